"""A progress bar for work that takes its time: on a terminal or in a notebook, after two seconds."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field
from typing import Any

from truing.heavy import ipython_display, rich
from truing.studies.bench import Progress, silent

PATIENCE = 2.0
"""Seconds that pass before anything is shown: short work shows nothing."""
SETTLED = 0.02
"""The share of a task that must be done before its time left is guessed."""
REFRESH = 0.25
"""Seconds between two drawings in a notebook."""


def has_terminal() -> bool:
    """Whether errors go to a terminal that can redraw a line, and nobody has asked it to be plain."""
    return sys.stderr.isatty() and os.environ.get("TERM") != "dumb" and not os.environ.get("NO_COLOR")


def in_notebook() -> bool:
    """Whether this process is the kernel of a notebook."""
    shell: Any = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return type(shell).__name__ == "ZMQInteractiveShell"


@dataclass
class Task:
    """The work under way: what it is called, how much of it is done, and when one first heard how much."""

    name: str
    began: float
    done: int = 0
    total: int = 0
    first: int = 0

    @property
    def share(self) -> float:
        """The share that is done, 0 to 1; 0 where nobody knows."""
        return self._share_of(self.done)

    def _share_of(self, steps: int) -> float:
        return min(max(steps / self.total, 0.0), 1.0) if self.total > 0 else 0.0

    def left(self, now: float) -> float | None:
        """Return the seconds left at the pace so far, or None where that would be a guess in the dark.

        The pace is that since one first heard of the task, which may have come some way before; it is that up to now,
        so that a long step lengthens what is left while it lasts.
        """
        gone = self.share - self._share_of(self.first)
        if gone < SETTLED or now - self.began < PATIENCE / 2:
            return None
        return (now - self.began) * (1 - self.share) / gone


def spoken(seconds: float) -> str:
    """Return a duration as one says it: no more exact than it is known."""
    if seconds < 10:
        return f"{max(seconds, 1):.0f} s"
    if seconds < 60:
        return f"{round(seconds / 5) * 5} s"
    if seconds < 3600:
        return f"{round(seconds / 60)} min"
    return f"{int(seconds // 3600)} h {round(seconds % 3600 / 600) * 10} min"


class NotebookLine:
    """A line in a notebook: an output that is drawn anew until it is emptied. rich draws it as HTML."""

    def __init__(self, drawn: Callable[[], Any]) -> None:
        self._drawn = drawn
        self._handle: Any = None
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._refresh, daemon=True)

    def start(self) -> None:
        """Show the line and keep it up to date."""
        self._handle = ipython_display.display(self._drawn(), display_id=True)
        self._thread.start()

    def stop(self) -> None:
        """Empty the output."""
        self._over.set()
        self._thread.join()
        self._handle.update({"text/plain": ""}, raw=True)

    def _refresh(self) -> None:
        while not self._over.wait(REFRESH):
            self._handle.update(self._drawn())


@dataclass
class Tasks:
    """The tasks of a command as they are reported, from whichever thread, and the line that shows the present one."""

    task: Task = field(default_factory=lambda: Task("working", time.monotonic()))
    _line: Any = None
    _lock: threading.Lock = field(default_factory=threading.Lock)
    _over: bool = False

    def report(self, task: str, done: int, total: int) -> None:
        """Take note of how far a task has come; one that begins again is another one."""
        now = time.monotonic()
        with self._lock:
            if task != self.task.name or done < self.task.done or total != self.task.total:
                self.task = Task(task, now, first=done)
            self.task.done, self.task.total = done, total

    @contextmanager
    def shown(self) -> Iterator[Progress]:
        """Give what takes reports, and show the line once the patience is over, until the work is."""
        timer = threading.Timer(PATIENCE, self._show)
        timer.daemon = True
        timer.start()
        try:
            yield self.report
        finally:
            timer.cancel()
            with self._lock:
                self._over = True
                line, self._line = self._line, None
            if line is not None:
                line.stop()

    def _show(self) -> None:
        with self._lock:
            if self._over:
                return
            self._line = self._new_line()
            self._line.start()

    def _new_line(self) -> Any:
        if in_notebook():
            return NotebookLine(self._drawn)
        console = rich.Console(stderr=True)
        return rich.Live(console=console, transient=True, refresh_per_second=5, get_renderable=self._drawn)

    def _drawn(self) -> Any:
        """Draw the present task: its name, a bar, how much is done, and how long it will take."""
        task, now = self.task, time.monotonic()
        known = task.share > 0
        bar = rich.ProgressBar(total=1.0, completed=task.share, width=30, pulse=not known, animation_time=now)
        left = task.left(now)
        time_words = f"{spoken(left)} left" if left is not None else f"{now - task.began:.0f} s so far"
        table = rich.Table.grid(padding=(0, 1))
        table.add_row(task.name, bar, f"{100 * task.share:.0f} %" if known else "", time_words)
        return table


def shown_progress() -> AbstractContextManager[Progress]:
    """Give what takes reports of progress, and show them until the work is over."""
    return Tasks().shown()


@contextmanager
def progress_bar(progress: Progress | bool) -> Iterator[Progress]:
    """Give what takes reports of progress: what is given, or a bar (True) on a terminal or in a notebook, or nothing.

    A bar appears once the work takes its time; where errors go to a file or a pipe there is none.
    """
    if not isinstance(progress, bool):
        yield progress
    elif progress and (in_notebook() or has_terminal()):
        with shown_progress() as report:
            yield report
    else:
        yield silent
