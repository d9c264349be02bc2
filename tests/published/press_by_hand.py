"""The press linkage a second time, from a machine that imports nothing of the plugin, for any sizes.

The machine of the benchmark closes the loops on complex numbers, side 2 with its own angles and no mirror. Derivatives
are differences of it, and everything that follows (scatter, chances, synthesis, cost) is written again from formulas.
"""

from collections.abc import Iterator, Mapping
from itertools import product
from math import acos
from statistics import NormalDist
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hidden_effects import press_machine

Values = Mapping[str, Any]

PAPER = {
    "crank_radius": 0.36, "rod_length": 1.304, "platform_arm": 0.6, "knee_drive_length": 0.868,
    "upper_knee_length": 1.7, "lower_knee_length": 1.6, "slider_half_width": 1.6, "crank_pivot_radius": 1.2,
    "platform_half_width": 0.3, "ground_pivot_radius": 1.393, "ground_pivot_angle": 0.367,
}  # fmt: skip
CHANGED = {
    "crank_radius": 0.31, "rod_length": 1.42, "platform_arm": 0.52, "knee_drive_length": 0.93,
    "upper_knee_length": 1.6, "lower_knee_length": 1.5, "slider_half_width": 1.45, "crank_pivot_radius": 1.1,
    "platform_half_width": 0.35, "ground_pivot_radius": 1.3, "ground_pivot_angle": 0.33,
}  # fmt: skip
KINDS = tuple(press_machine.NOMINAL)
SOURCES = (*(f"{kind}_deviation_{side}" for side in (1, 2) for kind in KINDS), "platform_arm_deviation")
STEP = 1e-4
CLOSE = 3e-11
"""Of a derivative: rounding of positions of some metres over the step."""


def slider(press: Values, crank_angle: float, off: Values) -> tuple[Any, Any]:
    """Position and tilt at a crank angle from the dead centre of these sizes, off as the inputs have it.

    Sizes of another press are the paper's, off by what is between them; angles of the frame count from pi on side 2.
    """
    beside = {kind: press.get(kind, 0.0) - PAPER.get(kind, 0.0) for kind in KINDS}
    more = {f"{kind}_deviation_{side}": size for kind, size in beside.items() for side in (1, 2)}
    more["ground_pivot_angle_deviation_2"] *= -1
    more["platform_arm_deviation"] = press["platform_arm"] - PAPER["platform_arm"]
    sizes = press_machine.built({name: size + off.get(name, 0.0) for name, size in more.items()})
    across = press["platform_half_width"] - press["crank_pivot_radius"]
    lowest = acos(across / (press["crank_radius"] + press["rod_length"]))
    found = press_machine.slider(np.asarray(crank_angle + lowest - press_machine.BOTTOM), sizes)
    span = PAPER["slider_half_width"] / press["slider_half_width"]
    return found[press_machine.POSITION], found[press_machine.TILT] * span


def derivatives(press: Values, crank_angle: float, off: Values | None = None) -> dict[str, tuple[float, float]]:
    """Change of position and tilt per metre or radian of each of the 29 sources, by five points."""
    known = off or {}

    def at(name: str, steps: int) -> NDArray[np.float64]:
        return np.array(slider(press, crank_angle, {**known, name: known.get(name, 0.0) + steps * STEP}))

    found = {name: (8 * (at(name, 1) - at(name, -1)) - at(name, 2) + at(name, -2)) / (12 * STEP) for name in SOURCES}
    return {name: (float(position), float(tilt)) for name, (position, tilt) in found.items()}


LINKS = {  # ISO 286-1, Table 1, IT5 IT6 IT7 at the size of the link, m
    "lower_knee_length": (55e-6, 78e-6, 125e-6), "upper_knee_length": (65e-6, 92e-6, 150e-6),
    "knee_drive_length": (40e-6, 56e-6, 90e-6), "rod_length": (55e-6, 78e-6, 125e-6),
    "crank_radius": (25e-6, 36e-6, 57e-6), "platform_arm": (32e-6, 44e-6, 70e-6),
}  # fmt: skip
GRADES = ("IT5", "IT6", "IT7")
GOALS = (0.88, 0.95)


def on(link: str) -> list[str]:
    """The sources of one kind."""
    return [name for name in SOURCES if name.rsplit("_deviation", 1)[0] == link]


