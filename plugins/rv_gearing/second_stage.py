"""The second stage: forces of disc and pins, their pressure, what friction takes, and the life of the crank bearings.

Disc and pins without clearance (``gear_geometry.cycloid``); clearance, wear and backlash are the business of rv_wear.
Two discs half a turn apart. Sizes that are not stated follow the torque of the power and the centre distance, as the
pin circle of the search does, and usual coefficients; they do not change with the load of a bench. SI throughout.
"""

import numpy as np

from gear_geometry import cycloid
from rv_gearing.geometry import ToothLoad
from rv_gearing.groups import centre_distance_of, output_torque, pin_circle_window
from rv_gearing.quantities import Gearing
from truing import Float, either, feasible, found, results

DISCS = 2.0
ANGLES, TURNS = 90, 36  # phase angles of pins; places of the crank against the disc
MILLION = 1e6
LEAST_LOAD = 1e-3  # N, of a bearing without load
BEARING = "ISO 281:2007"
DISC = "gear geometry, cycloid disc"


@results
class SecondStage:
    """Sizes, forces, pressure and efficiency of disc and pins, and the bearings between cranks and discs."""

    pin_circle: Float = found("mm", symbol="R_p", note="radius of the pin circle; as stated where it is",
                              method="else the middle of what suits torque and centre distance")  # fmt: skip
    crank_throw: Float = found("mm", symbol="e", note="eccentricity; as stated where it is",
                               formula="either(eccentricity, short_width * pin_circle / pins)")  # fmt: skip
    short_width_coefficient: Float = found("", symbol="K_1", note="below 1", formula="crank_throw * pins / pin_circle")
    pin_size: Float = found("mm", symbol="r_rp", note="radius of the pins; as stated where it is",
                            formula="either(pin_radius, pin_circle * sin(pi / pins) / pin_gap)")  # fmt: skip
    disc_size: Float = found("mm", symbol="B", note="width of a disc; as stated where it is",
                             formula="either(disc_width, 0.12 * pin_circle)")  # fmt: skip
    flank_radius: Float = found("mm", symbol="rho_min", note="least radius of the path of a pin in the convex flank; "
                                "pins above it undercut the disc", source=DISC, method="closed form")  # fmt: skip
    disc_torque: Float = found(
        "N*m", symbol="T_d", note="of one disc about its centre: half of what the pins hold, times its uneven share",
        formula="disc_load_factor * (output_torque - sun_torque) / 2 * (pins - 1) / pins",
    )  # fmt: skip
    pin_force: Float = found("N", symbol="F_max", note="largest force of a pin", source=DISC,
                             formula="4 * disc_torque / (short_width_coefficient * (pins - 1) * pin_circle)"
                             )  # fmt: skip
    pin_pressure: Float = found("MPa", symbol="p_max", note="largest pressure of Hertz between disc and pins",
                                source="Hertz", method="largest over the phase angles of the pins")  # fmt: skip
    force_across: Float = found("N", symbol="R_y", note="of all pins of a disc across its eccentricity", source=DISC,
                                formula="disc_torque / (crank_throw * (pins - 1))")  # fmt: skip
    force_along: Float = found(
        "N", symbol="R_x", note="of all pins of a disc along its eccentricity; below 0 inward", source=DISC,
        formula="pin_force * pins / (2 * pi) * ((1 - short_width_coefficient**2) * log((1 + short_width_coefficient)"
        " / (1 - short_width_coefficient)) - 2 * short_width_coefficient) / (2 * short_width_coefficient**2)",
    )  # fmt: skip
    pin_loss_efficiency: Float = found(
        "", symbol="eta_H6,c", note="of disc and pins that do not turn, with the cranks at rest; cycloid_efficiency is "
        "what is used", source=DISC,
        formula="1 - pin_friction * 4 * (1 - pin_size / pin_circle) / (pi * short_width_coefficient * (pins - 1))",
    )  # fmt: skip
    crank_moving: Float = found("N", symbol="F_R", note="of a crank bearing, by the pins: turns with the crank",
                                formula="hypot(force_across, force_along) / planets")  # fmt: skip
    crank_standing: Float = found("N", symbol="F_T", note="of a crank bearing, by the torque: stands in the disc",
                                  formula="disc_torque / (planets * centre_distance)")  # fmt: skip
    crank_load: Float = found("N", symbol="F_c", note="largest of a crank bearing",
                              formula="crank_moving + crank_standing")  # fmt: skip
    equivalent_load: Float = found("N", symbol="P", note="of a crank bearing, over a turn; as stated where it is",
                                   source=BEARING, method="mean of the power of the exponent of life")  # fmt: skip
    crank_speed: Float = found("rpm", symbol="n_c", note="of a crank against its disc",
                               formula="mesh_speed * teeth_sun / teeth_planet")  # fmt: skip
    needed_rating: Float = found(
        "kN", symbol="C_n", note="dynamic rating of a crank bearing that lasts the working time", source=BEARING,
        formula="equivalent_load * (crank_speed * working_life / 1000000)**(1 / bearing_exponent)",
    )  # fmt: skip
    million_turns: Float = found("", symbol="L_10", note="million turns that nine of ten crank bearings last",
                                 source=BEARING,
                                 formula="either((bearing_rating / equivalent_load)**bearing_exponent, crank_speed"
                                         " * working_life / 1000000)")  # fmt: skip
    bearing_life: Float = found("h", symbol="L_10h", note="time that nine of ten crank bearings last; where no "
                                "rating is stated, the working time that is asked for", source=BEARING,
                                formula="million_turns * 1000000 / crank_speed")  # fmt: skip


