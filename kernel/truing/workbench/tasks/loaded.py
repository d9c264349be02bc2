"""The calculations of a worker: each loaded once, a file anew when it has changed."""

from __future__ import annotations

import sys
from functools import lru_cache
from pathlib import Path

from truing.kernel import Offer, offer_of


def loaded(plugin: str) -> Offer:
    """Return an installed calculation, or that of a file as it is now. Raises UnknownPluginError, PluginError."""
    return _loaded(plugin, version_of(plugin))


def version_of(plugin: str) -> tuple[int, int]:
    """Return what tells a calculation in a file from the same after a change; of an installed one always the same."""
    return stamp_of(Path(plugin)) if plugin.endswith(".py") else (0, 0)


@lru_cache(maxsize=8)
def _loaded(plugin: str, version: tuple[int, int]) -> Offer:
    if any(version):
        for name, module in [*sys.modules.items()]:  # as it was before the file changed
            if getattr(module, "__file__", None) == plugin:
                del sys.modules[name]
    return offer_of(plugin, lambda text: None)


def changed_since(plugin: str, run: Path) -> bool:
    """Whether the file of a calculation was written after a run of it; no installed one is."""
    document = run / "results.json"
    if not plugin.endswith(".py") or not document.is_file():
        return False
    return stamp_of(Path(plugin))[0] > document.stat().st_mtime_ns


def stamp_of(path: Path) -> tuple[int, int]:
    """Return time and size of a file, by which it is known again; two zeros for one that is not there."""
    try:
        status = path.stat()
    except OSError:
        return 0, 0
    return status.st_mtime_ns, status.st_size
