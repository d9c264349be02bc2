"""What tolerances cost is a result like any other: printed, limited, in every case."""

from __future__ import annotations

from dataclasses import replace

import pytest
from pin_wear import PIN_WEAR

from truing import Price, Require, Tolerance, normal, off, plus_minus
from truing.calculation import calculate
from truing.cases import run_cases
from truing.executors import open_executor
from truing.measurements import Case
from truing.runs.documents import results_document
from truing.runs.provenance import provenance_of
from truing.setup import default_setup

PAID = Price("40 * width**-0.5", width="N", unit="EUR")
LIMITED = replace(
    PIN_WEAR,
    errors=[
        Tolerance("load", normal(sd="3 %"), price=PAID),
        Tolerance("area", plus_minus("0.5 mm^2"), price=Price("2 / width", width="mm^2", unit="EUR")),
        Tolerance("hardness", normal(sd="6 %")),
    ],
    objectives=[Require("tolerance_price", at_most="10 EUR")],
    studies=[],
    sheet=[],
)
BAND = 6 * 0.03 * 120.0  # N: six standard deviations of 3 % of 120 N
SUM = 40 / BAND**0.5 + 2 / 1.0  # EUR: and a band of 1 mm^2


def test_the_sum_is_an_answer_and_a_check() -> None:
    found = calculate(default_setup(LIMITED))
    assert found.answers["tolerance_price"] == pytest.approx(SUM, rel=1e-12)
    (check,) = found.checks
    assert (check.name, check.unit, check.passed) == ("tolerance_price", "EUR", False)
    assert check.margin == pytest.approx((10 - SUM) / 10, rel=1e-12)


def test_the_sum_is_printed_in_the_unit_asked_for() -> None:
    setup = replace(default_setup(LIMITED), units={"tolerance_price": "kEUR"})
    document = results_document(calculate(setup), provenance_of(setup))
    assert document["results"]["tolerance_price"] == {"value": pytest.approx(SUM / 1000, rel=1e-12), "unit": "kEUR"}


def test_what_is_off_is_not_paid() -> None:
    setup = default_setup(LIMITED)
    free = replace(setup, spreads={**setup.spreads, "area": off()})
    assert calculate(free).answers["tolerance_price"] == pytest.approx(SUM - 2.0, rel=1e-12)
    assert calculate(replace(free, spreads=dict.fromkeys(setup.spreads, off()))).answers["tolerance_price"] == 0.0


def test_a_band_on_several_inputs_is_paid_once() -> None:
    both = Tolerance("both", normal(sd="3 %"), on=["load", "hardness"], price=PAID)
    model = replace(LIMITED, errors=[both])
    assert calculate(default_setup(model)).answers["tolerance_price"] == pytest.approx(40 / BAND**0.5, rel=1e-12)


def test_every_case_has_its_own_price() -> None:
    cases = [Case(1, 2, "light", {"load": 30.0}), Case(2, 3, "as it is", {"load": 120.0})]
    with open_executor("serial") as executor:
        full, table = run_cases(default_setup(LIMITED), cases, executor=executor)
    light, normal_ = (case.answers["tolerance_price"] for case in table.cases)
    assert light == pytest.approx(40 / (BAND / 4) ** 0.5 + 2, rel=1e-12)
    assert normal_ == pytest.approx(SUM, rel=1e-12)
    assert table.governing == 0
    assert full.answers["tolerance_price"] == light


def test_a_model_without_prices_has_no_such_result() -> None:
    plain = replace(LIMITED, errors=[Tolerance("load", normal(sd="3 %"))], objectives=[])
    assert "tolerance_price" not in plain.result_fields
    assert "tolerance_price" not in calculate(default_setup(plain)).answers
