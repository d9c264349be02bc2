"""The calculation sheet: neutral content first, then HTML, Markdown and PDF from the same content."""

from __future__ import annotations

from pathlib import Path

# Where the templates of the sheets are: inside the installed package, or beside the sources


def template_folder() -> Path:
    """Return the folder of the templates, in a wheel and in an editable install alike."""
    package = Path(__file__).resolve().parents[1]
    for folder in (package / "templates", package.parents[1] / "templates"):
        if (folder / "sheet.html.j2").is_file():
            return folder
    raise FileNotFoundError(f"the templates of the sheets are missing from {package}; install truing again")
