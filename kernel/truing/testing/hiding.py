"""Hiding an effect in a record of one's own making, with the truth kept beside it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from truing.declare.model import Model
from truing.declare.near_miss import near_miss
from truing.declare.sources import Effect, Unknown
from truing.errors import Fault, InputError, TruingError
from truing.setup import Setup, SwitchedOn
from truing.testing.designs import Design, columns_of
from truing.testing.hidden import MEASURED, Hidden, offer_of
from truing.testing.noises import Noise, noise_of
from truing.testing.subject import Subject

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

Size = str | float | Mapping[str, str | float]
Strange = Callable[..., Any]
HELD_OUT = 200
STRANGE = "hidden_by_the_test"


def hide(  # one argument per thing a record has; all but the first three by name
    effect: str | None,
    size: Size | None = None,
    noise: str | float | Mapping[str, str | float] | None = None,
    *,
    model: Model[Any, Any],
    over: Mapping[str, str | Sequence[Any]] | None = None,
    measure: str | Sequence[str] | None = None,
    rows: int = 60,
    runs: int = 1,
    seed: int = 0,
    by: Strange | None = None,
    settings: Mapping[str, str] | None = None,
    machine: int | None = None,
    correlation: float = 0.0,
) -> Hidden:
    """Make a measured record in which an effect is hidden, and rows that are never fitted.

    ``effect`` names one of the model's effects or of the kernel's; None hides nothing. ``size`` says its unknowns:
    ``"4 um"`` where it has one, else ``{"extra": "3 um", "length": "200 m"}``; without it every amplitude is half of
    what its bounds allow, every shape in the middle of its own. ``noise`` is the standard deviation of the gauge, in
    the unit of the one measured result or in "%" of the span of its readings; or by result. ``measure`` names the
    results that are measured, by default those of ``noise``, or the one whose dimension fits it.

    ``over`` says what is set from row to row: ``{"load": "10..90 N", "oil_temperature": "20..60 degC"}``, inputs and
    conditions, filled evenly; ``"10, 50, 90 N"`` takes levels. By default that is what the effect needs and what is
    declared to vary and has no tolerance. ``rows`` are those of one run, of ``runs`` runs; a result along an axis is
    measured along it, a run is then one record. ``settings`` are as with ``--set``. The machine is that of the drawing,
    or by ``machine=7`` the seventh one drawn from the tolerances. ``correlation`` is that of the noise of neighbouring
    rows. The same ``seed`` gives the same record.

    The effect is made by its own function, the very one that the diagnosis tries. Such a test proves that the effect
    can be seen under this noise, told apart from all others and from the tolerances, and that its size is recovered; it
    cannot prove that the function is true to any machine: a wrong sign is planted and found alike. For that hand in
    ``by``, a function of your own from other sources (the exact geometry, a table, a measured curve):
    ``by(inputs, results, **unknowns, **conditions) -> results``, in SI, numbers or arrays (n,), as an effect on the
    reading. With ``effect=None`` it hides something that nobody registered.

    Raises InputError with every fault of the call, a sentence each.
    """
    faults: list[str] = []
    setup = _setup(model, settings or {}, faults)
    wanted = _effect(model, effect, faults)
    noises = noise_of(setup, noise, measure, faults)
    truth = _truth(wanted, size, list(noises), faults)
    _check_by(by, wanted, model, faults)
    _check_counts({"rows": rows, "runs": runs}, correlation, faults)
    columns, wrong = columns_of(setup, wanted, list(noises), over)
    _raise(model, [*faults, *wrong])
    design = Design(tuple(columns), rows, runs)
    off = {} if machine is None else _drawn(setup, machine)
    known = {column.name: setup.nominal(column.name) for column in columns if column.name in model.known_conditions}
    setup = replace(setup, conditions={**setup.conditions, **known})
    plan = _Plan(setup, _wrong(setup.changed(off), wanted, truth, by), noises, correlation, seed)
    measured, _ = plan.recorded(design, 0)
    more = replace(design, rows=HELD_OUT) if runs == 1 and not any(one.places for one in columns) else design
    held, left = plan.recorded(more, 1)
    return Hidden(
        setup=setup, measured=measured, held_out=held, effect=effect, truth=truth, machine=off, noise=left,
        is_strange=effect is None and by is not None,
    )  # fmt: skip


@dataclass(frozen=True)
class _Plan:
    """What is known, what is true, and how it is read off."""

    setup: Setup
    true: Setup
    noises: Mapping[str, Noise]
    correlation: float
    seed: int

    def recorded(self, design: Design, part: int) -> tuple[str, dict[str, float]]:
        """Return a record as CSV, and the root mean square of the noise in it by result, SI."""
        import numpy as np

        from truing.studies.scatter import generator
        from truing.units import difference_unit, from_si, unit_factor

        columns = design.drawn(generator(self.seed, part, "design"))
        true = self._shown(columns)
        left: dict[str, float] = {}
        for name, noise in self.noises.items():
            rng = generator(self.seed, part, f"noise of {name}")
            size = noise.size(true[name])
            added = size * _correlated(rng, design, self.correlation)
            unit = self.setup.print_unit(name)
            step = size / unit_factor(difference_unit(unit)) / 1000
            read = from_si(true[name] + added, unit)
            columns[f"{name} [{unit or '1'}]"] = np.round(read, -math.floor(math.log10(step))) if step else read
            left[name] = float(np.sqrt(np.mean(added**2)))
        return _csv(columns), left

    def _shown(self, columns: Mapping[str, Any]) -> Mapping[str, NDArray[np.float64]]:
        """Return what the gauges would show without noise, SI. Raises InputError where the model has no answer."""
        from truing.gauge import read_by_gauge
        from truing.measurements import read_rows

        with TemporaryDirectory() as folder:
            file = Path(folder) / MEASURED
            file.write_text(_csv(columns), encoding="utf-8")
            rows = read_rows(file, offer_of(self.true), self.true)
        found = read_by_gauge(self.true, rows, list(self.noises))
        if found.failed.any():
            row, reason = next(iter(found.reasons.items()))
            at = ", ".join(f"{name} = {values[row]}" for name, values in columns.items())
            many = f"{int(found.failed.sum())} of {len(found)} rows"
            _raise(self.setup.model, [f"the model has no answer in {many}; at {at}: {reason}; narrow the range (over)"])
        return found.results


def _csv(columns: Mapping[str, Any]) -> str:
    from truing.measurements import write_table

    text = StringIO()
    write_table(text, list(columns), list(columns.values()))
    return text.getvalue()


def _correlated(rng: np.random.Generator, design: Design, correlation: float) -> NDArray[np.float64]:
    """Draw noise of unit variance for every row; that of neighbours in a run is correlated."""
    import numpy as np

    drawn = rng.standard_normal((design.runs, design.rows))
    for row in range(1, design.rows if correlation else 0):
        drawn[:, row] = correlation * drawn[:, row - 1] + math.sqrt(1 - correlation**2) * drawn[:, row]
    return np.asarray(drawn.ravel())


def _raise(model: Model[Any, Any], faults: Sequence[str]) -> None:
    if faults:
        raise InputError([Fault(f"{model.name}: {sentence}") for sentence in faults])


def _setup(model: Model[Any, Any], settings: Mapping[str, str], faults: list[str]) -> Setup:
    from truing.inputs_file import setup_from_settings

    subject = Subject(model)
    if settings:
        try:
            return setup_from_settings(subject.offer, settings)
        except TruingError as error:
            faults.append(str(error))
    return subject.setup


def _effect(model: Model[Any, Any], name: str | None, faults: list[str]) -> Effect[Any, Any] | None:
    if name is None or name in model.known_effects:
        return model.known_effects[name] if name is not None else None
    known = list(model.known_effects)
    faults.append(f"no effect '{name}'.{near_miss(name, known) or ' It has ' + ', '.join(known)}")
    return None


def _truth(
    effect: Effect[Any, Any] | None, size: Size | None, measured: Sequence[str], faults: list[str]
) -> dict[str, float]:
    """Return the unknowns of the effect in SI."""
    if effect is None:
        if size is not None and not faults:
            faults.append(f"size is {size!r}, but no effect is hidden; leave it out")
        return {}
    stated = _stated(effect, size, measured, faults)
    found: dict[str, float] = {}
    for name, said in stated.items():
        unknown = next((one for one in effect.unknowns if one.name == name), None)
        if unknown is None:
            known = [one.name for one in effect.unknowns]
            faults.append(f"effect '{effect.name}' has no unknown '{name}'.{near_miss(name, known)}")
            continue
        try:
            found[name] = _value(effect, unknown, said)
        except TruingError as error:
            faults.append(f"size of '{name}': {error}")
    touched = [part for part in effect.groups() if any(one.name in stated for one in part)]
    missing = [one.name for part in touched for one in part if one.name not in stated]
    if missing:
        faults.append(f"effect '{effect.name}': say {' and '.join(missing)} as well, size={{...}}")
    if found and not any(one.is_amplitude and found.get(one.name) for one in effect.unknowns) and not missing:
        faults.append(f"effect '{effect.name}' of size 0 hides nothing; hide(None, ...) does that")
    return found


def _stated(
    effect: Effect[Any, Any], size: Size | None, measured: Sequence[str], faults: list[str]
) -> Mapping[str, str | float]:
    """Return what is said of each unknown; a plain size is that of the only amplitude."""
    if isinstance(size, Mapping):
        return size
    parts = effect.groups()
    if effect.parts:  # one gauge each: that of what is measured
        parts = tuple(part for part in parts if any(one.name in measured for one in part)) or parts
    if size is None:
        return _half(effect, parts, faults)
    if len(parts) == 1 and len(parts[0]) == 1:
        return {parts[0][0].name: size}
    names = [one.name for part in parts for one in part]
    faults.append(
        f"effect '{effect.name}' has the unknowns {', '.join(names)}: say which is {size}, "
        f'size={{"{names[0]}": "{size}", ...}}'
    )
    return {}


def _half(effect: Effect[Any, Any], parts: Sequence[Sequence[Unknown]], faults: list[str]) -> dict[str, str]:
    """Take half of what the bounds of an amplitude allow, and the middle of those of a shape."""
    if len(parts) != 1 or any(abs(one.high) >= 1e6 for one in parts[0]):
        faults.append(f"say how large '{effect.name}' is: size={{...}}; its bounds are no measure of it")
        return {}
    found = {}
    for one in parts[0]:
        if one.is_amplitude:
            value = max((one.low, one.high), key=abs) / 2
        else:
            value = math.sqrt(one.low * one.high) if one.low > 0 else (one.low + one.high) / 2
        found[one.name] = f"{round(value) if one.whole else value!r} {one.unit}".strip()
    return found


def _value(effect: Effect[Any, Any], unknown: Unknown, said: str | float) -> float:
    """Read one unknown, SI. Raises UsageError where it is no quantity of its kind, or out of its bounds."""
    from truing.errors import UsageError
    from truing.units import from_si, read_quantity

    value = float(read_quantity(said if isinstance(said, str) else repr(said), unknown.unit))
    number = float(from_si(value, unknown.unit))
    slack = 1e-9 * max(abs(unknown.low), abs(unknown.high))
    if not unknown.low - slack <= number <= unknown.high + slack:
        raise UsageError(
            f"{said} lies outside of its bounds, {unknown.low:g} to {unknown.high:g} {unknown.unit}".rstrip()
            + ", where no diagnosis looks"
        )
    if unknown.whole and not number.is_integer():
        raise UsageError(f"{said} is no whole number")
    return value


def _check_by(by: Strange | None, effect: Effect[Any, Any] | None, model: Model[Any, Any], faults: list[str]) -> None:
    """Say where a function of the author's own does not take what the effect has."""
    import inspect

    if by is None:
        return
    parameters = list(inspect.signature(by).parameters.values())
    if any(item.kind is inspect.Parameter.VAR_KEYWORD for item in parameters):
        return
    named = {item.name for item in parameters[2:]}
    if effect is None:
        unknown = sorted(named - set(model.known_conditions))
        if unknown:
            faults.append(f"by takes {', '.join(unknown)}, which is no condition of the model")
        return
    wanted = {one.name for one in effect.unknowns} | {need.name for need in effect.needs}
    needed = {item.name for item in parameters[2:] if item.default is inspect.Parameter.empty}
    if len(parameters) < 2 or not needed <= wanted <= named:
        faults.append(
            f"by takes {', '.join(item.name for item in parameters) or 'nothing'}; it is called with inputs, results "
            f"and the keywords {', '.join(sorted(wanted))}"
        )


