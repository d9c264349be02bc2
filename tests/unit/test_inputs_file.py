"""The inputs file: what is read, and what is said of everything that cannot be."""

from __future__ import annotations

import hashlib
import json
import math
import re
import time
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from sample_models import PIN_OFFER, PIN_WEAR, RENAMED, STAGE_OFFER, Census, faults, pin

from truing.declare.spreads import Band, Grade, Off, Zone
from truing.errors import InfeasibleError, InputError, PluginError
from truing.example_file import example_text, text_to_fill_in
from truing.inputs_file import json_schema, read_setup, setup_from_settings, setup_from_text
from truing.inputs_file.assemble import OF_THE_SHEET
from truing.inputs_file.entries import HEAD
from truing.inputs_file.sentences import located, told_by_line
from truing.kernel import Kernel
from truing.runs.inputs_written import complete_inputs
from truing.setup import DiagnoseOptions, InputsSource, Setup, default_setup

SURFACE = 'surface = { file = "flank.txt", spacing = "0.4 um" }'


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "flank.txt").write_text("1\n2\n4\n")
    return tmp_path


def stage(text: str, folder: Path, *overrides: str) -> Setup:
    return setup_from_text(text, STAGE_OFFER, file="stage.toml", folder=folder, overrides=overrides)


def stage_faults(text: str, folder: Path, *overrides: str) -> list[str]:
    with pytest.raises(InputError) as caught:
        stage(text, folder, *overrides)
    return str(caught.value).splitlines()


# What is read


def test_values_are_converted_and_the_rest_is_default() -> None:
    setup = pin('[inputs]\nload = "0.2 kN"\ntime = "24 h"\nrate = 4e-8\n')
    assert (setup.inputs.load, setup.inputs.time, setup.inputs.rate) == (200.0, 86400.0, 4e-8)
    assert setup.inputs.area == pytest.approx(28e-6, rel=1e-15)
    assert setup.source.stated == {"load", "time", "rate"}


def test_an_empty_section_list_is_the_default_setup() -> None:
    setup = pin("# nothing stated\n")
    assert replace(setup, source=replace(setup.source, file="")) == default_setup(PIN_WEAR, PIN_OFFER.origin)


def test_every_section_is_read() -> None:
    setup = pin("""
plugin = "pin_wear"
[sheet]
project = "Rig 7"
revision = 2
date = 2024-02-29
detail = "full"
company = ""
[inputs]
load = "150 N"
[tolerances]
load = "±3 N"
hardness = "off"
[conditions]
probe_temperature = "35 degC"
[effects.running_in]
length = "30 m"
extra = { value = "5 um", sd = "0.5 um" }
covariance = [[0.25, 0.1], [0.1, 4.0]]
[calibrated]
hardness = "2.2 GPa"
[studies]
run = ["second", "census"]
seed = 0
[studies.census]
draws = 50
method = "quasi"
of = ["pressure"]
[units]
depth = "mm"
load = "kN"
""")
    assert setup.sheet.head == {"project": "Rig 7", "revision": "2", "date": "2024-02-29"}
    assert (setup.sheet.detail, setup.seed) == ("full", 0)
    assert setup.spreads == {"load": Band("3 N", "±"), "hardness": Off()}
    assert setup.conditions == {"probe_temperature": pytest.approx(308.15)}
    assert setup.calibrated == {"hardness": 2.2e9}
    assert setup.studies == (Census(name="second"), Census(draws=50, method="quasi", of=("pressure",)))
    assert setup.units == {"depth": "mm", "load": "kN"}
    (on,) = setup.effects
    assert on.effect is PIN_WEAR.effects["running_in"]
    assert on.values == {"extra": pytest.approx(5e-6), "length": 30.0}
    assert on.sds == {"extra": pytest.approx(0.5e-6), "length": 2.0}
    np.testing.assert_allclose(on.covariance, [[0.25e-12, 0.1e-6], [0.1e-6, 4.0]], rtol=1e-12)


def test_the_options_of_a_study_may_stand_in_one_line() -> None:
    assert pin("[studies]\ncensus = { draws = 7 }\n").studies == (Census(draws=7), Census(name="second"))


