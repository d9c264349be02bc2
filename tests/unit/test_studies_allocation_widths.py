"""Widths bought by their price: Lagrange's closed form, trying everything, zones that move the mean."""

from __future__ import annotations

import itertools
import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar
from scipy.stats import norm
from study_models import PRICED, setup_of

from truing import (
    Allocation,
    Allotted,
    Float,
    Model,
    Price,
    Require,
    Table,
    Tolerance,
    drawn,
    found,
    given,
    inputs,
    normal,
    off,
    plus_minus,
    results,
    uniform,
    zone,
)
from truing.calculation import calculate
from truing.declare.spreads import read_spread
from truing.errors import UsageError
from truing.fits import GRADES, tolerance
from truing.setup import Setup
from truing.studies.allocation import ToleranceVariable, prices_at


@inputs
class Row:
    """Four lengths."""

    a: Float = given(0.0, "mm")
    b: Float = given(0.0, "mm")
    c: Float = given(0.0, "mm")
    d: Float = given(0.0, "mm")


@results
class End:
    """Where the last one ends."""

    end: Float = found("mm")


WEIGHTS = {"a": 1.0, "b": 2.0, "c": -0.5}


def row(lengths: Row) -> End:
    """A weighted sum."""
    return End(end=lengths.a + 2.0 * lengths.b - 0.5 * lengths.c + lengths.d)


def only_d(lengths: Row) -> End:
    """The last length alone."""
    return End(end=lengths.d + 0.0 * lengths.a)


def euro(formula: str) -> Price:
    return Price(formula, width="mm", unit="EUR")


POWER = 0.7
COSTS = {"a": 3.0, "b": 1.0, "c": 5.0}
ROW = Model(
    name="row", title="Lengths in a row", function=row,
    errors=[
        *(Tolerance(name, normal(band="0.3 mm"), price=euro(f"{cost} * width**-{POWER}"))
          for name, cost in COSTS.items()),
        Tolerance("d", normal(sd="0.02 mm")),
    ],
    objectives=[Require("end", within="0.2 mm", reliability=0.99)],
)  # fmt: skip


def allotted(model: Model[Any, Any], setup: Setup | None = None, **options: Any) -> Allotted:
    study = Allocation(**{"draws": 1000, **options})
    answer = calculate(replace(setup or setup_of(model), studies=(study,))).outcomes["allocation"]
    assert isinstance(answer, Allotted)
    return answer


def limited(model: Model[Any, Any], *objectives: Require) -> Model[Any, Any]:
    return replace(model, objectives=list(objectives))


@pytest.mark.parametrize(
    ("require", "times"),
    [
        (Require("end", within="0.2 mm", reliability=0.99), norm.ppf(0.995)),
        (Require("end", at_most="0.2 mm", reliability=0.99), norm.ppf(0.99)),
        (Require("end", at_least="-0.2 mm", reliability=0.999), norm.ppf(0.999)),
    ],
)
def test_prices_of_one_power_have_lagranges_closed_form(require: Require, times: float) -> None:
    """Prices c/w^p at a given sum of (s w/6)^2: every width is in proportion to (c p/s^2)^(1/(p + 2))."""
    variance = (0.2 / times) ** 2 - 0.02**2
    shape = {name: (COSTS[name] * POWER / WEIGHTS[name] ** 2) ** (1 / (POWER + 2)) for name in COSTS}
    scale = (variance / sum((WEIGHTS[name] * shape[name] / 6) ** 2 for name in shape)) ** 0.5
    answer = allotted(limited(ROW, require), tightest=0.01, widest=100.0)
    widths = {name: 1e3 * width for name, width in answer.least.widths.items()}
    assert widths == pytest.approx({name: scale * one for name, one in shape.items()}, rel=1e-5)
    assert answer.cost == pytest.approx(sum(COSTS[name] * (scale * shape[name]) ** -POWER for name in shape), rel=1e-9)
    assert answer.reached
    assert answer.final["end"] == pytest.approx(require.reliability, abs=1e-9)
    assert answer.rule.residual is not None
    assert answer.rule.residual < 1e-5


def test_a_width_at_its_end_stays_there_and_the_others_share_the_rest() -> None:
    """With 0.15 mm the most that a may have, b and c keep Lagrange's ratio."""
    answer = allotted(ROW, tightest=0.01, widest=0.5)
    widths = {name: 1e3 * width for name, width in answer.least.widths.items()}
    free = allotted(ROW, tightest=0.01, widest=100.0).least.widths
    at_end = [name for name in widths if 1e3 * free[name] > 0.15]
    assert at_end
    for name in at_end:
        assert widths[name] == pytest.approx(0.15, rel=1e-9)
    inner = [name for name in COSTS if name not in at_end]
    shape = {name: (COSTS[name] / WEIGHTS[name] ** 2) ** (1 / (POWER + 2)) for name in inner}
    assert [widths[name] / shape[name] for name in inner] == pytest.approx(
        [widths[inner[0]] / shape[inner[0]]] * len(inner)
    )


