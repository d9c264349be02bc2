"""The door: which plugins are installed, from metadata alone; nothing of them is loaded."""

from __future__ import annotations

import os
import sys
from functools import lru_cache
from importlib import metadata

GROUP = "truing.plugins"


def entry_points() -> list[metadata.EntryPoint]:
    """Return the entry points of all plugins from metadata alone; nothing is loaded.

    The metadata are read again where a folder of ``sys.path`` has changed since the last call.
    """
    return list(_entry_points_in(tuple((folder, _changed_at(folder)) for folder in map(os.path.abspath, sys.path))))


@lru_cache(maxsize=1)
def _entry_points_in(folders: tuple[tuple[str, int], ...]) -> list[metadata.EntryPoint]:
    unique = {(entry.name, entry.value, distribution_of(entry)): entry for entry in metadata.entry_points(group=GROUP)}
    return sorted(unique.values(), key=lambda entry: entry.name)


def _changed_at(folder: str) -> int:
    """Return when something was put into a folder or taken from it, in nanoseconds since 1970; 0 where it is not."""
    try:
        return os.stat(folder).st_mtime_ns
    except OSError:
        return 0


def distribution_of(entry: metadata.EntryPoint) -> str:
    """Return the name of the distribution that an entry point belongs to, or nothing."""
    return entry.dist.name if entry.dist is not None else ""


def plugin_names() -> list[str]:
    """Return the names of all plugins, each once; which distribution offers them is not looked up."""
    return sorted({entry.name for entry in metadata.entry_points(group=GROUP)})
