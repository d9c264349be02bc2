"""Heat, film and reversed bending of the first stage against integrals, laws of their own and limits.

The worked examples of ISO/TS 6336-21, ISO/TR 15144-2 and AGMA 925 could not be had; what is written here a second time
is in millimetres, as the standards print it. Printed numbers are those of the test gears: the load stages of the FZG
tests, and the film that ISO/TR 15144-1 permits by stage and viscosity (figure A.1).
"""

from math import cos, log10, pi, sqrt, tan
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from gear_geometry.mesh_load import viscosity_at
from pages import Page
from rv_gearing import geometry
from rv_gearing.flank import BLOK_FACTOR, Oil, blok, mean_by_tip, path_of
from rv_gearing.model import RV_GEARING
from rv_gearing.published import FILM_OF_THE_TEST, MICROPITTING_TEST, STAGES
from rv_gearing.rating import rv_gearing
from truing.units import from_si


def rated(**stated: Any) -> dict[str, Any]:
    fields = RV_GEARING.own_result_fields
    answers = RV_GEARING.read_results(rv_gearing(RV_GEARING.inputs(**stated)))
    return {name: from_si(value, fields[name].unit) for name, value in answers.items()}


def test_the_factor_of_blok_is_the_hottest_point_of_a_fast_band_with_the_pressure_of_hertz() -> None:
    """Heat that flows straight down: rise(x) = int q(s) / sqrt(pi (x - s)) ds over B_M sqrt(v), q half an ellipse."""

    def rise(place: float) -> float:
        ellipse = lambda s: 2 / pi * sqrt(max(1 - s * s, 0)) / sqrt(pi)  # noqa: E731  half width 1, load 1
        return float(quad(ellipse, -1, place, weight="alg", wvar=(0, -0.5))[0])

    hottest = max(rise(place) for place in np.linspace(0, 1, 101))
    assert hottest * sqrt(2) == pytest.approx(BLOK_FACTOR, rel=2e-3)


def path_of_group(group: int) -> tuple[np.ndarray, np.ndarray, float]:
    stage = RV_GEARING.inputs(group=group)
    load = geometry.load_of(stage)
    mesh = geometry.mesh_size(stage, load)
    sizes = [geometry.gear_size(stage, load, mesh, which) for which in ("sun", "planet")]
    path = path_of(stage, load.duty, mesh, (sizes[0], sizes[1]))
    return np.asarray(path.radii[0]), np.asarray(path.share), float(mesh.base_pitch)


@pytest.mark.parametrize("group", [1, 5, 25])
def test_two_pairs_a_base_pitch_apart_carry_the_whole_load_together(group: int) -> None:
    """Statics: where a pair does not carry alone, its share and that of the other pair add up to 1."""
    radius, share, pitch = path_of_group(group)
    begins, ends = slice(0, 5), slice(10, 15)
    assert radius[begins] + pitch == pytest.approx(radius[ends], rel=1e-12)
    assert share[begins] + share[ends] == pytest.approx(np.ones(5), rel=1e-12)
    assert share[5:10] == pytest.approx(np.ones(5))


def test_flash_temperature_is_that_of_the_printed_formula_in_millimetres() -> None:
    """ISO/TR 13989-1, equation 5 with X_M = 50; it takes the load of the pitch line, Blok that along the normal."""
    w, speed, u, radii = 200.0, 1500.0, 2.75, (6.0, 12.0)
    printed = 2.52 * w**0.75 * sqrt(speed / 60) * abs(sqrt(radii[0]) - sqrt(radii[1] / u))
    printed /= (radii[0] * radii[1] / sum(radii)) ** 0.25
    turn = 2 * pi * speed / 60
    speeds = (turn * radii[0] / 1e3, turn * radii[1] / 1e3 / u)
    own = blok(w * 1e3 / cos(np.radians(20)), (radii[0] / 1e3, radii[1] / 1e3), speeds, 2 * 0.91 / 206e9)
    assert float(own) == pytest.approx(printed / cos(np.radians(20)) ** 0.75, rel=0.025)  # 2.52 and 50 are rounded
    assert printed < float(own)  # on the safe side of the standard


