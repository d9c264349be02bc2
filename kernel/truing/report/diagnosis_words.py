"""A diagnosis in words: what an engineer would tell a colleague, and the pieces that sheet and terminal share."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

from truing.diagnosis.result import (
    FAMILIES,
    UNKNOWN,
    Alternative,
    Amount,
    Cause,
    Chance,
    DiagnosisResult,
    Experiment,
    FittedUnknown,
    Gain,
    NextPoint,
    Tie,
    doubts,
    explanations_of,
    further_of,
    reads_well,
    shared_of,
    stated_remedy,
)
from truing.numbers import ABSENT, format_number, format_value, pretty, with_unit
from truing.units import from_si, unit_text

CERTAIN, LIKELY = 0.005, 0.05
MUCH, FEW_BLOCKS = 0.5, 0.25
TO = " … "
MICRO = re.compile(r"(?<=\d )u(?=(?:m|rad|s|N|g|l)\b)")


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
    """Write a sentence of the diagnosis for print: without underscores, micro as a letter of its own."""
    return MICRO.sub("µ", text.replace("_", " "))


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
        together([f"{name}{over}" if name == UNKNOWN else name for name in alternative.causes]) or "nothing but noise"
    )


def amount_text(amount: Amount | None, digits: int = 3) -> str:
    """Write a number with its unit, as many digits as carry meaning."""
    if amount is None:
        return ABSENT
    number, unit = format_value(amount.value, amount.unit, digits)
    return with_unit(pretty(number), unit)


def readable(amount: Amount | None) -> Amount | None:
    """Return a size in a unit in which it reads well: 1.15 µm/h rather than 0.00115 mm/h."""
    if amount is None or not amount.value or reads_well(amount.value, amount.unit):
        return amount
    head, bar, tail = amount.unit.partition("/")
    units = [f"{each}{bar}{tail}" for family in FAMILIES if head in family for each in family]
    return next((Amount(amount.value, unit) for unit in units if reads_well(amount.value, unit)), amount)


def score_text(number: float | None) -> str:
    """Write a score, a λ or a gain in log score: to a hundredth below ten, what is smaller is 0."""
    if number is None or not math.isfinite(number):
        return ABSENT
    return pretty(format_number(round(number, 2), 3))


def percent(share: float | None) -> str:
    """Write a share in percent."""
    return ABSENT if share is None or not math.isfinite(share) else f"{pretty(format_number(100 * share, 3))} %"


def p_text(p_value: float | None) -> str:
    """Write a significance."""
    if p_value is None:
        return "not tested"
    return "p < 0.001" if p_value < 0.001 else f"p {pretty(format_number(p_value, 2))}"


def certainty(p_value: float | None) -> str:
    """Say how sure something is that was found with this significance, the search paid for."""
    if p_value is None:
        return ABSENT
    words = "practically certain" if p_value <= CERTAIN else "likely" if p_value <= LIKELY else "may be chance"
    return f"{words} ({p_text(p_value)})"


def number_texts(unknown: FittedUnknown, fitted: tuple[float, float | None, float | None]) -> tuple[str, str, str, str]:
    """Write value, lower end, upper end and unit; the width of the interval decides the digits, an open end is open."""
    size = readable(Amount(unknown.value, unknown.unit))
    unit = unknown.unit if size is None else size.unit
    numbers = [None if one is None else float(from_si(one, unit)) for one in fitted]
    value, *ends = numbers
    widths = [abs(end - value) for end in ends if end is not None and value is not None]
    spread = max(filter(math.isfinite, widths), default=0.0)
    printed, low, high = (_as_wide(one, spread) for one in numbers)
    return printed, low, high, unit_text(unit)


def _as_wide(number: float | None, spread: float) -> str:
    """Write a number to two digits of its uncertainty; without one to four of its own."""
    if number is None:
        return "open"
    if not 1e-5 < spread < 1e6 or not math.isfinite(number):
        return pretty(format_number(number, 4))
    decimals = max(0, 1 - math.floor(math.log10(spread)))
    return pretty(f"{number:.{decimals}f}".replace("-0.00000", "0.00000") if number else "0")


def fitted_text(unknown: FittedUnknown, *, with_name: bool = True) -> str:
    """Write an unknown with its interval: expansion 11.8 µm/(m·K) (95 %: 11.4 … 12.2)."""
    value, low, high, unit = number_texts(unknown, (unknown.value, unknown.low, unknown.high))
    name = f"{unknown.name.replace('_', ' ')} " if with_name else ""
    if unknown.per_file:
        return f"{name}of each file alone"
    if unknown.low is None and unknown.high is None:
        return f"{name}{with_unit(value, unit)} (its interval is open)"
    return f"{name}{with_unit(value, unit)} (95 %: {low}{TO}{high})"


def cause_text(cause: Cause) -> str:
    """Say a cause with its size."""
    sizes = "; ".join(fitted_text(unknown) for unknown in cause.unknowns)
    return f"{spoken(cause.effect)}, {sizes}" if sizes else spoken(cause.effect)


NO_REMEDY = "Nobody registered what to do about it; with it on, the calculation is right: see the extended model."


def remedy_of(diagnosis: DiagnosisResult, cause: str) -> str:
    """Say what to do about a cause."""
    if cause.startswith("input:"):
        name = cause.removeprefix("input:").replace("_", " ")
        return f"Measure the {name}: it must lie outside of its tolerance."
    return stated_remedy(diagnosis, cause) or NO_REMEDY


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
        names = listed([spoken(name) for name in further], "or")
        yield f"whether {names} is there as well, this record cannot say"
    elif shared:
        names = listed([spoken(name) for name in shared])
        yield f"{names} {'is' if len(shared) == 1 else 'are'} in {'both' if count == 2 else 'all'} of them"


def headline(diagnosis: DiagnosisResult) -> list[str]:
    """Say what an engineer would tell a colleague: what is wrong, why, how much, what it is worth, what to do next."""
    if diagnosis.verdict == "none" or (diagnosis.verdict == "undecided" and not diagnosis.causes):
        return list(_unnamed(diagnosis))
    said = [
        *_cause_sentences(diagnosis), *(f"{prose(warning)}." for warning in diagnosis.warnings),
        *_gain_sentences(diagnosis), *_next_sentences(diagnosis),
    ]  # fmt: skip
    return [sentence[:1].upper() + sentence[1:] for sentence in said]


def _unnamed(diagnosis: DiagnosisResult) -> Iterator[str]:
    met = listed(
        [
            f"{spoken(wrong.result)} to {amount_text(wrong.rmse)} (noise floor {amount_text(wrong.noise_floor)})"
            for wrong in diagnosis.wrong
        ]
    )
    if diagnosis.verdict == "none":
        yield f"Within its tolerances the model meets the measurement: {met}."
        yield "What is left is noise; no effect, registered or not, is needed."
    else:
        yield f"No cause is named, but that nothing is wrong cannot be said either: {reasons(diagnosis)}."
        yield f"The model as it is: {met}."
    blind = [spoken(visible.name) for visible in diagnosis.seen if visible.sight == "not excited"]
    if blind:
        yield f"That says nothing of {listed(blind)}: this data does not excite {'it' if len(blind) == 1 else 'them'}."
    if diagnosis.verdict == "undecided":
        yield "More readings, of a wider range and in a changed order, would decide."


def reasons(diagnosis: DiagnosisResult) -> str:
    """Give the reasons for which a diagnosis is undecided, in print."""
    return listed([prose(doubt) for doubt in doubts(diagnosis)])


def wrong_results(diagnosis: DiagnosisResult) -> list[str]:
    """Return the results that are wrong: with findings or a gain, else those of the remainder, else all."""
    wrong_names = [wrong.result for wrong in diagnosis.wrong if wrong.findings]
    gained = [gain.result for gain in diagnosis.gain if is_gain(gain)]
    names = [name for name in diagnosis.measured if name in {*wrong_names, *gained}]
    of_remainder = list(diagnosis.remainder.results) if diagnosis.remainder is not None else []
    return names or of_remainder or list(diagnosis.measured)


def is_gain(gain: Gain) -> bool:
    """Tell whether a gain is more than chance."""
    return gain.p_value <= LIKELY and gain.rmse_after.value < gain.rmse_before.value


def _cause_sentences(diagnosis: DiagnosisResult) -> Iterator[str]:
    results = listed([spoken(name) for name in wrong_results(diagnosis)])
    has_further = bool(further_of(diagnosis))
    is_open = diagnosis.verdict == "one_of" and not has_further
    if is_open:
        names = [together(names) for names in explanations_of(diagnosis)]
        yield f"what the model misses in {results} is drawn alike by {listed(names, 'or')}."
        yield from (f"{words}." for words in shared_words(diagnosis))
    if diagnosis.causes:
        causes = listed([cause_text(cause) for cause in diagnosis.causes])
        if is_open:
            yield f"taken as the first of them: {causes}."
        elif diagnosis.verdict == "undecided":
            what = "this is the cause" if len(diagnosis.causes) == 1 else "these are the causes"
            yield f"what the model misses in {results} is drawn best by {causes}; that {what} is in doubt."
        else:
            yield f"what the model misses in {results}: {causes}."
    remainder = diagnosis.remainder
    if remainder is not None:
        over = listed([spoken(name) for name in remainder.depends_on])
        of_results = listed([spoken(name) for name in remainder.results])
        what = "beside it something" if diagnosis.causes else "something"
        yield f"{what} that no registered effect explains is in {of_results}, over {over}: {prose(remainder.shape)}."
    if has_further:
        yield from (f"{words}." for words in shared_words(diagnosis))


def _gain_sentences(diagnosis: DiagnosisResult) -> Iterator[str]:
    gains = [gain for gain in diagnosis.gain if is_gain(gain)]
    perhaps = [  # their error falls by much, but in too few independent blocks to be more than chance
        gain
        for gain in diagnosis.gain
        if gain not in gains and gain.reducible_removed >= MUCH and gain.p_value < FEW_BLOCKS
    ]
    for gain in (*gains, *perhaps):
        before, after = amount_text(gain.rmse_before), amount_text(gain.rmse_after)
        falls = f"on rows that were not fitted the error of {spoken(gain.result)} falls from {before} to {after}"
        if gain in gains:
            removed = percent(gain.reducible_removed)
            yield f"{falls} (noise floor {amount_text(gain.noise_floor)}): {removed} of what can be removed is gone."
        else:
            yield f"{falls}; in so few independent blocks that may be chance ({p_text(gain.p_value)})."
    if diagnosis.gain and not gains and not perhaps:
        yield "on rows that were not fitted there is no gain that could not be chance."
    for gain in diagnosis.gain:
        if gain.held_out is not None:
            before, after = (amount_text(replace(gain.rmse_before, value=row)) for row in gain.held_out)
            if gain.held_out[1] < gain.held_out[0]:
                yield f"on the rows held out the error of {spoken(gain.result)} falls from {before} to {after}."
            elif not diagnosis.causes:  # with causes an alarm says so
                grows = f"on the rows held out the error of {spoken(gain.result)} GROWS from {before} to {after}"
                yield f"{grows}: the extension does not carry over to them."


def _next_sentences(diagnosis: DiagnosisResult) -> Iterator[str]:
    """Say what tells the explanations apart, with which chance."""
    said = [
        f"measure {settings_text(each)}: it separates {pair_text(each)}." for each in diagnosis.next if each.measure
    ]
    ways = [said, [] if diagnosis.experiment is None else [f"{experiment_text(diagnosis.experiment)}."]]
    for sentences in ways if is_result_first(diagnosis) else reversed(ways):
        yield from sentences
    yield from map(tie_text, diagnosis.ties)
    if diagnosis.next or diagnosis.ties:
        return
    if diagnosis.verdict == "named":
        yield "no other explanation comes near; there is nothing left to separate."
    if diagnosis.verdict == "one_of":
        yield "no setting can be proposed that tells them apart; another record, of other conditions, may."


def is_result_first(diagnosis: DiagnosisResult) -> bool:
    """Whether a further result is proposed before the experiment, which leaves something open that it does not."""
    return bool(diagnosis.next and diagnosis.next[0].measure)


def experiment_text(experiment: Experiment) -> str:
    """Say an experiment: what is held, what is varied from where to where, how long, what it tells, how surely."""
    count, takes = experiment.readings, experiment.takes
    said = f"{count} readings" + (f" in {amount_text(readable(takes), 2)}" if takes is not None and takes.value else "")
    tells = f"tell {told_apart(experiment)} apart with a chance of {chance_text(experiment.chance)}"
    enough = f"{experiment.needed} readings" if experiment.needed else "more than a hundred readings"
    more = f"; {enough} like these would be needed for 95 %" if experiment.needed != count else ""
    return f"{'; '.join(course_texts(experiment))}: {said} {tells}{more}"


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


def pair_text(point: NextPoint) -> str:
    """Say which two explanations a point is for."""
    first, second = point.separates
    return f"{together([first])} from {together([second])}"


def tie_text(tie: Tie) -> str:
    """Say which fact decides where no measurement does."""
    names = listed([together([name]) for name in tie.explanations])
    if not tie.facts:
        return f"no measurement proposed here tells {names} apart; only a fact from elsewhere does."
    facts = []
    for fact in tie.facts:
        note = f" ({fact.note})" if fact.note else ""
        facts.append(
            f"whether {spoken(fact.quantity.removeprefix('input:'))}{note} is {amount_text(readable(fact.value))}"
        )
    return f"no measurement proposed here tells {names} apart; a fact from elsewhere does: {listed(facts, 'or')}."


def settings_text(point: NextPoint) -> str:
    """Write a setting: load -50 kN, crank angle 28.6°; or what to measure, too: depth as well."""
    if point.measure:
        return f"{listed([spoken(name) for name in point.measure])} as well"
    return ", ".join(f"{spoken(name)} {amount_text(amount)}" for name, amount in point.settings.items())
