"""The calculations of a worker: each loaded once, a file anew when it has changed."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

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


def changed_since(plugin: str, run: Path, document: Mapping[str, Any]) -> str:
    """Say that a calculation is another than in a run, whose results.json is ``document``; nothing where it is not.

    An installed one is known by its version, one in a file also by the time at which that was written.
    """
    then, now = (document.get("plugin") or {}).get("version"), loaded(plugin).origin.version
    if then != now:
        return f"the calculation was {then} then and is {now}"
    results = run / "results.json"
    is_newer = plugin.endswith(".py") and results.is_file() and stamp_of(Path(plugin))[0] > results.stat().st_mtime_ns
    return f"{Path(plugin).name} has changed since" if is_newer else ""


def stamp_of(path: Path) -> tuple[int, int]:
    """Return time and size of a file, by which it is known again; two zeros for one that is not there."""
    try:
        status = path.stat()
    except OSError:
        return 0, 0
    return status.st_mtime_ns, status.st_size
