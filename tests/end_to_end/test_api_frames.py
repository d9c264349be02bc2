"""Dataframes of pandas, polars and pyarrow in and out of the API; what a file refuses they are refused, too."""

from __future__ import annotations

import inspect
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pytest

import truing
from shared import TESTS, process

PIN = TESTS / "data" / "pin_wear.py"


@pytest.fixture(scope="module")
def pin() -> truing.LoadedModel:
    return truing.load(PIN)


def test_rows_come_back_with_their_results(pin: truing.LoadedModel) -> None:
    rows = pd.DataFrame({"load [N]": [56.0, 84.0, 84_000.0], "who": ["a", "b", "c"]}, index=[7, 8, 9])
    made = pin.evaluate(rows)
    assert list(made.index) == [7, 8, 9]
    assert made["pressure [MPa]"].tolist()[:2] == pytest.approx([2, 3])
    assert made["who"].tolist() == ["a", "b", "c"]
    assert made["fault"].tolist()[:2] == ["", ""]
    assert np.isnan(made["pressure [MPa]"].tolist()[2])
    assert made["fault"].tolist()[2].startswith("the contact flows")


def test_a_unit_stands_in_the_name_or_beside_it(pin: truing.LoadedModel) -> None:
    rows = pd.DataFrame({"load": [56.0, 84.0]})
    assert pin.evaluate(rows, units={"load": "N"})["pressure [MPa]"].tolist() == pytest.approx([2, 3])


def test_results_of_an_earlier_call_are_calculated_anew(pin: truing.LoadedModel) -> None:
    made = pin.evaluate(pd.DataFrame({"load [N]": [56.0, 84.0]}))
    again = pin.evaluate(made.assign(**{"load [N]": [28.0, 28.0]}))
    assert again["pressure [MPa]"].tolist() == pytest.approx([1, 1])
    assert list(again.columns) == list(made.columns)


@pytest.mark.parametrize("make", [pl.DataFrame, pa.table], ids=["polars", "pyarrow"])
def test_a_dataframe_comes_back_as_what_it_was(pin: truing.LoadedModel, make: Any) -> None:
    rows = make({"load [N]": [56.0, 84.0], "area [mm^2]": [28.0, None]})
    made = pin.evaluate(rows)
    assert type(made) is type(rows)
    pressure = made["pressure [MPa]"]
    assert (pressure.to_list() if hasattr(pressure, "to_list") else pressure.to_pylist()) == pytest.approx([2, 3])


def test_numbers_of_every_width_are_numbers(pin: truing.LoadedModel) -> None:
    rows = pd.DataFrame({"load [N]": np.array([56, 84], dtype="int32"), "area [mm^2]": pd.array([28, None], "Int64")})
    assert pin.evaluate(rows)["pressure [MPa]"].tolist() == pytest.approx([2, 3])


def rows(**columns: Any) -> pd.DataFrame:
    return pd.DataFrame({name.replace("_of_", " [") + "]": values for name, values in columns.items()})


REFUSED: list[tuple[Any, str]] = [
    (pd.DataFrame({"load": [1.0]}), "dataframe:1: column 'load' has no unit"),
    (rows(load_of_kg=[1.0]), "dataframe:1: column 'load [kg]': 'kg' is a mass (kg), expected a force (N)"),
    (rows(load_of_N=[1.0, float("nan")]), "dataframe:3: load: 'nan'"),
    (rows(load_of_N=[1.0, float("inf")]), "dataframe:3: load: 'inf'"),
    (pd.DataFrame({"load [N]": [1.0, None]}, dtype=object), "row 2 of the dataframe holds nothing"),
    (rows(load_of_N=[]), "the dataframe holds no rows"),
    (pd.DataFrame(), "the dataframe holds no rows"),
    (rows(load_of_N=[1.0, "x"]), "column 'load [N]' of the dataframe holds numbers and texts; make it one kind"),
    (rows(load_of_N=["1.0", "x"]), "dataframe:3: load: 'x' is no number"),
    (rows(load_of_N=[True, False]), "dataframe:2: load: 'True' is no number"),
    (rows(load_of_N=[1 + 2j, 3j]), "dataframe:2: load: '(1+2j)' is no number"),
    (rows(load_of_N=[pd.Timestamp("2026-01-01")]), "dataframe:2: load: '2026-01-01 00:00:00' is a date and no number"),
    (rows(load_of_N=[-1.0]), "dataframe:2: load"),
    (rows(lod_of_N=[1.0]), "dataframe:1: column 'lod' changes nothing. Did you mean 'load'? Rename it or leave it out"),
    (pd.DataFrame({"load [N]": [1.0, 2.0]}, index=[8, 8]), "the index of the dataframe names the row 8 twice"),
    (pd.DataFrame([[1.0, 2.0]], columns=["load [N]", "load [N]"]), "the dataframe cannot be read"),
    (pd.DataFrame([[1.0, 2.0]], columns=["load [N]", "load [kN]"]), "dataframe:1: the column 'load' occurs twice"),
    ({"load": [1.0]}, "dict is no dataframe of pandas, polars, pyarrow"),
    (pd.Series([1.0], name="load [N]"), "Series is no dataframe of pandas, polars, pyarrow"),
]


def test_units_are_those_of_columns(pin: truing.LoadedModel) -> None:
    with pytest.raises(truing.TruingError, match="units names 'lod', which is no column; the columns are load"):
        pin.evaluate(pd.DataFrame({"load": [1.0]}), units={"lod": "N"})


