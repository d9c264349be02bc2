"""What the figures of the roller screw show is what holds: their lines are read back and compared.

Expected numbers are geometry: thickness of involute teeth, the rack's own critical section, the paper's weights.
"""

from dataclasses import replace
from math import cos, pi, radians, tan
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from drawn import figures, line
from roller_screw_shift import sheet
from roller_screw_shift.figures import MARKS, SIDES, path_of, ring_half, roller_half, triangle
from roller_screw_shift.geometry import geometry_of
from roller_screw_shift.model import MARGINS, ROLLER_SCREW_SHIFT
from roller_screw_shift.optimum import ChosenShift
from roller_screw_shift.quantities import Pair
from truing.calculation import Calculation, calculate
from truing.setup import default_setup

ALPHA, MODULE = radians(20.0), 0.5e-3
CHORD = 4e-6  # rad, 20 nm of a tooth: the outline is drawn with 60 straight lines
SHIFTS = (0.0, 0.21, 0.2534, 0.6)


def pair_at(shift: float, **values: Any) -> Pair:
    found: Pair = ROLLER_SCREW_SHIFT.inputs(roller_shift=shift, **values)
    return found


def half_angle(outline: NDArray[np.complex128], radius: float) -> float:
    """The angle of the flank beside the axis of the tooth where it crosses this radius."""
    away = np.abs(outline) - radius
    (place, *_) = np.flatnonzero(away[:-1] * away[1:] < 0)
    share = away[place] / (away[place] - away[place + 1])
    point = outline[place] + share * (outline[place + 1] - outline[place])
    return float(0.5 * pi - np.angle(point))


# The outlines of the teeth


@pytest.mark.parametrize("shift", SHIFTS)
def test_outlines_run_from_tip_to_root_by_the_critical_section_of_the_rack(shift: float) -> None:
    """Where its tangent makes 30 degrees with the axis of the tooth, twice the distance from it is the chord.

    At the reference circle a tooth of the roller has pi/2 + 2 x tan(alpha), a gap of the ring with its own x.
    """
    pair = pair_at(shift)
    geometry = geometry_of(pair)
    ring_shift = float(np.asarray(geometry.ring_shift))
    thick = [(pi / 2 + 2 * x * tan(ALPHA)) / teeth for x, teeth in ((shift, 20), (ring_shift, 100))]
    assert half_angle(roller_half(pair), 10 * MODULE) == pytest.approx(thick[0], abs=CHORD)
    assert pi / 100 - half_angle(ring_half(pair), 50 * MODULE) == pytest.approx(thick[1], abs=4e-7)
    for outline, gear, teeth in ((roller_half(pair), geometry.roller, 20), (ring_half(pair), geometry.ring, 100)):
        assert abs(outline[0]) == pytest.approx(float(gear.tip_radius), rel=1e-9)
        assert abs(outline[-1]) == pytest.approx(float(gear.root_radius), rel=1e-9)
        assert float(0.5 * pi - np.angle(outline[-1])) == pytest.approx(pi / teeth, abs=1e-9)
        assert np.abs(np.diff(outline)).max() < 0.2 * MODULE
        if shift < 0.5:
            assert np.abs(np.diff(np.abs(outline))).max() < 0.05 * MODULE
    fillet = roller_half(pair)[72:132]
    way = np.angle(np.diff(fillet) / -1j)  # 0 along the axis, towards the root
    beside = float(np.interp(radians(30.0), way, 0.5 * (fillet[1:] + fillet[:-1]).real))
    meshing: Any = ROLLER_SCREW_SHIFT.function(pair)
    assert 2 * beside / MODULE == pytest.approx(float(meshing.root_chord_roller), rel=2e-4)


def test_the_fillet_of_the_ring_is_round_and_touches_flank_and_root() -> None:
    pair = pair_at(0.21)
    outline = ring_half(pair)[72:132]
    centre = outline[-1] * (abs(outline[-1]) - 0.15 * MODULE) / abs(outline[-1])
    assert np.abs(outline - centre) == pytest.approx(0.15 * MODULE, rel=1e-6)
    flank = ring_half(pair)[:72]
    before, after = flank[-1] - flank[-2], outline[1] - outline[0]
    assert np.angle(after / before) == pytest.approx(0.0, abs=0.03)


