"""What rough flanks leave out of a drive and of a surface: each effect against its own arithmetic.

Numbers marked as reference follow by hand: size 20 has a pitch radius of 25.4 mm and a pressure angle of 20 degrees.
"""

from dataclasses import replace
from math import cos, erf, exp, log, pi, sqrt, tan, tanh
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.linalg import solve_banded
from scipy.optimize import brentq

from harmonic_fractal.calculation import harmonic_fractal
from harmonic_fractal.effects import EFFECTS, held_share, oil_film
from harmonic_fractal.model import HARMONIC_FRACTAL
from harmonic_fractal.quantities import Drive
from harmonic_fractal.structure import kept_share
from truing import Effect, Kernel
from truing.diagnosis.reading import read_records
from truing.inputs_file import read_setup

URAD, UM, NM, ROOM = 1e-6, 1e-6, 1e-9, 293.15
HOUR, RPM, DEGREE = 3600.0, 1 / 60, pi / 180
BY_NAME: dict[str, Effect[Any, Any]] = {effect.name: effect for effect in EFFECTS}
LEG = {"direction": 1.0, "reversal_torque": -40.0, "peak_torque": 40.0}


def drive_at(torque: float = 25.0, **settings: Any) -> Drive:
    """The drive of the model under a torque, with 40 urad/(N m) in series."""
    drive: Drive = HARMONIC_FRACTAL.inputs(torque=torque, **{"drive_compliance": 40e-6, **settings})
    return drive


def shown(name: str, drive: Drive, **values: float) -> dict[str, Any]:
    """The results in SI with one effect on; unknowns and conditions in SI."""
    effect = BY_NAME[name]
    if effect.place == "inputs":
        found = harmonic_fractal(effect.function(drive, **values))
    else:
        found = effect.function(drive, harmonic_fractal(drive), **values)
    return vars(found)


def turned(name: str, drive: Drive, **values: float) -> float:
    """What one effect adds to the torsion, urad."""
    return float(shown(name, drive, **values)["torsion"] - harmonic_fractal(drive).torsion) / URAD


def stiffer(name: str, drive: Drive, **values: float) -> float:
    """How many times as stiff the mesh is with one effect on."""
    return float(shown(name, drive, **values)["mesh_stiffness"] / harmonic_fractal(drive).mesh_stiffness)


@pytest.mark.parametrize("torque", [25.0, -10.0])
def test_springs_in_series_add_their_compliance(torque: float) -> None:
    beyond = np.sign(torque) * (abs(torque) - 1e-3)
    assert turned("series_compliance", drive_at(torque), compliance=30e-6) == pytest.approx(30 * beyond, rel=1e-6)


def test_warm_steel_softens_all_that_is_in_series() -> None:
    """3e-4 per kelvin, 40 K: modulus times 0.988, of the 1000 urad of the springs 12.1 more."""
    found = turned("modulus_temperature", drive_at(), softening=3e-4, temperature=ROOM + 40)
    assert found == pytest.approx(40 * 24.999 * (1 / 0.988 - 1), rel=0.01)
    assert turned("modulus_temperature", drive_at(), softening=3e-4, temperature=ROOM) == 0


def test_pairs_that_bend_share_the_torque_with_those_that_come() -> None:
    """Teeth that bend make the mesh stiffer in proportion to their number, and the torsion is summed on the way."""
    drive = drive_at(tooth_stiffness=1e4, drive_compliance=0.0, reference_torque=0.1)
    values = {"gain": 1.5, "torque_scale": 0.32}
    assert stiffer("engaged_pairs", drive, **values) == pytest.approx(1 + 1.5 * (1 - exp(-25 / 8)), rel=1e-3)
    radius = 25.4e-3 * cos(20 * DEGREE)
    softness = quad(lambda torque: 1 / (1 + 1.5 * (1 - exp(-torque / 8))), 0.1, 25)[0] / (60 * 1e4 * radius**2)
    found = shown("engaged_pairs", drive, **values)["torsion"]
    assert found == pytest.approx(softness, rel=1e-3)


