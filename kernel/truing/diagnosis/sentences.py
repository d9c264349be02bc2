"""Every kind of sentence that a diagnosis says without being asked for its statistics, and what each means.

``say`` writes one. The manual lists them; the tests hold every sentence of a sheet and of the terminal against this
table. What stands in braces is filled in: names, sizes, lists.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Final


@dataclass(frozen=True)
class Kind:
    """One kind of sentence: its text with gaps, and what a reader should take from it."""

    text: str
    meaning: str


VERDICT: Final[Mapping[str, Kind]] = {
    "meets": Kind(
        "within its tolerances the model meets the measurement: {met}",
        "Nothing is wrong that this record can show. Parts may differ from the drawing as their tolerances allow.",
    ),
    "met to": Kind(
        "{result} to {error} (its readings scatter by {scatter})",
        "How far model and measurement are apart, root mean square, beside the scatter of single readings. Where the "
        "two are alike, nothing is left to be explained.",
    ),
    "only scatter": Kind(
        "what is left is scatter of the readings; no cause, registered or not, is needed",
        "The verdict that there is no cause to be looked for.",
    ),
    "not sure of nothing": Kind(
        "no cause is named, but that nothing is wrong cannot be said either: {reasons}",
        "The record is too short, or something in it is odd, but no cause stands out.",
    ),
    "as it is": Kind("the model as it is meets {met}", "The errors without any cause."),
    "blind": Kind(
        "that says nothing of {causes}: nothing in this record brings {them} out",
        "Such a cause may be there and could not have been seen: what it follows did not change.",
    ),
    "more readings": Kind(
        "more readings, of a wider range and in a changed order, would decide", "What to do about an open verdict."
    ),
    "cause": Kind(
        "what the model misses in {results}: {causes}",
        "The named cause with its fitted size. In brackets the range in which the true size lies in 95 of 100 such "
        "records, if the cause is the right one.",
    ),
    "means": Kind("{cause} means: {text}", "What a cause is, in the words of its author, where it is named first."),
    "drawn alike": Kind(
        "what the model misses in {results} is drawn alike by {explanations}",
        "Each of these fits as well as the others, or nearly. The record cannot say which is the right one.",
    ),
    "taken as first": Kind(
        "taken as the first of them: {causes}", "The size that the first of several explanations would have."
    ),
    "best in doubt": Kind(
        "what the model misses in {results} is drawn best by {causes}; that {this} is in doubt",
        "One explanation fits best, but a warning speaks against it. Read the warning first.",
    ),
    "in all of them": Kind(
        "{causes} {are} in {all} of them", "So much is sure, although the whole explanation is open."
    ),
    "as well": Kind(
        "whether {causes} is there as well, this record cannot say",
        "The first cause is sure; a second one may stand beside it.",
    ),
    "unregistered": Kind(
        "{something} that no registered cause explains is in {results}, over {covariates}: {shape}",
        "There is a pattern, but nobody registered a cause that draws it. Its shape says where to look.",
    ),
    "chance": Kind(
        "chance alone would give differences like these in {records}, all causes tried counted",
        "How sure it is that anything is wrong at all; not how sure a cause is. All causes that were tried are paid "
        "for.",
    ),
    "chance of another": Kind(
        "chance alone would make {causes} together look needed in {records}",
        "How sure it is that one cause less does not do.",
    ),
    "chance not known": Kind(
        "how often chance alone would give this was not tested", "The simulation that tells it was switched off."
    ),
}

WRONG: Final[Mapping[str, Kind]] = {
    "is off": Kind(
        "{result} is off by {error} after calibration within the tolerances; its readings scatter by {scatter}",
        "The error of the calibrated model, root mean square. It is larger than the scatter of the readings, so "
        "something can be explained.",
    ),
    "is met": Kind(
        "{result} is met to {error}; its readings scatter by {scatter}",
        "The model is as good as the readings can tell.",
    ),
    "no pattern": Kind(
        "the differences show no pattern that is more than chance",
        "No drift, step, wave, bend or change of scatter was noticed.",
    ),
    "bias": Kind("on average {size} off the nominal model, {allowed}", "A constant difference to the model as drawn."),
    "bias allowed": Kind(
        "within what the tolerances allow, {spread} either way",
        "Parts within their tolerances give as much; calibration takes it away.",
    ),
    "bias too large": Kind("more than the tolerances allow", "Parts within their tolerances do not explain it."),
    "bias alone": Kind("and no tolerance allows for it", "No tolerance in force moves this result."),
    "order": Kind("order {order} of {covariate}, amplitude {size}", "So many waves in one turn."),
    "step": Kind("step of {size} at {place}", "From here on all readings lie higher or lower."),
    "wave": Kind("one wave per {length}, amplitude {size}", "A regular wave."),
    "settling": Kind("settles with a time constant of {length}, by {size}", "Falls or rises quickly first, then less."),
    "jump": Kind(
        "jumps by {size} where {covariate} changes its sign", "Typical of play: what is lifted lies on the other side."
    ),
    "kink": Kind("has a kink where {covariate} changes its sign, range {size}", "Stiffer one way than the other."),
    "dead zone": Kind("a dead zone of ±{length}, range {size}", "Nothing moves within it; typical of lost motion."),
    "product": Kind("depends on {covariates} together, range {size}", "How much one matters depends on the other."),
    "rises": Kind("{rises} with {covariate}, by {size} over the record", "A trend one way."),
    "curved": Kind("curved over {covariate}, {lowest} at {place}, range {size}", "A bend with a turning point."),
    "patterns": Kind(
        "each pattern was looked at alone; one cause can draw several of them",
        "A pattern that a named cause draws needs no explanation of its own.",
    ),
    "follows": Kind("depends on {covariate}, if {cause} is the cause", "What the named cause follows."),
    "spread": Kind("the scatter {grows} with {covariate}", "Readings are less sure at one end of the range."),
    "alike": Kind(
        "neighbouring readings are alike",
        "The scatter wanders slowly. It is taken into account: such readings count less than independent ones.",
    ),
    "outliers": Kind("{rows} far outside of the scatter: {places}", "Look at these rows; nothing was removed."),
    "wave left": Kind(
        "{count} waves over the range of {covariate}, with {share} of what is left after all",
        "After the named causes a wave remains.",
    ),
}

CAUSE: Final[Mapping[str, Kind]] = {
    "explains it": Kind("{causes} {explain} it", "The verdict: one cause, or causes that act together."),
    "explains it alone": Kind(
        "{causes} {explain} it; no other registered cause comes near", "The verdict where it is unique."
    ),
    "one of": Kind(
        "one of {count} explanations, which this record does not tell apart", "The verdict where it is open."
    ),
    "explains it perhaps": Kind("{causes} {explain} it best; it is in doubt", "The verdict where a warning speaks."),
    "nothing needed": Kind("nothing has to be explained", "The verdict where nothing is wrong."),
    "open": Kind("open: {reasons}", "The verdict where neither can be said."),
    "of the correction": Kind(
        "of what the causes add to the model: {shares}", "How large a part each of several causes has."
    ),
    "same curve": Kind(
        "{others} would draw the same curve as {cause} on this record",
        "Another name for the same thing here. Only a fact from elsewhere, or another record, tells them apart.",
    ),
    "what to do": Kind("what to do about {cause}: {remedy}", "The remedy that the author of the cause wrote down."),
    "cannot be ruled out": Kind("almost as good; cannot be ruled out: {explanation}", "A rival that is still open."),
    "next best": Kind("next best, and ruled out: {explanation}", "The nearest rival that the record excludes."),
    "best": Kind("explains it best", "Of all that were compared."),
    "is open": Kind("almost as good; cannot be ruled out", "The difference could be chance."),
    "adds nothing": Kind("the best one with a cause more that explains nothing more", "What is added is not needed."),
    "needs more": Kind("explains as much with more free numbers", "The simpler one is taken."),
    "ruled out": Kind("ruled out: explains clearly less", "The difference cannot be chance."),
    "not distinguished": Kind(
        "{one} and {other} draw the same curve on this data: nothing in it tells them apart",
        "Whatever their size, this record cannot tell the two apart.",
    ),
    "hardly distinguished": Kind(
        "{one} and {other} draw nearly the same curve on this data: only much larger effects than usual could be told "
        "apart",
        "The record tells the two apart only where they are large.",
    ),
    "moved together": Kind(
        "{one} and {other} move together in this record: what follows one cannot be told from what follows the other",
        "Vary one of them alone in the next record.",
    ),
    "never changed sign": Kind(
        "{covariate} never changed its sign: what jumps with the sign looks like a constant here",
        "Play and dry friction cannot be seen in such a record.",
    ),
}

SIGHT: Final[Mapping[str, Kind]] = {
    "would be noticed": Kind(
        "it would be noticed above {size}", "From this size on it is found in 9 of 10 such records."
    ),
    "tolerances could hide": Kind(
        "tolerances could hide this; it would be noticed above {size}",
        "Up to this size the calibration of toleranced inputs can take it up.",
    ),
    "tolerances hide": Kind("tolerances could hide this, whatever its size", "State a tolerance narrower if you can."),
    "not brought out": Kind("nothing in this record brings it out", "What it depends on did not change."),
    "cannot be fitted": Kind("it could not be tried: {why}", "The model fails with it on."),
    "no column": Kind("not measured: no column gives {conditions}", "Measure this, and it can be seen."),
    "named here": Kind("named above", "The cause itself."),
    "could not be seen": Kind("nothing in this record brings out {causes}", "These causes were not tested."),
    "could be hidden": Kind("tolerances could hide {causes}", "These may be there up to the size that is said."),
    "could not be tried": Kind("could not be tried: {causes}", "The model fails with these on."),
    "was not measured": Kind("not measured, so not seen: {causes}", "No column of the record gives what they need."),
    "would have been seen": Kind("would have been noticed: {causes}", "Larger than that they are not there."),
}

MODEL: Final[Mapping[str, Kind]] = {
    "nothing named": Kind("nothing was named: the model stands as it is", "There is nothing to be added to the model."),
    "size": Kind("{cause}: {sizes}", "The cause and its fitted numbers."),
    "or size": Kind("or {explanation}: {sizes}", "The numbers that a rival would have."),
    "moved most": Kind(
        "within their tolerances moved most: {inputs}", "Which parts of this machine are most likely off nominal."
    ),
    "well inside": Kind("well inside", "By less than half of what two machines usually differ."),
    "inside": Kind("inside", "By about as much as machines usually differ."),
    "at the edge": Kind("near the edge", "As few machines are; measure the part."),
    "outside": Kind("outside", "Hardly a machine is there: the tolerance, or something else, is wrong."),
    "use it": Kind(
        "all of it is in {file}, which every verb accepts: calc run {model} --inputs {file}", "How to go on with it."
    ),
    "not in a file": Kind(
        "what no registered cause explains ({shape}) is in no inputs file. new_effect.py holds its fitted shape as an "
        "effect, ready to be made physical. Do not extrapolate it beyond the measured range",
        "How an unknown cause becomes one that is registered.",
    ),
}

GAIN: Final[Mapping[str, Kind]] = {
    "falls": Kind(
        "on rows that were not fitted the error of {result} falls from {before} to {after} (its readings scatter by "
        "{scatter})",
        "What the cause is worth where it had to predict.",
    ),
    "falls perhaps": Kind(
        "on rows that were not fitted the error of {result} falls from {before} to {after}; in so few independent "
        "blocks that may be chance",
        "A large gain, but of too few rows to be sure of.",
    ),
    "stays": Kind(
        "on rows that were not fitted the error of {result} stays at {after}", "The cause changes nothing here."
    ),
    "no gain": Kind(
        "on rows that were not fitted there is no gain that could not be chance", "The cause predicts nothing for sure."
    ),
    "falls held out": Kind(
        "on the rows held out the error of {result} falls from {before} to {after}",
        "Rows that were marked as judges and took no part in anything.",
    ),
    "grows held out": Kind(
        "on the rows held out the error of {result} GROWS from {before} to {after}: the extension does not carry over "
        "to them",
        "The cause fits its own rows and fails on the judges. Do not trust it.",
    ),
    "no estimate": Kind("no gain was estimated", "There was nothing to be compared."),
    "same in parts": Kind(
        "diagnosed without one part at a time, the record says the same {often}",
        "How steady the verdict is.",
    ),
}

NEXT: Final[Mapping[str, Kind]] = {
    "measure as well": Kind(
        "measure {results} as well: that separates {one} from {other}", "A further result decides."
    ),
    "experiment": Kind(
        "{course}: {readings} tell {explanations} apart with a chance of {chance}",
        "The readings to take next, and how often they would name the right one.",
    ),
    "experiment needs more": Kind(
        "{course}: {readings} tell {explanations} apart with a chance of {chance}; {enough} like these would be needed "
        "for 95 %",
        "The same where the budget is too small for certainty.",
    ),
    "differ by": Kind("{one} and {other} there differ by {size} in {result}", "Why to measure there."),
    "differ beyond": Kind(
        "{one} and {other} there differ by {size} in {result}; {covariate} was only {low} to {high} so far",
        "Why to measure beyond the range that was measured.",
    ),
    "differ in": Kind(
        "measure {result}, too: {one} and {other} differ by {size} in it", "Why to measure a further result."
    ),
    "differ more than machines": Kind(
        "measure {result}, too: {one} and {other} differ by {size} in it, machines within their "
        "tolerances by {scatter}",
        "The same, beside what the tolerances do.",
    ),
    "beyond": Kind(
        "that goes beyond what was measured so far: {settings}; check first that the machine permits it",
        "Settings outside of the range of the record, beside that range.",
    ),
    "bring first": Kind(
        "before that, bring {settings}",
        "What follows from the work of the machine cannot be set. Let the machine get there, as a warm one cools down: "
        "the experiment begins elsewhere than the record ended.",
    ),
    "left open": Kind(
        "nothing that is proposed here settles {explanations}", "For these another record, or a check of the gauge."
    ),
    "fact decides": Kind(
        "no setting tells {explanations} apart; a measurement of another quantity does: {facts}",
        "Measure the part, or look it up.",
    ),
    "fact": Kind(
        "{quantity} to ±{accuracy} ({size} if it is {explanation})",
        "What to measure, how well at the least, and what it then is.",
    ),
    "nothing decides": Kind(
        "no measurement proposed here tells {explanations} apart: for this machine they stay one",
        "What they say of the machine is too alike to be measured by other means, too.",
    ),
    "nothing to separate": Kind(
        "no other explanation comes near; there is nothing left to separate", "No further reading is needed for this."
    ),
    "nothing open": Kind("nothing has to be told apart", "No further reading is needed for the verdict."),
    "no proposal": Kind(
        "no setting can be proposed that tells them apart; another record, of other conditions, may",
        "The search for an experiment had no result.",
    ),
    "no setting": Kind("no setting is proposed", "Nothing was found to be measured next."),
}

WARNING: Final[Mapping[str, Kind]] = {
    "at bound": Kind(
        "{unknown} was fitted at the bound declared for it ({size}): a wrong cause often ends there; look at what else "
        "could draw this curve, and widen the range if the machine allows more",
        "The fit wanted to go further than the author of the cause thought possible.",
    ),
    "input moved": Kind(
        "{input} had to move {times} times as far as its tolerance makes usual to meet the measurement: its tolerance "
        "is stated too narrow, or something else is wrong; measure it",
        "In units of the standard deviation of the tolerance.",
    ),
    "held out grows": Kind(
        "on the rows held out the error of {result} grows from {before} to {after}: the extension does not carry over "
        "to them; look at what is different there",
        "The judges say no.",
    ),
    "all grow": Kind(
        "on rows that were not fitted the error of {result} grows from {before} to {after}: the cause draws this "
        "record and predicts nothing; measure more rows",
        "The cause is of no use for prediction.",
    ),
    "unsteady": Kind(
        "diagnosed without one part at a time, the record names the same causes {often}: parts of it say something "
        "else; look at the other explanations, and measure more rows",
        "The verdict rests on some of the rows.",
    ),
    "halves": Kind(
        "{unknown} is {first} in one half of the rows and {second} in the other: the two contradict one another; look "
        "at what changed between them",
        "One size should do for all rows.",
    ),
    "other on half": Kind(
        "on {rows}, {explanation} explains more: rows that should say the same do not; look at what alternates between "
        "them, and measure more rows",
        "Half of the rows prefer another cause.",
    ),
    "stand in": Kind(
        "{unknown} and {input} can stand for one another: {input}, off by what its tolerance allows, draws nearly the "
        "same; measure {input}, or state its tolerance narrower if it is known better",
        "The cause may be a part that is off, and the other way round.",
    ),
    "too good": Kind(
        "what is left of {result}, {left}, is far below the scatter stated for it, {stated}: the causes follow the "
        "noise, or it is smaller than stated; read some settings again to see how far readings scatter",
        "Better than the gauge can be.",
    ),
    "wanders": Kind(
        "the scatter of {result} wanders slowly, which draws any slow effect: something that changes over time is "
        "unexplained; measure again, in a changed order",
        "A slow cause cannot be told from such a wander.",
    ),
    "waves": Kind(
        "in what is left of {result} there are {waves}: something more is at work", "The causes do not explain all."
    ),
    "rough": Kind(
        "the model's {result} jumps or scatters by itself by up to {size}: derivatives are taken over wide steps, and "
        "no effect much smaller is seen",
        "The calculation is not smooth; small effects drown in it.",
    ),
    "fails with": Kind(
        "the model fails with {cause} at {share} of the points tried ({lost} of {tried}); sizes and shapes there are "
        "left out",
        "The calculation does not run with large sizes of this cause.",
    ),
    "too rough": Kind(
        "the model's {result} jumps or scatters by up to {size} by itself, which is most of what is left of the "
        "readings: this may be what is wrong; make it finer",
        "The calculation's own steps are as large as the error.",
    ),
}

DOUBT: Final[Mapping[str, Kind]] = {
    "too few": Kind("{count} readings that differ are too few to tell a cause from chance", "Take twenty or more."),
    "nearly": Kind(
        "chance alone would give the best explanation{named} in {records}",
        "Too often to call it a cause, too seldom to call it nothing.",
    ),
    "not tested": Kind("whether anything is wrong was not tested", "The simulation that tells it was switched off."),
    "no mere scatter": Kind(
        "the differences of {result} are no mere scatter: {pattern}", "A pattern was noticed that no cause explains."
    ),
}

CHAPTERS: Final[Mapping[str, Mapping[str, Kind]]] = {
    "The verdict": VERDICT,
    "What is wrong": WRONG,
    "The cause": CAUSE,
    "What the record can show": SIGHT,
    "The extended model": MODEL,
    "What it is worth": GAIN,
    "What to measure next": NEXT,
    "Warnings": WARNING,
    "Why a verdict stays open": DOUBT,
}
SENTENCES: Final[Mapping[str, Kind]] = {name: kind for kinds in CHAPTERS.values() for name, kind in kinds.items()}


def say(kind: str, /, **words: object) -> str:
    """Write a sentence of a kind, its gaps filled; without a capital and a full stop. Raises KeyError."""
    return SENTENCES[kind].text.format(**words)


def sentence(text: str) -> str:
    """Give words a capital and a full stop."""
    words = text.strip().rstrip(".")
    return f"{words[:1].upper()}{words[1:]}."


def kind_of(text: str) -> str:
    """Return the kind of a sentence: of those whose words stand in it the one that leaves least open; else nothing."""
    plain = text.strip().rstrip(".")
    fitting = [name for name, pattern in _patterns().items() if pattern.fullmatch(plain)]
    return max(fitting, key=lambda name: len(re.sub(r"{\w+}", "", SENTENCES[name].text)), default="")


@cache
def _patterns() -> Mapping[str, re.Pattern[str]]:
    patterns = {}
    for name, kind in SENTENCES.items():
        parts = [re.escape(part) for part in re.split(r"{\w+}", kind.text)]
        patterns[name] = re.compile("(.+?)".join(parts), re.IGNORECASE | re.DOTALL)
    return patterns


RARE: Final = 0.1


def records_words(p_value: float) -> str:
    """Say how often chance alone gives something: 1 of 300 records, never rarer than the p-value allows."""
    if p_value >= 0.5:
        return "most records"
    if p_value >= RARE:
        return f"about {10 * p_value:.0f} of 10 records"
    if p_value <= 0.001:
        return "fewer than 1 of 1,000 records"
    times = 1 / p_value
    if times < 100:
        return f"about 1 of {math.floor(times)} records"
    return f"fewer than 1 of {math.floor(times / 100 + 1e-9) * 100:,} records"
