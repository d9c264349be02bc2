"""Figures: the same bytes every time, nothing shared between figures of one page, a title for those who cannot see."""

import re
from typing import Any
from xml.etree import ElementTree

import matplotlib as mpl
import pytest
from matplotlib.figure import Figure

from truing.errors import PluginError
from truing.report.figures import draw

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
