"""The mesh to scale: one disc among its pins, the crank, and the forces of one position."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle
from numpy.typing import NDArray

from rv_wear import cycloid
from rv_wear.curves import flank
from rv_wear.drawn_look import BLUE, GREY, INK, ORANGE
from rv_wear.mesh import Mesh, mesh_of
from rv_wear.quantities import Reducer

Points = NDArray[np.complex128]
MM = 1e3
PROFILE_POINTS = 4000
LONGEST_ARROW = 0.26  # of the radius of the pin circle
SHOWN_ARM = np.radians(80.0)


@dataclass(frozen=True)
class Position:
    """One position, crank to the right, lengths in mm as complex numbers about the centre of the pins.

    Pins (z_p,), the disc's outline, its centre and the pitch point; of the loaded side the phase angles (k,), the
    contacts (k,) and the forces on the disc (k,) in N, which point from the pin to the pitch point.
    """

    pins: Points
    outline: Points
    centre: complex
    pitch_point: complex
    angle: NDArray[np.float64]
    contact: Points
    force: NDArray[np.float64]


def position_of(reducer: Reducer) -> Position:
    """The middle one of the positions that are calculated within one pin pitch."""
    mesh, new = mesh_of(reducer), flank(reducer)
    phases = mesh.choices.phases
    angle, force = (values.reshape(-1, phases)[:, phases // 2] for values in (new.angle, new.force[0]))
    circle, throw, count = float(mesh.pin_circle_radius), float(mesh.eccentricity), mesh.choices.pin_count
    pins = circle * np.exp(1j * (angle[0] + 2.0 * np.pi * np.arange(count) / count))
    turn = count * angle[0] / (count - 1)
    x, y = cycloid.profile(mesh, np.linspace(0.0, 2.0 * np.pi, PROFILE_POINTS))
    outline = throw + np.exp(1j * turn) * (np.asarray(x) + 1j * np.asarray(y))
    pitch_point = throw * count
    loaded = circle * np.exp(1j * angle)
    to_pitch = (pitch_point - loaded) / np.abs(pitch_point - loaded)
    contact = loaded + float(mesh.pin_radius) * to_pitch
    return Position(MM * pins, MM * outline, MM * throw, MM * pitch_point, angle, MM * contact, force)


def mesh_figure(reducer: Reducer) -> "Figure":
    """Draw pins, disc and crank to scale, with the forces of the new mesh in one position."""
    mesh, position = mesh_of(reducer), position_of(reducer)
    figure = Figure(figsize=(6.4, 6.3), layout="constrained")
    panel: Any = figure.subplots()
    panel.set_aspect("equal")
    _disc(panel, position)
    _pins(panel, position, MM * float(mesh.pin_radius))
    _forces(panel, position, MM * float(mesh.pin_radius))
    _angle_and_arm(panel, position)
    _centres(panel, position, mesh)
    reach = 1.04 * MM * (float(mesh.pin_circle_radius) + float(mesh.pin_radius))
    panel.set_xlim(-reach, reach)
    panel.set_ylim(-reach, reach)
    panel.set_xlabel("mm, along the crank line")
    panel.set_ylabel("mm")
    panel.grid(alpha=0.3)
    panel.set_axisbelow(True)
    return figure


def _disc(panel: Any, position: Position) -> None:
    panel.fill(position.outline.real, position.outline.imag, facecolor="#e8eff5", edgecolor=BLUE, linewidth=1.1,
               zorder=2)  # fmt: skip


def _pins(panel: Any, position: Position, radius: float) -> None:
    for place, pin in enumerate(position.pins):
        bears = place < len(position.force) and position.force[place] > 0.0
        panel.add_patch(
            Circle((pin.real, pin.imag), radius, facecolor="#f3d3bb" if bears else "white",
                   edgecolor=ORANGE if bears else GREY, linewidth=1.0, zorder=3)
        )  # fmt: skip


def _forces(panel: Any, position: Position, radius: float) -> None:
    """Arrows from the contacts along their lines of action, as long as the force is large."""
    largest = float(position.force.max(initial=0.0))
    if largest <= 0.0:
        return
    reach = LONGEST_ARROW * float(np.abs(position.pins).max())
    for contact, force in zip(position.contact, position.force, strict=True):
        if force <= 0.0:
            continue
        panel.plot(*_ends(contact, position.pitch_point), color=ORANGE, linewidth=0.5, alpha=0.7, zorder=4)
        way = (position.pitch_point - contact) / abs(position.pitch_point - contact)
        tip = contact + reach * force / largest * way
        panel.annotate(
            "", (tip.real, tip.imag), (contact.real, contact.imag), zorder=6,
            arrowprops={"arrowstyle": "-|>", "color": ORANGE, "linewidth": 1.5, "shrinkA": 0, "shrinkB": 0,
                        "mutation_scale": 7},
        )  # fmt: skip
    place = int(position.force.argmax())
    beside = position.pins[place] * (1.0 + radius / abs(position.pins[place]))
    panel.annotate(
        f"{largest:.0f} N", (beside.real, beside.imag), (4, 3), textcoords="offset points", color=ORANGE, fontsize=8.5,
    )  # fmt: skip


def _ends(first: complex, second: complex) -> tuple[list[float], list[float]]:
    return [first.real, second.real], [first.imag, second.imag]


def _angle_and_arm(panel: Any, position: Position) -> None:
    """The phase angle of one pin about the middle of the pins, and the arm of its force about that of the disc."""
    bearing = np.flatnonzero(position.force > 0.0)
    if not len(bearing):
        return
    place = bearing[np.abs(position.angle[bearing] - SHOWN_ARM).argmin()]
    pin, angle, contact = position.pins[place], position.angle[place], position.contact[place]
    panel.plot(*_ends(0j, pin), color=INK, linewidth=0.7, linestyle=(0, (6, 3)), zorder=4)
    size = 0.5 * abs(pin)
    panel.add_patch(Arc((0, 0), size, size, theta1=0, theta2=np.degrees(angle), color=INK, linewidth=0.9, zorder=5))
    middle = 0.29 * abs(pin) * np.exp(0.5j * angle)
    panel.text(middle.real, middle.imag, r"$\psi$", ha="center", va="center", fontsize=11, zorder=7)
    way = (position.pitch_point - contact) / abs(position.pitch_point - contact)
    foot = contact + ((position.centre - contact) * way.conjugate()).real * way
    panel.plot(*_ends(position.centre, foot), color=BLUE, linewidth=1.3, zorder=5)
    step = 0.035 * abs(pin)
    turned = (foot - position.centre) / abs(foot - position.centre)
    corner = np.array([foot - step * turned, foot - step * turned + step * way, foot + step * way])
    panel.plot(corner.real, corner.imag, color=BLUE, linewidth=0.9, zorder=5)
    panel.plot(*_ends(foot, position.pitch_point), color=ORANGE, linewidth=0.5, alpha=0.7, zorder=4)
    half = 0.5 * (position.centre + foot)
    panel.annotate(r"$l$", (half.real, half.imag), (3, -12), textcoords="offset points", color=BLUE, fontsize=11)


def _centres(panel: Any, position: Position, mesh: Mesh) -> None:
    """Both centres, the crank line, the pitch point, and the circle on which the longest arm ends."""
    reach = abs(position.pins[0])
    panel.plot([-reach, reach], [0, 0], color=INK, linewidth=0.7, linestyle=(0, (8, 3, 1, 3)), zorder=4)
    panel.add_patch(
        Circle((position.centre.real, 0.0), MM * float(mesh.longest_arm), fill=False, edgecolor=GREY, linewidth=0.8,
               linestyle=(0, (1, 2)), zorder=4)
    )  # fmt: skip
    for point, name, where in (
        (0.0, "centre of the pins", (-8, -42)),
        (position.centre.real, f"centre of the disc,\n{position.centre.real:.3g} mm beside it", (14, -58)),
        (position.pitch_point.real, "pitch point", (-4, -26)),
    ):
        panel.plot(point, 0.0, "o", markersize=4.2, markerfacecolor="white", markeredgecolor=INK, zorder=8)
        panel.annotate(
            name, (point, 0.0), where, textcoords="offset points", fontsize=8,
            ha="right" if where[0] < 0 else "left", va="top",
            arrowprops={"arrowstyle": "-", "color": INK, "linewidth": 0.6, "shrinkB": 3},
            zorder=8, bbox={"facecolor": "#e8eff5", "edgecolor": "none", "pad": 1.0},
        )  # fmt: skip
