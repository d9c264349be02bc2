"""Tables: CSV with units in the header."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given as drawn
from hypothesis import settings as drawing
from hypothesis import strategies as st
from sample_models import PIN_OFFER, PIN_WEAR, STAGE, STAGE_OFFER, Surface

from truing.errors import InputError
from truing.measurements import DataTable, RowCount, StatedCase, read_cases, read_rows, read_table, table_text
from truing.setup import Setup, default_setup

KNOWN = {"time": "h", "depth": "um", "probe_temperature": "degC", "rate": "", "slope": "um/K"}


@pytest.fixture
def table(tmp_path: Path) -> Callable[[str | bytes], Path]:
    def write(content: str | bytes) -> Path:
        path = tmp_path / "rows.csv"
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return path

    return write


Write = Callable[[str | bytes], Path]


def faults(read: Callable[[], object]) -> list[str]:
    """Return what is wrong as "LINE: sentence", without the name of the file."""
    with pytest.raises(InputError) as caught:
        read()
    return [f"{fault.line}: {fault.message}" for fault in caught.value.faults]


def read(path: Path, known: Mapping[str, str] = KNOWN, *, is_measured: bool = True) -> DataTable:
    """Read a table that has no faults."""
    table, found = read_table(path, known, is_measured=is_measured)
    found.raise_any()
    return table


def data_faults(path: Path) -> list[str]:
    return faults(lambda: read(path))


PLAIN = "time [h],depth [um],run\n" + "".join(f"{row}, {row / 8},a b\n" for row in range(20))


@pytest.mark.parametrize(
    "odd",
    [
        '1,"2",a',
        "1,2,a#",
        "# a remark",
        ",,",
        " , ,",
        ",2,a",
        "1,2,",
        "\t1 ,2 ,a ",
        "1,2",
        "1,2,a,b",
        "1,2,a,",
        '1,"2,a',
    ],
)
@pytest.mark.parametrize("behind", [3, 17])
def test_rows_that_are_taken_apart_together_are_what_they_are_one_by_one(
    odd: str, behind: int, table: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    lines = PLAIN.splitlines(keepends=True)
    path = table("".join([*lines[:behind], f"{odd}\n", *lines[behind:]]))

    def read_all() -> object:
        read, found = read_table(path, KNOWN)
        columns = {name: np.asarray(column, dtype=str).tolist() for name, column in read.columns.items()}
        return columns, read.lines, read.count, found.found

    monkeypatch.setattr("truing.measurements.csv_text.ROWS_AT_ONCE", 5)
    together = read_all()
    monkeypatch.setattr("truing.measurements.csv_text.CsvFile._plain_columns", lambda *_: None)
    assert together == read_all()


def pin_setup() -> Setup:
    return default_setup(PIN_WEAR, PIN_OFFER.origin)


# Measured data

GERMAN = "time [h];depth [1e-6 m];run\r\n1,5;2;a\r\n2;,5;a\r\n"
ENGLISH = "time [h],depth [um],run\n1.5,2,a\n2,.5,a\n"


@pytest.mark.parametrize(
    "content",
    [
        ENGLISH,
        GERMAN,
        "\ufeff" + GERMAN,
        "\ufeff" + ENGLISH.replace("\n", "\r\n"),
        ENGLISH.replace(",", "\t"),
        GERMAN.replace(";", "\t"),
        ENGLISH.replace(",", ";"),
        '"time [h]" , "depth [um]" , "run"\n"1.5" , "2" , "a"\n2 , 0.5 , "a"\n',
        "# rig 7, Monday\n\n" + ENGLISH + "\n# end\n\n",
        ENGLISH.replace("\n", ",\n"),
        "time[min],depth[mm],run\n90,2e-3,a\n+120,5E-4,a\n",
    ],
)
def test_every_way_to_write_the_same_table(table: Write, content: str) -> None:
    found = read(table(content))
    np.testing.assert_allclose(found.columns["time"], [5400.0, 7200.0], rtol=1e-15)
    np.testing.assert_allclose(found.columns["depth"], [2e-6, 0.5e-6], rtol=1e-15)
    assert found.columns["run"] == ("a", "a")
    assert len(found) == 2


def test_units_lines_and_missing_cells(table: Write) -> None:
    content = 'time [h],note,depth [um],probe_temperature [degF]\n1,"two ""lines""" ,,50\n#\n\n2,x,3,\n,,nan,68\n'
    found = read(table(content))
    assert found.lines == (2, 5, 6)
    assert found.units == {"time": "h", "note": "", "depth": "um", "probe_temperature": "degF"}
    np.testing.assert_array_equal(found.columns["time"], [3600.0, 7200.0, math.nan])
    np.testing.assert_array_equal(np.isnan(found.columns["depth"]), [True, False, True])
    np.testing.assert_allclose(found.columns["probe_temperature"], [283.15, math.nan, 293.15], rtol=1e-12)
    assert found.columns["note"] == ('two "lines"', "x", "")


