"""Texts that are written from templates: where these are, and how one that is no page is filled in."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from truing.errors import UsageError

ENGLISH = "en"
"""The language in which everything is written; the others are translations of it."""


def languages() -> list[str]:
    """Return the languages that a sheet can be in, English first."""
    return [ENGLISH, *sorted(file.stem for file in (template_folder() / "words").glob("*.toml"))]


def demand_language(language: str) -> None:
    """Raise UsageError for a language that a sheet cannot be in; "" is none."""
    if language and language not in languages():
        raise UsageError(f"language: choose {' or '.join(languages())}, not '{language:.40}'.")


def template_folder() -> Path:
    """Return the folder of the templates, in a wheel and in an editable install alike."""
    package = Path(__file__).resolve().parent
    for folder in (package / "templates", package.parents[1] / "templates"):
        if (folder / "sheet.html.j2").is_file():
            return folder
    raise FileNotFoundError(f"the templates of the sheets are missing from {package}; install truing again")


def rendered(template: str, words: Mapping[str, Any]) -> str:
    """Fill in a template; what a word holds is printed, never obeyed."""
    return _environment().get_template(template).render(words)


@lru_cache(maxsize=1)
def _environment() -> Environment:
    return Environment(
        loader=FileSystemLoader(template_folder()), undefined=StrictUndefined, trim_blocks=True,
        keep_trailing_newline=True,
    )  # fmt: skip
