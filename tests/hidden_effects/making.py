"""Cases from seeds: a drawn machine, a way of measuring, noise, and something wrong with it, or nothing.

Nominal inputs are drawn from their tolerances in every case. The part which no machine within its tolerances imitates
is half the noise to three times: in half of these cases what the best imitation leaves, in the others that and how far
the imitating machine lies outside its tolerances. In a fifth of the cases the whole effect is as large.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from hidden_effects.candidates import HOUR, Candidate, changes, columns
from hidden_effects.cases import Case, Stratum
from hidden_effects.designs import DESIGNS, Design, drawn_noise, measured, parted
from hidden_effects.press_machine import POSITION, SCATTER, TILT, Array, Rows
from hidden_effects.record import Record
from hidden_effects.rigs import KINDS, Kind
from hidden_effects.shapes import MAKERS, Shape

SCHEDULE: tuple[Stratum, ...] = (
    "none", "single", "double", "none", "single", "none", "unknown", "none", "single", "beside",
    "none", "double", "none", "single", "none", "unknown", "none", "single", "beside", "double",
)  # fmt: skip
LENGTHS = (80, 150, 300)
HELD_OUT = 1000
LEAST, MOST = 0.5, 3.0
WHOLE = 0.2
REACH = 0.9
ATTEMPTS = 400


@dataclass(frozen=True)
class Wish:
    """What a case is to be like; what is left open follows from the seed.

    ``effects`` names candidates, ``maker`` the function that makes the unregistered shape, ``size`` is that of the part
    which no machine within its tolerances imitates, over the noise.
    """

    stratum: Stratum | None = None
    design: Design | None = None
    kind: Kind | None = None
    results: tuple[str, ...] | None = None
    rows: int | None = None
    effects: tuple[str, ...] = ()
    size: float | None = None
    maker: str = ""


NOTHING = Wish()
Measure = Callable[[Array], float]


def make_case(seed: int, wish: Wish = NOTHING) -> Case:
    """The case of this seed. Stratum, noise and what is measured follow from the seed in turn, all else is drawn."""
    rng = np.random.default_rng([seed, 20240])
    stratum = wish.stratum or SCHEDULE[seed % len(SCHEDULE)]
    kind = wish.kind or KINDS[(seed + seed // len(SCHEDULE)) % len(KINDS)]
    results = wish.results or ((POSITION,), (POSITION, TILT))[int(rng.integers(2))]
    design = wish.design or DESIGNS[int(rng.integers(len(DESIGNS)))]
    for _ in range(ATTEMPTS):
        count = wish.rows or int(rng.choice(LENGTHS))
        rows, held = parted(measured(design, count + HELD_OUT, rng), count, rng)
        off = {name: float(sd * rng.standard_normal()) for name, sd in SCATTER.items()}
        record = Record(rows, results, drawn_noise(kind, rng))
        right = Case(seed=seed, stratum=stratum, design=design, record=record, held=held, off=off)
        wrong = _wrong(right, wish, rng)
        if wrong is not None:
            return _read(wrong, rng)
    raise ValueError(f"seed {seed}: nothing of this kind can be hidden at this size")


def _read(case: Case, rng: np.random.Generator) -> Case:
    """The case with what its gauges and counters showed."""
    is_new = rng.random() < 0.5
    counters = (0.0, 0.0) if is_new else (rng.uniform(0, 500) * HOUR, float(rng.integers(0, 4_000_000)))
    readings, held = (_noisy(case, rows, rng) for rows in (case.record.rows, case.held))
    return replace(case, counters=counters, readings=readings, held_readings=held)


def _noisy(case: Case, rows: Rows, rng: np.random.Generator) -> dict[str, Array]:
    parts = zip(case.results, np.split(case.true_readings(rows), len(case.results)), strict=True)
    return {result: part + case.record.noise.drawn(rows, result, rng) for result, part in parts}


def _wrong(case: Case, wish: Wish, rng: np.random.Generator) -> Case | None:
    """Draw what is wrong; None where what was drawn cannot be hidden here at its size."""
    many = {"none": 0, "single": 1, "double": 2, "unknown": 0, "beside": 1}[case.stratum]
    measure = _measure(case.record, wish, rng)
    hidden: dict[str, Mapping[str, float]] = {}
    truth: list[str] = []
    for at in range(many):
        candidate = _candidate(case.record, wish.effects[at] if wish.effects else "", rng)
        unknowns = _sized(case, candidate, _target(wish, rng), measure, rng)
        if unknowns is None or candidate.effect in hidden:
            return None
        hidden[candidate.effect] = unknowns
        truth.append(candidate.name)
    if _is_one_in_another(case.record, truth):
        return None
    shape = _shape(case.record, wish, measure, rng) if case.stratum in ("unknown", "beside") else None
    if shape is not None and shape.also in hidden:
        return None
    return replace(case, hidden=hidden, truth=tuple(truth), shape=shape)


def _measure(record: Record, wish: Wish, rng: np.random.Generator) -> Measure:
    """What is made half the noise to three times."""
    if wish.size is not None:
        return record.rest_of
    if rng.random() < WHOLE:
        return record.size_of
    return record.rest_of if rng.random() < 0.5 else record.strangeness_of


def _target(wish: Wish, rng: np.random.Generator) -> float:
    return rng.uniform(LEAST, MOST) if wish.size is None else wish.size


def _candidate(record: Record, name: str, rng: np.random.Generator) -> Candidate:
    """A candidate by name, or any: an effect first, then one of its parts."""
    if name:
        return record.candidates[record.place(name)]
    effects = sorted({candidate.effect for candidate in record.candidates})
    effect = effects[int(rng.integers(len(effects)))]
    parts = [candidate for candidate in record.candidates if candidate.effect == effect]
    return parts[int(rng.integers(len(parts)))]


def _is_one_in_another(record: Record, truth: list[str]) -> bool:
    """Whether one of a pair can make the curve of the other, so that there is no pair."""
    if len(truth) < 2:
        return False
    one, two = (record.place(name) for name in truth)
    return bool(record.contained[one, two] or record.contained[two, one])


def _sized(
    case: Case, candidate: Candidate, target: float, measure: Measure, rng: np.random.Generator
) -> dict[str, float] | None:
    """Unknowns of the wanted size, or None where their bounds do not allow it."""
    record = case.record
    shapes = {name: _shape_value(name, record.rows, rng) for name in candidate.shapes or {}}
    ways = rng.standard_normal(len(candidate.amplitudes))
    made = columns(record.rows, record.results, candidate, shapes)
    ways = np.where(np.any(made != 0, axis=0), ways, 0.0)  # what these rows do not excite is absent
    if not np.any(ways):
        return None
    ways = ways / np.linalg.norm(ways)
    signs = [abs(way) if low >= 0 else way for way, (low, _) in zip(ways, candidate.amplitudes.values(), strict=True)]
    factor = candidate.small
    for _ in range(4):
        amplitudes = {name: float(factor * way) for name, way in zip(candidate.amplitudes, signs, strict=True)}
        if not _is_inside(candidate, amplitudes):
            return None
        change = changes(record.rows, record.results, {candidate.effect: {**shapes, **amplitudes}}, case.off)
        size = measure(change)
        if size < 1e-9 * target:
            return None
        factor *= target / size
    return {**shapes, **amplitudes} if abs(size / target - 1) < 0.1 else None


def _is_inside(candidate: Candidate, amplitudes: Mapping[str, float]) -> bool:
    bounds = candidate.amplitudes
    return all(REACH * bounds[name][0] <= value <= REACH * bounds[name][1] for name, value in amplitudes.items())


def _shape_value(name: str, rows: Rows, rng: np.random.Generator) -> float:
    """A time constant about as long as the record, a whole order, or a place inside the record."""
    length = float(rows.time[-1])
    if name == "time_constant":
        return float(length * np.exp(rng.uniform(np.log(0.1), np.log(0.7))))
    return float(rng.integers(1, 4)) if name.endswith("_order") else float(rng.uniform(0.15, 0.85) * length)


def _shape(record: Record, wish: Wish, measure: Measure, rng: np.random.Generator) -> Shape:
    """A shape that nobody registered, in one or all of the readings, of the wanted size."""
    makers = [maker for maker in MAKERS if wish.maker in ("", maker.__name__)]
    shape = makers[int(rng.integers(len(makers)))](record.rows, rng)
    seen = record.results if rng.random() < 0.4 else (record.results[int(rng.integers(len(record.results)))],)
    ways = {result: record.noise.sd[result] * rng.uniform(0.5, 1.5) * rng.choice([-1.0, 1.0]) for result in seen}
    unit = replace(shape, sizes=tuple(ways.items()))
    factor = _target(wish, rng) / measure(unit.of(record.rows, record.results))
    return replace(shape, sizes=tuple((result, float(factor * way)) for result, way in ways.items()))
