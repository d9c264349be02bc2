"""How often is what is wrong with a reducer found and named? Every effect of rv_wear hidden in fresh machines.

Run it: ``python tests/benchmarks/bench_diagnosis_reducer.py --cases 64 --seed 1000``. A third of the cases hides
nothing. The others hide one effect at a size drawn between half and the whole of a clear one, in turn on every design,
noise and choice of what is measured. A name counts if it is the verdict alone or another name of its curve. Prints
counts, the names of what went wrong, and how often an interval held the truth.
"""

import argparse
import os
import sys
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np  # noqa: E402

from hidden_effects.noises import KINDS  # noqa: E402
from hidden_effects.rv_asking import diagnosed  # noqa: E402
from hidden_effects.rv_cases import BACKLASH, WEAR, Design, Wish, make_case  # noqa: E402

CLEAR: dict[str, dict[str, float]] = {
    "thermal_clearance": {"expansion": 11.5}, "running_in": {"depth": 0.9, "run_in_time": 300},
    "wear_temperature": {"softening": 0.006}, "film_lubrication": {"film_factor": 140}, "pin_rolling": {"rolling": 0.5},
    "pin_wear": {"ratio": 0.7}, "lost_motion_share": {"loss": 0.6}, "bearing_wear": {"wear": 0.6},
    "wind_up": {"compliance": 1.0}, "stiffening": {"twist": 0.2, "torque_scale": 120},
    "runout": {"cosine": 0.7, "sine": -0.9}, "pin_pass_ripple": {"pin_cosine": 0.03, "pin_sine": -0.02},
    "friction_hysteresis": {"lag": 0.02}, "lubricant_ageing": {"rate": 0.3}, "load_exponent": {"exponent": 0.5},
    "duty_share": {"reversing": 0.9},
}  # fmt: skip
SHAPES = {"run_in_time", "torque_scale"}
OF_FLEETS = {"wear_temperature", "film_lubrication", "load_exponent"}


@dataclass
class Tally:
    """What was said, counted."""

    nothing: int = 0
    false_alarms: int = 0
    hidden: int = 0
    said: Counter[str] = field(default_factory=Counter)
    covered: list[bool] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)


def wished(seed: int) -> Wish:
    """The case of a seed."""
    rng = np.random.default_rng([seed, 9])
    name = "" if seed % 3 == 0 else list(CLEAR)[int(rng.integers(len(CLEAR)))]
    share = rng.uniform(0.5, 1.0)
    unknowns = {key: value if key in SHAPES else share * value for key, value in CLEAR.get(name, {}).items()}
    design: Design = "fleet" if name in OF_FLEETS or rng.random() < 0.5 else "endurance"
    results = (BACKLASH, WEAR) if rng.random() < 0.5 else (BACKLASH,)
    kind = KINDS[int(rng.integers(len(KINDS)))]
    return Wish(seed=seed, hidden={name: unknowns} if name else {}, design=design, kind=kind, results=results)


def judge(seed: int, tally: Tally) -> None:
    """Ask one case, count what was said, and print it where it is not the truth alone."""
    case = make_case(wished(seed))
    answer = diagnosed(case)
    document, tally.seconds = answer.document, [*tally.seconds, answer.seconds]
    causes = document["causes"]
    named = [{cause["effect"], *cause["same_as"]} for cause in causes]
    if not case.wish.hidden:
        tally.nothing += 1
        tally.false_alarms += document["verdict"] != "none"
        said = "nothing" if document["verdict"] == "none" else "false alarm"
    else:
        (hidden,) = case.wish.hidden
        others = {tuple(other["causes"]) for other in document["alternatives"]}
        is_alone = len(named) == 1 and document["remainder"] is None
        said = document["verdict"] if document["verdict"] != "named" else "another name"
        if is_alone and hidden in named[0]:
            said = "named" if causes[0]["effect"] == hidden else "same curve"
        elif any(hidden in names for names in named):
            said = "with something else"
        elif (hidden,) in others:
            said = "alternative"
        tally.hidden += 1
        tally.said[said] += 1
        for cause in causes if said == "named" else ():
            for name, value in case.wish.hidden[hidden].items():
                low, high = cause["unknowns"][name]["interval95"]
                tally.covered.append((low is None or low <= value) and (high is None or value <= high))
                if not tally.covered[-1]:
                    print(f"  {seed} {case.wish.title}: {name} is {value:.4g}, not {low} to {high}", flush=True)
    if said not in {"nothing", "named", "same curve"}:
        print(f"  {seed} {case.wish.title}: {said}: {[cause['effect'] for cause in causes]}", flush=True)


def main() -> None:
    """Read the options and run."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=64)
    parser.add_argument("--seed", type=int, default=1000, help="the first seed")
    options = parser.parse_args()
    tally = Tally()
    for seed in range(options.seed, options.seed + options.cases):
        judge(seed, tally)
    print(f"nothing hidden: {tally.false_alarms} false alarms in {tally.nothing}")
    print(
        f"one effect hidden: {tally.hidden}; " + ", ".join(f"{name} {many}" for name, many in tally.said.most_common())
    )
    print(f"intervals that hold the truth: {sum(tally.covered)} of {len(tally.covered)}")
    print(f"seconds: median {np.median(tally.seconds):.1f}, longest {max(tally.seconds):.1f}")


if __name__ == "__main__":
    main()
