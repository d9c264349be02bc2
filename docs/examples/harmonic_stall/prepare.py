"""Make run1.csv to run7.csv of the published record: its plateaus, each with the last two thirds set aside to judge.

python prepare.py data.csv
"""

import csv
import sys
from itertools import groupby
from pathlib import Path

COLUMNS = ["run [-]", "gearbox [-]", "motor_current [A]", "time [s]", "lever_torque [N*m]"]
HEADER = ["time [s]", "held [s]", "ratio [-]", "motor_current [A]", "lever_torque [N*m]", "record"]


Row = dict[str, str]


def plateau(rows: list[Row], torques: list[float], times: list[float]) -> list[list[str]]:
    """Return every fourth row from 0.2 s after the torque came on, as a table with a header; too few rows give none."""
    level = sorted(torques)[3 * len(torques) // 4]
    start = next(time for time, torque in zip(times, torques, strict=True) if torque >= 0.9 * level)
    kept = [(time, row) for time, row in zip(times, rows, strict=True) if time >= start + 0.2][::4]
    if len(kept) < 12:
        return []
    end = start + (kept[-1][0] - start) / 3
    made = [HEADER]
    for time, row in kept:
        ratio, role = "1" if row["gearbox [-]"] == "0" else "20", "fit" if time < end else "validation"
        held = f"{time - start:.4f}"
        made.append([row["time [s]"], held, ratio, row["motor_current [A]"], row["lever_torque [N*m]"], role])
    return made


def numbers(path: Path, rows: list[Row], column: str) -> list[float]:
    """Return a column as numbers. Raises ValueError with file and line at the first cell that is none."""
    found = []
    for row in rows:
        try:
            found.append(float(row[column]))
        except (TypeError, ValueError):
            name = column.split()[0]
            raise ValueError(f"{path}:{row['line']}: {name} '{row[column]}' is no number") from None
    return found


def prepared(path: Path) -> dict[str, list[list[str]]]:
    """Return the tables to write, by run. Raises ValueError with one sentence where the file is another one."""
    with path.open(encoding="utf-8-sig", newline="") as lines:
        table = csv.DictReader(lines)
        missing = [name for name in COLUMNS if name not in (table.fieldnames or [])]
        if missing:
            raise ValueError(f"{path}:1: no column '{missing[0]}'; README.md says which file is meant")
        every = [{**row, "line": str(table.line_num)} for row in table]
    made = {}
    for run, group in groupby(every, key=lambda row: row["run [-]"]):
        rows = list(group)
        torques, times = numbers(path, rows, "lever_torque [N*m]"), numbers(path, rows, "time [s]")
        made[run] = plateau(rows, torques, times)
        if not made[run]:
            raise ValueError(f"{path}: the plateau of run {run} is too short")
    if not made:
        raise ValueError(f"{path}: there are no rows in it")
    return made


def main(arguments: list[str]) -> int:
    """Write the files into this folder; 2 and one sentence where that cannot be done."""
    if len(arguments) != 1:
        sys.stderr.write("name the published record: python prepare.py data.csv\n")
        return 2
    if not Path(arguments[0]).is_file():
        sys.stderr.write(f"{arguments[0]}: no such file; README.md says where the record comes from\n")
        return 2
    try:
        tables = prepared(Path(arguments[0]))
    except ValueError as error:
        sys.stderr.write(f"{error}\n")
        return 2
    for run, table in tables.items():
        with Path(f"run{run}.csv").open("w", encoding="utf-8", newline="") as lines:
            csv.writer(lines, lineterminator="\n").writerows(table)
    sys.stdout.write(f"wrote {', '.join(f'run{run}.csv' for run in tables)}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
