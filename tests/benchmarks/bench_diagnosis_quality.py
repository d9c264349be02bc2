"""How often does the diagnosis find what is hidden, name it rightly and say how sure it is? Hundreds of hidden cases.

Run it: ``python tests/benchmarks/bench_diagnosis_quality.py --cases 200 --seed 1000 --workers 2``. It
prints every metric with its 95 % interval beside what is asked, for all cases, for the slider position alone and for
position and tilt; ``--dump FILE`` writes one JSON line per case, ``--only SEED`` shows one case and its document.
Seeds decide everything: the same seeds are the same cases.
"""

import argparse
import json
import os
import sys
import time
import traceback
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
sys.path.insert(0, str(Path(__file__).parents[1]))

from hidden_effects.asking import diagnosed  # noqa: E402
from hidden_effects.making import Wish, make_case  # noqa: E402
from hidden_effects.next_points import asked  # noqa: E402
from hidden_effects.outcome import about, outcome  # noqa: E402
from hidden_effects.scoring import table  # noqa: E402

ALL_TOGETHER = "position alone and position with tilt"


def wished(stratum: str | None) -> Wish:
    """What every case is to be like: everything open but the stratum."""
    return Wish(stratum=stratum)  # type: ignore[arg-type]


def one_case(seed: int, *, stratum: str | None = None) -> dict[str, Any]:
    """Make a case, ask, and judge; what goes wrong is an outcome too."""
    case = make_case(seed, wished(stratum))
    try:
        answer = diagnosed(case)
        return outcome(case, answer) | {"next_points": asked(case, answer.document)}
    except Exception:
        return about(case) | {"failed": traceback.format_exc()}


def every_outcome(seeds: Sequence[int], options: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """Give the outcome of every seed, as they are done."""
    from concurrent.futures import ProcessPoolExecutor, as_completed
    from multiprocessing import get_context

    work = partial(one_case, stratum=options.stratum)
    if options.workers < 2:
        yield from map(work, seeds)
        return
    with ProcessPoolExecutor(options.workers, mp_context=get_context("spawn")) as pool:
        for done in as_completed([pool.submit(work, seed) for seed in seeds]):
            yield done.result()


def gathered(seeds: Sequence[int], options: argparse.Namespace) -> list[dict[str, Any]]:
    """Every outcome in the order of the seeds; dumped as they come, with a line of progress now and then."""
    found: list[dict[str, Any]] = []
    start = time.monotonic()
    dump = Path(options.dump).open("w", encoding="utf-8") if options.dump else None  # noqa: SIM115
    for one in every_outcome(seeds, options):
        found.append(one)
        if dump:
            dump.write(json.dumps(one) + "\n")
            dump.flush()
        if len(found) % 20 == 0 or len(found) == len(seeds):
            print(f"{len(found)} of {len(seeds)} cases, {time.monotonic() - start:.0f} s", file=sys.stderr, flush=True)
    if dump:
        dump.close()
    return sorted(found, key=lambda one: one["seed"])


def say(outcomes: Sequence[dict[str, Any]]) -> None:
    """Print the tables, and the seeds where the diagnosis broke."""
    failed = [one for one in outcomes if "failed" in one]
    good = [one for one in outcomes if "failed" not in one]
    for title, count in ((ALL_TOGETHER, None), ("position alone", 1), ("position with tilt", 2)):
        chosen = [one for one in good if count is None or len(one["results"]) == count]
        if chosen:
            print(table(chosen, title))
    for one in failed:
        print(f"\nseed {one['seed']} broke: {one['failed'].strip().splitlines()[-1]}")


def show(seed: int, stratum: str | None) -> None:
    """Print one case, what is true, and the document."""
    case = make_case(seed, wished(stratum))
    print(json.dumps(about(case), indent=1))
    answer = diagnosed(case)
    print(json.dumps(answer.document, indent=1))
    judged = outcome(case, answer) | {"next_points": asked(case, answer.document)}
    kept = ("exact", "in_set", "extra", "to_truth", "covered", "held_out", "gain", "next_points", "seconds")
    print(json.dumps({name: judged[name] for name in kept}, indent=1))


def main() -> None:
    """Read the options and run."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1000, help="the first seed")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--stratum", choices=["none", "single", "double", "unknown", "beside"])
    parser.add_argument("--dump", help="write one JSON line per case to this file")
    parser.add_argument("--only", type=int, help="show the case of this seed alone, with its document")
    options = parser.parse_args()
    if options.only is not None:
        show(options.only, options.stratum)
        return
    say(gathered(range(options.seed, options.seed + options.cases), options))


if __name__ == "__main__":
    main()