def _check_counts(counts: Mapping[str, int], correlation: float, faults: list[str]) -> None:
    for name, count in counts.items():
        if count < 1:
            faults.append(f"{name} is {count}; at least one")
    if not -1 < correlation < 1:
        faults.append(f"correlation is {correlation:g}; it lies between -1 and 1")


def _drawn(setup: Setup, seed: int) -> dict[str, float]:
    """Draw a machine from the tolerances: its inputs in SI."""
    from truing.studies.scatter import scatter_of

    return {name: float(values[0]) for name, values in scatter_of(setup).draw(seed, 0, 1).items()}


def _wrong(setup: Setup, effect: Effect[Any, Any] | None, truth: Mapping[str, float], by: Strange | None) -> Setup:
    """Return the machine as it truly is: the effect on, made by its own function or by the author's."""
    if by is None:
        return replace(setup, effects=(SwitchedOn(effect, truth),)) if effect is not None else setup
    model = setup.model
    made = _by_hand(by, effect, model)
    errors = [source for source in model.errors if source.name != made.name]
    changed = replace(model, errors=[*errors, made])
    on = SwitchedOn(made, truth if effect is not None else {made.unknowns[0].name: 1.0})
    return replace(setup, model=changed, effects=(on,))


def _by_hand(by: Strange, effect: Effect[Any, Any] | None, model: Model[Any, Any]) -> Effect[Any, Any]:
    """Make an effect on the reading of the author's own function."""
    import inspect

    if effect is not None:
        return Effect(effect.name, on_reading=by, unknowns=effect.unknowns, needs=effect.needs, parts=effect.parts)
    named = [*inspect.signature(by).parameters][2:]
    needs = [model.known_conditions[name] for name in named if name in model.known_conditions]

    def function(inputs: Any, results: Any, **known: Any) -> Any:
        return by(inputs, results, **{name: known[name] for name in named})

    return Effect(STRANGE, on_reading=function, unknowns=[Unknown("size", 0, 1)], needs=needs)
