"""What a paper prints, where, and under which settings: compared with our own numbers on every sheet."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from decimal import Decimal
from typing import Literal

from truing.errors import DeclarationError

PublishedKind = Literal["printed", "worked", "calibrated", "probability", "at_least", "at_most", "words"]
RULES: Mapping[PublishedKind, str] = {
    "printed": "a printed number: within half a unit of its last digit",
    "worked": "a number of a worked example, rounded on the way: within 0.1 % or half a unit of its last digit",
    "calibrated": "a number that an input was chosen to give: within 0.5 % or half a unit of its last digit",
    "probability": "a probability: the share that fails within 1 % of the printed share that fails",
    "at_least": "said to be at least this",
    "at_most": "said to be at most this",
    "words": "said in words and read as a number: within the distance that the plugin states",
}
"""What counts as a match, one rule for each kind of figure."""
WORKED, CALIBRATED, FAILING = 1e-3, 5e-3, 1e-2
ROUNDING = 1e-9


@dataclass(frozen=True, kw_only=True)
class Published:
    """One printed number.

    ``result`` names the result of ours it is compared with and ``value`` is in ``unit``; ``printed`` is the number as
    it is printed where its last digits are zeros ("1.040"). ``settings`` are what it holds for: input names, and
    ``tolerances.NAME`` for spreads. ``kind`` chooses the rule by which it is judged (``RULES``); where it is empty,
    ``obtained`` does. ``within`` is the distance that counts as a match for what is said in words.
    ``verdict`` is what we state of it: "matches", or "differs" with the reason in ``why``; ``calc verify`` fails when
    the stated verdict is not what comes out.
    """

    name: str
    result: str
    value: float
    unit: str = ""
    where: str = ""
    settings: Mapping[str, str] = field(default_factory=dict)
    printed: str = ""
    kind: Literal["", PublishedKind] = ""
    within: float = 0.0
    verdict: Literal["matches", "differs"] = "matches"
    obtained: Literal["predicted", "calibrated"] = "predicted"
    why: str = ""

    def __post_init__(self) -> None:
        if self.printed and float(self.printed) != self.value:
            raise DeclarationError(f"the published number '{self.name}' is {self.value:g}, printed as '{self.printed}'")

    @property
    def rule(self) -> PublishedKind:
        """The kind of figure it is, by which it is judged."""
        return self.kind or ("calibrated" if self.obtained == "calibrated" else "printed")

    @property
    def half_unit(self) -> float:
        """Half a unit of the last printed digit."""
        text = self.printed or f"{self.value!r}".removesuffix(".0")
        exponent = Decimal(text).as_tuple().exponent
        return 0.5 * 10.0 ** int(exponent)

    def agrees(self, value: float) -> bool:
        """Tell whether a number of ours, in the same unit, matches by the rule of its kind; NaN never does."""
        if self.rule == "at_least":
            return value >= self.value
        if self.rule == "at_most":
            return value <= self.value
        return abs(value - self.value) <= self._distance() * (1 + ROUNDING) + ROUNDING * abs(self.value)

    def _distance(self) -> float:
        if self.rule == "words":
            return self.within
        if self.rule == "probability":
            return FAILING * ((100.0 if self.unit == "%" else 1.0) - self.value)
        share = {"worked": WORKED, "calibrated": CALIBRATED}.get(self.rule, 0.0)
        return max(share * abs(self.value), self.half_unit)


def rules_of(published: Iterable[Published]) -> dict[PublishedKind, str]:
    """Return the rules by which these numbers are judged, by kind."""
    kinds = {number.rule for number in published}
    return {kind: rule for kind, rule in RULES.items() if kind in kinds}


@dataclass(frozen=True, kw_only=True)
class Finding:
    """A misprint, gap or contradiction of the source: said on the sheet and by ``calc verify``, never hidden."""

    title: str
    text: str
