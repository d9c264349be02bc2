"""Links that give way under load, joints whose play the load takes up, and the load that the slider itself is.

A central force F on the slider presses each link with N = F dS/dL (virtual work), dS/dL being the exact derivative of
the slider position by the length of that link, in the position that the press is in: F/2 times the paper's xi.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from press_linkage.effects_of_heat import longer
from press_linkage.increments import face_sensitivities
from press_linkage.kinematics import Position
from press_linkage.mechanism import position_of
from press_linkage.motion import slider_motion
from press_linkage.quantities import Press
from truing import Float

KNEE = ("knee_drive_length", "upper_knee_length", "lower_knee_length")
JOINTS = 2  # per link
MILLION = 1e6
TURN = 2.0 * np.pi
GRAVITY = 9.80665  # m/s2
ROUNDING = 1e-9  # of the weight: a load nearer to nothing is nothing

Shares = tuple[Mapping[str, Float], Mapping[str, Float]]


def shares_of_load(position: Position) -> Shares:
    """Compression of the links of both sides per newton that pushes the slider up, N/N, negative where they are pulled.

    Rods and knee links; 0 where the loops do not close, so that the model itself says why they do not.
    """
    halves = (position.side_1, position.side_2)
    with np.errstate(invalid="ignore", divide="ignore"):
        faces = [face_sensitivities(half) for half in halves]
        arm = 0.5 * (faces[0]["platform_arm"] + faces[1]["platform_arm"])
        found = [
            {"rod_length": 0.5 * arm / half.rod.sine} | {kind: 0.5 * face[kind] for kind in KNEE}
            for half, face in zip(halves, faces, strict=True)
        ]
    one, two = ({kind: _closed(value) for kind, value in shares.items()} for shares in found)
    return one, two


def _closed(value: Float) -> Float:
    """0 where there is no number."""
    return np.nan_to_num(value, nan=0.0, posinf=0.0, neginf=0.0)


def net_force(press: Press, forming_force: Float) -> Float:
    """What pushes the slider up, N: forming force and counterbalance less its weight; below 0 it hangs in its links.

    The weight of the links and the inertia of the slider are left out.
    """
    weight = GRAVITY * press.slider_mass
    force = forming_force + press.counterbalance - weight
    return np.where(np.abs(force) <= ROUNDING * weight, 0.0, force)


def pressed(press: Press, position: Position, force_by_stiffness: Float) -> Press:
    """The press under a central force F, given as F/(EA) with equal sections: each link shortens by N L/(EA)."""
    sides = zip((press.side_1, press.side_2), shares_of_load(position), strict=True)
    side_1, side_2 = (
        longer(side, {kind: -force_by_stiffness * share * getattr(press, kind) for kind, share in shares.items()})
        for side, shares in sides
    )
    return replace(press, side_1=side_1, side_2=side_2)


def slackened(press: Press, clearance: Float, forming_force: Float) -> Press:
    """The press with this radial clearance in both joints of each link: shorter where pressed, longer where pulled."""
    force = net_force(press, forming_force)
    upward = np.where(np.isnan(force), np.nan, np.where(force < 0, -1.0, 1.0))
    play = JOINTS * clearance * upward
    sides = zip((press.side_1, press.side_2), shares_of_load(position_of(press)), strict=True)
    side_1, side_2 = (
        longer(side, {kind: -play * np.sign(share) for kind, share in shares.items()}) for side, shares in sides
    )
    return replace(press, side_1=side_1, side_2=side_2)


def elastic_deflection(press: Press, *, compliance: Float, forming_force: Float) -> Press:
    """Rods and knee links shorten under the force that they carry like bars of one section; compliance is 1/(EA)."""
    return pressed(press, position_of(press), compliance * net_force(press, forming_force))


def joint_clearance(press: Press, *, clearance: Float, forming_force: Float) -> Press:
    """The load takes up the clearance of every joint, to the side to which it presses or pulls the link.

    It reverses where the forming force and the counterbalance together are the weight of the slider.
    """
    return slackened(press, clearance, forming_force)


def joint_wear(press: Press, *, wear: Float, strokes: Float, forming_force: Float) -> Press:
    """Every joint gains clearance in proportion to the strokes; the load takes it up, as above."""
    return slackened(press, wear * strokes / MILLION, forming_force)


def slider_inertia(press: Press, *, mass_compliance: Float, speed: Float) -> Press:
    """The elastic line under the inertia of the slider, with both cranks turning at the same, steady speed.

    A slider that accelerates upward (z'' < 0, as at the bottom dead centre) pulls its links down: as a force that is
    positive upward, its inertia is +m z''. ``mass_compliance`` is m/(EA), ``speed`` in turns per second; z'' is exact
    at every crank angle.
    """
    position = position_of(press)
    by_angle = _closed(slider_motion(position).acceleration)
    return pressed(press, position, mass_compliance * by_angle * (TURN * speed) ** 2)
