"""At which voltage does an electrical insulation break down after some weeks at some temperature?"""

from dataclasses import replace

import numpy as np

from truing import (
    Effect,
    Float,
    Model,
    Section,
    Tolerance,
    Unknown,
    feasible,
    found,
    given,
    hookimpl,
    inputs,
    lognormal,
    results,
)

BOLTZMANN = 8.617333262e-5  # eV/K, CODATA 2018
WEEK = 7 * 86400.0  # s
HOT = 523.15  # K, 250 degC: the temperature at which the rate of ageing is stated


@inputs
class Insulation:
    """A sample in an oven; what ageing at one rate leaves out is neutral as declared."""

    age: Float = given(16.0, "week", symbol="t", note="time in the oven", above=0)
    temperature: Float = given(225.0, "degC", symbol="T", note="temperature of the oven", at_least=100, at_most=400)
    fresh: Float = given(14.0, "kV", symbol="V_0", note="strength of a fresh sample", above=0)
    rate: Float = given(0.01, "1/week", symbol="r", note="share of the strength that is lost in a week", above=0)
    activation: Float = given(0.0, "", symbol="E", note="activation energy of the ageing, in electronvolts")
    per_kelvin: Float = given(0.0, "1/K", symbol="m", note="growth of the rate with temperature, in logarithms")
    fading: Float = given(0.0, "", symbol="n", note="by how much the exponent of the age is below 1")
    softening: Float = given(0.0, "1/K", symbol="h", note="strength that heat takes away at once, in logarithms")
    sound: Float = given(0.0, "week", symbol="t_0", note="time until the ageing begins", at_least=0)


@results
class Strength:
    """What the sample stands."""

    log_strength: Float = found(
        "", symbol="L", note="natural logarithm of the strength in kV", numeric=True,
        formula="log(fresh) - 32 * rate * (max(age - sound, 0) / 32)**(1 - fading)"
        " * exp(activation / 8.617333262e-5 * (1 / 523.15 - 1 / (temperature + 273.15))"
        " + per_kelvin * (temperature - 250)) - softening * (temperature - 250)",
    )  # fmt: skip
    strength: Float = found("kV", symbol="V", note="voltage at which it breaks down", method="exp L")


def insulation_ageing(sample: Insulation) -> Strength:
    """A strength that falls by the same share every week, as hot as it may be. Shapes (n,) or numbers."""
    feasible(sample.fading < 1, "the exponent of the age must be above 0")
    hotter = sample.temperature - HOT
    speed = sample.activation / BOLTZMANN * (1 / HOT - 1 / sample.temperature) + sample.per_kelvin * hotter
    weeks = 32 * (np.maximum(sample.age - sample.sound, 0) / (32 * WEEK)) ** (1 - sample.fading)
    lost = sample.rate * WEEK * weeks * np.exp(speed) + sample.softening * hotter
    return Strength(log_strength=np.log(sample.fresh / 1e3) - lost, strength=sample.fresh * np.exp(-lost))


def arrhenius(sample: Insulation, *, energy: Float) -> Insulation:
    """Ageing is a chemical reaction: its rate grows with temperature after Arrhenius."""
    return replace(sample, activation=sample.activation + energy)


def rule_of_degrees(sample: Insulation, *, per_kelvin: Float) -> Insulation:
    """So many degrees halve the life (Montsinger): the rate is an exponential of the temperature."""
    return replace(sample, per_kelvin=sample.per_kelvin + per_kelvin)


def fading_rate(sample: Insulation, *, exponent: Float) -> Insulation:
    """What can react runs short, or has to diffuse: a power of the age below 1."""
    return replace(sample, fading=sample.fading + exponent)


def hot_test(sample: Insulation, *, per_kelvin: Float) -> Insulation:
    """A sample that is tested hot, or was once hot, stands less, whatever its age."""
    return replace(sample, softening=sample.softening + per_kelvin)


def incubation(sample: Insulation, *, delay: Float) -> Insulation:
    """An inhibitor must be used up before the ageing begins."""
    return replace(sample, sound=sample.sound + delay)


INSULATION_AGEING = Model(
    name="insulation_ageing",
    title="Ageing of an electrical insulation",
    function=insulation_ageing,
    cites=["W. Nelson, Analysis of performance-degradation data, IEEE Trans. Reliab. R-30 (1981) 149"],
    errors=[
        Tolerance("fresh", lognormal(sd="15 %"), why="from batch to batch"),
        Tolerance("rate", lognormal(sd="100 %"), why="nobody has aged this insulation before"),
        Effect(
            "arrhenius",
            on_inputs=arrhenius,
            looks_like="the strength falls only in the hot ovens, and there fast",
            unknowns=[Unknown("energy", 0, 3, "", note="in electronvolts; insulations 0.8 to 1.5")],
        ),
        Effect(
            "rule_of_degrees",
            on_inputs=rule_of_degrees,
            looks_like="as Arrhenius, with a rate that doubles every so many degrees",
            unknowns=[Unknown("per_kelvin", 0, 0.2, "1/K", note="0.07: ten degrees halve the life")],
        ),
        Effect(
            "fading_rate",
            on_inputs=fading_rate,
            looks_like="fast in the first weeks, slower and slower",
            unknowns=[Unknown("exponent", 0, 0.8)],
        ),
        Effect(
            "hot_test",
            on_inputs=hot_test,
            looks_like="a step between the ovens that is there from the first week",
            unknowns=[Unknown("per_kelvin", -0.02, 0.02, "1/K")],
        ),
        Effect(
            "incubation",
            on_inputs=incubation,
            looks_like="nothing at first, then a straight fall",
            unknowns=[Unknown("delay", 0, 30, "week")],
        ),
    ],
    sheet=[Section("Strength", "log_strength", "strength")],
)


@hookimpl
def truing_models() -> list[Model[Insulation, Strength]]:
    """Offer one calculation: insulation_ageing."""
    return [INSULATION_AGEING]
