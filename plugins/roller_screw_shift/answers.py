"""What the roller screw calculation answers: geometry, objectives, constraints, stresses and what effects act on."""

from truing import Float, found, results

BASE = "0 in the calculation; effects act here"


@results
class Meshing:
    """The pair of roller and ring at one profile shift."""

    working_angle: Float = found("deg", symbol="alpha_w", note="working pressure angle", method="cosine rule")
    ring_shift: Float = found("", symbol="x_I", note="profile shift of the ring", method="no backlash")
    root_stress_roller: Float = found("MPa", symbol="sigma_FE", note="root stress of the roller", method="30° tangent")
    root_stress_ring: Float = found("MPa", symbol="sigma_FI", note="root stress of the ring", method="substitute rack")
    transmission_error: Float = found("um", symbol="TE", note="along the line of action", method=BASE)
    wear_depth: Float = found("um", symbol="h", note="wear of the flank of the roller", method=BASE)
    axial_shift: Float = found("um", symbol="Delta z", note="of a roller along the screw", method=BASE)
    friction_torque: Float = found("N*m", symbol="M_R", note="of the meshes, at the screw", method=BASE)
    backlash: Float = found("um", symbol="j_t", note="at the working pitch circle", method=BASE)
