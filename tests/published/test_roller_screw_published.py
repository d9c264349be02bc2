"""What is stated of the paper's numbers on the roller screw, and the study that chooses the shift.

Expected numbers are equations written a second time with plain floats and solved by other means, the paper's prints, or
an independent reconstruction that tried shifts in steps of 0.0025.
"""

from dataclasses import replace
from functools import cache
from math import acos, cos, isnan, pi, radians, sqrt, tan
from statistics import NormalDist
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from drawn import words
from roller_screw_shift import sheet
from roller_screw_shift.model import MARGINS, ROLLER_SCREW_SHIFT
from roller_screw_shift.objectives import equal_sliding, intervals_of, weights_of
from roller_screw_shift.optimum import READINGS, Field, Plan, Shifting, box_optimum, field_of, grid_optimum, over_ratios
from roller_screw_shift.published import FINDINGS
from roller_screw_shift.quantities import Pair
from truing import Table, TruingError
from truing.calculation import Calculation, calculate
from truing.setup import default_setup

ALPHA, ROLLER, RING, MODULE, ADDENDUM, CLEARANCE, CENTRES = radians(20.0), 20, 100, 0.5, 0.8, 0.3, 19.80778
SPAN, POINTS, STEP = (-2.0, 3.0), 2001, 0.0025


def inv(angle: float) -> float:
    return tan(angle) - angle


def by_hand(shift: float) -> dict[str, float]:
    """Contact ratio, largest sliding of both on 101 places of the path and the shift of the ring, mm and modules."""
    working = acos(0.5 * MODULE * (RING - ROLLER) * cos(ALPHA) / CENTRES)
    ring = shift + (RING - ROLLER) * (inv(working) - inv(ALPHA)) / (2 * tan(ALPHA))
    tip = acos(0.5 * ROLLER * cos(ALPHA) / (0.5 * ROLLER + ADDENDUM + shift))
    ring_tip = acos(0.5 * RING * cos(ALPHA) / (0.5 * RING - ADDENDUM + ring))
    at = tan(working)
    # Radii of curvature over half the module and cos(alpha), at the tip of the ring and at that of the roller.
    inner, outer = RING * (tan(ring_tip) - at), ROLLER * (tan(tip) - at)
    ratio, places = RING / ROLLER, np.linspace(inner, outer, 101)
    own, other = RING * at + places, ratio * (ROLLER * at + places)
    return {
        "ring": ring,
        "ratio": (outer - inner) / (2 * pi),
        "roller_sliding": float(np.max(np.abs(1 - own / other))),
        "ring_sliding": float(np.max(np.abs(1 - other / own))),
    }


def difference_of_sliding(shift: float) -> float:
    at = by_hand(shift)
    return at["roller_sliding"] - at["ring_sliding"]


def shift_at(ratio: float) -> float:
    """The shift with this contact ratio."""
    return float(brentq(lambda shift: by_hand(shift)["ratio"] - ratio, -0.2, 1.0, xtol=1e-14))


@cache
def run(*, seed: int = 0, study: Shifting | None = None, **values: Any) -> Calculation:
    """A run in which the shift is chosen and nothing else asked."""
    chosen = study or Shifting(points=POINTS, ratios=(), gives=GIVES)
    return calculate(replace(default_setup(ROLLER_SCREW_SHIFT, **values), studies=(chosen,), seed=seed))


GIVES: Any = ROLLER_SCREW_SHIFT.studies[0].gives


# The paper


def test_the_ranges_by_sliding_at_the_roots_are_those_of_the_reconstruction() -> None:
    """It compared the roots alone."""
    answers = run(sliding_reading="roots").answers
    assert answers["least_sum"] == pytest.approx(-0.480, abs=2 * STEP)
    assert answers["least_stress_difference"] / 1e6 == pytest.approx(27.61, abs=0.05)


