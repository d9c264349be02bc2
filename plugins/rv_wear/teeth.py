"""The mesh at all its contacts: what geometry fixes once, before any force is known.

Arrays over contacts have the axes (pins, phases, meshes), so that numbers of a mesh (m,) meet them as they are; what
belongs to a position of the disc has (phases, meshes).
"""

from dataclasses import dataclass

import numpy as np

from rv_wear import contact, cycloid
from rv_wear.mesh import Array, Mesh, Truths, many
from truing import Float

NO_ARM = 1e-9  # a pin whose arm is shorter than this part of the longest one bears nothing


@dataclass(frozen=True)
class Teeth:
    """Contacts of many meshes: phase angle (pins, phases, 1), arms and radii (pins, phases, m), numbers (m,)."""

    mesh: Mesh
    angle: Array
    relative_arm: Array
    bears: Truths
    weight: Array
    slack: Array
    relative_radius: Array
    depth_number: Array
    compliance: Array
    torque: Array

    @property
    def count(self) -> int:
        """How many meshes there are."""
        return len(self.torque)


def teeth_of(mesh: Mesh, angle: Float | None = None) -> Teeth:
    """Geometry of all contacts at the phase angles of the loaded side, or at others (pins, phases)."""
    mesh = many(mesh)
    nodes = cycloid.contact_angles(mesh.choices.pin_count, mesh.choices.phases) if angle is None else np.asarray(angle)
    nodes = nodes[:, :, None]
    arm = np.asarray(cycloid.relative_arm(mesh, nodes))
    bears = (arm > NO_ARM) & (nodes < np.pi - NO_ARM)
    arm = np.where(bears, arm, 1.0)
    return Teeth(
        mesh=mesh,
        angle=nodes,
        relative_arm=arm,
        bears=bears,
        weight=np.where(bears, arm**2 * mesh.longest_arm, 0.0),
        slack=np.where(bears, cycloid.clearance(mesh, nodes) / arm, np.inf),
        relative_radius=np.asarray(cycloid.relative_radius(mesh, nodes)),
        depth_number=np.asarray(pitch_number(mesh)),
        compliance=np.asarray(contact.compliance(mesh)),
        torque=np.asarray(mesh.torque, dtype=float),
    )


def pitch_number(mesh: Mesh) -> Float:
    """Number of equation 1b at the longest arm."""
    angle = cycloid.longest_arm_angle(mesh)
    return contact.depth_number(mesh, cycloid.profile_radius(mesh, angle), cycloid.relative_radius(mesh, angle))
