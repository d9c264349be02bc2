"""What is made when the site is built: whole files, and parts of pages that ask for them by a mark."""

from __future__ import annotations

import re
from pathlib import Path

from manual import gallery, model_page, models

_PARTS = {"models": models.list_of_models, "effects": models.list_of_effects, "gallery": gallery.cards}
_MARK = re.compile(r"^<!-- made: (\w+) -->$", re.MULTILINE)


def files() -> dict[str, str | Path]:
    """Return every file that is made, by its place in the site: its text, or where it lies."""
    return {**model_page.pages(), **dict(gallery.files())}


def filled(text: str) -> str:
    """Put what is made in the place of the marks of a page."""
    return _MARK.sub(lambda item: _PARTS[item[1]](), text)