def test_the_numbers_in_the_findings_are_computed() -> None:
    told = " ".join(finding.text for finding in FINDINGS).replace("−", "-")
    meshing: Any = ROLLER_SCREW_SHIFT.function(ROLLER_SCREW_SHIFT.inputs())
    ring_tip, roller_tip = 1e3 * float(meshing.tip_radius_ring), 1e3 * float(meshing.tip_radius_roller)
    ring_root, roller_root = 1e3 * float(meshing.root_radius_ring), 1e3 * float(meshing.root_radius_roller)
    curve = np.linspace(0, 2 * pi, 100_001)
    literal = curve / (2 * pi) - np.sin(curve)
    equal = brentq(difference_of_sliding, 0.1, 0.6, xtol=1e-14)
    numbers = {
        f"{-float(meshing.tip_clearance):.3f} instead of {float(meshing.tip_clearance):.3f}",
        f"{roller_tip - ring_root - CENTRES - 0.05:.1f} mm instead of {ring_tip - roller_root - CENTRES - 0.05:.3f} mm",
        f"{roller_tip - ring_tip + CENTRES - 0.05:.3f} instead of {ring_tip - roller_tip + CENTRES - 0.05:.1f}",
        f"falls to {literal.min():.2f}, rises to {literal.max():.2f}",
        f"{4 / 2.7**2:.3f}, {4 / 33.2**2:.4f} and {4 / 3.08**2:.3f}",
        f"{5.38 - 2 / sqrt(0.35):.2f}, {33.2 - 2 / sqrt(0.01):.1f} and {3.08 - 2 / sqrt(0.81):.2f}",
        f"from {33.2 - 2 / sqrt(0.005):.1f} to {33.2 - 2 / sqrt(0.015):.1f}",
        f"{by_hand(0.0)['ring']:.3f}, whatever the shift",
        f"difference {120 / 80 * by_hand(0.0)['ring']:.3f}",
        f"at {shift_at(1.4):.4f} and {by_hand(shift_at(1.4))['ring']:.4f}, by every",
        f"{shift_at(1.42):.4f} and {by_hand(shift_at(1.42))['ring']:.4f}",
        f"printed pair is {by_hand(0.21)['ratio']:.3f}",
        f"shift of {equal:.4f} at which",
        f"contact ratio is {by_hand(equal)['ratio']:.3f}",
        f"difference is {difference_of_sliding(0.21):.2f} or more",
        f"from {2 * brentq(lambda x: difference_of_sliding(x) - 3.08, -0.15, 0.1) + by_hand(0.0)['ring']:.3f} to",
    }
    assert {number for number in numbers if number not in told} == set()


# The study


PAIR: Pair = ROLLER_SCREW_SHIFT.inputs()


@pytest.mark.parametrize("ratio", [1.2, 1.4, 1.5])
def test_the_interval_ends_where_equations_solved_otherwise_end_it(ratio: float) -> None:
    (found,) = intervals_of(replace(PAIR, least_contact_ratio=ratio), SPAN, POINTS)
    lowest = brentq(lambda shift: difference_of_sliding(shift) - 3.08, -0.15, 0.1, xtol=1e-14)
    assert found.low == pytest.approx(lowest, abs=1e-10)
    assert found.high == pytest.approx(shift_at(ratio), abs=1e-10)
    assert (found.low_limits, found.high_limits) == (("margin_sliding",), ("margin_contact_ratio",))


def test_equal_sliding_is_found_whatever_the_limits() -> None:
    wanted = brentq(difference_of_sliding, 0.1, 0.6, xtol=1e-14)
    assert equal_sliding(PAIR, SPAN, POINTS) == pytest.approx(wanted, abs=1e-10)
    assert equal_sliding(replace(PAIR, least_contact_ratio=2.9), SPAN, POINTS) == pytest.approx(wanted, abs=1e-10)
    assert isnan(equal_sliding(PAIR, (0.4, 1.0), 101))


@pytest.fixture(scope="module")
def field() -> Field:
    """With a contact ratio of 1.2 the optimum lies within."""
    found = field_of(replace(PAIR, least_contact_ratio=1.2), SPAN, 4001)
    assert found is not None
    return found


@pytest.mark.parametrize("reading", READINGS)
def test_box_agrees_with_the_grid(field: Field, reading: str) -> None:
    weights = weights_of(reading, field.ranges)
    grid = grid_optimum(field, weights)
    found = box_optimum(field, weights, SPAN, np.random.default_rng(0), Plan())
    assert found.settled
    assert found.point[0] == pytest.approx(grid, abs=2e-7)


