"""How far does a load cell give way under a load?"""

from dataclasses import replace

import numpy as np

from truing import (
    Effect,
    Float,
    Model,
    Section,
    Tolerance,
    Unknown,
    found,
    given,
    hookimpl,
    inputs,
    normal,
    results,
)

FULL = 3e6  # the largest load of the calibration; its source prints no unit


@inputs
class Cell:
    """A load cell in its calibration; what a straight line leaves out is neutral as declared."""

    load: Float = given(1.5e6, "", symbol="F", note="load that is put on, in units of the source", at_least=0)
    span: Float = given(2.17, "", symbol="d_1", note="deflection under the full load of 3 million", above=0)
    zero: Float = given(0.0, "", symbol="d_0", note="what is read without a load")
    bend: Float = given(0.0, "", symbol="b", note="share of the span that a parabola takes away at full load")
    stiffer: Float = given(0.0, "", symbol="s", note="share by which it is stiffer at full load")
    contact: Float = given(0.0, "", symbol="k", note="share of the span that contact surfaces take at full load")
    bulge: Float = given(0.0, "", symbol="w", note="share of the span that a cubic takes away at full load")
    seat: Float = given(0.0, "", symbol="d_S", note="deflection while the parts find their seats")
    seated: Float = given(0.05, "", symbol="f_S", note="share of the full load that seats most of it", above=0)


@results
class Reading:
    """What the cell shows."""

    deflection: Float = found(
        "", symbol="d", note="deflection, in units of the source",
        formula="zero + span * (load / 3e6) * (1 / (1 + stiffer * load / 3e6) - bend * load / 3e6"
        " - bulge * (load / 3e6)**2) + span * contact * sqrt(load / 3e6)"
        " + seat * (1 - exp(-load / 3e6 / seated))",
    )  # fmt: skip


def load_cell(cell: Cell) -> Reading:
    """A spring: deflection in proportion to load, until an effect says otherwise. Shapes (n,) or numbers."""
    share = cell.load / FULL
    spring = 1 / (1 + cell.stiffer * share) - cell.bend * share - cell.bulge * share**2
    fitting = cell.span * cell.contact * np.sqrt(share) + cell.seat * (1 - np.exp(-share / cell.seated))
    return Reading(deflection=cell.zero + cell.span * share * spring + fitting)


def bending(cell: Cell, *, share: Float) -> Cell:
    """Its shape changes under load: a parabola is taken from the line."""
    return replace(cell, bend=cell.bend + share)


def stiffening(cell: Cell, *, share: Float) -> Cell:
    """It gets stiffer in proportion to the load."""
    return replace(cell, stiffer=cell.stiffer + share)


def contact_surfaces(cell: Cell, *, share: Float) -> Cell:
    """Rough surfaces between cell and frame give way at once, and hardly more: a root of the load."""
    return replace(cell, contact=cell.contact + share)


def bulging(cell: Cell, *, share: Float) -> Cell:
    """Its walls bulge: a cubic is taken from the line, the same for push and pull."""
    return replace(cell, bulge=cell.bulge + share)


def seating(cell: Cell, *, depth: Float, reach: Float) -> Cell:
    """The parts find their seats under the first loads."""
    at = np.where(np.equal(depth, 0), cell.seated, reach)
    return replace(cell, seat=cell.seat + depth, seated=at)


LOAD_CELL = Model(
    name="load_cell",
    title="Calibration of a load cell",
    function=load_cell,
    errors=[
        Tolerance("span", normal(sd="2 %"), why="gauges are glued by hand; this is what a calibration is for"),
        Tolerance("zero", normal(sd="0.002"), why="the zero is set by hand"),
        Effect(
            "bending",
            on_inputs=bending,
            looks_like="a parabola",
            unknowns=[Unknown("share", -0.1, 0.1, "", note="of the span, at full load")],
        ),
        Effect(
            "stiffening",
            on_inputs=stiffening,
            looks_like="nearly a parabola, a little flatter at full load",
            unknowns=[Unknown("share", -0.1, 0.1, "", note="at full load")],
        ),
        Effect(
            "contact_surfaces",
            on_inputs=contact_surfaces,
            looks_like="steep at the lightest load, straight beyond",
            unknowns=[Unknown("share", 0, 0.1, "", note="of the span, at full load")],
        ),
        Effect(
            "bulging",
            on_inputs=bulging,
            looks_like="straight at first, bent near full load",
            unknowns=[Unknown("share", -0.1, 0.1, "", note="of the span, at full load")],
        ),
        Effect(
            "seating",
            on_inputs=seating,
            looks_like="something extra up to a light load, the same from there on",
            unknowns=[
                Unknown("depth", 0, 0.1),
                Unknown("reach", 0.02, 0.2, "", note="share of the full load that seats two thirds"),
            ],
        ),
    ],
    sheet=[Section("Deflection", "deflection")],
)


@hookimpl
def truing_models() -> list[Model[Cell, Reading]]:
    """Offer one calculation: load_cell."""
    return [LOAD_CELL]
