"""Every effect of a plugin is in the table of its theory page, and says what whoever finds it must know."""

import re
from pathlib import Path

import pytest

from truing import Kernel

OFFERS = Kernel.installed(strict=True).offers
PAGES = Path(__file__).parents[2] / "docs" / "explanation"
EFFECTS = {
    "press_linkage": 11, "roller_screw_shift": 13, "rv_gearing": 18, "rv_wear": 18, "harmonic_fractal": 20,
    "press_linkage.motion": 6, "press_linkage.loaded": 8,
}  # fmt: skip
"""How many effects each calculation has."""
WITH_EFFECTS = [name for name, offer in OFFERS.items() if name.partition(".")[0] in EFFECTS and offer.model.effects]


@pytest.mark.parametrize("plugin", EFFECTS)
def test_the_effects_are_those_of_the_page(plugin: str) -> None:
    page = (PAGES / f"{plugin.partition('.')[0]}.md").read_text(encoding="utf-8")
    effects = OFFERS[plugin].model.effects
    assert set(effects) <= set(re.findall(r"^\| `(\w+)` \|", page, re.MULTILINE))
    assert len(effects) == EFFECTS[plugin]


@pytest.mark.parametrize("plugin", EFFECTS)
def test_every_effect_says_what_it_looks_like_why_and_whence(plugin: str) -> None:
    """What is measured beside the results is one condition for all effects, with the range in which it can be set."""
    effects = OFFERS[plugin].model.effects.values()
    conditions = {need.name: need for effect in effects for need in effect.needs}
    for effect in effects:
        assert all((effect.looks_like, effect.why, effect.source)), effect.name
        assert all(unknown.note for unknown in effect.unknowns), effect.name
        for need in effect.needs:
            assert need is conditions[need.name]
            assert need.note
            assert need.low is not None
            assert need.high is not None


@pytest.mark.parametrize("calculation", WITH_EFFECTS)
def test_every_effect_says_in_one_or_two_short_sentences_what_to_do(calculation: str) -> None:
    for name, effect in OFFERS[calculation].model.effects.items():
        assert re.fullmatch(r"[A-Z][^.]*\.( [A-Z][^.]*\.)?", effect.remedy), name
        assert len(effect.remedy) <= 160, name