def test_the_mean_over_the_path_is_that_of_a_triangle_of_heat_and_continuous() -> None:
    """Heat in proportion to the distance from the pitch point; where two pairs carry, about half of it."""
    assert float(mean_by_tip(0.4999999, 0.5000001)) == pytest.approx(0.5, rel=2e-6)  # one pair alone: a triangle
    for one, two in ((0.8, 0.8), (0.9, 0.7), (0.7, 0.9), (0.95, 0.9)):
        both = one + two
        alone = quad(abs, one - 1, 1 - two, points=[0])[0]
        shared = 0.5 * (quad(abs, -two, one - 1)[0] + quad(abs, 1 - two, one)[0])
        exact = (alone + shared) / (both * one)
        assert float(mean_by_tip(one, two)) == pytest.approx(exact, rel=0.1)
    for two in (0.3, 0.6, 0.9):
        assert float(mean_by_tip(1 - 1e-12, two)) == pytest.approx(float(mean_by_tip(1.0, two)), rel=1e-9)
        assert float(mean_by_tip(two, 1 - 1e-12)) == pytest.approx(float(mean_by_tip(two, 1.0)), rel=1e-9)


def test_temperatures_of_the_example_point_by_point() -> None:
    """The path in 4000 steps, in mm, with friction, sharing and sums written a second time."""
    found = rated(group=5, flank_roughness_sun="3 um", flank_roughness_planet="3 um", oil_temperature="60 degC")
    module, z, angle = 1.25, (23, 63), np.radians(20)
    base = [module * each * cos(angle) / 2 for each in z]
    tips = [sqrt((module * (each + 2) / 2) ** 2 - own**2) for each, own in zip(z, base, strict=True)]
    whole, pitch = sum(base) * tan(angle), pi * module * cos(angle)
    begin, end = whole - tips[1], tips[0]
    one = np.linspace(begin, end, 4001)
    two, u = whole - one, z[1] / z[0]
    share = np.interp(one, [begin, end - pitch, end - pitch + 1e-9, begin + pitch, begin + pitch + 1e-9, end],
                      [1 / 3, 2 / 3, 1, 1, 2 / 3, 1 / 3])  # fmt: skip
    turn, w = 2 * pi * float(found["mesh_speed"]) / 60, float(found["flank_load"])
    eta = viscosity_at(333.15, 100.0) * (892 - 0.7 * (333.15 - 289)) / 1e3
    curve = base[0] * tan(angle) * base[1] * tan(angle) / whole
    v_sum = 2 * turn * base[0] * tan(angle) / 1e3
    friction = 0.045 * (max(w, 150) / (v_sum * curve)) ** 0.2 * eta**-0.05 * 2.2 * (0.5 / curve) ** 0.25
    heat = 2.52 * friction * (share * w) ** 0.75 * sqrt(turn / 2 / pi) * np.abs(np.sqrt(one) - np.sqrt(two / u))
    heat /= (one * two / whole) ** 0.25
    assert float(found["flank_friction"]) == pytest.approx(friction, rel=1e-6)
    assert float(found["flash_temperature"]) == pytest.approx(heat.max(), rel=0.03)
    assert float(found["mean_flash_temperature"]) == pytest.approx(heat.mean(), rel=0.04)
    assert float(found["scuffing_rise"]) == pytest.approx(80 + 2.25 * eta**-0.05 * 144 - 60, rel=1e-9)


