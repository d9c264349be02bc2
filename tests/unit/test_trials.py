"""Many changes of inputs and unknowns, asked of the model in one call: as one by one, with NaN where it fails."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from test_gauge import PIN_WEAR, WALL, Course, Wall, rows_for, wall

from truing import gauge
from truing.gauge import read_by_gauge, read_trials
from truing.setup import SwitchedOn, effect_column

LOADS = "load [N],time [h]\n28,1\n56,2\n84,3\n"


def counting() -> tuple[Callable[[Wall], Course], list[int]]:
    """The calculation of the wall, and how many rows each call of it has had so far."""
    calls: list[int] = []

    def counted(given_: Wall) -> Course:
        calls.append(np.size(given_.flux))
        return wall(given_)

    return counted, calls


def test_each_trial_is_the_machine_with_that_input(tmp_path: Path) -> None:
    """Pressure is load over 28 mm^2; a measured column is replaced row by row, another input for all rows."""
    setup, rows = rows_for(PIN_WEAR, tmp_path / "rows.csv", LOADS)
    changes = [{}, {"load": np.array([28.0, 28.0, 280.0])}, {"rate": 2e-8}, {"load": 14.0}]
    answers = [dict(each) for each in read_trials(setup, rows, changes, ["pressure", "depth"])]
    expected = [[1e6, 2e6, 3e6], [1e6, 1e6, 1e7], [1e6, 2e6, 3e6], [0.5e6] * 3]
    np.testing.assert_allclose([each["pressure"] for each in answers], expected)
    for change, answer in zip(changes, answers, strict=True):
        columns = {name: np.broadcast_to(value, (3,)) for name, value in change.items()}
        alone = read_by_gauge(setup, replace(rows, columns={**rows.columns, **columns}), ["pressure", "depth"])
        np.testing.assert_allclose(answer["depth"], alone.results["depth"], rtol=1e-12)


@pytest.mark.parametrize("count", [1, 2])
def test_a_model_may_change_its_columns_in_place(tmp_path: Path, count: int) -> None:
    """A trial of one value for all rows may hold it once, as numpy repeats it: the model has a column of its own."""

    def colder(given_: Wall) -> Course:
        given_.flux[...] -= 1.0
        return wall(given_)

    setup, rows = rows_for(replace(WALL, function=colder), tmp_path / "rows.csv", "flux [W/m^2]\n10\n20\n30\n")
    value = np.broadcast_to(11.0, (3,))
    for answer in read_trials(setup, rows, [{"flux": value}] * count, ["inside"]):
        np.testing.assert_allclose(answer["inside"] - 293.15, [1, 1, 1])
    assert value[0] == 11.0


def test_trials_are_one_call_and_not_too_many_rows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    counted, calls = counting()
    setup, rows = rows_for(replace(WALL, function=counted), tmp_path / "rows.csv", "flux [W/m^2]\n10\n20\n30\n")
    changes = [{"outside": 273.15 + place} for place in range(5)]
    answers = list(read_trials(setup, rows, changes, ["inside"]))
    assert calls == [15]
    monkeypatch.setattr(gauge, "AT_ONCE", 7)
    in_parts = list(read_trials(setup, rows, changes, ["inside"]))
    assert calls[1:] == [6, 6, 3]
    for place, (at_once, part) in enumerate(zip(answers, in_parts, strict=True)):
        np.testing.assert_allclose(at_once["inside"] - 273.15, place + np.array([1, 2, 3]))
        np.testing.assert_allclose(part["inside"], at_once["inside"])


@pytest.mark.parametrize("text", ["depth [mm]\n0\n50\n100\n", "depth [mm],pressing [N]\n0,1\n50,2\n100,3\n"])
def test_a_curve_is_calculated_once_for_all_rows_of_a_trial(tmp_path: Path, text: str) -> None:
    """10 W/m^2 through 100 mm of 1 W/(m K) are one kelvin: half of it in the middle. The trials are one call."""
    counted, calls = counting()
    model = replace(WALL, function=counted)
    setup, rows = rows_for(model, tmp_path / "rows.csv", text)
    setup = setup.changed({"pressing": np.ones(3)})
    answers = list(read_trials(setup, rows, [{"flux": 10.0}, {"flux": 20.0}], ["temperature"]))
    np.testing.assert_allclose([each["temperature"] - 293.15 for each in answers], [[0, 0.5, 1], [0, 1, 2]], atol=1e-9)
    assert calls == [2]


def test_what_no_column_changes_is_calculated_once_a_trial(tmp_path: Path) -> None:
    counted, calls = counting()
    setup, rows = rows_for(replace(WALL, function=counted), tmp_path / "rows.csv", "flux [W/m^2]\n10\n20\n30\n")
    rows = replace(rows, columns={"of_another_effect": np.arange(3.0)})
    answers = list(read_trials(setup, rows, [{"flux": 10.0}, {"flux": 20.0}], ["inside"]))
    np.testing.assert_allclose([each["inside"] - 293.15 for each in answers], [[1] * 3, [2] * 3])
    assert calls == [2]


def test_rows_that_are_alike_are_one_calculation_along_an_axis(tmp_path: Path) -> None:
    """Of 10 and 20 W/m^2 two kelvins are one third: four rows are two calculations, each read at its own places."""
    counted, calls = counting()
    text = "depth [mm],flux [W/m^2]\n0,10\n50,20\n100,10\n100,20\n"
    setup, rows = rows_for(replace(WALL, function=counted), tmp_path / "rows.csv", text)
    setup = setup.changed({"pressing": np.ones(3)})
    plain, warm = read_trials(setup, rows, [{"outside": 293.15}, {"outside": 303.15}], ["temperature"])
    np.testing.assert_allclose(plain["temperature"] - 293.15, [0, 1, 1, 2], atol=1e-9)
    np.testing.assert_allclose(warm["temperature"] - 293.15, [10, 11, 11, 12], atol=1e-9)
    assert calls == [4]


def test_an_effect_on_the_reading_asks_for_no_record_again(tmp_path: Path) -> None:
    """What dirt adds at 40 sizes is added to one record."""
    counted, calls = counting()
    text = "run,depth [mm],pressing [N]\na,0,1\na,50,2\na,100,3\n"
    setup, rows = rows_for(replace(WALL, function=counted), tmp_path / "rows.csv", text)
    on = setup.with_effects([SwitchedOn(WALL.known_effects["dirt"], {"offset": 0.0})])
    changes = [{effect_column("dirt", "offset"): np.full(3, float(size))} for size in range(40)]
    found = [each["inside"] for each in read_trials(on, rows, changes, ["inside"])]
    np.testing.assert_allclose([each - found[0] for each in found], np.repeat(np.arange(40.0)[:, None], 3, axis=1))
    assert calls == [1]


def test_unknowns_of_effects_are_set_row_by_row(tmp_path: Path) -> None:
    setup, rows = rows_for(WALL, tmp_path / "rows.csv", "flux [W/m^2]\n10\n20\n30\n")
    on = setup.with_effects([SwitchedOn(WALL.known_effects["dirt"], {"offset": 0.0})])
    changes = [{effect_column("dirt", "offset"): np.array(offset)} for offset in ([0.0, 1.0, 2.0], [3.0, 3.0, 3.0])]
    answers = [each["inside"] - 293.15 for each in read_trials(on, rows, changes, ["inside"])]
    np.testing.assert_allclose(answers, [[1, 3, 5], [4, 5, 6]])


def test_a_trial_in_which_the_model_fails_leaves_the_others(tmp_path: Path) -> None:
    def failing(given_: Wall) -> Course:
        return replace(wall(given_), inside=given_.outside + given_.flux / (given_.flux - 20.0))

    setup, rows = rows_for(replace(WALL, function=failing), tmp_path / "rows.csv", "flux [W/m^2]\n10\n20\n30\n")
    plain, scaled = read_trials(setup, rows, [{}, {"flux": np.array([10.0, 40.0, 60.0])}], ["inside"])
    np.testing.assert_allclose(plain["inside"] - 293.15, [-1, np.nan, 3])
    np.testing.assert_allclose(scaled["inside"] - 293.15, [-1, 2, 1.5])
