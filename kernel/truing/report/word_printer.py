"""A document for Word: headings to navigate by, formulas that stay formulas, tables, figures as pictures."""

from __future__ import annotations

import base64
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from html import escape
from io import BytesIO
from typing import Any, Final

from truing.errors import PluginError, UsageError
from truing.formulas.symbols import printable
from truing.formulas.write_omml import OMML, symbol_omml
from truing.heavy import docx
from truing.numbers import pretty, with_unit
from truing.report import equations
from truing.report.document import (
    MARKS,
    BlockView,
    Chapter,
    Document,
    Equation,
    FigurePair,
    FigureView,
    Fold,
    Items,
    Marked,
    Paragraph,
    Piece,
    ResultEntry,
    TableView,
    Text,
    Value,
    plain_text,
    state_words,
)
from truing.report.figures import PIXELS_PER_INCH, draw_png
from truing.report.translation import Catalogue, kernel_catalogue
from truing.workbooks.writing import undated

PAPERS: Final = {"A4": (210.0, 297.0), "letter": (215.9, 279.4)}
"""Width and height, mm, of what the sheet may be printed on."""
MARGIN, ABOVE = 20.0, 16.0
"""White edges of a page, mm, beside its text with room to punch, and above and below."""
LINE: Final = 42.0
"""How wide a line of a formula may be, in em as estimated: an eighth less than 170 mm at 10 points."""
INCH: Final = 25.4
"""mm."""
BODY, IN_TABLE, SMALLEST = 10.0, 9.0, 6.5
"""Sizes of type, points: of text, in tables, and in a table whose columns do not fit otherwise."""
PER_CHARACTER: Final = 0.19
"""Width of a character in mm, for each point of its size: the mean of digits and lower-case letters of Calibri."""
PADDING: Final = 4.0
"""White space beside the text of a cell, mm."""
LONGEST_WORD, WIDEST_CELL = 24, 90
"""So many characters of a word ask for one line; so many of a cell count where columns share the width."""
LOWER: Final = 0.8
"""How high the figure of page one is, as a share of its height beside the key results: here it stands below them."""
GAP: Final = '<w:p><w:pPr><w:spacing w:before="0" w:after="0" w:line="120" w:lineRule="exact"/></w:pPr></w:p>'
"""What parts a table from what follows: 6 points."""
GREY, DARK = "666666", "1F3A5F"
MOODS: Final = {
    "passes": "E3F2E6", "calm": "E3F2E6", "proposed": "FFF4D6", "undecided": "FFF4D6", "open": "FFF4D6",
    "fails": "FBE3E1", "found": "E4EDF7", "none": "EEF0F2",
}  # fmt: skip
"""The colour behind the verdict, by the mood of the banner."""
NAMESPACES: Final = (
    'xmlns:w="http://schemas.openxmlformats.org/wordprocessingml/2006/main" '
    'xmlns:m="http://schemas.openxmlformats.org/officeDocument/2006/math"'
)
KEEP_NEXT: Final = "<w:keepNext/>"


def demand_word_library() -> None:
    """Raise UsageError where the library is not installed that writes Word documents; before a long calculation."""
    try:
        assert docx.Document
    except ImportError:
        raise UsageError(
            "a Word document needs python-docx, which is not installed: pip install 'truing[word]'"
        ) from None


def word_of(document: Document) -> bytes:
    """Write a document as .docx, the same bytes whenever it is done.

    Raises UsageError where the library is missing.
    """
    demand_word_library()
    paper = PAPERS[document.paper]
    page = _Page(docx.Document(), paper[0] - 2 * MARGIN, kernel_catalogue(document.language))
    _set_up(page, document, paper)
    _head(page, document)
    for index, chapter in enumerate(document.front):
        _chapter(page, chapter, index, highest=LOWER * document.figure_height)
    if document.head.signatures:
        page.add(_signatures(document.head.signatures, page))
    listed = [*document.front, *document.chapters]
    if document.detail != "short":
        page.add(*_contents(listed, page.words))
    for index, chapter in enumerate(document.chapters, start=len(document.front)):
        _chapter(page, chapter, index)
    stream = BytesIO()
    page.word.save(stream)
    return undated(stream.getvalue())


