"""The conformance kit: what every calculation must keep, ours and strangers'."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from truing.declare.model import Model, Promise
from truing.testing import declared, running, sources
from truing.testing.subject import Subject, fail


@dataclass(frozen=True)
class ConformanceCheck:
    """One promise of every model: ``run`` raises AssertionError with a sentence where it is broken."""

    name: Promise
    run: Callable[[Subject], None]
    needs_run: bool = True
    needs_home: bool = False

    def obstacle(self, subject: Subject) -> str:
        """Why a model cannot be asked this, or nothing."""
        if self.needs_run and subject.obstacle:
            return f"the defaults cannot be calculated: {subject.obstacle}"
        if self.needs_home and subject.home is None:
            return "no other process could find the model: no module of its own offers it (truing_models)"
        return ""

    @property
    def promise(self) -> str:
        """What is checked, in a sentence."""
        return (self.run.__doc__ or "").partition("\n")[0]


CHECKS: tuple[ConformanceCheck, ...] = (
    ConformanceCheck("units are known", declared.units_are_known, needs_run=False),
    ConformanceCheck("defaults keep their bounds", declared.defaults_keep_their_bounds, needs_run=False),
    ConformanceCheck("finite at defaults", running.finite_at_defaults, needs_run=False),
    ConformanceCheck("goals can be read", declared.goals_can_be_read, needs_run=False),
    ConformanceCheck("spreads resolve", sources.spreads_resolve, needs_run=False),
    ConformanceCheck("printed numbers are of results", declared.printed_numbers_are_of_results, needs_run=False),
    ConformanceCheck("sheet is in order", declared.sheet_is_in_order, needs_run=False),
    ConformanceCheck("formulas have the unit", declared.formulas_have_the_unit),
    ConformanceCheck("formulas equal the function", declared.formulas_equal_the_function),
    ConformanceCheck("batch equals loop", running.batch_equals_loop),
    ConformanceCheck("steps may be halved", running.steps_may_be_halved),
    ConformanceCheck("motion is settled", running.motion_is_settled),
    ConformanceCheck("inputs untouched", running.inputs_untouched),
    ConformanceCheck("seeds decide", running.seeds_decide),
    ConformanceCheck("serial equals parallel", running.serial_equals_parallel, needs_home=True),
    ConformanceCheck("derivatives are exact", running.derivatives_are_exact),
    ConformanceCheck("bounds are answered", running.bounds_are_answered),
    ConformanceCheck("inputs survive a file", declared.inputs_survive_a_file),
    ConformanceCheck("example can be read", declared.example_can_be_read),
    ConformanceCheck("zero is the base", sources.zero_is_the_base),
    ConformanceCheck("references are neutral", sources.references_are_neutral),
    ConformanceCheck("effects act", sources.effects_act),
    ConformanceCheck("only last results are edited", sources.only_last_results_are_edited),
    ConformanceCheck("order of effects", sources.order_is_free),
)
"""Every check, in the order in which they are run."""


def conformance(model: Model[Any, Any]) -> Callable[[ConformanceCheck], None]:
    """Return a pytest test, parametrised by check: ``test_pin_wear = conformance(PIN_WEAR)``.

    What needs a running model is skipped where the defaults cannot be calculated, because one check says so already. A
    check from which the model declares an exception is expected to fail; one that is kept all the same fails.
    """
    import pytest

    subject = Subject(model)

    @pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.name)
    def test(check: ConformanceCheck) -> None:
        obstacle = check.obstacle(subject)
        if obstacle:
            pytest.skip(obstacle)
        if _is_excepted(check, subject):
            pytest.xfail(model.exceptions[check.name])

    return test


def failures(model: Model[Any, Any]) -> dict[str, str]:
    """Return the sentence of every check that the model does not pass, by the name of the check.

    Known exceptions are left out; one whose check is kept is a failure.
    """
    subject = Subject(model)
    sentences: dict[str, str] = {}
    for check in CHECKS:
        if check.obstacle(subject):
            continue
        try:
            _is_excepted(check, subject)
        except Exception as error:  # whatever a model under test raises is its failure
            sentences[check.name] = str(error)
    return sentences


def _is_excepted(check: ConformanceCheck, subject: Subject) -> bool:
    """Run a check; tell whether it fails and the model declares that it does.

    Raises what it says of another model, and AssertionError where it is kept although an exception is declared.
    """
    is_declared = check.name in subject.model.exceptions
    try:
        check.run(subject)
    except AssertionError:
        if is_declared:
            return True
        raise
    if is_declared:
        fail(
            f"{subject.model.name}: '{check.name}' holds, but the model declares a known exception from it; take the "
            "exception away"
        )
    return False
