"""Torsional vibration of the mesh after figures 1 and 2 of the patent: two inertias, stiffness K, damping, clearance b.

Along the line of action, with y the distance by which the flexspline is turned ahead of the circular spline (the
dynamic transmission error) and e the error that the teeth bring in by themselves:

    m y'' + c (y' - e') + K (1 + epsilon cos phase) f(y - e) = F + F_1 cos phase,    e = e_1 cos phase

f is the backlash function of figure 2. K and b are those of the rough flanks, by the calculation of the drive.
"""

from dataclasses import dataclass, fields, replace
from typing import Any, Literal

import numpy as np

from harmonic_fractal import contact as rough_contact
from harmonic_fractal.calculation import require_surface
from harmonic_fractal.flank import Flank, read_flank
from harmonic_fractal.mesh import load_of_largest, mesh_of, normal_stiffness
from harmonic_fractal.quantities import Drive, Material
from harmonic_fractal.vibration_response import backlash
from truing import (
    Dynamics,
    Event,
    Float,
    Motion,
    axis,
    column,
    either,
    feasible,
    found,
    given,
    inputs,
    loaded,
    part,
    results,
    state,
    states,
)

FIGURE_1 = "figure 1 of the patent"
FIGURE_2 = "figure 2 of the patent"


def of_drive(name: str, **changes: Any) -> Any:
    """Declare an input as the drive has it, with another default where one is given."""
    (declared,) = (each for each in fields(Drive) if each.name == name)
    return given(**vars(declared.metadata["truing"]) | changes)


@inputs
class GearPair:
    """Figure 1: flexspline and circular spline with their mesh, whose flanks are rough, and what makes it vibrate."""

    # The flanks and their materials
    surface: Flank | None = loaded(read_flank, default=None, note="measured flank of the flexspline, as of the drive")
    fractal_dimension: Float = of_drive("fractal_dimension", note="fractal dimension of both flanks together")
    fractal_roughness: Float = of_drive("fractal_roughness", note="fractal roughness of both flanks together, in the "
                                        "convention stated beside it")  # fmt: skip
    convention: Literal["areal", "one_direction", "profile"] = of_drive("convention")
    density: Float = of_drive("density")
    patch_length: Float = of_drive("patch_length")
    peak_height: Float = of_drive("peak_height")
    flexspline: Material = part(Material, index="1")
    circular: Material = part(Material, index="2")
    hardness: Float = of_drive("hardness")
    critical_rule: Literal["hardness", "yield_onset"] = of_drive("critical_rule")
    # The mesh
    pitch_radius: Float = of_drive("pitch_radius")
    pressure_angle: Float = of_drive("pressure_angle")
    flexspline_teeth: int = of_drive("flexspline_teeth")
    engaged_pairs: int = of_drive("engaged_pairs")
    tooth_stiffness: Float = of_drive(
        "tooth_stiffness", default=2e7, source="typical: 1e7 to 1e8 N/m",
        note="bending of the teeth and rim of one pair, in series with its contact",
    )  # fmt: skip
    stated_stiffness: Float = given(None, "N/m", symbol="K_0", note="stiffness of the whole mesh along its normals "
                                    "where it is known otherwise; else that of flanks and teeth", above=0)  # fmt: skip
    stiffness_variation: Float = given(0.0, "", symbol="epsilon", note="wave of the stiffness over a mesh, as a share "
                                       "of it; small where dozens of pairs engage", at_least=0, below=1)  # fmt: skip
    # Its clearance
    form_clearance: Float = given(0.5, "um", symbol="j", note="play along the line of action by tooth form, assembly "
                                  "and wear, from flank to flank", source="1 arcmin of lost motion is 7 um",
                                  at_least=0, at_most=1e4)  # fmt: skip
    roughness_clearance: Literal["closing", "printed", "none"] = given(
        "closing", note="what roughness adds to either side: the distance of the mean planes that is left under the "
        "load, equation 7 as printed, or nothing",
    )  # fmt: skip
    reference_torque: Float = of_drive("reference_torque", default=50.0)
    # What vibrates
    ring_inertia: Float = given(5e-5, "kg*m^2", symbol="J_1", note="moment of inertia of the toothed ring of the "
                                "flexspline; the load hangs behind the soft cup", source="steel ring, size 20",
                                above=0, at_most=1e4)  # fmt: skip
    circular_inertia: Float = given(None, "kg*m^2", symbol="J_2", note="moment of inertia of the circular spline and "
                                    "what turns with it; not given: it is held", above=0)  # fmt: skip
    circular_lever: Float = given(None, "mm", symbol="r_2", note="lever of the normal force about the axis of the "
                                  "circular spline; else that of the flexspline", above=0)  # fmt: skip
    damping_ratio: Float = given(0.03, "", symbol="zeta_0", note="damping of the mesh in parts of the critical one",
                                 source="typical: 0.02 to 0.07", above=0, below=1)  # fmt: skip
    oil_damping: Float = given(0.0, "N*s/m", symbol="c_oil", note="damping by oil between the flanks, neutral; effects "
                               "act here", at_least=0)  # fmt: skip
    # What makes it vibrate
    torque: Float = of_drive("torque", default=5.0, note="mean torque at the output", source="a fifth of T_2", above=0,
                             at_least=None)  # fmt: skip
    torque_wave: Float = given(0.0, "N*m", symbol="T_1", note="wave of the torque over a mesh", at_least=0)
    error_amplitude: Float = given(0.1, "um", symbol="e_1", note="wave of the transmission error over a mesh",
                                   source="typical", at_least=0, at_most=1e3)  # fmt: skip
    mesh_order: Float = given(None, "", symbol="z_m", note="meshes per turn of the wave generator; else the teeth of "
                              "the circular spline, two more than those of the flexspline", above=0,
                              at_most=1e4)  # fmt: skip


