"""Geometry of roller and ring: printed digits, both readings of the paper's labels, gears traced point by point."""

from dataclasses import replace

import numpy as np
import pytest
from traced_gears import ALPHA, Couple, Flanks, deepest_overlap, free_turn, path_of_contact, sliding_of_surfaces

from gear_geometry.pairs import working_angle
from roller_screw_shift import geometry as formulas
from roller_screw_shift.calculation import meshing_of
from roller_screw_shift.geometry import backlash, geometry_of
from roller_screw_shift.model import ROLLER_SCREW_SHIFT
from roller_screw_shift.quantities import Pair
from roller_screw_shift.strength import load_of

# The default pair at x_E = 0.21, as an independent program printed it: six digits
REGRESSION = {
    "working_angle": 0.321344, "contact_ratio": 1.423027, "tip_angle_roller": 0.548150, "tip_angle_ring": 0.290545,
    "crossing_angle_roller": 0.611395, "crossing_angle_ring": 0.129231, "tip_clearance": 0.6299,
    "form_factor_roller": 2.12002, "stress_correction_roller": 1.86315, "form_factor_ring": 1.83107,
    "stress_correction_ring": 2.84399, "sliding_roller": 0.8287, "sliding_ring": 0.5719, "margin_roller_root": 0.2144,
    "ring_shift": -0.16, "margin_opposite_tips": 77.5456,
}  # fmt: skip


def pair_of(**changed: object) -> Pair:
    """A pair with the defaults but for these inputs."""
    made: Pair = ROLLER_SCREW_SHIFT.inputs(**changed)
    return made


def traced(pair: Pair) -> Couple:
    """The pair as mounted, for tracing: lengths in modules, flanks by the shifts found without backlash."""
    geometry, module = geometry_of(pair), float(pair.module)
    return Couple(
        Flanks(float(pair.roller_teeth), float(pair.roller_shift), float(pair.pressure_angle)),
        Flanks(float(pair.ring_teeth), float(geometry.ring_shift), float(pair.pressure_angle)),
        float(geometry.roller.tip_radius) / module,
        float(geometry.ring.tip_radius) / module,
        float(geometry.mounted_distance) / module,
    )


# Teeth, centre distance over the one without shifts, shift of the roller, addendum: tips that pass and tips that do not
TIPS = [
    (30, 38, 0.97, 0.5, 1.0), (30, 38, 1.0, 0.0, 1.0), (30, 38, 1.0, 0.5, 1.0), (40, 48, 0.97, 1.0, 1.0),
    (40, 48, 1.05, 0.5, 1.0), (60, 68, 0.97, -0.5, 0.8), (60, 68, 0.97, 1.0, 0.8), (60, 68, 0.97, 1.5, 0.8),
    (60, 68, 1.0, 0.0, 1.0), (100, 108, 0.97, 0.5, 0.8), (100, 108, 1.0, 0.0, 0.8),
]  # fmt: skip


def small_difference(roller: float, ring: float, stretch: float, shift: float, addendum: float) -> Pair:
    """A pair of few teeth difference, where tips may meet."""
    teeth = {"roller_teeth": float(roller), "ring_teeth": float(ring)}
    return pair_of(**teeth, centre_distance=0.25e-3 * (ring - roller) * stretch, roller_shift=shift, addendum=addendum)


@pytest.mark.parametrize("name", REGRESSION)
def test_the_default_pair_has_the_digits_of_an_independent_program(name: str) -> None:
    result = ROLLER_SCREW_SHIFT.read_results(ROLLER_SCREW_SHIFT.function(pair_of()))[name]
    digits = len(str(REGRESSION[name]).partition(".")[2])
    assert float(result) == pytest.approx(REGRESSION[name], abs=0.51 * 10.0**-digits)
    assert formulas.tip_land(pair_of(), geometry_of(pair_of())) / 0.5e-3 == pytest.approx(0.85162, abs=5e-6)


def test_without_backlash_the_pair_keeps_both_equations_of_the_standard() -> None:
    pair = pair_of(roller_shift=np.linspace(-0.05, 0.25, 7))
    geometry = geometry_of(pair)
    reference = 0.5 * pair.module * (pair.ring_teeth - pair.roller_teeth)
    assert pair.centre_distance * np.cos(geometry.working_angle) == pytest.approx(
        reference * np.cos(pair.pressure_angle), rel=1e-14
    )
    found = working_angle((geometry.ring_shift - pair.roller_shift) / 80.0, pair.pressure_angle)
    assert found == pytest.approx(np.full(7, float(geometry.working_angle)), rel=1e-13)
    assert geometry.ring_shift - pair.roller_shift == pytest.approx(np.full(7, -0.37), abs=1e-5)


def test_a_positive_shift_of_the_ring_is_outward() -> None:
    """The ring follows the roller: tip, root and gap of the ring grow with its shift, and not with a deviation."""
    near, far, off = (
        geometry_of(pair_of(**changed))
        for changed in (
            {"roller_shift": 0.0},
            {"roller_shift": 0.2},
            {"roller_shift": 0.0, "centre_distance_deviation": 30e-6},
        )
    )
    assert far.ring_shift > near.ring_shift == off.ring_shift
    assert far.ring.tip_radius - near.ring.tip_radius == pytest.approx(0.2 * 0.5e-3, rel=1e-9)
    assert far.ring.root_radius - near.ring.root_radius == pytest.approx(0.2 * 0.5e-3, rel=1e-9)
    assert off.ring.tip_radius == near.ring.tip_radius
    assert off.mounted_angle > near.mounted_angle == near.working_angle
    assert float(backlash(near)) == 0.0


