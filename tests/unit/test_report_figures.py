"""Figures: the same bytes every time, nothing shared between figures of one page, a title for those who cannot see."""

import itertools
import re
from collections.abc import Callable
from io import StringIO
from typing import Any
from xml.etree import ElementTree

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.backends.backend_svg import FigureCanvasSVG, RendererSVG
from matplotlib.figure import Figure

from truing.errors import PluginError
from truing.report import figures
from truing.report.figure_layout import arranged
from truing.report.figures import draw, styled

SVG = "{http://www.w3.org/2000/svg}"


def line() -> Any:
    figure = Figure(figsize=(4, 2))
    axes = figure.subplots()
    axes.plot([0, 1, 2], [3, 1, 2], label="<b>&</b>")
    axes.set_title("</svg><script>alert(1)</script> -- >")
    axes.legend()
    return figure


TITLE = "Depth <over> time & more"


@pytest.fixture(scope="module")
def drawn() -> str:
    """The figure of a line as a page has it."""
    return draw(line, title=TITLE, ident="f1")


def test_a_figure_is_the_same_bytes_every_time_and_does_not_follow_the_users_settings(drawn: str) -> None:
    with mpl.rc_context({"font.size": 30, "svg.hashsalt": "other", "axes.facecolor": "red"}):
        assert draw(line, title=TITLE, ident="f1") == drawn


def test_references_arrive_inside_their_figure_and_figures_of_one_page_share_no_identifier(drawn: str) -> None:
    first, second = (re.findall(r'\bid="([^"]+)"', text) for text in (drawn, draw(line, title=TITLE, ident="f2")))
    assert len(first) == len(set(first))
    assert not set(first) & set(second)
    references = re.findall(r'(?:url\(#|href="#)([^)"]+)', drawn)
    assert references
    assert set(references) <= set(first)


def test_a_figure_is_an_image_with_a_title_and_brings_nothing_else_into_the_page(drawn: str) -> None:
    tree = ElementTree.fromstring(drawn)
    assert tree.get("role") == "img"
    title = tree.find(f"{SVG}title")
    assert title is not None
    assert title.text == TITLE
    assert tree.get("aria-labelledby") == title.get("id")
    marks = ["<script", "<style", "<metadata", "<!--", "<?xml", "DOCTYPE", "matplotlib.org"]
    assert [mark for mark in marks if mark in drawn] == []


def test_a_figure_that_fails_is_named_with_its_place() -> None:
    def broken() -> Any:
        return 1 / 0

    with pytest.raises(PluginError, match=r"test_report_figures\.py:\d+: the figure 'Wear' failed: ZeroDivisionError"):
        draw(broken, title="Wear", ident="f1")


def labelled(title: str) -> str:
    """Draw a figure with this title, and with a formula at its axis."""

    def make() -> Any:
        figure = line()
        figure.axes[0].set_title(title)
        figure.axes[0].set_xlabel(r"$\alpha_1$")
        return figure

    return draw(make, title=title, ident="f1")


@pytest.mark.parametrize(
    "text", ["cost $5", r"\frac{1}{2}", r"$\frac$", r"$x^$ and $y_1$", "$$", "a $ b $ c $", "\x1b[31m", "\u65e5"]
)
def test_no_text_breaks_a_figure_and_a_formula_beside_it_is_still_set(text: str, drawn: str) -> None:
    found = labelled(text)
    assert ElementTree.fromstring(found).get("role") == "img"
    assert "Oblique" in found  # the slanted letter of a formula
    assert "Oblique" not in drawn


# Layout of figures: panels stand where constrained layout sets them, all that is drawn is seen, nothing overlaps.

LONG = "a result whose name takes more room than it should, in units of per mille"


def two_beside() -> Any:
    figure = Figure(figsize=(6.4, 3.0), layout="constrained")
    for axes in figure.subplots(1, 2):
        axes.plot([0.0, 1.0], [-12345.0, 98765.4])
        axes.set_xlabel("position [mm]")
        axes.set_ylabel("a label\nof two lines")
        axes.set_title("before", loc="left")
    return figure


def bars_with_long_names() -> Any:
    figure = Figure(figsize=(6.4, 3.0), layout="constrained")
    axes = figure.subplots()
    axes.barh([LONG[:46], "short"], [1.0, 0.5])
    axes.text(1.0, 0, "a number beyond the panel", va="center")
    axes.legend(["bars"], loc="lower left", bbox_to_anchor=(0, 1.0))
    return figure


def panels_below_one_another() -> Any:
    figure = Figure(figsize=(6.4, 9.0), layout="constrained")
    for index, axes in enumerate(figure.subplots(5, 1, sharex=True, height_ratios=(1, 2, 1, 2, 1))):
        axes.plot([0.0, 1.0], [0.0, 10.0**index])
        axes.set_ylabel(f"result {index}")
    return figure


