"""The harmonic drive refuses what cannot be, by name, file and line, with nothing written."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from harmonic_fractal.flank import Flank, read_flank
from harmonic_fractal.generators import Array, brownian_profiles
from shared import Calc

Refused = Callable[..., list[str]]
SURFACES = Path(__file__).parents[1] / "data" / "surfaces"
HEAD = "# spacing = 0.4 um\n# height_unit = um\n"


@pytest.fixture
def refused(calc: Calc, tmp_path: Path) -> Refused:
    """Run the drive with lines under [inputs]; it must end with exit code 2 and leave nothing behind."""

    def run(*lines: str, plugin: str = "harmonic_fractal", studies: str = "run = []") -> list[str]:
        text = "\n".join([f'plugin = "{plugin}"', "[inputs]", *lines, "[studies]", studies, ""])
        (tmp_path / "drive.toml").write_text(text, encoding="utf-8")
        before = sorted(tmp_path.iterdir())
        answer = calc("run", plugin, "--inputs", "drive.toml")
        assert answer.code == 2, answer
        assert answer.out == ""
        assert "Traceback" not in answer.err
        assert sorted(tmp_path.iterdir()) == before
        return answer.err.rstrip("\n").split("\n")

    return run


POSITIVE = {
    "sampling": "um", "longest_lag": "um", "youngs_modulus_flexspline": "GPa", "youngs_modulus_circular": "GPa",
    "hardness": "GPa", "pair_load": "N", "face_width": "mm", "flank_height": "mm", "patch_length": "mm",
    "pitch_radius": "mm", "reference_torque": "mN*m", "cup_radius": "mm", "cup_wall": "mm",
}  # fmt: skip


@pytest.mark.parametrize("value", ["0", "-1"])
def test_sizes_that_are_none(refused: Refused, value: str) -> None:
    found = refused(*(f'{name} = "{value} {unit}"' for name, unit in POSITIVE.items()))
    wanted = [f"{name} is {value} {unit}; it must be above 0 {unit}" for name, unit in POSITIVE.items()]
    assert found == [f"drive.toml:{place}: {text}" for place, text in enumerate(wanted, start=3)]


@pytest.mark.parametrize("value", ["nan", "inf", "-inf"])
def test_what_is_not_finite(refused: Refused, value: str) -> None:
    units = {**POSITIVE, "torque": "N*m"}
    found = refused(*(f'{name} = "{value} {unit}"' for name, unit in units.items()))
    for place, (name, text) in enumerate(zip(units, found, strict=True), start=3):
        assert text.startswith(f"drive.toml:{place}: ")
        assert name in text
        assert "not a finite number" in text


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("fractal_dimension = 2", "fractal_dimension is 2; it must be above 2"),
        ("fractal_dimension = 3", "fractal_dimension is 3; it must be below 3"),
        ("mating_dimension = 1.5", "mating_dimension is 1.5; it must be above 2"),
        ("density = 1", "density is 1; it must be above 1"),
        ("poisson_ratio_flexspline = 0.5", "poisson_ratio_flexspline is 0.5; it must be below 0.5"),
        ("poisson_ratio_circular = -0.1", "poisson_ratio_circular is -0.1; it must be at least 0"),
        ("engaged_pairs = 0", "engaged_pairs is 0; it must be at least 1"),
        ("flexspline_teeth = 19", "flexspline_teeth is 19; it must be at least 20"),
        ('pressure_angle = "60 deg"', "pressure_angle is 60 deg; it must be below 60 deg"),
        ('tooth_stiffness = "0 N/m"', "tooth_stiffness is 0 N/m; it must be above 0 N/m"),
        ('cup_length = "-1 mm"', "cup_length is -1 mm; it must be at least 0 mm"),
        ('drive_compliance = "-1 urad/(N*m)"', "drive_compliance is -1 urad/(N*m); it must be at least 0 urad/(N*m)"),
        ("engaged_factor = 0", "engaged_factor is 0; it must be above 0"),
        ("modulus_factor = 0", "modulus_factor is 0; it must be above 0"),
    ],
)
def test_a_number_outside_of_its_range(refused: Refused, line: str, sentence: str) -> None:
    assert refused(line) == [f"drive.toml:3: {sentence}"]


@pytest.mark.parametrize(
    ("line", "name", "words"),
    [
        ('convention = "mine"', "convention", "one_direction"),
        ('critical_rule = "yield"', "critical_rule", "yield_onset"),
        ('tip_rule = "loose"', "tip_rule", "scaled"),
        ('clearance_rule = "b"', "clearance_rule", "interference"),
        ('catalogue_size = "21"', "catalogue_size", "25"),
        ("engaged_pairs = 3.5", "engaged_pairs", "whole number"),
        ("engaged_pairs = true", "engaged_pairs", "number"),
        ('line_contact = "no"', "line_contact", "true"),
        ('torque = "25 N"', "torque", "force"),
        ('hardness = "306 HV"', "hardness", "HV"),
        ("torque = 25", "torque", 'write torque = "25 N*m"'),
        ("stiffness = 1e9", "stiffness", "is a result; it is calculated, not stated"),
        ("fractal_dimention = 2.4", "fractal_dimention", "Did you mean 'fractal_dimension'"),
        ('lags = "0 um"', "lags", "is a series"),
        ("surface = 3", "surface", "file"),
        ('surface = "flank.csv"', "surface", "there is no file 'flank.csv'"),
    ],
)
def test_what_is_no_such_value(refused: Refused, line: str, name: str, words: str) -> None:
    (found,) = refused(line)
    assert found.startswith("drive.toml:3: ")
    assert name in found
    assert words in found


@pytest.mark.parametrize(
    "lines",
    [
        ['fractal_roughness = "1e-11 m"'],
        ["mating_dimension = 2.4", 'mating_roughness = "1e-11 m"'],
    ],
)
def test_a_roughness_without_its_convention_means_nothing(refused: Refused, lines: list[str]) -> None:
    (found,) = refused(*lines)
    name = lines[-1].split(" ")[0]
    choices = "areal, one_direction, profile"
    assert found == (
        f"drive.toml:{2 + len(lines)}: {name} means nothing without convention; state convention ({choices}) beside it"
    )


@pytest.mark.parametrize("text", ["0 m", "-1e-11 m", "nan m", "1 m"])
def test_a_roughness_that_is_no_length_of_a_surface(refused: Refused, text: str) -> None:
    (found,) = refused('convention = "areal"', f'fractal_roughness = "{text}"')
    assert found.startswith("drive.toml:4: ")
    assert "fractal_roughness" in found


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        (["fractal_dimension = 2.04"], ["below 2.05", "fractal_dimension", "enlarge"]),
        (["fractal_dimension = 2.96"], ["above 2.95", "fractal_dimension", "reduce"]),
        (["dimension_deviation = 0.6"], ["above 2.95", "dimension_deviation"]),
        (["engaged_pairs = 201"], ["engaged", "teeth", "reduce engaged_pairs"]),
        (["engaged_factor = 4"], ["engaged", "engaged_factor"]),
        # the sum of both flanks needs lags between two limits
        (
            ['sampling = "20 um"', "mating_dimension = 2.4", 'mating_roughness = "1e-11 m"', 'convention = "areal"'],
            ["longest_lag", "sampling"],
        ),
        # 10 mm by 0.4 mm carry 4e-6 m2 times 3 GPa = 12 kN at most, and the rough contact much less than that
        (['pair_load = "100 kN"'], ["contact area exceeds the flank", "pair_load"]),
        (['torque = "100 kN*m"'], ["contact area exceeds the flank", "torque"]),
    ],
)
def test_a_drive_that_cannot_be(refused: Refused, lines: list[str], words: list[str]) -> None:
    (found,) = refused(*lines)
    assert found.startswith("drive.toml:")
    for word in words:
        assert word in found


def test_every_fault_is_named_at_once(refused: Refused) -> None:
    found = refused('hardness = "0 GPa"', "fractal_dimension = 3", 'tip_rule = "soft"', 'fractal_roughness = "1 nm"')
    assert sorted(line.split(": ")[0] for line in found) == [f"drive.toml:{place}" for place in (3, 4, 5, 6)]


def matrix(rows: int = 2, points: int = 80) -> str:
    return "\n".join(",".join(f"{(7 * row + 3 * place) % 11}" for place in range(points)) for row in range(rows)) + "\n"


STATED = 'spacing = "0.4 um", height_unit = "um"'


@pytest.mark.parametrize(
    ("content", "options", "words"),
    [
        (matrix(), 'spacing = "0.4 um"', ["unit of the heights is not stated", 'height_unit = "um"']),
        (matrix(), 'spacing = "0.4 um", height_unit = "rad"', ["'rad' is no length", "the length of one count"]),
        (matrix(), 'spacing = "0.4 um", height_unit = "counts"', ["'counts' is no length", "one count"]),
        (matrix(), 'height_unit = "um"', ["spacing of the points is not stated", 'spacing = "0.4 um"']),
        (matrix(), 'spacing_x = "0.4 um", height_unit = "um"', ["spacing of the rows", "spacing_y"]),
        (matrix(), 'spacing = 0.4, height_unit = "um"', ["spacing = 0.4 needs its unit"]),
        (matrix(), 'spacing = "0 um", height_unit = "um"', ["spacing", "above 0"]),
        (matrix(), 'spacing = "-1 um", height_unit = "um"', ["spacing", "above 0"]),
        (matrix(), 'spacing = "nan um", height_unit = "um"', ["spacing", "finite"]),
        (matrix(), 'spacing = "0.4 N", height_unit = "um"', ["spacing", "force"]),
        (matrix(points=63), STATED, ["63 points", "64 or more"]),
        (matrix().replace("\n", ",\n", 1), STATED, ["line 2", "81"]),
        (matrix().replace("5", "five", 1), STATED, ["line 1", "'five' is no number"]),
        ("five" + matrix()[1:], STATED, ["line 1: 'five' is no number", "skip_lines = 1"]),
        (matrix().replace("5", "inf", 1), STATED, ["line 1", "infinite"]),
        ("", STATED, ["empty"]),
        ("height of a flank\n", STATED, ["no line of the file holds numbers"]),
        ("x [um];z [um]\n0;1\n1;2\n2,5;3\n", "", ["spacing of x is unequal", "resample"]),
        ("x [um];z [um]\n0;1\n1;2\n1;3\n", "", ["two points have x"]),
        ("x [um];z [rad]\n0;1\n1;2\n2;3\n", "", ["'rad' is no length"]),
        ("x;z [um]\n0;1\n1;2\n2;3\n", "", ["column x has no unit"]),
        ("0;1\n1;2\n2;3\n3;4\n", STATED, ["2 columns without names", "columns ="]),
        (matrix(), f'{STATED}, form = "sphere"', ["form", "second_order, plane, none"]),
        (matrix(), f'{STATED}, direction = "z"', ["direction", "auto, x, y, both"]),
        (matrix(), f'{STATED}, spikes = "off"', ["spikes", "remove, keep"]),
        (matrix(), f'{STATED}, method = "mean"', ["method", "per_line"]),
        (matrix(), f"{STATED}, noise_aware = 1", ["noise_aware", "true or false"]),
        (matrix(), f'{STATED}, rectangle = ["1 mm", "1 mm"]', ["rectangle leaves the surface", "31.6 um"]),
        (matrix(), f'{STATED}, corner = ["1 um", "1 um"]', ["corner needs rectangle"]),
        (matrix(), f'{STATED}, shortest_lag = "9 um", longest_lag = "1 um"', ["longest_lag", "above shortest_lag"]),
        (matrix(), f"{STATED}, skip_lines = -1", ["skip_lines", "whole number"]),
        (matrix(), f"{STATED}, spacing_x = '1 um'", ["leave out spacing_x"]),
        (matrix(1), f'{STATED}, direction = "y"', ["one profile", "direction"]),
        (matrix(), f"{STATED}, smoothing = 3", ["smoothing"]),
    ],
)  # fmt: skip
def test_a_surface_that_cannot_be_read(
    refused: Refused, tmp_path: Path, content: str, options: str, words: list[str]
) -> None:
    (tmp_path / "flank.csv").write_text(content)
    (found,) = refused(f'surface = {{ file = "flank.csv"{", " if options else ""}{options} }}')
    assert found.startswith("drive.toml:3: surface: ")
    for word in words:
        assert word in found


@pytest.mark.parametrize(
    ("file", "words"),
    [("nowhere.csv", ["nowhere.csv"]), (".", ["."]), ("drive.toml", ["no line of the file holds numbers"])],
)
def test_a_file_that_is_none(refused: Refused, file: str, words: list[str]) -> None:
    (found,) = refused(f'surface = {{ file = "{file}", {STATED} }}')
    assert found.startswith("drive.toml:3: surface: ")
    for word in words:
        assert word in found


HOSTILE = "<script>alert(1)</script>, {{7*7}}, [a](javascript:b), =cmd()|'x'!A0, \x1b[31mred\n"


def test_hostile_text_is_named_and_not_obeyed(refused: Refused, tmp_path: Path) -> None:
    (tmp_path / "flank.csv").write_text(HEAD + matrix().replace("5", "<script>alert(1)</script>", 1))
    (found,) = refused('surface = { file = "flank.csv" }')
    assert "'<script>alert(1)</script>' is no number" in found
    (tmp_path / "flank.csv").write_text(HOSTILE)
    (found,) = refused(f'surface = {{ file = "flank.csv", {STATED} }}')
    assert "\x1b" not in found


def test_bytes_that_are_no_text_and_no_format(refused: Refused, tmp_path: Path) -> None:
    (tmp_path / "flank.csv").write_bytes(bytes(range(256)) * 40)
    (found,) = refused(f'surface = {{ file = "flank.csv", {STATED} }}')
    assert found.startswith("drive.toml:3: surface: ")
    assert "SurfaceTopography" in found
    assert len(found) < 500


def test_without_the_extra_a_profilometer_file_says_what_to_install(
    refused: Refused, calc: Calc, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Texts are read all the same."""
    monkeypatch.setitem(sys.modules, "SurfaceTopography", None)
    binary = (SURFACES / "al3d-1.al3d").as_posix()
    (found,) = refused(f'surface = {{ file = "{binary}" }}')
    assert "pip install 'truing[surfaces]'" in found
    assert "or export the heights as text" in found
    (tmp_path / "text.toml").write_text(
        f'[inputs]\nsurface = {{ file = "{(SURFACES / "hfm-1.hfm").as_posix()}" }}\n[studies]\nrun = []\n'
    )
    (tmp_path / "rows.csv").write_text("torque [N*m]\n25\n")
    answer = calc("table", "harmonic_fractal", "--inputs", "text.toml", "--rows", "rows.csv")
    assert answer.code == 0, answer.err
    assert answer.out.count("\n") == 2


