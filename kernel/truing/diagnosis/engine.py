"""The diagnosis from records to answer: machine, search, decision, exact fit, gain, next measurement."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from truing.declare.near_miss import near_miss
from truing.diagnosis.beside import second_beside_first
from truing.diagnosis.contest import Contest, contest
from truing.diagnosis.decide import Decision, decide, without_needless_inputs
from truing.diagnosis.design import next_points
from truing.diagnosis.findings import wrong_of
from truing.diagnosis.fit import Fit, fit, input_values, may_be_zero, shape_part
from truing.diagnosis.gain import Nested, nested, sign_flip_p
from truing.diagnosis.machine import machine_of
from truing.diagnosis.naming import alternative_of, causes_of, extended_setup, remainder_of
from truing.diagnosis.problem import Problem, problem_of
from truing.diagnosis.records import FEWEST_READINGS, Records
from truing.diagnosis.result import Alternative, Amount, Calibrated, Curves, Diagnosis, Gain
from truing.diagnosis.rivals import Rival, rivals_of
from truing.diagnosis.search import NoiseModel, first_noise, moved_to
from truing.diagnosis.second_look import second_look
from truing.diagnosis.shares import by_share
from truing.diagnosis.unmeasured import with_results
from truing.diagnosis.visibility import inseparable, smallest_visible
from truing.errors import UsageError
from truing.setup import Setup
from truing.studies.bench import FINE, Done, part_of, unheard
from truing.studies.threads import one_thread

if TYPE_CHECKING:
    from truing.studies.bench import Progress

RANKED = 8
FITTED = 4
SURELY = 30.0
"""Twice the log-likelihood by which a single cause whose interval holds zero must be better than none."""
LEAST_REDUCIBLE = 0.03
"""Less than this share of the noise is not told from it, so there is nothing to remove."""
SHARES = (0.0, 0.05, 0.35, 0.45, 0.5, 1.0)
"""What share of the time has passed when each stage ends, for whoever waits."""


def diagnose(setup: Setup, records: Records, *, progress: Progress | None = None) -> Diagnosis:
    """Show what the model gets wrong on these records, name the cause, extend the model, measure the gain.

    The same records, setup and seed give the same answer. Raises UsageError where an option names what is not there.
    """
    _check_options(setup)
    with one_thread():  # many small matrices: threads would only wait for one another
        return _diagnose(setup, records, _Steps(progress))


def _diagnose(setup: Setup, records: Records, step: _Steps) -> Diagnosis:
    """Go through the stages; of few readings in silence, since what is calculated of them is not used."""
    import numpy as np

    with np.errstate(all="ignore" if records.readings < FEWEST_READINGS else None):
        return _staged(setup, records, step)


def _staged(setup: Setup, records: Records, step: _Steps) -> Diagnosis:
    machine = machine_of(setup, records)
    raw = first_noise(machine)
    problem = problem_of(machine, raw.scales)
    step.done("columns")
    full = without_needless_inputs(contest(problem, raw, ~records.held_out, done=step.within()))
    step.done("search")
    decision = decide(full, seed=setup.seed)
    step.done("significance")
    best, decision = _certain(full, decision)
    for look in (second_look, second_beside_first):
        again = look(full, decision.winner, best, ~records.held_out)
        if again is not None:
            full = without_needless_inputs(again)
            decision = decide(full, seed=setup.seed)
            best, decision = _certain(full, decision)
    step.done("fit")
    raw = moved_to(raw, machine, full.problem.machine)
    answer = _answer(full, decision, best, raw, done=step.within())
    step.done("gain")
    extended = None if answer.extended is None else replace(answer.extended, inputs=setup.inputs)
    return replace(answer, setup=setup, extended=extended)


def _certain(full: Contest, decision: Decision) -> tuple[Fit, Decision]:
    """Fit the winner; a cause that may as well be zero is not named.

    Of a pair with such a cause only the best single explanation is kept; in the place of a single one comes the next
    best that explains as much as the search asks for, or nothing.
    """
    best = fit(full, decision.winner)
    if not _is_doubtful(full, decision.winner, best):
        return best, decision
    found, limit = full.found, full.found.score[0] + decision.thresholds.first
    singles = [place for place in found.ranked() if len(found.hypotheses[place].pieces) == 1]
    for place in [each for each in singles if found.score[each] > limit][:FITTED]:
        alone = fit(full, place)
        if not _is_doubtful(full, place, alone):
            return alone, replace(decision, winner=place)
    return fit(full, 0), replace(decision, winner=0)


def _is_doubtful(full: Contest, place: int, best: Fit) -> bool:
    """Whether some cause may as well be zero: by its intervals and, where it stands alone, by what it is worth.

    The interval of an amplitude that saturates may hold zero although nothing else will do.
    """
    found, pieces = full.found, best.hypothesis.pieces
    if len(pieces) == 1 and found.likelihood[place] - found.likelihood[0] >= SURELY:
        return False
    return any(may_be_zero(best, number) for number, piece in enumerate(pieces) if piece.kind == "term")


class _Steps:
    """Says how far a diagnosis has come, where anybody listens."""

    def __init__(self, progress: Progress | None) -> None:
        self.progress, self.count = progress, 0

    def done(self, what: str) -> None:
        """Count one stage."""
        self.count += 1
        if self.progress is not None:
            self.progress(what, round(FINE * SHARES[self.count]), FINE)

    def within(self) -> Done:
        """Return what reports the steps of the present stage."""
        if self.progress is None:
            return unheard
        return part_of(self.progress, "diagnosis", SHARES[self.count], SHARES[self.count + 1])


def _check_options(setup: Setup) -> None:
    known = {*setup.model.known_effects, *setup.model.input_fields}
    known |= {f"{name}.{one.name}" for name, item in setup.model.known_effects.items() for one in item.unknowns}
    for name in setup.diagnose.per_file:
        if name not in known:
            near = near_miss(name, known)
            raise UsageError(f"[studies.diagnose] per_file: '{name}' is no effect, unknown or input.{near}")


def _answer(full: Contest, decision: Decision, best: Fit, raw: NoiseModel, *, done: Done) -> Diagnosis:
    problem = full.problem
    machine, records, setting = problem.machine, problem.machine.records, best.setting
    units = units_of(full)
    causes = by_share(full, best, causes_of(full, best))
    remainder = remainder_of(full, best, decision, units)
    rivals = rivals_of(full, decision.winner, best)
    judged = nested(full, decision.winner, decision.thresholds, raw, done=done)
    wrong = wrong_of(full, best, decision.null, units)
    has_cause = bool(causes or remainder)
    fitted = [rival.own for rival in rivals if rival.own is not None]
    places = [rival.place for rival in rivals]
    points, ties = with_results(full, best, fitted, next_points(full, decision.winner, places))
    return Diagnosis(
        setup=machine.start,
        records=records,
        measured=tuple(records.measured),
        units=units,
        wrong=wrong,
        causes=causes,
        alternatives=tuple(
            alternative_of(full, decision.winner, rival, with_sizes=rank < FITTED) for rank, rival in enumerate(rivals)
        ),
        remainder=remainder,
        seen=tuple(smallest_visible(full, setting)),
        not_measured=_not_measured(problem),
        calibrated=_calibrated(full, best),
        gain=tuple(_gains(full, best, judged, units, has_cause=has_cause)),
        stability=judged.stability,
        next=tuple(points),
        ties=tuple(ties),
        curves=tuple(_curves(full, best)),
        p_any=decision.p_any,
        p_second=decision.p_second,
        ranking=_ranking(full, decision.winner),
        inseparable=tuple(inseparable(full, setting)),
        extended=extended_setup(full, best, causes) if has_cause else None,
    )


def _ranking(full: Contest, winner: int) -> tuple[Alternative, ...]:
    """Return the best explanations, the winner first, every one with how far it lies behind."""
    score, others = full.found.score, (place for place in full.found.ranked() if place != winner)
    ranked = [Rival(place, None, max(0.0, float(score[winner] - score[place]))) for place in [winner, *others][:RANKED]]
    return tuple(alternative_of(full, winner, each) for each in ranked)


def units_of(full: Contest) -> dict[str, str]:
    """Return by result a unit in which its noise is neither tiny nor huge: 2.3 um rather than 0.0023 mm."""
    from truing.diagnosis.readable import readable_unit

    setup = full.problem.machine.start
    return {
        channel.name: readable_unit(setup.print_unit(channel.name), channel.scale) for channel in full.evidence.channels
    }


def _not_measured(problem: Problem) -> Mapping[str, tuple[str, ...]]:
    machine = problem.machine
    absent = machine.records.absent
    found = {}
    for name, effect in machine.start.model.known_effects.items():
        missing = tuple(need.name for need in effect.needs if need.name in absent)
        if missing:
            found[name] = missing
    return found


def _calibrated(full: Contest, best: Fit) -> tuple[Calibrated, ...]:
    setup = full.problem.machine.start
    values = input_values(full, best)
    return tuple(Calibrated(name, value, setup.unit_of(name), moved) for name, (value, moved) in values.items())


def _curves(full: Contest, best: Fit) -> list[Curves]:
    from truing.diagnosis.gain import linear_prediction

    machine = full.problem.machine
    base = full.base()
    found = []
    for name, measured in machine.records.measured.items():
        before = machine.base[name] + linear_prediction(full, base, name) + machine.shifts[name]
        found.append(Curves(name, measured, before, best.predicted[name]))
    return found


def _gains(full: Contest, best: Fit, judged: Nested, units: Mapping[str, str], *, has_cause: bool) -> list[Gain]:
    """Say what the extension is worth for every result, on rows it has not seen."""
    import numpy as np

    found = []
    for place, channel in enumerate(full.evidence.channels):
        name, unit, item = channel.name, units[channel.name], judged.judged[channel.name]
        left = (full.problem.machine.records.measured[name] - best.predicted[name])[channel.rows]
        used = (len(best.values) + len(best.directions)) / len(full.evidence.channels)
        floor2 = float(left @ left) / max(len(left) - used, 1.0)
        before2, after2 = (float(np.nanmean(errors**2)) for errors in (item.before, item.after))
        reducible = before2 - floor2
        removed = (before2 - after2) / reducible if has_cause and reducible > LEAST_REDUCIBLE * floor2 else 0.0
        p_value = sign_flip_p(item.gain, judged.block_of, seed=full.problem.machine.start.seed + place)
        found.append(
            Gain(
                name,
                Amount(before2**0.5, unit),
                Amount(after2**0.5, unit),
                Amount(floor2**0.5, unit),
                min(removed, 1.0),
                float(np.nanmean(item.gain)),
                p_value,
                float(np.nanmean(item.inside)),
                _held_out(full, best, name),
            )
        )
    return found


def _held_out(full: Contest, best: Fit, name: str) -> tuple[float, float] | None:
    """Return root mean squares before and after on rows that were held out on request.

    An unregistered shape was fitted to its own record and says nothing of another one.
    """
    import numpy as np

    machine = full.problem.machine
    rows = machine.records.held_out & np.isfinite(machine.records.measured[name])
    if not rows.any():
        return None
    curve = next(item for item in _curves(full, best) if item.result == name)
    fitted_runs = np.unique(machine.records.run_of[~machine.records.held_out])
    is_other = ~np.isin(machine.records.run_of, fitted_runs)
    extended = curve.after - np.where(is_other, shape_part(full, best, name), 0.0)
    errors = [(curve.measured - values)[rows] for values in (curve.before, extended)]
    before, after = (float(np.sqrt(np.mean(error**2))) for error in errors)
    return before, after
