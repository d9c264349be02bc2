"""Strangers' calculations are diagnosed on their first day: by what they declare, and what gauges may do."""

from __future__ import annotations

import json
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
    text_of,
)
from numpy.typing import NDArray
from strange_plugins import BEAM, EXACT_BEAM

from hidden_effects.asking import write_case
from hidden_effects.making import Wish, make_case
from hidden_effects.press_machine import POSITION
from shared import Calc

pytestmark = pytest.mark.filterwarnings("error::RuntimeWarning")
Array = NDArray[Any]
ROWS = 80


@pytest.fixture(scope="session")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the strangers' files and an inputs file that says nothing."""
    folder = tmp_path_factory.mktemp("strangers")
    for name, text in {"beam.py": BEAM, "exact_beam.py": EXACT_BEAM}.items():
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
def test_what_a_gauge_may_do_is_found_and_the_extended_model_shows_it(
    desk: Path, on_its_gauge: Callable[[str], Diagnosed], effect: str
) -> None:
    found, truth = on_its_gauge(effect), GAUGES[effect][1]
    document = found.document
    assert names(document) == [effect]
    assert document["remainder"] is None
    demand_unknowns(document, truth)
    assert document["causes"][0]["unknowns"][next(iter(truth))]["unit"] == UNITS[effect]
    demand_contract(document, json.loads(calc_here(desk, "describe", "./beam.py", "--json").out))
    assert document["calibrated"]["modulus"]["of_its_sd"] == pytest.approx(-0.5, abs=0.1)
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
    """As the file says: in a project of its own, which lies as pip installs it, it is a candidate like any other."""
    installed, described = tmp_path / "installed", tmp_path / "installed" / "oil_of_our_press-0.1.dist-info"
    described.mkdir(parents=True)
    (described / "METADATA").write_text("Metadata-Version: 2.1\nName: oil-of-our-press\nVersion: 0.1\n", "utf-8")
    (described / "entry_points.txt").write_text("[truing.plugins]\nmy_new_effect = new_effect\n", "utf-8")
    (installed / "new_effect.py").write_bytes((oily.folder / "new_effect.py").read_bytes())
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
