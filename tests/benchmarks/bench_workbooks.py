"""Rows of a workbook are read in time that grows with their number, and in little more memory than they hold.

Run it: ``python -m pytest tests/benchmarks/bench_workbooks.py -s``. Time is that of the processor, so that a busy
machine makes no difference; what is judged is the ratio of ten times the rows to the rows.
"""

from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from timed import least, said_by_a_fresh_process

from truing.measurements import read_table, table_text
from truing.workbooks.writing import SheetTable, workbook_bytes

pytest.importorskip("openpyxl")

HEADERS = ["time [h]", "depth [um]", "load [N]", "probe_temperature [degC]", "run", "note"]
KNOWN = {"time": "h", "depth": "um", "load": "N", "probe_temperature": "degC"}
FEW, MANY = 10_000, 100_000
MOST_FOR_TEN = 15.0
"""Ten times the rows take 10 times as long where time is linear, and 100 times where it is quadratic. openpyxl alone
takes 11.5 times as long, and we 11.3 to 12.8: Python's collector of cycles passes over all that is kept."""
MEMORY = """
from bench_workbooks import read
from pathlib import Path
from timed import peak_of_this_process
import openpyxl
before = peak_of_this_process()
read(Path(sys.argv[1]))
print(peak_of_this_process() - before)
"""


def write(folder: Path, rows: int, *, gaps: bool) -> tuple[Path, Path]:
    """Write the same rows as a workbook and as CSV; with gaps every tenth note is missing."""
    draw = np.random.default_rng(4)
    numbers = draw.normal(100, 5, (rows, 4)).round(4).tolist()
    words = [("abc"[row % 3], None if gaps and row % 10 == 0 else "as read") for row in range(rows)]
    cells = [(*four, *two) for four, two in zip(numbers, words, strict=True)]
    book, text = folder / f"{rows}{gaps}.xlsx", folder / f"{rows}{gaps}.csv"
    book.write_bytes(workbook_bytes([SheetTable("rows", HEADERS, cells)]))
    text.write_text(table_text(HEADERS, list(zip(*cells, strict=True))), encoding="utf-8")
    return book, text


def read(path: Path) -> int:
    """Read rows as a diagnosis does; return how many there are."""
    table, faults = read_table(path, KNOWN)
    faults.raise_any()
    return len(table)


@pytest.mark.parametrize("gaps", [False, True], ids=["full", "with gaps"])
def test_ten_times_the_rows_take_ten_times_as_long(tmp_path: Path, gaps: bool) -> None:
    (few, _), (many, text) = (write(tmp_path, rows, gaps=gaps) for rows in (FEW, MANY))
    assert (read(few), read(many), read(text)) == (FEW, MANY, MANY)
    works: list[Callable[[], object]] = [partial(read, path) for path in (few, many, text)]
    seconds = least(*works)
    print(f"\n{FEW} rows {seconds[0]:.2f} s, {MANY} rows {seconds[1]:.2f} s, ratio {seconds[1] / seconds[0]:.1f}")
    print(f"{MANY} rows of CSV {seconds[2]:.2f} s: a workbook takes {seconds[1] / seconds[2]:.1f} times as long")
    assert seconds[1] / seconds[0] < MOST_FOR_TEN


def test_the_memory_grows_with_the_rows(tmp_path: Path) -> None:
    books = [write(tmp_path, rows, gaps=False)[0] for rows in (FEW, MANY)]
    few, many = (float(said_by_a_fresh_process(MEMORY, str(book))) for book in books)
    print(f"\n{FEW} rows {few:.0f} MiB, {MANY} rows {many:.0f} MiB")
    assert many < MOST_FOR_TEN * max(few, 1.0)
