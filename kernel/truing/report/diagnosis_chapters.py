"""The chapters of a diagnosis, in plain sentences; what statistics stand behind each is folded away below it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from math import inf

from truing.diagnosis.ranking import lowest_first
from truing.diagnosis.records import file_labels
from truing.diagnosis.result import (
    Amount,
    DiagnosisResult,
    FittedUnknown,
    NextPoint,
    ResidualFinding,
    VisibleSize,
    Wrong,
    explanations_of,
    often,
    stated_remedy,
)
from truing.diagnosis.sentences import kind_of, say, sentence
from truing.numbers import ABSENT, STATED_DIGITS
from truing.report import diagnosis_figures as figures
from truing.report import diagnosis_statistics as statistics
from truing.report.chapters import Figures
from truing.report.diagnosis_record import record_blocks
from truing.report.diagnosis_rivals import parting_of, rivals_apart
from truing.report.diagnosis_sizes import amount_text, as_waves, number_texts, partner_of, percent, readable, score_text
from truing.report.diagnosis_words import (
    about_of,
    cause_text,
    certainty,
    chance_words,
    experiment_text,
    explanation,
    gain_text,
    held_out_words,
    is_off,
    is_result_first,
    listed,
    prose,
    reasons,
    result_text,
    shared_words,
    sight_name,
    sizes_text,
    spoken,
    tie_text,
)
from truing.report.document import (
    BlockView,
    Chapter,
    Fold,
    Items,
    Marked,
    Paragraph,
    TableView,
    Text,
    plain_text,
    table_of,
)

FITTED_DIGITS = 7
EVERYTHING = "extended.toml"
MOST_SEEN, MOST_MOVED = 6, 4
"""So many effects and inputs a sentence names at most."""
MOVED = 0.1
"""An input that moved by less, in standard deviations of its tolerance, has not moved."""
WEAK = 10.0
"""A rival that loses less fit than this is not worth a line of its own."""
HEADS = ("Cause", "Unknown", "Value", "95 % interval", "Unit")


def diagnosis_chapters(diagnosis: DiagnosisResult, drawn: Figures) -> Iterator[Chapter]:
    """Write the chapters in the order in which they are asked for: the record first, so that a wrong column is seen."""
    chapters: Mapping[str, tuple[str, Callable[[], Iterator[BlockView]]]] = {
        "record": ("The record", partial(record_blocks, diagnosis, drawn)),
        "wrong": ("What is wrong", partial(_wrong, diagnosis, drawn)),
        "cause": ("Cause", partial(_cause, diagnosis, drawn)),
        "left": ("What is left", partial(_left, diagnosis, drawn)),
        "model": ("Extended model", partial(_model, diagnosis)),
        "gain": ("Gain", partial(_gain, diagnosis, drawn)),
        "next": ("Next measurement", partial(_next, diagnosis)),
    }
    for ident, (title, written) in chapters.items():
        blocks = tuple(written())
        lines = tuple(terminal_lines(blocks)) if ident not in ("record", "left") else ()
        yield Chapter(title, blocks, ident, lines=lines)


def terminal_lines(blocks: Iterable[BlockView]) -> Iterator[str]:
    """Give what a terminal and a notebook print of a chapter: its sentences, what belongs to one indented below it."""
    for block in blocks:
        match block:
            case Paragraph(text):
                yield plain_text(text)
            case Items(_, texts, labels):
                for index, text in enumerate(texts):
                    label = f"{labels[index]}: " if labels else ""
                    yield f"  {label}{plain_text(text)}"


def _said(texts: Iterable[str]) -> Iterator[Paragraph]:
    """Write sentences as paragraphs."""
    yield from (Paragraph(sentence(text)) for text in texts)


# What is wrong


def _wrong(diagnosis: DiagnosisResult, drawn: Figures) -> Iterator[BlockView]:
    for wrong in diagnosis.wrong:
        yield from _said([_off_text(diagnosis, wrong)])
        if wrong.findings:
            yield Items("patterns", tuple(map(_pattern, wrong.findings)))
    if sum(finding.p_value is not None for wrong in diagnosis.wrong for finding in wrong.findings) > 1:
        yield from _said([say("patterns")])
    if not any(wrong.findings for wrong in diagnosis.wrong):
        yield from _said([say("no pattern")])
    for curves in figures.shown_curves(diagnosis):
        title = f"Measured {spoken(curves.result)} against simulated"
        colours = " Red circles before, blue points after." if figures.has_changed(curves) else ""
        caption = f"{title}: as it is on the left, the difference on the right.{colours}"
        caption += figures.thinning_words(diagnosis, curves)
        yield drawn.view(title, partial(figures.against_simulated, diagnosis, curves), caption)
    yield Fold("Statistics: errors, patterns, scatter", tuple(statistics.of_errors(diagnosis)))


def _pattern(finding: ResidualFinding) -> Text:
    """Say what was noticed, and where that was tested how sure it is."""
    text = prose(finding.text)
    if finding.p_value is None or kind_of(finding.text) == "follows":
        return sentence(text)
    return Marked("strong", f"{certainty(finding.p_value).capitalize()}:"), f" {text}."


def _off_text(diagnosis: DiagnosisResult, wrong: Wrong) -> str:
    kind = "is off" if is_off(diagnosis, wrong) else "is met"
    error, scatter = amount_text(wrong.rmse), amount_text(wrong.noise_floor)
    return say(kind, result=spoken(wrong.result), error=error, scatter=scatter)


# Cause


def _cause(diagnosis: DiagnosisResult, drawn: Figures) -> Iterator[BlockView]:
    yield from _said([_verdict_text(diagnosis)])
    yield from _said(shared_words(diagnosis))
    yield from _said(chance_words(diagnosis))
    if diagnosis.causes:
        yield from _named(diagnosis)
    yield from _said(_near(diagnosis))
    if diagnosis.ranking:
        yield explanations_table(diagnosis)
    yield from _rivals(diagnosis, drawn)
    of_interest = _names_of_interest(diagnosis)
    yield from _said(prose(text) for text in diagnosis.inseparable if any(name in text for name in of_interest))
    yield from _said(_sight(diagnosis))
    yield Fold("What this record could show", tuple(_sight_table(diagnosis)))
    yield Fold("Statistics: how the explanations compare", tuple(statistics.of_explanations(diagnosis, drawn)))


def _rivals(diagnosis: DiagnosisResult, drawn: Figures) -> Iterator[BlockView]:
    """Draw where the explanations that are left part."""
    parting = parting_of(diagnosis)
    if parting is not None:
        title = f"How far the explanations are apart in {spoken(parting.result)}"
        caption = f"{title}: dots on this record, diamonds at the readings that are proposed. Inside of the grey band, "
        caption += "the scatter of the readings, two cannot be told apart by one reading."
        yield drawn.view(title, partial(rivals_apart, diagnosis, parting), caption)


def _verdict_text(diagnosis: DiagnosisResult) -> str:
    explanations = explanations_of(diagnosis)
    if not explanations:
        return say("nothing needed") if diagnosis.verdict == "none" else say("open", reasons=reasons(diagnosis))
    if diagnosis.verdict == "one_of":
        return say("one of", count=len(explanations))
    parts = [spoken(cause.effect) for cause in diagnosis.causes]
    if diagnosis.remainder is not None:
        parts.append(f"something unregistered ({prose(diagnosis.remainder.shape)})")
    causes, explain = listed(parts), "explains" if len(parts) == 1 else "together explain"
    kinds = {"named": "explains it alone", "undecided": "explains it perhaps"}
    return say(kinds.get(diagnosis.verdict, "explains it"), causes=causes, explain=explain)


def _named(diagnosis: DiagnosisResult) -> Iterator[BlockView]:
    """Say what the named causes are, what draws the same curve, what to do, and of several the shares."""
    rows = [
        (spoken(cause.effect), about_of(diagnosis, cause.effect) or ABSENT, percent(cause.share))
        for cause in diagnosis.causes
    ]
    if len(rows) > 1:
        shares = ", ".join(f"{name} {share}" for name, _, share in rows)
        yield from _said([say("of the correction", shares=shares)])
    for cause in diagnosis.causes:
        if cause.same_as:
            others = listed([spoken(name) for name in cause.same_as])
            yield from _said([say("same curve", others=others, cause=spoken(cause.effect))])
        if remedy := stated_remedy(diagnosis, cause.effect):
            yield from _said([say("what to do", cause=spoken(cause.effect), remedy=prose(remedy))])
    shown = slice(None) if len(rows) > 1 else slice(-1)
    yield table_of("Named", ("Cause", "What it is", "Share")[shown], [row[shown] for row in rows], (2,))


def _near(diagnosis: DiagnosisResult) -> Iterator[str]:
    """Say which explanations are not excluded, and which is the next behind them: none that adds to the named one."""
    named = {cause.effect for cause in diagnosis.causes}
    yield from (say("cannot be ruled out", explanation=explanation(each)) for each in diagnosis.alternatives)
    if not explanations_of(diagnosis):
        return
    behind = [
        alternative
        for alternative in diagnosis.ranking
        if alternative.causes and alternative.behind > 0 and not figures.is_open(alternative, diagnosis)
        if alternative.separation >= WEAK and not (named and named <= set(alternative.causes))
    ]
    yield from (say("next best", explanation=explanation(each)) for each in behind[:1])


def explanations_table(diagnosis: DiagnosisResult) -> TableView:
    """Say the explanations that were compared, and what this record makes of each."""
    rows = [
        (explanation(each), sentence(statistics.judged(each, diagnosis)).rstrip("."))
        for each in figures.shown_ranking(diagnosis)
    ]
    return table_of("Explanations, best first", ("Explanation", "On this record"), rows)


def _names_of_interest(diagnosis: DiagnosisResult) -> set[str]:
    """Return the causes that are named or open, and the covariates: what is said of others stays folded."""
    return {*_open_names(diagnosis), *diagnosis.records.covariates}


def _open_names(diagnosis: DiagnosisResult) -> set[str]:
    """Return every cause that is named or still open."""
    return {name for names in explanations_of(diagnosis) for name in names}


# What the record can show


def _merged(seen: Iterable[VisibleSize]) -> list[VisibleSize]:
    """Take the two parts of a wave together: it is noticed for sure where the one is that shows less."""
    merged: dict[str, VisibleSize] = {}
    for size in seen:
        effect, _, unknown = size.name.partition(".")
        key = f"{effect}.{sight_name(size.name)}" if partner_of(unknown) else size.name
        other = merged.get(key)
        if other is None or _smallest(size) > _smallest(other):
            merged[key] = size
    return list(merged.values())


def _smallest(size: VisibleSize) -> float:
    return inf if size.smallest is None else size.smallest.value


SIGHTS = {
    "not excited": "could not be seen", "hidden in the tolerances": "could be hidden",
    "cannot be fitted": "could not be tried",
}  # fmt: skip


def _sight(diagnosis: DiagnosisResult) -> Iterator[str]:
    """Say in a sentence each which causes the record cannot show, and how small others would have been noticed."""
    named = _open_names(diagnosis)
    unseen: dict[str, list[str]] = {}
    visible: list[str] = []
    for size in _merged(diagnosis.seen):
        name, smallest = sight_name(size.name), amount_text(readable(size.smallest))
        if size.name.partition(".")[0] in named:
            continue
        if size.sight in SIGHTS:
            up_to = f" (noticed above {smallest})" if size.sight == "hidden in the tolerances" and size.smallest else ""
            unseen.setdefault(size.sight, []).append(name + up_to)
        elif size.smallest is not None:
            visible.append(f"{name} from {smallest}")
    yield from (say(SIGHTS[sight], causes=_some(names)) for sight, names in unseen.items())
    lacking = [f"{spoken(name)} ({listed([spoken(need) for need in needs])})"
               for name, needs in diagnosis.not_measured.items()]  # fmt: skip
    if lacking:
        yield say("was not measured", causes=_some(lacking))
    if visible:
        yield say("would have been seen", causes=_some(visible))


def _sight_table(diagnosis: DiagnosisResult) -> Iterator[BlockView]:
    """Say of every effect what this record could show of it, then which pairs it could not have told apart."""
    named = _open_names(diagnosis)
    rows = []
    for size in _merged(diagnosis.seen):
        words = "named here" if size.name.partition(".")[0] in named else _sight_kind(size)
        said = say(words, size=amount_text(readable(size.smallest)), why=size.text)
        rows.append((sight_name(size.name), sentence(said)))
    for effect, needs in diagnosis.not_measured.items():
        said = say("no column", conditions=listed([spoken(need) for need in needs]))
        rows.append((spoken(effect), sentence(said)))
    yield table_of("", ("Effect", "In this record"), rows)
    yield from _said(map(prose, diagnosis.inseparable))


def _sight_kind(size: VisibleSize) -> str:
    kinds = {"not excited": "not brought out", "cannot be fitted": "cannot be fitted"}
    is_hidden = size.sight == "hidden in the tolerances"
    if size.smallest is None:
        return kinds.get(size.sight, "tolerances hide")
    return kinds.get(size.sight, "tolerances could hide" if is_hidden else "would be noticed")


def _some(texts: Sequence[str]) -> str:
    return "; ".join(texts[:MOST_SEEN]) + (f"; and {len(texts) - MOST_SEEN} more" if len(texts) > MOST_SEEN else "")


# What is left


def _left(diagnosis: DiagnosisResult, drawn: Figures) -> Iterator[BlockView]:
    """Draw what is left: over what carries something, in the order of time, and beside normal scatter."""
    for curves in figures.shown_curves(diagnosis):
        name = spoken(curves.result)
        when = ", before and after" if figures.has_changed(curves) else ""
        thinned = figures.thinning_words(diagnosis, curves)
        for covariate in figures.carrying_covariates(diagnosis, curves):
            title = f"Differences of {name} over {spoken(covariate.name)}{when}"
            caption = f"{title}. The grey band is the scatter of the readings.{thinned}"
            yield drawn.view(title, partial(figures.over_covariate, diagnosis, curves, covariate), caption)
        title = f"What is left of {name}: in order, and sorted beside normal scatter"
        caption = f"{title}. A course on the left means that something is missing; points far off the line on the "
        caption += f"right are readings to look at.{thinned}"
        yield drawn.view(title, partial(figures.what_is_left, diagnosis, curves), caption)


# Extended model


def _model(diagnosis: DiagnosisResult) -> Iterator[BlockView]:
    yield from _said(_sizes(diagnosis))
    fitted = fitted_table(diagnosis)
    if fitted.rows:
        yield fitted
    name, remainder = diagnosis.setup.model.name, diagnosis.remainder
    if diagnosis.causes or diagnosis.calibrated:
        yield from _said([say("use it", file=EVERYTHING, model=name)])
    if remainder is not None:
        yield from _said([say("not in a file", shape=prose(remainder.shape))])
    if diagnosis.calibrated:
        heads = ("Input", "Nominal", "Fitted", "Within its tolerance", "Moved, standard deviations")
        table = table_of("Inputs as fitted", heads, list(_calibrated(diagnosis)), (1, 2, 4))
        yield Fold("Inputs as fitted to this machine", (table,))


def _sizes(diagnosis: DiagnosisResult) -> Iterator[str]:
    if not diagnosis.causes:
        yield say("nothing named")
    for cause in diagnosis.causes:
        sizes = sizes_text(cause.unknowns, cause.covariance)
        yield say("size", cause=spoken(cause.effect), sizes=sizes) if sizes else cause_text(cause)
    for alternative in diagnosis.alternatives:
        sizes = "; ".join(sizes_text(unknowns) for unknowns in alternative.unknowns.values() if unknowns)
        if sizes:
            yield say("or size", explanation=explanation(alternative), sizes=sizes)
    far = [calibrated for calibrated in diagnosis.calibrated if abs(calibrated.of_its_sd) >= MOVED]
    moved = lowest_first(far, lambda calibrated: -abs(calibrated.of_its_sd))[:MOST_MOVED]
    if moved:
        shifts = [f"{spoken(each.name)} ({_how_far(each.of_its_sd)})" for each in moved]
        yield say("moved most", inputs=listed(shifts))


def _how_far(of_its_sd: float) -> str:
    """Say how far inside of its tolerance an input was fitted."""
    ends = ((0.7, "well inside"), (2.0, "inside"), (3.0, "at the edge"))
    return say(next((words for end, words in ends if abs(of_its_sd) <= end), "outside"))


def fitted_table(diagnosis: DiagnosisResult) -> TableView:
    """Say the size of every cause that is named, with its interval; a wave by amplitude and phase."""
    fitted = [
        (spoken(cause.effect), unknown)
        for cause in diagnosis.causes
        for unknown in as_waves(cause.unknowns, cause.covariance)
    ]
    rows = [row for name, unknown in fitted for row in _fitted(name, unknown)]
    return table_of("Unknowns as fitted", HEADS, rows, (2, 3), "Intervals hold if the named cause is the true one.")


def _fitted(cause: str, unknown: FittedUnknown) -> Iterator[tuple[str, ...]]:
    """Write an unknown as rows: one, or one for each file where every file has its own."""
    labels = dict(zip(unknown.per_file, file_labels(list(unknown.per_file)), strict=True))
    fits = {f", {labels[file]}": fit for file, fit in unknown.per_file.items()}
    for suffix, fit in (fits or {"": (unknown.value, unknown.low, unknown.high)}).items():
        value, low, high, unit = number_texts(unknown, fit)
        yield cause, unknown.name.replace("_", " ") + suffix, value, f"{low} … {high}", unit or ABSENT


def _calibrated(diagnosis: DiagnosisResult) -> Iterator[tuple[str, ...]]:
    for calibrated in diagnosis.calibrated:
        nominal, size = float(diagnosis.setup.nominal(calibrated.name)), Amount(calibrated.value, calibrated.unit)
        fitted = amount_text(size, FITTED_DIGITS) if nominal else amount_text(readable(size))
        stated = amount_text(Amount(nominal, calibrated.unit), STATED_DIGITS)
        yield spoken(calibrated.name), stated, fitted, _how_far(calibrated.of_its_sd), score_text(calibrated.of_its_sd)


# Gain


def _gain(diagnosis: DiagnosisResult, drawn: Figures) -> Iterator[BlockView]:
    if not diagnosis.gain:
        yield from _said([say("no estimate")])
        return
    rows = []
    for gain in diagnosis.gain:
        before, after = amount_text(gain.rmse_before), amount_text(gain.rmse_after)
        rows.append((spoken(gain.result), before, after, amount_text(gain.noise_floor)))
        text = gain_text(diagnosis, gain)
        yield from _said([text or say("stays", result=spoken(gain.result), after=after)])
        yield from _said(held_out_words(diagnosis, gain, alone=False))
    if diagnosis.causes:
        yield from _said([say("same in parts", often=often(diagnosis.stability))])
    heads = ("Result", "Before", "After", "Scatter of the readings")
    note = "Root mean squares on rows that were not fitted: parts of the record judge what the others say."
    yield table_of("What the extension is worth", heads, rows, (1, 2, 3), note)
    title = "Error before and after, and the scatter of the readings"
    yield drawn.view(title, partial(figures.gain_bars, diagnosis), f"{title}, on rows that were not fitted.")
    yield Fold("Statistics: the gain", tuple(statistics.of_gain(diagnosis)))


# Next measurement


def _next(diagnosis: DiagnosisResult) -> Iterator[BlockView]:
    """Write the further results and the experiment, with its readings as a table to be taken to the machine."""
    ways = [_results, _experiment]
    for way in ways if is_result_first(diagnosis) else reversed(ways):
        yield from way(diagnosis)
    yield from _said(map(tie_text, diagnosis.ties))
    if not diagnosis.next and not diagnosis.ties:
        kind = "nothing open" if diagnosis.unique else "no setting"
        yield from _said([say("nothing to separate" if diagnosis.verdict == "named" else kind)])
    if diagnosis.next:
        yield Fold("Statistics: the proposal", tuple(statistics.of_proposal(diagnosis)))


def _results(diagnosis: DiagnosisResult) -> Iterator[BlockView]:
    for point in (point for point in diagnosis.next if point.measure):
        yield from _said([result_text(point), prose(point.why)])


def _experiment(diagnosis: DiagnosisResult) -> Iterator[BlockView]:
    experiment, readings = diagnosis.experiment, [point for point in diagnosis.next if not point.measure]
    if experiment is None or not readings:
        return
    longest: NextPoint = max(readings, key=lambda point: len(point.why))
    yield from _said([experiment_text(experiment), prose(longest.why)])
    yield statistics.readings_table(experiment)
