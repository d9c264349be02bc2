"""A run that was killed goes on from its finished batches, and answers as if nobody had disturbed it."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
from pathlib import Path

import pytest
from gated import BATCHES, FREE, Gated, run_of, wait_until
from measured import calc_here
from test_interrupt import SEES_CHILDREN, children_of, is_alive

from shared import Answer, Calc
from truing.api import run
from truing.errors import OutputError
from truing.studies import sampling

fcntl = pytest.importorskip("fcntl", reason="a console signal there stops the test too")

PIN = Path(__file__).parents[1] / "data" / "pin_wear.py"
SMALL = (
    "run", PIN, "-q", "--set", 'studies.run=["reliability"]',
    "--set", "studies.reliability.draws=60000", "--set", "studies.reliability.batch=16384",
)  # fmt: skip


def test_a_killed_run_goes_on_where_it_was(calc: Calc, tmp_path: Path) -> None:
    """Killed with two processes, interrupted with one, completed with one: no finished batch is computed twice."""
    pin = Gated.in_folder(tmp_path)
    process = pin.start("-o", "run", "--resume", "--workers", "2")
    pin.at_the_gate(process, FREE + 2)  # each of the two workers holds a batch
    wait_until(lambda: pin.kept("run") == FREE, "the others are kept")
    children = children_of(process.pid) if SEES_CHILDREN else []
    os.kill(process.pid, signal.SIGKILL)
    process.ended()
    wait_until(lambda: not any(map(is_alive, children)), "the workers end with the process that started them")
    assert not (tmp_path / "run").exists()

    process = pin.start("-o", "run", "--resume", "-q")
    pin.at_the_gate(process, FREE + 3)
    process.signal(signal.SIGINT)
    words = "calc: interrupted; finished batches are kept in run.partial, the same command goes on from there\n"
    assert process.ended() == Answer(130, "", words)
    with (tmp_path / "run.partial" / "batches.log").open("ab") as torn:
        torn.write(b"TRB2 the power failed here")

    pin.open()
    before = pin.calls
    answer = pin.start("-q", "-o", "run", "--resume").ended()
    assert answer.code == 0, answer.err
    assert run_of(tmp_path / "run")["resumed"] == FREE
    assert pin.calls - before == BATCHES - FREE
    assert not (tmp_path / "run.partial").exists()
    assert calc(*pin.words, "-q", "-o", "whole").code == 0
    assert run_of(tmp_path / "whole")["resumed"] == 0
    assert (tmp_path / "run/results.json").read_bytes() == (tmp_path / "whole/results.json").read_bytes()


@pytest.fixture(scope="module")
def failed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run that failed at the very end, when every batch was finished."""
    folder = tmp_path_factory.mktemp("failed")
    with pytest.MonkeyPatch.context() as broken:

        def full(*_: object, **__: object) -> None:
            raise OutputError("the disk is full")

        broken.setattr(run, "write_outcome", full)
        assert calc_here(folder, *SMALL, "-o", "run", "--resume").code == 2
    assert (folder / "run.partial" / "batches.log").stat().st_size > 0
    return folder


@pytest.fixture
def unfinished(failed: Path, tmp_path: Path) -> Path:
    """A copy of it."""
    shutil.copytree(failed, tmp_path, dirs_exist_ok=True)
    return tmp_path


