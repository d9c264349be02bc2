"""What an input is taken from: a result of another calculation, named before that one is known."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Taken:
    """A result, or an input, of another calculation that stands for an input; ``settings`` are inputs of that one.

    ``model`` is the name by which the command line knows it, ``called`` its name in the chain where that is another.
    """

    model: str
    result: str
    settings: Mapping[str, Any] = field(default_factory=dict)
    called: str = ""


@dataclass(frozen=True)
class OtherModel:
    """Another calculation, of which every attribute is a result to take: ``from_model("rv_gearing").output_torque``."""

    name: str
    settings: Mapping[str, Any]
    called: str = ""

    def __getattr__(self, result: str) -> Taken:
        """Name one of its results, or of its inputs, by the flat name."""
        if result.startswith("__"):
            raise AttributeError(result)
        return Taken(self.name, result, self.settings, self.called)


def from_model(name: str, called: str = "", /, **settings: Any) -> OtherModel:
    """Name another calculation, whose results, and inputs, may stand for inputs of one's own.

    A calculation of which a chain has two is ``called`` by a name for each: ``from_model("rv_gearing", "first")``.

    ``settings`` state inputs of it, as texts with units or numbers in the declared unit. In a declaration:
    ``torque: Float = given(from_model("rv_gearing", group=5).output_torque, "N*m")``; in a call:
    ``model.run(output_torque=from_model("rv_gearing").output_torque)``.
    """
    return OtherModel(name, settings, called)