def to_scale() -> Any:
    figure = Figure(figsize=(6.4, 3.5), layout="constrained")
    for axes, side in zip(figure.subplots(1, 2, width_ratios=(1.0, 1.5)), (1.0, 3.0), strict=True):
        axes.plot([0.0, side], [0.0, 1.0])
        axes.set_aspect("equal")
    return figure


def spanning() -> Any:
    figure = Figure(figsize=(6.4, 4.0), layout="constrained")
    grid = figure.add_gridspec(2, 2)
    for place in (grid[0, :], grid[1, 0], grid[1, 1]):
        figure.add_subplot(place).set_ylabel("value")
    return figure


PLAIN = [two_beside, bars_with_long_names, panels_below_one_another, to_scale, spanning]


def placed(figure: Any) -> tuple[Any, Any]:
    """Lay a figure out; return the renderer and the box of what is drawn."""
    FigureCanvasSVG(figure)
    figure.dpi = 72
    renderer: Any = RendererSVG(*map(float, figure.bbox.size), StringIO())  # type: ignore[no-untyped-call, call-arg]
    return renderer, arranged(figure, renderer)


@pytest.fixture(scope="module", params=PLAIN, ids=lambda make: make.__name__)
def laid_out(request: pytest.FixtureRequest) -> tuple[Any, Any, Any]:
    """A figure as it is laid out, the renderer, and the box of what is drawn."""
    with styled():
        figure = request.param()
        return figure, *placed(figure)


def test_panels_stand_where_constrained_layout_sets_them(
    laid_out: tuple[Any, Any, Any], request: pytest.FixtureRequest
) -> None:
    figure, _, _ = laid_out
    with styled():
        expected = request.node.callspec.params["laid_out"]()
        FigureCanvasSVG(expected)
        expected.get_layout_engine().execute(expected)
    for axes, other in zip(figure.axes, expected.axes, strict=True):
        wanted = other.get_position().get_points() * figure.get_size_inches() * 72
        assert axes.bbox.get_points() == pytest.approx(wanted, abs=4.0)  # points


def test_the_box_holds_all_that_is_drawn_and_no_panel_covers_another(laid_out: tuple[Any, Any, Any]) -> None:
    figure, renderer, box = laid_out
    with styled():
        drawn = 72 * figure.get_tightbbox(renderer).get_points()
        boxes = [axes.get_tightbbox(renderer, for_layout_only=True) for axes in figure.axes]
    assert box.get_points() == pytest.approx(drawn, abs=1.5)  # points, of 4.3 that are kept around
    assert not [pair for pair in itertools.combinations(boxes, 2) if pair[0].overlaps(pair[1])]


def test_panels_keep_their_share_of_the_width_beside_labels_that_take_all_of_it() -> None:
    def make() -> Any:
        figure = Figure(figsize=(3.0, 2.0), layout="constrained")
        figure.subplots().barh([LONG, "short"], [1.0, 0.5])
        return figure

    with styled():
        figure = make()
        _, box = placed(figure)
    assert figure.axes[0].bbox.width == pytest.approx(0.2 * 3.0 * 72)
    assert box.width > 3.0 * 72
    root = ElementTree.fromstring(draw(make, title="a", ident="f1"))
    assert float(root.attrib["viewBox"].split()[2]) == pytest.approx(box.width + 2 * figures.EDGE, abs=0.01)


def titled() -> Any:
    figure = two_beside()
    figure.suptitle("a title above both")
    return figure


def with_colours() -> Any:
    figure = Figure(layout="constrained")
    axes = figure.subplots()
    figure.colorbar(axes.imshow(np.eye(3)), ax=axes, label="height")
    return figure


def without_layout() -> Any:
    figure = Figure()
    figure.add_axes((0.2, 0.2, 0.9, 0.6)).set_ylabel("value")
    return figure


def in_space() -> Any:
    figure = Figure(layout="constrained")
    figure.add_subplot(projection="3d")
    return figure


@pytest.mark.parametrize("make", [titled, with_colours, without_layout, in_space])
def test_what_is_no_plain_grid_is_laid_out_by_matplotlib(make: Callable[[], Any]) -> None:
    with styled():
        figure, expected = make(), make()
        _, box = placed(figure)
        FigureCanvasSVG(expected)
        expected.dpi = 72
        expected.draw_without_rendering()
        drawn = 72 * expected.get_tightbbox().get_points()
    for axes, other in zip(figure.axes, expected.axes, strict=True):
        assert axes.get_position().get_points() == pytest.approx(other.get_position().get_points(), abs=1e-6)
    assert box.get_points() == pytest.approx(drawn, abs=1.0)


def test_heights_of_fonts_that_are_kept_change_no_figure(monkeypatch: pytest.MonkeyPatch) -> None:
    kept = draw(bars_with_long_names, title="a", ident="f1")
    monkeypatch.delattr(figures._Writer, "_get_font_height_metrics")
    assert draw(bars_with_long_names, title="a", ident="f1") == kept
