"""What makes a named cause doubtful: what a wrong cause looks like, each in one sentence with what to check.

The thresholds are conventions; each stands with its name below.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain
from math import sqrt
from typing import TYPE_CHECKING

from truing.numbers import format_number, with_unit
from truing.units import from_si, to_si

if TYPE_CHECKING:
    from truing.diagnosis.result import Amount, Cause, Diagnosis, FittedUnknown

AT_BOUND = 5e-3
"""Of the declared range of an unknown: what lies nearer to an end of it lies there."""
OUTSIDE = 3.0
"""An input is off its band beyond this many standard deviations of its tolerance."""
RANDOM_WALK = 0.92
"""From this AR coefficient on noise is nearly a random walk, which draws any slow curve (the largest that is tried).

Beside a cause one within two standard errors of it is: few rows do not tell them apart.
"""
OVERFITTED = 0.5
"""Of the noise that is stated: what is left is below it by chance 1 in 100 with ten rows, 1 in 3000 with twenty."""
STABLE = 0.5
"""Less than this share of the folds that name the same causes is another verdict on parts of the record."""


def alarms_of(diagnosis: Diagnosis) -> Iterator[str]:
    """Give what speaks against the causes that are named, one sentence each; nothing where none is named."""
    if diagnosis.causes:
        yield from chain(
            _at_bounds(diagnosis),
            moved_inputs(diagnosis),
            _growing(diagnosis),
            _unstable(diagnosis),
            _torn(diagnosis),
            _overfitted(diagnosis),
            wandering(diagnosis),
            diagnosis.hindrances,
        )


def warnings_of(diagnosis: Diagnosis) -> Iterator[str]:
    """Give the alarms, and what is left beside the causes that are named: more to be found, nothing against them."""
    yield from alarms_of(diagnosis)
    if diagnosis.causes:
        yield from _waves_left(diagnosis)
    else:
        yield from diagnosis.hindrances


def _at_bounds(diagnosis: Diagnosis) -> Iterator[str]:
    for cause in diagnosis.causes:
        for unknown in cause.unknowns:
            if _is_at_bound(diagnosis, cause, unknown):
                yield (
                    f"{unknown.name} of {cause.effect} was fitted at the bound declared for it "
                    f"({_text(unknown.value, unknown.unit)}): a wrong cause often ends there; look at what else could "
                    "draw this curve, and widen the range if the machine allows more"
                )


def _is_at_bound(diagnosis: Diagnosis, cause: Cause, unknown: FittedUnknown) -> bool:
    """Whether a fitted unknown lies at an end of its declared range, other than at zero."""
    effect = diagnosis.setup.model.known_effects.get(cause.effect)
    declared = next((each for each in effect.unknowns if each.name == unknown.name), None) if effect else None
    if declared is None or declared.whole or declared.along:
        return False
    low, high = (float(to_si(end, declared.unit)) for end in (declared.low, declared.high))
    return any(end and abs(unknown.value - end) <= AT_BOUND * (high - low) for end in (low, high))


def moved_inputs(diagnosis: Diagnosis) -> Iterator[str]:
    """Give the inputs that no cause names and that were calibrated far beyond their tolerances."""
    named = {cause.effect.removeprefix("input:") for cause in diagnosis.causes}
    for moved in diagnosis.calibrated:
        if abs(moved.of_its_sd) > OUTSIDE and moved.name not in named:
            yield (
                f"{moved.name} had to move by {moved.of_its_sd:.1f} standard deviations of its tolerance to meet the "
                "measurement: its tolerance is stated too narrow, or something else is wrong; measure it"
            )


def _growing(diagnosis: Diagnosis) -> Iterator[str]:
    for gain in diagnosis.gain:
        if gain.held_out is not None and gain.held_out[1] > gain.held_out[0]:
            before, after = (_text(error, gain.rmse_before.unit) for error in gain.held_out)
            yield (
                f"on the rows held out the error of {gain.result} grows from {before} to {after}: the extension "
                "does not carry over to them; look at what is different there"
            )
    if diagnosis.gain and all(gain.rmse_after.value > gain.rmse_before.value for gain in diagnosis.gain):
        first = diagnosis.gain[0]
        yield (
            f"on rows that were not fitted the error of {first.result} grows from {_amount(first.rmse_before)} to "
            f"{_amount(first.rmse_after)}: the cause draws this record and predicts nothing; measure more rows"
        )


def _unstable(diagnosis: Diagnosis) -> Iterator[str]:
    if diagnosis.stability < STABLE:
        yield (
            f"the same causes are named in {100 * diagnosis.stability:.0f} % of the folds only: parts of the record "
            "say something else; look at the ranking, and measure more rows"
        )


def _torn(diagnosis: Diagnosis) -> Iterator[str]:
    """Give the amplitudes that parts of the record, or tolerances, do not let be what all rows say."""
    for each in diagnosis.contradictions:
        yield (
            f"{each.unknown} of {each.effect} is {_amount(each.first)} in one half of the rows and "
            f"{_amount(each.second)} in the other: the two contradict one another; look at what changed between them"
        )
    for half in diagnosis.thinned:
        yield (
            f"on {half.rows}, {' + '.join(half.causes)} explains more, by {half.ahead:.1f} in score: rows that should "
            "say the same do not; look at what alternates between them, and measure more rows"
        )
    for two in diagnosis.trades:
        yield (
            f"{two.unknown} of {two.effect} and {two.input} trade against one another (correlation "
            f"{two.correlation:.3f}): {two.input}, off by what its tolerance allows, draws nearly the same; measure "
            f"{two.input}, or state its tolerance narrower if it is known better"
        )


def _overfitted(diagnosis: Diagnosis) -> Iterator[str]:
    for wrong in diagnosis.wrong:
        if wrong.stated is not None and wrong.noise_floor.value < OVERFITTED * wrong.stated.value:
            yield (
                f"what is left of {wrong.result}, {_amount(wrong.noise_floor)}, is far below the standard deviation "
                f"stated for it, {_amount(wrong.stated)}: the causes follow the noise, or it is smaller than stated; "
                "read some settings again to see how far readings scatter"
            )


def wandering(diagnosis: Diagnosis) -> Iterator[str]:
    """Give the results whose noise was taken as nearly a random walk."""
    for wrong in diagnosis.wrong:
        rho = wrong.noise.ar_coefficient
        most = rho + 2 * sqrt((1 - rho**2) / wrong.rows) if rho > 0 and diagnosis.causes else rho
        if most >= RANDOM_WALK:
            yield (
                f"the noise of {wrong.result} was taken as nearly a random walk (AR coefficient {rho:.2g}), which "
                "draws any slow effect: something that wanders over time is unexplained; measure again, in a changed "
                "order"
            )


def _waves_left(diagnosis: Diagnosis) -> Iterator[str]:
    for wrong in diagnosis.wrong:
        for finding in wrong.findings:
            if finding.kind == "wave":
                yield f"in what is left of {wrong.result} there are {finding.text}: something more is at work"


def _amount(amount: Amount) -> str:
    return _text(amount.value, amount.unit)


def _text(value: float, unit: str) -> str:
    return with_unit(format_number(float(from_si(value, unit)), 3), unit)
