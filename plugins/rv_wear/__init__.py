"""RV reducer: cycloid wear, backlash over the years, its reliability, and what better tolerances cost."""

from rv_wear.model import RV_WEAR
from rv_wear.quantities import Reducer, Wear
from truing import Model, hookimpl


@hookimpl
def truing_models() -> "list[Model[Reducer, Wear]]":
    """Offer one calculation: rv_wear."""
    return [RV_WEAR]
