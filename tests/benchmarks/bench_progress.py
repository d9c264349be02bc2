"""Every shipped calculation and diagnosis that takes its time says how far it has come.

Run it: ``python -m pytest tests/benchmarks/bench_progress.py -s``. Time is that of the processor, so that a busy
machine makes no study long.
"""

import time
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from shared import ROOT
from truing import Kernel
from truing.calculation import calculate
from truing.diagnosis.engine import diagnose
from truing.diagnosis.reading import read_records
from truing.example_file import example_text
from truing.inputs_file import read_setup, setup_from_text

OFFERS = Kernel.installed().offers
MORE = {
    "harmonic_fractal": ["studies.reliability.draws=200000"],
    "press_linkage": ["studies.reliability.draws=2000000", "studies.sensitivity.sobol=65536"],
    "roller_screw_shift": [
        "studies.shift.points=200001",
        "studies.shift.ratios=[1.2, 1.25, 1.3, 1.35, 1.4, 1.42]",
        "studies.optimise.generations=120",
    ],
    "rv_gearing": ["studies.reliability.draws=400000"],
    "rv_wear": ["studies.reliability.draws=300000", "studies.surrogate.design=300"],
}
LONG = 2.0
"""Seconds after which work owes word of its progress."""
LEAST_STEPS = 10
LONGEST_SILENCE = 0.4
"""The share of its time that work may pass without a word, unless it is short."""


def listen(name: str, work: Callable[..., Any]) -> None:
    """Do some work, and demand that it speaks often enough, and of shares from nothing to all."""
    words: list[tuple[float, float]] = []
    begin = time.process_time()
    work(progress=lambda _, done, total: words.append((time.process_time() - begin, done / total if total else 0.0)))
    seconds = time.process_time() - begin
    silence = max(after - before for before, after in pairwise([0.0, *(when for when, _ in words), seconds]))
    shares = {share for _, share in words}
    print(f"{name:26} {seconds:7.2f} s {len(words):6} words, silent for {silence:.2f} s")
    if seconds > LONG:
        assert len(shares) >= LEAST_STEPS
        assert silence <= max(LONGEST_SILENCE * seconds, LONG)
        assert all(0 <= share <= 1 for share in shares)


@pytest.mark.parametrize(
    ("name", "overrides"),
    [*((name, []) for name in OFFERS), *MORE.items()],
    ids=[*(f"{name}-shipped" for name in OFFERS), *(f"{name}-more" for name in MORE)],
)
def test_long_studies_speak(name: str, overrides: list[str]) -> None:
    offer = OFFERS[name]
    example = offer.model.example
    file, folder = (str(example), example.parent) if example is not None else ("example.toml", Path.cwd())
    setup = setup_from_text(example_text(offer), offer, file=file, folder=folder, overrides=overrides)
    listen(name, lambda progress: calculate(setup, progress=progress))


@pytest.mark.parametrize(
    ("name", "files"),
    [
        ("press_linkage", ["press_off_by_40_um/measured.csv"]),
        ("press_linkage", ["press_warm_links/monday.csv", "press_warm_links/tuesday.csv"]),
        ("roller_screw_shift", ["roller_screw_rubs/measured.csv"]),
    ],
)
def test_a_diagnosis_speaks(name: str, files: list[str]) -> None:
    offer, places = OFFERS[name], [ROOT / "docs" / "examples" / file for file in files]
    setup = read_setup(places[0].parent / "inputs.toml", offer)
    records = read_records(places, offer, setup)
    listen(name, lambda progress: diagnose(setup, records, progress=progress))
