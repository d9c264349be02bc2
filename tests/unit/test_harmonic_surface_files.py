"""Surfaces from files: every layout of text, what a file says of itself, profilometer formats, and what is refused."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from harmonic_fractal.surface import Lines, Surface, pooled
from harmonic_fractal.surface_files import FileLayout, Reading, read_surface

SURFACES = Path(__file__).parents[1] / "data" / "surfaces"
MICROMETRES = FileLayout(spacing_x=4e-7, spacing_y=4e-7, height_unit="um")
HEIGHTS = np.array([[1.5, -2.0, 3.25, 0.5], [0.0, 7.0, -8.125, 1.0], [4.0, 5.0, 6.0, 2.0]])
HOLED = np.array([[1.5, np.nan, 3.25], [np.nan, 7.0, -8.125]])


def read(folder: Path, text: str | bytes, layout: FileLayout = MICROMETRES) -> Reading:
    file = folder / "flank.txt"
    file.write_bytes(text.encode() if isinstance(text, str) else text)
    return read_surface(file, layout)


def heights(folder: Path, text: str | bytes, layout: FileLayout = MICROMETRES) -> NDArray[np.float64]:
    """Heights in um."""
    return read(folder, text, layout).surface.heights * 1e6


def refused(folder: Path, text: str | bytes, layout: FileLayout = MICROMETRES) -> str:
    with pytest.raises(ValueError, match=r"\w") as error:
        read(folder, text, layout)
    assert "\n" not in str(error.value)
    return str(error.value)


# A matrix


def lines_of(separator: str, mark: str = ".") -> str:
    return "\n".join(separator.join(str(value).replace(".", mark) for value in row) for row in HEIGHTS)


@pytest.mark.parametrize(
    "text",
    [
        lines_of(","), lines_of(", "), lines_of(";"), lines_of("; "), lines_of("\t"), lines_of(" "), lines_of("   "),
        lines_of(";", ","), lines_of("\t", ","), lines_of(" ", ","),
        lines_of(";").replace("\n", "\r\n"), lines_of(",") + "\n\n\n", "# a comment\n\n" + lines_of(","),
        lines_of(",").replace("\n", "\n# in between\n"), "\ufeff" + lines_of(","),
        lines_of(";").replace("\n", ";\n") + ";", "  " + lines_of(" ").replace("\n", "\n  "),
        "Instrument: none\nheights in um\n" + lines_of(","), lines_of(",").replace("7.0", "7e0"),
    ],
)  # fmt: skip
def test_separators_decimal_signs_and_comments(text: str, tmp_path: Path) -> None:
    found = read(tmp_path, text).surface
    assert found.heights == pytest.approx(HEIGHTS * 1e-6, rel=1e-14)
    assert (found.spacing_x, found.spacing_y, found.name) == (4e-7, 4e-7, "flank.txt")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_encodings(encoding: str, tmp_path: Path) -> None:
    text = "# Prüfling, Höhe in µm\n# height_unit = µm\n" + lines_of(";", ",")
    assert heights(tmp_path, text.encode(encoding), FileLayout(spacing_x=1e-6, spacing_y=1e-6)) == pytest.approx(
        HEIGHTS
    )


@pytest.mark.parametrize(
    "text",
    [
        "1.5,,3.25\n,7,-8.125", "1.5, ,3.25\n ,7,-8.125", "1.5;nan;3.25\nNaN;7;-8.125", "1.5\t\t3.25\n\t7\t-8.125",
        "1.5 *** 3.25\n*** 7 -8.125", "1,5 *** 3,25\nnan 7 -8,125", "1.5;---;3.25\nN/A;7;-8.125",
    ],
)  # fmt: skip
def test_what_was_not_measured_is_a_hole_and_never_zero(text: str, tmp_path: Path) -> None:
    assert np.array_equal(heights(tmp_path, text).round(9), HOLED, equal_nan=True)


def test_a_row_of_holes_keeps_its_place(tmp_path: Path) -> None:
    for separator in ",;\t":
        text = "\n".join([separator.join("1234"), separator * 3, separator.join("5678"), separator.join("99 9")])
        found = heights(tmp_path, text)
        assert found.shape == (4, 4)
        assert np.isnan(found[1]).all()
        assert np.isnan(found[3, 2])
        assert np.isfinite(found).sum() == 11


def test_one_column_and_one_row_are_profiles(tmp_path: Path) -> None:
    for text in ("1\n2\nnan\n4\n", "1,2,,4"):
        found = read(tmp_path, text).surface
        assert found.is_profile
        assert np.array_equal((found.heights * 1e6).round(9), [[1, 2, np.nan, 4]], equal_nan=True)
        assert np.isnan(found.spacing_y)
    assert "line 3 is empty" in refused(tmp_path, "1\n2\n\n4\n")


def test_a_file_speaks_for_itself(tmp_path: Path) -> None:
    head = "# spacing_x = 0.4 um\n# spacing_y = 500 nm\n# height_unit = nm\n# filter_width = 1 um\n# anything = else\n"
    found = read(tmp_path, head + lines_of(","), FileLayout())
    assert found.surface.heights == pytest.approx(HEIGHTS * 1e-9)
    assert (found.surface.spacing_x, found.surface.spacing_y) == pytest.approx((4e-7, 5e-7))
    assert found.filter_width == pytest.approx(1e-6)
    both = read(tmp_path, "# spacing = 2 um\n# height_unit: mm\n" + lines_of(","), FileLayout()).surface
    assert (both.spacing_x, both.spacing_y, both.heights[0, 0]) == pytest.approx((2e-6, 2e-6, 1.5e-3))


def test_what_is_stated_overrides_the_file_and_is_said(tmp_path: Path) -> None:
    found = read(tmp_path, "# spacing = 2 um\n# height_unit = mm\n" + lines_of(","))
    assert found.surface.heights == pytest.approx(HEIGHTS * 1e-6)
    assert found.surface.spacing_x == 4e-7
    assert len(found.remarks) == 3
    assert "spacing_x is 0.4 um as stated; the file says 2 um" in found.remarks
    assert not read(tmp_path, "# spacing = 0.4 um\n# height_unit = um\n" + lines_of(",")).remarks


def test_a_unit_may_be_a_number_of_metres_per_count(tmp_path: Path) -> None:
    layout = FileLayout(spacing_x=1e-6, spacing_y=1e-6, height_unit="2.91818e-8 m")
    assert heights(tmp_path, lines_of(" "), layout) == pytest.approx(HEIGHTS * 2.91818e-2)


def test_lines_at_the_top_that_look_like_numbers_are_skipped(tmp_path: Path) -> None:
    text = "3 4\n0.4\n" + lines_of(" ")
    assert "skip_lines" in refused(tmp_path, text)
    layout = FileLayout(spacing_x=1e-6, spacing_y=1e-6, height_unit="um", skip_lines=2)
    assert heights(tmp_path, text, layout) == pytest.approx(HEIGHTS)


def test_a_million_numbers_with_a_header_of_words(tmp_path: Path) -> None:
    many = np.arange(1e6).reshape(1000, 1000)
    text = "h w\n" + "\n".join(" ".join(f"{value:.0f}" for value in row) for row in many.tolist())
    assert np.array_equal(heights(tmp_path, text, FileLayout(spacing_x=1, spacing_y=1, height_unit="m")) * 1e-6, many)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "empty"), ("  \n \n", "empty"), ("no numbers at all", "no line of the file holds numbers"),
        ("five,2,3,4\n1,2,3,4\n", "line 1: 'five' is no number"), ("five,2,3,4\n1,2,3,4\n", "skip_lines = 1"),
        ("# only\n# comments\n", "no line of the file holds numbers"), ("1,2,3,4\n1,2,3\n", "line 2 has 3 cells"),
        ("1,2,3,4\n1,x7,3,4\n", "line 2: 'x7' is no number"), ("1;2;3;4\n1;1.234,5;3;4\n", "line 2"),
        ("1,2,3,4\n1,inf,3,4\n", "line 2: infinite"), ("1,2,3,4\n1,1_0,3,4\n", "line 2"),
        ("1,2,3,4\n1,\u0665,3,4\n", "line 2: '\u0665' is no number"),
        ("1,2\n3,4\n5,6\n7,8\n9,10\n", "without names"), (",,,\n,,,\n", "no point of the surface is measured"),
    ],
)  # fmt: skip
def test_texts_that_are_refused(text: str, words: str, tmp_path: Path) -> None:
    assert words in refused(tmp_path, text)


@pytest.mark.parametrize(
    ("layout", "words"),
    [
        (FileLayout(spacing_x=1e-6, spacing_y=1e-6), "height_unit"),
        (FileLayout(height_unit="um"), 'spacing = "0.4 um"'),
        (FileLayout(spacing_x=1e-6, height_unit="um"), "spacing_y"),
        (FileLayout(spacing_x=1e-6, spacing_y=1e-6, height_unit="rad"), "the length of one count"),
        (FileLayout(spacing_x=1e-6, spacing_y=1e-6, height_unit="counts"), "the length of one count"),
        (FileLayout(spacing_x=1e-6, spacing_y=1e-6, height_unit="2 kg"), "no length"),
        (FileLayout(spacing_x=1e-6, spacing_y=1e-6, height_unit="-1 um"), "above 0"),
        (FileLayout(spacing_x=1e-6, spacing_y=1e-6, height_unit="um", skip_lines=99), "skip_lines = 99"),
    ],
)  # fmt: skip
def test_what_must_be_stated(layout: FileLayout, words: str, tmp_path: Path) -> None:
    assert words in refused(tmp_path, lines_of(","), layout)


@pytest.mark.parametrize(
    "line", ["spacing = 0.4", "spacing = 0.4 kg", "spacing_x = -1 um", "spacing_y = wide", "filter_width = 1 s"]
)
def test_a_header_that_says_nonsense_is_refused(line: str, tmp_path: Path) -> None:
    assert line.split(" ", maxsplit=1)[0] in refused(tmp_path, f"# {line}\n{lines_of(',')}")


# Columns


@pytest.mark.parametrize(
    "head",
    [
        "x [um];z [nm]", "# x [um]; z [nm]", "X;Z\n[um];[nm]", "X;Y\n[um];[nm]", "Position (um);Height (nm)",
        "x/um;z/nm", '"x [um]";"z [nm]"', "Instrument\n12 July\nx [um];z [nm]",
    ],
)  # fmt: skip
def test_two_columns_are_a_profile(head: str, tmp_path: Path) -> None:
    found = read(tmp_path, head + "\n10;1,5\n10,5;2\n11;-3\n11,5;4\n", FileLayout()).surface
    assert found.heights == pytest.approx(np.array([[1.5, 2.0, -3.0, 4.0]]) * 1e-9)
    assert found.spacing_x == pytest.approx(5e-7)
    assert found.is_profile


def test_columns_are_named_in_the_options(tmp_path: Path) -> None:
    layout = FileLayout(columns=("x [um]", "z [um]"))
    assert heights(tmp_path, "0 1\n1 2\n2 3\n", layout) == pytest.approx(np.array([[1.0, 2.0, 3.0]]))
    assert "must name the 2 columns" in refused(tmp_path, "0 1\n1 2\n", FileLayout(columns=("x [um]",)))
    assert "must name" in refused(tmp_path, "0 1\n1 2\n", FileLayout(columns=("x [um]", "colour")))
    assert "two columns are x" in refused(tmp_path, "0 1\n1 2\n", FileLayout(columns=("x [um]", "x [um]")))


def test_points_of_a_profile_come_in_any_order_and_missing_ones_are_holes(tmp_path: Path) -> None:
    text = "x [um],z [um]\n3,13\n0,10\n1,11\n5,15\n6,16\n7,17\n"
    found = heights(tmp_path, text, FileLayout())
    assert np.array_equal(found.round(9), [[10, 11, np.nan, 13, np.nan, 15, 16, 17]], equal_nan=True)


def test_points_marked_invalid_are_holes(tmp_path: Path) -> None:
    text = "X;Y;valid\r\n[mm];[mm];[1/0]\r\n8.6720;106.1;1\r\n8.6725;999;0\r\n8.6730;106.3;1\r\n"
    found = read(tmp_path, text, FileLayout()).surface
    assert np.array_equal((found.heights * 1e3).round(9), [[106.1, np.nan, 106.3]], equal_nan=True)
    assert found.spacing_x == pytest.approx(5e-7)


def test_points_of_a_grid_come_in_any_order(tmp_path: Path) -> None:
    y, x = np.mgrid[0:3, 0:4]
    points = np.stack([x * 0.4 + 7, y * 0.5 - 2, HEIGHTS], axis=-1).reshape(-1, 3)
    shuffled = np.random.default_rng(3).permutation(points)
    text = "x [um] y [um] z [nm]\n" + "\n".join(" ".join(map(repr, row)) for row in shuffled.tolist())
    found = read(tmp_path, text, FileLayout()).surface
    assert found.heights == pytest.approx(HEIGHTS * 1e-9)
    assert (found.spacing_x, found.spacing_y) == pytest.approx((4e-7, 5e-7))
    fewer = "\n".join(line for line in text.split("\n") if not line.endswith("-8.125"))
    assert np.argwhere(np.isnan(heights(tmp_path, fewer, FileLayout()))).tolist() == [[1, 2]]


@pytest.mark.parametrize(
    ("text", "words"),
    [
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
    ],
)  # fmt: skip
def test_columns_that_are_refused(text: str, words: str, tmp_path: Path) -> None:
    assert words in refused(tmp_path, text, FileLayout())


def test_spacing_may_differ_by_one_per_cent(tmp_path: Path) -> None:
    assert heights(tmp_path, "x [um],z [um]\n0,1\n1,2\n2.009,3\n3,4\n4,5\n", FileLayout()).shape == (1, 5)
    wrong = FileLayout(spacing_x=2e-6)
    assert "spacing_x is stated as 2 um" in refused(tmp_path, "x [um],z [um]\n0,1\n1,2\n2,3\n", wrong)


# Real files, read by the layouts of their formats


def metropro(file: Path) -> NDArray[np.float64]:
    """Heights (480, 640) in m by the layout of the format: factor S lambda O / R, R = 32768 for resolution 1."""
    counts = np.frombuffer(file.read_bytes(), dtype=">i4", offset=834 + 640 * 480 * 2).reshape(480, 640)
    return np.where(counts >= 2147483640, np.nan, counts * (0.5 * 5.6999999742402e-07 / 32768))


def al3d(file: Path) -> NDArray[np.float64]:
    """Heights (296, 200) in m: little-endian float32 from byte 1261, 800 bytes a row."""
    found = np.frombuffer(file.read_bytes(), dtype="<f4", offset=1261, count=296 * 200).reshape(296, 200)
    return np.where(found == np.float32(3.000000028082e15), np.nan, found)


def test_interferogram_against_the_layout_of_its_format() -> None:
    pytest.importorskip("SurfaceTopography")
    found = read_surface(SURFACES / "metropro-1.dat", FileLayout()).surface
    np.testing.assert_allclose(found.heights, metropro(SURFACES / "metropro-1.dat"), rtol=1e-12)
    assert (found.spacing_x, found.spacing_y) == pytest.approx((1.0982520e-6, 1.0982520e-6), rel=1e-7)
    assert np.std(found.heights) == pytest.approx(0.07529e-6, rel=5e-4)  # and not eight times as much


def test_focus_variation_against_the_layout_of_its_format() -> None:
    pytest.importorskip("SurfaceTopography")
    found = read_surface(SURFACES / "al3d-1.al3d", FileLayout())
    np.testing.assert_allclose(found.surface.heights, al3d(SURFACES / "al3d-1.al3d"), rtol=1e-12)
    assert (found.surface.spacing_x, found.surface.spacing_y) == pytest.approx((0.438027e-6, 0.438027e-6), rel=1e-9)
    assert found.filter_width == pytest.approx(0.606e-6)


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
    found = read_surface(tmp_path / name, FileLayout()).surface
    assert np.argwhere(np.isnan(found.heights)).tolist() == [[7, 5]]


def test_text_exports_of_instruments() -> None:
    layout = FileLayout(spacing_x=0.369862e-6, spacing_y=0.369862e-6, height_unit="2.91818e-8 m")
    phase = read_surface(SURFACES / "matrix-4.txt", layout).surface
    assert phase.heights.shape == (305, 75)
    assert phase.heights[0, :2] == pytest.approx([-4.448661 * 2.91818e-8, -4.596037 * 2.91818e-8])
    contour = read_surface(SURFACES / "hfm-1.hfm", FileLayout()).surface
    assert contour.heights.shape == (1, 9600)
    assert contour.spacing_x == pytest.approx(0.5e-6)
    assert contour.heights[0, [0, -1]] == pytest.approx([106.606853e-3, 106.609048e-3], rel=1e-12)
    with pytest.raises(ValueError, match="height_unit"):
        read_surface(SURFACES / "matrix-4.txt", FileLayout(spacing_x=1e-6, spacing_y=1e-6))


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
    found = read_surface(file, FileLayout()).surface
    expected = np.arange(12.0).reshape(3, 4)
    expected[1, 2] = np.nan
    np.testing.assert_allclose(found.heights * 1e9, expected, atol=1e-12)
    assert (found.spacing_x, found.spacing_y) == pytest.approx((1e-6, 2e-6))
    file.write_text(STANDARD.replace("aISO", "aBCR"), encoding="ascii")
    with pytest.raises(ValueError, match="none of its formats"):
        read_surface(file, FileLayout())


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
        pooled(Lines(HEIGHTS, 1e-6), Lines(HEIGHTS, 1.02e-6))
