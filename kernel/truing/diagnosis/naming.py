"""From the fitted explanation to what is reported: causes with intervals, alternatives, the remainder."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from truing.declare.sources import Unknown
from truing.diagnosis.contest import Contest, names_of
from truing.diagnosis.findings import fitted_shape, shape_in_words
from truing.diagnosis.fit import Fit, input_values, interval, si_covariance
from truing.diagnosis.hypotheses import Piece
from truing.diagnosis.profile import shape_interval
from truing.diagnosis.result import Alternative, Cause, FittedUnknown, Remainder, ShapeTerm
from truing.diagnosis.rivals import Rival
from truing.diagnosis.search import Solution
from truing.diagnosis.visibility import separation
from truing.setup import Setup, SwitchedOn

if TYPE_CHECKING:
    from truing.diagnosis.decide import Decision


def causes_of(full: Contest, best: Fit) -> tuple[Cause, ...]:
    """Return the named causes; parts of one effect (offsets of two gauges) are one cause."""
    by_name: dict[str, list[int]] = {}
    for place, piece in enumerate(best.hypothesis.pieces):
        if piece.kind == "term":
            by_name.setdefault(full.problem.candidates[piece.owner].name, []).append(place)
    found = [_cause(full, best, name, places) for name, places in by_name.items()]
    return (*found, *_inputs(full, best))


def _inputs(full: Contest, best: Fit) -> list[Cause]:
    """Return the inputs that lie outside their band, each with the interval of its value."""
    machine = full.problem.machine
    values = input_values(full, best)
    found = []
    for place, item in enumerate(best.parameters):
        piece = best.hypothesis.pieces[item.piece]
        if piece.kind != "input":
            continue
        given = machine.inputs[piece.owner]
        reach = (interval(best, place)[1] - best.si_value(place)) * given.sd
        value = values[given.name][0]
        unknown = FittedUnknown(given.name, value, value - reach, value + reach, machine.start.unit_of(given.name))
        found.append(Cause(f"input:{given.name}", (unknown,)))
    return found


def _cause(full: Contest, best: Fit, name: str, pieces: list[int]) -> Cause:
    problem = full.problem
    effect = problem.machine.start.model.known_effects[name]
    numbers = [number for number, item in enumerate(best.parameters) if item.piece in pieces]
    unknowns: list[FittedUnknown] = []
    kept: list[int] = []
    same = _same_curve(full, best, pieces)
    for unknown in effect.unknowns:
        own = [number for number in numbers if best.parameters[number].name == unknown.name]
        if own:
            unknowns.append(_fitted(full, best, unknown, own))
            kept.append(own[0])
        else:
            unknowns += _fixed(full, best, unknown, pieces)
    moving = [item.name for item in unknowns if any(best.parameters[number].name == item.name for number in kept)]
    covariance = si_covariance(best, kept) if len(moving) == len(unknowns) and not _is_split(unknowns) else ()
    return Cause(name, tuple(unknowns), covariance, tuple(other for other in same if other != name))


def _same_curve(full: Contest, best: Fit, pieces: list[int]) -> tuple[str, ...]:
    """Return the names of what may be the curve of these pieces as well, at the signs that they have."""
    found: list[str] = []
    for place in pieces:
        own = {item.column: float(value) for item, value in zip(best.parameters, best.values, strict=True)}
        piece = best.hypothesis.pieces[place]
        found += full.problem.same_curve(piece.owner, [own.get(column, 0.0) for column in piece.columns])
    return tuple(dict.fromkeys(found))


def _is_split(unknowns: list[FittedUnknown]) -> bool:
    return any(unknown.per_file for unknown in unknowns)


def _fitted(full: Contest, best: Fit, unknown: Unknown, own: list[int]) -> FittedUnknown:
    """Return an unknown with its interval; of one fitted file by file, the mean and every file's own."""
    files = full.problem.machine.records.files
    ends = [_ends(full, best, number) for number in own]
    values = [best.si_value(number) for number in own]
    if best.parameters[own[0]].file < 0:
        return FittedUnknown(unknown.name, values[0], *ends[0], unknown.unit)
    by_file = {
        files[best.parameters[number].file]: (value, *end) for number, value, end in zip(own, values, ends, strict=True)
    }
    return FittedUnknown(unknown.name, sum(values) / len(values), None, None, unknown.unit, by_file)


def _ends(full: Contest, best: Fit, number: int) -> tuple[float | None, float | None]:
    if best.parameters[number].is_shape:
        return shape_interval(full, best, number)
    return interval(best, number)


def _fixed(full: Contest, best: Fit, unknown: Unknown, pieces: list[int]) -> list[FittedUnknown]:
    """Return a shape that was chosen from its grid (a whole number, the place of a step), with its neighbours."""
    terms = full.problem.terms
    for place in pieces:
        piece = best.hypothesis.pieces[place]
        shape = terms[piece.place].shape
        if unknown.name in shape:
            grid = sorted({term.shape[unknown.name] for term in terms if term.candidate == piece.owner})
            at = grid.index(shape[unknown.name])
            low, high = grid[max(at - 1, 0)], grid[min(at + 1, len(grid) - 1)]
            value = shape[unknown.name]
            ends = (value, value) if unknown.whole else (low, high)
            return [FittedUnknown(unknown.name, value, *ends, unknown.unit)]
    return []


