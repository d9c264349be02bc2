"""How benchmarks measure: the least time of several rounds, taken in turn, and the memory of a process of its own."""

import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

ROUNDS = 3


def least(*works: Callable[[], object], rounds: int = ROUNDS) -> list[float]:
    """Least processor time of each, s: one round after another, so that a busy machine slows all of them alike."""
    seconds = [float("inf")] * len(works)
    for _ in range(rounds):
        for place, work in enumerate(works):
            start = time.process_time()
            work()
            seconds[place] = min(seconds[place], time.process_time() - start)
    return seconds


def said_by_a_fresh_process(code: str, *arguments: str) -> str:
    """What a program prints that finds the modules of this one."""
    program = [sys.executable, "-c", f"import sys; sys.path[:0] = {sys.path!r}\n{code}", *arguments]
    return subprocess.run(program, check=True, capture_output=True, text=True).stdout


def peak_of_this_process() -> float:
    """Return the peak in MiB; that of ``getrusage`` would begin with the parent's (Linux only)."""
    status = Path("/proc/self/status").read_text()
    return next(int(line.split()[1]) / 1024 for line in status.splitlines() if line.startswith("VmHWM"))
