"""Measured files that cannot be used, each as a change of one that can, and what is said of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from measured import ANGLE, FORCE, HEIGHT, SPEED, TIME, Columns, renamed, taken, text_of, with_cells

NEEDED = "a diagnosis needs 3 rows at the very least, better fifty"
RESULTS = "face_height_1 [mm], face_height_2 [mm], slider_position [mm], slider_tilt [urad], permitted_tilt [deg]"


def without_angle(press: Columns) -> str:
    """No link reaches a ground pivot that is nine metres away."""
    return text_of({"ground_pivot_radius [m]": ["9"] * 90, **press})


Change = Callable[[Columns], "str | bytes"]
REFUSED: dict[str, tuple[Change, Sequence[str]]] = {
    "no measured column": (
        lambda press: text_of({name: cells for name, cells in press.items() if name != HEIGHT}),
        [f"m.csv:1: no column is a result of press_linkage, so nothing is measured; it could be {RESULTS}."],
    ),
    "misspelt measured column": (
        lambda press: text_of(renamed(press, HEIGHT, "slider_positon [mm]")),
        [
            f"m.csv:1: no column is a result of press_linkage, so nothing is measured; it could be {RESULTS}."
            " Did you mean 'slider_position'?"
        ],
    ),
    "unknown unit": (
        lambda press: text_of(renamed(press, HEIGHT, "slider_position [mmm]")),
        ["m.csv:1: column 'slider_position [mmm]': unknown unit 'mmm'; did you mean 'mm'?"],
    ),
    "unknown unit of something nobody declared": (
        lambda press: text_of({**press, "oil_level [furlongish]": ["1"] * 90}),
        ["m.csv:1: column 'oil_level': unknown unit 'furlongish'; leave the brackets out where a number has no unit"],
    ),
    "unit of another kind": (
        lambda press: text_of(renamed(press, HEIGHT, "slider_position [kN]")),
        ["m.csv:1: column 'slider_position [kN]': 'kN' is a force (kN), expected a length (mm)"],
    ),
    "a unit that is a trap": (
        lambda press: text_of(renamed(press, HEIGHT, "slider_position [m**999999999]")),
        ["m.csv:1: column 'slider_position [m**999999999]': "],
    ),
    "two rows": (lambda press: text_of(taken(press, [0, 1])), [f"m.csv:3: holds two rows; {NEEDED}"]),
    "one row": (lambda press: text_of(taken(press, [0])), [f"m.csv:2: holds one row; {NEEDED}"]),
    "no row": (lambda press: text_of(taken(press, [])), ["m.csv:1: holds a header but no rows"]),
    "nothing at all": (
        lambda press: "",
        ["m.csv:1: is empty; the first line of a table holds the names, with units such as 'load [N]'"],
    ),
    "a column of NaN": (
        lambda press: text_of({**press, HEIGHT: ["NaN"] * 90}),
        ["m.csv:1: column 'slider_position' holds no value in any row; fill it or leave it out"],
    ),
    "an empty column": (
        lambda press: text_of({**press, ANGLE: [""] * 90}),
        ["m.csv:1: column 'crank_angle' holds no value in any row; fill it or leave it out"],
    ),
    "infinity": (
        lambda press: text_of(with_cells(press, HEIGHT, {0: "inf", 3: "1e999"})),
        [
            "m.csv:2: slider_position: 'inf' is not a finite number",
            "m.csv:5: slider_position: '1e999' is too large for a number",
        ],
    ),
    "formulas and markup": (
        lambda press: text_of(with_cells(press, FORCE, {2: "=cmd|' /C calc'!A0", 4: "<script>alert(1)</script>"})),
        [
            "m.csv:4: forming_force: '=cmd|' /C calc'!A0' is no number",
            "m.csv:6: forming_force: '<script>alert(1)</script>' is no number",
        ],
    ),
    "a header that moves the cursor": (
        lambda press: text_of(renamed(press, FORCE, "\x1b[31mforce [kN]")),
        ["m.csv:1: the header '\\x1b[31mforce [kN]' cannot be read; write it like 'load [N]'"],
    ),
    "a column twice": (
        lambda press: text_of({**press, "slider_position [um]": press[HEIGHT]}),
        ["m.csv:1: the column 'slider_position' occurs twice"],
    ),
    "several faults": (
        lambda press: (
            text_of(
                with_cells(
                    renamed(renamed(press, FORCE, "forming_force [mm]"), SPEED, "speed [flurb]"), TIME, {5: "late"}
                )
            )
            + "1,2,3\n"
        ),
        [
            "m.csv:1: column 'forming_force [mm]': 'mm' is a length (mm), expected a force (kN)",
            "m.csv:1: column 'speed [flurb]': unknown unit 'flurb'",
            "m.csv:7: time: 'late' is no number",
            "m.csv:92: this row has 3 cells, expected 8 as in the header",
        ],
    ),
    "no machine": (
        without_angle,
        [f"m.csv: no row can be used; {NEEDED} (90 rows are left out where the model fails; the first is m.csv:2: "],
    ),
    "no text": (lambda press: bytes(range(256)) * 9, ["m.csv:1: is a binary file; a table is CSV text in UTF-8"]),
}
