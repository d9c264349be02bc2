"""Figures: what a plugin draws with matplotlib, as SVG that is the same byte by byte on every machine.

Text becomes outlines, so that a figure looks the same wherever the sheet is opened. Identifiers get the figure's own
prefix, because all figures of a sheet share one page.
"""

from __future__ import annotations

import re
import traceback
from collections.abc import Callable
from html import escape
from io import StringIO
from typing import Any

from truing.errors import PluginError

STYLE = {
    "svg.fonttype": "path",
    "svg.hashsalt": "truing",
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "axes.titlesize": 10.0,
    "axes.labelsize": 9.0,
    "axes.linewidth": 0.7,
    "axes.edgecolor": "#333333",
    "axes.grid": False,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": "#d5d8dc",
    "grid.linewidth": 0.5,
    "lines.linewidth": 1.4,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "xtick.major.width": 0.7,
    "ytick.major.width": 0.7,
    "legend.frameon": False,
    "legend.fontsize": 8.0,
    "figure.figsize": (6.4, 3.6),
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
}
"""The look of every figure; a plugin may say otherwise for its own."""

_IDENTIFIER = re.compile(r'\bid="([^"]+)"')
_REFERENCE = re.compile(r'(url\(#|href="#)([^)"]+)')
_ROOT = re.compile(r"<svg\b[^>]*>")
_VIEW_BOX = re.compile(r'viewBox="([-\d. ]+)"')
_NOT_WANTED = (
    re.compile(r"<!--.*?-->", re.DOTALL),
    re.compile(r"<metadata>.*?</metadata>", re.DOTALL),
    re.compile(r"<style\b.*?</style>", re.DOTALL),
    re.compile(r"<script\b.*?</script>", re.DOTALL),
    re.compile(r"<defs>\s*</defs>"),
)


def draw(what: Callable[[], Any], *, title: str, ident: str) -> str:
    """Draw a figure and return it as an ``<svg>`` element with ``role="img"`` and a title.

    ``what()`` returns a matplotlib Figure. Raises PluginError, naming the figure and the place, where drawing fails.
    """
    import matplotlib as mpl

    look: Any = {key: value for key, value in mpl.rcParamsDefault.items() if not key.startswith("backend")}
    look.update(STYLE)
    with mpl.rc_context(look):
        try:
            figure = what()
            stream = StringIO()
            figure.savefig(stream, format="svg", metadata={"Date": None}, bbox_inches="tight", pad_inches=0.06)
        except Exception as error:
            frame = traceback.extract_tb(error.__traceback__)[-1]
            place = f"{frame.filename}:{frame.lineno}"
            raise PluginError(f"{place}: the figure '{title}' failed: {type(error).__name__}: {error}") from error
    return inlined(stream.getvalue(), title=title, ident=ident)


def inlined(svg: str, *, title: str, ident: str) -> str:
    """Make an SVG document fit to stand inside a page: own identifiers, no style of its own, a title."""
    body = svg[svg.index("<svg") :]
    for pattern in _NOT_WANTED:
        body = pattern.sub("", body)
    body = _IDENTIFIER.sub(rf'id="{ident}-\1"', body)
    body = _REFERENCE.sub(rf"\1{ident}-\2", body)
    opening = _ROOT.match(body)
    box = _VIEW_BOX.search(body)
    assert opening is not None
    assert box is not None, "matplotlib writes a viewBox"
    width, height = box.group(1).split()[2:]
    root = (
        f'<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
        f'viewBox="{box.group(1)}" width="{width}pt" height="{height}pt" role="img" aria-labelledby="{ident}-title" '
        f'style="stroke-linejoin: round; stroke-linecap: butt">'
        f'<title id="{ident}-title">{escape(title)}</title>'
    )
    return root + re.sub(r"\n\s*", "\n", body[opening.end() :]).strip()
