"""The sheet of a diagnosis and its report on a terminal: what every verdict says, whatever its texts try to be."""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from html import unescape
from pathlib import Path

import numpy as np
import pytest
from diagnosis_samples import SAMPLES, ambiguous, named
from test_report_sheet import HOSTILE, Page

from truing.cli.diagnose import lines_of as report
from truing.diagnosis.records import Covariate, SuspectedUnit
from truing.diagnosis.result import (
    Alternative,
    Amount,
    Cause,
    DiagnosisResult,
    FittedUnknown,
    NextPoint,
    ResidualFinding,
    VisibleSize,
)
from truing.report.diagnosis_figures import main_covariates, thinned
from truing.report.diagnosis_sheet import make_diagnosis_sheet
from truing.report.diagnosis_words import (
    amount_text,
    certainty,
    explanation,
    fitted_text,
    headline,
    listed,
    number_texts,
    p_text,
    percent,
    prose,
    readable,
    score_text,
    spoken,
    verdict_word,
)
from truing.report.document import Document, FigureView, Items, Paragraph, TableView
from truing.report.html_printer import html_of
from truing.report.markdown_printer import markdown_of
from truing.runs.provenance import provenance_of


def sheet_of(made: DiagnosisResult) -> Document:
    return make_diagnosis_sheet(made, provenance=provenance_of(made.setup, date="2026-11-21"))


@cache
def sample_sheet(name: str) -> Document:
    return sheet_of(SAMPLES[name]())


@cache
def page_of(name: str) -> str:
    """The page of a sample, with its figures drawn: made once for all tests."""
    return html_of(sample_sheet(name))


@pytest.fixture(params=list(SAMPLES))
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture
def sheet(name: str) -> Document:
    return sample_sheet(name)


def texts_of(sheet: Document) -> Iterator[str]:
    """Every text that stands on the sheet, as it was said."""
    yield from (sheet.head.title, sheet.banner.headline, sheet.summary, *sheet.alarms, *sheet.warnings)
    yield from map(str, sheet.banner.sentences)
    for chapter in sheet.chapters:
        yield chapter.title
        for block in chapter.blocks:
            if isinstance(block, TableView):
                yield from (block.title, *(column.title for column in block.columns), str(block.note))
                yield from (str(cell) for row in block.rows for cell in row)
            elif isinstance(block, FigureView):
                yield block.caption
            elif isinstance(block, Paragraph):
                yield str(block.text)
            elif isinstance(block, Items):
                yield from block.labels


def plain(text: str) -> str:
    """A text without what markup needs: entities, backslashes, true minus signs and narrow spaces stay as they are."""
    return re.sub(r"\s+", " ", text.replace("\u00a0", " ")).strip()


# The sheet, in both languages


def test_figures_can_all_be_drawn(sheet: Document) -> None:
    views = [block for chapter in sheet.chapters for block in chapter.blocks if isinstance(block, FigureView)]
    assert len(views) >= 3
    assert [view.number for view in views] == list(range(1, len(views) + 1))
    assert not [text for text in sheet.warnings if "figure" in text]


def test_html_and_markdown_say_the_same(name: str, sheet: Document) -> None:
    html = plain(Page(page_of(name)).text)
    markdown = plain(re.sub(r"\\(.)", r"\1", unescape(markdown_of(sheet))))
    said = [plain(text) for text in texts_of(sheet) if text]
    assert len(said) > 80
    assert [text for text in said if text not in html and text.replace("-", "−") not in html] == []
    assert [text for text in said if text not in markdown and text.replace("-", "−") not in markdown] == []


def test_the_chapters_follow_the_questions(sheet: Document) -> None:
    titles = [chapter.title for chapter in sheet.chapters]
    asked = ["What is wrong", "Cause", "Extended model", "Gain", "Next measurement", "Data"]
    assert titles[:6] == asked
    assert titles[-1] == "Provenance"


def test_a_unit_slip_stands_before_everything_else() -> None:
    text = page_of("ambiguous")
    assert 0 < text.index("Suspected unit slip.") < text.index("<h2")
    assert "Suspected unit slip" not in page_of("named")


