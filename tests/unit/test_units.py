"""Reading and printing quantities: what engineers write, what must be refused and with which sentence."""

import math
import os
import re
import subprocess
import sys
import time

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from truing import units
from truing.errors import UnitError
from truing.numbers import format_difference, format_ends, format_number, format_value, pretty, with_unit
from truing.units import names
from truing.units.meaning import _suggestions
from truing.units.sizes import SIZES

# Definitions: SI Brochure (9th edition), and for the others NIST SP 811, appendix B.8 (exact where the unit is exact).
IN_SI = [
    (["3136 N*m"], "N*m", 3136.0),
    (["360 mm", "0.36 m"], "mm", 0.36),
    (["1 in"], "mm", 0.0254),
    (["30 µm", "30 μm", "30 um", "30 micron"], "mm", 30e-6),
    (["28 mm^2", "28 mm²", "28 mm**2"], "mm^2", 28e-6),
    (["28 mm2"], "m2", 28e-6),
    (["7 mm³"], "m^3", 7e-9),
    (["4 cm4"], "mm4", 4e-8),
    (["4 cm^4"], "m^4", 4e-8),
    (["210 N/mm²"], "MPa", 210e6),
    (["1 bar"], "Pa", 1e5),
    (["5 Nm"], "N*m", 5.0),
    (["5 Nmm"], "N*m", 5e-3),
    (["5 kNm"], "N*m", 5e3),
    (["5 N·m", "5 N m", "5 N-m", "5 N⋅m"], "N*m", 5.0),
    (["3000 rpm"], "1/s", 50.0),
    (["3000 r/min", "3000 1/min", "3000 /min", "3000 min^-1", "3000 min⁻¹", "3000 min-1"], "rpm", 50.0),
    (["2 turn", "2 rev"], "", 2.0),
    (["1e6 cycle"], "", 1e6),
    (["180 deg", "180°"], "rad", math.pi),
    (["60'", "3600''", '3600"'], "deg", math.pi / 180),
    (["30 urad"], "rad", 30e-6),
    (["5 %"], "", 0.05),
    (["5 ‰"], "", 0.005),
    (["5 [-]", "5 -"], "", 5.0),
    (["5 [1]"], "%", 5.0),
    (["5"], "", 5.0),
    (["47 kΩ"], "ohm", 47e3),
    (["60 l/min"], "m^3/s", 1e-3),
    (["50 W/(m·K)"], "W/(m*K)", 50.0),
    (["1 N/µm"], "N/m", 1e6),
    (["12e-6 K⁻¹", "12 1e-6/K", "12 10^-6 1/K", "12 10⁻⁶/K", "12 10^(-6)/K", "12 um/(m·°C)"], "1/K", 12e-6),
    (["1.2×10^-5 1/K", "1.2x10^-5 1/K", "1.2·10⁻⁵ 1/K"], "1/K", 1.2e-5),
    (["10^-3 m"], "mm", 1e-3),
    (["-1.5E+2 mm"], "mm", -0.15),
    (["+.5 mm"], "mm", 5e-4),
    (["5.mm", "5*mm"], "mm", 5e-3),
    (["−5 mm"], "mm", -5e-3),
    (["5 mm"], "mm", 5e-3),
    (["1 year"], "d", 365.25 * 86400),
    (["5 g"], "kg", 5e-3),
    (["1 kWh"], "J", 3.6e6),
    (["1 cSt"], "m^2/s", 1e-6),
    (["1 mPa*s"], "Pa*s", 1e-3),
    (["5 kg m-3"], "kg/m^3", 5.0),
    (["30 MPa*m^0.5"], "Pa*m^(1/2)", 30e6),
    (["1 m/s/s"], "m/s^2", 1.0),
    (["1 (m/s)^2"], "m^2/s^2", 1.0),
    (["1 (m/s)²"], "J/kg", 1.0),
    (["90 N*m/deg"], "N*m/rad", 90 * 180 / math.pi),
    (["16.14 yuan"], "CNY", 16.14),
    (["5 €"], "EUR", 5.0),
    (["2 meters"], "m", 2.0),
    (["20 degC", "20 °C", "20 deg C", "68 °F"], "degC", 293.15),
    (["293.15 K"], "degF", 293.15),
    (["0 K", "-459.67 degF"], "degC", 0.0),
    (["5 K", "5 delta_degC", "9 delta_degF"], "K", 5.0),
    (["5 K"], "delta_degC", 5.0),
]