@pytest.mark.parametrize("name", ["surface", "mating_surface"])
def test_the_fault_names_the_flank_whose_file_it_is(refused: Refused, tmp_path: Path, name: str) -> None:
    (tmp_path / "flank.csv").write_text(matrix())
    (found,) = refused(f'{name} = {{ file = "flank.csv", spacing = "0.4 um" }}')
    assert found.startswith(f"drive.toml:3: {name}: ")


def heights(rows: int = 40, points: int = 400, dimension: float = 1.5, seed: int = 1) -> Array:
    """Lines of fractional Brownian motion, nm, 100 nm from point to point."""
    return brownian_profiles(dimension, 1e4, (rows, points), np.random.default_rng(seed))


def flank(folder: Path, z: Array, direction: str = "auto") -> Flank:
    """Write heights in nm as a text and read it as an inputs file would."""
    rows = [",".join("" if np.isnan(each) else f"{each:.6g}" for each in row) for row in z]
    (folder / "flank.csv").write_text("\n".join(rows) + "\n")
    return read_flank(folder / "flank.csv", spacing="0.4 um", height_unit="nm", direction=direction)


def missing(share: float) -> Array:
    z = heights()
    z.ravel()[np.random.default_rng(2).permutation(z.size)[: round(share * z.size)]] = np.nan
    return z


