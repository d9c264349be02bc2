"""A load spectrum: against an independent integration of the wear, closed limits, and the count of the reliability."""

from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from hidden_effects.rv_machine import PSI, Wearing
from pages import Page
from rv_wear.machines import chances
from rv_wear.model import RV_WEAR
from rv_wear.spectrum import LoadBlock, LoadSpectrum, flank_history, life_of, lived, read_block
from truing import Kernel, Reliability, TruingError
from truing.calculation import calculate
from truing.setup import default_setup

HOUR = 3600.0
RATED = "3136 N*m, 15 r/min"
OFFER = Kernel.installed(strict=True).offer("rv_wear")
REDUCER = RV_WEAR.inputs()
MIXED = ("3136 N*m, 10 r/min, 30 %, forward", "1500 N*m, 20 r/min, 40 %, forward", "2000 N*m, 15 r/min, 20 %, back")
PAGE = Page("rv_wear")


@lru_cache(maxsize=8)
def spectrum(loads: tuple[str, ...], reversing: float | None = None) -> Any:
    """The study, with the reliability beside it that counts the same machines."""
    setup = default_setup(OFFER.model, OFFER.origin)
    if reversing is not None:
        setup = setup.changed({"reversing": reversing})
    studies = (Reliability(draws=20_000, gives=chances), LoadSpectrum(loads=loads, gives=lived))
    return calculate(replace(setup, studies=studies))


def depth(loads: tuple[str, ...], sense: int, hours: float) -> float:
    """Deepest wear, um."""
    blocks = [read_block(text) for text in loads]
    return float(flank_history(REDUCER, blocks, sense, hours * HOUR).after(np.asarray(hours * HOUR))) * 1e6


def test_a_mixture_wears_as_an_independent_integration_has_it() -> None:
    """Both loads on one profile, by the midpoint rule over 12 positions, forces by halving."""
    loads = ((3136.0, 10.0, 0.3), (1500.0, 20.0, 0.4))
    wearings = [Wearing(torque, 0.694e-3) for torque, _, _ in loads]
    turns = [60 * speed * share for _, speed, share in loads]  # per hour

    def rate(worn: Any) -> Any:
        return sum(count * each.per_turn(worn) for count, each in zip(turns, wearings, strict=True))

    worn, steps = np.zeros_like(PSI), 40
    for _ in range(steps):
        step = 6000 / steps
        worn = worn + step * rate(worn + rate(worn) * step / 2)
    fine = replace(REDUCER, reconstruction_depth=0.005e-6)
    ours = flank_history(fine, [read_block(text) for text in MIXED], 1, 6000 * HOUR).after(np.asarray(6000 * HOUR))
    assert float(ours) * 1e3 == pytest.approx(float(worn.max()), rel=2e-3)


def test_the_rated_load_all_the_time_is_the_wear_of_the_paper() -> None:
    assert depth((f"{RATED}, 100 %, forward",), 1, 6000) == pytest.approx(3.1288, abs=1e-3)
    assert depth((f"{RATED}, 100 %, forward",), -1, 6000) == 0.0


def test_a_load_in_two_parts_is_the_load() -> None:
    parts = (f"{RATED}, 20 %, forward", "3136 N*m, 30 r/min, 15 %, forward")
    assert depth(parts, 1, 6000) == pytest.approx(depth((f"{RATED}, 50 %, forward",), 1, 6000), rel=1e-9)


def test_without_loads_it_is_even_reversing_machine_by_machine() -> None:
    """Counted by the reliability with reversing = 1, which has its own way to the wear of both flanks."""
    run = spectrum((), reversing=1.0)
    told = run.answers
    assert float(told["wear_forward"]) == pytest.approx(float(told["max_wear"]), rel=1e-3)
    assert float(told["wear_back"]) == pytest.approx(float(told["wear_forward"]), rel=1e-12)
    assert float(told["spectrum_backlash"]) == pytest.approx(float(told["backlash"]), rel=1e-4)
    assert float(told["spectrum_reliability"]) == pytest.approx(float(told["accuracy_reliability"]), abs=2e-3)


