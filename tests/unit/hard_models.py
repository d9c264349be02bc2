"""A beam that gives way under a load, as a model that is hard to ask: slow, failing, rough.

What it does is known from the formulas that make the records, in kN, mm, degC and um.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from diagnosis_models import Array, Asked

from truing import Effect, Float, Model, Tolerance, Unknown, found, given, inputs, normal, results
from truing.diagnosis.result import DiagnosisResult
from truing.setup import DiagnoseOptions

ROWS, NOISE = 100, 5.0
UNITS = {"load": "kN", "place": "mm", "warmth": "degC", "bend": "um"}


@inputs
class Beam:
    """A beam under a load."""

    load: Float = given(0.0, "kN")
    place: Float = given(0.0, "mm")
    warmth: Float = given(20.0, "degC")
    stiffness: Float = given(10.0, "kN/mm")
    slant: Float = given(0.0, "um", note="what it leans over 300 mm")
    growth: Float = given(0.0, "um/K")
    play: Float = given(0.0, "um")
    ripple: Float = given(0.0, "um")


@results
class Bend:
    """How far it gives way."""

    bend: Float = found("um")


class Shop:
    """Where beams are calculated: how long a call takes by a clock of its own, and how rough what it says is."""

    def __init__(self, seconds: float = 0.0, rough: Callable[[Array], Array] = lambda bend: bend) -> None:
        self.seconds, self.rough = seconds, rough
        self.calls = self.time = 0.0

    def clock(self) -> float:
        """Return the time that its calls have taken."""
        return self.time

    def function(self, rows: int) -> Callable[[Beam], Bend]:
        """Return the model, which takes its time for every so many rows."""

        def beam(it: Beam) -> Bend:
            """Hooke's law."""
            self.calls += np.size(it.load) / rows
            self.time += self.seconds * np.size(it.load) / rows
            lean = it.slant * it.place / 0.3 + it.play * np.sign(it.load) + it.ripple
            bend = it.load / it.stiffness + lean + it.growth * (it.warmth - 293.15)
            return Bend(bend=self.rough(np.asarray(bend)))

        return beam


def leans(it: Beam, *, slant: Float) -> Beam:
    return replace(it, slant=it.slant + slant)


def grows(it: Beam, *, growth: Float) -> Beam:
    return replace(it, growth=it.growth + growth)


def plays(it: Beam, *, play: Float) -> Beam:
    return replace(it, play=it.play + play)


def softens(it: Beam, *, loss: Float) -> Beam:
    return replace(it, stiffness=it.stiffness * (1 - loss))


def hardens(it: Beam, *, gain: Float, knee: Float) -> Beam:
    return replace(it, stiffness=it.stiffness * (1 + gain * np.maximum(np.abs(it.load) / knee - 1, 0)))


EFFECTS = (
    Effect("leans", on_inputs=leans, unknowns=[Unknown("slant", -200, 200, "um")]),
    Effect("grows", on_inputs=grows, unknowns=[Unknown("growth", -10, 10, "um/K")]),
    Effect("plays", on_inputs=plays, unknowns=[Unknown("play", 0, 200, "um")]),
    Effect("softens", on_inputs=softens, unknowns=[Unknown("loss", -0.5, 0.5)]),
    Effect("hardens", on_inputs=hardens, unknowns=[Unknown("gain", 0, 5), Unknown("knee", 1, 20, "kN")]),
)  # fmt: skip


def asked(shop: Shop, effects: Sequence[Effect[Any, Any]] = EFFECTS, rows: int = ROWS, calls: int = 0) -> Asked:
    spreads = [Tolerance("stiffness", normal(sd="2 %"))]
    model = Model(name="beam", title="Beam", function=shop.function(rows), errors=[*spreads, *effects])
    return Asked(model, units=UNITS, diagnose=DiagnoseOptions(budget=calls))


def record(error: Callable[[Mapping[str, Array]], Any], rows: int = ROWS, seed: int = 0) -> dict[str, Array]:
    """Readings of a beam of 10 kN/mm with an error of its own, in um."""
    rng = np.random.default_rng(seed)
    made = {
        "load": rng.uniform(-20, 20, rows), "place": rng.uniform(0, 300, rows), "warmth": rng.uniform(15, 45, rows),
    }  # fmt: skip
    return {**made, "bend": made["load"] * 100 + error(made) + rng.normal(0, NOISE, rows)}


def leaning(at: Mapping[str, Array]) -> Array:
    return 40 * at["place"] / 300


def leaning_with_play(at: Mapping[str, Array]) -> Array:
    return leaning(at) + 30 * np.sign(at["load"])


def hardened(at: Mapping[str, Array]) -> Array:
    """From 8 kN on a beam that is stiffer by 0.8 for every 8 kN more."""
    return at["load"] * 100 * (1 / (1 + 0.8 * np.maximum(np.abs(at["load"]) / 8 - 1, 0)) - 1)


def of_causes(answer: DiagnosisResult) -> dict[str, float]:
    """The fitted unknowns of all causes, SI, by effect and name."""
    return {f"{cause.effect}.{each.name}": each.value for cause in answer.causes for each in cause.unknowns}