def test_oil_carries_beside_the_flanks_while_they_turn() -> None:
    """60 pairs of 1e9 N/m on a lever of 23.868 mm: 3.418e7 N m/rad, and 2^0.67 times less at twice the speed."""
    drive, values = drive_at(), {"stiffness": 1e9, "temperature": ROOM}
    added = {
        speed: shown("oil_film", drive, speed=speed * RPM, **values)["mesh_stiffness"]
        - harmonic_fractal(drive).mesh_stiffness
        for speed in (0.0, 1000.0, -1000.0, 2000.0)
    }
    assert added[0.0] == 0
    assert added[1000.0] == pytest.approx(60e9 * (25.4e-3 * cos(20 * DEGREE)) ** 2, rel=0.02)
    assert added[-1000.0] == added[1000.0]
    assert added[1000.0] / added[2000.0] == pytest.approx(2**0.67, rel=1e-6)
    warm = shown("oil_film", drive, speed=1000 * RPM, stiffness=1e9, temperature=ROOM + 20)["mesh_stiffness"]
    assert warm - harmonic_fractal(drive).mesh_stiffness == pytest.approx(added[1000.0] * exp(0.035 * 20 * 0.67))


def wedge(flow: float, wide: float) -> float:
    """Load of a parabolic wedge by Reynolds' equation in finite differences, negative pressures cut off."""
    x = np.linspace(-4.0, 4.0, 801)
    height, step = wide + x**2 / 2, x[1] - x[0]
    between = ((height[1:] + height[:-1]) / 2) ** 3
    bands = np.zeros((3, len(x) - 2))
    bands[0, 1:], bands[1], bands[2, :-1] = between[1:-1], -(between[:-1] + between[1:]), between[1:-1]
    drag = 6 * flow * (height[2:] - height[:-2]) / 2 * step
    return float(np.maximum(solve_banded((1, 1), bands, drag), 0).sum() * step)


@pytest.mark.parametrize("speed", [1e-6, 1.0, 10.0, 50.0, 300.0])
def test_film_and_asperities_share_the_load(speed: float) -> None:
    """The film what its wedge carries at the gap, over what it carries where it is as thick alone; asperities the rest.

    They hold a tenth and let go by e over a fiftieth. At 1e-6 rpm the film has 1e-9/0.1^(1/0.67) = 3.1e-8 of it.
    """

    def film(gap: float) -> float:
        return wedge(speed / 1000, gap) / wedge(gap ** (1 / 0.67), gap)

    gap = brentq(lambda gap: film(gap) + exp((0.1 - gap) / 0.02) - 1, 0.1, 2.0, xtol=1e-15)
    found = oil_film(drive_at(), stiffness=1e9, speed=speed * RPM, temperature=ROOM).film_stiffness
    assert found == pytest.approx(1e9 * film(gap) / gap, rel=1e-7)
    if speed == 1e-6:
        assert found == pytest.approx(1e10 * 3.1e-8, rel=0.01)


def test_torsion_is_continuous_to_rest() -> None:
    """It falls as the film comes to carry, from what the asperities alone give, and rises as the film gets thicker."""
    values = {"stiffness": 2e11, "temperature": ROOM}
    speeds = [0.0, 1e-9, 1e-6, 1e-3, 1.0, 40.0, 70.0, 200.0, 1000.0, 6000.0]
    found = [shown("oil_film", drive_at(), speed=speed * RPM, **values)["torsion"] for speed in speeds]
    assert found[1] == pytest.approx(found[0], rel=1e-3)
    assert (np.diff(found[:6]) < 0).all()
    assert (np.diff(found[6:]) > 0).all()


def test_asperities_go_and_leave_another_surface() -> None:
    values = {"dimension": 0.05, "roughness": 1.0, "cycle_scale": 1e5, "cycles": 1e5}
    found, share = shown("asperity_smoothing", drive_at(), **values), 1 - exp(-1)
    assert found["dimension"] == pytest.approx(2.4 + 0.05 * share)
    assert found["roughness"] == pytest.approx(1e-11 * exp(-share))
    assert stiffer("asperity_smoothing", drive_at(), **values) > 1.5


