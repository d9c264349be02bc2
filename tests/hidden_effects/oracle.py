"""What the best possible diagnosis would predict: the true structure, fitted with the true covariance of the noise."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from hidden_effects.candidates import changes, stacked, tolerance_columns
from hidden_effects.cases import Case
from hidden_effects.press_machine import SCATTER, Array, Rows, shown
from hidden_effects.shapes import step_at

FARTHEST = 15  # rows between the true place of a step and one that is tried


def unknown_columns(case: Case, rows: Rows) -> Array:
    """Derivatives of the readings by everything that is unknown but the tolerances, at the truth.

    Amplitudes, time constants and the sizes of a shape. Where a step lies is tried place by place; which order a wave
    has is taken as known.
    """
    made = [np.zeros((len(rows) * len(case.results), 0))]
    if case.truth:
        made.append(case.true_columns(rows))
    if "warm_up" in case.hidden:
        made.append(_by_time_constant(case, rows)[:, None])
    if case.shape is not None:
        made.append(case.shape.columns(rows, case.results))
    return np.hstack(made)


def _by_time_constant(case: Case, rows: Rows) -> Array:
    warm = case.hidden["warm_up"]
    step = 1e-4 * warm["time_constant"]
    up, down = (
        changes(rows, case.results, {"warm_up": {**warm, "time_constant": warm["time_constant"] + way * step}}, {})
        for way in (1, -1)
    )
    return np.asarray((up - down) / (2 * step))


def oracle(case: Case) -> Array:
    """Predict the rows held out (without the first): generalised least squares, each tolerance with its prior."""
    weight = np.asarray(np.linalg.inv(case.record.covariance), dtype=float)
    return min((_fitted(assumed, weight) for assumed in _with_steps(case)), key=lambda fit: fit.misfit).predicted


@dataclass(frozen=True)
class _Fit:
    misfit: float
    predicted: Array


def _with_steps(case: Case) -> Iterator[Case]:
    """The case as it is; where it has a step, with the step in the middle of every gap between rows near its place."""
    if not _steps(case):
        yield case
    time = case.record.rows.time
    for after in (time[1:] + time[:-1]) / 2:
        for name, true in _steps(case).items():
            if np.sum((time > min(after, true)) & (time < max(after, true))) > FARTHEST:
                continue
            if name:
                moved = {**case.hidden["step"], name: float(after)}
                yield replace(case, hidden={**case.hidden, "step": moved})
            elif case.shape is not None:
                yield replace(case, shape=replace(step_at(float(after)), sizes=case.shape.sizes))


def _steps(case: Case) -> dict[str, float]:
    """When a step comes, by its unknown; that of a shape without a name."""
    found = {name: when for name, when in case.hidden.get("step", {}).items() if name.endswith("_after")}
    if case.shape is not None and case.shape.also == "step":
        found[""] = float(case.record.rows.time[np.argmax(case.shape.curve(case.record.rows) > 0)])
    return found


def _fitted(case: Case, weight: Array) -> _Fit:
    """Fit what is unknown, steps taken to be where they are said to be."""
    rows, count = case.record.rows, len(SCATTER)
    unknown, unknown_held = unknown_columns(case, rows), unknown_columns(case, case.held)
    lengths = np.linalg.norm(unknown, axis=0)
    unknown, unknown_held, lengths = unknown[:, lengths > 0], unknown_held[:, lengths > 0], lengths[lengths > 0]
    design = np.hstack([case.record.tolerances, unknown / lengths])
    held = np.hstack([tolerance_columns(case.held, case.results), unknown_held / lengths])
    prior = np.concatenate([np.ones(count), np.zeros(design.shape[1] - count)])
    truth = np.array([case.off[name] / sd for name, sd in SCATTER.items()])
    noise = stacked(case.readings, case.results) - case.true_readings(rows)
    pull = np.concatenate([truth, np.zeros(design.shape[1] - count)])
    error = _solved(design.T @ weight @ design + np.diag(prior), design.T @ (weight @ noise) - pull)
    left, machine = noise - design @ error, truth + error[:count]
    misfit = float(left @ weight @ left + machine @ machine)
    return _Fit(misfit, judged(case, case.true_readings(case.held) + held @ error))


def _solved(matrix: Array, right: Array) -> Array:
    """Solve a symmetric system whose unknowns differ by orders of magnitude in scale."""
    scale = 1 / np.sqrt(np.diag(matrix))
    return np.asarray(scale * np.linalg.lstsq(matrix * np.outer(scale, scale), scale * right, rcond=1e-12)[0])


def calibrated(case: Case, rounds: int = 0) -> dict[str, float]:
    """The base model, calibrated within its tolerances with the true noise: what its inputs are off.

    With ``rounds`` the misfit that is left is taken for noise, again and again: what is to be expected of whoever knows
    neither the noise nor that something is wrong; the calibration then stays nearer to the tolerances.
    """
    rows, design = case.record.rows, case.record.tolerances
    residual = stacked(case.readings, case.results) - stacked(shown(rows, {}, {}), case.results)
    found: Array = np.zeros(design.shape[1])
    grown: Array = np.ones(len(residual))
    for _ in range(rounds + 1):
        weighted = np.linalg.solve(case.record.covariance * np.outer(grown, grown), design)
        found = np.asarray(
            np.linalg.solve(design.T @ weighted + np.eye(len(found)), weighted.T @ residual), dtype=float
        )
        left = (residual - design @ found) * case.record.weight
        grown = np.asarray(
            np.repeat([max(rms(part), 1.0) for part in np.split(left, len(case.results))], len(rows)), dtype=float
        )
    return {name: float(sd * value) for (name, sd), value in zip(SCATTER.items(), found, strict=True)}


def judged(case: Case, values: Array) -> Array:
    """Leave the first row of every result out: it belongs to the record."""
    return np.concatenate([part[1:] for part in np.split(values, len(case.results))])


def scale(case: Case) -> Array:
    """The standard deviation of the noise at every judged row, by result."""
    return np.repeat([case.record.noise.sd[result] for result in case.results], len(case.held) - 1)


def rms(values: Array) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(values**2)))
