"""Small calculations with known answers, importable by worker processes."""

from dataclasses import replace
from typing import Literal

import numpy as np

from truing import (
    Condition,
    Effect,
    Float,
    Maximise,
    Minimise,
    Model,
    Optimise,
    Price,
    Require,
    Tolerance,
    Unknown,
    Vary,
    axis,
    by_choice,
    column,
    drawn,
    feasible,
    found,
    given,
    grade,
    hookimpl,
    inputs,
    lognormal,
    normal,
    plus_minus,
    results,
    uniform,
    zone,
)
from truing.kernel import Origin
from truing.setup import Setup, SwitchedOn, default_setup


def setup_of(model, **values) -> Setup:
    return default_setup(model, Origin("study_models", "", "", __file__, "module:study_models"), **values)


@inputs
class Chain:
    """Three lengths in a row."""

    first: Float = given(30.0, "mm")
    second: Float = given(20.0, "mm")
    third: Float = given(40.0, "mm")
    gap_limit: Float = given(0.1, "mm")


@results
class Gap:
    """What is left between them."""

    gap: Float = found("mm")
    twice: Float = found("mm")


def chain(sizes: Chain) -> Gap:
    """The dimension chain of a textbook: the gap closes the row."""
    gap = sizes.first + sizes.second - sizes.third
    return Gap(gap=gap, twice=2 * gap)


def grow(sizes: Chain, *, strain: Float, warmth: Float) -> Chain:
    """All lengths grow alike."""
    factor = 1 + strain * (warmth - WARMTH.zero)
    return replace(sizes, first=sizes.first * factor, second=sizes.second * factor, third=sizes.third * factor)


def misread(sizes: Chain, base: Gap, *, offset: Float) -> Gap:
    """The gauge stands off; the gap does not care."""
    return Gap(gap=base.gap + offset, twice=base.twice)


WARMTH = Condition("warmth", "degC", reference=20)
CHAIN = Model(
    name="chain", title="Dimension chain", function=chain,
    errors=[
        Tolerance("first", normal(sd="0.03 mm")),
        Tolerance("second", normal(sd="0.04 mm")),
        Tolerance("third", normal(sd="0.12 mm")),
        Effect("grow", on_inputs=grow, unknowns=[Unknown("strain", -1e-4, 1e-4, "1/K")], needs=[WARMTH]),
        Effect("misread", on_reading=misread, unknowns=[Unknown("offset", -1, 1, "mm")]),
    ],
    objectives=[
        Require("gap", within="0.2 mm", reliability=0.85), Require("twice", at_most="20.3 mm", reliability=0.5),
    ],
)  # fmt: skip


@inputs
class Two:
    """Two numbers that scatter."""

    x: Float = given(0.0, "")
    y: Float = given(0.0, "")


@results
class Sum:
    """What they make together."""

    total: Float = found("")


def add(two: Two) -> Sum:
    """The sum."""
    return Sum(total=two.x + two.y)


UNIFORMS = Model(
    name="uniforms", title="Sum of two uniform numbers", function=add,
    errors=[Tolerance("both", uniform("1"), on=["x", "y"])],
    objectives=[Require("total", within="0.5")],
)  # fmt: skip


def strength_minus(two: Two) -> Sum:
    """The load itself; the strength is the input y."""
    return Sum(total=two.x)


STRENGTH = Model(
    name="strength", title="Load against strength", function=strength_minus,
    errors=[Tolerance("x", normal(sd="3")), Tolerance("y", normal(sd="4"))],
    objectives=[Require("total", at_most="y", reliability=0.9)],
)  # fmt: skip


@inputs
class Three:
    """The three angles of Ishigami and Homma."""

    x1: Float = given(0.0, "")
    x2: Float = given(0.0, "")
    x3: Float = given(0.0, "")


def ishigami(three: Three) -> Sum:
    """Ishigami and Homma's test function, a = 7, b = 0.1."""
    return Sum(total=np.sin(three.x1) + 7 * np.sin(three.x2) ** 2 + 0.1 * three.x3**4 * np.sin(three.x1))


ISHIGAMI = Model(
    name="ishigami", title="Ishigami function", function=ishigami,
    errors=[Tolerance("angle", uniform(f"{np.pi!r}"), on=["x1", "x2", "x3"])],
)  # fmt: skip


