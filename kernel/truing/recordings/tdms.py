"""TDMS files of LabVIEW, read by npTDMS: channels in groups, their unit and their clock in the properties."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.heavy import nptdms
from truing.recordings.channels import Channel, Recording, UnreadableError, as_column, demand_modest, unit_or_none
from truing.units.grammar import shown


def read_channels(path: Path) -> Recording:
    """Read every channel. An index file beside it is not looked at; what the file says of its size must fit it."""
    channels: list[Channel] = []
    notes: list[str] = []
    with path.open("rb") as stream, nptdms.TdmsFile.open(stream) as file:
        every = [channel for group in file.groups() for channel in group.channels()]
        values, size = sum(len(channel) for channel in every), path.stat().st_size
        if values > size:  # a value takes a byte at the very least
            raise UnreadableError(f"says that it holds {values} values in {size} bytes; it is damaged: copy it again")
        demand_modest(values, len(every))
        if file.file_status.incomplete_final_segment:
            notes.append("the file is cut off in its last segment; what was written before is read")
        for channel in every:
            column = as_column(channel[:]) if len(channel) else None
            if column is None:
                what = f"holds {channel.dtype} and no numbers" if len(channel) else "holds no value"
                notes.append(f"channel {shown(f'{channel.group_name}/{channel.name}')} {what} and is left out")
                continue
            unit = unit_or_none(channel.properties.get("unit_string"))
            times = _times(channel.properties, len(column))
            start = channel.properties.get("wf_start_time") if times is not None else None
            channels.append(Channel(channel.name, channel.group_name, unit, column, times, _stamp(start)))
    return Recording(tuple(channels), tuple(notes))


def _times(properties: Any, length: int) -> NDArray[np.float64] | None:
    """Return the seconds of a waveform, (n,), or None where the properties give none."""
    step, offset = properties.get("wf_increment"), properties.get("wf_start_offset", 0.0)
    if not isinstance(step, (int, float)) or not isinstance(offset, (int, float)):
        return None
    if not (np.isfinite(step) and step > 0 and np.isfinite(offset)):
        return None
    return np.asarray(offset + step * np.arange(length), dtype=float)


def _stamp(start: Any) -> np.datetime64 | None:
    return start if isinstance(start, np.datetime64) and not np.isnat(start) else None
