"""What is stated of the paper's numbers, and the figures beside which no row may be worse.

The reference reproduction of this paper, ours over the paper's, row by row. Where a row cannot be as near with the
zones and scatters stated, the bound is ours and the reason stands beside it.
"""

from itertools import pairwise
from math import isfinite

import pytest

from rv_wear.published import PUBLISHED
from truing import Kernel
from truing.published import ComparedRow, compare_published

# Largest distance of the ratio from 1.
REFERENCE = {
    **{f"sensitivity index {number}": 0.0095 for number in range(1, 17)},
    "largest equidistant modification": 0.0096,
    "smallest equidistant modification": 0.0143,
    "deepest wear after 6000 h": 0.001,
    "deepest wear at optimum 1": 0.001,
    "deepest wear at optimum 2": 0.0012,
    "force falls with the modification": 0.0,
    "contact widens with the modification": 0.0,
    "wear falls with the modification": 0.0,
    "wear to 3000 h within the 95 % band": 0.0,
    "mean backlash, unworn": 0.0025,
    "share below 1 arcmin, unworn": 0.0,
    "cost before optimisation": 0.001,
    "least cost at optimum 1": 0.0355,
    # The wear scatters by 1.3 % here, by 2 % in the reference, which has 1.007.
    "reliability after 6000 h": 0.0078,
}


@pytest.fixture(scope="module")
def rows() -> dict[str, ComparedRow]:
    """Every printed number beside ours."""
    found = compare_published(Kernel.installed().offers["rv_wear"])
    return {row.published.name: row for row in found}


def test_every_row_is_as_stated_and_has_a_number(rows: dict[str, ComparedRow]) -> None:
    assert len(rows) == len(PUBLISHED)
    assert all(row.as_stated and isfinite(row.value) for row in rows.values())


@pytest.mark.parametrize("name", REFERENCE)
def test_no_row_is_farther_from_the_paper(rows: dict[str, ComparedRow], name: str) -> None:
    ratio = rows[name].ratio
    assert ratio is not None
    assert abs(ratio - 1) <= REFERENCE[name] + 1e-9


def test_the_knee_is_shown_as_not_reproduced(rows: dict[str, ComparedRow]) -> None:
    """With zones up to twice as wide the knee is cheaper and wears more than the paper's choice."""
    knees = {name: row for name, row in rows.items() if "knee" in name}
    assert len(knees) == 4
    for name, row in knees.items():
        assert not row.matches
        assert "not reproduced" in row.published.why
        assert row.ratio is not None
        assert (row.ratio < 0.9) if name.startswith("cost") else (1.02 < row.ratio < 1.03)


def test_the_two_optima_cost_more_here_than_printed(rows: dict[str, ComparedRow]) -> None:
    for number, most in ((1, 1.0355), (2, 1.06)):
        row = rows[f"least cost at optimum {number}"]
        assert not row.matches
        assert row.ratio is not None
        assert 1.03 < row.ratio < most


def test_the_reliability_falls_visibly_only_after_4000_h(rows: dict[str, ComparedRow]) -> None:
    shares = [rows[f"reliability after {hours} h"].value for hours in (3000, 4000, 6000)]
    assert shares[0] == pytest.approx(99.98, abs=0.02)
    assert shares[1] == pytest.approx(99.7, abs=0.1)
    assert all(later < earlier for earlier, later in pairwise(shares))


def test_what_was_chosen_to_fit_is_marked(rows: dict[str, ComparedRow]) -> None:
    calibrated = {name for name, row in rows.items() if row.published.obtained == "calibrated"}
    assert {
        "deepest wear after 6000 h", "mean backlash, unworn", "reliability after 6000 h", "cost before optimisation",
        "deepest wear at optimum 1", "deepest wear at optimum 2", "smallest equidistant modification",
        *(f"sensitivity index {number}" for number in (1, 2, 4, 14, 16)),
    } == calibrated  # fmt: skip
    assert all(rows[name].published.why for name in calibrated)
