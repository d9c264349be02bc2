"""What the gearing calculation is told: every quantity with unit, symbol, bounds and source.

A factor that is calculated may be stated instead: ``stated_dynamic_factor = 1.05``. It is then used as it stands.
"""

from typing import Any, Literal

from truing import Float, given, inputs, part

PAPER = "section 2 of the paper"
LOST = "not in the paper; usual"
LARGEST = 10000.0  # mm, um: a size above it was meant in another unit


def share(value: float, symbol: str, note: str) -> Any:
    """Declare an efficiency: above 0, at most 1."""
    return given(value, "", symbol=symbol, note=note, source=PAPER, above=0, at_most=1)


def positive(value: float, unit: str, symbol: str, note: str, source: str = LOST) -> Any:
    """Declare a quantity above zero."""
    return given(value, unit, symbol=symbol, note=note, source=source, above=0)


def stated(symbol: str, note: str) -> Any:
    """Declare a factor that is calculated unless it is stated here."""
    note = f"{note}; calculated where it is not stated"
    return given(None, "", symbol=f"{symbol},st", note=note, above=0)


@inputs
class Gear:
    """What belongs to one gear alone: sun or planet."""

    shift: Float = given(0.0, "", symbol="x", note="profile shift, in modules", source=LOST, at_least=-1.5, at_most=2)
    bore_ratio: Float = given(0.0, "", symbol="q", note="bore over mean diameter, for its inertia", source=LOST,
                              at_least=0, below=1)  # fmt: skip
    contact_limit: Float = positive(1500.0, "MPa", "sigma_Hlim", "endurance limit for contact stress, ISO 6336-5")
    bending_limit: Float = positive(460.0, "MPa", "sigma_Flim", "nominal endurance limit for bending, ISO 6336-5")
    young_modulus: Float = positive(206.0, "GPa", "E", "modulus of steel")
    poisson_ratio: Float = given(0.3, "", symbol="nu", note="Poisson ratio", source=LOST, at_least=0, below=0.5)
    flank_roughness: Float = positive(4.0, "um", "R_z", "mean peak-to-valley roughness of the flank")
    root_roughness: Float = positive(4.0, "um", "R_z,F", "mean peak-to-valley roughness of the root")
    stress_ratio: Float = given(0.0, "", symbol="R", note="root stress of the opposite load over that of the load: 0 "
                                "pulsating, -1 where the drive reverses under the same torque", source=LOST,
                                at_least=-2, at_most=0)  # fmt: skip
    stated_form_factor: Float = stated("Y_Fa", "form factor, load at the tip")
    stated_stress_correction: Float = stated("Y_Sa", "stress correction factor, load at the tip")
    stated_contact_life: Float = stated("Z_NT", "life factor for contact")
    stated_bending_life: Float = stated("Y_NT", "life factor for bending")
    stated_notch_sensitivity: Float = stated("Y_delta relT", "relative notch sensitivity factor")
    stated_root_surface: Float = stated("Y_RrelT", "relative surface factor of the root")
    stated_bending_size: Float = stated("Y_X", "size factor for bending")
    stated_single_contact: Float = stated("Z_BD", "single pair contact factor, Z_B of the sun and Z_D of the planet")


