"""The workbench of a study of one's own: another design, its machines, and many calculations at once."""

from dataclasses import replace

import numpy as np
import pytest
from study_models import CHAIN, setup_of

from truing import Bench, Reliability
from truing.calculation import calculate
from truing.evaluate import evaluate
from truing.executors import open_executor


def bench_of(**values: str) -> Bench:
    setup = setup_of(CHAIN, **values)
    results = evaluate(setup)
    return Bench(setup, results, open_executor("serial"), setup.model.read_results(results))


def test_another_design_has_its_own_results_and_leaves_the_first_alone() -> None:
    bench = bench_of()
    name = next(iter(CHAIN.input_fields))
    value = float(bench.setup.nominal(name))
    moved = bench.changed({name: value + 1e-3})
    assert moved.answers["gap"] != bench.answers["gap"]
    assert moved.answers["gap"] == setup_results(moved)["gap"]
    assert float(bench.setup.nominal(name)) == value


def setup_results(bench: Bench) -> dict[str, float]:
    found: dict[str, float] = bench.setup.model.read_results(evaluate(bench.setup))
    return found


def test_another_width_scatters_accordingly() -> None:
    bench = bench_of()
    name, inner = next(iter(bench.setup.distributions().items()))
    width = next(iter(inner.values())).width
    wide = bench.changed({}, {name: 2 * width}).setup.distributions()[name]
    assert next(iter(wide.values())).sd == pytest.approx(2 * next(iter(inner.values())).sd, rel=1e-12)


def test_drawn_machines_are_the_first_of_the_reliability() -> None:
    """As many as one batch of the study: the same mean to the last digit."""
    bench = bench_of()
    odds = calculate(replace(bench.setup, studies=(Reliability(draws=500),))).outcomes["reliability"]
    gaps = bench.rows(bench.drawn(500), 500, "gap")["gap"]
    assert gaps.shape == (500,)
    assert np.mean(gaps) == pytest.approx(odds.mean["gap"], rel=1e-12)
    assert (np.min(gaps), np.max(gaps)) == (odds.moments["gap"].smallest, odds.moments["gap"].largest)


def test_the_inputs_are_those_of_the_setup_without_effects() -> None:
    bench = bench_of()
    assert bench.inputs == bench.setup.inputs
