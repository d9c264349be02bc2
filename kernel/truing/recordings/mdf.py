"""MDF files of versions 3 and 4 (ASAM): channel groups, each with a master that is its clock.

They are read by asammdf in a process of its own, which a damaged file may end.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from truing.recordings.channels import Channel, Recording, UnreadableError

READER = "truing.recordings.mdf_process"
"""The module that reads, as a program."""
PATIENCE = 600
"""So many seconds a file may take; one of the largest size takes a tenth of them."""


def read_channels(path: Path) -> Recording:
    """Read every channel but the masters. Raises ImportError where asammdf is not installed."""
    if find_spec("asammdf") is None:
        raise ImportError("asammdf")
    where = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    command = [sys.executable, "-P", "-m", READER, str(path)]
    again = "it is damaged: copy or export it again"
    try:
        done = subprocess.run(command, capture_output=True, env=where, timeout=PATIENCE, check=False)
    except subprocess.TimeoutExpired:
        raise UnreadableError(f"takes longer than {PATIENCE} s to read; {again}") from None
    if done.returncode or not done.stdout:
        raise UnreadableError(f"ends the library that reads MDF files; {again}")
    with np.load(BytesIO(done.stdout), allow_pickle=False) as arrays:
        head = json.loads(arrays["head"].tobytes())
        if "fault" in head:
            raise UnreadableError(f"{head['fault']}; {again}")
        channels = tuple(_channel(place, about, arrays) for place, about in enumerate(head["channels"]))
    return Recording(channels, tuple(head["notes"]))


def _channel(place: int, about: dict[str, Any], arrays: Any) -> Channel:
    """Return a channel as it was packed."""
    texts = about.get("texts")
    values = arrays[f"values{place}"] if texts is None else np.array(texts, dtype=object)
    times = arrays[about["times"]] if "times" in about else None
    return Channel(about["name"], about["group"], about["unit"], values, times)
