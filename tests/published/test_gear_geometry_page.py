"""The numbers on the page of gear geometry are those that the formulas give."""

import numpy as np
import pytest
from test_gear_geometry import FACTORS

from gear_geometry import roots
from gear_geometry.pairs import external_contact_ratio, working_angle
from gear_geometry.roots import Cutter, Rack, external_arm, external_root
from pages import Page

PAGE = Page("gear_geometry")
ALPHA = np.radians(20.0)
RACK = Rack(dedendum=1.25, fillet=0.38, pressure_angle=ALPHA)
SUBSTITUTE = Rack(dedendum=1.1, fillet=0.15, pressure_angle=ALPHA)
BASES = (10.0 * np.cos(ALPHA), 27.5 * np.cos(ALPHA))
RATIO = float(external_contact_ratio((11.0, 28.5), BASES, ALPHA, np.pi * np.cos(ALPHA)))


def factors(root: roots.Root, arm: roots.Arm) -> tuple[float, float]:
    return float(roots.form_factor(root, arm, ALPHA)), float(roots.stress_correction(root, arm))


def outer_single(teeth: float) -> float:
    """Diameter at the outer point of single contact of the pair 20/55, modules."""
    base = 0.5 * teeth * np.cos(ALPHA)
    from_base = np.sqrt((0.5 * teeth + 1.0) ** 2 - base**2) - np.pi * np.cos(ALPHA) * (RATIO - 1.0)
    return 2.0 * float(np.hypot(from_base, base))


@pytest.mark.parametrize(("teeth", "start"), [(20, "sun of 20 teeth against 55"), (55, "planet of 55 teeth")])
def test_load_at_the_tip_and_at_the_outer_point_of_single_contact(teeth: int, start: str) -> None:
    root = external_root(RACK, teeth, 0.0)
    sharing = 0.25 + 0.75 / RATIO
    form, stress = factors(root, external_arm(RACK, teeth, 0.0, root, teeth + 2.0))
    tip = rf"${form:.4f} \cdot {stress:.4f} \cdot {sharing:.4f} = {form * stress * sharing:.3f}$"
    outer_form, outer_stress = factors(root, external_arm(RACK, teeth, 0.0, root, outer_single(teeth)))
    outer = rf"${outer_form:.4f} \cdot {outer_stress:.4f} = {outer_form * outer_stress:.3f}$"
    assert PAGE.row(start) == [tip, outer]
    safer = form * stress * sharing / (outer_form * outer_stress) - 1.0
    assert {20: 7, 55: 3}[teeth] == round(100 * safer)
    PAGE.says(
        "The tip is the safe side here, by 7 and 3 %",
        f"give {100 * (1 - sharing):.0f} % too little",
        "{:.6f} for 20 teeth, {:.6f} for 55".format(*(external_root(RACK, each, 0.0).chord for each in (20, 55))),
    )


def test_the_root_of_a_ring() -> None:
    root = roots.ring_root(SUBSTITUTE)
    found = {"substitute rack": factors(root, roots.ring_arm(SUBSTITUTE, root, 0.8))}
    for teeth, shift in ((20, 0.2), (25, 0.0), (40, 0.0)):
        root = roots.cut_ring_root(Cutter(teeth=teeth, shift=shift, addendum=1.1, fillet=0.15), 100.0, -0.16, ALPHA)
        arm = roots.cut_ring_arm(root, 100.0, -0.16, 50.0 - 0.8 - 0.16, ALPHA)
        found[f"cutter of {teeth} teeth"] = factors(root, arm)
    for start, (form, stress) in found.items():
        assert PAGE.row(start) == [f"{form:.3f}", f"{stress:.3f}", f"{form * stress:.3f}"]
    rack, *cut = (form * stress for form, stress in found.values())
    less = [1.0 - product / rack for product in cut]
    assert min(less) == pytest.approx(1 / 6, abs=0.01)
    assert max(less) == pytest.approx(1 / 3, abs=0.02)


def test_what_was_checked() -> None:
    working = float(working_angle(0.5 / 8.0, ALPHA))
    distance = 3.0 * 4.0 * np.cos(ALPHA) / np.cos(working)
    rack = Rack(dedendum=1.25, fillet=0.15, pressure_angle=ALPHA)
    root = roots.ring_root(rack)
    form, stress = factors(root, roots.ring_arm(rack, root, 1.0))
    apart = []
    chosen = {17, 20, 25, 35, 50, 80, 100, 150, 200}
    for teeth, *expected in (line for line in FACTORS if line[0] in chosen):
        tooth = external_root(RACK, teeth, 0.0)
        found = factors(tooth, external_arm(RACK, teeth, 0.0, tooth, teeth + 2.0))
        apart += [abs(own / printed - 1.0) for own, printed in zip(found, expected, strict=True)]
    PAGE.says(
        f"| {np.degrees(working):.4f}°, {distance:.5f} mm |",
        f"| {form:.4f}, {stress:.4f} |",
        f"| within {100 * max(apart):.1f} % |",
    )
