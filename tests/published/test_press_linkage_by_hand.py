"""What ``calc run press_linkage`` writes, against the same press calculated a second time from its loops alone."""

import re
from math import radians, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import press_by_hand as by_hand
import pytest

import press_linkage
from truing import Kernel
from truing.calculation import calculate
from truing.inputs_file import setup_from_settings
from truing.runs.documents import results_document
from truing.runs.provenance import provenance_of

PRESSES = pytest.mark.parametrize("press", [by_hand.PAPER, by_hand.CHANGED], ids=["paper", "changed"])
READINGS = pytest.mark.parametrize("reading", ["printed", "complete"])
PLACES = pytest.mark.parametrize(
    ("press", "degrees"),
    [(by_hand.PAPER, 0.0), (by_hand.PAPER, -100.0), *((by_hand.CHANGED, at) for at in (-40.0, 0.0, 25.0, 130.0))],
)
CHECKS = ("slider_position", "slider_tilt")
SI = {"mm": 1e-3, "m": 1.0, "urad": 1e-6, "mrad": 1e-3}
OFF = {name: 1e-3 * size for name, size in zip(by_hand.SOURCES, np.sin(np.arange(1.0, 30.0)).tolist(), strict=True)}


def calculated(*changed: str) -> dict[str, Any]:
    """The document that becomes results.json, without the sheet beside it."""
    settings = dict(text.split("=", 1) for text in changed)
    setup = setup_from_settings(Kernel([press_linkage], strict=True).offers["press_linkage"], settings)
    document: dict[str, Any] = results_document(calculate(setup), provenance_of(setup))
    return document


def si(entry: dict[str, Any]) -> float:
    """A value with its unit in SI, by a table of our own."""
    above, _, below = entry["unit"].partition("/")
    value: float = entry.get("value", entry.get("derivative"))
    return value * SI[above] / (SI[below] if below else 1.0)


def sizes(press: by_hand.Values) -> list[str]:
    return [f"{name}={size!r} {'rad' if name.endswith('angle') else 'm'}" for name, size in press.items()]


@PLACES
def test_position_and_all_29_derivatives(press: by_hand.Values, degrees: float) -> None:
    found = calculated(*sizes(press), f"crank_angle={degrees} deg", 'studies.run=["sensitivity"]')
    position, _ = by_hand.slider(by_hand.closed(press, radians(degrees)), press)
    assert si(found["results"]["slider_position"]) == pytest.approx(position, abs=1e-13)
    assert found["results"]["slider_tilt"]["value"] == 0.0
    slopes = by_hand.derivatives(press, radians(degrees))
    for place, result in enumerate(CHECKS):
        entries = found["studies"]["sensitivity"][result]
        assert set(entries) == set(by_hand.SOURCES)
        for name, entry in entries.items():
            assert si(entry) == pytest.approx(slopes[name][place], abs=1e-13), (result, name)


@PRESSES
def test_exact_position_with_every_part_off(press: by_hand.Values) -> None:
    """Errors of up to a millimetre and a milliradian, all 29 different, through twelve equations and through ours."""
    off = [f"{name}={1e3 * size!r} {'mrad' if '_angle_' in name else 'mm'}" for name, size in OFF.items()]
    found = calculated(*sizes(press), *off, "crank_angle=-40 deg", 'studies.run=["sensitivity"]')
    position, tilt = by_hand.slider(by_hand.closed(press, radians(-40.0), OFF), press)
    assert abs(tilt) > 1e-4
    assert si(found["results"]["slider_position"]) == pytest.approx(position, abs=1e-13)
    assert si(found["results"]["slider_tilt"]) == pytest.approx(tilt, abs=1e-13)
    slopes = by_hand.derivatives(press, radians(-40.0), OFF)
    for place, result in enumerate(CHECKS):
        for name, entry in found["studies"]["sensitivity"][result].items():
            assert si(entry) == pytest.approx(slopes[name][place], abs=1e-13), (result, name)


