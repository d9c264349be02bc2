"""A study of our own: the made flank as a data file, which a run of harmonic_fractal reads like a measured one."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from harmonic_fractal.made_calculation import surface_of
from harmonic_fractal.made_quantities import Made
from harmonic_fractal.made_truth import truth_of
from harmonic_fractal.surface import Surface
from truing import Bench, Block, Check, TruingError, Words

PLAIN = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,95}\.csv", re.ASCII)
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
            raise TruingError(f"height_unit = '{self.height_unit}', but it is m, mm, um or nm")
        if not PLAIN.fullmatch(self.file):
            raise TruingError(
                f"file = '{self.file}', but it is a plain name that ends in .csv, of letters, digits, _, - and ., at "
                "most 100 of them; it stands in the run folder"
            )

    def run(self, bench: Bench) -> "Written":
        """Make the flank once more, as the effects that are on leave its inputs, and write it down."""
        made: Made = bench.inputs
        surface, truth = surface_of(made), truth_of(made)
        words = (
            f"made flank, {made.kind}, seed {made.seed}: fractal dimension of the surface "
            f"{made.fractal_dimension:.10g}, fractal roughness {truth.areal:.10g} m in the areal convention"
        )
        text = flank_text(surface, words, self.height_unit, cutoff=float(made.filter_cutoff))
        return Written(surface, self.file, text)


def flank_text(surface: Surface, words: str, height_unit: str = "um", *, cutoff: float = 0.0) -> str:
    """Return a surface as text: what it is, spacings, lateral filter and unit behind #, then its heights, a line a row.

    Numbers come back exactly; a point that was not measured is nan.
    """
    lengths = {"spacing_x": surface.spacing_x, "spacing_y": surface.spacing_y, "filter_width": cutoff}
    head = [f"# {words}"]
    head += [f"# {name} = {_exact(length, 1e6)} um" for name, length in lengths.items() if length > 0.0]
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
        counted = "one line" if lines == 1 else f"{lines} lines"
        return [
            Words(
                f"The run folder holds {self.file}: {counted} of {points} points, with spacing and unit in its "
                "head. An inputs file of harmonic_fractal in that folder reads it by "
                f'surface = {{ file = "{self.file}", form = "none" }}: a made flank has no form to be taken away, and '
                "taking one raises the dimension that is found."
            )
        ]

    def checks(self) -> "Sequence[Check]":
        """Return nothing: a file keeps no limit."""
        return ()

    def warnings(self) -> Sequence[str]:
        """Return nothing."""
        return ()