def test_without_loads_the_hours_of_each_flank_are_those_of_reversing() -> None:
    """Always the same flank: the other never wears, and the backlash feels one flank, as the model itself has it."""
    told = spectrum((), reversing=0.0).answers
    assert float(told["wear_forward"]) == pytest.approx(float(told["max_wear"]), rel=1e-3)
    assert float(told["wear_back"]) == 0.0
    assert float(told["spectrum_backlash"]) == pytest.approx(float(told["backlash"]), rel=1e-4)


def test_a_flank_on_a_film_that_carries_everywhere_does_not_wear() -> None:
    thick = replace(REDUCER, film_factor=1e9, sliding_factor=1.0)
    assert flank_history(thick, [read_block("3136 N*m, 15 r/min, 50 %, back")], -1, HOUR).depth.max() == 0.0


def test_every_machine_is_at_its_limit_when_its_life_ends() -> None:
    """The life of three machines, found again with the model itself: there the backlash is the permitted one."""
    run = spectrum((), reversing=1.0)
    outcome = run.outcomes["load_spectrum"]
    for machine in (0, 1, 2):
        base, faster = outcome.machines.without_wear[machine], outcome.machines.faster[machine]

        def beyond(hours: float, base: float = base, faster: float = faster) -> float:
            reducer = replace(REDUCER, reversing=1.0, working_time=hours * HOUR, wear_rate_factor=faster)
            return float(base + OFFER.model.function(reducer).backlash_of_wear - REDUCER.permitted_backlash)

        assert outcome.life[machine] / HOUR == pytest.approx(brentq(beyond, 1000, 100_000), rel=2e-3)


def test_old_oil_shortens_the_life_by_the_clock() -> None:
    setup = default_setup(OFFER.model, OFFER.origin).changed({"ageing_rate": 1e-4 / HOUR})
    aged = calculate(replace(setup, studies=(LoadSpectrum(draws=200, gives=lived),))).outcomes["load_spectrum"]
    fresh = calculate(
        replace(default_setup(OFFER.model, OFFER.origin), studies=(LoadSpectrum(draws=200, gives=lived),))
    ).outcomes["load_spectrum"]
    hours = aged.life / HOUR
    assert hours * (1 + 0.5e-4 * hours) == pytest.approx(fresh.life / HOUR, rel=1e-6)


def test_the_life_of_a_share_is_the_longest_that_so_many_reach() -> None:
    life = np.arange(1.0, 11.0)
    assert [life_of(life, share) for share in (0.9, 0.5, 1.0)] == [2.0, 6.0, 1.0]


@pytest.mark.parametrize(
    ("loads", "words"),
    [
        (("3136 N*m, 15 r/min, 50 %",), "write torque, speed, share"), ((f"{RATED}, 50 %, up",), "forward or back"),
        ((f"{RATED}, 60 %, forward", f"{RATED}, 60 %, back"), "take 120 % of the hours"),
        (("3136 mm, 15 r/min, 50 %, back",), "is no load"), ((f"{RATED}, 0 %, back",), "lie above 0"),
    ],
)  # fmt: skip
def test_a_load_that_cannot_be_is_refused(loads: tuple[str, ...], words: str) -> None:
    with pytest.raises(TruingError, match=words):
        LoadSpectrum(loads=loads)


def test_a_load_is_read_with_its_units() -> None:
    assert read_block("1.5 kN*m, 0.25 r/s, 40 %, back") == LoadBlock(1500.0, 0.25, 0.4, -1)


def test_what_the_page_says() -> None:
    told: Any = spectrum(()).answers
    life, nine = (
        f"{float(told[name]) / HOUR:,.0f}".replace(",", " ") for name in ("spectrum_life", "spectrum_life_90")
    )
    wear, backlash = float(told["wear_back"]) * 1e6, float(told["spectrum_backlash"]) * 10800 / np.pi
    PAGE.says(
        f"each flank wears {wear:.3f} µm in 6000 h, the backlash is {backlash:.3f}′",
        f"{100 * float(told['spectrum_reliability']):.2f} % of the machines are within 1′",
        f"Half of the machines reach {life} h, 90 % reach {nine} h",
    )
