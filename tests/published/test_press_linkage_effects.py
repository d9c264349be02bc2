"""What the press linkage leaves out: each effect against loops solved independently, statics, and identities.

Numbers marked as reference were worked out to first order from the loop increments of the linkage, by hand.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from itertools import product
from math import exp, radians
from typing import Any

import numpy as np
import press_by_hand as by_hand
import pytest
from press_linkage_cases import AROUND, MECHANISMS, PAPER, scattered, solve

from press_linkage.effects import EFFECTS, shares_of_load
from press_linkage.errors import press_linkage
from press_linkage.kinematics import Half, slider_motion
from press_linkage.model import PRESS_LINKAGE
from press_linkage.quantities import Press, Slider
from truing import Effect, Float
from truing.calculation import calculate
from truing.errors import InfeasibleError
from truing.evaluate import evaluate
from truing.setup import SwitchedOn, default_setup

STEEL = 11.5e-6  # 1/K
ROOM = 293.15  # K
SOFT = 1e-9  # 1/N, a bar of 48 cm² of steel
NOMINAL = by_hand.PAPER
LINKS = ("crank_radius", "rod_length", "knee_drive_length", "upper_knee_length", "lower_knee_length")
LOADED = LINKS[1:]
KNEE = LINKS[2:]
SIDES = (1, 2)
TURNED = np.radians([-720.0, -360.0, -180.0, -140.3, -90.0, -1.0, 0.0, 1.0, 45.0, 179.0, 180.0, 350.0, 360.0, 725.0])
PLACES = pytest.mark.parametrize("degrees", [-140.3, -90.0, -25.0, 0.0, 40.0, 150.0])
BY_NAME = {effect.name: effect for effect in EFFECTS}
EVERY = pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect.name)


def press_at(crank_angle: Float = 0.0, **deviations: float) -> Press:
    """The paper's press at a crank angle in radians."""
    return replace(PRESS_LINKAGE.inputs(**deviations), crank_angle=crank_angle)


def shown(name: str, crank_angle: Float = 0.0, **values: Float) -> Slider:
    """The slider with one effect on, unknowns and conditions in SI."""
    effect, press = BY_NAME[name], press_at(crank_angle)
    if effect.place == "inputs":
        return press_linkage(effect.function(press, **values))
    return effect.function(press, press_linkage(press), **values)  # type: ignore[no-any-return]


def moved(name: str, crank_angle: Float = 0.0, **values: Float) -> tuple[Float, Float]:
    """What one effect does to position (m) and tilt (rad)."""
    base, there = press_linkage(press_at(crank_angle)), shown(name, crank_angle, **values)
    return there.slider_position - base.slider_position, there.slider_tilt - base.slider_tilt


# Against the loops, solved and differentiated a second time elsewhere


@cache
def slopes(degrees: float) -> dict[str, float]:
    """Change of the slider position per metre of each source, by the implicit function theorem on the loops."""
    return {name: pair[0] for name, pair in by_hand.derivatives(NOMINAL, radians(degrees)).items()}


def height_by_hand(crank_angle: float) -> float:
    return float(by_hand.slider(by_hand.closed(NOMINAL, crank_angle), NOMINAL)[0])


@cache
def acceleration_by_hand(degrees: float) -> float:
    """Second derivative of the slider position by the crank angle: central differences, once extrapolated."""

    def second(step: float) -> float:
        ends = [height_by_hand(radians(degrees) + by) for by in (-step, 0.0, step)]
        return (ends[0] - 2 * ends[1] + ends[2]) / step**2

    return (4 * second(4e-3) - second(8e-3)) / 3


def heated(strain_1: float, strain_2: float) -> dict[str, float]:
    off = {f"{kind}_deviation_1": strain_1 * NOMINAL[kind] for kind in LINKS}
    off |= {f"{kind}_deviation_2": strain_2 * NOMINAL[kind] for kind in LINKS}
    return off | {"platform_arm_deviation": (strain_1 + strain_2) / 2 * NOMINAL["platform_arm"]}


def pressed(degrees: float, compliance_by_force: float) -> dict[str, float]:
    """Force times slope is the force in the link (virtual work), and shortens it by N L/(EA)."""
    return {
        f"{kind}_deviation_{side}": -compliance_by_force * slopes(degrees)[f"{kind}_deviation_{side}"] * NOMINAL[kind]
        for kind in LOADED
        for side in SIDES
    }


