"""Ties between parameters: found in covariances worked by hand, said in words, drawn in frames."""

import numpy as np
import pytest

from matstd.information.identifiability import ties
from matstd.information.identifiability.correlation import correlation
from matstd.report.identifiability import pair_words, short
from matstd.report.maps import draw_ties
from matstd.twin.errors import ShapeMismatch

NAMES = (
    "geometric(EXX,linear)",
    "location(EX0C)",
    "location(EY0C)",
    "geometric(EYX,sinusoidal@90)",
)


def covariance():
    """Two parameters of which touches see the sum alone, with 1e-2 left of the difference known.

    a + b is measured with variance s, a - b keeps 2: covariance (s + 2)/4 and (s - 2)/4, so
    r = (s - 2)/(s + 2).
    """
    s = 0.02
    C = np.diag([(s + 2.0) / 4.0, (s + 2.0) / 4.0, 9.0, 0.0])
    C[0, 1] = C[1, 0] = (s - 2.0) / 4.0
    return C


def test_two_errors_of_which_only_the_sum_is_seen():
    found = ties(covariance(), NAMES)
    (pair,) = found.pairs
    assert pair.r == pytest.approx((0.02 - 2.0) / (0.02 + 2.0))  # -0.980
    assert pair_words(pair, NAMES) == (
        "geometric(EXX,linear) and location(EX0C) (r = -0.980): only their sum is known"
    )
    assert found.groups == ((0, 1),)


def said(C):
    """The strongest tie in words."""
    return pair_words(ties(C, NAMES[:2]).pairs[0], NAMES)


def test_a_full_tie_is_not_shown_as_a_full_one():
    C = np.array([[1.0, 2.0], [2.0, 4.0]])
    assert said(C).endswith("(r > 0.999): only their difference is known")
    C[0, 1] = C[1, 0] = -2.0
    assert said(C).endswith("(r < -0.999): only their sum is known")


def test_correlations_are_those_of_numpy_on_samples():
    rng = np.random.default_rng(2)
    sample = rng.normal(size=(200, 5)) @ rng.normal(size=(5, 5)) * np.array([1.0, 1e-6, 1e3, 5, 2])
    r = correlation(np.cov(sample.T))
    np.testing.assert_allclose(r, np.corrcoef(sample.T), atol=1e-12)


def test_a_parameter_without_variance_has_no_ties():
    r = correlation(covariance())
    assert r[3].tolist() == [0.0, 0.0, 0.0, 1.0]


def test_ties_chain_into_groups_and_the_largest_comes_first():
    r = np.eye(6)
    for i, j, value in ((0, 4, 0.95), (4, 2, -0.92), (1, 5, 0.99), (0, 2, -0.8)):
        r[i, j] = r[j, i] = value
    found = ties(r, "abcdef")
    assert [set(g) for g in found.groups] == [{0, 2, 4}, {1, 5}]
    assert found.groups[0][0] == 4  # of the strongest ties, and its nearest beside it
    assert found.groups[0][1] == 0
    assert [(p.first, p.second) for p in found.pairs] == [(1, 5), (0, 4), (2, 4)]
    assert ties(r, "abcdef", strong=0.999).pairs == ()


def test_names_and_covariance_must_go_together():
    with pytest.raises(ShapeMismatch, match="for 2 names"):
        ties(np.eye(3), ("a", "b"))


def test_the_heat_map_shows_the_correlations_of_the_groups_with_short_names():
    drawn = draw_ties(ties(covariance(), NAMES))
    axes, bar = drawn.axes
    np.testing.assert_allclose(
        axes.images[0].get_array(), [[1.0, -0.980], [-0.980, 1.0]], atol=1e-3
    )
    assert [t.get_text() for t in axes.get_yticklabels()] == ["EXX linear", "EX0C"]
    assert len(axes.patches) == 1  # one frame
    assert bar.get_ylabel() == "correlation r"
    assert short(NAMES[3]) == "EYX cosine"
    assert short("backlash(B)") == "backlash(B)"


def test_many_ties_are_cut_to_what_can_be_read():
    r = np.kron(np.eye(30), np.array([[1.0, 0.97], [0.97, 1.0]]))
    found = ties(r, [f"p{i}" for i in range(60)])
    assert len(found.groups) == 30
    axes = draw_ties(found, most=11).axes[0]
    assert len(axes.get_yticklabels()) == 10  # five whole pairs, no half one
    assert len(axes.patches) == 5


def test_without_ties_the_picture_says_so():
    (text,) = draw_ties(ties(np.eye(3), "abc")).texts
    assert "No two parameters" in text.get_text()
