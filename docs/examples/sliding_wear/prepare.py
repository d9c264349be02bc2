"""Make measured.csv and logarithms.csv of the published record: each specimen is a run, two of every load only judge.

python prepare.py data.csv
"""

import csv
import math
import sys
from pathlib import Path

NUMBERS = ["load [gf]", "cycles [-]", "wear [um]"]
SPECIMEN = "specimen [-]"
JUDGES = 2

Table = list[list[str]]


def prepared(path: Path) -> dict[str, Table]:
    """Return header and rows of both files. Raises ValueError with one sentence where the file is another one."""
    with path.open(encoding="utf-8-sig", newline="") as lines:
        table = csv.DictReader(lines)
        missing = [name for name in (SPECIMEN, *NUMBERS) if name not in (table.fieldnames or [])]
        if missing:
            raise ValueError(f"{path}:1: no column '{missing[0]}'; README.md says which file is meant")
        rows = [[row[SPECIMEN], *checked(path, table.line_num, row)] for row in table]
    judging = judges(path, rows)
    made = [[*row, "validation" if row[0] in judging else "fit"] for row in rows]
    logarithms = [[*row[:3], f"{math.log10(float(row[3])):.6f}", row[4]] for row in made]
    return {
        "measured.csv": [["run", *NUMBERS, "record"], *made],
        "logarithms.csv": [["run", *NUMBERS[:2], "log_wear [-]", "record"], *logarithms],
    }


def judges(path: Path, rows: Table) -> set[str]:
    """Return the last specimens of every load. Raises ValueError where a load has too few of them."""
    under: dict[str, list[str]] = {}
    for specimen, load, *_ in rows:
        specimens = under.setdefault(load, [])
        if specimen not in specimens:
            specimens.append(specimen)
    if not rows or min(map(len, under.values())) <= JUDGES:
        raise ValueError(f"{path}: a load with fewer than {JUDGES + 1} specimens: none is left to fit or to judge")
    return {specimen for specimens in under.values() for specimen in specimens[-JUDGES:]}


def checked(path: Path, line: int, row: dict[str, str]) -> list[str]:
    """Return the cells of a row. Raises ValueError with file and line at a cell that is no number above 0."""
    for name in NUMBERS:
        try:
            math.log10(float(row[name]))
        except (TypeError, ValueError):
            raise ValueError(f"{path}:{line}: {name.split()[0]} '{row[name]}' is no number above 0") from None
    return [row[name] for name in NUMBERS]


def main(arguments: list[str]) -> int:
    """Write both files into this folder; 2 and one sentence where that cannot be done."""
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
    for name, table in tables.items():
        with Path(name).open("w", encoding="utf-8", newline="") as lines:
            csv.writer(lines, lineterminator="\n").writerows(table)
        sys.stdout.write(f"wrote {name}: {len(table) - 1} rows\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
