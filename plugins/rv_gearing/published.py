"""What the paper, standards, handbooks and a catalogue print, for comparison, and what the paper leaves open."""

from collections.abc import Iterator, Mapping

from rv_gearing.groups import PINS, RATIOS, TORQUE
from truing import Finding, Published

# The paper prints the inputs of its example, and its tables and figures of results are lost. The credit of the strength
# formulas therefore rests on examples that others have published.

EXAMPLE = "ISO/TR 6336-30:2017, example 1"
HANDBOOK = "Pu Lianggui, Mechanical Design, table 10-5"
TEXTBOOK = "Pu Lianggui, Mechanical Design, example 10-1"
EXERCISE = "exercise on rating life, sarthaks.com 2642436"
SLIDING = "the paper prints 0.998 and no friction; 0.05 of steel on pins that do not turn gives it"
CATALOGUE = "catalogue of the maker, RV-110E"
FIGURE = "ISO/TR 15144-1:2014, figure A.1"
REPORTS = "reports of GEARpie, a public program"

QUOTED = "as public calculation projects quote the report; not compared with the printed document"
FACE = "K_Hbeta = 1.16 is stated as in the example; pinion solid and bore of the wheel half its diameter, for K_V"
TABLE = "two or three digits are printed, of a rack with 1.25 modules of dedendum and 0.38 of fillet"
INFERRED = (
    "the catalogue prints no teeth; they were inferred from all five ratios, with one centre distance of 46.875 mm"
)
LOST_TABLE = (
    "Table 1 is lost; the text names groups up to number 22. With 40 pins and a tolerance of 0.01, read so that there "
    "are enough, there are 25"
)
LOSSES = (
    "2.26 kW at 15 r/min with equations 6 to 8; the catalogue's torque at the same power and speed means an "
    "efficiency of 0.749, not 0.894; losses without load are not in equations 6 to 8"
)

READ_OFF = (
    "read off the figure by a public project, to 10 % at best: the film that may be permitted to a mineral oil that "
    "fails at this stage of the FZG test C-GF/8.3/90; ours is the film of the test gears themselves at this stage, "
    "with the torques of the stages that public programs list, Ra 0.5 µm, oil at 90 degC of viscosity index 95"
)
THINNER = (
    "ours is {percent:.0f} % thinner there: to hold a film of ours against the limit of the figure is on the safe side"
)
LOSSES_TOO = (
    "geometry and losses alone: that program rates neither scuffing nor micropitting, and finds films otherwise"
)
SHORTENED = "the tips are 0.032 mm shorter than by the rack, as the report has them"
LAW_ALONE = "this tries the power law alone: the load of the bearing is stated, not calculated"
ONE_DIGIT = "; of K_V − 1 only one digit is printed, 0.003, ours is 0.0033"

