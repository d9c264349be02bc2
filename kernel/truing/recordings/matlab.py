"""MATLAB files: of versions 5 to 7 read by scipy, of version 7.3, which are HDF5, by h5py where it is installed.

Vectors are channels, matrices a channel for each column, and a struct of these is a group. Nothing else is a channel.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from truing.heavy import h5py, matlab_files
from truing.recordings.channels import INSTALL, MOST_VALUES, Channel, Recording, UnreadableError, demand_modest
from truing.units.grammar import shown

MOST_COLUMNS = 100
"""A matrix with more columns is none of channels."""
_HEADER, _COMPRESSED = 128, 15
_HDF5 = b"MATLAB 7.3"


def read_channels(path: Path) -> Recording:
    """Read every vector, matrix and struct of these; anything else is left out and named."""
    with path.open("rb") as stream:
        start = stream.read(_HEADER)
        if start.startswith(_HDF5):
            return _read_hdf5(path)
        if len(start) < _HEADER:
            raise UnreadableError(f"ends after {len(start)} bytes, within its header; copy it again")
        demand_modest(sum(_declared(stream, start)) // 8)
    variables = matlab_files.loadmat(path, chars_as_strings=True, struct_as_record=True)
    return _recording({name: value for name, value in variables.items() if not name.startswith("__")})


def _declared(stream: BinaryIO, start: bytes) -> Iterator[int]:
    """Give how many bytes each variable says that it takes when it is unpacked. Raises UnreadableError at a cut.

    The file behind its header is a row of elements, each with its kind and its length before it; of a compressed one
    only the beginning is unpacked, which holds the same of what is inside.
    """
    order = "<" if start[126:128] == b"IM" else ">"
    end = stream.seek(0, 2)
    place = stream.seek(_HEADER)
    while place < end:
        tag = stream.read(8)
        if len(tag) < 8:
            raise UnreadableError("is cut off; copy it again")
        kind, length = struct.unpack(f"{order}II", tag)
        if place + 8 + length > end:
            raise UnreadableError(
                f"says that a variable takes {length} bytes, {end - place - 8} are left; copy it again"
            )
        inside = length
        if kind == _COMPRESSED:
            unpacked = zlib.decompressobj().decompress(stream.read(min(length, 4096)), 8)
            inside = struct.unpack(f"{order}II", unpacked)[1] if len(unpacked) == 8 else 0
        if inside > 8 * MOST_VALUES:
            demand_modest(inside // 8)
        yield inside
        place = stream.seek(place + 8 + length)


def _recording(variables: dict[str, Any]) -> Recording:
    channels: list[Channel] = []
    notes: list[str] = []
    for name, value in variables.items():
        record = _struct(value)
        for inner, field in [("", value)] if record is None else record.items():
            group, called = (name, inner) if record is not None else ("", name)
            columns, why = _columns(called, field)
            channels += [Channel(each, group, None, column) for each, column in columns.items()]
            if why:
                notes.append(f"{shown(f'{group}.{called}' if group else called)} {why} and is left out")
    return Recording(tuple(channels), tuple(notes))


def _struct(value: Any) -> dict[str, Any] | None:
    """Return the fields of a struct that is one, None for anything else."""
    if not isinstance(value, np.ndarray) or value.dtype.names is None or value.size != 1:
        return None
    record = value.reshape(-1)[0]
    opaque = type(value).__name__ in {"MatlabOpaque", "MatlabFunction"}
    return None if opaque else {name: record[name] for name in value.dtype.names}


def _columns(name: str, value: Any) -> tuple[dict[str, NDArray[Any]], str]:
    """Return the columns of a variable by name, and why it has none."""
    if type(value).__name__ in {"MatlabOpaque", "MatlabFunction"}:
        return {}, "is a table, a class or a function; save its columns as vectors"
    array = np.asarray(value) if not hasattr(value, "tocsc") else np.empty((0, 0), dtype=complex)
    if array.dtype.names is not None:
        return {}, "is a struct in a struct, or an array of them; save its fields as vectors"
    if array.dtype.kind == "O":
        texts = [_cell_text(cell) for cell in array.reshape(-1).tolist()]
        if not texts or None in texts or min(array.shape) > 1:
            return {}, "is an array of cells that are no texts; save it as a vector"
        return {name: np.array(texts, dtype=object)}, ""
    if array.dtype.kind == "U" and array.ndim == 1:
        words: Any = np.array([str(text).strip() for text in array.tolist()], dtype=object)
        return ({name: words}, "") if len(array) > 1 else ({}, "is one text")
    if array.ndim != 2 or array.dtype.kind not in "fiub":
        return {}, "is no real vector or matrix"
    if array.size == 0 or array.shape == (1, 1):
        return {}, "is one number and no column" if array.size else "holds no value"
    if min(array.shape) == 1:
        return {name: array.reshape(-1)}, ""
    if array.shape[1] > MOST_COLUMNS:
        return {}, f"has {array.shape[1]} columns, at most {MOST_COLUMNS} are channels; transpose it"
    return {f"{name}(:,{place})": column for place, column in enumerate(array.T, start=1)}, ""


def _cell_text(cell: Any) -> str | None:
    """Return the text in a cell of an array of them, None for anything else."""
    is_text = isinstance(cell, np.ndarray) and cell.dtype.kind == "U" and cell.size <= 1
    return "".join(cell.reshape(-1).tolist()).strip() if is_text else None


# Version 7.3


def _read_hdf5(path: Path) -> Recording:
    """Read the numbers of a file of version 7.3. Raises UnreadableError where h5py is not installed."""
    try:
        opened = h5py.File(path, "r")
    except ImportError:
        otherwise = f"which needs h5py: {INSTALL}; or save it with save(..., '-v7')"
        raise UnreadableError(f"is a MATLAB file of version 7.3, {otherwise}") from None
    with opened as file:
        nodes = _inside(file)
        variables = {name: _fields(node) if hasattr(node, "items") else _numbers(node) for name, node in nodes.items()}
    groups = {name: value for name, value in variables.items() if isinstance(value, dict)}
    alone = _recording({name: value for name, value in variables.items() if name not in groups})
    channels, notes = list(alone.channels), list(alone.notes)
    for group, fields in groups.items():
        inner = _recording(fields)
        channels += [Channel(each.name, group, None, each.values) for each in inner.channels]
        notes += [f"in {shown(group)}, {note}" for note in inner.notes]
    return Recording(tuple(channels), tuple(notes))


def _inside(group: Any) -> dict[str, Any]:
    """Return what a group holds itself: no links, which may lead out of the file, and nothing of MATLAB's own."""
    hard = [name for name in group if isinstance(group.get(name, getlink=True), h5py.HardLink)]
    return {name: group[name] for name in hard if not name.startswith("#")}


def _fields(group: Any) -> dict[str, Any]:
    """Return the data sets of a group as arrays; groups in it are no columns."""
    nothing = np.empty(0, dtype=complex)
    return {name: nothing if hasattr(node, "items") else _numbers(node) for name, node in _inside(group).items()}


def _numbers(node: Any) -> NDArray[Any]:
    """Return a data set as MATLAB shows it; an array that is no column where it holds none."""
    if node.is_virtual or node.external:  # what lies in another file
        return np.empty(0, dtype=complex)
    if node.dtype.kind not in "fiub" or b"char" in bytes(node.attrs.get("MATLAB_class", b"")) or node.ndim != 2:
        return np.empty(0, dtype=complex)
    demand_modest(node.size)
    return np.asarray(node[()]).T
