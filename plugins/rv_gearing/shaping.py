"""A study of our own: which profile shifts make each group narrowest, and how narrow.

For every group of the search and every shift of a grid the least face width is sought at which all safeties, and the
distance to scuffing, are what is asked of them. Shifts that undercut a gear, leave its tip too sharp, or let too few
teeth meet are out. Of those left the one with the least width is taken.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rv_gearing.groups import Groups, search
from rv_gearing.quantities import Gearing
from rv_gearing.rating import HEAT, SAFETIES
from truing import Array, Bench, Block, Outcome, Table, TruingError

WIDEST, HALVINGS = 10.0, 15  # times the width of the run, either way; the last step is 0.02 % of the width
GEARS = ("sun", "planet")
OF_A_GEAR = ("tip_thickness", "start_curvature", "form_diameter", "base_diameter")
SHAPE = ("contact_ratio", *(f"{name}_{gear}" for name in OF_A_GEAR for gear in GEARS))
LEAST_CURVATURE = 1e-6  # of the base diameter: what is left of 0 by rounding


@dataclass(frozen=True, kw_only=True)
class Shifts:
    """Seek shifts and width of every group; the sum of the shifts stays as stated unless ``free_centre``.

    ``least_tip`` is the least tooth thickness at the tip, in modules; ``least_contact_ratio`` is transverse. ``low`` to
    ``high`` are the shifts of the sun that are tried, and of the planet where the centre distance is free.
    """

    least_tip: float = 0.3
    least_contact_ratio: float = 1.2
    low: float = -0.4
    high: float = 0.8
    points: int = 25
    free_centre: bool = False
    name: str = "shifts"
    gives: Callable[[Any], Any] | None = None

    def __post_init__(self) -> None:
        if not (self.points >= 2 and -1.5 <= self.low < self.high <= 1.5):
            raise TruingError(f"study '{self.name}': write -1.5 <= low < high <= 1.5, and at least 2 points")

    def run(self, bench: "Bench") -> "ShapedGroups":
        """Rate all groups with all shifts at once, and halve the width until each just lasts."""
        stage: Gearing = bench.inputs
        groups, grid = search(stage), self._grid(stage)
        number = len(groups) * len(grid)
        tried = {name: np.repeat(getattr(groups, name), len(grid)) for name in ("sun", "planet", "pins")}
        one, two = (np.tile(grid[:, place], len(groups)) for place in (0, 1))
        columns = {"sun_teeth": tried["sun"], "planet_teeth": tried["planet"], "pin_teeth": tried["pins"],
                   "shift_sun": one, "shift_planet": two}  # fmt: skip
        table = (len(groups), len(grid))
        if not number:
            return ShapedGroups(stage=stage, groups=groups, grid=grid, width=np.zeros(table), shape={}, study=self)
        shape = {name: values.reshape(table) for name, values in bench.rows(columns, number, *SHAPE).items()}
        allowed = self._allowed(float(stage.module), shape)
        width = _least_width(bench, columns, number, bench.part(self.name, 0.0, 1.0)).reshape(table)
        return ShapedGroups(stage=stage, groups=groups, grid=grid, shape=shape, study=self,
                            width=np.where(allowed, width, np.nan))  # fmt: skip

    def _grid(self, stage: Gearing) -> Array:
        """Return the shifts of sun and planet that are tried, (k, 2), those of the run first."""
        own = np.array([[float(stage.sun.shift), float(stage.planet.shift)]])
        line = np.linspace(self.low, self.high, self.points)
        if self.free_centre:
            pairs = np.stack(np.meshgrid(line, line, indexing="ij"), axis=-1).reshape(-1, 2)
        else:
            pairs = np.stack([line, own.sum() - line], axis=-1)
        return np.concatenate([own, pairs])

    def _allowed(self, module: float, shape: Mapping[str, Array]) -> NDArray[np.bool_]:
        """Say where neither gear is undercut or sharp, and enough teeth meet above both fillets."""
        good = shape["contact_ratio"] >= self.least_contact_ratio
        for gear in GEARS:
            tip, contact, form, base = (shape[f"{name}_{gear}"] for name in OF_A_GEAR)
            begin = 0.5 * np.sqrt(
                np.maximum(form**2 - base**2, 0.0)
            )  # curvature of the involute; 0 where it is undercut
            good = good & (begin > LEAST_CURVATURE * base) & (contact >= begin) & (tip >= self.least_tip * module)
        return np.asarray(good)


def _least_width(bench: "Bench", columns: Mapping[str, Array], number: int, done: Callable[[int, int], None]) -> Array:
    """Return the least face width of every row at which all that is asked of the stage holds, m; NaN where none."""
    stage: Gearing = bench.inputs
    asked = [float(stage.least_bending_safety)] * 2 + [float(stage.least_contact_safety)] * 2

    def lasts(width: Array) -> NDArray[np.bool_]:
        answers = bench.rows({**columns, "face_width": width}, number, *SAFETIES, *HEAT)
        safe = np.all([answers[name] >= least for name, least in zip(SAFETIES, asked, strict=True)], axis=0)
        return np.asarray(safe & (answers[HEAT[0]] <= answers[HEAT[1]]))

    own = float(stage.face_width)
    low, high = np.full(number, np.log(own / WIDEST)), np.full(number, np.log(own * WIDEST))
    ever = lasts(np.exp(high))
    for halving in range(HALVINGS):
        done(halving, HALVINGS)
        middle = 0.5 * (low + high)
        holds = lasts(np.exp(middle))
        low, high = np.where(holds, low, middle), np.where(holds, middle, high)
    return np.where(ever, np.exp(high), np.nan)


@dataclass(frozen=True, kw_only=True)
class ShapedGroups(Outcome):
    """Least width, m, of every group and shift (groups, shifts), NaN where it is not allowed or no width is enough.

    ``grid`` are the shifts of sun and planet (shifts, 2), the first those of the run.
    """

    stage: Gearing
    groups: Groups
    grid: Array
    width: Array
    shape: Mapping[str, Array]
    study: Shifts

    @property
    def best(self) -> Array:
        """The place of the best shift of each group in the grid, -1 where there is none; the first of equal ones."""
        known = np.where(np.isnan(self.width), np.inf, self.width)
        place = np.argmin(np.round(known, 7), axis=1) if known.size else np.zeros(len(known), dtype=np.intp)
        return np.where(np.isfinite(known).any(axis=1), place, -1)

    def as_json(self) -> Mapping[str, Any]:
        """Return shifts and width of every group; null where no shift does."""
        entries = [
            {"group": number, "sun": row[1], "planet": row[2], "shift_sun": row[3], "shift_planet": row[4],
             "face_width": {"value": row[6], "unit": "mm"}, "face_width_as_stated": {"value": row[5], "unit": "mm"}}
            for number, row in enumerate(self._rows(), 1)
        ]  # fmt: skip
        return {"free_centre": self.study.free_centre, "groups": entries}

    def _rows(self) -> list[tuple[float | None, ...]]:
        module = float(self.stage.module)
        rows: list[tuple[float | None, ...]] = []
        for number, place in enumerate(self.best):
            head = (float(number + 1), float(self.groups.sun[number]), float(self.groups.planet[number]))
            before = _printed(1e3 * self.width[number, 0])
            if place < 0:
                rows.append((*head, None, None, before, None, None, None, None))
                continue
            tips = [float(self.shape[f"tip_thickness_{gear}"][number, place]) / module for gear in GEARS]
            shifts = (round(float(each), 3) for each in self.grid[place])
            shape = (float(self.shape["contact_ratio"][number, place]), *tips)
            width = _printed(1e3 * self.width[number, place])
            rows.append((*head, *shifts, before, width, *(round(each, 3) for each in shape)))
        return rows

    def blocks(self) -> Sequence[Block]:
        """Return the groups as a table."""
        study = self.study
        centre = "and so the centre distance is free" if study.free_centre else "and the centre distance stays"
        note = (
            f"Shifts from {study.low:g} to {study.high:g} at {study.points} places, {centre}. No gear is undercut, no "
            f"tip thinner than {study.least_tip:g} modules, the contact ratio at least {study.least_contact_ratio:g}; "
            "the width is the least at which all safeties and the distance to scuffing are what is asked. Empty: "
            "undercut, sharp, or not strong enough at ten times the width of the run."
        )
        columns = ("no.", "sun", "planet", "shift, sun", "shift, planet", "width as stated", "width", "contact ratio",
                   "tip, sun", "tip, planet")  # fmt: skip
        units = ("", "", "", "", "", "mm", "mm", "", "m", "m")
        return [Table("Shifts that make each group narrowest", columns, self._rows(), units, note)]


def _printed(value: float) -> float | None:
    return round(float(value), 2) if np.isfinite(value) else None
