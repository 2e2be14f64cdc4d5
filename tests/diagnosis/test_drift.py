"""Laws of a thermal drift, each beside something that does not share its code."""

import numpy as np
import pytest

from matstd.diagnosis.drift import (
    DriftRecord,
    chosen,
    joined,
    judge,
    offered,
    predict_with_probings,
)
from matstd.diagnosis.drift.lags import Lagged, at_once, first_order_lag
from matstd.diagnosis.drift.linear import WEIGHTS, fitted, ridge
from matstd.diagnosis.drift.probing import RENEWAL_TIME
from matstd.diagnosis.drift.record import blocks
from matstd.twin.compute import silent
from matstd.twin.units import UM

STEP = 300.0


def heat(rng, rows=400, drives=4):
    """Temperatures that wander, and a spindle that is on and off."""
    T = 20.0 + np.cumsum(0.1 * rng.standard_normal((rows, drives)), axis=0)
    rpm = 1000.0 * np.repeat(rng.integers(0, 4, rows // 40 + 1), 40)[:rows]
    rpm[:40] = 0.0
    return np.column_stack([T, rpm])


def record_of(drive, displacement):
    names = tuple(f"t{k}" for k in range(drive.shape[1] - 1))
    count = displacement.shape[1]
    return DriftRecord(
        time=np.arange(len(drive)) * STEP,
        stretch=np.zeros(len(drive), dtype=np.int64),
        step=STEP,
        drives=(*names, "spindle_rpm"),
        drive=drive,
        components=tuple("xyz"[:count]),
        units=("mm",) * count,
        displacement=displacement,
    )


def by_its_equation(a, b, constant, drive, first):
    """The difference equation of the paper, step by step; b is (D, q)."""
    out = list(first)
    for t in range(len(first), len(drive)):
        past = sum(a[i] * out[t - 1 - i] for i in range(len(a)))
        new = sum(b[j, k] * drive[t - k, j] for j in range(b.shape[0]) for k in range(b.shape[1]))
        out.append(constant + past + new)
    return np.array(out)


@pytest.fixture(scope="module")
def planted():
    """A drift of its own past (time constants 30 and 110 min), two sensors and the speed."""
    rng = np.random.default_rng(3)
    drive = heat(rng)
    a = np.poly(np.exp(-STEP / np.array([1800.0, 6600.0])))
    b = np.zeros((5, 2))
    b[0], b[2], b[4] = (3e-4, -2e-4), (-1e-4, 0.0), (1e-7, 0.0)
    settled = (0.001 + drive[0] @ b.sum(axis=1)) / a.sum()
    true = by_its_equation(-a[1:], b, 0.001, drive, [settled, settled])
    y = np.column_stack([true, -0.5 * true]) + 0.1 * UM * rng.standard_normal((len(true), 2))
    return record_of(drive, y)


def test_ridge_is_that_of_scikit_learn(planted):
    from sklearn.linear_model import Ridge

    rows = np.arange(100, 300)
    law = fitted(planted, at_once(planted), [rows], 0.03)
    Z = (planted.drive - planted.drive[rows].mean(axis=0)) / planted.drive[rows].std(axis=0)
    theirs = Ridge(alpha=0.03 * len(rows)).fit(Z[rows], planted.displacement[rows])
    np.testing.assert_allclose(law.predicted(planted), theirs.predict(Z), atol=1e-9)


def test_the_weight_of_a_ridge_is_the_best_of_refitted_blocks(planted):
    from sklearn.linear_model import Ridge

    parts = blocks(np.arange(280), 4)
    law = ridge(planted, at_once(planted), parts)
    y = planted.displacement / UM
    Z = (planted.drive - planted.drive[:280].mean(axis=0)) / planted.drive[:280].std(axis=0)

    def left_out(weight):
        total = 0.0
        for part in parts:
            others = np.setdiff1d(np.arange(280), part)
            theirs = Ridge(alpha=weight * len(others)).fit(Z[others], y[others])
            total += ((theirs.predict(Z[part]) - y[part]) ** 2).sum()
        return total

    own = left_out(law.weight)
    assert all(own <= 1.0001 * left_out(w) for w in WEIGHTS)


def test_a_lag_is_the_exact_solution_of_a_body_that_warms_up():
    """A speed that is on from row 10: 1 - exp(-t/tau); a temperature has settled at its first."""
    drive = np.column_stack([np.full(100, 25.0), np.where(np.arange(100) < 10, 0.0, 2000.0)])
    record = record_of(drive, np.zeros((100, 1)))
    t = np.maximum(np.arange(100) - 9, 0) * STEP
    speed = first_order_lag(record, "spindle_rpm", 3000.0)
    np.testing.assert_allclose(speed, 2000.0 * -np.expm1(-t / 3000.0), atol=1e-9)
    np.testing.assert_allclose(first_order_lag(record, "t0", 3000.0), 25.0)


def test_a_log_of_another_day_begins_anew(planted):
    two = joined([planted, planted])
    columns = Lagged((("spindle_rpm", 3600.0), ("t0", 3600.0)))
    once, twice = columns(planted), columns(two)
    np.testing.assert_array_equal(twice, np.vstack([once, once]))


def test_left_out_blocks_choose_and_their_uncertainty_holds(planted):
    judged = judge(planted, np.arange(280), np.arange(280, 400), offered(planted), silent)
    best = chosen(judged, planted)
    assert best.left_out[0] == min(j.left_out[0] for j in judged)
    z = ((best.law.predicted(planted) - planted.displacement) / best.u(planted))[280:]
    assert 0.8 <= np.mean(np.abs(z) < 2.0) <= 1.0


def test_probing_is_what_conditioning_a_gaussian_process_gives(planted):
    """The filter against one solution with the whole covariance of state and probings."""
    laws = {"static-ridge": offered(planted)["static-ridge"]}
    (judged,) = judge(planted, np.arange(280), np.arange(280, 400), laws, silent)
    at = np.array([20, 60, 61, 150])
    result = predict_with_probings(judged, planted, at, 2.0)
    law, n = judged.law, 180
    X, t = law.basis(planted)[:n], np.arange(n) * STEP
    variance = float(judged.factor[0] * law.residual[0]) ** 2
    forgets = variance * np.exp(-np.abs(t[:, None] - t) / law.memory)
    drifts = 1.0 + np.minimum(t[:, None], t) / RENEWAL_TIME
    K = forgets + variance * drifts * (X @ law.covariance @ X.T)
    free = law.predicted(planted)[:n, 0]
    misses = planted.displacement[:n, 0] - free
    for row in (10, 20, 59, 100, 149, 170):
        seen = at[at <= row]
        if not len(seen):
            want, v = 0.0, K[row, row]
        else:
            S = K[np.ix_(seen, seen)] + (2.0 * UM) ** 2 * np.eye(len(seen))
            want = K[row, seen] @ np.linalg.solve(S, misses[seen])
            v = K[row, row] - K[row, seen] @ np.linalg.solve(S, K[seen, row])
        assert result.predicted[row, 0] - free[row] == pytest.approx(want, abs=1e-9)
        assert result.u[row, 0] == pytest.approx(np.sqrt(v), rel=1e-6)


# --- logs with zeros of their own ---------------------------------------------------------------


@pytest.fixture(scope="module")
def days():
    """Three days of one law, z = 3 um/K t0 + 0.5 um/K t1, each from another zero."""
    rng = np.random.default_rng(8)
    out = []
    for zero in (0.0, 80.0, -45.0):
        drive = heat(rng, rows=200, drives=2)
        drift = 3.0 * drive[:, :1] + 0.5 * drive[:, 1:2] + zero + rng.normal(0.0, 0.3, (200, 1))
        out.append(record_of(drive, drift * UM))
    return out


def test_own_zeros_are_dummy_columns_of_least_squares(days):
    """By a column for every log, as a textbook would have it."""
    record = joined(days, own_zeros=True)
    parts = [np.flatnonzero(record.zeros == k) for k in range(3)]
    law = fitted(record, at_once(record), parts, 1e-12)
    dummies = (record.zeros[:, None] == np.arange(3)).astype(float)
    X = np.column_stack([record.drive, dummies])
    theta = np.linalg.lstsq(X, record.displacement[:, 0])[0]
    np.testing.assert_allclose(law.coefficients[:, 0] / law.scale, theta[:3], rtol=1e-5)
    np.testing.assert_allclose(theta[:2] / UM, [3.0, 0.5], atol=0.05)


def test_a_day_from_another_zero_is_predicted(days):
    """The third day held out: as good as its noise with own zeros, lost without them."""
    left = {}
    for own_zeros in (False, True):
        record = joined(days, own_zeros)
        train, held = np.arange(400), np.arange(400, 600)
        judged = judge(record, train, held, offered(record), silent)
        best = chosen(judged, record)
        left[own_zeros] = best.free_run[0] / UM
        ratio = best.u(record)[held].mean() / UM
    assert left[False] > 10.0
    assert left[True] < 0.4
    assert 0.2 < ratio < 0.6
    moved = record.rezeroed(best.law.predicted(record))
    assert np.abs(moved.displacement - best.law.predicted(record)).max() < 2.0 * UM
    first = record.rezeroed(best.law.predicted(record), np.array([400]))
    assert first.displacement[400, 0] == pytest.approx(best.law.predicted(record)[400, 0])
    np.testing.assert_array_equal(first.displacement[:400], record.displacement[:400])
