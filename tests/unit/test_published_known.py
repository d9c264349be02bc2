"""A run that asked more than a printed number needs serves for it; one that asked less, or otherwise, does not."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest

from truing import Float, Model, Published, Sweep, found, given, inputs, results
from truing.calculation import calculate
from truing.errors import DeclarationError
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
    ("run", "load", "known", "again"),
    [
        ('["first"]', "3 kN", (FIRST, SECOND), False),
        ('["second"]', "3 kN", (FIRST, SECOND), False),
        ("[]", "3 kN", (FIRST, SECOND), False),
        ('["first", "second"]', "3 kN", (FIRST, SECOND), False),
        ('["second", "first"]', "3 kN", (FIRST, SECOND), True),
        ('["first"]', "4 kN", (FIRST, SECOND), True),
        ('["first"]', "3 kN", (SECOND,), True),
    ],
)
def test_a_known_run_serves_for_a_part_of_its_studies(
    run: str, load: str, known: tuple[Sweep, ...], again: bool
) -> None:
    model = model_asking(run)
    origin = Origin("bar", "", "", "", "entry:bar")
    made = calculate(replace(default_setup(model, origin, load=load), studies=known))
    CALLS.clear()
    (row,) = compare_published(Offer("bar", model, origin), known=made)
    assert bool(CALLS) is again
    assert row.value == pytest.approx(3.0)


@pytest.mark.parametrize(
    ("stated", "ours", "matches"),
    [
        ({"value": 1.04, "printed": "1.040"}, 1.0404, True),  # half a unit of the last digit is 0.0005
        ({"value": 1.04, "printed": "1.040"}, 1.0406, False),
        ({"value": 1.04}, 1.0406, True),  # and 0.005 where two digits are printed
        ({"value": 9.0}, 10.0, False),
        ({"value": 1206.582, "kind": "worked"}, 1206.4226, True),
        ({"value": 1206.582}, 1206.4226, False),
        ({"value": 3.127, "obtained": "calibrated"}, 3.1288, True),
        ({"value": -0.053, "obtained": "calibrated"}, -0.05375, False),
        ({"value": 100.0, "unit": "%", "kind": "probability"}, 99.67, False),  # 0.33 % of failures are none
        ({"value": 100.0, "unit": "%", "kind": "probability"}, 100.0, True),
        ({"value": 0.857, "kind": "probability"}, 0.8562, True),  # 14.4 % fail instead of 14.3 %
        ({"value": 0.9973, "kind": "probability"}, 0.99707, False),  # 0.29 % instead of 0.27 %
        ({"value": 22.0, "kind": "at_least"}, 25.0, True),
        ({"value": 22.0, "kind": "at_least"}, 21.0, False),
        ({"value": 22.0, "kind": "at_most"}, 25.0, False),
        ({"value": 0.5, "kind": "words", "within": 0.05}, 0.54, True),
        ({"value": 0.5, "kind": "words", "within": 0.05}, 0.56, False),
        ({"value": 0.5}, float("nan"), False),
    ],
)
def test_one_rule_for_each_kind_of_figure(stated: dict[str, Any], ours: float, matches: bool) -> None:
    assert Published(name="x", result="x", **stated).agrees(ours) is matches


def test_a_number_is_printed_as_it_is() -> None:
    with pytest.raises(DeclarationError, match=r"'x' is 1\.04, printed as '1\.05'"):
        Published(name="x", result="x", value=1.04, printed="1.05")
