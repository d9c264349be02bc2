"""How often is what is wrong with a first stage found and named? Every effect of rv_gearing hidden in fresh machines.

Run it: ``python tests/benchmarks/bench_diagnosis_gearing.py --cases 40 --seed 1000``. A third of the cases hides
nothing. The others hide one effect, each in its turn, at a size drawn between half and the whole of a clear one, on
every noise. A name counts if it is the verdict alone. Prints counts, the names of what went wrong, and how often an
interval held the truth.
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


@dataclass
class Tally:
    """What was said, counted."""

    nothing: int = 0
    false_alarms: int = 0
    said: Counter[str] = field(default_factory=Counter)
    covered: list[bool] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)


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


def judge(wish: Wish, tally: Tally) -> None:
    """Ask one case, count what was said, and print it where it is not the truth alone."""
    answer = diagnosed(make_case(wish))
    document, tally.seconds = answer.document, [*tally.seconds, answer.seconds]
    names = {cause["effect"] for cause in document["causes"]}
    if not wish.hidden:
        tally.nothing += 1
        tally.false_alarms += document["verdict"] != "none"
        said = "nothing" if document["verdict"] == "none" else "false alarm"
    else:
        said = said_of(wish, document)
        tally.said[said] += 1
    if said == "named":
        check_sizes(wish, document, tally)
    elif said != "nothing":
        print(f"  {wish.seed} {wish.title} {wish.hidden}: {said}: {sorted(names)}", flush=True)


def said_of(wish: Wish, document: dict[str, object]) -> str:
    """In a word, what a document says of the effect that is hidden."""
    (hidden,) = wish.hidden
    causes, others = document["causes"], document["alternatives"]
    assert isinstance(causes, list)
    assert isinstance(others, list)
    names = {cause["effect"] for cause in causes}
    if names == {hidden}:
        return "named" if document["remainder"] is None else "with an unknown remainder"
    if any(hidden in cause["same_as"] for cause in causes):
        return "same curve"
    if hidden in names:
        return "with something else"
    if any(other["causes"] == [hidden] for other in others):
        return "alternative"
    return "another name" if names else str(document["verdict"])


def check_sizes(wish: Wish, document: dict[str, object], tally: Tally) -> None:
    """Count the intervals that hold the truth."""
    causes = document["causes"]
    assert isinstance(causes, list)
    found = {name: known for cause in causes for name, known in cause["unknowns"].items()}
    for name, value in next(iter(wish.hidden.values())).items():
        low, high = found[name]["interval95"] if name in found else (0.0, 0.0)
        tally.covered.append((low is None or low <= value) and (high is None or value <= high))
        if not tally.covered[-1]:
            print(f"  {wish.seed} {wish.title}: {name} is {value:.4g}, not {low} to {high}", flush=True)


def main() -> None:
    """Read the options and run."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1000, help="the first seed")
    options = parser.parse_args()
    tally = Tally()
    for place in range(options.cases):
        judge(wished(place, options.seed + place), tally)
    hidden = sum(tally.said.values())
    print(f"nothing hidden: {tally.false_alarms} false alarms in {tally.nothing}")
    print(f"one effect hidden: {hidden}; " + ", ".join(f"{name} {many}" for name, many in tally.said.most_common()))
    print(f"intervals that hold the truth: {sum(tally.covered)} of {len(tally.covered)}")
    print(f"seconds: median {np.median(tally.seconds):.1f}, longest {max(tally.seconds):.1f}")


if __name__ == "__main__":
    main()
