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
    fractal_roughness: Float = given(1e-11, "m", symbol="G_1",
                                     note="fractal roughness of the flank, in the convention stated beside it",
                                     source="typical", above=0, at_most=1e-3, stated_with="convention")  # fmt: skip
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
    lags: Float = given((0.4, 0.6, 1.0, 1.6, 2.5, 4.0, 6.0, 10.0, 16.0, 20.0), "um", symbol="xi", along="lag",
                        note="lags at which the structure function is shown")  # fmt: skip
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
                          source=CATALOGUE, at_least=-1e6, at_most=1e6, role="set")  # fmt: skip
    reference_torque: Float = given(1.0, "mN*m", symbol="T_0",
                                    note="torque from which the torsion counts; from 0 it would be infinite", above=0,
                                    at_most=1e6)  # fmt: skip
    tooth_stiffness: Float = given(None, "N/m", symbol="k_t", note="bending of the teeth and rim of one pair; not "
                                   "given: rigid", above=0)  # fmt: skip
    line_contact: bool = given(False, note="whether the flanks as a whole flatten too, as two cylinders do")
    cup_radius: Float = given(24.5, "mm", symbol="r_c", note="mean radius of the cup", above=0, at_most=5000)
    cup_wall: Float = given(0.35, "mm", symbol="t_c", note="wall of the cup", above=0, at_most=100)
    cup_length: Float = given(0.0, "mm", symbol="l_c", note="length of the cup that twists; 0: it is rigid",
                              at_least=0, at_most=5000)  # fmt: skip
    drive_compliance: Float = given(0.0, "urad/(N*m)", symbol="c_s",
                                    note="compliance in series with the mesh: cup, wave generator, bearing, rig",
                                    at_least=0, at_most=1e6)  # fmt: skip
    wave_torsion_stated: Float = given(0.0, "urad", symbol="theta_w0", note="torsion at wave_torque by the wave "
                                       "generator beside its balls, taken to grow as contacts of balls do, T^(2/3); "
                                       "0: rigid", at_least=0, at_most=1e6)  # fmt: skip
    wave_torque: Float = given(25.0, "N*m", symbol="T_w", note="torque at which that torsion is stated", above=0,
                               at_most=1e6)  # fmt: skip
    balls: Float = given(0.0, "", symbol="Z_b", note="balls in the bearing of the wave generator, whose closing is "
                         "then calculated; 0: it is not", at_least=0, at_most=500)  # fmt: skip
    ball_diameter: Float = given(4.0, "mm", symbol="d_b", note="of these balls", above=0, at_most=200)
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


# What the calculation answers: interface, one pair of teeth, its clearance, the mesh, and the drive around it

HERTZ = "equation 8 of the patent; Hertz"
PATENT_6 = "equation 6 of the patent, lost there; Jiang, Zheng and Zhu 2010"
PATENT_7 = "equation 7 of the patent, with a radius in place of its area"
CONTACTS = "Yan and Komvopoulos 1998"
NUMBERS = "Wang and Komvopoulos 1994"
CATALOGUES = "catalogues of the maker, by size and ratio"
RACES = 1.02
"""Closing of a ball and both its races, by (load over modulus)^(2/3)/diameter^(1/3): 4.36e-4 Q^(2/3)/d^(1/3) of steel,
N and mm (Palmgren; Harris, Rolling Bearing Analysis). Between flat plates it would be 2.08."""
ROW = 1.2885
"""Sum of w^(5/3) over many balls with shares w by the square of the cosine, by their number to the power -2/3:
2^(5/3) Gamma(13/6)/(sqrt(pi) Gamma(8/3))."""
CLOSING = round(RACES * ROW, 5)
"""Both together, to the digits that the sheet prints."""
SHARES = "load shares by the square of the cosine along two opposite arcs"


