"""Surfaces that the harmonic drive cannot read, what it says of poor ones, and files that it cannot write."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

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
