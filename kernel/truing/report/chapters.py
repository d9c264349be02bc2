"""The numbered chapters of results: the model's sections, what the studies say, and what is in no section."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from truing.arrays import Matrix
from truing.calculation import Calculation
from truing.declare.blocks import Block, Drawing, Table, Words
from truing.declare.chain import acts_on, chain_of
from truing.declare.fields import Axis, Found, InputField, ResultField
from truing.declare.model import Model, Section
from truing.errors import PluginError
from truing.evaluate import acting_inputs
from truing.kernel.blame import spoken_place
from truing.numbers import RESULT_DIGITS, format_ends, format_number, format_value, pretty
from truing.report.chain_chapter import chain_chapter, head_of_calculation
from truing.report.document import (
    BlockView,
    Chapter,
    Column,
    FigureView,
    Marked,
    Paragraph,
    ResultEntry,
    TableView,
    Text,
    Value,
    label_of,
    lines_of,
    symbol_cell,
    table_of,
    unit_as_said,
    with_source,
)
from truing.report.equations import equation_of, state_equation
from truing.report.figures import draw, in_words, phase, states_over_time
from truing.report.limits import MOST_CHECKS
from truing.report.sheet_units import AS_DECLARED, SheetUnits
from truing.report.translation import ENGLISH_WORDS, Catalogue
from truing.report.wording import STUDY
from truing.studies.drawings import labelled
from truing.units import from_si

RANK = {"short": 0, "normal": 1, "full": 2}
LONGEST_TABLE = {"short": 20, "normal": 60, "full": 1000}
DEPARTURES = {
    True: "in the calculation, with the effects on the results that are on",
    False: "in the calculation: the printed formula gives another number",
}
"""Why a calculation has another number than the printed formula, with and without an effect on the results."""
MOST_MAIN, FEWEST_MAIN, LINE_OF_RESULTS, HEADING = 28, 8, 80, 5
"""So many lines of results, of so many characters, stand on a short sheet, fewer below a chapter of limits: they fit on
its second page. A heading takes the room of so many lines."""
ON_PAGE_ONE = Paragraph("Its figure is on page one.", "aside")
AXIS_ROWS = {"short": 0, "normal": 12, "full": 25}


@dataclass
class Figures:
    """Counts the figures of one sheet and keeps what could not be drawn."""

    words: Catalogue = ENGLISH_WORDS
    """What is drawn is in this language."""
    count: int = 0
    failures: list[str] = field(default_factory=list)
    skipped: bool = False
    """Whether nothing is drawn: for a printer that has no figures."""
    units: SheetUnits = AS_DECLARED
    """The units of the sheet, to which the axes are brought over."""

    def view(self, title: str, what: Callable[[], Any], caption: str, *, place: str = "") -> BlockView:
        """Draw a figure; one that fails is said in its place and does not take the sheet away.

        ``place`` says which words hold in it, where these are not those of the sheet.
        """
        self.count += 1
        if self.skipped:
            return FigureView(title, "", caption or title, self.count, what)
        ident = f"f{self.count}"
        try:
            words = self.words.at(place)
            drawn = partial(self.units.drawn, what)
            svg = draw(drawn, title=title, ident=ident, words=words)
            return FigureView(title, svg, caption or title, self.count, in_words(drawn, words))
        except PluginError as error:
            self.failures.append(str(error))
            return Paragraph(f"The figure '{title}' could not be drawn.", "warning")


@dataclass(frozen=True)
class Writing:
    """What the chapters are written from."""

    calculation: Calculation
    detail: str
    figures: Figures
    made: dict[str, list[Block]] = field(default_factory=dict)
    """The blocks of a section, by its title; in a chain by the title behind the calculation."""
    front: list[Any] = field(default_factory=list)
    """The figure or drawing that stands on page one."""


def front_figure(writing: Writing) -> Chapter | None:
    """Draw the figure of page one: the first of a section that is marked, else of all sections of normal detail."""
    sections = [section for section in writing.calculation.setup.model.sheet if not section.of]
    marked = [section for section in sections if section.key]
    for section in marked or [section for section in sections if RANK[section.level] <= 1]:
        drawing = _first_drawing(writing, section)
        if drawing is not None:
            writing.front.append(section.figure or drawing)
            view = writing.figures.view(drawing.title, drawing.draw, drawing.caption or drawing.title)
            return Chapter(drawing.title, (view,), "key-figure")
    return None


def _first_drawing(writing: Writing, section: Section) -> Drawing | None:
    if section.figure is not None:
        return Drawing(section.title, partial(section.figure, writing.calculation.record), section.caption)
    with suppress(Exception):  # it is said where the section stands
        return next((block for block in _blocks_of(writing, section) if isinstance(block, Drawing)), None)
    return None


def _blocks_of(writing: Writing, section: Section) -> list[Block]:
    """Return the blocks of a section, which are made once."""
    title = section.whole_title
    if section.blocks is not None and title not in writing.made:
        writing.made[title] = list(section.blocks(writing.calculation.record))
    return writing.made.get(title, [])


def result_chapters(writing: Writing) -> Iterator[Chapter]:
    """Write the model's sections at this level of detail, then the studies, then the rest."""
    rank = RANK.get(writing.detail, 1)
    if rank:
        yield from _state_equation(writing)
    model = writing.calculation.setup.model
    chain, begun = chain_of(model), None
    yield from chain_chapter(writing.calculation.setup, writing.figures.view)
    named: set[str] = set()
    for section in model.sheet:
        named.update(section.names)
        if RANK[section.level] <= rank:
            chapter = _of_section(writing, section)
            says = len(chapter.blocks) > bool(section.text)
            if says or not (section.names or section.figure or section.blocks):
                if chain is not None and begun != section.of:
                    yield head_of_calculation(chain, section.of)
                    begun = section.of
                yield replace(chapter, inside=chain is not None)
                # one that has nothing to say because its study did not run has no heading either
    if rank == 0:
        yield from _main_results(writing)
        return
    yield from study_chapters(writing)
    rest = [
        name
        for name in writing.calculation.setup.model.result_fields
        if name not in named and name in writing.calculation.answers
    ]
    if rest:
        yield Chapter("Further results", tuple(_results(writing, rest)))


