"""A run of the reducer: its figures are read back and compared, its results, and the printed numbers beside ours.

Expected numbers are geometry, closed forms and equations written a second time, the paper's prints, or the tables of an
independent program.
"""

from collections.abc import Mapping
from dataclasses import replace
from math import acos, cos, degrees, isfinite, log, pi, radians, sin, sqrt
from statistics import NormalDist
from typing import Any

import numpy as np
import pytest
from matplotlib.patches import Circle
from rv_wear_by_hand import PRICE_OF, price_by_hand

from drawn import figures, line, words
from pages import Page
from rv_wear import sheet
from rv_wear.figures import mesh_figure
from rv_wear.machines import NewMachines
from rv_wear.optimum import Fronts, LeastCosts
from truing import Kernel, Reliability, TruingError
from truing.calculation import Calculation, calculate
from truing.published import compare_published
from truing.setup import default_setup

E, PINS, CIRCLE, RADIUS, ARM = 2.2, 40, 114.5, 5.0, 2.2 * 39  # mm
K1 = E * PINS / CIRCLE
Q = sqrt(1 - K1**2)
TORQUE = 0.55 * 3136.0
ARCMIN = pi / 10800
WEAR = {1000: 0.788, 2000: 1.419, 3000: 1.943, 4000: 2.391, 5000: 2.783, 6000: 3.129}  # um after hours
LESS = log(WEAR[6000] / WEAR[5000]) / log(6000 / 5000)  # wear grows as this power of its coefficient
# arcmin per um of each priced error, and its width now in um.
PRICED = {
    "pin_circle_error": (2 * Q, 1.2), "pin_radius_error": (-2.0, 1.0), "disc_runout": (0.5, 6.55),
    "pin_position_error": (2 * K1, 1.2), "disc_pitch_error": (-K1, 2.0), "modification_error": (2.0, 1.2),
}  # fmt: skip
PER_MICROMETRE = 1e-3 / ARM / ARCMIN
UNPRICED = (  # arcmin: coefficient times width over 6 of the errors 1, 2, 3, 8 and 16
    (10e-3 / 6) / (18 * 101) / ARCMIN,
    2 * sin(radians(20)) * (10e-3 / 6) / (18 * 101) / ARCMIN,
    2 * sin(radians(20)) * (20e-3 / 6) / (18 * 101) / ARCMIN,
    1.6 / 6 * PER_MICROMETRE,
    (1.2e-3 / 6) / 63 / ARCMIN,
)
OFFER = Kernel.installed(strict=True).offer("rv_wear")
RV_WEAR = OFFER.model
SMALL: dict[str, dict[str, Any]] = {
    "reliability": {"draws": 20_000, "points": 7},
    "new_machines": {"draws": 2000},
    "optimise": {"population": 16, "generations": 6, "draws": 512, "verify": 2000},
}
RATIOS = {  # our number over the printed one: how far from 1, in the reference reproduction of the paper or known here
    **{f"sensitivity index {number}": (-0.0095, 0.0095) for number in range(1, 17)},
    **dict.fromkeys(
        ("force falls with the modification", "contact widens with the modification",
         "wear falls with the modification", "wear to 3000 h within the 95 % band", "share below 1 arcmin, unworn"),
        (0.0, 0.0),
    ),
    "largest equidistant modification": (-0.0096, 0.0096), "smallest equidistant modification": (-0.0143, 0.0143),
    "deepest wear after 6000 h": (-0.001, 0.001), "deepest wear at optimum 1": (-0.001, 0.001),
    "deepest wear at optimum 2": (-0.0012, 0.0012), "mean backlash, unworn": (-0.0025, 0.0025),
    "cost before optimisation": (-0.001, 0.001), "least cost at optimum 1": (0.03, 0.0355),
    "least cost at optimum 2": (0.03, 0.06),
    # The wear scatters by 1.3 % here, by 2 % in the reference, which has 1.007.
    "reliability after 6000 h": (-0.0078, 0.0078), "reliability after 4000 h": (-0.004, -0.002),
    "reliability after 3000 h": (-0.0004, 0.0),
    # With zones up to twice as wide the knee is cheaper and wears more than the paper's choice.
    **{f"cost at optimum {number}, zones up to 20 % wider": (-0.0065, -0.0035) for number in (1, 2)},
    **{f"wear at optimum {number}, zones up to 20 % wider": (0.0045, 0.0055) for number in (1, 2)},
    "cost at optimum 1, knee of the front": (-1.0, -0.1), "cost at optimum 2, knee of the front": (-1.0, -0.1),
    "wear at optimum 1, knee of the front": (0.02, 0.03), "wear at optimum 2, knee of the front": (0.02, 0.03),
}  # fmt: skip


