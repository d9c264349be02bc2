"""How the pins share the torque: equations 1b to 4 with rigid take-up, solved for all meshes and positions at once.

The *slack* of a pin is its clearance over its relative arm: how far the pitch point must move until the pin touches.
Before each solution the least slack of a position is taken up, since the disc turns freely until the first pin touches.
Then pin i bears what is left of the approach:

    F_i = (F / delta) (l_i / l_max) (delta - slack_i),   delta from F by equation 1b   (linear sharing)
    F_i by equation 1b from (l_i / l_max) (delta - slack_i) with its own radii          (Hertz sharing)

The torque is convex in F, so Newton's rule with the pins that bear at the moment comes down to the answer from above;
each position stops for itself, so an answer does not depend on what else is calculated in the same call.
"""

from dataclasses import dataclass

import numpy as np

from rv_wear import contact, cycloid
from rv_wear.mesh import Array, Truths
from rv_wear.teeth import Teeth

CLOSE = 1e-14
ROUNDS = 100


@dataclass(frozen=True)
class Loads:
    """Force at the longest arm and approach there (phases, m), slack after take-up and pin forces (pins, phases, m)."""

    scale: Array
    approach: Array
    slack: Array
    force: Array


def start_scale(teeth: Teeth) -> Array:
    """Forces (phases, m) from which the first solution starts: those without clearance."""
    return np.broadcast_to(np.asarray(teeth.mesh.start_force), (*teeth.angle.shape[1:2], teeth.count)).copy()


def shared(teeth: Teeth, slack: Array, guess: Array) -> Loads:
    """Forces of all pins for these slacks (pins, phases, m), by the sharing that the mesh was given."""
    taken = slack - slack.min(axis=0)
    solve = hertz if teeth.mesh.choices.load_sharing == "hertz" else linear
    return solve(teeth, taken, guess)


def linear(teeth: Teeth, slack: Array, guess: Array) -> Loads:
    """Forces in proportion to the approach, as in the paper; *guess* is a force at the longest arm (phases, m)."""
    scale, stiffness = guess, np.zeros_like(guess)
    for _ in range(ROUNDS):
        bearing = teeth.weight * (slack < contact_approach(teeth, scale))
        new = bearing.sum(axis=0)
        moving = new != stiffness
        if not moving.any():
            break
        stiffness = new
        lost = (bearing * np.where(np.isfinite(slack), slack, 0.0)).sum(axis=0)
        scale = _balanced(teeth, scale, stiffness, lost, moving)
    approach = contact_approach(teeth, scale)
    share = teeth.relative_arm * np.maximum(approach - slack, 0.0)
    return Loads(scale, approach, slack, scale / approach * share)


def contact_approach(teeth: Teeth, scale: Array) -> Array:
    """Approach at the longest arm under a force there, equation 1b."""
    return teeth.compliance * scale * (teeth.depth_number - np.log(scale))


def _balanced(teeth: Teeth, scale: Array, stiffness: Array, lost: Array, moving: Truths) -> Array:
    """Force at which the bearing pins hold the torque: F A - (F / delta) B = T, solved by Newton's rule."""
    for _ in range(ROUNDS):
        left = teeth.depth_number - np.log(scale)
        secant = 1.0 / (teeth.compliance * left)  # F / delta
        excess = scale * stiffness - secant * lost - teeth.torque
        step = excess / (stiffness - lost * secant / (scale * left))
        new = np.where(moving, np.maximum(scale - step, 0.1 * scale), scale)
        moving = moving & (np.abs(step) > CLOSE * scale)
        scale = new
        if not moving.any():
            break
    return scale


def hertz(teeth: Teeth, slack: Array, guess: Array) -> Loads:
    """Forces by equation 1b at every pin with its own radii; *guess* is a force at the longest arm (phases, m)."""
    profile_radius = np.asarray(cycloid.profile_radius(teeth.mesh, teeth.angle))
    number = np.asarray(contact.depth_number(teeth.mesh, profile_radius, teeth.relative_radius))
    approach = contact_approach(teeth, guess)
    lever = np.where(teeth.bears, teeth.relative_arm * teeth.mesh.longest_arm, 0.0)
    moving = np.ones(approach.shape, dtype=bool)
    for _ in range(ROUNDS):
        force = contact.force_of(teeth.mesh, teeth.relative_arm * (approach - slack), number)
        soft = teeth.compliance * np.maximum(number - np.log(np.where(force > 0.0, force, 1.0)) - 1.0, 1.0)
        slope = np.where(force > 0.0, lever * teeth.relative_arm / soft, 0.0).sum(axis=0)
        step = ((force * lever).sum(axis=0) - teeth.torque) / slope
        new = np.where(moving, np.maximum(approach - step, 0.5 * approach), approach)
        moving = moving & (np.abs(step) > CLOSE * approach)
        approach = new
        if not moving.any():
            break
    force = contact.force_of(teeth.mesh, teeth.relative_arm * (approach - slack), number)
    scale = contact.force_of(teeth.mesh, approach, teeth.depth_number)
    return Loads(np.asarray(scale), approach, slack, np.asarray(force))
