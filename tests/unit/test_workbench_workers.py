"""Workers of the workbench: whatever a model does to its process, the server goes on and says what it was.

Every deed is in ``hostile_tasks``.
"""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from truing.errors import UsageError
from truing.workbench.workers import MOST_WAITING, OvertakenError, TaskError, Workers

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="does to processes what only POSIX has")
MEMORY = 2**29


@pytest.fixture(scope="module")
def workers(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Workers]:
    made = Workers(MEMORY, tmp_path_factory.mktemp("served").resolve(), home="hostile_tasks")
    yield made
    made.close()


def eventually(is_so: Callable[[], Any], seconds: float = 5.0) -> bool:
    end = time.monotonic() + seconds
    while not is_so() and time.monotonic() < end:
        time.sleep(0.01)
    return bool(is_so())


def is_alive(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


ENDS = {
    "loop_in_python": "the calculation did not answer within 0.5 s and was stopped",
    "loop_in_c": "the calculation did not answer within 0.5 s and was stopped",
    "deaf": "the calculation did not answer within 0.5 s and was stopped",
    "write_everywhere": "the calculation did not answer within 0.5 s and was stopped",
    "fork_away_and_hang": "the calculation did not answer within 0.5 s and was stopped",
    "abort": "the calculation crashed (Aborted)",
    "segfault": "the calculation crashed (Segmentation fault)",
    "kill_itself": "the calculation was killed by the system, perhaps because memory ran short",
    "leave": "the calculation ended without an answer (exit code 3)",
    "close_everything": "the calculation ended without an answer (exit code 0)",
}
FAILS = {
    "end_program": "the calculation ended itself (exit code 4)",
    "interrupt": "KeyboardInterrupt: ",
    "eat_memory": "the calculation asked for more memory than it may have; see calc serve --memory",
    "recurse": "RecursionError: maximum recursion depth exceeded",
    "answer_much": "the answer is larger than 8 MB",
    "answer_no_json": "the answer cannot be shown: TypeError: a object is no JSON",
}


@pytest.mark.parametrize("deed", ENDS)
def test_a_process_that_is_lost_is_one_sentence(workers: Workers, deed: str) -> None:
    began = time.monotonic()
    with pytest.raises(TaskError) as caught:
        workers.ask(f"deeds.{deed}", patience=0.5)
    assert str(caught.value) == ENDS[deed]
    assert workers.ask("deeds.echo", said=deed) == deed
    assert time.monotonic() - began < 3


@pytest.mark.parametrize("deed", FAILS)
def test_a_failure_is_one_sentence(workers: Workers, deed: str) -> None:
    with pytest.raises(TaskError) as caught:
        workers.ask(f"deeds.{deed}")
    assert str(caught.value).startswith(FAILS[deed])
    assert workers.ask("deeds.echo", said=deed) == deed


def test_a_long_complaint_is_cut(workers: Workers) -> None:
    with pytest.raises(TaskError) as caught:
        workers.ask("deeds.complain_much")
    assert 1000 < len(str(caught.value)) < 3000


def test_a_worker_that_ends_while_it_waits_is_not_asked(workers: Workers) -> None:
    assert eventually(lambda: len(workers._idle) > workers._quick)
    for worker in tuple(workers._idle):
        os.kill(worker._process.pid or 0, signal.SIGKILL)
    assert workers.ask("deeds.echo", said="at once") == "at once"  # before the server can know
    assert eventually(lambda: len(workers._idle) > workers._quick)
    for worker in tuple(workers._idle):
        os.kill(worker._process.pid or 0, signal.SIGKILL)
    assert eventually(lambda: not any(worker.works for worker in workers._idle))
    assert workers.ask("deeds.echo", said="later") == "later"


def test_what_is_printed_goes_nowhere(workers: Workers, capfd: pytest.CaptureFixture[str]) -> None:
    assert workers.ask("deeds.print_much") == "printed"
    assert capfd.readouterr() == ("", "")


def test_a_number_that_json_has_not_becomes_null(workers: Workers) -> None:
    assert workers.ask("deeds.answer_nan") == [None, None, 1.0]


def test_the_folder_is_put_back(workers: Workers) -> None:
    assert workers.ask("deeds.change_folder") == "/"
    assert workers.ask("deeds.where")[1] == str(workers._root)


def test_a_fork_answers_once(workers: Workers) -> None:
    for number in range(3):
        assert workers.ask("deeds.fork") > 0
        assert workers.ask("deeds.echo", said=number) == number


def test_only_public_functions_of_tasks_are_called(workers: Workers) -> None:
    for name in ("os.system", "deeds._hidden", "deeds", "deeds.threading.main_thread", "", "..deeds.echo"):
        with pytest.raises(TaskError):
            workers.ask(name)


def test_a_newer_question_ends_the_older(workers: Workers, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("truing.workbench.workers.OVERTAKEN", 0.3)
    said: list[str] = []

    def older() -> None:
        try:
            workers.ask("deeds.loop_in_c", group="page")
        except OvertakenError as error:
            said.append(str(error))

    threads = [threading.Thread(target=older) for _ in range(3)]
    for thread in threads:
        thread.start()
        time.sleep(0.05)
    began = time.monotonic()
    assert workers.ask("deeds.echo", said="newest", group="page") == "newest"
    assert time.monotonic() - began < 2
    for thread in threads:
        thread.join(3)
    assert said == ["a newer question took the place of this one"] * 3


def test_a_quick_question_is_not_ended_by_a_newer_one(workers: Workers) -> None:
    answers: list[int] = []
    threads = [
        threading.Thread(target=lambda number=number: answers.append(workers.ask("deeds.echo", said=number, group="p")))
        for number in range(2)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(5)
    assert 1 in answers


# Jobs


def test_a_job_begins_at_once_and_others_are_told_their_place(workers: Workers, tmp_path: Path) -> None:
    assert eventually(lambda: len(workers._idle) > workers._quick)
    began = time.monotonic()
    jobs = [
        workers.start("deeds.wait_for", f"job {number}", "a.toml", file=str(tmp_path / str(number)))
        for number in range(4)
    ]
    assert eventually((tmp_path / "0").exists)
    assert time.monotonic() - began < 0.5
    assert [job.status for job in jobs] == ["runs", "runs", "waits", "waits"]
    assert jobs[3].stage == "waits, number 2 in the queue"
    assert workers.cancel(jobs[2].ident)
    assert jobs[3].stage == "waits, number 1 in the queue"
    assert eventually((tmp_path / "1").exists)
    processes = [int((tmp_path / name).read_text()) for name in ("0", "1")]
    assert workers.cancel(jobs[0].ident)
    assert not workers.cancel(jobs[0].ident)
    assert workers.cancel(jobs[1].ident)
    assert eventually((tmp_path / "3").exists)
    assert not (tmp_path / "2").exists()
    assert workers.cancel(jobs[3].ident)
    assert eventually(lambda: not any(map(is_alive, processes)))
    assert [job.status for job in jobs] == ["cancelled"] * 4


def test_what_a_job_leaves_behind_ends_with_it(workers: Workers, tmp_path: Path) -> None:
    job = workers.start("deeds.fork_and_keep", "fork", "", file=str(tmp_path / "left"))
    assert eventually(lambda: job.is_over)
    assert job.answer == "forked"
    assert eventually(lambda: not is_alive(int((tmp_path / "left").read_text())))


def test_a_job_that_is_cancelled_takes_back_what_it_was_writing(workers: Workers, tmp_path: Path) -> None:
    job = workers.start("deeds.write_slowly", "write", "", file=str(tmp_path / "sheet"))
    assert eventually((tmp_path / "sheet.begun").exists)
    workers.cancel(job.ident)
    assert eventually(lambda: [path.name for path in tmp_path.iterdir()] == ["sheet.begun"])


def test_progress_is_bounded(workers: Workers) -> None:
    before = workers.changes
    job = workers.start("deeds.report", "report", "")
    assert eventually(lambda: job.is_over)
    assert (job.status, job.answer) == ("done", "reported")
    assert workers.changes - before < 100
    assert len(job.stage) <= 200
    assert job.stage.isprintable()


def test_a_job_whose_process_crashes_or_answers_too_much_has_failed(workers: Workers) -> None:
    crashed, large = (workers.start(f"deeds.{deed}", deed, "") for deed in ("segfault", "answer_much"))
    assert eventually(lambda: crashed.is_over and large.is_over)
    assert [job.faults[0]["message"] for job in (crashed, large)] == [ENDS["segfault"], FAILS["answer_much"]]


def test_finished_jobs_are_forgotten_by_number_and_by_size(workers: Workers) -> None:
    for _ in range(20):
        job = workers.start("deeds.echo", "large", "", said="x" * 250_000)
        assert eventually(lambda job=job: job.is_over)
    assert sum(job.size for job in workers.jobs.values()) < 4_600_000
    assert job.ident in workers.jobs


def test_a_queue_has_an_end(workers: Workers, tmp_path: Path) -> None:
    jobs = [workers.start("deeds.wait_for", "w", "", file=str(tmp_path / "w")) for _ in range(MOST_WAITING + 2)]
    with pytest.raises(UsageError, match="20 jobs wait already"):
        workers.start("deeds.echo", "one more", "")
    for job in reversed(jobs):
        workers.cancel(job.ident)
    assert eventually(lambda: not any(job.worker for job in jobs))


def test_nothing_is_left_after_the_end(tmp_path: Path) -> None:
    workers = Workers(MEMORY, tmp_path, home="hostile_tasks")
    said: list[str] = []

    def asked() -> None:
        try:
            workers.ask("deeds.deaf")
        except TaskError as error:
            said.append(str(error))

    thread = threading.Thread(target=asked)
    thread.start()
    job = workers.start("deeds.wait_for", "w", "", file=str(tmp_path / "job"))
    assert eventually((tmp_path / "job").exists)
    processes = [worker._process.pid for worker in workers._all]
    began = time.monotonic()
    workers.close()
    thread.join(2)
    assert time.monotonic() - began < 2
    assert said == ["the workbench has ended"]
    assert job.is_over or eventually(lambda: job.is_over)
    assert eventually(lambda: not any(map(is_alive, processes)))
    with pytest.raises(TaskError, match="has ended"):
        workers.ask("deeds.echo")
