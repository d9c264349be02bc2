"""What the calculation is told: flanks, materials, one pair of teeth, the drive, and what acts on it."""

from typing import Literal

from harmonic_fractal.flank import Flank, read_flank
from truing import Float, given, inputs, loaded, part

PATENT = "the patent"
CATALOGUE = "catalogue of component sets, size 20, ratio 100"
HANDBOOK = "handbook: alloy steel"
NEUTRAL = "neutral; effects act here"
SIZES = Literal["14", "17", "20", "25", "32", "40", "50", "58"]


@inputs
class Material:
    """One of the two bodies in contact."""

    youngs_modulus: Float = given(206.0, "GPa", symbol="E", note="Young's modulus", source=HANDBOOK, above=0,
                                  at_most=2000)  # fmt: skip
    poisson_ratio: Float = given(0.30, "", symbol="nu", note="Poisson's ratio", source=HANDBOOK, at_least=0, below=0.5)


@inputs
class Drive:
    """Two rough flanks, the pair of teeth they belong to, and the harmonic drive around it."""

    # The flanks
    surface: Flank | None = loaded(
        read_flank, default=None, note="measured flank of the flexspline; where it has a self-affine range its D and G "
        "replace those stated",
    )  # fmt: skip
    mating_surface: Flank | None = loaded(
        read_flank, default=None, note="measured flank of the circular spline; without it and without mating_dimension "
        "that flank is smooth",
    )  # fmt: skip
    fractal_dimension: Float = given(2.4, "", symbol="D_1", note="fractal dimension of the surface of the flank, one "
                                     "above that of its profiles", source="typical", above=2, below=3)  # fmt: skip
    fractal_roughness: Float = given(
        1e-11, "m", symbol="G_1", note="fractal roughness of the flank, in the convention stated beside it",
        source="typical", above=0, at_most=1e-3, stated_with="convention",
    )  # fmt: skip
    mating_dimension: Float = given(None, "", symbol="D_2", note="fractal dimension of the mating flank; without it "
                                    "that one is smooth", above=2, below=3)  # fmt: skip
    mating_roughness: Float = given(None, "m", symbol="G_2", note="fractal roughness of the mating flank, likewise",
                                    above=0, at_most=1e-3, stated_with="convention")  # fmt: skip
    convention: Literal["areal", "one_direction", "profile"] = given(
        "areal", note="convention of G as stated: areal (ridges in all directions), one_direction (ridges across the "
        "trace), or profile (Weierstrass-Mandelbrot profile, with the logarithm of the density)",
    )  # fmt: skip
    density: Float = given(1.5, "", symbol="gamma", note="ratio of neighbouring frequencies of the surface",
                           source=PATENT, above=1, at_most=10)  # fmt: skip
    sampling: Float = given(0.4, "um", symbol="dx", note="sampling interval from which D and G come", above=0,
                            at_most=1000)  # fmt: skip
    longest_lag: Float = given(20.0, "um", symbol="xi_max", note="longest lag of the range in which two flanks are "
                               "added", source="a tenth of 0.2 mm", above=0, at_most=10000)  # fmt: skip
    lags: Float = given(
        (0.4, 0.6, 1.0, 1.6, 2.5, 4.0, 6.0, 10.0, 16.0, 20.0), "um", symbol="xi", along="lag",
        note="lags at which the structure function is shown",
    )  # fmt: skip
    # Materials
    flexspline: Material = part(Material, index="1")
    circular: Material = part(Material, index="2")
    hardness: Float = given(3.0, "GPa", symbol="H", note="indentation hardness of the softer flank, HV times 9.81 MPa",
                            source="handbook: 306 HV", above=0, at_most=100)  # fmt: skip
    critical_rule: Literal["hardness", "yield_onset"] = given(
        "hardness", note="where a contact turns elastic: its elastic load equals hardness times area, or first yield",
    )  # fmt: skip
    tip_rule: Literal["fixed", "scaled"] = given(
        "fixed", note="tip radius of a contact while it is pressed: its own, or following its area",
    )  # fmt: skip
    # One pair of teeth
    pair_load: Float = given(25.0, "N", symbol="F", note="normal load of the pair that is looked at", above=0,
                             at_most=1e6)  # fmt: skip
    face_width: Float = given(10.0, "mm", symbol="l", note="length of contact", above=0, at_most=1000)
    flank_height: Float = given(0.4, "mm", symbol="h", note="height of the flank that can touch", above=0, at_most=100)
    clearance_rule: Literal["amplitude", "interference", "patch"] = given(
        "amplitude", note="what equation 7 is read as: amplitude of the largest contact, its whole interference, or "
        "amplitude of the longest wave of the patch",
    )  # fmt: skip
    patch_length: Float = given(0.2, "mm", symbol="L", note="length of the measured patch", source=PATENT, above=0,
                                at_most=100)  # fmt: skip
    peak_height: Float = given(None, "um", symbol="S_z1", note="height of the flank; else that of its surface, else of "
                               "its fractal patch", above=0, at_most=1000)  # fmt: skip
    mating_peak_height: Float = given(None, "um", symbol="S_z2", note="height of the mating flank; else as above",
                                      at_least=0, at_most=1000)  # fmt: skip
    # The drive
    catalogue_size: SIZES = given("20", note="size in the catalogue, with which the torsion is compared")
    pitch_radius: Float = given(25.4, "mm", symbol="r_p", note="pitch radius", source=CATALOGUE, above=0, at_most=5000)
    pressure_angle: Float = given(20.0, "deg", symbol="alpha", note="pressure angle", at_least=0, below=60)
    flexspline_teeth: int = given(200, symbol="z_1", note="teeth of the flexspline; the circular spline has two more",
                                  source=CATALOGUE, at_least=20, at_most=2000)  # fmt: skip
    engaged_pairs: int = given(60, symbol="N_e", note="engaged pairs of teeth, in two opposite arcs",
                               source="30 % of the teeth", at_least=1, at_most=2000)  # fmt: skip
    torque: Float = given(25.0, "N*m", symbol="T", note="torque at the output; its sign is its sense",
                          source=CATALOGUE, at_least=-1e6, at_most=1e6)  # fmt: skip
    reference_torque: Float = given(
        1.0, "mN*m", symbol="T_0", note="torque from which the torsion counts; from 0 it would be infinite", above=0,
        at_most=1e6,
    )  # fmt: skip
    tooth_stiffness: Float = given(None, "N/m", symbol="k_t", note="bending of the teeth and rim of one pair; not "
                                   "given: rigid", above=0)  # fmt: skip
    line_contact: bool = given(False, note="whether the flanks as a whole flatten too, as two cylinders do")
    cup_radius: Float = given(24.5, "mm", symbol="r_c", note="mean radius of the cup", above=0, at_most=5000)
    cup_wall: Float = given(0.35, "mm", symbol="t_c", note="wall of the cup", above=0, at_most=100)
    cup_length: Float = given(0.0, "mm", symbol="l_c", note="length of the cup that twists; 0: it is rigid",
                              at_least=0, at_most=5000)  # fmt: skip
    drive_compliance: Float = given(
        0.0, "urad/(N*m)", symbol="c_s", note="compliance in series with the mesh: cup, wave generator, bearing, rig",
        at_least=0, at_most=1e6,
    )  # fmt: skip
    # What is asked
    required_stiffness: Float = given(None, "N/m", symbol="K_req", note="stiffness asked of the pair; not given: none",
                                      above=0, at_most=1e15)  # fmt: skip
    required_reliability: Float = given(0.95, "", symbol="R_req", note="share of drives that must reach it", above=0,
                                        below=1)  # fmt: skip
    # Neutral inputs: errors and effects reach the calculation through them
    dimension_deviation: Float = given(0.0, "", symbol="Delta D", at_least=-1, at_most=1,
                                       note=f"deviation of D of both flanks together, {NEUTRAL}")  # fmt: skip
    roughness_deviation: Float = given(0.0, "", symbol="Delta ln G", at_least=-30, at_most=30,
                                       note=f"deviation of ln G of both flanks together, {NEUTRAL}")  # fmt: skip
    modulus_factor: Float = given(1.0, "", symbol="f_E", note=f"factor on the elasticity of all steel, {NEUTRAL}",
                                  above=0, at_most=10)  # fmt: skip
    engaged_factor: Float = given(1.0, "", symbol="f_N", note=f"engaged pairs over those stated, {NEUTRAL}", above=0,
                                  at_most=100)  # fmt: skip
    engaged_gain: Float = given(0.0, "", symbol="g_N", note="pairs that come to bear under a large torque, over those "
                                f"without it, {NEUTRAL}", at_least=0, at_most=100)  # fmt: skip
    engaged_torque: Float = given(20.0, "N*m", symbol="T_N", note=f"torque under which 63 % of those bear, {NEUTRAL}",
                                  above=0, at_most=1e6)  # fmt: skip
    film_stiffness: Float = given(0.0, "N/m", symbol="k_oil", note="stiffness of an oil film that fills the flank, "
                                  "beside the contacts of a pair", at_least=0)  # fmt: skip
    spot_width: Float = given(0.0, "um", symbol="w_s", note="standard deviation of the weight by which an instrument "
                              f"averages along a line, for the structure function alone, {NEUTRAL}", at_least=0,
                              at_most=1000)  # fmt: skip
