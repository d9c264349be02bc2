"""What the author of a plugin tests with: every promise of a calculation, and whether its effects can be found.

In a test file of your plugin::

    from my_plugin import MY_MODEL
    from truing.testing import assert_finds, conformance, hide

    test_my_model = conformance(MY_MODEL)

    def test_settling_is_found() -> None:
        assert_finds(hide("settling", "4 um", noise="0.1 kN", model=MY_MODEL, over={"torque": "60..110 N*m"}))

    def test_it_runs(calc) -> None:
        assert calc("run", "my_plugin").code == 0

Needs pytest (``truing[testing]``), which then knows the fixtures of ``truing.testing.fixtures`` by itself.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from truing.testing.finding import assert_finds, assert_finds_nothing, finds_every_effect
    from truing.testing.fixtures import Answer, Calc, CalcProcess
    from truing.testing.hiding import Answered, Hidden, hide, recorded
    from truing.testing.kit import CHECKS, ConformanceCheck, conformance, failures

_HOMES = {
    "truing.testing.finding": ("assert_finds", "assert_finds_nothing", "finds_every_effect"),
    "truing.testing.fixtures": ("Answer", "Calc", "CalcProcess"),
    "truing.testing.hiding": ("Answered", "Hidden", "hide", "recorded"),
    "truing.testing.kit": ("CHECKS", "ConformanceCheck", "conformance", "failures"),
}
_HOME = {name: module for module, names in _HOMES.items() for name in names}

__all__ = [  # noqa: RUF022  # in the order of the page
    "conformance", "failures", "CHECKS", "ConformanceCheck",
    "hide", "Hidden", "assert_finds", "assert_finds_nothing", "finds_every_effect", "recorded", "Answered",
    "Answer", "Calc", "CalcProcess",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    """Import a name when it is first used: pytest loads the fixtures of this package wherever Truing is installed."""
    if name not in _HOME:
        raise AttributeError(f"module 'truing.testing' has no attribute '{name}'")

    value = getattr(import_module(_HOME[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(set(globals()) | set(__all__))