def test_the_optimum_within_is_where_the_weighed_sum_is_level(field: Field) -> None:
    """The sum written a second time, its derivative 0 at the optimum."""
    ranges, weights = field.ranges, weights_of("printed", field.ranges)
    stress = {}
    for shift in (0.62, 0.625, 0.63):
        meshing: Any = ROLLER_SCREW_SHIFT.function(replace(PAIR, roller_shift=shift))
        stress[shift] = float(meshing.stress_difference) / 1e6
    through = np.polyfit(list(stress), list(stress.values()), 2)

    def cost(shift: float) -> float:
        level = float(np.polyval(through, shift))
        values = (2 * shift + by_hand(0.0)["ring"], level, abs(difference_of_sliding(shift)))
        parts = [2 * pi * (value - low) / (high - low) for value, (low, high) in zip(values, ranges, strict=True)]
        curves = [(part - np.sin(part)) / (2 * pi) for part in parts]
        return float(-weights[0] * curves[0] + weights[1] * curves[1] + weights[2] * curves[2])

    best = grid_optimum(field, weights)
    slope = (cost(best + 1e-4) - cost(best - 1e-4)) / 2e-4
    bend = (cost(best + 1e-3) - 2 * cost(best) + cost(best - 1e-3)) / 1e-6
    assert abs(slope / bend) < 1e-5
    assert bend > 0


def test_results_of_a_run_by_hand() -> None:
    answers = run().answers
    shift = shift_at(1.4)
    assert answers["highest_shift"] == pytest.approx(shift, abs=1e-10)
    assert answers["optimal_shift_roller"] == pytest.approx(shift, abs=2e-6)
    assert answers["most_sum"] == pytest.approx(2 * shift + by_hand(0.0)["ring"], abs=1e-9)
    assert answers["least_sliding"] == pytest.approx(difference_of_sliding(shift), abs=1e-9)
    assert answers["optimal_contact_ratio"] == pytest.approx(1.4, abs=2e-6)
    assert answers["weight_sum"] == pytest.approx(4 / (answers["most_sum"] - answers["least_sum"]) ** 2, rel=1e-12)
    assert 0 <= answers["limit_distance"] < 2e-6
    assert 0 <= answers["optimal_margin"] < 2e-6
    assert answers["grid_distance"] < 2e-6
    assert 100 < answers["evaluations"] < 2000


def test_a_seed_tells_the_run_and_every_seed_the_same_optimum() -> None:
    again = run.__wrapped__(seed=0)
    documents = [done.outcomes["shift"].as_json() for done in (run(), again, run(seed=1))]
    assert documents[0] == documents[1]
    assert documents[0]["box"] != documents[2]["box"]
    assert documents[0]["box"]["shift"] == pytest.approx(documents[2]["box"]["shift"], abs=2e-6)
    assert documents[0]["limits"] == ["margin_contact_ratio"]


@pytest.mark.parametrize("reading", READINGS)
def test_weights_by_every_reading(reading: str) -> None:
    answers = run(weights=reading).answers
    found = answers["weight_sum"], answers["weight_stress"] * 1e12, answers["weight_sliding"]
    ranges = [
        (answers["least_sum"], answers["most_sum"]),
        (answers["least_stress_difference"] / 1e6, answers["most_stress_difference"] / 1e6),
        (answers["least_sliding"], answers["most_sliding"]),
    ]
    wanted = {
        "own_ranges": [4 / (high - low) ** 2 for low, high in ranges],
        "printed_ranges": [4 / 2.7**2, 4 / 33.2**2, 4 / 3.08**2],
        "printed": [0.35, 0.01, 0.81],
    }
    assert found == pytest.approx(wanted[reading], rel=1e-9)


