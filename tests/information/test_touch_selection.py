"""Choice of rows: updates against recomputation, small cases against all possibilities."""

from itertools import combinations

import numpy as np
import pytest

from matstd.information.criteria import DesignCriterion, mean_prediction
from matstd.information.criteria.measures import MeanVariance
from matstd.information.selection import (
    Quota,
    Selection,
    best_groups,
    exchange,
    fill,
    heaviest,
    relaxed,
)
from matstd.twin.errors import DesignError

ROUNDING = 1e-9


@pytest.fixture
def case():
    """Rows of unequal directions, and a criterion that weighs them unequally."""
    rng = np.random.default_rng(8)
    W = rng.normal(size=(60, 6)) * np.array([5.0, 3.0, 2.0, 1.0, 0.5, 0.2])
    half = rng.normal(size=(6, 6))
    return DesignCriterion(np.eye(6), MeanVariance(half @ half.T)), W


def value_of(criterion, W, rows):
    M = np.eye(W.shape[1]) + W[rows].T @ W[rows]
    return float(np.trace(np.linalg.inv(M) @ criterion.measure.K))


def test_updates_are_exact(case, monkeypatch):
    monkeypatch.setattr("matstd.information.selection.touch_selection._REFRESH", 10**9)
    criterion, W = case
    selection = Selection(criterion, W)
    rng = np.random.default_rng(1)
    for _ in range(200):
        row = int(rng.integers(60))
        selection.drop(row) if selection.chosen[row] else selection.add(row)
    rows = np.flatnonzero(selection.chosen)
    assert selection.value == pytest.approx(value_of(criterion, W, rows), rel=ROUNDING)
    fresh = Selection(criterion, W, selection.chosen)
    np.testing.assert_allclose(selection.gains, fresh.gains, rtol=1e-6)
    out = next(r for r in range(60) if r not in rows)
    gain = value_of(criterion, W, rows) - value_of(criterion, W, [*rows, out])
    assert selection.gains[out] == pytest.approx(gain, rel=1e-6)
    kept = [r for r in rows if r != rows[3]]
    loss = value_of(criterion, W, kept) - value_of(criterion, W, rows)
    assert selection.losses[rows[3]] == pytest.approx(loss, rel=1e-6)
    assert np.isinf(selection.losses[out])


def test_choice_is_near_the_best_of_all_possibilities():
    rng = np.random.default_rng(2)
    ratios = []
    for _ in range(20):
        W, half = 2.0 * rng.normal(size=(11, 4)), rng.normal(size=(4, 4))
        criterion = DesignCriterion(np.eye(4), MeanVariance(half @ half.T))
        best = min(value_of(criterion, W, list(c)) for c in combinations(range(11), 5))
        selection = Selection(criterion, W)
        fill(selection, 5)
        exchange(selection)
        ratios.append(selection.value / best)
        assert selection.chosen.sum() == 5
    assert min(ratios) >= 1.0 - ROUNDING  # nothing is better than the best
    assert np.median(ratios) < 1.02
    assert max(ratios) < 1.25


def test_choice_beats_chance_and_exchange_never_harms(case):
    criterion, W = case
    selection = Selection(criterion, W)
    fill(selection, 12)
    greedy = selection.value
    exchange(selection)
    assert selection.value <= greedy * (1.0 + ROUNDING)
    rng = np.random.default_rng(3)
    chance = [value_of(criterion, W, rng.choice(60, 12, replace=False)) for _ in range(50)]
    assert selection.value < min(chance)


def test_exchange_mends_a_bad_start(case):
    criterion, W = case
    start = np.zeros(60, dtype=bool)
    start[:12] = True
    selection = Selection(criterion, W, start)
    before = selection.value
    assert exchange(selection) > 0
    assert selection.value < before
    assert selection.chosen.sum() == 12


def test_quotas_hold(case):
    criterion, W = case
    kind = np.arange(60) % 3
    quota = Quota(kind, np.array([2, 5, 100]))
    selection = Selection(criterion, W)
    fill(selection, 15, (quota,))
    exchange(selection, (quota,))
    count = np.bincount(kind[selection.chosen], minlength=3)
    assert count.tolist() == [2, 5, 8] or (count[0] <= 2 and count[1] <= 5 and count.sum() == 15)
    with pytest.raises(DesignError, match="under the shares of each kind"):
        fill(Selection(criterion, W), 10, (Quota(kind, np.array([2, 2, 2])),))


