"""What is reported of explanations, in words with numbers and units: causes, rivals, what is left, what is wrong.

Named causes have intervals, shapes that nobody registered a description: where they bend, jump or turn, how long, how
high. The residuals show bias, trends, orders, steps, waves, spread and outliers.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from truing.arrays import Matrix
from truing.declare.sources import Effect
from truing.diagnosis.causes import Candidate, followed_by, gauged
from truing.diagnosis.choice import Chosen, Rival
from truing.diagnosis.extended import Extended, shape_added, switched_on
from truing.diagnosis.fitted import Fit, input_value
from truing.diagnosis.gain import floor_of
from truing.diagnosis.intervals import Certainty, certainty_of, ends_of, numbers_of, places_of, value_of
from truing.diagnosis.machine import Calibration
from truing.diagnosis.noise import robust_sd
from truing.diagnosis.ranking import lowest_first
from truing.diagnosis.records import Covariate, file_labels
from truing.diagnosis.result import (
    Alternative,
    Amount,
    Calibrated,
    Cause,
    FittedUnknown,
    NoiseSummary,
    Remainder,
    ResidualFinding,
    ResidualPattern,
    ShapeTerm,
    Wrong,
    readable_unit,
)
from truing.diagnosis.sample import Channel, errors_of, residuals_of
from truing.diagnosis.sentences import say
from truing.diagnosis.visibility import separation
from truing.numbers import counted, format_number
from truing.setup import Setup, SwitchedOn
from truing.units import from_si

SHOWN_DIGITS, PLACE_DIGITS = 2, 3
"""Significant digits of a size, and of where something is on an axis."""
ONE_WAY = 0.9
"""Share of its range between the ends of a trend from which on it rises or falls; else it is curved."""
Sized = tuple[float, float | None, float | None]
"""A fitted value with its interval, SI."""
SIGNIFICANT, LARGEST_COUNT = 0.05, 4
"""Chance that noise alone gives as much, up to which a pattern is told, and so many of the largest."""
OUTLYING = 4.0
"""Standard deviations from which on a reading is named as an outlier: of normal noise one in 16,000."""
NOTICEABLE = 0.1
"""Autocorrelation of neighbouring rows from which on it is told."""
BIASED, SHOWS = 3.0, 3.0
"""Standard errors from which on a mean is off zero, and from which on what a cause adds to a result is told."""
PAIR_BETTER, SHADOW = 6.0, 0.3
"""A pattern over two covariates must be worth so much more than over one, and any such a share of what the best
explanation is worth: less is the shadow of another pattern."""
WAVE_LEVEL = 0.001
"""Significance from which on a wave in what is left is visible, all frequencies and covariates paid for."""
FEWEST_PERIODS = 2
"""What turns more slowly in the whole record is a wander, which the memory of the noise has taken."""
FEW_OUTLIERS = 5
"""So many readings that lie far out a finding names."""
FEWEST_OF_WAVE = 20
"""Readings below which any scatter looks like some wave."""


def in_unit(value: float, unit: str, digits: int = SHOWN_DIGITS) -> str:
    """Write an SI number with its unit."""
    return f"{format_number(float(from_si(value, unit)), digits)} {unit}".strip()


def drawn_by(cause: Candidate) -> tuple[str, ...]:
    """Return the kind of curve that a shape, or an effect of the kernel, draws, and the covariates that it follows."""
    if cause.shape is not None:
        return cause.shape.kind, *cause.shape.depends_on
    kind = {"periodic_order": "order", "step": "step"}.get(cause.name.partition("_of_")[0], "")
    return (kind, followed_by(cause.effect)) if kind and cause.is_kernel else ()


def shape_in_words(machine: Calibration, cause: Candidate, values: Matrix, added: Matrix, unit: str) -> str:
    """Describe a fitted curve by its numbers (SI) and what it adds to a result, SI, (n,): see ``drawn_by``."""
    kind, *names = drawn_by(cause)
    covariate, spanned = machine.records.covariates[names[0]], float(np.ptp(added))
    size, amplitude = in_unit(spanned, unit), in_unit(spanned / 2, unit)
    change = in_unit(float(added[np.nanargmax(covariate.values)] - added[np.nanargmin(covariate.values)]), unit)
    number = float(values[cause.shapes[0]]) if cause.shapes else 0.0
    if kind == "order":
        return say("order", order=f"{number:g}", covariate=covariate.name, size=amplitude)
    if kind == "step":
        height = in_unit(float(added[np.argmax(np.abs(added))]), unit)
        return say("step", size=height, place=_place(covariate, number))
    if kind == "wave":
        return say("wave", length=_length(covariate, 1 / number), size=amplitude)
    if kind == "settling":
        return say("settling", length=_length(covariate, number), size=change)
    if kind == "jump":
        return say("jump", size=change, covariate=covariate.name)
    if kind == "kink":
        return say("kink", covariate=covariate.name, size=size)
    if kind == "dead zone":
        return say("dead zone", length=_length(covariate, number), size=size)
    if kind == "product":
        return say("product", covariates=" and ".join(names), size=size)
    return _trend(covariate, added, unit)


def _place(covariate: Covariate, at: float) -> str:
    return f"{covariate.name} = {in_unit(at, covariate.unit, PLACE_DIGITS)}"


def _length(covariate: Covariate, value: float) -> str:
    """Write a distance along a covariate."""
    length = in_unit(value, readable_unit(covariate.unit, value), PLACE_DIGITS)
    return f"{length} of {covariate.name}" if covariate.role != "time" else length


def _trend(covariate: Covariate, added: Matrix, unit: str) -> str:
    """Describe a trend: rising or falling, or curved with its turning point."""
    order = np.argsort(covariate.values)[: int(np.isfinite(covariate.values).sum())]
    curve, at = added[order], covariate.values[order]
    low, high = int(np.argmin(curve)), int(np.argmax(curve))
    size = in_unit(float(np.ptp(curve)), unit)
    ends = abs(curve[-1] - curve[0]) / max(float(np.ptp(curve)), 1e-300)
    if ends > ONE_WAY:
        way = "rises" if curve[-1] > curve[0] else "falls"
        return say("rises", rises=way, covariate=covariate.name, size=size)
    turning = low if 0 < low < len(curve) - 1 and abs(curve[low] - curve[0]) >= abs(curve[high] - curve[0]) else high
    kind = "lowest" if turning == low else "highest"
    return say("curved", covariate=covariate.name, lowest=kind, place=_place(covariate, float(at[turning])), size=size)


def causes_of(chosen: Chosen, fit: Fit) -> tuple[Cause, ...]:
    """Return the named causes of an explanation; parts of one effect (offsets of two gauges) are one cause."""
    if all(cause.shape is not None for cause in fit.causes):
        return ()
    known = certainty_of(fit, chosen.competition.extended)
    effects = {cause.name: cause.effect for cause in fit.causes if cause.effect is not None}
    inputs = dict.fromkeys(cause.name for cause in fit.causes if cause.tolerated >= 0)
    named = [_effect(chosen, fit, known, each) for each in effects.values()]
    return (*named, *(_input(fit, known, name) for name in inputs))


def _input(fit: Fit, known: Certainty, effect: str) -> Cause:
    """Return an input that lies outside its band, with the interval of its value, in every file that has its own."""
    machine = fit.sample.machine
    by_file: dict[int, Sized] = {}
    for cause in [cause for cause in fit.causes if cause.name == effect]:
        given = machine.inputs[cause.tolerated]
        own = np.zeros(len(known.covariance))
        own[places_of(fit, cause)[0]] = 1.0
        if len(fit.inputs):
            own[-len(fit.inputs) :] = fit.sample.directions[cause.tolerated]
        value, reach = input_value(fit, cause.tolerated), known.reach(own) * given.sd
        by_file[given.file] = value, value - reach, value + reach
    return Cause(effect, (_of_files(fit, given.name, by_file, machine.start.unit_of(given.name)),))


def _of_files(fit: Fit, name: str, made: Mapping[int, Sized], unit: str) -> FittedUnknown:
    """Return an unknown with its interval, -1 where it is one for all files; else their mean and every file's own."""
    if -1 in made:
        return FittedUnknown(name, *made[-1], unit)
    own = {fit.sample.machine.records.files[file]: sized for file, sized in made.items()}
    return FittedUnknown(name, sum(value for value, _, _ in made.values()) / len(made), None, None, unit, own)


