"""A machine of each plugin with something wrong, hidden by physics of its own: is it named, sized, and gained by it?

For each plugin a few clear cases: effects on inputs, results and readings, on every kind of noise, one pair, something
that nobody registered, nothing at all, and curves that several effects draw. How often each effect is found at other
sizes, on other noise and in other designs is measured by ``tests/benchmarks/bench_diagnosis_plugins.py``.
"""

from collections.abc import Mapping
from dataclasses import replace
from math import acos, cos, pi, radians, tan
from typing import Any

import numpy as np
import pytest

from hidden_effects import rv_machine, screw_machine
from hidden_effects.gearing_machine import ERROR, LOSS, PLAY, stage
from hidden_effects.harmonic_machine import MESH, TORSION, WHOLE, drive
from hidden_effects.harmonic_surface import STRUCTURE, surface
from hidden_effects.rigs import Wish, demand_named
from hidden_effects.rows import Array
from hidden_effects.rv_machine import WEAR, reducer
from hidden_effects.screw_machine import DEFLECTION, ROLLER, TORQUE, screw
from truing.diagnosis.result import APART


def fifth_order(rows: Any) -> Array:
    """A wave that nobody registered."""
    return np.asarray(2.0 * np.sin(5 * np.radians(rows.input_angle) + 0.4))


def warm_and_fast_seal(rows: Any) -> Array:
    """A seal that grips when it is warm and turned fast."""
    return np.asarray(4e-8 * (rows.temperature - 20) * rows.screw_speed)


def hot_and_fast(rows: Any) -> Array:
    """A mesh that grows stiff when it is warm and turned fast."""
    return np.asarray(2.5e5 * (rows.temperature - 30) / 30 * (rows.speed - 1000) / 1000)


STIFF: dict[str, Any] = {"design": "points", "results": (MESH,)}
RESONANCE = {"excitation": 0.06, "resonance_speed": 1800, "damping": 0.06}
TILTED_ROLLER = screw(seed=5, hidden={"face_misalignment": {"misalignment": 1.5}}, kind="growing", count=60)
NOTHING = [
    stage(seed=2, results=(ERROR, PLAY), kind="autocorrelated", count=70),
    reducer(seed=1),
    screw(seed=2, kind="heavy", results=(screw_machine.ERROR, screw_machine.BACKLASH)),
    drive(seed=43, kind="autocorrelated", logs=("time", "wave_angle"), **STIFF),
    surface(seed=2),
]
NAMED = [
    stage(seed=31, hidden={"centre_distance_growth": {"expansion": 12}}, results=(PLAY,), kind="autocorrelated"),
    stage(seed=41, hidden={"pin_drag": {"friction": 0.02, "film_speed": 6}}, results=(LOSS,), design="one_way"),
    stage(seed=13, hidden={"sun_runout": {"cosine": 1.2, "sine": -0.9}}, results=(ERROR,), kind="heavy"),
    reducer(
        seed=16,
        hidden={"runout": {"offset": 1.2, "direction": 310}, "disc_phase": {"phase": -2}},
        kind="autocorrelated",
    ),
    reducer(seed=27, hidden={"toothing_runout": {"offset": 1.2, "direction": 230}}, count=60),
    TILTED_ROLLER,
    screw(seed=7, hidden={"mesh_resonance": RESONANCE}, results=(ROLLER,), count=120),
    screw(seed=11, hidden={"roller_pitch_error": {"deviation": 0.2}}, results=(DEFLECTION,), count=40),
    screw(seed=12, hidden={"soft_threads": {"compliance": 20}}, results=(DEFLECTION,), count=30),
    drive(
        seed=31,
        hidden={"hysteresis": {"loop": 200, "torque_scale": 0.16}, "eccentricity": {"cosine": -12, "sine": 16}},
        logs=("wave_angle", "temperature"),
        count=30,
    ),
    drive(WHOLE, seed=78, hidden={"soft_wave_generator": {"torsion": 200}}, logs=(), count=30),
    surface(seed=3, hidden={"instrument_noise": {"variance": 60}}),
    surface(seed=4, hidden={"waviness": {"square": 0.01, "wavelength": 25}}),
]
UNKNOWN = [
    (stage(seed=26, strange=fifth_order, results=(ERROR,)), {"input_angle"}),
    (screw(seed=22, strange=warm_and_fast_seal, results=(TORQUE,), kind="heavy"), {"temperature", "screw_speed"}),
    (drive(seed=41, strange=hot_and_fast, logs=("temperature", "speed"), **STIFF), {"temperature", "speed"}),
]
OTHER_NAMES = {
    TORSION: {"eccentricity": "periodic_order", "ellipticity": "periodic_order", "rig_drift": "sensor_drift"},
    STRUCTURE: {"instrument_noise": "sensor_offset"},
}
"""Effects of harmonic drives and flanks that draw the curve of a gauge that errs, by result."""
OF_THE_GAUGE = {"rig_drift": (TORSION, 1.0), "instrument_noise": (STRUCTURE, 2e-6)}
"""The unknown of the gauge that has the same curve, and its size per unit of the effect's own."""