GROWING = Model(
    name="growing", title="Zones that grow", function=row,
    errors=[
        Tolerance("a", zone("0 mm", "0.2 mm", grows="up"), price=euro("2 * width**-0.5 + exp(-3 * width)")),
        Tolerance("b", zone("-0.05 mm", "0.05 mm"), price=euro("1.5 * width**-0.9 + 1")),
    ],
    objectives=[Require("end", at_most="0.25 mm", reliability=0.95)],
)  # fmt: skip


def by_trying(low: float, high: float, goal: float) -> float:
    """The least price of GROWING: for every width of a (mm) the widest b that still meets the goal."""

    def chance(a: float, b: float) -> float:
        sd = ((a / 6) ** 2 + (2 * b / 6) ** 2) ** 0.5
        return float(norm.cdf((high - a / 2) / sd) - norm.cdf((low - a / 2) / sd))

    def price(a: float) -> float:
        if chance(a, 0.01) < goal:
            return np.inf
        b = 1.0 if chance(a, 1.0) >= goal else brentq(lambda b: chance(a, b) - goal, 0.01, 1.0, xtol=1e-14)
        return float(2 * a**-0.5 + np.exp(-3 * a) + 1.5 * b**-0.9 + 1)

    grid = np.linspace(0.02, 1.9, 400)
    best = grid[int(np.argmin([price(a) for a in grid]))]
    return float(
        minimize_scalar(price, bounds=(best - 0.01, best + 0.01), method="bounded", options={"xatol": 1e-10}).fun
    )


@pytest.mark.parametrize(
    ("require", "low", "high", "goal"),
    [
        (Require("end", at_most="0.25 mm", reliability=0.95), -np.inf, 0.25, 0.95),
        (Require("end", at_most="0.25 mm", reliability=0.999), -np.inf, 0.25, 0.999),
        (Require("end", within="0.3 mm", reliability=0.97), -0.3, 0.3, 0.97),
    ],
)
def test_zones_that_grow_move_the_mean_too(require: Require, low: float, high: float, goal: float) -> None:
    """A zone that grows up from 0 has its mean at half its width; ``within`` is measured from the nominal, 0."""
    answer = allotted(limited(GROWING, require), tightest=0.1, widest=10.0)
    assert answer.reached
    assert answer.cost == pytest.approx(by_trying(low, high, goal), rel=1e-7)


def test_monte_carlo_verifies_what_was_bought() -> None:
    answer = allotted(GROWING, draws=200_000)
    for design in ("start", "least"):
        chance = answer.problem.chances(answer.least.widths if design == "least" else {})["end"]
        error = (chance * (1 - chance) / 200_000) ** 0.5
        assert answer.monte_carlo[design]["end"] == pytest.approx(chance, abs=4 * error)
    assert answer.final["end"] == pytest.approx(0.95, abs=1e-9)
    assert answer.tolerances["a"].startswith("zone 0.0 mm .. ") or answer.tolerances["a"].startswith("zone 0 mm .. ")


def test_two_goals_at_once() -> None:
    """Both sides demanded: what meets both is dearer than what meets either, and both are met."""
    above = Require("end", at_most="0.25 mm", reliability=0.95)
    below = Require("end", at_least="0.0 mm", reliability=0.99)
    one, other, both = (allotted(limited(GROWING, *goals)) for goals in ((above,), (below,), (above, below)))
    assert both.reached
    assert both.cost > max(one.cost, other.cost)
    assert min(both.final["end at most"] - 0.95, both.final["end at least"] - 0.99) >= 0


def test_a_goal_out_of_reach_says_how_far_it_came() -> None:
    """At best every width is half: sd 0.02 and 0.025 * sqrt(1 + 4 + 0.25) mm, so 0.2 mm are kept this often."""
    answer = allotted(limited(ROW, Require("end", within="0.1 mm", reliability=0.99)), tightest=0.5, widest=2.0)
    sd = (0.02**2 + 5.25 * 0.025**2) ** 0.5
    assert not answer.reached
    assert answer.final["end"] == pytest.approx(2 * norm.cdf(0.1 / sd) - 1, rel=1e-9)
    assert answer.rule.status == "not reachable: no widths from 0.5 to 2 times those in force meet it"
    assert any("not reachable" in text and "of 0.99" in text for text in answer.warnings())
    assert not any(check.passed for check in answer.checks())
    table = [block for block in answer.blocks() if isinstance(block, Table)][-1]
    assert {line[-1] for line in table.rows} == {"tightest"}


