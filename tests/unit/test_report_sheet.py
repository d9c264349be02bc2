"""The sheet: what it says, at every level of detail, in both languages, whatever its texts try to be."""

from __future__ import annotations

import os
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from markdown_it import MarkdownIt
from markdown_it.token import Token

from press_linkage.model import PRESS_LINKAGE
from roller_screw_shift.model import ROLLER_SCREW_SHIFT
from truing import Section, Table
from truing.calculation import calculate
from truing.cases import run_cases
from truing.declare.fields import with_values
from truing.executors import open_executor
from truing.formulas.symbols import printable
from truing.inputs_file import read_setup, setup_from_text
from truing.kernel import Kernel, Offer
from truing.measurements import read_cases
from truing.published import compare_published
from truing.report.chapters import with_notes
from truing.report.document import Column, Document, FigureView, Marked, Paragraph, ResultEntry, TableView, plain_text
from truing.report.html_printer import css_text, html_of, with_room
from truing.report.markdown_printer import escaped, markdown_of
from truing.report.sheet import logo_of, make_sheet, style_of
from truing.runs.provenance import provenance_of
from truing.setup import InputsSource, Setup, SheetOptions, default_setup

DATA = Path(__file__).parents[1] / "data"
HOSTILE = "<script>alert(1)</script> {{7*7}} $x$ | # `code` [link](https://evil.example) **bold** & \"' # next"
VOID = {"meta", "br", "wbr", "img"}


@pytest.fixture(scope="module")
def offer() -> Offer:
    kernel = Kernel(strict=True)
    kernel.add_file(DATA / "hostile_pin.py")
    return kernel.offer("hostile_pin")


@pytest.fixture(scope="module")
def setup(offer: Offer) -> Setup:
    return read_setup(DATA / "hostile_pin.toml", offer)


def sheet_of(setup: Setup, **more: Any) -> Document:
    return make_sheet(calculate(setup), provenance=provenance_of(setup, date="2026-11-21"), **more)


@pytest.fixture(scope="module")
def whole(setup: Setup, offer: Offer) -> Document:
    return sheet_of(setup, verified=compare_published(offer))


@pytest.fixture(scope="module")
def html(whole: Document) -> str:
    return html_of(whole)


@pytest.fixture(scope="module")
def markdown(whole: Document) -> str:
    return markdown_of(whole)


