"""What the paper, standards, handbooks and a catalogue print, for comparison under the same settings.

The paper prints the inputs of its example, and its tables and figures of results are lost. The credit of the strength
formulas therefore rests on examples that others have published.
"""

from collections.abc import Iterator, Mapping

from rv_gearing.catalogue import PINS, RATIOS, TORQUE
from truing import Published

EXAMPLE = "ISO/TR 6336-30:2017, example 1"
HANDBOOK = "Pu Lianggui, Mechanical Design, table 10-5"
TEXTBOOK = "Pu Lianggui, Mechanical Design, example 10-1"
CATALOGUE = "catalogue of the maker, RV-110E"

QUOTED = "as public calculation projects quote the report; not compared with the printed document"
FACE = "K_Hbeta = 1.16 is stated as in the example; pinion solid and bore of the wheel half its diameter, for K_V"
TABLE = "two or three digits are printed, of a rack with 1.25 modules of dedendum and 0.38 of fillet"
INFERRED = (
    "the catalogue prints no teeth; they were inferred from all five ratios, with one centre distance of 46.875 mm"
)
LOST_TABLE = "Table 1 is lost; the text names groups up to number 22. With 40 pins and a tolerance of 0.01 there are 25"
LOSSES = (
    "2.26 kW at 15 r/min with equations 6 to 8; the catalogue's torque at the same power and speed means an "
    "efficiency of 0.749, not 0.894; losses without load are not in equations 6 to 8"
)

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
PAIRS = ((17, 200), (20, 80), (25, 50), (35, 80))  # every number of teeth of the handbook in some pair


def iso_example() -> Iterator[Published]:
    """The helical pair of the standard's technical report."""
    for name, result, value, unit in ISO_ROWS:
        why = {"centre_distance": QUOTED, "dynamic_factor": FACE}.get(result, "")
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
              settings={"studies.run": '["search"]'}, kind="at_least", why=LOST_TABLE),
    *catalogue(),
    Published(name="torque of the catalogue", result="output_torque", value=TORQUE, unit="N*m", where=CATALOGUE,
              settings={"studies.run": "[]"}, verdict="differs", why=LOSSES),
    *iso_example(),
    *textbook(),
    *handbook(),
]  # fmt: skip
