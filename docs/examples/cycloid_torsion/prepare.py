"""Make measured.csv of the published record: every eighth row, with loops 3, 4 and 7 set aside to judge.

python prepare.py data.csv
"""

import csv
import sys
from pathlib import Path

COLUMNS = ["time [s]", "ramp [-]", "ramp_kind [-]", "torque_command [N*m]", "torque [N*m]", "angle [rad]"]
JUDGE = {"3", "4", "7"}


def prepared(path: Path) -> list[list[str]]:
    """Return the header and the rows to write. Raises ValueError with one sentence where the file is another one."""
    with path.open(encoding="utf-8-sig", newline="") as lines:
        table = csv.DictReader(lines)
        missing = [name for name in COLUMNS if name not in (table.fieldnames or [])]
        if missing:
            raise ValueError(f"{path}:1: no column '{missing[0]}'; README.md says which file is meant")
        rows = list(table)[::8]
    loops = {row["ramp [-]"] for row in rows}
    if not loops > JUDGE:
        raise ValueError(f"{path}: the column 'ramp [-]' lacks the loops 3, 4 and 7, or holds nothing else")
    told = [[*(row[name] for name in COLUMNS), "validation" if row["ramp [-]"] in JUDGE else "fit"] for row in rows]
    return [[*COLUMNS, "record"], *told]


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