class Page(HTMLParser):
    """Reads a page strictly: what is opened is closed, and every text stands somewhere."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.open: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.words: list[str] = []
        self.feed(text)
        self.close()
        assert not self.open

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if "style" not in self.open:
            self.words.append(data)

    @property
    def text(self) -> str:
        return re.sub(r"\s+", " ", "".join(self.words))


@pytest.fixture(scope="module")
def page(html: str) -> Page:
    return Page(html)


def test_the_page_is_well_formed_and_holds_only_elements_that_cannot_act(page: Page, html: str) -> None:
    names = {tag for tag, _ in page.tags}
    assert not names & {"script", "iframe", "object", "embed", "link", "form", "input", "base", "audio", "video", "img"}
    assert {"math", "mfrac", "svg", "table", "caption", "h1", "h2"} <= names
    for tag, attributes in page.tags:
        assert not [name for name in attributes if name.startswith("on")], tag
        for name in ("src", "href", "xlink:href", "action", "srcset", "data", "formaction"):
            assert (attributes.get(name) or "#").startswith("#"), (tag, attributes)
    style = html[html.index("<style>") : html.index("</style>")]
    assert "url(" not in style
    assert "@import" not in style
    metas = [attributes for tag, attributes in page.tags if tag == "meta"]
    policies = [meta["content"] for meta in metas if meta.get("http-equiv") == "Content-Security-Policy"]
    assert policies == ["default-src 'none'; style-src 'unsafe-inline'; img-src data:"]


def test_hostile_texts_are_printed_as_they_are(page: Page, markdown: str) -> None:
    assert page.text.count(HOSTILE) >= 12
    assert "49" not in re.sub(r"[\da-f]{64}", "", page.text)
    assert [mark for mark in ("<", "{{7", "https://") if mark in markdown] == []


def test_identifiers_are_unique_and_every_link_inside_the_page_arrives(page: Page) -> None:
    identifiers = [attributes["id"] for _, attributes in page.tags if "id" in attributes]
    assert len(identifiers) == len(set(identifiers))
    targets = {(attributes.get("href") or "")[1:] for tag, attributes in page.tags if tag == "a"}
    assert targets <= set(identifiers)
    assert len(targets) > 5


def test_headings_descend_in_order_and_tables_are_labelled(page: Page) -> None:
    levels = [int(tag[1]) for tag, _ in page.tags if re.fullmatch("h[1-6]", tag)]
    assert levels[0] == 1
    assert set(levels[1:]) == {2}
    assert next(attributes for tag, attributes in page.tags if tag == "html")["lang"] == "en"
    assert all("scope" in attributes for tag, attributes in page.tags if tag == "th")
    assert sum(tag == "caption" for tag, _ in page.tags) == sum(tag == "table" for tag, _ in page.tags)


def test_columns_say_how_many_characters_they_need() -> None:
    """The longest word and the gap; a number stands on one line, a name may break behind its underscores."""
    rows = '<tr><td>well_<wbr>named thing</td><td class="number">1.5 &lt; 2 mm</td><td>{}</td></tr>'.format("x" * 90)
    head = '<thead><tr><th>Name</th><th class="number">Least margin</th><th>Remark</th></tr></thead>'
    page = with_room(f'<p>a</p><table class="grid narrow">{head}{rows}<tr><td>short row</td></tr></table>')
    assert re.findall(r"--(own|room): (\d+)", page) == [("room", "45"), ("own", "7"), ("own", "12"), ("own", "26")]
    assert re.sub(r' style="[^"]*"', "", page).count("<th>") == 2


def test_every_table_of_the_markdown_has_equal_rows(markdown: str) -> None:
    tokens = MarkdownIt("commonmark").enable("table").parse(markdown)
    rows = sum(token.type == "tr_open" for token in tokens)
    lines = [line for line in markdown.splitlines() if line.startswith("|")]
    rules = [line for line in lines if re.fullmatch(r"[|\s:-]+", line) and "---" in line]
    assert rows == len(lines) - len(rules)


def test_both_sheets_say_the_same(page: Page, markdown: str) -> None:
    said = ["Werk Süd", "A. Müller", "4711-02", "1 of 3 checks fails: depth.", "lognormal sd 6 %", "running in"]
    for text in (page.text, markdown):
        assert [words for words in said if words not in text] == []


def test_what_the_page_says_of_inputs_tolerances_and_checks(page: Page, html: str) -> None:
    """Inputs whether they are stated, tolerances if they are on; checks are told by words and not by colour."""
    assert re.search(r"normal load on the pin load ?130N ?stated", page.text)
    assert re.search(r"running time time ?200h ?default", page.text)
    assert "not given" in page.text
    assert "day and night" not in page.text  # what scatters so is off
    assert re.findall(r'<tr class="(passes|fails)">.*?</tr>', html, re.DOTALL) == ["passes", "fails", "passes"]
    assert (page.text.count("✓ pass"), page.text.count("✗ FAILS")) == (2, 1)
    assert "<code>early_<wbr>depth</code>" in html
    assert "early_depth" in page.text


def test_numbers_of_formulas_are_those_the_calculation_ran_with(markdown: str) -> None:
    """The effect adds 3 µm * (1 - exp(-360 km / 500 m)) to the stated 2 µm, so the formula must start from 5 µm."""
    assert "With them the calculation runs with $h_{0}$ = 5 µm instead of 2 µm." in markdown
    depth = markdown[markdown.index("**worn depth** (depth)") :].split("$$")[1]
    assert r"= 5\thinspace \mathrm{\mu{}m} + " in depth
    assert depth.rstrip().endswith(r"= 28.878\thinspace \mathrm{\mu{}m}")


def test_an_effect_on_the_results_sets_the_answer_apart_from_the_formula(markdown: str) -> None:
    """0.1 µm/K over 15 K on top of 28.878 µm."""
    assert "$h$ = 30.378 µm in the calculation, with the effects on the results that are on" in markdown


def test_a_long_sum_is_broken_into_lines(html: str) -> None:
    entry = re.search(r"<code>both</code>.*?</div>\s*</dd>", html.replace("<wbr>", ""), re.DOTALL)
    assert entry is not None
    assert entry[0].count('<math display="block"') >= 3


@pytest.mark.parametrize(
    ("detail", "shown", "hidden"),
    [
        ("short", ["Checks", "Main results", "Provenance"], ["Inputs", "Wear", "Only in full", "References"]),
        ("normal", ["Checks", "Inputs", "Wear", "Materials", "References"], ["Main results", "Only in full"]),
        ("full", ["Checks", "Inputs", "Wear", "Only in full", "Provenance"], ["Main results"]),
    ],
)
def test_detail_chooses_the_chapters(setup: Setup, detail: str, shown: list[str], hidden: list[str]) -> None:
    sheet = sheet_of(replace(setup, sheet=SheetOptions(detail=detail)))
    first, titles = ([chapter.title for chapter in chapters] for chapters in (sheet.front, sheet.chapters))
    assert [title for title in shown if title not in first + titles] == []
    assert [title for title in hidden if title in titles] == []
    assert [int(chapter.number) for chapter in sheet.chapters] == list(range(1, len(titles) + 1))


# Page one


def front_of(setup: Setup, example: Setup | None = None) -> dict[str, Any]:
    """The blocks of page one by the title of their chapter."""
    return {chapter.title: chapter.blocks for chapter in sheet_of(setup, example=example).front}


def test_page_one_has_the_limits_the_key_results_the_figure_and_what_was_changed() -> None:
    example = replace(default_setup(PRESS_LINKAGE), studies=())
    changed = replace(example, inputs=with_values(example.inputs, {("crank_angle",): 0.1}))
    same, front = front_of(example, example), front_of(changed, example)
    assert [*front] == ["Checks", "Key results", "Mechanism and slider", "Inputs against the example"]
    (results,) = front["Key results"]
    (name, symbol) = "slider_position", Marked("symbol", "z_2")
    assert [row[1][-1].text for row in results.rows] == [name, "slider_tilt"]  # the others are of studies
    assert results.rows[0][0] == symbol
    (inputs,) = front["Inputs against the example"]
    assert [(row[1][-1].text, row[2].text, row[3].text) for row in inputs.rows] == [("crank_angle", "5.729577951", "0")]
    assert [block.text for block in same["Inputs against the example"]] == [
        "All inputs are those of the shipped example."
    ]


def test_of_many_limits_those_of_which_least_is_left_stand_on_page_one() -> None:
    setup = replace(default_setup(ROLLER_SCREW_SHIFT), studies=())
    sheet = sheet_of(setup)
    (shown,) = next(chapter.blocks for chapter in sheet.front if chapter.title == "Checks")
    (every,) = next(chapter.blocks for chapter in sheet.chapters if chapter.title == "All checks")
    margins = sorted(check.margin for check in calculate(setup).checks)
    assert (len(shown.rows), len(every.rows)) == (8, 12) == (8, len(margins))
    assert [float(row[4].text) for row in shown.rows] == pytest.approx(margins[:8], rel=1e-2)


def test_a_figure_of_page_one_is_drawn_once(setup: Setup) -> None:
    """Its section refers to it; a model without key results or limits has its first results there."""
    sheet = sheet_of(replace(setup, sheet=SheetOptions(detail="full")))
    figures = [
        block
        for chapter in (*sheet.front, *sheet.chapters)
        for block in chapter.blocks
        if isinstance(block, FigureView)
    ]
    assert [figure.number for figure in figures] == [*range(1, len(figures) + 1)]
    assert [chapter.ident for chapter in sheet.front if figures[0] in chapter.blocks] == ["key-figure"]
    said = [block.text for chapter in sheet.chapters for block in chapter.blocks if isinstance(block, Paragraph)]
    assert said.count("Its figure is on page one.") == 1


def blocks_of(sheet: Document, kind: type[Any]) -> list[Any]:
    return [block for chapter in sheet.chapters for block in chapter.blocks if isinstance(block, kind)]


def test_a_result_hidden_at_this_level_does_not_come_back_as_a_further_one(setup: Setup) -> None:
    names = [block.name for block in blocks_of(sheet_of(setup), ResultEntry)]
    assert "root" not in names
    assert sorted(names) == sorted(set(names))


def chapter_of(sheet: Document, title: str) -> Any:
    return next(chapter for chapter in sheet.chapters if chapter.title == title)


def test_a_full_sheet_shows_results_along_an_axis_as_a_thinned_table(setup: Setup) -> None:
    sheet = sheet_of(replace(setup, sheet=SheetOptions(detail="full")))
    table = next(table for table in blocks_of(sheet, TableView) if table.title == "Along moment")
    assert [len(table.rows), table.rows[0][0], table.rows[-1][0]] == [25, "0", "200"]
    assert table.note == "25 of 1201 rows"


def test_the_paper_is_compared_under_its_own_settings(offer: Offer) -> None:
    """120 N on 28 mm² are 4.2857 MPa; at 240 N the law without effects gives 44.08 µm where "the paper" has 40."""
    first, second = compare_published(offer)
    assert first.value == pytest.approx(120 / 28, rel=1e-12)
    assert (first.matches, first.as_stated) == (True, True)
    assert second.value == pytest.approx(3e-8 * 240 / 28e-6 * 0.5 * 200 * 3600 / 2.1e9 * 1e6, rel=1e-12)
    assert (second.matches, second.as_stated) == (False, True)


def test_rows_that_this_run_reproduces_come_first(offer: Offer) -> None:
    setup = setup_from_text('[inputs]\nload = "240 N"', offer, file="x", folder=Path())
    sheet = sheet_of(setup, verified=compare_published(offer))
    own, elsewhere = (block for block in chapter_of(sheet, "Paper against this calculation").blocks[1:])
    assert [row[0][0] for row in own.rows] == ["depth at double load"]
    assert [row[0][0] for row in elsewhere.rows] == ["pressure"]


def sheet_with(setup: Setup, *sections: Section) -> Document:
    """The sheet of a model that has these sections."""
    return sheet_of(replace(setup, model=replace(setup.model, sheet=list(sections)), effects=()))


def test_a_figure_that_fails_is_a_warning_and_not_the_end(setup: Setup) -> None:
    def broken(record: Any) -> Any:
        raise ZeroDivisionError("nothing to divide by")

    sheet = sheet_with(setup, Section("Broken", figure=broken))
    assert any("the figure 'Broken' failed: ZeroDivisionError: nothing to divide by" in text for text in sheet.warnings)
    for printed in (html_of(sheet), markdown_of(sheet)):
        assert "could not be drawn" in printed


@pytest.mark.parametrize("rows", [[], [["a"], ["a", 1.0, "too many"]], "no table at all"])
def test_blocks_of_a_guest_do_not_take_the_sheet_away(setup: Setup, rows: Any) -> None:
    """Rows too short or too long are printed as far as they go; what is no table is said to have failed.

    A section whose study did not run has no heading; one that is words and nothing else stays.
    """

    def blocks(record: Any) -> Any:
        return [Table("T", ["one", "two"], rows)] if rows and isinstance(rows, list) else rows

    sheet = sheet_with(
        setup, Section("Guest", text="What it found", blocks=blocks), Section("There", text="Only words")
    )
    titles = [item.title for item in sheet.chapters]
    assert ("Guest" in titles, "There" in titles) == (bool(rows), True)
    said = [text for text in sheet.warnings if "'Guest' failed" in text]
    assert len(said) == (1 if isinstance(rows, str) else 0)
    for printed in (html_of(sheet), markdown_of(sheet)):
        assert ("could not be written" in printed) == bool(said)


def with_logo(setup: Setup, logo: str, folder: Path) -> Setup:
    source = InputsSource(file=str(folder / "in.toml"))
    return replace(setup, sheet=SheetOptions(head={"logo": logo}), source=source)


def test_a_logo_stands_in_the_file_itself(setup: Setup, tmp_path: Path) -> None:
    (tmp_path / "sign.svg").write_text("<svg xmlns='http://www.w3.org/2000/svg'/>")
    stated = with_logo(setup, "sign.svg", tmp_path)
    images = [attributes for tag, attributes in Page(html_of(sheet_of(stated))).tags if tag == "img"]
    assert [(image["src"] or "")[:26] for image in images] == ["data:image/svg+xml;base64,"]
    assert images[0]["alt"]


def test_a_logo_that_cannot_be_shown_is_a_warning(setup: Setup, tmp_path: Path) -> None:
    for name in ("missing.png", "/etc/hostname", "https://evil.example/x.png", "a\0.png"):
        sheet = sheet_of(replace(setup, sheet=SheetOptions(head={"logo": name})))
        assert sheet.head.logo == ""
        assert len([text for text in sheet.warnings if text.startswith("the logo '")]) == 1
    if hasattr(os, "mkfifo"):  # a pipe does not keep the sheet waiting
        os.mkfifo(tmp_path / "sign.png")
        piped = with_logo(setup, "sign.png", tmp_path)
        assert logo_of(piped) == ("", "the logo 'sign.png' is left out: it is no ordinary file")


HOUSE = "h1 { color: #005f73; } </style><script>alert(1)</script>"


def test_the_letterhead_and_an_own_style_sheet(setup: Setup, tmp_path: Path) -> None:
    """The company's lines stand once, above the title; the style comes last, and ends nothing that holds it."""
    (tmp_path / "house.css").write_text(HOUSE, encoding="utf-8")
    stated = with_logo(setup, "", tmp_path)
    letter = {"company": "Weber GmbH <b>", "address": "Hafenstr. 3, Kiel", "document": "C-0815", "style": "house.css"}
    sheet = sheet_of(replace(stated, sheet=SheetOptions(head=letter)))
    assert [text for text in sheet.warnings if "style" in text] == []
    html, markdown = html_of(sheet), markdown_of(sheet)
    assert '<p class="letter"><span>Weber GmbH &lt;b&gt;</span><span>Hafenstr. 3, Kiel</span></p>' in html
    assert ("Document", "C-0815") in sheet.head.fields
    assert {label for label, _ in sheet.head.fields} & {"Company", "Address", "Style"} == set()
    own = html.index("h1 { color: #005f73; }")
    assert html.rindex("@page") < own < html.index("</style>")
    assert "<script" not in html
    assert markdown.startswith("**Weber GmbH &lt;b&gt;**, Hafenstr. 3, Kiel\n\n# ")
    (tmp_path / "house.css").write_bytes(b"\xff\xfe")
    assert style_of(replace(stated, sheet=SheetOptions(head={"style": "house.css"}))) == (
        "", "the style 'house.css' is left out: it is no UTF-8 text",
    )  # fmt: skip


