"""Curves over phase and time for figures, differently ground discs, and where modifications may lie."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rv_wear import geometry
from rv_wear.calculation import rv_wear
from rv_wear.forces import Loads, holding, refuse, shared, start_scale
from rv_wear.geometry import Mesh, Teeth, many, mesh_of, teeth_of
from rv_wear.quantities import Reducer
from rv_wear.wear import exposure_of, oil_part, unworn, wear_at
from truing import Array, Bench, Block, Float, Outcome, Table, TruingError, found, results

# Curves for figures and tests: plain numpy out of one reducer or of many, every Float a number or an array (n,); SI
#
# Curves over the phase angle have the shape (n, k), those over the time (n, t); n is 1 for one reducer.

CLOSE = 1e-13  # m
ROUNDS = 100


@dataclass(frozen=True)
class DiscFlank:
    """The loaded side of the disc over the phase angle (k,): clearance with wear, wear, and pin forces, each (n, k)."""

    angle: Array
    clearance: Array
    wear: Array
    force: Array


def flank(reducer: Reducer, time: float = 0.0) -> DiscFlank:
    """Clearance, wear and forces at every contact of the loaded side after a time (s), 0: new.

    The wear is that of the law alone, without ``depth_factor`` and ``extra_wear``. Raises InfeasibleError.
    """
    teeth, loads, wear = worn_mesh(reducer, time)
    mesh = teeth.mesh
    clearance = np.asarray(geometry.clearance(mesh, teeth.angle)) + wear
    return DiscFlank(teeth.angle.reshape(-1), _rows(clearance), _rows(wear), _rows(loads.force))


def worn_mesh(reducer: Reducer, time: float = 0.0) -> tuple[Teeth, Loads, Array]:
    """Contacts, loads and wear (pins, phases, n) after a time (s)."""
    teeth = teeth_of(_feasible(mesh_of(reducer)))
    exposure = np.broadcast_to(np.asarray(exposure_of(reducer, oil_part(reducer), time)), (teeth.count,))
    wear = wear_at(teeth, exposure) if time > 0.0 else np.zeros_like(teeth.slack)
    return teeth, shared(teeth, teeth.slack + wear / teeth.relative_arm, start_scale(teeth)), wear


def clearance_over_angle(reducer: Reducer, angle: ArrayLike) -> Array:
    """Normal clearance (n, k) of the new disc at phase angles (k,) from 0 to pi."""
    mesh = many(mesh_of(reducer))
    return np.asarray(geometry.clearance(mesh, np.asarray(angle, dtype=float)[:, None])).T


def lowest_by_approach(reducer: Reducer) -> Array:
    """The equidistant modification (n,) whose largest clearance is its own approach, at the radial clearance given.

    Another reading of the lost condition in equation 17: pins there never bear. Tried again until it stays.
    """
    mesh = _feasible(mesh_of(reducer))
    radial, trial = mesh.radial_clearance, np.asarray(mesh.equidistant)
    for _ in range(ROUNDS):
        tried = replace(mesh, equidistant=trial, shift=trial - radial)
        found = np.asarray(geometry.lowest_equidistant(mesh, unworn(tried).approach))
        if np.all(np.abs(found - trial) <= CLOSE):
            break
        trial = found
    return found


def _rows(values: Array) -> Array:
    return np.ascontiguousarray(values.reshape(-1, values.shape[-1]).T)


def _feasible(mesh: Mesh) -> Mesh:
    mesh = many(mesh)
    good, broken = holding(mesh)
    refuse(broken, None if len(good) == 1 else np.arange(len(good)))
    return mesh


# A study of our own: the paper's Figs. 1 and 2, forces and early wear of differently ground discs

HOUR = 3600.0
MOST = 100
STEPS = "share of the steps from one modification to the next larger one; 1: all of them"


@results
class Trend:
    """What a larger equidistant modification does at the same radial clearance."""

    force_falls: Float = found("", symbol="n_F", note="the largest force falls with the modification", method=STEPS)
    mesh_widens: Float = found("", symbol="n_p", note="the loaded part of the flank does not shrink", method=STEPS)
    wear_falls: Float = found("", symbol="n_h", note="the deepest wear falls with the modification", method=STEPS)


@dataclass(frozen=True, kw_only=True)
class Modifications:
    """Forces and wear after ``hours`` of discs ground over the whole range of equation 17, in ``points`` steps."""

    points: int = 6
    hours: float = 100.0
    name: str = "modifications"
    gives: Callable[[Any], Any] | None = None

    def __post_init__(self) -> None:
        if not 2 <= self.points <= MOST:
            raise TruingError(f"study '{self.name}': points = {self.points}, but 2 to {MOST} can be compared")
        if not self.hours > 0:
            raise TruingError(f"study '{self.name}': hours = {self.hours:g} must lie above 0")

    def run(self, bench: "Bench") -> "Ground":
        """Calculate all of them at the radial clearance of the inputs."""
        reducer: Reducer = replace(bench.inputs, working_time=self.hours * HOUR)
        clearance = reducer.equidistant_modification - reducer.shift_modification
        low, high = float(bench.answers["equidistant_low"]), float(bench.answers["equidistant_high"])
        modifications = np.linspace(low, high, self.points)
        discs = replace(reducer, equidistant_modification=modifications, shift_modification=modifications - clearance)
        answers = rv_wear(discs)
        return Ground(
            hours=self.hours,
            modifications=modifications,
            new=flank(discs),
            worn=flank(discs, self.hours * HOUR),
            force=np.asarray(answers.largest_force),
            wear=np.asarray(answers.max_wear),
        )


@dataclass(frozen=True, kw_only=True)
class Ground(Outcome):
    """Discs by their equidistant modification (n,) in m: largest force in N, deepest wear in m, flanks new and worn."""

    hours: float
    modifications: "NDArray[np.float64]"
    new: DiscFlank
    worn: DiscFlank
    force: "NDArray[np.float64]"
    wear: "NDArray[np.float64]"

    @property
    def loaded(self) -> "NDArray[np.float64]":
        """The share of all contacts that carry, (n,)."""
        return np.asarray(np.mean(self.new.force > 0.0, axis=-1))

    def as_json(self) -> Mapping[str, Any]:
        """Return modification, force, loaded share and wear of every disc."""
        return {
            "hours": self.hours,
            "equidistant_modification": {"unit": "um", "values": (self.modifications * 1e6).tolist()},
            "largest_force": {"unit": "N", "values": self.force.tolist()},
            "loaded": self.loaded.tolist(),
            "max_wear": {"unit": "um", "values": (self.wear * 1e6).tolist()},
        }

    def blocks(self) -> Sequence[Block]:
        """Return the discs as a table."""
        columns = zip(self.modifications * 1e6, self.force, 100 * self.loaded, self.wear * 1e6, strict=True)
        return [
            Table(
                "Discs ground in different ways",
                ("equidistant modification", "largest force", "loaded part of the flank", "deepest wear"),
                [tuple(float(value) for value in row) for row in columns],
                ("µm", "N", "%", "µm"),
                f"At the same radial clearance, new; wear after {self.hours:g} h.",
            )
        ]


def trend(ground: Ground) -> Trend:
    """How many of the steps go the way the paper says."""
    return Trend(
        force_falls=float(np.mean(np.diff(ground.force) < 0.0)),
        mesh_widens=float(np.mean(np.diff(ground.loaded) >= 0.0)),
        wear_falls=float(np.mean(np.diff(ground.wear) < 0.0)),
    )


# A study of our own: where the modifications may lie, and what was stated beyond what the laws were made for

FEWEST_PINS = 2
VISCOSITY = (5e-9, 5e-8)  # 1/Pa
ROUGHNESS = (0.05e-6, 5e-6)  # m
FITTED = "the regression of the wear coefficient was fitted to steel rollers in oil"


@dataclass(frozen=True, kw_only=True)
class DiscValidity:
    """Find the range of the equidistant modification, and warn of inputs outside of the range of the laws."""

    name: str = "validity"
    gives: Callable[[Any], Any] | None = None

    def run(self, bench: "Bench") -> "DiscValid":
        """Compare the inputs, as effects leave them, with the ranges."""
        reducer: Reducer = bench.inputs
        lowest, highest = (float(bench.answers[name]) for name in ("equidistant_low", "equidistant_high"))
        return DiscValid(
            name=self.name,
            equidistant=float(reducer.equidistant_modification),
            highest=highest,
            lowest=lowest,
            lowest_by_approach=float(lowest_by_approach(reducer)[0]),
            beyond=tuple(_beyond(reducer, lowest, float(bench.answers["loaded_pins"]))),
        )


def _beyond(reducer: Reducer, lowest: float, pins: float) -> Iterator[str]:
    """Say what lies outside."""
    viscosity, roughness = float(reducer.pressure_viscosity), float(reducer.composite_roughness)
    if not VISCOSITY[0] <= viscosity <= VISCOSITY[1]:
        yield f"pressure_viscosity is {viscosity:.3g} 1/Pa, outside of 5e-9 to 5e-8 1/Pa; {FITTED}"
    if not ROUGHNESS[0] <= roughness <= ROUGHNESS[1]:
        yield f"composite_roughness is {roughness * 1e6:.3g} um, outside of 0.05 to 5 um; {FITTED}"
    equidistant = float(reducer.equidistant_modification)
    if equidistant < lowest:
        yield (
            f"equidistant_modification is {equidistant * 1e6:.4g} um, below the {lowest * 1e6:.4g} um of equation 17: "
            "clearances are wide and few pins carry"
        )
    if pins < FEWEST_PINS:
        yield (
            f"at most {pins:.0f} pin carries; output_torque is too small for this clearance, and the sharing of forces "
            "among pins does not hold"
        )


@dataclass(frozen=True, kw_only=True)
class DiscValid(Outcome):
    """The equidistant modification and the ends of its range (m), and what was found outside of its own range."""

    name: str
    equidistant: float
    highest: float
    lowest: float
    lowest_by_approach: float
    beyond: tuple[str, ...]

    def as_json(self) -> dict[str, Any]:
        """Return the range and what is beyond its own."""
        return {
            "equidistant_modification": {
                "value": self.equidistant * 1e6,
                "highest": self.highest * 1e6,
                "lowest": self.lowest * 1e6,
                "lowest_by_approach": self.lowest_by_approach * 1e6,
                "unit": "um",
            },
            "beyond": list(self.beyond),
        }

    def blocks(self) -> Sequence[Block]:
        """Return the range with both readings of its lower end."""
        rows = (
            ("highest: the disc does not interfere with a pin", self.highest * 1e6),
            ("as it is", self.equidistant * 1e6),
            ("lowest: no clearance above twice the radial one", self.lowest * 1e6),
            ("lowest, other reading: no clearance above the approach under load", self.lowest_by_approach * 1e6),
        )
        note = "Equation 17 at this radial clearance. The paper prints -53 to 11 µm; its lower condition is lost."
        return [Table("Equidistant modification", ("", "modification"), rows, ("", "µm"), note)]

    def warnings(self) -> Sequence[str]:
        """Return what is beyond its range."""
        return [f"study '{self.name}': {text}" for text in self.beyond]
