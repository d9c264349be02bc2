"""What a diagnosis answers, as data: SI numbers with their printed unit. Sheet, JSON and terminal read this."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain, product
from math import isnan, sqrt
from typing import Literal

import numpy as np

from truing.arrays import Matrix
from truing.diagnosis.records import FEWEST_READINGS, Records
from truing.diagnosis.sentences import records_words, say
from truing.numbers import format_number, with_unit
from truing.setup import Setup
from truing.units import difference_unit, from_si, same_dimension, to_si

ResidualPattern = Literal["bias", "trend", "order", "step", "wave", "spread", "autocorrelation", "outlier"]
Way = Literal["held", "ramp", "to and fro", "in turn"]
Visibility = Literal["visible", "hidden in the tolerances", "not excited", "cannot be fitted"]
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
    ("ft", "in", "uin"),
    ("Mpsi", "ksi", "psi"),
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
class ResidualFinding:
    """Something that is wrong with the residuals of the calibrated model; ``p_value`` has paid for the search.

    ``is_allowed`` where the tolerances may have caused it: a bias inside of what they let machines differ by.
    """

    kind: ResidualPattern
    covariate: str
    p_value: float | None
    text: str
    is_allowed: bool = False


@dataclass(frozen=True)
class NoiseSummary:
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
    noise: NoiseSummary
    findings: tuple[ResidualFinding, ...]
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
class Course:
    """How one input or condition goes over an experiment, SI: held, from start to end, there and back, both in turn."""

    name: str
    way: Way
    start: float
    end: float

    def values(self, readings: int) -> Matrix:
        """Return its value at every reading, evenly spaced, (readings,)."""
        share: Matrix = np.linspace(0.0, 1.0, readings)
        if self.way == "to and fro":
            share = np.asarray(1 - np.abs(1 - 2 * share))
        elif self.way == "in turn":
            share = np.asarray(np.arange(readings) % 2.0)
        return self.start + (self.end - self.start) * share


@dataclass(frozen=True)
class Chance:
    """How often an experiment named the right one of several explanations: of so many simulated ones, with Wilson's 95
    % interval. ``by`` says how each was judged."""

    value: float
    low: float
    high: float
    draws: int
    by: str


@dataclass(frozen=True)
class Experiment:
    """Readings that can be taken one after another, and what they tell apart.

    ``tells`` names the explanations, ``apart`` the pairs of them. ``settings`` has by name the value at every reading,
    (n,) SI; ``courses`` how it goes, of what is made from others as well. ``takes`` is the time from the first reading
    to the last, where it is known. ``separation`` is that of the two least apart, ``needed`` how many readings like
    these would suffice. ``sizes`` are the believed unknowns ("EFFECT.UNKNOWN") where no record tells them. ``parted``
    are pairs of explanations, and ``gaps`` by how much each first one then shows more than the second at every
    reading, (n, results), SI.
    """

    tells: tuple[str, ...]
    apart: tuple[tuple[str, str], ...]
    courses: tuple[Course, ...]
    settings: Mapping[str, Matrix]
    units: Mapping[str, str]
    takes: Amount | None
    separation: float
    needed: int
    chance: Chance
    results: tuple[str, ...]
    sizes: Mapping[str, Amount] = field(default_factory=dict)
    parted: tuple[tuple[str, str], ...] = ()
    gaps: tuple[Matrix, ...] = ()

    @property
    def readings(self) -> int:
        """How many readings it has."""
        return len(next(iter(self.settings.values())))


@dataclass(frozen=True)
class Fact:
    """What would have to be so if an explanation is the right one: a quantity that can be measured by other means.

    ``quantity`` is "EFFECT.UNKNOWN" or "input:NAME", ``note`` what it was declared to be, in words. ``accuracy`` is how
    well it must be known, either way, to decide.
    """

    explanation: str
    quantity: str
    value: Amount
    note: str
    accuracy: Amount


@dataclass(frozen=True)
class Tie:
    """Explanations that no setting within reach and no further result tells apart, with the facts that would."""

    explanations: tuple[str, ...]
    facts: tuple[Fact, ...] = ()


@dataclass(frozen=True)
class VisibleSize:
    """How small an effect may be and still be seen on this data (90 % power, search paid for).

    ``name`` is the effect's, with ".UNKNOWN" behind it where the effect has several amplitudes.
    """

    name: str
    smallest: Amount | None
    sight: Visibility
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
class Alike:
    """Two effects that draw nearly one curve on this data: the angle between what the inputs leave of them, rad."""

    one: str
    other: str
    angle: float


@dataclass(frozen=True)
class ResultCurves:
    """What the figures show of one result, SI, shape (n,), NaN where missing: measured, and the model before and after.

    ``before`` is the model calibrated within its tolerances, ``after`` the extended one, ``nominal`` the machine as
    drawn. ``rivals`` are those of the ``alternatives``, in their order.
    """

    result: str
    measured: Matrix
    before: Matrix
    after: Matrix
    nominal: Matrix | None = None
    rivals: tuple[Matrix, ...] = ()


@dataclass(frozen=True, kw_only=True)
class DiagnosisResult:
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
    seen: tuple[VisibleSize, ...]
    not_measured: Mapping[str, tuple[str, ...]]
    calibrated: tuple[Calibrated, ...]
    gain: tuple[Gain, ...]
    stability: float
    curves: tuple[ResultCurves, ...]
    p_any: float | None = None
    p_second: float | None = None
    ranking: tuple[Alternative, ...] = ()
    inseparable: tuple[str, ...] = ()
    alike: tuple[Alike, ...] = ()
    next: tuple[NextPoint, ...] = ()
    ties: tuple[Tie, ...] = ()
    experiment: Experiment | None = None
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


# What makes a named cause doubtful: what a wrong cause looks like, each in one sentence with what to check

AT_BOUND = 5e-3
"""Of the declared range of an unknown: what lies nearer to an end of it lies there."""
OUTSIDE = 3.0
"""An input is off its band beyond this many standard deviations of its tolerance."""
RANDOM_WALK = 0.92
"""From this AR coefficient on noise is nearly a random walk, which draws any slow curve (the largest that is tried).