def _effect(chosen: Chosen, fit: Fit, known: Certainty, effect: Effect[Any, Any]) -> Cause:
    """Return an effect with all its unknowns that were fitted."""
    extended, numbers = chosen.competition.extended, numbers_of(fit)
    parts = [cause for cause in fit.causes if cause.effect is effect]
    places = [index for cause in parts for index in places_of(fit, cause)]
    unknowns, kept = [], []
    for unknown in effect.unknowns:
        own = [index for index in places if numbers[index].name == unknown.name]
        if own:
            sized: dict[int, Sized] = {
                numbers[index].file: (value_of(fit, index), *ends_of(fit, extended, known, index)) for index in own
            }
            unknowns.append(_of_files(fit, unknown.name, sized, unknown.unit))
            kept.append(own[0])
    is_whole = all(numbers[index].is_free and numbers[index].file < 0 for index in kept)
    covariance = known.in_si(kept) if is_whole else ()
    return Cause(effect.name, tuple(unknowns), covariance, _other_names(chosen, fit, effect.name))


def _other_names(chosen: Chosen, fit: Fit, name: str) -> tuple[str, ...]:
    """Return the names of others that draw the same curve as the causes of an explanation that have this name."""
    same = [other for cause in fit.causes if cause.name == name for other in chosen.same.get(cause.tag, ())]
    return tuple(dict.fromkeys(other for other in same if other != name))


