"""Causes of one slope at zero: they are one cause while they are small, and part where they bend or turn about."""

from __future__ import annotations

import re
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from diagnosis_models import Array, Asked, assert_sized, ends

from truing import (
    Condition,
    Effect,
    Float,
    Minimise,
    Model,
    Tolerance,
    Unknown,
    drawn,
    feasible,
    found,
    given,
    inputs,
    normal,
    results,
)
from truing.diagnosis import exact
from truing.diagnosis.causes import effects_of
from truing.diagnosis.engine import diagnose
from truing.diagnosis.exact import EXACTLY, alone, fitting
from truing.diagnosis.extended import Extended
from truing.diagnosis.learning import first_noise
from truing.diagnosis.machine import calibration_of
from truing.diagnosis.result import DiagnosisResult
from truing.diagnosis.sample import sample_of
from truing.runs.diagnosis_document import diagnosis_document
from truing.setup import SwitchedOn

NOISE = 0.02  # MPa
ROWS = 90


@inputs
class Beam:
    """A beam under a force that may be shaken, and that may not bear along its whole width."""

    force: Float = given(10.0, "N", above=0)
    speed: Float = given(0.0, "Hz", at_least=0)
    crowding: Float = given(1.0, "", note="neutral 1: largest over mean pressure")
    lead: Float = given(0.0, "N", note="neutral 0: carried beside the force; together never below 0")
    swing: Float = given(0.0, "", note="neutral 0: in motion beside at rest")


@results
class Stress:
    """What the beam bears."""

    stress: Float = found("MPa")


def beam(it: Beam) -> Stress:
    """A megapascal per newton."""
    return Stress(stress=1e6 * np.maximum(it.force * it.crowding + it.lead, 0.0) * (1.0 + it.swing))


def tilted(it: Beam, *, tilt: Float) -> Beam:
    """1 + r of the mean, and 2 sqrt(r) where a part of the width lifts off: r = tilt over force."""
    ratio = tilt / it.force
    return replace(it, crowding=np.where(ratio <= 1, 1 + ratio, 2 * np.sqrt(np.maximum(ratio, 0.0))))


def ahead(it: Beam, *, lead: Float) -> Beam:
    return replace(it, lead=it.lead + lead)


def resonant(it: Beam, *, excitation: Float, own: Float, damping: Float) -> Beam:
    return replace(it, swing=it.swing + excitation * peak(it.speed, own, damping))


def peak(speed: Float, own: Float, damping: Float) -> Float:
    ratio = np.square(speed / own)
    made: Float = ratio / np.sqrt((1 - ratio) ** 2 + 4 * np.square(damping) * ratio)
    return made


MODEL = Model(
    name="beam",
    title="Beam",
    function=beam,
    errors=[
        Effect("tilted", on_inputs=tilted, unknowns=[Unknown("tilt", 0, 20, "N")]),
        Effect("ahead", on_inputs=ahead, unknowns=[Unknown("lead", -20, 20, "N")]),
        Effect(
            "resonant",
            on_inputs=resonant,
            unknowns=[
                Unknown("excitation", 0, 1, ""),
                Unknown("own", 5, 300, "Hz"),
                Unknown("damping", 0.03, 0.3, ""),
            ],
        ),
    ],
)


ASKED = Asked(MODEL, units={"force": "N", "speed": "Hz", "stress": "MPa"})


def asked(folder: Path, truth: str, size: float, *, low: float, gauge: float = 1.0) -> DiagnosisResult:
    """Ask about beams under forces from ``low`` on, with one thing wrong; ``gauge`` scales the noise of some rows."""
    rng = np.random.default_rng(4)
    force, speed = rng.uniform(low, 12.0, ROWS), rng.uniform(1.0, 100.0, ROWS)
    stress = {
        "tilted": np.where(size <= force, force + size, 2 * np.sqrt(np.abs(size) * force)),
        "ahead": np.maximum(force + size, 0.0),
        "resonant": force * (1 + size * np.asarray(peak(speed, 40.0, 0.05))),
    }[truth]
    stress = stress + NOISE * rng.standard_normal(ROWS) * np.where(np.arange(ROWS) % 9 == 4, gauge, 1.0)
    return ASKED.diagnosed(folder, {"force": force, "speed": speed, "stress": stress})


