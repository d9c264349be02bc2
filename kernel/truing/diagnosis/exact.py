"""Exact fits: an explanation with the model itself, numbers within their bounds, inputs within their tolerances.

Levenberg-Marquardt steps on the numbers of the causes. The inputs are eliminated from every step: as far as the fit
goes they act by their slopes about an anchor, which is moved when the fit has settled and the model bends in them.
Derivatives are taken by differences in one batched call and corrected by what each step shows (C. G. Broyden, Math.
Comp. 19, 1965, 577) until that no longer leads down. The noise of every result is the one that is left: the logarithm
of its mean square is what a fit makes small.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import Any, TypeVar

import numpy as np
from scipy.linalg.lapack import dgesv, dpotrf, dpotrs
from scipy.optimize import least_squares

from truing.arrays import Matrix
from truing.diagnosis.causes import Candidate, Parameter
from truing.diagnosis.extended import Extended, Predictions, Request, parts_of
from truing.diagnosis.fitted import STEP, Fit, inward, moved_by, size_of, steps_of
from truing.diagnosis.sample import Sample

T = TypeVar("T")
Asking = Generator[Request, Any, T]
"""Something that asks what the gauges show at some points, is sent the answers, and returns what it was to find."""

EXACTLY, CLOSELY, ROUGHLY = 1e-5, 1e-3, 1e-2
"""A fit ends where a step promises less than so much of the score."""
MOST_STEPS, MOST_ROUGH, MOST_ROUGH_AT_ONCE = 40, 12, 6
"""So many steps are taken to an exact end, and to a rough one; of these with all derivatives at every point."""
MOVED = 0.1
"""Sum of squares, in units of the noise, that slopes of the inputs may miss before their anchor is moved."""
MOST_ANCHORS = 3
"""So often the slopes of the inputs are taken anew where a fit has put these."""
ASIDE = 0.05
"""Standard deviations to each side by which an input is moved for its slope where a fit has put it."""
MOST_NOISE_ROUNDS, FAILED = 5, 1e6
"""So often the noise is taken anew where numbers and inputs are fitted at once; what is left where the model fails."""
WAYS = (1.0, 0.5, 0.25, 0.1)
"""Of the way that the slopes promise, how far the anchor goes: where the model bends, the whole way may lead up."""
MOST_INPUT_ROUNDS, INPUTS_SETTLED = 20, 1e-7
"""Inputs go with the noise that they leave when a round gains less than so much of the score."""
NEXT_TO, WIDER, FURTHER_DAMPED = 1e-4, 0.1, 10
"""Where all derivatives are taken at once: standard deviations by which an input is moved, so many times the step of a
number, as errors of a followed state are small beside them; and how much more a step is damped that led up."""
NEARER = 30
"""So often a start at which the model fails is halved: what is left of it is rounding."""
FIRST_DAMPING, LARGEST_DAMPING = 1e-3, 1e8
"""Of a step, in units of the curvature: where it begins, and where no step is left that leads down."""
MOST_KEPT = 1_000_000
"""So many derivatives by the inputs are kept with a fit; on a longer record they are made anew where asked for."""
GOOD = 0.25
"""Share of what a step promised from which on its corrected derivatives are good enough for the next one."""


def alone(extended: Extended, asking: Asking[T]) -> T:
    """Return what one finds that asks by itself."""
    (made,) = together(extended, [asking])
    return made


def together(extended: Extended, several: Sequence[Asking[T]]) -> list[T]:
    """Return what each of several finds; what they ask at one time is one call of the model where it can be."""
    ended: dict[int, T] = {}
    answers: dict[int, Predictions | None] = dict.fromkeys(range(len(several)))
    while answers:
        requests: dict[int, Request] = {}
        for index, answer in answers.items():
            try:
                requests[index] = several[index].send(answer)
            except StopIteration as end:
                ended[index] = end.value
        answers = dict(zip(requests, extended.at_each(list(requests.values())), strict=True))
    return [ended[index] for index in range(len(several))]


def fitting(
    sample: Sample,
    extended: Extended,
    causes: Sequence[Candidate],
    values: Sequence[Matrix],
    near: Fit | None = None,
    *,
    until: float = EXACTLY,
    held: Sequence[Parameter] = (),
) -> Asking[Fit | None]:
    """Fit an explanation from a start: numbers of every cause, SI.

    Numbers in ``held`` keep their start. ``near`` is a fit to begin with: its inputs, what they draw, and what its
    numbers draw where it is of the same causes. None where the model fails however small the causes are.
    """
    state = Fitting(sample, extended, tuple(causes), near, held=held)
    if not (yield from state.begin(np.concatenate(values) if causes else np.zeros(0))):
        return None
    if near is not None and near.slopes and near.causes == state.causes and not extended.grain:
        state.carry(near.slopes)
    yield from state.settle(until)
    return state.answer()


def refitting(fit: Fit, sample: Sample, extended: Extended, *, until: float = ROUGHLY) -> Asking[Fit | None]:
    """Fit an explanation again from where it is: in other noise, or to other rows."""
    return fitting(sample, extended, fit.causes, fit.values, fit, until=until)


def held_without(fit: Fit, index: int, sample: Sample, extended: Extended) -> Fit:
    """Return an explanation without one of its causes, all else held where it is."""
    causes, values = fit.less(index)
    (predicted,) = extended.at(causes, [(values, fit.moved)])
    return replace(fit, causes=causes, values=values, predicted=predicted, slopes={}, moves={}).in_sample(sample)


@dataclass(frozen=True)
class _Looked:
    """A point, numbers as the fit sees them and directions: what the model shows there, and its derivatives, SI."""

    u: Matrix
    b: Matrix
    shown: dict[str, Matrix]
    drawn: dict[str, Matrix]
    moves: dict[str, Matrix]
    left: Matrix
    cost: float


class Fitting:
    """One fit on its way: the numbers as the fit sees them, what is left, and its derivatives."""

    def __init__(
        self,
        sample: Sample,
        extended: Extended,
        causes: tuple[Candidate, ...],
        near: Fit | None,
        *,
        held: Sequence[Parameter],
    ) -> None:
        self.sample, self.extended, self.causes = sample, extended, causes
        self.numbers = [number for cause in causes for number in cause.numbers]
        sizes = {channel.name: channel.scale for channel in sample.channels}
        self.sizes = np.array([size_of(number, sizes) for number in self.numbers])
        ends = [inward(number, size) for number, size in zip(self.numbers, self.sizes, strict=True)]
        self.low, self.high = (np.array([end[side] for end in ends]) for side in (0, 1))
        self.free = np.array([n.is_free and not any(n is each for each in held) for n in self.numbers], dtype=bool)
        self.log = np.array([number.is_log for number in self.numbers], dtype=bool)
        moves = near.moves if near is not None and near.sample.directions is sample.directions else {}
        self.moves = moves or sample.moves
        self.slopes = sample.drawn if self.moves is sample.moves else sample.curve(self.moves)
        is_alike = near is not None and len(near.inputs) == self.slopes.shape[1]
        self.anchor = np.array(near.inputs) if near is not None and is_alike else np.zeros(self.slopes.shape[1])
        self.is_at_once = extended.is_moving and not extended.grain
        self.damping = FIRST_DAMPING
        self.drawn: dict[str, Matrix] = {}
        self.predicted: dict[str, Matrix] = {}
        self.is_fresh = False

    def outward(self, u: Matrix) -> Matrix:
        """Return numbers in SI."""
        return np.where(self.log, np.exp(np.where(self.log, u, 0.0)), u * self.sizes)

    def asked(self, points: Sequence[Matrix], anchor: Matrix) -> Request:
        """Return several points, with the inputs at an anchor, as the model is asked for them."""
        moved = moved_by(self.sample, anchor)
        return self.causes, [(parts_of(self.causes, self.outward(u)), moved) for u in points]

    def bare(self, shown: dict[str, Matrix]) -> Matrix:
        """Return what is left if the inputs were at their means, as far as their slopes tell."""
        return self.sample.left(shown) + self.slopes @ self.anchor

    def begin(self, values: Matrix) -> Asking[bool]:
        """Take a start, or so much nearer to no cause that the model does not fail; False where it always does."""
        u = np.where(self.log, np.log(np.where(self.log, values, 1.0)), values / self.sizes)
        u = np.clip(u, self.low, self.high)
        amplitudes = np.array([number.is_amplitude for number in self.numbers], dtype=bool)
        for halving in range(NEARER):
            tried = np.where(amplitudes, u / 2**halving, u)
            shown, *_ = yield self._around(tried, self.anchor) if self.is_at_once else self.asked([tried], self.anchor)
            bare = self.bare(shown)
            if np.isfinite(bare).all():
                self.u, self.predicted, self.b = tried, shown, self.anchor
                self.b, self.left, self.cost = self.calibrated(bare)
                return True
        return False

    def calibrated(self, bare: Matrix) -> tuple[Matrix, Matrix, float]:
        """Return the inputs that go best with what is left without them, what is then left, and its cost."""
        b = self.b
        left = bare - self.slopes @ b
        squares = self.sample.squares(left)
        for _ in range(MOST_INPUT_ROUNDS if len(b) else 0):
            roots = self.sample.roots(left, squares)
            weighted = self.slopes * roots[:, None]
            downward = weighted.T @ (roots * left) - b
            *_, moved, _ = dgesv(_plus_one(weighted.T @ weighted), downward)  # numpy's checks take far longer
            b = b + self.sample.stride * moved
            left = bare - self.slopes @ b
            squares = self.sample.squares(left)
            if moved @ downward < INPUTS_SETTLED:
                break
        return b, left, self.sample.cost(left, b, squares)

    def derivatives(self) -> Asking[None]:
        """Take the derivatives of what the model shows by all free numbers, in one call of it."""
        places = np.flatnonzero(self.free)
        steps = steps_of(self.u, self.log, is_rough=bool(self.extended.grain))
        steps = np.where(self.u + steps > self.high, -steps, steps)
        points = [self.u + step * unit for step, unit in zip(steps[places], np.eye(len(self.u))[places], strict=True)]
        drawn = {name: np.zeros((len(base), len(self.u))) for name, base in self.predicted.items()}
        answers = (yield self.asked(points, self.anchor)) if points else []
        for index, shown in zip(places, answers, strict=True):
            if not np.isfinite(self.sample.left(shown)).all():
                shown = yield from self._other_side(int(index), float(steps[index]))
            for name, base in self.predicted.items():
                drawn[name][:, index] = (shown[name] - base) / steps[index]
        self._draw(drawn)
        self.is_fresh = True

    def _other_side(self, index: int, step: float) -> Asking[dict[str, Matrix]]:
        """Return what the model would show a step on, as the other side has it; what it shows where that fails too."""
        point = self.u.copy()
        point[index] -= step
        (shown,) = yield self.asked([point], self.anchor)
        if not np.isfinite(self.sample.left(shown)).all():
            return self.predicted
        return {name: 2 * base - shown[name] for name, base in self.predicted.items()}

    def _draw(self, drawn: dict[str, Matrix]) -> None:
        """Take derivatives, by result (n, numbers), SI per number as the fit sees it."""
        self.drawn, self.slope = drawn, -self.sample.curve(drawn, self.predicted)

    def carry(self, slopes: dict[str, Matrix]) -> None:
        """Begin with the derivatives of another fit, where they are known on these rows."""
        drawn = {name: each * np.where(self.log, 1.0, self.sizes) for name, each in slopes.items()}
        if np.isfinite(self.sample.curve(drawn)).all():
            self._draw(drawn)

    def step(self) -> tuple[Matrix, float]:
        """Return where a damped step leads within the bounds, and by how much the cost is to fall."""
        roots = self.sample.roots(self.left)
        slope, slopes = self.slope * roots[:, None], self.slopes * roots[:, None]
        right = -(roots * self.left)
        normal, gradient = slope.T @ slope, slope.T @ right
        if len(self.b):
            factor, cross = dpotrf(_plus_one(slopes.T @ slopes))[0], slopes.T @ slope  # not with scipy's checks
            normal = normal - cross.T @ dpotrs(factor, cross)[0]
            gradient = gradient - cross.T @ dpotrs(factor, slopes.T @ right + self.b)[0]
        curvature = normal.diagonal()
        damped = normal.copy()
        np.fill_diagonal(damped, curvature + (self.damping + 1e-12) * curvature)
        moved = np.zeros(len(self.u))
        active = self.free & (curvature > 0)
        for _ in range(len(self.u) + 1):
            if active.all():
                moved = _solved(damped, gradient)
            elif active.any():
                held = ~active
                target = gradient[active] - normal[active][:, held] @ moved[held]
                moved[active] = _solved(damped[active][:, active], target)
            else:
                break
            tried = self.u + moved
            beyond = ((tried < self.low) | (tried > self.high)) & active
            if not beyond.any():
                break
            moved = np.where(beyond, np.clip(tried, self.low, self.high) - self.u, moved)
            active = active & ~beyond
        promised = float(2 * gradient @ moved - moved @ normal @ moved)
        return moved, promised

    def settle(self, until: float) -> Asking[None]:
        """Step down until little is promised; then move the anchor of the inputs, where slopes miss what they do."""
        if self.is_at_once:
            yield from self._settle_at_once(until)
            return
        if until < ROUGHLY and len(self.b):  # with the causes on, and where the inputs begin
            yield from self._draw_inputs()
        bends = False
        for _ in range(MOST_ANCHORS):
            yield from self._descend(until)
            is_near = until >= ROUGHLY and float(np.abs(self.b - self.anchor).max(initial=0.0)) < 1.0
            if not len(self.b) or is_near or not (yield from self._anchored()):
                break
            bends = True
        if bends and until < ROUGHLY and not self.extended.grain:
            self._together(until)

    # Of a model of which many calculations take hardly longer than one: all derivatives at every point that is tried

    def _around(self, u: Matrix, b: Matrix) -> Request:
        """Return a point and its neighbours in every free number and in every direction of the inputs."""
        steps = self._steps(u)
        points = [(u, b), *((u + steps[index] * np.eye(len(u))[index], b) for index in np.flatnonzero(self.free))]
        points += [(u, b + NEXT_TO * unit) for unit in np.eye(len(b))]
        return self.causes, [self._setting(u, b) for u, b in points]

    def _setting(self, u: Matrix, b: Matrix) -> tuple[list[Matrix], Matrix]:
        """Return a point as the model is asked for it."""
        return parts_of(self.causes, self.outward(u)), moved_by(self.sample, b)

    def _steps(self, u: Matrix) -> Matrix:
        steps = WIDER * steps_of(u, self.log, is_rough=False)
        return np.asarray(np.where(u + steps > self.high, -steps, steps))

    def look_at(self, tried: Sequence[tuple[Matrix, Matrix]]) -> Asking[list[_Looked]]:
        """Return what the model shows at several points, with all derivatives there."""
        requests = [self._around(*each) for each in tried]
        answers = iter((yield self.causes, [point for _, points in requests for point in points]))
        looked = []
        for (u, b), (_, points) in zip(tried, requests, strict=True):
            shown, *several = (next(answers) for _ in points)
            left = self.sample.left(shown)
            cost = self.sample.cost(left, b) if np.isfinite(left).all() else inf
            places = np.flatnonzero(self.free)
            drawn, moves = {}, {}
            for name, base in shown.items():
                rises = np.column_stack([each[name] - base for each in several] or [np.zeros((len(base), 0))])
                rises = np.where(np.isfinite(rises), rises, 0.0)
                drawn[name] = np.zeros((len(base), len(u)))
                drawn[name][:, places] = rises[:, : len(places)] / self._steps(u)[places]
                moves[name] = rises[:, len(places) :] / NEXT_TO
            looked.append(_Looked(u, b, shown, drawn, moves, left, cost))
        return looked

    def stand_at(self, point: _Looked) -> None:
        """Go to a point."""
        self.u, self.anchor, self.b, self.predicted, self.moves = point.u, point.b, point.b, point.shown, point.moves
        self.slopes = self.sample.curve(point.moves, point.shown)
        self.left, self.cost = point.left, point.cost
        self._draw(point.drawn)

    def _ahead(self, damping: float, share: float) -> tuple[tuple[Matrix, Matrix], float]:
        """Return where a damped step leads, the inputs so much of their way, and the cost that is promised."""
        self.damping = damping
        standing = self.b, self.left
        bare = self.bare(self.predicted)
        self.b, self.left, _ = self.calibrated(bare)
        u = np.clip(self.u + self.step()[0], self.low, self.high)
        b, _, cost = self.calibrated(bare + self.slope @ (u - self.u))
        self.b, self.left = standing
        return (u, self.anchor + share * (b - self.anchor)), cost

    def _settle_at_once(self, until: float) -> Asking[None]:
        """Step down with numbers and inputs together until little is promised."""
        (now,) = yield from self.look_at([(self.u, self.anchor)])
        self.stand_at(now)
        damping = FIRST_DAMPING
        tries: Sequence[float] = WAYS[:1]
        for _ in range(MOST_STEPS if until < ROUGHLY else MOST_ROUGH_AT_ONCE):
            ahead = [self._ahead(damping * FURTHER_DAMPED**place, share) for place, share in enumerate(tries)]
            promised = self.cost - ahead[0][1]
            if promised < until or damping > LARGEST_DAMPING:
                return
            best = min((yield from self.look_at([point for point, _ in ahead])), key=lambda point: point.cost)
            gained = self.cost - best.cost
            if gained > 0:
                self.stand_at(best)
                damping = max(damping / 5, 1e-12) if gained > GOOD * promised else damping * 3
                tries = WAYS[:1]
                if gained < until:
                    return
            else:
                damping, tries = max(damping, 1e-6) * FURTHER_DAMPED ** len(tries), WAYS[1:]

    def _together(self, until: float) -> None:
        """Fit numbers and inputs at once, all with the model itself: where slopes of the inputs mislead."""
        places = np.flatnonzero(self.free)
        low = np.append(self.low[places], np.full(len(self.b), -np.inf))
        high = np.append(self.high[places], np.full(len(self.b), np.inf))
        for _ in range(MOST_NOISE_ROUNDS):
            roots = self.sample.roots(self.left)

            def weighted(x: Matrix, roots: Matrix = roots) -> Matrix:
                return np.asarray(self._weighted([x], roots)[0])

            def sloped(x: Matrix, roots: Matrix = roots) -> Matrix:
                steps = STEP * np.maximum(np.abs(x), 1.0)
                steps = np.where(x + steps > high, -steps, steps)
                here, *there = self._weighted([x, *(x + np.diag(steps))], roots)
                return np.asarray((np.column_stack(there) - here[:, None]) / steps)

            start = np.clip(np.append(self.u[places], self.b), low, high)
            solved = least_squares(
                weighted, start, sloped, (low, high), ftol=until / len(roots), x_scale="jac", max_nfev=MOST_STEPS
            )
            u, b = self._parted(solved.x)
            (shown,) = self.extended.at(*self.asked([u], b))
            left = self.sample.left(shown)
            cost = self.sample.cost(left, b) if np.isfinite(left).all() else inf
            if cost > self.cost - until:
                return
            self.u, self.b, self.anchor, self.predicted, self.left, self.cost = u, b, b, shown, left, cost

    def _parted(self, x: Matrix) -> tuple[Matrix, Matrix]:
        """Return the numbers and the inputs of a point at which free numbers and inputs stand one behind another."""
        u, size = self.u.copy(), int(self.free.sum())
        u[self.free] = x[:size]
        return u, x[size:]

    def _weighted(self, points: Sequence[Matrix], roots: Matrix) -> Matrix:
        """Return what is left at several points and how far the inputs are off there, (points, rows + K)."""
        parted = [self._parted(x) for x in points]
        settings = [self._setting(u, b) for u, b in parted]
        made = self.extended.at(self.causes, settings)
        left = [np.append(roots * self.sample.left(each), b) for each, (_, b) in zip(made, parted, strict=True)]
        return np.where(np.isfinite(left), left, FAILED)

    def _descend(self, until: float) -> Asking[None]:
        if not self.free.any():
            return
        self.damping = FIRST_DAMPING
        if not self.drawn:
            yield from self.derivatives()
        is_enough = until >= ROUGHLY and not self.extended.grain  # derivatives that were corrected, of a smooth model
        for _ in range(MOST_STEPS if until < ROUGHLY else MOST_ROUGH):
            moved, promised = self.step()
            if promised < until and (self.is_fresh or is_enough or promised < 1e-3 * until):
                if until < ROUGHLY and promised > 0:
                    yield from self._taken(moved)
                return
            if promised < until:
                yield from self.derivatives()
                continue
            gained = yield from self._taken(moved)
            if gained is None or gained <= 0:
                if not self.is_fresh:
                    yield from self.derivatives()
                elif self.damping < LARGEST_DAMPING:
                    self.damping = max(self.damping, 1e-6) * 10
                else:
                    return
                continue
            self.damping = max(self.damping / 5, 1e-12) if gained > GOOD * promised else self.damping * 3
            if gained < GOOD * promised and not self.is_fresh:
                yield from self.derivatives()
            elif gained < until and self.is_fresh:
                return

    def _taken(self, moved: Matrix) -> Asking[float | None]:
        """Take a step if it leads down, and correct the derivatives by what it shows; return how far it led down."""
        tried = np.clip(self.u + moved, self.low, self.high)
        (shown,) = yield self.asked([tried], self.anchor)
        bare = self.bare(shown)
        if not np.isfinite(bare).all():
            return None
        b, left, cost = self.calibrated(bare)
        gained = self.cost - cost
        if gained > 0:
            way = tried - self.u
            before = self.predicted
            self.u, self.predicted, self.b, self.left, self.cost = tried, shown, b, left, cost
            self._draw({name: _corrected(own, shown[name] - before[name], way) for name, own in self.drawn.items()})
            self.is_fresh = False
        return gained

    def _anchored(self) -> Asking[bool]:
        """Move the anchor to the inputs, or as far as leads down; whether the slopes missed enough to go on."""
        start, wanted = self.anchor, self.b
        before = self.sample.cost(self.sample.left(self.predicted), start)
        for share in WAYS:
            tried = start + share * (wanted - start)
            (shown,) = yield self.asked([self.u], tried)
            exact = self.sample.left(shown)
            cost = self.sample.cost(exact, tried) if np.isfinite(exact).all() else inf
            if cost <= before:
                break
        if cost == inf:
            return False
        missed = self.sample.roots(self.left) * (exact - self.left)
        is_off = bool(missed @ missed > MOVED)
        self.anchor, self.b, self.predicted, self.left, self.cost = tried, tried, shown, exact, cost
        if is_off:
            yield from self._draw_inputs()
        return is_off

    def _draw_inputs(self) -> Asking[None]:
        """Take the slopes of the inputs about the anchor, and the inputs that go best with them."""
        self.slopes = yield from self.slopes_of_inputs()
        self.b, self.left, self.cost = self.calibrated(self.bare(self.predicted))

    def slopes_of_inputs(self) -> Asking[Matrix]:
        """Return what the directions of the inputs draw about the anchor, (rows, K), in one call of the model."""
        k, own = len(self.anchor), parts_of(self.causes, self.outward(self.u))
        aside = 10 * ASIDE if self.extended.grain else ASIDE
        ends = [self.anchor + sign * aside * np.eye(k)[index] for index in range(k) for sign in (1, -1)]
        made = yield self.causes, [(own, moved_by(self.sample, end)) for end in ends]
        for name, before in self.moves.items() if made else ():
            rises = zip(made[::2], made[1::2], strict=True)
            taken = np.column_stack([(up[name] - down[name]) / (2 * aside) for up, down in rises])
            self.moves = {**self.moves, name: np.where(np.isfinite(taken), taken, before)}
        return self.sample.curve(self.moves, self.predicted)

    def answer(self) -> Fit:
        """Return the fit, its predictions with the inputs where they are."""
        moved = self.b - self.anchor
        predicted = {name: shown + self.moves[name] @ moved for name, shown in self.predicted.items()}
        values = tuple(parts_of(self.causes, self.outward(self.u)))
        slopes = {name: each / np.where(self.log, 1.0, self.sizes) for name, each in self.drawn.items()}
        moves = self.moves if sum(each.size for each in self.moves.values()) <= MOST_KEPT else {}
        return Fit(self.causes, values, self.b, predicted, self.left, self.cost, self.sample, slopes, moves)


def _corrected(slopes: Matrix, change: Matrix, way: Matrix) -> Matrix:
    """Return derivatives (n, numbers) that agree with what a step along ``way`` changed."""
    return slopes + np.outer(change - slopes @ way, way) / max(float(way @ way), 1e-300)


def _plus_one(square: Matrix) -> Matrix:
    """Add the unit matrix to a matrix (k, k), in place."""
    square.reshape(-1)[:: len(square) + 1] += 1.0
    return square


def _solved(normal: Matrix, right: Matrix) -> Matrix:
    scale = np.sqrt(np.maximum(normal.diagonal(), 1e-300))
    return np.asarray(np.linalg.lstsq(normal / np.outer(scale, scale), right / scale, rcond=1e-14)[0] / scale)


def nothing(sample: Sample, extended: Extended) -> Fit:
    """Return the model as it is, calibrated as far as tolerances and its own misfit make likely."""
    fit = alone(extended, fitting(sample, extended, (), ()))
    if fit is None:
        raise ArithmeticError("the model fails with its inputs at their means")
    return fit


# What numbers and inputs draw about a fit: the derivatives of what the model shows


def slopes_at(fit: Fit, extended: Extended) -> tuple[Matrix, Matrix]:
    """Return the derivatives of what a fit predicts, by its numbers and by the directions, in units of the noise.

    Shapes (rows, numbers) per unit of the number as the fit sees it, 0 for what keeps its start, and (rows, K); those
    of the inputs are taken where the fit has put them.
    """

    def asking() -> Asking[tuple[Matrix, Matrix]]:
        state = Fitting(fit.sample, extended, fit.causes, fit, held=())
        yield from state.begin(np.concatenate(fit.values) if fit.causes else np.zeros(0))
        if state.is_at_once:
            (there,) = yield from state.look_at([(state.u, state.anchor)])
            state.stand_at(there)
            return -state.slope, state.slopes
        yield from state.derivatives()
        return -state.slope, (yield from state.slopes_of_inputs())

    return alone(extended, asking())


def slopes_left(fit: Fit, extended: Extended) -> tuple[Matrix, Matrix]:
    """Return the derivatives as the fit left them, without a call of the model; else as ``slopes_at`` does."""
    sample = fit.sample
    if not fit.moves or (fit.causes and not fit.slopes):
        return slopes_at(fit, extended)
    own = sample.curve(fit.slopes, fit.predicted) if fit.slopes else np.zeros((sample.rows, 0))
    return own, sample.curve(fit.moves, fit.predicted)


def unit_of(fit: Fit) -> Matrix:
    """Return what one unit of every number, as the fit sees it, is in SI at the fitted value."""
    scales = {channel.name: channel.scale for channel in fit.sample.channels}
    numbers = [number for cause in fit.causes for number in cause.numbers]
    flat = np.concatenate(fit.values) if fit.causes else np.zeros(0)
    return np.array(
        [value if number.is_log else size_of(number, scales) for number, value in zip(numbers, flat, strict=True)]
    )
