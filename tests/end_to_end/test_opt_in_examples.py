"""Examples on records that are not shipped: without them what can be checked is the plugins and the preparation.

The effects are hidden by generators of other physics than the plugins write: a slider that is moved step by step, waves
by complex numbers, a ladder of springs and dampers.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from shown_in_docs import EXAMPLES, NEEDED

from truing import Kernel
from truing.kernel import Offer
from truing.kernel.loading import load_file
from truing.testing import assert_finds, assert_finds_nothing, recorded

NAMES = ("cycloid_torsion", "cycloid_ripple", "harmonic_stall", "cycloid_drag")
Values = NDArray[np.float64]


def offer_of(name: str) -> Offer:
    """The calculation of an example, as the command line offers its file."""
    kernel = Kernel()
    kernel.add_file(EXAMPLES / name / f"{name}.py")
    return kernel.offer(name)


OFFERS = {name: offer_of(name) for name in NAMES}


def record(name: str, columns: Mapping[str, Sequence[float] | Values], **hidden: Any) -> Any:
    """A record that a diagnosis reads, with what is hidden in it."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*(np.round(values, 9).tolist() for values in columns.values()), strict=True))
    return recorded(OFFERS[name].model, inputs=f'plugin = "{name}"\n', measured=text.getvalue(), **hidden)


def ramps(peaks: Sequence[float], rows: int) -> Values:
    """A torque that goes from 0 to each peak in turn, in even steps."""
    corners = np.array([0.0, *peaks])
    length = np.append(0.0, np.cumsum(np.abs(np.diff(corners))))
    return np.asarray(np.interp(np.linspace(0, length[-1], rows), length, corners))


def behind_a_slider(torque: Values, friction: float, doubled_at: float) -> Values:
    """The torque of a spring behind a slider that is dragged as soon as more than its friction pulls on it."""
    spring, moved = 0.0, []
    for pull in torque.tolist():
        most = friction + friction / doubled_at * abs(pull)
        spring = max(min(spring, pull + most), pull - most)
        moved.append(spring)
    return np.array(moved)


def test_friction_that_drags_a_slider_is_found() -> None:
    torque = ramps([20, -20, 20, -20, 0], 90)
    angle = 1000 * behind_a_slider(torque, 3.0, 300.0) / 430 + np.random.default_rng(1).normal(0, 0.4, 90)
    columns = {"time [s]": np.arange(90.0), "torque_command [N*m]": torque, "torque [N*m]": torque}
    columns["angle [mrad]"] = angle
    assert_finds(record("cycloid_torsion", columns, effect="friction", truth={"torque": 3.0, "doubled_at": 300.0}))


def test_a_wave_of_the_eccentric_shaft_is_found() -> None:
    turned = np.linspace(0, 2 * np.pi * 1.7, 100)
    wave = 0.6 * np.exp(1j * (26 * turned + 0.8))  # twice in a turn of the shaft
    torque = 6 + wave.imag + np.random.default_rng(2).normal(0, 0.2, 100)
    columns = {"time [s]": 0.32 * turned, "angle [rad]": 0.4 + turned, "torque [N*m]": torque}
    truth = {"sine_2": 0.6 * np.cos(0.8), "cosine_2": 0.6 * np.sin(0.8)}
    assert_finds(record("cycloid_ripple", columns, effect="eccentric_shaft", truth=truth))


def test_a_brake_is_found_beside_grease() -> None:
    speed = ramps([10, -10, 0], 120)[1:-1] + 0.01
    brake = np.where(speed > 0, 2.5, -2.5)  # a pad that is dragged, either way
    torque = brake + 0.12 * speed + np.random.default_rng(5).normal(0, 0.1, len(speed))
    columns = {"time [s]": np.arange(len(speed)) / 2, "speed [rad/s]": speed, "torque [N*m]": torque}
    assert_finds(record("cycloid_drag", columns, effect="dry_friction", truth={"torque": 2.5}))


