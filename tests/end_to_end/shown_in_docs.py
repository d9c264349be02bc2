"""What the pages show is run: files they ask the reader to write, and commands with the output printed below them.

Marks stand in an HTML comment right above a fenced block:

- ``<!-- file: NAME -->``: the block is this file, whole.
- ``<!-- excel: NAME -->``: the block is this file as a spreadsheet saves it: byte order mark, Windows line ends.
- ``<!-- changes: NAME -->``: its definitions replace those of the same name in NAME; new ones go above the last.
- ``<!-- exit: 2 -->``: the last command of the block ends with this code (0 without the mark).
- ``<!-- not run: WHY -->``: the block is not run.

What is no command and no file is executed or read as ``read_in_docs.py`` says.

A page with ``<!-- needs data: NAME as FILE -->`` is about measurements that are not shipped. Where the environment
variable TRUING_MEASURED names a folder with NAME/data.csv, that file is copied to FILE; else the page is skipped.

A page with ``<!-- long: WHY -->`` is run at full size only, ``--torture=full``: it takes longer than it is worth every
time, and WHY names the test that asks for less of the same every time.

In a ``console`` block every line that begins with ``$`` is a command; what follows is compared with what it prints.
A line ``...`` stands for any lines, ``...`` within a line for any text.

``python tests/end_to_end/shown_in_docs.py [PAGE...]`` writes the present output into pages (all, where none is named)
whose blocks do not match; where a page shows a part, the lines most like those shown.
"""

from __future__ import annotations

import ast
import difflib
import importlib
import io
import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import chdir, contextmanager, redirect_stderr, redirect_stdout
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from read_in_docs import read

from warm import FORKED_WORKERS, Running

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "docs" / "examples"
_FENCE = re.compile(
    r"(?:^<!-- (?P<mark>[^\n]*?) -->\n)?^```(?P<kind>\w*)\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL
)


@dataclass(frozen=True)
class Block:
    """One fenced block of a page: its language, what is in it, its mark, and where its text stands in the page."""

    kind: str
    text: str
    mark: str
    line: int
    start: int

    def marked(self, word: str) -> str:
        """Return what the mark says of a word, or nothing."""
        name, _, value = self.mark.partition(":")
        return value.strip() if name == word else ""


@dataclass(frozen=True)
class Command:
    """One command of a console block, and the lines shown below it."""

    words: str
    shown: str


