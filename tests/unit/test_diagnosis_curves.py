"""Response curves: what every cause draws, at which points it is asked for, and what of it an explanation leaves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from diagnosis_models import (
    KN,
    SKEWED,
    TOLERANCES,
    UM,
    Array,
    Asked,
    Bench,
    Deflection,
    Drive,
    cause_of,
    drive_model,
    fit_of,
    gauge,
    offer_of,
    wide,
    write_csv,
)
from numpy.testing import assert_allclose

from truing import Effect, Float, Unknown
from truing.diagnosis.causes import Candidate, Parameter, effects_of, inputs_of
from truing.diagnosis.competition import Competition
from truing.diagnosis.conditional import Conditional, ConditionalGain, compared, conditional_on, independent
from truing.diagnosis.curves import FINEST, LEVELS, NEXT_TO, WAVES_PER_POINT, Bundle, first_places, placed
from truing.diagnosis.extended import Extended
from truing.diagnosis.machine import Calibration, calibration_of
from truing.diagnosis.reading import read_records
from truing.diagnosis.records import Records
from truing.diagnosis.sample import Sample
from truing.diagnosis.unregistered import highest_order, shapes_of
from truing.setup import DiagnoseOptions


def bump(screw: Drive, base: Deflection, *, height: Float, centre: Float) -> Deflection:
    """Stand out over 5 mm of the travel."""
    return replace(base, deflection=base.deflection + height * np.exp(-(((screw.travel - centre) / 5e-3) ** 2) / 2))


def rubbing(screw: Drive, base: Deflection, *, drag: Float) -> Deflection:
    """Act otherwise upward than downward."""
    return replace(base, deflection=base.deflection + np.maximum(drag, 0) * screw.travel + np.minimum(drag, 0) * 1e-3)


OWN = {
    "bump": Effect(
        "bump", on_results=bump, unknowns=[Unknown("height", -9, 9, "um"), Unknown("centre", 40, 300, "mm")]
    ),
    "rubbing": Effect("rubbing", on_results=rubbing, unknowns=[Unknown("drag", -2, 4, "um/mm")]),
}


def made_of(
    folder: Path,
    effects: Sequence[str] = (),
    *,
    bench: Bench,
    error: Array | float = 0.0,
    tolerances: Mapping[str, str] | None = None,
) -> Competition:
    """Lay out effects of the drive and the bump on a record with 1 um of noise, nothing searched."""
    model = drive_model([name for name in effects if name not in OWN], tolerances or {})
    errors = [*model.errors, *(OWN[name] for name in effects if name in OWN)]
    noise = np.random.default_rng(3).normal(0, 1, len(bench))
    asked = Asked(replace(model, errors=errors))
    return asked.competing(folder, bench.shown(error + noise))


def alone(made: Competition, name: str) -> Bundle:
    return made.curves.of(cause_of(made, name), made.null)


def looked(bundle: Bundle, beside: Conditional) -> ConditionalGain | None:
    return dict(compared([bundle], beside)).get(bundle.cause.tag)


# What a cause draws


def test_an_effect_with_a_kink_is_asked_for_on_both_sides_at_many_sizes(tmp_path: Path) -> None:
    bench = wide(60)
    found = alone(made_of(tmp_path, ["rubbing"], bench=bench), "rubbing")
    assert not found.is_straight
    (drag,) = found.points.T
    assert_allclose(np.sort(drag), np.sort([end * level for end in (-2e-3, 4e-3) for level in LEVELS]))
    exact = np.maximum(drag, 0)[:, None] * bench.travel * 1e-3 + np.minimum(drag, 0)[:, None] * 1e-3
    assert_allclose(found.curves[:, 0], exact, rtol=1e-9, atol=1e-15)


def test_a_curve_beside_an_effect_on_the_inputs_is_drawn_anew(tmp_path: Path) -> None:
    """A gain scales what the gauge shows: with a loss of stiffness that is the deflection under a larger load."""
    bench = wide(60)
    error = gauge(1.3 * bench.load, bench.travel) - gauge(bench.load, bench.travel)
    made = made_of(tmp_path, ["stiffness_loss", "lead_error"], bench=bench, error=error)
    gain, lead = cause_of(made, "sensor_gain"), cause_of(made, "lead_error")
    assert_allclose(made.curves.of(gain, made.null).curves[0, 0] / UM, gauge(bench.load, bench.travel), rtol=1e-9)
    loss = fit_of(made, "stiffness_loss")
    (found,) = loss.values[0]
    assert_allclose(found, 0.3, atol=0.02)
    beside = made.curves.of(gain, loss).curves[0, 0]
    assert_allclose(beside / UM, gauge((1 + found) * bench.load, bench.travel), rtol=1e-9)
    assert made.curves.of(gain, fit_of(made, "lead_error")) is made.curves.of(gain, made.null)
    assert made.curves.of(lead, loss) is not made.curves.of(lead, made.null)


# At which points


def cosines(curves: Sequence[Array]) -> Array:
    return np.array([a @ b / np.sqrt((a @ a) * (b @ b)) for a, b in pairwise(curves)])


def test_a_sweep_is_refined_where_neighbours_differ_too_much(tmp_path: Path) -> None:
    """Of two bumps d apart the cosine is exp(-d^2 / (4 w^2)): 0.7 at 6 mm, and nothing at the first nine's 32 mm."""
    bench = replace(wide(3000), travel=np.linspace(0, 300, 3000))
    found = alone(made_of(tmp_path, ["bump"], bench=bench), "bump")
    apart = np.diff(found.points[:, 1] * 1e3)
    widest = 2 * 5 * np.sqrt(-np.log(NEXT_TO))
    inner = apart[3:-3]  # a bump that is cut in two is narrower
    assert (inner > widest / 2 - 1e-9).all()
    assert (inner <= widest).all()
    exact = [np.exp(-(((bench.travel - centre * 1e3) / 5) ** 2) / 2) for centre in found.points[:, 1]]
    assert_allclose(found.curves[:, 0], exact, rtol=1e-9, atol=1e-12)
    assert cosines(exact).min() >= NEXT_TO
    assert len(found.points) <= FINEST