@pytest.mark.parametrize("deviation", [-40e-6, 0.0, 25e-6])
def test_sliding_and_contact_ratio_are_those_of_the_pair_as_mounted(deviation: float) -> None:
    pair = pair_of(centre_distance_deviation=deviation)
    geometry, couple = geometry_of(pair), traced(pair)
    at_roller_tip, at_ring_tip = path_of_contact(couple)
    length = np.hypot(*(at_roller_tip - at_ring_tip)) / (np.pi * np.cos(ALPHA))
    assert formulas.contact_ratio(geometry) == pytest.approx(length, rel=1e-10)
    roller, ring = formulas.sliding_at_roots(geometry)
    assert -float(roller) == pytest.approx(sliding_of_surfaces(couple, at_ring_tip)[0], rel=1e-9)
    assert -float(ring) == pytest.approx(sliding_of_surfaces(couple, at_roller_tip)[1], rel=1e-9)


def test_specific_sliding_of_the_printed_shifts() -> None:
    """-0.828725 from surface speeds belongs to a difference of the shifts of exactly -0.37."""
    working = working_angle(-0.37 / 80.0, ALPHA)
    pair = pair_of(centre_distance=0.02 * np.cos(ALPHA) / np.cos(working))
    at_ring_tip = path_of_contact(traced(pair))[1]
    assert sliding_of_surfaces(traced(pair), at_ring_tip)[0] == pytest.approx(-0.828725, abs=5e-7)
    assert meshing_of(pair).sliding_roller == pytest.approx(0.828725, abs=5e-7)


@pytest.mark.parametrize("shift", [-0.05, 0.21, 0.7, 1.5])
def test_the_sliding_that_counts_is_the_largest_on_the_path(shift: float) -> None:
    """Point by point from the speeds of both surfaces; from 0.69 on the path lies wholly beyond the pitch point."""
    pair = pair_of(roller_shift=shift)
    at_roller_tip, at_ring_tip = path_of_contact(traced(pair))
    along = (at_ring_tip + share * (at_roller_tip - at_ring_tip) for share in np.linspace(0.0, 1.0, 401))
    largest = np.abs([sliding_of_surfaces(traced(pair), point) for point in along]).max(axis=0)
    found = meshing_of(pair)
    assert (found.sliding_roller, found.sliding_ring) == pytest.approx(tuple(largest), rel=1e-9)


def test_the_difference_of_sliding_does_not_fold() -> None:
    """It grows with the shift on either side of equal sliding; by the roots alone it falls again from 0.69 on."""
    shifts = np.linspace(0.29, 1.5, 300)
    found, roots = (
        np.diff(np.asarray(meshing_of(pair_of(roller_shift=shifts, **reading)).sliding_difference))
        for reading in ({}, {"sliding_reading": "roots"})
    )
    assert found.min() > 0
    assert roots.min() < 0


@pytest.mark.parametrize(("roller", "ring", "stretch", "shift", "addendum"), TIPS)
def test_tips_overlap_by_what_their_clearance_lacks(
    roller: float, ring: float, stretch: float, shift: float, addendum: float
) -> None:
    pair = small_difference(roller, ring, stretch, shift, addendum)
    clearance = float(formulas.crossing_of(geometry_of(pair)).clearance)
    deepest = deepest_overlap(traced(pair))
    assert formulas.involute_margin(geometry_of(pair)) > 0.0
    assert deepest == pytest.approx(max(0.0, -clearance), abs=2e-4)


def test_some_of_these_tips_meet_and_some_do_not() -> None:
    found = [float(formulas.crossing_of(geometry_of(small_difference(*each))).clearance) for each in TIPS]
    assert min(found) < -0.1
    assert max(found) > 0.1


def test_tips_whose_circles_do_not_cross_have_a_whole_pitch() -> None:
    pair = pair_of(centre_distance=0.0195)  # the roller is too far inside to reach the teeth of the ring
    far = geometry_of(replace(pair, addendum=0.05))
    assert far.mounted_distance + far.roller.tip_radius < far.ring.tip_radius
    assert float(formulas.crossing_of(far).clearance) == pytest.approx(2.0 * np.pi)
    assert pytest.approx(2.0 * np.pi) == formulas.APART
    assert formulas.contact_ratio(far) < 0.0


@pytest.mark.parametrize("deviation", [-40e-6, -2e-6, 0.0, 2e-6, 40e-6])
def test_backlash_is_the_play_of_the_roller_in_the_ring(deviation: float) -> None:
    """Turned by hand from flank to flank; centres farther apart press the roller into the ring."""
    pair = pair_of(centre_distance_deviation=deviation)
    geometry = geometry_of(pair)
    pitch_radius = geometry.mounted_distance * 20.0 / 80.0
    play = free_turn(traced(pair)) * pitch_radius
    assert float(backlash(geometry)) == pytest.approx(play, abs=2e-11)
    assert deviation * play <= 0.0


def test_turns_of_carrier_and_roller_are_those_of_threads_that_roll() -> None:
    """The nut stands still: the roller's thread touches it at rest and the screw at the screw's speed."""
    pair = pair_of()
    screw, roller = float(pair.screw_diameter), float(pair.roller_diameter)
    carrier = 0.5 * screw / (screw + roller)  # centre of the roller at half the speed of the screw's pitch point
    spin = carrier - carrier * (screw + 2.0 * roller) / roller  # about its own axis: rolls in the nut
    load = load_of(pair)
    assert load.carrier_order == pytest.approx(carrier) == pytest.approx(0.375)
    assert load.roller_order == pytest.approx(carrier - spin) == pytest.approx(1.875)
