"""Optimise: known fronts, least costs in closed form, and every array of the search against one design at a time."""

import itertools
import json
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.stats import norm
from study_models import GEAR, PAIR, PARTS, PRICED, ZDT1, grown, setup_of

from press_linkage.model import PRESS_LINKAGE
from truing import (
    Allocation,
    Maximise,
    Minimise,
    Optimise,
    Optimum,
    Reliability,
    Require,
    Surrogate,
    Table,
    Vary,
    Words,
    correlated,
    off,
)
from truing.calculation import calculate
from truing.errors import DeclarationError, UsageError
from truing.evaluate import evaluate, evaluate_rows
from truing.executors import WorkerPool
from truing.fits import GRADES
from truing.prices import price_answers, total_price
from truing.setup import Setup, default_setup
from truing.studies.checks import demands, limits, margin_of, plain_checks, worst
from truing.studies.first_order import chance, straightened
from truing.studies.optimise import (
    REFERENCE,
    Problem,
    answers_of,
    make_problem,
    open_space,
    volume_of,
)
from truing.studies.sampling import Scatter, gather, scatter_of

SMALL = Optimise(population=20, generations=12, draws=600, verify=2000)


def optimum(setup: Setup, *studies: Any) -> Optimum:
    found_ = calculate(replace(setup, studies=studies or setup.studies)).outcomes["optimise"]
    assert isinstance(found_, Optimum)
    return found_


def values(best: Optimum, *names: str) -> np.ndarray:
    return np.array([[design.objectives[name] for name in names] for design in best.front])


# Known fronts


def test_the_front_of_zdt1() -> None:
    best = optimum(setup_of(ZDT1), Optimise(population=60, generations=100))
    first, second = values(best, "first", "second").T
    away = second - (1 - np.sqrt(first))  # Zitzler, Deb, Thiele 2000: the front is 1 - sqrt(f1)
    assert len(best.front) == 60
    assert away.min() > -1e-12
    assert np.median(away) < 1e-3
    assert away.max() < 5e-3
    assert np.diff(np.sort(first)).max() < 0.05
    assert best.evaluations == 6_000
    # what the curve itself dominates of the box of our front, from its ideal to 1.1 of its extent
    assert best.volume is not None
    low, span = np.array(best.volume.ideal), np.array(best.volume.nadir) - np.array(best.volume.ideal)
    at = np.linspace(low[0], low[0] + REFERENCE * span[0], 100_001)
    room = low[1] + REFERENCE * span[1] - np.maximum(1 - np.sqrt(at), 0.0)
    assert best.volume.history[-1] == pytest.approx(np.trapezoid(room, at) / span.prod(), abs=5e-3)
    assert best.volume.settled
    # near f1 = 0 a gain of 1/1000 costs more than 1/50, the slope being above 20 before f1 = 1/1600: ours begins near
    start = first.min()
    assert start < 2 / 1600
    # on the curve from there to (1, 0) the chord is farthest where 1 / (2 sqrt(x)) is its slope
    root = (1 + math.sqrt(start)) / 2
    farthest = (1 - (root**2 - start) / (1 - start) - (1 - root) / (1 - math.sqrt(start))) / math.sqrt(2)
    assert best.knee is not None
    assert best.knee.objectives["first"] == pytest.approx(root**2, abs=0.05)
    assert best.distance == pytest.approx(farthest, rel=0.01)


def least_cost(permitted: float) -> float:
    """Lagrange: with w1^2 + w2^2 = V the cost a1/w1^2 + a2/w2^2 is least for w^4 ~ a; 1000 and 300 EUR um^2."""
    whole = 36 * (1e6 * permitted / norm.ppf((1 + 0.95) / 2)) ** 2
    return (math.sqrt(1000.0) + math.sqrt(300.0)) ** 2 / whole


