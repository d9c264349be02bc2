"""Where batches are computed: the order of the answers, lost workers, and setups that travel as plain data."""

import math
import os
import pickle
import struct
import time
import zlib
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from study_models import CHAIN, setup_of

from truing.declare.spreads import Off
from truing.errors import LostWorkersError, PluginError, UsageError
from truing.executors import (
    BatchLog,
    SerialExecutor,
    WorkerPool,
    in_order,
    open_executor,
    processes,
    stays_here,
)
from truing.executors.cluster import differences
from truing.executors.kept import HEAD, MAGIC, answer_of, key_of, text_of
from truing.packed import pack, unpack
from truing.setup import SwitchedOn
from truing.studies.sampling import Moments


def slow_when_even(number: int) -> int:
    time.sleep(0.02 if number % 2 == 0 else 0)
    return number * number


def fail_at_three(number: int) -> int:
    if number == 3:
        raise ValueError("three")
    return number


def die_once(job: tuple[int, str]) -> int:
    """End the worker without a word the first time number 2 is met."""
    number, marker = job
    if number == 2 and not Path(marker).exists():
        Path(marker).write_text("met")
        os._exit(1)
    return number


def die(_: int) -> int:
    os._exit(1)


def test_answers_and_errors_come_in_the_order_of_the_jobs(two_processes):
    """Also where the executor is any other one; jobs are made when they are needed."""
    with ThreadPoolExecutor(2) as threads:
        for place in (SerialExecutor(), two_processes, threads):
            assert list(in_order(place, slow_when_even, range(8))) == [number * number for number in range(8)]
            answers = in_order(place, fail_at_three, range(10))
            assert [next(answers) for _ in range(3)] == [0, 1, 2]
            with pytest.raises(ValueError, match="three"):
                next(answers)
    jobs = iter(range(1000))
    next(in_order(SerialExecutor(), fail_at_three, jobs))
    assert next(jobs) == 1


def test_a_lost_worker_changes_the_time_and_not_the_result(tmp_path, monkeypatch):
    """Those that die again and again end the run."""
    monkeypatch.setattr(processes, "MOST_LOSSES", 1)
    marker = str(tmp_path / "met")
    with open_executor("processes:1") as executor:
        assert list(in_order(executor, die_once, [(number, marker) for number in range(8)])) == list(range(8))
        assert executor.losses == 1
        with pytest.raises(LostWorkersError, match="2 times without an answer"):
            list(in_order(executor, die, range(2)))


def test_an_unknown_place_is_one_sentence():
    for address in ("", "parallel", "processes", "processes:0", "processes:-1", "processes:two", "dask:x"):
        with pytest.raises(UsageError, match="write serial, processes:4 or dask:tcp://host:8786"):
            open_executor(address)


def test_a_setup_survives_packing():
    on = SwitchedOn(CHAIN.effects["grow"], {"strain": 1e-4}, {"strain": 4e-4}, ((1.6e-7,),))
    setup = replace(
        setup_of(CHAIN, first="31 mm"), effects=(on,), conditions={"warmth": 300.0}, seed=0, calibrated={"first": 0.03},
    )  # fmt: skip
    setup = replace(setup, spreads={**setup.spreads, "third": Off()})
    packed = pack(setup)
    assert b"study_models" not in packed.content  # no class and no function of the plugin travels
    assert len(packed.content) < 2000
    assert hash(packed) == hash(pack(replace(setup)))
    again = unpack(packed)
    for name in ("inputs", "spreads", "conditions", "seed", "calibrated"):
        assert getattr(again, name) == getattr(setup, name)
    (grow,) = again.effects
    assert (grow.effect.name, grow.values, grow.sds, grow.covariance) == ("grow", on.values, on.sds, on.covariance)
    with pytest.raises(PluginError, match="no model 'chian' in module:study_models"):
        unpack(replace(packed, model="chian"))


# ---- short jobs travel together -----------------------------------------------------------------------------------


