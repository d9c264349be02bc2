"""Gear geometry against handbooks, identities of the standards, and gears traced point by point."""

import numpy as np
import pytest
from traced_gears import (
    ALPHA,
    Couple,
    Flanks,
    deepest_overlap,
    line_of_action_meets,
    path_of_contact,
    sliding_of_surfaces,
    swept_root,
)

from gear_geometry import pairs, roots
from gear_geometry.mesh_load import face_factor, shaken_by_error
from gear_geometry.pairs import working_angle
from gear_geometry.roots import Rack, external_root

INVOLUTES = [  # degrees, involute, digits: any gear handbook; angles whose tangents are known have exact ones
    *((degrees, value, 5e-8) for degrees, value in ((14.5, 0.0055448), (20, 0.0149044), (25, 0.0299753))),
    *((degrees, tangent - np.pi * degrees / 180.0, 2e-14) for degrees, tangent in (
        (15, 2 - 3**0.5), (22.5, 2**0.5 - 1), (30, 3**-0.5), (45, 1.0), (60, 3**0.5), (75, 2 + 3**0.5)
    )),
]  # fmt: skip

# Form factor and stress correction of a load at the tip, rack of 20 degrees with h_f = 1.25 and fillet 0.38, no shift:
# Pu Lianggui, Mechanical Design, table 10-5
FACTORS = [
    (17, 2.97, 1.52), (18, 2.91, 1.53), (19, 2.85, 1.54), (20, 2.80, 1.55), (21, 2.76, 1.56), (22, 2.72, 1.57),
    (23, 2.69, 1.575), (24, 2.65, 1.58), (25, 2.62, 1.59), (26, 2.60, 1.595), (27, 2.57, 1.60), (28, 2.55, 1.61),
    (29, 2.53, 1.62), (30, 2.52, 1.625), (35, 2.45, 1.65), (40, 2.40, 1.67), (45, 2.35, 1.68), (50, 2.32, 1.70),
    (60, 2.28, 1.73), (70, 2.24, 1.75), (80, 2.22, 1.77), (90, 2.20, 1.78), (100, 2.18, 1.79), (150, 2.14, 1.83),
    (200, 2.12, 1.865), (1e7, 2.06, 1.97),
]  # fmt: skip
READ = 0.0071  # the table was read off diagrams and rounded: its own steps scatter by this share

HANDBOOK = Rack(dedendum=1.25, fillet=0.38, pressure_angle=ALPHA)
RACKS = [  # dedendum, fillet, pressure angle in degrees, teeth, shift
    (1.25, 0.38, 20.0, 20, 0.0), (1.25, 0.38, 20.0, 20, 0.3), (1.25, 0.38, 20.0, 55, 0.0), (1.25, 0.25, 20.0, 17, 0.5),
    (1.1, 0.30, 20.0, 20, 0.21), (1.35, 0.20, 20.0, 40, -0.3), (1.2, 0.25, 25.0, 30, 0.1), (0.9, 0.30, 20.0, 12, 1.2),
]  # fmt: skip
NOWHERE = [(9, 1.6, 1.0), (10, 1.3, 0.4), (10, 2.2, 0.7)]  # teeth, shift, dedendum: the fillet stays flatter than 30°


def couple(teeth: tuple[float, float], roller_shift: float, distance: float, addendum: float) -> Couple:
    """Roller and ring without backlash at this distance of their centres; tips by the addendum, in modules."""
    working = float(np.arccos(0.5 * (teeth[1] - teeth[0]) * np.cos(ALPHA) / distance))
    ring_shift = roller_shift + (teeth[1] - teeth[0]) * float(pairs.shift_per_tooth(working, ALPHA))
    tips = 0.5 * teeth[0] + addendum + roller_shift, 0.5 * teeth[1] - addendum + ring_shift
    return Couple(Flanks(teeth[0], roller_shift), Flanks(teeth[1], ring_shift), *tips, distance)


def angles(pair: Couple) -> tuple[tuple[float, float], tuple[float, float], float]:
    """Teeth, tip pressure angles and working pressure angle, as the formulas want them."""
    tips = (float(np.arccos(pair.roller.base / pair.roller_tip)), float(np.arccos(pair.ring.base / pair.ring_tip)))
    working = pairs.working_angle_at(pair.distance, pair.ring.base - pair.roller.base)
    return (pair.roller.teeth, pair.ring.teeth), tips, float(working)


