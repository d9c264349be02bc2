"""How does the diagnosis do on machines that nobody tuned to? Families of the zoo, one half at a time.

Run it: ``python tests/benchmarks/bench_zoo.py --half open --cases 60 --seed 1000 --workers 1``. It prints how many
answers are right, open, silent, partly right and wrong, with intervals of 95 %, by what is hidden, by family and by
noise, and the processor time. ``--dump FILE`` writes one JSON line per case. Seeds decide everything: the same seed is
the same case, whatever the number of cases.
"""

from dataclasses import asdict
from functools import partial

import many_cases
import numpy as np
from many_cases import Outcome

from zoo.zoo import HALVES, NOISES, Case, Half, can_be_unregistered, diagnosis_of, families, judged, rig_of

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
    """Make a case, ask, and judge."""
    case = case_of(half, seed)
    what = "nothing" if case.hidden is None else "registered" if case.registered else "unregistered"
    return {**asdict(case), "hides": what, **many_cases.attempted(lambda: asdict(judged(case, diagnosis_of(case))))}


def main() -> None:
    """Read the options and run."""
    parser = many_cases.options_of(__doc__, 60)
    parser.add_argument("--half", choices=HALVES, default="open")
    options = parser.parse_args()
    outcomes = many_cases.gathered(partial(outcome, half=options.half), options)
    many_cases.say_judged(outcomes, ("hides", "family", "noise"))


if __name__ == "__main__":
    main()
