"""Sheets for Word, read back by python-docx and by LibreOffice, whatever their texts try to be."""

from __future__ import annotations

import base64
import shutil
import subprocess
import sys
import zipfile
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import docx
import pytest
from diagnosis_samples import named
from docx.oxml.ns import qn
from PIL import Image

import truing
from truing.calculation import calculate
from truing.errors import UsageError
from truing.formulas.symbols import printable
from truing.formulas.write_omml import OMML
from truing.inputs_file import read_setup
from truing.kernel import Kernel
from truing.report import equations
from truing.report.diagnosis_sheet import make_diagnosis_sheet
from truing.report.document import (
    Chapter,
    Document,
    FigureView,
    Fold,
    Marked,
    Paragraph,
    ResultEntry,
    TableView,
    Value,
    plain_text,
    table_of,
)
from truing.report.sheet import make_sheet
from truing.report.word_printer import word_of
from truing.runs.provenance import provenance_of

DATA = Path(__file__).parents[1] / "data"
HOSTILE = "<w:p/> </w:t> ]]> &amp; {{7*7}} =1+1 \x00\x0b\x1b\u202e\ud800\ufffe {DDEAUTO c:\\x}"


@pytest.fixture(scope="module")
def sheet() -> Document:
    """The sheet of a calculation whose texts are hostile, with figures and a formula that is solved."""
    kernel = Kernel(strict=True)
    kernel.add_file(DATA / "hostile_pin.py")
    setup = read_setup(DATA / "hostile_pin.toml", kernel.offer("hostile_pin"))
    return make_sheet(calculate(setup), provenance=provenance_of(setup, date="2026-11-21"))


@pytest.fixture(scope="module")
def content(sheet: Document) -> bytes:
    return word_of(sheet)


@pytest.fixture(scope="module")
def word(content: bytes) -> Any:
    return docx.Document(BytesIO(content))


def all_of(document: Document, kind: type) -> list[Any]:
    """Every block of a kind that paper has, also of what is folded on a screen, in order."""
    blocks = [block for chapter in (*document.front, *document.chapters) for block in chapter.blocks]
    paper = [block for block in blocks if not isinstance(block, Fold) or block.printed]
    opened = [each for block in paper for each in (block, *(block.blocks if isinstance(block, Fold) else ()))]
    return [block for block in opened if isinstance(block, kind)]


def text_of(element: Any) -> str:
    return "".join(each.text for each in element.iter(qn("w:t"), qn("m:t")))


def test_chapters_are_headings_that_contents_lead_to(sheet: Document, word: Any) -> None:
    chapters = [*sheet.front, *sheet.chapters]
    titles = [printable(f"{chapter.number} {chapter.title}".strip()) for chapter in chapters]
    headings = [each for each in word.paragraphs if each.style.name == "Heading 1"]
    assert [each.text for each in headings] == titles
    links = list(word.element.body.iter(qn("w:hyperlink")))
    assert list(map(text_of, links)) == titles
    marks = [each._p.find(qn("w:bookmarkStart")).get(qn("w:name")) for each in headings]
    assert [link.get(qn("w:anchor")) for link in links] == marks
    assert len(set(marks)) == len(titles)
    fields = [each.get(qn("w:fldCharType")) for each in word.element.body.iter(qn("w:fldChar"))]
    assert fields == ["begin", "separate", "end"]


def test_every_formula_is_one_of_word(sheet: Document, word: Any) -> None:
    lines = [equations.lines(OMML, entry.equation, limit=42.0) for entry in all_of(sheet, ResultEntry)
             if entry.equation is not None]  # fmt: skip
    assert len(lines) > 3
    assert len(list(word.element.body.iter(qn("m:oMathPara")))) == sum(map(len, lines))


def test_tables_have_a_header_that_repeats_and_numbers_to_the_right(sheet: Document, word: Any) -> None:
    written = [table for table in word.tables if table.rows[0]._tr.find(f".//{qn('w:tblHeader')}") is not None]
    views = all_of(sheet, TableView)
    assert len(written) == len(views) > 3
    for table, view in zip(written, views, strict=True):
        assert [cell.text for cell in table.rows[0].cells] == [printable(column.heading) for column in view.columns]
        assert len(table.rows) == len(view.rows) + 1
        for row, texts in zip(list(table.rows)[1:], view.rows, strict=True):
            for cell, text, column in zip(row.cells, texts, view.columns, strict=True):
                assert (cell.paragraphs[0].alignment == docx.enum.text.WD_ALIGN_PARAGRAPH.RIGHT) is (
                    column.kind == "number"
                )
                if isinstance(text, (str, Value)):
                    assert cell.text.replace("\u00a0", " ").startswith(
                        printable(plain_text(text)).replace("\u00a0", " ")
                    )
    verdicts = {cell.text for table in written for row in table.rows for cell in row.cells}
    assert "✓ pass" in verdicts


def test_figures_are_pictures_with_words(sheet: Document, word: Any) -> None:
    figures = all_of(sheet, FigureView)
    shapes = list(word.inline_shapes)
    assert [shape._inline.docPr.get("descr") for shape in shapes] == [printable(each.caption) for each in figures]
    for shape, picture in zip(shapes, pictures(word), strict=True):
        assert 20 < shape.width.mm <= 170
        assert shape.width / shape.height == pytest.approx(picture.width / picture.height, rel=1e-3)
        assert len(picture.convert("L").getcolors()) > 10  # something is drawn


def test_a_figure_that_cannot_be_drawn_again_is_missed_aloud(sheet: Document) -> None:
    def broken() -> Any:
        raise ValueError("only once")

    figure = FigureView("Scar", "<svg/>", "The scar", 1, broken)
    made = replace(sheet, front=(), chapters=(Chapter("Figures", (figure,), number="1"),))
    texts = [each.text for each in docx.Document(BytesIO(word_of(made))).paragraphs]
    assert "The figure 'Scar' could not be drawn again." in texts


