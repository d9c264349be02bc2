"""A whole run: what it warns of beside its studies, and what sections see of it."""

from dataclasses import replace

import pytest
from study_models import CHAIN, setup_of

from truing import Odds, Reliability, Sensitivities, Tolerance, normal
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


def test_sections_see_the_inputs_as_effects_leave_them() -> None:
    plain = setup_of(CHAIN)
    warmer = replace(plain, effects=(GROWING,), conditions={"warmth": plain.conditions["warmth"] + 10})
    record = calculate(warmer).record
    assert record.inputs == plain.inputs
    assert record.acting.first == pytest.approx(plain.inputs.first * (1 + 1e-4), rel=1e-12)
    assert calculate(plain).record.acting == plain.inputs


def test_sections_find_the_outcome_of_a_study() -> None:
    record = calculate(replace(setup_of(CHAIN), studies=(Reliability(draws=100),))).record
    assert isinstance(record.outcome(Odds), Odds)
    assert record.outcome(Sensitivities) is None
