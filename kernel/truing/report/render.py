"""The sheet as HTML and as Markdown, both from the same content."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from functools import lru_cache
from html import escape
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from truing.formulas.symbols import printable
from truing.formulas.write_latex import LatexWriter
from truing.formulas.write_mathml import MathMLWriter
from truing.numbers import format_number, pretty, with_unit
from truing.published import ComparedRow
from truing.report import equations
from truing.report.columns import with_room
from truing.report.context import Equation, FigureView, ResultEntry, Sheet, TableView, Value
from truing.report.markdown import Raw, escaped
from truing.report.templates import template_folder
from truing.units import unit_text

COLUMN = equations.LINE
"""How wide a formula may be, in em, beside the words of its result; a wider one stands below them."""
WIDEST = 1.3
"""How much wider than estimated a formula may come out, in the widest of usual fonts; paper keeps room for that."""
LONG = 7
"""A sheet with more chapters than this has a table of contents."""


def html_of(sheet: Sheet) -> str:
    """Write a sheet as HTML."""
    return page("sheet.html.j2", sheet, has_contents=_is_long(sheet))


def page(template: str, sheet: Any, *, styles: Sequence[str] = ("sheet.css",), **more: Any) -> str:
    """Write a page from its template; ``sheet`` has a ``head``, whose footer stands in the margin of every page."""
    style = "".join((template_folder() / name).read_text(encoding="utf-8") for name in styles)
    style = _markup(style + page_style(sheet.head.footer))
    return with_room(_html().get_template(template).render(sheet=sheet, style=style, **more)) + "\n"


def markdown_of(sheet: Sheet) -> str:
    """Write a sheet as Markdown."""
    return markdown_page("sheet.md.j2", sheet)


def markdown_page(template: str, sheet: Any) -> str:
    """Write Markdown from its template, no two empty lines in a row."""
    text = _markdown().get_template(template).render(sheet=sheet)
    blocks = [line.rstrip() for line in text.splitlines()]
    kept = [line for index, line in enumerate(blocks) if line or (index and blocks[index - 1])]
    return "\n".join(kept).strip() + "\n"


def _is_long(sheet: Sheet) -> bool:
    return sheet.detail != "short" and len(sheet.chapters) > LONG


def page_style(footer: str) -> str:
    """Write what only this sheet's pages say: its title in the margin, from the second page on."""
    title = f'@page {{ @top-left {{ content: "{css_text(footer)}"; }} }}'
    return f"\n{title}\n@page :first {{ @top-left {{ content: none; }} }}\n"


def css_text(text: str) -> str:
    """Write any text inside a CSS string: everything but letters and digits as a code point."""
    short = printable(text)[:110]
    return "".join(c if c.isascii() and c.isalnum() else f"\\{ord(c):x} " for c in short)


def _markup(text: str) -> Any:
    return Markup(text)  # only for what this package wrote itself


def _environment(**options: Any) -> Environment:
    return Environment(
        loader=FileSystemLoader(template_folder()),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=False,
        **options,
    )


@lru_cache(maxsize=1)
def _html() -> Environment:
    made = _environment(autoescape=True, finalize=_printable)
    made.filters.update(
        number=lambda text: pretty(text),
        symbol=_symbol_html,
        formula=_equation_html,
        svg=lambda figure: _markup(figure.svg),
        value=_value_html,
        ratio=_ratio,
        digits=_paper_digits,
        unit=_unit,
        breakable=_breakable,
        unbroken=_unbroken,
        own=_markup,
    )
    made.tests.update(narrow=_is_narrow, wide=_is_wide)
    return made


@lru_cache(maxsize=1)
def _markdown() -> Environment:
    made = _environment(autoescape=False, finalize=escaped)
    made.filters.update(
        number=lambda text: pretty(text),
        symbol=_symbol_latex,
        formula=_equation_latex,
        image=_image,
        value=_value_text,
        table=_table_markdown,
        ratio=_ratio,
        digits=_paper_digits,
        unit=_unit,
        raw=Raw,
    )
    return made


def _printable(value: Any) -> Any:
    """Take control and direction characters out of every text that is no markup of ours."""
    return printable_text(value) if type(value) is str else value


