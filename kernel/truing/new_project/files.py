"""The files of a new plugin, from their templates, and how they come to the disk: complete or not at all."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from truing.atomic import place_folder, recover, write_files
from truing.errors import OutputError
from truing.report.markdown import escaped
from truing.report.templates import template_folder

PROJECT = {
    ".github/workflows/tests.yml": "workflow.yml.j2",
    ".gitignore": "gitignore.j2",
    "README.md": "README.md.j2",
    "measured.csv": "measured.csv",
    "pyproject.toml": "pyproject.toml.j2",
    "NAME/__init__.py": "package.py.j2",
    "NAME/physics.py": "physics.py.j2",
    "NAME/py.typed": "py.typed.j2",
    "tests/test_NAME.py": "tests.py.j2",
}
"""The files of a project by their path, and the template of each; NAME stands for the plugin's name."""


@dataclass(frozen=True)
class NewPlugin:
    """What a new plugin is called: its name in Python and on the command line, and the title of its sheet."""

    name: str
    title: str

    @property
    def words(self) -> dict[str, str]:
        """What the templates may print, the title written for every language that quotes it."""
        return {
            "name": self.name,
            "distribution": self.name.replace("_", "-"),
            "title_python": python_text(self.title),
            "title_toml": json.dumps(self.title, ensure_ascii=False),
            "title_markdown": escaped(self.title),
            "truing": ".".join(version("truing").split(".")[:2]),
        }


def python_text(text: str) -> str:
    """Write a printable text as a Python literal, with the quotation mark that needs fewer escapes."""
    mark = "'" if text.count('"') > text.count("'") else '"'
    return mark + text.replace("\\", "\\\\").replace(mark, "\\" + mark) + mark


def project(plan: NewPlugin) -> dict[str, str]:
    """Return the files of a project by their path inside it: package, tests, packaging, README, CI, made rows."""
    return {
        path.replace("NAME", plan.name): rendered(f"plugin/{template}", plan.words)
        for path, template in PROJECT.items()
    }


def single_file(plan: NewPlugin) -> str:
    """Return a plugin as one Python file: physics, model, hook and tests."""
    return rendered("single/calculation.py.j2", plan.words)


def rendered(template: str, words: Mapping[str, str]) -> str:
    """Fill in a template; what a word holds is printed, never obeyed."""
    return _environment().get_template(template).render(words)


@lru_cache(maxsize=1)
def _environment() -> Environment:
    return Environment(
        loader=FileSystemLoader(template_folder()), undefined=StrictUndefined, trim_blocks=True,
        keep_trailing_newline=True,
    )  # fmt: skip


def write_project(folder: Path, files: Mapping[str, str]) -> None:
    """Write a project into a folder that is not there yet, or empty.

    Raises OutputError where something lies there, or where nothing can be written; then nothing is.
    """
    try:
        if folder.is_dir():
            recover(folder.absolute() / folder.absolute().name)
            if any(folder.iterdir()):
                raise OutputError(f"{folder}: the folder is there and not empty; name another place with --output")
        elif folder.exists() or folder.is_symlink():
            raise OutputError(f"{folder}: is there already and no folder; name another place with --output")
    except OSError as error:
        raise OutputError(f"{folder}: the project cannot be written: {error.strerror or error}") from error
    place_folder(folder, files, "project")


def write_single_file(path: Path, text: str) -> None:
    """Write one file that is not there yet. Raises OutputError where it is, or where it cannot be written."""
    if path.is_dir():
        raise OutputError(f"{path}: is a folder; name the file with --output")
    if path.exists():
        raise OutputError(f"{path}: is there already; name another file with --output")
    write_files({path: text})