class Travel(WorkerPool):
    """A place which notes how many jobs came together, and pretends that each took ``seconds``."""

    where = "travel"
    moment = 1.0

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self.together: list[int] = []

    def submit(self, together: Callable, function: Callable, jobs: list) -> Future:
        self.together.append(len(jobs))
        timed: Future = Future()
        timed.set_result(replace(together(function, jobs), seconds=self.seconds * len(jobs)))
        return timed


def test_short_jobs_travel_together_and_long_ones_alone():
    short, long = Travel(0.1), Travel(1.1)
    assert list(in_order(short, abs, range(400))) == list(range(400))
    assert short.together[0] == 1
    assert max(short.together) == 10  # 1 s of jobs that take 0.1 s
    assert sum(short.together) == 400
    assert list(in_order(long, abs, range(100))) == list(range(100))
    assert set(long.together) == {1}


# ---- batches that are kept ----------------------------------------------------------------------------------------


def kept_here(log: BatchLog) -> WorkerPool:
    """Return a place to compute, this process, where answers are kept."""
    place = SerialExecutor()
    place.log = log
    return place


def counted(job: tuple[int, str]) -> int:
    """Note that it was called."""
    number, marker = job
    with Path(marker).open("a") as file:
        file.write("x")
    return number * 10


def test_what_was_answered_is_not_asked_again(tmp_path, monkeypatch, two_processes):
    marker = tmp_path / "calls"
    jobs = [(number, str(marker)) for number in range(12)]
    for finished, count in ((5, 5), (12, 12), (12, 12)):
        log = BatchLog(tmp_path / "log")
        monkeypatch.setattr(two_processes, "log", log)
        assert list(in_order(two_processes, counted, jobs[:finished])) == [number * 10 for number in range(finished)]
        log.close()
        assert len(marker.read_text()) == count
    assert log.resumed == 12


def test_a_torn_or_spoilt_end_is_cut_off(tmp_path):
    path = tmp_path / "log"
    log = BatchLog(path)
    for number in range(3):
        log.put(key_of(abs, number), {"answer": number})
    log.close()
    whole = path.read_bytes()
    length = len(whole) // 3
    for cut in (1, 47, 48, length - 1):  # in the head of the last record and in its content
        path.write_bytes(whole[: 2 * length + cut])
        log = BatchLog(path)
        assert len(log) == 2
        assert [log.kept(key_of(abs, number)) for number in (1, 2)] == [[{"answer": 1}], []]
        log.put(key_of(abs, 2), {"answer": 2})
        log.close()
        assert path.read_bytes() == whole
    spoilt = bytearray(whole)
    spoilt[length + 60] ^= 1
    path.write_bytes(spoilt)
    assert len(BatchLog(path)) == 1
    path.write_bytes(whole[: 2 * length] + struct.pack(">4s32sQI", b"TRB2", bytes(32), 2**62, 0))
    assert len(BatchLog(path)) == 2  # a length beyond the file is no length


