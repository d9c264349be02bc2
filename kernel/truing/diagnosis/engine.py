"""The diagnosis from records to answer: machine, what competes, search, decision, gain, next measurement.

Of a long record the search looks at some thousand rows, drawn evenly over it: one of every stretch of equal length, so
that no wave of the record is folded into another one by a regular step. The decision is that of these rows, and so is
what is said of sizes that would be visible and of how far apart two explanations lie, as if every row stood for as many
as it was drawn from; estimates, intervals and gains are those of all rows.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial

import numpy as np

from truing.arrays import one_thread
from truing.declare.near_miss import near_miss
from truing.diagnosis.causes import Candidate, effects_of, followed_by, inputs_of
from truing.diagnosis.choice import Chosen, Rival, choose, rivals_of
from truing.diagnosis.competition import Competition, Start, competition_of, search
from truing.diagnosis.extended import Extended, probe
from truing.diagnosis.findings import (
    alternative_of,
    by_share,
    calibrated_of,
    causes_of,
    extended_setup,
    in_unit,
    remainder_of,
    wrong_of,
)
from truing.diagnosis.gain import contradictions_of, gains_of, nested, thinned_of
from truing.diagnosis.learning import first_noise
from truing.diagnosis.machine import Calibration, calibration_of
from truing.diagnosis.records import FEWEST_READINGS, Records
from truing.diagnosis.result import UNKNOWN, Alternative, DiagnosisResult, ResultCurves, readable_unit
from truing.diagnosis.sample import sample_of
from truing.diagnosis.sentences import say
from truing.diagnosis.unregistered import shapes_of
from truing.diagnosis.visibility import alike_of, inseparable, smallest_visible, trades_of
from truing.errors import UsageError
from truing.setup import Setup
from truing.studies.bench import FINE, Progress, part_of, silent

LONG = 2500
"""A record of more readings is searched on about so many of them."""
Proposer = Callable[[Chosen, DiagnosisResult], DiagnosisResult]
"""Adds to an answer what to measure next."""
RANKED = 8
"""So many of the best explanations are fitted to all rows beside the chosen one and its rivals."""
TOO_ROUGH = 6**0.5
"""A step so many times what is left of the readings is half of it: its mean square is a twelfth of its own."""
SIZED = 4
"""Of so many alternatives it is told what their own fit says."""
STAGE_ENDS = {"columns": 0.05, "search": 0.75, "significance": 0.85, "gain": 1.0}
"""What share of the time has passed when each stage ends, for whoever waits."""


def searched(records: Records, *, seed: int) -> Records:
    """Return the rows that a search looks at: all of a record that is not long."""
    readings = sum(int(np.isfinite(values).sum()) for values in records.measured.values())
    if readings <= LONG or records.rows.series:
        return records
    rows = len(records) * LONG // readings
    edges = np.linspace(0, len(records), rows + 1).astype(np.intp)
    generator = np.random.Generator(np.random.SFC64(seed))
    return records.part(edges[:-1] + (generator.random(rows) * np.diff(edges)).astype(np.intp))


def on_all_rows(chosen: Chosen, machine: Calibration) -> Chosen:
    """Return what a search of some rows came to, fitted to all rows of a machine."""
    few = chosen.competition
    if len(few.sample.machine.records) == len(machine.records):
        return chosen
    sample = sample_of(machine, first_noise(machine), ~machine.records.held_out)
    competition = competition_of(Extended(machine), few.causes, sample)
    competition.stage, competition.extended.grain = "fits to all rows", few.extended.grain
    competition.extended.budget = few.extended.budget.of_rows(len(machine.records) / len(few.sample.machine.records))
    competition.tries = dict(few.tries)
    few.gains_seen = {}  # much, and needed no more
    rivals_there = [few.known[rival.fit.key] for rival in chosen.rivals]
    wanted = [few.known[chosen.best.key], *rivals_there, *few.ranked()[:RANKED]]
    competition.fit_each([Start(fit.causes, fit.values, None) for fit in {fit.key: fit for fit in wanted}.values()])
    competition.renew()
    competition.refresh()
    best = competition.exact(competition.known.get(chosen.best.key, competition.null))
    ends = [
        competition.exact(competition.known[rival.fit.key])
        for rival in chosen.rivals
        if rival.fit.key in competition.known
    ]
    rivals = rivals_of(competition, best, ends)
    return replace(chosen, competition=competition, best=best, rivals=rivals, of_some_rows=chosen)


def diagnose(
    setup: Setup, records: Records, *, progress: Progress | None = None, propose: Proposer | None = None
) -> DiagnosisResult:
    """Show what the model gets wrong on these records, name the cause, extend the model, measure the gain.

    ``propose`` adds what to measure next. The same records, setup and seed give the same answer. Raises UsageError
    where an option names what is not there.
    """
    _check_options(setup)
    told = progress or silent
    is_short = records.readings < FEWEST_READINGS  # what is calculated of them is not used
    with one_thread(), np.errstate(all="ignore" if is_short else None), _nothing_remembered(setup):
        machine = calibration_of(setup, records)
        told("columns", round(FINE * STAGE_ENDS["columns"]), FINE)
        few = searched(records, seed=setup.seed)
        competition = laid_out(machine if few is records else calibration_of(setup, few))
        probe(competition.extended, competition.causes)
        search(competition, part_of(told, "diagnosis", STAGE_ENDS["columns"], STAGE_ENDS["search"]))
        told("search", round(FINE * STAGE_ENDS["search"]), FINE)
        chosen = on_all_rows(choose(competition, seed=setup.seed), machine)
        told("significance", round(FINE * STAGE_ENDS["significance"]), FINE)
        answer = _answer(chosen, setup, told)
        if propose is not None:
            answer = propose(chosen, answer)
        spent, alone = competition.extended.budget.told(), _only_asked(setup, with_unknown=False)
        return replace(answer, hindrances=(*spent, *_too_rough(answer, chosen), *alone))


@contextmanager
def _nothing_remembered(setup: Setup) -> Iterator[None]:
    """Let nothing that was followed before, or in this diagnosis, move a digit of another answer."""
    memory = setup.model.dynamics.memory if setup.model.dynamics is not None else {}
    memory.clear()
    try:
        yield
    finally:
        memory.clear()


def laid_out(machine: Calibration) -> Competition:
    """Lay out what competes on the records of a machine, and fit the model as it is."""
    records, effects = machine.records, asked_for(effects_of(machine), machine.start)
    orders = {
        followed_by(cause.effect): range(int(number.low), int(number.high) + 1)
        for cause in effects
        if cause.is_kernel and cause.name.startswith("periodic_order")
        for number in cause.numbers
        if number.whole
    }
    has_steps = any(cause.is_kernel and cause.name == "step" for cause in effects)
    others = [*inputs_of(machine), *shapes_of(records, orders, has_steps=has_steps)]
    causes = [*effects, *asked_for(others, machine.start)]
    sample = sample_of(machine, first_noise(machine), ~records.held_out)
    return competition_of(Extended(machine), causes, sample)


def asked_for(causes: Sequence[Candidate], setup: Setup) -> list[Candidate]:
    """Return the causes that may compete, as ``[studies.diagnose] causes`` says; all where it says nothing."""
    wanted = setup.diagnose.causes
    return [cause for cause in causes if not wanted or cause.name in wanted]


def _only_asked(setup: Setup, *, with_unknown: bool) -> list[str]:
    """Say that others were not looked for. Where shapes that nobody registered competed, it speaks against nothing."""
    wanted = setup.diagnose.causes
    if not wanted or (UNKNOWN in wanted) is not with_unknown:
        return []
    return [say("only asked", causes=", ".join(wanted))]


def _check_options(setup: Setup) -> None:
    known = {*setup.model.known_effects, *setup.model.input_fields}
    known |= {f"{name}.{one.name}" for name, effect in setup.model.known_effects.items() for one in effect.unknowns}
    for name in setup.diagnose.per_file:
        if name not in known:
            near = near_miss(name, known)
            raise UsageError(f"[studies.diagnose] per_file: '{name}' is no effect, unknown or input.{near}")


def _answer(chosen: Chosen, setup: Setup, progress: Progress) -> DiagnosisResult:
    best = chosen.best
    machine = best.sample.machine
    units = units_of(chosen)
    causes = by_share(chosen, causes_of(chosen, best))
    judged = nested(chosen, part_of(progress, "diagnosis", STAGE_ENDS["significance"], STAGE_ENDS["gain"]))
    alternatives = [
        partial(alternative_of, chosen, rival, with_sizes=rank < SIZED) for rank, rival in enumerate(chosen.rivals)
    ]
    alike, notes = alike_of(chosen), (*_hard(chosen, units), *_only_asked(setup, with_unknown=True))
    progress("gain", FINE, FINE)
    return DiagnosisResult(
        setup=setup,
        records=replace(machine.records, notes=(*machine.records.notes, *notes)),
        measured=tuple(machine.records.measured),
        units=units,
        wrong=wrong_of(chosen, units),
        causes=causes,
        alternatives=tuple(chosen.competition.extended.side_by_side(alternatives)),
        remainder=remainder_of(chosen, units),
        seen=tuple(smallest_visible(chosen)),
        not_measured=_not_measured(machine),
        calibrated=calibrated_of(best),
        gain=gains_of(chosen, judged, units),
        stability=judged.stability,
        contradictions=contradictions_of(chosen),
        thinned=thinned_of(chosen),
        trades=trades_of(chosen),
        curves=tuple(_curves(chosen)),
        p_any=chosen.p_any,
        p_second=chosen.p_second,
        ranking=_ranking(chosen),
        inseparable=tuple(inseparable(machine, alike)),
        alike=alike,
        extended=extended_setup(chosen, causes) if best.causes else None,
    )


def _curves(chosen: Chosen) -> Iterator[ResultCurves]:
    """Give what the figures show of every result."""
    machine, before, after = chosen.best.sample.machine, chosen.null.predicted, chosen.best.predicted
    for name, values in machine.records.measured.items():
        rivals = tuple(rival.fit.predicted[name] for rival in chosen.rivals)
        yield ResultCurves(name, values, before[name], after[name], machine.base[name] + machine.shifts[name], rivals)


def _ranking(chosen: Chosen) -> tuple[Alternative, ...]:
    """Return the best explanations, the winner first, every one with how far it lies behind."""
    competition = chosen.competition
    others = [fit for fit in competition.ranked() if fit.key != chosen.best.key][: RANKED - 1]
    ranked = [Rival(chosen.best, 0.0), *rivals_of(competition, competition.known[chosen.best.key], others)]
    tasks = [partial(alternative_of, chosen, each) for each in ranked]
    return tuple(competition.extended.side_by_side(tasks))


def units_of(chosen: Chosen) -> dict[str, str]:
    """Return by result a unit in which its noise is neither tiny nor huge: 2.3 um rather than 0.0023 mm."""
    setup = chosen.best.sample.machine.start
    return {
        channel.name: readable_unit(setup.print_unit(channel.name), channel.scale)
        for channel in chosen.best.sample.channels
    }


def _hard(chosen: Chosen, units: Mapping[str, str]) -> list[str]:
    """Say where the model is rough, and at what share of the points that were tried it fails with an effect."""
    competition = chosen.competition
    rough = [
        say("rough", result=name, size=in_unit(grain, units[name]))
        for name, grain in competition.extended.grain.items()
    ]
    lost = [
        say("fails with", cause=name, share=f"{100 * lost / tried:.0f} %", lost=lost, tried=tried)
        for name, (lost, tried) in competition.curves.lost.items()
    ]
    return rough + lost


def _too_rough(answer: DiagnosisResult, chosen: Chosen) -> list[str]:
    """Say where the model itself is rougher than what is left of the readings, so that its steps may be the error."""
    grain = chosen.competition.extended.grain
    return [
        say("too rough", result=each.result, size=in_unit(grain[each.result], each.noise_floor.unit))
        for each in answer.wrong
        if grain.get(each.result, 0.0) > TOO_ROUGH * each.noise_floor.value
    ]


def _not_measured(machine: Calibration) -> Mapping[str, tuple[str, ...]]:
    absent = machine.records.absent
    effects = machine.start.model.known_effects.items()
    needs = {name: tuple(need.name for need in effect.needs if need.name in absent) for name, effect in effects}
    return {name: missing for name, missing in needs.items() if missing}
