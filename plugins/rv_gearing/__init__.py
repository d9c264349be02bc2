"""RV reducer: which tooth numbers give the ratio, and does the first gear stage carry the load?"""

from rv_gearing.model import RV_GEARING
from rv_gearing.quantities import Gearing
from rv_gearing.rating import Strength
from truing import Model, hookimpl


@hookimpl
def truing_models() -> "list[Model[Gearing, Strength]]":
    """Offer one calculation: rv_gearing."""
    return [RV_GEARING]
