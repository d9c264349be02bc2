"""RV reducer: which tooth numbers give the ratio, and does the first gear stage carry the load?"""

from typing import TYPE_CHECKING

from truing import hookimpl

if TYPE_CHECKING:
    from rv_gearing.answers import Strength
    from rv_gearing.quantities import Gearing
    from truing import Model


@hookimpl
def truing_models() -> "list[Model[Gearing, Strength]]":
    """Offer one calculation: rv_gearing."""
    from rv_gearing.model import RV_GEARING

    return [RV_GEARING]