ISO_SETTINGS = {
    "sun_teeth": "17", "planet_teeth": "103", "module": "8 mm", "helix_angle": "15.8 deg", "shift_sun": "0.145",
    "shift_planet": "0", "face_width": "100 mm", "dedendum": "1.4", "fillet": "0.39", "planets": "1",
    "stated_sun_torque": "9000 N*m", "stated_mesh_speed": "360 rpm", "application_factor": "1",
    "planet_load_factor": "1", "stated_face_factor": "1.16", "least_contact_safety": "1", "least_bending_safety": "1",
    "viscosity": "320 mm^2/s", "flank_roughness_sun": "6 um", "flank_roughness_planet": "6 um",
    "accuracy_grade": "5", "tip_relief": "70 um", "working_life": "50000 h", "bore_ratio_planet": "0.5",
    "studies.run": "[]",
}  # fmt: skip
ISO_ROWS: tuple[tuple[str, str, float, str], ...] = (
    ("centre distance", "centre_distance", 500.0, "mm"),
    ("tip diameter of the pinion", "tip_diameter_sun", 159.66, "mm"),
    ("tangential force", "tangential_force", 127352.0, "N"),
    ("virtual teeth of the pinion", "virtual_teeth_sun", 18.905, ""),
    ("virtual teeth of the wheel", "virtual_teeth_planet", 114.543, ""),
    ("zone factor", "zone_factor", 2.39533, ""),
    ("elasticity factor", "elasticity_factor", 189.8117, "MPa**0.5"),
    ("contact ratio factor", "contact_ratio_factor", 0.803, ""),
    ("helix factor", "helix_factor", 1.01944, ""),
    ("nominal contact stress", "nominal_contact_stress", 1206.582, "MPa"),
    ("stiffness of a pair of teeth, theoretical", "theoretical_stiffness", 17.85584, "N/(mm*um)"),
    ("stiffness of a pair of teeth", "tooth_stiffness", 12.37047, "N/(mm*um)"),
    ("mean mesh stiffness", "mesh_stiffness", 17.46485, "N/(mm*um)"),
    ("dynamic factor", "dynamic_factor", 1.003, ""),
    ("face load factor for bending", "face_factor_bending", 1.12803, ""),
    ("lubricant factor", "lubricant_factor", 1.04739, ""),
    ("velocity factor", "velocity_factor", 0.96911, ""),
    ("roughness factor", "roughness_factor", 0.96599, ""),
    ("life factor of the pinion", "contact_life_factor_sun", 0.910, ""),
    ("life factor of the wheel", "contact_life_factor_planet", 0.962, ""),
    ("permissible stress of the pinion", "permitted_contact_stress_sun", 1338.481, "MPa"),
    ("permissible stress of the wheel", "permitted_contact_stress_planet", 1414.526, "MPa"),
    ("contact stress", "contact_stress_sun", 1301.353, "MPa"),
    ("safety of the pinion, pitting", "contact_safety_sun", 1.02853, ""),
    ("safety of the wheel, pitting", "contact_safety_planet", 1.08696, ""),
)
ROOT_FORMS = {17: (2.97, 1.52), 20: (2.80, 1.55), 25: (2.62, 1.59), 35: (2.45, 1.65), 50: (2.32, 1.70),
              80: (2.22, 1.77), 200: (2.12, 1.865)}  # fmt: skip
OFF = {("form_factor", teeth) for teeth in (17, 25, 35, 50, 80, 200)} | {("stress_correction", 200)}
"""What differs by more than rounding: up to 0.6 % of the form factor."""
MICROPITTING_TEST = {
    "sun_teeth": "16", "planet_teeth": "24", "module": "4.5 mm", "shift_sun": "0.1817", "shift_planet": "0.1715",
    "face_width": "14 mm", "planets": "1", "stated_mesh_speed": "2250 rpm", "oil_temperature": "90 degC",
    "flank_roughness_sun": "3 um", "flank_roughness_planet": "3 um", "application_factor": "1",
    "planet_load_factor": "1", "stated_dynamic_factor": "1", "stated_face_factor": "1",
    "stated_transverse_factor": "1", "studies.run": "[]",
}  # fmt: skip
STAGES = {5: 70.0, 10: 265.1}  # N m on the pinion
FILM_OF_THE_TEST = {  # viscosity grade: density, kg/m³, film permitted by stage
    32: (870.8, {5: 0.130, 10: 0.055}), 100: (892.2, {5: 0.250, 10: 0.090}), 220: (907.1, {5: 0.400, 10: 0.145}),
    460: (921.0, {5: 0.570, 10: 0.200}),
}  # fmt: skip
THINNER_BY = {(100, 5): 18.0, (220, 5): 25.0, (460, 5): 25.0, (220, 10): 14.0, (460, 10): 16.0}  # %, beyond 10
HELICAL_TEST = {**MICROPITTING_TEST, "sun_teeth": "20", "planet_teeth": "30", "module": "3.5 mm",
                "helix_angle": "15 deg", "shift_sun": "0.1809", "shift_planet": "0.0891",
                "face_width": "23 mm", "addendum": "0.9909"}  # fmt: skip
