"""The mesh at all its contacts: what geometry fixes once, before any force is known.

Arrays over contacts have the axes (pins, phases, meshes), so that numbers of a mesh (m,) meet them as they are; what
belongs to a position of the disc has (phases, meshes).
"""

from dataclasses import dataclass, replace

import numpy as np

from rv_wear import contact, cycloid
from rv_wear.mesh import Array, Mesh, many
from truing import Float

NO_ARM = 1e-9  # a pin whose arm is shorter than this part of the longest one bears nothing
NEVER_TOUCHES = 1.0  # m; slack of such a pin


@dataclass(frozen=True)
class Teeth:
    """Contacts of many meshes: phase angle (pins, phases, 1), arms, slack and radii (pins, phases, m).

    ``weight`` is the torque per force at the longest arm and approach; ``depth_number``, ``compliance`` and ``torque``
    are the numbers of equation 1b and the torque for every position (phases, m); ``nothing`` is 0. ``first`` is the
    number of the first pin where a part of the pins is left out.
    """

    mesh: Mesh
    angle: Array
    relative_arm: Array
    per_arm: Array
    weight: Array
    slack: Array
    relative_radius: Array
    depth_number: Array
    compliance: Array
    torque: Array
    nothing: Array
    first: int = 0

    @property
    def count(self) -> int:
        """How many meshes there are."""
        return int(self.slack.shape[-1])

    @property
    def pins(self) -> slice:
        """The pins that are looked at."""
        return slice(self.first, self.first + len(self.angle))


def teeth_of(mesh: Mesh, angle: Float | None = None) -> Teeth:
    """Geometry of all contacts at the phase angles of the loaded side, or at others (pins, phases)."""
    mesh = many(mesh)
    nodes = cycloid.contact_angles(mesh.choices.pin_count, mesh.choices.phases) if angle is None else np.asarray(angle)
    nodes = nodes[:, :, None]
    arm = np.asarray(cycloid.relative_arm(mesh, nodes))
    bears = (arm > NO_ARM) & (nodes < np.pi - NO_ARM)
    arm = np.where(bears, arm, 1.0)
    positions = (nodes.shape[1], arm.shape[2])
    number, compliance, torque = (
        np.broadcast_to(value, positions).copy()
        for value in (pitch_number(mesh), contact.compliance(mesh), mesh.torque)
    )
    return Teeth(
        mesh=mesh,
        angle=nodes,
        relative_arm=arm,
        per_arm=1.0 / arm,
        weight=np.where(bears, arm**2 * mesh.longest_arm, 0.0),
        slack=np.where(bears, cycloid.clearance(mesh, nodes) / arm, NEVER_TOUCHES),
        relative_radius=np.asarray(cycloid.relative_radius(mesh, nodes)),
        depth_number=number,
        compliance=compliance,
        torque=torque,
        nothing=np.zeros_like(arm),
    )


def part_of(teeth: Teeth, pins: slice) -> Teeth:
    """The same meshes with some pins only, of all those there are."""
    names = ("angle", "relative_arm", "per_arm", "weight", "slack", "relative_radius", "nothing")
    return replace(teeth, **{name: getattr(teeth, name)[pins] for name in names}, first=pins.start)


def pitch_number(mesh: Mesh) -> Float:
    """Number of equation 1b at the longest arm."""
    angle = cycloid.longest_arm_angle(mesh)
    return contact.depth_number(mesh, cycloid.profile_radius(mesh, angle), cycloid.relative_radius(mesh, angle))