@pytest.mark.parametrize("shift", SHIFTS)
def test_sliding_at_the_ends_of_the_path_is_that_of_the_objective(shift: float) -> None:
    pair = pair_at(shift)
    meshing: Any = ROLLER_SCREW_SHIFT.function(pair)
    path = path_of(pair)
    assert -path.roller[0] == pytest.approx(float(meshing.root_sliding_roller), rel=1e-9)
    assert -path.ring[-1] == pytest.approx(float(meshing.root_sliding_ring), rel=1e-9)
    assert np.abs(path.roller).max() == pytest.approx(float(meshing.sliding_roller), rel=1e-9)
    assert np.abs(path.ring).max() == pytest.approx(float(meshing.sliding_ring), rel=1e-9)
    length = path.place[-1] - path.place[0]
    assert length / (pi * MODULE * cos(ALPHA)) == pytest.approx(float(meshing.contact_ratio), rel=1e-9)


# The figures


@pytest.fixture(scope="module")
def run() -> Calculation:
    """The paper's screw with small budgets."""
    shifting, optimise = ROLLER_SCREW_SHIFT.studies
    small: tuple[Any, ...] = (
        replace(shifting, points=4001, ratios=(1.2,)),  # type: ignore[type-var]
        replace(optimise, population=12, generations=4),  # type: ignore[type-var]
    )
    return calculate(replace(default_setup(ROLLER_SCREW_SHIFT), studies=small))


def chosen_of(run: Calculation) -> ChosenShift:
    found = run.outcomes["shift"]
    assert isinstance(found, ChosenShift)
    return found


def test_objectives_over_the_shift(run: Calculation) -> None:
    figure = figures(run, sheet.choice)["Objectives over the shift"]
    names = ("shift_sum", "stress_difference", "sliding_difference")
    for panel, name, scale in zip(figure.axes, names, (1.0, 1e-6, 1.0), strict=True):
        curve = panel.get_lines()[-1]
        shifts, values = np.asarray(curve.get_xdata()), np.asarray(curve.get_ydata())
        meshing: Any = ROLLER_SCREW_SHIFT.function(pair_at(0.1))
        assert np.interp(0.1, shifts, values) == pytest.approx(scale * float(getattr(meshing, name)), rel=1e-5)
        assert line(panel, "optimum")[0][0] == pytest.approx(0.25345, abs=1e-5)
        assert line(panel, "as stated")[0][0] == 0.21


def test_limits_over_the_shift(run: Calculation) -> None:
    bars, lines = figures(run, sheet.limits)["Limits over the shift"].axes
    kept = {}
    for place, collection in enumerate(item for item in bars.collections if len(item.get_paths())):
        corners = np.concatenate([path.vertices[:, 0] for path in collection.get_paths()])
        kept[MARGINS[place]] = (corners.min(), corners.max())
    assert len(kept) == len(MARGINS)
    low, high = bars.get_xlim()
    assert kept["margin_contact_ratio"][1] == pytest.approx(0.25345, abs=2e-3)
    assert kept["margin_sliding"][0] == pytest.approx(-0.06737, abs=2e-3)
    # undercut: h - rho (1 - sin) - z/2 sin^2, by hand
    assert kept["margin_undercut"][0] == pytest.approx(
        1.1 - 0.3 * (1 - np.sin(ALPHA)) - 10 * np.sin(ALPHA) ** 2, abs=2e-3
    )
    assert kept["margin_opposite_tips"] == pytest.approx((low, high), abs=2e-3)
    for name, root in (("g3", 0.25345), ("g10", -0.06737)):
        shifts, margin = line(lines, name)
        order = np.argsort(margin)
        order = order[np.isfinite(margin[order])]
        assert np.interp(0.0, margin[order], shifts[order]) == pytest.approx(root, abs=2e-4)


