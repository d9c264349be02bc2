"""Checks of the function: batches, inputs left alone, finite answers, seeds, processes, derivatives, bounds."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.arrays import one_thread
from truing.declare.batch import watching
from truing.declare.dynamics import Dynamics
from truing.declare.fields import Axis, Given, InputField, read, with_values
from truing.declare.model import Model
from truing.declare.sources import Condition
from truing.errors import InfeasibleError, PluginError, TruingError
from truing.evaluate import Rows, acting_inputs, evaluate, evaluate_rows
from truing.executors import in_order, open_executor
from truing.heavy import integrate
from truing.inputs_file import setup_from_settings
from truing.inputs_file.values import broken_bound
from truing.packed import Packed, pack, unpack
from truing.setup import Setup, effect_column
from truing.studies.sampling import scatter_of
from truing.testing.sources import off_reference, shape, switched
from truing.testing.subject import Subject, fail
from truing.units import read_quantity, to_si, unit_factor

SLOPE = 1e-6


def finite_at_defaults(subject: Subject) -> None:
    """The defaults give finite results."""
    if subject.obstacle:
        fail(f"{subject.model.name}: the defaults cannot be calculated: {subject.obstacle}")


def inputs_untouched(subject: Subject) -> None:
    """A call leaves the arrays it was given as they were."""
    batch = together(subject)
    columns = batch.columns
    before = {name: values.copy() for name, values in columns.items()}
    own = subject.model.read_inputs(subject.setup.inputs)
    series = {name: np.copy(value) for name, value in own.items() if isinstance(value, np.ndarray)}
    evaluate_rows(subject.setup, columns, batch.rows)
    after = {**own, **columns}
    for name, values in {**before, **series}.items():
        if not np.array_equal(values, after[name], equal_nan=True):
            fail(f"{subject.model.name}: the function writes to the input '{name}'; take a copy before changing it")


def seeds_decide(subject: Subject) -> None:
    """The same inputs give the same results, the same seed the same draws, and a tolerance leaves the others alone."""
    name = subject.model.name
    one, two = (subject.model.read_results(evaluate(subject.setup)) for _ in range(2))
    for result, value in one.items():
        if not np.array_equal(value, two[result], equal_nan=True):
            fail(f"{name}: '{result}' differs between two calls with the same inputs; randomness is handed in")
    first, again, other = (scatter_of(subject.setup).draw(seed, 0, 64) for seed in (0, 0, 1))
    for column, values in first.items():
        if not np.array_equal(values, again[column]):
            fail(f"{name}: '{column}' is drawn differently with the same seed; draw from the generator that is given")
        if np.array_equal(values, other[column]) and np.ptp(values):
            fail(f"{name}: '{column}' is drawn alike with another seed; draw from the generator that is given")


def serial_equals_parallel(subject: Subject) -> None:
    """A worker process computes the same numbers, bit for bit. Skipped where no process could find the model."""
    assert subject.home is not None
    setup = replace(subject.setup, origin=subject.home)
    jobs = [(pack(setup), batch) for batch in range(2)]
    with open_executor("processes:1") as executor:
        far = list(in_order(executor, _drawn_rows, jobs))
    for here, there in zip(map(_drawn_rows, jobs), far, strict=True):
        for name, values in here.results.items():
            if not np.array_equal(values, there.results[name], equal_nan=True):
                fail(f"{subject.model.name}: '{name}' is different in another process; avoid globals and set order")


@one_thread()
def _drawn_rows(job: tuple[Packed, int]) -> Rows:
    packed, batch = job
    setup = unpack(packed)
    return evaluate_rows(setup, scatter_of(setup).draw(setup.seed, batch, 32), 32)


def derivatives_are_exact(subject: Subject) -> None:
    """Derivatives that the model states equal central differences of the function, to 1e-6."""
    if subject.model.derivatives is None:
        return
    for point in ({}, *subject.points(1)):
        setup = subject.at(point)
        for result, by_input in subject.model.derivatives(setup.inputs).items():
            for name, stated in by_input.items():
                _compare_slope(subject, setup, (result, name), float(stated))


def _compare_slope(subject: Subject, setup: Setup, pair: tuple[str, str], stated: float) -> None:
    result, name = pair
    if result not in subject.model.own_result_fields or name not in subject.scattering:
        fail(f"{subject.model.name}: derivatives() names '{result}' by '{name}', which is no result by an input")
    usual = float(subject.setup.nominal(name))  # an input that is 0 by default is no scale of itself where it is drawn
    reach = 0.1 * abs(usual) or unit_factor(subject.model.input_fields[name].unit)
    slopes = [_difference(setup, pair, reach * share) for share in (1.0, 0.1, 1e-2, 1e-3)]
    known = [slope for slope in slopes if slope is not None]
    if len(known) < 2:
        return
    nearest = min(known, key=lambda slope: abs(slope - stated))
    height = abs(float(subject.model.read_results(evaluate(setup))[result]))
    unsure = max(min(abs(one - other) for one, other in pairwise(known)), sys.float_info.epsilon * height / reach)
    if abs(nearest - stated) > SLOPE * abs(stated) + 3 * unsure:
        fail(
            f"{subject.model.name}: the derivative of '{result}' by '{name}' is stated as {stated:.9g}; "
            f"differences of the function give {nearest:.9g} (SI)"
        )


def _difference(setup: Setup, pair: tuple[str, str], step: float) -> float | None:
    """Return the central difference of fourth order, or None where a step is impossible."""
    result, name = pair
    values = float(setup.nominal(name)) + step * np.array([-2.0, -1.0, 1.0, 2.0])
    rows = evaluate_rows(setup, {name: values}, 4, wanted={result})
    if rows.failed.any():
        return None
    far_low, low, high, far_high = rows.results[result]
    return float((8 * (high - low) - (far_high - far_low)) / (12 * step))


def bounds_are_answered(subject: Subject) -> None:
    """What lies outside a bound is refused by name; what lies on an inclusive bound is calculated or told why not."""
    for name, field in subject.scattering.items():
        spec = field.spec
        assert isinstance(spec, Given)
        bounds: Mapping[str, float | None] = {
            "above": spec.above, "at least": spec.at_least, "below": spec.below, "at most": spec.at_most,
        }  # fmt: skip
        for word, bound in bounds.items():
            if bound is None:
                continue
            step = max(abs(bound), 1.0) * 1e-3  # to what lies just outside; an exclusive bound is outside itself
            _refused(subject, name, word, bound + {"at least": -step, "at most": step}.get(word, 0.0))
            if word in {"at least", "at most"}:
                _answered(subject, name, bound)


def _refused(subject: Subject, name: str, word: str, value: float) -> None:
    unit = subject.model.input_fields[name].unit
    try:
        setup_from_settings(subject.offer, {name: f"{value!r} {unit}".strip()})
    except TruingError as error:
        if name not in str(error) or not (word in str(error) or "absolute zero" in str(error)):
            fail(f"{subject.model.name}: {name} = {value:g} {unit} is refused with other words: {error}")
        return
    fail(f"{subject.model.name}: {name} = {value:g} {unit} is accepted, but it must be {word} its bound")


def _answered(subject: Subject, name: str, bound: float) -> None:
    unit = subject.model.input_fields[name].unit
    try:
        evaluate(subject.at({name: to_si(bound, unit)}))
    except InfeasibleError as error:
        if "is not finite" in str(error):
            fail(
                f"{subject.model.name}: with {name} = {bound:g} {unit}, which its bounds allow, {error}; "
                "exclude the bound (above, below) or state what must hold"
            )


# The check of numerical steps: halving one, or doubling a count, changes no result by more than it is declared to


POINTS = 2
HALVED_ROUNDING = 1e-9


def steps_may_be_halved(subject: Subject) -> None:
    """Halving a numerical step, or doubling a count, changes no result by more than the sheet says of it."""
    for field in numerical(subject):
        for point in ({}, *subject.points(POINTS)):
            setup = subject.at(point)
            value = setup.model.read_inputs(setup.inputs)[field.name]
            step = {field.path: value * 2 if field.is_count else value / 2}
            try:
                finer = evaluate(replace(setup, inputs=with_values(setup.inputs, step)))
            except InfeasibleError as error:
                fail(f"{subject.model.name}: '{field.name}' is finer by a half, and the model refuses it: {error}")
            for sentence in _moved(setup, finer, field):
                fail(f"{subject.model.name}: {sentence}; refuse what is too coarse (feasible), or say what it changes")


def motion_is_settled(subject: Subject) -> None:
    """A tenth of the tolerance of a motion changes no result by more than the sheet says, and slopes are its own."""
    dynamics = subject.model.dynamics
    if dynamics is None or dynamics.step is not None:
        return
    _slopes_are_its_own(subject, dynamics)
    finer = replace(dynamics, tolerance=dynamics.tolerance / 10)
    for point in ({}, *subject.points(POINTS)):
        inputs = subject.at(point).inputs
        before, after = (subject.model.read_results(each(inputs)) for each in (dynamics, finer))
        for name, value in before.items():
            here, there = np.asarray(value, dtype=float), np.asarray(after[name], dtype=float)
            moved, size = (np.max(np.nan_to_num(np.abs(each)), initial=0.0) for each in (here - there, there))
            if moved > dynamics.settled * size:
                what = f"a tenth of the tolerance moves '{name}' by {moved / size:.1g} of its largest value"
                fail(f"{subject.model.name}: {what}, not {dynamics.settled:g}; state a smaller tolerance, or settled")


FEW_STAMPS, FEW_INPUTS = 5, 3
"""Slopes of a motion are held against one another over so many times, in so many inputs."""
AGREED = 1e-3
"""Differences over a step that respects the tolerance agree so far, as a share of the largest slope of a state."""


def _slopes_are_its_own(subject: Subject, dynamics: Dynamics[Any, Any, Any]) -> None:
    """Derivatives of states by differences are those of the variational equation; no event may set a state.

    The step, a share of an input, is the cube root of the tolerance: there what a difference leaves out is about as
    large as the error of the integration. Differences over the step and twice of it are extrapolated to none; what
    lies between them is allowed.
    """
    setup, step = subject.setup, max(dynamics.tolerance, 1e-12) ** (1 / 3)
    values = {name: float(setup.nominal(name)) for name in subject.scattering if name in setup.model.input_fields}
    names = [name for name, value in values.items() if np.isfinite(value) and value != 0][:FEW_INPUTS]
    inputs, several = dynamics.begun(acting_inputs(setup), FEW_STAMPS), len(names)
    moved = _moved_inputs(setup.model, inputs, {name: values[name] for name in names}, (step, 2 * step))
    with watching(4 * several + 1) as log:
        motion = dynamics.followed(moved)
    if not names or log.codes.any() or any(np.any(count) for count in motion.counts.values()):
        return
    states = np.array([getattr(motion.states, name) for name in dynamics.state_fields])
    up, down, further_up, further_down = np.split(states[:, 1:], 4, axis=1)
    near, far = (up - down) / (2 * step), (further_up - further_down) / (4 * step)
    differences = near + (near - far) / 3
    varied = _varied(subject, dynamics, inputs, {name: values[name] for name in names})
    largest = np.abs(varied).max(axis=(1, 2), initial=0.0)[:, None, None]
    sizes = np.maximum(np.abs(states).max(axis=(1, 2)), 1e-300)[:, None, None]
    allowed = AGREED * largest + np.abs(near - far) + 100 * dynamics.tolerance / step * sizes
    wrong = np.abs(differences - varied) > allowed
    for state, name in {(int(state), int(name)) for state, name, _ in np.argwhere(wrong)}:
        which = f"state '{list(dynamics.state_fields)[state]}' in '{names[name]}'"
        why = "the law jumps where no event says so, or it keeps something between calls"
        fail(
            f"{subject.model.name}: the slope of {which} by differences is not that of the variational equation; {why}"
        )


def _moved_inputs(model: Model[Any, Any], inputs: Any, values: Mapping[str, float], steps: Sequence[float]) -> Any:
    """Return inputs of machines: as they are; then by every step, a share, each value up, and each down."""
    one = np.eye(len(values))
    rows = np.concatenate([0 * one[:1], *(sign * step * one for step in steps for sign in (1, -1))])
    columns = {name: value * (1 + rows[:, place]) for place, (name, value) in enumerate(values.items())}
    return with_values(inputs, {model.input_fields[name].path: column for name, column in columns.items()})


def _varied(
    subject: Subject, dynamics: Dynamics[Any, Any, Any], inputs: Any, values: Mapping[str, float]
) -> NDArray[np.float64]:
    """Return the slopes of all states in values, each in shares of itself, by the variational equation, (d, p, k).

    S' = df/dx S + df/dp is the slope of the law along (S, 1), a central difference; scipy integrates states and slopes.
    """
    several, short = len(values), 1e-5
    moved = _moved_inputs(subject.model, inputs, values, [short])
    stamps = np.asarray(read(inputs, dynamics.input_fields[dynamics.times].path), dtype=float)
    starts = dynamics.starts_of(moved)
    slopes = (starts[:, 1 : several + 1] - starts[:, several + 1 :]) / (2 * short)

    def rate(t: float, flat: NDArray[np.float64]) -> NDArray[np.float64]:
        y, s = flat.reshape(-1, several + 1)[:, :1], short * flat.reshape(-1, several + 1)[:, 1:]
        law = dynamics.law_at(moved, np.concatenate([y, y + s, y - s], axis=1), t)
        slope = (law[:, 1 : several + 1] - law[:, several + 1 :]) / (2 * short)
        return np.concatenate([law[:, :1], slope], axis=1).ravel()

    y = np.concatenate([starts[:, :1], slopes], axis=1).ravel()
    known = [y]
    for begin, end in pairwise(stamps.tolist()):
        inside = np.nextafter(end, begin)  # what drives is that of this interval
        y = integrate.solve_ivp(rate, (begin, inside), y, method="LSODA", rtol=1e-8, atol=1e-10).y[:, -1]
        known.append(y)
    return np.moveaxis(np.array(known).reshape(len(stamps), -1, several + 1)[:, :, 1:], 0, 2)


def numerical(subject: Subject) -> list[InputField]:
    """Return the inputs that are declared as numerical steps, tolerances or grids."""
    fields = subject.model.input_fields.values()
    return [field for field in fields if isinstance(field.spec, Given) and field.spec.halving is not None]


def _moved(setup: Setup, finer: Any, field: InputField) -> Iterator[str]:
    """Say of every result that a finer step moves further than declared by how much it does."""
    spec, model = field.spec, setup.model
    assert isinstance(spec, Given)
    assert spec.halving is not None
    before, after = model.read_results(evaluate(setup)), model.read_results(finer)
    for name, value in before.items():
        there, here = np.asarray(value, dtype=float), np.asarray(after[name], dtype=float)
        size = np.max(np.abs(here), initial=0.0)
        most = spec.halving_but.get(name)
        limit = read_quantity(most, model.own_result_fields[name].unit) if most else spec.halving * size
        if there.shape != here.shape or np.any(np.abs(here - there) > limit + HALVED_ROUNDING * size):
            numbers = "" if there.ndim or here.ndim else f" from {there:.6g} to {here:.6g} (SI)"
            yield f"a finer '{field.name}' moves '{name}'{numbers}: more than {most or f'{100 * spec.halving:g} %'}"


# Whether a batch is what single calls give: every input, condition and unknown varied alone, and all of them


ROUNDING = 2**12 * sys.float_info.epsilon
"""How far two ways of calculating one number may lie apart, in parts of it: 9.1e-13.

