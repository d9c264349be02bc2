"""Small problems of choice with known answers, importable by worker processes."""

from typing import Literal

import numpy as np

from truing import (
    Float,
    Maximise,
    Minimise,
    Model,
    Optimise,
    Price,
    Require,
    Tolerance,
    Vary,
    by_choice,
    feasible,
    found,
    given,
    grade,
    hookimpl,
    inputs,
    normal,
    results,
    zone,
)
from truing.kernel import Origin
from truing.setup import Setup, default_setup


def setup_of(model, **values) -> Setup:
    return default_setup(model, Origin("optimise_models", "", "", __file__, "module:optimise_models"), **values)


# ZDT1 with five variables: E. Zitzler, K. Deb, L. Thiele, Evol. Comput. 8 (2000) 173; front f2 = 1 - sqrt(f1).


@inputs
class Five:
    """Five shares."""

    a: Float = given(0.5, "")
    b: Float = given(0.5, "")
    c: Float = given(0.5, "")
    d: Float = given(0.5, "")
    e: Float = given(0.5, "")


@results
class Two:
    """Two numbers that should be small."""

    first: Float = found("")
    second: Float = found("")


def zdt1(five: Five) -> Two:
    """The test function."""
    away = 1 + 9 * (five.b + five.c + five.d + five.e) / 4
    return Two(first=five.a, second=away * (1 - np.sqrt(five.a / away)))


ZDT1: Model[Five, Two] = Model(
    name="zdt1", title="ZDT1", function=zdt1,
    objectives=[*(Vary(name, "0", "1") for name in "abcde"), Minimise("first"), Minimise("second")],
    studies=[Optimise(population=60, generations=150)],
)  # fmt: skip


# Two tolerances of a chain with reciprocal costs: least cost at a given variance has a closed solution (Lagrange).


@inputs
class Pair:
    """Two lengths, and by which law their widths are paid."""

    one: Float = given(30.0, "mm")
    other: Float = given(20.0, "mm")
    law: Literal["reciprocal", "square"] = given("reciprocal")
    goal: Float = given(0.95, "")


@results
class Length:
    """What they make together."""

    length: Float = found("mm")


def together(pair: Pair) -> Length:
    """The sum."""
    return Length(length=pair.one + pair.other)


def priced(first: float, second: float) -> tuple[Tolerance, Tolerance]:
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
    name="pair", title="Two tolerances in a row", function=together, errors=[*priced(1000.0, 300.0)],
    objectives=[
        Vary("goal", "0.6", "0.999"), Minimise("tolerance_price"), Maximise("goal"),
        Require("length", within="12 um", reliability="goal"),
    ],
    studies=[Optimise(tightest=0.25, widest=4.0, chance="first_order", population=60, generations=120, verify=10_000)],
)  # fmt: skip


# Whole numbers: a gear of teeth and module, and a grade.


@inputs
class Gear:
    """A spur gear."""

    teeth: int = given(30)
    starts: Float = given(2.0, "", whole=True)
    module: Float = given(2.0, "mm")
    face: Float = given(20.0, "mm", note="follows the module")
    bore: Float = given(30.0, "mm")


@results
class Stage:
    """What it is worth."""

    weight: Float = found("mm^3")
    ratio: Float = found("")
    play: Float = found("mm")


def gear(one: Gear) -> Stage:
    """Volume of the blank, ratio against a worm, and the play in the bore."""
    feasible(one.module * one.teeth > one.bore + 5e-3, "the bore is larger than the gear")
    return Stage(
        weight=(one.module * one.teeth) ** 2 * one.face, ratio=one.teeth / one.starts, play=one.bore - 29.98e-3
    )


GEAR: Model[Gear, Stage] = Model(
    name="gear", title="A gear", function=gear,
    errors=[Tolerance("bore", grade("IT7"), price=Price("1 / width", width="mm", unit="EUR"))],
    objectives=[
        Vary("teeth", "12", "60"), Vary("starts", "1", "4"), Vary("module", "1 mm", "4 mm"), Vary("face", by="10 * module"),
        Minimise("weight"), Minimise("tolerance_price"), Require("ratio", at_least="20"),
        Require("play", at_most="25 um", reliability=0.99),
    ],
    studies=[Optimise(population=40, generations=40, draws=500, verify=2000)],
)  # fmt: skip


@hookimpl
def truing_models() -> list[Model]:
    """Offer all of them."""
    return [ZDT1, PAIR, GEAR]
