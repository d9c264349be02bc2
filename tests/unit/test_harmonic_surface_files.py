"""Surfaces from files: every layout of text, what a file says of itself, profilometer formats, and what is refused."""

import pickle
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from harmonic_fractal import flank
from harmonic_fractal import surface as surfaces
from harmonic_fractal.estimate import Estimate
from harmonic_fractal.flank import Flank, read_flank
from harmonic_fractal.generators import brownian_surface
from harmonic_fractal.surface import Direction, Lines, Surface, cut
from harmonic_fractal.surface_files import FileLayout, Reading, read_surface

SURFACES = Path(__file__).parents[1] / "data" / "surfaces"
MICROMETRES = FileLayout(spacing_x=4e-7, spacing_y=4e-7, height_unit="um")
SPACED = FileLayout(spacing_x=1e-6, spacing_y=1e-6)
NOTHING = FileLayout()
HEIGHTS = np.array([[1.5, -2.0, 3.25, 0.5], [0.0, 7.0, -8.125, 1.0], [4.0, 5.0, 6.0, 2.0]])
NONE = np.nan


def read(folder: Path, text: str | bytes, layout: FileLayout = MICROMETRES) -> Reading:
    file = folder / "flank.txt"
    file.write_bytes(text.encode() if isinstance(text, str) else text)
    return read_surface(file, layout)


def refused(folder: Path, text: str | bytes, layout: FileLayout = MICROMETRES) -> str:
    with pytest.raises(ValueError, match=r"\w") as error:
        read(folder, text, layout)
    assert "\n" not in str(error.value)
    return str(error.value)


# A matrix


def lines_of(separator: str, mark: str = ".") -> str:
    return "\n".join(separator.join(str(value).replace(".", mark) for value in row) for row in HEIGHTS)


def grid_points() -> str:
    """Points of the grid in any order."""
    y, x = np.mgrid[0:3, 0:4]
    points = np.stack([x * 0.4 + 7, y * 0.5 - 2, HEIGHTS], axis=-1).reshape(-1, 3)
    shuffled = np.random.default_rng(3).permutation(points)
    return "x [um] y [um] z [nm]\n" + "\n".join(" ".join(map(repr, row)) for row in shuffled.tolist())


SAID = "# spacing_x = 0.4 um\n# spacing_y = 500 nm\n# height_unit = nm\n# filter_width = 1 um\n# anything = else\n"
IN_MICROMETRES = replace(SPACED, height_unit="um")
READ: list[tuple[list[str], FileLayout, Any, tuple[float, float]]] = [  # texts, layout, heights in um, spacing in um
    # separators, decimal signs, comments
    ([lines_of(","), lines_of(", "), lines_of(";"), lines_of("; "), lines_of("\t"), lines_of(" "), lines_of("   "),
      lines_of(";", ","), lines_of("\t", ","), lines_of(" ", ","), lines_of(";").replace("\n", "\r\n"),
      lines_of(",") + "\n\n\n", "# a comment\n\n" + lines_of(","), lines_of(",").replace("\n", "\n# in between\n"),
      "\ufeff" + lines_of(","), lines_of(";").replace("\n", ";\n") + ";", "  " + lines_of(" ").replace("\n", "\n  "),
      "Instrument: none\nheights in um\n" + lines_of(","), lines_of(",").replace("7.0", "7e0")],
     MICROMETRES, HEIGHTS, (0.4, 0.4)),
    # what was not measured is a hole and never zero; a row of holes keeps its place
    (["1.5,,3.25\n,7,-8.125", "1.5, ,3.25\n ,7,-8.125", "1.5;nan;3.25\nNaN;7;-8.125", "1.5\t\t3.25\n\t7\t-8.125",
      "1.5 *** 3.25\n*** 7 -8.125", "1,5 *** 3,25\nnan 7 -8,125", "1.5;---;3.25\nN/A;7;-8.125"],
     MICROMETRES, [[1.5, NONE, 3.25], [NONE, 7.0, -8.125]], (0.4, 0.4)),
    (["1,2,3,4\n,,,\n5,6,7,8\n9,9,,9", "1;2;3;4\n;;;\n5;6;7;8\n9;9;;9", "1\t2\t3\t4\n\t\t\t\n5\t6\t7\t8\n9\t9\t\t9"],
     MICROMETRES, [[1, 2, 3, 4], [NONE] * 4, [5, 6, 7, 8], [9, 9, NONE, 9]], (0.4, 0.4)),
    # one column and one row are profiles
    (["1\n2\nnan\n4\n", "1,2,,4"], MICROMETRES, [[1, 2, NONE, 4]], (0.4, NONE)),
    # a file that speaks for itself; a unit of metres per count; lines at the top that look like numbers
    ([SAID + lines_of(",")], NOTHING, 1e-3 * HEIGHTS, (0.4, 0.5)),
    (["# spacing = 2 um\n# height_unit: mm\n" + lines_of(",")], NOTHING, 1e3 * HEIGHTS, (2.0, 2.0)),
    ([lines_of(" ")], replace(SPACED, height_unit="2.91818e-8 m"), 2.91818e-2 * HEIGHTS, (1.0, 1.0)),
    (["3 4\n0.4\n" + lines_of(" ")], replace(IN_MICROMETRES, skip_lines=2), HEIGHTS, (1.0, 1.0)),
    # two columns are a profile, whatever their heads; points in any order, and missing ones are holes
    ([head + "\n10;1,5\n10,5;2\n11;-3\n11,5;4\n" for head in (
        "x [um];z [nm]", "# x [um]; z [nm]", "X;Z\n[um];[nm]", "X;Y\n[um];[nm]", "Position (um);Height (nm)",
        "x/um;z/nm", '"x [um]";"z [nm]"', "Instrument\n12 July\nx [um];z [nm]")],
     NOTHING, [[1.5e-3, 2e-3, -3e-3, 4e-3]], (0.5, NONE)),
    (["0 1\n1 2\n2 3\n"], FileLayout(columns=("x [um]", "z [um]")), [[1, 2, 3]], (1.0, NONE)),
    (["x [um],z [um]\n3,13\n0,10\n1,11\n5,15\n6,16\n7,17\n"],
     NOTHING, [[10, 11, NONE, 13, NONE, 15, 16, 17]], (1.0, NONE)),
    (["X;Y;valid\r\n[mm];[mm];[1/0]\r\n8.6720;106.1;1\r\n8.6725;999;0\r\n8.6730;106.3;1\r\n"],
     NOTHING, [[106.1e3, NONE, 106.3e3]], (0.5, NONE)),
    ([grid_points()], NOTHING, 1e-3 * HEIGHTS, (0.4, 0.5)),
    (["\n".join(line for line in grid_points().split("\n") if not line.endswith("-8.125"))],
     NOTHING, np.where(HEIGHTS == -8.125, NONE, 1e-3 * HEIGHTS), (0.4, 0.5)),
    # spacing may differ by one per cent
    (["x [um],z [um]\n0,1\n1,2\n2.009,3\n3,4\n4,5\n"], NOTHING, [[1, 2, 3, 4, 5]], (1.0, NONE)),
]  # fmt: skip


