"""A study of our own: the made flank as a data file, which a run of harmonic_fractal reads like a measured one."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from harmonic_fractal.made_calculation import surface_of, truth_of
from harmonic_fractal.made_quantities import Made
from harmonic_fractal.surface import Surface
from truing import Bench, TruingError, Words

if TYPE_CHECKING:
    from truing import Block, Check

SCALES = {"m": 1.0, "mm": 1e3, "um": 1e6, "nm": 1e9}


@dataclass(frozen=True, kw_only=True)
class FlankFile:
    """Write the flank into the run folder as ``file``: a matrix of heights, one line a row, in ``height_unit``."""

    file: str = "flank.csv"
    height_unit: str = "um"
    name: str = "flank_file"
    gives: Callable[[Any], Any] | None = None

    def __post_init__(self) -> None:
        if self.height_unit not in SCALES:
            raise TruingError(f"study '{self.name}': height_unit = '{self.height_unit}', but it is m, mm, um or nm")
        if not self.file.endswith(".csv"):
            raise TruingError(f"study '{self.name}': file = '{self.file}', but a file of heights ends in .csv")

    def run(self, bench: Bench) -> "Written":
        """Make the flank once more, as the effects that are on leave its inputs, and write it down."""
        made: Made = bench.inputs
        surface, truth = surface_of(made), truth_of(made)
        words = (
            f"made flank, {made.kind}, seed {made.seed}: fractal dimension of the surface "
            f"{made.fractal_dimension:.10g}, fractal roughness {truth.areal:.10g} m in the areal convention"
        )
        return Written(surface, self.file, flank_text(surface, words, self.height_unit))


def flank_text(surface: Surface, words: str, height_unit: str = "um") -> str:
    """Return a surface as text: what it is, spacings and unit behind #, then its heights, one line a row.

    Numbers come back exactly; a point that was not measured is nan.
    """
    lengths = {"spacing_x": surface.spacing_x, "spacing_y": surface.spacing_y}
    head = [f"# {words}"]
    head += [f"# {name} = {_exact(length, 1e6)} um" for name, length in lengths.items() if np.isfinite(length)]
    head.append(f"# height_unit = {height_unit}")
    rows = (surface.heights * SCALES[height_unit]).tolist()
    return "\n".join([*head, *(",".join(repr(each) for each in row) for row in rows)]) + "\n"


def _exact(value: float, scale: float) -> str:
    """Return a number in a larger scale by as few digits as bring it back."""
    short = f"{value * scale:.12g}"
    return short if float(short) / scale == value else repr(value * scale)


@dataclass(frozen=True, eq=False)
class Written:
    """The flank that was written, and its file."""

    surface: Surface
    file: str
    text: str

    @property
    def files(self) -> Mapping[str, str | bytes]:
        """The file by its name, for the run folder."""
        return {self.file: self.text}

    def as_json(self) -> Mapping[str, Any]:
        """Return the name of the file and the size of its matrix."""
        lines, points = self.surface.heights.shape
        missing = int(np.isnan(self.surface.heights).sum())
        return {"file": self.file, "lines": lines, "points": points, "missing": missing}

    def blocks(self) -> "Sequence[Block]":
        """Say what the file holds and how it is read."""
        lines, points = self.surface.heights.shape
        return [
            Words(
                f"The run folder holds {self.file}: {lines} lines of {points} points, with spacing and unit in its "
                "head. An inputs file of harmonic_fractal reads it, from its own folder on, by "
                f'surface = {{ file = "{self.file}" }}.'
            )
        ]

    def checks(self) -> "Sequence[Check]":
        """Return nothing: a file keeps no limit."""
        return ()

    def warnings(self) -> Sequence[str]:
        """Return nothing."""
        return ()