@inputs
class Root:
    """A number whose root is taken."""

    square: Float = given(1.0, "m^2")


@results
class Side:
    """Its root."""

    side: Float = found("m")


def root(inputs_: Root) -> Side:
    """The side of a square, where there is one."""
    feasible(inputs_.square >= 0, "no square has a negative area")
    return Side(side=np.sqrt(inputs_.square))


ROOT = Model(
    name="root", title="Side of a square", function=root,
    errors=[Tolerance("square", normal(sd="1 m^2"))],
    objectives=[Require("side", at_least="0 m", reliability=0.5)],
)  # fmt: skip


def joint(rng, rows):
    """Two deviations of which the second follows the first."""
    common = rng.standard_normal(rows)
    return {"x": common, "y": -0.5 * common}


JOINT = Model(
    name="joint", title="Inputs that scatter together", function=add,
    errors=[Tolerance("pair", drawn(joint), on=["x", "y"])],
    objectives=[Require("total", within="0.5", reliability=0.5)],
)  # fmt: skip


@inputs
class Graded:
    """Lengths whose grades may be chosen."""

    large: Float = given(100.0, "mm")
    middle: Float = given(40.0, "mm")
    small: Float = given(10.0, "mm")
    shift: Float = given(0.0, "mm")


@results
class Stack:
    """Their sum, weighted."""

    height: Float = found("mm")


def stack(lengths: Graded) -> Stack:
    """A weighted sum."""
    return Stack(height=lengths.large + 1.5 * lengths.middle - 0.5 * lengths.small + lengths.shift)


@inputs
class Ages:
    """A rate of wear and how long it goes on."""

    rate: Float = given(2.0, "um/h", symbol="k")
    load: Float = given(100.0, "N")
    working_time: Float = given(10.0, "h")
    stages: int = given(2)


@results
class Worn:
    """The depth then, and along the way."""

    depth: Float = found("um")
    hours: Float = axis("h")
    course: Float = found("um", along="hours")


def age(ages: Ages) -> Worn:
    """Depth grows with time, evenly."""
    hours = 3600.0 * np.array([1.0, 4.0, 9.0])
    return Worn(
        depth=ages.rate * ages.working_time * ages.stages, hours=hours, course=column(ages.rate) * hours * ages.stages
    )


WEAR = Model(
    name="wear", title="Even wear", function=age,
    errors=[Tolerance("rate", normal(sd="25 %")), Tolerance("load", lognormal(sd="10 %"))],
    objectives=[
        Require("depth", at_most="50 um", reliability=0.9), Require("course", at_most="20 um", reliability=0.1),
    ],
)  # fmt: skip
LOGNORMAL = Model(
    name="lognormal", title="Lognormal load against lognormal strength", function=strength_minus,
    errors=[Tolerance("x", lognormal(sd="20 %")), Tolerance("y", lognormal(sd="10 %"))],
    objectives=[Require("total", at_most="y", reliability=0.9)],
)  # fmt: skip


def saddle(two: Two) -> Sum:
    """A limit that bends away from the origin: 0.1 (x - y)^2 - (x + y)/sqrt 2 + 2.5."""
    return Sum(total=0.1 * (two.x - two.y) ** 2 - (two.x + two.y) / np.sqrt(2) + 2.5)


SADDLE = Model(
    name="saddle", title="Quadratic limit", function=saddle,
    errors=[Tolerance("both", normal(sd="1"), on=["x", "y"])],
    objectives=[Require("total", at_least="0", reliability=0.9)],
)  # fmt: skip
STACK = Model(
    name="stack", title="Stack", function=stack,
    errors=[
        Tolerance("large", grade("IT9")), Tolerance("middle", grade("IT9")), Tolerance("small", grade("IT9")),
        Tolerance("shift", zone("0 um", "6 um")),
    ],
    objectives=[Require("height", within="15 um", reliability=0.95)],
)  # fmt: skip
PRICED = Model(
    name="priced", title="Stack with prices", function=stack,
    errors=[
        Tolerance("large", grade("IT9"), price=Price("3 * width**-0.6 + 2", width="um", unit="EUR")),
        Tolerance("middle", grade("IT9"), price=Price("9 * width**-0.8", width="um", unit="EUR")),
        Tolerance("small", grade("IT9"), price=Price("1 * width**-0.5 + 1", width="um", unit="EUR")),
    ],
    objectives=[Require("height", within="15 um", reliability=0.95)],
)  # fmt: skip