def test_unknown_columns_are_kept_in_si_where_their_unit_is_known(table: Write) -> None:
    content = "oil [degC],play [mm],gain,wind [Bft],batch,time [h]\n20,3,1,4,A7,1\n30,4,2,5,8,2\n"
    found = read(table(content))
    np.testing.assert_allclose(found.columns["oil"], [293.15, 303.15])
    np.testing.assert_allclose(found.columns["play"], [3e-3, 4e-3])
    np.testing.assert_array_equal(found.columns["gain"], [1, 2])
    np.testing.assert_array_equal(found.columns["wind"], [4, 5])
    assert found.columns["batch"] == ("A7", "8")


def test_a_standard_deviation_is_a_difference(table: Write) -> None:
    content = "probe_temperature [degC],sigma_probe_temperature [K],depth [um],sigma_depth [nm]\n20,0.5,1,100\n"
    found = read(table(content))
    np.testing.assert_allclose(found.columns["sigma_probe_temperature"], [0.5])
    np.testing.assert_allclose(found.columns["sigma_depth"], [1e-7])
    (sentence,) = data_faults(table("time [h],sigma_depth [N]\n1,2\n"))
    assert sentence == "1: column 'sigma_depth [N]': 'N' is a force (N), expected a length (µm)"
    assert data_faults(table("sigma_depth [um]\n1\n-2\n")) == ["3: sigma_depth: a standard deviation is 0 or more"]


def test_a_run_is_a_label_even_where_it_is_a_number_and_a_pure_number_needs_no_unit(table: Write) -> None:
    assert read(table("run,time [h]\n1,2\n2,3\n")).columns["run"] == ("1", "2")
    for mark in ("[-]", "[1]", "[]", ""):
        np.testing.assert_array_equal(read(table(f"rate {mark}\n3e-8\n")).columns["rate"], [3e-8])


OPEN = "opens a quotation mark that this line does not close; a cell ends in the line in which it begins"
"""What an unclosed quotation mark is answered with."""


