"""Rows of a recording are read in time that grows with their number.

Run it: ``python -m pytest tests/benchmarks/bench_recordings.py -s``. Time is that of the processor, so that a busy
machine makes no difference; what is judged is the ratio of ten times the rows to the rows. An MDF file is read here as
in the process of its own in which the program reads it, so that its time counts.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from timed import least

from recording_files import KINDS, WRITERS, Recorded, write_csv
from truing.measurements import read_table
from truing.recordings import KINDS as READ
from truing.recordings import mdf_process

KNOWN = {"time": "h", "depth": "um", "load": "N", "temperature": "degC"}
FEW, MANY = 10_000, 100_000
MOST_FOR_TEN = 15.0
"""Ten times the rows take 10 times as long where time is linear, and 100 times where it is quadratic."""


def recorded(rows: int) -> dict[str, Recorded]:
    """Three channels of numbers on one clock."""
    draw, times = np.random.default_rng(4), 1e-3 * np.arange(rows)
    return {
        name: Recorded(draw.normal(100, 5, rows), unit, times)
        for name, unit in (("depth", "um"), ("load", "N"), ("temperature", "degC"))
    }


def read(path: Path) -> int:
    """Read rows as a diagnosis does; return how many there are."""
    table, faults = read_table(path, {} if path.suffix == ".mat" else KNOWN)
    faults.raise_any()
    return len(table)


@pytest.mark.parametrize("kind", KINDS)
def test_ten_times_the_rows_take_ten_times_as_long(tmp_path: Path, kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(READ, ".mf4", replace(READ[".mf4"], read=mdf_process.read_channels))
    few, many = (WRITERS[kind](tmp_path / f"{rows}.{kind}", recorded(rows)) for rows in (FEW, MANY))
    text = write_csv(tmp_path / "many.csv", recorded(MANY))
    assert (read(few), read(many), read(text)) == (FEW, MANY, MANY)
    works: list[Callable[[], object]] = [partial(read, path) for path in (few, many, text)]
    seconds = least(*works)
    print(f"\n{kind}: {FEW} rows {seconds[0]:.3f} s, {MANY} rows {seconds[1]:.3f} s, ", end="")
    print(f"ratio {seconds[1] / seconds[0]:.1f}; {MANY} rows of CSV {seconds[2]:.3f} s")
    assert seconds[1] / seconds[0] < MOST_FOR_TEN
