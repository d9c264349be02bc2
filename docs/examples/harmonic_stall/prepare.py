"""Make run1.csv to run7.csv of the published record: its plateaus, each with the last two thirds set aside to judge.

python prepare.py data.csv
"""

import csv
import sys
from itertools import groupby
from pathlib import Path

COLUMNS = ["run [-]", "gearbox [-]", "motor_current [A]", "time [s]", "lever_torque [N*m]"]
HEADER = ["time [s]", "held [s]", "ratio [-]", "motor_current [A]", "lever_torque [N*m]", "record"]


def plateau(rows: list[dict[str, str]]) -> list[list[str]]:
    """Return every fourth row from 0.2 s after the torque came on, as a table with a header."""
    torques = sorted(float(row["lever_torque [N*m]"]) for row in rows)
    level = torques[3 * len(torques) // 4]
    start = next(float(row["time [s]"]) for row in rows if float(row["lever_torque [N*m]"]) > 0.9 * level)
    kept = [row for row in rows if float(row["time [s]"]) >= start + 0.2][::4]
    end = start + (float(kept[-1]["time [s]"]) - start) / 3
    made = [HEADER]
    for row in kept:
        time, ratio = row["time [s]"], "1" if row["gearbox [-]"] == "0" else "20"
        role = "fit" if float(time) < end else "validation"
        held = f"{float(time) - start:.4f}"
        made.append([time, held, ratio, row["motor_current [A]"], row["lever_torque [N*m]"], role])
    return made


def prepared(path: Path) -> dict[str, list[list[str]]]:
    """Return the tables to write, by run. Raises ValueError with one sentence where the file is another one."""
    with path.open(encoding="utf-8-sig", newline="") as lines:
        table = csv.DictReader(lines)
        missing = [name for name in COLUMNS if name not in (table.fieldnames or [])]
        if missing:
            raise ValueError(f"{path}:1: no column '{missing[0]}'; README.md says which file is meant")
        runs = {run: list(rows) for run, rows in groupby(table, key=lambda row: row["run [-]"])}
    return {run: plateau(rows) for run, rows in runs.items()}


def main(arguments: list[str]) -> int:
    """Write the files into this folder; 2 and one sentence where that cannot be done."""
    if len(arguments) != 1:
        sys.stderr.write("name the published record: python prepare.py data.csv\n")
        return 2
    try:
        tables = prepared(Path(arguments[0]))
    except (OSError, ValueError) as error:
        sys.stderr.write(f"{error}\n")
        return 2
    for run, table in tables.items():
        with Path(f"run{run}.csv").open("w", encoding="utf-8", newline="") as lines:
            csv.writer(lines, lineterminator="\n").writerows(table)
    sys.stdout.write(f"wrote {', '.join(f'run{run}.csv' for run in tables)}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
