"""How often is what is wrong with a machine of a plugin found and named? Every effect of it hidden in fresh machines.

Run it: ``python tests/benchmarks/bench_diagnosis_plugins.py rv_wear --cases 64 --seed 1000``. A third of the cases
hides nothing (of harmonic drives and flanks a quarter, and a quarter something that nobody registered). The others hide
one effect at a size drawn between half and the whole of a clear one, on every noise and in several designs, with the
results measured in which it shows. A name counts if it is the verdict alone or another name of its curve. Prints
counts, the names of what went wrong, how often an interval held the truth, and the error on rows that were not fitted
over that of the truth itself; ``--dump FILE`` writes one JSON line per case.
"""

from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import many_cases
import numpy as np
from many_cases import Outcome

from hidden_effects import gearing_cases, harmonic_cases, rv_cases, screw_cases
from hidden_effects.clear import DRIVES, REDUCERS, SCREWS, SHAPES, STAGE_STRESSES, STAGES
from hidden_effects.harmonic_machine import MESH, Rows
from hidden_effects.harmonic_surface import FLANK, surface
from hidden_effects.rigs import KINDS, Wish
from hidden_effects.rows import Array, Hidden

OF_STAGES: list[tuple[tuple[str, ...], str]] = [
    (STAGE_STRESSES, "rig"),
    ((gearing_cases.ERROR, gearing_cases.PLAY), "sweep"),
    ((gearing_cases.LOSS, gearing_cases.WARMTH), "one_way"),
    ((gearing_cases.PLAY,), "rig"),
    ((gearing_cases.ERROR,), "rig"),
]
FLEETS = {"wear_temperature", "film_lubrication", "load_exponent"}
"""What only several reducers, each at its own load and speed, can show."""
OF_SCREWS = (*screw_cases.STRESSES, screw_cases.ERROR, screw_cases.WEAR, screw_cases.AXIAL, screw_cases.TORQUE,
             screw_cases.BACKLASH)  # fmt: skip
OF_ITS_OWN = {"lost_motion": "torque_scale", "flank_wear": "torque_scale", "creep": "time_scale"}


def fifth_order(rows: Rows) -> Array:
    """A wave that nobody registered."""
    return 12 * np.sin(5 * np.radians(rows.wave_angle) + 0.4)


def stiff_when_hot_and_fast(rows: Rows) -> Array:
    """A product of two conditions."""
    return 2.5e5 * (rows.temperature - 30) / 30 * (rows.speed - 1000) / 1000


def feed_marks(at: Array) -> Array:
    """Steps across a flank."""
    return np.asarray(0.06 * np.sign(np.sin(2 * np.pi * at / 9 + 1)))


def sized(hidden: Hidden, rng: np.random.Generator, without: Collection[str] = ()) -> Hidden:
    """What is hidden at a share of its size, half to the whole; shapes as they are."""
    share = rng.uniform(0.5, 1.0)
    kept = SHAPES - set(without)
    return {
        effect: {key: value if key in kept else share * value for key, value in unknowns.items()}
        for effect, unknowns in hidden.items()
    }


