"""Units on the sheet: what is stated keeps its unit, and one word brings all that people read to SI or to inches."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from diagnosis_samples import named
from hypothesis import given as drawn
from hypothesis import strategies as st
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from truing import (
    Float,
    Maximise,
    Model,
    Price,
    Require,
    Sensitivity,
    Tolerance,
    Vary,
    found,
    given,
    normal,
    plus_minus,
)
from truing import inputs as declared_inputs
from truing import results as declared_results
from truing.api.model import LoadedModel
from truing.calculation import calculate
from truing.errors import InputError, UsageError
from truing.inputs_file import read_setup, setup_from_text
from truing.kernel import Kernel, Offer, Origin
from truing.report.diagnosis_sheet import make_diagnosis_sheet
from truing.report.document import Chapter, Document, Head, ResultEntry, TableView, plain_text
from truing.report.figure_units import brought_over
from truing.report.sheet import make_sheet
from truing.report.sheet_units import SheetUnits, as_printed
from truing.runs.comparison import compared
from truing.runs.documents import results_document
from truing.runs.inputs_written import complete_inputs, input_hash
from truing.runs.provenance import Provenance, provenance_of
from truing.setup import Setup
from truing.studies.sweep import Sweep
from truing.units import from_si, meaning, same_dimension, to_si
from truing.units.systems import UNIT_SYSTEMS, UnitSystem, in_system

POUND_FORCE = 0.45359237 * 9.80665  # N, exact: the international pound at standard gravity
INCH = 0.0254  # m, exact
BTU = 1055.056  # J, ISO 31-4

COUNTERPARTS = [
    ("mm", 1, "in", INCH), ("um", 1, "uin", 1e-6 * INCH), ("m", 1, "ft", 12 * INCH), ("mm^2", 1, "in^2", INCH**2),
    ("N", 1, "lbf", POUND_FORCE), ("kN", 1, "lbf", POUND_FORCE), ("N*m", 1, "lbf*ft", POUND_FORCE * 12 * INCH),
    ("N*mm", 1, "lbf*in", POUND_FORCE * INCH), ("mN*m", 1, "lbf*in", POUND_FORCE * INCH),
    ("MPa", 1, "ksi", 1000 * POUND_FORCE / INCH**2), ("N/mm^2", 1, "ksi", 1000 * POUND_FORCE / INCH**2),
    ("bar", 1, "psi", POUND_FORCE / INCH**2), ("GPa", 1, "Mpsi", 1e6 * POUND_FORCE / INCH**2),
    ("N/um", 1, "lbf/in", POUND_FORCE / INCH), ("um/N", 1, "uin/lbf", 1e-6 * INCH / POUND_FORCE),
    ("kg", 1, "lb", 0.45359237), ("kg*m^2", 1, "lb*ft^2", 0.45359237 * (12 * INCH) ** 2),
    ("kW", 1, "hp", 550 * 12 * INCH * POUND_FORCE), ("J", 1, "ft*lbf", 12 * INCH * POUND_FORCE), ("kJ", 1, "BTU", BTU),
    ("W/(m*K)", 1, "BTU/(h*ft*delta_degF)", BTU / (3600 * 12 * INCH * 5 / 9)),
    ("l/min", 1, "gal/min", 231 * INCH**3 / 60),
    ("K", 1, "delta_degF", 5 / 9), ("um/K", 1, "uin/delta_degF", 1e-6 * INCH * 9 / 5), ("m/s", 1, "ft/s", 12 * INCH),
    ("mm^3/(N*m)", 1, "in^3/(lbf*ft)", INCH**3 / (POUND_FORCE * 12 * INCH)),
]  # fmt: skip
"""A unit, and its counterpart with its size in SI from the definitions of inch, pound and BTU."""
WITHOUT = ["deg", "rad", "arcmin", "rpm", "Hz", "s", "h", "V", "A", "%", "", "EUR", "kWh", "Pa*s", "mPa*s"]


@pytest.mark.parametrize(("unit", "_", "counterpart", "size"), COUNTERPARTS)
def test_a_unit_has_the_counterpart_of_the_definition(unit: str, _: int, counterpart: str, size: float) -> None:
    assert in_system(unit, "inch") == counterpart
    assert to_si(1.0, counterpart) == pytest.approx(size, rel=1e-12)


@pytest.mark.parametrize("unit", WITHOUT)
def test_what_has_no_counterpart_stays(unit: str) -> None:
    assert [in_system(unit, system) for system in UNIT_SYSTEMS] == [unit, unit]


def test_levels_and_differences_of_temperature() -> None:
    assert (in_system("degC", "inch"), in_system("degF", "SI")) == ("degF", "degC")
    assert from_si(to_si(np.array([-40.0, 0.0, 100.0]), "degC"), "degF") == pytest.approx([-40.0, 32.0, 212.0])
    assert from_si(to_si(5.0, "K"), "delta_degF") == pytest.approx(9.0)


@drawn(st.lists(st.tuples(st.sampled_from(["mm", "um", "N", "kN", "kg", "K", "MPa", "s", "rad", "W", "J", "m"]),
                          st.sampled_from([-2, -1, 1, 2])), min_size=1, max_size=4),
       st.floats(1e-3, 1e3), st.sampled_from(UNIT_SYSTEMS))  # fmt: skip
def test_any_product_keeps_its_kind_and_comes_back(
    factors: list[tuple[str, int]], number: float, system: UnitSystem
) -> None:
    unit = "*".join(f"{name}^{exponent}" for name, exponent in dict(factors).items())
    shown = in_system(unit, system)
    back = in_system(in_system(unit, "inch"), "SI")
    assert same_dimension(shown, unit)
    assert same_dimension(back, unit)
    assert in_system(shown, system) == shown
    si = to_si(number, unit)
    assert to_si(float(from_si(si, shown)), shown) == pytest.approx(si, rel=1e-12)


SENTENCES = [
    ("worn by 2 mm.", "worn by 0.07874 in."), ("12.345 mm", "0.48602 in"), ("±0.05 mm", "±0.001969 in"),
    ("zone -5 um .. 5 um", "zone −196.9 µin .. 196.9 µin"), ("P(stress ≤ 80 MPa)", "P(stress ≤ 11.6 ksi)"),
    ("0 to 25.4 mm", "0 to 1 in"), ("at 25 N m.", "at 18.44 lbf·ft."),
    ("10, 12 and 15 mm", "0.3937, 0.4724 and 0.5906 in"),
    ("10-20 µm", "393.7-787.4 µin"),
    ("(12.34 ± 0.40) µm, k = 2", "(485.8 ± 15.75) µin, k = 2"), ("Figure 3, 12 µm deep", "Figure 3, 472.4 µin deep"),
    ("3.8 µm per K", "83.11 µin per Δ°F"), ("3.8 µm per row", "149.6 µin per row"), ("±2 °C", "±3.6 Δ°F"),
    ("at 20 °C", "at 68 °F"), ("1.2 × 10⁻³ mm", "4.724 × 10⁻⁵ in"),
    ("M8 x 1.25, 3 of 4, 5 A, 7 h", "M8 x 1.25, 3 of 4, 5 A, 7 h"),
]  # fmt: skip


@pytest.mark.parametrize(("said", "expected"), SENTENCES)
def test_quantities_in_a_sentence_are_brought_over_and_words_stay(said: str, expected: str) -> None:
    assert SheetUnits("inch").said(said) == expected
    assert SheetUnits("").said(said) == said


def test_a_word_that_is_a_unit_too_stays_and_a_unit_by_hand_wins() -> None:
    assert SheetUnits("SI").said("4 in all, 5 in, 63 lbf·ft") == "4 in all, 127 mm, 85.42 N·m"
    assert SheetUnits("inch", frozenset({"mm"})).said("2 mm and 3 N") == "2 mm and 0.6744 lbf"


# A small machine with every kind of quantity


@declared_inputs
class Shaft:
    """A shaft that is turned and heated."""

    torque: Float = given(100.0, "N*m", symbol="T", note="torque", above=0)
    diameter: Float = given(40.0, "mm", symbol="d", note="diameter", above=0)
    room: Float = given(20.0, "degC", symbol="theta_0", note="room temperature")
    heating: Float = given(15.0, "K", symbol="Delta theta", note="heating by friction")
    permitted: Float = given(120.0, "N*m", symbol="T_per", note="permitted torque")


@declared_results
class Loaded:
    """What comes of it."""

    stress: Float = found("MPa", symbol="tau", formula="16 * torque / (pi * diameter**3)", note="shear stress")
    oil: Float = found("degC", symbol="theta", formula="room + heating", note="oil temperature")
    turned: Float = found("N*m", symbol="T_2", formula="1.2 * torque", note="torque with the factor")
    growth: Float = found("um", symbol="g", formula="12e-6 / 1 * diameter * 15", note="growth")


def turn(shaft: Shaft) -> Loaded:
    """Turn it; every field is a number or an array (n,)."""
    return Loaded(
        stress=16 * shaft.torque / (np.pi * shaft.diameter**3), oil=shaft.room + shaft.heating,
        turned=1.2 * shaft.torque, growth=12e-6 * shaft.diameter * 15,
    )  # fmt: skip


SHAFT = Model(
    name="shaft", title="A shaft", function=turn,
    errors=[
        Tolerance("diameter", plus_minus("0.05 mm"), why="turned",
                  price=Price("4 * width**-0.5", width="mm", unit="EUR")),
        Tolerance("room", normal(sd="2 K"), why="workshop"), Tolerance("torque", normal(sd="3 %"), why="motor"),
    ],
    objectives=[
        Vary("diameter", "30 mm", "60 mm"), Maximise("torque"), Require("stress", at_most="30 MPa"),
        Require("oil", at_most="50 degC"), Require("turned", at_most="permitted"), Require("growth", at_most="0.02 mm"),
    ],
    studies=[Sensitivity(), Sweep(over="diameter", at="30..60 mm", points=7)],
)  # fmt: skip
OFFER = Offer("shaft", SHAFT, Origin("shaft", "1.0", "", "", "entry:shaft"))


def read(text: str) -> Setup:
    return setup_from_text(text, OFFER, file="shaft.toml", folder=Path())


def document(setup: Setup) -> Document:
    return make_sheet(calculate(setup), provenance=provenance_of(setup, date="2026-11-26"), example=read(""))


def table(sheet: Document, kind: str) -> TableView:
    blocks = [block for chapter in (*sheet.front, *sheet.chapters) for block in chapter.blocks]
    return next(block for block in blocks if isinstance(block, TableView) and block.kind == kind)


def row(view: TableView, name: str) -> dict[str, str]:
    cells = next(cells for cells in view.rows if f"({name})" in plain_text(cells[1 if view.kind != "checks" else 0]))
    return {column.title: plain_text(cell) for column, cell in zip(view.columns, cells, strict=True)}


STATED = '[inputs]\ntorque = "63 lbf*ft"\npermitted = "80 lbf*ft"\ndiameter = "40 mm"\nroom = "68 degF"\n'


def test_the_unit_that_is_stated_is_shown_with_that_of_the_model_beside_it() -> None:
    sheet = document(read(STATED))
    stated = row(table(sheet, "inputs"), "torque")
    assert (stated["Value"], stated["Unit"], stated["In the model"]) == ("63", "lbf·ft", "85.417 N·m")
    assert row(table(sheet, "inputs"), "room")["In the model"] == "20 °C"
    assert row(table(sheet, "inputs"), "diameter")["In the model"] == ""
    changed = row(next(c for c in sheet.front if c.ident == "changes").blocks[0], "torque")  # type: ignore[arg-type]
    assert changed["Value"] == "63 lbf·ft = 85.417 N·m"
    assert row(table(sheet, "checks"), "turned")["Limit"] == "80 lbf·ft = 108.47 N·m"
    assert "In the model" not in [column.title for column in table(document(read("")), "inputs").columns]


def test_what_is_stated_survives_in_results_json_and_in_the_inputs_of_the_run(tmp_path: Path) -> None:
    setup = read(STATED)
    said = results_document(calculate(setup), provenance_of(setup))["inputs"]["torque"]
    assert said["stated"] == {"value": 63.0, "unit": "lbf*ft"}
    assert (said["unit"], said["value"]) == ("N*m", pytest.approx(63 * POUND_FORCE * 12 * INCH, rel=1e-12))
    again = read(complete_inputs(setup, tmp_path))
    assert again.source.units == setup.source.units == {"torque": "lbf*ft", "permitted": "lbf*ft", "room": "degF"}
    assert input_hash(again) == input_hash(setup) == input_hash(read(complete_inputs(again, tmp_path)))


def test_the_same_value_in_another_unit_is_no_difference() -> None:
    inches, metres = (read(f'[inputs]\ndiameter = "{text}"\n') for text in ("2 in", "50.8 mm"))
    documents = [results_document(calculate(setup), provenance_of(setup)) for setup in (inches, metres)]
    assert "stated" in documents[0]["inputs"]["diameter"]
    assert [change for change in compared(*documents) if change.kind == "inputs"] == []


def test_a_workbook_and_python_state_units_too(tmp_path: Path) -> None:
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.active.title = "inputs"
    for cells in (("name", "value", "unit"), ("torque", 63, "lbf*ft"), ("sheet.units", "inch", None)):
        book.active.append(cells)
    book.save(tmp_path / "shaft.xlsx")
    setup = read_setup(tmp_path / "shaft.xlsx", OFFER)
    assert (setup.source.units, setup.sheet.units) == ({"torque": "lbf*ft"}, "inch")
    model = LoadedModel(OFFER, text=("", "shaft.toml", tmp_path))
    stated = model.setup(torque="63 lbf*ft", units="inch")
    assert (stated.source.units, stated.sheet.units) == ({"torque": "lbf*ft"}, "inch")
    assert model.given(torque="63 lbf*ft").setup().source.units == {"torque": "lbf*ft"}


# One word


SI_UNITS = re.compile(r"(?<![\w/])(?:[munkc]?m|MPa|GPa|kPa|Pa|bar|k?N|°C|kg|k?W|J|K)[²³⁴]?(?![\w])")
SI_LENGTHS = re.compile(r"(?<![\w/])[munkcµ]?m[²³⁴]?(?!\w)")
INCH_UNITS = re.compile(r"(?<!\w)(?:µin|ft|lbf|psi|ksi|Mpsi|°F|Δ°F|lb|hp)[²³⁴]?(?!\w)|\d in\b|^in[²³⁴]?$")
WRITTEN_BY_HAND = {"Source", "Why", "Input", "Result", "Check", "Quantity", "Where"}
"""Columns with the words of the model's author."""


