"""Shapes that nobody registered, and the smooth families with which anybody could imitate them."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from math import pi

import numpy as np
from numpy.polynomial.legendre import legvander

from hidden_effects.press_machine import Array, Rows

COVARIATES = ("crank_angle", "forming_force", "link_temperature", "time", "strokes", "speed", "direction")
SMOOTH = tuple(name for name in COVARIATES if name != "direction")
Curve = Callable[[Rows], Array]


@dataclass(frozen=True)
class Shape:
    """A curve over the rows that no registered effect has: what it depends on, and its size by result in SI.

    ``also`` names a registered effect that is as good a name for it (a late step, a third order).
    """

    text: str
    depends_on: tuple[str, ...]
    curve: Curve
    sizes: tuple[tuple[str, float], ...] = ()
    also: str = ""
    family: Curve | None = field(default=None, compare=False)

    def of(self, rows: Rows, results: Sequence[str]) -> Array:
        """What it adds to the readings, one result after another."""
        sizes = dict(self.sizes)
        return np.concatenate([sizes.get(result, 0.0) * self.curve(rows) for result in results])

    def columns(self, rows: Rows, results: Sequence[str]) -> Array:
        """The curve of every result in which it shows by itself, (rows * results, results)."""
        sizes = dict(self.sizes)
        shows = np.diag([1.0 if sizes.get(result) else 0.0 for result in results])
        return np.asarray(np.kron(shows, self.curve(rows)[:, None]), dtype=float)


def scaled(values: Array) -> Array:
    """Values as -1 to 1 over the record; 0 where they do not change."""
    width = np.ptp(values)
    return np.asarray(2 * (values - values.min()) / width - 1 if width > 0 else np.zeros_like(values))


def _between(name: str, rows: Rows, start: Rows) -> Array:
    """A covariate as -1 to 1 over the record that ``start`` spans, for other rows of it too."""
    span = getattr(start, name)
    return np.asarray(2 * (getattr(rows, name) - span.min()) / np.ptp(span) - 1)


def waves(angle: Array) -> Array:
    """A wave of any phase, beside an offset."""
    return np.column_stack([np.ones(len(angle)), np.cos(angle), np.sin(angle)])


def order(rows: Rows, rng: np.random.Generator) -> Shape:
    """A waviness of order 3 to 9 of the crank angle."""
    number, phase = int(rng.integers(3, 10)), rng.uniform(0, 2 * pi)
    return Shape(
        f"order {number} of crank_angle", ("crank_angle",), lambda at: np.cos(number * at.crank_angle + phase),
        also="periodic_order" if number == 3 else "", family=lambda at: waves(number * at.crank_angle),
    )  # fmt: skip


def step_at(after: float) -> Shape:
    """Something slips at one moment."""

    def curve(at: Rows) -> Array:
        return np.where(at.time >= after, 1.0, 0.0)

    def family(at: Rows) -> Array:
        return np.column_stack([np.ones(len(at)), curve(at)])

    return Shape("late step in time", ("time",), curve, also="step", family=family)


def late_step(rows: Rows, rng: np.random.Generator) -> Shape:
    """Something slips in the second half of the record."""
    return step_at(rng.uniform(0.5, 0.85) * float(rows.time[-1]))


def product_of_two(rows: Rows, rng: np.random.Generator) -> Shape:
    """Two things that only matter together."""
    pairs = [("forming_force", "link_temperature"), ("speed", "link_temperature"), ("forming_force", "speed"),
             ("crank_angle", "link_temperature"), ("speed", "time"), ("forming_force", "strokes")]  # fmt: skip
    one, two = pairs[int(rng.integers(len(pairs)))]
    return Shape(
        f"product of {one} and {two}", (one, two), lambda at: _between(one, at, rows) * _between(two, at, rows)
    )


def valley(rows: Rows, rng: np.random.Generator) -> Shape:
    """Best in the middle of a range, worse on both sides of it."""
    name = SMOOTH[int(rng.integers(len(SMOOTH)))]
    middle = rng.uniform(-0.4, 0.4)
    return Shape(f"quadratic in {name}", (name,), lambda at: (_between(name, at, rows) - middle) ** 2)


def bend(rows: Rows, rng: np.random.Generator) -> Shape:
    """Nothing up to a point, then growing: a stop that is reached, an oil film that breaks."""
    name = ("forming_force", "link_temperature", "speed", "crank_angle")[int(rng.integers(4))]
    place, width = rng.uniform(-0.3, 0.5), rng.uniform(0.1, 0.4)

    def curve(at: Rows) -> Array:
        return width * np.logaddexp(0.0, (_between(name, at, rows) - place) / width)

    return Shape(f"bend in {name}", (name,), curve)


def hum(rows: Rows, rng: np.random.Generator) -> Shape:
    """A slow oscillation in time, of a cooling circuit for example."""
    cycles, phase = rng.uniform(2.0, 6.0), rng.uniform(0, 2 * pi)
    length = float(rows.time[-1])

    def angle(at: Rows) -> Array:
        return 2 * pi * cycles * at.time / length

    text = f"{cycles:.1f} cycles in time"
    return Shape(text, ("time",), lambda at: np.sin(angle(at) + phase), family=lambda at: waves(angle(at)))


MAKERS = (order, order, late_step, product_of_two, product_of_two, valley, bend, hum)


def single_group(name: str, rows: Rows) -> Array:
    """A polynomial of degree 4 in one covariate; of the direction, its two values."""
    return np.asarray(legvander(scaled(getattr(rows, name)), 1 if name == "direction" else 4))


def pair_group(one: str, two: str, rows: Rows) -> Array:
    """Two covariates by themselves to the second degree, and three products."""
    a, b = scaled(getattr(rows, one)), scaled(getattr(rows, two))
    return np.column_stack([np.ones(len(rows)), a, a**2, b, b**2, a * b, a**2 * b, a * b**2])


def groups(rows: Rows) -> Iterator[tuple[frozenset[str], Array]]:
    """Give every smooth family with what it depends on."""
    for name in COVARIATES:
        yield frozenset([name]), single_group(name, rows)
    for one, two in combinations(COVARIATES, 2):
        yield frozenset([one, two]), pair_group(one, two, rows)
    for number in range(3, 17):
        yield frozenset(["crank_angle"]), waves(number * rows.crank_angle)
    for cycles in range(2, 13):
        yield frozenset(["time"]), waves(2 * pi * cycles * rows.time / rows.time[-1])
    for place in np.linspace(0.02, 0.98, 49):
        yield frozenset(["time"]), family_of(step_at(place * rows.time[-1]), rows)


def family_of(shape: Shape, rows: Rows) -> Array:
    """The family to which a shape belongs: all that is known of it once its covariates are."""
    if shape.family is not None:
        return shape.family(rows)
    return (
        pair_group(*shape.depends_on, rows) if len(shape.depends_on) == 2 else single_group(shape.depends_on[0], rows)
    )
