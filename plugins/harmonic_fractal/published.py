"""What is printed, for comparison, and where the patent leaves something open."""

from collections.abc import Iterator, Mapping

from harmonic_fractal.calculation import TABLE, UNIT, CatalogueColumn
from truing import Finding, Published

# What is printed, for comparison: the patent prints no number, the maker's catalogues print torsional stiffnesses
#
# Compared is what the mesh of rough contacts alone predicts, from typical D and G and all else rigid: the claim that
# the contact of the flanks is the weakest part of the mesh is put to the test against every drive of the catalogue.

RATIOS: dict[CatalogueColumn, int] = {"30": 30, "50": 50, "above 50": 100}
ENGAGED = 0.3  # of the teeth
LLC = "CSF and CSG, tables 41, 42"
AG = "CHA, manual 1018854"
ALONE = "all but the contacts is rigid"
TEETH = "teeth bend too, 2e7 N/m each pair"
ROUNDED = "no number of the model: the catalogue's own T_1/K_1 is 5.4e-4 rad; its numbers are rounded one by one"
ROUGHER = {"fractal_dimension": "2.5", "fractal_roughness": "1e-9 m", "convention": "areal",
           "reference_torque": "0.1 N*m"}  # fmt: skip


def drive(size: str, column: CatalogueColumn, torque: float) -> Mapping[str, str]:
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


def printed_in(size: str, column: CatalogueColumn) -> str:
    """Say in which catalogue a column is printed; smaller sizes with 30 and 50 stand in both."""
    return AG if column == "above 50" or float(size) > 32 else LLC


def stiffnesses(column: CatalogueColumn, numbers: tuple[int, ...]) -> Iterator[Published]:
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


# The whole drive: all parts that give way, and two numbers of them chosen so that size 20 has its K_1 and K_2
#
# Drives of a series are alike in shape, so that lengths go with the size, compliances with its power -3, and the
# torque under which a part turns by the same angle with its cube. So the numbers of size 20 give the other sizes. That
# tests whether the series is alike in shape, not whose the torsion is: any split among the parts would do as well.

CHOSEN = "K_1 and K_2 of this size chose two numbers, drive_compliance and wave_torsion_stated"
ALIKE = "by similarity from size 20: tests that the series is alike in shape, not whose the torsion is"
EXPONENT = "from K_1 and K_2 of this size and the exponent 2/3 of the wave generator"
SMALLEST = "the smallest size is softer than a small size 20: its parts are not alike in shape"
NEARLY = "by similarity from size 20, which is off by more than 5 % here, beyond the rounding of two digits"
TEETH_ALONE = "the parts of ratio 100; what makes drives of a small ratio so soft is not in the model"
CALCULATED = (
    "nothing is fitted: 23 balls of 4 mm at size 20 (assumed; the makers publish none), others by similarity; "
    "calculated balls are a tenth of what the fit needs"
)
AS_A_SERIES = 0.05  # of the printed stiffness: what two digits are rounded by at most
BEYOND = {("17", 2): NEARLY, ("17", 3): NEARLY, ("50", 3): NEARLY, ("14", 1): SMALLEST, ("14", 2): SMALLEST,
          ("14", 3): SMALLEST}  # fmt: skip


def whole_drive(size: str, torque: float, column: CatalogueColumn = "above 50") -> Mapping[str, str]:
    """Settings of a drive at a torque, N m, whose cup, teeth and wave generator give way too."""
    scale = float(size) / 20.0
    return {
        **calculated_parts(size, torque, column),
        "drive_compliance": f"{3.568 / scale**3:.6g} urad/(N*m)",
        "wave_torsion_stated": "751.6 urad",
        "wave_torque": f"{25.0 * scale**3:.6g} N*m",
    }


def calculated_parts(size: str, torque: float, column: CatalogueColumn = "above 50") -> Mapping[str, str]:
    """Settings of a drive at a torque, N m, with those parts alone that are calculated: teeth and tube of the cup."""
    scale = float(size) / 20.0
    lengths = {"face_width": 10.0, "flank_height": 0.4, "cup_radius": 24.5, "cup_wall": 0.35, "cup_length": 28.0}
    return {
        **drive(size, column, torque),
        **{name: f"{scale * length:.6g} mm" for name, length in lengths.items()},
        "line_contact": "true",
        "tooth_stiffness": f"{2e7 * scale:.6g} N/m",
    }


