"""Which design do I want? Variables, objectives and limits as the model declares them, and the front between them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field, fields, replace
from functools import cached_property, lru_cache, partial
from graphlib import CycleError, TopologicalSorter
from math import ceil, floor, isnan
from typing import Any, Literal, Protocol, runtime_checkable

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.special import ndtri

from truing.arrays import Matrix
from truing.declare.blocks import Block, Cell, Drawing, Table, Words
from truing.declare.correlations import pearson
from truing.declare.fields import InputField
from truing.declare.goals import Maximise, Minimise, Require, Vary
from truing.declare.model import TOTAL_PRICE
from truing.declare.near_miss import near_miss
from truing.declare.sources import Tolerance
from truing.declare.spreads import (
    Band,
    Distribution,
    Grade,
    Spread,
    Target,
    Zone,
    shift_per_width,
)
from truing.errors import InfeasibleError, TruingError, UnitError, UsageError
from truing.evaluate import acting_inputs, evaluate, evaluate_rows
from truing.executors import in_order, keepable, stays_here
from truing.fits import GRADES
from truing.formulas import Formula, parse
from truing.formulas import evaluate as evaluate_formula
from truing.heavy import pymoo
from truing.inputs_file.values import broken_bound
from truing.packed import Packed, pack, unpack
from truing.prices import price_answers, price_of, prices_at
from truing.setup import Setup
from truing.studies.bench import Bench, Outcome
from truing.studies.checks import (
    Demand,
    Limit,
    as_number,
    beside,
    check_name,
    demand_of,
    demands,
    goal_of,
    limit_of,
    normal_chance,
    requirements,
    results_needed,
    sockets_of,
    worst,
)
from truing.studies.drawings import BLUE, GREY, ORANGE, WIDTH, labelled
from truing.studies.first_order import nominal_of
from truing.studies.reading import printed, spoken
from truing.studies.sampling import (
    BATCH,
    Scatter,
    ScatterSource,
    Tally,
    gather,
    generator,
    sample,
    scatter_of,
    with_tolerances,
)
from truing.units import difference_unit, read_quantity, to_si, unit_text

ALGORITHMS = ("nsga2",)
CHANCES = ("draws", "first_order")
FOUND = "found"


@dataclass(frozen=True, kw_only=True)
class Optimise:
    """Look for the designs that no other beats: every Minimise and Maximise, under every Require.

    Chosen are the inputs of every ``Vary`` and the width of every tolerance with a price, from ``tightest`` to
    ``widest`` times what it is now (a grade from ``finest`` on). A probability is found with the same machines for
    every design, or to first order. The knee of the front is verified by ``verify`` machines on the exact model.
    """

    vary: tuple[str, ...] = ()
    population: int = 100
    generations: int = 100
    algorithm: Literal["nsga2"] = "nsga2"
    tightest: float = 1.0
    widest: float = 2.0
    finest: str = "IT5"
    chance: Literal["draws", "first_order"] = "draws"
    draws: int = 4096
    surrogate: bool = False
    verify: int = 100_000
    batch: int = BATCH
    parts: int = 1
    name: str = "optimise"
    gives: Callable[[Optimum], Any] | None = None

    def __post_init__(self) -> None:
        if self.algorithm not in ALGORITHMS:
            raise UsageError(f"the algorithm '{self.algorithm}' is unknown; there is {', '.join(ALGORITHMS)}")
        if self.chance not in CHANCES:
            raise UsageError(f"chance takes {' or '.join(CHANCES)}, not '{self.chance}'")
        if not 4 <= self.population <= 10_000:
            raise UsageError(f"population = {self.population}, but a population has 4 to 10000 designs")
        if not 1 <= self.generations <= 100_000:
            raise UsageError(f"generations = {self.generations}, but a search has 1 to 100000 generations")
        if not 0 < self.tightest < self.widest:
            raise UsageError(
                f"tightest = {self.tightest:g} and widest = {self.widest:g}, but widths run from a smaller factor "
                "above 0 to a larger one"
            )
        if self.finest not in GRADES:
            raise UsageError(f"'{self.finest}' is no tolerance grade; write IT1 to IT18")
        if min(self.draws, self.verify, self.batch, self.parts) < 1:
            raise UsageError("draws, verify, batch and parts are at least 1")

    def run(self, bench: Bench) -> Optimum:
        """Search, and verify the knee. Raises UsageError without a variable or an objective."""
        setup = bench.setup
        problem = make_problem(setup, self, constants(setup, bench.answers))
        if self.surrogate:
            problem = replace(problem, stand_in=_stand_in(bench, self.name))
        done = bench.part(self.name, 0.0, self.generations / (self.generations + 1))
        trail = search(problem, bench.executor, done)
        values = trail.answers.objectives * np.array([aim.sign for aim in problem.aims])
        answers = trail.answers[np.lexsort(values.T[::-1])]  # by the first objective, then by the others
        optimum = _optimum(problem, trail, answers)
        knee = optimum.knee_place
        return optimum if knee is None else self._verified(bench, problem, optimum, answers.designs[knee])

    def _verified(self, bench: Bench, problem: Problem, optimum: Optimum, knee: Matrix) -> Optimum:
        """Run the knee as an inputs file would state it, and draw machines of it."""
        setup = problem.space.setup_of(knee)
        try:
            answers = {**dict(problem.known), **setup.model.read_results(evaluate(setup)), **price_answers(setup)}
        except InfeasibleError as error:
            remark = f"the model itself has no answer at the knee ({error})"
            return replace(optimum, remarks=(*optimum.remarks, remark))
        exact = {aim.name: float(answers.get(aim.name, _nominal(setup, aim.name))) for aim in problem.aims}
        wanted = demands(setup, answers, with_goal=True)
        tally = None
        if wanted:
            done = bench.part(self.name, self.generations / (self.generations + 1), 1.0)
            tally = sample(
                scatter_of(setup), wanted, answers,
                draws=self.verify, batch=self.batch, executor=bench.executor, done=done,
            )  # fmt: skip
        return replace(optimum, exact=exact, demands=tuple(wanted), tally=tally)


def _stand_in(bench: Bench, study: str) -> ModelSubstitute:
    """Return the outcome of the surrogate study that ran before."""
    for outcome in bench.outcomes.values():
        if isinstance(outcome, ModelSubstitute):
            return outcome
    raise UsageError(f"study '{study}': surrogate = true, but no Surrogate ran before it; list it first in run = [...]")


def _nominal(setup: Setup, name: str) -> float:
    return float(setup.nominal(name)) if name in setup.model.input_fields else float("nan")


def _optimum(problem: Problem, trail: Trail, answers: Answers) -> Optimum:
    feasible = bool(answers.feasible.all())
    start = answers_of(problem, problem.space.start[None, :], as_stated=True)
    knee, distance = knee_of(small(problem, answers)) if feasible else (None, 0.0)
    return Optimum(
        problem=problem,
        front=tuple(_designs(problem, answers)) if feasible else (),
        start=_designs(problem, start, as_stated=True)[0],
        knee_place=knee,
        distance=distance,
        status=FOUND if feasible else _nothing(problem, trail),
        volume=volume_of(trail.fronts, exhausted=len(trail.fronts) < problem.study.generations) if feasible else None,
        evaluations=trail.evaluations,
        failed=trail.failed,
        remarks=(*left_out(problem.setup), *_too_few(problem), *_beyond(problem, answers.designs)),
        inputs=acting_inputs(problem.setup),
    )


def _nothing(problem: Problem, trail: Trail) -> str:
    """Say that no design keeps every limit, and which limit the nearest one misses most."""
    counted = f"no design among {trail.evaluations} keeps every limit"
    nearest = int(np.argmin(violation(trail.answers)))
    if trail.answers.failed[nearest]:
        return f"{counted}: none has an answer"
    margins = trail.answers.margins[nearest]
    worst = int(np.argmin(margins))
    return f"{counted}; the nearest misses '{problem.bounds[worst].name}' by a margin of {margins[worst]:.3g}"


def _too_few(problem: Problem) -> tuple[str, ...]:
    """Name the goals that so few machines cannot tell from certainty."""
    if problem.cloud is None:
        return ()
    words = []
    for bound in problem.by_chance:
        goal = goal_of(bound.require, problem.setup)
        if goal is not None and problem.study.draws * (1 - goal) < 1:
            words.append(f"{problem.study.draws} machines cannot tell {goal:g} of '{bound.name}' from certainty")
    return tuple(words)


def _beyond(problem: Problem, designs: Matrix) -> tuple[str, ...]:
    """Say how many designs of the front lie where the surrogate learnt nothing."""
    outside = getattr(problem.stand_in, "extrapolated", None)
    count = int(np.sum(outside(problem.space.columns(designs)))) if outside is not None else 0
    return (f"{count} of {len(designs)} designs of the front lie outside the surrogate's box",) if count else ()


@dataclass(frozen=True, kw_only=True)
class DesignPoint:
    """One design: ``inputs`` in SI, ``tolerances`` as full widths in SI or grades, and what it is worth.

    ``objectives`` are in SI, ``margins`` of every limit above 0 safe, ``chances`` by check; NaN where it has no answer.
    """

    inputs: Mapping[str, float]
    tolerances: Mapping[str, float | str]
    objectives: Mapping[str, float]
    margins: Mapping[str, float]
    chances: Mapping[str, float]
    feasible: bool


def _designs(problem: Problem, answers: Answers, *, as_stated: bool = False) -> list[DesignPoint]:
    """Return the designs by name."""
    columns = problem.space.columns(answers.designs, as_stated=as_stated)
    choices = problem.space.choices(answers.designs)
    by_chance = problem.by_chance
    return [
        DesignPoint(
            inputs={name: float(values[row]) for name, values in columns.items()},
            tolerances={name: variable.chosen(values[row]) for name, (variable, values) in choices.items()},
            objectives={aim.name: float(answers.objectives[row, i]) for i, aim in enumerate(problem.aims)},
            margins={bound.name: float(answers.margins[row, i]) for i, bound in enumerate(problem.bounds)},
            chances={bound.name: float(answers.chances[row, i]) for i, bound in enumerate(by_chance)},
            feasible=bool(answers.feasible[row]),
        )
        for row in range(len(answers.designs))
    ]


@dataclass(frozen=True, kw_only=True)
class Optimum(Outcome):
    """The designs that no other beats, in the order of the first objective, and the knee among them.

    ``start`` is the design that the inputs file states. Without any feasible design ``front`` is empty, ``knee`` None
    and ``status`` says why. ``exact`` holds the knee's objectives (SI) by the model itself, ``verified`` the share of
    machines of it that meet each goal, ``volume`` the hypervolume of every generation. ``inputs`` are the run's.
    """

    problem: Problem = field(repr=False)
    front: tuple[DesignPoint, ...]
    start: DesignPoint
    knee_place: int | None
    distance: float
    status: str
    volume: Volume | None
    evaluations: int
    failed: int = 0
    exact: Mapping[str, float] = field(default_factory=dict)
    demands: tuple[Demand, ...] = ()
    tally: Tally | None = None
    remarks: tuple[str, ...] = ()
    inputs: Any = None

    def printed_in(self, unit_of: Callable[[str, str], str]) -> Optimum:
        """Return the same, printed in other units."""
        space, setup = self.problem.space, self.problem.setup
        inputs = {name: unit_of(name, setup.print_unit(name)) for name in self.start.inputs}
        aims = tuple(replace(aim, unit=unit_of(aim.name, aim.unit)) for aim in self.problem.aims)
        variables = tuple(replace(each, unit=unit_of(each.name, each.unit)) for each in space.variables)
        setup = replace(setup, units={**setup.units, **inputs})
        problem = replace(self.problem, aims=aims, space=replace(space, setup=setup, variables=variables))
        return replace(self, problem=problem)

    @property
    def study(self) -> Optimise:
        """The study that found it."""
        return self.problem.study

    @property
    def name(self) -> str:
        """The name of the study."""
        return self.study.name

    @property
    def knee(self) -> DesignPoint | None:
        """The design farthest from the chord of the normalised front; with one objective the best."""
        return None if self.knee_place is None else self.front[self.knee_place]

    @property
    def variables(self) -> tuple[Variable, ...]:
        """What was chosen, between which ends."""
        return self.problem.space.variables

    @property
    def aims(self) -> tuple[Aim, ...]:
        """What should be small or large."""
        return self.problem.aims

    @property
    def bounds(self) -> tuple[Bound, ...]:
        """The limits that every design of the front keeps."""
        return self.problem.bounds

    @property
    def verified(self) -> dict[str, float]:
        """The share of drawn machines of the knee that meets each goal."""
        return {} if self.tally is None else {name: worst(share) for name, share in self.tally.shares.items()}

    @property
    def interval(self) -> dict[str, tuple[float, float]]:
        """Wilson's 95 % interval of each of these shares."""
        tally = self.tally
        return (
            {} if tally is None else {name: (worst(low), worst(high)) for name, (low, high) in tally.intervals.items()}
        )

    def as_json(self) -> dict[str, Any]:
        """Return front, knee, start, hypervolume and status in printed units."""
        study = self.study
        entry: dict[str, Any] = {
            "status": self.status,
            "variables": {variable.key: _variable_json(variable) for variable in self.variables},
            "objectives": {aim.name: {"sense": aim.sense, "unit": aim.unit} for aim in self.aims},
            "start": _design_json(self, self.start),
            "front": [_design_json(self, design) for design in self.front],
            "evaluations": self.evaluations,
            "failed": self.failed,
            "algorithm": study.algorithm,
            "population": study.population,
            "generations": study.generations,
            "chance": study.chance,
            "draws": study.draws if self.problem.cloud is not None else None,
            "surrogate": study.surrogate,
        }
        if self.knee is not None:
            entry["knee"] = _knee_json(self, self.knee)
        if self.volume is not None:
            volume = self.volume
            entry["hypervolume"] = {
                "reference": REFERENCE,
                "ideal": _by_aim(self, volume.ideal),
                "nadir": _by_aim(self, volume.nadir),
                "history": [as_number(value) for value in volume.history],
                "settled": volume.settled,
            }
        return entry

    def blocks(self) -> Sequence[Block]:
        """Return start against knee, the front, and both figures."""
        if self.knee is None:
            return [Words(f"{self.status[:1].upper()}{self.status[1:]}.", "finding"), _comparison(self)]
        blocks: list[Block] = [Words(_summary(self)), _comparison(self), *_undecided(self)]
        if len(self.front) > 1:
            blocks += [*fit_for_paper(_front(self)), Drawing("Front, start and knee", partial(_drawn_front, self))]
        words = (
            "Of every generation's front, in the box of the last one (each objective 0 to 1), against the reference "
            f"point {REFERENCE:g} in each objective."
        )
        assert self.volume is not None  # there is a front
        history = partial(_drawn_history, self.volume.history)
        blocks.append(Drawing("Hypervolume over the generations", history, words))
        return blocks

    def warnings(self) -> Sequence[str]:
        """Say what was not found, what the exact model contradicts, and whether the search had settled."""
        return [f"study '{self.name}': {text}" for text in _doubts(self)]


