"""Causes of one curve on what was measured: the result that would tell them apart, and what each may be at all.

A pin wears a disc. Its scar is as deep as the disc and the pin lost together; the debris weighs what the disc lost.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnosis_models import Asked

from truing import Effect, Float, Minimise, Model, Tolerance, Unknown, found, given, inputs, normal, results
from truing.diagnosis.result import DiagnosisResult

RATE, DENSE = 2.0, 5.0  # um per km, and mg per um
SD = 0.03  # of the rate, from disc to disc


@inputs
class Disc:
    """A disc that slides along a pin."""

    path: Float = given(0.0, "km")
    rate: Float = given(RATE, "um/km")
    harder: Float = given(1.0, "", note="neutral 1: of the disc")
    of_pin: Float = given(0.0, "", note="neutral 0: wear of the pin over that of the disc")


@results
class Scar:
    """What is lost."""

    depth: Float = found("um")
    noise: Float = found("", note="of nothing")
    warmth: Float = found("K")
    debris: Float = found("mg")


def scar(disc: Disc) -> Scar:
    """A scar that grows with the path."""
    lost = disc.rate * disc.harder * disc.path
    return Scar(depth=lost * (1 + disc.of_pin), noise=0 * lost + 1, warmth=lost / 1e-6, debris=lost * DENSE)


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


def asked(
    folder: Path, *, on_disc: float, on_both: float, weighed: bool = False, goals: bool = True
) -> DiagnosisResult:
    """The disc loses ``on_disc`` times what it should, the scar is ``on_both`` times as deep as that."""
    model = Model(
        name="scar", title="Scar", function=scar, errors=[*ADDS, TAKES, Tolerance("rate", normal(sd=f"{SD:.0%}"))],
        objectives=[Minimise("debris")] if goals else [],
    )  # fmt: skip
    rng = np.random.default_rng(5)
    path = np.linspace(0, 20, 60)
    depth = RATE * path * on_disc * on_both + rng.normal(0, 0.2, 60)
    debris = RATE * path * on_disc * DENSE + rng.normal(0, 1.0, 60)
    columns = {"path": path, "depth": depth, **({"debris": debris} if weighed else {})}
    return Asked(model, units={"path": "km", "depth": "um", "debris": "mg"}).diagnosed(folder, columns)


def test_a_result_that_was_not_measured_is_asked_for_where_it_tells_causes_apart(tmp_path: Path) -> None:
    answer = asked(tmp_path, on_disc=1.4, on_both=1.0)
    (cause,) = answer.causes
    names = {cause.effect, *cause.same_as}
    assert {"pin_too", "faster"} <= names
    point = answer.next[0]
    assert (dict(point.settings), point.measure) == ({}, ("debris",))
    assert set(point.separates) <= names
    assert point.why.startswith("measure debris, too: ")
    words = re.search(r"differ by (\S+) mg in it, machines within their tolerances by (\S+) mg", point.why)
    assert words is not None
    farthest, scatter = 0.4 * RATE * 20 * DENSE, SD * RATE * 20 * DENSE  # at the end of the path
    assert float(words[1]) == pytest.approx(farthest, abs=2 * scatter)  # disc to disc the share is another one
    assert float(words[2]) == pytest.approx(scatter, rel=0.02)
    assert point.separation == pytest.approx((float(words[1]) / float(words[2])) ** 2, rel=0.1)
    # both causes draw one curve along the path wherever it is measured: no setting separates them
    assert [point for point in answer.next if point.settings and point.separation < 1] == []


def test_a_goal_comes_before_other_results_that_tell_as_much(tmp_path: Path) -> None:
    """Warmth is declared before debris and follows the disc as well."""
    assert asked(tmp_path, on_disc=1.4, on_both=1.0, goals=False).next[0].measure == ("warmth",)


@pytest.mark.parametrize(("on_disc", "on_both", "name"), [(1.4, 1.0, "faster"), (1.0, 1.4, "pin_too")])
def test_with_that_result_the_cause_has_one_name(tmp_path: Path, on_disc: float, on_both: float, name: str) -> None:
    answer = asked(tmp_path, on_disc=on_disc, on_both=on_both, weighed=True)
    (cause,) = answer.causes
    assert name in {cause.effect, *cause.same_as}
    assert {"faster", "pin_too"} - {name} <= {"faster", "pin_too"} - {cause.effect, *cause.same_as}


@pytest.mark.parametrize(("on_both", "there", "not_there"), [(0.6, "filled", "pin_too"), (1.4, "pin_too", "filled")])
def test_what_can_only_add_is_no_name_of_what_takes_away(
    tmp_path: Path, on_both: float, there: str, not_there: str
) -> None:
    answer = asked(tmp_path, on_disc=1.0, on_both=on_both)
    (cause,) = answer.causes
    names = {cause.effect, *cause.same_as}
    assert there in names
    assert not_there not in names
    assert all(not_there not in pair for point in answer.next for pair in point.separates)