ONE_NUMBER = "only a power of ten may stand in a unit, at its beginning"
NO_UNIT = "is not a unit; write it like 'N*m', 'mm^2' or 'W/(m*K)'"
REFUSED = [
    ("", "mm", "the text is empty; expected a length such as '1 mm'"),
    ("360", "mm", "'360' has no unit; expected a length such as '360 mm'"),
    ("0.3", "rad", "'0.3' has no unit; expected an angle such as '0.3 rad'"),
    ("20", "degC", "'20' has no unit; expected a temperature level such as '20 degC'"),
    ("88", "%", "'88' has no unit; expected a pure number such as '88 %'"),
    ("3 kN", "mm", "'3 kN' is a force (kN), expected a length (mm)"),
    ("10 m m", "mm", "'10 m m' is an area (m·m), expected a length (mm)"),
    ("5 mm", "", "'5 mm' is a length (mm), expected a pure number"),
    ("5 deg", "", "'5 deg' is an angle (°), expected a pure number"),
    ("5 %", "deg", "'5 %' is a pure number (%), expected an angle (°)"),
    ("5 mms", "mm", "unknown unit 'mms'; did you mean 'mm'?"),
    ("5 MM", "mm", "unknown unit 'MM'; did you mean 'mm'?"),
    ("5 nmm", "N*m", "unknown unit 'nmm'; did you mean 'Nmm'?"),
    ("5 newtn", "N", "unknown unit 'newtn'; did you mean 'newtons'?"),
    ("5 foo", "N", "unknown unit 'foo'"),
    ("5 c", "m/s", "unknown unit 'c'; did you mean 'C'?"),
    ("5 speed_of_light", "m/s", "unknown unit 'speed_of_light'"),
    ("3 dB", "", "unknown unit 'dB'; did you mean 'd'?"),
    ("5 nm", "N*m", "'5 nm' is a length (nm), expected a torque (N·m); did you mean 'Nm'?"),
    ("20 C", "degC", "'20 C' is an electric charge (C), expected a temperature level (°C); did you mean 'degC'?"),
    (
        "10 rad/s",
        "rpm",
        "'10 rad/s' is an angular speed (rad/s), expected a rotational speed (rpm); divide by 2 pi: 1.591549 1/s",
    ),
    (
        "3000 rpm",
        "rad/s",
        "'3000 rpm' is a rotational speed (rpm), expected an angular speed (rad/s); multiply by 2 pi: 314.1593 rad/s",
    ),
    (
        "5 N*m/rad",
        "N*m",
        "'5 N*m/rad' is a torsional stiffness (N·m/rad), expected a torque (N·m); the two differ by an angle",
    ),
    ("5 degC", "K", "'5 degC' is a temperature level; a difference is written 5 K"),
    ("5 °F", "K", "'5 °F' is a temperature level; a difference is written 5 delta_degF"),
    ("5 delta_degC", "degC", "'5 delta_degC' is a temperature difference; a level is written 5 degC"),
    ("-300 degC", "degC", "'-300 degC' lies below absolute zero"),
    ("9**9**9 kN", "kN", "'9**9**9 kN' is not a number followed by a unit"),
    ("10^9^9 kN", "kN", "'10^9^9 kN' is not a number followed by a unit"),
    ("5*3 mm", "mm", "'5*3 mm' is not a number followed by a unit"),
    ("nan mm", "mm", "'nan mm' is not a finite number"),
    ("∞ mm", "mm", "'∞ mm' is not a finite number"),
    ("1e400 mm", "mm", "'1e400 mm' is too large for a number"),
    ("1e-400 mm", "mm", "'1e-400 mm' is too small for a number"),
    ("1e308 km", "mm", "'1e308 km' is too large for a number in SI units"),
    ("1e-323 nm", "mm", "'1e-323 nm' is too small for a number in SI units"),
    ("0,36 m", "m", "'0,36 m' has a decimal comma; write '0.36 m'"),
    (",5 mm", "mm", "',5 mm' has a decimal comma; write '0.5 mm'"),
    ("1,234.5 mm", "mm", "'1,234.5 mm' holds commas; write '1234.5 mm'"),
    ("5_000 mm", "mm", "'5_000 mm' holds an underscore; write the number with digits alone"),
    ("1 000 mm", "mm", "'1 000 mm' holds a second number; write one number, without blanks, and then its unit"),
    ("five mm", "mm", "'five mm' does not begin with a number; write it like '5 mm'"),
    ("mm", "mm", "'mm' does not begin with a number; write it like '5 mm'"),
    ("5 W/m·K", "W/(m*K)", "'W/m·K' is ambiguous; put what is below the '/' in parentheses, as in 'W/(m*K)'"),
    ("5 Nmm²", "N*mm^2", "'Nmm²' is ambiguous; write 'Nmm' as 'N*mm' with its exponents"),
    ("5 60 s", "s", "'5 60 s' holds a second number; write one number, without blanks, and then its unit"),
    ("5 N*3", "N", f"the unit 'N*3' holds the number '3'; {ONE_NUMBER}"),
    ("5 m^13", "m", "the unit 'm^13' has an exponent beyond 12"),
    ("5 (m^9)^9", "m", "the unit '(m^9)^9' has an exponent beyond 12"),
    ("5 m^(1/0)", "m", "'m^(1/0)' is not a unit: an exponent divides by zero"),
    ("5 1e-99 m", "m", "the unit '1e-99 m' carries too large a power of ten"),
    ("5 m**", "m", f"'m^' {NO_UNIT}"),
    ("5 (m", "m", f"'(m' {NO_UNIT}"),
    ("5 m//s", "m/s", f"'m//s' {NO_UNIT}"),
    ("5 __import__('os')", "m", "unknown unit '__import__'"),
    ("5 m; 6", "m", "'5 m; 6' holds ';', which stands in no number or unit"),
    (
        "20° 10",
        "deg",
        f"the unit '° 10' holds the number '10'; {ONE_NUMBER}",
    ),
    ("5 m - 10", "m", f"the unit 'm - 10' holds the number '10'; {ONE_NUMBER}"),
    ("5 m/10", "m", f"the unit 'm/10' holds the number '10'; {ONE_NUMBER}"),
    ("5 m+2", "m", f"the unit 'm+2' holds the number '2'; {ONE_NUMBER}"),
    ("5 rev2", "", f"'rev2' {NO_UNIT}"),
    ("5 m0", "", "the unit 'm0' has the exponent 0"),
    ("5 N - m", "N*m", f"'N - m' {NO_UNIT}"),
    ("20 10^1", "", "'20 10^1' is two numbers; write one"),
    ("5 degC*m/m", "degC", "'degC*m/m' may be a temperature level or a difference; write degC alone, or K"),
    ("5 degC*m/m", "K", "'degC*m/m' may be a temperature level or a difference; write degC alone, or K"),
    ("5 K*m/m", "degC", "'5 K*m/m' is a temperature difference; a level is written 5 degC"),
    ("5 kcycles", "", "unknown unit 'kcycles'; 'cycles' takes no prefix 'k': write '10^3 cycles'"),
    ("5 byte", "", "unknown unit 'byte'"),
    ("1,050 mm", "mm", "'1,050 mm' holds a comma; write '1.050 mm' or '1050 mm'"),
    ("\u0661\u0662 mm", "mm", "'\u0661\u0662 mm' holds '\u0661', which stands in no number or unit"),
    ("\uff15,\uff15 mm", "mm", "'\uff15,\uff15 mm' holds '\uff15', which stands in no number or unit"),
    ("5 <b>m</b>", "m", "'5 <b>m</b>' holds '<', which stands in no number or unit"),
    ("5 \x00m", "m", "'5 \\x00m' holds '\\x00', which stands in no number or unit"),
]


