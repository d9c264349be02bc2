"""The torsion of a catalogue against rough flanks alone: what is missing is a spring in series, and it is found.

The record is that of docs/examples/harmonic_catalogue: the torsion that catalogues print for size 20, ratio 100, in
three straight pieces, with 10 urad of scatter.
"""

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from harmonic_fractal.model import HARMONIC_FRACTAL
from hidden_effects.plugin_asking import model_of
from truing.testing import recorded

EXAMPLE = Path(__file__).parents[2] / "docs" / "examples" / "harmonic_catalogue"
STIFF = 16e3, 25e3, 29e3  # N m/rad
CHANGES = 7.0, 25.0  # N m


@cache
def _document() -> Mapping[str, Any]:
    inputs, record = ((EXAMPLE / name).read_text(encoding="utf-8") for name in ("inputs.toml", "measured.csv"))
    return recorded(model_of("harmonic_fractal"), inputs=inputs, measured=record).answered.document


def measured() -> Any:
    """Torque, N m, and torsion, urad."""
    return np.loadtxt(EXAMPLE / "measured.csv", delimiter=",", skiprows=3, comments="#").T


def rms(values: Any) -> float:
    return float(np.sqrt(np.mean(values**2)))


def test_the_record_is_the_catalogue_with_its_scatter() -> None:
    torque, torsion = measured()
    np.testing.assert_allclose(torque, np.arange(1, 101) * CHANGES[1] / 50, rtol=1e-9)
    ends = np.concatenate([[0.0], CHANGES, [50.0]])
    angles = np.concatenate([[0.0], np.cumsum(np.diff(ends) / STIFF)])
    left = torsion - 1e6 * np.interp(torque, ends, angles)
    assert 8 < rms(left) < 12
    assert abs(left.mean()) < 3


def test_roughness_alone_explains_less_than_a_hundredth() -> None:
    torque, torsion = measured()
    rough = HARMONIC_FRACTAL.function(HARMONIC_FRACTAL.inputs(torque=torque)).rough_torsion
    assert rms(1e6 * rough) < 0.01 * rms(torsion)
    assert 1 - _document()["wrong"]["torsion"]["rmse"]["value"] / rms(torsion) < 0.01


def test_a_spring_in_series_is_named_first_by_its_share() -> None:
    document = _document()
    assert document["verdict"] in {"named", "one_of"}
    corner = document["remainder"]  # three straight pieces are no smooth law: what is left of their corners is small
    assert corner is None or corner["depends_on"] == ["torque"]
    first, *others = document["causes"]
    assert first["effect"] == "series_compliance"
    assert first["same_as"] == []
    assert first["share"] > 0.9
    assert all(each["share"] < first["share"] for each in others)


def test_its_size_is_the_compliance_at_large_torques() -> None:
    """34.5 urad/(N m) above 25 N m; what the drive is softer by at small ones has the shape of a lost motion.

    A smooth law draws the last corner, at half of the torque, only roughly: the spring is known to that.
    """
    first, second = _document()["causes"]
    np.testing.assert_allclose(first["unknowns"]["compliance"]["value"], 1e6 / STIFF[2], rtol=0.08)
    assert second["effect"] == "lost_motion"
