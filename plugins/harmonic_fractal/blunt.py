"""What an instrument that averages over a spot leaves of the structure function of a power law."""

import numpy as np
from scipy.special import gamma, hyp1f1

from truing import Float

FAR = 30.0  # from here on the series of the hypergeometric function in 1/x is exact to 1e-12
TERMS = 16  # of that series


def kept_share(lag: Float, width: Float, exponent: Float) -> Float:
    """Return the structure function of a filtered power law over that of the power law, 0 to 1; 1 without a width.

    Heights with S = c lag^a, averaged with a Gaussian weight of standard deviation w, have
    c (E|lag + sqrt(2) w Z|^a - E|sqrt(2) w Z|^a), Z standard normal: both ends are averaged, each on its own. With
    x = lag²/(4 w²): (2 w/lag)^a Gamma((1+a)/2)/sqrt(pi) (1F1(-a/2; 1/2; -x) - 1).
    Reference: absolute moments of the normal distribution, Abramowitz and Stegun 13.6, 22.5.
    """
    spot = np.maximum(width, 1e-6 * np.min(lag))
    x = np.square(lag / (2.0 * spot))
    scale = gamma((1.0 + exponent) / 2.0) / np.sqrt(np.pi)
    near = np.minimum(x, FAR)
    found = scale * near ** (-exponent / 2.0) * hyp1f1(-exponent / 2.0, 0.5, -near)
    whole = np.where(x > FAR, _far(np.maximum(x, FAR), exponent / 2.0), found)
    share: Float = np.where(np.asarray(width) > 0.0, whole - scale * x ** (-exponent / 2.0), 1.0)
    return share


def _far(x: Float, half: Float) -> Float:
    """Return Gamma(1/2 + p)/Gamma(1/2) x^-p 1F1(-p; 1/2; -x) for a large x: sum of (-p)_k (1/2 - p)_k / (k! x^k)."""
    term = total = np.ones(np.broadcast(x, half).shape)
    for k in range(TERMS):
        term = term * (k - half) * (k + 0.5 - half) / ((k + 1.0) * x)
        total = total + term
    return total
