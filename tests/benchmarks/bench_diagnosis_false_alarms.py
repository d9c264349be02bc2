"""False alarms of the diagnosis where nothing is wrong: 400 records of four kinds of noise, 60 with gross errors.

Run it: ``python tests/benchmarks/bench_diagnosis_false_alarms.py [--first 0] [--cases 100] [--workers 2]``. It prints
the rate of every kind of noise with its 95 % interval, the test of the probabilities against uniform ones, and the
rate with gross errors. ``pytest tests/benchmarks/bench_diagnosis_false_alarms.py`` holds the same against the bounds.
"""

import argparse
import os
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
sys.path.insert(0, str(Path(__file__).parents[1] / "unit"))

from diagnosis_nothing import NOISES, decision_on, gross_errors, nothing_wrong  # noqa: E402
from scipy.stats import beta, kstest  # noqa: E402

CASES, GROSS = 100, 60
Outcome = tuple[str, bool, float]


def one(case: tuple[str, int]) -> Outcome:
    """Decide on one record."""
    noise, seed = case
    columns = gross_errors(seed)[0] if noise == "gross errors" else nothing_wrong(noise, seed)
    with TemporaryDirectory() as folder:
        return noise, *decision_on(columns, Path(folder), seed)


def every(cases: Sequence[tuple[str, int]], workers: int) -> list[Outcome]:
    """Decide on every record."""
    if workers < 2:
        return [one(case) for case in cases]
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        return list(pool.map(one, cases, chunksize=4))


def zero_effect(first: int, cases: int) -> list[tuple[str, int]]:
    """Seeds of so many records of every kind of noise."""
    return [(noise, seed) for seed in range(first, first + cases) for noise in NOISES]


def interval(alarms: int, cases: int) -> tuple[float, float]:
    """The 95 % interval of a rate (Clopper and Pearson)."""
    low = 0.0 if alarms == 0 else float(beta.ppf(0.025, alarms, cases - alarms + 1))
    high = 1.0 if alarms == cases else float(beta.ppf(0.975, alarms + 1, cases - alarms))
    return low, high


def line(name: str, outcomes: Sequence[Outcome]) -> str:
    """One line of the table."""
    alarms, cases = sum(is_alarm for _, is_alarm, _ in outcomes), len(outcomes)
    low, high = interval(alarms, cases)
    return f"{name:<14} {cases:5d} {alarms:5d} {100 * alarms / cases:6.1f} %  [{100 * low:.1f}, {100 * high:.1f}]"


def report(first: int, cases: int, gross: int, workers: int) -> str:
    """Decide on all and return the table."""
    outcomes = every(zero_effect(first, cases), workers)
    lines = ["noise          cases alarms   rate  95 %"]
    lines += [line(noise, [item for item in outcomes if item[0] == noise]) for noise in NOISES]
    lines.append(line("all", outcomes))
    test = kstest([probability for *_, probability in outcomes], "uniform", alternative="greater")
    lines.append(f"probabilities below uniform: D+ = {test.statistic:.3f}, p = {test.pvalue:.3f}")
    lines.append(line("gross errors", every([("gross errors", seed) for seed in range(first, first + gross)], workers)))
    return "\n".join(lines)


def test_four_hundred_records_in_which_nothing_is_wrong() -> None:
    outcomes = every(zero_effect(0, CASES), 1)
    assert sum(is_alarm for _, is_alarm, _ in outcomes) <= 0.05 * len(outcomes)
    probabilities = [probability for *_, probability in outcomes]
    assert kstest(probabilities, "uniform", alternative="greater").pvalue > 0.01


def test_sixty_records_with_gross_errors() -> None:
    outcomes = every([("gross errors", seed) for seed in range(GROSS)], 1)
    assert sum(is_alarm for _, is_alarm, _ in outcomes) <= 0.10 * len(outcomes)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--cases", type=int, default=CASES, help="records of every kind of noise")
    parser.add_argument("--gross", type=int, default=GROSS, help="records with gross errors")
    parser.add_argument("--workers", type=int, default=2)
    chosen = parser.parse_args()
    print(report(chosen.first, chosen.cases, chosen.gross, chosen.workers))