def test_cases_are_listed_and_the_governing_one_is_marked(offer: Offer, tmp_path: Path) -> None:
    file = tmp_path / "cases.csv"
    file.write_text("case,load [N]\nlight,60\nheavy <b>,200\nmiddle,120\n", encoding="utf-8")
    setup = setup_from_text("", offer, file="x", folder=tmp_path)
    with open_executor("serial") as executor:
        calculation, cases = run_cases(setup, read_cases(file, offer, setup), executor=executor)
    sheet = make_sheet(calculation, provenance=provenance_of(setup), cases=cases)
    (table,) = chapter_of(sheet, "Cases").blocks
    assert [row[:2] for row in table.rows] == [("light", "60"), ("heavy <b>", "200"), ("middle", "120")]
    assert table.states == ("", "marked", "")
    assert sheet.banner.sentences == ("3 of 3 cases fail; the governing case is heavy <b>.",)
    assert "heavy &lt;b&gt;" in html_of(sheet)
    assert "**heavy &lt;b&gt;**" in markdown_of(sheet)


def test_the_title_in_the_margin_cannot_leave_its_string() -> None:
    for text in ("</style><script>", '"; } body { display: none', "\\", "Ø 5 µm", "\n\n*/"):
        assert re.fullmatch(r"(?:[A-Za-z0-9]|\\[0-9a-f]+ )*", css_text(text))


