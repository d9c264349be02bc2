"""From duty and teeth to stresses and safeties, and how much torque and time each limit leaves."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isnan, nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gear_geometry.pairs import involute
from rv_gearing import geometry, load_factors, stress_factors
from rv_gearing.flank import FlankState, flank_state
from rv_gearing.geometry import LEAST_LINE_LOAD, Duty, GearSize, MeshSize, ToothLoad, Which
from rv_gearing.material import Cycles, GearLife, Steel, cycles_of, life_of, steel_of
from rv_gearing.quantities import Gearing
from rv_gearing.second_stage import SecondStage, second_stage
from truing import Array, Bench, Block, Float, Outcome, Sweep, Swept, Table, TruingError, found, part, results

# What the gearing calculation answers: the duty, every factor, the stresses, and what they may be
#
# Factors are declared beside the functions that calculate them and stand here as parts. All names are flat outside;
# what belongs to one gear ends with ``_sun`` or ``_planet``.

BASE = "0 in the calculation; effects act here"
PART_2 = "equation 13 of the paper; ISO 6336-2:2006, clause 5"
PART_3 = "equation 10 of the paper; GB/T 3480-1997"
BEARS_2 = "equation 14 of the paper; ISO 6336-2:2006, clause 5"
BEARS_3 = "equation 11 of the paper; ISO 6336-3:2006, clause 5"
METHOD_B = "ISO 6336-3:2006, clause 5, method B"
GEARS: tuple[Which, Which] = ("sun", "planet")
MOST_SAFETY = 1000.0  # a stage without load is that safe


@results
class GearStress:
    """Sizes, quality and factors of one gear, its stresses, what they may be, and how safe it is."""

    nominal_root_stress: Float = found(
        "MPa", symbol="sigma_F0", note="nominal root stress, load at the tip", source=PART_3,
        formula="tangential_force / (carrying_width * module) * form_factor * stress_correction"
        " * contact_ratio_factor_bending * helix_factor_bending",
    )  # fmt: skip
    root_stress: Float = found(
        "MPa", symbol="sigma_F", note="root stress, load at the tip", source=PART_3,
        formula="nominal_root_stress * application_factor * dynamic_factor * face_factor_bending"
        " * transverse_factor_bending * planet_factor_bending * tip_load_factor",
    )  # fmt: skip
    nominal_root_stress_outer: Float = found(
        "MPa", symbol="sigma_F0,B", note="nominal root stress, load at the outer single contact", source=METHOD_B,
        formula="tangential_force / (carrying_width * module) * form_factor_outer * stress_correction_outer"
        " * helix_factor_bending * deep_tooth_factor",
    )  # fmt: skip
    root_stress_outer: Float = found(
        "MPa", symbol="sigma_F,B", note="root stress, load at the outer single contact", source=METHOD_B,
        formula="nominal_root_stress_outer * application_factor * dynamic_factor * face_factor_bending"
        " * transverse_factor_bending * planet_factor_bending",
    )  # fmt: skip
    permitted_root_stress: Float = found(
        "MPa", symbol="sigma_FP", note="permitted root stress", source=BEARS_3,
        formula="bending_limit * stress_correction_of_test * bending_life_factor * notch_sensitivity * root_surface"
        " * bending_size * mean_stress_factor / least_bending_safety",
    )  # fmt: skip
    root_safety: Float = found(
        "", symbol="S_F", note="safety against breakage, load at the tip; 1000 at most", source=BEARS_3,
        formula="min(permitted_root_stress * least_bending_safety / root_stress, 1000)",
    )  # fmt: skip
    root_safety_outer: Float = found(
        "", symbol="S_F,B", note="safety against breakage, load at the outer single contact; 1000 at most",
        source=METHOD_B, formula="min(permitted_root_stress * least_bending_safety / root_stress_outer, 1000)",
    )  # fmt: skip
    contact_stress: Float = found(
        "MPa", symbol="sigma_H", note="contact stress", source=PART_2,
        formula="single_contact_factor * nominal_contact_stress * sqrt(application_factor * dynamic_factor"
        " * face_factor * transverse_factor * planet_factor)",
    )  # fmt: skip
    permitted_contact_stress: Float = found(
        "MPa", symbol="sigma_HP", note="permitted contact stress", source=BEARS_2,
        formula="contact_limit * contact_life_factor * lubricant_factor * velocity_factor * roughness_factor"
        " * work_hardening_factor * contact_size_factor / least_contact_safety",
    )  # fmt: skip
    contact_safety: Float = found(
        "", symbol="S_H", note="safety against pitting; 1000 at most", source=BEARS_2,
        formula="min(permitted_contact_stress * least_contact_safety / contact_stress, 1000)",
    )  # fmt: skip
    size: GearSize = part(GearSize, suffix="")
    quality: load_factors.GearQuality = part(load_factors.GearQuality, suffix="")
    root: stress_factors.GearRoot = part(stress_factors.GearRoot, suffix="")
    life: GearLife = part(GearLife, suffix="")


@results
class Strength:
    """The first stage under its load."""

    contact_stress: Float = found("MPa", symbol="sigma_H", note="contact stress of the sun", method="as of the sun")
    transmission_error: Float = found("um", symbol="TE", note="along the line of action", method=BASE)
    efficiency: Float = found("", symbol="eta", note="input to output", source="equations 6 and 7 of the paper",
                              formula="mesh_efficiency * bearing_efficiency**3", key=True)  # fmt: skip
    flank_temperature: Float = found("degC", symbol="theta_M", note="of the flanks", method="that of the oil")
    backlash: Float = found(
        "um", symbol="j_n", note="along the line of action; 0 at the centre distance without backlash",
        source="ISO 21771", formula="cases(0, centre_distance_deviation <= 0,"
        " (base_diameter_sun + base_diameter_planet) * (inv(working_angle) - inv(tight_angle))"
        " * cos(base_helix_angle))",
    )  # fmt: skip
    nominal_contact_stress: Float = found(
        "MPa", symbol="sigma_H0", note="nominal contact stress at the pitch point", source=PART_2,
        formula="zone_factor * elasticity_factor * contact_ratio_factor * helix_factor"
        " * sqrt(tangential_force / (reference_diameter_sun * carrying_width) * (tooth_ratio + 1) / tooth_ratio)",
    )  # fmt: skip
    contact_safety: Float = found("", symbol="S_H", note="least safety against pitting of both gears",
                                  formula="min(contact_safety_sun, contact_safety_planet)", key=True)  # fmt: skip
    root_safety: Float = found("", symbol="S_F", note="least safety against breakage of both gears, load at the tip",
                               formula="min(root_safety_sun, root_safety_planet)", key=True)  # fmt: skip
    root_safety_outer: Float = found(
        "", symbol="S_F,B", note="least safety against breakage of both gears, load at the outer single contact",
        formula="min(root_safety_outer_sun, root_safety_outer_planet)",
    )  # fmt: skip
    duty: Duty = part(Duty, suffix="")
    mesh: MeshSize = part(MeshSize, suffix="")
    quality: load_factors.MeshQuality = part(load_factors.MeshQuality, suffix="")
    steel: Steel = part(Steel, suffix="")
    stiffness: load_factors.MeshStiffness = part(load_factors.MeshStiffness, suffix="")
    dynamics: load_factors.MeshDynamics = part(load_factors.MeshDynamics, suffix="")
    planets: load_factors.PlanetSharing = part(load_factors.PlanetSharing, suffix="")
    face: load_factors.FaceLoad = part(load_factors.FaceLoad, suffix="")
    sharing: load_factors.Sharing = part(load_factors.Sharing, suffix="")
    contact: stress_factors.ContactFactors = part(stress_factors.ContactFactors, suffix="")
    bending: stress_factors.BendingFactors = part(stress_factors.BendingFactors, suffix="")
    cycles: Cycles = part(Cycles, suffix="")
    flank: FlankState = part(FlankState, suffix="")
    second: SecondStage = part(SecondStage, suffix="")
    sun: GearStress = part(GearStress, index="1")
    planet: GearStress = part(GearStress, index="2")


# From load and factors to the stresses of one gear, what they may be, and how safe it is


def gear_of(
    stage: Gearing, which: Which, shares: tuple[Float, Float], nominal: Float, *, load: ToothLoad, mesh: MeshSize,
    sizes: tuple[GearSize, GearSize], made: Sequence[load_factors.GearQuality], steel: Steel, cycles: Cycles,
    contact: stress_factors.ContactFactors, bending: stress_factors.BendingFactors,
) -> GearStress:  # fmt: skip
    """Return root, life, stresses and safeties of one gear.

    ``shares`` are the load factors behind K_A for contact and bending, ``nominal`` is the contact stress without any.
    """
    gear, place = (stage.sun, 0) if which == "sun" else (stage.planet, 1)
    root = stress_factors.root_of(stage, sizes[place], mesh, steel, which)
    life = life_of(gear, steel, getattr(cycles, f"load_cycles_{which}"), stage.mean_stress_sensitivity)
    bent = load.duty.tangential_force / (load.duty.carrying_width * stage.module) * bending.helix_factor_bending
    at_tip = bent * bending.contact_ratio_factor_bending * root.form_factor * root.stress_correction
    at_outer = bent * bending.deep_tooth_factor * root.form_factor_outer * root.stress_correction_outer
    raised = stage.application_factor * shares[1]
    stress, outer = at_tip * raised * bending.tip_load_factor, at_outer * raised
    bears = gear.bending_limit * stage.stress_correction_of_test * life.bending_life_factor * root.notch_sensitivity
    bears = bears * root.root_surface * root.bending_size * life.mean_stress_factor
    single = getattr(contact, f"single_contact_factor_{which}")
    pressed = single * nominal * np.sqrt(stage.application_factor * shares[0])
    strength = contact.lubricant_factor * contact.velocity_factor * contact.roughness_factor
    strength = strength * stage.work_hardening_factor * stage.contact_size_factor
    flank_bears = gear.contact_limit * life.contact_life_factor * strength
    return GearStress(
        nominal_root_stress=at_tip, root_stress=stress, nominal_root_stress_outer=at_outer, root_stress_outer=outer,
        permitted_root_stress=bears / stage.least_bending_safety, root_safety=safety(bears, stress),
        root_safety_outer=safety(bears, outer), contact_stress=pressed,
        permitted_contact_stress=flank_bears / stage.least_contact_safety,
        contact_safety=safety(flank_bears, pressed), size=sizes[place], quality=made[place], root=root, life=life,
    )  # fmt: skip


def safety(strength: Float, stress: Float) -> Float:
    """Return strength over stress, 1000 at most: a stage without load is that safe."""
    with np.errstate(divide="ignore"):
        return np.minimum(np.divide(strength, stress), MOST_SAFETY)


# From duty and teeth to stresses and safeties; one call answers for thousands of stages


def rv_gearing(stage: Gearing) -> Strength:
    """Strength of one stage or of a batch; every Float is a number or an array (n,), SI."""
    load = geometry.load_of(stage)
    mesh = geometry.mesh_size(stage, load)
    sun_size = geometry.gear_size(stage, load, mesh, "sun")
    sizes = sun_size, geometry.gear_size(stage, load, mesh, "planet")
    duty = load.duty
    made, quality = load_factors.quality_of(stage, sizes, mesh, duty.pitch_line_velocity)
    stiffness = load_factors.stiffness_of(stage, load, sizes, mesh.contact_ratio)
    dynamics = load_factors.dynamics_of(stage, load, sizes, mesh.total_contact_ratio, (quality, stiffness))
    planets = load_factors.planets_of(stage, duty.line_load, stiffness.mesh_stiffness)
    mean = np.maximum(duty.line_load * dynamics.dynamic_factor * planets.planet_factor, LEAST_LINE_LOAD)
    seen = (sun_size, mesh, duty.pitch_line_velocity)
    face = load_factors.face_load_of(stage, made, mean, stiffness.mesh_stiffness_face, seen)
    z_epsilon = stress_factors.contact_ratio_factor(stage, mesh)
    held = stiffness.mesh_stiffness, z_epsilon
    sharing = load_factors.sharing_of(stage, mesh, mean * face.face_factor, quality.pitch_left, held)
    contact = stress_factors.contact_factors(stage, sizes, mesh, duty.pitch_line_velocity, z_epsilon)
    bending = stress_factors.bending_factors(stage, mesh, stiffness.tooth_stiffness, duty.line_load)
    for_contact = face.face_factor * sharing.transverse_factor * planets.planet_factor
    for_bending = face.face_factor_bending * sharing.transverse_factor_bending * planets.planet_factor_bending
    shares = dynamics.dynamic_factor * for_contact, dynamics.dynamic_factor * for_bending
    steel, cycles = steel_of(stage), cycles_of(stage, load)
    nominal = stress_at_pitch_point(duty, sun_size.reference_diameter, mesh.tooth_ratio, contact)
    sun, planet = (
        gear_of(stage, which, shares, nominal, load=load, mesh=mesh, sizes=sizes, made=made, steel=steel, cycles=cycles,
                contact=contact, bending=bending)
        for which in GEARS
    )  # fmt: skip
    return Strength(
        contact_stress=sun.contact_stress, transmission_error=0.0 * duty.tangential_force, efficiency=load.efficiency,
        flank_temperature=stage.oil_temperature, backlash=backlash_of(stage, load, mesh),
        nominal_contact_stress=nominal, contact_safety=np.minimum(sun.contact_safety, planet.contact_safety),
        root_safety=np.minimum(sun.root_safety, planet.root_safety),
        root_safety_outer=np.minimum(sun.root_safety_outer, planet.root_safety_outer), duty=duty, mesh=mesh,
        quality=quality, steel=steel, stiffness=stiffness, dynamics=dynamics, planets=planets, face=face,
        sharing=sharing, contact=contact, bending=bending, cycles=cycles, sun=sun, planet=planet,
        second=second_stage(stage, load, mesh.centre_distance),
        flank=flank_state(stage, duty, mesh, sizes, dynamics.dynamic_factor * for_contact),
    )  # fmt: skip


def stress_at_pitch_point(duty: Duty, diameter: Float, u: Float, contact: stress_factors.ContactFactors) -> Float:
    """Return the nominal contact stress at the pitch point, Pa, for the reference diameter of the sun, m."""
    factors = contact.zone_factor * contact.elasticity_factor * contact.contact_ratio_factor * contact.helix_factor
    return factors * np.sqrt(duty.tangential_force / (diameter * duty.carrying_width) * (u + 1.0) / u)


def backlash_of(stage: Gearing, load: ToothLoad, mesh: MeshSize) -> Float:
    """Return the backlash along the line of action, m: 0 unless the gears are farther apart than without it."""
    opened = (
        2.0 * (load.base_radii[0] + load.base_radii[1]) * (involute(mesh.working_angle) - involute(mesh.tight_angle))
    )
    return np.where(stage.centre_distance_deviation <= 0.0, 0.0, opened * np.cos(mesh.base_helix_angle))


# Studies of our own: how much torque and time each limit leaves, and how the safeties run along one input


HOUR = 3600.0
SPAN = 1e4  # a limit is sought between the load as it is over SPAN and times SPAN
HALVINGS = 60
LIMITS = {
    "root_safety_sun": "breakage of the sun",
    "root_safety_planet": "breakage of the planet",
    "contact_safety_sun": "pitting of the sun",
    "contact_safety_planet": "pitting of the planet",
    "contact_rise": "scuffing",
}
SAFETIES = tuple(name for name in LIMITS if "safety" in name)
HEAT = ("contact_rise", "permitted_contact_rise")
AROUND = {  # unit in SI, and the range as parts of the value
    "load_torque": ("N*m", 0.1, 2.0), "stated_sun_torque": ("N*m", 0.1, 2.0), "power": ("W", 0.1, 2.0),
    "face_width": ("m", 0.5, 2.0), "working_life": ("s", 0.1, 10.0),
}  # fmt: skip
SOUGHT = "bisection on the whole calculation"


@results
class Rating:
    """What the first stage may be loaded with."""

    torque_capacity: Float = found(
        "N*m", symbol="T_2,max", note="output torque at which the first safety or the distance to scuffing is used up",
        method=SOUGHT, key=True,
    )  # fmt: skip
    power_capacity: Float = found("kW", symbol="P_max", note="input power at this torque and the speed of the run",
                                  method="in proportion to the torque", key=True)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Capacity:
    """Find the output torque, and the working time, at which each safety falls to what is asked of it.

    Against scuffing the permitted rise of the contact over the one reached counts as a safety, and 1 is asked of it.
    """

    name: str = "capacity"
    gives: Callable[[Any], Any] | None = None

    def run(self, bench: "Bench") -> "Reserve":
        """Bisect on torque and on time for all limits at once."""
        stage: Gearing = bench.inputs
        stated = not isnan(float(stage.stated_sun_torque))
        torque = float(bench.answers["output_torque"]) or 1.0
        sun = float(bench.answers["sun_torque"]) or 1.0
        column, start = ("stated_sun_torque", sun) if stated else ("load_torque", torque)
        life = float(stage.working_life)
        speed, power = float(bench.answers["sun_speed"]), 2.0 * np.pi * float(bench.answers["sun_torque"])
        return Reserve(
            inputs=stage,
            safeties=_safeties({name: np.full(len(LIMITS), float(bench.answers[name])) for name in (*SAFETIES, *HEAT)}),
            required=_required(stage),
            torque=torque * _used_up(bench, column, start, bench.part(self.name, 0.0, 0.5)),
            life=life * _used_up(bench, "working_life", life, bench.part(self.name, 0.5, 1.0)),
            power_per_torque=power * speed / float(bench.answers["output_torque"] or nan),
        )


def _required(stage: Gearing) -> "Array":
    bending, contact = float(stage.least_bending_safety), float(stage.least_contact_safety)
    return np.array([bending, bending, contact, contact, 1.0])


def _safeties(rows: Mapping[str, "Array"]) -> "Array":
    """The safety of every limit from a row of its own; that against scuffing is what may be over what is."""
    with np.errstate(divide="ignore"):
        heat = np.divide(rows[HEAT[1]][-1], rows[HEAT[0]][-1])
    return np.array([*(rows[name][place] for place, name in enumerate(SAFETIES)), heat])


def _used_up(bench: "Bench", column: str, start: float, done: Callable[[int, int], None]) -> "Array":
    """By what factor on the column each safety falls to what is asked; infinite where never, 0 where always below."""
    required = _required(bench.inputs)
    low, high = np.full(len(LIMITS), -np.log(SPAN)), np.full(len(LIMITS), np.log(SPAN))

    def enough(factors: "Array") -> "NDArray[np.bool_]":
        return _safeties(bench.rows({column: start * np.exp(factors)}, len(LIMITS), *SAFETIES, *HEAT)) >= required

    never, always = enough(high), np.logical_not(enough(low))
    for halving in range(HALVINGS):
        done(halving, HALVINGS)
        middle = 0.5 * (low + high)
        holds = enough(middle)
        low, high = np.where(holds, middle, low), np.where(holds, high, middle)
    return np.where(never, np.inf, np.where(always, 0.0, np.exp(low)))


@dataclass(frozen=True, kw_only=True)
class Reserve(Outcome):
    """By limit (5,): safety, what is asked, and torque (N m) and time (s) at which they meet; infinite where never."""

    inputs: Gearing
    safeties: "Array"
    required: "Array"
    torque: "Array"
    life: "Array"
    power_per_torque: float

    @property
    def governing(self) -> str:
        """The limit that is met first as the torque grows."""
        return LIMITS[tuple(LIMITS)[int(np.argmin(self.torque))]]

    def as_json(self) -> Mapping[str, Any]:
        """Return safety, limit, torque and time of every limit; null where it is never met."""
        return {
            "governing": self.governing,
            "limits": {
                name: {
                    "safety": float(self.safeties[place]),
                    "required": float(self.required[place]),
                    "output_torque": {"value": _finite(self.torque[place]), "unit": "N*m"},
                    "working_life": {"value": _finite(self.life[place] / HOUR), "unit": "h"},
                }
                for place, name in enumerate(LIMITS)
            },
        }

    def blocks(self) -> Sequence[Block]:
        """Return the limits as a table."""
        rows = [
            (
                LIMITS[name],
                float(self.safeties[place]),
                float(self.required[place]),
                _finite(self.torque[place]) or _beyond(self.torque[place]),
                _finite(self.life[place] / HOUR) or _beyond(self.life[place]),
            )
            for place, name in enumerate(LIMITS)
        ]
        return [
            Table(
                "What uses up each safety",
                ("limit", "safety", "asked", "at an output torque of", "or after"),
                rows,
                ("", "", "", "N*m", "h"),
                f"Everything else as stated. {self.governing[0].upper() + self.governing[1:]} comes first.",
            )
        ]


def _finite(value: Any) -> float | None:
    return float(value) if 0.0 < value < np.inf else None


def _beyond(value: Any) -> str:
    return "never" if value > 0.0 else "always below"


def rating(reserve: Reserve) -> Rating:
    """The torque that may be, and the power that goes with it."""
    torque = float(np.min(reserve.torque))
    return Rating(
        torque_capacity=torque if np.isfinite(torque) else nan,
        power_capacity=torque * reserve.power_per_torque if np.isfinite(torque) else nan,
    )


@dataclass(frozen=True, kw_only=True)
class Safeties(Sweep):
    """How the four safeties run along one input; without ``at`` from a part of its value in the run to a multiple.

    Where the torque of the sun is stated, a load torque means nothing; then the stated one takes its place.
    """

    at: str = ""
    points: int = 49
    name: str = "safeties"

    def run(self, bench: "Bench") -> Swept:
        """Sweep the input, and keep the safeties of the two gears alone."""
        stated = float(bench.inputs.stated_sun_torque)
        at_sun = self.over == "load_torque" and stated > 0.0
        over = "stated_sun_torque" if at_sun else self.over
        at = self.at if self.at and not at_sun else _around(bench, over, self.name)
        swept = Sweep(over=over, at=at, points=self.points, name=self.name).run(bench)
        kept = {name: swept.results[name] for name in SAFETIES if name in swept.results}
        return replace(swept, results=kept, shown=False)


def _around(bench: "Bench", over: str, study: str) -> str:
    """A range around the value of the run."""
    if over not in AROUND:
        raise TruingError(f"study '{study}': write at = \"low..high unit\", the range of {over}")
    unit, least, most = AROUND[over]
    answer = bench.answers["output_torque"] if over == "load_torque" else getattr(bench.inputs, over)
    value = abs(float(answer)) or 1.0
    return f"{least * value!r}..{most * value!r} {unit}"
