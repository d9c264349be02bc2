"""A column of a measured file as a small figure: SVG in the colours of the page, thinned so that no peak is lost."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from xml.sax.saxutils import escape

import numpy as np

from truing.arrays import Indices, Matrix
from truing.numbers import format_number

WIDTH, HEIGHT = 640, 240
LEFT, RIGHT, TOP, BOTTOM = 74, 12, 12, 44
MOST = 1200
"""So many points are drawn: two for every pixel of the width."""
TICKS = 5
MOST_MARKED = 200
"""So many wrong rows are marked; there are no more different places on the width of a screen to see."""


@dataclass(frozen=True)
class Axis:
    """An axis of the figure: its title, and the values of all rows, (n,), NaN where there is none."""

    title: str
    values: Matrix


def thinned(x: Matrix, y: Matrix) -> Indices:
    """Return the rows to draw, in the order of x: of every stretch the lowest and the highest y, (m,), m <= MOST."""
    known = np.flatnonzero(np.isfinite(x) & np.isfinite(y))
    rows = known[np.argsort(x[known], kind="stable")]
    if len(rows) <= MOST:
        return rows
    edges = np.linspace(0, len(rows), MOST // 2 + 1).astype(np.intp)
    ends: list[int] = []
    for start, end in pairwise(edges.tolist()):
        part = rows[start:end]
        low, high = part[np.argmin(y[part])], part[np.argmax(y[part])]
        ends += sorted({int(low), int(high)}, key=lambda row: float(x[row]))
    return np.array(ends, dtype=np.intp)


def drawn(over: Axis, shown: Axis, wrong: Indices) -> str:
    """Return the figure as SVG; ``wrong`` are rows to be marked in red. Nothing where there is nothing to be drawn."""
    x, y = over.values, shown.values
    rows = thinned(x, y)
    if not len(rows):
        return ""
    across, up = _scale(x[rows], LEFT, WIDTH - RIGHT), _scale(y[rows], HEIGHT - BOTTOM, TOP)
    is_course = bool(np.all(np.diff(x[np.isfinite(x)]) >= 0))  # measured along x: a line, else points
    places = [f"{across(x[row]):.1f} {up(y[row]):.1f}" for row in rows.tolist()]
    path = "M" + "L".join(places) if is_course and len(rows) > 1 else "".join(f"M{place}h0" for place in places)
    marks = [
        f"M{across(x[row]):.1f} {up(y[row]):.1f}m-4-4l8 8m0-8l-8 8"
        for row in wrong.tolist()[:MOST_MARKED]
        if math.isfinite(x[row]) and math.isfinite(y[row])
    ]
    title = escape(f"{shown.title} over {over.title}")
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{title}">',
        *_frame(over, shown, across, up),
        f'<path class="{"line" if is_course else "points"}" d="{path}"/>',
        f'<path class="wrong" d="{"".join(marks)}"/>' if marks else "",
        "</svg>",
    ]
    return "".join(parts)


class _Scale:
    """From the values of an axis to places on the paper; ``ticks`` are round values."""

    def __init__(self, low: float, high: float, start: float, end: float) -> None:
        margin = 0.04 * (high - low) or abs(low) * 0.01 or 1.0
        self.low, self.high = low - margin, high + margin
        self.start, self.end = start, end

    def __call__(self, value: float) -> float:
        share = (float(value) - self.low) / (self.high - self.low)
        return min(max(self.start + share * (self.end - self.start), -1e4), 1e4)

    @property
    def ticks(self) -> list[float]:
        rough = (self.high - self.low) / TICKS
        power = 10.0 ** math.floor(math.log10(rough))
        step = power * next(factor for factor in (1, 2, 5, 10) if factor * power >= rough)
        first = math.ceil(self.low / step)
        return [step * count for count in range(first, first + 2 * TICKS) if step * count <= self.high]


def _scale(values: Matrix, start: float, end: float) -> _Scale:
    return _Scale(float(values.min()), float(values.max()), start, end)


def _frame(over: Axis, shown: Axis, across: _Scale, up: _Scale) -> list[str]:
    """Return lines and labels of both axes."""
    floor, middle = HEIGHT - BOTTOM, (TOP + HEIGHT - BOTTOM) / 2
    parts = [f'<path class="axis" d="M{LEFT} {TOP}V{floor}H{WIDTH - RIGHT}"/>']
    for value in across.ticks:
        place, text = across(value), escape(format_number(value, 5))
        parts.append(f'<text x="{place:.1f}" y="{floor + 16}" text-anchor="middle">{text}</text>')
    for value in up.ticks:
        place, text = up(value), escape(format_number(value, 5))
        parts.append(f'<path class="grid" d="M{LEFT} {place:.1f}H{WIDTH - RIGHT}"/>')
        parts.append(f'<text x="{LEFT - 6}" y="{place + 4:.1f}" text-anchor="end">{text}</text>')
    parts.append(f'<text x="{(LEFT + WIDTH) / 2}" y="{HEIGHT - 8}" text-anchor="middle">{escape(over.title)}</text>')
    turned = f'transform="rotate(-90 14 {middle})" x="14" y="{middle}" text-anchor="middle"'
    return [*parts, f"<text {turned}>{escape(shown.title)}</text>"]