@dataclass
class Desk:
    """Where a reader works: a folder, and a place for what is installed."""

    folder: Path
    site: Path
    faults: list[str] = field(default_factory=list)
    editable: list[str] = field(default_factory=list)
    namespace: dict[str, Any] = field(default_factory=dict)

    def run(self, words: str) -> tuple[str, int]:
        """Run one command as the reader would; return what a terminal shows, and the exit code."""
        parts = shlex.split(words)
        if parts[0] == "cd":
            self.folder = (self.folder / parts[1]).resolve()
            return "", 0
        if parts[0] == "calc" and not OF_ITS_OWN & set(parts):
            return self._here(parts[1:])
        said, code = self._beside(self._spelled_out(parts))
        if parts[:3] == ["pip", "install", "-e"]:
            self.editable.append(str((self.folder / parts[3].partition("[")[0]).resolve()))
        return "" if parts[0] == "pip" and code == 0 else said, code

    def _beside(self, words: list[str]) -> tuple[str, int]:
        """Run Python in a process of its own; pytest and pip begin in a fresh one."""
        if hasattr(os, "fork") and {"pytest", "pip"}.isdisjoint(words[:2]):
            ended = Running(words, self.folder, self._environment(), together=True).ended()
            return ended.out, ended.code
        done = subprocess.run(
            [sys.executable, *words], cwd=self.folder, env={**os.environ, **self._environment()}, check=False,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, encoding="utf-8", timeout=300,
        )  # fmt: skip
        return done.stdout.replace("\\", "/"), done.returncode  # the pages show paths with /

    def _here(self, words: list[str]) -> tuple[str, int]:
        """Run ``calc`` in this process, and forget the reader's files afterwards: the next command reads them anew."""
        from truing.cli import main

        said, before = io.StringIO(), list(sys.path)
        sys.path[:0] = self._installed()
        importlib.invalidate_caches()
        with chdir(self.folder), redirect_stdout(said), redirect_stderr(said), _terminal():
            code = main(words)
        sys.path[:] = before
        home = str(self.site.parent.resolve())
        for name, module in list(sys.modules.items()):
            if str(getattr(module, "__file__", None) or "").startswith(home):
                del sys.modules[name]
        return said.getvalue(), code

    def _installed(self) -> list[str]:
        """Return where Python finds what the reader installed; what is editable is read where it is edited."""
        return [*self.editable, str(self.site)] if self.site.exists() else []

    def _spelled_out(self, parts: list[str]) -> list[str]:
        """Return what Python is to run for ``calc``, ``python`` and ``pip``; it installs into a folder of its own."""
        if parts[0] == "calc":
            return ["-m", "truing", *parts[1:]]
        if parts[0] == "python":
            return parts[1:]
        if parts[:2] == ["pip", "install"]:
            what = [part for part in parts[2:] if part != "-e"]
            offline = ["--no-deps", "--no-build-isolation", "--no-index", "--quiet", "--target", str(self.site)]
            return ["-m", "pip", "install", *offline, *what]
        raise AssertionError(f"the pages run calc, python, pip install and cd; not {parts[0]}")

    def _environment(self) -> dict[str, str]:
        own = {
            FORKED_WORKERS: "",
            "PYTHONUNBUFFERED": "1",
            "PYTHONIOENCODING": "utf-8",
            "PYTHONPATH": os.pathsep.join(self._installed()),
        }
        return {**own, **TERMINAL, "PYTHONDONTWRITEBYTECODE": "1"}


NEEDED = re.compile(r"^<!-- needs data: (\S+) as (\S+) -->$", re.MULTILINE)


LONG = re.compile(r"^<!-- long: (.+) -->$", re.MULTILINE)


def takes_long(page: Path) -> str:
    """Return why a page is run at full size only, or nothing."""
    found = LONG.search(page.read_text(encoding="utf-8"))
    return found[1] if found else ""


def missing_data(page: Path) -> str:
    """Return why a page cannot be run, or nothing: measurements that it is about are not there."""
    for name, _ in NEEDED.findall(page.read_text(encoding="utf-8")):
        home = os.environ.get("TRUING_MEASURED")
        if not home:
            return f"{page} needs {name}/data.csv, which is not shipped: TRUING_MEASURED names no folder"
        if not (Path(home) / name / "data.csv").is_file():
            return f"{page} needs {name}/data.csv, which is not shipped: there is none in TRUING_MEASURED"
    return ""


def _bring_data(page: Path, desk: Desk) -> None:
    for name, place in NEEDED.findall(page.read_text(encoding="utf-8")):
        shutil.copyfile(Path(os.environ["TRUING_MEASURED"]) / name / "data.csv", desk.folder / place)


TERMINAL = {"COLUMNS": "80", "TERM": "dumb", "NO_COLOR": "1"}
OF_ITS_OWN = {"--workers", "--cluster", "--pdf"}
"""Options of commands that start processes themselves: these are typed as a reader types them."""


@contextmanager
def _terminal() -> Iterator[None]:
    """Let this process have the terminal that the pages show."""
    before = {name: os.environ.get(name) for name in TERMINAL}
    os.environ.update(TERMINAL)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def desk_in(folder: Path) -> Desk:
    """Prepare an empty folder with the examples that the manual ships.

    Commands are run in this process where they may be.
    """
    work = folder / "work"
    work.mkdir(parents=True)
    for example in EXAMPLES.iterdir():
        if example.is_dir():
            shutil.copytree(example, work / example.name, ignore=shutil.ignore_patterns("__pycache__", "runs"))
        else:
            shutil.copy(example, work / example.name)
    return Desk(work, folder / "site")


