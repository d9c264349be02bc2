"""What the paper prints, for comparison under the same settings, and what it leaves open."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Literal

from roller_screw_shift.objectives import PRINTED_RANGES, PRINTED_WEIGHTS
from truing import Finding, Published

ShiftObtained = Literal["predicted", "calibrated"]
ShiftRow = tuple[str, str, str, str]  # name, result, as printed, unit

TEXT = "text below Table 1"
RULE = (
    "the paper's own rule gives this weight from the range that it prints beside it; it would follow from a lower "
    "limit of {limit}"
)
SUM = (
    "the printed range of the sum cannot be that of a sum of shifts: the sum at the printed optimum itself is 0.05, "
    "and its difference of −0.37 lies outside too"
)
LOAD = "load and width are lost with Table 1; the tangential load was chosen so that this difference follows"
NEVER = "the notch of the ring is sharper, so its root stress exceeds that of the roller at every shift allowed"
HELD = (
    "0 needs the shift of 0.2833 at which both roots slide alike, and that has a contact ratio of 1.384, less than "
    "the 1.4 asked for here"
)
REACHED = "with a contact ratio of 1.2 the shift at which both roots slide alike is allowed"
BOUND = "without a bound the difference grows without end; the printed limit was taken as that bound"
PAIR = "the centre distance was chosen so that the printed pair meshes without backlash; index 1 read as the roller"
LOST = (
    "the limit of the contact ratio decides, and it is lost in equation 8; with the common 1.4 the optimum is 0.04 "
    "beside the printed one"
)
FITTED = "limit fitted, to two digits; 0.006 beside the printed shift"
OWN = "limit set to the contact ratio of the printed pair itself"
ROOTS = (
    "the sliding at the roots alone, which folds where the path of contact begins near the pitch point: there the tip "
    "slides more; with it the optimum is 0.03 lower"
)
COMMON = "with the other common limit of 1.2 no limit holds the optimum; the weights decide, and lead elsewhere"
OTHER = "the printed weights lead to the same place: the contact ratio holds the optimum"
ALONE = "where sliding alone would put the optimum; the paper balances three objectives"


def only(**settings: str) -> Mapping[str, str]:
    """Settings of a run in which only the choice of the shift is needed."""
    return {**settings, "studies.run": '["shift"]'}


def printed(row: ShiftRow, obtained: ShiftObtained, why: str, settings: Mapping[str, str]) -> Published:
    """One number (name, result, as printed, unit) that comes out."""
    name, result, text, unit = row
    return Published(
        name=name, result=result, value=float(text), printed=text, unit=unit, where=TEXT, settings=settings,
        obtained=obtained, why=why,
    )  # fmt: skip


def differing(row: ShiftRow, why: str, settings: Mapping[str, str], obtained: ShiftObtained = "predicted") -> Published:
    """One number (name, result, as printed, unit) that does not come out."""
    return replace(printed(row, obtained, why, settings), verdict="differs")


def weights() -> Iterator[Published]:
    """The printed weights beside those that the paper's rule gives from the ranges that it prints."""
    rule = only(weights="printed_ranges")
    for name, result, value, unit, limit in (
        ("weight of the sum of the shifts", "weight_sum", f"{PRINTED_WEIGHTS[0]:.2f}", "", "2.00"),
        ("weight of the stress difference", "weight_stress", f"{PRINTED_WEIGHTS[1]:.2f}", "1/MPa^2", "13.2 MPa"),
        ("weight of the sliding difference", "weight_sliding", f"{PRINTED_WEIGHTS[2]:.2f}", "", "0.86"),
    ):
        yield differing((name, result, value, unit), RULE.format(limit=limit), rule)


def ranges() -> Iterator[Published]:
    """Both ends of the range of each objective."""
    (least_sum, most_sum), (least_stress, most_stress), (least_sliding, most_sliding) = PRINTED_RANGES
    low, high = f"{least_sliding:.2f}", f"{most_sliding:.2f}"
    yield differing(("smallest sum of the shifts", "least_sum", f"{least_sum:.2f}", ""), SUM, only())
    yield differing(("largest sum of the shifts", "most_sum", f"{most_sum:.2f}", ""), SUM, only())
    yield differing(("smallest stress difference", "least_stress_difference", f"{least_stress:.1f}", "MPa"), NEVER,
                    only())  # fmt: skip
    yield printed(("largest stress difference", "most_stress_difference", f"{most_stress:.1f}", "MPa"), "calibrated",
                  LOAD, only())  # fmt: skip
    yield differing(("smallest sliding difference", "least_sliding", low, ""), HELD, only())
    yield printed(("smallest sliding difference, contact ratio 1.2", "least_sliding", low, ""), "predicted",
                  REACHED, only(least_contact_ratio="1.2"))  # fmt: skip
    yield printed(("largest sliding difference", "most_sliding", high, ""), "calibrated", BOUND, only())


def optima() -> Iterator[Published]:
    """The printed optimum, with the contact ratio asked for as it may have been."""
    yield printed(("shift of the ring without backlash", "ring_shift", "-0.16", ""), "calibrated", PAIR, only())
    yield from optimum("", differs=LOST)
    yield from optimum(", printed weights", differs=OTHER, weights="printed")
    yield from optimum(", contact ratio 1.2", differs=COMMON, least_contact_ratio="1.2")
    yield from optimum(", contact ratio 1.2, sliding at the roots", differs=ROOTS, least_contact_ratio="1.2",
                       sliding_reading="roots")  # fmt: skip
    yield from optimum(", contact ratio 1.42", differs=FITTED, obtained="calibrated", least_contact_ratio="1.42")
    yield from optimum(", contact ratio 1.423", OWN, least_contact_ratio="1.423")
    yield differing(("shift of the roller, equal sliding alone", "equal_sliding_roller", "0.21", ""), ALONE, only())
    yield differing(("shift of the ring, equal sliding alone", "equal_sliding_ring", "-0.16", ""), ALONE, only())


