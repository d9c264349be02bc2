"""The press linkage a second time, from its vector loops alone: nothing of the plugin is imported here.

The six loops stand as the paper writes them, complex numbers y + jz, side 2 with its own angles and no mirror. They are
solved as twelve simultaneous equations by scipy, differentiated by the implicit function theorem, and everything that
follows (scatter, chances, synthesis, cost) is written again from the formulas.
"""

from collections.abc import Iterator, Mapping
from itertools import product
from statistics import NormalDist
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, root

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
KINDS = (
    "crank_radius", "rod_length", "knee_drive_length", "upper_knee_length", "lower_knee_length", "slider_half_width",
    "slider_joint_angle", "crank_pivot_radius", "crank_pivot_angle", "platform_half_width", "platform_joint_angle",
    "ground_pivot_radius", "ground_pivot_angle", "crank_angle",
)  # fmt: skip
SOURCES = (*(f"{kind}_deviation_{side}" for side in (1, 2) for kind in KINDS), "platform_arm_deviation")
DIGITS = np.finfo(float).eps


def loops(unknown: Any, press: Values, crank: float, off: Values) -> list[Any]:
    """What is left of the loops I, II, III and VI, V, IV, real and imaginary part each; zero where all close.

    Unknowns of each side: its own platform height, the directions of rod, knee drive, upper and lower link, its face.
    """
    platform = (unknown[0] + unknown[6]) / 2
    left: list[Any] = []
    for side in (1, 2):
        own, rod, drive, upper, lower, face = unknown[6 * (side - 1) : 6 * side]
        outward, turn = (0.0, 1.0) if side == 1 else (np.pi, -1.0)

        def d(kind: str, side: int = side) -> Any:
            return off.get(f"{kind}_deviation_{side}", 0.0)

        a, k_r = press["crank_radius"] + d("crank_radius"), press["rod_length"] + d("rod_length")
        l_g, l_m = press["knee_drive_length"] + d("knee_drive_length"), press["upper_knee_length"]
        l_m, l_h = l_m + d("upper_knee_length"), press["lower_knee_length"] + d("lower_knee_length")
        k = press["platform_arm"] + off.get("platform_arm_deviation", 0.0)
        r_a, alpha_1 = press["crank_pivot_radius"] + d("crank_pivot_radius"), outward + d("crank_pivot_angle")
        e, beta_1 = press["platform_half_width"] + d("platform_half_width"), outward + d("platform_joint_angle")
        r_m = press["ground_pivot_radius"] + d("ground_pivot_radius")
        alpha_2 = outward + turn * press["ground_pivot_angle"] + d("ground_pivot_angle")
        l, beta_2 = press["slider_half_width"] + d("slider_half_width"), outward + d("slider_joint_angle")  # noqa: E741
        theta_1 = outward + turn * (crank + d("crank_angle"))
        left += [
            e * np.cos(beta_1) - r_a * np.cos(alpha_1) - a * np.cos(theta_1) - k_r * np.cos(rod),
            own + e * np.sin(beta_1) - r_a * np.sin(alpha_1) - a * np.sin(theta_1) - k_r * np.sin(rod),
            l_g * np.cos(drive) - r_m * np.cos(alpha_2) - l_m * np.cos(upper),
            platform + k + l_g * np.sin(drive) - r_m * np.sin(alpha_2) - l_m * np.sin(upper),
            l * np.cos(beta_2) - r_m * np.cos(alpha_2) - l_m * np.cos(upper) - l_h * np.cos(lower),
            face + l * np.sin(beta_2) - r_m * np.sin(alpha_2) - l_m * np.sin(upper) - l_h * np.sin(lower),
        ]
    return left


def dead_centre(press: Values) -> float:
    """The crank direction at which the platform is lowest: where its height over the crank angle has no slope."""

    def slope(crank: float) -> float:
        y = press["crank_pivot_radius"] + press["crank_radius"] * np.cos(crank) - press["platform_half_width"]
        across = press["crank_radius"] * np.sin(crank)
        return float(press["crank_radius"] * np.cos(crank) + y * across / np.sqrt(press["rod_length"] ** 2 - y * y))

    return float(brentq(slope, np.pi / 2, np.pi, xtol=1e-15, rtol=4 * DIGITS))


def closed(press: Values, crank_angle: float, off: Values | None = None) -> NDArray[np.float64]:
    """The twelve unknowns at a crank angle from the dead centre, followed from there in small steps of the crank."""
    bottom = dead_centre(press)
    drive, upper, lower = np.radians([10.0, 105.0, 62.0])
    guess = [
        1.4, bottom, drive, upper, lower, 3.5, 1.4, np.pi - bottom, np.pi - drive, np.pi - upper, np.pi - lower, 3.5,
    ]  # fmt: skip
    for part in np.linspace(0.0, 1.0, 2 + int(abs(crank_angle) / 0.1)):
        crank = bottom + part * crank_angle
        found = root(loops, guess, args=(press, crank, off or {}), method="hybr", options={"xtol": 1e-14})
        guess = found.x
    for _ in range(2):  # Newton, to the last digits
        guess = guess - np.linalg.solve(by(guess, press, crank, off or {}, None), loops(guess, press, crank, off or {}))
    assert np.abs(loops(guess, press, crank, off or {})).max() < 1e-14
    return np.asarray(guess)


def by(unknown: Any, press: Values, crank: float, off: Values, source: str | None) -> NDArray[np.float64]:
    """Derivatives of the loops by their unknowns (12, 12), or by one source (12,), from a step along i."""
    step = 1e-30
    if source is not None:
        moved = loops(unknown, press, crank, {**off, source: off.get(source, 0.0) + 1j * step})
        return np.array([np.imag(value) for value in moved]) / step
    columns = np.asarray(unknown, dtype=complex) + 1j * step * np.eye(12)
    return np.array([np.imag(loops(list(column), press, crank, off)) for column in columns]).T / step


def slider(unknown: Any, press: Values) -> tuple[Any, Any]:
    """Position and tilt from the faces of both sides."""
    return (unknown[5] + unknown[11]) / 2, (unknown[5] - unknown[11]) / (2 * press["slider_half_width"])


def derivatives(press: Values, crank_angle: float, off: Values | None = None) -> dict[str, tuple[float, float]]:
    """Change of position and tilt per metre or radian of each of the 29 sources."""
    crank, unknown = dead_centre(press) + crank_angle, closed(press, crank_angle, off)
    matrix = by(unknown, press, crank, off or {}, None)
    return {
        name: slider(np.linalg.solve(matrix, -by(unknown, press, crank, off or {}, name)), press) for name in SOURCES
    }


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
    """Position less its nominal, and tilt, of machines drawn at the dead centre; all loops by Newton's method."""
    rng = np.random.default_rng(seed)
    scatter = deviations(reading, dict.fromkeys(LINKS, "IT7"))
    off = {name: size * rng.standard_normal(machines) for name, size in scatter.items()}
    start, crank = closed(PAPER, 0.0), dead_centre(PAPER)
    inverse = np.linalg.inv(by(start, PAPER, crank, {}, None))
    unknown = np.repeat(start[:, None], machines, axis=1)
    for _ in range(8):  # with the matrix of the nominal machine: each step gains three digits or more
        unknown = unknown - inverse @ np.array(loops(unknown, PAPER, crank, off))
    assert np.abs(loops(unknown, PAPER, crank, off)).max() < 1e-13
    position, tilt = slider(unknown, PAPER)
    return position - slider(start, PAPER)[0], tilt
