"""What ``--set`` and the settings of published numbers put in the place of the file."""

from __future__ import annotations

from pathlib import Path

import pytest
from sample_models import PIN_OFFER, STAGE_OFFER, Census

from truing.declare.spreads import Band, Zone
from truing.errors import InputError
from truing.inputs_file import read_setup, setup_from_settings

SURFACE = 'surface={ file = "flank.txt", spacing = "0.4 um" }'


def test_overrides_replace_what_the_file_says(tmp_path: Path) -> None:
    path = tmp_path / "wear.toml"
    path.write_text('[inputs]\nload = "3 kN"\nspeed = "oops"\n[effects.warm_probe]\nslope = "1 um/K"\n')
    overrides = [
        "load=4 kN", "speed = 2 m/s", "inputs.rate=1e-8", "probe_temperature=30 degC", "tolerances.load=±0.1 kN",
        "effects.warm_probe.slope=-1 um/K", "studies.census.draws=7", "studies.run=[\"census\"]", "seed=3",
        "sheet.project=A=B", "units.depth=mm", "calibrated.hardness=2 GPa", "detail=short",
        'tolerances.hardness={zone = ["0 GPa", "0.2 GPa"]}', 'studies.census.of=["pressure"]',
    ]  # fmt: skip
    setup = read_setup(path, PIN_OFFER, overrides=overrides)
    assert (setup.inputs.load, setup.inputs.speed, setup.inputs.rate) == (4000.0, 2.0, 1e-8)
    assert setup.conditions["probe_temperature"] == pytest.approx(303.15)
    assert setup.spreads == {"load": Band("0.1 kN", "±"), "hardness": Zone("0 GPa", "0.2 GPa")}
    assert setup.effects[0].values == {"slope": pytest.approx(-1e-6)}
    assert setup.studies == (Census(draws=7, of=("pressure",)),)
    assert (setup.seed, setup.sheet.detail, setup.sheet.head["project"]) == (3, "short", "A=B")
    assert (setup.units, setup.calibrated) == ({"depth": "mm"}, {"hardness": 2e9})
    assert setup.source.file == str(path)


def test_an_effect_is_switched_off(tmp_path: Path) -> None:
    path = tmp_path / "wear.toml"
    path.write_text('[effects.warm_probe]\nslope = "1 um/K"\n')
    assert len(read_setup(path, PIN_OFFER).effects) == 1
    assert read_setup(path, PIN_OFFER, overrides=["effects.warm_probe=off"]).effects == ()


def test_faults_of_overrides_come_after_those_of_the_file(tmp_path: Path) -> None:
    path = tmp_path / "wear.toml"
    path.write_text('[inputs]\nspeed = "1 m"\n')
    with pytest.raises(InputError) as caught:
        read_setup(path, PIN_OFFER, overrides=["laod=3 kN", "area=3 mm", "nonsense", "studies.census.draws=x"])
    assert str(caught.value).splitlines() == [
        f"{path}:2: speed: '1 m' is a length (m), expected a speed (m/s)",
        "--set laod=3 kN: pin_wear has no input 'laod'. Did you mean 'load' (F, normal load on the pin, N)?",
        "--set area=3 mm: area: '3 mm' is a length (mm), expected an area (mm²)",
        "--set nonsense: write name=value, such as load='3 kN'",
        "--set studies.census.draws=x: study 'census': draws = 'x' is no whole number",
    ]


def test_settings_of_published_numbers() -> None:
    setup = setup_from_settings(PIN_OFFER, {"load": "3 kN", "tolerances.load": "sd 1 %"})
    assert setup.inputs.load == 3000.0
    assert setup.spreads["load"] == Band("1 %", "sd")
    with pytest.raises(InputError, match=r"^settings area=1 N: area: '1 N' is a force"):
        setup_from_settings(PIN_OFFER, {"area": "1 N"})


@pytest.mark.parametrize(("text", "expected"), [("true", True), ("false", False)])
def test_switches_counts_and_files_on_the_command_line(tmp_path: Path, text: str, expected: bool) -> None:
    (tmp_path / "flank.txt").write_text("1\n2\n4\n")
    path = tmp_path / "stage.toml"
    path.write_text("[inputs]\n")
    overrides = [f"is_hardened={text}", "planets=5", "reading=printed", SURFACE, "orders=[4]"]
    setup = read_setup(path, STAGE_OFFER, overrides=[*overrides, 'profile=["1 um"]'])
    assert setup.inputs.is_hardened is expected
    assert (setup.inputs.planets, setup.inputs.reading, setup.inputs.orders) == (5, "printed", (4,))
    assert setup.inputs.surface.heights == (1.0, 2.0, 4.0)


@pytest.mark.parametrize(
    "stated", ['surface = { file = "flank.txt", spacing = "0.4 um" }', 'surface = "flank.txt"'], ids=["table", "file"]
)
def test_an_option_of_a_data_file_on_the_command_line(tmp_path: Path, stated: str) -> None:
    (tmp_path / "flank.txt").write_text("1\n2\n4\n")
    (tmp_path / "stage.toml").write_text(f"[inputs]\n{stated}\n")
    setup = read_setup(tmp_path / "stage.toml", STAGE_OFFER, overrides=['surface.spacing="0.5 um"'])
    assert setup.inputs.surface.spacing == "0.5 um"
    assert setup.inputs.surface.heights == (1.0, 2.0, 4.0)


@pytest.mark.parametrize(
    ("option", "words"),
    [
        ("surface.spacng=1 um", "the reader takes no 'spacng'; beside file it takes: spacing, height_unit."),
        ("surface.file=none.txt", "there is no file 'none.txt'"),
    ],
)
def test_an_option_that_is_none_is_named_with_the_override(tmp_path: Path, option: str, words: str) -> None:
    (tmp_path / "flank.txt").write_text("1\n2\n4\n")
    (tmp_path / "stage.toml").write_text(f"[inputs]\n{SURFACE.replace('=', ' = ', 1)}\n")
    with pytest.raises(InputError) as caught:
        read_setup(tmp_path / "stage.toml", STAGE_OFFER, overrides=[option])
    (line,) = str(caught.value).splitlines()
    assert line.startswith(f"--set {option}: surface: ")
    assert words in line


def test_an_option_without_its_file_asks_for_the_file(tmp_path: Path) -> None:
    (tmp_path / "stage.toml").write_text("[inputs]\n")
    with pytest.raises(InputError, match=r"--set surface\.spacing=1 um: surface is read from a data file"):
        read_setup(tmp_path / "stage.toml", STAGE_OFFER, overrides=["surface.spacing=1 um"])
