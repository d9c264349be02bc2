"""The workbench in a browser: a server over a folder as ``calc serve`` starts it, pages that are let in, axe-core.

A test takes the fixture ``workbench`` (one server over an empty folder for a whole file of tests) and opens pages:
``page = workbench.page(browser)``, ``page.goto(workbench.address + "runs")``, ``assert axe(page) == []``.
"""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

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
    process: subprocess.Popen[str]

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
        page.goto(self.opening.replace("/?", f"/{at}?"))
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
        opening = line[line.index("http://") :].strip()
        yield Workbench(folder.resolve(), opening.partition("?")[0], opening, process)
    finally:
        process.send_signal(signal.SIGTERM if sys.platform == "win32" else signal.SIGINT)
        try:
            process.communicate(timeout=PATIENCE)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()


@pytest.fixture(scope="module")
def workbench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Workbench]:
    """A workbench over a folder that is empty, for all tests of a file: what one writes there, the next one sees."""
    with serving(tmp_path_factory.mktemp("press")) as served:
        yield served


def axe(page: Any, *rules_left_out: str) -> list[str]:
    """Return what axe-core finds wrong with a page as it is shown now: rule, element and what to do, line by line."""
    from axe_playwright_python.sync_playwright import Axe

    rules = {rule: {"enabled": False} for rule in rules_left_out}
    found = Axe().run(page, options={"runOnly": {"type": "tag", "values": EASY_TO_READ}, "rules": rules})
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
