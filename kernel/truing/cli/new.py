"""calc new: a plugin of one's own, as a project or as a single file."""

from __future__ import annotations

import os
import shlex
from pathlib import Path
from types import SimpleNamespace

from truing.cli.console import Settings
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


def new(settings: Settings, asked: SimpleNamespace) -> int:
    """Write a plugin of your own: package, tests, entry point, CI; it works as written."""
    check_name(asked.name)
    if asked.title is not None:
        check_title(asked.title)
    plan = NewPlugin(asked.name, asked.title.strip() if asked.title is not None else title_of(asked.name))
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
    path = output if output is not None else Path(f"{plan.name}.py")
    if path.suffix != ".py":
        raise UsageError(f"--output: {path} is no name of a Python file; with --single-file it ends in .py")
    write_single_file(path, single_file(plan))
    word = _typed(str(path) if path.is_absolute() else f"./{path.as_posix()}")
    return [
        f"wrote {path}; now:",
        f"  calc run {word}",
        f"  calc init {word} -o {plan.name}.toml",
        f"  python -m pytest {word}",
    ]


def _typed(path: str) -> str:
    """Write a path as one types it."""
    if os.name != "nt":
        return shlex.quote(path)
    return f'"{path}"' if " " in path else path
