"""What is printed, for comparison: the patent prints no number, the maker's catalogues print torsional stiffnesses.

Compared is what the mesh of rough contacts alone predicts, from typical D and G and all else rigid: the claim that
the contact of the flanks is the weakest part of the mesh is put to the test against every drive of the catalogue.
"""

from collections.abc import Iterator, Mapping

from harmonic_fractal.catalogue import TABLE, UNIT, Column
from truing import Published

RATIOS: dict[Column, int] = {"30": 30, "50": 50, "above 50": 100}
ENGAGED = 0.3  # of the teeth
LLC = "CSF and CSG, tables 41, 42"
AG = "CHA, manual 1018854"
ALONE = "all but the contacts is rigid"
TEETH = "teeth bend too, 2e7 N/m each pair"
ROUNDED = "the catalogue's own T_1/K_1 is 5.4e-4 rad; its numbers are rounded one by one"
ROUGHER = {"fractal_dimension": "2.5", "fractal_roughness": "1e-9 m", "convention": "areal",
           "reference_torque": "0.1 N*m"}  # fmt: skip


def drive(size: str, column: Column, torque: float) -> Mapping[str, str]:
    """Settings of a drive of the catalogue at a torque, N m; size numbers are tenths of an inch of pitch diameter."""
    teeth = 2 * RATIOS[column]
    return {
        "catalogue_size": size,
        "pitch_radius": f"{1.27 * float(size):.5g} mm",
        "flexspline_teeth": str(teeth),
        "engaged_pairs": str(round(ENGAGED * teeth)),
        "torque": f"{torque:g} N*m",
        "studies.run": "[]",
    }


def printed_in(size: str, column: Column) -> str:
    """Say in which catalogue a column is printed; smaller sizes with 30 and 50 stand in both."""
    return AG if column == "above 50" or float(size) > 32 else LLC


def stiffnesses(column: Column, numbers: tuple[int, ...]) -> Iterator[Published]:
    """K_1, K_2 or K_3 of every size that has this column, each in the middle of its range of torque."""
    for size, (first, second, by_column) in TABLE.items():
        middles = {1: first / 2.0, 2: (first + second) / 2.0, 3: 1.5 * second}
        if column not in by_column:
            continue
        for number in numbers:
            yield Published(
                name=f"K_{number}, size {size}, ratio {column}", result="torsional_stiffness", unit="N*m/rad",
                value=UNIT * by_column[column][number - 1], where=printed_in(size, column),
                settings=drive(size, column, middles[number]), verdict="differs", why=ALONE,
            )  # fmt: skip


def with_teeth() -> Iterator[Published]:
    """K_2 again at T_2, with teeth that bend, and with a rougher flank."""
    for size, settings, words in (
        ("14", {}, "teeth bend"), ("20", {}, "teeth bend"), ("20", ROUGHER, "teeth bend, rougher flank"),
        ("32", ROUGHER, "teeth bend, rougher flank"),
    ):  # fmt: skip
        _, second, by_column = TABLE[size]
        yield Published(
            name=f"K_2, size {size}, ratio above 50, {words}", result="torsional_stiffness",
            value=UNIT * by_column["above 50"][1], unit="N*m/rad", where=AG, verdict="differs",
            settings={**drive(size, "above 50", second), "tooth_stiffness": "2e7 N/m", **settings}, why=TEETH,
        )  # fmt: skip


PUBLISHED = [
    Published(
        name="torsion at T_1, size 20, ratio 50", result="catalogue_torsion", value=5.2e-4, unit="rad", where=LLC,
        settings=drive("20", "50", 7.0), verdict="differs", why=ROUNDED,
    ),
    *stiffnesses("above 50", (1, 2, 3)),
    *stiffnesses("50", (2,)),
    *stiffnesses("30", (2,)),
    *with_teeth(),
]  # fmt: skip
