"""What a model may do to its process: by mistake, or not."""

from __future__ import annotations

import ctypes
import itertools
import os
import signal
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any


def echo(said: Any = None) -> Any:
    return said


def where() -> list[Any]:
    return [os.getpid(), os.getcwd()]


def loop_in_python() -> None:
    while True:
        with suppress(Exception):
            pass


def loop_in_c() -> int:
    return sum(itertools.repeat(0, 10**15))


def abort() -> None:
    os.abort()


def segfault() -> None:
    ctypes.string_at(0)


def leave() -> None:
    os._exit(3)


def kill_itself() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def end_program() -> None:
    sys.exit(4)


def interrupt() -> None:
    raise KeyboardInterrupt


def eat_memory() -> int:
    eaten = []
    while True:
        eaten.append(bytearray(50_000_000))


def recurse(depth: int = 0) -> int:
    return recurse(depth + 1) + 1


def print_much() -> str:
    for _ in range(300):
        print("x" * 100_000)
        os.write(1, b"y" * 100_000)
        os.write(2, b"z" * 100_000)
    return "printed"


def answer_much() -> str:
    return "x" * 20_000_000


def complain_much() -> None:
    raise ValueError("x" * 20_000_000)


def answer_no_json() -> object:
    return object()


def answer_nan() -> list[float]:
    return [float("nan"), float("inf"), 1.0]


def fork() -> int:
    return os.fork()


def fork_and_keep(file: str) -> str:
    """Leave a process behind that holds the pipe and goes on."""
    if os.fork() == 0:
        Path(file).write_text(str(os.getpid()))
        time.sleep(60)
        os._exit(0)
    while not Path(file).exists() or not Path(file).read_text():
        time.sleep(0.01)
    return "forked"


def fork_away_and_hang() -> None:
    """Leave a process that has left the group and holds the pipe, and hang."""
    if os.fork() == 0:
        os.setsid()
        time.sleep(4)
        os._exit(0)
    time.sleep(60)


def change_folder() -> str:
    os.chdir("/")
    return os.getcwd()


def close_everything() -> None:
    os.closerange(0, 100)


def write_everywhere() -> None:
    for descriptor in range(3, 100):
        with suppress(OSError):
            os.write(descriptor, b"\x00\x00\x10\x00garbage")
    time.sleep(60)


def deaf() -> None:
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    while True:
        with suppress(BaseException):
            time.sleep(60)


def stay_in_thread() -> str:
    threading.Thread(target=time.sleep, args=(60,)).start()
    return "thread"


def report(progress: Callable[[str, int, int], None]) -> str:
    for done in range(50_000):
        progress("stage\x1b[31m" + "x" * 1000, done, 50_000)
    return "reported"


def wait_for(file: str, seconds: float = 60.0) -> str:
    """Say where it runs, and wait."""
    Path(file).write_text(str(os.getpid()))
    time.sleep(seconds)
    return "waited"


def write_slowly(file: str) -> None:
    """Be in the middle of writing."""
    from truing.atomic import file_appearing

    with file_appearing(Path(file), replace=True) as stream:
        stream.write(b"half")
        stream.flush()
        Path(f"{file}.begun").touch()
        time.sleep(60)