def slackened(degrees: float, clearance: float) -> dict[str, float]:
    return {
        name: -2 * clearance * float(np.sign(slopes(degrees)[name]))
        for name in (f"{kind}_deviation_{side}" for kind in LOADED for side in SIDES)
    }


def ahead(by: float) -> dict[str, float]:
    return {f"crank_angle_deviation_{side}": by for side in SIDES}


Off = Callable[[float], dict[str, float]]
BY_HAND: list[tuple[str, dict[str, float], Off, float]] = [  # effect, unknowns and conditions, deviations, within
    ("link_heating", {"expansion": STEEL, "link_temperature": ROOM + 15}, lambda at: heated(15 * STEEL, 15 * STEEL), 0),
    (
        "side_heating",
        {"expansion_1": 1.4e-5, "expansion_2": -3e-6, "link_temperature": ROOM - 9},
        lambda at: heated(-9 * 1.4e-5, 9 * 3e-6),
        0,
    ),
    (
        "warm_up",
        {"rise": 4e-4, "time_constant": 7200.0, "time": 3600.0},
        lambda at: heated(*[4e-4 * (1 - exp(-0.5))] * 2),
        0,
    ),
    ("crank_phase", {"phase": 0.012}, lambda at: ahead(0.012), 0),
    (
        "encoder_eccentricity",
        {"sine": 0.003, "cosine": -0.007},
        lambda at: ahead(0.003 * np.sin(radians(at)) - 0.007 * np.cos(radians(at))),
        0,
    ),
    ("elastic_deflection", {"compliance": SOFT, "forming_force": 8e5}, lambda at: pressed(at, 8e-4), 0),
    ("elastic_deflection", {"compliance": SOFT, "forming_force": -1e5}, lambda at: pressed(at, -1e-4), 0),
    ("joint_clearance", {"clearance": 2e-5, "forming_force": 3.0}, lambda at: slackened(at, 2e-5), 0),
    ("joint_clearance", {"clearance": 2e-5, "forming_force": -9e5}, lambda at: slackened(at, -2e-5), 0),
    (
        "joint_wear",
        {"wear": 3e-4, "strokes": 2e5, "forming_force": 1e4},
        lambda at: slackened(at, 0.2 * 3e-4),
        0,
    ),
    (
        "slider_inertia",
        {"mass_compliance": 5e-6, "speed": 0.5},  # 20 t on bars of 190 cm², 30 turns per minute
        lambda at: pressed(at, 5e-6 * acceleration_by_hand(at) * np.pi**2),
        1e-9,  # of some hundred um: differences of the loops stand in for their second derivative
    ),
]


@pytest.mark.parametrize(("name", "values", "off", "within"), BY_HAND, ids=[row[0] for row in BY_HAND])
@PLACES
def test_effect_is_an_exact_mechanism_with_these_deviations(
    name: str, values: dict[str, float], off: Off, within: float, degrees: float
) -> None:
    there = by_hand.closed(NOMINAL, radians(degrees), off(degrees))
    position, tilt = by_hand.slider(there, NOMINAL)
    found = shown(name, radians(degrees), **values)
    assert found.slider_position == pytest.approx(position, abs=1e-12 + within)
    assert found.slider_tilt == pytest.approx(tilt, abs=1e-12)


@pytest.mark.parametrize(("degrees", "direction"), [(-25.0, 1.0), (-25.0, -1.0), (40.0, 1.0), (40.0, -1.0)])
def test_backlash_leaves_the_crank_behind_in_its_sense_of_turning(degrees: float, direction: float) -> None:
    """Towards the dead centre the crank turns forward before it and backward after it."""
    turns_forward = (degrees < 0) == (direction > 0)
    play = 0.004 if degrees < 0 else 0.009
    behind = ahead(-play / 2 if turns_forward else play / 2)
    position, _ = by_hand.slider(by_hand.closed(NOMINAL, radians(degrees), behind), NOMINAL)
    found = shown("drive_backlash", radians(degrees), play_before=0.004, play_after=0.009, direction=direction)
    assert found.slider_position == pytest.approx(position, abs=1e-12)


# First-order numbers at the bottom dead centre


# Statics: every joint is in equilibrium


