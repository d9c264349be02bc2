"""Sensitivities, salience and first-order scatter of the press linkage.

The paper: error analysis and accuracy synthesis of a parallel-driven multi-link servo press (Shanghai Jiao Tong
University). Where a number is not printed there, it was solved independently from the loop equations, to the digits
shown; everything else is an identity that no linkage of this kind can escape.
"""

from dataclasses import replace
from math import erf, sqrt

import numpy as np
import pytest
from press_linkage_cases import AROUND, MECHANISMS, PAPER, SIZES, moved, off_by, scattered, sensitivities, solve
from press_linkage_loops import loop_increments

from press_linkage import errors, kinematics
from press_linkage.errors import ARM, DRIVEN, KINDS, PASSIVE, POLAR_ANGLES, SOURCES, source
from press_linkage.quantities import Press


def polar_errors(across: float, down: float, *, radius: float, angle: float) -> tuple[float, float]:
    """Installation errors of a joint along y and z as errors of its polar radius (m) and polar angle (rad).

    First order; *angle* is the polar angle in the frame, so pi minus that of side 1 on side 2.
    """
    cosine, sine = np.cos(angle), np.sin(angle)
    return across * cosine + down * sine, (down * cosine - across * sine) / radius


def test_the_sources_are_29() -> None:
    assert len(SOURCES) == len(set(SOURCES)) == 29
    assert (len(KINDS), len(DRIVEN), len(PASSIVE)) == (14, 7, 7)


# Positions, solved independently: crank angle in degrees from BDC, z_1, z_2 (m), dz_2/dz_1,
# dz_H/dtheta_11 (m/rad), xi of l_h, l_m, l_g, and cot(theta_18)
CYCLE = [
    (-140.3, 0.28484, 2.39436, 2.89112, 0.00021, 2.45116, -2.58896, 2.92904, 2.23790),
    (-90.0, 0.69839, 3.17132, 1.17428, 0.90158, 1.36973, -0.19707, 1.44614, 0.93604),
    (-40.0, 1.25516, 3.53002, 0.25932, 0.10929, 1.14401, 0.77174, 0.81474, 0.55566),
    (-10.0, 1.39105, 3.55649, 0.13308, 0.01322, 1.12995, 0.89827, 0.77289, 0.52611),
    (0.0, 1.39961, 3.55760, 0.12559, 0.0, 1.12937, 0.90583, 0.77162, 0.52486),
    (10.0, 1.39156, 3.55656, 0.13263, -0.01201, 1.12992, 0.89873, 0.77281, 0.52603),
    (40.0, 1.28623, 3.53760, 0.22887, -0.06716, 1.13996, 0.80218, 0.80164, 0.54727),
    (90.0, 0.96450, 3.40544, 0.62750, -0.25295, 1.21407, 0.39884, 1.04130, 0.68846),
    (150.0, 0.56730, 2.99361, 1.55118, -0.52525, 1.51796, -0.65082, 1.74347, 1.14201),
]


@pytest.mark.parametrize("row", CYCLE, ids=lambda row: f"{row[0]:g}deg")
def test_positions_and_sensitivities_over_the_cycle(row: tuple[float, ...]) -> None:
    angle = np.radians(row[0])
    position = solve(PAPER, angle)
    xi = sensitivities(PAPER, angle)
    ours = [
        position.platform_height,
        position.slider_position,
        xi["platform_arm"],
        xi["crank_angle"],
        xi["lower_knee_length"],
        xi["upper_knee_length"],
        xi["knee_drive_length"],
        -xi["slider_half_width"],
    ]
    assert ours == pytest.approx(list(row[1:]), abs=5.001e-6)


# Sensitivities of one side at BDC, solved independently, m/m and m/rad. The slider joint has the sign of the face
# height; the paper writes the height of the joint with +l.
AT_BDC = {
    "lower_knee_length": 1.129368,
    "upper_knee_length": 0.905827,
    "knee_drive_length": 0.771624,
    "slider_half_width": -0.524855,
    "slider_joint_angle": -1.6,
    "ground_pivot_radius": 0.093022,
    "ground_pivot_angle": 1.255145,
    "rod_length": 0.149310,
    "crank_radius": 0.149310,
    "platform_arm": 0.125586,
    "crank_pivot_radius": -0.080757,
    "platform_half_width": 0.080757,
    "crank_pivot_angle": 0.150704,
    "platform_joint_angle": -0.037676,
    "crank_angle": 0.0,
}