# How an optimum is written: results.json, the sheet, and what must be said of it


SHOWN = 20
FLAT = 1e-6
WIDEST = 7
"""So many columns with long names fit on A4 and letter."""


def _by_aim(optimum: Optimum, values: Sequence[float]) -> dict[str, Any]:
    return {aim.name: printed(aim.sign * value, aim.unit) for aim, value in zip(optimum.aims, values, strict=True)}


def _variable_json(variable: Any) -> dict[str, Any]:
    if variable.kind == "grade":
        return {"kind": "grade", "finest": variable.chosen(variable.low), "coarsest": variable.chosen(variable.high)}
    said = {
        "kind": {"number": "input", "whole": "whole", "width": "width"}[variable.kind],
        "low": printed(variable.low, variable.unit),
        "high": printed(variable.high, variable.unit),
        "unit": variable.unit,
    }
    stepped = variable.step > 0 and variable.kind == "number"
    return said | ({"step": printed(variable.step, difference_unit(variable.unit))} if stepped else {})


def _kinds(optimum: Optimum) -> dict[str, dict[str, tuple[str, str]]]:
    """Return by group and name what each value of a design is, and its unit."""
    tolerances = [variable for variable in optimum.variables if not variable.is_input]
    return {
        "inputs": {name: ("input", optimum.problem.setup.print_unit(name)) for name in optimum.start.inputs},
        "tolerances": {one.name: ("grade" if one.kind == "grade" else "full width", one.unit) for one in tolerances},
        "objectives": {aim.name: (aim.sense, aim.unit) for aim in optimum.aims},
    }


def _design_json(optimum: Optimum, design: DesignPoint) -> dict[str, Any]:
    values = {
        group: {
            name: value if isinstance(value, str) else printed(value, kinds[name][1])
            for name, value in getattr(design, group).items()
        }
        for group, kinds in _kinds(optimum).items()
    }
    margins = {name: as_number(value) for name, value in design.margins.items()}
    chances = {name: as_number(value) for name, value in design.chances.items()}
    return {**values, "margins": margins, "chances": chances, "feasible": design.feasible}


def _knee_json(optimum: Optimum, knee: DesignPoint) -> dict[str, Any]:
    exact = {aim.name: printed(optimum.exact[aim.name], aim.unit) for aim in optimum.aims if aim.name in optimum.exact}
    tally = optimum.tally
    verified = {
        name: {"probability": share, "interval95": list(optimum.interval[name]), "draws": tally.draws if tally else 0}
        for name, share in optimum.verified.items()
    }
    return {
        "place": optimum.knee_place,
        "distance": as_number(optimum.distance),
        **_design_json(optimum, knee),
        "exact": exact,
        "verified": verified,
    }


def _summary(optimum: Optimum) -> str:
    count, study = len(optimum.front), optimum.study
    what = f"{count} designs that no other beats" if count > 1 else "One design that no other beats"
    words = (
        f"{what}, from {optimum.evaluations} evaluated ({study.algorithm.upper()}, seed {optimum.problem.setup.seed})."
    )
    if optimum.problem.by_chance:
        how = f"with the same {study.draws} machines for every design" if study.chance == "draws" else "to first order"
        words += f" Chances are found {how}."
    if study.surrogate:
        words += " The surrogate answered in place of the model; the knee was run on the model itself."
    return f"{words} {_settled(optimum)}"


