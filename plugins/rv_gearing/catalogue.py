"""Ratios of a reducer of this size in its maker's catalogue, and teeth that give all of them at one centre distance.

The catalogue prints ratios and no teeth. With 40 pins and sun and planet of 75 teeth together all five come out.
"""

from rv_gearing.duty import centre_distance_of, ratio_of
from rv_gearing.quantities import Gearing
from truing import Table

PINS = 40
RATIOS = ((81.0, 25, 50), (111.0, 20, 55), (127.7, 18, 57), (161.0, 15, 60), (175.2, 14, 61))  # printed, sun, planet
MODULE = 1.25e-3  # m, of the paper
TORQUE = 1078.0  # N m, of the catalogue at 15 turns per minute


def catalogue_table(stage: Gearing) -> Table:
    """Return the ratios of the catalogue beside those of the teeth, and their centre distance with this module."""
    rows = []
    for printed, sun, planet in RATIOS:
        ratio = float(ratio_of(sun, planet, PINS))
        centre = 1e3 * float(centre_distance_of(stage, sun, planet))
        rows.append((printed, sun, planet, PINS, ratio, round(100.0 * (ratio / printed - 1.0), 3), centre))
    return Table(
        "Ratios of the RV-110E in the catalogue of its maker",
        ("catalogue", "sun", "planet", "pins", "ratio", "deviation", "centre distance"),
        rows,
        ("", "", "", "", "", "%", "mm"),
        "Shaft rotation. The catalogue prints no teeth; these are inferred: of all sums of sun and planet up to 100, "
        "75 alone gives all five ratios with 40 pins. Suns of 14 and 15 teeth need profile shift, which the rule of at "
        "least 17 teeth does not know.",
    )
