"""The workbench in a browser: a server over a folder as ``calc serve`` starts it, pages that are let in, axe-core.

A test takes the fixture ``workbench`` (one server over an empty folder for a whole file of tests) and opens pages:
``page = workbench.page(browser)``, ``page.goto(workbench.address + "runs")``, ``assert axe(page) == []``.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from warm import LONGEST, WARM_WORKERS, Running

if TYPE_CHECKING:
    from playwright.sync_api import Browser

PATIENCE = 15.0
"""Seconds that a server may take to end."""
EASY_TO_READ = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]
"""The rules of axe-core that every page keeps: WCAG 2.2 to level AA, and what its authors recommend beyond."""


@dataclass(frozen=True)
class Workbench:
    """A server that runs: the folder that it serves, its address (ending in /) and the one that lets a browser in."""

    folder: Path
    address: str
    opening: str
    stop: Callable[[], None]

    def page(
        self, browser: Browser, at: str = "", *, width: int = 1280, height: int = 900, colours: str = "light"
    ) -> Any:
        """Return a page in a context of its own, on the first page of the folder or ``at`` another.

        ``requested`` are the addresses that it asked for, ``outside`` those of them that are not the server's (which
        are refused), ``said`` what it complained of: errors of scripts, of the console, and broken requests.
        """
        context = browser.new_context(viewport={"width": width, "height": height}, color_scheme=colours)  # type: ignore[arg-type]
        context.set_default_timeout(30_000)
        page: Any = context.new_page()
        page.requested, page.outside, page.said = [], [], []

        def requested(request: Any) -> None:
            page.requested.append(request.url)
            if not request.url.startswith((self.address, "data:", "blob:")):
                page.outside.append(request.url)

        page.on("request", requested)
        page.on("console", lambda said: page.said.append(f"{said.type}: {said.text}") if said.type == "error" else None)
        page.on("pageerror", lambda error: page.said.append(f"error: {error}"))
        context.route(lambda address: not address.startswith(self.address), lambda route: route.abort())
        if at:  # let in without the first page, whose figures would be drawn
            context.request.get(self.opening, max_redirects=0)
        page.goto(self.address + at if at else self.opening)
        return page


@contextmanager
def serving(folder: Path, *arguments: str) -> Iterator[Workbench]:
    """Serve a folder on a free port as ``calc serve`` does, until the block ends; then interrupt it."""
    command = [sys.executable, "-m", "truing", "serve", str(folder), "--no-browser", "--port", "0", *arguments]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        output, errors = process.stdout, process.stderr
        assert output is not None
        assert errors is not None
        line = output.readline()
        assert "http://" in line, line + errors.read()
        yield _said_by(line, folder, process.terminate)
    finally:
        process.send_signal(signal.SIGTERM if sys.platform == "win32" else signal.SIGINT)
        try:
            process.communicate(timeout=PATIENCE)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()


def _said_by(line: str, folder: Path, stop: Callable[[], None]) -> Workbench:
    opening = line[line.index("http://") :].strip()
    return Workbench(folder.resolve(), opening.partition("?")[0], opening, stop)


@contextmanager
def serving_warm(folder: Path) -> Iterator[Workbench]:
    """Serve a folder so, by a server and workers that need not import first: they are forked, see ``warm.py``."""
    if not hasattr(os, "fork"):
        with serving(folder) as served:
            yield served
        return
    words = ["-m", "truing", "serve", str(folder), "--no-browser", "--port", "0"]
    running = Running(words, folder, {WARM_WORKERS: "", "PYTHONUNBUFFERED": "1"})
    try:
        end = time.monotonic() + LONGEST
        while not running.said[0].endswith("\n"):
            assert running.poll() is None, running.said
            assert time.monotonic() < end, running.said
            time.sleep(0.02)
        yield _said_by(running.said[0], folder, lambda: running.signal(signal.SIGTERM))
    finally:
        with suppress(ProcessLookupError):
            running.signal(signal.SIGINT)
        running.ended()


@pytest.fixture(scope="module")
def workbench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Workbench]:
    """A workbench over a folder that is empty, for all tests of a file: what one writes there, the next one sees."""
    with serving_warm(tmp_path_factory.mktemp("press")) as served:
        yield served


def axe(page: Any, *rules_left_out: str) -> list[str]:
    """Return what axe-core finds wrong with a page as it is shown now: rule, element and what to do, line by line."""
    from axe_playwright_python.sync_playwright import Axe

    rules = {rule: {"enabled": False} for rule in rules_left_out}
    found = Axe().run(page, options={"resultTypes": ["violations"], "runOnly": EASY_TO_READ, "rules": rules})
    return [
        f"{violation['id']}: {node['html'][:120]} – {' '.join(node['failureSummary'].split())[:300]}"
        for violation in found.response["violations"]
        for node in violation["nodes"]
    ]


WIDER = """() => {
    const width = document.documentElement.clientWidth;
    if (document.documentElement.scrollWidth <= width) return [];
    const right = node => node.getBoundingClientRect().right;
    const wide = [...document.body.querySelectorAll('*')].filter(node => right(node) > width + 1);
    const name = node => `${node.tagName} ${node.className} ${(node.id || node.textContent).slice(0, 40)}`;
    return [`the page is ${document.documentElement.scrollWidth} px wide`, ...wide.slice(0, 5).map(name)];
}"""


def sideways(page: Any) -> list[str]:
    """Return nothing where a page is no wider than its window, else how wide it is and what reaches beyond."""
    beyond: list[str] = page.evaluate(WIDER)
    return beyond
