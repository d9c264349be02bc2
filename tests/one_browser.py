"""The browser of this machine, one for all tests; those that use it are marked."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from shared import missed
from truing.report.pdf import find_browser, sandbox_arguments

if TYPE_CHECKING:
    from playwright.sync_api import Browser

QUIET = [
    "--disable-gpu",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
]


@pytest.fixture(scope="session")
def chromium() -> Path:
    """The browser of this machine; without one the tests are skipped, but never where CI=true says it must be there."""
    found = find_browser()
    if found is None:
        missed("no Chromium, Chrome or Edge on this machine (CHROME_PATH names one): the sheet was not looked at")
    return found


@pytest.fixture(scope="session")
def browser(chromium: Path) -> Iterator[Browser]:
    from playwright.sync_api import sync_playwright

    driver = Path(sys.executable).with_name("playwright")
    if driver.exists() and subprocess.run([driver, "--version"], capture_output=True).returncode:
        missed("Playwright does not start on this machine (Debian: libatomic1): the sheet was not looked at")
    with sync_playwright() as play:
        running = play.chromium.launch(executable_path=chromium, args=[*QUIET, *sandbox_arguments()])
        yield running
        running.close()
