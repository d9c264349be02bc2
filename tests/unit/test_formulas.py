"""Formulas as data: what may stand in them, what they compute, their dimensions, and the safety of what is printed."""

from __future__ import annotations

import math
import time

import numpy as np
import pytest

from shared import ROUNDING
from truing import units
from truing.errors import DeclarationError, UnitError
from truing.formulas import evaluate, evaluate_quantities, parse
from truing.formulas.tree import children, source

REFUSED = [
    ("", "is empty"),
    ("load /", "cannot be read"),
    ("load.area", "a dot between names"),
    ("load[0]", "an index in brackets"),
    ("lambda x: x", "a lambda"),
    ("[load]", "a list"),
    ("load, area", "a comma outside a function"),
    ("{1: 2}", "a dictionary"),
    ("(x := 3)", "an assignment"),
    ("load if area else 3", r"write cases\(value, condition, otherwise\)"),
    ("__import__('os')", 'character "\'" is not allowed'),
    ('"text"', "is not allowed"),
    ("load # area", "character '#'"),
    ("__import__(load)", "no function '__import__'"),
    ("sine(load)", "did you mean sin"),
    ("sin(*load)", "a star"),
    ("sin(x=load)", "keyword"),
    ("sin(load)(area)", "not allowed: 'sin(load)'".replace("(", r"\(").replace(")", r"\)")),
    ("sin.cos(load)", "a dot between names"),
    ("sin()", "sin takes 1 argument, here it has 0"),
    ("sin(load, area)", "sin takes 1 argument, here it has 2"),
    ("atan2(load)", "atan2 takes 2 arguments, here it has 1"),
    ("hypot(load)", "hypot takes at least 2 arguments"),
    ("cases(load, area)", "an odd number, at least three"),
    ("cases(load, area, 3)", "needs a condition, such as x > 1"),
    ("cases(load > 1, load > 2, 3)", "a comparison outside"),
    ("cases(load, not load > 1, 3)", "needs a condition"),
    ("cases(load, load in area, 3)", "compares with"),
    ("load > 1", "a comparison outside"),
    ("load == area == 3", "a comparison outside"),
    ("load + (area == 3)", "a comparison outside"),
    ("load and area", "and/or outside"),
    ("load % area", "an operator other than"),
    ("load ^ area", "an operator other than"),
    ("+load", "an operator other than"),
    ("not load", "an operator other than"),
    ("1j", "not a real number"),
    ("True", "not a real number"),
    ("1e999", "not finite"),
    ("9" * 400, "not finite"),
    ("load\x00", "not allowed"),
    ("load + " * 400 + "load", "at most 2000"),
    ("sqrt(" * 60 + "load" + ")" * 60, "deeper than 50"),
    ("-" * 1999 + "1", "deep"),
    ("(" * 900 + "1" + ")" * 900, "cannot be read"),
    ("load" + " + load" * 200, "deeper than 50"),
]


@pytest.mark.parametrize(("text", "sentence"), REFUSED)
def test_what_is_not_a_formula_is_refused_with_its_text_and_reason(text: str, sentence: str) -> None:
    with pytest.raises(DeclarationError, match=sentence) as caught:
        parse(text)
    message = str(caught.value)
    assert message.startswith("formula ")
    assert repr(text)[1:20].rstrip("'") in message
    assert "\n" not in message
    assert len(message) < 600


def test_a_formula_that_is_no_text_is_refused_and_a_tower_of_powers_answers_at_once() -> None:
    with pytest.raises(DeclarationError, match="a formula is a text, not float"):
        parse(3.5)  # type: ignore[arg-type]
    started = time.perf_counter()
    assert evaluate(parse("9**9**9"), {}) == math.inf
    assert time.perf_counter() - started < 0.5


def test_names_are_the_quantities_only() -> None:
    formula = parse("cases(a * pi, sin(b) > c, either(d, 2), e < 1, min(f, g))")
    assert formula.names == {"a", "b", "c", "d", "e", "f", "g"}
    assert formula.left is None
    equation = parse("inv(alpha) == x")
    assert equation.left is not None
    assert equation.names == {"alpha", "x"}