def _state_equation(writing: Writing) -> Iterator[Chapter]:
    """Write what a model that moves follows: each state with its rate and where it starts, the events, the method."""
    dynamics = writing.calculation.setup.model.dynamics
    if dynamics is None:
        return
    model = writing.calculation.setup.model
    entries: list[BlockView] = []
    for name, spec in dynamics.state_fields.items():
        symbol = (Marked("symbol", spec.symbol), " ") if spec.symbol else ()
        start = str(spec.start) if isinstance(spec.start, str) else f"{spec.start:g} {spec.unit}".strip()
        start = writing.figures.units.said(start) if not isinstance(spec.start, str) else start
        begins = "as the calculation sets it" if dynamics.start is not None else f"at {start.replace('_', ' ')}"
        equation = state_equation(model, name)
        entries.append(ResultEntry(name, label_of(spec.note, name), equation, (*symbol, f"begins {begins}")))
    if dynamics.events:
        when = {"rises": "rises through 0", "falls": "falls through 0", "either": "passes 0"}
        rows = [
            (event.name.replace("_", " "), label_of(event.note, event.name), when[event.when],
             "it stays as it is then" if event.ends else "the states are set anew" if event.then else "it is counted")
            for event in dynamics.events
        ]  # fmt: skip
        entries.append(table_of("Events", ("event", "what passes 0", "happens where it", "then"), rows))
    if dynamics.step is None:
        tolerance, settled = (format_number(each, 2) for each in (dynamics.tolerance, 100 * dynamics.settled))
        said = (
            f"Every step keeps the relative error below {pretty(tolerance)}; a tenth of that changes no result by more "
            f"than {pretty(settled)} % of its largest value."
        )
        entries.append(Paragraph(said))
    moving = _moving_states(writing.calculation)
    if len(moving) > 1:
        entries.append(writing.figures.view("States over time", partial(states_over_time, moving), ""))
    if len(moving) > 2:
        entries.append(writing.figures.view("Phase", partial(phase, moving), "Phase: one state over the other"))
    yield Chapter("State equation", tuple(entries))


