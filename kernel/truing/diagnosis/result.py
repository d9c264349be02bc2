"""What a diagnosis answers, as data: SI numbers with their printed unit. Sheet, JSON and terminal read this."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from truing.diagnosis.alarms import warnings_of
from truing.diagnosis.arrays import Matrix
from truing.diagnosis.records import Records
from truing.diagnosis.verdict import Verdict, explanations_of, verdict_of
from truing.setup import Setup
from truing.units import difference_unit, from_si, same_dimension

Kind = Literal["bias", "trend", "order", "step", "wave", "spread", "autocorrelation", "outlier"]
Sight = Literal["visible", "hidden in the tolerances", "not excited", "cannot be fitted"]
FAMILIES = (
    ("m", "mm", "um", "nm"),
    ("rad", "mrad", "urad"),
    ("deg", "arcmin", "arcsec"),
    ("kN", "N", "mN"),
    ("kN*m", "N*m", "mN*m"),
    ("GPa", "MPa", "kPa", "Pa"),
    ("h", "min", "s", "ms"),
    ("kW", "W", "mW"),
    ("kg", "g", "mg"),
)
KNOWN = {unit for family in FAMILIES for unit in family}
SMALLEST, LARGEST = 0.1, 1000.0
"""Between these a number reads well: 2.3 um rather than 0.0023 mm."""


@dataclass(frozen=True)
class Amount:
    """A number in SI and the unit to print it in; differences (a residual, a slope) have a difference unit."""

    value: float
    unit: str


@dataclass(frozen=True)
class Finding:
    """Something that is wrong with the residuals of the calibrated model; ``p_value`` has paid for the search.

    ``is_allowed`` where the tolerances may have caused it: a bias inside of what they let machines differ by.
    """

    kind: Kind
    covariate: str
    p_value: float | None
    text: str
    is_allowed: bool = False


@dataclass(frozen=True)
class Noise:
    """What the noise of one result is like, once everything found is taken out.

    ``autocorrelation`` is that of neighbouring rows (0 is none); ``ar_coefficient`` is the share of the slow part of
    the noise that carries over from row to row (1 is a random walk); ``tails`` and ``spread`` are words ("normal",
    "heavy, t with 4 degrees of freedom"; "constant", "grows with forming_force"). ``outliers`` are (file, line) of rows
    beyond four standard deviations.
    """

    sd: Amount
    autocorrelation: float
    tails: str
    spread: str
    outliers: tuple[tuple[str, int], ...] = ()
    ar_coefficient: float = 0.0


@dataclass(frozen=True)
class Wrong:
    """How far one result is off, and how: root mean squares of the model calibrated inside its tolerances.

    ``stated`` is the standard deviation that the record gives for its readings, None where it gives none.
    """

    result: str
    rows: int
    rmse: Amount
    noise_floor: Amount
    reducible_share: float
    noise: Noise
    findings: tuple[Finding, ...]
    stated: Amount | None = None


@dataclass(frozen=True)
class FittedUnknown:
    """An unknown of an effect as fitted, SI, with its 95 % interval; an open end is None.

    ``per_file`` holds value and interval by file name where the unknown was fitted for each file alone.
    """

    name: str
    value: float
    low: float | None
    high: float | None
    unit: str
    per_file: Mapping[str, tuple[float, float | None, float | None]] = field(default_factory=dict)


@dataclass(frozen=True)
class Cause:
    """A named cause: an effect, or "input:NAME" for an input that lies outside its band.

    ``covariance`` (SI) follows the order of ``unknowns``. ``same_as`` are effects that are the same curve on this data.
    ``share`` is that of its mean square in the sum of those of all named causes.
    """

    effect: str
    unknowns: tuple[FittedUnknown, ...]
    covariance: tuple[tuple[float, ...], ...] = ()
    same_as: tuple[str, ...] = ()
    share: float = 1.0


@dataclass(frozen=True)
class Alternative:
    """Another explanation that this data does not exclude: ``behind`` in score units, ``separation`` as lambda.

    ``causes`` names effects, and "unknown" for a shape nobody registered; ``unknowns`` holds its own fit by effect,
    ``same_as`` by effect those that are the same curve on this data.
    """

    causes: tuple[str, ...]
    behind: float
    separation: float
    depends_on: tuple[str, ...] = ()
    unknowns: Mapping[str, tuple[FittedUnknown, ...]] = field(default_factory=dict)
    same_as: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


@dataclass(frozen=True)
class ShapeTerm:
    """One term of a fitted shape, ``coefficient * product of factors``, as Python over covariates in SI.

    ``expression`` uses covariate names and ``np``, e.g. "np.cos(7 * crank_angle)"; the coefficient is SI.
    """

    expression: str
    coefficient: float


@dataclass(frozen=True)
class Remainder:
    """Structure that nothing registered explains: what it depends on and its shape in words, for these results."""

    depends_on: tuple[str, ...]
    shape: str
    results: tuple[str, ...]
    p_value: float | None
    terms: Mapping[str, tuple[ShapeTerm, ...]] = field(default_factory=dict)


@dataclass(frozen=True)
class Calibrated:
    """An input as fitted to this machine within its tolerance, SI; ``of_its_sd`` is how far it moved in units of it."""

    name: str
    value: float
    unit: str
    of_its_sd: float


@dataclass(frozen=True)
class Gain:
    """What the extension is worth on rows it was not fitted to, for one result (nested blocked cross-validation)."""

    result: str
    rmse_before: Amount
    rmse_after: Amount
    noise_floor: Amount
    reducible_removed: float
    log_score_gain: float
    p_value: float
    coverage90: float
    held_out: tuple[float, float] | None = None
    """Root mean squares (SI) before and after on rows held out on request."""


@dataclass(frozen=True)
class NextPoint:
    """A setting worth measuring next: what it separates, why, and lambda once all points up to it are measured.

    ``measure`` names results that were not measured and are to be, at the settings there are; lambda is then that of
    one value without noise. ``needed`` is the number of points like those proposed after which every pair that they
    are for is told apart: more than there are where they do not suffice.
    """

    settings: Mapping[str, Amount]
    separates: tuple[str, str]
    why: str
    separation: float
    measure: tuple[str, ...] = ()
    needed: int = 1


@dataclass(frozen=True)
class Fact:
    """What would have to be so if an explanation is the right one: a quantity that may be known from elsewhere.

    ``quantity`` is "EFFECT.UNKNOWN" or "input:NAME", ``note`` what it was declared to be, in words.
    """

    explanation: str
    quantity: str
    value: Amount
    note: str = ""


@dataclass(frozen=True)
class Tie:
    """Explanations that no setting within reach and no further result tells apart, with the facts that would."""

    explanations: tuple[str, ...]
    facts: tuple[Fact, ...] = ()


@dataclass(frozen=True)
class Seen:
    """How small an effect may be and still be seen on this data (90 % power, search paid for).

    ``name`` is the effect's, with ".UNKNOWN" behind it where the effect has several amplitudes.
    """

    name: str
    smallest: Amount | None
    sight: Sight
    text: str = ""


@dataclass(frozen=True)
class Contradiction:
    """An amplitude of a named cause that is not the same in both halves of the record: in the first, in the second."""

    effect: str
    unknown: str
    first: Amount
    second: Amount


@dataclass(frozen=True)
class Thinned:
    """Another explanation that is better than the named one on a half of the rows: ``rows`` says on which, in words.

    ``ahead`` is by how much, in score units; "unknown" among the ``causes`` is a shape that nobody registered.
    """

    rows: str
    causes: tuple[str, ...]
    ahead: float


@dataclass(frozen=True)
class Trade:
    """A named effect that this record hardly tells from a tolerated input, by the amplitude that is most alike.

    ``separation`` is lambda: how far the effect is from zero with all inputs free.
    """

    effect: str
    unknown: str
    input: str
    correlation: float
    separation: float


@dataclass(frozen=True)
class Curves:
    """What the figures show of one result, SI, shape (n,), NaN where missing: measured, and the model before and after.

    ``before`` is the model calibrated within its tolerances, ``after`` the extended one.
    """

    result: str
    measured: Matrix
    before: Matrix
    after: Matrix


@dataclass(frozen=True, kw_only=True)
class Diagnosis:
    """Everything one diagnosis found. ``p_any`` is the significance of the first step, ``p_second`` that of the last
    further one.

    ``not_measured`` holds, by effect, the conditions that no column gives; ``inseparable`` are sentences about pairs
    that this design of the experiment cannot separate whatever their size.
    """

    setup: Setup
    records: Records
    measured: tuple[str, ...]
    units: Mapping[str, str]
    wrong: tuple[Wrong, ...]
    causes: tuple[Cause, ...]
    alternatives: tuple[Alternative, ...]
    remainder: Remainder | None
    seen: tuple[Seen, ...]
    not_measured: Mapping[str, tuple[str, ...]]
    calibrated: tuple[Calibrated, ...]
    gain: tuple[Gain, ...]
    stability: float
    next: tuple[NextPoint, ...]
    curves: tuple[Curves, ...]
    p_any: float | None = None
    p_second: float | None = None
    ranking: tuple[Alternative, ...] = ()
    inseparable: tuple[str, ...] = ()
    ties: tuple[Tie, ...] = ()
    contradictions: tuple[Contradiction, ...] = ()
    thinned: tuple[Thinned, ...] = ()
    trades: tuple[Trade, ...] = ()
    hindrances: tuple[str, ...] = ()
    """What hindered the search, one sentence each: a budget that ended, a model rougher than the noise."""
    extended: Setup | None = None
    """The setup with the causes on, conditions as measured and inputs calibrated; None where nothing was named."""

    @property
    def verdict(self) -> Verdict:
        """What may be said in one word; it follows from all that was found, so that it cannot contradict it."""
        return verdict_of(self)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What speaks against the causes that are named, and what is left beside them, one sentence each."""
        return tuple(warnings_of(self))

    @property
    def unique(self) -> bool:
        """Whether one explanation is left, or nothing is to be explained."""
        return self.verdict == "none" or (self.verdict != "undecided" and len(explanations_of(self)) == 1)


def reads_well(size: float, unit: str) -> bool:
    """Whether a number (SI) is neither tiny nor huge in a unit."""
    return SMALLEST <= abs(float(from_si(size, unit))) < LARGEST


def readable_unit(unit: str, size: float) -> str:
    """Return a unit like ``unit`` in which ``size`` (SI, a difference) reads well; ``unit`` itself where it does."""
    own = difference_unit(unit)
    if size == 0 or reads_well(size, own):
        return own
    families = (each for each in FAMILIES if own in each or (own not in KNOWN and same_dimension(own, each[0])))
    return next((unit for unit in next(families, ()) if reads_well(size, unit)), own)
