"""What holds for sheet and example of every calculation: results, figures, and lines that can be switched on."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pytest

from drawn import draw_all, drawings
from roller_screw_shift.optimum import Shifting
from rv_gearing.groups import GroupSearch
from rv_gearing.rating import Capacity, Safeties
from rv_wear.discs import Modifications
from rv_wear.machines import NewMachines
from truing import Kernel, off
from truing.calculation import Calculation, calculate
from truing.inputs_file import setup_from_text
from truing.setup import default_setup

OFFERS = Kernel.installed(strict=True).offers
WHOLE = [
    "roller_screw_shift",
    "rv_gearing",
    "rv_wear",
    "harmonic_fractal",
    "press_linkage.motion",
    "press_linkage.loaded",
]
"""Calculations whose sections show all of their results."""


@pytest.mark.parametrize("plugin", WHOLE)
def test_every_result_stands_in_one_section(plugin: str) -> None:
    model = OFFERS[plugin].model
    named = [name for section in model.sheet for name in section.names]
    assert set(model.result_fields) == set(named)
    assert len(named) == len(set(named))


@dataclass(frozen=True, kw_only=True)
class Drawn:
    """A run that is not the default one: what is stated, its studies, names of declared ones, tolerances off."""

    plugin: str
    inputs: Mapping[str, Any] = field(default_factory=dict)
    studies: tuple[Any, ...] = ()
    declared: tuple[str, ...] = ()
    exact: tuple[str, ...] = ()

    def run(self) -> Calculation:
        model = OFFERS[self.plugin].model
        studies = (*self.studies, *(study for study in model.studies if study.name in self.declared))
        setup = default_setup(model, **self.inputs)
        spreads = {**setup.spreads, **{name: off() for name in self.exact}}
        return calculate(replace(setup, studies=studies, spreads=spreads))


GROUPS = (GroupSearch(sort_by="contact_safety_sun"), Capacity(), Safeties(over="power", at="1..4 kW", points=7))
DISCS = (Modifications(points=3), NewMachines(draws=50))
ALONE: list[tuple[Drawn, int]] = [  # without any study, and how many figures are known then
    (Drawn(plugin="press_linkage", inputs={"rod_length": "1.2 m"}), 3),
    (Drawn(plugin="roller_screw_shift"), 3),
    (Drawn(plugin="rv_gearing"), 3),
    (Drawn(plugin="rv_wear"), 4),
    (Drawn(plugin="harmonic_fractal"), 2),
    (Drawn(plugin="press_linkage.motion"), 3),
    (Drawn(plugin="press_linkage.loaded"), 2),
]
UNUSUAL: list[tuple[Drawn, int]] = [
    (Drawn(plugin="press_linkage", inputs={"crank_angle": "-60 deg", "ground_pivot_angle": "0.117 rad"},
           declared=("sweep", "sensitivity", "allocation")), 5),
    (Drawn(plugin="roller_screw_shift", inputs={"least_contact_ratio": 1.2}, studies=(Shifting(points=501),)), 8),
    # The pair of module 8 mm fits no window: no group, and nothing to draw of groups.
    (Drawn(plugin="rv_gearing", studies=GROUPS, inputs={
        "sun_teeth": 17, "planet_teeth": 103, "module": "8 mm", "helix_angle": "15.8 deg", "shift_sun": 0.145}), 4),
    (Drawn(plugin="rv_gearing", studies=GROUPS,
           inputs={"fewest_pins": 20, "most_pins": 40, "load_torque": -900.0}), 7),
    (Drawn(plugin="rv_wear", inputs={"working_time": "0 h", "phases": 4, "load_sharing": "hertz"}, studies=DISCS,
           declared=("sweep",)), 6),
    (Drawn(plugin="rv_wear", studies=DISCS, declared=("sweep",), inputs={
        "output_torque": "1 N*m", "phases": 256, "equidistant_modification": "0 um", "shift_modification": "0 um"}), 7),
    (Drawn(plugin="rv_wear", inputs={
        "pin_count": 12, "eccentricity": "5 mm", "pin_radius": "12 mm", "film_factor": 150.0}), 4),
    (Drawn(plugin="harmonic_fractal", inputs={"drive_compliance": "40 urad/(N*m)", "torque": "-25 N*m"}), 2),
    (Drawn(plugin="press_linkage.motion", declared=("sweep",), inputs={
        "times": ["0 s", "1 s", "2 s"], "start_angle": "-10 deg", "crank_speed": ["12 rpm", "0 rpm", "-12 rpm"],
        "forming_force": ["0 N", "0 N", "0 N"]}), 4),
    (Drawn(plugin="press_linkage.loaded", declared=("sweep",), exact=("joint_play", "guide_clearance"), inputs={
        "platform_guide_span": "0 m", "joint_play": "0 um", "guide_clearance": "0 um", "load_offset": "0 mm"}), 3),
]  # fmt: skip


@pytest.mark.parametrize(("drawn", "count"), ALONE, ids=lambda one: getattr(one, "plugin", str(one)))
def test_without_studies_there_are_the_figures_of_what_is_known(drawn: Drawn, count: int) -> None:
    made = drawings(drawn.run())
    assert len(made) == count, [title for title, _ in made]


@pytest.mark.parametrize(("drawn", "count"), UNUSUAL, ids=lambda one: getattr(one, "plugin", str(one)))
def test_every_figure_is_drawn_without_a_complaint(drawn: Drawn, count: int) -> None:
    titles = draw_all(drawn.run())
    assert len(titles) == count, titles


@pytest.mark.parametrize("plugin", ["press_linkage", *WHOLE[:3], *WHOLE[4:]])
def test_every_line_of_the_example_can_be_switched_on(plugin: str) -> None:
    """Inputs, tolerances, effects with their unknowns, and conditions are all named; with every effect it runs."""
    offer = OFFERS[plugin]
    model, example = offer.model, offer.model.example
    assert example is not None
    text = re.sub(r"(?m)^# (?=\[|[a-z_0-9]+ = )", "", example.read_text(encoding="utf-8"))
    unknowns = {unknown.name for effect in model.effects.values() for unknown in effect.unknowns}
    wanted = {*model.input_fields, *model.conditions, *model.tolerances, *unknowns}
    errors = {name for name in model.input_fields if re.search(r"_deviation_[12]$", name)}  # of a side of the press
    assert wanted - errors - set(re.findall(r"(?m)^(\w+) = ", text)) == set()
    setup = setup_from_text(text, offer, file="example.toml", folder=example.parent)
    assert {on.effect.name for on in setup.effects} == set(model.effects)
    answers = calculate(replace(setup, studies=())).answers
    assert any(np.isfinite(value).all() for value in answers.values())
