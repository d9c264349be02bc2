"""What is told of a made flank: its truth, its heights, its structure function, and what an estimator makes of it."""

from truing import Float, found, results, rows

PLANE = "after its mean plane, or line, is taken away"


@results
class MadeFlank:
    """The truth, the flank that was made, and the truth as it is found again."""

    profile_dimension: Float = found("", symbol="D_s", note="dimension of its profiles",
                                     formula="fractal_dimension - 1")  # fmt: skip
    areal_roughness: Float = found(
        "m", symbol="G_areal", note="roughness in the areal convention, which the estimator gives",
        method="the same structure function along the lines, written in the areal convention",
    )  # fmt: skip
    points: Float = found("", symbol="N_x", note="points of a line", digits=9,
                          method="spacings that fit into the length, and one more")  # fmt: skip
    lines: Float = found("", symbol="N_y", note="lines", digits=9,
                         method="spacings that fit into the width, and one more")  # fmt: skip
    longest: Float = found("mm", symbol="lambda_1", note="longest wave of the sum; Brownian motion has longer ones",
                           method="stated, or by rule")  # fmt: skip
    shortest: Float = found("um", symbol="lambda_n", note="shortest wave of the sum; Brownian motion has shorter ones",
                            method="stated, or by rule")  # fmt: skip
    rms_height: Float = found("nm", symbol="S_q", note=f"root mean square height {PLANE}", method="of the points")
    height: Float = found("nm", symbol="S_z", note=f"from the lowest to the highest point {PLANE}",
                          method="of the points")  # fmt: skip
    lag: Float = rows("lag", unit="um")
    structure_function: Float = found("nm^2", symbol="S", note="S of this flank as measured", along="lag",
                                      method="mean square of the difference of height, of all pairs")  # fmt: skip
    exact: Float = found("nm^2", symbol="S_exact", note="S of all flanks of this truth, before the instrument",
                         along="lag", method="sum over all waves; of Brownian motion its power law")  # fmt: skip
    power_law: Float = found("nm^2", symbol="S_law", note="power law", along="lag", method="closed form")
    fitted_dimension: Float = found("", symbol="D_fit", note="dimension of the surface, found again",
                                    method="straight line through ln S over ln lag, along the lines")  # fmt: skip
    fitted_roughness: Float = found("m", symbol="G_fit", note="roughness found again, areal convention",
                                    method="of the same fit")  # fmt: skip
    dimension_error: Float = found("", symbol="e_D", note="found less true",
                                   formula="fitted_dimension - fractal_dimension")  # fmt: skip
    roughness_error: Float = found("", symbol="e_G", note="decades by which the roughness found is above the true one",
                                   formula="log10(fitted_roughness / areal_roughness)")  # fmt: skip
    accepted: Float = found("", note="1 where the estimator sees a self-affine range, 0 where it refuses",
                            method="local slopes", digits=1)  # fmt: skip