@dataclass(frozen=True)
class _Page:
    """What is being written, how wide its text is, mm, and in which words."""

    word: Any
    width: float
    words: Catalogue

    def add(self, *blocks: str) -> None:
        """Add the markup of paragraphs and tables at the end."""
        body = self.word.element.body
        for element in docx.parse_xml(f"<w:body {NAMESPACES}>{''.join(blocks)}</w:body>"):
            body.insert_element_before(element, "w:sectPr")


# The document as a whole


def _set_up(page: _Page, document: Document, paper: tuple[float, float]) -> None:
    """Set paper, styles, footer, and what the file says of itself."""
    word = page.word
    section = word.sections[0]
    section.page_width, section.page_height = map(docx.Mm, paper)
    section.left_margin = section.right_margin = docx.Mm(MARGIN)
    section.top_margin = section.bottom_margin = docx.Mm(ABOVE)
    section.footer_distance = docx.Mm(ABOVE / 2)
    _set_styles(word.styles, page.width)
    for setting in word.settings.element.iter(docx.qn("w:compatSetting")):
        if setting.get(docx.qn("w:name")) == "compatibilityMode":
            setting.set(docx.qn("w:val"), "15")  # as Word 2013 and later; what is older is opened in another mode
    said = word.core_properties
    said.title, said.subject = _safe(document.title)[:255], _safe(document.kind)[:255]
    said.author, said.comments, said.last_modified_by = "", "", ""
    pages = (
        _run("\t"),
        _run(f"{page.words.said('Page')} "),
        _field("PAGE"),
        _run(f" {page.words.said('of')} "),
        _field("NUMPAGES"),
    )
    footer = section.footer.paragraphs[0]
    written = docx.parse_xml(
        f"<w:p {NAMESPACES}>{_run(_safe(document.head.footer)[:110], color=GREY)}{''.join(pages)}</w:p>"
    )
    footer._p.extend(list(written))


def _set_styles(styles: Any, width: float) -> None:
    """Set the sizes and spaces of the styles that are used; all of them stay those of Word, by name."""
    sizes = {
        "Normal": BODY,
        "Title": 20,
        "Heading 1": 13,
        "Heading 2": 11,
        "Caption": IN_TABLE,
        "Footer": 8,
        "List Bullet": BODY,
    }
    spaces = {"Normal": (0, 4), "Title": (2, 2), "Heading 1": (12, 4), "Heading 2": (8, 3), "Caption": (2, 8)}
    for name, size in sizes.items():
        style = styles[name]
        style.font.size = docx.Pt(size)
        fonts = style.element.get_or_add_rPr().get_or_add_rFonts()
        for key in list(fonts.attrib):
            del fonts.attrib[key]
        style.font.name = "Calibri"
    for name, (before, behind) in spaces.items():
        shape = styles[name].paragraph_format
        shape.space_before, shape.space_after, shape.line_spacing = docx.Pt(before), docx.Pt(behind), 1.0
    for name, color in {"Title": DARK, "Heading 1": DARK, "Heading 2": DARK, "Caption": "000000"}.items():
        styles[name].font.color.rgb = docx.RGBColor.from_string(color)
    styles["Caption"].font.bold = False
    contents = styles.add_style("toc 1", docx.WD_STYLE_TYPE.PARAGRAPH, builtin=True)
    contents.base_style = styles["Normal"]
    right = docx.WD_TAB_ALIGNMENT.RIGHT
    contents.paragraph_format.tab_stops.add_tab_stop(docx.Mm(width), right, docx.WD_TAB_LEADER.DOTS)
    stops = styles["Footer"].paragraph_format.tab_stops
    stops.clear_all()
    stops.add_tab_stop(docx.Mm(width), right)


