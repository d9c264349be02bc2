"""Inputs that scatter together: closed forms in every study, H.2 of the Guide, the prior, and what is refused."""

from __future__ import annotations

import itertools
import re
from dataclasses import replace
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np
import openpyxl
import pytest
from diagnosis_models import Asked
from scipy.special import ndtr
from scipy.stats import norm, spearmanr
from study_models import CHAIN, PRICED, STACK, add, setup_of

import truing
from truing import (
    Allocation,
    Float,
    Model,
    Price,
    Reliability,
    Require,
    Sensitivity,
    Tolerance,
    Uncertainty,
    correlated,
    drawn,
    found,
    given,
    inputs,
    lognormal,
    normal,
    results,
    uniform,
)
from truing.calculation import calculate
from truing.declare.correlations import Correlated, contradictions, pearson
from truing.declare.spreads import Distribution, DistributionShape
from truing.diagnosis.unit_errors import _as_drawn
from truing.errors import DeclarationError, InputError, UsageError
from truing.fits import GRADES, tolerance
from truing.inputs_file import read_setup, setup_from_text
from truing.kernel import Offer, Origin
from truing.packed import pack, unpack
from truing.runs.extension import extended_text
from truing.runs.inputs_written import complete_inputs
from truing.setup import Setup, default_setup
from truing.studies.sampling import scatter_of

DRAWS = 100_000
SPRING = Path(__file__).parents[2] / "docs" / "examples" / "coil_spring.py"


def with_pairs(setup: Setup, *pairs: Correlated) -> Setup:
    return replace(setup, correlations=pairs)


def outcome(setup: Setup, study: Any) -> Any:
    return calculate(replace(setup, studies=(study,))).outcomes[study.name]


# A chain: gap = first + second - third, with standard deviations 0.03, 0.04, 0.12 mm, and two of them correlated

SDS, SIGNS = np.array([0.03, 0.04, 0.12]), np.array([1.0, 1.0, -1.0])
MATRIX = np.array([[1.0, 0.7, 0.2], [0.7, 1.0, 0.5], [0.2, 0.5, 1.0]])
VARIANCE = float(SIGNS * SDS @ MATRIX @ (SIGNS * SDS))
COUPLED = with_pairs(
    setup_of(CHAIN),
    correlated("first", "second", 0.7), correlated("third", "first", 0.2), correlated("second", "third", 0.5),
)  # fmt: skip


def test_monte_carlo_form_and_first_order_have_the_closed_form_of_a_sum() -> None:
    """The nominal gap is 10 mm and stays within 0.2 mm with the probability of a normal number."""
    odds = outcome(COUPLED, Reliability(draws=DRAWS))
    sd = sqrt(VARIANCE) * 1e-3
    chance = float(ndtr(2e-4 / sd) - ndtr(-2e-4 / sd))
    said = odds.as_json()["gap"]
    assert said["first_order_sd"] == pytest.approx(sd * 1e3, rel=1e-9)
    assert said["sd"] == pytest.approx(sd * 1e3, rel=4 / sqrt(2 * DRAWS))
    assert said["first_order"] == pytest.approx(chance, abs=1e-9)
    assert said["probability"] == pytest.approx(chance, abs=4 * sqrt(chance * (1 - chance) / DRAWS))
    assert said["form"]["beta"]["high"] == pytest.approx(2e-4 / sd, rel=1e-6)
    assert said["form"]["probability"] == pytest.approx(chance, abs=1e-6)


def test_shares_are_halves_of_what_two_add_together_and_sobol_is_refused() -> None:
    said = outcome(COUPLED, Sensitivity(of="gap", sobol=64))
    weighed = SIGNS * SDS
    assert list(said.share["gap"].values()) == pytest.approx(list(weighed * (MATRIX @ weighed) / VARIANCE), rel=1e-8)
    assert not said.sobol_first
    assert (
        "no Sobol indices: they need independent sources, and 'first' and 'second' are correlated" in said.warnings()[0]
    )