def test_the_least_cost_of_two_tolerances_for_every_limit() -> None:
    study = Optimise(tightest=0.25, widest=4.0, chance="first_order", population=100, generations=200, verify=1000)
    best = optimum(setup_of(PAIR, law="square"), study)
    limits_ = np.array([design.inputs["permitted"] for design in best.front])
    least = np.array([least_cost(limit) for limit in limits_])
    over = values(best, "tolerance_price")[:, 0] / least - 1
    assert over.min() > -1e-9
    assert np.median(over) < 3e-3
    assert over.max() < 0.015
    assert (limits_.min(), limits_.max()) == pytest.approx((6e-6, 20e-6), rel=5e-3)
    assert all(design.chances["length"] >= 0.95 for design in best.front)


def press(**inputs: Any) -> Setup:
    objectives = [*PRESS_LINKAGE.objectives, Minimise("tolerance_price")]
    return default_setup(replace(PRESS_LINKAGE, objectives=objectives, studies=[], sheet=[], published=[]), **inputs)


DEAR = default_setup(replace(PRICED, objectives=[*PRICED.objectives, Minimise("tolerance_price")]))


@pytest.mark.parametrize(("setup", "unit"), [(DEAR, 1.0), (press(reading="printed"), 1e3)], ids=["priced", "press"])
def test_the_least_cost_of_grades_is_what_the_exact_program_of_the_allocation_finds(setup: Setup, unit: float) -> None:
    """The prices of the press are in 1/mm, and in the search in 1/m."""
    best = optimum(setup, Optimise(chance="first_order", population=30, generations=30, verify=1000, widest=1.7))
    assert {variable.kind for variable in best.variables} == {"grade"}
    exact = calculate(replace(setup, studies=(Allocation(loosen=True, draws=10),))).outcomes["allocation"].least  # type: ignore[attr-defined]
    assert best.knee is not None
    assert best.knee.tolerances == exact.grades
    assert best.knee.objectives["tolerance_price"] == pytest.approx(exact.cost * unit, rel=1e-12)
    assert best.knee.chances == pytest.approx(exact.chances, rel=1e-6)
    assert not best.start.feasible


# Whole numbers


def test_whole_numbers_stay_whole_and_the_best_gear_is_found() -> None:
    best = optimum(setup_of(GEAR))
    assert best.knee is not None
    gear = best.knee
    assert gear.inputs["teeth"] == 35  # the bore of 30 mm and 5 mm of rim need just more than 35 mm
    assert gear.inputs["module"] == pytest.approx(1e-3, rel=1e-3)
    assert gear.inputs["face"] == 10 * gear.inputs["module"]
    assert gear.inputs["starts"] == 1  # 35 / 2 is no ratio of 20
    assert gear.objectives["weight"] == pytest.approx(35e-3**2 * 10e-3, rel=3e-3)
    # 5 um of room over 9 um / 6 is 3.33 standard deviations; over IT6, 13 um / 6, it is 2.31 and 98.9 %
    assert gear.tolerances == {"bore": "IT5"}
    assert best.failed > 0
    for design in best.front:
        assert all(design.inputs[name] == round(design.inputs[name]) for name in ("teeth", "starts"))


def test_sizes_in_steps_are_whole_multiples_of_them() -> None:
    steps = [Vary("module", "0.95 mm", "2.6 mm", step="0.25 mm"), Vary("teeth", "20", "23", step="2")]
    goals = [*steps, Minimise("weight"), Maximise("ratio")]
    best = optimum(setup_of(replace(GEAR, objectives=goals, errors=[])), SMALL)
    chosen = {(round(design.inputs["module"] * 1e3, 9), design.inputs["teeth"]) for design in best.front}
    assert chosen <= {(module, teeth) for module in (1, 1.25, 1.5, 1.75, 2, 2.25, 2.5) for teeth in (20, 22)}
    assert chosen == {(1.75, 20), (1.75, 22)}  # 35 mm are asked for: 22 teeth of 1.5 mm are 33 mm
    said = json.loads(written(best))["variables"]
    assert said["module"] == {"kind": "input", "low": 1, "high": 2.5, "unit": "mm", "step": 0.25}
    assert (said["teeth"]["low"], said["teeth"]["high"]) == (20, 22)


