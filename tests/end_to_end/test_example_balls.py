"""The worked example of falling balls: drag in closed form, light balls, the dense control, what frames can show."""

from __future__ import annotations

import re
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from measured import documented, names
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares
from shown_in_docs import EXAMPLES

from truing.kernel.loading import load_file

EXAMPLE = EXAMPLES / "falling_balls"
PAGE = (EXAMPLE / "README.md").read_text(encoding="utf-8")
GRAVITY, AIR = 9.81, 1.2
Row = NDArray[np.float64]


@pytest.fixture(scope="module")
def ball() -> Any:
    return load_file(EXAMPLE / "falling_ball.py")


@dataclass(frozen=True)
class Drop:
    """One record, read without Truing."""

    time: Row
    height: Row
    mass: float
    diameter: float

    @property
    def lightness(self) -> float:
        """The drag of the ball per drag coefficient and mass, 1/m."""
        return AIR * np.pi * self.diameter**2 / 8 / self.mass


def drop_of(name: str) -> Drop:
    file = EXAMPLE / "drops" / f"{name}.csv"
    time, mass, diameter, height = np.genfromtxt(file, delimiter=",", skip_header=2, usecols=range(4)).T
    return Drop(time, height, float(mass[0]), float(diameter[0]))


def fallen(time: Row, drag: float) -> Row:
    """How far a ball falls from rest: ln cosh, or free where there is no drag (1/m)."""
    if drag < 1e-9:
        return GRAVITY * time**2 / 2
    return np.logaddexp(time * np.sqrt(GRAVITY * drag), -time * np.sqrt(GRAVITY * drag)) / drag - np.log(2) / drag


def fit(drops: list[tuple[Row, Row, float]]) -> tuple[float, float]:
    """Fit height and moment of release of each drop and one coefficient; return that, and the root mean square left."""

    def left(unknowns: Row) -> Row:
        each = zip(drops, unknowns[1::2], unknowns[2::2], strict=True)
        return np.concatenate(
            [
                start - fallen(np.maximum(time - begin, 0), unknowns[0] * per) - height
                for (time, height, per), start, begin in each
            ]
        )

    start = np.r_[0.4, np.tile([47.0, 0.1], len(drops))]
    lower, upper = np.r_[1e-6, np.tile([30.0, -1.0], len(drops))], np.r_[3.0, np.tile([60.0, 1.5], len(drops))]
    found = least_squares(left, start, bounds=(lower, upper))
    return float(found.x[0]), float(np.sqrt(np.mean(found.fun**2)))


def diagnosed(folder: Path, ball: str, numbers: str = "12") -> dict[str, Any]:
    shutil.copytree(EXAMPLE, folder / "desk", ignore=shutil.ignore_patterns("__pycache__", "runs"))
    drops = [f"drops/{ball}_{number}.csv" for number in numbers]
    return documented(folder / "desk", "falling_ball.py", *drops)


# The physics


@pytest.mark.parametrize(("drag", "viscosity"), [(0.5, 0.0), (1.3, 0.0), (0.0, 2e-2), (0.7, 1e-3), (0.0, 0.0)])
def test_a_ball_falls_as_its_differential_equation_says(ball: Any, drag: float, viscosity: float) -> None:
    model = ball.FALLING_BALL
    given = model.inputs(drag_coefficient=drag, viscosity=viscosity, release_time=0.25, lift_of_air=1.0)
    linear = 3 * np.pi * viscosity * given.diameter / given.mass
    square = AIR * np.pi * given.diameter**2 / 8 / given.mass * drag
    pull = GRAVITY * (1 - AIR * np.pi * given.diameter**3 / 6 / given.mass)

    def motion(_: float, state: Row) -> list[float]:
        return [state[1], pull - linear * state[1] - square * state[1] ** 2]

    frames = np.array([0.5, 1.0, 2.0, 3.0])
    by_steps = solve_ivp(motion, (0, 3), [0, 0], t_eval=frames - 0.25, rtol=1e-11, atol=1e-12)
    answer = model.function(model.inputs(
        drag_coefficient=drag, viscosity=viscosity, release_time=0.25, lift_of_air=1.0, frames=frames
    ))  # fmt: skip
    assert np.ravel(answer.height) == pytest.approx(47 - by_steps.y[0], abs=1e-7)
    assert np.ravel(answer.speed) == pytest.approx(by_steps.y[1], abs=1e-7)


