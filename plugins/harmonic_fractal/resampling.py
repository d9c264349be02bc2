"""How far D and G scatter: blocks of neighbouring lines, or of neighbouring pieces of them, drawn anew many times."""

import numpy as np

from harmonic_fractal.structure import Array, Steps, StructureFunction, piece_sums

ENOUGH_LINES = 20
LINES_TOGETHER = 10
PIECES = 50  # of all lines, across them
FEWEST_BLOCKS = 4
MOST_UNITS = 2000  # more lines are taken together by neighbours, so that samples of any map fit into memory


def units_of(heights: Array, curve: StructureFunction, steps: Steps, block: int) -> tuple[StructureFunction, int]:
    """Return what is resampled, its structure function (units, k), and how many neighbours are drawn together.

    Blocks of ``block`` lines where that is asked for (not 0). Else of ten lines, where there are twenty lines or more
    and they are independent. Else of pieces: the lines, few or alike, are cut across into 50 pieces, all lines of a
    piece together, and as many neighbouring pieces are drawn together as the longest lag reaches over. At most a
    quarter of the units, so that there are four blocks to draw.

    Lines of one patch are seldom independent, and blocks of ten of them then see half of the scatter only: a fractal
    patch is correlated over its whole height. Pieces as long as the longest lag see 0.6 to 0.9 of it.
    """
    if block or (len(curve.sums) >= ENOUGH_LINES and are_independent(curve)):
        together = -(-len(curve.sums) // MOST_UNITS)
        groups = _grouped(curve, together)
        return groups, _at_most(-(-(block or LINES_TOGETHER) // together), len(groups.sums))
    pieces = StructureFunction(curve.lags, *piece_sums(heights, steps, PIECES))
    reach = steps[-1] * len(pieces.sums) / (heights.shape[1] - steps[-1])
    return pieces, _at_most(int(np.ceil(reach)), len(pieces.sums))


def are_independent(curve: StructureFunction) -> bool:
    """Tell whether what a line says about the slope has nothing to do with what its neighbour says (5 % level)."""
    scores = _scores(curve)
    return bool(scores[1:] @ scores[:-1] <= 1.96 * (scores @ scores) / np.sqrt(len(scores)))


def block_weights(units: int, block: int, samples: int, seed: int) -> Array:
    """Return how often every unit (lines, say) stands in every sample (samples, units): blocks of neighbours.

    The blocks begin anywhere and the last is continued by the first (circular block bootstrap, Politis and Romano
    1992). One block fewer is drawn than the units hold, which makes the variance that of the units and not the
    (blocks - 1)/blocks of it (Rao and Wu 1988).
    """
    generator = np.random.default_rng(seed)
    drawn = max(1, round(units / block) - 1)
    starts = generator.multinomial(drawn, np.full(units, 1.0 / units), size=samples).astype(float)
    weights = np.zeros_like(starts)
    for shift in range(block):
        weights += np.roll(starts, shift, axis=1)
    return weights


def _grouped(curve: StructureFunction, together: int) -> StructureFunction:
    if together == 1:
        return curve
    starts = np.arange(0, len(curve.sums), together)
    return StructureFunction(curve.lags, np.add.reduceat(curve.sums, starts), np.add.reduceat(curve.counts, starts))


def _at_most(block: int, units: int) -> int:
    return max(1, min(block, units // FEWEST_BLOCKS))


def _scores(curve: StructureFunction) -> Array:
    """Return how far every line pulls the slope of ln S over ln lag, to first order; their sum is 0."""
    x = np.log(curve.lags)
    pull = (x - x.mean()) / (curve.pooled * curve.pairs)
    scores: Array = (curve.sums - curve.pooled * curve.counts) @ pull
    return scores