def named(answer: DiagnosisResult) -> set[str]:
    (cause,) = answer.causes
    return {cause.effect, *cause.same_as}


def test_small_ones_are_one_cause_and_small_forces_would_part_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Under 4 N and more a tilt of 1 N adds 1 MPa at any force, as a lead of 1 N does and an offset of the gauge.

    Of a record that is too long what inputs draw is not kept, and calculated anew.
    """
    monkeypatch.setattr(exact, "MOST_KEPT", -1)
    assert {"tilted", "ahead"} <= named(asked(tmp_path, "tilted", 1.0, low=4.0))


@pytest.mark.parametrize(("truth", "size"), [("tilted", 8.0), ("ahead", -1.5)])
def test_large_ones_part(tmp_path: Path, truth: str, size: float) -> None:
    """2 sqrt(r) is no 1 + r; and what lacks 1.5 N bears nothing below 1.5 N, which a tilt can never do.

    Noise is 0.25 % of the largest of them: chords of sizes nearby leave more than that.
    """
    answer = asked(tmp_path, truth, size, low=0.5)
    assert truth in named(answer)
    assert not ({"tilted", "ahead"} - {truth}) & named(answer)
    assert answer.remainder is None
    (cause,) = answer.causes
    (unknown,) = cause.unknowns
    size *= 1e6 if cause.effect == "sensor_offset" else 1.0  # a gauge that is off by it draws the same curve
    assert_sized(unknown, size, within=0.05)


@pytest.mark.parametrize(("excitation", "gauge"), [(0.05, 1.0), (0.1, 40.0)], ids=["small", "gross errors"])
def test_a_sharp_peak_that_few_rows_tell_is_no_set_of_outliers(tmp_path: Path, excitation: float, gauge: float) -> None:
    """Also with forty times the noise in every ninth reading: a fit to the readings as they are would follow them."""
    answer = asked(tmp_path, "resonant", excitation, low=4.0, gauge=gauge)
    (cause,) = answer.causes
    assert (cause.effect, answer.remainder) == ("resonant", None)
    held = {item.name: ends(item) for item in cause.unknowns}
    for name, true in (("excitation", excitation), ("own", 40.0), ("damping", 0.05)):
        low, high = held[name]
        reach = 0.5 * (high - low)
        assert low - 0.5 * reach <= true <= high + 0.5 * reach, name  # three standard errors
    assert reach < 0.3 * 0.05


# Effects that are not in proportion to their size: one that begins late, and one that is so large that it has bent.

FIRST_FELT = 5.0
MOST_CLOGGED = 1e7  # um
DENSE, SD = 5.0, 0.03
"""mg per um; of the rate, from disc to disc."""


@inputs
class Disc:
    """A disc that slides along a pin, and less of it where a film carries."""

    path: Float = given(0.0, "km")
    speed: Float = given(1.0, "m/s", above=0)
    rate: Float = given(1.0, "um/km")
    harder: Float = given(1.0, "", note="neutral 1: of the disc")
    of_pin: Float = given(0.0, "", note="neutral 0: wear of the pin over that of the disc")
    film: Float = given(0.0, "", note="neutral 0: thickness over that of the formula")
    growth: Float = given(0.0, "1/km", note="neutral 0: of the rate of wear")
    clog: Float = given(0.0, "um/km", note="neutral 0: worn beside, which ends at ten metres")


@results
class Scar:
    """What is lost."""

    depth: Float = found("um")
    noise: Float = found("", note="of nothing")
    warmth: Float = found("K")
    debris: Float = found("mg")


def worn(path_km: Float, speed: Float, film: Float, growth: Float, clog: Float = 0.0) -> Float:
    """um: a micrometre per km, less by the film from a felt thickness on, growing; more where it clogs, to a bound."""
    carried = np.clip((film * speed - FIRST_FELT) / 10.0, 0.0, 1.0)
    grown = np.where(growth == 0, path_km, np.expm1(growth * path_km) / np.where(growth == 0, 1.0, growth))
    return (1.0 - carried) * grown + clog * path_km * speed / (1.0 + clog * path_km * speed / MOST_CLOGGED)


def scar(disc: Disc) -> Scar:
    """A scar that grows with the path."""
    lost = disc.harder * disc.rate / 1e-9 * 1e-6
    lost = lost * worn(disc.path / 1e3, disc.speed, disc.film, disc.growth * 1e3, disc.clog * 1e9)
    return Scar(depth=lost * (1 + disc.of_pin), noise=0 * lost + 1, warmth=lost / 1e-6, debris=lost * DENSE)


def filmed(disc: Disc, *, thickness: Float) -> Disc:
    return replace(disc, film=disc.film + thickness)


def hastened(disc: Disc, *, growth: Float) -> Disc:
    return replace(disc, growth=disc.growth + growth)


def clogging(disc: Disc, *, rate: Float) -> Disc:
    return replace(disc, clog=disc.clog + rate)


def slowed(disc: Disc, *, share: Float) -> Disc:
    return replace(disc, path=disc.path * (1 - share))


EFFECTS = [
    Effect("filmed", on_inputs=filmed, unknowns=[Unknown("thickness", 0, 20)]),
    Effect("hastened", on_inputs=hastened, unknowns=[Unknown("growth", 0, 0.5, "1/km")]),
    Effect("slowed", on_inputs=slowed, unknowns=[Unknown("share", 0, 1)]),
]


def disc_asked(effects: Sequence[Any], goals: Sequence[Any] = ()) -> Asked:
    model: Model[Any, Any] = Model(name="scar", title="Scar", function=scar, errors=effects, objectives=goals)
    return Asked(model, units={"path": "km", "speed": "m/s", "depth": "um", "debris": "mg"})


def record(film: float = 0.0, growth: float = 0.0, clog: float = 0.0) -> dict[str, Array]:
    """Rows of a disc with this film, growth and clogging, with 0.5 um of noise."""
    rng = np.random.default_rng(8)
    path, speed = np.sort(rng.uniform(0, 20, 80)), rng.uniform(0.3, 2.0, 80)
    depth = worn(path, speed, film, growth, clog) + rng.normal(0, 0.5, 80)
    return {"path": path, "speed": speed, "depth": np.asarray(depth)}


CLOGGED = Effect("clogged", on_inputs=clogging, unknowns=[Unknown("rate", 0, 1e6, "um/km")])


@pytest.mark.parametrize(
    ("wrong", "effects", "name", "size"),
    [
        ({"film": 8.0}, EFFECTS, "filmed", 8.0),
        ({"growth": 0.05}, EFFECTS, "hastened", 0.05e-3),
        ({"clog": 0.2}, [*EFFECTS, CLOGGED], "clogged", 0.2e-9),
    ],
)
def test_a_cause_that_is_not_in_proportion_to_its_size_is_named_alone(
    tmp_path: Path, wrong: Mapping[str, float], effects: Sequence[Effect], name: str, size: float
) -> None:
    """A film has no slope at no film; exp(1) is far from its slope: what that leaves is no second cause.

    The bound of what clogs is ten million times what is there: it bends at every size looked at, and is a line there.
    """
    answer = disc_asked(effects).diagnosed(tmp_path, record(**wrong))
    assert answer.verdict in {"named", "one_of"}
    (cause,) = answer.causes
    assert (cause.effect, answer.remainder) == (name, None)
    (unknown,) = cause.unknowns
    assert_sized(unknown, size, within=0.2)


def test_a_film_that_is_not_there_is_not_found(tmp_path: Path) -> None:
    answer = disc_asked(EFFECTS).diagnosed(tmp_path, record())
    assert (answer.causes, answer.remainder) == ((), None)


# A model that cannot go everywhere: a start beyond what is feasible is moved inside, and what fails is named.

WIDTH, LENGTH, GAP_NOISE = 100.0, 10.0, 0.3


@inputs
class Gap:
    """A gap that narrows along its length."""

    place: Float = given(0.0, "mm")
    width: Float = given(WIDTH, "um")
    loss: Float = given(0.0, "um", note="neutral 0: what is lost at the end")


@results
class Flow:
    """What comes through."""

    flow: Float = found("um")


def flow(gap: Gap) -> Flow:
    """The root of the width in units of 100 um."""
    left = gap.width - gap.loss * gap.place / (LENGTH * 1e-3)
    feasible(left > 0, "the gap is closed")
    return Flow(flow=np.sqrt(left * 1e-4))


def loses(gap: Gap, *, loss: Float) -> Gap:
    return replace(gap, loss=gap.loss + loss)


def shuts(gap: Gap, *, blow: Float) -> Gap:
    return replace(gap, width=gap.width - np.where(np.asarray(blow) != 0, 1.0, 0.0))


GAP = Model(
    name="gap", title="Gap", function=flow,
    errors=[
        Tolerance("width", normal(sd="2 %")),
        Effect("loses", on_inputs=loses, unknowns=[Unknown("loss", 0, 200, "um")]),
        Effect("shuts", on_inputs=shuts, unknowns=[Unknown("blow", 0, 200, "um")]),
    ],
)  # fmt: skip


def gap_asked(folder: Path, loss: float) -> DiagnosisResult:
    """Sixty readings along a gap that loses so much, in um."""
    rng = np.random.default_rng(3)
    place = np.linspace(0, LENGTH, 60)
    shown = np.sqrt((WIDTH - loss * place / LENGTH) * 100) + rng.normal(0, GAP_NOISE, 60)
    return Asked(GAP, units={"place": "mm", "flow": "um"}).diagnosed(folder, {"place": place, "flow": shown})


def test_a_start_at_which_the_model_fails_is_moved_inside_and_what_always_fails_is_left_out(tmp_path: Path) -> None:
    """Linear in the loss, 99 um look like far more than the 100 um that close the gap."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        answer = gap_asked(tmp_path, 99.0)
    (cause,) = answer.causes
    (unknown,) = cause.unknowns
    assert (cause.effect, unknown.value) == ("loses", pytest.approx(99e-6, rel=0.01))
    (unseen,) = [item for item in answer.seen if item.name == "shuts"]
    assert (unseen.sight, unseen.smallest) == ("cannot be fitted", None)
    assert unseen.text == "the model fails with it, in measured.csv:2 as the first row: the gap is closed"
    document = diagnosis_document(answer)
    assert document["not_fitted"] == {"shuts": unseen.text}
    assert "shuts" not in document["not_excited"]