def each(wishes: list[Wish]) -> pytest.MarkDecorator:
    """One test per case."""
    return pytest.mark.parametrize("wish", wishes, ids=[wish.title for wish in wishes])


def other_name(wish: Wish, effect: str) -> str:
    """The other name of an effect on what is measured, or its own."""
    return OTHER_NAMES.get(wish.results[0], {}).get(effect, effect)


def names_of(document: Mapping[str, Any]) -> list[set[str]]:
    """Every name of each cause that was found."""
    return [{cause["effect"], *cause["same_as"]} for cause in document["causes"]]


@each(NOTHING)
def test_nothing_is_found_where_nothing_is_wrong(wish: Wish) -> None:
    document = wish.answered.document
    assert (document["explanations"], document["causes"], document["remainder"]) == ([], [], None)
    for gain in (document["gain"][name] for name in wish.results):
        assert not (gain["p_value"] < 0.05 and gain["log_score_gain"] > 0)


@each(NAMED)
def test_the_causes_are_named(wish: Wish) -> None:
    document = wish.answered.document
    curves = [{effect, other_name(wish, effect)} for effect in wish.hidden]
    demand_named(document, curves, may_be_unknown="instrument_noise" in wish.hidden)
    assert document["remainder"] is None
    assert sorted(map(sorted, names_of(document))) == sorted(map(sorted, curves))


MIRRORED = {"toothing_runout"}
"""Effects of which either sign of the first unknown draws the same, as long as they act alone."""


@each(NAMED)
def test_intervals_hold_the_truth(wish: Wish) -> None:
    """Where both parts of one effect are on, each is found with its own interval."""
    causes = wish.answered.document["causes"]
    for effect, unknowns in wish.hidden.items():
        cause = next(found for found in causes if effect in {found["effect"], *found["same_as"]})
        stated = unknowns
        if effect in OF_THE_GAUGE:
            result, size = OF_THE_GAUGE[effect]
            stated = {result: size * next(iter(unknowns.values()))}
        for name, true in stated.items():
            low, high = cause["unknowns"][name]["interval95"]
            if effect in MIRRORED and high < 0:
                low, high = -high, -low
            assert low <= true <= high, name


@each(NAMED)
def test_rows_held_out_are_predicted_as_well_as_can_be(wish: Wish) -> None:
    """Nearly as well as by the truth, which leaves the noise; most of what was wrong is gone, and that is no chance.

    Drives and flanks are read at few rows: what is estimated costs more.
    """
    answer = wish.answered
    few = wish.rig.plugin == "harmonic_fractal"
    for name in wish.results:
        assert wish.case.left_over_noise(answer.predicted, name) < (1.12 if few else 1.07)
    gains = [answer.document["gain"][name] for name in wish.results]
    assert any(gain["p_value"] < 0.05 for gain in gains)
    assert few or all(gain["reducible_removed"] > 0.9 for gain in gains if gain["p_value"] < 0.05)


