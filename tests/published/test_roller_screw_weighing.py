"""How three objectives become one: curve, weights by the paper's rule, and what the printed ones do not follow from."""

from math import pi, sin

import numpy as np
import pytest

from roller_screw_shift.objectives import normalised, rule_weights, total, weight
from truing import TruingError

# X/(2 pi) - sin(X)/(2 pi) at quarters of a turn: sin is 1 at a quarter, 0 at a half.
CURVE = [(0.0, 0.0), (0.25, 0.25 - 1 / (2 * pi)), (0.5, 0.5), (0.75, 0.75 + 1 / (2 * pi)), (1.0, 1.0)]


@pytest.mark.parametrize(("place", "value"), CURVE)
def test_curve(place: float, value: float) -> None:
    assert normalised(2.0 + 3.0 * place, (2.0, 5.0)) == pytest.approx(value, abs=1e-15)
    assert round(value, 6) in {0.0, 0.090845, 0.5, 0.909155, 1.0}


def test_curve_rises_is_level_at_both_ends_and_clipped_beyond() -> None:
    values = np.asarray(normalised(np.linspace(-1.0, 2.0, 3001), (0.0, 1.0)))
    assert (np.diff(values) >= 0.0).all()
    assert (values[:1001] == 0.0).all()
    assert (values[2000:] == 1.0).all()
    step = 1e-4  # level: the third power of the distance is all that is left
    assert normalised(step, (0.0, 1.0)) == pytest.approx((2 * pi * step) ** 3 / 6 / (2 * pi), rel=1e-4)


def test_total_objective_by_hand() -> None:
    ranges = ((0.0, 1.0), (10.0, 30.0), (0.0, 2.0))
    weights = rule_weights(ranges)
    assert weights == pytest.approx((4.0, 0.01, 1.0))
    found = total(np.array([[0.25, 0.5], [30.0, 20.0], [1.5, 2.0]]), ranges, weights)
    quarter = 0.25 - sin(pi / 2) / (2 * pi)
    assert found == pytest.approx([-4 * quarter + 0.01 + (1 - quarter), -2.0 + 0.005 + 1.0], abs=1e-14)


@pytest.mark.parametrize("reach", [(1.0, 1.0), (2.0, 1.0), (0.0, float("inf")), (float("nan"), 1.0)])
def test_a_range_without_width_is_refused(reach: tuple[float, float]) -> None:
    with pytest.raises(TruingError, match="no width"):
        weight(reach)
    with pytest.raises(TruingError, match="no width"):
        normalised(0.5, reach)