def test_a_search_ends_when_every_design_was_tried() -> None:
    levels = [Vary("teeth", "20", "22"), Minimise("weight"), Maximise("ratio")]
    best = optimum(setup_of(replace(GEAR, objectives=levels, errors=[], studies=[])), SMALL)
    assert [design.inputs["teeth"] for design in best.front] == [20, 21, 22]
    assert best.volume is not None
    assert best.volume.settled
    assert list(best.warnings()) == []
    assert len(best.volume.history) < 12
    assert "no design was left" in best.blocks()[0].text  # type: ignore[union-attr]


# One design at a time: what the arrays of the search must say too


def problem_of(setup: Setup, **options: Any) -> tuple[Problem, np.ndarray]:
    problem = make_problem(setup, Optimise(**options))
    places = np.random.default_rng(5).random((7, len(problem.space.variables)))
    return problem, problem.space.designs(places)


TOGETHER = (
    correlated("force", "strength", 0.6), correlated("size", "other", -0.4), correlated("other", "twin", 0.5),
    correlated("clearance", "angle", 0.3),
)  # fmt: skip
SETUPS = [
    pytest.param(grown(), id="parts"),
    pytest.param(replace(grown(), correlations=TOGETHER), id="correlated"),
    pytest.param(press(crank_angle="35 deg"), id="press"),
]


@pytest.mark.parametrize("setup", SETUPS)
def test_answers_are_those_of_each_design_alone(setup: Setup) -> None:
    """Objectives, margins and prices, and chances both ways, by the functions of the other studies."""
    problem, designs = problem_of(setup, draws=700)
    straight_problem, _ = problem_of(setup, chance="first_order")
    drawn_, straight_ = (answers_of(each, designs) for each in (problem, straight_problem))
    assert not drawn_.failed.any()
    for row, design in enumerate(designs):
        one = problem.space.setup_of(design)
        answers = {**one.model.read_results(evaluate(one)), **price_answers(one)}
        assert answers["tolerance_price"] == pytest.approx(total_price(one), rel=1e-14)
        assert drawn_.objectives[row] == pytest.approx([answers[aim.name] for aim in problem.aims], rel=1e-12)
        checks = {check.name: check.margin for check in plain_checks(one, answers)}
        plain = [bound.name for bound in problem.bounds if not bound.by_chance]
        assert dict(zip(plain, drawn_.margins[row], strict=False)) == pytest.approx(checks, rel=1e-9, abs=1e-12)
        wanted, scatter = demands(one, answers, with_goal=True), scatter_of(one)
        lines, _ = straightened(scatter, wanted)
        assert straight_.chances[row] == pytest.approx(
            [worst(chance(demand, lines[demand.name])) for demand in wanted], abs=1e-5
        )
        columns = columns_of(scatter, problem)
        results = evaluate_rows(one, columns, problem.study.draws).results
        responses = [demand.response(results, columns) for demand in wanted]
        pairs = list(zip(wanted, responses, strict=True))
        shares = [worst(((here <= limit.high) & (here >= limit.low)).mean(axis=0)) for limit, here in pairs]
        assert drawn_.chances[row] == pytest.approx(shares, abs=1e-12)
        goals = [limit.goal for limit in limits(one, answers) if limit.goal is not None]
        by_chance = [margin_of(value, goal, at_least=True) for value, goal in zip(shares, goals, strict=True)]
        assert drawn_.margins[row, len(plain) :] == pytest.approx(by_chance, abs=1e-12)


def columns_of(scatter: Scatter, problem: Problem) -> dict[str, Any]:
    """The machines of one design from the standard values that all designs share."""
    assert problem.cloud is not None
    columns: dict[str, Any] = {}
    for cause in scatter.causes:
        drawn = problem.cloud[cause.name]
        gather(columns, cause.deviating(drawn) if cause.function else cause.from_standard(drawn))
    return columns


