"""Small calculations with known answers, importable by worker processes."""

from dataclasses import replace

import numpy as np

from truing import (
    Condition,
    Effect,
    Float,
    Model,
    Price,
    Require,
    Tolerance,
    Unknown,
    axis,
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
    results,
    uniform,
    zone,
)  # fmt: skip
from truing.kernel import Origin
from truing.setup import Setup, default_setup


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


@hookimpl
def truing_models() -> list:
    return [CHAIN, UNIFORMS, STRENGTH, ISHIGAMI, ROOT, JOINT, WEAR, LOGNORMAL, SADDLE, STACK, PRICED]