def test_the_film_is_that_of_the_printed_formula_in_millimetres() -> None:
    """ISO/TR 15144-1, equations 4 to 33 at the end of the path where it is least; without friction nothing is hot."""
    found = rated(sun_teeth=25, planet_teeth=69, shift_sun=0.3, stated_friction=1e-9, oil_temperature="60 degC")
    reduced, kelvin = 2 / (2 * 0.91 / 206000), 333.15

    def eta(heat: float) -> float:
        return 1e-6 * float(viscosity_at(heat, 100.0)) * (892 - 0.7 * (heat - 289))

    alpha = 2.657e-8 * eta(311.0) ** 0.1348 * (1 + 516 * (1 / kelvin - 1 / 311))
    turn, w = 2 * pi * float(found["mesh_speed"]) / 60, float(found["flank_load"])
    whole = sum(float(found[f"base_diameter_{gear}"]) / 2 for gear in ("sun", "planet")) * tan(
        np.radians(float(found["working_angle"]))
    )
    films = []
    for one, share in (
        (float(found["start_curvature_sun"]), 1 / 3),
        (whole - float(found["start_curvature_planet"]), 1 / 3),
    ):
        two = whole - one
        radius = one * two / whole
        v_sum = turn * (one + two * 25 / 69) / 1e3
        pressed = sqrt(reduced / (2 * pi)) * sqrt(w * share / (radius * cos(np.radians(20))))
        u_y = eta(kelvin) * v_sum / (2000 * reduced * radius)
        w_y = 2 * pi * pressed**2 / reduced**2
        films.append(1600 * radius * (1e6 * alpha * reduced) ** 0.6 * u_y**0.7 * w_y**-0.13)
    assert float(found["film_ratio"]) == pytest.approx(min(films) / (4 / 6), rel=1e-3)


def micropitting_test(grade: int, stage: int) -> dict[str, Any]:
    stated = {name: value for name, value in MICROPITTING_TEST.items() if name != "studies.run"}
    numbers = {name: float(value) for name, value in stated.items() if value.replace(".", "").isdigit()}
    density = FILM_OF_THE_TEST[grade][0]
    return rated(**{**stated, **numbers}, viscosity=f"{grade} mm^2/s", oil_density=f"{density} kg/m^3",
                 stated_sun_torque=f"{STAGES[stage]} N*m")  # fmt: skip


@pytest.mark.parametrize(("grade", "stage"), [(32, 10), (100, 10), (460, 5)])
def test_the_film_of_the_test_gears_is_that_of_the_whole_chain_written_again(grade: int, stage: int) -> None:
    """ISO/TR 15144-1 in mm and N/mm², with its own steel (45 W/(m K), 440 J/(kg K), 7800 kg/m³) and flash, at A.

    Ours takes Blok's factor 1.11 where the report has 2/sqrt(pi) = 1.128, and a steel that conducts more: a flash that
    is 11 % lower, and up to 6 % more film.
    """
    found = micropitting_test(grade, stage)
    base, a, pitch = (4.5 * 16 * cos(np.radians(20)), 4.5 * 24 * cos(np.radians(20))), 91.5, 4.5 * pi * cos(0.349066)
    tips = (4.5 * (18 + 2 * 0.1817), 4.5 * (26 + 2 * 0.1715))
    ends = [sqrt(tip**2 - own**2) / 2 for tip, own in zip(tips, base, strict=True)]
    whole, turn, load = sqrt(a**2 - (sum(base) / 2) ** 2), 2 * pi * 2250 / 60, 2000 * STAGES[stage] / 72
    ratios = [(end - own / 2 * tan(np.arccos(sum(base) / 2 / a))) / pitch for end, own in zip(ends, base, strict=True)]
    losses = pi * (1 / 16 + 1 / 24) * (1 - sum(ratios) + ratios[0] ** 2 + ratios[1] ** 2)

    def eta(kelvin: float) -> float:
        return 1e-6 * float(viscosity_at(kelvin, grade)) * (FILM_OF_THE_TEST[grade][0] - 0.7 * (kelvin - 289))

    def alpha_eta(kelvin: float) -> float:
        return 2.657e-8 * eta(311.0) ** 0.1348 * (1 + 516 * (1 / kelvin - 1 / 311)) * eta(kelvin)

    rolling = [own / 2 * tan(np.arccos(sum(base) / 2 / a)) for own in base]
    curve = rolling[0] * rolling[1] / whole
    friction = 0.045 * (load / cos(0.349066) / 14 / (2e-3 * turn * rolling[0] * curve)) ** 0.2
    friction *= (1e3 * eta(363.15)) ** -0.05 * 2.2 * (0.5 / curve) ** 0.25
    bulk = 7400 * (turn * STAGES[stage] / 1e3 * friction * losses / (a * 14)) ** 0.72 / 1.2
    assert float(found["film_bulk_rise"]) == pytest.approx(bulk, rel=0.02)
    one, two = whole - ends[1], ends[1]
    radius, speeds, reduced = one * two / whole, (turn * one / 1e3, turn * two / 1.5e3), 206000 / 0.91
    pressed = sqrt(reduced / 2 / pi * load / 3 / (14 * radius * cos(0.349066)))
    flash = sqrt(pi) / 2 * friction * 1e6 * pressed * abs(speeds[0] - speeds[1]) / sqrt(45 * 440 * 7800)
    flash *= sqrt(8e-3 * radius * pressed / reduced) / (sqrt(speeds[0]) + sqrt(speeds[1]))
    warm = 363.15 + bulk
    film = 1600 * radius * (1e6 * alpha_eta(warm) / eta(warm) * reduced) ** 0.6
    film *= (eta(warm) * sum(speeds) / (2000 * reduced * radius)) ** 0.7 * (2 * pi * pressed**2 / reduced**2) ** -0.13
    cooler = flash * (1.11 / sqrt(4 / pi)) * sqrt(45 * 440 * 7800) / sqrt(50 * 3.8e6)
    printed, own = (film / 0.5 * (alpha_eta(warm + heat) / alpha_eta(warm)) ** 0.22 for heat in (flash, cooler))
    assert float(found["film_ratio"]) == pytest.approx(own, rel=1e-2)  # its friction takes F_t/cos(alpha)
    assert float(found["film_ratio"]) == pytest.approx(printed, rel=0.06)
    if (grade, stage) == (100, 10):
        Page("rv_gearing").says(
            f"{float(found['film_ratio']):.3f}, and written again with the report's own steel {printed:.3f}"
        )


