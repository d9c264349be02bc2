"""How often does the diagnosis find what is hidden, name it rightly and say how sure it is? Hundreds of hidden cases.

Run it: ``python tests/benchmarks/bench_diagnosis_quality.py --cases 200 --seed 1000 --workers 2``. It
prints every metric with its 95 % interval beside what is asked, for all cases, for the slider position alone and for
position and tilt; ``--dump FILE`` writes one JSON line per case, ``--only SEED`` shows one case and its document.
Seeds decide everything: the same seeds are the same cases.
"""

import json
import traceback
from collections.abc import Sequence
from functools import partial

from many_cases import Outcome, gathered, options_of

from hidden_effects.asking import diagnosed
from hidden_effects.making import SCHEDULE, Wish, make_case
from hidden_effects.next_points import asked
from hidden_effects.outcome import about, outcome
from hidden_effects.scoring import table


def one_case(seed: int, *, wish: Wish) -> Outcome:
    """Make a case, ask, and judge; what goes wrong is an outcome too."""
    case = make_case(seed, wish)
    try:
        answer = diagnosed(case)
        return outcome(case, answer) | {"next_points": asked(case, answer.document)}
    except Exception:
        return about(case) | {"failed": traceback.format_exc()}


def say(outcomes: Sequence[Outcome]) -> None:
    """Print the tables, and the seeds where the diagnosis broke."""
    good = [one for one in outcomes if "failed" not in one]
    for title, counts in (("position alone and position with tilt", {1, 2}), ("position alone", {1}),
                          ("position with tilt", {2})):  # fmt: skip
        chosen = [one for one in good if len(one["results"]) in counts]
        if chosen:
            print(table(chosen, title))
    for one in outcomes:
        if "failed" in one:
            print(f"\nseed {one['seed']} broke: {one['failed'].strip().splitlines()[-1]}")


def show(seed: int, wish: Wish) -> None:
    """Print one case, what is true, and the document."""
    case = make_case(seed, wish)
    print(json.dumps(about(case), indent=1))
    print(json.dumps(diagnosed(case).document, indent=1))
    judged = one_case(seed, wish=wish)
    kept = ("exact", "in_set", "extra", "to_truth", "covered", "held_out", "gain", "next_points", "seconds")
    print(json.dumps({name: judged[name] for name in kept}, indent=1))


def main() -> None:
    """Read the options and run."""
    parser = options_of(__doc__, 200)
    parser.add_argument("--stratum", choices=sorted(set(SCHEDULE)))
    parser.add_argument("--only", type=int, help="show the case of this seed alone, with its document")
    options = parser.parse_args()
    wish = Wish(stratum=options.stratum)
    if options.only is not None:
        show(options.only, wish)
        return
    say(gathered(partial(one_case, wish=wish), options))


if __name__ == "__main__":
    main()
