"""What the paper prints, for comparison with what this calculation gives under the same settings."""

from collections.abc import Iterator, Mapping
from typing import Literal

from truing import Published

Obtained = Literal["predicted", "calibrated"]
Row = tuple[str, str, str, str]  # name, result, as printed, unit

GEOMETRY = "one of the indices from which the lost sizes of Table 1 were reconstructed"
SET = "the formula of this factor is lost; it was set to the printed index"
LOWER = "the condition of the lower bound is lost; twice the radial clearance was taken, which comes to 1.4 % beside"
ROUGHNESS = "the roughness 0.694 µm was chosen so that this wear follows; nothing else of the wear was fitted"
OPTIMUM = "Table 5 with the modifications of the optimum is lost; a whole micrometre was taken that gives the print"
ZONES = "Table 3 is lost; the zones were chosen so that mean, reliability at 6000 h and cost follow"
TOGETHER = (
    "Table 3 is lost; the zones were chosen so that mean, reliability and cost follow together; of the printed 11.3 % "
    "that fail that leaves 10.6 %"
)
FORM = "the form of the cost functions and the features they are for were chosen so that this sum follows"
FALL = (
    "Fig. 5 is said to fall only after 4000 h, and no number is printed; read as no failure at all, here 0.01 % fail "
    "after 3000 h and 0.3 % after 4000 h"
)
QUALITATIVE = "said in words; here the share of the steps of modification at which it is so"
MIDDLE = "said in words: in the middle of the contact zone"
BAND = "the paper: every point; here ten from 300 to 3000 h"
LEAST = (
    "first order, zones up to twice as wide as now; the paper's upper bounds (Table 4) and widths (Table 5) are lost, "
    "and how it counts 100 %"
)
KNEE = (
    "not reproduced: the knee depends on the upper bounds of the zones, which are lost with Table 4; up to twice as "
    "wide the front goes on to cheaper designs with more wear"
)

# Number of the constraint, reliability asked for (100 % is read as 0.999), printed cost and wear, modification taken.
CHOSEN = ((1, "0.95", "1291", "3.151", -27), (2, "0.999", "1300", "3.207", -29))
INDICES: tuple[tuple[int, str, Obtained, str], ...] = (
    (1, "-0.037", "calibrated", GEOMETRY),
    (2, "0.025", "calibrated", GEOMETRY),
    (3, "0.025", "predicted", ""),
    (4, "1.56", "calibrated", GEOMETRY),
    (5, "-1.00", "predicted", ""),
    (6, "1.00", "predicted", "the reference itself"),
    (7, "-1.56", "predicted", ""),
    (8, "0.78", "predicted", ""),
    (9, "0.39", "predicted", ""),
    (10, "1.20", "predicted", ""),
    (11, "-0.60", "predicted", ""),
    (12, "1.56", "predicted", ""),
    (13, "-1.00", "predicted", ""),
    (14, "0.00016", "calibrated", SET),
    (15, "1.56", "predicted", ""),
    (16, "1.06", "calibrated", GEOMETRY),
)


def only(*studies: str, **settings: str) -> Mapping[str, str]:
    """Settings of a run in which only these studies are needed."""
    named = ", ".join(f'"{study}"' for study in studies)
    return {**settings, "studies.run": f"[{named}]"}


def printed(
    row: Row, where: str, obtained: Obtained = "predicted", *, why: str = "", settings: Mapping[str, str] | None = None,
    chance: bool = False, differs: bool = False,
) -> Published:  # fmt: skip
    """One printed number."""
    name, result, text, unit = row
    return Published(
        name=name, result=result, value=float(text), printed=text, unit=unit, where=where, settings=settings or {},
        kind="probability" if chance else "", obtained=obtained, why=why,
        verdict="differs" if differs else "matches",
    )  # fmt: skip


def said(row: tuple[str, str, float, str, float], where: str, *, why: str, settings: Mapping[str, str]) -> Published:
    """What is said in words: name, result, the number it is read as, unit, distance that counts as a match."""
    name, result, value, unit, within = row
    return Published(
        name=name, result=result, value=value, unit=unit, where=where, settings=settings, kind="words", within=within,
        why=why,
    )  # fmt: skip


def at(hours: int) -> Mapping[str, str]:
    """The paper's reducer after another working time, without its curve over the time."""
    return only("reliability", working_time=f"{hours} h", **{"studies.reliability.points": "2"})