def by_share(chosen: Chosen, causes: tuple[Cause, ...]) -> tuple[Cause, ...]:
    """Return the causes with their shares, the largest first.

    What a cause adds is the extended model less the same without it, at every row, in units of the noise. Its share is
    that of its mean square in the sum of the mean squares of all.
    """
    if len(causes) < 2:
        return causes
    added, channels = added_by(chosen.best, chosen.competition.extended), chosen.best.sample.channels
    drawn = [
        [added[cause.effect][channel.name][channel.rows] * channel.factors / channel.weights for channel in channels]
        for cause in causes
    ]
    squares = np.array([sum(float(np.sum(part**2)) for part in parts) for parts in drawn])
    if not squares.sum() > 0:
        return causes
    weighed = [replace(cause, share=float(share)) for cause, share in zip(causes, squares / squares.sum(), strict=True)]
    return tuple(lowest_first(weighed, lambda cause: -cause.share))


def added_by(fit: Fit, extended: Extended) -> dict[str, dict[str, Matrix]]:
    """Return by name of a cause what all that it names adds to each result of an explanation, SI on all rows."""
    points = []
    for name in ("", *fit.names):
        off = ([cause.name == name and number.is_amplitude for number in cause.numbers] for cause in fit.causes)
        values = [np.where(mask, 0.0, own) for mask, own in zip(off, fit.values, strict=True)]
        points.append((values, fit.moved))
    whole, *without = extended.at(fit.causes, points)
    return {
        name: {result: np.nan_to_num(whole[result] - values) for result, values in less.items()}
        for name, less in zip(fit.names, without, strict=True)
    }


def extended_setup(chosen: Chosen, causes: Sequence[Cause]) -> Setup:
    """Return the model brought true: causes on, conditions as measured (their means), inputs calibrated."""
    machine, on = chosen.best.sample.machine, tuple(_switched_on(chosen.best, causes))
    start = machine.start
    seen = {need.name for active in on for need in active.effect.needs} | set(start.conditions)
    measured = {name: covariate for name, covariate in machine.records.covariates.items() if name in seen}
    conditions = {
        **start.conditions,
        **{name: float(np.nanmean(covariate.values)) for name, covariate in measured.items()},
    }
    calibrated = {**start.calibrated, **{name: value for name, (value, _) in input_values(chosen.best).items()}}
    setup = replace(start, inputs=machine.design.inputs, conditions=conditions, calibrated=calibrated)
    return setup.with_effects(on)


def _switched_on(best: Fit, causes: Sequence[Cause]) -> Iterator[SwitchedOn]:
    """Give the named effects as they are switched on in the extended model; what was not excited is 0."""
    fitted = {on.effect.name: on for on in switched_on(best.causes, best.values, best.sample.machine)}
    for cause in causes:
        if cause.effect in fitted:
            on, variances = fitted[cause.effect], np.diag(cause.covariance or np.zeros((0, 0))).tolist()
            sds = {unknown.name: square**0.5 for unknown, square in zip(cause.unknowns, variances, strict=False)}
            complete = cause.covariance if len(cause.unknowns) == len(on.values) > 1 else ()
            yield replace(on, sds=sds, covariance=complete)


