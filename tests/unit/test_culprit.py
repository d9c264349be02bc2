"""Which line is blamed when what is stated describes something impossible."""

from __future__ import annotations

from pathlib import Path

import pytest
from pin_wear import PIN_WEAR

from truing.errors import InfeasibleError, InputError
from truing.inputs_file import setup_from_text
from truing.inputs_file.sentences import located, told_by_line
from truing.kernel import Offer, Origin
from truing.setup import default_setup

OFFER = Offer("pin_wear", PIN_WEAR, Origin("pin_wear", "", "", "", "module:pin_wear"))
SENTENCE = "the contact flows: load exceeds hardness times area"


def blamed(text: str, *overrides: str, sentence: str = SENTENCE) -> str:
    """Return what is said of a file in which something impossible stands."""
    setup = setup_from_text(text, OFFER, file="wear.toml", folder=Path(), overrides=overrides)
    said = str(located(setup, sentence))
    assert said.endswith(f": {sentence}")
    return said.removesuffix(f": {sentence}")


@pytest.mark.parametrize(
    ("text", "overrides", "place"),
    [
        ('[inputs]\nload = "500 kN"\nspeed = "1 m/s"\n', (), "wear.toml:2"),  # the sentence names it
        ('[inputs]\nspeed = "1 m/s"\nload = "120 N"\n', (), "wear.toml:2"),  # the load is as it always is
        ('[inputs]\nload = "120 N"\nspeed = "0.5 m/s"\n', (), "wear.toml:2"),  # all as always: what is named
        ('[inputs]\nload = "500 kN"\narea = "1 mm^2"\n', (), "wear.toml:3"),  # both: what came last
        ('[inputs]\nload = "500 kN"\n', ("area=1 mm^2",), "--set area=1 mm^2"),
        ('[inputs]\nload = "500 kN"\n', ("speed=1 m/s",), "wear.toml:2"),
        ('[inputs]\n[effects.running_in]\nextra = "1 um"\nlength = "10 m"\n', (), "wear.toml:2"),
        ('plugin = "pin_wear"\n\n[conditions]\nprobe_temperature = "400 degC"\n', (), "wear.toml:4"),
        ('plugin = "pin_wear"\n\n[inputs]\n', (), "wear.toml:3"),
        ("# nothing\n", (), "wear.toml:1"),
    ],
)
def test_the_likeliest_line_is_blamed(text: str, overrides: tuple[str, ...], place: str) -> None:
    assert blamed(text, *overrides) == place


def test_without_a_file_there_is_no_place() -> None:
    assert str(located(default_setup(PIN_WEAR), SENTENCE)) == SENTENCE


def test_only_what_is_impossible_is_told_by_line() -> None:
    setup = setup_from_text('[inputs]\nload = "500 kN"\n', OFFER, file="wear.toml", folder=Path())
    with pytest.raises(InputError, match=r"^wear\.toml:2: the contact flows"), told_by_line(setup):
        raise InfeasibleError(SENTENCE)
    with pytest.raises(ZeroDivisionError), told_by_line(setup):
        _ = 1 / 0
