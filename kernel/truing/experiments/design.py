"""The experiment that tells most: every quantity gets the course that is worth most, the others held to theirs.

Courses are few (held at a level, from one end to the other, there and back, both ends in turn), so that an experiment
can be said in a sentence and run. From the best of some drawn at random every quantity in turn takes the course that
gains most, less a little for what is harder to run: what gains nothing is held.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from truing.arrays import Matrix
from truing.diagnosis.extended import Extended, elsewhere
from truing.diagnosis.machine import Calibration
from truing.diagnosis.ranking import lowest_first
from truing.diagnosis.result import APART, Course
from truing.experiments import BUDGET
from truing.experiments.duels import Duel, Explained, duels, machine_there
from truing.experiments.reach import Reach

FEWEST = 4
"""So many readings are proposed at most where nothing else is asked for, and so many at least."""
LOOKED_AT = 6
"""Readings of an experiment while it is looked for: each stands for as many as are asked for."""
TRIED, TRIED_FEW = 96, 12
"""So many experiments are drawn at random, and so many where calls of the model are dear."""
PASSES = 2
"""So often every quantity is gone through."""
ENOUGH = 33.0
"""Separation that names the right one with 95 %: twice the log likelihood has it as mean and twice its root as standard
deviation, and another explanation is excluded ``SURE`` = 1.22 of these behind: 33 = (1.64 + 1.22) * 2 * 33^0.5."""
NEARLY = 0.95
"""Of the most that readings like these can reach, where that is less."""
CHANCE, GROWTH = 0.95, 1.5
"""An experiment grows until its simulated chance is as high, so many times in one step, as far as the budget goes."""
MORE = 2
"""So many times more readings are simulated, up to ``MOST_READINGS``, where the budget does not suffice."""
MOST_READINGS = 100
"""Nobody takes more: what so many readings do not tell apart is told apart by a fact, or not at all."""
EFFORT: Mapping[str, float] = {"held": 0.0, "ramp": 0.1, "in turn": 0.15, "to and fro": 0.15}
"""What a course must be worth, in the logarithm of the separation, to be taken before a plainer one: a tenth of it."""
ELSEWHERE, LATER, BROUGHT = 0.03, 0.1, 0.1
"""The same for what is held where it usually is not, or goes downward, for a history that goes farther than it must,
and for what has to be brought to its start first, which is a ramp before the experiment."""


@dataclass(frozen=True)
class Stand:
    """What an experiment is designed on: explanations, what the machine can do, the noise of one value (R,), SI."""

    machine: Calibration
    extended: Extended
    several: Sequence[Explained]
    reach: Reach
    spreads: Matrix
    budget: int = BUDGET
    fewest: int = FEWEST

    def machine_of(self, experiments: Sequence[Mapping[str, Course]], readings: int) -> Calibration:
        """Return the machine at the readings of some experiments."""
        return machine_there(self.machine, self.reach.columns(experiments, readings), readings)

    def duels(self, experiments: Sequence[Mapping[str, Course]], readings: int = LOOKED_AT) -> list[Duel]:
        """Set up all duels over some experiments."""
        tried = elsewhere(self.extended, self.machine_of(experiments, readings))
        return list(duels(self.several, tried, self.spreads, readings))

    @cached_property
    def courses(self) -> dict[str, list[Course]]:
        """What every quantity may do, the plainest first."""
        return {quantity.name: quantity.courses(self.budget) for quantity in self.reach.quantities}


@dataclass(frozen=True)
class Designed:
    """An experiment as found, the pairs that it is for, and how many readings like these it would need; 0: too many."""

    courses: Mapping[str, Course]
    readings: int
    pairs: tuple[tuple[str, str], ...]
    needed: int = 0


def designed(stand: Stand) -> Designed | None:
    """Return the best experiment for all pairs that any experiment decides; None where none decides any."""
    choices = stand.courses
    plain = {name: courses[0] for name, courses in choices.items()}
    generator = np.random.Generator(np.random.SFC64(0))
    few = stand.extended.budget.is_dear
    first = [plain, *({name: each[int(generator.integers(len(each)))] for name, each in choices.items()}
                      for _ in range(TRIED_FEW if few else TRIED))]  # fmt: skip
    ends = [plain | {name: course} for name, each in choices.items() for course in each[1:]] if not few else []
    fought = stand.duels([*first, *ends])
    pairs = _decided({duel.names: float(np.max(duel.after(MOST_READINGS / LOOKED_AT))) for duel in fought})
    if not pairs:
        return None

    def worth(experiments: Sequence[Mapping[str, Course]], fought: Sequence[Duel]) -> Matrix:
        live = [duel for duel in fought if duel.names in pairs]
        gained = np.mean([np.log1p(duel.after(stand.budget / LOOKED_AT)) for duel in live], axis=0)
        return np.asarray(gained - np.array([_effort(stand, courses) for courses in experiments]))

    best = _most_worth([*first, *ends], worth([*first, *ends], fought))
    for _ in range(0 if few else PASSES):
        before = best
        for name, courses in choices.items():
            tried = [best | {name: course} for course in courses]
            best = _most_worth(tried, worth(tried, stand.duels(tried)))
        if best == before:
            break
    return _sized(stand, best, pairs)


def _most_worth(experiments: Sequence[dict[str, Course]], worth: Matrix) -> dict[str, Course]:
    return experiments[lowest_first(range(len(worth)), lambda index: -float(worth[index]))[0]]


def _decided(separations: Mapping[tuple[str, str], float]) -> set[tuple[str, str]]:
    """Return the pairs that are told apart whichever of the two is true."""
    return {
        (one, other)
        for (one, other), separation in separations.items()
        if min(separation, separations.get((other, one), separation)) >= APART
    }


def _effort(stand: Stand, courses: Mapping[str, Course]) -> float:
    """Return what an experiment must be worth more than a plainer one."""
    effort = 0.0
    slow = {quantity.name for quantity in stand.reach.quantities if quantity.role == "follows"}
    for name, choices in stand.courses.items():
        course = courses[name]
        effort += BROUGHT * (name in slow and course.start != choices[0].start)
        if choices[0].way == "ramp":  # a clock
            effort += LATER * choices.index(course)
        else:
            effort += EFFORT[course.way] + ELSEWHERE * ((course != choices[0]) + (course.end < course.start))
    return effort


def _sized(stand: Stand, courses: Mapping[str, Course], pairs: set[tuple[str, str]]) -> Designed | None:
    """Take as many readings as tell the pairs apart, within the budget; pairs that these never do are left out."""
    fewest = min(stand.fewest, stand.budget)
    counts: dict[tuple[str, str], int] = {}
    live = [duel for duel in stand.duels([courses]) if duel.names in pairs]
    most = {duel.names: float(duel.after(MOST_READINGS / LOOKED_AT)[0]) for duel in live}
    for duel in (duel for duel in live if duel.names in _decided(most)):
        enough = min(ENOUGH, NEARLY * most[duel.names])
        reached = (count for count in range(fewest, MOST_READINGS) if duel.after(count / LOOKED_AT)[0] >= enough)
        counts[duel.names] = next(reached, MOST_READINGS)
    if not counts:
        return None
    return Designed(stand.reach.settled(courses), min(max(counts.values()), stand.budget), tuple(counts))
