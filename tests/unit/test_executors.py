"""Where batches are computed: the order of the answers, lost workers, and setups that travel as plain data."""

import os
import time
from dataclasses import replace
from pathlib import Path

import pytest
from study_models import CHAIN, WEAR, setup_of

from truing.declare.spreads import Off
from truing.errors import PluginError, TruingError, UsageError
from truing.executors import ProcessExecutor, SerialExecutor, in_order, open_executor
from truing.kernel import kernel_for
from truing.packed import pack, unpack
from truing.setup import SwitchedOn, default_setup


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


@pytest.fixture(scope="module")
def two():
    with open_executor("processes:2") as executor:
        yield executor


def test_answers_come_in_the_order_of_the_jobs(two):
    expected = [number * number for number in range(40)]
    assert list(in_order(two, slow_when_even, range(40))) == expected
    assert list(in_order(SerialExecutor(), slow_when_even, range(6))) == expected[:6]


@pytest.mark.parametrize("serial", [True, False])
def test_an_error_is_raised_where_it_stands_in_the_order(two, serial):
    answers = in_order(SerialExecutor() if serial else two, fail_at_three, range(10))
    assert [next(answers) for _ in range(3)] == [0, 1, 2]
    with pytest.raises(ValueError, match="three"):
        next(answers)


def test_jobs_are_made_when_they_are_needed():
    made = []

    def jobs():
        for number in range(1000):
            made.append(number)
            yield number

    answers = in_order(SerialExecutor(), fail_at_three, jobs())
    next(answers)
    assert len(made) == 1


def test_a_lost_worker_changes_the_time_and_not_the_result(tmp_path):
    marker = str(tmp_path / "met")
    with open_executor("processes:2") as executor:
        assert list(in_order(executor, die_once, [(number, marker) for number in range(8)])) == list(range(8))
        assert isinstance(executor, ProcessExecutor)
        assert executor.losses == 1


def test_workers_that_die_again_and_again_end_the_run():
    with open_executor("processes:1") as executor, pytest.raises(TruingError, match="without an answer"):
        list(in_order(executor, die, range(2)))


@pytest.mark.parametrize(
    "address", ["", "parallel", "processes", "processes:0", "processes:-1", "processes:two", "dask:x"]
)
def test_an_unknown_place_is_one_sentence(address):
    with pytest.raises(UsageError, match="write serial, processes:4 or dask:tcp://host:8786"):
        open_executor(address)


def test_a_setup_survives_packing():
    on = SwitchedOn(CHAIN.effects["grow"], {"strain": 1e-4}, {"strain": 4e-4}, ((1.6e-7,),))
    setup = replace(
        setup_of(CHAIN, first="31 mm"), effects=(on,), conditions={"warmth": 300.0}, seed=0, calibrated={"first": 0.03},
    )  # fmt: skip
    setup = replace(setup, spreads={**setup.spreads, "third": Off()})
    again = unpack(pack(setup))
    assert again.inputs == setup.inputs
    assert again.spreads == setup.spreads
    assert again.conditions == setup.conditions
    assert again.seed == 0
    assert again.calibrated == setup.calibrated
    assert [(item.effect.name, item.values, item.sds, item.covariance) for item in again.effects] == [
        (item.effect.name, item.values, item.sds, item.covariance) for item in setup.effects
    ]


def test_what_is_packed_is_plain_and_small():
    packed = pack(setup_of(WEAR))
    assert b"study_models" not in packed.content  # no class and no function of the plugin travels
    assert len(packed.content) < 2000
    assert hash(packed) == hash(pack(setup_of(WEAR)))


def test_a_plugin_in_one_file_reaches_the_workers(tmp_path):
    file = tmp_path / "lone_file.py"
    file.write_text(Path(__file__).with_name("study_models.py").read_text())
    kernel = kernel_for(f"file:{file}")
    offer = next(offer for offer in kernel.offers.values() if offer.model.name == "chain")
    packed = pack(default_setup(offer.model, offer.origin, first="29 mm"))
    assert unpack(packed).inputs.first == pytest.approx(0.029)


def test_a_model_that_a_worker_cannot_find_is_named():
    packed = replace(pack(setup_of(CHAIN)), model="chian")
    with pytest.raises(PluginError, match="no model 'chian' in module:study_models"):
        unpack(packed)
