"""Make measured.csv of the published record: every second row, with all behind the first 20 turns set aside to judge.

python prepare.py data.csv
"""

import csv
import math
import sys
from pathlib import Path

COLUMNS = ["time [s]", "angle [rad]", "torque [N*m]", "controller_temperature [degC]"]
TURNS = 20


def prepared(path: Path) -> list[list[str]]:
    """Return the header and the rows to write. Raises ValueError with one sentence where the file is another one."""
    with path.open(encoding="utf-8-sig", newline="") as lines:
        table = csv.DictReader(lines)
        missing = [name for name in COLUMNS if name not in (table.fieldnames or [])]
        if missing:
            raise ValueError(f"{path}:1: no column '{missing[0]}'; README.md says which file is meant")
        rows = [(table.line_num, row) for row in table][::2]
    made = [[*COLUMNS, "record"]]
    first = math.nan
    for line, row in rows:
        try:
            angle = float(row["angle [rad]"])
        except (TypeError, ValueError):
            raise ValueError(f"{path}:{line}: angle '{row['angle [rad]']}' is no number") from None
        first = first if made[1:] else angle
        role = "fit" if angle - first < TURNS * 2 * math.pi else "validation"
        made.append([*(row[name] for name in COLUMNS), role])
    if made[-1][-1] != "validation":
        raise ValueError(f"{path}: fewer than {TURNS} turns, so that no row is left to judge")
    return made


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
