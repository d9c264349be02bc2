"""The final fit: exact model, effects on, tolerated inputs free within their prior, unknowns within their bounds."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import exp, log, sqrt
from typing import TYPE_CHECKING, Any

from truing.diagnosis.candidates import Term, si_bounds
from truing.diagnosis.chords import one_side
from truing.diagnosis.columns import MANY, in_blocks
from truing.diagnosis.contest import Contest, names_of
from truing.diagnosis.hypotheses import Hypothesis, Piece
from truing.diagnosis.machine import Predicted, predict_each
from truing.diagnosis.noise import SETTINGS
from truing.diagnosis.residual import Residual
from truing.diagnosis.slopes import Jacobian, white_directions
from truing.errors import ConvergenceError
from truing.evaluate import effect_column
from truing.setup import Setup, SwitchedOn

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Matrix = NDArray[np.float64]

LEVEL = 0.975
FROM_BOUNDS = 0.03
LARGEST_LEVERAGE = 0.95
NEARER = 40
"""So often a start at which the model fails is halved: what is left of it is rounding."""
STEEPEST = 1e-12
SPARING: Mapping[str, Any] = {"tr_solver": "lsmr", "tr_options": {"atol": 1e-13, "btol": 1e-13}}
"""Of many rows the fit makes no copies of its derivatives."""


@dataclass(frozen=True)
class Parameter:
    """One number of the fit: a coefficient of a column, or a shape (as its logarithm where it is positive).

    ``piece`` is the place of the piece in the hypothesis; ``per`` turns a coefficient into SI.
    """

    piece: int
    name: str
    column: int
    per: float
    low: float
    high: float
    file: int = -1
    is_shape: bool = False
    is_log: bool = False


@dataclass(frozen=True)
class Fit:
    """The fitted explanation: parameters with covariance, directions, what the model then says, and what is left.

    ``covariance`` covers all parameters and directions, scaled for clipping and unequal spread; ``freedom`` is the
    number of independent rows left. ``predicted`` is SI on all rows of the records, ``innovations`` by channel.
    """

    hypothesis: Hypothesis
    setting: tuple[int, ...]
    parameters: tuple[Parameter, ...]
    values: Matrix
    directions: Matrix
    covariance: Matrix
    freedom: float
    predicted: Predicted
    innovations: tuple[Matrix, ...]

    def si_value(self, place: int) -> float:
        """Return a parameter in SI."""
        item = self.parameters[place]
        value = float(self.values[place])
        return exp(value) if item.is_log else value * item.per


class Fitter:
    """The exact model of one explanation as a function of its parameters and of the directions of the inputs."""

    def __init__(self, contest: Contest, hypothesis: Hypothesis) -> None:
        self.contest, self.hypothesis = contest, hypothesis
        self.machine = contest.problem.machine
        self.parameters = tuple(_parameters(contest, hypothesis))
        self.setup = self._switched_on()

    def _terms(self) -> list[tuple[int, Piece, Term]]:
        terms = self.contest.problem.terms
        pieces = enumerate(self.hypothesis.pieces)
        return [(place, piece, terms[piece.place]) for place, piece in pieces if piece.kind == "term"]

    def _switched_on(self) -> Setup:
        """Return the setup with every cause on, at zero; parts of one effect are on together."""
        start, problem = self.machine.start, self.contest.problem
        values: dict[str, dict[str, float]] = {}
        for _, piece, term in self._terms():
            candidate = problem.candidates[piece.owner]
            own = values.setdefault(candidate.name, {})
            own |= {unknown.name: 0.0 for unknown in candidate.amplitudes} | dict(term.shape)
        known, before = start.model.known_effects, {item.effect.name: item.values for item in start.effects}
        for name, own in values.items():
            if known[name].place != "reading" or name in start.model.effects:
                stated = {*own, *before.get(name, ())}
                missing = [unknown for unknown in known[name].unknowns if unknown.name not in stated]
                own |= {each.name: 0.0 if each.is_amplitude else si_bounds(each)[0] for each in missing}
        on = tuple(SwitchedOn(known[name], own) for name, own in values.items())
        return start.with_effects(on)

    def columns(self, x: Matrix, u: Matrix) -> dict[str, Any]:
        """Return the columns that set every unknown and every input, SI: one value for all rows or one per row."""
        import numpy as np

        files, problem = self.machine.records.file_of, self.contest.problem
        found: dict[str, Any] = {}
        off = self.contest.evidence.directions @ u if len(u) else np.zeros(len(self.machine.inputs))
        for given, moved in zip(self.machine.inputs, off, strict=True):
            at = float(self.machine.start.nominal(given.name)) + given.mean + moved * given.sd
            found[given.name] = _in_file(found.get(given.name), given.file, files, at)
        for item, value in zip(self.parameters, x, strict=True):
            piece = self.hypothesis.pieces[item.piece]
            if piece.kind == "term":
                name = effect_column(problem.candidates[piece.owner].name, item.name)
                si = exp(value) if item.is_log else float(value) * item.per
                found[name] = _in_file(found.get(name), item.file, files, si)
            elif piece.kind == "input":
                owner = self.machine.inputs[piece.owner]
                added = np.where((files == owner.file) | (owner.file < 0), float(value) * owner.sd, 0.0)
                found[owner.name] = found[owner.name] + added
        return {name: np.broadcast_to(np.asarray(value, dtype=float), (len(files),)) for name, value in found.items()}

    def predicted(self, x: Matrix, u: Matrix) -> dict[str, Matrix]:
        """Return the extended model at every row, SI, by result."""
        return next(self.predicted_at([(x, u)]))

    def predicted_at(self, points: Sequence[tuple[Matrix, Matrix]]) -> Iterator[dict[str, Matrix]]:
        """Give the extended model at several points, each parameters and directions, as few calls of the model."""
        made = predict_each(self.setup, self.machine.records, [self.columns(x, u) for x, u in points])
        for (x, _), each in zip(points, made, strict=True):
            yield {name: values + self.shape_part(x, name) for name, values in each.items()}

    def shape_part(self, x: Matrix, name: str) -> Any:
        """Return what unregistered shapes add to a result, SI: an array (n,), or 0 where there are none."""
        added: Any = 0.0
        for item, value in zip(self.parameters, x, strict=True):
            if self.hypothesis.pieces[item.piece].kind == "shape":
                column = self.contest.problem.columns[item.column]
                if name in column.parts:
                    added = added + column.parts[name] * (column.per * value)
        return added


def _in_file(held: Any, file: int, files: Any, value: float) -> Any:
    """Return a value for all rows, or one per row that holds in its file."""
    import numpy as np

    if file < 0:
        return value
    before = np.zeros(len(files)) if held is None else np.broadcast_to(held, (len(files),))
    return np.where(files == file, value, before)


def _parameters(contest: Contest, hypothesis: Hypothesis) -> list[Parameter]:
    found: list[Parameter] = []
    for place, piece in enumerate(hypothesis.pieces):
        for column, low, high, place_in in zip(
            piece.columns, piece.low, piece.high, range(len(piece.columns)), strict=True
        ):
            per, name, file = contest.problem.columns[column].per, str(place_in), -1
            if piece.kind == "term":
                term = contest.problem.terms[piece.place]
                name, file = term.unknowns[place_in], term.files[place_in]
                low, high = term.low[place_in], term.high[place_in]
                if term.at:  # a chord stands for sizes near its own; the exact model is not bound to them
                    low, high = (end / per for end in one_side(contest.problem.candidates[piece.owner], term.at))
            found.append(Parameter(place, name, column, per, low, high, file))
        if piece.kind == "term":
            found += _shapes(contest, place, piece)
    return found


def _shapes(contest: Contest, place: int, piece: Piece) -> list[Parameter]:
    """Return the shapes that can be moved smoothly; whole numbers and places of a step stay where they are."""
    candidate = contest.problem.candidates[piece.owner]
    found = []
    for unknown in candidate.shapes:
        if unknown.whole or unknown.along:
            continue
        low, high = si_bounds(unknown)
        is_log = low > 0
        bounds = (log(low), log(high)) if is_log else (low, high)
        found.append(Parameter(place, unknown.name, -1, 1.0, *bounds, is_shape=True, is_log=is_log))
    return found


def fit(contest: Contest, place: int) -> Fit:
    """Fit one of the hypotheses of a contest with the exact model."""
    import numpy as np
    from scipy.optimize import least_squares

    hypothesis, setting = contest.found.hypotheses[place], contest.found.setting[place]
    solution = contest.solution(place)
    fitter = Fitter(contest, hypothesis)
    start = np.concatenate([_start(fitter, solution.coefficients), solution.directions])
    p = len(fitter.parameters)
    residual = Residual(contest, fitter, setting)
    low = np.array([item.low for item in fitter.parameters] + [-np.inf] * (len(start) - p))
    high = np.array([item.high for item in fitter.parameters] + [np.inf] * (len(start) - p))
    way: Mapping[str, Any] = {"bounds": (low, high), "x_scale": "jac", "xtol": 1e-10, "ftol": 1e-12}
    way = {**way, **(SPARING if contest.evidence.rows > MANY else {})}
    jacobian = Jacobian(fitter.parameters, residual, white_directions(contest, setting))
    start = _that_works(residual, np.clip(start, low, high))
    found = least_squares(residual, start, jac=jacobian, **way)
    if jacobian.is_off(found.x):
        jacobian.is_exact = True
        inside = _inside(found.x, low, high)
        again = inside if np.isfinite(residual(inside)).all() else found.x
        found = least_squares(residual, again, jac=jacobian, **way)
    covariance, freedom = _covariance(contest, found.fun, np.asarray(found.jac), setting)
    left = _split(contest, found.fun)
    predicted = fitter.predicted(found.x[:p], found.x[p:])
    return Fit(hypothesis, setting, fitter.parameters, found.x[:p], found.x[p:], covariance, freedom, predicted, left)


def is_off(contest: Contest, found: Fit) -> bool:
    """Whether the inputs of a fit have moved farther than the model is linear in them."""
    import numpy as np

    fitter = Fitter(contest, found.hypothesis)
    residual = Residual(contest, fitter, found.setting)
    jacobian = Jacobian(fitter.parameters, residual, white_directions(contest, found.setting))
    return jacobian.is_off(np.concatenate([found.values, found.directions]))


def _that_works(residual: Residual, start: Matrix) -> Matrix:
    """Return a start at which the model does not fail: the linear one, or so much nearer to no cause at all.

    Shapes stay where they are. Raises ConvergenceError where the model fails with the explanation however small it is.
    """
    import numpy as np

    is_shape = np.zeros(len(start), dtype=bool)
    is_shape[: residual.p] = [item.is_shape for item in residual.fitter.parameters]
    for halving in range(NEARER):
        tried = np.where(is_shape, start, start / 2**halving)
        if np.isfinite(residual(tried)).all():
            return tried
    names = " and ".join(names_of(residual.contest.problem, residual.fitter.hypothesis)) or "no effect at all"
    raise ConvergenceError(f"the model fails with {names}, however small")


def _inside(x: Matrix, low: Matrix, high: Matrix) -> Matrix:
    """Return a start a little inside its bounds: what begins beside one hardly leaves it."""
    import numpy as np

    reach = np.where(np.isfinite(high - low), FROM_BOUNDS * (high - low), 0.0)
    return np.clip(x, low + reach, high - reach)


def shape_part(contest: Contest, found: Fit, name: str) -> Any:
    """Return what the unregistered shapes of a fit add to a result, SI: an array (n,), or 0 where there are none."""
    return Fitter(contest, found.hypothesis).shape_part(found.values, name)


def _start(fitter: Fitter, coefficients: Matrix) -> Matrix:
    """Return where the fit begins: the linear solution, and the grid's value of every shape."""
    import numpy as np

    values, given = [], iter(coefficients)
    for item in fitter.parameters:
        if not item.is_shape:
            values.append(float(next(given)))
            continue
        piece = fitter.hypothesis.pieces[item.piece]
        value = fitter.contest.problem.terms[piece.place].shape[item.name]
        values.append(log(value) if item.is_log else value)
    return np.array(values)


