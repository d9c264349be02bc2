"""What a paper prints, where, and under which settings: compared with our own numbers on every sheet."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal


@dataclass(frozen=True, kw_only=True)
class Published:
    """One printed number.

    ``result`` names the result of ours it is compared with and ``value`` is in ``unit``. ``settings`` are what it holds
    for: input names, and ``tolerances.NAME`` for spreads. ``agrees_to`` is the relative difference that counts as a
    match.
    ``verdict`` is what we state of it: "matches", or "differs" with the reason in ``why``; ``calc verify`` fails when
    the stated verdict is not what comes out.
    """

    name: str
    result: str
    value: float
    unit: str = ""
    where: str = ""
    settings: Mapping[str, str] = field(default_factory=dict)
    agrees_to: float = 1e-3
    verdict: Literal["matches", "differs"] = "matches"
    obtained: Literal["predicted", "calibrated"] = "predicted"
    why: str = ""


@dataclass(frozen=True, kw_only=True)
class Finding:
    """A misprint, gap or contradiction of the source: said on the sheet and by ``calc verify``, never hidden."""

    title: str
    text: str
