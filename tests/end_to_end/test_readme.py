"""The README: its two commands as they are written, and its tour, which is run."""

from __future__ import annotations

import re
import shlex
from pathlib import Path
from typing import Any

import pytest
import typer.main
from shown_in_docs import ROOT, blocks, check_page, commands, desk_in

from truing.cli import main
from truing.cli.app import app
from truing.kernel import Kernel

README = ROOT / "README.md"


def lines_of(kind: str) -> list[str]:
    """The lines of the README's blocks of one language."""
    return [line for block in blocks(README) if block.kind == kind for line in block.text.splitlines()]


def parts(line: str) -> list[list[str]]:
    """The commands that ``&&`` joins, as words."""
    return [shlex.split(part) for part in line.split(" && ")]


def test_there_are_two_commands_of_one_line_each() -> None:
    first, second = lines_of("sh")
    assert parts(first) == [
        ["python3", "-m", "venv", ".venv"],
        [".venv/bin/pip", "install", "."],
        [".venv/bin/calc", "run", "press_linkage", "--inputs", "plugins/press_linkage/example.toml"],
    ]
    assert parts(second) == [
        ["python3", "-m", "venv", ".venv"],
        [".venv/bin/pip", "install", "-e", ".[test]"],
        [".venv/bin/python", "-m", "pytest", "-n", "auto"],
    ]


def test_windows_has_the_same_two() -> None:
    for unix, windows in zip(lines_of("sh"), lines_of("powershell"), strict=True):
        said = windows.replace("\\", "/").replace(".venv/Scripts", ".venv/bin").replace("py -m venv", "python3 -m venv")
        assert said == unix


def test_the_first_command_runs_the_shipped_example_and_the_sheet_is_where_the_readme_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    calc = parts(lines_of("sh")[0])[-1]
    monkeypatch.chdir(tmp_path)
    assert main([*calc[1:-1], str(ROOT / calc[-1]), "--set", "studies.run=[]"]) == 1  # limits on chances stay undecided
    (place,) = re.findall(r"The sheet is then in `(.*?)`", README.read_text(encoding="utf-8"))
    assert (tmp_path / place).is_file()


def test_ci_runs_the_test_command_of_the_readme() -> None:
    pytest_words = " ".join(parts(lines_of("sh")[1])[-1][1:])
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    assert pytest_words == "-m pytest -n auto"
    assert pytest_words in script
    assert ".[test]" in script


def test_the_tour_does_what_it_shows(tmp_path: Path) -> None:
    faults = check_page(README, desk_in(tmp_path))
    assert not faults, "\n".join(faults)


def test_the_diagnosis_is_that_of_the_tutorial() -> None:
    (block,) = [block for block in blocks(README) if "my_press_is_off_by_40_um" in block.marked("not run")]
    page = (ROOT / block.marked("not run").removesuffix(" runs it")).read_text(encoding="utf-8")
    said = [line for line in block.text.splitlines()[1:] if line and "..." not in line]
    assert len(said) > 3
    assert [line for line in said if line not in page.splitlines()] == []


def test_the_tour_visits_what_it_promises() -> None:
    typed = [command.words for block in blocks(README) if block.kind == "console" for command in commands(block)]
    assert {words.split()[1] for words in typed} >= {"init", "run", "compare", "verify", "describe"}
    assert any("--set" in words for words in typed)
    assert any("./bolt.py" in words for words in typed)


NUMBERS = {11: "eleven", 13: "thirteen", 16: "sixteen", 18: "eighteen", 20: "twenty"}


def test_it_lists_every_verb_and_every_plugin_with_its_effects() -> None:
    text = re.sub(r"\s+", " ", README.read_text(encoding="utf-8"))
    (listed,) = re.findall(r"and the verbs `([a-z ]+)`", text)
    group: Any = typer.main.get_command(app)
    assert sorted(listed.split()) == sorted(group.commands)
    said = dict(re.findall(r"`(\w+)` \([^()]*?(\w+) effects\)", text))
    offers = Kernel.installed().offers
    assert said == {name: NUMBERS[len(offer.model.effects)] for name, offer in offers.items() if "." not in name}


def test_the_pictures_are_there_and_not_heavy() -> None:
    pictures = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", README.read_text(encoding="utf-8"))
    assert [Path(picture).name for picture in pictures] == ["sheet.png", "diagnosis.png", "workbench.png"]
    for picture in pictures:
        assert (ROOT / picture).stat().st_size < 400_000
        assert (ROOT / picture).read_bytes().startswith(b"\x89PNG")
