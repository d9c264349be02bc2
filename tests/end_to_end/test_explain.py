"""calc explain: what a name of a calculation is, what it is made from, and what moves it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from shared import Calc

PIN = Path(__file__).parents[1] / "data" / "pin_wear.py"
LOAD_SHARE = 0.03**2 / (0.03**2 + 0.06**2)
"""Of a product of powers, the variance is the sum of squared relative standard deviations: 3 % and 6 %."""


def told(calc: Calc, *words: str) -> dict[str, Any]:
    """The explanation as data."""
    answer = calc("explain", PIN, *words, "--json", "-q")
    assert (answer.code, answer.err) == (0, "")
    found: dict[str, Any] = json.loads(answer.out)
    return found


def shown(calc: Calc, *words: str) -> list[str]:
    """The lines on the terminal, spaces aside; none wider than eighty columns."""
    answer = calc("explain", *words, "-q")
    assert (answer.code, answer.err) == (0, "")
    assert max(map(len, answer.out.split("\n"))) <= 80
    return [" ".join(line.split()) for line in answer.out.split("\n")]


def test_what_scatters_is_ranked_by_its_share(calc: Calc) -> None:
    scatter = told(calc, "depth")["scatter"]
    assert [item["name"] for item in scatter["shares"]] == ["hardness", "load"]
    assert scatter["shares"][1]["share"] == pytest.approx(LOAD_SHARE, rel=1e-3)
    assert scatter["shares"][1]["spread"] == "sd 3 %"
    lines = shown(calc, str(PIN), "depth")
    assert "hardness 80 % lognormal sd 6 %" in lines


def test_inputs_are_ranked_by_what_one_per_cent_does(calc: Calc) -> None:
    slopes = {item["name"]: item["percent"] for item in told(calc, "depth")["slopes"]}
    powers = {"load": 1, "area": -1, "speed": 1, "time": 1, "rate": 1, "hardness": -1}
    assert slopes == pytest.approx(powers, rel=1e-6)


def test_a_result_of_a_study_is_calculated_by_it(calc: Calc) -> None:
    share = told(calc, "safe_share")
    assert (share["study"], share["unit"], share["slopes"]) == ("reliability", "%", [])
    assert 99 < share["value"] <= 100


def test_an_input_says_what_depends_on_it(calc: Calc) -> None:
    load = told(calc, "load")
    assert (load["followed_by"], load["then"]) == (["pressure"], ["depth"])
    moves = {row["name"]: (row["percent"], row["share"]) for row in load["moves"]}
    assert moves["pressure"] == pytest.approx((1.0, 1.0), rel=1e-6)
    assert moves["depth"] == pytest.approx((1.0, LOAD_SHARE), rel=1e-3)
    assert "distance" not in moves
    assert load["limits"] == ["pressure at most 80 MPa, with reliability 0.99"]
    assert told(calc, "speed")["limits"] == []
    lines = shown(calc, str(PIN), "load")
    assert "stated by the inputs file; above 0 N" in lines
    assert "may be chosen from 50 N to 200 N" in lines


def test_values_are_those_of_the_inputs_file_and_the_line(calc: Calc, tmp_path: Path) -> None:
    (tmp_path / "pin.toml").write_text('[inputs]\nload = "240 N"\n[units]\npressure = "bar"\n', encoding="utf-8")
    assert told(calc, "pressure", "--inputs", "pin.toml")["value"] == pytest.approx(240 / 28 * 10)
    assert told(calc, "pressure", "--inputs", "pin.toml", "--set", "area=1 cm2")["value"] == pytest.approx(24.0)


def test_an_effect_is_tried_beside_the_model_without(calc: Calc) -> None:
    probe = told(calc, "warm_probe", "--set", "probe_temperature=35 degC")
    assert [row["name"] for row in probe["moves"]] == ["depth"]
    depth = told(calc, "depth")["value"]
    assert probe["moves"][0]["percent"] == pytest.approx(100 * 1.0 * 15 / depth, rel=1e-6)
    (running,) = told(calc, "running_in", "--set", "time=200 s")["inputs"]  # 100 m; the length is 10 m to 5 km
    assert running["name"] == "early_depth"
    assert float(running["after"].split()[0]) == pytest.approx(25 * -np.expm1(-100 / np.sqrt(10 * 5e3)), rel=1e-6)
    lines = shown(calc, str(PIN), "warm_probe")
    assert "slope -2 .. 2 µm/K" in lines
    assert "probe_temperature reference 20 °C" in lines


def test_an_effect_that_is_on_is_tried_as_it_is(calc: Calc, tmp_path: Path) -> None:
    (tmp_path / "pin.toml").write_text('[effects.running_in]\nextra = "2 um"\nlength = "10 m"\n', encoding="utf-8")
    effect = told(calc, "running_in", "--inputs", "pin.toml")
    assert effect["on"]
    assert effect["inputs"] == [{"name": "early_depth", "before": "0 µm", "after": "2 µm"}]


@pytest.mark.parametrize(
    ("words", "kind"),
    [
        ("hardness", "input"), ("tolerances.hardness", "tolerance"), ("inputs.load", "input"), ("reliability", "study"),
        ("probe_temperature", "condition"), ("effects.sensor_offset", "effect"), ("tolerance_price", "result"),
    ],
)  # fmt: skip
def test_every_kind_of_name_is_explained(calc: Calc, words: str, kind: str) -> None:
    lines = shown(calc, str(PIN), words)
    assert lines[0].split()[0] == words.rpartition(".")[2]
    assert lines[1] == f"a{'n' * (kind[0] in 'ei')} {kind} of pin_wear (Sliding wear of a pin)"


def test_a_name_behind_a_plugin_and_what_it_publishes(calc: Calc) -> None:
    lines = shown(calc, "press_linkage.salience_position_key")
    assert lines[0].startswith("salience_position_key")
    assert any("0.8766, ours 0.87707: matches (section 2.2.1" in line for line in lines)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ([PIN], f"explain what of {PIN}? Write its name behind it: calc explain {PIN} RESULT"),
        ([PIN, "presure"], "pin_wear has no result, input, effect or tolerance 'presure'. Did you mean 'pressure' "
         "(result, contact pressure)?"),
        ([PIN, "Pressure"], "pin_wear has no result, input, effect or tolerance 'Pressure'. Did you mean 'pressure' "
         "(result, contact pressure)?"),
        ([PIN, "zzz"], "pin_wear has no result, input, effect or tolerance 'zzz'. `calc describe pin_wear` lists what "
         "there is."),
        ([PIN, "effects.hardness"], "pin_wear has no effect 'hardness'. `calc describe pin_wear` lists what there is."),
        (["press_linkage"], "explain what of press_linkage? Name it, as in calc explain press_linkage.face_height_1; "
         "calc describe press_linkage lists all"),
    ],
)  # fmt: skip
def test_what_is_not_there_is_said_in_one_sentence(calc: Calc, words: list[Any], sentence: str) -> None:
    answer = calc("explain", *words)
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.endswith(f"calc: {sentence}\n")


def test_an_impossible_input_ends_with_its_sentence(calc: Calc) -> None:
    answer = calc("explain", PIN, "depth", "--set", "load=100 kN", "-q")
    assert (answer.code, answer.out) == (2, "")
    assert "the contact flows: load exceeds hardness times area" in answer.err
    assert answer.err.count("\n") == 1
