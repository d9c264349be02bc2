"""MDF files of versions 3 and 4 (ASAM), read by asammdf: channel groups, each with a master that is its clock."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.heavy import asammdf
from truing.recordings.channels import Channel, Recording, as_column, demand_modest, unit_or_none
from truing.units.grammar import shown

FORMULAS = frozenset({3, 10})
"""The kinds of conversion that are a formula in the file: algebraic in version 4, formula in version 3."""


def read_channels(path: Path) -> Recording:
    """Read every channel but the masters; samples that are marked invalid are missing.

    A channel that a formula in the file converts is left out: what a file says is not executed.
    """
    channels: list[Channel] = []
    notes: list[str] = []
    with path.open("rb") as stream, asammdf.MDF(stream) as file:
        demand_modest(_declared(file), sum(len(group.channels) for group in file.groups))
        for place, group in enumerate(file.groups):
            name = _name(group, place, file)
            for index, declared in enumerate(group.channels):
                if file.masters_db.get(place) == index:
                    continue
                called = shown(f"{name}/{declared.name}")
                if _is_formula(declared):
                    notes.append(f"channel {called} is converted by a formula in the file and is left out")
                    continue
                signal = file.get(group=place, index=index)
                column = as_column(signal.samples)
                if column is None or not len(column):
                    what = "holds no value" if column is not None else "holds more than one number in a sample"
                    notes.append(f"channel {called} {what} and is left out")
                    continue
                column = _without_invalid(column, signal.invalidation_bits)
                times = np.asarray(signal.timestamps, dtype=float) if place in file.masters_db else None
                channels.append(Channel(declared.name, name, unit_or_none(signal.unit), column, times))
    return Recording(tuple(channels), tuple(notes))


def _declared(file: Any) -> int:
    """Return how many values the file says that it holds."""
    return sum(int(group.channel_group.cycles_nr) * len(group.channels) for group in file.groups)


def _name(group: Any, place: int, file: Any) -> str:
    """Return what a channel group is called: by its source of acquisition, else by its number."""
    named = [str(getattr(each.channel_group, "acq_name", "") or "") for each in file.groups]
    return named[place] if named[place] and named.count(named[place]) == 1 else str(place)


def _is_formula(declared: Any) -> bool:
    conversion = declared.conversion
    inner = [] if conversion is None else [conversion, *(getattr(conversion, "referenced_blocks", None) or {}).values()]
    return any(getattr(each, "conversion_type", None) in FORMULAS for each in inner)


def _without_invalid(column: NDArray[Any], invalid: Any) -> NDArray[Any]:
    """Return a column with what is marked invalid as missing."""
    if invalid is None or not np.any(invalid):
        return column
    mask = np.asarray(invalid, dtype=bool)
    known: NDArray[Any] = column.copy() if column.dtype == object else column.astype(float)
    known[mask] = None if column.dtype == object else np.nan
    return known
