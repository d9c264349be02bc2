"""A process of its own that reads one MDF file with asammdf and writes its channels to the standard output.

The library unpacks records in C and trusts what the file says of their places: a file that means harm, or is damaged,
may end the process. Only this one, which holds nothing else. ``python -m truing.recordings.mdf_process FILE``.
"""

from __future__ import annotations

import json
import os
import sys
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.heavy import asammdf
from truing.recordings.channels import Channel, Recording, UnreadableError, as_column, demand_modest, unit_or_none
from truing.units.grammar import shown

FORMULAS = frozenset({3, 10})
"""The kinds of conversion that are a formula in the file: algebraic in version 4, formula in version 3."""


def main(path: str) -> None:
    """Read a file and write what it holds; whatever a library prints goes to the standard error."""
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    try:
        content = packed(read_channels(Path(path)))
    except UnreadableError as error:
        content = packed_fault(str(error))
    except Exception as error:
        content = packed_fault(f"cannot be read as an MDF file ({shown(f'{type(error).__name__}: {error}')[1:-1]})")
    out.write(content)
    out.flush()
    os._exit(0)  # what is left of a broken file is not cleared up


def read_channels(path: Path) -> Recording:
    """Read every channel but the masters; samples that are marked invalid are missing.

    A channel that a formula in the file converts is left out: what a file says is not executed.
    """
    channels: list[Channel] = []
    notes: list[str] = []
    with path.open("rb") as stream, asammdf.MDF(stream) as file:
        declared = sum(int(group.channel_group.cycles_nr) * len(group.channels) for group in file.groups)
        demand_modest(declared, sum(len(group.channels) for group in file.groups))
        for place, group in enumerate(file.groups):
            name = _name(group, place, file)
            _demand_inside(group, name)
            for index, each in enumerate(group.channels):
                if file.masters_db.get(place) == index:
                    continue
                called = shown(f"{name}/{each.name}")
                if _is_formula(each.conversion):
                    notes.append(f"channel {called} is converted by a formula in the file and is left out")
                    continue
                signal = file.get(group=place, index=index, ignore_invalidation_bits=True)
                column = as_column(signal.samples)
                if column is None or not len(column):
                    what = "holds no value" if column is not None else "holds more than one number in a sample"
                    notes.append(f"channel {called} {what} and is left out")
                    continue
                times = np.asarray(signal.timestamps, dtype=float) if place in file.masters_db else None
                values = _without_invalid(column, signal.invalidation_bits)
                channels.append(Channel(each.name, name, unit_or_none(signal.unit), values, times))
    return Recording(tuple(channels), tuple(notes))


def _name(group: Any, place: int, file: Any) -> str:
    """Return what a channel group is called: by its source of acquisition, else by its number."""
    named = [str(getattr(each.channel_group, "acq_name", "") or "") for each in file.groups]
    return named[place] if named[place] and named.count(named[place]) == 1 else str(place)


def _demand_inside(group: Any, name: str) -> None:
    """Raise UnreadableError where a channel lies outside of its record, which the library does not look at."""
    size = group.channel_group.samples_byte_nr
    for channel in group.channels:
        if hasattr(channel, "byte_offset"):
            end = channel.byte_offset + (channel.bit_offset + channel.bit_count + 7) // 8
            if end > size:
                raise UnreadableError(
                    f"channel {shown(f'{name}/{channel.name}')} ends at byte {end} of a record of {size}"
                )


def _is_formula(conversion: Any) -> bool:
    """Whether a conversion, or one that it refers to, is a formula."""
    if conversion is None or isinstance(conversion, (str, bytes)):
        return False
    inner = (getattr(conversion, "referenced_blocks", None) or {}).values()
    return getattr(conversion, "conversion_type", None) in FORMULAS or any(map(_is_formula, inner))


def _without_invalid(column: NDArray[Any], invalid: Any) -> NDArray[Any]:
    """Return a column with what is marked invalid as missing."""
    if invalid is None or not np.any(invalid):
        return column
    mask = np.asarray(invalid, dtype=bool)
    known: NDArray[Any] = column.copy() if column.dtype == object else column.astype(float)
    known[mask] = None if column.dtype == object else np.nan
    return known


def packed(recording: Recording) -> bytes:
    """Pack channels as numpy's .npz with a head in JSON, which holds the texts, too; nothing is pickled."""
    head: dict[str, Any] = {"notes": recording.notes, "channels": []}
    arrays: dict[str, NDArray[Any]] = {}
    clocks: dict[bytes, str] = {}
    for place, channel in enumerate(recording.channels):
        about: dict[str, Any] = {"name": channel.name, "group": channel.group, "unit": channel.unit}
        if channel.times is not None:
            about["times"] = clocks.setdefault(channel.times.tobytes(), f"times{place}")
            arrays[about["times"]] = channel.times
        if channel.values.dtype == object:
            about["texts"] = channel.values.tolist()
        else:
            arrays[f"values{place}"] = channel.values
        head["channels"].append(about)
    return _packed(head, arrays)


def packed_fault(sentence: str) -> bytes:
    """Pack the one sentence that says why a file cannot be read."""
    return _packed({"fault": sentence}, {})


def _packed(head: dict[str, Any], arrays: dict[str, NDArray[Any]]) -> bytes:
    stream = BytesIO()
    text = np.frombuffer(json.dumps(head).encode(), dtype=np.uint8)
    np.savez(stream, allow_pickle=False, head=text, **arrays)
    return stream.getvalue()


if __name__ == "__main__":
    main(sys.argv[1])