def test_a_fifth_missing_is_too_much_and_a_twentieth_is_said(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"21\.0% of the points are missing, more than 20%: cut another rectangle"):
        flank(tmp_path, missing(0.21))
    assert any("of the points are missing, more than 5%" in text for text in flank(tmp_path, missing(0.06)).warnings)
    assert not any("missing" in text for text in flank(tmp_path, missing(0.04)).warnings)


def test_spikes_beyond_a_fiftieth_are_said(tmp_path: Path) -> None:
    z = heights()
    places = np.random.default_rng(3).permutation(z.size)[: round(0.03 * z.size)]
    z.ravel()[places] += 2000.0
    assert any("of the points are spikes, more than 2%" in text for text in flank(tmp_path, z).warnings)
    assert not any("spikes" in text for text in flank(tmp_path, heights()).warnings)


def test_steps_coarser_than_the_roughness_are_said(tmp_path: Path) -> None:
    coarse = 500.0 * np.round(heights() / 500.0)
    (said,) = (text for text in flank(tmp_path, coarse).warnings if "steps" in text and "along x" in text)
    assert "steps of 500 nm" in said


NO_RANGE = "no self-affine range"
LONG = np.linspace(0.0, 1.0, 400)


@pytest.mark.parametrize(
    ("z", "words"),
    [
        pytest.param(np.random.default_rng(4).normal(0, 50, (40, 400)), NO_RANGE, id="white noise: slope 0"),
        pytest.param(300 * np.sin(2 * np.pi * LONG + np.arange(40)[:, None]), NO_RANGE, id="one long wave: slope 2"),
        pytest.param(heights(rows=1, points=108), "less than a decade", id="less than a decade of lags"),
        pytest.param(np.concatenate([heights(40, 200), np.full((40, 200), 0.0)], axis=1)
                     + 400 * np.sin(2 * np.pi * 40 * LONG), NO_RANGE, id="chatter"),
    ],
)  # fmt: skip
def test_what_has_no_range_is_refused_with_its_slopes(tmp_path: Path, z: Array, words: str) -> None:
    found = flank(tmp_path, z, direction="x")
    assert found.chosen is None
    assert words in found.reason
    assert len(found.resampled) == 0
    assert len(found.estimates[0].local_dimensions) >= 3


