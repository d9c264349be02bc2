"""The tolerance grades of ISO 286-1 against tables printed elsewhere and against the standard's rules."""

import itertools
import math

import pytest

from truing import fits
from truing.errors import UnitError

LIMITS_MM = (3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500, 630, 800, 1000, 1250, 1600, 2000, 2500, 3150)

# Otto Ganter, technical data "ISO-Fundamental Tolerance series, DIN ISO 286": up to 500 mm, one line per grade, um.
CATALOGUE_UP_TO_500_MM = {
    "IT1": "0.8 1 1 1.2 1.5 1.5 2 2.5 3.5 4.5 6 7 8",
    "IT2": "1.2 1.5 1.5 2 2.5 2.5 3 4 5 7 8 9 10",
    "IT3": "2 2.5 2.5 3 4 4 5 6 8 10 12 13 15",
    "IT4": "3 4 4 5 6 7 8 10 12 14 16 18 20",
    "IT5": "4 5 6 8 9 11 13 15 18 20 23 25 27",
    "IT6": "6 8 9 11 13 16 19 22 25 29 32 36 40",
    "IT7": "10 12 15 18 21 25 30 35 40 46 52 57 63",
    "IT8": "14 18 22 27 33 39 46 54 63 72 81 89 97",
    "IT9": "25 30 36 43 52 62 74 87 100 115 130 140 155",
    "IT10": "40 48 58 70 84 100 120 140 160 185 210 230 250",
    "IT11": "60 75 90 110 130 160 190 220 250 290 320 360 400",
    "IT12": "100 120 150 180 210 250 300 350 400 460 520 570 630",
    "IT13": "140 180 220 270 330 390 460 540 630 720 810 890 970",
    "IT14": "250 300 360 430 520 620 740 870 1000 1150 1300 1400 1550",
    "IT15": "400 480 580 700 840 1000 1200 1400 1600 1850 2100 2300 2500",
    "IT16": "600 750 900 1100 1300 1600 1900 2200 2500 2900 3200 3600 4000",
    "IT17": "1000 1200 1500 1800 2100 2500 3000 3500 4000 4600 5200 5700 6300",
    "IT18": "1400 1800 2200 2700 3300 3900 4600 5400 6300 7200 8100 8900 9700",
}

# mechguru.com, "DIN ISO 286 standard tolerance zone size table": IT5 ... IT11 above 500 mm, one line per range, in mm.
HANDBOOK_ABOVE_500_MM = {
    630: "0.032 0.044 0.070 0.110 0.175 0.280 0.440",
    800: "0.036 0.050 0.080 0.125 0.200 0.320 0.500",
    1000: "0.040 0.056 0.090 0.140 0.230 0.360 0.560",
    1250: "0.047 0.066 0.105 0.165 0.260 0.420 0.660",
    1600: "0.055 0.078 0.125 0.195 0.310 0.500 0.780",
    2000: "0.065 0.092 0.150 0.230 0.370 0.600 0.920",
    2500: "0.078 0.110 0.175 0.280 0.440 0.700 1.100",
    3150: "0.096 0.135 0.210 0.330 0.540 0.860 1.350",
}

# github.com/Ralul/TI-84, ISO-286.py: IT1 ... IT4 above 500 mm, one line per range, um.
CALCULATOR_ABOVE_500_MM = {
    630: "9 11 16 22",
    800: "10 13 18 25",
    1000: "11 15 21 28",
    1250: "13 18 24 33",
    1600: "15 21 29 39",
    2000: "18 25 35 46",
    2500: "22 30 41 55",
    3150: "26 36 50 68",
}


def width_um(grade: str, size_mm: float) -> float:
    return fits.tolerance(grade, size_mm / 1000) * 1e6


@pytest.mark.parametrize(("grade", "line"), CATALOGUE_UP_TO_500_MM.items())
def test_table_up_to_500_mm(grade, line):
    expected = [float(number) for number in line.split()]
    assert [width_um(grade, size) for size in LIMITS_MM[:13]] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("upper_mm", HANDBOOK_ABOVE_500_MM)
def test_tables_above_500_mm(upper_mm):
    fine_um = [float(number) for number in CALCULATOR_ABOVE_500_MM[upper_mm].split()]
    coarser_um = [float(number) * 1000 for number in HANDBOOK_ABOVE_500_MM[upper_mm].split()]
    grades = [f"IT{number}" for number in range(1, 12)]
    assert [width_um(grade, upper_mm) for grade in grades] == pytest.approx([*fine_um, *coarser_um], rel=1e-12)


@pytest.mark.parametrize("number", range(6, 14))
def test_ten_times_the_width_every_fifth_grade(number):
    """ISO 286-1: from IT6 upwards; the one printed exception is IT6 of 3 to 6 mm, 8 um beside 75 um at IT11."""
    for upper_mm in LIMITS_MM:
        ten_times = 75 if (number, upper_mm) == (6, 6) else 10 * width_um(f"IT{number}", upper_mm)
        assert width_um(f"IT{number + 5}", upper_mm) == pytest.approx(ten_times)


def test_wider_with_every_grade_and_never_narrower_with_size():
    table = [[width_um(grade, size) for grade in fits.GRADES] for size in LIMITS_MM]
    for row in table:
        assert all(left < right for left, right in itertools.pairwise(row))
    for above, below in itertools.pairwise(table):
        assert all(smaller <= larger for smaller, larger in zip(above, below, strict=True))


@pytest.mark.parametrize("limit", LIMITS_MM)
def test_a_size_on_a_limit_belongs_to_the_lower_range(limit):
    """A rounding error is no size: metres may miss the limit by one."""
    own, above = width_um("IT9", 0.999 * limit), width_um("IT9", min(1.0001 * limit, 3150))
    for metres in (limit / 1000, limit * 0.001, limit * 1e-3 + 1e-17, math.nextafter(limit / 1000, 4)):
        assert fits.tolerance("IT9", metres) * 1e6 == own
    assert own < above or limit == 3150


def test_sizes_and_grades_outside_the_standard():
    for size in (0.0, -0.1, 3.1501, 10.0, math.nan, math.inf, -math.inf):
        with pytest.raises(UnitError, match="above 0 and up to 3150 mm"):
            fits.tolerance("IT7", size)
    for grade in ("IT19", "IT0", "IT01", "7", "", "H7", "IT 7x"):
        with pytest.raises(UnitError, match="is not a tolerance grade"):
            fits.tolerance(grade, 0.1)
    assert fits.tolerance(" it10 ", 0.36) == fits.tolerance("IT10", 0.36)


def test_coarse_grades_are_not_for_sizes_up_to_1_mm():
    with pytest.raises(UnitError, match=r"gives IT14 only for sizes above 1 mm; this size is 1 mm"):
        fits.tolerance("IT14", 0.001)
    assert fits.tolerance("IT13", 0.001) == pytest.approx(140e-6)
    assert fits.tolerance("IT14", 0.0011) == pytest.approx(250e-6)
