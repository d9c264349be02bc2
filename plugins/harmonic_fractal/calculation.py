"""From rough flanks to the stiffness of one pair, of the mesh and of the drive, and what must hold before."""

from typing import Any, Literal, NamedTuple

import numpy as np

from harmonic_fractal import contact as rough_contact
from harmonic_fractal.mesh import DriveMesh, line_stiffness, load_of_largest, mesh_of, mesh_torsion, normal_stiffness
from harmonic_fractal.micro import LEAST_DIMENSION, MOST_DIMENSION, elastic_sum
from harmonic_fractal.quantities import CLOSING, SIZES, Drive, Stiffness
from harmonic_fractal.structure import kept_share, structure_function
from truing import Float, column, feasible

# Torsional stiffness of harmonic drives as their maker's catalogues print it, size by size, in three straight pieces
#
# K_1 holds from 0 to T_1, K_2 to T_2, K_3 beyond. Sources: Harmonic Drive LLC, Cup Type Component Sets, CSF and CSG
# series, tables 41 and 42 (ratios 30 and 50); Harmonic Drive AG, CHA actuators, manual 1018854 (30, 50 and above). They
# agree where they overlap. The values are averages over many drives.

CatalogueColumn = Literal["30", "50", "above 50"]
UNIT = 1e3  # N m/rad

# size: T_1 and T_2 in N m, then K_1, K_2, K_3 in 1e3 N m/rad for ratios of 30, of 50, and above 50
TABLE: dict[str, tuple[float, float, dict[CatalogueColumn, tuple[float, float, float]]]] = {
    "14": (2.0, 6.9, {"30": (1.9, 2.4, 3.4), "50": (3.4, 4.7, 5.7), "above 50": (4.7, 6.1, 7.1)}),
    "17": (3.9, 12.0, {"30": (3.4, 4.4, 6.7), "50": (8.1, 11.0, 13.0), "above 50": (10.0, 14.0, 16.0)}),
    "20": (7.0, 25.0, {"30": (5.7, 7.1, 11.0), "50": (13.0, 18.0, 23.0), "above 50": (16.0, 25.0, 29.0)}),
    "25": (14.0, 48.0, {"30": (10.0, 13.0, 21.0), "50": (25.0, 34.0, 44.0), "above 50": (31.0, 50.0, 57.0)}),
    "32": (29.0, 108.0, {"30": (24.0, 30.0, 49.0), "50": (54.0, 78.0, 98.0), "above 50": (67.0, 110.0, 120.0)}),
    "40": (54.0, 196.0, {"50": (100.0, 140.0, 180.0), "above 50": (130.0, 200.0, 230.0)}),
    "50": (108.0, 382.0, {"50": (200.0, 280.0, 340.0), "above 50": (250.0, 400.0, 440.0)}),
    "58": (168.0, 598.0, {"50": (310.0, 440.0, 540.0), "above 50": (400.0, 610.0, 710.0)}),
}


class Polyline(NamedTuple):
    """Torsion over torque in three straight pieces: where they meet, N m, and their stiffnesses, N m/rad."""

    first_torque: float
    second_torque: float
    stiffnesses: tuple[float, float, float]

    def torsion(self, torque: Float) -> Float:
        """Return the torsion, rad, odd in the torque."""
        size, (first, second, third) = np.abs(torque), self.stiffnesses
        turned = np.minimum(size, self.first_torque) / first
        turned = turned + np.clip(size - self.first_torque, 0.0, self.second_torque - self.first_torque) / second
        return np.sign(torque) * (turned + np.maximum(size - self.second_torque, 0.0) / third)

    def stiffness(self, torque: Float) -> Float:
        """Return the stiffness of the piece in which the torque lies, N m/rad."""
        size, (first, second, third) = np.abs(torque), self.stiffnesses
        return np.where(size <= self.first_torque, first, np.where(size <= self.second_torque, second, third))


def column_of(ratio: float) -> CatalogueColumn:
    """Return the column of the table for a ratio: above 50, 50 from 40 on, and 30 below, the nearest of the two."""
    if ratio > 50.0:
        return "above 50"
    return "50" if ratio >= 40.0 else "30"


def polyline_of(size: SIZES, ratio: float) -> Polyline | None:
    """Return the printed pieces of a size and a ratio, or None where the catalogues print none."""
    first, second, columns = TABLE[size]
    printed = columns.get(column_of(ratio))
    if printed is None:
        return None
    return Polyline(first, second, (UNIT * printed[0], UNIT * printed[1], UNIT * printed[2]))


def ratio_of(drive: Drive) -> float:
    """Return the ratio with the circular spline at rest: half the teeth of the flexspline."""
    return drive.flexspline_teeth / 2.0


# What must hold before roughness, pairs and drive can be calculated: the sentence names the inputs and what to do