def blocks(page: Path) -> Iterator[Block]:
    """Give the fenced blocks of a page in order."""
    text = page.read_text(encoding="utf-8")
    for found in _FENCE.finditer(text):
        line = text.count("\n", 0, found.start("text"))
        yield Block(found["kind"], found["text"], found["mark"] or "", line, found.start("text"))


def commands(block: Block) -> Iterator[Command]:
    """Give the commands of a console block."""
    for part in re.split(r"^\$ ", block.text, flags=re.MULTILINE)[1:]:
        words, _, shown = part.partition("\n")
        yield Command(words.strip(), shown)


def check_page(page: Path, desk: Desk) -> list[str]:
    """Do what a page asks and return, by line, where it does not do what the page says."""
    _bring_data(page, desk)
    for block in blocks(page):
        if block.mark.startswith("not run"):
            continue
        try:
            _do(block, page, desk)
        except AssertionError as fault:
            desk.faults.append(f"{page.name}:{block.line}: {fault}")
    return desk.faults


def _do(block: Block, page: Path, desk: Desk) -> None:
    if block.kind == "console":
        for place, (command, end) in enumerate(_with_ends(block), start=1):
            said, code = desk.run(command.words)
            assert code == end, f"command {place}, '{command.words}', ended with {code}, not {end}:\n{said}"
            assert matches(command.shown, said), (
                f"'{command.words}' prints\n{said}\nbut the page shows\n{command.shown}"
            )
    elif block.marked("file"):
        file = desk.folder / block.marked("file")
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(block.text, encoding="utf-8")
    elif block.marked("excel"):
        (desk.folder / block.marked("excel")).write_text(block.text, encoding="utf-8-sig", newline="\r\n")
    elif block.marked("changes"):
        file = desk.folder / block.marked("changes")
        file.write_text(grown(file.read_text(encoding="utf-8"), block.text), encoding="utf-8")
    else:
        read(block, page, desk)


def _with_ends(block: Block) -> list[tuple[Command, int]]:
    """Return the commands with the exit code each must have."""
    found = list(commands(block))
    last = int(block.marked("exit") or 0)
    return [(command, last if command is found[-1] else 0) for command in found]


def matches(shown: str, said: str) -> bool:
    """Compare what a page shows with what a command says; ``...`` stands for anything."""
    lines = [line.rstrip() for line in shown.strip("\n").splitlines()]
    pattern = ""
    for line in lines:
        if line.strip() == "...":
            pattern += r"(?:[^\n]*\n)*?"
        else:
            pattern += r"[^\n]*".join(re.escape(part) for part in line.split("...")) + r"\n"
    plain = "".join(line.rstrip() + "\n" for line in said.strip("\n").splitlines())
    return re.fullmatch(pattern, plain) is not None


def refreshed(shown: str, said: str) -> str:
    """Return what a page should show: the parts between its lines ``...`` anew, shortened lines shortened again.

    A part runs from the line most like its first to the one most like its last.
    """
    lines = [line.rstrip() for line in said.strip("\n").splitlines()]
    found: list[str] = []
    for number, part in enumerate(re.split(r"^\.\.\.\n", shown.strip("\n") + "\n", flags=re.MULTILINE)):
        kept = part.splitlines()
        found += ["..."] if number else []
        if not kept:
            continue
        first = _most_like(kept[0], lines) if number or "..." in shown else 0
        last = first + _most_like(kept[-1], lines[first:]) if "..." in shown else len(lines) - 1
        shortened = [line for line in kept if "..." in line]
        found += [
            next((short for short in shortened if matches(short, line)), line) for line in lines[first : last + 1]
        ]
        lines = lines[last + 1 :]
    return "".join(line + "\n" for line in found)