@pytest.mark.parametrize(("wish", "depends_on"), UNKNOWN, ids=[wish.title for wish, _ in UNKNOWN])
def test_what_nobody_registered_is_called_unknown(wish: Wish, depends_on: set[str]) -> None:
    document = wish.answered.document
    assert (document["verdict"], document["causes"]) == ("unknown", [])
    assert set(document["remainder"]["depends_on"]) >= depends_on


# What cannot be told apart

LIKE_A_SPRING = {"wind_up", "mesh_stiffening", "lost_motion"}


def test_what_draws_nearly_one_curve_has_several_names() -> None:
    wish = stage(seed=3, hidden={"mesh_stiffening": {"share": 0.7}}, results=(ERROR,), design="sweep")
    document = wish.answered.document
    named = {name for names in names_of(document) for name in names}
    others = {name for other in document["alternatives"] for name in other["causes"]}
    assert set(wish.hidden) <= named | others
    assert len((named | others) & LIKE_A_SPRING) > 1
    assert not document["unique"]
    point = document["next"][0]
    assert point["measure"] or "load_torque" in point["settings"]
    assert set(" + ".join(point["separates"]).split(" + ")) <= LIKE_A_SPRING


def test_pins_that_drag_without_a_film_are_an_offset_of_the_gauge() -> None:
    """The same share at any load, speed and warmth is no more than an offset, or a gain: it is 2.6 % of 0.894."""
    dry = {"pin_drag": {"friction": 0.02, "film_speed": 1e4}}
    document = stage(seed=42, hidden=dry, results=(LOSS,), design="one_way", count=40).answered.document
    assert (document["verdict"], names_of(document)) == ("one_of", [{"sensor_offset", "sensor_gain"}])
    low, high = document["causes"][0]["unknowns"][LOSS]["interval95"]
    assert low <= -0.0256 <= high


def test_within_one_turn_of_the_crank_the_dips_do_not_say_what_is_off_centre() -> None:
    """Pins and toothing part only as the output turns; the next reading is asked for far from where it stood."""
    toothing = {"toothing_runout": {"offset": 0.6, "direction": 230}}
    document = reducer(seed=18, hidden=toothing, design="one_turn", count=40).answered.document
    assert (document["verdict"], document["unique"]) == ("one_of", False)
    assert sorted(map(sorted, document["explanations"])) == [["runout"], ["toothing_runout"]]
    point = document["next"][0]
    assert sorted(point["separates"]) == ["runout", "toothing_runout"]
    turned = point["settings"]["output_angle"]["value"]
    assert 30 < turned < 330


def test_discs_out_of_phase_without_runout_are_an_offset_of_the_gauge() -> None:
    """A crank that leads by 12 arcmin takes 12/39 of them at every angle; no reading over the crank tells."""
    document = reducer(seed=18, hidden={"disc_phase": {"phase": 12}}, count=40).answered.document
    assert (document["verdict"], names_of(document)) == ("one_of", [{"sensor_offset", "disc_phase"}])
    low, high = document["causes"][0]["unknowns"][rv_machine.BACKLASH]["interval95"]
    assert low <= -12 / 39 <= high


LESS_SLIDING = {"pin_rolling", "duty_share"}
"""Pins that roll and a load that reverses evenly are one thing to flank and backlash: only a fact parts them."""


