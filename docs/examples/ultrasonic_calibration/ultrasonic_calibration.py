"""How loud is an ultrasonic echo behind so much metal? The metal takes the same share of it in every millimetre."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from truing import (
    Effect,
    Float,
    Model,
    Require,
    Section,
    Tolerance,
    Unknown,
    found,
    given,
    hookimpl,
    inputs,
    lognormal,
    results,
)


@inputs
class Path:
    """The way of the sound, and what a constant loss leaves out (neutral as declared)."""

    distance: Float = given(1.0, "mm", symbol="x", note="metal between transducer and receiver", above=0, at_most=20)
    first_response: Float = given(100.0, "", symbol="A", note="response without metal between", above=0)
    attenuation: Float = given(0.5, "1/mm", symbol="b", note="loss of amplitude in the metal", above=0)
    lowest_response: Float = given(3.0, "", symbol="r_p", note="smallest response that the receiver can use", above=0)
    divergence: Float = given(0.0, "1/mm", symbol="c", note="how fast the beam widens; 0: it stays as wide as it is")
    background: Float = given(0.0, "", symbol="r_0", note="response without any sound")
    second_share: Float = given(0.0, "", symbol="s", note="share that goes another way", at_most=1)
    second_attenuation: Float = given(0.1, "1/mm", symbol="b_2", note="loss on that way", above=0)
    hardening: Float = given(0.0, "", symbol="h", note="how much less every further millimetre takes", below=1)
    overload: Float = given(0.0, "", symbol="q", note="one over the largest response of the receiver")
    plate: Float = given(0.0, "mm", symbol="x_0", note="way that is not in the distance")


@results
class Echo:
    """What the receiver shows."""

    sound: Float = found("", symbol="u", note="amplitude of the sound", method="loss in the metal, and widening")
    response: Float = found(
        "", symbol="r", note="response of the receiver", formula="sound / (1 + overload * sound) + background"
    )


MILLIMETRE = 1e-3


def ultrasonic_calibration(path: Path) -> Echo:
    """Exponential loss over the distance; with nothing on it is ``A exp(-b x)``. Distances up to some 20 mm."""
    way = path.distance + path.plate
    hardened = way * np.maximum(way / MILLIMETRE, 1e-9) ** -path.hardening
    first = (1 - path.second_share) * np.exp(-path.attenuation * hardened)
    second = path.second_share * np.exp(-path.second_attenuation * way)
    sound = path.first_response * (first + second) / (1 + path.divergence * way)
    return Echo(sound=sound, response=sound / (1 + path.overload * sound) + path.background)


def beam_spreading(path: Path, *, divergence: Float) -> Path:
    """The beam widens with the distance, so that less and less of it meets the receiver."""
    return replace(path, divergence=path.divergence + divergence)


def background(path: Path, *, level: Float) -> Path:
    """The receiver shows something where there is no sound: noise, crosstalk, its zero."""
    return replace(path, background=path.background + level)


def second_path(path: Path, *, share: Float, attenuation: Float) -> Path:
    """A part goes another way, on which the metal takes less of it: along the surface, or as another wave."""
    other = np.where(np.equal(share, 0), path.second_attenuation, attenuation)
    return replace(path, second_share=path.second_share + share, second_attenuation=other)


def pulse_hardening(path: Path, *, hardening: Float) -> Path:
    """The high frequencies of the pulse are lost first, so that every further millimetre takes less."""
    return replace(path, hardening=path.hardening + hardening)


def receiver_overload(path: Path, *, overload: Float) -> Path:
    """The receiver is overloaded by a loud sound and shows too little of it."""
    return replace(path, overload=path.overload + overload)


def wear_plate(path: Path, *, thickness: Float) -> Path:
    """The sound passes a plate in front of the transducer, which is not in the distance."""
    return replace(path, plate=path.plate + thickness)


def effect(function: Callable[..., Path], *unknowns: Unknown, looks_like: str) -> Effect[Path, Echo]:
    """Declare an effect on the inputs under the name of its function."""
    why = str(function.__doc__).splitlines()[0].rstrip(".")
    return Effect(function.__name__, on_inputs=function, unknowns=list(unknowns), looks_like=looks_like, why=why)


ULTRASONIC_CALIBRATION = Model(
    name="ultrasonic_calibration",
    title="Ultrasonic response behind metal",
    function=ultrasonic_calibration,
    cites=["NIST Statistical Reference Datasets, nonlinear regression, Chwirut2; data: D. Chwirut, NIST, 1979"],
    errors=[
        Tolerance("first_response", lognormal(sd="300 %"), why="the gain of the receiver was not written down"),
        Tolerance("attenuation", lognormal(sd="300 %"), why="metal and frequency were not written down"),
        effect(
            beam_spreading,
            Unknown("divergence", 0, 50, "1/mm"),
            looks_like="falls faster near the transducer than far from it, and never quite stops falling faster",
        ),
        effect(background, Unknown("level", 0, 20), looks_like="the far rows stay above zero by the same amount"),
        effect(
            second_path,
            Unknown("share", 0, 1),
            Unknown("attenuation", 0.01, 0.4, "1/mm", note="less than in the metal"),
            looks_like="two slopes in a plot of the logarithm, one near and one far",
        ),
        effect(
            pulse_hardening, Unknown("hardening", 0, 0.9), looks_like="the logarithm is bent, most in the first rows"
        ),
        effect(receiver_overload, Unknown("overload", 0, 0.05), looks_like="the loudest rows are too low"),
        effect(wear_plate, Unknown("thickness", 0, 3, "mm"), looks_like="all rows are lower by the same share"),
    ],
    objectives=[Require("response", at_least="lowest_response")],
    sheet=[Section("Echo", "sound", "response")],
)


@hookimpl
def truing_models() -> list[Model[Path, Echo]]:
    """Offer one calculation: ultrasonic_calibration."""
    return [ULTRASONIC_CALIBRATION]
