"""The algebra of the search: inner products, eliminated inputs, scores, bounds and priors, against dense algebra."""

from __future__ import annotations

from math import exp, inf, log

import numpy as np
import pytest
from diagnosis_models import Array
from numpy.testing import assert_allclose, assert_array_equal
from scipy.linalg import block_diag, solve_triangular, toeplitz

from truing.diagnosis import evidence
from truing.diagnosis.columns import Column, Design
from truing.diagnosis.evidence import (
    Channel,
    Products,
    Reduced,
    Simulation,
    products_of,
    reduced,
    replicates_of,
    starts_of,
)
from truing.diagnosis.hypotheses import (
    MASSES,
    NOTHING,
    Hypothesis,
    Piece,
    batches_of,
    mixed,
    off_inputs,
    pairs,
    shapes,
    singles,
)
from truing.diagnosis.machine import directions_of
from truing.diagnosis.noise import Setting
from truing.diagnosis.scoring import BOUND_SLACK, base_likelihood, batch_likelihood, scores_of
from truing.diagnosis.sight import visible
from truing.diagnosis.significance import LARGEST_RHO, carried

K, M = 2, 4
LENGTHS = (9, 14)


def channel(name: str, n: int, seed: int, *, weights: bool = True) -> Channel:
    rng = np.random.default_rng([seed, n])
    runs = np.repeat([0, 1], [n // 3, n - n // 3])
    columns = [Column({name: rng.normal(size=n + 2)}, per) for per in (1.0, 2.0, 0.5)] + [Column({"other": np.ones(n)})]
    rows = np.arange(1, n + 1)
    return Channel(
        name,
        0.1,
        rows,
        starts_of(np.concatenate([[0], runs, [1]]), rows),
        rng.uniform(0.5, 2, n) if weights else np.ones(n),
        rng.normal(size=n),
        rng.normal(size=(n + 2, K)),
        0.1 * np.eye(K),
        Design(name, columns, n + 2),
    )


def dense_rows(item: Channel, rho: float) -> Array:
    """Residual, directions and columns, weighted and whitened by the inverse root of the covariance."""
    columns = [
        (each.parts[item.name][item.rows] if item.name in each.parts else np.zeros(len(item))) * each.per / item.scale
        for each in item.columns
    ]
    made = np.column_stack([item.residual, item.directions, *columns]) * item.weights[:, None]
    lengths = np.diff([*np.flatnonzero(item.starts), len(item)])
    covariance = block_diag(*(toeplitz(rho ** np.arange(float(n))) / (1 - rho**2) for n in lengths))
    return np.asarray(solve_triangular(np.linalg.cholesky(covariance), made, lower=True))


def two_gauges(rho: float = 0.6) -> tuple[list[Channel], list[Array], Reduced]:
    channels = [channel(name, n, 1) for name, n in zip(("position", "tilt"), LENGTHS, strict=True)]
    products = [products_of(item, [Setting(rho)])[0] for item in channels]
    return channels, [dense_rows(item, rho) for item in channels], reduced(products, LENGTHS, K)


@pytest.mark.parametrize("rho", [0.0, 0.6])
def test_inner_products_are_those_of_whitened_rows(rho: float) -> None:
    item = channel("position", 23, 3)
    (found,) = products_of(item, [Setting(rho)])
    white = dense_rows(item, rho)
    assert_allclose(found.matrix, white.T @ white, rtol=1e-10, atol=1e-10)
    assert_array_equal(found.matrix[:, -1], 0)  # a column of another result says nothing here


def test_inner_products_do_not_depend_on_the_blocks_of_rows(monkeypatch: pytest.MonkeyPatch) -> None:
    item = channel("position", 40, 4)
    whole = products_of(item, [Setting(0.6)])[0]
    monkeypatch.setattr(evidence, "LONGEST", 5)
    again = channel("position", 40, 4)
    object.__setattr__(again, "starts", item.starts)
    assert len(again.blocks) == 2
    assert_allclose(products_of(again, [Setting(0.6)])[0].matrix, whole.matrix, rtol=1e-12)


def test_long_runs_are_cut_into_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(evidence, "LONGEST", 4)
    found = starts_of(np.repeat([0, 1, 2], [6, 3, 9]), np.arange(18))
    assert np.flatnonzero(found).tolist() == [0, 4, 6, 9, 13, 17]


def test_a_run_starts_anew_where_its_first_row_is_missing() -> None:
    assert starts_of(np.array([0, 0, 0, 1, 1, 2]), np.array([1, 2, 4, 5])).tolist() == [True, False, True, True]


def test_eliminating_the_inputs_is_least_squares_with_rows_for_their_prior() -> None:
    _, white, case = two_gauges()
    rng = np.random.default_rng(5)
    for chosen in ([0], [1, 3], [0, 1, 2]):
        b = rng.normal(size=len(chosen))
        left = [rows[:, 0] - rows[:, 1 + K :][:, chosen] @ b for rows in white]
        design = np.concatenate([*(rows[:, 1 : 1 + K] for rows in white), np.eye(K)])
        u = np.linalg.lstsq(design, np.concatenate([*left, np.zeros(K)]))[0]
        dense = [
            *(np.sum((rest - rows[:, 1 : 1 + K] @ u) ** 2) for rest, rows in zip(left, white, strict=True)), u @ u
        ]  # fmt: skip
        ours = [
            own[0] - 2 * b @ g[chosen, 0] + b @ h[np.ix_(chosen, chosen)] @ b
            for own, g, h in zip(case.own, case.g, case.h, strict=True)
        ]
        assert_allclose(ours, dense, rtol=1e-9)


def test_the_constant_holds_the_determinant_of_the_inputs() -> None:
    channels, white, case = two_gauges(0.6)
    given = sum(products_of(item, [Setting(0.6)])[0].constant for item in channels)
    normal = np.eye(K) + sum(rows[:, 1 : 1 + K].T @ rows[:, 1 : 1 + K] for rows in white)
    assert_allclose(case.constant, given - np.linalg.slogdet(normal)[1], rtol=1e-12)


def test_without_inputs_nothing_is_eliminated() -> None:
    rows = np.random.default_rng(6).normal(size=(12, 1 + M))
    case = reduced([Products(rows.T @ rows, 3.0)], [12], 0)
    assert_allclose(case.total_h, rows[:, 1:].T @ rows[:, 1:])
    assert_allclose(case.total_g[:, 0], rows[:, 1:].T @ rows[:, 0])
    assert_allclose([case.own[0][0], case.own[1][0], case.constant], [rows[:, 0] @ rows[:, 0], 0, 3])


def test_many_residuals_at_once_are_the_same_as_one_by_one() -> None:
    item = channel("position", 30, 7)
    generator = np.random.default_rng(8)
    simulation = Simulation(np.array([0.7, -1.2, 0.4]), Setting(0.3), np.full(30, 0.2))
    inputs = generator.normal(size=(K, 5))
    (drawn,) = replicates_of(item, simulation, inputs, generator=np.random.default_rng(9), settings=[Setting(0.6)])
    (products,) = products_of(item, [Setting(0.6)])
    together = reduced([products], [30], K, [drawn])
    made = _simulated(item, simulation, inputs)
    for place in range(5):
        alone = Channel(
            item.name, item.scale, item.rows, item.starts, item.weights, made[:, place] / item.weights,
            item.slopes, item.moves, item.design,
        )  # fmt: skip
        case = reduced(products_of(alone, [Setting(0.6)]), [30], K)
        assert_allclose(together.total_g[:, place], case.total_g[:, 0], rtol=1e-9, atol=1e-9)
        assert_allclose(together.own[0][place], case.own[0][0], rtol=1e-9)
        assert_allclose(together.own[-1][place], case.own[-1][0], rtol=1e-9)


def _simulated(item: Channel, simulation: Simulation, inputs: Array) -> Array:
    """Noise by the recursion, run by run, the fitted part and the inputs, weighted."""
    drawn = np.random.default_rng(9).choice(simulation.innovations, size=(len(item), inputs.shape[1]))
    rho, noise = simulation.setting.rho, np.empty_like(drawn)
    for row in range(len(item)):
        first = item.starts[row]
        noise[row] = drawn[row] / np.sqrt(1 - rho**2) if first else rho * noise[row - 1] + drawn[row]
    return noise + simulation.mean[:, None] + item.directions * item.weights[:, None] @ inputs


def piece(columns: tuple[int, ...], *, owner: int = 0, low: float = -inf, high: float = inf, size: int = 0) -> Piece:
    many = len(columns)
    return Piece("term", owner, owner, columns, size or many, (low,) * many, (high,) * many)


def one_of(columns: tuple[int, ...], low: float = -inf, high: float = inf) -> Hypothesis:
    return Hypothesis("one", (piece(columns, low=low, high=high),), log(0.3))


def dense_likelihood(white: list[Array], chosen: tuple[int, ...], constant: float) -> float:
    """Twice the likelihood, profiled over the noise of each gauge, at the joint least squares."""
    design = np.concatenate([*(np.delete(rows, 0, 1)[:, [0, 1, *(K + c for c in chosen)]] for rows in white)])
    prior = np.eye(K, design.shape[1])
    target = np.concatenate([*(rows[:, 0] for rows in white), np.zeros(K)])
    x = np.linalg.lstsq(np.concatenate([design, prior]), target)[0]
    left = np.split(target[:-K] - design @ x, [len(white[0])])
    return float(constant - sum(len(rest) * log(rest @ rest / len(rest)) for rest in left) - x[:K] @ x[:K])


def test_the_likelihood_of_many_explanations_is_the_dense_one_of_each() -> None:
    _, white, case = two_gauges()
    chosen = [(0,), (2,), (0, 1), (1, 2)]
    batches = batches_of([one_of(each) for each in chosen])
    for batch in batches:
        (found,) = batch_likelihood([case], batch)
        for place, value in zip(batch.places, found[:, 0], strict=True):
            assert_allclose(value, dense_likelihood(white, chosen[place], case.constant), rtol=1e-8)
    assert_allclose(base_likelihood([case])[0, 0], dense_likelihood(white, (), case.constant), rtol=1e-10)


def test_a_score_pays_for_parameters_and_prior() -> None:
    _, white, case = two_gauges()
    gridded = Hypothesis("one", (piece((1,), size=2),), log(0.05))
    hypotheses = [NOTHING, gridded]
    found = scores_of([case], batches_of(hypotheses), 23)
    expected = dense_likelihood(white, (1,), case.constant) - 2 * log(23) + 2 * log(0.05)
    assert_allclose(found.score[0, 1, 0], expected, rtol=1e-8)
    assert_allclose(found.score[0, 0, 0], dense_likelihood(white, (), case.constant) + 2 * log(0.5), rtol=1e-10)


def straight(slope: float) -> Reduced:
    """One column of ones on 100 rows, and a residual that it fits with this coefficient and noise of about one."""
    noise = np.tile([1.0, -1.0], 50)
    rows = np.column_stack([slope + noise, np.ones(100)])
    return reduced([Products(rows.T @ rows, 0.0)], [100], 0)


@pytest.mark.parametrize(
    ("slope", "low", "high", "possible"),
    [
        (0.01, 0, inf, True),
        (-0.01, 0, inf, False),
        (0.01, -inf, 0, False),
        (-0.01, -inf, 0, True),
        (5.0, 0, 5.0 - 0.9 * BOUND_SLACK / 10, True),
        (5.0, 0, 5.0 - 1.1 * BOUND_SLACK / 10, False),
        (-5.0, -5.0 + 0.9 * BOUND_SLACK / 10, 1, True),
        (-5.0, -5.0 + 1.1 * BOUND_SLACK / 10, 1, False),
    ],
)
def test_a_solution_outside_its_bounds_is_impossible(slope: float, low: float, high: float, possible: bool) -> None:
    """A bound of zero is a sign and kept strictly; any other within two standard errors (0.1 each here)."""
    (batch,) = batches_of([one_of((0,), low, high)])
    ((value,),) = batch_likelihood([straight(slope)], batch)[..., 0]
    assert np.isfinite(value) == possible
    assert value == -inf or possible


def test_the_prior_of_a_class_is_shared_by_its_explanations_not_by_their_variants() -> None:
    terms = [piece((0,), owner=0), piece((1,), owner=0), piece((2,), owner=1), piece((3,), owner=2)]
    groups = [Piece("shape", place, place, (place,), 1, (-inf,), (inf,)) for place in range(5)]
    classes = {
        "one": singles(terms),
        "two": pairs(terms),
        "shape": shapes(groups),
        "mixed": mixed(terms, groups, frozenset()),
        "input": off_inputs([Piece("input", 0, 0, (0,), 1, (-inf,), (inf,))]),
    }
    for kind, members in classes.items():
        priors = {item.key: exp(item.log_prior) for item in members}
        assert_allclose(sum(priors.values()), MASSES[kind])  # type: ignore[index]
        assert len(set(np.round(list(priors.values()), 12))) == 1
    assert len(classes["one"]) == 4
    assert len({item.key for item in classes["one"]}) == 3


def test_a_pair_is_of_two_causes_and_never_of_two_variants_of_one() -> None:
    terms = [piece((0,), owner=0), piece((1,), owner=0), piece((2,), owner=1), piece((3,), owner=2)]
    found = {item.columns for item in pairs(terms)}
    assert found == {(0, 2), (0, 3), (1, 2), (1, 3), (2, 3)}


def test_a_shape_that_reproduces_a_cause_is_never_beside_it() -> None:
    terms = [piece((0,), owner=0), piece((1,), owner=1)]
    groups = [Piece("shape", place, place, (2 + place,), 1, (-inf,), (inf,)) for place in range(2)]
    found = {item.key for item in mixed(terms, groups, frozenset({(0, 1)}))}
    assert found == {(("shape", 0), ("term", 0)), (("shape", 0), ("term", 1)), (("shape", 1), ("term", 1))}


def test_batches_hold_every_explanation_once() -> None:
    hypotheses = [NOTHING, *(one_of(tuple(range(1 + place % 3))) for place in range(10))]
    found = batches_of(hypotheses, largest=2)
    assert sorted(int(place) for batch in found for place in batch.places) == list(range(11))
    assert max(len(batch.places) for batch in found) == 2
    for batch in found:
        for place, index, penalty in zip(batch.places, batch.index, batch.penalty(50), strict=True):
            assert tuple(index) == hypotheses[place].columns
            assert_allclose(penalty, hypotheses[place].size * log(50) - 2 * hypotheses[place].log_prior)


def test_what_the_tolerances_leave_has_the_inner_products_of_the_marginal_covariance() -> None:
    rng = np.random.default_rng(10)
    columns, directions = rng.normal(size=(15, 3)), rng.normal(size=(15, 4)) * 2
    both = np.concatenate([directions, columns], axis=1)
    marginal = columns.T @ np.linalg.solve(np.eye(15) + directions @ directions.T, columns)
    assert_allclose(visible(both.T @ both, 4), marginal, rtol=1e-10)
    assert_allclose(visible(columns.T @ columns, 0), columns.T @ columns)


def test_collinear_inputs_are_few_directions_with_the_same_prior() -> None:
    rng = np.random.default_rng(11)
    curves = rng.normal(size=(200, 2))
    slopes = curves @ np.array([[1.0, 2.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0]]) + 1e-4 * rng.normal(size=(200, 4))
    gram = slopes.T @ slopes
    found = directions_of(gram, 200)
    assert found.shape == (4, 2)
    assert_allclose(found.T @ found, np.eye(2), atol=1e-12)
    assert_allclose(slopes @ found @ found.T @ slopes.T, slopes @ slopes.T, atol=0.02)
    assert directions_of(np.zeros((0, 0)), 5).shape == (0, 0)
    assert directions_of(1e-6 * gram, 200).shape == (4, 0)  # a thousandth of the noise moves nothing


def test_simulations_carry_over_a_little_more_than_was_fitted() -> None:
    assert_allclose(carried(0.6, 100), 0.6 + (1 + 1.8) / 100 + 0.5 * np.sqrt((1 - 0.36) / 100))
    assert carried(0.97, 30) == LARGEST_RHO