COUPLES = [
    couple((20, 100), 0.21, 39.61556, 0.8), couple((20, 100), 0.0, 40.0, 0.8), couple((18, 90), 0.21, 35.63, 1.0),
    couple((25, 125), 0.3, 50.4, 0.9), couple((40, 60), 0.5, 10.1, 0.8),
]  # fmt: skip
OF_THE_CATALOGUE = couple((16, 24), 0.0, 13.168267706742354 / 3, 1.0)


@pytest.mark.parametrize(("degrees", "value", "digits"), INVOLUTES)
def test_involutes_are_those_of_the_tables(degrees: float, value: float, digits: float) -> None:
    assert pairs.involute(np.radians(degrees)) == pytest.approx(value, abs=digits)
    assert pairs.angle_of_involute(value) == pytest.approx(np.radians(degrees), abs=100 * digits)


def test_the_inverse_of_the_involute_holds_from_0_to_nearly_90_degrees() -> None:
    angle = np.concatenate([np.logspace(-4, -1, 301), np.linspace(0.1, 1.57, 1001)])
    found = np.asarray(pairs.angle_of_involute(pairs.involute(angle)))
    assert np.abs(found - angle).max() < 2e-12  # below 0.01 tan(angle) - angle itself has lost digits
    assert np.abs(found - angle)[angle > 0.1].max() < 3e-15
    assert pairs.angle_of_involute(0.0) == 0.0
    assert np.isnan(pairs.angle_of_involute(-1e-9))
    assert isinstance(pairs.angle_of_involute(0.015), float)


@pytest.mark.parametrize("helix", [0.0, 10.0, 15.8, 30.0])
def test_angles_of_a_helical_gear_keep_the_identities_of_the_standard(helix: float) -> None:
    beta = np.radians(helix)
    transverse, base = pairs.transverse_angle(ALPHA, beta), pairs.base_helix_angle(ALPHA, beta)
    assert np.tan(base) == pytest.approx(np.tan(beta) * np.cos(transverse), rel=1e-14)
    assert np.cos(base) * np.cos(transverse) == pytest.approx(np.cos(beta) * np.cos(ALPHA), rel=1e-14)


def test_pairs_of_a_catalogue() -> None:
    """Spur pair 12/24, shifts 0.6/0.36, and internal pair 16/24, shifts 0/0.5, module 3: technical reference of KHK.

    The catalogue looks the angles up in a table of the involute, and prints 31.0937 for 31.0936.
    """
    external, internal = working_angle((0.6 + 0.36) / 36, ALPHA), working_angle((0.5 - 0.0) / 8, ALPHA)
    assert np.degrees(external) == pytest.approx(26.0886, abs=5e-5)
    assert 3 * 18 * np.cos(ALPHA) / np.cos(external) == pytest.approx(56.4999, abs=5e-5)
    assert np.degrees(internal) == pytest.approx(31.0937, abs=1e-4)
    assert 3 * 4 * np.cos(ALPHA) / np.cos(internal) == pytest.approx(13.1683, abs=5e-5)


def test_the_internal_pair_of_the_catalogue_interferes_by_a_hair_at_full_depth() -> None:
    pair = OF_THE_CATALOGUE
    teeth, tips, working = angles(pair)
    assert pair.ring.shift == pytest.approx(0.5, abs=1e-9)
    assert pairs.clear_of_base(teeth, tips[1], working) == pytest.approx(-0.0206, abs=5e-5)
    roller, ring = pairs.internal_sliding(teeth, tips, working)
    assert np.isnan(roller)
    assert np.isfinite(ring)


@pytest.mark.parametrize("pair", [*COUPLES, OF_THE_CATALOGUE])
def test_the_tip_of_the_ring_meets_the_line_of_action_so_far_beyond_the_base_circle(pair: Couple) -> None:
    teeth, tips, working = angles(pair)
    outward = np.array([np.cos(working), np.sin(working)])
    touches = np.array([pair.distance, 0.0]) + pair.roller.base * outward
    beyond = (path_of_contact(pair)[1] - touches) @ np.array([outward[1], -outward[0]])
    assert 0.5 * np.cos(ALPHA) * pairs.clear_of_base(teeth, tips[1], working) == pytest.approx(beyond, abs=1e-10)


@pytest.mark.parametrize("helix", [0.0, 20.0])
def test_working_angle_and_shift_are_inverse_to_one_another(helix: float) -> None:
    transverse = pairs.transverse_angle(ALPHA, np.radians(helix))
    share = np.linspace(-0.01, 0.05, 13)
    working = working_angle(share, ALPHA, transverse)
    assert pairs.shift_per_tooth(working, ALPHA, transverse) == pytest.approx(share, abs=1e-14)
    assert working_angle(0.0, ALPHA, transverse) == pytest.approx(float(transverse), abs=1e-14)


