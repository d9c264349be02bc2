"""The normal probability in formulas: values of the printed tables, printed form, dimension."""

import pytest
from formula_printed import latex, mathml

from truing.errors import UnitError
from truing.formulas import evaluate, evaluate_quantities, parse
from truing.units import registry

TABLE = [(0.0, 0.5), (1.0, 0.8413), (1.645, 0.9500), (1.96, 0.9750), (2.576, 0.9950), (-1.0, 0.1587)]  # any handbook


@pytest.mark.parametrize(("argument", "chance"), TABLE)
def test_phi_is_that_of_the_tables(argument: float, chance: float) -> None:
    assert evaluate(parse("Phi(x)"), {"x": argument}) == pytest.approx(chance, abs=5e-5)


def test_phi_is_printed_upright_with_its_argument() -> None:
    formula = parse("2 * Phi(limit / sd) - 1")
    symbols = {"limit": "L", "sd": "sigma_S"}
    assert r"\Phi \left( \frac{L}{\sigma_{S}} \right)" in latex(formula, symbols)
    assert '<mi mathvariant="normal">Φ</mi>' in mathml(formula, symbols)


def test_phi_needs_a_pure_number() -> None:
    metre = registry().Quantity(1.0, "m")
    with pytest.raises(UnitError, match="Phi needs a pure number"):
        evaluate_quantities(parse("Phi(x)"), {"x": metre})