def test_the_same_run_gives_the_same_sheet(setup: Setup) -> None:
    first, again = (html_of(sheet_of(setup)) for _ in range(2))
    assert first == again


def test_the_title_block_leaves_room_for_what_is_not_stated(setup: Setup) -> None:
    plain = {"Project": "", "Drawing": "", "Revision": "", "Date": "2026-11-21"}
    for head in ({}, {"project": "P", "date": "1 May"}):
        sheet = sheet_of(replace(setup, sheet=SheetOptions(head=head)))
        assert dict(sheet.head.fields) == {**plain, **{name.capitalize(): text for name, text in head.items()}}
        assert sheet.head.signatures == (("Prepared", ""), ("Checked", ""), ("Approved", ""))


def test_a_data_file_is_named_on_the_sheet(tmp_path: Path) -> None:
    (tmp_path / "flank <1>.txt").write_text("1\n2\n")
    kernel = Kernel()
    kernel.add_file(DATA / "worn_surface.py")
    inputs = '[inputs]\nsurface = "flank <1>.txt"\n'
    setup = setup_from_text(inputs, kernel.offer("worn_surface"), file="inputs.toml", folder=tmp_path)
    page = html_of(sheet_of(setup))
    assert "flank &lt;1&gt;.txt" in page.replace("\u00a0", " ")