def pictures(word: Any) -> list[Image.Image]:
    blips = [next(shape._inline.iter(qn("a:blip"))).get(qn("r:embed")) for shape in word.inline_shapes]
    return [Image.open(BytesIO(word.part.related_parts[blip].blob)) for blip in blips]


def test_any_text_is_inert(sheet: Document) -> None:
    table = table_of(HOSTILE, ("a", HOSTILE), [(HOSTILE, (Marked("symbol", HOSTILE), Value(HOSTILE, HOSTILE)))])
    blocks = (Paragraph((HOSTILE, Marked("code", HOSTILE), Marked("source", HOSTILE))), table)
    head = replace(sheet.head, title=HOSTILE, fields=((HOSTILE, HOSTILE),), footer=HOSTILE)
    chapter = Chapter(HOSTILE, blocks, number="1")
    content = word_of(replace(sheet, title=HOSTILE, head=head, front=(), chapters=(chapter,), alarms=(HOSTILE,)))
    word = docx.Document(BytesIO(content))
    text = text_of(word.element.body)
    assert text.count(printable(HOSTILE)) >= 8
    assert not any(character in text for character in "\x00\x0b\x1b\u202e\ud800\ufffe")
    body = word.element.body
    assert len(word.tables) == 3
    assert [each.text for each in body.iter(qn("w:instrText"))] == [r' TOC \o "1-1" \h \z \u ']
    fields = [each.get(qn("w:instr")) for each in word.sections[0].footer._element.iter(qn("w:fldSimple"))]
    assert fields == [" PAGE ", " NUMPAGES "]
    assert not [each for each in word.part.rels.values() if each.is_external]


def test_the_paper_is_that_of_the_sheet_and_no_time_stands_in_the_file(sheet: Document, content: bytes) -> None:
    section = docx.Document(BytesIO(word_of(replace(sheet, paper="letter", front=(), chapters=())))).sections[0]
    assert (section.page_width.mm, section.page_height.mm) == pytest.approx((215.9, 279.4), abs=0.1)
    with zipfile.ZipFile(BytesIO(content)) as archive:
        assert {part.date_time for part in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
        core = archive.read("docProps/core.xml").decode()
    assert core.count("1980-01-01T00:00:00Z") == 2
    assert word_of(sheet) == content


@pytest.mark.parametrize(("kind", "shown"), [("image/png", True), ("image/svg+xml", False), ("image/jpeg", False)])
def test_a_logo_is_shown_or_missed_aloud(sheet: Document, kind: str, shown: bool) -> None:
    stream = BytesIO()
    Image.new("RGB", (30, 10), "red").save(stream, "PNG")
    picture = stream.getvalue() if shown else b"<svg xmlns='http://www.w3.org/2000/svg'/>"
    logo = f"data:{kind};base64,{base64.b64encode(picture).decode()}"
    made = replace(sheet, head=replace(sheet.head, logo=logo), front=(), chapters=())
    word = docx.Document(BytesIO(word_of(made)))
    assert len(word.inline_shapes) == shown
    assert any("logo cannot stand in a Word document" in each.text for each in word.paragraphs) is not shown


def test_a_diagnosis_reads_back(tmp_path: Path) -> None:
    made = make_diagnosis_sheet(named(), provenance=provenance_of(named().setup, date="2026-11-21"))
    word = docx.Document(BytesIO(word_of(made)))
    texts = [each.text for each in word.paragraphs]
    assert any(text.startswith("● Cause named. ") for text in texts)
    folds = [each.text for each in word.paragraphs if each.style.name == "Heading 2"]
    assert folds == [fold.title for fold in all_of(made, Fold)] != []
    assert [text for text in texts if text in {chapter.title for chapter in made.front}] != []
    assert len(word.inline_shapes) == len(all_of(made, FigureView)) > 0
    cells = {cell.text for table in word.tables for row in table.rows for cell in row.cells}
    for table in all_of(made, TableView):
        assert {printable(plain_text(row[0])) for row in table.rows} <= cells


def test_without_the_library_one_sentence_says_what_to_install(
    sheet: Document, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "docx", None)
    sentence = r"a Word document needs python-docx, which is not installed: pip install 'truing\[word\]'"
    model = truing.load(DATA / "pin_wear.py")
    with pytest.raises(UsageError, match=sentence):
        model.run(output=tmp_path / "out", docx=True, progress=False)
    with pytest.raises(UsageError, match=sentence):
        word_of(sheet)
    assert list(tmp_path.iterdir()) == []


def test_libreoffice_reads_every_formula(content: bytes, word: Any, tmp_path: Path) -> None:
    office = shutil.which("soffice") or shutil.which("libreoffice")
    if office is None:
        pytest.skip("LibreOffice is not installed")
    (tmp_path / "sheet.docx").write_bytes(content)
    profile = f"-env:UserInstallation={(tmp_path / 'profile').as_uri()}"
    words = [office, profile, "--headless", "--convert-to", "odt", "--outdir", str(tmp_path), "sheet.docx"]
    subprocess.run(words, check=True, timeout=300, cwd=tmp_path)
    with zipfile.ZipFile(tmp_path / "sheet.odt") as archive:
        names = [name for name in archive.namelist() if name.startswith("Object ") and name.endswith("/content.xml")]
        formulas = [archive.read(name).decode() for name in names]
    assert len(formulas) == len(list(word.element.body.iter(qn("m:oMath"))))
    assert not [formula for formula in formulas if "<math" not in formula or "merror" in formula]
    assert any("mfrac" in formula for formula in formulas)