def along(half: Half, link: str) -> tuple[Float, Float]:
    direction = getattr(half, link)
    return direction.cosine, direction.sine


@MECHANISMS
@pytest.mark.parametrize("size", [0.0, 2e-3])
def test_link_forces_are_in_equilibrium(geometry: Press, size: float) -> None:
    """Slider joint, knee and platform, under half of a newton on each side that pushes the slider up."""
    off = scattered(size, 31)
    position = solve(geometry, AROUND, side_1=off, side_2=off)
    platform = 0.0
    for half, force in zip((position.side_1, position.side_2), shares_of_load(position), strict=True):
        drive, upper, lower, rod = (along(half, name) for name in ("drive", "upper", "lower", "rod"))
        assert force["lower_knee_length"] * lower[1] == pytest.approx(np.full(AROUND.shape, 0.5), abs=1e-14)
        for part in (0, 1):  # links that are pressed push the knee away from their other ends
            knee = force["knee_drive_length"] * drive[part] + force["upper_knee_length"] * upper[part]
            assert knee == pytest.approx(force["lower_knee_length"] * lower[part], abs=1e-13)
        platform = platform + force["rod_length"] * rod[1] - force["knee_drive_length"] * drive[1]
    assert platform == pytest.approx(np.zeros_like(AROUND), abs=1e-14)


# Motion


@MECHANISMS
@pytest.mark.parametrize("size", [0.0, 2e-3])
def test_motion_is_the_derivative_of_the_position_over_the_whole_turn(geometry: Press, size: float) -> None:
    turn, step = np.radians(np.linspace(-180, 180, 361)), 1e-3

    def height(by: float) -> Any:
        return solve(geometry, turn + by, side_1=scattered(size, 41), side_2=scattered(size, 42)).slider_position

    found = slider_motion(solve(geometry, turn, side_1=scattered(size, 41), side_2=scattered(size, 42)))
    speed = (8 * (height(step) - height(-step)) - (height(2 * step) - height(-2 * step))) / (12 * step)
    gain = 16 * (height(step) + height(-step)) - (height(2 * step) + height(-2 * step)) - 30 * height(0.0)
    assert found.speed == pytest.approx(speed, abs=1e-9)
    assert found.acceleration == pytest.approx(gain / (12 * step**2), abs=3e-8)


def test_acceleration_at_the_dead_centre_is_that_of_the_platform_times_the_transmission() -> None:
    """There the slider has no speed: z_2'' = (dz_2/dz_1) z_1'' with z_1'' = -a (a + k_R) / (k_R sin theta_21)."""
    position = solve(PAPER, 0.0)
    platform = -0.36 * (0.36 + 1.304) / (1.304 * np.sin(radians(122.743)))
    assert platform == pytest.approx(-0.546, abs=5e-4)  # reference
    assert slider_motion(position).acceleration == pytest.approx(0.125586 * platform, abs=2e-6)
    assert slider_motion(position).speed == pytest.approx(0.0, abs=1e-15)


# Identities


def test_uniform_heat_is_a_mechanism_with_longer_links() -> None:
    strain = 15 * STEEL
    grown = {name: size * (1 + strain if name in (*LINKS, "platform_arm") else 1) for name, size in NOMINAL.items()}
    for degrees in (-90.0, 0.0, 40.0):
        crank = radians(degrees) + by_hand.dead_centre(NOMINAL) - by_hand.dead_centre(grown)
        position, _ = by_hand.slider(by_hand.closed(grown, crank), grown)
        found = shown("link_heating", radians(degrees), expansion=STEEL, link_temperature=ROOM + 15)
        assert found.slider_position == pytest.approx(position, abs=1e-12)


def test_both_sides_heated_are_all_links_heated() -> None:
    press = press_at(AROUND)
    both = BY_NAME["side_heating"].function(press, expansion_1=STEEL, expansion_2=STEEL, link_temperature=ROOM + 8)
    one = BY_NAME["side_heating"].function(press, expansion_1=STEEL, expansion_2=0.0, link_temperature=ROOM + 8)
    then = BY_NAME["side_heating"].function(one, expansion_1=0.0, expansion_2=STEEL, link_temperature=ROOM + 8)
    whole = BY_NAME["link_heating"].function(press, expansion=STEEL, link_temperature=ROOM + 8)
    for press in (both, then):
        assert (press.side_1, press.side_2) == (whole.side_1, whole.side_2)
        assert press.platform_arm_deviation == pytest.approx(whole.platform_arm_deviation, rel=1e-15)