def texts(value: Any) -> Iterator[str]:
    """Give the numbers with their units, headings and sentences of a document, but not the author's own words.

    A formula that holds in certain units only ends in these, and then in those of the sheet.
    """
    author = isinstance(value, Chapter) and value.title in {"Findings", "References"}
    if isinstance(value, (Head, Provenance)) or author:
        return
    if isinstance(value, str):
        yield value
    elif isinstance(value, tuple):
        for each in value:
            yield from texts(each)
    elif isinstance(value, TableView):
        shown = [index for index, column in enumerate(value.columns) if column.title not in WRITTEN_BY_HAND]
        yield from texts((value.title, value.note, *(column.unit for column in value.columns)))
        yield from (plain_text(cells[index]) for cells in value.rows for index in shown)
    elif isinstance(value, ResultEntry):
        results = value.equation.results if value.equation is not None else ()
        numbers = value.equation.numbers if value.equation is not None else {}
        yield from (plain_text(value.value), *(plain_text(each) for each in results[-1:]))
        yield from (unit for _, unit in (numbers or {}).values())
    elif is_dataclass(value) and not isinstance(value, type):
        yield from texts(
            tuple(getattr(value, each.name) for each in fields(value) if each.name not in {"svg", "summary"})
        )


@pytest.mark.parametrize("word", ["inch", "SI"])
def test_no_unit_of_the_other_system_is_left_on_a_sheet(word: str) -> None:
    foreign, own = (SI_UNITS, INCH_UNITS) if word == "inch" else (INCH_UNITS, SI_UNITS)
    said = list(texts(document(read(f'[sheet]\nunits = "{word}"\ndetail = "full"\n{STATED}'))))
    assert [text for text in said if foreign.search(text)] == []
    assert len([text for text in said if own.search(text)]) > 30


