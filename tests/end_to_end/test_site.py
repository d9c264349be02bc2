"""The site of the manual: built strictly, whole, and without a word that leads a browser elsewhere."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from built_site import site  # noqa: F401

from shared import ROOT

DOCS = ROOT / "docs"


def pages(site: Path) -> list[Path]:  # noqa: F811
    found = sorted(site.rglob("*.html"))
    assert len(found) > 50
    return found


def test_every_page_on_disk_is_a_page_of_the_site(site: Path) -> None:  # noqa: F811
    for page in DOCS.rglob("*.md"):
        if DOCS / "site" in page.parents:
            continue
        place = page.relative_to(DOCS).with_suffix(".html")
        place = place.with_name("index.html") if place.name == "README.html" else place
        assert (site / place).is_file(), place
