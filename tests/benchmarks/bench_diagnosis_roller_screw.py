"""How often is what is wrong with a roller screw found and named? Every effect of its model hidden in fresh machines.

Run it: ``python tests/benchmarks/bench_diagnosis_roller_screw.py --cases 32 --seed 1000``. A third of the cases hides
nothing. The others hide one effect at a size drawn between half and the whole of a clear one, on every noise and every
load range, with the results measured in which it shows or one of them alone. A name counts if it is the verdict alone
or another name of its curve. Prints counts, the names of what went wrong, how often an interval held the truth, and
the error on rows that were not fitted over that of the truth itself.
"""

import os
import sys
from pathlib import Path

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np  # noqa: E402

from benchmarks.diagnosis_tally import Tally, asked_by  # noqa: E402
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


def judge(_: int, seed: int, tally: Tally) -> None:
    """Ask one case and count what was said."""
    case = make_case(wished(seed))
    answer = diagnosed(case)
    said = tally.count(case.wish, answer.document, answer.seconds)
    if case.wish.hidden:
        tally.left.append(left_over(case, answer))
    if said == "named":
        tally.cover(case.wish, answer.document["causes"][0])


def left_over(case: Case, answer: Answer) -> float:
    """Error on the rows that were not fitted over that of the truth, of the worst result."""
    true = case.true_readings(case.held)
    errors = [(case.held_readings[name] - answer.predicted[name], name) for name in case.wish.results]
    return max(
        float(np.sqrt(np.mean(error**2) / np.mean((case.held_readings[name] - true[name]) ** 2)))
        for error, name in errors
    )


if __name__ == "__main__":
    asked_by(__doc__, 32, judge)