@pytest.mark.parametrize(
    ("content", "sentences"),
    [
        ("time\n1\n", ["1: column 'time' has no unit; it is a time: write 'time [h]'"]),
        ("time [mm]\n1\n", ["1: column 'time [mm]': 'mm' is a length (mm), expected a time (h)"]),
        ("depth [mms]\n1\n", ["1: column 'depth [mms]': unknown unit 'mms'; did you mean 'mm'?"]),
        ("slope [degC]\n1\n", ["1: column 'slope [degC]': 'degC' is a temperature level (°C), expected "]),
        ("time [h],depth [um],time [s]\n1,2,3\n", ["1: the column 'time' occurs twice"]),
        ("time [h],,depth [um]\n1,2,3\n", ["1: column 2 has no name"]),
        ("time [h\n1\n", ["1: the header 'time [h' cannot be read; write it like 'load [N]'"]),
        ("time [h]\n", ["1: holds a header but no rows"]),
        (
            "time [h],depth [um]\n1\n2,3\n4,5,6\n1,5,2,3\n",
            [
                "2: this row has 1 cell, expected 2 as in the header",
                "4: this row has 3 cells, expected 2 as in the header; with decimal commas, ",
                "5: this row has 4 cells, expected 2 as in the header; with decimal commas, ",
            ],
        ),
        (
            "time [h];depth [um]\nx;1.234,5\n3 mm;inf\n1e400;1_0\n1;1.234.567\n",
            [
                "2: time: 'x' is no number",
                "2: depth: '1.234,5' has marks between the thousands; write the digits alone",
                "3: time: '3 mm' holds more than a number; the unit stands in the header, as in 'load [N]'",
                "3: depth: 'inf' is not a finite number",
                "4: time: '1e400' is too large for a number",
                "4: depth: '1_0' holds more than a number",
                "5: depth: '1.234.567' has marks between the thousands",
            ],
        ),
        ('time [h],depth [um]\n"1,5",2\n', [
            "2: time: '1,5' has a decimal comma; put semicolons between the columns, or write a point"
        ]),
        ("time [mm],depth\n1,x\n2\n", [
            "1: column 'time [mm]': 'mm' is a length (mm), expected a time (h)",
            "1: column 'depth' has no unit; it is a length: write 'depth [um]'",
            "2: depth: 'x' is no number",
            "3: this row has 1 cell, expected 2 as in the header",
        ]),
        ('depth [um],note\n5,ok\n6,"start\n9.99,bad\n30,last\n', [f"3: cell 2 {OPEN}"]),
        ('depth [um],note\n5,ok\n6,"end', [f"3: cell 2 {OPEN}"]),
        ('depth [um],note\n5,"two\nlines"\n', [
            f"2: cell 2 {OPEN}", "3: this row has 1 cell, expected 2 as in the header"
        ]),
        ('depth [um],"note\n5,ok\n', [f"1: cell 2 {OPEN}"]),
        ('depth [um],note\n"5"0,ok\n', [
            "2: cell 1 goes on behind its closing quotation mark; write a quotation mark inside of a quoted cell twice"
        ]),
        ("run,depth [um]\n#3,5\n# a remark\n4,6\n", [
            "2: this line begins with '#' and holds 2 cells as a row does; put '#3' in quotation marks where it is "
            "one, and a remark above the header"
        ]),
        ("depth [um];time [h]\n1.050;1\n950,5;1\n1,050;1\n", [
            "3: '950,5' and '1.050' in line 2 have different decimal marks; write one mark in the whole file, and none "
            "between the thousands"
        ]),
        ("depth [um];gain\n1,5;1.5\n", [
            "2: '1,5' and '1.5' in line 2 have different decimal marks; write one mark in the whole file, and none "
            "between the thousands"
        ]),
        ("depth [um];time [h]\n1,050;1\n20,000;1\n", [
            "2: depth: '1,050' may be 1.050 or 1050, and no other number decides; write '1,0500' or '1050'",
            "3: depth: '20,000' may be 20.000 or 20000, and no other number decides; write '20,0000' or '20000'",
        ]),
        ("time [h]\n\u0665\n\uff15\n", [
            "2: time: '\u0665' is no number; digits are 0 to 9", "3: time: '\uff15' is no number; digits are 0 to 9"
        ]),
        ("probe_temperature [degC]\n-300\n-273.15\n", ["2: probe_temperature: '-300 degC' lies below absolute zero"]),
        ("time [h]\n1e306\n1e-400\n", [
            "2: time: '1e306 h' is too large for a number in SI units", "3: time: '1e-400' is too small for a number"
        ]),
    ],
)  # fmt: skip
def test_faults_of_a_table(table: Write, content: str, sentences: list[str]) -> None:
    found = data_faults(table(content))
    assert len(found) == len(sentences)
    for one, beginning in zip(found, sentences, strict=True):
        assert one.startswith(beginning)


def test_a_mark_that_the_file_decides(table: Write) -> None:
    for content in ("depth [um];time [h]\n1,050;0,5\n", "depth [um]\n1.050\n", "depth [um];x\n1.050;\n"):
        np.testing.assert_allclose(read(table(content)).columns["depth"], [1.05e-6], rtol=1e-15)


def test_words_for_missing_are_faults_in_a_column_of_inputs(table: Write) -> None:
    path = table("time [h],depth [um]\nNaN,NaN\n1,2\n")
    assert math.isnan(read(path).columns["time"][0])  # type: ignore[arg-type]
    assert faults(lambda: read(path, is_measured=False)) == [
        f"2: {name}: 'NaN' is no number; leave the cell empty where a value is missing" for name in ("time", "depth")
    ]


EMPTY = "is empty; the first line of a table holds the names, with units such as 'load [N]'"


