"""The harmonic drive through the command line: the example, four measured surfaces, made ones, rows and a diagnosis."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from harmonic_fractal.structure import structure_function
from shared import Calc
from truing.cli import main

SURFACES = Path(__file__).parents[1] / "data" / "surfaces"
OPTIONS = {"matrix-4.txt": 'spacing = "0.369862 um", height_unit = "2.91818e-8 m"'}
BINARY = (".al3d", ".dat")
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
    said = io.StringIO()
    with redirect_stdout(said), redirect_stderr(said):
        code = main([*map(str, words), "-o", str(folder), "-q"])
    document = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    return Ran(code, said.getvalue(), document, (folder / "sheet.md").read_text(encoding="utf-8"))


def value(run: Ran, name: str) -> float:
    return float(run.found["results"][name]["value"])


@pytest.fixture(scope="module")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("harmonic")


@pytest.fixture(scope="module")
def example(desk: Path) -> Ran:
    """The shipped example, with fewer draws."""
    assert main(["init", "harmonic_fractal", "-o", str(desk / "drive.toml"), "-q"]) == 0
    few = ("--set", "studies.reliability.draws=2000")
    return ran(desk / "example", "run", "harmonic_fractal", "--inputs", desk / "drive.toml", *few)


@pytest.fixture(scope="module")
def measured(desk: Path) -> Callable[[str], Ran]:
    """A run on one of the four measured surfaces, once each."""
    done: dict[str, Ran] = {}

    def run(file: str) -> Ran:
        if file.endswith(BINARY):
            pytest.importorskip("SurfaceTopography")
        if file not in done:
            more = f", {OPTIONS[file]}" if file in OPTIONS else ""
            path = (SURFACES / file).as_posix()
            inputs = desk / f"{Path(file).stem}.toml"
            inputs.write_text(
                f'plugin = "harmonic_fractal"\n[inputs]\nsurface = {{ file = "{path}"{more} }}\n'
                '[studies]\nrun = ["validity"]\n'
            )
            done[file] = ran(desk / Path(file).stem, "run", "harmonic_fractal", "--inputs", inputs)
        return done[file]

    return run


def directions(run: Ran) -> dict[str, Any]:
    return dict(run.found["studies"]["validity"]["flanks"]["surface"]["directions"])


def test_the_example_runs_and_keeps_its_limits(example: Ran) -> None:
    assert example.code == 0, example.said
    assert value(example, "stiffness") == pytest.approx(1.95e9, rel=1e-3)  # by quadrature, 25 N, D = 2.4, G = 1e-11 m
    assert value(example, "equivalent_modulus") == pytest.approx(113.19, rel=1e-4)
    assert value(example, "catalogue_torsion") == pytest.approx(7.0 / 1.6e4 * 1e6 + 18.0 / 2.5e4 * 1e6)
    assert value(example, "rough_share") < 1.0  # per cent
    assert all(check["passed"] for check in example.found["checks"])
    assert "<img" not in example.sheet


def test_the_example_says_where_it_extrapolates(example: Ran) -> None:
    assert any("extrapolated below resolution" in text for text in example.found["warnings"])


REFUSED = {"al3d-1.al3d": ("x", "y"), "hfm-1.hfm": ("x",)}


@pytest.mark.parametrize("file", REFUSED)
def test_a_surface_that_is_not_self_affine_is_refused_with_its_slopes(
    measured: Callable[[str], Ran], file: str
) -> None:
    run = measured(file)
    assert run.code == 1
    assert value(run, "surface_accepted") == 0
    (check,) = (each for each in run.found["checks"] if each["name"] == "surface_accepted")
    assert check["passed"] is False
    assert "1 of" in run.said
    assert "surface_accepted" in run.said
    assert any("surface is refused" in text and "no self-affine range" in text for text in run.found["warnings"])
    assert f"{file}: local slopes" in run.sheet
    assert set(directions(run)) == set(REFUSED[file])
    for found in directions(run).values():
        assert found["r_squared"] > 0.92
        assert found["accepted"] is False
        assert max(found["local_dimensions"]) - min(found["local_dimensions"]) > 0.6
        for slope in found["local_dimensions"]:
            assert f"{slope:.5g}" in run.sheet


@pytest.mark.parametrize("file", REFUSED)
def test_what_is_stated_stands_for_a_refused_surface(measured: Callable[[str], Ran], example: Ran, file: str) -> None:
    run = measured(file)
    for name in ("dimension", "roughness", "stiffness", "torsion"):
        assert value(run, name) == pytest.approx(value(example, name), rel=1e-12)


def test_a_surface_with_a_lay_is_taken_along_the_one_direction_that_has_a_range(measured: Callable[[str], Ran]) -> None:
    run = measured("matrix-4.txt")
    assert run.code == 0, run.said
    assert value(run, "surface_accepted") == 1
    found = directions(run)
    assert run.found["studies"]["validity"]["flanks"]["surface"]["chosen"] == "y"
    assert found["y"]["accepted"] is True
    assert found["x"]["accepted"] is False
    assert found["x"]["r_squared"] > found["y"]["r_squared"]
    low, high = found["y"]["range"]["values"]
    assert high / low >= 10
    assert value(run, "profile_dimension") == pytest.approx(1.803, abs=0.005)  # independent, spikes kept
    assert value(run, "profile_dimension") == found["y"]["profile_dimension"]
    assert any("the direction y alone is used; along x: no self-affine range" in text for text in run.found["warnings"])


def test_a_surface_in_counts_has_its_scale(measured: Callable[[str], Ran]) -> None:
    run = measured("metropro-1.dat")
    assert run.code in {0, 1}
    heights = run.found["studies"]["validity"]["flanks"]["surface"]["sq"]
    assert heights["raw"] == pytest.approx(0.07529, rel=5e-3)
    assert heights["plane"] == pytest.approx(0.01333, rel=5e-3)
    assert value(run, "surface_accepted") == float(run.code == 0)


def test_no_surface_leaves_a_trace_of_this_machine(measured: Callable[[str], Ran]) -> None:
    run = measured("matrix-4.txt")
    assert str(SURFACES) not in run.sheet


TRUTH = """plugin = "harmonic_fractal.made_flank"
[inputs]
kind = "brownian"
fractal_dimension = 2.4
fractal_roughness = "1e-11 m"
convention = "areal"
length = "160 um"
width = "40 um"
spacing = "0.4 um"
seed = {seed}
"""


@pytest.fixture(scope="module")
def made(desk: Path) -> Ran:
    """One made flank, written."""
    (desk / "truth.toml").write_text(TRUTH.format(seed=3))
    return ran(desk / "made", "run", "harmonic_fractal.made_flank", "--inputs", desk / "truth.toml")


@pytest.fixture(scope="module")
def both(desk: Path, made: Ran) -> Ran:
    """Made flank against made flank."""
    assert made.code == 0
    pair = 'surface = { file = "made/flank.csv" }\nmating_surface = { file = "made/flank.csv" }\n'
    (desk / "both.toml").write_text(f'plugin = "harmonic_fractal"\n[inputs]\n{pair}[studies]\nrun = ["validity"]\n')
    return ran(desk / "both", "run", "harmonic_fractal", "--inputs", desk / "both.toml")


def test_a_made_flank_is_written_and_read_back(desk: Path, made: Ran, both: Ran) -> None:
    lines = (desk / "made" / "flank.csv").read_text(encoding="utf-8").splitlines()
    head = [line for line in lines if line.startswith("#")]
    assert "# height_unit = um" in head
    assert len(lines) - len(head) == value(made, "lines") == 101
    assert {len(line.split(",")) for line in lines[len(head) :]} == {401}
    again = directions(both)["x"]
    assert again["accepted"] is True
    assert 1 + again["profile_dimension"] == pytest.approx(2.4, abs=0.08)
    assert value(made, "accepted") == 1
    assert abs(value(made, "dimension_error")) < 0.08


def test_two_flanks_add_their_roughness(desk: Path, both: Ran) -> None:
    """Alike, they are one flank of 2^(1/(2(D-2))) the roughness and twice the structure function."""
    assert both.code == 0, both.said
    dimension = value(both, "dimension")
    used = both.found["studies"]["validity"]["flanks"]["surface"]
    single = used["directions"][used["chosen"]]
    assert dimension - 1 == pytest.approx(single["profile_dimension"], rel=1e-9)
    ratio = value(both, "roughness") / single["roughness"]["value"]
    assert ratio == pytest.approx(2 ** (1 / (2 * (dimension - 2))), rel=1e-6)


def test_a_roughness_without_its_convention_is_refused(calc: Calc, tmp_path: Path) -> None:
    (tmp_path / "drive.toml").write_text('plugin = "harmonic_fractal"\n[inputs]\nfractal_roughness = "1e-11 m"\n')
    answer = calc("run", "harmonic_fractal", "--inputs", "drive.toml")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.startswith("drive.toml:3: fractal_roughness means nothing without convention; state convention")
    assert [path.name for path in tmp_path.iterdir()] == ["drive.toml"]


@pytest.fixture
def table(tabled: Table) -> Table:
    """Print results of the plugin row by row for a CSV of inputs."""
    return partial(tabled, "harmonic_fractal")


@pytest.mark.parametrize(("convention", "areal"), [("areal", 1.0), ("one_direction", 1.891), ("profile", 5.844)])
def test_every_convention_arrives_as_the_areal_one(table: Table, convention: str, areal: float) -> None:
    """At D_s = 1.4 and density 1.5, by hand from the constants."""
    rough = ("fractal_dimension=2.4", "fractal_roughness=1e-12 m", f"convention={convention}")
    (row,) = table("torque [N*m]\n10\n", *rough)
    assert row["roughness"] == pytest.approx(areal * 1e-12, rel=1e-3)


def test_a_column_of_lags_is_calculated_just_there(table: Table) -> None:
    """Far from the lags that are shown by default and between them: no straight line between points."""
    lags = [0.05, 0.5, 3.3, 77.0]
    rows = table("lag [um]\n" + "\n".join(map(str, lags)) + "\n")
    exact = structure_function(np.array(lags) * 1e-6, 1.4, 1e-11) * 1e12
    assert [row["structure_function"] for row in rows] == pytest.approx(list(exact), rel=1e-9)


def test_torsion_is_odd_and_none_below_its_reference(table: Table) -> None:
    back, idle, little, forth = table("torque [N*m]\n-25\n0\n0.0005\n25\n", "drive_compliance=40 urad/(N*m)")
    assert forth["torsion"] == pytest.approx(-back["torsion"], rel=1e-12)
    assert idle["torsion"] == little["torsion"] == 0
    assert forth["torsion"] == pytest.approx(forth["rough_torsion"] + 40 * (25 - 0.001), rel=1e-9)


def test_a_batch_of_loads_is_stiffer_the_larger(table: Table) -> None:
    rows = table("pair_load [N]\n0.001\n0.1\n1\n5\n25\n100\n")
    printed = [2.49e5, 1.59e7, 1.19e8, 4.82e8, 1.95e9, 6.50e9]  # by quadrature
    assert [row["stiffness"] for row in rows] == pytest.approx(printed, rel=4e-3)


def test_a_load_below_the_plastic_limit_has_no_stiffness_and_says_so(calc: Calc, tmp_path: Path) -> None:
    (tmp_path / "drive.toml").write_text(
        'plugin = "harmonic_fractal"\n[inputs]\npair_load = "1 uN"\n[studies]\nrun = ["validity"]\n'
    )
    answer = calc("run", "harmonic_fractal", "--inputs", "drive.toml", "--json", "-o", "run")
    found = json.loads(answer.out)
    assert found["results"]["stiffness"]["value"] == 0
    assert any("all contacts of the pair are plastic" in text for text in found["warnings"])


@pytest.fixture(scope="module")
def diagnosed(desk: Path) -> tuple[int, dict[str, Any]]:
    """A structure function with 12 nm of white noise in every height, measured at lags of its own."""
    rng = np.random.default_rng(11)
    lags = np.geomspace(0.4, 20.0, 40)
    clean = structure_function(lags * 1e-6, 1.4, 1e-11) * 1e12
    seen = (clean + 2 * 0.012**2) * (1 + 0.01 * rng.standard_normal(len(lags)))
    rows = "\n".join(f"{lag:.17g},{height:.17g}" for lag, height in zip(lags, seen, strict=True))
    (desk / "instrument.csv").write_text(f"lag [um],structure_function [um^2]\n{rows}\n")
    (desk / "instrument.toml").write_text('plugin = "harmonic_fractal"\n[tolerances]\nhardness = "off"\n')
    files = ("--inputs", desk / "instrument.toml", "--data", desk / "instrument.csv", "-o", desk / "diagnosis")
    said = io.StringIO()
    with redirect_stdout(said), redirect_stderr(said):
        code = main(["diagnose", "harmonic_fractal", *map(str, files), "-q"])
    return code, json.loads((desk / "diagnosis" / "diagnosis.json").read_text(encoding="utf-8"))


def test_noise_of_the_instrument_is_named_from_its_structure_function(diagnosed: tuple[int, dict[str, Any]]) -> None:
    code, found = diagnosed
    assert code == 0
    assert found["rows"] == 40
    assert found["verdict"] in {"named", "one_of"}
    (cause,) = found["causes"]
    assert {cause["effect"], *cause["same_as"]} == {"sensor_offset", "instrument_noise"}
    (unknown,) = cause["unknowns"].values()
    true = 2 * 0.012**2 if cause["effect"] == "sensor_offset" else 144.0  # um^2, or nm^2
    low, high = unknown["interval95"]
    assert low <= true <= high
    assert unknown["value"] == pytest.approx(true, rel=0.03)


def test_verify_states_every_row_as_it_is(calc: Calc) -> None:
    answer = calc("verify", "harmonic_fractal", "--json")
    assert answer.code == 0, answer.err
    found = json.loads(answer.out)
    assert len(found["rows"]) > 10
    assert all(row["as_stated"] for row in found["rows"])
    assert all(row["why"] for row in found["rows"] if row["verdict"] == "differs")
    titles = " ".join(finding["title"] for finding in found["findings"]).lower()
    for words in ("clearance", "weakest", "missing", "straight line"):
        assert words in titles


@pytest.mark.parametrize(
    ("lines", "lacking", "reason"),
    [
        # the first contact turns elastic at 2.3 and 4.2 mN m, above the 1 mN m from which the torsion counts
        (
            ["fractal_dimension = 2.444", 'fractal_roughness = "3.3421e-10 m"'],
            ["torsion", "rough_torsion", "mesh_torsion", "approach", "closing_clearance", "free_play", "rough_share"],
            "raise reference_torque above plastic_torque",
        ),
        # the catalogues print 30 as the ratio of sizes up to 32
        (
            ['catalogue_size = "40"', "flexspline_teeth = 60", "engaged_pairs = 18"],
            ["catalogue_torsion", "catalogue_stiffness", "rough_share"],
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
    found, other = (ran(tmp_path / at.stem, "run", "harmonic_fractal", "--inputs", at) for at in (file, raised))
    assert found.code == 0
    results = found.found["results"]
    assert sorted(name for name, result in results.items() if result["value"] is None) == sorted(lacking)
    assert all(reason in results[name]["reason"] for name in lacking)
    for name in ("stiffness", "clearance", "mesh_stiffness"):
        assert value(found, name) == value(other, name) > 0
    assert reason in found.said
    assert found.sheet.count(reason.replace("_", "\\_")) >= len(lacking)


def test_a_case_and_a_row_that_lack_the_torsion_keep_the_rest(calc: Calc, tmp_path: Path) -> None:
    (tmp_path / "drive.toml").write_text(
        'plugin = "harmonic_fractal"\n[inputs]\nconvention = "areal"\n[studies]\nrun = []\n', encoding="utf-8"
    )
    (tmp_path / "rows.csv").write_text("fractal_roughness [m]\n1e-11\n1e-8\n", encoding="utf-8")
    words = ["harmonic_fractal", "--inputs", tmp_path / "drive.toml"]
    found = ran(tmp_path / "run", "run", *words, "--cases", tmp_path / "rows.csv")
    fine, rough = (case["results"] for case in found.found["cases"])
    assert fine["torsion"]["value"] > 0
    assert (rough["torsion"]["value"], "reference_torque" in rough["torsion"]["reason"]) == (None, True)
    assert 0 < rough["stiffness"]["value"] < fine["stiffness"]["value"]
    shown = calc("table", *words, "--rows", tmp_path / "rows.csv")
    table = list(csv.DictReader(io.StringIO(shown.out)))
    assert (table[1]["torsion [urad]"], float(table[1]["stiffness [N/m]"])) == ("", rough["stiffness"]["value"])
    assert "rows.csv:3: no approach, closing_clearance, free_play, mesh_torsion, torsion" in shown.err
