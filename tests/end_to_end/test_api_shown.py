"""What a notebook shows of models, runs, studies, records and diagnoses: small, inert, and whole in itself."""

from __future__ import annotations

import re
from collections.abc import Iterator
from html.parser import HTMLParser
from typing import Any

import matplotlib as mpl
import pytest
from matplotlib.figure import Figure

import truing
from shared import TESTS
from truing.api.notebook import LEFT_OUT, html_table, joined

PRESS = TESTS.parent / "docs" / "examples" / "press_off_by_40_um"
LARGEST = 100_000
TAGS = {"p", "b", "table", "thead", "tbody", "tr", "th", "td", "ul", "li", "details", "summary", "img"}
STYLES = {"text-align: left", "max-width: 100%"}


class Seen(HTMLParser):
    """The tags and attributes of a piece of HTML, and whether every tag is closed."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.attributes: list[tuple[str, str]] = []
        self.open: list[str] = []
        self.words: list[str] = []
        self.feed(html)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.attributes += [(name, value or "") for name, value in attrs]
        if tag != "img":
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.words.append(data)


def shown_by(name: str, diagnosis: truing.Diagnosis) -> Iterator[Any]:
    """Give the objects that show themselves, of a model with little and of one with much."""
    pin = truing.load(TESTS / "data" / "pin_wear.py")
    press = truing.load("press_linkage")
    if name == "model":
        yield from (pin, press, truing.load("rv_gearing"), truing.load("harmonic_fractal"))
    elif name == "run":
        yield from (pin.run(load="84 N"), pin.run(load="84 N").compare(pin.run()), press.run(set={"studies.run": "[]"}))
    elif name == "study":
        yield from (pin.sweep("load", (50, 90), points=3), pin.study(truing.Reliability(draws=4096)))
        yield pin.study(truing.Sensitivity())
    else:
        yield from (truing.read(PRESS / "measured.csv", press), diagnosis, diagnosis.ranking)


@pytest.mark.parametrize("name", ["model", "run", "study", "diagnosis"])
def test_what_is_shown_is_small_and_asks_for_nothing(name: str, diagnosis: truing.Diagnosis) -> None:
    for shown in shown_by(name, diagnosis):
        html = shown._repr_html_()
        seen = Seen(html)
        assert len(html.encode()) < LARGEST
        assert set(seen.tags) <= TAGS
        assert not seen.open
        for attribute, value in seen.attributes:
            allowed = attribute == "alt" or (attribute == "style" and value in STYLES)
            assert allowed or (attribute == "src" and value.startswith("data:image/png;base64,")), attribute


def test_a_diagnosis_shows_verdict_picture_and_the_rest_folded(diagnosis: truing.Diagnosis) -> None:
    html = diagnosis._repr_html_()
    before, _, folded = html.partition("<details>")
    assert "softening, loss" in before
    assert before.count("<img") == 1
    assert re.search("softening</td><td[^>]*>loss</td><td[^>]*>0.000247", before)
    for question in ("What is wrong", "Cause", "Extended model", "Gain", "Next"):
        assert f"<summary>{question}</summary>" in folded


def test_a_name_of_a_stranger_is_text() -> None:
    hostile = truing.load(TESTS / "data" / "hostile_pin.py")
    run = hostile.run(TESTS / "data" / "hostile_pin.toml")
    for shown in (hostile, run):
        assert set(Seen(shown._repr_html_()).tags) <= TAGS


def test_figures_look_like_those_of_the_sheet_whatever_the_user_has_set() -> None:
    pin = truing.load(TESTS / "data" / "pin_wear.py")
    with mpl.rc_context({"font.size": 30.0, "axes.spines.top": True}):
        figure = pin.sweep("load", (50, 90), points=3).plot("pressure")
    assert isinstance(figure, Figure)
    assert not figure.axes[0].spines["top"].get_visible()
    assert figure.axes[0].xaxis.label.get_fontsize() == 9.0


def test_a_long_table_is_cut_and_says_so() -> None:
    html = html_table([(str(number), "x" * 500) for number in range(100)], ("number", "text"))
    assert html.count("<tr>") == 61
    assert "40 further rows" in html
    assert not re.search("x{201}", html)


def test_what_does_not_fit_is_left_out_and_that_is_said() -> None:
    assert joined("a" * 50_000, "b" * 40_000) == "a" * 50_000 + "b" * 40_000
    cut = joined("a" * 50_000, "b" * 50_000, "c")
    assert cut == "a" * 50_000 + f"<p>{LEFT_OUT}</p>"
