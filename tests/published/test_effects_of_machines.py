"""What each effect of a plugin does, against a machine that was written apart from the plugin.

The machines of the benchmark import nothing of a plugin, and most of what they do is not the formula of the effect:
links move on complex numbers, load is spread strip by strip, wear and heat are summed step by step. The last number of
a case says how far both may be apart, as a share of the largest change: what those sums leave, and not more.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from hidden_effects import gearing_machine, harmonic_machine, press_machine, rv_machine, screw_machine
from hidden_effects.clear import REDUCED, STAGES
from hidden_effects.gearing_machine import Stage
from hidden_effects.rigs import model_of
from hidden_effects.rows import Array
from truing.evaluate import evaluate_rows
from truing.setup import SwitchedOn, default_setup
from truing.units import from_si, to_si

Unknowns = Mapping[str, Mapping[str, float]]
SI = ""
COUNT = 60


def press_rows(_: str) -> press_machine.Rows:
    """All round the turn, in either direction, some without load, over some hours and strokes."""
    rng = np.random.default_rng(11)
    return press_machine.Rows(
        time=np.sort(rng.uniform(0, 3e4, COUNT)),
        crank_angle=np.radians(rng.uniform(-175, 175, COUNT)),
        forming_force=np.where(np.arange(COUNT) % 6 == 0, 0.0, rng.uniform(-3e5, 1.5e6, COUNT)),
        link_temperature=rng.uniform(15, 50, COUNT),
        strokes=np.sort(rng.uniform(0, 1e6, COUNT)),
        speed=rng.uniform(0.1, 0.9, COUNT),
        direction=rng.choice([-1.0, 1.0], COUNT),
    )


def screw_rows(design: str) -> screw_machine.Rows:
    """As on the bench, under loads of either sign."""
    rng = np.random.default_rng(3)
    rows = screw_machine.measured(design, COUNT, rng)
    return replace(rows, axial_load=rows.axial_load * rng.choice([-1.0, 1.0], COUNT))


@dataclass(frozen=True, kw_only=True)
class Machine:
    """A machine with its plugin: rows of a design, what its gauges show, and the units of columns and results.

    ``unit`` is that of the unknowns of the press, which are SI; those of the others have the units of the registry.
    """

    plugin: str
    rows: Callable[[Any], Any]
    shown: Callable[[Any, Unknowns], Mapping[str, Array]]
    columns: Mapping[str, str]
    results: Mapping[str, str]
    inputs: Mapping[str, Any]
    unit: str | None = None

    def change(self, design: str, hidden: Unknowns, stated: Mapping[str, Any]) -> dict[str, tuple[Array, Array]]:
        """What the effects do to each result: by the plugin and by the machine, in the units of the results."""
        model, rows = model_of(self.plugin), self.rows(design)
        setup = default_setup(model, **{**self.inputs, **stated})
        columns = {name: np.asarray(to_si(getattr(rows, name), unit)) for name, unit in self.columns.items()}
        on = tuple(SwitchedOn(model.effects[name], self.si(name, unknowns)) for name, unknowns in hidden.items())
        known = {*model.input_fields, *(need.name for effect in on for need in effect.effect.needs)}
        given = {name: values for name, values in columns.items() if name in known}
        bare = {name: values for name, values in given.items() if name in model.input_fields}
        with_it, without = (
            evaluate_rows(each, named, len(rows), reading=True)
            for each, named in ((replace(setup, effects=on), given), (setup, bare))
        )
        assert not with_it.failed.any()
        hanging = {"hanging": stated_of_machine(stated)} if stated else {}
        there, before = self.shown(rows, {**hidden, **hanging}), self.shown(rows, {})
        return {
            name: (np.asarray(from_si(with_it.results[name], unit)) - from_si(without.results[name], unit),
                   there[name] - before[name])
            for name, unit in self.results.items()
        }  # fmt: skip

    def si(self, effect: str, unknowns: Mapping[str, float]) -> dict[str, float]:
        """All unknowns of an effect in SI; those that a case leaves out are 0."""
        declared = model_of(self.plugin).effects[effect].unknowns
        return {
            each.name: float(to_si(unknowns.get(each.name, 0.0), each.unit if self.unit is None else self.unit))
            for each in declared
        }


def stated_of_machine(stated: Mapping[str, Any]) -> dict[str, float]:
    """What hangs on the slider, kg, and what lifts it, N."""
    return {
        "mass": 1e3 * float(stated["slider_mass"].split()[0]),
        "lift": 1e3 * float(stated["counterbalance"].split()[0]),
    }


PRESS = Machine(
    plugin="press_linkage", rows=press_rows, shown=lambda rows, hidden: press_machine.shown(rows, {}, hidden),
    columns={"time": SI, "crank_angle": SI, "forming_force": SI, "link_temperature": "degC", "strokes": SI,
             "speed": SI, "direction": SI},
    results={"slider_position": SI, "slider_tilt": SI}, inputs={}, unit=SI,
)  # fmt: skip
GEARING = Machine(
    plugin="rv_gearing", rows=lambda design: gearing_machine.measured(design, COUNT, np.random.default_rng(3)),
    shown=lambda rows, hidden: gearing_machine.shown(rows, Stage(), hidden), columns=gearing_machine.STAGE.written,
    results=gearing_machine.UNIT, inputs={"sun_teeth": 20, "planet_teeth": 55},
)  # fmt: skip
REDUCER = Machine(
    plugin="rv_wear", rows=lambda design: rv_machine.measured(design, COUNT, np.random.default_rng(3)),
    shown=lambda rows, hidden: rv_machine.shown(rows, {}, hidden), columns=rv_machine.REDUCER.written,
    results=rv_machine.UNIT, inputs={},
)  # fmt: skip
SCREW = Machine(
    plugin="roller_screw_shift", rows=screw_rows, shown=lambda rows, hidden: screw_machine.shown(rows, {}, hidden),
    columns=screw_machine.SCREW.written, results=screw_machine.UNIT, inputs={},
)  # fmt: skip
DRIVE = Machine(
    plugin="harmonic_fractal", rows=lambda design: harmonic_machine.measured(design, COUNT, np.random.default_rng(3)),
    shown=lambda rows, hidden: harmonic_machine.shown(rows, harmonic_machine.RIGID, hidden),
    columns=harmonic_machine.PAST | harmonic_machine.LOGS, results=harmonic_machine.UNIT,
    inputs={"fractal_dimension": 2.5, "fractal_roughness": "1e-9 m", "reference_torque": "20 mN*m",
            "drive_compliance": "36 urad/(N*m)"},
)  # fmt: skip
WHOLE_DRIVE = replace(
    DRIVE, shown=lambda rows, hidden: harmonic_machine.shown(rows, harmonic_machine.WHOLE, hidden),
    inputs={**DRIVE.inputs, "cup_length": "28 mm", "wave_torsion_stated": "752 urad"},
)  # fmt: skip
HEAT = {"link_heating": {"expansion": 1.15e-5}}
HANGING = {"slider_mass": "20 t", "counterbalance": "150 kN"}
LOOSE = {"joint_clearance": {"clearance": 2e-5}}
SOFT = {"elastic_deflection": {"compliance": 1e-9}}
AHEAD = {"encoder_eccentricity": {"sine": 0.003, "cosine": -0.007}}
EXACT, SLOPE, SUMMED, WORN, HARMONIC, WAVE, FILMS = 1e-9, 1.5e-5, 1e-3, 0.01, 0.02, 0.045, 0.05
PRESSES: list[tuple[Unknowns, float, dict[str, str]]] = [
    (HEAT, EXACT, {}),
    ({"side_heating": {"expansion_1": 1.4e-5, "expansion_2": -3e-6}}, EXACT, {}),
    ({"warm_up": {"rise": 4e-4, "time_constant": 7200.0}}, EXACT, {}),
    ({"crank_phase": {"phase": 0.012}}, EXACT, {}),
    (AHEAD, EXACT, {}),
    ({"drive_backlash": {"play_before": 0.004, "play_after": 0.009}}, EXACT, {}),
    (SOFT, SLOPE, {}),
    (SOFT, SLOPE, HANGING),
    (LOOSE, SLOPE, {}),
    (LOOSE, SLOPE, HANGING),
    ({"joint_wear": {"wear": 3e-4}}, SLOPE, HANGING),
    ({"slider_inertia": {"mass_compliance": 5e-6}}, SLOPE, {}),
    ({"die_inclination": {"inclination": 7e-5, "height": -3e-5}}, EXACT, {}),
    (HEAT | AHEAD | SOFT, 2e-4, {}),  # the plugin shortens links of their nominal length
]
WITHIN = {
    **dict.fromkeys(("sun_runout", "planet_runout", "mesh_ripple", "output_eccentricity", "film_lubrication"), WAVE),
    **dict.fromkeys(("structural_resonance", "planet_load_sharing", "crowned_contact", "relief_error"), SUMMED),
    **dict.fromkeys(("face_misalignment", "centre_distance_growth", "wind_up", "wear_drift"), SUMMED),
    **dict.fromkeys(("ratio_drift", "mesh_stiffening"), SUMMED), "lost_motion": 0.02, "pin_drag": FILMS,
    **dict.fromkeys(("runout", "disc_phase"), HARMONIC), "toothing_runout": FILMS,
    **dict.fromkeys(("running_in", "bearing_wear", "stiffening", "pin_pass_ripple", "friction_hysteresis"), EXACT),
}  # fmt: skip
"""How near the machine comes to the plugin, over the largest change: 1 % where heat or wear is summed otherwise.

