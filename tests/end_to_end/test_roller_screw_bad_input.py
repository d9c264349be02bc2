"""The roller screw refuses what cannot be, by name, file and line, with nothing written."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from shared import Calc

Refused = Callable[..., list[str]]


@pytest.fixture
def refused(calc: Calc, tmp_path: Path) -> Refused:
    """Run the roller screw with lines under [inputs]; it must end with exit code 2 and leave nothing behind."""

    def run(lines: str, studies: str = "run = []") -> list[str]:
        text = f'plugin = "roller_screw_shift"\n[inputs]\n{lines}\n[studies]\n{studies}\n'
        (tmp_path / "screw.toml").write_text(text)
        answer = calc("run", "roller_screw_shift", "--inputs", "screw.toml")
        assert answer.code == 2, answer
        assert answer.out == ""
        assert "Traceback" not in answer.err
        assert [path.name for path in tmp_path.iterdir()] == ["screw.toml"]
        return answer.err.rstrip("\n").split("\n")

    return run


@pytest.mark.parametrize("value", ["0", "-1"])
@pytest.mark.parametrize("name", ["module", "face_width", "centre_distance", "screw_diameter", "roller_diameter"])
def test_a_size_that_is_none(refused: Refused, name: str, value: str) -> None:
    (found,) = refused(f'{name} = "{value} mm"')
    assert found == f"screw.toml:3: {name} is {value} mm; it must be above 0 mm"


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("roller_teeth = 7", "roller_teeth is 7; it must be at least 8"),
        ("ring_teeth = 15", "ring_teeth is 15; it must be at least 16"),
        ('pressure_angle = "10 deg"', "pressure_angle is 10 deg; it must be above 10 deg"),
        ('pressure_angle = "30 deg"', "pressure_angle is 30 deg; it must be below 30 deg"),
        ("least_contact_ratio = 0.9", "least_contact_ratio is 0.9; it must be at least 1"),
        ("rollers = 0", "rollers is 0; it must be at least 1"),
        ("carrying_share = 1.1", "carrying_share is 1.1; it must be at most 1"),
        ("rim_factor = 0", "rim_factor is 0; it must be above 0"),
        ("most_sliding_difference = 0", "most_sliding_difference is 0; it must be above 0"),
        ("clearance = -0.1", "clearance is -0.1; it must be at least 0"),
        ("roller_shift = 3.1", "roller_shift is 3.1; it must be at most 3"),
    ],
)
def test_a_number_outside_of_its_range(refused: Refused, line: str, sentence: str) -> None:
    assert refused(line) == [f"screw.toml:3: {sentence}"]


@pytest.mark.parametrize(
    ("line", "name", "words"),
    [
        ('centre_distance = "nan mm"', "centre_distance", "not a finite number"),
        ('axial_load = "inf kN"', "axial_load", "not a finite number"),
        ("roller_shift = nan", "roller_shift", "not a finite number"),
        ("roller_shift = true", "roller_shift", "number"),
        ("rollers = true", "rollers", "number"),
        ("roller_teeth = 20.5", "roller_teeth", "whole number"),
        ('module = "0.5 N"', "module", "force"),
        ('weights = "mine"', "weights", "printed_ranges"),
        ("ring_shift = -0.16", "ring_shift", "is a result; it is calculated, not stated"),
    ],
)
def test_what_is_no_such_value(refused: Refused, line: str, name: str, words: str) -> None:
    (found,) = refused(line)
    assert found.startswith("screw.toml:3: ")
    assert name in found
    assert words in found


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        (["roller_teeth = 20", "ring_teeth = 27"], "ring_teeth at least 8 above roller_teeth"),
        # a cos(alpha) = 20 cos(20 deg) = 18.794 mm must be less than the centre distance
        (['centre_distance = "18.79 mm"'], "the base circles are farther apart than the centres"),
        (["centre_distance = '18.8 mm'", "centre_distance_deviation = '-10 um'"], "as mounted"),
        # 10 + 0.8 - 1.5 = 9.3 modules, below 10 cos(20 deg) = 9.397
        (["roller_shift = -1.5"], "tip circle of the roller lies inside its base circle"),
        # the ring: (50 - 2 - 0.58) below 50 cos(20 deg) = 46.98 needs a shift below -1.02
        (["addendum = 2", "roller_shift = -0.7"], "tip circle of the ring lies inside its base circle"),
        (["roller_shift = -0.5"], "involute interference"),
        # the default set with full-depth teeth: at 0.1 the tip of the ring already meets no involute
        (["addendum = 1.0", "roller_shift = -0.1"], "involute interference"),
    ],
)
def test_a_pair_that_cannot_be(refused: Refused, lines: list[str], words: str) -> None:
    (found,) = refused("\n".join(lines))
    assert found.startswith("screw.toml:")
    assert words in found


@pytest.mark.parametrize(
    ("lines", "name"),
    [
        # the flanks of the rack meet above such a fillet: no root chord, or none of positive length
        (["roller_fillet = 1.0"], "roller_fillet"),
        (["clearance = 1.0", "addendum = 1.2", "roller_shift = 0.6"], "roller"),
        (["ring_fillet = 1.0"], "ring_fillet"),
        (["ring_fillet = 0"], "ring_fillet must be greater than 0"),
        # no arm: the force at the tip of the ring meets the axis below the section
        (["addendum = 0.1", "clearance = 0.0", "roller_shift = 0"], "addendum"),
    ],
)
def test_a_root_without_section_or_arm(refused: Refused, lines: list[str], name: str) -> None:
    (found,) = refused("\n".join(lines))
    assert found.startswith("screw.toml:")
    assert name in found


def test_every_fault_is_named_at_once(refused: Refused) -> None:
    found = refused('module = "0 mm"\nroller_teeth = 2\nweights = "equal"\nroller_shift = 9')
    assert [line.split(": ")[0] for line in found] == [f"screw.toml:{place}" for place in (3, 4, 5, 6)]