@pytest.fixture(scope="module")
def run() -> Calculation:
    """The paper's reducer with small budgets: all studies of the shipped example."""
    left_out = {"allocation", "both_free", "paper_route"}
    chosen: list[Any] = [study for study in RV_WEAR.studies if study.name not in left_out]
    studies = tuple(replace(study, **SMALL.get(study.name, {})) for study in chosen)
    return calculate(replace(default_setup(OFFER.model, OFFER.origin), studies=studies))


def normal_mean(hours: float) -> float:
    """Mean backlash, arcmin, with the wear of the table."""
    return 0.6985 + 2 * WEAR.get(int(hours), 0.0) * PER_MICROMETRE


def spread(widths: Mapping[str, float], wear: float) -> float:
    """Standard deviation of the backlash, arcmin, from full widths in um; its coefficient scatters by 2 %."""
    parts = [PRICED[name][0] * width / 6 * PER_MICROMETRE for name, width in widths.items()]
    parts.append(-2 * Q * widths["modification_error"] / 6 * PER_MICROMETRE)  # factor 13 beside 12
    parts.append(2 * 0.0126 * 1.589 * wear * LESS * PER_MICROMETRE)
    return sqrt(sum(part**2 for part in (*parts, *UNPRICED)))


# The mesh


@pytest.fixture(scope="module")
def mesh() -> Any:
    """The drawing of the mesh."""
    return mesh_figure(RV_WEAR.inputs()).axes[0]


def circles(panel: Any) -> list[Any]:
    return [each for each in panel.patches if isinstance(each, Circle) and each.get_radius() == pytest.approx(RADIUS)]


def test_every_pin_stands_on_its_circle_and_touches_the_disc(mesh: Any) -> None:
    """All pins but for what grinding takes off, before the disc is turned; the outline has a point every 0.2 mm."""
    pins = np.array([complex(*each.center) for each in circles(mesh)])
    assert len(pins) == PINS
    assert np.abs(pins) == pytest.approx(CIRCLE)
    corners = next(each for each in mesh.patches if len(each.get_xy() if hasattr(each, "get_xy") else ()) > 1000)
    outline = corners.get_xy()[:, 0] + 1j * corners.get_xy()[:, 1]
    gaps = np.abs(pins[:, None] - outline[None, :]).min(axis=1) - RADIUS
    psi = np.angle(pins)
    ground = -0.026 + 0.030 * (1 - K1 * np.cos(psi)) / np.sqrt(1 + K1**2 - 2 * K1 * np.cos(psi))
    assert gaps == pytest.approx(ground, abs=2e-3)


def test_the_arrows_balance_the_torque_and_point_to_the_pitch_point(mesh: Any) -> None:
    """Moments about the middle of the disc, from the arrows alone; the longest is the force that is written."""
    arrows = [each for each in mesh.texts if each.get_text() == "" and each.arrow_patch is not None]
    assert 9 <= len(arrows) <= 12
    tails = np.array([complex(*each.xyann) for each in arrows])
    tips = np.array([complex(*each.xy) for each in arrows])
    assert np.angle((tips - tails) / (E * PINS - tails)) == pytest.approx(0.0, abs=1e-9)
    written = next(float(each.get_text()[:-2]) for each in mesh.texts if each.get_text().endswith(" N"))
    force = (tips - tails) / np.abs(tips - tails).max() * written
    moments = ((tails - E).conjugate() * force).imag * 1e-3
    assert abs(moments.sum()) == pytest.approx(TORQUE, rel=1e-3)
    assert len([each for each in circles(mesh) if each.get_facecolor()[:3] != (1.0, 1.0, 1.0)]) == len(arrows)


# Along the flank


def test_the_clearance_is_equation_g3(run: Calculation) -> None:
    panel = figures(run, sheet.geometry)["Clearance along the flank"].axes[0]
    angle, clearance = line(panel, "clearance, new")
    for degree, drawn_clearance in zip(angle[::20], clearance[::20], strict=True):
        psi = radians(degree)
        distance = sqrt(1 + K1**2 - 2 * K1 * cos(psi))
        expected = -26 * (1 - sin(psi) / distance) + 30 * (1 - K1 * cos(psi) - Q * sin(psi)) / distance
        assert drawn_clearance == pytest.approx(expected, abs=1e-9)
    assert np.interp(degrees(acos(K1)), angle, clearance) == pytest.approx(0.0, abs=1e-3)
    at, approach = line(panel, "approach under load, new")
    assert approach.max() == pytest.approx(6.01, abs=0.01)
    assert at[approach.argmax()] == pytest.approx(degrees(acos(K1)), abs=0.5)


