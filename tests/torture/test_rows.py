"""No row is lost: every line of a file is used, left out with its reason, or the file is refused and the line named."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from random import Random

import pytest

from shared import TESTS

sys.path += [str(TESTS / "unit")]

from sample_models import PIN_OFFER, PIN_WEAR

from truing.cases import run_cases
from truing.errors import Fault, InputError
from truing.executors import SerialExecutor
from truing.measurements import RowCount, read_cases, read_rows, read_table
from truing.runs.documents import results_document
from truing.runs.provenance import provenance_of
from truing.setup import default_setup

HEADERS = ["load [N]", "load [kN]", "speed [m/s]", "probe_temperature [degC]", "case", "note"]
PLAIN = ["5", "7.25", "1e2", "0.5", "12", "20", "", " 3 "]
HOSTILE = [
    '"', '""', '"5', '5"', '"5"', '"5"6', '"a""b"', '"open', 'end"', "#", "#3", '"#3"', " # x", "9,5", "1,050", "1.050",
    "\u0665", "nan", "-", "inf", "1e400", "x", "'", "\ufeff", "\x0b", "\u2028", "\x85", "\x1c", ";", ",", "\t", "[",
]  # fmt: skip
ENDS = ["\n", "\n", "\n", "\r\n", "\r", "\n\n", "\n \t\n"]


def hostile(random: Random) -> str:
    """Return a table that is nearly one: some cells, line ends, quotation marks and remarks are wrong."""
    mark = random.choice([",", ",", ";", "\t"])
    names = random.sample(HEADERS, random.randint(1, 4))
    bad = random.choice([0.0, 0.02, 0.1, 0.4])
    lines = ["# rig 7" if random.random() < 0.2 else "", mark.join(names)]
    for _ in range(random.randint(0, 9)):
        width = len(names) + (random.choice([-1, 1, 1]) if random.random() < bad else 0)
        cells = [random.choice(HOSTILE if random.random() < bad else PLAIN) for _ in range(width)]
        lines.append(("# " if random.random() < 0.05 else "") + mark.join(cells))
        if random.random() < 0.05:
            lines.append(random.choice(["# a remark", "#", " #, ,", mark * 3, "\u2028"]))
    text = "".join(line + random.choice(ENDS) for line in lines if line or random.random() < 0.3)
    return ("\ufeff" if random.random() < 0.1 else "") + (text.rstrip("\r\n") if random.random() < 0.3 else text)


def rows_of(text: str) -> tuple[list[int], set[int]]:
    """Return the lines behind the header that hold anything, and those whose quotation marks do not close.

    By hand, one character after the other: no line end is inside of a cell.
    """
    physical = re.split(r"\r\n|\r|\n", text.removeprefix("\ufeff"))
    numbered = [(number, line) for number, line in enumerate(physical, start=1) if line.strip()]
    header = next(place for place, (_, line) in enumerate(numbered) if not line.lstrip().startswith("#"))
    mark = next((mark for mark in ";\t" if mark in numbered[header][1]), ",")
    behind = numbered[header + 1 :]
    rows = [(number, line) for number, line in behind if not line.lstrip().startswith("#")]
    return [number for number, _ in behind], {number for number, line in rows if is_open(line, mark)}


def is_open(line: str, mark: str) -> bool:
    """Tell whether a quotation mark that begins a cell is not closed, or anything stands behind the closing one."""
    position = 0
    while position <= len(line):
        while line[position : position + 1] == " ":
            position += 1
        if line[position : position + 1] == '"':
            position += 1
            while not (line[position : position + 1] == '"' and line[position + 1 : position + 2] != '"'):
                if position >= len(line):
                    return True
                position += 2 if line[position] == '"' else 1
            position += 1
            while line[position : position + 1] == " ":
                position += 1
            if position < len(line) and line[position] != mark:
                return True
        while position < len(line) and line[position] != mark:
            position += 1
        position += 1
    return False


def judge(lines: list[int], broken: set[int], used: list[int], count: RowCount) -> None:
    """Demand that the lines used and those left out are the rows of the file, each once."""
    left = [line for lines in count.left_out.values() for line in lines]
    assert sorted([*used, *left]) == lines
    assert (count.in_file, count.used) == (len(lines), len(used))
    assert all(count.left_out)
    assert not broken & set(used)


Read = tuple[list[int], RowCount]
SETUP = default_setup(PIN_WEAR, PIN_OFFER.origin)


def data_read(path: Path) -> Read:
    table, found = read_table(path, {"load": "N", "speed": "m/s", "probe_temperature": "degC"})
    found.raise_any()
    return list(table.lines), table.count


def cases_read(path: Path) -> Read:
    read = read_cases(path, PIN_OFFER, SETUP)
    return [case.line for case in read.cases], read.count


def rows_read(path: Path) -> Read:
    read = read_rows(path, PIN_OFFER, SETUP)
    return list(read.lines), read.count


def answered(read: Callable[[Path], Read], path: Path) -> Read | tuple[Fault, ...]:
    """Return what was read, or the faults of a file that is refused."""
    try:
        return read(path)
    except InputError as error:
        return error.faults


@pytest.mark.parametrize("read", [data_read, cases_read, rows_read])
def test_every_line_of_a_hostile_file_is_used_or_named(
    read: Callable[[Path], Read], full_torture: bool, tmp_path: Path
) -> None:
    path, taken = tmp_path / "rows.csv", 0
    for number in range(10_000 if full_torture else 200):
        text = hostile(Random(number * 7919))
        path.write_bytes(text.encode())
        lines, broken = rows_of(text)
        answer = answered(read, path)
        if isinstance(answer[-1], RowCount):
            judge(lines, broken, *answer)  # type: ignore[arg-type]
            taken += 1
            continue
        named = {fault.line for fault in answer}  # type: ignore[union-attr]
        assert broken <= named or len(answer) > 200, text
        assert named <= {None, *range(1, len(re.split(r"\r\n|\r|\n", text)) + 1)}
    assert taken > 20


def test_every_row_of_a_run_stands_in_results_json(full_torture: bool, tmp_path: Path) -> None:
    """Cases that cannot be calculated are left out with the reason; what was calculated and they are all rows."""
    setup, path = replace(SETUP, studies=()), tmp_path / "rows.csv"
    for number in range(200 if full_torture else 10):
        random = Random(number)
        loads = [random.choice(["120", "5e5", "140", ""]) for _ in range(random.randint(1, 30))]
        lines = [f"{load},{random.choice(['', '#', 'x'])}" for load in ["90", *loads]]
        path.write_text("load [N],note\n" + "\n".join(lines) + "\n# end\n", encoding="utf-8")
        with SerialExecutor() as alone:
            found, cases = run_cases(setup, read_cases(path, PIN_OFFER, setup), executor=alone)
        document = results_document(found, provenance_of(setup), cases=cases)
        rows = document["rows"]
        left = [line for item in rows["left_out"] for line in item["lines"]]
        assert rows["file"] == "rows.csv"
        assert rows["in_file"] == rows["used"] + len(left) == len(lines) + 1
        failed = [line for line, load in enumerate(["90", *loads], start=2) if load == "5e5"]
        empty = [line for line, text in enumerate(lines, start=2) if text == ","]
        assert sorted(left) == sorted([*failed, *empty, len(lines) + 2])
