"""What the benchmarks of the diagnosis share: options, many cases in one process or several, and tables of outcomes.

Import it before numpy: it keeps every process to one thread, and finds the generators of the tests.
"""

import argparse
import json
import os
import sys
import time
import traceback
from collections import Counter
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
JUDGED = ("right", "open", "silent", "partly", "wrong", "failed")
"""How an answer may be judged (``zoo.zoo.judgement``); of those that failed there is none."""


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


def attempted(ask: Callable[[], Outcome]) -> Outcome:
    """What came of a case, with its seconds; what goes wrong is an outcome too."""
    start = time.process_time()
    try:
        said = ask()
    except Exception:
        said = {"judged": "failed", "said": traceback.format_exc(), "explanations": ()}
    return {**said, "seconds": time.process_time() - start}


def _line(title: str, outcomes: Sequence[Outcome]) -> str:
    """Counts, and the shares of right answers, of right or open ones, and of wrong ones."""
    counts = Counter(one["judged"] for one in outcomes)
    right, fine, wrong = counts["right"], counts["right"] + counts["open"], counts["wrong"]
    shares = (share(hits, len(outcomes)) for hits in (right, fine, wrong))
    numbers = " | ".join(f"{counts[name]:>6}" for name in JUDGED)
    return f"| {title:<32} | {len(outcomes):>5} | {numbers} | {' | '.join(f'{one:<17}' for one in shares)} |"


def say_judged(outcomes: Sequence[Outcome], keys: Sequence[str]) -> None:
    """Print the table, everything first, then by each key; the time; and every case that is neither right nor open."""
    heads = " | ".join(f"{name:>6}" for name in JUDGED)
    print(f"| {'':<32} | cases | {heads} | {'right':<17} | {'right or open':<17} | {'wrong':<17} |")
    print(_line("all", outcomes))
    for key in keys:
        for name in sorted({str(one[key]) for one in outcomes}):
            print(_line(f"{key} {name}", [one for one in outcomes if str(one[key]) == name]))
    seconds = sorted(one["seconds"] for one in outcomes)
    print(f"processor time of a case: median {seconds[len(seconds) // 2]:.1f} s, longest {seconds[-1]:.1f} s")
    for one in outcomes:
        if one["judged"] not in ("right", "open"):
            said = " or ".join("+".join(names) for names in one["explanations"]) or one["said"].strip().splitlines()[-1]
            case = ", ".join(str(one[key]) for key in keys)
            print(f"  {one['seed']} {case}: {one['judged']}: {one['said'][:9]}: {said}")
