"""The site of the manual, built once for all tests: strictly, as continuous integration builds it."""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

import pytest

from shared import ROOT, Answer, process


def build(target: Path) -> Answer:
    """Build the site into a folder; a warning is an error."""
    return process([sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(target)], ROOT)


@pytest.fixture(scope="session")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the built site; of several processes that test, the first builds and the others wait."""
    if "TRUING_SITE" in os.environ:  # one that was built already, to look at tests alone
        return Path(os.environ["TRUING_SITE"])
    alone = "PYTEST_XDIST_WORKER" not in os.environ
    place = tmp_path_factory.mktemp("manual") if alone else tmp_path_factory.getbasetemp().parent
    target, done, said = place / "site", place / "site.done", place / "site.said"
    try:
        os.close(os.open(place / "site.begun", os.O_CREAT | os.O_EXCL))
    except FileExistsError:
        end = time.monotonic() + 300
        while not done.exists() and time.monotonic() < end:
            time.sleep(0.2)
    else:
        answer = build(target)
        said.write_text(f"{answer.code}\n{answer.out}{answer.err}", encoding="utf-8")
        done.touch()
    code, _, words = said.read_text(encoding="utf-8").partition("\n")
    assert code == "0", words
    return target