@pytest.mark.parametrize(("kind", "expected"), AT_BDC.items())
def test_sensitivity_at_bdc(kind: str, expected: float) -> None:
    assert sensitivities(PAPER, 0.0)[kind] == pytest.approx(expected, abs=5.001e-7)


@MECHANISMS
@pytest.mark.parametrize("name", SOURCES)
def test_derivatives_are_slopes_of_the_exact_kinematics(geometry: Press, name: str) -> None:
    nominal = solve(geometry, AROUND)
    closed = errors.derivatives(geometry, nominal)
    solved = loop_increments(geometry, nominal)
    up, down = moved(geometry, AROUND, name, 1e-6), moved(geometry, AROUND, name, -1e-6)
    for result in ("position", "tilt"):
        exact = getattr(closed, result)[name] * np.ones_like(AROUND)
        slope = (getattr(up, f"slider_{result}") - getattr(down, f"slider_{result}")) / 2e-6
        assert getattr(solved, result)[name] == pytest.approx(exact, abs=1e-12)
        assert slope == pytest.approx(exact, abs=1e-8)


@MECHANISMS
def test_closed_forms_hold_with_deviations_present(geometry: Press) -> None:
    position = solve(
        geometry, 0.4, side_1=scattered(5e-3, 6, (40,)), side_2=scattered(5e-3, 7, (40,)), platform_arm=3e-3
    )
    closed = errors.derivatives(geometry, position)
    solved = loop_increments(geometry, position)
    for name in SOURCES:
        assert closed.position[name] == pytest.approx(solved.position[name], abs=1e-12)
        assert closed.tilt[name] == pytest.approx(solved.tilt[name], abs=1e-12)


def test_driven_chain_tilts_only_a_press_that_is_already_uneven() -> None:
    even = errors.derivatives(PAPER, solve(PAPER, AROUND)).tilt
    assert all(np.all(even[source(kind, side)] == 0.0) for kind in DRIVEN for side in (1, 2))
    uneven = errors.derivatives(PAPER, solve(PAPER, 0.5, side_1=off_by(lower_knee_length=1e-3))).tilt
    assert 0.0 < abs(uneven["rod_length_deviation_1"]) < 1e-3


@MECHANISMS
def test_height_is_of_degree_one_in_the_lengths(geometry: Press) -> None:
    """Euler: the sum of sensitivity times length is the height itself, at every crank angle."""
    xi = sensitivities(geometry, AROUND)
    lengths = [name for name in SIZES if name != "ground_pivot_angle"]
    total = sum(xi[kind] * getattr(geometry, kind) for kind in lengths)
    assert total == pytest.approx(np.asarray(solve(geometry, AROUND).slider_position), abs=1e-12)
    double = replace(geometry, **{kind: 2 * getattr(geometry, kind) for kind in lengths})
    assert solve(double, AROUND).slider_position == pytest.approx(
        2 * np.asarray(solve(geometry, AROUND).slider_position), abs=1e-13
    )


@MECHANISMS
def test_lowering_the_whole_frame_lowers_the_slider(geometry: Press) -> None:
    """A rigid motion: crank pivots and ground joints of both sides down by the same amount, in polar errors."""
    found = errors.derivatives(geometry, solve(geometry, AROUND))
    position, tilt = np.zeros_like(AROUND), np.zeros_like(AROUND)
    for side in (1, 2):
        for place, radius, angle in [
            ("crank_pivot", geometry.crank_pivot_radius, 0.0),
            ("ground_pivot", geometry.ground_pivot_radius, geometry.ground_pivot_angle),
        ]:
            polar = polar_errors(0.0, 1.0, radius=radius, angle=angle if side == 1 else np.pi - angle)
            for suffix, error in zip(("radius", "angle"), polar, strict=True):
                position += error * found.position[source(f"{place}_{suffix}", side)]
                tilt += error * found.tilt[source(f"{place}_{suffix}", side)]
    assert position == pytest.approx(np.ones_like(AROUND), abs=1e-12)
    assert tilt == pytest.approx(np.zeros_like(AROUND), abs=1e-12)


@MECHANISMS
def test_frame_height_is_shared_by_upper_link_and_platform(geometry: Press) -> None:
    xi = sensitivities(geometry, AROUND)
    upper = solve(geometry, AROUND).side_1.upper
    assert xi["upper_knee_length"] * upper.sine + xi["platform_arm"] == pytest.approx(np.ones_like(AROUND), abs=1e-12)


