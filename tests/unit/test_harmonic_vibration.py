"""The vibration of the mesh: closed forms, harmonic balance against fixed steps, and a gear pair of the literature."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import fsolve

from harmonic_fractal import vibration_response as response
from harmonic_fractal.vibration import RECORD, Running, Turned, loaded_at_rest, mesh_quantities
from harmonic_fractal.vibration_run import RunUp, run_up
from harmonic_fractal.vibration_sheet import RUN_UP, VIBRATION
from hidden_effects.vibration_in_steps import Machines, run
from truing import FrequencyAnswer
from truing.calculation import calculate
from truing.declare.batch import watching
from truing.evaluate import evaluate
from truing.setup import default_setup

Array = response.Array
RADIUS = 25.4e-3 * np.cos(np.radians(20.0))


def machines(rows: list[dict[str, float]]) -> response.Oscillators:
    """Machines by what is not as in the first row of the literature: clearance 1, mean 0.1, damping 0.05."""
    whole = [{"clearance": 1.0, "mean": 0.1, "force": 0.0, "error": 0.0, "damping": 0.05, "variation": 0.0} | row
             for row in rows]  # fmt: skip
    return response.Oscillators(**{name: np.array([row[name] for row in whole]) for name in whole[0]})


def amplitudes(runs: response.Run) -> Array:
    """Half the height of the deflection, (n, k)."""
    return np.asarray(np.ptp(response.motion_of(runs.harmonics), axis=-1) / 2)


def pair(**changes: Any) -> RunUp:
    return RUN_UP.inputs(**changes)


# The oscillator that the flanks make


def test_the_oscillator_is_that_of_figure_1() -> None:
    """Teeth and contacts in series, pair by pair: at most what their sums make in series, less where unlike."""
    both, held = mesh_quantities(pair(circular_inertia="1e-4 kg*m^2")), mesh_quantities(pair())
    assert held["effective_mass"] == pytest.approx(5e-5 / RADIUS**2, rel=1e-12)
    assert both["effective_mass"] == pytest.approx(1 / (RADIUS**2 / 5e-5 + RADIUS**2 / 1e-4), rel=1e-12)
    series = 1 / (1 / (60 * 2e7) + 1 / held["rough_stiffness"])
    assert 0.8 * series < held["mesh_stiffness"] < series
    soft, stiff = (mesh_quantities(pair(tooth_stiffness=f"{each} N/m")) for each in ("1e2", "1e17"))
    assert soft["mesh_stiffness"] == pytest.approx(60 * 1e2, rel=1e-4)
    assert stiff["mesh_stiffness"] == pytest.approx(stiff["rough_stiffness"], rel=1e-4)
    stated = mesh_quantities(pair(stated_stiffness="3.8e8 N/m", roughness_clearance="none", form_clearance="0.1 mm"))
    assert (stated["mesh_stiffness"], stated["clearance"]) == (3.8e8, pytest.approx(5e-5))


def test_small_oscillations_are_those_of_figure_1_linearised() -> None:
    """Poles, dynamic factor and natural frequency over torque by their closed forms, stiffness by the other model."""
    answer = calculate(default_setup(VIBRATION)).outcomes["frequency"]
    assert isinstance(answer, FrequencyAnswer)
    mesh = mesh_quantities(pair(torque="5 N*m"))
    natural, damping = np.sqrt(mesh["mesh_stiffness"] / mesh["effective_mass"]), 0.03
    pole = answer.poles[0]
    assert abs(pole) == pytest.approx(natural, rel=1e-6)
    assert -pole.real / abs(pole) == pytest.approx(damping, rel=1e-6)
    ratio = 2 * np.pi * answer.frequencies / natural
    expected = 1 / (1 - ratio**2 + 2j * damping * ratio) / RADIUS
    assert answer.response == pytest.approx(expected, rel=1e-5)
    assert answer.campbell is not None
    stiffness = [mesh_quantities(pair(torque=f"{each} N*m"))["mesh_stiffness"] for each in answer.campbell.axis[::20]]
    over_torque = np.sqrt(np.array(stiffness) / mesh["effective_mass"] * (1 - damping**2)) / (2 * np.pi)
    assert answer.campbell.frequencies[::20, 0] == pytest.approx(over_torque, rel=1e-6)


# A linear oscillator: frequency response, and how it gets there


def test_without_loss_of_contact_the_response_is_that_of_a_linear_oscillator() -> None:
    answer = evaluate(default_setup(RUN_UP, error_amplitude="0.005 um"))
    ratio, damping = np.asarray(answer.speed) / answer.resonance_speed, 0.03
    deflection = ratio**2 / (1 - ratio**2 + 2j * damping * ratio)
    np.testing.assert_allclose(answer.amplitude_up, 5e-9 * np.abs(1 + deflection), rtol=2e-3)  # by 128 samples
    np.testing.assert_array_equal(answer.impacts_up, 0)
    np.testing.assert_allclose(answer.multiplier_up, np.exp(-2 * np.pi * damping / ratio), rtol=1e-9)
    np.testing.assert_allclose(answer.amplitude_down, answer.amplitude_up, rtol=1e-12)
    harmonics = response.linear(machines([{"error": 0.01}]), np.array([0.9]))
    left, _, _ = response.residual(machines([{"error": 0.01}]), harmonics, np.array([0.9]))
    assert np.abs(left).max() < 1e-15


def test_the_record_is_the_forced_motion_of_a_linear_oscillator_from_rest() -> None:
    """Particular solution and what decays beside it, exp(-zeta omega t)."""
    answer = evaluate(default_setup(VIBRATION, error_amplitude="0.005 um", times=np.linspace(0, 4e-4, 81)))
    natural, damping, time = 2 * np.pi * answer.natural_frequency, 0.03, np.asarray(answer.time)
    drive = 2 * np.pi * 202 * 75.0
    forced = 5e-9 * drive**2 / (natural**2 - drive**2 + 2j * damping * natural * drive)
    damped = natural * np.sqrt(1 - damping**2)
    rest = -forced.real
    swing = (drive * forced.imag + damping * natural * rest) / damped  # x' is 0 at first
    own = np.exp(-damping * natural * time) * (rest * np.cos(damped * time) + swing * np.sin(damped * time))
    x = (forced * np.exp(1j * drive * time)).real + own
    mean = answer.clearance + answer.deflection
    np.testing.assert_allclose(np.asarray(answer.mesh_deflection) - mean, x, atol=2e-12)  # 1e-7 um a step


# A piecewise linear oscillator: free, and forced with one impact in a period


@pytest.mark.parametrize("height", [1.5, 3.0])
def test_a_free_swing_that_parts_takes_as_long_as_contact_and_flight(height: float) -> None:
    """In contact arccos(-d/A) of the natural phase to either side, then a throw against the mean force."""

    def pushed(running: Running) -> Turned:
        rest = loaded_at_rest(running)
        return replace(rest, error=rest.error + height * deflection)

    setup = default_setup(VIBRATION, error_amplitude="0 um", damping_ratio=1e-9, speed="0 rpm")
    mesh = mesh_quantities(setup.inputs)
    deflection, natural = float(mesh["deflection"]), 2 * np.pi * float(mesh["natural_frequency"])
    contact, flight = np.arccos(-1 / height), np.sqrt(height**2 - 1)
    period = 2 * (contact + flight) / natural
    times = np.array([0.0, contact / natural, period / 2, period])
    answer = replace(RECORD, start=pushed, tolerance=1e-10)(replace(setup.inputs, times=times))
    over = (np.asarray(answer.transmission_error) - mesh["clearance"]) / deflection
    np.testing.assert_allclose(over, [1 + height, 0, -(height**2 - 1) / 2, 1 + height], atol=1e-7 * height)
    assert answer.losses_of_contact == 1


def one_impact(ratio: float, damping: float, mean: float, error: float, guess: tuple[float, ...]) -> Array:
    """The periodic motion that parts once in a period, pieced together from both closed forms: lowest and highest.

    Unknown are the phases of parting and of meeting again, and the speeds there (Natsiavas 1989).
    """
    size, decay = ratio**2 * error, 2 * damping
    drive = size / (1 - ratio**2 + 1j * decay * ratio)
    flying = size / (-(ratio**2) + 1j * decay * ratio)

    def part(t: Any, begin: tuple[float, float, float], *, is_flight: bool) -> tuple[Any, Any]:
        t0, x0, v0 = begin
        forced = flying if is_flight else drive
        level = (lambda s: mean / decay * s) if is_flight else (lambda s: mean + 0 * s)
        slope = mean / decay if is_flight else 0.0
        wave, rate = (forced * np.exp(1j * ratio * t)).real, (1j * ratio * forced * np.exp(1j * ratio * t)).real
        a = x0 - (forced * np.exp(1j * ratio * t0)).real - level(0.0)
        b = v0 - (1j * ratio * forced * np.exp(1j * ratio * t0)).real - slope
        s = t - t0
        if is_flight:
            return wave + level(s) + a + b / decay * (1 - np.exp(-decay * s)), rate + slope + b * np.exp(-decay * s)
        w = np.sqrt(1 - damping**2)
        c = (b + damping * a) / w
        own = np.exp(-damping * s) * (a * np.cos(w * s) + c * np.sin(w * s))
        own_rate = np.exp(-damping * s) * (
            (c * w - damping * a) * np.cos(w * s) - (a * w + damping * c) * np.sin(w * s)
        )
        return wave + level(s) + own, rate + own_rate

    def off(unknown: Array) -> list[float]:
        t1, t2, v1 = unknown
        x2, v2 = part(t2, (t1, 0.0, v1), is_flight=True)
        x3, v3 = part(t1 + 2 * np.pi / ratio, (t2, 0.0, v2), is_flight=False)
        return [float(x2), float(x3), float(v3 - v1)]

    t1, t2, v1 = fsolve(off, guess, xtol=1e-13)
    assert np.abs(off(np.array([t1, t2, v1]))).max() < 1e-10
    _, v2 = part(t2, (t1, 0.0, v1), is_flight=True)
    low = part(np.linspace(t1, t2, 20001), (t1, 0.0, v1), is_flight=True)[0].min()
    high = part(np.linspace(t2, t1 + 2 * np.pi / ratio, 20001), (t2, 0.0, v2), is_flight=False)[0].max()
    return np.array([low, high])


@pytest.mark.parametrize(("ratio", "mean", "error"), [(0.9, 0.1, 0.05), (0.8, 0.1, 0.05), (1.1, 0.2, 0.1)])
def test_one_impact_in_a_period_is_what_the_closed_forms_make_of_it(ratio: float, mean: float, error: float) -> None:
    several = machines([{"mean": mean, "error": error}])
    curve = response.traced(several, np.array([0.4]), np.array([1.5]))
    down = response.run(several, curve, np.array([[ratio]]), down=True)
    x = response.motion_of(down.harmonics)[0, 0] - 1.0
    phase = 2 * np.pi * np.arange(len(x)) / len(x)
    parts = int(np.flatnonzero((x > 0) & (np.roll(x, -1) <= 0))[0])
    meets = int(np.flatnonzero((np.roll(x, -(parts + 1)) <= 0) & (np.roll(x, -(parts + 2)) > 0))[0]) + parts + 1
    speed = (x[(parts + 1) % len(x)] - x[parts]) / (phase[1] / ratio)
    guess = (phase[parts] / ratio, meets * phase[1] / ratio, speed)
    np.testing.assert_allclose([x.min(), x.max()], one_impact(ratio, 0.05, mean, error, guess), atol=5e-4 * np.ptp(x))


# Runs up and down, against fixed steps, and the literature

CASES: list[dict[str, float]] = [
    {"error": 0.05}, {"error": 0.1, "mean": 0.3}, {"force": 0.05},
    {"error": 0.16, "mean": 0.23, "clearance": 0.77, "damping": 0.03},
    {"error": 0.17, "mean": 0.2, "clearance": 0.4, "damping": 0.04},
]  # fmt: skip


@pytest.fixture(scope="module")
def compared() -> tuple[Array, Array, Array, Array]:
    """Amplitudes (k, 2n) of runs up and down by harmonic balance and by steps, and both jumps (2, n)."""
    several = machines(CASES)
    ratios = np.linspace(0.49, 1.25, 15)
    curve = response.traced(several, np.full(len(CASES), 0.4), np.full(len(CASES), 1.6))
    asked = np.tile(ratios, (len(CASES), 1))
    up, down = response.run(several, curve, asked), response.run(several, curve, asked, down=True)
    ours = [response.motion_of(runs.harmonics) for runs in (up, down)]
    wave = several.error[:, np.newaxis, np.newaxis] * np.cos(2 * np.pi * np.arange(response.SAMPLES) / response.SAMPLES)
    balance = np.concatenate([np.ptp(x + wave, axis=-1).T / 2 for x in ours], axis=1)
    plain = Machines(*(getattr(several, name) for name in ("clearance", "mean", "force", "error", "damping")))
    ways = np.tile(np.concatenate([ratios, ratios[::-1]])[:, np.newaxis], len(CASES))  # one run, up and down again
    steps = run(plain, ways, 32)
    steps = np.concatenate([steps[: len(ratios)], steps[: len(ratios) - 1 : -1]], axis=1)
    return balance, steps, np.array([up.jump, down.jump]), ratios


def test_runs_up_and_down_are_those_of_fixed_steps(compared: tuple[Array, Array, Array, Array]) -> None:
    """Every row of every run, on both sides of its jumps, but for the one beside a jump."""
    balance, steps, jumps, ratios = compared
    beside = np.abs(ratios[:, np.newaxis] - jumps.ravel()) < 0.02
    assert beside.mean() < 0.06
    np.testing.assert_allclose(np.where(beside, 1, balance / steps), 1, atol=4e-3)


def test_there_is_a_jump_each_way_and_hysteresis_between(compared: tuple[Array, Array, Array, Array]) -> None:
    balance, _, (up, down), _ = compared
    assert (up > down).all()
    assert (np.nanmax(np.abs(balance[:, : len(CASES)] - balance[:, len(CASES) :]), axis=0) > 0.1).all()


def by_one_term(ratio: float, damping: float, mean: float, error: float, height: float) -> float:
    """The amplitude by one harmonic with the describing functions of a clearance (Comparin and Singh 1989).

    ``height`` is where the search begins: there may be several.
    """

    def describing(unknown: Array) -> tuple[float, float]:
        middle, size = unknown
        ends = np.clip((np.array([1.0, -1.0]) - middle) / size, -1, 1)
        spans = 2 / np.pi * (ends * np.arcsin(ends) + np.sqrt(1 - ends**2))
        areas = 2 / np.pi * (np.arcsin(ends) + ends * np.sqrt(1 - ends**2))
        outside = np.abs((np.array([1.0, -1.0]) - middle) / size) - np.abs(ends)
        spans = spans + outside
        return middle + size / 2 * (spans[0] - spans[1]), 1 - (areas[0] - areas[1]) / 2

    def off(unknown: Array) -> list[float]:
        force, gain = describing(unknown)
        size = abs(complex(gain - ratio**2, 2 * damping * ratio)) * unknown[1]
        return [force - mean, size - ratio**2 * error]

    answer = fsolve(off, (1.0, height), xtol=1e-12)
    assert np.abs(off(answer)).max() < 1e-10
    return float(answer[1])


@pytest.mark.parametrize(
    ("ratio", "one_term", "ours"),
    [(1.0, 0.1839, 0.1870), (0.85, 0.2473, 0.2555), (0.75, 0.3067, 0.3184)],
)
def test_one_harmonic_alone_misses_some_per_cent(ratio: float, one_term: float, ours: float) -> None:
    """The gear pair of Kahraman and Singh (mean 0.1, damping 0.05, error 0.05): their method, ours, and fixed steps."""
    several = machines([{"error": 0.05}])
    curve = response.traced(several, np.array([0.4]), np.array([1.6]))
    found = amplitudes(response.run(several, curve, np.array([[ratio]]), down=True))[0, 0]
    plain = Machines(*(getattr(several, name) for name in ("clearance", "mean", "force", "error", "damping")))
    bare = replace(plain, force=ratio**2 * plain.error, error=0 * plain.error)  # the same force; y is x
    stepped = run(bare, np.array([[1.3], [1.15], [1.0], [0.9], [ratio]]), 30)[-1, 0]
    single = by_one_term(ratio, 0.05, 0.1, 0.05, found)
    assert (single, found) == (pytest.approx(one_term, abs=1e-4), pytest.approx(ours, abs=1e-4))
    assert abs(found - stepped) < 0.05 * abs(single - stepped)


@pytest.mark.parametrize("error", [0.05, 2.0])
def test_a_curve_is_as_long_as_is_said_before_it_is_followed(error: float) -> None:
    several, last = machines([{"error": error}]), np.array([1.6])
    first = 0.97 * response.still_in_contact(several)
    curve = response.traced(several, first, last)
    assert curve.is_whole.all()
    whole = np.concatenate([curve.harmonics[0], curve.ratio[0][:, np.newaxis]], axis=1)
    length = np.linalg.norm(np.diff(whole, axis=0), axis=1).sum()
    assert response.least_way(several, first, last)[0] < length


def test_a_curve_beyond_all_steps_is_not_set_out_on() -> None:
    """Beside one that is followed: a motion of thousands at the resonance, and a speed as many times as high."""
    several = machines([{}, {"error": 200.0}, {}])
    first, last = 0.97 * response.still_in_contact(several), np.array([1.6, 1.6, 2000.0])
    assert response.balanced(several, response.linear(several, first), first)[1].all()
    curve = response.traced(several, first, last)
    assert curve.is_whole.tolist() == [True, False, False]
    assert np.ptp(curve.ratio[1:], axis=1).tolist() == [0, 0]


def test_machines_that_are_all_plastic_fail_alone_in_a_batch() -> None:
    """The others have what they have without them; a batch of none but such machines has no answer and no error."""
    with watching(3) as failed, np.errstate(all="ignore"):
        some = run_up(pair(fractal_roughness=np.array([1e-11, 1e-6, 1e-11]), speeds=(3000.0, 4000.0)))
    with watching(2), np.errstate(all="ignore"):
        none = run_up(pair(fractal_roughness=np.array([1e-6, 1e-6]), speeds=(3000.0, 4000.0)))
    alone = run_up(pair(fractal_roughness=1e-11, speeds=(3000.0, 4000.0)))
    assert list(failed.reasons(3)) == [1]
    assert some.largest_amplitude[[0, 2]] == pytest.approx(float(alone.largest_amplitude), rel=1e-12)
    assert np.isnan([some.largest_amplitude[1], *none.largest_amplitude]).all()
    assert np.isnan(none.amplitude_up).all()
    assert none.amplitude_up.shape == (2, 2)
