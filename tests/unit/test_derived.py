"""Conditions that are history: made once from the rows of a file, in time order; and the table that shows them."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from truing import Condition, Effect, Float, Model, Unknown, found, given, inputs, results
from truing.errors import DeclarationError, InputError, UsageError
from truing.gauge import shown_by_gauge
from truing.inputs_file import setup_from_text
from truing.kernel import Offer, Origin
from truing.measurements import RowsFile, read_rows
from truing.measurements.derived import derive

NAN = math.nan


def history(derived: str, values: list[float], runs: list[int] | None = None, time: list[float] | None = None,
            unit: str = "mm") -> list[float]:  # fmt: skip
    """What an effect sees of these rows."""
    condition = Condition("it", unit, derived=derived)
    column = {condition.made_from: np.array(values)}
    clock = None if time is None else np.array(time)
    return derive(condition, column, None if runs is None else np.array(runs), clock).tolist()


# Each kind, by hand

KINDS: list[tuple[str, list[float], list[float]]] = [
    ("since_start", [5, 7, 4, 9], [0, 2, -1, 4]),
    ("running_maximum of x", [3, 1, 4, 1, 5], [3, 3, 4, 4, 5]),
    ("running_maximum of x", [-3, -1, -4], [-3, -1, -1]),
    ("cumulative of x", [0, 2, -1, -1, 4], [0, 2, 5, 5, 10]),
    ("direction of x", [0, 1, 2, 1, 1, 3], [1, 1, 1, -1, -1, 1]),
    ("direction of x", [2, 2, 2, 1], [-1, -1, -1, -1]),
    ("direction of x", [2, 2, 2], [0, 0, 0]),
    ("direction of x", [2], [0]),
    ("last_reversal of x", [0, 1, 2, 1, 0, 3], [0, 0, 0, 2, 2, 0]),
    ("last_reversal of x", [0, 1, 2, 2, 1], [0, 0, 0, 0, 2]),
    ("last_reversal of x", [7, 7, 7], [7, 7, 7]),
    ("last_reversal of x", [7], [7]),
]


@pytest.mark.parametrize(("derived", "values", "seen"), KINDS)
def test_what_has_been(derived: str, values: list[float], seen: list[float]) -> None:
    assert history(derived, values) == seen


# In time order, run by run


@pytest.mark.parametrize(("derived", "values", "seen"), KINDS)
def test_rows_out_of_order_are_the_same_rows(derived: str, values: list[float], seen: list[float]) -> None:
    order = np.random.default_rng(0).permutation(len(values))
    shuffled = history(derived, [values[row] for row in order], time=[60.0 * row for row in order])
    assert shuffled == [seen[row] for row in order]


def test_history_begins_anew_with_every_run_but_the_start_is_that_of_the_file() -> None:
    values, runs = [10.0, 1.0, 12.0, 3.0, 11.0, 2.0], [7, 3, 7, 3, 7, 3]
    assert history("running_maximum of x", values, runs) == [10, 1, 12, 3, 12, 3]
    assert history("cumulative of x", values, runs) == [0, 0, 2, 2, 3, 3]
    assert history("direction of x", values, runs) == [1, 1, 1, 1, -1, -1]
    assert history("last_reversal of x", values, runs) == [10, 1, 10, 1, 12, 3]
    assert history("since_start", values, runs) == [0, -9, 2, -7, 1, -8]


def test_the_earliest_row_of_the_file_is_the_start() -> None:
    assert history("since_start", [30, 10, 20], [1, 2, 2], [8.0, 6.0, 7.0]) == [20, 0, 10]
    assert history("since_start", [30, NAN, 20], time=[8.0, 6.0, 7.0])[::2] == [10, 0]
    assert history("since_start", [6.0, 8.0], time=[NAN, NAN]) == [0, 2]


def test_rows_without_a_time_come_last() -> None:
    assert history("cumulative of x", [1, 9, 2], time=[0.0, NAN, 1.0]) == [0, 8, 1]


# Missing values


@pytest.mark.parametrize(
    ("derived", "seen"),
    [
        ("since_start", [NAN, 0, NAN, 3, -1]),
        ("running_maximum of x", [NAN, 1, 1, 4, 4]),
        ("cumulative of x", [NAN, 0, 0, 3, 7]),
        ("direction of x", [1, 1, 1, 1, -1]),
        ("last_reversal of x", [NAN, 1, 1, 1, 4]),
    ],
)
def test_what_is_missing_is_passed_over(derived: str, seen: list[float]) -> None:
    np.testing.assert_array_equal(history(derived, [NAN, 1, NAN, 4, 0]), seen)


@pytest.mark.parametrize("word", ["running_maximum", "cumulative", "direction", "last_reversal"])
def test_where_nothing_is_measured_nothing_is_known(word: str) -> None:
    assert np.isnan(history(f"{word} of x", [NAN, NAN, 1.0], [1, 1, 2])).tolist() == [True, True, False]
    assert np.isnan(history("since_start", [NAN, NAN])).all()


def test_a_column_that_is_not_there() -> None:
    with pytest.raises(UsageError, match="condition 'way' is derived from 'travel', which is no column"):
        derive(Condition("way", "", derived="direction of travel"), {}, None, None)


def test_many_rows_are_quick() -> None:
    travel = np.sin(np.linspace(0, 300, 200_000))
    begin = time.perf_counter()
    way = derive(Condition("way", "", derived="direction of travel"), {"travel": travel}, None, None)
    assert time.perf_counter() - begin < 2
    assert np.count_nonzero(np.diff(way)) == 95  # extrema at pi/2 + k pi, k = 0 to 94, below 300


# Declarations


@pytest.mark.parametrize(
    "derived",
    ["since start", "maximum of x", "direction", "direction of", "direction of x y", "since_start of x", "of x"],
)
def test_histories_that_nobody_knows(derived: str) -> None:
    with pytest.raises(DeclarationError, match=f"condition 'it' is derived by '{derived}'; write 'since_start', "):
        Condition("it", "", derived=derived)


def test_nothing_is_made_from_itself() -> None:
    with pytest.raises(DeclarationError, match="each of another column"):
        Condition("load", "N", derived="running_maximum of load")


@pytest.mark.parametrize("derived", ["since_start", "cumulative of oil"])
def test_what_is_gained_is_no_level(derived: str) -> None:
    with pytest.raises(DeclarationError, match="is in degC, a temperature level, but what is gained is a difference"):
        Condition("warming", "degC", derived=derived)
    assert Condition("warming", "K", derived=derived).made_from in {"warming", "oil"}
    assert Condition("hottest", "degC", derived="running_maximum of oil").history == "running_maximum"


def test_a_range_that_is_none() -> None:
    with pytest.raises(DeclarationError, match="condition 'load': its range goes from 5 to 2; lower first"):
        Condition("load", "N", low=5, high=2)


# Rows of a file


@inputs
class Stage:
    """A stage that is pushed to a place."""

    place: Float = given(0.0, "mm", symbol="x")


@results
class Shown:
    """Where it is."""

    position: Float = found("um", symbol="x_1")


def stage(given_: Stage) -> Shown:
    """Just there."""
    return Shown(position=given_.place)


def lost(given_: Stage, *, play: Float, way: Float) -> Stage:
    """Half the play is lost against the way."""
    return replace(given_, place=given_.place - play / 2 * way)


def worn(given_: Stage, base: Shown, *, wear: Float, strokes: Float) -> Shown:
    """So much per stroke."""
    return replace(base, position=base.position + wear * strokes)


def kneaded(given_: Stage, base: Shown, *, yielding: Float, peak: Float) -> Shown:
    """So much per newton of the highest load so far."""
    return replace(base, position=base.position + yielding * peak)


STAGE = Model(
    name="stage",
    title="Stage",
    function=stage,
    errors=[
        Effect("lost", on_inputs=lost, unknowns=[Unknown("play", -1, 1, "mm")],
               needs=[Condition("way", "", derived="direction of place")]),
        Effect("worn", on_results=worn, unknowns=[Unknown("wear", -9, 9, "um")],
               needs=[Condition("strokes", "", derived="since_start")]),
        Effect("kneaded", on_results=kneaded, unknowns=[Unknown("yielding", -9, 9, "um/N")],
               needs=[Condition("peak", "N", derived="running_maximum of load")]),
    ],
)  # fmt: skip
ALL = '[effects.lost]\nplay = "1 mm"\n[effects.worn]\nwear = "3 um"\n[effects.kneaded]\nyielding = "2 um/N"\n'
Read = Callable[..., RowsFile]
OFFER = Offer("stage", STAGE, Origin("stage", "", "", "", "module:stage"))


@pytest.fixture
def rows(tmp_path: Path) -> Read:
    """Read rows for the stage."""

    def read(text: str, stated: str = ALL) -> RowsFile:
        (tmp_path / "rows.csv").write_text(text)
        return read_rows(tmp_path / "rows.csv", OFFER, setup_from_text(stated, OFFER, file="a.toml", folder=tmp_path))

    return read


def test_the_rows_of_a_file_make_the_conditions(rows: Read) -> None:
    read = rows("place [mm],strokes,load [kN]\n0,100,0.001\n1,101,0.004\n0.5,103,0.002\n")
    np.testing.assert_allclose(read.columns["way"], [1, 1, -1])
    np.testing.assert_allclose(read.columns["strokes"], [0, 1, 3])
    np.testing.assert_allclose(read.columns["peak"], [1, 4, 4])
    assert read.others == ()
    setup = setup_from_text(ALL, OFFER, file="a.toml", folder=Path())
    shown = shown_by_gauge(setup, read).values["position"]
    np.testing.assert_allclose(shown, [0 - 500 + 0 + 2, 1000 - 500 + 3 + 8, 500 + 500 + 9 + 8])


def test_time_and_runs_decide_what_came_before(rows: Read) -> None:
    read = rows("time,run,place [mm]\n3,a,0.5\n1,b,7\n2,a,0.7\n2,b,9\n1,a,0.1\n")
    np.testing.assert_allclose(read.columns["way"], [-1, 1, 1, 1, 1])
    assert read.others == ()


def test_a_column_of_its_own_is_taken_as_it_is(rows: Read) -> None:
    read = rows("place [mm],way,peak [N]\n0,-1,7\n1,-1,3\n")
    np.testing.assert_allclose(read.columns["way"], [-1, -1])
    np.testing.assert_allclose(read.columns["peak"], [7, 3])


def test_without_its_column_the_inputs_file_speaks(rows: Read) -> None:
    read = rows("strokes,note\n5,a\n,b\n9,c\n", ALL + '[conditions]\nway = -1\nstrokes = 50\npeak = "2 N"\n')
    assert "way" not in read.columns
    assert "peak" not in read.columns
    np.testing.assert_allclose(read.columns["strokes"], [0, 50, 4])


def test_the_column_it_is_made_from_is_checked(rows: Read) -> None:
    with pytest.raises(
        InputError, match=r"column 'load' has no unit; it is a force: write 'load \[N\]' \('peak' is made"
    ):
        rows("load\n5\n")
    with pytest.raises(InputError, match=r"rows.csv:3: load: 'much' is no number"):
        rows("load [N]\n5\nmuch\n")


def test_a_clock_that_is_none_leaves_the_rows_as_they_stand(rows: Read) -> None:
    read = rows("time,place [mm]\nnoon,0\nevening,1\n")
    np.testing.assert_allclose(read.columns["way"], [1, 1])


def test_the_time_of_the_kernel_counts_from_the_first_row_where_an_effect_needs_it(rows: Read) -> None:
    """2 um/h of drift; the file begins at 8 h. Without such an effect a column "time" may hold anything."""
    drift = '[effects.sensor_drift]\nposition = "2 um/h"\n'
    read = rows("time [h]\n8\n9\n8.5\n", drift)
    np.testing.assert_allclose(read.columns["time"], [0, 3600, 1800])
    setup = setup_from_text(drift, OFFER, file="a.toml", folder=Path())
    np.testing.assert_allclose(shown_by_gauge(setup, read).values["position"], [0, 2, 1], atol=1e-12)
    assert rows("time\n12:30\n12:31\n", "[inputs]\n").others == ("time",)
    with pytest.raises(InputError, match="column 'time' has no unit"):
        rows("time\n8\n", drift)
