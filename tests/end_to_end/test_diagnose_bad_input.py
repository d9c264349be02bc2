"""Measured files that are wrong or odd: refused in one sentence, or kept, said and counted; never silently guessed."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from measured import (
    ANGLE,
    FORCE,
    HEIGHT,
    SPEED,
    TIME,
    WARMTH,
    Columns,
    Diagnosed,
    calc_here,
    columns_of,
    diagnose_here,
    documented,
    names,
    renamed,
    taken,
    text_of,
    with_cells,
)

pytestmark = pytest.mark.filterwarnings("error::RuntimeWarning")
COMMAND = ("diagnose", "press_linkage", "--inputs", "inputs.toml")


@pytest.fixture(scope="session")
def desk(heated: Diagnosed, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the inputs of the press; what is diagnosed lies here."""
    folder = tmp_path_factory.mktemp("press")
    shutil.copy(heated.folder.parents[1] / "inputs.toml", folder)
    return folder


@pytest.fixture(scope="session")
def press(heated: Diagnosed) -> Columns:
    """The record of a press whose links are warm, as cells of text."""
    return columns_of((heated.folder.parents[1] / "measured.csv").read_text(encoding="utf-8"))


@pytest.fixture
def bench(desk: Path, tmp_path: Path, press: Columns) -> Path:
    """A folder with the inputs of the press, its record, and a folder of somebody else."""
    (tmp_path / "inputs.toml").write_bytes((desk / "inputs.toml").read_bytes())
    (tmp_path / "m.csv").write_text(text_of(press), encoding="utf-8")
    (tmp_path / "letters").mkdir()
    (tmp_path / "letters" / "to the mill.txt").write_text("Dear Sirs", encoding="utf-8")
    return tmp_path


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


# What is refused


def units_mixed_up(press: Columns) -> str:
    wrong = renamed(renamed(press, FORCE, "forming_force [mm]"), SPEED, "\x1b[31mspeed [rpm]")
    return text_of(with_cells(wrong, TIME, {5: "late"})) + "1,2,3\n"


REFUSED: list[tuple[dict[str, Callable[[Columns], str]], str, list[str]]] = [
    (
        {"m.csv": units_mixed_up},
        "m.csv",
        [
            "m.csv:1: the header '\\x1b[31mspeed [rpm]' cannot be read; write it like 'load [N]'",
            "m.csv:1: column 'forming_force [mm]': 'mm' is a length (mm), expected a force (kN)",
            "m.csv:7: time: 'late' is no number",
            "m.csv:92: this row has 3 cells, expected 8 as in the header",
        ],
    ),
    (
        {"m.csv": lambda press: text_of({**press, "rod_length [m]": ["0.5"] * 90})},
        "m.csv",
        [
            "m.csv: no row can be used; a diagnosis needs 3 rows at the very least, better fifty "
            "(90 rows are left out where the model fails; the first is m.csv:2: "
        ],
    ),
    (
        {
            "one.csv": lambda press: text_of(renamed(press, HEIGHT, "slider_position [s]")),
            "two.csv": lambda press: text_of(with_cells(press, ANGLE, {1: "steep"})),
        },
        "one.csv absent.csv two.csv",
        [
            "one.csv:1: column 'slider_position [s]': 's' is a time (s), expected a length (mm)",
            "absent.csv: no such file",
            "two.csv:3: crank_angle: 'steep' is no number",
        ],
    ),
    ({}, "letters", ["letters: is a folder; name a file"]),
    ({}, "", ["calc: nothing to diagnose: name the measured rows with --data FILE.csv"]),
    ({}, "m.csv -o letters", ["calc: letters: is an existing folder but no diagnosis of ours, so it is left alone; "]),
    *(
        (
            {"inputs.toml": lambda _, option=option: f"[studies.diagnose]\n{option}\n"},
            "m.csv",
            [f"inputs.toml:2: {said}"],
        )
        for option, said in (
            ('hold_out = "record = validation"', "hold_out: no file has a column 'record'."),
            ('hold_out = "time = 77"', "hold_out: no row has '77' in the column 'time'"),
            ('per_file = ["sensor_ofset"]', "study 'diagnose': per_file names 'sensor_ofset', which is no "),
            ('box = {speed = "60..10 rpm"}', "study 'diagnose': box: speed = '60..10 rpm' goes from its "),
        )
    ),
]


@pytest.mark.parametrize(("files", "data", "sentences"), REFUSED, ids=[sentences[0] for *_, sentences in REFUSED])
def test_what_is_refused_is_said_at_once_and_leaves_nothing(
    bench: Path, press: Columns, files: dict[str, Callable[[Columns], str]], data: str, sentences: list[str]
) -> None:
    for name, text in files.items():
        (bench / name).write_text(text(press), encoding="utf-8")
    before = contents(bench)
    answer = calc_here(bench, *COMMAND, *(["--data", *data.split()] if data else []))
    assert (answer.code, answer.out, contents(bench)) == (2, "", before)
    lines = answer.err.rstrip("\n").split("\n")
    assert len(lines) == len(sentences)
    assert all(line.startswith(sentence) for line, sentence in zip(lines, sentences, strict=True)), lines


