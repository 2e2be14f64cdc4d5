"""The counting engine: compiled and numpy against sorting, threads, tolerance, stopping."""

import numpy as np
import pytest

from sensitivity.lengths import BINS, compiled_kernel, count_lengths
from sensitivity.montecarlo import volumetric
from sensitivity.sampling import Population
from sensitivity.workspace import latin_hypercube
from twin.units import UM

LENGTH = 160.0


@pytest.fixture(scope="module")
def task():
    rng = np.random.default_rng(1)
    G, theta = rng.normal(size=(70, 3, 9)), rng.normal(size=(9, 3000))
    size = np.linalg.norm(np.einsum("nik,ks->nsi", G, theta), axis=2)
    return G, theta, np.full(70, 0.01), size


@pytest.mark.parametrize("compiled", [False, True])
@pytest.mark.parametrize("threads", [1, 3])
def test_counts_are_those_of_plain_numpy(task, compiled, threads):
    if compiled and compiled_kernel() is None:
        assert count_lengths(*task[:3], compiled=True).histogram.sum() == task[3].size
        return
    G, theta, width, size = task
    found = count_lengths(G, theta, width, 4.0, compiled, threads)
    np.testing.assert_allclose(found.sum, size.sum(axis=1), rtol=1e-12)
    np.testing.assert_allclose(found.squares, (size**2).sum(axis=1), rtol=1e-12)
    np.testing.assert_array_equal(found.above, (size > 4.0).sum(axis=1))
    index = np.minimum(size / width[:, None], BINS - 1).astype(int)
    for row, expected in zip(found.histogram, index, strict=True):
        off = np.abs(row - np.bincount(expected, minlength=BINS)).sum()
        assert off <= 2  # a length on the edge of two bins may fall either way
        assert row.sum() == 3000


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
