"""Size that is found in four of five runs: by its chance alone, and beside a likelier rival."""

import numpy as np
import pytest
from scipy.stats import f, ncf

from matstd.diagnosis.evidence import Signatures, needed_lengths
from matstd.diagnosis.policy import POLICY

DOF = 400.0
TRIED = 300


def pool(C, tries=1):
    """Candidates of one column each."""
    count = C.shape[1]
    return Signatures(
        complement=None,
        variants=tuple(range(count)),
        owner=np.arange(count),
        names=tuple(f"effect {k}" for k in range(count)),
        C=np.asfortranarray(C),
        start=np.arange(count + 1),
        size=np.linalg.norm(C, axis=0),
        tries=np.full(count, tries),
        tried=TRIED,
    )


def lengths(C, prior, tries=1):
    found = pool(C, tries)
    return needed_lengths(found, np.arange(C.shape[1]), prior, np.zeros((0, C.shape[1])), DOF)


@pytest.mark.parametrize("tries", [1, 40])
def test_without_rivals_it_is_the_power_of_the_f_test(tries) -> None:
    (length,) = lengths(np.eye(5)[:, :1], np.zeros(1), tries)
    threshold = f.isf(POLICY.false_alarm / (tries * TRIED), 1.0, DOF)
    assert 0.88 < ncf.sf(threshold, 1.0, DOF, length) < 0.96


@pytest.mark.parametrize("cosine", [0.6, 0.9])
def test_a_likelier_rival_that_does_less_than_alike_must_stay_behind(cosine) -> None:
    """By draws: effect with evidence ½ (c r)², against that of the rival and what it was ahead."""
    ahead = 6.0
    rival = np.array([cosine, np.sqrt(1.0 - cosine**2)])
    C = np.column_stack([np.eye(5)[:, 0], np.r_[rival, np.zeros(3)]])
    length = lengths(C, np.array([0.0, ahead]))[0]
    r = np.random.default_rng(1).normal(size=(4000, 2)) + np.array([np.sqrt(length), 0.0])
    threshold = f.isf(POLICY.false_alarm / TRIED, 1.0, DOF)
    is_found = (r[:, 0] ** 2 > threshold) & (r[:, 0] ** 2 - (r @ rival) ** 2 > 2.0 * ahead)
    assert 0.8 < is_found.mean() < 0.96


def test_a_rival_alike_counts_as_found() -> None:
    C = np.column_stack([np.eye(5)[:, 0], [0.99, np.sqrt(1.0 - 0.99**2), 0.0, 0.0, 0.0]])
    alone = lengths(np.eye(5)[:, :1], np.zeros(1))[0]
    assert lengths(C, np.array([0.0, 6.0]))[0] == pytest.approx(alone, rel=0.1)


def test_what_a_likelier_rival_nearly_imitates_is_never_detectable() -> None:
    C = np.column_stack([np.eye(5)[:, 0], [0.925, np.sqrt(1.0 - 0.925**2), 0.0, 0.0, 0.0]])
    assert np.isinf(lengths(C, np.array([0.0, 60.0]))[0])
