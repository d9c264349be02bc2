"""Do the settings that a diagnosis proposes separate what it could not tell apart? Against chance, and the best chance.

A pair is the truth and another explanation that the diagnosis left open. The separation after further rows is
``min_c`` of the whole deviance, the rival refitted to all rows, the machine within its tolerances throughout.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from hidden_effects.candidates import HOUR, Candidate, columns, tolerance_columns
from hidden_effects.cases import APART, Case
from hidden_effects.outcome import FIRST, is_alternative, is_exact
from hidden_effects.press_machine import Array, Rows
from truing.units import to_si

POINTS = 4
SETS = 200
BOX = {  # where the press can be set, SI; the crank angle as the inputs file of a case says, all else as declared
    "crank_angle": (-np.pi / 3, np.pi / 3), "forming_force": (-200e3, 2000e3), "link_temperature": (15.0, 60.0),
    "time": (0.0, 10 * HOUR), "strokes": (0.0, 1e6), "speed": (5 / 60, 1.0), "direction": (-1.0, 1.0),
}  # fmt: skip


def asked(case: Case, document: Mapping[str, Any]) -> dict[str, Any] | None:
    """What four points would have done for the first pair that was left open; None where there is no such pair."""
    rival = open_rival(case, document)
    if rival is None:
        return None
    proposed = _points(case, document["next"][:POINTS])
    rng = np.random.default_rng([case.seed, 7])
    drawn = _random(POINTS * SETS, rng)
    problems = list(_problems(case, rival, _joined(proposed, drawn)))
    if _left(problems, []) >= APART:
        return None
    many = len(proposed)
    sets = [list(range(many + POINTS * at, many + POINTS * (at + 1))) for at in range(SETS)]
    found = [_left(problems, each) for each in sets]
    after = _left(problems, range(many))
    return {
        "rival": list(rival), "before": _left(problems, []), "points": many, "proposed": after,
        "random_share": float(np.mean(np.array(found) > APART)), "best_random": max(found), "best": max(*found, after),
    }  # fmt: skip


def open_rival(case: Case, document: Mapping[str, Any]) -> tuple[str, ...] | None:
    """The names of the first registered explanation beside the truth in an answer that leaves both open."""
    if case.shape is not None or not case.truth or not document["alternatives"] or not document["causes"]:
        return None
    others = document["alternatives"][:FIRST]
    if is_exact(case, document):
        named = [tuple(other["causes"]) for other in others if "unknown" not in other["causes"]]
    else:
        is_open = any(is_alternative(case, other) for other in others) and document["remainder"] is None
        named = [tuple(cause["effect"] for cause in document["causes"])] if is_open else []
    true = set().union(*(case.record.effects_of(name) for name in case.truth))
    known = {candidate.effect for candidate in case.record.candidates}
    kept = [names for names in named if not set(names) <= true and set(names) <= known]
    return kept[0] if kept else None


def _points(case: Case, proposed: Sequence[Mapping[str, Any]]) -> Rows:
    """The settings that were proposed; what they leave open stays at the middle of the record."""
    rows = {name: np.full(len(proposed), float(np.median(values))) for name, values in vars(case.record.rows).items()}
    for at, point in enumerate(proposed):
        for name, amount in point["settings"].items():
            value = float(to_si(amount["value"], amount["unit"]))
            rows[name][at] = value - 273.15 if name == "link_temperature" else value
    return Rows(**rows)


def _random(count: int, rng: np.random.Generator) -> Rows:
    """Points anywhere in the box."""
    rows = {name: rng.uniform(low, high, count) for name, (low, high) in BOX.items()}
    return Rows(**{**rows, "direction": np.where(rows["direction"] < 0, -1.0, 1.0)})


def _joined(*parts: Rows) -> Rows:
    return Rows(**{name: np.concatenate([getattr(part, name) for part in parts]) for name in vars(parts[0])})


@dataclass(frozen=True)
class Problem:
    """One rival with its shapes chosen: the record as a least squares problem in summed form, and further points.

    The matrix (k, k), right side (k,) and sum of squares of the record; design (results, points, k) and change
    (results, points) of the points, over their noise.
    """

    matrix: Array
    right: Array
    total: float
    design: Array
    change: Array

    def left(self, points: Sequence[int]) -> float:
        """The separation once these points are measured too."""
        chosen = list(points)
        design = self.design[:, chosen].reshape(-1, self.design.shape[2])
        change = self.change[:, chosen].reshape(-1)
        matrix, right = self.matrix + design.T @ design, self.right + design.T @ change
        scale = 1 / np.sqrt(np.maximum(np.diag(matrix), 1e-30))
        solved = np.linalg.solve(matrix * np.outer(scale, scale) + 1e-12 * np.eye(len(scale)), scale * right)
        return self.total + float(change @ change) - float(solved @ (scale * right))


def _left(problems: Sequence[Problem], points: Sequence[int]) -> float:
    """The separation from a rival whatever its shapes."""
    return min(problem.left(points) for problem in problems)


def _problems(case: Case, rival: Sequence[str], points: Rows) -> Iterator[Problem]:
    """Give the rival with every choice of its shapes."""
    record, change = case.record, case.change
    weight = np.asarray(np.linalg.inv(record.covariance), dtype=float)
    tolerances = tolerance_columns(points, case.results)
    sds = np.array([record.noise.sd[result] for result in case.results])[:, None]
    further = np.array(np.split(case.change_at(points), len(sds))) / sds
    for choice in product(*(_of_name(case, name) for name in rival)):
        made = [
            np.hstack([columns(rows, case.results, candidate, shapes) for candidate, shapes in choice])
            for rows in (record.rows, points)
        ]
        scale = np.linalg.norm(made[0], axis=0) + np.linalg.norm(made[1], axis=0)
        old = np.hstack([record.tolerances, made[0] / np.where(scale > 0, scale, 1.0)])
        new = np.hstack([tolerances, made[1] / np.where(scale > 0, scale, 1.0)])
        prior = np.arange(old.shape[1]) < record.tolerances.shape[1]
        weighted = old.T @ weight
        matrix, total = weighted @ old + np.diag(prior), float(change @ weight @ change)
        yield Problem(matrix, weighted @ change, total, np.array(np.split(new, len(sds))) / sds[:, :, None], further)


def _of_name(case: Case, name: str) -> list[tuple[Candidate, dict[str, float]]]:
    """Every candidate of this effect with every choice of its shapes; one of several parts is enough."""
    fits = [candidate for candidate in case.record.candidates if candidate.effect == name]
    return [(candidate, shapes) for candidate in fits for shapes in candidate.variants()]
