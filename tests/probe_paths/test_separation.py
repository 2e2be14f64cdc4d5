"""Gaps of moving cylinders from convex bodies, against projections that share nothing with them."""

import numpy as np
import pytest

from matstd.probe_paths.plan.separation import EXACT, Hulls, Sweeps, balls_apart, gaps, least_gaps

SIGNS = np.array([[a, b, c] for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)])
SHORT = 1e-6
"""What a distance found by projections may be too short by, mm: it never is, but for rounding."""


def random_pairs(rng, count):
    """Boxes about the origin, and cylinders on their way past them."""
    axis = rng.normal(size=(count, 3))
    half = rng.uniform(5.0, 30.0, (count, 3))
    sweeps = Sweeps(
        centre=rng.uniform(-60.0, 60.0, (count, 3)),
        axis=axis / np.linalg.norm(axis, axis=1)[:, None],
        way=rng.normal(size=(count, 3)) * 10.0,
        low=np.zeros(count),
        high=rng.uniform(5.0, 40.0, count),
        radius=rng.uniform(1.0, 20.0, count),
        ball=np.zeros(count),
    )
    hulls = Hulls(
        corner=SIGNS * half[:, None],
        disc=np.zeros((count, 8)),
        up=np.tile([0.0, 0.0, 1.0], (count, 1)),
        ball=np.zeros(count),
    )
    return sweeps, hulls, half


def on_sweep(s, x, rounds=60):
    """Points of the swept cylinders near given ones, by turns along the way and in the cylinder."""
    share = np.zeros(len(x))
    for _ in range(rounds):
        local = x - s.centre - share[:, None] * s.way
        along = np.clip(np.einsum("mi,mi->m", local, s.axis), s.low, s.high)
        across = local - np.einsum("mi,mi->m", local, s.axis)[:, None] * s.axis
        size = np.linalg.norm(across, axis=1)
        across *= np.minimum(1.0, s.radius / np.maximum(size, 1e-12))[:, None]
        off = along[:, None] * s.axis + across
        length = np.einsum("mi,mi->m", s.way, s.way)
        share = np.clip(np.einsum("mi,mi->m", x - s.centre - off, s.way) / length, 0.0, 1.0)
    return s.centre + share[:, None] * s.way + off


def test_gaps_are_those_of_alternating_projections_and_never_larger():
    sweeps, hulls, half = random_pairs(np.random.default_rng(3), 400)
    found = gaps(sweeps, hulls, np.inf)
    x = sweeps.middle
    for _ in range(300):
        y = np.clip(x, -half, half)
        x = on_sweep(sweeps, y)
    distance = np.linalg.norm(x - np.clip(x, -half, half), axis=1)
    assert (found > 0.0).sum() > 250
    assert (found == 0.0).sum() > 25
    assert np.max(found - distance) < SHORT
    # projections creep where faces are nearly parallel: a few have not arrived
    assert np.mean(distance - found < 2.0 * EXACT) > 0.98


def test_enough_is_enough():
    """With a limit every gap below it is the same, and no other is reported below it."""
    sweeps, hulls, _ = random_pairs(np.random.default_rng(4), 800)
    exact, quick = gaps(sweeps, hulls, np.inf), gaps(sweeps, hulls, 5.0)
    assert np.all(quick <= exact + 2.0 * EXACT)
    near = exact < 5.0 - EXACT
    assert near.sum() > 100
    np.testing.assert_allclose(quick[near], exact[near], atol=2.0 * EXACT)
    assert np.all(quick[~near] >= 5.0 - 2.0 * EXACT)


def test_discs_and_balls_by_hand():
    """A ball beside a disc on edge, over its face, and over its rim; a cone beside its wall."""
    disc = Hulls(
        corner=np.array([[[0.0, 0.0, 0.0]] * 4 + [[0.0, 0.0, 10.0]] * 4] * 4),
        disc=np.array([[20.0] * 8] * 3 + [[20.0] * 4 + [10.0] * 4]),
        up=np.tile([0.0, 0.0, 1.0], (4, 1)),
        ball=np.zeros(4),
    )
    centre = np.array([[30.0, 0.0, 5.0], [3.0, 4.0, 17.0], [0.0, 23.0, 14.0], [0.0, 25.0, 5.0]])
    still = Sweeps(
        centre=centre,
        axis=np.tile([0.0, 0.0, 1.0], (4, 1)),
        way=np.zeros((4, 3)),
        low=np.zeros(4),
        high=np.zeros(4),
        radius=np.zeros(4),
        ball=np.full(4, 2.0),
    )
    # the wall of the cone leans by 45 degrees and is met at 15 in the middle: 10 sin 45
    by_hand = [8.0, 5.0, 3.0, 10.0 / np.sqrt(2.0) - 2.0]
    np.testing.assert_allclose(gaps(still, disc, np.inf), by_hand, atol=2.0 * EXACT)


def test_balls_round_bodies_are_never_farther_than_the_bodies():
    sweeps, hulls, _ = random_pairs(np.random.default_rng(5), 800)
    bound, exact = balls_apart(sweeps, hulls), gaps(sweeps, hulls, np.inf)
    assert np.max(bound - exact) < EXACT
    assert (bound > 0.0).sum() > 100


@pytest.mark.parametrize("enough", [np.inf, 8.0])
def test_least_gaps_of_groups_are_those_of_all_rows_searched(enough: float) -> None:
    rng = np.random.default_rng(6)
    sweeps, hulls, _ = random_pairs(rng, 800)
    group = rng.integers(0, 100, 800)
    searched = []

    def search(rows, limit):
        searched.append(rows)
        return gaps(sweeps[rows], hulls[rows], limit)

    found = least_gaps(balls_apart(sweeps, hulls), group, np.full(800, enough), search)
    exact = gaps(sweeps, hulls, np.inf)
    for k in np.unique(group):
        least = exact[group == k].min()
        if least < enough - EXACT:
            assert abs(found[group == k].min() - least) < 2.0 * EXACT
        else:
            assert found[group == k].min() > enough - 2.0 * EXACT
    assert len(np.concatenate(searched)) < 600