def test_what_the_weights_choose_on_the_front(run: Calculation) -> None:
    figure = figures(run, sheet.weights)["The front, and what the weights choose"]
    chosen = chosen_of(run)
    assert chosen.field is not None
    assert len(figure.axes) == 2
    for panel in figure.axes:
        stress, value = line(panel, "all shifts")
        assert (stress[0], stress[-1]) == pytest.approx(chosen.field.ranges[1])
        found, at = line(panel, "front found")
        assert len(found) == 12
        assert at == pytest.approx(np.interp(found, stress, value), rel=2e-3, abs=2e-4)
        for begin in ("rule, ranges found here: 0.2534", "rule, printed ranges: 0.2534", "as printed: 0.2534"):
            mark = line(panel, begin)
            assert mark[0][0] == pytest.approx(stress[-1], rel=1e-6)
            assert mark[1][0] == pytest.approx(value[-1], rel=1e-4)


def test_the_triangle_of_weights(run: Calculation) -> None:
    chosen = chosen_of(run)
    assert chosen.field is not None
    shares, shifts = triangle(chosen.field)
    part = chosen.field.intervals[0]
    assert shares.sum(axis=1) == pytest.approx(1.0)
    # All on the sum or on sliding: as far as allowed; all on the stresses: the other end.
    for corner, end in (((1, 0, 0), part.high), ((0, 1, 0), part.low), ((0, 0, 1), part.high)):
        (place,) = np.flatnonzero((shares == corner).all(axis=1))
        assert shifts[place] == pytest.approx(end, abs=1e-3)
    # On the edge without sliding the ends of the interval are all there is: the sum's shares above a half win.
    edge = shares[:, 2] == 0
    assert (shifts[edge & (shares[:, 0] > 0.55)] > part.high - 0.01).all()
    assert (shifts[edge & (shares[:, 0] < 0.45)] < part.low + 0.01).all()


def test_marks_in_the_triangle_stand_at_their_shares(run: Calculation) -> None:
    figure = figures(run, sheet.weights)["The shift by weights"]
    panel = figure.axes[0]
    weights = (0.35, 0.01, 0.81)
    place = sum(share * corner for share, corner in zip(weights, SIDES, strict=True)) / sum(weights)
    across, up = line(panel, "as printed")
    assert (across[0], up[0]) == pytest.approx((place.real, place.imag))
    assert {each.get_marker() for each in panel.get_lines()} == {marker for marker, _ in MARKS.values()}


def test_sliding_shows_the_ends_before_and_after(run: Calculation) -> None:
    (panel,) = figures(run, sheet.sliding)["Sliding along the path of contact"].axes
    for begin, shift in (("before", 0.0), ("as stated", 0.21), ("optimum", 0.25345)):
        meshing: Any = ROLLER_SCREW_SHIFT.function(pair_at(shift))
        ends = line(panel, begin)[1]
        assert -ends == pytest.approx([float(meshing.root_sliding_roller), float(meshing.root_sliding_ring)], rel=1e-3)


def test_the_pair_is_drawn_to_scale_before_and_after(run: Calculation) -> None:
    figure = figures(run, sheet.signs)["Roller and ring"]
    assert [panel.get_title(loc="left").split(":")[0] for panel in figure.axes] == [
        "before, no shift of the roller", "optimum",
    ]  # fmt: skip
    for panel, shift in zip(figure.axes, (0.0, 0.25345), strict=True):
        assert panel.get_aspect() == 1.0
        ring, roller = (np.asarray(patch.get_xy()) @ np.array([1, 1j]) for patch in panel.patches)
        tip = 0.5 * (10 + 0.8 + shift)
        assert np.abs(roller[:-2] - 19.80778j).max() == pytest.approx(tip, abs=1e-4)
        ring_shift = float(np.asarray(geometry_of(pair_at(shift)).ring_shift))
        assert np.abs(ring).min() == pytest.approx(0.5 * (50 - 0.8 + ring_shift), abs=1e-4)


def test_without_the_study_the_pair_is_drawn_as_stated() -> None:
    bare = calculate(replace(default_setup(ROLLER_SCREW_SHIFT), studies=()))
    (panel,) = figures(bare, sheet.signs)["Roller and ring"].axes
    assert panel.get_title(loc="left") == "as stated: roller 0.2100, ring −0.1600"
    assert sheet.limits(bare.record) == []
    assert sheet.choice(bare.record) == []
    assert sheet.weights(bare.record) == []
