"""What must hold before roughness, pairs and drive can be calculated: the sentence names the inputs and what to do."""

import numpy as np

from harmonic_fractal.catalogue import Polyline, polyline_of, ratio_of
from harmonic_fractal.contact import Contact, Pressed
from harmonic_fractal.interface import Rough, flanks_of, is_half_stated, range_of
from harmonic_fractal.mesh import Mesh, load_of_largest
from harmonic_fractal.micro import LEAST_DIMENSION, MOST_DIMENSION
from harmonic_fractal.quantities import Drive
from truing import Float, feasible


def require_surface(drive: Drive, rough: Rough) -> None:
    """Refuse what is no rough surface; NaN is none."""
    feasible(
        np.logical_not(is_half_stated(drive)),
        "the mating flank is half stated: state mating_dimension and mating_roughness, or neither if it is smooth",
    )
    if flanks_of(drive)[1] is not None:
        shortest, longest = range_of(drive)
        feasible(
            longest > shortest,
            "two flanks are added over the lags that both have, and these have none: enlarge longest_lag beyond "
            "sampling, or measure both flanks alike",
        )
    feasible(
        np.asarray(rough.dimension) >= LEAST_DIMENSION,
        f"the fractal dimension of both flanks together is below {LEAST_DIMENSION}, where the critical area, a power "
        "of 2/(D - 2), loses all meaning: enlarge fractal_dimension, or look at dimension_deviation",
    )
    feasible(
        np.asarray(rough.dimension) <= MOST_DIMENSION,
        f"the fractal dimension of both flanks together is above {MOST_DIMENSION}, where the contact area, a multiple "
        "of 1/(3 - D), loses all meaning: reduce fractal_dimension, or look at dimension_deviation",
    )
    feasible(
        np.isfinite(rough.roughness) & (np.asarray(rough.roughness) > 0.0),
        "the fractal roughness of both flanks together must be positive and finite: state fractal_roughness, and "
        "mating_roughness with mating_dimension",
    )


CLOSED = ("approach", "closing_clearance", "free_play")
"""The results that count the way of the pair from the reference load."""
TURNED = ("mesh_torsion", "torsion", "rough_torsion", "rough_share")
"""The results that count the torsion from the reference torque."""
COMPARED = ("catalogue_torsion", "catalogue_stiffness", "rough_share")
"""The results that need the catalogue."""


def require_contact(drive: Drive, contact: Contact, mesh: Mesh) -> None:
    """Refuse more pairs than there are teeth; without stiffness where the torsion begins nothing counts from there."""
    feasible(
        drive.engaged_pairs * np.asarray(mesh.engagement.factor(drive.torque)) <= drive.flexspline_teeth,
        "more pairs are engaged than the flexspline has teeth: reduce engaged_pairs, engaged_factor or engaged_gain, "
        "or enlarge flexspline_teeth",
    )
    feasible(
        np.isfinite(contact.critical_area) & (np.asarray(contact.critical_area) > 0.0),
        "the critical area is not a number that can be calculated with: look at fractal_roughness, hardness and the "
        "moduli",
    )
    starts = np.asarray(mesh.plastic_torque) < drive.reference_torque
    still = np.abs(drive.torque) <= drive.reference_torque
    untouched = drive.pair_load <= load_of_largest(drive.reference_torque, mesh)
    for holds, names in ((starts | untouched, CLOSED), (starts | still, TURNED)):
        feasible(
            holds,
            "at reference_torque all contacts are plastic and have no stiffness, so what counts from there is "
            "infinite: raise reference_torque above plastic_torque, where the first contact turns elastic, or reduce "
            "fractal_roughness",
            only=names,
        )


def require_flank(drive: Drive, one: Pressed, largest: Pressed) -> None:
    """Refuse contacts larger than the flank: of the pair that is looked at, and of the one that carries most."""
    flank: Float = drive.face_width * drive.flank_height
    for pair, load in ((one, "pair_load"), (largest, "torque")):
        feasible(
            np.asarray(pair.real_area) <= flank,
            f"the contact area exceeds the flank: reduce {load}, or enlarge face_width, flank_height or hardness",
        )


def require_catalogue(drive: Drive) -> Polyline:
    """Return what the catalogue prints for this drive; without a comparison where it prints none."""
    printed = polyline_of(drive.catalogue_size, ratio_of(drive))
    feasible(
        printed is not None,
        f"the catalogues print no size {drive.catalogue_size} with a ratio below 40: for a comparison choose "
        "catalogue_size 32 or smaller, or flexspline_teeth of 80 or more",
        only=COMPARED,
    )
    return printed or Polyline(np.nan, np.nan, (np.nan, np.nan, np.nan))
