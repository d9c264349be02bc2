"""Worker processes as the server sees them: quick questions with a time limit, and jobs with progress and cancel.

A process that does not answer in time, crashes or is no longer wanted is ended with all that it has started. One more
than is needed is always kept warm, so that its successor and the next job begin at once.
"""

from __future__ import annotations

import json
import multiprocessing
import os
import secrets
import signal
import socket
import subprocess
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from truing.errors import UsageError
from truing.workbench import end_orphans
from truing.workbench.places import tidy
from truing.workbench.tasks import HOME
from truing.workbench.worker_process import LARGEST_ANSWER, work

PATIENCE = 20.0
"""Seconds that a quick question may take."""
MOST_LOST = 6
"""Workers that may be found to have ended while they waited, one after another: more than there are."""
OVERTAKEN = 2.0
"""Seconds that a question may go on after a newer one of its group was asked: longer than most take."""
LONGEST_JOB = 1e6
"""Seconds that a job may take: as long as the user lets it."""
MOST_JOBS, MOST_WAITING = 2, 20
"""Jobs that run at the same time, and that wait behind them."""
KEPT_JOBS, KEPT_BYTES = 50, 4_000_000
"""So many finished jobs are remembered, with answers of so many bytes in all."""
LARGEST_RESULT = 256_000
"""Bytes of a job's answer: what it leaves is in the folder."""
FAREWELL = 0.3
"""Seconds in which a worker may take back what it is writing, before it is killed."""
SETTLED = 3.0
"""Seconds after which the other workers begin, if nothing was asked before."""
MOST_KEPT_MEMORY = 1_000_000_000
"""A worker that holds more bytes than this after an answer is replaced."""
Status = Literal["waits", "runs", "done", "failed", "cancelled"]
Progress = Callable[[str, int, int], None]


class TaskError(Exception):
    """What is wrong with what a task was given, fault by fault: message, file, line, cell."""

    def __init__(self, faults: Sequence[dict[str, Any]]) -> None:
        self.faults = list(faults)
        super().__init__("\n".join(fault["message"] for fault in self.faults))


class OvertakenError(TaskError):
    """A newer question of the same group was asked; nobody waits for the answer to this one."""

    def __init__(self) -> None:
        super().__init__([fault_of("a newer question took the place of this one")])


class NotBegunError(TaskError):
    """The process had ended while it waited, so that the task was not begun: another one can do it."""


def fault_of(sentence: str) -> dict[str, Any]:
    """Return a fault that stands in no file."""
    return {"message": sentence, "file": "", "line": None, "cell": ""}


class OrphanEnder:
    """The process that ends the workers when this one was killed; Windows has none, workers there end themselves."""

    def __init__(self) -> None:
        self._process: Any = None

    def hear(self, kind: str, group: int | None) -> None:
        """Take note of a group that has begun ("+") or ended ("-")."""
        if self._process is None and hasattr(os, "killpg"):
            self._process = subprocess.Popen(
                [sys.executable, "-I", "-S", end_orphans.__file__],
                stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True,
            )  # fmt: skip
        if self._process is not None and group is not None:
            with suppress(OSError, ValueError):
                os.write(self._process.stdin.fileno(), f"{kind} {group}\n".encode())

    def close(self) -> None:
        """End it, with whatever is left."""
        if self._process is not None:
            with suppress(OSError, ValueError):
                self._process.stdin.close()
            with suppress(subprocess.TimeoutExpired):
                self._process.wait(FAREWELL)