def test_no_shift_that_keeps_every_limit_is_a_sentence_and_no_number() -> None:
    done = run(least_contact_ratio=2.2)
    chosen: Any = done.outcomes["shift"]
    (warning,) = chosen.warnings()
    assert "no shift of the roller from -2 to 3 keeps every limit" in warning
    assert "margin_contact_ratio (-" in warning
    assert isnan(done.answers["optimal_shift_roller"])
    assert chosen.as_json()["status"] == chosen.status
    assert set(chosen.as_json()) == {"status", "equal_sliding"}
    assert chosen.checks() == ()


def test_without_load_the_stresses_have_nothing_to_say() -> None:
    done = run(axial_load="0 kN")
    (warning,) = done.outcomes["shift"].warnings()
    assert "difference of the root stresses is the same for every shift" in warning
    assert done.answers["weight_stress"] == 0.0
    assert done.answers["optimal_shift_roller"] == pytest.approx(shift_at(1.4), abs=2e-6)


def test_an_interval_too_thin_for_nine_vertices_leaves_the_grid() -> None:
    done = run(most_sliding_difference=difference_of_sliding(shift_at(1.4) - 1e-5),
               study=Shifting(span=(0.2, 0.3), points=20_001, ratios=(), gives=GIVES))  # fmt: skip
    chosen: Any = done.outcomes["shift"]
    assert "the grid's optimum stands" in chosen.warnings()[0]
    assert chosen.shift == pytest.approx(shift_at(1.4), abs=2e-5)
    assert isnan(done.answers["evaluations"])


def test_optimum_by_contact_ratio_and_weights() -> None:
    chosen: Any = run(study=Shifting(points=POINTS, ratios=(1.2, 1.42))).outcomes["shift"]
    found = chosen.as_json()["variants"]
    shifts = {(item["least_contact_ratio"], item["weights"]): item["shift"] for item in found}
    assert len(shifts) == 9
    for (ratio, _), shift in shifts.items():
        if ratio > 1.2:
            assert shift == pytest.approx(shift_at(ratio), abs=1e-5)
    assert [round(shifts[1.2, reading], 3) for reading in READINGS] == [0.641, 0.635, 0.626]


def test_the_stresses_must_weigh_many_times_as_much_to_leave_the_limit() -> None:
    """At the ends of the interval the weighed sum is w2 - w1 and w3: beyond w2 = w1 + w3 the far end wins at last."""
    chosen: Any = run(weights="printed").outcomes["shift"]
    assert chosen.factor is not None
    assert 10 < chosen.factor <= (0.35 + 0.81) / 0.01 + 0.1


def test_an_optimum_at_a_limit_leaves_nothing_for_scatter() -> None:
    """The contact ratio falls as the centres come apart or together; 10 um are three standard deviations of that."""
    answers = run().answers
    assert answers["kept_at_optimum"] == pytest.approx(0.5, abs=4 * 0.5 / sqrt(8192))

    def ratio(deviation: float) -> float:
        meshing: Any = ROLLER_SCREW_SHIFT.function(ROLLER_SCREW_SHIFT.inputs(centre_distance_deviation=deviation))
        return float(meshing.contact_ratio)

    margin = by_hand(0.21)["ratio"] - 1.4
    slope = (ratio(1e-6) - ratio(-1e-6)) / 2e-6
    wanted = NormalDist().cdf(margin / (abs(slope) * 10e-6 / 3))
    assert 0.9 < wanted < 1.0
    spread = sqrt(wanted * (1 - wanted) / 8192)
    assert answers["kept_as_stated"] == pytest.approx(wanted, abs=4 * spread + 1 / 8192)
    inside = run(least_contact_ratio=1.2, sliding_reading="roots").answers
    assert inside["kept_at_optimum"] > 0.98


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"span": (1.0, 1.0)}, "lowest and the highest"), ({"points": 5}, "points = 5"),
        ({"ratios": (0.9,)}, "least contact ratios"), ({"vertices": 2}, "vertices = 2"),
        ({"reflection": 0.5}, "reflection"), ({"spread": -1.0}, "spread"),
        ({"probability": 0.3}, "probability = 0.3"), ({"probability": 1.0}, "probability = 1"),
    ],
)  # fmt: skip
def test_options_that_make_no_sense_are_refused(options: dict[str, Any], said: str) -> None:
    with pytest.raises(TruingError, match=said):
        Shifting(**options)


