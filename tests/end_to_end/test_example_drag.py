"""Drag of a cycloid reducer: the published record against least squares, and what a diagnosis says of it.

What every example without its record must keep is tested in ``test_opt_in_examples.py``.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from measured import Document
from numpy.typing import NDArray
from prepared import PreparedExample, Table, table_of, write

EXAMPLE = PreparedExample("cycloid_drag", "cycloid_speed_friction")
pytestmark = EXAMPLE.needs_the_record
Values = NDArray[np.float64]


@pytest.fixture(scope="module")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return EXAMPLE.desk(tmp_path_factory.mktemp("drag") / "desk", "measured.csv")


def fitted(table: Table, *, inertia: bool) -> tuple[Values, float]:
    """Least squares of dry, viscous and inertial torque on the rows to fit; the error on the others."""
    numbers = np.array([row[:4] for row in table[1:]], dtype=float)
    to_fit = np.array([row[-1] == "fit" for row in table[1:]])
    _, speed, acceleration, torque = numbers.T
    columns = np.stack([np.sign(speed), speed, acceleration][: 3 if inertia else 2], axis=1)
    sizes = np.linalg.lstsq(columns[to_fit], torque[to_fit], rcond=None)[0]
    return sizes, float(np.sqrt(np.mean((torque - columns @ sizes)[~to_fit] ** 2)))


def dry_friction(document: Document) -> dict[str, float]:
    """Dry friction as the explanation that stands first states it, in N m."""
    unknown = next(cause for cause in document["causes"] if cause["effect"] == "dry_friction")["unknowns"]["torque"]
    return {"value": unknown["value"], "low": unknown["interval95"][0], "high": unknown["interval95"][1]}


def test_the_page_prints_what_least_squares_say(desk: Path) -> None:
    page = (EXAMPLE.folder / "README.md").read_text(encoding="utf-8")
    table = table_of(desk / "measured.csv")
    sizes, error = fitted(table, inertia=False)
    assert f"| dry and viscous | {sizes[0]:.2f} N m | {sizes[1]:.3f} N m s/rad | | {error:.2f} N m |" in page
    sizes, error = fitted(table, inertia=True)
    row = f"| {sizes[0]:.2f} N m | {sizes[1]:.3f} N m s/rad | {sizes[2]:.2f} kg m² | {error:.2f} N m |"
    assert f"| dry, viscous and inertia {row}" in page


def test_dry_friction_is_in_every_explanation(desk: Path) -> None:
    document = EXAMPLE.diagnosed(desk, "measured")
    assert document["verdict"] in {"named", "one_of"}
    assert all("dry_friction" in names for names in document["explanations"])
    assert {frozenset(names) for names in document["explanations"]} <= {
        frozenset({"dry_friction"}),
        frozenset({"dry_friction", "inertia"}),  # a tenth of a newton metre; it helps on the rows held out too
    }
    size = dry_friction(document)
    sizes, error = fitted(table_of(desk / "measured.csv"), inertia=False)
    assert size["low"] < sizes[0] < size["high"]
    assert size["value"] == pytest.approx(sizes[0], abs=0.15)
    held_out = document["gain"]["torque"]["held_out"]
    assert held_out["rmse_after"]["value"] == pytest.approx(error, abs=0.03)


def test_the_viscous_part_is_calibrated_to_what_is_left(desk: Path) -> None:
    sizes, _ = fitted(table_of(desk / "measured.csv"), inertia=False)
    viscosity = EXAMPLE.diagnosed(desk, "measured")["calibrated"]["viscosity"]["value"]
    assert viscosity == pytest.approx(sizes[1], abs=0.02)


@pytest.mark.parametrize("first", [0, 1])
def test_every_second_row_says_the_same(desk: Path, first: int) -> None:
    head, *rows = table_of(desk / "measured.csv")
    write(desk / f"half_{first}.csv", [head, *rows[first::2]])
    document = EXAMPLE.diagnosed(desk, f"half_{first}")
    assert document["verdict"] in {"named", "one_of"}
    assert all("dry_friction" in names for names in document["explanations"])
    sizes, _ = fitted(table_of(desk / f"half_{first}.csv"), inertia=False)
    assert dry_friction(document)["value"] == pytest.approx(sizes[0], abs=0.2)


def test_one_way_alone_dry_friction_is_not_taken_for_an_offset(desk: Path) -> None:
    """Where the speed never changes its sign, dry friction is one curve with whatever adds a constant torque."""
    head, *rows = table_of(desk / "measured.csv")
    write(desk / "forward.csv", [head, *(row for row in rows if float(row[1]) > 0)])
    document = EXAMPLE.diagnosed(desk, "forward")
    assert document["verdict"] != "named"
    assert any("dry_friction" in names for names in document["explanations"])
