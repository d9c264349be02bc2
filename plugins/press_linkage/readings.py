"""A study of our own: the same press under both readings of the paper's tolerances, side by side."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from press_linkage.mechanism import permitted_tilt
from truing import Allocation, Allotted, Bench, Block, Check, Table

READINGS = ("printed", "complete")
CHECKS = {"slider_position": "position", "slider_tilt": "tilt"}


@dataclass(frozen=True, kw_only=True)
class Readings:
    """Reliability and synthesis under the readings ``printed`` and ``complete``, first order.

    ``finest`` is the finest grade of the synthesis.
    """

    finest: str = "IT5"
    name: str = "readings"
    gives: Callable[[Any], Any] | None = None

    def run(self, bench: "Bench") -> "Compared":
        """Allocate under each reading; whatever the inputs file says of tolerances holds for both."""
        study = Allocation(of="slider_position", finest=self.finest, draws=1, name=self.name)
        found = {}
        for place, reading in enumerate(READINGS):
            press = replace(bench.setup.inputs, reading=reading)
            answers = {**bench.answers, "permitted_tilt": permitted_tilt(press)}
            setup = replace(bench.setup, inputs=press)
            told = _part(bench, self.name, place)
            own = replace(bench, setup=setup, answers=answers, progress=told)
            found[reading] = study.run(own)
        return Compared(found, self.finest)


def _part(bench: "Bench", name: str, place: int) -> Callable[[str, int, int], None]:
    """Return what reports the study of one reading as its part of this one."""
    done = bench.part(name, place / len(READINGS), (place + 1) / len(READINGS))
    return lambda task, step, steps: done(step, steps)


@dataclass(frozen=True)
class Compared:
    """What each reading comes to."""

    by_reading: Mapping[str, Allotted]
    finest: str = "IT5"

    def as_json(self) -> dict[str, Any]:
        """Return reliabilities before and after, adjustments, and whether the goals are reached."""
        return {
            reading: {
                "start": dict(found.start),
                "final": dict(found.final),
                "adjustments": found.adjustments,
                "reached": found.reached,
            }
            for reading, found in self.by_reading.items()
        }

    def table(self) -> Table:
        """Return both readings as a table of the sheet."""
        rows: list[tuple[str | int | float | bool, ...]] = []
        for reading, found in self.by_reading.items():
            chances = [100 * chance[check] for check in CHECKS for chance in (found.start, found.final)]
            rows.append((reading, *chances, found.adjustments, found.reached))
        columns = [f"{name} {when}" for name in CHECKS.values() for when in ("start", "final")]
        return Table(
            "Reliability under both readings",
            ("reading", *columns, "adjustments", "goals reached"),
            rows,
            ("", "%", "%", "%", "%", "", ""),
            f"First order, links down to {self.finest}. Tolerances that the inputs file states hold for both.",
        )

    def blocks(self) -> Sequence[Block]:
        """Return nothing: a section of the sheet shows the table."""
        return ()

    def checks(self) -> "Sequence[Check]":
        """Return nothing: only the reading of the inputs decides limits."""
        return ()

    def warnings(self) -> Sequence[str]:
        """Return nothing."""
        return ()
