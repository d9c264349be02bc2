"""What is not excluded beside the winner: scores of exact fits, and when their difference decides."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from diagnosis_models import UM, Array, Asked, drive_model, gauge, names_of_piece, plain_contest, wide

from truing.diagnosis import rivals
from truing.diagnosis.contest import Contest
from truing.diagnosis.fit import Fit, fit
from truing.diagnosis.rivals import CLOSE, SURE, exact_score, rivals_of, unsure

ROWS = 90


def searched(folder: Path, error: Array) -> Contest:
    """All explanations of a gauge that is off by this much (um), with noise of 1 um."""
    bench = wide(ROWS, seed=21)
    noise = np.random.default_rng(3).normal(0, 1, ROWS)
    asked = Asked(drive_model())
    return plain_contest(
        asked, asked.records(folder, bench.columns(gauge(bench.load, bench.travel) + error + noise)), UM
    )


def single(full: Contest, name: str) -> int:
    """The place of a single cause."""
    return full.found.best(lambda item: item.kind == "one" and name in names_of_piece(full, item.pieces[0]))


def test_the_exact_score_of_a_cause_that_acts_in_proportion_is_that_of_the_search(tmp_path: Path) -> None:
    bench = wide(ROWS, seed=21)
    full = searched(tmp_path, 0.03 * bench.travel)
    for name in ("lead_error", "clearance"):
        place = single(full, name)
        assert exact_score(full, place, fit(full, place)) == pytest.approx(full.found.score[place], abs=1e-4)


@pytest.mark.parametrize("apart", [6.0, 25.0, 60.0])
def test_where_what_is_left_is_noise_a_difference_d_is_unsure_by_two_roots_of_d(apart: float) -> None:
    """Of two fits of which one misses a curve c of the noise: d = |c|^2 with the variance 4 |c|^2."""
    rng = np.random.default_rng(0)
    curve = np.sin(np.arange(4000) / 50)
    curve *= np.sqrt(apart) / np.linalg.norm(curve)
    said = []
    for _ in range(40):
        noise = rng.normal(0, 1, 4000)
        one, other = (cast(Fit, SimpleNamespace(innovations=(left,))) for left in (noise, noise + curve))
        said.append(unsure(one, other))
    assert np.mean(said) == pytest.approx(2 * np.sqrt(apart), rel=0.05)
    assert SURE * 2 * np.sqrt(CLOSE) == pytest.approx(CLOSE)


def test_a_rival_stays_open_where_the_rows_contradict_one_another(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench = wide(ROWS, seed=21)
    full = searched(tmp_path, 0.012 * bench.travel)
    best = single(full, "lead_error")
    chosen = fit(full, best)
    assert rivals_of(full, best, chosen) == []
    behind = min(
        exact_score(full, best, chosen) - exact_score(full, place, fit(full, place))
        for place in rivals._worth_a_fit(full, best)
    )
    assert CLOSE < behind < 60
    monkeypatch.setattr(rivals, "unsure", lambda one, other: 1.01 * behind / SURE)
    (open_one,) = rivals_of(full, best, chosen)
    assert open_one.behind == pytest.approx(behind)
    assert open_one.own is not None


def test_nothing_has_no_rivals(tmp_path: Path) -> None:
    full = searched(tmp_path, np.zeros(ROWS))
    assert rivals_of(full, 0, fit(full, 0)) == []


def test_the_unsureness_of_a_fit_and_itself_is_nothing(tmp_path: Path) -> None:
    full = searched(tmp_path, np.zeros(ROWS))
    assert unsure(fit(full, 0), fit(full, 0)) == 0


def test_what_acts_beside_the_winner_is_no_rival(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two causes draw two curves: each alone leaves the other, so that neither stands for it, however near they are."""
    bench = wide(ROWS, seed=21)
    full = searched(tmp_path, 0.01 * bench.travel + 1.6 * np.sign(bench.load))
    monkeypatch.setattr(rivals, "unsure", lambda one, other: 1e6)
    one, other = single(full, "lead_error"), single(full, "clearance")
    assert {one, other} & set(rivals._worth_a_fit(full, one)) == {other}
    assert other not in [rival.place for rival in rivals_of(full, one, fit(full, one))]
    alone = searched(tmp_path, 0.012 * bench.travel)
    one = single(alone, "lead_error")
    assert rivals_of(alone, one, fit(alone, one))
