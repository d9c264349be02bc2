"""Answers as text that is data only: numbers, words, lists, arrays, and the dataclasses that were named for it."""

from __future__ import annotations

import json
from base64 import b64decode, b64encode
from dataclasses import fields, is_dataclass
from typing import Any, TypeVar

import numpy as np

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


def _packed(array: np.ndarray[Any, Any]) -> list[Any]:
    order = "F" if array.flags.f_contiguous and not array.flags.c_contiguous else "C"
    return [array.dtype.str, list(array.shape), order, b64encode(array.tobytes(order=order)).decode("ascii")]  # type: ignore[arg-type]


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
        return _unpacked(*content)
    if tag == "number":
        return _unpacked(*content)[()]
    if tag == "class":
        name, parts = content
        return _classes[name](**{part: _answer(inner) for part, inner in parts.items()})
    raise NoDataError(f"'{tag}' is no kind of value")


def _unpacked(kind: str, shape: list[int], order: str, content: str) -> Any:
    dtype = np.dtype(kind)
    if dtype.kind not in KINDS or order not in {"C", "F"}:
        raise NoDataError(f"an array of '{kind}' is no plain data")
    flat = np.frombuffer(bytearray(b64decode(content, validate=True)), dtype)
    return flat.reshape(shape, order=order)  # type: ignore[call-overload]
