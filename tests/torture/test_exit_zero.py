"""Exit 0 means that every check passed, whatever befalls the output: every verb, every stream, broken in every way."""

from __future__ import annotations

import os
import random
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from forked import End, Redirection, filled, forked, stop_serving, stop_watching

from truing.cli.app import app

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="needs os.fork, which Windows has not")

VERBS = {
    "run": "run bar.py",
    "run fails": "run bar.py --set load=13kN",
    "run fails, JSON": "run bar.py --set load=13kN --json",
    "run, cases": "run bar.py --cases rows.csv",
    "run fails, cases": "run bar.py --cases bad.csv",
    "run is refused": "run bar.py --set load=13m",
    "watch": "watch bar.py -i bar.toml",
    "watch fails": "watch bar.py -i bar.toml --set load=13kN",
    "verify": "verify bar.py",
    "verify differs": "verify wrong.py",
    "compare": "compare one one",
    "compare differs": "compare one two",
    "table": "table bar.py -i bar.toml --rows rows.csv",
    "diagnose": "diagnose bar.py --data measured.csv",
    "plan": "plan bar.py --causes heating,sensor_offset --noise stress=1MPa "
    '--set studies.diagnose.box={bar_temperature="20..80degC",load="2..11kN"}',
    "sweep": "sweep bar.py load 2..12kN",
    "describe": "describe bar.py",
    "explain": "explain bar.py stress",
    "init": "init bar.py",
    "index": "index .",
    "serve": "serve . --no-browser",
    "plugins": "plugins --names",
    "new": "new mine",
    "completion": "completion bash",
    "version": "--version",
    "help": "run --help",
    "usage": "run --nonsense",
}
FAILING = {
    "run fails": 1, "run fails, JSON": 1, "run fails, cases": 1, "run is refused": 2, "watch fails": 1,
    "verify differs": 1, "compare differs": 1, "usage": 2,
}  # fmt: skip
SILENT = {"run is refused", "new", "usage"}
"""Print no results."""
TYPER = {"help", "usage"}
"""Are printed by typer, which ends with 1 where the reader of its help has gone."""
CANNOT = "the results cannot be written to the output"


def _pipe_without_reader() -> int:
    reader, writer = os.pipe()
    os.close(reader)
    return writer


def _full() -> int:
    return os.open("/dev/full", os.O_WRONLY)


def _read_only() -> int:
    return os.open(os.devnull, os.O_RDONLY)


BROKEN: dict[str | None, Redirection] = {
    "closed": lambda: None,
    "pipe without reader": _pipe_without_reader,
    "full": _full,
    "read-only": _read_only,
}
CANNOT_BE_WRITTEN = {"full", "read-only"}


@pytest.fixture(scope="module")
def prepared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with everything that the verbs read; what they need is imported here, once."""
    folder = filled(
        tmp_path_factory.mktemp("verbs"),
        "run bar.py -o one",
        "run bar.py -o two --set load=9kN",
        "diagnose bar.py --data measured.csv -o warm",
    )
    shutil.rmtree(folder / "warm")
    text = (folder / "bar.py").read_text(encoding="utf-8")
    (folder / "wrong.py").write_text(text.replace("value=100.0", "value=90.0"), encoding="utf-8")
    (folder / "bad.csv").write_text("load [kN]\n9\n13\n")
    return folder


@pytest.fixture
def place(prepared: Path, tmp_path: Path) -> Path:
    """A copy of it for one test."""
    return Path(shutil.copytree(prepared, tmp_path / "place"))


def ended(
    verb: str,
    place: Path,
    *,
    stdout: Redirection | None = None,
    stderr: Redirection | None = None,
    encoding: str = "utf-8",
) -> End:
    """Run a verb; a watch or a server, which goes on until somebody ends it, is interrupted once it has begun."""
    ends: dict[str, Callable[[], object]] = {"watch": stop_watching, "serve": stop_serving}
    before = ends.get(verb.partition(" ")[0], lambda: None)
    return forked(VERBS[verb].split(), place, stdout=stdout, stderr=stderr, encoding=encoding, before=before)


def test_every_verb_is_here() -> None:
    names = {command.name for command in app.registered_commands}
    assert names == {words.split()[0] for words in VERBS.values()} & names
    assert set(FAILING) | SILENT <= set(VERBS)


WAYS = [(on_stdout, on_stderr) for on_stdout in (None, *BROKEN) for on_stderr in (None, *BROKEN)]


@pytest.mark.parametrize("verb", VERBS)
def test_the_exit_code_is_the_calculations(place: Path, verb: str, full_torture: bool) -> None:
    """All ways to break the two streams, and two encodings that are not UTF-8; of modest size one way for each verb."""
    if verb == "diagnose" and not full_torture:
        pytest.skip("the longest of all; at full size only")
    ways = WAYS if full_torture else [random.Random(verb).choice(WAYS[1:])]
    for on_stdout, on_stderr in ways:
        end = ended(verb, _anew(place), stdout=BROKEN.get(on_stdout), stderr=BROKEN.get(on_stderr))
        unwritten = on_stdout in CANNOT_BE_WRITTEN and verb not in SILENT
        code = FAILING.get(verb, 0) or (2 if unwritten else 0)
        assert end.code == code or (verb in TYPER and end.code), (on_stdout, on_stderr, end)
        assert "Traceback" not in end.err, (on_stdout, on_stderr, end)
        if on_stdout is None:
            assert bool(end.out) == (verb not in SILENT), (on_stdout, on_stderr, end)
        if on_stderr is None and verb not in TYPER:
            assert (CANNOT in end.err) == unwritten, (on_stdout, on_stderr, end)
    for encoding in ("ascii", "cp437") if full_torture else ():
        assert ended(verb, _anew(place), encoding=encoding).code == FAILING.get(verb, 0)


def _anew(place: Path) -> Path:
    """Take away what an earlier run of the verb has left."""
    for left in (place / "runs", place / "mine"):
        if left.exists():
            shutil.rmtree(left)
    return place
