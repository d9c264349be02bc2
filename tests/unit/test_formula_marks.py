"""How symbols, numbers, units and whole formulas look in print, and that no text does harm there."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from truing.formulas import parse, symbol_mathml, symbol_text
from truing.formulas.layout import substituted, symbolic
from truing.formulas.write_latex import LATEX, number_latex, symbol_latex
from truing.formulas.write_mathml import MATHML, number_mathml

SYMBOLS = [
    ("F", "<mi>F</mi>", "F", "F"),
    ("h_0", "<msub><mi>h</mi><mn>0</mn></msub>", "h_{0}", "h_0"),
    ("k_R", "<msub><mi>k</mi><mi>R</mi></msub>", "k_{R}", "k_R"),
    ("theta_11", "<msub><mi>θ</mi><mn>11</mn></msub>", r"\theta_{11}", "θ_11"),
    ("xi_lh", '<msub><mi>ξ</mi><mi mathvariant="normal">lh</mi></msub>', r"\xi_{\mathrm{lh}}", "ξ_lh"),
    ("Phi_alpha", "<msub><mi>Φ</mi><mi>α</mi></msub>", r"\Phi_{\alpha}", "Φ_α"),
    ("θ", "<mi>θ</mi>", r"\theta", "θ"),
    ("Delta z", '<mrow><mi mathvariant="normal">Δ</mi><mi>z</mi></mrow>', r"\Delta z", "Δz"),
    ("z_2'", "<msubsup><mi>z</mi><mn>2</mn><mo>′</mo></msubsup>", r"z_{2}^{\prime}", "z_2′"),
    ("z'", "<msup><mi>z</mi><mo>′</mo></msup>", r"z^{\prime}", "z′"),
    ("Re", '<mi mathvariant="normal">Re</mi>', r"\mathrm{Re}", "Re"),
    ("F_N,max", None, r"F_{N,\mathrm{max}}", "F_N,max"),
]


@pytest.mark.parametrize(("symbol", "in_mathml", "in_latex", "plain"), SYMBOLS)
def test_symbols(symbol: str, in_mathml: str | None, in_latex: str, plain: str) -> None:
    assert in_mathml is None or symbol_mathml(symbol) == in_mathml
    assert (symbol_latex(symbol), symbol_text(symbol)) == (in_latex, plain)


NUMBERS = [
    ("360", "<mn>360</mn>", "360"),
    ("-2.5", '<mrow><mo form="prefix">−</mo><mn>2.5</mn></mrow>', "-2.5"),
    ("3e+08", "<mrow><mn>3</mn><mo>×</mo><msup><mn>10</mn><mn>8</mn></msup></mrow>", r"3 \times 10^{8}"),
    ("1.2e-05", None, r"1.2 \times 10^{-5}"),
    ("12 345", "<mn>12 345</mn>", r"12\thinspace 345"),
    ("–", "<mtext>–</mtext>", r"\mathrm{\text{–}}"),
]


@pytest.mark.parametrize(("text", "in_mathml", "in_latex"), NUMBERS)
def test_numbers(text: str, in_mathml: str | None, in_latex: str) -> None:
    assert in_mathml is None or number_mathml(text) == in_mathml
    assert number_latex(text) == in_latex


SYMBOL_OF = {name: name for name in ["a", "b", "c", "x"]}
FEWEST = [
    ("a * b / c", r"\frac{a \thinspace b}{c}"),
    ("a / (b * c)", r"\frac{a}{b \thinspace c}"),
    ("a + (b + c)", "a + b + c"),
    ("a - (b - c)", r"a - \left( b - c \right)"),
    ("a - b * c", r"a - b \thinspace c"),
    ("(a * b) + c", r"a \thinspace b + c"),
    ("2**-x", "2^{-x}"),
    ("(a + b)**2", r"\left( a + b \right)^{2}"),
    ("sin(x)**2", r"\sin^{2} x"),
    ("2 * 3 * a", r"2 \cdot 3 \thinspace a"),
    ("a * 2", r"a \cdot 2"),
    ("-a / b", r"-\frac{a}{b}"),
    ("max(a, b)", r"\mathrm{max} \left( a,\thinspace b \right)"),
    ("friction * a", r"\mathrm{friction} \cdot a"),
    ("contact_area", r"\mathrm{contact\ area}"),
    ("sqrt(a) + cbrt(b)", r"\sqrt{a} + \sqrt[3]{b}"),
    ("abs(a - b)", r"\left\vert a - b \right\vert"),
    ("log10(a) * log(b) * exp(c)", r"\log_{10} a \thinspace \ln \left( b \right) \thinspace \exp \left( c \right)"),
    ("atan(a) * sinh(b) * sum(c)", r"\arctan a \thinspace \sinh b \thinspace \sum c"),
    ("max(a, -pi)", r"\mathrm{max} \left( a,\thinspace -\pi \right)"),
    ("tan(x) == a / b", r"\tan x = \frac{a}{b}"),
    ("2 * Phi(a / b) - 1", r"2 \thinspace \Phi \left( \frac{a}{b} \right) - 1"),
    (
        "cases(a, x > 1 and b <= 2, b, a != 0 or x == c, c)",
        r"\begin{cases} a & \mathrm{if}\ x \gt 1\ \mathrm{and}\ b \le 2 \cr b & \mathrm{if}\ a \ne 0\ \mathrm{or}\ "
        r"x = c \cr c & \mathrm{otherwise} \end{cases}",
    ),
]


@pytest.mark.parametrize(("text", "expected"), FEWEST)
def test_parentheses_only_where_needed(text: str, expected: str) -> None:
    assert symbolic(LATEX, parse(text), SYMBOL_OF) == expected


def test_numbers_take_the_place_of_symbols() -> None:
    formula = parse("a * b**2 / c")
    numbers = {"a": ("1.2e-05", "N·m"), "b": ("-3", ""), "c": ("20", "°")}
    printed = substituted(LATEX, formula, numbers)
    assert printed == (
        r"\frac{1.2 \times 10^{-5}\thinspace \mathrm{N{\cdot}m} \cdot \left( -3 \right)^{2}}{20\mathrm{{^{\circ}}}}"
    )
    text = "".join(ElementTree.fromstring(f"<r>{substituted(MATHML, formula, numbers)}</r>").itertext())
    assert text == "1.2×10−5N·m⋅(−3)220°"


def test_units_that_carry_a_power_and_what_only_one_of_two_values_needs() -> None:
    formula = parse("a")
    assert substituted(LATEX, formula, {"a": ("12", "10⁻⁶/K")}) == r"12 \times \mathrm{10^{-6}/K}"
    assert substituted(LATEX, formula, {"a": ("12", "mm^0.5")}) == r"12\thinspace \mathrm{mm^{0.5}}"
    assert "<mo>×</mo>" in substituted(MATHML, formula, {"a": ("12", "10⁻⁶/K")})
    formula = parse("either(a, b) * 2")
    assert substituted(LATEX, formula, {"a": ("–", ""), "b": ("1.2", "")}) == r"1.2 \cdot 2"
    assert substituted(LATEX, formula, {"a": ("1.7", ""), "b": ("1.2", "")}) == r"1.7 \cdot 2"
    assert r"\mathrm{if\ given}" in symbolic(LATEX, formula, SYMBOL_OF)


CORE = {"mrow", "mi", "mn", "mo", "mfrac", "msqrt", "mroot", "msup", "msub", "msubsup", "mtext", "mspace"}
CORE |= {"mtable", "mtr", "mtd"}
ATTRIBUTES = {"form", "stretchy", "width", "mathvariant", "separator", "largeop", "displaystyle", "style"}
RICH = parse("cases(-a**2 / sqrt(b), sin(x) > 1 and b < 2, either(cbrt(abs(c)), sum(a) * log10(x)))")
HOSTILE = st.text(st.sampled_from("<>&\"'$#%_{}^\\|~`*[]()!/ax1,. \n\t\x00\x1b\u202e²°µ·′"), max_size=12) | st.text(
    max_size=8
)


NASTY = [
    "<script>alert(1)</script>", "&lt;b&gt;", "$x$", "a|b", "²^1", "mm^2²", "\\input{x}", "{{7*7}}", "}{", "`x`",
    "[a](b)", "</math>",
]  # fmt: skip


def nasty(test: Callable[..., None]) -> Callable[..., None]:
    """Try these texts in any case."""
    for text in NASTY:
        test = example(text)(test)
    return test


def printed_with(text: str) -> tuple[list[str], list[str]]:
    names = dict.fromkeys(RICH.names, text)
    numbers = dict.fromkeys(RICH.names, (text, text))
    in_mathml, in_latex = (
        [symbolic(writer, RICH, names), substituted(writer, RICH, numbers)] for writer in (MATHML, LATEX)
    )
    return [*in_mathml, symbol_mathml(text), number_mathml(text)], [*in_latex, symbol_latex(text), number_latex(text)]


@nasty
@given(HOSTILE)
@settings(max_examples=150, deadline=None)
def test_any_text_is_inert(text: str) -> None:
    in_mathml, in_latex = printed_with(text)
    for markup in in_mathml:
        for element in ElementTree.fromstring(f"<mrow>{markup}</mrow>").iter():
            assert element.tag in CORE
            assert set(element.attrib) <= ATTRIBUTES
        assert not re.search(r"&(?!(?:lt|gt|amp|quot|#x27);)", markup)
    for words in in_latex:
        bare = re.sub(r"\\[$#%&_]", "x", words.replace(" & ", " "))  # a printed mark is as good as a letter
        assert not re.search(r"[$#%&|<>`~*\n\x00\x1b\u202e\[]", bare.replace(r"\sqrt[3]", ""))
        assert set(re.findall(r"\\(?![A-Za-z ])", bare)) == set()
        depth = 0
        for brace in re.findall(r"[{}]", bare):
            depth += 1 if brace == "{" else -1
            assert depth >= 0
        assert depth == 0
        assert not re.search(r"\^\{[^{}]*\}\s*\^", bare)
        assert not set(re.findall(r"\\([A-Za-z]+)", bare)) & {"input", "href", "def", "write", "include"}
    assert symbol_text(text).isprintable()


def test_markup_of_a_symbol_shows_its_characters() -> None:
    assert "".join(ElementTree.fromstring(symbol_mathml("<b>")).itertext()) == "<b>"
    assert symbol_latex("50%") == r"\mathrm{50\%}"
    assert symbol_latex("a|b") == r"\mathrm{a\vert{}b}"
