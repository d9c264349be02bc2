"""Where the numbers of a run come from: versions, hash of the inputs, seed, guests, data files."""

from __future__ import annotations

import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib import metadata

from truing.runs.inputs_written import input_hash
from truing.setup import DEFAULT_SEED, Setup

PACKAGES = ("numpy", "scipy", "pint", "pluggy", "pydantic", "matplotlib", "jinja2")


@dataclass(frozen=True, kw_only=True)
class Provenance:
    """Where the numbers come from: enough to get them again."""

    kernel: str
    plugin: str
    plugin_version: str
    python: str
    packages: Mapping[str, str] = field(default_factory=dict)
    input_hash: str = ""
    seed: int = DEFAULT_SEED
    date: str = ""
    added: Sequence[tuple[str, str, str]] = ()
    """What guests added: what, plugin, version."""
    files: Mapping[str, str] = field(default_factory=dict)
    """Data files that were read, with the hash of their content."""
    exceptions: Mapping[str, str] = field(default_factory=dict)
    """Promises that the calculation is known not to keep, with the reason."""


def provenance_of(setup: Setup, *, date: str = "") -> Provenance:
    """Say where the numbers of a run come from: versions, hash of the inputs, seed, guests, data files."""
    return Provenance(
        kernel=_version("truing"),
        plugin=setup.origin.name,
        plugin_version=setup.origin.version,
        python=platform.python_version(),
        packages={name: version for name in PACKAGES if (version := _version(name))},
        input_hash=input_hash(setup),
        seed=setup.seed,
        date=date,
        added=tuple((addition.what, addition.plugin, addition.version) for addition in setup.source.added),
        files=dict(setup.source.files),
        exceptions={str(name): reason for name, reason in setup.model.exceptions.items()},
    )


@cache
def _version(name: str) -> str:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return ""