def test_a_frequency_is_swept_in_quarters_of_a_wave_over_the_record() -> None:
    frequency = Parameter("frequency", 0.1, 4.0, is_amplitude=False)  # 1 to 40 waves over ten seconds
    places = placed([frequency], first_places(frequency)[:, None]).ravel()
    assert_allclose(places[[0, -1]], [0.1, 4.0])
    waves = np.diff(places) * 10
    assert_allclose(waves, WAVES_PER_POINT, rtol=0.02)
    time = np.linspace(0, 10, 2000)
    curves = [np.exp(2j * np.pi * place * time) for place in places]
    alike = [abs(np.vdot(a, b)) / 2000 for a, b in pairwise(curves)]
    assert min(alike) > 0.89  # sin(pi / 4) / (pi / 4) is 0.90


# What of it an explanation leaves


def prior_rows(sample: Sample, weight: Array) -> Array:
    """Directions of the inputs in units of what is left, and rows for their prior, from the slopes alone."""
    slopes = sample.machine.slopes["deflection"] @ sample.directions / UM
    return np.concatenate([slopes * weight, np.eye(slopes.shape[1])])


@pytest.mark.parametrize("name", ["lead_error", "warm_up"])
def test_a_promise_is_what_least_squares_with_the_inputs_free_give(tmp_path: Path, name: str) -> None:
    """-N log(1 - drop / S), drop that of the weighted sum of squares S of rows and inputs by joint least squares."""
    bench = wide(90)
    error = {"lead_error": 0.02 * bench.travel, "warm_up": 8 * (1 - np.exp(-bench.time / 2.5))}[name]
    made = made_of(tmp_path, ["lead_error", "warm_up"], bench=bench, error=error, tolerances=TOLERANCES)
    beside = conditional_on(made.null, made.extended)
    found = looked(alone(made, name), beside)
    assert found is not None
    promised, values = found.starts[0]
    curve = bench.travel * KN * UM if name == "lead_error" else 1 - np.exp(-bench.time * 3600 / values[-1])
    weight = 1 / np.sqrt(np.mean(made.null.left**2))
    rows = prior_rows(made.sample, np.array(weight))
    target = np.concatenate([weight * (made.null.left + made.sample.drawn @ made.null.inputs), np.zeros(2)])
    both = np.column_stack([np.concatenate([weight * curve / UM, np.zeros(2)]), rows])
    drops = []
    for columns in (rows, both):
        solved = np.linalg.lstsq(columns, target)[0]
        drops.append(float(np.sum((target - columns @ solved) ** 2)))
    assert_allclose(promised, -90 * np.log(drops[1] / drops[0]), rtol=1e-4)
    assert_allclose(values[0], solved[0], rtol=1e-4)