def test_an_input_that_is_drawn_first_keeps_its_machines() -> None:
    before, after = (scatter_of(setup).draw(3, 1, 1000) for setup in (setup_of(CHAIN), COUPLED))
    assert np.array_equal(before["first"], after["first"])
    assert not np.array_equal(before["second"], after["second"])


# Example H.2 of the Guide (JCGM 100:2008): resistance, reactance and impedance from the same five readings


VOLTS = np.array([5.007, 4.994, 5.005, 4.990, 4.999])
MILLIAMPERES = np.array([19.663, 19.639, 19.640, 19.685, 19.678])
RADIANS = np.array([1.0456, 1.0438, 1.0468, 1.0428, 1.0433])
READINGS = {"volts": VOLTS, "current": MILLIAMPERES * 1e-3, "phase": RADIANS}


@inputs
class Circuit:
    """Means of five simultaneous readings."""

    volts: Float = given(float(VOLTS.mean()), "V")
    current: Float = given(float(MILLIAMPERES.mean()), "mA")
    phase: Float = given(float(RADIANS.mean()), "rad")


@results
class Impedance:
    """Table H.4."""

    resistance: Float = found("ohm")
    reactance: Float = found("ohm")
    impedance: Float = found("ohm")


def element(at: Circuit) -> Impedance:
    """Equations (H.7a) to (H.7c)."""
    impedance = at.volts / at.current
    return Impedance(
        resistance=impedance * np.cos(at.phase), reactance=impedance * np.sin(at.phase), impedance=impedance
    )


def sd_of_mean(name: str) -> float:
    return float(READINGS[name].std(ddof=1) / sqrt(5))


CIRCUIT = Model(
    name="circuit", title="JCGM 100:2008, H.2", function=element,
    errors=[
        Tolerance("volts", normal(sd=f"{sd_of_mean('volts')!r} V")),
        Tolerance("current", normal(sd=f"{sd_of_mean('current')!r} A")),
        Tolerance("phase", normal(sd=f"{sd_of_mean('phase')!r} rad")),
        *(correlated(one, other, float(np.corrcoef(READINGS[one], READINGS[other])[0, 1]), why="same readings")
          for one, other in itertools.combinations(READINGS, 2)),
    ],
)  # fmt: skip


def test_resistance_reactance_and_impedance_of_the_guide() -> None:
    """Tables H.3 and H.4, and the law of propagation (GUM 13) with derivatives by hand over the covariance of the data.

    The Guide prints 0.295 for the reactance: its first approach gives 0.29558 from these readings, its second 0.29549.
    """
    assert [round(pair.coefficient, 2) for pair in CIRCUIT.correlations] == [-0.36, 0.86, -0.65]
    budgets = outcome(setup_of(CIRCUIT), Uncertainty(draws=0)).budgets
    printed = {"resistance": (127.732, 0.071), "reactance": (219.847, 0.295), "impedance": (254.260, 0.236)}
    volts, current, phase = (column.mean() for column in READINGS.values())
    by_hand = {
        "resistance": np.array([np.cos(phase), -volts * np.cos(phase) / current, -volts * np.sin(phase)]) / current,
        "reactance": np.array([np.sin(phase), -volts * np.sin(phase) / current, volts * np.cos(phase)]) / current,
        "impedance": np.array([1.0, -volts / current, 0.0]) / current,
    }
    covariance = np.cov(list(READINGS.values())) / 5
    for name, (value, u) in printed.items():
        assert budgets[name].value == pytest.approx(value, abs=5e-4)
        assert budgets[name].combined == pytest.approx(sqrt(by_hand[name] @ covariance @ by_hand[name]), rel=1e-6)
        assert budgets[name].combined == pytest.approx(u, abs=1e-3)  # a unit of the last digit


def test_shares_of_sources_and_pairs_make_the_whole_and_degrees_of_correlated_ones_are_doubted() -> None:
    said = outcome(setup_of(CIRCUIT), Uncertainty(draws=0, degrees={"volts": 4}))
    for budget in said.budgets.values():
        alone = sum(budget.share(source) for source in budget.sources)
        assert alone + sum(term.variance for term in budget.shared) / budget.combined**2 == pytest.approx(1.0)
    assert "'volts' is correlated with another" in said.warnings()[0]


