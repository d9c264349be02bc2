"""Layout of figures: panels stand where constrained layout sets them, all that is drawn is seen, nothing overlaps."""

from collections.abc import Callable
from io import StringIO
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.backends.backend_svg import FigureCanvasSVG, RendererSVG
from matplotlib.figure import Figure

from truing.report import figures
from truing.report.figure_layout import arranged
from truing.report.figures import draw, styled

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
