"""Every worked example: its plugin keeps the promises of the kit, and its data may be shipped."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from shown_in_docs import EXAMPLES

from truing import Kernel
from truing.testing import failures

PLUGINS = [file for file in sorted(EXAMPLES.rglob("*.py")) if "@hookimpl" in file.read_text(encoding="utf-8")]
TABLES = ("lew", "hahn1", "alaska", "chwirut2", "pontius", "norris", "nelson", "misra1", "enso")
"""The tables of NIST that are shipped."""


def test_every_plugin_is_here() -> None:
    assert len(PLUGINS) == 18


@pytest.mark.parametrize("file", PLUGINS, ids=lambda file: file.stem)
def test_the_plugin_passes_the_kit(file: Path) -> None:
    kernel = Kernel()
    kernel.add_file(file)
    assert failures(kernel.offer(file.stem).model) == {}


@pytest.mark.parametrize("table", TABLES)
def test_the_data_are_said_to_be_free(table: str) -> None:
    (file,) = EXAMPLES.glob(f"*/{table}.csv")
    first = file.read_text(encoding="utf-8").splitlines()[0]
    assert first.startswith("# NIST")
    assert "Public domain" in first
    assert re.search(r"\*\*public\s+domain\*\*", (file.parent / "README.md").read_text(encoding="utf-8"))
