"""What each direction of a surface says, and whose D and G are used."""

from dataclasses import dataclass, replace

import numpy as np

from harmonic_fractal.cleaning import without_line
from harmonic_fractal.estimate import Estimate, Estimation, estimate_of
from harmonic_fractal.flank_options import Options
from harmonic_fractal.surface import Direction, Lines, Surface, pooled

ISOTROPIC = 0.15  # difference of the dimensions along x and y up to which a flank is the same in all directions
ALIKE = 3.0  # ratio of the structure functions along x and y, at the lags they share, up to which it is, too
ROUNDING = 1e-18  # of the structure function along the other direction: no relief but rounding


@dataclass(frozen=True, eq=False, kw_only=True)
class Choice:
    """The estimates of all directions, the one that is used or None with the reason, and what is to be said."""

    estimates: tuple[Estimate, ...]
    chosen: Direction | None
    reason: str = ""
    warnings: tuple[str, ...] = ()


def choice_of(surface: Surface, settings: Estimation, options: Options) -> Choice:
    """Estimate D and G along each direction, each line less its own straight line, and choose.

    A profile keeps its lines: its form was removed. With ``auto`` both directions are pooled where both are
    self-affine, their dimensions agree within 0.15, their structure functions within a factor of 3 and their spacings
    within 1 %; else the direction of sliding is
    used, or the only one.
    Raises ValueError where a direction is asked for that the surface does not have.
    """
    if surface.is_profile:
        if options.direction in {"y", "both"} or options.sliding == "y":
            raise ValueError("one profile has the direction x alone: leave out direction and sliding")
        return _asked((estimate_of(surface.lines("x"), "x", settings),), "x")
    lines: dict[Direction, Lines] = {"x": _level(surface.lines("x")), "y": _level(surface.lines("y"))}
    alone = _with_relief(tuple(estimate_of(each, axis, settings) for axis, each in lines.items()))
    said = _anisotropy(alone)
    if options.direction == "both":
        return replace(_asked((*alone, _together(lines, settings)), "both"), warnings=said)
    if options.direction != "auto":
        return replace(_asked(alone, options.direction), warnings=said)
    if not said and surface.is_square and all(estimate.is_accepted for estimate in alone):
        both = _together(lines, settings)
        if both.is_accepted:
            return _asked((*alone, both), "both")
    return _best(alone, options, said)


def _level(lines: Lines) -> Lines:
    return Lines(without_line(lines.heights), lines.spacing)


def _together(lines: dict[Direction, Lines], settings: Estimation) -> Estimate:
    return estimate_of(pooled(lines["x"], lines["y"]), "both", settings)


def _asked(estimates: tuple[Estimate, ...], direction: Direction) -> Choice:
    """Use this direction, or none with its reason."""
    found = next(estimate for estimate in estimates if estimate.direction == direction)
    if found.is_accepted:
        return Choice(estimates=estimates, chosen=direction)
    return Choice(estimates=estimates, chosen=None, reason=found.reason)


def _best(alone: tuple[Estimate, ...], options: Options, said: tuple[str, ...]) -> Choice:
    accepted = [estimate.direction for estimate in alone if estimate.is_accepted]
    refused = [f"along {estimate.direction}: {estimate.reason}" for estimate in alone if not estimate.is_accepted]
    if not accepted:
        return Choice(estimates=alone, chosen=None, reason="; ".join(refused))
    chosen = options.sliding if options.sliding in accepted else accepted[0]
    if refused:
        said = (*said, f"the direction {chosen} alone is used; {refused[0]}")
    elif not said:
        said = (f"the direction of sliding, {chosen}, is used; the directions cannot be pooled",)
    return Choice(estimates=alone, chosen=chosen, warnings=said)


def _with_relief(alone: tuple[Estimate, ...]) -> tuple[Estimate, ...]:
    """Refuse a direction along which the surface has no relief, only rounding: ridges that run along it."""
    largest = [float(np.max(estimate.all_values, initial=0.0)) for estimate in alone]
    return tuple(
        replace(each, reason=f"no relief along {each.direction}: the heights of a line are all the same")
        if each.is_accepted and each.all_values.size and own <= ROUNDING * max(largest)
        else each
        for each, own in zip(alone, largest, strict=True)
    )


def _anisotropy(alone: tuple[Estimate, ...]) -> tuple[str, ...]:
    x, y = alone
    if not (x.is_accepted and y.is_accepted):
        return ()
    meaning = "the contact model knows no lay and takes it as alike in all directions"
    if abs(x.dimension - y.dimension) > ISOTROPIC:
        return (
            f"the flank is anisotropic: the dimension of its profiles is {x.dimension:.3f} along x and "
            f"{y.dimension:.3f} along y; {meaning}",
        )
    ratio = _ratio(x, y)
    if 1.0 / ALIKE <= ratio <= ALIKE:
        return ()
    return (f"the flank is anisotropic: its structure function along x is {ratio:.3g} times that along y; {meaning}",)


def _ratio(x: Estimate, y: Estimate) -> float:
    """Return the structure function along x over that along y at the lags that they share; 1 where there are none."""
    if not (x.lags.size and y.lags.size):
        return 1.0
    low, high = max(x.lags[0], y.lags[0]), min(x.lags[-1], y.lags[-1])
    if low >= high:
        return 1.0
    shared = np.log(np.geomspace(low, high, len(x.lags)))
    along_x, along_y = (np.interp(shared, np.log(each.lags), np.log(each.values)) for each in (x, y))
    return float(np.exp(np.mean(along_x - along_y)))