def test_one_side_or_the_other_heated_is_a_mirror_image() -> None:
    one = moved("side_heating", AROUND, expansion_1=STEEL, expansion_2=0.0, link_temperature=ROOM + 8)
    other = moved("side_heating", AROUND, expansion_1=0.0, expansion_2=STEEL, link_temperature=ROOM + 8)
    assert one[0] == pytest.approx(other[0], abs=1e-14)
    assert one[1] == pytest.approx(-np.asarray(other[1]), abs=1e-14)
    assert (np.asarray(one[1]) > 0).all()  # side 1 is lower


def test_warm_up_ends_where_heat_has_the_same_strain() -> None:
    late = moved("warm_up", AROUND, rise=3e-4, time_constant=3600.0, time=1e9)
    hot = moved("link_heating", AROUND, expansion=1e-5, link_temperature=ROOM + 30)
    assert late[0] == pytest.approx(hot[0], abs=1e-14)
    assert moved("warm_up", AROUND, rise=3e-4, time_constant=3600.0, time=0.0)[0] == pytest.approx(0.0, abs=0.0)
    share = np.asarray(moved("warm_up", rise=3e-6, time_constant=3600.0, time=np.array([3600.0, 7200.0]))[0])
    assert share / moved("warm_up", rise=3e-6, time_constant=3600.0, time=1e9)[0] == pytest.approx(
        [0.632121, 0.864665], abs=1e-6
    )


def test_clearance_depends_on_the_sign_of_the_force_alone_and_jumps_by_twice_its_size() -> None:
    force = np.array([1e-3, 1.0, 2e6, 0.0, -1e-3, -2e6])
    found = np.asarray(moved("joint_clearance", radians(-20), clearance=2e-5, forming_force=force)[0])
    assert len(set(found[:4])) == len(set(found[4:])) == 1
    assert found[0] < 0 < found[-1]  # pushed up, the slider stands higher
    assert found[0] == pytest.approx(-found[-1], rel=1e-4)  # to first order


@cache
def reach_of_play(degrees: float) -> tuple[float, float]:
    """The highest and the lowest slider of all sixteen ways in which 40 um of play of the links can lie, by hand."""
    heights = []
    for ways in product((-4e-5, 4e-5), repeat=len(LOADED)):
        changed = NOMINAL | {name: NOMINAL[name] + way for name, way in zip(LOADED, ways, strict=True)}
        crank = radians(degrees) + by_hand.dead_centre(NOMINAL) - by_hand.dead_centre(changed)
        heights.append(float(by_hand.slider(by_hand.closed(changed, crank), changed)[0]))
    return min(heights), max(heights)


@pytest.mark.parametrize("degrees", [-60.0, 0.0, 40.0])
@pytest.mark.parametrize(
    ("tonnes", "lift", "force", "is_up"),
    [
        (20.0, 0.0, 0.0, False), (20.0, 0.0, 195e3, False), (20.0, 0.0, 197e3, True), (20.0, 196.133e3, 0.0, True),
        (20.0, 196.133e3, -1.0, False), (20.0, 250e3, -50e3, True), (20.0, 250e3, -60e3, False), (0.0, 0.0, 0.0, True),
    ],
)  # fmt: skip
def test_a_slider_hangs_in_its_joints_until_the_load_lifts_it(
    degrees: float, tonnes: float, lift: float, force: float, is_up: bool
) -> None:
    """Reference: 20 t are 196.133 kN."""
    press = replace(press_at(radians(degrees)), slider_mass=1e3 * tonnes, counterbalance=lift)
    loose, worn = (
        press_linkage(BY_NAME["joint_clearance"].function(press, clearance=2e-5, forming_force=force)),
        press_linkage(BY_NAME["joint_wear"].function(press, wear=4e-5, strokes=5e5, forming_force=force)),
    )
    assert loose.slider_position == pytest.approx(reach_of_play(degrees)[0 if is_up else 1], abs=1e-12)
    assert worn.slider_position == loose.slider_position


