"""A run that asked more than a printed number needs serves for it; one that asked less, or otherwise, does not."""

from collections.abc import Iterator
from dataclasses import replace

import pytest

from truing import Float, Model, Published, Sweep, found, given, inputs, results
from truing.calculation import calculate
from truing.kernel import Offer, Origin
from truing.published import compare_published
from truing.setup import default_setup

CALLS: list[float] = []


@inputs
class Bar:
    """A bar."""

    load: Float = given(3.0, "kN")


@results
class Stretch:
    """Its stretch."""

    length: Float = found("mm")


def stretch(bar: Bar) -> Stretch:
    """One millimetre per kilonewton."""
    CALLS.append(0.0)
    return Stretch(length=1e-6 * bar.load)


FIRST = Sweep(over="load", at="0..1 kN", points=3, name="first")
SECOND = Sweep(over="load", at="0..2 kN", points=3, name="second")


def model_asking(run: str) -> Model[Bar, Stretch]:
    row = Published(name="length", result="length", value=3.0, unit="mm", settings={"studies.run": run})
    return Model(name="bar", title="A bar", function=stretch, studies=[FIRST, SECOND], published=[row])


@pytest.fixture(autouse=True)
def forgotten() -> Iterator[None]:
    CALLS.clear()
    yield
    CALLS.clear()


@pytest.mark.parametrize(
    ("run", "load", "again"),
    [
        ('["first"]', "3 kN", False),
        ('["second"]', "3 kN", False),
        ("[]", "3 kN", False),
        ('["first", "second"]', "3 kN", False),
        ('["second", "first"]', "3 kN", True),
        ('["first"]', "4 kN", True),
    ],
)
def test_a_known_run_serves_for_a_part_of_its_studies(run: str, load: str, again: bool) -> None:
    model = model_asking(run)
    origin = Origin("bar", "", "", "", "entry:bar")
    known = calculate(replace(default_setup(model, origin, load=load), studies=(FIRST, SECOND)))
    CALLS.clear()
    (row,) = compare_published(Offer("bar", model, origin), known=known)
    assert bool(CALLS) is again
    assert row.value == pytest.approx(3.0)


def test_a_run_without_a_study_does_not_serve_for_it() -> None:
    model = model_asking('["first"]')
    origin = Origin("bar", "", "", "", "entry:bar")
    known = calculate(replace(default_setup(model, origin), studies=(SECOND,)))
    CALLS.clear()
    compare_published(Offer("bar", model, origin), known=known)
    assert CALLS
