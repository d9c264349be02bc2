"""How much the teeth excite one another: the dynamic factor. Reference: ISO 6336-1:2006, 6.5, method B."""

import numpy as np

from rv_gearing.loads import Load
from rv_gearing.pair import GearSize
from rv_gearing.quality import MeshQuality
from rv_gearing.quantities import Gearing
from rv_gearing.stiffness import Stiffness
from truing import Float, either, feasible, found, results

CLAUSE = "ISO 6336-1:2006, 6.5"
COEFFICIENT = "ISO 6336-1:2006, 6.5, table of C_v"
COARSE = 6  # accuracy grade from which tip relief does not count
FULL_LOAD = 100e3  # N/m


@results
class Dynamics:
    """Inertia, resonance and dynamic factor of the mesh."""

    inertia_sun: Float = found("kg*mm", symbol="J_1", note="moment of inertia of the sun per face width", source=CLAUSE,
                               formula="pi / 32 * density * (1 - bore_ratio_sun**4)"
                               " * ((tip_diameter_sun + root_diameter_sun) / 2)**4")  # fmt: skip
    inertia_planet: Float = found("kg*mm", symbol="J_2", note="moment of inertia of a planet per face width",
                                  source=CLAUSE, formula="pi / 32 * density * (1 - bore_ratio_planet**4)"
                                  " * ((tip_diameter_planet + root_diameter_planet) / 2)**4")  # fmt: skip
    reduced_mass: Float = found(
        "kg/mm", symbol="m_red", note="reduced mass of sun and planets per face width",
        source="ISO 6336-1:2006, 6.5.8 and 6.5.9",
        formula="4 * inertia_sun * inertia_planet / (planets * inertia_planet * base_diameter_sun**2"
        " + inertia_sun * base_diameter_planet**2)",
    )  # fmt: skip
    resonance_speed: Float = found(
        "rpm", symbol="n_E", note="resonance speed of the mesh", source="ISO 6336-1:2006, 6.5.3",
        formula="sqrt(mesh_stiffness / reduced_mass) / (2 * pi * teeth_sun)",
    )  # fmt: skip
    resonance_ratio: Float = found("", symbol="N", note="mesh speed over resonance speed",
                                   source="ISO 6336-1:2006, 6.5.3", formula="mesh_speed / resonance_speed")  # fmt: skip
    resonance_limit: Float = found(
        "", symbol="N_S", note="end of the range below resonance", numeric=True, source="ISO 6336-1:2006, 6.5.3",
        formula="cases(0.85, line_load >= 100, 0.5 + 0.35 * sqrt(line_load / 100))",
    )  # fmt: skip
    pitch_influence: Float = found("", symbol="B_p", note="influence of the pitch deviation",
                                   source="ISO 6336-1:2006, 6.5.4",
                                   formula="tooth_stiffness * pitch_left / line_load")  # fmt: skip
    profile_influence: Float = found("", symbol="B_f", note="influence of the profile deviation",
                                     source="ISO 6336-1:2006, 6.5.4",
                                     formula="tooth_stiffness * profile_left / line_load")  # fmt: skip
    relief_influence: Float = found(
        "", symbol="B_k", note="influence of the tip relief", source="ISO 6336-1:2006, 6.5.4",
        formula="cases(1, accuracy_grade >= 6, abs(1 - tooth_stiffness * tip_relief / line_load))",
    )  # fmt: skip
    profile_coefficient: Float = found(
        "", symbol="C_v2", note="for the profile deviation", source=COEFFICIENT,
        formula="cases(0.34, total_contact_ratio <= 2, 0.57 / (total_contact_ratio - 0.3))",
    )  # fmt: skip
    stiffness_coefficient: Float = found(
        "", symbol="C_v3", note="for the changing stiffness, below resonance", source=COEFFICIENT,
        formula="cases(0.23, total_contact_ratio <= 2, 0.096 / (total_contact_ratio - 1.56))",
    )  # fmt: skip
    resonance_coefficient: Float = found(
        "", symbol="C_v4", note="for the changing stiffness, at resonance", source=COEFFICIENT,
        formula="cases(0.90, total_contact_ratio <= 2,"
        " (0.57 - 0.05 * total_contact_ratio) / (total_contact_ratio - 1.44))",
    )  # fmt: skip
    fast_coefficient: Float = found(
        "", symbol="C_v6", note="for the profile deviation, above resonance", source=COEFFICIENT,
        formula="cases(0.47, total_contact_ratio <= 2, 0.12 / (total_contact_ratio - 1.74))",
    )  # fmt: skip
    fast_constant: Float = found(
        "", symbol="C_v7", note="for the changing stiffness, above resonance", source=COEFFICIENT,
        formula="cases(0.75, total_contact_ratio <= 1.5, 0.125 * sin(pi * (total_contact_ratio - 2)) + 0.875,"
        " total_contact_ratio <= 2.5, 1)",
    )  # fmt: skip
    dynamic_slow: Float = found(
        "", symbol="K", note="growth of the dynamic factor below resonance", source="ISO 6336-1:2006, 6.5.4",
        formula="0.32 * pitch_influence + profile_coefficient * profile_influence"
        " + stiffness_coefficient * relief_influence",
    )  # fmt: skip
    dynamic_resonant: Float = found(
        "", symbol="K_V,115", note="dynamic factor at resonance", source="ISO 6336-1:2006, 6.5.5",
        formula="1 + 0.32 * pitch_influence + profile_coefficient * profile_influence"
        " + resonance_coefficient * relief_influence",
    )  # fmt: skip
    dynamic_fast: Float = found(
        "", symbol="K_V,150", note="dynamic factor above resonance", source="ISO 6336-1:2006, 6.5.6",
        formula="0.47 * pitch_influence + fast_coefficient * profile_influence + fast_constant",
    )  # fmt: skip
    dynamic_factor: Float = found(
        "", symbol="K_V", note="dynamic factor; as stated where it is", source="ISO 6336-1:2006, 6.5.4 to 6.5.7",
        formula="either(stated_dynamic_factor, cases(1 + resonance_ratio * dynamic_slow,"
        " resonance_ratio <= resonance_limit, dynamic_resonant, resonance_ratio <= 1.15,"
        " dynamic_fast + (dynamic_resonant - dynamic_fast) * (1.5 - resonance_ratio) / 0.35, resonance_ratio < 1.5,"
        " dynamic_fast)) + extra_dynamic_factor",
    )  # fmt: skip


