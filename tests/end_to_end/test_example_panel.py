"""Fatigue of panels: the published record against least squares, what a diagnosis says of it."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from measured import Document
from numpy.typing import NDArray
from prepared import PreparedExample, Table, table_of, write
from scipy.optimize import minimize
from scipy.stats import norm

EXAMPLE = PreparedExample("panel_fatigue", "panel_fatigue_sn")
needs_the_record = EXAMPLE.needs_the_record


@pytest.fixture(scope="module")
def panel() -> Any:
    return EXAMPLE.plugin()


@pytest.fixture(scope="module")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return EXAMPLE.desk(tmp_path_factory.mktemp("panel") / "desk", "lives.csv")


def stated(document: Document) -> dict[str, float]:
    """The fatigue limit as every explanation that holds it alone states it: value and interval, in MPa."""
    causes = [{cause["effect"]: cause["unknowns"] for cause in document["causes"]}]
    every = causes + [other["unknowns"] for other in document["alternatives"]]
    unknown = next(item["fatigue_limit"]["stress"] for item in every if list(item) == ["fatigue_limit"])
    return {"value": unknown["value"], "low": unknown["interval95"][0], "high": unknown["interval95"][1]}


def likeliest_limit(table: Table) -> float:
    """The limit of Basquin's line over S - S_L in normal scatter, run-outs as what they are; in MPa."""
    stress, life = np.array([[float(cell) for cell in row[:2]] for row in table[1:]]).T
    is_cut = np.array([row[2] == "runout" for row in table[1:]])

    def cost(unknowns: NDArray[np.float64]) -> float:
        level, exponent, limit, log_sd = unknowns
        if limit >= stress.min():
            return np.inf
        left = (life - level + exponent * np.log10((stress - limit) / (300 - limit))) / np.exp(log_sd)
        return -float(norm.logpdf(left[~is_cut]).sum() - (~is_cut).sum() * log_sd + norm.logsf(left[is_cut]).sum())

    return float(minimize(cost, [6.3, 6.0, 150.0, -1.6], method="Nelder-Mead", options={"maxiter": 9999}).x[2])


@pytest.mark.parametrize(("stress", "limit"), [(270.0, 200.0), (380.0, 200.0), (300.0, 120.0)])
def test_a_limit_is_the_stress_that_counts_as_none(panel: Any, stress: float, limit: float) -> None:
    """Basquin's line over S - S_L: with the slope of the tangent at the usual stress and the same level there."""
    life = panel.panel_fatigue(panel.PANEL_FATIGUE.inputs(stress=stress * 1e6, limit=limit * 1e6, exponent=5.0))
    assert life.log_life == pytest.approx(6.2 - 5 * np.log10((stress - limit) / (300 - limit)), rel=1e-12)


@needs_the_record
def test_the_record_is_the_published_one() -> None:
    rows = table_of(EXAMPLE.record)[1:]
    stresses = [row[0] for row in rows]
    assert {stress: stresses.count(stress) for stress in stresses} == dict.fromkeys(
        ["380", "340", "300", "280", "270"], 25
    )
    unbroken = [row[0] for row in rows if row[2] == "runout"]
    assert (unbroken.count("280"), unbroken.count("270"), len(unbroken)) == (2, 8, 10)


@needs_the_record
def test_a_fatigue_limit_is_among_the_explanations_and_its_size_the_likeliest(desk: Path) -> None:
    document = EXAMPLE.diagnosed(desk, "lives")
    assert document["verdict"] in {"one_of", "named"}
    assert ["fatigue_limit"] in document["explanations"]
    size = stated(document)
    by_hand = likeliest_limit(table_of(desk / "lives.csv"))
    assert by_hand == pytest.approx(210, abs=1)
    assert size["low"] < by_hand < size["high"]
    assert size["value"] == pytest.approx(by_hand, abs=5)
    assert ["static_strength"] not in document["explanations"]  # it bends the line the other way
    assert ["grip_bending"] not in document["explanations"]
    assert any(note.startswith("10 of 125 readings of 'log_life' are censored") for note in document["notes"])


@needs_the_record
def test_a_run_out_is_no_failure_at_its_last_cycle(desk: Path, tmp_path: Path) -> None:
    """Taken for failures the ten put the limit lower: 201 MPa by least squares."""
    other = EXAMPLE.desk(tmp_path / "desk", "lives.csv")
    broken = (other / "inputs.toml").read_text(encoding="utf-8").replace("at_least", "# at_least")
    (other / "inputs.toml").write_text(broken, encoding="utf-8")
    honest = stated(EXAMPLE.diagnosed(desk, "lives"))["value"]
    assert stated(EXAMPLE.diagnosed(other, "lives"))["value"] < honest - 5


@needs_the_record
@pytest.mark.parametrize("seed", [2, 3])
def test_the_order_of_the_rows_does_not_matter(desk: Path, seed: int) -> None:
    head, *rows = table_of(desk / "lives.csv")
    random.Random(seed).shuffle(rows)
    write(desk / f"again_{seed}.csv", [head, *rows])
    first, again = EXAMPLE.diagnosed(desk, "lives"), EXAMPLE.diagnosed(desk, f"again_{seed}")
    assert again["verdict"] == first["verdict"]
    assert again["explanations"] == first["explanations"]
    assert stated(again)["value"] == pytest.approx(stated(first)["value"], rel=0.05)


@needs_the_record
def test_a_table_sorted_by_life_has_no_other_cause(desk: Path) -> None:
    head, *rows = table_of(desk / "lives.csv")
    write(desk / "sorted.csv", [head, *sorted(rows, key=lambda row: (-float(row[0]), float(row[1])))])
    document = EXAMPLE.diagnosed(desk, "sorted")
    assert document["remainder"] is None or "order" not in document["remainder"]["depends_on"]
    assert document["verdict"] != "unknown"


@needs_the_record
def test_a_load_cell_is_not_hundreds_of_megapascals_off(desk: Path) -> None:
    """It is declared to be off by 10 MPa at the most, and would have to be by 300."""
    assert ["load_cell_zero"] not in EXAMPLE.diagnosed(desk, "lives")["explanations"]


@needs_the_record
def test_every_second_row_says_nothing_against_the_limit(desk: Path) -> None:
    head, *rows = table_of(desk / "lives.csv")
    write(desk / "half.csv", [head, *rows[::2]])
    document = EXAMPLE.diagnosed(desk, "half")
    assert ["fatigue_limit"] in document["explanations"] or document["verdict"] in {"none", "undecided"}