def _settled(optimum: Optimum) -> str:
    volume = optimum.volume
    assert volume is not None  # there is a front
    if volume.exhausted:
        return "The search ended when no design was left that it had not tried."
    way = "grew" if volume.gain >= 0 else "shrank"
    grown = f"the hypervolume {way} by {100 * abs(volume.gain):.2g} % in the last {volume.last} generations"
    return f"The search has settled: {grown}." if volume.settled else f"The search has not settled: {grown}."


def _comparison(optimum: Optimum) -> Table:
    """Set the stated design and the knee side by side: variables, objectives, limits."""
    start, knee = optimum.start, optimum.knee
    designs = [start] if knee is None else [start, knee]
    told = [_design_json(optimum, design) for design in designs]
    rows: list[list[Cell]] = [
        [name, kind, unit_text(unit), *(values[group][name] for values in told)]
        for group, kinds in _kinds(optimum).items()
        for name, (kind, unit) in kinds.items()
    ]
    for bound in optimum.bounds:
        chances = [as_number(100 * design.chances[bound.name]) for design in designs if bound.by_chance]
        margins = [as_number(design.margins[bound.name]) for design in designs]
        rows.append([bound.name, "chance", "%", *chances] if bound.by_chance else [bound.name, "margin", "", *margins])
    for name, share in optimum.verified.items():
        rows.append([name, f"chance, {optimum.study.verify} machines", "%", None, 100 * share])
    rows.append(["every limit is kept", "", "", *(design.feasible for design in designs)])
    columns = ("name", "", "unit", "start", "knee")[: 3 + len(designs)]
    return Table("Start and knee", columns, rows, note=_comparison_note(optimum))


def _comparison_note(optimum: Optimum) -> str:
    if optimum.knee is None:
        return ""
    if len(optimum.aims) == 1:
        return "With one objective the knee is the best design."
    if len(optimum.front) == 1:
        return "The front is a single design: it is the best in every objective."
    plane = "chord between the ends" if len(optimum.aims) == 2 else "plane through the ends"
    if optimum.distance <= FLAT:
        return f"The front has no knee: none of its designs lies before the {plane}. Shown is the nearest one."
    return f"The knee lies farthest from the {plane} of the front, each objective brought to 0 to 1."


def _front(optimum: Optimum) -> Table:
    """List the front, thinned evenly; its ends and the knee stay."""
    places = _thinned(len(optimum.front), optimum.knee_place or 0)
    kinds = _kinds(optimum)
    inputs = {name: kind for name, kind in kinds["inputs"].items() if name not in kinds["objectives"]}
    chances = [bound.name for bound in optimum.problem.by_chance]
    rows: list[list[Cell]] = []
    for index in places:
        design = optimum.front[index]
        told = _design_json(optimum, design)
        row: list[Cell] = [f"{index + 1} knee" if index == optimum.knee_place else str(index + 1)]
        row += [*told["objectives"].values(), *(as_number(100 * design.chances[name]) for name in chances)]
        rows.append([*row, *(told["inputs"][name] for name in inputs), *told["tolerances"].values()])
    columns = ["design", *kinds["objectives"], *chances, *inputs, *kinds["tolerances"]]
    units = ["", *(unit for _, unit in kinds["objectives"].values()), *("%" for _ in chances)]
    units += [unit for _, unit in (*inputs.values(), *kinds["tolerances"].values())]
    left = len(optimum.front) - len(places)
    note = f"{len(places)} of {len(optimum.front)} designs; results.json holds all of them." if left else ""
    return Table("Front", columns, rows, units, note)


def fit_for_paper(table: Table) -> list[Table]:
    """Cut a table with more columns than a page has room for; the first column stands in every part."""
    count = len(table.columns)
    if count <= WIDEST:
        return [table]
    steps = range(1, count, WIDEST - 1)
    parts = []
    for part, start in enumerate(steps, 1):
        places = [0, *range(start, min(start + WIDEST - 1, count))]
        title = f"{table.title}, part {part} of {len(steps)}"
        columns = [table.columns[index] for index in places]
        rows = [[row[index] for index in places] for row in table.rows]
        parts.append(Table(title, columns, rows, [table.units[index] for index in places], table.note))
    return parts


def _thinned(count: int, knee: int) -> list[int]:
    if count <= SHOWN:
        return list(range(count))
    steps = SHOWN - 1
    return sorted({*(round(step * (count - 1) / (steps - 1)) for step in range(steps)), knee})


def _drawn_front(optimum: Optimum) -> Figure:
    """Draw the first objective against each of the others."""
    first, others = optimum.aims[0], optimum.aims[1:]
    figure = Figure(figsize=(WIDTH, 0.4 + 3.2 * len(others)), layout="constrained")
    panels = figure.subplots(len(others), 1, squeeze=False)[:, 0]
    for panel, other in zip(panels, others, strict=True):
        _panel(panel, optimum, (first, other))
        panel.set_xlabel(labelled(first.name, unit_text(first.unit)))
        panel.set_ylabel(labelled(other.name, unit_text(other.unit)))
    panels[0].legend(frameon=False)
    return figure


def _panel(panel: Any, optimum: Optimum, aims: tuple[Any, Any]) -> None:
    def places(designs: Sequence[DesignPoint]) -> list[list[Any]]:
        return [[printed(design.objectives[aim.name], aim.unit) for design in designs] for aim in aims]

    line = "-" if len(optimum.aims) == 2 else ""
    panel.plot(
        *places(optimum.front), color=BLUE, marker="o", markersize=3.5, linewidth=0.8, linestyle=line, label="front"
    )
    start = optimum.start
    if all(start.objectives[aim.name] == start.objectives[aim.name] for aim in aims):
        label = "start" if start.feasible else "start, which misses a limit"
        face = GREY if start.feasible else "none"
        panel.plot(*places([start]), color=GREY, marker="s", markerfacecolor=face, linestyle="", label=label)
    if optimum.knee is not None:
        panel.plot(*places([optimum.knee]), color=ORANGE, marker="D", linestyle="", label="knee")
    panel.grid(alpha=0.3)


def _drawn_history(history: Sequence[float]) -> Figure:
    figure = Figure(figsize=(WIDTH, 2.4), layout="constrained")
    panel: Any = figure.subplots()
    panel.plot(range(1, len(history) + 1), history, color=BLUE)
    panel.set_xlabel("generation")
    panel.set_ylabel("hypervolume")
    panel.grid(alpha=0.3)
    return figure


def _doubts(optimum: Optimum) -> Iterator[str]:
    """Say what was not found, what the exact model contradicts, and whether the search had settled."""
    yield from optimum.remarks
    if optimum.knee is None:
        yield optimum.status
        return
    if optimum.volume is not None and not optimum.volume.settled:
        yield (
            f"the hypervolume still grew by more than {100 * SETTLED:g} % in the last {optimum.volume.last} "
            "generations; ask for more generations"
        )
    for name, goal, (low, high) in _goals(optimum):
        if high < goal:
            yield (
                f"the knee misses '{name}': machines that the search has not seen give {low:.5f} to {high:.5f} "
                f"of {goal:g}"
            )


def _undecided(optimum: Optimum) -> Iterator[Words]:
    """Say where the sampling error of the verification does not decide: an optimum stands at its limits."""
    for name, goal, (low, high) in _goals(optimum):
        if low < goal <= high:
            yield Words(
                f"Whether the knee reaches {goal:g} of {spoken(name)} lies within the sampling error of the "
                f"verification ({low:.5f} to {high:.5f}): it stands at this limit."
            )


def _goals(optimum: Optimum) -> Iterator[tuple[str, float, tuple[float, float]]]:
    for demand in optimum.demands:
        if demand.goal is not None:
            yield demand.name, demand.goal, optimum.interval[demand.name]


# The search: NSGA-II over places in the unit cube; a population is one array, and only the seed decides chance.
# Source: K. Deb, A. Pratap, S. Agarwal, T. Meyarivan, IEEE Trans. Evol. Comput. 6 (2002) 182. Whole variables sit at
# their steps; beside polynomial mutation they jump to any other step now and then.


FAILED = 1e6
"""How far a design without an answer is counted beyond every limit: finite, and worse than any that has one."""

ROOM = 4
"""How many times its population a search remembers of what it has found on the way."""

LED = 2
"""Every second offspring is a differential step."""
REACH, MOVED = (0.2, 1.0), 0.9
"""How long these steps are, and in what share of the variables."""

TRIFLE, DEAR = 1e-3, 2e-2


@dataclass(frozen=True)
class Trail:
    """What the search left: the designs it ended with, and every generation's best objectives.

    ``fronts`` hold what should be small (objectives, those to be large negated), of feasible designs no other beats.
    """

    answers: Answers
    fronts: tuple[Matrix, ...]
    evaluations: int
    failed: int


