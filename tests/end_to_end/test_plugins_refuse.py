"""What the shipped calculations refuse, by name, file and line: numbers beyond their range, what cannot be built."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

import pytest

Refused = Callable[..., list[str]]
Faults = Sequence[tuple[str, str]]
"""Lines under [inputs] with what is said of each; all of them are said at once."""


def positive(units: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """Give inputs that must lie above 0, by their unit, at 0 and below it."""
    for value in ("0", "-1"):
        for name, unit in units.items():
            yield f'{name} = "{value} {unit}"', f"{name} is {value} {unit}; it must be above 0 {unit}"


def beyond(name: str, value: float | str, bound: str) -> tuple[str, str]:
    """Return a number, or a text with its unit, beyond the bound that is said."""
    written = f'"{value}"' if isinstance(value, str) else value
    return f"{name} = {written}", f"{name} is {value}; it must be {bound}"


def not_offered(name: str, *choices: str) -> tuple[str, str]:
    """Return a word that is none of the choices."""
    offered = " or ".join(f"'{choice}'" for choice in choices)
    return f'{name} = "7 of 9"', f"{name} = '7 of 9' is not offered; choose {offered}."


NUMBERS: dict[str, Faults] = {
    "harmonic_fractal": [
        *positive({
            "sampling": "um", "longest_lag": "um", "youngs_modulus_flexspline": "GPa", "youngs_modulus_circular": "GPa",
            "hardness": "GPa", "pair_load": "N", "face_width": "mm", "flank_height": "mm", "patch_length": "mm",
            "pitch_radius": "mm", "reference_torque": "mN*m", "cup_radius": "mm", "cup_wall": "mm",
        }),
        beyond("fractal_dimension", 2, "above 2"),
        beyond("fractal_dimension", 3, "below 3"),
        beyond("mating_dimension", 1.5, "above 2"),
        beyond("density", 1, "above 1"),
        beyond("poisson_ratio_flexspline", 0.5, "below 0.5"),
        beyond("poisson_ratio_circular", -0.1, "at least 0"),
        beyond("engaged_pairs", 0, "at least 1"),
        beyond("flexspline_teeth", 19, "at least 20"),
        beyond("pressure_angle", "60 deg", "below 60 deg"),
        beyond("tooth_stiffness", "0 N/m", "above 0 N/m"),
        beyond("cup_length", "-1 mm", "at least 0 mm"),
        beyond("drive_compliance", "-1 urad/(N*m)", "at least 0 urad/(N*m)"),
        beyond("engaged_factor", 0, "above 0"),
        beyond("modulus_factor", 0, "above 0"),
        not_offered("convention", "areal", "one_direction", "profile"),
        not_offered("critical_rule", "hardness", "yield_onset"),
        not_offered("tip_rule", "fixed", "scaled"),
        not_offered("clearance_rule", "amplitude", "interference", "patch"),
        not_offered("catalogue_size", "14", "17", "20", "25", "32", "40", "50", "58"),
        ("stiffness = 1e9", "'stiffness' is a result; it is calculated, not stated"),
        ('lags = "0 um"', 'lags is a series; write lags = ["1 um", ...]'),
        ("surface = 3", 'surface is read from a data file; write surface = { file = "data.txt" }'),
    ],
    "harmonic_fractal.made_flank": [
        beyond("directions", 0, "at least 1"),
        beyond("seed", -1, "at least 0"),
        beyond("spikes", "60 %", "at most 50 %"),
        not_offered("kind", "areal", "brownian", "profile"),
    ],
    "roller_screw_shift": [
        *positive({"module": "mm", "face_width": "mm", "centre_distance": "mm", "screw_diameter": "mm"}),
        *positive({"roller_diameter": "mm"}),
        beyond("roller_teeth", 7, "at least 8"),
        beyond("ring_teeth", 15, "at least 16"),
        beyond("pressure_angle", "10 deg", "above 10 deg"),
        beyond("pressure_angle", "30 deg", "below 30 deg"),
        beyond("least_contact_ratio", 0.9, "at least 1"),
        beyond("rollers", 0, "at least 1"),
        beyond("carrying_share", 1.1, "at most 1"),
        beyond("rim_factor", 0, "above 0"),
        beyond("most_sliding_difference", 0, "above 0"),
        beyond("clearance", -0.1, "at least 0"),
        beyond("roller_shift", 3.1, "at most 3"),
        beyond("roller_teeth", 20.5, "a whole number"),
        not_offered("weights", "own_ranges", "printed_ranges", "printed"),
        ("ring_shift = -0.16", "'ring_shift' is a result; it is calculated, not stated"),
    ],
    "rv_gearing": [
        *positive({"power": "kW", "output_speed": "r/min", "module": "mm", "face_width": "mm"}),
        beyond("target_ratio", 1, "above 1"),
        beyond("target_ratio", -111, "above 1"),
        beyond("ratio_tolerance", 0, "above 0"),
        beyond("ratio_tolerance", 0.21, "at most 0.2"),
        beyond("fewest_sun_teeth", 5, "at least 6"),
        beyond("sun_teeth", 5, "at least 6"),
        beyond("planets", 0, "at least 1"),
        beyond("group", 0, "at least 1"),
        beyond("involute_efficiency", 0, "above 0"),
        beyond("cycloid_efficiency", 1.01, "at most 1"),
        beyond("bearing_efficiency", -0.99, "above 0"),
        beyond("bearing_efficiency", 1.0001, "at most 1"),
        beyond("planet_load_factor", 0.9, "at least 1"),
        beyond("accuracy_grade", 13, "at most 12"),
        beyond("addendum", 0, "above 0"),
        beyond("fillet", -0.1, "at least 0"),
        beyond("pressure_angle", "10 deg", "above 10 deg"),
        beyond("helix_angle", "45 deg", "below 45 deg"),
        beyond("poisson_ratio_sun", 0.5, "below 0.5"),
        beyond("stated_dynamic_factor", 0, "above 0"),
        beyond("stated_form_factor_planet", -2.3, "above 0"),
        beyond("viscosity", "0 mm**2/s", "above 0 mm**2/s"),
        beyond("viscosity", "-1 mm**2/s", "above 0 mm**2/s"),
        beyond("sun_teeth", 20.5, "a whole number"),
        ("fewest_pins = 40.5", "fewest_pins = 40.5 is no whole number; write fewest_pins = 3"),
        not_offered("material", "case_hardened", "through_hardened", "nitrided"),
        not_offered("window", "whole", "one_pin_circle"),
        not_offered("helix_reading", "iso", "gb_1997"),
    ],
    "rv_wear": [
        *positive({
            "pin_circle_radius": "mm", "pin_radius": "mm", "eccentricity": "mm", "disc_width": "mm",
            "young_modulus": "MPa", "output_torque": "N*m", "output_speed": "r/min", "composite_roughness": "um",
            "pressure_viscosity": "1/Pa", "reconstruction_depth": "um", "permitted_backlash": "arcmin",
            "sun_radius": "mm", "centre_distance": "mm",
        }),
        beyond("pin_count", 3, "at least 4"),
        beyond("pin_count", -40, "at least 4"),
        beyond("phases", 0, "at least 4"),
        beyond("poisson_ratio", 0.5, "below 0.5"),
        beyond("poisson_ratio", -0.1, "at least 0"),
        beyond("working_time", "-1 h", "at least 0 h"),
        beyond("required_reliability", 0, "above 0"),
        beyond("required_reliability", 1.01, "at most 1"),
        beyond("torque_share", 1.2, "at most 1"),
        ("pin_count = 40.5", "pin_count = 40.5 is no whole number; write pin_count = 3"),
        not_offered("cost_form", "power", "exponential", "process"),
        not_offered("load_sharing", "linear", "hertz"),
        # a wear, a deviation or a roughness of a millimetre is micrometres written as millimetres
        ('composite_roughness = "1.5 mm"', "composite_roughness is 1500 um; it must be below 1000 um"),
        ('extra_wear = "3.1 mm"', "extra_wear is 3100 um; it must be at most 1000 um"),
        ('equidistant_modification = "-26 mm"', "equidistant_modification is -26000 um; it must be at least -1000 um"),
        ('disc_runout = "6.55 mm"', "disc_runout is 6550 um; it must be at most 1000 um"),
        ('pin_radius = "5 m"', "pin_radius is 5000 mm; it must be below 1000 mm"),
    ],
}  # fmt: skip


def parted(faults: Faults) -> Iterator[Faults]:
    """Part faults so that every input is stated once, as a file demands."""
    left = list(faults)
    while left:
        first = {line.split(" ")[0]: (line, said) for line, said in reversed(left)}
        yield list(first.values())
        left = [fault for fault in left if fault not in first.values()]


@pytest.mark.parametrize("plugin", NUMBERS)
def test_numbers_and_words_out_of_their_range_are_all_named(refused_inputs: Refused, plugin: str) -> None:
    for faults in parted(NUMBERS[plugin]):
        said = refused_inputs(plugin, *(line for line, _ in faults))
        assert said == [f"inputs.toml:{place}: {words}" for place, (_, words) in enumerate(faults, start=3)]


AREAL = 'convention = "areal"'
ROUGH = 'mating_roughness = "1e-11 m"'
CONVENTIONS = "means nothing without convention; state convention (areal, one_direction, profile) beside it"
IMPOSSIBLE: dict[str, list[tuple[list[str], int, str]]] = {
    "harmonic_fractal": [
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
