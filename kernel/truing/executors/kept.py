"""Finished batches kept in a file as data only, so that an interrupted run does not compute them again."""

from __future__ import annotations

import hashlib
import io
import json
import os
import pickle
import struct
import threading
import time
import zlib
from base64 import b64decode, b64encode
from collections.abc import Callable
from contextlib import suppress
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

J = TypeVar("J")
A = TypeVar("A")
MAGIC = b"TRB2"
HEAD = struct.Struct(">4s32sQI")
SYNC_SECONDS = 1.0


class BatchLog:
    """Answers by key in one file that only grows: each record has a length and a checksum, a torn end is cut off.

    A record is data only (see ``executors.data``): whatever lies in the file, reading it runs nothing.
    What was put is safe when this process is killed; when the power fails, but for the last second.
    """

    def __init__(self, path: Path) -> None:
        self._file = open(path, "r+b" if path.exists() else "x+b", buffering=0)  # noqa: SIM115
        self._lock = threading.Lock()
        self._places: dict[bytes, tuple[int, int]] = {}
        self._end = 0
        self._synced = time.monotonic()
        self.fault = ""
        """Why no more batches can be kept (a full disk), or nothing."""
        self.strange = ""
        """Why some batches are not kept (answers that are no plain data), or nothing."""
        self._read()
        self._earlier = frozenset(self._places)
        self._taken: set[bytes] = set()

    def __len__(self) -> int:
        return len(self._places)

    @property
    def resumed(self) -> int:
        """How many answers of an earlier run were taken up."""
        return len(self._taken)

    def kept(self, key: bytes) -> list[Any]:
        """Return what is kept under a key: one answer, or none; what turns out to be no answer is forgotten."""
        if key not in self._places:
            return []
        start, length = self._places[key]
        try:
            with self._lock:
                self._file.seek(start)
                content = self._file.read(length)
            answers = [answer_of(content.decode("ascii"))]
        except (OSError, ValueError):
            del self._places[key]
            return []
        if key in self._earlier:
            self._taken.add(key)
        return answers

    def put(self, key: bytes, answer: Any) -> None:
        """Keep an answer. Where that fails, say so in ``fault`` and keep no more: the run itself goes on."""
        try:
            content = text_of(answer).encode("ascii")
        except NoDataError as error:
            self.strange = str(error)
            return
        record = memoryview(HEAD.pack(MAGIC, key, len(content), zlib.crc32(content, zlib.crc32(key))) + content)
        with self._lock:
            if self.fault or self._file.closed or key in self._places:
                return
            try:
                self._append(record)
            except OSError as error:
                self.fault = error.strerror or str(error)
                return
            self._places[key] = (self._end + HEAD.size, len(content))
            self._end += len(record)

    def remarks(self) -> list[str]:
        """Say where answers could not be kept."""
        words = []
        if self.fault:
            words.append(f"finished batches are no longer kept for --resume: {self.fault}")
        if self.strange:
            words.append(f"some finished batches are not kept for --resume: {self.strange}")
        return words

    def close(self) -> None:
        """Write everything to the disk and close the file."""
        with self._lock:
            if not self._file.closed:
                with suppress(OSError):
                    os.fsync(self._file.fileno())
                self._file.close()

    def _append(self, record: memoryview) -> None:
        self._file.seek(self._end)
        while record:
            record = record[self._file.write(record) or 0 :]
        if time.monotonic() - self._synced > SYNC_SECONDS:
            os.fsync(self._file.fileno())
            self._synced = time.monotonic()

    def _read(self) -> None:
        """Find all whole records, and cut off what comes behind the last of them."""
        size = self._file.seek(0, io.SEEK_END)
        while self._end + HEAD.size <= size:
            self._file.seek(self._end)
            magic, key, length, checksum = HEAD.unpack(self._file.read(HEAD.size))
            if magic != MAGIC or self._end + HEAD.size + length > size:
                break
            if zlib.crc32(self._file.read(length), zlib.crc32(key)) != checksum:
                break
            self._places[key] = (self._end + HEAD.size, length)
            self._end += HEAD.size + length
        self._file.truncate(self._end)