def second_stage(stage: Gearing, load: ToothLoad, centre_distance: Float) -> SecondStage:
    """Return sizes, forces and lives of the second stage under the torque of a stage."""
    duty, pins = load.duty, load.duty.pins
    circle, throw, pin, width = sizes_of(stage, load)
    short = throw * pins / circle
    feasible(short < 1.0, "eccentricity * pins exceeds pin_circle_radius: the disc would cross itself; lower one of "
             "eccentricity and short_width, or raise pin_circle_radius")  # fmt: skip
    torque = stage.disc_load_factor * (duty.output_torque - duty.sun_torque) / DISCS * (pins - 1.0) / pins
    torque = np.maximum(torque, 0.0)
    across, along = cycloid.resultant(torque, short, pins, circle)
    moving = np.hypot(across, along) / stage.planets
    standing = torque / (stage.planets * centre_distance)
    power = stage.bearing_exponent
    equivalent = either(stage.stated_crank_load, np.maximum(mean_load(moving, standing, power), LEAST_LOAD))
    speed = duty.mesh_speed * load.sun / load.planet
    asked = speed * stage.working_life / MILLION
    turns = either((stage.bearing_rating / equivalent) ** power, asked)
    lost = cycloid.sliding_share(short, pins, (circle, pin))
    return SecondStage(
        pin_circle=circle, crank_throw=throw, short_width_coefficient=short, pin_size=pin, disc_size=width,
        flank_radius=cycloid.least_convex_radius(short, pins, circle), disc_torque=torque,
        pin_force=cycloid.largest_force(torque, short, pins, circle),
        pin_pressure=largest_pressure(stage, (circle, pin, width), short, pins, torque), force_across=across,
        force_along=along, pin_loss_efficiency=1.0 - stage.pin_friction * lost, crank_moving=moving,
        crank_standing=standing, crank_load=moving + standing, equivalent_load=equivalent, crank_speed=speed,
        needed_rating=equivalent * asked ** (1.0 / power), million_turns=turns, bearing_life=turns * MILLION / speed,
    )  # fmt: skip


def sizes_of(stage: Gearing, load: ToothLoad) -> tuple[Float, Float, Float, Float]:
    """Return the radius of the pin circle, eccentricity, radius of the pins and width of a disc, m."""
    pins = load.duty.pins
    window = pin_circle_window(
        stage, output_torque(stage, load.efficiency), centre_distance_of(stage, load.sun, load.planet)
    )
    circle = either(stage.pin_circle_radius, 0.5 * (window[0] + window[1]))
    throw = either(stage.eccentricity, stage.short_width * circle / pins)
    pin = either(stage.pin_radius, circle * np.sin(np.pi / pins) / stage.pin_gap)
    return circle, throw, pin, either(stage.disc_width, 0.12 * circle)


def largest_pressure(
    stage: Gearing, sizes: tuple[Float, Float, Float], short: Float, pins: Float, torque: Float
) -> Float:
    """Return the largest pressure of Hertz over all pins, Pa; ``sizes``: pin circle, pin, width; steel on steel."""
    modulus = stage.sun.young_modulus / (2.0 * (1.0 - stage.sun.poisson_ratio**2))
    squares = 0.0 * torque
    for angle in (np.arange(ANGLES) + 0.5) / ANGLES * np.pi:
        carried = np.sin(angle) / cycloid.pin_distance(short, angle)
        radius = cycloid.relative_radius(short, pins, (sizes[0], sizes[1]), angle)
        squares = np.maximum(squares, carried / np.maximum(radius, 1e-7))
    force = cycloid.largest_force(torque, short, pins, sizes[0])
    return np.sqrt(force * squares * modulus / (np.pi * sizes[2]))


def mean_load(moving: Float, standing: Float, power: Float) -> Float:
    """Return the load that wears out a bearing as fast as one part that turns and one that stands, N.

    (mean of |F|^p)^(1/p) over a turn of the one against the other.
    """
    total = 0.0 * (moving + standing)
    scale = np.maximum(moving + standing, 1e-9)
    for place in np.arange(TURNS) / TURNS * 2.0 * np.pi:
        square = np.square(moving) + np.square(standing) + 2.0 * moving * standing * np.cos(place)
        total = total + (np.sqrt(np.maximum(square, 0.0)) / scale) ** power
    return scale * (total / TURNS) ** (1.0 / power)
