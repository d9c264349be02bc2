"""What the benchmarks of the diagnosis share: options, many cases in one process or several, and shares of them.

Import it before numpy: it keeps every process to one thread, and finds the generators of the tests.
"""

import argparse
import json
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from pathlib import Path
from typing import Any

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
TESTS = Path(__file__).parents[1]
sys.path.insert(0, str(TESTS))

from hidden_effects.scoring import wilson  # noqa: E402

Outcome = dict[str, Any]


def options_of(doc: str, cases: int) -> argparse.ArgumentParser:
    """Options that every benchmark has: how many cases, from which seed, in how many processes, and where to."""
    parser = argparse.ArgumentParser(description=doc.splitlines()[0])
    parser.add_argument("--cases", type=int, default=cases)
    parser.add_argument("--seed", type=int, default=1000, help="the first seed")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--dump", help="write one JSON line per case to this file")
    return parser


def gathered(work: Callable[[int], Outcome], options: argparse.Namespace) -> list[Outcome]:
    """The outcome of every seed, in their order; dumped as they come, with a line of progress now and then."""
    found: list[Outcome] = []
    seeds = range(options.seed, options.seed + options.cases)
    if options.dump:
        Path(options.dump).write_text("", encoding="utf-8")
    for outcome in _as_they_come(work, seeds, options.workers):
        found.append(outcome)
        if options.dump:
            with Path(options.dump).open("a", encoding="utf-8") as lines:
                lines.write(json.dumps(outcome) + "\n")
        if len(found) % 20 == 0 or len(found) == len(seeds):
            print(f"{len(found)} of {len(seeds)} cases", file=sys.stderr, flush=True)
    return sorted(found, key=lambda outcome: int(outcome["seed"]))


def _as_they_come(work: Callable[[int], Outcome], seeds: Sequence[int], workers: int) -> Iterator[Outcome]:
    if workers < 2:
        yield from map(work, seeds)
        return
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        for done in as_completed([pool.submit(work, seed) for seed in seeds]):
            yield done.result()


def share(hits: int, count: int) -> str:
    """A share in percent with its interval of Wilson (95 %)."""
    if not count:
        return "-"
    low, high = wilson(hits, count)
    return f"{100 * hits / count:.0f} % [{low:.0f}, {high:.0f}]"