# What the page says of each ball, computed apart from any diagnosis


@dataclass(frozen=True)
class Said:
    """One line of the table: lengths in m."""

    ball: str
    coefficient: float
    late: float
    left: float
    noise: float
    visible: float
    found: str


def table() -> list[Said]:
    lines = re.findall(
        r"^\| ([a-z][\w ]+) \| ([\d.]+) \| (\S+) m \| (\S+) m \| (\S+) m \| (\S+) \| (.+) \|$", PAGE, re.MULTILINE
    )
    assert len(lines) == 10
    return [Said(name.replace(" ", "_"), *map(float, numbers), found) for name, *numbers, found in lines]


@pytest.mark.parametrize("said", table(), ids=lambda said: said.ball)
def test_what_drag_would_do_to_each_ball(said: Said) -> None:
    drop = drop_of(f"{said.ball}_1")
    drag = said.coefficient * drop.lightness
    falling = np.maximum(drop.time - 0.1, 0)
    with_drag = fallen(falling, drag)
    assert said.late == pytest.approx((GRAVITY * falling**2 / 2 - with_drag)[-1], abs=6e-3)
    _, left = fit([(drop.time, 47 - with_drag, 0.0)])
    assert said.left == pytest.approx(left, abs=6e-3)
    if said.found == "nothing" and said.coefficient < said.visible:
        assert said.left < said.noise


@pytest.mark.parametrize("said", [said for said in table() if "air drag" in said.found], ids=lambda said: said.ball)
def test_the_coefficient_that_is_named_is_that_of_least_squares(said: Said) -> None:
    """Within its interval, and 8 %: by least squares all rows count, here those that err with their neighbours less."""
    drops = [drop_of(f"{said.ball}_{number}") for number in (1, 2)]
    value, _ = fit([(drop.time, drop.height, drop.lightness) for drop in drops])
    ((low, high),) = re.findall(r"air drag, [\d.]+ \(([\d.]+) … ([\d.]+)\)", said.found)
    assert 0.92 * float(low) < value < 1.08 * float(high)


# What the diagnosis says


@pytest.mark.parametrize("dense", ["golf_ball", "baseball"])
def test_nothing_is_named_that_the_rows_of_a_dense_ball_do_not_hold(dense: str, tmp_path: Path) -> None:
    found = diagnosed(tmp_path, dense)
    (said,) = [said for said in table() if said.ball == dense]
    assert found["remainder"] is None
    if found["verdict"] == "one_of":  # a golf ball has drag; "one of" names nothing, and drag is one of them
        assert ["air_drag"] in found["explanations"]
        assert len(found["explanations"]) > 1
        assert "one of" in said.found
    else:
        assert (found["explanations"], names(found), said.found) == ([], [], "nothing")
    assert found["smallest_visible"]["air_drag"]["value"] == pytest.approx(said.visible, abs=0.006)
    floor = found["wrong"]["height"]["noise_floor"]
    assert floor["value"] / {"m": 1, "mm": 1e3}[floor["unit"]] == pytest.approx(said.noise, abs=6e-3)


def test_a_basketball_is_not_explained_by_a_constant_coefficient(tmp_path: Path) -> None:
    found = diagnosed(tmp_path, "green_basketball")
    assert (found["verdict"], names(found)) == ("unknown", [])
    assert found["remainder"]["depends_on"] == ["time"]


def test_the_page_shows_drag_the_control_and_a_ball_never_fitted() -> None:
    """The page is run elsewhere; what it prints is compared with what is known."""
    said = re.findall(r"air drag, drag coefficient ([\d.]+) \(95 %: ([\d.]+) … ([\d.]+)\)(.)", PAGE)
    (first, second) = [(value, low, high) for value, low, high, end in said if end in ".;"]
    assert 0.45 < float(first[0]) < 0.69
    assert all(float(low) < 0.5 <= float(high) for _, low, high in (first, second))
    assert PAGE.count("Cause named, a remainder left") == 2
    assert PAGE.count("Nothing found. Within its tolerances") == 1  # the control
    held_out = re.findall(
        r"^On the rows held out the error of height falls from ([\d.]+) mm to ([\d.]+) mm", PAGE, re.M
    )
    (before, after), (before_other, after_other) = [map(float, pair) for pair in held_out]
    assert before > 15 * after
    assert before_other > 8 * after_other
