"""The exact play: against discs whose outline is laid point by point, and against closed forms at its limits."""

from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
import pytest
from scipy.spatial import cKDTree

from hidden_effects.rv_play import Mesh, ends_of_play
from pages import Page, number
from rv_wear import play
from rv_wear.discs import worn_mesh
from rv_wear.exact_play import ExactPlay, answered
from rv_wear.model import RV_WEAR
from truing import Kernel, TruingError
from truing.calculation import calculate
from truing.setup import default_setup

PINS, CIRCLE, PIN, THROW = 40, 114.5, 5.0, 2.2  # mm
ARM = THROW * (PINS - 1)
ARCMIN = np.pi / 10800
Q = np.sqrt(1 - (THROW * PINS / CIRCLE) ** 2)
REDUCER = RV_WEAR.inputs()
CRANK = np.linspace(0, 2 * np.pi, 40, endpoint=False)
NOMINAL = {"pin_radius_error": "0 um", "pin_fit_clearance": "0 um"}
POINTS = 400_000
PAGE = Page("rv_wear")


# A disc as a cloud of points, one every two micrometres: what the parts are off, mm


@lru_cache(maxsize=4)
def outlines(machine: int) -> tuple[play.Parts, list[Any]]:
    """A machine with large errors, and the outline of both its discs in their own frames."""
    reducer = RV_WEAR.inputs(
        pin_radius_spread="2 um", pin_position_spread="4 um", tooth_pitch_spread="3 um", disc_phase_error="0.7 arcmin",
        eccentricity_error="5 um", equidistant_error="19 um", shift_error="-12 um", disc_runout="8 um",
        pin_circle_error="3 um",
    )  # fmt: skip
    parts = play.drawn_parts(reducer, np.random.default_rng(machine), 1)
    trees = []
    t = np.linspace(0, 2 * np.pi, POINTS, endpoint=False)
    circle, ground_pin = CIRCLE - 0.030 - 0.012, PIN - 0.026 + 0.019
    path = circle * np.exp(1j * t) - THROW * np.exp(1j * PINS * t)
    way = np.roll(path, -1) - np.roll(path, 1)
    outline = path + 1j * way / np.abs(way) * ground_pin
    tooth = np.floor(t * (PINS - 1) / (2 * np.pi)).astype(int)
    for disc in range(2):
        turned = outline * np.exp(1j * parts.tooth_along[disc, tooth, 0] * 1e3 / CIRCLE)
        moved = turned + parts.offset[disc, 0] * 1e3
        trees.append(cKDTree(np.column_stack([moved.real, moved.imag])))
    return parts, trees


def least_gap(machine: int, crank: float, output: float) -> float:
    """The least gap (mm) between any pin and any disc at an angle of the output, from the clouds of points."""
    parts, trees = outlines(machine)
    at = 2 * np.pi * np.arange(PINS) / PINS
    radial, along = parts.pin_radial[:, 0] * 1e3, parts.pin_along[:, 0] * 1e3
    pins = (CIRCLE + radial + 1j * along) * np.exp(1j * at)
    least = np.inf
    for disc, tree in enumerate(trees):
        swing = crank + np.pi * disc
        centre = parts.throw[disc, 0] * 1e3 * np.exp(1j * (swing + parts.phase[disc, 0]))
        seen = (pins - centre) * np.exp(-1j * (output - swing / (PINS - 1)))
        gaps = tree.query(np.column_stack([seen.real, seen.imag]))[0] - parts.pin_radius[:, 0] * 1e3
        least = min(least, float(gaps.min()))
    return least


@pytest.mark.parametrize(("machine", "crank"), [(1, 0.3), (1, 100.0), (2, 4.0), (3, 17.7)])
def test_the_output_turns_until_the_outline_of_a_disc_touches_a_pin(machine: int, crank: float) -> None:
    """Outlines laid point by point know nothing of phases, arms or feet: at both ends something just touches."""
    parts, _ = outlines(machine)
    ends = [sense * float(play.touches(parts, np.array([crank]), sense).first[0, 0]) for sense in (1, -1)]
    inside = 0.5 * sum(ends)
    assert ends[0] - ends[1] > 10e-3 / ARM
    assert least_gap(machine, crank, inside) > 2e-3
    for end in ends:
        assert least_gap(machine, crank, end) == pytest.approx(0.0, abs=2e-6)


