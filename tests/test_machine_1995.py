"""The claims of the third paper on the exact twin: each within what it may be, with its seeds."""

import importlib
import sys
from pathlib import Path

import numpy as np
import pytest

PLACE = Path(__file__).parents[1] / "examples" / "machine_1995"


@pytest.fixture(scope="module")
def claims():
    if str(PLACE) not in sys.path:
        sys.path.append(str(PLACE))
    return importlib.import_module("claims")


@pytest.mark.parametrize("seed", [1995, 2])
def test_rigid_over_compensates_where_the_other_model_does_not(claims, seed):
    found = claims.geometry(seed)
    # 157 um at its height; 46 arcsec on 320 mm and 16 um by x more: 244 of the paper's 250
    assert found["Z, line 1"][0] == pytest.approx(160.0, rel=0.05)
    assert found["Z, line 2"][0] == pytest.approx(250.0, rel=0.05)
    assert max(found["Z, line 1"][1], found["Z, line 2"][1]) < 10.0
    before, rigid, other = np.array([found[f"X, line {k}"] for k in (1, 2, 3, 4)]).T
    assert np.all((before >= 70.0) & (before <= 115.0))
    assert rigid.min() == pytest.approx(-30.0, abs=3.0)
    assert rigid.max() == pytest.approx(10.0, abs=3.0)
    assert rigid[1] < -10.0
    assert rigid[3] < -10.0
    assert np.abs(other).max() < 3.0
    holes = found["holes"]
    assert holes[0] == pytest.approx(92.4, rel=0.05)  # put in: the growth of Fig. 22
    assert 12.0 < holes[1] < 20.0
    assert holes[2] < 3.0


def test_the_over_compensation_is_that_of_a_hand(claims):
    """120 urad of pitch over 750 mm of X, unknown to the rigid model, on a lever of 250 mm."""
    found = claims.geometry(1995)["X, line 2"]
    assert found[1] - found[2] == pytest.approx(-120e-6 * 250.0 * 1e3, abs=1.0)


def test_no_figure_after_compensation_follows_from_the_growth_put_in(claims, monkeypatch):
    """Twice the growth: 90 um more before, and the same 16 and 0.5 um left."""
    once = claims.geometry(1995)["holes"]
    monkeypatch.setattr(claims, "WARM", {n: 2.0 * size for n, size in claims.WARM.items()})
    twice = claims.geometry(1995)["holes"]
    # 298 ppm of a machine that is otherwise right within a few um over 304 mm
    assert twice[0] - once[0] == pytest.approx(298e-6 * 304e3, rel=0.02)
    np.testing.assert_allclose(twice[1:], once[1:], atol=0.05)


@pytest.mark.slow
def test_the_step_of_two_cuts_falls_to_a_twentieth(claims):
    steps = [claims.step_of_two_cuts(seed) for seed in (1995, 2, 3)]
    assert np.median([left / before for before, left in steps]) < 0.051