def ladder(held: Values, per_decade: float) -> Values:
    """What springs that relax, two for each decade of time from 1 ms to 10000 s, have let go since one second."""
    times = np.logspace(-3, 4, 15)
    since_one = np.exp(-1 / times) - np.exp(-held[:, None] / times)
    return np.asarray(np.sum(since_one, axis=1)) * per_decade / 2


def held_up(ratio: float, per_decade: float, seed: int) -> dict[str, Any]:
    """A stalled lever at 0.7 A, read every 0.2 s."""
    held = np.arange(0.2, 15, 0.2)
    torque = ratio * 0.7 * 0.313 * (1 - ladder(held, per_decade))
    noise = np.random.default_rng(seed).normal(0, 0.002 * ratio * 0.219, len(held))
    shared = {"time [s]": held + 3, "held [s]": held, "ratio [-]": np.full(len(held), ratio)}
    return {**shared, "motor_current [A]": np.full(len(held), 0.7), "lever_torque [N*m]": torque + noise}


def test_a_gear_that_relaxes_is_found() -> None:
    assert_finds(record("harmonic_stall", held_up(20, 0.035, 3), effect="relaxation", truth={"per_decade": 0.035}))


def test_a_motor_without_a_gear_relaxes_not() -> None:
    assert_finds_nothing(record("harmonic_stall", held_up(1, 0, 4)))


# Preparation


def preparation(name: str) -> ModuleType:
    """The script of an example that makes measured rows of the published record."""
    return load_file(EXAMPLES / name / "prepare.py")


def made(folder: Path, name: str = "measured.csv") -> list[dict[str, str]]:
    """The rows that a script wrote."""
    with (folder / name).open(encoding="utf-8", newline="") as lines:
        return list(csv.DictReader(lines))


def torsion_record(loops: Sequence[int]) -> str:
    """Sixteen rows of each loop, in the columns of the published record."""
    rows = [f"{n},{loop},small,{n / 10},{n / 10 + 0.01},0.00{n}" for loop in loops for n in range(16)]
    return "\n".join(["time [s],ramp [-],ramp_kind [-],torque_command [N*m],torque [N*m],angle [rad]", *rows])


def ripple_record(turns: float) -> str:
    """Some ten rows in each turn, in the columns of the published record."""
    angles = (0.5 + np.arange(0, turns, 0.0999)) * 2 * np.pi
    rows = [f"{angle / 3},{angle},3.1,7.5,38" for angle in angles]
    return "\n".join(["time [s],angle [rad],speed [rad/s],torque [N*m],controller_temperature [degC]", *rows])


def stall_record(*gears: int) -> str:
    """A run without (0) or with a gear for each, 20 s long, switched on after 2 s."""
    rows = [
        f"{run},{gear},fresh,0.7,{n / 10},{(2 if gear else 0.2) if n >= 20 else 0}"
        for run, gear in enumerate(gears, start=1)
        for n in range(200)
    ]
    return "\n".join(["run [-],gearbox [-],state [-],motor_current [A],time [s],lever_torque [N*m]", *rows])


@pytest.fixture
def prepare(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str, str], int]:
    """Write a record, and let the script of an example read it in an empty folder."""

    def run(name: str, text: str) -> int:
        (tmp_path / "data.csv").write_text(text, encoding="utf-8")
        monkeypatch.chdir(tmp_path)
        return int(preparation(name).main(["data.csv"]))

    return run


def test_loops_3_4_and_7_of_the_torsion_judge(prepare: Callable[[str, str], int], tmp_path: Path) -> None:
    assert prepare("cycloid_torsion", torsion_record(range(8))) == 0
    rows = made(tmp_path)
    assert [float(row["time [s]"]) for row in rows] == [3.5, 11.5] * 8  # means of 0 to 7 and of 8 to 15
    assert [float(row["torque [N*m]"]) for row in rows] == pytest.approx([0.36, 1.16] * 8)
    assert {row["ramp [-]"] for row in rows if row["record"] == "validation"} == {"3", "4", "7"}
    assert {row["ramp [-]"] for row in rows if row["record"] == "fit"} == {"0", "1", "2", "5", "6"}


