"""A study of our own: the backlash of machines when new, the paper's Fig. 4, and after their working time."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing import Bench, Block, Check, TruingError

ARCMIN = 3.141592653589793 / 10800.0
MOST = 100_000


@dataclass(frozen=True, kw_only=True)
class NewMachines:
    """Draw ``draws`` machines, the first ones of the study 'reliability', and keep the backlash of each."""

    draws: int = 2000
    name: str = "new_machines"
    gives: Callable[[Any], Any] | None = None

    def __post_init__(self) -> None:
        if not 2 <= self.draws <= MOST:
            raise TruingError(f"study '{self.name}': draws = {self.draws}, but 2 to {MOST} machines can be shown")

    def run(self, bench: "Bench") -> "Newborn":
        """Calculate each machine twice: without any working time, and with that of the run."""
        columns = bench.drawn(self.draws)
        as_new = {name: values for name, values in columns.items() if name != "working_time"}
        return Newborn(
            new=bench.changed({"working_time": 0.0}).rows(as_new, self.draws, "backlash")["backlash"],
            used=bench.rows(columns, self.draws, "backlash")["backlash"],
            limit=float(bench.setup.inputs.permitted_backlash),
            inputs=bench.inputs,
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Newborn:
    """Backlash of machines (n,) in rad, new and after the working time, NaN where one cannot be; the permitted one."""

    new: "NDArray[np.float64]"
    used: "NDArray[np.float64]"
    limit: float
    inputs: Any = None

    def as_json(self) -> Mapping[str, Any]:
        """Return mean, standard deviation, largest backlash and the share above the limit, new and used."""
        return {
            "draws": len(self.new),
            **{when: self._summary(values) for when, values in (("new", self.new), ("used", self.used))},
        }

    def _summary(self, values: "NDArray[np.float64]") -> dict[str, Any]:
        known = values[np.isfinite(values)]
        if len(known) < 2:
            return {"failed": len(values)}
        return {
            "unit": "arcmin",
            "mean": float(known.mean()) / ARCMIN,
            "sd": float(known.std(ddof=1)) / ARCMIN,
            "largest": float(known.max()) / ARCMIN,
            "within": float(np.mean(values <= self.limit)),
            "failed": len(values) - len(known),
        }

    def blocks(self) -> "Sequence[Block]":
        """Return nothing: the section on reliability shows the machines."""
        return ()

    def checks(self) -> "Sequence[Check]":
        """Return nothing: the study 'reliability' decides the limit."""
        return ()

    def warnings(self) -> Sequence[str]:
        """Return nothing."""
        return ()
