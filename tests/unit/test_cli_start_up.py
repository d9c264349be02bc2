"""What the command line costs before it works: help and names import nothing heavy and no plugin."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

# typer brings pydantic, whatever is imported here
HEAVY = {"numpy", "scipy", "pint", "matplotlib", "jinja2", "sklearn", "pymoo", "press_linkage", "pluggy", "tomlkit"}
PROBE = """
import json, sys
from truing.cli import main
code = main(sys.argv[1:])
sys.stdout.flush()
print(json.dumps([code, sorted({name.partition(".")[0] for name in sys.modules})]), file=sys.stderr)
"""


def imported(*arguments: str) -> tuple[int, set[str], str]:
    """Run ``calc`` in a fresh process and return exit code, packages imported, and what it printed."""
    done = subprocess.run([sys.executable, "-c", PROBE, *arguments], capture_output=True, text=True, check=True)
    code, names = json.loads(done.stderr.rstrip("\n").split("\n")[-1])
    return code, set(names), done.stdout


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--help"], "Commands:"),
        (["run", "--help"], "--set NAME=VALUE"),
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
    code, names, _ = imported("plugins")
    assert code == 0
    assert {"press_linkage", "pluggy"} <= names


def test_importing_truing_costs_nothing() -> None:
    done = subprocess.run(
        [sys.executable, "-c", "import sys, truing; print(*sys.modules)"], capture_output=True, text=True, check=True
    )
    assert {name.partition(".")[0] for name in done.stdout.split()} & HEAVY == set()
