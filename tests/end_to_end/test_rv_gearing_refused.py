"""The gearing refuses what cannot be, by name, file and line, with nothing written; an empty list is no fault."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from shared import Calc

Refused = Callable[[str], list[str]]
POSITIVE = {"power": "kW", "output_speed": "r/min", "module": "mm", "face_width": "mm", "viscosity": "mm**2/s"}


@pytest.fixture
def refused(calc: Calc, tmp_path: Path) -> Refused:
    """Run the gearing with lines under [inputs]; it must end with exit code 2 and leave nothing behind."""

    def run(lines: str) -> list[str]:
        text = f'plugin = "rv_gearing"\n[inputs]\n{lines}\n[studies]\nrun = []\n'
        (tmp_path / "gearing.toml").write_text(text)
        answer = calc("run", "rv_gearing", "--inputs", "gearing.toml")
        assert answer.code == 2, answer
        assert answer.out == ""
        assert "Traceback" not in answer.err
        assert [path.name for path in tmp_path.iterdir()] == ["gearing.toml"]
        return answer.err.rstrip("\n").split("\n")

    return run


@pytest.mark.parametrize("value", ["0", "-1"])
@pytest.mark.parametrize("name", POSITIVE)
def test_what_must_be_positive(refused: Refused, name: str, value: str) -> None:
    unit = POSITIVE[name]
    (found,) = refused(f'{name} = "{value} {unit}"')
    assert found.startswith(f"gearing.toml:3: {name} is {value} ")
    assert "it must be above 0" in found


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("target_ratio = 1", "target_ratio is 1; it must be above 1"),
        ("target_ratio = -111", "target_ratio is -111; it must be above 1"),
        ("ratio_tolerance = 0", "ratio_tolerance is 0; it must be above 0"),
        ("ratio_tolerance = 0.21", "ratio_tolerance is 0.21; it must be at most 0.2"),
        ("ratio_tolerance = 1", "ratio_tolerance is 1; it must be at most 0.2"),
        ("fewest_sun_teeth = 5", "fewest_sun_teeth is 5; it must be at least 6"),
        ("sun_teeth = 5\nplanet_teeth = 55", "sun_teeth is 5; it must be at least 6"),
        ("planets = 0", "planets is 0; it must be at least 1"),
        ("group = 0", "group is 0; it must be at least 1"),
        ("involute_efficiency = 0", "involute_efficiency is 0; it must be above 0"),
        ("cycloid_efficiency = 1.01", "cycloid_efficiency is 1.01; it must be at most 1"),
        ("bearing_efficiency = -0.99", "bearing_efficiency is -0.99; it must be above 0"),
        ("bearing_efficiency = 1.0001", "bearing_efficiency is 1.0001; it must be at most 1"),
        ("planet_load_factor = 0.9", "planet_load_factor is 0.9; it must be at least 1"),
        ("accuracy_grade = 13", "accuracy_grade is 13; it must be at most 12"),
        ("addendum = 0", "addendum is 0; it must be above 0"),
        ("fillet = -0.1", "fillet is -0.1; it must be at least 0"),
        ('pressure_angle = "10 deg"', "pressure_angle is 10 deg; it must be above 10 deg"),
        ('helix_angle = "45 deg"', "helix_angle is 45 deg; it must be below 45 deg"),
        ("poisson_ratio_sun = 0.5", "poisson_ratio_sun is 0.5; it must be below 0.5"),
        ("stated_dynamic_factor = 0", "stated_dynamic_factor is 0; it must be above 0"),
        ("stated_form_factor_planet = -2.3", "stated_form_factor_planet is -2.3; it must be above 0"),
    ],
)
def test_a_number_outside_of_its_range(refused: Refused, line: str, sentence: str) -> None:
    assert refused(line) == [f"gearing.toml:3: {sentence}"]


@pytest.mark.parametrize(
    ("line", "name", "words"),
    [
        ('power = "nan kW"', "power", "not a finite number"),
        ('power = "inf kW"', "power", "not a finite number"),
        ("target_ratio = nan", "target_ratio", "not a finite number"),
        ("ratio_tolerance = inf", "ratio_tolerance", "not a finite number"),
        ("load_torque = nan", "load_torque", "number"),
        ("target_ratio = true", "target_ratio", "number"),
        ("planets = true", "planets", "number"),
        ("shift_sun = false", "shift_sun", "number"),
        ("sun_teeth = 20.5\nplanet_teeth = 55", "sun_teeth", "whole number"),
        ("fewest_pins = 40.5", "fewest_pins", "whole number"),
        ('power = "2.26 N"', "power", "force"),
        ('material = "cast_iron"', "material", "case_hardened"),
        ('window = "narrow"', "window", "one_pin_circle"),
        ('helix_reading = "din"', "helix_reading", "gb_1997"),
        ("modul = 1", "modul", "Did you mean 'module'"),
    ],
)
def test_what_is_no_such_value(refused: Refused, line: str, name: str, words: str) -> None:
    (found,) = refused(line)
    assert found.startswith("gearing.toml:3: ")
    assert name in found
    assert words in found


@pytest.mark.parametrize(
    ("lines", "blamed", "words"),
    [
        # the set of pin numbers: odd, empty
        (["fewest_pins = 39", "most_pins = 41"], (3, 4), "is odd"),
        (["most_pins = 41"], (3,), "most_pins = 41 is odd"),
        (["fewest_pins = 42"], (3,), "fewest_pins = 42 exceeds most_pins = 40"),
        (["sun_teeth = 20", "planet_teeth = 55", "pin_teeth = 39"], (5,), "pin_teeth"),
        # ranges that are reversed
        (['pin_circle_low = "1.4 mm**(2/3)/N**(1/3)"'], (3,), "pin_circle_low exceeds pin_circle_high"),
        (["centre_share_low = 0.7"], (3,), "centre_share_low exceeds centre_share_high"),
        # one number of teeth alone, a group that is not there
        (["sun_teeth = 20"], (3,), "sun_teeth and planet_teeth are stated together"),
        (["planet_teeth = 55"], (3,), "sun_teeth and planet_teeth are stated together"),
        (["pin_teeth = 40"], (3,), "pin_teeth is stated without"),
        (["group = 26"], (3,), "group = 26, but the search finds 25 groups"),
        (["target_ratio = 3000"], (3,), "the search finds no group"),
    ],
)
def test_a_search_that_cannot_be(refused: Refused, lines: list[str], blamed: tuple[int, ...], words: str) -> None:
    (found,) = refused("\n".join(lines))
    assert any(found.startswith(f"gearing.toml:{line}: ") for line in blamed), found
    assert words in found


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        # contact ratio of 20/55 at 20 deg: 1.664 with h_a* = 1; below 1 at 0.55
        (["addendum = 0.5"], "contact ratio is below 1"),
        # tip circle 20 + 2 (0.8 - 1.45) = 18.7 modules, base circle 20 cos(20 deg) = 18.79
        (["addendum = 0.8", "shift_sun = -1.45"], "tip of the sun lies below its base circle"),
        (["dedendum = 11"], "nothing is left below the teeth"),
        (["shift_sun = 1.4"], "pointed"),
        # tan of the angle at the tip, 1.007, is less than one tooth, 2 pi/6: negative under the root of Z_B
        (["sun_teeth = 6", "planet_teeth = 30"], "single contact of the sun would lie below the base circle"),
        (["shift_sun = -1.5", "shift_planet = -1.5"], "shift_sun"),
    ],
)
def test_a_pair_that_cannot_mesh(refused: Refused, lines: list[str], words: str) -> None:
    (found,) = refused("\n".join(lines))
    assert found.startswith("gearing.toml:")
    assert words in found


def test_every_fault_is_named_at_once(refused: Refused) -> None:
    found = refused('power = "0 kW"\nplanets = 0\nratio_tolerance = 0.3\nbearing_efficiency = 2\nmaterial = "wood"')
    assert [line.split(": ")[0] for line in found] == [f"gearing.toml:{place}" for place in (3, 4, 5, 6, 7)]
