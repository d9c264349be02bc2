"""Surfaces that the harmonic drive cannot read, what it says of poor ones, and files that it cannot write."""

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
def refused(refused_inputs: Refused) -> Refused:
    """Run the drive with lines under [inputs], which it must refuse."""

    def run(*lines: str, plugin: str = "harmonic_fractal", studies: str = "run = []") -> list[str]:
        return refused_inputs(plugin, *lines, studies=studies)

    return run


def matrix(rows: int = 2, points: int = 80) -> str:
    return "\n".join(",".join(f"{(7 * row + 3 * place) % 11}" for place in range(points)) for row in range(rows)) + "\n"


STATED = 'spacing = "0.4 um", height_unit = "um"'


@pytest.mark.parametrize(
    ("content", "options", "words"),
    [
        (matrix(), 'spacing = "0.4 um"', ["unit of the heights is not stated", 'height_unit = "um"']),
        (matrix().replace("5", "five", 1), STATED, ["line 1", "'five' is no number"]),
        (matrix(), f'{STATED}, direction = "z"', ["direction", "auto, x, y, both"]),
        (matrix(), f"{STATED}, smoothing = 3", ["smoothing"]),
    ],
)
def test_a_surface_that_cannot_be_read(
    refused: Refused, tmp_path: Path, content: str, options: str, words: list[str]
) -> None:
    (tmp_path / "flank.csv").write_text(content)
    (found,) = refused(f'surface = {{ file = "flank.csv"{", " if options else ""}{options} }}')
    assert found.startswith("inputs.toml:3: surface: ")
    for word in words:
        assert word in found


@pytest.mark.parametrize(
    ("file", "words"),
    [("nowhere.csv", ["nowhere.csv"]), (".", ["."]), ("inputs.toml", ["no line of the file holds numbers"])],
)
def test_a_file_that_is_none(refused: Refused, file: str, words: list[str]) -> None:
    (found,) = refused(f'surface = {{ file = "{file}", {STATED} }}')
    assert found.startswith("inputs.toml:3: surface: ")
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
    assert found.startswith("inputs.toml:3: surface: ")
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
    assert found.startswith(f"inputs.toml:3: {name}: ")


def heights(rows: int = 40, points: int = 400, dimension: float = 1.5, seed: int = 1) -> Array:
    """Lines of fractional Brownian motion, nm, 100 nm from point to point."""
    return brownian_profiles(dimension, 1e4, (rows, points), np.random.default_rng(seed))


def flank(folder: Path, z: Array, direction: str = "auto") -> Flank:
    """Write heights in nm as a text and read it as an inputs file would."""
    rows = [",".join("" if np.isnan(each) else f"{each:.6g}" for each in row) for row in z]
    (folder / "flank.csv").write_text("\n".join(rows) + "\n")
    return read_flank(folder / "flank.csv", spacing="0.4 um", height_unit="nm", direction=direction)


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


def test_a_study_is_named_once(refused: Refused) -> None:
    (found,) = refused('torque = "1 N*m"', studies='run = ["uncertainty"]\n[studies.uncertainty]\ndraws = 5')
    assert found == "inputs.toml:7: study 'uncertainty': draws = 5, but 20 to 100000 can be propagated"


@pytest.mark.parametrize(
    ("setting", "words"),
    [('file = "a/b.csv"', "plain name"), ('file = "flank.txt"', "ends in .csv"), ('height_unit = "km"', "um or nm")],
)
def test_a_file_that_cannot_be_written(refused: Refused, setting: str, words: str) -> None:
    study = f'run = ["flank_file"]\n[studies.flank_file]\n{setting}'
    (found,) = refused('width = "0 um"', plugin="harmonic_fractal.made_flank", studies=study)
    assert found.startswith(f"inputs.toml:7: study 'flank_file': {setting.split(' ')[0]} = ")
    assert words in found