def test_no_working_angle_where_no_pair_has_these_shifts() -> None:
    assert np.isnan(working_angle(-0.03, ALPHA))
    assert np.isnan(pairs.working_angle_at(0.9, 1.0))


def test_contact_ratio_of_an_external_pair_is_its_traced_path() -> None:
    pinion, wheel, tips, distance = Flanks(21, 0.3), Flanks(40, -0.1), (11.8, 20.9), 30.69
    working = float(np.arccos((pinion.base + wheel.base) / distance))
    touch = pinion.base * np.array([np.cos(working), np.sin(working)])
    along = np.array([np.sin(working), -np.cos(working)])  # from one base circle to the other
    reach = [np.sqrt(tip**2 - flanks.base**2) for tip, flanks in zip(tips, (pinion, wheel), strict=True)]
    far = np.array([distance, 0.0]) - wheel.base * np.array([np.cos(working), np.sin(working)])
    path = (touch + reach[0] * along) - (far - reach[1] * along)
    pitch = np.pi * np.cos(ALPHA)
    expected = float(path @ along) / pitch
    found = pairs.external_contact_ratio(tips, (pinion.base, wheel.base), working, pitch)
    assert found == pytest.approx(expected, rel=1e-12)
    assert 1.3 < expected < 1.8


@pytest.mark.parametrize("pair", COUPLES)
def test_contact_ratio_and_sliding_of_an_internal_pair_are_those_of_its_traced_path(pair: Couple) -> None:
    """Sliding: from the speeds of both surfaces at the ends of the path."""
    teeth, tips, working = angles(pair)
    at_roller_tip, at_ring_tip = path_of_contact(pair)
    length = np.hypot(*(at_roller_tip - at_ring_tip)) / (np.pi * np.cos(ALPHA))
    assert pairs.internal_contact_ratio(teeth, tips, working) == pytest.approx(length, rel=1e-10)
    roller, ring = pairs.internal_sliding(teeth, tips, working)
    assert -float(roller) == pytest.approx(sliding_of_surfaces(pair, at_ring_tip)[0], rel=1e-9)
    assert -float(ring) == pytest.approx(sliding_of_surfaces(pair, at_roller_tip)[1], rel=1e-9)


@pytest.mark.parametrize("pair", COUPLES)
def test_flanks_that_mesh_touch_without_overlap(pair: Couple) -> None:
    assert abs(deepest_overlap(pair)) < 1e-6


@pytest.mark.parametrize(("teeth", "form", "correction"), FACTORS)
def test_factors_of_a_load_at_the_tip_are_those_of_the_handbook(teeth: float, form: float, correction: float) -> None:
    root = external_root(HANDBOOK, teeth, 0.0)
    arm = roots.external_arm(HANDBOOK, teeth, 0.0, root, teeth + 2.0)
    assert roots.form_factor(root, arm, ALPHA) == pytest.approx(form, rel=READ)
    assert roots.stress_correction(root, arm) == pytest.approx(correction, rel=READ)


def test_ring_factors_are_those_of_the_standard() -> None:
    """Internal gear, h_a = 1, h_f = 1.25, fillet 0.15: Y_Fa = 2.053, Y_Sa = 2.65, GB/T 3480-1997."""
    rack = Rack(dedendum=1.25, fillet=0.15, pressure_angle=ALPHA)
    root = roots.ring_root(rack)
    arm = roots.ring_arm(rack, root, 1.0)
    assert roots.form_factor(root, arm, ALPHA) == pytest.approx(2.053, abs=1e-3)
    assert roots.stress_correction(root, arm) == pytest.approx(2.65, abs=5e-3)
    assert roots.notch(root) == pytest.approx(float(root.chord) / 0.3, rel=1e-15)


@pytest.mark.parametrize(("dedendum", "fillet", "degrees", "teeth", "shift"), RACKS)
def test_critical_section_and_arm_are_those_of_the_swept_rack(
    dedendum: float, fillet: float, degrees: float, teeth: float, shift: float
) -> None:
    """The arm reaches to where the normal of the tip meets the axis."""
    alpha = float(np.radians(degrees))
    rack = Rack(dedendum=dedendum, fillet=fillet, pressure_angle=alpha)
    root, tip = external_root(rack, teeth, shift), 0.5 * teeth + 1.0 + shift
    chord, curvature, depth = swept_root(dedendum, fillet, Flanks(teeth, shift, alpha))
    assert float(root.chord) == pytest.approx(chord, abs=1e-6)
    assert float(root.depth) == pytest.approx(depth, abs=1e-6)
    assert float(root.fillet) == pytest.approx(curvature, rel=2e-4)
    arm = roots.external_arm(rack, teeth, shift, root, 2.0 * tip)
    meets = line_of_action_meets(Flanks(teeth, shift, alpha), tip, 1.0)
    assert float(arm.height) == pytest.approx(meets - float(root.depth), abs=1e-6)