def _head(page: _Page, document: Document) -> None:
    """Write the title block and the verdict."""
    head, banner = document.head, document.banner
    if head.logo:
        _logo(page, head.logo)
    page.add(*(_paragraph(_run(_safe(line), bold=place == 0)) for place, line in enumerate(head.letter)))
    page.add(_paragraph(_run(_safe(document.kind), color=GREY)), _paragraph(_run(_safe(head.title)), "Title"))
    page.add(*(_paragraph(_run(_safe(text))) for text in (head.model, document.summary) if text))
    page.add(_pairs(head.fields, page.width), GAP)
    sentences = [_said(sentence) for sentence in banner.sentences]
    sentences[0] = _run(f"{MARKS[banner.mood]} {_safe(banner.headline)}. ", bold=True) + sentences[0]
    if document.warnings:
        sentences[-1] += _run(f" {page.words.said(f'See the warnings ({len(document.warnings)}).')}")
    behind = f'<w:shd w:val="clear" w:color="auto" w:fill="{MOODS[banner.mood]}"/>'
    page.add(*(_paragraph(sentence, shape=behind) for sentence in sentences))
    slip = _run(f"{page.words.said('Suspected unit slip.')} ", bold=True)
    unchanged = _run(f" {page.words.said('Nothing was changed.')}")
    page.add(*(_paragraph(f"{slip}{_run(_safe(text))}{unchanged}") for text in document.alarms))


def _logo(page: _Page, address: str) -> None:
    """Add the company's sign; of a kind that Word documents do not take, say so in its place."""
    data = address.partition(";base64,")[2]
    try:
        page.word.add_picture(BytesIO(base64.b64decode(data, validate=True)), height=docx.Mm(14))
    except Exception:  # of a picture that is none, the library may fail anywhere
        said = page.words.said("The logo cannot stand in a Word document: state a .png or .jpg file.")
        page.add(_paragraph(_run(said, color=GREY)))


def _pairs(fields: Sequence[tuple[str, str]], width: float, *further: str) -> str:
    """Write labels with what stands below each, and further lines below that, all on one page."""
    labels = [_run(_safe(label), color=GREY, size=8) for label, _ in fields]
    texts = [_run(_safe(text)) for _, text in fields]
    rows = [labels, texts, *([_run(line, color=GREY, size=8)] * len(fields) for line in further)]
    wide = width / len(fields)
    return _grid([_row([_cell(cell, wide, keeps=True) for cell in row]) for row in rows], [wide] * len(fields))


def _signatures(signatures: Sequence[tuple[str, str]], page: _Page) -> str:
    return GAP + _pairs(signatures, page.width, page.words.said("Date, signature")) + GAP


def _contents(chapters: Sequence[Chapter], words: Catalogue) -> Iterator[str]:
    """Write a table of contents whose lines lead to their chapters; Word fills in the pages when it is updated."""
    yield _paragraph(_run(words.said("Contents"), bold=True, size=13, color=DARK), shape=KEEP_NEXT)
    instruction = r' TOC \o "1-1" \h \z \u '
    begin = f'{_mark("begin")}<w:r><w:instrText xml:space="preserve">{escape(instruction)}</w:instrText></w:r>'
    for index, chapter in enumerate(chapters):
        link = f'<w:hyperlink w:anchor="{_anchor(index)}" w:history="1">{_run(_title(chapter))}</w:hyperlink>'
        opening = f"{begin}{_mark('separate')}" if index == 0 else ""
        yield _paragraph(f"{opening}{link}{_mark('end') if index == len(chapters) - 1 else ''}", "TOC1")


def _mark(kind: str) -> str:
    return f'<w:r><w:fldChar w:fldCharType="{kind}"/></w:r>'


def _field(instruction: str) -> str:
    return f'<w:fldSimple w:instr=" {instruction} ">{_run("1")}</w:fldSimple>'


def _anchor(index: int) -> str:
    return f"_Toc{index + 1:08d}"


def _title(chapter: Chapter) -> str:
    return _safe(f"{chapter.number} {chapter.title}".strip())


# Chapters and blocks


def _chapter(page: _Page, chapter: Chapter, index: int, *, highest: float | None = None) -> None:
    """Write a chapter; figures are at most so many mm high, and never higher than half of a page."""
    bookmark = f'<w:bookmarkStart w:id="{index + 1}" w:name="{_anchor(index)}"/>'
    page.add(_paragraph(f'{bookmark}{_run(_title(chapter))}<w:bookmarkEnd w:id="{index + 1}"/>', "Heading1"))
    _add_blocks(page, chapter.blocks, highest or PAPERS["letter"][1] / 2)


