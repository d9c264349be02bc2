"""One rule gives the verdict: over made states of a diagnosis, nothing that is printed contradicts what was found."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import hypothesis.strategies as st
import numpy as np
import pytest
from diagnosis_samples import (
    CALIBRATED,
    DRIFTING,
    HEATING,
    REMAINDER,
    SAMPLES,
    TIE,
    ambiguous,
    gain_of,
    named,
    none_found,
)
from hypothesis import HealthCheck, given, settings

from truing.cli.diagnose import lines_of as report
from truing.diagnosis.noise import SETTINGS
from truing.diagnosis.result import (
    Alternative,
    Amount,
    Cause,
    Contradiction,
    DiagnosisResult,
    ResidualFinding,
    Thinned,
    Trade,
    doubts,
    shared_of,
)
from truing.report.chapters import Figures
from truing.report.diagnosis_sheet import diagnosis_chapters
from truing.report.diagnosis_words import headline, prose, spoken, together, verdict_word
from truing.report.document import Paragraph, TableView
from truing.runs.diagnosis_document import diagnosis_document
from truing.runs.index import _of_diagnosis

FINDINGS = {
    "allowed": ResidualFinding("bias", "", None, "on average 3 um off the nominal model", is_allowed=True),
    "bias": ResidualFinding("bias", "", None, "on average 30 um off the nominal model, more than the tolerances allow"),
    "wave": ResidualFinding(
        "wave", "crank_angle", 1e-4, "12 waves over the range of crank_angle, with 31 % of what is left"
    ),
    "trend": ResidualFinding("trend", "load", 0.03, "rises with load, by 3 um over the record"),
    "spread": ResidualFinding("spread", "load", 0.001, "the scatter grows with load"),
    "alike": ResidualFinding("autocorrelation", "", None, "neighbouring rows are alike (autocorrelation 0.6)"),
    "far": ResidualFinding("outlier", "", None, "1 suspected outlier, beyond four standard deviations of the noise"),
}
HARMLESS = {"allowed", "spread", "alike", "far"}
CAUSES = {
    "rod_heating": HEATING,
    "joint_play": Cause("joint_play", (replace(HEATING.unknowns[0], name="clearance", unit="um"),)),
    "input:rod": Cause("input:rod", (replace(HEATING.unknowns[0], name="rod", value=0.32, unit="mm"),)),
}
RIVALS = [
    DRIFTING, Alternative(("unknown",), 3.0, 2.0, ("time",)), Alternative(("rod_heating", "step"), 1.0, 0.3),
    Alternative(("step",), 2.0, 1.0, same_as={"step": ("sensor_drift", "wear")}),
    Alternative(("wear", "unknown"), 1.0, 0.3, REMAINDER.depends_on),
]  # fmt: skip
APART = Contradiction("rod_heating", "expansion", Amount(8e-6, "um/(m*K)"), Amount(15e-6, "um/(m*K)"))
POINT = replace(ambiguous().next[0], needed=1)


class NoFigures(Figures):
    """Draws nothing: this is about words."""

    def view(self, title: str, what: Any, caption: str) -> Paragraph:
        return Paragraph(caption)


@st.composite
def states(draw: st.DrawFn) -> DiagnosisResult:
    """A diagnosis in any state of its parts."""
    made = none_found()
    causes = [CAUSES[name] for name in draw(st.lists(st.sampled_from(list(CAUSES)), unique=True, max_size=2))]
    same = [draw(st.sampled_from([(), (), ("warm_up",), ("warm_up", "sensor_offset")])) for _ in causes]
    causes = [replace(cause, same_as=names) for cause, names in zip(causes, same, strict=True)]
    remainder = draw(st.sampled_from([None, None, REMAINDER]))
    is_found = bool(causes or remainder)
    found = [FINDINGS[name] for name in draw(st.lists(st.sampled_from(list(FINDINGS)), unique=True, max_size=3))]
    noise = replace(made.wrong[0].noise, ar_coefficient=draw(st.sampled_from([0.0, 0.6, 0.87, 0.92, 0.96])))
    moved = replace(CALIBRATED[0], of_its_sd=draw(st.sampled_from([0.4, -2.9, 3.1, -7.0])))
    if draw(st.integers(0, 9)) == 0:
        records = made.records
        rows = np.arange(len(records)) < 5
        few = {name: np.where(rows, values, np.nan) for name, values in list(records.measured.items())[:1]}
        made = replace(made, records=replace(records, measured=few))
    names = [" + ".join(cause.effect for cause in causes)] if causes else []
    rivals = draw(st.lists(st.sampled_from(RIVALS), unique_by=lambda item: item.causes, max_size=3)) if is_found else []
    points = (
        replace(POINT, separates=(names[0], "sensor_drift"), needed=draw(st.sampled_from([1, 2, 3, 40])))
        if names
        else None
    )
    return replace(
        made,
        causes=tuple(causes), remainder=remainder, alternatives=tuple(rivals), calibrated=(moved,),
        wrong=(replace(made.wrong[0], findings=tuple(found), noise=noise), made.wrong[1]),
        stability=draw(st.sampled_from([1.0, 1.0, 0.6, 0.4])),
        contradictions=draw(st.sampled_from([(), (), (APART,)])) if causes else (),
        p_any=draw(st.sampled_from([0.003, 0.02] if is_found else [None, 0.003, 0.1, 0.19, 0.2, 0.5, 1.0])),
        ranking=(Alternative(tuple(cause.effect for cause in causes), 0, 0), DRIFTING),
        next=(points, points) if points is not None and rivals and draw(st.booleans()) else (),
        ties=(TIE,) if rivals and draw(st.booleans()) else (),
    )  # fmt: skip


def sheet_text(made: DiagnosisResult) -> str:
    """What the chapters of the sheet say, without their figures."""
    said = []
    for chapter in diagnosis_chapters(made, NoFigures()):
        for block in chapter.blocks:
            if isinstance(block, TableView):
                said += [block.note, *(" | ".join(row) for row in block.rows)]
            else:
                said.append(block.text)
    return "\n".join(said)


def open_names(made: DiagnosisResult) -> set[frozenset[str]]:
    """Every explanation that is left, each under all its names: worked out anew, by sets."""
    found = []
    if made.causes or made.remainder:
        own = [{cause.effect, *cause.same_as} for cause in made.causes]
        found.append([*own, {"something"}] if made.remainder else own)
    for rival in made.alternatives:
        other = ["something over " + ",".join(rival.depends_on) if each == "unknown" else each for each in rival.causes]
        found.append([{each, *rival.same_as.get(each, ())} for each in other])
    return {frozenset(names) for groups in found for names in product(*groups)}


def is_doubtful(made: DiagnosisResult) -> bool:
    """Whether something on the sheet speaks against "nothing": by the figures alone."""
    (first, _) = made.wrong
    return (
        made.records.readings < 8
        or made.p_any is None
        or made.p_any < 0.2
        or any(item not in [FINDINGS[name] for name in HARMLESS] for item in first.findings)
        or first.noise.ar_coefficient >= 0.92
        or abs(made.calibrated[0].of_its_sd) > 3
    )


def is_alarming(made: DiagnosisResult) -> bool:
    """Whether something speaks against the one explanation: by the figures alone."""
    (first, _) = made.wrong
    rho = first.noise.ar_coefficient
    return (
        rho + 2 * bool(rho and made.causes) * ((1 - rho**2) / first.rows) ** 0.5 >= 0.92
        or abs(made.calibrated[0].of_its_sd) > 3
        or made.stability < 0.5
        or bool(made.contradictions)
    )


def expected(made: DiagnosisResult) -> str:
    """The verdict that this state asks for."""
    left = open_names(made)
    if not left:
        return "undecided" if is_doubtful(made) else "none"
    if all(name.startswith("something") for names in left for name in names):
        return "unknown"
    if (len(left) == 1 or further(made, left)) and made.causes and is_alarming(made):
        return "undecided"
    return "one_of" if len(left) > 1 else "named"


def further(made: DiagnosisResult, left: set[frozenset[str]]) -> set[str]:
    """What is in some explanation beside all names of the best one, where every other one holds these."""
    own = {cause.effect for cause in made.causes}
    over = "something over " + ",".join(made.remainder.depends_on) if made.remainder else ""
    others = {names - {over, "something"} for names in left} - {frozenset(own)}
    is_whole = all(own <= names for names in others) and all(not over or {over, "something"} & names for names in left)
    return {name for names in others for name in names - own} if others and is_whole else set()


@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])
@given(states())
def test_headline_terminal_sheet_and_json_say_one_thing(made: DiagnosisResult) -> None:
    document, verdict, left = diagnosis_document(made), expected(made), open_names(made)
    said = f"{verdict_word(made)}. {' '.join(headline(made))}"
    terminal = re.sub(r"\s+", " ", "\n".join(report(made, Path("runs/x"))))
    everything = "\n".join([said, terminal, sheet_text(made), _of_diagnosis(document, "x").verdict]).lower()
    assert document["verdict"] == verdict
    assert said in terminal
    assert {frozenset(names) for names in document["explanations"]} == {
        frozenset("unknown" if name == "something" else name.replace("something over ", "unknown:") for name in names)
        for names in left
    }
    assert document["unique"] is (verdict == "none" or (len(left) == 1 and verdict != "undecided"))
    assert bool(document["undecided"]) is (verdict == "undecided")
    has_wave = FINDINGS["wave"] in made.wrong[0].findings
    assert bool(document["warnings"]) is bool(made.causes and (is_alarming(made) or has_wave))
    assert all(prose(warning).lower() in said.lower() for warning in document["warnings"])
    assert ("nothing found" in everything) is (verdict == "none")
    assert ("what is left is noise" in everything) is (verdict == "none")
    sure = ("no other explanation", "nothing left to separate", "; unique", "is unique", "cause named")
    assert verdict == "named" or not [words for words in sure if words in everything]
    _demand_all_named(made, said, document["explanations"])
    _demand_shared(document, said, terminal, sheet_text(made))
    _demand_true_proposals(made, said, everything)


def _demand_all_named(made: DiagnosisResult, said: str, explanations: Sequence[Sequence[str]]) -> None:
    """Of several explanations the headline names every one, and their number; of what may be there as well each."""
    if made.verdict == "one_of":
        assert re.match(rf"One of {len(explanations)} (causes|explanations); this record cannot say which\.", said)
        names = further(made, open_names(made))
        if names:
            assert re.search(r"[Ww]hether .+ is there as well, this record cannot say\.", said)
            assert not [name for name in names if spoken(name.replace("something over ", "unknown:")) not in said]
        else:
            assert not [names for names in explanations if together(names) not in said]


def _demand_shared(document: Mapping[str, Any], *texts: str) -> None:
    """What all of several explanations hold is said everywhere, and nothing else is said to be in them all."""
    several = [set(names) for names in document["explanations"]]
    over = ",".join((document["remainder"] or {"depends_on": ()})["depends_on"])
    several = [{"unknown" if name == f"unknown:{over}" else name for name in names} for names in several]
    shared = set.intersection(*several) if len(several) > 1 else set()
    assert set(document["shared"]) == shared
    for text in texts:
        said = re.findall(r"([\w ,]+?) (?:is|are) in (?:both|all) of them", text)
        assert len(said) >= (bool(shared) and not re.search("[Ww]hether .+ is there as well", text))
        for names in said:
            parts = re.split(r", | and ", names.strip().lower())
            assert {part.strip() for part in parts} == {spoken(name).lower() for name in shared}


def _demand_true_proposals(made: DiagnosisResult, said: str, everything: str) -> None:
    """What is said to separate passes the limit with the points there are; else their number is said."""
    if made.next:
        pair = " from ".join(spoken(name) for name in made.next[0].separates)
        suffices = made.next[0].needed <= len(made.next)
        assert (f"separates {spoken(made.next[0].separates[0])}" in everything) is False or suffices
        assert ("points together separate" in said or "it separates" in said) is suffices
        assert (f"{made.next[0].needed} points like" in said) is not suffices
        assert pair.split(" + ")[0] in said
    if made.ties:
        assert "a fact from elsewhere does" in said


@pytest.mark.parametrize("name", SAMPLES)
def test_every_sample_has_the_verdict_of_its_name(name: str) -> None:
    words = {"ambiguous": "one_of", "remainder": "named"}
    assert SAMPLES[name]().verdict == words.get(name, name)


PLAY = CAUSES["joint_play"]
STEP = Alternative(("joint_play", "step"), 2.0, 1.0)


@pytest.mark.parametrize(
    ("causes", "rivals", "shared", "words"),
    [
        ((HEATING, PLAY), (STEP,), ("joint_play",), "Joint play is in both of them."),
        ((replace(HEATING, same_as=("warm_up",)), PLAY), (STEP,), ("joint_play",), "Joint play is in all of them."),
        ((PLAY,), (STEP,), ("joint_play",), "Whether step is there as well, this record cannot say."),
        ((HEATING, PLAY), (replace(STEP, causes=("rod_heating", "joint_play", "step")),), ("rod_heating", "joint_play"),
         "Whether step is there as well, this record cannot say."),
        ((HEATING, PLAY), (STEP, DRIFTING), (), ""),
        ((HEATING, replace(PLAY, same_as=("gap",))), (STEP,), (), ""),
        ((HEATING, PLAY), (), (), ""),
        ((), (), (), ""),
    ],
)  # fmt: skip
def test_what_several_explanations_share_is_said(
    causes: Sequence[Cause], rivals: Sequence[Alternative], shared: Sequence[str], words: str
) -> None:
    """A name stands in every one of several explanations, under no other name of its curve."""
    made = replace(named(), causes=tuple(causes), alternatives=tuple(rivals))
    assert shared_of(made) == shared
    assert diagnosis_document(made)["shared"] == list(shared)
    pattern = r"in (both|all) of them|is there as well"
    said = [sentence for sentence in headline(made) if re.search(pattern, sentence)]
    assert said == ([words] if words else [])
    for text in ("\n".join(report(made, Path("runs/x"))), sheet_text(made)):
        flat = re.sub(r"\s+", " ", text).lower()
        assert words.rstrip(".").lower() in flat
        assert bool(words) is bool(re.search(pattern, flat))


(UNKNOWN,) = HEATING.unknowns
AT_END = replace(HEATING, unknowns=(replace(UNKNOWN, value=19.95e-6, low=18e-6, high=20e-6),))
FIRST, OTHER = named().wrong
GAINS = named().gain
ALARMS = {
    "expansion of rod_heating was fitted at the bound declared for it (19.9 um/(m*K)): a wrong": {"causes": (AT_END,)},
    "radius had to move by -4.0 standard deviations of its tolerance to meet the measurement": {
        "calibrated": (replace(CALIBRATED[0], of_its_sd=-4.0),),
    },
    "on the rows held out the error of slide_position grows from 40 um to 55 um": {
        "gain": (replace(GAINS[0], held_out=(40e-6, 55e-6)), GAINS[1]),
    },
    "on rows that were not fitted the error of slide_position grows from 6 um to 6.2 um": {
        "gain": gain_of(6.0e-6, 6.2e-6, 0.8),
    },
    "expansion of rod_heating is 8 um/(m*K) in one half of the rows and 15 um/(m*K) in the other": {
        "contradictions": (APART,),
    },
    "on every second row, from the first, sensor_drift explains more, by 7.5 in score": {
        "thinned": (Thinned("every second row, from the first", ("sensor_drift",), 7.5),),
    },
    "expansion of rod_heating and rod trade against one another (correlation 0.970)": {
        "trades": (Trade("rod_heating", "expansion", "rod", 0.97, 14.5),),
    },
    "what is left of slide_position, 6 um, is far below the standard deviation stated for it, 15 um": {
        "wrong": (replace(FIRST, stated=Amount(15e-6, "um")), OTHER),
    },
    "the same causes are named in 40 % of the folds only": {"stability": 0.4},
    "the noise of slide_position was taken as nearly a random walk (AR coefficient 0.92)": {
        "wrong": (replace(FIRST, noise=replace(FIRST.noise, ar_coefficient=0.92)), OTHER),
    },
}


@pytest.mark.parametrize("words", ALARMS)
def test_an_alarm_takes_the_name_and_is_said_everywhere(words: str) -> None:
    """The expansion may be 20 um/(m*K) at the most; all else is stated in the change itself."""
    assert named().warnings == ()
    made = replace(named(), **ALARMS[words])
    (warning,) = made.warnings
    document = diagnosis_document(made)
    assert warning.startswith(words)
    assert (made.verdict, made.unique, document["undecided"]) == ("undecided", False, [warning])
    assert document["causes"]
    assert prose(warning).lower() in " ".join(headline(made)).lower()
    assert "Cause in doubt" in verdict_word(made)
    assert prose(warning).lower() in sheet_text(made).lower()
    assert _of_diagnosis(document, "x").verdict.endswith("rod_heating in doubt")


@pytest.mark.parametrize(
    ("place", "rows", "is_alarm"),
    [(-1, 10_000, True), (-2, 10_000, False), (-2, 160, True), (-4, 160, False)],
    ids=["largest", "smaller", "few rows", "far off"],
)
def test_the_largest_memory_that_is_tried_is_nearly_a_random_walk(place: int, rows: int, is_alarm: bool) -> None:
    """And so is what so few rows do not tell from it, by two standard errors sqrt((1 - rho^2) / n)."""
    rho = sorted({setting.rho for setting in SETTINGS})[place]
    noise = replace(FIRST.noise, ar_coefficient=rho)
    made = replace(named(), wrong=(replace(FIRST, rows=rows, noise=noise), OTHER))
    assert bool(made.warnings) is is_alarm
    assert made.verdict == ("undecided" if is_alarm else "named")


def test_where_nothing_is_named_a_memory_below_the_largest_is_noise() -> None:
    noise = replace(FIRST.noise, ar_coefficient=0.87)
    made = replace(named(), causes=(), wrong=(replace(FIRST, rows=80, noise=noise), OTHER))
    assert not any("random walk" in doubt for doubt in doubts(made))


def test_a_wave_that_is_left_is_said_and_takes_no_name() -> None:
    made = replace(named(), wrong=(replace(FIRST, findings=(*FIRST.findings, FINDINGS["wave"])), OTHER))
    (warning,) = made.warnings
    assert warning.startswith("in what is left of slide_position there are 12 waves over the range of crank_angle")
    assert made.verdict == "named"
    assert prose(warning)[1:] in " ".join(headline(made))


def test_an_alarm_beside_several_explanations_is_a_warning() -> None:
    made = replace(ambiguous(), stability=0.2)
    assert made.verdict == "one_of"
    assert len(made.warnings) == 1
