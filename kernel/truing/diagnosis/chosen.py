"""What the competition came to: the chosen explanation, what is not excluded beside it, and how sure it is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from truing.diagnosis.competition import Competition
from truing.diagnosis.fitted import Fit

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Law:
    """Largest gains that a search makes of noise alone, simulated (draws,), and the chance of the measured one."""

    gains: NDArray[np.float64]
    p_value: float

    def p_of(self, gain: float) -> float:
        """Return the chance of any other gain of the same search."""
        return float((1 + (self.gains >= gain).sum()) / (1 + len(self.gains)))


@dataclass(frozen=True)
class Rival:
    """An explanation that is not excluded, and how far it lies behind in score."""

    fit: Fit
    behind: float


@dataclass(frozen=True)
class Chosen:
    """The answer of the competition: ``best`` as fitted with the memory of the noise taken out, and its rivals.

    ``same`` holds, by the tag of a cause of ``best``, the names of other causes that draw its curve as it was fitted.
    ``law`` is that of the first step; ``p_second`` is the chance of the last further cause, None where there is none.
    """

    competition: Competition
    best: Fit
    rivals: tuple[Rival, ...]
    same: Mapping[str, tuple[str, ...]]
    law: Law
    p_second: float | None

    @property
    def p_any(self) -> float:
        """The chance that noise alone gives the search as much as the best explanation."""
        return self.law.p_value

    @property
    def null(self) -> Fit:
        """The model as it is, calibrated within its tolerances."""
        return self.competition.null
