"""How long does a diagnosis take beside a Gaussian process on the same rows, and how does it grow with them?

Run it: ``python tests/benchmarks/bench_diagnosis_speed.py [--many 100000] [--million]``. It prints the time of a whole
diagnosis of 300 rows over that of scikit-learn's Gaussian process (one length scale per covariate, hyperparameters
fitted from one start), both measured alternately in this run; the time of many rows over that of 300; how often the
model is called and for how many rows; with ``--million`` the peak of the memory for a million rows.
"""

import argparse
import os
import resource
import sys
import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np  # noqa: E402

from hidden_effects.asking import INPUTS, press_offer, table  # noqa: E402
from hidden_effects.designs import Noise, measured  # noqa: E402
from hidden_effects.press_machine import POSITION, SCATTER, TILT, Array, Rows, shown  # noqa: E402
from hidden_effects.shapes import COVARIATES, scaled  # noqa: E402

ROUNDS = 3
FEW = 300
MOST_OVER_PROCESS, MOST_OVER_FEW = 8.0, 100.0
GIGABYTE = 2**30
NOISE = Noise("gaussian", {POSITION: 1.5e-6, TILT: 3e-6})
HIDDEN = {"link_heating": {"expansion": 5e-7}, "drive_backlash": {"play_before": 5e-5, "play_after": 5e-5}}


@dataclass(frozen=True)
class Measured:
    """A record with two things wrong, and a folder with its files."""

    rows: Rows
    readings: dict[str, Array]
    folder: Path


def record(count: int, results: tuple[str, ...], folder: Path) -> Measured:
    """Measure a press that is warm and has play."""
    rng = np.random.default_rng(count)
    rows = measured("wide", count, rng)
    off = {name: float(sd * rng.standard_normal()) for name, sd in SCATTER.items()}
    true = shown(rows, off, HIDDEN)
    readings = {result: true[result] + NOISE.drawn(rows, result, rng) for result in results}
    (folder / "inputs.toml").write_text(INPUTS, encoding="utf-8")
    (folder / "measured.csv").write_text(table(rows, readings), encoding="utf-8")
    return Measured(rows, readings, folder)


def diagnosed(made: Measured, calls: list[int] | None = None) -> Any:
    """Read the files and diagnose them; ``calls`` gains the number of rows of every call of the model."""
    from truing.diagnosis.engine import diagnose
    from truing.diagnosis.reading import read_records
    from truing.inputs_file import read_setup

    offer = press_offer()
    own = offer.model.function

    def counted(press: Any) -> Any:
        if calls is not None:
            calls.append(int(np.size(press.crank_angle)))
        return own(press)

    counted.__annotations__ = own.__annotations__
    if calls is not None:
        offer = replace(offer, model=replace(offer.model, function=counted))
    setup = read_setup(made.folder / "inputs.toml", offer)
    return diagnose(setup, read_records([made.folder / "measured.csv"], offer, setup))


def fitted_process(made: Measured) -> None:
    """Fit scikit-learn's Gaussian process to every result."""
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

    rows = np.column_stack([scaled(getattr(made.rows, name)) for name in COVARIATES])
    nominal = shown(made.rows, {}, {})
    for result, values in made.readings.items():
        left = values - nominal[result]
        kernel = ConstantKernel(1.0) * RBF(np.full(len(COVARIATES), 2.0), (0.1, 1e3)) + WhiteKernel(1.0)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            GaussianProcessRegressor(kernel, random_state=0).fit(rows, (left - left.mean()) / left.std())


def seconds(work: Callable[[], object]) -> float:
    """How long something takes."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def beside_process(results: tuple[str, ...], folder: Path) -> float:
    """Print how long a diagnosis of few rows takes, and over a process; return the former."""
    made = record(FEW, results, folder)
    diagnosed(made)
    own, other = [], []
    for _ in range(ROUNDS):
        own.append(seconds(lambda: diagnosed(made)))
        other.append(seconds(lambda: fitted_process(made)))
    ratio = median(one / two for one, two in zip(own, other, strict=True))
    calls: list[int] = []
    diagnosed(made, calls)
    what = " and ".join(results)
    print(
        f"{what}, {FEW} rows: {median(own):.2f} s, {ratio:.1f} times a Gaussian process (asked: {MOST_OVER_PROCESS:g})"
    )
    print(f"  the model is called {len(calls)} times, for {sum(calls) / FEW:.0f} times the rows of the record")
    return median(own)


def grown(results: tuple[str, ...], count: int, few: float, folder: Path) -> None:
    """Print how long many rows take over few, and the most memory in use."""
    made = record(count, results, folder)
    took = seconds(lambda: diagnosed(made))
    print(f"  {count} rows: {took:.1f} s, {took / few:.0f} times {FEW} rows (asked for 100000: {MOST_OVER_FEW:g})")
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / GIGABYTE
    print(f"  most memory of this process so far, making the record included: {peak:.2f} GB", flush=True)


def main() -> None:
    """Read the options and run."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--many", type=int, default=100_000)
    parser.add_argument("--million", action="store_true", help="a million rows too (asked: less than 2 GB)")
    options = parser.parse_args()
    with TemporaryDirectory() as name:
        folder = Path(name)
        for results in ((POSITION,), (POSITION, TILT)):
            few = beside_process(results, folder)
            for count in (options.many, *([1_000_000] if options.million else [])):
                grown(results, count, few, folder)


if __name__ == "__main__":
    main()
