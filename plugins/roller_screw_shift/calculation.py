"""From the profile shift to geometry, objectives and constraints, and what a pair needs before."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from gear_geometry.roots import Fillet, gap_offset, notch
from roller_screw_shift import geometry as geo
from roller_screw_shift import strength, threads
from roller_screw_shift.geometry import Geometry, involute_margin
from roller_screw_shift.quantities import Meshing, Pair
from truing import Float, feasible

# What a pair needs before it can be calculated: the sentence names the inputs and what to do

FEWEST = 8  # teeth of the ring beyond those of the roller


def require_pair(pair: Pair, geometry: Geometry) -> None:
    """Refuse pairs that do not fit into one another; NaN does not fit."""
    feasible(
        pair.ring_teeth - pair.roller_teeth >= FEWEST,
        f"the formulas hold for ring_teeth at least {FEWEST} above roller_teeth: enlarge ring_teeth",
    )
    feasible(
        np.asarray(geometry.working_angle) > 0.0,
        "the base circles are farther apart than the centres: centre_distance must exceed "
        "module * (ring_teeth - roller_teeth) * cos(pressure_angle) / 2",
    )
    feasible(
        np.asarray(geometry.mounted_angle) > 0.0,
        "the base circles are farther apart than the centres as mounted: centre_distance + centre_distance_deviation "
        "must exceed module * (ring_teeth - roller_teeth) * cos(pressure_angle) / 2",
    )
    feasible(
        geometry.roller.tip_radius > geometry.roller.base_radius,
        "the tip circle of the roller lies inside its base circle: enlarge roller_shift or addendum",
    )
    feasible(
        geometry.ring.tip_radius > geometry.ring.base_radius,
        "the tip circle of the ring lies inside its base circle: enlarge roller_shift, which the shift of the ring "
        "follows, or reduce addendum",
    )
    feasible(
        involute_margin(geometry) > 0.0,
        "involute interference: the tip of the ring would meet the roller below its base circle; enlarge roller_shift, "
        "or reduce addendum",
    )


def require_roots(pair: Pair, roller: strength.Tooth, ring: strength.Tooth, fillet: Fillet) -> None:
    """Refuse teeth without a critical section; ``fillet`` is that of the rack of the roller."""
    of_ring = gap_offset(strength.rack_of(pair, pair.ring_fillet))
    for gear, offset, cut in (("roller", fillet.offset, False), ("ring", of_ring, strength.is_cut(pair))):
        feasible(
            cut | (np.asarray(offset) >= 0.0),
            f"the rack of the {gear} is pointed before it is round: reduce {gear}_fillet, addendum or clearance",
        )
    feasible(
        ~strength.is_cut(pair) | (pair.cutter_teeth <= pair.ring_teeth - FEWEST),
        f"the cutter does not fit into the ring: cutter_teeth must be at least {FEWEST} below ring_teeth",
    )
    feasible(
        ~strength.is_cut(pair) | np.isfinite(ring.root.chord + ring.arm.height),
        "the cutter makes no such ring: its tip is pointed before it is round; reduce cutter_fillet or cutter_addendum",
    )
    feasible(
        np.isfinite(fillet.angle),
        "the fillet of the roller has no tangent of 30 degrees: reduce roller_shift or enlarge roller_teeth",
    )
    for gear, tooth in (("roller", roller), ("ring", ring)):
        feasible(
            tooth.root.chord > 0.0,
            f"the tooth of the {gear} has no thickness at its root: reduce addendum, clearance or pressure_angle",
        )
        feasible(
            (tooth.root.fillet > 0.0) & np.isfinite(tooth.root.fillet),
            f"the root of the {gear} has no radius: {gear}_fillet must be greater than 0",
        )
        feasible(
            tooth.arm.height > 0.0,
            f"the load at the tip of the {gear} has no arm about its root: enlarge addendum or clearance",
        )


def require_threads(pair: Pair, shared: threads.Sharing) -> None:
    """Refuse bodies that are not there, and threads of which no sharing of the load is found."""
    nut = threads.nut_diameter(pair)
    feasible(pair.nut_outside > nut, "the nut has no wall: nut_outside must exceed the diameter of its thread")
    feasible(pair.screw_bore < pair.screw_diameter, "the screw has no wall: reduce screw_bore")
    feasible(nut > pair.roller_diameter, "the nut is no wider than a roller: enlarge nut_diameter")
    feasible(
        np.isfinite(shared.deflection),
        "the threads find no balance: reduce roller_pitch_deviation, thread_compliance or thread_turns",
    )


# From the profile shift to geometry, objectives and constraints; one call answers for thousands of shifts


def roller_screw_shift(pair: Pair) -> Meshing:
    """The pair at one shift or at a batch of them; every Float is a number or an array (n,), SI."""
    geometry, fillet = geo.geometry_of(pair), strength.roller_fillet(pair)
    require_pair(pair, geometry)
    roller, ring = strength.roller_tooth(pair, fillet), strength.ring_tooth(pair, geometry)
    require_roots(pair, roller, ring, fillet)
    shared = threads.sharing_of(pair)
    require_threads(pair, shared)
    return _meshing(pair, geometry, fillet, roller, ring, loaded=_threads(pair, shared))


def meshing_of(pair: Pair) -> Meshing:
    """The same, but nothing is refused: NaN where a result does not exist, and a margin below 0 then or NaN.

    The threads, which do not follow the shift, are left out: NaN too.
    Where a tip circle lies inside its base circle, what depends on the angle at the tip does not exist; where the tip
    of the ring meets no involute, sliding does not.
    """
    with np.errstate(all="ignore"):
        geometry, fillet = geo.geometry_of(pair), strength.roller_fillet(pair)
        roller, ring = strength.roller_tooth(pair, fillet), strength.ring_tooth(pair, geometry)
        return _meshing(pair, geometry, fillet, roller, ring, loaded=dict.fromkeys(OF_THREADS, np.nan))


def _meshing(
    pair: Pair, geometry: Geometry, fillet: Fillet, roller: strength.Tooth, ring: strength.Tooth,
    *, loaded: Mapping[str, Any],
) -> Meshing:  # fmt: skip
    mesh = _mesh(pair, geometry)
    return Meshing(
        **_circles(geometry),
        **mesh,
        tangential_force=strength.load_of(pair).tangential_force,
        fillet_offset_roller=fillet.offset,
        fillet_height_roller=fillet.height,
        tangent_constant_roller=fillet.constant,
        tangent_angle_roller=fillet.angle,
        **_roots(roller, ring),
        **_cut(pair, ring),
        root_stress_roller=roller.stress * strength.acting(pair),
        root_stress_ring=ring.stress * strength.acting(pair) * pair.rim_factor,
        shift_sum=pair.roller_shift + geometry.ring_shift,
        stress_difference=np.abs(roller.stress - ring.stress),
        **_margins(pair, geometry, mesh),
        **loaded,
        **dict.fromkeys(("transmission_error", "wear_depth", "axial_shift", "friction_torque"), 0.0),
        backlash=geo.backlash(geometry),
    )


def _circles(geometry: geo.Geometry) -> dict[str, Any]:
    """Return angles, shifts and circles by the names of their results."""
    names = ("working_angle", "shift_difference", "ring_shift", "mounted_distance", "mounted_angle")
    found = {name: getattr(geometry, name) for name in names}
    for gear in ("roller", "ring"):
        for name in ("base_radius", "tip_radius", "root_radius", "tip_angle"):
            found[f"{name}_{gear}"] = getattr(getattr(geometry, gear), name)
    return found


def _mesh(pair: Pair, geometry: geo.Geometry) -> dict[str, Any]:
    """Return contact ratio, tips and sliding by the names of their results."""
    crossing, count = geo.crossing_of(geometry), geo.tips_count(pair)
    roots, tips = geo.sliding_at_roots(geometry), geo.sliding_at_tips(geometry)
    roller, ring = (np.maximum(root, count * tip) for root, tip in zip(roots, tips, strict=True))
    return {
        "contact_ratio": geo.contact_ratio(geometry),
        "half_angle_roller": geo.half_angle_at_tip(pair, geometry),
        "tip_land": geo.tip_land(pair, geometry),
        "crossing_cosine_roller": np.cos(crossing.roller),
        "crossing_cosine_ring": np.cos(crossing.ring),
        "crossing_angle_roller": crossing.roller,
        "crossing_angle_ring": crossing.ring,
        "tip_clearance": crossing.clearance,
        **dict(zip(("root_sliding_roller", "root_sliding_ring"), roots, strict=True)),
        **dict(zip(("tip_sliding_roller", "tip_sliding_ring"), tips, strict=True)),
        "tips_count": count,
        "sliding_roller": roller,
        "sliding_ring": ring,
        "sliding_difference": np.abs(roller - ring),
        "largest_sliding": np.maximum(np.maximum(*roots), np.maximum(*tips)),
        "ring_meshes": strength.load_of(pair).ring_meshes,
    }


def _roots(roller: strength.Tooth, ring: strength.Tooth) -> dict[str, Any]:
    """Return sections, factors and nominal stresses of both by the names of their results."""
    found: dict[str, Any] = {}
    for gear, tooth in (("roller", roller), ("ring", ring)):
        found[f"root_chord_{gear}"] = tooth.root.chord
        found[f"root_fillet_{gear}"] = tooth.root.fillet
        found[f"load_angle_{gear}"] = tooth.arm.angle
        found[f"bending_arm_{gear}"] = tooth.arm.height
        found[f"form_factor_{gear}"] = tooth.form
        found[f"notch_{gear}"] = notch(tooth.root)
        found[f"stress_correction_{gear}"] = tooth.correction
        found[f"nominal_stress_{gear}"] = tooth.stress
    return found


def _cut(pair: Pair, ring: strength.Tooth) -> dict[str, Any]:
    """Return the section that a cutter leaves by the names of its results; 0 where the ring is taken as a rack."""
    section = {"chord": ring.root.chord, "fillet": ring.root.fillet, "arm": ring.arm.height, "angle": ring.arm.angle}
    return {f"cut_{name}_ring": np.where(strength.is_cut(pair), value, 0.0) for name, value in section.items()}


NAMES = tuple(Meshing.__dataclass_fields__)
OF_THREADS = NAMES[NAMES.index("pitch") : NAMES.index("transmission_error")]


def _threads(pair: Pair, shared: threads.Sharing) -> dict[str, Any]:
    """Return what the threads do by the names of their results."""
    pitch, helix = pair.lead / pair.starts, np.arctan(pair.lead / (np.pi * pair.screw_diameter))
    nut, ratio = threads.nut_diameter(pair), pair.ring_teeth / pair.roller_teeth
    carried = pair.screw_diameter / (pair.screw_diameter + pair.roller_diameter * ratio)  # turns of the carrier
    along = np.sin(pair.contact_angle) * np.cos(helix)
    pressure = np.maximum(shared.pressure_screw, shared.pressure_nut)
    return {
        "pitch": pitch,
        "helix_angle": helix,
        "mean_thread_force": np.abs(pair.axial_load) / (pair.rollers * pair.thread_turns * along),
        "thread_share_screw": np.max(shared.screw, axis=-1),
        "thread_share_nut": np.max(shared.nut, axis=-1),
        "thread_pressure_screw": shared.pressure_screw,
        "thread_pressure_nut": shared.pressure_nut,
        "margin_pressure": 1.0 - pressure / pair.most_pressure,
        "thread_deflection": shared.deflection,
        "axial_stiffness": shared.stiffness,
        "life_factor_screw": shared.life_factor_screw,
        "life_factor_nut": shared.life_factor_nut,
        **threads.life_of(pair, shared),
        "nut_pitch_diameter": nut,
        "ratio_mismatch": nut / (pair.roller_diameter * ratio) - 1.0,
        "slip_per_turn": np.pi * (nut - pair.roller_diameter * ratio) * carried,
        "migration_per_turn": (pair.lead - pitch * ratio) * carried,
    }


# The constraints g1 to g10 of the paper and of gear geometry: above 0 is safe

MARGINS = tuple(
    name for name in Meshing.__dataclass_fields__ if name.startswith("margin_") and name != "margin_pressure"
)


def _margins(pair: Pair, geometry: Geometry, mesh: Mapping[str, Any]) -> dict[str, Any]:
    """Return the margins by the names of their results."""
    roller, ring, distance = geometry.roller, geometry.ring, geometry.mounted_distance
    clearances = {
        "margin_opposite_tips": ring.tip_radius - roller.tip_radius + distance,
        "margin_roller_root": ring.tip_radius - roller.root_radius - distance,
        "margin_ring_root": ring.root_radius - roller.tip_radius - distance,
    }
    return {
        "margin_ring_base": ring.tip_radius / ring.base_radius - 1.0,
        "margin_roller_base": roller.tip_radius / roller.base_radius - 1.0,
        "margin_contact_ratio": mesh["contact_ratio"] - pair.least_contact_ratio,
        "margin_interference": mesh["tip_clearance"] - pair.interference_margin,
        **{name: clearance / pair.module - pair.least_clearance for name, clearance in clearances.items()},
        "margin_involute": involute_margin(geometry),
        "margin_undercut": pair.roller_shift - undercut_limit(pair),
        "margin_tip_land": mesh["tip_land"] / pair.module - pair.least_tip_land,
        "margin_sliding": pair.most_sliding_difference - mesh["sliding_difference"],
    }


def undercut_limit(pair: Pair) -> Float:
    """Return the shift below which the rack undercuts the roller."""
    sine = np.sin(pair.pressure_angle)
    straight = pair.addendum + pair.clearance - pair.roller_fillet * (1.0 - sine)
    return straight - 0.5 * pair.roller_teeth * sine**2
