"""The conformance kit over every calculation that is installed, ours and any guest's."""

import warnings

import pytest

from truing import Kernel
from truing.kernel import Offer
from truing.testing import CHECKS, ConformanceCheck
from truing.testing.subject import Subject

OFFERS = list(Kernel.installed().offers.values())
SUBJECTS = {offer.name: Subject(offer.model, offer.origin) for offer in OFFERS}


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.name)
@pytest.mark.parametrize("offer", OFFERS, ids=lambda offer: offer.name)
def test_installed(offer: Offer, check: ConformanceCheck) -> None:
    subject = SUBJECTS[offer.name]
    if check.needs_run and subject.obstacle:
        pytest.skip(f"the defaults cannot be calculated: {subject.obstacle}")
    with warnings.catch_warnings():
        warnings.simplefilter("default")
        check.run(subject)


def test_something_is_installed() -> None:
    ours = {"press_linkage", "roller_screw_shift", "rv_gearing", "rv_wear"}
    assert ours | {"harmonic_fractal", "harmonic_fractal.made_flank"} <= set(SUBJECTS)