def test_what_cannot_be_kept_is_said_and_does_not_end_the_run(tmp_path, monkeypatch):
    """An answer that is no data, and a full disk."""
    log = BatchLog(tmp_path / "log")
    place = kept_here(log)
    assert stays_here(SerialExecutor())
    assert not stays_here(place)  # what is kept is asked for as plain data
    assert list(in_order(place, Path, ["a"])) == [Path("a")]
    no_data = f"some finished batches are not kept for --resume: a {type(Path()).__name__} is no plain data"
    assert (len(log), log.remarks()) == (0, [no_data])

    def full(_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(log, "_append", full)
    assert list(in_order(place, abs, range(4))) == [0, 1, 2, 3]
    assert "finished batches are no longer kept for --resume: No space left on device" in log.remarks()
    assert len(log) == 0


class Planted:
    """What runs code where it is unpickled."""

    def __reduce__(self):
        return Path.touch, (Path("ran"),)


@pytest.mark.parametrize(
    "content",
    [
        pickle.dumps(Planted()),
        b'{"class": ["Path", {}]}',
        b'{"class": ["os.system", {"command": "touch ran"}]}',
        b'{"array": ["|O", [1], "C", "AAAAAAAAAAA="]}',
        b'{"array": ["<f8", [9], "C", "AAAAAAAAAAA="]}',
        b'{"tuple": 3}',
        b"[" * 100_000,
        b"\xff",
    ],
)
def test_a_planted_record_runs_no_code_and_is_computed_again(tmp_path, monkeypatch, content):
    """Whoever can write into the folder can plant a record with a right checksum; it stays data."""
    monkeypatch.chdir(tmp_path)
    key = key_of(abs, -3)
    record = HEAD.pack(MAGIC, key, len(content), zlib.crc32(content, zlib.crc32(key))) + content
    (tmp_path / "log").write_bytes(record)
    log = BatchLog(tmp_path / "log")
    assert len(log) == 1
    assert list(in_order(kept_here(log), abs, [-3])) == [3]
    assert log.resumed == 0
    assert not (tmp_path / "ran").exists()
    log.close()
    again = BatchLog(tmp_path / "log")  # what was computed has taken its place
    assert list(in_order(kept_here(again), abs, [-3])) == [3]
    assert again.resumed == 1


def test_answers_come_back_to_the_last_bit():
    """With their types, and the order of arrays in memory, on which the rounding of their sums depends."""
    rng = np.random.default_rng(5)
    arrays = [
        rng.normal(size=(3, 4)), np.asfortranarray(rng.normal(size=(3, 4))), rng.normal(size=(6, 8))[::2, ::3],
        np.array([0.1, -0.0, np.nan, np.inf]), np.zeros((0, 3)), np.array(["a", "µm"]), np.array([True, False]),
        np.array(7), rng.integers(0, 9, 5).astype("int16"),
    ]  # fmt: skip
    for array in arrays:
        back = answer_of(text_of(array))
        assert (back.dtype, back.shape, back.tobytes("A")) == (array.dtype, array.shape, array.tobytes("A"))
        assert back.flags.c_contiguous or back.flags.f_contiguous
        assert back.flags.writeable
    moments = Moments(3, np.float64(0.1), 0.2, -math.inf, None)
    plain = {"a": (1, [2.5e-308, "µ\ud800"]), 3: {}, "big": 2**80, "moments": moments}
    back = answer_of(text_of(plain))
    assert back == plain
    assert [type(back["moments"].mean), type(back["a"])] == [np.float64, tuple]


def test_equal_jobs_have_one_key_wherever_their_parts_lie():
    twice = "".join(["kn", "ee"])
    one = {"a": twice, "b": twice}
    two = {"a": "knee", "b": "".join(["k", "nee"])}
    assert pickle.dumps(one) != pickle.dumps(two)
    assert key_of(abs, one) == key_of(abs, two)
    assert key_of(abs, one) != key_of(len, one)
    assert key_of(abs, one) != key_of(abs, {**one, "a": "elbow"})


# ---- versions -----------------------------------------------------------------------------------------------------


def test_other_versions_are_named_with_the_worker():
    here = {"python": "3.12.1", "numpy": "2.1.0", "the code of wear": "ab"}
    may = "the results may differ from those of this machine"
    assert differences(here, {"tcp://a:1": dict(here), "tcp://b:1": dict(here)}) == []
    assert differences(here, {"tcp://a:1": here, "tcp://b:1": {**here, "numpy": "2.0.0"}}) == [
        f"worker tcp://b:1 has numpy 2.0.0, here it is 2.1.0: {may}"
    ]
    old = {"python": "3.11.7", "numpy": "", "the code of wear": "cd"}
    assert differences(here, {"tcp://b:1": old, "tcp://c:1": old}) == [
        f"worker tcp://b:1 and 1 more has python 3.11.7, here it is 3.12.1: {may}",
        f"worker tcp://b:1 and 1 more has numpy missing, here it is 2.1.0: {may}",
        f"the code of wear is not the same on worker tcp://b:1 and 1 more as here: {may}",
    ]
