"""The generator of hidden effects is right in itself: its geometry, its noise, what it says is visible."""

from math import radians

import numpy as np
import pytest

from hidden_effects.candidates import columns, registered, tolerance_columns
from hidden_effects.cases import Case
from hidden_effects.designs import DESIGNS, Design, Noise, covariance, measured
from hidden_effects.making import SCHEDULE, Wish, make_case
from hidden_effects.press_machine import BOTTOM, POSITION, SCATTER, TILT, Array, Rows, built, shown, slider
from hidden_effects.record import Lens, rivals
from hidden_effects.rigs import KINDS, Kind, held_out, noise_of
from published import press_by_hand as by_hand

BOTH = (POSITION, TILT)
ANGLES = (-150.0, -90.0, -35.0, 0.0, 20.0, 75.0, 160.0)


def rows_at(**given: Array | float) -> Rows:
    """Rows of a press that is cold, idle and new, but for what is given."""
    count = max(np.size(value) for value in given.values())
    cold = {"crank_angle": 0.0, "forming_force": 0.0, "link_temperature": 20.0, "time": 0.0, "strokes": 0.0,
            "speed": 0.5, "direction": 1.0}  # fmt: skip
    return Rows(**{name: np.broadcast_to(value, count).astype(float) for name, value in (cold | given).items()})


@pytest.mark.parametrize("degrees", ANGLES)
def test_the_geometry_is_that_of_the_loops(degrees: float) -> None:
    """Twelve simultaneous loop equations, solved by iteration, with every source far off."""
    off = {name: 1e-3 * size for name, size in zip(by_hand.SOURCES, np.sin(np.arange(1.0, 30.0)).tolist(), strict=True)}
    found = slider(np.array([radians(degrees)]), built(off))
    position, tilt = by_hand.slider(by_hand.closed(by_hand.PAPER, radians(degrees), off), by_hand.PAPER)
    assert found[POSITION][0] == pytest.approx(position, abs=2e-14)
    assert found[TILT][0] == pytest.approx(tilt, abs=2e-14)


def test_the_crank_is_at_its_dead_centre() -> None:
    assert pytest.approx(by_hand.dead_centre(by_hand.PAPER), abs=1e-8) == BOTTOM


# What the effects come to at the dead centre, from the closed forms of the paper's sensitivities: link heating
# 46.2 um/K of the knee and 3.7 um/K of the driven chain at 11.5e-6/K, one side alone 14.4 urad/K; knee 3.953 m / (EA)
# of elastic line and the rods besides; clearance 2 * (2.807 + 0.149) of it, one way.
AT_DEAD_CENTRE = [
    ("link_heating", {"expansion": 11.5e-6}, {"link_temperature": 21.0}, POSITION, 49.9e-6, 0.1e-6),
    ("side_heating", {"expansion_1": 11.5e-6}, {"link_temperature": 21.0}, TILT, 14.4e-6, 0.05e-6),
    (
        "elastic_deflection", {"compliance": 1e-9}, {"forming_force": 1e4}, POSITION,
        -1e-5 / 2 * (3.953 + 0.14931**2 * 1.304), 0.02e-6,
    ),
    ("joint_clearance", {"clearance": 20e-6}, {"forming_force": 0.0}, POSITION, -2 * 20e-6 * 2.95613, 0.02e-6),
    ("joint_clearance", {"clearance": 20e-6}, {"forming_force": -1.0}, POSITION, 2 * 20e-6 * 2.95613, 0.02e-6),
    (
        "joint_wear", {"wear": 40e-6}, {"strokes": 5e5, "forming_force": 1.0}, POSITION,
        -2 * 20e-6 * 2.95613, 0.02e-6,
    ),
    ("crank_phase", {"phase": 10e-3}, {}, POSITION, -0.0686 / 2 * 1e-4, 0.01e-6),
    ("slider_inertia", {"mass_compliance": 1e-6}, {"speed": 1.0}, POSITION,
     1e-6 * 0.0686 * 39.478 / 2 * (3.953 + 0.14931**2 * 1.304), 0.01e-6),
    ("die_inclination", {"inclination": 1e-4}, {}, TILT, 1e-4, 1e-12),
    ("sensor_gain", {POSITION: 1e-5}, {}, POSITION, 3.55760e-5, 1e-9),
    ("thermal_drift", {TILT: 2e-6}, {"link_temperature": 25.0}, TILT, 1e-5, 1e-12),
]  # fmt: skip


@pytest.mark.parametrize(("effect", "unknowns", "given", "result", "expected", "within"), AT_DEAD_CENTRE)
def test_effects_at_the_dead_centre(
    effect: str, unknowns: dict[str, float], given: dict[str, float], result: str, expected: float, within: float
) -> None:
    rows = rows_at(crank_angle=0.0, **given)
    change = shown(rows, {}, {effect: unknowns})[result] - shown(rows, {}, {})[result]
    assert change[0] == pytest.approx(expected, abs=within)


