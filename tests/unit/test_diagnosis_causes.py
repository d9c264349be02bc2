"""What competes in a diagnosis: effects and inputs with their numbers, and names for one curve."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnosis_models import (
    EFFECTS,
    SKEWED,
    UM,
    Array,
    Asked,
    Bench,
    Deflection,
    Drive,
    drive_model,
    gauge,
    offer_of,
    wide,
    write_csv,
)
from numpy.testing import assert_allclose

from truing import Effect, Float, Unknown
from truing.diagnosis.causes import Candidate, at_rest, effects_of, idle_of, inputs_of
from truing.diagnosis.curves import PLACES, first_places, placed
from truing.diagnosis.extended import Extended
from truing.diagnosis.machine import Calibration, calibration_of
from truing.diagnosis.reading import read_records
from truing.diagnosis.records import Records
from truing.setup import DiagnoseOptions


def lead_again(screw: Drive, base: Deflection, *, pitch: Float) -> Deflection:
    """Follow the travel under another name."""
    return replace(base, deflection=base.deflection + pitch * screw.travel)


def eccentricity(screw: Drive, base: Deflection, *, sine: Float, cosine: Float) -> Deflection:
    """Go round with the screw, once per turn."""
    wave = sine * np.sin(screw.rotation) + cosine * np.cos(screw.rotation)
    return replace(base, deflection=base.deflection + wave)


MORE: Mapping[str, Effect[Drive, Deflection]] = {
    "skewed": SKEWED,
    "lead_again": Effect("lead_again", on_results=lead_again, unknowns=[Unknown("pitch", -1, 1, "um/mm")]),
    "eccentricity": Effect(
        "eccentricity",
        on_results=eccentricity,
        unknowns=[Unknown("sine", -50, 50, "um"), Unknown("cosine", -50, 50, "um")],
    ),
}


def asked(effects: Sequence[str] = (), more: Sequence[str] = (), tolerances: Mapping[str, str] | None = None) -> Asked:
    model = drive_model(effects, tolerances or {})
    return Asked(replace(model, errors=[*model.errors, *(MORE[name] for name in more)]))


def machine(one: Asked, folder: Path, bench: Bench) -> Calibration:
    return calibration_of(one.setup, one.records(folder, bench.columns(gauge(bench.load, bench.travel))))


def cause_of(there: Calibration, name: str) -> Candidate:
    (found,) = (cause for cause in effects_of(there) if cause.name == name)
    return found


def two_files(folder: Path, one: Asked) -> tuple[Records, Array]:
    benches = [wide(40, seed=1), wide(30, seed=2)]
    paths = [
        write_csv(folder / f"day {number}.csv", bench.columns(gauge(bench.load, bench.travel)))
        for number, bench in enumerate(benches)
    ]
    return read_records(paths, offer_of(one.model), one.setup), np.concatenate([bench.travel for bench in benches])


# Numbers


def test_a_cause_has_the_numbers_of_its_effect_in_si(tmp_path: Path) -> None:
    rise, constant = cause_of(machine(asked(["warm_up"]), tmp_path, wide(60)), "warm_up").numbers
    assert_allclose([rise.low, rise.high, constant.low, constant.high], [-1e-3, 1e-3, 360, 72_000])
    assert (rise.is_amplitude, rise.is_free, rise.is_log) == (True, True, False)
    assert (constant.is_amplitude, constant.is_free, constant.is_log) == (False, True, True)


@pytest.mark.parametrize("per_file", [("lead_error",), ("lead_error.lead",)])
def test_an_unknown_of_every_file_is_a_number_for_each(tmp_path: Path, per_file: tuple[str, ...]) -> None:
    one = asked(["lead_error"])
    records, travel = two_files(tmp_path, one)
    setup = replace(one.setup, diagnose=DiagnoseOptions(per_file=per_file))
    there = calibration_of(setup, records)
    split = cause_of(there, "lead_error")
    assert [(number.name, number.file) for number in split.numbers] == [("lead", 0), ("lead", 1)]
    alone, both = Extended(there).at([split], [([np.array(at)], np.zeros(0)) for at in ([2e-3, 0], [2e-3, 3e-3])])
    off = [made["deflection"] - there.base["deflection"] for made in (alone, both)]
    assert_allclose(off[0], np.where(records.file_of == 0, 2e-3 * travel * 1e-3, 0), rtol=1e-9, atol=1e-18)
    assert_allclose(off[1], np.where(records.file_of == 0, 2e-3, 3e-3) * travel * 1e-3, rtol=1e-9)
    shared = cause_of(calibration_of(one.setup, records), "lead_error")
    assert [number.file for number in shared.numbers] == [-1]


def test_an_input_of_every_file_is_a_machine_for_each(tmp_path: Path) -> None:
    one = asked(tolerances={"contact": "3 %", "shaft": "3 %"})
    records, _ = two_files(tmp_path, one)
    setup = replace(one.setup, diagnose=DiagnoseOptions(per_file=("contact",)))
    there = calibration_of(setup, records)
    assert [(item.name, item.file) for item in there.inputs] == [("contact", 0), ("contact", 1), ("shaft", -1)]
    slopes = there.slopes["deflection"]
    assert not slopes[records.file_of == 1, 0].any()
    assert not slopes[records.file_of == 0, 1].any()
    causes = inputs_of(there)
    assert [(cause.name, cause.tolerated) for cause in causes] == [
        ("input:contact", 0), ("input:contact", 1), ("input:shaft", 2),
    ]  # fmt: skip
    assert len({cause.tag for cause in causes}) == 3
    (made,) = Extended(there).at([causes[1]], [([np.array([2.0])], np.zeros(3))])
    assert_allclose(made["deflection"] - there.base["deflection"], 2 * slopes[:, 1], rtol=1e-6, atol=1e-15)


def test_the_prior_of_an_input_lies_at_its_nominal_with_its_deviation(tmp_path: Path) -> None:
    bench = wide(50)
    there = machine(asked(tolerances={"contact": "3 %", "zero": "5 um"}), tmp_path, bench)
    assert [(item.name, item.mean) for item in there.inputs] == [("contact", 0.0), ("zero", 0.0)]
    assert_allclose([item.sd for item in there.inputs], [0.09 * UM, 5 * UM])
    contact = np.sign(bench.load) * np.abs(bench.load) ** (2 / 3)
    assert_allclose(there.slopes["deflection"] / UM, np.column_stack([0.09 * contact, np.full(50, 5.0)]), rtol=1e-6)
    assert_allclose(there.shifts["deflection"], 0)


def test_an_input_that_moves_nothing_is_no_cause(tmp_path: Path) -> None:
    there = machine(
        asked(tolerances={"contact": "3 %", "zero": "5 um"}), tmp_path, replace(wide(30), load=np.zeros(30))
    )
    assert [cause.name for cause in inputs_of(there)] == ["input:zero"]


def test_whole_numbers_are_tried_one_by_one_and_steps_at_places_of_the_record(tmp_path: Path) -> None:
    there = machine(asked(), tmp_path, wide(100))
    order = cause_of(there, "periodic_order_of_rotation").numbers[-1]
    assert placed([order], first_places(order)[:, None]).ravel().tolist() == [1, 2, 3]
    after = cause_of(there, "step").numbers[-1]
    assert_allclose([after.low, after.high], np.array([0.2, 9.8]) * 3600)  # a fiftieth of ten hours from either end
    places = placed([after], first_places(after)[:, None]).ravel()
    assert_allclose(places, np.linspace(0.2, 9.8, PLACES) * 3600)
    assert not order.is_free
    assert not after.is_free


# Which


def test_an_effect_whose_condition_nobody_measured_is_left_out(tmp_path: Path) -> None:
    one = asked(["thermal_growth", "lead_error"])
    columns = wide(40).columns(np.zeros(40))
    del columns["temperature"]
    there = calibration_of(one.setup, one.records(tmp_path, columns))
    names = {cause.name for cause in effects_of(there)}
    assert "lead_error" in names
    assert not {"thermal_growth", "thermal_drift"} & names
    assert EFFECTS["thermal_growth"].needs[0].name in there.records.absent
    assert not {"thermal_growth", "thermal_drift"} & set(idle_of(there))


def test_an_effect_that_follows_what_never_moved_is_idle(tmp_path: Path) -> None:
    still = replace(wide(60), temperature=np.full(60, 31.0))
    there = machine(asked(["thermal_growth", "lead_error"]), tmp_path, still)
    assert not {"thermal_growth", "thermal_drift"} & {cause.name for cause in effects_of(there)}
    assert set(idle_of(there)) == {"thermal_growth", "thermal_drift"}


def test_causes_are_the_models_first_then_the_kernels_and_their_tags_differ(tmp_path: Path) -> None:
    found = effects_of(machine(asked(["wear", "lead_error"]), tmp_path, wide(60)))
    assert [cause.name for cause in found][:2] == ["wear", "lead_error"]
    assert [cause.is_kernel for cause in found] == [False, False, *[True] * (len(found) - 2)]
    assert len({cause.tag for cause in found}) == len(found)
    assert [cause.order for cause in found] == sorted(cause.order for cause in found)


def test_an_effect_at_rest_is_the_model_itself(tmp_path: Path) -> None:
    there = machine(asked(["stiffness_loss", "warm_up", "lead_error"]), tmp_path, wide(60))
    for cause in effects_of(there):
        rest = at_rest(cause, there)
        values = np.array([rest[number.name] for number in cause.numbers])
        (made,) = Extended(there).at([cause], [([values], np.zeros(0))])
        assert_allclose(made["deflection"], there.base["deflection"], rtol=1e-12, atol=1e-18)


# Names of one curve


def named(one: Asked, folder: Path, bench: Bench, error: Array) -> list[set[str]]:
    """The causes that are named, each with what draws the same, of a record with 1 um of noise."""
    noise = np.random.default_rng(3).normal(0, 1, len(bench))
    found = one.diagnosed(folder, bench.columns(gauge(bench.load, bench.travel) + error + noise))
    return [{f"first: {cause.effect}", *cause.same_as} for cause in found.causes]


def test_one_curve_under_several_names_goes_by_the_weakest_claim(tmp_path: Path) -> None:
    bench = wide(120)
    steady = replace(bench, temperature=20 + 2.5 * bench.time)
    names = named(asked(["thermal_growth"]), tmp_path, steady, 4 * bench.time)
    assert names == [{"first: sensor_drift", "thermal_growth", "thermal_drift"}]  # the kernel's, the first declared


def test_of_two_of_the_model_the_first_declared_and_the_one_with_fewer_unknowns_goes_first(tmp_path: Path) -> None:
    bench = wide(120)
    error = 0.1 * bench.travel
    several = asked(["lead_error"], more=["skewed", "lead_again"])
    assert named(several, tmp_path, bench, error) == [{"first: lead_error", "lead_again", "skewed"}]
    fewer = asked(more=["skewed", "lead_again"])  # declared later, but with one unknown instead of two
    assert named(fewer, tmp_path, bench, error) == [{"first: lead_again", "skewed"}]


def test_curves_that_differ_only_by_what_is_tolerated_are_one(tmp_path: Path) -> None:
    bench = wide(120)
    warmer = replace(bench, temperature=27 + 2.5 * bench.time)  # growth is a drift and an offset
    error = 4 * (warmer.temperature - 20)
    apart = named(asked(["thermal_growth"]), tmp_path, warmer, error)
    assert apart == [{"first: thermal_drift", "thermal_growth"}]
    alike = named(asked(["thermal_growth"], tolerances={"zero": "1 m"}), tmp_path, warmer, error)
    assert alike == [{"first: sensor_drift", "thermal_growth", "thermal_drift"}]


def test_the_first_order_of_a_gauge_goes_by_the_name_of_the_models_own(tmp_path: Path) -> None:
    """Two numbers and no order claim less than an order that could have been another; orders 2 and 3 stay apart."""
    bench, one = wide(150), asked(["lead_error"], more=["eccentricity"])
    first = 8 * np.sin(np.radians(bench.rotation) + 0.7)
    assert named(one, tmp_path, bench, first) == [{"first: eccentricity", "periodic_order_of_rotation"}]
    second = 8 * np.sin(2 * np.radians(bench.rotation) + 0.7)
    assert named(one, tmp_path, bench, second) == [{"first: periodic_order_of_rotation"}]