def _add_blocks(page: _Page, blocks: Iterable[BlockView], highest: float) -> None:
    """Write blocks; what is folded has a heading, and what paper leaves out is left out here."""
    for block in blocks:
        match block:
            case FigureView():
                _figure(page, block, highest)
            case FigurePair():
                _pair(page, block, highest / 2)
            case Fold(title, inner, printed):
                if printed:
                    page.add(_paragraph(_run(_safe(title)), "Heading2"))
                    _add_blocks(page, inner, highest)
            case _:
                page.add(*_block(block, page))


def _block(block: BlockView, page: _Page) -> Iterator[str]:
    match block:
        case Paragraph(text, kind):
            head = "" if kind in ("note", "aside") else _run(f"{page.words.said(kind.capitalize())}. ", bold=True)
            yield _paragraph(head + (_said(text, color=GREY) if kind == "aside" else _said(text)))
        case Items():
            yield from _items(block)
        case TableView():
            yield from _table(block, page)
        case ResultEntry():
            yield from _entry(block)


def _items(items: Items) -> Iterator[str]:
    style = "ListNumber" if items.kind == "references" else "ListBullet"
    for index, text in enumerate(items.texts):
        label = items.labels[index] if items.labels else ""
        label = label and f"{label}. " if items.kind == "findings" else label and f"{label}: "
        yield _paragraph(_run(_safe(label), bold=items.kind == "findings") + _said(text), style)


def _entry(entry: ResultEntry) -> Iterator[str]:
    """Write a result: what it is, its formula line by line, its value, and how it was found."""
    note, *rest = entry.label if isinstance(entry.label, tuple) else (entry.label,)
    parts = [] if entry.equation is None else [*_equation(entry.equation)]
    parts += [_paragraph(_said(entry.value), shape=_indent())] if entry.value else []
    parts += [_paragraph(_said(entry.method, color=GREY), shape=_indent())] if entry.method else []
    yield _paragraph(_said(note, bold=True) + _said(tuple(rest)), shape=KEEP_NEXT if parts else "")
    yield from parts


def _indent() -> str:
    return f'<w:ind w:left="{_twips(PADDING)}"/>'


def _equation(equation: Equation) -> Iterator[str]:
    """Set a formula, a paragraph for each of its lines."""
    lines = equations.lines(OMML, equation, limit=LINE)
    for number, line in enumerate(lines, start=1):
        keeps = KEEP_NEXT if number < len(lines) else ""
        left = '<m:oMathParaPr><m:jc m:val="left"/></m:oMathParaPr>'
        mathematics = f"<m:oMathPara>{left}<m:oMath>{line.markup}</m:oMath></m:oMathPara>"
        yield _paragraph(mathematics, shape=f"{keeps}{_indent()}")


def _figure(page: _Page, view: FigureView, highest: float) -> None:
    """Write a figure with its caption; say where it cannot be drawn again: a run is not lost for a picture."""
    if not _picture(page, view, highest):
        page.add(_paragraph(_run(_safe(f"The figure '{view.title}' could not be drawn again."), bold=True)))
        return
    page.add(_caption(page, view.number, view.caption))


def _pair(page: _Page, pair: FigurePair, highest: float) -> None:
    """Write two figures one below the other; those that were read from a sheet cannot be drawn again."""
    for word, view in (("Before", pair.before), ("After", pair.after)):
        page.add(_paragraph(_run(page.words.said(word), color=GREY), shape=KEEP_NEXT))
        if view is None:
            page.add(_paragraph(_run(page.words.said("No such figure.")), shape=KEEP_NEXT))
        elif not _picture(page, view, highest):
            words = page.words.said("This figure was read from a sheet: it stands there, and cannot be drawn for Word.")
            page.add(_paragraph(_run(words), shape=KEEP_NEXT))
    page.add(_caption(page, pair.number, pair.title))


def _caption(page: _Page, number: int, text: str) -> str:
    return _paragraph(_run(f"{page.words.said('Figure')} {number}. ", bold=True) + _run(_safe(text)), "Caption")