@results
class Mesh:
    """The oscillator that the flanks make: stiffness, clearance, mass, and what follows before anything moves."""

    effective_radius: Float = found("mm", symbol="r_n", note="lever of the normal force about the axis",
                                    formula="pitch_radius * cos(pressure_angle)")  # fmt: skip
    mean_force: Float = found("N", symbol="F", note="mean normal force of the mesh",
                              formula="torque / effective_radius")  # fmt: skip
    pair_force: Float = found("N", symbol="F_1", note="of the pair that carries most",
                              method="load shares by the square of the cosine along two opposite arcs")  # fmt: skip
    pair_stiffness: Float = found("N/m", symbol="K_p", note="stiffness of the rough contact of that pair",
                                  source="equation 6 of the patent", method="as of the drive")  # fmt: skip
    rough_stiffness: Float = found("N/m", symbol="K_r", note="stiffness of all pairs if only their rough contacts gave "
                                   "way", method="sum over the engaged pairs")  # fmt: skip
    mesh_stiffness: Float = found("N/m", symbol="K", note="stiffness of the mesh along its normals at the torque",
                                  method="as stated, else sum over the engaged pairs, each in series with its tooth",
                                  key=True
                                  )  # fmt: skip
    rough_share: Float = found("%", symbol="q_r", note="share of the compliance of the mesh that is of rough contacts",
                               formula="mesh_stiffness / rough_stiffness", key=True)  # fmt: skip
    rough_clearance: Float = found("nm", symbol="b_r", note="clearance by roughness, to either side",
                                   method="by roughness_clearance")  # fmt: skip
    clearance: Float = found("um", symbol="b", note="clearance of the backlash function, to either side",
                             source=FIGURE_2, formula="form_clearance / 2 + rough_clearance", key=True)  # fmt: skip
    wave_force: Float = found("N", symbol="F_2", note="wave of the force of the mesh by that of the torque, which acts "
                              "on the flexspline",
                              formula="effective_mass * effective_radius * torque_wave / ring_inertia")  # fmt: skip
    deflection: Float = found("um", symbol="delta", note="static deflection of the mesh",
                              formula="mean_force / mesh_stiffness")  # fmt: skip
    effective_mass: Float = found("kg", symbol="m", note="mass of both inertias along the line of action",
                                  source=FIGURE_1, method="1/(r_n^2/J_1 + r_2^2/J_2)")  # fmt: skip
    damping: Float = found("", symbol="zeta", note="damping ratio of mesh and oil",
                           formula="damping_ratio + oil_damping / (2 * sqrt(mesh_stiffness * effective_mass))"
                           )  # fmt: skip
    natural_frequency: Float = found("Hz", symbol="f_n", note="natural frequency in contact, undamped",
                                     formula="sqrt(mesh_stiffness / effective_mass) / (2 * pi)", key=True)  # fmt: skip
    order: Float = found("", symbol="z", note="meshes per turn of the wave generator",
                         method="as stated, else teeth of the circular spline")  # fmt: skip
    resonance_speed: Float = found("rpm", symbol="n_0", note="speed of the wave generator at which the mesh frequency "
                                   "is the natural one",
                                   formula="natural_frequency / order", key=True)  # fmt: skip