def switched_on(full: Contest, causes: tuple[Cause, ...]) -> tuple[SwitchedOn, ...]:
    """Return the named effects as they are switched on in the extended model; what was not excited is 0."""
    start = full.problem.machine.start
    known, before = start.model.known_effects, {item.effect.name: item.values for item in start.effects}
    found = []
    for cause in causes:
        if cause.effect.startswith("input:"):
            continue
        effect = known[cause.effect]
        values = {unknown.name: unknown.value for unknown in cause.unknowns}
        if not (effect.parts and effect.takes_any):
            values = {
                **dict.fromkeys((each.name for each in effect.unknowns), 0.0),
                **before.get(cause.effect, {}),
                **values,
            }
        sds = {}
        if cause.covariance:
            names = [unknown.name for unknown in cause.unknowns]
            sds = {name: cause.covariance[place][place] ** 0.5 for place, name in enumerate(names)}
        complete = cause.covariance if len(cause.unknowns) == len(values) > 1 else ()
        found.append(SwitchedOn(effect, values, sds, complete))
    return tuple(found)


def extended_setup(full: Contest, best: Fit, causes: tuple[Cause, ...]) -> Setup:
    """Return the model brought true: causes on, conditions as measured (their means), inputs calibrated."""
    import numpy as np

    machine = full.problem.machine
    needed = {need.name for item in switched_on(full, causes) for need in item.effect.needs}
    conditions = dict(machine.start.conditions)
    for name, item in machine.records.covariates.items():
        if name in conditions or name in needed:
            conditions[name] = float(np.nanmean(item.values))
    calibrated = {name: value for name, (value, _) in input_values(full, best).items()}
    setup = replace(machine.start, conditions=conditions).with_effects(switched_on(full, causes))
    inputs = machine.start.inputs
    return replace(setup, inputs=inputs, calibrated={**machine.start.calibrated, **calibrated})


def remainder_of(full: Contest, best: Fit, decision: Decision, units: Mapping[str, str]) -> Remainder | None:
    """Return the unregistered shape of the explanation in words, with its terms; None where there is none."""
    piece = next((item for item in best.hypothesis.pieces if item.kind == "shape"), None)
    if piece is None:
        return None
    place, results = full.problem.shape_results[piece.owner]
    shape = full.problem.library.shapes[place]
    alone = _alone(full.solution(decision.winner), piece)
    words = [shape_in_words(full, shape, fitted_shape(full, alone, name), units[name]) for name in results]
    named = [f"{name}: {word}" for name, word in zip(results, words, strict=True)]
    p_value = decision.p_any if len(best.hypothesis.pieces) == 1 else decision.p_second
    text = words[0] if len(words) == 1 else "; ".join(named)
    return Remainder(shape.depends_on, text, results, p_value, _terms(full, best, piece))


def _terms(full: Contest, best: Fit, piece: Piece) -> dict[str, tuple[ShapeTerm, ...]]:
    """Return the fitted terms of a shape by result, with coefficients in SI."""
    values = {item.column: float(value) for item, value in zip(best.parameters, best.values, strict=True)}
    bases = full.problem.library.bases
    first = min(column for each in full.problem.shape_pieces for column in each.columns)
    found: dict[str, list[ShapeTerm]] = {}
    for column in piece.columns:
        item = full.problem.columns[column]
        expression = bases[(column - first) % len(bases)].expression
        for name in item.parts:
            found.setdefault(name, []).append(ShapeTerm(expression, values[column] * item.per))
    return {name: tuple(terms) for name, terms in found.items()}


def _alone(solution: Solution, piece: Piece) -> Solution:
    """Return a solution with one of its pieces only, as it was fitted beside the others."""
    import numpy as np

    own = zip(solution.hypothesis.columns, solution.coefficients, strict=True)
    kept = [float(value) for column, value in own if column in piece.columns]
    only = replace(solution.hypothesis, pieces=(piece,))
    return replace(solution, hypothesis=only, coefficients=np.array(kept))


def alternative_of(full: Contest, winner: int, rival: Rival, *, with_sizes: bool = False) -> Alternative:
    """Return a rival explanation: how far behind, how separable, and on demand what its own fit says if it has one."""
    hypothesis = full.found.hypotheses[rival.place]
    true = full.solution(winner)
    depends: tuple[str, ...] = ()
    for piece in hypothesis.pieces:
        if piece.kind == "shape":
            depends = full.problem.library.shapes[full.problem.shape_results[piece.owner][0]].depends_on
    return Alternative(
        names_of(full.problem, hypothesis),
        rival.behind,
        separation(full, true, hypothesis),
        depends,
        {cause.effect: cause.unknowns for cause in causes_of(full, rival.own)} if with_sizes and rival.own else {},
        _same_as(full, full.solution(rival.place)),
    )


def _same_as(full: Contest, solution: Solution) -> dict[str, tuple[str, ...]]:
    """Return by cause the names of all that draw the same curve on this data, at the signs of a solution."""
    found: dict[str, tuple[str, ...]] = {}
    values = iter(solution.coefficients.tolist())
    for piece in solution.hypothesis.pieces:
        own = [next(values) for _ in piece.columns]
        if piece.kind == "term":
            name = full.problem.candidates[piece.owner].name
            others = (*found.get(name, ()), *full.problem.same_curve(piece.owner, own))
            found[name] = tuple(other for other in dict.fromkeys(others) if other != name)
    return {name: others for name, others in found.items() if others}