def test_an_earlier_diagnosis_outlives_a_refusal(bench: Path, heated: Diagnosed) -> None:
    earlier = shutil.copytree(heated.folder, bench / "earlier")
    (bench / "wrong.csv").write_text("slider_position [kN]\n1\n2\n3\n", encoding="utf-8")
    assert calc_here(bench, *COMMAND, "--data", "wrong.csv", "-o", "earlier").code == 2
    assert contents(earlier) == contents(heated.folder)


# What is kept, said and counted


def test_nothing_is_said_of_a_file_without_oddities(heated: Diagnosed) -> None:
    assert heated.answer.err == ""
    assert heated.document["notes"] == heated.document["unit_slips"] == heated.document["warnings"] == []
    assert names(heated.document) == ["link_heating"]
    assert heated.document["rows"] == 90
    assert "slider_inertia" not in heated.document["not_excited"]


def said(found: Diagnosed, sentence: str) -> bool:
    """Whether a sentence stands in diagnosis.json and was said beside the results."""
    return (
        any(note.startswith(sentence) for note in found.document["notes"]) and f"note: {sentence}" in found.answer.err
    )


def test_what_never_changed_is_not_excited(desk: Path, press: Columns) -> None:
    found = diagnose_here(desk, "constant", text_of({**press, SPEED: ["30"] * 90, FORCE: ["0"] * 90}))
    assert said(found, "2 columns never change, so nothing can be seen of what depends on it: ")
    blind = set(found.document["not_excited"])
    assert {"slider_inertia", "elastic_deflection"} <= blind
    assert "link_heating" not in blind
    assert found.document["covariates"]["speed"] == {"unit": "rpm", "role": "condition", "constant": True}
    assert names(found.document) == ["link_heating"]
    assert "slider inertia" in found.answer.out


def test_one_row_many_times_names_nothing(desk: Path, press: Columns) -> None:
    """A gauge that stands still: 80 times the same row are 80 readings, and no cause."""
    (desk / "still.csv").write_text(text_of(taken(press, [7] * 80)), encoding="utf-8")
    document = documented(desk, "press_linkage", "still.csv")
    assert (document["rows"], document["verdict"] in {"none", "undecided"}) == (80, True)


def test_a_condition_that_no_column_gives_is_not_measured(desk: Path, press: Columns) -> None:
    found = diagnose_here(desk, "cold", text_of({name: cells for name, cells in press.items() if name != WARMTH}))
    assert said(found, "not measured: 'link_temperature'; what depends on it cannot be seen")
    lacking = ["link_temperature"]
    assert found.document["not_measured"] == {
        "link_heating": lacking, "side_heating": lacking, "thermal_drift": lacking,
    }  # fmt: skip
    assert not set(names(found.document)) & set(found.document["not_measured"])
    assert "Not measured, so not seen: link heating (link temperature)" in found.answer.out


def test_what_a_budget_of_calls_leaves_out_is_said(desk: Path, press: Columns, heated: Diagnosed) -> None:
    """A budget that does not last forbids a plain name; one that does changes nothing."""
    few = diagnose_here(desk, "few", text_of(press), "--set", "studies.diagnose.budget=150")
    many = documented(desk, "press_linkage", "few.csv", budget=100_000)
    (said,) = [text for text in few.document["warnings"] if text.startswith("the search ended after 150 calls of the ")]
    assert said.endswith("look further with [studies.diagnose] budget = 600")
    assert few.document["verdict"] == "undecided"
    assert not few.document["unique"]
    assert said in few.document["undecided"]
    assert "the search ended after 150 calls" in " ".join(few.answer.out.split())
    assert "the search ended after 150 calls" in (few.folder / "sheet.html").read_text(encoding="utf-8")
    assert many["warnings"] == heated.document["warnings"] == []
    assert names(many) == names(heated.document)


def test_another_way_to_write_a_file_gives_the_same_bytes(bench: Path, press: Columns, heated: Diagnosed) -> None:
    """A byte order mark, semicolons and decimal commas, spaces around them, other line ends and empty lines."""
    german = text_of(press).replace(",", " ; ").replace(".", ",").replace("\n", "\r\n\r\n")
    again = diagnose_here(bench, "measured", b"\xef\xbb\xbf" + german.encode())
    first, second = ((found.folder / "diagnosis.json").read_bytes() for found in (heated, again))
    assert first == second
