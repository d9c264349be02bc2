"""The model under test: its setup at the defaults, and points near them that it can answer."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from types import ModuleType
from typing import Any, NoReturn

import numpy as np

from truing.declare.chain import chain_of
from truing.declare.fields import Given, InputField, with_values
from truing.declare.model import Model
from truing.errors import InfeasibleError, TruingError, UsageError
from truing.evaluate import evaluate
from truing.inputs_file import read_setup
from truing.inputs_file.values import broken_bound
from truing.kernel import Kernel, Offer, Origin
from truing.kernel.loading import PREFIX
from truing.setup import Setup, default_setup
from truing.units import difference_unit, to_si, unit_factor

ATTEMPTS = 12
NARROWER = (0.1, 0.03, 0.01, 1e-3, 1e-4, 1e-6)


def fail(sentence: str) -> NoReturn:
    """End a check with the sentence that its reader needs; pytest points at the test that asked for it."""
    __tracebackhide__ = True
    raise AssertionError(sentence)


@dataclass(frozen=True)
class Subject:
    """One model, with what every check asks of it; ``origin`` tells another process where to find it."""

    model: Model[Any, Any]
    origin: Origin | None = None

    @cached_property
    def offer(self) -> Offer:
        """The model as the command line would offer it."""
        name = self.model.name
        origin = self.home or Origin(name, "", "", "", f"entry:{name}")
        name, chain = name if origin.name == name else f"{origin.name}.{name}", chain_of(self.model)
        parts = {} if chain is None else {**chain.calculations, name: chain.last}
        beside = {part: Offer(part, model, origin) for part, model in parts.items()}
        return Offer(name, self.model, origin, beside=beside)

    @cached_property
    def home(self) -> Origin | None:
        """The plugin that offers the model, as another process finds it; None where none does."""
        if self.origin is not None:
            return self.origin
        parts = self.model.function.__module__.split(".")
        names = [".".join(parts[:count]) for count in range(len(parts), 0, -1)]
        modules = [module for name in names if (module := sys.modules.get(name)) and getattr(module, "__spec__", None)]
        for module in modules:
            if not hasattr(module, "truing_models"):
                continue
            for offer in _offers(module):
                if offer.model.function is self.model.function and offer.model.name == self.model.name:
                    return offer.origin
        return None

    @cached_property
    def setup(self) -> Setup:
        """The defaults; where a data file has none, the shipped example."""
        try:
            return default_setup(self.model)
        except UsageError:
            if self.model.example is None:
                raise
            return read_setup(self.model.example, self.offer)

    @cached_property
    def obstacle(self) -> str:
        """Why the model cannot be run at its defaults, or nothing."""
        try:
            evaluate(self.setup)
        except TruingError as error:
            return str(error)
        return ""

    @property
    def scattering(self) -> dict[str, InputField]:
        """The inputs that a batch can vary."""
        return {name: field for name, field in self.model.input_fields.items() if field.varies}

    def at(self, point: Mapping[str, float]) -> Setup:
        """Return the setup with these inputs, SI."""
        fields = self.model.input_fields
        changed = {fields[name].path: value for name, value in point.items()}
        return replace(self.setup, inputs=with_values(self.setup.inputs, changed))

    def points(self, count: int) -> list[dict[str, float]]:
        """Return inputs in SI near the defaults, within their bounds, that the model can answer; the same every time.

        Every input moves by up to a tenth of its value, or by three standard deviations or a tenth of its unit where
        it is 0; by less where the model finds that impossible.
        """
        if count not in self._found:
            self._found[count] = self._new_points(count)
        return [dict(point) for point in self._found[count]]

    @cached_property
    def _found(self) -> dict[int, list[dict[str, float]]]:
        """The points that were found already, by their number: they serve many checks."""
        return {}

    def _new_points(self, count: int) -> list[dict[str, float]]:
        rng = np.random.default_rng(20)
        points: list[dict[str, float]] = []
        for share in NARROWER:
            for _ in range(ATTEMPTS + count):
                if len(points) == count:
                    return points
                point = {name: self.near(field, share, rng) for name, field in self.scattering.items()}
                with suppress(InfeasibleError):
                    evaluate(self.at(point))
                    points.append(point)
        fail(f"{self.model.name}: no point within a millionth of the defaults can be calculated; state what must hold")

    def near(self, field: InputField, share: float, rng: np.random.Generator) -> float:
        """Draw a value of an input within its bounds, SI, up to so large a share of its own away from that."""
        value, spec = float(self.setup.nominal(field.name)), field.spec
        assert isinstance(spec, Given)
        if value != value or (spec.whole and share < 0.1):
            return value
        if spec.whole:
            moved = value + float(rng.integers(-1, 2))
        else:
            moved = value + share * self._span(field, value) * float(rng.uniform(-1, 1))
        moved = max(moved, to_si(spec.at_least, field.unit)) if spec.at_least is not None else moved
        moved = min(moved, to_si(spec.at_most, field.unit)) if spec.at_most is not None else moved
        return value if broken_bound(field, moved) else moved

    def _span(self, field: InputField, value: float) -> float:
        """Return how far a tenth of the input reaches, times ten."""
        if difference_unit(field.unit) != field.unit:
            return 100 * unit_factor(field.unit)
        if value:
            return abs(value)
        return self._widest.get(field.name, 0.0) * 30 or unit_factor(field.unit)

    @cached_property
    def _widest(self) -> dict[str, float]:
        """The largest standard deviation declared on each input, where it resolves."""
        widest: dict[str, float] = {}
        try:
            spreads = self.setup.distributions()
        except TruingError:
            return widest
        for inner in spreads.values():
            for name, distribution in inner.items():
                widest[name] = max(widest.get(name, 0.0), distribution.sd)
        return widest


def _offers(module: ModuleType) -> Sequence[Offer]:
    """Return what a module offers; of a file whose plain name another module has, as found by its path."""
    if not module.__name__.startswith(PREFIX):
        return list(Kernel([module]).offers.values())
    kernel = Kernel()
    kernel.add_file(Path(str(module.__file__)))
    return list(kernel.offers.values())