def test_hostile_texts_are_printed_and_do_nothing() -> None:
    made = ambiguous()
    covariates = {**made.records.covariates, HOSTILE: Covariate(HOSTILE, np.arange(160.0), "", "other")}
    records = replace(
        made.records, covariates=covariates, notes=(HOSTILE,), unit_errors=(SuspectedUnit(HOSTILE, 10.0, HOSTILE),),
        files=(HOSTILE, "b.csv"),
    )  # fmt: skip
    wrong = replace(made.wrong[0], findings=(ResidualFinding("trend", HOSTILE, 0.01, HOSTILE),))
    made = replace(
        made, records=records, wrong=(wrong, made.wrong[1]), inseparable=(HOSTILE,),
        alternatives=(Alternative((HOSTILE,), 1.0, 2.0, (HOSTILE,)),),
        causes=(*made.causes, Cause(f"input:{HOSTILE}", (FittedUnknown(HOSTILE, 1.0, 0.5, 1.5, ""),), (), (HOSTILE,))),
        next=(NextPoint({HOSTILE: Amount(1.0, "")}, (HOSTILE, HOSTILE), HOSTILE, 3.0),),
        seen=(VisibleSize(HOSTILE, None, "not excited", HOSTILE),), not_measured={HOSTILE: (HOSTILE,)},
    )  # fmt: skip
    sheet = sheet_of(made)
    html = html_of(sheet)
    assert "<script" not in html
    assert HOSTILE in plain(Page(html).text)
    markdown = markdown_of(sheet)
    assert "<script" not in markdown
    assert "](https://evil" not in markdown
    assert "**bold**" not in markdown
    printed = "\n".join(report(made, Path("runs/x")))
    assert "alert(1)" in printed


# Words


def fitted(value: float, low: float | None, high: float | None, unit: str = "um") -> FittedUnknown:
    return FittedUnknown("size", value, low, high, unit)


@pytest.mark.parametrize(
    ("unknown", "expected"),
    [
        (fitted(11.8e-6, 11.42e-6, 12.18e-6), ("11.80", "11.42", "12.18", "µm")),
        (fitted(118.2e-6, 101e-6, 135e-6), ("118", "101", "135", "µm")),
        (fitted(-0.66e-6, -0.71e-6, -0.61e-6), ("−0.660", "−0.710", "−0.610", "µm")),
        (fitted(41e-6, None, 52e-6), ("41", "open", "52", "µm")),
        (fitted(51.3e-6, 47.2e-6, 55.4e-6, "mm/K"), ("51.3", "47.2", "55.4", "µm/K")),
        (fitted(41e-6, None, None), ("41", "open", "open", "µm")),
        (fitted(0.0, -1e-6, 1e-6), ("0", "−1.0", "1.0", "µm")),
        (fitted(7.0, 7.0, 7.0, ""), ("7", "7", "7", "")),
        (fitted(298.15, 297.15, 299.15, "degC"), ("25.0", "24.0", "26.0", "°C")),
    ],
)
def test_the_width_of_the_interval_decides_the_digits(unknown: FittedUnknown, expected: tuple[str, ...]) -> None:
    assert number_texts(unknown, (unknown.value, unknown.low, unknown.high)) == expected


def test_an_interval_without_ends_is_said_to_be_open() -> None:
    assert fitted_text(fitted(41e-6, None, None)) == "size 41 µm (its interval is open)"
    assert fitted_text(fitted(41e-6, 38e-6, 44e-6)) == "size 41.0 µm (95 %: 38.0 … 44.0)"


@pytest.mark.parametrize(
    ("p_value", "expected"),
    [
        (0.0004, "practically certain (p < 0.001)"), (0.0033, "practically certain (p 0.0033)"),
        (0.02, "likely (p 0.02)"), (0.4, "may be chance (p 0.4)"), (None, "–"),
    ],
)  # fmt: skip
def test_significance_is_said_in_words(p_value: float | None, expected: str) -> None:
    assert certainty(p_value) == expected


