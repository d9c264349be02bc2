"""Strangers' calculations are diagnosed on their first day: by what they declare, and what gauges may do."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from diagnosis_contract import demand_contract
from measured import (
    CONTRACT,
    HEIGHT,
    Columns,
    Diagnosed,
    Document,
    calc_here,
    columns_of,
    diagnose_here,
    names,
    numbers,
    read_document,
    renamed,
    text_of,
)
from numpy.typing import NDArray
from strange_plugins import BEAM, EXACT_BEAM, GUEST, SLEDGE

from hidden_effects.asking import write_case
from hidden_effects.making import Wish, make_case
from hidden_effects.press_machine import POSITION
from shared import Calc, process

pytestmark = pytest.mark.filterwarnings("error::RuntimeWarning")
Array = NDArray[Any]
ROWS = 80
PIN = Path(__file__).parents[1] / "data" / "pin_wear.py"


@pytest.fixture(scope="session")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the strangers' files and an inputs file that says nothing."""
    folder = tmp_path_factory.mktemp("strangers")
    for name, text in {"beam.py": BEAM, "exact_beam.py": EXACT_BEAM, "sledge.py": SLEDGE}.items():
        (folder / name).write_text(text, encoding="utf-8")
    (folder / "inputs.toml").write_text("[studies]\nrun = []\n", encoding="utf-8")
    return folder


# A beam on a gauge that errs


def measured_beam(hidden: Callable[[Array, Array, Array], Array], softer: float) -> Columns:
    """Loads, angles, hours and temperatures; F L^3 / (3 E I) of a beam that is softer, what is hidden, 1.5 um of noise.

    ``hidden`` is given angles (rad), hours and temperatures, and returns micrometres.
    """
    rng = np.random.default_rng(21)
    load, turn = rng.uniform(20, 400, ROWS), rng.uniform(-180, 180, ROWS)
    hours = np.concatenate([[0.0], np.sort(rng.uniform(0, 8, ROWS - 1))])
    temperature = rng.uniform(18, 35, ROWS)
    angle = np.radians(turn)
    true = load * np.cos(angle) * 0.3**3 / (3 * 206e9 / softer * 8e-9) * 1e6
    read = true + hidden(angle, hours, temperature) + rng.normal(0, 1.5, ROWS)
    columns = {"load [N]": load, "turn [deg]": turn, "time [h]": hours + 400, "temperature [degC]": temperature}
    return numbers({**columns, "sag [um]": read})


GAUGES: dict[str, tuple[Callable[[Array, Array, Array], Array], dict[str, float]]] = {
    "sensor_offset": (lambda angle, hours, warm: np.full(ROWS, 8.0), {"sag": 8.0}),
    "sensor_drift": (lambda angle, hours, warm: -1.5 * hours, {"sag": -1.5}),
    "thermal_drift": (lambda angle, hours, warm: 0.4 * (warm - 20), {"sag": 0.4}),
    "periodic_order_of_turn": (
        lambda angle, hours, warm: np.asarray(3 * np.sin(2 * angle) - 2 * np.cos(2 * angle)),
        {"sag_sine": 3.0, "sag_cosine": -2.0, "sag_order": 2.0},
    ),
    "step": (lambda angle, hours, warm: 12.0 * (hours > 3.3), {"sag": 12.0, "sag_after": 3.3}),
}
UNITS = {
    "sensor_offset": "um",
    "sensor_drift": "um/h",
    "thermal_drift": "um/K",
    "periodic_order_of_turn": "um",
    "step": "um",
}


def demand_unknowns(document: Document, truth: dict[str, float]) -> None:
    """The one named cause has these unknowns, each within its interval."""
    (cause,) = document["causes"]
    assert cause["unknowns"].keys() == truth.keys()
    for name, value in truth.items():
        low, high = cause["unknowns"][name]["interval95"]
        assert low <= value <= high, name


@pytest.fixture(scope="session")
def on_its_gauge(desk: Path) -> Callable[[str], Diagnosed]:
    """Diagnose a beam on a gauge that does one thing wrong, once for all tests.

    The beam is 1 % softer than its drawing, half of what its tolerance allows: that is calibrated, not named.
    """

    @cache
    def ask(effect: str) -> Diagnosed:
        columns = measured_beam(GAUGES[effect][0], 1.01)
        return diagnose_here(desk, effect, text_of(columns), plugin="./beam.py")

    return ask