@pytest.mark.parametrize("label", ["new, in proportion to the approach", "new, Hertz at every pin", "after 6000 h"])
def test_the_forces_hold_the_torque_in_every_position(run: Calculation, label: str) -> None:
    """Eight positions per pin pitch; in each the pins that are one pitch apart hold the torque."""
    angle, force = line(figures(run, sheet.forces)["Force on a pin"].axes[0], label)
    psi = np.radians(angle)
    moments = force * ARM * 1e-3 * np.sin(psi) / np.sqrt(1 + K1**2 - 2 * K1 * np.cos(psi))
    assert moments.reshape(-1, 8).sum(axis=0) == pytest.approx(np.full(8, TORQUE), rel=1e-8)


def test_the_words_on_both_ways_of_sharing_are_read_off_the_figure(run: Calculation) -> None:
    panel = figures(run, sheet.forces)["Force on a pin"].axes[0]
    linear, hertz = (line(panel, f"new, {way}")[1] for way in ("in proportion to the approach", "Hertz at every pin"))
    said = words(sheet.forces(run.record))
    assert f"{100 * (hertz.max() / linear.max() - 1):.1f} % larger" in said
    assert f"up to {100 * np.abs(hertz - linear).max() / linear.max():.0f} % of" in said
    assert 1 < 100 * (hertz.max() / linear.max() - 1) < 4  # an independent solution of both


def test_the_wear_along_the_flank_ends_at_the_deepest(run: Calculation) -> None:
    panel = figures(run, sheet.wear)["Wear along the flank"].axes[0]
    for hours in (3000, 6000):
        angle, wear = line(panel, f"{hours} h")
        assert wear.max() == pytest.approx(WEAR[hours], abs=6e-4)
        assert 50 < angle[wear.argmax()] < 65


def test_the_histories_are_the_table(run: Calculation) -> None:
    upper, lower = figures(run, sheet.wear)["Wear and backlash over the years"].axes
    hours, wear = (np.asarray(values) for values in upper.get_lines()[0].get_data())
    _, backlash = (np.asarray(values) for values in lower.get_lines()[0].get_data())
    for at, expected in WEAR.items():
        assert np.interp(at, hours, wear) == pytest.approx(expected, abs=6e-4)
        assert np.interp(at, hours, backlash) == pytest.approx(normal_mean(at), abs=2e-4)
    assert np.asarray(lower.get_lines()[1].get_ydata())[0] == pytest.approx(1.0)


def test_discs_ground_in_other_ways_are_as_the_paper_says(run: Calculation) -> None:
    """Figs. 1 and 2; the wear of both ends after 100 h from an independent program."""
    upper, lower = figures(run, sheet.other_discs)["Forces and wear of discs ground in other ways"].axes
    force = [np.asarray(item.get_ydata()) for item in upper.get_lines()]
    wear = [np.asarray(item.get_ydata()) for item in lower.get_lines()]
    assert len(force) == len(wear) == 6
    assert np.all(np.diff([values.max() for values in force]) < 0)
    assert np.all(np.diff([(values > 0).sum() for values in force]) > 0)
    assert np.all(np.diff([values.max() for values in wear]) < 0)
    assert wear[0].max() == pytest.approx(0.105, abs=1e-3)
    assert wear[-1].max() == pytest.approx(0.060, abs=1e-3)
    for item in upper.get_lines():
        equidistant, shift = (float(text.replace("−", "-")) for text in item.get_label().split(", "))
        assert equidistant - shift == pytest.approx(4.0, abs=0.11)


# Scatter


def test_new_machines_scatter_as_their_zones_say(run: Calculation) -> None:
    left, right = figures(run, sheet.reliability)["Backlash of new machines"].axes
    backlash = np.asarray(left.get_lines()[0].get_ydata())
    assert len(backlash) == 2000
    sd = spread({name: width for name, (_, width) in PRICED.items()}, 0.0)
    assert backlash.mean() == pytest.approx(0.6985, abs=4 * sd / sqrt(2000))
    assert backlash.std() == pytest.approx(sd, rel=4 / sqrt(2 * 2000))
    assert backlash.max() < 1.0
    counts = [sum(item.get_width() for item in part) for part in right.containers]
    assert counts == [2000, 2000]


