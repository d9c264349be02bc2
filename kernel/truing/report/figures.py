"""Figures: what a plugin draws with matplotlib, as SVG that is the same byte by byte on every machine, or as PNG.

Text becomes outlines, so that a figure looks the same wherever the sheet is opened. Identifiers get the figure's own
prefix, because all figures of a sheet share one page.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from html import escape
from io import BytesIO, StringIO
from typing import Any, TypeVar

import matplotlib as mpl
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_mixed import MixedModeRenderer
from matplotlib.backends.backend_svg import FigureCanvasSVG, RendererSVG
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties, findfont, get_font
from matplotlib.mathtext import MathTextParser
from matplotlib.text import Text
from matplotlib.ticker import FixedLocator
from matplotlib.transforms import Bbox

from truing.arrays import Matrix
from truing.errors import PluginError
from truing.formulas.symbols import printable
from truing.kernel.blame import spoken_place
from truing.report.figure_layout import arranged
from truing.report.translation import ENGLISH_WORDS, Catalogue

MOST_STATES = 6
"""So many states are drawn over time."""
STYLE = {
    "svg.hashsalt": "truing",
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "axes.titlesize": 10.0,
    "axes.linewidth": 0.7,
    "axes.edgecolor": "#333333",
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
    "savefig.facecolor": "white",
}
"""The look of every figure where it is not matplotlib's own; a plugin may say otherwise for its own."""

Drawn = TypeVar("Drawn", str, bytes)
POINTS_PER_INCH = 72
PIXELS_PER_INCH = 200
"""Of a picture of pixels: a line of 0.5 points is more than a pixel wide, and page-wide figures stay near 100 kB."""
EDGE = 4.3
"""Points that are kept around all that is drawn."""

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


@contextmanager
def styled() -> Iterator[None]:
    """Draw as on the sheet, whatever the user of this process has set."""
    look: Any = {key: value for key, value in mpl.rcParamsDefault.items() if not key.startswith("backend")}
    look.update(STYLE)
    with mpl.rc_context(look):
        yield


def states_over_time(states: Mapping[str, Matrix]) -> Figure:
    """Draw what changes over the first of these, (k,) each by their labels, one below another."""
    (label, time), *several = states.items()
    figure = Figure(figsize=(6.4, 0.8 + 1.4 * max(len(several[:MOST_STATES]), 1)), layout="constrained")
    panels = figure.subplots(max(len(several[:MOST_STATES]), 1), 1, sharex=True, squeeze=False)[:, 0]
    for panel, (name, values) in zip(panels, several, strict=False):
        panel.plot(time, values, linewidth=1.2)
        panel.set_ylabel(name)
        panel.grid(alpha=0.3)
    panels[-1].set_xlabel(label)
    return figure


def phase(states: Mapping[str, Matrix]) -> Figure:
    """Draw the second state that changes over the first, the time left out; a point marks where it begins."""
    figure = Figure(figsize=(4.2, 3.6), layout="constrained")
    panel = figure.subplots()
    (across, x), (up, y) = [*states.items()][1:3]
    panel.plot(x, y, linewidth=1.0)
    panel.plot(x[:1], y[:1], marker="o", markersize=4)
    panel.set_xlabel(across)
    panel.set_ylabel(up)
    panel.grid(alpha=0.3)
    return figure


def draw(what: Callable[[], Any], *, title: str, ident: str, words: Catalogue = ENGLISH_WORDS) -> str:
    """Draw a figure and return it as an ``<svg>`` element with ``role="img"`` and a title, its texts as ``words`` say.

    ``what()`` returns a matplotlib Figure. Raises PluginError, naming the figure and the place, where drawing fails.
    """
    return inlined(_drawn(in_words(what, words), _svg, title), title=words.said(title), ident=ident)


def in_words(what: Callable[[], Any], words: Catalogue) -> Callable[[], Any]:
    """Return what makes the same figure with its texts in another language."""
    return what if words.is_english else partial(_translated, what, words)


def _translated(what: Callable[[], Any], words: Catalogue) -> Any:
    """Put the texts of a figure into another language: labels, legends, titles, and ticks that are words."""
    figure = what()
    for axis in figure.findobj(Axis):
        if isinstance(axis.get_major_locator(), FixedLocator):
            ticks = [label.get_text() for label in axis.get_ticklabels()]
            if (said := [words.said(tick) for tick in ticks]) != ticks:
                axis.set_ticks(axis.get_ticklocs(), said)
    for text in figure.findobj(Text):
        text.set_text(words.said(text.get_text()))
    return figure