def _split(contest: Contest, residual: Matrix) -> tuple[Matrix, ...]:
    import numpy as np

    ends = np.cumsum([len(channel) for channel in contest.evidence.channels])
    return tuple(np.split(residual[: ends[-1]], ends[:-1]))


def _covariance(contest: Contest, residual: Matrix, jacobian: Matrix, setting: tuple[int, ...]) -> tuple[Matrix, float]:
    """Return the covariance of all parameters, and the number of independent rows left.

    The larger of the model-based one and the sandwich (HC3), parameter by parameter; widened by the share of clipped
    innovations, as for any robust estimate.
    """
    import numpy as np

    rows = contest.evidence.rows
    inverse = np.linalg.pinv(jacobian.T @ jacobian)
    k = contest.evidence.directions.shape[1]
    used = float(np.trace(inverse @ (jacobian[:rows].T @ jacobian[:rows])))
    sigma2 = float(np.sum(residual[:rows] ** 2)) / max(rows - used, 1.0)
    plain = inverse * sigma2
    spread = np.zeros_like(inverse)
    for block in in_blocks(rows):
        own = jacobian[block]
        leverage = np.minimum(np.einsum("ij,ij->i", own @ inverse, own), LARGEST_LEVERAGE)
        scores = own * (residual[block] / (1 - leverage))[:, None]
        spread += scores.T @ scores
    prior = np.zeros_like(inverse)
    if k:
        prior[-k:, -k:] = np.eye(k)
    sandwich = inverse @ (spread + sigma2 * prior) @ inverse
    ratio = np.sqrt(np.maximum(np.diag(sandwich) / np.maximum(np.diag(plain), 1e-300), 1.0))
    clipped = max(contest.noise.tails[channel.name].clipped for channel in contest.evidence.channels)
    shares = [SETTINGS[place].independent_share for place in setting]
    counts = [len(channel) for channel in contest.evidence.channels]
    free = sum(share * count for share, count in zip(shares, counts, strict=True)) - used
    return plain * np.outer(ratio, ratio) / (1 - clipped) ** 2, max(free, 2.0)


