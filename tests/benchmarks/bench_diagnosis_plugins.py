"""How often is what is wrong with a machine of a plugin found and named? Every effect of it hidden in fresh machines.

Run it: ``python tests/benchmarks/bench_diagnosis_plugins.py rv_wear --cases 64 --seed 1000``. A third of the cases
hides nothing, a sixth something that nobody registered where the gauge has such a thing. The others hide one effect at
a size drawn between half and the whole of a clear one, on every noise. Another name of the same curve is right. It
prints how many answers are right, open, silent, partly right and wrong, by effect and noise, how often an interval held
the truth, and the error on rows not fitted over that of the truth; ``--dump FILE`` writes one JSON line per case.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import many_cases
import numpy as np
from many_cases import Outcome

from hidden_effects.clear import CLEAR, SHAPES
from hidden_effects.harmonic_machine import MESH, TORSION
from hidden_effects.harmonic_surface import FLANK, STRUCTURE
from hidden_effects.rigs import KINDS, Wish
from hidden_effects.rows import Array, Hidden
from truing.diagnosis.result import UNKNOWN
from zoo.zoo import judgement


def fifth_order(rows: Any) -> Array:
    """A wave that nobody registered."""
    return np.asarray(12 * np.sin(5 * np.radians(rows.wave_angle) + 0.4))


def stiff_when_hot_and_fast(rows: Any) -> Array:
    """A product of two conditions."""
    return np.asarray(2.5e5 * (rows.temperature - 30) / 30 * (rows.speed - 1000) / 1000)


def feed_marks(at: Array) -> Array:
    """Steps across a flank."""
    return np.asarray(0.06 * np.sign(np.sin(2 * np.pi * at / 9 + 1)))


STRANGE: Mapping[str, Callable[[Any], Array]] = {
    TORSION: fifth_order, MESH: stiff_when_hot_and_fast, STRUCTURE: feed_marks,
}  # fmt: skip
"""What nobody registered, by what is measured."""
OF_ITS_OWN = {"lost_motion": "torque_scale", "flank_wear": "torque_scale", "creep": "time_scale"}
"""Shapes of the machine of a drive that are another thing than those of the registry."""


def sized(hidden: Hidden, rng: np.random.Generator) -> Hidden:
    """What is hidden at a share of its size, half to the whole; shapes as they are."""
    share = rng.uniform(0.5, 1.0)
    kept = SHAPES - {"exponent"} if "load_exponent" in hidden else SHAPES
    return {
        effect: {key: value if key in kept else share * value for key, value in unknowns.items()}
        for effect, unknowns in hidden.items()
    }


def wish_of(plugin: str, seed: int) -> Wish:
    """The case of a seed: measured as one effect or another would be that shows clearly."""
    rng = np.random.default_rng([seed, 9])
    clear = CLEAR[plugin][int(rng.integers(len(CLEAR[plugin])))]
    kind, what = KINDS[int(rng.integers(len(KINDS)))], rng.uniform()
    wish = replace(clear, seed=seed, hidden={}, kind=clear.kind if clear.rig is FLANK else kind)
    if what < 1 / 3:
        return wish
    if what < 1 / 2 and clear.results[0] in STRANGE:
        return replace(wish, strange=STRANGE[clear.results[0]])
    return replace(wish, hidden=sized(clear.hidden, rng))


def sets_of(wish: Wish, document: Mapping[str, Any]) -> list[frozenset[str]]:
    """The explanations that are left, the curve of what is hidden under its own name."""
    own = {cause["effect"]: name for cause in document["causes"] for name in wish.hidden if name in cause["same_as"]}
    plain = {name: UNKNOWN for names in document["explanations"] for name in names if name.startswith(UNKNOWN)}
    return [frozenset((plain | own).get(name, name) for name in names) for names in document["explanations"]]


def answered(wish: Wish) -> Outcome:
    """Ask and judge, with the intervals that hold the truth and the error left."""
    document, sets = wish.answered.document, sets_of(wish, wish.answered.document)
    truth = frozenset(wish.hidden or ([UNKNOWN] if wish.strange is not None else []))
    judged = judgement(truth, document["verdict"], sets)
    named = [cause for cause in document["causes"] if cause["effect"] in wish.hidden] if judged == "right" else []
    return {
        "judged": judged, "said": document["verdict"], "explanations": [sorted(names) for names in sets],
        "covered": [hit for cause in named for hit in covered(wish.hidden[cause["effect"]], cause)],
        "left": max(wish.case.left_over_noise(wish.answered.predicted, name) for name in wish.results),
    }  # fmt: skip


def covered(unknowns: Mapping[str, float], cause: Mapping[str, Any]) -> list[bool]:
    """Whether the interval of every unknown of a cause holds the truth."""
    without: Collection[str] = (OF_ITS_OWN.get(cause["effect"]),)
    ends = {name: cause["unknowns"][name]["interval95"] for name in unknowns if name in cause["unknowns"]}
    return [
        (low is None or low <= unknowns[name]) and (high is None or unknowns[name] <= high)
        for name, (low, high) in ends.items()
        if name not in without
    ]


def outcome(seed: int, *, plugin: str) -> Outcome:
    """Make a case, ask, and judge."""
    wish = wish_of(plugin, seed)
    hides = "+".join(wish.hidden) or ("something unregistered" if wish.strange is not None else "nothing")
    return {"seed": seed, "hides": hides, "noise": wish.kind, **many_cases.attempted(lambda: answered(wish))}


def say(outcomes: Sequence[Outcome]) -> None:
    """Print what was counted."""
    many_cases.say_judged(outcomes, ("hides", "noise"))
    holds = [hit for one in outcomes for hit in one.get("covered", ())]
    print(f"intervals that hold the truth: {sum(holds)} of {len(holds)}")
    left = [one["left"] for one in outcomes if "left" in one]
    print(f"error on rows not fitted, over the truth: median {np.median(left):.3f}, worst {max(left):.2f}")


def main() -> None:
    """Read the options and run."""
    parser = many_cases.options_of(__doc__, 40)
    parser.add_argument("plugin", choices=CLEAR)
    options = parser.parse_args()
    say(many_cases.gathered(partial(outcome, plugin=options.plugin), options))


if __name__ == "__main__":
    main()
