"""calc sweep: curves of a model that declares none, their limits, two inputs, points that fail, and what is refused."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from test_file_formats import demand

import truing
from shared import ROOT, Calc
from truing.studies.sweep import Swept, curves

SPRING = ROOT / "docs" / "examples" / "coil_spring.py"
Refused = Callable[..., list[str]]


@pytest.fixture
def bolt(tmp_path: Path) -> truing.LoadedModel:
    """The bolt of the README, in the folder in which ``calc`` runs; it declares no sweep."""
    (code,) = re.findall(r"<!-- file: bolt.py -->\n```python\n(.*?)```", (ROOT / "README.md").read_text("utf-8"), re.S)
    (tmp_path / "bolt.py").write_text(code, encoding="utf-8")
    return truing.load(tmp_path / "bolt.py")


def table_of(page: str, title: str) -> list[list[str]]:
    """The rows of a table of a sheet in Markdown."""
    (lines,) = re.findall(rf"\*\*{title}\*\*\n\n((?:\|.*\n)+)", page)
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines.splitlines()[2:]]


def points_in(folder: Path) -> dict[str, list[float]]:
    head, *rows = csv.reader((folder / "points.csv").read_text(encoding="utf-8").splitlines())
    return {name: [float(row[index]) if row[index] else np.nan for row in rows] for index, name in enumerate(head)}


def test_the_points_are_single_runs_and_the_limit_is_met_where_the_formula_says(
    calc: Calc, bolt: truing.LoadedModel, tmp_path: Path
) -> None:
    answer = calc("sweep", "./bolt.py", "torque", "50..100", "N m", "--steps", "6", "-q")
    assert answer.code == 0, answer.err
    folder = tmp_path / "runs" / "bolt_sweep"
    points = points_in(folder)
    assert points["torque [N*m]"] == pytest.approx([50, 60, 70, 80, 90, 100], rel=1e-15)
    single = [float(bolt.run(torque=torque).si["preload"]) / 1e3 for torque in points["torque [N*m]"]]
    assert points["preload [kN]"] == pytest.approx(single, rel=1e-15)
    page = (folder / "sheet.md").read_text(encoding="utf-8")
    ((result, limit, met, kept),) = table_of(page, "Limits along the torque")
    assert (result, limit, kept) == ("preload $F$ (preload)", "≥ 28 kN", "above it")
    closed = 28e3 * 0.2 * 12e-3
    assert float(met) == pytest.approx(closed, rel=1e-4)
    (crossing,) = json.loads((folder / "results.json").read_text())["studies"]["sweep"]["limits"]["preload"][
        "crossings"
    ]
    assert crossing["at"] == pytest.approx(closed, rel=1e-9)
    assert "67.2  above it" in answer.out
    assert "<svg" in (folder / "sheet.html").read_text(encoding="utf-8")


def test_a_unit_within_the_range_and_behind_it_are_the_same(calc: Calc, bolt: truing.LoadedModel) -> None:
    ways = [("50..100", "N m"), ("50..100 N m",), ("50 N m..100 N m",), ("50000..100000", "N*mm")]
    said = {calc("sweep", "./bolt.py", "torque", *words, "-q").out for words in ways}
    assert len(said) == 1
    assert "35.42" in said.pop()


def test_what_is_asked_alone_is_a_run_folder_whose_inputs_run(
    calc: Calc, bolt: truing.LoadedModel, tmp_path: Path
) -> None:
    answer = calc(
        "sweep", "./bolt.py", "torque", "50..100 N m", "--set", "diameter=10mm", "-o", "curve", "--json", "-q"
    )
    document = json.loads(answer.out)
    demand("results", document)
    assert document == json.loads((tmp_path / "curve" / "results.json").read_text(encoding="utf-8"))
    text = (tmp_path / "curve" / "inputs.toml").read_text(encoding="utf-8")
    assert '# asked besides, and not declared by the model: sweep, over = "torque", at = "50..100 N m"' in text
    again = bolt.run(tmp_path / "curve" / "inputs.toml")
    assert again.si["preload"] == pytest.approx(85 / 0.2 / 10e-3)


def test_limits_the_stated_value_and_what_fails_are_drawn(bolt: truing.LoadedModel) -> None:
    found = bolt.sweep("torque", "50..100 N*m")
    assert isinstance(found.outcome, Swept)
    figure = found.plot()
    (panel,) = figure.axes
    curve, limit, stated = sorted(panel.lines, key=lambda line: ["-", "--", ":"].index(line.get_linestyle()))
    assert curve.get_ydata()[[0, -1]] == pytest.approx([50 / 2.4, 100 / 2.4])
    assert set(limit.get_ydata()) == {28.0}
    assert set(stated.get_xdata()) == {85.0}
    assert {text.get_text() for text in panel.texts} == {"≥ 28 kN", "stated: 85 N·m"}
    (shaded,) = [each.get_paths()[0].get_extents() for each in panel.collections]
    assert (shaded.y0, shaded.y1) == (panel.get_ylim()[0], 28.0)
    loose = bolt.sweep("torque", "5..6 N*m").plot().axes[0]
    assert [text.get_text() for text in loose.texts] == ["≥ 28 kN (beyond the figure)"]
    assert [line.get_linestyle() for line in loose.lines] == ["-"]


def test_a_second_input_gives_a_line_each(calc: Calc, bolt: truing.LoadedModel, tmp_path: Path) -> None:
    words = ("torque", "50..100 N m", "--over", "nut_factor", "0.25, 0.15, 0.2", "--steps", "6", "-o", "two", "-q")
    assert calc("sweep", "./bolt.py", *words).code == 0
    rows = table_of((tmp_path / "two" / "sheet.md").read_text(encoding="utf-8"), "Limits along the torque")
    assert [float(row[2]) for row in rows] == [0.15, 0.2, 0.25]
    assert [float(row[3]) for row in rows] == pytest.approx([28e3 * 12e-3 * factor for factor in (0.15, 0.2, 0.25)])
    points = points_in(tmp_path / "two")
    assert len(points["preload [kN]"]) == 18
    expected = np.array(points["torque [N*m]"]) / np.array(points["nut_factor [1]"]) / 12
    assert points["preload [kN]"] == pytest.approx(expected)
    swept = bolt.sweep("torque", (50, 100), over=("nut_factor", (0.15, 0.25)))
    (panel,) = swept.plot().axes
    assert [text.get_text() for text in panel.get_legend().get_texts()] == ["0.15", "0.175", "0.2", "0.225", "0.25"]
    assert swept.frame().columns.tolist() == ["torque [N*m]", "nut_factor [1]", "preload [kN]"]


def test_a_limit_that_is_swept_itself_or_calculated_moves() -> None:
    spring = truing.load(SPRING)
    swept = spring.sweep("permitted_stress", "500..700 MPa", results="stress").outcome
    assert isinstance(swept, Swept)
    (crossing,) = swept.crossings
    assert (crossing.limit, crossing.kept) == ("stress", "above")
    assert crossing.at == pytest.approx(float(spring.run().si["stress"]), rel=1e-9)
    (panel,) = curves(swept, ["stress"])().axes
    limit = next(line for line in panel.lines if line.get_linestyle() == "--")
    assert limit.get_ydata()[[0, -1]] == pytest.approx([500, 700])


def test_points_that_fail_are_left_out_counted_and_named(calc: Calc, tmp_path: Path) -> None:
    answer = calc("sweep", SPRING, "coil_diameter", "-2..8", "mm", "--steps", "11", "--results", "index", "-q")
    assert answer.code == 0, answer.err
    said = answer.out.replace("\n", " ")
    assert (
        "4 of 11 points have no answer: 3 from -2 mm to 0 mm: coil_diameter must be above 0 mm; 1 at 1 mm: the coils"
        in said
    )
    points = points_in(tmp_path / "runs" / "coil_spring_sweep")
    assert np.isnan(points["index [1]"]).tolist() == [True] * 4 + [False] * 7
    assert points["index [1]"][4:] == pytest.approx([2, 3, 4, 5, 6, 7, 8])
    assert calc("sweep", SPRING, "coil_diameter", "-2..-1 mm", "-q").code == 1


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("torqe", "50..100 N m"), "'torqe' is no input of bolt. Did you mean 'torque'?"),
        (("torque", "50..100 kg"), "is a mass (kg), expected a torque (N·m)"),
        (("torque", "50..100"), "has no unit; expected a torque"),
        (("torque", "100..50 N m"), "the range '100..50 N m' runs backwards; write the lower end first"),
        (("torque", "50..50 N m"), "the range '50..50 N m' is empty: its ends are the same"),
        (("torque", "nan..50 N m"), "'nan' is not a finite number"),
        (("torque", "50..inf N m"), "'inf N m' is not a finite number"),
        (("torque", ""), "'' is no range"),
        (("torque", "50..100 N m", "--results", "prelod"), "bolt has no result 'prelod'. Did you mean 'preload'?"),
        (("torque", "50..100 N m", "--steps", "1000001"), "a sweep has 2 to 1000000 points"),
        (("torque", "50..100 N m", "--over", "torque", "1..2 N m"), "'torque' is swept already"),
        (("torque", "50..100 N m", "--over", "diameter", "1..2 N m"), "expected a length (mm)"),
        (("torque", "50..100 N m", "--over", "nut_factor", ",".join(map(str, range(1, 14)))), "13 lines; a figure has"),
        (("torque", "50..100 N m", "--steps", "400000", "--over", "nut_factor", "1,2,3"), "more than 1000000 points"),
        (("torque", "50..100 N m", "--set", "torque=0 N m"), "torque is 0 N*m; it must be above 0 N*m"),
        (("torque", "50..100 N m", "-o", "bolt.py"), "bolt.py: is a file"),
    ],
)
def test_what_cannot_be_swept_is_one_sentence(
    refused: Refused, bolt: truing.LoadedModel, words: tuple[str, ...], sentence: str
) -> None:
    (said,) = refused("sweep", "./bolt.py", *words, "-q")
    assert sentence in said


def test_a_word_and_a_series_are_not_swept(refused: Refused) -> None:
    for name, model in (("reading", "press_linkage"), ("surface", "harmonic_fractal")):
        (said,) = refused("sweep", model, name, "1..2", "-q")
        assert f"'{name}' cannot be swept; only a number can" in said


def test_of_very_many_points_a_figure_shows_the_extremes(bolt: truing.LoadedModel) -> None:
    swept = bolt.sweep("torque", "50..100 N*m", points=100_000).outcome
    assert isinstance(swept, Swept)
    swept.results["preload"][54_321] = 9e9  # type: ignore[index]
    (panel,) = curves(swept, ["preload"])().axes
    curve = panel.lines[0]
    assert len(curve.get_xdata()) <= 2002
    assert curve.get_ydata().max() == pytest.approx(9e6)
    assert curve.get_xdata()[[0, -1]] == pytest.approx([50, 100])
