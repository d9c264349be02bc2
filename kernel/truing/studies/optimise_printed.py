"""How an optimum is written: results.json, the sheet, and what must be said of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from truing.declare.blocks import Block, Cell, Drawing, Table, Words
from truing.studies.demands import as_number
from truing.studies.optimise_front import REFERENCE, SETTLED
from truing.studies.reading import printed, spoken

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from truing.studies.optimise import Design, Optimum

SHOWN = 20
FLAT = 1e-6
WIDEST = 7
"""So many columns with long names fit on A4 and letter."""


def optimum_json(optimum: Optimum) -> dict[str, Any]:
    """Return what results.json holds."""
    study = optimum.study
    entry: dict[str, Any] = {
        "status": optimum.status,
        "variables": {item.key: _variable_json(item) for item in optimum.variables},
        "objectives": {aim.name: {"sense": aim.sense, "unit": aim.unit} for aim in optimum.aims},
        "start": _design_json(optimum, optimum.start),
        "front": [_design_json(optimum, design) for design in optimum.front],
        "evaluations": optimum.evaluations,
        "failed": optimum.failed,
        "algorithm": study.algorithm,
        "population": study.population,
        "generations": study.generations,
        "chance": study.chance,
        "draws": study.draws if optimum.problem.cloud is not None else None,
        "surrogate": study.surrogate,
    }
    if optimum.knee is not None:
        entry["knee"] = _knee_json(optimum, optimum.knee)
    if optimum.volume is not None:
        volume = optimum.volume
        entry["hypervolume"] = {
            "reference": REFERENCE,
            "ideal": _by_aim(optimum, volume.ideal),
            "nadir": _by_aim(optimum, volume.nadir),
            "history": [as_number(value) for value in volume.history],
            "settled": volume.settled,
        }
    return entry


def _by_aim(optimum: Optimum, values: Sequence[float]) -> dict[str, Any]:
    return {aim.name: printed(aim.sign * value, aim.unit) for aim, value in zip(optimum.aims, values, strict=True)}


def _variable_json(item: Any) -> dict[str, Any]:
    from truing.fits import GRADES

    if item.kind == "grade":
        return {"kind": "grade", "finest": GRADES[round(item.low)], "coarsest": GRADES[round(item.high)]}
    return {
        "kind": {"number": "input", "whole": "whole", "width": "width"}[item.kind],
        "low": printed(item.low, item.unit),
        "high": printed(item.high, item.unit),
        "unit": item.unit,
    }


def _design_json(optimum: Optimum, design: Design) -> dict[str, Any]:
    return {
        "inputs": {name: printed(value, _input_unit(optimum, name)) for name, value in design.inputs.items()},
        "tolerances": {name: _width(optimum, name, value) for name, value in design.tolerances.items()},
        "objectives": {aim.name: printed(design.objectives[aim.name], aim.unit) for aim in optimum.aims},
        "margins": {name: as_number(value) for name, value in design.margins.items()},
        "chances": {name: as_number(value) for name, value in design.chances.items()},
        "feasible": design.feasible,
    }


def _knee_json(optimum: Optimum, knee: Design) -> dict[str, Any]:
    exact = {aim.name: printed(optimum.exact[aim.name], aim.unit) for aim in optimum.aims if aim.name in optimum.exact}
    tally = optimum.tally
    verified = {
        name: {"probability": share, "interval95": list(optimum.interval[name]), "draws": tally.draws if tally else 0}
        for name, share in optimum.verified.items()
    }
    return {
        "place": optimum.knee_place,
        "distance": as_number(optimum.distance),
        **_design_json(optimum, knee),
        "exact": exact,
        "verified": verified,
    }


def _input_unit(optimum: Optimum, name: str) -> str:
    return optimum.problem.setup.print_unit(name)


def _width_unit(optimum: Optimum, name: str) -> str:
    return next(item.unit for item in optimum.variables if not item.is_input and item.name == name)


def _width(optimum: Optimum, name: str, value: float | str) -> Any:
    return value if isinstance(value, str) else printed(value, _width_unit(optimum, name))


def optimum_blocks(optimum: Optimum) -> Sequence[Block]:
    """Return start against knee, the front, and the figures."""
    if optimum.knee is None:
        return [Words(f"{optimum.status[:1].upper()}{optimum.status[1:]}.", "finding"), _comparison(optimum)]
    blocks: list[Block] = [Words(_summary(optimum)), _comparison(optimum), *_undecided(optimum)]
    if len(optimum.front) > 1:
        blocks += [*fit_for_paper(_front(optimum)), Drawing("Front, start and knee", _drawn_front(optimum))]
    blocks.append(Drawing("Hypervolume over the generations", _drawn_history(optimum), _history_words(optimum)))
    return blocks


def _summary(optimum: Optimum) -> str:
    count, study = len(optimum.front), optimum.study
    what = f"{count} designs that no other beats" if count > 1 else "One design that no other beats"
    words = (
        f"{what}, from {optimum.evaluations} evaluated ({study.algorithm.upper()}, seed {optimum.problem.setup.seed})."
    )
    if optimum.problem.by_chance:
        how = f"with the same {study.draws} machines for every design" if study.chance == "draws" else "to first order"
        words += f" Chances are found {how}."
    if study.surrogate:
        words += " The surrogate answered in place of the model; the knee was run on the model itself."
    return f"{words} {_settled(optimum)}"


def _settled(optimum: Optimum) -> str:
    volume = optimum.volume
    assert volume is not None  # there is a front
    if volume.exhausted:
        return "The search ended when no design was left that it had not tried."
    way = "grew" if volume.gain >= 0 else "shrank"
    grown = f"the hypervolume {way} by {100 * abs(volume.gain):.2g} % in the last {volume.last} generations"
    return f"The search has settled: {grown}." if volume.settled else f"The search has not settled: {grown}."


def _comparison(optimum: Optimum) -> Table:
    """Set the stated design and the knee side by side: variables, objectives, limits."""
    start, knee = optimum.start, optimum.knee
    designs = [start] if knee is None else [start, knee]
    rows: list[list[Cell]] = []
    for name in start.inputs:
        unit = _input_unit(optimum, name)
        rows.append([name, "input", _text(unit), *(printed(item.inputs[name], unit) for item in designs)])
    for name, width in start.tolerances.items():
        unit, kind = ("", "grade") if isinstance(width, str) else (_width_unit(optimum, name), "full width")
        rows.append([name, kind, _text(unit), *(_width(optimum, name, item.tolerances[name]) for item in designs)])
    for aim in optimum.aims:
        values = [printed(item.objectives[aim.name], aim.unit) for item in designs]
        rows.append([aim.name, aim.sense, _text(aim.unit), *values])
    rows += [_limit_row(bound, designs) for bound in optimum.bounds]
    rows += _verified_rows(optimum)
    rows.append(["every limit is kept", "", "", *(item.feasible for item in designs)])
    columns = ("name", "", "unit", "start", "knee")[: 3 + len(designs)]
    return Table("Start and knee", columns, rows, note=_comparison_note(optimum))


def _limit_row(bound: Any, designs: Sequence[Design]) -> list[Cell]:
    if bound.by_chance:
        return [bound.name, "chance", "%", *(_percent(item.chances[bound.name]) for item in designs)]
    return [bound.name, "margin", "", *(as_number(item.margins[bound.name]) for item in designs)]


def _verified_rows(optimum: Optimum) -> Iterator[list[Cell]]:
    if optimum.tally is not None:
        for name, share in optimum.verified.items():
            yield [name, f"chance, {optimum.tally.draws} machines", "%", None, 100 * share]


def _comparison_note(optimum: Optimum) -> str:
    if optimum.knee is None:
        return ""
    if len(optimum.aims) == 1:
        return "With one objective the knee is the best design."
    if len(optimum.front) == 1:
        return "The front is a single design: it is the best in every objective."
    plane = "chord between the ends" if len(optimum.aims) == 2 else "plane through the ends"
    if optimum.distance <= FLAT:
        return f"The front has no knee: none of its designs lies before the {plane}. Shown is the nearest one."
    return f"The knee lies farthest from the {plane} of the front, each objective brought to 0 to 1."


def _percent(value: float) -> Any:
    return as_number(100 * value)


def _text(unit: str) -> str:
    from truing.units import unit_text

    return unit_text(unit)


def _front(optimum: Optimum) -> Table:
    """List the front, thinned evenly; its ends and the knee stay."""
    places = _thinned(len(optimum.front), optimum.knee_place or 0)
    first = optimum.front[0]
    inputs = [name for name in first.inputs if name not in first.objectives]
    chances = [bound.name for bound in optimum.problem.by_chance]
    rows: list[list[Cell]] = []
    for place in places:
        design = optimum.front[place]
        row: list[Cell] = [f"{place + 1} knee" if place == optimum.knee_place else str(place + 1)]
        row += [printed(design.objectives[aim.name], aim.unit) for aim in optimum.aims]
        row += [_percent(design.chances[name]) for name in chances]
        row += [printed(design.inputs[name], _input_unit(optimum, name)) for name in inputs]
        row += [_width(optimum, name, value) for name, value in design.tolerances.items()]
        rows.append(row)
    columns = ["design", *(aim.name for aim in optimum.aims), *chances, *inputs, *first.tolerances]
    units = ["", *(aim.unit for aim in optimum.aims), *("%" for _ in chances)]
    units += [_input_unit(optimum, name) for name in inputs]
    units += ["" if isinstance(width, str) else _width_unit(optimum, name) for name, width in first.tolerances.items()]
    left = len(optimum.front) - len(places)
    note = f"{len(places)} of {len(optimum.front)} designs; results.json holds all of them." if left else ""
    return Table("Front", columns, rows, units, note)


def fit_for_paper(table: Table) -> list[Table]:
    """Cut a table with more columns than a page has room for; the first column stands in every part."""
    count = len(table.columns)
    if count <= WIDEST:
        return [table]
    steps = range(1, count, WIDEST - 1)
    found = []
    for part, start in enumerate(steps, 1):
        places = [0, *range(start, min(start + WIDEST - 1, count))]
        title = f"{table.title}, part {part} of {len(steps)}"
        columns = [table.columns[place] for place in places]
        rows = [[row[place] for place in places] for row in table.rows]
        found.append(Table(title, columns, rows, [table.units[place] for place in places], table.note))
    return found


def _thinned(count: int, knee: int) -> list[int]:
    if count <= SHOWN:
        return list(range(count))
    steps = SHOWN - 1
    return sorted({*(round(step * (count - 1) / (steps - 1)) for step in range(steps)), knee})


def _drawn_front(optimum: Optimum) -> Callable[[], Figure]:
    """Draw the first objective against each of the others."""

    def draw() -> Figure:
        from matplotlib.figure import Figure

        from truing.studies.drawings import WIDTH, labelled

        first, others = optimum.aims[0], optimum.aims[1:]
        figure = Figure(figsize=(WIDTH, 0.4 + 3.2 * len(others)), layout="constrained")
        panels = figure.subplots(len(others), 1, squeeze=False)[:, 0]
        for panel, other in zip(panels, others, strict=True):
            _panel(panel, optimum, (first, other))
            panel.set_xlabel(labelled(first.name, _text(first.unit)))
            panel.set_ylabel(labelled(other.name, _text(other.unit)))
        panels[0].legend(frameon=False)
        return figure

    return draw


def _panel(panel: Any, optimum: Optimum, aims: tuple[Any, Any]) -> None:
    from truing.studies.drawings import BLUE, GREY, ORANGE

    def places(designs: Sequence[Design]) -> list[list[Any]]:
        return [[printed(design.objectives[aim.name], aim.unit) for design in designs] for aim in aims]

    line = "-" if len(optimum.aims) == 2 else ""
    panel.plot(
        *places(optimum.front), color=BLUE, marker="o", markersize=3.5, linewidth=0.8, linestyle=line, label="front"
    )
    start = optimum.start
    if all(start.objectives[aim.name] == start.objectives[aim.name] for aim in aims):
        label = "start" if start.feasible else "start, which misses a limit"
        face = GREY if start.feasible else "none"
        panel.plot(*places([start]), color=GREY, marker="s", markerfacecolor=face, linestyle="", label=label)
    if optimum.knee is not None:
        panel.plot(*places([optimum.knee]), color=ORANGE, marker="D", linestyle="", label="knee")
    panel.grid(alpha=0.3)


def _drawn_history(optimum: Optimum) -> Callable[[], Figure]:
    def draw() -> Figure:
        from matplotlib.figure import Figure

        from truing.studies.drawings import BLUE, WIDTH

        assert optimum.volume is not None  # there is a front
        history = optimum.volume.history
        figure = Figure(figsize=(WIDTH, 2.4), layout="constrained")
        panel: Any = figure.subplots()
        panel.plot(range(1, len(history) + 1), history, color=BLUE)
        panel.set_xlabel("generation")
        panel.set_ylabel("hypervolume")
        panel.grid(alpha=0.3)
        return figure

    return draw


def _history_words(optimum: Optimum) -> str:
    return (
        f"Of every generation's front, in the box of the last one (each objective 0 to 1), against the reference point "
        f"{REFERENCE:g} in each objective."
    )


def optimum_warnings(optimum: Optimum) -> Iterator[str]:
    """Say what was not found, what the exact model contradicts, and whether the search had settled."""
    yield from optimum.remarks
    if optimum.knee is None:
        yield optimum.status
        return
    if optimum.volume is not None and not optimum.volume.settled:
        yield (
            f"the hypervolume still grew by more than {100 * SETTLED:g} % in the last {optimum.volume.last} "
            "generations; ask for more generations"
        )
    yield from _contradicted(optimum)


def _contradicted(optimum: Optimum) -> Iterator[str]:
    """Name the goals that the knee misses when it is verified."""
    for name, goal, (low, high) in _goals(optimum):
        if high < goal:
            yield (
                f"the knee misses '{name}': machines that the search has not seen give {low:.5f} to {high:.5f} "
                f"of {goal:g}"
            )


def _undecided(optimum: Optimum) -> Iterator[Words]:
    """Say where the sampling error of the verification does not decide: an optimum stands at its limits."""
    for name, goal, (low, high) in _goals(optimum):
        if low < goal <= high:
            yield Words(
                f"Whether the knee reaches {goal:g} of {spoken(name)} lies within the sampling error of the "
                f"verification ({low:.5f} to {high:.5f}): it stands at this limit."
            )


def _goals(optimum: Optimum) -> Iterator[tuple[str, float, tuple[float, float]]]:
    for item in optimum.demands:
        if item.goal is not None:
            yield item.name, item.goal, optimum.interval[item.name]