def test_leaving_out_what_nothing_shows_is_exact():
    rng = np.random.default_rng(4)
    seen = rng.normal(size=(4, 12))  # rows and tool point feel four combinations of twelve
    sd = rng.uniform(0.5, 2.0, 12)
    W = (rng.normal(size=(30, 4)) @ seen) * sd
    G = np.einsum("mik,kp->mip", rng.normal(size=(9, 3, 4)), seen)
    criterion = mean_prediction(G, W, sd)
    assert criterion.directions.shape == (12, 4)
    M = np.eye(12) + W.T @ W
    scaled = G * sd
    whole = np.mean([np.trace(g @ np.linalg.inv(M) @ g.T) for g in scaled])
    R = criterion.rows(W)
    assert criterion.value(R.T @ R) == pytest.approx(whole, rel=1e-8)


def chosen_by_loops(criterion, W, group, count):
    """One group after another, then each once weighed beside all the others."""

    def best(others):
        left = [k for k in range(10) if k not in others]
        rows = {k: np.flatnonzero(np.isin(group, [*others, k])) for k in left}
        return min(left, key=lambda k: value_of(criterion, W, rows[k]))

    chosen = []
    while len(chosen) < count:
        chosen.append(best(chosen))
    for i in range(count):
        chosen[i] = best(chosen[:i] + chosen[i + 1 :])
    return chosen


@pytest.mark.parametrize("count", [1, 3, 5])
def test_groups_are_chosen_by_what_they_bring_beside_all_the_others(case, count):
    group = np.arange(60) // 6
    for _ in range(3):
        assert best_groups(*case, group, count, take=6) == chosen_by_loops(*case, group, count)
        group = np.random.default_rng(count).permutation(group)


def test_groups_that_do_not_fit_are_not_put_together(case):
    criterion, W = case
    group = np.arange(60) // 6
    free = best_groups(criterion, W, group, 2, take=6)
    fits = np.ones((10, 10), dtype=bool)
    fits[free[0], free[1]] = fits[free[1], free[0]] = False
    assert set(best_groups(criterion, W, group, 2, take=6, apart=fits)) != set(free)
    alone = np.zeros((10, 10), dtype=bool)
    assert len(best_groups(criterion, W, group, 4, take=6, apart=alone)) == 1


def test_what_is_measured_anyway_is_not_chosen_again(case):
    criterion, W = case
    group = np.arange(60) // 6
    first = best_groups(criterion, W, group, 1, take=6)[0]
    have = W[group == first]
    second = best_groups(criterion, W, group, 1, take=6, start=1e4 * have.T @ have)[0]
    assert second != first


def test_groups_to_begin_with_are_exchanged_like_the_others(case):
    criterion, W = case
    group = np.arange(60) // 6
    fits = np.zeros((10, 10), dtype=bool)
    for some in ([0, 1, 2], [3, 4, 5, 6]):
        fits[np.ix_(some, some)] = True
    np.fill_diagonal(fits, val=False)
    begun = best_groups(criterion, W, group, 4, take=6, apart=fits, begin=[3, 4, 5])
    assert set(begun) == {3, 4, 5, 6}
    free = best_groups(criterion, W, group, 3, take=6)
    assert set(best_groups(criterion, W, group, 3, take=6, begin=free)) == set(free)


@pytest.mark.parametrize("seed", [0, 3, 5, 7])
def test_the_last_digit_of_rows_decides_nothing(seed):
    """Mirrored rows are worth the same; another processor rounds each of them differently."""
    rng = np.random.default_rng(seed)
    half = rng.normal(size=(90, 5)) * np.array([60.0, 20.0, 5.0, 1.0, 0.3])
    mirrored = half * np.array([1, 1, 1, 1, -1]), half[::-1] * np.array([1, 1, 1, -1, 1])
    W = np.concatenate([half, *mirrored])
    criterion = DesignCriterion(np.eye(5), MeanVariance(np.diag([1.0, 2.0, 3.0, 4.0, 5.0])))
    shares = (Quota(np.arange(len(W)) % 6, np.full(6, 9)),)
    chosen = []
    for rounding in (0.0, 3e-16):
        rows = W * (1.0 + rounding * np.random.default_rng(99).uniform(-1.0, 1.0, W.shape))
        start = heaviest(np.linalg.norm(rows, axis=1), 40, shares)
        found = relaxed(criterion, rows, 40, start, 1e-4, shares)
        groups = best_groups(criterion, rows, np.arange(len(W)) // 9, count=8, take=4)
        chosen.append([*np.flatnonzero(heaviest(found.weight, 40, shares)), *groups])
    assert chosen[0] == chosen[1]