def _picture(page: _Page, view: FigureView, highest: float) -> bool:
    """Draw a figure again as pixels, as large as it is drawn where the page has room; tell whether it can be drawn."""
    try:
        stream = BytesIO(draw_png(view.drawing, title=view.title))
    except PluginError:
        return False
    picture = page.word.add_picture(stream)
    wide, high = (size / PIXELS_PER_INCH * INCH for size in _pixels(stream.getvalue()))
    share = min(1.0, page.width / wide, highest / high)
    picture.width, picture.height = docx.Mm(wide * share), docx.Mm(high * share)
    picture._inline.docPr.set("descr", _safe(plain_text(view.caption)))
    picture._inline.docPr.set("name", f"Figure {view.number}")
    page.word.paragraphs[-1].paragraph_format.keep_with_next = True
    return True


def _pixels(png: bytes) -> tuple[int, int]:
    """Return width and height of a picture, which stand at the beginning of every PNG."""
    return int.from_bytes(png[16:20], "big"), int.from_bytes(png[20:24], "big")


# Tables


def _table(table: TableView, page: _Page) -> Iterator[str]:
    """Write a table whose header is repeated on every page; numbers stand to the right."""
    widths, size = _widths(table, page.width)
    heads = [_run(_safe(column.heading), bold=True, size=size) for column in table.columns]
    cells = zip(heads, table.columns, widths, strict=True)
    rows = [_row([_cell(text, wide, column.kind, "E8ECF1") for text, column, wide in cells], is_header=True)]
    for index, texts in enumerate(table.rows):
        is_marked = bool(table.states) and table.states[index] == "marked"
        said = [_said(text, size=size, bold=is_marked) for text in texts]
        said[0] += _run(f" {page.words.said('governs')}", size=size, color=GREY) if is_marked else ""
        together = zip(said, table.columns, widths, strict=True)
        rows.append(_row([_cell(text, wide, column.kind) for text, column, wide in together]))
    if table.title:
        yield _paragraph(_run(_safe(table.title), size=IN_TABLE), "Caption", shape=KEEP_NEXT)
    yield _grid(rows, widths, lines=True)
    yield GAP
    if table.note:
        yield _paragraph(_said(table.note, size=IN_TABLE))


def _widths(table: TableView, width: float) -> tuple[list[float], float]:
    """Return the widths of the columns, mm, and the size of type at which every word has room.

    Where all cells fit on one line each, a column is as wide as its longest; else what the longest words leave is
    shared out.
    """
    words, cells = [], []
    for index, column in enumerate(table.columns):
        texts = [column.heading, *(plain_text(row[index]) for row in table.rows)]
        whole = [text for text in texts[1:] if column.kind == "number"]
        parts = [part for text in texts for part in re.split(r"\s+|(?<=[-_])", text)]
        heads = [len(part) + 1 for part in column.heading.split()]  # bold letters are wider
        words.append(max([*heads, *(min(len(part), LONGEST_WORD) for part in [*parts, *whole])]))
        cells.append(max(words[-1], len(texts[0]) / 2, *(min(len(text), WIDEST_CELL) for text in texts[1:])))
    size = IN_TABLE
    while size > SMALLEST and sum(words) * PER_CHARACTER * size + PADDING * len(words) > width:
        size -= 0.5
    least, most = ([count * PER_CHARACTER * size + PADDING for count in counts] for counts in (words, cells))
    if sum(most) <= width:
        return most, size
    left, asked = width - sum(least), sum(most) - sum(least)
    if left < 0 or asked <= 0:
        return [wide * width / sum(least) for wide in least], size
    return [low + left * (high - low) / asked for low, high in zip(least, most, strict=True)], size