# Inputs that nobody stated


@pytest.mark.parametrize(("detail", "is_named_only"), [("normal", True), ("full", False)])
def test_inputs_not_given_or_at_0_are_named_in_one_sentence_unless_all_is_asked_for(
    detail: str, is_named_only: bool
) -> None:
    model = replace(PRESS_LINKAGE, sheet=[], published=[])
    text = Page(html_of(sheet_of(replace(default_setup(model), sheet=SheetOptions(detail=detail), studies=())))).text
    assert ("Not given, or left at their default of 0 (inputs.toml names them)" in text) is is_named_only
    assert ("deviation: crank, A to B" in text) is not is_named_only
    assert "crank, A to B" in text


# Markdown from hostile texts: read by another program, it must give the text back and nothing else.

HOSTILE_MARKS = [
    "<script>alert(1)</script>", "{{7*7}} {% raw %}", "$x$ and $$y$$", "a | b", "# heading", "`code` ``more``",
    "[text](https://evil.example) ![picture](x.png)", "[text][1] [1]: https://evil.example",
    "<https://evil.example> https://evil.example www.evil.example", "**bold** __bold__ *i* _i_ ~~struck~~", "- item",
    "+ item", "1. item", "12) item", "> quoted", "=====", "---", "***", "    indented", "one\n\ntwo\n# three",
    "\\* \\| \\", "&lt;b&gt; &amp; &#36;", "trailing backslash \\", "```\nfence\n```", "~~~", "| a |\n| --- |",
    "a\u202eb\x00c\x1b[31m",
]  # fmt: skip
ONLY = {"inline", "text", "text_special", "paragraph_open", "paragraph_close"}