# Other shapes: the number is that of the normal scores


SHAPES: tuple[DistributionShape, ...] = ("normal", "uniform", "lognormal")


@pytest.mark.parametrize("rho", [-0.8, 0.3, 0.95])
@pytest.mark.parametrize(("one", "other"), list(itertools.combinations_with_replacement(SHAPES, 2)))
def test_correlation_of_values_is_that_of_a_quadrature(
    one: DistributionShape, other: DistributionShape, rho: float
) -> None:
    first, second = Distribution(2.0, 0.9, one), Distribution(5.0, 0.4, other)
    nodes, weights = np.polynomial.hermite_e.hermegauss(80)
    weights = weights / weights.sum()
    x, y = np.meshgrid(nodes, nodes, indexing="ij")
    values = first.from_standard(x), second.from_standard(rho * x + sqrt(1 - rho**2) * y)
    covariance = weights @ ((values[0] - 2.0) * (values[1] - 5.0)) @ weights
    assert float(pearson(first, second, rho)) == pytest.approx(covariance / (0.9 * 0.4), abs=1e-8)


def test_drawn_ranks_have_the_correlation_of_the_copula() -> None:
    """Spearman's correlation of a Gaussian copula is 6/pi arcsin(rho/2), whatever the shapes."""
    model = Model(
        name="skew", title="Sum", function=add,
        errors=[Tolerance("x", lognormal(sd="2")), Tolerance("y", uniform("3")), correlated("y", "x", -0.6)],
    )  # fmt: skip
    columns = scatter_of(setup_of(model, x=4.0)).draw(0, 0, DRAWS)
    assert spearmanr(columns["x"], columns["y"])[0] == pytest.approx(6 / np.pi * np.arcsin(-0.3), abs=4 / sqrt(DRAWS))


# Allocation


def best_by_trying(model: Model[Any, Any], goal: float, shift_sd: float, sign: int) -> float:
    """The least cost over all grades by ISO 286; large and middle are correlated by 0.6, middle and small by -0.5."""
    sizes, weights = {"large": 0.1, "middle": 0.04, "small": 0.01}, np.array([1.0, 1.5, -0.5])
    matrix = np.eye(3) + sign * np.array([[0.0, 0.6, 0.0], [0.6, 0.0, -0.5], [0.0, -0.5, 0.0]])
    costs = []
    for grades in itertools.product(GRADES[4:9], repeat=3):
        widths = np.array([tolerance(grade, size) for grade, size in zip(grades, sizes.values(), strict=True)])
        sd = sqrt(weights * widths @ matrix @ (weights * widths) / 36 + shift_sd**2)
        shift = 3 * shift_sd
        if ndtr((goal - shift) / sd) - ndtr((-goal - shift) / sd) >= 0.95:
            prices = {name: model.tolerances[name].price for name in sizes}
            costs.append(sum(1e-3 / width if price is None else price.at(width)
                             for price, width in zip(prices.values(), widths, strict=True)))  # fmt: skip
    return min(costs)


@pytest.mark.parametrize(("model", "shift_sd"), [(STACK, 1e-6), (PRICED, 0.0)])
@pytest.mark.parametrize(
    ("goal", "sign"), [(15, 1), (40, 1), (12, -1)]
)  # -1: the parts take from each other's variance
def test_least_cost_of_correlated_grades_is_what_trying_everything_finds(
    model: Model[Any, Any], shift_sd: float, goal: int, sign: int
) -> None:
    asked = replace(model, objectives=[Require("height", within=f"{goal} um", reliability=0.95)])
    pairs = correlated("large", "middle", sign * 0.6), correlated("middle", "small", sign * -0.5)
    setup = with_pairs(setup_of(asked), *pairs)
    answer = outcome(setup, Allocation(draws=20_000))
    assert answer.least_cost.cost == pytest.approx(best_by_trying(asked, goal * 1e-6, shift_sd, sign), rel=1e-12)
    chance = answer.least_cost.chances["height"]
    assert answer.monte_carlo["least"]["height"] == pytest.approx(chance, abs=4 * sqrt(0.05 * 0.95 / 20_000))


