"""calc new: a plugin of one's own, as a project or as a single file."""

from __future__ import annotations

import os
import shlex
from pathlib import Path
from types import SimpleNamespace

from truing.cli.console import Settings
from truing.drafted import draft_of, drafted_file
from truing.errors import UsageError
from truing.new_project import (
    NewPlugin,
    check_name,
    check_title,
    project,
    single_file,
    title_of,
    write_project,
    write_single_file,
)
from truing.workbooks.reading import file_of


def new(settings: Settings, asked: SimpleNamespace) -> int:
    """Write a plugin of your own: package, tests, entry point, CI; it works as written."""
    check_name(asked.name)
    if asked.title is not None:
        check_title(asked.title)
    plan = NewPlugin(asked.name, asked.title.strip() if asked.title is not None else title_of(asked.name))
    if asked.workbook is not None:
        settings.say("\n".join(_drafted(plan, asked.workbook, asked.output)))
        return 0
    steps = _file(plan, asked.output) if asked.single else _project(plan, asked.output)
    settings.say("\n".join([*steps, "the physics in it is a placeholder, a clamped bar: replace it by your own"]))
    return 0


def _project(plan: NewPlugin, output: Path | None) -> list[str]:
    """Write a project; return what to type next."""
    folder = output if output is not None else Path(plan.name)
    files = project(plan)
    write_project(folder, files)
    return [
        f"wrote {folder}: {len(files)} files; now:",
        *([f"  cd {_typed(str(folder))}"] if folder.resolve() != Path.cwd() else []),
        '  pip install -e ".[test]"',
        f"  calc diagnose {plan.name} --data measured.csv",
    ]


def _file(plan: NewPlugin, output: Path | None) -> list[str]:
    """Write a single file; return what to type next."""
    path, word = _place(plan, output)
    write_single_file(path, single_file(plan))
    return [
        f"wrote {path}; now:",
        f"  calc run {word}",
        f"  calc init {word} -o {plan.name}.toml",
        f"  python -m pytest {word}",
    ]


def _drafted(plan: NewPlugin, workbook: Path, output: Path | None) -> list[str]:
    """Write a single file drafted from a workbook; return what became of its cells, and what to type next."""
    path, word = _place(plan, output)
    draft = draft_of(workbook)
    write_single_file(path, drafted_file(plan, draft, file_of(workbook).name))
    odd = [
        f"{one.cell}: {one.typed} is not translated, {one.why}; its value is an input"
        for one in draft.inputs
        if one.why
    ]
    left_out = [f"{cell.cell}: {cell.typed} is left out, {cell.why}" for cell in draft.left_out]
    return [
        f"wrote {path}: {len(draft.inputs)} inputs, {len(draft.results)} results from {workbook.name}",
        *draft.said, *odd, *left_out,
        "now read it, and:",
        f"  calc run {word}",
        f"  calc verify {word}",
    ]  # fmt: skip


def _place(plan: NewPlugin, output: Path | None) -> tuple[Path, str]:
    """Return where a single file goes, and how that is typed."""
    path = output if output is not None else Path(f"{plan.name}.py")
    if path.suffix != ".py":
        raise UsageError(f"--output: {path} is no name of a Python file; a single file ends in .py")
    return path, _typed(str(path) if path.is_absolute() else f"./{path.as_posix()}")


def _typed(path: str) -> str:
    """Write a path as one types it."""
    if os.name != "nt":
        return shlex.quote(path)
    return f'"{path}"' if " " in path else path