2 % where the play is of first order, 5 % where each pin has a film of its own, and where the toothings of both discs
differ, of which the effect knows the mean; pins without a film are within the sum over them.
"""
DRY_PINS = {"pin_drag": {"friction": 0.02, "film_speed": 1e5}}
DISCS = {"pin_pass_ripple": {"disc_cosine": 0.03, "disc_sine": -0.02}}
SCREWS: list[tuple[Unknowns, float]] = [
    ({"face_misalignment": {"misalignment": 1.5}}, SUMMED),
    ({"face_misalignment": {"misalignment": 8.0, "per_load": 0.1}}, SUMMED),
    ({"mesh_resonance": {"excitation": 0.06, "resonance_speed": 1800, "damping": 0.06}}, HARMONIC),
    ({"roller_load_sharing": {"lead": 0.2}}, SLOPE),
    ({"roller_load_sharing": {"lead": -0.4}}, SLOPE),  # it lifts off under small loads
    ({"interrupted_tooth": {"lost": 0.3, "phase": 300}}, HARMONIC),
    ({"rim_compliance": {"softness": 0.6}}, SLOPE),
    ({"soft_threads": {"compliance": 20.0}}, SLOPE),
    ({"roller_pitch_error": {"deviation": 0.3}}, SLOPE),
    ({"roller_pitch_error": {"deviation": 0.1}, "soft_threads": {"compliance": 1.0}}, SLOPE),
    ({"thermal_centre_distance": {"expansion": 11.5}}, EXACT),
    ({"roller_runout": {"cosine": 3, "sine": -2}}, SUMMED),
    ({"carrier_runout": {"cosine": 3, "sine": -2}}, SUMMED),
    ({"axial_migration": {"mismatch": 0.05}}, SUMMED),
    ({"flank_wear": {"rate": 2}}, EXACT),
    ({"mesh_friction": {"factor": 1.5}}, SUMMED),
]
DRIVES: list[tuple[Unknowns, float, str]] = [
    ({"series_compliance": {"compliance": 12}}, EXACT, "loops"),
    ({"engaged_pairs": {"gain": 1.8, "torque_scale": 0.8}}, SUMMED, "points"),
    ({"oil_film": {"stiffness": 0.03}}, WAVE, "points"),
    ({"asperity_smoothing": {"dimension": 0.03, "roughness": 0.6, "cycle_scale": 2e5}}, SUMMED, "points"),
    ({"modulus_temperature": {"softening": 8e-4}}, HARMONIC, "loops"),
    ({"creep": {"share": 0.03, "time_scale": 0.1}}, 2e-5, "loops"),
    ({"ellipticity": {"cosine": 20, "sine": -25}}, HARMONIC, "loops"),
    ({"ellipticity": {"stiffness_cosine": 0.08, "stiffness_sine": 0.06}}, 0.022, "points"),
    ({"eccentricity": {"cosine": -16, "sine": 20}}, SUMMED, "loops"),
    ({"hysteresis": {"loop": 200, "torque_scale": 0.16}}, HARMONIC, "loops"),
    ({"viscous_hysteresis": {"loop": 100, "torque_scale": 0.2, "thinning": 0.03}}, 0.03, "loops"),
    ({"lost_motion": {"play": 60, "torque_scale": 0.12}}, HARMONIC, "loops"),
    ({"first_load_set": {"set": 40, "exponent": 1.2}}, EXACT, "loops"),
    ({"first_load_set": {"stiffening": 0.3}}, SLOPE, "points"),
    ({"flank_wear": {"rate": 1.0, "torque_scale": 0.08}}, HARMONIC, "loops"),
    ({"thermal_preload": {"expansion": 3}}, EXACT, "loops"),
    ({"rig_drift": {"rate": 6}}, EXACT, "loops"),
]
CASES: list[tuple[Machine, Unknowns, float, str, dict[str, str]]] = [
    *((PRESS, hidden, within, "", stated) for hidden, within, stated in PRESSES),
    *((GEARING, wish.hidden, WITHIN.get(*wish.hidden, WORN), wish.design, {}) for wish in STAGES),
    (GEARING, DRY_PINS, SUMMED, "one_way", {}),
    *((REDUCER, wish.hidden, (WITHIN | {"wind_up": EXACT}).get(*wish.hidden, WORN), "fleet", {}) for wish in REDUCED),
    (REDUCER, DISCS, EXACT, "fleet", {}),
    *((SCREW, hidden, within, "endurance" if "flank_wear" in hidden else "bench", {}) for hidden, within in SCREWS),
    *((DRIVE, hidden, within, design, {}) for hidden, within, design in DRIVES),
    (WHOLE_DRIVE, {"thin_cup": {"lost": 0.3}}, 1e-4, "loops", {}),  # the wall is thin beside its radius
    (WHOLE_DRIVE, {"modulus_temperature": {"softening": 8e-4}}, HARMONIC, "loops", {}),
    (WHOLE_DRIVE, {"creep": {"share": 0.03, "time_scale": 0.1}}, 3e-5, "loops", {}),
    (WHOLE_DRIVE, {"soft_wave_generator": {"torsion": 200}}, SLOPE, "loops", {}),
]


@pytest.mark.parametrize(
    ("machine", "hidden", "within", "design", "stated"), CASES, ids=["+".join(case[1]) for case in CASES]
)
def test_an_effect_does_what_the_machine_shows(
    machine: Machine, hidden: Unknowns, within: float, design: str, stated: dict[str, str]
) -> None:
    moved = False
    for name, (ours, theirs) in machine.change(design, hidden, stated).items():
        most = float(np.max(np.abs(theirs)))
        moved = moved or most > 0
        assert ours == pytest.approx(theirs, rel=0, abs=max(within * most, 1e-12)), name
    assert moved