def test_what_follows_20_turns_of_the_ripple_judges(prepare: Callable[[str, str], int], tmp_path: Path) -> None:
    assert prepare("cycloid_ripple", ripple_record(29)) == 0
    rows = made(tmp_path)
    assert [row["record"] for row in rows] == ["fit"] * 101 + ["validation"] * 45  # 0, 0.1998 ... 19.98 turns
    assert "speed [rad/s]" not in rows[0]


def test_the_first_third_of_a_plateau_is_fitted(prepare: Callable[[str, str], int], tmp_path: Path) -> None:
    assert prepare("harmonic_stall", stall_record(0, 1)) == 0
    alone, geared = made(tmp_path, "run1.csv"), made(tmp_path, "run2.csv")
    assert {row["ratio [-]"] for row in alone} == {"1"}
    assert {row["ratio [-]"] for row in geared} == {"20"}
    assert float(geared[0]["held [s]"]) == pytest.approx(0.2)  # on since 2.0 s, read every 0.1 s
    assert float(geared[1]["held [s]"]) == pytest.approx(0.6)
    last = max(float(row["held [s]"]) for row in geared if row["record"] == "fit")
    assert last < float(geared[-1]["held [s]"]) / 3 < last + 0.4


def drag_record(rows: int) -> str:
    """Ten rows a second of a ramp that gains 0.3 rad/s in a second, in the columns of the published record."""
    lines = [f"{n / 10},{0.03 * n},{0.03 * n},{1 + n}" for n in range(rows)]
    return "\n".join(["time [s],speed [rad/s],speed_command [rad/s],torque [N*m]", *lines])


def test_every_second_stretch_of_the_drag_judges(prepare: Callable[[str, str], int], tmp_path: Path) -> None:
    assert prepare("cycloid_drag", drag_record(240)) == 0
    rows = made(tmp_path)
    assert [float(row["time [s]"]) for row in rows] == pytest.approx(
        [2.35 + 1.6 * n for n in range(14)]
    )  # first too slow
    assert [row["record"] for row in rows] == ["fit"] * 5 + ["validation"] * 7 + ["fit"] * 2
    assert [float(row["acceleration [rad/s^2]"]) for row in rows] == pytest.approx([0.3] * 14)
    assert float(rows[0]["torque [N*m]"]) == pytest.approx(24.5)  # the mean of 17 to 32


FATIGUE = "stress [MPa],life [kcycles],outcome [-]\n"
WEAR = "specimen [-],load [gf],cycles [-],wear [um]\n"


def test_run_outs_are_marked_at_their_last_cycle(prepare: Callable[[str, str], int], tmp_path: Path) -> None:
    assert prepare("panel_fatigue", FATIGUE + "380,100,failed\n270,10000,runout\n300,1000,failed\n") == 0
    rows = [tuple(row.values()) for row in made(tmp_path, "lives.csv")]
    assert rows == [("380", "5", "failed"), ("270", "7", "runout"), ("300", "6", "failed")]


def test_the_last_two_specimens_of_a_load_judge(prepare: Callable[[str, str], int], tmp_path: Path) -> None:
    assert prepare("sliding_wear", WEAR + "".join(f"{name},10,2,100\n" for name in (7, 8, 9))) == 0
    assert [list(row.values())[-1] for row in made(tmp_path)] == ["fit", "validation", "validation"]
    assert [*made(tmp_path, "logarithms.csv")[0].values()] == ["7", "10", "2", "2.000000", "fit"]