def test_perfect_parts_have_the_play_of_an_independent_solution() -> None:
    parts = play.ideal_parts(RV_WEAR.inputs(**NOMINAL, disc_phase_error="0 arcmin"))
    expected = ends_of_play(Mesh(CIRCLE, PIN, CIRCLE - 0.030, PIN - 0.026, THROW, THROW), CRANK)
    for sense, ends in zip((1, -1), expected, strict=True):
        assert play.touches(parts, CRANK, sense).first[:, 0] == pytest.approx(ends, abs=1e-12)


# Limits in closed form


def test_without_modification_the_play_is_that_of_the_pins() -> None:
    """Thinner pins alone: every contact has the gap d, and the longest arm touches first; equation 21 is exact."""
    parts = play.ideal_parts(
        RV_WEAR.inputs(equidistant_modification="0 um", shift_modification="0 um", pin_radius_error="-4 um",
                       pin_fit_clearance="0 um")
    )  # fmt: skip
    least = float(play.play_of(parts, np.linspace(0, 2 * np.pi, 4000)).min())
    assert least == pytest.approx(2 * 4e-3 / ARM, rel=1e-4)


@pytest.mark.parametrize("minutes", [-0.8, 0.5])
def test_a_crank_out_of_phase_takes_its_angle_over_the_teeth(minutes: float) -> None:
    """Disc 2 ideally stands turned back by the phase over the teeth: one disc stops each end of the play."""
    fair, off = (
        play.play_of(play.ideal_parts(RV_WEAR.inputs(disc_phase_error=f"{each} arcmin")), CRANK[:8])
        for each in (0.0, minutes)
    )
    assert off == pytest.approx(fair - abs(minutes) * ARCMIN / (PINS - 1), abs=5e-5 * ARCMIN)


def test_like_discs_share_the_torque_evenly_over_a_turn_and_hold_it() -> None:
    parts = play.ideal_parts(REDUCER)
    held = play.carried(parts, CRANK, 1)
    touched = play.touches(parts, CRANK, 1)
    arm = np.sin(touched.phase) / np.sqrt(1 + (1 - Q**2) - 2 * np.sqrt(1 - Q**2) * np.cos(touched.phase)) * ARM * 1e-3
    assert (held.force * arm[:, :, None]).sum(axis=0) == pytest.approx(np.full((40, 1), 3136.0), rel=1e-7)
    assert held.shares.mean(axis=1) == pytest.approx(0.5, abs=1e-3)


def test_the_disc_that_touches_first_carries_a_small_torque_alone() -> None:
    """A phase of 6 arcmin parts the discs by 0.15 arcmin at the output; 0.2 N m winds neither up as far."""
    reducer = RV_WEAR.inputs(disc_phase_error="-6 arcmin", output_torque="0.2 N*m")
    shares = play.carried(play.ideal_parts(reducer), CRANK, 1).shares
    assert shares[0] == pytest.approx(0.0) or shares[1] == pytest.approx(0.0)


def test_the_worn_play_feels_the_first_pin_and_not_the_deepest_wear() -> None:
    """The take-up of the worn flank where the disc is looked at, twice: the paper counts the deepest wear instead."""
    time = 6000 * 3600.0
    new, worn = (play.play_of(play.ideal_parts(REDUCER, each), CRANK)[:, 0] for each in (0.0, time))
    _, _, depth = worn_mesh(REDUCER, time)
    assert np.all(worn > new)
    assert (worn - new).max() * ARM * 1e-3 / 2 < 0.25 * depth.max()


def test_runout_of_the_discs_takes_play() -> None:
    rng = np.random.default_rng(4)
    even = replace(REDUCER, disc_runout=0.0)
    off = play.play_of(play.drawn_parts(REDUCER, np.random.default_rng(4), 30), CRANK).mean()
    assert off < play.play_of(play.drawn_parts(even, rng, 30), CRANK).mean()


