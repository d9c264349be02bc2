"""One grammar: an inputs file, --set and a table accept or refuse the same quantities, and to the same number."""

from __future__ import annotations

import csv
import io
import json
import sys
from collections import Counter
from collections.abc import Callable
from functools import partial
from itertools import product
from pathlib import Path
from random import Random

import pytest

from shared import TESTS

sys.path += [str(TESTS / "unit")]

from sample_models import PIN_OFFER, PIN_WEAR

from truing.errors import Fault, InputError
from truing.inputs_file import setup_from_settings, setup_from_text
from truing.measurements import read_cases
from truing.setup import default_setup

SETUP = default_setup(PIN_WEAR, PIN_OFFER.origin)
ABOVE_ZERO = {"load", "area"}
NUMBERS = {
    "5": 5, "0.5": 0.5, "12.": 12, ".25": 0.25, "1e3": 1e3, "2.5E-3": 2.5e-3, "-3": -3, "+4": 4, "−7": -7,
    "1.5×10^3": 1.5e3, "2*10^-2": 2e-2, "3x10²": 3e2, "10^3": 1e3, "10⁻²": 1e-2, "-10^2": -1e2, "0": 0, "300": 300,
    "-273.15": -273.15, "-274": -274,
} | dict.fromkeys(["1e400", "1e-400", "1,5", "1,050", "1_0", "five", "nan", "\u0665", "1e", "0x10"])  # fmt: skip
"""What a number is in the manual's words (docs/reference/units.md), and None where it is none."""
LBF, FT, INCH = 4.4482216152605, 0.3048, 0.0254
UNITS: dict[str, dict[str, float]] = {
    "load": {"N": 1, "kN": 1e3, "lbf": LBF, "kg*m/s^2": 1, "kg m s-2": 1, "N*m/m": 1, "MPa*mm^2": 1, "J/m": 1,
             "10^3 N": 1e3, "1e-3 kN": 1, "kN-m/m": 1e3},
    "area": {"mm^2": 1e-6, "mm²": 1e-6, "m2": 1, "mm**2": 1e-6, "(mm)^2": 1e-6, "mm·mm": 1e-6, "um^2": 1e-12,
             "in^2": INCH**2, "N/MPa": 1e-6, "1e-6 m²": 1e-6},
    "speed": {"m/s": 1, "mm/s": 1e-3, "km/h": 1 / 3.6, "m s-1": 1, "m·s⁻¹": 1, "ft/min": FT / 60, "W/N": 1, "(m/s)": 1,
              "m*Hz": 1, "10^-3 m/s": 1e-3},
    "time": {"h": 3600, "min": 60, "s": 1, "1/Hz": 1, "/Hz": 1, "1/rpm": 60, "kg m/(N*s)": 1, "Hz^-1": 1, "Hz⁻¹": 1},
    "rate": {"": 1, "%": 1e-2, "ppm": 1e-6, "rev": 1, "um/m": 1e-6, "[-]": 1, "[1]": 1, "-": 1, "mm/mm": 1,
             "N/(MPa*mm^2)": 1, "m^0.5*m^(-1/2)": 1},
    "probe_temperature": {"degC": 1, "°C": 1, "K": 1, "degF": 5 / 9, "mK": 1e-3, "degC^1": 1, "10^3 K": 1e3},
}  # fmt: skip
"""Units of the kind of each input with their size in SI: SI Brochure (9th edition) and NIST SP 811, appendix B.8."""
ZERO = {"degC": 273.15, "°C": 273.15, "degC^1": 273.15, "degF": 459.67 * 5 / 9}
NO_LEVELS = ["delta_degC", "degC*m/m", "K*m/m"]
PIECES = [
    " ", "  ", "*", "/", "·", "-", "^2", "²", "^-1", "⁻¹", "2", "-1", "10", "1/", "(", ")", "m", "mm", "s", "N", "K",
    "°", "%", "degC", "rev", "rad", "10^3", "1e3", "^(1/2)", "^0.5", "+", "xyz", "byte", ".", "^", "0", "×",
]  # fmt: skip


