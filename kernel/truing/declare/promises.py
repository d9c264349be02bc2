"""What every calculation promises, by the names that the conformance kit gives its checks."""

from __future__ import annotations

from typing import Literal, get_args

Promise = Literal[
    "units are known",
    "defaults keep their bounds",
    "finite at defaults",
    "goals can be read",
    "spreads resolve",
    "printed numbers are of results",
    "sheet is in order",
    "formulas have the unit",
    "formulas equal the function",
    "batch equals loop",
    "steps may be halved",
    "inputs untouched",
    "seeds decide",
    "serial equals parallel",
    "derivatives are exact",
    "bounds are answered",
    "inputs survive a file",
    "example can be read",
    "zero is the base",
    "references are neutral",
    "effects act",
    "only last results are edited",
    "order of effects",
]
"""A check of the kit, as a known exception of a model names it."""
PROMISES: tuple[str, ...] = get_args(Promise)