RECORDS: list[tuple[Any, str]] = [
    (rows(load_of_N=[1.0]), "record:1: no column is a result of pin_wear, so nothing is measured"),
    (rows(depth_of_kg=[1.0, 2.0]), "record:1: column 'depth [kg]': 'kg' is a mass (kg), expected a length (µm)"),
    (pd.DataFrame({"depth": [1.0, 2.0]}), "record:1: column 'depth' has no unit"),
    (rows(depth_of_um=[1.0, "x"]), "column 'depth [um]' of the dataframe holds numbers and texts"),
    (rows(depth_of_um=[]), "the dataframe holds no rows"),
    (rows(depth_of_um=[float("nan"), 1.0]), "row 1 of the dataframe holds nothing"),
    (pd.DataFrame({"depth [um]": [1.0, 2.0]}, index=["a", "a"]), "names the row 'a' twice"),
]


@pytest.mark.parametrize(("frame", "words"), REFUSED + RECORDS, ids=[words for _, words in REFUSED + RECORDS])
def test_what_a_file_refuses_is_refused_in_the_same_words(pin: truing.LoadedModel, frame: Any, words: str) -> None:
    with pytest.raises(truing.TruingError) as caught:
        truing.record(frame, pin) if words in dict(map(reversed, RECORDS)) else pin.evaluate(frame)
    assert words in str(caught.value)


def test_a_column_of_a_record_that_may_be_misspelt_is_told(pin: truing.LoadedModel) -> None:
    with pytest.warns(UserWarning, match=r"column 'lod' is neither input, result nor condition\. Did you mean 'load'"):
        truing.record(rows(depth_of_um=[1.0, 2.0], lod_of_N=[1.0, 2.0]), pin)


def test_a_record_gives_its_rows_back_however_the_file_is_written(pin: truing.LoadedModel, tmp_path: Path) -> None:
    (tmp_path / "rig.csv").write_text("# rig 7\ndepth [um];load [N];who\n1,5;50;a\n2;;b\n", encoding="utf-8")
    frame = truing.read(tmp_path / "rig.csv", pin).frame()
    assert frame.to_dict("list") == {"depth [um]": ["1.5", "2"], "load [N]": ["50", ""], "who": ["a", "b"]}


def test_a_text_that_looks_like_a_remark_is_a_cell(pin: truing.LoadedModel) -> None:
    made = pin.evaluate(pd.DataFrame({"who": ["# a", "b"], "load [N]": [56.0, 84.0]}))
    assert made["pressure [MPa]"].tolist() == pytest.approx([2, 3])


ALONE = """
import sys
from importlib.machinery import PathFinder

blocked, find = {"pandas", "polars"}, PathFinder.find_spec
PathFinder.find_spec = lambda name, *more: None if name.partition(".")[0] in blocked else find(name, *more)

import json
from typing import Any
import numpy as np
import pyarrow
import truing

DIAGNOSED
pin = truing.load(sys.argv[1])
made = diagnosed(pin, pyarrow.table)
runs = [pin.run(), pin.sweep("load", (50, 90), points=3), pin.run(load=50).compare(pin.run())]
cases = pin.run(cases=pyarrow.table({"load [N]": [50.0, 60.0]})).case_frame()
for frame in [*made[1:], *(run.frame() for run in runs), cases]:
    assert type(frame).__module__.split(".")[0] == "pyarrow", type(frame)
assert not [name for name in blocked if sys.modules.get(name)]
assert pin.sweep("load", (50, 90), points=3).plot()._repr_png_().startswith(b"\\x89PNG")
assert "matplotlib.pyplot" not in sys.modules
print(json.dumps(made[0].document))
"""


def diagnosed(pin: Any, make: Any) -> list[Any]:
    """A diagnosis whose rows came as a dataframe, and dataframes that come back of it."""
    time = np.linspace(10.0, 400.0, 40)
    base = pin.evaluate(make({"time [h]": time.tolist()}))
    depth = np.asarray(base["depth [um]"]) + 7.0 + np.random.default_rng(1).normal(0, 0.1, 40)
    columns = {"time": time.tolist(), "depth": depth.tolist()}
    record = truing.record(make(columns), pin, units={"time": "h", "depth": "um"})
    found = pin.diagnose(record)
    return [found, base, record.frame(), found.ranking.frame(), found.residuals.frame()]


def test_one_library_of_dataframes_is_enough(pin: truing.LoadedModel, tmp_path: Path) -> None:
    """In a process that finds pyarrow alone; the notebook runs with pandas and with polars alone.

    A notebook shows what has ``_repr_png_``: pyplot is not imported for it.
    """
    code = ALONE.replace("DIAGNOSED", inspect.getsource(diagnosed))
    answer = process([sys.executable, "-c", code, str(PIN)], tmp_path)
    assert answer.code == 0, answer.err
    assert json.loads(answer.out) == diagnosed(pin, pd.DataFrame)[0].document


def test_without_any_a_sentence_says_what_to_install(pin: truing.LoadedModel, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("pandas", "polars", "pyarrow"):
        monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(truing.TruingError) as caught:
        pin.run().frame()
    assert str(caught.value) == "a table in Python needs one of pandas, polars, pyarrow: pip install pandas"
