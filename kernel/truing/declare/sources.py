"""Error sources: what could make a model disagree with reality. Declared once, used by every study."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Sequence
from dataclasses import KW_ONLY, dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Concatenate, Generic, Literal, TypeAlias, TypeVar

from truing.declare.correlations import Correlated
from truing.declare.fields import ROLES, Role
from truing.declare.goals import Price, PriceByChoice
from truing.declare.near_miss import near_miss
from truing.declare.spreads import Spread
from truing.errors import DeclarationError
from truing.units import to_si
from truing.units.names import LEVELS

if TYPE_CHECKING:
    from typing_extensions import TypeVar as TypeVarWithDefault

    I = TypeVarWithDefault("I", default=Any)  # noqa: E741  # inputs, as in Model[I, R]
    R = TypeVarWithDefault("R", default=Any)
else:
    I = TypeVar("I")  # noqa: E741
    R = TypeVar("R")
ActsOn = Literal["inputs", "results", "reading"]
SINCE_START = "since_start"
HISTORIES = ("running_maximum", "cumulative", "direction", "last_reversal")
"""What a condition may be derived by: "since_start" from its own column, these from another one."""
MOST_UNKNOWNS = 3


@dataclass(frozen=True)
class Tolerance:
    """Inputs that scatter about their nominal: one band, one price, one draw of its own per input it is ``on``.

    Draws are independent, but of inputs that are ``correlated``.
    """

    name: str
    spread: Spread
    on: Sequence[str] = ()
    _: KW_ONLY
    why: str = ""
    price: Price | PriceByChoice | None = None
    source: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "on", tuple(self.on or (self.name,)))


@dataclass(frozen=True)
class Unknown:
    """A number that only measurement can tell; bounds in ``unit``.

    Bounds that contain 0 make it an amplitude, any others a shape (positive ones are looked for by their logarithm).
    A shape may be a ``whole`` number, which is tried one by one, or a place ``along`` a condition (when does the step
    come?), which is tried at places of the record; such an unknown is no amplitude whatever its bounds.
    """

    name: str
    low: float
    high: float
    unit: str = ""
    note: str = ""
    whole: bool = False
    along: str = ""

    def __post_init__(self) -> None:
        if not (self.low < self.high and math.isfinite(self.low) and math.isfinite(self.high)):
            raise DeclarationError(
                f"unknown '{self.name}': its bounds are {self.low} and {self.high}; two finite numbers, lower first"
            )
        if self.whole and not (float(self.low).is_integer() and float(self.high).is_integer()):
            raise DeclarationError(
                f"unknown '{self.name}': it is a whole number, so its bounds are; they are {self.low} and {self.high}"
            )
        if self.whole and self.along:
            raise DeclarationError(
                f"unknown '{self.name}': a place along '{self.along}' is no whole number; drop whole or along"
            )

    @property
    def is_amplitude(self) -> bool:
        """Whether the effect vanishes with it."""
        return self.low <= 0 <= self.high and not self.whole and not self.along


@dataclass(frozen=True)
class Condition:
    """Something measured that is no input of the model; at its ``reference`` (in ``unit``) its effects vanish.

    ``derived`` makes it, once, from whole runs in time order: "since_start" (what its own column has gained since the
    first row of the file), or "running_maximum of load", "cumulative of load", "direction of travel", "last_reversal of
    travel". ``low`` and ``high`` (in ``unit``) are the range in which it can be measured, for the next experiment.
    ``role`` says how it gets there: it is "set", it only "goes_on" (time, cycles, wear so far), or it "follows" from
    others (a temperature after hours of work). ``rate`` names what it gains with time (revolutions: the speed).
    Raises DeclarationError for another text, for a range upside down, for a temperature level that is gained, for what
    counts and is to be set, and for a rate of what does not go on.
    """

    name: str
    unit: str
    reference: float = 0.0
    note: str = ""
    derived: str = ""
    low: float | None = None
    high: float | None = None
    role: Role | Literal[""] = ""
    rate: str = ""

    def __post_init__(self) -> None:
        _check_condition(self)

    @property
    def does(self) -> Role:
        """Its role: as declared, else "goes_on" of what counts, "follows" of other histories, "set" of the rest."""
        counts = self.history == SINCE_START or bool(self.rate)
        return self.role or ("goes_on" if counts else "follows" if self.derived else "set")

    @property
    def history(self) -> str:
        """The word of what it is derived by ("since_start", "direction" ...), or nothing."""
        return self.derived.partition(" of ")[0]

    @property
    def made_from(self) -> str:
        """The column it is derived from: its own for "since_start", else the one behind "of"; nothing without."""
        return (self.derived.partition(" of ")[2] or self.name) if self.derived else ""

    @cached_property
    def zero(self) -> float:
        """The reference in SI, as effects see the condition itself."""
        return float(to_si(self.reference, self.unit))


def _check_condition(condition: Condition) -> None:
    """Refuse a history that nobody knows how to derive, and a range that is none."""
    low, high = condition.low, condition.high
    if low is not None and high is not None and not low < high:
        raise DeclarationError(f"condition '{condition.name}': its range goes from {low} to {high}; lower first")
    _check_role(condition)
    if not condition.derived:
        return
    word, of, column = condition.derived.partition(" of ")
    fits = word in HISTORIES and column.isidentifier() if of else condition.derived == SINCE_START
    if not fits or column == condition.name:
        words = ", ".join(f"'{known} of COLUMN'" for known in HISTORIES)
        raise DeclarationError(
            f"condition '{condition.name}' is derived by '{condition.derived}'; write '{SINCE_START}', {words}, "
            "each of another column"
        )
    if word in {SINCE_START, "cumulative"} and condition.unit in LEVELS:
        raise DeclarationError(
            f"condition '{condition.name}' is in {condition.unit}, a temperature level, but what is gained is a "
            "difference: declare it in K"
        )


def _check_role(condition: Condition) -> None:
    """Refuse a role that is none, or that what is derived cannot have, and a rate of what does not go on."""
    name, wanted = condition.name, condition.role
    if wanted not in {"", *ROLES}:
        meant = near_miss(wanted, ROLES)
        raise DeclarationError(f"condition '{name}' has the role '{wanted}'; the roles are {', '.join(ROLES)}.{meant}")
    if condition.derived and wanted == "set":
        raise DeclarationError(
            f"condition '{name}' is derived by '{condition.derived}', so it cannot be set; leave out its role"
        )
    if condition.rate and condition.does != "goes_on":
        raise DeclarationError(
            f"condition '{name}' has the rate '{condition.rate}', but it does not go on; its role is \"goes_on\""
        )


@dataclass(frozen=True)
class Effect(Generic[I, R]):
    """Physics the model leaves out, with one to three unknowns, acting at one place.

    ``on_inputs(inputs, **unknowns, **conditions) -> inputs``: the model runs again and everything follows;
    ``on_results(inputs, results, ...) -> results``: a last term on a last result;
    ``on_reading(inputs, results, ...) -> results``: the gauge errs, not the machine.
    ``parts`` are groups of unknowns that a diagnosis looks for one by one (an offset of this gauge, of that gauge);
    without them all unknowns are one cause. The limit of three and the need of an amplitude hold for each part; a part
    of which nothing is stated is off: a function with ``**unknowns`` is called without it, any other with 0.
    ``reads`` names inputs or axes of results, beside the conditions, that a place ``along`` may lie on.
    ``acts_at_reference``: its conditions say where it acts (an angle) or temper it, and do not take it away.
    ``remedy`` is what to do about it: "shim the joint; the tilt then comes back to 0 at every load".
    """

    name: str
    _: KW_ONLY
    unknowns: Sequence[Unknown]
    on_inputs: Callable[Concatenate[I, ...], I] | None = None
    on_results: Callable[Concatenate[I, R, ...], R] | None = None
    on_reading: Callable[Concatenate[I, R, ...], R] | None = None
    needs: Sequence[Condition] = ()
    parts: Sequence[Sequence[str]] = ()
    reads: Sequence[str] = ()
    acts_at_reference: bool = False
    looks_like: str = ""
    remedy: str = ""
    why: str = ""
    source: str = ""

    def __post_init__(self) -> None:
        for name in ("unknowns", "needs", "reads"):
            object.__setattr__(self, name, tuple(getattr(self, name)))
        object.__setattr__(self, "parts", tuple(tuple(part) for part in self.parts))
        _check_effect(self)

    @property
    def place(self) -> ActsOn:
        """Where the effect acts: on the inputs, on the results or on the reading."""
        if self.on_inputs is not None:
            return "inputs"
        return "results" if self.on_results is not None else "reading"

    @property
    def function(self) -> Callable[..., Any]:
        """The function of that place."""
        given = (self.on_inputs, self.on_results, self.on_reading)
        return next(function for function in given if function is not None)

    @cached_property
    def takes_any(self) -> bool:
        """Whether the function takes whatever unknowns are stated (``**unknowns``)."""
        parameters = inspect.signature(self.function).parameters.values()
        return any(parameter.kind is inspect.Parameter.VAR_KEYWORD for parameter in parameters)

    def groups(self) -> tuple[tuple[Unknown, ...], ...]:
        """Return the unknowns by part, in the order declared; without parts all of them are one."""
        named = {unknown.name: unknown for unknown in self.unknowns}
        return tuple(tuple(named[name] for name in part) for part in self.parts) or (tuple(self.unknowns),)


def _check_effect(effect: Effect[Any, Any]) -> None:
    """Refuse an effect whose function does not fit its unknowns and conditions."""
    if sum(function is not None for function in (effect.on_inputs, effect.on_results, effect.on_reading)) != 1:
        raise DeclarationError(f"effect '{effect.name}' acts at one place: give on_inputs, on_results or on_reading")
    _check_parts(effect)
    for part in effect.groups():
        what = f"the part {', '.join(unknown.name for unknown in part)} of effect" if effect.parts else "effect"
        if not 1 <= len(part) <= MOST_UNKNOWNS:
            raise DeclarationError(f"{what} '{effect.name}' has {len(part)} unknowns; one to three can be found")
        if not any(unknown.is_amplitude for unknown in part):
            raise DeclarationError(f"{what} '{effect.name}' has no amplitude: one unknown's bounds must contain 0")
    seen = {*effect.reads, *(need.name for need in effect.needs)}
    for unknown in effect.unknowns:
        if unknown.along and unknown.along not in seen:
            raise DeclarationError(
                f"effect '{effect.name}': its unknown '{unknown.name}' lies along '{unknown.along}', which it does not "
                f"see; name it in needs (or, an input, in reads).{near_miss(unknown.along, seen)}"
            )
    wanted = {unknown.name for unknown in effect.unknowns} | {need.name for need in effect.needs}
    if len(wanted) != len(effect.unknowns) + len(effect.needs):
        raise DeclarationError(f"effect '{effect.name}' names an unknown or condition twice")
    _check_keywords(effect, wanted)


def _check_parts(effect: Effect[Any, Any]) -> None:
    if not effect.parts:
        return
    named = [name for part in effect.parts for name in part]
    known = [unknown.name for unknown in effect.unknowns]
    for name in named:
        if name not in known:
            raise DeclarationError(f"a part of effect '{effect.name}' names '{name}', which is no unknown of it")
        if named.count(name) > 1:
            raise DeclarationError(f"effect '{effect.name}': the unknown '{name}' stands in two parts")
    for name in known:
        if name not in named:
            raise DeclarationError(f"effect '{effect.name}': the unknown '{name}' stands in no part")


def _check_keywords(effect: Effect[Any, Any], wanted: set[str]) -> None:
    """Refuse a function whose keywords are not the unknowns and conditions; further ones need a default."""
    if effect.takes_any:
        return
    parameters = list(inspect.signature(effect.function).parameters.values())
    named = parameters[1 if effect.place == "inputs" else 2 :]
    needed = {parameter.name for parameter in named if parameter.default is inspect.Parameter.empty}
    if not needed <= wanted <= {parameter.name for parameter in named}:
        have = ", ".join(parameter.name for parameter in named) or "none"
        function = getattr(effect.function, "__name__", repr(effect.function))
        raise DeclarationError(
            f"effect '{effect.name}': {function} takes the keywords {have}, "
            f"but its unknowns and conditions are {', '.join(sorted(wanted))}"
        )


ErrorSource: TypeAlias = Tolerance | Correlated | Effect[I, R]