PAIRS = ((17, 200), (20, 80), (25, 50), (35, 80))  # every number of teeth of the handbook in some pair


def iso_example() -> Iterator[Published]:
    """The helical pair of the standard's technical report."""
    for name, result, value, unit in ISO_ROWS:
        why = {"centre_distance": QUOTED, "dynamic_factor": FACE + ONE_DIGIT}.get(result, "")
        yield Published(
            name=name, result=result, value=value, unit=unit, where=EXAMPLE, settings=ISO_SETTINGS, kind="worked",
            why=why,
        )  # fmt: skip


def handbook() -> Iterator[Published]:
    """Form factor and stress correction by number of teeth, each number once."""
    seen: set[int] = set()
    for pair in PAIRS:
        settings = {"sun_teeth": str(pair[0]), "planet_teeth": str(pair[1]), "studies.run": "[]"}
        for gear, teeth in zip(("sun", "planet"), pair, strict=True):
            if teeth in seen:
                continue
            seen.add(teeth)
            for word, short, value in zip(
                ("form_factor", "stress_correction"), ("Y_Fa", "Y_Sa"), ROOT_FORMS[teeth], strict=True
            ):
                yield Published(
                    name=f"{short} of {teeth} teeth", result=f"{word}_{gear}", value=value, where=HANDBOOK,
                    settings=settings, verdict="differs" if (word, teeth) in OFF else "matches",
                    why=TABLE if (word, teeth) in OFF else "",
                )  # fmt: skip


def films() -> Iterator[Published]:
    """Films of the gears of the micropitting test beside those that a figure permits by the outcome of that test."""
    for grade, (density, films_by_stage) in FILM_OF_THE_TEST.items():
        for stage, value in films_by_stage.items():
            thinner = THINNER_BY.get((grade, stage))
            settings = {**MICROPITTING_TEST, "viscosity": f"{grade} mm^2/s", "oil_density": f"{density} kg/m^3",
                        "stated_sun_torque": f"{STAGES[stage]} N*m"}  # fmt: skip
            yield Published(
                name=f"film permitted at VG {grade}, stage {stage}", result="film_ratio", value=value, where=FIGURE,
                settings=settings, kind="words", within=0.1 * value, verdict="differs" if thinner else "matches",
                why=THINNER.format(percent=thinner) if thinner else READ_OFF,
            )  # fmt: skip


def test_gears() -> Iterator[Published]:
    """Contact ratio and loss factor of two test gears, spur and helical."""
    for word, settings, loss, why in (
        ("spur", MICROPITTING_TEST, 0.1986, LOSSES_TOO),
        ("helical", HELICAL_TEST, 0.1639, SHORTENED),
    ):
        for name, result, value in (("contact ratio", "contact_ratio", 1.46), ("loss factor", "loss_factor", loss)):
            yield Published(name=f"{name} of the {word} test gears", result=result, value=value, where=REPORTS,
                            settings=settings, why=why)  # fmt: skip


def textbook() -> Iterator[Published]:
    """A spur pair of 24 and 77 teeth."""
    settings = {"sun_teeth": "24", "planet_teeth": "77", "studies.run": "[]"}
    for name, result, value in (
        ("contact ratio of 24/77", "contact_ratio", 1.711),
        ("contact ratio factor of 24/77", "contact_ratio_factor", 0.873),
        ("zone factor of 24/77", "zone_factor", 2.5),
    ):
        yield Published(name=name, result=result, value=value, where=TEXTBOOK, settings=settings)


