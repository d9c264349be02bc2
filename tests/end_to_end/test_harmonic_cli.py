"""The harmonic drive through the command line: the example, a measured surface, rows and a diagnosis.

What it calculates is tested in tests/published and in tests/unit, on the model.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from measured import Document, calc_here, documented

import truing
from harmonic_fractal.structure import structure_function
from shared import Calc

SURFACES = Path(__file__).parents[1] / "data" / "surfaces"
Table = Callable[..., list[dict[str, float]]]


@dataclass(frozen=True)
class Ran:
    """What a run left: exit code, what was printed, results.json and sheet.md."""

    code: int
    said: str
    found: dict[str, Any]
    sheet: str


def ran(folder: Path, *words: str | Path) -> Ran:
    """Run a command in this process and read its folder."""
    answer = calc_here(folder.parent, *words, "-o", folder, "-q")
    document = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    return Ran(answer.code, answer.out + answer.err, document, (folder / "sheet.md").read_text(encoding="utf-8"))


def value(run: Ran, name: str) -> float:
    return float(run.found["results"][name]["value"])


@pytest.fixture(scope="module")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("harmonic")


@pytest.fixture(scope="module")
def example(desk: Path) -> Ran:
    """The shipped example, with fewer draws."""
    assert calc_here(desk, "init", "harmonic_fractal", "-o", "drive.toml", "-q").code == 0
    few = ("--set", "studies.reliability.draws=2000")
    return ran(desk / "example", "run", "harmonic_fractal", "--inputs", desk / "drive.toml", *few)


@pytest.fixture(scope="module")
def refused(desk: Path) -> Ran:
    """A run on a measured profile that is not self-affine."""
    inputs = desk / "profile.toml"
    file = (SURFACES / "hfm-1.hfm").as_posix()
    text = f'plugin = "harmonic_fractal"\n[inputs]\nsurface = {{ file = "{file}" }}\n[studies]\nrun = ["validity"]\n'
    inputs.write_text(text, encoding="utf-8")
    return ran(desk / "profile", "run", "harmonic_fractal", "--inputs", inputs)


def test_the_example_runs_and_keeps_its_limits(example: Ran) -> None:
    assert example.code == 0, example.said
    assert value(example, "stiffness") == pytest.approx(1.95e9, rel=1e-3)  # by quadrature, 25 N, D = 2.4, G = 1e-11 m
    assert value(example, "equivalent_modulus") == pytest.approx(113.19, rel=1e-4)
    assert value(example, "catalogue_torsion") == pytest.approx(7.0 / 1.6e4 * 1e6 + 18.0 / 2.5e4 * 1e6)
    assert value(example, "rough_share") < 1.0  # per cent
    assert all(check["passed"] for check in example.found["checks"])
    assert "<img" not in example.sheet
    assert any("extrapolated below resolution" in text for text in example.found["warnings"])


def test_a_surface_that_is_not_self_affine_is_refused_with_its_slopes(refused: Ran, example: Ran) -> None:
    assert refused.code == 1
    assert value(refused, "surface_accepted") == 0
    (check,) = (each for each in refused.found["checks"] if each["name"] == "surface_accepted")
    assert check["passed"] is False
    assert "1 of" in refused.said
    assert "surface_accepted" in refused.said
    warnings = refused.found["warnings"]
    assert any("surface is refused" in text and "no self-affine range" in text for text in warnings)
    assert "hfm-1.hfm: local slopes" in refused.sheet
    (found,) = refused.found["studies"]["validity"]["flanks"]["surface"]["directions"].values()
    assert found["r_squared"] > 0.92
    assert found["accepted"] is False
    assert max(found["local_dimensions"]) - min(found["local_dimensions"]) > 0.6
    for slope in found["local_dimensions"]:
        assert f"{slope:.5g}" in refused.sheet
    assert str(SURFACES) not in refused.sheet  # no trace of this machine
    for name in ("dimension", "roughness", "stiffness", "torsion"):  # what is stated stands for what is refused
        assert value(refused, name) == pytest.approx(value(example, name), rel=1e-12)


@pytest.fixture
def table(tabled: Table) -> Table:
    """Print results of the plugin row by row for a CSV of inputs."""
    return partial(tabled, "harmonic_fractal")


def test_a_column_of_lags_is_calculated_just_there(table: Table) -> None:
    """Far from the lags that are shown by default and between them: no straight line between points."""
    lags = [0.05, 0.5, 3.3, 77.0]
    rows = table("lag [um]\n" + "\n".join(map(str, lags)) + "\n")
    exact = structure_function(np.array(lags) * 1e-6, 1.4, 1e-11) * 1e12
    assert [row["structure_function"] for row in rows] == pytest.approx(list(exact), rel=1e-9)


@pytest.fixture(scope="module")
def diagnosed(desk: Path) -> Document:
    """A structure function with 12 nm of white noise in every height, measured at lags of its own."""
    rng = np.random.default_rng(11)
    lags = np.geomspace(0.4, 20.0, 40)
    clean = structure_function(lags * 1e-6, 1.4, 1e-11) * 1e12
    seen = (clean + 2 * 0.012**2) * (1 + 0.01 * rng.standard_normal(len(lags)))
    rows = "\n".join(f"{lag:.17g},{height:.17g}" for lag, height in zip(lags, seen, strict=True))
    (desk / "instrument.csv").write_text(f"lag [um],structure_function [um^2]\n{rows}\n")
    (desk / "instrument.toml").write_text('plugin = "harmonic_fractal"\n[tolerances]\nhardness = "off"\n')
    return documented(desk, "harmonic_fractal", "instrument.csv", inputs="instrument.toml")


def test_noise_of_the_instrument_is_named_from_its_structure_function(diagnosed: Document) -> None:
    found = diagnosed
    assert found["rows"] == 40
    assert found["verdict"] in {"named", "one_of"}
    (cause,) = found["causes"]
    assert {cause["effect"], *cause["same_as"]} == {"sensor_offset", "instrument_noise"}
    (unknown,) = cause["unknowns"].values()
    true = 2 * 0.012**2 if cause["effect"] == "sensor_offset" else 144.0  # um^2, or nm^2
    low, high = unknown["interval95"]
    assert low <= true <= high
    assert unknown["value"] == pytest.approx(true, rel=0.03)


@pytest.mark.parametrize(
    ("lines", "lacking", "reason"),
    [
        # the first contact turns elastic at 2.3 and 4.2 mN m, above the 1 mN m from which the torsion counts
        (
            ["fractal_dimension = 2.444", 'fractal_roughness = "3.3421e-10 m"'],
            [
                "torsion",
                "rough_torsion",
                "mesh_torsion",
                "approach",
                "closing_clearance",
                "free_play",
                "rough_share",
                "catalogue_ratio",
            ],
            "raise reference_torque above plastic_torque",
        ),
        # the catalogues print 30 as the ratio of sizes up to 32
        (
            ['catalogue_size = "40"', "flexspline_teeth = 60", "engaged_pairs = 18"],
            ["catalogue_torsion", "catalogue_stiffness", "rough_share", "catalogue_ratio"],
            "print no size 40",
        ),
    ],
)
def test_the_pair_is_answered_and_what_does_not_exist_says_why(
    tmp_path: Path, lines: list[str], lacking: list[str], reason: str
) -> None:
    file = tmp_path / "drive.toml"
    text = ['plugin = "harmonic_fractal"', "[inputs]", 'convention = "areal"', *lines]
    studies = ["[studies]", 'run = ["sensitivity", "reliability", "sweep"]']
    file.write_text("\n".join([*text, *studies, "[studies.reliability]", "draws = 100"]), encoding="utf-8")
    raised = tmp_path / "raised.toml"
    raised.write_text("\n".join([*text, 'reference_torque = "20 mN*m"', "[studies]", "run = []"]), encoding="utf-8")
    found = ran(tmp_path / "drive", "run", "harmonic_fractal", "--inputs", file)
    other = truing.load("harmonic_fractal").run(raised).document["results"]
    assert found.code == 0
    results = found.found["results"]
    assert sorted(name for name, result in results.items() if result["value"] is None) == sorted(lacking)
    assert all(reason in results[name]["reason"] for name in lacking)
    for name in ("stiffness", "clearance", "mesh_stiffness"):
        assert value(found, name) == other[name]["value"] > 0
    assert reason in found.said
    assert found.sheet.count(reason.replace("_", "\\_")) >= len(lacking)


def test_a_case_and_a_row_that_lack_the_torsion_keep_the_rest(calc: Calc, tmp_path: Path) -> None:
    (tmp_path / "drive.toml").write_text(
        'plugin = "harmonic_fractal"\n[inputs]\nconvention = "areal"\n[studies]\nrun = []\n', encoding="utf-8"
    )
    (tmp_path / "rows.csv").write_text("fractal_roughness [m]\n1e-11\n1e-8\n", encoding="utf-8")
    found = truing.load("harmonic_fractal").run(tmp_path / "drive.toml", cases=tmp_path / "rows.csv").document
    fine, rough = (case["results"] for case in found["cases"])
    assert fine["torsion"]["value"] > 0
    assert (rough["torsion"]["value"], "reference_torque" in rough["torsion"]["reason"]) == (None, True)
    assert 0 < rough["stiffness"]["value"] < fine["stiffness"]["value"]
    shown = calc("table", "harmonic_fractal", "--inputs", "drive.toml", "--rows", "rows.csv")
    table = list(csv.DictReader(io.StringIO(shown.out)))
    assert (table[1]["torsion [urad]"], float(table[1]["stiffness [N/m]"])) == ("", rough["stiffness"]["value"])
    assert "rows.csv:3: no approach, closing_clearance, free_play, mesh_torsion, torsion" in shown.err
