"""Every worked example: its plugin keeps the promises of the kit, and its data may be shipped."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import nullcontext

import pytest
from shown_in_docs import EXAMPLES

from truing import Kernel
from truing.executors import open_executor
from truing.testing import failures, running

PLUGINS = [file for file in sorted(EXAMPLES.rglob("*.py")) if "@hookimpl" in file.read_text(encoding="utf-8")]
TABLES = ("lew", "hahn1", "alaska", "chwirut2", "pontius", "norris", "nelson", "misra1", "enso")
"""The tables of NIST that are shipped."""


def test_every_plugin_is_here() -> None:
    assert len(PLUGINS) == 22


@pytest.fixture(scope="module")
def kernel() -> Iterator[Kernel]:
    """A kernel with all of them; one process computes what the kit wants computed in another, and finds them too."""
    made = Kernel()
    for file in PLUGINS:
        made.add_file(file)
    with pytest.MonkeyPatch.context() as patch, open_executor("processes:1") as elsewhere:
        patch.setattr(running, "open_executor", lambda _: nullcontext(elsewhere))
        yield made


@pytest.mark.parametrize("name", [file.stem for file in PLUGINS])
def test_the_plugin_passes_the_kit(kernel: Kernel, name: str) -> None:
    assert failures(kernel.offer(name).model) == {}


@pytest.mark.parametrize("table", TABLES)
def test_the_data_are_said_to_be_free(table: str) -> None:
    (file,) = EXAMPLES.glob(f"*/{table}.csv")
    first = file.read_text(encoding="utf-8").splitlines()[0]
    assert first.startswith("# NIST")
    assert "Public domain" in first
    assert re.search(r"\*\*public\s+domain\*\*", (file.parent / "README.md").read_text(encoding="utf-8"))


@pytest.mark.parametrize(
    ("example", "holder", "author"),
    [
        ("falling_balls", "2020 Brian de Silva", "B. M. de Silva, D. M. Higdon, S. L. Brunton"),
        ("cascaded_tanks", "2025 Milad Banitalebi Dehkordi", "M. Schoukens, P. Mattsson, T. Wigren, J.-P. Noël"),
    ],
)
def test_the_licence_goes_with_the_records(example: str, holder: str, author: str) -> None:
    licence, page = ((EXAMPLES / example / name).read_text(encoding="utf-8") for name in ("LICENSE", "README.md"))
    assert licence.lower().startswith(f"MIT License\n\nCopyright (c) {holder}\n".lower())
    assert "The above copyright notice and this permission notice shall be included" in licence
    assert f"Copyright (c) {holder}" in " ".join(page.split())
    assert author in page
    drops = list((EXAMPLES / example / "drops").glob("*.csv"))
    assert len(drops) == {"falling_balls": 20}.get(example, 0)
    assert all(f"Copyright (c) {holder}" in drop.read_text(encoding="utf-8").splitlines()[0] for drop in drops)