@MECHANISMS
@pytest.mark.parametrize("kind", KINDS)
def test_equal_errors_do_not_tilt_and_opposite_ones_do_not_lower(geometry: Press, kind: str) -> None:
    found = errors.derivatives(geometry, solve(geometry, AROUND))
    sign = -1.0 if kind in POLAR_ANGLES else 1.0
    first, second = (found.position[source(kind, side)] for side in (1, 2))
    assert first == pytest.approx(sign * second, abs=1e-15)
    first, second = (found.tilt[source(kind, side)] for side in (1, 2))
    assert first == pytest.approx(-sign * second, abs=1e-15)


@MECHANISMS
@pytest.mark.parametrize("dead_centre", ["bottom", "top"])
def test_dead_centres(geometry: Press, dead_centre: str) -> None:
    angle = 0.0 if dead_centre == "bottom" else kinematics.top_crank_angle(geometry)
    xi = sensitivities(geometry, angle)
    sign = 1.0 if dead_centre == "bottom" else -1.0
    assert xi["crank_angle"] == pytest.approx(0.0, abs=1e-14)
    assert xi["crank_radius"] == pytest.approx(sign * xi["rod_length"], abs=1e-13)
    rod = solve(geometry, angle).side_1.rod
    assert xi["rod_length"] == pytest.approx(xi["platform_arm"] / rod.sine, abs=1e-13)


# Shares of one source in the slider position, independently computed from the sensitivities
POSITION_SHARES = {
    "slider_joint_angle": 0.1134,
    "ground_pivot_angle": 0.0890,
    "lower_knee_length": 0.0801,
    "upper_knee_length": 0.0642,
    "knee_drive_length": 0.0547,
    "slider_half_width": 0.0372,
    "crank_pivot_angle": 0.0107,
    "rod_length": 0.0106,
    "crank_radius": 0.0106,
    "ground_pivot_radius": 0.0066,
    "crank_pivot_radius": 0.0057,
    "platform_half_width": 0.0057,
    "platform_joint_angle": 0.0027,
    "crank_angle": 0.0,
}


@pytest.mark.parametrize(("kind", "share"), POSITION_SHARES.items())
@pytest.mark.parametrize("side", [1, 2])
def test_share_in_the_slider_position(kind: str, share: float, side: int) -> None:
    shares = errors.salience(errors.derivatives(PAPER, solve(PAPER, 0.0)).position)
    assert shares[source(kind, side)] == pytest.approx(share, abs=5.001e-5)
    assert shares[ARM] == pytest.approx(0.0178, abs=5.001e-5)


# The paper's key sources: H and M positions and the knee links on both sides; the sums it prints, and ours
KEY = [
    ("position", [*list(POSITION_SHARES)[:6]], 0.8766, 0.8771),
    ("tilt", [*list(POSITION_SHARES)[:5]], 0.9006, 0.9016),
]


@pytest.mark.parametrize(("result", "kinds", "printed", "ours"), KEY, ids=["position", "tilt"])
def test_salience_of_the_key_sources(result: str, kinds: list[str], printed: float, ours: float) -> None:
    derivative = getattr(errors.derivatives(PAPER, solve(PAPER, 0.0)), result)
    shares = errors.salience(derivative)
    assert sum(shares.values()) == pytest.approx(1.0, abs=1e-14)
    key = sum(shares[source(kind, side)] for kind in kinds for side in (1, 2))
    assert key == pytest.approx(ours, abs=5.001e-5)
    assert key == pytest.approx(printed, rel=0.0012)
    assert set(sorted(shares, key=shares.get)[-2 * len(kinds) :]) == {source(k, s) for k in kinds for s in (1, 2)}
    assert errors.salience({name: 7.0 * value for name, value in derivative.items()}) == pytest.approx(shares)