NO_FILE = "this is no table"
REFUSED = [
    ("cycloid_torsion", NO_FILE, r"data.csv:1: no column 'time \[s\]'; README.md says which file is meant"),
    ("cycloid_torsion", torsion_record(range(3)), r"data.csv: .* lacks the loops 3, 4 and 7, or holds nothing else"),
    ("cycloid_torsion", torsion_record([3, 4, 7]), r"data.csv: .* lacks the loops 3, 4 and 7, or holds nothing else"),
    ("cycloid_torsion", torsion_record(range(8)).replace("0.007", "slip"), r"data.csv:9: angle 'slip' is no number"),
    ("cycloid_ripple", NO_FILE, r"data.csv:1: no column 'time \[s\]'; README.md says which file is meant"),
    ("cycloid_ripple", ripple_record(12), r"data.csv: fewer than 20 turns, so that no row is left to judge"),
    ("cycloid_ripple", ripple_record(1) + "\n0,far,3,7,38\n" * 2, r"data.csv:\d+: angle 'far' is no number"),
    ("harmonic_stall", NO_FILE, r"data.csv:1: no column 'run \[-\]'; README.md says which file is meant"),
    (
        "harmonic_stall",
        stall_record(1).replace("19.9,2", "19.9,much"),
        r"data.csv:201: lever_torque 'much' is no number",
    ),
    ("cycloid_drag", NO_FILE, r"data.csv:1: no column 'time \[s\]'; README.md says which file is meant"),
    ("cycloid_drag", drag_record(80), r"data.csv: shorter than two stretches of 10 s, so that no row is left to judge"),
    ("cycloid_drag", drag_record(240).replace(",9\n", ",slip\n"), r"data.csv:10: torque 'slip' is no number"),
    ("panel_fatigue", NO_FILE, r"data.csv:1: no column 'stress \[MPa\]'; README.md says which file is meant"),
    (
        "panel_fatigue",
        FATIGUE + "380,100,failed\n",
        r"data.csv: .* other words than 'failed' and 'runout', .*",
    ),
    ("panel_fatigue", FATIGUE + "380,100,failed\n270,0,runout\n", r"data.csv:3: life '0' is no number above 0"),
    ("sliding_wear", NO_FILE, r"data.csv:1: no column 'specimen \[-\]'; README.md says which file is meant"),
    ("sliding_wear", WEAR + "1,10,2,3\n2,10,2,3\n", r"data.csv: .* fewer than 3 specimens: none is left to .*"),
    ("sliding_wear", WEAR + "1,10,2,worn\n", r"data.csv:2: wear 'worn' is no number above 0"),
    ("harmonic_stall", "\n".join(stall_record(1).splitlines()[:25]), r"data.csv: the plateau of run 1 is too short"),
]


@pytest.mark.parametrize(("name", "text", "sentence"), REFUSED)
def test_another_file_is_refused_in_one_sentence(
    name: str, text: str, sentence: str, prepare: Callable[[str, str], int], tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    assert prepare(name, text) == 2
    assert re.fullmatch(sentence + "\n", capsys.readouterr().err)
    assert [file.name for file in tmp_path.iterdir()] == ["data.csv"]


@pytest.mark.parametrize("name", [*NAMES, "panel_fatigue", "sliding_wear"])
def test_without_a_record_there_is_one_sentence(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    script = preparation(name)
    assert script.main([]) == 2
    assert capsys.readouterr().err == "name the published record: python prepare.py data.csv\n"
    assert script.main(["nowhere.csv"]) == 2
    assert capsys.readouterr().err == "nowhere.csv: no such file; README.md says where the record comes from\n"


@pytest.mark.parametrize("name", NAMES)
def test_the_page_says_where_the_record_comes_from_and_none_is_shipped(name: str) -> None:
    page = (EXAMPLES / name / "README.md").read_text(encoding="utf-8")
    assert NEEDED.search(page)
    assert "https://creativecommons.org/licenses/by-sa/4.0/" in page
    assert "https://github.com/" in page
    ignored = (EXAMPLES / name / ".gitignore").read_text(encoding="utf-8").split()
    assert ignored[0] == "data.csv"
    files = {file.name for file in (EXAMPLES / name).iterdir() if file.is_file() and not any(map(file.match, ignored))}
    assert files == {".gitignore", "README.md", "inputs.toml", "prepare.py", f"{name}.py"}
