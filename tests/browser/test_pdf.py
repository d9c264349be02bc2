"""The sheet on paper, and printed by the browser as ``calc run --pdf`` does it."""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import replace
from html import unescape
from pathlib import Path

import pytest

from shared import missed
from truing import load
from truing.calculation import calculate
from truing.errors import OutputError
from truing.kernel import Kernel
from truing.report.html_printer import html_of
from truing.report.pdf import find_browser, pdf_bytes
from truing.report.sheet import make_sheet
from truing.runs.provenance import provenance_of
from truing.setup import SheetOptions, default_setup

POINT = 25.4 / 72
ONE = pytest.mark.parametrize("sheet", ["hostile"], indirect=True)  # what does not depend on the sheet


def words_of(pdf: Path, page: int = 0) -> str:
    if shutil.which("pdftotext") is None:
        missed("pdftotext is not on this machine (Debian: poppler-utils): the words of the PDF were not read")
    pages = ["-f", str(page), "-l", str(page)] if page else []
    done = subprocess.run(["pdftotext", *pages, "-enc", "UTF-8", str(pdf), "-"], capture_output=True, check=True)
    return re.sub(r"\s+", " ", done.stdout.decode("utf-8"))


def sizes_of(pdf: Path) -> set[tuple[float, float]]:
    boxes = re.findall(rb"/MediaBox \[\s*0 0 ([\d.]+) ([\d.]+)\s*\]", pdf.read_bytes())
    return {(round(float(width) * POINT), round(float(height) * POINT)) for width, height in boxes}


def test_the_print_is_complete(sheet: Path, printed: Path) -> None:
    """Every chapter's heading, the last row of every table and the end of the sheet are on paper."""
    text = words_of(printed)
    html = sheet.read_text(encoding="utf-8")
    headings = re.findall(r'<h2 id="[^"]+"><span class="place">(\d+)</span> ([^<]+)</h2>', html)
    assert len(headings) > 7
    assert [title for _, title in headings if unescaped(title) not in text] == []
    assert re.search(r"Calculated \d{4}-\d\d-\d\d", text)


def test_page_one_holds_the_answer_and_the_signatures(sheet: Path, printed: Path) -> None:
    """Verdict, limits, key results, figure and room to sign are on page one; the contents follow on the next."""
    first, second = words_of(printed, page=1), words_of(printed, page=2)
    html = sheet.read_text(encoding="utf-8")
    front = re.findall(
        r'<section id="[^"]+" class="front" aria-labelledby="[^"]+">\s*<h2 id="[^"]+">([^<]+)</h2>', html
    )
    assert len(front) > 1
    assert [title for title in [*front, "Prepared", "Checked", "Approved"] if unescaped(title) not in first] == []
    (contents,) = re.findall(r'<nav class="contents".*?</nav>', html, re.DOTALL)
    titles = re.findall(r"</span> ([^<]+)</a>", contents)
    assert [title for title in titles if unescaped(title) not in second] == []


@pytest.mark.parametrize("name", ["press_linkage", "rv_gearing", "roller_screw_shift", "harmonic_fractal", "rv_wear"])
def test_a_short_sheet_has_two_pages(name: str, chromium: Path) -> None:
    """Its studies are left out: they say nothing on a short sheet."""
    setup = replace(default_setup(Kernel.installed().offer(name).model), studies=(), sheet=SheetOptions(detail="short"))
    sheet = make_sheet(calculate(setup), provenance=provenance_of(setup, date="2026-11-26"), example=setup)
    printed = pdf_bytes(html_of(sheet), chromium)
    assert len(re.findall(rb"/Type /Page\b(?!s)", printed)) == 2


@pytest.fixture
def pdf(sheet: Path, chromium: Path) -> Path:
    """The sheet as ``calc run --pdf`` prints it, once for all tests; the sheet stays as it is."""
    made = sheet.with_name("by calc.pdf")
    if not made.exists():
        before = sheet.read_bytes(), sorted(sheet.parent.iterdir())
        printed = pdf_bytes(sheet.read_text(encoding="utf-8"), chromium)
        assert (sheet.read_bytes(), sorted(sheet.parent.iterdir())) == before
        made.write_bytes(printed)
    return made