class Worker:
    """One worker process. Once it was ended, by whomever, it is good for nothing more."""

    def __init__(self, memory: int, root: Path, orphans: OrphanEnder, home: str = HOME) -> None:
        context = multiprocessing.get_context("spawn")
        self._orphans, self._number, self._lock = orphans, 0, threading.Lock()
        self._begun = False
        self.why = ""
        """Why it was ended, or nothing as long as it works."""
        self._pipe, end = context.Pipe()
        self._process = context.Process(target=work, args=(end, memory, str(root), home))
        self._process.start()
        end.close()
        orphans.hear("+", self._process.pid)

    def ask(self, name: str, arguments: dict[str, Any], *, patience: float, progress: Progress) -> Any:
        """Do a task and return its answer. Raises TaskError, also where it takes too long or the process ends."""
        self._number, self._begun = self._number + 1, False
        late = f"the calculation did not answer within {patience:g} s and was stopped"
        timer = threading.Timer(min(patience, threading.TIMEOUT_MAX), self.end, [late])
        timer.daemon = True
        timer.start()
        try:
            self._pipe.send((self._number, name, arguments))
            return self._heard(progress)
        except (EOFError, OSError, ValueError):
            is_lost = not self._begun and not self.why
            self.end(self._how_it_ended())
            raise (NotBegunError if is_lost else TaskError)([fault_of(self.why)]) from None
        finally:
            timer.cancel()
            timer.join()

    def _heard(self, progress: Progress) -> Any:
        while True:
            number, kind, said = json.loads(self._pipe.recv_bytes(LARGEST_ANSWER))
            if number != self._number:
                continue
            self._begun = True
            if kind == "answer":
                return said
            if kind == "faults":
                raise TaskError(said)
            if kind == "progress":
                progress(*said)

    def _how_it_ended(self) -> str:
        self._process.join(FAREWELL)
        code = self._process.exitcode
        if code is None:
            return "the calculation closed its connection and was stopped"
        if -code == getattr(signal, "SIGKILL", None):
            return "the calculation was killed by the system, perhaps because memory ran short"
        if code < 0:
            return f"the calculation crashed ({signal.strsignal(-code) or f'signal {-code}'})"
        return f"the calculation ended without an answer (exit code {code})"

    @property
    def works(self) -> bool:
        """Whether it can be asked: a process may end while it waits, as where the system is short of memory."""
        return not self.why and self._process.is_alive()

    @property
    def memory(self) -> int:
        """Return the bytes that the process holds in memory, or 0 where the system does not say."""
        try:
            pages = Path(f"/proc/{self._process.pid}/statm").read_text(encoding="ascii").split()[1]
            return int(pages) * os.sysconf("SC_PAGE_SIZE")
        except (OSError, ValueError, IndexError):
            return 0

    def end(self, why: str, *, gently: bool = False) -> None:
        """End the process and all that it has started; ``gently`` gives it a moment to take back what it writes."""
        if self.condemn(why):
            self.finish(gently=gently)

    def condemn(self, why: str) -> bool:
        """Decide that the process ends, so that nobody asks it any more; tell whether nobody had decided it before."""
        with self._lock:
            is_first = not self.why
            self.why = self.why or why
        return is_first

    def finish(self, *, gently: bool = False) -> None:
        """End a process for which that was decided."""
        with suppress(OSError, ValueError):
            if gently and self._process.is_alive():
                self._process.terminate()
                self._process.join(FAREWELL)
        with suppress(OSError, ValueError):
            self._process.kill()
        if hasattr(os, "killpg") and self._process.pid:
            with suppress(OSError):
                os.killpg(self._process.pid, signal.SIGKILL)
        self._hang_up()
        self._process.join(FAREWELL)
        self._orphans.hear("-", self._process.pid)

    def _hang_up(self) -> None:
        """Wake whoever waits for an answer, even where a process that has left the group still holds the other end."""
        with suppress(OSError, ValueError):
            if os.name == "posix":
                with socket.socket(fileno=os.dup(self._pipe.fileno())) as connection:
                    connection.shutdown(socket.SHUT_RDWR)


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
    size: int = 0
    """Bytes of its answer."""
    worker: Worker | None = None

    def as_json(self) -> dict[str, Any]:
        """Return what the page shows of it."""
        shown = ("ident", "name", "title", "about", "status", "stage", "done", "total", "answer", "faults", "started")
        return {name: getattr(self, name) for name in shown}

    @property
    def is_over(self) -> bool:
        """Whether nothing more becomes of it."""
        return self.status not in {"waits", "runs"}


