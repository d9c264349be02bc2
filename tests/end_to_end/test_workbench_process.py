"""calc serve as a process: what it says, what it imports, and that nothing is left of it however it ends."""

from __future__ import annotations

import hashlib
import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from http.client import HTTPConnection, HTTPException
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest

CALC = [sys.executable, "-m", "truing"]
HANGING = """
import itertools
from pathlib import Path
from truing.atomic import file_appearing
with file_appearing(Path(__file__).with_name("sheet.html"), replace=True) as stream:
    stream.write(b"half")
    stream.flush()
    Path(__file__).with_suffix(".begun").touch()
    sum(itertools.repeat(0, 10**15))
"""
"""A plugin that never comes back, not even to Python, in the middle of writing."""
SLOWEST_END, SLOWEST_ADDRESS = 2.0, 1.5
"""Seconds on a machine that has nothing else to do; see ``allowed``."""
QUIET = 0.03
"""Seconds that Python takes there to begin and to end, at most."""


def allowed(seconds: float) -> float:
    """Return so many seconds, or more as the machine is busy: by as much as the start of Python takes longer."""
    began = time.monotonic()
    for _ in range(3):
        subprocess.run([sys.executable, "-I", "-S", "-c", ""], check=True)
    return seconds * max(1.0, (time.monotonic() - began) / 3 / QUIET)


class Served:
    """A server as a process, and a browser's way into it."""

    def __init__(self, process: subprocess.Popen[str], address: str) -> None:
        self.process, parts = process, urlsplit(address)
        self.host, self.port = parts.hostname or "", parts.port or 0
        answer = self.ask("GET", f"{parts.path}?{parts.query}")
        self.cookie = answer.headers["set-cookie"].partition(";")[0]

    def ask(self, method: str, path: str, **document: Any) -> Any:
        connection = HTTPConnection(self.host, self.port, timeout=20)
        shown = f"[{self.host}]" if ":" in self.host else self.host
        headers = {"Origin": f"http://{shown}:{self.port}", "Content-Type": "application/json"}
        if hasattr(self, "cookie"):
            headers["Cookie"] = self.cookie
        connection.request(method, path, json.dumps(document) if document else None, headers)
        return connection.getresponse()


def started(folder: Path, *words: str) -> tuple[subprocess.Popen[str], str, float]:
    began = time.monotonic()
    process = subprocess.Popen(
        [*CALC, "serve", str(folder), "--no-browser", *words],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
    )  # fmt: skip
    assert process.stdout is not None
    line = process.stdout.readline()
    return process, line.rsplit(" ", 1)[-1].strip(), time.monotonic() - began


@contextmanager
def serving(folder: Path, *words: str) -> Iterator[Served]:
    process, address, _ = started(folder, *words)
    try:
        yield Served(process, address)
    finally:
        process.kill()
        process.communicate()


def children(process: int) -> set[int]:
    """Return the processes that descend from one."""
    below: dict[int, set[int]] = {}
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = path.read_text().rpartition(")")[2].split()
        except OSError:
            continue
        below.setdefault(int(fields[1]), set()).add(int(path.parent.name))
    own = below.get(process, set())
    return own.union(*(children_ for each in own if (children_ := _all_below(below, each))))


def _all_below(below: dict[int, set[int]], process: int) -> set[int]:
    own = below.get(process, set())
    return own.union(*(_all_below(below, each) for each in own))


def is_alive(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


ENDS = [(signal.SIGINT, 0), (signal.SIGTERM, 143), (signal.SIGKILL, -signal.SIGKILL)]


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="looks for processes in /proc")
@pytest.mark.parametrize(("number", "code"), ENDS)
def test_nothing_is_left_of_a_server_that_is_ended(tmp_path: Path, number: int, code: int) -> None:
    (tmp_path / "hanging.py").write_text(HANGING)
    (tmp_path / "own.toml").write_text('plugin = "hanging.py"\n')
    with serving(tmp_path) as served:
        assert served.ask("POST", "/api/confirm", file="hanging.py").status == 200
        ends: list[float] = []
        stream = served.ask("GET", "/events")
        reader = threading.Thread(target=read_to_the_end, args=(stream, ends))
        reader.start()
        if number != signal.SIGINT:  # by Ctrl-C while nothing is done, by the others while a model hangs
            assert served.ask("POST", "/api/run", file="own.toml", plugin="hanging.py").status == 200
            assert eventually((tmp_path / "hanging.begun").exists)
        processes = children(served.process.pid)
        assert len(processes) >= 3
        soon = allowed(SLOWEST_END)
        began = time.monotonic()
        served.process.send_signal(number)
        assert served.process.wait(soon) == code
        assert eventually(lambda: not any(map(is_alive, processes)), soon)
        reader.join(soon)
        assert ends
        assert ends[0] - began < soon
        assert "Traceback" not in (served.process.stderr.read() if served.process.stderr else "")
    assert not (tmp_path / "sheet.html").exists()
    if number == signal.SIGKILL:  # the next server takes away what one that was killed was writing
        with serving(tmp_path):
            assert eventually(lambda: not list(tmp_path.glob(".*.part")))
    assert not list(tmp_path.glob(".*"))


def read_to_the_end(stream: Any, ends: list[float]) -> None:
    with suppress(HTTPException, OSError):
        stream.read()
    ends.append(time.monotonic())