def test_links_carry_what_weight_and_counterbalance_leave() -> None:
    """A slider of 20 t that 100 kN lift stretches its links as a forming force of -96.133 kN does."""
    press = replace(press_at(0.3), slider_mass=20e3, counterbalance=1e5)
    there = BY_NAME["elastic_deflection"].function(press, compliance=SOFT, forming_force=5e4)
    alone = BY_NAME["elastic_deflection"].function(press_at(0.3), compliance=SOFT, forming_force=5e4 - 96133.0)
    assert press_linkage(there).slider_position == pytest.approx(press_linkage(alone).slider_position, abs=1e-14)


def test_clearance_follows_links_that_change_from_pressed_to_pulled() -> None:
    """Near the top the upper knee link is pulled by a force that pushes the slider up (reference: xi_lm < 0)."""
    for degrees, sign in [(-140.3, -1), (-90.0, -1), (-40.0, 1), (0.0, 1), (90.0, 1), (150.0, -1)]:
        press = press_at(radians(degrees))
        there = BY_NAME["joint_clearance"].function(press, clearance=2e-5, forming_force=5e4)
        assert there.side_1.upper_knee_length_deviation == pytest.approx(-sign * 4e-5, rel=1e-12)
        assert there.side_1.lower_knee_length_deviation == pytest.approx(-4e-5, rel=1e-12)


def test_wear_after_some_strokes_is_a_clearance() -> None:
    force = np.where(AROUND < 0, 1e5, -1e5)
    worn = moved("joint_wear", AROUND, wear=8e-5, strokes=250_000.0, forming_force=force)
    loose = moved("joint_clearance", AROUND, clearance=2e-5, forming_force=force)
    assert worn[0] == pytest.approx(loose[0], abs=1e-15)


def test_deflection_is_proportional_to_the_force() -> None:
    force = np.array([-1e5, 0.0, 1e5, 1e6])
    found = np.asarray(moved("elastic_deflection", 0.3, compliance=SOFT, forming_force=force)[0])
    assert found[1] == 0.0
    assert found / found[2] == pytest.approx([-1.0, 0.0, 1.0, 10.0], rel=5e-3)
    assert found[2] < 0


def test_inertia_is_the_deflection_under_mass_times_acceleration_against_the_motion() -> None:
    mass, turns = 20e3, 0.5
    acceleration = np.array([acceleration_by_hand(at) for at in (-90.0, -25.0, 0.0, 40.0)])
    angle = np.radians([-90.0, -25.0, 0.0, 40.0])
    inertia = moved("slider_inertia", angle, mass_compliance=mass * SOFT, speed=turns)
    force = mass * acceleration * (2 * np.pi * turns) ** 2  # positive upward, z and its acceleration downward
    elastic = moved("elastic_deflection", angle, compliance=SOFT, forming_force=force)
    assert inertia[0] == pytest.approx(elastic[0], rel=1e-6)
    assert inertia[0][2] > 0, "at the bottom dead centre the slider runs deeper the faster it goes"
    slow, fast = (
        BY_NAME["slider_inertia"].function(press_at(angle), mass_compliance=mass * SOFT, speed=speed).side_2
        for speed in (turns, 2 * turns)
    )
    for link in LOADED:
        name = f"{link}_deviation"
        assert getattr(fast, name) == pytest.approx(4 * getattr(slow, name), rel=1e-14)


def test_backlash_is_odd_in_the_direction_and_nothing_at_the_dead_centre() -> None:
    press, play = press_at(TURNED), {"play_before": 0.004, "play_after": 0.009}
    down, up, rest = (BY_NAME["drive_backlash"].function(press, **play, direction=d) for d in (1.0, -1.0, 0.0))
    assert np.array_equal(down.side_1.crank_angle_deviation, -up.side_1.crank_angle_deviation)
    assert np.array_equal(down.side_2.crank_angle_deviation, down.side_1.crank_angle_deviation)
    assert not np.any(rest.side_1.crank_angle_deviation)
    centre = np.isin(np.round(np.degrees(TURNED)), [-720, -360, 0, 360])
    assert np.array_equal(down.side_1.crank_angle_deviation == 0, centre)
    higher = moved("drive_backlash", np.radians([-60.0, -5.0, 5.0, 60.0]), **play, direction=1.0)[0]
    assert (np.asarray(higher) < 0).all()