Beside a cause one within two standard errors of it is: few rows do not tell them apart.
"""
OVERFITTED = 0.5
"""Of the noise that is stated: what is left is below it by chance 1 in 100 with ten rows, 1 in 3000 with twenty."""
STABLE = 0.5
"""Less than this share of the folds that name the same causes is another verdict on parts of the record."""


def alarms_of(diagnosis: DiagnosisResult) -> Iterator[str]:
    """Give what speaks against the causes that are named, one sentence each; nothing where none is named."""
    if diagnosis.causes:
        yield from chain(
            _at_bounds(diagnosis),
            moved_inputs(diagnosis),
            _growing(diagnosis),
            _unstable(diagnosis),
            _torn(diagnosis),
            _overfitted(diagnosis),
            wandering(diagnosis),
            diagnosis.hindrances,
        )


def warnings_of(diagnosis: DiagnosisResult) -> Iterator[str]:
    """Give the alarms, and what is left beside the causes that are named: more to be found, nothing against them."""
    yield from alarms_of(diagnosis)
    if diagnosis.causes:
        yield from _waves_left(diagnosis)
    else:
        yield from diagnosis.hindrances


def _at_bounds(diagnosis: DiagnosisResult) -> Iterator[str]:
    for cause in diagnosis.causes:
        for unknown in cause.unknowns:
            if _is_at_bound(diagnosis, cause, unknown):
                size = _text(unknown.value, unknown.unit)
                yield say("at bound", unknown=unknown_words(cause.effect, unknown.name), size=size)


def _is_at_bound(diagnosis: DiagnosisResult, cause: Cause, unknown: FittedUnknown) -> bool:
    """Whether a fitted unknown lies at an end of its declared range, other than at zero."""
    effect = diagnosis.setup.model.known_effects.get(cause.effect)
    declared = next((each for each in effect.unknowns if each.name == unknown.name), None) if effect else None
    if declared is None or declared.whole or declared.along:
        return False
    low, high = (float(to_si(end, declared.unit)) for end in (declared.low, declared.high))
    return any(end and abs(unknown.value - end) <= AT_BOUND * (high - low) for end in (low, high))


def moved_inputs(diagnosis: DiagnosisResult) -> Iterator[str]:
    """Give the inputs that no cause names and that were calibrated far beyond their tolerances."""
    named = {cause.effect.removeprefix("input:") for cause in diagnosis.causes}
    for moved in diagnosis.calibrated:
        if abs(moved.of_its_sd) > OUTSIDE and moved.name not in named:
            yield say("input moved", input=moved.name, times=f"{abs(moved.of_its_sd):.1f}")


def _growing(diagnosis: DiagnosisResult) -> Iterator[str]:
    for gain in diagnosis.gain:
        if gain.held_out is not None and gain.held_out[1] > gain.held_out[0]:
            before, after = (_text(error, gain.rmse_before.unit) for error in gain.held_out)
            yield say("held out grows", result=gain.result, before=before, after=after)
    if diagnosis.gain and all(gain.rmse_after.value > gain.rmse_before.value for gain in diagnosis.gain):
        first = diagnosis.gain[0]
        before, after = _amount(first.rmse_before), _amount(first.rmse_after)
        yield say("all grow", result=first.result, before=before, after=after)


def _unstable(diagnosis: DiagnosisResult) -> Iterator[str]:
    if diagnosis.stability < STABLE:
        yield say("unsteady", often=often(diagnosis.stability))


def _torn(diagnosis: DiagnosisResult) -> Iterator[str]:
    """Give the amplitudes that parts of the record, or tolerances, do not let be what all rows say."""
    for contradiction in diagnosis.contradictions:
        first, second = _amount(contradiction.first), _amount(contradiction.second)
        unknown = unknown_words(contradiction.effect, contradiction.unknown)
        yield say("halves", unknown=unknown, first=first, second=second)
    for half in diagnosis.thinned:
        yield say("other on half", rows=half.rows, explanation=" + ".join(half.causes))
    for two in diagnosis.trades:
        yield say("stand in", unknown=unknown_words(two.effect, two.unknown), input=two.input)


def _overfitted(diagnosis: DiagnosisResult) -> Iterator[str]:
    for wrong in diagnosis.wrong:
        if wrong.stated is not None and wrong.noise_floor.value < OVERFITTED * wrong.stated.value:
            left, stated = _amount(wrong.noise_floor), _amount(wrong.stated)
            yield say("too good", result=wrong.result, left=left, stated=stated)


def wandering(diagnosis: DiagnosisResult) -> Iterator[str]:
    """Give the results whose noise was taken as nearly a random walk."""
    for wrong in diagnosis.wrong:
        rho = wrong.noise.ar_coefficient
        most = rho + 2 * sqrt((1 - rho**2) / wrong.rows) if rho > 0 and diagnosis.causes else rho
        if most >= RANDOM_WALK:
            yield say("wanders", result=wrong.result)


def _waves_left(diagnosis: DiagnosisResult) -> Iterator[str]:
    for wrong in diagnosis.wrong:
        for finding in wrong.findings:
            if finding.kind == "wave":
                yield say("waves", result=wrong.result, waves=finding.text)


WAVE_PART = re.compile(r"_?(?:co)?sine(?:_|$)")


def unknown_words(effect: str, unknown: str) -> str:
    """Name an unknown of an effect; the two parts of a wave, of which neither means anything alone, by one name."""
    return f"a part of the wave of {effect}" if WAVE_PART.search(unknown) else f"{unknown} of {effect}"


def often(share: float) -> str:
    """Say how often the parts of a record agree."""
    return "every time" if share >= 1 else "never" if share <= 0 else f"in {100 * share:.0f} % of the cases"


def _amount(amount: Amount) -> str:
    return _text(amount.value, amount.unit)


def _text(value: float, unit: str) -> str:
    return with_unit(format_number(float(from_si(value, unit)), 3), unit)


# The verdict of a diagnosis: one rule over all that was found, for headline, terminal, sheet and JSON alike

Verdict = Literal["named", "one_of", "unknown", "none", "undecided"]

UNKNOWN = "unknown"
"""What an explanation calls a shape that nobody registered."""
CHANCE = 0.2
"""Below this p-value the best explanation is not called chance: one record of nothing in five lies below it."""
APART = 25.0
"""The lambda from which on two explanations are told apart. Their scores then differ by 25 with a standard deviation of
2 sqrt(25) = 10, so that with a chance of 97 % the difference is above the 6 below which a rival is not excluded."""
STRUCTURE = ("bias", "trend", "order", "step", "wave")

Explanation = tuple[str, ...]


def explanations_of(diagnosis: DiagnosisResult) -> tuple[Explanation, ...]:
    """Return every explanation that this record does not exclude, the best first; names of one curve count each."""
    if not diagnosis.causes and diagnosis.remainder is None:
        return ()
    best = [cause.effect for cause in diagnosis.causes]
    same: Mapping[str, Sequence[str]] = {cause.effect: cause.same_as for cause in diagnosis.causes}
    explanations = [([*best, UNKNOWN] if diagnosis.remainder is not None else best, same)]
    for rival in diagnosis.alternatives:
        over = [f"{UNKNOWN}:{','.join(rival.depends_on)}" if name == UNKNOWN else name for name in rival.causes]
        explanations.append((over, rival.same_as))
    once: dict[frozenset[str], Explanation] = {}
    for names, same in explanations:
        for explanation in product(*((name, *same.get(name, ())) for name in names)):
            once.setdefault(frozenset(explanation), explanation)
    return tuple(once.values())


def shared_of(diagnosis: DiagnosisResult) -> tuple[str, ...]:
    """Return the names that every one of several explanations holds: so much is sure where the rest is open.

    A shape that nobody registered is the same in two of them where it is one over the same covariates.
    """
    first, *others = explanations_of(diagnosis) or ((),)
    over = ",".join(diagnosis.remainder.depends_on) if diagnosis.remainder is not None else ""
    names = {name: {name, f"{UNKNOWN}:{over}"} if name == UNKNOWN else {name} for name in first}
    return tuple(name for name, words in names.items() if others and all(words & set(each) for each in others))


def further_of(diagnosis: DiagnosisResult) -> tuple[str, ...]:
    """Return the names of what may be there beside the best explanation, where every other one holds all of it."""
    first, *others = explanations_of(diagnosis) or ((),)
    if len(shared_of(diagnosis)) < len(first):
        return ()
    return tuple(dict.fromkeys(name for names in others for name in names if name.split(":")[0] not in first))


def verdict_of(diagnosis: DiagnosisResult) -> Verdict:
    """Return the verdict; "one_of" wherever a cause has another name or a rival is near, "none" without any doubt.

    One explanation that an alarm speaks against is not named, with or without what may be there as well: it is
    undecided.
    """
    explanations = explanations_of(diagnosis)
    if not explanations:
        return "undecided" if any(doubts(diagnosis)) else "none"
    if all(name.startswith(UNKNOWN) for names in explanations for name in names):
        return "unknown"
    if (len(explanations) == 1 or further_of(diagnosis)) and any(alarms_of(diagnosis)):
        return "undecided"
    return "one_of" if len(explanations) > 1 else "named"


def doubts(diagnosis: DiagnosisResult) -> Iterator[str]:
    """Give the reasons for which a diagnosis may be undecided, one clause each.

    Where a cause would be named: what speaks against it. Where none is: why it cannot be said that nothing is wrong.
    """
    yield from alarms_of(diagnosis) if explanations_of(diagnosis) else _doubts_of_nothing(diagnosis)


def _doubts_of_nothing(diagnosis: DiagnosisResult) -> Iterator[str]:
    readings = diagnosis.records.readings
    if readings < FEWEST_READINGS:
        yield say("too few", count=readings)
    elif diagnosis.p_any is None or not diagnosis.p_any >= CHANCE:
        yield _nearly(diagnosis)
    for wrong in diagnosis.wrong:
        for finding in wrong.findings:
            if finding.kind in STRUCTURE and not finding.is_allowed:
                yield say("no mere scatter", result=wrong.result, pattern=finding.text)
    yield from wandering(diagnosis)
    yield from moved_inputs(diagnosis)
    yield from diagnosis.hindrances


def _nearly(diagnosis: DiagnosisResult) -> str:
    if diagnosis.p_any is None or isnan(diagnosis.p_any):
        return say("not tested")
    best = next((rival.causes for rival in diagnosis.ranking if rival.causes), ())
    named = f", {' + '.join(best)}," if best else ""
    return say("nearly", named=named, records=records_words(diagnosis.p_any))


def stated_remedy(diagnosis: DiagnosisResult, cause: str) -> str:
    """Return what an effect states is to be done about it, or nothing."""
    effect = diagnosis.setup.model.known_effects.get(cause)
    return effect.remedy if effect is not None else ""
