"""The rows of a recording: its channels on one time base, named by [columns], as text that reads back exactly.

Where a file has several clocks the rows stand at the times of the measured results: no reading is made up and none is
lost. What else was recorded is interpolated onto these times, linearly and never beyond its own first and last value.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.errors import Fault, InputError, UnitError
from truing.inputs_file.files import refuse_recording
from truing.measurements.csv_text import (
    LARGEST_TABLE,
    NOTHING,
    ROWS_AT_ONCE,
    ColumnNames,
    DecimalMarks,
    Faults,
    Header,
    RowCount,
    name_and_unit,
)
from truing.measurements.derived import TIME
from truing.numbers import counted
from truing.recordings import Channel, read_recording
from truing.units import check_unit, to_si
from truing.units.grammar import shown
from truing.units.names import PURE

FIRST_LINE = 2
"""What the first row is called: its line in the same table as CSV, behind the header."""
SAME_TIME = 1e-6
"""Clocks that differ by a smaller share of their mean step are one: what is left is the rounding of the file."""


@dataclass(frozen=True)
class Parts:
    """What columns are to the model, by name: known at all, results that keep their own times, words that are held."""

    known: frozenset[str]
    results: frozenset[str]
    words: frozenset[str]


@dataclass(frozen=True)
class NamedChannel:
    """A channel and the header of its column; ``clock`` are its times (m,) in seconds, None where there are none."""

    header: Header
    channel: Channel
    values: NDArray[Any]
    clock: NDArray[np.float64] | None


@dataclass
class RecordedTable:
    """An open recording: columns of one length, whose rows come in chunks of text."""

    file: str
    faults: Faults
    headers: tuple[Header, ...]
    values: Sequence[NDArray[Any]]
    lines: NDArray[np.intp]
    left_out: dict[str, list[int]]
    header_line: int | None = None
    marks: DecimalMarks = field(default_factory=lambda: DecimalMarks(may_be_comma=False))

    @property
    def decimal_comma(self) -> bool:
        """Never: numbers are no texts here."""
        return False

    def count(self) -> RowCount:
        """Return how many rows the recording has, with those left out."""
        return RowCount(self.file, len(self.lines) + sum(map(len, self.left_out.values()))).without_all(self.left_out)

    def chunks(self) -> Iterator[tuple[list[tuple[str, ...]], tuple[int, ...]]]:
        """Give columns of text with the row of each, thousands at a time."""
        for start in range(0, len(self.lines), ROWS_AT_ONCE):
            part = slice(start, start + ROWS_AT_ONCE)
            yield [tuple(_texts(values[part])) for values in self.values], tuple(self.lines[part].tolist())
        if not len(self.lines):
            self.faults.add(f"holds no row that can be used: {self.count().sentence()}")


def _texts(values: NDArray[Any]) -> list[str]:
    """Return values as a CSV file would have them: numbers exact, nothing where one is missing."""
    if values.dtype == object:
        return ["" if value is None else value for value in values.tolist()]
    if values.dtype.kind == "b":
        return [str(value).lower() for value in values.tolist()]
    if values.dtype.kind in "iu":
        return list(map(str, values.tolist()))
    numbers = values.tolist()
    return ["" if number != number else repr(number) for number in numbers]


@contextmanager
def opened_recording(path: Path, names: ColumnNames, parts: Parts) -> Iterator[RecordedTable]:
    """Open a recording as a table. Raises InputError where it cannot be one."""
    refuse_recording(path, largest=LARGEST_TABLE)
    recording = read_recording(path)
    names.notes += recording.notes
    if not recording.channels:
        why = f" ({'; '.join(recording.notes[:4])})" if recording.notes else ""
        raise InputError([Fault(f"holds no channel with values{why}; record or export it again", str(path))])
    faults = Faults(str(path))
    channels = _with_clocks(_named(recording.channels, names, parts), faults)
    rows = _on_one_base(channels, parts, names, faults)
    faults.raise_any()
    _demand_apart(rows.headers, faults)
    headers = rows.headers
    faults.addressed = lambda line, column: f"line {line} of {shown(_called(headers, column))}"
    values, lines, left_out = _usable(rows)
    yield RecordedTable(str(path), faults, headers, values, lines, left_out)


def _called(headers: Sequence[Header], column: str | int) -> str:
    """Return what the file calls a column."""
    header = (
        headers[column] if isinstance(column, int) else next((each for each in headers if each.name == column), None)
    )
    return header.key or header.text if header is not None else str(column)


def _demand_apart(headers: Sequence[Header], faults: Faults) -> None:
    """Say which channels are called alike."""
    for name, count in Counter(header.name for header in headers).items():
        if count > 1:
            alike = " and ".join(shown(header.key) for header in headers if header.name == name)
            faults.add(f"the channels {alike} are all called {shown(name)}; name them apart under [columns]")


# Names, units and clocks


def _named(channels: Sequence[Channel], names: ColumnNames, parts: Parts) -> list[NamedChannel]:
    """Return the channels with their headers: by their own name where it stands once in the file, else by the whole."""
    often = Counter(channel.name for channel in channels)
    made = []
    for channel in channels:
        name, unit = name_and_unit(channel.name)
        is_alone = often[channel.name] == 1
        stamped = channel.values.dtype.kind == "M"
        said = None if stamped else unit if channel.unit is None else channel.unit
        own = (name or channel.name) if is_alone or name == TIME else channel.path
        called = [channel.path, *([channel.name] if is_alone else [])]
        header = names.header(own, said, own if said is None else f"{own} [{said}]", *called)
        header = replace(header, unit="s") if stamped else _with_known_unit(header, names, parts)
        made.append(NamedChannel(header, channel, channel.values, channel.times))
    return made


def _with_known_unit(header: Header, names: ColumnNames, parts: Parts) -> Header:
    """Return a header without its unit where nobody knows the unit, nor the model the column; and say so."""
    if header.unit is None or header.unit in PURE or header.name in parts.known:
        return header
    try:
        check_unit(header.unit)
    except UnitError as error:
        numbers = "its values are taken as numbers without a unit; state its unit under [columns] where it matters"
        names.notes.append(f"channel {shown(header.key)}: {error}; {numbers}")
        return replace(header, unit=None)
    return header


def _with_clocks(channels: list[NamedChannel], faults: Faults) -> list[NamedChannel]:
    """Return the channels with their times in seconds from the start, and stamps as seconds.

    A channel called ``time`` is the clock of its group. Stamps of all clocks count from the earliest of them.
    """
    own = {each.channel.group: each for each in channels if each.header.name == TIME}
    clocks = {id(each): _clock(each, own.get(each.channel.group), faults) for each in channels}
    starts = [start for _, start in clocks.values() if start is not None]
    is_relative = any(times is not None and start is None for times, start in clocks.values())
    if starts and is_relative and len({*_lengths(channels)}) > 1:
        faults.add("some channels have stamps and others only seconds, so nobody knows which rows belong together")
    first = min(starts, default=None)
    made = []
    for each in channels:
        times, start = clocks[id(each)]
        if times is not None and start is not None and first is not None and start != first:
            times = times + _seconds(start - first)
        values = each.values
        if values.dtype.kind == "M":
            values = times if each is own.get(each.channel.group) and times is not None else _since_first(values)
        made.append(replace(each, clock=times, values=values))
    return made


def _clock(
    named: NamedChannel, own: NamedChannel | None, faults: Faults
) -> tuple[NDArray[np.float64] | None, np.datetime64 | None]:
    """Return the times (n,) of a channel in seconds, and the stamp that they count from where there is one."""
    if own is None or len(own.values) != len(named.values):
        return named.channel.times, named.channel.start
    if own.values.dtype.kind == "M":
        known = own.values[~np.isnat(own.values)]
        return _since_first(own.values), known[0] if len(known) else None
    if own.values.dtype == object:
        faults.add(f"channel {shown(own.header.key)} is called time and holds texts")
        return None, None
    times = own.values.astype(float)
    try:
        return (times if own.header.unit is None or own.header.unit in PURE else to_si(times, own.header.unit)), None
    except UnitError:
        return times, None  # said where its column is read


def _seconds(difference: Any) -> Any:
    return difference / np.timedelta64(1, "ns") / 1e9


def _since_first(stamps: NDArray[Any]) -> NDArray[np.float64]:
    """Return stamps (n,) as seconds since the first that is known, NaN where one is missing."""
    known = stamps[~np.isnat(stamps)]
    if not len(known):
        return np.full(len(stamps), np.nan)
    return np.asarray((stamps - known[0]).astype("timedelta64[ns]") / np.timedelta64(1, "ns") / 1e9)


def _lengths(channels: Sequence[NamedChannel]) -> list[int]:
    return [len(each.values) for each in channels]


# One time base


@dataclass(frozen=True)
class Rows:
    """Columns of one length; ``outside`` marks the rows that are left out, by reason."""

    headers: tuple[Header, ...]
    values: tuple[NDArray[Any], ...]
    outside: dict[str, NDArray[np.bool_]]


def _on_one_base(channels: list[NamedChannel], parts: Parts, names: ColumnNames, faults: Faults) -> Rows:
    """Return all channels on one time base; as they stand where they have one."""
    clocks = [each.clock for each in channels if each.clock is not None]
    if len(set(_lengths(channels))) == 1 and all(_is_same(clock, clocks[0]) for clock in clocks[1:]):
        first = next((each for each in channels if each.header.name == TIME), None)  # others say the same
        columns = [each for each in channels if each is first or each.header.name != TIME]
        headers, values = [each.header for each in columns], [each.values for each in columns]
        if clocks and TIME not in [header.name for header in headers]:
            headers, values = [_time_header(), *headers], [clocks[0], *values]
        return Rows(tuple(headers), tuple(values), {})
    timed = _timed(channels, parts, names, faults)
    if faults.found or not timed:
        return Rows((), (), {})
    base, of_whom = _base(timed, parts)
    headers, values, outside = [_time_header()], [base], {}
    for each in timed:
        column, beyond = _onto(base, of_whom, each, parts, names)
        headers.append(each.header)
        values.append(column)
        if each.header.name in parts.known and beyond.any():
            outside[f"outside the time in which {shown(each.header.key)} was recorded"] = beyond
    return Rows(tuple(headers), tuple(values), outside)


def _time_header() -> Header:
    return Header(TIME, "s", f"{TIME} [s]")


def _is_same(clock: NDArray[np.float64], other: NDArray[np.float64]) -> bool:
    """Whether two clocks are one, but for rounding."""
    if clock is other:
        return True
    if len(clock) != len(other):
        return False
    step = np.nanmean(np.abs(np.diff(clock))) if len(clock) > 1 else 0.0
    return bool(np.allclose(clock, other, rtol=0, atol=SAME_TIME * step, equal_nan=True))


def _timed(channels: list[NamedChannel], parts: Parts, names: ColumnNames, faults: Faults) -> list[NamedChannel]:
    """Return the channels that have a usable clock, clocks themselves left out; say what is wrong with the others."""
    timed = []
    for each in channels:
        called = shown(each.header.key)
        if each.header.name == TIME:
            continue
        if each.clock is None:
            many = counted(len(each.values), "value")
            sentence = f"channel {called} has {many} and no clock, beside channels of other lengths"
            if each.header.name in parts.known:
                faults.add(f'{sentence}; call the channel that holds its times "time" under [columns]')
            else:
                names.notes.append(f"{sentence}; it is left out")
        elif not (np.diff(each.clock) > 0).all():
            place = int(np.flatnonzero(~(np.diff(each.clock) > 0))[0]) + 2
            faults.add(
                f"the times of channel {called} do not increase at value {place}; nothing can be interpolated in them"
            )
        else:
            timed.append(each)
    if not timed and not faults.found:
        faults.add(
            'holds channels of different lengths and no clock; call the channel of their times "time" under [columns]'
        )
    return timed


def _base(timed: list[NamedChannel], parts: Parts) -> tuple[NDArray[np.float64], str]:
    """Return the times of all measured results together, else those of the channel with the most values; and whose."""
    measured = [each for each in timed if each.header.name in parts.results]
    if not measured:
        longest = max(timed, key=lambda each: len(each.values))
        return np.asarray(longest.clock), shown(longest.header.key)
    clocks: list[Any] = [each.clock for each in measured]
    apart = [clock for place, clock in enumerate(clocks) if not any(_is_same(clock, other) for other in clocks[:place])]
    of_whom = " and ".join(dict.fromkeys(shown(each.header.key) for each in measured))
    return apart[0] if len(apart) == 1 else np.unique(np.concatenate(apart)), of_whom


def _onto(
    base: NDArray[np.float64], of_whom: str, named: NamedChannel, parts: Parts, names: ColumnNames
) -> tuple[NDArray[Any], NDArray[np.bool_]]:
    """Return a channel at the times of the base (n,), missing where it was not recorded; and which rows these are."""
    clock, values, nowhere = np.asarray(named.clock), named.values, np.zeros(len(base), dtype=bool)
    called, many = shown(named.header.key), counted(len(values), "value")
    if _is_same(clock, base):
        return values, nowhere
    if named.header.name in parts.results:
        is_text = values.dtype == object
        column: NDArray[Any] = np.full(len(base), None if is_text else np.nan, dtype=object if is_text else float)
        column[_nearest(base, clock)] = values
        names.notes.append(
            f"channel {called} keeps its {many} in {len(base)} rows: a measured result is not interpolated"
        )
        return column, nowhere
    beyond = (base < clock[0]) | (base > clock[-1])
    if values.dtype == object or values.dtype.kind == "b" or named.header.name in parts.words:
        latest = values[np.maximum(np.searchsorted(clock, base, side="right") - 1, 0)]
        column, how = _as_objects(latest), "each value held until the next"
        column[beyond] = None
    else:
        column = np.interp(base, clock, values.astype(float))
        column[beyond] = np.nan
        how = "linear interpolation"
    left = f"; {counted(int(beyond.sum()), 'row lies', 'rows lie')} outside its record" if beyond.any() else ""
    names.notes.append(f"channel {called}: from {many} to {counted(len(base))} at the times of {of_whom}, {how}{left}")
    return column, beyond


def _nearest(base: NDArray[np.float64], clock: NDArray[np.float64]) -> NDArray[np.intp]:
    """Return the row of the base at each of the times, which are the same but for rounding."""
    above = np.clip(np.searchsorted(base, clock), 1, len(base) - 1)
    return np.where(clock - base[above - 1] < base[above] - clock, above - 1, above)


def _as_objects(values: NDArray[Any]) -> NDArray[Any]:
    return np.array(values if values.dtype == object else _texts(values), dtype=object)


def _usable(rows: Rows) -> tuple[list[NDArray[Any]], NDArray[np.intp], dict[str, list[int]]]:
    """Return the columns without the rows that are left out, the number of each row, and those left out by reason."""
    length = len(rows.values[0]) if rows.values else 0
    kept, left_out = np.ones(length, dtype=bool), dict[str, list[int]]()
    empty = np.ones(length, dtype=bool)
    for values in rows.values:
        empty &= np.array([value in (None, "") for value in values]) if values.dtype == object else values != values
    for reason, beyond in {**rows.outside, NOTHING: empty}.items():
        if (beyond & kept).any():
            left_out[reason] = (np.flatnonzero(beyond & kept) + FIRST_LINE).tolist()
            kept &= ~beyond
    return [values[kept] for values in rows.values], np.flatnonzero(kept) + FIRST_LINE, left_out