def require_surface(drive: Drive, rough: rough_contact.Rough) -> None:
    """Refuse what is no rough surface; NaN is none."""
    feasible(
        np.logical_not(rough_contact.is_half_stated(drive)),
        "the mating flank is half stated: state mating_dimension and mating_roughness, or neither if it is smooth",
    )
    if rough_contact.flanks_of(drive)[1] is not None:
        shortest, longest = rough_contact.range_of(drive)
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
TURNED = ("mesh_torsion", "torsion", "rough_torsion", "rough_share", "catalogue_ratio")
"""The results that count the torsion from the reference torque."""
COMPARED = ("catalogue_torsion", "catalogue_stiffness", "rough_share", "catalogue_ratio")
"""The results that need the catalogue."""


def require_contact(drive: Drive, contact: rough_contact.Contact, mesh: DriveMesh) -> None:
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


def require_flank(drive: Drive, one: rough_contact.Pressed, largest: rough_contact.Pressed) -> None:
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


def harmonic_fractal(drive: Drive) -> Stiffness:
    """One drive or a batch of them; every Float is a number or an array (n,), SI."""
    rough = rough_contact.interface_of(drive)
    require_surface(drive, rough)
    contact = rough_contact.contact_of(drive, rough)
    mesh = mesh_of(drive, contact)
    require_contact(drive, contact, mesh)
    pair = rough_contact.pressed(drive.pair_load, contact)
    require_flank(drive, pair, rough_contact.pressed(load_of_largest(drive.torque, mesh), contact))
    return Stiffness(
        lag=drive.lags,
        structure_function=_seen(drive, rough),
        surface_accepted=rough_contact.is_accepted(drive),
        spacing=rough_contact.spacing_of(drive),
        dimension=rough.dimension,
        profile_dimension=rough.dimension - 1.0,
        roughness=rough.roughness,
        **_contact(drive, contact),
        **_pair(drive, contact, pair),
        **_clearance(drive, contact, mesh, pair),
        **_mesh(drive, contact, mesh),
    )


def around_of(drive: Drive) -> dict[str, Float]:
    """Return cup and compliance in series with the mesh by the names of their results; elasticity acts on both."""
    shear = drive.modulus_factor * drive.flexspline.youngs_modulus / (2.0 * (1.0 + drive.flexspline.poisson_ratio))
    moment = 2.0 * np.pi * drive.cup_radius**3 * drive.cup_wall
    compliance = drive.drive_compliance / drive.modulus_factor + drive.cup_length / (shear * moment)
    length = np.asarray(drive.cup_length)
    cup = np.where(length > 0.0, shear * moment / np.where(length > 0.0, length, 1.0), 0.0)
    return {"shear_modulus": shear, "cup_moment": moment, "cup_stiffness": cup, "series_compliance": compliance}


def ball_torsion(drive: Drive) -> Float:
    """Return the torsion at wave_torque by the balls of the wave generator between their races, rad; 0 without any.

    The teeth press the flexspline inwards with T tan(alpha)/r_p, onto the balls under both engaged arcs, with shares by
    the square of the cosine. A ball and its races close by c Q^(2/3); by Castigliano the drive turns by the sum of
    c Q^(5/3) over T. Cam and rings are rigid between balls. Left out is preload, which makes a bearing stiffer.
    """
    steel = 0.5 * drive.modulus_factor * drive.flexspline.youngs_modulus / (1.0 - drive.flexspline.poisson_ratio**2)
    loaded = np.maximum(drive.balls, 1.0) * drive.engaged_pairs / drive.flexspline_teeth
    closing = CLOSING * np.power(drive.wave_torque / (steel * loaded), 2.0 / 3.0)
    lever = np.power(np.tan(drive.pressure_angle) / drive.pitch_radius, 5.0 / 3.0)
    return np.where(np.asarray(drive.balls) > 0.0, closing * lever / np.cbrt(drive.ball_diameter), 0.0)


def wave_scale(drive: Drive) -> Float:
    """Return the torsion of the wave generator over torque^(2/3), rad/(N m)^(2/3): what is stated, and its balls.

    Hertz: contacts close as load^(2/3) and as modulus^(-2/3).
    """
    whole = drive.wave_torsion_stated * drive.modulus_factor ** (-2.0 / 3.0) + ball_torsion(drive)
    value: Float = whole / np.power(drive.wave_torque, 2.0 / 3.0)
    return value


def wave_torsion(drive: Drive, torque: Float) -> Float:
    """Return the torsion, rad, of the wave generator from the reference to a size of torque."""
    beyond = np.maximum(np.abs(torque), drive.reference_torque)
    value: Float = wave_scale(drive) * (np.power(beyond, 2.0 / 3.0) - np.power(drive.reference_torque, 2.0 / 3.0))
    return value


def wave_compliance(drive: Drive) -> Float:
    """Return the slope of that torsion at the torque, rad/(N m), from torque 0 on as if it had no reference; 0 at 0."""
    size = np.abs(np.asarray(drive.torque, dtype=float))
    slope = 2.0 / 3.0 * wave_scale(drive) * np.where(size > 0.0, size, 1.0) ** (-1.0 / 3.0)
    return np.where(size > 0.0, slope, 0.0)


