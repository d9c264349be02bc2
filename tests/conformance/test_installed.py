"""The conformance kit over every calculation that is installed, ours and any guest's."""

import pytest

from truing import Kernel
from truing.testing import conformance

pytestmark = pytest.mark.usefixtures("kit_shares_processes")
OFFERS = Kernel.installed().offers
globals().update({f"test_{name.replace('.', '_')}": conformance(offer.model) for name, offer in OFFERS.items()})


def test_something_is_installed() -> None:
    ours = {"press_linkage", "roller_screw_shift", "rv_gearing", "rv_wear"}
    assert ours | {
        "harmonic_fractal",
        "harmonic_fractal.made_flank",
        "press_linkage.loaded",
        "press_linkage.motion",
    } <= set(OFFERS)