def test_eccentricity_is_a_phase_error_once_per_turn() -> None:
    ahead = BY_NAME["encoder_eccentricity"].function(press_at(TURNED), sine=0.003, cosine=0.004)
    found = np.asarray(ahead.side_1.crank_angle_deviation)
    assert np.array_equal(found, ahead.side_2.crank_angle_deviation)
    assert found == pytest.approx(0.005 * np.cos(TURNED - np.arctan2(3, 4)), abs=1e-15)


def test_die_adds_to_tilt_and_position() -> None:
    found = moved("die_inclination", AROUND, inclination=7e-5, height=-3e-5)
    assert found[0] == pytest.approx(np.full(AROUND.shape, -3e-5), abs=1e-15)
    assert found[1] == pytest.approx(np.full(AROUND.shape, 7e-5), abs=1e-15)
    alone = moved("die_inclination", inclination=7e-5, height=0.0)
    assert alone == (0.0, pytest.approx(7e-5))


# What holds for every effect


CONDITIONS = {
    "forming_force": 4e5, "link_temperature": ROOM + 12, "time": 9e3, "strokes": 3e5, "speed": 0.4, "direction": 1.0,
}  # fmt: skip
SIZES = {"time_constant": 5e3, "wear": 1e-4, "clearance": 2e-5, "compliance": SOFT, "mass_compliance": 5e-6}
SIZES |= dict.fromkeys(("expansion", "expansion_1", "rise", "inclination", "height"), 1e-5)
SIZES |= dict.fromkeys(("expansion_2", "phase", "sine", "cosine", "play_before", "play_after"), 2e-3)
SIZES |= {"expansion_2": 5e-6, "cosine": -1e-3, "play_after": 3e-3}


def keywords(effect: Effect[Any, Any], **changed: Float) -> dict[str, Float]:
    known: dict[str, Float] = {**SIZES, **CONDITIONS, **changed}
    return {item.name: known[item.name] for item in (*effect.unknowns, *effect.needs)}


@EVERY
@pytest.mark.parametrize(("degrees", "turned"), [(-10, 350), (5, 725), (5, -355), (180, -180), (-140, 580)])
def test_a_crank_angle_means_the_same_in_every_turn(effect: Effect[Any, Any], degrees: float, turned: float) -> None:
    here, there = (moved(effect.name, radians(at), **keywords(effect)) for at in (degrees, turned))
    assert here == pytest.approx(there, abs=2e-14)
    assert abs(float(here[0])) > 1e-9


@EVERY
def test_a_loop_that_does_not_close_is_still_told_by_name(effect: Effect[Any, Any]) -> None:
    setup = default_setup(PRESS_LINKAGE, knee_drive_length="0.3 m", crank_angle="-140 deg")
    values = {item.name: SIZES[item.name] for item in effect.unknowns}
    on = replace(setup, effects=(SwitchedOn(effect, values),), conditions=CONDITIONS)
    with pytest.raises(InfeasibleError, match="loop II, side 1 does not close: the knee drive is open"):
        evaluate(on)


def test_a_press_without_load_has_its_clearance_taken_up_and_no_deflection() -> None:
    setup = replace(default_setup(PRESS_LINKAGE), studies=())
    loose = SwitchedOn(BY_NAME["joint_clearance"], {"clearance": 2e-5})
    assert calculate(replace(setup, effects=(loose,))).warnings == ()
    idle = SwitchedOn(BY_NAME["elastic_deflection"], {"compliance": SOFT})
    (warning,) = calculate(replace(setup, effects=(loose, idle))).warnings
    assert warning == "effect 'elastic_deflection' is on, but 'forming_force' stays at its reference: it does nothing"


def test_effects_that_act_together_add_up() -> None:
    """Heat, crank, load and die at once, against the sum of one by one: what is left is of second order."""
    setup = replace(default_setup(PRESS_LINKAGE, crank_angle="-20 deg"), conditions=CONDITIONS)
    base = evaluate(setup).slider_position

    def shift(*effects: Effect[Any, Any]) -> float:
        on = [SwitchedOn(item, {one.name: SIZES[one.name] for one in item.unknowns}) for item in effects]
        return float(evaluate(replace(setup, effects=tuple(on))).slider_position - base)

    alone = sum(shift(effect) for effect in EFFECTS)
    assert shift(*EFFECTS) == pytest.approx(alone, abs=5e-3 * sum(abs(shift(effect)) for effect in EFFECTS))


# What is declared
