"""A study of our own: where the modifications may lie, and what was stated beyond what the laws were made for."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from rv_wear.curves import allowed_equidistant
from rv_wear.quantities import Reducer
from truing import Bench, Block, Check, Table

FEWEST_PINS = 2
VISCOSITY = (5e-9, 5e-8)  # 1/Pa
ROUGHNESS = (0.05e-6, 5e-6)  # m
FITTED = "the regression of the wear coefficient was fitted to steel rollers in oil"


@dataclass(frozen=True, kw_only=True)
class Validity:
    """Find the range of the equidistant modification, and warn of inputs outside of the range of the laws."""

    name: str = "validity"
    gives: Callable[[Any], Any] | None = None

    def run(self, bench: "Bench") -> "Valid":
        """Compare the inputs, as effects leave them, with the ranges."""
        reducer: Reducer = bench.inputs
        lowest, highest = (float(bench.answers[name]) for name in ("equidistant_low", "equidistant_high"))
        by_approach, _ = allowed_equidistant(reducer, "approach")
        return Valid(
            name=self.name,
            equidistant=float(reducer.equidistant_modification),
            highest=highest,
            lowest=lowest,
            lowest_by_approach=float(by_approach[0]),
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
class Valid:
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

    def checks(self) -> "Sequence[Check]":
        """Return nothing: a range decides no limit."""
        return ()

    def warnings(self) -> Sequence[str]:
        """Return what is beyond its range."""
        return [f"study '{self.name}': {text}" for text in self.beyond]