@pytest.mark.parametrize(
    ("text", "left", "right"),
    [
        ("a - (b - c)", "a", "b - c"),
        (" (a +\n   b)\t* c", "a + b", "c"),
        ("-a**2 / 1e-3", "-a**2", "1e-3"),
        ("(a**b)**2.50", "a**b", "2.50"),
        ("cases(a, 0 < x <= 1, b) / ü", "cases(a, 0 < x <= 1, b)", "ü"),
    ],
)
def test_parts_of_a_formula_are_quoted_as_they_were_written(text: str, left: str, right: str) -> None:
    formula = parse(text)
    assert [source(formula, side) for side in children(formula.right)] == [left, right]


VALUES = {"a": 3.0, "b": 4.0, "x": 0.5, "t": math.radians(20), "n": math.nan}
COMPUTED = [
    ("a + b * 2", 11.0),
    ("-a**2", -9.0),
    ("(-a)**2", 9.0),
    ("2**-1", 0.5),
    ("2**a**2", 512.0),
    ("a / b / 2", 0.375),
    ("hypot(a, b)", 5.0),
    ("hypot(a, b, 12)", 13.0),
    ("sqrt(b)", 2.0),
    ("cbrt(-27)", -3.0),
    ("exp(1)", math.e),
    ("log(exp(2))", 2.0),
    ("log10(1000)", 3.0),
    ("abs(-a)", 3.0),
    ("sign(-a) + sign(0)", -1.0),
    ("sin(pi / 6)", 0.5),
    ("cos(pi / 3)", 0.5),
    ("tan(pi / 4)", 1.0),
    ("cot(pi / 6)", math.sqrt(3)),
    ("asin(0.5)", math.pi / 6),
    ("acos(0.5)", math.pi / 3),
    ("atan(1)", math.pi / 4),
    ("atan2(-1, -1)", -3 * math.pi / 4),
    ("sinh(1)", (math.e - 1 / math.e) / 2),
    ("cosh(1)", (math.e + 1 / math.e) / 2),
    ("tanh(1)", (math.e**2 - 1) / (math.e**2 + 1)),
    ("min(a, b, 1)", 1.0),
    ("max(a, b, 1)", 4.0),
    ("sum(a) + mean(b) + min(a) + max(b)", 14.0),
    ("cases(1, a > 3, 2, a >= 3, 3)", 2.0),
    ("cases(1, a > 1, 2, a > 2, 3)", 1.0),
    ("cases(1, a > 3, 2, a > 4, 3)", 3.0),
    ("cases(1, 2 < a < 4, 2)", 1.0),
    ("cases(1, a == 3 and b != 4, 2)", 2.0),
    ("cases(1, a == 3 or b != 4, 2)", 1.0),
    ("cases(1 / (a - 3), a > 3, 7)", 7.0),
    ("either(n, b)", 4.0),
    ("either(a, n)", 3.0),
    ("either(n, either(n, 5))", 5.0),
    ("a * x == 1.5", 0.0),
    ("a == b", -1.0),
    ("1_000 + 0x10", 1016.0),
]


@pytest.mark.parametrize(("text", "expected"), COMPUTED)
def test_evaluate(text: str, expected: float) -> None:
    found = evaluate(parse(text), VALUES)
    assert type(found) is float
    assert found == pytest.approx(expected, rel=1e-14, abs=1e-15)


# inv 14.5, 20, 25 and 30 degrees, from the involute table in Niemann/Winter, Maschinenelemente II (also DIN 3960)
INVOLUTE = {14.5: 0.005545, 20: 0.014904, 25: 0.029975, 30: 0.053751}
# Any handbook of statistics
CHANCES = {0: 0.5, 1: 0.8413, 1.645: 0.95, 1.96: 0.975, 2.576: 0.995, -1: 0.1587}


def test_involute_and_normal_probability_against_the_printed_tables() -> None:
    degrees, arguments = (np.array(list(table)) for table in (INVOLUTE, CHANCES))
    involute = evaluate(parse("inv(angle * pi / 180)"), {"angle": degrees})
    assert involute == pytest.approx(list(INVOLUTE.values()), abs=5.1e-7)
    assert evaluate(parse("Phi(x)"), {"x": arguments}) == pytest.approx(list(CHANCES.values()), abs=5e-5)