def test_friction_takes_up_energy_and_closes_its_loop() -> None:
    """Behind on the way up and before on the way down; a turn begins where the last leg ended."""
    values = {"loop": 200e-6, "torque_scale": 0.08}
    torque = np.linspace(-40, 40, 401)
    up = np.array([turned("hysteresis", drive_at(one), **values, **LEG) for one in torque[::40]])
    down_leg = {"direction": -1.0, "reversal_torque": 40.0, "peak_torque": 40.0}
    down = np.array([turned("hysteresis", drive_at(one), **values, **down_leg) for one in torque[::40]])
    assert np.trapezoid(down - up, torque[::40]) > 0
    assert (up[0], down[-1]) == pytest.approx((100, -100), rel=1e-6)
    assert (up[5], down[5]) == pytest.approx((-100, 100), rel=1e-6)


def test_the_first_load_begins_in_the_middle_of_the_loop() -> None:
    """Masing: a branch is the first load, twice as large and twice as long."""
    first = float(held_share(drive_at(3.0), 0.08, 1.0, 0.0, 3.0))
    later = float(held_share(drive_at(6.0 - 40.0), 0.08, 1.0, -40.0, 40.0))
    assert first == pytest.approx(1 - exp(-3.0))
    assert later + 1 == pytest.approx(2 * first)
    assert float(held_share(drive_at(0.0), 0.08, 1.0, 0.0, 0.0)) == 0
    assert float(held_share(drive_at(3.0), 0.08, 0.0, 0.0, 3.0)) == 0


def test_drag_is_in_proportion_to_viscosity_and_speed() -> None:
    values = {"loop": 100e-6, "torque_scale": 0.08, "thinning": 0.03, **LEG}
    found = turned("viscous_hysteresis", drive_at(30), **values, speed=-500 * RPM, temperature=ROOM - 20)
    assert found == pytest.approx(-0.5 * 100 * 0.5 * exp(0.6), rel=1e-6)
    assert turned("viscous_hysteresis", drive_at(30), **values, speed=0.0, temperature=ROOM) == 0


def test_play_wear_and_heat_shift_the_torsion_in_the_sense_of_the_torque() -> None:
    play = {"play": 60e-6, "torque_scale": 0.12}
    assert turned("lost_motion", drive_at(-3.0), **play) == pytest.approx(-60 * tanh(1))
    worn = turned("flank_wear", drive_at(30), rate=1e-6, torque_scale=0.04, cycles=2e6)
    assert worn == pytest.approx(2 * 2e-6 / (25.4e-3 * cos(20 * DEGREE)) / URAD)  # 167.6 urad
    apart = turned("thermal_preload", drive_at(-5), expansion=2e-6, temperature=ROOM + 40)
    assert apart == pytest.approx(-2e-6 * 40 * tan(20 * DEGREE) / URAD)  # 29.1 urad: gap dr tan(alpha) over r_p


def test_a_first_load_leaves_a_set_and_a_stiffer_mesh() -> None:
    values = {"set": 40e-6, "exponent": 1.5, "stiffening": 0.2}
    assert turned("first_load_set", drive_at(10), **values, peak_torque=50.0) == pytest.approx(40 * 2**1.5)
    assert turned("first_load_set", drive_at(-10), **values, peak_torque=-1.0) == 0
    assert stiffer("first_load_set", drive_at(10), **values, peak_torque=50.0) == pytest.approx(1.2)
    assert stiffer("first_load_set", drive_at(50), **values, peak_torque=50.0) == 1


def test_waves_turn_with_the_wave_generator() -> None:
    values = {"cosine": 3e-6, "sine": -4e-6, "wave_angle": 30 * DEGREE}
    assert turned("eccentricity", drive_at(), **values) == pytest.approx(3 * cos(pi / 6) - 2)
    assert turned("ellipticity", drive_at(), **values) == pytest.approx(1.5 - 4 * cos(pi / 6))
    lobes = {"stiffness_cosine": 0.1, "stiffness_sine": 0.0, "wave_angle": 90 * DEGREE}
    assert stiffer("ellipticity", drive_at(), **lobes) == pytest.approx(0.9)
    assert turned("ellipticity", drive_at(), **lobes) == 0


