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
    plain_competition,
    wide,
)
from numpy.testing import assert_allclose

from truing import Effect, Float, Unknown
from truing.diagnosis.causes import Parameter
from truing.diagnosis.competition import Competition
from truing.diagnosis.conditional import KEPT, Conditional, ConditionalGain, compared, conditional_on, independent
from truing.diagnosis.curves import (
    FINEST,
    LEVELS,
    NEXT_TO,
    SPREAD,
    WAVES_PER_POINT,
    Bundle,
    first_places,
    placed,
    spread,
)
from truing.diagnosis.sample import Sample


def rubbing(screw: Drive, base: Deflection, *, drag: Float) -> Deflection:
    """Act otherwise upward than downward."""
    return replace(base, deflection=base.deflection + np.maximum(drag, 0) * screw.travel + np.minimum(drag, 0) * 1e-3)


def bowed(screw: Drive, base: Deflection, *, bow: Float) -> Deflection:
    """Bend with the amplitude, but smoothly."""
    return replace(base, deflection=base.deflection + bow * screw.travel + 30 * bow**2 * screw.travel)


def fading(screw: Drive, base: Deflection, *, start: Float, width: Float) -> Deflection:
    """Be largest at the beginning of the travel."""
    return replace(base, deflection=base.deflection + start * np.exp(-screw.travel / width))


def bump(screw: Drive, base: Deflection, *, height: Float, centre: Float) -> Deflection:
    """Stand out over 5 mm of the travel."""
    return replace(base, deflection=base.deflection + height * np.exp(-(((screw.travel - centre) / 5e-3) ** 2) / 2))


START = Unknown("start", -9, 9, "um")
MORE: Mapping[str, Effect[Drive, Deflection]] = {
    "rubbing": Effect("rubbing", on_results=rubbing, unknowns=[Unknown("drag", -2, 4, "um/mm")]),
    "bowed": Effect("bowed", on_results=bowed, unknowns=[Unknown("bow", -1, 1, "um/mm")]),
    "skewed": SKEWED,
    "fading": Effect("fading", on_results=fading, unknowns=[START, Unknown("width", 1, 300, "mm")]),
    "bump": Effect(
        "bump", on_results=bump, unknowns=[Unknown("height", -9, 9, "um"), Unknown("centre", 40, 300, "mm")]
    ),
}
TOLERANCES = {"contact": "3 %", "shaft": "3 %"}


def made_of(
    folder: Path,
    effects: Sequence[str] = (),
    *,
    bench: Bench,
    error: Array | float = 0.0,
    tolerances: Mapping[str, str] | None = None,
) -> Competition:
    """Lay out effects of the drive and of this file on a record with 1 um of noise, nothing searched."""
    model = drive_model([name for name in effects if name not in MORE], tolerances or {})
    errors = [*model.errors, *(MORE[name] for name in effects if name in MORE)]
    noise = np.random.default_rng(3).normal(0, 1, len(bench))
    asked = Asked(replace(model, errors=errors))
    records = asked.records(folder, bench.columns(gauge(bench.load, bench.travel) + error + noise))
    return plain_competition(asked, records, UM)


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


def test_an_effect_that_bends_is_asked_for_at_many_sizes(tmp_path: Path) -> None:
    bench = wide(60)
    found = alone(made_of(tmp_path, ["bowed"], bench=bench), "bowed")
    assert not found.is_straight
    bow = found.points
    assert_allclose(found.curves[:, 0], (bow + 30 * bow**2) * bench.travel * 1e-3, rtol=1e-9, atol=1e-15)


def test_an_effect_on_the_inputs_is_what_the_model_says_with_it(tmp_path: Path) -> None:
    bench = wide(60)
    found = alone(made_of(tmp_path, ["stiffness_loss"], bench=bench), "stiffness_loss")
    assert not found.is_straight
    exact = [gauge(bench.load * (1 + loss), bench.travel) for loss in found.points[:, 0]]
    assert_allclose(found.curves[:, 0] / UM, np.array(exact) - gauge(bench.load, bench.travel), rtol=1e-9, atol=1e-9)


def test_an_effect_in_proportion_is_one_curve_per_unit_of_its_amplitude(tmp_path: Path) -> None:
    bench = wide(60)
    found = alone(made_of(tmp_path, ["lead_error"], bench=bench), "lead_error")
    assert found.is_straight
    assert found.curves.shape == (1, 1, 60)
    assert_allclose(found.curves[0, 0], bench.travel * 1e-3, rtol=1e-9)


def test_an_input_is_its_slope_per_standard_deviation(tmp_path: Path) -> None:
    bench = wide(60)
    made = made_of(tmp_path, bench=bench, tolerances=TOLERANCES)
    found = alone(made, "input:contact")
    assert_allclose(found.curves[0, 0] / UM, 0.09 * np.sign(bench.load) * np.cbrt(bench.load) ** 2, rtol=1e-6)


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