def expected(number: str, unit: str, name: str) -> float | None:
    """Return a quantity in SI, None where it must be refused."""
    value = NUMBERS[number]
    if value is None or unit in NO_LEVELS:
        return None
    found = value * UNITS[name][unit] + ZERO.get(unit, 0.0)
    is_low = (name in ABOVE_ZERO and found <= 0) or (name == "probe_temperature" and found < -1e-9)
    return None if is_low else found


def answered(read: Callable[[], float | None], name: str) -> float | None:
    """Return what was read, None where it is refused in a sentence that names the input."""
    faults: tuple[Fault, ...] = ()
    try:
        return read()
    except InputError as error:
        faults = error.faults
    assert faults
    assert all(name in str(fault) for fault in faults)
    return None


def in_the_file(text: str, name: str) -> float:
    section = "conditions" if name == "probe_temperature" else "inputs"
    file = f"[{section}]\n{name} = {json.dumps(text)}\n"
    return float(setup_from_text(file, PIN_OFFER, file="x.toml", folder=Path()).nominal(name))


def by_set(text: str, name: str) -> float:
    return float(setup_from_settings(PIN_OFFER, {name: text}).nominal(name))


def in_a_table(number: str, unit: str, name: str, path: Path) -> float | None:
    stream = io.StringIO()
    csv.writer(stream).writerows([[f"{name} [{unit}]" if unit else name, "note"], [number, "x"]])
    path.write_text(stream.getvalue(), encoding="utf-8", newline="")
    (case,) = read_cases(path, PIN_OFFER, SETUP).cases
    return float(case.values[name]) if name in case.values else None


def read_by_all(number: str, unit: str, name: str, path: Path, between: str = " ") -> dict[str, float | None]:
    """Read a quantity at every door; a table has brackets of its own."""
    text = number + between + unit
    doors = {"file": partial(in_the_file, text, name), "--set": partial(by_set, text, name)}
    found = {door: answered(read, name) for door, read in doors.items()}
    if not unit.startswith("["):
        found["table"] = answered(partial(in_a_table, number, unit, name, path), name)
    return found


@pytest.mark.parametrize("name", UNITS)
def test_every_door_reads_the_same(name: str, full_torture: bool, tmp_path: Path) -> None:
    random, seen = Random(f"quantities of {name}"), Counter[str]()
    pairs = list(product(NUMBERS, [*UNITS[name], *(NO_LEVELS if name == "probe_temperature" else ())]))
    for number, unit in pairs if full_torture else random.sample(pairs, 60):
        wanted = expected(number, unit, name)
        between = random.choice([" ", "*", "·", "  ", "\u00a0"]) if unit[:1].isalpha() else " "
        for door, value in read_by_all(number, unit, name, tmp_path / "cases.csv", between).items():
            same = value is wanted if None in (value, wanted) else value == pytest.approx(wanted, rel=1e-12, abs=1e-300)
            assert same, f"'{number}{between}{unit}' as {name}: {door} reads {value}, not {wanted}"
        seen["refused" if wanted is None else "read"] += 1
    assert min(seen["refused"], seen["read"]) > 5


@pytest.mark.parametrize("name", UNITS)
def test_what_is_nearly_a_quantity_is_the_same_at_every_door(name: str, full_torture: bool, tmp_path: Path) -> None:
    """Of unit texts with pieces put in or taken out some mean something; what begins with a letter is no number."""
    random, read = Random(f"nearly {name}"), 0
    units = [unit for units in UNITS.values() for unit in units if unit[:1].isalpha()]
    for _ in range(1700 if full_torture else 60):
        unit = random.choice(units)
        for _ in range(random.choice([0, 1, 1, 2, 4])):
            place = random.randint(1, len(unit))
            unit = unit[:place] + random.choice(PIECES) + unit[place + random.choice([0, 0, 1, 2]) :]
        found = read_by_all("5", unit, name, tmp_path / "cases.csv")
        assert len(set(found.values())) == 1, f"'5 {unit}' as {name}: {found}"
        read += found["file"] is not None
    assert read > 0