def test_a_design_as_an_inputs_file_states_it() -> None:
    problem, designs = problem_of(grown())
    keys = [variable.key for variable in problem.space.variables]
    assert keys[:4] == ["size", "force", "count", "span"]
    assert keys[4:] == [f"tolerances.{name}" for name in ("size", "both", "strength", "clearance")]
    setup = problem.space.setup_of(designs[0])
    assert setup.inputs.size == designs[0, 0]
    assert setup.inputs.other == setup.inputs.size * 0.6
    assert setup.inputs.radius == pytest.approx(setup.inputs.other * 5 + 0.01, rel=1e-15)
    assert setup.inputs.count == round(designs[0, 2])
    assert type(setup.inputs.count) is int
    assert setup.spreads["size"].text == GRADES[round(designs[0, 4])]
    spread = setup.distributions()
    assert spread["both"]["other"].width == pytest.approx(designs[0, 5], rel=1e-14)
    # one drawing, a share of each nominal: the other input has its own width
    assert spread["both"]["twin"].width == pytest.approx(designs[0, 5] * 0.010 / setup.inputs.other, rel=1e-12)
    # a zone that grows up keeps its lower end
    clearance = spread["clearance"]["clearance"]
    assert clearance.mean - clearance.width / 2 == pytest.approx(0.0, abs=1e-18)


def test_what_may_be_chosen_and_between_which_ends() -> None:
    setup = setup_of(PARTS)
    space = open_space(setup, Optimise(tightest=0.5, widest=3.0, finest="IT6"))
    ends = {variable.key: (variable.low, variable.high) for variable in space.variables}
    assert ends["tolerances.clearance"] == pytest.approx((6e-6, 36e-6), rel=1e-14)
    # 50 mm: IT8 is 39 um, IT10 100 um, IT11 160 um (ISO 286-1, table 1); 3 times 39 um is 117 um
    assert ends["tolerances.size"] == (GRADES.index("IT6"), GRADES.index("IT10"))
    start = {variable.key: variable.start for variable in space.variables}
    assert (start["tolerances.size"], start["force"]) == (GRADES.index("IT8"), 3000)
    with pytest.raises(UsageError, match="parts has nothing to choose; add Vary"):
        open_space(setup_of(replace(PARTS, objectives=[], errors=[])), Optimise())
    free = replace(setup, spreads={**setup.spreads, "clearance": off()})
    assert list(ends.keys() - {each.key for each in open_space(free, Optimise()).variables}) == [
        "tolerances.clearance"
    ]  # what is off is no variable
    for vary, keys in ((("span", "both"), ["span", "tolerances.both"]), (("size",), ["size", "tolerances.size"])):
        assert [each.key for each in open_space(setup, Optimise(vary=vary)).variables] == keys


# Same seed, same front


def written(best: Optimum) -> str:
    return json.dumps(best.as_json(), allow_nan=False)


def test_the_same_seed_gives_the_same_front_and_another_one_another() -> None:
    """Nobody reads the global state of numpy, or changes it."""
    study = replace(SMALL, generations=4, tightest=0.25, widest=4.0)
    once = written(optimum(replace(setup_of(PAIR), seed=0), study))
    np.random.seed(3)  # noqa: NPY002
    state = np.random.get_state()[1]  # noqa: NPY002
    assert written(optimum(replace(setup_of(PAIR), seed=0), study)) == once
    assert np.array_equal(np.random.get_state()[1], state)  # noqa: NPY002
    assert written(optimum(replace(setup_of(PAIR), seed=1), study)) != once


@pytest.mark.parametrize(("setup", "chance_"), [(setup_of(PAIR), "draws"), (grown(), "first_order")])
def test_processes_give_the_same_bytes(setup: Setup, chance_: Any, two_processes: WorkerPool) -> None:
    setup = replace(setup, studies=(replace(SMALL, generations=4, tightest=0.25, chance=chance_, parts=3),))
    apart = calculate(setup, executor=two_processes).outcomes["optimise"]
    assert written(apart) == written(calculate(setup).outcomes["optimise"])  # type: ignore[arg-type]