def dynamics_of(
    stage: Gearing, load: Load, sizes: tuple[GearSize, GearSize], total_contact_ratio: Float,
    held: tuple[MeshQuality, Stiffness],
) -> Dynamics:  # fmt: skip
    """Return the dynamic factor with all that it follows from; ``held`` is quality and stiffness of the mesh."""
    quality, stiffness = held
    inertia = [
        np.pi / 32.0 * stage.density * (1.0 - gear.bore_ratio**4)
        * (0.5 * (size.tip_diameter + size.root_diameter)) ** 4
        for gear, size in zip((stage.sun, stage.planet), sizes, strict=True)
    ]  # fmt: skip
    bases = load.base_radii
    mass = inertia[0] * inertia[1] / (stage.planets * inertia[1] * bases[0] ** 2 + inertia[0] * bases[1] ** 2)
    resonance = np.sqrt(stiffness.mesh_stiffness / mass) / (2.0 * np.pi * load.sun)
    ratio, limit = load.mesh_speed / resonance, resonance_limit(load.line_load)
    specific = stiffness.tooth_stiffness / load.line_load
    pitch, profile, relief = specific * quality.pitch_left, specific * quality.profile_left, _relief(stage, specific)
    c_2, c_3, c_4, c_6, c_7 = coefficients(total_contact_ratio)
    slow = 0.32 * pitch + c_2 * profile + c_3 * relief
    resonant = 1.0 + 0.32 * pitch + c_2 * profile + c_4 * relief
    fast = 0.47 * pitch + c_6 * profile + c_7
    factor = either(stage.stated_dynamic_factor, by_range(ratio, limit, (slow, resonant, fast)))
    factor = factor + stage.extra_dynamic_factor
    feasible(factor > 0.0, "the dynamic factor must exceed 0: raise extra_dynamic_factor")
    return Dynamics(
        inertia_sun=inertia[0], inertia_planet=inertia[1], reduced_mass=mass, resonance_speed=resonance,
        resonance_ratio=ratio, resonance_limit=limit, pitch_influence=pitch, profile_influence=profile,
        relief_influence=relief, profile_coefficient=c_2, stiffness_coefficient=c_3, resonance_coefficient=c_4,
        fast_coefficient=c_6, fast_constant=c_7, dynamic_slow=slow, dynamic_resonant=resonant, dynamic_fast=fast,
        dynamic_factor=factor,
    )  # fmt: skip


def _relief(stage: Gearing, specific: Float) -> Float:
    """Return B_k: tip relief counts for accurate gears only."""
    if stage.accuracy_grade >= COARSE:
        return 1.0
    return np.abs(1.0 - specific * stage.tip_relief)


def resonance_limit(line_load: Float) -> Float:
    """Return N_S, the speed ratio at which the resonance range begins, for a line load in N/m."""
    return np.where(line_load >= FULL_LOAD, 0.85, 0.5 + 0.35 * np.sqrt(line_load / FULL_LOAD))


def coefficients(ratio: Float) -> tuple[Float, Float, Float, Float, Float]:
    """Return C_v2, C_v3, C_v4, C_v6 and C_v7 for a total contact ratio; C_v1 is 0.32 and C_v5 0.47 for all."""
    low = np.less_equal(ratio, 2.0)
    bent = np.where(np.less_equal(ratio, 2.5), 0.125 * np.sin(np.pi * (ratio - 2.0)) + 0.875, 1.0)
    with np.errstate(divide="ignore"):
        return (
            np.where(low, 0.34, 0.57 / (ratio - 0.3)),
            np.where(low, 0.23, 0.096 / (ratio - 1.56)),
            np.where(low, 0.90, (0.57 - 0.05 * ratio) / (ratio - 1.44)),
            np.where(low, 0.47, 0.12 / (ratio - 1.74)),
            np.where(np.less_equal(ratio, 1.5), 0.75, bent),
        )


def by_range(ratio: Float, limit: Float, factors: tuple[Float, Float, Float]) -> Float:
    """Return the dynamic factor at a speed ratio; ``factors`` are growth below, factor at and factor above resonance.

    The standard lets it jump at ``limit``; from there on it is continuous.
    """
    slow, resonant, fast = factors
    between = fast + (resonant - fast) * (1.5 - ratio) / 0.35
    above = np.where(ratio <= 1.15, resonant, np.where(ratio < 1.5, between, fast))
    return np.where(ratio <= limit, 1.0 + ratio * slow, above)