SHARED = [each.name for each in fields(GearPair) if each.name in {one.name for one in fields(Drive)}]
DRIVE = Drive()


def drive_of(pair: GearPair) -> Drive:
    """Return the drive whose flanks and mesh these are."""
    return replace(DRIVE, **{name: getattr(pair, name) for name in SHARED})


def effective_radius(pair: GearPair) -> Float:
    """Return the lever of the normal force about the axis of the flexspline, m."""
    return pair.pitch_radius * np.cos(pair.pressure_angle)


def effective_mass(pair: GearPair) -> Float:
    """Return the mass of both inertias along the line of action, kg; that of the flexspline where the other is held."""
    lever = either(pair.circular_lever, effective_radius(pair))
    held = either(np.square(lever) / pair.circular_inertia, 0.0)
    return 1.0 / (np.square(effective_radius(pair)) / pair.ring_inertia + held)


def order_of(pair: GearPair) -> Float:
    """Return how often teeth mesh per turn of the wave generator."""
    return either(pair.mesh_order, pair.flexspline_teeth + 2.0)


def torque_wave_force(pair: GearPair) -> Float:
    """Return the wave of force by that of the torque on the flexspline, N: the part that reaches the mesh."""
    return effective_mass(pair) * effective_radius(pair) * pair.torque_wave / pair.ring_inertia


def mesh_quantities(pair: GearPair) -> dict[str, Float]:
    """Return the results of ``Mesh`` by name; every Float is a number or an array (n,), SI."""
    drive = drive_of(pair)
    rough = rough_contact.interface_of(drive)
    require_surface(drive, rough)
    contact = rough_contact.contact_of(drive, rough)
    mesh = mesh_of(drive, contact)
    alone = replace(mesh, pair=replace(mesh.pair, compliance=0.0))
    force, radius = load_of_largest(pair.torque, mesh), mesh.radius
    stiffness = either(pair.stated_stiffness, normal_stiffness(pair.torque, mesh))
    feasible(
        np.asarray(stiffness) > 0.0,
        "all contacts are plastic at this torque, and the mesh has no stiffness: raise torque, or reduce "
        "fractal_roughness",
    )
    mass, gap = effective_mass(pair), clearance_by_roughness(pair, contact, force)
    natural = np.sqrt(stiffness / mass)
    order = order_of(pair)
    rough_alone = normal_stiffness(pair.torque, alone)
    return {
        "effective_radius": radius,
        "mean_force": pair.torque / radius,
        "pair_force": force,
        "pair_stiffness": rough_contact.pressed(force, contact).stiffness,
        "rough_stiffness": rough_alone,
        "mesh_stiffness": stiffness,
        "rough_share": stiffness / np.where(np.asarray(rough_alone) > 0.0, rough_alone, np.inf),
        "rough_clearance": gap,
        "clearance": pair.form_clearance / 2.0 + gap,
        "wave_force": torque_wave_force(pair),
        "deflection": pair.torque / radius / stiffness,
        "effective_mass": mass,
        "damping": pair.damping_ratio + pair.oil_damping / (2.0 * np.sqrt(stiffness * mass)),
        "natural_frequency": natural / (2.0 * np.pi),
        "order": order,
        "resonance_speed": natural / (2.0 * np.pi) / order,
    }