# What the outcome says


def test_the_knee_is_verified_by_other_machines() -> None:
    best = optimum(setup_of(PAIR), replace(SMALL, tightest=0.25, widest=4.0, verify=40_000))
    assert best.knee is not None
    sd = math.hypot(*(best.knee.tolerances[name] for name in ("one", "other"))) / 6  # type: ignore[arg-type]
    exact = 2 * norm.cdf(best.knee.inputs["permitted"] / sd) - 1
    low, high = best.interval["length"]
    assert low - 1e-3 < exact < high + 1e-3  # 95 % interval, and half of one on either side
    assert best.tally is not None
    assert best.tally.draws == 40_000
    assert best.verified["length"] != best.knee.chances["length"]


def test_too_few_draws_end_in_a_knee_that_misses_and_the_sheet_says_so() -> None:
    model = replace(PAIR, objectives=[Minimise("tolerance_price"), Require("length", within="12 um", reliability=0.95)])
    few = Optimise(tightest=0.25, widest=4.0, population=30, generations=30, draws=60, verify=40_000)
    seeds = [optimum(replace(setup_of(model), seed=seed), few) for seed in range(4)]
    missed = [best for best in seeds if any("the knee misses 'length'" in text for text in best.warnings())]
    assert missed
    assert all(best.interval["length"][1] < 0.95 for best in missed)


def test_nothing_feasible_is_a_status_and_no_number() -> None:
    """Where no design has an answer, it says so."""
    goal = Require("length", within="0.01 um", reliability=0.99)
    best = optimum(setup_of(replace(PAIR, objectives=[Minimise("tolerance_price"), goal])), SMALL)
    assert (best.front, best.knee, best.volume, best.verified) == ((), None, None, {})
    counted = f"no design among {best.evaluations} keeps every limit"
    assert best.status.startswith(f"{counted}; the nearest misses 'length' by a margin of -")
    assert list(best.warnings())[-1] == f"study 'optimise': {best.status}"
    document = json.loads(written(best))
    assert document["front"] == []
    assert not {"knee", "hypervolume"} & set(document)
    assert [type(block).__name__ for block in best.blocks()] == ["Words", "Table"]
    small = replace(GEAR, objectives=[Vary("module", "0.1 mm", "0.2 mm"), Minimise("weight")], studies=[])
    best = optimum(setup_of(small, teeth=31), SMALL)
    assert best.status == f"no design among {best.evaluations} keeps every limit: none has an answer"
    assert best.failed == best.evaluations
    assert math.isfinite(best.start.objectives["weight"])


def test_it_makes_no_check_so_that_a_failing_design_stays_one() -> None:
    done = calculate(
        replace(setup_of(PAIR, goal=0.99), studies=(Reliability(draws=5000), replace(SMALL, tightest=0.25)))
    )
    (check,) = done.checks
    best = done.outcomes["optimise"]
    assert (check.name, check.passed, best.checks()) == ("length", False, ())
    assert isinstance(best, Optimum)
    assert best.knee is not None
    assert (best.knee.feasible, best.start.feasible) == (True, False)


@pytest.mark.parametrize(("law", "price"), [("square", 1000 / 24**2 + 300 / 24**2), ("reciprocal", 1300 / 24)])
def test_a_choice_of_the_inputs_changes_the_prices_and_a_goal_may_be_too_fine(law: Any, price: float) -> None:
    best = optimum(setup_of(PAIR, law=law, goal=0.999), replace(SMALL, generations=1))
    assert best.start.objectives["tolerance_price"] == pytest.approx(price, rel=1e-12)
    assert "study 'optimise': 600 machines cannot tell 0.999 of 'length' from certainty" in best.warnings()


