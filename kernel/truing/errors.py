"""Every exception of Truing, in one tree.

::

    TruingError                    catch this one and nothing else
    ├── UsageError                 exit 2: the caller can mend it
    │   ├── UnitError              a text that is no quantity, or of the wrong dimension
    │   ├── InputError             faults of an input file, all of them, each with its line
    │   ├── InfeasibleError        the inputs describe something impossible (geometry, physics)
    │   ├── OutputError            the result has nowhere to go
    │   └── UnknownPluginError     no plugin or model of that name
    ├── PluginError                exit 3: a plugin failed while it was loaded or run
    │   └── DeclarationError       a calculation is declared wrongly
    ├── ConvergenceError           exit 4: an iteration or a search did not arrive
    └── LostWorkersError           exit 2: the processes or the cluster that computed are gone, and work with them
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


class TruingError(Exception):
    """Anything that Truing has to say against a calculation; one sentence, no traceback needed."""

    exit_code = 1


class UsageError(TruingError):
    """What the caller gave cannot be used as it stands."""

    exit_code = 2


class UnitError(UsageError, ValueError):
    """A text that is no quantity, or one of the wrong dimension."""


@dataclass(frozen=True, slots=True)
class Fault:
    """One thing wrong with one file: the sentence, and where it stands: in a line, or in a cell of a workbook."""

    message: str
    file: str = ""
    line: int | None = None
    cell: str = ""

    def __str__(self) -> str:
        if not self.file:
            return self.message
        if self.cell:
            return f"{self.file}, {self.cell}: {self.message}"
        return f"{self.file}:{self.line}: {self.message}" if self.line else f"{self.file}: {self.message}"


class InputError(UsageError):
    """Every fault of the files that were read, collected before anything is said."""

    def __init__(self, faults: Sequence[Fault]) -> None:
        self.faults = tuple(faults)
        super().__init__("\n".join(str(fault) for fault in self.faults))


class InfeasibleError(UsageError):
    """The inputs are well formed and describe something that cannot exist."""


class OutputError(UsageError):
    """The result cannot be written where it was asked for."""


class UnknownPluginError(UsageError):
    """No plugin, model or run of that name."""


class PluginError(TruingError):
    """A plugin failed while it was loaded or run; the fault is in its code."""

    exit_code = 3


class DeclarationError(PluginError):
    """A calculation is declared wrongly: found before anything runs. ``place`` is file and line where known."""

    def __init__(self, sentence: str, place: tuple[str, int | None] | None = None) -> None:
        super().__init__(sentence)
        self.place = place


class ConvergenceError(TruingError):
    """An iteration or a search ended without arriving."""

    exit_code = 4


class LostWorkersError(TruingError):
    """The processes or the cluster that computed are gone, and their work with them; the inputs are not to blame."""

    exit_code = 2
