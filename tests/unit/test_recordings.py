"""Recordings: TDMS, MDF, MATLAB and parquet files give exactly the arrays of the same columns in CSV."""

from __future__ import annotations

import struct
import subprocess
import sys
import zlib
from collections.abc import Collection, Mapping
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pandas
import pytest
from asammdf import MDF, Signal
from sample_models import PIN_OFFER, PIN_WEAR
from scipy.io import savemat

from recording_files import KINDS, WRITERS, Recorded, write_csv, write_mat, write_mdf, write_parquet, write_tdms
from truing.errors import InputError
from truing.inputs_file import json_schema, setup_from_text
from truing.measurements import DataTable, read_cases, read_rows, read_table
from truing.recordings import KINDS as KINDS_READ
from truing.recordings import mdf, mdf_process
from truing.setup import NamedColumn, Setup
from truing.workbooks.writing import SheetTable, workbook_bytes

KNOWN = {"time": "h", "depth": "um", "load": "N", "probe_temperature": "degC"}
NAN = float("nan")


def read(
    path: Path, named: Mapping[str, str | tuple[str, str]] | None = None, results: Collection[str] = ("depth",)
) -> DataTable:
    """Read a recording that has no faults."""
    pairs = {key: (what, None) if isinstance(what, str) else what for key, what in (named or {}).items()}
    columns = {key: NamedColumn(*pair) for key, pair in pairs.items()}
    table, faults = read_table(path, KNOWN, named=columns, results=results)
    faults.raise_any()
    return table


def said(path: Path, named: Mapping[str, str | tuple[str, str]] | None = None) -> str:
    """Return what is wrong with a recording, from its name on."""
    with pytest.raises(InputError) as caught:
        read(path, named)
    return str(caught.value).replace(f"{path.parent}/", "")


def equal(table: DataTable, other: DataTable) -> None:
    """Both hold the same columns, bit by bit."""
    assert set(table.columns) == set(other.columns)
    for name, column in other.columns.items():
        if isinstance(column, tuple):
            assert table.columns[name] == column
        else:
            np.testing.assert_array_equal(table.columns[name], column, strict=True)