# The shift that scatter leaves


def mounted_ratio(shift: float, deviation: float) -> float:
    """Contact ratio of a pair made for CENTRES and mounted ``deviation`` mm farther apart."""
    working = acos(0.5 * MODULE * (RING - ROLLER) * cos(ALPHA) / (CENTRES + deviation))
    ring = by_hand(shift)["ring"]
    tip = acos(0.5 * ROLLER * cos(ALPHA) / (0.5 * ROLLER + ADDENDUM + shift))
    ring_tip = acos(0.5 * RING * cos(ALPHA) / (0.5 * RING - ADDENDUM + ring))
    return (ROLLER * (tan(tip) - tan(working)) - RING * (tan(ring_tip) - tan(working))) / (2 * pi)


@pytest.mark.parametrize("probability", [0.9, 0.99])
def test_the_robust_shift_is_where_the_quantile_of_the_centres_keeps_the_ratio(probability: float) -> None:
    """Centres of ±10 um, six standard deviations: the ratio falls with one sense, so its quantile is that of them."""
    done = run(study=Shifting(points=POINTS, ratios=(), probability=probability, gives=GIVES))
    sense = np.sign(mounted_ratio(0.21, -1e-3) - mounted_ratio(0.21, 1e-3))
    spread = sense * 10e-3 / 3

    def shift(quantile: float) -> float:
        return float(brentq(lambda at: mounted_ratio(at, quantile * spread) - 1.4, -0.2, 0.4, xtol=1e-14))

    wanted = shift(NormalDist().inv_cdf(probability))
    error = sqrt(probability * (1 - probability) / 8192)  # of a share; four of them in places of the shift
    ends = (shift(NormalDist().inv_cdf(probability + sign * 4 * error)) for sign in (1, -1))
    low, high = ends
    found = done.answers["robust_shift_roller"]
    assert low < found < high
    assert high - low < 0.2 * abs(wanted - shift_at(1.4))
    assert probability <= done.answers["kept_at_robust"] < probability + 2 / 8192
    assert done.answers["robust_contact_ratio"] == pytest.approx(by_hand(found)["ratio"], rel=1e-9)
    assert f"{100 * probability:g} % do is {found:.4f} for the roller" in words(sheet.choice(done.record))


def test_screws_of_another_draw_keep_the_robust_shift_too() -> None:
    shift, count = run().answers["robust_shift_roller"], 100_000
    deviations = 10e-3 / 3 * np.random.default_rng(77).standard_normal(count)
    reach = np.array([mounted_ratio(shift, deviation) for deviation in (-20e-3, 0.0, 20e-3)])
    ratios = np.polyval(np.polyfit([-20e-3, 0.0, 20e-3], reach, 2), deviations)
    assert np.mean(ratios >= 1.4) == pytest.approx(0.99, abs=4 * sqrt(0.0099 * (1 / 8192 + 1 / count)))


def test_an_optimum_within_its_interval_stays_and_one_that_nothing_keeps_is_named() -> None:
    study = Shifting(points=POINTS, ratios=(), probability=0.9, gives=GIVES)
    inside = run(least_contact_ratio=1.2, sliding_reading="roots", study=study).answers
    assert inside["kept_at_optimum"] > 0.98
    assert inside["robust_shift_roller"] == pytest.approx(inside["optimal_shift_roller"], abs=1e-3)
    nowhere = run(most_sliding_difference=difference_of_sliding(shift_at(1.4) - 1e-3))
    assert isnan(nowhere.answers["robust_shift_roller"])
    assert "There is no shift at which 99 % of them do." in words(sheet.choice(nowhere.record))


def test_the_largest_sliding_is_least_where_both_roots_slide_alike() -> None:
    """That of the roller falls with the shift and that of the ring rises; both by the path, place by place."""
    answers = run(least_contact_ratio=1.2).answers
    assert answers["gentlest_shift"] == pytest.approx(answers["equal_sliding_roller"], abs=5e-4)
    hand = by_hand(answers["gentlest_shift"])
    assert answers["gentlest_sliding"] == pytest.approx(max(hand["roller_sliding"], hand["ring_sliding"]), rel=1e-9)


