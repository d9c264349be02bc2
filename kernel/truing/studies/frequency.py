"""What does a moving model answer to small oscillations? Poles, gain and phase, frequencies over speed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from truing.arrays import Matrix
from truing.declare.batch import watching
from truing.declare.blocks import Block, Drawing, Table, Words
from truing.declare.dynamics import Dynamics
from truing.declare.fields import Axis, read, with_values
from truing.declare.near_miss import near_miss
from truing.errors import ConvergenceError, UnitError, UsageError
from truing.evaluate import acting_inputs
from truing.heavy import optimize
from truing.setup import Setup
from truing.studies.bench import Bench, Outcome
from truing.studies.drawings import BLUE, GREY, WIDTH, labelled
from truing.studies.reading import per, printed, read_range, scattering_name, spoken
from truing.units import difference_unit, from_si, read_quantity, same_dimension, unit_factor, unit_text

Complex = NDArray[np.complex128]
LARGEST = 100_000
STEP = 1e-3
"""Step of a difference, as a share of a value or its size; five points make an error of its fourth power."""
STILL = 1e-8
"""An equilibrium: rates below what such a share of the states would make of them."""
BENDS = 0.05
"""Slopes to both sides that differ by more of the largest one are those of a law that bends there."""
POINTS = np.array([-2, -1, 1, 2])
WEIGHTS = np.array([1, -8, 8, -1]) / 12
DECADE = 10.0


@dataclass(frozen=True, kw_only=True)
class Frequency:
    """Linearise a moving model at an operating point: its poles, and how an output follows a small oscillation.

    ``point`` is "equilibrium" (found from the start), "start", or holds states by name ("10 deg"), the others as they
    start. ``output`` is a state or a result along time (the first state), ``input`` an input that is a number; without
    one there are poles alone. ``frequencies`` is a range "0.1..100 Hz" of ``points``, by default a decade about the
    poles. ``over`` is an input or condition and ``at`` its range "0..6000 rpm" of ``steps`` values, along which the
    frequencies of the poles are followed; over a rotational speed they meet its ``orders``.
    """

    input: str = ""
    output: str = ""
    point: str | Mapping[str, str] = "equilibrium"
    frequencies: str = ""
    points: int = 400
    over: str = ""
    at: str = ""
    steps: int = 61
    orders: tuple[float, ...] = (1.0,)
    name: str = "frequency"
    gives: Callable[[FrequencyAnswer], Any] | None = None

    def __post_init__(self) -> None:
        for name, count in (("points", self.points), ("steps", self.steps)):
            if not 2 <= count <= LARGEST:
                raise UsageError(f"{name} = {count}, but there are 2 to {LARGEST} of them")
        if isinstance(self.point, str) and self.point not in {"equilibrium", "start"}:
            like = 'point = { angle = "10 deg" }'
            raise UsageError(f'point = \'{self.point}\' is neither "equilibrium" nor "start"; or write {like}')
        if bool(self.over) != bool(self.at):
            raise UsageError('over and at go together: over = "speed", at = "0..6000 rpm"')

    def run(self, bench: Bench) -> FrequencyAnswer:
        """Linearise the model. Raises UsageError for what it has not, ConvergenceError where it comes to no rest."""
        setup, dynamics = bench.setup, bench.setup.model.dynamics
        if dynamics is None:
            raise UsageError(f"study '{self.name}': {setup.model.name} does not move, so it has no frequencies")
        output = self._output(setup, dynamics)
        if self.input and not self._can_drive(setup):
            known = [name for name, field in setup.model.input_fields.items() if field.kind in {"float", "series"}]
            raise UsageError(f"study '{self.name}': '{self.input}' is no number.{near_miss(self.input, known)}")
        system = linearised(setup, dynamics, self._point(setup, dynamics), self.input, output)
        frequencies = self._frequencies(system)
        return FrequencyAnswer(
            study=self,
            system=system,
            frequencies=frequencies,
            response=system.response(frequencies) if self.input else np.zeros(0, dtype=complex),
            campbell=self._campbell(bench, dynamics, system) if self.over else None,
            units={**_units(setup, dynamics), **({self.over: setup.unit_of(self.over)} if self.over else {})},
            shown=self.gives is None,
        )

    @property
    def title(self) -> str:
        """What is asked."""
        return f"of {spoken(self.output)} to {spoken(self.input)}"

    def _can_drive(self, setup: Setup) -> bool:
        field, dynamics = setup.model.input_fields.get(self.input), setup.model.dynamics
        return (
            field is not None
            and dynamics is not None
            and self.input != dynamics.times
            and (field.varies or self.input in dynamics.driving)
        )

    def _output(self, setup: Setup, dynamics: Dynamics[Any, Any, Any]) -> str:
        results = setup.model.own_result_fields
        axes = [name for name, each in results.items() if isinstance(each.spec, Axis)
                and each.spec.follows == dynamics.times]  # fmt: skip
        along = [name for name, each in results.items() if each.along in axes and name not in axes]
        known = [*dynamics.state_fields, *along]
        if self.output and self.output not in known:
            near = near_miss(self.output, known) or f" (there are: {', '.join(known)})"
            sentence = f"'{self.output}' is no state and no result along time of {setup.model.name}.{near}"
            raise UsageError(f"study '{self.name}': {sentence}")
        return self.output or known[0]

    def _point(self, setup: Setup, dynamics: Dynamics[Any, Any, Any]) -> Matrix:
        """Return the states about which the model is linearised, (d,)."""
        inputs, stated = acting_inputs(setup), self.point
        start = dynamics.starts_of(inputs)[:, 0]
        if isinstance(stated, str):
            return equilibrium(dynamics, inputs, start) if stated == "equilibrium" else start
        known, states = dynamics.state_fields, np.array(start)
        for name, text in stated.items():
            if name not in known:
                near = near_miss(name, known)
                raise UsageError(f"study '{self.name}': {setup.model.name} has no state '{name}'.{near}")
            try:
                states[list(known).index(name)] = read_quantity(text, known[name].unit)
            except UnitError as error:
                raise UsageError(f"study '{self.name}': point: {name}: {error}") from error
        return states

    def _frequencies(self, system: StateSpace) -> Matrix:
        """Return the frequencies in Hz at which the response is calculated."""
        if self.frequencies:
            asked = read_range(self.frequencies, "Hz", self.points)
            if (asked <= 0).any():
                raise UsageError(f"study '{self.name}': the frequencies '{self.frequencies}' begin above 0")
            return np.geomspace(asked[0], asked[-1], self.points) if ".." in self.frequencies else asked
        of_poles = np.abs(system.poles) / (2 * np.pi)
        of_poles = of_poles[of_poles > 0] if (of_poles > 0).any() else np.ones(1)
        low, high = float(of_poles.min()) / DECADE, float(of_poles.max()) * DECADE
        high = 0.5 / system.step if system.step else high
        return np.geomspace(min(low, high / DECADE), high, self.points)

    def _campbell(self, bench: Bench, dynamics: Dynamics[Any, Any, Any], first: StateSpace) -> Campbell:
        """Follow the poles along an input or condition, each operating point found from the one before."""
        setup, done = bench.setup, bench.part(self.name, 0.0, 1.0)
        over = scattering_name(setup, self.over, self.name)
        axis = read_range(self.at, setup.unit_of(over), self.steps)
        poles: list[Complex] = []
        states = first.at
        for step, value in enumerate(axis.tolist(), start=1):
            changed = setup.changed({over: value})
            if self.point == "equilibrium":
                states = equilibrium(dynamics, acting_inputs(changed), states)
            else:
                states = self._point(changed, dynamics)
            found = linearised(changed, dynamics, states, "", "").poles
            poles.append(found if not poles else _paired(poles[-1], found))
            done(step, len(axis))
        unit = setup.unit_of(over)
        turns = axis if same_dimension(unit, "Hz") else axis / (2 * np.pi) if same_dimension(unit, "rad/s") else None
        return Campbell(over, axis, np.array(poles), turns, self.orders)


def _units(setup: Setup, dynamics: Dynamics[Any, Any, Any]) -> dict[str, str]:
    """Return the unit in which inputs, states and results are printed, states of the same name first."""
    results = {name: setup.print_unit(name) for name in setup.model.own_result_fields}
    inputs = {name: field.unit for name, field in setup.model.input_fields.items()}
    return {**inputs, **results, **{name: spec.unit for name, spec in dynamics.state_fields.items()}}


def _paired(before: Complex, after: Complex) -> Complex:
    """Return poles in the order of those before, each with the nearest one."""
    if len(before) != len(after):
        return after
    return after[optimize.linear_sum_assignment(np.abs(before[:, None] - after))[1]]


# The linear model: differences of law and results about an operating point, many machines in one call


@dataclass(frozen=True)
class StateSpace:
    """dx/dt = A x + B u, y = C x + D u about ``at`` (d,), SI; the next x in place of dx/dt with a ``step`` in s.

    States that nothing changes but events have no part in it. ``bent`` names those at which the law bends.
    """

    states: tuple[str, ...]
    at: Matrix
    a: Matrix
    b: Matrix
    c: Matrix
    d: float
    step: float = 0.0
    bent: tuple[str, ...] = ()

    @cached_property
    def poles(self) -> Complex:
        """The poles in rad/s, by frequency; those of a law in steps as the continuous ones that it samples."""
        values = np.linalg.eigvals(self.a[np.ix_(self._moving, self._moving)]).astype(complex)
        if self.step:
            with np.errstate(divide="ignore"):
                values = np.log(values) / self.step
        return values[np.lexsort((values.imag < 0, values.real, np.round(np.abs(values), 12)))]

    @property
    def _moving(self) -> NDArray[np.intp]:
        rest = np.eye(len(self.a)) if self.step else 0.0
        return np.flatnonzero((self.a != rest).any(axis=1) | (self.b != 0))

    def response(self, frequencies: Matrix) -> Complex:
        """Return y over u at frequencies in Hz, (m,): C (s - A)^-1 B + D."""
        moving, turned = self._moving, 2j * np.pi * frequencies
        s = np.exp(turned * self.step) if self.step else turned
        matrices = s[:, None, None] * np.eye(len(moving)) - self.a[np.ix_(moving, moving)]
        x = np.linalg.solve(matrices, np.broadcast_to(self.b[moving, None], (len(s), len(moving), 1)))[..., 0]
        return np.asarray(x @ self.c[moving] + self.d)


def linearised(setup: Setup, dynamics: Dynamics[Any, Any, Any], at: Matrix, driven: str, output: str) -> StateSpace:
    """Linearise a model about states ``at`` (d,): from an input by name to a state or result; "" for none."""
    inputs, names = acting_inputs(setup), tuple(dynamics.state_fields)
    steps = STEP * np.maximum(np.abs(at), _sizes(dynamics))
    columns = np.tile(at[:, None], 4 * (len(at) + 1) + 1)
    for row, step in enumerate(steps):
        columns[row, 4 * row : 4 * row + 4] += POINTS * step
    own = _input_step(setup, driven) if driven else 1.0
    moved = np.zeros(columns.shape[1])
    moved[-5:-1] = POINTS * own
    inputs = _driven(setup, inputs, driven, moved) if driven else inputs
    law = dynamics.law_at(inputs, columns)
    slopes, bends = _slopes(law, [*steps, own])
    largest = np.abs(slopes).max(axis=1, initial=0.0)[:, None]
    is_bent = ((bends > BENDS * largest) & (bends > 0)).any(axis=0)[:-1]
    shown = _shown(setup, dynamics, inputs, columns, output) if output else np.zeros((1, columns.shape[1]))
    out = _slopes(shown, [*steps, own])[0][0]
    first = read(inputs, dynamics.input_fields[dynamics.times].path)
    return StateSpace(
        names, at, slopes[:, :-1], slopes[:, -1] if driven else np.zeros(len(at)), out[:-1],
        float(out[-1]) if driven else 0.0, float(first[1] - first[0]) if dynamics.step is not None else 0.0,
        tuple(name for name, bent in zip(names, is_bent, strict=True) if bent),
    )  # fmt: skip


def _sizes(dynamics: Dynamics[Any, Any, Any]) -> Matrix:
    return np.array([spec.size * unit_factor(difference_unit(spec.unit)) for spec in dynamics.state_fields.values()])


def _slopes(values: Matrix, steps: Sequence[float]) -> tuple[Matrix, Matrix]:
    """Return slopes (rows, m) of what was calculated four times for each of m steps and once at the middle.

    And by how much those to both sides differ.
    """
    around, middle = values[:, :-1].reshape(len(values), -1, 4), values[:, -1:]
    return around @ WEIGHTS / steps, np.abs(around[..., 1] + around[..., 2] - 2 * middle) / steps


def _input_step(setup: Setup, driven: str) -> float:
    value = np.asarray(setup.nominal(driven), dtype=float).ravel()[0]
    return STEP * float(np.maximum(np.abs(value), unit_factor(difference_unit(setup.unit_of(driven)))))


def _driven(setup: Setup, inputs: Any, driven: str, moved: Matrix) -> Any:
    """Return inputs of n machines, of which one input is moved; of a series every value."""
    path = setup.model.input_fields[driven].path
    value = np.asarray(read(inputs, path), dtype=float)
    return with_values(inputs, {path: value + (moved[:, None] if value.ndim else moved)})


def _shown(setup: Setup, dynamics: Dynamics[Any, Any, Any], inputs: Any, states: Matrix, output: str) -> Matrix:
    """Return a state or a result along time as it is shown at once, (1, n)."""
    if output in dynamics.state_fields:
        return states[[list(dynamics.state_fields).index(output)]]
    rows = states.shape[1]
    with watching(rows), np.errstate(all="ignore"):
        value = setup.model.read_results(dynamics.shown_at(inputs, states))[output]
    return np.broadcast_to(np.asarray(value, dtype=float), (rows, 2))[:, :1].T


def equilibrium(dynamics: Dynamics[Any, Any, Any], inputs: Any, start: Matrix) -> Matrix:
    """Return the states (d,) in which nothing changes, found from a start. Raises ConvergenceError."""
    sizes, in_steps = np.maximum(np.abs(start), _sizes(dynamics)), dynamics.step is not None

    def rate(scaled: Matrix) -> tuple[Matrix, Matrix]:
        states = scaled * sizes
        columns = np.concatenate([states[:, None] + STEP * sizes[:, None] * np.kron(np.eye(len(states)), POINTS),
                                  states[:, None]], axis=1)  # fmt: skip
        law = dynamics.law_at(inputs, columns) - (columns if in_steps else 0.0)
        return law[:, -1], _slopes(law, [STEP] * len(states))[0]

    with np.errstate(all="ignore"):
        solved = optimize.root(rate, start / sizes, jac=True, method="lm", options={"xtol": 1e-14, "ftol": 1e-14}).x
        left, slopes = rate(solved)
    allowed = STILL * (np.abs(slopes) @ (1 + np.abs(solved)))
    moving = [name for name, is_left in zip(dynamics.state_fields, ~(np.abs(left) <= allowed), strict=True) if is_left]
    if moving:
        hint = 'state the operating point (point = { angle = "0 deg" }), or take the start (point = "start")'
        raise ConvergenceError(f"no equilibrium was found from the start: {' and '.join(moving)} still changes; {hint}")
    return np.asarray(solved * sizes)


# What the study answers


@dataclass(frozen=True)
class Campbell:
    """Poles (m, d) in rad/s along ``axis`` (m,); ``turns`` are rotations per second where it is a rotational speed."""

    over: str
    axis: Matrix
    poles: Complex
    turns: Matrix | None
    orders: tuple[float, ...]

    @property
    def frequencies(self) -> Matrix:
        """Frequencies in Hz of those poles that oscillate anywhere, (m, modes)."""
        values = self.poles.imag / (2 * np.pi)
        return values[:, (values > 0).any(axis=0)]

    def excited(self) -> dict[float, Matrix]:
        """Return the frequencies in Hz, (m,), that each order of the speed excites."""
        return {} if self.turns is None else {order: order * self.turns for order in self.orders}

    def crossings(self) -> list[tuple[float, float, float]]:
        """Return order, value of the axis (SI) and frequency where an order of the speed meets a frequency."""
        return sorted(self._met())

    def _met(self) -> Iterator[tuple[float, float, float]]:
        for order, excited in self.excited().items():
            for mode in self.frequencies.T:
                gap = mode - excited
                for place in np.flatnonzero((gap[:-1] * gap[1:] < 0) | ((gap[1:] == 0) & (gap[:-1] != 0))):
                    share = gap[place] / (gap[place] - gap[place + 1])
                    at, hertz = (each[place] + share * (each[place + 1] - each[place]) for each in (self.axis, excited))
                    yield order, float(at), float(hertz)


@dataclass(frozen=True, kw_only=True)
class FrequencyAnswer(Outcome):
    """The linear model ``system``, its ``response`` (complex, SI) at ``frequencies`` in Hz, and ``campbell``."""

    study: Frequency
    system: StateSpace
    frequencies: Matrix
    response: Complex
    campbell: Campbell | None
    units: Mapping[str, str]
    shown: bool = True

    @property
    def poles(self) -> Complex:
        """The poles in rad/s, one of each pair."""
        return self.system.poles[self.system.poles.imag >= 0]

    @property
    def gain_unit(self) -> str:
        """The unit of the gain."""
        return per(self.units[self._asked()], self.units[self.study.input])

    @property
    def gain(self) -> Matrix:
        """Amplitude of the output over that of the input, in ``gain_unit``, (m,)."""
        factors = [unit_factor(difference_unit(self.units[name])) for name in (self._asked(), self.study.input)]
        return np.abs(self.response) * factors[1] / factors[0]

    @property
    def phase(self) -> Matrix:
        """By how much the output leads the input, degrees, (m,)."""
        return np.degrees(np.unwrap(np.angle(self.response)))

    def _asked(self) -> str:
        return self.study.output or self.system.states[0]

    def as_json(self) -> dict[str, Any]:
        """Return the operating point, the poles, and what was asked along frequency and along an input."""
        said: dict[str, Any] = {
            "at": {
                name: {"value": printed(value, self.units[name]), "unit": self.units[name]}
                for name, value in zip(self.system.states, self.system.at, strict=True)
            },
            "poles": [dict(zip(("real", "imaginary", "frequency", "damping_ratio"), row, strict=True))
                      for row in _of_poles(self.system.poles)],
        }  # fmt: skip
        if self.study.input:
            said["response"] = {
                "input": self.study.input, "output": self._asked(), "unit": self.gain_unit,
                "frequency": self.frequencies.tolist(), "gain": self.gain.tolist(), "phase": self.phase.tolist(),
            }  # fmt: skip
        if self.campbell is not None:
            unit = self.units[self.campbell.over]
            said["campbell"] = {
                "over": self.campbell.over, "unit": unit, "axis": printed(self.campbell.axis, unit),
                "frequencies": self.campbell.frequencies.T.tolist(),
                "crossings": [{"order": order, "at": printed(at, unit), "frequency": hertz}
                              for order, at, hertz in self.campbell.crossings()],
            }  # fmt: skip
        return said

    def blocks(self) -> Sequence[Block]:
        """Return the operating point with its poles, the response with its peaks, and the frequencies over speed."""
        at = ", ".join(
            f"{spoken(name)} {from_si(value, self.units[name]):.6g} {unit_text(self.units[name])}".strip()
            for name, value in zip(self.system.states, self.system.at.tolist(), strict=True)
        )
        is_stable = (self.system.poles.real < 0).all()
        word = "comes back to" if is_stable else "does not come back to"
        blocks: list[Block] = [Words(f"Linearised at {at}. After a small push the machine {word} this point.")]
        rows = [
            [hertz, ratio, imaginary / (2 * np.pi), -1 / real if real < 0 else None]
            for real, imaginary, hertz, ratio in _of_poles(self.poles)
        ]
        columns = ("natural frequency", "damping ratio", "frequency when it swings", "falls to 37 % in")
        blocks.append(Table("Poles", columns, rows, ("Hz", "", "Hz", "s"), "A pair of poles is one row."))
        if self.study.input:
            title = f"{spoken(self._asked())} over {spoken(self.study.input)}"
            blocks += [self._peaks(title), Drawing(f"Gain and phase: {title}", self._bode())]
        if self.campbell is not None:
            blocks += [
                *self._critical(self.campbell),
                Drawing("Frequencies " + self._along(), self._drawn(self.campbell)),
            ]
        return [block for block in blocks if self.shown or not isinstance(block, Drawing)]

    def _along(self) -> str:
        return f"along the {spoken(self.study.over)}"

    def warnings(self) -> Sequence[str]:
        """Name states at which the law bends, so that it is not linear however small the oscillation."""
        return [
            f"study '{self.study.name}': the law bends at this value of '{name}' (friction, a stop, a clearance?): "
            "a linear model of it holds for no oscillation"
            for name in self.system.bent
        ]

    def _peaks(self, title: str) -> Table:
        """Say the response at the lowest frequency and at every peak."""
        gain, phase = self.gain, self.phase
        peaks = np.flatnonzero((gain[1:-1] > gain[:-2]) & (gain[1:-1] >= gain[2:])) + 1
        rows = [[self.frequencies[place], gain[place], phase[place], gain[place] / gain[0]] for place in [0, *peaks]]
        columns = ("frequency", "gain", "phase", "over the first")
        units = ("Hz", unit_text(self.gain_unit), "°", "")
        note = "At the lowest frequency and at every peak; nothing is sought between the points."
        return Table(f"Response: {title}", columns, [[float(cell) for cell in row] for row in rows], units, note)

    def _critical(self, campbell: Campbell) -> list[Block]:
        unit = self.units[campbell.over]
        rows = [[order, float(from_si(at, unit)), hertz] for order, at, hertz in campbell.crossings()]
        columns = ("order", spoken(campbell.over), "frequency")
        title = "Where an order meets a frequency"
        return [Table(title, columns, rows, ("", unit_text(unit), "Hz"))] if rows else []

    def _bode(self) -> Callable[[], Figure]:
        def draw() -> Figure:
            figure = Figure(figsize=(WIDTH, 4.2), layout="constrained")
            above, below = figure.subplots(2, 1, sharex=True)
            above.loglog(self.frequencies, self.gain, color=BLUE)
            above.set_ylabel(labelled("gain", unit_text(self.gain_unit)))
            below.semilogx(self.frequencies, self.phase, color=BLUE)
            below.set_ylabel("phase, °")
            below.set_xlabel("frequency, Hz")
            for panel in (above, below):
                panel.grid(alpha=0.3)
            return figure

        return draw

    def _drawn(self, campbell: Campbell) -> Callable[[], Figure]:
        def draw() -> Figure:
            unit = self.units[campbell.over]
            figure = Figure(figsize=(WIDTH, 3.6), layout="constrained")
            panel: Any = figure.subplots()
            x = from_si(campbell.axis, unit)
            panel.plot(x, campbell.frequencies, color=BLUE)
            highest = 1.15 * campbell.frequencies.max(initial=0.0) or 1.0
            for order, excited in campbell.excited().items():
                panel.plot(x, excited, color=GREY, linestyle="--", linewidth=0.9)
                end = int(np.flatnonzero(excited <= highest)[-1])
                panel.annotate(f"{order:g}×", (x[end], excited[end]), color=GREY, ha="right", va="bottom")
            for _, at, hertz in campbell.crossings():
                panel.plot(from_si(at, unit), hertz, color=GREY, marker="o", markersize=4)
            panel.set_ylim(0, highest)
            panel.set_xlabel(labelled(campbell.over, unit_text(unit)))
            panel.set_ylabel("frequency, Hz")
            panel.grid(alpha=0.3)
            return figure

        return draw


def _of_poles(poles: Complex) -> list[tuple[float, float, float, float | None]]:
    """Return real and imaginary part (rad/s), natural frequency (Hz) and damping ratio of each pole."""
    return [
        (pole.real, pole.imag, abs(pole) / (2 * np.pi), -pole.real / abs(pole) if pole else None)
        for pole in poles.tolist()
    ]
