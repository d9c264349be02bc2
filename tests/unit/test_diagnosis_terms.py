"""What competes in a diagnosis: the columns of effects, their grids and names, and the shapes nobody registered."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from diagnosis_models import (
    EFFECTS,
    UM,
    Array,
    Asked,
    Bench,
    Deflection,
    Drive,
    drive_model,
    gauge,
    offer_of,
    warming,
    wide,
    write_csv,
)
from numpy.testing import assert_allclose

from truing import Effect, Float, Unknown
from truing.diagnosis.candidates import Candidate, Term, candidates_of
from truing.diagnosis.contest import _finer
from truing.diagnosis.grids import grid_of, terms_of
from truing.diagnosis.hypotheses import Hypothesis, Piece, mixed
from truing.diagnosis.machine import Machine, machine_of
from truing.diagnosis.problem import Problem, near, problem_of, terms_for_pairs
from truing.diagnosis.reading import read_records
from truing.diagnosis.records import Records
from truing.diagnosis.search import Found
from truing.diagnosis.shapes import highest_order, library_of
from truing.setup import DiagnoseOptions

SCALES = {"deflection": UM}


def rubbing(screw: Drive, base: Deflection, *, drag: Float) -> Deflection:
    """Act otherwise upward than downward."""
    return replace(base, deflection=base.deflection + np.maximum(drag, 0) * screw.travel + np.minimum(drag, 0) * 1e-3)


def bowed(screw: Drive, base: Deflection, *, bow: Float) -> Deflection:
    """Bend with the amplitude, but smoothly."""
    return replace(base, deflection=base.deflection + bow * screw.travel + 30 * bow**2 * screw.travel)


def skewed(screw: Drive, base: Deflection, *, along: Float, across: Float) -> Deflection:
    """Follow the travel, and something that never moves."""
    return replace(base, deflection=base.deflection + along * screw.travel + across * 0 * screw.travel)


def fading(screw: Drive, base: Deflection, *, start: Float, width: Float) -> Deflection:
    """Be largest at the beginning of the travel."""
    return replace(base, deflection=base.deflection + start * np.exp(-screw.travel / width))


def lead_again(screw: Drive, base: Deflection, *, pitch: Float) -> Deflection:
    """Follow the travel under another name."""
    return replace(base, deflection=base.deflection + pitch * screw.travel)


MORE: Mapping[str, Effect[Drive, Deflection]] = {
    "rubbing": Effect("rubbing", on_results=rubbing, unknowns=[Unknown("drag", -2, 4, "um/mm")]),
    "bowed": Effect("bowed", on_results=bowed, unknowns=[Unknown("bow", -1, 1, "um/mm")]),
    "skewed": Effect(
        "skewed", on_results=skewed, unknowns=[Unknown("along", -1, 1, "um/mm"), Unknown("across", -1, 1, "um/mm")]
    ),
    "fading": Effect(
        "fading", on_results=fading, unknowns=[Unknown("start", -9, 9, "um"), Unknown("width", 1, 300, "mm")]
    ),
    "lead_again": Effect("lead_again", on_results=lead_again, unknowns=[Unknown("pitch", -1, 1, "um/mm")]),
}


def asked(effects: Sequence[str] = (), more: Sequence[str] = (), tolerances: Mapping[str, str] | None = None) -> Asked:
    model = drive_model(effects, tolerances or {})
    errors = [*model.errors, *(MORE[name] for name in more)]
    return Asked(replace(model, errors=errors))


def machine(one: Asked, folder: Path, bench: Bench) -> Machine:
    return machine_of(one.setup, one.records(folder, bench.columns(gauge(bench.load, bench.travel))))


def candidate(there: Machine, name: str) -> tuple[int, Candidate]:
    return next((place, item) for place, item in enumerate(candidates_of(there)) if item.name == name)


def terms(there: Machine, name: str) -> list[Term]:
    place, item = candidate(there, name)
    return terms_of(place, item, there, SCALES)


def problem(one: Asked, folder: Path, bench: Bench) -> Problem:
    return problem_of(machine(one, folder, bench), SCALES)


def variants(found: Problem, name: str) -> list[Piece]:
    owner = next(place for place, item in enumerate(found.candidates) if item.name == name)
    return [piece for piece in found.term_pieces if piece.owner == owner]


def test_an_effect_with_a_kink_is_two_one_sided_terms(tmp_path: Path) -> None:
    bench = wide(60)
    up, down = terms(machine(asked(more=["rubbing"]), tmp_path, bench), "rubbing")
    assert (up.low, down.high) == ((0.0,), (0.0,))
    assert_allclose(up.curves[0]["deflection"], bench.travel * 1e-3, rtol=1e-9)
    assert_allclose(down.curves[0]["deflection"], 1e-3, rtol=1e-9)
    assert_allclose([up.high[0] * up.per[0], down.low[0] * down.per[0]], [4e-3, -2e-3])  # um/mm is 1e-3
    root_mean_square = np.sqrt(np.mean((up.curves[0]["deflection"] * up.per[0] / UM) ** 2))
    assert_allclose(root_mean_square, 1, rtol=1e-12)


def test_an_effect_that_only_bends_is_one_term(tmp_path: Path) -> None:
    bench = wide(60)
    (term,) = terms(machine(asked(more=["bowed"]), tmp_path, bench), "bowed")
    assert_allclose(term.curves[0]["deflection"], bench.travel * 1e-3, rtol=1e-6)
    assert_allclose([term.low[0] * term.per[0], term.high[0] * term.per[0]], [-1e-3, 1e-3])


def test_an_effect_on_the_inputs_is_its_exact_slope(tmp_path: Path) -> None:
    bench = wide(60)
    (term,) = terms(machine(asked(["stiffness_loss"]), tmp_path, bench), "stiffness_loss")
    contact = np.sign(bench.load) * np.abs(bench.load) ** (2 / 3)
    slope = 2 * contact + 0.5 * bench.load * bench.travel / 150  # d/d(loss) at zero of both terms
    assert_allclose(term.curves[0]["deflection"] / UM, slope, rtol=1e-4)


def test_a_coefficient_that_nothing_excites_has_no_column(tmp_path: Path) -> None:
    (term,) = terms(machine(asked(more=["skewed"]), tmp_path, wide(60)), "skewed")
    assert term.unknowns == ("along",)
    still = replace(wide(60), temperature=np.full(60, 31.0))
    assert terms(machine(asked(["thermal_growth"]), tmp_path, still), "thermal_growth") == []


def two_files(folder: Path, one: Asked) -> tuple[Records, Array]:
    benches = [wide(40, seed=1), wide(30, seed=2)]
    paths = [
        write_csv(folder / f"day {number}.csv", bench.columns(gauge(bench.load, bench.travel)))
        for number, bench in enumerate(benches)
    ]
    return read_records(paths, offer_of(one.model), one.setup), np.concatenate([bench.travel for bench in benches])


@pytest.mark.parametrize("per_file", [("lead_error",), ("lead_error.lead",)])
def test_an_unknown_of_every_file_has_a_column_for_each(tmp_path: Path, per_file: tuple[str, ...]) -> None:
    one = asked(["lead_error"])
    records, travel = two_files(tmp_path, one)
    setup = replace(one.setup, diagnose=DiagnoseOptions(per_file=per_file))
    (split,) = terms(machine_of(setup, records), "lead_error")
    assert split.files == (0, 1)
    assert split.unknowns == ("lead", "lead")
    assert split.size == 2
    for number, curve in enumerate(split.curves):
        assert_allclose(curve["deflection"], np.where(records.file_of == number, travel * 1e-3, 0), atol=1e-15)
    (shared,) = terms(machine_of(one.setup, records), "lead_error")
    assert (shared.files, shared.size) == ((-1,), 1)


def test_an_input_of_every_file_is_a_machine_for_each(tmp_path: Path) -> None:
    one = asked(tolerances={"contact": "3 %", "shaft": "3 %"})
    records, _ = two_files(tmp_path, one)
    setup = replace(one.setup, diagnose=DiagnoseOptions(per_file=("contact",)))
    there = machine_of(setup, records)
    assert [(item.name, item.file) for item in there.inputs] == [("contact", 0), ("contact", 1), ("shaft", -1)]
    slopes = there.slopes["deflection"]
    assert not slopes[records.file_of == 1, 0].any()
    assert not slopes[records.file_of == 0, 1].any()


def test_the_prior_of_an_input_lies_at_its_nominal_with_its_deviation(tmp_path: Path) -> None:
    bench = wide(50)
    there = machine(asked(tolerances={"contact": "3 %", "zero": "5 um"}), tmp_path, bench)
    assert [(item.name, item.mean) for item in there.inputs] == [("contact", 0.0), ("zero", 0.0)]
    assert_allclose([item.sd for item in there.inputs], [0.09 * UM, 5 * UM])
    contact = np.sign(bench.load) * np.abs(bench.load) ** (2 / 3)
    assert_allclose(there.slopes["deflection"] / UM, np.column_stack([0.09 * contact, np.full(50, 5.0)]), rtol=1e-6)
    assert_allclose(there.shifts["deflection"], 0)


def error_and_angle(found: Sequence[Term], exact: Sequence[Array]) -> tuple[Array, Array]:
    """By term how far its curve lies from the exact one, relative; and the angle of the exact one to the next, rad."""
    made = [term.curves[0]["deflection"] for term in found]
    errors = [np.linalg.norm(a - b) / np.linalg.norm(b) for a, b in zip(made, exact, strict=True)]
    cosines = [a @ b / np.sqrt((a @ a) * (b @ b)) for a, b in pairwise(exact)]
    return np.array(errors), np.arccos(cosines)


def test_the_grid_of_a_time_constant_leaves_no_gap(tmp_path: Path) -> None:
    """Nine values are those of the model; curves between them are interpolated, to a thousandth of their size."""
    bench = wide(200)
    found = terms(machine(asked(["warm_up"]), tmp_path, bench), "warm_up")
    constants = np.array([term.shape["time_constant"] / 3600 for term in found])
    assert (np.diff(constants) > 0).all()
    errors, angles = error_and_angle(found, [1 - np.exp(-bench.time / constant) for constant in constants])
    assert_allclose(constants[errors < 1e-9], np.geomspace(0.1, 20, 9))
    assert errors.max() < 1e-3
    assert angles.max() < 0.07
    assert {term.size for term in found} == {2}


def test_a_grid_is_refined_where_neighbours_differ_too_much(tmp_path: Path) -> None:
    """Of exp(-x/a) and exp(-x/b) the cosine is 2 sqrt(a b) / (a + b): 0.94 where nine widths go from 1 to 300 mm.

    The model is asked for widths between them until neighbours are at 0.97, and interpolated between those.
    """
    bench = replace(wide(3000), travel=np.linspace(0, 300, 3000))
    found = terms(machine(asked(more=["fading"]), tmp_path, bench), "fading")
    widths = np.array([term.shape["width"] for term in found])
    ratio = (300.0) ** (1 / 8)
    assert 2 * np.sqrt(ratio) / (1 + ratio) < 0.97
    curves = np.exp(-bench.travel[:, None] * 1e-3 / widths).T
    errors, angles = error_and_angle(found, list(curves))
    asked_for = errors < 1e-9
    assert 9 < asked_for.sum() <= 17
    assert np.cos(error_and_angle(np.array(found)[asked_for], curves[asked_for])[1]).min() > 0.97
    assert errors.max() < 2e-3
    assert angles.max() < 1.05 * 0.07  # values are even in their logarithm, which is not quite even in angle


def test_whole_numbers_are_tried_one_by_one_and_steps_at_places_of_the_record(tmp_path: Path) -> None:
    there = machine(asked(), tmp_path, wide(100))
    (order,) = candidate(there, "periodic_order_of_rotation")[1].shapes
    assert grid_of(order, there) == [1.0, 2.0, 3.0]
    (after,) = candidate(there, "step")[1].shapes
    places = np.array(grid_of(after, there)) / 3600
    assert 90 <= len(places) <= 100
    assert_allclose([places.min(), places.max()], [5 * 10 / 99, 95 * 10 / 99], atol=10 / 99)  # five rows on either side
    assert_allclose(np.diff(places).max(), 10 / 99)  # every row between is a place
    long = machine(asked(), tmp_path, wide(1000))
    places = np.array(grid_of(after, long)) / 3600
    assert len(places) == 100
    assert_allclose(np.diff(places), 0.1, atol=2 * 10 / 999)


def test_one_curve_under_several_names_goes_by_the_weakest_claim(tmp_path: Path) -> None:
    bench = wide(120)
    steady = replace(bench, temperature=20 + 2.5 * bench.time)
    found = problem(asked(["thermal_growth"]), tmp_path, steady)
    kept = {found.candidates[place].name: set(same) for place, same in found.same_as.items()}
    assert kept["sensor_drift"] == {"thermal_growth", "thermal_drift"}  # the kernel's, the first declared
    assert not {"thermal_growth", "thermal_drift"} & kept.keys()


def test_of_two_of_the_model_the_first_declared_and_the_one_with_fewer_unknowns_goes_first(tmp_path: Path) -> None:
    bench = wide(120)
    found = problem(asked(more=["lead_again", "skewed"]), tmp_path, bench)
    assert {found.candidates[place].name: same for place, same in found.same_as.items()}["lead_again"] == ("skewed",)
    found = problem(asked(["lead_error"], more=["skewed", "lead_again"]), tmp_path, bench)
    kept = {found.candidates[place].name: set(same) for place, same in found.same_as.items()}
    assert kept["lead_error"] == {"lead_again", "skewed"}
    found = problem(asked(more=["skewed", "lead_again"]), tmp_path, bench)
    kept = {found.candidates[place].name: set(same) for place, same in found.same_as.items()}
    assert kept["lead_again"] == {"skewed"}  # declared later, but with one unknown instead of two


def test_curves_that_differ_only_by_what_is_tolerated_are_one(tmp_path: Path) -> None:
    bench = wide(120)
    warmer = replace(bench, temperature=27 + 2.5 * bench.time)  # growth is a drift and an offset
    apart = problem(asked(["thermal_growth"]), tmp_path, warmer)
    assert {"sensor_drift", "thermal_drift"} <= {apart.candidates[place].name for place in apart.same_as}
    alike = problem(asked(["thermal_growth"], tolerances={"zero": "1 m"}), tmp_path, warmer)
    kept = {alike.candidates[place].name: set(same) for place, same in alike.same_as.items()}
    assert kept["sensor_drift"] == {"thermal_growth", "thermal_drift"}


def test_shapes_that_reproduce_a_cause_are_known_and_never_beside_it(tmp_path: Path) -> None:
    found = problem(asked(["lead_error", "thermal_growth", "clearance"]), tmp_path, warming(120))
    is_like = {}
    for place, term in enumerate(found.terms):
        curve = term.curves[0]["deflection"] / UM
        for owner, shape in enumerate(found.shape_pieces):
            columns = np.column_stack([found.columns[column].parts["deflection"] for column in shape.columns])
            left = curve - columns @ np.linalg.lstsq(columns, curve)[0]
            share = 1 - left @ left / (curve @ curve)
            if len(term.curves) == 1 and abs(share - 0.98) > 1e-6:
                key = (found.terms[place].candidate, owner)
                is_like[key] = is_like.get(key, False) or share > 0.98
    assert 10 < sum(is_like.values()) < len(is_like) / 2
    for key, expected in is_like.items():
        assert (key in found.like) == expected
    beside = mixed(found.term_pieces, found.shape_pieces, found.like)
    assert not {(item.pieces[0].owner, item.pieces[1].owner) for item in beside} & found.like


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
    there = machine(asked(), tmp_path, bench)
    found = library_of(there.records, {"rotation": frozenset({1, 2, 3})}, has_steps=True)
    assert sorted(shape.detail for shape in found.shapes if shape.kind == "order") == [4, 5]
    free = machine(asked(), tmp_path, wide(96))
    found = library_of(free.records, {"rotation": frozenset({1, 2, 3})}, has_steps=True)
    assert sorted(shape.detail for shape in found.shapes if shape.kind == "order") == list(range(4, 17))


def test_every_shape_over_what_moved_and_nothing_over_what_stood_still(tmp_path: Path) -> None:
    bench = replace(wide(80), temperature=np.full(80, 23.0))
    there = machine(asked(), tmp_path, bench)
    found = library_of(there.records, {}, has_steps=False)
    kinds = {(shape.kind, shape.depends_on) for shape in found.shapes}
    assert {depends for kind, depends in kinds if kind == "trend"} == {
        ("load",), ("travel",), ("rotation",), ("time",)
    }  # fmt: skip
    assert len([1 for kind, _ in kinds if kind == "product"]) == 6
    assert {("order", ("rotation",)), ("cycle", ("time",)), ("step", ("time",))} <= kinds
    assert not any("temperature" in depends for _, depends in kinds)
    values = {name: item.values for name, item in there.records.covariates.items()}
    for basis in found.bases:
        assert_allclose(eval(basis.expression, {"np": np, **values}) * np.ones(80), basis.values, atol=1e-12)


def test_places_of_a_step_are_thinned_in_pairs_but_not_the_favourite(tmp_path: Path) -> None:
    found = problem(asked(["lead_error"]), tmp_path, wide(200))
    every = variants(found, "step")
    thinned = [piece for piece in terms_for_pairs(found) if piece in every]
    assert len(every) == 100
    assert 20 <= len(thinned) <= 25
    assert np.ptp(np.diff([every.index(piece) for piece in thinned])) == 0
    favourite = next(piece for piece in every if piece not in thinned)
    kept = terms_for_pairs(found, frozenset({favourite.place}))
    assert favourite in kept
    assert {piece.owner for piece in kept} == {piece.owner for piece in found.term_pieces}
    few = [piece for piece in terms_for_pairs(found, sparse=True) if piece in every]
    assert len(few) == 6


def test_what_was_passed_over_in_pairs_is_looked_at_beside_the_best(tmp_path: Path) -> None:
    found = problem(asked(["lead_error"]), tmp_path, wide(200))
    every = variants(found, "step")
    thinned = [piece for piece in terms_for_pairs(found) if piece in every]
    assert {piece.place for tried in thinned for piece in near(found, tried)} >= {
        piece.place for piece in every if piece not in thinned
    }
    (lead,) = variants(found, "lead_error")
    assert near(found, lead) == []
    middle = thinned[10]
    pair = Hypothesis("two", (lead, middle), -1.0)
    finer = _finer(found, Found((pair,), np.array([5.0]), np.array([9.0]), ((0,),)))
    assert {item.key for item in finer} == {pair.key}
    at = every.index(middle)
    between = every.index(thinned[11]) - at
    looked = {item.pieces[1].place for item in finer}
    assert looked == {piece.place for piece in every[at - between : at + between + 1]} - {middle.place}
    assert {item.pieces[0] for item in finer} == {lead}


def test_an_effect_whose_condition_nobody_measured_is_left_out(tmp_path: Path) -> None:
    one = asked(["thermal_growth", "lead_error"])
    columns = wide(40).columns(np.zeros(40))
    del columns["temperature"]
    there = machine_of(one.setup, one.records(tmp_path, columns))
    names = {item.name for item in candidates_of(there)}
    assert "lead_error" in names
    assert not {"thermal_growth", "thermal_drift"} & names
    assert EFFECTS["thermal_growth"].needs[0].name in there.records.absent