def test_a_film_without_load_or_with_a_load_the_other_way_is_finite() -> None:
    both = [rated(load_torque=f"{torque} N*m") for torque in (-500, 500)]
    assert float(both[0]["film_bulk_rise"]) == float(both[1]["film_bulk_rise"]) > 0
    assert np.isfinite(float(rated(load_torque="0 N*m")["film_ratio"]))


def test_the_integral_temperature_is_that_of_the_printed_factors() -> None:
    """ISO/TR 13989-2, equations 13 to 24, in mm: X_M 50, X_alpha,beta and X_BE, and the mean by the contact ratios."""
    found = rated(group=5, flank_roughness_sun="3 um", flank_roughness_planet="3 um", planets=1)
    module, z, angle = 1.25, (23, 63), np.radians(20)
    tip = [module * (each + 2) for each in z]
    base, a, u = [module * each * cos(angle) for each in z], module * sum(z) / 2, z[1] / z[0]
    end = sqrt(tip[0] ** 2 - base[0] ** 2) / 2
    other = a * np.sin(angle) - end
    shape = 0.51 * sqrt(u + 1) * (sqrt(end) - sqrt(other / u)) / (end * other) ** 0.25
    sloped = 1.22 * np.sin(angle) ** 0.25 * cos(angle) ** 0.25 / sqrt(cos(angle)) / sqrt(cos(angle))
    assert sloped == pytest.approx(0.978, abs=5e-4)  # table 2
    flash = float(found["flank_friction"]) * 50 * shape * sloped * float(found["flank_load"]) ** 0.75
    flash *= sqrt(float(found["pitch_line_velocity"])) / a**0.25
    assert float(found["tip_flash"]) == pytest.approx(flash, rel=0.03)
    one, two = (each / 2 / pi * (sqrt((top / own) ** 2 - 1) - tan(angle)) for each, top, own in
                zip(z, tip, base, strict=True))  # fmt: skip
    mean = 0.7 * (one**2 + two**2) - 0.22 * (one + two) + 0.52 - 0.6 * one * two
    mean /= 2 * (one + two) * one
    assert max(one, two) < 1
    assert two < 1.5 * one
    assert float(found["integral_rise"]) == pytest.approx((0.7 + 1.5) * flash * mean, rel=0.03)


def test_the_viscosity_of_the_film_gets_its_slope_from_two_points_of_an_oil() -> None:
    """An oil VG 100 of viscosity index 95 has 11.1 mm2/s at 100 degC."""
    oil = Oil(at_forty=100.0, density=892.0)
    assert float(oil.viscosity(373.15)) == pytest.approx(11.1e-6 * (892 - 0.7 * 84.15), rel=0.01)
    assert log10(float(oil.pressure_coefficient(313.15))) == pytest.approx(-7.7, abs=0.05)  # 2e-8 1/Pa, mineral oil