def test_the_way_along_a_sweep_counts_its_curves() -> None:
    """A curve that turns by an angle a in fine steps makes 1 + a / 2 independent ones; one that stays makes one."""
    angles = np.linspace(0, 3, 2001)
    turning = np.column_stack([np.cos(angles), np.sin(angles)])[:, None]
    assert_allclose(independent(turning, is_sweep=True), 1 + 3 / 2, rtol=1e-6)
    assert_allclose(independent(np.repeat(turning[:1], 9, axis=0), is_sweep=True), 1)


def test_curves_over_several_numbers_count_by_the_spectrum_of_their_inner_products() -> None:
    rng = np.random.default_rng(6)
    basis = rng.normal(size=(40, 1, 12)) * np.geomspace(1, 0.05, 12)
    basis /= np.linalg.norm(basis, axis=-1, keepdims=True)
    values = np.linalg.svd(basis[:, 0], compute_uv=False) ** 2
    assert_allclose(independent(basis, is_sweep=False), values.sum() ** 2 / (values**2).sum(), rtol=1e-9)
    assert_allclose(independent(np.eye(7)[:, None], is_sweep=False), 7)
    assert independent(basis[:1], is_sweep=False) == 1


# Shapes that nobody registered: which there are, what they calculate, and what is said in their place.


def of_kind(found: Sequence[Candidate], kind: str, *on: str) -> list[Candidate]:
    """The shapes of one kind, over these covariates if any are named."""
    return [
        each for each in found if each.shape and each.shape.kind == kind and (not on or each.shape.depends_on == on)
    ]


@pytest.mark.parametrize(
    ("degrees", "highest"),
    [
        (np.arange(0.0, 360, 30), 5),
        (np.arange(0.0, 360, 36), 4),
        (np.arange(0.0, 720, 8), 22),
        (np.arange(-60.0, 61, 5), 35),
        (np.array([0.0, 180]), 0),
    ],
)
def test_orders_are_named_up_to_half_the_places_per_turn(degrees: Array, highest: int) -> None:
    """An order k looks like n - k where a turn has n places: sampled at 30 degrees, 7 looks like 5."""
    angle = np.radians(degrees)
    assert highest_order(angle) == highest
    if 0 < highest < 10:
        places = round(2 * np.pi / np.diff(angle)[0])
        assert_allclose(np.cos((places - highest) * angle), np.cos(highest * angle), atol=1e-9)


def test_orders_above_the_sampling_are_not_looked_for(tmp_path: Path) -> None:
    bench = replace(wide(96, turning=True), rotation=np.tile(np.arange(0.0, 360, 30), 8))
    ends = []
    for each in (bench, wide(96, turning=True)):
        there = calibration(asked(), tmp_path, each)
        (order,) = of_kind(shapes_of(there.records, {"rotation": (1, 2, 3)}, has_steps=True), "order")
        assert order.numbers[-1].whole
        ends.append((order.numbers[-1].low, order.numbers[-1].high))
    assert ends == [(4, 5), (4, 16)]