@pytest.mark.parametrize("rho", [-0.5, 0.8])
def test_two_widths_of_one_price_share_the_variance_of_their_sum(rho: float) -> None:
    """Two widths w: the variance of the sum is 2 (1 + rho) (w/6)^2."""
    price = Price("1 / width", width="1", unit="EUR")
    model = Model(
        name="twins", title="Sum", function=add,
        errors=[Tolerance("x", normal(band="3"), price=price), Tolerance("y", normal(band="2"), price=price),
                correlated("x", "y", rho)],
        objectives=[Require("total", at_most="1", reliability=0.99)],
    )  # fmt: skip
    widths = outcome(setup_of(model), Allocation(draws=100, tightest=0.05, widest=50)).least.widths
    expected = 6 / norm.ppf(0.99) / sqrt(2 * (1 + rho))
    assert list(widths.values()) == pytest.approx([expected, expected], rel=1e-5)


# The prior of a diagnosis


@inputs
class Bars:
    """Two bars of one batch; the third input only tells rows apart."""

    one: Float = given(100.0, "um")
    other: Float = given(50.0, "um")
    place: Float = given(0.0, "mm")


@results
class Seen:
    """What a gauge reads."""

    seen: Float = found("um")


def only_sum(bars: Bars) -> Seen:
    return Seen(seen=bars.one + bars.other + 0.0 * bars.place)


@pytest.mark.parametrize("rho", [-0.6, 0.0, 0.8])
def test_calibration_is_the_conditional_normal_of_the_prior(tmp_path: Path, rho: float) -> None:
    """A sum that is 6 um too large moves each input by its covariance with the sum over the variance of the sum."""
    sds, rows, noise, off = np.array([4.0, 3.0]), 400, 0.2, 6.0
    model = Model(
        name="bars", title="Bars", function=only_sum,
        errors=[Tolerance("one", normal(sd="4 um")), Tolerance("other", normal(sd="3 um")),
                correlated("one", "other", rho)],
    )  # fmt: skip
    rng = np.random.default_rng(5)
    columns = {"place": rng.uniform(-5, 5, rows), "seen": 150 + off + rng.normal(0, noise, rows)}
    said = Asked(model, units={"place": "mm", "seen": "um"}).diagnosed(tmp_path, columns)
    assert said.verdict == "none"
    with_sum = np.outer(sds, sds) * np.array([[1, rho], [rho, 1]]) @ np.ones(2)
    gain = with_sum / (with_sum.sum() + noise**2 / rows)
    moved = {calibrated.name: 1e6 * calibrated.value for calibrated in said.calibrated}
    mean = float(columns["seen"].mean()) - 150
    assert [moved["one"] - 100, moved["other"] - 50] == pytest.approx(list(gain * mean), abs=0.01)
    assert numbers(read(extended_text(said), model=model)) == {"one, other": rho}


def test_what_tolerances_reach_before_a_unit_is_suspected_counts_the_correlation() -> None:
    """The directions of two inputs that move a result by 3 and 4: 9 + 16 + 2 r 3 4 together, and no failed row."""
    moves = [np.array([3.0, 3.0, np.nan]), np.array([4.0, -4.0, 4.0])]
    drawn_ = np.array(_as_drawn(moves, np.array([[1.0, 0.5], [0.5, 1.0]])))
    assert np.sum(drawn_**2, axis=0) == pytest.approx([37.0, 13.0, 16.0])
    assert _as_drawn(moves, np.eye(2)) is moves


# Files: what is read, written and refused


ORIGIN = Origin("study_models", "", "", __file__, "module:study_models")


def read(text: str, *overrides: str, model: Model[Any, Any] = CHAIN) -> Setup:
    return setup_from_text(text, Offer(model.name, model, ORIGIN), file="c.toml", folder=Path(), overrides=overrides)


def faults(text: str, *overrides: str, model: Model[Any, Any] = CHAIN) -> list[str]:
    with pytest.raises(InputError) as caught:
        read(text, *overrides, model=model)
    return str(caught.value).splitlines()