def catalogue() -> Iterator[Published]:
    """The five ratios of one reducer."""
    for ratio, sun, planet in RATIOS:
        settings: Mapping[str, str] = {
            "sun_teeth": str(sun), "planet_teeth": str(planet), "pin_teeth": str(PINS), "shift_sun": "0.2",
            "shift_planet": "-0.2", "studies.run": "[]",
        }  # fmt: skip
        yield Published(
            name=f"catalogue ratio {ratio:g}, as {sun}/{planet}/{PINS}", result="ratio", value=ratio, where=CATALOGUE,
            settings=settings, obtained="calibrated", why=INFERRED if ratio == RATIOS[0][0] else "",
        )  # fmt: skip


PUBLISHED = [
    Published(name="groups in its table, at least", result="group_count", value=22.0, where="text below Table 1",
              settings={"studies.run": '["search"]'}, kind="at_least", obtained="calibrated",
              why=LOST_TABLE),
    *catalogue(),
    Published(name="torque of the catalogue", result="output_torque", value=TORQUE, unit="N*m", where=CATALOGUE,
              settings={"studies.run": "[]"}, verdict="differs", why=LOSSES),
    Published(name="million turns of a ball bearing of 16 kN under 2 kN", result="million_turns", value=512.0,
              where=EXERCISE, kind="worked",
              settings={"bearing_exponent": "3", "bearing_rating": "16 kN", "stated_crank_load": "2 kN",
                        "studies.run": "[]"}, why=LAW_ALONE),
    Published(name="efficiency of disc and pins", result="pin_loss_efficiency", value=0.998, where="section 2",
              settings={"studies.run": "[]"}, obtained="calibrated", why=SLIDING),
    *iso_example(),
    *films(),
    *test_gears(),
    *textbook(),
    *handbook(),
]  # fmt: skip


# Where the paper leaves something open or cannot be read literally, and what its reader must know