def search(problem: Problem, executor: Executor, done: Callable[[int, int], None]) -> Trail:
    """Look for the designs that no other beats; each generation is answered at once."""
    algorithm = _algorithm(problem)
    population, generations = problem.study.population, problem.study.generations
    rng = np.random.default_rng([problem.setup.seed, LED])
    kept: Answers | None = None
    fronts: list[Matrix] = []
    evaluations = failed = 0
    for generation in range(generations):
        asked = algorithm.ask()
        if asked is None or not len(asked):
            break
        if kept is not None:
            asked.set("X", _led(problem, (asked.get("X"), algorithm.pop.get("X")), kept.designs, rng))
        generated = answered(problem, problem.space.designs(asked.get("X")), executor)
        evaluations, failed = evaluations + len(generated.designs), failed + int(generated.failed.sum())
        _tell(algorithm, asked, problem, generated)
        kept = _best(problem, generated if kept is None else joined([kept, generated]), ROOM * population)
        fronts.append(small(problem, kept))
        done(generation + 1, generations)
    assert kept is not None  # the first generation is never empty
    return Trail(_best(problem, kept, population), tuple(fronts), evaluations, failed)


def _led(problem: Problem, places: tuple[Matrix, Matrix], best: Matrix, rng: np.random.Generator) -> Matrix:
    """Put differential steps in the place of every second offspring, and return all offspring as places.

    A step is a part of the way between two designs of the population, away from one of the best: so it follows the
    front whatever its direction (R. Storn, K. Price, J. Glob. Optim. 11 (1997) 341). ``places`` are those of the
    offspring and of the population.
    """
    offspring, population = places
    changed = offspring.copy()
    count = len(changed[1::LED])
    start = problem.space.units(best[rng.integers(len(best), size=count)])
    ahead, behind = (population[rng.integers(len(population), size=count)] for _ in range(2))
    reach = rng.uniform(*REACH, (count, 1))
    moved = rng.random(start.shape) < MOVED
    led = start + np.where(moved, reach * (ahead - behind), 0.0)
    changed[1::LED] = problem.space.units(problem.space.designs(np.clip(led, 0.0, 1.0)))
    return changed


def small(problem: Problem, answers: Answers) -> Matrix:
    """Return the objectives of feasible designs as numbers that should be small."""
    return np.asarray(answers.objectives[answers.feasible] * np.array([aim.sign for aim in problem.aims]))


def _best(problem: Problem, answers: Answers, most: int) -> Answers:
    """Keep the feasible designs that no other beats, or while there is none the one that misses least.

    At most ``most`` of them, chosen so that they spread along the front; the ends always stay.
    """
    if not answers.feasible.any():
        return answers[[int(np.argmin(violation(answers)))]]
    values = small(problem, answers)
    front = non_dominated(values)
    return answers[np.flatnonzero(answers.feasible)[spread_out(values, front[worth_it(values[front])], most)]]


def violation(answers: Answers) -> Matrix:
    """Return how far every design misses its limits together; finite where it has no answer."""
    missed = np.where(np.isfinite(answers.margins), np.maximum(-answers.margins, 0.0), FAILED).sum(axis=1)
    return np.asarray(np.where(answers.failed, FAILED * (1 + answers.margins.shape[1]), missed))


def non_dominated(values: Matrix) -> NDArray[np.intp]:
    """Return the rows (of values that should be small) that no other row beats; of equal rows the first."""
    order = np.lexsort(values.T[::-1])
    if values.shape[1] <= 2:  # sorted by the first, a row stays where the last falls below all before it
        last = values[order, -1]
        lowest = np.minimum.accumulate(np.concatenate([[np.inf], last[:-1]]))
        return np.asarray(order[last < lowest])
    front = []
    while len(order):
        first, rest = order[0], order[1:]
        front.append(first)
        order = rest[(values[rest] < values[first]).any(axis=1)]
    return np.array(front, dtype=np.intp)


def worth_it(front: Matrix) -> NDArray[np.bool_]:
    """Say which designs of a front buy something for their price.

    One that is better than another by less than ``TRIFLE`` of the front's extent, in what it is better in, and worse
    by more than ``DEAR`` in anything, is no trade: the ends of a front would hang on to such designs for ever.
    """
    span = np.ptp(front, axis=0)
    scaled = (front / np.where(span > 0, span, 1.0)).T
    apart: Matrix = scaled[:, :, None] - scaled[:, None, :]  # how much worse the first is than the second
    beaten = (apart.min(axis=0) > -TRIFLE) & (apart.max(axis=0) > DEAR)
    return np.asarray(~beaten.any(axis=1))


def spread_out(values: Matrix, front: NDArray[np.intp], most: int) -> NDArray[np.intp]:
    """Thin a front to ``most`` rows by leaving out, one by one, the most crowded; ends have no neighbour and stay."""
    while len(front) > most:
        objectives = values[front]
        span = np.ptp(objectives, axis=0)
        scaled = (objectives - objectives.min(axis=0)) / np.where(span > 0, span, 1.0)
        room = np.zeros(len(front))
        for column in scaled.T:
            order = np.argsort(column, kind="stable")
            room[order[1:-1]] += column[order[2:]] - column[order[:-2]]
            room[order[[0, -1]]] = np.inf
        front = np.delete(front, int(np.argmin(room)))
    return front


def _tell(algorithm: Any, asked: Any, problem: Problem, answers: Answers) -> None:
    """Hand the answers back; a design without one is finite and worse than any other."""
    signs = np.array([aim.sign for aim in problem.aims])
    objectives = np.where(answers.failed[:, None], FAILED, answers.objectives * signs)
    missing = np.where(answers.failed, FAILED, -1.0)
    limits = np.where(answers.failed[:, None], FAILED, -answers.margins)
    shell = pymoo.StaticProblem(algorithm.problem, F=objectives, G=np.column_stack([limits, missing]))
    pymoo.Evaluator().eval(shell, asked)
    algorithm.tell(infills=asked)


def _algorithm(problem: Problem) -> Any:
    """Set up the algorithm of the literature with the first population."""
    pymoo.Config.warnings["not_compiled"] = False
    count = len(problem.space.variables)
    shell = pymoo.Problem(
        n_var=count,
        n_obj=len(problem.aims),
        n_ieq_constr=len(problem.bounds) + 1,
        xl=np.zeros(count),
        xu=np.ones(count),
    )
    mutation, repair = _operators(problem)
    algorithm = pymoo.NSGA2(
        pop_size=problem.study.population, sampling=_first(problem), mutation=mutation, repair=repair
    )
    termination = ("n_gen", problem.study.generations)
    algorithm.setup(shell, termination=termination, seed=problem.setup.seed, verbose=False)
    return algorithm


def _first(problem: Problem) -> Matrix:
    """Return the first population: the stated design, it with every width at its ends, and a Latin hypercube."""
    space, population = problem.space, problem.study.population
    start = space.units(space.start[None, :])[0]
    widths = np.array([not variable.is_input for variable in space.variables])
    ends = [start, np.where(widths, 0.0, start), np.where(widths, 1.0, start)] if widths.any() else [start]
    ends = ends[:population]
    rest = population - len(ends)
    rng = np.random.default_rng([problem.setup.seed, rest])
    strata = np.array([rng.permutation(rest) for _ in space.variables]).reshape(len(start), rest).T
    return np.vstack([*ends, (strata + rng.random((rest, len(start)))) / max(rest, 1)])


def _operators(problem: Problem) -> tuple[Any, Any]:
    """Return the mutation and the repair that know variables with steps."""
    space = problem.space
    discrete = np.flatnonzero([variable.step > 0 for variable in space.variables])

    class Mutation(pymoo.PM):  # type: ignore[misc]  # pymoo has no types
        def _do(self, shell: Any, places: Any, *args: Any, random_state: Any = None, **kwargs: Any) -> Any:
            changed = super()._do(shell, places, *args, random_state=random_state, **kwargs)
            if len(discrete):
                jumps = random_state.random((len(changed), len(discrete))) < 1 / len(space.variables)
                anywhere = random_state.random(jumps.shape)
                changed[:, discrete] = np.where(jumps, anywhere, changed[:, discrete])
            return changed

    class ToSteps(pymoo.Repair):  # type: ignore[misc]
        def _do(self, shell: Any, places: Any, **kwargs: Any) -> Any:
            return space.units(space.designs(np.asarray(places, dtype=float)))

    return Mutation(eta=20), ToSteps()


# What a front is worth: its knee, its hypervolume, and whether the search has settled


REFERENCE = 1.1
"""The reference point of the hypervolume, in every objective: the box of the final front is 0 to 1."""
SETTLED = 1e-3
LAST = 0.1


@dataclass(frozen=True)
class Volume:
    """The hypervolume of every generation's front in one box: ``ideal`` is 0, ``nadir`` 1 in each objective."""

    ideal: tuple[float, ...]
    nadir: tuple[float, ...]
    history: tuple[float, ...]
    exhausted: bool = False
    """Whether the search ended because it found no design that it had not tried."""

    @property
    def last(self) -> int:
        """How many generations at the end are looked at."""
        return max(1, round(LAST * len(self.history)))

    @property
    def gain(self) -> float:
        """By what share it grew in these last generations."""
        before = self.history[max(0, len(self.history) - 1 - self.last)]
        return (self.history[-1] - before) / self.history[-1] if self.history[-1] > 0 else 0.0

    @property
    def settled(self) -> bool:
        """Whether it grew by no more than one part in a thousand, or nothing was left to try."""
        return self.exhausted or (len(self.history) > self.last and self.gain <= SETTLED)


