"""The joint itself: plain functions of numbers or arrays, SI."""

from dataclasses import replace

import numpy as np

from screw_joint.quantities import Chance, Joint, Preload
from truing import Condition, Float, Odds, feasible

PROOF_STRESS = {"8.8": 640e6, "10.9": 940e6, "12.9": 1100e6}
CYCLES = Condition("load_cycles", "1", reference=0, note="changes of the working force since tightening")
GAUGE = Condition("gauge_temperature", "degC", reference=20, note="of the strain gauge on the shank")


def joint(given: Joint) -> Preload:
    """Preload by torque, loss by embedding, load factor of a joint that is loaded at its faces.

    Valid for metric threads, elastic plates and a screw below its proof stress. Source: VDI 2230-1.
    """
    proof_stress = PROOF_STRESS[given.strength_class]
    pitch_diameter = given.thread_diameter - 0.649519 * given.pitch
    core_diameter = given.thread_diameter - 1.226869 * given.pitch
    feasible(core_diameter > 0, "the thread has no core: its pitch is too large for its diameter")
    mean_diameter = (pitch_diameter + core_diameter) / 2
    stress_area = np.pi / 4 * mean_diameter**2
    arm = given.pitch / (2 * np.pi) + 0.577 * pitch_diameter * given.thread_friction
    preload = given.tightening_torque / (arm + given.head_friction_diameter / 2 * given.head_friction)
    thread_torque = preload * arm
    tension = preload / stress_area
    torsion = 16 * thread_torque / (np.pi * mean_diameter**3)
    equivalent_stress = np.sqrt(tension**2 + 3 * torsion**2)
    screw_compliance = given.clamping_length / (given.screw_modulus * stress_area)
    plate_compliance = given.clamping_length / (given.plate_modulus * given.plate_area)
    load_factor = plate_compliance / (screw_compliance + plate_compliance)
    preload_loss = (given.embedding + given.extra_settling) / (screw_compliance + plate_compliance)
    return Preload(
        pitch_diameter=pitch_diameter,
        core_diameter=core_diameter,
        stress_area=stress_area,
        preload=preload,
        thread_torque=thread_torque,
        tension=tension,
        torsion=torsion,
        equivalent_stress=equivalent_stress,
        proof_stress=proof_stress + 0 * preload,
        screw_compliance=screw_compliance,
        plate_compliance=plate_compliance,
        load_factor=load_factor,
        preload_loss=preload_loss,
        clamp_left=preload - preload_loss - (1 - load_factor) * given.axial_force,
        alternating_stress=load_factor * given.axial_force / (2 * stress_area),
    )


def settling(given: Joint, *, depth: Float, life: Float, load_cycles: Float) -> Joint:
    """The faces go on settling under the changing load, and come to rest after some lives."""
    return replace(given, extra_settling=given.extra_settling + depth * (1 - np.exp(-load_cycles / life)))


def bending(given: Joint, base: Preload, *, share: Float) -> Preload:
    """An eccentric force bends the shank: more alternating stress, nothing else."""
    return replace(base, alternating_stress=base.alternating_stress * (1 + share))


def gauge_drift(given: Joint, base: Preload, *, slope: Float, gauge_temperature: Float) -> Preload:
    """The strain gauge drifts with its temperature; the joint does not care."""
    return replace(base, preload=base.preload + slope * (gauge_temperature - GAUGE.zero))


def chance(odds: Odds) -> Chance:
    """The one number of the study of reliability that stands on the sheet."""
    return Chance(tight_share=odds.at_least["clamp_left"])