@pytest.mark.parametrize(
    "text", ["a / b", "cases(a, a > b, b, a > 1, a * b)", "either(a, b)", "min(a, b, 1)", "sin(a)**2"]
)
def test_a_batch_equals_the_loop(text: str) -> None:
    formula = parse(text)
    a, b = np.array([0.5, 1.5, math.nan, 2.5]), np.array([1.0, 1.0, 3.0, 4.0])
    loop = [evaluate(formula, {"a": float(x), "b": float(y)}) for x, y in zip(a, b, strict=True)]
    batch = evaluate(formula, {"a": a, "b": b})
    assert batch.shape == (4,)
    np.testing.assert_allclose(batch, loop, rtol=2 * ROUNDING)  # the condition of a square is 2


def test_sums_run_over_the_last_axis() -> None:
    a = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
    for text, sums in (("sum(a)", [6.0, 15.0]), ("mean(a)", [2.0, 5.0]), ("max(a) - min(a)", [2.0, 2.0])):
        np.testing.assert_array_equal(evaluate(parse(text), {"a": a}), sums)
    assert evaluate(parse("sum(a)"), {"a": a[0]}) == 6.0
    column = np.array([[10.0], [20.0]])
    np.testing.assert_array_equal(evaluate(parse("a * c"), {"a": a, "c": column})[1], [80.0, 100.0, 120.0])


def test_outside_its_domain_a_formula_is_nan_without_a_warning(recwarn: pytest.WarningsRecorder) -> None:
    assert math.isnan(evaluate(parse("sqrt(a)"), {"a": -1.0}))
    assert evaluate(parse("1 / a"), {"a": 0.0}) == math.inf
    assert not recwarn.list


def test_whole_numbers_compute_like_real_ones_and_stay_untouched() -> None:
    assert evaluate(parse("teeth**-1"), {"teeth": 2}) == 0.5
    assert evaluate(parse("teeth / 4"), {"teeth": np.int64(2)}) == 0.5
    a = np.array([1, 2, 3])
    evaluate(parse("-abs(a) * 2"), {"a": a})
    assert (a.tolist(), a.dtype.kind) == ([1, 2, 3], "i")


def test_a_missing_value_and_a_text_are_named() -> None:
    with pytest.raises(DeclarationError, match="names 'area', which has no value here"):
        evaluate(parse("load / area"), {"load": 1.0})
    with pytest.raises(DeclarationError, match="needs a number for 'load', not 'printed'"):
        evaluate(parse("load / 2"), {"load": "printed"})


QUANTITIES = {
    "load": (120.0, "N"), "area": (28.0, "mm^2"), "speed": (0.5, "m/s"), "time": (200.0, "h"), "hardness": (2.1, "GPa"),
    "rate": (3e-8, ""), "depth": (2.0, "um"), "width": (3.0, "mm"), "angle": (20.0, "deg"),
    "turning": (1500.0, "rad/s"), "torque": (10.0, "N*m"), "power": (1.5, "kW"), "share": (5.0, "%"),
    "missing": (math.nan, "mm"), "warm": (20.0, "K"),
}  # fmt: skip


def quantity(name: str) -> object:
    value, unit = QUANTITIES[name]
    return units.registry().Quantity(units.to_si(value, unit), units.pint_quantity(1.0, unit).units)


PROVEN = [
    ("load / area", "MPa", 120 / 28),
    ("speed * time", "km", 360.0),
    ("depth + rate * load / area * speed * time / hardness", "um", 2.0 + 3e-8 * (120 / 28e-6) * 360e3 / 2.1e9 * 1e6),
    ("sqrt(area)", "mm", math.sqrt(28)),
    ("area**0.5 * width**-1", "", math.sqrt(28) / 3),
    ("cbrt(area * width)", "mm", 84 ** (1 / 3)),
    ("cbrt(-area * width)", "mm", -(84 ** (1 / 3))),
    ("width**0.1 * width**0.2 + width**0.3", "mm^0.3", 2 * 3**0.3),
    ("width * asin(share) + depth", "mm", 3 * math.asin(0.05) + 2e-3),
    ("area**(3 / 2)", "mm^3", 28**1.5),
    ("hypot(width, depth)", "mm", math.hypot(3, 2e-3)),
    ("sin(angle) * width", "mm", 3 * math.sin(math.radians(20))),
    ("atan2(width, depth)", "", math.atan2(3, 2e-3)),
    ("torque * turning", "kW", 15.0),
    ("cases(width, depth > 0, depth)", "mm", 3.0),
    ("max(0, -width)", "mm", 0.0),
    ("either(missing, width)", "mm", 3.0),
    ("exp(-share)", "", math.exp(-0.05)),
    ("sign(width) * 2**share", "", 2**0.05),
    ("power / turning == torque", "N*m", -9.0),
    ("abs(depth - width) * inv(angle) / 1e3", "m", 2.998e-6 * (math.tan(math.radians(20)) - math.radians(20))),
    ("sum(width) / mean(depth)", "", 1500.0),
]


