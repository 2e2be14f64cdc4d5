"""Bounds against all possibilities and against a foreign optimiser of the relaxed problem."""

from itertools import combinations

import numpy as np
import pytest
from scipy.optimize import LinearConstraint, minimize

from matstd.information.criteria import DesignCriterion
from matstd.information.criteria.measures import Determinant, MeanVariance
from matstd.information.selection import (
    Certificate,
    Quota,
    Selection,
    exchange,
    fill,
    heaviest,
    relaxed,
    rounded,
)
from matstd.information.selection.relaxation import _candidates_to_search, slope
from matstd.information.selection.shares import largest_sum
from matstd.twin.errors import DesignError

ROUNDING = 1e-9
GAP = 1e-3
"""To which relaxed problems are solved here."""


def case(seed, rows, columns, is_determinant):
    rng = np.random.default_rng(seed)
    W = rng.normal(size=(rows, columns)) * np.linspace(3.0, 0.5, columns)
    half = rng.normal(size=(columns, columns))
    measure = Determinant(columns) if is_determinant else MeanVariance(half @ half.T)
    return DesignCriterion(np.eye(columns), measure), W


def value_of(criterion, W, weight):
    """By the definition, with nothing of the code that is tested."""
    M = np.eye(W.shape[1]) + W.T @ np.diag(weight) @ W
    if isinstance(criterion.measure, Determinant):
        return float(np.prod(np.linalg.eigvalsh(M)) ** (-1.0 / len(M)))
    return float(np.trace(np.linalg.inv(M) @ criterion.measure.K))


@pytest.mark.parametrize("is_determinant", [False, True])
def test_no_choice_beats_the_bound(is_determinant):
    rng = np.random.default_rng(5)
    for seed in range(10):
        criterion, W = case(seed, 11, 4, is_determinant)
        best = min(
            value_of(criterion, W, np.isin(np.arange(11), c)) for c in combinations(range(11), 5)
        )
        chosen = np.arange(11) < 5
        found = relaxed(criterion, W, 5, chosen, GAP)
        assert found.bound <= best * (1.0 + ROUNDING)
        # the tangent at any information is a bound, tight or not
        x = rng.random(11)
        here = slope(criterion, W.T @ np.diag(x) @ W)
        largest = largest_sum(here.gains(W), 5, ()).most
        assert here.bound(largest) <= best * (1.0 + ROUNDING)


@pytest.mark.parametrize("is_determinant", [False, True])
def test_fractions_are_those_of_a_foreign_optimiser(is_determinant):
    criterion, W = case(3, 30, 5, is_determinant)
    found = relaxed(criterion, W, 12, np.arange(30) < 12, GAP)
    assert found.gap <= GAP
    assert found.weight.sum() == pytest.approx(12.0, abs=ROUNDING)
    assert found.weight.min() >= 0.0
    assert found.weight.max() <= 1.0
    assert found.value == pytest.approx(value_of(criterion, W, found.weight), rel=ROUNDING)
    other = minimize(
        lambda x: np.log(value_of(criterion, W, x)),
        np.full(30, 0.4),
        method="SLSQP",
        bounds=[(0.0, 1.0)] * 30,
        constraints=LinearConstraint(np.ones((1, 30)), 12.0, 12.0),
        options={"maxiter": 500, "ftol": 1e-12},
    )
    best = float(np.exp(other.fun))
    assert found.value == pytest.approx(best, rel=2.0 * GAP)
    assert found.bound <= best * (1.0 + 1e-6)


@pytest.mark.parametrize("is_determinant", [False, True])
def test_the_bound_is_tight_where_a_share_binds(is_determinant):
    criterion, W = case(5, 600, 8, is_determinant)
    W[:100] *= 1.5  # more of these are useful than may be chosen
    shares = (Quota(np.arange(600) // 100, np.full(6, 14)),)
    found = relaxed(criterion, W, 60, heaviest(np.linalg.norm(W, axis=1), 60, shares), GAP, shares)
    assert found.weight[:100].sum() == pytest.approx(14.0)
    assert found.gap <= GAP


@pytest.mark.parametrize("is_determinant", [False, True])
def test_certified_efficiency_of_a_good_and_of_a_bad_choice(is_determinant):
    criterion, W = case(7, 2000, 10, is_determinant)
    selection = Selection(criterion, W)
    fill(selection, 40)
    exchange(selection)
    best = relaxed(criterion, W, 40, selection.chosen, 2e-3)
    good = Certificate(2000, 40, value_of(criterion, W, selection.chosen), best.bound, False)
    assert 0.97 < good.efficiency <= 1.0
    other = np.arange(2000) < 40
    again = relaxed(criterion, W, 40, other, 2e-3)
    assert again.bound == pytest.approx(best.bound, rel=5e-3)  # the same bound from another start
    assert Certificate(2000, 40, value_of(criterion, W, other), again.bound, False).efficiency < 0.6
    whole = rounded(criterion, W, best.weight, 40)
    assert int(whole.chosen.sum()) == 40
    assert best.bound / whole.value > 0.97
    assert "40 of 2000 candidate touches: at least 9" in str(good)


def test_determinant_by_updates_is_the_determinant():
    criterion, W = case(2, 60, 6, True)
    selection = Selection(criterion, W)
    fill(selection, 20)
    assert selection.value == pytest.approx(value_of(criterion, W, selection.chosen), rel=ROUNDING)
    selection.drop(int(np.flatnonzero(selection.chosen)[3]))
    assert selection.value == pytest.approx(value_of(criterion, W, selection.chosen), rel=ROUNDING)
    gain = np.argmax(np.where(selection.chosen, -np.inf, selection.gains))
    by_hand = [value_of(criterion, W, selection.chosen | (np.arange(60) == i)) for i in range(60)]
    assert gain == np.argmin(np.where(selection.chosen, np.inf, by_hand))


def test_a_start_of_another_size_is_refused():
    criterion, W = case(1, 10, 3, False)
    with pytest.raises(DesignError, match="4 of 10 touches to start from, 5 wanted"):
        relaxed(criterion, W, 5, np.arange(10) < 4, 2e-3)


def test_every_cell_keeps_its_best_candidates():
    """One touch: the two largest gains, and of two cells the best 4 + 2 * 1 // 2 = 5 each."""
    gain = np.array([9.0, 8.0, 7.0, 6.0, 5.0, 4.0, 0.1, 0.3, 0.2])
    cell = np.array([0, 0, 0, 0, 0, 0, 1, 1, 1])
    nothing = np.array([], dtype=np.int64)
    assert _candidates_to_search(gain, nothing, 1, 0 * cell).tolist() == [0, 1]
    assert _candidates_to_search(gain, np.array([8]), 1, 0 * cell).tolist() == [0, 1, 8]
    assert _candidates_to_search(gain, nothing, 1, cell).tolist() == [0, 1, 2, 3, 4, 6, 7, 8]
