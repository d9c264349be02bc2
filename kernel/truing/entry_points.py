"""The door: which plugins are installed, from metadata alone; nothing of them is loaded."""

from __future__ import annotations

from importlib import metadata

GROUP = "truing.plugins"


def entry_points() -> list[metadata.EntryPoint]:
    """Return the entry points of all plugins from metadata alone; nothing is loaded."""
    unique = {(entry.name, entry.value, distribution_of(entry)): entry for entry in metadata.entry_points(group=GROUP)}
    return sorted(unique.values(), key=lambda entry: entry.name)


def distribution_of(entry: metadata.EntryPoint) -> str:
    """Return the name of the distribution that an entry point belongs to, or nothing."""
    return entry.dist.name if entry.dist is not None else ""


def plugin_names() -> list[str]:
    """Return the names of all plugins, each once; which distribution offers them is not looked up."""
    return sorted({entry.name for entry in metadata.entry_points(group=GROUP)})
