"""The browser of this machine, one for all tests; those that use it are marked."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from shared import missed
from truing.report.pdf import find_browser, sandbox_arguments

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Playwright

QUIET = [
    "--disable-gpu",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
    "--renderer-process-limit=1",  # pages of one site share a process: starting one costs more than drawing most pages
]
FIREFOX = ("firefox", "firefox-esr", "/Applications/Firefox.app/Contents/MacOS/firefox")
"""Names of a Firefox: as a command, of Debian, of macOS."""


@pytest.fixture(scope="session")
def chromium() -> Path:
    """The browser of this machine; without one the tests are skipped, but never where CI=true says it must be there."""
    found = find_browser()
    if found is None:
        missed("no Chromium, Chrome or Edge on this machine (CHROME_PATH names one): the sheet was not looked at")
    return found


@pytest.fixture(scope="session")
def player() -> Iterator[Playwright]:
    """What drives browsers; it can be started once in a process."""
    from playwright.sync_api import sync_playwright

    driver = Path(sys.executable).with_name("playwright")
    if driver.exists() and subprocess.run([driver, "--version"], capture_output=True).returncode:
        missed("Playwright does not start on this machine (Debian: libatomic1): the sheet was not looked at")
    with sync_playwright() as play:
        yield play


@pytest.fixture(scope="session")
def browser(chromium: Path, player: Playwright) -> Iterator[Browser]:
    running = player.chromium.launch(executable_path=chromium, args=[*QUIET, *sandbox_arguments()])
    yield running
    running.close()


@pytest.fixture(scope="session")
def firefox(player: Playwright) -> Iterator[Browser]:
    """The Firefox of this machine; without one the tests are skipped."""
    found = next((path for path in map(shutil.which, FIREFOX) if path), None)
    if found is None:
        pytest.skip("no Firefox on this machine: the workbench was looked at in Chromium only")
    try:
        running = player.firefox.launch(executable_path=found, channel="moz-firefox")
        running.new_context().close()
    except Exception as error:
        reason = str(error).splitlines()[0]
        pytest.skip(f"this Firefox and this Playwright do not fit together ({reason}): looked at in Chromium only")
    yield running
    running.close()
