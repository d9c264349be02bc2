"""An experiment before any data exist: which readings would tell named causes apart, were one of them there.

What can be varied is what the causes follow, and the inputs that are declared to be set or to go on. The noise of a
reading is stated. A cause is as large as the inputs file says under ``[effects]``; else so large that it moves the
readings by some standard deviations, which the plan says.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isnan

import numpy as np

from truing.arrays import Matrix, one_thread
from truing.declare.goals import Vary
from truing.declare.near_miss import near_miss
from truing.declare.sources import SINCE_START, Condition
from truing.diagnosis.causes import INPUT, Candidate, effects_of, inputs_of
from truing.diagnosis.competition import competition_of
from truing.diagnosis.curves import middle
from truing.diagnosis.extended import Extended, probe
from truing.diagnosis.fitted import Fit
from truing.diagnosis.machine import Calibration, calibration_of
from truing.diagnosis.records import FEWEST_READINGS, Covariate, Records
from truing.diagnosis.result import Amount, Experiment
from truing.diagnosis.sample import NoiseModel, sample_of
from truing.errors import UsageError
from truing.experiments import BUDGET
from truing.experiments.design import LOOKED_AT, TRIED, Stand, designed
from truing.experiments.duels import explained
from truing.experiments.proposal import experiment_of, grown
from truing.experiments.reach import Quantity, Reach, range_of, role_of, tied_of
from truing.measurements import RowsFile
from truing.measurements.derived import TIME
from truing.setup import Setup
from truing.studies.reading import read_range
from truing.studies.sweep import Sweep
from truing.units import read_quantity
from truing.units.names import PURE

LEAST_BUDGET = 2
SIZE = 5.0
"""Standard deviations of a reading by which a cause of unknown size moves them, root mean square; of an input outside
of its tolerance, of these."""
SEEN = 1.0
"""A cause that moves no reading by so many standard deviations, at the ends of its bounds, cannot be seen."""
MOST_LISTED = 8
"""So many results are listed where none is named."""
SMALL = 1e-3
"""Share of its bound at which an amplitude is first tried."""


@dataclass(frozen=True)
class Planned:
    """What was planned; ``experiment`` is None where no run within reach tells the causes apart."""

    setup: Setup
    causes: tuple[str, ...]
    noise: Mapping[str, float]
    budget: int
    experiment: Experiment | None


def planned(setup: Setup, causes: Sequence[str], *, budget: int = BUDGET) -> Planned:
    """Design the experiment that tells causes apart, within a budget of readings, and simulate it.

    Raises UsageError for fewer than two causes, one that is unknown or that no reading shows, a budget below two, and
    where no noise is stated.
    """
    names, noise = tuple(dict.fromkeys(causes)), dict(setup.diagnose.noise)
    _check(setup, names, noise, budget)
    stated = {on.effect.name: on.values for on in setup.effects if on.effect.name in names}
    setup = replace(setup, effects=tuple(on for on in setup.effects if on.effect.name not in names))
    with one_thread(), np.errstate(all="ignore"):
        reach = reach_before(setup, names, budget)
        machine = _machine(setup, reach, noise, budget)
        extended = Extended(machine)
        several = {name: _candidates(machine, name) for name in names}
        probe(extended, [cause for each in several.values() for cause in each])
        sds = {name: NoiseModel(sd, *(np.ones(len(machine.records)),) * 2) for name, sd in noise.items()}
        sample = sample_of(machine, sds, np.ones(len(machine.records), dtype=bool))
        competition = competition_of(extended, [cause for each in several.values() for cause in each], sample)
        fits = [
            Fit(
                tuple(each), tuple(_sized(extended, each, noise, stated.get(name, {}))),
                np.zeros(sample.directions.shape[1]), dict(machine.base), np.zeros(sample.rows), 0.0, sample,
            )
            for name, each in several.items()
        ]  # fmt: skip
        seen = [explained(fit, extended, np.ones(sample.rows), has_record=False) for fit in fits]
        stand = Stand(machine, extended, seen, reach, np.array(list(noise.values())), budget, FEWEST_READINGS)
        best = designed(stand)
        if best is None:
            return Planned(setup, names, noise, budget, None)
        best, chance = grown(stand, best, competition, has_record=False)
        experiment, _ = experiment_of(stand, best, chance, _sizes(fits))
    return Planned(setup, names, noise, budget, experiment)


def _check(setup: Setup, names: Sequence[str], noise: Mapping[str, float], budget: int) -> None:
    """Raise UsageError with one sentence for what nothing can be planned for."""
    model = setup.model
    known = [*model.known_effects, *(f"{INPUT}{name}" for each in model.tolerances.values() for name in each.on)]
    for name in names:
        if name not in known:
            meant = near_miss(name, known)
            raise UsageError(f"{model.name} has no effect '{name}', and no tolerance of it as input:NAME.{meant}")
    if len(names) < LEAST_BUDGET:
        raise UsageError("an experiment tells two causes or more apart; name them, as in --causes one,other")
    if budget < LEAST_BUDGET:
        raise UsageError(f"a budget of {budget} readings tells nothing apart; allow {LEAST_BUDGET}, better twelve")
    if not noise:
        known = [name for name in model.measurable if not model.own_result_fields[name].along]
        results = ", ".join(known[:MOST_LISTED]) + (" ..." if len(known) > MOST_LISTED else "")
        raise UsageError(
            "no noise is known: state the standard deviation of one reading for every result that is measured, as "
            f"--noise RESULT=SD or under [studies.diagnose] noise (results: {results})"
        )
    for name in noise:
        if model.own_result_fields[name].along:
            raise UsageError(f"'{name}' runs along an axis; an experiment is planned for results of one value")


# What can be varied before anything was measured


def reach_before(setup: Setup, names: Sequence[str], budget: int) -> Reach:
    """Return what the machine can do: all that the causes follow, and the inputs that are declared to be varied.

    Raises UsageError for a condition of a cause whose range nothing tells.
    """
    effects = [setup.model.known_effects[name] for name in names if name in setup.model.known_effects]
    needs = {need.name: need for effect in effects for need in effect.needs}
    known = setup.model.known_conditions
    extra = [each for need in needs.values() for each in (need.made_from, need.rate, TIME if need.rate else "") if each]
    asked = [*needs, *extra, *(name for effect in effects for name in effect.reads), *setup.diagnose.box]
    fields = setup.model.input_fields
    asked += [name for name, field in fields.items() if getattr(field.spec, "role", "")]
    if any(role_of(setup, name) == "follows" for name in asked if name in known) and TIME in known:
        asked.append(TIME)
    there = [name for name in dict.fromkeys(asked) if name in known or (name in fields and fields[name].varies)]
    conditions = [known[name] for name in there if name in known]
    derived = [each for each in conditions if each.derived and each.history != SINCE_START and each.made_from in there]
    tied = tied_of(setup, conditions, dict.fromkeys(there)) if TIME in there else []
    made = {each.name for each in (*derived, *tied)}
    clock = _quantity(setup, TIME, budget, None) if TIME in there else None
    several = [clock if name == TIME else _quantity(setup, name, budget, clock) for name in there if name not in made]
    for name, quantity in zip([name for name in there if name not in made], several, strict=True):
        if quantity is None and name in needs:
            raise UsageError(f"nothing says where '{name}' can be measured; {_box_like(setup, name)}")
    quantities = tuple(quantity for quantity in several if quantity is not None)
    return Reach(quantities, tuple(derived), tuple((each, 0.0) for each in tied), {})


def _box_like(setup: Setup, name: str) -> str:
    return f'write [studies.diagnose] box = {{ {name} = "LOW..HIGH {setup.unit_of(name)}" }}'.replace(' "}', '" }')


def _quantity(setup: Setup, name: str, budget: int, clock: Quantity | None) -> Quantity | None:
    """Return a quantity as it may be varied; None where nothing tells its range."""
    condition, role = setup.model.known_conditions.get(name), role_of(setup, name)
    low, high = _range(setup, name)
    if isnan(low) or isnan(high) or high <= low:
        return None
    if role == "goes_on":
        pace = (high - low) / (8 * budget) if name == TIME else 0.0
        return Quantity(name, role, low, high, low, low, pace)
    nominal = float(setup.nominal(name))
    usual = min(max(nominal if not isnan(nominal) else low, low), high)
    levels = (low, high) if condition is not None and _is_sign(condition) else ()
    usual = high if levels else usual
    made = Quantity(name, role, low, high, usual, levels=levels)
    if role != "follows" or clock is None:
        return made
    return replace(made, slowness=(clock.high - clock.low) / (high - low), most=high - low)


def _is_sign(condition: Condition) -> bool:
    """Whether a condition is a sense, +1 or -1, with nothing between them."""
    return condition.history == "direction" or (condition.unit in PURE and (condition.low, condition.high) == (-1, 1))


def _range(setup: Setup, name: str) -> tuple[float, float]:
    """Return where a quantity can be measured: as asked for, as studies and goals vary it, or as it is declared."""
    if name in setup.diagnose.box:
        return setup.diagnose.box[name]
    unit = setup.unit_of(name)
    for study in setup.model.studies:
        if isinstance(study, Sweep) and study.over == name and study.at:
            values = read_range(study.at, unit, 2)
            return float(values.min()), float(values.max())
    for goal in setup.model.objectives:
        if isinstance(goal, Vary) and goal.input == name and not goal.by:
            return read_quantity(goal.low, unit), read_quantity(goal.high, unit)
    condition = setup.model.known_conditions.get(name)
    return (-1.0, 1.0) if condition is not None and condition.history == "direction" else range_of(setup, name, None)


def _machine(setup: Setup, reach: Reach, noise: Mapping[str, float], budget: int) -> Calibration:
    """Return the machine at readings of experiments drawn at random, as if it had been measured as it is."""
    generator = np.random.Generator(np.random.SFC64(1))
    choices = {quantity.name: quantity.courses(budget) for quantity in reach.quantities}
    drawn = [{name: each[int(generator.integers(len(each)))] for name, each in choices.items()} for _ in range(TRIED)]
    columns = reach.columns(drawn, LOOKED_AT)
    count = TRIED * LOOKED_AT
    covariates = {
        name: Covariate(name, values, setup.print_unit(name), "time" if name == TIME else "condition")
        for name, values in columns.items()
    }
    run_of = np.repeat(np.arange(TRIED), LOOKED_AT)
    records = Records(
        files=("plan",),
        rows=RowsFile("", columns, {}, {}, tuple(range(count)), runs=tuple(map(str, run_of.tolist()))),
        file_of=np.zeros(count, dtype=np.intp),
        run_of=run_of,
        lines=np.arange(count),
        measured={name: np.zeros(count) for name in noise},
        sigma={},
        covariates=covariates,
        held_out=np.zeros(count, dtype=bool),
    )
    machine = calibration_of(setup, records)
    return replace(machine, records=replace(records, measured=dict(machine.base)))


# The causes, and how large they are


def _candidates(machine: Calibration, name: str) -> list[Candidate]:
    """Return a cause, all parts of it. Raises UsageError where it cannot act on what is measured."""
    several = [cause for cause in (*effects_of(machine), *inputs_of(machine)) if cause.name == name]
    if not several:
        raise UsageError(_unseen(machine, name, "nothing that can be varied here brings it out"))
    return several


def _unseen(machine: Calibration, name: str, why: str) -> str:
    results = " or ".join(machine.records.measured)
    return f"'{name}' cannot be seen in {results}: {why}; measure another result (--noise), or vary more (box)"


def _sized(
    extended: Extended, causes: Sequence[Candidate], noise: Mapping[str, float], stated: Mapping[str, float]
) -> Iterator[Matrix]:
    """Give the numbers of every part of a cause, SI. Raises UsageError where no part shows."""
    machine = extended.machine
    is_seen = False
    for cause in causes:
        values = np.array([stated.get(number.name, middle(number)) for number in cause.numbers])
        own = [index for index in cause.amplitudes if cause.numbers[index].name not in stated]
        if cause.tolerated >= 0:
            values[:] = SIZE
        elif own:
            bounds = np.array([max(cause.numbers[i].high, cause.numbers[i].low, key=abs) for i in own])
            small = _moves(extended, cause, _with(values, own, SMALL * bounds), noise)
            values[own] = bounds * min(1.0, SMALL * SIZE / max(small, 1e-300))
        is_seen |= _moves(extended, cause, values, noise) >= SEEN
        yield values
    if not is_seen:
        raise UsageError(_unseen(machine, causes[0].name, "at its bounds it moves no reading by its noise"))


def _with(values: Matrix, places: Sequence[int], sizes: Matrix) -> Matrix:
    made = np.array(values)
    made[list(places)] = sizes
    return made


def _moves(extended: Extended, cause: Candidate, values: Matrix, noise: Mapping[str, float]) -> float:
    """Return by how many standard deviations of a reading a cause moves the readings, root mean square."""
    machine = extended.machine
    (shown,) = extended.at([cause], [([values], np.zeros(len(machine.inputs)))])
    squares = [((shown[name] - machine.base[name]) / sd) ** 2 for name, sd in noise.items()]
    return float(np.sqrt(max(np.nanmean(each) for each in squares)))


def _sizes(fits: Sequence[Fit]) -> dict[str, Amount]:
    """Return the believed numbers of all causes, by "EFFECT.UNKNOWN"."""
    made = {}
    for fit in fits:
        for cause, values in zip(fit.causes, fit.values, strict=True):
            units = {unknown.name: unknown.unit for unknown in cause.effect.unknowns} if cause.effect else {}
            for number, value in zip(cause.numbers, values.tolist(), strict=True):
                if cause.effect is not None:
                    made[f"{cause.name}.{number.name}"] = Amount(value, units[number.name])
                else:
                    tolerated = fit.sample.machine.inputs[cause.tolerated]
                    shifted = tolerated.design + tolerated.mean + value * tolerated.sd
                    made[cause.name] = Amount(shifted, fit.sample.machine.start.unit_of(tolerated.name))
    return made
