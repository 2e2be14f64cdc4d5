"""Chips are found, wherever they hide; structure is not taken for chips."""

from dataclasses import replace

import numpy as np
import pytest
from made_up import arm_poses

from matstd.diagnosis.fit import fit_run
from matstd.diagnosis.regression import find_gross, shots
from matstd.diagnosis.remarks import What, remarks
from matstd.diagnosis.residual.structure import crowds
from matstd.report.words import remark_sentence
from matstd.twin.library import ordinary_model
from matstd.twin.record import Run
from matstd.twin.units import UM


def test_a_chip_that_bends_the_fit_towards_itself_is_found() -> None:
    """A touch with 80 % leverage: its residual is a fifth of its error, left out it is all."""
    rng = np.random.default_rng(0)
    X = np.column_stack([np.full(200, 10.0), np.r_[28.0, rng.standard_normal(199)]])
    y = X @ np.array([0.1, 0.2]) + rng.standard_normal(200)
    y[0] += 25.0
    fit, gross = find_gross(X, y, np.ones(200, dtype=bool))
    assert np.flatnonzero(gross.rows).tolist() == [0]
    assert gross.size[0] == pytest.approx(25.0, abs=4.0)
    assert len(fit.residual) == 199


def test_noise_has_no_gross_errors() -> None:
    rng = np.random.default_rng(2)
    found = 0
    for _ in range(100):
        X = rng.standard_normal((150, 5)) * 10.0
        found += find_gross(X, rng.standard_normal(150), np.ones(150, dtype=bool))[1].rows.sum()
    assert found <= 2  # one run in a thousand may have one


def test_a_crowd_is_not_a_row_of_accidents() -> None:
    """Touches 60 to 69 moved together: something happened to them, and it must stay in the data."""
    rng = np.random.default_rng(4)
    X = np.full((400, 1), 10.0)
    y = rng.standard_normal(400)
    y[60:70] += 12.0
    y[200] += 30.0
    _, gross = find_gross(X, y, np.ones(400, dtype=bool))
    assert gross.rows[200]
    assert gross.rows[62:68].sum() == 0


def test_held_out_touches_stay_out(case) -> None:
    hard = case(11, "hsm600u", hard=True)
    allowed = np.ones(len(hard.run), dtype=bool)
    allowed[::3] = False
    X = ordinary_model(hard.run.touches.chain).columns(hard.run.touches) / (0.6 * UM) * 0.05
    fit, gross = find_gross(X, hard.run.deviation / (0.6 * UM), allowed)
    assert not gross.rows[::3].any()
    assert len(fit.residual) == int(allowed.sum()) - int(gross.rows.sum())


def test_coordinates_of_one_shot_go_together_and_those_of_another_place_stay() -> None:
    """Rows 30 to 32 are x, y and z of a reflector; z alone is far off."""
    rng = np.random.default_rng(5)
    X = np.full((300, 1), 10.0)
    y = rng.standard_normal(300)
    y[32] += 40.0
    shot = np.repeat(np.arange(100), 3)
    _, gross = find_gross(X, y, np.ones(300, dtype=bool), shot)
    assert np.flatnonzero(gross.rows).tolist() == [30, 31, 32]


def test_a_shot_is_one_place_at_one_time_seen_along_several_directions() -> None:
    seen = arm_poses()
    seen = replace(seen, time=10.0 * seen.pose)
    assert shots(seen).tolist() == seen.pose.tolist()
    repeated = seen[np.repeat(np.arange(0, len(seen), 3), 2)]  # x of every pose, twice
    assert shots(repeated).tolist() == list(range(len(repeated)))
    touched = replace(seen, radius=np.ones(len(seen)))
    assert shots(touched).tolist() == list(range(len(seen)))


def test_coordinates_of_two_shots_are_no_crowd() -> None:
    """Two reflectors seen wrongly are six rows beside one another, and two accidents."""
    seen = arm_poses()
    seen = replace(seen, time=10.0 * seen.pose)
    bad = np.isin(seen.pose, [3, 9])
    every = np.ones(len(seen), dtype=bool)
    assert crowds(seen, every, bad) == {}
    alone = replace(seen, radius=np.ones(len(seen)))  # touches are shots of their own
    assert min(crowds(alone, every, bad).values()) < 1e-3