@inputs
class Gearing:
    """Duty and search, the two gears, material and quality, and what is asked of them."""

    # Duty, and the search for teeth
    power: Float = positive(2.26, "kW", "P", "input power", PAPER)
    output_speed: Float = positive(15.0, "r/min", "n", "speed of the output", PAPER)
    target_ratio: Float = given(111.0, "", symbol="i_p", note="wanted ratio", source=PAPER, above=1)
    ratio_tolerance: Float = given(0.01, "", symbol="Delta i_p",
                                   note="permitted relative deviation; the paper names 0.01 to 0.04", source=PAPER,
                                   above=0, at_most=0.2)  # fmt: skip
    module: Float = given(1.25, "mm", symbol="m_n", note="normal module", source=PAPER, above=0, below=100)
    fewest_pins: int = given(40, symbol="Z_5,min", note="fewest pins that are tried, even",
                             source="reading of the lost flow chart", at_least=4, at_most=1000)  # fmt: skip
    most_pins: int = given(40, symbol="Z_5,max", note="most pins that are tried, even",
                           source="reading of the lost flow chart", at_least=4, at_most=1000)  # fmt: skip
    fewest_sun_teeth: int = given(17, symbol="Z_1,min", note="fewest teeth of the sun: no undercut without shift",
                                  source=PAPER, at_least=6, at_most=1000)  # fmt: skip
    least_tooth_ratio: Float = given(1.5, "", symbol="u_min", note="least teeth of the planet over those of the sun",
                                     source=PAPER, at_least=1)  # fmt: skip
    involute_efficiency: Float = share(0.992, "eta_H1", "mesh efficiency of sun and planet")
    cycloid_efficiency: Float = share(0.998, "eta_H6", "mesh efficiency of disc and pins")
    bearing_efficiency: Float = share(0.99, "eta_B", "of each of the three bearings: crank, its support, carrier")
    pin_circle_low: Float = positive(0.85, "mm**(2/3)/N**(1/3)", "k_R,min", "least pin circle radius by torque", PAPER)
    pin_circle_high: Float = positive(1.3, "mm**(2/3)/N**(1/3)", "k_R,max", "most pin circle radius by torque", PAPER)
    centre_share_low: Float = positive(0.5, "", "k_a,min", "least centre distance over pin circle radius", PAPER)
    centre_share_high: Float = positive(0.6, "", "k_a,max", "largest centre distance over pin circle radius", PAPER)
    window: Literal["whole", "one_pin_circle"] = given(
        "whole", note="centre distances of all pin circles that the torque permits, or of pin_circle_low alone"
    )
    group: int = given(1, symbol="no", note="group of the search that is rated, where no teeth are stated", at_least=1)
    sun_teeth: Float = given(None, "", symbol="Z_1", note="teeth of the sun; without them those of the group",
                             at_least=6, at_most=1000, whole=True)  # fmt: skip
    planet_teeth: Float = given(None, "", symbol="Z_2", note="teeth of the planet; without them those of the group",
                                at_least=6, at_most=3000, whole=True)  # fmt: skip
    pin_teeth: Float = given(None, "", symbol="Z_5", note="pins; without them those of the group, or fewest_pins",
                             at_least=4, at_most=1000, whole=True)  # fmt: skip
    # The load of the first stage
    load_torque: Float = given(None, "N*m", symbol="T_2", role="set",
                               note="torque at the output, with the sign of its direction; without it that of the "
                                    "power")  # fmt: skip
    input_speed: Float = given(None, "rpm", symbol="n_in", note="speed of the sun; without it that of the output speed",
                               above=0)  # fmt: skip
    stated_sun_torque: Float = given(None, "N*m", symbol="T_1,st", note="torque of the sun, in place of all the above",
                                     at_least=0)  # fmt: skip
    stated_mesh_speed: Float = given(None, "rpm", symbol="n_rel,st",
                                     note="speed of the sun relative to the carrier, in place of all the above",
                                     above=0)  # fmt: skip
    planets: int = given(2, symbol="n_p", note="planets that share the torque", source=LOST, at_least=1, at_most=12)
    application_factor: Float = positive(1.25, "", "K_A", "1 uniform, 1.25 light, 1.5 moderate, 1.75 heavy shocks")
    planet_load_factor: Float = given(
        1.10, "", symbol="K_Hp,0", note="uneven sharing among the planets: 1.05 to 1.2 with a floating sun, 1.3 to 1.6 "
        "without", source=LOST, at_least=1,
    )  # fmt: skip
    working_life: Float = positive(6000.0, "h", "L_h", "working time that is asked for")
    # The second stage, and the bearings between its cranks and discs
    pin_circle_radius: Float = given(None, "mm", symbol="R_p,st", note="of the pins; without it the middle of what "
                                     "suits torque and centre distance", above=0, below=LARGEST)  # fmt: skip
    eccentricity: Float = given(None, "mm", symbol="e_st", note="of the cranks; without it by short_width", above=0,
                                below=LARGEST)  # fmt: skip
    pin_radius: Float = given(None, "mm", symbol="r_rp,st", note="of the pins; without it by pin_gap", above=0,
                              below=LARGEST)  # fmt: skip
    disc_width: Float = given(None, "mm", symbol="B_st", note="of each disc; without it 0.12 of the pin circle radius",
                              above=0, below=LARGEST)  # fmt: skip
    short_width: Float = given(0.75, "", symbol="K_1,0", note="eccentricity times pins over pin circle radius; 0.6 to "
                               "0.85", source=LOST, above=0, below=1)  # fmt: skip
    pin_gap: Float = given(1.6, "", symbol="K_2", note="distance of neighbouring pins over their diameter", source=LOST,
                           above=1)  # fmt: skip
    disc_load_factor: Float = given(1.1, "", symbol="K_d", note="load of the worse disc over half of both", source=LOST,
                                    at_least=1, at_most=2)  # fmt: skip
    pin_friction: Float = positive(0.05, "", "mu_p", "of discs on pins that do not turn")
    bearing_rating: Float = given(None, "kN", symbol="C", note="dynamic rating of one bearing between crank and disc; "
                                  "without it what lasts the working time", above=0)  # fmt: skip
    bearing_exponent: Float = given(3.333333333333333, "", symbol="p", note="of the life: 10/3 rollers, 3 balls",
                                    source="ISO 281:2007", at_least=1, at_most=10)  # fmt: skip
    stated_crank_load: Float = given(None, "N", symbol="P_st", note="equivalent load of a crank bearing; calculated "
                                     "where it is not stated", above=0)  # fmt: skip
    # Geometry and quality of the pair
    pressure_angle: Float = given(20.0, "deg", symbol="alpha_n", note="of the rack", source=LOST, above=10, below=30)
    helix_angle: Float = given(0.0, "deg", symbol="beta", note="0: spur", source=LOST, at_least=0, below=45)
    face_width: Float = given(12.0, "mm", symbol="b", note="common face width", source=LOST, above=0, below=LARGEST)
    addendum: Float = positive(1.0, "", "h_a*", "addendum of the rack, in modules")
    dedendum: Float = positive(1.25, "", "h_f*", "dedendum of the rack, in modules")
    fillet: Float = given(0.38, "", symbol="rho_f*", note="fillet radius of the rack", source=LOST, at_least=0,
                          at_most=1)  # fmt: skip
    accuracy_grade: int = given(6, symbol="Q", note="grade of ISO 1328-1:1995", source=LOST, at_least=1, at_most=12)
    flank_form: Literal["none", "crowned", "helix_corrected", "crowned_and_corrected", "end_relief"] = given(
        "crowned", note="how the flank is modified along its width"
    )
    tip_relief: Float = given(0.0, "um", symbol="C_a", note="tip relief; acts in the dynamic factor up to grade 5",
                              source=LOST, at_least=0, below=1000)  # fmt: skip
    material: Literal["case_hardened", "through_hardened", "nitrided"] = given(
        "case_hardened", note="of both gears: life, running-in, notch and surface factors follow it"
    )
    proof_stress: Float = positive(800.0, "MPa", "sigma_0.2", "of through-hardened steel, for its notch sensitivity")
    density: Float = positive(7830.0, "kg/m**3", "rho", "of both gears, for their inertia", "ISO 6336-1:2006, 6.5.9")
    viscosity: Float = positive(100.0, "mm**2/s", "nu_40", "kinematic viscosity of the lubricant at 40 degC")
    oil_density: Float = positive(892.0, "kg/m**3", "rho_15", "of the lubricant at 15 degC")
    oil_factor: Float = positive(1.0, "", "X_L", "1 mineral oil, 0.8 polyalphaolefin, 0.6 to 0.7 polyglycol",
                                 "ISO/TS 6336-20")  # fmt: skip
    lubrication_factor: Float = positive(1.0, "", "X_S", "1 dipped, 1.2 sprayed or greased, 0.2 submerged",
                                         "ISO/TS 6336-20")  # fmt: skip
    scuffing_stage: Float = given(12.0, "", symbol="S_FZG", note="load stage at which the lubricant scuffs in the FZG "
                                  "test A/8.3/90", source=LOST, at_least=1, at_most=14)  # fmt: skip
    oil_temperature: Float = given(40.0, "degC", symbol="theta_oil", note="of the lubricant at work", source=LOST,
                                   at_least=-60, at_most=250, role="follows")  # fmt: skip
    # What is asked
    least_contact_safety: Float = positive(1.1, "", "S_Hmin", "least safety against pitting")
    least_bending_safety: Float = positive(1.25, "", "S_Fmin", "least safety against breakage")
    least_scuffing_distance: Float = given(50.0, "K", symbol="S_Theta", note="least distance of the contact "
                                           "temperature from that at which it scuffs", source="ISO/TS 6336-20, advice",
                                           at_least=0)  # fmt: skip
    least_film_ratio: Float = positive(
        0.09, "", "lambda_GFP", "film over roughness below which micropitting begins, of the lubricant: 0.055 to 0.57 "
        "of mineral oils by viscosity and test, this at VG 100 and stage 10",
        "ISO/TR 15144-1, figure A.1, as a public project reads it",
    )  # fmt: skip
    mean_stress_sensitivity: Float = given(0.4, "", symbol="M", note="of the root: 0.4 makes the mean stress factor "
                                           "0.7 where the load reverses fully", source=LOST, at_least=0,
                                           at_most=1)  # fmt: skip
    stress_correction_of_test: Float = positive(2.0, "", "Y_ST", "stress correction of the reference test gears")
    single_contact: bool = given(
        True, note="contact stress at the inner point of single contact (ISO Z_B, Z_D; the paper leaves them out)"
    )
    helix_reading: Literal["iso", "gb_1997"] = given(
        "iso", note="Z_beta: 1/sqrt(cos beta) of ISO 6336:2006, or sqrt(cos beta) of GB/T 3480-1997"
    )
    # Factors that are calculated unless they are stated
    stated_dynamic_factor: Float = stated("K_V", "dynamic factor")
    stated_face_factor: Float = given(None, "", symbol="K_H beta,st", note="face load factor for contact; calculated "
                                      "where it is not stated", at_least=1)  # fmt: skip
    stated_face_factor_bending: Float = stated("K_F beta", "face load factor for bending")
    stated_transverse_factor: Float = stated("K_H alpha", "transverse load factor for contact")
    stated_transverse_factor_bending: Float = stated("K_F alpha", "transverse load factor for bending")
    stated_planet_load_bending: Float = stated("K_Fp", "uneven sharing among the planets, for bending")
    stated_friction: Float = stated("mu_mC", "mean friction of the flanks")
    stated_zone_factor: Float = stated("Z_H", "zone factor")
    stated_elasticity_factor: Float = given(
        None, "MPa**0.5", symbol="Z_E,st", note="elasticity factor; calculated where it is not stated", above=0
    )
    stated_contact_ratio_factor: Float = stated("Z_epsilon", "contact ratio factor for contact")
    stated_helix_factor: Float = stated("Z_beta", "helix factor for contact")
    stated_lubricant_factor: Float = stated("Z_L", "lubricant factor")
    stated_velocity_factor: Float = stated("Z_V", "velocity factor")
    stated_roughness_factor: Float = stated("Z_R", "roughness factor")
    work_hardening_factor: Float = positive(1.0, "", "Z_W", "1 for equal hardness", "ISO 6336-2, clause 13")
    contact_size_factor: Float = positive(1.0, "", "Z_X", "1 up to module 10 mm", "ISO 6336-2, clause 14")
    stated_contact_ratio_bending: Float = stated("Y_epsilon", "contact ratio factor for bending, load at the tip")
    stated_helix_factor_bending: Float = stated("Y_beta", "helix factor for bending")
    stated_mesh_stiffness: Float = given(
        None, "N/(mm*um)", symbol="c_gamma,st", note="mean mesh stiffness; calculated where it is not stated", above=0
    )
    # Neutral inputs: effects reach the calculation through them
    extra_misalignment: Float = given(0.0, "um", symbol="F_beta,0", note="neutral 0: misalignment over the face width, "
                                      "beside that of the tolerances", at_least=-1000, at_most=1000)  # fmt: skip
    extra_dynamic_factor: Float = given(0.0, "", symbol="Delta K_V", note="neutral 0: added to the dynamic factor",
                                        at_least=-0.9)  # fmt: skip
    sharing_error: Float = given(0.0, "um", symbol="e_p", note="neutral 0: planet ahead of the others, along the line "
                                 "of action", at_least=-1000, at_most=1000)  # fmt: skip
    centre_distance_deviation: Float = given(0.0, "um", symbol="Delta a", note="neutral 0: gears farther apart than "
                                             "without backlash", at_least=-1000, at_most=1000)  # fmt: skip
    carrying_share: Float = given(1.0, "", symbol="f_b", note="neutral 1: share of the face width that carries",
                                  above=0, at_most=1)  # fmt: skip
    relief_deviation: Float = given(0.0, "um", symbol="Delta C_a", note="neutral 0: tip relief missing on the tooth; "
                                    "loads its tip", at_least=-1000, at_most=1000)  # fmt: skip
    sun: Gear = part(Gear, index="1")
    planet: Gear = part(Gear, index="2")