def test_it_asks_for_the_wear_where_the_wear_can_tell() -> None:
    """Play that is not felt leaves the flank as deep as it is; less sliding does not. With the wear one is left."""
    document = reducer(seed=11, hidden={"lost_motion_share": {"loss": 0.5}}).answered.document
    explanations = {name for names in document["explanations"] for name in names}
    assert (document["verdict"], explanations) == ("one_of", {"lost_motion_share", *LESS_SLIDING})
    point = document["next"][0]
    assert (point["settings"], point["measure"]) == ({}, [WEAR])
    assert "lost_motion_share" in point["separates"]
    assert set(point["separates"]) <= explanations
    assert point["why"].startswith("measure max_wear, too: ")
    assert point["separation"] > APART


def test_a_stated_duty_leaves_one_name() -> None:
    """The log says that the load reverses evenly; then pins that roll are the only name that is left."""
    rig = replace(rv_machine.REDUCER, inputs='plugin = "rv_wear"\n[inputs]\nreversing = 1\n')
    wish = reducer(rig=rig, seed=20, hidden={"duty_share": {"idle": 0.4}}, count=40)
    assert not any("duty_share" in names for names in names_of(wish.answered.document))


GROWN = screw(seed=32, hidden={"thermal_centre_distance": {"expansion": 11.5}}, results=(screw_machine.BACKLASH,))
LOADED = screw(seed=35, hidden={"face_misalignment": {"misalignment": 0.6}}, design="loaded", count=60)
ALIKE = [  # every name of the curve
    (GROWN, {"thermal_drift", "thermal_centre_distance"}),
    (LOADED, {"face_misalignment", "roller_load_sharing"}),
]


@pytest.mark.parametrize(("wish", "names"), ALIKE, ids=[wish.title for wish, _ in ALIKE])
def test_curves_with_several_names_carry_them_all(wish: Wish, names: set[str]) -> None:
    """No further gauge would tell them apart; whatever the name, rows that were held out are predicted."""
    document = wish.answered.document
    assert (names_of(document), document["remainder"]) == ([names], None)
    assert not any(point["measure"] for point in document["next"])
    test_rows_held_out_are_predicted_as_well_as_can_be(wish)


def test_a_gauge_that_drifts_and_a_screw_that_grows_have_one_size() -> None:
    """The drift of the backlash is -2 a tan(working angle) times the expansion, 0.1516 um per kelvin."""
    (cause,) = GROWN.answered.document["causes"]
    working = acos(20 * cos(radians(20)) / 19.80778)
    true = -2 * 19807.78 * tan(working) * 11.5e-6
    low, high = cause["unknowns"]["backlash"]["interval95"]
    assert low <= true <= high


def test_a_thin_cup_is_a_spring_in_series_and_no_gain_of_the_gauge() -> None:
    """Wave generators are soft as T^(2/3), which a gain enlarges too; only the wall tells a cup from other springs.

    Bredt: a tube twists L/(2 pi r^3 t G) per torque, 10.9 urad/(N m) here, and 0.3/0.7 of it more without 0.3 of t.
    """
    document = drive(WHOLE, seed=54, hidden={"thin_cup": {"lost": 0.3}}, logs=(), count=30).answered.document
    assert (document["verdict"], document["remainder"]) == ("one_of", None)
    assert names_of(document) == [{"series_compliance", "thin_cup"}]
    assert document["next"][0]["measure"] == ["cup_moment"]
    twist = 1e6 * 28e-3 / (2 * pi * 24.5e-3**3 * 0.35e-3 * 206e9 / 2.6)
    low, high = document["causes"][0]["unknowns"]["compliance"]["interval95"]
    assert low <= 0.3 / 0.7 * twist <= high


def test_at_small_loads_a_tilt_is_no_roller_that_leads() -> None:
    """Under 12 kN and more both add one stress at any load; the diagnosis asks for small loads, and there they part."""
    points = [point for point in LOADED.answered.document["next"] if point["settings"]]
    assert points
    assert all(abs(point["settings"]["axial_load"]["value"]) < 5 for point in points)
    assert points[0]["separation"] > 25
    assert names_of(TILTED_ROLLER.answered.document) == [{"face_misalignment"}]
