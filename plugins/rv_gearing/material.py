"""What the treatment of the steel fixes, and what it bears at the number of loads of a life."""

from typing import Any

import numpy as np

from rv_gearing.geometry import ToothLoad
from rv_gearing.quantities import Gear, Gearing
from truing import Float, either, found, results

# What the treatment of the steel fixes: life curves, running-in, sensitivity to notches, roughness and size
#
# Values of ISO 6336-1 to -3:2006; the exponents of the life curves are those that join the points of the standard, as
# GB/T 3480-1997 prints them.

PART_2 = "ISO 6336-2:2006, clause 11"
LIFE = "ISO 6336-3:2006, clause 12"
NOTCH = "ISO 6336-3:2006, clause 13"
SURFACE = "ISO 6336-3:2006, clause 14"
SIZE = "ISO 6336-3:2006, clause 15"
PROOF_STRESS = (500e6, 600e6, 800e6, 1000e6)  # Pa, of through-hardened steel
SLIP_LAYER = (0.0281e-3, 0.0194e-3, 0.0064e-3, 0.0014e-3)  # m


def constant(symbol: str, note: str, source: str) -> Any:
    """Declare a number that the material fixes."""
    return found("", symbol=symbol, note=note, method="by the material", source=source)


@results
class Steel:
    """Constants of the material of both gears, as the formulas of the factors use them."""

    contact_life_most: Float = constant("Z_NT,st", "life factor for contact of few cycles", PART_2)
    contact_life_knee: Float = constant("N_H", "cycles of the endurance limit for contact", PART_2)
    contact_life_slope: Float = constant("q_H", "exponent of limited life for contact", PART_2)
    contact_life_tail: Float = constant("q_H,l", "exponent of long life for contact", PART_2)
    bending_life_most: Float = constant("Y_NT,st", "life factor for bending of few cycles", LIFE)
    bending_life_slope: Float = constant("q_F", "exponent of limited life for bending", LIFE)
    slip_layer: Float = found("mm", symbol="rho'", note="thickness of the slip layer", source=NOTCH,
                              method="by the material; of through-hardened steel by its proof stress")  # fmt: skip
    surface_smooth: Float = constant("Y_R,0", "surface factor of a root smoother than 1 um", SURFACE)
    surface_constant: Float = constant("Y_R,1", "constant of the surface factor", SURFACE)
    surface_slope: Float = constant("Y_R,2", "slope of the surface factor", SURFACE)
    surface_exponent: Float = constant("q_R", "exponent of the surface factor", SURFACE)
    size_constant: Float = constant("Y_X,1", "constant of the size factor for bending", SIZE)
    size_slope: Float = constant("Y_X,2", "slope of the size factor for bending, per mm", SIZE)
    size_least: Float = constant("Y_X,3", "least size factor for bending", SIZE)


HARDENED_CONTACT = {
    "contact_life_most": 1.6,
    "contact_life_knee": 5e7,
    "contact_life_slope": 0.0756,
    "contact_life_tail": 0.0306,
}
HARDENED_SURFACE = {"surface_smooth": 1.12, "surface_constant": 1.674, "surface_slope": 0.529, "surface_exponent": 0.1}
HARDENED_SIZE = {"size_constant": 1.05, "size_slope": 0.01, "size_least": 0.8}
CURVES: dict[str, dict[str, Float]] = {
    "case_hardened": {
        **HARDENED_CONTACT, **HARDENED_SURFACE, **HARDENED_SIZE, "bending_life_most": 2.5, "bending_life_slope": 0.115,
        "slip_layer": 0.003e-3,
    },
    "through_hardened": {
        **HARDENED_CONTACT, **HARDENED_SURFACE, "bending_life_most": 2.5, "bending_life_slope": 0.16,
        "size_constant": 1.03, "size_slope": 0.006, "size_least": 0.85,
    },
    "nitrided": {
        "contact_life_most": 1.3, "contact_life_knee": 2e6, "contact_life_slope": 0.0876, "contact_life_tail": 0.0191,
        "bending_life_most": 1.6, "bending_life_slope": 0.0587, "slip_layer": 0.1005e-3, "surface_smooth": 1.025,
        "surface_constant": 4.299, "surface_slope": 3.259, "surface_exponent": 0.0058, **HARDENED_SIZE,
    },
}  # fmt: skip


