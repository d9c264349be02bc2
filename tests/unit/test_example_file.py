"""The commented inputs file that a newcomer starts from."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest
from sample_models import PIN_OFFER, PIN_WEAR, RENAMED, STAGE_OFFER

from truing.declare.spreads import Band
from truing.errors import PluginError
from truing.example_file import example_text
from truing.inputs_file import setup_from_text
from truing.setup import InputsSource, default_setup

COMMENTED_OUT = re.compile(r"^# (?=\[|[\w\"]+ = )", re.MULTILINE)


def test_the_example_is_the_default_setup() -> None:
    setup = setup_from_text(example_text(PIN_OFFER), PIN_OFFER, file="", folder=Path())
    assert setup.source.stated == set(PIN_WEAR.input_fields)
    assert replace(setup, source=InputsSource()) == default_setup(PIN_WEAR, PIN_OFFER.origin)


def test_what_is_commented_out_states_the_defaults_too() -> None:
    text = COMMENTED_OUT.sub("", example_text(PIN_OFFER))
    setup = setup_from_text(text, PIN_OFFER, file="", folder=Path())
    assert [on.effect.name for on in setup.effects] == ["running_in", "warm_probe"]
    assert setup.units == {"pressure": "MPa", "distance": "km", "depth": "um"}
    plain = replace(setup, source=InputsSource(), effects=(), units={})
    assert plain == default_setup(PIN_WEAR, PIN_OFFER.origin)


def test_an_example_with_a_data_file_runs_once_the_file_is_named(tmp_path: Path) -> None:
    text = example_text(STAGE_OFFER)
    (tmp_path / "surface.txt").write_text("1\n")
    named = text.replace('"surface.txt" }', '"surface.txt", spacing = "1 um" }')
    setup = setup_from_text(named, STAGE_OFFER, file="", folder=tmp_path)
    assert setup.inputs.surface.heights == (1.0,)
    assert (setup.inputs.planet.teeth, setup.inputs.planets, setup.inputs.reading) == (31, 3, "complete")
    assert setup.inputs.orders == (1, 2)
    assert 'oil = "±5 K"' in text
    assert '"printed" or "complete"' in text
    assert "# face_factor = " in text
    everything = setup_from_text(COMMENTED_OUT.sub("", named), STAGE_OFFER, file="", folder=tmp_path)
    assert everything.spreads["oil"] == Band("5 K", "±")


def test_no_line_is_too_long_to_read() -> None:
    assert max(len(line) for line in example_text(STAGE_OFFER).splitlines()) <= 100


def test_old_names_are_not_offered() -> None:
    assert not any(old in example_text(PIN_OFFER) for old in RENAMED)


def test_a_shipped_example_is_handed_out_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "example.toml"
    path.write_bytes("# Ölprüfstand\n[inputs]\n".encode())
    offer = replace(PIN_OFFER, model=replace(PIN_WEAR, example=path))
    assert example_text(offer) == "# Ölprüfstand\n[inputs]\n"
    path.unlink()
    with pytest.raises(PluginError, match="the example of 'pin_wear' cannot be read"):
        example_text(offer)