def key_of(function: Callable[[J], Any], job: J) -> bytes:
    """Return the SHA-256 of what is asked: the function by its name, and the job as plain data.

    Equal jobs have equal keys, wherever their parts lie in memory; not so where a job holds a set of texts, whose order
    is another in each process: such a batch would not be found again.
    """
    stream = io.BytesIO()
    pickler = pickle.Pickler(stream, protocol=5)
    pickler.fast = True  # nothing is referred to by where it lies
    pickler.dump((function, job))
    return hashlib.sha256(stream.getvalue()).digest()


# Answers as text that is data only: numbers, words, lists, arrays, and the dataclasses that were named for it


C = TypeVar("C", bound=type[Any])
KINDS = frozenset("biufcU")
"""The kinds of numpy arrays that hold plain values: truths, numbers, texts; no objects, no records."""
_classes: dict[str, type[Any]] = {}


class NoDataError(ValueError):
    """An answer that cannot be written as data, or a text that is none."""


def keepable(cls: C) -> C:
    """Allow instances of a dataclass to be kept: they are written by field, and made again from their fields alone."""
    if not is_dataclass(cls) or _classes.setdefault(cls.__name__, cls) is not cls:
        raise TypeError(f"{cls.__name__} is no dataclass, or another one of that name is kept")
    return cls


def text_of(answer: Any) -> str:
    """Return an answer as JSON; arrays as base64 of their bytes. Raises NoDataError for what is no plain data."""
    return json.dumps(_tree(answer), separators=(",", ":"))


def answer_of(text: str) -> Any:
    """Return the answer that ``text_of`` wrote, equal to the last bit. Raises NoDataError for any other text.

    Nothing in the text is run, imported or looked up, but the names of dataclasses among those that were allowed.
    """
    try:
        return _answer(json.loads(text))
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
        raise NoDataError(f"{type(error).__name__}: {error}") from None


def _tree(value: Any) -> Any:
    if value is None or type(value) in (bool, int, float, str):
        return value
    if type(value) is list:
        return [_tree(part) for part in value]
    if type(value) is tuple:
        return {"tuple": [_tree(part) for part in value]}
    if type(value) is dict:
        return {"dict": [[_tree(key), _tree(part)] for key, part in value.items()]}
    if isinstance(value, np.generic) and value.dtype.kind in KINDS:
        return {"number": _packed(np.asarray(value))}
    if type(value) is np.ndarray and value.dtype.kind in KINDS:
        return {"array": _packed(value)}
    name = type(value).__name__
    if _classes.get(name) is not type(value):
        raise NoDataError(f"a {name} is no plain data")
    return {"class": [name, {field.name: _tree(getattr(value, field.name)) for field in fields(value)}]}


def _packed(array: np.ndarray[Any, Any]) -> str:
    stream = io.BytesIO()
    np.lib.format.write_array(stream, array, allow_pickle=False)
    return b64encode(stream.getvalue()).decode("ascii")


def _answer(tree: Any) -> Any:
    if isinstance(tree, list):
        return [_answer(part) for part in tree]
    if not isinstance(tree, dict):
        return tree
    ((tag, content),) = tree.items()
    if tag == "tuple":
        return tuple(_answer(part) for part in content)
    if tag == "dict":
        return {_answer(key): _answer(part) for key, part in content}
    if tag == "array":
        return _unpacked(content)
    if tag == "number":
        return _unpacked(content)[()]
    if tag == "class":
        name, parts = content
        return _classes[name](**{part: _answer(inner) for part, inner in parts.items()})
    raise NoDataError(f"'{tag}' is no kind of value")


def _unpacked(content: str) -> np.ndarray[Any, Any]:
    stream = io.BytesIO(b64decode(content, validate=True))
    return np.lib.format.read_array(stream, allow_pickle=False)
