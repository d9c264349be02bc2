"""What is wrong with the residuals, in words with numbers and units: bias, trends, orders, steps, spread, outliers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from truing.arrays import Matrix
from truing.diagnosis.causes import Candidate, gauged
from truing.diagnosis.choice import Chosen
from truing.diagnosis.extended import Extended
from truing.diagnosis.fitted import Fit
from truing.diagnosis.gain import floor_of
from truing.diagnosis.naming import added_by
from truing.diagnosis.noise import robust_sd
from truing.diagnosis.result import Amount, NoiseSummary, ResidualFinding, ResidualPattern, Wrong
from truing.diagnosis.sample import Channel, errors_of, residuals_of
from truing.diagnosis.shape_words import drawn_by, in_unit, shape_in_words
from truing.numbers import counted

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
FEWEST_OF_WAVE = 20
"""Readings below which any scatter looks like some wave."""


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
        words = f"{counted(len(outliers), 'suspected outlier')}, beyond four standard deviations of the noise"
        findings.append(ResidualFinding("outlier", "", None, words))
    given = records.sigma.get(name, np.zeros(len(records)))[rows]
    given = given[given > 0]
    stated = Amount(float(np.sqrt(np.mean(given**2))), unit) if len(given) else None
    return Wrong(name, len(rows), Amount(rmse, unit), Amount(floor, unit), share, noise, tuple(findings), stated)


def _bias(chosen: Chosen, channel: Channel, residual: Matrix, unit: str) -> Iterator[ResidualFinding]:
    """Say by how much the nominal model is off on average, and whether calibration within the tolerances takes it."""
    sample = chosen.null.sample
    mean = float(np.mean(residual))
    drawn = np.asarray(sample.machine.slopes[channel.name][channel.rows] @ sample.directions)
    spread = float(np.sqrt(np.mean(np.sum(drawn**2, axis=1))))
    if abs(mean) <= BIASED * channel.scale / np.sqrt(len(channel)):
        return
    words = "more than the tolerances allow" if spread > 0 else "and no tolerance allows for it"
    if is_allowed := abs(mean) <= BIASED * spread:
        words = f"within what the tolerances allow ({in_unit(spread, unit)} standard deviation)"
    yield ResidualFinding(
        "bias", "", None, f"on average {in_unit(mean, unit)} off the nominal model, {words}", is_allowed
    )


def _structure(chosen: Chosen, name: str, unit: str) -> Iterator[ResidualFinding]:
    """Say what the residual of the calibrated model depends on; every p-value has paid for the whole search.

    Shapes that explain little beside the best explanation are its shadows (a jump has waves of every order).
    """
    competition = chosen.competition
    alone = [fit for fit in competition.known.values() if len(fit.causes) == 1]
    offsets = [fit for fit in alone if fit.causes[0].name == "sensor_offset"]
    constant = [fit for fit in offsets if gauged(fit.causes[0], [name])]
    plain = min(competition.score(fit) for fit in (competition.null, *constant))  # what a trend must beat to be one
    best: dict[tuple[str, ...], tuple[float, Fit]] = {}
    for fit in alone:
        label, gain = _label(fit, name), plain - competition.score(fit)
        is_found = bool(label) and chosen.law.p_of(gain) <= SIGNIFICANT
        if is_found and (label not in best or gain > best[label][0]):
            best[label] = (gain, fit)
    singles: dict[str, float] = {}
    for label, (gain, _) in best.items():
        if len(label) == 2:
            singles[label[1]] = max(gain, singles.get(label[1], gain))
    least = SHADOW * (plain - competition.score(competition.ranked()[0]))
    kept = []
    for label, (gain, fit) in sorted(best.items(), key=lambda pair: -pair[1][0]):
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
                findings.append(
                    ResidualFinding("trend", name, chosen.law.p_of(gain), f"follows {name}, as {cause.name} would")
                )
    return findings


def _of_noise(best: Fit, channel: Channel) -> Iterator[ResidualFinding]:
    """Say what the noise itself is like."""
    spread, neighbours = best.sample.noise[channel.name].spread, channel.memory.neighbours
    if spread.driver:
        yield ResidualFinding("spread", spread.driver, spread.p_value, f"the scatter {spread.words}")
    if neighbours >= NOTICEABLE:
        words = f"neighbouring rows are alike (autocorrelation {neighbours:.2f})"
        yield ResidualFinding("autocorrelation", "", None, words)


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
        words = f"{count} waves over the range of {name}, with {100 * share:.0f} % of what is left after all"
        yield ResidualFinding("wave", name, p_value, words)