def _most_like(line: str, others: list[str]) -> int:
    """Return the place of the line that is most like one that may be shortened."""
    if not others:
        return 0
    alike = [
        2.0 if matches(line, other) else difflib.SequenceMatcher(None, line, other, autojunk=False).ratio()
        for other in others
    ]
    return alike.index(max(alike))


def grown(before: str, step: str) -> str:
    """Put the definitions of a step into a file: in the place of those they replace, else above the model.

    What belongs together by name: classes and functions, what is assigned to a name, imports from one module. New
    imports go below the last one.
    """
    old, new = _pieces(before), _pieces(step)
    kept = {name: new.get(name, text) for name, text in old.items()}
    fresh = {name: text for name, text in new.items() if name not in old}
    imports = {name: text for name, text in fresh.items() if name.startswith("import ")}
    others = {name: text for name, text in fresh.items() if name not in imports}
    ordered: list[str] = []
    last_import = [name for name in kept if name.startswith(("import ", "'''"))][-1]
    model = next(name for name in kept if name.isupper() and "Model(" in kept[name])
    for name, text in kept.items():
        ordered += list(others.values()) if name == model else []
        ordered.append(text)
        ordered += list(imports.values()) if name == last_import else []
    return "\n\n".join(ordered) + "\n"


def _pieces(text: str) -> dict[str, str]:
    """Take a file apart into its statements by name."""
    found: dict[str, str] = {}
    lines = text.splitlines()
    for statement in ast.parse(text).body:
        decorators = getattr(statement, "decorator_list", [])
        first = min([statement.lineno, *(item.lineno for item in decorators)])
        found[_name(statement)] = "\n".join(lines[first - 1 : statement.end_lineno])
    return found


def _name(statement: ast.stmt) -> str:
    if isinstance(statement, ast.ImportFrom):
        return f"import {statement.module}"
    if isinstance(statement, ast.Import):
        return f"import {statement.names[0].name}"
    if isinstance(statement, ast.Assign) and isinstance(statement.targets[0], ast.Name):
        return statement.targets[0].id
    if isinstance(statement, (ast.FunctionDef, ast.ClassDef)):
        return statement.name
    if isinstance(statement, ast.If):
        return "import for the type checker"
    assert isinstance(statement, ast.Expr), f"line {statement.lineno}: a step holds imports and definitions"
    return "'''"


def rewrite(page: Path, desk: Desk) -> int:
    """Write the present output into a page where its blocks do not match; return how many commands changed."""
    if why := missing_data(page):
        print(why)
        return 0
    _bring_data(page, desk)
    text, changed, moved = page.read_text(encoding="utf-8"), 0, 0
    for block in blocks(page):
        if block.mark.startswith("not run") or block.kind != "console":
            if not block.mark.startswith("not run"):
                _do(block, page, desk)
            continue
        shown = ""
        for command, end in _with_ends(block):
            said, code = desk.run(command.words)
            if code != end:
                print(f"{page}:{block.line}: '{command.words}' ended with {code}, not {end}")
            good = code != end or matches(command.shown, said)
            fresh = command.shown if good else refreshed(command.shown, said)
            if not good and not matches(fresh, said):
                print(f"{page}:{block.line}: '{command.words}' no longer prints what the page shows in part")
                fresh = command.shown
            changed += fresh != command.shown
            shown += f"$ {command.words}\n" + fresh
        start = block.start + moved
        text = text[:start] + shown + text[start + len(block.text) :]
        moved += len(shown) - len(block.text)
    page.write_text(text, encoding="utf-8")
    return changed


if __name__ == "__main__":
    import tempfile

    every = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    for argument in map(Path, sys.argv[1:] or every):
        with tempfile.TemporaryDirectory() as name:
            print(argument, rewrite(argument.resolve(), desk_in(Path(name))))
