"""How the outcome of a surrogate is written: results.json, which holds no times, and the sheet, which does."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from truing.declare.blocks import Block, Drawing, Table, Words
from truing.studies.demands import as_number
from truing.studies.drawings import BLUE, GREY, ORANGE, WIDTH, labelled
from truing.studies.reading import printed, printed_step, spoken

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from truing.studies.surrogate import Counted, Emulated
    from truing.studies.surrogate_answers import Judged
    from truing.studies.surrogate_runs import Speed

MOST_PANELS = 4


def emulated_json(emulated: Emulated) -> dict[str, Any]:
    """Return what results.json holds."""
    return {
        "of": list(emulated.of),
        "box": _box(emulated),
        "design": _points(emulated.sample),
        "held_out": _points(emulated.judges),
        "results": {name: _result(emulated, name) for name in emulated.of},
        "extrapolated": list(emulated.passed),
        "course": _course(emulated),
    }


def _box(emulated: Emulated) -> dict[str, Any]:
    found = {}
    for item in emulated.stand_in.box.features:
        unit = emulated.units[item.name]
        ends = {"low": printed(item.low, unit), "high": printed(item.high, unit), "unit": unit}
        found[item.name] = {**ends, "logarithmic": item.logarithmic, "sets": item.sets}
    return found


def _points(counted: Counted) -> dict[str, int]:
    return {"points": counted.points, "left_out": counted.left_out}


def _result(emulated: Emulated, name: str) -> dict[str, Any]:
    unit = emulated.units[name]
    emulator = emulated.stand_in.emulators[name]
    features = [item.name for item in emulated.stand_in.box.features]
    mean, low, high = (float(values[0]) for values in emulated.stand_in.bands({})[name])
    entry: dict[str, Any] = {"unit": unit}
    if name in emulated.judged:
        entry |= _accuracy(emulated.judged[name], unit)
    return entry | {
        "lengths": dict(zip(features, emulator.lengths, strict=True)),
        "noise": emulator.noise,
        "at_inputs": {
            "predicted": printed(mean, unit),
            "band95": [printed(low, unit), printed(high, unit)],
            "model": printed(emulated.own[name], unit),
        },
    }


def _accuracy(judged: Judged, unit: str) -> dict[str, Any]:
    import numpy as np

    return {
        "coverage95": judged.coverage,
        "interval95": list(judged.interval),
        "median_error": printed_step(np.median(judged.errors), unit),
        "largest_error": printed_step(judged.errors.max(), unit),
        "median_share": as_number(np.median(judged.shares)),
        "largest_share": as_number(judged.shares.max()),
        "share_of": "value" if judged.is_share else "range",
    }


def _course(emulated: Emulated) -> dict[str, Any] | None:
    course = emulated.course
    if course is None:
        return None
    results = {}
    for name in emulated.of:
        unit = emulated.units[name]
        mean, low, high = (printed(values[:: course.every], unit) for values in course.bands[name])
        model = printed(course.simulated[name], unit)
        results[name] = {"unit": unit, "model": model, "predicted": mean, "low": low, "high": high}
    unit = emulated.units[course.over]
    return {"over": course.over, "unit": unit, "at": printed(course.coarse, unit), "results": results}


def emulated_blocks(emulated: Emulated) -> Sequence[Block]:
    """Return the words on speed and loss, three tables and two figures."""
    blocks: list[Block] = []
    if emulated.speed is not None:
        blocks.append(Words(_verdict(emulated, emulated.speed), "finding"))
    if emulated.judged:
        blocks.append(_accuracy_table(emulated))
    if emulated.speed is not None:
        blocks.append(_speed_table(emulated, emulated.speed))
    blocks.append(_box_table(emulated))
    names = list(emulated.judged)[:MOST_PANELS]
    if names:
        caption = "Points that were held out; beside it how far each is off, with its 95 % band."
        blocks.append(Drawing("Surrogate over model", _agreement(emulated, names), caption))
    if emulated.course is not None:
        title = f"Surrogate along the {spoken(emulated.course.over)}"
        blocks.append(Drawing(title, _along(emulated, list(emulated.of)[:MOST_PANELS]), _said_of_course(emulated)))
    return blocks


def _verdict(emulated: Emulated, speed: Speed) -> str:
    """Say which way was faster, and what the faster one loses."""
    import numpy as np

    model, whole = _seconds(speed.model), _seconds(speed.making + speed.predictions)
    lost = ", ".join(
        f"{spoken(name)} by {100 * float(np.median(judged.shares)):.2g} % (median) and "
        f"{100 * float(judged.shares.max()):.2g} % (largest) of its {'value' if judged.is_share else 'range'}"
        for name, judged in emulated.judged.items()
    )
    work = f"For {speed.rows} calculations the model takes {model}, the surrogate {whole}, its making included"
    if speed.pays:
        return f"{work}: the surrogate was faster. It is off in {lost or 'nothing that was measured'}."
    return (
        f"{work}: running the model was faster, and loses nothing. The surrogate is off in {lost or 'nothing known'}."
    )


def _seconds(value: float) -> str:
    return f"{value:.3g} s"


def _accuracy_table(emulated: Emulated) -> Table:
    from truing.units import unit_text

    rows: list[list[Any]] = []
    for name, judged in emulated.judged.items():
        unit = emulated.units[name]
        found = _accuracy(judged, unit)
        shares = [100 * found[key] if found[key] is not None else None for key in ("median_share", "largest_share")]
        errors = [found["median_error"], shares[0], found["largest_error"], shares[1]]
        rows.append([name, unit_text(unit), judged.points, 100 * judged.coverage, *errors])
    whole = "value" if next(iter(emulated.judged.values())).is_share else "range of all values"
    columns = ("result", "unit", "points", "in the 95 % band", "median error", "share", "largest error", "share")
    note = f"At points the surrogate never saw. Percentages of errors are of the {whole}."
    return Table("What the surrogate loses", columns, rows, ("", "", "", "%", "", "%", "", "%"), note)


def _speed_table(emulated: Emulated, speed: Speed) -> Table:
    rows: list[list[Any]] = [
        [f"{emulated.sample.points} runs of the designed sample", speed.sample],
        ["learning from them", speed.fit],
        [f"{speed.rows} answers of the surrogate", speed.predictions],
        [f"{speed.rows} answers of the model", speed.model],
    ]
    never = "The surrogate never pays: the model answers faster than it does."
    even = (
        never
        if speed.break_even == float("inf")
        else f"It pays from about {float(f'{speed.break_even:.2g}'):.0f} calculations on."
    )
    part = (
        f" {speed.measured} of the model's were run, the rest is in proportion." if speed.measured < speed.rows else ""
    )
    note = f"On this machine, in one process. {even}{part}"
    return Table("Surrogate or model: which is faster?", ("work", "time"), rows, ("", "s"), note)


def _box_table(emulated: Emulated) -> Table:
    from truing.units import unit_text

    rows: list[list[Any]] = []
    emulators = emulated.stand_in.emulators
    for place, item in enumerate(emulated.stand_in.box.features):
        unit = emulated.units[item.name]
        scale = "logarithmic" if item.logarithmic else "even"
        lengths = [emulator.lengths[place] for emulator in emulators.values()]
        rows.append([item.name, printed(item.low, unit), printed(item.high, unit), unit_text(unit), scale, *lengths])
    columns = ("direction", "from", "to", "unit", "scale", *(f"length of {spoken(name)}" for name in emulators))
    note = "Lengths over the side of the box: over a short one the result turns, over a long one it is straight."
    return Table("Box of the surrogate", columns, rows, (), note)


def _agreement(emulated: Emulated, names: Sequence[str]) -> Callable[[], Figure]:
    """Draw predicted over simulated results, and beside it how far each is off with its band."""

    def draw() -> Figure:
        from matplotlib.figure import Figure

        figure = Figure(figsize=(WIDTH, 3.0 * len(names)), layout="constrained")
        panels = figure.subplots(len(names), 2, squeeze=False)
        for (left, right), name in zip(panels, names, strict=True):
            _draw_values(left, emulated.judged[name], name, emulated.units[name])
            _draw_errors(right, emulated.judged[name], name, emulated.units[name])
        return figure

    return draw


def _draw_values(panel: Any, judged: Judged, name: str, unit: str) -> None:
    from truing.units import from_si, unit_text

    model, mean = from_si(judged.simulated, unit), from_si(judged.predicted, unit)
    panel.plot(model, mean, "o", color=BLUE, markersize=3, label="surrogate")
    ends = [float(model.min()), float(model.max())]
    panel.plot(ends, ends, color=ORANGE, linewidth=0.9, label="model")
    panel.set_ylabel(labelled("by the surrogate", unit_text(unit)))
    if judged.is_share:
        panel.set_yscale("log")
    _finish(panel, judged, labelled(f"{name} by the model", unit_text(unit)))
    panel.legend(frameon=False)


def _draw_errors(panel: Any, judged: Judged, name: str, unit: str) -> None:
    """Draw errors in percent of the value, or of the range of all values."""
    import numpy as np

    from truing.units import from_si, unit_text

    ends = (judged.predicted, judged.low, judged.high)
    off, low, high = (100 * (values - judged.simulated) / judged.whole for values in ends)
    bars = np.abs([off - low, high - off])
    panel.errorbar(
        from_si(judged.simulated, unit), off, yerr=bars, fmt="o", color=BLUE, ecolor=GREY, markersize=3, elinewidth=0.8
    )
    panel.axhline(0.0, color=ORANGE, linewidth=0.9)
    panel.set_ylabel("off by, %")
    _finish(panel, judged, labelled(f"{name} by the model", unit_text(unit)))


def _finish(panel: Any, judged: Judged, label: str) -> None:
    if judged.is_share:
        panel.set_xscale("log")
    panel.set_xlabel(label)
    panel.grid(alpha=0.3)


def _along(emulated: Emulated, names: Sequence[str]) -> Callable[[], Figure]:
    """Draw the surrogate with its band along one input, and the model's own points."""

    def draw() -> Figure:
        from matplotlib.figure import Figure

        from truing.units import from_si, unit_text

        course = emulated.course
        assert course is not None  # drawn only where there is one
        over = emulated.units[course.over]
        figure = Figure(figsize=(WIDTH, 0.8 + 2.4 * len(names)), layout="constrained")
        panels = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
        for panel, name in zip(panels, names, strict=True):
            unit = emulated.units[name]
            mean, low, high = (from_si(values, unit) for values in course.bands[name])
            axis = from_si(course.axis, over)
            panel.fill_between(axis, low, high, color=BLUE, alpha=0.2, linewidth=0, label="95 % band")
            panel.plot(axis, mean, color=BLUE, label="surrogate")
            simulated = from_si(course.simulated[name], unit)
            panel.plot(from_si(course.coarse, over), simulated, "o", color=ORANGE, markersize=4, label="model")
            panel.set_ylabel(labelled(name, unit_text(unit)))
            panel.legend(frameon=False)
            panel.grid(alpha=0.3)
        panels[-1].set_xlabel(labelled(course.over, unit_text(over)))
        return figure

    return draw


def _said_of_course(emulated: Emulated) -> str:
    course = emulated.course
    assert course is not None  # drawn only where there is one
    counts: Mapping[str, tuple[int, int]] = {name: course.inside(name) for name in emulated.of}
    held = ", ".join(f"{inside} of {points} of {spoken(name)}" for name, (inside, points) in counts.items())
    others = [f"'{name}'" for name in emulated.passed if name != course.over]
    beyond = f" Outside the box in {' and '.join(others)}: extrapolated." if others else ""
    return f"All else as in the run. Of the model's points the band holds {held}.{beyond}"