def interval(found: Fit, place: int) -> tuple[float, float]:
    """Return the 95 % interval of a parameter in SI, within its bounds."""
    from scipy.special import stdtrit

    item = found.parameters[place]
    reach = float(stdtrit(found.freedom, LEVEL)) * sqrt(max(float(found.covariance[place, place]), 0.0))
    value = float(found.values[place])
    low, high = max(value - reach, min(item.low, value)), min(value + reach, max(item.high, value))
    return (exp(low), exp(high)) if item.is_log else (low * item.per, high * item.per)


def may_be_zero(found: Fit, piece: int) -> bool:
    """Tell whether the 95 % interval of every amplitude of a cause contains zero."""
    own = [place for place, item in enumerate(found.parameters) if item.piece == piece and not item.is_shape]
    ends = [interval(found, place) for place in own]
    return all(low <= 0 <= high for low, high in ends)


def si_covariance(found: Fit, places: Sequence[int]) -> tuple[tuple[float, ...], ...]:
    """Return the covariance of some parameters in SI."""
    import numpy as np

    factors = np.array(
        [found.si_value(place) if found.parameters[place].is_log else found.parameters[place].per for place in places]
    )
    part = found.covariance[np.ix_(list(places), list(places))] * np.outer(factors, factors)
    return tuple(tuple(float(value) for value in row) for row in part)


def input_values(contest: Contest, found: Fit) -> Mapping[str, tuple[float, float]]:
    """Return every tolerated input as calibrated, SI, and how far it moved in units of its sd (the first file's)."""
    directions = contest.evidence.directions
    machine = contest.problem.machine
    moved = directions @ found.directions if directions.size else [0.0] * len(machine.inputs)
    extra = {
        found.hypothesis.pieces[item.piece].owner: float(value)
        for item, value in zip(found.parameters, found.values, strict=True)
        if found.hypothesis.pieces[item.piece].kind == "input"
    }
    answer: dict[str, tuple[float, float]] = {}
    for place, item in enumerate(machine.inputs):
        off = float(moved[place]) + extra.get(place, 0.0)
        value = float(machine.start.nominal(item.name)) + item.mean + off * item.sd
        answer.setdefault(item.name, (value, (value - item.design) / item.sd))
    return answer