@pytest.mark.parametrize(("texts", "unit", "expected"), IN_SI)
def test_what_engineers_write(texts, unit, expected):
    for text in texts:
        assert units.read_quantity(text, unit) == pytest.approx(expected, rel=1e-14, abs=1e-300), text


@pytest.mark.parametrize(("text", "unit", "sentence"), REFUSED)
def test_what_is_refused(text, unit, sentence):
    with pytest.raises(UnitError) as caught:
        units.read_quantity(text, unit)
    assert str(caught.value) == sentence


def test_a_band_belongs_to_the_tolerances_and_a_long_text_is_cut_in_the_sentence():
    for text in ("360 ± 0.05 mm", "360 mm +/- 0.05", "360 +- 0.05 mm", "360±0.05 mm", "± 0.05 mm"):
        with pytest.raises(UnitError, match=r"holds a tolerance; .* under \[tolerances\]$"):
            units.read_quantity(text, "mm")
    with pytest.raises(UnitError, match=r"is too long for a number with a unit \(100000 characters\)") as caught:
        units.read_quantity("9" * 100_000, "mm")
    assert len(str(caught.value)) < 150


def test_one_literal_is_one_number():
    """A text, a default in code and the SI number agree to the last digit, so that input hashes agree."""
    for number in (0.36, 28.0, 1.25e-3, 7.1):
        assert units.read_quantity(f"{number!r} mm", "mm") == units.to_si(number, "mm") == number / 1000
    assert units.read_quantity("28 mm^2", "mm^2") == 28e-6
    assert units.from_si(units.to_si(28.0, "mm^2"), "mm^2") == 28.0


