"""From rough flanks to the stiffness of one pair, of the mesh and of the drive."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from harmonic_fractal import clearance as gap
from harmonic_fractal.answers import Stiffness
from harmonic_fractal.blunt import kept_share
from harmonic_fractal.contact import Contact, Pressed, contact_of, critical_pressure, pressed
from harmonic_fractal.feasibility import require_catalogue, require_contact, require_flank, require_surface
from harmonic_fractal.interface import Rough, interface_of, is_accepted, spacing_of
from harmonic_fractal.mesh import Mesh, line_stiffness, load_of_largest, mesh_of, normal_stiffness
from harmonic_fractal.micro import elastic_sum
from harmonic_fractal.power_law import structure_function
from harmonic_fractal.quantities import Drive
from harmonic_fractal.torsion import mesh_torsion
from truing import Float, column


@dataclass(frozen=True)
class Around:
    """What is in series with the mesh."""

    shear_modulus: Float
    moment: Float
    compliance: Float


def harmonic_fractal(drive: Drive) -> Stiffness:
    """One drive or a batch of them; every Float is a number or an array (n,), SI."""
    rough = interface_of(drive)
    require_surface(drive, rough)
    contact = contact_of(drive, rough)
    mesh = mesh_of(drive, contact)
    require_contact(drive, contact, mesh)
    pair = pressed(drive.pair_load, contact)
    require_flank(drive, pair, pressed(load_of_largest(drive.torque, mesh), contact))
    return Stiffness(
        lag=drive.lags,
        structure_function=_seen(drive, rough),
        **_interface(drive, rough),
        **_contact(drive, contact),
        **_pair(drive, contact, pair),
        **_clearance(drive, contact, mesh, pair),
        **_mesh(drive, contact, mesh),
    )


def around_of(drive: Drive) -> Around:
    """Return cup and compliance in series with the mesh; elasticity acts on both."""
    shear = drive.modulus_factor * drive.flexspline.youngs_modulus / (2.0 * (1.0 + drive.flexspline.poisson_ratio))
    moment = 2.0 * np.pi * drive.cup_radius**3 * drive.cup_wall
    compliance = drive.drive_compliance / drive.modulus_factor + drive.cup_length / (shear * moment)
    return Around(shear, moment, compliance)


def _seen(drive: Drive, rough: Rough) -> Float:
    """Return the structure function over the lags, as an instrument that averages over a spot sees it."""
    lags, dimension = np.asarray(drive.lags), column(rough.dimension) - 1.0
    seen = structure_function(lags, dimension, column(rough.roughness))
    return (
        seen * kept_share(lags, column(drive.spot_width), 4.0 - 2.0 * dimension) if np.any(drive.spot_width) else seen
    )


def _interface(drive: Drive, rough: Rough) -> dict[str, Any]:
    return {
        "surface_accepted": is_accepted(drive),
        "spacing": spacing_of(drive),
        "dimension": rough.dimension,
        "profile_dimension": rough.dimension - 1.0,
        "roughness": rough.roughness,
    }


def _contact(drive: Drive, contact: Contact) -> dict[str, Any]:
    """Return what does not depend on the load by the names of its results."""
    return {
        "equivalent_modulus": contact.modulus,
        "critical_pressure": critical_pressure(drive),
        "domain_factor": contact.domain_factor,
        "critical_area": contact.critical_area,
        "resolved_share": np.sqrt(contact.critical_area / np.pi) / spacing_of(drive),
        "plastic_limit": contact.plastic_limit,
        "tip_factor": contact.tip_factor,
    }


def _pair(drive: Drive, contact: Contact, pair: Pressed) -> dict[str, Any]:
    """Return one pair under its load by the names of its results."""
    plastic = np.exp(contact.law.growth * pair.size) * contact.plastic_limit / drive.pair_load
    return {
        "largest_area": pair.largest_area,
        "area_ratio": np.exp(pair.size),
        "elastic_sum": elastic_sum(pair.size, contact.law),
        "plastic_share": np.where(pair.size > 0.0, plastic, 1.0),
        "contact_area": pair.contact_area,
        "real_area": pair.real_area,
        "flank_share": pair.real_area / (drive.face_width * drive.flank_height),
        "stiffness": pair.stiffness,
        "load_exponent": pair.load_exponent,
    }


def _clearance(drive: Drive, contact: Contact, mesh: Mesh, pair: Pressed) -> dict[str, Any]:
    """Return the clearance of one pair by the names of its results."""
    largest = np.sqrt(pair.largest_area / np.pi)
    radius, multiple = gap.read_radius(drive, largest)
    first, second = gap.heights(drive)
    reference = load_of_largest(drive.reference_torque, mesh)
    approach = gap.approach(drive.pair_load, reference, contact)
    left = np.maximum((first + second) / 2.0 - approach, 0.0)
    return {
        "largest_radius": largest,
        "clearance_radius": radius,
        "clearance_multiple": multiple,
        "clearance": multiple * gap.amplitude(radius, contact, drive.density),
        "rough_height": first,
        "mating_rough_height": second,
        "open_clearance": (first + second) / 2.0,
        "reference_load": reference,
        "approach": approach,
        "closing_clearance": left,
        "free_play": 2.0 * left / mesh.radius,
    }


def _mesh(drive: Drive, contact: Contact, mesh: Mesh) -> dict[str, Any]:
    """Return mesh and drive by the names of their results; torsions have the sense of the torque."""
    around, printed, sense = around_of(drive), require_catalogue(drive), np.sign(drive.torque)
    whole, rough = (sense * size for size in mesh_torsion(drive.torque, drive.reference_torque, mesh))
    more = mesh.engagement.factor(drive.torque)
    normal = normal_stiffness(drive.torque, mesh)
    stiffness, in_catalogue = normal * mesh.radius**2, printed.torsion(drive.torque)
    beyond = np.maximum(np.abs(drive.torque) - drive.reference_torque, 0.0)
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
        "shear_modulus": around.shear_modulus,
        "cup_moment": around.moment,
        "cup_stiffness": _stiffness_of_cup(drive, around),
        "series_compliance": around.compliance,
        "torsional_stiffness": stiffness / (1.0 + around.compliance * stiffness),
        "torsion": whole + sense * around.compliance * beyond,
        "rough_torsion": rough,
        "catalogue_torsion": in_catalogue,
        "catalogue_stiffness": printed.stiffness(drive.torque),
        "rough_share": np.where(in_catalogue == 0.0, 0.0, rough / np.where(in_catalogue == 0.0, 1.0, in_catalogue)),
    }


def _stiffness_of_cup(drive: Drive, around: Around) -> Float:
    length = np.asarray(drive.cup_length)
    return np.where(length > 0.0, around.shear_modulus * around.moment / np.where(length > 0.0, length, 1.0), 0.0)
