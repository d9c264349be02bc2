"""Where the paper leaves something open or cannot be read literally, and what its reader must know."""

from truing import Finding

FINDINGS = [
    Finding(
        title="Table 1 and equations 1 and 6 to 8 are lost",
        text="Teeth, module, centre distance, load and width of the example are not to be had, nor the form of the "
        "first objective and the limit of the contact ratio. What stands here is one set of sizes that fits together: "
        "a screw with five starts needs a nut five times as large as its rollers, so the ring has five times the teeth "
        "of a roller; the centre distance makes the printed pair mesh without backlash; the tangential load makes the "
        "largest difference of the root stresses the printed 33.2 MPa. Another set gives other numbers.",
    ),
    Finding(
        title="Indices 1 and 2 contradict one another",
        text="In the words 1 is the ring and 2 the roller; in equations 9 to 11 they must be the other way round. With "
        "1 as the ring equation 9 gives −0.630 instead of 0.630 (asked for: 0.05), the clearance at the root in "
        "equation 11 is −39.8 mm instead of 0.107 mm, and the tip distance of equation 10 is 0.743 instead of 38.8 "
        "mm. Teeth of full depth with +0.21 on the ring and −0.16 on the roller interfere with 16/80, 18/90 and "
        "20/100 teeth. The printed optimum is therefore read as +0.21 for the roller and −0.16 for the ring, and "
        "roller and ring are named here.",
    ),
    Finding(
        title="Equation 12 asks for the opposite of equations 9 to 11",
        text="It prints g ≤ 0 for all six constraints; equations 9 to 11, each by itself, ask for ≥ 0. Read here: 0 or "
        "more, for all.",
    ),
    Finding(
        title="The curve that brings the objectives to 0 to 1 lacks a factor",
        text="Printed is y = x/2π − sin x, which falls to −0.76, rises to 1.76 and turns back twice. With x/2π − "
        "(sin x)/2π it rises from 0 to 1. That curve is level at both ends: nearer than about 1e-6 to a limit of the "
        "shift the weighed sum no longer changes, and no search can tell such shifts apart.",
    ),
    Finding(
        title="The printed weights do not follow from the printed ranges",
        text="By the paper's rule its ranges give 0.549, 0.0036 and 0.422; printed are 0.35, 0.01 and 0.81. They would "
        "follow from the printed upper limits and lower limits of 2.00, 13.2 and 0.86 instead of 2.68, 0 and 0 (0.01 "
        "is rounded: anything from 4.9 to 16.9 would do). The input weights chooses. The rule also gives each weight "
        "a unit: with the stresses in N/m² instead of MPa the second would be 1e12 times smaller.",
    ),
    Finding(
        title="The printed range of the sum does not hold the sum of the printed optimum",
        text="The optimum has a sum of 0.05 and a difference of −0.37; the first objective is said to run from 2.68 to "
        "5.38. So that range cannot be one of a sum of shifts. Here the sum runs from −0.505 to 0.137.",
    ),
    Finding(
        title="The zero-backlash equation cannot be the first objective",
        text="At a given centre distance it fixes the difference of the two shifts of an internal pair: −0.370, "
        "whatever the shift, and with the sum of the teeth in place of their difference −0.555. A number that never "
        "changes has no range and cannot be made large. What still varies is the sum of the shifts; it is taken as "
        "the first objective.",
    ),
    Finding(
        title="The limit of the contact ratio decides the optimum, not the weights",
        text="With 1.4 the optimum stands at that limit, at 0.2534 and −0.1165, by every reading of the weights; with "
        "1.42 at 0.2157 and −0.1543, near the printed 0.21 and −0.16. The contact ratio of the printed pair is 1.423. "
        "With 1.2 no limit holds it, and the weights decide: 0.641, 0.635 or 0.626 for the roller. With these "
        "sizes the lost limit of equation 8 would lie near 1.42; with others elsewhere.",
    ),
    Finding(
        title="The printed range of the sliding difference and the printed optimum do not go together",
        text="A smallest difference of 0 needs the shift of 0.2833 at which both roots slide alike, and there the "
        "contact ratio is 1.384. A limit that holds the optimum at 0.21 forbids that shift: with it the difference "
        "is 0.26 or more.",
    ),
    Finding(
        title="The difference of sliding at the roots folds",
        text="Where the path of contact begins beyond the pitch point, here from a shift of 0.69 on, the tip of the "
        "roller slides more than its root, and the difference by the roots falls again although both flanks slide ever "
        "more. The largest sliding of each gear on the path is compared instead. With a least contact ratio of 1.4 or "
        'more the optimum stays; with 1.2 it moves from 0.614 to 0.641. sliding_reading = "roots" takes the roots.',
    ),
    Finding(
        title="Five limits more than the paper has",
        text="Its six leave a very wide range of shifts, and one in which the difference of sliding grows without end. "
        "Involute interference, undercut, tip land and the clearance at the root of the ring are added, and the "
        "printed upper limit of the sliding difference, 3.08, as a bound; it is what ends the range at its lower end.",
    ),
]