def volume_of(fronts: Sequence[Matrix], *, exhausted: bool = False) -> Volume:
    """Measure every generation's front (values that should be small) in the box of the last one.

    In one objective it is the way from the reference to the best. An objective in which the last front has no extent
    takes that of all fronts. Source: E. Zitzler, L. Thiele, IEEE Trans. Evol. Comput. 3 (1999) 257.
    """
    filled = [front for front in fronts if len(front)]
    last, whole = filled[-1], np.vstack(filled)
    ideal, nadir = last.min(axis=0), last.max(axis=0)
    nadir = np.where(nadir > ideal, nadir, whole.max(axis=0))
    span = np.where(nadir > ideal, nadir - ideal, 1.0)
    history = tuple(_hypervolume((front - ideal) / span) if len(front) else 0.0 for front in fronts)
    return Volume(tuple(ideal.tolist()), tuple((ideal + span).tolist()), history, exhausted)


def _hypervolume(values: Matrix) -> float:
    inside = values[(values < REFERENCE).all(axis=1)]
    if not len(inside):
        return 0.0
    if values.shape[1] == 1:
        return float(REFERENCE - inside.min())
    if values.shape[1] > 2:
        return float(pymoo.HV(ref_point=np.full(values.shape[1], REFERENCE))(inside))
    order = inside[np.lexsort(inside.T[::-1])]
    below = np.minimum.accumulate(np.concatenate([[REFERENCE], order[:, 1]]))
    return float(((REFERENCE - order[:, 0]) * (below[:-1] - below[1:])).sum())


def knee_of(front: Matrix) -> tuple[int, float]:
    """Return the design farthest from the chord of the normalised front, towards small values, and how far it is.

    The chord (with more objectives the plane) goes through the ends of the front, each objective from 0 to 1. With one
    objective it is the best design. Source: I. Das, Structural Optimization 18 (1999) 107.
    """
    if front.shape[1] == 1:
        return int(np.argmin(front[:, 0])), 0.0
    span = np.ptp(front, axis=0)
    scaled = (front - front.min(axis=0)) / np.where(span > 0, span, 1.0)
    distance = (1.0 - scaled.sum(axis=1)) / np.sqrt(front.shape[1])
    knee = int(np.argmax(distance))
    return knee, float(distance[knee]) if (span > 0).all() else 0.0


# Many designs answered at once: objectives, margins and chances; here, or by a worker that makes the problem again


ROWS = 2**16  # of one call of the model, so that memory stays flat


@runtime_checkable
class ModelSubstitute(Protocol):
    """What may answer in place of the model: the outcome of a surrogate study."""

    @property
    def of(self) -> tuple[str, ...]:
        """The results it knows."""

    def predict(self, columns: Mapping[str, Any]) -> Mapping[str, Any]:
        """Return these results (n,) in SI from columns (n,) or numbers in SI."""


@dataclass(frozen=True, eq=False)
class Problem:
    """What is chosen, what for, and the machines by which every design is judged."""

    space: Space
    study: Optimise
    known: ConstantAnswers
    aims: tuple[Aim, ...]
    bounds: tuple[Bound, ...]
    scatter: Scatter
    cloud: Cloud | None
    stand_in: ModelSubstitute | None = None

    @property
    def setup(self) -> Setup:
        """The setup of the design that the inputs file states."""
        return self.space.setup

    @property
    def by_chance(self) -> tuple[Bound, ...]:
        """The limits with a probability; they are the last ones."""
        return tuple(bound for bound in self.bounds if bound.by_chance)

    def answer(self, columns: Mapping[str, Any], rows: int, wanted: Sequence[str]) -> dict[str, Any]:
        """Run a batch: the surrogate for what it knows, the model for the rest; NaN where a row failed."""
        own = [name for name in self.setup.model.own_result_fields if name in wanted]
        covered = [name for name in own if self.stand_in is not None and name in self.stand_in.of]
        values: dict[str, Any] = {}
        if self.stand_in is not None and covered:
            predicted = self.stand_in.predict(columns)
            values = {name: np.broadcast_to(np.asarray(predicted[name], dtype=float), (rows,)) for name in covered}
        rest = [name for name in own if name not in covered]
        if rest or not own:
            values.update(evaluate_rows(self.setup, columns, rows, wanted=rest).results)
        return {name: values[name] for name in own}


@keepable
@dataclass(frozen=True)
class Answers:
    """Designs (m, v) and what they are worth: objectives (m, a) in SI, margins of every limit (m, b), chances (m, c).

    ``failed`` designs have no answer: NaN everywhere.
    """

    designs: Matrix
    objectives: Matrix
    margins: Matrix
    chances: Matrix
    failed: NDArray[np.bool_]

    @property
    def feasible(self) -> NDArray[np.bool_]:
        """Whether a design has an answer and keeps every limit."""
        return ~self.failed & (self.margins >= 0).all(axis=1)

    def __getitem__(self, rows: Any) -> Answers:
        """Return some of the designs."""
        return Answers(**{field.name: getattr(self, field.name)[rows] for field in fields(self)})


def joined(parts: Sequence[Answers]) -> Answers:
    """Put the answers of several batches together, in their order."""
    return Answers(
        **{field.name: np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(Answers)}
    )


def make_problem(setup: Setup, study: Optimise, known: ConstantAnswers = ()) -> Problem:
    """Collect variables, objectives and limits, and draw the machines. Raises UsageError where one is missing."""
    aims, space, bounds = aims_of(setup, study.name), open_space(setup, study), bounds_of(setup)
    scatter = scatter_of(setup)
    drawn = study.chance == "draws" and any(bound.by_chance for bound in bounds)
    cloud = cloud_of(scatter, setup.seed, study) if drawn else None
    return Problem(space, study, known, aims, bounds, scatter, cloud)


def answers_of(problem: Problem, designs: Matrix, *, as_stated: bool = False) -> Answers:
    """Answer designs (m, v) in one go; ``as_stated`` leaves inputs that follow as the inputs file states them."""
    count, world = len(designs), _world(problem, designs, as_stated=as_stated)
    objectives = np.column_stack([np.broadcast_to(world.value(aim.name), (count,)) for aim in problem.aims])
    plain = [margins(limit, world) for limit in world.limits if limit.goal is None]
    goals = [np.broadcast_to(limit.goal, (count,)) for limit in world.limits if limit.goal is not None]
    asked = np.array(goals, dtype=float).reshape(-1, count).T
    chances = np.zeros((count, 0))
    if goals:
        chances = (by_first_order if problem.cloud is None else by_draws)(problem, world)
    kept = np.column_stack([np.zeros((count, 0)), *plain, (chances - asked) / np.where(asked > 0, asked, 1.0)])
    failed = ~(np.isfinite(objectives).all(axis=1) & np.isfinite(kept).all(axis=1))
    for inner in world.spreads.values():  # no width: a grade that does not exist for this size
        for distribution in inner.values():
            failed |= ~np.isfinite(distribution.sd)
    for values in world.results.values():
        failed |= ~np.isfinite(values.reshape(count, -1)).all(axis=1)
    objectives, kept, chances = (np.where(failed[:, None], np.nan, part) for part in (objectives, kept, chances))
    return Answers(designs, objectives, kept, chances, failed)


@dataclass(frozen=True)
class Designs:
    """Designs (m,) without scatter, and how their inputs scatter.

    ``columns`` are nominal inputs that differ, ``values`` these, results, prices and what earlier studies gave.
    """

    setup: Setup
    rows: int
    columns: Mapping[str, Any]
    results: Mapping[str, Matrix]
    values: Mapping[str, Any]
    scatter: Scatter
    spreads: Spreads
    limits: tuple[Limit, ...]

    def value(self, name: str) -> Any:
        """Return a result, an input or the sum of the prices: a number for all designs or an array (m, ...)."""
        return self.values[name] if name in self.values else float(self.setup.nominal(name))

    def nominal(self, column: str) -> Any:
        """Return the nominal values (m,) of a column."""
        return self.columns[column] if column in self.columns else np.full(self.rows, nominal_of(self.setup, column))

    def each(self, values: Any) -> Matrix:
        """Return numbers (m,) of what is a number or (m, 1)."""
        return np.broadcast_to(np.ravel(values), (self.rows,))

    @cached_property
    def causes(self) -> tuple[ScatterSource, ...]:
        """What scatters, with nominal values and distributions (m, 1) where they are those of a tolerance."""
        causes = []
        for cause in self.scatter.causes:
            if own := self.spreads.get(cause.name):
                nominals = tuple(self.nominal(column)[:, None] for column in cause.columns)
                spreads = [own[column] for column in cause.columns]
                deep = tuple(replace(one, mean=one.mean[:, None], sd=one.sd[:, None]) for one in spreads)
                cause = replace(cause, nominals=nominals, distributions=deep)
            causes.append(cause)
        return tuple(causes)

    def distribution(self, column: str) -> Distribution:
        """Return how a column scatters that a single cause moves, numbers or (m, 1)."""
        causes = ((cause, cause.columns.index(column)) for cause in self.causes if column in cause.columns)
        cause, index = next(causes)
        return cause.distributions[index]

    @property
    def by_chance(self) -> list[Demand]:
        """The limits with a probability, as they are demanded of every machine."""
        return [demand_of(limit, self.setup) for limit in self.limits if limit.goal is not None]


