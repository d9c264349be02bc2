"""How stiff a tooth and a mesh are. Reference: ISO 6336-1:2006, clause 9, method B, solid gears."""

import numpy as np

from rv_gearing.loads import Load
from rv_gearing.pair import GearSize
from rv_gearing.quantities import Gearing
from truing import Float, either, found, results

CLAUSE = "ISO 6336-1:2006, 9.3.1"
FULL_LOAD = 100e3  # N/m; below it a mesh is softer
STEEL_MODULUS = 206e9  # Pa


@results
class Stiffness:
    """Stiffness of tooth and mesh, per face width."""

    tooth_compliance: Float = found(
        "mm*um/N", symbol="q'", note="compliance of a pair of teeth, theoretical", numeric=True, source=CLAUSE,
        formula="0.04723 + 0.15551 / virtual_teeth_sun + 0.25791 / virtual_teeth_planet - 0.00635 * shift_sun"
        " - 0.11654 * shift_sun / virtual_teeth_sun - 0.00193 * shift_planet"
        " - 0.24188 * shift_planet / virtual_teeth_planet + 0.00529 * shift_sun**2 + 0.00182 * shift_planet**2",
    )  # fmt: skip
    theoretical_stiffness: Float = found("N/(mm*um)", symbol="c'_th", note="stiffness of a pair of teeth, theoretical",
                                         formula="1 / tooth_compliance", source=CLAUSE)  # fmt: skip
    rack_factor: Float = found(
        "", symbol="C_B", note="basic rack factor", numeric=True, source="ISO 6336-1:2006, 9.3.1.4",
        formula="(1 + 0.5 * (1.2 - dedendum)) * (1 - 0.02 * (20 - pressure_angle))",
    )  # fmt: skip
    modulus_factor: Float = found(
        "", symbol="zeta", note="moduli of both gears against steel", numeric=True, source=CLAUSE,
        formula="2 * young_modulus_sun * young_modulus_planet / ((young_modulus_sun + young_modulus_planet) * 206)",
    )  # fmt: skip
    low_load_factor: Float = found("", symbol="c_w", note="softer contact below 100 N/mm", numeric=True, source=CLAUSE,
                                   formula="min((line_load / 100)**0.25, 1)")  # fmt: skip
    tooth_stiffness: Float = found(
        "N/(mm*um)", symbol="c'", note="stiffness of a pair of teeth", source=CLAUSE,
        formula="0.8 * rack_factor * cos(helix_angle) * modulus_factor * low_load_factor * theoretical_stiffness",
    )  # fmt: skip
    mesh_stiffness: Float = found(
        "N/(mm*um)", symbol="c_gamma alpha", note="mean mesh stiffness", source="ISO 6336-1:2006, 9.3.2",
        formula="either(stated_mesh_stiffness, tooth_stiffness * (0.75 * contact_ratio + 0.25))",
    )  # fmt: skip
    mesh_stiffness_face: Float = found("N/(mm*um)", symbol="c_gamma beta", note="mesh stiffness for the face factor",
                                       source="ISO 6336-1:2006, 9.3.2", formula="0.85 * mesh_stiffness")  # fmt: skip


def stiffness_of(stage: Gearing, load: Load, sizes: tuple[GearSize, GearSize], contact_ratio: Float) -> Stiffness:
    """Return the stiffness of tooth and mesh."""
    first, second = sizes[0].virtual_teeth, sizes[1].virtual_teeth
    x_1, x_2 = stage.sun.shift, stage.planet.shift
    compliance_um = (
        0.04723 + 0.15551 / first + 0.25791 / second - 0.00635 * x_1 - 0.11654 * x_1 / first - 0.00193 * x_2
        - 0.24188 * x_2 / second + 0.00529 * x_1**2 + 0.00182 * x_2**2
    )  # fmt: skip
    theoretical = 1e9 / compliance_um
    rack = (1.0 + 0.5 * (1.2 - stage.dedendum)) * (1.0 - 0.02 * (20.0 - np.degrees(stage.pressure_angle)))
    moduli = stage.sun.young_modulus, stage.planet.young_modulus
    modulus = 2.0 * moduli[0] * moduli[1] / ((moduli[0] + moduli[1]) * STEEL_MODULUS)
    low = np.minimum((load.line_load / FULL_LOAD) ** 0.25, 1.0)
    tooth = 0.8 * rack * np.cos(stage.helix_angle) * modulus * low * theoretical
    mesh = either(stage.stated_mesh_stiffness, tooth * (0.75 * contact_ratio + 0.25))
    return Stiffness(
        tooth_compliance=1e-9 * compliance_um,
        theoretical_stiffness=theoretical,
        rack_factor=rack,
        modulus_factor=modulus,
        low_load_factor=low,
        tooth_stiffness=tooth,
        mesh_stiffness=mesh,
        mesh_stiffness_face=0.85 * mesh,
    )
