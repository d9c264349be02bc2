"""What calculations answered for rows, remembered for a few calls: fits and curves ask for the same rows again."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from hashlib import blake2b
from struct import pack
from typing import Any, Final

import numpy as np

from truing.declare.batch import FailedRows, watching

REMEMBERED: Final = 8
LARGEST: Final = 1_000_000
"""So many numbers of results are remembered; a longer record is calculated anew."""


@dataclass(frozen=True)
class Known:
    """What a function answered for some rows, and which of them failed."""

    function: Callable[[Any], Any]
    results: Any
    failed: FailedRows


Memory = OrderedDict[bytes, Known]
OF_MODELS: Final[Memory] = OrderedDict()
OF_SOURCES: Final[Memory] = OrderedDict()
"""What sources of chains answered: apart, so that the many of one call do not drive out what models answered."""


def answered_before(
    memory: Memory, function: Callable[[Any], Any], inputs: Any, values: Mapping[tuple[str, ...], Any], *,
    rows: int, results: int,
) -> Known:  # fmt: skip
    """Return what a calculation answers for so many rows, called anew only where it is not remembered.

    ``values`` are all its inputs by path, which tell two calls apart; ``results`` is how many of them it gives.
    """
    key = key_of(values)
    known = memory.get(key)
    if known is None or known.function is not function:
        with watching(rows) as failed:
            known = Known(function, function(inputs), failed)
        if rows * max(results, 1) <= LARGEST:
            memory[key] = known
            if len(memory) > REMEMBERED:
                memory.popitem(last=False)
    return known


def forget() -> None:
    """Forget every answer: the next call is one of the calculation itself."""
    OF_MODELS.clear()
    OF_SOURCES.clear()


def key_of(values: Mapping[tuple[str, ...], Any]) -> bytes:
    """Return what tells inputs of one calculation apart; they come in one order, and each says where it ends."""
    digest = blake2b(digest_size=16)
    for value in values.values():
        if isinstance(value, np.ndarray):
            digest.update(f"array{value.shape}{value.dtype.str}\0".encode())
            digest.update(np.ascontiguousarray(value).data)
        elif isinstance(value, float):
            digest.update(b"float" + pack("d", value))
        else:
            digest.update(f"other{value!r}\0".encode())
    return digest.digest()
