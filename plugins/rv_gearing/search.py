"""A study of our own: all groups of tooth numbers that meet the five conditions, sorted as wished, with strength."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from rv_gearing.groups import Groups, chosen_teeth, search
from rv_gearing.preference import reason_of
from rv_gearing.quantities import Gearing
from truing import Bench, Block, Check, Float, TruingError, found, results, rows

Values = NDArray[np.float64]

Column = Literal[
    "group", "sun", "planet", "pins", "ratio", "deviation", "torque", "centre_distance", "circle_low", "circle_high",
    "common_first", "common_second", "planet_kinds", "mesh_phases", "preference", "root_stress_sun",
    "root_stress_planet", "contact_stress_sun", "contact_stress_planet", "root_safety_sun", "root_safety_planet",
    "contact_safety_sun", "contact_safety_planet",
]  # fmt: skip
STRENGTH: tuple[Column, ...] = (
    "root_stress_sun", "root_stress_planet", "contact_stress_sun", "contact_stress_planet", "root_safety_sun",
    "root_safety_planet", "contact_safety_sun", "contact_safety_planet",
)  # fmt: skip
SIZES: tuple[Column, ...] = (
    "sun", "planet", "pins", "ratio", "deviation", "torque", "centre_distance", "circle_low", "circle_high",
)  # fmt: skip
MEETING: tuple[Column, ...] = ("common_first", "common_second", "planet_kinds", "mesh_phases", "preference")
PERMITTED = (
    "permitted_root_stress_sun", "permitted_root_stress_planet", "permitted_contact_stress_sun",
    "permitted_contact_stress_planet",
)  # fmt: skip
PRINTED = {"deviation": ("%", 100.0), "torque": ("N*m", 1.0)} | dict.fromkeys(
    ("centre_distance", "circle_low", "circle_high"), ("mm", 1e3)
)
EXACT = 1e-12
SCATTER = 0.004  # of the efficiency of a bearing: four standard deviations of its tolerance
CONDITIONS = "meets all five conditions of section 2 of the paper"


@results
class Listed:
    """The groups as a table, in the order asked for."""

    group_count: Float = found("", symbol="N", note="groups of tooth numbers", method=CONDITIONS)
    exact_count: Float = found("", symbol="N_0", note="of them with just the wanted ratio", method="counted")
    group_number: Float = rows("number of the group")
    group_sun_teeth: Float = found("", symbol="Z_1", along="group_number", note="teeth of the sun")
    group_planet_teeth: Float = found("", symbol="Z_2", along="group_number", note="teeth of the planet")
    group_pins: Float = found("", symbol="Z_5", along="group_number", note="pins")
    group_ratio: Float = found("", symbol="i", along="group_number", note="ratio", source="equation 1")
    group_deviation: Float = found("%", symbol="Delta i", along="group_number", note="deviation of the ratio",
                                   source="equation 2")  # fmt: skip
    group_torque: Float = found("N*m", symbol="T", along="group_number", note="output torque", source="equation 5")
    group_centre_distance: Float = found("mm", symbol="a_0", along="group_number", note="centre distance")
    group_circle_low: Float = found("mm", symbol="R_p,min", along="group_number", note="least radius of the pin circle",
                                    source="equations 3 and 4")  # fmt: skip
    group_circle_high: Float = found("mm", symbol="R_p,max", along="group_number",
                                     note="largest radius of the pin circle",
                                     source="equations 3 and 4")  # fmt: skip
    group_common_first: Float = found("", symbol="g_1", along="group_number", note="largest common factor of the teeth "
                                      "of sun and planet; 1: hunting teeth")  # fmt: skip
    group_common_second: Float = found("", symbol="g_2", along="group_number",
                                       note="largest common factor of the teeth of a disc and the pins")  # fmt: skip
    group_planet_kinds: Float = found("", symbol="n_k", along="group_number", note="kinds of planet, by the angle "
                                      "between crank and teeth, for equal spacing; 1: all alike")  # fmt: skip
    group_mesh_phases: Float = found("", symbol="n_f", along="group_number", note="phases in which the planets mesh; "
                                     "1: all carry alike at any moment")  # fmt: skip
    group_preference: Float = found("", symbol="r", along="group_number", note="1: hunting teeth and planets in phase, "
                                    "better; 2: hunting teeth; 3: planets in phase; 4: neither; none: planets touch",
                                    )  # fmt: skip
    group_root_stress_sun: Float = found("MPa", symbol="sigma_F1", along="group_number", note="root stress of the sun")
    group_root_stress_planet: Float = found(
        "MPa", symbol="sigma_F2", along="group_number", note="root stress of the planet"
    )
    group_contact_stress_sun: Float = found("MPa", symbol="sigma_H1", along="group_number",
                                            note="contact stress of the sun")  # fmt: skip
    group_contact_stress_planet: Float = found("MPa", symbol="sigma_H2", along="group_number",
                                               note="contact stress of the planet")  # fmt: skip
    group_root_safety_sun: Float = found("", symbol="S_F1", along="group_number", note="safety of the sun, breakage")
    group_root_safety_planet: Float = found("", symbol="S_F2", along="group_number",
                                            note="safety of the planet, breakage")  # fmt: skip
    group_contact_safety_sun: Float = found("", symbol="S_H1", along="group_number", note="safety of the sun, pitting")
    group_contact_safety_planet: Float = found("", symbol="S_H2", along="group_number",
                                               note="safety of the planet, pitting")  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Search:
    """List all groups, sorted by one column; ``exact_only`` keeps those with just the wanted ratio."""

    sort_by: Column = "group"
    descending: bool = False
    exact_only: bool = False
    name: str = "search"
    gives: Callable[[Any], Any] | None = None

    def __post_init__(self) -> None:
        if self.sort_by not in ("group", *SIZES, *MEETING, *STRENGTH):
            raise TruingError(f"study '{self.name}': the groups have no column '{self.sort_by}'")

    def run(self, bench: "Bench") -> "Found":
        """Search with the duty of the inputs, and rate every group in one call."""
        stage: Gearing = bench.inputs
        groups = search(stage)
        numbers = np.arange(1.0, len(groups) + 1.0)
        exact = np.abs(groups.deviation) <= EXACT
        kept = np.flatnonzero(exact) if self.exact_only else np.arange(len(groups))
        shown = Found(
            name=self.name,
            inputs=stage,
            count=len(groups),
            exact=int(np.sum(exact)),
            groups=groups.at(kept),
            numbers=numbers[kept],
            strength=_strength(bench, groups.at(kept)),
            rated=_rated(stage, groups),
            stable=_stable(stage, groups),
            sort_by=self.sort_by,
            descending=self.descending,
        )
        return shown.sorted()


def _strength(bench: "Bench", groups: Groups) -> dict[str, "Values"]:
    """Stresses and safeties of every group under the load of the inputs; NaN where a group cannot be rated."""
    asked = (*STRENGTH, *PERMITTED)
    known = [name for name in asked if name in bench.setup.model.own_result_fields]
    columns = {"sun_teeth": groups.sun, "planet_teeth": groups.planet, "pin_teeth": groups.pins}
    answers = bench.rows(columns, len(groups), *known) if len(groups) else {}
    return {name: np.asarray(answers.get(name, np.full(len(groups), np.nan))) for name in asked}


def _rated(stage: Gearing, groups: Groups) -> int | None:
    """The number of the group that is rated, None where its teeth are stated and in none."""
    teeth = chosen_teeth(stage)
    same = (groups.sun == teeth.sun) & (groups.planet == teeth.planet) & (groups.pins == teeth.pins)
    return int(np.argmax(same)) + 1 if np.any(same) else None


def _stable(stage: Gearing, groups: Groups) -> bool:
    """Whether the number of the rated group stays with that group while the efficiency scatters a little."""
    if not np.isnan(stage.sun_teeth):
        return True
    own = [each[: stage.group] for each in (groups.sun, groups.planet, groups.pins)]
    for factor in (1.0 - SCATTER, 1.0 + SCATTER):
        other = search(replace(stage, bearing_efficiency=np.minimum(stage.bearing_efficiency * factor, 1.0)))
        others = (other.sun, other.planet, other.pins)
        if not all(np.array_equal(one, two[: stage.group]) for one, two in zip(own, others, strict=True)):
            return False
    return True


@dataclass(frozen=True, kw_only=True)
class Found:
    """Groups with their numbers and strength, (groups,) in SI; how many there are in all; which is rated.

    ``stable`` says that the rated number keeps its teeth while the efficiency of the bearings scatters.
    """

    name: str
    inputs: Gearing
    count: int
    exact: int
    groups: Groups
    numbers: "Values"
    strength: Mapping[str, "Values"]
    rated: int | None
    stable: bool
    sort_by: Column
    descending: bool

    def column(self, name: Column) -> "Values":
        """Return one column, SI."""
        if name == "group":
            return self.numbers
        return self.strength[name] if name in self.strength else np.asarray(getattr(self.groups, name))

    def sorted(self) -> "Found":
        """Return the same in the order that was asked for; a deviation counts by its size, NaN comes last."""
        key = self.column(self.sort_by)
        key = np.abs(key) if self.sort_by == "deviation" else key
        order = np.argsort(-key if self.descending else key, kind="stable")
        return replace(
            self,
            groups=self.groups.at(order),
            numbers=self.numbers[order],
            strength={name: values[order] for name, values in self.strength.items()},
        )

    def as_json(self) -> Mapping[str, Any]:
        """Return counts, the rated group and every column in its printed unit; null where there is no answer."""
        columns = {}
        for name in ("group", *SIZES, *MEETING, *STRENGTH):
            unit, factor = printed_in(name)
            values = [float(value) * factor if np.isfinite(value) else None for value in self.column(name)]
            columns[name] = {"unit": unit, "values": values}
        return {
            "count": self.count,
            "exact": self.exact,
            "rated": self.rated,
            "sort_by": self.sort_by,
            "descending": self.descending,
            "groups": columns,
            "reasons": self.reasons(),
        }

    def reasons(self) -> list[str]:
        """Say of every group why it has its preference."""
        told = ("common_first", "mesh_phases", "planet_kinds", "preference")
        asked = zip(*(getattr(self.groups, name) for name in told), strict=True)
        return [reason_of(*map(float, values)) for values in asked]

    def blocks(self) -> Sequence[Block]:
        """Return nothing: the section on the search shows tables and figures where they are read."""
        return ()

    def checks(self) -> "Sequence[Check]":
        """Return nothing: a list decides no limit."""
        return ()

    def warnings(self) -> Sequence[str]:
        """Say that there is no group, or that none is the one that is rated."""
        if not self.count:
            return [f"study '{self.name}': no group of tooth numbers meets all conditions"]
        if self.rated is None:
            return [
                f"study '{self.name}': the stated teeth are none of the {self.count} groups that meet all conditions"
            ]
        if not self.stable:
            return [
                f"study '{self.name}': a group lies so near the edge of the window that number {self.rated} is another "
                "one with a slightly different efficiency; state sun_teeth, planet_teeth and pin_teeth instead"
            ]
        return ()


def printed_in(name: str) -> tuple[str, float]:
    """The unit a column is printed in, and the factor from SI to it."""
    return ("MPa", 1e-6) if "stress" in name else PRINTED.get(name, ("", 1.0))


def listed(found: Found) -> Listed:
    """The table as results of the run."""
    names: dict[str, Column] = {"group_sun_teeth": "sun", "group_planet_teeth": "planet"}
    columns = {f"group_{name}": found.column(name) for name in (*SIZES[2:], *MEETING, *STRENGTH)}
    return Listed(
        group_count=float(found.count),
        exact_count=float(found.exact),
        group_number=found.numbers,
        **{name: found.column(column) for name, column in names.items()},
        **columns,
    )
