"""calc watch: the sheet follows what is saved; what is wrong is said and the last sheet stays."""

from __future__ import annotations

import os
import re
import shutil
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from gated import wait_until

from shared import Calc
from truing.watching import PATIENCE, WatchedFiles
from warm import LONGEST, Running

PIN = Path(__file__).parents[1] / "data" / "pin_wear.py"
INPUTS = '[inputs]\nload = "120 N"\n[studies]\nrun = ["reliability"]\n'


def saved(file: Path, text: str, *, by_renaming: bool = False) -> None:
    """Save a file as editors do: in its place, or beside it and then renamed."""
    place = file.with_name(f".{file.name}.new") if by_renaming else file
    place.write_text(text, encoding="utf-8")
    if by_renaming:
        os.replace(place, file)


class Watching:
    """A running ``calc watch`` whose lines are read one by one."""

    def __init__(self, folder: Path, *words: str, path: str = "") -> None:
        command = ["-m", "truing", "watch", *words, "--every", "0.05"]
        self.process = Running(command, folder, {"PYTHONPATH": path}, together=True)
        self.read = 0

    def says(self, pattern: str) -> str:
        """Wait for a line with this pattern and return it."""
        shown: list[str] = []

        def is_said() -> bool:
            has_ended = self.process.poll() is not None
            lines = self.process.said[0].split("\n")[self.read : -1]
            shown[:] = [line for line in lines if re.search(pattern, line)][:1]
            self.read += lines.index(shown[0]) + 1 if shown else 0
            assert shown or not has_ended, lines
            return bool(shown)

        wait_until(is_said, f"a line with {pattern!r}")
        return shown[0]

    def interrupted(self) -> int:
        """Press Ctrl-C and return the exit code."""
        self.process.signal(signal.SIGINT)
        return self.process.ended().code


@contextmanager
def watching(folder: Path, *words: str, path: str = "") -> Iterator[Watching]:
    made = Watching(folder, *words, path=path)
    try:
        yield made
    finally:
        if made.process.poll() is None:
            made.process.signal(signal.SIGKILL)


@pytest.mark.skipif(sys.platform == "win32", reason="a console signal there stops the test too")
def test_the_sheet_follows_inputs_and_code_and_survives_mistakes(tmp_path: Path) -> None:
    code = shutil.copy(PIN, tmp_path / "pin.py")
    inputs = tmp_path / "pin.toml"
    saved(inputs, INPUTS)
    results = tmp_path / "runs" / "pin" / "results.json"
    with watching(tmp_path, "./pin.py", "--inputs", "pin.toml") as watch:
        assert watch.says(r"^\d\d:\d\d:\d\d \d+\.\d s .*; sheet: runs.pin.sheet\.html$")
        saved(inputs, INPUTS.replace("120 N", "150 N"), by_renaming=True)
        assert "pressure +25 %" in watch.says("pressure")
        before = results.read_bytes()
        saved(inputs, INPUTS.replace("120 N", "150 mm"))
        assert watch.says("pin.toml:2: load: '150 mm' is a length")
        assert watch.says("not calculated; the sheet of .* stays")
        assert results.read_bytes() == before
        text = PIN.read_text(encoding="utf-8")
        saved(code, text.replace("pressure = pin.load / pin.area", "pressure = pin.load / (pin.area"))
        assert watch.says(r"pin\.py:\d+: .*'\(' was never closed")
        saved(inputs, INPUTS.replace("120 N", "150 N"))
        saved(code, text.replace("pressure = pin.load / pin.area", "pressure = 2 * pin.load / pin.area"))
        assert "pressure +100 %" in watch.says("pressure")
        assert watch.interrupted() == 0
        assert watch.says("calc: watched 3 runs; the sheet of .* stays")


@pytest.mark.skipif(sys.platform == "win32", reason="a console signal there stops the test too")
def test_a_diagnosis_follows_its_measured_rows(tmp_path: Path) -> None:
    shutil.copy(PIN, tmp_path / "pin.py")
    saved(tmp_path / "pin.toml", '[inputs]\nload = "120 N"\n')
    depth = 3e-8 * (120 / 28e-6) * 0.5 * 3600 / 2.1e9 * 1e6  # Archard, um per hour
    scatter = (0.1, -0.2, 0.15, -0.05, 0.2, -0.1, 0.05, -0.15, 0.1, -0.05)
    times = [20.0 * row for row in range(1, 11)]
    rows = [f"{time},{depth * time + off:.3f}" for time, off in zip(times, scatter, strict=True)]
    late = [f"{time},{depth * time + off + 900 * (time > 100):.3f}" for time, off in zip(times, scatter, strict=True)]
    measured = tmp_path / "m.csv"
    saved(measured, "\n".join(["time [h],depth [um]", *rows]))
    with watching(tmp_path, "./pin.py", "--inputs", "pin.toml", "--data", "m.csv") as watch:
        assert watch.says(r"Nothing found\. .*; sheet: runs.m.sheet\.html$")
        saved(measured, "\n".join(["time [h],depth [um]", *late]))
        assert watch.says(r"^\S+ \S+ s step new, .*; Cause named\. .*step")
        saved(measured, "\n".join(["time [h],depth [N]", *late]))
        assert watch.says(r"m\.csv:1: column 'depth \[N\]': 'N' is a force")
        assert watch.says("not calculated; the sheet of .* stays")
        assert watch.interrupted() == 1
        assert watch.says("calc: watched 2 diagnoses; the sheet of .* stays")


