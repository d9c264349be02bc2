"""Where things lie, on disk and in the site."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).parents[3]
DOCS = ROOT / "docs"
SITE = DOCS / "site"
PROJECT = {"README.md": "project/overview.md", "CONTRIBUTING.md": "project/contributing.md",
           "CHANGELOG.md": "project/changelog.md"}  # fmt: skip
"""Pages beside docs/, and what they are called in the site."""


def pages() -> list[Path]:
    """Return every page that lies on disk."""
    inside = [page for page in sorted(DOCS.rglob("*.md")) if SITE not in page.parents]
    return [*inside, *(ROOT / name for name in PROJECT)]


def place_in_site(file: Path) -> str:
    """Return the path by which the site knows a file of the project; what lies beside docs/ is copied to files/."""
    if DOCS in file.parents:
        return file.relative_to(DOCS).as_posix()
    name = file.relative_to(ROOT).as_posix()
    return PROJECT.get(name) or f"files/{name}" + ("" if file.suffix else ".txt")