def test_all_batches_are_taken_up_and_none_is_computed(
    calc: Calc, unfinished: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert calc(*SMALL, "-o", "whole").code == 0
    monkeypatch.setattr(sampling, "_unpacked", None)  # computing a batch would call it
    answer = calc(*(word for word in SMALL if word != "-q"), "-o", "run", "--resume")
    assert answer.code == 0
    assert "4 finished batches of an interrupted run were taken up\n" in answer.err
    assert run_of(unfinished / "run")["resumed"] == 4
    assert (unfinished / "run/results.json").read_bytes() == (unfinished / "whole/results.json").read_bytes()
    assert not (unfinished / "run.partial").exists()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ('load="121 N"', "other inputs"),
        ("seed=7", r"another seed \(0, now 7\)"),
        ("studies.reliability.draws=60001", "other inputs"),
        ("version of numpy", r"another version of numpy \(0.1, now [\d.]+\)"),
        ("code of pin_wear.py", "other code of pin_wear.py"),
        ("code of truing", "other code of truing"),
    ],
)
def test_batches_of_another_run_are_refused(calc: Calc, unfinished: Path, change: str, said: str) -> None:
    """Of other inputs (``--set``), or of another version than the header of the batches states."""
    header, more = unfinished / "run.partial" / "partial.json", ["--set", change]
    content = json.loads(header.read_text(encoding="utf-8"))
    if change in content:
        more = []
        header.write_text(json.dumps({**content, change: "0.1"}), encoding="utf-8")
    before = (unfinished / "run.partial/batches.log").read_bytes()
    answer = calc(*SMALL, *more, "-o", "run", "--resume")
    assert answer.code == 2
    sentence = f"run.partial: holds finished batches of a run with {said}; run that one again, or remove the folder"
    assert re.fullmatch(f"calc: {sentence}\n", answer.err)
    assert (unfinished / "run.partial/batches.log").read_bytes() == before


def test_without_resume_batches_are_neither_read_nor_touched(calc: Calc, unfinished: Path) -> None:
    before = (unfinished / "run.partial/batches.log").read_bytes()
    plain = calc(*(word for word in SMALL if word != "-q"), "--set", "seed=7", "-o", "run")
    assert plain.code == 0
    note = "note: run.partial holds finished batches of an interrupted run; --resume would take them up\n"
    assert note in plain.err
    assert (unfinished / "run.partial/batches.log").read_bytes() == before


def test_two_runs_do_not_share_their_batches(calc: Calc, unfinished: Path) -> None:
    with (unfinished / "run.partial" / "lock").open("a") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        answer = calc(*SMALL, "-o", "run", "--resume")
        assert answer.code == 2
        assert answer.err == "calc: run.partial: is in use by another run; wait for it, or name another --output\n"
    assert calc(*SMALL, "-o", "run", "--resume").code == 0  # whoever held it is gone, and so is the hold


def test_a_folder_of_somebody_else_is_left_alone(calc: Calc, tmp_path: Path) -> None:
    (tmp_path / "run.partial").mkdir()
    (tmp_path / "run.partial" / "thesis.txt").write_text("mine")
    answer = calc(*SMALL, "-o", "run", "--resume")
    assert answer.code == 2
    assert answer.err == "calc: run.partial: holds 'thesis.txt', so it is none of ours; name another --output\n"
    assert [path.name for path in (tmp_path / "run.partial").iterdir()] == ["thesis.txt"]


def test_nothing_is_kept_of_a_run_that_never_began(calc: Calc, tmp_path: Path) -> None:
    answer = calc(*SMALL, "--set", 'load="900 kN"', "-o", "deep/down/run", "--resume")
    assert answer.code == 2
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not SEES_CHILDREN, reason="needs /proc to find the workers")
def test_a_worker_that_is_killed_changes_nothing_but_the_warning(calc: Calc, tmp_path: Path) -> None:
    pin = Gated.in_folder(tmp_path)
    process = pin.start("-o", "run", "--workers", "2")
    pin.at_the_gate(process, FREE + 2)
    workers = children_of(process.pid)
    assert len(workers) == 2
    os.kill(workers[0], signal.SIGKILL)
    pin.open()
    answer = process.ended()
    assert answer.code == 0, answer.err
    lost = "a worker process ended without an answer once; its batches were computed again, the results are the same"
    assert f"warning: {lost}\n" in answer.err
    run = run_of(tmp_path / "run")
    assert run["workers"] == {"count": 2, "lost": 1, "where": "processes"}
    assert run["warnings"] == [lost]
    assert calc(*pin.words, "-q", "-o", "whole").code == 0
    assert (tmp_path / "run/results.json").read_bytes() == (tmp_path / "whole/results.json").read_bytes()
