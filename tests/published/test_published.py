"""Printed numbers of every calculation beside ours: as stated, and equal to what programs of others found.

The tables of others are by programs written apart from these calculations, from the same papers and standards.
"""

from dataclasses import replace
from functools import cache
from math import isfinite

import pytest

from pages import Page
from rv_gearing.published import EXAMPLE, HANDBOOK, TEXTBOOK
from truing import Kernel
from truing.calculation import calculate
from truing.published import ComparedRow, compare_published
from truing.report.html_printer import html_of
from truing.report.markdown_printer import markdown_of
from truing.report.sheet import make_sheet
from truing.runs.provenance import provenance_of
from truing.setup import default_setup

OFFERS = Kernel.installed(strict=True).offers
PRINTED = {"press_linkage": 34, "roller_screw_shift": 25, "rv_gearing": 63, "harmonic_fractal": 76}
"""How many printed numbers each calculation compares."""
STEP = 0.0025
"""Of the shifts that the reconstruction of the roller screw tried; its ends are up to one step short."""


@cache
def rows(plugin: str) -> dict[str, ComparedRow]:
    """Every printed number beside ours, by its name."""
    return {row.published.name: row for row in compare_published(OFFERS[plugin])}


@pytest.mark.parametrize("plugin", PRINTED)
def test_every_row_is_as_stated_and_what_differs_says_why(plugin: str) -> None:
    found = rows(plugin)
    assert len(found) == PRINTED[plugin]
    assert [name for name, row in found.items() if not (row.as_stated and isfinite(row.value))] == []
    assert all(row.published.why for row in found.values() if not row.matches)


# The first stage of a reducer


def test_handbook_and_textbook_are_met_as_far_as_they_are_printed() -> None:
    """Form factors and stress corrections within 0.6 %, the pair 24/77 within 0.3 %."""
    for where, count, within in ((HANDBOOK, 14, 6e-3), (TEXTBOOK, 3, 3e-3)):
        ratios = [row.ratio for row in rows("rv_gearing").values() if row.published.where == where]
        assert len(ratios) == count
        assert all(ratio is not None and abs(ratio - 1) < within for ratio in ratios)


def test_what_differs_of_the_gearing() -> None:
    found = rows("rv_gearing")
    forms = {f"Y_Fa of {teeth} teeth" for teeth in (17, 25, 35, 50, 80, 200)}
    differing = {name for name, row in found.items() if not row.matches}
    films = {f"film permitted at VG {grade}, stage {stage}" for grade in (220, 460) for stage in (5, 10)}
    films.add("film permitted at VG 100, stage 5")
    assert differing == {*forms, *films, "Y_Sa of 200 teeth", "torque of the catalogue"}
    ratios = {
        stage: [found[f"film permitted at VG {grade}, stage {stage}"].ratio or 0.0 for grade in (32, 100, 220, 460)]
        for stage in (5, 10)
    }
    Page("rv_gearing").says(
        f"{max(ratios[10]):.2f} to {min(ratios[10]):.2f} of it at stage 10 and {max(ratios[5]):.2f} to "
        f"{min(ratios[5]):.2f} at stage 5"
    )
    assert found["torque of the catalogue"].value == pytest.approx(1285.75, abs=0.01)
    assert found["groups in its table, at least"].value == 25  # of at least 22


def test_settings_of_an_example_are_said_once() -> None:
    """Sheet and its Markdown: the further rows of one example say "as above"."""
    setup = default_setup(OFFERS["rv_gearing"].model)
    calculation = calculate(replace(setup, studies=()))
    shown = [row for row in rows("rv_gearing").values() if row.published.where in {EXAMPLE, TEXTBOOK}]
    sheet = make_sheet(calculation, provenance=provenance_of(setup), verified=shown)
    for text in (html_of(sheet), markdown_of(sheet)):
        assert text.count("15.8 deg") == 1
        assert text.count("as above") == len(shown) - 2


# The roller screw


SCREW_RECONSTRUCTED = {
    "weight of the sum of the shifts": (0.5487, 5e-5),
    "weight of the stress difference": (0.0036, 5e-5),
    "weight of the sliding difference": (0.4217, 5e-5),
    "largest sum of the shifts": (0.135, 2 * STEP),
    "largest stress difference": (33.20, 0.03),
    "smallest sliding difference": (0.099, 0.005),
    "largest sliding difference": (3.034, 0.06),
    "optimal shift of the roller": (0.2525, STEP),
    "optimal shift of the ring": (-0.1175, STEP),
    "optimal shift of the roller, contact ratio 1.42": (0.2150, STEP),
    "optimal shift of the ring, contact ratio 1.42": (-0.1550, STEP),
    "optimal shift of the roller, contact ratio 1.2, sliding at the roots": (0.613, STEP),
    "optimal shift of the ring, contact ratio 1.2, sliding at the roots": (0.243, STEP),
    "shift of the roller, equal sliding alone": (0.2833, 5e-5),
    "shift of the ring, equal sliding alone": (-0.0867, 5e-5),
    "shift of the ring without backlash": (-0.16, 1e-5),
}


@pytest.mark.parametrize("name", SCREW_RECONSTRUCTED)
def test_rows_of_the_screw_are_those_of_an_independent_reconstruction(name: str) -> None:
    value, close = SCREW_RECONSTRUCTED[name]
    assert rows("roller_screw_shift")[name].value == pytest.approx(value, abs=close)
