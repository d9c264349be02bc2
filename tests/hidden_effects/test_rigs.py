"""The noise that generators put on readings is what its name says, and has its size."""

import numpy as np
import pytest

from hidden_effects.rigs import KINDS, MEMORY, Kind, grown, held_out, noise_of
from hidden_effects.rows import Array

SPREAD = np.repeat([0.4, 2.0], 4000)


def drawn(kind: Kind) -> Array:
    noise = noise_of(kind, len(SPREAD), np.random.default_rng(1), size=0.01)
    return grown(noise, SPREAD) if kind == "growing" else noise


@pytest.mark.parametrize("kind", KINDS)
def test_noise_has_its_size(kind: Kind) -> None:
    assert np.sqrt(np.mean(drawn(kind) ** 2)) == pytest.approx(0.01, rel=0.06)


def test_each_kind_is_what_its_name_says() -> None:
    """Student with 4 degrees of freedom has 8.6 times as much beyond 4 as the normal law, which has 6e-5."""
    assert np.mean(np.abs(drawn("heavy")) > 0.04) > 20 * 6.3e-5
    assert np.mean(np.abs(drawn("gaussian")) > 0.04) < 1e-3
    wander = drawn("autocorrelated")
    assert np.corrcoef(wander[1:], wander[:-1])[0, 1] == pytest.approx(MEMORY, abs=0.04)
    growing = drawn("growing")
    assert growing[4000:].std() / growing[:4000].std() == pytest.approx(5.0, rel=0.05)


def test_rows_held_out_are_the_others_and_never_the_first() -> None:
    fitted, held = held_out(50, 20, np.random.default_rng(2))
    assert sorted([*fitted, *held]) == list(range(50))
    assert len(held) == 20
    assert fitted[0] == 0
