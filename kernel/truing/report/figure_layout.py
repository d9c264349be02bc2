"""Where the panels of a figure stand: as in matplotlib's constrained layout, measured once.

Constrained layout measures all texts of a figure twice. To save what is drawn and no more, matplotlib then draws the
figure without output and measures it again. Here one measurement serves both: what the labels take up around a panel
stays the same while the panel moves, unless its ticks change.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.gridspec import GridSpec
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.spines import Spine
from matplotlib.text import Text
from matplotlib.transforms import Bbox
from numpy.typing import NDArray

USUAL_ROOM, UNLABELLED_ROOM = (0.5, 0.4, 0.0, 0.05), (0.5, 0.08, 0.0, 0.05)
"""Inches left, below, right and above of a panel, with and without a label below, where it is measured first.

They are the medians of the panels of the gallery: near its final size a panel has its final ticks.
"""
STEADY = 1.0
"""Pixels by which the sides of a panel may still change when its place is taken as final: less cannot be seen."""
MOST_ROUNDS = 4
LEAST_SHARE = 0.2
"""Share of a figure that its panels keep, however long the labels are; the picture becomes larger instead."""

Floats = NDArray[np.float64]
OUTWARD = np.array([[-1.0], [1.0]])
"""Signs that turn the corners of a box, lower left and upper right, into lengths that point out of it."""


@dataclass(frozen=True)
class _Labels:
    """What ticks, labels and titles take up around a panel: (4,) pixels left, below, right and above."""

    ticks: tuple[Floats, Floats]
    room: Floats
    """What no other panel may take. A title, or the label of an axis, may be longer than its panel."""
    drawn: Floats


def arranged(figure: Any, renderer: Any) -> Bbox:
    """Set the panels of a figure in their places; return the box around all that is drawn, in pixels.

    A plain grid of panels in constrained layout is laid out here, everything else by its own layout engine. The figure
    has no layout engine after this.
    """
    engine = figure.get_layout_engine()
    if _is_plain_grid(figure, engine):
        box = _grid_arranged(figure, renderer, engine)
    else:
        if engine is not None:
            engine.execute(figure)
        box = Bbox(figure.dpi * figure.get_tightbbox(renderer).get_points())
    figure.set_layout_engine("none")
    return box


def _is_plain_grid(figure: Any, engine: Any) -> bool:
    """Tell whether a figure holds nothing but ordinary panels of one grid, in constrained layout as it comes."""
    if not (isinstance(engine, ConstrainedLayoutEngine) and engine.get() == ConstrainedLayoutEngine().get()):
        return False
    panels = figure.axes
    if not all(axes.name == "rectilinear" and axes.get_visible() and axes.get_subplotspec() for axes in panels):
        return False
    grids = {axes.get_subplotspec().get_gridspec() for axes in panels}
    if len(grids) != 1 or len(figure.get_children()) > 1 + len(panels):
        return False
    grid = grids.pop()
    return isinstance(grid, GridSpec) and grid.hspace is None and grid.wspace is None


def _grid_arranged(figure: Any, renderer: Any, engine: Any) -> Bbox:
    """Set panels so that their labels, and what else is drawn beyond them, have room; return the box around it all."""
    panels: list[Axes] = figure.axes
    padding = figure.dpi * np.array([engine.get()["w_pad"], engine.get()["h_pad"]])
    usual = [USUAL_ROOM if axes.get_xlabel() else UNLABELLED_ROOM for axes in panels]
    sizes = _set_in_grid(figure, figure.dpi * np.array(usual), padding)
    labels: list[_Labels | None] = [None] * len(panels)
    for _ in range(MOST_ROUNDS):
        measured = [_labels(axes, renderer, known) for axes, known in zip(panels, labels, strict=True)]
        others = [_beyond(_unclipped(axes, renderer), axes.bbox) for axes in panels]
        around = zip(panels, measured, others, strict=True)
        rooms = np.array([_room(axes, np.maximum(own.room, other)) for axes, own, other in around])
        before, sizes, labels = sizes, _set_in_grid(figure, rooms, padding), [*measured]
        if np.all(np.abs(sizes - before) <= STEADY):
            break
    around = zip(panels, measured, others, strict=True)
    return Bbox.union([_grown(axes, np.maximum(own.drawn, other)) for axes, own, other in around])


def _labels(axes: Axes, renderer: Any, known: _Labels | None) -> _Labels:
    """Measure ticks, labels and titles of a panel where it stands, unless they are known and the ticks the same."""
    ticks = axes.xaxis.get_majorticklocs(), axes.yaxis.get_majorticklocs()
    if known is not None and all(map(np.array_equal, ticks, known.ticks)):
        return known
    needed = axes.get_tightbbox(renderer, for_layout_only=True, bbox_extra_artists=[])
    assert needed is not None, "a visible panel has a box"
    titles = [artist for artist in axes.get_children() if isinstance(artist, Text) and artist not in axes.texts]
    texts = [text for text in (axes.xaxis.label, axes.yaxis.label, *titles) if text.get_text() and text.get_visible()]
    drawn = Bbox.union([needed, *(text.get_window_extent(renderer) for text in texts)])
    return _Labels(ticks, _beyond(needed, axes.bbox), _beyond(drawn, axes.bbox))


def _unclipped(axes: Axes, renderer: Any) -> Bbox:
    """Return the box around a panel and its texts, legends and what else is not cut at its sides."""
    axes.apply_aspect()
    artists = [artist for artist in axes.get_default_bbox_extra_artists() if not isinstance(artist, Spine)]
    boxes = [box for artist in artists if (box := artist.get_tightbbox(renderer)) is not None]
    return Bbox.union([axes.bbox, *(box for box in boxes if np.isfinite(box.get_points()).all() and any(box.size))])


def _room(axes: Axes, around: Floats) -> Floats:
    """Return what a panel needs around its place in the grid, which is larger than a panel of fixed aspect."""
    box = axes.get_position(original=True).transformed(axes.figure.transFigure)
    return np.maximum(_beyond(_grown(axes, around), box), 0.0)


def _grown(axes: Axes, around: Floats) -> Bbox:
    axes.apply_aspect()
    return Bbox(axes.bbox.get_points() + OUTWARD * around.reshape(2, 2))


def _beyond(outer: Any, inner: Any) -> Floats:
    """Return how far a box reaches beyond another, (4,): left, below, right, above."""
    lengths: Floats = OUTWARD * (outer.get_points() - inner.get_points())
    return lengths.ravel()


def _set_in_grid(figure: Any, rooms: Floats, padding: Floats) -> Floats:
    """Set panels so that each has its room (panels, 4) and the padding around it; return their sizes (panels, 2)."""
    places = [axes.get_subplotspec() for axes in figure.axes]
    grid = places[0].get_gridspec()
    width, height = figure.bbox.size
    columns = [(cell.colspan.start, cell.colspan.stop) for cell in places]
    across = _sides(columns, padding[0] + rooms[:, [0, 2]], grid.get_width_ratios(), width)
    rows = [(cell.rowspan.start, cell.rowspan.stop) for cell in places]
    down = _sides(rows, padding[1] + rooms[:, [3, 1]], grid.get_height_ratios(), height)
    for axes, (left, right), (top, bottom) in zip(figure.axes, across, down, strict=True):
        box = Bbox([[left, height - bottom], [right, height - top]])
        axes.set_position(box.transformed(figure.transFigure.inverted()))
    return np.column_stack([across[:, 1] - across[:, 0], down[:, 1] - down[:, 0]])


def _sides(cells: Sequence[tuple[int, int]], rooms: Floats, ratios: Sequence[float], whole: float) -> Floats:
    """Return where panels start and end (panels, 2) along one direction; its cells share what their rooms leave."""
    before, after = np.zeros((2, len(ratios)))
    for (start, stop), (first, last) in zip(cells, rooms, strict=True):
        before[start] = max(before[start], first)
        after[stop - 1] = max(after[stop - 1], last)
    left = max(whole - before.sum() - after.sum(), LEAST_SHARE * whole)
    sizes = left * np.asarray(ratios) / np.sum(ratios)
    starts = np.cumsum(before + np.append(0.0, (sizes + after)[:-1]))
    return np.array([(starts[start], starts[stop - 1] + sizes[stop - 1]) for start, stop in cells])
