"""How often is what is wrong with a first stage found and named? Every effect of rv_gearing hidden in fresh machines.

Run it: ``python tests/benchmarks/bench_diagnosis_gearing.py --cases 40 --seed 1000``. A third of the cases hides
nothing. The others hide one effect, each in its turn, at a size drawn between half and the whole of a clear one, on
every noise. A name counts if it is the verdict alone. Prints counts, the names of what went wrong, and how often an
interval held the truth.
"""

import os
import sys
from pathlib import Path

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np  # noqa: E402

from benchmarks.diagnosis_tally import Tally, asked_by  # noqa: E402
from hidden_effects.gearing_asking import diagnosed  # noqa: E402
from hidden_effects.gearing_cases import (  # noqa: E402
    CONTACT,
    ERROR,
    LOSS,
    PLAY,
    SUN_ROOT,
    WARMTH,
    Design,
    Wish,
    make_case,
)
from hidden_effects.noises import KINDS  # noqa: E402

STRESS = (SUN_ROOT, CONTACT)
CLEAR: list[tuple[str, dict[str, float], tuple[str, ...], Design]] = [
    ("face_misalignment", {"misalignment": 2.0}, STRESS, "rig"),
    ("face_misalignment", {"misalignment": 9.0}, STRESS, "rig"),
    ("face_misalignment", {"per_load": 8.0}, STRESS, "one_way"),
    ("structural_resonance", {"strength": 0.06, "resonance_speed": 900, "damping": 0.1}, STRESS, "rig"),
    ("structural_resonance", {"strength": 0.06, "resonance_speed": 1500, "damping": 0.1}, STRESS, "rig"),
    ("planet_load_sharing", {"lead": 0.2}, STRESS, "rig"),
    ("crowned_contact", {"full_line_load": 25.0}, STRESS, "rig"),
    ("relief_error", {"missing": 0.4}, STRESS, "rig"),
    ("centre_distance_growth", {"expansion": 12.0}, (PLAY,), "rig"),
    ("sun_runout", {"cosine": 1.5, "sine": -1.2}, (ERROR,), "rig"),
    ("planet_runout", {"cosine": -1.2, "sine": 1.5}, (ERROR,), "rig"),
    ("mesh_ripple", {"cosine": 1.0, "sine": 1.0}, (ERROR,), "sweep"),
    ("mesh_ripple", {"second_cosine": 1.2, "second_sine": -0.8}, (ERROR,), "rig"),
    ("output_eccentricity", {"cosine": 2.5, "sine": 1.5}, (ERROR,), "rig"),
    ("output_eccentricity", {"tooth_cosine": 1.2, "tooth_sine": -0.8}, (ERROR,), "rig"),
    ("speed_dependent_loss", {"constant": 0.4, "viscous": 0.4}, (LOSS,), "one_way"),
    ("flash_temperature", {"friction": 0.06}, (WARMTH,), "rig"),
    ("wind_up", {"compliance": 0.6}, (ERROR,), "rig"),
    ("lost_motion", {"play": 15.0, "torque_scale": 60}, (ERROR, PLAY), "sweep"),
    ("wear_drift", {"rate": 2.0}, (ERROR, PLAY), "rig"),
    ("ratio_drift", {"miscount": 1e-6}, (ERROR,), "rig"),
    ("mesh_stiffening", {"share": 1.4}, (ERROR,), "rig"),
]
MEASURED: list[tuple[tuple[str, ...], Design]] = [
    (STRESS, "rig"), ((ERROR, PLAY), "sweep"), ((LOSS, WARMTH), "one_way"), ((PLAY,), "rig"), ((ERROR,), "rig"),
]  # fmt: skip
SHAPES = {"resonance_speed", "damping", "torque_scale"}


def wished(place: int, seed: int) -> Wish:
    """The case of a place in the list and a seed: of three the first hides nothing."""
    rng = np.random.default_rng([seed, 9])
    kind = KINDS[int(rng.integers(len(KINDS)))]
    if place % 3 == 0:
        results, design = MEASURED[place // 3 % len(MEASURED)]
        return Wish(seed=seed, results=results, design=design, kind=kind)
    name, clear, results, design = CLEAR[(place - place // 3 - 1) % len(CLEAR)]
    share = rng.uniform(0.5, 1.0)
    unknowns = {key: value if key in SHAPES else share * value for key, value in clear.items()}
    return Wish(seed=seed, hidden={name: unknowns}, results=results, design=design, kind=kind)


def judge(place: int, seed: int, tally: Tally) -> None:
    """Ask one case and count what was said."""
    wish = wished(place, seed)
    answer = diagnosed(make_case(wish))
    if tally.count(wish, answer.document, answer.seconds) == "named":
        tally.cover(wish, answer.document["causes"][0])


if __name__ == "__main__":
    asked_by(__doc__, 40, judge)