# Causes of one curve on what was measured: the result that would tell them apart, and what each may be at all.


def faster(disc: Disc, *, growth: Float) -> Disc:
    return replace(disc, harder=disc.harder * (1 + growth))


def pin_too(disc: Disc, *, ratio: Float) -> Disc:
    return replace(disc, of_pin=disc.of_pin + ratio)


def filled(disc: Disc, *, share: Float) -> Disc:
    return replace(disc, of_pin=disc.of_pin - share)


ADDS = [
    Effect("pin_too", on_inputs=pin_too, unknowns=[Unknown("ratio", 0, 2)]),
    Effect("faster", on_inputs=faster, unknowns=[Unknown("growth", 0, 2)]),
]
TAKES = Effect("filled", on_inputs=filled, unknowns=[Unknown("share", 0, 0.9)])


def scar_asked(
    folder: Path, *, on_disc: float, on_both: float, weighed: bool = False, goals: bool = True
) -> DiagnosisResult:
    """The disc loses ``on_disc`` times what it should, the scar is ``on_both`` times as deep as that."""
    effects = [*ADDS, TAKES, Tolerance("rate", normal(sd=f"{SD:.0%}"))]
    rng = np.random.default_rng(5)
    path = np.linspace(0, 20, 60)
    depth = path * on_disc * on_both + rng.normal(0, 0.1, 60)
    debris = path * on_disc * DENSE + rng.normal(0, 0.5, 60)
    columns = {"path": path, "depth": depth, **({"debris": debris} if weighed else {})}
    return disc_asked(effects, [Minimise("debris")] if goals else []).diagnosed(folder, columns)


