"""Uncertainty of D and G carried to stiffness: as pairs it stays small, as two error bars it would be large."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from harmonic_fractal.contact import Rough, contact_of, interface_of, pressed
from harmonic_fractal.estimate import Estimation, estimate_of
from harmonic_fractal.flank import Flank
from harmonic_fractal.generators import brownian_profiles
from harmonic_fractal.model import HARMONIC_FRACTAL
from harmonic_fractal.quantities import Drive
from harmonic_fractal.structure import constant
from harmonic_fractal.surface import Lines, Surface
from harmonic_fractal.uncertainty import FLANKS, Propagated, Uncertainty, flank_samples, interval_about, slopes
from truing import Table, TruingError, Words
from truing.calculation import Calculation, calculate
from truing.setup import default_setup
from truing.studies.sampling import scatter_of

Array = NDArray[np.float64]
SPACING, LINES, POINTS = 0.4e-6, 100, 500
TRUTH: dict[str, Any] = {"fractal_dimension": 2.5, "fractal_roughness": 1e-9, "convention": "profile"}
STEP = float(constant(1.5, 1.5, "profile")) * 1e-9 * SPACING  # S at one spacing
TRIALS = 12


def lines_of(seed: int) -> Array:
    """Independent lines of fractional Brownian motion with that truth."""
    made: Array = brownian_profiles(1.5, STEP, (LINES, POINTS), np.random.default_rng(seed))
    return made


def flank_of(seed: int, resamples: int = 400) -> Flank:
    """A flank of such lines along x."""
    heights = lines_of(seed)
    found = estimate_of(Lines(heights, SPACING), "x", Estimation(fit="all", resamples=resamples, block=1, seed=seed))
    surface = Surface(heights, SPACING, SPACING, f"made {seed}")
    return Flank(raw=surface, surface=surface, estimates=(found,), chosen="x", reason="", warnings=())


def stiffness(rough: Rough) -> Any:
    """Stiffness of a pair under 25 N, N/m."""
    return pressed(25.0, contact_of(HARMONIC_FRACTAL.inputs(), rough)).stiffness


def of_pairs(pairs: Array) -> Array:
    return np.asarray(stiffness(Rough(dimension=pairs[:, 0], roughness=np.exp(pairs[:, 1]))))


def relative_sd(values: Array) -> float:
    return float(values.std(ddof=1) / values.mean())


@pytest.fixture(scope="module")
def flanks() -> list[Flank]:
    """Independent measurements of one truth."""
    return [flank_of(seed) for seed in range(TRIALS)]


@pytest.fixture(scope="module")
def run(flanks: list[Flank]) -> Calculation:
    """A drive with the first of them, its study with 1000 pairs."""
    setup = default_setup(HARMONIC_FRACTAL, surface=flanks[0], reference_torque="100 mN*m")
    return calculate(replace(setup, studies=(Uncertainty(draws=1000),)))


# Independent trials, against the table that was calculated beforehand: standard deviation 0.7 %


def test_resampled_pairs_know_the_scatter_of_trials(flanks: list[Flank]) -> None:
    claimed = np.array([relative_sd(of_pairs(flank.resampled)) for flank in flanks])
    assert claimed.mean() == pytest.approx(0.007, rel=0.35)


# The study


def test_study_says_both(run: Calculation) -> None:
    found = run.outcomes["uncertainty"]
    assert isinstance(found, Propagated)
    summary = found.summaries["stiffness"]
    assert 0.004 < summary.relative_sd < 0.012
    assert summary.independent_sd > 6.0 * summary.relative_sd
    assert summary.low < summary.median < summary.high
    assert summary.high - summary.low == pytest.approx(3.92 * summary.relative_sd * summary.median, rel=0.15)
    assert summary.median == pytest.approx(float(run.answers["stiffness"]), rel=2e-3)
    assert found.correlation > 0.98


def test_study_on_the_sheet_and_in_json(run: Calculation) -> None:
    found = run.outcomes["uncertainty"]
    document = json.loads(json.dumps(found.as_json(), allow_nan=False))
    assert document["results"]["stiffness"]["unit"] == "N/m"
    assert document["results"]["stiffness"]["if_independent"] > document["results"]["stiffness"]["relative_sd"]
    words, table = found.blocks()[:2]
    assert isinstance(words, Words)
    assert "times as much" in words.text
    assert isinstance(table, Table)
    assert [row[0] for row in table.rows] == [
        "stiffness", "clearance", "closing clearance", "dimension", "roughness", "mesh stiffness", "torsion"
    ]  # fmt: skip


def test_study_without_a_measured_flank_claims_nothing() -> None:
    run = calculate(replace(default_setup(HARMONIC_FRACTAL), studies=(Uncertainty(),)))
    found = run.outcomes["uncertainty"]
    assert found.as_json() == {"draws": 0}
    (words,) = found.blocks()
    assert isinstance(words, Words)
    assert "nothing is propagated" in words.text


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"draws": 5}, "20 to 100000"), ({"draws": 10**6}, "20 to 100000"), ({"of": ("stifness",)}, "stifness"),
        ({"of": ("structure_function",)}, "structure_function"),
    ],
)  # fmt: skip
def test_a_study_that_cannot_be_is_refused(flanks: list[Flank], options: dict[str, Any], words: str) -> None:
    setup = default_setup(HARMONIC_FRACTAL, surface=flanks[0], reference_torque="100 mN*m")
    with pytest.raises(TruingError, match=words):
        calculate(replace(setup, studies=(Uncertainty(**options),)))


def test_an_interval_reaches_further_to_the_side_on_which_few_values_lie() -> None:
    """Of z = -1/2, as Efron's bias correction has it: from the percentile of Phi(-1 - 1.96), 0.154 %, to 97.5 %."""
    values = np.linspace(0.0, 1.0, 100_001)
    below = 0.308538  # Phi(-1/2)
    assert interval_about(0.5, values) == pytest.approx((0.025, 0.975), abs=1e-4)
    assert interval_about(below, values) == pytest.approx((0.00154, 0.975), abs=1e-4)
    assert interval_about(1.0 - below, values) == pytest.approx((0.025, 1.0 - 0.00154), abs=1e-4)
    assert interval_about(-1.0, values)[0] == pytest.approx(0.0, abs=1e-4)
    assert interval_about(2.0, np.full(5, 2.0)) == (2.0, 2.0)
    assert np.isnan(interval_about(1.0, np.array([np.nan]))).all()


