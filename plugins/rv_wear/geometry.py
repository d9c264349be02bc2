"""The cycloid disc and its meshes: arm, curvature, clearance, profile and sliding at every contact.

One entry per distinct mesh of a batch; what geometry fixes is calculated once, before any force is known.
"""

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gear_geometry import cycloid
from rv_wear.quantities import Reducer
from truing import Array, Float

# What the teeth know of a reducer: one entry per distinct mesh, and which row of a batch runs on which mesh


@dataclass(frozen=True)
class Choices:
    """What is one value for a whole call: numbers of pins and positions, and the ways of calculating."""

    pin_count: int = 40
    phases: int = 8
    load_sharing: str = "linear"
    wear_coefficient: str = "pointwise"
    has_film: bool = False


@dataclass(frozen=True)
class Mesh:
    """One disc among its pins, or many of them: every field but the last is a number or an array (m,), in SI.

    What begins with ``film`` is the oil between them, 0 where no film is asked for; the speed is that of the output.
    """

    pin_circle_radius: Float
    pin_radius: Float
    eccentricity: Float
    width: Float
    equidistant: Float
    shift: Float
    torque: Float
    young_modulus: Float
    poisson_ratio: Float
    threshold: Float
    film_pressure_viscosity: Float = 0.0
    film_viscosity: Float = 0.0
    film_speed: Float = 0.0
    film_roughness: Float = 0.0
    film_factor: Float = 0.0
    choices: Choices = Choices()

    @property
    def short_width(self) -> Float:
        """Short-width coefficient K_1."""
        return self.eccentricity * self.choices.pin_count / self.pin_circle_radius

    @property
    def root(self) -> Float:
        """Sine q of the phase angle of the longest arm."""
        return np.sqrt(1.0 - self.short_width**2)

    @property
    def longest_arm(self) -> Float:
        """Radius of the pitch circle of the disc, where the arm of the contact force is longest."""
        return self.eccentricity * (self.choices.pin_count - 1)

    @property
    def radial_clearance(self) -> Float:
        """Clearance between disc and pins before the disc is turned."""
        return self.equidistant - self.shift

    @property
    def equivalent_modulus(self) -> Float:
        """Modulus E' of the contact in the convention of film theory."""
        return self.young_modulus / (1.0 - self.poisson_ratio**2)

    @property
    def start_force(self) -> Float:
        """Largest force between disc and pins without any clearance, equation 1."""
        return cycloid.largest_force(self.torque, self.short_width, self.choices.pin_count, self.pin_circle_radius)


NUMBERS = tuple(each.name for each in fields(Mesh) if each.name != "choices")


def mesh_of(reducer: Reducer) -> Mesh:
    """The mesh of a reducer, numbers and arrays as they are; the oil belongs to it only where a film is asked for."""
    has_film = bool(np.any(np.asarray(reducer.film_factor) > 0.0))
    film: dict[str, Float] = {
        "film_pressure_viscosity": reducer.pressure_viscosity, "film_viscosity": reducer.oil_viscosity,
        "film_speed": reducer.output_speed, "film_roughness": reducer.composite_roughness,
        "film_factor": reducer.film_factor,
    }  # fmt: skip
    return Mesh(
        pin_circle_radius=reducer.pin_circle_radius,
        pin_radius=reducer.pin_radius,
        eccentricity=reducer.eccentricity,
        width=reducer.disc_width,
        equidistant=reducer.equidistant_modification,
        shift=reducer.shift_modification,
        torque=reducer.torque_share * reducer.output_torque,
        young_modulus=reducer.young_modulus,
        poisson_ratio=reducer.poisson_ratio,
        threshold=reducer.reconstruction_depth,
        choices=Choices(reducer.pin_count, reducer.phases, reducer.load_sharing, reducer.wear_coefficient, has_film),
        **(film if has_film else {}),
    )


def columns_of(mesh: Mesh) -> list[Float]:
    """The numbers of a mesh in a fixed order."""
    return [getattr(mesh, name) for name in NUMBERS]


def with_columns(mesh: Mesh, columns: list[Float]) -> Mesh:
    """The same choices with other numbers, in the order of ``columns_of``."""
    return Mesh(**dict(zip(NUMBERS, columns, strict=True)), choices=mesh.choices)


