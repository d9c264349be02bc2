"""The table of metrics over many outcomes: what was asked, what was measured with its interval, and over how many."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import log, sqrt
from typing import Any

import numpy as np

Outcome = Mapping[str, Any]
Chosen = Callable[[Outcome], bool]
VISIBLE = 25.0
APART = 10.0
NOTHING = ("none", "undecided")
KINDS = ("gaussian", "heavy", "autocorrelated", "growing")


@dataclass(frozen=True)
class Metric:
    """One line of the table: the measured value with its 95 % interval, how many cases, and what is asked."""

    name: str
    value: float
    low: float
    high: float
    count: int
    required: str = ""
    wanted: str = ""
    unit: str = "%"

    def line(self) -> str:
        """The line as printed."""
        digits = 1 if self.unit == "%" else 3
        nothing = self.count == 0 or not np.isfinite(self.value)
        interval = "" if np.isnan(self.low) else f"[{self.low:.{digits}f}, {self.high:.{digits}f}]"
        shown = "-" if nothing else f"{self.value:.{digits}f} {interval}"
        return f"| {self.name:<66} | {shown:<22} | {self.count:>5} | {self.required:<8} | {self.wanted:<8} |"


def wilson(hits: int, count: int, z: float = 1.959964) -> tuple[float, float]:
    """The interval of Wilson of a rate, in percent."""
    if count == 0:
        return float("nan"), float("nan")
    share = hits / count
    middle = (share + z * z / (2 * count)) / (1 + z * z / count)
    half = z * sqrt(share * (1 - share) / count + z * z / (4 * count * count)) / (1 + z * z / count)
    return 100 * max(middle - half, 0.0), 100 * min(middle + half, 1.0)


def rate(name: str, hits: Sequence[bool], required: str = "", wanted: str = "") -> Metric:
    """A share with its interval."""
    low, high = wilson(sum(hits), len(hits))
    return Metric(name, 100 * float(np.mean(hits)) if hits else float("nan"), low, high, len(hits), required, wanted)


def quantile(
    name: str, values: Sequence[float], at: float, required: str = "", wanted: str = "", *, unit: str = ""
) -> Metric:
    """A quantile; its interval from the order statistics."""
    if not values:
        return Metric(name, float("nan"), float("nan"), float("nan"), 0, required, wanted, unit)
    ordered = np.sort(np.asarray(values, dtype=float))
    spread = 1.96 * sqrt(len(ordered) * at * (1 - at))
    low, high = (int(np.clip(at * len(ordered) + way * spread, 0, len(ordered) - 1)) for way in (-1, 1))
    value = float(np.quantile(ordered, at))
    return Metric(name, value, float(ordered[low]), float(ordered[high]), len(ordered), required, wanted, unit)


def of(outcomes: Sequence[Outcome], *strata: str) -> list[Outcome]:
    """The outcomes of some strata."""
    return [one for one in outcomes if one["stratum"] in strata]


def are_both_visible(one: Outcome) -> bool:
    """Whether both halves of a pair can be seen beside each other."""
    return bool(one["visible"] and one["halves"] and min(one["halves"]) > VISIBLE)


def is_unique_and_wrong(one: Outcome) -> bool:
    """Whether something false was stated without a doubt, where the data tell it from the truth."""
    return bool(one["unique"] and not one["exact"] and one["to_truth"] is not None and one["to_truth"] >= APART)


def false_alarms(outcomes: Sequence[Outcome]) -> Iterator[Metric]:
    """How often something is found where nothing is."""
    nothing = of(outcomes, "none")
    alarms = {kind: [not one["exact"] for one in nothing if one["noise"] == kind] for kind in KINDS}
    yield rate("false alarms, all", [not one["exact"] for one in nothing], "<= 4", "<= 3")
    worst = max(KINDS, key=lambda kind: np.mean(alarms[kind]) if alarms[kind] else -1.0)
    yield rate(f"false alarms, worst noise ({worst})", alarms[worst], "<= 7", "<= 5")
    for kind in KINDS:
        yield rate(f"  of {kind}", alarms[kind])


def names(outcomes: Sequence[Outcome]) -> Iterator[Metric]:
    """How often what is hidden is named."""
    single, double = of(outcomes, "single"), of(outcomes, "double")
    unknown, beside = of(outcomes, "unknown"), of(outcomes, "beside")
    seen, both = [one for one in single if one["visible"]], [one for one in double if are_both_visible(one)]
    yield rate("single, separable: exact name", _exact(single, "separable"), ">= 96", ">= 99")
    yield rate("single, visible: exact name", [one["exact"] for one in seen], ">= 85", ">= 92")
    yield rate("single, visible: verdict or first four", [one["in_set"] for one in seen], ">= 96", ">= 99")
    yield rate("double, separable: exact", _exact(double, "separable"), ">= 95", ">= 98")
    yield rate("double, both halves visible: exact", [one["exact"] for one in both], ">= 70", ">= 80")
    yield rate("double, both halves visible: in set", [one["in_set"] for one in both], ">= 88", ">= 95")
    yield rate("unknown, separable: unknown, right covariates", _exact(unknown, "separable"), ">= 92", ">= 97")
    right = [one["exact"] for one in beside if are_both_visible(one)]
    yield rate("registered beside unregistered, both visible: both right", right, ">= 50", ">= 70")
    known = [one["exact"] for one in beside if one["visible"] and min(one["halves_beside_curve"]) > VISIBLE]
    yield rate("  both visible if the very curve of the shape were known", known)
    yield rate("  of those that are separable", _exact(beside, "separable"))
    yield rate("  of all, visible or not", [one["exact"] for one in beside])
    for kind in KINDS:
        yield rate(f"  all separable, {kind}", _exact([one for one in outcomes if one["noise"] == kind], "separable"))
    for design in ("wide", "narrow", "warm-up"):
        chosen = [one for one in outcomes if one["design"] == design]
        yield rate(f"  all separable, {design}", _exact(chosen, "separable"))


def _exact(outcomes: Sequence[Outcome], which: str) -> list[bool]:
    return [one["exact"] for one in outcomes if one[which] and one["stratum"] != "none"]


def honesty(outcomes: Sequence[Outcome]) -> Iterator[Metric]:
    """How often something false is stated, and how many explanations are left open."""
    stated = [one for one in outcomes if one["unique"] and one["verdict"] not in NOTHING and one["stratum"] != "none"]
    wrong = [is_unique_and_wrong(one) for one in stated]
    yield rate("stated unique and wrong (lambda to the truth >= 10)", wrong, "<= 1.5", "<= 0.7")
    named = [is_unique_and_wrong(one) and one["wrong_name"] for one in stated]
    yield rate("  of these, a cause is named that is not there", named)
    right = [one for one in outcomes if one["exact"] and one["stratum"] != "none"]
    yield rate("right, but in doubt", [one["verdict"] == "in doubt" for one in right])
    yield rate("an extra second name on a single", [one["extra"] for one in of(outcomes, "single")], "<= 2.5", "<= 1")
    for kind in KINDS:
        held = [hit for one in outcomes if one["noise"] == kind for hit in one["covered"].values()]
        yield rate(f"95 % intervals cover, {kind}", held, "90-98", "93-97")
    open_ones = [one for one in outcomes if one["verdict"] not in NOTHING and one["alternative_count"]]
    counts = [float(one["alternative_count"]) for one in open_ones]
    yield quantile("alternatives of an ambiguous verdict, median", counts, 0.5, "<= 3", "<= 2")


def prediction(outcomes: Sequence[Outcome]) -> Iterator[Metric]:
    """How well the extended model predicts rows that were held out."""
    hidden = [one for one in outcomes if one["stratum"] != "none"]
    for text, chosen in (("", hidden), ("  of zero-effect cases: ", of(outcomes, "none"))):
        ratios = [one["held_out"]["rmse"] / one["held_out"]["oracle"] for one in chosen]
        asked = (("<= 1.005", "<= 1.002"), ("<= 1.09", "<= 1.05")) if not text else (("", ""), ("", ""))
        yield quantile(f"{text}held-out RMSE over the oracle's, median", ratios, 0.5, *asked[0])
        yield quantile(f"{text}held-out RMSE over the oracle's, 90th percentile", ratios, 0.9, *asked[1])
    seen = [one["held_out"] for one in hidden if one["visible"]]
    removed = [1 - one["mse"] / one["mse_base"] for one in seen]
    yield quantile("reducible error removed (visible), median", removed, 0.5, ">= .98", ">= .99")
    yield quantile("reducible error removed (visible), 10th percentile", removed, 0.1, ">= .75", ">= .85")
    best = [1 - one["mse_oracle"] / one["mse_base"] for one in seen]
    yield quantile("  by the oracle, median", best, 0.5)
    yield quantile("  by the oracle, 10th percentile", best, 0.1)


def gain(outcomes: Sequence[Outcome]) -> Iterator[Metric]:
    """Whether the gain that is stated is the gain that is had."""
    stated = [
        one
        for case in outcomes
        if case["verdict"] not in NOTHING and case["stratum"] != "none"
        for one in case["gain"].values()
        if one["nested_before"] and one["nested_after"] and abs(log(one["held_after"] / one["held_before"])) > 0.01
    ]
    apart = [_apart(one, "nested") for one in stated]
    yield quantile("nested gain against held-out, median |log difference|", apart, 0.5, "<= 5", "<= 4", unit="%")
    least = [_apart(one, "sampled") for one in stated]
    yield quantile("  of one who knows truth and noise of the record", least, 0.5, unit="%")
    ratios = [
        (one["nested_after"] / one["nested_before"], one["sampled_after"] / one["sampled_before"]) for one in stated
    ]
    between = [100 * abs(log(nested / sampled)) for nested, sampled in ratios]
    yield quantile("  between the two", between, 0.5, unit="%")
    false = [_has_false_gain(one) for one in of(outcomes, "none")]
    yield rate("false gain on zero-effect cases (p < 0.05, above 0)", false, "0 of 50", "0 of 100")


def _apart(one: Mapping[str, float], way: str) -> float:
    """Difference of two gains in percent."""
    return 100 * abs(log(one[f"{way}_after"] / one[f"{way}_before"]) - log(one["held_after"] / one["held_before"]))


def _has_false_gain(one: Outcome) -> bool:
    said = [item for item in one["gain"].values() if item["p_value"] is not None and item["log_score"] is not None]
    return any(item["p_value"] < 0.05 and item["log_score"] > 0 for item in said)


def next_points(outcomes: Sequence[Outcome]) -> Iterator[Metric]:
    """How often the measurement that is proposed separates a pair that four points can separate."""
    tried = [one["next_points"] for one in outcomes if one.get("next_points")]
    can = [one for one in tried if one["best"] > APART]
    resolved = [one["proposed"] > APART for one in can]
    yield rate("next measurement: pairs that the proposed points resolve", resolved, "half way", ">= 80")
    chance = [one["random_share"] for one in can]
    mean = 100 * float(np.mean(chance)) if chance else float("nan")
    yield Metric("  a random set of four (baseline)", mean, float("nan"), float("nan"), len(can))
    yield rate("  the best of 200 random sets (ceiling)", [one["best_random"] > APART for one in can])
    proposed = [one["proposed"] > APART for one in can if one["points"]]
    yield rate("  where points were proposed", proposed)
    nothing = float("nan")
    yield Metric("  pairs that no four points separate", nothing, nothing, nothing, len(tried) - len(can))


def speed(outcomes: Sequence[Outcome]) -> Iterator[Metric]:
    """Seconds per diagnosis; only to see, they depend on the machine."""
    yield quantile("seconds per diagnosis, median", [one["seconds"] for one in outcomes], 0.5)
    yield quantile("seconds per diagnosis, 95th percentile", [one["seconds"] for one in outcomes], 0.95)


def metrics(outcomes: Sequence[Outcome]) -> list[Metric]:
    """Every line of the table."""
    parts = (false_alarms, names, honesty, prediction, gain, next_points, speed)
    return [metric for part in parts for metric in part(outcomes)]


def table(outcomes: Sequence[Outcome], title: str) -> str:
    """The table as text."""
    columns = f"| {'metric':<66} | {'measured [95 %]':<22} | {'n':>5} | required | wanted   |"
    lines = [metric.line() for metric in metrics(outcomes)]
    return "\n".join([f"\n{title}: {len(outcomes)} cases", columns, *lines])
