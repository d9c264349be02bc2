"""What the gearing calculation answers: the duty, every factor, the stresses, and what they may be."""

from truing import Float, found, part, results

BASE = "0 in the calculation; effects act here"


@results
class GearStress:
    """Root stress of one gear and what it may be."""

    root_stress: Float = found("MPa", symbol="sigma_F", note="root stress, load at the tip", method="equation 10")


@results
class Strength:
    """The first stage under its load."""

    contact_stress: Float = found("MPa", symbol="sigma_H1", note="contact stress of the sun", method="equation 13")
    transmission_error: Float = found("um", symbol="TE", note="along the line of action", method=BASE)
    efficiency: Float = found("", symbol="eta", note="input to output", method="equations 6 to 8")
    flank_temperature: Float = found("degC", symbol="theta_M", note="of the flanks", method="that of the oil")
    backlash: Float = found("um", symbol="j_n", note="along the line of action", method=BASE)
    sun: GearStress = part(GearStress, index="1")
    planet: GearStress = part(GearStress, index="2")