TURNING = wide(80, turning=True)


def test_every_shape_over_what_moved_and_nothing_over_what_stood_still(tmp_path: Path) -> None:
    bench = replace(TURNING, temperature=np.full(80, 23.0))
    found = shapes_of(calibration(asked(), tmp_path, bench).records, {}, has_steps=False)
    kinds = {(each.shape.kind, each.shape.depends_on) for each in found if each.shape}
    moved = {("load",), ("travel",), ("rotation",), ("time",)}
    assert {depends for kind, depends in kinds if kind == "trend"} == moved
    assert {depends for kind, depends in kinds if kind == "wave"} == moved - {("rotation",)}
    assert len([1 for kind, _ in kinds if kind == "product"]) == 6
    assert {("order", ("rotation",)), ("step", ("time",)), ("settling", ("time",))} <= kinds
    assert {depends for kind, depends in kinds if kind in {"jump", "kink", "dead zone"}} == {("load",)}
    assert not any("temperature" in depends for _, depends in kinds)
    assert len({each.tag for each in found}) == len(found)
    assert not of_kind(shapes_of(calibration(asked(), tmp_path, bench).records, {}, has_steps=True), "step")


def test_printed_terms_are_what_is_calculated(tmp_path: Path) -> None:
    there = calibration(asked(), tmp_path, TURNING)
    covariates = there.records.covariates
    values = {name: item.values for name, item in covariates.items()}
    for each in shapes_of(there.records, {}, has_steps=False):
        assert each.shape is not None
        for share in (0.1, 0.7):
            numbers = [each.numbers[place] for place in each.shapes]
            at = [round(one.low + share * (one.high - one.low)) if one.whole else one.low + share * (one.high - one.low)
                  for one in numbers]  # fmt: skip
            terms = each.shape.terms(at, covariates)
            assert len(terms) * len(each.shape.results) == len(each.amplitudes)
            for term in terms:
                assert_allclose(eval(term.expression, {"np": np, **values}) * np.ones(80), term.values, atol=1e-12)


LOAD, TIME, ROTATION = TURNING.load, TURNING.time, np.radians(TURNING.rotation)


