"""Bands of all 29 sources over a stroke: closed form at one angle, optimality by multipliers, and machines.

References: the Lagrangian of one limit in closed form; non-negative multipliers by another algorithm; the exact
geometry of ``hidden_effects/press_machine.py``, which shares nothing with the plugin.
"""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import nnls

from hidden_effects import press_machine
from press_linkage.errors import SOURCES
from press_linkage.model import PRESS_LINKAGE
from press_linkage.over_the_stroke import (
    EVERY,
    SIGMAS,
    OverTheStroke,
    cheapest,
    of_kinds,
    of_sources,
    relative,
)
from press_linkage.quantities import Press
from truing.calculation import calculate
from truing.setup import default_setup

ANGLES = np.radians(np.linspace(-30.0, 10.0, 9))
PRICES = np.linspace(1.0, 3.0, len(EVERY))
WIDE = (np.full(len(EVERY), 1e-9), np.full(len(EVERY), 1.0))
GOALS = {"position": 0.88, "tilt": 0.95}


def test_at_one_angle_with_one_limit_the_bands_are_those_of_the_lagrangian() -> None:
    """A band is in proportion to the cube root of its price over its part of the variance; z of 95 % is 1.959964."""
    slopes = {"tilt": relative(Press(), np.zeros(1), "tilt") / 2.3e-5}
    parts = of_kinds((slopes["tilt"][0] / SIGMAS) ** 2) * 1.959963985**2
    counts = parts > 1e-3 * parts.max()  # the driven chain does not tilt the slider
    bands = cheapest(slopes, {"tilt": 0.95}, PRICES, (np.full(15, 1e-9), np.full(15, 1e-2)))
    shape = np.where(counts, (PRICES / np.where(counts, parts, 1.0)) ** (1 / 3), 0.0)
    assert bands[counts] == pytest.approx((shape / np.sqrt(parts @ shape**2))[counts], rel=1e-3)
    assert bands[~counts] == pytest.approx(1e-2)


def test_over_a_stroke_no_exchange_of_bands_is_cheaper() -> None:
    """What a wider band saves is balanced by multipliers of the limits, none of them negative."""
    press = Press()
    slopes = {of: relative(press, ANGLES, of) / limit for of, limit in (("position", 2e-5), ("tilt", 2.3e-5))}
    bands = cheapest(slopes, GOALS, PRICES, WIDE)
    z = {"position": 1.554773595, "tilt": 1.959963985}
    weights = np.concatenate([of_kinds((slopes[of] / SIGMAS) ** 2) * z[of] ** 2 for of in slopes])
    used = weights @ bands**2
    assert np.max(used) == pytest.approx(1.0, abs=1e-6)
    saved = PRICES / bands
    active = used > 1.0 - 1e-5
    _, left = nnls((2 * weights[active] * bands**2).T / saved[:, np.newaxis], np.ones(len(EVERY)))
    assert left < 0.01


def test_the_machines_of_a_press_apart_keep_the_limits_as_often() -> None:
    setup = replace(default_setup(PRESS_LINKAGE), studies=(OverTheStroke(points=9, draws=4000),))
    found: Any = calculate(setup).outcomes["over_the_stroke"]
    draws = 4000
    rng = np.random.default_rng(8)
    for title, bands in found.bands.items():
        off = rng.standard_normal((draws, len(SOURCES))) * (of_sources(bands) / SIGMAS)
        within = {"position": np.ones(draws, bool), "tilt": np.ones(draws, bool)}
        sizes = press_machine.built({name: off[:, place] for place, name in enumerate(SOURCES)})
        for angle in ANGLES:
            there = press_machine.slider(np.full(draws, angle), sizes)
            right = press_machine.slider(np.array([angle]), press_machine.built({}))
            within["position"] &= np.abs(there["slider_position"] - right["slider_position"]) <= 2e-5
            within["tilt"] &= np.abs(there["slider_tilt"]) <= np.radians(0.0013)
        for of, fits in within.items():
            share = found.chances[title][of][1]
            scatter = np.sqrt(2 * max(share * (1 - share), 1e-3) / draws)
            assert float(fits.mean()) == pytest.approx(share, abs=3.5 * scatter), (title, of)
    for of, goal in GOALS.items():
        assert found.chances["stroke"][of][1] > goal - 0.02
    assert found.chances["dead centre"]["position"][1] < 0.8
    assert found.costs["dead centre"] < found.costs["stroke"]


def test_no_band_is_tighter_than_may_be_bought_and_a_goal_missed_is_said() -> None:
    """With 0.8 times the bands in force no goal can be had over a stroke; that of the position needs 0.41 times."""
    setup = replace(default_setup(PRESS_LINKAGE), studies=(OverTheStroke(points=9, draws=4000, tightest=0.8),))
    found: Any = calculate(setup).outcomes["over_the_stroke"]
    assert np.min(found.bands["stroke"] / found.bands["in force"]) == pytest.approx(0.8)
    assert found.chances["stroke"]["position"][1] < GOALS["position"]
    assert "do not reach the goal of position" in found.shown()[0].text


def test_the_theory_page_says_what_the_designs_cost_and_keep() -> None:
    page = (Path(__file__).parents[2] / "docs" / "explanation" / "press_linkage.md").read_text(encoding="utf-8")
    setup = replace(default_setup(PRESS_LINKAGE), studies=(OverTheStroke(),))
    found: Any = calculate(setup).outcomes["over_the_stroke"]
    titles = ("bands of Table 3", "least cost for the dead centre", "least cost for the stroke")
    for title, key in zip(titles, found.bands, strict=True):
        row = next(line for line in page.splitlines() if line.startswith(f"| {title} |"))
        cells = [float(cell.strip(" %")) for cell in row.split("|")[2:6]]
        kept = [100 * found.chances[key]["position"][place] for place in (0, 1)]
        assert cells[0] == pytest.approx(found.costs[key], abs=1.0)
        assert cells[1:3] == pytest.approx(kept, abs=1.0)
        assert cells[3] == pytest.approx(100 * found.chances[key]["tilt"][1], abs=1.0)
