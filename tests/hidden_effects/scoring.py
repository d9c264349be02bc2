"""The table of metrics over many outcomes: what was asked, what was measured with its interval, and over how many."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import log, nan, sqrt
from typing import Any

import numpy as np
from scipy.stats import binomtest

from hidden_effects.cases import APART, VISIBLE
from hidden_effects.designs import DESIGNS
from hidden_effects.rigs import KINDS

Outcome = Mapping[str, Any]
NOTHING = ("none", "undecided")


@dataclass(frozen=True)
class Metric:
    """One line of the table: ``what`` (one fact or several) of the cases where all that ``where`` names is true.

    A share of hits in percent, or the quantile ``at`` of numbers; what is required of it, and what is wanted.
    """

    name: str
    where: str
    what: str
    required: str = ""
    wanted: str = ""
    at: float | None = None

    def line(self, cases: Sequence[Mapping[str, Any]]) -> str:
        """The line as printed."""
        chosen = [facts for facts in cases if all(facts[name] for name in self.where.split())]
        values = np.concatenate([[], *(np.ravel(facts[self.what]) for facts in chosen)])
        digits = 1 if self.at is None else 3
        value, low, high = (f"{number:.{digits}f}" for number in self._measured(values))
        shown = f"{value} [{low}, {high}]" if len(values) else "-"
        return f"| {self.name:<66} | {shown:<22} | {len(values):>5} | {self.required:<8} | {self.wanted:<8} |"

    def _measured(self, values: np.ndarray[Any, Any]) -> tuple[float, float, float]:
        """The value with its 95 % interval: of a share that of Wilson, of a quantile from the order statistics."""
        count = len(values)
        if not count:
            return nan, nan, nan
        if self.at is None:
            return 100 * float(np.mean(values)), *wilson(round(np.sum(values)), count)
        spread = 1.96 * sqrt(count * self.at * (1 - self.at))
        ends = np.clip(count * self.at + spread * np.array([-1.0, 1.0]), 0, count - 1).astype(int)
        low, high = np.sort(values)[ends].tolist()
        return float(np.quantile(values, self.at)), low, high


def wilson(hits: int, count: int) -> tuple[float, float]:
    """The interval of Wilson of a share (95 %), in percent."""
    found = binomtest(hits, count).proportion_ci(method="wilson")
    return 100 * float(found.low), 100 * float(found.high)


def facts_of(one: Outcome) -> dict[str, Any]:
    """What the lines of the table ask of a case: which it is, and what is to be counted."""
    is_hidden, is_said, held = one["stratum"] != "none", one["verdict"] not in NOTHING, one["held_out"]
    is_wrong = one["unique"] and not one["exact"] and one["to_truth"] is not None and one["to_truth"] >= APART
    points = one.get("next_points")
    gains = _gains(one) if is_hidden and is_said else []
    return {
        **dict.fromkeys(("none", "single", "double", "unknown", "beside", *KINDS, *DESIGNS), False),
        one["stratum"]: True, one["noise"]: True, one["design"]: True,
        **{name: one[name] for name in ("exact", "in_set", "extra", "visible", "separable", "seconds")},
        "any": True, "hidden": is_hidden, "alarm": not one["exact"],
        "both": one["visible"] and one["halves"] and min(one["halves"]) > VISIBLE,
        "stated": is_hidden and is_said and one["unique"],
        "wrong": is_wrong, "wrong_name": is_wrong and one["wrong_name"], "in_doubt": one["verdict"] == "in doubt",
        "covered": list(one["covered"].values()),
        "open": is_said and one["alternative_count"] > 0, "alternatives": one["alternative_count"],
        "over_oracle": held["rmse"] / held["oracle"],
        "removed": 1 - held["mse"] / held["mse_base"], "nested": gains,
        "false_gain": any((gain["p_value"] or 1) < 0.05 and (gain["log_score"] or 0) > 0
                          for gain in one["gain"].values()),
        "pair": bool(points), "parted": bool(points) and points["best"] > APART,
        **({"pointed": points["points"] > 0, "chance": points["random_share"],
            "by_chance": points["best_random"] > APART, "resolved": points["proposed"] > APART} if points else {}),
    }  # fmt: skip


def _gains(one: Outcome) -> list[float]:
    """How far the gains of a case as stated lie from those on rows held out, as logarithms in percent."""
    apart = []
    for gain in one["gain"].values():
        had = 100 * log(gain["held_after"] / gain["held_before"])
        if gain["nested_before"] and gain["nested_after"] and abs(had) > 1:
            apart.append(abs(100 * log(gain["nested_after"] / gain["nested_before"]) - had))
    return apart


METRICS = [
    Metric("false alarms, all", "none", "alarm", "<= 4", "<= 3"),
    *(Metric(f"  of {kind}", f"none {kind}", "alarm", "<= 7", "<= 5") for kind in KINDS),
    Metric("single, separable: exact name", "single separable", "exact", ">= 96", ">= 99"),
    Metric("single, visible: exact name", "single visible", "exact", ">= 85", ">= 92"),
    Metric("single, visible: verdict or first four", "single visible", "in_set", ">= 96", ">= 99"),
    Metric("double, separable: exact", "double separable", "exact", ">= 95", ">= 98"),
    Metric("double, both halves visible: exact", "double both", "exact", ">= 70", ">= 80"),
    Metric("double, both halves visible: in set", "double both", "in_set", ">= 88", ">= 95"),
    Metric("unknown, separable: unknown, right covariates", "unknown separable", "exact", ">= 92", ">= 97"),
    Metric("registered beside unregistered, both visible: both right", "beside both", "exact", ">= 50", ">= 70"),
    *(Metric(f"  all separable, {name}", f"hidden separable {name}", "exact") for name in (*KINDS, *DESIGNS)),
    Metric("stated unique and wrong (lambda to the truth >= 10)", "stated", "wrong", "<= 1.5", "<= 0.7"),
    Metric("  of these, a cause is named that is not there", "stated", "wrong_name"),
    Metric("right, but in doubt", "hidden exact", "in_doubt"),
    Metric("an extra second name on a single", "single", "extra", "<= 2.5", "<= 1"),
    *(Metric(f"95 % intervals cover, {kind}", kind, "covered", "90-98", "93-97") for kind in KINDS),
    Metric("alternatives of an ambiguous verdict, median", "open", "alternatives", "<= 3", "<= 2", 0.5),
    Metric("held-out RMSE over the oracle's, median", "hidden", "over_oracle", "<= 1.005", "<= 1.002", 0.5),
    Metric("held-out RMSE over the oracle's, 90th percentile", "hidden", "over_oracle", "<= 1.09", "<= 1.05", 0.9),
    Metric("reducible error removed (visible), median", "hidden visible", "removed", ">= .98", ">= .99", 0.5),
    Metric("reducible error removed (visible), 10th percentile", "hidden visible", "removed", ">= .75", ">= .85", 0.1),
    Metric("nested gain against held-out, median |log difference|, %", "any", "nested", "<= 5", "<= 4", 0.5),
    Metric("false gain on zero-effect cases (p < 0.05, above 0)", "none", "false_gain", "0 of 50", "0 of 100"),
    Metric("next measurement: pairs that the proposed points resolve", "parted", "resolved", "half way", ">= 80"),
    Metric("  a random set of four (baseline)", "parted", "chance"),
    Metric("  the best of 200 random sets (ceiling)", "parted", "by_chance"),
    Metric("  where points were proposed", "parted pointed", "resolved"),
    Metric("  pairs that some four points separate", "pair", "parted"),
    Metric("seconds per diagnosis, median", "any", "seconds", at=0.5),
    Metric("seconds per diagnosis, 95th percentile", "any", "seconds", at=0.95),
]


def table(outcomes: Sequence[Outcome], title: str) -> str:
    """The table as text."""
    columns = f"| {'metric':<66} | {'measured [95 %]':<22} | {'n':>5} | required | wanted   |"
    cases = [facts_of(one) for one in outcomes]
    return "\n".join([f"\n{title}: {len(outcomes)} cases", columns, *(metric.line(cases) for metric in METRICS)])
