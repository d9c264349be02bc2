"""What cannot be used is refused in one sentence that says what, where and what to do; nothing is half-written."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from own_pins import write_pin
from refusals import listing, sentences

from shared import Calc

DATA = Path(__file__).parents[1] / "data"
PIN = DATA / "pin_wear.py"
Refused = Callable[..., list[str]]


def faults(refused: Refused, folder: Path, text: str | bytes, *more: str | Path, name: str = "press.toml") -> list[str]:
    """Write an inputs file and return what is said of it; each fault begins with file and line."""
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    found = refused("run", "press_linkage", "--inputs", name, *more)
    for line in found:
        assert re.match(rf"{re.escape(name)}:\d+: |--set \S+=", line), line
    return found


def test_misspelt_extra_and_wrong_entries_are_named_together(refused: Refused, tmp_path: Path) -> None:
    text = (
        '[inputs]\nrod_lenght = "1.304 m"\ncolour = "grey"\ncrank_radius = 0.36\nreading = "prnted"\n'
        '[tolerances]\ncrank_radus = "IT7"\n[effects.link_heating]\n[studies]\nrun = ["sweeep"]\n'
        '[shet]\nproject = "x"\n'
    )
    found = faults(refused, tmp_path, text)
    assert [line.split(": ")[0] for line in found] == [f"press.toml:{line}" for line in (2, 3, 4, 5, 7, 8, 10, 11)]
    expected = [
        "no input 'rod_lenght'. Did you mean 'rod_length' (k_R, connecting rod, B to E, m)?",
        "no input 'colour'.",
        'write crank_radius = "0.36 m"',
        "Did you mean 'printed'?",
        "Did you mean 'crank_radius'",
        "its unknown 'expansion' must be given (from -20 to 20 um/(m*K))",
        "Did you mean 'sweep'?",
        "Did you mean 'sheet'?",
    ]
    for words, line in zip(expected, found, strict=True):
        assert words in line


def test_a_missing_field_is_named_with_the_section_it_belongs_to(calc: Calc, tmp_path: Path) -> None:
    shutil.copy(DATA / "worn_surface.py", tmp_path)
    (tmp_path / "s.toml").write_text('\n[inputs]\nlod = "3 N"\n')
    before = listing(tmp_path)
    found = sentences(calc("run", "./worn_surface.py", "--inputs", "s.toml"))
    assert listing(tmp_path) == before
    assert found == [
        "s.toml:2: worn_surface needs the input 'surface' (measured flank); "
        'write surface = { file = "data.txt" } under [inputs]',
        "s.toml:3: worn_surface has no input 'lod'. Did you mean 'load' (F, pressing force, N)?",
    ]


def test_what_is_impossible_by_set_or_in_the_example_names_that(refused: Refused, tmp_path: Path) -> None:
    (tmp_path / "press.toml").write_text('[inputs]\ncrank_radius = "0.35 m"\n')
    (found,) = refused("run", "press_linkage", "--inputs", "press.toml", "--set", "lower_knee_length=0.5 m")
    assert found.startswith("--set lower_knee_length=0.5 m: loop III, side 1 does not close")
    first, second = refused("run", "press_linkage", "--set", "rod_length=0.5 m", "-v")
    assert first.startswith("no --inputs")
    assert second.startswith("--set rod_length=0.5 m: loop I has no bottom dead centre")
    (found,) = refused("run", PIN, "--set", "load=500 kN", "-q")
    assert found == "--set load=500 kN: the contact flows: load exceeds hardness times area"


def test_a_fault_in_the_shipped_example_names_its_file(calc: Calc, tmp_path: Path) -> None:
    write_pin(tmp_path)
    example = tmp_path / "example.toml"
    example.write_text('plugin = "own_pin"\n[inputs]\narea = "1 mm^2"\nload = "3 kN"\n')
    answer = calc("run", "./own_pin.py")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.split("\n")[1] == f"{example}:4: the contact flows: load exceeds hardness times area"
    example.write_text('plugin = "own_pin"\n[inputs]\nload = "3 kg"\n')
    answer = calc("run", "./own_pin.py", "-q")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err == f"{example}:3: load: '3 kg' is a mass (kg), expected a force (N)\n"
    assert not (tmp_path / "runs").exists()


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no pipes with a name")
def test_a_pipe_is_refused_before_it_is_read(refused: Refused, tmp_path: Path) -> None:
    """It could be read only once, or never; half of it would be a calculation with defaults."""
    os.mkfifo(tmp_path / "pipe")
    sentence = "pipe: is no ordinary file but a pipe or a device; save it in a file first"
    assert refused("run", "press_linkage", "--inputs", "pipe") == [sentence]
    (tmp_path / "press.toml").write_text("[inputs]\n")
    assert refused("run", "press_linkage", "--inputs", "press.toml", "--cases", "pipe") == [sentence]


@pytest.mark.parametrize(("verb", "option"), [("run", "--cases"), ("table", "--rows")])
def test_a_table_with_faults(refused: Refused, tmp_path: Path, verb: str, option: str) -> None:
    (tmp_path / "press.toml").write_text("[inputs]\n")
    (tmp_path / "cases.csv").write_text("crank_angle [deg],rod_length [mm]\nx,1300\n1\n2,-1\n")
    assert refused(verb, "press_linkage", "--inputs", "press.toml", option, "cases.csv") == [
        "cases.csv:2: crank_angle: 'x' is no number",
        "cases.csv:3: this row has 1 cell, expected 2 as in the header",
        "cases.csv:4: rod_length is -0.001 m; it must be above 0 m",
    ]


def test_a_misspelt_column_of_cases_is_refused_and_one_of_rows_is_said(
    refused: Refused, calc: Calc, tmp_path: Path
) -> None:
    (tmp_path / "press.toml").write_text("[inputs]\n")
    (tmp_path / "cases.csv").write_text("crank_angel [deg],crank_radius [mm]\n1,360\n")
    (found,) = refused("run", "press_linkage", "--inputs", "press.toml", "--cases", "cases.csv")
    assert found == "cases.csv:1: press_linkage has no input 'crank_angel'. Did you mean 'crank_angle'?"
    answer = calc("table", "press_linkage", "--inputs", "press.toml", "--rows", "cases.csv")
    assert answer.code == 0
    assert answer.err == "column 'crank_angel' changes nothing and is kept as it stands. Did you mean 'crank_angle'?\n"
    assert answer.out.startswith("crank_angel [deg],crank_radius [mm],face_height_1 [mm],")


def test_an_output_below_an_ordinary_file(refused: Refused, tmp_path: Path) -> None:
    (tmp_path / "press.toml").write_text("[inputs]\n")
    (tmp_path / "file").write_text("mine\n")
    (found,) = refused("run", "press_linkage", "-i", "press.toml", "-o", "file/runs/here")
    where = tmp_path / "file"
    assert found == f"calc: file/runs/here: {where} is a file, so there can be no folder below it; name another place"
    (found,) = refused("run", "press_linkage", "-i", "press.toml", "-o", "file")
    assert found == "calc: file: is a file; a run is a folder, name another place"
    for verb, option in (("init", ()), ("table", ("-i", "press.toml", "--rows", "rows.csv"))):
        (tmp_path / "rows.csv").write_text("crank_angle [deg]\n1\n")
        (found,) = refused(verb, "press_linkage", *option, "-o", "file/x")
        assert found.startswith("calc: file/")
        assert found.endswith("cannot be written: file is a file and no folder")


def test_a_table_that_would_replace_what_it_reads(refused: Refused, tmp_path: Path) -> None:
    (tmp_path / "press.toml").write_text("[inputs]\n")
    (tmp_path / "rows.csv").write_text("crank_angle [deg]\n1\n")
    (found,) = refused("table", "press_linkage", "-i", "press.toml", "--rows", "rows.csv", "-o", "./rows.csv")
    assert found == "calc: rows.csv is read by this command; name another file for the output"


def test_a_plugin_that_nobody_offers(refused: Refused) -> None:
    (found,) = refused("run", "press_linkge")
    drive = "harmonic_fractal, harmonic_fractal.made_flank, harmonic_fractal.run_up, harmonic_fractal.vibration"
    ours = (
        f"{drive}, press_linkage, press_linkage.loaded, press_linkage.motion, roller_screw_shift, rv_gearing, rv_wear"
    )
    assert found == f"calc: no plugin offers 'press_linkge'. Did you mean 'press_linkage'? Installed: {ours}."
    (found,) = refused("describe", "./nowhere.py")
    assert found == "calc: ./nowhere.py: no such file"


HOSTILE = "<script>alert(1)</script> {{7*7}} {% raw %} $x$ | # `code` [a](javascript:b) ![c](d) &amp; \\ __x__"


def test_what_a_project_is_called_is_inert_on_both_sheets(calc: Calc, tmp_path: Path) -> None:
    text = "\n".join(f"{key} = '{HOSTILE}'" for key in ("project", "drawing", "prepared_by"))
    (tmp_path / "pin.toml").write_text(f"[sheet]\n{text}\n[studies]\nrun = []\n")
    answer = calc("run", PIN, "--inputs", "pin.toml")
    assert answer.code in {0, 1}, answer.err
    page = (tmp_path / "runs/pin/sheet.html").read_text(encoding="utf-8")
    assert "<script>alert" not in page
    assert "&lt;script&gt;alert(1)&lt;/script&gt; {{7*7}} {% raw %} $x$ | # `code`" in page
    assert 'href="javascript' not in page
    sheet = (tmp_path / "runs/pin/sheet.md").read_text(encoding="utf-8")
    lines = [line for line in sheet.split("\n") if "7\\*7" in line or "7*7" in line]
    assert lines
    assert "49" not in "".join(lines)
    for line in lines:
        bare = re.sub(r"\\.", "", line)  # what Markdown takes as itself
        for mark in ("<script", "$", "`", "[a](", "__"):
            assert mark not in bare, line
        if line.startswith("|"):
            assert bare.count("|") == sheet_columns(sheet, line)
        else:
            assert not bare.startswith(("# |", "#  "))


def sheet_columns(sheet: str, line: str) -> int:
    """Return how many bars a row of the table has that this line stands in: as many as the rule below its head."""
    lines = sheet.split("\n")
    rules = [one for one in lines[: lines.index(line)] if re.fullmatch(r"\|[ :|-]+\|", one)]
    return rules[-1].count("|")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("rnu", "press_linkage"), "No such command 'rnu'. Did you mean 'run'?"),
        (("run", "press_linkage", "--input", "x.toml"), "--inputs"),
        (("table", "press_linkage"), "--inputs"),
        (("run", "press_linkage", "--workers", "0"), "--workers"),
        (("run",), "plugin"),
    ],
)
def test_a_wrong_call_says_what_is_missing(calc: Calc, tmp_path: Path, arguments: tuple[str, ...], words: str) -> None:
    answer = calc(*arguments)
    assert answer.code == 2
    assert answer.out == ""
    assert words in answer.err
    assert "Traceback" not in answer.err
    assert listing(tmp_path) == []