@pytest.mark.parametrize("effect", GAUGES)
def test_what_a_gauge_may_do_is_found_without_any_declaration(
    desk: Path, on_its_gauge: Callable[[str], Diagnosed], effect: str
) -> None:
    document, truth = on_its_gauge(effect).document, GAUGES[effect][1]
    assert names(document) == [effect]
    assert document["remainder"] is None
    demand_unknowns(document, truth)
    assert document["causes"][0]["unknowns"][next(iter(truth))]["unit"] == UNITS[effect]
    demand_contract(document, json.loads(calc_here(desk, "describe", "./beam.py", "--json").out))
    assert document["calibrated"]["modulus"]["of_its_sd"] == pytest.approx(-0.5, abs=0.1)


@pytest.mark.parametrize("effect", GAUGES)
def test_the_extended_model_shows_what_the_gauge_shows(
    desk: Path, on_its_gauge: Callable[[str], Diagnosed], effect: str
) -> None:
    found = on_its_gauge(effect)
    rows = (found.folder / "extended.toml", "--rows", f"{effect}.csv", "-o", "shown.csv")
    assert calc_here(desk, "table", "./beam.py", "--inputs", *rows).code == 0
    shown, read = (
        np.array(columns_of((desk / name).read_text(encoding="utf-8"))["sag [um]"], float)
        for name in ("shown.csv", f"{effect}.csv")
    )
    assert np.sqrt(np.mean((shown - read) ** 2)) < 1.2 * 1.5


def test_a_gauge_that_does_nothing_wrong(desk: Path) -> None:
    columns = measured_beam(lambda angle, hours, warm: 0 * hours, 1.01)
    found = diagnose_here(desk, "good gauge", text_of(columns), plugin="./beam.py")
    assert found.document["explanations"] == []
    assert found.document["wrong"]["sag"]["noise_floor"]["value"] == pytest.approx(1.5, rel=3 / np.sqrt(2 * ROWS))


def test_the_same_data_gives_the_same_bytes_and_a_folder_is_replaced_whole(
    desk: Path, on_its_gauge: Callable[[str], Diagnosed]
) -> None:
    """With --json there is one document and nothing else."""
    folder = on_its_gauge("sensor_offset").folder
    before = {name: (folder / name).read_bytes() for name in ("diagnosis.json", "extended.toml", "arrays.npz")}
    (folder / "remark.txt").write_text("mine", encoding="utf-8")
    folders = sorted(path.name for path in folder.parent.iterdir())
    words = ("--inputs", "inputs.toml", "--data", "sensor_offset.csv", "-o", folder.name, "--json")
    answer = calc_here(desk, "diagnose", "./beam.py", *words)
    assert (answer.code, answer.err) == (0, on_its_gauge("sensor_offset").answer.err)
    assert {name: (folder / name).read_bytes() for name in before} == before
    assert {path.name for path in folder.iterdir()} == CONTRACT | {"extended.toml"}
    assert sorted(path.name for path in folder.parent.iterdir()) == folders
    assert json.loads(answer.out) == on_its_gauge("sensor_offset").document


def test_a_plugin_without_any_tolerance(desk: Path) -> None:
    """Nothing can be calibrated: a beam that is 1 % softer is named as a gauge that reads 1 % too much."""
    exact = measured_beam(GAUGES["sensor_drift"][0], 1.0)
    found = diagnose_here(desk, "exact", text_of(exact), plugin="./exact_beam.py")
    assert names(found.document) == ["sensor_drift"]
    assert found.document["calibrated"] == {}
    demand_unknowns(found.document, {"sag": -1.5})
    softer = measured_beam(lambda angle, hours, warm: 0 * hours, 1.01)
    found = diagnose_here(desk, "softer", text_of(softer), plugin="./exact_beam.py")
    assert names(found.document) == ["sensor_gain"]
    demand_unknowns(found.document, {"sag": 0.01})
    again = ("--inputs", "of softer/extended.toml", "--data", "softer.csv", "-o", "again")
    assert calc_here(desk, "diagnose", "./exact_beam.py", *again).code == 0
    assert read_document(desk / "again")["explanations"] == []


# Files that are odd: what the press is too large for (others are tested in test_diagnose_bad_input.py)


def test_a_unit_that_is_probably_wrong_is_named_and_nothing_is_changed(desk: Path) -> None:
    columns = measured_beam(GAUGES["sensor_offset"][0], 1.01)
    found = diagnose_here(desk, "metres", text_of(renamed(columns, "sag [um]", "sag [mm]")), plugin="./beam.py")
    (unit_error,) = found.document["unit_slips"]
    assert unit_error["column"] == "sag"
    assert unit_error["factor"] == pytest.approx(1e-3, rel=1e-12)
    told = "the unit of column 'sag [mm]' is probably wrong: multiply it by 0.001; "
    assert unit_error["text"].startswith(told)
    assert f"warning: suspected unit slip: {unit_error['text']} (nothing was changed)" in found.answer.err
    assert "probably wrong" in (found.folder / "sheet.md").read_text(encoding="utf-8")
    measured = np.load(found.folder / "arrays.npz")["sag.measured"]
    assert measured == pytest.approx([1e3 * float(cell) for cell in columns["sag [um]"]], rel=1e-12)  # as it says


