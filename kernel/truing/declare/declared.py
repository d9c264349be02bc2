"""What a model declares, as its own checks and the kernel's own effects see it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

from truing.declare.fields import InputField, ResultField
from truing.declare.goals import Objective
from truing.declare.sources import Condition, Effect, ErrorSource, Tolerance


class NamedStudy(Protocol):
    """A study, as far as a model asks: its name, and what turns its outcome into results."""

    @property
    def name(self) -> str:
        """The key in results.json and in ``[studies]``."""

    @property
    def gives(self) -> Callable[[Any], Any] | None:
        """Turns the outcome into results of the model, or None."""


class Declared(Protocol):
    """A model's words, and its fields by flat name (see ``declare.model.Model``)."""

    @property
    def name(self) -> str: ...  # noqa: D102
    @property
    def errors(self) -> Sequence[ErrorSource[Any, Any]]: ...  # noqa: D102
    @property
    def objectives(self) -> Sequence[Objective]: ...  # noqa: D102
    @property
    def studies(self) -> Sequence[NamedStudy]: ...  # noqa: D102
    @property
    def sheet(self) -> Sequence[Any]: ...  # noqa: D102
    @property
    def exceptions(self) -> Mapping[Any, str]: ...  # noqa: D102
    @property
    def input_type(self) -> type[Any]: ...  # noqa: D102
    @property
    def result_type(self) -> type[Any]: ...  # noqa: D102
    @property
    def input_fields(self) -> dict[str, InputField]: ...  # noqa: D102
    @property
    def own_result_fields(self) -> dict[str, ResultField]: ...  # noqa: D102
    @property
    def measurable(self) -> list[str]: ...  # noqa: D102
    @property
    def study_result_fields(self) -> dict[str, dict[str, ResultField]]: ...  # noqa: D102
    @property
    def result_fields(self) -> dict[str, ResultField]: ...  # noqa: D102
    @property
    def tolerances(self) -> dict[str, Tolerance]: ...  # noqa: D102
    @property
    def effects(self) -> dict[str, Effect[Any, Any]]: ...  # noqa: D102
    @property
    def conditions(self) -> dict[str, Condition]: ...  # noqa: D102
