"""A measured flank pressed against a smooth one, or two against one another, numerically: the check of K and b.

Elastic half-spaces, boundary elements by fast Fourier transform (ContactMechanics, an extra: no own solver). The patch
counts as one period of an endless flank, so that neither its own nor the bulk's deformation as a whole counts: what is
pressed together is the roughness. No fractal model is in it, and no plasticity: ``hard_share`` says how much of the
contact carries more than the hardness. Source of the method: Stanley and Kato 1997; Polonsky and Keer 1999.

Two elastic bodies count as one of both compliances under the sum of their heights. That is exact for half-spaces of any
two materials without friction, and of like materials with it. It does not hold for a layer as thin as the contacts are
wide, for steep flanks, or for unlike materials that stick (Johnson, Contact Mechanics, 5.4).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from gear_geometry.drawing import signed
from harmonic_fractal.contact import Rough, approach, contact_of, equivalent_modulus, interface_of, pressed
from harmonic_fractal.figures import MEAN_PLANE, or_none
from harmonic_fractal.flank import Flank
from harmonic_fractal.micro import LEAST_DIMENSION, MOST_DIMENSION
from harmonic_fractal.quantities import Drive
from truing import Array, Bench, Block, Outcome, Table, TruingError, Words

MISSING = "ContactMechanics is not installed, and nothing is pressed numerically: pip install 'truing[contact]'"
NO_FLANK = "No flank was measured, so there is nothing to press numerically."
PROFILE = "A single profile is no patch and cannot be pressed numerically."
LEAST, MOST = 1e-3, 0.1
"""Mean pressures, in parts of that which flattens the patch: modulus times root mean square slope."""
ADDS = 0.05
"""Relative difference of rms heights from which two flanks are said not to add as independent ones do."""
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


def measured_flanks(drive: Drive) -> list[Flank]:
    """Return the measured flanks."""
    return [flank for flank in (drive.surface, drive.mating_surface) if flank is not None]


def heights_of(drive: Drive) -> tuple[Array, float] | None:
    """Return the heights (rows, points), m, of the interface and their spacing: of the flank and its mate together.

    The mate is turned over to lie on the flank, so its lines run the other way: ridges at 30 degrees on both cross at
    60. Of two maps the part that both have; holes are filled along the lines. None where no patch was measured. Raises
    TruingError where spacings differ.
    """
    mates = [flank is drive.mating_surface for flank in measured_flanks(drive)]
    patches = [flank.surface for flank in measured_flanks(drive)]
    if not patches or any(patch.is_profile for patch in patches):
        return None
    spacings = [spacing for patch in patches for spacing in (patch.spacing_x, patch.spacing_y)]
    if max(spacings) > 1.01 * min(spacings):
        raise TruingError("flanks are pressed on one square grid: measure both with the same spacing along x and y")
    rows, points = np.min([patch.heights.shape for patch in patches], axis=0)
    cut = [_filled(patch.heights[:rows, :points]) for patch in patches]
    turned = [heights[:, ::-1] if is_mate else heights for heights, is_mate in zip(cut, mates, strict=True)]
    return sum(turned[1:], turned[0]), float(spacings[0])


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
        too_hard = int(np.sum(pressure > hardness)) / max(int(np.sum(touching)), 1)
        rows.append((load, abs(gap), touching.mean(), too_hard))
    return Pressing(*np.array(rows).T)


def slope_of(heights: Array, spacing: float) -> float:
    """Return the root mean square slope of a patch, both directions together."""
    return float(np.sqrt(sum(np.mean(np.square(np.diff(heights, axis=axis))) for axis in (0, 1)))) / spacing


def compared_with(drive: Drive) -> tuple[Rough, str]:
    """Return the fractal interface that stands beside the measured heights, and what it is in words.

    Of a refused flank that is its fit over all lags of its first direction: D and G that were stated say nothing of it.
    """
    flanks = {name: getattr(drive, name) for name in ("surface", "mating_surface")}
    anyway = {
        name: replace(flank, chosen=flank.estimates[0].direction)
        for name, flank in flanks.items() if flank is not None and flank.used is None
    }  # fmt: skip
    rough = interface_of(replace(drive, **anyway))
    words = f"D = {float(rough.dimension):.3f}, G = {signed(float(rough.roughness), '.2g')} m"
    if not anyway:
        return rough, words
    fits = " and ".join(f"{name} along {flank.chosen}" for name, flank in anyway.items())
    return rough, f"{words}, of the fit over all lags of {fits}, which is refused: for comparison only"


def _fractal(load: Array, rough: Rough, drive: Drive) -> Array:
    """Return K of the fractal model at these loads, N/m; NaN where it has no value for this D."""
    if not LEAST_DIMENSION <= float(rough.dimension) <= MOST_DIMENSION:
        return np.full(np.shape(load), np.nan)
    return np.asarray(pressed(load, contact_of(drive, rough)).stiffness)


@dataclass(frozen=True, kw_only=True)
class PressedFlanks:
    """Press the measured flanks under ``loads`` loads and set K and the way that they close beside the fractal model.

    The loads make mean pressures of 0.001 to 0.1 of modulus times rms slope: contact on a fraction of a per cent to a
    sixth of the patch. Where nothing can be pressed (a profile, two spacings, no library) it says why, and what the rms
    height alone says of K.
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
        if not measured_flanks(drive):
            return Compared(self.name, reason=NO_FLANK)
        rough, words = compared_with(drive)
        alone = [float(np.nanstd(flank.surface.heights)) for flank in measured_flanks(drive)]
        load, height = float(drive.pair_load), float(np.hypot.reduce(alone))
        ratio = float(_fractal(np.array(load), rough, drive)) * MEAN_PLANE * height / load
        known = Compared(self.name, words=words, load=load, by_height=ratio, apart=height)
        try:
            found = heights_of(drive)
            if found is None:
                return replace(known, reason=PROFILE)
            return self._pressed(*found, drive, rough=rough, known=known)
        except TruingError as error:
            return replace(known, reason=str(error), is_missing=True)

    def _pressed(self, heights: Array, spacing: float, drive: Drive, *, rough: Rough, known: "Compared") -> "Compared":
        modulus = float(equivalent_modulus(drive))
        area = heights.size * spacing**2
        loads = np.geomspace(LEAST, MOST, self.loads) * modulus * slope_of(heights, spacing) * area
        numbers = press(heights, spacing, modulus, float(drive.hardness), loads)
        fractal = _fractal(numbers.between, rough, drive)
        closed = np.full(len(loads), np.nan)
        if np.isfinite(fractal).all():
            closed = np.asarray(approach(loads, loads[0], contact_of(drive, rough)))
        return replace(known, numbers=numbers, fractal=fractal, closed=closed, height=float(heights.std()))


