"""What the flanks bear and what they get: the factors of contact stress. Reference: ISO 6336-2:2006, method B."""

import numpy as np

from rv_gearing.pair import GearSize, MeshSize
from rv_gearing.quantities import Gearing
from truing import Float, either, feasible, found, results

ISO = "ISO 6336-2:2006, clause "
SOFTER = "min(contact_limit_sun, contact_limit_planet)"
MPA = 1e6


@results
class ContactFactors:
    """Factors of the contact stress that sun and planet share, and the single contact factors of both."""

    zone_factor: Float = found(
        "", symbol="Z_H", note="zone factor; as stated where it is", source=ISO + "6",
        formula="either(stated_zone_factor, sqrt(2 * cos(base_helix_angle) * cos(working_angle)"
        " / (cos(transverse_angle)**2 * sin(working_angle))))",
    )  # fmt: skip
    elasticity_factor: Float = found(
        "MPa**0.5", symbol="Z_E", note="elasticity factor; as stated where it is", source=ISO + "7",
        formula="either(stated_elasticity_factor, sqrt(1 / (pi * ((1 - poisson_ratio_sun**2) / young_modulus_sun"
        " + (1 - poisson_ratio_planet**2) / young_modulus_planet))))",
    )  # fmt: skip
    contact_ratio_factor: Float = found(
        "", symbol="Z_epsilon", note="contact ratio factor; as stated where it is", source=ISO + "8",
        formula="either(stated_contact_ratio_factor, sqrt(cases((4 - contact_ratio) / 3 * (1 - overlap_ratio)"
        " + overlap_ratio / contact_ratio, overlap_ratio < 1, 1 / contact_ratio)))",
    )  # fmt: skip
    helix_power: Float = found("", symbol="q_beta", note="power of cos beta in the helix factor", source=ISO + "9",
                               method="-1/2 by ISO 6336:2006, 1/2 by GB/T 3480-1997")  # fmt: skip
    helix_factor: Float = found("", symbol="Z_beta", note="helix factor; as stated where it is", source=ISO + "9",
                                formula="either(stated_helix_factor, cos(helix_angle)**helix_power)")  # fmt: skip
    single_contact_counts: Float = found("", symbol="s_BD", note="1 where the single contact counts, else 0",
                                         method="single_contact as stated", source=ISO + "6")  # fmt: skip
    single_contact_factor_sun: Float = found(
        "", symbol="Z_B", note="single contact factor of the sun; as stated where it is", source=ISO + "6",
        formula="either(stated_single_contact_sun, cases(max(1, overlap_ratio + (1 - overlap_ratio)"
        " * tan(working_angle) / sqrt((tan(tip_angle_sun) - 2 * pi / teeth_sun)"
        " * (tan(tip_angle_planet) - (contact_ratio - 1) * 2 * pi / teeth_planet))),"
        " single_contact_counts > 0 and overlap_ratio < 1, 1))",
    )  # fmt: skip
    single_contact_factor_planet: Float = found(
        "", symbol="Z_D", note="single contact factor of the planet; as stated where it is", source=ISO + "6",
        formula="either(stated_single_contact_planet, cases(max(1, overlap_ratio + (1 - overlap_ratio)"
        " * tan(working_angle) / sqrt((tan(tip_angle_planet) - 2 * pi / teeth_planet)"
        " * (tan(tip_angle_sun) - (contact_ratio - 1) * 2 * pi / teeth_sun))),"
        " single_contact_counts > 0 and overlap_ratio < 1, 1))",
    )  # fmt: skip
    lubricant_constant: Float = found(
        "", symbol="C_ZL", note="share of Z_L without lubricant, by the softer gear", numeric=True, source=ISO + "12",
        formula=f"cases(0.83, {SOFTER} < 850, 0.91, {SOFTER} > 1200, {SOFTER} / 4375 + 0.6357)",
    )  # fmt: skip
    lubricant_factor: Float = found(
        "", symbol="Z_L", note="lubricant factor; as stated where it is", numeric=True, source=ISO + "12",
        formula="either(stated_lubricant_factor,"
        " lubricant_constant + 4 * (1 - lubricant_constant) / (1.2 + 134 / viscosity)**2)",
    )  # fmt: skip
    velocity_factor: Float = found(
        "", symbol="Z_V", note="velocity factor; as stated where it is", numeric=True, source=ISO + "12",
        formula="either(stated_velocity_factor, lubricant_constant + 0.02"
        " + 2 * (0.98 - lubricant_constant) / sqrt(0.8 + 32 / pitch_line_velocity))",
    )  # fmt: skip
    relative_roughness: Float = found(
        "um", symbol="R_z10", note="mean roughness of the flanks at a relative radius of 10 mm", numeric=True,
        source=ISO + "12",
        formula="(flank_roughness_sun + flank_roughness_planet) / 2 * cbrt(10 / curvature)",
    )  # fmt: skip
    roughness_exponent: Float = found(
        "", symbol="C_ZR", note="exponent of the roughness factor, by the softer gear", numeric=True, source=ISO + "12",
        formula=f"cases(0.15, {SOFTER} < 850, 0.08, {SOFTER} > 1200, 0.32 - 0.0002 * {SOFTER})",
    )  # fmt: skip
    roughness_factor: Float = found(
        "", symbol="Z_R", note="roughness factor; as stated where it is", numeric=True, source=ISO + "12",
        formula="either(stated_roughness_factor, (3 / relative_roughness)**roughness_exponent)",
    )  # fmt: skip


