"""False alarms of the diagnosis where nothing is wrong: records of four kinds of noise, and some with gross errors.

Run it: ``python tests/benchmarks/bench_diagnosis_false_alarms.py [--seed 0] [--cases 460] [--workers 2]``. Of 23 seeds
twenty hide nothing under one noise after another, three have gross errors. It prints the rate of every kind with its
95 % interval, and the test of the probabilities against uniform ones. ``pytest`` holds the same against the bounds.
"""

import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from many_cases import Outcome, gathered, options_of, share
from scipy.stats import kstest

sys.path.insert(0, str(Path(__file__).parents[1] / "unit"))

from diagnosis_nothing import NOISES, decision_on, gross_errors, nothing_wrong

CASES = 460
GROSS_ERRORS = "gross errors"


def noise_of(seed: int) -> tuple[str, int]:
    """The noise of a seed, and which record of this noise it is."""
    turn, place = divmod(seed, 23)
    if place >= 20:
        return GROSS_ERRORS, 3 * turn + place - 20
    record, noise = divmod(20 * turn + place, len(NOISES))
    return NOISES[noise], record


def outcome(seed: int) -> Outcome:
    """Decide on one record."""
    noise, record = noise_of(seed)
    columns = gross_errors(record)[0] if noise == GROSS_ERRORS else nothing_wrong(noise, record)
    with TemporaryDirectory() as folder:
        is_alarm, probability = decision_on(columns, Path(folder), record)
    return {"seed": seed, "noise": noise, "alarm": is_alarm, "probability": probability}


def alarms(outcomes: Sequence[Outcome]) -> int:
    return sum(one["alarm"] for one in outcomes)


def uniform(outcomes: Sequence[Outcome]) -> float:
    """The probability of probabilities as small as these, were they uniform."""
    test = kstest([one["probability"] for one in outcomes], "uniform", alternative="greater")
    return float(test.pvalue)


def say(outcomes: Sequence[Outcome]) -> None:
    """Print the rates, and whether the probabilities are too small."""
    quiet = [one for one in outcomes if one["noise"] != GROSS_ERRORS]
    for noise in (*NOISES, GROSS_ERRORS):
        chosen = [one for one in outcomes if one["noise"] == noise]
        print(f"{noise:<14} {len(chosen):5d} {alarms(chosen):5d} {share(alarms(chosen), len(chosen))}")
    print(f"{'all noises':<14} {len(quiet):5d} {alarms(quiet):5d} {share(alarms(quiet), len(quiet))}")
    print(f"probabilities below uniform: p = {uniform(quiet):.3f}")


def test_four_hundred_records_in_which_nothing_is_wrong_and_sixty_with_gross_errors() -> None:
    outcomes = [outcome(seed) for seed in range(CASES)]
    say(outcomes)
    quiet = [one for one in outcomes if one["noise"] != GROSS_ERRORS]
    gross = [one for one in outcomes if one["noise"] == GROSS_ERRORS]
    assert (len(quiet), len(gross)) == (400, 60)
    assert alarms(quiet) <= 0.05 * len(quiet)
    assert alarms(gross) <= 0.10 * len(gross)
    assert uniform(quiet) > 0.01


if __name__ == "__main__":
    asked = options_of(__doc__, CASES)
    asked.set_defaults(seed=0)
    say(gathered(outcome, asked.parse_args()))
