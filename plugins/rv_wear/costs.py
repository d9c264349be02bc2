"""The zones of the error factors, what a tolerance costs, and a study of the bill."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from truing import Bench, Block, Float, Outcome, Price, Table, Tolerance, by_choice, found, normal, results, zone

# What a tolerance costs: the paper's three cost functions, each in three readings of its lost equations
#
# The paper's text names the coefficients of equations 25 to 27; the equations are lost. The number of coefficients fits
# the families of Z. Dong, W. Hu, D. Xue, New production cost-tolerance models for tolerance synthesis, J. Eng. for
# Industry 116 (1994) 199. Every formula is in the width of the zone in mm and gives yuan. Only the power form gives the
# printed total of 1402 yuan.

Kind = Literal["size", "place", "runout"]
FORMS = ("power", "exponential", "process")

# Equations 25 (size), 26 (place) and 27 (runout) with the coefficients of the paper.
FORMULAS: dict[str, dict[Kind, str]] = {
    "power": {
        "size": "16.140 * width**-0.324 + 0.217 * exp(-0.013 * width) + 2.845",
        "place": "4.862 * width**-0.483 + 0.877 * exp(-1.020 * width)",
        "runout": "23.729 * width**-0.682",
    },
    "exponential": {
        "size": "16.140 * exp(-0.324 * width) + 0.217 * exp(-0.013 * width) + 2.845",
        "place": "4.862 * exp(-0.483 * width) + 0.877 * exp(-1.020 * width)",
        "runout": "23.729 * exp(-0.682 * width)",
    },
    "process": {
        "size": "16.140 * exp(-0.324 * width) + width / (0.217 * width + 0.013) + 2.845",
        "place": "4.862 * exp(-0.483 * width) + width / (0.877 * width + 1.020)",
        "runout": "23.729 * exp(-0.682 * width)",
    },
}


def price(kind: Kind, form: str) -> Price:
    """Return the price of a tolerance of this kind in one form."""
    return Price(FORMULAS[form][kind], width="mm", unit="yuan")


# The zones of the error factors: where each lies, how wide it is, and what it costs
#
# The paper's Table 3 is lost. The zones here give its mean, its reliability after 6000 h and its cost; another split
# with the same mean and standard deviation would serve as well. Every factor scatters normally in its zone, which is
# six standard deviations wide; the inputs hold the middles.

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
    name: str, half: str, why: str, *, grows: Literal["up", "both"] = "both", on: tuple[str, ...] = ()
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


# A study of our own: what every priced tolerance costs, in each reading of the cost functions


@results
class Cost:
    """What the zones cost together."""

    manufacturing_cost: Float = found("yuan", symbol="C", note="of all priced tolerances, as they are",
                                      formula="tolerance_price", source="sum of equations 25 to 27")  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Costs:
    """Price every zone with each form of the cost functions: power, exponential and process."""

    name: str = "costs"
    gives: Callable[[Any], Any] | None = None

    def run(self, bench: "Bench") -> "Bill":
        """Read the width of every priced zone that is in force and price it; one that is off is not paid."""
        widths = {
            name: next(iter(inner.values())).width
            for name, inner in bench.setup.distributions().items()
            if name in PRICED
        }
        prices = {name: {form: price(PRICED[name], form).at(width) for form in FORMS} for name, width in widths.items()}
        return Bill(float(bench.answers["tolerance_price"]), widths, prices)


@dataclass(frozen=True)
class Bill(Outcome):
    """The sum in force (yuan), the width of every priced zone (m), and its price by form (yuan)."""

    total: float
    widths: Mapping[str, float]
    prices: Mapping[str, Mapping[str, float]]

    def as_json(self) -> dict[str, Any]:
        """Return width and prices by tolerance, and the sums by form."""
        return {
            "total": {"value": self.total, "unit": "yuan"},
            "by_form": {form: self.of_form(form) for form in FORMS},
            "tolerances": {
                name: {"width": {"value": width * 1e6, "unit": "um"}, "prices": dict(self.prices[name])}
                for name, width in self.widths.items()
            },
        }

    def of_form(self, form: str) -> float:
        """Return the sum of all prices in one form, yuan."""
        return sum((prices[form] for prices in self.prices.values()), 0.0)

    def blocks(self) -> Sequence[Block]:
        """Return the bill as a table."""
        rows: list[tuple[str | float, ...]] = [
            (name.replace("_", " "), PRICED[name], width * 1e6, *(self.prices[name][form] for form in FORMS))
            for name, width in self.widths.items()
        ]
        rows.append(("all together", "", "", *(self.of_form(form) for form in FORMS)))
        return [
            Table(
                "What the zones cost",
                ("zone", "cost function", "width", *FORMS),
                rows,
                ("", "", "µm", *("yuan" for _ in FORMS)),
                "The paper's coefficients in three forms of its lost equations 25 to 27. Its total is 1402 yuan.",
            )
        ]


def cost(bill: Bill) -> Cost:
    """The one number of the bill that the paper prints."""
    return Cost(manufacturing_cost=bill.total)