@pytest.mark.parametrize("unit", ["mm", "kN", "deg", "degC", "degF", "um/K", "%", "rpm", "1e-6/K", "EUR", "in"])
def test_arrays_go_as_numbers_do_and_come_back(unit):
    values = np.array([[1.5, -2.25, 300.0], [0.0, 1e-3, 7e5]])
    kept = values.copy()
    inside = units.to_si(values, unit)
    assert isinstance(inside, np.ndarray)
    np.testing.assert_array_equal(values, kept)
    np.testing.assert_array_equal(inside.ravel(), [units.to_si(float(value), unit) for value in values.ravel()])
    np.testing.assert_allclose(units.from_si(inside, unit), values, rtol=1e-13, atol=1e-12)


def test_the_kind_of_number_is_kept():
    for convert in (units.to_si, units.from_si):
        assert type(convert(3, "mm")) is type(convert(np.float64(3), "mm")) is float
        assert convert(np.array([1, 2]), "mm").dtype == np.float64


def test_powers_of_ten_in_a_header():
    for unit, size in (("1e-6/K", 1e-6), ("10^-6 1/K", 1e-6), ("10^3 N", 1e3), ("1e-3", 1e-3)):
        assert units.to_si(11.5, unit) == pytest.approx(11.5 * size, rel=1e-15)
    for pure in ("", "[]", "[-]", "[1]", "-", "1"):
        assert units.to_si(2.0, pure) == 2.0


OF_COLUMNS = [
    ("mm", "N", "'mm' is a length (mm), expected a force (N)"),
    ("degC", "K", "'degC' is a temperature level; a difference is written in K"),
    ("delta_degC", "degC", "'delta_degC' is a temperature difference; a level is written in degC"),
    ("rpm", "rad/s", "'rpm' is a rotational speed (rpm), expected an angular speed (rad/s); multiply by 2 pi"),
    ("mms", "mm", "unknown unit 'mms'; did you mean 'mm'?"),
]


@pytest.mark.parametrize(("given_unit", "unit", "words"), OF_COLUMNS)
def test_the_unit_of_a_column(given_unit, unit, words):
    with pytest.raises(UnitError, match=f"^{re.escape(words)}$"):
        units.demand_dimension(given_unit, unit)