def whole_drives() -> Iterator[Published]:
    """Torsion at T_1, which is T_1/K_1, and K_2 and K_3 in the middle of their ranges of torque, of every size."""
    for size, (first, second, by_column) in TABLE.items():
        printed = [UNIT * value for value in by_column["above 50"]]
        rows = (
            (1, "torsion at T_1, from K_1", "torsion", first / printed[0], "rad", first),
            (2, "K_2", "torsional_stiffness", printed[1], "N*m/rad", (first + second) / 2.0),
            (3, "K_3", "torsional_stiffness", printed[2], "N*m/rad", 1.5 * second),
        )
        for number, name, result, value, unit, torque in rows:
            is_chosen = size == "20" and number < 3
            beyond = BEYOND.get((size, number))
            source = ALIKE if size != "20" else CHOSEN if is_chosen else EXPONENT
            yield Published(
                name=f"{name}, size {size}, ratio above 50, whole drive", result=result, value=value, unit=unit,
                where=AG, settings=whole_drive(size, torque), kind="words", within=AS_A_SERIES * value,
                obtained="calibrated" if is_chosen else "predicted", verdict="differs" if beyond else "matches",
                why=beyond or source,
            )  # fmt: skip


def other_ratios() -> Iterator[Published]:
    """K_2 of size 20 with the ratios that chose nothing: the same parts with fewer and larger teeth."""
    first, second, by_column = TABLE["20"]
    columns: tuple[CatalogueColumn, ...] = ("50", "30")
    for column in columns:
        yield Published(
            name=f"K_2, size 20, ratio {column}, whole drive", result="torsional_stiffness",
            value=UNIT * by_column[column][1], unit="N*m/rad", where=LLC, verdict="differs", why=TEETH_ALONE,
            settings=whole_drive("20", (first + second) / 2.0, column),
        )  # fmt: skip


def nothing_fitted() -> Iterator[Published]:
    """K_2 of every size with the balls of the wave generator calculated, and nothing that was chosen."""
    for size, (first, second, by_column) in TABLE.items():
        balls = {"balls": "23", "ball_diameter": f"{0.2 * float(size):.6g} mm"}
        yield Published(
            name=f"K_2, size {size}, ratio above 50, nothing fitted", result="torsional_stiffness",
            value=UNIT * by_column["above 50"][1], unit="N*m/rad", where=AG, verdict="differs", why=CALCULATED,
            settings={**calculated_parts(size, (first + second) / 2.0), **balls},
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
    *whole_drives(),
    *other_ratios(),
    *nothing_fitted(),
]  # fmt: skip


# Where the patent leaves something open or cannot be read literally, and what its reader must know

