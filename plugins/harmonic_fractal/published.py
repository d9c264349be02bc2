"""What is printed, for comparison: the patent prints no number, the maker's catalogues print torsional stiffnesses.

Compared is what the mesh of rough contacts alone predicts, from typical D and G and all else rigid: the claim that
the contact of the flanks is the weakest part of the mesh is put to the test against every drive of the catalogue.
"""

from collections.abc import Iterator, Mapping

from harmonic_fractal.catalogue import TABLE, UNIT, Column
from truing import Published

RATIOS: dict[Column, int] = {"30": 30, "50": 50, "above 50": 100}
ENGAGED = 0.3  # of the teeth
LLC = "CSF and CSG component sets, tables 41 and 42"
AG = "CHA actuators, manual 1018854"
ALONE = "rough contacts alone; cup, wave generator, bearing and teeth, which carry the torsion of a drive, are rigid"
TEETH = "with 2e7 N/m for tooth and rim of every pair; cup, wave generator and bearing are still rigid"
ROUNDED = "the catalogue's own T_1/K_1 is 5.4e-4 rad: K_1 is printed with two digits, the torsion was rounded otherwise"
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


def stiffnesses(columns: tuple[Column, ...]) -> Iterator[Published]:
    """K_1, K_2 and K_3 of every size, each in the middle of its range of torque."""
    for size, (first, second, by_column) in TABLE.items():
        middles = (first / 2.0, (first + second) / 2.0, 1.5 * second)
        for column in columns:
            for number, (torque, value) in enumerate(zip(middles, by_column.get(column, ()), strict=False), 1):
                yield Published(
                    name=f"K_{number}, size {size}, ratio {column}", result="torsional_stiffness", value=UNIT * value,
                    unit="N*m/rad", where=printed_in(size, column), settings=drive(size, column, torque),
                    agrees_to=0.05, verdict="differs", why=ALONE,
                )  # fmt: skip


def with_teeth() -> Iterator[Published]:
    """K_2 again at T_2, with the bending of the teeth and with a rougher flank."""
    for size, settings, words in (
        ("14", {}, "bending teeth"), ("20", {}, "bending teeth"), ("20", ROUGHER, "bending teeth, rougher flank"),
        ("32", ROUGHER, "bending teeth, rougher flank"),
    ):  # fmt: skip
        _, second, by_column = TABLE[size]
        yield Published(
            name=f"K_2, size {size}, ratio above 50, {words}", result="torsional_stiffness",
            value=UNIT * by_column["above 50"][1], unit="N*m/rad", where=AG, agrees_to=0.05, verdict="differs",
            settings={**drive(size, "above 50", second), "tooth_stiffness": "2e7 N/m", **settings}, why=TEETH,
        )  # fmt: skip


PUBLISHED = [
    Published(
        name="torsion at T_1, size 20, ratio 50", result="catalogue_torsion", value=5.2e-4, unit="rad", where=LLC,
        settings=drive("20", "50", 7.0), agrees_to=0.01, verdict="differs", why=ROUNDED,
    ),
    *stiffnesses(("above 50", "50", "30")),
    *with_teeth(),
]  # fmt: skip