def contact_ratio_factor(stage: Gearing, mesh: MeshSize) -> Float:
    """Return Z_epsilon, as stated where it is."""
    contact, overlap = mesh.contact_ratio, mesh.overlap_ratio
    below = (4.0 - contact) / 3.0 * (1.0 - overlap) + overlap / contact
    return either(stage.stated_contact_ratio_factor, np.sqrt(np.where(overlap < 1.0, below, 1.0 / contact)))


def contact_factors(
    stage: Gearing, sizes: tuple[GearSize, GearSize], mesh: MeshSize, velocity: Float, z_epsilon: Float
) -> ContactFactors:
    """Return the factors of the contact stress and of the contact strength."""
    power = -0.5 if stage.helix_reading == "iso" else 0.5
    working = mesh.working_angle
    zone = (
        2.0 * np.cos(mesh.base_helix_angle) * np.cos(working) / (np.cos(mesh.transverse_angle) ** 2 * np.sin(working))
    )
    sun, planet = stage.sun, stage.planet
    bodies = (1.0 - sun.poisson_ratio**2) / sun.young_modulus + (1.0 - planet.poisson_ratio**2) / planet.young_modulus
    single = single_contact_factors(stage, sizes, mesh)
    softer_mpa = np.minimum(sun.contact_limit, planet.contact_limit) / MPA
    share = by_strength(softer_mpa, (0.83, 0.91), softer_mpa / 4375.0 + 0.6357)
    roughness = 0.5 * (sun.flank_roughness + planet.flank_roughness) * np.cbrt(0.01 / mesh.curvature)
    exponent = by_strength(softer_mpa, (0.15, 0.08), 0.32 - 0.0002 * softer_mpa)
    with np.errstate(divide="ignore"):
        oil = share + 4.0 * (1.0 - share) / (1.2 + 134e-6 / stage.viscosity) ** 2
        moving = share + 0.02 + 2.0 * (0.98 - share) / np.sqrt(0.8 + 32.0 / velocity)
    return ContactFactors(
        zone_factor=either(stage.stated_zone_factor, np.sqrt(zone)),
        elasticity_factor=either(stage.stated_elasticity_factor, np.sqrt(1.0 / (np.pi * bodies))),
        contact_ratio_factor=z_epsilon,
        helix_power=power,
        helix_factor=either(stage.stated_helix_factor, np.cos(stage.helix_angle) ** power),
        single_contact_counts=float(stage.single_contact),
        single_contact_factor_sun=single[0],
        single_contact_factor_planet=single[1],
        lubricant_constant=share,
        lubricant_factor=either(stage.stated_lubricant_factor, oil),
        velocity_factor=either(stage.stated_velocity_factor, moving),
        relative_roughness=roughness,
        roughness_exponent=exponent,
        roughness_factor=either(stage.stated_roughness_factor, (3e-6 / roughness) ** exponent),
    )


def by_strength(strength_mpa: Float, ends: tuple[float, float], between: Float) -> Float:
    """Return a constant by the endurance limit: the first end below 850 MPa, the second above 1200 MPa."""
    return np.where(strength_mpa < 850.0, ends[0], np.where(strength_mpa > 1200.0, ends[1], between))


def single_contact_factors(stage: Gearing, sizes: tuple[GearSize, GearSize], mesh: MeshSize) -> tuple[Float, Float]:
    """Return Z_B of the sun and Z_D of the planet: 1 where they are switched off, or the overlap is a full pitch."""
    stated = stage.sun.stated_single_contact, stage.planet.stated_single_contact
    if not stage.single_contact:
        one = 1.0 + 0.0 * mesh.contact_ratio
        return either(stated[0], one), either(stated[1], one)
    found = []
    for own, (first, second), name in zip(stated, (sizes, sizes[::-1]), ("sun", "planet"), strict=True):
        inner = np.tan(first.tip_angle) - 2.0 * np.pi / first.teeth
        outer = np.tan(second.tip_angle) - (mesh.contact_ratio - 1.0) * 2.0 * np.pi / second.teeth
        used = np.isnan(own) & (mesh.overlap_ratio < 1.0)
        feasible(
            np.logical_not(used) | ((inner > 0.0) & (outer > 0.0)),
            f"the single contact of the {name} would lie below the base circle: raise the teeth or the shifts, or set "
            "single_contact = false",
        )
        overlap = mesh.overlap_ratio
        with np.errstate(invalid="ignore", divide="ignore"):
            raised = overlap + (1.0 - overlap) * np.tan(mesh.working_angle) / np.sqrt(inner * outer)
        found.append(either(own, np.where(overlap < 1.0, np.maximum(1.0, raised), 1.0)))
    return found[0], found[1]