def _moving_states(calculation: Calculation) -> Mapping[str, Matrix]:
    """Return the time and every state that changes, by their labels, in the units in which they are declared."""
    dynamics = calculation.setup.model.dynamics
    assert dynamics is not None
    motion = dynamics.followed(acting_inputs(calculation.setup))
    units = {name: calculation.setup.sheet.shown(spec.unit) for name, spec in dynamics.state_fields.items()}
    states = {
        labelled(name, unit_as_said(unit)): from_si(getattr(motion.states, name), unit) for name, unit in units.items()
    }
    return {"time, s": motion.time} | {label: values for label, values in states.items() if np.ptp(values) > 0}


def _of_section(writing: Writing, section: Section) -> Chapter:
    names = [name for name in section.names if name in writing.calculation.answers]
    record = writing.calculation.record
    blocks: list[BlockView] = [*([Paragraph(section.text)] if section.text else []), *_results(writing, names)]
    if section.figure is not None and section.figure in writing.front:
        blocks.append(ON_PAGE_ONE)
    elif section.figure is not None:
        blocks.append(writing.figures.view(section.title, partial(section.figure, record), section.caption))
    if section.blocks is not None:
        blocks += _guarded(writing, section.title, partial(_blocks_of, writing, section))
    return Chapter(section.title, tuple(blocks))


def _main_results(writing: Writing) -> Iterator[Chapter]:
    """Write the values of the normal sections without their formulas."""
    model = writing.calculation.setup.model
    sections = [section for section in model.sheet if section.level == "normal"]
    names = [name for section in sections for name in section.names] or (
        list(model.result_fields) if not model.sheet else []
    )
    scalars = [name for name in dict.fromkeys(names) if _is_scalar(writing.calculation.answers.get(name))]
    if scalars:
        notes = [model.result_fields[name].spec.note for name in scalars]
        lines = np.cumsum([lines_of(note, LINE_OF_RESULTS) for note in notes])
        checks = len(writing.calculation.checks)
        room = MOST_MAIN - (checks + HEADING if checks > MOST_CHECKS else 0)
        shown = scalars[: int(np.searchsorted(lines, max(room, FEWEST_MAIN), side="right"))]
        left = len(scalars) - len(shown)
        note = f'{left} further results stand on a sheet of detail "normal".' if left > 0 else ""
        table = result_table(writing.calculation, shown)
        yield Chapter("Main results", (replace(table, note=note),))


def result_table(calculation: Calculation, names: Sequence[str]) -> TableView:
    """Write results with their values alone."""
    columns = (
        Column("Symbol", kind="symbol"), Column("Result", kind="name"), Column("Value", kind="number"),
        Column("Unit", kind="units"),
    )  # fmt: skip
    rows: list[tuple[Text, ...]] = []
    for name in names:
        field = calculation.setup.model.result_fields[name]
        value = _value_of(calculation, name)
        rows.append((symbol_cell(field.symbol), label_of(field.spec.note, name), value.text, value.unit))
    return TableView("", columns, tuple(rows), kind="key")


def _value_of(calculation: Calculation, name: str) -> Value:
    """Write a result: a number, the ends of what runs along an axis, or that there is none."""
    setup, answer = calculation.setup, calculation.answers.get(name)
    field, unit = setup.model.result_fields[name], setup.print_unit(name)
    if answer is None or name in calculation.absent:
        return Value("no value")
    if np.ndim(answer) == 0:
        digits = field.digits if isinstance(field.spec, Found) else 5
        return Value(*format_value(answer, unit, digits))
    low, high, printed = format_ends(answer, unit)
    return Value(f"{pretty(low)} … {pretty(high)}", printed) if low else Value("no finite value")