@dataclass(frozen=True, eq=False)
class Compared(Outcome):
    """Numbers of the boundary elements; K of the fractal model, and the way that it closes from the first load, m.

    Without numbers ``reason`` says why, and ``is_missing`` whether that is a fault. ``words`` say which D and G the
    fractal model has. ``height`` is the rms height of what was pressed, ``apart`` that of flanks that know nothing of
    one another, m. ``by_height`` is K of the fractal model over load/(0.48 ``apart``) at ``load``, N, or NaN.
    """

    name: str
    numbers: Pressing | None = None
    fractal: Array = field(default_factory=lambda: np.empty(0))
    closed: Array = field(default_factory=lambda: np.empty(0))
    height: float = float("nan")
    reason: str = ""
    is_missing: bool = False
    words: str = ""
    load: float = float("nan")
    by_height: float = float("nan")
    apart: float = float("nan")

    def as_json(self) -> Mapping[str, Any]:
        """Return the columns of the tables, SI."""
        known = {"reason": self.reason, "compared_with": self.words, "by_height": or_none(self.by_height)}
        if self.numbers is None:
            return {"loads": [], **known}
        one = self.numbers
        return {
            "loads": one.load.tolist(), "gap": one.gap.tolist(), "contact_share": one.contact_share.tolist(),
            "hard_share": one.hard_share.tolist(), "fractal_closed": [or_none(each) for each in self.closed],
            "between": one.between.tolist(), "stiffness": one.stiffness.tolist(),
            "fractal": [or_none(each) for each in self.fractal], **known,
        }  # fmt: skip

    def blocks(self) -> Sequence[Block]:
        """Say by what factor the fractal model is off, and show stiffness and gap."""
        if self.numbers is None:
            return [Words(self.reason, "warning" if self.is_missing else "note"), *self._by_height()]
        one, ratio = self.numbers, self.fractal / self.numbers.stiffness
        closed = one.gap[0] - one.gap
        rows = list(zip(one.between, one.stiffness, self.fractal, ratio, one.between / one.stiffness / self.height,
                        strict=True))  # fmt: skip
        gaps = list(zip(one.load, 1e9 * one.gap, 1e9 * closed, 1e9 * self.closed, 100.0 * one.contact_share,
                        100.0 * one.hard_share, strict=True))  # fmt: skip
        return [
            Words(self._said(ratio)),
            *self._by_height(),
            Table("Stiffness of the measured patch",
                  ("load", "K by numbers", "K fractal", "ratio", "F/(K h_rms)"), rows,
                  ("N", "N/m", "N/m", "", ""), "Elastic, one period of an endless flank; between the loads below."),
            Table("Its mean gap", ("load", "gap", "closed from the first load", "closed, fractal model", "in contact",
                                   "of that beyond the hardness"), gaps, ("N", "nm", "nm", "nm", "%", "%"),
                  "The gap is that of the mean planes: what closing_clearance stands for."),
        ]  # fmt: skip

    def _said(self, ratio: Array) -> str:
        off = (
            f"has {signed(float(ratio.min()), '.2g')} to {signed(float(ratio.max()), '.2g')} times the stiffness of "
            "the measured heights under the same load"
            if np.isfinite(ratio).all()
            else "has no stiffness for this D"
        )
        both = self.height / self.apart
        adds = (
            f" The rms height of both together is {both:.2f} times that of flanks that know nothing of one another, "
            "for which the fractal model adds their structure functions."
            if abs(both - 1.0) > ADDS
            else ""
        )
        return (
            f"The fractal model ({self.words}) {off}. Scaled with the rms height, F/K should be near {MEAN_PLANE:g} by "
            f"the theory of contact over all scales (Persson 2007).{adds}"
        )

    def _by_height(self) -> Sequence[Block]:
        if not np.isfinite(self.by_height):
            return []
        return [
            Words(
                f"By the rms height alone, {signed(1e9 * self.apart, '.3g')} nm, K is F/({MEAN_PLANE:g} h_rms). At "
                f"pair_load, {self.load:g} N, the fractal model ({self.words}) has {signed(self.by_height, '.2g')} "
                "times that."
            )
        ]

    def warnings(self) -> Sequence[str]:
        """Say why nothing was pressed; or where the numbers end, in a contact that would be plastic."""
        if self.is_missing:
            return [f"study '{self.name}': {self.reason}"]
        if self.numbers is None or self.numbers.hard_share.max() < 0.5:
            return []
        return [f"study '{self.name}': most of the contact carries more than the hardness; the numbers stay elastic"]