def test_the_sweep_of_a_time_constant_leaves_no_gap_and_is_the_models(tmp_path: Path) -> None:
    bench = wide(200)
    found = alone(made_of(tmp_path, ["warm_up"], bench=bench), "warm_up")
    constants = found.points[:, 1] / 3600
    assert found.is_straight
    assert_allclose(constants, np.geomspace(0.1, 20, 9))  # neighbours are alike already
    exact = [1 - np.exp(-bench.time / constant) for constant in constants]
    assert_allclose(found.curves[:, 0], exact, rtol=1e-9, atol=1e-12)
    assert cosines(exact).min() > NEXT_TO


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


def test_points_over_several_numbers_lie_within_their_bounds_and_reach_all_sizes(tmp_path: Path) -> None:
    made = made_of(tmp_path, ["skewed", "fading"], bench=wide(40))
    for name in ("skewed", "fading"):
        cause = cause_of(made, name)
        points = spread(cause, 4 * SPREAD)
        for values, number in zip(points.T, cause.numbers, strict=True):
            assert number.low <= values.min() <= values.max() <= number.high
            if number.is_amplitude:
                sizes = np.abs(values) / number.high
                assert sizes.min() < 2e-3
                assert sizes.max() > 0.5
                assert (np.sign([values.min(), values.max()]) == [-1, 1]).all()


# What of it an explanation leaves


def prior_rows(sample: Sample, weight: Array) -> Array:
    """Directions of the inputs in units of what is left, and rows for their prior, from the slopes alone."""
    slopes = sample.machine.slopes["deflection"] @ sample.directions / UM
    return np.concatenate([slopes * weight, np.eye(slopes.shape[1])])


def test_what_is_left_is_least_squares_with_rows_for_the_prior_of_the_inputs(tmp_path: Path) -> None:
    """Null: r = measured minus nominal; u minimises |w (r - S u)|^2 + |u|^2 with w one over the rms of what is left."""
    bench = wide(80)
    error = gauge(bench.load, bench.travel, 3.2) - gauge(bench.load, bench.travel)
    made = made_of(tmp_path, bench=bench, error=error, tolerances=TOLERANCES)
    beside = conditional_on(made.null, made.extended)
    r = (made.sample.channels[0].values / UM) - gauge(bench.load, bench.travel)
    weight, rows = 1.0, np.zeros((0, 0))
    for _ in range(40):
        rows = prior_rows(made.sample, np.array(weight))
        target = np.concatenate([weight * r, np.zeros(2)])
        u = np.linalg.lstsq(rows, target)[0]
        left = target - rows @ u
        weight = weight / np.sqrt(np.mean(left[:80] ** 2))
    assert_allclose(beside.left, left, atol=2e-3)
    assert beside.sample.rows == 80
    curve = np.random.default_rng(5).normal(size=(1, 1, 80)) * UM
    weighed = beside.beyond(beside.drawn(curve))[0, 0]
    padded = np.concatenate([weight * curve[0, 0] / UM, np.zeros(2)])
    assert_allclose(weighed, padded - rows @ np.linalg.lstsq(rows, padded)[0], atol=1e-3)


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


def test_the_best_starts_come_first_and_draw_differently(tmp_path: Path) -> None:
    bench = replace(wide(600), travel=np.linspace(0, 300, 600))
    error = sum(size * np.exp(-(((bench.travel - at) / 5) ** 2) / 2) for at, size in ((60, 6), (150, 9), (230, 4)))
    made = made_of(tmp_path, ["bump"], bench=bench, error=np.asarray(error))
    found = looked(alone(made, "bump"), conditional_on(made.null, made.extended))
    assert found is not None
    centres = np.array([values[1] * 1e3 for _, values in found.starts])
    assert len(centres) == KEPT
    assert_allclose(centres[0], 150, atol=1)
    apart = np.abs(centres[:, None] - centres)[np.triu_indices(KEPT, 1)]
    assert (np.exp(-(apart**2) / (2 * 25)) < 0.98).all()  # squares of the cosines of bumps of 5 mm
    promised = [gain for gain, _ in found.starts]
    assert promised == sorted(promised, reverse=True)


def test_bounds_cut_what_is_promised(tmp_path: Path) -> None:
    """The gap is a clearance of one sign: a jump to the other side promises nothing."""
    bench = wide(90)
    gaps = []
    for size in (-5, 5):
        made = made_of(tmp_path, ["clearance"], bench=bench, error=size * np.sign(bench.load))
        found = looked(alone(made, "clearance"), conditional_on(made.null, made.extended))
        assert found is not None
        gaps.append([float(values[0]) / UM for _, values in found.starts])
    assert gaps[0] == []
    assert_allclose(gaps[1], [5], rtol=0.1)


def test_a_coefficient_that_nothing_excites_draws_nothing(tmp_path: Path) -> None:
    bench = wide(60)
    made = made_of(tmp_path, ["skewed"], bench=bench, error=0.1 * bench.travel)
    found = looked(alone(made, "skewed"), conditional_on(made.null, made.extended))
    assert found is not None
    assert_allclose(np.linalg.norm(found.span.vectors(0), axis=-1), [1, 0], atol=1e-12)
    along, across = found.starts[0][1]
    assert_allclose(along, 1e-4, rtol=0.02)
    assert across == 0
    still = made_of(tmp_path, ["lead_error"], bench=replace(bench, travel=np.zeros(60)))
    assert looked(alone(still, "lead_error"), conditional_on(still.null, still.extended)) is None


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
