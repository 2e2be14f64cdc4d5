"""Criteria: published designs, brute force over all choices, bounds under shares."""

from itertools import combinations

import numpy as np
import pytest
from scipy.optimize import approx_fprime

from matstd.information.criteria import (
    DesignCriterion,
    five_criteria,
    mean_prediction,
    robust,
    with_potential,
)
from matstd.information.criteria.measures import (
    Determinant,
    LargestEigenvalue,
    LargestVariance,
    MeanVariance,
)
from matstd.information.criteria.tangents import LogDeterminant, Trace
from matstd.information.selection import Quota, Selection, exchange, fill, relaxed, rounded
from matstd.information.selection.shares import keeps, largest_sum
from matstd.twin.errors import DesignError

ROUNDING = 1e-9
WEIGHT = 3e-3
"""Weights of published designs, to which the relaxed problem is solved."""
SLACK = 1e3
"""Rows so long that a prior does not matter."""

MOMENTS = np.array([[1.0, 0.0, 1 / 3], [0.0, 1 / 3, 0.0], [1 / 3, 0.0, 1 / 5]])
PLACES = np.linspace(-1.0, 1.0, 21)
QUADRATIC = np.stack([np.ones(21), PLACES, PLACES**2], axis=1)
PUBLISHED = {  # weights at -1, 0, 1 for a parabola (Pukelsheim 1993; Kiefer and Wolfowitz 1960)
    "I": (1 / 4, 1 / 2, 1 / 4),
    "A": (1 / 4, 1 / 2, 1 / 4),
    "D": (1 / 3, 1 / 3, 1 / 3),
    "G": (1 / 3, 1 / 3, 1 / 3),
    "E": (1 / 5, 3 / 5, 1 / 5),
}


def mean_variance(K):
    return DesignCriterion(np.eye(len(K)), MeanVariance(K))


def parabola():
    roots = np.repeat(QUADRATIC[:, :, None], 3, axis=2)
    measures = {
        "I": MeanVariance(MOMENTS),
        "A": MeanVariance(np.eye(3)),
        "D": Determinant(3),
        "E": LargestEigenvalue.of(np.eye(3)),
        "G": LargestVariance(roots, np.zeros((3, 3))),
    }
    return {name: DesignCriterion(np.eye(3), measure) for name, measure in measures.items()}


@pytest.mark.parametrize("name", list(PUBLISHED))
def test_published_designs_of_the_parabola(name):
    W, place = np.repeat(SLACK * QUADRATIC, 60, axis=0), np.repeat(np.arange(21), 60)
    start = np.zeros(len(W), dtype=bool)
    start[np.random.default_rng(0).choice(len(W), 60, replace=False)] = True
    criterion = parabola()[name]
    found = relaxed(criterion, W, 60, start, 1e-4)
    weight = np.bincount(place, weights=found.weight) / 60
    np.testing.assert_allclose(weight[[0, 10, 20]], PUBLISHED[name], atol=WEIGHT)
    exact = Selection(criterion, W)
    fill(exact, 60)
    exchange(exact)
    count = np.bincount(place[exact.chosen], minlength=21)[[0, 10, 20]]
    np.testing.assert_array_equal(count, np.round(60 * np.array(PUBLISHED[name])))
    assert found.bound / exact.value > 0.999


def criteria(rng):
    half = rng.normal(size=(4, 4))
    K = half @ half.T
    roots = rng.normal(size=(6, 4, 2))
    scale = rng.uniform(0.3, 2.0, (5, 4))
    measures = [
        MeanVariance(K),
        Determinant(4),
        LargestEigenvalue.of(K),
        LargestVariance(roots, np.zeros((4, 4))),
    ]
    plain = [DesignCriterion(np.eye(4), measure) for measure in measures]
    return plain + [robust(criterion, scale, tail) for criterion in plain for tail in (1.0, 0.4)]


