"""From the fitted explanation to what is reported: causes with intervals, alternatives, the remainder."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from truing.arrays import Matrix
from truing.declare.sources import Effect
from truing.diagnosis.choice import Chosen, Rival
from truing.diagnosis.extended import Extended, shape_added, switched_on
from truing.diagnosis.fitted import Fit, input_value
from truing.diagnosis.intervals import Certainty, certainty_of, ends_of, numbers_of, places_of, value_of
from truing.diagnosis.result import Alternative, Calibrated, Cause, FittedUnknown, Remainder, ShapeTerm
from truing.diagnosis.shape_words import shape_in_words
from truing.diagnosis.visibility import separation
from truing.setup import Setup, SwitchedOn

Sized = tuple[float, float | None, float | None]
"""A fitted value with its interval, SI."""


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
    return tuple(sorted(weighed, key=lambda cause: -cause.share))


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
