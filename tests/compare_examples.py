"""Do all shipped examples still give the same bytes? Run them with two states of the code, and compare.

``python tests/compare_examples.py write FOLDER [--tree CHECKOUT]`` runs every plugin's own example, with the quick
budgets of the gallery, and every ``calc run`` and ``calc diagnose`` of the example pages, with the code of a checkout
(this one, or another), and keeps what they wrote; ``python tests/compare_examples.py compare BEFORE AFTER`` names every
file that differs and how, and exits with 1 where one does. The examples are those of this checkout both times.
"""

from __future__ import annotations

import argparse
import difflib
import os
import shlex
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).parents[1]
KEPT = ("results.json", "diagnosis.json", "extended.toml", "inputs.toml")
"""What a run writes that depends on nothing but inputs, data, seed and versions."""
SHOWN = 12
"""So many lines of a difference are shown."""
Command = tuple[str, ...]


def gallery() -> Iterator[tuple[str, Path, list[Command]]]:
    """Give the plugins' own examples: name, the folder whose files they need, commands."""
    for name, sheet in tomllib.loads((ROOT / "docs" / "gallery" / "sheets.toml").read_text("utf-8")).items():
        if "data" not in sheet and "inputs" not in sheet:
            quick = [part for each in sheet.get("quick", ()) for part in ("--set", f"studies.{each}")]
            yield f"gallery/{name}", ROOT / "docs" / "gallery", [("run", sheet["plugin"], "-q", *quick)]


def pages() -> Iterator[tuple[str, Path, list[Command]]]:
    """Give the example pages: name, folder, the commands that the page shows, in their order."""
    for page in sorted((ROOT / "docs" / "examples").glob("*/README.md")):
        lines = [line.removeprefix("$ ") for line in page.read_text("utf-8").splitlines()]
        wanted = [line for line in lines if line.startswith(("calc run ", "calc diagnose "))]
        if wanted:
            yield f"examples/{page.parent.name}", page.parent, [tuple(shlex.split(line)[1:]) for line in wanted]


def run(name: str, files: Path, commands: list[Command], tree: Path, kept: Path) -> str:
    """Run the commands of an example in a copy of its folder and keep what they wrote; return their exit codes."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tree / "kernel"), str(tree / "plugins")])}
    environment |= {"TERM": "dumb", "COLUMNS": "120", "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    with TemporaryDirectory() as folder:
        work = Path(folder) / "work"
        shutil.copytree(files, work, ignore=shutil.ignore_patterns("runs", "__pycache__"))
        codes = []
        for command in commands:
            program = [sys.executable, "-m", "truing", *command]
            done = subprocess.run(program, cwd=work, env=environment, capture_output=True, text=True, check=False)
            codes.append(f"{done.returncode}  calc {shlex.join(command)}")
        for file in sorted(work.rglob("*")):
            if file.name in KEPT and "runs" in file.relative_to(work).parts:
                place = kept / name / file.relative_to(work)
                place.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(file, place)
    (kept / name).mkdir(parents=True, exist_ok=True)
    (kept / name / "exit codes").write_text("\n".join(codes) + "\n", encoding="utf-8")
    return "\n".join(codes)


def write(folder: Path, tree: Path, only: str) -> None:
    """Run all examples whose name holds ``only`` and keep what they wrote."""
    wanted = [each for each in (*gallery(), *pages()) if only in each[0]]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for said in pool.map(lambda each: run(*each, tree, folder), wanted):
            print(said, flush=True)


def compare(before: Path, after: Path) -> int:
    """Print every file that is not the same in two folders; return how many there are."""
    names = {file.relative_to(root) for root in (before, after) for file in root.rglob("*") if file.is_file()}
    apart = 0
    for name in sorted(names):
        one, two = (root / name for root in (before, after))
        if not (one.exists() and two.exists()):
            print(f"only in {before if one.exists() else after}: {name}")
            apart += 1
        elif one.read_bytes() != two.read_bytes():
            lines = [file.read_text("utf-8").splitlines() for file in (one, two)]
            print(*list(difflib.unified_diff(*lines, str(one), str(two), n=0, lineterm=""))[:SHOWN], sep="\n")
            apart += 1
    print(f"{len(names)} files, {apart} of them not the same")
    return apart


def main() -> None:
    """Write or compare."""
    parser = argparse.ArgumentParser(description=__doc__)
    verbs = parser.add_subparsers(dest="verb", required=True)
    writing = verbs.add_parser("write")
    writing.add_argument("folder", type=Path)
    writing.add_argument("--tree", type=Path, default=ROOT)
    writing.add_argument("--only", default="")
    comparing = verbs.add_parser("compare")
    comparing.add_argument("before", type=Path)
    comparing.add_argument("after", type=Path)
    asked = parser.parse_args()
    if asked.verb == "write":
        write(asked.folder.resolve(), asked.tree.resolve(), asked.only)
    elif compare(asked.before, asked.after):
        sys.exit(1)


if __name__ == "__main__":
    main()
