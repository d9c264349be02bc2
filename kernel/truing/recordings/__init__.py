"""Recordings as data acquisition writes them: TDMS, MDF, MATLAB and parquet files, read as channels.

Nothing in them is executed: no pickled object, no formula of a file.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from truing.recordings import matlab, mdf, parquet, tdms
from truing.recordings.channels import Channel, Recording, told

__all__ = ["Channel", "Recording", "is_recording", "not_of_its_kind", "read_recording"]


@dataclass(frozen=True)
class Kind:
    """One kind of recording: how sentences call it, how its bytes may begin, and what reads it."""

    title: str
    begins: tuple[bytes, ...]
    read: Callable[[Path], Recording]


_MDF = Kind("an MDF file", (b"MDF ",), mdf.read_channels)
KINDS = {
    ".tdms": Kind("a TDMS file", (b"TDSm",), tdms.read_channels),
    ".mf4": _MDF,
    ".mdf": _MDF,
    ".mat": Kind("a MATLAB file of version 5 or later", (b"MATLAB ",), matlab.read_channels),
    ".parquet": Kind("a parquet file", (b"PAR1",), parquet.read_channels),
}
"""The kinds of recordings by the end of their names."""


def is_recording(path: Path) -> bool:
    """Whether the name of a file says that it is a recording that we read."""
    return path.suffix.lower() in KINDS


def not_of_its_kind(path: Path, start: bytes) -> str:
    """Say that a file does not begin as one of its name does, or nothing."""
    kind = KINDS[path.suffix.lower()]
    if not start:
        return "is empty; record or copy it again"
    if start.startswith(b"UnFinMF"):
        return "is an MDF file that the recorder did not finish; let its tool finish it"
    return (
        "" if start.startswith(kind.begins) else f"is not {kind.title}, though it is called so; record or copy it again"
    )


def read_recording(path: Path) -> Recording:
    """Read every channel of a recording. Raises InputError with one sentence for what is broken or too large."""
    kind = KINDS[path.suffix.lower()]
    with told(path, kind.title):
        return kind.read(path)
