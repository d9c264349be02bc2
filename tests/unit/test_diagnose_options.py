"""What is asked of a diagnosis in the inputs file: read, refused, written back, offered by the schema."""

from __future__ import annotations

import math
from pathlib import Path

import jsonschema
import pytest
from pin_wear import PIN_WEAR

from truing.errors import InputError
from truing.inputs_file import json_schema, setup_from_text
from truing.kernel import Offer, Origin
from truing.runs.inputs_written import complete_inputs
from truing.setup import DiagnoseOptions, Setup

OFFER = Offer("pin_wear", PIN_WEAR, Origin("pin_wear", "", "", "", "module:pin_wear"))
TEXT = """[studies.diagnose]
per_file = ["sensor_offset", "running_in.extra", "load"]
hold_out = "record = validation"
box = { probe_temperature = "15..40 degC", load = "0.05..0.2 kN", rate = "1e-8..5e-8", speed = "10 mm/s..2 m/s" }
budget = 1500
at_least = { depth = "outcome = runout" }
at_most = { distance = "flag = 0" }
clipped = { depth = "..1 mm", pressure = "0..80 MPa", distance = "1 km.." }
lognormal = ["depth"]
"""


def setup_of(text: str, *overrides: str) -> Setup:
    return setup_from_text(text, OFFER, file="given.toml", folder=Path(), overrides=overrides)


def test_the_options_in_si() -> None:
    options = setup_of(TEXT).diagnose
    assert options.per_file == ("sensor_offset", "running_in.extra", "load")
    assert options.held_out == ("record", "validation")
    assert set(options.box) == {"probe_temperature", "load", "rate", "speed"}
    assert options.box["probe_temperature"] == pytest.approx((288.15, 313.15))
    assert options.box["load"] == pytest.approx((50, 200))
    assert options.box["rate"] == pytest.approx((1e-8, 5e-8))
    assert options.box["speed"] == pytest.approx((0.01, 2))
    assert options.budget == 1500
    assert (options.at_least, options.at_most) == ({"depth": "outcome = runout"}, {"distance": "flag = 0"})
    assert options.flags == {"outcome", "flag"}
    assert options.clipped == {"depth": (-math.inf, 1e-3), "pressure": (0, 80e6), "distance": (1e3, math.inf)}
    assert options.lognormal == ("depth",)


def test_nothing_is_asked_by_default() -> None:
    assert setup_of("").diagnose == DiagnoseOptions()
    assert DiagnoseOptions().held_out == ("", "")
    assert "[studies.diagnose]" not in complete_inputs(setup_of(""))


def test_they_are_written_back_as_they_are() -> None:
    options = setup_of(TEXT).diagnose
    again = setup_of(complete_inputs(setup_of(TEXT)))
    assert again.diagnose == options


def test_conditions_of_the_kernel_have_a_range_too() -> None:
    text = '[studies.diagnose]\nbox = { angle = "-90..90 deg" }\n'
    options = setup_of(text).diagnose
    assert options.box["angle"] == pytest.approx((-math.pi / 2, math.pi / 2))
    assert setup_of(complete_inputs(setup_of(text))).diagnose == options