def test_directions_that_differ_are_said(tmp_path: Path) -> None:
    """Brownian lines that know nothing of one another: 1.3 along the lines, and white noise across them."""
    ridges = heights(400, 400, 1.3)[:, :1] * 0 + np.cumsum(np.random.default_rng(5).normal(0, 20, (400, 1)), axis=0)
    found = flank(tmp_path, heights(400, 400, 1.2) + ridges)
    assert any("anisotropic" in text or "alone is used" in text for text in found.warnings)
    assert found.chosen in {"x", "y", None}


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        (["fractal_dimension = 2.01"], "2.05"),
        (['length = "20 um"'], "fewer than 64 points"),
        (['length = "10 mm"', 'width = "10 mm"'], "more than 4000000 points"),
        (['longest_wave = "1 nm"'], "shortest wave"),
        (["directions = 0"], "directions"),
        (["seed = -1"], "seed"),
        (['spikes = "60 %"'], "spikes"),
        (['fractal_roughness = "1e-9 m"'], "convention"),
        (['kind = "cantor"'], "brownian"),
    ],
)
def test_a_flank_that_cannot_be_made(refused: Refused, lines: list[str], words: str) -> None:
    (found,) = refused(*lines, plugin="harmonic_fractal.made_flank")
    assert found.startswith("drive.toml:")
    assert words in found


def test_a_study_is_named_once(refused: Refused) -> None:
    (found,) = refused('torque = "1 N*m"', studies='run = ["uncertainty"]\n[studies.uncertainty]\ndraws = 5')
    assert found == "drive.toml:7: study 'uncertainty': draws = 5, but 20 to 100000 can be propagated"


@pytest.mark.parametrize(
    ("setting", "words"),
    [('file = "a/b.csv"', "plain name"), ('file = "flank.txt"', "ends in .csv"), ('height_unit = "km"', "um or nm")],
)
def test_a_file_that_cannot_be_written(refused: Refused, setting: str, words: str) -> None:
    study = f'run = ["flank_file"]\n[studies.flank_file]\n{setting}'
    (found,) = refused('width = "0 um"', plugin="harmonic_fractal.made_flank", studies=study)
    assert found.startswith(f"drive.toml:7: study 'flank_file': {setting.split(' ')[0]} = ")
    assert words in found