TOLD = {
    "The table and all figures of results are lost": "Of the paper the text, its equations and the inputs of the "
    "example were at hand, but neither the table of groups nor the flow chart nor the figures with stresses. Face "
    "width, profile shifts, material, quality and the number of planets are printed nowhere; usual ones were taken, "
    "and every stress here is ours alone. What the formulas are worth is shown by examples of others, in the "
    "comparison above.",
    "The numbering of the groups cannot be recovered": "The paper names groups up to number 22 and rates number 5. Its "
    "tolerance and how far it tried pins stood in the flow chart. Forty pins and a tolerance of 0.01 is the simplest "
    "reading that has at least 22 groups: it has 25. A tolerance of 0.04 gives 102, even pins from 30 to 60 give 422, "
    "from 20 to 80 give 687, and one pin circle instead of all that the torque permits leaves 5. Group 5 here, 23/63, "
    "need not be the paper's.",
    "The paper calls nine groups better and gives no rule": "It names 3, 7, 10, 12, 13, 15, 20, 21 and 22, for "
    "accuracy of transmission and distribution of load. Read here: hunting teeth (no common factor of sun and planet, "
    "so that every tooth meets every other and no error is repeated), and planets that mesh in phase (their number "
    "divides the teeth of the sun, so that they carry alike at any moment). Of the 25 groups 15 have hunting teeth and "
    "4 both, with two planets: 4, 8, 15 and 21. Were its numbers those of this list, 7 of its 9 would have hunting "
    "teeth, as 13 of the first 22 have; drawn blindly as many or more come out in 15 % of cases, which proves no rule. "
    "Both together need planets of several kinds: planets that are all alike want the sum of the teeth divided by "
    "their number.",
    "The cube root wants newton millimetres": "The radius of the pin circle is 0.85 to 1.3 times the cube root of the "
    "output torque. That is millimetres for a torque in N mm, as the printed 9 550 000 says; with N m it would be ten "
    "times too small. The 1078 N m of the catalogue give 87 to 133 mm, the size of such reducers.",
    "An even number of pins is no condition of one tooth difference": "The paper calls it that. The one tooth by which "
    "pins exceed the teeth of a disc is already in equation 1. The number of pins is even so that two equal discs, "
    "half a turn of the crank apart, fit one ring of pins.",
    "At least 17 teeth is a rule without profile shift": "With shift a sun may have fewer teeth and not be undercut. "
    "The catalogue of the maker proves it: its five ratios 81, 111, 127.7, 161 and 175.2 come out with 40 pins and sun "
    "and planet of 75 teeth together, 25/50, 20/55, 18/57, 15/60 and 14/61, all at 46.875 mm. The input "
    "fewest_sun_teeth opens the search to them.",
    "The torque of the search is not the torque of the gears": "Equation 5 multiplies input power by the efficiency "
    "and divides by the speed of the output: the torque at the output, which sizes the pin circle. Sun and planet "
    "carry the torque of the input, 1/(i eta) of it, 12.96 instead of 1285.8 N m.",
    "Efficiency 0.894 or 0.749": "Equations 6 to 8 give 0.894 from input to output, 1285.8 N m at 15 turns per minute. "
    "For the same power and speed the catalogue rates the reducer with 1078 N m, 0.749. The equations have the losses "
    "of meshes and bearings under load, but none that are there without load: seals, grease, and friction of pins.",
    "Equations 2, 5 and 8 are read, not copied": "In the copy at hand equation 2 has no bars of an absolute value, "
    "equation 5 no fraction bar and equation 8 no brackets. Equation 8 is read as the ratio of a lossy train over that "
    "of one without losses, so that it is 1 where both mesh efficiencies are.",
    "Contact stress at the pitch point only": "The paper leaves out Z_B and Z_D of ISO 6336-2, which carry the stress "
    "from the pitch point to the inner point of single contact. For a sun of 20 teeth that is 7.5 % more; with it 0.6 "
    "% of the permissible stress is left, without it 7.5 %. They are applied here; single_contact = false leaves them "
    "out.",
    "Small gears get a large face load factor": "By method C the factor is 1.54 for the example although the flanks "
    "are crowned: under 54 N/mm the deviations of grade 6 are more than the deflection. For crowned suns that align "
    "themselves 1.1 to 1.3 is usual; stated_face_factor = 1.2 takes 8 % off the contact stress. Measure it, or state "
    "where it is from.",
    "Two conventions of root stress": "The paper, as older standards, loads the tooth at its tip and takes part of it "
    "off again by a contact ratio factor. Method B of ISO 6336-3 loads it at the outer point of single contact. The "
    "factors look alike and differ: for the sun 2.80 and 1.55 by one, 1.55 and 1.83 by the other. Both stand on the "
    "sheet; the first is checked, as in the paper.",
    "Robots reverse, and the paper does not say so": "A planet of this stage meshes with the sun alone, so its teeth "
    "are not bent to both sides in each turn. A robot that goes to and fro bends them to both sides all the same; ISO "
    "6336-3 then takes about 0.7 of the endurance limit for bending. State stress_ratio_sun and stress_ratio_planet, "
    "-1 where the torque is the same both ways.",
    "Scuffing and micropitting are held against test gears, not against worked examples": "The worked examples of "
    "ISO/TS 6336-21, ISO/TR 15144-2 and AGMA 925 could not be had, nor reports of programs with all inputs. The gears "
    "of the FZG tests stand in for them: at the load stage that names a lubricant they must scuff, which they do "
    "within 17 %, and their film at the stage at which they turn grey must be the one that is permitted by that "
    "stage: 0.75 to 1.01 of the eight values that could be read off the figure. Where the factor (1 + planets)/2 of "
    "the bulk temperature is public, it is so for one mate only.",
    "The first group of the list is the one that is built": "Of the 25 groups the smallest, 20/55/40, has the centre "
    "distance of the maker's catalogue and the ratio 111. The paper prefers larger ones by accuracy and sharing of "
    "load. Larger groups carry more: contact stress falls from 1087 to 709 MPa from the first to the last, and the "
    "centre distance grows by 80 %.",
}
FINDINGS = [Finding(title=title, text=text) for title, text in TOLD.items()]
