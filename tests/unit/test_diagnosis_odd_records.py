"""Many effects, many inputs, and records of odd sizes: what is there is found, and no row is lost unsaid."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from diagnosis_models import Asked, names_in
from hard_models import (
    EFFECTS,
    NOISE,
    ROWS,
    UNITS,
    Beam,
    Bend,
    Shop,
    asked,
    leaning,
    of_causes,
    record,
)

from truing import Effect, Float, Model, Tolerance, Unknown, given, inputs, normal
from truing.diagnosis import engine

pytestmark = pytest.mark.filterwarnings("error::RuntimeWarning")

# Many effects, many inputs


def ripples(order: int) -> Effect[Any, Any]:
    def rippling(it: Beam, *, size: Float) -> Beam:
        return replace(it, ripple=it.ripple + size * np.cos(np.pi * order * it.place / 0.3))

    return Effect(f"ripple_{order}", on_inputs=rippling, unknowns=[Unknown("size", -200, 200, "um")])


def test_one_of_forty_effects_is_named(tmp_path: Path) -> None:
    effects = [*EFFECTS, *(ripples(order) for order in range(1, 36))]
    error = record(lambda at: 20 * np.cos(17 * np.pi * at["place"] / 300))
    answer = asked(Shop(), effects).diagnosed(tmp_path, error)
    assert (answer.verdict, [cause.effect for cause in answer.causes]) == ("named", ["ripple_17"])
    assert of_causes(answer)["ripple_17.size"] == pytest.approx(20e-6, abs=5 * NOISE * 1e-6 * np.sqrt(2 / ROWS))
    assert asked(Shop(), effects).diagnosed(tmp_path, record(lambda at: 0.0)).verdict == "none"


PARTS = tuple(f"part_{place}" for place in range(24))
Stack = inputs(
    type(
        "Stack", (), {
            "__annotations__": dict.fromkeys(("place", "slant", *PARTS), Float), "__doc__": "Parts in a row.",
            "place": given(0.0, "mm"), "slant": given(0.0, "um"), **{name: given(0.0, "um") for name in PARTS},
        },
    )
)  # fmt: skip


def stack_leans(it: Any, *, slant: Float) -> Any:
    return replace(it, slant=it.slant + slant)


stack_leans.__annotations__ |= {"it": Stack, "return": Stack}
STACK_LEANS = Effect("leans", on_inputs=stack_leans, unknowns=[Unknown("slant", -200, 200, "um")])


def stack(it: Any) -> Bend:
    """Every part is felt where it lies, 12 mm from the next one."""
    bend = it.slant * it.place / 0.3
    for number, name in enumerate(PARTS):
        bend = bend + getattr(it, name) * np.exp(-(((it.place - 0.012 * number) / 0.01) ** 2))
    return Bend(bend=bend)


stack.__annotations__ = {"it": Stack, "return": Bend}


@pytest.mark.parametrize("slant", [0.0, 40.0])
def test_many_tolerated_inputs_are_calibrated_and_no_cause(tmp_path: Path, slant: float) -> None:
    rng = np.random.default_rng(2)
    place, off = np.linspace(0, 300, 240), rng.normal(0, 2, len(PARTS))
    parts = [each * np.exp(-(((place - 12 * number) / 10) ** 2)) for number, each in enumerate(off)]
    bend = slant * place / 300 + np.sum(parts, axis=0) + rng.normal(0, 1, 240)
    spreads = [Tolerance(name, normal(sd="2 um")) for name in PARTS]
    model = Model(name="stack", title="Stack", function=stack, errors=[*spreads, STACK_LEANS])
    answer = Asked(model, units=UNITS).diagnosed(tmp_path, {"place": place, "bend": bend})
    assert len(answer.calibrated) == len(PARTS)
    known = of_causes(answer)
    assert names_in(answer) >= ({"leans"} if slant else set())
    assert bool(known) == bool(slant)


# Records of odd sizes


def test_two_equal_columns_are_told_as_one(tmp_path: Path) -> None:
    """A shape over either is the same: neither of the two is called the one."""
    columns = record(lambda at: 30 * np.sin(2 * np.pi * at["warmth"] / 12))
    twin = replace(asked(Shop()), units={**UNITS, "air": "K"})
    answer = twin.diagnosed(tmp_path, {**columns, "air": columns["warmth"] + 273.15})
    assert any({"warmth", "air"} <= set(said.replace(" and ", " ").split()) for said in answer.inseparable)
    assert answer.verdict in {"unknown", "one_of"}


def test_a_long_record_runs_to_the_end_and_counts_every_row(
    tmp_path: Path, full_torture: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A million rows at full size; a modest record is long where 400 rows are searched."""
    rows = 1_000_000 if full_torture else 3_000
    if not full_torture:
        monkeypatch.setattr(engine, "LONG", 400)
    answer = asked(Shop(), EFFECTS[:3], rows).diagnosed(tmp_path, record(leaning, rows))
    assert [cause.effect for cause in answer.causes] == ["leans"]
    assert sum(count.in_file for count in answer.records.counts) == rows == len(answer.records)
    error = NOISE * 1e-6 * np.sqrt(12 / rows)
    assert of_causes(answer)["leans.slant"] == pytest.approx(40e-6, abs=5 * error)


def test_of_a_long_record_the_rows_searched_say_what_would_be_visible(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As much as all rows say, up to what a quarter of them is not like the whole."""
    answers = []
    for rows_searched in (1_200, 300):
        monkeypatch.setattr(engine, "LONG", rows_searched)
        answers.append(asked(Shop(), EFFECTS[:3], 1_200).diagnosed(tmp_path, record(leaning, 1_200)))
    whole, few = answers
    sizes = [{seen.name: seen.smallest.value for seen in answer.seen if seen.smallest} for answer in answers]
    assert sizes[0].keys() == sizes[1].keys() > {effect.name for effect in EFFECTS[:3]}
    assert [sizes[1][name] for name in sizes[0]] == pytest.approx(list(sizes[0].values()), rel=0.1)
    apart = [{rival.causes: rival.separation for rival in answer.ranking} for answer in answers]
    both = apart[0].keys() & apart[1].keys()
    assert len(both) > 1
    assert [apart[1][names] for names in both] == pytest.approx([apart[0][names] for names in both], rel=0.2)
    assert [cause.effect for cause in whole.causes] == [cause.effect for cause in few.causes] == ["leans"]