def test_creep_and_drift_go_on_with_time() -> None:
    drive = drive_at()
    found = turned("creep", drive, share=0.01, time_scale=0.5 * HOUR, time=2 * HOUR)
    assert found == pytest.approx(0.01 * log(5) * harmonic_fractal(drive).torsion / URAD)
    assert turned("rig_drift", drive, rate=6e-6 / HOUR, time=2 * HOUR) == pytest.approx(12)


def test_turns_direction_and_peak_are_made_from_the_torque(tmp_path: Path) -> None:
    torque = [0, 4, 8, 2, -6, -8, 0, 12, 11]
    (tmp_path / "loop.csv").write_text(
        "torque [N*m],torsion [urad]\n" + "".join(f"{one},{at}\n" for at, one in enumerate(torque))
    )
    (tmp_path / "inputs.toml").write_text('plugin = "harmonic_fractal"\n')
    offer = Kernel.installed().offer("harmonic_fractal")
    setup = read_setup(tmp_path / "inputs.toml", offer)
    made = read_records([tmp_path / "loop.csv"], offer, setup).rows.columns
    assert list(made["reversal_torque"]) == [0, 0, 0, 8, 8, 8, -8, -8, 12]
    assert list(made["direction"]) == [1, 1, 1, -1, -1, -1, 1, 1, -1]
    assert list(made["peak_torque"]) == [0, 4, 8, 8, 8, 8, 8, 12, 12]


def raised(name: str, **values: float) -> NDArray[np.float64]:
    """What one effect adds to the structure function, um^2, at 0.5, 5 and 50 um."""
    drive = replace(drive_at(), lags=np.array([0.5, 5.0, 50.0]) * UM)
    added: NDArray[np.float64] = shown(name, drive, **values)["structure_function"]
    return np.ravel(added - harmonic_fractal(drive).structure_function) / UM**2


def test_a_wave_and_noise_add_to_the_structure_function() -> None:
    added = raised("waviness", square=0.04 * UM**2, wavelength=20 * UM)
    assert added == pytest.approx(0.04 * (1 - np.cos(2 * pi * np.array([0.025, 0.25, 2.5]))), rel=1e-6)
    assert raised("instrument_noise", variance=400 * NM**2) == pytest.approx([8e-4] * 3)


@pytest.mark.parametrize("exponent", [0.2, 0.8, 1.2, 1.8])
@pytest.mark.parametrize("lag", [0.1, 0.5, 1.0, 3.0, 10.0, 10.96, 300.0])
def test_a_spot_leaves_what_the_mean_over_two_normal_places_leaves(lag: float, exponent: float) -> None:
    """Width 1: (E|lag + sqrt(2) Z|^a - E|sqrt(2) Z|^a)/lag^a, by quadrature."""

    def density(place: float) -> float:
        return exp(-(place**2) / 4) / (2 * sqrt(pi))

    def part(at: float, sign: int) -> float:
        middle = [max(sign * at, 0.0)]
        found = quad(lambda way: way**exponent * density(sign * way - at), 0, at + 30, points=middle, epsrel=1e-12,
                     epsabs=1e-13, limit=400)  # fmt: skip
        return float(found[0])

    def mean(at: float) -> float:
        return part(at, 1) + part(at, -1)

    expected = (mean(lag) - mean(0.0)) / lag**exponent
    assert float(kept_share(np.array(lag), 1.0, exponent)) == pytest.approx(expected, rel=1e-7, abs=1e-9)


def test_a_spot_on_a_parabola_and_on_white_noise() -> None:
    """Heights that rise evenly (a = 2) keep all; a walk (a = 1) keeps erf-like tails, in closed form."""
    lag = np.array([0.5, 2.0, 8.0])
    x = lag / 2
    closed = np.array([erf(one) for one in x]) + (np.exp(-(x**2)) - 1) / (sqrt(pi) * x)
    assert kept_share(lag, 1.0, 1.0) == pytest.approx(closed, rel=1e-10)
    assert kept_share(lag, 1.0, 1.999999) == pytest.approx(np.ones(3), abs=1e-5)