def test_hostile_words_are_shown_and_obeyed_nowhere(desk: Path) -> None:
    """A name that breaks out of a string of code carries the error, so it stands in every file that is written."""
    level = np.random.default_rng(8).uniform(0, 1, ROWS)
    evil, markup = 't"); import os; os.system("x") #', "remark <img src=x onerror=alert(1)>"
    columns = measured_beam(lambda angle, hours, warm: 50 * level, 1.01)
    columns[f"{evil} [mm]"] = [repr(value) for value in level.tolist()]
    columns[markup] = ["<script>alert(1)</script>", "=1+1", "\x1b[31mred", "{{ 7*7 }}", "$HOME"] * 16
    found = diagnose_here(desk, "oil <script>alert(2)<b>", text_of(columns), plugin="./beam.py")
    assert found.document["remainder"]["depends_on"] == [evil]
    assert {path.name for path in found.folder.iterdir()} == CONTRACT | {"new_effect.py", "extended.toml"}
    html = (found.folder / "sheet.html").read_text(encoding="utf-8")
    assert "<script>alert" not in html
    assert "<img src=x" not in html
    assert "\x1b" not in found.answer.out + found.answer.err
    texts = [path.read_bytes() for path in found.folder.iterdir() if path.suffix != ".npz"]
    assert not [text for text in texts if b"\x1b" in text]
    scope: dict[str, Any] = {"__name__": "new_effect"}
    exec(compile((found.folder / "new_effect.py").read_text(encoding="utf-8"), "new_effect.py", "exec"), scope)
    assert "os" not in scope
    assert calc_here(desk, "run", "./beam.py", "--inputs", found.folder / "extended.toml", "-o", "run").code == 0


# A result along an axis, measured by the rows of runs


def pushed_sledges() -> Columns:
    """Five pushes of other lengths and masses, recorded second by second; the gauge begins at 2.5 mm."""
    rng = np.random.default_rng(3)
    columns: Columns = {name: [] for name in ("run", "moment [s]", "force [N]", "mass [kg]", "way [mm]", "time [h]")}
    for run, mass in enumerate((30, 40, 55, 70, 50)):
        force = rng.uniform(0, 3, 20 + run)
        speed, way = 0.0, 0.0
        for second, newton in enumerate(force.tolist()):
            speed += newton / mass
            way += speed
            read = 1e3 * way + 2.5 + float(rng.normal(0, 0.5))
            cells = (f"push {run}", second, newton, mass, read, run * 0.5 + second / 3600)
            for column, cell in zip(columns.values(), cells, strict=True):
                column.append(str(cell))
    return columns


def test_a_record_along_an_axis_with_a_series_as_input(desk: Path) -> None:
    columns = pushed_sledges()
    found = diagnose_here(desk, "pushes", text_of(columns), plugin="./sledge.py")
    assert (found.document["rows"], found.document["runs"]) == (110, 5)
    assert names(found.document) == ["sensor_offset"]
    demand_unknowns(found.document, {"way": 2.5})
    assert found.document["calibrated"] == {}
    assert {path.name for path in found.folder.iterdir()} == CONTRACT | {"extended.toml"}
    answer = calc_here(desk, "run", "./sledge.py", "--inputs", "of pushes/extended.toml", "-o", "run")
    assert answer.code == 0, answer.err
    again = ("--inputs", "of pushes/extended.toml", "--data", "pushes.csv", "-o", "again")
    assert calc_here(desk, "diagnose", "./sledge.py", *again).code == 0
    assert read_document(desk / "again")["explanations"] == []


# Effects that strangers declare


def test_a_strangers_own_effect_is_named_with_its_shape(desk: Path) -> None:
    """Running-in: 9 um in the first 1.4 km and Archard's law by hand; a drift or an offset would be the vaguer word."""
    rng = np.random.default_rng(4)
    hours = np.concatenate([np.linspace(0.1, 3, 40), np.linspace(3.5, 60, 40)])
    distance = 0.5 * hours * 3600
    depth = 3e-8 * (120 / 28e-6) * distance / 2.1e9 * 1e6 + 9 * (1 - np.exp(-distance / 1400))
    columns = numbers({"time [h]": hours, "depth [um]": depth + rng.normal(0, 0.2, 80)})
    found = diagnose_here(desk, "running in", text_of(columns), plugin=PIN)
    assert names(found.document) == ["running_in"]
    demand_unknowns(found.document, {"extra": 9.0, "length": 1400.0})


