"""A study of our own: the paper's Figs. 1 and 2, forces and early wear of differently ground discs."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rv_wear.calculation import rv_wear
from rv_wear.curves import Flank, flank
from rv_wear.quantities import Reducer
from truing import Bench, Block, Check, Float, Table, TruingError, found, results

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
class Ground:
    """Discs by their equidistant modification (n,) in m: largest force in N, deepest wear in m, flanks new and worn."""

    hours: float
    modifications: "NDArray[np.float64]"
    new: Flank
    worn: Flank
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

    def checks(self) -> "Sequence[Check]":
        """Return nothing: a comparison decides no limit."""
        return ()

    def warnings(self) -> Sequence[str]:
        """Return nothing."""
        return ()


def trend(ground: Ground) -> Trend:
    """How many of the steps go the way the paper says."""
    return Trend(
        force_falls=float(np.mean(np.diff(ground.force) < 0.0)),
        mesh_widens=float(np.mean(np.diff(ground.loaded) >= 0.0)),
        wear_falls=float(np.mean(np.diff(ground.wear) < 0.0)),
    )