@READINGS
def test_reliabilities_synthesis_and_least_cost(reading: str) -> None:
    found = calculated(f"reading={reading}")
    slopes = by_hand.derivatives(by_hand.PAPER, 0.0)
    start = by_hand.chances(slopes, reading, dict.fromkeys(by_hand.LINKS, "IT7"))
    results, allocation = found["results"], found["studies"]["allocation"]
    assert results["position_reliability"]["value"] == pytest.approx(start[0], abs=1e-9)
    assert results["tilt_reliability"]["value"] == pytest.approx(start[1], abs=1e-9)
    assert allocation["coefficients"] == pytest.approx(by_hand.coefficients(slopes), rel=1e-7)
    steps = list(by_hand.steps(slopes, reading))
    assert len(steps) == {"printed": 9, "complete": 12}[reading]
    assert [(step["tolerance"], step["to"]) for step in allocation["steps"]] == [step[:2] for step in steps]
    for ours, theirs in zip(allocation["steps"], steps, strict=True):
        assert [ours["probabilities"][name] for name in CHECKS] == pytest.approx(list(theirs[2]), abs=1e-9)
    assert results["position_reliability_final"]["value"] == pytest.approx(steps[-1][2][0], abs=1e-9)
    assert results["tilt_reliability_final"]["value"] == pytest.approx(steps[-1][2][1], abs=1e-9)
    _scatter_is_written_in_its_units(found, slopes, reading)
    best, least = by_hand.cheapest(slopes, reading), allocation["least_cost"]
    assert least["reached"] == allocation["reached"] == (best is not None)
    if best is not None:
        assert least["cost"] == {"value": pytest.approx(best[0], rel=1e-12), "unit": "1/mm"}
        assert least["tolerances"] == best[1]


def _scatter_is_written_in_its_units(found: dict[str, Any], slopes: Any, reading: str) -> None:
    """Standard deviations of the sources, as results.json states them, and of both results to first order."""
    scatter = by_hand.deviations(reading, dict.fromkeys(by_hand.LINKS, "IT7"))
    stated = {name: entry for item in found["tolerances"].values() for name, entry in item["on"].items()}
    assert {name: entry["sd"] * SI[entry["unit"]] for name, entry in stated.items()} == pytest.approx(
        scatter, rel=1e-12
    )
    for place, name in enumerate(CHECKS):
        entry = found["studies"]["reliability"][name]
        sd = sqrt(sum((slopes[source][place] * size) ** 2 for source, size in scatter.items()))
        assert entry["first_order_sd"] * SI[entry["unit"]] == pytest.approx(sd, rel=1e-8, abs=0.0)


@READINGS
def test_monte_carlo_draws_the_machines_of_the_loops(reading: str) -> None:
    """Two samples of the same machines, by two programs: they differ by their sampling errors only."""
    run = calculated(f"reading={reading}", 'studies.run=["reliability"]')
    machines = 60_000
    for name, values, limit in zip(CHECKS, by_hand.drawn(reading, machines, 7), by_hand.limits(reading), strict=True):
        ours = run["studies"]["reliability"][name]
        share = float(np.mean(np.abs(values) <= limit))
        error = sqrt(share * (1 - share) * (1 / machines + 1 / ours["draws"]))
        assert abs(ours["probability"] - share) < 4 * error
        apart = ours["sd"] * SI[ours["unit"]] / float(np.std(values)) - 1
        assert abs(apart) < 4 * sqrt(0.5 / machines + 0.5 / ours["draws"])


def test_the_second_calculation_shares_no_code_with_the_first() -> None:
    imported = re.findall(r"^(?:import|from) (\w+)", Path(by_hand.__file__).read_text(encoding="utf-8"), re.MULTILINE)
    assert set(imported) == {"collections", "itertools", "statistics", "typing", "numpy", "scipy"}
