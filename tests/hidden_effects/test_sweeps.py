"""Waves on long records are passed through and not kept: whatever is asked of them is what kept curves give."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from hidden_effects.asking import press_offer, write_case
from hidden_effects.making import Wish, make_case
from hidden_effects.press_machine import POSITION, TILT
from truing.diagnosis import conditional, curves
from truing.diagnosis.choice import law_of
from truing.diagnosis.competition import Competition, beside, competition_of
from truing.diagnosis.conditional import ProjectedCurves, Spanned, conditional_on
from truing.diagnosis.curves import Bundle
from truing.diagnosis.engine import laid_out
from truing.diagnosis.machine import calibration_of
from truing.diagnosis.reading import read_records
from truing.inputs_file import read_setup

EVERY, NONE = 0, 10**12
CASE = make_case(11, Wish("single", "wide", "autocorrelated", (POSITION, TILT), 80, ("link_heating",), 2.0))


def competing(folder: Path) -> Competition:
    """The press on 80 rows of two results, in the noise with a memory that a fit of its cause leaves."""
    write_case(CASE, folder)
    setup = read_setup(folder / "inputs.toml", press_offer())
    made = laid_out(calibration_of(setup, read_records([folder / "measured.csv"], press_offer(), setup)))
    (heating,) = (cause for cause in made.causes if cause.tag == "link_heating")
    made.fit_each(beside(made.null, heating, made.look(made.null, [heating])["link_heating"].starts))
    made.renew()
    assert any(channel.memory.rho for channel in made.sample.channels)
    swept = [cause for cause in made.causes if ":wave:" in cause.tag or ":step:" in cause.tag or ":order:" in cause.tag]
    again = competition_of(made.extended, swept, made.sample)
    again.known = made.known
    return again


def test_a_table_gives_what_kept_curves_give(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Starts, what they are worth, how many curves there are, every inner product and the law of chance.

    Terms are kept in single precision, with seven digits.
    """
    kept, through = competing(tmp_path), competing(tmp_path)
    for made, limit in ((kept, NONE), (through, EVERY)):
        monkeypatch.setattr(curves, "LARGE", limit)
        assert {type(each.span) for each in made.look(made.null).values()} == {Spanned if limit else ProjectedCurves}
    monkeypatch.setattr(conditional, "BLOCK", 7 * 160)  # blocks of a few points, and one that is not full
    one = next(found for found in kept.known.values() if found.causes)
    for at in (kept.null, one):
        before, after = kept.look(at), through.look(at)
        assert set(before) == set(after)
        assert before
        drawn = np.random.default_rng(5).normal(size=(kept.sample.rows + len(at.inputs), 9))
        beside = conditional_on(at, kept.extended)
        drawn -= beside.taken @ (beside.taken.T @ drawn)
        for tag, old in before.items():
            new = after[tag]
            assert_allclose(new.tries, old.tries, rtol=1e-5)
            assert_allclose(
                [worth for worth, _ in new.starts], [worth for worth, _ in old.starts], rtol=1e-4, atol=1e-6
            )
            for (_, mine), (_, theirs) in zip(new.starts, old.starts, strict=True):
                assert_allclose(mine, theirs, rtol=1e-3, atol=1e-3 * np.abs(theirs).max())
            assert_allclose(new.span.inner(drawn, {}), old.span.inner(drawn, {}), atol=3e-5)
            assert_allclose(new.span.vectors(0), old.span.vectors(0), atol=1e-5)
    laws = [law_of(made, made.null, made.known[one.key], seed=3) for made in (kept, through)]
    assert_allclose(laws[1].gains, laws[0].gains, rtol=1e-4, atol=1e-4)


def test_results_share_a_table(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(curves, "LARGE", EVERY)
    made = competing(tmp_path)
    waves = [cause for cause in made.causes if ":wave:time:" in cause.tag]
    bundles: list[Bundle] = [made.curves.of(cause, made.null) for cause in waves]
    assert [len(cause.amplitudes) for cause in waves] == [2, 2, 4]
    assert len({id(bundle.table) for bundle in bundles}) == 1
    (table,) = {bundle.table for bundle in bundles}
    assert table is not None
    assert table.terms.shape == (len(bundles[0].points), 2, 80)