def clearance_by_roughness(pair: GearPair, contact: rough_contact.Contact, force: Float) -> Float:
    """Return what rough flanks add to the clearance on either side under the force of the pair that carries most, m."""
    drive = drive_of(pair)
    if pair.roughness_clearance == "none":
        return 0.0 * force
    if pair.roughness_clearance == "printed":
        largest = np.sqrt(rough_contact.pressed(force, contact).largest_area / np.pi)
        radius, multiple = rough_contact.read_radius(drive, largest)
        return multiple * rough_contact.amplitude(radius, contact, drive.density)
    first, second = rough_contact.heights(drive)
    reference = force / pair.torque * pair.reference_torque
    approach = rough_contact.approach(force, reference, contact)
    feasible(
        np.isfinite(approach),
        "at reference_torque all contacts are plastic, so the approach that counts from there is infinite: raise "
        "reference_torque, reduce fractal_roughness, or choose another roughness_clearance",
    )
    return np.maximum((first + second) / 2.0 - approach, 0.0)


# The record in time


@inputs
class Running(GearPair):
    """A gear pair that runs, at one speed or faster and faster."""

    times: Float = given(tuple(5e-6 * row for row in range(13)), "s", along="time", note="when it is looked at")
    speed: Float = given(4500.0, "rpm", symbol="n", note="speed of the wave generator at time 0", at_least=0,
                         at_most=1e5)  # fmt: skip
    acceleration: Float = given(0.0, "rpm/s", symbol="a_n", note="by which the speed rises, or falls")


@states
class Turned:
    """How far the flexspline is ahead of the circular spline along the line of action, how fast, where the mesh is."""

    error: Float = state("um", start="0 um", symbol="y", note="dynamic transmission error", rate="error_rate")
    error_rate: Float = state("mm/s", start="0 mm/s", symbol="v", note="its rate", size=100.0,
                              rate="(mean_force + wave_force * cos(phase) - damping_force - mesh_force)"
                              " / effective_mass")  # fmt: skip
    phase: Float = state("rad", start=0, symbol="phi", note="of the mesh",
                         rate="2 * pi * order * (speed + acceleration * time)")  # fmt: skip
    stiffness: Float = state("N/m", start="0 N/m", symbol="K", note="of the mesh, which stays", rate="0", size=1e9)
    clearance: Float = state("um", start="0 um", symbol="b", note="to either side, which stays", rate="0")


@results
class Vibration(Mesh):
    """The record of the vibration."""

    time: Float = axis("s", symbol="t", follows="times")
    transmission_error: Float = found("um", symbol="y", note="dynamic transmission error", along="time",
                                      method="first state")  # fmt: skip
    transmission_error_rate: Float = found("mm/s", symbol="v", note="its rate", along="time", method="second state")
    mesh_phase: Float = found("rad", symbol="phi", note="of the mesh", along="time", method="third state")
    mesh_deflection: Float = found("um", symbol="x", note="by which the flanks overlap; within the clearance nothing "
                                   "touches", along="time",
                                   formula="transmission_error - error_amplitude * cos(mesh_phase)")  # fmt: skip
    mesh_force: Float = found(
        "N", symbol="F_K", note="elastic force of the mesh; negative on the other flank", along="time", source=FIGURE_2,
        formula="mesh_stiffness * (1 + stiffness_variation * cos(mesh_phase)) * cases(mesh_deflection - clearance,"
        " mesh_deflection > clearance, mesh_deflection + clearance, mesh_deflection < -clearance, 0)",
    )  # fmt: skip
    damping_force: Float = found(
        "N", symbol="F_c", note="force of the damping", along="time",
        formula="2 * damping * sqrt(mesh_stiffness * effective_mass)"
        " * (transmission_error_rate + 2 * pi * order * (speed + acceleration * time) * error_amplitude"
        " * sin(mesh_phase))",
    )  # fmt: skip
    losses_of_contact: Float = found("", symbol="N_1", note="times at which the driving flanks part", digits=4,
                                     method="located events", key=True)  # fmt: skip
    back_impacts: Float = found("", symbol="N_2", note="times at which the other flanks are hit", digits=4,
                                method="located events", key=True)  # fmt: skip