@pytest.mark.parametrize(
    ("name", "content", "sentence"),
    [
        *(("rows.csv", content, EMPTY) for content in (b"", b"\n  \n", b"# only words\n")),
        ("rows.csv", b"a\0b", "is a binary file; a table is CSV text in UTF-8"),
        *((name, b"PK\x03\x04", "is a spreadsheet; save it as .xlsx or CSV UTF-8") for name in ("a.csv", "a.ods")),
        ("rows.csv", "time [h]\n1".encode("utf-16"), "is text in UTF-16; save it as UTF-8"),
        ("rows.csv", "note\nPrüfung\n".encode("latin-1"), "is not UTF-8 text; save it as CSV UTF-8"),
        ("rows.csv", b"note\n" + b"x" * 1_000_001, ":2: this line has 1000001 characters; at most 1000000 are "),
    ],
)
def test_a_file_that_is_no_table(tmp_path: Path, name: str, content: bytes, sentence: str) -> None:
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(InputError) as caught:
        read(path)
    assert str(path) in str(caught.value)
    assert sentence in str(caught.value)


def test_a_table_above_512_megabytes_is_refused_by_its_size(tmp_path: Path) -> None:
    path = tmp_path / "huge.csv"
    with path.open("wb") as stream:
        stream.truncate(512_000_001)
    begin = time.perf_counter()
    with pytest.raises(InputError, match=r"is too large: 512\.0 MB, at most 512 MB are read"):
        read(path)
    assert time.perf_counter() - begin < 1


def test_many_faults_are_counted(table: Write) -> None:
    found = data_faults(table("time [h]\n" + "x\n" * 1000))
    assert (len(found), found[-1]) == (201, "None: and 800 faults more")


def test_rows_beyond_one_chunk_keep_their_places(table: Write) -> None:
    count = 20_001
    found = read(table("time [s],depth [m],batch\n" + "".join(f"{i},{i / 7!r},b{i}\n" for i in range(count))))
    np.testing.assert_array_equal(found.columns["time"], np.arange(count))
    np.testing.assert_array_equal(found.columns["depth"], np.arange(count) / 7)
    assert found.columns["batch"][-1] == f"b{count - 1}"
    assert found.lines == tuple(range(2, count + 2))


# Cases


def test_cases_override_inputs_and_conditions(table: Write) -> None:
    content = (
        "case;load [kN];rate;probe_temperature [degC];note\nlight;0,1;3e-8;30;as built\n;;;;\nheavy;3;;;x\n;2;;;\n"
    )
    path = table(content)
    cases = read_cases(path, PIN_OFFER, pin_setup())
    assert cases.count == RowCount(str(path), 4, {"holds nothing": (3,)})
    assert list(cases.cases) == [
        StatedCase(1, 2, "light", {"load": 100.0, "rate": 3e-8, "probe_temperature": 303.15}),
        StatedCase(2, 4, "heavy", {"load": 3000.0}),
        StatedCase(3, 5, "3", {"load": 2000.0}),
    ]


def test_cases_of_every_kind_of_input(table: Write) -> None:
    setup = default_setup(STAGE, surface=Surface((1.0,), "1 um"))
    content = "name,reading,is_hardened,planets,teeth_sun\nA,printed,no,4,19\nB,complete,TRUE,3,\n"
    cases = read_cases(table(content), STAGE_OFFER, setup)
    assert [case.values for case in cases.cases] == [
        {"reading": "printed", "is_hardened": False, "planets": 4, "teeth_sun": 19.0},
        {"reading": "complete", "is_hardened": True, "planets": 3},
    ]
    content = "name,reading,is_hardened,planets,teeth_sun,bore_sun\nA,prined,maybe,2.5,4,3\n"
    assert faults(lambda: read_cases(table(content), STAGE_OFFER, setup)) == [
        "1: column 'bore_sun' has no unit; it is a length: write 'bore_sun [mm]'",
        "2: reading = 'prined' is not offered; choose 'printed' or 'complete'. Did you mean 'printed'?",
        "2: is_hardened = 'maybe' is no switch; write is_hardened = true or is_hardened = false",
        "2: planets = 2.5 is no whole number; write planets = 3",
        "2: teeth_sun is 4; it must be at least 5",
    ]
    assert faults(lambda: read_cases(table("surface,orders\na,1\n"), STAGE_OFFER, setup)) == [
        "1: surface cannot change from row to row; state it in the inputs file",
        "1: orders cannot change from row to row; state it in the inputs file",
    ]