def input_values(fit: Fit) -> Mapping[str, tuple[float, float]]:
    """Return every tolerated input as calibrated, SI, and how far it moved in units of its sd (the first file's)."""
    made: dict[str, tuple[float, float]] = {}
    for index, tolerated in enumerate(fit.sample.machine.inputs):
        value = input_value(fit, index)
        made.setdefault(tolerated.name, (value, (value - tolerated.design) / tolerated.sd))
    return made


def calibrated_of(fit: Fit) -> tuple[Calibrated, ...]:
    """Return every tolerated input as fitted to this machine."""
    start, values = fit.sample.machine.start, input_values(fit).items()
    return tuple(Calibrated(name, value, start.unit_of(name), off) for name, (value, off) in values)


def remainder_of(chosen: Chosen, units: Mapping[str, str]) -> Remainder | None:
    """Return the unregistered shapes of the explanation in words, with their terms; None where there are none."""
    best, machine = chosen.best, chosen.best.sample.machine
    words: dict[str, list[str]] = {}
    terms: dict[str, tuple[ShapeTerm, ...]] = {}
    for cause, values in zip(best.causes, best.values, strict=True):
        shape = cause.shape
        if shape is None:
            continue
        shape_terms = shape.terms([float(values[index]) for index in cause.shapes], machine.records.covariates)
        sizes = iter([float(values[index]) for index in cause.amplitudes])
        for name, added in shape_added(machine, cause, values).items():
            words.setdefault(name, []).append(shape_in_words(machine, cause, values, added, units[name]))
            own = (ShapeTerm(term.expression, next(sizes)) for term in shape_terms)
            terms[name] = (*terms.get(name, ()), *own)
    if not words:
        return None
    spoken = {name: " and ".join(own) for name, own in words.items()}
    named = [f"{name}: {word}" for name, word in spoken.items()] if len(spoken) > 1 else spoken.values()
    p_value = chosen.p_any if len(best.causes) == 1 else chosen.p_second
    return Remainder(_followed(best), "; ".join(named), tuple(words), p_value, terms)


def _followed(fit: Fit) -> tuple[str, ...]:
    """Return what the unregistered shapes of an explanation depend on."""
    shapes = [cause.shape for cause in fit.causes if cause.shape is not None]
    return tuple(dict.fromkeys(name for shape in shapes for name in shape.depends_on))


def alternative_of(chosen: Chosen, rival: Rival, *, with_sizes: bool = False) -> Alternative:
    """Return a rival explanation: how far behind, how separable, and on demand what its own fit says."""
    fit, searched = rival.fit, chosen.searched
    fits = searched.competition.known if searched is not chosen else {}
    apart = separation(searched.best, fits.get(fit.key, fit), searched.competition.extended)
    sized = causes_of(chosen, fit) if with_sizes else ()
    same = {name: others for name in fit.names if (others := _other_names(chosen, fit, name))}
    return Alternative(
        fit.names,
        rival.behind,
        apart * chosen.rows_searched,
        _followed(fit),
        {cause.effect: cause.unknowns for cause in sized},
        same,
    )


def wrong_of(chosen: Chosen, units: Mapping[str, str]) -> tuple[Wrong, ...]:
    """Describe every measured result: how far off, how much of it is noise, and what structure it has."""
    acting = _acting(chosen)
    return tuple(_wrong(chosen, channel, acting, units[channel.name]) for channel in chosen.best.sample.channels)


def _wrong(chosen: Chosen, channel: Channel, acting: Mapping[str, Sequence[Candidate]], unit: str) -> Wrong:
    best, name, rows = chosen.best, channel.name, channel.rows
    machine, own, records = best.sample.machine, best.sample.noise[name], best.sample.machine.records
    before, after = (errors_of(machine, name, own, fit.predicted[name])[rows] for fit in (chosen.null, best))
    floor = floor_of(best, channel)
    rmse = float(np.sqrt(np.mean(before**2)))
    share = max(0.0, 1 - floor**2 / rmse**2) if rmse > 0 and best.causes else 0.0
    findings = [
        *_bias(chosen, channel, residuals_of(machine)[name][rows[channel.read]], unit),
        *_with_named(chosen, acting[name], list(_structure(chosen, name, unit))),
        *_of_noise(best, channel),
        *_wave(best, channel),
    ]
    size = after[channel.read] * channel.weights[channel.read]
    far = np.abs(size) > OUTLYING * max(robust_sd(size), channel.scale * channel.least**0.5)
    places = rows[channel.read][far].tolist()
    outliers = tuple((records.files[int(records.file_of[row])], int(records.lines[row])) for row in places)
    memory = channel.memory
    noise = NoiseSummary(
        Amount(floor, unit), memory.neighbours, own.tails.words, own.spread.words, outliers, memory.rho
    )
    if outliers:
        findings.append(ResidualFinding("outlier", "", None, _far_words(outliers)))
    given = records.sigma.get(name, np.zeros(len(records)))[rows]
    given = given[given > 0]
    stated = Amount(float(np.sqrt(np.mean(given**2))), unit) if len(given) else None
    return Wrong(name, len(rows), Amount(rmse, unit), Amount(floor, unit), share, noise, tuple(findings), stated)