def test_the_cost_is_that_of_the_run_and_every_price_is_paid_once() -> None:
    """One band on two inputs: 2/w once; the start costs what the run itself says."""
    pair = Tolerance("pair", plus_minus("0.1 mm"), on=["a", "b"], price=euro("2 / width"))
    model = replace(ROW, errors=[pair, Tolerance("c", off(), price=euro("1 / width"))])
    run = calculate(replace(setup_of(model), studies=(Allocation(draws=10),)))
    answer = run.outcomes["allocation"]
    assert isinstance(answer, Allotted)
    assert set(answer.tolerances) == {"pair"}
    assert answer.as_json()["start"]["cost"] == {"value": pytest.approx(10.0), "unit": "EUR"}
    assert run.answers["tolerance_price"] == pytest.approx(10.0)
    sd = 0.2 / norm.ppf(0.995)
    assert 1e3 * answer.least.widths["pair"] == pytest.approx(6 * sd / 5**0.5, rel=1e-9)


def test_shares_and_uniform_bands_keep_their_words() -> None:
    """A uniform band of width w has the variance w^2/12: with 1/w for both, w ~ (k/s^2)^(1/3), k = 12 and 36."""
    model = replace(
        ROW,
        errors=[
            Tolerance("a", uniform("0.1 mm"), price=euro("1 / width")),
            Tolerance("b", normal(sd="1 %"), price=euro("1 / width")),
        ],
        objectives=[Require("end", at_most="10.2 mm", reliability=0.99)],
    )
    setup = setup_of(model, b="5 mm")
    answer = allotted(model, setup, tightest=0.01, widest=100.0)
    widths = answer.least.widths
    assert widths["a"] / widths["b"] == pytest.approx((12 / 1.0) ** (1 / 3) / (36 / 4.0) ** (1 / 3), rel=1e-5)
    assert answer.tolerances["a"].startswith("uniform ±")
    assert answer.tolerances["b"].endswith(" %")
    for name, text in answer.tolerances.items():
        spread = read_spread(text, model.tolerances[name].spread)
        resolved = spread.resolve(setup.target(name))
        assert resolved is not None
        assert resolved.width == pytest.approx(widths[name], rel=1e-12)


MIXED = replace(
    PRICED,
    errors=[
        PRICED.tolerances["large"],
        Tolerance("middle", normal(band="62 um"), price=Price("9 * width**-0.8", width="um", unit="EUR")),
        PRICED.tolerances["small"],
    ],
)


def test_grades_come_first_and_widths_are_bought_with_them() -> None:
    answer = allotted(MIXED, tightest=0.05)
    assert answer.reached
    assert set(answer.rule.grades) == {"large", "small"}
    assert set(answer.rule.widths) == {"middle"}
    assert answer.least_cost.cost <= answer.cost
    assert not answer.problem.reached(answer.rule.grades)  # with the width in force every grade at IT5 is not enough
    left = (15e-6 / norm.ppf(0.975)) ** 2 - (tolerance("IT5", 0.1) / 6) ** 2 - (0.5 * tolerance("IT5", 0.01) / 6) ** 2
    assert answer.rule.widths["middle"] == pytest.approx(6 * left**0.5 / 1.5, rel=1e-6)
    titles = [block.title for block in answer.blocks() if isinstance(block, Table)]
    assert titles == [
        "Synthesis grade by grade", "Rule against least cost", "Grades", "The rule's tolerances",
        "The least-cost tolerances",
    ]  # fmt: skip


@pytest.mark.parametrize("goal_um", [12, 15, 30])
@pytest.mark.parametrize("loosen", [False, True])
def test_the_least_cost_of_grades_and_widths_is_what_trying_everything_finds(goal_um: int, loosen: bool) -> None:
    """All pairs of grades (ISO 286-1), each with the widest width that its goal leaves: wider is cheaper."""
    model = limited(MIXED, Require("height", within=f"{goal_um} um", reliability=0.95))
    answer = allotted(model, tightest=0.05, widest=4.0, loosen=loosen)
    costs = []
    for large, small in itertools.product(GRADES[4:] if loosen else GRADES[4:9], repeat=2):
        widths = tolerance(large, 0.1), tolerance(small, 0.01)
        left = (goal_um * 1e-6 / norm.ppf(0.975)) ** 2 - (widths[0] / 6) ** 2 - (0.5 * widths[1] / 6) ** 2
        middle = min(6 * max(left, 0.0) ** 0.5 / 1.5, 4 * 62e-6)
        if middle >= 0.05 * 62e-6:
            um = [1e6 * width for width in (*widths, middle)]
            costs.append(3 * um[0] ** -0.6 + 2 + um[1] ** -0.5 + 1 + 9 * um[2] ** -0.8)
    assert answer.least_cost.reached
    assert answer.least_cost.cost == pytest.approx(min(costs), rel=1e-6)


