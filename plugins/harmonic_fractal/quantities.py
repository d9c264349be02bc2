"""What the calculation is told and what it answers: flanks, materials, one pair of teeth, the mesh, the drive."""

from typing import Literal

from harmonic_fractal.flank import Flank, read_flank
from truing import Float, axis, found, given, inputs, loaded, part, results

PATENT = "the patent"
CATALOGUE = "catalogue of component sets, size 20, ratio 100"
HANDBOOK = "handbook: alloy steel"
NEUTRAL = "neutral; effects act here"
SIZES = Literal["14", "17", "20", "25", "32", "40", "50", "58"]


@inputs
class Material:
    """One of the two bodies in contact."""

    youngs_modulus: Float = given(206.0, "GPa", "E", "Young's modulus", HANDBOOK, above=0, at_most=2000)
    poisson_ratio: Float = given(0.30, "", "nu", "Poisson's ratio", HANDBOOK, at_least=0, below=0.5)


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
    fractal_dimension: Float = given(2.4, "", "D_1",
                                     "fractal dimension of the surface of the flank, one above that of its profiles",
                                     "typical", above=2, below=3)  # fmt: skip
    fractal_roughness: Float = given(1e-11, "m", "G_1",
                                     "fractal roughness of the flank, in the convention stated beside it", "typical",
                                     above=0, at_most=1e-3, stated_with="convention")  # fmt: skip
    mating_dimension: Float = given(
        None, "", "D_2", "fractal dimension of the mating flank; without it that one is smooth", above=2, below=3
    )
    mating_roughness: Float = given(None, "m", "G_2", "fractal roughness of the mating flank, likewise", above=0,
                                    at_most=1e-3, stated_with="convention")  # fmt: skip
    convention: Literal["areal", "one_direction", "profile"] = given(
        "areal",
        note="convention of G as stated: areal (ridges in all directions), one_direction (ridges across the trace), or "
             "profile (Weierstrass-Mandelbrot profile, with the logarithm of the density)",
    )  # fmt: skip
    density: Float = given(1.5, "", "gamma", "ratio of neighbouring frequencies of the surface", PATENT, above=1,
                           at_most=10)  # fmt: skip
    sampling: Float = given(0.4, "um", "dx", "sampling interval from which D and G come", above=0, at_most=1000)
    longest_lag: Float = given(20.0, "um", "xi_max", "longest lag of the range in which two flanks are added",
                               "a tenth of 0.2 mm", above=0, at_most=10000)  # fmt: skip
    lags: Float = given((0.4, 0.6, 1.0, 1.6, 2.5, 4.0, 6.0, 10.0, 16.0, 20.0), "um", "xi",
                        "lags at which the structure function is shown", along="lag")  # fmt: skip
    # Materials
    flexspline: Material = part(Material, index="1")
    circular: Material = part(Material, index="2")
    hardness: Float = given(3.0, "GPa", "H", "indentation hardness of the softer flank, HV times 9.81 MPa",
                            "handbook: 306 HV", above=0, at_most=100)  # fmt: skip
    critical_rule: Literal["hardness", "yield_onset"] = given(
        "hardness", note="where a contact turns elastic: its elastic load equals hardness times area, or first yield"
    )
    tip_rule: Literal["fixed", "scaled"] = given(
        "fixed", note="tip radius of a contact while it is pressed: its own, or following its area"
    )
    # One pair of teeth
    pair_load: Float = given(25.0, "N", "F", "normal load of the pair that is looked at", above=0, at_most=1e6)
    face_width: Float = given(10.0, "mm", "l", "length of contact", above=0, at_most=1000)
    flank_height: Float = given(0.4, "mm", "h", "height of the flank that can touch", above=0, at_most=100)
    clearance_rule: Literal["amplitude", "interference", "patch"] = given(
        "amplitude",
        note="what equation 7 is read as: amplitude of the largest contact, its whole interference, or amplitude of "
             "the longest wave of the patch",
    )  # fmt: skip
    patch_length: Float = given(0.2, "mm", "L", "length of the measured patch", PATENT, above=0, at_most=100)
    peak_height: Float = given(None, "um", "S_z1",
                               "height of the flank; else that of its surface, else of its fractal patch", above=0,
                               at_most=1000)  # fmt: skip
    mating_peak_height: Float = given(None, "um", "S_z2", "height of the mating flank; else as above", at_least=0,
                                      at_most=1000)  # fmt: skip
    # The drive
    catalogue_size: SIZES = given("20", note="size in the catalogue, with which the torsion is compared")
    pitch_radius: Float = given(25.4, "mm", "r_p", "pitch radius", CATALOGUE, above=0, at_most=5000)
    pressure_angle: Float = given(20.0, "deg", "alpha", "pressure angle", at_least=0, below=60)
    flexspline_teeth: int = given(200, symbol="z_1", note="teeth of the flexspline; the circular spline has two more",
                                  source=CATALOGUE, at_least=20, at_most=2000)  # fmt: skip
    engaged_pairs: int = given(60, symbol="N_e", note="engaged pairs of teeth, in two opposite arcs",
                               source="30 % of the teeth", at_least=1, at_most=2000)  # fmt: skip
    torque: Float = given(25.0, "N*m", "T", "torque at the output; its sign is its sense", CATALOGUE, at_least=-1e6,
                          at_most=1e6)  # fmt: skip
    reference_torque: Float = given(
        1.0, "mN*m", "T_0", "torque from which the torsion counts; from 0 it would be infinite", above=0, at_most=1e6
    )
    tooth_stiffness: Float = given(None, "N/m", "k_t", "bending of the teeth and rim of one pair; not given: rigid",
                                   above=0)  # fmt: skip
    line_contact: bool = given(False, note="whether the flanks as a whole flatten too, as two cylinders do")
    cup_radius: Float = given(24.5, "mm", "r_c", "mean radius of the cup", above=0, at_most=5000)
    cup_wall: Float = given(0.35, "mm", "t_c", "wall of the cup", above=0, at_most=100)
    cup_length: Float = given(0.0, "mm", "l_c", "length of the cup that twists; 0: it is rigid", at_least=0,
                              at_most=5000)  # fmt: skip
    drive_compliance: Float = given(0.0, "urad/(N*m)", "c_s",
                                    "compliance in series with the mesh: cup, wave generator, bearing, rig", at_least=0,
                                    at_most=1e6)  # fmt: skip
    # What is asked
    required_stiffness: Float = given(None, "N/m", "K_req", "stiffness asked of the pair; not given: none", above=0,
                                      at_most=1e15)  # fmt: skip
    required_reliability: Float = given(0.95, "", "R_req", "share of drives that must reach it", above=0, below=1)
    # Neutral inputs: errors and effects reach the calculation through them
    dimension_deviation: Float = given(0.0, "", "Delta D", f"deviation of D of both flanks together, {NEUTRAL}",
                                       at_least=-1, at_most=1)  # fmt: skip
    roughness_deviation: Float = given(0.0, "", "Delta ln G", f"deviation of ln G of both flanks together, {NEUTRAL}",
                                       at_least=-30, at_most=30)  # fmt: skip
    modulus_factor: Float = given(1.0, "", "f_E", f"factor on the elasticity of all steel, {NEUTRAL}", above=0,
                                  at_most=10)  # fmt: skip
    engaged_factor: Float = given(1.0, "", "f_N", f"engaged pairs over those stated, {NEUTRAL}", above=0, at_most=100)
    engaged_gain: Float = given(0.0, "", symbol="g_N", note="pairs that come to bear under a large torque, over those "
                                f"without it, {NEUTRAL}", at_least=0, at_most=100)  # fmt: skip
    engaged_torque: Float = given(20.0, "N*m", "T_N", f"torque under which 63 % of those bear, {NEUTRAL}", above=0,
                                  at_most=1e6)  # fmt: skip
    film_stiffness: Float = given(
        0.0, "N/m", "k_oil", "stiffness of an oil film that fills the flank, beside the contacts of a pair", at_least=0
    )
    spot_width: Float = given(0.0, "um", symbol="w_s", note="standard deviation of the weight by which an instrument "
                              f"averages along a line, for the structure function alone, {NEUTRAL}", at_least=0,
                              at_most=1000)  # fmt: skip