def deflection_of(turned: Turned, running: Running) -> Float:
    """Return by how much the flanks overlap, m."""
    return turned.error - running.error_amplitude * np.cos(turned.phase)


def mesh_speed(running: Running, time: Float) -> Float:
    """Return by how much the phase of the mesh grows per second, rad/s."""
    return 2.0 * np.pi * order_of(running) * (running.speed + running.acceleration * time)


@dataclass(frozen=True)
class Acting:
    """What acts on the mesh at a moment: elastic force and force of the damping, N; phase rate, rad/s; mass, kg."""

    elastic: Float
    damping: Float
    phase_rate: Float
    mass: Float


def acting_on(turned: Turned, running: Running, time: Float) -> Acting:
    """Return what acts on the mesh: elastic by the backlash function (figure 2), damping by the rate of y - e."""
    wave = 1.0 + running.stiffness_variation * np.cos(turned.phase)
    elastic = turned.stiffness * wave * backlash(deflection_of(turned, running), turned.clearance)
    mass, phase_rate = effective_mass(running), mesh_speed(running, time)
    own_rate = phase_rate * running.error_amplitude * np.sin(turned.phase)
    damping = 2.0 * running.damping_ratio * np.sqrt(turned.stiffness * mass) + running.oil_damping
    return Acting(elastic, damping * (turned.error_rate + own_rate), phase_rate, mass)


def law(turned: Turned, running: Running, time: Float) -> Turned:
    """Return what the states gain per second (figure 1)."""
    acting = acting_on(turned, running, time)
    radius, still = effective_radius(running), 0.0 * turned.phase
    wave = acting.mass * radius * running.torque_wave / running.ring_inertia
    force = running.torque / radius + wave * np.cos(turned.phase)
    return Turned(
        error=turned.error_rate,
        error_rate=(force - acting.damping - acting.elastic) / acting.mass,
        phase=acting.phase_rate + still,
        stiffness=still,
        clearance=still,
    )


def loaded_at_rest(running: Running) -> Turned:
    """Return where the mesh begins: loaded by the mean force, without any vibration."""
    mesh = mesh_quantities(running)
    error = mesh["clearance"] + mesh["deflection"] + running.error_amplitude
    return Turned(error=error, error_rate=0.0 * error, phase=0.0 * error, stiffness=mesh["mesh_stiffness"],
                  clearance=mesh["clearance"])  # fmt: skip


def over_driving_flank(turned: Turned, running: Running, time: Float) -> Float:
    """Return how deep the driving flanks are in contact, m; 0 where they part."""
    return deflection_of(turned, running) - turned.clearance


def over_other_flank(turned: Turned, running: Running, time: Float) -> Float:
    """Return how far the other flanks are from being hit, m."""
    return deflection_of(turned, running) + turned.clearance


ALONG = ("error_amplitude", "stiffness_variation", "damping_ratio", "oil_damping", "ring_inertia", "circular_inertia",
         "circular_lever", "pitch_radius", "pressure_angle", "mesh_order", "speed", "acceleration")  # fmt: skip


def vibration(running: Running, motion: Motion[Turned]) -> Vibration:
    """Return the record with its forces."""
    columns: dict[str, Any] = {name: column(getattr(running, name)) for name in ALONG}
    in_rows = replace(running, **columns)
    acting = acting_on(motion.states, in_rows, motion.time)
    return Vibration(
        **mesh_quantities(running),
        time=motion.time,
        transmission_error=motion.states.error,
        transmission_error_rate=motion.states.error_rate,
        mesh_phase=motion.states.phase,
        mesh_deflection=deflection_of(motion.states, in_rows),
        mesh_force=acting.elastic,
        damping_force=acting.damping,
        losses_of_contact=motion.counts["contact is lost"],
        back_impacts=motion.counts["the other flank is hit"],
    )


RECORD = Dynamics(
    rate=law, start=loaded_at_rest, gives=vibration, tolerance=1e-7, settled=1e-4,
    events=[
        Event("contact is lost", over_driving_flank, when="falls", note="the driving flanks part"),
        Event("the other flank is hit", over_other_flank, when="falls", note="the mesh has crossed its clearance"),
    ],
)  # fmt: skip
