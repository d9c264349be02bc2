"""Moving models that are declared wrongly, records that no motion can follow, machines that come to no end."""

from __future__ import annotations

import json
import tracemalloc
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from kettle import HEATING, KETTLE, Water
from refusals import listing

from shared import TESTS, Calc
from truing import Float
from truing.evaluate import evaluate
from truing.setup import default_setup

KETTLE_LINE = 39
"""Where the kettle declares its state."""
OFFERED = """

from truing import hookimpl


@hookimpl
def truing_models():
    return [KETTLE]
"""
STATED = """[inputs]
times = ["0 s", "10 s", "20 s"]
power = ["1000 W", "1000 W", "1000 W"]
"""


@pytest.fixture
def desk(tmp_path: Path) -> Path:
    """A folder with the kettle, a bouncing ball, a reaction that runs away, and inputs."""
    kettle = (TESTS / "data" / "kettle.py").read_text(encoding="utf-8")
    bounded = kettle.replace('start: Float = given(20.0, "degC",', 'start: Float = given(20.0, "degC", at_most=100,')
    (tmp_path / "kettle.py").write_text(bounded + OFFERED, encoding="utf-8")
    for name in ("bouncing_ball", "runaway"):
        (tmp_path / f"{name}.py").write_bytes((TESTS / "data" / f"{name}.py").read_bytes())
    (tmp_path / "inputs.toml").write_text(STATED, encoding="utf-8")
    (tmp_path / "empty.toml").write_text("[inputs]\n", encoding="utf-8")
    return tmp_path


DECLARED: list[tuple[str, str, str]] = [
    ('"degC", start="start"', 'start="start"', "TypeError: state() missing 1 required positional argument: 'unit'"),
    ('"degC", start="start"', '"degCC", start="start"', "state 'temperature' is declared in 'degCC': unknown unit"),
    (
        "(temperature - room)) / capacity",
        "(temperature - room))",
        "the rate of state 'temperature' ((power - loss * (temperature - room))) gives [mass] * [length] ** 2 / [time] "
        "** 3, not [temperature]/[time] ('K/s')",
    ),
    ("(temperature - room)", "(temperature - loss)", "the rate of state 'temperature' cannot be: formula "),
    ('start="start"', 'start="capacity"', "state 'temperature' is in 'degC' and starts at 'capacity', which is in "),
    ('start="start"', 'start="20 kg"', "the start of state 'temperature': '20 kg' is a mass (kg), expected a "),
]


@pytest.mark.parametrize(("written", "instead", "sentence"), DECLARED, ids=[instead for _, instead, _ in DECLARED])
def test_a_wrong_declaration_is_refused_with_file_and_line(
    desk: Path, calc: Calc, written: str, instead: str, sentence: str
) -> None:
    text = (desk / "kettle.py").read_text(encoding="utf-8")
    assert written in text
    (desk / "kettle.py").write_text(text.replace(written, instead), encoding="utf-8")
    before = listing(desk)
    answer = calc("run", "kettle.py", "-i", "inputs.toml", "-o", "out")
    assert (answer.code, answer.out, listing(desk)) == (3, "", before)
    said = answer.err.splitlines()[0]
    assert said.removeprefix(f"{desk}/").startswith(f"kettle.py:{KETTLE_LINE}: plugin 'kettle': ") or ":38: " in said
    assert sentence in said


