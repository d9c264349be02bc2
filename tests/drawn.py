"""The sheet of a run: its figures drawn and read back, and its words."""

import warnings
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing import Drawing, Words
from truing.calculation import Calculation
from truing.report.figures import draw

Array = NDArray[np.float64]


def drawings(run: Calculation) -> list[tuple[str, Callable[[], Any]]]:
    """Every figure of the sheet, not drawn yet, with its title."""
    found: list[tuple[str, Callable[[], Any]]] = []
    for section in run.setup.model.sheet:
        if section.figure is not None:
            found.append((section.title, partial(section.figure, run.record)))
        blocks = section.blocks(run.record) if section.blocks else ()
        found += [(block.title, block.draw) for block in blocks if isinstance(block, Drawing)]
    return found


def draw_all(run: Calculation) -> list[str]:
    """Draw every figure of the sheet without a complaint, name its axes, and return the titles."""
    made = drawings(run)
    for title, drawn in made:
        figure = drawn()
        assert any(panel.get_xlabel() or panel.get_aspect() == 1.0 for panel in figure.axes), title
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            svg = draw(partial(lambda figure: figure, figure), title=title, ident="f")
        assert svg.startswith("<svg"), title
        assert "nan" not in svg.lower(), title
    return [title for title, _ in made]


def figures(run: Calculation, section: Callable[[Any], Any]) -> dict[str, Any]:
    """The figures of a section by title, drawn."""
    return {block.title: block.draw() for block in section(run.record) if isinstance(block, Drawing)}


def line(panel: Any, label: str) -> tuple[Array, Array]:
    """The data of the first line whose label holds these words."""
    found = next(each for each in panel.get_lines() if label in str(each.get_label()))
    return np.asarray(found.get_xdata(), dtype=float), np.asarray(found.get_ydata(), dtype=float)


def words(blocks: Any, kind: str = "") -> str:
    """All words of some blocks, or those of one kind."""
    return " ".join(block.text for block in blocks if isinstance(block, Words) and kind in {"", block.kind})
