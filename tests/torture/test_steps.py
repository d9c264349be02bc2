"""Numerical steps that are inputs: none moves a result by more than its sheet says, over random reducers.

Which inputs are numerical is looked at here, too: one whose name sounds so is declared (``halving``) or stands in
PHYSICAL with what it is.
"""

import re
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from rv_wear.model import RV_WEAR
from truing.evaluate import Rows, evaluate_rows
from truing.kernel import Kernel
from truing.setup import Setup, default_setup
from truing.testing.running import numerical
from truing.testing.subject import Subject
from truing.units import read_quantity

Columns = dict[str, NDArray[np.float64]]

WORDS = "step depth tolerance count grid points samples sampling phases position spacing number terms lags directions"
SOUNDS = re.compile(f"(^|_)({'|'.join(WORDS.split())})(_|$)")
PHYSICAL = {  # input: what it is
    "rv_gearing.ratio_tolerance": "a limit of the search",
    "rv_wear.pin_count": "pins of the reducer",
    "rv_wear.depth_factor": "a factor of the wear",
    "rv_wear.pin_position_error": "an error of a part",
    "rv_wear.pin_position_spread": "a spread of parts",
    "press_linkage.loaded.face_depth": "a size of the press",
    "press_linkage.loaded.bolster_depth": "a size of the press",
    "press_linkage.position_limit": "a limit",
    "press_linkage.position_goal": "a limit",
    "harmonic_fractal.sampling": "the interval of an instrument",
    "harmonic_fractal.lags": "where a curve is shown",
    "harmonic_fractal.made_flank.spacing": "the interval of an instrument",
    "harmonic_fractal.made_flank.height_step": "the resolution of an instrument",
    "harmonic_fractal.made_flank.directions": "ridges of the flank that is made",
}
OF_SUM = {"backlash": "backlash_of_wear", "backlash_gearing": "backlash_of_wear"}  # nearly cancel; the part that moves
EVER_TWO = {"rv_wear.reconstruction_depth", "rv_wear.phases"}


def test_every_input_that_sounds_like_a_step_is_one_or_says_what_it_is() -> None:
    offers = Kernel.installed().offers
    sounding = {
        f"{name}.{item.name}"
        for name, offer in offers.items()
        for item in offer.model.input_fields.values()
        if SOUNDS.search(item.name) and not item.name.startswith(("stated_",))
    }
    declared = {f"{name}.{item.name}" for name, offer in offers.items() for item in numerical(Subject(offer.model))}
    assert declared == EVER_TWO
    assert sounding - declared == set(PHYSICAL)


def random_reducers(rows: int, pins: int, rng: np.random.Generator) -> Columns:
    """Reducers of 100 to 400 mm with slim and stout pins, wide and narrow gaps, any load, new and worn out, SI."""
    circle, short = rng.uniform(0.05, 0.2, rows), rng.uniform(0.5, 0.85, rows)
    pin = circle * np.sin(np.pi / pins) * rng.uniform(0.3, 0.7, rows)
    gap = rng.uniform(1e-6, 12e-6, rows)
    highest = gap / (1 - np.sqrt(1 - short**2))
    ground = rng.uniform(-8 * gap, highest)
    load = 10 ** rng.uniform(2, 3.8, rows)
    return {
        "pin_circle_radius": circle, "eccentricity": short * circle / pins, "pin_radius": pin, "disc_width": 4 * pin,
        "equidistant_modification": ground, "shift_modification": ground - gap,
        "output_torque": load * short * pins * circle, "working_time": 3600 * 10 ** rng.uniform(1, 3.5, rows),
        "composite_roughness": 10 ** rng.uniform(-6.7, -5.9, rows),
        "reconstruction_depth": 10 ** rng.uniform(-7.5, -5.5, rows),
    }  # fmt: skip


def answers(setup: Setup, columns: Mapping[str, Any]) -> Rows:
    return evaluate_rows(setup, columns, len(columns["working_time"]))


@pytest.mark.parametrize("sharing", ["linear", "hertz"])
@pytest.mark.parametrize("wear", ["pointwise", "pitch_point"])
def test_no_step_moves_a_result_by_more_than_the_sheet_says(sharing: str, wear: str, full_torture: bool) -> None:
    rng = np.random.default_rng(7)
    rows, sizes = (120, (8, 12, 20, 30, 40, 60)) if full_torture else (8, (20, 40))
    answered = 0
    for pins in sizes:
        for phases in (4, 8, 16, 32) if full_torture else (8,):
            choices = {"pin_count": pins, "phases": phases, "load_sharing": sharing, "wear_coefficient": wear}
            setup = default_setup(RV_WEAR).changed(choices)
            columns = random_reducers(rows, pins, rng)
            before = answers(setup, columns)
            halved = columns | {"reconstruction_depth": columns["reconstruction_depth"] / 2}
            answered += compared(before, answers(setup, halved), "reconstruction_depth")
            doubled = default_setup(RV_WEAR).changed(choices | {"phases": 2 * phases})
            answered += compared(before, answers(doubled, columns), "phases")
    assert answered > (2880 if full_torture else 8)  # half of them at least


def compared(before: Rows, after: Rows, name: str) -> int:
    """How many rows both answer; none of their results has moved further than the input declares."""
    spec: Any = RV_WEAR.input_fields[name].spec
    both = ~before.failed & ~after.failed
    for result, field in RV_WEAR.own_result_fields.items():
        here, there = before.results[result][both], after.results[result][both]
        scale = np.abs(after.results[OF_SUM[result]][both] if result in OF_SUM else there)
        most = spec.halving_but.get(result)
        limit = read_quantity(most, field.unit) if most else spec.halving * scale
        moved = np.abs(here - there)
        assert np.all(moved <= limit + 1e-9 * np.abs(there)), (name, result, float(np.max(moved / np.abs(there))))
    return int(both.sum())