# ZDT1 with three variables: E. Zitzler, K. Deb, L. Thiele, Evol. Comput. 8 (2000) 173; front f2 = 1 - sqrt(f1).


@results
class Front:
    """Two numbers that should be small."""

    first: Float = found("")
    second: Float = found("")


def zdt1(three: Three) -> Front:
    """The test function."""
    away = 1 + 9 * (three.x2 + three.x3) / 2
    return Front(first=three.x1, second=away * (1 - np.sqrt(three.x1 / away)))


ZDT1: Model[Three, Front] = Model(
    name="zdt1", title="ZDT1", function=zdt1,
    objectives=[*(Vary(name, "0", "1") for name in ("x1", "x2", "x3")), Minimise("first"), Minimise("second")],
)  # fmt: skip


# Two tolerances of a chain with reciprocal costs: least cost at a given variance has a closed solution (Lagrange).


@inputs
class Pair:
    """Two lengths, and by which law their widths are paid."""

    one: Float = given(30.0, "mm")
    other: Float = given(20.0, "mm")
    law: Literal["reciprocal", "square"] = given("reciprocal")
    goal: Float = given(0.95, "")
    permitted: Float = given(12.0, "um")


@results
class Length:
    """What they make together."""

    length: Float = found("mm")


def together(pair: Pair) -> Length:
    """The sum."""
    return Length(length=pair.one + pair.other)


def by_law(first: float, second: float) -> tuple[Tolerance, Tolerance]:
    """The tolerances of the two lengths."""

    def law(amount: float):
        return by_choice(
            "law",
            reciprocal=Price(f"{amount} / width", width="um", unit="EUR"),
            square=Price(f"{amount} / width**2", width="um", unit="EUR"),
        )

    return (
        Tolerance("one", normal(band="24 um"), price=law(first)),
        Tolerance("other", zone("-12 um", "12 um"), price=law(second)),
    )


PAIR: Model[Pair, Length] = Model(
    name="pair", title="Two tolerances in a row", function=together, errors=[*by_law(1000.0, 300.0)],
    objectives=[
        Vary("permitted", "6 um", "20 um"), Minimise("tolerance_price"), Minimise("permitted"),
        Require("length", within="permitted", reliability="goal"),
    ],
    studies=[Optimise(tightest=0.25, widest=4.0, chance="first_order", population=60, generations=100, verify=10_000)],
)  # fmt: skip


# Whole numbers: a gear of teeth and module, and a grade.


@inputs
class Wheel:
    """A spur gear."""

    teeth: int = given(30)
    starts: Float = given(2.0, "", whole=True)
    module: Float = given(2.0, "mm")
    face: Float = given(20.0, "mm", note="follows the module")
    bore: Float = given(30.0, "mm")


@results
class Worth:
    """What it is worth."""

    weight: Float = found("mm^3")
    ratio: Float = found("")
    play: Float = found("mm")


def gear(one: Wheel) -> Worth:
    """Volume of the blank, ratio against a worm, and the play in the bore."""
    feasible(one.module * one.teeth > one.bore + 5e-3, "the bore is larger than the gear")
    return Worth(
        weight=(one.module * one.teeth) ** 2 * one.face, ratio=one.teeth / one.starts, play=one.bore - 29.98e-3
    )


GEAR: Model[Wheel, Worth] = Model(
    name="gear", title="A gear", function=gear,
    errors=[Tolerance("bore", grade("IT7"), price=Price("1 / width", width="mm", unit="EUR"))],
    objectives=[
        Vary("teeth", "12", "60"), Vary("starts", "1", "4"), Vary("module", "1 mm", "4 mm"),
        Vary("face", by="10 * module"),
        Minimise("weight"), Minimise("tolerance_price"), Require("ratio", at_least="20"),
        Require("play", at_most="25 um", reliability=0.99),
    ],
    studies=[Optimise(population=40, generations=40, draws=500, verify=2000)],
)  # fmt: skip


# Every kind of scatter at once, and limits of every kind: the arrays of a search against one design at a time.


