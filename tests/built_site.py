"""The site of the manual, built once for all tests: strictly, as continuous integration builds it."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from shared import ROOT, Answer, made_once, process


def build(target: Path) -> Answer:
    """Build the site into a folder; a warning is an error."""
    return process([sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(target)], ROOT)


@pytest.fixture(scope="session")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the built site; of several processes that test, the first builds and the others wait."""
    if "TRUING_SITE" in os.environ:  # one that was built already, to look at tests alone
        return Path(os.environ["TRUING_SITE"])

    def built(folder: Path) -> None:
        answer = build(folder)
        assert answer.code == 0, answer.out + answer.err

    return made_once(tmp_path_factory, "site", built)