TOLD = {
    "Equations 1, 3, 4, 6 and 8 are lost, and no number is printed": "The patent prints equations 2, 5 and 7 and names "
    "the symbols of the others. Equation 8 is told in words; 1, 3, 4 and 6 are those of the literature that have just "
    "these symbols. It gives no measured flank, no D, no G, no stiffness and no clearance, so nothing of it can be "
    "compared in numbers. What is compared above is the torsional stiffness that the maker of such drives prints.",
    "r' is called an area and must be a radius": "With r' as an area equation 7 has the unit m^(4 − D), which is no "
    "length. With the radius of the largest contact it is the amplitude of equation 1, in metres. The input "
    "clearance_rule chooses between that amplitude, twice it, and the amplitude of the longest wave of the patch.",
    "The clearance of equation 7 grows with the load": "It is half the interference of the largest contact: 47 nm at 1 "
    "N, 153 nm at 25 N and 255 nm at 100 N (D = 2.4, G = 1e-11 m). A gap that widens while it is pressed cannot close, "
    "and cannot be the backlash of a model of vibrations. What closes is the distance of the mean planes less the "
    "integral of dF/K: 461, 427 and 408 nm. At the output that is 0.12 arcmin, where catalogues state about 1 arcmin "
    "of hysteresis: the clearance of a drive is made by tooth form, assembly and wear.",
    "Stiffness without load, and an integral without end": "Up to a small load (1.4e-5 N here) all contacts are "
    "plastic and the model has no stiffness; just above it the stiffness begins at 0. The integrals of dF/K and dT/K "
    "from there on are infinite, like a logarithm, so closing clearance and torsion count from a reference torque. "
    "From 0.1 instead of 1 mN m the torsion at 25 N m is 3.44 instead of 3.05 µrad. The surfaces touch below that load "
    "too; how stiffly, this theory cannot say.",
    "The contact of the flanks is not the weakest part of the mesh": "The patent says so. Rough contacts of 60 pairs "
    "of size 20 have 4.7e7 N m/rad (D = 2.4, G = 1e-11 m) or 6.6e6 N m/rad (2.5, 1e-9 m); the maker prints 2.5e4 N "
    "m/rad for the drive. That is 0.05 % or 0.4 % of its compliance at 25 N m, and 0.3 % of its torsion from 1 mN m "
    "on, or 1.9 % from 50 mN m. With 2e7 N/m for tooth and rim of each pair the mesh has 4 to 5 %. More than nine "
    "tenths lie in cup, wave generator and bearing.",
    "Tuning the topography tunes the contact, hardly the drive": "The patent means to improve a drive by the "
    "topography of its flanks. In its own model half of G makes the contact of a pair 1.67 times as stiff and D = 2.45 "
    "instead of 2.4 makes it 3.0 times as stiff: smoother is always stiffer, and there is no best. But of the torsion "
    "of the drive at 25 N m a contact without any compliance would save 0.26 %.",
    "A factor is missing in the constant that is usually printed": "For waves of f cycles per metre the constant of "
    "the structure function holds (2π)^(4 − 2 D_s). Where it is left out, as in many papers, G comes out too large by "
    "(2π)^((2 − D_s)/(D_s − 1)): 15.7 at D_s = 1.4, 6.3 at 1.5, 3.4 at 1.6, 1560 at 1.2. At 1.4 the stiffness of a "
    "pair is then 0.13 of what it should be. That constant belongs to waves counted in radians per metre. The patent's "
    "own equations 3 and 4 are lost with their constant.",
    "There are two G, and they differ by factors": "The G of a Weierstrass-Mandelbrot profile and that of the areal "
    "surface of the contact model differ by ln γ and by the mean over directions: at D_s = 1.5 and γ = 1.5 one surface "
    "has an areal G 3.87 times that of its profiles. The patent reads the one and puts it into the other, which would "
    "change the stiffness by a factor of 3.4. Here every G has its convention.",
    "Named is the roughness-length method, printed the structure function": "Equation 2 is the structure function; the "
    "roughness-length method of Malinverno looks at the roughness of windows instead and gives D_s only. The structure "
    "function is used.",
    "D = ⟨D_s⟩ + 1 holds for flanks that look alike in all directions": "Teeth that are shaped or ground have a lay, "
    "and D_s differs along and across it. Lines of all directions are pooled only where they agree within 0.15; "
    "otherwise one direction is used, and said. The mean of many D_s and a mean of G do not belong together: G of "
    "single lines scatters by decades, so its logarithm is averaged.",
    "A straight line always fits": "A surface that is smooth below 2 µm and random above 10 µm still gives R² = 0.98, "
    "a D and a G. The local slopes tell: a flank without a decade of equal slopes is refused here, whatever its R², "
    "and the calculation ends with a failed check. The patent asks nothing of the kind.",
    "Which contacts are plastic, and whether tips change, is a choice": "Small contacts yield first in this theory, "
    "which single contacts of a fixed tip do not (Morag and Etsion 2007). With first yield instead of the hardness as "
    "the limit the critical area is 3800 times as large and the stiffness a ninth (2.16e8 instead of 1.95e9 N/m); with "
    "a tip radius that follows the area it is 1.78 times as large. The inputs critical_rule and tip_rule choose; no "
    "test of flanks is known that decides.",
}
FINDINGS = [Finding(title=title, text=text) for title, text in TOLD.items()]