def test_backlash_holds_the_slider_back_on_both_ways() -> None:
    """Down, the slider lags and stands higher; up, it lags and stands lower, on both sides of the dead centre."""
    angles = np.radians([-40.0, -40.0, 40.0, 40.0, 220.0, 220.0])
    rows = rows_at(crank_angle=angles, direction=np.array([1.0, -1.0] * 3))
    play = {"drive_backlash": {"play_before": 1e-3, "play_after": 2e-3}}
    change = (shown(rows, {}, play)[POSITION] - shown(rows, {}, {})[POSITION]) * 1e6
    # derivatives of the position by the crank angle at -40 and 40 degrees: 0.10929 and -0.06716 m/rad
    assert change[:4] == pytest.approx([-0.5 * 109.29, 0.5 * 109.29, -67.16, 67.16], abs=0.1)
    assert change[4] < 0 < change[5]  # 220 degrees is before the next dead centre


@pytest.mark.parametrize("kind", KINDS)
def test_noise_has_its_spread_and_memory(kind: Kind) -> None:
    rng = np.random.default_rng(3)
    rows = measured("wide", 300, rng)
    rho = 0.6 if kind == "autocorrelated" else 0.0
    noise = Noise(kind, {POSITION: 1.5e-6}, rho)
    many = np.array([noise.drawn(rows, POSITION, rng) for _ in range(500)])
    stated = noise.covariance(rows, POSITION)
    assert np.sqrt(np.mean(np.diag(stated))) == pytest.approx(1.5e-6, rel=1e-12)
    heavy = kind == "heavy"  # its fourth moment is infinite: the variance converges slowly
    assert np.std(many) == pytest.approx(1.5e-6, rel=0.05 if heavy else 0.01)
    assert np.mean(many[:, 1:] * many[:, :-1]) / np.mean(many**2) == pytest.approx(rho, abs=0.01)
    if kind == "growing":
        load = np.abs(rows.forming_force)
        busy, idle = load > np.quantile(load, 0.9), load < np.quantile(load, 0.1)
        expected = noise.spread(rows, POSITION)
        assert many[:, busy].std() / many[:, idle].std() == pytest.approx(
            np.sqrt(np.mean(expected[busy] ** 2) / np.mean(expected[idle] ** 2)), rel=0.02
        )
        assert many[:, busy].std() > 2.5 * many[:, idle].std()


def test_heavy_tails_are_heavy() -> None:
    """Student with 4 degrees of freedom has 8.6 times as much beyond 4 as the normal law, which has 6e-5."""
    heavy, plain = (noise_of(kind, 8000, np.random.default_rng(1)) for kind in (KINDS[1], KINDS[0]))
    assert np.std(heavy) == pytest.approx(1.0, rel=0.06)
    assert np.mean(np.abs(heavy) > 4) > 20 * 6.3e-5
    assert np.mean(np.abs(plain) > 4) < 1e-3


def test_rows_held_out_are_the_others_and_never_the_first() -> None:
    fitted, held = held_out(50, 20, np.random.default_rng(2))
    assert sorted([*fitted, *held]) == list(range(50))
    assert len(held) == 20
    assert fitted[0] == 0


@pytest.mark.parametrize("design", DESIGNS)
def test_designs_are_ordered_and_begin_at_nothing(design: Design) -> None:
    rows = measured(design, 300, np.random.default_rng(5))
    assert rows.time[0] == rows.strokes[0] == 0
    assert np.all(np.diff(rows.time) >= 0)
    assert np.all(np.diff(rows.strokes) >= 0)
    assert (np.any(rows.forming_force < 0)) == (design != "narrow")
    tied = np.corrcoef(rows.link_temperature, -np.expm1(-rows.time / rows.time[-1] * 3))[0, 1]
    assert (tied > 0.9) == (design == "warm-up")


def test_a_case_without_an_effect_is_tolerance_and_noise() -> None:
    """Deviations scatter like the tolerances over many cases, and what is left of the readings is the noise."""
    cases = [make_case(seed, Wish("none", kind="gaussian", rows=80)) for seed in range(15)]
    drawn = np.array([[case.off[name] / sd for name, sd in SCATTER.items()] for case in cases])
    assert drawn.std() == pytest.approx(1.0, abs=0.1)
    assert abs(drawn.mean()) < 0.1
    for case in cases:
        assert (case.hidden, case.truth, case.shape, case.lambda_det) == ({}, (), None, 0.0)
        plain = shown(case.record.rows, case.off, {})
        for name in case.results:
            left = (case.readings[name] - plain[name]) / case.record.noise.sd[name]
            assert left.std() == pytest.approx(1.0, abs=0.35)


