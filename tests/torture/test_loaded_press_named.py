"""What is wrong with a press under load is named from a record of its stroke, however the press scatters.

The press of ``hidden_effects/loaded_press.py`` hides it; nothing of it is shared with the calculation. Three presses
within their tolerances for each effect, drawn here a second time.
"""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from hidden_effects.loaded_press import LoadedMachine
from hidden_effects.rigs import demand_first
from hidden_effects.test_loaded_press import (
    HIDDEN,
    PARTS,
    SLIDER,
    START,
    diagnosed,
    holds_the_truth,
    record,
    with_hidden,
)

SEEDS = (3, 4, 5)
MORE = {"soft_frame": ("ground_rise_1", "ground_rise_2"), "worn_platform_guides": ("platform_tilt",)}
"""Gauges beside those of the slider, where these do not tell an effect from what may scatter. One at each bearing: a
single one with a wrong gain would look as a soft frame does."""
WHOLE = float(np.radians(-150.0))
"""A stroke from far above parts links that are warm from a frame that has cooled."""
WITHIN = {"off_centre": 0.2, "loose_joints": 0.3, "worn_guides": 0.15, "inclined_guides": 0.15}
"""How far a size may be off: two to three standard deviations of what scatters in the same place (10 mm of 150 mm, 20 %
of 15 um, 20 % of 50 um, 7 urad of 200) and of the noise; else 5 %."""


def drawn(seed: int, effect: str = "") -> LoadedMachine:
    """A press whose load, play, guides, joints and frame are off by as much as the tolerances say.

    Whether a frame has become soft is asked of one whose stiffness was measured when it was new.
    """
    rng, press = np.random.default_rng([seed, 21]), LoadedMachine()

    def about(value: float, share: float) -> float:
        return float(value * np.exp(share * rng.standard_normal()))

    scattered = replace(
        press,
        offset=press.offset + 10e-3 * rng.standard_normal(),
        play=about(press.play, 0.2),
        clearance=about(press.clearance, 0.2),
        lean=press.lean + 4e-5 / 6 * rng.standard_normal(),
        joint=about(press.joint, 0.2),
        ground=(about(press.ground[0], 0.1), about(press.ground[1], 0.1)),
        columns=(about(press.columns[0], 0.1), press.columns[1]),
    )
    known = {"ground": press.ground, "columns": press.columns} if effect == "soft_frame" else {}
    return replace(scattered, **known)


@cache
def answered(effect: str, seed: int) -> Any:
    """What a diagnosis says to a stroke of such a press."""
    start = WHOLE if effect.startswith("warm") else START
    gauges = (*SLIDER, *MORE.get(effect, ()))
    known = (*PARTS, "frame_stiffness") if effect == "soft_frame" else PARTS
    return diagnosed(record(with_hidden(drawn(seed, effect), effect), gauges, seed=seed, start=start), known)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("effect", HIDDEN)
def test_what_is_wrong_is_named_with_its_size(effect: str, seed: int, full_torture: bool) -> None:
    if not full_torture:
        pytest.skip("takes a few seconds for each press")
    demand_first(answered(effect, seed), effect)
    holds_the_truth(answered(effect, seed), effect, within=WITHIN.get(effect, 0.05))


def test_few_are_named_beside_another_and_intervals_hold_the_truth_as_often_as_they_say(full_torture: bool) -> None:
    """Of 24 events of 95 % five or more fail to come in less than 1 of 100 such rounds."""
    if not full_torture:
        pytest.skip("takes a few seconds for each press")
    cases = [(effect, seed) for effect in HIDDEN for seed in SEEDS]
    assert len(cases) == 24
    alone = [demand_first(answered(*case), case[0]) for case in cases]
    held = [holds_the_truth(answered(*case), case[0], within=WITHIN.get(case[0], 0.05)) for case in cases]
    assert alone.count(False) < 5
    assert held.count(False) < 5


@pytest.mark.parametrize("seed", SEEDS)
def test_a_press_within_its_tolerances_has_nothing(seed: int, full_torture: bool) -> None:
    if not full_torture:
        pytest.skip("takes a few seconds for each press")
    document = diagnosed(record(drawn(seed), SLIDER, seed=seed), PARTS)
    assert (document["verdict"], document["causes"], document["remainder"]) == ("none", [], None)


@pytest.mark.parametrize("effect", ["warm_links", "warm_frame"])
def test_near_the_dead_centre_warm_links_and_a_frame_that_cools_are_one_curve(effect: str, full_torture: bool) -> None:
    """Both are found, whichever is true; which it is takes a stroke from farther up, as above."""
    if not full_torture:
        pytest.skip("takes a few seconds")
    document = diagnosed(record(with_hidden(drawn(3), effect), SLIDER, seed=3), PARTS)
    assert document["verdict"] == "one_of"
    assert sorted(document["explanations"]) == [["warm_frame"], ["warm_links"]]


@pytest.mark.parametrize("gauges", [SLIDER, (*SLIDER, *MORE["soft_frame"])], ids=["slider", "bearings"])
def test_a_soft_frame_is_one_with_a_frame_that_was_never_measured(gauges: Any, full_torture: bool) -> None:
    """It is named or not, but never another; with gauges at the bearings, the stiffness as built may stand for it.

    Gauges at the slider alone do not even part it from soft joints.
    """
    if not full_torture:
        pytest.skip("takes a few seconds for each press")
    reasons: list[str] = []
    for seed in SEEDS:
        document = diagnosed(record(with_hidden(drawn(seed), "soft_frame"), gauges, seed=seed), PARTS)
        assert "soft_frame" in document["hidden_in_tolerances"]
        assert all("soft_frame" in names for names in document["explanations"])
        reasons += document["undecided"]
    assert reasons
    assert gauges == SLIDER or all("ground_stiffness_vertical" in reason for reason in reasons)
