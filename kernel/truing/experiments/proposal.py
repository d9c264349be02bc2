"""What to measure next, of a diagnosis that leaves several explanations: an experiment, a further result, or a fact."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from math import ceil
from operator import attrgetter

import numpy as np

from truing.diagnosis.causes import Candidate
from truing.diagnosis.choice import Chosen
from truing.diagnosis.competition import Competition
from truing.diagnosis.conditional import look
from truing.diagnosis.exact import alone, fitting, held_without
from truing.diagnosis.findings import in_unit
from truing.diagnosis.fitted import Fit
from truing.diagnosis.ranking import lowest_first
from truing.diagnosis.result import Amount, Chance, DiagnosisResult, Experiment, NextPoint, readable_unit
from truing.diagnosis.sample import Sample
from truing.diagnosis.sentences import say
from truing.experiments.chances import Simulation
from truing.experiments.design import CHANCE, GROWTH, MORE, MOST_READINGS, Designed, Stand, designed
from truing.experiments.duels import Duel, explained, name_of
from truing.experiments.facts import joined_pairs, result_to_measure, tie_of
from truing.experiments.reach import reach_of
from truing.measurements.derived import TIME
from truing.numbers import format_number
from truing.units import from_si

MOST_DUELLING = 4
"""So many of the nearest rivals are to be told apart: their pairs are compared at every setting."""


def proposed(chosen: Chosen, answer: DiagnosisResult) -> DiagnosisResult:
    """Add to a diagnosis what to measure next: the readings of an experiment, a further result, and facts.

    The result comes first where an experiment leaves something open that it does not.
    """
    experiment, points, tied = next_experiment(chosen)
    explanations = rival_fits(chosen) if is_physical(chosen.best) else []
    asked, apart = result_to_measure(chosen.competition.sample.machine, explanations)
    left = [pair for pair in tied if frozenset(pair) not in apart]
    ties = tuple(tie_of(names, explanations, chosen.competition) for names in joined_pairs(left))
    if asked is not None:
        suffices = points and points[-1].needed <= len(points) and not tied
        points = [*points, asked] if suffices else [asked, *points]
    return replace(answer, next=tuple(points), ties=ties, experiment=experiment)


def next_experiment(chosen: Chosen) -> tuple[Experiment | None, list[NextPoint], list[tuple[str, str]]]:
    """Return the experiment that separates the winner and its rivals, its readings, and the pairs that none separates.

    Shapes that nobody registered say nothing beyond the rows they were fitted to, so they are no rivals here. Of
    results along an axis nothing is proposed: what could be set there is a whole record.
    """
    several = rival_fits(chosen)
    pairs = [(name_of(chosen.best), name_of(fit)) for fit in several[1:]] if is_physical(chosen.best) else []
    stand, best = designed_for(chosen)
    if stand is None or best is None:
        return None, [], pairs
    best, chance = grown(stand, best, chosen.competition, has_record=True)
    experiment, live = experiment_of(stand, best, chance)
    apart = {frozenset(pair) for pair in best.pairs}
    left = [pair for pair in pairs if frozenset(pair) not in apart]
    return experiment, list(points_of(stand, experiment, live)), left


def designed_for(chosen: Chosen) -> tuple[Stand | None, Designed | None]:
    """Return the best experiment for what a diagnosis leaves open, and what it is designed on."""
    several = rival_fits(chosen)
    stand = stand_of(chosen, several) if len(several) > 1 else None
    return stand, designed(stand) if stand is not None else None


def stand_of(chosen: Chosen, several: Sequence[Fit]) -> Stand | None:
    """Return what an experiment is designed on; None where nothing can be varied."""
    competition, sample = chosen.competition, chosen.competition.sample
    machine = sample.machine
    fields = machine.start.model.own_result_fields
    if any(fields[name].along for name in machine.records.measured) or machine.records.rows.series:
        return None
    reach = reach_of(machine)
    if not reach.quantities:
        return None
    roots = sample.roots(chosen.best.in_sample(sample).left)
    seen = [explained(fit.in_sample(sample), competition.extended, roots, has_record=True) for fit in several]
    return Stand(machine, competition.extended, seen, reach, np.array(list(_spreads(sample, chosen.best).values())))


def grown(stand: Stand, best: Designed, competition: Competition, *, has_record: bool) -> tuple[Designed, Chance]:
    """Return an experiment with as many readings as name the right explanation often enough, and its chance.

    The number of readings is chosen by one set of draws and the chance is that of another one: it is not the best of
    several.
    """
    apart = among(stand, {frozenset(pair) for pair in best.pairs})
    seed = stand.machine.start.seed

    def simulated(readings: int) -> Simulation:
        machine = stand.machine_of([best.courses], readings)
        return Simulation(competition, stand.several, apart, machine, has_record)

    needed = best.readings
    while needed <= MOST_READINGS and not simulated(needed).reaches(CHANCE, seed):
        more = min(stand.budget, ceil(GROWTH * needed))
        needed = more if needed < stand.budget else MORE * needed
    best = replace(best, readings=min(needed, stand.budget), needed=needed if needed <= MOST_READINGS else 0)
    return best, simulated(best.readings).chance(seed + 1)


def among(stand: Stand, apart: set[frozenset[str]]) -> frozenset[frozenset[int]]:
    """Return pairs of explanations by their places."""
    names = [name_of(each.fit) for each in stand.several]
    return frozenset(frozenset(names.index(name) for name in pair) for pair in apart)


def experiment_of(
    stand: Stand, best: Designed, chance: Chance, sizes: Mapping[str, Amount] | None = None
) -> tuple[Experiment, list[Duel]]:
    """Return an experiment as it is told, and the duels that it decides."""
    start, settings = stand.machine.start, stand.reach.columns([best.courses], best.readings)
    live = [duel for duel in stand.duels([best.courses], best.readings) if duel.names in best.pairs]
    clock, apart = settings.get(TIME), {frozenset(pair): pair for pair in reversed(best.pairs)}
    names = [name_of(each.fit) for each in stand.several]
    experiment = Experiment(
        tells=tuple(name for name in names if any(name in pair for pair in apart)),
        apart=tuple(apart.values()),
        courses=tuple(best.courses.values()),
        settings=settings,
        units={name: start.print_unit(name) for name in settings},
        takes=None if clock is None else Amount(float(clock[-1] - clock[0]), start.print_unit(TIME)),
        separation=min(duel.up_to(best.readings * len(stand.spreads)) for duel in live),
        needed=best.needed,
        chance=chance,
        results=tuple(stand.machine.records.measured),
        sizes=sizes or {},
        parted=tuple(duel.names for duel in live),
        gaps=tuple(duel.left[0].reshape(best.readings, -1) * stand.spreads for duel in live),
    )
    return experiment, live


def points_of(stand: Stand, experiment: Experiment, live: Sequence[Duel]) -> Iterator[NextPoint]:
    """Give the readings in their order: which pair is then least apart, and how far apart all are."""
    results = len(stand.spreads)
    for count in range(1, experiment.readings + 1):
        weakest = lowest_first(live, partial(Duel.up_to, values=(count - 1) * results))[0]
        why = _why(stand, experiment, count - 1, weakest)
        amounts = {
            name: Amount(float(values[count - 1]), experiment.units[name])
            for name, values in experiment.settings.items()
        }
        least = min(duel.up_to(count * results) for duel in live)
        yield NextPoint(amounts, weakest.names, why, least, needed=experiment.needed)


def is_physical(fit: Fit) -> bool:
    """Whether an explanation is made of effects and inputs alone, so that it says something at other settings."""
    return bool(fit.causes) and all(cause.is_registered for cause in fit.causes)


def rival_fits(chosen: Chosen) -> list[Fit]:
    """Return the winner, the winner under its other names and the first rivals, one fit for every name.

    Explanations with a shape that nobody registered are left out.
    """
    rivals = [rival.fit for rival in chosen.rivals if is_physical(rival.fit)][:MOST_DUELLING]
    own = [chosen.best, *_renamed(chosen)] if is_physical(chosen.best) else []
    by_name: dict[frozenset[str], Fit] = {}
    for fit in (*own, *rivals):
        by_name.setdefault(frozenset(fit.names), fit)
    return list(by_name.values())


def _renamed(chosen: Chosen) -> Iterator[Fit]:
    """Give the winner with one cause exchanged for each that draws the same curve, as large as that is here."""
    best, competition = chosen.best, chosen.competition
    for index, cause in enumerate(best.causes):
        for name in chosen.same.get(cause.tag, ()):
            others = [other for other in competition.causes if other.name == name and other.tag not in best.key]
            keys = [(best.key - {cause.tag}) | {other.tag} for other in others]
            fits = [competition.known[key] for key in keys if key in competition.known]
            fits = fits or [fit for other in others for fit in _exchanged(competition, best, index, other)]
            if fits:
                yield competition.best_first(fits, attrgetter("cost"))[0]


def _exchanged(competition: Competition, best: Fit, index: int, other: Candidate) -> Iterator[Fit]:
    """Give exact fits of an explanation with one cause exchanged for another, from where its curves say."""
    held = held_without(best, index, competition.sample, competition.extended)
    causes, values = held.causes, held.values
    seen = look(competition.curves, held, [other]).get(other.tag) if np.isfinite(held.left).all() else None
    for _, start in seen.starts if seen is not None else ():
        several, begun = (*causes[:index], other, *causes[index:]), (*values[:index], start, *values[index:])
        extended = competition.extended
        fit = alone(extended, fitting(competition.sample, extended, several, begun, held))
        if fit is not None:
            yield fit


def _spreads(sample: Sample, best: Fit) -> dict[str, float]:
    """Return the standard deviation of one new value of every result as the winner leaves it, SI."""
    squares = sample.squares(sample.left(best.predicted))
    return {each.name: each.scale * square**0.5 for each, square in zip(sample.channels, squares, strict=True)}


def _why(stand: Stand, experiment: Experiment, index: int, duel: Duel) -> str:
    """Say what makes a reading worth taking: how far the two then differ, and what leaves the record farthest.

    Only what the effects of the two explanations follow is looked at, where they follow anything.
    """
    start, covariates = stand.machine.start, stand.machine.records.covariates
    gaps = np.abs(duel.left[0].reshape(experiment.readings, -1)[index]) * stand.spreads
    best = int(np.argmax(gaps / stand.spreads))
    name = experiment.results[best]
    unit = readable_unit(start.print_unit(name), float(stand.spreads[best]))
    (one, other), size = duel.names, in_unit(float(gaps[best]), unit)
    words, reach = say("differ by", one=one, other=other, size=size, result=name), 0.05
    known = start.model.known_effects
    effects = [known[effect_name] for name in duel.names for effect_name in name.split(" + ") if effect_name in known]
    asked = {key for effect in effects for key in (*(need.name for need in effect.needs), *effect.reads)}
    for key in [setting for setting in experiment.settings if not asked or setting in asked]:
        covariate, value = covariates[key], float(experiment.settings[key][index])
        low, high = float(np.nanmin(covariate.values)), float(np.nanmax(covariate.values))
        out = max(low - value, value - high) / max(high - low, 1e-300)
        if out > reach:
            begin, end = format_number(float(from_si(low, covariate.unit)), 3), in_unit(high, covariate.unit, 3)
            said = {"one": one, "other": other, "size": size, "result": name}
            words, reach = say("differ beyond", **said, covariate=key, low=begin, high=end), out
    return words
