"""A case with a hidden answer: what a diagnosis may see, what is true, how visible and how separable that is."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal, TypeAlias

import numpy as np

from hidden_effects.candidates import Candidate, columns, stacked
from hidden_effects.designs import Design
from hidden_effects.press_machine import Array, Hidden, Rows, shown
from hidden_effects.record import Lens, Record, Rival, beside_groups, other_groups, over_results, rivals
from hidden_effects.rigs import Kind
from hidden_effects.shapes import Shape, family_of

Stratum: TypeAlias = Literal["none", "single", "double", "unknown", "beside"]
VISIBLE, APART = 25.0, 10.0


@dataclass(frozen=True, kw_only=True)
class Case:
    """One press with its measurements. ``readings`` hold what a diagnosis may see; everything else is the answer.

    ``held`` are rows of the same record that are not to be learnt from, their first is that of the record; ``hidden``
    are the unknowns in SI by effect, ``truth`` the candidates' names, ``counters`` what time (s) and strokes had
    counted before the first row.
    """

    seed: int
    stratum: Stratum
    design: Design
    record: Record
    held: Rows
    off: dict[str, float]
    hidden: Hidden = field(default_factory=dict)
    truth: tuple[str, ...] = ()
    shape: Shape | None = None
    counters: tuple[float, float] = (0.0, 0.0)
    readings: dict[str, Array] = field(default_factory=dict)
    held_readings: dict[str, Array] = field(default_factory=dict)

    @property
    def results(self) -> tuple[str, ...]:
        """What is measured."""
        return self.record.results

    @property
    def kind(self) -> Kind:
        """What the noise is like."""
        return self.record.noise.kind

    @property
    def causes(self) -> list[Candidate]:
        """The candidates that are true."""
        return [self.record.candidates[self.record.place(name)] for name in self.truth]

    def true_readings(self, rows: Rows) -> Array:
        """What the gauges would show without noise, one result after another."""
        return stacked(shown(rows, self.off, self.hidden), self.results) + self._of_shape(rows)

    def _of_shape(self, rows: Rows) -> Array:
        return self.shape.of(rows, self.results) if self.shape else np.zeros(len(rows) * len(self.results))

    @cached_property
    def change(self) -> Array:
        """What was hidden in the readings, one result after another."""
        return self.change_at(self.record.rows)

    def change_at(self, rows: Rows) -> Array:
        """What is hidden at these rows, one result after another."""
        return self.true_readings(rows) - stacked(shown(rows, self.off, {}), self.results)

    @cached_property
    def lens(self) -> Lens:
        """What this record can show."""
        return Lens(self.record)

    @cached_property
    def lambda_det(self) -> float:
        """How visible what was hidden is."""
        return self.lens.visibility(self.change)

    @cached_property
    def halves(self) -> tuple[float, ...]:
        """How visible each half of a pair is beside the other one; nothing where there is no pair."""
        if len(self.truth) + (self.shape is not None) < 2:
            return ()
        if self.shape is not None:
            family = over_results(family_of(self.shape, self.record.rows), self.record)
            return (Lens(self.record, family).visibility(self.change), self.lens.separation(self.change, self.truth))
        return tuple(self.lens.separation(self.change, [name]) for name in reversed(self.truth))

    @cached_property
    def nearest_rival(self) -> Rival:
        """The explanation of at most the same size that is hardest to tell from the truth."""
        if not self.truth and self.shape is None:
            return Rival((), 0.0)
        places = [self.record.place(name) for name in self.truth]
        size = 1 if len(places) == 1 and self.shape is None else 2
        sets = rivals(self.lens, places if self.shape is None else [], size)
        also = self.shape.also if self.shape else ""
        candidates = self.record.candidates
        sets = [one for one in sets if all(candidates[variant.owner].effect != also for variant in one)]
        found = [self.lens.nearest(self.change, sets)]
        if self.shape is not None:
            found.append(self._nearest_smooth(self.shape))
        return min(found, key=lambda rival: rival.separation)

    def _nearest_smooth(self, shape: Shape) -> Rival:
        """The smooth family, with what else is true or another cause beside it, that is hardest to tell apart."""
        kept = other_groups(self.record, shape.depends_on)
        if not self.truth:
            return beside_groups(self.lens, self.change, kept)
        own = over_results(family_of(shape, self.record.rows), self.record)
        places = [self.record.place(name) for name in self.truth]
        beside = Lens(self.record, own)
        other = beside.nearest(self.change, [(), *rivals(beside, places, 1)])
        truth = self.true_columns(self.record.rows)
        best = Rival((), np.inf)
        for names, family in kept:
            free = np.hstack([over_results(family, self.record), truth])
            left = Lens(self.record, free).visibility(self.change)
            best = min(best, Rival((*self.truth, *sorted(names)), left), key=lambda rival: rival.separation)
        return min(other, best, key=lambda rival: rival.separation)

    def true_columns(self, rows: Rows) -> Array:
        """Columns of the amplitudes of what is true, with its true shapes."""
        made = []
        for candidate in self.causes:
            unknowns = self.hidden[candidate.effect]
            shapes = {shape: unknowns[shape] for shape in candidate.shapes or {}}
            made.append(columns(rows, self.results, candidate, shapes))
        return np.hstack(made)

    @property
    def lambda_sep(self) -> float:
        """How separable what was hidden is from every rival of at most its size."""
        return min(self.lambda_det, self.nearest_rival.separation)

    @property
    def is_visible(self) -> bool:
        """Whether a diagnosis must see it."""
        return self.lambda_det > VISIBLE

    @property
    def is_separable(self) -> bool:
        """Whether a diagnosis must name it."""
        return self.is_visible and self.lambda_sep > VISIBLE