def test_the_reliability_is_the_closed_form(run: Calculation) -> None:
    """Equation 21 is a sum of normal errors; the counts lie within four standard errors of it."""
    panel = figures(run, sheet.reliability)["Reliability over the working time"].axes[0]
    hours, counted = line(panel, "counted among the machines drawn")
    widths = {name: width for name, (_, width) in PRICED.items()}
    for at in WEAR:
        expected = NormalDist().cdf((1 - normal_mean(at)) / spread(widths, WEAR[at]))
        found = counted[np.abs(hours - at).argmin()] / 100
        assert found == pytest.approx(expected, abs=4 * sqrt(max(expected * (1 - expected), 1e-5) / 20_000))
    printed, share = line(panel, "the paper, 88.7 % at 6000 h")
    assert (printed[0], share[0]) == (6000.0, pytest.approx(88.7))


def test_the_indices_stand_beside_table_2(run: Calculation) -> None:
    panel = figures(run, sheet.influence)["How much backlash each error gives"].axes[0]
    bars = [item.get_width() for item in panel.containers[0]]
    printed, _ = line(panel, "the paper, Table 2")
    assert len(bars) == 16
    for bar, value in zip(bars, printed, strict=True):
        assert bar == pytest.approx(value, rel=1e-2)


# Money


def by_hand(name: str, width: float) -> float:
    """The price of a zone of this full width in um, yuan."""
    return price_by_hand(PRICE_OF[name][0], width / 1000)


def test_the_prices_are_those_of_the_cost_functions(run: Calculation) -> None:
    left, right = figures(run, sheet.costs)["Price of the zones"].axes
    names = [item.get_text().replace(" ", "_") for item in left.get_yticklabels()]
    bars = [item.get_width() for item in left.containers[0]]
    assert dict(zip(names, bars, strict=True)) == pytest.approx(
        {name: by_hand(name, width) for name, (_, width) in PRICED.items()}
    )
    shares, paid = line(right, "disc runout, now 6.55 µm")
    assert paid == pytest.approx([by_hand("disc_runout", 6.55 * share) for share in shares])


def test_the_front_shows_the_start_and_what_the_paper_prints(run: Calculation) -> None:
    panel = figures(run, sheet.better_tolerances)["Cost and wear"].axes[0]
    for label, cost, wear in (
        ("as stated", 1402.7, 3.1288), ("the paper, before", 1402.0, 3.127),
        ("the paper's optimum for 95 %", 1291.0, 3.151), ("the paper's optimum for 100 %", 1300.0, 3.207),
    ):  # fmt: skip
        x, y = line(panel, label)
        assert (x[0], y[0]) == (pytest.approx(cost, abs=0.05), pytest.approx(wear, abs=1e-4))


def test_no_design_of_the_search_beats_the_front(run: Calculation) -> None:
    """It draws 512 machines per design, so it may err by what these do not tell: 2 % of the cost."""
    panel = figures(run, sheet.better_tolerances)["Cost and wear"].axes[0]
    cost, wear = line(panel, "least cost for 95 %")
    found_cost, found_wear = line(panel, "found by the search for 95 %")
    within = (found_wear >= wear[0]) & (found_wear <= wear[-1])
    assert np.all(found_cost[within] > 0.98 * np.interp(found_wear[within], wear, cost))


def test_the_numbers_on_the_theory_page_are_those_of_the_fronts(run: Calculation) -> None:
    """Smallest wear, knee, and the cost at the paper's wear."""
    fronts: Fronts = run.outcomes["least_costs"]
    for front in fronts.fronts:
        printed = {0.95: 3.151, 0.999: 3.207}[front.goal]
        wear, cost = ([getattr(each, name) for each in front.designs] for name in ("wear", "cost"))
        between = np.interp(printed, 1e6 * np.array(wear), cost)
        row = " ".join(Page("rv_wear").row(rf"$R \ge {front.goal:g}$"))
        for place in (0, front.knee or 0):
            assert f"{1e6 * wear[place]:.3f} µm, {cost[place]:.0f} yuan" in row
        assert f"{printed:g} µm: {between:.0f} yuan" in row