@pytest.mark.skipif(sys.platform == "win32", reason="a console signal there stops the test too")
def test_data_files_and_the_files_of_an_installed_package_are_watched(tmp_path: Path) -> None:
    name, text = "worn_surface", PIN.with_name("worn_surface.py").read_text(encoding="utf-8")
    home, described = tmp_path / "site" / name, tmp_path / "site" / f"{name}-1.0.dist-info"
    home.mkdir(parents=True)
    described.mkdir()
    saved(home / "__init__.py", f"from {name}.law import truing_models as truing_models\n")
    saved(home / "law.py", text)
    saved(described / "METADATA", f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    saved(described / "entry_points.txt", f"[truing.plugins]\n{name} = {name}\n")
    saved(tmp_path / "depths.txt", "1\n2\n3\n")
    saved(tmp_path / "worn.toml", '[inputs]\nsurface = "depths.txt"\n')
    with watching(tmp_path, name, "--inputs", "worn.toml", "-o", "out", path=str(tmp_path / "site")) as watch:
        assert watch.says(r"no checks; sheet: out.sheet\.html$")
        saved(tmp_path / "depths.txt", "2\n4\n6\n", by_renaming=True)
        assert watch.says(r"share -50 %; no checks")
        saved(home / "law.py", text.replace("share=given_.load", "share=2 * given_.load"))
        assert watch.says(r"share \+100 %; no checks")
        assert watch.interrupted() == 0


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["no_such_plugin", "--inputs", "pin.toml"], "calc: no plugin offers 'no_such_plugin'."),
        ([PIN, "--inputs", "pim.toml"], "pim.toml: no such file. Did you mean 'pin.toml'?"),
        ([PIN, "--inputs", "pin.toml", "--data", "n.csv"], "n.csv: no such file"),
        (
            [PIN, "--inputs", "pin.toml", "--data", "pin.toml", "--workers", "2"],
            "calc: --cases, --excel and --workers are",
        ),
        ([PIN, "--inputs", "pin.toml", "-o", "other"], "calc: other: is an existing folder but no run of ours"),
    ],
)
def test_what_can_never_run_ends_at_once(calc: Calc, tmp_path: Path, words: list[Any], sentence: str) -> None:
    saved(tmp_path / "pin.toml", INPUTS)
    (tmp_path / "other").mkdir()
    saved(tmp_path / "other" / "letter.txt", "mine")
    answer = calc("watch", *words)
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.startswith(sentence)
    assert answer.err.count("\n") == 1


@contextmanager
def editor(*savings: Callable[[], object]) -> Iterator[None]:
    """Edit files in the background, a moment between two savings, until all are done."""

    def edit() -> None:
        for saving in savings:
            time.sleep(0.25)
            saving()

    hand = threading.Thread(target=edit)
    hand.start()
    yield
    hand.join(LONGEST)


def watched(*files: Path) -> WatchedFiles:
    made = WatchedFiles(0.05)
    made.add(files)
    return made


def test_a_half_written_file_is_waited_for(tmp_path: Path) -> None:
    file = tmp_path / "pin.toml"
    saved(file, "load = 1")
    files = watched(file)
    with editor(lambda: saved(file, ""), lambda: saved(file, "load = 2")):
        assert files.changed() == [file]
        assert file.read_text() == "load = 2"


def test_a_file_that_is_taken_away_for_good_has_changed(tmp_path: Path) -> None:
    file = tmp_path / "pin.toml"
    saved(file, "load = 1")
    files, begin = watched(file), time.monotonic()
    with editor(file.unlink):
        assert files.changed() == [file]
    assert time.monotonic() - begin >= PATIENCE


def test_the_same_content_is_no_change(tmp_path: Path) -> None:
    file, other = tmp_path / "pin.toml", tmp_path / "new.csv"
    saved(file, "load = 1")
    files = watched(file, other)
    with editor(lambda: os.utime(file), lambda: saved(file, "load = 1"), lambda: saved(other, "1")):
        assert files.changed() == [other]


def test_what_changed_during_a_run_is_not_missed(tmp_path: Path) -> None:
    """Behind a link too, and in a folder that was not there."""
    real, file, late = tmp_path / "kept" / "pin.toml", tmp_path / "pin.toml", tmp_path / "data" / "new.csv"
    real.parent.mkdir()
    saved(real, "load = 1")
    file.symlink_to(real)
    files = watched(file, late)
    saved(real, "load = 2")
    assert files.changed() == [file]
    with editor(late.parent.mkdir, lambda: saved(late, "1")):
        assert files.changed() == [late]
    with editor(lambda: saved(real, "load = 3")):
        assert files.changed() == [file]