def printable_text(text: str) -> str:
    """Return a text on one line, without characters that hide or turn what is written."""
    return text if text.isprintable() else printable(text)


def _symbol_html(item: Any) -> Any:
    if not item.symbol:
        return _markup("")
    return _markup(f"<math>{MathMLWriter().symbol(item.symbol)}</math>")


def _symbol_latex(item: Any) -> Raw:
    return Raw(f"${LatexWriter().symbol(item.symbol)}$" if item.symbol else "")


def _value_text(value: Value) -> str:
    return with_unit(pretty(value.text), value.unit)


def _value_html(value: Value) -> str:
    """Keep number and unit together, unless the text is a long one."""
    text = printable_text(_value_text(value))
    return text.replace(" ", "\u00a0") if len(text) < 30 else text


def _ratio(row: ComparedRow) -> str:
    return f"{row.ratio:.4f}".replace("-", "−") if row.ratio is not None else "–"


def _paper_digits(row: ComparedRow) -> tuple[str, str]:
    """Write the paper's number as it prints it and ours with as many digits, at least four."""
    paper = format_number(row.published.value, 10)
    digits = len(paper.partition("e")[0].replace(".", "").replace("-", "").lstrip("0"))
    return pretty(paper), pretty(format_number(row.value, max(digits + 1, 4)))


def _unit(unit: str) -> str:
    return unit_text(unit) if unit else ""


def _is_narrow(table: TableView) -> bool:
    return len(table.columns) <= 4


def _is_wide(entry: ResultEntry) -> bool:
    """Tell whether the formula of an entry needs the whole width of the page."""
    return entry.equation is not None and max(line.width for line in _html_lines(entry.equation)) > COLUMN


def _html_lines(equation: Equation) -> list[equations.Line]:
    return equations.lines(MathMLWriter(), equation)


def _equation_html(equation: Equation) -> Any:
    """Set a formula as blocks of MathML, one a line; ``--room`` is the width in em for which paper keeps room."""
    alternative = escape(f"{equation.name} = {equation.formula.text}")
    blocks = []
    lines = _html_lines(equation)
    room = f' style="--room: {WIDEST * max(line.width for line in lines):.0f}"'
    for index, line in enumerate(lines):
        label = f' alttext="{alternative}"' if index == 0 else ""
        mathematics = f'<math display="block"{label}><mrow>{line.markup}</mrow></math>'
        blocks.append(f'<div class="line{" next" if index else ""}"{room}>{mathematics}</div>')
    return _markup("".join(blocks))


def _unbroken(text: str) -> Any:
    """Keep the two ends of an interval on one line."""
    return _markup(escape(printable_text(text)).replace(" … ", "\u00a0…\u00a0"))


def _breakable(name: str) -> Any:
    """Let a long name break behind its underscores."""
    return _markup(escape(printable_text(name)).replace("_", "_<wbr>"))


def _equation_latex(equation: Equation) -> Raw:
    found = [line.markup for line in equations.lines(LatexWriter(), equation, limit=60.0)]
    if len(found) == 1:
        return Raw(f"$$\n{found[0]}\n$$")
    body = " \\cr\n& ".join(found)
    return Raw(f"$$\n\\begin{{aligned}}\n& {body}\n\\end{{aligned}}\n$$")


def _image(figure: FigureView) -> Raw:
    data = base64.b64encode(figure.svg.encode()).decode()
    return Raw(f"![{escaped(figure.title)}](data:image/svg+xml;base64,{data})")


def _table_markdown(table: TableView) -> Raw:
    """Write a pipe table; units stand in the headings."""
    titles: list[str] = [
        escaped(f"{title} [{unit}]" if unit else title)
        for title, unit in zip(table.columns, [*table.units, *[""] * len(table.columns)], strict=False)
    ]
    rule: list[str] = ["---:" if numeric else "---" for numeric in table.numeric]
    rows: list[list[str]] = [
        [_cell(cell, index == table.marked) for cell in row] for index, row in enumerate(table.rows)
    ]
    return Raw("\n".join("| " + " | ".join(cells) + " |" for cells in (titles, rule, *rows)))


def _cell(text: str, is_marked: bool) -> str:
    inner = escaped(pretty(text))
    return f"**{inner}**" if is_marked and inner else inner