def test_the_better_reducers_reach_their_goal_at_the_end(run: Calculation) -> None:
    panel = figures(run, sheet.better_tolerances)["Reliability before and after"].axes[0]
    ends = {item.get_label(): np.asarray(item.get_ydata())[-1] for item in panel.get_lines()}
    reached = {label.rsplit(" for ", 1)[1]: value for label, value in ends.items() if " yuan, " in str(label)}
    assert reached == {"95 %": pytest.approx(95.0, abs=1e-3), "99.9 %": pytest.approx(99.9, abs=1e-3)}


# Results and printed numbers


def test_the_paper_finds_one_check_that_fails(run: Calculation) -> None:
    """88.7 % stay within one arc minute after 6000 h: not enough."""
    assert run.verdict == "fails"
    (failing,) = [check for check in run.checks if not check.passed]
    assert (failing.name, failing.limit) == ("backlash", 0.95)


def test_what_runs_along_an_axis_reaches_the_results(run: Calculation) -> None:
    axes = {
        "phase_angle": ("normal_force", "worn_force", "wear_depth"),
        "history_time": ("wear_history", "backlash_history"),
        "reliability_time": ("reliability_history",),
        "front_cost": ("front_wear", "front_equidistant"),
    }
    found = run.answers
    for axis, names in axes.items():
        assert len(found[axis]) > 2
        assert [len(found[name]) for name in names] == [len(found[axis])] * len(names)
    assert found["normal_force"].max() == pytest.approx(found["largest_force"], rel=1e-12)
    assert found["wear_depth"].max() == pytest.approx(found["max_wear"], rel=1e-9)
    assert found["wear_history"][0] == 0
    assert found["wear_history"][-1] == pytest.approx(found["max_wear"], rel=1e-12)
    assert found["reliability_history"][-1] == pytest.approx(found["accuracy_reliability"], rel=1e-12)
    assert np.all(np.diff(found["front_wear"]) < 0)  # in the order of cost
    assert all(design.feasible for design in run.outcomes["optimise"].front)
    assert 0.85 <= found["surrogate_coverage"] <= 1


def test_every_printed_number_is_as_stated_and_as_near_as_in_the_reference(run: Calculation) -> None:
    rows = {row.published.name: row for row in compare_published(OFFER, known=run)}
    apart = {name: row.ratio - 1 for name, row in rows.items() if row.ratio is not None}
    assert len(rows) == 42
    assert set(RATIOS) == set(rows) - {"place of the deepest wear"}
    for name, (low, high) in RATIOS.items():
        assert low - 1e-9 <= apart[name] <= high + 1e-9, name
    assert all(row.as_stated and isfinite(row.value) for row in rows.values())
    assert all(row.published.why for row in rows.values() if not row.matches)


# The studies that are there for the figures


@pytest.mark.parametrize(
    ("study", "options", "said"),
    [
        (LeastCosts, {"goals": (1.0,)}, "goals lie between 0 and 1"),
        (LeastCosts, {"span": (4.0, -45.0)}, "span is the lowest and the highest"),
        (LeastCosts, {"widest": 1.0}, "widest = 1 must lie above 1"),
        (NewMachines, {"draws": 1}, "2 to 100000 machines can be shown"),
        (NewMachines, {"draws": 100_001}, "2 to 100000 machines can be shown"),
    ],
)
def test_a_study_that_cannot_be_is_refused(study: Any, options: dict[str, Any], said: str) -> None:
    with pytest.raises(TruingError, match=said):
        study(**options)


def test_a_goal_out_of_reach_is_a_warning_and_no_front() -> None:
    setup = replace(default_setup(RV_WEAR), inputs=replace(RV_WEAR.inputs(), permitted_backlash=0.3 * ARCMIN))
    found = calculate(replace(setup, studies=(LeastCosts(goals=(0.999,)), Reliability(draws=100))))
    fronts: Fronts = found.outcomes["least_costs"]
    assert [front.designs for front in fronts.fronts] == [(), ()]
    assert sum("reaches a reliability of" in text for text in found.warnings) == 2
    assert list(sheet.better_tolerances(found.record)) == []


def test_the_machines_shown_are_the_first_of_the_reliability_study() -> None:
    """With as many draws both find the same share within the limit."""
    setup = default_setup(RV_WEAR)
    found = calculate(replace(setup, studies=(Reliability(draws=2000, method=("monte_carlo",)), NewMachines())))
    counted = found.outcomes["reliability"].probability["backlash"]
    assert found.outcomes["new_machines"].as_json()["used"]["within"] == pytest.approx(counted, abs=1e-12)
