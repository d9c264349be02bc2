"""A spread of another width keeps its words, its place and its shape, and stands in its text in full."""

import math

import pytest

from truing import by_choice, drawn, grade, lognormal, normal, off, plus_minus, uniform, zone
from truing.declare.spreads import Band, Spread, Target, read_spread, with_width
from truing.errors import TruingError, UnitError, UsageError
from truing.fits import tolerance

OTHER = {"radius": 0.25, "kind": "rough"}
LENGTH = Target("length", 0.08, "mm", OTHER.__getitem__)
ANGLE = Target("angle", 0.3, "deg", OTHER.__getitem__)
PURE = Target("share", -2.0, "", OTHER.__getitem__)
PERCENT = Target("share", 0.12, "%", OTHER.__getitem__)
WARMTH = Target("warmth", 300.0, "degC", OTHER.__getitem__)

WIDTHS: list[tuple[Spread, Target, float]] = [
    (normal(sd="0.01 mm"), LENGTH, 6e-5),
    (normal(band="125 um"), LENGTH, 125e-6),
    (normal(sd="3 %"), LENGTH, 6 * 0.03 * 0.08),
    (normal(sd="3 %"), PURE, 6 * 0.03 * 2.0),
    (normal(sd="3 %"), PERCENT, 0.18),
    (plus_minus("0.05 mm"), LENGTH, 1e-4),
    (plus_minus("0.05 mm", at_radius="radius"), ANGLE, 1e-4 / 0.25),
    (uniform("0.05 mm"), LENGTH, 1e-4),
    (lognormal(sd="6 %"), LENGTH, 6 * 0.06 * 0.08),
    (read_spread("uniform sd 0.01 mm", off()), LENGTH, math.sqrt(12) * 1e-5),
    (plus_minus("2 K"), WARMTH, 4.0),
    (zone("0 um", "6.55 um", grows="up"), LENGTH, 6.55e-6),
    (zone("-7 um", "0 um", grows="down"), LENGTH, 7e-6),
    (zone("-3 um", "5 um"), LENGTH, 8e-6),
    (by_choice("kind", fine=normal(band="1 um"), rough=normal(band="9 um")), LENGTH, 9e-6),
    (grade("IT7"), LENGTH, 30e-6),  # ISO 286-1, table 1: 50 mm to 80 mm
]


def width_of(spread: Spread, target: Target) -> float:
    """Return the full band of a spread, SI."""
    resolved = spread.resolve(target)
    assert resolved is not None
    return resolved.width


@pytest.mark.parametrize(("spread", "target", "width"), WIDTHS)
def test_the_width_is_the_full_band(spread: Spread, target: Target, width: float) -> None:
    assert width_of(spread, target) == pytest.approx(width, rel=1e-14)


@pytest.mark.parametrize("times", [1.0, 1.37, 2.0, 0.123456789012345])
@pytest.mark.parametrize(("spread", "target", "width"), WIDTHS)
def test_the_new_width_is_the_one_asked_for(spread: Spread, target: Target, width: float, times: float) -> None:
    changed = with_width(spread, target, times * width)
    assert width_of(changed, target) == pytest.approx(times * width, rel=4e-15)


@pytest.mark.parametrize(("spread", "target", "width"), WIDTHS)
def test_read_again_it_is_the_same_to_the_last_bit(spread: Spread, target: Target, width: float) -> None:
    changed = with_width(spread, target, width * 1.2345678901234567)
    again = read_spread(changed.text, changed)
    assert again == changed
    assert again.resolve(target) == changed.resolve(target)


@pytest.mark.parametrize(("spread", "target", "width"), WIDTHS)
def test_shape_and_words_stay(spread: Spread, target: Target, width: float) -> None:
    before, after = spread.resolve(target), with_width(spread, target, 3 * width).resolve(target)
    assert before is not None
    assert after is not None
    assert after.shape == before.shape
    assert after.sd == pytest.approx(3 * before.sd, rel=1e-14)


@pytest.mark.parametrize(
    ("grows", "low", "high"),
    [("up", -2e-6, 18e-6), ("down", -12e-6, 8e-6), ("both", -7e-6, 13e-6)],
)
def test_a_zone_grows_where_it_says(grows: str, low: float, high: float) -> None:
    changed = with_width(zone("-2 um", "8 um", grows=grows), LENGTH, 20e-6)  # type: ignore[arg-type]
    found = changed.resolve(LENGTH)
    assert found is not None
    assert found.mean - 0.08 == pytest.approx((low + high) / 2, abs=1e-16)
    assert found.width == pytest.approx(20e-6, rel=1e-14)


def test_a_band_keeps_what_it_says() -> None:
    assert with_width(normal(sd="3 %"), LENGTH, 6 * 0.05 * 0.08).text.endswith(" %")
    assert with_width(plus_minus("0.05 mm"), LENGTH, 2e-4).text == "±0.1 mm"
    assert with_width(uniform("0.05 mm"), LENGTH, 2e-4).text == "uniform ±0.1 mm"
    at_radius = with_width(plus_minus("0.05 mm", at_radius="radius"), ANGLE, 1e-3)
    assert at_radius.text == "±0.125 mm"
    assert read_spread("±0.125 mm", at_radius) == at_radius


def test_a_share_is_of_the_nominal_of_its_target() -> None:
    twice = Target("length", 0.16, "mm", OTHER.__getitem__)
    changed = with_width(normal(sd="3 %"), twice, 6 * 0.03 * 0.08)
    assert isinstance(changed, Band)
    share, unit = changed.amount.split()
    assert (float(share), unit) == (pytest.approx(1.5, rel=1e-14), "%")
    with pytest.raises(UnitError, match="its nominal is 0"):
        with_width(normal(sd="3 %"), Target("length", 0.0, "mm", OTHER.__getitem__), 1e-6)


def test_a_grade_becomes_the_band_of_its_width() -> None:
    changed = with_width(grade("IT7"), LENGTH, tolerance("IT8", 0.08))
    assert changed.text == "band 0.046 mm"
    assert changed.resolve(LENGTH) == grade("IT8").resolve(LENGTH)


def pair(rng, rows):
    """Draw one deviation."""
    return {"length": rng.standard_normal(rows)}


@pytest.mark.parametrize("spread", [off(), drawn(pair), by_choice("kind", fine=normal(sd="1 um"), rough=off())])
def test_what_has_no_width_is_refused_by_name(spread: Spread) -> None:
    with pytest.raises(UsageError, match=r"^the spread of 'length' is (off|drawn by pair): it has no width"):
        with_width(spread, LENGTH, 1e-5)


@pytest.mark.parametrize("width", [0.0, -1e-6, math.nan, math.inf])
def test_a_width_that_is_none_is_refused(width: float) -> None:
    with pytest.raises(UsageError, match="the width of the tolerance of 'length' must lie above zero"):
        with_width(normal(sd="1 um"), LENGTH, width)


def test_a_width_of_another_kind_is_refused() -> None:
    with pytest.raises(TruingError, match="IT7 is a grade for lengths"):
        width_of(grade("IT7"), ANGLE)
    with pytest.raises(UnitError, match="must lie above its start"):
        width_of(zone("2 um", "1 um"), LENGTH)
