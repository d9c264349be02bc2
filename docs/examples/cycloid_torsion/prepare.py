"""Make measured.csv of the published record: means of eight rows, with loops 3, 4 and 7 set aside to judge.

python prepare.py data.csv
"""

import csv
import sys
from itertools import groupby
from pathlib import Path

MEANS = ["time [s]", "torque_command [N*m]", "torque [N*m]", "angle [rad]"]
LABELS = ["ramp [-]", "ramp_kind [-]"]
JUDGE = {"3", "4", "7"}
TOGETHER = 8

Row = dict[str, str]


def prepared(path: Path) -> list[list[str]]:
    """Return the header and the rows to write. Raises ValueError with one sentence where the file is another one."""
    with path.open(encoding="utf-8-sig", newline="") as lines:
        table = csv.DictReader(lines)
        missing = [name for name in (*MEANS, *LABELS) if name not in (table.fieldnames or [])]
        if missing:
            raise ValueError(f"{path}:1: no column '{missing[0]}'; README.md says which file is meant")
        rows = [{**row, "line": str(table.line_num)} for row in table]
    if not {row["ramp [-]"] for row in rows} > JUDGE:
        raise ValueError(f"{path}: the column 'ramp [-]' lacks the loops 3, 4 and 7, or holds nothing else")
    made = [[*MEANS, *LABELS, "record"]]
    for _, loop in groupby(rows, key=lambda row: row["ramp [-]"]):
        every = list(loop)
        blocks = [every[at : at + TOGETHER] for at in range(0, len(every) - TOGETHER + 1, TOGETHER)]
        made += [[*means(path, block), *(block[0][name] for name in LABELS), role(block[0])] for block in blocks]
    return made


def role(row: Row) -> str:
    """Return what the rows of a loop are for."""
    return "validation" if row["ramp [-]"] in JUDGE else "fit"


def means(path: Path, block: list[Row]) -> list[str]:
    """Return the mean of every measured column. Raises ValueError with file and line at a cell that is no number."""
    found = []
    for name in MEANS:
        total = 0.0
        for row in block:
            try:
                total += float(row[name])
            except (TypeError, ValueError):
                raise ValueError(f"{path}:{row['line']}: {name.split()[0]} '{row[name]}' is no number") from None
        found.append(f"{total / len(block):.7g}")
    return found


def main(arguments: list[str]) -> int:
    """Write measured.csv into this folder; 2 and one sentence where that cannot be done."""
    if len(arguments) != 1:
        sys.stderr.write("name the published record: python prepare.py data.csv\n")
        return 2
    if not Path(arguments[0]).is_file():
        sys.stderr.write(f"{arguments[0]}: no such file; README.md says where the record comes from\n")
        return 2
    try:
        table = prepared(Path(arguments[0]))
    except ValueError as error:
        sys.stderr.write(f"{error}\n")
        return 2
    with Path("measured.csv").open("w", encoding="utf-8", newline="") as lines:
        csv.writer(lines, lineterminator="\n").writerows(table)
    sys.stdout.write(f"wrote measured.csv: {len(table) - 1} rows\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
