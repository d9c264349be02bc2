"""What is wrong with the residuals, in words with numbers and units: bias, trends, orders, steps, spread, outliers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from truing.diagnosis.contest import Contest
from truing.diagnosis.fit import Fit
from truing.diagnosis.gain import linear_prediction
from truing.diagnosis.hypotheses import Hypothesis
from truing.diagnosis.noise import SETTINGS
from truing.diagnosis.records import Covariate
from truing.diagnosis.result import Amount, Finding, Noise, Wrong
from truing.diagnosis.search import Solution, residuals_of
from truing.diagnosis.shapes import Shape
from truing.diagnosis.significance import Null
from truing.numbers import format_number
from truing.units import from_si

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Matrix = NDArray[np.float64]

SIGNIFICANT = 0.05
FAR = 4.0
LARGEST_COUNT = 4
NOTICEABLE = 0.1
BIASED = 3.0
SHOWN_DIGITS = 2
BETTER = 6.0
SHADOW = 0.3
WAVE_LEVEL = 0.001
"""Significance from which on a wave in what is left is visible, all frequencies and covariates paid for."""
FEWEST_PERIODS = 2
"""What turns more slowly in the whole record is a wander, which the noise filter has taken."""
FEWEST_OF_WAVE = 20
"""Readings below which any scatter looks like some wave."""


def in_unit(value: float, unit: str) -> str:
    """Write a difference with its unit, two digits."""
    number = format_number(float(from_si(value, unit)), SHOWN_DIGITS)
    return f"{number} {unit}".strip()


def wrong_of(full: Contest, best: Fit, null: Null, units: Mapping[str, str]) -> tuple[Wrong, ...]:
    """Describe every measured result: how far off, how much of it is noise, and what structure it has."""
    return tuple(_wrong(full, best, null, place, units) for place in range(len(full.evidence.channels)))


def _wrong(full: Contest, best: Fit, null: Null, place: int, units: Mapping[str, str]) -> Wrong:
    import numpy as np

    channel = full.evidence.channels[place]
    unit, rows = units[channel.name], channel.rows
    base = full.base()
    raw = residuals_of(full.problem.machine)[channel.name]
    before = (raw - linear_prediction(full, base, channel.name))[rows]
    after = (full.problem.machine.records.measured[channel.name] - best.predicted[channel.name])[rows]
    used = (len(best.values) + len(best.directions)) / len(full.evidence.channels)
    floor = float(np.sqrt(np.sum(after**2) / max(len(rows) - used, 1.0)))
    rmse = float(np.sqrt(np.mean(before**2)))
    share = max(0.0, 1 - floor**2 / rmse**2) if rmse > 0 and best.hypothesis.pieces else 0.0
    found = [
        *_bias(full, place, raw[rows], unit),
        *_with_named(full, best, null, place, list(_structure(full, null, place, unit))),
        *_of_noise(full, best, place),
        *_wave(full, best, place),
    ]
    noise = _noise(full, best, after, place, floor=floor, unit=unit)
    if noise.outliers:
        text = f"{len(noise.outliers)} suspected outliers, beyond four standard deviations of the noise"
        found.append(
            Finding("outlier", "", None, text if len(noise.outliers) > 1 else text.replace("outliers", "outlier"))
        )
    return Wrong(channel.name, len(rows), Amount(rmse, unit), Amount(floor, unit), share, noise, tuple(found))


def _bias(full: Contest, place: int, residual: Matrix, unit: str) -> Iterator[Finding]:
    """Say by how much the nominal model is off on average, and whether calibration within the tolerances takes it."""
    import numpy as np

    channel = full.evidence.channels[place]
    mean = float(np.mean(residual))
    spread = float(np.sqrt(np.mean(np.sum((channel.directions * channel.scale) ** 2, axis=1))))
    error = channel.scale / np.sqrt(len(residual) * SETTINGS[full.found.setting[0][place]].independent_share)
    if abs(mean) <= BIASED * error:
        return
    is_allowed = abs(mean) <= BIASED * spread
    if is_allowed:
        words = f"within what the tolerances allow ({in_unit(spread, unit)} standard deviation)"
    else:
        words = "more than the tolerances allow" if spread > 0 else "and no tolerance allows for it"
    yield Finding("bias", "", None, f"on average {in_unit(mean, unit)} off the nominal model, {words}", is_allowed)


def _structure(full: Contest, null: Null, place: int, unit: str) -> Iterator[Finding]:
    """Say what the residual of the calibrated model depends on; every p-value has paid for the whole search.

    Shapes that explain little beside the best explanation are its shadows (a jump has waves of every order).
    """
    found = full.found
    name = full.evidence.channels[place].name
    plain = max(float(found.score[0]), _constant_score(full, name))
    best: dict[tuple[str, ...], tuple[float, int]] = {}
    for number, hypothesis in enumerate(found.hypotheses):
        if len(hypothesis.pieces) != 1 or not _acts_on(full, hypothesis, name):
            continue
        label = _label(full, hypothesis)
        excess = float(found.score[number] - plain)
        if label and null.p_of(excess) <= SIGNIFICANT and excess > best.get(label, (-float("inf"), 0))[0]:
            best[label] = (excess, number)
    singles = {label[1]: excess for label, (excess, _) in best.items() if len(label) == 2}
    ranked = sorted(best.items(), key=lambda item: -item[1][0])
    kept = 0
    least = SHADOW * float(max(found.score) - plain)
    for label, (excess, number) in ranked:
        is_product = len(label) == 3
        if excess < least:
            continue
        if is_product and excess < max(singles.get(each, -float("inf")) for each in label[1:]) + BETTER:
            continue
        kept += 1
        if kept <= LARGEST_COUNT:
            yield _finding(full, number, null.p_of(excess), name, unit)


def _with_named(full: Contest, best: Fit, null: Null, place: int, found: list[Finding]) -> list[Finding]:
    """Add what the named causes follow, where no shape has shown it: a cause is a sharper eye than any shape."""
    name, problem = full.evidence.channels[place].name, full.problem
    excess = float(full.found.score[full.found.hypotheses.index(best.hypothesis)] - full.found.score[0])
    for piece in best.hypothesis.pieces:
        if piece.kind != "term" or not any(name in problem.columns[column].parts for column in piece.columns):
            continue
        candidate = problem.candidates[piece.owner]
        follows = [*(need.name for need in candidate.effect.needs), *candidate.effect.reads]
        for covariate in follows:
            if not any(covariate in finding.covariate.split(" and ") for finding in found):
                text = f"follows {covariate}, as {candidate.name} would"
                found.append(Finding("trend", covariate, null.p_of(excess), text))
    return found


def _constant_score(full: Contest, name: str) -> float:
    """Return the score of a mere constant on one result: what a trend must beat to be one."""
    candidates, found = full.problem.candidates, full.found
    own = [
        float(found.score[place])
        for place, hypothesis in enumerate(found.hypotheses)
        if hypothesis.kind == "one"
        and candidates[hypothesis.pieces[0].owner].name == "sensor_offset"
        and set(full.problem.columns[hypothesis.columns[0]].parts) == {name}
    ]
    return max(own, default=-float("inf"))


def _acts_on(full: Contest, hypothesis: Hypothesis, name: str) -> bool:
    """Tell whether a shape, an order or a step is one of this result alone."""
    piece = hypothesis.pieces[0]
    if piece.kind == "shape":
        return full.problem.shape_results[piece.owner][1] == (name,)
    if piece.kind != "term" or not full.problem.candidates[piece.owner].is_kernel:
        return False
    return set(full.problem.columns[piece.columns[0]].parts) == {name}


def _label(full: Contest, hypothesis: Hypothesis) -> tuple[str, ...]:
    """Return kind and covariates of a finding; nothing for what is none."""
    piece = hypothesis.pieces[0]
    if piece.kind == "shape":
        shape = full.problem.library.shapes[full.problem.shape_results[piece.owner][0]]
        return (shape.kind, *shape.depends_on)
    from truing.diagnosis.readings import followed_by

    candidate = full.problem.candidates[piece.owner]
    kinds = {"periodic_order": "order", "step": "step"}
    kind = kinds.get(candidate.name.partition("_of_")[0], "")
    return (kind, followed_by(candidate)) if kind else ()


def _finding(full: Contest, number: int, p_value: float, name: str, unit: str) -> Finding:
    hypothesis = full.found.hypotheses[number]
    piece = hypothesis.pieces[0]
    solution = full.solution(number)
    if piece.kind == "shape":
        shape = full.problem.library.shapes[full.problem.shape_results[piece.owner][0]]
        text = shape_in_words(full, shape, fitted_shape(full, solution, name), unit)
        kinds = {"trend": "trend", "product": "trend", "order": "order", "cycle": "trend", "step": "step"}
        return Finding(kinds[shape.kind], " and ".join(shape.depends_on), p_value, text)  # type: ignore[arg-type]
    label = _label(full, hypothesis)
    values = fitted_shape(full, solution, name)
    at = next(iter(full.problem.terms[piece.place].shape.values()))
    if label[0] == "order":
        text = f"order {at:g} of {label[1]}, amplitude {in_unit(_amplitude(values), unit)}"
        return Finding("order", label[1], p_value, text)
    item = full.problem.machine.records.covariates[label[1]]
    return Finding("step", label[1], p_value, f"step of {in_unit(_height(values), unit)} at {_place(item, at)}")


def fitted_shape(full: Contest, solution: Solution, name: str) -> Matrix:
    """Return what the columns of a solution add to one result, SI, on all rows of the records."""
    import numpy as np

    made = np.zeros(len(full.problem.machine.records))
    for column, value in zip(solution.hypothesis.columns, solution.coefficients, strict=True):
        item = full.problem.columns[column]
        if name in item.parts:
            made += item.parts[name] * (item.per * value)
    return made


def _amplitude(values: Matrix) -> float:
    import numpy as np

    return float(np.ptp(values)) / 2


def _height(values: Matrix) -> float:
    import numpy as np

    return float(values[np.argmax(np.abs(values))])


def _place(item: Covariate, at: float) -> str:
    return f"{item.name} = {format_number(float(from_si(at, item.unit)), 3)} {item.unit}".strip()


def shape_in_words(full: Contest, shape: Shape, values: Matrix, unit: str) -> str:
    """Describe a fitted shape: which order, where the step, which way the trend, where its turning point."""
    covariates = full.problem.machine.records.covariates
    name = shape.depends_on[0]
    if shape.kind == "order":
        return f"order {shape.detail:g} of {name}, amplitude {in_unit(_amplitude(values), unit)}"
    if shape.kind == "step":
        return f"step of {in_unit(_height(values), unit)} at {_place(covariates[name], shape.detail)}"
    if shape.kind == "cycle":
        return f"{shape.detail:g} waves over {name} per record, amplitude {in_unit(_amplitude(values), unit)}"
    if shape.kind == "product":
        first, second = shape.depends_on
        return f"depends on {first} and {second} together, range {in_unit(2 * _amplitude(values), unit)}"
    return _trend(covariates[name], values, unit)


def _trend(item: Covariate, values: Matrix, unit: str) -> str:
    """Describe a trend: rising or falling, or curved with its turning point."""
    import numpy as np

    order = np.argsort(item.values)
    curve, at = values[order], item.values[order]
    low, high = int(np.argmin(curve)), int(np.argmax(curve))
    size = in_unit(float(np.ptp(values)), unit)
    ends = abs(curve[-1] - curve[0]) / max(float(np.ptp(curve)), 1e-300)
    if ends > 0.9:
        way = "rises" if curve[-1] > curve[0] else "falls"
        return f"{way} with {item.name}, by {size} over the record"
    turning = low if 0 < low < len(curve) - 1 and abs(curve[low] - curve[0]) >= abs(curve[high] - curve[0]) else high
    kind = "lowest" if turning == low else "highest"
    return f"curved over {item.name}, {kind} at {_place(item, float(at[turning]))}, range {size}"


def _of_noise(full: Contest, best: Fit, place: int) -> Iterator[Finding]:
    """Say what the noise itself is like."""
    name = full.evidence.channels[place].name
    spread, setting = full.noise.spreads[name], SETTINGS[best.setting[place]]
    if spread.driver:
        yield Finding("spread", spread.driver, spread.p_value, f"the scatter {spread.words}")
    if setting.neighbours >= NOTICEABLE:
        words = f"neighbouring rows are alike (autocorrelation {setting.neighbours:.2f})"
        yield Finding("autocorrelation", "", None, words)


def _wave(full: Contest, best: Fit, place: int) -> Iterator[Finding]:
    """Say which wave is left over that no explanation drew, by Fisher's test of the largest ordinate of a periodogram.

    The innovations of the best explanation are put in the order of each covariate, so that a wave over it is one over
    the row; a covariate of fewer values than ``FEWEST_OF_WAVE`` orders nothing. Of m ordinates that are chance, the
    share of the largest is above g with a probability of at most
    ``m (1 - g)^(m - 1)`` (Fisher, Proc. R. Soc. A 125, 1929, the first term of his sum).
    """
    import numpy as np

    channel, left = full.evidence.channels[place], best.innovations[place]
    covariates = full.problem.machine.records.covariates.values()
    moved = [item for item in covariates if len(np.unique(item.values[channel.rows])) >= FEWEST_OF_WAVE]
    periods = np.arange(FEWEST_PERIODS, (len(left) - 1) // 2 + 1)
    if len(left) < FEWEST_OF_WAVE or not moved or not np.ptp(left):
        return
    found: list[tuple[float, str, int, float]] = []
    for item in moved:
        ordered = left[np.argsort(item.values[channel.rows], kind="stable")]
        power = np.abs(np.fft.rfft(ordered - ordered.mean()))[periods] ** 2
        share = float(power.max() / power.sum())
        p_value = min(1.0, len(moved) * len(periods) * (1 - share) ** (len(periods) - 1))
        found.append((p_value, item.name, int(periods[np.argmax(power)]), share))
    p_value, name, count, share = min(found)
    if p_value <= WAVE_LEVEL:
        words = f"{count} waves over the range of {name}, with {100 * share:.0f} % of what is left after all"
        yield Finding("wave", name, p_value, words)


def _noise(full: Contest, best: Fit, after: Matrix, place: int, *, floor: float, unit: str) -> Noise:
    """Describe the noise of one result, with the rows that lie beyond four standard deviations of it."""
    import numpy as np

    channel = full.evidence.channels[place]
    noise, setting = full.noise, SETTINGS[best.setting[place]]
    size = after * channel.weights
    sd = 1.4826 * float(np.median(np.abs(size - np.median(size))))
    records = full.problem.machine.records
    far = channel.rows[np.abs(size) > FAR * sd]
    outliers = tuple((records.files[int(records.file_of[row])], int(records.lines[row])) for row in far)
    spread = noise.spreads[channel.name].words
    tails = noise.tails[channel.name].words
    return Noise(Amount(floor, unit), setting.neighbours, tails, spread, outliers, setting.rho)