@pytest.mark.parametrize("name", ["rv_gearing", "harmonic_fractal"])
def test_no_si_length_is_left_on_an_inch_sheet_of_a_shipped_model(name: str) -> None:
    offer = Kernel.installed().offer(name)
    assert offer.model.example is not None
    overrides = ["sheet.units=inch", "sheet.detail=full", "studies.run=[]"]
    said = list(texts(document_of(read_setup(offer.model.example, offer, overrides=overrides))))
    assert [text for text in said if SI_LENGTHS.search(text)] == []
    assert len([text for text in said if re.search(r"(?<!\w)(µin|in)[²³⁴]?(?!\w)", text)]) > 10


@declared_inputs
class Lever:
    """A lever that is declared in inches."""

    force: Float = given(20.0, "lbf", symbol="F", note="force")
    arm: Float = given(10.0, "in", symbol="a", note="arm")
    oil: Float = given(212.0, "degF", symbol="theta", note="oil")


@declared_results
class Turned:
    """What it does."""

    torque: Float = found("lbf*ft", symbol="T", formula="force * arm", note="torque")


def lever(lever: Lever) -> Turned:
    """Pull it; every field is a number or an array (n,)."""
    return Turned(torque=lever.force * lever.arm)


def test_a_plugin_that_is_declared_in_inches_has_a_sheet_in_si() -> None:
    model = Model(name="lever", title="A lever", function=lever, objectives=[Require("torque", at_most="20 lbf*ft")])
    offer = Offer("lever", model, Origin("lever", "1.0", "", "", "entry:lever"))
    setup = setup_from_text('[sheet]\nunits = "SI"\n', offer, file="lever.toml", folder=Path())
    sheet = document_of(setup)
    assert [text for text in texts(sheet) if INCH_UNITS.search(text)] == []
    assert row(table(sheet, "checks"), "torque")["Value"] == "22.597 N·m"  # 20 * 4.4482216152605 N * 0.254 m
    assert row(table(sheet, "inputs"), "oil")["Value"] == "100"