# Starting tolerances of the paper's Table 3, total bands in mm (installation: plus and minus, so doubled), and the
# variance they cause in the slider position, both sides together, in um^2
VARIANCES = [
    ("lower_knee_length", 0.125, 276.8),
    ("upper_knee_length", 0.150, 256.4),
    ("knee_drive_length", 0.090, 67.0),
    ("slider_half_width", 0.1, 38.3),
    ("rod_length", 0.125, 4.8),
    ("ground_pivot_radius", 0.1, 1.2),
    ("crank_radius", 0.057, 1.0),
    ("crank_pivot_radius", 0.2, 3.6),
    ("platform_half_width", 0.1, 0.9),
    ("slider_joint_angle", 0.1 / 1.6, 138.9),
    ("ground_pivot_angle", 0.1 / 1.393, 112.8),
    ("crank_pivot_angle", 0.2 / 1.2, 8.8),
    ("platform_joint_angle", 0.1 / 0.3, 2.2),
]


@pytest.mark.parametrize(("kind", "band", "variance"), VARIANCES)
def test_variance_at_the_start(kind: str, band: float, variance: float) -> None:
    found = errors.derivatives(PAPER, solve(PAPER, 0.0)).position
    ours = sum((1e3 * band / 6 * found[source(kind, side)]) ** 2 for side in (1, 2))
    assert ours == pytest.approx(variance, abs=0.0501)


# The paper's Table 4: coefficient of each link, (sensitivity ratio + tolerance ratio) / 2 against the lower knee link
COEFFICIENTS = [
    ("upper_knee_length", 0.150, 1.040),
    ("knee_drive_length", 0.090, 1.426),
    ("rod_length", 0.125, 4.281),
    ("crank_radius", 0.057, 4.876),
    ("platform_arm", 0.070, 5.389),
]


@pytest.mark.parametrize(("kind", "band", "printed"), COEFFICIENTS)
def test_adjustment_coefficients(kind: str, band: float, printed: float) -> None:
    xi = sensitivities(PAPER, 0.0)
    assert (xi["lower_knee_length"] / xi[kind] + 0.125 / band) / 2 == pytest.approx(printed, rel=5.5e-4)


# The paper's reliabilities before and after its synthesis (link bands in mm, ISO 286 IT7, then IT5 and IT6), with its
# reading: lengths only, crank pivot +-0.05 mm, limits 0.02 mm and 0.001324 degree
LINKS = ("lower_knee_length", "upper_knee_length", "knee_drive_length", "rod_length", "crank_radius", "platform_arm")
RELIABILITIES = [
    ((0.125, 0.150, 0.090, 0.125, 0.057, 0.070), 0.5674, 0.8570),
    ((0.055, 0.065, 0.040, 0.078, 0.036, 0.044), 0.8870, 0.9973),
]


@pytest.mark.parametrize(("bands", "position", "tilt"), RELIABILITIES, ids=["start", "final"])
def test_reliabilities(bands: tuple[float, ...], position: float, tilt: float) -> None:
    installed = ("slider_half_width", "ground_pivot_radius", "crank_pivot_radius", "platform_half_width")
    band = dict(zip(LINKS, bands, strict=True)) | dict.fromkeys(installed, 0.1)
    found = errors.derivatives(PAPER, solve(PAPER, 0.0))
    for derivative, limit, printed in [
        (found.position, 0.02e-3, position),
        (found.tilt, np.radians(0.001324), tilt),
    ]:
        sources = {name: name.rsplit("_deviation", 1)[0] for name in SOURCES}
        variance = sum((band.get(kind, 0.0) * 1e-3 / 6 * derivative[name]) ** 2 for name, kind in sources.items())
        assert erf(limit / sqrt(2 * variance)) == pytest.approx(printed, abs=1e-3)


def test_first_order_scatter_is_enough() -> None:
    """Exact kinematics of 10^5 machines: scatter within 1 % of the first order, no shift of the mean."""
    rng = np.random.default_rng(2024)
    sd = {kind: band * 1e-3 / 6 for kind, band, _ in VARIANCES} | {"crank_angle": 0.0}
    sides = [off_by(**{kind: sd[kind] * rng.standard_normal(100_000) for kind in KINDS}) for _ in (1, 2)]
    position = solve(PAPER, 0.0, side_1=sides[0], side_2=sides[1])
    found = errors.derivatives(PAPER, solve(PAPER, 0.0))
    for exact, derivative in [(position.slider_position, found.position), (position.slider_tilt, found.tilt)]:
        first_order = sqrt(sum((sd[kind] * derivative[source(kind, side)]) ** 2 for kind in KINDS for side in (1, 2)))
        assert np.std(exact) == pytest.approx(first_order, rel=0.01)
    assert abs(np.mean(position.slider_position) - solve(PAPER, 0.0).slider_position) < 0.5e-6