def test_a_result_that_was_not_measured_is_asked_for_where_it_tells_causes_apart(tmp_path: Path) -> None:
    answer = scar_asked(tmp_path, on_disc=1.4, on_both=1.0)
    names = named(answer)
    assert {"pin_too", "faster"} <= names
    point = answer.next[0]
    assert (dict(point.settings), point.measure) == ({}, ("debris",))
    assert set(point.separates) <= names
    assert point.why.startswith("measure debris, too: ")
    words = re.search(r"differ by (\S+) mg in it, machines within their tolerances by (\S+) mg", point.why)
    assert words is not None
    farthest, scatter = 0.4 * 20 * DENSE, SD * 20 * DENSE  # at the end of the path
    assert float(words[1]) == pytest.approx(farthest, abs=2 * scatter)  # disc to disc the share is another one
    assert float(words[2]) == pytest.approx(scatter, rel=0.02)
    assert point.separation == pytest.approx((float(words[1]) / float(words[2])) ** 2, rel=0.1)
    # both causes draw one curve along the path wherever it is measured: no setting separates them
    assert [point for point in answer.next if point.settings and point.separation < 1] == []


def test_a_goal_comes_before_other_results_that_tell_as_much(tmp_path: Path) -> None:
    """Warmth is declared before debris and follows the disc as well."""
    assert scar_asked(tmp_path, on_disc=1.4, on_both=1.0, goals=False).next[0].measure == ("warmth",)