@inputs
class Parts:
    """Sizes of which some may be chosen, and what scatters about them."""

    size: Float = given(50.0, "mm")
    other: Float = given(30.0, "mm")
    twin: Float = given(10.0, "mm")
    radius: Float = given(200.0, "mm")
    angle: Float = given(5.0, "deg")
    force: Float = given(3.0, "kN", above=0)
    strength: Float = given(5.0, "kN")
    clearance: Float = given(0.0, "um")
    deviation: Float = given(0.0, "mm")
    left: Float = given(1.0, "")
    right: Float = given(2.0, "")
    count: int = given(3)
    span: Float = given(0.05, "mm")


@results
class Sums:
    """Results of different curvature."""

    length: Float = found("mm")
    stress: Float = found("MPa")
    load: Float = found("kN")
    place: Float = axis("mm")
    course: Float = found("mm", along="place")


def parts(one: Parts) -> Sums:
    """Gentle curves in every input."""
    feasible(one.force < 50e3, "the force tears it")
    length = one.size + 0.5 * one.other - one.twin + one.clearance + one.deviation + 1e-3 * one.left * one.right
    bent = one.radius * np.sin(one.angle)
    place = np.array([0.0, 0.05, 0.1])
    return Sums(
        length=length + 0.01 * bent,
        stress=one.force / (one.size * one.other) * (1 + 0.1 * one.count),
        load=one.force * (1 + 0.02 * (one.left - 1)),
        place=place,
        course=column(length) * (1 + 3 * place) + column(one.deviation),
    )


def scattered(rng, rows):
    """Two numbers that scatter together, and not normally."""
    common = rng.exponential(0.02, rows)
    return {"left": common - 0.02, "right": -0.5 * common}


def longer(one: Parts, *, strain: Float, offset: Float) -> Parts:
    """Everything grows a little."""
    return replace(one, size=one.size * (1 + strain), deviation=one.deviation + offset)


EUR = {"width": "um", "unit": "EUR"}
PARTS: Model[Parts, Sums] = Model(
    name="parts", title="All kinds of scatter", function=parts,
    errors=[
        Tolerance("size", grade("IT8"), price=Price("300 / width", **EUR)),
        Tolerance("both", normal(sd="0.1 %"), on=["other", "twin"], price=Price("200 / width**0.5", **EUR)),
        Tolerance("angle", plus_minus("0.05 mm", at_radius="radius")),
        Tolerance("force", lognormal(sd="8 %")),
        Tolerance("strength", uniform("0.6 kN"), price=Price("900 / width", width="N", unit="EUR")),
        Tolerance("clearance", zone("0 um", "12 um", grows="up"), price=Price("50 / width", **EUR)),
        Tolerance("deviation", grade("IT6", size="size")),
        Tolerance("again", plus_minus("5 um"), on=["deviation"]),
        Tolerance("pair", drawn(scattered), on=["left", "right"]),
        Effect(
            "longer", on_inputs=longer, unknowns=[Unknown("strain", -1e-3, 1e-3, ""), Unknown("offset", -1, 1, "mm")]
        ),
    ],
    objectives=[
        Vary("size", "35 mm", "75 mm"), Vary("force", "2 kN", "4 kN"), Vary("count", "1", "5"),
        Vary("other", by="size * 0.6"), Vary("radius", by="other * 5 + 0.01"), Vary("span", "0.04 mm", "0.06 mm"),
        Minimise("stress"), Minimise("tolerance_price"), Maximise("load"),
        Require("stress", at_most="12 MPa"), Require("length", within="span"), Require("course", at_least="40 mm"),
        Require("length", within="span", reliability=0.9), Require("load", at_most="strength", reliability=0.95),
        Require("course", within="0.05 mm", reliability=0.5), Require("tolerance_price", at_most="300 EUR"),
    ],
)  # fmt: skip
GROWN = SwitchedOn(
    PARTS.effects["longer"], {"strain": 2e-4, "offset": 3e-6}, {"strain": 1e-4, "offset": 4e-6},
    ((1e-8, 2e-10), (2e-10, 1.6e-11)),
)  # fmt: skip


def grown(**values) -> Setup:
    """The parts, a little longer than they should be."""
    return replace(setup_of(PARTS, **values), effects=(GROWN,))


@hookimpl
def truing_models() -> list[Model]:
    """Offer all of them."""
    return [value for value in globals().values() if isinstance(value, Model)]