def by_definition(criterion, W, weights):
    """Of every choice, (S,), with nothing of the code that is tested.

    A tail of 0.4 is the worst two of five machines.
    """
    F, measure = np.einsum("sn,ni,nj->sij", np.atleast_2d(weights), W, W), criterion.measure
    priors = np.eye(len(W[0]))[None] if criterion.priors is None else criterion.priors
    inverse = np.linalg.inv(priors + F[:, None])  # (S, machines, P, P)
    if isinstance(measure, Determinant):
        each = np.log(np.linalg.det(inverse))
    elif isinstance(measure, MeanVariance):
        each = np.trace(measure.K @ inverse, axis1=-2, axis2=-1)
    else:
        seen = [np.asarray(root).T @ inverse @ root for root in measure.roots]
        if isinstance(measure, LargestEigenvalue):
            each = np.linalg.eigvalsh(seen[0])[..., -1]
        else:
            each = np.max([np.trace(s, axis1=-2, axis2=-1) for s in seen], axis=0)
    count = max(1, round(criterion.tail * len(priors)))
    mean = np.sort(each, axis=1)[:, ::-1][:, :count].mean(axis=1)
    return np.exp(mean / len(W[0])) if isinstance(measure, Determinant) else mean


@pytest.mark.parametrize(
    ("shares", "seed"),
    [
        (True, 1),
        *(pytest.param(*s, marks=pytest.mark.slow) for s in ((False, 1), (False, 2), (True, 2))),
    ],
)
def test_no_choice_beats_any_bound_and_values_are_those_of_the_definition(shares, seed):
    rng = np.random.default_rng(seed)
    kind, side = np.arange(9) % 3, np.arange(9) // 5
    quotas = ()
    if shares:
        quotas = (
            Quota(kind, np.array([2, 2, 3]), np.array([1, 0, 1])),
            Quota(side, np.array([3, 4])),
        )
    rows = [np.isin(np.arange(9), c) for c in combinations(range(9), 5)]
    allowed = [r for r in rows if all(keeps(q, r) for q in quotas)]
    assert (len(allowed) < len(rows)) == shares
    near, gaps = [], []
    W = 2.0 * rng.normal(size=(9, 4))
    for criterion in criteria(rng):
        best = by_definition(criterion, W, np.array(allowed, dtype=float)).min()
        start = allowed[int(rng.integers(len(allowed)))]
        found = relaxed(criterion, W, 5, start, 1e-3, quotas)
        assert found.bound <= best * (1.0 + ROUNDING)
        assert found.value == pytest.approx(by_definition(criterion, W, found.weight)[0], rel=1e-8)
        assert all(keeps(q, found.weight) for q in quotas)
        whole = rounded(criterion, W, found.weight, 5, quotas=quotas)
        assert all(keeps(q, whole.chosen) for q in quotas)
        (value,) = by_definition(criterion, W, whole.chosen)
        assert whole.value == pytest.approx(value, rel=1e-8)
        near.append(value / best)
        gaps.append(found.gap)
    assert min(near) >= 1.0 - ROUNDING
    assert np.median(near) < 1.01
    assert np.median(gaps) < 2e-3


def test_gains_are_the_slope_of_the_criterion():
    rng = np.random.default_rng(4)
    W = rng.normal(size=(20, 4))
    for criterion in criteria(rng)[:2] + criteria(rng)[4:6]:
        selection = Selection(criterion, W, np.arange(20) < 8)
        with_row = by_definition(criterion, W, selection.chosen | np.eye(20, dtype=bool)[8:])
        fall = selection.value - with_row
        if isinstance(criterion.measure, Determinant):
            fall = 4.0 * np.log(selection.value / with_row)
        np.testing.assert_allclose(selection.gains[8:], fall, rtol=1e-6)


def test_drawn_machines_keep_to_the_directions_that_matter():
    """What is left out is left out exactly, also where the priors differ from one another."""
    rng = np.random.default_rng(6)
    felt, sd = rng.normal(size=(4, 9)), np.ones(9)
    W, G = rng.normal(size=(30, 4)) @ felt, rng.normal(size=(5, 3, 4)) @ felt
    scale = rng.uniform(0.5, 2.0, (3, 9))
    criterion = robust(mean_prediction(G, W, sd), scale, 1.0)
    assert criterion.size == 4
    whole = [
        np.mean([np.trace(g @ np.linalg.inv(np.diag(s**-2.0) + W.T @ W) @ g.T) for g in G])
        for s in scale
    ]
    rows = criterion.rows(W)
    assert criterion.value(rows.T @ rows) == pytest.approx(np.mean(whole), rel=1e-8)


