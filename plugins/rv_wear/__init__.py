"""RV reducer: cycloid wear, backlash over the years, its reliability, and what better tolerances cost."""

from typing import TYPE_CHECKING

from truing import hookimpl

if TYPE_CHECKING:
    from rv_wear.answers import Wear
    from rv_wear.quantities import Reducer
    from truing import Model


@hookimpl
def truing_models() -> "list[Model[Reducer, Wear]]":
    """Offer one calculation: rv_wear."""
    from rv_wear.model import RV_WEAR

    return [RV_WEAR]
