"""Writing a sheet under a name that the user chooses."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from truing.atomic import write_files
from truing.errors import OutputError
from truing.report.document import Document
from truing.report.html_printer import html_of
from truing.report.markdown_printer import markdown_of
from truing.report.pdf import pdf_bytes


def write_sheet(path: str | Path, make: Callable[[], Document]) -> Path:
    """Write a sheet as HTML, Markdown or PDF, as the name ends, and return its path.

    Raises OutputError for any other ending, for a PDF where no browser can print it, and where it cannot be written.
    """
    file = Path(path)
    ending = file.suffix.lower()
    if ending not in {".html", ".htm", ".md", ".pdf"}:
        raise OutputError(f"{file}: a sheet ends in .html, .md or .pdf")
    sheet = make()
    if ending == ".md":
        write_files({file: markdown_of(sheet)})
    else:
        page = html_of(sheet)
        write_files({file: pdf_bytes(page) if ending == ".pdf" else page})
    return file