@pytest.mark.parametrize(("on_disc", "on_both", "name"), [(1.4, 1.0, "faster"), (1.0, 1.4, "pin_too")])
def test_with_that_result_the_cause_has_one_name(tmp_path: Path, on_disc: float, on_both: float, name: str) -> None:
    answer = scar_asked(tmp_path, on_disc=on_disc, on_both=on_both, weighed=True)
    assert named(answer) & {"faster", "pin_too"} == {name}


@pytest.mark.parametrize(("on_both", "there", "not_there"), [(0.6, "filled", "pin_too"), (1.4, "pin_too", "filled")])
def test_what_can_only_add_is_no_name_of_what_takes_away(
    tmp_path: Path, on_both: float, there: str, not_there: str
) -> None:
    answer = scar_asked(tmp_path, on_disc=1.0, on_both=on_both)
    assert named(answer) & {there, not_there} == {there}
    assert all(not_there not in pair for point in answer.next for pair in point.separates)


# Inputs that are drawn together: the calibration may move them only as they scatter, one with the other.

SHIM_SD, SHIM_NOISE, SHIM_ROWS = 5.0, 0.5, 80


@inputs
class Stack:
    """Two shims cut from one sheet: what one has more the other has less."""

    left: Float = given(10.0, "um")
    right: Float = given(10.0, "um")
    place: Float = given(0.0, "mm")


@results
class Shims:
    """What a gauge reads, on both shims and on one of them and half of the other."""

    both: Float = found("um")
    bent: Float = found("um")


def height(stack: Stack) -> Shims:
    """The place of the gauge changes nothing."""
    nothing = 0.0 * stack.place
    return Shims(both=stack.left + stack.right + nothing, bent=stack.left + 0.5 * stack.right + nothing)


def cut(rng: np.random.Generator, rows: int) -> Mapping[str, Any]:
    """Return deviations that add up to nothing."""
    more = rng.normal(0.0, SHIM_SD * 1e-6, rows)
    return {"left": more, "right": -more}


def shims_asked(folder: Path, result: str, off: float) -> DiagnosisResult:
    """Readings of shims that are off by so much, um; both vary together."""
    model = Model(
        name="stack", title="Stack", function=height, errors=[Tolerance("cut", drawn(cut), on=["left", "right"])]
    )
    rng = np.random.default_rng(7)
    nominal = 20.0 if result == "both" else 15.0
    columns = {"place": rng.uniform(-5, 5, SHIM_ROWS), result: nominal + off + rng.normal(0, SHIM_NOISE, SHIM_ROWS)}
    return Asked(model, units={"place": "mm", result: "um"}).diagnosed(folder, columns)


