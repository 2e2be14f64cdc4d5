"""Gross errors: touches on a chip, slips of the pen. Found, shown, kept out of the estimates."""

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri

from diagnosis.regression.linear import BoolArray, Solution, solve
from twin.frames import Array
from twin.record import IntArray, Touches

CHANCE = 1e-3
"""Probability that a run without gross errors is said to have one."""

MOST = 0.05
"""Largest share of touches that may be gross errors; more of them are structure, not accidents."""

CROWD = 3
"""Of a touch's four neighbours in the run, so many also apart make it part of a crowd, which has a
cause of its own and is not a row of accidents."""

BY_HALVES = 0.5
"""A round takes out only what stands out at least half as far as the farthest touch: chips that
bend the fit make good touches look bad, until they are out."""

ROUNDS = 30
"""Most rounds; two touches that take turns would go on for ever."""

FEWEST_DOF = 10.0
"""With fewer degrees of freedom there is no scale by which a touch could stand out."""


@dataclass(frozen=True, eq=False)
class GrossErrors:
    """Result of the test of every touch against the fit to the others.

    Attributes:
        rows: Which touches are gross errors, (N,).
        size: Left-out prediction error of every touch, (N,), in units of the stated noise.
        score: The same in units of its standard deviation, (N,).
        limit: Score above which a touch is a gross error.
        too_many: Whether more than `MOST` of the touches stood out, so that none was taken out.
    """

    rows: BoolArray
    size: Array
    score: Array
    limit: float
    too_many: bool = False


def robust_scale(values: Array) -> float:
    """Standard deviation by the median of the absolute values; immune to a tenth of outliers."""
    return float(1.4826 * np.median(np.abs(values))) if len(values) else 0.0


def _left_out_each(X: Array, y: Array, fit: Solution, used: BoolArray) -> tuple[Array, Array]:
    """Prediction error of every row by the other used rows, and its variance, (N,) each."""
    h = np.minimum(fit.leverage, 1.0 - 1e-9)
    error, variance = np.zeros(len(y)), np.ones(len(y))
    error[used], variance[used] = fit.residual / (1.0 - h), 1.0 / (1.0 - h)
    out = ~used
    if out.any():
        error[out] = y[out] - X[out] @ fit.phi
        variance[out] = 1.0 + (fit.spread(X[out]) ** 2).sum(axis=1)
    return error, variance


def shots(touches: Touches) -> IntArray:
    """Number of the shot that every row is of, (N,).

    An instrument that sees a target from afar gives several coordinates at once, rows one after the
    other at one place and time that differ in direction alone; a touch is a shot of its own.
    """
    if touches.radius.any():
        return np.arange(len(touches))
    place = np.column_stack([touches.q, touches.time, touches.setup, touches.point])
    is_same = (place[1:] == place[:-1]).all(axis=1)
    is_same &= (touches.normal[1:] != touches.normal[:-1]).any(axis=1)
    return np.concatenate([[0], np.cumsum(~is_same)])


def find_gross(
    X: Array, y: Array, allowed: BoolArray, shot: IntArray | None = None
) -> tuple[Solution, GrossErrors]:
    """Fit and gross errors together: take out what stands out, take back what fits after all.

    Every round tests all touches, inside and outside the fit alike, by the prediction of the other
    touches; the leverage is in the variance of that prediction. The scale is a median, so that
    neither chips nor an unknown effect hides a chip. The limit holds for the largest of N normal
    scores (Bonferroni). With one coordinate of a shot the others go: a target that was seen at
    another moment is wrong in all, and those that are less so would pass for an effect.

    Args:
        X: Whitened columns, (N, P).
        y: Whitened observations, (N,).
        allowed: Rows that may be used at all (not those held out), (N,).
        shot: Of every row, as from `shots`, (N,); None where each is one of its own.

    Returns:
        The fit to the used rows, in their order, and the gross errors of all rows.
    """
    n = int(allowed.sum())
    limit = float(-ndtri(0.5 * CHANCE / max(n, 1)))
    used = allowed.copy()
    fit = solve(X[used], y[used])
    if fit.dof < FEWEST_DOF:
        zero, nothing = np.zeros(len(y)), np.zeros(len(y), dtype=bool)
        return fit, GrossErrors(rows=nothing, size=zero, score=zero, limit=limit)
    for _ in range(ROUNDS):
        error, variance = _left_out_each(X, y, fit, used)
        z = error / np.sqrt(variance)
        scale = robust_scale(z[allowed])
        score = z / scale if scale > 0.0 else np.zeros_like(z)
        inside = np.abs(score[used])
        bar = max(limit, BY_HALVES * float(inside.max(initial=0.0)))
        far = np.abs(score) > np.where(used, bar, limit)
        wanted = allowed & ~_whole(_alone(far), shot)
        if (wanted == used).all():
            break
        if n - int(wanted.sum()) > MOST * n:
            fit = solve(X[allowed], y[allowed])
            nothing = np.zeros(len(y), dtype=bool)
            return fit, GrossErrors(
                rows=nothing, size=error, score=score, limit=limit, too_many=True
            )
        used = wanted
        fit = solve(X[used], y[used])
    return fit, GrossErrors(rows=allowed & ~used, size=error, score=score, limit=limit)


def _whole(rows: BoolArray, shot: IntArray | None) -> BoolArray:
    """Those rows, and the others of their shots."""
    return rows if shot is None else np.isin(shot, shot[rows])


def _alone(far: BoolArray) -> BoolArray:
    """Those far rows that are not in a crowd of far rows; the run is in the order of probing."""
    padded = np.pad(far, 2).astype(int)
    n = len(far)
    crowd = padded[0:n] + padded[1 : n + 1] + padded[3 : n + 3] + padded[4 : n + 4]
    return np.asarray(far & (crowd < CROWD))