def document_of(setup: Setup) -> Document:
    return make_sheet(calculate(setup), provenance=provenance_of(setup, date="2026-11-26"))


def test_the_numbers_of_files_stay_and_those_of_the_sheet_agree_with_them() -> None:
    declared, inch = read(""), read('[sheet]\nunits = "inch"\n')
    ours, theirs = calculate(declared), calculate(inch)
    assert results_document(ours, provenance_of(declared)) == results_document(theirs, provenance_of(inch))
    shown = as_printed(theirs)
    for before, after in zip(ours.checks, shown.checks, strict=True):
        assert to_si(after.value, after.unit) == pytest.approx(to_si(before.value, before.unit), rel=1e-12)
        assert (after.state, after.unit) == (before.state, in_system(before.unit, "inch"))
        if not meaning(before.unit).level:
            assert after.margin == before.margin
    oil = next(check for check in shown.checks if check.name == "oil")
    assert (oil.value, oil.limit) == (pytest.approx(95.0), pytest.approx(122.0))
    assert oil.margin == pytest.approx((122 - 95) / 122)


def test_a_unit_by_hand_wins_and_a_stated_one_stays_where_it_belongs_to_the_system() -> None:
    sheet = document(read(f'[sheet]\nunits = "inch"\n{STATED}\n[units]\nstress = "MPa"\n'))
    assert (
        next(plain_text(cells[1]) for cells in table(sheet, "checks").rows if "(stress)" in plain_text(cells[0]))
        == "6.7972 MPa"
    )
    stated = row(table(sheet, "inputs"), "torque")
    assert (stated["Value"], stated["Unit"]) == ("63", "lbf·ft")
    assert (row(table(sheet, "inputs"), "diameter")["Value"], row(table(sheet, "inputs"), "heating")["Value"]) == (
        "1.5748",
        "27",
    )
    in_si = row(table(document(read(f'[sheet]\nunits = "SI"\n{STATED}')), "inputs"), "torque")
    assert (in_si["Value"], in_si["Unit"]) == ("85.417", "N·m")