# What the calculation answers: interface, one pair of teeth, its clearance, the mesh, and the drive around it

HERTZ = "equation 8 of the patent; Hertz"
PATENT_6 = "equation 6 of the patent, lost there; Jiang, Zheng and Zhu 2010"
PATENT_7 = "equation 7 of the patent, with a radius in place of its area"
CONTACTS = "Yan and Komvopoulos 1998"
NUMBERS = "Wang and Komvopoulos 1994"
CATALOGUES = "catalogues of the maker, by size and ratio"
SHARES = "load shares by the square of the cosine along two opposite arcs"


@results
class Stiffness:
    """Of the rough interface, of one pair of teeth, of the mesh and of the drive."""

    lag: Float = axis("um", symbol="xi", note="lag of the structure function", follows="lags")
    structure_function: Float = found("um^2", "S",
                                      "mean square of the difference of height over a lag, of both flanks together",
                                      along="lag", method="power law of D and G, areal convention")  # fmt: skip
    # The interface
    surface_accepted: Float = found("", "I_a",
                                    "whether measured flanks are self-affine: 1, or 0 where one is refused and the "
                                    "stated D and G stand for it", method="local slopes of the structure function",
                                    digits=1)  # fmt: skip
    spacing: Float = found("um", "dx_s", "sampling interval behind D and G",
                           method="of the flank that was measured, else as stated")  # fmt: skip
    dimension: Float = found("", "D", "fractal dimension of both flanks together",
                             method="sum of both structure functions, fitted by one power law")  # fmt: skip
    profile_dimension: Float = found("", "D_s", "fractal dimension of profiles", "dimension - 1",
                                     "equation 5 of the patent")  # fmt: skip
    roughness: Float = found("m", "G", "fractal roughness of both, areal convention", method="as the dimension")
    # One pair of teeth
    equivalent_modulus: Float = found("GPa", "E", "equivalent modulus of both bodies",
                                      "modulus_factor / ((1 - poisson_ratio_flexspline**2) / youngs_modulus_flexspline"
                                      " + (1 - poisson_ratio_circular**2) / youngs_modulus_circular)",
                                      HERTZ)  # fmt: skip
    critical_pressure: Float = found("GPa", "p_c", "elastic load over area at which a contact turns elastic",
                                     method="by critical_rule: the hardness, or at first yield (0.454 + 0.41 Poisson's "
                                            "ratio of the circular spline)/3 of it")  # fmt: skip
    domain_factor: Float = found(
        "", "psi", "domain extension factor: it widens the distribution of areas",
        "(domain_factor**((2 - profile_dimension) / 2) - (1 + domain_factor**(-profile_dimension / 2))**(-(2"
        " - profile_dimension) / profile_dimension)) * profile_dimension / (2 - profile_dimension) == 1", NUMBERS,
    )  # fmt: skip
    critical_area: Float = found("um^2", "a_c", "critical truncated area; smaller contacts are plastic",
                                 "roughness**2 * (2**(11 - 2 * dimension) / (9 * pi**(4 - dimension)) * log(density)"
                                 " * (equivalent_modulus / critical_pressure)**2)**(1 / (dimension - 2))",
                                 CONTACTS)  # fmt: skip
    resolved_share: Float = found("", "q_r",
                                  "radius of the critical area over the sampling interval; below 0.3 the power law is "
                                  "used far below what was measured", "sqrt(critical_area / pi) / spacing")  # fmt: skip
    plastic_limit: Float = found(
        "N", "F_c", "load of a pair up to which all its contacts are plastic and it has no stiffness",
        "(dimension - 1) / (3 - dimension) * domain_factor**((3 - dimension) / 2) * hardness * critical_area",
    )  # fmt: skip
    largest_area: Float = found("um^2", "a_L", "truncated area of the largest contact",
                                "pair_load == cases(plastic_limit * area_ratio**((dimension - 1) / 2)"
                                " * (1 + (3 - dimension) * critical_pressure / hardness * elastic_sum), area_ratio > 1,"
                                " plastic_limit * area_ratio)", CONTACTS)  # fmt: skip
    area_ratio: Float = found("", "x", "largest over critical area; up to 1 all contacts are plastic",
                              "largest_area / critical_area")  # fmt: skip
    elastic_sum: Float = found("", "s_e", "what the elastic contacts add to the load; 0 without any",
                               "cases((max(area_ratio, 1)**((5 - 2 * dimension) / 2) - 1) / (5 - 2 * dimension),"
                               " abs(dimension - 2.5) > 1e-6, log(max(area_ratio, 1)) / 2)")  # fmt: skip
    plastic_share: Float = found(
        "%", "q_p", "share of the load on plastic contacts; at 100 % the pair has no stiffness",
        "cases(plastic_limit / pair_load * area_ratio**((dimension - 1) / 2), area_ratio > 1, 1)",
    )  # fmt: skip
    contact_area: Float = found("um^2", "A_t", "truncated area of all contacts",
                                "(dimension - 1) / (3 - dimension) * domain_factor**((3 - dimension) / 2)"
                                " * largest_area")  # fmt: skip
    real_area: Float = found("um^2", "A_r",
                             "real area: all of the plastic contacts, half of the truncated elastic ones",
                             "contact_area * (1 + max(area_ratio, 1)**((dimension - 3) / 2)) / 2")  # fmt: skip
    flank_share: Float = found("%", "q_A", "real area over the area of the flank",
                               "real_area / (face_width * flank_height)")  # fmt: skip
    tip_factor: Float = found("", "f_t", "factor on the stiffness by the radius of tips",
                              method="by tip_rule: 1, or 2/3 (4 - D)/(3 - D) if it follows the area")  # fmt: skip
    stiffness: Float = found("N/m", "K", "normal stiffness of one pair of rough flanks",
                             "tip_factor * equivalent_modulus * sqrt(2 * critical_area / pi) * (dimension - 1)"
                             " / (dimension - 2) * domain_factor**((3 - dimension) / 2)"
                             " * max(area_ratio**((dimension - 1) / 2) - sqrt(area_ratio), 0)", PATENT_6)  # fmt: skip
    load_exponent: Float = found("", "m", "load exponent d ln K/d ln F at this load; 0 where there is no stiffness",
                                 "cases((dimension - 1 + (dimension - 2) / (area_ratio**((dimension - 2) / 2) - 1))"
                                 " / (dimension - 1 + (3 - dimension) * critical_pressure"
                                 " * area_ratio**((5 - 2 * dimension) / 2) / (hardness + (3 - dimension)"
                                 " * critical_pressure * elastic_sum)), area_ratio > 1, 0)")  # fmt: skip
    # Its clearance
    largest_radius: Float = found("um", "r_L", "radius of the largest contact", "sqrt(largest_area / pi)")
    clearance_radius: Float = found(
        "um", "r'", "radius in equation 7", method="by clearance_rule: that of the largest contact, or half the patch"
    )
    clearance_multiple: Float = found("", "n_b", "amplitudes that count as clearance", digits=2,
                                      method="by clearance_rule: 1, or 2 for the whole interference")  # fmt: skip
    clearance: Float = found("nm", "b", "clearance of equation 7, as printed; it grows with the load",
                             "clearance_multiple * roughness**(dimension - 2) * sqrt(log(density))"
                             " * (2 * clearance_radius)**(3 - dimension)", PATENT_7)  # fmt: skip
    rough_height: Float = found("um", "S_1", "height of the flank, lowest to highest point",
                                method="as stated, else measured, else of its fractal patch")  # fmt: skip
    mating_rough_height: Float = found("um", "S_2", "height of the mating flank; 0 if smooth",
                                       method="as stated, else measured, else of its fractal patch")  # fmt: skip
    open_clearance: Float = found("nm", "b_0", "clearance of the mean planes at the reference load",
                                  "(rough_height + mating_rough_height) / 2")  # fmt: skip
    reference_load: Float = found("N", "F_0",
                                  "load of the pair that carries most at the reference torque; clearance and torsion "
                                  "count from it", method=SHARES)  # fmt: skip
    approach: Float = found("nm", "u", "way by which the pair closes from the reference load to its own; 0 below",
                            method="integral of dF/K by Gauss and Legendre")  # fmt: skip
    closing_clearance: Float = found("nm", "b_c", "clearance that is left under the load",
                                     "max(open_clearance - approach, 0)")  # fmt: skip
    free_play: Float = found("arcmin", "theta_j", "free play at the output, both flanks together",
                             "2 * closing_clearance / effective_radius")  # fmt: skip
    # The mesh
    effective_radius: Float = found("mm", "r_n", "lever of the normal force about the axis",
                                    "pitch_radius * cos(pressure_angle)")  # fmt: skip
    pairs_factor: Float = found("", "n_T", "engaged pairs at the torque over those stated",
                                "engaged_factor * (1 + engaged_gain"
                                " * (1 - exp(-abs(torque) / engaged_torque)))")  # fmt: skip
    largest_share: Float = found("%", "w_1", "share of the pair that carries most", method=SHARES)
    largest_pair_force: Float = found("N", "F_1", "normal load of that pair",
                                      "abs(torque) * largest_share / effective_radius")  # fmt: skip
    plastic_torque: Float = found("mN*m", "T_c", "torque up to which all contacts of all pairs are plastic",
                                  method="where the pair that carries most reaches F_c")  # fmt: skip
    line_stiffness: Float = found("N/m", "k_H", "of flanks as cylinders, where line_contact counts",
                                  "pi * equivalent_modulus * face_width / 2", "Yang and Sun 1985")  # fmt: skip
    normal_stiffness: Float = found("N/m", "K_n", "stiffness of all engaged pairs along their normals", method=SHARES)
    mesh_stiffness: Float = found("N*m/rad", "K_mesh", "stiffness of all engaged pairs about the axis",
                                  "normal_stiffness * effective_radius**2")  # fmt: skip
    mesh_torsion: Float = found("urad", "theta_m", "torsion of the mesh, from the reference torque on",
                                method="integral of dT/K_mesh by Gauss and Legendre")  # fmt: skip
    # The drive
    shear_modulus: Float = found("GPa", "G_c", "shear modulus of the cup",
                                 "modulus_factor * youngs_modulus_flexspline"
                                 " / (2 * (1 + poisson_ratio_flexspline))")  # fmt: skip
    cup_moment: Float = found("mm^4", "J_c", "polar moment of area of the thin wall of the cup",
                              "2 * pi * cup_radius**3 * cup_wall")  # fmt: skip
    cup_stiffness: Float = found("N*m/rad", "K_cup", "torsional stiffness of the cup; 0: it is taken as rigid",
                                 "cases(shear_modulus * cup_moment / cup_length, cup_length > 0, 0)")  # fmt: skip
    series_compliance: Float = found("urad/(N*m)", "c_d", "compliance of all that is in series with the mesh",
                                     "drive_compliance / modulus_factor + cup_length"
                                     " / (shear_modulus * cup_moment)")  # fmt: skip
    torsional_stiffness: Float = found(
        "N*m/rad", "K_theta", "stiffness of the mesh in series with the drive, at the torque",
        "normal_stiffness * effective_radius**2 / (1 + series_compliance * normal_stiffness * effective_radius**2)",
    )  # fmt: skip
    torsion: Float = found("urad", "theta", "torsion of the drive, from the reference torque on; 0 below",
                           "mesh_torsion + sign(torque) * series_compliance"
                           " * max(abs(torque) - reference_torque, 0)")  # fmt: skip
    rough_torsion: Float = found("urad", "theta_r", "torsion of the rough contacts alone, all else rigid",
                                 method="as that of the mesh")  # fmt: skip
    catalogue_torsion: Float = found("urad", "theta_cat", "torsion of a drive of this size and ratio",
                                     source=CATALOGUES, method="three straight pieces")  # fmt: skip
    catalogue_stiffness: Float = found("N*m/rad", "K_cat", "stiffness of such a drive at the torque", source=CATALOGUES,
                                       method="the piece in which the torque lies")  # fmt: skip
    rough_share: Float = found("%", "q_theta", "share of the catalogue's torsion that the rough contacts explain",
                               "cases(rough_torsion / catalogue_torsion, abs(torque) > 0, 0)")  # fmt: skip
