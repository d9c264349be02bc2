"""The numbers on the page of gear geometry are those that the formulas give."""

from pathlib import Path

import numpy as np
import pytest
from test_gear_geometry import FACTORS

from gear_geometry.pairs import external_contact_ratio, working_angle
from gear_geometry.roots import (
    Arm,
    Cutter,
    Rack,
    Root,
    cut_ring_arm,
    cut_ring_root,
    external_arm,
    external_root,
    form_factor,
    ring_arm,
    ring_root,
)
from gear_geometry.roots import stress_correction as correction

PAGE = (Path(__file__).parents[2] / "docs" / "explanation" / "gear_geometry.md").read_text(encoding="utf-8")
WORDS = " ".join(PAGE.split())
ALPHA = np.radians(20.0)
RACK = Rack(dedendum=1.25, fillet=0.38, pressure_angle=ALPHA)
SUBSTITUTE = Rack(dedendum=1.1, fillet=0.15, pressure_angle=ALPHA)


def row(start: str) -> list[str]:
    """The cells of the row of a table that starts so, without its first cell."""
    line = next(text for text in PAGE.splitlines() if text.startswith(f"| {start}"))
    return [cell.strip() for cell in line.strip("|").split("|")][1:]


def factors(root: Root, arm: Arm) -> tuple[float, float]:
    return float(form_factor(root, arm, ALPHA)), float(correction(root, arm))


def contact_ratio() -> float:
    tip, base = (11.0, 28.5), (10.0 * np.cos(ALPHA), 27.5 * np.cos(ALPHA))
    return float(external_contact_ratio(tip, base, ALPHA, np.pi * np.cos(ALPHA)))


def outer_single(teeth: float) -> float:
    """Diameter at the outer point of single contact of the pair 20/55, modules."""
    base = 0.5 * teeth * np.cos(ALPHA)
    from_base = np.sqrt((0.5 * teeth + 1.0) ** 2 - base**2) - np.pi * np.cos(ALPHA) * (contact_ratio() - 1.0)
    return 2.0 * float(np.hypot(from_base, base))


@pytest.mark.parametrize(("teeth", "start"), [(20, "sun of 20 teeth against 55"), (55, "planet of 55 teeth")])
def test_load_at_the_tip_and_at_the_outer_point_of_single_contact(teeth: int, start: str) -> None:
    root = external_root(RACK, teeth, 0.0)
    sharing = 0.25 + 0.75 / contact_ratio()
    form, stress = factors(root, external_arm(RACK, teeth, 0.0, root, teeth + 2.0))
    tip = rf"${form:.4f} \cdot {stress:.4f} \cdot {sharing:.4f} = {form * stress * sharing:.3f}$"
    outer_form, outer_stress = factors(root, external_arm(RACK, teeth, 0.0, root, outer_single(teeth)))
    outer = rf"${outer_form:.4f} \cdot {outer_stress:.4f} = {outer_form * outer_stress:.3f}$"
    assert row(start) == [tip, outer]
    safer = form * stress * sharing / (outer_form * outer_stress) - 1.0
    assert {20: 7, 55: 3}[teeth] == round(100 * safer)
    assert "The tip is the safe side here, by 7 and 3 %" in WORDS
    assert f"give {100 * (1 - sharing):.0f} % too little" in WORDS


def test_chords() -> None:
    chords = [float(external_root(RACK, teeth, 0.0).chord) for teeth in (20, 55)]
    assert f"{chords[0]:.6f} for 20 teeth, {chords[1]:.6f} for 55" in WORDS


def test_the_root_of_a_ring() -> None:
    root = ring_root(SUBSTITUTE)
    products = [cells(*factors(root, ring_arm(SUBSTITUTE, root, 0.8)))]
    assert row("substitute rack") == products[0]
    for start, teeth, shift in (("of 20", 20, 0.2), ("of 25", 25, 0.0), ("of 40", 40, 0.0)):
        root = cut_ring_root(Cutter(teeth=teeth, shift=shift, addendum=1.1, fillet=0.15), 100.0, -0.16, ALPHA)
        products.append(cells(*factors(root, cut_ring_arm(root, 100.0, -0.16, 50.0 - 0.8 - 0.16, ALPHA))))
        assert row(f"cutter {start} teeth") == products[-1]
    less = [1.0 - float(product[2]) / float(products[0][2]) for product in products[1:]]
    assert min(less) == pytest.approx(1 / 6, abs=0.01)
    assert max(less) == pytest.approx(1 / 3, abs=0.02)


def cells(form: float, stress: float) -> list[str]:
    return [f"{form:.3f}", f"{stress:.3f}", f"{form * stress:.3f}"]


def test_what_was_checked() -> None:
    working = float(working_angle(0.5 / 8.0, ALPHA))
    distance = 3.0 * 4.0 * np.cos(ALPHA) / np.cos(working)
    assert f"| {np.degrees(working):.4f}°, {distance:.5f} mm |" in PAGE
    rack = Rack(dedendum=1.25, fillet=0.15, pressure_angle=ALPHA)
    root = ring_root(rack)
    form, stress = factors(root, ring_arm(rack, root, 1.0))
    assert f"| {form:.4f}, {stress:.4f} |" in PAGE
    apart = []
    chosen = {17, 20, 25, 35, 50, 80, 100, 150, 200}
    for teeth, *expected in (line for line in FACTORS if line[0] in chosen):
        tooth = external_root(RACK, teeth, 0.0)
        found = factors(tooth, external_arm(RACK, teeth, 0.0, tooth, teeth + 2.0))
        apart += [abs(own / printed - 1.0) for own, printed in zip(found, expected, strict=True)]
    assert f"| within {100 * max(apart):.1f} % |" in PAGE