def over(value: Float, whole: Float) -> Float:
    """Return a value in parts of a whole; 0 where that is 0."""
    return np.where(np.asarray(whole) == 0.0, 0.0, value / np.where(np.asarray(whole) == 0.0, 1.0, whole))


def _seen(drive: Drive, rough: rough_contact.Rough) -> Float:
    """Return the structure function over the lags, as an instrument that averages over a spot sees it."""
    lags, dimension = np.asarray(drive.lags), column(rough.dimension) - 1.0
    seen = structure_function(lags, dimension, column(rough.roughness))
    if not np.any(drive.spot_width):
        return seen
    return seen * kept_share(lags, column(drive.spot_width), 4.0 - 2.0 * dimension)


def _contact(drive: Drive, contact: rough_contact.Contact) -> dict[str, Any]:
    """Return what does not depend on the load by the names of its results."""
    return {
        "equivalent_modulus": contact.modulus,
        "critical_pressure": rough_contact.critical_pressure(drive),
        "domain_factor": contact.domain_factor,
        "critical_area": contact.critical_area,
        "resolved_share": np.sqrt(contact.critical_area / np.pi) / rough_contact.spacing_of(drive),
        "plastic_limit": contact.plastic_limit,
        "tip_factor": contact.tip_factor,
    }


def _pair(drive: Drive, contact: rough_contact.Contact, pair: rough_contact.Pressed) -> dict[str, Any]:
    """Return one pair under its load by the names of its results."""
    plastic = np.exp(contact.law.growth * pair.size) * contact.plastic_limit / drive.pair_load
    return {
        **{name: value for name, value in vars(pair).items() if name != "size"},
        "area_ratio": np.exp(pair.size),
        "elastic_sum": elastic_sum(pair.size, contact.law),
        "plastic_share": np.where(pair.size > 0.0, plastic, 1.0),
        "flank_share": pair.real_area / (drive.face_width * drive.flank_height),
    }


def _clearance(
    drive: Drive, contact: rough_contact.Contact, mesh: DriveMesh, pair: rough_contact.Pressed
) -> dict[str, Any]:
    """Return the clearance of one pair by the names of its results."""
    largest = np.sqrt(pair.largest_area / np.pi)
    radius, multiple = rough_contact.read_radius(drive, largest)
    first, second = rough_contact.heights(drive)
    reference = load_of_largest(drive.reference_torque, mesh)
    approach = rough_contact.approach(drive.pair_load, reference, contact)
    left = np.maximum((first + second) / 2.0 - approach, 0.0)
    return {
        "largest_radius": largest,
        "clearance_radius": radius,
        "clearance_multiple": multiple,
        "clearance": multiple * rough_contact.amplitude(radius, contact, drive.density),
        "rough_height": first,
        "mating_rough_height": second,
        "open_clearance": (first + second) / 2.0,
        "reference_load": reference,
        "approach": approach,
        "closing_clearance": left,
        "free_play": 2.0 * left / mesh.radius,
    }


def _mesh(drive: Drive, contact: rough_contact.Contact, mesh: DriveMesh) -> dict[str, Any]:
    """Return mesh and drive by the names of their results; torsions have the sense of the torque."""
    around, printed, sense = around_of(drive), require_catalogue(drive), np.sign(drive.torque)
    compliance = around["series_compliance"]
    whole, rough = (sense * size for size in mesh_torsion(drive.torque, drive.reference_torque, mesh))
    more = mesh.engagement.factor(drive.torque)
    normal = normal_stiffness(drive.torque, mesh)
    stiffness, in_catalogue = normal * mesh.radius**2, printed.torsion(drive.torque)
    beyond = np.maximum(np.abs(drive.torque) - drive.reference_torque, 0.0)
    wave, wave_slope = sense * wave_torsion(drive, drive.torque), wave_compliance(drive)
    torsion = whole + sense * compliance * beyond + wave
    return {
        "effective_radius": mesh.radius,
        "pairs_factor": more,
        "largest_share": mesh.arcs.shares[0] / more,
        "largest_pair_force": load_of_largest(drive.torque, mesh),
        "plastic_torque": mesh.plastic_torque,
        "line_stiffness": line_stiffness(drive, contact),
        "normal_stiffness": normal,
        "mesh_stiffness": stiffness,
        "mesh_torsion": whole,
        **around,
        "ball_torsion": ball_torsion(drive),
        "wave_torsion": wave,
        "wave_compliance": wave_slope,
        "torsional_stiffness": stiffness / (1.0 + (compliance + wave_slope) * stiffness),
        "torsion": torsion,
        "rough_torsion": rough,
        "catalogue_torsion": in_catalogue,
        "catalogue_stiffness": printed.stiffness(drive.torque),
        "catalogue_ratio": over(torsion, in_catalogue),
        "rough_share": over(rough, in_catalogue),
    }
