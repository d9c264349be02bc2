"""calc compare: what changed between two runs."""

from __future__ import annotations

import io
import json
import re
from functools import partial
from pathlib import Path
from typing import Any

import docx
import pytest

import truing
from shared import Calc
from truing.cli import main
from truing.cli.folders import styles_of
from truing.report.comparison_page import Side, comparison_page, in_one_unit
from truing.report.document import plain_text
from truing.runs.comparison import Change, amount_of, differing, same, words_of
from truing.runs.comparison import compared as changes

PIN = Path(__file__).parents[1] / "data" / "pin_wear.py"


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Make three runs: two alike, and one with another load."""
    folder = tmp_path_factory.mktemp("runs")
    for name, more in (("first", ()), ("again", ()), ("heavy", ("--set", "load=2300 N"))):
        assert main(["run", str(PIN), "-q", "-o", str(folder / name), *more]) in {0, 1}
    return folder


@pytest.fixture
def runs(calc: Calc, made: Path) -> Calc:
    """Run ``calc`` where these runs are."""
    return partial(calc, cwd=made)


def test_a_check_that_flipped_stands_above_all_others(runs: Calc) -> None:
    there = runs("compare", "first", "heavy").out.split("\n")[1]
    assert there.split()[:3] == ["checks", "pressure", "1"]
    assert "(fails)" in there
    assert "now FAILS, -80" in there
    back = runs("compare", "heavy", "first").out.split("\n")[1]
    assert "now passes, +4" in back


def test_different_runs_as_json(runs: Calc) -> None:
    answer = runs("compare", "first", "heavy", "--json")
    assert answer.code == 1
    found = json.loads(answer.out)
    assert found["equal"] is False
    first = found["changes"][0]
    assert first == {
        "kind": "inputs",
        "name": "load",
        "before": {"value": 120.0, "unit": "N"},
        "after": {"value": 2300.0, "unit": "N"},
    }


def test_a_name_that_one_run_lacks() -> None:
    before = {"results": {"a": {"value": 1.0, "unit": ""}}, "checks": [], "seed": 1}
    after = {"results": {"b": {"value": 1.0, "unit": ""}}, "checks": [{"name": "c", "state": "passes"}], "seed": 1}
    assert changes(before, after) == [
        Change("results", "a", {"value": 1.0, "unit": ""}, None),
        Change("results", "b", None, {"value": 1.0, "unit": ""}),
        Change("checks", "c", None, {"state": "passes"}),
    ]


def test_rounding_is_no_change_and_a_change_beyond_it_is() -> None:
    before = {"results": {"a": {"value": 1.0, "unit": "mm"}}, "studies": {"s": {"x": [1.0, 2.0], "y": None}}}
    rounded = {"results": {"a": {"value": 1.0 + 4e-16, "unit": "mm"}}, "studies": {"s": {"x": [1.0, 2.0], "y": None}}}
    assert changes(before, rounded) == []
    changed = {"results": {"a": {"value": 1.0 + 1e-11, "unit": "mm"}}, "studies": {"s": {"x": [1.0, 2.1], "y": 3.0}}}
    assert [(item.kind, item.name) for item in changes(before, changed)] == [("results", "a"), ("studies", "s")]
    assert differing(before["studies"], changed["studies"]) == 2
    other = changes({**before, "kernel": "0.1.0", "seed": 1}, {**before, "kernel": "0.2.0", "seed": 2})
    assert [(item.kind, item.name) for item in other] == [("settings", "kernel"), ("settings", "seed")]


def test_tolerances_effects_and_studies_in_words(calc: Calc, tmp_path: Path) -> None:
    warm = '[effects.warm_probe]\nslope = "1 um/K"\n[tolerances]\nload = "sd 1 %"\n'
    (tmp_path / "warm.toml").write_text(warm, encoding="utf-8")
    calc("run", PIN, "-q", "-o", "cold")
    calc("run", PIN, "-q", "-o", "warm", "--inputs", "warm.toml")
    lines = [" ".join(line.split()) for line in calc("compare", "cold", "warm").out.split("\n")]
    assert "tolerances load sd 3 % sd 1 %" in lines
    assert "effects warm_probe - slope = 1 um/K new" in lines
    assert any(
        line.startswith("studies reliability ") and line.endswith("values differ (see results.json)") for line in lines
    )


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ({"value": 8.0, "unit": "mm"}, {"value": 9.0, "unit": "mm"}, "+12.5 %"),
        ({"value": 8.0, "unit": "mm"}, {"value": 7.0, "unit": "mm"}, "-12.5 %"),
        ({"value": -1.0, "unit": "mm"}, {"value": -1.5, "unit": "mm"}, "+50 %"),
        ({"value": 0.0, "unit": "mm"}, {"value": -1.5, "unit": "mm"}, "-1.5 mm"),
        ({"value": 20.0, "unit": "degC"}, {"value": 25.0, "unit": "degC"}, "+5 K"),
        ({"value": 1.0, "unit": "mm"}, {"value": 0.25, "unit": "m"}, "in another unit"),
        ({"value": 2.0, "unit": ""}, {"value": 80.0, "unit": ""}, "x 40"),
        ({"value": 9, "unit": ""}, {"value": 8, "unit": ""}, "-1"),
        ({"value": 1.0, "unit": ""}, {"value": 1.0 + 1e-11, "unit": ""}, "below 1e-09 of it"),
        ({"value": "printed", "unit": ""}, {"value": "physical", "unit": ""}, ""),
        ({"value": True, "unit": ""}, {"value": False, "unit": ""}, ""),
        (None, {"value": 1.0, "unit": ""}, "new"),
        ({"value": 1.0, "unit": ""}, None, "gone"),
        ({"value": [1.0, 2.0], "unit": ""}, {"value": [1.0, 3.0], "unit": ""}, "1 of 2 values differ"),
    ],
)
def test_by_how_much(before: Any, after: Any, words: str) -> None:
    assert amount_of(Change("inputs", "x", before, after)) == words


def test_a_limit_that_moved_is_said() -> None:
    check = {"value": 5.0, "limit": 8.0, "unit": "mm", "margin": 0.375, "state": "passes"}
    assert amount_of(Change("checks", "depth", check, {**check, "limit": 6.0, "margin": 1 / 6})) == "limit 8 -> 6"


@pytest.mark.parametrize("state", ["passes", "fails"])
def test_a_check_that_one_run_lacks_did_not_flip(state: str) -> None:
    check = {"value": 5.0, "limit": 8.0, "unit": "mm", "margin": 0.375, "state": state}
    gone, new = Change("checks", "depth", check, None), Change("checks", "depth", None, check)
    assert (gone.flipped, amount_of(gone)) == (False, "gone")
    assert (new.flipped, amount_of(new)) == (False, "new")
    assert styles_of(gone) == styles_of(new) == ("", "", "dim", "bold", "")


def test_what_is_long_or_nested_stays_short() -> None:
    plugin = {"name": "pin", "version": "1.2", "model": "pin_wear"}
    assert words_of(Change("settings", "plugin", plugin, {**plugin, "version": "1.3"}))[2:4] == (
        "pin_wear 1.2", "pin_wear 1.3",
    )  # fmt: skip
    assert words_of(Change("studies", "reliability", {"p": {"value": 1.0}}, None)) == (
        "studies", "reliability", "there", "-", "gone",
    )  # fmt: skip
    effect = {f"unknown_{place}": {"value": 1.0, "unit": "um"} for place in range(20)}
    assert words_of(Change("effects", "many", None, effect))[3] == "(see results.json)"


class Terminal(io.StringIO):
    """A terminal that keeps what it is shown."""

    def isatty(self) -> bool:
        """It is one."""
        return True


def shown(monkeypatch: pytest.MonkeyPatch, **environment: str) -> str:
    """What a terminal of 120 columns shows of the first run beside the heavy one."""
    screen = Terminal()
    for name in ("NO_COLOR", "FORCE_COLOR", "TERM", "COLORTERM"):
        monkeypatch.delenv(name, raising=False)
    for name, value in {"COLUMNS": "120", "TERM": "xterm", **environment}.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr("sys.stdout", screen)
    assert main(["compare", "first", "heavy"]) == 1
    return screen.getvalue()


def test_colour_on_a_terminal_repeats_the_words(runs: Calc, monkeypatch: pytest.MonkeyPatch) -> None:
    plain = runs("compare", "first", "heavy").out
    coloured = shown(monkeypatch)
    flip = next(line for line in coloured.split("\n") if "now FAILS" in line)
    assert "\x1b[1;31m" in flip
    assert re.sub(r"\x1b\[[\d;]*m", "", coloured) == plain
    assert shown(monkeypatch, NO_COLOR="1") == shown(monkeypatch, TERM="dumb") == plain


def diagnosed(folder: Path, document: dict[str, Any]) -> Path:
    folder.mkdir()
    whole = {"schema": "truing.diagnosis/1", "plugin": {}, "kernel": "1", "seed": 0, "verdict": "none", **document}
    (folder / "diagnosis.json").write_text(json.dumps(whole), encoding="utf-8")
    return folder


def cause(value: float) -> dict[str, Any]:
    fitted = {"value": value, "unit": "um", "interval95": [5.9, 6.1]}
    return {"effect": "play", "unknowns": {"clearance": fitted}, "same_as": [], "share": 1.0}


def test_two_diagnoses(calc: Calc, tmp_path: Path) -> None:
    diagnosed(tmp_path / "calm", {})
    diagnosed(tmp_path / "found", {"verdict": "named", "unique": True, "causes": [cause(6.0)]})
    diagnosed(tmp_path / "moved", {"verdict": "named", "unique": True, "causes": [cause(6.06)]})
    lines = [" ".join(line.split()) for line in calc("compare", "calm", "found").out.split("\n")]
    assert lines[1] == "verdict verdict none named"
    assert "causes play - named new" in lines
    assert "causes play.clearance - 6 um new" in lines
    answer = calc("compare", "found", "moved")
    assert (answer.code, answer.err) == (1, "")
    (line,) = [" ".join(line.split()) for line in answer.out.split("\n")[1:-1]]
    assert line == "causes play.clearance 6 um 6.06 um +1 %, within its interval"
    assert calc("compare", "found", "found").out == "equal\n"


def test_a_run_beside_a_diagnosis_is_refused(runs: Calc, tmp_path: Path) -> None:
    diagnosed(tmp_path / "calm", {})
    answer = runs("compare", "first", tmp_path / "calm")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err == "calc: the first is a run and the second a diagnosis; compare two of one kind\n"


# Both side by side, as a page


SPRING = Path(__file__).parents[2] / "docs" / "examples" / "coil_spring.py"


def test_the_page_says_what_changed_and_why_the_verdict_did(runs: Calc) -> None:
    answer = runs("compare", "first", "heavy", "--plugin", PIN, "-o", "page.md")
    assert (answer.code, answer.err) == (1, "")
    assert answer.out.endswith("\n\npage: page.md\n")
    page = (runs.keywords["cwd"] / "page.md").read_text(encoding="utf-8")
    assert "**The verdict went from Passes to Fails.** Because " in page
    assert "| $F$ | normal load on the pin (load) | 120 N | 2300 N | +2180 N | x 19.2 |" in page  # 2300 / 120
    # load / area: 2300 N on 28 mm² is 82.143 MPa, where 80 MPa is permitted, and 120 N is 4.2857 MPa
    assert "| $p$ | contact pressure (pressure) | 4.2857 MPa | 82.143 MPa | +77.857 MPa | x 19.2 |" in page
    assert "✓ pass → ✗ **FAILS**" in page
    assert re.search(r"## \d+ What did not change\n.*hardness", page, re.DOTALL)


def test_folders_and_runs_in_hand_write_one_page(tmp_path: Path) -> None:
    spring = truing.load(SPRING).given(set={"studies.run": "[]"})
    before, after = spring.run(progress=False), spring.run(coil_diameter="7.5 mm", progress=False)
    folders = before.save(tmp_path / "before"), after.save(tmp_path / "after")
    in_hand = after.compare(before).sheet(tmp_path / "in_hand.html").read_text(encoding="utf-8")
    differences = truing.compare(*folders, plugin=str(SPRING))
    assert differences.sheet(tmp_path / "page.html").read_text(encoding="utf-8") == in_hand
    pictures = re.findall(r'<img alt="(Before|After): [^"]*" src="data:image/svg\+xml;base64,([^"]+)"', in_hand)
    assert [word for word, _ in pictures] == ["Before", "After"] * (len(pictures) // 2)
    assert pictures
    assert pictures[0][1] != pictures[1][1]


def test_two_inputs_files_run_now(calc: Calc, tmp_path: Path) -> None:
    (tmp_path / "light.toml").write_text('plugin = "pin_wear"\n[inputs]\nload = "100 N"\n', encoding="utf-8")
    (tmp_path / "heavy.toml").write_text('[inputs]\nload = "150 N"\n', encoding="utf-8")
    answer = calc("compare", "light.toml", "heavy.toml", "--plugin", PIN, "-q")
    assert answer.code == 1
    assert ["inputs", "load", "100", "N", "150", "N", "+50", "%"] in [line.split() for line in answer.out.split("\n")]
    nameless = calc("compare", "heavy.toml", "heavy.toml")
    assert (nameless.code, nameless.out) == (2, "")
    assert nameless.err.startswith('heavy.toml:1: names no plugin; write plugin = "NAME"')


def test_a_number_in_another_unit_of_print_did_not_change() -> None:
    long = in_one_unit(Change("results", "a", {"value": 2500.0, "unit": "um"}, {"value": 2.5, "unit": "mm"}))
    assert same(long.before, long.after)
    warm = in_one_unit(Change("results", "a", {"value": 68.0, "unit": "degF"}, {"value": 21.0, "unit": "degC"}))
    assert warm.before == {"value": pytest.approx(20.0), "unit": "degC"}
    other = Change("results", "a", {"value": 1.0, "unit": "mm"}, {"value": 1.0, "unit": "N"})
    assert in_one_unit(other) == other


def test_two_diagnoses_and_two_plugins_as_a_page(runs: Calc, tmp_path: Path) -> None:
    diagnosed(tmp_path / "calm", {})
    diagnosed(tmp_path / "found", {"verdict": "named", "unique": True, "causes": [cause(6.0)]})
    page = tmp_path / "page.md"
    assert runs("compare", tmp_path / "calm", tmp_path / "found", "-q", "-o", page).code == 1
    text = page.read_text(encoding="utf-8")
    assert "**The verdict went from Nothing found to Cause named.**" in text
    assert r"| play.clearance | \- | 6 um | new |" in text
    first = json.loads((runs.keywords["cwd"] / "first" / "results.json").read_text(encoding="utf-8"))
    sides = (Side("a", first), Side("b", {**first, "plugin": {**first["plugin"], "version": "9.0"}, "seed": 7}))
    said = " ".join(map(plain_text, comparison_page(*sides).banner.sentences))
    assert "and 9.0 after: numbers may differ for that alone." in said
    assert "and 7 after: numbers may differ for that alone." in said


def test_a_page_of_another_ending_is_refused_before_anything_runs(runs: Calc) -> None:
    answer = runs("compare", "first", "no such folder", "-o", "page.txt")
    assert (answer.code, answer.out, answer.err) == (
        2,
        "",
        "calc: page.txt: a sheet ends in .html, .md, .pdf or .docx\n",
    )


def test_a_language_without_a_page_and_one_that_is_none_are_refused_before_anything_runs(runs: Calc) -> None:
    pageless = runs("compare", "first", "no such folder", "--language", "de")
    assert (pageless.code, pageless.out) == (2, "")
    assert pageless.err == "calc: --language is that of the page; name the page with -o, too\n"
    unknown = runs("compare", "first", "no such folder", "--language", "xx", "-o", "page.md")
    assert (unknown.code, unknown.err) == (2, "calc: language: choose en or de, not 'xx'.\n")


def test_the_page_is_written_in_german_and_for_word(tmp_path: Path) -> None:
    spring = truing.load(SPRING).given(set={"studies.run": "[]"})
    before, after = spring.run(progress=False), spring.run(coil_diameter="7 mm", progress=False)
    differences = after.compare(before)
    page = differences.sheet(tmp_path / "page.md", language="de").read_text(encoding="utf-8")
    # 8 F D K / (pi d^3) of 37.2 N is 796.1 MPa, where 700 MPa is permitted
    assert "bisher 595.5 MPa und jetzt 796.1 MPa, wobei ≤ 700 MPa verlangt ist." in page
    assert "| Vorher | Nachher |\n| --- | --- |\n| ![Vorher: Force](data:" in page
    in_hand = docx.Document(str(differences.sheet(tmp_path / "page.docx", language="de")))
    assert len(in_hand.inline_shapes) == 2
    folders = before.save(tmp_path / "before"), after.save(tmp_path / "after")
    read = docx.Document(str(truing.compare(*folders, plugin=str(SPRING)).sheet(tmp_path / "read.docx")))
    said = [paragraph.text for paragraph in read.paragraphs]
    assert not read.inline_shapes
    assert said.count("This figure was read from a sheet: it stands there, and cannot be drawn for Word.") == 2
