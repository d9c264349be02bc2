"""A diagnosis in words: what an engineer would tell a colleague, and the pieces that sheet and terminal share."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import chain

import numpy as np

from truing.diagnosis.result import (
    STRUCTURE,
    UNKNOWN,
    Alternative,
    Amount,
    Cause,
    Chance,
    DiagnosisResult,
    Experiment,
    Fact,
    FittedUnknown,
    Gain,
    NextPoint,
    Tie,
    Wrong,
    doubts,
    explanations_of,
    further_of,
    shared_of,
    stated_remedy,
)
from truing.diagnosis.sentences import records_words, say, sentence
from truing.experiments.reach import ended_at, role_of
from truing.numbers import format_number, pretty
from truing.report.diagnosis_sizes import (
    TO,
    amount_text,
    as_waves,
    fitted_text,
    partner_of,
    readable,
    wave_name,
)
from truing.report.document import unit_as_said
from truing.units import difference_unit

CERTAIN, LIKELY = 0.005, 0.05
MUCH, FEW_BLOCKS = 0.5, 0.25
BEYOND = 0.05
"""A setting lies outside of the record where it is beyond its ends by more than this share of range or size."""
UNIT = re.compile(r"(?<=\d )[A-Za-z][A-Za-z0-9*/^()]*")
AMBIGUOUS = frozenset({"in", "at", "a"})
"""Words that would be units behind a number."""


def spoken(name: str) -> str:
    """Say a name: without underscores; the unknown of an effect behind it; an input outside of its band as such."""
    if name.startswith("input:"):
        return f"{name.removeprefix('input:').replace('_', ' ')} outside of its tolerance"
    if name.startswith(UNKNOWN):
        over = [spoken(each) for each in name.removeprefix(UNKNOWN).removeprefix(":").split(",") if each]
        return f"something unregistered over {listed(over)}" if over else "something unregistered"
    return name.replace("_", " ").replace(".", ", ")


def together(names: Sequence[str]) -> str:
    """Say an explanation by the names of its causes."""
    return " + ".join(spoken(each) for name in names for each in name.split(" + "))


def prose(text: str) -> str:
    """Write a sentence of the diagnosis for print: without underscores, units behind numbers as they are printed."""
    return UNIT.sub(_printed_unit, text.replace("_", " "))


def _printed_unit(match: re.Match[str]) -> str:
    unit = match[0]
    return unit if unit in AMBIGUOUS else unit_as_said(unit)


def listed(words: Sequence[str], joined: str = "and") -> str:
    """Join words as a sentence does: a, b and c."""
    words = list(dict.fromkeys(words))
    if len(words) < 2:
        return "".join(words)
    return f"{', '.join(words[:-1])} {joined} {words[-1]}"


def explanation(alternative: Alternative) -> str:
    """Say one explanation: its causes, or that nothing is wrong."""
    over = f":{','.join(alternative.depends_on)}" if alternative.depends_on else ""
    return (
        together([f"{name}{over}" if name == UNKNOWN else name for name in alternative.causes]) or "nothing but scatter"
    )


def cause_text(cause: Cause) -> str:
    """Say a cause with its size."""
    sizes = sizes_text(cause.unknowns, cause.covariance)
    return f"{spoken(cause.effect)}, {sizes}" if sizes else spoken(cause.effect)


def sizes_text(unknowns: Sequence[FittedUnknown], covariance: Sequence[Sequence[float]] = ()) -> str:
    """Say fitted numbers with their intervals, a wave by its amplitude and phase."""
    return "; ".join(fitted_text(unknown) for unknown in as_waves(unknowns, covariance))


def certainty(p_value: float | None) -> str:
    """Say how sure something is that was noticed with this significance, the search paid for."""
    if p_value is None:
        return "noticed"
    return "practically certain" if p_value <= CERTAIN else "likely" if p_value <= LIKELY else "may be chance"


NO_REMEDY = "No remedy is registered for it. Find out what stands behind it before the machine is changed."


def remedy_of(diagnosis: DiagnosisResult, cause: str) -> str:
    """Say what to do about a cause."""
    if cause.startswith("input:"):
        name = cause.removeprefix("input:").replace("_", " ")
        return f"Measure the {name}: it must lie outside of its tolerance."
    return prose(stated_remedy(diagnosis, cause)) or NO_REMEDY


def about_of(diagnosis: DiagnosisResult, cause: str) -> str:
    """Say what a cause is: what its author wrote, or that it is an input; nothing where nobody wrote anything."""
    if cause.startswith("input:"):
        return "an input that must lie outside of its tolerance"
    effect = diagnosis.setup.model.known_effects.get(cause)
    return "" if effect is None else prose(effect.why or effect.looks_like)


def meaning_of(diagnosis: DiagnosisResult, cause: str) -> str:
    """Say in its author's words what a cause is, of an input what that one is; nothing where nobody wrote anything."""
    if not cause.startswith("input:"):
        return about_of(diagnosis, cause)
    name, model = cause.removeprefix("input:"), diagnosis.setup.model
    declared = model.input_fields.get(name)
    note = declared.spec.note if declared is not None else model.known_conditions[name].note
    return prose(note)


