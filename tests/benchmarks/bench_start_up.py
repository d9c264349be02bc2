"""What do help, names and completion cost: against a bare typer program that does the same with as many commands.

Run it: ``python -m pytest tests/benchmarks/bench_start_up.py -s``. Both are started in turn, as
processes of their own; of the rounds the least processor time counts.
"""

import os
import resource
import subprocess
import sys
from pathlib import Path

import pytest

BARE = """
import importlib.metadata

import typer

app = typer.Typer(add_completion=False, pretty_exceptions_enable=False, rich_markup_mode=None)


def greet(name: str = typer.Argument("you", help="Whom to greet."), loud: bool = typer.Option(False, "--loud")) -> None:
    "Greet somebody."


for number in range(12):  # with the next one as many as there are verbs
    app.command(f"greet{number}")(greet)


@app.command()
def names(loud: bool = typer.Option(False, "--loud")) -> None:
    "List the plugins."
    for entry in importlib.metadata.entry_points(group="truing.plugins"):
        print(entry.name)


app()
"""
OURS = "import sys; from truing.cli import main; sys.exit(main())"
ROUNDS = 15
ALLOWED = 1.3
COMPLETING = {"_CALC_COMPLETE": "complete_bash", "_TYPER_COMPLETE_ARGS": "calc run pre"}
COMPLETING |= {"COMP_WORDS": "calc run pre", "COMP_CWORD": "2"}
ASKED: dict[str, tuple[str, list[str], dict[str, str]]] = {
    "help": ("--help", ["--help"], {}),
    "names": ("names", ["plugins", "--names"], {}),
    "completion": ("names", [], COMPLETING),
}


def processor_seconds(command: list[str], more: dict[str, str]) -> float:
    """Return what a process and nothing else has cost."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, capture_output=True, check=True, env={**os.environ, **more})
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert done.stdout
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


@pytest.mark.parametrize("asked", ASKED)
def test_the_door_costs_as_much_as_a_bare_typer_program(asked: str, tmp_path: Path) -> None:
    file = tmp_path / "bare.py"
    file.write_text(BARE, encoding="utf-8")
    of_bare, arguments, more = ASKED[asked]
    pairs = [
        (
            processor_seconds([sys.executable, str(file), of_bare], {}),
            processor_seconds([sys.executable, "-c", OURS, *arguments], more),
        )
        for _ in range(ROUNDS)
    ]
    bare, ours = (min(times) for times in zip(*pairs, strict=True))
    print(f"\n{asked}: {ours:.3f} s, bare typer {bare:.3f} s, ratio {ours / bare:.2f} (at most {ALLOWED})")
    assert ours <= ALLOWED * bare