SAME = ["mm in", "N*m J", "degC K", "rpm Hz", "deg arcmin", "N*m/rad N*m/deg", "% ppm", "sr rad^2"]
OTHER = ["rpm rad/s", "deg %", "N*m/rad N*m", "EUR CNY", "EUR %"]


def test_same_dimension():
    for pairs, same in ((SAME, True), (OTHER, False)):
        for left, right in map(str.split, pairs):
            assert units.same_dimension(left, right) is units.same_dimension(right, left) is same, (left, right)


WORDS_OF = {
    "kWh": "an energy or work", "N/mm^2": "a pressure or stress", "degC": "a temperature level", "%": "a pure number",
    "rpm": "a rotational speed", "Hz": "a frequency", "yuan": "an amount of money", "m^5/s": "[length]**5/[time]",
    "rad^3/m^0.5": "[angle]**3/[length]**0.5", "EUR/h": "[EUR]/[time]",
}  # fmt: skip


def test_human_dimension():
    assert {unit: units.human_dimension(unit) for unit in WORDS_OF} == WORDS_OF


def test_every_kind_of_quantity_has_one_name():
    words = [units.human_dimension(unit) for unit, _ in names.KINDS]
    assert words.count("a torque") == 1
    assert len({text for text, _ in names.KINDS}) == len(names.KINDS)
    for unit, expected in names.KINDS:
        if unit != "1/s":
            assert units.human_dimension(unit) == expected


PRINTED = {
    "N*m": "N·m", "Nm": "N·m", "um": "µm", "m/s**2": "m/s²", "m/s^2": "m/s²", "m s^-2": "m/s²", "degC": "°C",
    "deg": "°", "arcmin": "′", "": "", "[-]": "", "1": "", "%": "%", "W/(m*K)": "W/(m·K)", "K^-1": "1/K",
    "1e-6/K": "10⁻⁶/K", "10^3 N": "10³·N", "MPa*m^0.5": "MPa·m^0.5", "kohm": "kΩ", "delta_degC": "K", "mm^4": "mm⁴",
    "rpm": "rpm", "€": "EUR",
}  # fmt: skip


def test_printed_units():
    assert {unit: units.unit_text(unit) for unit in PRINTED} == PRINTED


@pytest.mark.parametrize("unit", [text for text, _ in names.KINDS] + ["um/degC", "1e-6/K", "N/mm²", "kN*m/deg"])
def test_a_printed_unit_can_be_read_again(unit):
    assert units.same_dimension(units.unit_text(unit), unit)
    assert units.unit_factor(units.unit_text(unit)) == pytest.approx(units.unit_factor(unit), rel=1e-15)


def test_every_unit_that_is_suggested_exists():
    assert len(_suggestions()) > 300
    for name in _suggestions():
        units.check_unit(name)
        assert units.unit_factor(name) > 0


def test_names_that_pint_takes_for_something_else():
    """Nm is a textile count, cycle rev turn are 2 pi, pa is a picoyear and MM a megamolar in pint."""
    assert units.same_dimension("Nm", "J")
    assert units.unit_factor("rev") == units.unit_factor("cycle") == units.unit_factor("turn") == 1.0
    for name in ("pa", "MM", "c", "R", "k", "e", "pi", "zeta", "lambda", "b", "decibel", "dB", "degree_Reaumur"):
        with pytest.raises(UnitError):
            units.check_unit(name)


@pytest.mark.parametrize("name", [name for name, (definition, _) in names.SYMBOLS.items() if definition.isidentifier()])
def test_sizes_agree_with_pint(name):
    """The table of names points at the unit it means: the symbol, read by pint itself, has the same size."""
    definition = names.SYMBOLS[name][0]
    size = units.registry().Quantity(1.0, definition).to_base_units().magnitude
    assert units.unit_factor(name) == pytest.approx(size, rel=1e-14)


