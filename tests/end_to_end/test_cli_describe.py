"""calc plugins, describe and init: what there is, what it takes, and a file to begin with."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import pin_wear
import pytest
from jsonschema import Draft202012Validator

from shared import Calc
from truing import Kernel
from truing.example_file import example_text
from truing.inputs_file import json_schema

PIN = Path(__file__).parents[1] / "data" / "pin_wear.py"
INSTALLED = ["harmonic_fractal", "press_linkage", "roller_screw_shift", "rv_gearing", "rv_wear"]
MODELS = [
    "harmonic_fractal",
    "harmonic_fractal.made_flank",
    "harmonic_fractal.run_up",
    "harmonic_fractal.vibration",
    *sorted([*INSTALLED[1:], "press_linkage.loaded", "press_linkage.motion"]),
]


def test_plugins_as_json(calc: Calc) -> None:
    found = json.loads(calc("plugins", "--json").out)
    assert found["broken"] == []
    assert [model["name"] for model in found["models"]] == MODELS
    for model in found["models"]:
        assert model["plugin"] == model["name"].partition(".")[0]
        assert model["distribution"] == "truing"
        assert Path(model["file"]).is_file()


def test_describe_names_what_the_page_has_none_of(calc: Calc) -> None:
    answer = calc("describe", PIN)
    assert (answer.code, answer.err) == (0, "")
    said = " ".join(answer.out.split())
    assert "rate k 3e-08 - wear coefficient; test 14" in said
    assert "warm_probe on reading slope -2..2 µm/K needs probe_temperature" in said
    assert "vary load 50 N .. 200 N" in said


def test_describe_as_json(calc: Calc) -> None:
    found = json.loads(calc("describe", "press_linkage", "--json").out)
    inputs = {item["name"]: item for item in found["inputs"]}
    assert len([name for name in inputs if "_deviation" in name]) == 29
    assert (inputs["crank_radius"]["default"], inputs["crank_radius"]["unit"]) == (0.36, "m")
    assert (inputs["reading"]["default"], inputs["reading"]["choices"]) == ("complete", ["complete", "printed"])
    assert "link_heating" in {item["name"] for item in found["effects"]}
    assert set(found["studies"]) >= {"sweep", "sensitivity", "reliability", "allocation"}
    assert {"slider_position", "bdc_position", "adjustments"} <= {item["name"] for item in found["results"]}


def test_describe_names_what_the_reader_of_a_file_takes(calc: Calc) -> None:
    (line,) = (text for text in calc("describe", "harmonic_fractal").out.split("\n") if text.startswith("  surface "))
    assert " a file " in line
    assert "options: spacing, spacing_x, spacing_y, height_unit, " in line
    inputs = {item["name"]: item for item in json.loads(calc("describe", "harmonic_fractal", "--json").out)["inputs"]}
    assert {"rectangle", "noise_aware", "direction", "sliding"} <= set(inputs["mating_surface"]["options"])
    assert inputs["torque"]["options"] == []


def test_init_writes_once(calc: Calc, tmp_path: Path) -> None:
    answer = calc("init", "press_linkage", "-o", "press.toml")
    assert (answer.code, answer.out) == (0, "")
    assert answer.err == (
        "wrote press.toml and press_linkage.schema.json; now: calc run press_linkage --inputs press.toml\n"
    )
    written = (tmp_path / "press.toml").read_text(encoding="utf-8")
    assert tomllib.loads(written)["inputs"]["reading"] == "printed"
    assert any(line.startswith("#") and '"printed" repeats the paper' in line for line in written.split("\n"))
    (tmp_path / "press.toml").write_text("mine")
    answer = calc("init", "press_linkage", "-o", "press.toml")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err == "calc: press.toml exists already; choose another name or say --force\n"
    assert (tmp_path / "press.toml").read_text() == "mine"
    answer = calc("init", "press_linkage", "-o", "press.toml", "--force", "-q")
    assert (answer.code, answer.out, answer.err) == (0, "", "")
    assert (tmp_path / "press.toml").read_text(encoding="utf-8") == written
    assert sorted(path.name for path in tmp_path.iterdir()) == ["press.toml", "press_linkage.schema.json"]


@pytest.mark.parametrize("word", ["press_linkage", "harmonic_fractal.made_flank", str(PIN)])
def test_the_file_names_the_schema_beside_it(calc: Calc, tmp_path: Path, word: str) -> None:
    assert calc("init", word, "-o", "own.toml", "-q").code == 0
    text = (tmp_path / "own.toml").read_text(encoding="utf-8")
    mark, name = text.split("\n")[0].split(" ")
    assert (mark, name) == ("#:schema", f"./{'pin_wear' if word == str(PIN) else word}.schema.json")
    schema = json.loads((tmp_path / name).read_text(encoding="utf-8"))
    assert schema == json.loads(calc("describe", word, "--json-schema").out)
    assert text.split("\n", 1)[1] == calc("init", word).out
    Draft202012Validator.check_schema(schema)


def test_the_schema_judges_every_example_as_an_editor_does() -> None:
    offers = [*Kernel.installed().offers.values(), Kernel([pin_wear]).offer("pin_wear")]
    assert len(offers) > 6
    for offer in offers:
        judge, document = Draft202012Validator(json_schema(offer)), tomllib.loads(example_text(offer))
        assert list(judge.iter_errors(document)) == []
        wrong = {**document, "inputs": {**document.get("inputs", {}), "lod": "3 N"}}
        assert [error.validator for error in judge.iter_errors(wrong)] == ["additionalProperties"]
        assert [*judge.iter_errors({"shet": {}})]


def test_a_schema_is_replaced_only_when_told_to(calc: Calc, tmp_path: Path) -> None:
    assert calc("init", PIN, "-o", "one.toml").code == 0
    schema = tmp_path / "pin_wear.schema.json"
    right = schema.read_bytes()
    assert calc("init", PIN, "-o", "two.toml").code == 0  # it is the same one
    schema.write_text("{}")
    answer = calc("init", PIN, "-o", "three.toml")
    sentence = "exists already and is another schema; say --force to replace it, or --no-schema"
    assert (answer.code, answer.err) == (2, f"calc: pin_wear.schema.json {sentence}\n")
    assert calc("init", PIN, "-o", "three.toml", "--no-schema").code == 0
    assert not (tmp_path / "three.toml").read_text(encoding="utf-8").startswith("#:schema")
    assert schema.read_text() == "{}"
    assert calc("init", PIN, "-o", "three.toml", "--force").code == 0
    assert schema.read_bytes() == right
    assert {path.name for path in tmp_path.iterdir()} == {schema.name, "one.toml", "two.toml", "three.toml"}


def test_what_init_writes_runs(calc: Calc, tmp_path: Path) -> None:
    calc("init", PIN, "-o", "new/wear.toml")
    answer = calc("run", PIN, "--inputs", "new/wear.toml", "-q")
    assert answer.code == 0, answer.err


def test_a_long_series_is_shown_by_its_ends_and_one_that_is_not_given_as_optional(calc: Calc) -> None:
    lines = calc("describe", "press_linkage.motion").out.splitlines()
    said = {words[0]: line for line in lines if (words := line.split())}
    assert "0.0 .. 5.0, 121 values" in said["times"]
    assert " optional " in said["crank_speed"]
