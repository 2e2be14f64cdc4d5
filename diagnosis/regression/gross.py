"""Gross errors: touches on a chip, slips of the pen. Found, shown, kept out of the estimates."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_triangular
from scipy.special import gammainc, ndtri

from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.regression.features import (
    Features,
    Offsets,
    robust_scale,
    together,
    whole_features,
)
from matstd.diagnosis.regression.linear import Solution, solve
from matstd.twin.frames import Array, IntArray, Mask
from matstd.twin.record import Touches

MIN_EVEN_SHOTS = 7
"""Least number of shots whose sizes and gaps can be called even; of four it happens by chance."""

MIN_CROWD_NEIGHBOURS = 3
"""Of a shot's four neighbours in the run, so many also apart make it part of a crowd, which has a
cause of its own and is not a row of accidents."""

MIN_SCORE_SHARE = 0.5
"""A round takes out only what stands out at least half as far as the farthest touch: chips that
bend the fit make good touches look bad, until they are out."""

MAX_GROSS_ROUNDS = 30  # most rounds; two touches that alternate would never settle
MIN_DOF = 10.0  # with fewer degrees of freedom there is no scale by which a touch could stand out


@dataclass(frozen=True, eq=False)
class GrossErrors:
    """Result of the test of every touch against the fit to the others."""

    rows: Mask  # which touches are gross errors, (N,)
    size: Array  # left-out prediction error of every touch, (N,), in units of the stated noise
    score: Array  # the same in units of its standard deviation, (N,)
    limit: float  # score above which a touch is a gross error
    # whether more stood out than accidents can explain, so that none was taken out
    too_many: bool = False
    standing: Mask | None = None  # those that stood out then, (N,); None where none did
    # those of them that are off together with others of their feature, (N,); None where none are
    together: Mask | None = None

    @property
    def accidents(self) -> Mask:
        """Gross errors that each have a cause of their own, (N,)."""
        return self.rows if self.together is None else self.rows & ~self.together

    @property
    def are_many(self) -> bool:
        """Whether more accidents than usual were taken out, so that both errors are reported."""
        return float(self.accidents.sum()) > POLICY.accident_share * len(self.rows)


@dataclass(frozen=True, eq=False)
class _Whole:
    """The fit to all rows that may be used, from which any of them can be taken out again."""

    W: Array  # rows of its Q, of the rows that may not be used their spread, (N, P)
    rest: Array  # observed minus predicted, (N,)

    @classmethod
    def of(cls, X: Array, y: Array, fit: Solution, allowed: Mask) -> "_Whole":
        """For whitened columns (N, P) and observations (N,)."""
        W, rest = np.empty(X.shape), y - X @ fit.phi
        W[allowed], W[~allowed] = fit.Q, fit.spread(X[~allowed])
        return cls(W, rest)

    def left_out_each(self, used: Mask, out: IntArray) -> tuple[Array, Array]:
        """Prediction error of every row by the other used rows, and its variance, (N,) each.

        Rows S that are taken out move the prediction of every row by ``W Q_S^T M^-1 r_S`` with
        ``M = 1 - Q_S Q_S^T``, and widen it by as much: no new fit for a few touches.

        Args:
            used: Rows of the fit without those, (N,).
            out: Numbers of the rows taken out.
        """
        own, error = (self.W**2).sum(axis=1), self.rest
        if len(out):
            Q = self.W[out]
            # rows that alone decide a number leave no more than rounding
            L = np.linalg.cholesky((1.0 + 1e-12) * np.eye(len(out)) - Q @ Q.T)
            moved = solve_triangular(
                L, np.column_stack([Q @ self.W.T, error[out]]), lower=True, check_finite=False
            )
            error = error + moved[:, :-1].T @ moved[:, -1]
            own = own + (moved[:, :-1] ** 2).sum(axis=0)
        left = np.maximum(1.0 - own, 1e-9)
        return np.where(used, error / left, error), np.where(used, 1.0 / left, 1.0 + own)


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
    X: Array,
    y: Array,
    allowed: Mask,
    shot: IntArray | None = None,
    features: Features | None = None,
) -> tuple[Solution, GrossErrors]:
    """Fit and gross errors together: take out what stands out, take back what fits after all.

    Every round tests all touches, inside and outside the fit alike, by the prediction of the other
    touches; the leverage is in the variance of that prediction. The scale is a median, so that
    neither chips nor an unknown effect hides a chip. The limit holds for the largest of N normal
    scores (Bonferroni). With one coordinate of a shot the others go: a target that was seen at
    another moment is wrong in all, and those that are less so would pass for an effect. Features
    that are off as a whole are out from the start.

    Args:
        X: Whitened columns, (N, P).
        y: Whitened observations, (N,).
        allowed: Rows that may be used at all (not those held out), (N,).
        shot: Shot of every row, as from `shots`, (N,); None where each is one of its own.
        features: What every row is of; None where none is known.

    Returns:
        The fit to the used rows, in their order, and the gross errors of all rows.
    """
    shot = np.arange(len(y)) if shot is None else np.unique(shot, return_inverse=True)[1]
    features = features or Features(np.full(len(y), -1), np.zeros((len(y), 3)))
    n = int(allowed.sum())
    limit = float(-ndtri(0.5 * POLICY.false_alarm / max(n, 1)))
    every = solve(X[allowed], y[allowed])
    if every.dof < MIN_DOF:
        zero, nothing = np.zeros(len(y)), np.zeros(len(y), dtype=bool)
        return every, GrossErrors(rows=nothing, size=zero, score=zero, limit=limit)
    whole = _Whole.of(X, y, every, allowed)
    off = whole_features(whole.rest, every, allowed, features)
    used, error, score = _settled(whole, allowed, limit, shot, off)
    kept = off.still(allowed & ~used, features)
    if kept.rows.sum() < off.rows.sum():
        off = kept
        used, error, score = _settled(whole, allowed, limit, shot, off)
    out = allowed & ~used
    common = (out & off.rows) | together(out, allowed, error, features)
    alone, others = out & ~common, allowed & ~common
    is_few = alone.sum() <= POLICY.accident_share * n
    is_right = is_few or _are_accidents(alone, others, score / limit, shot)
    # too many, or with a common cause: then all touches stay in the fit
    rows = out if is_right else common
    fit = solve(X[allowed & ~rows], y[allowed & ~rows]) if rows.any() else every
    return fit, GrossErrors(
        rows=rows,
        size=error,
        score=score,
        limit=limit,
        too_many=not is_right,
        standing=None if is_right else alone,
        together=common if common.any() else None,
    )


def _settled(
    whole: _Whole, allowed: Mask, limit: float, shot: IntArray, off: Offsets
) -> tuple[Mask, Array, Array]:
    """Rows in use once none goes out and none comes back, prediction errors and scores, (N,) each.

    Args:
        limit: Score above which a touch is a gross error.
        off: Features that are out from the start; their touches that are right come back.
    """
    n, used = int(allowed.sum()), allowed & ~off.rows
    for _ in range(MAX_GROSS_ROUNDS):
        error, variance = whole.left_out_each(used, np.flatnonzero(allowed & ~used))
        z = error / np.sqrt(variance)
        scale = robust_scale(z[allowed & ~off.rows])
        score = z / scale if scale > 0.0 else np.zeros_like(z)
        inside = np.abs(score[used])
        # gross errors bend the fit, so only the farthest go out in one round
        bar = max(limit, MIN_SCORE_SHARE * float(inside.max(initial=0.0)))
        far = ~off.rows & (np.abs(score) > np.where(used, bar, limit))
        aside = off.rows & (np.abs(error) > off.half)
        wanted = allowed & ~_alone(far, shot) & ~aside
        if (wanted == used).all():
            break
        used = wanted
        if n - int((wanted | off.rows).sum()) > POLICY.gross_share * n:
            break
    return used, error, score


def _are_accidents(out: Mask, allowed: Mask, score: Array, shot: IntArray) -> bool:
    """Whether many touches that stand out look like accidents.

    They are far from the rest, differ in size, come at uneven gaps, and are not together.

    Args:
        score: In units of the limit, (N,).
    """
    every, place = np.unique(shot[allowed], return_inverse=True)
    size = np.zeros(len(every))
    np.maximum.at(size, place, np.abs(score[allowed]))
    bad = np.flatnonzero(np.isin(every, shot[out]))
    n, g = len(every), len(bad)
    if g > POLICY.gross_share * n or np.median(size[bad]) < POLICY.accident_score:
        return False
    gaps = np.diff(bad)
    pairs, mean = int((gaps == 1).sum()), g * (g - 1) / n
    is_crowd = pairs > 0 and float(gammainc(pairs, mean)) < POLICY.accident_neighbours
    if is_crowd or g < MIN_EVEN_SHOTS:
        return not is_crowd
    return all(
        float(np.std(v, ddof=1)) > POLICY.accident_variation * float(np.mean(v))
        for v in (size[bad], gaps)
    )


def _alone(far: Mask, shot: IntArray) -> Mask:
    """Rows of those shots, numbered in the order of probing, with a far row and in no crowd."""
    is_far = np.zeros(int(shot.max()) + 1, dtype=bool)
    is_far[shot[far]] = True
    padded = np.pad(is_far, 2).astype(int)
    n = len(is_far)
    crowd = padded[0:n] + padded[1 : n + 1] + padded[3 : n + 3] + padded[4 : n + 4]
    return np.asarray((is_far & (crowd < MIN_CROWD_NEIGHBOURS))[shot])