def test_the_axes_of_a_figure_have_round_numbers_of_the_other_unit() -> None:
    figure = Figure()
    panel = figure.subplots()
    panel.plot([0, 254], [1, 1000])
    panel.set_yscale("log")
    panel.set(xlabel="width, mm", ylabel="µm along the normal")
    panel.text(10, 10, "25.4 mm")
    panel.plot([0], [1], label="−50.8, 254")
    panel.legend(title="offsets, mm")
    brought_over(figure, SheetUnits("inch").unit, SheetUnits("inch").said)
    assert (panel.get_xlabel(), panel.get_ylabel()) == ("width, in", "µin along the normal")
    FigureCanvasAgg(figure).draw()
    written = {round(float(tick.get_loc()), 6): tick.label1.get_text() for tick in panel.xaxis.get_major_ticks()}
    assert (written[0.0], written[50.8], written[254.0]) == ("0", "2", "10")
    assert [round(place, 6) for place in panel.get_yticks() if 1 < place < 1000] == [2.54, 25.4, 254.0]
    assert panel.texts[0].get_text() == "1 in"
    legend = panel.get_legend()
    assert legend is not None
    assert (legend.get_title().get_text(), legend.get_texts()[0].get_text()) == ("offsets, in", "−2, 10")
    assert panel.lines[0].get_xdata().tolist() == [0, 254]