def installed(reading: str) -> dict[str, float]:
    """Standard deviations of the mounted joints: half-bands over three, across a radius over that radius."""
    pivot = 0.1e-3 if reading == "complete" else 0.05e-3
    along = {"slider_half_width": 0.05e-3, "crank_pivot_radius": pivot, "platform_half_width": 0.05e-3}
    along["ground_pivot_radius"] = 0.05e-3
    across = {
        "slider_joint_angle": 0.05e-3 / 1.6, "crank_pivot_angle": 0.1e-3 / 1.2,
        "platform_joint_angle": 0.05e-3 / 0.3, "ground_pivot_angle": 0.05e-3 / 1.393,
    }  # fmt: skip
    kinds = along | (across if reading == "complete" else {})
    return {name: half / 3 for kind, half in kinds.items() for name in on(kind)}


def deviations(reading: str, grades: Mapping[str, str]) -> dict[str, float]:
    """Standard deviation of every source with these grades of the links: a sixth of the band."""
    made = {name: LINKS[link][GRADES.index(grade)] / 6 for link, grade in grades.items() for name in on(link)}
    return installed(reading) | made


def limits(reading: str) -> tuple[float, float]:
    """The limits of position (m) and tilt (rad)."""
    return 0.02e-3, np.radians(0.0013 if reading == "complete" else 0.001324)


def chances(slopes: Mapping[str, tuple[float, float]], reading: str, grades: Mapping[str, str]) -> tuple[float, float]:
    """Both reliabilities to first order."""
    scatter = deviations(reading, grades)
    found = []
    for result, limit in enumerate(limits(reading)):
        sd = sum((slopes[name][result] * size) ** 2 for name, size in scatter.items()) ** 0.5
        found.append(1 - 2 * NormalDist().cdf(-limit / sd))
    return found[0], found[1]


def coefficients(slopes: Mapping[str, tuple[float, float]]) -> dict[str, float]:
    """Half the influence of the most influential link over one's own, half its tolerance over one's own."""
    weight = {link: sum(abs(slopes[name][0]) for name in on(link)) for link in LINKS}
    first = max(weight, key=lambda link: weight[link])
    return {link: (weight[first] / weight[link] + LINKS[first][2] / LINKS[link][2]) / 2 for link in LINKS}


def reached(both: tuple[float, float]) -> bool:
    """Whether both goals are met."""
    return both[0] >= GOALS[0] and both[1] >= GOALS[1]


def steps(slopes: Mapping[str, tuple[float, float]], reading: str) -> Iterator[tuple[str, str, tuple[float, float]]]:
    """Give link, new grade and both reliabilities of each adjustment: the coarsest first, by smallest coefficient."""
    order = coefficients(slopes)
    grades = dict.fromkeys(LINKS, "IT7")
    for coarse, fine in (("IT7", "IT6"), ("IT6", "IT5")):
        for link in sorted(LINKS, key=lambda link: order[link]):
            if reached(chances(slopes, reading, grades)):
                return
            assert grades[link] == coarse
            grades[link] = fine
            yield link, fine, chances(slopes, reading, grades)


def cheapest(slopes: Mapping[str, tuple[float, float]], reading: str) -> tuple[float, dict[str, str]] | None:
    """Try all 729 choices of three grades for six links; the sum of 1/width in 1/mm, and the grades."""
    best: tuple[float, dict[str, str]] | None = None
    for choice in product(GRADES, repeat=len(LINKS)):
        grades = dict(zip(LINKS, choice, strict=True))
        cost = sum(1e-3 / LINKS[link][GRADES.index(grade)] for link, grade in grades.items())
        if (best is None or cost < best[0]) and reached(chances(slopes, reading, grades)):
            best = cost, grades
    return best


def drawn(reading: str, machines: int, seed: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Position less its nominal, and tilt, of machines drawn at the dead centre."""
    rng = np.random.default_rng(seed)
    scatter = deviations(reading, dict.fromkeys(LINKS, "IT7"))
    off = {name: size * rng.standard_normal(machines) for name, size in scatter.items()}
    position, tilt = slider(PAPER, 0.0, off)
    return position - slider(PAPER, 0.0, {})[0], tilt
