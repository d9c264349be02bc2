"""One grammar: an inputs file, --set and a table accept or refuse the same quantities, and to the same number."""

from __future__ import annotations

import csv
import io
import json
import sys
from collections import Counter
from collections.abc import Callable
from functools import partial
from pathlib import Path
from random import Random

import pytest
from quantity_oracle import RefusedError, normalised, read, split, unit

from shared import TESTS

sys.path += [str(TESTS / "unit")]

from sample_models import PIN_OFFER, PIN_WEAR

from truing.errors import Fault, InputError
from truing.inputs_file import setup_from_settings, setup_from_text
from truing.measurements import read_cases
from truing.setup import default_setup

SETUP = default_setup(PIN_WEAR, PIN_OFFER.origin)
DECLARED = {"load": "N", "area": "mm^2", "speed": "m/s", "time": "h", "rate": "", "probe_temperature": "degC"}
ABOVE_ZERO = {"load", "area"}
NUMBERS = [
    "5", "0.5", "12.", ".25", "1e3", "2.5E-3", "-3", "+4", "−7", "1.5×10^3", "2*10^-2", "3x10²", "10^3", "10⁻²",
    "-10^2", "0", "1e400", "1e-400", "300", "-273.15", "-274", "1e306", "1,5", "1,050", "1_0", "five", "", "nan",
    "\u0665", "1e", "0x10",
]  # fmt: skip
GOOD = {
    "load": ["N", "kN", "lbf", "kg*m/s^2", "kg m s-2", "N*m/m", "MPa*mm^2", "J/m", "10^3 N", "1e-3 kN", "kN-m/m"],
    "area": ["mm^2", "mm²", "m2", "mm**2", "(mm)^2", "mm·mm", "um^2", "in^2", "N/MPa", "1e-6 m²"],
    "speed": ["m/s", "mm/s", "km/h", "m s-1", "m·s⁻¹", "ft/min", "W/N", "(m/s)", "m*Hz", "10^-3 m/s"],
    "time": ["h", "min", "s", "1/Hz", "/Hz", "1/rpm", "kg m/(N*s)", "Hz^-1", "Hz⁻¹"],
    "rate": ["", "%", "ppm", "rev", "um/m", "[-]", "[1]", "-", "mm/mm", "N/(MPa*mm^2)", "m^0.5*m^(-1/2)"],
    "probe_temperature": ["degC", "°C", "K", "degF", "mK", "delta_degC", "degC*m/m", "K*m/m", "10^3 K", "degC^1"],
}
PIECES = [
    " ", "  ", "*", "/", "·", "-", "^2", "²", "^-1", "⁻¹", "2", "-1", "10", "1/", "(", ")", "m", "mm", "s", "N", "K",
    "°", "%", "degC", "rev", "rad", "10^3", "1e3", "^(1/2)", "^0.5", "+", "xyz", "byte", ".", "[", "]", "^", "0", "×",
]  # fmt: skip


def quantity(random: Random, name: str) -> str:
    """Return a text that is a quantity of this input, or nearly one."""
    number = random.choice(NUMBERS if random.random() < 0.4 else NUMBERS[:15])
    own = random.random() < 0.8
    text = random.choice(GOOD[name] if own else [unit for units in GOOD.values() for unit in units])
    for _ in range(random.choice([0, 0, 0, 0, 1, 1, 2, 4])):
        place = random.randint(0, len(text))
        cut = place + random.choice([0, 0, 1, 2])
        text = text[:place] + random.choice(PIECES) + text[cut:]
    between = random.choice([" ", " ", " ", "", "*", " * ", "·", "  ", "\u00a0"])
    return number + between + text


def expected(text: str, name: str) -> float | None:
    """Return the number that the second reader finds, None where it refuses."""
    try:
        found = read(text, DECLARED[name])
    except RefusedError:
        return None
    return None if name in ABOVE_ZERO and found <= 0 else found


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


def in_a_table(text: str, name: str, path: Path) -> float | None:
    """Write the number into a cell and the unit into the header; a text that has no number stands in the cell."""
    try:
        _, rest = split(text)
    except RefusedError:
        header, cell = name, text
    else:
        plain = normalised(text)
        number = plain[: len(plain) - len(rest)].rstrip()
        if rest:
            number = number.removesuffix("*").removesuffix("·").rstrip()
        header, cell = f"{name} [{rest}]" if rest else name, number
    stream = io.StringIO()
    csv.writer(stream).writerows([[header, "note"], [cell, "x"]])
    path.write_text(stream.getvalue(), encoding="utf-8", newline="")
    (case,) = read_cases(path, PIN_OFFER, SETUP).cases
    return float(case.values[name]) if name in case.values else None


def is_for_a_table(text: str) -> bool:
    """Tell whether number and unit can stand apart: brackets are the header's, a power of ten is a unit there."""
    if set("[]\r\n") & set(text):
        return False
    try:
        power, factors = unit(split(text)[1])
    except RefusedError:
        return True
    return not (power and not factors)


@pytest.mark.parametrize("name", DECLARED)
def test_every_door_reads_the_same(name: str, full_torture: bool, tmp_path: Path) -> None:
    random, seen = Random(f"quantities of {name}"), Counter[str]()
    for _ in range(1700 if full_torture else 60):
        text = quantity(random, name)
        wanted = expected(text, name)
        doors: dict[str, Callable[[], float | None]] = {
            "file": partial(in_the_file, text, name), "--set": partial(by_set, text, name),
        }  # fmt: skip
        if is_for_a_table(text):
            doors["table"] = partial(in_a_table, text, name, tmp_path / "cases.csv")
        for door, read_there in doors.items():
            value = answered(read_there, name)
            same = value is wanted if None in (value, wanted) else value == pytest.approx(wanted, rel=1e-12, abs=1e-300)
            assert same, f"{text!r} as {name}: {door} reads {value}, the second reader {wanted}"
        seen["refused" if wanted is None else "read"] += 1
    assert min(seen["refused"], seen["read"]) > 5