@pytest.mark.parametrize(
    ("words", "expected"), [((), ""), (("a",), "a"), (("a", "b"), "a and b"), (("a", "b", "a", "c"), "a, b and c")]
)
def test_words_are_listed_as_a_sentence_does(words: tuple[str, ...], expected: str) -> None:
    assert listed(words) == expected


@pytest.mark.parametrize(
    ("amount", "expected"),
    [
        (Amount(1.15e-6 / 3600, "mm/h"), "1.15 µm/h"), (Amount(5.25e-6, "mm"), "5.25 µm"),
        (Amount(72.3e-6, "mrad"), "72.3 µrad"), (Amount(2.8e-12, "1/GN"), "0.0028 1/GN"),
        (Amount(0.12e-3, "mm"), "0.12 mm"), (Amount(0.0, "mm"), "0 mm"), (Amount(2e-4, "deg"), "0.688′"),
    ],
)  # fmt: skip
def test_sizes_are_written_in_a_unit_that_reads_well(amount: Amount, expected: str) -> None:
    assert amount_text(readable(amount)) == expected


def test_small_pieces_of_words() -> None:
    assert prose("rises with link_heating, by 12 um or 3 urad/h; 5 umbrellas") == (
        "rises with link heating, by 12 µm or 3 µrad/h; 5 umbrellas"
    )
    assert [score_text(x) for x in (4.8e-16, 6.3, 51.04, 210.4, math.nan)] == ["0", "6.3", "51", "210", "–"]
    assert p_text(None) == "not tested"
    assert percent(0.9991) == "99.9 %"
    assert percent(math.nan) == "–"
    assert amount_text(Amount(2.3e-6, "um")) == "2.3 µm"
    assert amount_text(None) == "–"
    assert spoken("input:rod") == "rod outside of its tolerance"
    assert explanation(Alternative((), 1.0, 1.0)) == "nothing but noise"
    assert explanation(Alternative(("a_b", "unknown"), 1.0, 1.0, ("x",))) == "a b + something unregistered over x"


SAID = {
    "none": ["meets the measurement: slide position to 6.1 µm (noise floor 6 µm)", "nothing of joint play"],
    "named": ["slide position: rod heating, expansion 11.80 µm/(m·K) (95 %: 11.42 … 12.18).",
              "falls from 41.2 µm to 6.12 µm (noise floor 6 µm): 99.9 %", "No other explanation comes near"],
    "undecided": ["No cause is named, but that nothing is wrong cannot be said either", "probability of 0.06",
                  "12 waves over the range of crank angle"],
    "ambiguous": ["in slide position is drawn alike by rod heating, warm up or sensor drift.",
                  "Taken as the first of them: rod heating, expansion 11.80 µm/(m·K)",
                  "Measure next at rod temperature 50 °C, load −50 kN, crank angle 28.6°: it separates",
                  "No measurement proposed here tells rod heating and warm up apart; a fact from elsewhere does: "
                  "whether rod heating, expansion (of the rod) is 11.8 µm/(m·K) or whether warm up, size is 3.1 µm"],
    "unknown": ["Something that no registered effect explains is in slide position, over crank angle: order 7"],
    "remainder": ["rod heating, expansion 11.80", "Beside it something that no registered effect explains"],
}  # fmt: skip
WORDS = {
    "none": "Nothing found", "undecided": "Undecided", "named": "Cause named",
    "ambiguous": "One of 3 causes; this record cannot say which",
    "unknown": "Cause unknown",
    "remainder": "Cause named, a remainder left",
}  # fmt: skip


def test_the_sentence_for_a_colleague_holds_cause_size_gain_and_what_is_next(name: str) -> None:
    made = SAMPLES[name]()
    said = " ".join(headline(made))
    assert [words for words in SAID[name] if words not in said] == []
    assert verdict_word(made) == WORDS[name]
    assert said in plain(Page(page_of(name)).text)


def test_a_gain_that_may_be_chance_is_called_so() -> None:
    made = replace(named(), gain=tuple(replace(item, p_value=0.3) for item in named().gain))
    (said,) = [words for words in headline(made) if "not fitted" in words]
    assert said == "On rows that were not fitted there is no gain that could not be chance."


