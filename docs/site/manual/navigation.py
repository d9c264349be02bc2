"""The navigation: the folders of the manual, in the order in which docs/index.md links to what is in them."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import PurePosixPath
from typing import Any

from manual.places import DOCS, place_in_site

LONGEST = 42
"""A title with more characters than this is left to the page, where the index has a shorter name."""

FOLDERS = ("tutorial", "how-to", "reference", "explanation", "examples", "gallery")
"""The folders in the order of the navigation; any other comes after them, what lies beside docs/ at the end."""

MODEL = re.compile(r"reference/models/(?!README).*\.md")
"""Pages that go by the name that is typed."""
_ENTRY = re.compile(r"\[([^\]]+)\]\(([^)\s#]+\.md)\)")
Titles = Mapping[str, str]


def titles_of_index() -> dict[str, str]:
    """Return the pages that the index links to, in order, with the words of the link."""
    text = (DOCS / "index.md").read_text(encoding="utf-8")
    found: dict[str, str] = {}
    for words, target in _ENTRY.findall(text):
        plain = " ".join(words.replace("`", "").split())
        found.setdefault(place_in_site((DOCS / target).resolve()), plain[:1].upper() + plain[1:])
    return found


def navigation(pages: Titles) -> list[dict[str, Any]]:
    """Arrange pages, given with their first headings, as mkdocs wants its ``nav``."""
    linked = titles_of_index()
    order = {place: number for number, place in enumerate(linked)}
    titles = {place: _title(linked.get(place), own) for place, own in pages.items()}
    titles |= {place: PurePosixPath(place).stem for place in pages if MODEL.fullmatch(place)}
    first = {"Truing: the manual": "index.md"}
    rest = [place for place in pages if place != "index.md"]
    ordered = sorted(rest, key=lambda place: (order.get(place, len(order)), place))
    rank = {name: number for number, name in enumerate([*FOLDERS, "", "project"])}
    ordered.sort(key=lambda place: rank.get(place.partition("/")[0], rank[""]))
    return [first, *_folder(ordered, titles, depth=0)]


def _title(linked: str | None, own: str) -> str:
    """The page's own heading, or the words of the index where that is long."""
    if linked and len(own) > LONGEST >= len(linked):
        return linked
    return own.partition(": ")[0] if len(own) > LONGEST else own


def _folder(places: Sequence[str], titles: Titles, depth: int) -> list[dict[str, Any]]:
    """Return what is in a folder: its pages, then its folders; a folder with one page is that page."""
    parts = {place: PurePosixPath(place).parts for place in places}
    found: list[dict[str, Any]] = [{titles[place]: place} for place in places if len(parts[place]) == depth + 1]
    for name in dict.fromkeys(parts[place][depth] for place in places if len(parts[place]) > depth + 1):
        below = [place for place in places if len(parts[place]) > depth + 1 and parts[place][depth] == name]
        inner = _folder(below, titles, depth + 1)
        found += inner if len(inner) == 1 and depth else [{name.replace("-", " ").capitalize(): inner}]
    return found
