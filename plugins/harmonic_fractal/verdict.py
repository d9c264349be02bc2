"""Whether there is a self-affine range: a decade of lags over which the local dimension stays the same."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
NONE = (float("nan"), float("nan"))
SPAN = 0.2  # of the local dimensions within the range
LOWEST, HIGHEST = (
    1.05,
    1.95,
)  # smoother is a filtered surface or form, rougher is noise or beyond the correlation length
DECADE = 10.0


def local_dimensions(lags: Array, values: Array) -> tuple[Array, Array]:
    """Return the geometric means of neighbouring lags (j,), m, and the profile dimension between them (j,).

    ``values`` (j + 1,) is S, m^2; the dimension is NaN where it is missing or not positive.
    """
    logarithms = np.log(np.where(values > 0, values, np.nan))
    slopes = np.diff(logarithms) / np.diff(np.log(lags))
    return np.sqrt(lags[1:] * lags[:-1]), 2.0 - slopes / 2.0


def self_affine_range(lags: Array, dimensions: Array) -> tuple[float, float]:
    """Return the longest range of lags, m, that is self-affine; NaN and NaN where there is none.

    ``dimensions`` (j,) belong to the steps between the lags (j + 1,). A range holds at least a decade; its local
    dimensions span less than 0.2 and lie within 1.05 and 1.95. Of ranges of the same length the one of shorter lags.
    """
    best = NONE
    for first in range(len(dimensions)):
        for last in range(first, len(dimensions)):
            low, high = float(lags[first]), float(lags[last + 1])
            longer = (
                high / low > best[1] / best[0] * (1 + 1e-9) if best is not NONE else high >= DECADE * low * (1 - 1e-9)
            )
            if longer and is_self_affine(dimensions[first : last + 1]):
                best = (low, high)
    return best


def is_self_affine(dimensions: Array) -> bool:
    """Tell whether local dimensions are those of one power law: within 1.05 and 1.95, and less than 0.2 apart."""
    low, high = float(np.min(dimensions)), float(np.max(dimensions))
    return low >= LOWEST and high <= HIGHEST and high - low < SPAN


def no_range(lags: Array, dimensions: Array) -> str:
    """Say in words why there is no self-affine range."""
    known = np.isfinite(dimensions)
    if not known.any():
        return (
            "no self-affine range: no local slope of the structure function could be taken, because hardly a lag has "
            "100 pairs of points or a difference of height; take longer lines, or more of them"
        )
    low, high = float(dimensions[known].min()), float(dimensions[known].max())
    return (
        f"no self-affine range: over no decade of lags does the local dimension of the profile vary by less than "
        f"{SPAN:g} and stay within {LOWEST:g} to {HIGHEST:g}; it runs from {low:.2f} to {high:.2f} over lags of "
        f"{span_of(lags[0], lags[-1])}"
    )


def span_of(shortest: float, longest: float) -> str:
    """Say from where to where lags, m, run."""
    return f"{shortest * 1e6:.4g} um to {longest * 1e6:.4g} um"
