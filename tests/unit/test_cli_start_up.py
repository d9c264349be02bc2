"""What the command line costs before it works: help and names import nothing heavy, a run what it needs."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from truing.cli.console import out, out_json, say

# typer brings pydantic, whatever is imported here
HEAVY = {
    "numpy",
    "scipy",
    "pint",
    "matplotlib",
    "jinja2",
    "sklearn",
    "pymoo",
    "press_linkage",
    "pluggy",
    "tomlkit",
    "openpyxl",
    "starlette",
    "uvicorn",
    "multiprocessing",
}
NOT_FOR_A_RUN = {
    "pint", "dask", "narwhals", "rich", "tomlkit", "sklearn", "pymoo", "openpyxl", "docx", "pypdf",
    "scipy.fft", "scipy.integrate", "scipy.interpolate", "scipy.ndimage", "scipy.optimize", "scipy.sparse",
    "scipy.stats",
    "truing.describe", "truing.diagnosis", "truing.gauge", "truing.experiments.planning", "truing.api.differences",
    "truing.api.findings", "truing.report.comparison_page", "truing.report.diagnosis_sheet", "truing.runs.comparison",
    "truing.runs.diagnosis_files", "truing.runs.index",
}  # fmt: skip
"""What other verbs need, and studies that this run does not have."""
PROBE = """
import json, sys
from truing.cli import main
code = main(sys.argv[1:])
sys.stdout.flush()
print(json.dumps([code, sorted(sys.modules)]), file=sys.stderr)
"""


def imported(*arguments: str) -> tuple[int, set[str], str]:
    """Run ``calc`` in a fresh process and return exit code, modules imported, and what it printed."""
    done = subprocess.run([sys.executable, "-c", PROBE, *arguments], capture_output=True, text=True, check=True)
    code, names = json.loads(done.stderr.rstrip("\n").split("\n")[-1])
    return code, set(names), done.stdout


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--help"], "Commands:"),
        (["run", "--help"], "--set NAME=VALUE"),
        (["serve", "--help"], "--no-browser"),
        (["--version"], "truing "),
        (["plugins", "--names"], "press_linkage\n"),
        (["--names", "plugins"], None),
    ],
)
def test_nothing_heavy_is_imported(arguments: list[str], words: str | None) -> None:
    code, names, out = imported(*arguments)
    assert code == (0 if words else 2)
    assert (words or "") in out
    assert names & HEAVY == set()
    assert "typer" in names


def test_the_probe_sees_what_is_imported() -> None:
    code, names, _ = imported("describe", str(Path(__file__).parents[1] / "data" / "pin_wear.py"))
    assert code == 0
    assert {"numpy", "pluggy", "jinja2"} <= names


def test_a_run_imports_what_it_needs(tmp_path: Path) -> None:
    """Also where other plugins are installed, which would need more."""
    plugin = Path(__file__).parents[1] / "data" / "pin_wear.py"
    code, names, _ = imported("run", str(plugin), "--output", str(tmp_path / "pin"))
    assert code == 0
    assert {"press_linkage", "matplotlib.figure", "scipy.special", "truing.studies.reliability"} <= names
    assert names & NOT_FOR_A_RUN == set()


# What is printed: a terminal shows it and obeys none of it.

ORDERS = "\x1b[31mred\x1b[0m\x07 \x9b2J \u202egnp.exe\rover"
SHOWN = "?[31mred?[0m? ?2J ?gnp.exe?over"


def test_a_terminal_is_given_no_orders(capsys):
    for write in (out, say):
        write(f"column '{ORDERS}'\nnext line\tµm")
        assert "".join(capsys.readouterr()) == f"column '{SHOWN}'\nnext line\tµm\n"


def test_a_document_reads_back_as_it_was(capsys):
    out_json({"name": ORDERS, "unit": "µm"})
    printed = capsys.readouterr().out
    assert json.loads(printed) == {"name": ORDERS, "unit": "µm"}
    assert not set(printed) & set("\x1b\x07\x9b\u202e\r")
