"""Waves on long records are passed through and not kept: a diagnosis says the same of them either way."""

from collections.abc import Mapping
from typing import Any

import pytest

from hidden_effects.asking import diagnosed
from hidden_effects.making import Wish, make_case
from hidden_effects.press_machine import POSITION, TILT
from truing.diagnosis import conditional, curves

EVERY, NONE = 0, 10**12
BOTH = (POSITION, TILT)
WISHES = [
    (1, Wish("unknown", "wide", "gaussian", BOTH, 80, (), 2.0, "hum")),
    (11, Wish("single", "wide", "autocorrelated", BOTH, 80, ("link_heating",), 2.0)),
]


def numbers(said: Any, path: str = "") -> dict[str, Any]:
    """Everything that a document says, by where it stands; formulas aside, which are made of its numbers."""
    if isinstance(said, (Mapping, list)):
        inner = said.items() if isinstance(said, Mapping) else enumerate(said)
        return {at: each for key, value in inner for at, each in numbers(value, f"{path}.{key}").items()}
    return {} if path.endswith(".expression") else {path: said}


@pytest.mark.parametrize(("seed", "wish"), WISHES, ids=[wish.kind for _, wish in WISHES])
def test_waves_that_are_passed_through_give_what_kept_curves_give(
    monkeypatch: pytest.MonkeyPatch, seed: int, wish: Wish
) -> None:
    """Terms are kept in single precision, with seven digits; blocks are of a few points, one of them not full."""
    monkeypatch.setattr(conditional, "BLOCK", 7 * 160)
    documents = []
    for limit in (NONE, EVERY):
        monkeypatch.setattr(curves, "LARGE", limit)
        documents.append(numbers(diagnosed(make_case(seed, wish)).document))
    kept, passed = documents
    assert passed.keys() == kept.keys()
    for at, value in kept.items():
        assert passed[at] == (pytest.approx(value, rel=1e-3, abs=1e-6) if isinstance(value, float) else value), at