@dataclass(eq=False)
class Question:
    """A quick question that is being answered: of which group, by whom, and whether a newer one has overtaken it."""

    group: str
    is_overtaken: bool = False
    worker: Worker | None = None


class Workers:
    """The workers of one server: some that answer questions, one for each job that runs, and one in reserve."""

    def __init__(self, memory: int, root: Path = Path(), quick: int = 2, home: str = HOME) -> None:
        self._memory, self._root, self._quick, self._home = memory, root.resolve(), quick, home
        self._gate = threading.Condition()
        self._orphans = OrphanEnder()
        self._idle: list[Worker] = []
        self._all: set[Worker] = set()
        self._asked: list[Question] = []
        self._queue: deque[tuple[Job, dict[str, Any]]] = deque()
        self.jobs: dict[str, Job] = {}
        self.changes = 0
        """Grows whenever something of a job changes."""
        self.closed = False
        if quick:
            self._idle.append(self._new())  # alone at first: the others would keep the first page waiting
            later = threading.Timer(SETTLED, self._refill)
            later.daemon = True
            later.start()

    # Processes

    def _refill(self) -> None:
        """Keep as many warm workers as there may be questions, and one more."""
        while True:
            with self._gate:
                for worker in [worker for worker in self._idle if not worker.works]:
                    self._idle.remove(worker)
                    worker.end("it ended while it waited")
                if self.closed or len(self._idle) + self._answering() > self._quick:
                    return
                self._idle.append(self._new())

    def _answering(self) -> int:
        return sum(question.worker is not None for question in self._asked)

    def _new(self) -> Worker:
        if self.closed:
            raise TaskError([fault_of("the workbench has ended")])
        worker = Worker(self._memory, self._root, self._orphans, self._home)
        self._all = {each for each in self._all if not each.why} | {worker}
        return worker

    def _take(self) -> Worker:
        """Return a warm worker, the one that was asked last; called within the gate."""
        while self._idle:
            worker = self._idle.pop(0)
            if worker.works:
                return worker
            worker.end("it ended while it waited")
        return self._new()

    def _answered(self, asked: Question | Job, task: tuple[str, Any], patience: float, progress: Progress) -> Any:
        """Let its worker do a task, or another one where that had ended while it waited. Raises TaskError."""
        for _ in range(MOST_LOST):
            worker = asked.worker
            if worker is None:
                break
            try:
                return worker.ask(*task, patience=patience, progress=progress)
            except NotBegunError:
                with self._gate:
                    asked.worker = self._take()
        raise TaskError([fault_of("the processes that calculate end before they begin")])

    # Quick questions

    def ask(self, name: str, /, *, patience: float = PATIENCE, group: str = "", **arguments: Any) -> Any:
        """Do a quick task in the next free worker. Blocks: call it from a thread.

        Where ``group`` is given, a newer question of the same group ends this one. Raises TaskError, OvertakenError.
        """
        with self._turn(group) as question:
            try:
                if question.worker is None:
                    raise OvertakenError
                return self._answered(question, (name, arguments), patience, lambda *_: None)
            except TaskError as error:
                if question.is_overtaken:
                    raise OvertakenError from error
                raise

    @contextmanager
    def _turn(self, group: str) -> Iterator[Question]:
        """Wait for a free worker, and give the question with it, or without one where it was overtaken."""
        question = Question(group)
        with self._gate:
            self._overtake(group)
            self._asked.append(question)
            self._gate.wait_for(lambda: self.closed or question.is_overtaken or self._answering() < self._quick)
            try:
                if not question.is_overtaken:
                    question.worker = self._take()
            except BaseException:
                self._asked.remove(question)
                raise
        try:
            yield question
        finally:
            worker = question.worker
            if worker is not None and worker.memory > MOST_KEPT_MEMORY:
                worker.end("it holds too much memory")
            with self._gate:
                self._asked.remove(question)
                question.worker = None
                if worker is not None and not worker.why:
                    self._idle.insert(0, worker)  # a worker that has read a model before is the quickest
                self._gate.notify_all()
            self._refill()

    def _overtake(self, group: str) -> None:
        for question in self._asked:
            if group and question.group == group and not question.is_overtaken:
                question.is_overtaken = True
                timer = threading.Timer(OVERTAKEN, self._give_up, [question])
                timer.daemon = True
                timer.start()
        self._gate.notify_all()

    def _give_up(self, question: Question) -> None:
        with self._gate:  # a worker that has answered in the meantime may be asked something else
            worker = question.worker
            is_condemned = worker is not None and worker.condemn("a newer question took the place of this one")
        if worker is not None and is_condemned:
            worker.finish()

    # Jobs

    def start(self, name: str, title: str, about: str, /, **arguments: Any) -> Job:
        """Begin a job in a process of its own. Raises UsageError where too many wait already."""
        job = Job(name, title, about)
        with self._gate:
            if len(self._queue) >= MOST_WAITING:
                raise UsageError(f"{MOST_WAITING} jobs wait already; cancel one, or wait for one to end")
            self._forget()
            self.jobs[job.ident] = job
            self._queue.append((job, arguments))
            self._begin_next()
        return job

    def _forget(self) -> None:
        """Forget the oldest jobs that are over, as far as too many, or too large answers, are remembered."""
        over = [job for job in self.jobs.values() if job.is_over]
        size = sum(job.size for job in over)
        for job in over:
            if len(self.jobs) < KEPT_JOBS and size <= KEPT_BYTES:
                break
            size -= job.size
            del self.jobs[job.ident]

    def _begin_next(self) -> None:
        """Begin the jobs that may run, and say the others their place; called within the gate."""
        while self._queue and sum(job.status == "runs" for job in self.jobs.values()) < MOST_JOBS and not self.closed:
            job, arguments = self._queue.popleft()
            job.status, job.stage = "runs", ""
            threading.Thread(target=self._do, args=(job, arguments), daemon=True).start()
        for place, (job, _) in enumerate(self._queue, start=1):
            job.stage = f"waits, number {place} in the queue"
        self.changes += 1

    def _do(self, job: Job, arguments: dict[str, Any]) -> None:
        def progress(stage: str, done: int, total: int) -> None:
            job.stage, job.done, job.total = stage, done, total
            self.changes += 1

        try:
            with self._gate:
                job.worker = self._take()
            self._refill()
            if job.status == "runs":
                self._finish(job, self._answered(job, (job.name, arguments), LONGEST_JOB, progress))
        except TaskError as error:
            if job.status == "runs":
                job.faults, job.status = error.faults, "failed"
        finally:
            if job.worker is not None:
                job.worker.end("the job is over")
                if job.status != "done":
                    tidy(self._root)
            with self._gate:
                job.worker = None
                self._begin_next()

    def _finish(self, job: Job, answer: Any) -> None:
        size = len(json.dumps(answer))
        if job.status != "runs":
            return
        if size > LARGEST_RESULT:
            job.faults = [fault_of(f"the answer of the job is larger than {LARGEST_RESULT // 1000} kB")]
            job.status = "failed"
        else:
            job.answer, job.size, job.status = answer, size, "done"

    def cancel(self, ident: str) -> bool:
        """End a job that waits or runs; tell whether there was one."""
        with self._gate:
            job = self.jobs.get(ident)
            if job is None or job.is_over:
                return False
            job.status, job.stage = "cancelled", ""
            self._queue = deque(each for each in self._queue if each[0] is not job)
            worker = job.worker
            self._begin_next()
        if worker is not None:
            threading.Thread(target=worker.end, args=("it was cancelled",), kwargs={"gently": True}).start()
        return True

    def close(self) -> None:
        """End every process; more than once does no harm."""
        with self._gate:
            self.closed = True
            for job, _ in self._queue:
                job.status = "cancelled"
            self._queue.clear()
            ending = [
                threading.Thread(target=worker.end, args=("the workbench has ended",), kwargs={"gently": True})
                for worker in self._all
            ]
            self.changes += 1
            self._gate.notify_all()
        for thread in ending:
            thread.start()
        for thread in ending:
            thread.join()
        self._orphans.close()
        tidy(self._root)
