"""What the shipped calculations refuse, by name, file and line: numbers beyond their range, what cannot be built."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from truing import Kernel

Refused = Callable[..., list[str]]


BOUNDS: dict[str, dict[str, str]] = {
    "harmonic_fractal": {
        "above 0": "sampling longest_lag youngs_modulus_flexspline youngs_modulus_circular hardness pair_load "
        "face_width flank_height patch_length pitch_radius cup_radius cup_wall reference_torque tooth_stiffness "
        "engaged_factor modulus_factor",
        "above 1": "density",
        "above 2": "fractal_dimension mating_dimension",
        "at least 0": "poisson_ratio_circular cup_length drive_compliance",
        "at least 1": "engaged_pairs",
        "at least 20": "flexspline_teeth",
        "below 0.5": "poisson_ratio_flexspline",
        "below 3": "fractal_dimension",
        "below 60": "pressure_angle",
        "areal or one_direction or profile": "convention",
        "hardness or yield_onset": "critical_rule",
        "fixed or scaled": "tip_rule",
        "amplitude or interference or patch": "clearance_rule",
        "14 or 17 or 20 or 25 or 32 or 40 or 50 or 58": "catalogue_size",
    },
    "harmonic_fractal.made_flank": {
        "at least 0": "seed",
        "at least 1": "directions",
        "at most 50": "spikes",
        "areal or brownian or profile": "kind",
    },
    "harmonic_fractal.run_up": {
        "above 0": "ring_inertia damping_ratio torque hardness",
        "at least 0": "error_amplitude torque_wave form_clearance oil_damping",
        "below 1": "damping_ratio stiffness_variation",
        "closing or printed or none": "roughness_clearance",
    },
    "harmonic_fractal.vibration": {
        "above 0": "stated_stiffness mesh_order torque",
        "at least 0": "speed",
        "at most 10000": "mesh_order",
        "at most 100000": "speed",
    },
    "press_linkage.motion": {
        "above 0": "speed speed_share permitted_torque crank_radius",
        "at least 0": "slider_mass counterbalance guide_friction bearing_friction mass_rod inertia_upper_knee",
        "at most 3": "centre_lower_knee",
    },
    "press_linkage.loaded": {
        "above 0": "joint_stiffness section_rod column_half_distance rated_force permitted_slope",
        "at least 0": "joint_play guide_clearance platform_guide_span",
        "at most 10": "platform_guide_span guide_above",
    },
    "roller_screw_shift": {
        "above 0": "module face_width centre_distance screw_diameter roller_diameter rim_factor "
        "most_sliding_difference",
        "above 10": "pressure_angle",
        "at least 0": "clearance",
        "at least 1": "least_contact_ratio rollers",
        "at least 8": "roller_teeth",
        "at least 16": "ring_teeth",
        "at most 1": "carrying_share",
        "at most 3": "roller_shift",
        "below 30": "pressure_angle",
        "a whole number": "roller_teeth",
        "own_ranges or printed_ranges or printed": "weights",
    },
    "rv_gearing": {
        "above 0": "power output_speed module face_width ratio_tolerance involute_efficiency bearing_efficiency "
        "addendum stated_dynamic_factor stated_form_factor_planet viscosity",
        "above 1": "target_ratio",
        "above 10": "pressure_angle",
        "at least 0": "fillet",
        "at least 1": "planets group planet_load_factor",
        "at least 6": "fewest_sun_teeth sun_teeth",
        "at most 0.2": "ratio_tolerance",
        "at most 1": "cycloid_efficiency bearing_efficiency",
        "at most 12": "accuracy_grade",
        "below 0.5": "poisson_ratio_sun",
        "below 45": "helix_angle",
        "a whole number": "sun_teeth",
        "case_hardened or through_hardened or nitrided": "material",
        "whole or one_pin_circle": "window",
        "iso or gb_1997": "helix_reading",
    },
    "rv_wear": {
        "above 0": "pin_circle_radius pin_radius eccentricity disc_width young_modulus output_torque output_speed "
        "composite_roughness reconstruction_depth pressure_viscosity permitted_backlash sun_radius centre_distance "
        "required_reliability",
        "at least -1000": "equidistant_modification",  # a wear of a millimetre is micrometres written as millimetres
        "at least 0": "poisson_ratio working_time",
        "at least 4": "pin_count phases",
        "at most 1": "required_reliability torque_share",
        "at most 1000": "extra_wear disc_runout",
        "below 0.5": "poisson_ratio",
        "below 1000": "composite_roughness pin_radius",
        "power or exponential or process": "cost_form",
        "linear or hertz": "load_sharing",
    },
}
"""Inputs by what they must be, in their own units, or by the words that they offer."""


def said_of(field: Any) -> set[str]:
    """Return what is said that an input must be."""
    spec = field.spec
    bounds = {"above": spec.above, "below": spec.below, "at least": spec.at_least, "at most": spec.at_most}
    said = {f"{words} {bound:g}" for words, bound in bounds.items() if bound is not None}
    return said | {"a whole number"} if spec.whole else said | {" or ".join(field.choices)}


@pytest.mark.parametrize("plugin", BOUNDS)
def test_an_input_has_its_bounds(plugin: str) -> None:
    """That a value beyond each is refused by name is a check of the kit, which every model passes."""
    fields: Any = Kernel.installed().offers[plugin].model.input_fields
    for bound, names in BOUNDS[plugin].items():
        assert [name for name in names.split() if bound not in said_of(fields[name])] == []


AREAL = 'convention = "areal"'
ROUGH = 'mating_roughness = "1e-11 m"'
CONVENTIONS = "means nothing without convention; state convention (areal, one_direction, profile) beside it"
IMPOSSIBLE: dict[str, list[tuple[list[str], int, str]]] = {
    "harmonic_fractal": [
        (["stiffness = 1e9"], 3, "'stiffness' is a result; it is calculated, not stated"),
        (['lags = "0 um"'], 3, 'lags is a series; write lags = ["1 um", ...]'),
        (["surface = 3"], 3, 'surface is read from a data file; write surface = { file = "data.txt" }'),
        (['fractal_roughness = "1e-11 m"'], 3, f"fractal_roughness {CONVENTIONS}"),
        (["mating_dimension = 2.4", ROUGH], 4, f"mating_roughness {CONVENTIONS}"),
        ([AREAL, 'fractal_roughness = "0 m"'], 4, "fractal_roughness is 0 m; it must be above 0 m"),
        ([AREAL, 'fractal_roughness = "-1e-11 m"'], 4, "fractal_roughness is -1e-11 m; it must be above 0 m"),
        ([AREAL, 'fractal_roughness = "1 m"'], 4, "fractal_roughness is 1 m; it must be at most 0.001 m"),
        (["fractal_dimension = 2.04"], 3, "the fractal dimension of both flanks together is below 2.05, where the "
         "critical area, a power of 2/(D - 2), loses all meaning: enlarge fractal_dimension"),
        (["fractal_dimension = 2.96"], 3, "the fractal dimension of both flanks together is above 2.95, where the "
         "contact area, a multiple of 1/(3 - D), loses all meaning: reduce fractal_dimension"),
        (["dimension_deviation = 0.56"], 3, "the fractal dimension of both flanks together is above 2.95"),
        (["dimension_deviation = -0.36"], 3, "the fractal dimension of both flanks together is below 2.05"),
        (["mating_dimension = 2.4"], 3, "the mating flank is half stated: state mating_dimension"),
        ([AREAL, ROUGH], 4, "the mating flank is half stated: state mating_dimension"),
        (["engaged_pairs = 201"], 3, "more pairs are engaged than the flexspline has teeth: reduce engaged_pairs"),
        (["engaged_factor = 3.4"], 3, "more pairs are engaged than the flexspline has teeth"),
        (["engaged_gain = 5"], 3, "more pairs are engaged than the flexspline has teeth"),
        # the sum of both flanks needs lags between two limits
        (['sampling = "20 um"', "mating_dimension = 2.4", ROUGH, AREAL], 3, "two flanks are added over the lags that "
         "both have, and these have none: enlarge longest_lag beyond sampling"),
        # 10 mm by 0.4 mm carry 4e-6 m2 times 3 GPa = 12 kN at most, and the rough contact much less than that
        (['pair_load = "10 kN"'], 3, "the contact area exceeds the flank: reduce pair_load"),
        (['torque = "-10 kN*m"'], 3, "the contact area exceeds the flank: reduce torque"),
    ],
    "harmonic_fractal.made_flank": [
        (["fractal_dimension = 2.01"], 3, "a fractal dimension below 2.05 or above 2.95: exponents diverge"),
        (['length = "20 um"'], 3, "a line has fewer than 64 points: make length larger or spacing smaller"),
        (['length = "10 mm"', 'width = "10 mm"'], 4, "the flank has more than 4000000 points"),
        (['longest_wave = "1 nm"'], 3, "the shortest wave is not shorter than the longest one"),
        (['fractal_roughness = "1e-9 m"'], 3, f"fractal_roughness {CONVENTIONS}"),
    ],
    "harmonic_fractal.run_up": [
        (['speeds = ["2000 rpm", "2000 rpm"]'], 3, "the speeds of a run are above 0 and rise from one to the next"),
        (["fractal_dimension = 2.04"], 3, "the fractal dimension of both flanks together is below 2.05"),
        ([AREAL, "fractal_dimension = 2.5", 'fractal_roughness = "1e-9 m"', 'reference_torque = "1 mN*m"'], 6,
         "at reference_torque all contacts are plastic, so the approach that counts from there is infinite: raise"),
        ([AREAL, 'fractal_roughness = "1e-5 m"', 'roughness_clearance = "none"'], 4, "all contacts are plastic at this "
         "torque, and the mesh has no stiffness: raise torque"),
    ],
    "harmonic_fractal.vibration": [
        (['times = ["0 s", "1 ms", "1 ms"]'], 3, "times: the times of a record rise; two are equal or fall"),
        (['times = ["0 s"]'], 3, "times: a motion needs two times or more"),
        (['fractal_roughness = "1e-9 m"'], 3, f"fractal_roughness {CONVENTIONS}"),
    ],
    "press_linkage": [
        (['crank_radius = "0.36 m"', 'lower_knee_length = "0.5 m"'], 4, "loop III, side 1 does not close: the lower "
         "link cannot reach the slider, it needs |l - y_G| < l_h"),
        (['rod_length = "0.5 m"'], 3, "loop I has no bottom dead centre: crank and rod in line do not reach the "
         "platform; it needs crank_pivot_radius - platform_half_width < crank_radius + rod_length"),
    ],
    "press_linkage.motion": [
        (['times = { values = [0, 1, 1], unit = "s" }'], 3, "times: two or more, each later than the one before"),
        (['times = ["0 s"]'], 3, "times: two or more, each later than the one before"),
        (['crank_speed = ["10 rpm", "12 rpm"]'], 3, "crank_speed has 2 values at 121 times; it needs one at each"),
        (['forming_force = ["1 kN"]'], 3, "forming_force has 1 values at 121 times; it needs one at each"),
        (['crank_speed = []'], 3, "crank_speed is a series; write crank_speed = "),
        (['speed_share = { values = [100, 0], unit = "%" }'], 3, "speed_share is 0"),
        (['speed_angle = { values = [0, 400], unit = "deg" }', 'speed_share = { values = [100, 50], unit = "%" }'], 3,
         "speed_angle: angles rise within one turn"),
        (['force_angle = { values = [0, 10], unit = "deg" }'], 3, "force has 4 values at 2 of force_angle"),
        (['bearing_friction = "150 mm"'], 3, "the press locks: its pins rub more than the drive can overcome"),
        (['lower_knee_length = "0.5 m"'], 3, "loop III, side 1 does not close"),
    ],
    "press_linkage.loaded": [
        (['acceptance_angle = { values = [0], unit = "deg" }'], 3, "acceptance_angle: two crank angles or more"),
        (['forming_force = ["1 kN"]'], 3, "forming_force has 1 values at 25 times; it needs one at each"),
    ],
    "roller_screw_shift": [
        (["roller_teeth = 20", "ring_teeth = 27"], 4, "the formulas hold for ring_teeth at least 8 above roller_teeth"),
        # a cos(alpha) = 20 cos(20 deg) = 18.794 mm must be less than the centre distance
        (['centre_distance = "18.79 mm"'], 3, "the base circles are farther apart than the centres: centre_distance"),
        (["centre_distance = '18.8 mm'", "centre_distance_deviation = '-10 um'"], 4,
         "the base circles are farther apart than the centres as mounted: centre_distance + centre_distance_deviation"),
        # 10 + 0.8 - 1.5 = 9.3 modules, below 10 cos(20 deg) = 9.397
        (["roller_shift = -1.5"], 3, "the tip circle of the roller lies inside its base circle"),
        # the ring: (50 - 2 - 0.58) below 50 cos(20 deg) = 46.98 needs a shift below -1.02
        (["addendum = 2", "roller_shift = -0.7"], 4, "the tip circle of the ring lies inside its base circle"),
        (["roller_shift = -0.5"], 3, "involute interference: the tip of the ring would meet the roller"),
        # the default set with full-depth teeth: at 0.1 the tip of the ring already meets no involute
        (["addendum = 1.0", "roller_shift = -0.1"], 4, "involute interference: the tip of the ring would meet"),
        # the flanks of the rack meet above such a fillet: no root chord, or none of positive length
        (["roller_fillet = 1.0"], 3, "the rack of the roller is pointed before it is round: reduce roller_fillet"),
        (["clearance = 1.0", "addendum = 1.2", "roller_shift = 0.6"], 4, "the rack of the roller is pointed"),
        (["ring_fillet = 1.0"], 3, "the rack of the ring is pointed before it is round: reduce ring_fillet"),
        (["ring_fillet = 0"], 3, "the root of the ring has no radius: ring_fillet must be greater than 0"),
        # no arm: the force at the tip of the ring meets the axis below the section
        (["addendum = 0.1", "clearance = 0.0", "roller_shift = 0"], 4, "the load at the tip of the roller has no arm "
         "about its root: enlarge addendum or clearance"),
    ],
    "rv_gearing": [
        # the set of pin numbers: odd, empty
        (["fewest_pins = 39", "most_pins = 41"], 3, "fewest_pins = 39 is odd: two discs half a turn apart need"),
        (["most_pins = 41"], 3, "most_pins = 41 is odd"),
        (["fewest_pins = 42"], 3, "fewest_pins = 42 exceeds most_pins = 40"),
        (["sun_teeth = 20", "planet_teeth = 55", "pin_teeth = 39"], 5, "pin_teeth is odd"),
        # ranges that are reversed
        (['pin_circle_low = "1.4 mm**(2/3)/N**(1/3)"'], 3, "pin_circle_low exceeds pin_circle_high"),
        (["centre_share_low = 0.7"], 3, "centre_share_low exceeds centre_share_high"),
        # one number of teeth alone, a group that is not there
        (["sun_teeth = 20"], 3, "sun_teeth and planet_teeth are stated together, or neither of them"),
        (["planet_teeth = 55"], 3, "sun_teeth and planet_teeth are stated together, or neither of them"),
        (["pin_teeth = 40"], 3, "pin_teeth is stated without sun_teeth and planet_teeth: state all three"),
        (["group = 26"], 3, "group = 26, but the search finds 25 groups"),
        (["target_ratio = 3000"], 3, "group = 1, but the search finds no group: state sun_teeth and planet_teeth"),
        # contact ratio of 20/55 at 20 deg: 1.664 with h_a* = 1; below 1 at 0.55
        (["addendum = 0.5"], 3, "the contact ratio is below 1: raise the teeth or addendum"),
        # tip circle 20 + 2 (0.8 - 1.45) = 18.7 modules, base circle 20 cos(20 deg) = 18.79
        (["addendum = 0.8", "shift_sun = -1.45"], 4, "the tip of the sun lies below its base circle"),
        (["dedendum = 11"], 3, "nothing is left below the teeth of the sun"),
        (["shift_sun = 1.4"], 3, "the teeth of the sun are pointed: lower shift_sun or addendum"),
        # tan of the angle at the tip, 1.007, is less than one tooth, 2 pi/6: negative under the root of Z_B
        (["sun_teeth = 6", "planet_teeth = 30"], 4, "the single contact of the sun would lie below the base circle"),
        (["shift_sun = -1.5", "shift_planet = -1.5"], 4, "no pair of gears has such shifts: shift_sun + shift_planet"),
    ],
    "rv_wear": [
        (["pin_count = 40.5"], 3, "pin_count = 40.5 is no whole number; write pin_count = 3"),
        # K_1 = e z_p / r_p: 2.9 * 40 / 114.5 = 1.013
        (['eccentricity = "2.9 mm"'], 3, "the short-width coefficient must lie between 0 and 1: reduce eccentricity or "
         "pin_count, or enlarge pin_circle_radius, until eccentricity * pin_count < pin_circle_radius"),
        (['pin_circle_radius = "88 mm"'], 3, "the short-width coefficient must lie between 0 and 1"),
        # r_p sin(pi / z_p) = 8.983 mm; the smallest convex radius is 9.05 mm, so pins overlap first
        (['pin_radius = "8.99 mm"'], 3, "neighbouring pins overlap: reduce pin_radius or pin_count"),
        (['pin_radius = "9.06 mm"'], 3, "the pins undercut the disc: pin_radius must be smaller than the smallest "
         "radius of the convex flank; reduce pin_radius"),
        # the radial clearance is the equidistant modification less the shift
        (['shift_modification = "-25.9 um"'], 3, "the radial clearance is negative: equidistant_modification must not "
         "be smaller than shift_modification"),
        # the upper bound is 11.104 um at a radial clearance of 4 um
        (['equidistant_modification = "11.2 um"', 'shift_modification = "7.2 um"'], 4, "disc and pins interfere: "
         "equidistant_modification lies above its upper limit at this radial clearance; reduce equidistant_modificat"),
    ],
}  # fmt: skip


@pytest.mark.parametrize(
    ("plugin", "lines", "blamed", "words"),
    [(plugin, *case) for plugin, cases in IMPOSSIBLE.items() for case in cases],
)
def test_what_cannot_be_built_is_refused(
    refused_inputs: Refused, plugin: str, lines: list[str], blamed: int, words: str
) -> None:
    (said,) = refused_inputs(plugin, *lines)
    assert said.startswith(f"inputs.toml:{blamed}: {words}")
