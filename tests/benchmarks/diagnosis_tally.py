"""What diagnoses said of cases whose truth is known, counted and printed: shared by the benchmarks of the plugins."""

import argparse
from collections import Counter
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

QUIET = {"nothing", "named", "same curve", "called unknown"}
"""What may be said of a case without a line being printed."""


class Wish(Protocol):
    """What a case hides: effects with their unknowns in the units of the registry, and what nobody registered."""

    @property
    def seed(self) -> int: ...
    @property
    def title(self) -> str: ...
    @property
    def hidden(self) -> Mapping[str, Mapping[str, float]]: ...
    @property
    def strange(self) -> Any: ...


@dataclass
class Tally:
    """What was said, counted; ``left`` is the error on rows not fitted over that of the truth, where it was taken."""

    nothing: int = 0
    false_alarms: int = 0
    strange: Counter[str] = field(default_factory=Counter)
    said: Counter[str] = field(default_factory=Counter)
    covered: list[bool] = field(default_factory=list)
    left: list[float] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)

    def count(self, wish: Wish, document: Mapping[str, Any], seconds: float) -> str:
        """Count one answer, say it where it is not the truth alone, and return it in a word."""
        self.seconds.append(seconds)
        verdict = str(document["verdict"])
        if wish.strange is not None:
            said = {"unknown": "called unknown", "named": "another name"}.get(verdict, verdict)
            self.strange[said] += 1
        elif not wish.hidden:
            self.nothing += 1
            self.false_alarms += bool(document["explanations"])
            said = "false alarm" if document["explanations"] else "nothing"
        else:
            said = verdict_on(document, next(iter(wish.hidden)))
            self.said[said] += 1
        if said not in QUIET:
            named = [cause["effect"] for cause in document["causes"]]
            print(f"  {wish.seed} {wish.title} {dict(wish.hidden)}: {said}: {named}", flush=True)
        return said

    def cover(self, wish: Wish, cause: Mapping[str, Any], without: Collection[str] = ()) -> None:
        """Count which intervals of a cause hold the truth."""
        for name, value in wish.hidden[cause["effect"]].items():
            if name not in cause["unknowns"] or name in without:
                continue
            low, high = cause["unknowns"][name]["interval95"]
            self.covered.append((low is None or low <= value) and (high is None or value <= high))
            if not self.covered[-1]:
                print(f"  {wish.seed} {wish.title}: {name} is {value:.4g}, not {low} to {high}", flush=True)

    def tell(self) -> None:
        """Print all that was counted."""
        print(f"nothing hidden: {self.false_alarms} false alarms in {self.nothing}")
        if self.strange:
            print("something unregistered: " + in_words(self.strange))
        print(f"one effect hidden: {sum(self.said.values())}; {in_words(self.said)}")
        print(f"intervals that hold the truth: {sum(self.covered)} of {len(self.covered)}")
        if self.left:
            middle, worst = np.median(self.left), max(self.left)
            print(f"error on rows not fitted, over the truth: median {middle:.3f}, worst {worst:.2f}")
        print(f"seconds: median {np.median(self.seconds):.1f}, longest {max(self.seconds):.1f}")


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


def in_words(counts: Mapping[str, int]) -> str:
    """Write counts in a line, the largest first."""
    return ", ".join(f"{name} {many}" for name, many in Counter(counts).most_common())


def asked_by(description: str, cases: int, judge: Callable[[int, int, Tally], None]) -> None:
    """Read the options of a benchmark, judge the cases (by place and seed) one after another, and print the tally."""
    options = parsed(description, cases)
    tally = Tally()
    for place in range(options.cases):
        judge(place, options.seed + place, tally)
    tally.tell()


def parsed(description: str, cases: int, **flags: str) -> argparse.Namespace:
    """Read how many cases are asked for, the first seed, and further flags with their help."""
    parser = argparse.ArgumentParser(description=description.splitlines()[0])
    parser.add_argument("--cases", type=int, default=cases)
    parser.add_argument("--seed", type=int, default=1000, help="the first seed")
    for name, words in flags.items():
        parser.add_argument(f"--{name}", action="store_true", help=words)
    return parser.parse_args()