def _world(problem: Problem, designs: Matrix, *, as_stated: bool) -> Designs:
    """Run the designs without scatter, and once more without effects where ``within`` is measured from there."""
    count, setup = len(designs), problem.setup
    columns = problem.space.columns(designs, as_stated=as_stated)
    spreads = scattered(problem.space, designs, columns)
    named = {aim.name for aim in problem.aims}
    named |= {name for bound in problem.bounds for name in (bound.require.result, bound.require.limit)}
    results = problem.answer(columns, count, [name for name in setup.model.own_result_fields if name in named])
    values = {**dict(problem.known), **columns, **results}
    if TOTAL_PRICE in setup.model.result_fields:
        values[TOTAL_PRICE] = total_prices(setup, spreads, count)
    centres = {**values, **_own_results(problem, columns, count)}
    limits = tuple(limit_of(bound.name, bound.require, setup, values, centres) for bound in problem.bounds)
    return Designs(setup, count, columns, results, values, problem.scatter, spreads, limits)


def _own_results(problem: Problem, columns: Mapping[str, Any], count: int) -> Mapping[str, Matrix]:
    """Return the results from which ``within`` is measured, where they are not the nominal ones: see ``of_design``."""
    setup, sockets = problem.setup, sockets_of(problem.setup)
    within = {bound.require.result for bound in problem.bounds if bound.require.kind == "within"}
    acts = any(active.effect.place != "reading" for active in setup.effects)
    deviates = any(name in columns or setup.nominal(name) != 0 for name in sockets)
    if not within or not (acts or deviates):
        return {}
    neutral = {**columns, **{name: np.zeros(count) for name in sockets}}
    return evaluate_rows(replace(setup, effects=()), neutral, count, wanted=within - {TOTAL_PRICE}).results


def run_job(packed: Packed, study: Optimise, known: ConstantAnswers, designs: Matrix) -> Answers:
    """Answer some designs in a worker."""
    return answers_of(_unpacked(packed, study, known), designs)


@lru_cache(maxsize=4)
def _unpacked(packed: Packed, study: Optimise, known: ConstantAnswers) -> Problem:
    return make_problem(unpack(packed), study, known)


