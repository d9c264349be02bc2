"""What a made flank is told: its truth, its size, the waves it consists of, and the instrument that looks at it."""

from typing import Literal

from truing import Float, given, inputs

TYPICAL = "typical of ground and shaped flanks"
PATCH = "the patch of 0.2 mm by 0.1 mm of the patent"
RULE = "rule for trying an estimator"


@inputs
class Made:
    """A flank of known dimension and roughness."""

    kind: Literal["areal", "brownian", "profile"] = given(
        "areal", note="waves in all directions (Weierstrass-Mandelbrot, areal), fractional Brownian motion, or lines "
        "of a Weierstrass-Mandelbrot profile that know nothing of one another",
    )  # fmt: skip
    fractal_dimension: Float = given(2.4, "", symbol="D", note="fractal dimension of the surface, one above that of "
                                     "its profiles", source=TYPICAL, above=2, below=3)  # fmt: skip
    fractal_roughness: Float = given(
        1e-11, "m", symbol="G", note="fractal roughness, in the convention stated beside it", source=TYPICAL, above=0,
        at_most=1e-3, stated_with="convention",
    )  # fmt: skip
    convention: Literal["areal", "one_direction", "profile"] = given(
        "areal", note="of G as stated: areal (ridges in all directions), one_direction (ridges across the trace), or "
        "profile (Weierstrass-Mandelbrot profile, with the logarithm of the density)",
    )  # fmt: skip
    density: Float = given(1.5, "", symbol="gamma", note="ratio of neighbouring frequencies", source="the patent",
                           above=1, at_most=10)  # fmt: skip
    # The patch
    length: Float = given(200.0, "um", symbol="L_x", note="along the lines", source=PATCH, above=0, at_most=1e5)
    width: Float = given(100.0, "um", symbol="L_y", note="across the lines; 0: a single profile", source=PATCH,
                         at_least=0, at_most=1e5)  # fmt: skip
    spacing: Float = given(0.4, "um", symbol="dx", note="of the points, both ways", above=0, at_most=1000)
    # The waves
    directions: int = given(40, symbol="M", note="directions of the ridges of an areal surface, over half a turn; "
                            "with 1 they all run across the lines", at_least=1, at_most=1000)  # fmt: skip
    longest_wave: Float = given(None, "mm", symbol="lambda_max", note="not given: 100 times the longer side of the "
                                "patch", source=RULE, above=0)  # fmt: skip
    shortest_wave: Float = given(None, "um", symbol="lambda_min", note="not given: a fiftieth of the spacing",
                                 source=RULE, above=0)  # fmt: skip
    seed: int = given(0, note="of all that is random; another one gives another flank of the same truth", at_least=0)
    # The instrument
    filter_cutoff: Float = given(0.0, "um", symbol="lambda_s", note="wave length of which half the amplitude passes "
                                 "the lateral filter; 0: no filter", source="ISO 16610-21", at_least=0,
                                 at_most=1e4)  # fmt: skip
    noise: Float = given(0.0, "nm", symbol="sigma_z", note="standard deviation of the height of each point",
                         at_least=0, at_most=1e6)  # fmt: skip
    height_step: Float = given(0.0, "nm", note="smallest difference of height that is told", at_least=0, at_most=1e6)
    spikes: Float = given(0.0, "%", note="share of points that stand out", at_least=0, at_most=50)
    spike_height: Float = given(500.0, "nm", note="by which they stand out, up or down", at_least=0, at_most=1e6)
    holes: Float = given(0.0, "%", note="share of points that were not measured", at_least=0, at_most=50)
    # How dimension and roughness are found again
    noise_aware: bool = given(False, note="fit a constant of white noise beside the power law")
    shortest_lag: Float = given(None, "um", symbol="xi_min", note="of the fit; not given: the spacing", above=0,
                                at_most=1e5)  # fmt: skip