def numbers(setup: Setup) -> dict[str, float]:
    return {pair.name: pair.coefficient for pair in setup.correlations}


def test_a_pair_a_group_and_a_matrix_are_read_and_written_so_that_they_are_read_again() -> None:
    setup = read('[correlations]\n"first, second" = 0.5\n"third , first" = -0.25\n')
    assert numbers(setup) == {"first, second": 0.5, "third, first": -0.25}
    assert numbers(read(complete_inputs(setup))) == numbers(setup)
    assert numbers(unpack(pack(setup))) == numbers(setup)
    assert numbers(read('[correlations]\n"first, second, third" = 0.5')) == {
        "first, second": 0.5, "first, third": 0.5, "second, third": 0.5,
    }  # fmt: skip
    matrix = "[[1, 0.5, -0.1], [0.5, 1, 0.2], [-0.1, 0.2, 1]]"
    assert list(numbers(read(f'[correlations]\n"first, second, third" = {matrix}')).values()) == [0.5, -0.1, 0.2]


def test_a_run_shows_its_pairs_wherever_it_shows_tolerances(tmp_path: Path) -> None:
    spring = truing.load(SPRING).given(correlated("coil_diameter", "active_coils", -0.6), draws=500)
    run = spring.run(output=tmp_path / "run", progress=False)
    (said,) = run.document["correlations"].items()
    assert said == ("coil_diameter, active_coils", {"value": -0.6, "unit": "", "of_values": -0.6})
    sheet = (tmp_path / "run" / "sheet.md").read_text(encoding="utf-8")
    assert re.search(r"\| coil diameter and active coils +\| +[-−]0\.6 ", sheet)
    again = spring.setup(tmp_path / "run" / "inputs.toml")
    assert numbers(again) == {"coil_diameter, active_coils": -0.6}
    assert not truing.load(SPRING).describe()["correlations"]


def test_a_workbook_states_pairs_and_matrices(tmp_path: Path) -> None:
    book = openpyxl.Workbook()
    matrix = "[[1, -0.1], [-0.1, 1]]"
    stated = {"correlations.first, second": 0.5, "correlations.third, first": matrix}
    for row in [("name", "value"), *stated.items()]:
        book.active.append(row)
    book.save(tmp_path / "inputs.xlsx")
    setup = read_setup(tmp_path / "inputs.xlsx", Offer(CHAIN.name, CHAIN, ORIGIN))
    assert numbers(setup) == {"first, second": 0.5, "third, first": -0.1}


def test_what_a_file_states_and_set_replaces_stands_in_place_of_what_is_declared() -> None:
    declared = replace(CHAIN, errors=[*CHAIN.errors, correlated("first", "second", 0.5, why="one bar")])
    assert numbers(read("", model=declared)) == {"first, second": 0.5}
    (kept,) = read('[correlations]\n"second, first" = 0.5', model=declared).correlations
    assert kept.why == "one bar"
    assert not scatter_of(read('[correlations]\n"second, first" = 0', model=declared)).pairs
    text = '[correlations]\n"second, first" = 0.1'
    assert numbers(read(text, "correlations.first, second=-0.3")) == {"second, first": -0.3}
    off = read('[tolerances]\nfirst = "off"', model=declared)  # says nothing of an input that does not scatter
    assert scatter_of(off).copula is None
    assert "correlations" not in complete_inputs(off)