def answered(problem: Problem, designs: Matrix, executor: Executor) -> Answers:
    """Answer designs (m, v), cut into jobs in a way that does not depend on who computes them."""
    rows = 1
    if problem.cloud is not None:
        rows = problem.study.draws
    elif problem.by_chance:
        rows = 1 + 2 * len(problem.scatter.columns)
    size = max(1, min(ROWS // rows, -(-len(designs) // problem.study.parts)))
    parts = [designs[start : start + size] for start in range(0, len(designs), size)]
    if stays_here(executor) or problem.stand_in is not None:
        return joined([answers_of(problem, part) for part in parts])
    study = replace(problem.study, vary=tuple(problem.study.vary), gives=None)
    run = partial(run_job, pack(problem.setup), study, problem.known)
    return joined(list(in_order(executor, run, parts)))


# What an optimisation is for: objectives and limits of many designs at once


@dataclass(frozen=True)
class Aim:
    """A number that should be small or large: a result of the function, an input, or the sum of the prices."""

    name: str
    maximise: bool
    unit: str

    @property
    def sign(self) -> float:
        """What turns it into something that should be small."""
        return -1.0 if self.maximise else 1.0

    @property
    def sense(self) -> str:
        """The word for it."""
        return "maximise" if self.maximise else "minimise"


@dataclass(frozen=True)
class Bound:
    """A limit that a design must keep: itself, or with a probability."""

    name: str
    require: Require

    @property
    def by_chance(self) -> bool:
        """Whether a probability is asked for."""
        return self.require.reliability is not None


def aims_of(setup: Setup, study: str) -> tuple[Aim, ...]:
    """Return the objectives. Raises UsageError where there is none, or one that is no single number."""
    own = setup.model.own_result_fields
    aims = []
    for objective in setup.model.objectives:
        if not isinstance(objective, (Minimise, Maximise)) or (name := objective.result) in given_by_studies(setup):
            continue
        if name in own and own[name].along:
            raise UsageError(f"study '{study}': the objective '{name}' runs along an axis; it must be one number")
        aims.append(Aim(name, isinstance(objective, Maximise), setup.print_unit(name)))
    if not aims:
        raise UsageError(
            f"study '{study}': {setup.model.name} says of no result of its function and of no price that it should be "
            "small or large; add Minimise(result) or Maximise(result) to its objectives"
        )
    return tuple(aims)


def given_by_studies(setup: Setup) -> set[str]:
    """Return the results that only studies give: no design has them while it is searched."""
    return {name for fields in setup.model.study_result_fields.values() for name in fields}


def bounds_of(setup: Setup) -> tuple[Bound, ...]:
    """Return the limits on results of the function and on the sum of the prices, those by chance last."""
    requires = requirements(setup)
    known = {*setup.model.own_result_fields, TOTAL_PRICE}
    bounds: list[Bound] = []
    for require in sorted(
        (require for require in requires if require.result in known),
        key=lambda require: require.reliability is not None,
    ):
        name = check_name(require, requires)
        if require.reliability is not None and any(bound.name == name for bound in bounds):
            name = f"{name} by chance"
        bounds.append(Bound(name, require))
    return tuple(bounds)


def left_out(setup: Setup) -> tuple[str, ...]:
    """Say which objectives and limits the search cannot see."""
    theirs = given_by_studies(setup)
    goals = [objective for objective in setup.model.objectives if isinstance(objective, (Minimise, Maximise))]
    named = [require.result for require in (*goals, *requirements(setup))]
    return tuple(
        f"'{name}' is given by a study once per run, so the search does not follow it"
        for name in dict.fromkeys(named)
        if name in theirs
    )


def constants(setup: Setup, answers: Mapping[str, Any]) -> ConstantAnswers:
    """Return the limits that are results of earlier studies: they stay what they are."""
    limits = {require.limit for require in requirements(setup)}
    theirs = limits & given_by_studies(setup) & set(answers)
    return tuple((name, float(answers[name])) for name in sorted(theirs) if np.ndim(answers[name]) == 0)


def margins(limit: Limit, world: Designs) -> Matrix:
    """Return how far every design (m,) keeps a limit on itself; along an axis the smallest margin."""
    values = np.asarray(world.value(limit.result), dtype=float)
    low, high = limit.low, limit.high
    if limit.require.kind == "within":
        half = (high - low) / 2
        above, scale = half - np.abs(values - (low + high) / 2), half
    elif limit.require.kind == "at_least":
        scale = beside(low, values)
        above = values - scale
    else:
        scale = beside(high, values)
        above = scale - values
    size = np.broadcast_to(np.abs(np.asarray(scale, dtype=float)), values.shape)
    margin = np.where(size > 0, above / np.where(size > 0, size, 1.0), above)
    return np.broadcast_to(margin.min(axis=tuple(range(1, margin.ndim))) if margin.ndim > 1 else margin, (world.rows,))


# What an optimisation may choose: inputs between bounds, inputs that follow a formula, the widths of what is priced


VariableKind = Literal["number", "whole", "width", "grade"]
SLACK = 1e-9
ConstantAnswers = tuple[tuple[str, float], ...]
"""Results of earlier studies that are limits, by name in SI."""


@dataclass(frozen=True)
class Variable:
    """One thing that may be chosen, between ``low`` and ``high`` (SI, or places of grades), and where it starts.

    With a ``step`` above 0 it takes whole multiples of it only.
    """

    name: str
    kind: VariableKind
    low: float
    high: float
    unit: str
    start: float
    step: float = 0.0

    @property
    def is_input(self) -> bool:
        """Whether it is an input; else it is a tolerance."""
        return self.kind in {"number", "whole"}

    @property
    def key(self) -> str:
        """Its name beside all others: that of the input, or ``tolerances.NAME``."""
        return self.name if self.is_input else f"tolerances.{self.name}"

    def chosen(self, value: float) -> str | float:
        """Return a value as it is chosen: a grade by its name, anything else in SI."""
        return GRADES[round(value)] if self.kind == "grade" else float(value)


@dataclass(frozen=True, eq=False)
class Space:
    """All variables of one setup, and the inputs that follow, each behind what it follows."""

    setup: Setup
    variables: tuple[Variable, ...]
    followers: Mapping[str, Formula]

    @cached_property
    def scatter(self) -> dict[str, dict[str, Distribution]]:
        """What scatters in the design that the inputs file states, by tolerance and input."""
        return self.setup.distributions()

    @property
    def moved(self) -> frozenset[str]:
        """The inputs that differ between designs."""
        return frozenset(variable.name for variable in self.variables if variable.is_input) | self.followers.keys()

    @property
    def start(self) -> Matrix:
        """The design that the inputs file states, as a row."""
        return np.array([variable.start for variable in self.variables])

    def designs(self, units: Matrix) -> Matrix:
        """Return designs (m, v) from places in the unit cube; variables with steps are at one of them."""
        low, high = self._ends()
        values = low + units * (high - low)
        steps = np.array([variable.step for variable in self.variables])
        stepped = steps * np.rint(values / np.where(steps > 0, steps, 1.0))
        return np.where(steps > 0, stepped, np.clip(values, low, high))

    def units(self, designs: Matrix) -> Matrix:
        """Return the places of designs in the unit cube, where they lie outside of it those nearest to them."""
        low, high = self._ends()
        return np.clip((designs - low) / (high - low), 0.0, 1.0)

    def _ends(self) -> tuple[Matrix, Matrix]:
        low = np.array([variable.low for variable in self.variables])
        return low, np.array([variable.high for variable in self.variables])

    def columns(self, designs: Matrix, *, as_stated: bool = False) -> dict[str, Any]:
        """Return the nominal inputs (m,) that differ; ``as_stated`` leaves followers as the file states them."""
        fields = self.setup.model.input_fields
        columns: dict[str, Any] = {
            variable.name: designs[:, index] for index, variable in enumerate(self.variables) if variable.is_input
        }
        for name, formula in self.followers.items():
            held = {other: self.setup.nominal(other) for other in formula.names}
            value = self.setup.nominal(name) if as_stated else evaluate_formula(formula, {**held, **columns})
            columns[name] = np.broadcast_to(np.asarray(value, dtype=float), (len(designs),))
        return {
            name: np.rint(values).astype(np.int64) if fields[name].kind == "integer" else values
            for name, values in columns.items()
        }

    def choices(self, designs: Matrix) -> dict[str, tuple[Variable, Matrix]]:
        """Return the tolerances that differ, by name: the variable and its values (m,)."""
        return {
            variable.name: (variable, designs[:, index])
            for index, variable in enumerate(self.variables)
            if not variable.is_input
        }

    def setup_of(self, design: Matrix) -> Setup:
        """Return the setup of one design, as an inputs file would state it."""
        columns = {name: values[0].item() for name, values in self.columns(design[None, :]).items()}
        choices = self.choices(design[None, :]).items()
        chosen = {name: variable.chosen(values[0]) for name, (variable, values) in choices}
        return with_tolerances(self.setup.changed(columns), chosen)


def open_space(setup: Setup, study: Optimise) -> Space:
    """Collect what may be chosen. Raises UsageError where there is nothing, or a name or range makes no sense."""
    stated = [objective for objective in setup.model.objectives if isinstance(objective, Vary)]
    inputs = [vary for vary in stated if not vary.by]
    tolerances = [tolerance for tolerance in setup.model.tolerances.values() if price_of(setup, tolerance) is not None]
    known = {*(vary.input for vary in inputs), *(tolerance.name for tolerance in tolerances)}
    kept = study.vary or known
    for name in kept:
        if name not in known:
            raise UsageError(
                f"study '{study.name}': vary names '{name}', which {setup.model.name} may not choose."
                f"{near_miss(name, sorted(known))}"
            )
    variables = [_of_input(setup, vary, study) for vary in inputs if vary.input in kept]
    widths = (_of_tolerance(setup, tolerance, study) for tolerance in tolerances if tolerance.name in kept)
    variables += [variable for variable in widths if variable is not None]
    if not variables:
        raise UsageError(
            f"study '{study.name}': {setup.model.name} has nothing to choose; add Vary(input, low, high) to its "
            "objectives or a price to a tolerance that is not off"
        )
    return Space(setup, tuple(variables), _followers(stated, study))


def _of_input(setup: Setup, vary: Vary, study: Optimise) -> Variable:
    input_field = setup.model.input_fields[vary.input]
    what = f"study '{study.name}': Vary('{vary.input}')"
    low, high = (_end(input_field, text, what) for text in (vary.low, vary.high))
    whole = input_field.kind in {"whole", "integer"}
    step = _step(input_field, vary.step, what) if vary.step else float(whole)
    if step:
        low, high = max(low, step * ceil(low / step - SLACK)), min(high, step * floor(high / step + SLACK))
    if not low < high:
        raise UsageError(
            f"{what} runs from {vary.low} to {vary.high}"
            f"{f' in steps of {vary.step}' if vary.step else ''}, which leaves nothing to choose"
        )
    start = float(setup.nominal(vary.input))
    if isnan(start):
        raise UsageError(f"{what} has no value to start from; give '{vary.input}' in the inputs")
    return Variable(vary.input, "whole" if whole else "number", low, high, setup.print_unit(vary.input), start, step)


def _step(input_field: InputField, text: str, what: str) -> float:
    """Read a step in SI. Raises UsageError for a text that is none, and for one that no value or no whole one meets."""
    step = _stated(text, difference_unit(input_field.unit), what)
    if not step > 0:
        raise UsageError(f"{what}: step = {text} must lie above 0")
    if input_field.kind in {"whole", "integer"} and not step.is_integer():
        raise UsageError(f"{what}: step = {text}, but '{input_field.name}' takes whole numbers")
    return step


def _stated(text: str, unit: str, what: str) -> float:
    try:
        return read_quantity(text, unit)
    except UnitError as error:
        raise UsageError(f"{what}: {error}") from None


def _end(input_field: InputField, text: str, what: str) -> float:
    """Read one end of a range in SI. Raises UsageError for a text that is none, or beyond the bounds of the input."""
    value = _stated(text, input_field.unit, what)
    broken = "" if input_field.kind == "whole" else broken_bound(input_field, value)
    if broken:
        raise UsageError(f"{what}: {broken}")
    return value


def _of_tolerance(setup: Setup, tolerance: Tolerance, study: Optimise) -> Variable | None:
    """Return a tolerance as a variable; None where it is off, drawn by a function, or has a single grade to take."""
    spread, price = setup.spread_of(tolerance.name), price_of(setup, tolerance)
    scattering = setup.distributions().get(tolerance.name, {})
    assert price is not None  # open_space has chosen these
    if not scattering or not isinstance(spread, (Band, Grade, Zone)):
        return None
    width = next(iter(scattering.values())).width
    if isinstance(spread, Grade):
        return _of_grade(setup, tolerance, spread, study, width)
    return Variable(tolerance.name, "width", study.tightest * width, study.widest * width, price.width, width)


def _of_grade(setup: Setup, tolerance: Tolerance, spread: Grade, study: Optimise, width: float) -> Variable | None:
    """Return a tolerance whose grade is chosen: from the finest allowed to the coarsest that is not too wide."""
    target, start = setup.target(tolerance.on[0]), GRADES.index(spread.grade)
    places = []
    for index, name in enumerate(GRADES):
        try:
            size = replace(spread, grade=name).width(target)
        except TruingError:  # ISO 286 has no such grade for the size
            continue
        if index == start or (index >= GRADES.index(study.finest) and size <= study.widest * width * (1 + SLACK)):
            places.append(index)
    if len(places) < 2:
        return None
    return Variable(tolerance.name, "grade", float(min(places)), float(max(places)), "", float(start), 1.0)


def _followers(stated: list[Vary], study: Optimise) -> dict[str, Formula]:
    """Return the inputs that follow a formula, each behind those it follows itself. Raises UsageError for a circle."""
    formulas = {vary.input: parse(vary.by) for vary in stated if vary.by}
    follows = {name: formula.names & formulas.keys() for name, formula in formulas.items()}
    try:
        return {name: formulas[name] for name in TopologicalSorter(follows).static_order()}
    except CycleError as error:
        circle = " and ".join(f"'{name}'" for name in formulas if name in error.args[1])
        raise UsageError(f"study '{study.name}': {circle} follow each other by their formulas in a circle") from None


# How much every input scatters in every design: means and standard deviations of many designs at once


Spreads = Mapping[str, Mapping[str, Distribution]]
"""By tolerance and input the distributions (m,) of m designs, SI; NaN where a design has none."""


def scattered(space: Space, designs: Matrix, columns: Mapping[str, Any]) -> Spreads:
    """Return how much every input scatters in every design; ``columns`` are the nominal inputs there."""
    choices = space.choices(designs)
    scatter = {}
    for name, inner in space.scatter.items():
        variable, values = choices.get(name, (None, None))
        spread = space.setup.spread_of(name)
        grades = values if variable is not None and variable.kind == "grade" else None
        by_column = {
            column: _resolved(space, spread, column, (base, columns, grades, len(designs)))
            for column, base in inner.items()
        }
        is_width = variable is not None and variable.kind == "width"
        scatter[name] = _widened(spread, by_column, values) if is_width else by_column
    return scatter


def _widened(spread: Spread, by_column: Mapping[str, Distribution], widths: Any) -> dict[str, Distribution]:
    """Bring a band to its chosen width (that of its first input); a zone grows where it says."""
    first = next(iter(by_column.values())).width
    with np.errstate(all="ignore"):
        factor = widths / first
    shift = shift_per_width(spread)
    return {
        column: replace(own, mean=own.mean + shift * (factor - 1) * own.width, sd=own.sd * factor)
        for column, own in by_column.items()
    }


def _resolved(
    space: Space,
    spread: Spread,
    column: str,
    given: tuple[Distribution, Mapping[str, Any], Matrix | None, int],
) -> Distribution:
    """Resolve one spread in every design, once for all of them where nothing it reads differs."""
    base, columns, grades, rows = given
    reads = sorted(_reads(spread, column) & space.moved)
    if not reads and grades is None:
        mean: Any = np.full(rows, base.mean)
        if column in columns:
            mean = columns[column] + (base.mean - float(space.setup.nominal(column)))
        return Distribution(mean, np.full(rows, base.sd), base.shape)
    places = np.full(rows, -1.0) if grades is None else grades
    nominal = columns.get(column, np.full(rows, float(space.setup.nominal(column))))
    keys = np.column_stack([places, *(columns[name] for name in reads)])
    unique, where = np.unique(keys, axis=0, return_inverse=True)
    resolved = [
        _of_design(space.setup, spread, column, dict(zip(reads, key[1:], strict=True)), key[0]) for key in unique
    ]
    shift, sd = (np.array(part)[where.reshape(-1)] for part in zip(*resolved, strict=True))
    return Distribution(nominal + shift, sd, base.shape)


def _of_design(
    setup: Setup, spread: Spread, column: str, values: Mapping[str, float], grade_index: float
) -> tuple[float, float]:
    """Return how far the mean lies from the nominal, and the standard deviation; NaN for no such grade."""

    def value_of(name: str) -> Any:
        return values.get(name, setup.nominal(name))

    if grade_index >= 0 and isinstance(spread, Grade):
        spread = replace(spread, grade=GRADES[round(grade_index)])
    target = Target(column, float(value_of(column)), setup.unit_of(column), value_of)
    try:
        distribution = spread.resolve(target)
    except TruingError:
        distribution = None
    if distribution is None:
        return float("nan"), float("nan")
    return distribution.mean - target.nominal, distribution.sd


def _reads(spread: Spread, column: str) -> frozenset[str]:
    """Return the inputs on which the width of a spread depends."""
    if isinstance(spread, Grade):
        return frozenset({spread.size or column})
    if isinstance(spread, Band):
        if spread.at_radius:
            return frozenset({spread.at_radius})
        return (
            frozenset({column}) if spread.amount.rstrip().endswith("%") or spread.shape == "lognormal" else frozenset()
        )
    return frozenset()


def total_prices(setup: Setup, spreads: Spreads, rows: int) -> Matrix:
    """Return what the tolerances of every design cost together (m,), in SI of the currency."""
    total = np.zeros(rows)
    for name, inner in spreads.items():
        price = price_of(setup, setup.model.tolerances[name])
        if price is not None:
            total = total + prices_at(price, next(iter(inner.values())).width)
    return np.asarray(to_si(total, setup.model.result_fields[TOTAL_PRICE].unit))


# With what probability do machines of many designs keep a limit? The same standard normal draws for every design


STEP = 0.1  # of a standard deviation, for central differences


Cloud = Mapping[str, Any]
"""By cause of scatter standard normal values (k, n), or deviations (n,) by column where a function draws them."""


def cloud_of(scatter: Scatter, seed: int, study: Optimise) -> Cloud:
    """Draw the machines once, for all designs; other random numbers than those of any verification."""
    draws = study.draws
    cloud: dict[str, Any] = {}
    for cause in scatter.causes:
        rng = generator(seed, 0, f"{study.name}: {cause.name}")
        if cause.function is not None:
            cloud[cause.name] = cause.function(rng, draws)
        else:
            strata = [(rng.permutation(draws) + rng.random(draws)) / draws for _ in cause.columns]
            cloud[cause.name] = ndtri(np.array(strata))
    return cloud if scatter.copula is None else scatter.copula.mixed(cloud)


def by_draws(problem: Problem, designs: Designs) -> Matrix:
    """Return the share of machines (m, limits) that keep each limit; a machine without an answer keeps none."""
    shape, wanted = (designs.rows, problem.study.draws), designs.by_chance
    columns = _machines(problem, designs)
    flat = {name: np.ascontiguousarray(values).reshape(-1) for name, values in columns.items()}
    results = problem.answer(flat, designs.rows * problem.study.draws, results_needed(designs.setup, wanted))
    each = {name: np.asarray(values).reshape(*shape, *np.shape(values)[1:]) for name, values in results.items()}
    shares = []
    for demand in wanted:
        response = demand.response(each, columns)
        with np.errstate(invalid="ignore"):
            inside = (response <= _per_design(demand.high, response)) & (response >= _per_design(demand.low, response))
        shares.append(_worst(inside.mean(axis=1)))
    return np.column_stack(shares)


def _per_design(limit: Any, values: Any) -> Any:
    """Bring a limit, a number or (m, ...), beside values (m, n, ...)."""
    if np.ndim(limit) == 0:
        return limit
    return beside(np.expand_dims(np.asarray(limit), 1), values)


def _worst(chances: Any) -> Any:
    """Return the smallest chance of every design where a result runs along an axis."""
    return chances.min(axis=tuple(range(1, chances.ndim))) if chances.ndim > 1 else chances


def _machines(problem: Problem, designs: Designs) -> dict[str, Any]:
    """Return the columns of all machines of all designs (m, n); two tolerances on one input add their deviations."""
    assert problem.cloud is not None  # else it is done to first order
    shape = (designs.rows, problem.study.draws)
    columns: dict[str, Any] = {}
    for cause in designs.causes:
        drawn = problem.cloud[cause.name]
        if cause.function is not None:
            gather(columns, cause.deviating(drawn))
        elif cause.name in designs.spreads:
            gather(columns, cause.from_standard(np.broadcast_to(drawn[:, None], (len(drawn), *shape))))
        else:
            gather(columns, cause.from_standard(drawn))
    still = {name: nominal[:, None] for name, nominal in designs.columns.items() if name not in columns}
    return {name: np.broadcast_to(values, shape) for name, values in {**columns, **still}.items()}


def by_first_order(problem: Problem, designs: Designs) -> Matrix:
    """Return the normal probability (m, limits) of the model made straight at every design; 0 where there is none."""
    wanted = designs.by_chance
    squares: dict[str, Any] = {}
    shifts: dict[str, Any] = {}
    for cause in designs.causes:
        for column, nominal, distribution in zip(cause.columns, cause.nominals, cause.distributions, strict=True):
            squares[column] = squares.get(column, 0.0) + designs.each(distribution.sd) ** 2
            shifts[column] = shifts.get(column, 0.0) + designs.each(distribution.mean - nominal)
    steps = {column: STEP * np.sqrt(square) for column, square in squares.items()}
    values = _beside_the_designs(problem, designs, steps, results_needed(designs.setup, wanted))
    chances = []
    for demand in wanted:
        mean, slopes = _line(demand.response(values, values), steps)
        sd = np.sqrt(np.maximum(_variance(designs, slopes), 0.0))
        for column, shift in shifts.items():
            if np.any(shift != 0):
                mean = mean + slopes[column] * beside(shift, slopes[column])
        chance = _worst(np.asarray(normal_chance(mean, sd, beside(demand.low, mean), beside(demand.high, mean))))
        chances.append(np.where(np.isfinite(chance), chance, 0.0))
    return np.column_stack(chances)


def _variance(designs: Designs, slopes: Mapping[str, Any]) -> Any:
    """Return the first-order variance of a response of every design from its slopes (m, ...) by column."""
    variance: Any = 0.0
    for cause in designs.causes:
        gradient = np.array([slopes[column] for column in cause.columns])
        if cause.mixing is not None:
            variance = variance + np.sum(gradient * np.tensordot(cause.covariance(), gradient, axes=1), axis=0)
            continue
        for slope, distribution in zip(gradient, cause.distributions, strict=True):
            variance = variance + (slope * beside(designs.each(distribution.sd), slope)) ** 2
    for pair in designs.scatter.pairs:
        first, second = designs.distribution(pair.first), designs.distribution(pair.second)
        covariance = designs.each(pearson(first, second, pair.coefficient) * first.sd * second.sd)
        product = slopes[pair.first] * slopes[pair.second]
        variance = variance + 2 * product * beside(covariance, product)
    return variance


def _beside_the_designs(
    problem: Problem, designs: Designs, steps: Mapping[str, Any], wanted: Sequence[str]
) -> dict[str, Any]:
    """Run every design, and every design with one column a step up and a step down: results (m, 1 + 2 k, ...)."""
    width, columns = 1 + 2 * len(steps), list(steps)
    batch: dict[str, Any] = {}
    for name in dict.fromkeys([*designs.columns, *columns]):
        values = np.repeat(designs.nominal(name)[:, None], width, axis=1)
        if name in steps:
            column = 1 + 2 * columns.index(name)
            values[:, column] += steps[name]
            values[:, column + 1] -= steps[name]
        batch[name] = values.reshape(-1)
    results = problem.answer(batch, designs.rows * width, wanted)
    inputs = {name: values.reshape(designs.rows, width) for name, values in batch.items()}
    shaped = {
        name: np.asarray(values).reshape(designs.rows, width, *np.shape(values)[1:]) for name, values in results.items()
    }
    return {**inputs, **shaped}


def _line(response: Any, steps: Mapping[str, Any]) -> tuple[Any, dict[str, Any]]:
    """Return the response at every design and its slopes by column; from one side where the other has no answer."""
    centre = response[:, 0]
    slopes: dict[str, Any] = {}
    for index, (column, size) in enumerate(steps.items()):
        step = beside(size, centre)
        up, down = response[:, 1 + 2 * index], response[:, 2 + 2 * index]
        with np.errstate(all="ignore"):
            slope = (up - down) / (2 * step)
            slope = np.where(np.isfinite(slope), slope, np.where(np.isfinite(up), up - centre, centre - down) / step)
        slopes[column] = np.where(step > 0, slope, 0.0)
    return centre, slopes