def test_parts_choices_counts_series_and_files(folder: Path) -> None:
    text = f"""[inputs]
teeth_sun = 19
bore_planet = "1 in"
reading = "printed"
planets = 4
is_hardened = false
face_factor = 1.2
oil = "140 degF"
profile = ["1 um", "0.002 mm"]
orders = [3, 5, 7]
{SURFACE}
"""
    setup = stage(text, folder)
    inputs = setup.inputs
    assert (inputs.sun.teeth, inputs.planet.teeth, inputs.planets) == (19.0, 31.0, 4)
    assert inputs.planet.bore == pytest.approx(25.4e-3)
    assert (inputs.reading, inputs.is_hardened, inputs.face_factor) == ("printed", False, 1.2)
    assert inputs.oil == pytest.approx(333.15)
    np.testing.assert_allclose(inputs.profile, [1e-6, 2e-6])
    assert inputs.orders == (3, 5, 7)
    assert (inputs.surface.heights, inputs.surface.spacing) == ((1.0, 2.0, 4.0), "0.4 um")
    assert setup.source.files == {"surface": hashlib.sha256(b"1\n2\n4\n").hexdigest()}


def test_a_series_may_share_one_unit_and_a_file_a_short_form(folder: Path) -> None:
    setup = stage(f'[inputs]\nprofile = {{ values = [1, 2.5], unit = "um" }}\n{SURFACE}\n', folder)
    np.testing.assert_allclose(setup.inputs.profile, [1e-6, 2.5e-6])
    assert stage_faults('[inputs]\nsurface = "flank.txt"\n', folder) == [
        'stage.toml:2: surface: the reader needs spacing too; write surface = { file = "...", spacing = ... }'
    ]


def test_an_optional_input_left_out_is_nan_and_does_not_scatter(folder: Path) -> None:
    setup = stage(f"[inputs]\n{SURFACE}\n", folder)
    assert math.isnan(setup.inputs.face_factor)
    assert setup.spreads["face_factor"] == Off()
    given = stage(
        f'[inputs]\nface_factor = 1.1\n{SURFACE}\n[tolerances]\nface_factor = {{ zone = ["0", "0.4"] }}\n', folder
    )
    assert given.spreads["face_factor"] == Zone("0", "0.4")
    assert stage_faults(f'[inputs]\n{SURFACE}\n[tolerances]\nface_factor = {{ zone = ["0", "0.4"] }}\n', folder) == [
        "stage.toml:4: 'face_factor' is not given, so it has no tolerance; state it or write \"off\""
    ]


def test_a_grade_is_read_for_every_size_it_is_on(folder: Path) -> None:
    """Where a stated size outgrows a declared grade, the size is told."""
    assert stage(f'[inputs]\n{SURFACE}\n[tolerances]\nbores = "IT6"\n', folder).spreads["bores"] == Grade("IT6")
    large = f'[inputs]\n{SURFACE}\nbore_planet = "4 m"\n'
    for text, place in (('[tolerances]\nbores = "IT6"\n', "5: bores"), ("", "3: tolerance 'bores'")):
        (found,) = stage_faults(large + text, folder)
        assert found.startswith(f"stage.toml:{place}: ")
        assert "3150 mm" in found


@pytest.mark.parametrize("mark", ["", "\ufeff"])
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_byte_order_marks_and_line_ends(tmp_path: Path, mark: str, end: str) -> None:
    path = tmp_path / "Größe 1.toml"
    path.write_bytes((mark + end.join(["[inputs]", 'load = "3 kN"', 'speed = "1 mm"', ""])).encode())
    with pytest.raises(InputError) as caught:
        read_setup(path, PIN_OFFER)
    assert [fault.line for fault in caught.value.faults] == [3]


def test_old_names_answer_with_a_warning() -> None:
    setup = pin("[inputs]\nk_wear = 5e-8\n")
    assert setup.inputs.rate == 5e-8
    assert setup.source.warnings == ("'k_wear' is now called 'rate'; the old name goes with pin_wear 2.0",)
    assert faults("[inputs]\nk_wear = 5e-8\nrate = 4e-8\n") == [
        "wear.toml:2: 'k_wear' is the old name of 'rate', which is given too; leave 'k_wear' out"
    ]