def test_what_is_written_down_of_a_unit_is_what_pint_says():
    """Every definition of a symbol, and no other; the last digit may differ from one release of pint to the next."""
    assert {definition for definition, _ in names.SYMBOLS.values() if definition.isidentifier()} == SIZES.keys()
    for name, (size, bases) in SIZES.items():
        said, base = units.registry().get_base_units(name)
        exponents = {
            unit: float(exponent or 1) for unit, _, exponent in (each.partition("^") for each in bases.split())
        }
        assert exponents == dict(base._units), name
        assert size == pytest.approx(said, rel=1e-15), name


def test_pint_quantities_prove_dimensions():
    torque = units.pint_quantity(3.0, "N*mm") / units.pint_quantity(2.0, "m")
    assert torque.dimensionality == units.registry().newton.dimensionality
    assert torque.to_base_units().magnitude == 1.5
    assert units.pint_quantity(0.3, "deg").dimensionless
    assert units.pint_quantity(293.15, "degC").units == units.registry().kelvin
    price = units.pint_quantity(3.0, "EUR") / units.pint_quantity(2.0, "CNY")
    assert not price.dimensionless
    assert str(units.pint_quantity(1.0, "Pa*m^0.5").dimensionality) == "[mass] / [length] ** 0.5 / [time] ** 2"


def read_in_a_new_process(cache):
    script = "import truing.units as u; print(u.read_quantity('5 mm', 'mm'), u.registry().cache_folder)"
    environment = {**os.environ, "XDG_CACHE_HOME": str(cache)}
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False, env=environment)
    return done.stdout.split() or done.stderr


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the folder of the cache is set by XDG_CACHE_HOME")
def test_a_broken_cache_does_not_stop_a_calculation(tmp_path):
    """An ordinary file where the cache would be a folder; a cache file that another process left half-written."""
    (tmp_path / "file").write_text("no folder", encoding="utf-8")
    assert read_in_a_new_process(tmp_path / "file") == ["0.005", "None"]
    assert read_in_a_new_process(tmp_path / "good")[0] == "0.005"
    torn = [path for path in (tmp_path / "good").rglob("*") if path.is_file() and path.suffix != ".json"]
    assert torn, "the cache was written"
    for path in torn:
        path.write_bytes(path.read_bytes()[:20])
    assert read_in_a_new_process(tmp_path / "good")[0] == "0.005"


ALPHABET = "0123456789.+-*/^()[]eE xmkNPadgsKrCF°µ·×²⁻'\"%_,±~\n\u00a0nifµΩ$€"
PIECES = [
    *["5", "1e3", "10^", "**", "mm", "kN", "N", "m", "degC", "/", "*", "(", ")", "^2", "²", "-", "nan", "rad", "1"],
    " ",
]
ANY_TEXT = st.one_of(
    st.text(max_size=250),
    st.text(alphabet=ALPHABET, max_size=60),
    st.lists(st.sampled_from(PIECES), max_size=12).map("".join),
    st.text(alphabet=ALPHABET, max_size=30).map(lambda tail: "5 " + tail),
)


@settings(max_examples=400, deadline=None)
@given(text=ANY_TEXT, unit=st.sampled_from(["mm", "", "degC", "rad", "rpm", "N*m", "K", "EUR"]))
@example(text="9**9**9 kN", unit="mm")
@example(text="9" * 200, unit="mm")
@example(text="5 " + "(" * 190, unit="mm")
@example(text="5 " + "m*" * 99, unit="mm")
@example(text="5 " + "m^12 " * 39, unit="mm")
@example(text="5 m^0.3333333333333333333333333333333333", unit="mm")
@example(text="\ud800", unit="mm")
@example(text="٣ mm", unit="mm")
def test_any_text_is_a_number_or_one_sentence_at_once(text, unit):
    begin = time.perf_counter()
    try:
        value = units.read_quantity(text, unit)
    except UnitError as error:
        sentence = str(error)
        assert "\n" not in sentence
        assert sentence.isprintable()
        assert len(sentence) < 300
    else:
        assert math.isfinite(value)
    assert time.perf_counter() - begin < 1