def verdict_word(diagnosis: DiagnosisResult) -> str:
    """Say the verdict in a few words."""
    count = len(explanations_of(diagnosis))
    is_single = all(len(names) == 1 for names in explanations_of(diagnosis))
    word = {
        "none": "Nothing found",
        "undecided": "Cause in doubt" if count else "Undecided",
        "unknown": "Cause unknown",
        "named": "Cause named",
        "one_of": f"One of {count} {'causes' if is_single else 'explanations'}; this record cannot say which",
    }[diagnosis.verdict]
    has_more = bool(diagnosis.causes) and diagnosis.remainder is not None
    return f"{word}, a remainder left" if has_more and diagnosis.verdict == "named" else word


def shared_words(diagnosis: DiagnosisResult) -> Iterator[str]:
    """Say what all explanations hold, where there are several, or what may be there beside the one that all hold."""
    shared, count = shared_of(diagnosis), len(explanations_of(diagnosis))
    further = further_of(diagnosis)
    if further:
        yield say("as well", causes=listed([spoken(name) for name in further], "or"))
    elif shared:
        names = listed([spoken(name) for name in shared])
        yield say(
            "in all of them", causes=names, are="is" if len(shared) == 1 else "are", all="both" if count == 2 else "all"
        )


def headline(diagnosis: DiagnosisResult) -> list[str]:
    """Say what an engineer would tell a colleague: what is wrong, why, how much, what it is worth, what to do next."""
    if diagnosis.verdict == "none" or (diagnosis.verdict == "undecided" and not diagnosis.causes):
        said = _unnamed(diagnosis)
    else:
        said = chain(
            _cause_sentences(diagnosis), map(prose, diagnosis.warnings), _gain_sentences(diagnosis),
            _next_sentences(diagnosis),
        )  # fmt: skip
    return [sentence(text) for text in said]


def _unnamed(diagnosis: DiagnosisResult) -> Iterator[str]:
    met = listed(
        [
            say("met to", result=spoken(wrong.result), error=amount_text(wrong.rmse),
                scatter=amount_text(wrong.noise_floor))
            for wrong in diagnosis.wrong
        ]
    )  # fmt: skip
    if diagnosis.verdict == "none":
        yield say("meets", met=met)
        yield say("only scatter")
    else:
        yield say("not sure of nothing", reasons=reasons(diagnosis))
        yield say("as it is", met=met)
    blind = list(dict.fromkeys(sight_name(seen.name) for seen in diagnosis.seen if seen.sight == "not excited"))
    if blind:
        yield say("blind", causes=listed(blind), them="it" if len(blind) == 1 else "them")
    if diagnosis.verdict == "undecided":
        yield say("more readings")


def sight_name(name: str) -> str:
    """Say the effect, and which amplitude of it, that could be seen; the parts of a wave are one."""
    effect, _, unknown = name.partition(".")
    shown = wave_name(unknown) if partner_of(unknown) else unknown
    return spoken(f"{effect}.{shown}" if shown else effect)


def reasons(diagnosis: DiagnosisResult) -> str:
    """Give the reasons for which a diagnosis is undecided, in print."""
    return listed([prose(doubt) for doubt in doubts(diagnosis)])


