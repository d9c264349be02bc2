"""Make lives.csv of the published record: the logarithm of every life, of a run-out that of its last cycle.

python prepare.py data.csv
"""

import csv
import math
import sys
from pathlib import Path

STRESS, LIFE, OUTCOME = "stress [MPa]", "life [kcycles]", "outcome [-]"

Table = list[list[str]]


def prepared(path: Path) -> Table:
    """Return header and rows. Raises ValueError with one sentence where the file is another one."""
    with path.open(encoding="utf-8-sig", newline="") as lines:
        table = csv.DictReader(lines)
        missing = [name for name in (STRESS, LIFE, OUTCOME) if name not in (table.fieldnames or [])]
        if missing:
            raise ValueError(f"{path}:1: no column '{missing[0]}'; README.md says which file is meant")
        rows = [[row[STRESS], log_life(path, table.line_num, row), row[OUTCOME]] for row in table]
    if {row[-1] for row in rows} != {"failed", "runout"}:
        raise ValueError(f"{path}: the column 'outcome [-]' holds other words than 'failed' and 'runout', or one alone")
    return [[STRESS, "log_life [-]", "outcome"], *rows]


def log_life(path: Path, line: int, row: dict[str, str]) -> str:
    """Return the logarithm of the cycles. Raises ValueError with file and line at a cell that has none."""
    try:
        return f"{math.log10(1000 * float(row[LIFE])):.7g}"
    except (TypeError, ValueError):
        raise ValueError(f"{path}:{line}: life '{row[LIFE]}' is no number above 0") from None


def main(arguments: list[str]) -> int:
    """Write the file into this folder; 2 and one sentence where that cannot be done."""
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
    with Path("lives.csv").open("w", encoding="utf-8", newline="") as lines:
        csv.writer(lines, lineterminator="\n").writerows(table)
    sys.stdout.write(f"wrote lives.csv: {len(table) - 1} rows\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
