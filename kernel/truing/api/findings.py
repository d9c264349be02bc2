"""What a diagnosis found, piece by piece: causes with sizes and intervals, the ranking, the residuals."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from matplotlib.figure import Figure

from truing.api.notebook import plotted, table_html
from truing.api.tables import frame_of, quantity_of
from truing.diagnosis import result as found
from truing.diagnosis.result import stated_remedy
from truing.errors import UsageError
from truing.report.diagnosis_figures import (
    against_simulated,
    main_covariates,
    over_covariate,
    ranking_bars,
    shown_curves,
)
from truing.report.diagnosis_statistics import ranking_table
from truing.report.diagnosis_words import explanation
from truing.units import from_si


@dataclass(frozen=True)
class Fitted:
    """A fitted unknown in its unit, with its 95 % interval; an open end is None. ``quantity`` is pint's."""

    value: float
    interval95: tuple[float | None, float | None]
    unit: str
    quantity: Any


@dataclass(frozen=True)
class NamedCause:
    """A cause that is named: its effect, its unknowns by name, its share of the correction, and what draws the same.

    ``remedy`` is what the effect states is to be done about it, or nothing.
    """

    effect: str
    unknowns: Mapping[str, Fitted]
    share: float
    same_as: tuple[str, ...]
    remedy: str = ""


@dataclass(frozen=True)
class Ranking:
    """The explanations that were compared, the best first."""

    result: found.DiagnosisResult

    def __repr__(self) -> str:
        return f"<Ranking: {'; '.join(explanation(alternative) for alternative in self.result.ranking)}>"

    def frame(self) -> Any:
        """Return them as a dataframe: explanation, how far behind in score, lambda that separates it from the best."""
        ranked = self.result.ranking
        return frame_of(
            {
                "explanation": [explanation(alternative) for alternative in ranked],
                "behind": [alternative.behind for alternative in ranked],
                "separation": [alternative.separation for alternative in ranked],
            }
        )

    def plot(self) -> Figure:
        """Draw how far every explanation is behind the best."""
        return plotted(lambda: ranking_bars(self.result))

    def _repr_html_(self) -> str:
        return table_html(ranking_table(self.result))


@dataclass(frozen=True)
class Residuals:
    """Measured minus simulated, before (calibrated within its tolerances) and after (extended), by result."""

    result: found.DiagnosisResult

    def __repr__(self) -> str:
        return f"<Residuals of {', '.join(curves.result for curves in self.result.curves)}>"

    def frame(self, name: str = "") -> Any:
        """Return what was measured, and the model before and after, of one result in its print unit, row by row."""
        curves = self._curves(name)
        unit = self.result.setup.print_unit(curves.result)
        return frame_of({each: from_si(getattr(curves, each), unit) for each in ("measured", "before", "after")})

    def plot(self, over: str = "", name: str = "") -> Figure:
        """Draw the residuals of a result over a covariate: of what the cause depends on, where none is named.

        Raises UsageError for a column that the record does not have and a result that was not measured.
        """
        return plotted(lambda: self.drawn(over, name))

    def drawn(self, over: str = "", name: str = "") -> Figure:
        """Draw that figure as the present style has it; without a covariate that varies, measured against simulated."""
        covariates = self.result.records.covariates
        if over and over not in covariates:
            raise UsageError(f"'{over}' is no column of the record; there are {', '.join(covariates)}")
        shown = [covariates[over]] if over else main_covariates(self.result)
        curves = self._curves(name)
        return over_covariate(self.result, curves, shown[0]) if shown else against_simulated(self.result, curves)

    def _curves(self, name: str) -> found.ResultCurves:
        by_name = {curves.result: curves for curves in self.result.curves}
        if name and name not in by_name:
            raise UsageError(f"'{name}' was not measured; measured are {', '.join(by_name)}")
        return by_name[name] if name else (shown_curves(self.result) or self.result.curves)[0]


def causes_of(diagnosis: found.DiagnosisResult) -> tuple[NamedCause, ...]:
    """Return the causes that are named, the largest first, unknowns in the units they were declared in."""
    causes = []
    for cause in diagnosis.causes:
        fitted = {}
        for unknown in cause.unknowns:
            unit, ends = unknown.unit, (unknown.low, unknown.high)
            low, high = (None if end is None else float(from_si(end, unit)) for end in ends)
            value = float(from_si(unknown.value, unit))
            fitted[unknown.name] = Fitted(value, (low, high), unit, quantity_of(unknown.value, unit))
        causes.append(
            NamedCause(cause.effect, fitted, cause.share, cause.same_as, stated_remedy(diagnosis, cause.effect))
        )
    return tuple(causes)