def test_a_gear_of_many_teeth_has_the_root_of_the_substitute_rack() -> None:
    rack = Rack(dedendum=1.25, fillet=0.3, pressure_angle=ALPHA)
    many, ring = external_root(rack, 1e7, 0.0), roots.ring_root(rack)
    arm, lever = roots.external_arm(rack, 1e7, 0.0, many, 1e7 + 2.0), roots.ring_arm(rack, ring, 1.0)
    assert float(many.chord) == pytest.approx(float(ring.chord), rel=1e-6)
    assert float(many.fillet) == pytest.approx(float(ring.fillet), rel=1e-5)
    assert float(arm.height) == pytest.approx(float(lever.height), rel=1e-6)
    assert float(arm.angle) == pytest.approx(float(lever.angle), rel=1e-5)


@pytest.mark.parametrize(("teeth", "shift", "dedendum"), NOWHERE)
def test_a_fillet_that_stays_flat_has_no_critical_section(teeth: float, shift: float, dedendum: float) -> None:
    assert np.isnan(swept_root(dedendum, 0.3, Flanks(teeth, shift))[0])
    assert np.isnan(external_root(Rack(dedendum=dedendum, fillet=0.3, pressure_angle=ALPHA), teeth, shift).chord)


def test_a_rack_that_is_pointed_before_it_is_round_has_no_critical_section() -> None:
    """The circles of both flanks meet where the fillet is (pi/4 - h_f tan a) cos a/(1 - sin a)."""
    largest = (0.25 * np.pi - 1.25 * np.tan(ALPHA)) * np.cos(ALPHA) / (1.0 - np.sin(ALPHA))
    below, above = (Rack(dedendum=1.25, fillet=largest + step, pressure_angle=ALPHA) for step in (-1e-9, 1e-9))
    assert np.isfinite(external_root(below, 20.0, 0.0).chord)
    assert np.isnan(external_root(above, 20.0, 0.0).chord)


def test_the_angle_of_the_tangent_solves_its_equation_wherever_it_is_told() -> None:
    rng = np.random.default_rng(5)
    teeth, shift = rng.integers(8, 200, 5000).astype(float), rng.uniform(-2.0, 3.0, 5000)
    found = roots.fillet_of(HANDBOOK, teeth, shift)
    known = np.isfinite(found.angle)
    missed = np.asarray(found.angle - 2.0 * found.height / teeth * np.tan(found.angle) + found.constant)
    assert 0.5 < known.mean() < 1.0
    assert np.abs(missed[known]).max() < 1e-12


def test_the_face_factor_of_a_misaligned_pair() -> None:
    """ISO 6336-1: 1 + r while the whole face carries, 2 sqrt(r) beyond; both are 2 with the same slope at r = 1."""
    assert face_factor(np.array([-0.5, 0.0, 0.3, 1.0, 4.0])) == pytest.approx([1.0, 1.0, 1.3, 2.0, 4.0])
    step = 1e-6
    assert (face_factor(1 + step) - face_factor(1 - step)) / (2 * step) == pytest.approx(1.0, abs=1e-6)


def test_the_limits_of_a_mass_that_an_error_shakes() -> None:
    """Textbook: nothing at rest, N^2 below, 1/(2 zeta) at resonance, 1 far above; largest at 1/sqrt(1 - 2 zeta^2)."""
    zeta, ratio = 0.07, np.linspace(0.5, 1.5, 100_001)
    assert shaken_by_error(0.0, zeta) == 0.0
    assert shaken_by_error(0.01, zeta) / 0.01**2 == pytest.approx(1.0, rel=2e-4)
    assert shaken_by_error(1.0, zeta) == pytest.approx(1 / (2 * zeta), rel=1e-14)
    assert shaken_by_error(100.0, zeta) == pytest.approx(1.0, rel=2e-4)
    assert ratio[np.argmax(shaken_by_error(ratio, zeta))] == pytest.approx(1 / np.sqrt(1 - 2 * zeta**2), abs=1e-5)
