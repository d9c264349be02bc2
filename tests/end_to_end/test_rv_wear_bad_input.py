"""The reducer refuses what cannot be, by name, file and line; what lies outside of its laws it says and goes on."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from shared import Calc
from truing import Kernel
from truing.calculation import Calculation, calculate
from truing.inputs_file import setup_from_settings

Refused = Callable[[str], list[str]]
NUMBERS = {
    "pin_circle_radius": "mm", "pin_radius": "mm", "eccentricity": "mm", "disc_width": "mm", "young_modulus": "MPa",
    "output_torque": "N*m", "output_speed": "r/min", "composite_roughness": "um", "pressure_viscosity": "1/Pa",
    "reconstruction_depth": "um", "permitted_backlash": "arcmin", "sun_radius": "mm", "centre_distance": "mm",
}  # fmt: skip


@pytest.fixture
def refused(calc: Calc, tmp_path: Path) -> Refused:
    """Run the reducer with lines under [inputs]; it must end with exit code 2 and leave nothing behind."""

    def run(lines: str) -> list[str]:
        text = f'plugin = "rv_wear"\n[inputs]\n{lines}\n'
        (tmp_path / "reducer.toml").write_text(text)
        answer = calc("run", "rv_wear", "--inputs", "reducer.toml")
        assert answer.code == 2, answer
        assert answer.out == ""
        assert "Traceback" not in answer.err
        assert [path.name for path in tmp_path.iterdir()] == ["reducer.toml"]
        return answer.err.rstrip("\n").split("\n")

    return run


def found_with(*settings: str, studies: str = "validity") -> Calculation:
    """Calculate the reducer with settings as of ``--set``, and only this study."""
    offer = Kernel.installed().offers["rv_wear"]
    pairs = dict(text.split("=", 1) for text in settings)
    return calculate(setup_from_settings(offer, {**pairs, "studies.run": f'["{studies}"]'}))


@pytest.mark.parametrize("value", ["0", "-1"])
@pytest.mark.parametrize("name", NUMBERS)
def test_what_must_be_positive(refused: Refused, name: str, value: str) -> None:
    unit = NUMBERS[name]
    (found,) = refused(f'{name} = "{value} {unit}"')
    assert found == f"reducer.toml:3: {name} is {value} {unit}; it must be above 0 {unit}"


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("pin_count = 3", "pin_count is 3; it must be at least 4"),
        ("pin_count = -40", "pin_count is -40; it must be at least 4"),
        ("poisson_ratio = 0.5", "poisson_ratio is 0.5; it must be below 0.5"),
        ("poisson_ratio = -0.1", "poisson_ratio is -0.1; it must be at least 0"),
        ('working_time = "-1 h"', "working_time is -1 h; it must be at least 0 h"),
        ('working_time = "nan h"', "working_time: 'nan h' is not a finite number"),
        ('output_torque = "inf N*m"', "output_torque: 'inf N*m' is not a finite number"),
        ("total_ratio = nan", "total_ratio is nan, which is not a finite number"),
        ("required_reliability = 0", "required_reliability is 0; it must be above 0"),
        ("required_reliability = 1.01", "required_reliability is 1.01; it must be at most 1"),
        ("torque_share = 1.2", "torque_share is 1.2; it must be at most 1"),
    ],
)
def test_a_number_outside_of_its_range(refused: Refused, line: str, sentence: str) -> None:
    assert refused(line) == [f"reducer.toml:3: {sentence}"]


def test_a_count_of_pins_that_is_no_whole_number(refused: Refused) -> None:
    (found,) = refused("pin_count = 40.5")
    assert found.startswith("reducer.toml:3: pin_count")
    assert "whole number" in found


@pytest.mark.parametrize(
    ("name", "value", "sentence"),
    [
        ("composite_roughness", "1.5 mm", "composite_roughness is 1500 um; it must be below 1000 um"),
        ("extra_wear", "3.1 mm", "extra_wear is 3100 um; it must be at most 1000 um"),
        ("equidistant_modification", "-26 mm", "equidistant_modification is -26000 um; it must be at least -1000 um"),
        ("disc_runout", "6.55 mm", "disc_runout is 6550 um; it must be at most 1000 um"),
        ("pin_radius", "5 m", "pin_radius is 5000 mm; it must be below 1000 mm"),
    ],
)
def test_micrometres_written_as_millimetres(refused: Refused, name: str, value: str, sentence: str) -> None:
    """A wear, a deviation or a roughness of a millimetre is a slip of the unit."""
    assert refused(f'{name} = "{value}"') == [f"reducer.toml:3: {sentence}"]


@pytest.mark.parametrize(
    ("lines", "blamed", "words"),
    [
        # K_1 = e z_p / r_p: 2.9 * 40 / 114.5 = 1.013
        (['eccentricity = "2.9 mm"'], 3, "the short-width coefficient must lie between 0 and 1"),
        (['pin_circle_radius = "88 mm"'], 3, "the short-width coefficient must lie between 0 and 1"),
        # r_p sin(pi / z_p) = 8.983 mm; the smallest convex radius is 9.05 mm, so pins overlap first
        (['pin_radius = "9.0 mm"'], 3, "neighbouring pins overlap"),
        (['pin_radius = "9.1 mm"'], 3, "the pins undercut the disc"),
        # the radial clearance is the equidistant modification less the shift
        (['shift_modification = "-25.9 um"'], 3, "the radial clearance is negative"),
        # the upper bound is 11.104 um at a radial clearance of 4 um
        (['equidistant_modification = "11.2 um"', 'shift_modification = "7.2 um"'], 4, "disc and pins interfere"),
    ],
)
def test_a_disc_that_cannot_be(refused: Refused, lines: list[str], blamed: int, words: str) -> None:
    (found,) = refused("\n".join(lines))
    assert found.startswith(f"reducer.toml:{blamed}: {words}"), found


@pytest.mark.parametrize("radius", ["8.97 mm", "5 mm"])
def test_pins_that_just_do_not_overlap(radius: str) -> None:
    assert found_with(f"pin_radius={radius}").answers["max_wear"] > 0


def test_the_largest_modification_is_where_the_disc_begins_to_interfere() -> None:
    found = found_with("equidistant_modification=11.1 um", "shift_modification=7.1 um")
    assert found.answers["equidistant_high"] == pytest.approx(11.104e-6, abs=1e-9)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('{zone = ["1 um", "1 um"]}', "its end 1 um must lie above its start 1 um"),
        ('{zone = ["1 um", "-1 um"]}', "its end -1 um must lie above its start 1 um"),
        ('"±-1 um"', "negative"),
        ('"band -2 um"', "negative"),
        ('"1 um"', "is no tolerance"),
    ],
)
def test_a_zone_without_width(refused: Refused, text: str, words: str) -> None:
    (found,) = refused(f"[tolerances]\ndisc_runout = {text}")
    assert found.startswith("reducer.toml:4: ")
    assert "disc_runout" in found
    assert words in found


def test_every_fault_is_named_at_once(refused: Refused) -> None:
    found = refused('pin_radius = "0 mm"\npin_count = 2\nworking_time = "-3 h"\ncost_form = "linear"')
    assert [line.split(": ")[0] for line in found] == [f"reducer.toml:{place}" for place in (3, 4, 5, 6)]
    assert "power" in found[3]


def test_what_is_said_stands_on_the_sheet_and_on_stderr(calc: Calc, tmp_path: Path) -> None:
    answer = calc(
        "run", "rv_wear", "-o", "run", "--set", 'studies.run=["validity"]', "--set", "pressure_viscosity=4e-9 1/Pa",
        "--set", "working_time=0 h",
    )  # fmt: skip
    said = "study 'validity': pressure_viscosity is 4e-09 1/Pa, outside of 5e-9 to 5e-8 1/Pa"
    assert answer.code == 1  # no study of this run decides the limit of the backlash
    assert f"warning: {said}" in answer.err
    assert said.replace("'", "&#39;") in (tmp_path / "run/sheet.html").read_text()


# ---- said, not refused ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ("pressure_viscosity=4e-9 1/Pa", "pressure_viscosity is 4e-09 1/Pa, outside of 5e-9 to 5e-8 1/Pa"),
        ("pressure_viscosity=6e-8 1/Pa", "pressure_viscosity is 6e-08 1/Pa, outside of 5e-9 to 5e-8 1/Pa"),
        ("composite_roughness=0.04 um", "composite_roughness is 0.04 um, outside of 0.05 to 5 um"),
        ("composite_roughness=6 um", "composite_roughness is 6 um, outside of 0.05 to 5 um"),
    ],
)
def test_oil_and_surfaces_outside_of_the_regression(setting: str, words: str) -> None:
    (warning,) = found_with(setting, "working_time=0 h").warnings
    assert warning.startswith(f"study 'validity': {words}")


@pytest.mark.parametrize(
    "setting", ["pressure_viscosity=5e-8 1/Pa", "composite_roughness=0.05 um", "equidistant_modification=-26 um"]
)
def test_nothing_is_said_at_the_ends_of_the_regression(setting: str) -> None:
    assert found_with(setting, "working_time=0 h").warnings == ()


def test_a_modification_below_its_range() -> None:
    (warning,) = found_with("equidistant_modification=-54 um", "shift_modification=-58 um").warnings
    assert "equidistant_modification is -54 um, below the -53.75 um of equation 17" in warning


def test_a_torque_that_only_one_pin_carries() -> None:
    found = found_with(
        "output_torque=0.1 N*m", "phases=200", "shift_modification=-126 um", "equidistant_modification=-26 um"
    )
    assert found.answers["loaded_pins"] < 2
    assert any("output_torque is too small" in warning for warning in found.warnings)


def test_a_pressure_above_the_permitted_one_fails_a_check() -> None:
    found = found_with("output_torque=20000 N*m", "working_time=0 h")
    (check,) = [check for check in found.checks if check.name == "max_pressure"]
    assert check.value > 2000
    assert not check.passed


def test_fewer_draws_than_the_reliability_needs() -> None:
    """0.999 allows one miss in a thousand."""
    quick = "studies.reliability.points=2"
    found = found_with("required_reliability=0.999", "studies.reliability.draws=999", quick, studies="reliability")
    assert any("draws = 999 cannot show a reliability of 0.999 of 'backlash'" in text for text in found.warnings)
    found = found_with("required_reliability=0.999", "studies.reliability.draws=1000", quick, studies="reliability")
    assert not any("cannot show" in text for text in found.warnings)


def test_a_point_outside_of_the_box_of_the_surrogate_is_said() -> None:
    few = ("studies.surrogate.design=30", "studies.surrogate.restarts=0", "studies.surrogate.compare=0")
    found = found_with("output_torque=6000 N*m", *few, studies="surrogate")
    assert any("outside the box of the surrogate in 'output_torque'" in text for text in found.warnings)
    assert found.outcomes["surrogate"].as_json()["extrapolated"] == ["output_torque"]
