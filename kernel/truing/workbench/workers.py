"""Worker processes as the server sees them: quick questions with a time limit, and jobs with progress and cancel."""

from __future__ import annotations

import multiprocessing
import secrets
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from typing import Any, Literal

from truing.workbench.worker_process import work

PATIENCE = 20.0
"""Seconds that a quick question may take."""
LONGEST_JOB = 1e6
"""Seconds that a job may take: as long as the user lets it."""
MOST_JOBS = 2
"""Jobs that run at the same time; others wait."""
KEPT_JOBS = 50
"""So many finished jobs are remembered."""
Status = Literal["waits", "runs", "done", "failed", "cancelled"]


class TaskError(Exception):
    """What is wrong with what a task was given, fault by fault: message, file, line, cell."""

    def __init__(self, faults: Sequence[dict[str, Any]]) -> None:
        self.faults = list(faults)
        super().__init__("\n".join(fault["message"] for fault in self.faults))


class Worker:
    """One worker process, which can be replaced."""

    def __init__(self, memory: int) -> None:
        self._memory = memory
        self._start()

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._pipe, end = context.Pipe()
        self._process = context.Process(target=work, args=(end, self._memory), daemon=True)
        self._process.start()
        end.close()

    def ask(
        self, name: str, arguments: dict[str, Any], *, patience: float, progress: Callable[[str, int, int], None]
    ) -> Any:
        """Do a task and return its answer. Raises TaskError, also where it takes too long or the process ends."""
        try:
            self._pipe.send((name, arguments))
            end = time.monotonic() + patience
            while self._pipe.poll(max(0.0, end - time.monotonic())):
                kind, said = self._pipe.recv()
                if kind == "answer":
                    return said
                if kind == "faults":
                    raise TaskError(said)
                progress(*said)
        except (EOFError, OSError):
            self._process.join(1.0)
            code = self._process.exitcode
            self.replace()
            raise TaskError([fault_of(f"the calculation ended without an answer (exit code {code})")]) from None
        self.replace()
        raise TaskError([fault_of(f"the calculation did not answer within {patience:g} s and was stopped")])

    def replace(self) -> None:
        """End the process and start another."""
        self.stop()
        self._start()

    def stop(self) -> None:
        """End the process, whatever it does."""
        with suppress(OSError, ValueError):
            self._process.kill()
        self._pipe.close()


def fault_of(sentence: str) -> dict[str, Any]:
    """Return a fault that stands in no file."""
    return {"message": sentence, "file": "", "line": None, "cell": ""}


@dataclass
class Job:
    """Work that takes longer: what it is, how far it is, and how it ended."""

    name: str
    title: str
    about: str
    """The file it is of, relative to the folder."""
    ident: str = field(default_factory=lambda: secrets.token_urlsafe(9))
    status: Status = "waits"
    stage: str = ""
    done: int = 0
    total: int = 0
    answer: Any = None
    faults: list[dict[str, Any]] = field(default_factory=list)
    started: float = field(default_factory=time.time)
    worker: Worker | None = None

    def as_json(self) -> dict[str, Any]:
        """Return what the page shows of it."""
        shown = ("ident", "name", "title", "about", "status", "stage", "done", "total", "answer", "faults", "started")
        return {name: getattr(self, name) for name in shown}


class Workers:
    """The workers of one server: some that answer questions, and one for each job that runs."""

    def __init__(self, memory: int, quick: int = 2) -> None:
        self._memory = memory
        self._free = [Worker(memory) for _ in range(quick)]
        self._gate = threading.Condition()
        self._running = threading.Semaphore(MOST_JOBS)
        self.jobs: dict[str, Job] = {}
        self.closed = False

    def ask(self, name: str, *, patience: float = PATIENCE, **arguments: Any) -> Any:
        """Do a quick task in the next free worker. Raises TaskError. Blocks: call it from a thread."""
        with self._taken() as worker:
            return worker.ask(name, arguments, patience=patience, progress=lambda *_: None)

    @contextmanager
    def _taken(self) -> Iterator[Worker]:
        with self._gate:
            while not self._free:
                self._gate.wait()
            worker = self._free.pop()
        try:
            yield worker
        finally:
            with self._gate:
                self._free.append(worker)
                self._gate.notify()

    def start(self, name: str, title: str, about: str, **arguments: Any) -> Job:
        """Begin a job in a process of its own."""
        job = Job(name, title, about)
        finished = [ident for ident, each in self.jobs.items() if each.status not in {"waits", "runs"}]
        for ident in finished[: max(0, len(self.jobs) - KEPT_JOBS)]:
            del self.jobs[ident]
        self.jobs[job.ident] = job
        threading.Thread(target=self._do, args=(job, arguments), daemon=True).start()
        return job

    def _do(self, job: Job, arguments: dict[str, Any]) -> None:
        def progress(stage: str, done: int, total: int) -> None:
            job.stage, job.done, job.total = stage, done, total

        with self._running:
            if self.closed or job.status == "cancelled":
                return
            job.status, job.worker = "runs", Worker(self._memory)
            try:
                job.answer = job.worker.ask(job.name, arguments, patience=LONGEST_JOB, progress=progress)
                job.status = "done"
            except TaskError as error:
                if job.status == "runs":
                    job.status, job.faults = "failed", error.faults
            finally:
                job.worker.stop()

    def cancel(self, ident: str) -> bool:
        """End a job that waits or runs; tell whether there was one."""
        job = self.jobs.get(ident)
        if job is None or job.status not in {"waits", "runs"}:
            return False
        job.status = "cancelled"
        if job.worker is not None:
            job.worker.stop()
        return True

    def close(self) -> None:
        """End every process."""
        self.closed = True
        for job in self.jobs.values():
            self.cancel(job.ident)
        with self._gate:
            for worker in self._free:
                worker.stop()
