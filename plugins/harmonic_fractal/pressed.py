"""A measured flank pressed against a smooth one, or two against one another, numerically: the check of K and b.

Elastic half-spaces, boundary elements by fast Fourier transform (ContactMechanics, an extra: no own solver). The patch
counts as one period of an endless flank, so that neither its own nor the bulk's deformation as a whole counts: what is
pressed together is the roughness. No fractal model is in it, and no plasticity: ``hard_share`` says how much of the
contact carries more than the hardness. Source of the method: Stanley and Kato 1997; Polonsky and Keer 1999.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from gear_geometry.drawing import signed
from harmonic_fractal.contact import approach, contact_of, equivalent_modulus, interface_of, pressed
from harmonic_fractal.quantities import Drive
from truing import Array, Bench, Block, Outcome, Table, TruingError, Words

MISSING = "ContactMechanics is not installed, and nothing is pressed numerically: pip install 'truing[contact]'"
NO_FLANK = "No flank was measured as a patch, so there is nothing to press numerically."
LEAST, MOST = 1e-3, 0.1
"""Mean pressures, in parts of that which flattens the patch: modulus times root mean square slope."""
CLOSE = 1e-10
"""Penetration that is left, in m: a tenth of a nanometre is far below the heights."""


@dataclass(frozen=True, eq=False)
class Pressing:
    """What the numbers say, each (n,): loads N; mean gap m; shares of the patch in contact, and of that beyond H."""

    load: Array
    gap: Array
    contact_share: Array
    hard_share: Array

    @property
    def between(self) -> Array:
        """Loads (n - 1,) in the middle of neighbouring ones by their logarithm, N."""
        return np.asarray(np.sqrt(self.load[1:] * self.load[:-1]))

    @property
    def stiffness(self) -> Array:
        """K = -dF/d gap (n - 1,) at these, N/m: F d ln F/d gap, since F is nearly exponential in the gap."""
        return np.asarray(self.between * np.diff(np.log(self.load)) / -np.diff(self.gap))


def heights_of(drive: Drive) -> tuple[Array, float] | None:
    """Return the heights (rows, points), m, of the interface and their spacing: the flank, less its mirrored mate.

    Of two maps the part that both have; holes are filled along the lines. None where no patch was measured. Raises
    TruingError where spacings differ.
    """
    flanks = (drive.surface, drive.mating_surface)
    patches = [flank.surface for flank in flanks if flank is not None and not flank.surface.is_profile]
    if not patches:
        return None
    spacings = [spacing for patch in patches for spacing in (patch.spacing_x, patch.spacing_y)]
    if max(spacings) > 1.01 * min(spacings):
        raise TruingError("flanks are pressed on one square grid: measure both with the same spacing along x and y")
    rows, points = np.min([patch.heights.shape for patch in patches], axis=0)
    cut = [_filled(patch.heights[:rows, :points]) for patch in patches]
    return sum(cut[1:], cut[0]), float(spacings[0])


def _filled(heights: Array) -> Array:
    place = np.arange(heights.shape[1])
    known = np.isfinite(heights)
    lines = [np.interp(place, place[own], line[own]) if own.any() else 0.0 * place
             for line, own in zip(heights, known, strict=True)]  # fmt: skip
    return np.array(lines)


def press(heights: Array, spacing: float, modulus: float, hardness: float, loads: Array) -> Pressing:
    """Press a patch (rows, points), m, against a smooth flank under each load (n,), N, rising.

    Raises TruingError where the library is missing or an iteration does not end.
    """
    try:
        from ContactMechanics import PeriodicFFTElasticHalfSpace
        from ContactMechanics.Systems import NonSmoothContactSystem
        from SurfaceTopography import Topography
    except ImportError as error:
        raise TruingError(MISSING) from error
    shape = heights.shape
    size = (shape[0] * spacing, shape[1] * spacing)
    system = NonSmoothContactSystem(
        PeriodicFFTElasticHalfSpace(shape, modulus, size), Topography(heights, size, periodic=True)
    )
    rows, start = [], None
    for load in loads:
        done = system.minimize_proxy(
            external_force=float(load), initial_displacements=start, pentol=CLOSE, maxiter=3000
        )
        if not done.success:
            raise TruingError(f"the numerical contact did not converge at {load:.3g} N: {done.message}")
        start = np.array(done.x)
        pressure = np.array(done.jac).reshape(shape) / spacing**2
        touching = pressure > 0.0
        gap = float(np.mean(start - heights - done.offset))
        rows.append((load, abs(gap), touching.mean(), (pressure > hardness).sum() / max(touching.sum(), 1)))
    return Pressing(*np.array(rows).T)


def slope_of(heights: Array, spacing: float) -> float:
    """Return the root mean square slope of a patch, both directions together."""
    return float(np.sqrt(sum(np.mean(np.square(np.diff(heights, axis=axis))) for axis in (0, 1)))) / spacing


@dataclass(frozen=True, kw_only=True)
class PressedFlanks:
    """Press the measured flanks under ``loads`` loads and set K and the way that they close beside the fractal model.

    The loads make mean pressures of 0.001 to 0.1 of modulus times rms slope: contact on a fraction of a per cent to a
    sixth of the patch.
    """

    loads: int = 6
    name: str = "pressed"
    gives: Callable[[Any], Any] | None = None

    def __post_init__(self) -> None:
        if not 3 <= self.loads <= 50:
            raise TruingError(f"study '{self.name}': loads = {self.loads}, but 3 to 50 can be calculated")

    def run(self, bench: Bench) -> "Compared":
        """Calculate every load, largest gap first."""
        drive: Drive = bench.inputs
        found = heights_of(drive)
        if found is None:
            return Compared(self.name)
        heights, spacing = found
        modulus = float(equivalent_modulus(drive))
        area = heights.size * spacing**2
        loads = np.geomspace(LEAST, MOST, self.loads) * modulus * slope_of(heights, spacing) * area
        numbers = press(heights, spacing, modulus, float(drive.hardness), loads)
        contact = contact_of(drive, interface_of(drive))
        fractal = np.array([float(pressed(load, contact).stiffness) for load in numbers.between])
        closed = np.array([float(approach(load, loads[0], contact)) for load in loads])
        return Compared(self.name, numbers, fractal, closed, float(heights.std()))


@dataclass(frozen=True, eq=False)
class Compared(Outcome):
    """Numbers of the boundary elements; K of the fractal model, and the way that it closes from the first load, m."""

    name: str
    numbers: Pressing | None = None
    fractal: Array = field(default_factory=lambda: np.empty(0))
    closed: Array = field(default_factory=lambda: np.empty(0))
    height: float = float("nan")

    def as_json(self) -> Mapping[str, Any]:
        """Return the columns of the tables, SI."""
        if self.numbers is None:
            return {"loads": []}
        one = self.numbers
        return {
            "loads": one.load.tolist(), "gap": one.gap.tolist(), "contact_share": one.contact_share.tolist(),
            "hard_share": one.hard_share.tolist(), "fractal_closed": self.closed.tolist(),
            "between": one.between.tolist(), "stiffness": one.stiffness.tolist(), "fractal": self.fractal.tolist(),
        }  # fmt: skip

    def blocks(self) -> Sequence[Block]:
        """Say by what factor the fractal model is off, and show stiffness and gap."""
        one = self.numbers
        if one is None:
            return [Words(NO_FLANK)]
        ratio = self.fractal / one.stiffness
        closed = one.gap[0] - one.gap
        rows = list(zip(one.between, one.stiffness, self.fractal, ratio, one.between / one.stiffness / self.height,
                        strict=True))  # fmt: skip
        gaps = list(zip(one.load, 1e9 * one.gap, 1e9 * closed, 1e9 * self.closed, 100.0 * one.contact_share,
                        100.0 * one.hard_share, strict=True))  # fmt: skip
        words = (
            f"The fractal model has {signed(float(ratio.min()), '.2g')} to {signed(float(ratio.max()), '.2g')} times "
            "the stiffness of the measured heights under the same load. Scaled with the rms height, F/K should be near "
            "0.48 by the theory of contact over all scales (Persson 2007)."
        )
        return [
            Words(words),
            Table("Stiffness of the measured patch",
                  ("load", "K by numbers", "K fractal", "ratio", "F/(K h_rms)"), rows,
                  ("N", "N/m", "N/m", "", ""), "Elastic, one period of an endless flank; between the loads below."),
            Table("Its mean gap", ("load", "gap", "closed from the first load", "closed, fractal model", "in contact",
                                   "of that beyond the hardness"), gaps, ("N", "nm", "nm", "nm", "%", "%"),
                  "The gap is that of the mean planes: what closing_clearance stands for."),
        ]  # fmt: skip

    def warnings(self) -> Sequence[str]:
        """Say where the numbers end: a contact that would be plastic."""
        if self.numbers is None or self.numbers.hard_share.max() < 0.5:
            return []
        return [f"study '{self.name}': most of the contact carries more than the hardness; the numbers stay elastic"]