def study_chapters(writing: Writing) -> Iterator[Chapter]:
    """Write what the studies say, a chapter each."""
    for name, outcome in writing.calculation.outcomes.items():
        blocks = _guarded(writing, f"study {name}", outcome.blocks, STUDY)
        if blocks:
            yield Chapter(f"Study: {name.replace('_', ' ')}", tuple(blocks))


def _is_scalar(value: Any) -> bool:
    return value is not None and getattr(value, "ndim", 0) == 0


def _results(writing: Writing, names: Sequence[str]) -> Iterator[BlockView]:
    """Write single results as entries, long axes as entries with their range, short ones as tables."""
    for name in names:
        spec = writing.calculation.setup.model.result_fields[name].spec
        if not (isinstance(spec, Axis) and spec.is_table):
            yield _entry(writing, name)
    yield from _axis_tables(writing, names)


def _entry(writing: Writing, name: str) -> ResultEntry:
    """Say a result: its formula, and its value where the formula does not end with it."""
    result, answers = writing.calculation.setup.model.result_fields[name], writing.calculation.answers
    absent = writing.calculation.absent.get(name, "")
    is_scalar = _is_scalar(answers[name])
    equation = equation_of(writing.calculation.setup, answers, result) if not (absent and is_scalar) else None
    symbol = (Marked("symbol", result.symbol), " ") if result.symbol else ()
    value: Text = ""
    if absent:
        value = (*symbol, *(("has ",) if symbol else ()), Marked("strong", "no value"), ": ", Marked("aside", absent))
    elif not is_scalar:
        along = result.along if isinstance(result.spec, Found) else ""
        words = f"{np.size(answers[name])} values" + (f" along {along}" if along and along != name else "")
        low, high, unit = format_ends(answers[name], writing.calculation.setup.print_unit(name))
        extent = Value(f"{pretty(low)} … {pretty(high)}", unit) if low else Value("no finite value")
        value = (*symbol, *(("is ",) if symbol else ()), Marked("strong", extent), " ", Marked("aside", f"({words})"))
    elif equation is None or equation.departs:
        printed = Value(*format_value(answers[name], writing.calculation.setup.print_unit(name), result.digits))
        value = (*symbol, *(("= ",) if symbol else ()), Marked("strong", printed))
        if equation is not None:
            setup = writing.calculation.setup
            on_results = any(acts_on(setup.model, active.effect) == "results" for active in setup.effects)
            value += (" ", Marked("aside", DEPARTURES[on_results]))
    method = with_source(getattr(result.spec, "method", ""), getattr(result.spec, "source", ""))
    return ResultEntry(name, label_of(result.spec.note, name), equation, value, method)


def _axis_tables(writing: Writing, names: Sequence[str]) -> Iterator[TableView]:
    """Write what runs along an axis as a table where it is short enough or the sheet is a full one.

    Where there are too many rows they are evenly thinned.
    """
    fields, answers = writing.calculation.setup.model.result_fields, writing.calculation.answers
    by_axis: dict[str, list[str]] = {}
    for name in names:
        result = fields[name]
        if not _is_scalar(answers[name]) and np.ndim(answers[name]) == 1 and isinstance(result.spec, Found):
            by_axis.setdefault(result.along, []).append(name)
    for axis, columns in by_axis.items():
        axis_field = fields.get(axis)
        is_table = axis_field is not None and isinstance(axis_field.spec, Axis) and axis_field.spec.is_table
        units = {
            name: writing.calculation.setup.print_unit(name)
            for name in (*([axis] if axis in answers else []), *columns)
        }
        length = len(answers[columns[-1]])
        most = LONGEST_TABLE[writing.detail] if is_table else AXIS_ROWS[writing.detail]
        if length <= most or writing.detail == "full" or is_table:
            places = sorted({round(one) for one in np.linspace(0, length - 1, min(length, most))}) if length else []
            rows = (tuple(format_value(float(answers[n][at]), unit)[0] for n, unit in units.items()) for at in places)
            heads = (
                Column(fields[n].spec.note or n, format_value(0.0, unit)[1], "number") for n, unit in units.items()
            )
            note = f"{len(places)} of {length} rows" if length > most else ""
            yield TableView(f"Along {axis}" if axis else "Series", tuple(heads), tuple(rows), note)