DRIVEN = "but a motion is driven by one value at each time"
REFUSED: list[tuple[str, str, list[str]]] = [
    (
        "time [s],power [W]\n0,1\n10,1\n10,2\n20,1\n20,1\n",
        "table kettle.py -i inputs.toml --rows rows.csv -o out.csv",
        [f"rows.csv:4: time is 10 s again with another power, {DRIVEN}: leave one of them out"],
    ),
    (
        "time [s],power [W],warm [degC]\n0,1,20\n10,1,20\n10,2,20\n20,1,20\n20,1,20\n",
        "diagnose kettle.py -i inputs.toml --data rows.csv -o out",
        [f"rows.csv:4: time is 10 s again with another power, {DRIVEN}: leave one of them out"],
    ),
    (
        "run,time [s],power [W]\na,0,1\na,30,1\na,10,1\nb,0,1\nb,,1\nb,10,\n",
        "table kettle.py -i inputs.toml --rows rows.csv -o out.csv",
        [
            "rows.csv:4: time falls from 30 s to 10 s within a record: sort its rows, or tell records apart by a ",
            f"rows.csv:6: time is empty, {DRIVEN}: fill it in, or leave the row out",
            f"rows.csv:7: power is empty, {DRIVEN}: fill it in, or leave the row out",
        ],
    ),
    (
        "time [s]\n0\n10\n20\n30\n",
        "table kettle.py -i inputs.toml --rows rows.csv -o out.csv",
        ["inputs.toml:3: power has 3 values at 4 times; give one for each, of rows of a file in a column of that "],
    ),
    (
        "time [s],warm [degC]\n0,20\n10,20\n20,20\n30,20\n",
        "diagnose kettle.py -i inputs.toml --data rows.csv -o out",
        ["inputs.toml:3: power has 3 values at 4 times; give one for each, of rows of a file in a column of that "],
    ),
    (
        "run,time [s],power [W],start [degC]\na,0,1,20\na,9,1,20\nb,0,1,120\nb,9,1,120\n",
        "table kettle.py -i inputs.toml --rows rows.csv -o out.csv",
        [f"rows.csv:{line}: start is 120 degC; it must be at most 100 degC" for line in (4, 5)],
    ),
    (
        "",
        "run kettle.py -i inputs.toml --set start=120degC -o out",
        ["--set start=120degC: start is 120 degC; it must be at most 100 degC"],
    ),
    (
        "",
        "run bouncing_ball.py -i empty.toml -o out --set times=['0s','3s']",
        [
            "--set times=['0s','3s']: the motion cannot be followed beyond t = 1.3548 s: the event 'bounces' comes "
            "again and again without end; end the motion there (ends=True), or let the event set a state in which the "
        ],
    ),
    (
        "",
        "run runaway.py -i empty.toml --set start=20 -o out",
        ["--set start=20: the motion cannot be followed beyond t = 0.5 s: a state grows beyond all bounds"],
    ),
]


@pytest.mark.parametrize(("rows", "words", "sentences"), REFUSED, ids=[sentences[0] for *_, sentences in REFUSED])
def test_what_cannot_be_followed_is_refused_and_leaves_nothing(
    desk: Path, calc: Calc, rows: str, words: str, sentences: list[str]
) -> None:
    (desk / "rows.csv").write_text(rows, encoding="utf-8")
    before = listing(desk)
    answer = calc(*words.split())
    assert (answer.code, answer.out, listing(desk)) == (2, "", before)
    said = answer.err.splitlines()
    assert len(said) == len(sentences)
    assert all(line.startswith(sentence) for line, sentence in zip(said, sentences, strict=True)), said


def test_the_step_limit_ends_with_exit_code_4(desk: Path, calc: Calc) -> None:
    text = (desk / "runaway.py").read_text(encoding="utf-8")
    (desk / "runaway.py").write_text(text.replace("gives=reacted", "gives=reacted, most_steps=1"), encoding="utf-8")
    before = listing(desk)
    answer = calc("run", "runaway.py", "-i", "empty.toml", "-o", "out")
    assert (answer.code, answer.out, listing(desk)) == (4, "", before)
    assert "the step limit is reached; a coarser tolerance or a larger most_steps would let it go on" in answer.err


# What is left out is named and counted, and the others go on


RUNS = "run,time [s],start\na,0,1\na,1,1\nb,0,20\nb,1,20\nc,0,2\nc,1,2\n"
BLOWN = "the motion cannot be followed beyond t = 0.5 s: a state grows beyond all bounds"


