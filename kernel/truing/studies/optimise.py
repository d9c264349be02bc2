"""Which design do I want? Variables, objectives and limits as the model declares them, and the front between them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal

from truing.declare.blocks import Block
from truing.errors import InfeasibleError, UsageError
from truing.evaluate import acting_inputs, evaluate
from truing.fits import GRADES
from truing.prices import price_answers
from truing.setup import Setup
from truing.studies.bench import Bench, Check
from truing.studies.demands import Demand, demands, wilson
from truing.studies.optimise_front import Volume, knee_of, volume_of
from truing.studies.optimise_goals import Aim, Bound, constants, left_out
from truing.studies.optimise_problem import Answers, Problem, StandIn, answered, answers_of, make_problem
from truing.studies.optimise_search import Plan, Trail, search, small, violation
from truing.studies.optimise_space import Brief, Variable
from truing.studies.sampling import Budget, Machines, Tally, sample
from truing.studies.scatter import scatter_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

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
    batch: int = 2**14
    parts: int = 1
    name: str = "optimise"
    gives: Callable[[Optimum], Any] | None = None

    def __post_init__(self) -> None:
        _check_options(self)

    def run(self, bench: Bench) -> Optimum:
        """Search, and verify the knee. Raises UsageError without a variable or an objective."""
        setup = bench.setup
        problem = make_problem(setup, self._brief(bench))
        if self.surrogate:
            problem = replace(problem, stand_in=_stand_in(bench, self.name))
        plan = Plan(self.population, self.generations, setup.seed)

        def done(generation: int, total: int) -> None:
            bench.progress(self.name, generation, total + 1)

        trail = search(problem, plan, lambda designs: answered(problem, designs, bench.executor), done)
        optimum = _optimum(self, problem, trail)
        return optimum if optimum.knee_place is None else self._verified(bench, problem, optimum, trail)

    def _brief(self, bench: Bench) -> Brief:
        return Brief(
            study=self.name,
            vary=tuple(self.vary),
            tightest=self.tightest,
            widest=self.widest,
            finest=self.finest,
            chance=self.chance,
            draws=self.draws,
            parts=self.parts,
            known=constants(bench.setup, bench.answers),
        )

    def _verified(self, bench: Bench, problem: Problem, optimum: Optimum, trail: Trail) -> Optimum:
        """Run the knee as an inputs file would state it, and draw machines of it."""
        place = optimum.knee_place
        assert place is not None  # run has asked
        setup = problem.space.setup_of(_sorted(problem, trail)[0][place])
        try:
            answers = {**dict(problem.brief.known), **setup.model.read_results(evaluate(setup)), **price_answers(setup)}
        except InfeasibleError as error:
            remark = f"the model itself has no answer at the knee ({error})"
            return replace(optimum, remarks=(*optimum.remarks, remark))
        exact = {aim.name: float(answers.get(aim.name, _input(setup, aim.name))) for aim in problem.aims}
        wanted = demands(setup, answers, with_goal=True)
        tally = None
        if wanted:

            def done(draws: int, total: int) -> None:
                bench.progress(self.name, self.generations * total + draws, (self.generations + 1) * total)

            budget = Budget(self.verify, self.batch, bench.executor, done)
            tally = sample(Machines(setup, scatter_of(setup)), wanted, answers, budget)
        return replace(optimum, exact=exact, demands=tuple(wanted), tally=tally)


def _check_options(study: Optimise) -> None:
    """Refuse options that make no sense, with one sentence."""
    if study.algorithm not in ALGORITHMS:
        raise UsageError(f"the algorithm '{study.algorithm}' is unknown; there is {', '.join(ALGORITHMS)}")
    if study.chance not in CHANCES:
        raise UsageError(f"chance takes {' or '.join(CHANCES)}, not '{study.chance}'")
    if not 4 <= study.population <= 10_000:
        raise UsageError(f"population = {study.population}, but a population has 4 to 10000 designs")
    if not 1 <= study.generations <= 100_000:
        raise UsageError(f"generations = {study.generations}, but a search has 1 to 100000 generations")
    if not 0 < study.tightest < study.widest:
        raise UsageError(
            f"tightest = {study.tightest:g} and widest = {study.widest:g}, but widths run from a smaller factor "
            "above 0 to a larger one"
        )
    if study.finest not in GRADES:
        raise UsageError(f"'{study.finest}' is no tolerance grade; write IT1 to IT18")
    if min(study.draws, study.verify, study.batch, study.parts) < 1:
        raise UsageError("draws, verify, batch and parts are at least 1")


def _stand_in(bench: Bench, study: str) -> StandIn:
    """Return the outcome of the surrogate study that ran before."""
    for outcome in bench.outcomes.values():
        if isinstance(outcome, StandIn):
            return outcome
    raise UsageError(f"study '{study}': surrogate = true, but no Surrogate ran before it; list it first in run = [...]")


def _input(setup: Setup, name: str) -> float:
    return float(setup.nominal(name)) if name in setup.model.input_fields else float("nan")


def _sorted(problem: Problem, trail: Trail) -> tuple[NDArray[np.float64], Answers]:
    """Return designs and answers in the order of the first objective, then of the others."""
    import numpy as np

    values = trail.answers.objectives * np.array([aim.sign for aim in problem.aims])
    order = np.lexsort(values.T[::-1])
    return trail.designs[order], trail.answers[order]


def _optimum(study: Optimise, problem: Problem, trail: Trail) -> Optimum:
    designs, answers = _sorted(problem, trail)
    feasible = bool(answers.feasible.all())
    start = problem.space.start[None, :]
    place, distance = knee_of(small(problem, answers)) if feasible else (None, 0.0)
    return Optimum(
        study=study,
        problem=problem,
        front=tuple(_designs(problem, designs, answers)) if feasible else (),
        start=_designs(problem, start, answers_of(problem, start, as_stated=True), as_stated=True)[0],
        knee_place=place,
        distance=distance,
        status=FOUND if feasible else _nothing(problem, trail),
        volume=volume_of(trail.fronts, exhausted=len(trail.fronts) < study.generations) if feasible else None,
        evaluations=trail.evaluations,
        failed=trail.failed,
        remarks=(*left_out(problem.setup), *_too_few(problem), *_beyond(problem, designs)),
        inputs=acting_inputs(problem.setup),
    )


def _nothing(problem: Problem, trail: Trail) -> str:
    """Say that no design keeps every limit, and which limit the nearest one misses most."""
    import numpy as np

    counted = f"no design among {trail.evaluations} keeps every limit"
    place = int(np.argmin(violation(trail.answers)))
    if trail.answers.failed[place]:
        return f"{counted}: none has an answer"
    margins = trail.answers.margins[place]
    worst = int(np.argmin(margins))
    return f"{counted}; the nearest misses '{problem.bounds[worst].name}' by a margin of {margins[worst]:.3g}"


def _too_few(problem: Problem) -> tuple[str, ...]:
    """Name the goals that so few machines cannot tell from certainty."""
    if problem.cloud is None:
        return ()
    words = []
    for bound in problem.by_chance:
        goal = bound.require.reliability
        goal = float(problem.setup.nominal(goal)) if isinstance(goal, str) else goal
        if goal is not None and problem.cloud.draws * (1 - goal) < 1:
            words.append(f"{problem.cloud.draws} machines cannot tell {goal:g} of '{bound.name}' from certainty")
    return tuple(words)


def _beyond(problem: Problem, designs: NDArray[np.float64]) -> tuple[str, ...]:
    """Say how many designs of the front lie where the surrogate learnt nothing."""
    import numpy as np

    outside = getattr(problem.stand_in, "extrapolated", None)
    count = int(np.sum(outside(problem.space.columns(designs)))) if outside is not None else 0
    return (f"{count} of {len(designs)} designs of the front lie outside the surrogate's box",) if count else ()


@dataclass(frozen=True, kw_only=True)
class Design:
    """One design: ``inputs`` in SI, ``tolerances`` as full widths in SI or grades, and what it is worth.

    ``objectives`` are in SI, ``margins`` of every limit above 0 safe, ``chances`` by check; NaN where it has no answer.
    """

    inputs: Mapping[str, float]
    tolerances: Mapping[str, float | str]
    objectives: Mapping[str, float]
    margins: Mapping[str, float]
    chances: Mapping[str, float]
    feasible: bool


def _designs(
    problem: Problem, designs: NDArray[np.float64], answers: Answers, *, as_stated: bool = False
) -> list[Design]:
    """Return the designs (m, v) by name."""
    columns = problem.space.columns(designs, as_stated=as_stated)
    choices = problem.space.choices(designs)
    by_chance = problem.by_chance
    return [
        Design(
            inputs={name: float(values[row]) for name, values in columns.items()},
            tolerances={
                name: GRADES[round(values[row])] if variable.kind == "grade" else float(values[row])
                for name, (variable, values) in choices.items()
            },
            objectives={aim.name: float(answers.objectives[row, i]) for i, aim in enumerate(problem.aims)},
            margins={bound.name: float(answers.margins[row, i]) for i, bound in enumerate(problem.bounds)},
            chances={bound.name: float(answers.chances[row, i]) for i, bound in enumerate(by_chance)},
            feasible=bool(answers.feasible[row]),
        )
        for row in range(len(designs))
    ]


@dataclass(frozen=True, kw_only=True)
class Optimum:
    """The designs that no other beats, in the order of the first objective, and the knee among them.

    ``start`` is the design that the inputs file states. Without any feasible design ``front`` is empty, ``knee`` None
    and ``status`` says why. ``exact`` holds the knee's objectives (SI) by the model itself, ``verified`` the share of
    machines of it that meet each goal, ``volume`` the hypervolume of every generation. ``inputs`` are the run's.
    """

    study: Optimise
    problem: Problem = field(repr=False)
    front: tuple[Design, ...]
    start: Design
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

    @property
    def name(self) -> str:
        """The name of the study."""
        return self.study.name

    @property
    def knee(self) -> Design | None:
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
        tally = self.tally
        return {} if tally is None else {name: _least(hits) / tally.draws for name, hits in tally.hits.items()}

    @property
    def interval(self) -> dict[str, tuple[float, float]]:
        """Wilson's 95 % interval of each of these shares."""
        tally = self.tally
        return {} if tally is None else {name: wilson(_least(hits), tally.draws) for name, hits in tally.hits.items()}

    def as_json(self) -> dict[str, Any]:
        """Return front, knee, start, hypervolume and status in printed units."""
        from truing.studies.optimise_printed import optimum_json

        return optimum_json(self)

    def blocks(self) -> Sequence[Block]:
        """Return start against knee, the front, and both figures."""
        from truing.studies.optimise_printed import optimum_blocks

        return optimum_blocks(self)

    def checks(self) -> Sequence[Check]:
        """Return nothing: the checks judge the design that the inputs file states, and that is not the optimum."""
        return ()

    def warnings(self) -> Sequence[str]:
        """Say what was not found, what the exact model contradicts, and whether the search had settled."""
        from truing.studies.optimise_printed import optimum_warnings

        return [f"study '{self.name}': {text}" for text in optimum_warnings(self)]


def _least(hits: Any) -> float:
    """Return the smallest count along an axis, or the count itself."""
    import numpy as np

    return float(np.min(hits))