def test_every_fault_of_a_file_is_said_with_its_line() -> None:
    text = """[tolerances]
third = "off"
[correlations]
"first, second" = 0.7
"second, first" = 0.6
"first, third" = 0.1
"first, secnd" = 0.1
"first" = 0.1
"first, gap_limit" = 0.1
"second, second" = 0.1
"third , second" = -1
"first, second, third" = [[1, 2], [2, 1]]
"""
    assert faults(text) == [
        "c.toml:5: the correlation of 'second' and 'first' is stated twice (first in line 4); state it once",
        "c.toml:6: 'third' does not scatter, its tolerance is off; state a tolerance, or leave the correlation out",
        "c.toml:7: chain has no input 'secnd'. Did you mean 'second'?",
        "c.toml:8: 'first': a correlation is that of two inputs; write \"first, second\" = 0.7",
        "c.toml:9: 'gap_limit' has no tolerance, so it does not scatter",
        "c.toml:10: 'second' is correlated with itself",
        "c.toml:11: the correlation of 'third' and 'second' is -1; it lies between -1 and 1; inputs that always go "
        "together are one input",
        "c.toml:12: the matrix of first, second, third is a list of 3 rows of 3 numbers",
    ]
    unquoted = "c.toml:2: 'first, second = 0.5' is no line of TOML; write \"first, second\" = 0.7"
    assert faults("[correlations]\nfirst, second = 0.5") == [unquoted]
    entries = {
        "[[1, 0.5], [0.4, 1]]": "the matrix is not symmetric: 'first' and 'second' have 0.5 and 0.4",
        "[[2, 0.5], [0.5, 1]]": "the matrix of first, second has 2 for 'first' with itself; its diagonal is 1",
        "[[1, 1.5], [1.5, 1]]": "the correlation of 'first' and 'second' is 1.5; it lies between -1 and 1",
        '"0.5"': "'first, second' = '0.5' is no correlation; write a number such as \"first, second\" = 0.7",
        "nan": "the correlation of 'first' and 'second' is nan; it lies between -1 and 1",
    }
    for value, sentence in entries.items():
        assert faults(f'[correlations]\n"first, second" = {value}') == [f"c.toml:2: {sentence}"]


def test_a_contradiction_names_the_inputs_the_line_and_what_is_permitted() -> None:
    """With two of three at r the third lies between 2 r^2 - 1 and 1."""
    text = '[correlations]\n"first, second" = 0.9\n"second, third" = 0.9\n"first, third" = -0.5'
    assert faults(text) == [
        "c.toml:4: the correlations of 'first', 'second' and 'third' contradict each other; with the others as they "
        "are, that of 'first' and 'third' lies between 0.621 and 1"
    ]
    two = [correlated("a", "b", 0.9), correlated("b", "c", 0.9)]
    (said,) = contradictions(two)
    assert said.blamed is two[1]
    assert said.text.endswith(
        "(a pair that is not stated counts as 0), that of 'b' and 'c' lies between -0.435 and 0.435"
    )
    assert not list(contradictions([*two, correlated("c", "a", 0.7)]))


def test_a_model_and_a_setup_refuse_what_cannot_be() -> None:
    def errors(*more: Any) -> None:
        replace(CHAIN, errors=[*CHAIN.errors, *more])

    pair = correlated("first", "second", 0.5)
    for more, sentence in (
        ([pair, correlated("second", "first", 0.1)], "the correlation of 'first' and 'second' is declared twice"),
        ([correlated("first", "gap_limit", 0.1)], "'gap_limit' is correlated, but no tolerance is on it"),
        ([correlated("first", "second", 0.9), correlated("second", "third", 0.9)], "contradict each other"),
    ):
        with pytest.raises(DeclarationError, match=sentence):
            errors(*more)
    with pytest.raises(DeclarationError, match="is correlated with itself"):
        correlated("first", "first", 0.5)
    twice = replace(CHAIN, errors=[*CHAIN.errors, Tolerance("again", normal(sd="1 um"), on=["first"])])
    with pytest.raises(UsageError, match="'first' scatters by two tolerances, first and again"):
        scatter_of(with_pairs(default_setup(twice), pair))
    spread = drawn(lambda rng, rows: {"x": rng.standard_normal(rows)})
    errors_of_both = [Tolerance("x", spread), Tolerance("y", normal(sd="1"))]
    function = Model(name="function", title="Drawn", function=add, errors=errors_of_both)
    with pytest.raises(UsageError, match="'x' is drawn by a function"):
        scatter_of(with_pairs(default_setup(function), correlated("x", "y", 0.5)))
    assert faults('[correlations]\n"x, y" = 0.5', model=function)[0].startswith("c.toml:2: 'x' is drawn by a function")