def is_off(diagnosis: DiagnosisResult, wrong: Wrong) -> bool:
    """Tell whether something in a result is to be explained: a pattern that no tolerance allows, or a gain."""
    gained = {gain.result for gain in diagnosis.gain if is_gain(gain)}
    shaped = any(finding.kind in STRUCTURE and not finding.is_allowed for finding in wrong.findings)
    remainder = diagnosis.remainder is not None and wrong.result in diagnosis.remainder.results
    return shaped or wrong.result in gained or remainder


def wrong_results(diagnosis: DiagnosisResult) -> list[str]:
    """Return the results that are wrong; all of them where none is."""
    wrong_names = [wrong.result for wrong in diagnosis.wrong if is_off(diagnosis, wrong)]
    return [name for name in diagnosis.measured if name in wrong_names] or list(diagnosis.measured)


def is_gain(gain: Gain) -> bool:
    """Tell whether a gain is more than chance."""
    return gain.p_value <= LIKELY and gain.rmse_after.value < gain.rmse_before.value


def _cause_sentences(diagnosis: DiagnosisResult) -> Iterator[str]:
    results = listed([spoken(name) for name in wrong_results(diagnosis)])
    has_further = bool(further_of(diagnosis))
    is_open = diagnosis.verdict == "one_of" and not has_further
    if is_open:
        names = [together(names) for names in explanations_of(diagnosis)]
        yield say("drawn alike", results=results, explanations=listed(names, "or"))
        yield from shared_words(diagnosis)
    if diagnosis.causes:
        causes = listed([cause_text(cause) for cause in diagnosis.causes])
        if is_open:
            yield say("taken as first", causes=causes)
        elif diagnosis.verdict == "undecided":
            this = "this is the cause" if len(diagnosis.causes) == 1 else "these are the causes"
            yield say("best in doubt", results=results, causes=causes, this=this)
        else:
            yield say("cause", results=results, causes=causes)
    remainder = diagnosis.remainder
    if remainder is not None:
        over = listed([spoken(name) for name in remainder.depends_on])
        something = "beside it something" if diagnosis.causes else "something"
        of_results = listed([spoken(name) for name in remainder.results])
        shape = prose(remainder.shape)
        yield say("unregistered", something=something, results=of_results, covariates=over, shape=shape)
    if has_further:
        yield from shared_words(diagnosis)
    yield from chance_words(diagnosis)


def chance_words(diagnosis: DiagnosisResult) -> Iterator[str]:
    """Say how often chance alone would give what was found."""
    if diagnosis.p_any is None or math.isnan(diagnosis.p_any):
        yield say("chance not known")
        return
    yield say("chance", records=records_words(diagnosis.p_any))
    if diagnosis.p_second is not None and not math.isnan(diagnosis.p_second) and len(diagnosis.causes) > 1:
        causes = listed([spoken(cause.effect) for cause in diagnosis.causes])
        yield say("chance of another", causes=causes, records=records_words(diagnosis.p_second))


def gain_text(diagnosis: DiagnosisResult, gain: Gain) -> str:
    """Say what the extension is worth for a result, on rows that were not fitted; nothing where that may be chance."""
    name, before, after = spoken(gain.result), amount_text(gain.rmse_before), amount_text(gain.rmse_after)
    if is_gain(gain):
        return say("falls", result=name, before=before, after=after, scatter=amount_text(gain.noise_floor))
    if gain.reducible_removed >= MUCH and gain.p_value < FEW_BLOCKS:
        return say("falls perhaps", result=name, before=before, after=after)
    return ""


def _gain_sentences(diagnosis: DiagnosisResult) -> Iterator[str]:
    said = [(gain, gain_text(diagnosis, gain)) for gain in diagnosis.gain]
    yield from (text for gain, text in said if text and is_gain(gain))
    yield from (text for gain, text in said if text and not is_gain(gain))
    if diagnosis.gain and not any(text for _, text in said):
        yield say("no gain")
    for gain in diagnosis.gain:
        if gain.held_out is not None:
            yield from held_out_words(diagnosis, gain)