def test_an_installed_strangers_effect_is_named(
    calc: Calc, strangers: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """VDI 2230 by hand: what is left of the preload after embedding, a working force and 12 um of later settling."""
    rng = np.random.default_rng(6)
    cycles, force = 10 ** rng.uniform(1, 6, ROWS), rng.uniform(0, 15, ROWS)
    pitch_diameter, core_diameter = 12 - 0.649519 * 1.75, 12 - 1.226869 * 1.75
    area = np.pi / 4 * ((pitch_diameter + core_diameter) / 2) ** 2
    preload = 84e3 / (1.75 / (2 * np.pi) + 0.577 * pitch_diameter * 0.12 + 15.05 / 2 * 0.12) / 1e3  # kN
    screw, plate = 60 / (205 * area), 60 / (205 * 330)  # mm/kN
    settled = 11e-3 + 12e-3 * (1 - np.exp(-cycles / 2e4))
    left = preload - settled / (screw + plate) - (1 - plate / (screw + plate)) * force
    columns = {
        "load_cycles [1]": cycles,
        "axial_force [kN]": force,
        "gauge_temperature [degC]": rng.uniform(15, 30, ROWS),
    }
    text = text_of(numbers({**columns, "clamp_left [kN]": left + rng.normal(0, 0.1, ROWS)}))
    (tmp_path / "joint.csv").write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(strangers)
    answer = calc("diagnose", "screw_joint", "--data", "joint.csv", "--json")
    assert answer.code == 0, answer.err
    document = json.loads(answer.out)
    assert names(document) == ["settling"]
    demand_unknowns(document, {"depth": 12.0, "life": 2e4})


# What nobody registered becomes an effect


@pytest.fixture(scope="session")
def oily(tmp_path_factory: pytest.TempPathFactory) -> Diagnosed:
    """A press whose slider hangs lower the more oil there is: curved, 12 um from empty to full; no effect knows oil."""
    folder = tmp_path_factory.mktemp("oily press")
    write_case(make_case(2, Wish("none", "wide", "gaussian", (POSITION,), 120)), folder)
    columns = columns_of((folder / "measured.csv").read_text(encoding="utf-8"))
    level = np.random.default_rng(9).uniform(0, 1, 120)
    lower = 0.012 * level**2
    columns[HEIGHT] = [repr(float(cell) + more) for cell, more in zip(columns[HEIGHT], lower.tolist(), strict=True)]
    return diagnose_here(folder, "oily", text_of({**columns, "oil_level [m]": [repr(one) for one in level.tolist()]}))


def test_what_nobody_registered_is_unknown_with_what_it_depends_on(oily: Diagnosed) -> None:
    assert oily.document["verdict"] == "unknown"
    assert oily.document["remainder"]["depends_on"] == ["oil_level"]
    assert "oil_level" in oily.document["remainder"]["shape"]
    assert {path.name for path in oily.folder.iterdir()} == CONTRACT | {"extended.toml", "new_effect.py"}


def test_the_new_effect_is_installed_and_named(
    calc: Calc, oily: Diagnosed, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As the file says: in a project of its own, installed as pip installs it, it is a candidate like any other."""
    project, installed = tmp_path / "project", tmp_path / "installed"
    project.mkdir()
    (project / "pyproject.toml").write_text(GUEST, encoding="utf-8")
    (project / "new_effect.py").write_bytes((oily.folder / "new_effect.py").read_bytes())
    options = ["--quiet", "--no-deps", "--no-build-isolation", "--no-index", "--disable-pip-version-check"]
    command = [sys.executable, "-m", "pip", "install", *options, "--target", str(installed), str(project)]
    done = process(command, tmp_path)
    assert done.code == 0, done.err
    data = oily.folder.parent
    for name in ("inputs.toml", "oily.csv"):
        (tmp_path / name).write_bytes((data / name).read_bytes())
    monkeypatch.syspath_prepend(installed)
    assert "adds 'remainder'" in calc("plugins").out
    answer = calc("diagnose", "press_linkage", "--inputs", "inputs.toml", "--data", "oily.csv", "--json")
    assert answer.code == 0, answer.err
    document = json.loads(answer.out)
    assert document["remainder"] is None
    demand_unknowns(document, {"factor": 1.0})
    assert names(document) == ["remainder"]
    extended = ("--inputs", "runs/oily/extended.toml", "--rows", "oily.csv", "-o", "shown.csv")
    assert calc("table", "press_linkage", *extended).code == 0
    shown, read = (columns_of((tmp_path / name).read_text(encoding="utf-8")) for name in ("shown.csv", "oily.csv"))
    errors = np.array(shown[HEIGHT], float) - np.array(read[HEIGHT], float)
    noise = oily.document["wrong"][POSITION]["noise_floor"]["value"] * 1e-3
    assert np.sqrt(np.mean(errors**2)) < 1.1 * noise