def test_a_machine_that_blows_up_is_named_and_counted_and_the_others_go_on(desk: Path, calc: Calc) -> None:
    """y' = y^2 / 10 s from y0 is y0 / (1 - y0 t / 10 s)."""
    (desk / "rows.csv").write_text(RUNS, encoding="utf-8")
    answer = calc("table", "runaway.py", "-i", "empty.toml", "--rows", "rows.csv", "-o", "out.csv")
    assert answer.code == 0
    said = answer.err.splitlines()
    assert said == [*(f"rows.csv:{line}: {BLOWN}" for line in (4, 5)), "wrote out.csv: 6 rows, 2 of them failed"]
    heat = [line.split(",")[-2] for line in (desk / "out.csv").read_text(encoding="utf-8").splitlines()[1:]]
    assert heat[2:4] == ["", ""]
    assert [float(heat[row]) for row in (1, 5)] == pytest.approx([1 / 0.9, 2 / 0.8])
    (desk / "cases.csv").write_text("case,start\na,1\nb,20\nc,2\n", encoding="utf-8")
    answer = calc("run", "runaway.py", "-i", "empty.toml", "--cases", "cases.csv", "-o", "out")
    assert answer.code == 1
    assert "1 left out: line 3 (cannot be calculated: the motion cannot be followed beyond t = 0.5 s" in answer.out


def test_what_fails_in_many_rows_is_said_once(desk: Path, calc: Calc) -> None:
    (desk / "rows.csv").write_text("time [s]\n" + "".join(f"{row}\n" for row in range(20)), encoding="utf-8")
    answer = calc("table", "runaway.py", "-i", "empty.toml", "--rows", "rows.csv", "--set", "start=20")
    assert answer.err.splitlines() == [
        f"rows.csv:2: {BLOWN} (so it is in 19 rows more, the last in line 21)",
    ]


def test_a_record_of_three_readings_and_one_with_a_machine_that_blows_up_are_diagnosed(desk: Path, calc: Calc) -> None:
    (desk / "three.csv").write_text("time [s],heat\n0,1\n1,1.11\n2,1.26\n", encoding="utf-8")
    answer = calc("diagnose", "runaway.py", "-i", "empty.toml", "--data", "three.csv", "-o", "three")
    assert answer.code == 0
    assert "3 readings tell no cause from chance" in answer.err
    assert json.loads((desk / "three" / "diagnosis.json").read_text(encoding="utf-8"))["rows"] == 3
    rows = "".join(
        f"{run},{time},{start},{start / (1 - start * time / 10):.4f}\n"
        for run, start in (("a", 1), ("b", 2))
        for time in (0, 1, 2, 3)
    )
    (desk / "four.csv").write_text(f"run,time [s],start,heat\n{rows}c,0,20,20\nc,1,20,30\n", encoding="utf-8")
    answer = calc("diagnose", "runaway.py", "-i", "empty.toml", "--data", "four.csv", "-o", "four")
    assert answer.code == 0
    assert f"10 rows, 8 used; 2 left out: lines 10, 11 (the model fails: {BLOWN})" in answer.err


# Long records


def test_a_million_times_take_little_more_memory_than_what_is_answered() -> None:
    setup = default_setup(KETTLE, times=np.linspace(0, 1000, 1_000_000), power=np.array([1000.0]))
    tracemalloc.start()
    try:
        warm = evaluate(setup).warm
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert warm[-1] - 293.15 == pytest.approx(100 * (1 - np.exp(-2.5)), rel=1e-7)
    assert most < 8 * warm.nbytes


def counting(counts: list[int]) -> Callable[[Water, object, Float], Water]:
    """Return the rate of the kettle, which counts how often it is asked."""

    def rate(water: Water, kettle: object, time: Float) -> Water:
        counts[0] += 1
        return HEATING.law(water, kettle, time)  # type: ignore[arg-type]

    rate.__annotations__ = HEATING.law.__annotations__
    return rate


def test_only_times_at_which_a_drive_changes_end_a_step() -> None:
    """A heater that is switched off once: two stretches of 50,000 times each are two short motions."""
    power, counts = np.where(np.arange(100_001) < 50_000, 1000.0, 0.0), [0]
    law = replace(HEATING, rate=counting(counts))
    setup = default_setup(replace(KETTLE, function=law), times=np.linspace(0, 2000, 100_001), power=power)
    warm = evaluate(setup).warm
    end = 100 * (1 - np.exp(-2.5)) * np.exp(-2.5)
    assert warm[-1] - 293.15 == pytest.approx(end, rel=1e-6)
    assert counts[0] < 1000
