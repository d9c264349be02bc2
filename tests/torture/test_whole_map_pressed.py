"""The whole map of the interferogram, 640 by 480 points, pressed numerically: its row of the theory page.

pytest tests/torture/test_whole_map_pressed.py
"""

from types import SimpleNamespace

import pytest

from harmonic_fractal.flank import read_flank
from harmonic_fractal.pressed import PressedFlanks
from harmonic_fractal.quantities import Drive
from published.test_harmonic_page import PAGE, SURFACES, pressed_row


def test_the_whole_interferogram_is_pressed(full_torture: bool) -> None:
    if not full_torture:
        pytest.skip("half a minute; at full size only")
    pytest.importorskip("ContactMechanics")
    flank = read_flank(SURFACES / "metropro-1.dat")
    assert flank.used is not None
    found = PressedFlanks().run(SimpleNamespace(inputs=Drive(surface=flank)))  # type: ignore[arg-type]
    assert PAGE.row("interferogram, whole") == pressed_row(found, flank.used.dimension + 1.0)