def _guarded(
    writing: Writing, title: str, make: Callable[[], Iterable[Block]], place: str = ""
) -> list[BlockView]:  # fmt: skip
    """Write the blocks of a guest; where its code fails that is said in their place, and the sheet goes on."""
    try:
        return [_view(writing, writing.figures.units.block(block), place) for block in make()]
    except Exception as error:
        writing.figures.failures.append(f"{spoken_place(error)}'{title}' failed: {type(error).__name__}: {error}")
        return [Paragraph(f"What '{title}' says could not be written.", "warning")]


def _view(writing: Writing, block: Block, place: str) -> BlockView:
    if isinstance(block, Words):
        return Paragraph(block.text, block.kind)
    if isinstance(block, Drawing):
        if any(block.draw is each.draw for each in writing.front if isinstance(each, Drawing)):
            return ON_PAGE_ONE
        return writing.figures.view(block.title, block.draw, _caption(block), place=place)
    return with_notes(table_view(block, LONGEST_TABLE[writing.detail]), writing.calculation.setup.model)


def with_notes(table: TableView, model: Model[Any, Any]) -> TableView:
    """Say what a quantity is where a cell is nothing but its name, and name columns without underscores."""
    known: dict[str, InputField | ResultField] = {**model.input_fields, **model.result_fields}

    def said(cell: Text) -> Text:
        field = known.get(cell) if isinstance(cell, str) else None
        return cell if field is None or not field.spec.note else label_of(field.spec.note, str(cell), field.symbol)

    columns = tuple(
        replace(column, title=column.title.replace("_", " ") if column.title in known else column.title)
        for column in table.columns
    )
    return replace(table, columns=columns, rows=tuple(tuple(map(said, row)) for row in table.rows))


def _caption(drawing: Drawing) -> str:
    return f"{drawing.title}. {drawing.caption}" if drawing.caption else drawing.title


def table_view(table: Table, most: int) -> TableView:
    """Write the cells of a plugin's table; what is left out is said."""
    shown = table.rows[:most]
    width = len(table.columns)
    rows = tuple(tuple([*map(_cell_text, row), *[""] * width][:width]) for row in shown)
    units = [unit_as_said(unit) for unit in (*table.units, *[""] * width)]
    cells = ([row[index] for row in shown if index < len(row)] for index in range(width))
    columns = tuple(
        Column(title, unit, "number" if shown and all(map(_is_numeric, column)) else "")
        for title, unit, column in zip(table.columns, units, cells, strict=False)
    )
    left = len(table.rows) - len(shown)
    note = " ".join(filter(None, [table.note, f"{left} further rows are not printed." if left else ""]))
    return TableView(table.title, columns, rows, note)


def _cell_text(cell: Any) -> str:
    """Write a number, a text, yes or no, or nothing."""
    if isinstance(cell, bool) or type(cell).__name__ == "bool":
        return "yes" if cell else "no"
    return format_number(cell, RESULT_DIGITS) if _is_numeric(cell) else str(cell)


def _is_numeric(cell: Any) -> bool:
    return cell is None or (isinstance(cell, (int, float)) and not isinstance(cell, bool)) or hasattr(cell, "dtype")


def numbered(chapters: Iterable[Chapter]) -> tuple[Chapter, ...]:
    """Give chapters their numbers and identifiers, in order; one inside another is numbered behind it: 4.1."""
    done: list[Chapter] = []
    outer = inner = 0
    for chapter in chapters:
        outer, inner = (outer, inner + 1) if chapter.inside and outer else (outer + 1, 0)
        number = f"{outer}.{inner}" if inner else str(outer)
        done.append(replace(chapter, number=number, ident=chapter.ident or f"chapter-{number.replace('.', '-')}"))
    return tuple(done)