def _marred(n: int, bad: np.ndarray, size: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Columns, deviations and shots of n reflectors, some seen wrongly in all coordinates."""
    rng = np.random.default_rng(9)
    X, shot = rng.standard_normal((3 * n, 12)) * 10.0, np.repeat(np.arange(n), 3)
    y = rng.standard_normal(3 * n)
    for k, s in zip(bad, size, strict=True):
        y[3 * k : 3 * k + 3] += s * rng.standard_normal(3)
    return X, y, shot


@pytest.mark.parametrize("count", [3, 5, 9, 14])
def test_up_to_a_fifth_scattered_and_uneven_are_accidents(count) -> None:
    """3 to 18 % of 80 shots: the parameters stay within their uncertainty, all that is far goes."""
    rng = np.random.default_rng(count)
    bad = rng.choice(80, count, replace=False)
    X, y, shot = _marred(80, bad, rng.uniform(15.0, 60.0, count))
    fit, gross = find_gross(X, y, np.ones(240, dtype=bool), shot)
    assert not gross.too_many
    assert gross.are_many == (count > 4)
    assert set(shot[gross.rows]) == set(bad)
    assert np.abs(fit.phi * 10.0 * np.sqrt(240.0)).max() < 5.0


def test_a_third_of_the_touches_is_no_accident() -> None:
    rng = np.random.default_rng(1)
    bad = rng.choice(80, 27, replace=False)
    X, y, shot = _marred(80, bad, rng.uniform(15.0, 60.0, 27))
    assert find_gross(X, y, np.ones(240, dtype=bool), shot)[1].too_many


def test_many_that_lie_together_are_structure() -> None:
    """Always two one after the other: far, of all sizes, but not by chance."""
    bad = np.array([10, 11, 22, 23, 29, 30, 48, 49, 65, 66])
    X, y, shot = _marred(80, bad, np.linspace(15.0, 60.0, 10))
    assert find_gross(X, y, np.ones(240, dtype=bool), shot)[1].too_many


def test_the_error_is_reported_both_ways_where_many_stand_out() -> None:
    seen = arm_poses(60)
    seen = replace(seen, time=10.0 * seen.pose)
    rng = np.random.default_rng(8)
    bad = np.isin(seen.pose, rng.choice(60, 6, replace=False))
    off = rng.normal(0.0, 0.02, len(seen)) + bad * rng.normal(0.0, 1.0, len(seen))
    fit = fit_run(Run(seen, off, np.full(len(seen), 0.02)), ordinary_model(seen.chain))
    (remark,) = [r for r in remarks(fit) if getattr(r, "what", None) is What.MANY_STOOD_OUT]
    assert remark.left_out
    assert remark.touches == bad.sum() == fit.gross.rows.sum()
    assert 5.0 * remark.without < remark.whole
    assert "18 of 180 touches are outliers (10 %), scattered" in remark_sentence(remark)


def test_every_size_is_the_error_of_a_fit_without_the_touch():
    """Touches in the fit, chips and touches held out alike, each by a fit of its own."""
    rng = np.random.default_rng(8)
    X, y, allowed = 3.0 * rng.normal(size=(200, 6)), rng.normal(size=200), np.arange(200) < 180
    y[[4, 60, 131]] += [12.0, -15.0, 20.0]
    _, gross = find_gross(X, y, allowed)
    assert np.flatnonzero(gross.rows).tolist() == [4, 60, 131]
    z = np.empty(200)
    for i in range(200):
        others = allowed & ~gross.rows & (np.arange(200) != i)
        A = np.vstack([X[others], np.eye(6)])  # the prior as further rows
        phi = np.linalg.lstsq(A, np.concatenate([y[others], np.zeros(6)]), rcond=None)[0]
        error = y[i] - X[i] @ phi
        assert gross.size[i] == pytest.approx(error, rel=1e-6, abs=1e-9)
        z[i] = error / np.sqrt(1.0 + X[i] @ np.linalg.solve(A.T @ A, X[i]))
    scale = 1.4826 * np.median(np.abs(z[allowed]))
    np.testing.assert_allclose(gross.score, z / scale, rtol=1e-6, atol=1e-9)
