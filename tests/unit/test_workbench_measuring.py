"""Measured files in the workbench: names made harmless, uploads that lose nothing, guesses, wrong rows, the figure."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from starlette.testclient import TestClient

from shared import ROOT
from truing.errors import UsageError
from truing.workbench import bench
from truing.workbench.guard import Key
from truing.workbench.guesses import Column, Quantity, guesses, split_unit
from truing.workbench.measuring import harmless
from truing.workbench.preview import MOST, Axis, drawn, thinned
from truing.workbench.server import application
from truing.workbench.tasks import diagnoses, records
from truing.workbench.workers import Workers

SCREW = ROOT / "docs" / "examples" / "roller_screw_rubs"
INPUTS = (SCREW / "inputs.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("run 4.csv", "run 4.csv"),
        ("../../etc/cron.d/x.csv", "x.csv"),
        ("C:\\data\\Größe.CSV", "Größe.csv"),
        ("a\0b<c>:d.csv", "a_b_c__d.csv"),
        ("...hidden.csv", "hidden.csv"),
        ("con.csv", "_con.csv"),
        ("x" * 500 + ".csv", "x" * 120 + ".csv"),
    ],
)
def test_names_are_made_harmless(name: str, expected: str) -> None:
    assert harmless(name) == expected


@pytest.mark.parametrize("name", ["", ".csv", "x.exe", "x.csv.py", "inputs.toml", "/", "..", ". .csv"])
def test_what_is_no_measured_file_is_not_taken_in(name: str) -> None:
    with pytest.raises(UsageError, match="is no measured file that is read"):
        harmless(name)


PRESS = [
    Quantity("slider_position", "mm", "y", "of the slider"),
    Quantity("link_temperature", "degC", "", "temperature of the links"),
    Quantity("crank_angle", "deg", "theta", "crank from the bottom dead centre"),
    Quantity("load", "N", "F", "normal load"),
    Quantity("rate", "", "k", "wear coefficient"),
]


@pytest.mark.parametrize(
    ("written", "name", "unit"),
    [
        ("temp_C", "link_temperature", "degC"),
        ("Crank Angle (deg)", "crank_angle", "deg"),
        ("slider_positon/um", "slider_position", "um"),
        ("F", "load", "N"),
        ("F_kN", "load", "kN"),
        ("theta", "crank_angle", "deg"),
    ],
)
def test_a_column_is_guessed_by_its_name_its_symbol_and_its_unit(written: str, name: str, unit: str) -> None:
    guess = guesses([Column(written, written, None)], PRESS)[written]
    assert (guess.name, guess.unit) == (name, unit)


@pytest.mark.parametrize(("written", "unit"), [("operator", None), ("x", None), ("temp", "kN"), ("remark_C", None)])
def test_nothing_is_guessed_where_nothing_speaks_for_it(written: str, unit: str | None) -> None:
    assert guesses([Column(written, written, unit)], PRESS) == {}


def test_a_quantity_is_guessed_once_and_a_unit_that_the_file_states_is_left_alone() -> None:
    made = guesses([Column("temperature", "temperature", "K"), Column("temp_C", "temp_C", None)], PRESS)
    assert [(key, guess.name, guess.unit) for key, guess in made.items()] == [("temperature", "link_temperature", "")]
    assert list(split_unit("wear rate")) == []


def test_thinning_keeps_the_peaks_and_the_order() -> None:
    x = np.arange(100_000.0)
    y = np.sin(x / 5000)
    y[[7, 51_234]] = 9, -9
    rows = thinned(x, y)
    assert len(rows) <= MOST
    assert {7, 51_234} <= set(rows.tolist())
    assert (np.diff(x[rows]) >= 0).all()
    svg = drawn(Axis("<row>", x), Axis("b & c", y), np.array([7]))
    assert "&lt;row&gt;" in svg
    assert "<row>" not in svg
    assert svg.count("m-4-4l8 8m0-8l-8 8") == 1
    assert drawn(Axis("x", np.full(3, np.nan)), Axis("y", np.ones(3)), np.zeros(0, dtype=np.intp)) == ""


def columns(folder: Path, text: str, *files: str) -> Any:
    return records.columns(
        "roller_screw_shift", "inputs.toml", str(folder), text, changes=[], data=files, root=str(folder)
    )


def test_wrong_rows_come_with_the_sentences_of_the_command_line(tmp_path: Path) -> None:
    lines = (SCREW / "measured.csv").read_text(encoding="utf-8").splitlines()
    lines[2] = lines[2].replace("-460", "12rpm")
    lines[4] += ",1"
    (tmp_path / "bad.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    (file,) = columns(tmp_path, INPUTS, "bad.csv")["files"]
    (wrong,) = file["wrong"]
    assert (wrong["line"], wrong["cells"][2], wrong["bad"]) == (3, "12rpm", [2])
    assert "'12rpm' holds more than a number; the unit stands in the header" in wrong["reasons"][0]
    assert [(fault["line"], "this row has 7 cells, expected 6" in fault["message"]) for fault in file["faults"]] == [
        (5, True)
    ]
    assert file["rows"] == 59
    assert columns(tmp_path, INPUTS, "gone.csv")["files"][0]["faults"][0]["message"].startswith("no such file")


def test_a_guess_is_a_guess_until_columns_says_so(tmp_path: Path) -> None:
    text = (SCREW / "measured.csv").read_text(encoding="utf-8")
    (tmp_path / "mine.csv").write_text(text.replace("friction_torque [N*m]", "torque_Nm"), encoding="utf-8")
    (file,) = columns(tmp_path, INPUTS, "mine.csv")["files"]
    column = file["columns"][5]
    assert (column["role"], column["guess"]["name"], column["guess"]["unit"]) == ("other", "friction_torque", "N*m")
    assert "no column is a result" in file["faults"][0]["message"]
    stated = f'{INPUTS}\n[columns]\ntorque_Nm = {{ name = "friction_torque", unit = "N*m" }}\n'
    (file,) = columns(tmp_path, stated, "mine.csv")["files"]
    assert (file["columns"][5]["role"], file["columns"][5]["guess"], file["faults"]) == ("measured", None, [])


def test_a_unit_at_the_end_of_a_foreign_name_says_what_a_column_can_be(tmp_path: Path) -> None:
    _, *rows = (SCREW / "measured.csv").read_text(encoding="utf-8").splitlines()
    (tmp_path / "mine.csv").write_text("\n".join(["Zeit_min,Last_N,Drehzahl_rpm,T,Winkel,Moment_Nmm", *rows]))
    (file,) = columns(tmp_path, INPUTS, "mine.csv")["files"]
    alike = {column["text"]: column["of_this_unit"] for column in file["columns"]}
    assert alike["Last_N"].items() >= {("tangential_force", "N"), ("axial_load", "N")}
    assert "friction_torque" not in alike["Last_N"]
    assert alike["Drehzahl_rpm"] == {"screw_speed": "rpm"}
    assert alike["Moment_Nmm"] == {"friction_torque": "N*mm"}
    assert alike["Zeit_min"] == {"time": "min"}
    assert alike["T"] == alike["Winkel"] == {}


def test_what_competes_and_how_a_restriction_leaves_an_accepted_file(tmp_path: Path) -> None:
    shutil.copytree(SCREW, tmp_path, dirs_exist_ok=True)
    known = diagnoses.candidates("roller_screw_shift", "inputs.toml", str(tmp_path), INPUTS)
    names = [each["name"] for each in known["candidates"]]
    assert {"mesh_friction", "sensor_offset", "unknown"} < set(names)
    assert any(name.startswith("input:") for name in names)
    (tmp_path / "runs").mkdir()
    restricted = INPUTS.replace("[studies.diagnose]", '[studies.diagnose]\ncauses = ["mesh_friction"]')
    (tmp_path / "runs" / "extended.toml").write_text(restricted, encoding="utf-8")
    asked = ("roller_screw_shift", str(tmp_path), "runs", "inputs.toml", "true.toml")
    assert diagnoses.accepted(*asked) == INPUTS
    (tmp_path / "inputs.toml").write_text(restricted, encoding="utf-8")
    assert diagnoses.accepted(*asked) == restricted


# Over the wire


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[TestClient, Path]]:
    folder, key = tmp_path_factory.mktemp("screw"), Key(1)
    (folder / "inputs.toml").write_text(INPUTS, encoding="utf-8")
    workers = Workers(2**32, quick=1)
    with TestClient(application(folder, key, frozenset({"testserver"}), workers)) as client:  # type: ignore[arg-type]
        client.cookies.set(key.cookie, key.token)
        client.headers["sec-fetch-site"] = "same-origin"
        yield client, folder


def test_a_file_never_takes_the_place_of_another_one_unasked(served: tuple[TestClient, Path]) -> None:
    client, folder = served

    def sent(content: bytes, more: str = "") -> Any:
        return client.post(f"/api/upload?name=../a.csv{more}", content=content)

    assert sent(b"a\n1\n").json() == {"file": "data/a.csv"}
    assert sent(b"a\n1\n").status_code == 200
    refused = sent(b"a\n2\n")
    assert (refused.status_code, refused.json()["exists"]) == (409, "a.csv")
    assert (folder / "data" / "a.csv").read_bytes() == b"a\n1\n"
    assert sent(b"a\n2\n", "&replace=yes").status_code == 200
    assert (folder / "data" / "a.csv").read_bytes() == b"a\n2\n"
    assert sent(b"").json()["faults"][0]["message"] == "a.csv is empty"
    assert sorted(path.name for path in folder.rglob("*")) == ["a.csv", "data", "inputs.toml"]


def test_an_upload_is_bounded_whatever_it_says_of_its_size(
    served: tuple[TestClient, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    client, folder = served
    monkeypatch.setattr(bench, "LARGEST_UPLOAD", 1000)
    for content in (b"x" * 1001, iter([b"x" * 600, b"x" * 600])):
        answer = client.post("/api/upload?name=bomb.csv", content=content)
        assert answer.json()["faults"][0]["message"] == "bomb.csv is larger than the 0.001 MB that are taken"
    assert [path for path in folder.rglob("*") if "bomb" in path.name or "upload" in path.name] == []


def test_a_confirmed_column_stands_in_the_text_and_comments_stay(served: tuple[TestClient, Path]) -> None:
    client, folder = served
    text = (SCREW / "measured.csv").read_text(encoding="utf-8")
    (folder / "mine.csv").write_text(text.replace("friction_torque [N*m]", "torque_Nm"), encoding="utf-8")
    asked = {"file": "inputs.toml", "plugin": "roller_screw_shift", "text": INPUTS, "data": ["mine.csv"]}
    change = {"key": "torque_Nm", "name": "friction_torque", "unit": "N*m"}
    answer = client.post("/api/columns", json={**asked, "changes": [change]}).json()
    assert answer["text"].startswith(INPUTS)
    assert 'torque_Nm = { name = "friction_torque", unit = "N*m" }' in answer["text"]
    assert answer["files"][0]["columns"][5]["role"] == "measured"
    again = {**asked, "text": answer["text"], "changes": [{"key": "torque_Nm", "name": None}]}
    assert "torque_Nm" not in client.post("/api/columns", json=again).json()["text"]
    outside = client.post("/api/columns", json={**asked, "data": ["../x.csv"]})
    assert "lies outside the folder" in outside.json()["faults"][0]["message"]


def test_nothing_is_accepted_over_a_file_or_without_a_diagnosis(served: tuple[TestClient, Path]) -> None:
    client, _ = served
    asked = {"plugin": "roller_screw_shift", "file": "inputs.toml", "folder": "runs/none"}
    for target, words in (
        ("inputs.toml", "is there already"),
        ("x.py", "let it end in .toml"),
        ("x.toml", "no extended"),
    ):
        answer = client.post("/api/accept", json={**asked, "target": target})
        assert words in answer.json()["faults"][0]["message"]
