"""Every factor of the first stage against the standards written out a second time, and how the factors behave."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import rv_gearing_by_hand as by_hand

from rv_gearing.load_factors import by_range
from rv_gearing.material import CURVES
from rv_gearing.model import RV_GEARING
from rv_gearing.rating import rv_gearing
from truing.errors import InfeasibleError
from truing.setup import default_setup
from truing.testing.declared import formulas_equal_the_function, formulas_have_the_unit
from truing.testing.subject import Subject
from truing.units import from_si

TEETH = {"sun_teeth": 20.0, "planet_teeth": 55.0}


def results(**stated: Any) -> dict[str, Any]:
    """All results by name, SI."""
    with np.errstate(all="ignore"):
        found = RV_GEARING.read_results(rv_gearing(RV_GEARING.inputs(**stated)))
    return {name: value if np.ndim(value) else float(value) for name, value in found.items()}


def in_units(found: dict[str, Any], name: str) -> Any:
    return from_si(found[name], RV_GEARING.own_result_fields[name].unit)


# The standards by hand, plain floats, for random pairs


def random_case(seed: int) -> by_hand.Case:
    """A pair of gears somewhere in the range of the standards; the faces and helices give overlaps from 0 to 3."""
    rng = np.random.default_rng(seed)
    sun = int(rng.integers(18, 40))
    m = float(rng.choice([1.0, 1.25, 4.0, 8.0, 20.0]))
    ha, hf = rng.uniform(0.95, 1.05), rng.uniform(1.2, 1.35)
    return {
        "m": m, "z": (sun, int(sun * rng.uniform(1.2, 5.0))), "x": tuple(rng.uniform(-0.1, 0.4, 2)),
        "beta": float(rng.choice([0.0, rng.uniform(2.0, 32.0)])), "alpha": rng.uniform(18.0, 22.0), "ha": ha, "hf": hf,
        "rho_f": rng.uniform(0.2, 0.33), "b": m * rng.uniform(5.0, 30.0), "apart": float(rng.choice([0.0, 0.004 * m])),
        "np": int(rng.integers(1, 4)), "T1": m**3 * 10.0 ** rng.uniform(-0.5, 1.7), "KA": rng.uniform(1.0, 2.0),
        "n_rel": 10.0 ** rng.uniform(1.0, 2.5) * 100.0 / m, "KHp": rng.uniform(1.0, 1.3),
        "Lh": 10.0 ** rng.uniform(-2, 5),
        "Q": int(rng.integers(3, 10)), "Ca": rng.uniform(0.0, 30.0), "form": str(rng.choice(list(by_hand.WEIGHTS))),
        "material": str(rng.choice(list(CURVES))), "rho": rng.uniform(7000.0, 8000.0),
        "q": tuple(rng.uniform(0, 0.7, 2)),
        "E": tuple(rng.uniform(150e3, 210e3, 2)), "nu": tuple(rng.uniform(0.25, 0.33, 2)),
        "sH": tuple(rng.uniform(500.0, 1600.0, 2)), "sF": tuple(rng.uniform(200.0, 500.0, 2)),
        "Rz": tuple(rng.uniform(1.0, 10.0, 2)), "RzF": tuple(rng.uniform(0.5, 20.0, 2)),
        "nu40": rng.uniform(20.0, 500.0),
        "SH": rng.uniform(1.0, 1.4), "SF": rng.uniform(1.2, 2.0),
    }  # fmt: skip


def stated(c: by_hand.Case) -> dict[str, Any]:
    """The same pair as inputs of the calculation."""
    pairs: dict[str, tuple[Any, str]] = {
        "shift": (c["x"], ""), "bore_ratio": (c["q"], ""), "contact_limit": (c["sH"], "MPa"),
        "bending_limit": (c["sF"], "MPa"), "young_modulus": (c["E"], "MPa"), "poisson_ratio": (c["nu"], ""),
        "flank_roughness": (c["Rz"], "um"), "root_roughness": (c["RzF"], "um"),
    }  # fmt: skip
    of_gears = {
        f"{key}_{name}": f"{value!r} {unit}".strip()
        for key, (values, unit) in pairs.items()
        for name, value in zip(("sun", "planet"), map(float, values), strict=True)
    }
    return of_gears | {
        "module": f"{c['m']} mm", "sun_teeth": float(c["z"][0]), "planet_teeth": float(c["z"][1]), "pin_teeth": 40.0,
        "helix_angle": f"{c['beta']!r} deg", "pressure_angle": f"{c['alpha']!r} deg", "addendum": c["ha"],
        "dedendum": c["hf"], "fillet": c["rho_f"], "face_width": f"{c['b']!r} mm",
        "centre_distance_deviation": f"{c['apart']!r} mm", "planets": c["np"],
        "stated_sun_torque": f"{c['T1']!r} N*m", "application_factor": c["KA"], "planet_load_factor": c["KHp"],
        "stated_mesh_speed": f"{c['n_rel']!r} rpm", "working_life": f"{c['Lh']!r} h", "accuracy_grade": c["Q"],
        "tip_relief": f"{c['Ca']!r} um", "flank_form": c["form"], "material": c["material"],
        "density": f"{c['rho']!r} kg/m**3", "viscosity": f"{c['nu40']!r} mm**2/s", "least_contact_safety": c["SH"],
        "least_bending_safety": c["SF"],
    }  # fmt: skip


@pytest.mark.parametrize("seed", range(40))
def test_every_factor_is_that_of_the_standards_written_out_by_hand(seed: int) -> None:
    case = random_case(seed)
    found, expected = results(**stated(case)), by_hand.rate(case)
    for name, value in expected.items():
        assert float(in_units(found, name)) == pytest.approx(value, rel=1e-9, abs=1e-15), name


def test_the_random_pairs_reach_every_branch() -> None:
    """Otherwise the comparison above would be silent about some."""
    cases = [random_case(seed) for seed in range(40)]
    all_found = [by_hand.rate(case) for case in cases]
    ratios = np.array([found["resonance_ratio"] for found in all_found])
    limits = np.array([found["resonance_limit"] for found in all_found])
    overlaps = np.array([found["overlap_ratio"] for found in all_found])
    totals = overlaps + np.array([found["contact_ratio"] for found in all_found])
    loads = np.array([found["line_load"] for found in all_found])
    for truths in (
        ratios < limits, (ratios > limits) & (ratios < 1.15), ratios > 1.5, overlaps == 0.0,
        (overlaps > 0.0) & (overlaps < 1.0), overlaps > 1.0, totals < 2.0, totals > 2.5, loads < 100.0, loads > 100.0,
        np.array([found["face_factor"] > 2.0 for found in all_found]),
        np.array([found["transverse_factor"] == 1.0 for found in all_found]),
        np.array([found["transverse_factor"] > 1.0 for found in all_found]),
        np.array([found["single_contact_factor_sun"] > 1.0 for found in all_found]),
        np.array([found["contact_life_factor_sun"] > 1.0 for found in all_found]),
        np.array([case["Q"] < 6 and case["Ca"] > 0.0 for case in cases]),
    ):  # fmt: skip
        assert truths.any()
    assert {case["material"] for case in cases} == set(CURVES)
    assert {case["form"] for case in cases} == set(by_hand.WEIGHTS)


@pytest.mark.parametrize("seed", range(100, 110))
def test_every_printed_formula_is_what_is_calculated_in_every_branch(seed: int) -> None:
    """The kit compares them near the defaults, a spur pair; here far from them, with factors stated and effects on."""
    rng = np.random.default_rng(seed)
    known: dict[str, Any] = {name: item[0] for name, item in STATED.items() if rng.random() < 0.3}
    known |= {"extra_misalignment": rng.uniform(-5e-6, 20e-6), "sharing_error": rng.uniform(-1e-6, 5e-6),
              "relief_deviation": rng.uniform(-1e-6, 5e-6), "carrying_share": rng.uniform(0.3, 1.0),
              "extra_dynamic_factor": rng.uniform(0.0, 0.5), "single_contact": bool(rng.random() < 0.7)}  # fmt: skip
    check_formulas(**stated(random_case(seed)) | known)


def check_formulas(**inputs: Any) -> None:
    """The checks of the kit with these inputs in place of the defaults."""
    subject = Subject(RV_GEARING)
    subject.__dict__["setup"] = replace(default_setup(RV_GEARING), inputs=RV_GEARING.inputs(**inputs))
    formulas_have_the_unit(subject)
    formulas_equal_the_function(subject)


@pytest.mark.parametrize("torque", [0.0, 1e-12, 1e-3])
def test_printed_formulas_hold_without_load(torque: float) -> None:
    check_formulas(**TEETH, stated_sun_torque=torque)


# The dynamic factor over its ranges, ISO 6336-1:2006, 6.5


def test_dynamic_factor_is_continuous_from_the_resonance_on() -> None:
    factors = (0.9, 2.4, 1.7)
    for edge in (1.15, 1.5):
        sides = [float(by_range(edge + step, 0.85, factors)) for step in (-1e-9, 0.0, 1e-9)]
        assert sides == pytest.approx([sides[1]] * 3, abs=1e-7)
    ratios = np.linspace(1.15, 1.5, 8)
    assert by_range(ratios, 0.85, factors) == pytest.approx(np.interp(ratios, [1.15, 1.5], [2.4, 1.7]))


# Life and material


HARD: dict[str, Any] = {"material": "through_hardened"}
ROUGH: dict[str, Any] = {
    **HARD, "accuracy_grade": 12, "flank_form": "none", "contact_limit_sun": 500e6, "contact_limit_planet": 500e6,
}  # fmt: skip
PRINTED: list[tuple[str, float, dict[str, Any]]] = [
    # ISO 6336-3:2006, table of the slip layer, mm by proof stress
    *(("slip_layer", layer, HARD | {"proof_stress": stress * 1e6}) for stress, layer in
      {400: 0.0281, 500: 0.0281, 550: 0.02375, 600: 0.0194, 800: 0.0064, 1000: 0.0014}.items()),
    # clause 15: size factors by module, mm
    *(("bending_size_sun", factor, {"material": material, "module": m * 1e-3, "face_width": m * 10e-3})
      for material, m, factor in (
          ("case_hardened", 5, 1.0), ("case_hardened", 15, 0.9), ("case_hardened", 40, 0.8), ("nitrided", 25, 0.8),
          ("through_hardened", 4, 1.0), ("through_hardened", 20, 0.91), ("through_hardened", 35, 0.85),
      )),
    # ISO 6336-1:2006, clause 7: 25600/sigma_Hlim above 5 m/s and half above 10 m/s
    *(("face_running_in", taken, ROUGH | {"stated_mesh_speed": velocity / (np.pi * 0.025)})
      for velocity, taken in ((5.1, 51.2), (9.9, 51.2), (10.1, 25.6))),
    # the older reading of the helix factor, GB/T 3480-1997
    ("helix_factor", np.sqrt(np.cos(0.2)), {"helix_angle": 0.2, "helix_reading": "gb_1997"}),
    # the paper leaves Z_B out, whatever its radicand
    ("single_contact_factor_sun", 1.0, {"sun_teeth": 6.0, "planet_teeth": 12.0, "single_contact": False}),
]  # fmt: skip


@pytest.mark.parametrize(("name", "value", "stated"), PRINTED)
def test_a_factor_is_that_of_its_table(name: str, value: float, stated: dict[str, Any]) -> None:
    assert in_units(results(**TEETH | stated), name) == pytest.approx(value)


@pytest.mark.parametrize(
    ("material", "contact", "bending"),
    [  # cycles and life factor at the corners of ISO 6336-2:2006, table 2, and ISO 6336-3:2006, table 1
        ("case_hardened", {1e4: 1.6, 1e5: 1.6, 5e7: 1.0, 1e10: 0.85}, {1e3: 2.5, 3e6: 1.0, 1e10: 0.85}),
        ("through_hardened", {1e5: 1.6, 5e7: 1.0, 1e10: 0.85}, {1e4: 2.5, 3e6: 1.0, 1e10: 0.85}),
        ("nitrided", {1e5: 1.3, 2e6: 1.0, 1e10: 0.85}, {1e3: 1.6, 3e6: 1.0, 1e10: 0.85}),
    ],
)
def test_life_factors_pass_through_the_corners_of_the_tables(
    material: str, contact: dict[float, float], bending: dict[float, float]
) -> None:
    for name, corners in (("contact", contact), ("bending", bending)):
        life = np.array(list(corners)) / (10.0 * 2.0)  # two planets meet a tooth of the sun ten times a second
        found = results(**TEETH, material=material, stated_mesh_speed=10.0, working_life=life)
        factors = found[f"{name}_life_factor_sun"]
        assert factors == pytest.approx(list(corners.values()), rel=6e-3)  # the exponents of GB/T 3480 are rounded


def test_identities_of_strength_factors() -> None:
    """The reference test gears: q_s = 2.5, R_z = 10 um."""
    for material in CURVES:
        found = results(**TEETH, material=material, root_roughness_sun=10e-6)
        assert found["root_surface_sun"] == pytest.approx(1.0, abs=0.015)
        layer, q_s = in_units(found, "slip_layer"), 2.5
        assert (1 + np.sqrt(0.2 * layer * (1 + 2 * q_s))) / (1 + np.sqrt(1.2 * layer)) == 1.0
    shifts = np.linspace(-0.2, 0.6, 4000)  # among the shifts is one whose root has the notch of the test gears
    found = results(sun_teeth=60.0, planet_teeth=90.0, shift_sun=shifts)
    near = np.argmin(np.abs(found["notch_parameter_sun"] - 2.5))
    assert found["notch_parameter_sun"][near] == pytest.approx(2.5, abs=1e-3)
    assert found["notch_sensitivity_sun"][near] == pytest.approx(1.0, abs=1e-5)


@pytest.mark.parametrize(("addendum", "helix"), [(1.0, 0.0), (1.2, 0.35), (1.3, 0.6), (1.4, 0.6)])
def test_deep_teeth_of_accurate_gears(addendum: float, helix: float) -> None:
    """ISO 6336-3:2006, clause 10: 1 up to 2.05, straight down to 0.7 at 2.5; 1 from grade 5 on."""
    deep = {"sun_teeth": 40.0, "planet_teeth": 90.0, "addendum": addendum, "dedendum": addendum + 0.1, "fillet": 0.15}
    found = results(**deep, helix_angle=helix, accuracy_grade=4)
    expected = np.interp(found["virtual_contact_ratio"], [2.05, 2.5], [1.0, 0.7])
    assert found["deep_tooth_factor"] == pytest.approx(expected, abs=2e-3)  # the standard rounds 2.366 and 0.666
    coarse = results(**deep, helix_angle=helix, accuracy_grade=5)
    assert coarse["deep_tooth_factor"] == 1.0
    ratios = [each["nominal_root_stress_outer_sun"] for each in (found, coarse)]
    assert ratios[0] / ratios[1] == pytest.approx(found["deep_tooth_factor"])
    check_formulas(**deep, helix_angle=helix, accuracy_grade=4)


# What is stated instead


STATED = {
    "stated_dynamic_factor": (1.31, "dynamic_factor", "root_stress_sun"),
    "stated_face_factor": (1.32, "face_factor", "contact_stress_planet"),
    "stated_face_factor_bending": (1.33, "face_factor_bending", "root_stress_outer_planet"),
    "stated_transverse_factor": (1.34, "transverse_factor", "contact_stress"),
    "stated_transverse_factor_bending": (1.35, "transverse_factor_bending", "root_stress_planet"),
    "stated_planet_load_bending": (1.36, "planet_factor_bending", "root_stress_sun"),
    "stated_friction": (0.07, "flank_friction", "contact_rise"),
    "stated_crank_load": (8e3, "equivalent_load", "needed_rating"),
    "stated_zone_factor": (2.37, "zone_factor", "contact_stress"),
    "stated_elasticity_factor": (181.4e3, "elasticity_factor", "contact_stress"),
    "stated_contact_ratio_factor": (0.91, "contact_ratio_factor", "contact_stress"),
    "stated_helix_factor": (0.98, "helix_factor", "contact_stress"),
    "stated_lubricant_factor": (0.92, "lubricant_factor", "permitted_contact_stress_sun"),
    "stated_velocity_factor": (0.93, "velocity_factor", "permitted_contact_stress_planet"),
    "stated_roughness_factor": (0.94, "roughness_factor", "contact_safety_sun"),
    "stated_contact_ratio_bending": (0.75, "contact_ratio_factor_bending", "root_stress_sun"),
    "stated_helix_factor_bending": (0.96, "helix_factor_bending", "root_stress_outer_sun"),
    "stated_mesh_stiffness": (20e9, "mesh_stiffness", "face_factor"),
    "stated_sun_torque": (20.0, "sun_torque", "tangential_force"),
    "stated_mesh_speed": (10.0, "mesh_speed", "load_cycles_planet"),
    "stated_form_factor_sun": (2.7, "form_factor_sun", "root_stress_sun"),
    "stated_stress_correction_planet": (1.6, "stress_correction_planet", "root_safety_planet"),
    "stated_contact_life_sun": (1.1, "contact_life_factor_sun", "contact_safety"),
    "stated_bending_life_sun": (0.8, "bending_life_factor_sun", "root_safety_outer_sun"),
    "stated_notch_sensitivity_planet": (0.9, "notch_sensitivity_planet", "permitted_root_stress_planet"),
    "stated_root_surface_sun": (0.9, "root_surface_sun", "root_safety"),
    "stated_bending_size_planet": (0.9, "bending_size_planet", "permitted_root_stress_planet"),
    "stated_single_contact_planet": (1.2, "single_contact_factor_planet", "contact_stress_planet"),
    "stated_single_contact_sun": (1.2, "single_contact_factor_sun", "contact_stress"),
    "input_speed": (20.0, "sun_speed", "pitch_line_velocity"),
    "load_torque": (-900.0, "output_torque", "tangential_force"),
}  # fmt: skip


@pytest.mark.parametrize("name", STATED)
def test_what_is_stated_is_used_and_what_follows_follows(name: str) -> None:
    value, result, follower = STATED[name]
    base, changed = results(**TEETH), results(**TEETH, **{name: value})
    assert changed[result] == pytest.approx(abs(value), rel=1e-12)
    assert abs(changed[follower] / base[follower] - 1.0) > 1e-3
    two = results(**TEETH, **{name: np.array([np.nan, value])})  # some rows of a batch stated, others not
    for each in (result, follower):
        assert two[each] == pytest.approx([base[each], changed[each]], rel=1e-12)


def test_every_optional_factor_is_tried() -> None:
    optional = {
        name for name, item in RV_GEARING.input_fields.items() if item.is_optional and name.startswith("stated_")
    }
    both = {name.removesuffix("_sun").removesuffix("_planet") for name in optional}
    assert both == {name.removesuffix("_sun").removesuffix("_planet") for name in STATED if name.startswith("stated_")}


def test_single_contact_can_be_switched_off() -> None:
    """The paper leaves Z_B and Z_D out."""
    on, off = results(**TEETH), results(**TEETH, single_contact=False)
    assert off["single_contact_factor_sun"] == off["single_contact_factor_planet"] == 1.0
    assert on["contact_stress"] / off["contact_stress"] == pytest.approx(on["single_contact_factor_sun"])


# Batches, limits and directions


def test_nothing_is_loaded_without_torque() -> None:
    found = results(**TEETH, load_torque=np.array([-500.0, -1e-9, 0.0, 1e-9, 500.0]))
    for name, values in found.items():
        assert np.all(np.isfinite(values)), name
    for name in ("root_stress_sun", "root_stress_planet", "contact_stress", "root_stress_outer_sun"):
        assert found[name][2] == 0.0
        assert found[name][0] == found[name][4] > 1e6
        assert found[name][1] < 1e6
    assert list(found["root_safety"][1:4]) == [1000.0] * 3


# What cannot be


REFUSED = [  # beside those of ``end_to_end/test_plugins_refuse.py``
    ({"centre_distance_deviation": 1e-3}, "the contact ratio is below 1"),
    ({"shift_sun": -1.0}, "single contact of the planet"),
    ({"dedendum": 3.0}, "the rack leaves no root"),
    ({"fillet": 0.9}, "the rack leaves no root"),
    ({"shift_sun": 2.0}, "the tips touch the roots"),
    ({"addendum": 1.6}, "the tips touch the roots"),
    ({"stated_dynamic_factor": 0.5, "extra_dynamic_factor": -0.6}, "extra_dynamic_factor"),
]  # fmt: skip


@pytest.mark.parametrize(("changed", "sentence"), REFUSED)
def test_impossible_pairs_are_refused_by_name(changed: dict[str, float], sentence: str) -> None:
    with pytest.raises(InfeasibleError, match=sentence) as refusal:
        results(**TEETH | changed)
    assert any(name in str(refusal.value) for name in RV_GEARING.input_fields) or "teeth" in str(refusal.value)
