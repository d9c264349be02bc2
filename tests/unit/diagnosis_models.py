"""A screw drive to be diagnosed: its model, the errors it may have, and records made by plain formulas.

The numbers of a record are made here without any code of the model or of its effects, in kN, mm, deg, degC, h and um.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing import Condition, Effect, Float, Model, Tolerance, Unknown, found, given, inputs, normal, results
from truing.diagnosis.causes import Candidate
from truing.diagnosis.choice import Chosen, Law, Rival, choose
from truing.diagnosis.competition import Competition, beside, search
from truing.diagnosis.curves import ResponseCurves
from truing.diagnosis.engine import diagnose, laid_out
from truing.diagnosis.exact import EXACTLY, nothing
from truing.diagnosis.fitted import Fit
from truing.diagnosis.intervals import numbers_of, value_of
from truing.diagnosis.learning import first_noise
from truing.diagnosis.machine import Calibration, calibration_of
from truing.diagnosis.reading import read_records
from truing.diagnosis.records import Records
from truing.diagnosis.result import DiagnosisResult, FittedUnknown
from truing.diagnosis.sample import NoiseModel, sample_of
from truing.experiments.proposal import proposed
from truing.kernel import Offer, Origin
from truing.setup import DiagnoseOptions, Setup, default_setup

Array = NDArray[np.float64]
KN, UM = 1e3, 1e-6
CONTACT, SHAFT, STROKE = 3.0, 0.5, 150.0
"""um at 1 kN, um/kN at a travel of STROKE, and mm."""

HEADER = {
    "load": "kN", "travel": "mm", "rotation": "deg", "temperature": "degC", "time": "h", "deflection": "um",
}  # fmt: skip


@inputs
class Drive:
    """A screw drive under load."""

    load: Float = given(0.0, "kN", symbol="F", note="axial load")
    travel: Float = given(0.0, "mm", symbol="s", note="place of the nut")
    rotation: Float = given(0.0, "deg", symbol="phi", note="angle of the screw")
    contact: Float = given(CONTACT, "um", symbol="c", note="approach of balls and track at 1 kN")
    shaft: Float = given(SHAFT, "um/kN", symbol="k", note="compliance of the shaft at the full stroke")
    zero: Float = given(0.0, "um", note="zero of the length gauge as set")


@results
class Deflection:
    """How far the nut gives way."""

    deflection: Float = found("um", symbol="g", note="axial deflection")


def drive(screw: Drive) -> Deflection:
    """Hertzian contact and a shaft in tension."""
    contact = screw.contact * np.sign(screw.load) * np.abs(screw.load / KN) ** (2 / 3)
    return Deflection(deflection=contact + screw.shaft * screw.load * screw.travel / (STROKE * 1e-3) + screw.zero)


def stiffness_loss(screw: Drive, *, loss: Float) -> Drive:
    """Give way as under a larger load."""
    return replace(screw, load=screw.load * (1 + loss))


def thermal_growth(screw: Drive, base: Deflection, *, growth: Float, temperature: Float) -> Deflection:
    """Follow the temperature."""
    return replace(base, deflection=base.deflection + growth * (temperature - TEMPERATURE.zero))


def warm_up(screw: Drive, base: Deflection, *, rise: Float, time_constant: Float, time: Float) -> Deflection:
    """Warm up once and stay warm."""
    return replace(base, deflection=base.deflection + rise * (1 - np.exp(-time / time_constant)))


def clearance(screw: Drive, base: Deflection, *, gap: Float) -> Deflection:
    """Lie on one flank or the other."""
    return replace(base, deflection=base.deflection + gap * np.sign(screw.load))


def wear(screw: Drive, base: Deflection, *, rate: Float, time: Float) -> Deflection:
    """Lose a little of both flanks in every hour."""
    return replace(base, deflection=base.deflection + rate * time * np.sign(screw.load))


def lead_error(screw: Drive, base: Deflection, *, lead: Float) -> Deflection:
    """Be off in proportion to the travel."""
    return replace(base, deflection=base.deflection + lead * screw.travel)


def skewed(screw: Drive, base: Deflection, *, along: Float, across: Float) -> Deflection:
    """Follow the travel, and something that never moves."""
    return replace(base, deflection=base.deflection + along * screw.travel + across * 0 * screw.travel)


TEMPERATURE = Condition("temperature", "degC", reference=20, low=10, high=60)
TIME = Condition("time", "h", derived="since_start")
EFFECTS: Mapping[str, Effect[Any, Any]] = {
    effect.name: effect
    for effect in (
        Effect("stiffness_loss", on_inputs=stiffness_loss, unknowns=[Unknown("loss", -0.5, 0.5)]),
        Effect(
            "thermal_growth", on_results=thermal_growth, needs=[TEMPERATURE],
            unknowns=[Unknown("growth", -100, 100, "um/K")],
        ),
        Effect(
            "warm_up", on_results=warm_up, needs=[TIME],
            unknowns=[Unknown("rise", -1000, 1000, "um"), Unknown("time_constant", 0.1, 20, "h")],
        ),
        Effect("clearance", on_results=clearance, unknowns=[Unknown("gap", 0, 500, "um")]),
        Effect("wear", on_results=wear, needs=[TIME], unknowns=[Unknown("rate", 0, 100, "um/h")]),
        Effect("lead_error", on_results=lead_error, unknowns=[Unknown("lead", -10, 10, "um/mm")]),
    )
}  # fmt: skip
ALL_EFFECTS = tuple(EFFECTS)
SKEWED = Effect(
    "skewed", on_results=skewed, unknowns=[Unknown("along", -1, 1, "um/mm"), Unknown("across", -1, 1, "um/mm")]
)
"""An effect that the drive does not declare: one of its unknowns no record can tell."""


TOLERANCES = {"contact": "3 %", "shaft": "3 %"}


def drive_model(effects: Sequence[str] = ALL_EFFECTS, tolerances: Mapping[str, str] = TOLERANCES) -> Model[Any, Any]:
    """The screw drive with some of its effects; ``tolerances`` holds standard deviations by input."""
    spreads = [Tolerance(name, normal(sd=sd), why="drawing") for name, sd in tolerances.items()]
    errors: list[Any] = [*spreads, *(EFFECTS[name] for name in effects)]
    return Model(name="drive", title="Deflection of a screw drive", function=drive, errors=errors)


def offer_of(model: Model[Any, Any]) -> Offer:
    """A model as if it had been installed."""
    return Offer(model.name, model, Origin(model.name, "1.0", "drives", "drive.py", "entry:drive"))


def gauge(load: Array, travel: Array, contact: float = CONTACT, shaft: float = SHAFT) -> Array:
    """The deflection of a drive in um, from kN and mm, by the formula of the textbook."""
    cube = np.cbrt(load)
    return np.asarray(contact * np.sign(load) * cube**2 + shaft * load * travel / STROKE)


@dataclass(frozen=True)
class Bench:
    """Settings of a record, one value per row: kN, mm, deg, degC, h."""

    load: Array
    travel: Array
    rotation: Array
    temperature: Array
    time: Array

    def __len__(self) -> int:
        return len(self.time)

    def columns(self, deflection: Array) -> dict[str, Array]:
        """The columns of a file of measurements."""
        return {**vars(self), "deflection": deflection}

    def shown(self, error: Array | float = 0.0, **machine: float) -> dict[str, Array]:
        """The columns where the gauge is off by this much, um; ``machine`` holds what is not as drawn."""
        return self.columns(gauge(self.load, self.travel, **machine) + error)

    def drawn(self, error: Array | float = 0.0) -> dict[str, Array]:
        """What the drawing knows alone, load and travel, and the gauge, um: few columns, so that a search is short."""
        return {name: column for name, column in self.shown(error).items() if name in {"load", "travel", "deflection"}}

    @property
    def contact(self) -> Array:
        """What the deflection of the contact is in proportion to."""
        return np.asarray(np.sign(self.load) * np.cbrt(self.load) ** 2)


def wide(n: int = 150, *, seed: int = 0, hours: float = 10.0, turning: bool = False) -> Bench:
    """Everything varied independently of everything else; the screw turns where that is asked for: it costs time."""
    rng = np.random.default_rng([seed, n])
    return Bench(
        load=rng.uniform(-20, 20, n),
        travel=rng.uniform(0, 300, n),
        rotation=rng.uniform(0, 360, n) * turning,
        temperature=rng.uniform(15, 45, n),
        time=np.linspace(0, hours, n),
    )


def warming(n: int = 150, *, seed: int = 0, hours: float = 10.0, turning: bool = False) -> Bench:
    """The temperature follows the time: 25 K with three hours."""
    bench = wide(n, seed=seed, hours=hours, turning=turning)
    return replace(bench, temperature=20 + 25 * (1 - np.exp(-bench.time / 3)))


def wander(rng: np.random.Generator, n: int, rho: float) -> Array:
    """Noise of unit variance that carries ``rho`` over from row to row, from the recursion itself."""
    noise = np.empty(n)
    noise[0] = rng.normal()
    for row in range(1, n):
        noise[row] = rho * noise[row - 1] + np.sqrt(1 - rho**2) * rng.normal()
    return noise


def write_csv(
    path: Path, columns: Mapping[str, Array], units: Mapping[str, str] = HEADER, runs: Sequence[str] = ()
) -> Path:
    """Write columns as a file of measurements, every digit kept."""
    header = [*(["run"] if runs else []), *(f"{name} [{units[name]}]" for name in columns)]
    cells = [[repr(float(cell)) for cell in column] for column in columns.values()]
    lines = [",".join(row) for row in zip(*([list(runs)] if runs else []), *cells, strict=True)]
    path.write_text("\n".join([",".join(header), *lines]) + "\n", encoding="utf-8")
    return path


@dataclass(frozen=True)
class Asked:
    """A model and how it is asked."""

    model: Model[Any, Any]
    seed: int = 0
    units: Mapping[str, str] = field(default_factory=lambda: HEADER)
    diagnose: DiagnoseOptions = field(default_factory=DiagnoseOptions)

    @property
    def setup(self) -> Setup:
        """The setup at the defaults of the model."""
        return replace(default_setup(self.model), seed=self.seed, diagnose=self.diagnose)

    def records(self, path: Path, columns: Mapping[str, Array], runs: Sequence[str] = ()) -> Records:
        """Write the columns to a file in a folder and read it as records."""
        file = write_csv(path / "measured.csv", columns, self.units, runs)
        return read_records([file], offer_of(self.model), self.setup)

    def competing(
        self, path: Path, columns: Mapping[str, Array], runs: Sequence[str] = (), *, scale: float = UM
    ) -> Competition:
        """Write, read, and lay out what competes in white noise of a known standard deviation (SI)."""
        return plain_competition(self, self.records(path, columns, runs), scale)

    def diagnosed(self, path: Path, columns: Mapping[str, Array], runs: Sequence[str] = ()) -> DiagnosisResult:
        """Write, read and diagnose."""
        return diagnose(self.setup, self.records(path, columns, runs), propose=proposed)


def names_in(found: DiagnosisResult) -> set[str]:
    """Every name the verdict does not exclude: causes, what is the same curve, and the alternatives."""
    names = {name for cause in found.causes for name in (cause.effect, *cause.same_as)}
    return names | {name for rival in found.alternatives for name in rival.causes}


def name_sets(found: DiagnosisResult) -> list[set[str]]:
    """The verdict: for each cause its name and those of the same curve."""
    return [{cause.effect, *cause.same_as} for cause in found.causes]


def ends(unknown: FittedUnknown) -> tuple[float, float]:
    """The ends of an interval that has both."""
    assert unknown.low is not None
    assert unknown.high is not None
    return unknown.low, unknown.high


def assert_sized(unknown: FittedUnknown, size: float, *, within: float) -> None:
    """A size (SI) lies within three standard errors of what was fitted; these are known to a share of it."""
    low, high = ends(unknown)
    half = (high - low) / 2
    assert abs(unknown.value - size) < 1.5 * half
    assert half < within * abs(size)


def decided(setup: Setup, records: Records) -> Chosen:
    """Search and choose, without the report: what a diagnosis does before it judges."""
    made = laid_out(calibration_of(setup, records))
    search(made)
    return choose(made, seed=setup.seed)


def white_noise(machine: Calibration, scale: float) -> dict[str, NoiseModel]:
    """White, normal noise of a known standard deviation (SI), for every result."""
    return {name: replace(own, scale=scale) for name, own in first_noise(machine).items()}


def plain_competition(asked: Asked, records: Records, scale: float) -> Competition:
    """Lay out what competes, in white noise of a known standard deviation (SI): nothing searched, learnt or clipped."""
    begun = laid_out(calibration_of(asked.setup, records))
    machine = begun.extended.machine
    sample = sample_of(machine, white_noise(machine, scale), ~records.held_out)
    made = Competition(begun.extended, begun.causes, sample, ResponseCurves(begun.extended))
    made.keep(nothing(sample, begun.extended))
    return made


def cause_of(made: Competition, name: str) -> Candidate:
    """The only cause of a name that somebody declared."""
    (found,) = (cause for cause in made.causes if cause.name == name and cause.is_registered)
    return found


def fit_of(made: Competition, *names: str) -> Fit:
    """An explanation by causes of these names, fitted exactly: one after another from where their curves say."""
    found: Fit | None = made.null
    for name in names:
        assert found is not None
        cause = cause_of(made, name)
        *_, found = made.fit_each(beside(found, cause, made.look(found, [cause])[cause.tag].starts))
    assert found is not None
    made.again([found], EXACTLY)
    return made.known[found.key]


def size_of(found: Fit, name: str) -> float:
    """One fitted number by its name, SI."""
    (place,) = (place for place, number in enumerate(numbers_of(found)) if number.name == name)
    return value_of(found, place)


def chosen_as(made: Competition, best: Fit, *rivals: Fit, same: Mapping[str, tuple[str, ...]] | None = None) -> Chosen:
    """An explanation as if it had been chosen, with rivals as near as itself; ``same`` names what draws its curves."""
    near = tuple(Rival(each, 0.0) for each in rivals)
    return Chosen(made, best, near, same or {}, Law(np.zeros(0), 1.0), None)


def of_size_one(rng: np.random.Generator, n: int) -> Array:
    """Noise whose mean square is 1 to the last digit."""
    noise = rng.normal(size=n)
    return np.asarray(noise / np.sqrt(np.mean(noise**2)))