def _far_words(outliers: Sequence[tuple[str, int]]) -> str:
    """Name the readings that are far out, the first few by file and line."""
    names = list(dict.fromkeys(file for file, _ in outliers))
    labels = dict(zip(names, file_labels(names), strict=True))
    places = ", ".join(f"{labels[file]}:{line}" for file, line in outliers[:FEW_OUTLIERS])
    more = f" and {len(outliers) - FEW_OUTLIERS} more" if len(outliers) > FEW_OUTLIERS else ""
    verb = "lies" if len(outliers) == 1 else "lie"
    return say("outliers", rows=f"{counted(len(outliers), 'reading')} {verb}", places=places + more)


def _bias(chosen: Chosen, channel: Channel, residual: Matrix, unit: str) -> Iterator[ResidualFinding]:
    """Say by how much the nominal model is off on average, and whether calibration within the tolerances takes it."""
    sample = chosen.null.sample
    mean = float(np.mean(residual))
    drawn = np.asarray(sample.machine.slopes[channel.name][channel.rows] @ sample.directions)
    spread = float(np.sqrt(np.mean(np.sum(drawn**2, axis=1))))
    if abs(mean) <= BIASED * channel.scale / np.sqrt(len(channel)):
        return
    allowed = say("bias too large") if spread > 0 else say("bias alone")
    if is_allowed := abs(mean) <= BIASED * spread:
        allowed = say("bias allowed", spread=in_unit(BIASED * spread, unit))
    words = say("bias", size=in_unit(mean, unit), allowed=allowed)
    yield ResidualFinding("bias", "", None, words, is_allowed)


def _structure(chosen: Chosen, name: str, unit: str) -> Iterator[ResidualFinding]:
    """Say what the residual of the calibrated model depends on; every p-value has paid for the whole search.

    Shapes that explain little beside the best explanation are its shadows (a jump has waves of every order).
    """
    competition = chosen.competition
    alone = competition.ranked(lambda fit: len(fit.causes) == 1)
    offsets = [fit for fit in alone if fit.causes[0].name == "sensor_offset"]
    constant = [fit for fit in offsets if gauged(fit.causes[0], [name])]
    plain = min(competition.score(fit) for fit in (competition.null, *constant))  # what a trend must beat to be one
    best: dict[tuple[str, ...], tuple[float, Fit]] = {}
    for fit in alone:
        label, gain = _label(fit, name), plain - competition.score(fit)
        if label and chosen.law.p_of(gain) <= SIGNIFICANT:
            best.setdefault(label, (gain, fit))
    singles: dict[str, float] = {}
    for label, (gain, _) in best.items():
        if len(label) == 2:
            singles[label[1]] = max(gain, singles.get(label[1], gain))
    least = SHADOW * (plain - competition.score(competition.ranked()[0]))
    kept = []
    for label, (gain, fit) in best.items():
        plainer = max((singles[each] + PAIR_BETTER for each in label[1:] if each in singles), default=gain)
        if gain >= least and (len(label) != 3 or gain >= plainer):
            kept.append((gain, fit))
    for gain, fit in kept[:LARGEST_COUNT]:
        yield _finding(fit, competition.extended, chosen.law.p_of(gain), name, unit)


def _label(fit: Fit, name: str) -> tuple[str, ...]:
    """Return kind and covariates of a finding on one result alone; nothing for what is none."""
    (cause,) = fit.causes
    alone = cause.shape.results if cause.shape is not None else (gauged(cause, [name]),)
    drawn = drawn_by(cause) if alone == (name,) else ()
    return drawn if not drawn or drawn[0] in {"order", "step", "wave", "product"} else ("trend", *drawn[1:])


