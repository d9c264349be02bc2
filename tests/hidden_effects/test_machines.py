"""The machines in which effects of the plugins are hidden: right in themselves, by figures from outside."""

from dataclasses import replace
from math import gamma, pi

import numpy as np
import pytest

from hidden_effects import rv_machine, screw_machine
from hidden_effects.clear import CLEAR
from hidden_effects.gearing_machine import CONTACT, PLANET_ROOT, SUN_ROOT, Stage, spread
from hidden_effects.gearing_machine import Rows as StageRows
from hidden_effects.gearing_machine import shown as shown_by_stage
from hidden_effects.harmonic_machine import COMPLIANCE, RADIUS, RIGID, TORSION, WHOLE, Flanks, measured, table
from hidden_effects.harmonic_machine import shown as shown_by_drive
from hidden_effects.harmonic_surface import power, surface, true_structure
from hidden_effects.rigs import Wish, model_of
from hidden_effects.rv_machine import RATED, ROUGHNESS, Wearing, wear_after
from hidden_effects.rv_machine import Rows as ReducerRows
from hidden_effects.rv_machine import shown as shown_by_reducer
from hidden_effects.screw_machine import ROLLER_FACTOR
from hidden_effects.screw_machine import Rows as ScrewRows
from hidden_effects.screw_machine import shown as shown_by_screw

WISHES = [wish for wishes in CLEAR.values() for wish in wishes]


@pytest.mark.parametrize("plugin", CLEAR)
def test_every_effect_is_hidden_by_the_benchmark(plugin: str) -> None:
    assert {name for wish in CLEAR[plugin] for name in wish.hidden} == set(model_of(plugin).effects)


@pytest.mark.parametrize("wish", WISHES, ids=[f"{wish.rig.plugin}-{wish.title}" for wish in WISHES])
def test_what_is_hidden_is_hidden(wish: Wish) -> None:
    """The same seed is the same machine and noise: a change as large as the noise makes an error of its root of 2."""
    changed, plain = (replace(wish, hidden=hidden, count=20, held=40).case for hidden in (wish.hidden, {}))
    assert max(changed.left_over_noise(plain.held_true, name) for name in wish.results) > 2**0.5


# Figures from outside


def one_row(torque: float) -> StageRows:
    """A row at the rated speed of the sun."""
    given = {"time": 0.0, "load_torque": torque, "input_speed": 1665.0, "oil_temperature": 40.0, "input_angle": 0.0}
    return StageRows(**{name: np.array([value]) for name, value in given.items()})


def test_the_stage_is_stressed_as_the_standard_has_it() -> None:
    """RV-110E at its rating, printed: 248.31 and 226.20 MPa at the roots, 1087.34 MPa on the flank."""
    found = shown_by_stage(one_row(1285.75), Stage(), {})
    for name, value in {SUN_ROOT: 248.31, PLANET_ROOT: 226.20, CONTACT: 1087.34}.items():
        assert found[name][0] == pytest.approx(value, rel=5e-5)


def test_a_face_carries_more_at_one_end_as_the_standard_has_it() -> None:
    """ISO 6336-1: K_Hbeta is 1 + r up to r = 1 and 2 sqrt(r) from there."""
    for ratio, factor in ((0.0, 1.0), (0.4, 1.4), (1.0, 2.0), (4.0, 4.0)):
        found = spread(np.array([ratio * 2 * 60 / 14]), np.array([14.0]), np.array([60.0]))
        assert found[0] == pytest.approx(factor, rel=3e-3)


def test_the_reducer_wears_as_the_paper_prints() -> None:
    """3.127 um after 6000 h and, with every factor at the middle of its zone, 0.698' new and 0.949' then."""
    depth = wear_after(Wearing(RATED, ROUGHNESS), np.array([0.0, 5.4e6]))
    assert depth[0] == 0
    assert depth[1] * 1e3 == pytest.approx(3.127, rel=5e-3)
    rows = rv_machine.measured("endurance", 2, np.random.default_rng(0))
    ends = ReducerRows(**{**vars(rows), "working_time": np.array([0.0, 6000.0])})
    assert shown_by_reducer(ends, {}, {})[rv_machine.BACKLASH] == pytest.approx([0.698, 0.949], abs=1.5e-3)


