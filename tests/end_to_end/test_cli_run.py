"""calc run, and what holds for every verb: exit codes, stdout and stderr, words that may stand anywhere."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from own_pins import write_pin

from shared import Answer, Calc
from truing.report import pdf

PIN = Path(__file__).parents[1] / "data" / "pin_wear.py"
FILES = ["inputs.toml", "results.csv", "results.json", "run.json", "sheet.html", "sheet.md"]
QUICK = ("--set", "studies.reliability.draws=2000")


def test_json_is_one_document_and_the_same_as_in_the_folder(calc: Calc, tmp_path: Path) -> None:
    answer = calc("run", PIN, "--json")
    assert answer.code == 0
    assert json.loads(answer.out) == json.loads((tmp_path / "runs/pin_wear/results.json").read_text("utf-8"))


@pytest.mark.parametrize(
    ("body", "code", "words"),
    [
        ("raise ConvergenceError('the iteration stood still after 50 steps')", 4, "calc: the iteration stood still"),
        ("raise ValueError('a mistake')", 3, "own_pin.py:21: own_pin failed: ValueError: a mistake"),
        ("return np.zeros(3)", 3, "calc: own_pin returned array([0., 0., 0.]), which is no Wear"),
        ("raise KeyboardInterrupt", 130, "calc: interrupted; nothing was written"),
    ],
)
def test_exit_codes_of_a_plugin_that_does_not_answer(
    calc: Calc, tmp_path: Path, body: str, code: int, words: str
) -> None:
    write_pin(tmp_path, body=body)
    answer = calc("run", "./own_pin.py", "-q")
    assert answer.code == code
    assert answer.out == ""
    assert words in answer.err
    assert answer.err.count("\n") == 1
    assert not (tmp_path / "runs").exists()


def test_traceback_shows_where_and_keeps_sentence_and_code(calc: Calc, tmp_path: Path) -> None:
    write_pin(tmp_path, body="raise ValueError('a mistake')")
    for arguments in (("--traceback", "run", "./own_pin.py"), ("run", "./own_pin.py", "--traceback")):
        answer = calc(*arguments)
        assert (answer.code, answer.out) == (3, "")
        assert "Traceback (most recent call last)" in answer.err
        assert "in own_pin\n    raise ValueError('a mistake')" in answer.err
        assert "own_pin failed: ValueError: a mistake" in answer.err.split("\n")[-2]
    assert "Traceback" not in calc("run", "./own_pin.py").err


@pytest.mark.parametrize("place", [0, 2, 4])
def test_quiet_and_verbose_may_stand_anywhere(calc: Calc, place: int) -> None:
    words = ["run", str(PIN), *QUICK]
    loud = calc(*words)
    assert loud.err == f"no --inputs: running the shipped example (calc init {PIN} writes it to a file)\n"
    quiet = calc(*words[:place], "-q", *words[place:])
    assert (quiet.code, quiet.err) == (0, "")
    verbose = calc(*words[:place], "--verbose", *words[place:])
    assert verbose.out == loud.out
    assert "plugin pin_wear" in verbose.err
    assert "input hash " in verbose.err
    assert "Traceback" not in verbose.err


def test_quiet_does_not_silence_errors(calc: Calc) -> None:
    answer = calc("run", PIN, "-q", "--set", "load=3 kg")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err == "--set load=3 kg: load: '3 kg' is a mass (kg), expected a force (N)\n"


def test_without_a_verb_the_help_is_shown(calc: Calc) -> None:
    answer = calc()
    assert "Usage: calc" in answer.out + answer.err
    for verb in ("plugins", "describe", "init", "run", "table", "verify", "compare"):
        assert f"  {verb} " in answer.out + answer.err


def test_set_replaces_what_the_file_says(calc: Calc, tmp_path: Path) -> None:
    (tmp_path / "wear.toml").write_text('[inputs]\nload = "84 N"\n')
    words = ("load=168 N", "tolerances.load=off", "units.pressure=bar", "seed=7", "effects.running_in.extra=3 um")
    settings = [word for text in (*words, "effects.running_in.length=100 m") for word in ("--set", text)]
    answer = calc("run", PIN, "--inputs", "wear.toml", "--json", *settings)
    assert answer.code == 0, answer.err
    found = json.loads(answer.out)
    assert found["inputs"]["load"] == {"value": 168.0, "unit": "N"}
    assert found["results"]["pressure"] == {"value": pytest.approx(60.0), "unit": "bar"}
    assert found["tolerances"]["load"]["spread"] == "off"
    assert found["seed"] == 7
    assert found["effects"]["running_in"]["extra"] == {"value": pytest.approx(3.0), "unit": "um"}
    assert "168" in (tmp_path / "runs/wear/inputs.toml").read_text(encoding="utf-8")


def test_paths_with_spaces_and_umlauts(calc: Calc, tmp_path: Path) -> None:
    name = "Prüfstand 7 日本, it's [x] (1)"
    folder = tmp_path / name
    folder.mkdir()
    shutil.copy(PIN, folder / "pin_wear.py")
    (folder / f"{name}.toml").write_bytes(
        '\ufeff[sheet]\r\nproject = "Größe µ"\r\n[inputs]\r\nload = "84 N"\r\n'.encode()
    )
    answer = calc("run", f"{name}/pin_wear.py", "-i", f"{name}/{name}.toml", "-o", f"{name}/out", *QUICK)
    assert answer.code == 0, answer.err
    assert sorted(path.name for path in (folder / "out").iterdir()) == FILES
    assert "Größe µ" in (folder / "out/sheet.md").read_text(encoding="utf-8")
    (folder / f"{name}.toml").write_text('[inputs]\n\nload = "84 kg"\n', encoding="utf-8")
    answer = calc("run", f"{name}/pin_wear.py", "-i", f"{name}/{name}.toml")
    assert answer.code == 2
    assert answer.err.startswith(f"{Path(name) / (name + '.toml')}:3: load: '84 kg' is a mass")


def test_detail_changes_the_sheet(calc: Calc, tmp_path: Path) -> None:
    sizes = {}
    for detail in ("short", "normal", "full"):
        answer = calc("run", PIN, "-o", detail, "--set", f"detail={detail}", "-q")
        assert answer.code == 0, answer.err
        sizes[detail] = len((tmp_path / detail / "sheet.md").read_text(encoding="utf-8"))
        results = (tmp_path / detail / "results.json").read_bytes()
        assert results == (tmp_path / "short" / "results.json").read_bytes()
    assert sizes["short"] < sizes["normal"] <= sizes["full"]
    answer = calc("run", PIN, "--set", "detail=ful")
    assert answer.code == 2
    assert "--set detail=ful: " in answer.err
    assert "short" in answer.err


def test_a_word_document_beside_the_other_sheets(calc: Calc, tmp_path: Path) -> None:
    answer = calc("run", PIN, "--docx", *QUICK[:2])
    assert (answer.code, f"for Word: {Path('runs', 'pin_wear', 'sheet.docx')}" in answer.err) == (0, True)
    assert sorted(path.name for path in (tmp_path / "runs" / "pin_wear").iterdir()) == sorted([*FILES, "sheet.docx"])


def test_a_printed_sheet_or_a_word_why_not(calc: Calc, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pdf, "find_browser", lambda: None)
    answer: Answer = calc("run", PIN, "--pdf", *QUICK)
    assert answer.code == 0
    assert "no PDF: " in answer.err
    assert "print" in answer.err
    assert not (tmp_path / "runs/pin_wear/sheet.pdf").exists()
    assert (tmp_path / "runs/pin_wear/sheet.html").exists()


@pytest.mark.browser
def test_a_printed_sheet(calc: Calc, tmp_path: Path) -> None:
    if pdf.find_browser() is None:
        pytest.skip("no Chromium, Chrome or Edge on this machine")
    answer = calc("run", PIN, "--pdf", *QUICK)
    assert answer.code == 0
    assert "printed: " in answer.err
    assert (tmp_path / "runs/pin_wear/sheet.pdf").read_bytes().startswith(b"%PDF-")
