"""The command line in a fork of this process: warm at once, with streams and a file system of its own to break."""

from __future__ import annotations

import contextlib
import gc
import io
import os
import select
import signal
import sys
import warnings
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from truing.cli import main
from truing.watching import WatchedFiles
from truing.workbench.listening import Server

POLL = 0.05
LONGEST = 60
"""Seconds that a forked command may take."""


@dataclass(frozen=True)
class End:
    """How a forked command ended: exit code, or minus the signal; and what it said where that was not redirected."""

    code: int
    out: str
    err: str


Redirection = Callable[[], int | None]
"""Returns the descriptor that a stream is to have, or None where it is to be closed; called in the fork."""


def forked(
    words: Sequence[str],
    folder: Path,
    *,
    stdout: Redirection | None = None,
    stderr: Redirection | None = None,
    encoding: str = "utf-8",
    before: Callable[[], object] = lambda: None,
) -> End:
    """Run ``calc`` in a fork, in a folder; ``before`` is called there at last, to inject what it likes."""
    (out, out_there), (err, err_there) = os.pipe(), os.pipe()  # a file might be limited with all others
    gc.freeze()  # else the fork looks through all that the tests before have left, and copies every page of it
    child = os.fork()
    if child == 0:
        _be_the_command(words, folder, (stdout or (lambda: out_there), stderr or (lambda: err_there)), encoding, before)
    os.close(out_there)
    os.close(err_there)
    status, said = _heard(child, (out, err))
    return End(os.waitstatus_to_exitcode(status), *(text.decode("utf-8", "replace") for text in said))


def _heard(child: int, pipes: Sequence[int]) -> tuple[int, list[bytes]]:
    """Return how a process ended and what it said; what it has started may hold the pipes longer than it lives."""
    said = dict.fromkeys(pipes, b"")
    still = list(pipes)
    ended = status = 0
    while not ended:
        ready = select.select(still, [], [], POLL)[0] if still else []
        ended, status = os.waitpid(child, os.WNOHANG if still else 0)
        for pipe in tuple(still if ended else ready):
            os.set_blocking(pipe, False)
            with suppress(BlockingIOError):
                while part := os.read(pipe, 65536):
                    said[pipe] += part
                still.remove(pipe)
    for pipe in pipes:
        os.close(pipe)
    return status, list(said.values())


def _be_the_command(
    words: Sequence[str],
    folder: Path,
    streams: Sequence[Redirection],
    encoding: str,
    before: Callable[[], object],
) -> None:
    """Do what the interpreter does from its streams to its exit code; never return."""
    code = 99
    try:
        signal.alarm(LONGEST)
        signal.signal(signal.SIGINT, signal.default_int_handler)
        os.chdir(folder)
        sys.stdin = io.TextIOWrapper(io.BufferedReader(io.FileIO(os.devnull)))
        descriptors = [stream() for stream in streams]
        sys.stdout = _stream(descriptors[0], 1, encoding)
        sys.stderr = _stream(descriptors[1], 2, encoding)
        before()
        code = main(words)
        for stream in (sys.stdout, sys.stderr):  # as at the end of the interpreter, which exits with 120
            try:
                stream.flush()
            except (OSError, ValueError):
                code = 120
    except BaseException:
        import traceback

        os.write(2, traceback.format_exc().encode())
    finally:
        os._exit(code)


def _stream(descriptor: int | None, number: int, encoding: str) -> IO[str]:
    """Make a descriptor a standard stream as the interpreter does: none where it is closed."""
    if descriptor is None:
        os.close(number)
        return None  # type: ignore[return-value]
    os.dup2(descriptor, number)
    raw = io.BufferedWriter(io.FileIO(number, "w", closefd=False))
    return io.TextIOWrapper(raw, encoding=encoding, errors="strict" if number == 1 else "backslashreplace")


def stop_watching() -> None:
    """Let ``calc watch`` end as by Ctrl+C when it looks for changes for the first time; called in the fork."""

    def stop(watched: WatchedFiles) -> None:
        raise KeyboardInterrupt

    WatchedFiles.changed = stop  # type: ignore[assignment, method-assign]


def stop_serving() -> None:
    """Let ``calc serve`` end as by Ctrl+C when it waits for the first page; called in the fork."""

    def stop(server: Server, sockets: object) -> None:
        raise KeyboardInterrupt

    Server.run = stop  # type: ignore[assignment, method-assign]


BAR = Path(__file__).parent / "bar.py"


def filled(folder: Path, *commands: str) -> Path:
    """Put into a folder what the verbs read: the bar, its inputs, rows, and a record.

    Then run commands there, in this process, so that every fork of it has imported what they need.
    """
    (folder / "bar.py").write_text(BAR.read_text(encoding="utf-8"), encoding="utf-8")
    (folder / "bar.toml").write_text("[inputs]\n")
    (folder / "rows.csv").write_text("load [kN]\n9\n10\n")
    rows = "".join(f"{10 + 0.1 * place},{100 + place + 0.01 * (-1) ** place}\n" for place in range(12))
    (folder / "measured.csv").write_text(f"load [kN],stress [MPa]\n{rows}")
    said = io.StringIO()
    quiet = contextlib.redirect_stdout(said), contextlib.redirect_stderr(said)
    with contextlib.chdir(folder), quiet[0], quiet[1], warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)  # of numpy, which a user would see
        for words in commands:
            assert main(words.split()) == 0, said.getvalue()
    return folder