# Bad input: one value


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ('load = "3 m"', "load: '3 m' is a length (m), expected a force (N)"),
        ('speed = "3 mms"', "speed: unknown unit 'mms'; did you mean 'mm'?"),
        ('load = "120"', "load: '120' has no unit; expected a force such as '120 N'"),
        ("load = 120", "load = 120 has no unit; it is a force: write load = \"120 N\""),
        ("load = 1.5", "load = 1.5 has no unit; it is a force: write load = \"1.5 N\""),
        ("rate = nan", "rate is nan, which is not a finite number"),
        (
            'load = "360 ± 0.05 N"',
            "load: '360 ± 0.05 N' holds a tolerance; write the nominal value here, the rest under [tolerances]",
        ),
        ('load = "-3 N"', "load is -3 N; it must be above 0 N"),
        ('load = "0 kN"', "load is 0 N; it must be above 0 N"),
        ("load = true", "load = true is no quantity; write load = \"1 N\""),
        ("rate = false", "rate = false is no number; write rate = 1"),
        ("load = [1, 2]", "load = a list is no quantity; write load = \"1 N\""),
        ("load = 2024-01-01", "load = '2024-01-01' is no quantity; write load = \"1 N\""),
        ("load = 10 mm", 'load = 10 mm needs quotation marks; write load = "10 mm"'),
    ],
)  # fmt: skip
def test_a_wrong_value_of_an_input(line: str, sentence: str) -> None:
    assert f"wear.toml:3: {sentence}" in faults(f"[inputs]\n# a comment\n{line}\n")


def test_a_number_of_any_length_is_refused_quickly() -> None:
    begin = time.perf_counter()
    assert "too many digits" in faults(f"[inputs]\nrate = {'9' * 5000}\n")[0]
    assert "too large" in faults(f"[inputs]\nrate = {'9' * 400}\n")[0]
    assert faults('[inputs]\nload = "9**9**9 kN"\n')
    assert time.perf_counter() - begin < 5


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("teeth_sun = 4", "teeth_sun is 4; it must be at least 5"),
        ("teeth_planet = 501", "teeth_planet is 501; it must be at most 500"),
        ("teeth_sun = 20.5", "teeth_sun is 20.5; it must be a whole number"),
        ('bore_sun = "0 mm"', "bore_sun is 0 mm; it must be above 0 mm"),
        ("planets = 2.5", "planets = 2.5 is no whole number; write planets = 3"),
        ("planets = true", "planets = true is no whole number; write planets = 3"),
        ("planets = 1", "planets is 1; it must be at least 2"),
        ("is_hardened = 1", "is_hardened = 1 is no switch; write is_hardened = true or is_hardened = false"),
        (
            'reading = "complet"',
            "reading = 'complet' is not offered; choose 'printed' or 'complete'. Did you mean 'complete'?",
        ),
        ("face_factor = 0.9", "face_factor is 0.9; it must be at least 1"),
        ('oil = "-300 degC"', "oil: '-300 degC' lies below absolute zero"),
        ("profile = []", 'profile is a series; write profile = ["1 um", ...]'),
        ('profile = ["1 um", "2 N"]', "profile[2]: '2 N' is a force (N), expected a length (µm)"),
        ('orders = [1, "a"]', "orders[2] = 'a' is no whole number"),
        ('teeth = 20', "stage has no input 'teeth'. Did you mean 'teeth_sun' (z_1, number of teeth, sun)?"),
    ],
)  # fmt: skip
def test_a_wrong_value_of_other_kinds(folder: Path, line: str, sentence: str) -> None:
    assert stage_faults(f"[inputs]\n{SURFACE}\n{line}\n", folder) == [f"stage.toml:3: {sentence}"]


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ('{ file = "flnak.txt", spacing = "1" }', "there is no file 'flnak.txt' beside the inputs file"),
        ('{ file = "flank.txt", spacing = "1", hieght_unit = "m" }', "Did you mean 'height_unit'?"),
        ('{ file = "broken.txt", spacing = "1" }', "'broken.txt' cannot be read: could not convert string to float"),
        ('{ file = ".", spacing = "1" }', "there is no file '.'"),
        ("{ spacing = 1 }", 'write surface = { file = "data.txt" }'),
        ("3", 'write surface = { file = "data.txt" }'),
    ],
)
def test_a_data_file_that_cannot_be_read(folder: Path, value: str, words: str) -> None:
    (folder / "broken.txt").write_text("1\nx\n")
    (found,) = stage_faults(f"\n[inputs]\nsurface = {value}\n", folder)
    assert found.startswith("stage.toml:3: surface")
    assert words in found


