"""How unevenly the teeth in mesh, and the planets, share the load.

Reference: ISO 6336-1:2006, 8.3, method B, for the teeth; Rao Zhenggang, Design of planetary transmissions, for K_Fp.
"""

import numpy as np

from rv_gearing.pair import MeshSize
from rv_gearing.quantities import Gearing
from truing import Float, either, found, results

CLAUSE = "ISO 6336-1:2006, 8.3"


@results
class PlanetSharing:
    """How unevenly the planets share."""

    planet_factor: Float = found(
        "", symbol="K_Hp", note="uneven sharing among the planets, with the error of sharing; none carries more",
        formula="min(max(planet_load_factor + sharing_error * mesh_stiffness * application_factor / line_load, 0),"
        " max(planets, planet_load_factor))",
        source="equation 13 of the paper",
    )  # fmt: skip
    planet_factor_bending: Float = found(
        "", symbol="K_Fp", note="uneven sharing among the planets, for bending; as stated where it is",
        formula="either(stated_planet_load_bending, max(1 + 1.5 * (planet_factor - 1), 0))",
        source="Rao Zhenggang, Design of planetary transmissions",
    )  # fmt: skip


@results
class Sharing:
    """How unevenly the teeth share."""

    transverse_line_load: Float = found("N/mm", symbol="w_tH", note="line load that parts the teeth", source=CLAUSE,
                                        formula="mean_line_load * face_factor")  # fmt: skip
    transverse_base: Float = found(
        "", symbol="K_alpha", note="transverse load factor before its bounds", source=CLAUSE,
        formula="cases(total_contact_ratio / 2 * (0.9 + 0.4 * mesh_stiffness * pitch_left / transverse_line_load),"
        " total_contact_ratio <= 2, 0.9 + 0.4 * sqrt(2 * (total_contact_ratio - 1) / total_contact_ratio)"
        " * mesh_stiffness * pitch_left / transverse_line_load)",
    )  # fmt: skip
    transverse_factor: Float = found(
        "", symbol="K_H alpha", note="transverse load factor for contact, within its bounds; as stated where it is",
        source=CLAUSE, formula="either(stated_transverse_factor, max(min(transverse_base,"
        " total_contact_ratio / (contact_ratio * contact_ratio_factor**2)), 1))",
    )  # fmt: skip
    transverse_factor_bending: Float = found(
        "", symbol="K_F alpha", note="transverse load factor for bending, within its bounds; as stated where it is",
        source=CLAUSE, formula="either(stated_transverse_factor_bending, max(min(transverse_base,"
        " total_contact_ratio / (0.25 * contact_ratio + 0.75)), 1))",
    )  # fmt: skip


def sharing_of(
    stage: Gearing, mesh: MeshSize, line_load: Float, pitch_left: Float, held: tuple[Float, Float]
) -> Sharing:
    """Return how the teeth share; ``line_load`` (N/m) holds all factors up to K_Hbeta.

    ``held`` are the mesh stiffness and the contact ratio factor Z_epsilon.
    """
    stiffness, z_epsilon = held
    total, contact = mesh.total_contact_ratio, mesh.contact_ratio
    error = stiffness * pitch_left / line_load
    base = np.where(
        total <= 2.0, 0.5 * total * (0.9 + 0.4 * error), 0.9 + 0.4 * np.sqrt(2.0 * (total - 1.0) / total) * error
    )
    most_h, most_f = total / (contact * z_epsilon**2), total / (0.25 * contact + 0.75)
    return Sharing(
        transverse_line_load=line_load,
        transverse_base=base,
        transverse_factor=either(stage.stated_transverse_factor, np.maximum(np.minimum(base, most_h), 1.0)),
        transverse_factor_bending=either(
            stage.stated_transverse_factor_bending, np.maximum(np.minimum(base, most_f), 1.0)
        ),
    )


def planets_of(stage: Gearing, line_load: Float, stiffness: Float) -> PlanetSharing:
    """Return how the planets share: as stated, and more by one that runs ahead, at most all; N/m and N/m2."""
    ahead = stage.sharing_error * stiffness * stage.application_factor / line_load
    most = np.maximum(float(stage.planets), stage.planet_load_factor)
    factor = np.minimum(np.maximum(stage.planet_load_factor + ahead, 0.0), most)
    bending = np.maximum(1.0 + 1.5 * (factor - 1.0), 0.0)
    return PlanetSharing(planet_factor=factor, planet_factor_bending=either(stage.stated_planet_load_bending, bending))
