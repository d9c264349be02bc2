"""Make measured.csv of the published record: means of 16 rows, with every second stretch of 10 s set aside to judge.

python prepare.py data.csv
"""

import csv
import sys
from pathlib import Path

COLUMNS = ["time [s]", "speed [rad/s]", "speed_command [rad/s]", "torque [N*m]"]
TOGETHER = 16
STRETCH = 10.0  # s
SLOWEST = 0.3  # rad/s, below which the movement sticks and slips


def prepared(path: Path) -> list[list[str]]:
    """Return the header and the rows to write. Raises ValueError with one sentence where the file is another one."""
    with path.open(encoding="utf-8-sig", newline="") as lines:
        table = csv.DictReader(lines)
        missing = [name for name in COLUMNS if name not in (table.fieldnames or [])]
        if missing:
            raise ValueError(f"{path}:1: no column '{missing[0]}'; README.md says which file is meant")
        rows = [numbers(path, table.line_num, row) for row in table]
    made = [["time [s]", "speed [rad/s]", "acceleration [rad/s^2]", "torque [N*m]", "record"]]
    for first in range(0, len(rows) - TOGETHER + 1, TOGETHER):
        time, speed, acceleration, torque = block_of(rows[first : first + TOGETHER])
        if abs(speed) > SLOWEST:
            role = "validation" if time // STRETCH % 2 else "fit"
            made.append([*(f"{value:.7g}" for value in (time, speed, acceleration, torque)), role])
    if {row[-1] for row in made[1:]} != {"fit", "validation"}:
        raise ValueError(f"{path}: shorter than two stretches of {STRETCH:g} s, so that no row is left to judge")
    return made


def block_of(rows: list[list[float]]) -> tuple[float, float, float, float]:
    """Return the means of time, speed and torque, and the slope of the speed that was commanded."""
    time, speed, _, torque = (sum(column) / len(rows) for column in zip(*rows, strict=True))
    acceleration = (rows[-1][2] - rows[0][2]) / (rows[-1][0] - rows[0][0])
    return time, speed, acceleration, torque


def numbers(path: Path, line: int, row: dict[str, str]) -> list[float]:
    """Return the cells of a row. Raises ValueError with file and line at a cell that is no number."""
    values = []
    for name in COLUMNS:
        try:
            values.append(float(row[name]))
        except (TypeError, ValueError):
            raise ValueError(f"{path}:{line}: {name.split()[0]} '{row[name]}' is no number") from None
    return values


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