def distinct(mesh: Mesh) -> tuple[Mesh, NDArray[np.intp] | None]:
    """The distinct meshes (m,) and the mesh of every row; None where all rows have the same one.

    Rows that follow each other with the same mesh are taken together first: a batch usually comes design by design.
    """
    columns = [np.asarray(column, dtype=float) for column in columns_of(mesh)]
    varying = [place for place, column in enumerate(columns) if column.ndim and (column != column[0]).any()]
    heads = [column.reshape(-1)[:1] for column in columns]
    if not varying:
        return with_columns(mesh, list(heads)), None
    table = np.stack([columns[place] for place in varying])
    starts = np.flatnonzero(np.concatenate([[True], (table[:, 1:] != table[:, :-1]).any(axis=0)]))
    found, back = np.unique(table[:, starts], axis=1, return_inverse=True)
    for row, place in enumerate(varying):
        heads[place] = found[row]
    filled = [np.broadcast_to(head, found.shape[1:]) for head in heads]
    runs = np.diff(np.append(starts, table.shape[1]))
    return with_columns(mesh, list(filled)), np.repeat(back.reshape(-1), runs)


def some_of(mesh: Mesh, index: NDArray[np.intp]) -> Mesh:
    """Some of many meshes (m,), in the order of ``index``."""
    return with_columns(mesh, [np.ascontiguousarray(np.asarray(column)[index]) for column in columns_of(mesh)])


def many(mesh: Mesh) -> Mesh:
    """The same with every number as an array (m,), also where there is one mesh only."""
    columns = np.broadcast_arrays(*(np.atleast_1d(np.asarray(column, dtype=float)) for column in columns_of(mesh)))
    return with_columns(mesh, [np.ascontiguousarray(column) for column in columns])


# Geometry of the cycloid disc: arm and curvature at every contact, clearance after grinding, profile
#
# The phase angle psi of a pin is measured from the crank line; contacts lie at 0 < psi < pi. All lengths in m. Sources:
# Li, and Malhotra and Parameswaran, Mechanism and Machine Theory 18(6), 1983, for arm and curvature; equations G1 to G3
# in the plugin's theory page.


def pin_distance(mesh: Mesh, angle: Float) -> Float:
    """S(psi): distance of the pin from the pitch point over the radius of the pin circle."""
    return cycloid.pin_distance(mesh.short_width, angle)


def relative_arm(mesh: Mesh, angle: Float) -> Float:
    """The arm over the longest one, 0 to 1."""
    return np.sin(angle) / pin_distance(mesh, angle)


def longest_arm_angle(mesh: Mesh) -> Float:
    """Phase angle of the longest arm, arccos K_1."""
    return np.arccos(mesh.short_width)


def centre_path_curvature(mesh: Mesh, angle: Float) -> Float:
    """Curvature 1/rho_0 of the path of the pin centre in the disc, 1/m; below 0 where the tooth is convex."""
    return cycloid.path_curvature(mesh.short_width, mesh.choices.pin_count, mesh.pin_circle_radius, angle)


def profile_radius(mesh: Mesh, angle: Float) -> Float:
    """Radius of curvature rho of the flank; below 0 where it is convex, infinite where it is straight."""
    return 1.0 / centre_path_curvature(mesh, angle) + mesh.pin_radius


def relative_radius(mesh: Mesh, angle: Float) -> Float:
    """Radius R' of the equivalent cylinder on a plane: |rho r_rp / (rho - r_rp)|, finite throughout."""
    sizes = mesh.pin_circle_radius, mesh.pin_radius
    return cycloid.relative_radius(mesh.short_width, mesh.choices.pin_count, sizes, angle)


def smallest_convex_radius(mesh: Mesh) -> Float:
    """Least radius of the path of the pin centre where the tooth is convex; a larger pin undercuts the disc."""
    return cycloid.least_convex_radius(mesh.short_width, mesh.choices.pin_count, mesh.pin_circle_radius)


def clearance(mesh: Mesh, angle: Float) -> Float:
    """Normal clearance of the unworn disc, turned until the pin at the longest arm touches; below 0: interference.

    Written with the factor (cos psi - K_1)^2 that all its terms share, so it is exactly 0 at the longest arm. It is
    Delta r_rp (1 - sin psi / S) - Delta r_p (1 - K_1 cos psi - q sin psi) / S.
    """
    short_width, sine, cosine = mesh.short_width, np.sin(angle), np.cos(angle)
    distance = pin_distance(mesh, angle)
    by_equidistant = 1.0 / (distance + sine)
    by_shift = 1.0 / (1.0 - short_width * cosine + mesh.root * sine)
    bracket = mesh.equidistant * by_equidistant - mesh.shift * by_shift
    return (cosine - short_width) ** 2 / distance * bracket


