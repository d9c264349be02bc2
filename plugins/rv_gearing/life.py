"""How often the teeth are loaded, and what their material bears that often. Reference: ISO 6336-2 and -3:2006."""

import numpy as np

from rv_gearing.loads import Load
from rv_gearing.quantities import Gear, Gearing
from rv_gearing.steel import Steel
from truing import Float, either, found, results

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


@results
class Cycles:
    """Load cycles of both gears."""

    load_cycles_sun: Float = found("", symbol="N_L1", note="load cycles of a sun tooth",
                                   formula="mesh_speed * planets * working_life")  # fmt: skip
    load_cycles_planet: Float = found("", symbol="N_L2", note="load cycles of a planet tooth flank",
                                      formula="mesh_speed / tooth_ratio * working_life")  # fmt: skip


def cycles_of(stage: Gearing, load: Load) -> Cycles:
    """Return the load cycles of sun and planet: a sun tooth meets every planet."""
    turns = load.mesh_speed * stage.working_life
    return Cycles(load_cycles_sun=turns * stage.planets, load_cycles_planet=turns * load.sun / load.planet)


def life_of(gear: Gear, steel: Steel, cycles: Float) -> GearLife:
    """Return the life factors of one gear."""
    contact = life_factor(
        cycles, steel.contact_life_knee, (steel.contact_life_slope, steel.contact_life_tail), steel.contact_life_most
    )
    bending = life_factor(cycles, BENDING_KNEE, (steel.bending_life_slope, BENDING_TAIL), steel.bending_life_most)
    return GearLife(
        contact_life_factor=either(gear.stated_contact_life, contact),
        bending_life_factor=either(gear.stated_bending_life, bending),
    )


def life_factor(cycles: Float, knee: Float, slopes: tuple[Float, Float], most: Float) -> Float:
    """Return the life factor: 1 at the knee, at most ``most`` before it, at least 0.85 after it."""
    share = knee / cycles
    return np.where(cycles <= knee, np.minimum(share ** slopes[0], most), np.maximum(share ** slopes[1], LEAST))