def test_the_chart_over_the_contact_ratio_holds_the_optima_of_every_limit() -> None:
    chosen: Any = run(study=Shifting(points=POINTS, ratios=(1.2, 1.42), gives=GIVES)).outcomes["shift"]
    ratios = np.array([1.2, 1.4, 1.42, 1.46])
    for reading in READINGS:
        shifts = over_ratios(chosen, ratios, reading, robust=False)
        found = {each.least_contact_ratio: each.shift for each in chosen.variants if each.weights == reading}
        assert shifts[:3] == pytest.approx([found[ratio] for ratio in ratios[:3]], abs=2e-3)
        assert shifts[3] == pytest.approx(shift_at(1.46), abs=2e-3)
    robust = over_ratios(chosen, ratios, "own_ranges", robust=True)
    assert robust[1] == pytest.approx(chosen.robust, abs=3e-3)
    assert (robust[1:] < shifts[1:]).all()


# The front of the three objectives


@pytest.fixture(scope="module")
def optimum() -> Any:
    """The paper's problem without weights, with a small search."""
    study: Any = next(study for study in ROLLER_SCREW_SHIFT.studies if study.name == "optimise")
    small = replace(study, population=24, generations=16)
    return calculate(replace(default_setup(ROLLER_SCREW_SHIFT), studies=(small,))).outcomes["optimise"]


def test_the_front_is_the_interval(optimum: Any) -> None:
    """More sum and more equal sliding cost more difference of the stresses all along, so no shift beats another."""
    shifts = np.array([design.inputs["roller_shift"] for design in optimum.front])
    low = brentq(lambda shift: difference_of_sliding(shift) - 3.08, -0.15, 0.1)
    assert [aim.sense for aim in optimum.aims] == ["maximise", "minimise", "minimise"]
    assert {bound.name for bound in optimum.bounds} == {*MARGINS, "margin_pressure"}
    assert shifts.max() <= shift_at(1.4) < shifts.max() + 0.01
    assert shifts.min() >= low > shifts.min() - 0.01
    for design in optimum.front:
        shift = design.inputs["roller_shift"]
        assert design.objectives["shift_sum"] == pytest.approx(2 * shift + by_hand(0.0)["ring"], abs=1e-12)
        assert design.objectives["sliding_difference"] == pytest.approx(difference_of_sliding(shift), abs=1e-9)


def test_a_front_without_a_knee_says_so(optimum: Any) -> None:
    """The sum of the objectives, each 0 to 1, is nowhere below 1: no design lies before the plane."""
    values = np.array([[design.objectives[aim.name] * aim.sign for aim in optimum.aims] for design in optimum.front])
    scaled = (values - values.min(axis=0)) / np.ptp(values, axis=0)
    assert scaled.sum(axis=1).min() > 1 - 1e-9
    (table,) = [block for block in optimum.blocks() if isinstance(block, Table) and block.title == "Start and knee"]
    assert table.note.startswith("The front has no knee")


# What sections read of it


def test_the_sheet_says_where_the_optimum_lies_and_what_holds_it() -> None:
    done = run()
    assert "0.2534 for the roller and −0.1165 for the ring" in words(sheet.choice(done.record))
    assert "It stands at a limit: g3 contact ratio." in words(sheet.choice(done.record))
    assert "leaves nothing for scatter" in words(sheet.choice(done.record))
    assert "away from its own axis" in words(sheet.signs(done.record))
    assert "from −0.0674 (where g10 difference of sliding is missed) to 0.2534" in words(sheet.limits(done.record))
    inside = run(least_contact_ratio=1.2)
    assert "It lies within its interval" in words(sheet.choice(inside.record))
    assert "the optimum would be 0.6140 for the roller" in words(sheet.choice(inside.record))
    assert "there is the same optimum" in words(sheet.choice(done.record))
    nowhere = run(least_contact_ratio=2.2)
    assert "keeps every limit" in words(sheet.limits(nowhere.record))
    assert sheet.choice(nowhere.record) == []
    assert sheet.weights(nowhere.record) == []