def test_a_large_gain_in_few_blocks_is_told_with_its_chance() -> None:
    made = replace(named(), gain=tuple(replace(item, p_value=0.125) for item in named().gain))
    (said,) = [words for words in headline(made) if "not fitted" in words]
    assert said == (
        "On rows that were not fitted the error of slide position falls from 41.2 µm to 6.12 µm; in so few independent "
        "blocks that may be chance (p 0.12)."
    )


@pytest.mark.parametrize(
    ("after", "words"),
    [
        (7e-6, "On the rows held out the error of slide position falls from 40 µm to 7 µm."),
        (55e-6, "On the rows held out the error of slide position grows from 40 µm to 55 µm: the extension does not "
                "carry over to them; look at what is different there."),
    ],
)  # fmt: skip
def test_what_became_of_rows_held_out_is_told(after: float, words: str) -> None:
    made = replace(named(), gain=tuple(replace(item, held_out=(40e-6, after)) for item in named().gain))
    assert words in headline(made)


# What residuals are drawn over


@pytest.mark.parametrize(
    ("sample", "expected"),
    [
        ("none", ["crank_angle"]), ("named", ["rod_temperature"]), ("unknown", ["crank_angle"]),
        ("remainder", ["rod_temperature", "crank_angle"]),
    ],
)  # fmt: skip
def test_residuals_are_drawn_over_what_is_guilty(sample: str, expected: list[str]) -> None:
    assert [item.name for item in main_covariates(SAMPLES[sample]())] == expected


def test_a_condition_with_few_values_shows_no_course() -> None:
    """The play follows the load, which has two values here: the angle is looked at instead."""
    play = Cause("joint_play", (FittedUnknown("clearance", 9e-6, 5e-6, 13e-6, "um"),))
    assert [item.name for item in main_covariates(replace(named(), causes=(play,)))] == ["crank_angle"]


@pytest.mark.parametrize(("rows", "step"), [(160, 1), (1500, 1), (1501, 2), (100_000, 67)])
def test_figures_of_long_records_are_thinned(rows: int, step: int) -> None:
    assert thinned(rows).step == step


# The terminal


def test_the_report_answers_the_five_questions(name: str) -> None:
    text = "\n".join(report(SAMPLES[name](), Path("runs/x")))
    titles = re.findall(r"^(\d [A-Z][a-z ]+?)  ", text, re.MULTILINE)
    assert titles == ["1 What is wrong", "2 Cause", "3 Extended model", "4 Gain", "5 Next"]
    assert text.startswith("DIAGNOSIS  press_record.csv, second day.csv: 160 of 162 rows, 3 runs, 4 h; slide: ")
    assert [words for words in SAID[name] if words not in text] == []
    assert ("extended model: " in text) == (name in {"named", "ambiguous", "remainder"})
    assert ("new_effect.py" in text) == (name in {"unknown", "remainder"})


def test_a_narrow_terminal_breaks_behind_the_titles(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    lines = "\n".join(report(ambiguous(), Path("runs/x"))).splitlines()
    assert max(map(len, lines)) <= 80
    start = lines.index(next(line for line in lines if line.startswith("1 What is wrong")))
    end = lines.index(next(line for line in lines if line.startswith("sheet: ")))
    assert [line for line in lines[start : end - 1] if line[1:2] != " " and line[:1].strip()] == []


# Several causes


def test_of_several_causes_the_sheet_and_the_terminal_say_the_shares() -> None:
    one = replace(named().causes[0], share=0.75)
    made = replace(named(), causes=(one, replace(one, effect="sensor_offset", share=0.25)))
    (table,) = (block for chapter in sheet_of(made).chapters for block in chapter.blocks
                if isinstance(block, TableView) and block.title == "Named")  # fmt: skip
    assert [row[-1] for row in table.rows] == ["75 %", "25 %"]
    assert table.note == (
        "Share: of the mean squares of what the named causes add to the model, over all rows in units of the noise."
    )
    said = "\n".join(report(made, Path("folder")))
    assert f"shares of the correction: {spoken(one.effect)} 75 %, sensor offset 25 %" in said
    assert "shares of the correction" not in "\n".join(report(named(), Path("folder")))
