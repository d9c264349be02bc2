"""Shapes that nobody registered: which there are, what they calculate, and what is said in their place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnosis_models import Array, Asked, Bench, drive_model, gauge, wide
from numpy.testing import assert_allclose

from truing.diagnosis.causes import Candidate
from truing.diagnosis.machine import Calibration, calibration_of
from truing.diagnosis.unregistered import highest_order, shapes_of


def machine(folder: Path, bench: Bench, effects: Sequence[str] = ()) -> Calibration:
    one = Asked(drive_model(effects, {}))
    return calibration_of(one.setup, one.records(folder, bench.columns(gauge(bench.load, bench.travel))))


def of_kind(found: Sequence[Candidate], kind: str, *on: str) -> list[Candidate]:
    """The shapes of one kind, over these covariates if any are named."""
    return [
        each for each in found if each.shape and each.shape.kind == kind and (not on or each.shape.depends_on == on)
    ]


@pytest.mark.parametrize(
    ("degrees", "highest"),
    [
        (np.arange(0.0, 360, 30), 5),
        (np.arange(0.0, 360, 36), 4),
        (np.arange(0.0, 720, 8), 22),
        (np.arange(-60.0, 61, 5), 35),
        (np.array([0.0, 180]), 0),
    ],
)
def test_orders_are_named_up_to_half_the_places_per_turn(degrees: Array, highest: int) -> None:
    """An order k looks like n - k where a turn has n places: sampled at 30 degrees, 7 looks like 5."""
    angle = np.radians(degrees)
    assert highest_order(angle) == highest
    if 0 < highest < 10:
        places = round(2 * np.pi / np.diff(angle)[0])
        assert_allclose(np.cos((places - highest) * angle), np.cos(highest * angle), atol=1e-9)


def test_orders_above_the_sampling_are_not_looked_for(tmp_path: Path) -> None:
    bench = replace(wide(96), rotation=np.tile(np.arange(0.0, 360, 30), 8))
    ends = []
    for each in (bench, wide(96)):
        there = machine(tmp_path, each)
        (order,) = of_kind(shapes_of(there.records, {"rotation": (1, 2, 3)}, has_steps=True), "order")
        assert order.numbers[-1].whole
        ends.append((order.numbers[-1].low, order.numbers[-1].high))
    assert ends == [(4, 5), (4, 16)]


def test_every_shape_over_what_moved_and_nothing_over_what_stood_still(tmp_path: Path) -> None:
    bench = replace(wide(80), temperature=np.full(80, 23.0))
    found = shapes_of(machine(tmp_path, bench).records, {}, has_steps=False)
    kinds = {(each.shape.kind, each.shape.depends_on) for each in found if each.shape}
    moved = {("load",), ("travel",), ("rotation",), ("time",)}
    assert {depends for kind, depends in kinds if kind == "trend"} == moved
    assert {depends for kind, depends in kinds if kind == "wave"} == moved - {("rotation",)}
    assert len([1 for kind, _ in kinds if kind == "product"]) == 6
    assert {("order", ("rotation",)), ("step", ("time",)), ("settling", ("time",))} <= kinds
    assert {depends for kind, depends in kinds if kind in {"jump", "kink", "dead zone"}} == {("load",)}
    assert not any("temperature" in depends for _, depends in kinds)
    assert len({each.tag for each in found}) == len(found)
    assert not of_kind(shapes_of(machine(tmp_path, bench).records, {}, has_steps=True), "step")


def test_printed_terms_are_what_is_calculated(tmp_path: Path) -> None:
    there = machine(tmp_path, wide(80))
    covariates = there.records.covariates
    values = {name: item.values for name, item in covariates.items()}
    for each in shapes_of(there.records, {}, has_steps=False):
        assert each.shape is not None
        for share in (0.1, 0.7):
            numbers = [each.numbers[place] for place in each.shapes]
            at = [round(one.low + share * (one.high - one.low)) if one.whole else one.low + share * (one.high - one.low)
                  for one in numbers]  # fmt: skip
            terms = each.shape.terms(at, covariates)
            assert len(terms) * len(each.shape.results) == len(each.amplitudes)
            for term in terms:
                assert_allclose(eval(term.expression, {"np": np, **values}) * np.ones(80), term.values, atol=1e-12)


LOAD, TIME, ROTATION = wide(80).load, wide(80).time, np.radians(wide(80).rotation)


@pytest.mark.parametrize(
    ("kind", "on", "shape", "columns"),
    [
        ("wave", "time", [3e-4], [np.sin(2 * np.pi * 1.08 * TIME), np.cos(2 * np.pi * 1.08 * TIME)]),
        ("order", "rotation", [4.0], [np.sin(4 * ROTATION), np.cos(4 * ROTATION)]),
        ("step", "time", [18_000.0], [TIME >= 5]),
        ("settling", "time", [7200.0], [np.ones(80), np.exp(-TIME / 2)]),
        ("jump", "load", [], [np.sign(LOAD)]),
        ("kink", "load", [], [np.abs(LOAD)]),
        ("dead zone", "load", [4e3], [np.sign(LOAD) * np.maximum(np.abs(LOAD) - 4, 0)]),
        ("trend", "load", [], [np.ones(80), LOAD, LOAD**2]),
        ("product", "load travel", [], [np.ones(80), LOAD, wide(80).travel, LOAD * wide(80).travel]),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_a_shape_draws_what_its_kind_says(
    tmp_path: Path, kind: str, on: str, shape: list[float], columns: list[Array]
) -> None:
    """The columns by hand, in kN, h and mm, span what the terms of the smallest shape of the kind do."""
    there = machine(tmp_path, wide(80))
    smallest = min(
        of_kind(shapes_of(there.records, {}, has_steps=False), kind, *on.split()), key=lambda each: each.size
    )
    assert smallest.shape is not None
    terms = np.column_stack([term.values for term in smallest.shape.terms(shape, there.records.covariates)])
    by_hand = np.column_stack(columns).astype(float)
    assert terms.shape == by_hand.shape
    missed = by_hand - terms @ np.linalg.lstsq(terms, by_hand)[0]
    assert np.abs(missed).max() < 1e-9 * np.abs(by_hand).max()