def draw_png(what: Callable[[], Any], *, title: str) -> bytes:
    """Draw a figure as ``draw`` does, and return it as PNG with ``PIXELS_PER_INCH``. Raises PluginError."""
    return _drawn(what, _png, title)


def _drawn(what: Callable[[], Any], write: Callable[[Any], Drawn], title: str) -> Drawn:
    with styled():
        try:
            return _saved(what(), write)
        except Exception as error:
            place, words = spoken_place(error), " ".join(f"{type(error).__name__}: {error}".split())
            raise PluginError(f"{place}the figure '{title}' failed: {words}") from error


def _saved(figure: Any, write: Callable[[Any], Drawn]) -> Drawn:
    """Write a figure; a text between dollars that is no formula is printed as it stands."""
    try:
        return write(figure)
    except ValueError:
        parser: Any = MathTextParser("path")
        texts = [text for text in figure.findobj(Text) if text.get_parse_math() and "$" in text.get_text()]
        for text in texts:
            try:
                parser.parse(text.get_text())
            except ValueError:
                text.set_parse_math(False)
        if all(text.get_parse_math() for text in texts):
            raise
    return write(figure)


class _Writer(RendererSVG):
    """Writes SVG and asks each font for its height once; matplotlib finds and opens the font anew for every text."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)  # type: ignore[no-untyped-call]
        self._heights: dict[FontProperties, tuple[float, float, float]] = {}

    def _get_font_height_metrics(self, properties: FontProperties) -> tuple[float | None, float | None, float | None]:
        """Return ascent, descent and line gap in pixels. Matplotlib asks a renderer that has this before it looks."""
        if properties not in self._heights:
            font = get_font(findfont(properties))
            table = font.get_sfnt_table("OS/2")
            if table is None:
                return None, None, None
            scale = properties.get_size_in_points() / font.units_per_EM
            ascent, descent = scale * table["sTypoAscender"], -scale * table["sTypoDescender"]
            self._heights[properties.copy()] = (ascent, descent, scale * table["sTypoLineGap"])
        return self._heights[properties]


def _svg(figure: Any) -> str:
    """Write a figure as an SVG document whose ``viewBox`` shows all that is drawn, and no more."""
    stream = StringIO()
    FigureCanvasSVG(figure)  # a layout engine asks the canvas how large texts are
    resolution, figure.dpi = figure.dpi, POINTS_PER_INCH
    inches, (width, height) = figure.get_size_inches(), figure.bbox.size
    writer = _Writer(width, height, stream, image_dpi=resolution, metadata={"Date": None})
    renderer: Any = MixedModeRenderer(figure, inches[0], inches[1], resolution, writer)  # type: ignore[no-untyped-call]
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing")  # a box stands in its place
        box = arranged(figure, renderer).padded(EDGE)
        figure.patch.set(facecolor="white", bounds=box.transformed(figure.transFigure.inverted()).bounds)
        figure.draw(renderer)
    renderer.finalize()
    view = " ".join(f"{number:.6g}" for number in (box.x0, height - box.y1, box.width, box.height))
    return _VIEW_BOX.sub(f'viewBox="{view}"', stream.getvalue(), count=1)


def _png(figure: Any) -> bytes:
    """Write a figure as PNG that shows all that is drawn, and no more."""
    stream = BytesIO()
    canvas = FigureCanvasAgg(figure)
    figure.dpi = PIXELS_PER_INCH
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing")
        box = arranged(figure, canvas.get_renderer()).padded(EDGE * PIXELS_PER_INCH / POINTS_PER_INCH)  # type: ignore[no-untyped-call]
        inches = Bbox(box.get_points() / PIXELS_PER_INCH)
        figure.savefig(stream, format="png", dpi=PIXELS_PER_INCH, bbox_inches=inches, metadata={"Software": None})
    return stream.getvalue()


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
        f'<title id="{ident}-title">{escape(printable(title))}</title>'
    )
    return root + re.sub(r"\n\s*", "\n", body[opening.end() :]).strip()
