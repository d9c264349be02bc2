"""From load and factors to the stresses of one gear, what they may be, and how safe it is."""

from dataclasses import dataclass

import numpy as np

from rv_gearing.answers import MOST_SAFETY, GearStress
from rv_gearing.bending_factors import BendingFactors, GearRoot
from rv_gearing.contact_factors import ContactFactors
from rv_gearing.life import GearLife
from rv_gearing.loads import Load
from rv_gearing.pair import GearSize, MeshSize
from rv_gearing.quality import GearQuality
from rv_gearing.quantities import Gear, Gearing
from truing import Float


@dataclass(frozen=True, kw_only=True)
class Acting:
    """What acts on both gears alike: nominal stresses without the factors of one gear, and the load factors."""

    contact: Float  # Pa, sigma_H0
    contact_factor: Float  # root of the load factors for contact
    contact_strength: Float  # factors of the contact strength without Z_NT
    tip: Float  # Pa, F_t/(b m) with Y_epsilon and Y_beta
    outer: Float  # Pa, F_t/(b m) with Y_beta and Y_DT
    bending_factor: Float  # load factors for bending
    tip_factor: Float


def acting(
    stage: Gearing, load: Load, size: tuple[GearSize, MeshSize], factors: tuple[ContactFactors, BendingFactors],
    shares: tuple[Float, Float],
) -> Acting:  # fmt: skip
    """Return what acts on both gears; ``size`` is that of sun and mesh, ``shares`` the load factors behind K_A."""
    contact, bending = factors
    width = stage.carrying_share * stage.face_width
    u = size[1].tooth_ratio
    pressed = load.tangential_force / (size[0].reference_diameter * width) * (u + 1.0) / u
    bent = load.tangential_force / (width * stage.module) * bending.helix_factor_bending
    return Acting(
        contact=contact.zone_factor * contact.elasticity_factor * contact.contact_ratio_factor * contact.helix_factor
        * np.sqrt(pressed),
        contact_factor=np.sqrt(stage.application_factor * shares[0]),
        contact_strength=contact.lubricant_factor * contact.velocity_factor * contact.roughness_factor
        * stage.work_hardening_factor * stage.contact_size_factor,
        tip=bent * bending.contact_ratio_factor_bending,
        outer=bent * bending.deep_tooth_factor,
        bending_factor=stage.application_factor * shares[1],
        tip_factor=bending.tip_load_factor,
    )  # fmt: skip


def stresses_of(
    stage: Gearing, gear: Gear, act: Acting, single_contact: Float,
    known: tuple[GearSize, GearQuality, GearRoot, GearLife],
) -> GearStress:  # fmt: skip
    """Return stresses and safeties of one gear."""
    size, quality, root, life = known
    nominal = act.tip * root.form_factor * root.stress_correction
    nominal_outer = act.outer * root.form_factor_outer * root.stress_correction_outer
    stress, outer = nominal * act.bending_factor * act.tip_factor, nominal_outer * act.bending_factor
    bears = gear.bending_limit * stage.stress_correction_of_test * life.bending_life_factor * root.notch_sensitivity
    bears = bears * root.root_surface * root.bending_size
    contact = single_contact * act.contact * act.contact_factor
    flank_bears = gear.contact_limit * life.contact_life_factor * act.contact_strength
    return GearStress(
        nominal_root_stress=nominal,
        root_stress=stress,
        nominal_root_stress_outer=nominal_outer,
        root_stress_outer=outer,
        permitted_root_stress=bears / stage.least_bending_safety,
        root_safety=safety(bears, stress),
        root_safety_outer=safety(bears, outer),
        contact_stress=contact,
        permitted_contact_stress=flank_bears / stage.least_contact_safety,
        contact_safety=safety(flank_bears, contact),
        size=size,
        quality=quality,
        root=root,
        life=life,
    )


def safety(strength: Float, stress: Float) -> Float:
    """Return strength over stress, 1000 at most: a stage without load is that safe."""
    with np.errstate(divide="ignore"):
        return np.minimum(np.divide(strength, stress), MOST_SAFETY)