# Bad input: names and sections


def test_misspelt_missing_and_extra_names_in_one_answer(folder: Path) -> None:
    assert stage_faults('plugin = "gears.stage"\n[inputs]\nplanest = 3\nlubricant = "oil"\n', folder) == [
        "stage.toml:2: stage needs the input 'surface' (measured flank); "
        'write surface = { file = "data.txt" } under [inputs]',
        "stage.toml:3: stage has no input 'planest'. Did you mean 'planets' (number of planets)?",
        "stage.toml:4: stage has no input 'lubricant'. (there are: teeth_sun, bore_sun, teeth_planet, bore_planet, "
        "reading, planets, is_hardened, face_factor, oil, profile, orders, surface)",
    ]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ('[input]\nload = "3 N"', "1: 'input' is no section of an inputs file. Did you mean 'inputs'?"),
        ('load = "3 N"', "1: 'load' is an input; write it under [inputs]"),
        ("inputs = 3", "1: 'inputs' is a section; write [inputs] and its entries below it"),
        ('[inputs]\nprobe_temperature = 3', "2: 'probe_temperature' is a condition; write it under [conditions]"),
        ('[conditions]\nload = "3 N"', "2: 'load' is an input; write it under [inputs]"),
        ('[inputs]\nrunning_in = "3 um"', "2: 'running_in' is an effect; write it under [effects.running_in]"),
        ('[inputs]\ndepth = "3 um"', "2: 'depth' is a result; it is calculated, not stated"),
        ('[inputs]\nLOAD = "3 N"', "2: pin_wear has no input 'LOAD'. Did you mean 'load'"),
        ('[tolerances]\narea = "±1 mm^2"', "2: 'area' is an input without a declared tolerance"),
        ('[tolerances]\nload = "3 N"', "2: load: '3 N' is no tolerance; write '±0.05 mm'"),
        ('[tolerances]\nload = "±3 mm"', "2: load: '3 mm' is a length (mm), expected a force (N)"),
        ('[tolerances]\nload = "IT6"', "2: load: IT6 is a grade for lengths"),
        ("[tolerances]\nload = 3", "2: load: a tolerance is a text such as"),
        ('[tolerances]\nload = "sd -3 %"', "2: load: "),
        ('[conditions]\nprobe_temperature = "3 K/m"', "2: probe_temperature: '3 K/m' is "),
        ('[effects.runing_in]\nextra = "3 um"', "1: pin_wear has no effect 'runing_in'. Did you mean 'running_in'?"),
        ('[effects.warm_probe]\nslope = "3 um/K"', "2: slope is 3 um/K; it must lie from -2 to 2 um/K"),
        ('[effects.warm_probe]\nslope = { sd = "3 um/K" }', "2: slope is written "),
        ('[effects.warm_probe]\nslope = { value = "1 um/K", sd = "-1 um/K" }', "2: sd of slope is negative"),
        ("[effects]\nwarm_probe = true", "2: 'warm_probe' is a section; write [effects.warm_probe]"),
        ('[effects.warm_probe]\nslope = "1 um/K"\ncovariance = [[-1]]', "3: covariance holds a negative variance"),
        ('[effects.warm_probe]\nslope = "1 um/K"\ncovariance = [1]', "3: covariance is a list of 1 rows of 1 numbers"),
        ('[calibrated]\nhardness = "-1 GPa"', "2: hardness is -1 GPa; it must be above 0 GPa"),
        ('[studies]\nrun = ["cencus"]', "2: run names 'cencus', which is no study. Did you mean 'census'?"),
        ('[studies]\nrun = ["census", "census"]', "2: run names 'census' twice"),
        ('[studies]\nrun = "census"', '2: run is a list of studies; write run = ["census"]'),
        ("[studies]\nseed = -1", "2: seed: a whole number from 0 upwards is expected"),
        ("[studies.census]\ndraw = 5", "2: study 'census' has no option 'draw'. Did you mean 'draws'?"),
        ("[studies.census]\ndraws = true", "2: study 'census': draws = true is no whole number"),
        ("[studies.census]\nshare = nan", "2: study 'census': share is not a finite number"),
        ('[studies.census]\nname = "x"', "2: study 'census' has no option 'name'."),
        ("[studies.senses]\ndraws = 5", "1: pin_wear has no study 'senses'. Did you mean 'census'?"),
        ('[units]\ndepth = "N"', "2: depth: 'N' is a force (N), expected a length (µm)"),
        ('[units]\ndpeth = "mm"', "2: pin_wear has no result or input 'dpeth'. Did you mean 'depth' (h, worn "),
        ("[units]\ndepth = 3", "2: depth: a text in quotation marks is expected"),
        ('[sheet]\nprojct = "x"', "2: the sheet has no entry 'projct'. Did you mean 'project'?"),
        ('[sheet]\ndetail = "long"', "2: detail: choose short, normal or full."),
        ("[sheet]\nproject = true", "2: project: a text in quotation marks is expected"),
        ('plugin = "gear"', "1: this file is for 'gear'; the calculation is 'pin_wear'"),
        ("plugin = 3", "1: plugin: a text in quotation marks is expected"),
    ],
)  # fmt: skip
def test_a_wrong_name_or_section(text: str, sentence: str) -> None:
    (found,) = faults(text + "\n")
    assert found.startswith(f"wear.toml:{sentence}")


