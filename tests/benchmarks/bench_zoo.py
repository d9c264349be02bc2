"""How does the diagnosis do on machines that nobody tuned to? Families of the zoo, one half at a time.

Run it: ``python tests/benchmarks/bench_zoo.py --half open --cases 60 --seed 1000 --workers 1``. It prints by family and
by noise how many answers are right, open, silent, partly right and wrong, with intervals of 95 %, the false alarms
where nothing is hidden, and the processor time. ``--dump FILE`` writes one JSON line per case. Seeds decide everything:
the same seed is the same case, whatever the number of cases.
"""

import time
import traceback
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict
from functools import partial

import many_cases
import numpy as np
from many_cases import Outcome

from zoo.zoo import HALVES, NOISES, Case, Half, can_be_unregistered, diagnosis_of, families, judged, rig_of

JUDGED = ("right", "open", "silent", "partly", "wrong", "failed")
NOTHING, UNREGISTERED = 0.25, 0.25
"""Share of the records with nothing hidden, and of those with something that is not registered."""


def case_of(half: Half, seed: int) -> Case:
    """The case of a seed: every family meets every noise in turn; what is hidden is drawn."""
    names = families(half)
    turn, place = divmod(seed, len(names))
    family, noise = names[place], NOISES[(turn + place) % len(NOISES)]
    generator = np.random.default_rng([seed, 20])
    kind, hidden = generator.uniform(), str(generator.choice(list(rig_of(family).HIDDEN)))
    if kind < NOTHING:
        return Case(family, None, True, noise, seed)
    is_taken_out = kind < NOTHING + UNREGISTERED and can_be_unregistered(family, hidden)
    return Case(family, hidden, not is_taken_out, noise, seed)


def outcome(seed: int, half: Half) -> Outcome:
    """Make a case, ask, and judge; what goes wrong is an outcome too."""
    case, start = case_of(half, seed), time.process_time()
    try:
        verdict = judged(case, diagnosis_of(case))
        said = {"judged": verdict.judged, "said": verdict.said, "explanations": verdict.explanations}
    except Exception:
        said = {"judged": "failed", "said": traceback.format_exc(), "explanations": ()}
    return {**asdict(case), **said, "seconds": time.process_time() - start}


def line(title: str, outcomes: Sequence[Outcome]) -> str:
    """One line of the table: counts, and the shares of right answers, of right or open ones, and of wrong ones."""
    counts = Counter(one["judged"] for one in outcomes)
    right, fine, wrong = counts["right"], counts["right"] + counts["open"], counts["wrong"]
    shares = (many_cases.share(hits, len(outcomes)) for hits in (right, fine, wrong))
    numbers = " | ".join(f"{counts[name]:>6}" for name in JUDGED)
    return f"| {title:<24} | {len(outcomes):>5} | {numbers} | {' | '.join(f'{one:<17}' for one in shares)} |"


def table(outcomes: Sequence[Outcome]) -> str:
    """The whole table: everything, by what was asked, by family and by noise."""
    heads = " | ".join(f"{name:>6}" for name in JUDGED)
    lines = [f"| {'':<24} | cases | {heads} | {'right':<17} | {'right or open':<17} | {'wrong':<17} |"]
    lines.append(line("all", outcomes))
    hidden = [one for one in outcomes if one["hidden"] is not None]
    lines.append(line("nothing hidden", [one for one in outcomes if one["hidden"] is None]))
    lines.append(line("hidden, registered", [one for one in hidden if one["registered"]]))
    lines.append(line("hidden, not registered", [one for one in hidden if not one["registered"]]))
    for key in ("family", "noise"):
        for name in sorted({one[key] for one in outcomes}):
            lines.append(line(f"{key} {name}", [one for one in outcomes if one[key] == name]))  # noqa: PERF401
    return "\n".join(lines)


def say(outcomes: Sequence[Outcome]) -> None:
    """Print the table, the false alarms, the time, and every case that is neither right nor open."""
    print(table(outcomes))
    nothing = [one for one in outcomes if one["hidden"] is None]
    alarms = sum(bool(one["explanations"]) for one in nothing)
    print(
        f"\nfalse alarms where nothing is hidden: {alarms} of {len(nothing)}, {many_cases.share(alarms, len(nothing))}"
    )
    seconds = [one["seconds"] for one in outcomes]
    print(f"processor time of a case: median {np.median(seconds):.1f} s, longest {max(seconds):.1f} s")
    for one in outcomes:
        if one["judged"] not in ("right", "open"):
            what = one["hidden"] or "nothing"
            what += "" if one["registered"] else ", not registered"
            said = " or ".join("+".join(names) for names in one["explanations"]) or one["said"].strip().splitlines()[-1]
            print(
                f"  {one['seed']} {one['family']}, {what}, {one['noise']}: {one['judged']}: {one['said'][:9]}: {said}"
            )


def main() -> None:
    """Read the options and run."""
    parser = many_cases.options_of(__doc__, 60)
    parser.add_argument("--half", choices=HALVES, default="open")
    options = parser.parse_args()
    say(many_cases.gathered(partial(outcome, half=options.half), options))


if __name__ == "__main__":
    main()
