"""Links that lead out of docs/: right on disk as they stand, rewritten for the site, their targets copied into it."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator
from pathlib import Path

from manual.places import DOCS, PROJECT, ROOT, pages, place_in_site

_LINK = re.compile(r"(?P<code>^```.*?^```|`[^`\n]*`)|(?<=\]\()(?P<target>[^)\s#]+)", re.DOTALL | re.MULTILINE)


def for_the_site(text: str, page: Path) -> str:
    """Rewrite the links of a page that lead out of docs/, or from beside it into it."""

    def written(target: str) -> str:
        file = _target(target, page)
        if file is None or (_inside(file) and _inside(page)):
            return target
        return os.path.relpath(place_in_site(file), Path(place_in_site(page)).parent).replace(os.sep, "/")

    return _with_targets(text, written)


def files_to_copy() -> dict[str, Path]:
    """Return the files beside docs/ that some page links to and that are no pages, by their place in the site."""
    found = {}
    for page in pages():
        for target in targets(page.read_text(encoding="utf-8")):
            file = _target(target, page)
            if file is not None and not _inside(file) and str(file.relative_to(ROOT)) not in PROJECT:
                found[place_in_site(file)] = file
    return found


def targets(text: str) -> Iterator[str]:
    """Give what the links of a page lead to, code left out."""
    yield from (item["target"] for item in _LINK.finditer(text) if item["target"])


def _with_targets(text: str, written: Callable[[str], str]) -> str:
    return _LINK.sub(lambda item: item["code"] or written(item["target"]), text)


def _target(target: str, page: Path) -> Path | None:
    """Return the file of the project that a link leads to; None for an address."""
    if ":" in target:
        return None
    file = (page.parent / target).resolve()
    return file if ROOT in file.parents else None


def _inside(file: Path) -> bool:
    return DOCS in file.parents