def test_results_json_and_the_start_are_those_of_the_inputs_file() -> None:
    setup = replace(grown(size="50 mm", other="31 mm"), units={"stress": "GPa"})  # other would follow as 30 mm
    best = optimum(setup, SMALL)
    assert best.start.inputs["other"] == pytest.approx(0.031)
    assert best.start.tolerances["size"] == "IT8"
    assert best.start.objectives["tolerance_price"] == pytest.approx(total_price(setup), rel=1e-14)
    assert best.start.objectives["stress"] == pytest.approx(float(evaluate(setup).stress), rel=1e-14)
    document = json.loads(written(best))
    first, said = best.front[0], document["front"][0]
    assert said["objectives"]["stress"] == pytest.approx(first.objectives["stress"] / 1e9)
    assert said["inputs"]["size"] == pytest.approx(first.inputs["size"] * 1e3)
    assert said["tolerances"]["strength"] == pytest.approx(first.tolerances["strength"])
    assert document["variables"]["tolerances.size"] == {"kind": "grade", "finest": "IT5", "coarsest": "IT9"}
    assert document["variables"]["count"] == {"kind": "whole", "low": 1, "high": 5, "unit": ""}
    assert document["objectives"]["load"] == {"sense": "maximise", "unit": "kN"}
    assert len(document["hypervolume"]["history"]) == 12
    assert document["knee"]["place"] == best.knee_place
    # one result with a limit on the design and one on its machines: two entries
    assert {"length within", "length within by chance", "course at least", "course within"} <= set(first.margins)


@pytest.mark.parametrize("setup", [grown(), setup_of(PAIR), setup_of(GEAR)], ids=["parts", "pair", "gear"])
def test_no_design_of_a_front_beats_another_and_the_sheet_shows_it(setup: Setup) -> None:
    best = optimum(setup, SMALL)
    names = [aim.name for aim in best.problem.aims]
    small = values(best, *names) * [aim.sign for aim in best.problem.aims]
    assert not any((one <= other).all() for one, other in itertools.permutations(small, 2))
    titles = ["Start and knee", "Front", "Front, start and knee", "Hypervolume over the generations"]
    blocks = [block for block in best.blocks() if not isinstance(block, Words)]
    shown = titles if len(best.front) > 1 else [titles[0], titles[-1]]
    assert list(dict.fromkeys(block.title.partition(", part")[0] for block in blocks)) == shown
    for block in blocks:
        if isinstance(block, Table):
            assert all(len(row) == len(block.columns) for row in block.rows)
            assert len(block.rows) <= 24
        else:
            block.draw().canvas.draw()


def test_the_hypervolume_of_known_fronts() -> None:
    last = np.array([[0.0, 1.0], [0.5, 0.5], [1.0, 0.0]])
    found_ = volume_of([np.zeros((0, 2)), np.array([[0.5, 0.5]]), last])
    # against (1.1, 1.1): nothing; a square of 0.6; and by strips 0.5*0.1 + 0.5*0.6 + 0.1*1.1
    assert found_.history == pytest.approx((0.0, 0.36, 0.05 + 0.3 + 0.11), rel=1e-12)
    one = volume_of([np.array([[4.0]]), np.array([[3.0]]), np.array([[2.0]])])
    assert one.history == pytest.approx((REFERENCE - 1, REFERENCE - 0.5, REFERENCE), rel=1e-12)
    corners = volume_of([np.array([[0.0, 0.0, 1.0], [1.0, 1.0, 0.0]])])  # two boxes that meet in one of 0.1^3
    assert corners.history[0] == pytest.approx(1.1**2 * 0.1 + 0.1**2 * 1.1 - 0.1**3, rel=1e-12)


# Surrogate on request


