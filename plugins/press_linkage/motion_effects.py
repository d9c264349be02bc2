"""What makes a press in motion need another torque than its drawing says: friction, air, masses, and a shifted zero."""

from dataclasses import replace

from press_linkage.motion_quantities import MovingPress, PressMotion
from truing import Effect, Float, Tolerance, Unknown, normal


def guide_friction(press: MovingPress, *, friction: Float) -> MovingPress:
    """Dry friction in the guides holds the slider with one force, against its way."""
    return replace(press, guide_friction=press.guide_friction + friction)


def bearing_friction(press: MovingPress, *, friction_radius: Float) -> MovingPress:
    """Every pin rubs in its bore under the force that it carries; coefficient times radius is one length for all."""
    return replace(press, bearing_friction=press.bearing_friction + friction_radius)


def drive_drag(press: MovingPress, *, drag: Float) -> MovingPress:
    """Oil in gears and bearings of the drive holds each crank in proportion to its speed."""
    return replace(press, drive_drag=press.drive_drag + drag)


def counterbalance_loss(press: MovingPress, *, loss: Float) -> MovingPress:
    """The cylinders lift with less than stated: their pressure is too low, or a seal leaks."""
    return replace(press, counterbalance=press.counterbalance * (1.0 - loss))


def heavier_slider(press: MovingPress, *, mass: Float) -> MovingPress:
    """More hangs on the slider than stated: its weight and its inertia grow."""
    return replace(press, slider_mass=press.slider_mass + mass)


def crank_phase(press: MovingPress, *, phase: Float) -> MovingPress:
    """Both cranks are ahead of the angle that is stated; what is stated over the times stays where it is."""
    return replace(press, start_angle=press.start_angle + phase)


EFFECTS: list[Effect[MovingPress, PressMotion]] = [
    Effect("guide_friction", on_inputs=guide_friction,
           unknowns=[Unknown("friction", 0, 500, "kN", "of all guides together")],
           looks_like="a torque that follows the travel of the slider per crank angle, against the drive on the way "
                      "down and up alike, whatever speed and force; nothing at the dead centres",
           remedy="Oil the guides, check the gibs, and see whether the work pushes the slider aside; less torque is "
                  "then needed in mid-stroke.",
           why="gibs are set too tight, the slider is pushed aside by the work, or the guides run dry",
           source="Coulomb friction"),
    Effect("bearing_friction", on_inputs=bearing_friction,
           unknowns=[Unknown("friction_radius", 0, 50, "mm", "friction coefficient times radius of the pins")],
           looks_like="the torque is larger where joints carry much, above all under the force of the work near the "
                      "bottom dead centre, where guide friction does nothing",
           remedy="Check that oil reaches the pins, and renew those that are scored; less torque is then needed under "
                  "the force of the work.",
           why="pins run with little oil; 0.1 on a radius of 100 mm are 10 mm",
           source="Coulomb friction of a pin in its bore"),
    Effect("drive_drag", on_inputs=drive_drag,
           unknowns=[Unknown("drag", 0, 50, "kN*m*s", "torque of one crank per angular speed")],
           looks_like="a constant torque at constant speed, in proportion to the speed",
           remedy="Let gears and bearings of the drive warm up, or check the viscosity of their oil; less torque is "
                  "then needed at constant speed.",
           why="gears churn cold oil, plain bearings of the crankshaft are viscous",
           source="viscous friction"),
    Effect("counterbalance_loss", on_inputs=counterbalance_loss,
           unknowns=[Unknown("loss", -50, 100, "%", "share of the force of the cylinders that is missing")],
           looks_like="the drive is pulled on the way down and must lift on the way up; no change with the speed",
           remedy="Check the gauge, set the pressure for this tool, and look for leaks; the torque is then as "
                  "calculated on the way down and up.",
           why="the pressure was set for a lighter tool, or a cylinder leaks",
           source="virtual work"),
    Effect("heavier_slider", on_inputs=heavier_slider,
           unknowns=[Unknown("mass", -10, 50, "t", "of the slider beyond what is stated")],
           looks_like="as a lack of counterbalance, and beside it inertia that grows with the square of the speed",
           remedy="Weigh the upper die, state the mass as slider_mass, and set the counterbalance for it; the torque "
                  "then fits at every speed.",
           why="the upper die is heavier than its record says",
           source="weight and inertia"),
    Effect("crank_phase", on_inputs=crank_phase,
           unknowns=[Unknown("phase", -100, 100, "mrad", "cranks ahead of the angle that is stated")],
           looks_like="the whole torque comes earlier",
           remedy="Set the zero of the encoder at the dead centre, and check the coupling for slip; the torque then "
                  "comes at its crank angle.",
           why="the zero of the encoder was set beside the dead centre, or a coupling has slipped",
           source="kinematics of the linkage"),
]  # fmt: skip

TOLERANCES = [
    Tolerance("slider_mass", normal(sd="1 %"), why="weighed with its upper die; assumed"),
    Tolerance("counterbalance", normal(sd="2 %"), why="pressure gauge of the cylinders; assumed"),
    Tolerance(
        "link_mass",
        normal(sd="3 %"),
        on=[f"mass_{link}" for link in ("crank", "rod", "knee_drive", "upper_knee", "lower_knee")],
        why="calculated; assumed",
    ),
    Tolerance("platform_mass", normal(sd="3 %"), why="calculated; assumed"),
    Tolerance("rotor_inertia", normal(sd="10 %"), why="of motor and gears from catalogues; assumed"),
    Tolerance("start_angle", normal(sd="0.1 deg"), why="zero of the encoder; assumed"),
]