@ONE
def test_the_contents_name_the_page_on_which_a_chapter_stands(sheet: Path, pdf: Path) -> None:
    """Read back from the text of each page: the number beside a title, and where its heading stands."""
    html = sheet.read_text(encoding="utf-8")
    titles = re.findall(r'<h2 id="[^"]+"><span class="place">(\d+)</span> ([^<]+)</h2>', html)
    contents = words_of(pdf, page=2)
    assert len(titles) > 7
    last = int(re.findall(r"\b2 ?/ ?(\d+)", contents)[-1])
    pages = {page: words_of(pdf, page) for page in range(2, last + 1)}
    for number, title in titles:
        heading = f"{number} {unescaped(title)}"
        named = re.search(rf"(?<!\d){re.escape(heading)} (\d+)", contents)
        assert named, f"{heading} has no page in the contents"
        page = int(named[1])
        assert pages[page].count(heading) == (2 if page == 2 else 1), f"{heading} does not stand on page {page}"


def unescaped(text: str) -> str:
    return re.sub(r"\s+", " ", unescape(text))


def test_pages_are_numbered_and_named(sheet: Path, printed: Path) -> None:
    text = words_of(printed)
    count = printed.read_bytes().count(b"/Type /Page\n") or printed.read_bytes().count(b"/Type /Page/")
    assert count > 2
    assert [page for page in range(1, count + 1) if not re.search(rf"\b{page} ?/ ?{count}\b", text)] == []
    title = unescaped(re.findall(r"<h1>([^<]+)</h1>", sheet.read_text(encoding="utf-8"))[0])
    assert text.count(title) >= count


@ONE
def test_the_paper_is_a4_unless_letter_is_asked_for(sheet: Path, pdf: Path, chromium: Path, tmp_path: Path) -> None:
    """It is as complete as what the browser prints that shows the sheet."""
    assert sizes_of(pdf) == {(210, 297)}
    test_the_print_is_complete(sheet, pdf)
    test_pages_are_numbered_and_named(sheet, pdf)
    text = sheet.read_text(encoding="utf-8")
    assert text.count("@page { size: A4;") == 1
    short = re.sub("<main.*</main>", "", text.replace("@page { size: A4;", "@page { size: letter;"), flags=re.DOTALL)
    (tmp_path / "letter.pdf").write_bytes(pdf_bytes(short, chromium))
    assert sizes_of(tmp_path / "letter.pdf") == {(216, 279)}


@ONE
def test_a_browser_that_prints_nothing_or_is_not_there_is_said_in_one_sentence(
    sheet: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text, dumb = sheet.read_text(encoding="utf-8"), shutil.which("true")
    with pytest.raises(OutputError, match=r"cannot be started: No such file"):
        pdf_bytes(text, tmp_path / "chrome")
    monkeypatch.setenv("CHROME_PATH", str(tmp_path / "chrome"))
    assert find_browser() is None
    with pytest.raises(OutputError, match=r"no Chromium, Chrome or Edge was found .* print it to PDF \(Ctrl\+P\)"):
        pdf_bytes("<p>sheet</p>")
    if dumb is not None:
        with pytest.raises(OutputError, match=r"^true printed no PDF \(exit 0\); open sheet.html in any browser"):
            pdf_bytes(text, Path(dumb))
    assert list(tmp_path.iterdir()) == []


def test_without_a_figure_the_chapters_follow_on_page_one(chromium: Path, tmp_path: Path) -> None:
    """Where there is none, page one would be empty between its results and the signatures."""
    model = load(Path(__file__).parents[2] / "docs" / "examples" / "adsorption" / "adsorption.py")
    printed = tmp_path / "sheet.pdf"
    html = model.run(progress=False).sheet(tmp_path / "sheet.html").read_text(encoding="utf-8")
    assert "key-figure" not in re.sub(r"<style>.*?</style>", "", html, flags=re.DOTALL)
    printed.write_bytes(pdf_bytes(html, chromium))
    first = words_of(printed, page=1)
    assert "1 Inputs What the calculation starts from" in first
    assert first.index("Approved") < first.index("1 Inputs")


def test_the_figure_of_page_one_is_seen_on_paper(chromium: Path, tmp_path: Path) -> None:
    """Of a study that is asked alone, whose page one has nothing else."""
    study = load("press_linkage.motion").sweep("counterbalance", "0..400 kN", points=5, output=tmp_path / "swept")
    assert study.outcome is not None
    html = (tmp_path / "swept" / "sheet.html").read_text(encoding="utf-8")
    printed = tmp_path / "sheet.pdf"
    printed.write_bytes(pdf_bytes(html, chromium))
    heights = [float(each) for each in re.findall(r"--high: ([\d.]+)mm", html)]
    assert heights
    assert min(heights) > 20
    assert "Figure 1." in words_of(printed, page=1)