def _grid(rows: Iterable[str], widths: Sequence[float], *, lines: bool = False) -> str:
    sides = ("top", "bottom", "insideH") if lines else ()
    borders = "".join(f'<w:{side} w:val="single" w:sz="4" w:space="0" w:color="B8C0CA"/>' for side in sides)
    shape = f'<w:tblW w:w="{_twips(sum(widths))}" w:type="dxa"/><w:tblBorders>{borders}</w:tblBorders>'
    columns = "".join(f'<w:gridCol w:w="{_twips(wide)}"/>' for wide in widths)
    shape = f'<w:tblPr>{shape}<w:tblLayout w:type="fixed"/></w:tblPr>'
    return f"<w:tbl>{shape}<w:tblGrid>{columns}</w:tblGrid>{''.join(rows)}</w:tbl>"


def _row(cells: Iterable[str], *, is_header: bool = False) -> str:
    repeated = "<w:tblHeader/>" if is_header else ""
    return f"<w:tr><w:trPr><w:cantSplit/>{repeated}</w:trPr>{''.join(cells)}</w:tr>"


def _cell(content: str, width: float, kind: str = "", fill: str = "", *, keeps: bool = False) -> str:
    right = '<w:jc w:val="right"/>' if kind == "number" else ""
    behind = f'<w:shd w:val="clear" w:color="auto" w:fill="{fill}"/>' if fill else ""
    shape = f'{KEEP_NEXT if keeps else ""}<w:spacing w:before="20" w:after="20"/>{right}'
    own = f'<w:tcPr><w:tcW w:w="{_twips(width)}" w:type="dxa"/>{behind}</w:tcPr>'
    return f"<w:tc>{own}{_paragraph(content, shape=shape)}</w:tc>"


# Paragraphs and pieces of text: whatever a user or a plugin writes is escaped, and holds no control characters


def _paragraph(content: str = "", style: str = "", *, shape: str = "") -> str:
    named = f'<w:pStyle w:val="{style}"/>' if style else ""
    return f"<w:p><w:pPr>{named}{shape}</w:pPr>{content}</w:p>"


def _run(text: str, *, bold: bool = False, color: str = "", size: float = 0.0, font: str = "") -> str:
    """Write characters that are safe already; a tab becomes one of Word."""
    if not text:
        return ""
    marks = f'<w:rFonts w:ascii="{font}" w:hAnsi="{font}" w:cs="{font}"/>' if font else ""
    marks += "<w:b/>" if bold else ""
    marks += f'<w:color w:val="{color}"/>' if color else ""
    marks += f'<w:sz w:val="{round(2 * size)}"/>' if size else ""
    content = "<w:tab/>" if text == "\t" else f'<w:t xml:space="preserve">{escape(text)}</w:t>'
    return f"<w:r><w:rPr>{marks}</w:rPr>{content}</w:r>"


def _said(text: Text, *, bold: bool = False, color: str = "", size: float = 0.0) -> str:
    """Write a text with all its pieces."""
    pieces = text if isinstance(text, tuple) else (text,)
    return "".join(_piece(piece, bold, color, size) for piece in pieces)


def _piece(piece: Piece, bold: bool, color: str, size: float) -> str:
    match piece:
        case str():
            return _run(_safe(pretty(piece)), bold=bold, color=color, size=size)
        case Value(text, unit):
            number = _safe(with_unit(pretty(text), unit)).replace(" ", "\u00a0")
            return _run(number, bold=bold, color=color, size=size)
        case Marked("symbol", text):
            return f"<m:oMath>{symbol_omml(str(text))}</m:oMath>"
        case Marked("code" | "bracketed code", name):
            return _run(_safe(str(name)), color=GREY, size=(size or BODY) - 1, font="Consolas")
        case Marked("strong", inner):
            return _piece(inner, True, color, size)
        case Marked("aside", inner):
            return _piece(inner, bold, GREY, size)
        case Marked("source", inner):
            return _run("[", color=GREY, size=size) + _piece(inner, bold, GREY, size) + _run("]", color=GREY, size=size)
        case Marked("state", state):
            sign, word = state_words(piece)
            return _run(f"{sign} {word}", bold=bold or state != "passes", size=size)
        case Marked():
            return "<w:r><w:br/></w:r>"


def _safe(text: str) -> str:
    """Return a text on one line, without characters that hide or turn what is written, or that XML refuses."""
    return text if text.isprintable() else printable(text)


def _twips(millimetres: float) -> int:
    return round(millimetres / INCH * 1440)