@pytest.mark.parametrize(("text", "unit", "expected"), PROVEN)
def test_quantities_prove_the_dimension(text: str, unit: str, expected: float) -> None:
    formula = parse(text)
    found = evaluate_quantities(formula, {name: quantity(name) for name in formula.names})  # type: ignore[misc]
    assert found.check(units.pint_quantity(1.0, unit).dimensionality)
    assert units.from_si(float(found.to_base_units().magnitude), unit) == pytest.approx(expected, rel=1e-12)


UNLIKE = [
    ("load + area", "'load + area'", {"a force", "an area"}),
    ("width - 2", "'width - 2'", {"a length", "a pure number"}),
    ("1 + width * (load - area)", "'load - area'", {"a force", "an area"}),
    ("exp(width)", "'exp(width)'", {"a length", "a pure number"}),
    ("Phi(width)", "'Phi(width)'", {"a length", "a pure number"}),
    ("log(load / area)", "'log(load / area)'", {"a pressure or stress", "a pure number"}),
    ("sin(width)", "'sin(width)'", {"a length", "an angle"}),
    ("max(width, load)", "'max(width, load)'", {"a length", "a force"}),
    ("max(width, 1)", "'max(width, 1)'", {"a length", "a pure number"}),
    ("atan2(width, load)", "'atan2(width, load)'", {"a length", "a force"}),
    ("hypot(width, time)", "'hypot(width, time)'", {"a length", "a time"}),
    ("either(missing, load)", "'either(missing, load)'", {"a length", "a force"}),
    ("cases(width, depth > 0, load)", "'cases(width, depth > 0, load)'", {"a length", "a force"}),
    ("cases(width, depth > load, width)", "'depth > load'", {"a length", "a force"}),
    ("cases(width, depth == load, width)", "'depth == load'", {"a length", "a force"}),
    ("cases(width, share > 0 and depth > 1, width)", "'depth > 1'", {"a length", "a pure number"}),
    ("width**width", "'width**width'", {"a length", "a pure number"}),
    ("asin(share) + width", "'asin(share) + width'", {"an angle", "a length"}),
    ("power == torque", "the two sides of the equation", {"a power", "a torque"}),
    ("2 * (width + time) == torque", "'width + time'", {"a length", "a time"}),
]


@pytest.mark.parametrize(("text", "part", "kinds"), UNLIKE)
def test_unlike_dimensions_are_named_by_their_part(text: str, part: str, kinds: set[str]) -> None:
    formula = parse(text)
    with pytest.raises(UnitError) as caught:
        evaluate_quantities(formula, {name: quantity(name) for name in formula.names})  # type: ignore[misc]
    words = str(caught.value)
    assert words.startswith(f"formula {text!r}: {part}: ")
    assert set(words.removeprefix(f"formula {text!r}: {part}: ").split(" does not go with ")) == kinds


def test_quantities_as_arrays_with_one_power_for_all_points() -> None:
    registry = units.registry()
    values = {"load": registry.Quantity(np.array([1.0, 2.0]), "kilonewton"), "area": registry.Quantity(4.0, "meter**2")}
    assert evaluate_quantities(parse("load / area"), values).to("pascal").magnitude.tolist() == [250.0, 500.0]
    values = {"width": registry.Quantity(2.0, "meter"), "n": registry.Quantity(np.array([2.0, 3.0]), "")}
    with pytest.raises(UnitError, match="not one finite number"):
        evaluate_quantities(parse("width**n"), values)
    assert evaluate_quantities(parse("(width / width)**n * n"), values).magnitude.tolist() == [2.0, 3.0]