def test_widths_stay_where_grades_have_no_price() -> None:
    bare = Tolerance("large", MIXED.tolerances["large"].spread)
    answer = allotted(replace(MIXED, errors=[bare, MIXED.tolerances["middle"]]))
    assert not answer.problem.variables
    assert answer.problem.unit == "1/mm"
    assert any("the widths of 'middle' stay" in text for text in answer.warnings())


def test_what_has_no_width_to_choose_is_no_variable() -> None:
    def together(rng: Any, rows: int) -> dict[str, Any]:
        return {"c": 1e-5 * rng.standard_normal(rows)}

    errors = [ROW.tolerances["a"], Tolerance("c", drawn(together), price=euro("1 / width"))]
    assert set(allotted(replace(ROW, errors=errors)).tolerances) == {"a"}
    with pytest.raises(UsageError, match="none with a price whose width could be chosen"):
        allotted(replace(ROW, errors=errors[1:]))


def test_a_width_that_does_not_matter_becomes_the_widest() -> None:
    """The goal hangs on d alone, which has no price."""
    model = replace(ROW, function=only_d, objectives=[Require("end", within="0.1 mm", reliability=0.99)])
    answer = allotted(model)
    assert {name: 1e3 * width for name, width in answer.least.widths.items()} == pytest.approx(
        dict.fromkeys("abc", 4 * 0.3), rel=1e-6
    )
    still = replace(model, errors=[*ROW.errors[:3], Tolerance("d", off())])
    assert allotted(still).least.widths == pytest.approx(answer.least.widths)


@pytest.mark.parametrize("formula", ["16.14 * width**-0.324 + 0.217 * exp(-0.013 * width)", "2 / (width + 0.1)", "7"])
def test_the_slope_of_a_price_is_exact(formula: str) -> None:
    """Against a central difference of a step that suits it."""
    strip = ToleranceVariable("a", 1e-3, 1e-4, 1e-2, euro(formula), {}, {})
    step = 1e-7
    expected = (strip.cost(1e-3 + step) - strip.cost(1e-3 - step)) / (2 * step)
    prices, slopes = prices_at([strip, strip], np.array([1e-3, 2e-3]))
    assert slopes[0] == pytest.approx(expected, rel=1e-6, abs=1e-9)
    assert prices == pytest.approx([strip.cost(1e-3), strip.cost(2e-3)], rel=1e-14)


@pytest.mark.parametrize("options", [{"tightest": 0.0}, {"tightest": 2.0, "widest": 2.0}, {"widest": float("inf")}])
def test_the_range_of_the_widths_is_checked(options: dict[str, float]) -> None:
    with pytest.raises(UsageError, match="widths need a range above 0 that rises") as caught:
        Allocation(**options)
    assert "\n" not in str(caught.value)


def test_results_json_and_sheet() -> None:
    answer = allotted(ROW)
    read = json.loads(json.dumps(answer.as_json(), allow_nan=False))
    assert read["steps"] == []
    assert read["adjustments"] == 0
    assert set(read["tolerances"]) == set(read["widths"]) == {"a", "b", "c"}
    assert read["tolerances"]["a"].startswith("band ")
    width = read["widths"]["a"]
    assert width["from"] == pytest.approx(0.3)
    assert width["price"] == {
        "from": pytest.approx(3 * 0.3**-POWER), "to": pytest.approx(3 * width["to"] ** -POWER), "unit": "EUR"
    }  # fmt: skip
    assert sum(one["price"]["to"] for one in read["widths"].values()) == pytest.approx(read["cost"]["value"])
    assert read["least_cost"]["cost"] == read["cost"]
    titles = [block.title for block in answer.blocks() if isinstance(block, Table)]
    assert titles == ["In force and at least cost", "The widths of least cost"]
    (proposal,) = answer.proposals()
    assert {name for name, *_ in proposal.changes} == {"a", "b", "c"}
    assert [check.name for check in proposal.checks] == [check.name for check in answer.checks()]
