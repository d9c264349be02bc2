"""A bar for work that takes its time: on a terminal, after two seconds, with the time left; nowhere else."""

from __future__ import annotations

import io
import os
import re
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest
from own_pins import write_pin

from shared import Calc
from truing import progress
from truing.progress import Task, has_terminal, shown_progress, spoken
from truing.studies.bench import part_of, within

PATIENT = """
@dataclass(frozen=True)
class Heard:
    def as_json(self): return {}
    def blocks(self): return ()
    def checks(self): return ()
    def warnings(self): return ()


@dataclass(frozen=True, kw_only=True)
class Patient:
    steps: int = 12
    pause: float = 0.3
    name: str = "patient"
    gives: None = None

    def run(self, bench):
        for step in range(self.steps):
            bench.progress(self.name, step, self.steps)
            time.sleep(self.pause)
        return Heard()
"""


def write_slow(folder: Path) -> None:
    """Write a pin with one study, of twelve steps that take 0.3 s."""
    write_pin(folder, "slow", head=PATIENT, more="objectives=[], studies=[Patient()], sheet=[]")


class Terminal(io.StringIO):
    """A terminal that remembers what it is given."""

    def isatty(self) -> bool:
        return True


def on_terminal(monkeypatch: pytest.MonkeyPatch, patience: float = 0.05) -> Terminal:
    """Let the errors of this process go to a terminal, with so much patience."""
    made = Terminal()
    monkeypatch.setattr(sys, "stderr", made)
    monkeypatch.setattr(progress, "PATIENCE", patience)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "90")
    monkeypatch.delenv("NO_COLOR", raising=False)
    return made


@pytest.mark.parametrize(
    ("elapsed", "first", "done", "total", "left"),
    [
        (30.0, 0, 1, 4, 90.0),  # a quarter in half a minute
        (30.0, 0, 3, 4, 10.0),
        (60.0, 0, 3, 4, 20.0),  # a step that takes long lengthens what is left
        (100.0, 0, 0, 4, None),  # nothing is known
        (100.0, 0, 1, 1000, None),  # next to nothing is
        (0.5, 0, 1, 2, None),  # too soon to say
        (10.0, 0, 4, 4, 0.0),
        (10.0, 0, 5, 4, 0.0),  # whoever counts too far is done
        (10.0, 0, 1, 0, None),
        (10.0, 2, 3, 4, 10.0),  # half was done at once, a quarter took ten seconds: so will the last quarter
        (10.0, 3, 3, 4, None),
    ],
)
def test_time_left_is_that_of_the_pace_since_one_heard_of_the_task(
    elapsed: float, first: int, done: int, total: int, left: float | None
) -> None:
    found = Task("work", 5.0, done, total, first=first).left(5.0 + elapsed)
    assert found == (None if left is None else pytest.approx(left))


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (0.2, "1 s"),
        (7.4, "7 s"),
        (33.0, "35 s"),
        (59.0, "60 s"),
        (150.0, "2 min"),
        (3500.0, "58 min"),
        (5000.0, "1 h 20 min"),
    ],
)
def test_a_duration_is_as_exact_as_it_is_known(seconds: float, words: str) -> None:
    assert spoken(seconds) == words


def test_work_that_takes_its_time_is_shown_and_leaves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = on_terminal(monkeypatch)
    with shown_progress() as report:
        report("reliability", 1, 4)
        time.sleep(0.35)
        report("reliability", 3, 4)
        time.sleep(0.35)
    shown = terminal.getvalue()
    assert "reliability" in shown
    assert "25 %" in shown
    assert "75 %" in shown
    assert " s left" in shown
    assert shown.rindex("\x1b[2K") > shown.rindex("reliability")  # the line is taken away


def test_short_work_shows_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = on_terminal(monkeypatch, patience=1.0)
    with shown_progress() as report:
        report("sweep", 1, 2)
    time.sleep(0.1)
    assert terminal.getvalue() == ""


def test_an_error_takes_the_line_away(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = on_terminal(monkeypatch)
    with suppress(KeyboardInterrupt), shown_progress() as report:
        report("sweep", 1, 2)
        time.sleep(0.3)
        raise KeyboardInterrupt
    shown = terminal.getvalue()
    assert shown.rindex("\x1b[2K") > shown.rindex("sweep")
    assert shown.rindex("\x1b[?25h") > shown.rindex("\x1b[?25l")  # the cursor is there again


@pytest.mark.parametrize(("name", "value"), [("TERM", "dumb"), ("NO_COLOR", "1")])
def test_plain_terminals_show_none(monkeypatch: pytest.MonkeyPatch, name: str, value: str) -> None:
    on_terminal(monkeypatch)
    assert has_terminal()
    monkeypatch.setenv(name, value)
    assert not has_terminal()


def test_nothing_goes_to_a_pipe(calc: Calc, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(progress, "PATIENCE", 0.0)
    write_slow(tmp_path)
    answer = calc("run", "slow.py", "--set", "studies.patient.pause=0.02")
    assert (answer.code, answer.err) == (
        0,
        "no --inputs: running the shipped example (calc init slow.py writes it to a file)\n",
    )


@pytest.mark.skipif(os.name == "nt", reason="a terminal of another kind")
def test_a_real_terminal(tmp_path: Path) -> None:
    """Twelve steps of 0.3 s: silence for two seconds, then the bar with what is left, then the results."""
    write_slow(tmp_path)
    heard = on_a_terminal([sys.executable, "-m", "truing", "run", "slow.py", "-v"], tmp_path)
    text = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", "".join(part for _, part in heard))
    begin = next(when for when, part in heard if "no --inputs" in part)
    first = next(when for when, part in heard if "patient" in part)
    assert first - begin > 1.8
    shares = [int(share) for share in re.findall(r"(\d+) %", text)]
    assert shares == sorted(shares)
    assert 50 <= shares[0] < shares[-1] < 100
    assert re.search(r"patient \S+ +75 % 1 s left", text)
    assert text.rindex("sheet: ") > text.rindex(" s left")


def on_a_terminal(command: list[str], folder: Path) -> list[tuple[float, str]]:
    """Run a command on a terminal of its own; return what it shows, and when."""
    import pty

    child, terminal = pty.fork()
    if child == 0:
        os.chdir(folder)
        environment = {name: value for name, value in os.environ.items() if name != "NO_COLOR"}
        os.execve(command[0], command, {**environment, "TERM": "xterm", "COLUMNS": "90", "PYTHONUTF8": "1"})
    heard: list[tuple[float, str]] = []
    while True:
        try:
            part = os.read(terminal, 65536)
        except OSError:
            break
        if not part:
            break
        heard.append((time.monotonic(), part.decode("utf-8", errors="replace")))
    os.close(terminal)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    return heard


# Parts of a whole


def test_parts_of_a_task_lie_one_behind_the_other() -> None:
    said: list[tuple[str, int]] = []

    def note(task: str, done: int, _: int) -> None:
        said.append((task, done))

    part_of(note, "surrogate", 0.2, 0.3)(1, 2)
    part_of(note, "surrogate", 0.2, 0.3)(0, 0)
    inner = within(note, "cases", 0.5, 0.75, ["sweep", "reliability"])
    for task, done in (("sweep", 1), ("reliability", 2), ("nobody", 1), ("reliability", 1)):  # it never goes back
        inner(task, done, 2)
    assert said == [("surrogate", 250), ("surrogate", 200), ("cases", 562), ("cases", 750), ("cases", 750)]