@pytest.mark.parametrize(
    ("text", "layout", "expected", "spacing"), [(text, *rest) for texts, *rest in READ for text in texts]
)
def test_texts_that_are_read(
    text: str, layout: FileLayout, expected: Any, spacing: tuple[float, float], tmp_path: Path
) -> None:
    found = read(tmp_path, text, layout).surface
    np.testing.assert_allclose(found.heights * 1e6, expected, rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose([found.spacing_x * 1e6, found.spacing_y * 1e6], spacing, rtol=1e-9)
    assert found.is_profile is (len(expected) == 1)
    assert found.name == "flank.txt"


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_encodings(encoding: str, tmp_path: Path) -> None:
    text = "# Prüfling, Höhe in µm\n# height_unit = µm\n" + lines_of(";", ",")
    assert read(tmp_path, text.encode(encoding), SPACED).surface.heights * 1e6 == pytest.approx(HEIGHTS)


def test_what_is_stated_overrides_the_file_and_is_said(tmp_path: Path) -> None:
    found = read(tmp_path, "# spacing = 2 um\n# height_unit = mm\n" + lines_of(","))
    assert found.surface.heights == pytest.approx(HEIGHTS * 1e-6)
    assert found.surface.spacing_x == 4e-7
    assert len(found.remarks) == 3
    assert "spacing_x is 0.4 um as stated; the file says 2 um" in found.remarks
    assert not read(tmp_path, "# spacing = 0.4 um\n# height_unit = um\n" + lines_of(",")).remarks
    assert read(tmp_path, SAID + lines_of(","), NOTHING).filter_width == pytest.approx(1e-6)


REFUSED: list[tuple[str, FileLayout, str]] = [
    *((text, MICROMETRES, words) for text, words in (
        ("1\n2\n\n4\n", "line 3 is empty"), ("3 4\n0.4\n" + lines_of(" "), "skip_lines"),
        ("", "empty"), ("  \n \n", "empty"), ("no numbers at all", "no line of the file holds numbers"),
        ("five,2,3,4\n1,2,3,4\n", "line 1: 'five' is no number"), ("five,2,3,4\n1,2,3,4\n", "skip_lines = 1"),
        ("# only\n# comments\n", "no line of the file holds numbers"), ("1,2,3,4\n1,2,3\n", "line 2 has 3 cells"),
        ("1,2,3,4\n1,x7,3,4\n", "line 2: 'x7' is no number"), ("1;2;3;4\n1;1.234,5;3;4\n", "line 2"),
        ("1,2,3,4\n1,inf,3,4\n", "line 2: infinite"), ("1,2,3,4\n1,1_0,3,4\n", "line 2"),
        ("1,2,3,4\n1,\u0665,3,4\n", "line 2: '\u0665' is no number"),
        ("1,2\n3,4\n5,6\n7,8\n9,10\n", "without names"), (",,,\n,,,\n", "no point of the surface is measured"),
        *((f"# {line}\n{lines_of(',')}", line.partition(" ")[0]) for line in (
            "spacing = 0.4", "spacing = 0.4 kg", "spacing_x = -1 um", "spacing_y = wide", "filter_width = 1 s")),
    )),
    *((lines_of(","), layout, words) for layout, words in (
        (SPACED, "height_unit"), (FileLayout(height_unit="um"), 'spacing = "0.4 um"'),
        (FileLayout(spacing_x=1e-6, height_unit="um"), "spacing_y"),
        (replace(SPACED, height_unit="rad"), "the length of one count"),
        (replace(SPACED, height_unit="counts"), "the length of one count"),
        (replace(SPACED, height_unit="2 kg"), "no length"), (replace(SPACED, height_unit="-1 um"), "above 0"),
        (replace(SPACED, height_unit="um", skip_lines=99), "skip_lines = 99"),
    )),
    *((text, NOTHING, words) for text, words in (
        ("x,z [um]\n0,1\n1,2\n", "column x has no unit"), ("x [um],z\n0,1\n1,2\n", "height_unit"),
        ("x [um],z [rad]\n0,1\n1,2\n", "the length of one count"), ("x [s],z [um]\n0,1\n1,2\n", "the unit of column x"),
        ("x [um],valid\n0,1\n1,1\n", "no column z"), ("y [um],z [um]\n0,1\n1,1\n", "no column x"),
        ("x [um],z [um]\n0,1\n0,2\n0,3\n", "all points have the same x"),
        ("x [um],z [um]\n0,1\n1,2\n1,3\n2,4\n", "two points have x = 1e-06 m"),
        ("x [um],z [um]\n0,1\n1,2\n2.02,3\n3.02,4\n4.02,4\n", "unequal: 1.02e-06 m at x = 1e-06 m"),
        ("x [um],z [um]\n0,1\n1,2\n,3\n3,4\n", "line 4: the point has no x"),
        ("x [um],y [um],z [um]\n0,0,1\n1,0,2\n0,1,3\n1,1,4\n1,1,5\n", "two points at column 2 of row 2"),
        ("x [um],y [um],z [um]\n0,0,1\n1,0.1,2\n-0.1,1,3\n0.9,1.1,4\n", "no full grid"),
        ("x [um],y [um],z [um]\n0,0,1\n1,0,2\n2,0,3\n0,1,3\n1.02,1,4\n2,1,3\n", "unequal"),
    )),
    ("0 1\n1 2\n", FileLayout(columns=("x [um]",)), "must name the 2 columns"),
    ("0 1\n1 2\n", FileLayout(columns=("x [um]", "colour")), "must name"),
    ("0 1\n1 2\n", FileLayout(columns=("x [um]", "x [um]")), "two columns are x"),
    ("x [um],z [um]\n0,1\n1,2\n2,3\n", FileLayout(spacing_x=2e-6), "spacing_x is stated as 2 um"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "layout", "words"), REFUSED)
def test_texts_that_are_refused(text: str, layout: FileLayout, words: str, tmp_path: Path) -> None:
    assert words in refused(tmp_path, text, layout)


# Real files, read by the layouts of their formats


@pytest.mark.parametrize(
    ("name", "place", "hole"),
    [
        ("metropro-1.dat", 834 + 640 * 480 * 2 + 4 * (640 * 7 + 5), (2147483640).to_bytes(4, "big")),
        ("al3d-1.al3d", 1261 + 800 * 7 + 4 * 5, np.float32(3.000000028082e15).tobytes()),
    ],
)
def test_holes_of_profilometer_formats(name: str, place: int, hole: bytes, tmp_path: Path) -> None:
    pytest.importorskip("SurfaceTopography")
    content = bytearray((SURFACES / name).read_bytes())
    content[place : place + 4] = hole
    (tmp_path / name).write_bytes(content)
    found = read_surface(tmp_path / name, NOTHING).surface
    assert np.argwhere(np.isnan(found.heights)).tolist() == [[7, 5]]


# The optional library


@pytest.mark.parametrize(
    ("layout", "words"),
    [
        (FileLayout(spacing_x=2e-6), "spacing_x is stated as 2 um, and the file says 1.09825 um"),
        (FileLayout(height_unit="nm"), "leave it out"), (FileLayout(skip_lines=3), "skip_lines belongs to text files"),
        (FileLayout(columns=("x [um]", "z [um]")), "columns belongs to text files"),
    ],
)  # fmt: skip
def test_what_contradicts_a_profilometer_file_is_refused(layout: FileLayout, words: str) -> None:
    pytest.importorskip("SurfaceTopography")
    with pytest.raises(ValueError, match="m") as error:
        read_surface(SURFACES / "metropro-1.dat", layout)
    assert words in str(error.value)


STANDARD = """aISO-1.0
ManufacID   = maker
CreateDate  = 010120201200
ModDate     = 010120201200
NumPoints   = 4
NumProfiles = 3
Xscale      = 1e-6
Yscale      = 2e-6
Zscale      = 1e-9
Zresolution = -1
Compression = 0
DataType    = 7
CheckType   = 0
*
0 1 2 3
4 5 BAD 7
8 9 10 11
*
"""


def test_standard_text_of_surfaces_is_in_metres(tmp_path: Path) -> None:
    """ISO 25178-71: all scales are in m; x runs along a row."""
    pytest.importorskip("SurfaceTopography")
    file = tmp_path / "flank.sdf"
    file.write_text(STANDARD, encoding="ascii")
    found = read_surface(file, NOTHING).surface
    expected = np.arange(12.0).reshape(3, 4)
    expected[1, 2] = np.nan
    np.testing.assert_allclose(found.heights * 1e9, expected, atol=1e-12)
    assert (found.spacing_x, found.spacing_y) == pytest.approx((1e-6, 2e-6))
    file.write_text(STANDARD.replace("aISO", "aBCR"), encoding="ascii")
    with pytest.raises(ValueError, match="none of its formats"):
        read_surface(file, NOTHING)


def test_a_format_without_lengths_needs_them_stated(tmp_path: Path) -> None:
    pytest.importorskip("SurfaceTopography")
    np.save(tmp_path / "flank.npy", HEIGHTS.T)  # the library puts x first
    for layout, words in (
        (FileLayout(), "height_unit"), (FileLayout(height_unit="um"), "spacing of its points"),
        (FileLayout(height_unit="um", spacing_x=1e-6), "spacing of its rows"),
    ):  # fmt: skip
        with pytest.raises(ValueError, match=words):
            read_surface(tmp_path / "flank.npy", layout)
    found = read_surface(tmp_path / "flank.npy", FileLayout(height_unit="um", spacing_x=1e-6, spacing_y=2e-6)).surface
    assert found.heights == pytest.approx(HEIGHTS * 1e-6)
    assert (found.spacing_x, found.spacing_y) == (1e-6, 2e-6)


def test_a_file_that_nobody_can_read(tmp_path: Path) -> None:
    pytest.importorskip("SurfaceTopography")
    assert "SurfaceTopography cannot read this file" in refused(tmp_path, bytes(range(256)) * 20)
    cut = (SURFACES / "metropro-1.dat").read_bytes()[:5000]
    assert "SurfaceTopography cannot read this file" in refused(tmp_path, cut)


# Lines of a surface


def test_lines_along_x_along_y_and_both() -> None:
    surface = Surface(HEIGHTS, 1e-6, 1.005e-6, "three rows")
    assert np.array_equal(surface.lines("x").heights, HEIGHTS)
    assert np.array_equal(surface.lines("y").heights, HEIGHTS.T)
    assert surface.lines("y").spacing == 1.005e-6
    both = surface.lines("both").heights
    assert np.array_equal(both[:3], HEIGHTS)
    assert np.array_equal(both[3:, :3], HEIGHTS.T)
    assert np.isnan(both[3:, 3]).all()
    with pytest.raises(ValueError, match="cannot be pooled"):
        surfaces.pooled(Lines(HEIGHTS, 1e-6), Lines(HEIGHTS, 1.02e-6))


# Cleaning of a surface and the options of a flank: form, rectangle, lines, spikes, choice, and every refusal.

Array = NDArray[np.float64]
SHAPE = (70, 90)


def noise(shape: tuple[int, int] = SHAPE, seed: int = 5) -> Array:
    return np.random.default_rng(seed).standard_normal(shape)


def holed(heights: Array, share: float, seed: int = 8) -> Array:
    return np.where(np.random.default_rng(seed).random(heights.shape) < share, np.nan, heights)


# Form


def second_order(rows: int, points: int) -> Array:
    x, y = np.arange(points)[None, :] * 1.0, np.arange(rows)[:, None] * 1.0
    return 7.0 - 0.3 * x + 0.5 * y + 0.02 * x**2 - 0.013 * x * y + 0.04 * y**2


@pytest.mark.parametrize(("form", "order"), [("plane", 1), ("second_order", 2)])
def test_what_is_left_is_the_rest_of_least_squares(form: Any, order: int) -> None:
    """Of a map with holes, and of one line: of which a parabola is left over, or a straight line."""
    heights = holed(noise(), 0.1)
    known = np.isfinite(heights)
    y, x = (place[known] / 50.0 for place in np.mgrid[0:70, 0:90])
    terms = [np.ones_like(x), x, y] + ([x * x, x * y, y * y] if order == 2 else [])
    design = np.stack(terms, axis=1)
    expected = heights[known] - design @ np.linalg.lstsq(design, heights[known], rcond=None)[0]
    assert surfaces.without_form(heights, form)[known] == pytest.approx(expected, abs=1e-12)
    assert np.array_equal(heights, holed(noise(), 0.1), equal_nan=True)  # the argument is left alone
    along = np.arange(200.0)
    fitted = np.polyval(np.polyfit(along, along**3, order), along)
    assert surfaces.without_form(along[None] ** 3, form)[0] == pytest.approx(along**3 - fitted, abs=1e-5)


def test_form_of_a_high_part_keeps_the_digits_of_its_roughness() -> None:
    rough = 1e-9 * noise()
    lifted = 0.1066 + 1e-4 * second_order(*SHAPE) / 100.0 + rough
    assert surfaces.without_form(lifted, "second_order") == pytest.approx(
        surfaces.without_form(rough, "second_order"), abs=1e-16 * 200
    )


def test_each_line_loses_its_own_straight_line() -> None:
    heights = holed(noise(), 0.2) + np.outer(np.arange(70.0), np.arange(90.0)) + np.arange(70.0)[:, None]
    for before, after in zip(heights, surfaces.without_line(heights), strict=True):
        known = np.isfinite(before)
        x = np.arange(90.0)[known]
        assert after[known] == pytest.approx(before[known] - np.polyval(np.polyfit(x, before[known], 1), x), abs=1e-10)
        assert np.isnan(after[~known]).all()


def test_lines_of_one_point_or_of_none() -> None:
    found = surfaces.without_line(np.array([[np.nan, 3.0, np.nan], [np.nan, np.nan, np.nan], [1.0, np.nan, 5.0]]))
    assert np.array_equal(np.isnan(found), [[1, 0, 1], [1, 1, 1], [0, 1, 0]])
    assert found[[0, 2, 2], [1, 0, 2]] == pytest.approx(0.0, abs=1e-15)


# Rectangle

PATCH = Surface(np.arange(300.0 * 600.0).reshape(300, 600), 0.4e-6, 0.5e-6, "patch")


@pytest.mark.parametrize(
    ("size", "corner", "shape", "first"),
    [
        ((200e-6, 100e-6), None, (201, 501), 49 * 600 + 49),  # of the patent, from the middle
        ((40e-6, 20e-6), (10e-6, 5e-6), (41, 101), 10 * 600 + 25),
        ((599 * 0.4e-6, 299 * 0.5e-6), None, (300, 600), 0),
        ((600 * 0.4e-6, 300 * 0.5e-6), None, (300, 600), 0),  # points are taken as wide as spacing
    ],
)
def test_a_rectangle(size: Any, corner: Any, shape: tuple[int, int], first: int) -> None:
    found = cut(PATCH, size, corner)
    assert (found.heights.shape, found.heights[0, 0]) == (shape, first)
    assert (found.spacing_x, found.spacing_y) == (0.4e-6, 0.5e-6)


def test_a_part_of_a_line() -> None:
    assert cut(Surface(np.arange(50.0)[None], 1e-6, np.nan, "line"), (9e-6,), (5e-6,)).heights[0, 0] == 5


@pytest.mark.parametrize(
    ("size", "corner", "words"),
    [
        ((300e-6, 100e-6), None, "leaves the surface along x: 300 um, and there are 239.6 um"),
        ((200e-6, 200e-6), None, "leaves the surface along y"),
        ((200e-6, 100e-6), (50e-6, 0.0), "along x: 200 um from 50 um"), ((200e-6,), None, "two lengths"),
        ((200e-6, 100e-6), (0.0,), "two lengths"),
    ],
)  # fmt: skip
def test_rectangles_that_are_refused(size: Any, corner: Any, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        cut(PATCH, size, corner)


# Spikes


def hampel_by_loop(line: Array) -> list[bool]:
    found = []
    for place, value in enumerate(line):
        window = line[max(0, place - 5) : place + 6]
        window = window[np.isfinite(window)]
        middle = np.median(window) if window.size >= 6 else np.nan
        limit = 4.0 * 1.4826022185 * np.median(np.abs(window - middle)) if window.size >= 6 else np.nan
        found.append(bool(abs(value - middle) > limit))
    return found


@pytest.mark.parametrize("share", [0.0, 0.4])
def test_spikes_are_those_of_the_loop_over_points(share: float) -> None:
    heights = holed(noise() ** 3, share)
    found = surfaces.spikes_of(heights)
    assert found.tolist() == [hampel_by_loop(line) for line in heights]
    assert found.any()
    assert not surfaces.spikes_of(holed(noise() ** 3, 0.9)).any()


def test_spikes_in_a_wide_map_of_many_blocks() -> None:
    heights = np.cumsum(noise((3, 100_000)), axis=1)
    heights[2, 99_990] += 100.0
    assert surfaces.spikes_of(heights)[2, 99_990]
    assert np.array_equal(surfaces.spikes_of(heights)[2], surfaces.spikes_of(heights[2:])[0])


def test_steps_of_the_instrument_are_no_spikes() -> None:
    line = np.zeros((1, 100))
    line[0, 40] = 2.0
    line[0, 70] = 9.0
    assert np.flatnonzero(surfaces.spikes_of(line)).tolist() == [40, 70]
    assert np.flatnonzero(surfaces.spikes_of(line, 2.0)).tolist() == [70]


def test_quantisation_is_the_least_step() -> None:
    counts = np.round(noise() * 20.0)
    assert surfaces.quantisation(counts * 8.7e-12) == pytest.approx(8.7e-12, rel=1e-9)
    assert surfaces.quantisation(holed(counts * 8.7e-12 + 1e-9, 0.2)) == pytest.approx(8.7e-12, rel=1e-6)
    assert surfaces.quantisation(noise()) < 1e-4
    assert surfaces.quantisation(np.full((3, 3), 2.0)) == 0.0


# A flank from a file


def write(folder: Path, heights: Array, *lines: str, name: str = "flank.csv") -> Path:
    head = lines or ("# spacing = 0.4 um", "# height_unit = um")
    rows = [",".join("" if np.isnan(value) else repr(value) for value in row) for row in heights.tolist()]
    file = folder / name
    file.write_text("\n".join([*head, *rows]) + "\n", encoding="utf-8")
    return file


def rough(seed: int = 1, shape: tuple[int, int] = (150, 180)) -> Array:
    """A Brownian surface of dimension 2.5: an exact power law, and waves longer than itself as a real one has."""
    heights = brownian_surface(1.5, 1.0, shape, np.random.default_rng(seed))
    return np.asarray(heights / heights.std())


@pytest.fixture(scope="module")
def rough_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write(tmp_path_factory.mktemp("alike"), rough())


@pytest.fixture(scope="module")
def alike(rough_file: Path) -> Flank:
    """The rough surface as it is read without any option."""
    return read_flank(rough_file)


def test_a_flank_alike_in_all_directions_is_pooled(alike: Flank) -> None:
    assert alike.chosen == "both"
    assert alike.reason == ""
    assert [estimate.direction for estimate in alike.estimates] == ["x", "y", "both"]
    used = alike.used
    assert used is not None
    assert used.dimension == pytest.approx(1.5, abs=0.08)
    assert alike.resampled is used.resampled
    assert len(alike.resampled) > 100
    assert alike.height == pytest.approx(np.nanmax(alike.surface.heights) - np.nanmin(alike.surface.heights))


def test_spacings_that_differ_cannot_be_pooled(tmp_path: Path) -> None:
    file = write(tmp_path, rough(), "# spacing_x = 0.4 um", "# spacing_y = 0.5 um", "# height_unit = um")
    found = read_flank(file)
    assert found.chosen == "x"
    assert "direction of sliding, x, is used" in found.warnings[-1]
    assert read_flank(file, sliding="y").chosen == "y"
    with pytest.raises(ValueError, match="cannot be pooled"):
        read_flank(file, direction="both")


def test_a_flank_that_is_rougher_along_one_direction_is_not_pooled(tmp_path: Path) -> None:
    """Ridges, of a random walk, above a surface alike in all directions: the same dimension, but other heights."""
    walk = np.cumsum(np.random.default_rng(3).normal(0.0, 0.6, 180))
    ridges = walk + rough()
    found = read_flank(write(tmp_path, ridges))
    assert found.chosen == "x"
    assert [estimate.dimension for estimate in found.estimates] == pytest.approx([1.5, 1.5], abs=0.15)
    assert "its structure function along x is" in found.warnings[0]
    assert read_flank(write(tmp_path, ridges.T), sliding="y").chosen == "y"


def test_a_direction_without_relief_is_refused(tmp_path: Path) -> None:
    """Ridges alone: along them there is nothing but the rounding of the numbers in the file."""
    profile = rough(2, (3, 300))[0]
    found = read_flank(write(tmp_path, np.broadcast_to(profile, (150, 300))), form="none")
    assert [bool(estimate.reason) for estimate in found.estimates] == [False, True]
    assert found.chosen == "x"
    assert "along y" in " ".join(found.warnings)


@pytest.mark.parametrize("direction", ["x", "y"])
def test_the_direction_that_is_asked_for(direction: str, rough_file: Path) -> None:
    assert read_flank(rough_file, direction=direction).chosen == direction


def settled(direction: Direction, dimension: float, reason: str = "") -> Estimate:
    nothing = np.empty(0)
    return Estimate(
        direction=direction, lags=nothing, values=nothing, local_lags=nothing, local_dimensions=nothing,
        dimension=dimension, roughness=1e-11, r_squared=0.99, line_scatter=0.05, noise=0.0, range=(1e-6, 2e-5),
        reason=reason, resampled=np.full((3, 2), dimension), spacing=4e-7,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("x", "y", "sliding", "chosen", "words"),
    [
        ((1.50, ""), (1.60, ""), "x", "both", ""), ((1.50, ""), (1.66, ""), "x", "x", "anisotropic"),
        ((1.50, ""), (1.66, ""), "y", "y", "1.500 along x and 1.660 along y"),
        ((1.50, "too smooth"), (1.60, ""), "x", "y", "y alone is used; along x: too smooth"),
        ((1.50, ""), (1.60, "too rough"), "y", "x", "x alone is used; along y: too rough"),
        ((1.50, "too smooth"), (1.60, "too rough"), "x", None, ""),
    ],
)  # fmt: skip
def test_the_choice_of_direction(
    x: Any, y: Any, sliding: str, chosen: str | None, words: str, rough_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    said = {"x": settled("x", *x), "y": settled("y", *y), "both": settled("both", 1.55)}

    def estimate_of(lines: Lines, direction: Direction, settings: Any) -> Estimate:
        assert np.nanmax(np.abs(np.nanmean(lines.heights, axis=1))) < 1e-15  # each line is level
        return said[direction]

    monkeypatch.setattr(flank, "estimate_of", estimate_of)
    found = read_flank(rough_file, sliding=sliding)
    assert found.chosen == chosen
    assert words in " ".join(found.warnings)
    assert found.reason == ("along x: too smooth; along y: too rough" if chosen is None else "")


def test_a_flank_travels_between_processes_and_cannot_be_changed(alike: Flank) -> None:
    content = pickle.dumps(alike)
    again = pickle.loads(content)
    assert np.array_equal(again.surface.heights, alike.surface.heights, equal_nan=True)
    assert again.used.dimension == alike.used.dimension  # type: ignore[union-attr]
    assert len(content) < 2.5 * alike.raw.heights.nbytes
    for surface in (alike.raw, alike.surface, again.surface):
        with pytest.raises(ValueError, match="read-only"):
            surface.heights[0, 0] = 1.0


def test_shares_and_heights_of_the_rectangle(tmp_path: Path) -> None:
    heights = holed(rough(1, (256, 320)), 0.03)
    heights[:100] = np.nan  # outside of the rectangle
    heights[200, 100:103] += 50.0
    file = write(tmp_path, heights)
    found = read_flank(file, rectangle=["100 um", "40 um"], corner=["0 um", "50 um"])
    assert found.surface.heights.shape == (101, 251)
    inside = heights[125:226, 0:251]
    assert found.missing == pytest.approx(np.isnan(inside).mean())
    assert 3 / inside.size <= found.spiked < 0.01
    assert found.sq_raw == pytest.approx(np.nanstd(inside) * 1e-6)
    assert found.sq_raw >= found.sq_plane >= found.sq_second_order > np.nanstd(found.surface.heights)
    kept = read_flank(file, rectangle=["100 um", "40 um"], corner=["0 um", "50 um"], spikes="keep")
    assert kept.spiked == found.spiked
    assert kept.height > 40e-6 > found.height


def test_missing_points_are_said_and_too_many_refused(tmp_path: Path) -> None:
    few, more = (read_flank(write(tmp_path, holed(rough(), share))) for share in (0.04, 0.06))
    assert "missing" not in " ".join(few.warnings)
    assert "points are missing, more than 5%" in " ".join(more.warnings)
    with pytest.raises(ValueError, match=r"2\d\.\d% of the points are missing, more than 20%"):
        read_flank(write(tmp_path, holed(rough(), 0.21)))


def test_many_spikes_are_said(alike: Flank, tmp_path: Path) -> None:
    heights = rough()
    heights += np.where(np.random.default_rng(4).random(heights.shape) < 0.03, 30.0 * heights.std(), 0.0)
    file = write(tmp_path, heights)
    assert "spikes, more than 2%; they were taken out" in " ".join(read_flank(file).warnings)
    assert "they were kept" in " ".join(read_flank(file, spikes="keep").warnings)
    assert not any("spikes" in words for words in alike.warnings)


def test_coarse_numbers_are_said(tmp_path: Path) -> None:
    heights = rough()
    step = 2.0 * np.sqrt(np.mean(np.diff(heights, axis=1) ** 2))
    said = read_flank(write(tmp_path, np.round(heights / step) * step)).warnings
    assert any("heights come in steps of" in words and "along x" in words for words in said)
    fine = read_flank(write(tmp_path, np.round(heights / step * 20) * step / 20)).warnings
    assert not any("steps" in words for words in fine)


def test_few_points(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="63 x 63 points"):
        read_flank(write(tmp_path, rough(1, (63, 63))))
    narrow = read_flank(write(tmp_path, rough()[:5]))
    assert "5 points" in narrow.estimates[1].reason
    assert narrow.chosen in {"x", None}
    assert "64" in narrow.estimates[1].reason


def test_a_profile_has_one_direction(tmp_path: Path) -> None:
    line = np.cumsum(noise((1, 4000)), axis=1)
    file = write(tmp_path, line)
    found = read_flank(file)
    assert [estimate.direction for estimate in found.estimates] == ["x"]
    x = np.arange(4000.0)
    form = np.polyval(np.polyfit(x, line[0], 2), x)
    kept = read_flank(file, spikes="keep").surface.heights[0]
    assert kept == pytest.approx((line[0] - form) * 1e-6, abs=1e-15)  # the parabola, and no line beside it
    for options in ({"direction": "y"}, {"direction": "both"}, {"sliding": "y"}):
        with pytest.raises(ValueError, match="one profile has the direction x alone"):
            read_flank(file, **options)  # type: ignore[arg-type]
    assert read_flank(file, rectangle=["0.8 mm"]).surface.heights.shape == (1, 2001)


def test_options_reach_the_estimate(tmp_path: Path, rough_file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    seen = []

    def estimate_of(lines: Lines, direction: Direction, settings: Any) -> Estimate:
        seen.append(settings)
        return settled(direction, 1.5)

    monkeypatch.setattr(flank, "estimate_of", estimate_of)
    read_flank(rough_file, method="per_line", noise_aware=True, fit="all", shortest_lag="0.8 um", longest_lag="10 um")
    assert (seen[-1].method, seen[-1].noise_aware, seen[-1].fit) == ("per_line", True, "all")
    assert (seen[-1].shortest_lag, seen[-1].longest_lag) == pytest.approx((0.8e-6, 10e-6))
    for options, shortest in (({}, 1.5e-6), ({"shortest_lag": "1 um"}, 1e-6)):
        read_flank(rough_file, filter_width="0.5 um", **options)
        assert seen[-1].shortest_lag == pytest.approx(shortest)
    stated = write(tmp_path, rough(), "# spacing = 0.4 um", "# height_unit = um", "# filter_width = 1 um")
    found = read_flank(stated)
    assert seen[-1].shortest_lag == pytest.approx(3e-6)
    assert "lateral filter of 1 um: lags below 3 um" in " ".join(found.warnings)
    read_flank(stated, filter_width="0 um")
    assert np.isnan(seen[-1].shortest_lag)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"form": "cubic"}, "form = 'cubic', but it is one of: second_order, plane, none"),
        ({"spikes": True}, "spikes = true, but it is one of: remove, keep"), ({"direction": "z"}, "direction = 'z'"),
        ({"sliding": "auto"}, "sliding = 'auto'"), ({"method": "wavelet"}, "method = 'wavelet'"),
        ({"fit": "some"}, "fit = 'some'"), ({"form": ["plane"]}, "form = "), ({"noise_aware": "yes"}, "true or false"),
        ({"spacing": 0.4}, 'spacing = "0.4 um"'), ({"spacing": "0.4"}, "spacing: '0.4' has no unit"),
        ({"spacing": "0.4 kg"}, "spacing: "), ({"spacing": "-0.4 um"}, "spacing = '-0.4 um' must be above 0"),
        ({"spacing": "1 um", "spacing_x": "1 um"}, "spacing is that of both directions"),
        ({"height_unit": "rad"}, "the length of one count"), ({"height_unit": 3}, "is no unit"),
        ({"height_unit": "counts"}, "the length of one count"), ({"skip_lines": -1}, "skip_lines = -1"),
        ({"skip_lines": 1.5}, "skip_lines = 1.5"), ({"skip_lines": True}, "skip_lines = true"),
        ({"columns": "x"}, "columns = 'x'"), ({"columns": [1]}, "columns = [1]"),
        ({"rectangle": "0.2 mm"}, "rectangle = '0.2 mm', but it is a list"), ({"rectangle": 3}, "rectangle = 3"),
        ({"rectangle": ["1 um"] * 3}, "list of lengths"), ({"rectangle": ["1", "1"]}, "rectangle: '1' has no unit"),
        ({"rectangle": ["0 um", "1 um"]}, "rectangle = '0 um' must be above 0"),
        ({"corner": ["1 um", "1 um"]}, "corner needs rectangle"),
        ({"rectangle": ["9 um", "9 um"], "corner": ["-1 um", "1 um"]}, "corner = '-1 um'"),
        ({"rectangle": ["9 um", "9 um"], "corner": ["500 um", "1 um"]}, "leaves the surface"),
        ({"shortest_lag": "5 um", "longest_lag": "5 um"}, "longest_lag = 5 um must be above shortest_lag = 5 um"),
        ({"filter_width": "5 um", "longest_lag": "10 um"}, "below 3 filter widths"),
        ({"filter_width": "-5 um"}, "filter_width"), ({"shortest_lag": 3}, "shortest_lag = 3 needs its unit"),
    ],
)  # fmt: skip
def test_options_that_are_refused(options: dict[str, Any], words: str, rough_file: Path) -> None:
    with pytest.raises(ValueError, match=r"\w") as error:
        read_flank(rough_file, **options)
    assert words in str(error.value)
    assert "\n" not in str(error.value)
