"""Friction torque of a roller bearing, after Palmgren: a part of the lubricant and a part of the load."""

from dataclasses import replace

from truing import Condition, Float, Model, Tolerance, Unknown, found, given, inputs, normal, results
from zoo.zoo import acting


@inputs
class Bearing:
    """A bearing at one operating point; the viscosity is read from the chart of the oil."""

    speed: Float = given(1500.0, "rpm", symbol="n", note="speed", above=0)
    load: Float = given(10.0, "kN", symbol="F", note="radial load", above=0)
    viscosity: Float = given(60.0, "mm^2/s", symbol="nu", note="viscosity of the oil at its temperature", above=0)
    mean_diameter: Float = given(100.0, "mm", symbol="d_m", note="mean diameter", above=0)
    lubricant_factor: Float = given(2.0, "", symbol="f_0", note="of the kind of bearing and its lubrication", above=0)
    friction_factor: Float = given(0.0004, "", symbol="f_1", note="of the kind of bearing", above=0)
    load_exponent: Float = given(0.0, "", symbol="e", note="by which the friction factor grows with the load")
    starved: Float = given(0.0, "s^2/m^2", symbol="k", note="loss of film with viscosity times speed", at_least=0)
    preload: Float = given(0.0, "kN", symbol="F_0", note="load that is there without a load")
    other_torque: Float = given(0.0, "N*m", symbol="M_3", note="torque of what touches the shaft beside the bearing")


REFERENCE_LOAD = 10.0  # kN


@results
class Friction:
    """What turning it takes."""

    lubricant_torque: Float = found(
        "N*m",
        symbol="M_0",
        note="torque of the lubricant",
        numeric=True,
        formula="1e-10 * lubricant_factor * (viscosity * speed)**(2 / 3) * mean_diameter**3"
        " / (1 + starved * 1e-6 * viscosity * speed / 60)",
        source="A. Palmgren, Ball and roller bearing engineering",
    )
    load_torque: Float = found(
        "N*m",
        symbol="M_1",
        note="torque of the load",
        numeric=True,
        formula="friction_factor * ((load + preload) / 10)**load_exponent * (load + preload) * mean_diameter",
        source="A. Palmgren, Ball and roller bearing engineering",
    )
    torque: Float = found("N*m", symbol="M", note="torque", formula="lubricant_torque + load_torque + other_torque")


def bearing_torque(bearing: Bearing) -> Friction:
    """The sum of both parts; Palmgren's numbers belong to mm, rpm and mm²/s."""
    stirred = (6e7 * bearing.viscosity * bearing.speed) ** (2 / 3)
    filled = 1 / (1 + bearing.starved * bearing.viscosity * bearing.speed)
    lubricant = 1e-10 * bearing.lubricant_factor * stirred * (1e3 * bearing.mean_diameter) ** 3 * filled
    load = bearing.load + bearing.preload
    raised = (load / (1e3 * REFERENCE_LOAD)) ** bearing.load_exponent
    carried = bearing.friction_factor * raised * load * bearing.mean_diameter
    return Friction(lubricant_torque=lubricant, load_torque=carried, torque=lubricant + carried + bearing.other_torque)


OIL = Condition("oil_temperature", "degC", reference=40)


def bent_load_law(bearing: Bearing, *, exponent: Float) -> Bearing:
    """The torque of the load grows with another power of it than the first; the factor holds at 10 kN."""
    return replace(bearing, load_exponent=bearing.load_exponent + exponent)


def starvation(bearing: Bearing, *, loss: Float) -> Bearing:
    """Oil does not flow back before the next roller comes: the film is thinner at high speed and in thick oil."""
    return replace(bearing, starved=bearing.starved + loss)


def seal_drag(bearing: Bearing, *, torque: Float) -> Bearing:
    """A seal rubs, at any speed the same."""
    return replace(bearing, other_torque=bearing.other_torque + torque)


def churning(bearing: Bearing, *, torque: Float) -> Bearing:
    """The rollers splash through an oil sump; the torque is that at 3000 rpm and grows as the square of the speed."""
    return replace(bearing, other_torque=bearing.other_torque + torque * (bearing.speed / 50.0) ** 2)


def wrong_oil(bearing: Bearing, *, thinner: Float) -> Bearing:
    """Another grade was filled in: the viscosity is a share of what the chart says."""
    return replace(bearing, viscosity=bearing.viscosity * (1 - thinner))


def tight_fit(bearing: Bearing, *, rise: Float, oil_temperature: Float) -> Bearing:
    """The inner ring is warmer than the outer one: a preload that grows with temperature."""
    return replace(bearing, preload=bearing.preload + rise * (oil_temperature - OIL.zero))


BEARING_TORQUE = Model(
    name="bearing_torque",
    title="Friction torque of a roller bearing",
    function=bearing_torque,
    errors=[
        Tolerance("lubricant_factor", normal(sd="8 %"), why="the table gives a range"),
        Tolerance("friction_factor", normal(sd="8 %"), why="the table gives a range"),
        acting(bent_load_law, Unknown("exponent", -0.5, 0.8)),
        acting(starvation, Unknown("loss", 0, 1000, "s^2/m^2")),
        acting(seal_drag, Unknown("torque", 0, 2, "N*m")),
        acting(churning, Unknown("torque", 0, 2, "N*m")),
        acting(wrong_oil, Unknown("thinner", -0.6, 0.6)),
        acting(tight_fit, Unknown("rise", 0, 0.2, "kN/K"), needs=[OIL]),
    ],
)