@results
class Stiffness:
    """Of the rough interface, of one pair of teeth, of the mesh and of the drive."""

    lag: Float = axis("um", symbol="xi", note="lag of the structure function", follows="lags")
    structure_function: Float = found(
        "um^2", symbol="S", note="mean square of the difference of height over a lag, of both flanks together",
        along="lag", method="power law of D and G, areal convention",
    )  # fmt: skip
    # The interface
    surface_accepted: Float = found(
        "", symbol="I_a", note="whether measured flanks are self-affine: 1, or 0 where one is refused and the stated D "
        "and G stand for it", method="local slopes of the structure function", digits=1,
    )  # fmt: skip
    spacing: Float = found("um", symbol="dx_s", note="sampling interval behind D and G",
                           method="of the flank that was measured, else as stated")  # fmt: skip
    dimension: Float = found("", symbol="D", note="fractal dimension of both flanks together",
                             method="sum of both structure functions, fitted by one power law", key=True)  # fmt: skip
    profile_dimension: Float = found("", symbol="D_s", note="fractal dimension of profiles", formula="dimension - 1",
                                     source="equation 5 of the patent")  # fmt: skip
    roughness: Float = found("m", symbol="G", note="fractal roughness of both, areal convention",
                             method="as the dimension", key=True)  # fmt: skip
    # One pair of teeth
    equivalent_modulus: Float = found(
        "GPa", symbol="E", note="equivalent modulus of both bodies", source=HERTZ,
        formula="modulus_factor / ((1 - poisson_ratio_flexspline**2) / youngs_modulus_flexspline"
        " + (1 - poisson_ratio_circular**2) / youngs_modulus_circular)",
    )  # fmt: skip
    critical_pressure: Float = found(
        "GPa", symbol="p_c", note="elastic load over area at which a contact turns elastic",
        method="by critical_rule: the hardness, or at first yield (0.454 + 0.41 Poisson's ratio of the circular "
        "spline)/3 of it",
    )  # fmt: skip
    domain_factor: Float = found(
        "", symbol="psi", note="domain extension factor: it widens the distribution of areas", source=NUMBERS,
        formula="(domain_factor**((2 - profile_dimension) / 2) - (1 + domain_factor**(-profile_dimension / 2))"
        "**(-(2 - profile_dimension) / profile_dimension)) * profile_dimension / (2 - profile_dimension) == 1",
    )  # fmt: skip
    critical_area: Float = found(
        "um^2", symbol="a_c", note="critical truncated area; smaller contacts are plastic", source=CONTACTS,
        formula="roughness**2 * (2**(11 - 2 * dimension) / (9 * pi**(4 - dimension)) * log(density)"
        " * (equivalent_modulus / critical_pressure)**2)**(1 / (dimension - 2))",
    )  # fmt: skip
    resolved_share: Float = found(
        "", symbol="q_r", note="radius of the critical area over the sampling interval; below 0.3 the power law is "
        "used far below what was measured", formula="sqrt(critical_area / pi) / spacing",
    )  # fmt: skip
    plastic_limit: Float = found(
        "N", symbol="F_c", note="load of a pair up to which all its contacts are plastic and it has no stiffness",
        formula="(dimension - 1) / (3 - dimension) * domain_factor**((3 - dimension) / 2) * hardness * critical_area",
    )  # fmt: skip
    largest_area: Float = found(
        "um^2", symbol="a_L", note="truncated area of the largest contact", source=CONTACTS,
        formula="pair_load == cases(plastic_limit * area_ratio**((dimension - 1) / 2)"
        " * (1 + (3 - dimension) * critical_pressure / hardness * elastic_sum), area_ratio > 1,"
        " plastic_limit * area_ratio)",
    )  # fmt: skip
    area_ratio: Float = found("", symbol="x", note="largest over critical area; up to 1 all contacts are plastic",
                              formula="largest_area / critical_area")  # fmt: skip
    elastic_sum: Float = found(
        "", symbol="s_e", note="what the elastic contacts add to the load; 0 without any",
        formula="cases((max(area_ratio, 1)**((5 - 2 * dimension) / 2) - 1) / (5 - 2 * dimension),"
        " abs(dimension - 2.5) > 1e-6, log(max(area_ratio, 1)) / 2)",
    )  # fmt: skip
    plastic_share: Float = found(
        "%", symbol="q_p", note="share of the load on plastic contacts; at 100 % the pair has no stiffness",
        formula="cases(plastic_limit / pair_load * area_ratio**((dimension - 1) / 2), area_ratio > 1, 1)",
    )  # fmt: skip
    contact_area: Float = found(
        "um^2", symbol="A_t", note="truncated area of all contacts",
        formula="(dimension - 1) / (3 - dimension) * domain_factor**((3 - dimension) / 2) * largest_area",
    )  # fmt: skip
    real_area: Float = found("um^2", symbol="A_r",
                             note="real area: all of the plastic contacts, half of the truncated elastic ones",
                             formula="contact_area * (1 + max(area_ratio, 1)**((dimension - 3) / 2)) / 2")  # fmt: skip
    flank_share: Float = found("%", symbol="q_A", note="real area over the area of the flank",
                               formula="real_area / (face_width * flank_height)")  # fmt: skip
    tip_factor: Float = found("", symbol="f_t", note="factor on the stiffness by the radius of tips",
                              method="by tip_rule: 1, or 2/3 (4 - D)/(3 - D) if it follows the area")  # fmt: skip
    stiffness: Float = found(
        "N/m", symbol="K", note="normal stiffness of one pair of rough flanks", source=PATENT_6,
        formula="tip_factor * equivalent_modulus * sqrt(2 * critical_area / pi) * (dimension - 1) / (dimension - 2)"
        " * domain_factor**((3 - dimension) / 2) * max(area_ratio**((dimension - 1) / 2) - sqrt(area_ratio), 0)",
        key=True,
    )  # fmt: skip
    load_exponent: Float = found(
        "", symbol="m", note="load exponent d ln K/d ln F at this load; 0 where there is no stiffness",
        formula="cases((dimension - 1 + (dimension - 2) / (area_ratio**((dimension - 2) / 2) - 1))"
        " / (dimension - 1 + (3 - dimension) * critical_pressure * area_ratio**((5 - 2 * dimension) / 2)"
        " / (hardness + (3 - dimension) * critical_pressure * elastic_sum)), area_ratio > 1, 0)",
    )  # fmt: skip
    # Its clearance
    largest_radius: Float = found("um", symbol="r_L", note="radius of the largest contact",
                                  formula="sqrt(largest_area / pi)")  # fmt: skip
    clearance_radius: Float = found("um", symbol="r'", note="radius in equation 7", method="by clearance_rule: that "
                                    "of the largest contact, or half the patch")  # fmt: skip
    clearance_multiple: Float = found("", symbol="n_b", note="amplitudes that count as clearance", digits=2,
                                      method="by clearance_rule: 1, or 2 for the whole interference")  # fmt: skip
    clearance: Float = found("nm", symbol="b", note="clearance of equation 7, as printed; it grows with the load",
                             source=PATENT_7,
                             formula="clearance_multiple * roughness**(dimension - 2) * sqrt(log(density))"
                                     " * (2 * clearance_radius)**(3 - dimension)", key=True)  # fmt: skip
    rough_height: Float = found("um", symbol="S_1", note="height of the flank, lowest to highest point",
                                method="as stated, else measured, else of its fractal patch")  # fmt: skip
    mating_rough_height: Float = found("um", symbol="S_2", note="height of the mating flank; 0 if smooth",
                                       method="as stated, else measured, else of its fractal patch")  # fmt: skip
    open_clearance: Float = found("nm", symbol="b_0", note="clearance of the mean planes at the reference load",
                                  formula="(rough_height + mating_rough_height) / 2")  # fmt: skip
    reference_load: Float = found(
        "N", symbol="F_0", note="load of the pair that carries most at the reference torque; clearance and torsion "
        "count from it", method=SHARES,
    )  # fmt: skip
    approach: Float = found("nm", symbol="u", note="way by which the pair closes from the reference load to its own; "
                            "0 below", method="integral of dF/K by Gauss and Legendre")  # fmt: skip
    closing_clearance: Float = found("nm", symbol="b_c", note="clearance that is left under the load",
                                     formula="max(open_clearance - approach, 0)")  # fmt: skip
    free_play: Float = found("arcmin", symbol="theta_j", note="free play at the output, both flanks together",
                             formula="2 * closing_clearance / effective_radius")  # fmt: skip
    # The mesh
    effective_radius: Float = found("mm", symbol="r_n", note="lever of the normal force about the axis",
                                    formula="pitch_radius * cos(pressure_angle)")  # fmt: skip
    pairs_factor: Float = found(
        "", symbol="n_T", note="engaged pairs at the torque over those stated",
        formula="engaged_factor * (1 + engaged_gain * (1 - exp(-abs(torque) / engaged_torque)))",
    )  # fmt: skip
    largest_share: Float = found("%", symbol="w_1", note="share of the pair that carries most", method=SHARES)
    largest_pair_force: Float = found("N", symbol="F_1", note="normal load of that pair",
                                      formula="abs(torque) * largest_share / effective_radius")  # fmt: skip
    plastic_torque: Float = found("mN*m", symbol="T_c", note="torque up to which all contacts of all pairs are plastic",
                                  method="where the pair that carries most reaches F_c")  # fmt: skip
    line_stiffness: Float = found("N/m", symbol="k_H", note="of flanks as cylinders, where line_contact counts",
                                  source="Yang and Sun 1985",
                                  formula="pi * equivalent_modulus * face_width / 2")  # fmt: skip
    normal_stiffness: Float = found("N/m", symbol="K_n", note="stiffness of all engaged pairs along their normals",
                                    method=SHARES)  # fmt: skip
    mesh_stiffness: Float = found("N*m/rad", symbol="K_mesh", note="stiffness of all engaged pairs about the axis",
                                  formula="normal_stiffness * effective_radius**2", key=True)  # fmt: skip
    mesh_torsion: Float = found("urad", symbol="theta_m", note="torsion of the mesh, from the reference torque on",
                                method="integral of dT/K_mesh by Gauss and Legendre")  # fmt: skip
    # The drive
    shear_modulus: Float = found(
        "GPa", symbol="G_c", note="shear modulus of the cup",
        formula="modulus_factor * youngs_modulus_flexspline / (2 * (1 + poisson_ratio_flexspline))",
    )  # fmt: skip
    cup_moment: Float = found("mm^4", symbol="J_c", note="polar moment of area of the thin wall of the cup",
                              formula="2 * pi * cup_radius**3 * cup_wall")  # fmt: skip
    cup_stiffness: Float = found(
        "N*m/rad", symbol="K_cup", note="torsional stiffness of the cup; 0: it is taken as rigid",
        formula="cases(shear_modulus * cup_moment / cup_length, cup_length > 0, 0)",
    )  # fmt: skip
    series_compliance: Float = found(
        "urad/(N*m)", symbol="c_d", note="compliance of all that is in series with the mesh",
        formula="drive_compliance / modulus_factor + cup_length / (shear_modulus * cup_moment)",
    )  # fmt: skip
    ball_torsion: Float = found(
        "urad", symbol="theta_b", note="torsion at wave_torque by the balls of the wave generator alone, calculated",
        source="Hertz, by Palmgren's constant; Castigliano over the balls under the engaged arcs",
        formula=f"cases({CLOSING:.6g} * wave_torque**(2/3) * (tan(pressure_angle) / pitch_radius)**(5/3)"
        " / (ball_diameter**(1/3) * (modulus_factor * youngs_modulus_flexspline"
        " / (2 * (1 - poisson_ratio_flexspline**2)) * max(balls, 1) * engaged_pairs / flexspline_teeth)**(2/3)),"
        " balls > 0, 0)",
    )  # fmt: skip
    wave_torsion: Float = found(
        "urad", symbol="theta_w", note="torsion by the wave generator from the reference torque on: what is stated, "
        "not calculated, and its balls",
        formula="sign(torque) * (wave_torsion_stated * modulus_factor**(-2/3) + ball_torsion)"
        " * (max(abs(torque), reference_torque)**(2/3) - reference_torque**(2/3)) / wave_torque**(2/3)",
    )  # fmt: skip
    wave_compliance: Float = found(
        "urad/(N*m)", symbol="c_w", note="compliance of the wave generator at the torque; 0 without torque",
        formula="cases(2/3 * (wave_torsion_stated * modulus_factor**(-2/3) + ball_torsion) * abs(torque)**(-1/3)"
        " / wave_torque**(2/3), abs(torque) > 0, 0)",
    )  # fmt: skip
    torsional_stiffness: Float = found(
        "N*m/rad", symbol="K_theta", note="stiffness of the mesh in series with the drive, at the torque",
        formula="normal_stiffness * effective_radius**2"
        " / (1 + (series_compliance + wave_compliance) * normal_stiffness * effective_radius**2)", key=True,
    )  # fmt: skip
    torsion: Float = found(
        "urad", symbol="theta", note="torsion of the drive, from the reference torque on; 0 below",
        formula="mesh_torsion + sign(torque) * series_compliance * max(abs(torque) - reference_torque, 0)"
        " + wave_torsion", key=True,
    )  # fmt: skip
    rough_torsion: Float = found("urad", symbol="theta_r", note="torsion of the rough contacts alone, all else rigid",
                                 method="as that of the mesh")  # fmt: skip
    catalogue_torsion: Float = found("urad", symbol="theta_cat", note="torsion of a drive of this size and ratio",
                                     method="three straight pieces", source=CATALOGUES)  # fmt: skip
    catalogue_stiffness: Float = found("N*m/rad", symbol="K_cat", note="stiffness of such a drive at the torque",
                                       method="the piece in which the torque lies", source=CATALOGUES)  # fmt: skip
    catalogue_ratio: Float = found(
        "", symbol="q_cat", note="torsion of all parts of this model over that of the catalogue; 0 without torque",
        formula="cases((mesh_torsion + sign(torque) * series_compliance * max(abs(torque) - reference_torque, 0)"
        " + wave_torsion) / catalogue_torsion, abs(torque) > 0, 0)",
    )  # fmt: skip
    rough_share: Float = found("%", symbol="q_theta",
                               note="share of the catalogue's torsion that the rough contacts explain",
                               formula="cases(rough_torsion / catalogue_torsion, abs(torque) > 0, 0)",
                               key=True)  # fmt: skip
