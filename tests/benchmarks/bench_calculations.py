"""How much faster are the calculations than plain loops, single calls and a library, and what do their searches need?

Run it: ``python -m pytest tests/benchmarks/bench_calculations.py -s``. Baselines are written well: what does not change
is computed once, and only plain floats and functions of ``math`` are used, or numpy where a loop over points would be
slower by far. Whatever is timed says the same first. Everything is measured alternately in one process, in time of the
processor, and the least of each counts; a slow baseline does a share of the work and is scaled to all of it.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import pytest
from timed import least

from harmonic_fractal.generators import Waves, brownian_profiles, weierstrass_surface
from harmonic_fractal.structure import fit_steps, structure_sums
from published.rv_wear_by_hand import wear_by_hand
from roller_screw_shift.model import ROLLER_SCREW_SHIFT
from roller_screw_shift.objectives import weights_of
from roller_screw_shift.optimum import READINGS, Plan, box_optimum, field_of, grid_optimum
from rv_gearing.groups import candidates, search
from rv_gearing.model import RV_GEARING
from rv_wear.model import BOX, RV_WEAR
from rv_wear.wear import forget, worn
from truing import Model, Optimise, Surrogate
from truing.calculation import calculate
from truing.setup import Setup, default_setup


@dataclass(frozen=True)
class Race:
    """A baseline and ours: ``slow`` and ``fast`` answer numbers that are the same to ``within``, relatively.

    Ours does so many ``times`` as much as the baseline; a unit of work is to be ``at_least`` as many times as fast.
    ``of_largest``: numbers may differ by so large a share of the largest.
    """

    slow: Callable[[], Any]
    fast: Callable[[], Any]
    at_least: float
    times: float = 1.0
    within: float = 1e-9
    of_largest: bool = False


# A made patch of the shipped example: 501 x 251 points, 40 ridge directions, 1480 plane waves

X, Y = 0.4e-6 * np.arange(501.0), 0.4e-6 * np.arange(251.0)
WAVES = Waves(dimension=1.4, roughness=1e-11, lowest=1.0 / 20e-3, highest=1.0 / 8e-9)


def patch() -> np.ndarray:
    """One matrix product."""
    return weierstrass_surface(WAVES, X, Y, np.random.default_rng(0))


def patch_by_waves() -> np.ndarray:
    """Wave by wave, over the whole patch."""
    frequencies, directions = WAVES.frequencies, WAVES.directions
    phases = np.random.default_rng(0).uniform(0.0, 2.0 * np.pi, (directions, len(frequencies)))
    heights = np.zeros((len(Y), len(X)))
    scale = WAVES.roughness ** (WAVES.dimension - 1.0) * np.sqrt(np.log(WAVES.density) / directions)
    for m in range(1, directions + 1):
        way = np.add.outer(Y * np.sin(np.pi * m / directions), X * np.cos(np.pi * m / directions))
        for frequency, phase in zip(frequencies, phases[m - 1], strict=True):
            wave = np.cos(phase) - np.cos(2.0 * np.pi * frequency * way + phase)
            heights += scale * frequency ** (WAVES.dimension - 2.0) * wave
    return heights


# The structure function of a map of 1024 x 1024 points, 3 % of them missing, at 16 lags

POINTS, LOOPED = 1024, 8
STEPS = fit_steps(POINTS, float("nan"), float("nan"), 18)  # 16 of them are different whole numbers
RNG = np.random.default_rng(0)
MAP = brownian_profiles(1.5, 1e-16, (POINTS, POINTS), RNG)
MAP[RNG.random(MAP.shape) < 0.03] = np.nan


def structure_by_pairs() -> np.ndarray:
    """Of some lines, pair by pair: floats in lists, which is how such a loop is quick."""
    means = []
    for line in MAP[:LOOPED].tolist():
        for step in STEPS.tolist():
            total, count = 0.0, 0
            for first in range(len(line) - step):
                difference = line[first + step] - line[first]
                if difference == difference:
                    total += difference * difference
                    count += 1
            means.append(total / count)
    return np.array(means).reshape(LOOPED, len(STEPS))


def structure() -> np.ndarray:
    """Of the whole map; the lines that the loop looks at."""
    sums, counts = structure_sums(MAP, STEPS)
    return np.asarray(sums / counts)[:LOOPED]


# The search for tooth numbers, all even pin numbers from 20 to 80: bounds as the search works them out

STAGE = RV_GEARING.inputs(fewest_pins=20, most_pins=80)


def meets(sun: int, planet: int, pins: int) -> bool:
    """The conditions of the paper for one group."""
    ratio = 1 + planet * pins / sun
    if abs(ratio - 111) / 111 > 0.01 or planet < 1.5 * sun:
        return False
    k, u = pins / (pins - 1), planet / sun
    mesh = (k - 1) * (k - 0.998 + u * k * 0.992) / ((k - 0.998) * (k - 1 + u * k))
    size = (9_550_000 * 2.26 / 15 * mesh * 0.99**3) ** (1 / 3)
    return 0.5 * 0.85 * size <= 1.25 * (sun + planet) / 2 <= 0.6 * 1.3 * size


def groups_by_loops() -> list[tuple[int, int, int]]:
    """Every pin, sun and planet number within the bounds."""
    tried = candidates(STAGE)
    pins, suns, planets = (
        range(int(numbers.min()), int(numbers.max()) + 1) for numbers in (tried.pins, tried.sun, tried.planet)
    )
    every = ((sun, planet, pin) for pin in pins[::2] for sun in suns for planet in planets)
    return [group for group in every if meets(*group)]


def groups_searched() -> list[tuple[int, int, int]]:
    """What the search finds."""
    groups = search(STAGE)
    return [(int(s), int(p), int(z)) for s, p, z in zip(groups.sun, groups.planet, groups.pins, strict=True)]


# Wear to 6000 h of differently ground discs: the paper's iteration starts from the force without clearance

GROUND = np.linspace(-45e-6, 10e-6, 1000)
SOME = slice(None, None, 100)


def wear_at_once() -> np.ndarray:
    """All of them in one call that remembers nothing; those that are worn by hand."""
    forget()
    discs = RV_WEAR.inputs(equidistant_modification=GROUND, shift_modification=GROUND - 4e-6)
    return np.asarray(worn(discs)["max_wear"])[SOME]


def wear_disc_by_disc() -> np.ndarray:
    """Some of them, one after another."""
    return np.array([wear_by_hand(ground, ground - 4e-6) for ground in GROUND[SOME].tolist()])


# 100 000 cases of very different first stages, spur to helical, and of profile shifts at which every number exists

CASES, ALONE = 100_000, 200
STAGES = {
    "sun_teeth": RNG.integers(18, 36, CASES) * 1.0,
    "planet_teeth": RNG.integers(45, 99, CASES) * 1.0,
    "face_width": RNG.uniform(8e-3, 20e-3, CASES),
    "helix_angle": RNG.uniform(0.0, 0.3, CASES),
    "load_torque": RNG.uniform(100.0, 1500.0, CASES),
    "input_speed": RNG.uniform(5.0, 40.0, CASES),
}
SHIFTS = {"roller_shift": np.linspace(-0.2, 1.0, CASES)}


def in_one_call(model: Model[Any, Any], columns: Mapping[str, Any]) -> Race:
    """The calculation itself called once for each of some cases, and for all of them at once; inputs ready made."""
    nominal = model.inputs()
    together, rows = replace(nominal, **columns), slice(None, None, CASES // ALONE)
    names = {name: values[rows] for name, values in columns.items()}
    alone = [replace(nominal, **dict(zip(names, values, strict=True))) for values in zip(*names.values(), strict=True)]

    def one_by_one() -> Any:
        return [list(model.read_results(model.function(case)).values()) for case in alone]

    def at_once() -> Any:
        results = model.read_results(model.function(together)).values()
        return np.array([np.broadcast_to(values, CASES)[rows] for values in results]).T

    return Race(one_by_one, at_once, at_least=50.0, times=CASES / ALONE, within=1e-12)


RACES = {
    "patch": Race(patch_by_waves, patch, at_least=10.0, of_largest=True),  # phases of 2e5 rad lose five digits
    "map": Race(structure_by_pairs, structure, at_least=50.0, times=POINTS / LOOPED),
    "search": Race(groups_by_loops, groups_searched, at_least=10.0),
    "wear": Race(wear_disc_by_disc, wear_at_once, at_least=100.0, times=len(GROUND) / len(GROUND[SOME])),
    "stages": in_one_call(RV_GEARING, STAGES),
    "shifts": in_one_call(ROLLER_SCREW_SHIFT, SHIFTS),
}


@pytest.mark.parametrize("name", RACES)
def test_it_says_the_same_that_many_times_faster(name: str) -> None:
    race = RACES[name]
    slow, fast = (np.asarray(work(), dtype=float) for work in (race.slow, race.fast))
    largest = np.abs(slow).max() if race.of_largest else 0.0
    np.testing.assert_allclose(fast, slow, rtol=race.within, atol=race.within * largest)
    loop, ours = least(race.slow, race.fast)
    ratio = race.times * loop / ours
    print(f"\n{name}: {ratio:.0f} times as fast as its baseline (at least {race.at_least:g})")
    assert ratio >= race.at_least


def test_a_map_is_faster_than_the_library() -> None:
    """Half the structure function at all lags by Fourier transforms, missing points left out."""
    library = pytest.importorskip("SurfaceTopography")
    topography = library.Topography(np.ma.masked_invalid(MAP.T), (float(POINTS), float(POINTS)))
    sums, counts = structure_sums(MAP, STEPS)
    half = topography.autocorrelation_from_profile()[1][0]
    assert 2.0 * half == pytest.approx(sums[:, 0].sum() / counts[:, 0].sum(), rel=1e-6)
    ours, theirs = least(structure, topography.autocorrelation_from_profile)
    print(f"\n{STEPS.size} lags: SurfaceTopography takes {theirs / ours:.1f} times as long (at least 1)")
    assert theirs > ours


# Searches


TRAINED = Surrogate(
    of="max_wear", over=BOX, logarithmic=("output_torque", "output_speed", "working_time"), log_result=True,
    held_out=10, compare=0,
)  # fmt: skip


def calculated_anew(setup: Setup) -> None:
    """The studies of a setup, nothing being remembered from before."""
    forget()
    calculate(setup)


def test_full_physics_against_a_surrogate() -> None:
    """Full physics is the default because it loses nothing; it must not be the slower way either.

    Both evaluate the same number of designs under the same chances; the surrogate pays for its 150 calculations, too.
    """
    plain, setup = Optimise(chance="first_order", generations=100, verify=1000), default_setup(RV_WEAR)
    ways = (replace(setup, studies=(plain,)), replace(setup, studies=(TRAINED, replace(plain, surrogate=True))))
    full, learnt = least(*(partial(calculated_anew, way) for way in ways))
    print(f"\nfull physics {full:.2f} s, with a surrogate {learnt:.2f} s: {learnt / full:.2f} times as long")
    assert full < learnt


@pytest.mark.parametrize("ratio", [1.2, 1.4])
def test_box_needs_a_twentieth_of_the_dense_grid(ratio: float) -> None:
    """On twenty seeds, under every reading of the weights, at this least contact ratio."""
    span = (-2.0, 3.0)
    field = field_of(ROLLER_SCREW_SHIFT.inputs(least_contact_ratio=ratio), span, 20_001)
    assert field is not None
    for reading in READINGS:
        weights = weights_of(reading, field.ranges)
        grid = grid_optimum(field, weights)
        runs = [box_optimum(field, weights, span, np.random.default_rng(seed), Plan()) for seed in range(20)]
        evaluations = float(np.mean([run.evaluations for run in runs]))
        away = max(abs(float(run.point[0]) - grid) for run in runs)
        print(f"\ncontact ratio {ratio:g}, {reading}: {evaluations:.0f} evaluations, {away:.1e} from the grid", end="")
        assert evaluations < 20_001 / 20
        assert away < 2e-6