COVARIANCE = '[effects.running_in]\nextra = "3 um"\nlength = "30 m"\ncovariance = '


@pytest.mark.parametrize(
    ("text", "sentences"),
    [
        ('[studies.census]\ndraws = 0\nof = ["nothing"]\nmethod = "plain"', [
            "2: study 'census': draws is at least 1", "3: study 'census': of names no result",
        ]),
        ("[studies]\ncensus = { draws = 0 }", ["2: study 'census': draws is at least 1"]),
        ('[studies.census]\nmethod = "quasi"\ndraws = 3', ["2: study 'census': quasi takes an even number of draws"]),
        ('[inputs]\n[effects.running_in]\nextra = "3 um"', [
            "2: effect 'running_in' is on, so its unknown 'length' must be given (from 10 to 5000 m)",
        ]),
        (f"{COVARIANCE}[[1, 0.5], [0.4, 1]]", ["4: covariance is not symmetric"]),
        (f"{COVARIANCE}[[1, 2], [2, 1]]", ["4: covariance holds a correlation beyond 1"]),
        (f"{COVARIANCE}[[1, nan], [nan, 1]]", ["4: covariance is a list of 2 rows of 2 numbers, "]),
        (f"{COVARIANCE}[[1, 0], [0]]", ["4: covariance is a list of 2 rows of 2 numbers, over extra [um], length [m]"]),
    ],
)  # fmt: skip
def test_what_does_not_go_together(text: str, sentences: list[str]) -> None:
    found = faults(text + "\n")
    assert len(found) == len(sentences)
    for said, sentence in zip(found, sentences, strict=True):
        assert said.startswith(f"wear.toml:{sentence}")


def test_a_broken_line_does_not_hide_that_a_file_is_named(folder: Path) -> None:
    """An input whose line cannot be read is not called missing as well."""
    assert [text.split(":")[1] for text in stage_faults("[inputs]\nsurface = {file = \n", folder)] == ["2"]


def test_a_bare_number_arrives_as_it_is() -> None:
    for number in (0.1, 1 / 3, 1e-300, 6.02214076e23, 123456.789012345):
        assert pin(f"[inputs]\nrate = {number!r}\n").inputs.rate == number
        assert pin(f'[inputs]\nrate = "{number!r}"\n').inputs.rate == number


# What ``--set`` and the settings of published numbers put in the place of the file.

SET_SURFACE = 'surface={ file = "flank.txt", spacing = "0.4 um" }'


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
    assert read_setup(path, PIN_OFFER, overrides=[*overrides[:2], "effects.warm_probe=off"]).effects == ()


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


def test_switches_counts_and_files_on_the_command_line(folder: Path) -> None:
    overrides = ["planets=5", "reading=printed", SET_SURFACE, "orders=[4]", 'profile=["1 um"]']
    for text, expected in (("true", True), ("false", False)):
        setup = stage("[inputs]\n", folder, f"is_hardened={text}", *overrides)
        assert setup.inputs.is_hardened is expected
    assert (setup.inputs.planets, setup.inputs.reading, setup.inputs.orders) == (5, "printed", (4,))
    assert setup.inputs.surface.heights == (1.0, 2.0, 4.0)