def test_potential_terms_go_from_a_line_to_a_parabola():
    """A straight line with a potential square (DuMouchel and Jones 1994), against its closed form.

    With half of the weight 1 - w at either end, ``det M`` of the information without a prior on the
    line is ``n^2 (1 - w) (1 + s^2 n (1 - w) w)`` for the prior standard deviation s of the square.
    """
    runs = 40
    for s in (0.02, 0.3, 3.0):
        square = s * PLACES**2
        rows = np.stack([SLACK * np.ones(21), SLACK * PLACES, square], axis=1)
        W, place = np.repeat(rows, runs, axis=0), np.repeat(np.arange(21), runs)
        criterion = with_potential(DesignCriterion(np.eye(2), Determinant(2)), 1, 0.0)
        start = np.zeros(len(W), dtype=bool)
        start[np.random.default_rng(1).choice(len(W), runs, replace=False)] = True
        found = relaxed(criterion, W, runs, start, 1e-5)
        w = np.linspace(0.0, 1.0, 100001)[:-1]
        best = w[np.argmax((1.0 - w) * (1.0 + s * s * runs * (1.0 - w) * w))]
        weight = np.bincount(place, weights=found.weight) / runs
        assert weight[10] == pytest.approx(best, abs=WEIGHT)
        assert weight[0] == pytest.approx(weight[20], abs=WEIGHT)


def test_potential_terms_join_the_mean_and_can_be_left_out_again():
    rng = np.random.default_rng(2)
    half, W = rng.normal(size=(3, 3)), rng.normal(size=(9, 5))
    plain = mean_variance(half @ half.T)
    criterion = with_potential(plain, 2, 0.7)
    inverse = np.linalg.inv(np.eye(5) + W.T @ W)
    by_hand = np.trace(inverse[:3, :3] @ half @ half.T) + 0.7 * np.trace(inverse[3:, 3:]) / 2.0
    assert criterion.value(W.T @ W) == pytest.approx(by_hand, rel=1e-10)
    assert criterion.primary is plain


def test_shares_that_nothing_keeps_are_refused():
    quota = Quota(np.arange(6) % 2, np.array([1, 1]))
    with pytest.raises(DesignError, match="keep the shares"):
        largest_sum(np.ones(6), 4, (quota,))


def test_tail_and_scales_that_mean_nothing_are_refused():
    with pytest.raises(DesignError, match="tail"):
        DesignCriterion(np.eye(2), Determinant(2), tail=0.0)
    with pytest.raises(DesignError, match="expected above zero"):
        robust(mean_variance(np.eye(2)), np.array([[1.0, 0.0]]), 1.0)


def test_the_five_are_their_definitions_over_the_same_directions():
    rng = np.random.default_rng(8)
    G, W, sd = rng.normal(size=(5, 3, 4)), rng.normal(size=(9, 4)), rng.uniform(0.5, 2.0, 4)
    five = five_criteria(G, W, sd)
    M = np.linalg.inv(np.eye(4) + W.T @ W)
    scaled = G * sd
    variances = [np.trace(g @ M @ g.T) for g in scaled]
    half = np.linalg.cholesky(sum(g.T @ g for g in scaled) / 5.0)
    expected = {
        "I": np.mean(variances),
        "G": max(variances),
        "D": np.linalg.det(M) ** 0.25,
        "A": np.trace(M),
        "E": np.linalg.eigvalsh(half.T @ M @ half)[-1],
    }
    assert set(five) == set(expected)
    for name, criterion in five.items():
        rows = criterion.rows(W)
        assert criterion.value(rows.T @ rows) == pytest.approx(expected[name], rel=1e-9)


@pytest.mark.parametrize(
    ("measure", "along"),
    [
        (LogDeterminant(3.0), lambda t, a, b, c, d: 3.0 * np.log(1.0 + b * t - d * t * t)),
        (Trace(np.eye(2)), lambda t, a, b, c, d: (a * t - c * t * t) / (1.0 + b * t - d * t * t)),
    ],
    ids=["log det", "trace"],
)
def test_slopes_of_a_flow_are_those_of_differences(measure, along) -> None:
    factors = 0.7, 0.4, 0.2, 0.3
    slope = approx_fprime([0.6], lambda t: along(t[0], *factors))
    assert measure.flow_slope(0.6, *factors) == pytest.approx(slope[0], rel=1e-6)