@pytest.mark.parametrize(
    ("kind", "on", "shape", "columns"),
    [
        ("wave", "time", [3e-4], [np.sin(2 * np.pi * 1.08 * TIME), np.cos(2 * np.pi * 1.08 * TIME)]),
        ("order", "rotation", [4.0], [np.sin(4 * ROTATION), np.cos(4 * ROTATION)]),
        ("step", "time", [18_000.0], [TIME >= 5]),
        ("settling", "time", [7200.0], [np.ones(80), np.exp(-TIME / 2)]),
        ("jump", "load", [], [np.sign(LOAD)]),
        ("kink", "load", [], [np.abs(LOAD)]),
        ("dead zone", "load", [4e3], [np.sign(LOAD) * np.maximum(np.abs(LOAD) - 4, 0)]),
        ("trend", "load", [], [np.ones(80), LOAD, LOAD**2]),
        ("product", "load travel", [], [np.ones(80), LOAD, TURNING.travel, LOAD * TURNING.travel]),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_a_shape_draws_what_its_kind_says(
    tmp_path: Path, kind: str, on: str, shape: list[float], columns: list[Array]
) -> None:
    """The columns by hand, in kN, h and mm, span what the terms of the smallest shape of the kind do."""
    there = calibration(asked(), tmp_path, TURNING)
    smallest = min(
        of_kind(shapes_of(there.records, {}, has_steps=False), kind, *on.split()), key=lambda each: each.size
    )
    assert smallest.shape is not None
    terms = np.column_stack([term.values for term in smallest.shape.terms(shape, there.records.covariates)])
    by_hand = np.column_stack(columns).astype(float)
    assert terms.shape == by_hand.shape
    missed = by_hand - terms @ np.linalg.lstsq(terms, by_hand)[0]
    assert np.abs(missed).max() < 1e-9 * np.abs(by_hand).max()


# What competes in a diagnosis: effects and inputs with their numbers, and names for one curve.


def lead_again(screw: Drive, base: Deflection, *, pitch: Float) -> Deflection:
    """Follow the travel under another name."""
    return replace(base, deflection=base.deflection + pitch * screw.travel)


def eccentricity(screw: Drive, base: Deflection, *, sine: Float, cosine: Float) -> Deflection:
    """Go round with the screw, once per turn."""
    wave = sine * np.sin(screw.rotation) + cosine * np.cos(screw.rotation)
    return replace(base, deflection=base.deflection + wave)


MORE: Mapping[str, Effect[Drive, Deflection]] = {
    "skewed": SKEWED,
    "lead_again": Effect("lead_again", on_results=lead_again, unknowns=[Unknown("pitch", -1, 1, "um/mm")]),
    "eccentricity": Effect(
        "eccentricity",
        on_results=eccentricity,
        unknowns=[Unknown("sine", -50, 50, "um"), Unknown("cosine", -50, 50, "um")],
    ),
}


def asked(effects: Sequence[str] = (), more: Sequence[str] = (), tolerances: Mapping[str, str] | None = None) -> Asked:
    model = drive_model(effects, tolerances or {})
    return Asked(replace(model, errors=[*model.errors, *(MORE[name] for name in more)]))


def calibration(one: Asked, folder: Path, bench: Bench) -> Calibration:
    return calibration_of(one.setup, one.records(folder, bench.shown()))


def effect_of(there: Calibration, name: str) -> Candidate:
    (found,) = (cause for cause in effects_of(there) if cause.name == name)
    return found


def two_files(folder: Path, one: Asked) -> tuple[Records, Array]:
    benches = [wide(40, seed=1), wide(30, seed=2)]
    paths = [write_csv(folder / f"day {number}.csv", bench.shown()) for number, bench in enumerate(benches)]
    return read_records(paths, offer_of(one.model), one.setup), np.concatenate([bench.travel for bench in benches])


@pytest.mark.parametrize("per_file", [("lead_error",), ("lead_error.lead",)])
def test_an_unknown_of_every_file_is_a_number_for_each(tmp_path: Path, per_file: tuple[str, ...]) -> None:
    one = asked(["lead_error"])
    records, travel = two_files(tmp_path, one)
    setup = replace(one.setup, diagnose=DiagnoseOptions(per_file=per_file))
    there = calibration_of(setup, records)
    split = effect_of(there, "lead_error")
    assert [(number.name, number.file) for number in split.numbers] == [("lead", 0), ("lead", 1)]
    alone, both = Extended(there).at([split], [([np.array(at)], np.zeros(0)) for at in ([2e-3, 0], [2e-3, 3e-3])])
    off = [made["deflection"] - there.base["deflection"] for made in (alone, both)]
    assert_allclose(off[0], np.where(records.file_of == 0, 2e-3 * travel * 1e-3, 0), rtol=1e-9, atol=1e-18)
    assert_allclose(off[1], np.where(records.file_of == 0, 2e-3, 3e-3) * travel * 1e-3, rtol=1e-9)
    shared = effect_of(calibration_of(one.setup, records), "lead_error")
    assert [number.file for number in shared.numbers] == [-1]


def test_an_input_of_every_file_is_a_machine_for_each(tmp_path: Path) -> None:
    one = asked(tolerances={"contact": "3 %", "shaft": "3 %"})
    records, _ = two_files(tmp_path, one)
    setup = replace(one.setup, diagnose=DiagnoseOptions(per_file=("contact",)))
    there = calibration_of(setup, records)
    assert [(item.name, item.file) for item in there.inputs] == [("contact", 0), ("contact", 1), ("shaft", -1)]
    slopes = there.slopes["deflection"]
    assert not slopes[records.file_of == 1, 0].any()
    assert not slopes[records.file_of == 0, 1].any()
    causes = inputs_of(there)
    assert [(cause.name, cause.tolerated) for cause in causes] == [
        ("input:contact", 0), ("input:contact", 1), ("input:shaft", 2),
    ]  # fmt: skip
    assert len({cause.tag for cause in causes}) == 3
    (made,) = Extended(there).at([causes[1]], [([np.array([2.0])], np.zeros(3))])
    assert_allclose(made["deflection"] - there.base["deflection"], 2 * slopes[:, 1], rtol=1e-6, atol=1e-15)


def test_causes_are_the_models_first_then_the_kernels_with_their_numbers_in_si(tmp_path: Path) -> None:
    there = calibration(
        asked(["wear", "warm_up"], tolerances={"contact": "3 %", "zero": "5 um"}), tmp_path,
        replace(wide(60), load=np.zeros(60)),
    )  # fmt: skip
    found = effects_of(there)
    assert [cause.name for cause in found][:2] == ["wear", "warm_up"]
    assert [cause.is_kernel for cause in found] == [False, False, *[True] * (len(found) - 2)]
    assert len({cause.tag for cause in found}) == len(found)
    assert [cause.order for cause in found] == sorted(cause.order for cause in found)
    rise, constant = found[1].numbers
    assert_allclose([rise.low, rise.high, constant.low, constant.high], [-1e-3, 1e-3, 360, 72_000])
    assert (rise.is_amplitude, rise.is_free, rise.is_log) == (True, True, False)
    assert (constant.is_amplitude, constant.is_free, constant.is_log) == (False, True, True)
    assert [cause.name for cause in inputs_of(there)] == ["input:zero"]  # the contact moves nothing without a load


# Names of one curve


def named(one: Asked, folder: Path, bench: Bench, error: Array) -> list[set[str]]:
    """The causes that are named, each with what draws the same, of a record with 1 um of noise."""
    noise = np.random.default_rng(3).normal(0, 1, len(bench))
    found = one.diagnosed(folder, bench.shown(error + noise))
    return [{f"first: {cause.effect}", *cause.same_as} for cause in found.causes]


def test_of_two_of_the_model_the_first_declared_and_the_one_with_fewer_unknowns_goes_first(tmp_path: Path) -> None:
    bench = replace(wide(60), temperature=np.full(60, 20.0))  # what never changes costs no search
    error = 0.1 * bench.travel
    several = asked(["lead_error"], more=["skewed", "lead_again"])
    assert named(several, tmp_path, bench, error) == [{"first: lead_error", "lead_again", "skewed"}]
    fewer = asked(more=["skewed", "lead_again"])  # declared later, but with one unknown instead of two
    assert named(fewer, tmp_path, bench, error) == [{"first: lead_again", "skewed"}]


def test_curves_that_differ_only_by_what_is_tolerated_are_one(tmp_path: Path) -> None:
    bench = replace(wide(60), travel=np.zeros(60))
    warmer = replace(bench, temperature=27 + 2.5 * bench.time)  # growth is a drift and an offset
    error = 4 * (warmer.temperature - 20)
    apart = named(asked(["thermal_growth"]), tmp_path, warmer, error)
    assert apart == [{"first: thermal_drift", "thermal_growth"}]
    alike = named(asked(["thermal_growth"], tolerances={"zero": "1 m"}), tmp_path, warmer, error)
    assert alike == [{"first: sensor_drift", "thermal_growth", "thermal_drift"}]


@pytest.mark.parametrize(("order", "names"), [
    (1, {"first: eccentricity", "periodic_order_of_rotation"}), (2, {"first: periodic_order_of_rotation"}),
])  # fmt: skip
def test_the_first_order_of_a_gauge_goes_by_the_name_of_the_models_own(
    tmp_path: Path, order: int, names: set[str]
) -> None:
    """Two numbers and no order claim less than an order that could have been another; orders 2 and 3 stay apart."""
    bench = wide(90, turning=True)
    wave = 8 * np.sin(order * np.radians(bench.rotation) + 0.7)
    assert named(asked(more=["eccentricity"]), tmp_path, bench, wave) == [names]