def test_a_learnt_surrogate_finds_the_front_and_says_where_it_learnt_nothing() -> None:
    learnt = Surrogate(of=("first", "second"), over={"x1": "0.1..1", "x2": "0..1"}, design=60, held_out=20, compare=0)
    study = Optimise(vary=("x1", "x2"), population=40, generations=20, surrogate=True)
    best = optimum(setup_of(ZDT1), learnt, study)
    first, second = values(best, "first", "second").T
    inside = first > 0.1
    assert second[inside] == pytest.approx(1 - np.sqrt(first[inside]), abs=0.02)
    counted = sum(design.inputs["x1"] < 0.1 for design in best.front)
    assert counted > 0
    words = f"study 'optimise': {counted} of {len(best.front)} designs of the front lie outside the surrogate's box"
    assert words in best.warnings()
    assert best.knee is not None
    assert best.exact["first"] == pytest.approx(best.knee.inputs["x1"], rel=1e-12)
    assert json.loads(written(best))["surrogate"] is True
    assert "The surrogate answered" in best.blocks()[0].text  # type: ignore[union-attr]


# Bad input: one sentence


SIZE = Vary("size", "1 mm", "2 mm")
CIRCLE = [Vary("size", by="2 * other"), Vary("other", by="size / 2"), Vary("span", "1 mm", "2 mm")]
WRONG = [
    ([SIZE], {}, "study 'optimise': parts says of no result of its function and of no price"),
    ([SIZE, Minimise("course")], {}, "study 'optimise': the objective 'course' runs along an axis"),
    ([*CIRCLE, Minimise("stress")], {}, "'size' and 'other' follow each other by their formulas in a circle"),
    ([Vary("other", by="2 * sise")], {}, "follows sise, which is no input"),
    *(
        ([Vary(name, low, high), Minimise("stress")], {}, f"study 'optimise': Vary('{name}'){words}")
        for name, low, high, words in [
            ("size", "2 mm", "1 mm", " runs from 2 mm to 1 mm"),
            ("size", "1 mm", "1e-3 m", " runs from 1 mm to 1e-3 m"),
            ("count", "1.2", "1.8", " runs from 1.2 to 1.8"),
            ("size", "1 kg", "2 kg", ": '1 kg'"),
            ("force", "0 kN", "2 kN", ": force is 0 kN; it must"),
        ]
    ),
    *(
        ([Vary(name, low, high, step=step), Minimise("stress")], {}, f"study 'optimise': Vary('{name}'){words}")
        for name, low, high, step, words in [
            ("size", "1 mm", "2 mm", "3 mm", " runs from 1 mm to 2 mm in steps of 3 mm, which leaves nothing"),
            ("size", "1 mm", "2 mm", "1 kg", ": '1 kg'"),
            ("size", "1 mm", "2 mm", "-1 mm", ": step = -1 mm must lie above 0"),
            ("count", "1", "5", "1.5", ": step = 1.5, but 'count' takes whole numbers"),
        ]
    ),
    (None, {"vary": ("spam",)}, "vary names 'spam', which parts may not choose. Did you mean 'span'"),
    (None, {"surrogate": True}, "study 'optimise': surrogate = true, but no Surrogate ran before it"),
    (None, {"population": 3}, "population = 3, but a population has 4 to 10000 designs"),
    (None, {"generations": 0}, "generations = 0, but a search has 1 to 100000 generations"),
    (None, {"tightest": 2.0, "widest": 1.0}, "tightest = 2 and widest = 1, but widths run"),
    (None, {"tightest": 0.0}, "tightest = 0 and widest = 2, but widths run"),
    (None, {"finest": "IT19"}, "'IT19' is no tolerance grade"),
    (None, {"draws": 0}, "draws, verify, batch and parts are at least 1"),
    (None, {"chance": "luck"}, "chance takes draws or first_order, not 'luck'"),
    (None, {"algorithm": "annealing"}, "the algorithm 'annealing' is unknown; there is nsga2"),
]


@pytest.mark.parametrize(("objectives", "options", "words"), WRONG)
def test_what_cannot_be_searched_is_one_sentence(objectives: Any, options: dict[str, Any], words: str) -> None:
    changed = {} if objectives is None else {"objectives": objectives}
    with pytest.raises((UsageError, DeclarationError)) as refused:
        optimum(setup_of(replace(PARTS, **changed)), replace(SMALL, **options))
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)