def steel_of(stage: Gearing) -> Steel:
    """Return the constants of the material that is stated."""
    values = CURVES[stage.material]
    if stage.material == "through_hardened":
        return Steel(**values, slip_layer=np.interp(stage.proof_stress, PROOF_STRESS, SLIP_LAYER))
    return Steel(**values)


# How often the teeth are loaded, and what their material bears that often. Reference: ISO 6336-2 and -3:2006

BENDING_KNEE = 3e6  # cycles of the endurance limit for bending, all materials
BENDING_TAIL = 0.02
LEAST = 0.85


@results
class GearLife:
    """Life factors of one gear."""

    contact_life_factor: Float = found(
        "", symbol="Z_NT", note="life factor for contact, no pitting; as stated where it is",
        source="ISO 6336-2:2006, clause 11",
        formula="either(stated_contact_life, cases("
        "min((contact_life_knee / load_cycles)**contact_life_slope, contact_life_most),"
        " load_cycles <= contact_life_knee,"
        " max((contact_life_knee / load_cycles)**contact_life_tail, 0.85)))",
    )  # fmt: skip
    bending_life_factor: Float = found(
        "", symbol="Y_NT", note="life factor for bending; as stated where it is", source="ISO 6336-3:2006, clause 12",
        formula="either(stated_bending_life, cases(min((3e6 / load_cycles)**bending_life_slope, bending_life_most),"
        " load_cycles <= 3e6, max((3e6 / load_cycles)**0.02, 0.85)))",
    )  # fmt: skip
    mean_stress_factor: Float = found(
        "", symbol="Y_M", note="mean stress influence factor: 1 pulsating", source="ISO 6336-3:2006, annex B",
        formula="1 / (1 - stress_ratio * (1 - mean_stress_sensitivity) / (1 + mean_stress_sensitivity))",
    )  # fmt: skip


@results
class Cycles:
    """Load cycles of both gears."""

    load_cycles_sun: Float = found("", symbol="N_L1", note="load cycles of a sun tooth",
                                   formula="mesh_speed * planets * working_life")  # fmt: skip
    load_cycles_planet: Float = found("", symbol="N_L2", note="load cycles of a planet tooth flank",
                                      formula="mesh_speed / tooth_ratio * working_life")  # fmt: skip


def cycles_of(stage: Gearing, load: ToothLoad) -> Cycles:
    """Return the load cycles of sun and planet: a sun tooth meets every planet."""
    turns = load.duty.mesh_speed * stage.working_life
    return Cycles(load_cycles_sun=turns * stage.planets, load_cycles_planet=turns * load.sun / load.planet)


def life_of(gear: Gear, steel: Steel, cycles: Float, sensitivity: Float) -> GearLife:
    """Return the life factors of one gear, with the mean stress factor for its sensitivity to mean stress."""
    contact = life_factor(
        cycles, steel.contact_life_knee, (steel.contact_life_slope, steel.contact_life_tail), steel.contact_life_most
    )
    bending = life_factor(cycles, BENDING_KNEE, (steel.bending_life_slope, BENDING_TAIL), steel.bending_life_most)
    return GearLife(
        contact_life_factor=either(gear.stated_contact_life, contact),
        bending_life_factor=either(gear.stated_bending_life, bending),
        mean_stress_factor=mean_stress_factor(gear.stress_ratio, sensitivity),
    )


def mean_stress_factor(ratio: Float, sensitivity: Float) -> Float:
    """Return Y_M: largest stress that lasts at a stress ratio R <= 0 over that at R = 0.

    A straight line in the diagram of amplitude over mean stress, of slope ``sensitivity`` M: sigma_a + M sigma_m is the
    same for both, with sigma_a = sigma (1 - R)/2 and sigma_m = sigma (1 + R)/2.
    """
    return 1.0 / (1.0 - ratio * (1.0 - sensitivity) / (1.0 + sensitivity))


def life_factor(cycles: Float, knee: Float, slopes: tuple[Float, Float], most: Float) -> Float:
    """Return the life factor: 1 at the knee, at most ``most`` before it, at least 0.85 after it."""
    share = knee / cycles
    return np.where(cycles <= knee, np.minimum(share ** slopes[0], most), np.maximum(share ** slopes[1], LEAST))