def test_faults_of_cases(table: Write) -> None:
    content = "laod [N],depth [um],load [m],area [mm^2],speed [m/s]\n1,2,3,-4,nan\n1,2,3,0,inf\n"
    assert faults(lambda: read_cases(table(content), PIN_OFFER, pin_setup())) == [
        "1: pin_wear has no input 'laod'. Did you mean 'load'?",
        "1: pin_wear has no input 'depth'. It is a result; cases change inputs.",
        "1: column 'load [m]': 'm' is a length (m), expected a force (N)",
        "2: area is -4 mm^2; it must be above 0 mm^2",
        "2: speed: 'nan' is no number; leave the cell empty where a value is missing",
        "3: area is 0 mm^2; it must be above 0 mm^2",
        "3: speed: 'inf' is not a finite number",
    ]


@pytest.mark.parametrize("read", [read_cases, read_rows])
def test_cases_and_rows_keep_what_the_inputs_file_keeps(table: Write, read: Callable[..., object]) -> None:
    """A wrong unit does not hide the cells below it."""
    for content, sentences in {
        "load [m],rate\nx,1\n1,y\n": [
            "1: column 'load [m]': 'm' is a length (m), expected a force (N)",
            "2: load: 'x' is no number",
            "3: rate: 'y' is no number",
        ],
        "probe_temperature [degC],speed [m/s]\n-300,1\n20,1e-400\n-273.15,1\n": [
            "2: probe_temperature: '-300 degC' lies below absolute zero",
            "3: speed: '1e-400' is too small for a number",
        ],
        "load [N]\n1\n-1\n": ["3: load is -1 N; it must be above 0 N"],
    }.items():
        path = table(content)
        assert faults(lambda: read(path, PIN_OFFER, pin_setup())) == sentences  # noqa: B023
    path = table("probe_temperature [degC];speed [m/s]\n1,050;1.5\n")
    (sentence,) = faults(lambda: read(path, PIN_OFFER, pin_setup()))
    assert "have different decimal marks" in sentence


# Rows of a virtual measurement


def test_rows_keep_what_is_written(table: Write) -> None:
    content = "load [kN];probe_temperature [degC];depth [um];batch\n0,1;30;2,5;A\n;;;B\n"
    found = read_rows(table(content), PIN_OFFER, pin_setup())
    np.testing.assert_allclose(found.columns["load"], [100.0, 120.0])
    np.testing.assert_allclose(found.columns["probe_temperature"], [303.15, 293.15])
    assert set(found.columns) == {"load", "probe_temperature"}
    assert found.others == ("depth", "batch")
    assert tuple(found.cells) == ("load [kN]", "probe_temperature [degC]", "depth [um]", "batch")
    assert found.cells["load [kN]"] == ("0.1", "")
    assert found.cells["batch"] == ("A", "B")
    assert len(found) == 2


def test_rows_of_other_kinds_and_of_a_series(table: Write) -> None:
    setup = default_setup(STAGE, surface=Surface((1.0,), "1 um"))
    found = read_rows(table("planets,profile [um],lag [mm]\n4,1,0\n,2,1\n"), STAGE_OFFER, setup)
    assert found.columns == {"planets": [4, 3]}
    np.testing.assert_allclose(found.series["profile"], [1e-6, 2e-6])
    np.testing.assert_allclose(found.axes["lag"], [0, 1e-3])
    assert found.others == ()


# Writing


@drawing(max_examples=50, deadline=None)
@drawn(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=1))
def test_numbers_round_trip_exactly(tmp_path_factory: pytest.TempPathFactory, values: list[float]) -> None:
    path = tmp_path_factory.getbasetemp() / "out.csv"
    path.write_text(table_text(["gain", "x [furlong*zzz]"], [np.array(values), values]))
    found = read(path, {})
    np.testing.assert_array_equal(found.columns["gain"], values)
    np.testing.assert_array_equal(found.columns["x"], values)


def test_what_is_written() -> None:
    columns = [np.array([0.1, math.nan]), ["a,b", 'say "c"'], [1, None], [True, False]]
    assert (
        table_text(["depth [um]", "batch", "planets", "on"], columns)
        == 'depth [um],batch,planets,on\n0.1,"a,b",1,true\n,"say ""c""",,false\n'
    )
    with pytest.raises(ValueError, match="shorter"):
        table_text(["a", "b"], [[1.0, 2.0], [1.0]])