# The tolerance that every other study draws from


def drawn(rows: int, **inputs: Any) -> dict[str, Any]:
    """Deviations as the tolerance draws them."""
    drive = replace(HARMONIC_FRACTAL.inputs(), **inputs)
    found = flank_samples(np.random.default_rng(1), rows, **{name: getattr(drive, name) for name in FLANKS})
    return dict(found)


def test_every_study_draws_pairs(flanks: list[Flank]) -> None:
    setup = default_setup(HARMONIC_FRACTAL, surface=flanks[0])
    columns = scatter_of(setup).draw(seed=3, first=0, rows=4000)
    pairs = flanks[0].resampled
    together = np.stack([columns["dimension_deviation"], columns["roughness_deviation"]])
    correlations = [float(np.asarray(np.corrcoef(each))[0, 1]) for each in (together, pairs.T)]
    assert correlations[0] == pytest.approx(correlations[1], abs=0.002)
    np.testing.assert_allclose(together.std(axis=1), pairs.std(axis=0), rtol=0.05)
    np.testing.assert_allclose(together.mean(axis=1) / together.std(axis=1), 0.0, atol=4.0 / np.sqrt(4000))


def test_two_alike_flanks_measured_apart_are_known_better(flanks: list[Flank]) -> None:
    """Equal D: G of both is 2^(1/(2(D-2))) G, so ln G of both moves by -ln 2/(2(D-2)^2) with D; errors are averaged."""
    both = drawn(20_000, surface=flanks[0], mating_surface=flanks[1])
    singles = [drawn(20_000, surface=flank) for flank in flanks[:2]]
    dimensions = [single["dimension_deviation"] for single in singles]
    logarithms = [
        single["roughness_deviation"] - 2.0 * np.log(2.0) * single["dimension_deviation"] for single in singles
    ]
    for name, parts in (("dimension_deviation", dimensions), ("roughness_deviation", logarithms)):
        expected = np.sqrt(np.mean([np.var(part) for part in parts]) / 2.0)
        assert np.std(both[name]) == pytest.approx(expected, rel=0.04)


