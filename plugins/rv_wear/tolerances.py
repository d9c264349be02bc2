"""The zones of the error factors: where each lies, how wide it is, and what it costs.

The paper's Table 3 is lost. The zones here give its mean, its reliability after 6000 h and its cost; another split with
the same mean and standard deviation would serve as well. Every factor scatters normally in its zone, which is six
standard deviations wide; the inputs hold the middles.
"""

from typing import Literal

from rv_wear.costs import FORMS, Kind, price
from truing import Tolerance, by_choice, normal, zone

# Which cost function holds for which zone; the paper names the functions, not the features they are for.
PRICED: dict[str, Kind] = {
    "pin_circle_error": "size",
    "pin_radius_error": "size",
    "modification_error": "size",
    "pin_position_error": "place",
    "disc_pitch_error": "place",
    "disc_runout": "runout",
}
SOURCE = "chosen to fit; Table 3 is lost"


def factor(
    name: str,
    half: str,
    why: str,
    *,
    grows: Literal["up", "both"] = "both",
    on: tuple[str, ...] = (),
) -> Tolerance:
    """A zone of an error factor, ``half`` to either side of its middle; one that grows up keeps its lower end."""
    priced = PRICED.get(name)
    prices = by_choice("cost_form", **{form: price(priced, form) for form in FORMS}) if priced else None
    return Tolerance(
        name, zone(f"-{half}", half, grows=grows), on=on or (name,), why=why, source=SOURCE,
        price=prices,
    )  # fmt: skip


TOLERANCES = [
    factor("base_tangent_error", "5 um", "factor 1: teeth are ground thinner, −20 to −10 µm"),
    factor("gear_runout", "5 um", "factor 2: 0 to 10 µm"),
    factor("centre_distance_error", "10 um", "factor 3: ±10 µm"),
    factor("pin_circle_error", "0.6 um", "factor 6: ±0.6 µm"),
    factor("pin_radius_error", "0.5 um", "factor 7: −2.5 to −1.5 µm"),
    factor("pin_fit_clearance", "0.8 um", "factor 8: 7.7 to 9.3 µm"),
    factor("disc_runout", "3.275 um", "factor 9: 0 to 6.55 µm, the lower end stays", grows="up"),
    factor("pin_position_error", "0.6 um", "factor 10: 0 to 1.2 µm, the lower end stays", grows="up"),
    factor("disc_pitch_error", "1 um", "factor 11: ±1 µm"),
    factor(
        "modification_error", "0.6 um", "factors 12 and 13: ±0.6 µm each, one width and one price",
        on=("equidistant_error", "shift_error"),
    ),
    factor("eccentricity_error", "2 um", "factor 14: ±2 µm"),
    factor("bearing_clearance", "0.6 um", "factor 16: 10.5 to 11.7 µm"),
    Tolerance(
        "composite_roughness", normal(sd="1.26 %"), why="2 % in the wear coefficient: the scatter of wear, factor 15",
        source="the paper: wear scatters normally; its size is not printed",
    ),
]  # fmt: skip
