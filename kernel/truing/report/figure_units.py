"""Axes of a figure in other units: what is drawn stays, its ticks stand where the numbers of the new unit are round."""

from __future__ import annotations

import copy
import re
from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.legend import Legend
from matplotlib.text import Text
from matplotlib.ticker import (
    FixedLocator,
    Formatter,
    Locator,
    LogFormatter,
    LogLocator,
    MaxNLocator,
    NullFormatter,
    NullLocator,
    ScalarFormatter,
    SymmetricalLogLocator,
)

from truing.units import from_si, to_si, unit_text

_LABELS = (
    re.compile(r"(?P<before>.*?(?:,\s*|\s*\[|\s*\())(?P<unit>[^\s,\[\]()][^,\[\]]*?)(?P<behind>[\])]?)"),
    re.compile(r"(?P<before>)(?P<unit>[^\s,]+)(?P<behind>(?:,?\s.*)?)"),
)
_NUMBER = re.compile(r"[-−+]?\d+(?:\.\d+)?")
_NUMBERS = re.compile(rf"{_NUMBER.pattern}(?:[,;]?\s+{_NUMBER.pattern})*")
_LOCATORS = (MaxNLocator, LogLocator, SymmetricalLogLocator)
_FORMATTERS = (ScalarFormatter, LogFormatter)
Convert = Callable[[Any], Any]


def brought_over(figure: Any, unit_of: Callable[[str], str], text_of: Callable[[str], str]) -> Any:
    """Bring every axis whose label names a unit to ``unit_of`` it, and the quantities in its words to ``text_of``.

    "depth, µm", "depth [µm]" and "depth (µm)" end with a unit, "µm along the normal" begins with one. An axis whose
    ticks a plugin has named itself stays. Of a drawing to scale one label speaks for both axes.
    """
    axes = [axis for panel in figure.axes for axis in panel._axis_map.values()]
    ticks = (each for axis in axes for each in axis.get_ticklabels(which="both"))
    labels = {id(axis.label) for axis in axes} | {*map(id, ticks)}
    for panel in figure.axes:
        _relabel(panel, unit_of)
    for legend in figure.findobj(Legend):
        _say_legend(legend, unit_of, text_of)
    for text in figure.findobj(Text):
        said = text.get_text()
        if said and "$" not in said and id(text) not in labels:
            text.set_text(text_of(said))
    return figure


def _relabel(panel: Any, unit_of: Callable[[str], str]) -> None:
    """Bring the axes of a panel over; in one that is drawn to scale the axis without a label goes with the other."""
    changed = ("", "")
    silent = []
    for axis in panel._axis_map.values():
        match, unit = _unit_in(axis.get_label_text().strip(), unit_of)
        shown = unit_of(unit)
        if match is None:
            silent += [] if axis.get_label_text().strip() else [axis]
        elif _can_change(axis, unit, shown):
            changed = unit, shown
            _change(axis, unit, shown)
            axis.set_label_text(match["before"] + unit_text(shown) + match["behind"])
    if panel.get_aspect() == 1 and all(changed):
        for axis in (axis for axis in silent if _can_change(axis, *changed)):
            _change(axis, *changed)


def _say_legend(legend: Any, unit_of: Callable[[str], str], text_of: Callable[[str], str]) -> None:
    """Bring a legend over whose title names the unit of its entries, which are numbers alone."""
    title, texts = legend.get_title(), legend.get_texts()
    match, unit = _unit_in(title.get_text().strip(), unit_of)
    if match is None or not all(_NUMBERS.fullmatch(text.get_text()) for text in texts):
        return
    shown = unit_text(unit_of(unit))
    for text in texts:
        said = _NUMBER.sub(lambda number: text_of(f"{number[0]} {unit}").removesuffix(f" {shown}"), text.get_text())
        text.set_text(said)
    title.set_text(match["before"] + shown + match["behind"])


def _unit_in(label: str, unit_of: Callable[[str], str]) -> tuple[re.Match[str] | None, str]:
    """Find the unit in a label that has a counterpart."""
    matches = (match for pattern in _LABELS if (match := pattern.fullmatch(label)))
    match = next((match for match in matches if unit_of(match["unit"]) != match["unit"]), None)
    return match, match["unit"] if match else ""


def _can_change(axis: Any, unit: str, shown: str) -> bool:
    """Tell whether the ticks of an axis are numbers that matplotlib chooses or writes.

    An axis that shares its ticks with one that was brought over is there already.
    """
    locator, formatter = axis.get_major_locator(), axis.get_major_formatter()
    if isinstance(formatter, _OtherFormatter):
        return formatter.units == (unit, shown)
    known = isinstance(locator, (*_LOCATORS, FixedLocator, NullLocator))
    return known and isinstance(formatter, (*_FORMATTERS, NullFormatter))


def _change(axis: Any, unit: str, shown: str) -> None:
    def to(values: Any) -> Any:
        return from_si(to_si(np.asarray(values, dtype=float), unit), shown)

    def back(values: Any) -> Any:
        return from_si(to_si(np.asarray(values, dtype=float), shown), unit)

    for which in ("major", "minor"):
        locator, formatter = getattr(axis, f"get_{which}_locator")(), getattr(axis, f"get_{which}_formatter")()
        if isinstance(locator, _LOCATORS):
            getattr(axis, f"set_{which}_locator")(_OtherLocator(locator, to, back))
        if isinstance(formatter, _FORMATTERS):
            getattr(axis, f"set_{which}_formatter")(_OtherFormatter(formatter, to, (unit, shown)))


class _OtherLocator(Locator):
    """Puts ticks where the numbers of another unit are round."""

    def __init__(self, base: Any, to: Convert, back: Convert) -> None:
        self.base, self.to, self.back = base, to, back

    def __call__(self) -> Any:
        """Return the places of the ticks within the view."""
        assert self.axis is not None
        return self.tick_values(*self.axis.get_view_interval())

    def tick_values(self, vmin: float, vmax: float) -> Any:
        """Return the places of the ticks between two ends."""
        low, high = sorted((float(self.to(vmin)), float(self.to(vmax))))
        return self.back(self.base.tick_values(low, high))

    def nonsingular(self, v0: float, v1: float) -> Any:
        """Widen a range of no width as the other locator does."""
        return self.base.nonsingular(v0, v1)


class _OtherFormatter(Formatter):
    """Writes ticks in another unit."""

    def __init__(self, base: Any, to: Convert, units: tuple[str, str]) -> None:
        self.base, self.to, self.units = copy.copy(base), to, units
        self.base.axis = None
        self.base.create_dummy_axis(minpos=1e-300)

    def set_locs(self, locs: Any) -> None:
        """Take the places of the ticks."""
        assert self.axis is not None
        self.base.axis.set_view_interval(*sorted(map(float, self.to(self.axis.get_view_interval()))))
        self.base.set_locs(self.to(locs))

    def __call__(self, x: Any, pos: Any = None) -> str:
        """Return the label of a tick."""
        return str(self.base(float(self.to(x)), pos))

    def get_offset(self) -> str:
        """Return what stands beside the axis for all its ticks."""
        return str(self.base.get_offset())