@pytest.mark.parametrize(("ratio", "sensitivity"), [(0.0, 0.4), (-1.0, 0.4), (-1.2, 0.3), (-0.5, 0.53), (-1.0, 1.0)])
def test_reversed_bending_lowers_what_a_root_bears_to_the_same_line_of_haigh(ratio: float, sensitivity: float) -> None:
    """Amplitude and mean stress at the limit lie on one straight line with those of the pulsating limit."""
    pulsating, both = (rated(stress_ratio_sun=each, mean_stress_sensitivity=sensitivity) for each in (0.0, ratio))
    limit, lasts = float(pulsating["permitted_root_stress_sun"]), float(both["permitted_root_stress_sun"])
    amplitude, mean = lasts * (1 - ratio) / 2, lasts * (1 + ratio) / 2
    assert amplitude + sensitivity * mean == pytest.approx(limit / 2 * (1 + sensitivity), rel=1e-12)
    assert float(both["permitted_root_stress_planet"]) == float(pulsating["permitted_root_stress_planet"])
    if (ratio, sensitivity) == (-1.0, 0.4):
        assert lasts / limit == pytest.approx(0.7, rel=1e-12)  # ISO 6336-5: 0.7 of the limit where the load reverses


@pytest.mark.parametrize("stage", [6, 8, 10, 12])
def test_the_gears_of_the_lubricant_test_run_at_their_own_limit(stage: int) -> None:
    """What a lubricant bears is named by the load stage at which the gears of the FZG test A/8.3/90 scuff.

    So these very gears at that stage must be about as hot as (23) permits: 16/24 teeth of 4.5 mm at 91.5 mm, 20 mm
    wide, 3.726 S² N m (372.6 at stage 10, 534.5 at 12), 2170 r/min, oil at 90 degC, load factors 1 (ISO 14635-1; main
    data as Hoehn, Oster, Tobie and Michaelis print them, goriva i maziva 47 (2008), whose tips are 0.05 mm larger). The
    oil of the test gets warmer than it began, the more the higher the stage, so the calculated rises above 90 degC come
    out lower there.
    """
    alone = dict.fromkeys(
        ("application_factor", "planet_load_factor", "stated_dynamic_factor", "stated_face_factor"), 1.0
    )
    found = rated(
        sun_teeth=16, planet_teeth=24, module="4.5 mm", shift_sun=0.8532, shift_planet=-0.5, face_width="20 mm",
        planets=1, stated_sun_torque=f"{3.726 * stage**2} N*m", stated_mesh_speed="2170 rpm", scuffing_stage=stage,
        oil_temperature="90 degC", flank_roughness_sun="2.1 um", flank_roughness_planet="2.1 um",
        stated_transverse_factor=1.0, **alone,
    )  # fmt: skip
    assert float(found["centre_distance"]) == pytest.approx(91.5, abs=0.01)
    assert float(found["pitch_line_velocity"]) * 73.2 / 72 == pytest.approx(8.3, rel=3e-3)  # at the rolling circle
    for reached, bears in (("contact_rise", "scuffing_rise"), ("integral_rise", "scuffing_integral_rise")):
        assert float(found[reached]) == pytest.approx(float(found[bears]), rel=0.17)
    if stage == 10:
        Page("rv_gearing").says(
            f"{float(found['contact_rise']):.0f} K of {float(found['scuffing_rise']):.0f} K by the flash method, "
            f"{float(found['integral_rise']):.0f} K of {float(found['scuffing_integral_rise']):.0f} K by the integral",
            f"{100 * (0.06 * float(found['normal_curvature']) ** 0.25 / 0.099 - 1):.0f} % more on the test gears",
        )
    if stage in (6, 12):
        Page("rv_gearing").says(
            {6: "{:.2f} to 0.87 and {:.2f} to 0.84", 12: "1.05 to {:.2f} and 1.01 to {:.2f}"}[stage].format(
                float(found["contact_rise"]) / float(found["scuffing_rise"]),
                float(found["integral_rise"]) / float(found["scuffing_integral_rise"]),
            )
        )
