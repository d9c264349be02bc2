"""What stands on a sheet, said once and without markup; HTML and Markdown are both written from it.

Texts in here are raw: they come from users and plugins, and only the renderers know how to make them harmless.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

from truing.declare.blocks import Words
from truing.declare.published import Finding
from truing.formulas import Formula
from truing.published import ComparedRow
from truing.runs.provenance import Provenance
from truing.studies.checks import Proposal, State


@dataclass(frozen=True)
class Value:
    """A number as printed, with the unit as printed."""

    text: str
    unit: str = ""


@dataclass(frozen=True)
class InputRow:
    """One input: what it is, its value, and whether the inputs file states it."""

    name: str
    symbol: str
    value: Value
    note: str
    source: str
    stated: bool
    calibrated: Value | None = None


@dataclass(frozen=True)
class ToleranceRow:
    """A tolerance in force: what it is on, how it is written, and the standard deviation of each input."""

    name: str
    on: tuple[tuple[str, str], ...]
    spread: str
    sds: tuple[Value, ...]
    shift: tuple[Value, ...]
    why: str
    source: str


@dataclass(frozen=True)
class ConditionRow:
    """A condition: its value, the reference at which its effects vanish."""

    name: str
    value: Value
    reference: Value
    note: str


@dataclass(frozen=True)
class UnknownRow:
    """One number of an effect that is on, with its standard deviation where it was diagnosed."""

    name: str
    value: Value
    sd: Value | None
    note: str


@dataclass(frozen=True)
class EffectRow:
    """An effect that is on."""

    name: str
    place: str
    unknowns: tuple[UnknownRow, ...]
    why: str
    source: str


@dataclass(frozen=True)
class ChangedInput:
    """An input that effects change before the calculation sees it."""

    name: str
    symbol: str
    stated: Value
    acting: Value


@dataclass(frozen=True)
class CheckRow:
    """A limit and how far it is kept.

    ``compared`` is what the value is; ``proposed`` the value of the design that a study proposes, ``remark`` says
    which study would decide the limit, or what its bound is called; ``method`` how a probability was found.
    """

    name: str
    symbol: str
    note: str
    compared: str
    relation: str
    value: Value
    limit: Value
    margin: Value
    state: State
    proposed: Value | None = None
    remark: str = ""
    method: str = ""


@dataclass(frozen=True)
class Equation:
    """A formula ready to be set: in symbols, in numbers (None where a name runs along an axis), and its result."""

    formula: Formula
    name: str
    symbol: str
    symbols: Mapping[str, str]
    numbers: Mapping[str, tuple[str, str]] | None
    results: tuple[Value, ...]
    departs: bool = False
    """Whether the calculation's own answer is another one than the formula's: an effect on the results is on."""


@dataclass(frozen=True)
class ResultEntry:
    """One result: its value, or its range along an axis, with its formula or how it was found."""

    name: str
    symbol: str
    note: str
    value: Value | None
    equation: Equation | None = None
    method: str = ""
    source: str = ""
    extent: str = ""
    absent: str = ""
    """Why it does not exist."""


@dataclass(frozen=True)
class TableView:
    """A table of finished texts; ``numeric`` says which columns hold numbers."""

    title: str
    columns: tuple[str, ...]
    units: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    numeric: tuple[bool, ...]
    note: str = ""
    marked: int | None = None
    """The row that is set off from the others, if there is one."""


@dataclass(frozen=True)
class FigureView:
    """A figure as SVG, with the words that stand for it where it cannot be seen."""

    title: str
    svg: str
    caption: str
    number: int


BlockView: TypeAlias = Words | TableView | FigureView


@dataclass(frozen=True)
class Chapter:
    """A part of the sheet with a number and a title."""

    number: str
    ident: str
    title: str
    kind: str
    text: str = ""
    entries: tuple[ResultEntry, ...] = ()
    blocks: tuple[BlockView, ...] = ()


@dataclass(frozen=True)
class Head:
    """The title block."""

    title: str
    model: str
    fields: tuple[tuple[str, str], ...]
    signatures: tuple[tuple[str, str], ...]
    footer: str
    logo: str = ""
    """A picture as a data address, or nothing."""


@dataclass(frozen=True)
class Banner:
    """The verdict below the title block: ``mood`` is the state, or none where there are no limits."""

    mood: str
    headline: str
    text: str
    proposal: Proposal | None = None


@dataclass(frozen=True, kw_only=True)
class Sheet:
    """Everything on a sheet, in order."""

    head: Head
    detail: str
    banner: Banner
    margins: str
    """What the margins are shares of, or that they are distances."""
    summary: str
    chapters: tuple[Chapter, ...]
    checks: tuple[CheckRow, ...]
    inputs: tuple[InputRow, ...]
    idle_inputs: tuple[InputRow, ...]
    """Inputs not given or left at a default of 0, which a sheet that is not a full one only names."""
    tolerances: tuple[ToleranceRow, ...]
    conditions: tuple[ConditionRow, ...]
    effects: tuple[EffectRow, ...]
    changed: tuple[ChangedInput, ...]
    compared: tuple[ComparedRow, ...]
    compared_elsewhere: tuple[ComparedRow, ...]
    rules: tuple[str, ...]
    """By which the printed numbers are judged."""
    findings: tuple[Finding, ...]
    warnings: tuple[str, ...]
    references: tuple[str, ...]
    provenance: Provenance
