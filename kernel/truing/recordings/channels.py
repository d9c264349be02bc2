"""What stands in a recording: channels, each with its values, its unit and the times at which they were taken."""

from __future__ import annotations

import logging
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.errors import Fault, InputError
from truing.units.grammar import shown

MOST_VALUES = 50_000_000
"""So many values of all channels are read: 400 MB of numbers, and a few times as much while they are looked through."""
MOST_CHANNELS = 10_000
INSTALL = "pip install 'truing[records]'"
_LOGGERS = ("nptdms", "asammdf")
_NO_UNIT = frozenset({"-", "–", "—", "1", ""})


@dataclass(frozen=True)
class Channel:
    """One channel of a recording.

    ``values`` (n,) are numbers or truth values, NaN where one is missing, stamps (datetime64), or texts (object, None
    where one is missing). ``times`` (n,) are the seconds of each since ``start``, or since the recording began where
    no stamp of it is known; None where the file gives no clock.
    """

    name: str
    group: str
    unit: str | None
    values: NDArray[Any]
    times: NDArray[np.float64] | None = None
    start: np.datetime64 | None = None

    @property
    def path(self) -> str:
        """Its name in the whole file: "Group/Channel"."""
        return f"{self.group}/{self.name}" if self.group else self.name


@dataclass(frozen=True)
class Recording:
    """The channels of a file, and what is to be said of others that are no columns, one sentence each."""

    channels: tuple[Channel, ...]
    notes: tuple[str, ...] = ()


class UnreadableError(Exception):
    """What is wrong with a recording as a whole, in one sentence; it does not leave this folder."""


def unit_or_none(unit: Any) -> str | None:
    """Return a unit as a file states it; None where it states none, "" for a pure number."""
    text = " ".join(str(unit).split()) if unit is not None else ""
    return ("" if text in _NO_UNIT else text) if text else None


def demand_modest(values: int, channels: int = 1) -> None:
    """Raise UnreadableError where a file says that it holds more than is read, before anything of it is read."""
    if channels > MOST_CHANNELS:
        raise UnreadableError(
            f"says that it holds {channels} channels, at most {MOST_CHANNELS} are read; export those needed"
        )
    if values > MOST_VALUES:
        much = f"says that it holds {values} values, at most {MOST_VALUES} are read"
        raise UnreadableError(f"{much}; export the channels and the time that matter")


def as_column(values: Any) -> NDArray[Any] | None:
    """Return values (n,) as numbers, truth values, stamps or texts; None for what is none of these."""
    array = np.asarray(values)
    if array.ndim != 1 or array.dtype.names is not None:
        return None
    if array.dtype.kind in "fiubM":
        return array
    if array.dtype.kind == "m":
        return array / np.timedelta64(1, "s")
    if array.dtype.kind in "SU":
        return _texts(array.tolist())
    if array.dtype.kind == "O" and all(value is None or isinstance(value, (str, bytes)) for value in array.tolist()):
        return _texts(array.tolist())
    return None


def _texts(values: list[Any]) -> NDArray[Any]:
    plain = (value.decode("utf-8", "replace") if isinstance(value, bytes) else value for value in values)
    return np.array([None if value is None else value.strip("\0 ") for value in plain], dtype=object)


@contextmanager
def told(file: Path, kind: str) -> Iterator[None]:
    """Turn whatever a library raises on a broken file, which may be any exception, into one sentence."""
    loggers = [logging.getLogger(name) for name in logging.root.manager.loggerDict if name.startswith(_LOGGERS)]
    levels = [logger.level for logger in loggers]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            for logger in loggers:
                logger.setLevel(logging.CRITICAL + 1)
            yield
        except InputError:
            raise
        except ImportError:
            needs = f"{kind} needs a library that is not installed: {INSTALL}"
            raise InputError([Fault(f"{needs}; or export it as CSV UTF-8", str(file))]) from None
        except UnreadableError as error:
            raise InputError([Fault(str(error), str(file))]) from None
        except Exception as error:
            reason = shown(f"{type(error).__name__}: {error}" if str(error) else type(error).__name__)[1:-1]
            sentence = f"cannot be read as {kind} ({reason}); it is damaged or cut off: copy or export it again"
            raise InputError([Fault(sentence, str(file))]) from error
        finally:
            for logger, level in zip(loggers, levels, strict=True):
                logger.setLevel(level)
