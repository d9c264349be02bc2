"""What the calculation answers: interface, one pair of teeth, mesh and torsion."""

from truing import Float, axis, found, results


@results
class Stiffness:
    """Of the rough interface, of one pair of teeth, of the mesh and of the drive."""

    lag: Float = axis("um", symbol="xi", note="lag of the structure function", follows="lags")
    structure_function: Float = found("um^2", symbol="S", note="mean square of the difference of height over a lag, of "
                                      "both flanks together", along="lag", method="power law")  # fmt: skip
    dimension: Float = found("", symbol="D", note="fractal dimension of both flanks together", method="see text")
    roughness: Float = found("m", symbol="G", note="fractal roughness of both, areal convention", method="see text")
    stiffness: Float = found("N/m", symbol="K", note="normal stiffness of one pair", method="see text")
    mesh_stiffness: Float = found("N*m/rad", symbol="K_mesh", note="of all engaged pairs", method="see text")
    torsion: Float = found("urad", symbol="theta", note="from the reference torque on", method="see text")
