"""How often is what is wrong with a reducer found and named? Every effect of rv_wear hidden in fresh machines.

Run it: ``python tests/benchmarks/bench_diagnosis_reducer.py --cases 64 --seed 1000``. A third of the cases hides
nothing. The others hide one effect at a size drawn between half and the whole of a clear one, in turn on every design,
noise and choice of what is measured. A name counts if it is the verdict alone or another name of its curve. Prints
counts, the names of what went wrong, and how often an interval held the truth.
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
from hidden_effects.rv_asking import diagnosed  # noqa: E402
from hidden_effects.rv_cases import BACKLASH, WEAR, Design, Wish, make_case  # noqa: E402

CLEAR: dict[str, dict[str, float]] = {
    "thermal_clearance": {"expansion": 11.5}, "running_in": {"depth": 0.9, "run_in_time": 300},
    "wear_temperature": {"softening": 0.006}, "film_lubrication": {"film_factor": 140}, "pin_rolling": {"rolling": 0.5},
    "pin_wear": {"ratio": 0.7}, "lost_motion_share": {"loss": 0.6}, "bearing_wear": {"wear": 0.6},
    "wind_up": {"compliance": 1.0}, "stiffening": {"twist": 0.2, "torque_scale": 120},
    "runout": {"offset": 1.2, "direction": 310}, "pin_pass_ripple": {"pin_cosine": 0.03, "pin_sine": -0.02},
    "friction_hysteresis": {"lag": 0.02}, "lubricant_ageing": {"rate": 0.3}, "load_exponent": {"exponent": 0.5},
    "duty_share": {"idle": 0.45},
}  # fmt: skip
SHAPES = {"run_in_time", "torque_scale", "direction"}
OF_FLEETS = {"wear_temperature", "film_lubrication", "load_exponent"}


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


def judge(_: int, seed: int, tally: Tally) -> None:
    """Ask one case and count what was said."""
    wish = wished(seed)
    answer = diagnosed(make_case(wish))
    if tally.count(wish, answer.document, answer.seconds) == "named":
        tally.cover(wish, answer.document["causes"][0])


if __name__ == "__main__":
    asked_by(__doc__, 64, judge)