def lowest_equidistant(mesh: Mesh, largest: Float | None = None, points: int = 121) -> Float:
    """Smallest equidistant modification of equation 17 at this radial clearance: a number or (m,).

    Below it the clearance somewhere exceeds *largest*: twice the radial clearance where nothing is given, or for
    example the approach under load. Found at *points* phase angles, refined by a parabola through the best three.
    """
    limit = 2.0 * mesh.radial_clearance if largest is None else largest
    axes = max(np.ndim(mesh.short_width), np.ndim(limit))
    angle = np.linspace(0.0, np.pi, points)[1:-1].reshape(-1, *([1] * axes))
    sine, cosine, distance = np.sin(angle), np.cos(angle), pin_distance(mesh, angle)
    by_equidistant = 1.0 - sine / distance
    by_shift = (1.0 - mesh.short_width * cosine - mesh.root * sine) / distance
    with np.errstate(divide="ignore", invalid="ignore"):
        bound = (limit - mesh.radial_clearance * by_shift) / (by_equidistant - by_shift)
    bound = np.where(by_equidistant - by_shift < -1e-9, bound, -np.inf)
    return _refined_maximum(bound)


def _refined_maximum(values: Array) -> Float:
    """The maximum along the first axis of equidistant samples, with the parabola through it and its neighbours."""
    place = np.clip(values.argmax(axis=0), 1, len(values) - 2)
    before, at, after = (np.take_along_axis(values, (place + step)[None], axis=0)[0] for step in (-1, 0, 1))
    with np.errstate(divide="ignore", invalid="ignore"):
        top = at - (after - before) ** 2 / (8.0 * (after - 2.0 * at + before))
    value: Float = np.where(np.isfinite(top), top, values.max(axis=0))
    return value


def profile(mesh: Mesh, turn: Float) -> tuple[Float, Float]:
    """Points (x, y) of the ground disc in its own frame, over the disc's turn t = psi / z_c relative to the pins.

    Without modifications the theoretical profile; with them the disc as ground with pins of r_rp + Delta r_rp on the
    circle r_p + Delta r_p, the eccentricity as it is.
    """
    pins, throw = mesh.choices.pin_count, mesh.eccentricity
    circle, pin = mesh.pin_circle_radius + mesh.shift, mesh.pin_radius + mesh.equidistant
    x = circle * np.cos(turn) - throw * np.cos(pins * turn)
    y = circle * np.sin(turn) - throw * np.sin(pins * turn)
    x_speed = -circle * np.sin(turn) + throw * pins * np.sin(pins * turn)
    y_speed = circle * np.cos(turn) - throw * pins * np.cos(pins * turn)
    speed = np.hypot(x_speed, y_speed)
    return x - pin * y_speed / speed, y + pin * x_speed / speed


