"""Better tolerances: the fronts of cost and wear, and what they do to the reliability over the hours."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from rv_wear.drawn_look import BLUE, GREEN, GREY, INK, MICRO, ORANGE, one_panel, signed
from rv_wear.least_costs import Front, Fronts
from truing import Optimum

PRINTED_OPTIMA = {0.95: (1291.0, 3.151), 0.999: (1300.0, 3.207)}
"""Cost (yuan) and wear (um) of the paper's optima by required reliability; its 100 % is read as 0.999."""
PRINTED_START = (1402.0, 3.127)
LOOKS = ((BLUE, "o"), (GREEN, "s"), (ORANGE, "^"))


def fronts_figure(fronts: "Fronts", optimum: "Optimum | None", start: tuple[float, float]) -> "Figure":
    """Draw the wear over the cost: the least costs by goal, designs that a search found, and what the paper prints.

    *start* is the cost (yuan) and the wear (m) of the run.
    """
    figure, panel = one_panel(4.2)
    for front, (colour, marker) in zip(fronts.fronts, LOOKS, strict=False):
        if not front.designs:
            continue
        cost, wear = _places(front)
        words = f"least cost for {_percent(front.goal)}"
        panel.plot(cost, wear, color=colour, marker=marker, markersize=3.5, label=words)
        if front.goal in PRINTED_OPTIMA:
            panel.plot(
                *PRINTED_OPTIMA[front.goal], "D", markersize=9, fillstyle="none", color=colour,
                label=f"the paper's optimum for {'100 %' if front.goal > 0.99 else _percent(front.goal)}",
            )  # fmt: skip
        if front.knee is not None:
            panel.plot(cost[front.knee], wear[front.knee], marker, markersize=10, fillstyle="none", color=colour)
        _modifications(panel, front)
    if optimum is not None and optimum.front:
        found = _found(optimum)
        goal = float(fronts.inputs.required_reliability)
        panel.plot(*found, ".", color=GREY, markersize=3.0, label=f"found by the search for {_percent(goal)}", zorder=1)
    panel.plot(start[0], start[1] / MICRO, "X", color=INK, markersize=8, linestyle="", label="as stated")
    panel.plot(*PRINTED_START, "D", markersize=9, fillstyle="none", color=INK, label="the paper, before", linestyle="")
    panel.set_xlabel("price of all zones, yuan")
    panel.set_ylabel("deepest wear after the working time, µm")
    panel.grid(alpha=0.4)
    panel.set_axisbelow(True)
    panel.margins(0.08)
    panel.legend(loc="upper right", fontsize=7.5)
    return figure


def _places(front: "Front") -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Cost in yuan and wear in um of all designs."""
    return (
        np.array([design.cost for design in front.designs]),
        np.array([design.wear / MICRO for design in front.designs]),
    )


def _found(optimum: "Optimum") -> tuple[list[float], list[float]]:
    return (
        [design.objectives["tolerance_price"] for design in optimum.front],
        [design.objectives["max_wear"] / MICRO for design in optimum.front],
    )


def _modifications(panel: Any, front: "Front") -> None:
    """The equidistant modification at both ends of a front and at its knee."""
    for place in sorted({0, front.knee or 0, len(front.designs) - 1}):
        design = front.designs[place]
        panel.annotate(
            f"{signed(design.modification / MICRO, '.1f')} µm", (design.cost, design.wear / MICRO), (8, 5),
            textcoords="offset points", fontsize=7, color=INK,
        )  # fmt: skip


def _percent(share: float) -> str:
    return f"{100 * share:g} %"


def better(fronts: "Fronts | None") -> Mapping[str, tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Times (s) and reliabilities of the knee of each front."""
    found = {}
    for front in fronts.fronts if fronts is not None else ():
        if front.knee is None or not len(front.times):
            continue
        design = front.designs[front.knee]
        words = f"{design.cost:.0f} yuan, {signed(design.modification / MICRO, '.1f')} µm, for {_percent(front.goal)}"
        found[words] = (front.times, front.chances)
    return found


def at_printed_wear(front: "Front") -> float | None:
    """Our least cost at the wear of the paper's optimum, between the designs beside it; None beyond the front."""
    printed = PRINTED_OPTIMA.get(front.goal)
    if printed is None or len(front.designs) < 2:
        return None
    cost, wear = _places(front)
    return float(np.interp(printed[1], wear, cost)) if wear[0] <= printed[1] <= wear[-1] else None
