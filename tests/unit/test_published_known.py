"""A run that asked more than a printed number needs serves for it; one that asked less, or otherwise, does not."""

from dataclasses import replace
from functools import wraps
from typing import Any

import pytest
from study_models import CHAIN, Chain, Gap, chain

from truing import Model, Published, Sweep
from truing.calculation import calculate
from truing.errors import DeclarationError
from truing.kernel import Offer, Origin
from truing.published import compare_published
from truing.setup import default_setup

CALLS: list[float] = []


@wraps(chain)
def counted(sizes: Chain) -> Gap:
    """The dimension chain, which notes that it was calculated."""
    CALLS.append(0.0)
    return chain(sizes)


FIRST = Sweep(over="second", at="0..1 mm", points=3, name="sweep_1")
SECOND = Sweep(over="second", at="0..2 mm", points=3, name="sweep_2")


def model_asking(run: str) -> Model[Chain, Gap]:
    row = Published(name="gap", result="gap", value=10.0, unit="mm", settings={"studies.run": run})
    return replace(CHAIN, function=counted, studies=[FIRST, SECOND], published=[row])


@pytest.mark.parametrize(
    ("run", "first", "known", "again"),
    [
        ('["sweep_1"]', "30 mm", (FIRST, SECOND), False),
        ('["sweep_2"]', "30 mm", (FIRST, SECOND), False),
        ("[]", "30 mm", (FIRST, SECOND), False),
        ('["sweep_1", "sweep_2"]', "30 mm", (FIRST, SECOND), False),
        ('["sweep_2", "sweep_1"]', "30 mm", (FIRST, SECOND), True),
        ('["sweep_1"]', "40 mm", (FIRST, SECOND), True),
        ('["sweep_1"]', "30 mm", (SECOND,), True),
    ],
)
def test_a_known_run_serves_for_a_part_of_its_studies(
    run: str, first: str, known: tuple[Sweep, ...], again: bool
) -> None:
    model = model_asking(run)
    origin = Origin("chain", "", "", "", "entry:chain")
    made = calculate(replace(default_setup(model, origin, first=first), studies=known))
    CALLS.clear()
    (row,) = compare_published(Offer("chain", model, origin), known=made)
    assert bool(CALLS) is again
    assert row.value == pytest.approx(10.0)


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
