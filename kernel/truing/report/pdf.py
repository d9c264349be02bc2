"""PDF: the sheet as a browser prints it. Nothing else sets the formulas right."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path

from truing.errors import OutputError
from truing.heavy import pypdf

NAMES = (
    "chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome", "microsoft-edge",
    "microsoft-edge-stable", "msedge",
)  # fmt: skip
WINDOWS = (
    r"Google\Chrome\Application\chrome.exe",
    r"Microsoft\Edge\Application\msedge.exe",
    r"Chromium\Application\chrome.exe",
)
MAC = (
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    "/Applications/Chromium.app/Contents/MacOS/Chromium",
    "/Applications/Microsoft Edge.app/Contents/MacOS/Microsoft Edge",
)
QUIET = (
    "--headless", "--disable-gpu", "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--disable-extensions", "--no-first-run", "--no-default-browser-check", "--no-pdf-header-footer",
)  # fmt: skip
HOW_TO_PRINT = "open sheet.html in any browser and print it to PDF (Ctrl+P), with background graphics on"
PATIENCE = 120.0


def find_browser() -> Path | None:
    """Return a Chromium, Chrome or Edge on this machine, or None; CHROME_PATH names one."""
    named = os.environ.get("CHROME_PATH", "")
    for name in [named] if named else NAMES:
        program = shutil.which(name)
        if program:
            return Path(program)
    usual = () if named else _usual_places()
    return next((path for path in usual if path.is_file()), None)


def _usual_places() -> Iterator[Path]:
    system: str = sys.platform
    if system == "win32":
        for variable in ("PROGRAMFILES", "PROGRAMFILES(X86)", "LOCALAPPDATA"):
            root = os.environ.get(variable)
            yield from (Path(root, name) for name in WINDOWS if root)
    elif system == "darwin":
        yield from (Path(name) for name in MAC)
        yield from (Path.home() / name.lstrip("/") for name in MAC)


def sandbox_arguments() -> list[str]:
    """Return what a browser needs to start as root, where its sandbox cannot work; nothing for anybody else."""
    is_root = hasattr(os, "geteuid") and os.geteuid() == 0
    return ["--no-sandbox"] if is_root else []


def pdf_bytes(html: str, browser: Path | None = None) -> bytes:
    """Print the text of a sheet, on the paper that it names, and return the PDF.

    The browser runs unseen, with an empty profile and no word to the network; once more where the sheet has contents,
    with the page of each chapter in them, if the library is installed that finds it (the extra ``pdf``).
    Raises OutputError with one sentence: no browser (and how to print without), or what went wrong.
    """
    browser = browser or find_browser()
    if browser is None:
        raise OutputError(f"no Chromium, Chrome or Edge was found for the PDF (CHROME_PATH names one); {HOW_TO_PRINT}")
    content = _printed(html, browser)
    if not PAGE_OF.search(html) or find_spec("pypdf") is None:
        return content
    pages: dict[str, int] = {}
    for _ in range(MOST_PRINTS - 1):
        before, pages = pages, pages_of(content)
        if pages == before:
            break
        content = _printed(with_pages(html, pages), browser)
    return content


def _printed(html: str, browser: Path) -> bytes:
    with tempfile.TemporaryDirectory(prefix="truing-print-", ignore_cleanup_errors=True) as folder:
        page, made = Path(folder, "sheet.html"), Path(folder, "sheet.pdf")
        page.write_text(html, encoding="utf-8")
        command = [
            str(browser), *QUIET, *sandbox_arguments(), f"--user-data-dir={Path(folder, 'profile')}",
            f"--print-to-pdf={made}", page.as_uri(),
        ]  # fmt: skip
        try:
            done = subprocess.run(command, capture_output=True, timeout=PATIENCE, check=False)
        except subprocess.TimeoutExpired:
            raise OutputError(f"{browser.name} did not print within {PATIENCE:.0f} s; {HOW_TO_PRINT}") from None
        except OSError as error:
            raise OutputError(f"{browser} cannot be started: {error.strerror or error}; {HOW_TO_PRINT}") from None
        content = made.read_bytes() if made.is_file() else b""
        if done.returncode or not content.startswith(b"%PDF"):
            last = " ".join(done.stderr.decode("utf-8", "replace").strip().splitlines()[-1:])
            raise OutputError(f"{browser.name} printed no PDF ({last or f'exit {done.returncode}'}); {HOW_TO_PRINT}")
        return content


# Page numbers in the contents, which no style sheet of a browser can give


PAGE_OF = re.compile(r'(<span class="page" data-of="([^"]+)">)(</span>)')
"""Where the contents have room for the page of a chapter."""
MOST_PRINTS = 3
"""So often a sheet is printed at the most; numbers have room of their own, so the second print moves nothing."""


def pages_of(pdf: bytes) -> dict[str, int]:
    """Return the page, counted from 1, of everything in a PDF that a link leads to, by its identifier in the sheet."""
    reader = pypdf.PdfReader(BytesIO(pdf))
    places = {name: reader.get_destination_page_number(place) for name, place in reader.named_destinations.items()}
    return {name.removeprefix("/"): page + 1 for name, page in places.items() if page is not None}


def with_pages(html: str, pages: Mapping[str, int]) -> str:
    """Write the pages of its chapters into the contents of a sheet."""
    return PAGE_OF.sub(lambda match: f"{match[1]}{pages.get(match[2], '')}{match[3]}", html)