def stage(place: int, seed: int) -> Wish:
    """A first stage: of three the first hides nothing, the others what comes next in the list."""
    rng = np.random.default_rng([seed, 9])
    kind = KINDS[int(rng.integers(len(KINDS)))]
    if place % 3 == 0:
        results, design = OF_STAGES[place // 3 % len(OF_STAGES)]
        return gearing_cases.stage(seed=seed, results=results, design=design, kind=kind)
    clear = STAGES[(place - place // 3 - 1) % len(STAGES)]
    return replace(clear, seed=seed, hidden=sized(clear.hidden, rng), kind=kind)


def reducer(_: int, seed: int) -> Wish:
    """A reducer: of three seeds one hides nothing, the others any effect."""
    rng = np.random.default_rng([seed, 9])
    name = "" if seed % 3 == 0 else list(REDUCERS)[int(rng.integers(len(REDUCERS)))]
    hidden = sized({name: REDUCERS[name]} if name else {}, rng, without=("exponent",))
    design = "fleet" if name in FLEETS or rng.random() < 0.5 else "endurance"
    results = (rv_cases.BACKLASH, rv_cases.WEAR) if rng.random() < 0.5 else (rv_cases.BACKLASH,)
    kind = KINDS[int(rng.integers(len(KINDS)))]
    return rv_cases.reducer(seed=seed, hidden=hidden, design=design, kind=kind, results=results)


def screw(_: int, seed: int) -> Wish:
    """A roller screw: of three seeds one hides nothing, the others any effect, at times in one of its results alone."""
    rng = np.random.default_rng([seed, 31])
    kind = KINDS[int(rng.integers(len(KINDS)))]
    if seed % 3 == 0:
        results = tuple(rng.choice(OF_SCREWS, 2, replace=False).tolist())
        design = "endurance" if rng.random() < 0.5 else "bench"
        return screw_cases.screw(seed=seed, design=design, kind=kind, results=results)
    clear = SCREWS[int(rng.integers(len(SCREWS)))]
    hidden, results = sized(clear.hidden, rng), clear.results
    if len(results) > 1 and rng.random() < 0.3:
        results = results[:1]
    design = clear.design if clear.design == "endurance" else "bench" if rng.random() < 0.7 else "loaded"
    return replace(clear, seed=seed, hidden=hidden, design=design, kind=kind, results=results)


def drive(_: int, seed: int) -> Wish:
    """A harmonic drive or a flank: of four seeds one hides nothing, one what nobody registered, two the next effect."""
    rng = np.random.default_rng([seed, 37])
    kind = KINDS[int(rng.integers(len(KINDS)))]
    if seed % 4 in {0, 2}:
        which, is_strange = int(rng.integers(3)), seed % 4 == 2
        if which == 2:
            return surface(seed=seed, strange=feed_marks if is_strange else None)
        strange = (fifth_order, stiff_when_hot_and_fast)[which] if is_strange else None
        points: dict[str, Any] = {"design": "points", "results": (MESH,)} if which else {}
        return harmonic_cases.drive(seed=seed, kind=kind, strange=strange, **points)
    clear = DRIVES[seed // 2 % len(DRIVES)]
    hidden = sized(clear.hidden, rng)
    return replace(clear, seed=seed, hidden=hidden, kind=clear.kind if clear.rig is FLANK else kind)


WISHED: dict[str, Callable[[int, int], Wish]] = {
    "rv_gearing": stage, "rv_wear": reducer, "roller_screw_shift": screw, "harmonic_fractal": drive,
}  # fmt: skip
"""How cases of a plugin are wished for, by place and seed."""


def outcome(seed: int, *, plugin: str, first: int) -> Outcome:
    """Ask one case and say what was answered: in a word, with the intervals that hold the truth and the error left."""
    wish = WISHED[plugin](seed - first, seed)
    document = wish.answered.document
    said = said_of(wish, document)
    without = {OF_ITS_OWN.get(effect, "") for effect in wish.hidden} if plugin == "harmonic_fractal" else set()
    return {
        "seed": seed, "title": wish.title, "seconds": wish.answered.seconds, "said": said,
        "hides": "something" if wish.strange is not None else "effect" if wish.hidden else "nothing",
        "hidden": {effect: dict(unknowns) for effect, unknowns in wish.hidden.items()},
        "causes": [cause["effect"] for cause in document["causes"]],
        "covered": covered(wish.hidden, document["causes"][0], without) if said == "named" and wish.hidden else {},
        "left": max((wish.case.left_over_noise(wish.answered.predicted, name) for name in wish.results), default=1.0),
    }  # fmt: skip


# Counts


QUIET = {"nothing", "named", "same curve", "called unknown"}
"""What may be said of a case without a line being printed."""


def said_of(wish: Wish, document: Mapping[str, Any]) -> str:
    """Say in a word what was answered."""
    if wish.strange is not None:
        verdict = str(document["verdict"])
        return {"unknown": "called unknown", "named": "another name"}.get(verdict, verdict)
    if not wish.hidden:
        return "false alarm" if document["explanations"] else "nothing"
    return verdict_on(document, next(iter(wish.hidden)))


def covered(
    hidden: Mapping[str, Mapping[str, float]], cause: Mapping[str, Any], without: Collection[str]
) -> dict[str, bool]:
    """Whether the interval of every unknown of a cause holds the truth."""
    found = {}
    for name, value in hidden[cause["effect"]].items():
        if name in cause["unknowns"] and name not in without:
            low, high = cause["unknowns"][name]["interval95"]
            found[name] = (low is None or low <= value) and (high is None or value <= high)
    return found


def say(outcomes: Sequence[Outcome]) -> None:
    """Print what was counted, and every case of which something else was said than the truth alone."""
    for one in outcomes:
        if one["said"] not in QUIET:
            print(f"  {one['seed']} {one['title']} {one['hidden']}: {one['said']}: {one['causes']}")
        for name, holds in one["covered"].items():
            if not holds:
                print(f"  {one['seed']} {one['title']}: the interval of {name} does not hold {one['hidden']}")
    of = {what: [one for one in outcomes if one["hides"] == what] for what in ("nothing", "something", "effect")}
    for what, title in (("nothing", "nothing hidden"), ("something", "something unregistered"),
                        ("effect", "one effect hidden")):  # fmt: skip
        counts = Counter(one["said"] for one in of[what])
        print(f"{title}: {len(of[what])}; " + ", ".join(f"{name} {many}" for name, many in counts.most_common()))
    holds = [hit for one in outcomes for hit in one["covered"].values()]
    print(f"intervals that hold the truth: {sum(holds)} of {len(holds)}")
    left = [one["left"] for one in of["effect"]]
    if left:
        print(f"error on rows not fitted, over the truth: median {np.median(left):.3f}, worst {max(left):.2f}")
    seconds = [one["seconds"] for one in outcomes]
    print(f"seconds: median {np.median(seconds):.1f}, longest {max(seconds):.1f}")


def verdict_on(document: Mapping[str, Any], hidden: str) -> str:
    """Say in a word how near to the truth an answer is."""
    causes = document["causes"]
    named = [{cause["effect"], *cause["same_as"]} for cause in causes]
    if len(named) == 1 and hidden in named[0]:
        if document["remainder"] is not None:
            return "with an unknown remainder"
        return "named" if causes[0]["effect"] == hidden else "same curve"
    if any(hidden in names for names in named):
        return "with something else"
    if [hidden] in [other["causes"] for other in document["alternatives"]]:
        return "alternative"
    return str(document["verdict"]) if document["verdict"] != "named" else "another name"


def main() -> None:
    """Read the options and run."""
    parser = many_cases.options_of(__doc__, 40)
    parser.add_argument("plugin", choices=WISHED)
    options = parser.parse_args()
    say(many_cases.gathered(partial(outcome, plugin=options.plugin, first=options.seed), options))


if __name__ == "__main__":
    main()