# The study


@lru_cache(maxsize=1)
def run() -> Any:
    """The study alone, as it is shipped."""
    offer = Kernel.installed(strict=True).offer("rv_wear")
    return calculate(replace(default_setup(offer.model, offer.origin), studies=(ExactPlay(gives=answered),)))


def test_the_study_tells_what_the_parts_give() -> None:
    played, reducer = run().outcomes["exact_play"], run().setup.inputs
    told: Any = answered(played)
    again = play.drawn_parts(reducer, np.random.default_rng(run().setup.seed), 40, float(reducer.working_time))
    beside = float(run().answers["backlash_involute"]) + float(run().answers["backlash_bearing"])
    assert told.exact_backlash - beside == pytest.approx(float(play.play_of(again, played.crank).mean()), rel=1e-9)
    assert told.exact_least <= told.backlash_of_a_machine.min()
    assert told.exact_most >= told.backlash_of_a_machine.max()
    assert told.error_loaded < told.error_free


def test_what_the_page_says() -> None:
    told: Any = answered(run().outcomes["exact_play"])
    linear = float(run().answers["backlash"]), float(run().answers["backlash_of_wear"])
    new, used = float(told.exact_new) / ARCMIN, float(told.exact_backlash) / ARCMIN
    by_21 = [(linear[0] - linear[1]) / ARCMIN, linear[0] / ARCMIN, linear[1] / ARCMIN]
    for start, paper, exact in zip(
        ("backlash, new", "backlash after 6000 h", "what the wear adds"), by_21, (new, used, used - new), strict=True
    ):
        assert PAGE.row(start) == [f"{number(each, 3)}′" for each in (paper, exact, exact - paper)]
    PAGE.says(
        f"between {told.exact_least / ARCMIN:.3f}′ and {told.exact_most / ARCMIN:.3f}′",
        f"as those of {told.averaged_errors:.1f} pins",
        f"carries {100 * told.worse_share:.0f} % on average and up to {100 * told.worst_share:.0f} %",
        f"pin is then {10 * round(float(told.force_of_both) / 10)} N",
        f"{told.error_free / ARCMIN:.3f}′ where the first tooth touches, {told.error_loaded / ARCMIN:.3f}′ under",
    )


def test_with_like_parts_the_play_is_equation_21_and_the_pitch_of_the_pins() -> None:
    """Errors 4 to 8 and 12 to 14: the first-order gap of every pin over its arm, by hand, at both ends.

    Second order: the shift of 30 um goes 23 um along a path of at least 9 mm radius, which is 0.03 um or 0.0012 arcmin.
    """
    crank = np.linspace(0, 2 * np.pi / PINS, 60)
    equidistant, shift, short_width = -26 + 2 + 8.5 / 2, -30, np.sqrt(1 - Q**2)
    ends = []
    for side in (-1, 1):
        psi = 2 * np.pi * np.arange(1, PINS // 2 - 1)[:, None] / PINS + side * crank
        distance = np.sqrt(1 + short_width**2 - 2 * short_width * np.cos(psi))
        gap = equidistant - shift * (1 - short_width * np.cos(psi)) / distance
        ends.append(np.min(gap * distance / np.maximum(np.sin(psi), 0.1), axis=0))
    exact = play.play_of(play.ideal_parts(REDUCER), crank)[:, 0]
    assert exact / ARCMIN == pytest.approx(sum(ends) * 1e-3 / ARM / ARCMIN, abs=2 * 0.0012)
    by_21 = (2 * equidistant - 2 * Q * shift) * 1e-3 / ARM / ARCMIN
    assert np.all((exact / ARCMIN - by_21 > -2e-4) & (exact / ARCMIN - by_21 < 0.005))


@pytest.mark.parametrize("wrong", [{"machines": 1}, {"points": 3}])
def test_a_study_of_nothing_is_refused(wrong: dict[str, int]) -> None:
    with pytest.raises(TruingError, match="can be drawn"):
        ExactPlay(**wrong)
