"""How do the results run along one input, or two, and where do they meet their limits? Many points in one batch."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure
from numpy.typing import NDArray

from truing.declare.blocks import Block, Drawing, Table, Words
from truing.declare.goals import Require
from truing.errors import UsageError
from truing.evaluate import acting_inputs, evaluate_rows
from truing.inputs_file.values import broken_demand
from truing.numbers import STATED_DIGITS, counted, format_value, pretty, with_unit
from truing.setup import Setup
from truing.studies.bench import Bench, Outcome, StepProgress, unheard
from truing.studies.checks import check_name, limit_of, of_design, requirements, sockets_of
from truing.studies.drawings import BLUE, GREY, ORANGE, WIDTH, labelled
from truing.studies.reading import printed, read_range, scattering_name, single_numbers, spoken
from truing.units import difference_unit, from_si, unit_text

LARGEST = 1_000_000
LABEL_DIGITS = 6
"""A stated value beside a curve has so many: it may stand there in another unit than it is stated in."""
ROUNDING = 1e-12
TOGETHER = 2**14
"""How many points one call of the model calculates."""
LINES, MOST_LINES = 5, 12
"""How many values a range of the second input has, and how many lines can be told apart in a figure."""
MOST_PANELS, MOST_FIGURES = 4, 3
FAR = 3.0
"""A limit so many heights of the curve away is named and not drawn: the curve would be flat."""
ROUNDS, PARTS, MOST_BRACKETS = 2, 8, 40
"""How a crossing is narrowed: the interval is parted so often, into so many parts, for at most so many crossings."""
MOST_REASONS = 5
MOST_SEEN = 2000
"""So many points of a line are drawn: more cannot be seen."""
Floats = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Sweep:
    """Evaluate results along one input or condition, in a line for each value of a second one.

    ``at`` is "low..high unit", divided into ``points`` values, or a list "a, b, c unit"; ``by_at``, the values of the
    second input ``by``, likewise. ``results`` names what is shown; empty: every result that changes.
    """

    over: str
    at: str
    points: int = 181
    by: str = ""
    by_at: str = ""
    results: str | tuple[str, ...] = ()
    name: str = "sweep"
    gives: Callable[[Swept], Any] | None = None

    def __post_init__(self) -> None:
        if not 2 <= self.points <= LARGEST:
            raise UsageError(f"points = {self.points}, but a sweep has 2 to {LARGEST} points")
        if bool(self.by) != bool(self.by_at):
            raise UsageError("by and by_at belong together: the second input, and its values")

    def run(self, bench: Bench) -> Swept:
        """Evaluate all points, many at once; an infeasible one keeps its reason. Raises UsageError for a bad range."""
        setup = bench.setup
        chosen = single_numbers(setup, self.results, self.name)
        columns = self._columns(setup)
        points = _evaluated(setup, columns, _wanted(setup, chosen), bench.part(self.name, 0.0, 1.0))
        limited = _limited(setup, bench.answers, points)
        crossings = _crossings(setup, bench.answers, points, limited, chosen or [*points.results])
        fields = setup.model.own_result_fields
        shown = [*columns, *points.results]
        return Swept(
            name=self.name,
            over=self.over,
            axis=columns[self.over],
            by=self.by,
            by_axis=columns.get(self.by, np.zeros(0)),
            results=points.results,
            failed=tuple(points.reasons.items()),
            absent=points.absent,
            units={name: setup.print_unit(name) for name in shown},
            symbols={name: fields[name].symbol or name for name in points.results},
            chosen=chosen,
            limits=tuple(limited),
            crossings=crossings,
            stated={name: float(setup.nominal(name)) for name in columns},
            shown=self.gives is None,
            inputs=acting_inputs(setup),
        )

    def _columns(self, setup: Setup) -> dict[str, Floats]:
        """Return the inputs that are swept, (rows,) each in SI: line after line."""
        over = scattering_name(setup, self.over, self.name)
        axis = _points(setup, over, self.at, self.points)
        if not self.by:
            return {over: axis}
        by = scattering_name(setup, self.by, self.name)
        if by == over:
            raise UsageError(f"study '{self.name}': '{over}' is swept already; name another input beside it")
        lines = np.unique(_points(setup, by, self.by_at, LINES))
        if len(lines) > MOST_LINES:
            raise UsageError(f"'{self.by_at}' are {len(lines)} lines; a figure has room for {MOST_LINES}")
        if len(lines) * len(axis) > LARGEST:
            raise UsageError(f"{len(lines)} lines of {len(axis)} points are more than {LARGEST} points")
        return {over: np.tile(axis, len(lines)), by: np.repeat(lines, len(axis))}


def _points(setup: Setup, over: str, at: str, points: int) -> Floats:
    """Return the points in SI; of an input that takes whole numbers, all between the ends or those listed."""
    axis = read_range(at, setup.unit_of(over), points)
    if ".." in at and not axis[0] < axis[-1]:
        empty = axis[0] == axis[-1]
        what = "is empty: its ends are the same" if empty else "runs backwards; write the lower end first"
        raise UsageError(f"the range '{at}' {what}")
    input_field = setup.model.input_fields.get(over)
    if input_field is not None and input_field.kind in {"integer", "whole"}:
        if ".." in at:
            axis = np.arange(np.ceil(axis[0]), np.floor(axis[-1]) + 1)
        if not len(axis) or (axis != np.round(axis)).any():
            raise UsageError(f"'{at}': '{over}' takes whole numbers")
    if len(axis) > LARGEST:
        raise UsageError(f"'{at}' are {len(axis)} points, but a sweep has at most {LARGEST}")
    return axis


def _wanted(setup: Setup, chosen: Sequence[str]) -> set[str] | None:
    """Return the results to calculate: those that are shown and those that are their limits; None for all."""
    if not chosen:
        return None
    bounds = {require.limit for require in requirements(setup) if require.result in chosen}
    return {*chosen, *(bounds & {*setup.model.own_result_fields})}


@dataclass(frozen=True)
class _Points:
    """What the model says at some points: inputs and results (rows,) in SI, and why there is no answer."""

    columns: Mapping[str, Floats]
    results: Mapping[str, Floats]
    reasons: Mapping[int, str]
    absent: Mapping[str, Mapping[int, str]]


def _evaluated(
    setup: Setup, columns: Mapping[str, Floats], wanted: Collection[str] | None, done: StepProgress = unheard
) -> _Points:
    """Ask the model at these points, but for those that break a declared bound of an input."""
    broken = _out_of_bounds(setup, columns)
    rows = len(next(iter(columns.values())))
    kept = np.array([row for row in range(rows) if row not in broken], dtype=int)
    asked = {name: _values(setup, name, values[kept]) for name, values in columns.items()}
    answer = evaluate_rows(setup, asked, len(kept), wanted=wanted, size=TOGETHER, done=done)
    results = dict(answer.results)
    if broken:
        for name, values in results.items():
            results[name] = np.full((rows, *values.shape[1:]), np.nan)
            results[name][kept] = values
    reasons = {**broken, **{int(kept[row]): why for row, why in answer.reasons.items()}}
    absent = {
        name: {int(kept[row]): why for row, why in lacking.items() if row not in answer.reasons}
        for name, lacking in answer.absent.items()
    }
    return _Points(columns, results, dict(sorted(reasons.items())), absent)


def _values(setup: Setup, over: str, axis: Floats) -> Any:
    input_field = setup.model.input_fields.get(over)
    return [int(value) for value in axis] if input_field is not None and input_field.kind == "integer" else axis


def _out_of_bounds(setup: Setup, columns: Mapping[str, Floats]) -> dict[int, str]:
    """Say which points break a declared bound; where neither end of the range does, none does."""
    broken: dict[int, str] = {}
    for name, values in columns.items():
        input_field = setup.model.input_fields.get(name)
        if input_field is None or not any(broken_demand(input_field, end) for end in (values.min(), values.max())):
            continue
        said = {value: broken_demand(input_field, value) for value in np.unique(values)}
        broken |= {row: f"{name} {said[value]}" for row, value in enumerate(values) if said[value]}
    return broken


# Limits: what bounds a result along the sweep, and where it is met


@dataclass(frozen=True)
class SweptLimit:
    """A limit on a result at every point: ``low <= result <= high`` (rows,) in SI, infinite where there is none."""

    name: str
    result: str
    words: str
    low: Floats
    high: Floats
    chance: bool = False

    def margin(self, results: Mapping[str, Floats]) -> Floats:
        """Return the distance to the nearer end: 0 or more where it is kept, NaN where there is no answer."""
        values = results[self.result]
        margin: Floats = np.minimum(values - self.low, self.high - values)
        return margin


@dataclass(frozen=True)
class Crossing:
    """Where a result meets its limit: the swept input, the second one (NaN without), both SI, and the side it keeps."""

    limit: str
    at: float
    by: float
    kept: str


def _limited(setup: Setup, answers: Mapping[str, Any], points: _Points) -> list[SweptLimit]:
    """Return the limits of these points; one from the nominal result only where the design itself does not change."""
    requires = requirements(setup)
    swept = {**points.results, **points.columns}
    changes = {*points.columns} & {*setup.model.input_fields} - {*sockets_of(setup)}
    found = []
    for require in requires:
        values, bound = points.results.get(require.result), points.results.get(require.limit)
        is_known = require.limit not in setup.model.result_fields if bound is None else bound.ndim == 1
        if values is None or values.ndim > 1 or not is_known or (require.kind == "within" and changes):
            continue
        centre = of_design(setup, require.result, dict(answers)) if require.kind == "within" else 0.0
        limit = limit_of(check_name(require, requires), require, setup, swept, {require.result: centre})
        low, high = (np.broadcast_to(np.asarray(end, dtype=float), values.shape) for end in (limit.low, limit.high))
        chance = require.reliability is not None
        found.append(SweptLimit(limit.name, require.result, _limit_words(require, setup, low, high), low, high, chance))
    return found


def _limit_words(require: Require, setup: Setup, low: Floats, high: Floats) -> str:
    """Say a limit as it stands in a figure: ≥ 28 kN, or its name where it moves."""
    relation = {"at_most": "≤ ", "at_least": "≥ ", "within": "nominal ± "}[require.kind]
    amounts = {"at_most": high, "at_least": low, "within": (high - low) / 2}[require.kind]
    if _moves(amounts) or not np.isfinite(amounts).any():
        return relation + spoken(require.limit)
    unit = setup.print_unit(require.result)
    unit = difference_unit(unit) if require.kind == "within" else unit
    number, unit = format_value(float(np.nanmax(amounts)), unit, STATED_DIGITS)
    return relation + with_unit(pretty(number), unit)


def _lines(columns: Mapping[str, Floats], over: str) -> Iterator[NDArray[np.intp]]:
    """Yield the rows of each line in the order of the swept input; without a second input there is one."""
    (by,) = [values for name, values in columns.items() if name != over] or [np.zeros(len(columns[over]))]
    for value in np.unique(by):
        rows = np.flatnonzero(by == value)
        yield rows[np.argsort(columns[over][rows], kind="stable")]


@dataclass(frozen=True)
class _Bracket:
    """Two neighbouring points (rows) between which a limit is met."""

    limit: SweptLimit
    rows: tuple[int, int]
    kept: str


def _crossings(
    setup: Setup, answers: Mapping[str, Any], points: _Points, limited: Sequence[SweptLimit], shown: Collection[str]
) -> tuple[Crossing, ...]:
    """Find where limits are met between points: more points there, then a straight line between the nearest two."""
    over, *others = points.columns
    brackets = [
        _Bracket(limit, (int(line[at]), int(line[at + 1])), "above" if kept[at + 1] else "below")
        for limit in limited
        if limit.result in shown
        for line in _lines(points.columns, over)
        for margin in [limit.margin(points.results)[line]]
        for kept in [margin >= 0]
        for at in np.flatnonzero((kept[:-1] != kept[1:]) & np.isfinite(margin[:-1] + margin[1:]))
    ][:MOST_BRACKETS]
    if not brackets:
        return ()
    rows = np.array([bracket.rows for bracket in brackets])
    low, high = points.columns[over][rows[:, 0]], points.columns[over][rows[:, 1]]
    beside = {name: points.columns[name][rows[:, 0]] for name in others}
    input_field = setup.model.input_fields.get(over)
    if input_field is not None and input_field.kind in {"integer", "whole"}:
        found = np.array([low[i] if bracket.kept == "below" else high[i] for i, bracket in enumerate(brackets)])
    else:
        found = _narrowed(setup, answers, brackets, ends=(low, high), over=over, beside=beside)
    by = beside[others[0]] if others else np.full(len(brackets), np.nan)
    return tuple(
        Crossing(bracket.limit.name, float(at), float(value), bracket.kept)
        for bracket, at, value in zip(brackets, found, by, strict=True)
    )


def _narrowed(
    setup: Setup,
    answers: Mapping[str, Any],
    brackets: Sequence[_Bracket],
    *,
    ends: tuple[Floats, Floats],
    over: str,
    beside: Mapping[str, Floats],
) -> Floats:
    """Return where the limits of these brackets are met; all brackets are asked in one batch, round by round."""
    low, high = ends
    count, every = len(brackets), np.arange(len(brackets))
    wanted = _wanted(setup, [bracket.limit.result for bracket in brackets])
    for _ in range(ROUNDS):
        grid = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, PARTS + 1)
        columns = {over: grid.ravel(), **{name: np.repeat(values, PARTS + 1) for name, values in beside.items()}}
        points = _evaluated(setup, columns, wanted)
        by_name = {limit.name: limit for limit in _limited(setup, answers, points)}
        own = [by_name[bracket.limit.name] for bracket in brackets]
        margins = np.array([
            limit.margin(points.results).reshape(count, -1)[index] for index, limit in enumerate(own)
        ])  # fmt: skip
        kept = margins >= 0
        place = np.argmax(kept[:, :-1] != kept[:, 1:], axis=1)
        low, high = grid[every, place], grid[every, place + 1]
    first, second = margins[every, place], margins[every, place + 1]
    with np.errstate(all="ignore"):
        share = first / (first - second)
    return low + np.where(np.isfinite(share), share, 0.5) * (high - low)


# What a sweep found


@dataclass(frozen=True, kw_only=True)
class Swept(Outcome):
    """The results along the swept input: ``axis`` (n,) and ``results[name]`` (n,) or (n, k) in SI, NaN where failed.

    With a second input ``by`` the rows are those of one line after another, and ``by_axis`` (n,) holds its values.
    ``failed`` says of rows without an answer why, ``absent`` likewise by result. ``limits`` and ``crossings`` say what
    bounds the results and where they meet it; ``stated`` holds the inputs as the run has them. ``inputs`` are those of
    the run, as effects leave them.
    """

    name: str
    over: str
    axis: Floats
    by: str = ""
    by_axis: Floats = field(default_factory=lambda: np.zeros(0))
    results: Mapping[str, Floats]
    failed: tuple[tuple[int, str], ...]
    absent: Mapping[str, Mapping[int, str]] = field(default_factory=dict)
    units: Mapping[str, str]
    symbols: Mapping[str, str]
    chosen: tuple[str, ...] = ()
    limits: tuple[SweptLimit, ...] = ()
    crossings: tuple[Crossing, ...] = ()
    stated: Mapping[str, float] = field(default_factory=dict)
    shown: bool = True
    inputs: Any = None

    @property
    def columns(self) -> dict[str, Floats]:
        """The inputs that are swept, (n,) by name."""
        return {self.over: self.axis, **({self.by: self.by_axis} if self.by else {})}

    def printed_columns(self, names: Sequence[str] = ()) -> dict[str, Floats]:
        """Return inputs, and these results or all that are one number per point, in printed units by "name [unit]"."""
        plain = {name: self.results[name] for name in names or self.results if self.results[name].ndim == 1}
        return {
            f"{name} [{self.units[name] or '1'}]": np.asarray(from_si(values, self.units[name]), dtype=float)
            for name, values in {**self.columns, **plain}.items()
        }

    def as_json(self) -> dict[str, Any]:
        """Return the axis and every result in printed units; null where a point failed."""
        second = {"unit": self.units[self.by], "axis": printed(self.by_axis, self.units[self.by])} if self.by else {}
        limits = {limit.name: {"result": limit.result, "limit": limit.words} for limit in self.limits}
        return {
            "over": self.over,
            "unit": self.units[self.over],
            "axis": printed(self.axis, self.units[self.over]),
            **({"by": self.by, "by_unit": second["unit"], "by_axis": second["axis"]} if self.by else {}),
            "results": {
                name: {"unit": self.units[name], "values": printed(values, self.units[name])}
                for name, values in self.results.items()
            },
            "limits": {
                name: {**said, "crossings": [self._crossing(each) for each in self.crossings if each.limit == name]}
                for name, said in limits.items()
            },
            "failed": [{"row": row, "reason": reason} for row, reason in self.failed],
        }

    def _crossing(self, crossing: Crossing) -> dict[str, Any]:
        by = {"by": printed(crossing.by, self.units[self.by])} if self.by else {}
        return {"at": printed(crossing.at, self.units[self.over]), **by, "kept": crossing.kept}

    def blocks(self) -> Sequence[Block]:
        """Return extremes, limits and where they are met; curves where no section draws them; what has no answer."""
        blocks: list[Block] = [table for table in (self._extremes(), self.limit_table()) if table.rows]
        names = self.moving()[: MOST_PANELS * MOST_FIGURES] if self.shown else []
        for start in range(0, len(names), MOST_PANELS):
            part = names[start : start + MOST_PANELS]
            which = ": " + ", ".join(map(spoken, part)) if len(names) > MOST_PANELS else ""
            blocks.append(Drawing(f"Along the {spoken(self.over)}{which}", curves(self, part)))
        if len(names) < len(self.moving()) and names:
            blocks.append(Words(f"{len(self.moving()) - len(names)} further results change; named, they are drawn."))
        return [*blocks, *(Words(text, "warning") for text in self.gaps())]

    def gaps(self) -> list[str]:
        """Say which points have no answer, reason by reason, and which results do not exist at points that have one."""
        lacking = [("", dict(self.failed))]
        lacking += [(name, dict(rows)) for name, rows in self.absent.items() if not self.chosen or name in self.chosen]
        said = []
        for name, rows in lacking:
            grouped: dict[str, list[int]] = {}
            for row, reason in rows.items():
                grouped.setdefault(reason, []).append(row)
            parts = [f"{len(found)} {self._between(found)}: {why}" for why, found in grouped.items()]
            more = f"; and {counted(len(parts) - MOST_REASONS, 'further reason')}" if len(parts) > MOST_REASONS else ""
            what = f"no '{name}'" if name else "no answer"
            if rows:
                said.append(f"{len(rows)} of {len(self.axis)} points have {what}: {'; '.join(parts[:5])}{more}.")
        return said

    def _between(self, rows: Sequence[int]) -> str:
        ends = [float(each) for each in (self.axis[rows].min(), self.axis[rows].max())]
        texts = [with_unit(*format_value(end, self.units[self.over])) for end in ends]
        return f"at {texts[0]}" if ends[0] == ends[1] else f"from {texts[0]} to {texts[1]}"

    def warnings(self) -> Sequence[str]:
        """Name the points that failed."""
        if not self.failed:
            return ()
        return (
            f"study '{self.name}': {len(self.failed)} of {len(self.axis)} points along '{self.over}' have no answer",
        )

    def _plain(self) -> list[str]:
        """Name the results that are one number per point and finite somewhere."""
        return [name for name, values in self.results.items() if values.ndim == 1 and np.isfinite(values).any()]

    def moving(self) -> list[str]:
        """Name those that are chosen; else those that change by more than rounding, or whose limit does.

        Those that have a limit come first.
        """
        plain = self._plain()
        if self.chosen:
            return [name for name in self.chosen if name in plain]
        limits = {limit.result for limit in self.limits if _moves(limit.low) or _moves(limit.high)}
        moving = [name for name in plain if name in limits or _moves(self.results[name])]
        limited = {limit.result for limit in self.limits}
        return sorted(moving, key=lambda name: name not in limited)

    def _extremes(self) -> Table:
        inputs = [*self.columns]
        rows: list[list[Any]] = []
        for name in self.moving():
            values = self.results[name]
            row: list[Any] = [name, unit_text(self.units[name])]
            for index in (int(np.nanargmin(values)), int(np.nanargmax(values))):
                row.append(float(from_si(values[index], self.units[name])))
                row += [float(from_si(self.columns[one][index], self.units[one])) for one in inputs]
            rows.append(row)
        at = ["at", *(["and"] if self.by else [])]
        units = [self.units[name] for name in inputs]
        columns = ("result", "unit", "smallest", *at, "largest", *at)
        still = len(self._plain()) - len(rows)
        note = f"Of {len(self.axis)} points; nothing is sought between them."
        if still and not self.chosen:
            note += f" {still} other results do not change." if still > 1 else " One other result does not change."
        title = f"Extremes along the {' and the '.join(map(spoken, inputs))}"
        return Table(title, columns, rows, ("", "", "", *units, "", *units), note)

    def limit_table(self) -> Table:
        """Say of every limit, line by line, where it is met and on which side it is kept."""
        rows: list[list[Any]] = []
        names = self.moving()
        limits = [limit for limit in self.limits if limit.result in names]
        for limit in limits:
            for line in _lines(self.columns, self.over):
                by = self.by_axis[line[0]] if self.by else np.nan
                met = [one for one in self.crossings if one.limit == limit.name and (not self.by or one.by == by)]
                beside = [float(from_si(by, self.units[self.by]))] if self.by else []
                places: list[tuple[float | None, str]] = [
                    (float(from_si(one.at, self.units[self.over])), f"{one.kept} it") for one in met
                ]
                for at, side in places or [(None, _kept_words(limit.margin(self.results)[line]))]:
                    rows.append([limit.result, limit.words, *beside, at, side])
        columns = ("result", "limit", *([spoken(self.by)] if self.by else []), f"met at {spoken(self.over)}", "kept")
        units = ("", "", *([self.units[self.by]] if self.by else []), self.units[self.over], "")
        note = "Limits that a share of machines must keep are compared with the result itself, without scatter."
        note = note if any(limit.chance for limit in limits) else ""
        return Table(f"Limits along the {spoken(self.over)}", columns, rows, units, note)


def _kept_words(margin: Floats) -> str:
    """Say where a limit is kept that is not met between two points."""
    answered = margin[np.isfinite(margin)]
    kept = int((answered >= 0).sum())
    if not answered.size:
        return "no answer"
    return "everywhere" if kept == answered.size else f"at {kept} of {answered.size} points" if kept else "nowhere"


def _moves(values: Floats) -> bool:
    finite = values[np.isfinite(values)]
    return bool(finite.size) and not np.ptp(finite) <= ROUNDING * np.abs(finite).max()


# Curves, with limits and the stated value drawn in


def curves(swept: Swept, names: Sequence[str]) -> Callable[[], Figure]:
    """Draw results along the swept input, one below the other: their limits, what fails, and where the run stands."""

    def draw() -> Figure:
        figure = Figure(
            figsize=(WIDTH, 0.6 + (2.4 if swept.by or len(names) == 1 else 1.6) * len(names)), layout="constrained"
        )
        panels = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
        unit = swept.units[swept.over]
        for panel, name in zip(panels, names, strict=True):
            _draw_result(panel, swept, name)
            panel.set_ylabel(labelled(name, unit_text(swept.units[name])))
            panel.grid(alpha=0.3)
        stated = swept.stated.get(swept.over, np.nan)
        if swept.axis.min() <= stated <= swept.axis.max():
            for panel in panels:
                panel.axvline(from_si(stated, unit), color=GREY, linestyle=":", linewidth=1.0)
            words = f"stated: {with_unit(*format_value(stated, unit, LABEL_DIGITS))}"
            place = {"xycoords": ("data", "axes fraction"), "ha": "center", "va": "bottom", "fontsize": 7.5}
            panels[0].annotate(words, (float(from_si(stated, unit)), 1.01), color=GREY, **place)
        if swept.by:
            title = labelled(swept.by, unit_text(swept.units[swept.by]))
            panels[0].legend(title=title, loc="center left", bbox_to_anchor=(1.01, 0.5), title_fontsize=8.0)
        panels[-1].set_xlabel(labelled(swept.over, unit_text(unit)))
        return figure

    return draw


def _draw_result(panel: Any, swept: Swept, name: str) -> None:
    """Draw the lines of one result, then its limits within what is then seen."""
    lines = [_thinned(line, swept.results[name]) for line in _lines(swept.columns, swept.over)]
    shades = colormaps["viridis"](np.linspace(0.0, 0.85, len(lines))) if swept.by else [BLUE]
    for line, colour in zip(lines, shades, strict=True):
        label = format_value(swept.by_axis[line[0]], swept.units[swept.by], LABEL_DIGITS)[0] if swept.by else None
        x, y = _printed(swept, swept.axis[line], swept.over), _printed(swept, swept.results[name][line], name)
        is_alone = np.isfinite(y).sum() == 1
        panel.plot(x, y, color=colour, label=label, marker="o" if is_alone else "")
    ends = [
        _printed(swept, end, name)
        for limit in swept.limits
        if limit.result == name
        for end in (limit.low, limit.high)
        if np.isfinite(end).any()
    ]
    values = _printed(swept, swept.results[name], name)
    bottom, top = _seen(values[np.isfinite(values)], ends)
    panel.set_ylim(bottom, top)
    for limit in swept.limits:
        for end, is_low in ((limit.low, True), (limit.high, False)):
            if limit.result == name and np.isfinite(end).any():
                _draw_limit(panel, swept, replace(limit, low=_printed(swept, end, name)), lines, is_low=is_low)


def _thinned(line: NDArray[np.intp], values: Floats) -> NDArray[np.intp]:
    """Return the rows of a line that can be seen: of very many the smallest and the largest of each part."""
    if len(line) <= MOST_SEEN:
        return line
    parts = [part[np.argsort(values[part])] for part in np.array_split(line, MOST_SEEN // 2)]  # NaN comes last
    kept = np.concatenate([line[[0, -1]], *(part[[0, -1]] for part in parts)])
    return line[np.isin(line, kept)]


def _printed(swept: Swept, values: Any, name: str) -> Floats:
    return np.asarray(from_si(values, swept.units[name]), dtype=float)


def _seen(values: Floats, ends: Sequence[Floats]) -> tuple[float, float]:
    """Return what is seen of a panel: all of the curve, and limits that are not too far from it."""
    low, high = (float(values.min()), float(values.max())) if values.size else (0.0, 1.0)
    reach = FAR * (high - low or abs(high) or 1.0)
    near = [end for end in ends if low - reach <= np.nanmax(end) and np.nanmin(end) <= high + reach]
    low, high = min([low, *map(np.nanmin, near)]), max([high, *map(np.nanmax, near)])
    room = 0.08 * (high - low or abs(high) or 1.0)
    return low - room, high + room


def _draw_limit(
    panel: Any, swept: Swept, limit: SweptLimit, lines: Sequence[NDArray[np.intp]], *, is_low: bool
) -> None:
    """Draw one end of a limit (its ``low``, in the printed unit) with its name, and shade lightly what lies beyond."""
    end, (bottom, top) = limit.low, panel.get_ylim()
    beyond = bottom if is_low else top
    if np.nanmax(end) < bottom or np.nanmin(end) > top:
        place, where = (1.0, "top") if np.nanmin(end) > top else (0.0, "bottom")
        words = f"{limit.words} (beyond the figure)"
        panel.text(0.01, place, words, transform=panel.transAxes, va=where, color=ORANGE, fontsize=7.5)
        return
    alike = all(np.array_equal(end[line], end[lines[0]], equal_nan=True) for line in lines)
    for line in lines[:1] if alike else lines:
        x = _printed(swept, swept.axis[line], swept.over)
        panel.plot(x, end[line], color=ORANGE, linestyle="--", linewidth=1.0)
        if alike:
            panel.fill_between(x, end[line], beyond, color=ORANGE, alpha=0.1, linewidth=0)
    first = lines[0][np.argmax(np.isfinite(end[lines[0]]))]
    how: dict[str, Any] = {
        "xytext": (3, -2 if is_low else 2),
        "textcoords": "offset points",
        "va": "top" if is_low else "bottom",
    }
    at = (_printed(swept, swept.axis[first], swept.over), end[first])
    panel.annotate(limit.words, at, color=ORANGE, fontsize=7.5, **how)
