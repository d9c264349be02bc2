"""A long day at the workbench, over HTTP: the memory of every process stays flat, and nothing that was saved is lost.

500 edits, each saved, 50 runs, 10 diagnoses, and 3 workers that are killed in between. Runs at full size only:
``pytest tests/torture/test_workbench_soak.py --torture=full -s`` prints the figures.
"""

from __future__ import annotations

import hashlib
import json
import os
import signal
import subprocess
import sys
import time
from http.client import HTTPConnection
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest
from forked import filled

pytestmark = pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="reads memory from /proc")
EDITS, RUNS, DIAGNOSES = 500, 50, 10
KILLED_AFTER = (120, 260, 400)
"""Edits after which a worker is killed."""
SETTLED = 100
"""Edits after which memory is looked at for the first time: everything has been imported then."""
MOST_GROWTH = {"server": 8e6, "worker": 40e6}
"""Bytes: what allocators keep; a leak of 100 kB an edit would show as 40 MB."""
LONGEST_JOB = 60.0


class Visitor:
    """A page of the workbench, without the page."""

    def __init__(self, address: str) -> None:
        parts = urlsplit(address)
        self._connection = HTTPConnection(parts.hostname or "", parts.port or 0, timeout=60)
        self._headers = {"Origin": f"http://{parts.netloc}", "Content-Type": "application/json"}
        self._connection.request("GET", f"/?{parts.query}")
        answer = self._connection.getresponse()
        answer.read()
        self._headers["Cookie"] = answer.headers["set-cookie"].partition(";")[0]

    def ask(self, path: str, **document: Any) -> tuple[int, Any]:
        method = "POST" if document else "GET"
        self._connection.request(method, path, json.dumps(document) if document else None, self._headers)
        answer = self._connection.getresponse()
        return answer.status, json.loads(answer.read())

    def finished(self, path: str, **document: Any) -> dict[str, Any]:
        """Begin a job and wait for its end."""
        status, begun = self.ask(path, **document)
        assert status == 200, begun
        end = time.monotonic() + LONGEST_JOB
        while time.monotonic() < end:
            jobs = {job["ident"]: job for job in self.ask("/api/jobs")[1]["jobs"]}
            job: dict[str, Any] = jobs[begun.get("ident") or begun["job"]["ident"]]
            if job["status"] not in {"waits", "runs"}:
                return job
            time.sleep(0.05)
        pytest.fail(f"{path} did not end")


def memory(process: int) -> int:
    """Return the bytes that a process holds, 0 for one that is gone."""
    try:
        pages = int(Path(f"/proc/{process}/statm").read_text(encoding="ascii").split()[1])
    except (OSError, IndexError):
        return 0
    return pages * os.sysconf("SC_PAGE_SIZE")


def workers_of(server: int) -> list[int]:
    """Return the worker processes of a server."""
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            parent = int(path.read_text().rpartition(")")[2].split()[1])
            command = (path.parent / "cmdline").read_bytes()
        except OSError:
            continue
        if parent == server and b"spawn_main" in command:
            found.append(int(path.parent.name))
    return found


def _killed(worker: int) -> bool:
    """Kill a process, and wait until it has ended: freeing what it holds takes a while."""
    os.kill(worker, signal.SIGKILL)
    end = time.monotonic() + 5
    while time.monotonic() < end and _state(worker) not in {"", "Z"}:
        time.sleep(0.01)
    return _state(worker) in {"", "Z"}


def _state(process: int) -> str:
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return ""


def digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def test_a_long_day(tmp_path: Path, full_torture: bool) -> None:
    if not full_torture:
        pytest.skip("takes minutes; at full size only")
    filled(tmp_path)
    server = subprocess.Popen(
        [sys.executable, "-m", "truing", "serve", str(tmp_path), "--no-browser"], stdout=subprocess.PIPE, text=True
    )
    assert server.stdout is not None
    try:
        _live(Visitor(server.stdout.readline().rsplit(" ", 1)[-1].strip()), tmp_path, server.pid)
    finally:
        server.send_signal(signal.SIGINT)
        assert server.wait(2.0) == 0


def _live(visitor: Visitor, folder: Path, server: int) -> None:
    file = folder / "bar.toml"
    about = {"file": "bar.toml", "plugin": "bar.py"}
    assert visitor.ask("/api/confirm", file="bar.py")[0] == 200
    text = file.read_text(encoding="utf-8")
    base, before, killed, began = digest(text), (0, 0), 0, time.monotonic()
    for number in range(1, EDITS + 1):
        change = {"path": ["inputs", "load"], "value": f"{5 + number / 100:.2f} kN"}
        status, state = visitor.ask("/api/state", **about, text=text, change=change)
        assert status == 200
        assert f"{5 + number / 100:.2f} kN" in state["text"]
        stale, text = digest(text), state["text"]
        status, saved = visitor.ask("/api/save", file="bar.toml", text=text, base=base)
        assert status == 200
        base = saved["digest"]
        assert visitor.ask("/api/save", file="bar.toml", text="lost", base=stale)[1]["conflict"]
        assert file.read_text(encoding="utf-8") == text
        if number in KILLED_AFTER:
            killed += _killed(workers_of(server)[0])
        if number % (EDITS // RUNS) == 0:
            job = visitor.finished("/api/run", **about)
            assert job["status"] == "done", (number, job["faults"])
        if number % (EDITS // DIAGNOSES) == 0:
            job = visitor.finished("/api/diagnose", **about, data=["measured.csv"])
            assert job["status"] == "done", (number, job["faults"])
        if number == SETTLED:
            before = memory(server), max(map(memory, workers_of(server)))
    after = memory(server), max(map(memory, workers_of(server)))
    megabytes = [f"{size / 1e6:.1f}" for size in (*before, *after)]
    print(f"\n{EDITS} edits, {RUNS} runs, {DIAGNOSES} diagnoses, {killed} killed in {time.monotonic() - began:.0f} s")
    print(f"after {SETTLED} edits: server {megabytes[0]} MB, largest worker {megabytes[1]} MB")
    print(f"at the end: server {megabytes[2]} MB, largest worker {megabytes[3]} MB; {len(workers_of(server))} workers")
    assert after[0] - before[0] < MOST_GROWTH["server"]
    assert after[1] - before[1] < MOST_GROWTH["worker"]
    assert len(workers_of(server)) <= 4
    assert not [path for path in folder.rglob(".*") if path.name.endswith((".part", ".old"))]
    assert json.loads((folder / "runs" / "bar" / "results.json").read_text(encoding="utf-8"))