def test_what_cancels_in_every_machine_hides_no_offset(tmp_path: Path) -> None:
    said = shims_asked(tmp_path, "both", 3.0)
    assert [cause.effect for cause in said.causes] == ["sensor_offset"]
    (offset,) = said.causes[0].unknowns
    assert offset.value == pytest.approx(3e-6, abs=3 * SHIM_NOISE * 1e-6 / SHIM_ROWS**0.5)


def test_calibration_moves_both_by_their_scatter(tmp_path: Path) -> None:
    """Half of the deviation is read: 3 um are 6 um on the one and -6 um on the other, 1.2 standard deviations."""
    said = shims_asked(tmp_path, "bent", 3.0)
    assert said.verdict == "none"
    moved = {item.name: item for item in said.calibrated}
    assert [moved[name].value for name in ("left", "right")] == pytest.approx([16e-6, 4e-6], abs=0.5e-6)
    assert [moved[name].of_its_sd for name in ("left", "right")] == pytest.approx([1.2, -1.2], abs=0.1)


# A second cause that shows what it is only beside the first: play in a joint, and friction that shifts its jump.


@inputs
class Joint:
    """A shaft under torque; ``kept`` is what friction keeps from it."""

    torque: Float = given(0.0, "N*m")
    rigidity: Float = given(400.0, "N*m/rad", above=0)
    kept: Float = given(0.0, "N*m")
    play: Float = given(0.0, "mrad")
    width: Float = given(1.0, "N*m", above=0)


@results
class Twist:
    """How far it turns."""

    angle: Float = found("mrad")


def shaft(joint: Joint) -> Twist:
    """A spring, and a joint that jumps where its load changes sign."""
    load = joint.torque - joint.kept
    return Twist(angle=load / joint.rigidity + joint.play / 2 * np.tanh(load / joint.width))


def lost_motion(joint: Joint, *, play: Float, width: Float) -> Joint:
    return replace(joint, play=joint.play + play, width=width)


def friction(joint: Joint, *, torque: Float, direction: Float) -> Joint:
    return replace(joint, kept=joint.kept + torque * direction)


def softening(joint: Joint, *, share: Float) -> Joint:
    return replace(joint, rigidity=joint.rigidity / (1 + share))


def waves(joint: Joint, base: Twist, *, slow: Float, fast: Float) -> Twist:
    """Go round with the torque, in two parts that are found one by one."""
    turns = joint.torque / 10
    return replace(base, angle=base.angle + slow * np.cos(2 * turns) + fast * np.cos(7 * turns))


JOINT_EFFECTS = [
        Effect("lost_motion", on_inputs=lost_motion,
               unknowns=[Unknown("play", 0, 200, "mrad"), Unknown("width", 0.3, 10, "N*m")]),
        Effect("friction", on_inputs=friction, unknowns=[Unknown("torque", 0, 10, "N*m")],
               needs=[Condition("direction", "", reference=0)]),
        Effect("softening", on_inputs=softening, unknowns=[Unknown("share", -0.5, 2, "")]),
        Effect("waves", on_results=waves, unknowns=[Unknown("slow", -9, 9, "mrad"), Unknown("fast", -9, 9, "mrad")],
               parts=[["slow"], ["fast"]]),
]  # fmt: skip


def shaft_of(*effects: Effect[Any, Any], sd: str = "2 %") -> Asked:
    """A shaft with these effects whose rigidity has this standard deviation."""
    errors = [Tolerance("rigidity", normal(sd=sd)), *effects]
    model: Model[Any, Any] = Model(name="shaft", title="A shaft", function=shaft, errors=errors)
    return Asked(model, units={"torque": "N*m", "direction": "", "angle": "mrad"})


def two_sided(joint: Joint, base: Twist, *, left: Float, right: Float) -> Twist:
    """Give way by another share on each side."""
    return replace(base, angle=base.angle * (1 + np.where(joint.torque < 0, left, right)))