def linear(case: Case) -> tuple[Array, Array]:
    """Tolerances' and one effect's columns of a case, as plain matrices."""
    rows, results = case.record.rows, case.results
    heating = next(one for one in registered(results, 1.0) if one.effect == "link_heating")
    return tolerance_columns(rows, results), columns(rows, results, heating, {})


def test_visibility_is_what_a_fit_with_prior_loses() -> None:
    """The textbook form: the weighted least squares of the effect by the tolerances, each pulled to 0 by its prior."""
    case = make_case(11, Wish("single", kind="autocorrelated", rows=80, effects=("link_heating",), size=1.0))
    tolerances, column = linear(case)
    hidden = column[:, 0] * case.hidden["link_heating"]["expansion"]
    noise = covariance(case.record.noise, case.record.rows, case.results)
    weight = np.linalg.inv(noise)
    normal = tolerances.T @ weight @ tolerances + np.eye(tolerances.shape[1])
    found = np.linalg.solve(normal, tolerances.T @ weight @ hidden)
    left = hidden - tolerances @ found
    assert Lens(case.record).visibility(hidden) == pytest.approx(left @ weight @ left + found @ found, rel=1e-6)
    assert case.lambda_det == pytest.approx(Lens(case.record).visibility(hidden), rel=2e-3)


def test_separation_from_a_rival_is_the_same_fit_with_its_column() -> None:
    case = make_case(11, Wish("single", kind="gaussian", rows=80, effects=("link_heating",), size=1.0))
    tolerances, _ = linear(case)
    rival = next(one for one in case.record.candidates if one.effect == "sensor_drift")
    beside = columns(case.record.rows, case.results, rival, {})
    beside = 0.1 * beside / beside.max()  # its prior is a decimetre: none at all
    noise = case.record.covariance + tolerances @ tolerances.T + beside @ beside.T
    expected = case.change @ np.linalg.solve(noise, case.change)
    assert case.lens.separation(case.change, [rival.name]) == pytest.approx(expected, rel=1e-4)


def test_a_rival_keeps_to_its_bounds() -> None:
    """Clearance that pulls instead of pushing is none: a link that grows under load is not told by it."""
    case = make_case(5, Wish("single", "wide", "gaussian", (POSITION,), 150, ("joint_clearance",), 2.0))
    against = {
        name: case.lens.separation(way * case.change, ["joint_clearance"]) for name, way in (("+", 1), ("-", -1))
    }
    assert against["+"] < 1e-3 * case.lambda_det
    assert against["-"] == pytest.approx(case.lambda_det, rel=1e-9)


def test_one_curve_has_several_names() -> None:
    narrow = make_case(2, Wish("none", "wide", "gaussian", (POSITION,), 80)).record
    assert narrow.same_as("link_heating") == {"link_heating", "side_heating"}
    assert narrow.same_as("sensor_offset:slider_position") == {
        "sensor_offset:slider_position",
        "die_inclination:height",
    }
    both = make_case(2, Wish("none", "wide", "gaussian", BOTH, 80)).record
    assert both.same_as("link_heating") == {"link_heating"}
    inside, around = both.place("link_heating"), both.place("side_heating")
    assert both.contained[inside, around]
    assert not both.contained[around, inside]


def test_rivals_of_a_pair_are_its_halves_too() -> None:
    record = make_case(2, Wish("none", "narrow", "gaussian", (POSITION,), 80)).record
    truth = [record.place("joint_wear"), record.place("crank_phase")]
    sets = {frozenset(record.candidates[one.owner].name for one in chosen) for chosen in rivals(Lens(record), truth, 2)}
    assert {frozenset(["joint_wear"]), frozenset(["crank_phase"])} <= sets
    assert frozenset(["joint_wear", "crank_phase"]) not in sets
    assert frozenset(["joint_wear", "joint_clearance"]) in sets


def test_the_same_seed_is_the_same_case() -> None:
    one, two = make_case(41), make_case(41)
    assert one.hidden == two.hidden
    assert np.array_equal(one.readings[POSITION], two.readings[POSITION])
    assert not np.array_equal(make_case(42).readings[POSITION][:80], one.readings[POSITION][:80])


def test_sizes_are_half_the_noise_to_three_times() -> None:
    """What no machine of this design imitates, or the whole effect, lies in the range."""
    sizes = []
    for seed in range(200, 240):
        if SCHEDULE[seed % len(SCHEDULE)] not in {"single", "unknown"}:
            continue
        case = make_case(seed)
        record, change = case.record, case.change
        sizes.append((record.size_of(change), record.rest_of(change), record.strangeness_of(change)))
        assert any(0.45 < size < 3.3 for size in sizes[-1])
    whole, rest, strange = np.array(sizes).T
    assert np.all(rest < whole * 1.001)
    assert np.all(rest < strange * np.sqrt(2.001))
    assert 0 < np.mean(strange < 0.45) < 0.25
    assert {make_case(seed).stratum for seed in (0, 1, 2, 6, 9)} == set(SCHEDULE)
