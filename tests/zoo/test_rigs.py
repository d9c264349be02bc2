"""The machines of the zoo: plugins that keep every promise, rigs that agree with them where nothing is hidden.

What is expected comes from outside of the diagnosis: a plain least-squares fit, the noise that a rig states, a rule.
How often the diagnosis is right on these machines, singles and pairs, is measured by ``tests/benchmarks/bench_zoo.py``.
"""

from __future__ import annotations

import zlib
from functools import cache

import numpy as np
import pytest

from truing.testing import CHECKS
from truing.testing.subject import Subject
from zoo.fitting import fitting
from zoo.zoo import (
    HALVES,
    NOISES,
    ROWS,
    Case,
    Measured,
    diagnosis_of,
    families,
    judged,
    judgement,
    measured_of,
    model_of,
    record_of,
    rig_of,
)

SEED = 1
"""Chosen before any record was seen, and kept."""
AGREES = 0.3
"""Root mean square, in standard deviations of the noise, up to which rig and baseline calculation are the same."""
SHOWS = 3.0
"""What a hidden effect, as fitted, must move somewhere, in standard deviations of the noise."""
WITHIN = 1.2
"""What white noise of 1 and the error of the right effect, fitted, may come to together."""
FAMILIES = families()
SINGLES = [
    (family, hidden) for family in FAMILIES for hidden, right in rig_of(family).HIDDEN.items() if len(right) == 1
]
OPEN = [(family, hidden) for family, hidden in dict(SINGLES).items() if family in families("open")]
PROMISES = [check for check in CHECKS if check.name != "serial equals parallel"]
"""A worker reads these files as any other, which is tested elsewhere; here it would take as long as all the rest."""


@cache
def record(family: str, hidden: str | None) -> Measured:
    """A record without noise."""
    return measured_of(Case(family, hidden, True, "white", SEED))


@pytest.mark.parametrize("family", FAMILIES)
def test_the_plugin_keeps_every_promise(family: str) -> None:
    subject = Subject(model_of(family))
    for check in PROMISES:
        check.run(subject)


@pytest.mark.parametrize("family", FAMILIES)
def test_what_can_be_hidden_is_registered(family: str) -> None:
    known = model_of(family).known_effects
    answers = rig_of(family).HIDDEN.values()
    assert all(name in known for names in answers for name in names)
    assert sorted(len(names) for names in answers)[:3] == [1, 1, 2]


@pytest.mark.parametrize("family", FAMILIES)
def test_rig_and_calculation_agree_where_nothing_is_hidden(family: str) -> None:
    assert fitting(family, record(family, None)).best().error < AGREES


@pytest.mark.parametrize(("family", "hidden"), SINGLES)
def test_the_right_effect_draws_what_is_hidden_and_that_is_much(family: str, hidden: str) -> None:
    fit = fitting(family, record(family, hidden), rig_of(family).HIDDEN[hidden]).best()
    assert np.hypot(1.0, fit.error) < WITHIN
    assert fit.moved > SHOWS


@pytest.mark.parametrize("family", FAMILIES)
def test_a_record_is_the_same_again_and_finite(family: str) -> None:
    first, again = record(family, None), measured_of(Case(family, None, True, "white", SEED))
    assert list(first.columns) == list(again.columns)
    for name, values in first.columns.items():
        assert values.shape == (ROWS,)
        assert np.all(np.isfinite(values))
        assert np.array_equal(values, again.columns[name])


@pytest.mark.parametrize("noise", NOISES)
def test_a_noise_does_what_its_name_says(noise: str) -> None:
    """Moments, quartiles and counts that define it; the quartiles of the normal are 1.35 apart, those of t 0.70."""
    family, rows = "belt_drive", 300
    measured = measured_of(Case(family, None, True, noise, 5), rows)
    lines = record_of(Case(family, None, True, noise, 5), rows).splitlines()[1:]
    table = np.array([[float(cell) for cell in line.split(",")] for line in lines])
    assert len(table) == {"missing": 210, "thinned": 100}.get(noise, rows)
    time = table[:, 0]
    assert np.all(np.diff(time) > 0) == (noise != "shuffled")
    names = list(measured.columns)
    true = dict(zip(measured.columns["time [min]"].tolist(), measured.columns[measured.result].tolist(), strict=True))
    off = (table[:, names.index(measured.result)] - [true[at] for at in time.tolist()]) / measured.noise
    skewness = np.mean((off - off.mean()) ** 3) / off.std() ** 3
    neighbours = np.corrcoef(off[:-1], off[1:])[0, 1]
    assert (skewness > 0.8) == (noise == "skewed") or noise in ("heavy", "outliers")
    assert (neighbours > 0.3) == (noise == "drift")
    assert (np.sum(np.abs(off) > 10) == 9) == (noise == "outliers")
    assert (np.subtract(*np.percentile(off, (75, 25))) < 0.95) == (noise == "heavy")
    steps = table[:, names.index(measured.result)] / (1.5 * measured.noise)
    assert np.allclose(steps, np.round(steps)) == (noise == "quantised")


def test_the_halves_follow_from_the_names() -> None:
    """CRC-32 of "123456789" is 0xcbf43926, the check value of its catalogue: odd names are sealed."""
    assert zlib.crc32(b"123456789") == 0xCBF43926
    for place, half in enumerate(HALVES):
        assert [name for name in FAMILIES if zlib.crc32(name.encode()) % 2 == place] == list(families(half))


JUDGEMENTS = [
    ("slip", "named", ["slip"], "right"),
    ("slip", "one_of", ["creep", "slip"], "open"),
    ("slip", "undecided", ["slip"], "open"),
    ("slip", "none", [], "silent"),
    ("slip", "undecided", [], "silent"),
    ("slip", "named", ["creep"], "wrong"),
    ("slip", "one_of", ["creep", "slip unknown"], "wrong"),
    ("slip", "named", ["slip unknown"], "partly"),
    ("slip", "unknown", ["unknown"], "wrong"),
    ("slip creep", "named", ["creep slip"], "right"),
    ("slip creep", "named", ["slip"], "partly"),
    ("slip creep", "one_of", ["slip", "slip wear"], "wrong"),
    ("", "none", [], "right"),
    ("", "undecided", [], "open"),
    ("", "named", ["slip"], "wrong"),
    ("", "unknown", ["unknown"], "wrong"),
    ("unknown", "unknown", ["unknown"], "right"),
    ("unknown", "one_of", ["slip", "unknown"], "open"),
    ("unknown", "named", ["slip unknown"], "wrong"),
    ("unknown", "none", [], "silent"),
]


@pytest.mark.parametrize(("truth", "verdict", "left", "expected"), JUDGEMENTS)
def test_an_answer_is_judged_by_the_truth(truth: str, verdict: str, left: list[str], expected: str) -> None:
    sets = [frozenset(names.split()) for names in left]
    assert judgement(frozenset(truth.split()), verdict, sets) == expected


@pytest.mark.parametrize(("family", "hidden"), OPEN)
def test_a_single_hidden_effect_is_named_or_among_those_left(family: str, hidden: str) -> None:
    """One of each family that may be looked at."""
    case = Case(family, hidden, True, "white", SEED)
    assert judged(case, diagnosis_of(case, 120)).judged in ("right", "open")
