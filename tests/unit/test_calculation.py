"""A whole run: what it warns of beside its studies."""

from dataclasses import replace

from study_models import CHAIN, setup_of

from truing import Tolerance, normal
from truing.calculation import calculate
from truing.setup import SwitchedOn

GROWING = SwitchedOn(CHAIN.effects["grow"], {"strain": 1e-5})
IDLE = "effect 'grow' is on, but 'warmth' stays at its reference: it does nothing"


def test_an_effect_that_is_on_at_its_reference_is_a_warning() -> None:
    setup = replace(setup_of(CHAIN), effects=(GROWING,))
    assert calculate(setup).warnings == (IDLE,)
    warmer = replace(setup, conditions={"warmth": setup.conditions["warmth"] + 1})
    assert calculate(warmer).warnings == ()


def test_a_condition_that_scatters_does_not_stay_at_its_reference() -> None:
    model = replace(CHAIN, errors=[*CHAIN.errors, Tolerance("warmth", normal(sd="5 K"))])
    assert calculate(replace(setup_of(model), effects=(GROWING,))).warnings == ()
