"""A calculation that finishes six batches, then waits at a gate: a test can end whoever computes it in the middle."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from own_pins import write_pin

from warm import FORKED_WORKERS, LONGEST, Running

FREE, ROWS, BATCHES = 6, 1024, 24
HEAD = 'CALLS, OPEN = Path(__file__).with_name("calls"), Path(__file__).with_name("open")'
GATE = f"""
if np.shape(pin.load) == ({ROWS},):
    with CALLS.open("ab", buffering=0) as calls:
        calls.write(b"%12d" % os.getpid())
    while CALLS.stat().st_size > 12 * {FREE} and not OPEN.exists():
        time.sleep(0.01)
"""
"""Let some batches pass, and the others when the gate is opened."""


def wait_until(holds: Callable[[], Any], what: str) -> None:
    """Poll until something holds."""
    until = time.monotonic() + LONGEST
    while not holds():
        assert time.monotonic() < until, f"not within {LONGEST:.0f} s: {what}"
        time.sleep(0.02)


@dataclass(frozen=True)
class Gated:
    """The calculation in a folder of its own: how it is run, how often it was asked for a batch, and its gate."""

    folder: Path

    @classmethod
    def in_folder(cls, folder: Path) -> Gated:
        write_pin(folder, "gated_pin", head=HEAD, body=GATE, more="sheet=[]")
        return cls(folder)

    @property
    def words(self) -> tuple[str, ...]:
        options = ['studies.run=["reliability"]', f"studies.reliability.batch={ROWS}"]
        options.append(f"studies.reliability.draws={ROWS * BATCHES}")
        return ("run", str(self.folder / "gated_pin.py"), *(word for text in options for word in ("--set", text)))

    @property
    def callers(self) -> list[int]:
        """Return the process of each batch that was begun, in their order."""
        file = self.folder / "calls"
        return [int(number) for number in file.read_bytes().split()] if file.exists() else []

    @property
    def calls(self) -> int:
        return len(self.callers)

    def kept(self, run: str) -> int:
        """How many batches are kept beside a run folder."""
        log = self.folder / f"{run}.partial" / "batches.log"
        return log.read_bytes().count(b"TRB2") if log.exists() else 0

    @property
    def left(self) -> list[str]:
        """Return what lies in the folder beside the calculation."""
        own = {"pin_wear.py", "gated_pin.py", "calls", "open", "__pycache__"}
        return sorted(path.name for path in self.folder.iterdir() if path.name not in own)

    def open(self) -> None:
        (self.folder / "open").touch()

    def start(self, *more: str, forked: bool = True) -> Running:
        """Run it; its workers start afresh, or are ``forked``: the sooner done, but they end as their parent does."""
        return Running(["-m", "truing", *self.words, *more], self.folder, {FORKED_WORKERS: ""} if forked else {})

    def at_the_gate(self, process: Running, calls: int) -> None:
        """Wait until so many batches were begun."""
        wait_until(lambda: process.poll() is not None or self.calls >= calls, f"{calls} batches are begun")
        assert process.poll() is None, process.said


def run_of(folder: Path) -> dict[str, Any]:
    """Return run.json."""
    found: dict[str, Any] = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    return found
