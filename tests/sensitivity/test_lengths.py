"""The counting engine: compiled and numpy against sorting, threads, tolerance, stopping."""

import numpy as np
import pytest

from matstd.sensitivity.first_order import latin_hypercube
from matstd.sensitivity.montecarlo import BINS, count_lengths, volumetric
from matstd.sensitivity.montecarlo.lengths import compiled_count
from matstd.sensitivity.population import Population
from matstd.twin.units import UM

LENGTH = 160.0
SINGLE = 1e-6
"""Compiled sums of lengths are taken in single precision, 512 at a time."""


@pytest.fixture(scope="module")
def task():
    rng = np.random.default_rng(1)
    G, theta = rng.normal(size=(70, 3, 9)), rng.normal(size=(9, 3000))
    size = np.linalg.norm(np.einsum("nik,ks->nsi", G, theta), axis=2)
    return G, theta, np.full(70, 0.01), size


@pytest.mark.usefixtures("compiled_loops")
@pytest.mark.parametrize("use_compiled", [False, True])
@pytest.mark.parametrize("threads", [1, 3])
def test_counts_are_those_of_plain_numpy(task, use_compiled, threads):
    assert compiled_count() is not None  # numba belongs to the test extra
    G, theta, width, size = task
    found = count_lengths(
        G, theta, width, 4.0, worst=(50, 3), use_compiled=use_compiled, threads=threads
    )
    np.testing.assert_allclose(found.sum, size.sum(axis=1), rtol=SINGLE)
    np.testing.assert_allclose(found.squares, (size**2).sum(axis=1), rtol=1e-12)
    np.testing.assert_array_equal(found.above, (size > 4.0).sum(axis=1))
    index = np.minimum(size / width[:, None], BINS - 1).astype(int)
    for row, expected in zip(found.histogram, index, strict=True):
        off = np.abs(row - np.bincount(expected, minlength=BINS)).sum()
        assert off <= 6  # a length on the edge of two bins may fall either way
        assert row.sum() == 3000
    limit = np.sort(size[:50], axis=0)[-3]
    np.testing.assert_array_equal(found.worst, (size >= limit).sum(axis=1))


@pytest.mark.usefixtures("compiled_loops")
@pytest.mark.parametrize("use_compiled", [False, True])
def test_poses_that_are_equally_bad_all_count(use_compiled):
    # machines along one direction: poses are equal, or differ by whole factors
    rng = np.random.default_rng(2)
    G = np.zeros((400, 3, 1))
    theta, width = rng.normal(size=(1, 130)), np.ones(400)
    theta[0, 7] = 0.0
    for factor in (np.ones(400), np.round(3.0 * rng.normal(size=400))):
        G[:, 1, 0] = factor
        found = count_lengths(G, theta, width, worst=(300, 15), use_compiled=use_compiled)
        limit = np.sort(np.abs(factor[:300]))[-15]
        expected = np.where(np.abs(factor) >= limit, 130, 1)  # machine 7 has no error anywhere
        np.testing.assert_array_equal(found.worst, expected)


def test_lots_of_machines_change_nothing(task, monkeypatch):
    G, theta, width, _ = task
    whole = count_lengths(G, theta, width, worst=(70, 4))
    monkeypatch.setattr("matstd.sensitivity.montecarlo.lengths._LENGTHS_HELD", 1)
    cut = count_lengths(G, theta, width, worst=(70, 4))
    for name in ("sum", "squares", "histogram", "worst"):
        np.testing.assert_array_equal(getattr(cut, name), getattr(whole, name), err_msg=name)


def test_without_recurrence_the_statistics_are_the_same(chain, workspace):
    q = latin_hypercube(workspace, 40, np.random.default_rng(7))
    population = Population(chain)
    runs = [
        volumetric(
            population, q, LENGTH, 1500, np.random.default_rng(3), tolerance=0.2, recurrence=r
        )
        for r in (True, False)
    ]
    for name in ("mean", "sd", "quantile", "exceedance"):
        a, b = (getattr(r, name) for r in runs)
        np.testing.assert_allclose(a, b, rtol=1e-6, err_msg=name)
    assert np.isnan(runs[1].recurrence).all()
    assert 0.0 < runs[0].exceedance.mean() < 1.0
    np.testing.assert_array_equal(runs[0].exceedance > 0.05, runs[0].p95 > 0.2)


def test_it_stops_when_the_digits_are_stable(chain, workspace):
    q = latin_hypercube(workspace, 10, np.random.default_rng(7))
    population = Population(chain)
    coarse, fine, short = (
        volumetric(
            population, q, LENGTH, most, np.random.default_rng(3), precision=p, recurrence=False
        )
        for p, most in ((30 * UM, 60_000), (4 * UM, 60_000), (0.01 * UM, 6000))
    )
    assert coarse.achieved <= 30 * UM
    assert fine.achieved <= 4 * UM
    assert coarse.draws < fine.draws < 60_000
    assert short.draws == 6000
    assert short.achieved > 0.01 * UM
    # what it says is true of a run with other random numbers
    other = volumetric(
        population, q, LENGTH, 60_000, np.random.default_rng(4), precision=4 * UM, recurrence=False
    )
    assert np.abs(other.p95 - fine.p95).max() < 12 * UM
