"""What a process computes with: versions, and the code of Truing and of the plugin as they were loaded."""

from __future__ import annotations

import platform
from collections.abc import Mapping
from functools import lru_cache
from importlib import metadata
from pathlib import Path

from truing.kernel.source import code_hash

PACKAGES = ("truing", "numpy", "scipy")


@lru_cache(maxsize=8)
def versions_here(code: tuple[str, ...] = ()) -> dict[str, str]:
    """Return the versions of Python and of what computes, and for each place in ``code`` a hash of its source.

    A place is the name of a package or module, or the path of a Python file. The answer is that of the first call: what
    a process has loaded does not change when a file does.
    """
    found = {"python": platform.python_version()}
    for name in PACKAGES:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            found[name] = ""
    return {**found, **{f"the code of {Path(place).name}": code_hash(place) for place in code}}


def differences(here: Mapping[str, str], workers: Mapping[str, Mapping[str, str]]) -> list[str]:
    """Say of every version that some worker has otherwise than this process, which it is."""
    words = []
    for name, own in here.items():
        others = {address: said.get(name, "") for address, said in workers.items() if said.get(name, "") != own}
        if not others:
            continue
        address, other = min(others.items())
        more = f" and {len(others) - 1} more" if len(others) > 1 else ""
        if name.startswith("the code of"):
            words.append(f"{name} is not the same on worker {address}{more} as here: {_MAY_DIFFER}")
        else:
            words.append(f"worker {address}{more} has {name} {other or 'missing'}, here it is {own}: {_MAY_DIFFER}")
    return words


_MAY_DIFFER = "the results may differ from those of this machine"