def test_the_screw_has_the_root_stress_of_the_design() -> None:
    """51.943 N at 10 kN on 4 mm of module 0.5 mm; no play on the drawing."""
    zero = np.zeros(2)
    rest = dict.fromkeys(("time", "screw_speed", "screw_angle", "cycles"), zero)
    read = shown_by_screw(ScrewRows(axial_load=np.array([10.0, 20.0]), temperature=zero + 20, **rest), {}, {})
    nominal = 51.943 / (4 * 0.5) * ROLLER_FACTOR
    assert read[screw_machine.ROLLER] == pytest.approx([nominal, 2 * nominal], rel=1e-5)
    assert read[screw_machine.BACKLASH] == pytest.approx([0, 0], abs=1e-9)


@pytest.mark.parametrize(
    ("dimension", "roughness", "stiffness"),
    [(2.3, 1e-11, 1.721e8), (2.4, 1e-11, 1.950e9), (2.4, 1e-10, 3.542e8), (2.5, 1e-9, 2.740e8)],
)
def test_a_pair_has_the_stiffness_of_the_closed_form(dimension: float, roughness: float, stiffness: float) -> None:
    """At 25 N; reference: the closed form of equation 6 by hand."""
    found, _ = table(dimension, roughness, 206e9 / (2 * 0.91)).at(np.array([25.0]))
    assert found[0] == pytest.approx(stiffness, rel=1e-3)


def test_the_mesh_has_the_stiffness_of_its_design() -> None:
    """60 pairs of size 20 under 25 N m: 6.56e6 N m/rad by the closed form."""
    assert Flanks().stiffness(np.array([25.0]))[0] == pytest.approx(6.56e6, rel=2e-3)


def test_a_whole_drive_turns_as_the_catalogue_prints() -> None:
    """Size 20, ratio 100: 25 kN m/rad from 7 to 25 N m and 29 from there on; rough contacts are taken off again.

    60 teeth of 2e7 N/m bend by 1/(60 k r^2), and diaphragm and seats give way by 3.57 urad/(N m).
    """
    torque = np.array([7.0, 25.0, 40.0])
    rows = replace(measured("points", 3, np.random.default_rng(0)), torque=torque, temperature=0 * torque + 20)
    others = 3.57 + 1e6 / (60 * 2e7 * RADIUS**2)
    softness = {"series_compliance": {"compliance": others - COMPLIANCE}}
    found = shown_by_drive(rows, WHOLE, softness)[TORSION]
    flanks = shown_by_drive(rows, RIGID, {"series_compliance": {"compliance": -COMPLIANCE}})[TORSION]
    assert np.diff(found - flanks) == pytest.approx([18 / 25e-3, 15 / 29e-3], rel=0.01)


def test_a_surface_has_the_structure_function_of_its_power_law() -> None:
    """D is 2.4: an exponent of 1.2; the mean of |cos|^1.2 over all directions is gamma(1.1) / (pi^0.5 gamma(1.6))."""
    level = gamma(1.1) / (pi**0.5 * gamma(1.6)) * (2 * pi) ** 1.2 * (1e-5) ** 0.8
    level *= pi / (2 * gamma(2.2) * np.sin(0.6 * pi))
    assert power() == pytest.approx(level, rel=1e-6)
    plain, blunt = (true_structure(surface(hidden=hidden), np.array([1.0, 10.0])) for hidden in ({}, BLUNT))
    assert plain == pytest.approx([level, level * 10**1.2], rel=1e-6)
    assert np.all(blunt < plain)


BLUNT = {"lateral_filter": {"width": 0.8}}
