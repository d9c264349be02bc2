"""Cranks that are not where their encoder says."""

from dataclasses import replace

import numpy as np

from press_linkage.effects_of_heat import longer
from press_linkage.quantities import Press
from truing import Float

TURN = 2.0 * np.pi


def ahead(press: Press, by: Float) -> Press:
    """The press with both cranks ahead, rad, in the sense in which the crank angle grows."""
    return replace(
        press, side_1=longer(press.side_1, {"crank_angle": by}), side_2=longer(press.side_2, {"crank_angle": by})
    )


def crank_phase(press: Press, *, phase: Float) -> Press:
    """Both cranks are ahead of the angle that is shown, by the same amount at every angle."""
    return ahead(press, phase)


def encoder_eccentricity(press: Press, *, sine: Float, cosine: Float) -> Press:
    """Both cranks are ahead by a first harmonic of the crank angle, as behind an encoder disc mounted off centre."""
    return ahead(press, sine * np.sin(press.crank_angle) + cosine * np.cos(press.crank_angle))


def past_dead_centre(crank_angle: Float) -> Float:
    """Which side of the bottom dead centre the crank is on: -1 before, +1 after, 0 at it.

    The angle is wrapped into (-180, 180] degrees first; half a turn counts as after, whichever way it was reached.
    """
    return np.sign(crank_angle - TURN * np.ceil(crank_angle / TURN - 0.5))


def drive_backlash(press: Press, *, play_before: Float, play_after: Float, direction: Float) -> Press:
    """Both cranks stay behind in their sense of turning by half the play, which may differ before and after the centre.

    A slider on its way to the bottom dead centre has cranks that turn forward before it and backward after it. At the
    dead centre itself, and without a direction (0), the crank lies in the middle of its play. Of the direction only the
    sign counts.
    """
    where = past_dead_centre(press.crank_angle)
    play = np.where(where < 0, play_before, play_after)
    sense_of_turning = -where * np.sign(direction)
    return ahead(press, -0.5 * play * sense_of_turning)
