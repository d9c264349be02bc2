"""Ctrl-C in the middle of a long calculation: exit 130, and everything is as it was before."""

from __future__ import annotations

import signal
import sys
import time
from pathlib import Path

import pytest
from gated import FREE, Gated, wait_until
from own_pins import write_pin

from shared import Answer, Calc
from warm import Running

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="a console signal there stops the test too")

SEES_CHILDREN = Path("/proc/self/task").exists()


def children_of(process: int) -> list[int]:
    """Return the processes that a process has started, theirs included."""
    found: list[int] = []
    for task in Path(f"/proc/{process}/task").iterdir():
        for child in (task / "children").read_text().split():
            found += [int(child), *children_of(int(child))]
    return found


def is_alive(process: int) -> bool:
    """Tell whether a process still runs; one that only waits to be counted does not."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def interrupted(process: Running, by: int = signal.SIGINT) -> tuple[Answer, list[int]]:
    """Signal to all processes of a command as a terminal does; return what it answers, and what it had started."""
    assert process.poll() is None, process.said
    children = children_of(process.pid) if SEES_CHILDREN else []
    process.signal(by)
    return process.ended(), children


def test_an_interrupted_run_leaves_the_earlier_one_as_it_was(calc: Calc, tmp_path: Path) -> None:
    pin = Gated.in_folder(tmp_path)
    assert calc(*pin.words, "--set", "studies.run=[]", "-q").code == 1  # its limit stays undecided
    folder = tmp_path / "runs" / "gated_pin"
    before = [(path.name, path.read_bytes()) for path in sorted(folder.iterdir())]
    process = pin.start("-q")
    pin.at_the_gate(process, FREE + 1)
    end, _ = interrupted(process)
    assert end.code == 130
    assert [(path.name, path.read_bytes()) for path in sorted(folder.iterdir())] == before
    assert [path.name for path in folder.parent.iterdir()] == ["gated_pin"]


@pytest.mark.parametrize("by", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_run_leaves_no_worker_behind(tmp_path: Path, by: int) -> None:
    """Nor a word of one, while they start (the first) and while they work."""
    pin = Gated.in_folder(tmp_path)
    process = pin.start("-q", "--workers", "2", "-o", "new/run", forked=False)
    if by == signal.SIGINT and SEES_CHILDREN:
        wait_until(lambda: process.poll() is not None or len(children_of(process.pid)) >= 2, "two workers start")
        time.sleep(0.1)
    else:
        pin.at_the_gate(process, FREE + 2)
    end, children = interrupted(process, by)
    assert end == Answer(130 if by == signal.SIGINT else 143, "", "calc: interrupted; nothing was written\n")
    assert pin.left == []
    assert len(children) >= 2 or not SEES_CHILDREN
    wait_until(lambda: not any(map(is_alive, children)), "the workers end")


SIGNALLED = """
class Signalled:
    def __del__(self) -> None:
        os.kill(os.getpid(), signal.SIGINT)
        for _ in range(1000):
            pass
"""


def test_an_interrupt_during_a_finalizer_is_not_lost(tmp_path: Path) -> None:
    """Python drops what is raised in a finalizer; this one sends the signal to its own process."""
    slow = write_pin(tmp_path, head=SIGNALLED, body="Signalled()\ntime.sleep(60)")
    ended = Running(["-m", "truing", "run", slow, "-q"], tmp_path).ended()
    assert ended == Answer(130, "", "calc: interrupted; nothing was written\n")


IN_A_FIT = """
import os, pathlib, signal, sys, time
from truing.cli import main
from truing.diagnosis import exact

settle, taken = exact.Fitting.settle, exact.Fitting._taken
stamps = []

def settled(state, until):
    state.is_exact = until <= exact.EXACTLY
    return settle(state, until)

def stepped(state, moved):
    if state.is_exact and state.causes and not stamps:
        stamps.append(time.process_time())
        os.kill(os.getpid(), signal.SIGINT)
    return taken(state, moved)

exact.Fitting.settle, exact.Fitting._taken = settled, stepped
told = pathlib.Path(sys.argv.pop())
try:
    code = main()
finally:
    told.write_text(str(time.process_time() - stamps[0]))
sys.exit(code)
"""


def test_a_diagnosis_ends_at_once_in_the_middle_of_an_exact_fit(tmp_path: Path) -> None:
    """Within a second of the processor's time, and nothing is written."""
    page = Path(__file__).parents[2] / "docs/examples/press_off_by_40_um"
    command = ["diagnose", "press_linkage", "--inputs", str(page / "inputs.toml"), "--data", str(page / "measured.csv")]
    work = tmp_path / "work"
    work.mkdir()
    end = Running(["-c", IN_A_FIT, *command, "-q", tmp_path / "taken"], work).ended()
    assert end == Answer(130, "", "calc: interrupted; nothing was written\n")
    assert list(work.iterdir()) == []
    assert float((tmp_path / "taken").read_text()) < 1.0
