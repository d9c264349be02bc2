"""The sheets of diagnoses, as a browser shows and prints them: the rules of every sheet hold here too."""

from __future__ import annotations

import re
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

sys.path.append(str(Path(__file__).parents[1] / "unit"))

from diagnosis_samples import SAMPLES, ambiguous
from test_pdf import test_pages_are_numbered_and_named, unescaped, words_of  # noqa: F401
from test_sheet import (  # noqa: F401
    test_every_character_is_drawn,
    test_every_figure_has_a_title_for_those_who_cannot_see_it,
    test_every_text_stands_out_from_its_ground,
    test_nothing_is_cut_off_on_paper,
    test_nothing_on_the_sheet_can_run,
    test_the_keyboard_reaches_every_table,
    test_the_page_is_no_wider_than_the_screen,
    test_the_sheet_asks_for_nothing_and_says_nothing,
    test_what_is_wide_scrolls_in_its_own_box_on_a_phone,
)

from truing.diagnosis.records import SuspectedUnit
from truing.diagnosis.result import Alternative, DiagnosisResult, ResidualFinding, VisibleSize
from truing.report.diagnosis_sheet import make_diagnosis_sheet
from truing.report.html_printer import html_of
from truing.runs.provenance import provenance_of

LONG = "wear_of_the_third_joint_of_the_left_knee_drive_in_micrometres_per_million_strokes"
HOSTILE = f"<script>alert(1)</script> {{{{7*7}}}} {LONG} & \"'"


def hostile() -> DiagnosisResult:
    """A diagnosis whose every text is long and hostile."""
    made = ambiguous()
    wrong = replace(made.wrong[0], findings=(ResidualFinding("trend", LONG, 0.01, HOSTILE),))
    return replace(
        made,
        wrong=(wrong, made.wrong[1]),
        alternatives=(Alternative((LONG, HOSTILE), 1.0, 2.0, (LONG,)),),
        ranking=(*made.ranking, Alternative((LONG, HOSTILE), 7.0, 2.0)),
        seen=(*made.seen, VisibleSize(LONG, None, "not excited", HOSTILE)),
        records=replace(
            made.records, notes=(HOSTILE,), unit_errors=(SuspectedUnit(LONG, 1e3, HOSTILE),), files=(LONG, HOSTILE)
        ),
    )


@pytest.fixture(scope="session", params=["unknown", "remainder", "hostile"])
def sheet(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The sheet of a diagnosis on disk: with a shape that is drawn, with causes and a remainder, and a hostile one."""
    made = {**SAMPLES, "hostile": hostile}[request.param]()
    text = html_of(make_diagnosis_sheet(made, provenance=provenance_of(made.setup, date="2026-11-21")))
    file = tmp_path_factory.mktemp("Größe ü") / f"{request.param} sheet.html"
    file.write_text(text, encoding="utf-8")
    return file


def test_the_print_is_complete(sheet: Path, printed: Path) -> None:
    """Every chapter's heading, every caption, every heading of a column and the end of the sheet are on paper."""
    text = re.sub(r"[\s-]+", "", words_of(printed))
    html = sheet.read_text(encoding="utf-8")
    wanted = re.findall(r'<h2 id="[^"]+"><span class="place">\d+</span> ([^<]+)</h2>', html)
    wanted += re.findall(r"<caption>([^<]+)</caption>", html)
    wanted += re.findall(r'<th scope="col"[^>]*>([^<]+)</th>', html)
    assert len(wanted) > 30
    assert [words for words in wanted if re.sub(r"[\s-]+", "", unescaped(words)) not in text] == []
    assert "Calculated20261121" in text


def test_the_verdict_is_seen_without_scrolling(page: Any) -> None:
    """Verdict and all that an engineer would tell a colleague stand above the fold of a common screen."""
    bottom = page.evaluate("document.querySelector('.verdict').getBoundingClientRect().bottom")
    assert 0 < bottom < 900


def test_numbers_and_their_units_stay_on_one_line(page: Any) -> None:
    """A cell with one number is one line high, on a screen that is wide enough."""
    tall = page.evaluate("""() => [...document.querySelectorAll('td.number')]
        .filter(node => node.getClientRects().length && node.textContent.trim().length < 20)
        .filter(node => { const range = document.createRange(); range.selectNodeContents(node);
            return new Set([...range.getClientRects()].map(box => Math.round(box.top))).size > 1; })
        .map(node => node.textContent)""")
    assert tall == []