def held_out_words(diagnosis: DiagnosisResult, gain: Gain, *, alone: bool = True) -> Iterator[str]:
    """Say what became of the error on rows that only judge; not ``alone`` also what a warning says of it."""
    if gain.held_out is None:
        return
    before, after = (amount_text(replace(gain.rmse_before, value=row)) for row in gain.held_out)
    if gain.held_out[1] < gain.held_out[0]:
        yield say("falls held out", result=spoken(gain.result), before=before, after=after)
    elif not (alone and diagnosis.causes):
        yield say("grows held out", result=spoken(gain.result), before=before, after=after)


def what_decides(diagnosis: DiagnosisResult) -> Iterator[str]:
    """Say what tells the explanations apart, with which chance: readings, further results, facts from elsewhere."""
    said = [result_text(each) for each in diagnosis.next if each.measure]
    ways = [said, [] if diagnosis.experiment is None else [experiment_text(diagnosis.experiment)]]
    for sentences in ways if is_result_first(diagnosis) else reversed(ways):
        yield from sentences
    if diagnosis.experiment is not None:
        yield from _bring_words(diagnosis, diagnosis.experiment)
        yield from _beyond_words(diagnosis, diagnosis.experiment)
    yield from map(tie_text, diagnosis.ties)
    yield from _left_open(diagnosis)


def _bring_words(diagnosis: DiagnosisResult, experiment: Experiment) -> Iterator[str]:
    """Say how far what follows from the work has to be brought before the experiment can begin."""
    brought = []
    for course in experiment.courses:
        covariate = diagnosis.records.covariates.get(course.name)
        if covariate is None or covariate.role == "time" or role_of(diagnosis.setup, course.name) != "follows":
            continue
        away = course.start - ended_at(diagnosis.records, course.name)
        if abs(away) > BEYOND * float(np.nanmax(covariate.values) - np.nanmin(covariate.values)):
            unit = experiment.units[course.name]
            distance = amount_text(readable(Amount(abs(away), difference_unit(unit))), 2)
            side = "above" if away > 0 else "below"
            begin = _end(experiment, course.name, course.start)
            brought.append(f"{spoken(course.name)} to {begin} ({distance} {side} where the record ended)")
    if brought:
        yield say("bring first", settings=listed(brought))


def _beyond_words(diagnosis: DiagnosisResult, experiment: Experiment) -> Iterator[str]:
    """Say which settings lie outside of what was measured."""
    beyond = []
    for name, values in experiment.settings.items():
        covariate = diagnosis.records.covariates.get(name)
        if covariate is None or covariate.role == "time":
            continue
        low, high = float(np.nanmin(covariate.values)), float(np.nanmax(covariate.values))
        if max(low - float(values.min()), float(values.max()) - high) > BEYOND * (high - low or abs(high)):
            ends = dict.fromkeys(amount_text(Amount(end, covariate.unit)) for end in (low, high))
            beyond.append(f"{spoken(name)} (so far {' to '.join(ends)})")
    if beyond:
        yield say("beyond", settings=listed(beyond))


def _left_open(diagnosis: DiagnosisResult) -> Iterator[str]:
    """Say which of several explanations nothing that is proposed is about."""
    if diagnosis.verdict != "one_of" or not (diagnosis.next or diagnosis.ties):
        return
    told = {*(diagnosis.experiment.tells if diagnosis.experiment is not None else ())}
    told |= {name for point in diagnosis.next if point.measure for name in point.separates}
    told |= {name for tie in diagnosis.ties for name in tie.explanations}
    left = [names for names in explanations_of(diagnosis) if " + ".join(names) not in told]
    if left:
        yield say("left open", explanations=listed([together(names) for names in left]))


def _next_sentences(diagnosis: DiagnosisResult) -> Iterator[str]:
    yield from what_decides(diagnosis)
    if diagnosis.next or diagnosis.ties:
        return
    if diagnosis.verdict == "named":
        yield say("nothing to separate")
    if diagnosis.verdict == "one_of":
        yield say("no proposal")


def result_text(point: NextPoint) -> str:
    """Say which further result to measure, and for which two explanations."""
    one, other = (together([name]) for name in point.separates)
    return say("measure as well", results=listed([spoken(name) for name in point.measure]), one=one, other=other)


def is_result_first(diagnosis: DiagnosisResult) -> bool:
    """Whether a further result is proposed before the experiment, which leaves something open that it does not."""
    return bool(diagnosis.next and diagnosis.next[0].measure)