@settings(max_examples=200, deadline=None)
@given(unit=ANY_TEXT)
def test_any_unit_text_is_a_unit_or_one_sentence(unit):
    try:
        units.check_unit(unit)
    except UnitError:
        return
    assert units.unit_factor(unit) > 0
    assert units.same_dimension(units.unit_text(unit), unit)
    assert units.human_dimension(unit)


@settings(deadline=None)
@given(value=st.floats(allow_nan=False, allow_infinity=False, min_value=-1e100, max_value=1e100))
def test_a_printed_number_is_read_back(value):
    text = f"{value!r} mm"
    if value == 0 or abs(value) > 1e-300:
        assert units.read_quantity(text, "mm") == value / 1000


# Numbers as an engineer writes them.


WRITTEN = [
    (0.73812, 4, "0.7381"), (12.5, 4, "12.5"), (3137.4, 4, "3137"), (31372.4, 4, "31372"), (1.2e-5, 4, "1.2e-05"),
    (1.23456e-5, 3, "1.23e-05"), (2.1e11, 4, "2.1e+11"), (0.00012346, 4, "0.0001235"), (0.99996, 4, "1"),
    (9999.96, 5, "10000"), (0.000099999, 3, "0.0001"), (100, 2, "100"), (123456789, 4, "123456789"),
    (np.int64(12345), 2, "12345"), (0.0, 4, "0"), (-0.0, 4, "0"), (-2.5, 4, "-2.5"), (-1e-9, 4, "-1e-09"),
    (math.nan, 4, "–"), (math.inf, 4, "–"), (None, 4, "–"),
]  # fmt: skip


@pytest.mark.parametrize(("value", "digits", "text"), WRITTEN)
def test_a_number_is_written_with_the_digits_that_matter(value: object, digits: int, text: str) -> None:
    assert format_number(value, digits) == text


@given(st.floats(allow_nan=False, allow_infinity=False, min_value=-1e300, max_value=1e300), st.integers(1, 12))
def test_what_is_written_is_the_number_to_its_digits_and_sign(value: float, digits: int) -> None:
    read = float(format_number(value, digits))
    assert read == pytest.approx(value, rel=0.51 * 10.0 ** (1 - digits), abs=0)
    assert math.copysign(1, read) == math.copysign(1, value) or value == 0


def test_a_value_is_written_in_its_unit_and_a_difference_of_temperatures_as_one() -> None:
    for si, unit, written in [
        (0.0000125, "um", ("12.5", "µm")), (308.15, "degC", ("35", "°C")), (math.pi, "deg", ("180", "°")),
        (3136.0, "N*m", ("3136", "N·m")), (3, "", ("3", "")), (math.nan, "mm", ("–", "mm")), (None, "mm", ("–", "mm")),
    ]:  # fmt: skip
        assert format_value(si, unit) == written
    for si, unit, written in [(2.0, "degC", ("2", "K")), (0.001, "mm", ("1", "mm")), (5.0, "degF", ("9", "Δ°F"))]:
        assert format_difference(si, unit) == written


def test_only_numbers_are_made_pretty_and_degrees_follow_closely() -> None:
    printed = {"1.2e-05": "1.2 × 10⁻⁵", "-3e+08": "−3 × 10⁸", "-12.5": "−12.5"}
    printed |= {text: text for text in ("0.7381", "–", "-abc", "1e5 bolts", "e-05")}
    assert {text: pretty(text) for text in printed} == printed
    assert [with_unit("12", unit) for unit in ("°", "°C", "")] == ["12°", "12 °C", "12"]


@pytest.mark.parametrize(
    ("values", "ends"),
    [
        ([-124.15e-6, 4.1e-17], ("-0.12415", "0")),
        ([-4.1e-17, 124.15e-6], ("0", "0.12415")),
        ([-1e-9, 1e-3], ("-1e-06", "1")),  # seen in full
        ([1e-15, 1e3], ("1e-12", "1000000")),  # of one sign: a spectrum spans as much
        ([np.nan, 2e-3], ("2", "2")),
    ],
)
def test_what_is_left_of_a_difference_is_written_as_zero_beside_the_other_sign(values, ends) -> None:
    assert format_ends(np.array(values), "mm")[:2] == ends