def ground(equidistant: int, shift: int) -> Mapping[str, str]:
    """The paper's reducer with other modifications, um."""
    return only(equidistant_modification=f"{equidistant} um", shift_modification=f"{shift} um")


def indices() -> Iterator[Published]:
    """Table 2."""
    for number, value, obtained, why in INDICES:
        row = (f"sensitivity index {number}", f"index_{number}", value, "")
        yield printed(row, "Table 2", obtained, why=why, settings=only("sensitivity"))


def optima() -> Iterator[Published]:
    """Both designs that the paper chose: their cost and wear, which only the studies of a whole front can tell."""
    for number, reliability, cost, _, equidistant in CHOSEN:
        chosen = {"equidistant_modification": f"{equidistant} um", "shift_modification": f"{equidistant - 4} um"}
        bought = only("allocation", required_reliability=reliability, **chosen)
        yield differing((f"least cost at optimum {number}", "least_cost", cost, "yuan"), LEAST, bought)
    whole = only("least_costs")
    for number, _, cost, wear, _ in CHOSEN:
        for result, value, unit in (("cost", cost, "yuan"), ("wear", wear, "um")):
            name = f"{result} at optimum {number}, knee of the front"
            yield differing((name, f"corner_{result}_{number}", value, unit), KNEE, whole)


def differing(row: Row, why: str, settings: Mapping[str, str]) -> Published:
    """One printed number that does not come out."""
    return printed(row, FIG_6, why=why, settings=settings, differs=True)


BOUNDS = "text before Table 1"
FIGS = "text on Figs. 1 and 2"
FIG_3, FIG_4, FIG_5, FIG_6 = (f"text on Fig. {number}" for number in (3, 4, 5, 6))
PUBLISHED = [
    *indices(),
    printed(("largest equidistant modification", "equidistant_high", "0.011", "mm"), BOUNDS, settings=only()),
    printed(("smallest equidistant modification", "equidistant_low", "-0.053", "mm"), BOUNDS, "calibrated",
            why=LOWER, settings=only(), differs=True),
    printed(("deepest wear after 6000 h", "max_wear", "3.127", "um"), FIG_6, "calibrated", why=ROUGHNESS,
            settings=only()),
    printed(("deepest wear at optimum 1", "max_wear", "3.151", "um"), FIG_6, "calibrated", why=OPTIMUM,
            settings=ground(-27, -31)),
    printed(("deepest wear at optimum 2", "max_wear", "3.207", "um"), FIG_6, "calibrated", why=OPTIMUM,
            settings=ground(-29, -33)),
    said(("place of the deepest wear", "wear_place", 0.5, "", 0.05), FIGS, why=MIDDLE, settings=only("sweep")),
    said(("force falls with the modification", "force_falls", 1.0, "", 0.0), FIGS, why=QUALITATIVE,
            settings=only("modifications")),
    said(("contact widens with the modification", "mesh_widens", 1.0, "", 0.0), FIGS, why=QUALITATIVE,
            settings=only("modifications")),
    said(("wear falls with the modification", "wear_falls", 1.0, "", 0.0), FIGS, why=QUALITATIVE,
            settings=only("modifications")),
    said(("wear to 3000 h within the 95 % band", "band_share", 100.0, "%", 0.0), FIG_3, why=BAND,
            settings=only("surrogate")),
    printed(("mean backlash, unworn", "backlash_mean", "0.7", "arcmin"), FIG_4, "calibrated", why=ZONES,
            settings=at(0)),
    printed(("share below 1 arcmin, unworn", "accuracy_reliability", "100", "%"), FIG_4, chance=True,
            why="the largest backlash drawn is below 1 arcmin", settings=at(0)),
    printed(("reliability after 3000 h", "accuracy_reliability", "100", "%"), FIG_5, why=FALL, settings=at(3000),
            chance=True, differs=True),
    printed(("reliability after 4000 h", "accuracy_reliability", "100", "%"), FIG_5, why=FALL, settings=at(4000),
            chance=True, differs=True),
    printed(("reliability after 6000 h", "accuracy_reliability", "88.7", "%"), FIG_5, "calibrated", why=TOGETHER,
            settings=at(6000), chance=True, differs=True),
    printed(("cost before optimisation", "manufacturing_cost", "1402", "yuan"), FIG_6, "calibrated", why=FORM,
            settings=only("costs")),
    *optima(),
]  # fmt: skip