def optimum(
    settings_in_words: str,
    fits: str = "",
    differs: str = "",
    obtained: Literal["predicted", "calibrated"] = "predicted",
    **settings: str,
) -> Iterator[Published]:
    """Both shifts of the printed optimum under these settings: calibrated where they come out, or why they do not."""
    for name, text in (("roller", "0.21"), ("ring", "-0.16")):
        row = (f"optimal shift of the {name}{settings_in_words}", f"optimal_shift_{name}", text, "")
        if differs:
            yield differing(row, differs, only(**settings), obtained)
        else:
            yield printed(row, "calibrated", fits, only(**settings))


PUBLISHED = [*weights(), *ranges(), *optima()]


# Where the paper leaves something open or cannot be read literally, and what its reader must know

TOLD = {
    "Table 1 and equations 1 and 6 to 8 are lost": "Teeth, module, centre distance, load and width of the example are "
    "not to be had, nor the form of the first objective and the limit of the contact ratio. What stands here is one "
    "set of sizes that fits together: a screw with five starts needs a nut five times as large as its rollers, so the "
    "ring has five times the teeth of a roller; the centre distance makes the printed pair mesh without backlash; the "
    "tangential load makes the largest difference of the root stresses the printed 33.2 MPa. Another set gives other "
    "numbers.",
    "Indices 1 and 2 contradict one another": "In the words 1 is the ring and 2 the roller; in equations 9 to 11 they "
    "must be the other way round. With 1 as the ring equation 9 gives −0.630 instead of 0.630 (asked for: 0.05), the "
    "clearance at the root in equation 11 is −39.8 mm instead of 0.107 mm, and the tip distance of equation 10 is "
    "0.743 instead of 38.8 mm. Teeth of full depth with +0.21 on the ring and −0.16 on the roller interfere with "
    "16/80, 18/90 and 20/100 teeth. The printed optimum is therefore read as +0.21 for the roller and −0.16 for the "
    "ring, and roller and ring are named here.",
    "Equation 12 asks for the opposite of equations 9 to 11": "It prints g ≤ 0 for all six constraints; equations 9 to "
    "11, each by itself, ask for ≥ 0. Read here: 0 or more, for all.",
    "The curve that brings the objectives to 0 to 1 lacks a factor": "Printed is y = x/2π − sin x, which falls to "
    "−0.76, rises to 1.76 and turns back twice. With x/2π − (sin x)/2π it rises from 0 to 1. That curve is level at "
    "both ends: nearer than about 1e-6 to a limit of the shift the weighed sum no longer changes, and no search can "
    "tell such shifts apart.",
    "The printed weights do not follow from the printed ranges": "By the paper's rule its ranges give 0.549, 0.0036 "
    "and 0.422; printed are 0.35, 0.01 and 0.81. They would follow from the printed upper limits and lower limits of "
    "2.00, 13.2 and 0.86 instead of 2.68, 0 and 0 (0.01 is rounded: anything from 4.9 to 16.9 would do). The input "
    "weights chooses. The rule also gives each weight a unit: with the stresses in N/m² instead of MPa the second "
    "would be 1e12 times smaller.",
    "The printed range of the sum does not hold the sum of the printed optimum": "The optimum has a sum of 0.05 and a "
    "difference of −0.37; the first objective is said to run from 2.68 to 5.38. So that range cannot be one of a sum "
    "of shifts. Here the sum runs from −0.505 to 0.137.",
    "The zero-backlash equation cannot be the first objective": "At a given centre distance it fixes the difference of "
    "the two shifts of an internal pair: −0.370, whatever the shift, and with the sum of the teeth in place of their "
    "difference −0.555. A number that never changes has no range and cannot be made large. What still varies is the "
    "sum of the shifts; it is taken as the first objective.",
    "The limit of the contact ratio decides the optimum, not the weights": "With 1.4 the optimum stands at that limit, "
    "at 0.2534 and −0.1165, by every reading of the weights; with 1.42 at 0.2157 and −0.1543, near the printed 0.21 "
    "and −0.16. The contact ratio of the printed pair is 1.423. With 1.2 no limit holds it, and the weights decide: "
    "0.641, 0.635 or 0.626 for the roller. With these sizes the lost limit of equation 8 would lie near 1.42; with "
    "others elsewhere.",
    "The printed range of the sliding difference and the printed optimum do not go together": "A smallest difference "
    "of 0 needs the shift of 0.2833 at which both roots slide alike, and there the contact ratio is 1.384. A limit "
    "that holds the optimum at 0.21 forbids that shift: with it the difference is 0.26 or more.",
    "The difference of sliding at the roots folds": "Where the path of contact begins beyond the pitch point, here "
    "from a shift of 0.69 on, the tip of the roller slides more than its root, and the difference by the roots falls "
    "again although both flanks slide ever more. The largest sliding of each gear on the path is compared instead. "
    "With a least contact ratio of 1.4 or more the optimum stays; with 1.2 it moves from 0.614 to 0.641. "
    'sliding_reading = "roots" takes the roots.',
    "Five limits more than the paper has": "Its six leave a very wide range of shifts, and one in which the difference "
    "of sliding grows without end. Involute interference, undercut, tip land and the clearance at the root of the ring "
    "are added, and the printed upper limit of the sliding difference, 3.08, as a bound; it is what ends the range at "
    "its lower end.",
}
FINDINGS = [Finding(title=title, text=text) for title, text in TOLD.items()]
