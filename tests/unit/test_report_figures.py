"""Figures: the same bytes every time, nothing shared between figures of one page, a title for those who cannot see."""

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


def test_a_figure_is_the_same_bytes_every_time() -> None:
    assert draw(line, title="a", ident="f1") == draw(line, title="a", ident="f1")


def test_a_figure_does_not_follow_the_users_settings() -> None:
    before = draw(line, title="a", ident="f1")
    with mpl.rc_context({"font.size": 30, "svg.hashsalt": "other", "axes.facecolor": "red"}):
        assert draw(line, title="a", ident="f1") == before


def test_figures_of_one_page_share_no_identifier() -> None:
    first, second = (ElementTree.fromstring(draw(line, title="a", ident=ident)) for ident in ("f1", "f2"))
    identifiers = [{node.get("id") for node in tree.iter() if node.get("id")} for tree in (first, second)]
    assert identifiers[0]
    assert not identifiers[0] & identifiers[1]


def test_every_reference_inside_a_figure_finds_its_target() -> None:
    text = draw(line, title="a", ident="f7")
    identifiers = re.findall(r'\bid="([^"]+)"', text)
    assert len(identifiers) == len(set(identifiers))
    references = re.findall(r'(?:url\(#|href="#)([^)"]+)', text)
    assert references
    assert set(references) <= set(identifiers)


def test_a_figure_is_an_image_with_a_title_and_no_date() -> None:
    tree = ElementTree.fromstring(draw(line, title="Depth <over> time & more", ident="f1"))
    assert tree.get("role") == "img"
    title = tree.find(f"{SVG}title")
    assert title is not None
    assert title.text == "Depth <over> time & more"
    assert tree.get("aria-labelledby") == title.get("id")


@pytest.mark.parametrize("mark", ["<script", "<style", "<metadata", "<!--", "<?xml", "DOCTYPE", "matplotlib.org"])
def test_a_figure_brings_nothing_into_the_page_but_itself(mark: str) -> None:
    assert mark not in draw(line, title="a", ident="f1")


def test_a_figure_that_fails_is_named_with_its_place() -> None:
    def broken() -> Any:
        return 1 / 0

    with pytest.raises(PluginError, match=r"test_report_figures\.py:\d+: the figure 'Wear' failed: ZeroDivisionError"):
        draw(broken, title="Wear", ident="f1")


@pytest.mark.parametrize(
    "text", ["cost $5", r"\frac{1}{2}", r"$\frac$", "$x^$ and $y_1$", "$$", "a $ b $ c $", "\x1b[31m", "\u65e5"]
)
def test_no_text_breaks_a_figure(text: str) -> None:
    def drawn() -> Any:
        figure = line()
        figure.axes[0].set_title(text)
        figure.axes[0].set_xlabel(r"$\alpha_1$")
        return figure

    tree = ElementTree.fromstring(draw(drawn, title=text, ident="f1"))
    assert tree.get("role") == "img"


def test_a_formula_beside_a_broken_one_is_still_set() -> None:
    def drawn(broken: str) -> str:
        def make() -> Any:
            figure = line()
            figure.axes[0].set_title(broken)
            figure.axes[0].set_xlabel(r"$\alpha_1$")
            return figure

        return draw(make, title="a", ident="f1")

    assert "Oblique" in drawn(r"$\frac$")  # the slanted letter of a formula
    assert "Oblique" in drawn("a title")
    assert "Oblique" not in draw(line, title="a", ident="f1")


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


@pytest.mark.parametrize("make", PLAIN)
def test_panels_stand_where_constrained_layout_sets_them(make: Callable[[], Any]) -> None:
    with styled():
        figure, expected = make(), make()
        placed(figure)
        FigureCanvasSVG(expected)
        expected.get_layout_engine().execute(expected)
    for axes, other in zip(figure.axes, expected.axes, strict=True):
        wanted = other.get_position().get_points() * figure.get_size_inches() * 72
        assert axes.bbox.get_points() == pytest.approx(wanted, abs=4.0)  # points


@pytest.mark.parametrize("make", PLAIN)
def test_the_box_holds_all_that_is_drawn_and_little_more(make: Callable[[], Any]) -> None:
    with styled():
        figure = make()
        renderer, box = placed(figure)
        drawn = 72 * figure.get_tightbbox(renderer).get_points()
    assert box.get_points() == pytest.approx(drawn, abs=1.5)  # points, of 4.3 that are kept around


@pytest.mark.parametrize("make", PLAIN)
def test_the_labels_of_a_panel_leave_the_others_free(make: Callable[[], Any]) -> None:
    with styled():
        figure = make()
        renderer, _ = placed(figure)
        boxes = [axes.get_tightbbox(renderer, for_layout_only=True) for axes in figure.axes]
    overlaps = [(one, other) for one in boxes for other in boxes if one is not other and one.overlaps(other)]
    assert not overlaps


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