def _finding(fit: Fit, extended: Extended, p_value: float, name: str, unit: str) -> ResidualFinding:
    """Describe an explanation of one cause as it was fitted."""
    (cause,), (values,) = fit.causes, fit.values
    drawn, *names = drawn_by(cause)
    kind: ResidualPattern = "order" if drawn == "order" else "step" if drawn == "step" else "trend"
    added = added_by(fit, extended)[cause.name][name]
    text = shape_in_words(fit.sample.machine, cause, values, added, unit)
    return ResidualFinding(kind, " and ".join(names), p_value, text)


def _acting(chosen: Chosen) -> dict[str, list[Candidate]]:
    """Return by result the registered effects of the explanation that add more to it than its noise would hide."""
    best = chosen.best
    added = added_by(best, chosen.competition.extended) if best.causes else {}
    registered = [cause for cause in best.causes if cause.effect is not None]
    return {
        channel.name: [
            cause
            for cause in registered
            # all rows together
            if np.sum((added[cause.name][channel.name][channel.rows] * channel.factors) ** 2) > SHOWS**2
        ]
        for channel in best.sample.channels
    }


def _with_named(chosen: Chosen, acting: Sequence[Candidate], findings: list[ResidualFinding]) -> list[ResidualFinding]:
    """Add what the named causes follow, where no shape has shown it: a cause is a sharper eye than any shape."""
    competition = chosen.competition
    gain = competition.score(competition.null) - competition.score(competition.known[chosen.best.key])
    covariates = competition.sample.machine.records.covariates
    for cause in acting:
        effect = cause.effect
        follows = [*(need.name for need in effect.needs), *effect.reads] if effect is not None else []
        for name in follows:
            is_seen = any(name in finding.covariate.split(" and ") for finding in findings)
            if not is_seen and name in covariates and not covariates[name].is_constant:
                words = say("follows", covariate=name, cause=cause.name)
                findings.append(ResidualFinding("trend", name, chosen.law.p_of(gain), words))
    return findings


def _of_noise(best: Fit, channel: Channel) -> Iterator[ResidualFinding]:
    """Say what the noise itself is like."""
    spread, neighbours = best.sample.noise[channel.name].spread, channel.memory.neighbours
    if spread.driver:
        words = say("spread", grows=spread.words.partition(" ")[0], covariate=spread.driver)
        yield ResidualFinding("spread", spread.driver, spread.p_value, words)
    if neighbours >= NOTICEABLE:
        yield ResidualFinding("autocorrelation", "", None, say("alike"))


def _wave(best: Fit, channel: Channel) -> Iterator[ResidualFinding]:
    """Say which wave is left over that no explanation drew, by Fisher's test of the largest ordinate of a periodogram.

    The innovations of the best explanation are put in the order of each covariate, so that a wave over it is one over
    the row; the place in a file orders nothing, nor does a covariate of fewer values than ``FEWEST_OF_WAVE``. Of m
    ordinates that are chance, the share of the largest is above g with a probability of at most
    ``m (1 - g)^(m - 1)`` (Fisher, Proc. R. Soc. A 125, 1929, the first term of his sum).
    """
    left = channel.white(channel.left(best.predicted[channel.name]))
    known = best.sample.machine.records.moved
    moved = [covariate for covariate in known if len(np.unique(covariate.values[channel.rows])) >= FEWEST_OF_WAVE]
    periods = np.arange(FEWEST_PERIODS, (len(left) - 1) // 2 + 1)
    if len(left) < FEWEST_OF_WAVE or not moved or not np.ptp(left):
        return
    waves: list[tuple[float, str, int, float]] = []
    for covariate in moved:
        ordered = left[np.argsort(covariate.values[channel.rows], kind="stable")]
        power = np.abs(np.fft.rfft(ordered - ordered.mean()))[periods] ** 2
        share = float(power.max() / power.sum())
        p_value = min(1.0, len(moved) * len(periods) * (1 - share) ** (len(periods) - 1))
        waves.append((p_value, covariate.name, int(periods[np.argmax(power)]), share))
    p_value, name, count, share = min(waves)
    if p_value <= WAVE_LEVEL:
        words = say("wave left", count=count, covariate=name, share=f"{100 * share:.0f} %")
        yield ResidualFinding("wave", name, p_value, words)
