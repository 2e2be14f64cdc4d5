"""What repeated visits to calibrated places let expect of the next result, as a distribution.

A place j on a feature, at a table pose, was found at y_ij in visit i:

    y_ij = mu + m_j - K_j c + v_ij        m ~ N(0, s_b^2 R),  c ~ N(0, 1),  v_i ~ N(0, s_p^2 R')

with m the machine's systematic error, unknown, K the calibration, known, and v what changes
from visit to visit. The next result, corrected by b, the mean of all y, at a new place and in a new
visit, errs by a normal deviate of the variance

    s_b^2 (1 + 1'R1 / J^2) + |K'1 / J|^2 + s_p^2 (1 + 1'R'1 / (n J^2)) + u_w^2

if s_b, s_p, R and R' are known. They are not: it is averaged over what the visits allow. So
the variance of the machine can be small but never negative, and it is known as well as the visits
determine, not as well as a rule for degrees of freedom says.

Of s_b the prior is that of Berger and Bernardo, sqrt(tr((P R)^2)) s_b, P the inverse covariance of
the contrasts: it gives Student's distribution where the calibration is exact, and is flat in s_b^2
where s_b is much smaller than what the calibration leaves. Of s_p it is 1 / s_p.

Errors of a machine hang together by the region where its linear axes stand, by feature, by table
pose, or not at all; the changes between visits by all, by feature, by table pose, or not at all. R
is a sum of these parts, no part's share is known, and every combination of "none", "a tenth" and
"as much" is as probable as any other at first. Features whose calibration is no better than the
machine inform about a part by feature only through this: an error that hardly goes by region, pose
and place is not expected to go by feature.

Reference:
    JCGM 101:2008, 6.4.9 (Student's distribution from indications), 7.7 (coverage interval).
    Bodnar, Link, Elster: Objective Bayesian inference for a generalized marginal random effects
    model. Bayesian Analysis 11 (2016) 25-45 (known covariance beside an unknown variance).
    Hoeting et al.: Bayesian model averaging. Statistical Science 14 (1999) 382-417.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.special import chdtri, ndtr, ndtri

from matstd.diagnosis.task.visits import Visits
from matstd.twin.frames import Array

_SHARES = (0.0, 0.1, 1.0)  # of a part beside the largest; four of them cover no better
_GRID = 100  # values of s_b for every R
_QUANTILES = 128  # values of s_p for every R'
_COMPONENTS = 400  # of the mixtures between them: 0.01 % of U
_MIN_VARIANCE_SHARE = 1e-12  # of a sum of variances: what is below counts as this
_NEGLIGIBLE_LOG_ODDS = 20.0
"""Logarithm of how much less probable than the most probable s_b: left out."""


@dataclass(frozen=True, eq=False)
class Expected:
    """The error of the next result: a mixture of normal distributions about zero."""

    probability: Array  # probability of every component, (M,)
    variance: Array  # variance of every component, (M,), mm^2

    def half_width(self, level: float) -> float:
        """Half the interval that holds a share of the results, mm."""
        sd = np.sqrt(self.variance)
        if not sd.any():
            return 0.0

        def short(x: float) -> float:
            return float(self.probability @ ndtr(-x / sd)) - 0.5 * (1.0 - level)

        low, high = ndtri(0.5 + 0.5 * level) * np.array([sd.min(), sd.max()])
        return float(high if short(high) >= 0.0 else brentq(short, low, high, rtol=1e-9))


def expected_error(visits: Visits, u_w: float = 0.0) -> Expected:
    """Distribution of a result's error beyond the mean of all places, as derived above.

    Args:
        u_w: Standard uncertainty of the workpieces, mm.
    """
    frame = _Frame.of(visits)
    of_visits, between = _of_visits(frame)
    of_machine = _of_machine(frame, between)
    known = float(np.sum(visits.shared.mean(axis=0) ** 2)) + u_w**2
    p = of_machine.probability[:, None] * of_visits.probability
    variance = known + of_machine.variance[:, None] + of_visits.variance
    return _averaged(p, variance)


def _averaged(p: Array, variance: Array) -> Expected:
    """A mixture of fewer components, each the mean of those of like variance."""
    p, variance = p.ravel(), variance.ravel()
    if variance.min() == variance.max():
        return Expected(np.ones(1), variance[:1])
    edges = np.geomspace(variance.min(), variance.max(), _COMPONENTS)
    at = np.searchsorted(edges, variance)
    weight, moment = np.bincount(at, p), np.bincount(at, p * variance)
    some = weight > 0.0
    return Expected(weight[some] / weight.sum(), moment[some] / weight[some])


@dataclass(frozen=True, eq=False)
class _Covariance:
    """Covariance of J places: r coordinates are separate, the others share one variance."""

    separate: Array  # (r, r)
    beside: float  # variance in every other direction

    @staticmethod
    def sum(weights: Array, of: "Sequence[_Covariance]") -> "_Covariance":
        """The weighted sum of several."""
        separate = np.tensordot(weights, np.stack([one.separate for one in of]), axes=1)
        return _Covariance(separate, float(weights @ [one.beside for one in of]))


@dataclass(frozen=True, eq=False)
class _Frame:
    """Visits in coordinates that separate features, poses and calibration.

    The first coordinate is that of what all places share, ``1 / sqrt(J)``.
    """

    places: int  # their number J
    others: int  # number of directions beside the r coordinates
    mean: Array  # mean of the visits, (r,)
    within: Array  # deviations of every visit from the mean, (n, r)
    mean_beside: float  # sum of squares of the mean in the other directions
    within_beside: float  # of all visits about it
    # what may add to its error: by region, by feature, by pose, by place, those that there are
    # several of
    of_machine: tuple[_Covariance, ...]
    # what may change: all places as one, by feature, by pose, by place
    of_visit: tuple[_Covariance, ...]
    of_calibration: _Covariance

    @staticmethod
    def of(visits: Visits) -> "_Frame":
        """The coordinates of some visits."""
        y, K = visits.deviation, visits.shared
        J = y.shape[1]
        labels = (visits.region, visits.face, visits.pose)
        groups = [np.unique(label, return_inverse=True)[1] for label in labels]
        some = [0 < g.max() < J - 1 for g in groups]  # others are "all" or "place"
        Z = [np.eye(g.max() + 1)[g] for g, there in zip(groups, some, strict=True) if there]
        columns = np.concatenate([*Z, K / max(float(np.abs(K).max(initial=0.0)), 1e-300)], axis=1)
        U, s, _ = np.linalg.svd(columns - columns.mean(axis=0), full_matrices=False)
        E = np.concatenate([np.full((J, 1), J**-0.5), U[:, s > 1e-9]], axis=1)
        r = E.shape[1]
        mean, within = y.mean(axis=0), y - y.mean(axis=0)
        of = [_Covariance(m @ m.T, 0.0) for m in (E.T @ z for z in (np.ones((J, 1)), *Z, K))]
        by_place = _Covariance(np.eye(r), 1.0)
        return _Frame(
            places=J,
            others=J - r,
            mean=mean @ E,
            within=within @ E,
            mean_beside=max(float(np.sum(mean**2) - np.sum((mean @ E) ** 2)), 0.0),
            within_beside=max(float(np.sum(within**2) - np.sum((within @ E) ** 2)), 0.0),
            of_machine=(*of[1:-1], by_place),
            of_visit=(of[0], *of[1 + some[0] : -1], by_place),
            of_calibration=of[-1],
        )


def _shares(parts: int) -> list[Array]:
    """Shares of the parts of a covariance, every combination once."""
    table = [w for w in itertools.product(_SHARES, repeat=parts) if max(w) == _SHARES[-1]]
    return [np.array(w) / sum(w) for w in table]


def _of_visits(frame: _Frame) -> tuple[Expected, _Covariance]:
    """What the next visit and the visits in b add, and the covariance of the mean of the visits."""
    n, J = len(frame.within), frame.places
    dof = (n - 1) * J
    parts = frame.of_visit
    size = float(np.sum(frame.within**2) + frame.within_beside)
    if size == 0.0:
        return _NOTHING, _Covariance(np.zeros_like(frame.of_calibration.separate), 0.0)
    scatter = frame.within.T @ frame.within
    evidence, squares, shapes = [], [], []
    for w in _shares(len(parts)):
        if w[-1] == 0.0:
            continue  # places err by themselves too
        R = _Covariance.sum(w, parts)
        square = np.trace(np.linalg.solve(R.separate, scatter)) + frame.within_beside / R.beside
        log_det = np.linalg.slogdet(R.separate)[1] + frame.others * np.log(R.beside)
        evidence.append(-0.5 * (n - 1) * log_det - 0.5 * dof * np.log(square / size))
        squares.append(square)
        shapes.append(R)
    p = np.exp(np.array(evidence) - max(evidence))
    p /= p.sum()
    quantiles = chdtri(dof, (np.arange(_QUANTILES) + 0.5) / _QUANTILES)  # of chi squared
    in_b = np.array([R.separate[0, 0] for R in shapes]) / (n * J)
    variance = (np.array(squares) * (1.0 + in_b))[:, None] / quantiles
    p_each = np.repeat(p[:, None] / _QUANTILES, _QUANTILES, axis=1)
    mean = _Covariance.sum(p * np.array(squares) / (dof * n), shapes)
    return _averaged(p_each, variance), mean


def _of_machine(frame: _Frame, of_visits: _Covariance) -> Expected:
    """What the machine's systematic error adds: how it varies over the task, and what b has of it.

    The contrasts of the places are brought to independent ones of variance ``1 + s_b^2 l``.
    """
    V = _Covariance.sum(np.ones(2), [frame.of_calibration, of_visits])
    square = float(np.sum(frame.mean[1:] ** 2) + frame.mean_beside)
    least = _MIN_VARIANCE_SHARE * (np.trace(V.separate) + V.beside + square)
    if frame.places < 2 or least == 0.0:
        return _NOTHING
    L = np.linalg.cholesky(V.separate[1:, 1:] + least * np.eye(len(V.separate) - 1))
    z = np.linalg.solve(L, frame.mean[1:])
    within = [np.linalg.solve(L, part.separate[1:, 1:]) for part in frame.of_machine]
    white = [np.linalg.solve(L, half.T) for half in within]
    beside, z2_beside = V.beside + least, frame.mean_beside / (V.beside + least)
    times = np.append(np.ones(len(z)), frame.others)
    log_p, variance = [], []
    for w in _shares(len(frame.of_machine)):
        lam, turn = np.linalg.eigh(np.tensordot(w, np.stack(white), axes=1))
        lam = np.append(np.maximum(lam, 0.0), w[-1] / beside)
        z2 = np.append((z @ turn) ** 2, z2_beside)
        s, log_p_each = _of_size(lam, z2, times)
        in_b = float(w @ [part.separate[0, 0] for part in frame.of_machine]) / frame.places
        log_p.append(log_p_each)
        variance.append(s**2 * (1.0 + in_b))
    p = np.exp(np.array(log_p) - np.max(log_p))
    return _averaged(p / p.sum(), np.array(variance))


def _of_size(lam: Array, z2: Array, times: Array) -> tuple[Array, Array]:
    """Values of s_b, and the logarithm of what each is worth, by prior and data.

    Args:
        lam: Contrasts have the variance ``1 + s_b^2 lam``.
        z2: Their squares; summed where there are several of one kind.
    """
    lam = np.where(lam < _MIN_VARIANCE_SHARE * lam.max(), 0.0, lam)
    has = (lam > 0.0) & (times > 0.0)
    ends = 1e-2 / np.sqrt(lam.max()), 1e3 * np.sqrt(np.max((1.0 + z2[has]) / lam[has]))
    for _ in range(2):  # the second time where something is
        s = np.geomspace(*ends, _GRID)
        each = 1.0 + s[:, None] ** 2 * lam
        log_p = -0.5 * np.log(each) @ times - 0.5 * (z2 / each).sum(axis=1)
        log_p += 0.5 * np.log((lam / each) ** 2 @ times / times[has].sum())  # the prior, with one s
        log_p += 2.0 * np.log(s) + np.log(np.log(s[1] / s[0]))
        some = np.flatnonzero(log_p > log_p.max() - _NEGLIGIBLE_LOG_ODDS)
        ends = s[max(some[0] - 1, 0)], s[min(some[-1] + 1, _GRID - 1)]
    return s, log_p


_NOTHING = Expected(np.ones(1), np.zeros(1))
