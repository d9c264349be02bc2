"""Run folders: complete or absent, ours or left alone; inputs that give the run again; results that are equal files."""

from __future__ import annotations

import json
import math
import os
import sys
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from truing.calculation import Calculation, calculate
from truing.errors import OutputError, PluginError, UnknownPluginError
from truing.inputs_file import read_setup, setup_from_text
from truing.kernel import Kernel, Offer
from truing.runs.documents import clean, results_document
from truing.runs.folder import (
    demand_place,
    is_ours,
    json_text,
    load_either,
    npz_bytes,
    run_files,
    write_folder,
    write_outcome,
)
from truing.runs.inputs_written import complete_inputs, exact, input_hash
from truing.runs.provenance import provenance_of
from truing.units import read_quantity, to_si

DATA = Path(__file__).parents[1] / "data"


@pytest.fixture(scope="module")
def offer() -> Offer:
    kernel = Kernel(strict=True)
    kernel.add_file(DATA / "hostile_pin.py")
    return kernel.offer("hostile_pin")


@pytest.fixture(scope="module")
def calculation(offer: Offer) -> Calculation:
    return calculate(read_setup(DATA / "hostile_pin.toml", offer))


def write(folder: Path, calculation: Calculation) -> dict[str, Any]:
    provenance = provenance_of(calculation.setup, date="2026-11-21")
    document = results_document(calculation, provenance)
    info = {"date": "2026-11-21T10:00:00+0000", "duration_s": 1.5}
    files = run_files(calculation, document, {"sheet.html": "<p>sheet</p>", "sheet.md": "# sheet\n"})
    write_outcome(folder, "run", calculation.setup, document, provenance=provenance, run_info=info, files=files)
    return document


