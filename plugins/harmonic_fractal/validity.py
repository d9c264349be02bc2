"""A study of our own: what was measured badly, refused, or carried beyond what the laws were made for."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from harmonic_fractal.flank import Flank
from harmonic_fractal.quantities import Drive
from truing import Bench, Block, Check

RESOLVED = 0.3  # radius of the critical area over the sampling interval
PLASTIC = 0.5  # share of the load on plastic contacts
BODIES = {"surface": "fractal_dimension and fractal_roughness", "mating_surface": "mating_dimension, if it is stated"}


@dataclass(frozen=True, kw_only=True)
class Validity:
    """Collect what its reader must know of every measured flank and of the contact that follows."""

    name: str = "validity"
    gives: Callable[[Any], Any] | None = None

    def run(self, bench: "Bench") -> "Valid":
        """Look at the flanks and at the answers."""
        drive: Drive = bench.inputs
        beyond = [*_of_flanks(drive), *_of_contact(bench.answers)]
        return Valid(name=self.name, inputs=drive, beyond=tuple(beyond))


def _of_flanks(drive: Drive) -> Iterator[str]:
    for name, stated in BODIES.items():
        flank: Flank | None = getattr(drive, name)
        if flank is None:
            continue
        if flank.used is None:
            yield f"{name} is refused, the contact is that of {stated}: {flank.reason}"
        elif flank.surface.is_profile:
            yield f"{name} is one profile: that it looks the same in all directions is assumed"
        elif flank.chosen != "both" and not any("direction" in sentence for sentence in flank.warnings):
            yield f"{name} is taken along {flank.chosen} only"
        yield from (f"{name}: {sentence}" for sentence in flank.warnings)


def _of_contact(answers: Any) -> Iterator[str]:
    share, stiffness = float(answers["resolved_share"]), float(answers["stiffness"])
    if share < RESOLVED:
        yield (
            f"extrapolated below resolution: the stiffness hangs on contacts of {share:.2g} sampling intervals radius, "
            f"less than {RESOLVED:g}"
        )
    if stiffness == 0.0:
        yield "all contacts of the pair are plastic at pair_load, and the model gives it no stiffness"
    elif float(answers["plastic_share"]) > PLASTIC:
        yield (
            f"{float(answers['plastic_share']):.0%} of the load is on plastic contacts, to which the model gives no "
            "stiffness"
        )


@dataclass(frozen=True, kw_only=True)
class Valid:
    """What was found; ``inputs`` are those of the run, as effects leave them."""

    name: str
    inputs: Drive
    beyond: tuple[str, ...]

    def as_json(self) -> dict[str, Any]:
        """Return every flank with what each direction says, and what is beyond its range."""
        flanks = {name: _flank_json(flank) for name in BODIES if (flank := getattr(self.inputs, name)) is not None}
        return {"flanks": flanks, "beyond": list(self.beyond)}

    def blocks(self) -> Sequence[Block]:
        """Return nothing: the sections say it where it belongs."""
        return ()

    def checks(self) -> "Sequence[Check]":
        """Return nothing: a refused surface fails the check of surface_accepted."""
        return ()

    def warnings(self) -> Sequence[str]:
        """Return what is beyond its range."""
        return [f"study '{self.name}': {text}" for text in self.beyond]


def _flank_json(flank: "Flank") -> dict[str, Any]:
    return {
        "file": flank.surface.name,
        "chosen": flank.chosen,
        "reason": flank.reason,
        "missing": flank.missing,
        "spikes": flank.spiked,
        "sq": {"unit": "um", "raw": flank.sq_raw * 1e6, "plane": flank.sq_plane * 1e6,
               "second_order": flank.sq_second_order * 1e6},
        "directions": {found.direction: _estimate_json(found) for found in flank.estimates},
    }  # fmt: skip


def _estimate_json(found: Any) -> dict[str, Any]:
    def known(values: Any, factor: float = 1.0) -> Any:
        return [float(value) * factor if value == value else None for value in values]

    dimension, roughness, r_squared = known((found.dimension, found.roughness, found.r_squared))
    window, with_noise, share = known((found.window_dimension, found.noise_dimension, found.noise_share))
    return {
        "accepted": found.is_accepted,
        "reason": found.reason,
        "profile_dimension": dimension,
        "roughness": {"value": roughness, "unit": "m", "convention": "areal"},
        "r_squared": r_squared,
        "for_comparison": {"roughness_length": window, "with_noise": with_noise, "noise_share": share},
        "range": {"unit": "um", "values": known(found.range, 1e6)},
        "lags": {"unit": "um", "values": known(found.lags, 1e6)},
        "structure_function": {"unit": "um^2", "values": known(found.values, 1e12)},
        "local_lags": {"unit": "um", "values": known(found.local_lags, 1e6)},
        "local_dimensions": known(found.local_dimensions),
    }
