"""``calc new`` from the command line: what it says, what it leaves, and that types and style are clean as written."""

from __future__ import annotations

import ast
import re
import sys
from pathlib import Path
from typing import Any

import pytest
import typer.main

from shared import ROOT, Answer, Calc, process
from truing.cli.app import app
from truing.kernel.loading import load_file
from truing.new_project import (
    LONGEST_NAME,
    WIDEST_TITLE,
    NewPlugin,
    project,
    single_file,
    write_project,
    write_single_file,
)

PLANS = [
    NewPlugin("q", "Q"),
    NewPlugin("gantry_arm", 'Träger „Größe“ \\ 5" wide'),
    NewPlugin("a" + "_b" * 19 + "c", "'" * (WIDEST_TITLE // 2)),
    NewPlugin("w" * LONGEST_NAME, "梁" * (WIDEST_TITLE // 2)),
]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Every plan as a project and, beside it, as a single file."""
    folder = tmp_path_factory.mktemp("made")
    for plan in PLANS:
        write_project(folder / f"{plan.name}-project", project(plan))
        write_single_file(folder / "single" / f"alone_{plan.name}.py", single_file(plan))
    return folder


def tool(folder: Path, *arguments: str) -> Answer:
    return process([sys.executable, "-m", *arguments], folder)


def test_style_is_clean_as_written(made: Path) -> None:
    """Each project by its own settings, a single file by those that ruff has without any."""
    for words in (["check"], ["format", "--check"]):
        answer = tool(made, "ruff", *words, "--no-cache", ".")
        assert answer.code == 0, answer.out
    settings = tool(made / f"{PLANS[0].name}-project", "ruff", "check", "--show-settings", "q/__init__.py")
    assert "undocumented-public-module (D100)" in settings.out


def test_types_are_clean_as_written(made: Path) -> None:
    """Strictly, by the settings of a project; the cache is that of the house."""
    own = made / f"{PLANS[0].name}-project"
    paths = [
        *(str(made / f"{plan.name}-project" / part) for plan in PLANS for part in (plan.name, "tests")),
        *map(str, sorted((made / "single").glob("*.py"))),
    ]
    answer = tool(own, "mypy", "--cache-dir", str(ROOT / ".mypy_cache"), *paths)
    assert answer.code == 0, answer.out
    assert f"{4 * len(PLANS)} source files" in answer.out


def test_a_project_is_written_where_one_stands(calc: Calc, tmp_path: Path) -> None:
    here = calc("new", "gantry_arm", "--output", ".")
    assert (here.code, here.out) == (0, "")
    assert here.err.startswith(f"wrote .: {len(project(PLANS[1]))} files; now:\n")
    assert "  cd " not in here.err
    assert (tmp_path / "gantry_arm" / "physics.py").is_file()
    spaced = calc("new", "gantry_arm", "-q", "--output", tmp_path / "ä b" / "c")
    assert (spaced.code, spaced.out + spaced.err) == (0, "")


def test_the_readme_names_verbs_and_files_that_are_there() -> None:
    files = project(PLANS[1])
    group: Any = typer.main.get_command(app)
    named = set(re.findall(r"calc (\w+)", files["README.md"]))
    assert {"run", "init", "diagnose", "describe", "new"} <= named <= set(group.commands)
    assert set(re.findall(r"`([\w./]+/[\w./]+\.\w+)`", files["README.md"])) - set(files) == {
        "runs/gantry_arm/sheet.html",
        "runs/measured/extended.toml",
    }
    assert {word for word in ("Bar", "Bending", "bend", "soft_clamp") if f"`{word}`" in files["README.md"]} == {
        node.name
        for node in ast.parse(files["gantry_arm/physics.py"]).body
        if isinstance(node, (ast.ClassDef, ast.FunctionDef))
    }


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["class"], "'class' is a word of Python itself; choose another name"),
        (["rv_wear", "--single-file"], "'rv_wear' is a calculation of truing; choose another name"),
        (["belt", "--title", "two\nlines"], "--title: a title is one line of printable characters"),
        (["belt", "--single-file", "--output", "belt.txt"], "belt.txt is no name of a Python file"),
        (["belt", "--single-file", "--output", "there.py"], "there.py: is there already; name another file"),
        (["belt", "--single-file", "--output", "folder.py"], "folder.py: is a folder; name the file"),
        (["belt", "--output", "there.py"], "there.py: is there already and no folder; name another place"),
        (["belt", "--output", "there.py/below"], "there.py/below: the project cannot be written: "),
        (
            ["belt", "--single-file", "--output", "there.py/b.py"],
            "there.py/b.py: cannot be written: there.py is a file and no folder",
        ),
    ],
)
def test_what_is_refused_leaves_nothing(calc: Calc, tmp_path: Path, words: list[str], sentence: str) -> None:
    (tmp_path / "there.py").write_text("mine\n", encoding="utf-8")
    (tmp_path / "folder.py").mkdir()
    answer = calc("new", *words)
    assert answer.code == 2
    assert answer.err.startswith("calc: ")
    assert sentence in answer.err.replace("\\", "/")
    assert answer.err.count("\n") == 1
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["folder.py", "there.py"]
    assert (tmp_path / "there.py").read_text(encoding="utf-8") == "mine\n"


def test_a_single_file_passes_its_own_tests(made: Path) -> None:
    module = load_file(made / "single" / f"alone_{PLANS[0].name}.py")
    tests = [item for name, item in vars(module).items() if name.startswith("test_")]
    assert len(tests) == 3
    for test in tests:
        test()
