"""The next measurement: settings that separate explanations which this data cannot tell apart.

Every explanation is believed in turn while its rival refits to everything so far; a setting is worth what the rival
then still gets wrong (greedy T-optimal design). The raw distance of two predictions would be the wrong criterion.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from truing.diagnosis.candidates import new_curves
from truing.diagnosis.contest import Contest, names_of
from truing.diagnosis.findings import in_unit
from truing.diagnosis.machine import Machine, machine_of
from truing.diagnosis.noise import SETTINGS, whiten
from truing.diagnosis.readable import readable_unit
from truing.diagnosis.records import Records
from truing.diagnosis.result import Amount, NextPoint
from truing.diagnosis.rival_twins import TwinTerm, believed, is_physical, twins_of
from truing.diagnosis.search import Solution
from truing.diagnosis.settings import settings_of
from truing.diagnosis.verdict import APART
from truing.measurements import RowsFile
from truing.numbers import format_number
from truing.units import from_si

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Matrix = NDArray[np.float64]

POINTS = 4
MOST_POINTS = 100
"""Nobody measures more: explanations that so many points do not tell apart are told apart by a fact, or not at all."""
RIVALS = 4
FAINTEST = 0.01
"""Curves that no setting sets apart by more, in units of the noise squared, are the same curve everywhere."""


@dataclass
class _Duel:
    """One explanation believed, a rival refitted to it: the rival's coefficients and inverse normal matrix.

    ``signal`` and ``rows`` hold, by result, what the believed one says at every setting (T,), and the rival's row
    there (T, p), both in units of the noise of one value.
    """

    names: tuple[str, str]
    separation: float
    coefficients: Matrix
    inverse: Matrix
    signal: Mapping[str, Matrix]
    rows: Mapping[str, Matrix]

    def gains(self) -> Matrix:
        """Return what every setting would add to the separation, shape (T,)."""
        import numpy as np

        total = np.zeros(len(next(iter(self.signal.values()))))
        for name, signal in self.signal.items():
            rows = self.rows[name]
            leverage = np.einsum("ij,jk,ik->i", rows, self.inverse, rows)
            total += (signal - rows @ self.coefficients) ** 2 / (1 + leverage)
        return total

    def needed(self, places: Sequence[int]) -> int | None:
        """Return how many points at these settings, each as often as the others, tell the two apart; None: too many.

        ``times`` readings at every setting leave the rival ``left' (1 / times + R inverse R')^-1 left`` more than now,
        R its rows there and ``left`` what it gets wrong before it is fitted to them.
        """
        import numpy as np

        rows = np.concatenate([rows[list(places)] for rows in self.rows.values()])
        signal = np.concatenate([signal[list(places)] for signal in self.signal.values()])
        left, carried = signal - rows @ self.coefficients, rows @ self.inverse @ rows.T
        point = np.arange(len(rows)) % max(len(places), 1)
        counts: list[int] = [*range(1, len(places)), *range(len(places), MOST_POINTS + 1, len(places) or MOST_POINTS)]
        for count in counts:
            few = np.flatnonzero(point < count)
            normal = carried[np.ix_(few, few)] + np.eye(len(few)) / max(count // max(len(places), 1), 1)
            if self.separation + float(left[few] @ np.linalg.solve(normal, left[few])) >= APART:
                return count
        return None

    def measure(self, place: int) -> None:
        """Add one setting to the data: the rival refits (exact rank-one update)."""
        for name, signal in self.signal.items():
            row = self.rows[name][place]
            carried = self.inverse @ row
            scale = 1 + float(row @ carried)
            left = float(signal[place] - row @ self.coefficients)
            self.separation += left**2 / scale
            self.coefficients = self.coefficients + carried * (left / scale)
            self.inverse = self.inverse - carried[:, None] * carried[None, :] / scale


@dataclass(frozen=True)
class Proposal:
    """Settings to measure, and the pairs of explanations that they do not tell apart, however often measured."""

    points: tuple[NextPoint, ...] = ()
    tied: tuple[tuple[str, str], ...] = ()


def next_points(full: Contest, winner: int, rivals: Sequence[int]) -> Proposal:
    """Return up to four settings that separate the winner and its rivals, with the reason for each.

    Shapes that nobody registered say nothing beyond the rows they were fitted to, so they are no rivals here. Of
    results along an axis nothing is proposed: what could be set there is a whole record.
    """
    places = [place for place in (winner, *rivals) if is_physical(full.found.hypotheses[place])][: RIVALS + 1]
    chosen = full.found.hypotheses[winner]
    twins = twins_of(full, chosen, full.solution(winner).coefficients.tolist()) if is_physical(chosen) else []
    if len(places) < 2 and not twins:
        return Proposal()
    fields = full.problem.machine.start.model.own_result_fields
    is_along = any(fields[name].along for name in full.problem.machine.records.measured)
    settings = {} if is_along else settings_of(full)
    named = [(twin, (_name_of(full, winner), _twin_name(full, winner, twin))) for twin in twins]
    duels: list[_Duel] = []
    if settings:
        there = _machine_there(full, settings)
        duels = [_duel(full, there, a, b) for a in places for b in places if not _is_part(full, a, b)]
        duels += [
            duel for twin, names in named for duel in _twin_duels(full, there, full.solution(winner), twin, names)
        ]
    live = _live(_live(duels))  # what cannot be told apart chooses no setting for the others
    every = [*_pairs(full, winner, places), *(names for _, names in named)]
    apart = {frozenset(duel.names) for duel in live}
    tied = tuple(pair for pair in dict.fromkeys(every) if frozenset(pair) not in apart)
    return Proposal(tuple(_points(full, settings, live)), tied)


def _live(duels: Sequence[_Duel]) -> list[_Duel]:
    """Return the duels of the pairs that the settings best for all of them tell apart, whichever is believed."""
    taken = _greedy(duels)
    tied = {frozenset(duel.names) for duel in duels if duel.needed(taken) is None}
    return [duel for duel in duels if frozenset(duel.names) not in tied]


def _pairs(full: Contest, winner: int, places: Sequence[int]) -> list[tuple[str, str]]:
    """Return the winner beside every rival, by name; where the winner has no name nothing is paired with it."""
    if winner not in places:
        return []
    return [(_name_of(full, winner), _name_of(full, place)) for place in places if place != winner]


def _name_of(full: Contest, place: int) -> str:
    return " + ".join(names_of(full.problem, full.found.hypotheses[place]))


def _twin_name(full: Contest, winner: int, twin: TwinTerm) -> str:
    """Return what the winner is called with one of its causes under its other name."""
    hypothesis = full.found.hypotheses[winner]
    replaced = full.problem.candidates[hypothesis.pieces[twin.piece].owner].name
    return " + ".join(twin.name if name == replaced else name for name in names_of(full.problem, hypothesis))


def _greedy(duels: Sequence[_Duel]) -> list[int]:
    """Return the places of the settings that separate most, one after another, none twice."""
    import numpy as np

    if not duels:
        return []
    now = [replace(duel) for duel in duels]
    found: list[int] = []
    for _ in range(POINTS):
        worth = np.sum([np.log1p(duel.separation + duel.gains()) for duel in now], axis=0)
        worth[found] = -np.inf
        place = int(np.argmax(np.where(np.isfinite(worth), worth, -np.inf)))
        if not np.isfinite(worth[place]):
            break
        found.append(place)
        for duel in now:
            duel.measure(place)
    return found


def _points(full: Contest, settings: Mapping[str, Matrix], live: Sequence[_Duel]) -> Iterator[NextPoint]:
    """Give the settings with what they are for, and how many like them are needed to tell all pairs apart."""
    taken = _greedy(live)
    needed = max((duel.needed(taken) or MOST_POINTS for duel in live), default=0)
    for count, place in enumerate(taken, start=1):
        weakest = min(live, key=lambda duel: duel.separation)
        why = _why(full, settings, place, weakest)
        for duel in live:
            duel.measure(place)
        if count == len(taken) < needed:
            why += f"; {needed} points like these would be needed to tell them apart"
        least = min(duel.separation for duel in live)
        yield NextPoint(_amounts(full, settings, place), weakest.names, why, least, needed=needed)


def _is_part(full: Contest, believed: int, rival: int) -> bool:
    """Whether a rival is the believed explanation itself, or that with something added: it is never wrong then."""
    return set(full.found.hypotheses[believed].key) <= set(full.found.hypotheses[rival].key)


def _machine_there(full: Contest, settings: Mapping[str, Matrix]) -> Machine:
    """Return the machine at the settings that are tried."""
    import numpy as np

    machine = full.problem.machine
    count = len(next(iter(settings.values())))
    columns = {
        name: np.full(count, _middle(values))
        for name, values in machine.records.rows.columns.items()
        if _is_number(values)
    }
    columns |= settings
    zeros = np.zeros(count, dtype=np.intp)
    rows = RowsFile("", columns, {}, {}, tuple(range(count)))
    covariates = {name: replace(machine.records.covariates[name], values=values) for name, values in settings.items()}
    records = Records(
        files=machine.records.files,
        rows=rows,
        file_of=zeros,
        run_of=zeros,
        lines=np.arange(count),
        measured={name: np.zeros(count) for name in machine.records.measured},
        sigma={},
        covariates=covariates,
        held_out=np.zeros(count, dtype=bool),
        absent=machine.records.absent,
    )
    return machine_of(machine.start, records)


def _is_number(values: object) -> bool:
    import numpy as np

    return isinstance(values, np.ndarray) and values.dtype.kind == "f"


def _middle(values: object) -> float:
    import numpy as np

    return float(np.nanmedian(np.asarray(values, dtype=float)))


def _duel(full: Contest, there: Machine, believed: int, rival: int) -> _Duel:
    """Set up one believed explanation against one rival, with the rival refitted to the data there is."""
    import numpy as np

    true, other = full.solution(believed), full.solution(rival)
    evidence = full.evidence
    k = evidence.directions.shape[1]
    chosen = [products[place].matrix for products, place in zip(evidence.products, true.setting, strict=True)]
    total = np.asarray(sum(chosen[1:], chosen[0]))
    own = [*range(1, 1 + k), *(1 + k + column for column in other.hypothesis.columns)]
    normal = total[np.ix_(own, own)].copy()
    normal[:k, :k] += np.eye(k)
    normal += 1e-9 * np.diag(np.diag(normal))
    theirs = [1 + k + column for column in true.hypothesis.columns]
    cross = total[np.ix_(own, theirs)] @ true.coefficients
    inverse: Matrix = np.asarray(np.linalg.inv(normal), dtype=np.float64)
    size = float(true.coefficients @ total[np.ix_(theirs, theirs)] @ true.coefficients)
    signal, rows = {}, {}
    for place, channel in enumerate(evidence.channels):
        spread = channel.scale * np.sqrt(SETTINGS[true.setting[place]].variance_ratio)
        a, b = (_columns_there(full, there, each, channel.name) for each in (true, other))
        signal[channel.name] = a @ true.coefficients / spread
        u = there.slopes[channel.name] @ evidence.directions
        rows[channel.name] = np.concatenate([u, b], axis=1) / spread
    names = tuple(" + ".join(names_of(full.problem, each.hypothesis)) for each in (true, other))
    return _Duel(
        (names[0], names[1]), max(0.0, size - float(cross @ inverse @ cross)), inverse @ cross, inverse, signal, rows
    )


def _twin_duels(
    full: Contest, there: Machine, solution: Solution, twin: TwinTerm, names: tuple[str, str]
) -> list[_Duel]:
    """Set up a named cause against one of the same curve here; none where no setting within reach tells them apart."""
    import numpy as np

    piece = solution.hypothesis.pieces[twin.piece]
    before = sum(len(each.columns) for each in solution.hypothesis.pieces[: twin.piece])
    own = slice(before, before + len(piece.columns))
    curves = list(zip(twin.term.curves, new_curves(there, twin.candidate, twin.term), twin.term.per, strict=True))
    expected, here = (
        believed(full, machine, piece, solution.coefficients[own]) for machine in (there, full.problem.machine)
    )
    k = full.evidence.directions.shape[1]
    normal, cross, size = np.zeros((k + len(curves),) * 2), np.zeros(k + len(curves)), 0.0
    signal, rows = {}, {}
    for place, channel in enumerate(full.evidence.channels):
        setting = SETTINGS[solution.setting[place]]
        rival = np.column_stack([curve[channel.name][channel.rows] * (per / channel.scale) for curve, _, per in curves])
        made = np.column_stack([channel.directions, rival, here[channel.name][channel.rows] / channel.scale])
        white = whiten(made * channel.weights[:, None], channel.starts, setting)
        normal, cross = normal + white[:, :-1].T @ white[:, :-1], cross + white[:, :-1].T @ white[:, -1]
        size += float(white[:, -1] @ white[:, -1])
        spread = channel.scale * np.sqrt(setting.variance_ratio)
        signal[channel.name] = expected[channel.name] / spread
        u = there.slopes[channel.name] @ full.evidence.directions
        new = np.column_stack([curve[channel.name] * per for _, curve, per in curves])
        rows[channel.name] = np.concatenate([u, new], axis=1) / spread
    prior = np.diag([1.0] * k + [0.0] * len(curves)) + 1e-9 * np.diag(np.diag(normal))
    inverse: Matrix = np.asarray(np.linalg.inv(normal + prior), dtype=np.float64)
    start = inverse @ cross
    duel = _Duel(names, max(0.0, size - float(cross @ start)), start, inverse, signal, rows)
    return [duel] if float(np.nanmax(duel.gains(), initial=0.0)) > FAINTEST else []


def _columns_there(full: Contest, there: Machine, solution: Solution, name: str) -> Matrix:
    """Return the columns of an explanation at the settings that are tried, SI per coefficient, shape (T, k)."""
    import numpy as np

    problem = full.problem
    made: list[Matrix] = []
    for piece in solution.hypothesis.pieces:
        if piece.kind == "input":
            given = problem.machine.inputs[piece.owner]
            place = next(number for number, item in enumerate(there.inputs) if item.name == given.name)
            made.append(there.slopes[name][:, place])
            continue
        term = problem.terms[piece.place]
        curves = new_curves(there, problem.candidates[piece.owner], term)
        made += [curve[name] * per for curve, per in zip(curves, term.per, strict=True)]
    return np.column_stack(made)


def _amounts(full: Contest, settings: Mapping[str, Matrix], place: int) -> dict[str, Amount]:
    start = full.problem.machine.start
    known = start.model.known_conditions
    return {
        name: Amount(float(values[place]), known[name].unit if name in known else start.print_unit(name))
        for name, values in settings.items()
    }


def _followed(full: Contest, names: Sequence[str]) -> set[str]:
    """Return the conditions and inputs that the effects of two explanations follow."""
    known = full.problem.machine.start.model.known_effects
    effects = [known[each] for name in names for each in name.split(" + ") if each in known]
    return {key for effect in effects for key in (*(need.name for need in effect.needs), *effect.reads)}


def _why(full: Contest, settings: Mapping[str, Matrix], place: int, duel: _Duel) -> str:
    """Say what makes a setting worth measuring: where it leaves the record, and how far the two then differ."""
    import numpy as np

    evidence, units = full.evidence, full.problem.machine.start
    gaps = {
        channel.name: abs(float(duel.signal[channel.name][place] - duel.rows[channel.name][place] @ duel.coefficients))
        for channel in evidence.channels
    }
    name = max(gaps, key=lambda key: gaps[key])
    channel = next(each for each in evidence.channels if each.name == name)
    unit = readable_unit(units.print_unit(name), channel.scale)
    words = f"{duel.names[0]} and {duel.names[1]} there differ by {in_unit(gaps[name] * channel.scale, unit)} in {name}"
    farthest, reach = "", 0.0
    asked = _followed(full, duel.names)
    for key, values in settings.items():
        if asked and key not in asked:
            continue
        item = full.problem.machine.records.covariates[key]
        low, high = float(np.nanmin(item.values)), float(np.nanmax(item.values))
        out = max(low - values[place], values[place] - high) / max(high - low, 1e-300)
        if out > max(reach, 0.05):
            farthest, reach = key, float(out)
    if not farthest:
        return words
    item = full.problem.machine.records.covariates[farthest]
    low, high = (float(from_si(each, item.unit)) for each in (np.nanmin(item.values), np.nanmax(item.values)))
    span = f"{format_number(low, 3)} to {format_number(high, 3)} {item.unit}".strip()
    return f"{words}; {farthest} was only {span} so far"