def test_a_stated_mating_flank_has_no_scatter_of_its_own(flanks: list[Flank]) -> None:
    """A mating flank that is a thousandth as rough leaves that of the measured one."""
    alone, beside = drawn(5000, surface=flanks[0]), drawn(5000, surface=flanks[0], mating_dimension=2.5,
                                                          mating_roughness=1e-12)  # fmt: skip
    for name, values in alone.items():
        np.testing.assert_allclose(beside[name], values, atol=2e-3 * np.std(values) + 1e-9, rtol=2e-3)


def test_nothing_scatters_without_a_measured_flank() -> None:
    assert drawn(10) == {}
    refused = replace(flank_of(0, resamples=20), chosen=None, reason="refused")
    assert drawn(10, surface=refused) == {}
    assert set(default_setup(HARMONIC_FRACTAL, surface=refused).distributions()) == {"hardness", "youngs_modulus"}


def test_compliance_scatters_by_a_percent_where_there_is_one() -> None:
    assert "drive_compliance" not in default_setup(HARMONIC_FRACTAL).distributions()
    spread = default_setup(HARMONIC_FRACTAL, drive_compliance="40 urad/(N*m)").distributions()["drive_compliance"]
    assert spread["drive_compliance"].mean == pytest.approx(40e-6)
    assert spread["drive_compliance"].sd == pytest.approx(0.4e-6, rel=0.02)


# Slopes, against the table that was calculated beforehand (D = 2.5, G = 1e-9 m, 25 N)


def test_slopes_of_the_stiffness() -> None:
    rougher: dict[str, Any] = {"fractal_dimension": 2.5, "fractal_roughness": "1e-9 m", "reference_torque": "100 mN*m"}
    setup = default_setup(HARMONIC_FRACTAL, **rougher)
    (study,) = (study for study in setup.studies if study.name == "sensitivity")
    answers = calculate(replace(setup, studies=(study,))).answers
    for name, printed in (("dimension", 13.2), ("roughness", -0.88), ("hardness", 0.82), ("load", 0.94)):
        assert answers[f"slope_{name}"] == pytest.approx(printed, abs=0.05 if abs(printed) > 1 else 0.005)
    assert answers["slope_load"] == pytest.approx(float(answers["load_exponent"]), rel=1e-6)


def test_shares_of_what_scatters_together_are_explained(flanks: list[Flank]) -> None:
    setup = default_setup(HARMONIC_FRACTAL, surface=flanks[0], reference_torque="100 mN*m")
    (study,) = (study for study in setup.studies if study.name == "sensitivity")
    found: Any = calculate(replace(setup, studies=(study,))).outcomes["sensitivity"]
    assert "below 0" not in _note(found)
    taken = {**found.share["stiffness"], "dimension_deviation": -0.65, "roughness_deviation": 1.64}
    assert "A share below 0: the source scatters together with another" in _note(replace(found, share={
        **found.share, "stiffness": taken,
    }))  # fmt: skip


def _note(found: Any) -> str:
    """The note below the first table."""
    return str(next(block for block in found.blocks() if isinstance(block, Table)).note)


def test_a_slope_that_was_not_asked_for_is_none() -> None:
    drive = HARMONIC_FRACTAL.inputs()
    assert isinstance(drive, Drive)

    class Asked:
        inputs = drive
        derivatives: dict[str, dict[str, float]] = {"stiffness": {"pair_load": 1.0}}  # noqa: RUF012

    found: Any = slopes(Asked())  # type: ignore[arg-type]
    assert np.isnan(found.slope_dimension)
    assert found.slope_load == pytest.approx(25.0 / float(stiffness(interface_of(drive))))