def test_panels_that_share_an_axis_and_drawings_to_scale_are_in_one_unit() -> None:
    figure = Figure()
    above, below = figure.subplots(2, 1, sharex=True)
    above.plot([0, 254], [0, 1])
    above.set_xlabel("x, mm")
    below.set(xlabel="x, mm")
    scale = Figure().subplots()
    scale.plot([0, 254], [0, 254])
    scale.set(aspect="equal", xlabel="mm")
    for panel in (above, scale):
        FigureCanvasAgg(brought_over(panel.figure, SheetUnits("inch").unit, SheetUnits("inch").said)).draw()
    assert [panel.get_xlabel() for panel in (above, below, scale)] == ["x, in", "x, in", "in"]
    for axis in (below.xaxis, scale.xaxis, scale.yaxis):
        assert "10" in {
            tick.label1.get_text() for tick in axis.get_major_ticks() if tick.get_loc() == pytest.approx(254)
        }


def test_a_diagnosis_is_printed_in_inches() -> None:
    made = named()
    made = replace(made, setup=replace(made.setup, sheet=replace(made.setup.sheet, units="inch")))
    sheet = make_diagnosis_sheet(made, provenance=provenance_of(made.setup, date="2026-11-26"))
    said = [
        text for text in texts(sheet) if text.strip() not in {"mm", "°C", "kN"}
    ]  # a column of the file, as it is read
    assert [text for text in said if SI_UNITS.search(text)] == []
    assert any("µin/(ft·Δ°F)" in plain_text(text) for text in sheet.banner.sentences)


@pytest.mark.parametrize("word", ["metric", "Inch"])
def test_another_word_is_refused_with_the_choices(word: str) -> None:
    with pytest.raises(InputError, match=r"shaft\.toml:2: units: choose SI or inch"):
        read(f'[sheet]\nunits = "{word}"\n')
    run = LoadedModel(OFFER, text=("", "shaft.toml", Path())).run(progress=False)
    with pytest.raises(UsageError, match=rf"units: choose SI or inch, not '{word}'"):
        run.sheet("sheet.md", units=word)
