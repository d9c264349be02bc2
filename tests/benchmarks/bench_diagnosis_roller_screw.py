"""How often is what is wrong with a roller screw found and named? Every effect of its model hidden in fresh machines.

Run it: ``python tests/benchmarks/bench_diagnosis_roller_screw.py --cases 32 --seed 1000``. A third of the cases hides
nothing. The others hide one effect at a size drawn between half and the whole of a clear one, on every noise and every
load range, with the results measured in which it shows or one of them alone. A name counts if it is the verdict alone
or another name of its curve. Prints counts, the names of what went wrong, how often an interval held the truth, and
the error on rows that were not fitted over that of the truth itself.
"""

import argparse
import os
import sys
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np  # noqa: E402

from hidden_effects.noises import KINDS  # noqa: E402
from hidden_effects.plugin_asking import Answer  # noqa: E402
from hidden_effects.screw_asking import diagnosed  # noqa: E402
from hidden_effects.screw_cases import (  # noqa: E402
    AXIAL,
    BACKLASH,
    ERROR,
    RING,
    STRESSES,
    TORQUE,
    WEAR,
    Case,
    Design,
    Wish,
    make_case,
)

CLEAR: list[tuple[str, dict[str, float], tuple[str, ...]]] = [  # effect, unknowns, results in which it shows
    ("face_misalignment", {"misalignment": 2.0}, STRESSES),
    ("face_misalignment", {"per_load": 0.1}, STRESSES),
    ("mesh_resonance", {"excitation": 0.08, "resonance_speed": 1800, "damping": 0.06}, STRESSES),
    ("roller_load_sharing", {"lead": 2.0}, STRESSES),
    ("roller_load_sharing", {"lead": -0.4}, STRESSES),
    ("interrupted_tooth", {"lost": 0.4, "phase": 320}, STRESSES),
    ("rim_compliance", {"softness": 0.4}, (RING,)),
    ("thermal_centre_distance", {"expansion": 11.5}, (BACKLASH,)),
    ("roller_runout", {"cosine": 3.0, "sine": -2.0}, (ERROR,)),
    ("carrier_runout", {"cosine": -1.0, "sine": 2.0}, (ERROR,)),
    ("axial_migration", {"mismatch": 0.05}, (AXIAL,)),
    ("flank_wear", {"rate": 2.0}, (WEAR, BACKLASH)),
    ("mesh_friction", {"factor": 1.3}, (TORQUE,)),
]
SHAPES = {"resonance_speed", "damping", "phase"}
EVERY = (*STRESSES, ERROR, WEAR, AXIAL, TORQUE, BACKLASH)


@dataclass
class Tally:
    """What was said, counted."""

    nothing: int = 0
    false_alarms: int = 0
    said: Counter[str] = field(default_factory=Counter)
    covered: list[bool] = field(default_factory=list)
    left: list[float] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)


def wished(seed: int) -> Wish:
    """The case of a seed."""
    rng = np.random.default_rng([seed, 31])
    kind = KINDS[int(rng.integers(len(KINDS)))]
    if seed % 3 == 0:
        results = tuple(rng.choice(EVERY, 2, replace=False).tolist())
        design: Design = "endurance" if rng.random() < 0.5 else "bench"
        return Wish(seed=seed, design=design, kind=kind, results=results)
    name, unknowns, results = CLEAR[int(rng.integers(len(CLEAR)))]
    share = rng.uniform(0.5, 1.0)
    sizes = {key: value if key in SHAPES else share * value for key, value in unknowns.items()}
    if len(results) > 1 and rng.random() < 0.3:
        results = results[:1]
    design = "endurance" if name == "flank_wear" else "bench" if rng.random() < 0.7 else "loaded"
    return Wish(seed=seed, hidden={name: sizes}, design=design, kind=kind, results=results)


def judge(seed: int, tally: Tally) -> None:
    """Ask one case, count what was said, and print it where it is not the truth alone."""
    case = make_case(wished(seed))
    answer = diagnosed(case)
    document, tally.seconds = answer.document, [*tally.seconds, answer.seconds]
    if not case.wish.hidden:
        tally.nothing += 1
        tally.false_alarms += document["verdict"] != "none"
        said = "nothing" if document["verdict"] == "none" else "false alarm"
    else:
        said = verdict_on(document, next(iter(case.wish.hidden)))
        tally.said[said] += 1
        tally.left.append(left_over(case, answer))
        if said == "named":
            held(case, document["causes"][0], tally)
    if said not in {"nothing", "named", "same curve"}:
        named = [cause["effect"] for cause in document["causes"]]
        print(f"  {seed} {case.wish.title}: {said}: {named}", flush=True)


def verdict_on(document: dict[str, Any], hidden: str) -> str:
    """How near to the truth an answer is."""
    causes = document["causes"]
    named = [{cause["effect"], *cause["same_as"]} for cause in causes]
    if len(named) == 1 and document["remainder"] is None and hidden in named[0]:
        return "named" if causes[0]["effect"] == hidden else "same curve"
    if any(hidden in names for names in named):
        return "with something else"
    if [hidden] in [other["causes"] for other in document["alternatives"]]:
        return "alternative"
    return str(document["verdict"]) if document["verdict"] != "named" else "another name"


def left_over(case: Case, answer: Answer) -> float:
    """Error on the rows that were not fitted over that of the truth, of the worst result."""
    true = case.true_readings(case.held)
    errors = [(case.held_readings[name] - answer.predicted[name], name) for name in case.wish.results]
    return max(
        float(np.sqrt(np.mean(error**2) / np.mean((case.held_readings[name] - true[name]) ** 2)))
        for error, name in errors
    )


def held(case: Case, cause: dict[str, Any], tally: Tally) -> None:
    """Count which intervals hold the truth."""
    for name, value in case.wish.hidden[cause["effect"]].items():
        if name not in cause["unknowns"]:
            continue
        low, high = cause["unknowns"][name]["interval95"]
        tally.covered.append((low is None or low <= value) and (high is None or value <= high))
        if not tally.covered[-1]:
            print(f"  {case.wish.seed} {case.wish.title}: {name} is {value:.4g}, not {low} to {high}", flush=True)


def main() -> None:
    """Read the options and run."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=32)
    parser.add_argument("--seed", type=int, default=1000, help="the first seed")
    options = parser.parse_args()
    tally = Tally()
    for seed in range(options.seed, options.seed + options.cases):
        judge(seed, tally)
    print(f"nothing hidden: {tally.false_alarms} false alarms in {tally.nothing}")
    told = ", ".join(f"{name} {many}" for name, many in tally.said.most_common())
    print(f"one effect hidden: {sum(tally.said.values())}; {told}")
    print(f"intervals that hold the truth: {sum(tally.covered)} of {len(tally.covered)}")
    print(f"error on rows not fitted, over the truth: median {np.median(tally.left):.3f}, worst {max(tally.left):.2f}")
    print(f"seconds: median {np.median(tally.seconds):.1f}, longest {max(tally.seconds):.1f}")


if __name__ == "__main__":
    main()