def leftovers(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_a_run_folder_holds_everything(tmp_path: Path, calculation: Calculation) -> None:
    folder = tmp_path / "runs" / "Größe 1"
    document = write(folder, calculation)
    own = ["arrays.npz", "inputs.toml", "results.csv", "results.json", "run.json", "sheet.html", "sheet.md"]
    assert leftovers(folder) == own
    assert load_either(folder) == document == json.loads((folder / "results.json").read_text(encoding="utf-8"))
    assert json.loads((folder / "run.json").read_text(encoding="utf-8"))["duration_s"] == 1.5
    assert leftovers(tmp_path / "runs") == ["Größe 1"]
    course = document["results"]["course"]  # too large for the document
    assert course == {"value": None, "unit": "um", "array": "course", "shape": [1201]}
    with np.load(folder / "arrays.npz") as arrays:
        assert sorted(arrays) == ["course", "moment"]
        assert arrays["course"] == pytest.approx(np.asarray(calculation.answers["course"]) * 1e6)


def test_results_are_in_printed_units_with_signed_margins(calculation: Calculation) -> None:
    """130 N on 28 mm²: 4.642857 MPa, (80 - 4.642857)/80 of the limit left; 360 km are 60/300 above 300 km."""
    document = results_document(calculation, provenance_of(calculation.setup))
    assert document["schema"] == "truing.results/1"
    assert document["results"]["pressure"] == {"value": pytest.approx(130 / 28, rel=1e-12), "unit": "MPa"}
    margins = {check["name"]: (check["margin"], check["passed"]) for check in document["checks"]}
    assert margins["pressure"] == (pytest.approx((80 - 130 / 28) / 80, rel=1e-12), True)
    assert margins["distance"] == (pytest.approx(0.2, rel=1e-12), True)
    assert margins["depth"][1] is False
    assert document["inputs"]["cover"] == {"value": None, "unit": "mm"}
    assert document["tolerances"]["room"] == {"spread": "off", "on": {}}
    load = document["tolerances"]["load"]["on"]["load"]
    assert load == {"mean": pytest.approx(130), "sd": pytest.approx(3.9, rel=1e-12), "unit": "N"}
    assert document["effects"]["running_in"]["extra"]["sd"] == pytest.approx(0.2, rel=1e-12)
    assert document["conditions"]["frame"] == {"value": pytest.approx(35, abs=1e-9), "unit": "degC"}


def test_equal_runs_are_equal_files(tmp_path: Path, calculation: Calculation) -> None:
    """Packed arrays know neither the time nor the order in which they came."""
    write(tmp_path / "one", calculation)
    write(tmp_path / "two", calculate(calculation.setup))
    for name in ("results.json", "arrays.npz", "inputs.toml"):
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes()
    arrays = {"b": np.arange(3), "a": np.ones((2, 2))}
    assert npz_bytes(arrays) == npz_bytes(dict(reversed(arrays.items())))


@dataclass(frozen=True)
class Left:
    """An outcome that leaves files."""

    files: Mapping[str, Any]

    def as_json(self) -> Mapping[str, Any]:
        return {}


def left_by(calculation: Calculation, files: Mapping[str, Any]) -> Calculation:
    """The calculation with a study that leaves these files."""
    return replace(calculation, outcomes={"made": Left(files)})


def test_a_study_leaves_files_beside_the_sheet(tmp_path: Path, calculation: Calculation) -> None:
    write(tmp_path / "one", left_by(calculation, {"flank.csv": "1,2\n", "map.bin": b"\x00"}))
    assert (tmp_path / "one" / "flank.csv").read_text() == "1,2\n"
    assert (tmp_path / "one" / "map.bin").read_bytes() == b"\x00"


@pytest.mark.parametrize(
    ("files", "sentence"),
    [
        *(({name: ""}, "plain file name") for name in ("../flank.csv", "", "flank.")),
        *(({name: ""}, "has already") for name in ("RESULTS.json", "sheet.pdf")),
        ({"a.csv": "", "A.csv": ""}, "has already"),
        ({"flank.csv": 1.0}, "text or bytes"),
    ],
)
def test_a_file_that_cannot_be_left_is_the_fault_of_the_study(
    tmp_path: Path, calculation: Calculation, files: Mapping[str, Any], sentence: str
) -> None:
    with pytest.raises(PluginError, match=f"study 'made' .*{sentence}"):
        write(tmp_path / "one", left_by(calculation, files))
    assert leftovers(tmp_path) == []


def test_what_studies_say_is_made_plain_and_holds_no_token_that_is_no_json() -> None:
    said = {"a": np.float64(1.5), "b": (np.nan, np.inf, 2), "c": np.array([[1, 2]]), 3: np.bool_(True), "d": {"y", "x"}}
    assert clean(said) == {"a": 1.5, "b": [None, None, 2], "c": [[1, 2]], "3": True, "d": ["x", "y"]}
    with pytest.raises(ValueError, match="not JSON compliant"):
        json_text({"value": math.nan})


def test_complete_inputs_give_the_run_again(tmp_path: Path, calculation: Calculation, offer: Offer) -> None:
    folder = tmp_path / "run"
    document = write(folder, calculation)
    again = calculate(read_setup(folder / "inputs.toml", offer))
    assert results_document(again, provenance_of(again.setup)) == document
    written = [complete_inputs(setup, folder).splitlines()[:9] for setup in (again.setup, calculation.setup)]
    assert written[0] == written[1]


def test_the_hash_follows_what_decides_the_results_and_nothing_else(offer: Offer) -> None:
    def hash_of(text: str) -> str:
        return input_hash(setup_from_text(text, offer, file="x", folder=Path()))

    plain = hash_of("")
    assert hash_of('[sheet]\nproject = "P"\ndetail = "full"') == plain
    assert hash_of('[inputs]\nload = "0.12 kN"') == plain
    others = ['[inputs]\nload = "121 N"', '[tolerances]\nload = "off"', '[units]\ndepth = "mm"', "[studies]\nseed = 7"]
    assert len({plain, *map(hash_of, others)}) == 5


@settings(deadline=None)  # the first reading of a unit is slow
@given(st.floats(-1e12, 1e12, allow_nan=False), st.sampled_from(["mm", "deg", "um", "MPa", "h", "kW", "l/min"]))
def test_an_input_is_written_so_that_it_reads_the_same(value: float, unit: str) -> None:
    """Exactly, for every number that a text in this unit can give at all."""
    si = to_si(value, unit)
    if abs(value) < 1e-200:
        return
    assert read_quantity(exact(si, unit), unit) == si


def test_an_input_is_written_as_briefly_as_it_was_stated() -> None:
    for text, unit in (("0.05", "mm"), ("0.001324", "deg"), ("12.5", "um"), ("0.1", "kN")):
        assert exact(read_quantity(f"{text} {unit}", unit), unit) == f"{text} {unit}"


def test_a_tolerance_that_follows_a_choice_is_left_to_follow_it() -> None:
    press = Kernel.installed().offer("press_linkage")
    setup = setup_from_text('[inputs]\nreading = "printed"', press, file="x", folder=Path())
    text = complete_inputs(setup)
    again = setup_from_text(text.replace('"printed"', '"complete"'), press, file="y", folder=Path())
    wanted = setup_from_text('[inputs]\nreading = "complete"', press, file="z", folder=Path())
    assert again.distributions() == wanted.distributions() != setup.distributions()


@pytest.mark.skipif(os.name == "nt", reason="permissions are another matter on Windows")
def test_an_earlier_run_is_replaced_whole_and_as_readable_as_its_neighbours(
    tmp_path: Path, calculation: Calculation
) -> None:
    folder = tmp_path / "run"
    write(folder, calculation)
    (folder / "notes.txt").write_text("left by the earlier run")
    write(folder, calculation)
    assert "notes.txt" not in leftovers(folder)
    assert leftovers(tmp_path) == ["run"]
    (tmp_path / "plain").mkdir()
    assert folder.stat().st_mode == (tmp_path / "plain").stat().st_mode


@pytest.mark.parametrize(
    "content",
    [
        {},
        {"thesis.txt": "years of work"},
        {"results.json": "{}", "run.json": "{}"},
        {"results.json": '{"schema": "truing.results/1"}'},
        {"results.json": "no json", "run.json": "{}"},
        {"results.json": "[1]", "run.json": "{}"},
    ],
)
def test_a_folder_that_is_no_run_of_ours_is_left_alone(tmp_path: Path, content: dict[str, str]) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    for name, text in content.items():
        (folder / name).write_text(text)
    assert not is_ours(folder, "run")
    with pytest.raises(OutputError, match="so it is left alone"):
        write_folder(folder, {"results.json": "x"})
    assert {path.name: path.read_text() for path in folder.iterdir()} == content
    assert leftovers(tmp_path) == ["folder"]


def test_a_place_that_is_none_is_refused_in_one_sentence_and_one_that_is_free_not_touched(tmp_path: Path) -> None:
    demand_place(tmp_path / "runs" / "one")
    assert leftovers(tmp_path) == []
    (tmp_path / "file").write_text("x")
    refused = {
        "file/runs/one": "file is a file, so there can be no folder below it; name another place",
        "file": "is a file; a run is a folder, name another place",
    }
    if sys.platform != "win32":  # links need a privilege there
        (tmp_path / "link").symlink_to(tmp_path / "nowhere")
        refused["link"] = "link: is a link that leads nowhere; name another place or remove this one"
    for place, sentence in refused.items():
        with pytest.raises(OutputError, match=f"{sentence}$"):
            demand_place(tmp_path / place)


def test_what_is_no_run_is_not_loaded(tmp_path: Path) -> None:
    with pytest.raises(UnknownPluginError, match=r"holds no results\.json"):
        load_either(tmp_path)
    for content, sentence in (("{", "cannot be read"), ('{"schema": "other/1"}', "is no truing.results/1 document")):
        (tmp_path / "results.json").write_text(content)
        with pytest.raises(UnknownPluginError, match=sentence):
            load_either(tmp_path)


def test_what_guests_added_is_listed(calculation: Calculation) -> None:
    provenance = replace(provenance_of(calculation.setup), added=[("hot_oil", "guest", "0.2")])
    added = results_document(calculation, provenance)["added"]
    assert added == [{"what": "hot_oil", "plugin": "guest", "version": "0.2"}]


def test_data_files_are_named_as_seen_from_the_run_folder(tmp_path: Path) -> None:
    """With --set, too: what was read last is what the inputs of the run name."""
    kernel = Kernel(strict=True)
    kernel.add_file(DATA / "worn_surface.py")
    offer = kernel.offer("worn_surface")
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "flank.txt").write_text("1\n2\n3")
    (tmp_path / "data" / "other.txt").write_text("4\n5\n9")
    (tmp_path / "logo.svg").write_text("<svg/>")
    inputs = '[sheet]\nlogo = "logo.svg"\n[inputs]\nsurface = { file = "data/flank.txt", factor = 2.0 }\n'
    (tmp_path / "in.toml").write_text(inputs)
    stated = '{ file = "data/other.txt", factor = 3.0 }'
    for overrides, depths in (([], [2, 4, 6]), ([f"surface={stated}"], [12, 15, 27])):
        calculation = calculate(read_setup(tmp_path / "in.toml", offer, overrides=overrides))
        document = write(tmp_path / "runs" / "one", calculation)
        assert document["results"]["share"]["value"] == pytest.approx(3 / np.std(depths), rel=1e-12)
        again = read_setup(tmp_path / "runs" / "one" / "inputs.toml", offer)
        assert calculate(again).answers["share"] == calculation.answers["share"]
        assert input_hash(again) == document["input_hash"]
        assert (Path(again.source.file).parent / again.sheet.head["logo"]).read_text() == "<svg/>"