SIDES = Effect("two_sided", on_results=two_sided, unknowns=[Unknown("left", -1, 1, ""), Unknown("right", -1, 1, "")])


def loops(noise: float, *, play: float, held: float, rigidity: float = 405.0, wave: float = 0.0) -> dict[str, Array]:
    """Four loops of torque between -20 and 20 N m, read with noise (mrad); written out without the model's code."""
    phase = np.linspace(0, 8 * np.pi, 320)
    torque, direction = 20 * np.sin(phase), np.sign(np.cos(phase))
    load = torque - held * direction
    angle = 1e3 * load / rigidity + play / 2 * np.tanh(load / 1.5)
    angle += wave * (np.cos(torque / 5) + 0.5 * np.cos(0.7 * torque))
    read = angle + noise * np.random.default_rng(5).standard_normal(320)
    return {"torque": torque, "direction": direction, "angle": read}


def test_friction_that_shifts_the_jump_of_a_joint_is_found_beside_its_play_where_an_input_has_moved_far(
    tmp_path: Path,
) -> None:
    """A shaft half as stiff again: what it adds is not linear in the stiffness so far from the nominal one."""
    found = shaft_of(*JOINT_EFFECTS, sd="40 %").diagnosed(tmp_path, loops(1.0, play=90.0, held=3.0, rigidity=620.0))
    assert {cause.effect for cause in found.causes} == {"lost_motion", "friction"}
    assert found.remainder is None
    truth = {"play": 0.090, "width": 1.5, "torque": 3.0}
    for cause in found.causes:
        for unknown in cause.unknowns:
            low, high = ends(unknown)
            assert low <= truth[unknown.name] <= high
    (gain,) = found.gain
    assert gain.rmse_after.value == pytest.approx(1e-3, rel=0.15)
    (stiff,) = found.calibrated
    assert stiff.value == pytest.approx(620, rel=0.02)
    assert stiff.of_its_sd == pytest.approx((stiff.value - 400) / 160, rel=1e-9)  # sd is 40 % of the nominal 400


def test_parts_of_an_effect_that_is_on_are_looked_for_and_join_it(tmp_path: Path) -> None:
    asked = shaft_of(*JOINT_EFFECTS)
    setup = asked.setup.with_effects([SwitchedOn(asked.model.effects["waves"], {"slow": 6e-3})])
    found = diagnose(setup, asked.records(tmp_path, loops(0.5, play=0.0, held=0.0, wave=6.0)))
    (cause,) = found.causes
    assert cause.effect == "waves"
    (fast,) = cause.unknowns
    assert fast.name == "fast"
    assert fast.value == pytest.approx(3e-3, rel=0.1)
    assert found.extended is not None
    (joined,) = found.extended.effects
    assert joined.values == {"slow": pytest.approx(6e-3), "fast": fast.value}


def test_an_amplitude_that_the_record_does_not_excite_is_zero_beside_the_others(tmp_path: Path) -> None:
    """Torque of one sign says nothing of the other side, and the cause is switched on all the same."""
    asked, torque = shaft_of(SIDES), np.linspace(1, 20, 40)
    machine = calibration_of(asked.setup, asked.records(tmp_path, {"torque": torque, "angle": 2.6 * torque}))
    cause = next(each for each in effects_of(machine) if each.name == "two_sided")
    assert [number.name for number in cause.numbers] == ["left", "right"]
    extended = Extended(machine)
    (there,) = extended.at([cause], [([np.array([0.3, 0.04])], np.zeros(len(machine.inputs)))])
    np.testing.assert_allclose(there["angle"], 1.04 * machine.base["angle"], rtol=1e-12)
    sample = sample_of(machine, first_noise(machine), np.ones(40, dtype=bool))
    found = alone(extended, fitting(sample, extended, [cause], [np.array([0.0, 0.01])]))
    assert found is not None
    (left, right), reach = found.of(cause), 0.02 * EXACTLY**0.5  # of the rigidity, within what a fit takes as exact
    assert left == 0.0
    assert right == pytest.approx(0.04, abs=2 * reach)  # 2.6 mrad are 4 % more than 1e3/400
