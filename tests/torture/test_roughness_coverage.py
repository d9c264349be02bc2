"""Whether the stated intervals of D, G, K and a_L hold the truth, on surfaces of seeds that decided nothing.

    pytest tests/torture/test_roughness_coverage.py

Every surface is made, cleaned and levelled as a measured one. Of N intervals of 95 % about 0.95 N must hold the truth;
the bounds are those of a binomial distribution at 1 in 1000.
"""

import numpy as np
import pytest
from scipy.stats import binom

from harmonic_fractal.contact import Rough, contact_of, pressed
from harmonic_fractal.estimate import Estimate
from harmonic_fractal.quantities import Drive
from harmonic_fractal.uncertainty import interval_about
from unit.test_harmonic_levelling import estimates, roughness_of

COUNT = 150
CASES = [((1, 500), ""), ((1, 1500), ""), ((100, 200), "x"), ((150, 150), "auto"), ((60, 300), "x")]


def pair_of(dimension: object, roughness: object) -> np.ndarray:
    """Stiffness and radius of the largest contact, which sets b, of one pair under 25 N."""
    drive = Drive()
    contact = contact_of(drive, Rough(dimension=np.asarray(dimension) + 1.0, roughness=np.asarray(roughness)))
    one = pressed(25.0, contact)
    return np.stack([np.asarray(one.stiffness), np.sqrt(np.asarray(one.largest_area))])


def held(found: list[Estimate], dimension: float) -> dict[str, float]:
    """The shares of the intervals that hold the truth."""
    truth = [dimension, np.log(roughness_of(dimension)), *pair_of(dimension, roughness_of(dimension))]
    within = []
    for each in found:
        profile, logarithm = each.resampled.T
        of_pair = pair_of(profile - 1.0, np.exp(logarithm))
        at_estimate = pair_of(each.dimension, each.roughness)
        ends = [each.dimension_interval, tuple(np.log(each.roughness_interval))]
        ends += [interval_about(float(nominal), values) for nominal, values in zip(at_estimate, of_pair, strict=True)]
        within.append([low <= true <= high for (low, high), true in zip(ends, truth, strict=True)])
    return dict(zip(("D", "G", "K", "a_L"), np.mean(within, axis=0), strict=True))


@pytest.mark.parametrize("dimension", [1.2, 1.3, 1.5, 1.7])
@pytest.mark.parametrize(("shape", "direction"), CASES)
def test_intervals_hold_the_truth(shape: tuple[int, int], direction: str, dimension: float, full_torture: bool) -> None:
    if not full_torture:
        pytest.skip("ten minutes; at full size only")
    options = {"direction": direction} if direction else {}
    found = estimates(dimension, shape, COUNT, 7_000_000 + round(100 * dimension) + shape[1], **options)
    assert len(found) > 0.9 * COUNT
    shares = held(found, dimension)
    errors = np.array([each.dimension for each in found]) - dimension
    stated = np.mean([each.resampled[:, 0].std() for each in found])
    raw = np.mean([each.levelled_dimension for each in found]) - dimension
    print(shape, dimension, {name: round(float(share), 3) for name, share in shares.items()},
          f"bias {raw:+.4f} {errors.mean():+.4f} sd {errors.std():.4f} stated {stated:.4f}")  # fmt: skip
    low = binom.ppf(0.001, len(found), 0.95) / len(found)
    assert all(share >= low for share in shares.values()), shares
    assert abs(errors.mean()) < max(3.3 * errors.std() / np.sqrt(len(found)), 0.004)