def test_they_can_be_set_on_the_command_line() -> None:
    setup = setup_of("", 'studies.diagnose.per_file=["load"]', "studies.diagnose.hold_out=run = b")
    assert setup.diagnose == DiagnoseOptions(per_file=("load",), hold_out="run = b")


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("per_fil = []", "study 'diagnose' has no option 'per_fil'. Did you mean 'per_file'?"),
        ('per_file = "load"', "study 'diagnose': per_file = 'load' is no list of names"),
        ('per_file = ["runing_in"]', "per_file names 'runing_in', which is no effect, unknown or number"),
        ('per_file = ["runing_in"]', "Did you mean 'running_in'?"),
        ('per_file = ["running_in.extras"]', "Did you mean 'running_in.extra'?"),
        ('per_file = ["load", "load"]', "per_file names 'load' twice"),
        ("hold_out = 3", "hold_out = 3 is no text"),
        ('hold_out = "validation"', "hold_out = 'validation' names no rows; write a column and the word"),
        ('hold_out = "= validation"', "names no rows"),
        ("box = 3", "box = 3 is no table"),
        ("budget = -1", "budget = -1 is no number of calls; write budget = 1000"),
        ('budget = "10 min"', "budget = '10 min' is no number of calls"),
        ("budget = 1e3", "budget = 1000.0 is no number of calls"),
        ("budget = true", "is no number of calls"),
        ('box = { lod = "1..2 N" }', "box names 'lod', which is no condition and no number"),
        ('box = { depth = "1..2 um" }', "box names 'depth', which is no condition and no number"),
        ('box = { load = "1 N" }', "box: load = '1 N' is no range; write load = \"0..10 N\""),
        ("box = { load = 5 }", "box: load = 5 is no range"),
        ('box = { load = "1..2 mm" }', "expected a force"),
        ('box = { load = "1..2" }', "load: '1' has no unit"),
        ('box = { load = "a..2 N" }', "box: "),
        ('box = { load = "2..1 N" }', "goes from its higher end; lower first"),
        ('box = { load = "-5..1 N" }', "load is -5 N; it must be above 0 N"),
        ("clipped = 3", 'clipped = 3 is no table; write clipped = { RESULT = "0..10 kN" }'),
        ('clipped = { dept = "0..5 um" }', "clipped names 'dept', which is no result of pin_wear"),
        ('clipped = { dept = "0..5 um" }', "Did you mean 'depth'?"),
        ('clipped = { load = "0..5 N" }', "clipped names 'load', which is no result"),
        ('clipped = { depth = "0..5" }', "depth: '0' has no unit"),
        ('clipped = { depth = "..5" }', "depth: '5' has no unit"),
        ('clipped = { depth = ".." }', "clipped: depth = '..' is no range; write depth = \"0..10 um\""),
        ('clipped = { depth = "5 um" }', "is no range"),
        ('clipped = { depth = "5..1 um" }', "goes from its higher end; lower first"),
        ('clipped = { depth = "..5 N" }', "expected a length"),
        ('at_least = "outcome = runout"', "at_least = 'outcome = runout' is no table; write at_least = { RESULT ="),
        ('at_least = { depth = "runout" }', "at_least: depth = 'runout' marks no rows; write a column and the word"),
        ("at_most = { depth = true }", "at_most: depth = true marks no rows"),
        ('at_most = { life = "outcome = runout" }', "at_most names 'life', which is no result of pin_wear"),
        ('lognormal = "depth"', "lognormal = 'depth' is no list of results"),
        ('lognormal = ["load"]', "lognormal names 'load', which is no result"),
    ],
)
def test_what_cannot_be_asked(line: str, expected: str) -> None:
    with pytest.raises(InputError) as caught:
        setup_of(f"[studies.diagnose]\n{line}\n")
    (fault,) = caught.value.faults
    assert expected in fault.message
    assert fault.line == 2


def test_all_faults_are_said_at_once() -> None:
    with pytest.raises(InputError) as caught:
        setup_of("[studies.diagnose]\nper_file = 1\nhold_out = 2\nbox = 3\nmore = 4\n[inputs]\nload = 5\n")
    assert [fault.line for fault in caught.value.faults] == [2, 3, 4, 5, 7]


def test_a_misspelt_section() -> None:
    with pytest.raises(InputError, match=r"no study 'diagnos'\. Did you mean 'diagnose'\?"):
        setup_of("[studies.diagnos]\n")


@pytest.mark.parametrize(
    ("asked", "fits"),
    [
        ({"per_file": ["load"], "hold_out": "a = b", "box": {"load": "1..2 N"}}, True),
        ({}, True),
        ({"per_file": "load"}, False),
        ({"box": {"lod": "1..2 N"}}, False),
        ({"budget": 1000}, True),
        ({"budget": "10 min"}, False),
        ({"at_least": {"depth": "a = b"}, "clipped": {"depth": "..1 um"}, "lognormal": ["depth"]}, True),
        ({"at_most": {"load": "a = b"}}, False),
        ({"lognormal": ["load"]}, False),
        ({"more": 1}, False),
    ],
)
def test_the_schema_offers_them(asked: dict[str, object], fits: bool) -> None:
    validator = jsonschema.Draft202012Validator(json_schema(OFFER))
    assert validator.is_valid({"studies": {"diagnose": asked}}) is fits