def test_an_option_of_a_data_file_on_the_command_line(folder: Path) -> None:
    for stated in (SURFACE, 'surface = "flank.txt"'):
        setup = stage(f"[inputs]\n{stated}\n", folder, 'surface.spacing="0.5 um"')
        assert (setup.inputs.surface.spacing, setup.inputs.surface.heights) == ("0.5 um", (1.0, 2.0, 4.0))
    for stated, option, words in [
        (SURFACE, "surface.spacng=1 um", "the reader takes no 'spacng'; beside file it takes: spacing, height_unit."),
        (SURFACE, "surface.file=none.txt", "there is no file 'none.txt'"),
        ("", "surface.spacing=1 um", "surface is read from a data file"),
    ]:
        (line,) = stage_faults(f"[inputs]\n{stated}\n", folder, option)
        assert line.startswith(f"--set {option}: surface")
        assert words in line


# The JSON Schema by which editors complete an inputs file.


def test_the_schema_is_valid_and_says_what_editors_need() -> None:
    schema = json_schema(STAGE_OFFER)
    Draft202012Validator.check_schema(schema)
    assert schema["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    inputs = schema["$defs"]["Inputs"]
    assert inputs["required"] == ["surface"]
    assert inputs["properties"]["bore_sun"]["default"] == "30 mm"
    assert inputs["properties"]["bore_sun"]["description"] == "d_1: bore, sun; above 0 mm"
    assert inputs["properties"]["reading"]["enum"] == ["printed", "complete"]
    assert inputs["properties"]["teeth_sun"]["minimum"] == 5
    assert inputs["properties"]["face_factor"]["description"] == "K_H: face load factor; at least 1; optional"
    validator = Draft202012Validator(schema)
    right = {"inputs": {"surface": {"file": "a"}, "teeth_sun": 7, "reading": "printed", "bore_sun": "3 mm"}}
    assert list(validator.iter_errors(right)) == []
    wrong = {"inputs": {"surface": 3, "teeth_sun": 4, "reading": "x", "bore_sun": 3, "planest": 3}, "nonsense": {}}
    assert len(list(validator.iter_errors(wrong))) == 6


def test_the_schema_of_studies_and_effects() -> None:
    schema = json_schema(PIN_OFFER)
    Draft202012Validator.check_schema(schema)
    json.dumps(schema, allow_nan=False)
    census = schema["$defs"]["Studies"]["properties"]["census"]["properties"]
    assert census["draws"] == {"type": "integer", "default": 1000}
    assert census["method"]["enum"] == ["plain", "quasi"]
    assert schema["$defs"]["Effect_running_in"]["required"] == ["extra", "length"]
    assert "required" not in schema["$defs"]["Effect_sensor_offset"]
    assert "time" not in schema["$defs"]["Conditions"]["properties"]
    assert schema["$defs"]["Tolerances"]["properties"]["hardness"]["default"] == "lognormal sd 6 %"


# Which line is blamed when what is stated describes something impossible.

SENTENCE = "the contact flows: load exceeds hardness times area"


def blamed(text: str, *overrides: str) -> str:
    """Return what is said of a file in which something impossible stands."""
    said = str(located(pin(text, *overrides), SENTENCE))
    assert said.endswith(f": {SENTENCE}")
    return said.removesuffix(f": {SENTENCE}")


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


def test_only_what_is_impossible_is_told_by_line() -> None:
    """Without a file there is none."""
    setup = pin('[inputs]\nload = "500 kN"\n')
    with pytest.raises(InputError, match=r"^wear\.toml:2: the contact flows"), told_by_line(setup):
        raise InfeasibleError(SENTENCE)
    with pytest.raises(ZeroDivisionError), told_by_line(setup):
        _ = 1 / 0
    assert str(located(default_setup(PIN_WEAR), SENTENCE)) == SENTENCE


# The commented inputs file that a newcomer starts from.

COMMENTED_OUT = re.compile(r"^# (?=\[|[\w\"]+ = )", re.MULTILINE)


def test_the_example_is_the_default_setup_and_what_is_commented_out_states_the_defaults_too() -> None:
    text = example_text(PIN_OFFER)
    assert not any(old in text for old in RENAMED)
    default = default_setup(PIN_WEAR, PIN_OFFER.origin)
    setup = pin(text, file="")
    assert setup.source.stated == set(PIN_WEAR.input_fields)
    assert replace(setup, source=InputsSource()) == default
    setup = pin(COMMENTED_OUT.sub("", text), file="")
    assert [on.effect.name for on in setup.effects] == ["running_in", "warm_probe"]
    assert setup.units == {"pressure": "MPa", "distance": "km", "depth": "um"}
    assert replace(setup, source=InputsSource(), effects=(), units={}) == default


def test_an_example_with_a_data_file_runs_once_the_file_is_named(tmp_path: Path) -> None:
    text = example_text(STAGE_OFFER)
    assert max(len(line) for line in text.splitlines()) <= 100
    (tmp_path / "surface.txt").write_text("1\n")
    named = text.replace('"surface.txt" }', '"surface.txt", spacing = "1 um" }')
    setup = setup_from_text(named, STAGE_OFFER, file="", folder=tmp_path)
    assert setup.inputs.surface.heights == (1.0,)
    assert (setup.inputs.planet.teeth, setup.inputs.planets, setup.inputs.reading) == (31, 3, "complete")
    assert setup.inputs.orders == (1, 2)
    for words in ('oil = "±5 K"', '"printed" or "complete"', "# face_factor = "):
        assert words in text
    everything = setup_from_text(COMMENTED_OUT.sub("", named), STAGE_OFFER, file="", folder=tmp_path)
    assert everything.spreads["oil"] == Band("5 K", "±")


@pytest.mark.parametrize("name", ["press_linkage", "roller_screw_shift"])
def test_what_the_head_of_a_sheet_may_hold_is_listed_to_be_filled_in(name: str, tmp_path: Path) -> None:
    """Without their marks all of its lines are read, and the example says what it said before."""
    offer = Kernel.installed().offer(name)
    text = text_to_fill_in(offer)
    known = {*HEAD, *OF_THE_SHEET}
    assert {line.lstrip("# ").partition(" =")[0] for line in text.split("\n")} >= known
    assert tomllib.loads(text) == tomllib.loads(example_text(offer))
    opened = re.sub(rf"^# (?=({'|'.join(known)}) = )", "", text, flags=re.MULTILINE)
    assert tomllib.loads(opened)["sheet"].keys() == known
    setup = setup_from_text(opened, offer, file=str(tmp_path / "in.toml"), folder=tmp_path)
    assert (setup.sheet.paper, setup.sheet.head["logo"], setup.sheet.head["style"]) == ("A4", "logo.svg", "house.css")
    assert (setup.sheet.units, setup.sheet.language) == ("SI", "en")


def test_a_shipped_example_is_handed_out_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "example.toml"
    path.write_bytes("# Ölprüfstand\n[inputs]\n".encode())
    offer = replace(PIN_OFFER, model=replace(PIN_WEAR, example=path))
    assert example_text(offer) == "# Ölprüfstand\n[inputs]\n"
    path.unlink()
    with pytest.raises(PluginError, match="the example of 'pin_wear' cannot be read"):
        example_text(offer)


# What is asked of a diagnosis in the inputs file: read, refused, written back, offered by the schema.

TEXT = """[studies.diagnose]
per_file = ["sensor_offset", "running_in.extra", "load"]
hold_out = "record = validation"
box = { probe_temperature = "15..40 degC", load = "0.05..0.2 kN", rate = "1e-8..5e-8", angle = "-90..90 deg" }
budget = 1500
at_least = { depth = "outcome = runout" }
at_most = { distance = "flag = 0" }
clipped = { depth = "..1 mm", pressure = "0..80 MPa", distance = "1 km.." }
lognormal = ["depth"]
"""


def test_the_options_in_si() -> None:
    options = pin(TEXT).diagnose
    assert options.per_file == ("sensor_offset", "running_in.extra", "load")
    assert options.held_out == ("record", "validation")
    assert set(options.box) == {"probe_temperature", "load", "rate", "angle"}
    assert options.box["probe_temperature"] == pytest.approx((288.15, 313.15))
    assert options.box["load"] == pytest.approx((50, 200))
    assert options.box["rate"] == pytest.approx((1e-8, 5e-8))
    assert options.box["angle"] == pytest.approx((-math.pi / 2, math.pi / 2))  # a condition of the kernel
    assert options.budget == 1500
    assert (options.at_least, options.at_most) == ({"depth": "outcome = runout"}, {"distance": "flag = 0"})
    assert options.flags == {"outcome", "flag"}
    assert options.clipped == {"depth": (-math.inf, 1e-3), "pressure": (0, 80e6), "distance": (1e3, math.inf)}
    assert options.lognormal == ("depth",)


def test_they_are_written_back_as_they_are_and_can_be_set_on_the_command_line() -> None:
    assert pin(complete_inputs(pin(TEXT))).diagnose == pin(TEXT).diagnose
    assert pin("").diagnose == DiagnoseOptions()
    assert DiagnoseOptions().held_out == ("", "")
    assert "[studies.diagnose]" not in complete_inputs(pin(""))
    setup = pin("", 'studies.diagnose.per_file=["load"]', "studies.diagnose.hold_out=run = b")
    assert setup.diagnose == DiagnoseOptions(per_file=("load",), hold_out="run = b")


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("per_fil = []", "study 'diagnose' has no option 'per_fil'. Did you mean 'per_file'?"),
        ('per_file = "load"', "study 'diagnose': per_file = 'load' is no list of names"),
        ('per_file = ["runing_in"]', "Did you mean 'running_in'?"),
        ('per_file = ["running_in.extras"]', "Did you mean 'running_in.extra'?"),
        ('per_file = ["load", "load"]', "per_file names 'load' twice"),
        ("hold_out = 3", "hold_out = 3 marks no rows"),
        ('hold_out = "validation"', "hold_out = 'validation' marks no rows; write a column and its word"),
        ("box = 3", "box = 3 is no table"),
        ("budget = -1", "budget = -1 is no number of calls; write budget = 1000"),
        ("budget = 1e3", "budget = 1000.0 is no number of calls"),
        ('box = { lod = "1..2 N" }', "box names 'lod', which is no condition and no number"),
        ('box = { load = "1 N" }', "box: load = '1 N' is no range; write load = \"0..10 N\""),
        ('box = { load = "1..2 mm" }', "expected a force"),
        ('box = { load = "2..1 N" }', "goes from its higher end; lower first"),
        ('box = { load = "-5..1 N" }', "load is -5 N; it must be above 0 N"),
        ("clipped = 3", 'clipped = 3 is no table; write clipped = { NAME = "..." }'),
        ('clipped = { dept = "0..5 um" }', "Did you mean 'depth'?"),
        ('clipped = { load = "0..5 N" }', "clipped names 'load', which is no result"),
        ('clipped = { depth = "0..5" }', "depth: '0' has no unit"),
        ('clipped = { depth = "..5" }', "depth: '5' has no unit"),
        ('clipped = { depth = ".." }', "clipped: depth = '..' is no range; write depth = \"0..10 um\""),
        ('at_least = "outcome = runout"', "at_least = 'outcome = runout' is no table; write at_least = { NAME ="),
        ('at_least = { depth = "runout" }', "at_least: depth = 'runout' marks no rows; write a column and its word"),
        ("at_most = { depth = true }", "at_most: depth = true marks no rows"),
        ('lognormal = "depth"', "lognormal = 'depth' is no list of names"),
        ('lognormal = ["load"]', "lognormal names 'load', which is no result"),
    ],
)
def test_what_cannot_be_asked(line: str, expected: str) -> None:
    (found,) = faults(f"[studies.diagnose]\n{line}\n")
    assert found.startswith("wear.toml:2: ")
    assert expected in found


@pytest.mark.parametrize(
    ("asked", "fits"),
    [
        ({"per_file": ["load"], "hold_out": "a = b", "box": {"load": "1..2 N"}}, True),
        ({}, True),
        ({"per_file": "load"}, False),
        ({"at_least": {"depth": "a = b"}, "clipped": {"depth": "..1 um"}, "lognormal": ["depth"]}, True),
        ({"lognormal": ["load"]}, False),
        ({"more": 1}, False),
    ],
)
def test_the_schema_offers_them(asked: dict[str, object], fits: bool) -> None:
    validator = Draft202012Validator(json_schema(PIN_OFFER))
    assert validator.is_valid({"studies": {"diagnose": asked}}) is fits