def contact_angles(pin_count: int, phases: int) -> NDArray[np.float64]:
    """Phase angles (pins, phases) at which the disc is looked at: one side of the disc, so many positions per pitch."""
    pins = np.arange((pin_count + 1) // 2)[:, None]
    return 2.0 * np.pi * (pins + (np.arange(phases) + 0.5) / phases) / pin_count


# How far disc and pin slide on each other: equations 6 to 8, housing and pins fixed


def sliding_speed(mesh: Mesh, angle: Float) -> Float:
    """Sliding speed v_r over the turning speed of the disc against the pins, m: r_p S - r_rp, equation 6."""
    return mesh.pin_circle_radius * pin_distance(mesh, angle) - mesh.pin_radius


def rolling_speed(mesh: Mesh, angle: Float) -> Float:
    """Speed v_t of the contact along the flank over the same turning speed, m: r_p S |rho / rho_0|, equation 7."""
    bend = 1.0 + mesh.pin_radius * centre_path_curvature(mesh, angle)
    return mesh.pin_circle_radius * pin_distance(mesh, angle) * np.abs(bend)


def sliding_ratio(mesh: Mesh, angle: Float) -> Float:
    """Sliding per length of flank, lambda = v_r / v_t; exactly 1 at the longest arm. Times 2 b: path of a point."""
    return sliding_speed(mesh, angle) / rolling_speed(mesh, angle)


# Line contact of disc and pin: the force that an approach needs, and the pressure under it; SI, arrays welcome
#
# Roark's formulas for two cylinders of equal elastic constants; the pins lie in half-round grooves and do not bend.

NEWTON = 4  # steps from the start below; they leave rounding only
LEAST = 2.0 - np.log(2.0)  # of u - ln u; the formula is not followed to where it ends


def compliance(mesh: Mesh) -> Float:
    """2 (1 - nu^2) / (pi E B): approach per force before the logarithm, m/N."""
    return 2.0 / (np.pi * mesh.equivalent_modulus * mesh.width)


def depth_number(mesh: Mesh, profile_radius: Float, relative_radius: Float) -> Float:
    """What equation 1b is without the force: 2/3 + ln(16 r_rp |rho| F / c^2) with the full width c = 2 b."""
    radius = np.minimum(np.abs(profile_radius), mesh.pin_circle_radius)  # no body is deeper than the disc
    return 2.0 / 3.0 + np.log(mesh.pin_radius * radius / (compliance(mesh) * relative_radius))


def force_of(mesh: Mesh, approached: Float, number: Float) -> Float:
    """Force that an approach needs: equation 1b solved by Newton's rule; 0 where nothing is approached.

    With u = number - ln F equation 1b reads u - ln u = number - ln(approach / compliance), and F is the ratio over u.
    Valid while the force stays below exp(number - 2); the formula ends at exp(number - 1), about 1e9 N for steel of
    this size.
    """
    wanted = np.maximum(approached, 1e-30) / compliance(mesh)
    sought = np.maximum(number - np.log(wanted), LEAST)
    left = sought + np.log(sought)
    for _ in range(NEWTON):
        left = left - (left - np.log(left) - sought) * left / (left - 1.0)
    return np.where(approached > 0.0, wanted / left, 0.0)


def mean_pressure(mesh: Mesh, force: Float, relative_radius: Float) -> Float:
    """Force over the area of the contact, equation 5; 0 without force."""
    return np.sqrt(np.maximum(force, 0.0) / (16.0 * compliance(mesh) * relative_radius)) / mesh.width


# The mesh at all its contacts: what geometry fixes once, before any force is known
#
# Arrays over contacts have the axes (pins, phases, meshes), so that numbers of a mesh (m,) meet them as they are; what
# belongs to a position of the disc has (phases, meshes).

NO_ARM = 1e-9  # a pin whose arm is shorter than this part of the longest one bears nothing
NEVER_TOUCHES = 1.0  # m; slack of such a pin


@dataclass(frozen=True)
class Teeth:
    """Contacts of many meshes: phase angle (pins, phases, 1), arms, slack and radii (pins, phases, m).

    ``weight`` is the torque per force at the longest arm and approach; ``depth_number``, ``compliance`` and ``torque``
    are the numbers of equation 1b and the torque for every position (phases, m); ``nothing`` is 0.
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

    @property
    def count(self) -> int:
        """How many meshes there are."""
        return int(self.slack.shape[-1])


def teeth_of(mesh: Mesh, angle: Float | None = None) -> Teeth:
    """Geometry of all contacts at the phase angles of the loaded side, or at others (pins, phases)."""
    mesh = many(mesh)
    nodes = contact_angles(mesh.choices.pin_count, mesh.choices.phases) if angle is None else np.asarray(angle)
    nodes = nodes[:, :, None]
    arm = np.asarray(relative_arm(mesh, nodes))
    bears = (arm > NO_ARM) & (nodes < np.pi - NO_ARM)
    arm = np.where(bears, arm, 1.0)
    positions = (nodes.shape[1], arm.shape[2])
    number, softness, torque = (
        np.broadcast_to(value, positions).copy() for value in (pitch_number(mesh), compliance(mesh), mesh.torque)
    )
    return Teeth(
        mesh=mesh,
        angle=nodes,
        relative_arm=arm,
        per_arm=1.0 / arm,
        weight=np.where(bears, arm**2 * mesh.longest_arm, 0.0),
        slack=np.where(bears, clearance(mesh, nodes) / arm, NEVER_TOUCHES),
        relative_radius=np.asarray(relative_radius(mesh, nodes)),
        depth_number=number,
        compliance=softness,
        torque=torque,
        nothing=np.zeros_like(arm),
    )


def some_pins(teeth: Teeth, pins: slice) -> Teeth:
    """The contacts of some of the pins, in the same positions."""
    along = ("angle", "relative_arm", "per_arm", "weight", "slack", "relative_radius", "nothing")
    kept: dict[str, Any] = {name: np.ascontiguousarray(getattr(teeth, name)[pins]) for name in along}
    return replace(teeth, **kept)


def pitch_number(mesh: Mesh) -> Float:
    """Number of equation 1b at the longest arm."""
    angle = longest_arm_angle(mesh)
    return depth_number(mesh, profile_radius(mesh, angle), relative_radius(mesh, angle))
