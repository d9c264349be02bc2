"""Diagnoses made by hand, one of every kind of verdict, on a small machine: a slide that a crank pushes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.declare.fields import Float, found, given, inputs, results
from truing.declare.model import Model
from truing.declare.sources import Condition, Effect, Tolerance, Unknown
from truing.declare.spreads import normal
from truing.diagnosis.records import Covariate, Records, SuspectedUnit
from truing.diagnosis.result import (
    Alternative,
    Amount,
    Calibrated,
    Cause,
    Chance,
    Course,
    DiagnosisResult,
    Experiment,
    Fact,
    FittedUnknown,
    Gain,
    NextPoint,
    NoiseSummary,
    Remainder,
    ResidualFinding,
    ResultCurves,
    ShapeTerm,
    Tie,
    VisibleSize,
    Wrong,
)
from truing.kernel import Offer, Origin
from truing.measurements import RowCount, RowsFile
from truing.setup import Setup, SwitchedOn, default_setup

N = 160
UM = 1e-6


@inputs
class Crank:
    """What the slide is made of, and where its crank stands."""

    radius: Float = given(80.0, "mm", symbol="r", note="crank radius", above=0)
    rod: Float = given(320.0, "mm", symbol="l", note="length of the rod", above=0)
    crank_angle: Float = given(30.0, "deg", symbol="phi", note="crank angle from the dead centre")


@results
class Slide:
    """Where the slide stands and how it leans."""

    slide_position: Float = found("mm", symbol="s", note="distance of the slide from the crank")
    slide_tilt: Float = found("urad", symbol="psi", note="tilt of the slide")


def slide(crank: Crank) -> Slide:
    """Return place and tilt of the slide."""
    position = crank.radius * np.cos(crank.crank_angle) + crank.rod
    return Slide(slide_position=position, slide_tilt=1e-4 * np.sin(crank.crank_angle))


def heating(crank: Crank, *, expansion: Float, rod_temperature: Float) -> Crank:
    """Lengthen the rod."""
    return replace(crank, rod=crank.rod * (1 + expansion * (rod_temperature - TEMPERATURE.zero)))


def play(crank: Crank, base: Slide, *, clearance: Float, load: Float) -> Slide:
    """Lie on one side of the joints."""
    return replace(base, slide_position=base.slide_position - clearance * np.sign(load))


TEMPERATURE = Condition("rod_temperature", "degC", reference=20, note="mean of three thermocouples", low=15, high=60)
LOAD = Condition("load", "kN", note="pushes the slide back", low=-200, high=200)
SLIDE = Model(
    name="slide",
    title="A slide that a crank pushes",
    function=slide,
    errors=[
        Tolerance("lengths", normal(band="0.05 mm"), on=["radius", "rod"], why="drawing"),
        Effect(
            "rod_heating", on_inputs=heating, needs=[TEMPERATURE], why="the rod grows where the motor warms it",
            unknowns=[Unknown("expansion", -20, 20, "um/(m*K)")],
        ),
        Effect("joint_play", on_results=play, needs=[LOAD], unknowns=[Unknown("clearance", 0, 500, "um")]),
    ],
)  # fmt: skip
SLIDE_OFFER = Offer("slide", SLIDE, Origin("slide", "2.1", "slides", "slide.py", "entry:slide"))
UNITS = {"slide_position": "um", "slide_tilt": "urad"}


def records_of(**more: Any) -> Records:
    """Two files, three runs, 160 rows, one cell of the tilt missing."""
    rng = np.random.default_rng(4)
    angle = np.radians(np.tile(np.linspace(-170, 170, 40), 4))
    time = np.concatenate([np.linspace(0, 4, 80), np.linspace(0, 2, 40), np.linspace(0, 2, 40)]) * 3600
    temperature = 293.15 + 25 * (1 - np.exp(-time / 5000))
    load = np.where(np.arange(N) % 3 == 0, 0.0, 60e3)
    columns = {"crank_angle": angle, "rod_temperature": temperature, "load": load, "time": time}
    lines = tuple(range(2, 82)) + tuple(range(2, 82))
    cells: dict[str, tuple[str, ...]] = {"x": ("",) * N}
    rows = RowsFile("press_record.csv", columns, {}, cells, lines)
    position = SLIDE.function(SLIDE.inputs(crank_angle=angle)).slide_position
    expansion = 12e-6 * (temperature - 293.15) * 0.32
    made: dict[str, Any] = {
        "files": ("data/press_record.csv", "data/second day.csv"),
        "rows": rows,
        "file_of": np.repeat([0, 1], 80),
        "run_of": np.repeat([0, 1, 2], [80, 40, 40]),
        "lines": np.array(lines),
        "measured": {
            "slide_position": position + expansion + rng.normal(0, 6e-6, N),
            "slide_tilt": 1e-4 * np.sin(angle) + rng.normal(0, 2e-6, N),
        },
        "sigma": {},
        "covariates": {
            "crank_angle": Covariate("crank_angle", angle, "deg", "input", is_angle=True),
            "rod_temperature": Covariate("rod_temperature", temperature, "degC", "condition"),
            "load": Covariate("load", load, "kN", "condition"),
            "time": Covariate("time", time, "h", "time"),
            "hall": Covariate("hall", np.full(N, 3.0), "", "other"),
        },
        "held_out": np.zeros(N, dtype=bool),
        "counts": (
            RowCount("data/press_record.csv", 82).without("repeats an earlier row in every cell", (82, 83)),
            RowCount("data/second day.csv", 80),
        ),
        "notes": ("press_record.csv: 2 rows are the same as others and kept once", "hall never changes"),
    }
    return Records(**{**made, **more})


def curves_of(records: Records, share: float) -> tuple[ResultCurves, ...]:
    """The model before, and after the share of the expansion that was found."""
    covariates = records.covariates
    crank = SLIDE.inputs(crank_angle=covariates["crank_angle"].values)
    grown = 12e-6 * (covariates["rod_temperature"].values - 293.15) * 0.32
    before = SLIDE.function(crank)
    position: NDArray[np.float64] = np.asarray(before.slide_position)
    tilt: NDArray[np.float64] = np.asarray(before.slide_tilt)
    return (
        ResultCurves("slide_position", records.measured["slide_position"], position, position + share * grown),
        ResultCurves("slide_tilt", records.measured["slide_tilt"], tilt, tilt),
    )


def wrong_of(rmse: float, share: float, *findings: ResidualFinding) -> tuple[Wrong, ...]:
    """What is wrong with position (as told) and tilt (nothing)."""
    noise = NoiseSummary(
        Amount(6.0 * UM, "um"), 0.45, "heavy, t with 4 degrees of freedom", "constant", (("data/second day.csv", 17),)
    )
    quiet = NoiseSummary(Amount(2.0e-6, "urad"), 0.0, "normal", "constant")
    return (
        Wrong("slide_position", N, Amount(rmse, "um"), Amount(6.0 * UM, "um"), share, noise, findings),
        Wrong("slide_tilt", N - 1, Amount(2.02e-6, "urad"), Amount(2.0e-6, "urad"), 0.0, quiet, ()),
    )


def gain_of(before: float, after: float, p_value: float) -> tuple[Gain, ...]:
    """What the extension is worth."""
    floor = Amount(6.0 * UM, "um")
    share = (before**2 - after**2) / (before**2 - (6.0 * UM) ** 2) if before > 6.1 * UM else 0.0
    return (
        Gain("slide_position", Amount(before, "um"), Amount(after, "um"), floor, share, 1.42, p_value, 0.89),
        Gain(
            "slide_tilt", Amount(2.02e-6, "urad"), Amount(2.03e-6, "urad"), Amount(2.0e-6, "urad"),
            0.0, -0.01, 0.62, 0.91,
        ),
    )  # fmt: skip


SEEN = (
    VisibleSize("rod_heating", Amount(0.4e-6, "um/(m*K)"), "visible"),
    VisibleSize("joint_play", Amount(9e-6, "um"), "not excited", "load never changes its sign"),
    VisibleSize("sensor_offset", Amount(150e-6, "um"), "hidden in the tolerances", "visible from 0.15 mm"),
    VisibleSize("input:radius", Amount(130e-6, "mm"), "hidden in the tolerances"),
    VisibleSize("sensor_drift", Amount(1.1e-9, "um/h"), "visible"),
)
CALIBRATED = (Calibrated("radius", 0.080012, "mm", 0.6), Calibrated("rod", 0.319995, "mm", -0.2))
HEATING = Cause(
    "rod_heating",
    (FittedUnknown("expansion", 11.8e-6, 11.42e-6, 12.18e-6, "um/(m*K)"),),
    covariance=((3.7e-14,),),
)
TREND = ResidualFinding("trend", "rod_temperature", 0.0033, "rises with rod_temperature: 3.8 µm per K")
ORDER = ResidualFinding("order", "crank_angle", 0.0033, "order 7 of crank_angle, amplitude 14 µm")
DRIFTING = Alternative(("sensor_drift",), 2.1, 6.3, unknowns={"sensor_drift": (
    FittedUnknown("slope", 4.1e-9, 3.8e-9, None, "um/h"),
)})  # fmt: skip


TIE = Tie(
    ("rod_heating", "warm_up"),
    (
        Fact(
            "rod_heating",
            "rod_heating.expansion",
            Amount(11.8e-6, "um/(m*K)"),
            "of the rod",
            Amount(5.7e-6, "um/(m*K)"),
        ),
        Fact("warm_up", "warm_up.size", Amount(3.1e-6, "um"), "", Amount(1.2e-6, "um")),
    ),
)


def _diagnosis(**more: Any) -> DiagnosisResult:
    setup = default_setup(SLIDE, SLIDE_OFFER.origin)
    records = more.pop("records", None) or records_of()
    made: dict[str, Any] = {
        "setup": setup,
        "records": records,
        "measured": ("slide_position", "slide_tilt"),
        "units": UNITS,
        "wrong": wrong_of(6.1 * UM, 0.02),
        "causes": (),
        "alternatives": (),
        "remainder": None,
        "seen": SEEN,
        "not_measured": {"speed_swing": ("speed",)},
        "calibrated": (),
        "gain": gain_of(6.1 * UM, 6.1 * UM, 0.7),
        "stability": 1.0,
        "next": (),
        "curves": curves_of(records, 0.0),
        "p_any": 0.41,
    }
    return DiagnosisResult(**{**made, **more})


def extended(diagnosis: DiagnosisResult, effects: Mapping[str, Mapping[str, float]]) -> Setup:
    """The setup with effects on, calibrated, conditions as measured."""
    on = [
        SwitchedOn(SLIDE.effects[name], values, dict.fromkeys(values, 1.9e-7), ((3.7e-14,),))
        for name, values in effects.items()
    ]
    return replace(
        diagnosis.setup,
        effects=tuple(on),
        conditions={**diagnosis.setup.conditions, "rod_temperature": 305.2, "load": 4e4},
        calibrated={item.name: item.value for item in CALIBRATED},
    )


def none_found() -> DiagnosisResult:
    """Verdict none: noise, and nothing else."""
    records = records_of()
    warm, cold = curves_of(records, 1.0)[0], curves_of(records, 0.0)[0]
    position = records.measured["slide_position"] - (warm.after - cold.after)
    return _diagnosis(records=replace(records, measured={**records.measured, "slide_position": position}))


def named() -> DiagnosisResult:
    """Verdict named, unique: the rod grows."""
    ranking = (
        Alternative(("rod_heating",), 0.0, 0.0),
        Alternative(("rod_heating", "joint_play"), 8.4, 0.4),
        Alternative(("sensor_drift", "sensor_offset"), 31.0, 38.0),
        Alternative(("unknown",), 44.2, 51.0, depends_on=("time",)),
        Alternative((), 180.3, 210.0),
    )
    made = _diagnosis(
        wrong=wrong_of(41 * UM, 0.98, TREND), causes=(HEATING,), ranking=ranking,
        calibrated=CALIBRATED, gain=gain_of(41.2 * UM, 6.12 * UM, 0.001), p_any=0.0033, p_second=0.6,
        curves=curves_of(records_of(), 0.98),
    )  # fmt: skip
    return replace(made, extended=extended(made, {"rod_heating": {"expansion": 11.8e-6}}))


def warmed() -> Experiment:
    """Two readings of a warm rod, the load reversed between them."""
    courses = (
        Course("rod_temperature", "held", 323.15, 323.15), Course("load", "in turn", -5e4, 5e4),
        Course("crank_angle", "held", 0.5, 0.5),
    )  # fmt: skip
    return Experiment(
        tells=("rod_heating", "warm_up", "sensor_drift"),
        apart=(("rod_heating", "sensor_drift"), ("warm_up", "sensor_drift")),
        courses=courses,
        settings={course.name: course.values(2) for course in courses},
        units={"rod_temperature": "degC", "load": "kN", "crank_angle": "deg"},
        takes=Amount(5400.0, "h"),
        separation=34.0,
        needed=2,
        chance=Chance(0.96, 0.902, 0.984, 100, "all explanations fitted again"),
        results=("slide_position",),
    )


def ambiguous() -> DiagnosisResult:
    """Verdict one of three: another name of the same curve, a rival, a tie that a fact decides; and a unit slip."""
    point = NextPoint(
        {"rod_temperature": Amount(323.15, "degC"), "load": Amount(-5e4, "kN"), "crank_angle": Amount(0.5, "deg")},
        ("rod_heating", "sensor_drift"), "warm at once: heat follows the temperature, a drift follows the clock", 27.5,
    )  # fmt: skip
    unit_error = SuspectedUnit("load", 1000.0, "load lies between 0 and 0.06 kN: was it written in MN?")
    made = named()
    return replace(
        made, causes=(replace(HEATING, same_as=("warm_up",)),), alternatives=(DRIFTING,), ties=(TIE,),
        ranking=(made.ranking[0], DRIFTING, *made.ranking[1:]),
        next=(point, replace(point, settings={**point.settings, "load": Amount(5e4, "kN")}, separation=34.0)),
        experiment=warmed(),
        records=replace(made.records, unit_errors=(unit_error,)), stability=0.8,
        inseparable=("time and rod_temperature rise together in every run: their effects cannot be separated here",),
    )  # fmt: skip


def undecided() -> DiagnosisResult:
    """Verdict undecided: nothing is named, but a wave is left, and chance is no good word for the best explanation."""
    wave = ResidualFinding(
        "wave", "crank_angle", 0.0002, "12 waves over the range of crank_angle, with 31 % of what is left"
    )
    best = Alternative(("sensor_drift",), 0.0, 4.2)
    return replace(
        none_found(), p_any=0.06, wrong=wrong_of(6.1 * UM, 0.02, wave), ranking=(Alternative((), 0, 0), best)
    )


REMAINDER = Remainder(
    ("crank_angle",), "order 7 of crank_angle", ("slide_position",), 0.0033,
    {"slide_position": (ShapeTerm("np.cos(7 * crank_angle)", 14e-6), ShapeTerm("np.sin(7 * crank_angle)", -3e-6))},
)  # fmt: skip


def unknown() -> DiagnosisResult:
    """Verdict unknown: something of order 7 that nobody registered."""
    ranking = (
        Alternative(("unknown",), 0.0, 0.0, depends_on=("crank_angle",)),
        Alternative(("sensor_drift", "joint_play"), 62.0, 71.0),
        Alternative((), 95.0, 120.0),
    )
    return _diagnosis(
        wrong=wrong_of(12 * UM, 0.75, ORDER), remainder=REMAINDER, ranking=ranking,
        gain=gain_of(12.1 * UM, 6.3 * UM, 0.002), p_any=0.0033, calibrated=CALIBRATED,
    )  # fmt: skip


def named_with_remainder() -> DiagnosisResult:
    """Verdict named, with something unregistered beside it."""
    made = named()
    return replace(made, remainder=REMAINDER, wrong=wrong_of(42 * UM, 0.98, TREND, ORDER))


SAMPLES = {
    "none": none_found, "undecided": undecided, "named": named, "ambiguous": ambiguous, "unknown": unknown,
    "remainder": named_with_remainder,
}  # fmt: skip