def read(markdown: str) -> list[Token]:
    return MarkdownIt("commonmark", {"linkify": False}).enable(["table", "strikethrough"]).parse(markdown)


def words(tokens: list[Token]) -> str:
    return "".join(child.content for token in tokens for child in token.children or [])


@given(st.text() | st.sampled_from(HOSTILE_MARKS))
def test_any_text_is_read_back_as_itself(text: str) -> None:
    tokens = read(escaped(text))
    kinds = {token.type for token in tokens} | {child.type for token in tokens for child in token.children or []}
    assert kinds <= ONLY
    assert words(tokens) == printable(text)


def test_a_hostile_text_stays_in_its_cell() -> None:
    for text in HOSTILE_MARKS:
        tokens = read(f"| head | next |\n| --- | --- |\n| {escaped(text)} | end |")
        cells = [tokens[place + 1] for place, token in enumerate(tokens) if token.type == "td_open"]
        assert [words([cell]) for cell in cells] == [printable(text), "end"]


def test_marks_that_other_readers_obey_do_not_stand_in_the_source() -> None:
    for mark in ("<", ">", "$", "|", "{", "}", "https://", "mailto:", "www."):
        assert mark not in escaped(f"a {mark} b {mark}c")


def test_tables_of_studies_say_what_a_quantity_is() -> None:
    table = TableView("", (Column("source"), Column("crank_angle")), (("crank_radius", "no name"), ("IT7", "stroke")))
    named = with_notes(table, PRESS_LINKAGE)
    assert [column.title for column in named.columns] == ["source", "crank angle"]
    assert plain_text(named.rows[0][0]) == "crank, A to B a (crank_radius)"
    assert plain_text(named.rows[1][1]) == "stroke of the slider H (stroke)"
    assert (named.rows[0][1], named.rows[1][0]) == ("no name", "IT7")
