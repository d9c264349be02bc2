"""Small recordings made by the libraries that own their formats: the same columns as TDMS, MDF, MATLAB and parquet."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow
import pyarrow.parquet
from asammdf import MDF, Signal
from nptdms import ChannelObject, TdmsWriter
from scipy.io import savemat

from truing.measurements import table_text


@dataclass(frozen=True)
class Recorded:
    """A channel as it is recorded: numbers or words, its unit, and the seconds of each value where it has a clock."""

    values: Any
    unit: str = ""
    times: Any = None
    start: str = ""

    @property
    def step(self) -> float:
        """The seconds between two values."""
        return float(self.times[1] - self.times[0])


Channels = Mapping[str, Recorded]


def write_csv(path: Path, channels: Channels) -> Path:
    """Write the columns of one clock with their times in front."""
    times = next((channel.times for channel in channels.values() if channel.times is not None), None)
    columns = {} if times is None else {"time [s]": times}
    columns |= {f"{name} [{each.unit}]" if each.unit else name: each.values for name, each in channels.items()}
    path.write_text(table_text(list(columns), list(columns.values())), encoding="utf-8")
    return path


def write_tdms(path: Path, channels: Channels, group: str = "Untitled") -> Path:
    """Write channels of one group, or of the group before the slash in their names; clocks are waveforms."""
    objects = []
    for name, each in channels.items():
        properties: dict[str, Any] = {"unit_string": each.unit} if each.unit else {}
        if each.times is not None:
            properties |= {"wf_increment": each.step, "wf_start_offset": float(each.times[0])}
        if each.start:
            properties["wf_start_time"] = np.datetime64(each.start, "us")
        folder, _, own = name.rpartition("/")
        objects.append(ChannelObject(folder or group, own, each.values, properties=properties))
    with TdmsWriter(path) as writer:
        writer.write_segment(objects)
    return path


def write_mdf(path: Path, channels: Channels, version: str = "4.10") -> Path:
    """Write a channel group for each clock, rows where there is none."""
    with MDF(version=version) as file:
        groups: dict[bytes, list[Signal]] = {}
        for name, each in channels.items():
            times = np.arange(len(each.values), dtype=float) if each.times is None else np.asarray(each.times)
            is_text = np.asarray(each.values).dtype.kind in "OU"
            samples = np.array([str(value).encode() for value in each.values]) if is_text else np.asarray(each.values)
            encoding = "utf-8" if is_text else None
            signal = Signal(samples, times, name=name, unit=each.unit, encoding=encoding)
            groups.setdefault(times.tobytes(), []).append(signal)
        for signals in groups.values():
            file.append(signals)
        file.save(path, overwrite=True)
    return path


def write_mat(path: Path, channels: Channels) -> Path:
    """Write vectors, and the times of the first clock as ``time``; MATLAB has no units."""
    times = next((each.times for each in channels.values() if each.times is not None), None)
    columns: dict[str, Any] = {} if times is None else {"time": np.asarray(times)}
    for name, each in channels.items():
        is_text = np.asarray(each.values).dtype.kind in "OU"
        columns[name] = np.array(list(each.values), dtype=object) if is_text else np.asarray(each.values)
    savemat(path, columns, do_compression=True)
    return path


def write_parquet(path: Path, channels: Channels) -> Path:
    """Write columns with their unit in the metadata."""
    times = next((each.times for each in channels.values() if each.times is not None), None)
    every = {**({} if times is None else {"time": Recorded(times, "s")}), **channels}
    arrays = {name: pyarrow.array(each.values) for name, each in every.items()}
    fields = [
        pyarrow.field(name, arrays[name].type, metadata={"unit": each.unit} if each.unit else None)
        for name, each in every.items()
    ]
    table = pyarrow.Table.from_arrays(list(arrays.values()), schema=pyarrow.schema(fields))
    pyarrow.parquet.write_table(table, path)
    return path


WRITERS: Mapping[str, Callable[[Path, Channels], Path]] = {
    "tdms": write_tdms, "mf4": write_mdf, "mat": write_mat, "parquet": write_parquet,
}  # fmt: skip
KINDS: Sequence[str] = tuple(WRITERS)