def eventually(is_so: Callable[[], Any], seconds: float = 40.0) -> bool:
    end = time.monotonic() + seconds
    while not is_so() and time.monotonic() < end:
        time.sleep(0.02)
    return bool(is_so())


def test_the_address_is_there_soon_and_the_server_imports_nothing_heavy(tmp_path: Path) -> None:
    script = f"""
import json, signal, sys, threading, urllib.request
from pathlib import Path
from truing.cli import main
import truing.cli.serve as serve
def visit(address):
    opener = urllib.request.build_opener(urllib.request.HTTPCookieProcessor())
    page = opener.open(address).read().decode()
    base = address.partition("/?")[0]
    def call(path, **document):
        headers = {{"content-type": "application/json", "origin": base}}
        return opener.open(urllib.request.Request(base + path, json.dumps(document).encode(), headers)).read()
    call("/api/begin", plugin="press_linkage", file="press.toml")
    text = Path({str(tmp_path / "press.toml")!r}).read_text()
    state = json.loads(call("/api/state", file="press.toml", plugin="press_linkage", text=text))
    opener.open(base + "/edit?file=press.toml").read()
    print(json.dumps([len(page), len(state["fields"]), sorted(sys.modules)]), file=sys.stderr)
    signal.raise_signal(signal.SIGINT)
serve.webbrowser.open = visit
sys.exit(main(["serve", {str(tmp_path)!r}]))
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    page, fields, modules = json.loads(next(line for line in done.stderr.splitlines() if line.startswith("[")))
    assert page > 1000
    assert fields > 3
    roots = {name.partition(".")[0] for name in modules}
    assert "starlette" in roots
    assert roots & {"numpy", "scipy", "matplotlib", "pint", "sklearn", "pymoo", "press_linkage", "rv_wear"} == set()
    times = []
    for _ in range(3):
        process, address, seconds = started(tmp_path)
        assert address.startswith("http://127.0.0.1:")
        times.append(seconds)
        process.send_signal(signal.SIGINT)
        assert process.wait(allowed(SLOWEST_END)) == 0
        process.communicate()
    assert min(times) < allowed(SLOWEST_ADDRESS)


# Refusals


def refused(*words: str, hidden: str = "") -> tuple[int, str]:
    """Run ``calc serve`` in a process in which a library cannot be imported; return exit code and what it says."""
    script = f"import sys\nsys.modules[{hidden!r}] = None\nfrom truing.cli import main\nsys.exit(main(sys.argv[1:]))"
    done = subprocess.run(
        [sys.executable, "-c", script, "serve", "--no-browser", *words], capture_output=True, text=True, timeout=30
    )
    assert done.stdout == ""
    return done.returncode, done.stderr


@pytest.mark.parametrize("library", ["starlette", "uvicorn", "tomlkit"])
def test_a_missing_library_is_one_sentence(tmp_path: Path, library: str) -> None:
    assert refused(str(tmp_path), hidden=library) == (
        2,
        f"calc: the workbench needs {library}, which is not installed; install it with: pip install 'truing[web]'\n",
    )


def test_a_port_that_is_taken_and_a_folder_that_is_none(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        assert refused(str(tmp_path), "--port", str(port), hidden="nothing_such") == (
            2,
            f"calc: 127.0.0.1:{port} cannot be opened: another program listens there; "
            "name another --port, or none for any that is free\n",
        )
    missing = tmp_path / "missing"
    assert refused(str(missing), hidden="nothing_such") == (
        2,
        f"calc: {missing} is no folder; name the one with your inputs files\n",
    )
    code, said = refused(str(tmp_path), "--host", "203.0.113.7", hidden="nothing_such")
    assert code == 2
    assert said.startswith("calc: 203.0.113.7:0 cannot be opened: ")


@pytest.mark.parametrize(("host", "shown", "warns"), [("::1", "[::1]", False), ("0.0.0.0", socket.gethostname(), True)])
def test_other_addresses(tmp_path: Path, host: str, shown: str, warns: bool) -> None:
    if ":" in host and not socket.has_ipv6:
        pytest.skip("needs IPv6")
    process, address, _ = started(tmp_path, "--host", host)
    try:
        port = urlsplit(address).port
        assert address.startswith(f"http://{shown}:{port}/?token=")
        near = "[::1]" if ":" in host else "127.0.0.1"
        answer = Served(process, f"http://{near}:{port}/?{address.partition('?')[2]}").ask("GET", "/api/jobs")
        assert answer.status == 200
    finally:
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=allowed(SLOWEST_END))
    assert ("warning: 0.0.0.0 can be reached from other machines" in said) == warns


def test_a_folder_that_is_read_only(tmp_path: Path) -> None:
    (tmp_path / "press.toml").write_text('plugin = "press_linkage"\n')
    tmp_path.chmod(0o500)
    if os.access(tmp_path, os.W_OK):
        pytest.skip("everything is permitted to this user")
    try:
        with serving(tmp_path) as served:
            answer = served.ask("POST", "/api/save", file="new.toml", text="", base=hashlib.sha256(b"").hexdigest())
            assert answer.status == 422
            assert "cannot be written" in json.loads(answer.read())["faults"][0]["message"]
            served.process.send_signal(signal.SIGINT)
            _, said = served.process.communicate(timeout=allowed(SLOWEST_END))
            assert f"warning: {tmp_path} is read-only; nothing can be saved there" in said
    finally:
        tmp_path.chmod(0o700)
