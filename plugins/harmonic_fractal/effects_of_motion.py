"""What turns and time bring along: an oval and an eccentric wave generator, creep, a rig that drifts."""

from dataclasses import replace

import numpy as np

from harmonic_fractal.answers import Stiffness
from harmonic_fractal.effects_of_friction import turned
from harmonic_fractal.quantities import Drive
from truing import Float


def creep(drive: Drive, results: Stiffness, *, share: Float, time_scale: Float, time: Float) -> Stiffness:
    """The twist goes on under torque: by ``share`` of itself each time that the time grows e-fold.

    Only what is elastic creeps: the mesh and what is in series with it.
    """
    beyond = np.sign(drive.torque) * np.maximum(np.abs(drive.torque) - drive.reference_torque, 0.0)
    elastic = results.mesh_torsion + results.series_compliance * beyond
    return turned(results, share * elastic * np.log1p(np.maximum(time, 0.0) / time_scale))


def ellipticity(drive: Drive, results: Stiffness, *, wave_angle: Float, **unknowns: Float) -> Stiffness:
    """The two lobes of the wave generator are not alike: two waves per turn, of the angle and of the stiffness."""

    def wave(name: str) -> Float:
        cosine, sine = unknowns.get(f"{name}cosine", 0.0), unknowns.get(f"{name}sine", 0.0)
        return cosine * np.cos(2.0 * wave_angle) + sine * np.sin(2.0 * wave_angle)

    stiffer = replace(results, mesh_stiffness=results.mesh_stiffness * (1.0 + wave("stiffness_")))
    return turned(stiffer, wave(""))


def eccentricity(drive: Drive, results: Stiffness, *, cosine: Float, sine: Float, wave_angle: Float) -> Stiffness:
    """The wave generator is off its axis: one wave of the angle per turn."""
    return turned(results, cosine * np.cos(wave_angle) + sine * np.sin(wave_angle))


def rig_drift(drive: Drive, results: Stiffness, *, rate: Float, time: Float) -> Stiffness:
    """The rig moves on with time, whatever the torque; the drive does not."""
    return turned(results, rate * time)
