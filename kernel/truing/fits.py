"""Standard tolerance grades of ISO 286-1: how wide is IT7 at 315 mm?

The values are those that ISO 286-1 prints (Table 1), not those of its formulas: the standard rounds by rules of its
own, and drawings follow the table. Lengths are in metres here, as everywhere inside; the table below is in micrometres
and millimetres, as in the standard.

Validity: nominal sizes above 0 and up to 3150 mm, grades IT1 to IT18. IT14 to IT18 are not for sizes up to 1 mm; IT1 to
IT5 above 500 mm are printed by the standard for experimental use. Source: ISO 286-1:2010, Table 1.
"""

from __future__ import annotations

from truing.errors import UnitError

GRADES: tuple[str, ...] = tuple(f"IT{number}" for number in range(1, 19))
"""The grades from the finest to the coarsest."""

_LIMITS_MM = (3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500, 630, 800, 1000, 1250, 1600, 2000, 2500, 3150)

# One row per range of nominal sizes (the upper limits above), IT1 ... IT18, in micrometres.
_WIDTHS_UM: tuple[tuple[float, ...], ...] = (
    (0.8, 1.2, 2, 3, 4, 6, 10, 14, 25, 40, 60, 100, 140, 250, 400, 600, 1000, 1400),
    (1, 1.5, 2.5, 4, 5, 8, 12, 18, 30, 48, 75, 120, 180, 300, 480, 750, 1200, 1800),
    (1, 1.5, 2.5, 4, 6, 9, 15, 22, 36, 58, 90, 150, 220, 360, 580, 900, 1500, 2200),
    (1.2, 2, 3, 5, 8, 11, 18, 27, 43, 70, 110, 180, 270, 430, 700, 1100, 1800, 2700),
    (1.5, 2.5, 4, 6, 9, 13, 21, 33, 52, 84, 130, 210, 330, 520, 840, 1300, 2100, 3300),
    (1.5, 2.5, 4, 7, 11, 16, 25, 39, 62, 100, 160, 250, 390, 620, 1000, 1600, 2500, 3900),
    (2, 3, 5, 8, 13, 19, 30, 46, 74, 120, 190, 300, 460, 740, 1200, 1900, 3000, 4600),
    (2.5, 4, 6, 10, 15, 22, 35, 54, 87, 140, 220, 350, 540, 870, 1400, 2200, 3500, 5400),
    (3.5, 5, 8, 12, 18, 25, 40, 63, 100, 160, 250, 400, 630, 1000, 1600, 2500, 4000, 6300),
    (4.5, 7, 10, 14, 20, 29, 46, 72, 115, 185, 290, 460, 720, 1150, 1850, 2900, 4600, 7200),
    (6, 8, 12, 16, 23, 32, 52, 81, 130, 210, 320, 520, 810, 1300, 2100, 3200, 5200, 8100),
    (7, 9, 13, 18, 25, 36, 57, 89, 140, 230, 360, 570, 890, 1400, 2300, 3600, 5700, 8900),
    (8, 10, 15, 20, 27, 40, 63, 97, 155, 250, 400, 630, 970, 1550, 2500, 4000, 6300, 9700),
    (9, 11, 16, 22, 32, 44, 70, 110, 175, 280, 440, 700, 1100, 1750, 2800, 4400, 7000, 11000),
    (10, 13, 18, 25, 36, 50, 80, 125, 200, 320, 500, 800, 1250, 2000, 3200, 5000, 8000, 12500),
    (11, 15, 21, 28, 40, 56, 90, 140, 230, 360, 560, 900, 1400, 2300, 3600, 5600, 9000, 14000),
    (13, 18, 24, 33, 47, 66, 105, 165, 260, 420, 660, 1050, 1650, 2600, 4200, 6600, 10500, 16500),
    (15, 21, 29, 39, 55, 78, 125, 195, 310, 500, 780, 1250, 1950, 3100, 5000, 7800, 12500, 19500),
    (18, 25, 35, 46, 65, 92, 150, 230, 370, 600, 920, 1500, 2300, 3700, 6000, 9200, 15000, 23000),
    (22, 30, 41, 55, 78, 110, 175, 280, 440, 700, 1100, 1750, 2800, 4400, 7000, 11000, 17500, 28000),
    (26, 36, 50, 68, 96, 135, 210, 330, 540, 860, 1350, 2100, 3300, 5400, 8600, 13500, 21000, 33000),
)
_FIRST_GRADE_NOT_BELOW_1_MM = GRADES.index("IT14")
_SAME = 1 + 1e-9  # a size that was converted to metres may miss the limit it stands on by a rounding error


def tolerance(grade: str, size: float) -> float:
    """Give the full width of a standard tolerance at a nominal size; both in metres.

    Raises UnitError for an unknown grade, for a size outside 0 to 3150 mm, and for IT14 to IT18 up to 1 mm.
    Source: ISO 286-1:2010, Table 1.
    """
    column = _column(grade)
    row = _row(size)
    if column >= _FIRST_GRADE_NOT_BELOW_1_MM and size * 1000 <= _SAME:
        raise UnitError(f"ISO 286-1 gives {GRADES[column]} only for sizes above 1 mm; this size is {_in_mm(size)}")
    return _WIDTHS_UM[row][column] / 1e6


def _column(grade: str) -> int:
    try:
        return GRADES.index(grade.strip().upper())
    except ValueError:
        raise UnitError(f"{grade!r} is not a tolerance grade; the grades of ISO 286-1 here are IT1 to IT18") from None


def _row(size: float) -> int:
    size_mm = size * 1000
    if size_mm > 0:
        for row, limit in enumerate(_LIMITS_MM):
            if size_mm <= limit * _SAME:
                return row
    raise UnitError(
        f"ISO 286-1 gives tolerance grades for sizes above 0 and up to 3150 mm; this size is {_in_mm(size)}"
    )


def _in_mm(size: float) -> str:
    return f"{size * 1000:.6g} mm"
