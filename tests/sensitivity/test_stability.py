"""Adaptive stopping: JCGM 101's tolerances, its worked examples, and a second implementation."""

import numpy as np
import pytest
from machines import none_but

from matstd.report.words import sampling_words
from matstd.report.words.sensitivity_words import stability_words
from matstd.sensitivity.montecarlo import Stability, volumetric
from matstd.sensitivity.montecarlo.stability import Stabiliser, numerical_tolerance
from matstd.sensitivity.population import Distributions, Population
from matstd.twin.errors import DesignError
from matstd.twin.units import UM

LENGTH = 160.0
EVEN = 3**0.5 * UM
"""Half width of an even distribution of standard deviation 1 um."""


@pytest.mark.parametrize(
    ("u", "digits", "delta"),
    [
        # JCGM 101:2008, 7.9.2, examples 1 and 2, and 9.2.2.3 with its 9.2.3 and 9.2.4
        (0.00035, 2, 0.000005),
        (2.0, 1, 0.5),
        (2.0, 2, 0.05),
        (10.1, 2, 0.5),
        (0.0996, 2, 0.005),  # rounds to 0.10
        (99.96, 3, 0.5),  # rounds to 100
    ],
)
def test_tolerances_are_those_of_the_guide(u, digits, delta):
    assert numerical_tolerance(np.array([u]), digits)[0] == pytest.approx(delta, rel=1e-12)


def test_what_does_not_vary_has_nothing_to_settle():
    assert np.isinf(numerical_tolerance(np.zeros(1), 2)).all()


def additive(chain, last):
    """Y = X1 + X2 + X3 + X4 as the tool point along x: four even errors at one pose."""
    one = (0.0, EVEN)
    ranges = none_but(EXX=one, EXY=one, EXZ=one, EX0t=(0.0, last * EVEN))
    return Population(chain, ranges, Distributions(("constant",), ("constant",)))


@pytest.mark.parametrize(
    ("last", "u", "half_width", "rounding"),
    [
        (1.0, 2.00, 3.88, 0.005),  # JCGM 101:2008, 9.2.3, table 3: even distributions
        (10.0, 10.1, 17.0, 0.05),  # 9.2.4, table 4: one of them ten times as wide
    ],
)
def test_additive_models_of_the_guide(chain, last, u, half_width, rounding):
    # the deviation is along x, so its 95 % interval of equal tails is +- the P95 of its length
    q = np.zeros((1, len(chain.axes)))
    found = volumetric(
        additive(chain, last), q, LENGTH, 1_500_000, np.random.default_rng(1), digits=2
    )
    assert found.stability is not None
    assert found.stability.is_stable
    about = 0.05 * UM + rounding * UM  # what it moves by at most with two stable digits
    assert np.hypot(found.mean, found.sd)[0] == pytest.approx(u * UM, abs=about)
    assert found.p95[0] == pytest.approx(half_width * UM, abs=about)


def test_standard_deviations_of_averages_are_those_of_plain_numpy():
    values = np.random.default_rng(3).normal(size=(7, 5, 4))
    stabiliser = Stabiliser(2)
    for batch in values:
        stabiliser.add(batch)
    s = values.std(axis=0, ddof=1) / np.sqrt(7)
    u = np.array([3.0, 0.1, 20.0, 1.0])
    delta = np.array([0.05, 0.005, 0.5, 0.05])
    found = stabiliser.stability(u)
    assert found.ratio == pytest.approx((2 * s / delta).max(), rel=1e-12)
    assert found.batches == 7


def test_it_ends_when_stable_and_says_when_not(chain):
    q = np.zeros((3, len(chain.axes)))
    q[:, chain.axis_index("X")] = (-200.0, 0.0, 150.0)
    population, rng = Population(chain), np.random.default_rng
    coarse = volumetric(population, q, LENGTH, 400_000, rng(1), digits=1, recurrence=False)
    fine = volumetric(population, q, LENGTH, 61_000, rng(1), digits=3, recurrence=False)
    assert coarse.stability is not None
    assert coarse.stability.is_stable
    assert coarse.draws == coarse.stability.batches * 10_240 < 400_000
    assert fine.stability is not None
    assert not fine.stability.is_stable
    assert fine.draws == 5 * 10_240  # whole batches only
    assert "NOT stable to 3" in sampling_words(fine)
    assert "stable to 1 significant digits" in sampling_words(coarse)
    assert sampling_words(coarse).startswith(
        f"{coarse.draws} random machines, seed 1, mean and P95 to"
    )
    # what is called stable does not move by more than its tolerance with other random numbers
    other = volumetric(population, q, LENGTH, 400_000, rng(2), digits=1, recurrence=False)
    delta = numerical_tolerance(coarse.sd, 1)
    for name in ("mean", "sd", "p95"):
        assert (np.abs(getattr(other, name) - getattr(coarse, name)) < 2 * delta).all(), name


def test_digits_that_cannot_be_shown_are_refused(chain):
    q = np.zeros((1, len(chain.axes)))
    with pytest.raises(DesignError, match="expected 20480 or more"):
        volumetric(Population(chain), q, LENGTH, 20_000, np.random.default_rng(1), digits=1)
    with pytest.raises(DesignError, match="expected 1 to 6"):
        volumetric(Population(chain), q, LENGTH, 30_000, np.random.default_rng(1), digits=9)
    assert not Stability(2, 1, np.inf).is_stable
    assert "one batch" in stability_words(Stability(2, 1, np.inf))
