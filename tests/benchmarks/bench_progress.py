"""Every study of every shipped calculation that takes its time says how far it has come.

Time is that of the processor, so that a busy machine makes no study long.

pytest tests/benchmarks/bench_progress.py -s
"""

import time
from pathlib import Path

import pytest

from progress_seen import Seen, watched
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


@pytest.mark.parametrize("asked", ["shipped", "more"])
@pytest.mark.parametrize("name", list(OFFERS))
def test_long_studies_speak(name: str, asked: str, monkeypatch: pytest.MonkeyPatch) -> None:
    offer = OFFERS[name]
    if asked == "more" and name not in MORE:
        pytest.skip("nothing to ask more of")
    example = offer.model.example
    file, folder = (str(example), example.parent) if example is not None else ("example.toml", Path.cwd())
    overrides = MORE[name] if asked == "more" else []
    setup = setup_from_text(example_text(offer), offer, file=file, folder=folder, overrides=overrides)
    with watched(monkeypatch, {type(study) for study in setup.studies}, time.process_time) as seen:
        calculate(setup)
    for one in seen:
        print(f"{name:26} {one.name:16} {one.seconds:7.2f} s {len(one.words):6} words")
    assert len(seen) == len(setup.studies)
    assert not [fault for one in seen for fault in one.faults]


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
    words: list[tuple[float, float]] = []
    begin = time.process_time()
    diagnose(setup, records, progress=lambda _, done, total: words.append((time.process_time() - begin, done / total)))
    seen = Seen("diagnosis", time.process_time() - begin, tuple(words))
    print(f"{name:26} {seen.name:16} {seen.seconds:7.2f} s {len(words):6} words")
    assert not seen.faults