@pytest.fixture(autouse=True)
def in_this_process(monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> None:
    """Read MDF files here, which takes no second; tests marked by their name read them as the program does."""
    if "of_its_own" not in request.node.name:
        monkeypatch.setitem(KINDS_READ, ".mf4", replace(KINDS_READ[".mf4"], read=mdf_process.read_channels))
        monkeypatch.setitem(KINDS_READ, ".mdf", replace(KINDS_READ[".mdf"], read=mdf_process.read_channels))


# The same arrays


def columns(rows: int = 300) -> dict[str, Recorded]:
    """Numbers of every size with gaps, single precision, whole numbers and words, on one clock."""
    draw = np.random.default_rng(5)
    times = 0.01 * np.arange(rows)
    depth = draw.normal(0, 1, rows) * 10.0 ** draw.integers(-12, 12, rows)
    load = draw.uniform(1, 200, rows).astype(np.float32)
    depth[::17] = NAN
    return {
        "depth": Recorded(depth, "um", times),
        "load": Recorded(load, "N", times),
        "strokes": Recorded(draw.integers(0, 10**9, rows), "", times),
        "run": Recorded([("one", "two")[row >= rows // 2] for row in range(rows)], "", times),
    }


@pytest.mark.parametrize("kind", KINDS)
def test_a_recording_reads_as_the_same_columns_in_csv(tmp_path: Path, kind: str) -> None:
    in_csv = read(write_csv(tmp_path / "rows.csv", columns()))
    units = {"time": ("time", "s"), "depth": ("depth", "um"), "load": ("load", "N")} if kind == "mat" else {}
    recorded = read(WRITERS[kind](tmp_path / f"rows.{kind}", columns()), units)
    equal(recorded, in_csv)
    assert recorded.lines == tuple(range(2, 302))
    assert (recorded.count.in_file, recorded.notes) == (300, ())


def test_mdf_of_version_3_reads_as_well(tmp_path: Path) -> None:
    numbers = {name: each for name, each in columns(20).items() if name in {"depth", "load"}}
    equal(read(write_mdf(tmp_path / "r.mdf", numbers, "3.30")), read(write_csv(tmp_path / "r.csv", numbers)))


def test_invalid_samples_of_an_mdf_are_missing(tmp_path: Path) -> None:
    times = np.arange(4.0)
    bits = np.array([False, True, False, False])
    with MDF(version="4.10") as file:
        file.append([Signal(np.array([1, 2, 3, 4]), times, name="depth", unit="um", invalidation_bits=bits)])
        file.save(tmp_path / "r.mf4")
    np.testing.assert_allclose(read(tmp_path / "r.mf4").columns["depth"], [1e-6, NAN, 3e-6, 4e-6])


def test_a_formula_in_a_file_is_not_executed(tmp_path: Path) -> None:
    times = np.arange(3.0)
    with MDF(version="4.10") as file:
        file.append(
            [
                Signal(np.array([1, 2, 3]), times, name="odd", conversion={"formula": "X+1"}),
                Signal(np.array([1, 2, 3]), times, name="depth", unit="um", conversion={"a": 2.0, "b": 1.0}),
            ]
        )
        file.save(tmp_path / "r.mf4")
    table = read(tmp_path / "r.mf4")
    assert table.notes == ("channel '0/odd' is converted by a formula in the file and is left out",)
    np.testing.assert_allclose(table.columns["depth"], [3e-6, 5e-6, 7e-6])


def test_structs_and_matrices_of_matlab(tmp_path: Path) -> None:
    rig = {"depth": np.array([1.0, 2.0]), "inner": {"deep": 1.0}}
    odd = {"fs": 1000.0, "words": ["a b"], "cells": np.array([1, "b"], dtype=object), "complex": np.array([1j, 2])}
    savemat(tmp_path / "r.mat", {"rig": rig, "m": np.array([[120.0, 20.0], [130.0, 21.0]]), **odd})
    named = {"rig/depth": ("depth", "um"), "m(:,1)": ("load", "N"), "m(:,2)": ("probe_temperature", "degC")}
    table = read(tmp_path / "r.mat", named)
    np.testing.assert_allclose(table.columns["depth"], [1e-6, 2e-6])
    np.testing.assert_allclose(table.columns["load"], [120, 130])
    np.testing.assert_allclose(table.columns["probe_temperature"], [293.15, 294.15])
    left = [note.partition(" ")[0] for note in table.notes]
    assert left == ["'rig.inner'", "'fs'", "'words'", "'cells'", "'complex'"]
    assert all(note.endswith("is left out") for note in table.notes)


def test_matlab_7_3_is_read_by_h5py(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "r.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        file.create_dataset("depth", data=np.array([[1.0, 2.0, 3.0]])).attrs["MATLAB_class"] = np.bytes_("double")
        file.create_dataset("text", data=np.array([[65], [66]], dtype="u2")).attrs["MATLAB_class"] = np.bytes_("char")
        file.create_dataset("outside", shape=(1, 3), dtype="f8", external=[(str(tmp_path / "secret"), 0, 24)])
        file["link"] = h5py.ExternalLink("other.mat", "/depth")
        rig = file.create_group("rig")
        rig.create_dataset("load", data=np.array([[5.0], [6.0], [7.0]]).T).attrs["MATLAB_class"] = np.bytes_("double")
    with path.open("r+b") as stream:
        stream.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")
    table = read(path, {"depth": ("depth", "um"), "rig/load": ("load", "N")})
    np.testing.assert_allclose(table.columns["depth"], [1e-6, 2e-6, 3e-6])
    np.testing.assert_allclose(table.columns["load"], [5, 6, 7])
    left = [f"'{name}' is no real vector or matrix and is left out" for name in ("outside", "text")]
    assert list(table.notes) == left
    monkeypatch.setitem(sys.modules, "h5py", None)
    needs = "which needs h5py: pip install 'truing[records]'; or save it with save(..., '-v7')"
    assert said(path) == f"r.mat: is a MATLAB file of version 7.3, {needs}"


def test_stamps_become_seconds_from_the_first(tmp_path: Path) -> None:
    stamps = np.array(["2024-03-01T23:59:58.5", "2024-03-02T00:00:00", "2024-03-02T00:00:01"], "datetime64[us]")
    depth = Recorded([1.0, 2.0, 3.0], "um")
    seconds = [0.0, 1.5, 2.5]
    for table in (
        read(write_tdms(tmp_path / "r.tdms", {"Clock": Recorded(stamps), "depth": depth}), {"Clock": ("time", "min")}),
        read(write_parquet(tmp_path / "r.parquet", {"time": Recorded(stamps), "depth": depth})),
    ):
        np.testing.assert_array_equal(table.columns["time"], seconds)


def test_rows_that_hold_nothing_are_left_out_and_named(tmp_path: Path) -> None:
    path = write_parquet(
        tmp_path / "r.parquet", {"depth": Recorded([1.0, None, 3.0], "um"), "run": Recorded(["a", None, ""])}
    )
    table = read(path)
    assert table.lines == (2, 4)
    assert table.count.sentence() == "3 rows, 2 used; 1 left out: line 3 (holds nothing)"


def test_columns_of_a_dataframe_keep_their_kind(tmp_path: Path) -> None:
    """Stamps with a zone, durations, categories, whole numbers and truth values that may be missing, single numbers."""
    frame = pandas.DataFrame(
        {
            "stamp": pandas.date_range("2024-03-31 00:30", periods=3, freq="h", tz="Europe/Berlin"),
            "time": pandas.to_timedelta([0, 90, 180], unit="s"),
            "depth [um]": np.array([1.0, NAN, 3.0], dtype=np.float32),
            "load [N]": pandas.array([1, None, 3], dtype="Int64"),
            "on": pandas.array([True, None, False], dtype="boolean"),
            "run": pandas.Categorical(["a", "b", "a"]),
            "lists": [[1], [2], [3]],
        }
    )
    frame.to_parquet(tmp_path / "r.parquet")
    table = read(tmp_path / "r.parquet")
    np.testing.assert_array_equal(table.columns["stamp"], [0, 3600, 7200])  # the clock jumps over an hour there
    np.testing.assert_array_equal(table.columns["time"], [0, 90, 180])
    np.testing.assert_allclose(table.columns["depth"], [1e-6, NAN, 3e-6])
    np.testing.assert_array_equal(table.columns["load"], [1, NAN, 3])
    assert (table.columns["on"], table.columns["run"]) == (("true", "", "false"), ("a", "b", "a"))
    (note,) = table.notes
    assert note.startswith("column 'lists' holds list")


# Names and units


def test_columns_of_csv_files_and_workbooks_are_named_too(tmp_path: Path) -> None:
    named = {"temp_C": ("probe_temperature", "degC"), "s [mm]": "depth", "Force": ("load", "kN")}
    (tmp_path / "r.csv").write_text("temp_C,s [mm],Force [N]\n20,1,2\n30,2,3\n", encoding="utf-8")
    rows = [(20, 1, 2), (30, 2, 3)]
    (tmp_path / "r.xlsx").write_bytes(workbook_bytes([SheetTable("r", ["temp_C", "s [mm]", "Force [N]"], rows)]))
    for path in (tmp_path / "r.csv", tmp_path / "r.xlsx"):
        table = read(path, named)
        np.testing.assert_allclose(table.columns["probe_temperature"], [293.15, 303.15])
        np.testing.assert_allclose(table.columns["depth"], [1e-3, 2e-3])
        np.testing.assert_allclose(table.columns["load"], [2e3, 3e3])
        assert table.notes == ("column 'Force' is read in [kN] as [columns] says; the file says [N]",)


def test_a_channel_is_called_by_its_path_or_by_its_name(tmp_path: Path) -> None:
    alike = {"A/x": Recorded([1.0, 2.0], "um"), "B/x": Recorded([3.0, 4.0], "N"), "B/y": Recorded([20.0, 21.0], "degC")}
    path = write_tdms(tmp_path / "r.tdms", alike)
    table = read(path, {"A/x": "depth", "B/x": "load", "y": "probe_temperature", "B/z": "run"})
    np.testing.assert_allclose(table.columns["depth"], [1e-6, 2e-6])
    np.testing.assert_allclose(table.columns["load"], [3, 4])
    np.testing.assert_allclose(table.columns["probe_temperature"], [293.15, 294.15])
    assert table.notes == ("[columns] names 'B/z', which is no column here. Did you mean 'B/x'?",)
    both = said(path, {"A/x": "depth", "B/x": ("depth", "um")})
    assert both == "r.tdms: the channels 'A/x' and 'B/x' are all called 'depth'; name them apart under [columns]"


def test_units_that_nobody_knows(tmp_path: Path) -> None:
    path = write_tdms(tmp_path / "r.tdms", {"depth": Recorded([1.0, 2.0], "Strich"), "x": Recorded([1.0, 2.0], "Grad")})
    assert "column 'depth [Strich]': " in said(path)
    assert "under [columns]" in said(path)
    table = read(path, {"depth": ("depth", "um")})
    assert table.units == {"depth": "um", "x": ""}
    assert [note.partition(":")[0] for note in table.notes] == [
        "column 'depth' is read in [um] as [columns] says; the file says [Strich]", "channel 'Untitled/x'",
    ]  # fmt: skip
    bare = write_tdms(tmp_path / "bare.tdms", {"Ch_1": Recorded([1.0, 2.0])})
    assert said(bare, {"Ch_1": "depth"}) == (
        "bare.tdms: column 'Ch_1' has no unit; it is a length: "
        'write Ch_1 = { name = "depth", unit = "um" } under [columns]'
    )


def test_a_cell_that_is_no_number_is_told_by_row_and_channel(tmp_path: Path) -> None:
    path = write_tdms(tmp_path / "r.tdms", {"depth": Recorded([1.0, float("inf")], "um")})
    assert said(path) == "r.tdms, line 3 of 'Untitled/depth': depth: 'inf' is not a finite number"


# Several clocks


FAST, SLOW = 0.5 * np.arange(9), 2.0 * np.arange(1, 3)


def test_what_is_no_result_is_interpolated_at_the_times_of_the_results(tmp_path: Path) -> None:
    """The load at 2 s and 4 s is 10 and 30; between, it is on the straight line; before 2 s nobody knows it."""
    channels = {
        "depth": Recorded(np.arange(9.0), "um", FAST), "load": Recorded([10.0, 30.0], "N", SLOW),
        "oil": Recorded([1.0, 2.0], "", SLOW), "run": Recorded(["a", "b"], "", SLOW),
    }  # fmt: skip
    for write, fast, slow in ((write_tdms, "Untitled", "Untitled"), (write_mdf, "0", "1")):
        table = read(write(tmp_path / {write_tdms: "r.tdms", write_mdf: "r.mf4"}[write], channels))
        np.testing.assert_array_equal(table.columns["time"], FAST[4:])
        np.testing.assert_array_equal(table.columns["load"], [10, 15, 20, 25, 30])
        np.testing.assert_allclose(table.columns["depth"], np.arange(4, 9) * 1e-6)
        assert table.columns["run"] == ("a", "a", "a", "a", "b")
        assert table.lines == (6, 7, 8, 9, 10)
        load = next(note for note in table.notes if "load" in note)
        assert load.endswith(
            f"from 2 values to 9 rows at the times of '{fast}/depth', linear interpolation; "
            "4 rows lie outside its record"
        )
        assert table.count.sentence() == (
            f"9 rows, 5 used; 4 left out: lines 2, 3, 4, 5 (outside the time in which '{slow}/load' was recorded)"
        )


def test_no_reading_of_a_result_is_made_up_or_lost(tmp_path: Path) -> None:
    channels = {"depth": Recorded([7.0, 8.0], "um", SLOW), "load": Recorded(np.arange(9.0), "N", FAST)}
    table = read(write_tdms(tmp_path / "r.tdms", channels))
    np.testing.assert_array_equal(table.columns["time"], SLOW)
    np.testing.assert_array_equal(table.columns["load"], [4, 8])
    both = read(tmp_path / "r.tdms", results=("depth", "load"))
    np.testing.assert_array_equal(both.columns["time"], FAST)
    np.testing.assert_allclose(both.columns["depth"], [NAN] * 4 + [7e-6] + [NAN] * 3 + [8e-6])
    assert [note.partition(" in ")[0] for note in both.notes] == ["channel 'Untitled/depth' keeps its 2 values"]


def test_a_channel_called_time_is_the_clock_of_its_group(tmp_path: Path) -> None:
    """In minutes here, in seconds there; absolute starts that differ are counted from the earlier one."""
    channels = {
        "A/t": Recorded(FAST / 60, "min"), "A/depth": Recorded(np.arange(9.0), "um"),
        "B/t": Recorded(SLOW, "s"), "B/load": Recorded([10.0, 30.0], "N"),
    }  # fmt: skip
    path = write_tdms(tmp_path / "r.tdms", channels)
    table = read(path, {"A/t": "time", "B/t": "time"})
    np.testing.assert_allclose(table.columns["load"], [10, 15, 20, 25, 30], rtol=1e-12)
    same = {name: Recorded(np.arange(3.0), "s") for name in ("A/time", "B/time")}
    path = write_tdms(tmp_path / "c.tdms", {**same, "B/depth": Recorded(np.arange(3.0), "um")})
    assert set(read(path).columns) == {"time", "depth"}
    stamped = {
        "depth": Recorded(np.arange(9.0), "um", FAST, "2024-01-01T00:00:02"),
        "load": Recorded([10.0, 30.0], "N", np.array([0.0, 4.0]), "2024-01-01T00:00:00"),
    }
    table = read(write_tdms(tmp_path / "s.tdms", stamped))
    np.testing.assert_allclose(table.columns["time"], [2, 2.5, 3, 3.5, 4])
    np.testing.assert_allclose(table.columns["load"], [20, 22.5, 25, 27.5, 30])


def test_lengths_that_differ_need_a_clock(tmp_path: Path) -> None:
    loose = {"depth": Recorded([1.0, 2.0, 3.0], "um", FAST[:3]), "load": Recorded([1.0], "N"), "oil": Recorded([1.0])}
    path = write_tdms(tmp_path / "r.tdms", loose)
    clock = 'call the channel that holds its times "time" under [columns]'
    assert (
        said(path)
        == f"r.tdms: channel 'Untitled/load' has 1 value and no clock, beside channels of other lengths; {clock}"
    )
    apart = {"depth": Recorded([1.0, 2.0], "um", SLOW), "load": Recorded([1.0, 2.0, 3.0], "N", 9 + FAST[:3])}
    assert said(write_tdms(tmp_path / "a.tdms", apart)) == (
        "a.tdms: holds no row that can be used: 2 rows, 0 used; 2 left out: lines 2, 3 "
        "(outside the time in which 'Untitled/load' was recorded)"
    )
    back = {"A/time": Recorded([0.0, 2.0, 1.0], "s"), "A/depth": Recorded([1.0, 2.0, 3.0], "um")}
    path = write_tdms(tmp_path / "b.tdms", {**back, "B/load": Recorded([1.0, 2.0], "N", SLOW)})
    assert "the times of channel 'A/depth' do not increase at value 3" in said(path)


# Files that are broken, or mean harm


HOSTILE = {
    "tdms": "a TDMS file",
    "mf4": "an MDF file",
    "mat": "a MATLAB file of version 5 or later",
    "parquet": "a parquet file",
}


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "mf4"])
def test_a_file_that_is_cut_off_or_damaged_has_one_sentence(tmp_path: Path, kind: str) -> None:
    whole = WRITERS[kind](tmp_path / f"whole.{kind}", columns(60)).read_bytes()
    path, draw = tmp_path / f"r.{kind}", np.random.default_rng(7)
    named = {"depth": ("depth", "um"), "load": ("load", "N"), "time": ("time", "s")}
    for share in (0.02, 0.1, 0.4, 0.8, 0.99):
        path.write_bytes(whole[: int(share * len(whole))])
        assert len(said(path, named).splitlines()) == 1
    for _ in range(40):
        damaged = bytearray(whole)
        for place in draw.integers(4, min(len(whole), 2000), 3):
            damaged[place] = draw.integers(256)
        path.write_bytes(damaged)
        with suppress(InputError):
            read(path, named)


def test_what_a_recorder_had_written_when_it_stopped_is_read(tmp_path: Path) -> None:
    path = write_tdms(tmp_path / "r.tdms", {"depth": Recorded(np.arange(100.0), "um")})
    path.write_bytes(path.read_bytes()[:-80])
    table = read(path)
    np.testing.assert_allclose(table.columns["depth"], np.arange(90) * 1e-6)
    assert table.notes == ("the file is cut off in its last segment; what was written before is read",)


def test_a_channel_outside_of_its_record_is_refused(tmp_path: Path) -> None:
    """The library would read what lies in memory behind the record."""
    path = write_mdf(tmp_path / "r.mf4", columns(60))
    whole = path.read_bytes()
    offset = whole.index(b"##CN") + 24 + 8 * 8 + 4  # the place of a channel in its record, behind eight links
    path.write_bytes(whole[:offset] + struct.pack("<I", 10**8) + whole[offset + 4 :])
    assert "ends at byte 100000008 of a record of" in said(path)


@pytest.mark.parametrize("kind", KINDS)
def test_another_file_under_the_name_of_a_recording(tmp_path: Path, kind: str) -> None:
    path = tmp_path / f"r.{kind}"
    assert "no such file" in said(path)
    path.write_bytes(b"")
    assert said(path) == f"r.{kind}: is empty; record or copy it again"
    path.write_bytes(b"PK\x03\x04 of another kind" * 20)
    assert said(path) == f"r.{kind}: is not {HOSTILE[kind]}, though it is called so; record or copy it again"


def test_a_process_of_its_own_reads_an_mdf_and_may_die_of_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = write_mdf(tmp_path / "whole.mf4", columns(60)).read_bytes()
    equal(read(tmp_path / "whole.mf4"), read(write_csv(tmp_path / "whole.csv", columns(60))))
    path = tmp_path / "r.mf4"
    path.write_bytes(whole[: len(whole) // 2])
    assert said(path).startswith("r.mf4: cannot be read as an MDF file (")
    (tmp_path / "dies.py").write_text("import os\nos.abort()\n", encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(mdf, "READER", "dies")
    assert said(path) == "r.mf4: ends the library that reads MDF files; it is damaged: copy or export it again"


def test_a_file_that_says_it_is_huge_is_refused_before_it_is_read(tmp_path: Path) -> None:
    bomb = zlib.compress(struct.pack("<II", 14, 2**31) + b"\0" * 10**6)
    head = b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM"
    (tmp_path / "r.mat").write_bytes(head + struct.pack("<II", 15, len(bomb)) + bomb)
    assert "says that it holds 268435456 values, at most 50000000 are read" in said(tmp_path / "r.mat")
    whole = write_tdms(tmp_path / "r.tdms", {"depth": Recorded(np.arange(4.0), "um")}).read_bytes()
    index = struct.pack("<IIQ", 10, 1, 4)  # of double precision, one dimension, four values
    assert whole.count(index) == 1
    (tmp_path / "r.tdms").write_bytes(whole.replace(index, struct.pack("<IIQ", 10, 1, 2**40)))
    np.testing.assert_allclose(read(tmp_path / "r.tdms").columns["depth"], np.arange(4) * 1e-6)


def test_a_file_without_channels(tmp_path: Path) -> None:
    path = write_tdms(tmp_path / "r.tdms", {"depth": Recorded(np.empty(0), "um")})
    assert said(path).startswith("r.tdms: holds no channel with values ('Untitled/depth'") or "holds no value" in said(
        path
    )
    path = write_mat(tmp_path / "r.mat", {})
    assert said(path) == "r.mat: holds no channel with values; record or export it again"


WITHOUT = """
import sys
for name in ("nptdms", "asammdf", "h5py", "pyarrow"):
    sys.modules[name] = None
from pathlib import Path
from truing.errors import InputError
from truing.measurements import read_table
for path in map(Path, sys.argv[1:]):
    try:
        read_table(path, {})
    except InputError as error:
        print(error.faults[0].message)
"""


def test_without_the_libraries_a_sentence_says_what_to_install(tmp_path: Path) -> None:
    few = {name: each for name, each in columns(5).items() if name == "depth"}
    paths = [WRITERS[kind](tmp_path / f"r.{kind}", few) for kind in KINDS if kind != "mat"]
    done = subprocess.run([sys.executable, "-c", WITHOUT, *map(str, paths)], capture_output=True, text=True, check=True)
    needs = "needs a library that is not installed: pip install 'truing[records]'; or export it as CSV UTF-8"
    assert done.stdout.splitlines() == [f"{HOSTILE[kind]} {needs}" for kind in KINDS if kind != "mat"]


# Cases, and rows to calculate


def stated(text: str) -> Setup:
    return setup_from_text(text, PIN_OFFER, file="i.toml", folder=Path())


def test_cases_and_rows_come_from_recordings(tmp_path: Path) -> None:
    setup = stated('[columns]\nF = "load"\nT = { name = "probe_temperature", unit = "degC" }\n')
    rows: dict[str, Any] = {
        "case": Recorded(["cold", "hot"]),
        "F": Recorded([0.1, 0.2], "kN"),
        "T": Recorded([10.0, None]),
    }
    read_in = read_cases(write_parquet(tmp_path / "c.parquet", rows), PIN_OFFER, setup)
    assert [case.name for case in read_in.cases] == ["cold", "hot"]
    assert read_in.cases[0].values == pytest.approx({"load": 100.0, "probe_temperature": 283.15})
    assert read_in.cases[1].values == pytest.approx({"load": 200.0})
    table = read_rows(write_tdms(tmp_path / "r.tdms", {"F": Recorded([0.1, 0.2], "kN")}), PIN_OFFER, setup)
    np.testing.assert_allclose(table.columns["load"], [100, 200])
    assert table.cells == {"F [kN]": ("0.1", "0.2")}
    assert table.notes == ("[columns] names 'T', which is no column here",)


def test_the_schema_of_inputs_files_knows_columns() -> None:
    valid = {"columns": {"Rig 7/F": "load", "T": {"name": "probe_temperature", "unit": "degC"}}}
    schema = json_schema(PIN_OFFER)
    jsonschema.validate(valid, schema)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({"columns": {"F": {"unit": "N"}}}, schema)


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        (
            "x = 3",
            'a column is called by one of the model\'s names: write "torque" or { name = "torque", unit = "N m" }',
        ),
        ('x = { name = "load", unit = "m" }', "load: "),
        ('x = { name = "oil", unit = "Grad" }', "oil: "),
        ('a.b = "load"', "put what the file calls it in quotation marks where it holds a dot"),
        ('x = { unit = "N" }', "a column is called by one of the model's names"),
    ],
)
def test_what_is_wrong_in_columns_is_told_by_its_line(line: str, sentence: str) -> None:
    with pytest.raises(InputError) as caught:
        stated(f"[columns]\n{line}\n")
    (fault,) = caught.value.faults
    assert (fault.file, fault.line) == ("i.toml", 2)
    assert sentence in fault.message
    assert PIN_WEAR.name == "pin_wear"
