"""What rough flanks leave out of a drive and of a surface: teeth that bend, oil, rest, and what an instrument leaves.

What each effect of a drive does is compared with a machine of its own in ``test_effects_of_machines.py``.
"""

from dataclasses import replace
from functools import partial
from math import cos, exp, pi, radians, sqrt, tanh
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.linalg import solve_banded
from scipy.optimize import brentq
from switched import change, shown

from harmonic_fractal.effects import oil_film
from harmonic_fractal.model import HARMONIC_FRACTAL
from harmonic_fractal.quantities import Drive
from harmonic_fractal.structure import kept_share
from truing import Kernel
from truing.diagnosis.reading import read_records
from truing.inputs_file import read_setup

UM, ROOM, RPM, ALPHA = 1e-6, 293.15, 1 / 60, radians(20)
with_effect: Any = partial(shown, HARMONIC_FRACTAL)
added: Any = partial(change, HARMONIC_FRACTAL)


def drive_at(torque: float = 25.0, **settings: Any) -> Drive:
    """The drive of the model under a torque, with 40 urad/(N m) in series."""
    drive: Drive = HARMONIC_FRACTAL.inputs(torque=torque, **{"drive_compliance": 40e-6, **settings})
    return drive


def test_pairs_that_bend_share_the_torque_with_those_that_come() -> None:
    """Teeth that bend make the mesh stiffer in proportion to their number, and the torsion is summed on the way."""
    drive = drive_at(tooth_stiffness=1e4, drive_compliance=0.0, reference_torque=0.1)
    found = with_effect("engaged_pairs", drive, gain=1.5, torque_scale=0.32)
    times = found["mesh_stiffness"] / with_effect("", drive)["mesh_stiffness"]
    assert times == pytest.approx(1 + 1.5 * (1 - exp(-25 / 8)), rel=1e-3)
    radius = 25.4e-3 * cos(ALPHA)
    softness = quad(lambda torque: 1 / (1 + 1.5 * (1 - exp(-torque / 8))), 0.1, 25)[0] / (60 * 1e4 * radius**2)
    assert found["torsion"] == pytest.approx(softness, rel=1e-3)


def wedge(flow: float, wide: float) -> float:
    """Load of a parabolic wedge by Reynolds' equation in finite differences, negative pressures cut off."""
    x = np.linspace(-4.0, 4.0, 801)
    height, step = wide + x**2 / 2, x[1] - x[0]
    between = ((height[1:] + height[:-1]) / 2) ** 3
    bands = np.zeros((3, len(x) - 2))
    bands[0, 1:], bands[1], bands[2, :-1] = between[1:-1], -(between[:-1] + between[1:]), between[1:-1]
    drag = 6 * flow * (height[2:] - height[:-2]) / 2 * step
    return float(np.maximum(solve_banded((1, 1), bands, drag), 0).sum() * step)


@pytest.mark.parametrize("speed", [1e-6, 1.0, 50.0, 300.0])
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
    found = [with_effect("oil_film", drive_at(), speed=speed * RPM, **values)["torsion"] for speed in speeds]
    assert found[1] == pytest.approx(found[0], rel=1e-3)
    assert (np.diff(found[:6]) < 0).all()
    assert (np.diff(found[6:]) > 0).all()


LEG = {"loop": 200e-6, "torque_scale": 0.08, "direction": 1.0, "reversal_torque": -40.0, "peak_torque": 40.0}
FIRST = {**LEG, "reversal_torque": 0.0, "peak_torque": 3.0}
SHIFTED: list[tuple[str, float, dict[str, float], float]] = [  # effect, torque, unknowns and conditions, urad
    ("hysteresis", 3.0, FIRST, -100 * (1 - exp(-3.0))),  # Masing: a first load slips in half the torque
    ("hysteresis", 3.0, LEG, -100 * (1 - 2 * exp(-43 / 2))),
    ("hysteresis", 3.0, FIRST | {"direction": 0.0}, 0.0),
    ("hysteresis", 0.0, FIRST | {"peak_torque": 0.0}, 0.0),
    ("viscous_hysteresis", 30.0, {**LEG, "thinning": 0.03, "speed": -500 * RPM, "temperature": ROOM - 20},
     -0.5 * 200 * 0.5 * exp(0.6)),
    ("lost_motion", -3.0, {"play": 60e-6, "torque_scale": 0.12}, -60 * tanh(1)),
    ("flank_wear", 30.0, {"rate": UM, "torque_scale": 0.04, "cycles": 2e6}, 4 / (25.4e-3 * cos(ALPHA))),
    ("first_load_set", -10.0, {"set": 40e-6, "exponent": 1.5, "stiffening": 0.2, "peak_torque": -1.0}, 0.0),
    ("ellipticity", 25.0, {"cosine": 3e-6, "sine": -4e-6, "wave_angle": pi / 6}, 1.5 - 4 * cos(pi / 6)),
]  # fmt: skip


@pytest.mark.parametrize(("name", "torque", "values", "expected"), SHIFTED)
def test_what_an_effect_adds_to_the_torsion(
    name: str, torque: float, values: dict[str, float], expected: float
) -> None:
    assert added("torsion", name, drive_at(torque), **values) / UM == pytest.approx(expected, rel=1e-5, abs=1e-9)


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


def test_a_wave_and_noise_add_to_the_structure_function() -> None:
    """In um^2 at 0.5, 5 and 50 um."""
    drive = replace(drive_at(), lags=np.array([0.5, 5.0, 50.0]) * UM)
    for name, values, expected in (
        ("waviness", {"square": 0.04 * UM**2, "wavelength": 20 * UM},
         0.04 * (1 - np.cos(2 * pi * np.array([0.025, 0.25, 2.5])))),
        ("instrument_noise", {"variance": 400e-18}, [8e-4] * 3),
    ):  # fmt: skip
        found = np.ravel(added("structure_function", name, drive, **values)) / UM**2
        assert found == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("exponent", [0.2, 1.0, 1.8, 1.999999])
@pytest.mark.parametrize("lag", [0.1, 1.0, 3.0, 10.96, 300.0])
def test_a_spot_leaves_what_the_mean_over_two_normal_places_leaves(lag: float, exponent: float) -> None:
    """Width 1: (E|lag + sqrt(2) Z|^a - E|sqrt(2) Z|^a)/lag^a, by quadrature."""

    def part(at: float, sign: int) -> float:
        def density(way: float) -> float:
            return way**exponent * exp(-((sign * way - at) ** 2) / 4) / (2 * sqrt(pi))

        middle = [max(sign * at, 0.0)]
        return float(quad(density, 0, at + 30, points=middle, epsrel=1e-12, epsabs=1e-13, limit=400)[0])

    def mean(at: float) -> float:
        return part(at, 1) + part(at, -1)

    expected = (mean(lag) - mean(0.0)) / lag**exponent
    assert float(kept_share(np.array(lag), 1.0, exponent)) == pytest.approx(expected, rel=1e-7, abs=1e-9)