def experiment_text(experiment: Experiment) -> str:
    """Say an experiment: what is held, what is varied from where to where, how long, what it tells, how surely."""
    count, takes = experiment.readings, experiment.takes
    said = {
        "course": "; ".join(course_texts(experiment)),
        "readings": f"{count} readings"
        + (f" in {amount_text(readable(takes), 2)}" if takes is not None and takes.value else ""),
        "explanations": told_apart(experiment),
        "chance": chance_text(experiment.chance),
    }
    if experiment.needed == count:
        return say("experiment", **said)
    enough = f"{experiment.needed} readings" if experiment.needed else "more than a hundred readings"
    return say("experiment needs more", **said, enough=enough)


def course_texts(experiment: Experiment) -> list[str]:
    """Say what is held, then what is varied from where to where; the time that passes is said with the readings."""
    held = [course for course in experiment.courses if course.way == "held"]
    varied = [course for course in experiment.courses if course.way != "held" and course.name != "time"]
    said = [f"hold {', '.join(f'{spoken(each.name)} {_end(experiment, each.name, each.start)}' for each in held)}"]
    for course in varied:
        begin, end = (_end(experiment, course.name, value) for value in (course.start, course.end))
        words = {"ramp": f"from {begin} to {end}", "to and fro": f"from {begin} to {end} and back"}
        said.append(f"{spoken(course.name)} {words.get(course.way, f'{begin} and {end} in turn')}")
    return said if held else said[1:] or ["as it stands"]


def _end(experiment: Experiment, name: str, value: float) -> str:
    return amount_text(Amount(value, experiment.units[name]), 4)


def chance_text(chance: Chance) -> str:
    """Write a chance with its interval, in percent."""
    value, low, high = (pretty(format_number(round(100 * each), 3)) for each in (chance.value, chance.low, chance.high))
    return f"{value} % (95 %: {low}{TO}{high})"


def told_apart(experiment: Experiment) -> str:
    """Say what an experiment tells apart: explanations, and in one breath those that stay one."""
    apart = {frozenset(pair) for pair in experiment.apart}
    groups: list[list[str]] = []
    for name in experiment.tells:
        fitting = [group for group in groups if not any(frozenset((name, other)) in apart for other in group)]
        if not fitting:
            groups.append([])
        (fitting or groups)[-1 if not fitting else 0].append(name)
    return listed([listed([together([name]) for name in group], "or") for group in groups])


def tie_text(tie: Tie) -> str:
    """Say which fact decides where no measurement does."""
    names = listed([together([name]) for name in tie.explanations])
    if not tie.facts:
        return say("nothing decides", explanations=names)
    return say("fact decides", explanations=names, facts=listed(list(_facts(tie.facts)), "or"))


def _facts(facts: Sequence[Fact]) -> Iterator[str]:
    """Say what to measure, and how well; the two parts of a wave are one amplitude."""
    known = {fact.quantity: fact for fact in facts}
    for fact in facts:
        effect, _, unknown = fact.quantity.partition(".")
        partner = f"{effect}.{partner_of(unknown)}"
        note, shown = (f" ({fact.note})" if fact.note else ""), spoken(fact.quantity)
        sizes = [fact.value, fact.accuracy]
        if partner in known:
            if "cosine" in unknown:
                continue
            parts = zip(sizes, (known[partner].value, known[partner].accuracy), strict=True)
            sizes = [replace(part, value=math.hypot(part.value, other.value)) for part, other in parts]
            shown, note = f"{sight_name(fact.quantity)}, amplitude", ""
        size, accuracy = map(readable, sizes)
        yield say(
            "fact", quantity=f"{shown.removesuffix(' outside of its tolerance')}{note}", size=amount_text(size),
            accuracy=amount_text(accuracy, 2), explanation=together([fact.explanation]),
        )  # fmt: skip


def settings_text(point: NextPoint) -> str:
    """Write a setting: load -50 kN, crank angle 28.6°; or what to measure, too: depth as well."""
    if point.measure:
        return f"{listed([spoken(name) for name in point.measure])} as well"
    return ", ".join(f"{spoken(name)} {amount_text(amount)}" for name, amount in point.settings.items())