The vector path of a function of numpy differs from its scalar path by up to 4 units in the last place, and by another
one from processor to processor. A result is a chain of some hundred of them, on numbers of a condition of up to ten:
4 * 100 * 10, rounded up to a power of two. Where they lie farther apart it is measured what rounding does.
"""
ROWS = 7
FEW = 2
"""Of a model that the kernel calls row by row anyway."""
ALONE = 3
OPTIONAL = (1.0, 1e3, 1e6, 1e9)
"""Tried for an input that is not given, in its unit, where its bounds do not say what lies between them."""


@dataclass(frozen=True)
class Batch:
    """One batch: the setup, the columns that vary (one value per row each), and what is to be said of it.

    ``first`` is what the first row answers alone, where that is known.
    """

    setup: Setup
    columns: Mapping[str, Any]
    what: str
    first: Rows | None = None

    @property
    def rows(self) -> int:
        """How many rows it has."""
        return max(map(len, self.columns.values()), default=1)

    def alone(self, row: int) -> Rows:
        """Return what a row answers by itself."""
        if row == 0 and self.first is not None:
            return self.first
        return single(self.setup, {name: values[row] for name, values in self.columns.items()})


def single(setup: Setup, values: Mapping[str, Any]) -> Rows:
    """Return what one calculation answers, all its numbers being numbers."""
    return evaluate_rows(setup, values, 1, reading=True)


def batch_equals_loop(subject: Subject) -> None:
    """A batch is what single calls give, to rounding: each input, condition and unknown varied alone, then together."""
    batches = [together(subject)]
    if not is_row_by_row(subject):
        first = single(subject.setup, {})
        alone = {name: input_values(subject, name) for name in subject.model.input_fields}
        batches += [
            Batch(subject.setup, {name: values}, f"only '{name}' varies", first)
            for name, values in alone.items()
            if len(values) > 1
        ]
        batches += _effects_alone(subject)
    for batch in batches:
        compare(subject.model.name, batch)


def is_row_by_row(subject: Subject) -> bool:
    """Whether the kernel calls the function once per row anyway, because a table is made of unlike length."""
    specs = [field.spec for field in subject.model.own_result_fields.values()]
    return any(isinstance(spec, Axis) and spec.is_table for spec in specs)


def compare(name: str, batch: Batch) -> None:
    """Fail where a row of a batch is another one than the same row alone, or breaks another condition."""
    try:
        together = evaluate_rows(batch.setup, batch.columns, batch.rows, reading=True)
    except PluginError as error:
        fail(f"{name}: a batch in which {batch.what} fails as a whole: {error}")
    singles = [batch.alone(row) for row in range(batch.rows)]
    moves = cache(partial(rounding, batch))
    for row, alone in enumerate(singles):
        here, there = reason(together, row), reason(alone, 0)
        if here != there:
            fail(
                f"{name}: where {batch.what}, row {row} {f'fails in a batch ({here})' if here else 'is answered'} and "
                f"{f'fails alone ({there})' if there else 'is answered alone'}"
            )
    for result, values in together.results.items():
        inner = [alone.results[result][0] for alone in singles]
        if values.ndim == 1 and not _differs(values, np.array(inner), values):
            continue
        for row, number in enumerate(inner):
            cut = slice(len(number)) if np.ndim(number) else ...
            outer = values[row][cut]
            if _differs(outer, number, values) and _differs(outer, number, values, moves(row)[result][cut]):
                fail(
                    f"{name}: where {batch.what}, '{result}' of row {row} is {_short(outer)} in a batch and "
                    f"{_short(number)} alone; write np.where, not if, on anything that may vary"
                )


def reason(rows: Rows, row: int) -> str:
    """Say why a row failed, or lacks results."""
    lacking = {name: why[row] for name, why in sorted(rows.absent.items()) if row in why}
    return rows.reasons.get(row) or "; ".join(f"no '{name}': {why}" for name, why in lacking.items())


def rounding(batch: Batch, row: int) -> Mapping[str, Any]:
    """Return how far rounding alone moves each result of a row: by the last digit of each of its numbers, in turn.

    So all that is calculated of it is rounded anew, by half a unit in the last place; the vector path of a function may
    be off by up to eight times that. The row and those beside it are one batch: they are equal but for these digits.
    """
    own = {name: values[row] for name, values in batch.columns.items()}
    fields = batch.setup.model.input_fields
    numbers = {name: batch.setup.nominal(name) for name, field in fields.items() if field.varies} | own
    moving = [name for name, value in numbers.items() if isinstance(value, float) and np.isfinite(value)]
    columns = {
        name: np.repeat(value, len(moving) + 1)
        for name, value in (own | {name: numbers[name] for name in moving}).items()
    }
    for place, name in enumerate(moving, 1):
        columns[name][place] = np.nextafter(numbers[name], np.inf)
    rows = evaluate_rows(batch.setup, columns, len(moving) + 1, reading=True)
    return {result: 8 * np.nansum(np.abs(values[1:] - values[0]), axis=0) for result, values in rows.results.items()}


def _differs(here: Any, there: Any, values: np.ndarray[Any, Any], most: Any = 0.0) -> bool:
    """Tell whether numbers lie apart by more than rounding, and by more than ``most`` beyond that."""
    finite = np.abs(values[np.isfinite(values)])
    scale = np.maximum(np.abs(there), finite.max(initial=0.0))
    near = np.abs(here - there) <= ROUNDING * scale + most
    return not np.all(near | (np.isnan(here) & np.isnan(there)))


def _short(value: Any) -> str:
    return f"{float(value):.15g}" if not value.ndim else str(value)


def together(subject: Subject) -> Batch:
    """All Float inputs in one batch, at points that have an answer."""
    points = subject.points(FEW if is_row_by_row(subject) else ROWS)
    columns = {name: np.array([point[name] for point in points]) for name in subject.scattering}
    return Batch(subject.setup, columns, "all Float inputs vary")


def input_values(subject: Subject, name: str) -> list[Any]:
    """Return values of an input, SI, its own first; one alone where no other can be thought of (a file, a series)."""
    field = subject.model.input_fields[name]
    own = subject.model.read_inputs(subject.setup.inputs)[name]
    if field.kind == "switch":
        return [own, not own]
    if field.kind == "choice" and isinstance(own, str):
        return [own, *(word for word in field.choices if word != own)][:ALONE]
    if field.kind == "integer":
        return [own, *(value for value in (own + 1, own - 1) if not broken_bound(field, value))]
    if not field.varies:
        return [own]
    others = [point[name] for point in subject.points(ROWS)][: ALONE - 1]
    return [own, *(others if own == own else optional_values(field))]


def optional_values(field: InputField) -> list[float]:
    """Return values of an input that is not given, SI: between its bounds where it has both, else of its unit."""
    spec = field.spec
    assert isinstance(spec, Given)
    low = spec.above if spec.above is not None else spec.at_least
    high = spec.below if spec.below is not None else spec.at_most
    if low is None or high is None:
        tried = [value for value in OPTIONAL if (low is None or value > low) and (high is None or value < high)]
        return [float(to_si(value, field.unit)) for value in tried]
    return [float(to_si(low + share * (high - low), field.unit)) for share in (1e-3, 0.5)]


def _effects_alone(subject: Subject) -> Iterator[Batch]:
    """Each effect on: its unknowns and conditions one by one, then these and all Float inputs together."""
    for effect in subject.model.effects.values():
        setup = switched(off_reference(subject.setup), effect)
        if setup is None:
            continue
        alone: dict[str, list[float]] = {}
        for unknown in effect.unknowns:
            own = setup.effects[0].values[unknown.name]
            others = (share * own if unknown.is_amplitude else shape(unknown, share) for share in (0.0, 0.3))
            alone[effect_column(effect.name, unknown.name)] = [own, *others]
        alone |= {need.name: condition_values(setup, need) for need in effect.needs}
        first = single(setup, {})
        for name, values in alone.items():
            yield Batch(setup, {name: values}, f"effect '{effect.name}' is on and only '{name}' varies", first)
        points = subject.points(ROWS)[:ALONE]
        inputs = {name: np.array([point[name] for point in points]) for name in subject.scattering}
        yield Batch(setup, {**inputs, **alone}, f"effect '{effect.name}' is on and all it knows varies")


def condition_values(setup: Setup, need: Condition) -> list[float]:
    """Return values of a condition, SI, its own first, then its reference and one more within its range."""
    if need.low is None or need.high is None:
        other = need.zero - 3 * unit_factor(need.unit)
    else:
        other = float(to_si(need.low + 0.8 * (need.high - need.low), need.unit))
    return [float(setup.nominal(need.name)), need.zero, other]
