"""The sheet of a harmonic drive: what its sections say, and what its figures show, read back and compared."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from drawn import line, words
from harmonic_fractal import figures
from harmonic_fractal.estimate import Estimation, estimate_of
from harmonic_fractal.figures import flanks, interface, stiffness, torsion
from harmonic_fractal.flank import Flank
from harmonic_fractal.generators import brownian_surface
from harmonic_fractal.model import HARMONIC_FRACTAL
from harmonic_fractal.surface import Direction, Lines, Surface, without_line
from harmonic_fractal.uncertainty import SurfaceValidity
from truing import Drawing, Table
from truing.calculation import Calculation, calculate
from truing.report.given import input_value
from truing.setup import default_setup

SPACING = 0.5e-6


def run(**inputs: Any) -> Calculation:
    """A drive with these inputs and the study that looks at validity."""
    return calculate(replace(default_setup(HARMONIC_FRACTAL, **inputs), studies=(SurfaceValidity(),)))


def patch(heights: NDArray[np.float64], name: str, chosen: Any = "both", **said: Any) -> Flank:
    """A flank as it is after reading, with both directions estimated."""
    surface = Surface(heights, SPACING, SPACING, name)
    settings = Estimation(resamples=50)
    axes: list[Direction] = ["x", "y", "both"] if chosen == "both" else ["x", "y"]
    lines = {axis: Lines(without_line(surface.lines(axis).heights), SPACING) for axis in axes}
    estimates = tuple(estimate_of(lines[axis], axis, settings) for axis in axes)
    facts: dict[str, Any] = {"reason": "", "warnings": (), "sq_raw": 1e-7, "sq_plane": 9e-8, "sq_second_order": 8e-8}
    return Flank(raw=surface, surface=surface, estimates=estimates, chosen=chosen, **(facts | said))


@pytest.fixture(scope="module")
def good() -> Flank:
    """A patch of fractional Brownian motion of D_s = 1.5, alike in all directions."""
    return patch(brownian_surface(1.5, 1e-16, (120, 300), np.random.default_rng(5)), "good.csv")


@pytest.fixture(scope="module")
def bad() -> Flank:
    """A patch of smooth hills: no self-affine range."""
    x, y = np.arange(300) * SPACING, np.arange(120)[:, None] * SPACING
    heights = 1e-7 * np.sin(2 * np.pi * x / 40e-6) * np.cos(2 * np.pi * y / 35e-6)
    found = patch(heights, "hills.csv", None)
    return replace(found, reason=found.estimates[0].reason)


@pytest.fixture(scope="module")
def measured(good: Flank) -> Calculation:
    return run(surface=good, reference_torque="1 N*m")


@pytest.fixture(scope="module")
def refused(bad: Flank) -> Calculation:
    return run(surface=bad)


@pytest.fixture(scope="module")
def stated() -> Calculation:
    return run()


def titles(blocks: Any) -> list[str]:
    return [block.title for block in blocks if isinstance(block, (Table, Drawing))]


def table(blocks: Any, title: str) -> Table:
    """The table whose title holds these words."""
    return next(block for block in blocks if isinstance(block, Table) and title in block.title)


# Flanks


def test_without_a_surface_the_sheet_says_so(stated: Calculation) -> None:
    said = "No flank was measured: D and G are as stated, and how sure they are is not known."
    assert words(flanks(stated.record)) == said
    assert stated.answers["surface_accepted"] == 1
    assert stated.verdict == "passes"


def test_a_good_surface_is_used_and_shown(measured: Calculation, good: Flank) -> None:
    blocks = flanks(measured.record)
    assert words(blocks, "warning") == ""
    assert "good.csv, is used" in words(blocks)
    assert "agree and are pooled" in words(blocks)
    assert [title.split(": ")[1] for title in titles(blocks)] == [
        "from above", "profiles", "structure function and local dimension", "what each direction says",
        "how sure D and G are", "D_s by other ways, for comparison", "local slopes",
    ]  # fmt: skip
    rows = table(blocks, "what each direction says").rows
    assert [row[0] for row in rows] == ["along x", "along y", "x and y together"]
    assert [row[-1] for row in rows] == ["self-affine, not used", "self-affine, not used", "used"]
    assert good.used is not None
    assert measured.answers["dimension"] == pytest.approx(good.used.dimension + 1)
    assert measured.verdict == "passes"


def test_a_refused_surface_fails_the_check_and_says_whose_contact_it_is(refused: Calculation) -> None:
    blocks = flanks(refused.record)
    said = words(blocks, "warning")
    assert said.startswith("REFUSED: the flank of the flexspline, hills.csv")
    assert "The contact below is NOT that of this surface: it is that of the D and G stated in the inputs" in said
    assert "inputs, D = 2.4 and G = 1·10⁻¹¹ m." in said
    assert "no self-affine range" in said
    assert "for comparison only" in said
    rows = table(blocks, "what each direction says").rows
    assert {row[-1] for row in rows} == {"refused, for comparison only"}
    local = table(blocks, "local slopes").rows
    assert len(local) >= 6
    assert float(local[0][1] or 0.0) < 1.05  # smooth at short lags
    assert refused.answers["surface_accepted"] == 0
    assert refused.verdict == "fails"
    assert [check.name for check in refused.checks if not check.passed] == ["surface_accepted"]
    assert any("surface is refused" in text for text in refused.warnings)
    assert float(refused.answers["stiffness"]) == pytest.approx(1.95e9, rel=1e-3)


def test_a_refused_mating_flank_leaves_that_flank_smooth(good: Flank, bad: Flank) -> None:
    found = run(surface=good, mating_surface=bad, reference_torque="1 N*m")
    assert "mating_dimension is not stated, so the circular spline is taken as smooth" in words(flanks(found.record))
    assert found.verdict == "fails"
    assert table(interface(found.record), "Both flanks").rows[1][-1] == "smooth"


@pytest.mark.parametrize(
    ("changed", "on_the_sheet", "warned"),
    [
        ({"chosen": "y", "warnings": ("the direction y alone is used; along x: too smooth",)},
         "It is taken along y only", "the direction y alone is used"),
        ({"chosen": "x"}, "It is taken along x only", "surface is taken along x only"),
        ({"warnings": ("7.0% of the points are missing, more than 5%",)}, "7.0% of the points are missing",
         "7.0% of the points are missing"),
    ],
    ids=["one direction", "one direction that was asked for", "holes"],
)  # fmt: skip
def test_what_is_said_of_a_flank_reaches_sheet_and_terminal(
    good: Flank, changed: dict[str, Any], on_the_sheet: str, warned: str
) -> None:
    noisy = tuple(replace(each, noise=3e-9) for each in good.estimates)
    found = run(surface=replace(good, estimates=noisy, **changed), reference_torque="1 N*m")
    blocks = flanks(found.record)
    assert on_the_sheet in words(blocks)
    assert any(warned in text for text in found.warnings)
    chosen = {"both": "x and y"}.get(changed.get("chosen", "both"), f"along {changed.get('chosen')} only")
    assert table(interface(found.record), "Both flanks").rows[0][-1] == f"measured, {chosen}"
    said = table(blocks, "what each direction says")
    assert said.columns[-2:] == ("noise", "verdict")
    assert [row[-2] for row in said.rows] == pytest.approx([3.0, 3.0, 3.0])


def test_map_shows_the_heights_with_the_longer_side_across(good: Flank) -> None:
    turned = Surface(good.surface.heights.T, SPACING, SPACING, "turned")
    for flank in (good, replace(good, surface=turned)):
        image = figures.map_figure(flank).axes[0].get_images()[0]
        shown: Any = image.get_array()
        assert shown.shape == (120, 300)
        np.testing.assert_allclose(shown, 1e9 * good.surface.heights)
        assert image.get_extent() == pytest.approx([0.0, 149.5, 0.0, 59.5])


def test_profiles_are_lines_of_the_direction_used(good: Flank) -> None:
    panel: Any = figures.profiles_figure(replace(good, chosen="y")).axes[0]
    drawn = [np.asarray(item.get_ydata(), dtype=float) for item in panel.get_lines()]
    columns = [1e9 * (column - column.mean()) for column in good.surface.heights.T]
    assert len(drawn) == 4
    for values in drawn:
        assert any(np.allclose(values - values.mean(), column) for column in columns)


def test_a_long_profile_keeps_its_peaks() -> None:
    heights = np.zeros((1, 9600))
    heights[0, 4321] = 5e-6
    profile = Surface(heights, SPACING, float("nan"), "long.csv")
    flank = Flank(raw=profile, surface=profile, estimates=(), chosen="x", reason="", warnings=())
    panel: Any = figures.profiles_figure(flank).axes[0]
    x, z = (np.asarray(values, dtype=float) for values in panel.get_lines()[0].get_data())
    assert len(x) <= 2000
    assert np.ptp(z) == pytest.approx(5000.0)
    assert x[np.argmax(z)] == pytest.approx(4321 * 0.5, abs=10 * 0.5)


def test_structure_figure_shows_points_fit_and_local_dimension(good: Flank) -> None:
    upper, lower = figures.structure_figure(good).axes
    used = good.used
    assert used is not None
    lags, fit = line(upper, "fit both together")
    slope = np.polyfit(np.log(lags), np.log(fit), 1)[0]
    assert 2.0 - slope / 2.0 == pytest.approx(used.dimension, abs=1e-9)
    points = dict(zip(*line(upper, "both together"), strict=True))
    assert points[min(points)] == pytest.approx(1e18 * float(used.all_values[0]))
    np.testing.assert_allclose(fit, np.interp(lags, list(points), list(points.values())), rtol=0.15)
    np.testing.assert_allclose(line(lower, "used")[1], used.dimension)


def test_structure_figure_of_a_refused_surface_is_for_comparison(bad: Flank) -> None:
    upper, _ = figures.structure_figure(bad).axes
    labels = [str(item.get_label()) for item in upper.get_lines()]
    assert any(label.endswith("for comparison only") for label in labels)
    assert not any("range" in label for label in labels)


# One pair


def test_pair_figure_goes_through_the_results(stated: Calculation) -> None:
    upper, lower = figures.pair_figure(stated.record.inputs).axes
    at = 25.0
    for panel, label, name, factor in (
        (upper, "(used)", "stiffness", 1.0), (lower, "amplitude of the largest", "clearance", 1e9),
        (lower, "what closes", "closing_clearance", 1e9),
    ):  # fmt: skip
        load, values = line(panel, label)
        found = np.exp(np.interp(np.log(at), np.log(load), np.log(values)))
        assert found == pytest.approx(factor * float(stated.answers[name]), rel=2e-3)


def test_pair_figure_shows_every_reading(stated: Calculation) -> None:
    """At 25 N: 3.47e9 N/m with scaled tips, 2.16e8 with first yield; 3.0e8 by the rms height of 172 nm."""
    upper, lower = figures.pair_figure(stated.record.inputs).axes
    for label, expected in (
        ("area, tip radius follows", 3.47e9), ("first yield, tip radius its own", 2.16e8), ("Persson", 3.0e8),
    ):  # fmt: skip
        load, values = line(upper, label)
        assert np.exp(np.interp(np.log(25.0), np.log(load), np.log(values))) == pytest.approx(expected, rel=0.01)
    labels = [str(item.get_label()) for item in lower.get_lines()]
    assert sum("equation 7" in label for label in labels) == 3


def test_single_contacts_are_spheres(stated: Calculation) -> None:
    """Hertz: F R = 4/3 E a^3, stiffness 1.5 F/delta, a^2 = R delta; at the critical area F is hardness times area."""
    rows = {
        row[0]: [float(value or 0.0) for value in row[1:]] for row in table(stiffness(stated.record), "Single").rows
    }
    modulus = 1.1318681e11
    for radius, interference, tip, force, spring in rows.values():
        real = radius * 1e-6 / np.sqrt(2.0)
        assert force * tip * 1e-6 == pytest.approx(4.0 / 3.0 * modulus * real**3, rel=1e-6)
        assert spring == pytest.approx(1.5 * force / (interference * 1e-9), rel=1e-9)
        assert real**2 == pytest.approx(tip * 1e-6 * interference * 1e-9, rel=1e-9)
    area = float(stated.answers["critical_area"])
    assert rows["just elastic"][3] == pytest.approx(3e9 * area, rel=1e-9)
    assert rows["the largest"][1] == pytest.approx(2e9 * float(stated.answers["clearance"]))


def test_plastic_contacts_are_a_warning_on_sheet_and_terminal() -> None:
    found = run(pair_load="1e-5 N")
    assert "All contacts of the pair are plastic" in words(stiffness(found.record), "warning")
    assert any("all contacts of the pair are plastic" in text for text in found.warnings)
    mostly = run(critical_rule="yield_onset", reference_torque="1 N*m")
    assert any("58% of the load is on plastic contacts" in text for text in mostly.warnings)


# Torsion


def test_torsion_beside_the_catalogue(stated: Calculation) -> None:
    """Size 20 above a ratio of 50: 7/16000 rad at T_1, 18/25000 more at T_2, 25/29000 more at twice that."""
    rows = table(torsion(stated.record), "torques of the catalogue").rows
    assert [row[0] for row in rows] == [7.0, 25.0, 50.0]
    assert [row[3] for row in rows] == pytest.approx([437.5, 1157.5, 1157.5 + 25e6 / 29000])
    assert rows[1][1] == pytest.approx(1e6 * float(stated.answers["rough_torsion"]))
    assert rows[1][4] == pytest.approx(100 * float(stated.answers["rough_share"]))
    assert all(0.0 < float(row[4] or 0.0) < 1.0 for row in rows)
    said = words(torsion(stated.record))
    assert "at most 0.55 %" in said
    assert "not the weakest link" in said
    assert "everything around the mesh is rigid" in said
    assert table(torsion(run(torque="-25 N*m").record), "torques of the catalogue").rows == rows


def test_the_share_of_the_wave_generator_says_that_it_is_fitted(stated: Calculation) -> None:
    """Where an amplitude is stated; where it is rigid there is nothing to say."""
    whole = table(torsion(run(wave_torsion_stated="752 urad").record), "Whose torsion")
    (share,) = [row[2] for row in whole.rows if row[0] == "wave generator, stated"]
    assert share == pytest.approx(65.0, abs=0.5)
    assert "not calculated" in whole.note
    assert "fitted, with drive_compliance, to two numbers of the catalogue" in whole.note
    assert "fitted" not in table(torsion(stated.record), "Whose torsion").note


def test_torsion_figure_goes_through_the_results() -> None:
    found = run(drive_compliance="40 urad/(N*m)")
    (drawing,) = (block for block in torsion(found.record) if isinstance(block, Drawing))
    upper, lower = drawing.draw().axes
    for label, name in (("catalogue", "catalogue_torsion"), ("this model", "torsion"), ("roughness", "rough_torsion")):
        torque, values = line(upper, label)
        assert np.interp(25.0, torque, values) == pytest.approx(1e6 * float(found.answers[name]), rel=5e-3)
    assert lower.get_yscale() == "log"
    assert float(found.answers["torsion"]) == pytest.approx(
        25 * 40e-6 + float(found.answers["rough_torsion"]), rel=1e-4
    )
    assert "everything around the mesh is rigid" not in words(torsion(found.record))


def test_an_input_file_that_is_not_given_is_said_so() -> None:
    setup = default_setup(HARMONIC_FRACTAL)
    for name in ("surface", "mating_surface", "mating_dimension"):
        assert input_value(setup, setup.model.input_fields[name], getattr(setup.inputs, name)).text == "not given"


@pytest.mark.parametrize(
    ("value", "text"), [(1e-11, "1·10⁻¹¹"), (0.056, "0.056"), (-3.5e-7, "−3.5·10⁻⁷"), (1.95e9, "1.95·10⁹")]
)
def test_numbers_in_words(value: float, text: str) -> None:
    assert figures.signed(value) == text
