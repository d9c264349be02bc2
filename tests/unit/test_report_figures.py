"""Figures: the same bytes every time, nothing shared between figures of one page, a title for those who cannot see."""

import re
from collections.abc import Callable
from io import StringIO
from typing import Any
from xml.etree import ElementTree

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.figure import Figure

from truing.errors import PluginError
from truing.report import figures
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


# What is drawn is seen: also what stands beyond the panels and the figure itself.


def two_beside() -> Any:
    figure = Figure(figsize=(6.4, 3.0), layout="constrained")
    for axes in figure.subplots(1, 2):
        axes.plot([0.0, 1.0], [-12345.0, 98765.4])
        axes.set_ylabel("a label\nof two lines")
    figure.suptitle("a title above both")
    return figure


def bars_with_long_names() -> Any:
    figure = Figure(figsize=(3.0, 2.0), layout="constrained")
    axes = figure.subplots()
    axes.barh(["a result whose name takes more room than it should", "short"], [1.0, 0.5])
    axes.text(1.0, 0, "a number beyond the panel", va="center")
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


@pytest.mark.filterwarnings("ignore:constrained_layout not applied")
@pytest.mark.parametrize("make", [two_beside, bars_with_long_names, with_colours, without_layout])
def test_a_figure_is_as_large_as_what_matplotlib_draws_of_it(make: Callable[[], Any]) -> None:
    root = ElementTree.fromstring(draw(make, title="a", ident="f1"))
    stream = StringIO()
    with styled():
        make().savefig(stream, format="svg", dpi=72, bbox_inches="tight", pad_inches=figures.EDGE / 72)
    wanted = ElementTree.fromstring(stream.getvalue())
    shown, expected = (list(map(float, tree.attrib["viewBox"].split()))[2:] for tree in (root, wanted))
    assert shown == pytest.approx(expected, abs=1.5)  # points, of 4.3 that are kept around
