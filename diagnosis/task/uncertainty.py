"""Uncertainty of a measuring task from repeated measurements of calibrated features.

A user measures the deviation of a surface point from its nominal place. At J places of calibrated
features that are like his task, n visits found y_ij where the calibration says 0. So

    b       mean of all y_ij: the systematic error of the task; results are corrected for it
    u_p     standard deviation of one visit about the mean of a place, all places together
    s^2     mean square of the places' means about b: what is systematic, and differs by place
    u_cal   of b: what the places' calibrations share once the standard is placed
    u_b^2   s^2 - what calibration lets expect of it - u_p^2 / n: how the machine's own systematic
            error varies over the task
    u_w     of the workpieces: form, roughness, expansion
    U       k sqrt(u_cal^2 + u_p^2 + u_b^2 + u_w^2)

and ``U + |b|`` where results are not corrected. The calibration of single features is within s; it
is taken off there and not added a second time. k is Student's factor for `LEVEL` with the degrees
of freedom after Welch and Satterthwaite; those of s^2 come from how much the squares differ between
features and between table poses, as places of one feature or pose are not independent.

Reference:
    ISO 15530-3:2011, 7 (the sum with u_b, b corrected); ISO/TS 15530-3:2004 (the sum with |b|).
    JCGM 100:2008, G.4 (effective degrees of freedom).
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from diagnosis.task.visits import Visits
from twin.frames import Array

LEVEL = 0.95
"""Share of results that U is to cover."""

_MOST = 1e4  # degrees of freedom that are as good as infinite


@dataclass(frozen=True, eq=False)
class TaskUncertainty:
    """The budget of a task.

    Attributes:
        visits: Their number n.
        places: Their number J.
        faces: Number of features that the places are on.
        poses: Number of table poses.
        bias: b, mm.
        u_cal: Of b by the calibration, mm.
        u_p: Of one visit, mm.
        dof_p: Its degrees of freedom.
        spread: s, mm.
        dof_s: Its degrees of freedom.
        expected: Root of the part of s^2 that calibration lets expect, mm.
        u_w: Of the workpieces, mm.
        by_face: Of every feature its name, the mean of its places and their spread about it, mm.
    """

    visits: int
    places: int
    faces: int
    poses: int
    bias: float
    u_cal: float
    u_p: float
    dof_p: float
    spread: float
    dof_s: float
    expected: float
    u_w: float
    by_face: tuple[tuple[str, float, float], ...]

    @property
    def u_b(self) -> float:
        """How the machine's systematic error varies over the task, mm."""
        own = self.spread**2 - self.expected**2 - self.u_p**2 / self.visits
        return float(np.sqrt(max(own, 0.0)))

    @property
    def u(self) -> float:
        """Combined standard uncertainty of a result that is corrected for b, mm."""
        return float(np.linalg.norm([self.u_cal, self.u_p, self.u_b, self.u_w]))

    @property
    def dof(self) -> float:
        """Degrees of freedom of `u`; what is taken off s^2 makes it no surer than s^2 is."""
        by_place = 1.0 - 1.0 / self.visits
        of = (self.u_p**2 * by_place) ** 2 / self.dof_p + self.spread**4 / self.dof_s
        return float(min(self.u**4 / of, _MOST)) if of > 0.0 else _MOST

    @cached_property
    def k(self) -> float:
        """Coverage factor."""
        from scipy.stats import t

        return float(t.ppf(0.5 + 0.5 * LEVEL, self.dof))

    @property
    def U(self) -> float:
        """Expanded uncertainty of a result that is corrected for b, mm."""
        return self.k * self.u

    @property
    def U_uncorrected(self) -> float:
        """Expanded uncertainty of a result that is not, mm."""
        return self.U + abs(self.bias)


def task_uncertainty(visits: Visits, u_w: float = 0.0) -> TaskUncertainty:
    """The budget of a task from visits to its places.

    Args:
        visits: At least two.
        u_w: Standard uncertainty of the workpieces, mm.
    """
    y, K = visits.deviation, visits.shared
    n, J = y.shape
    mean = y.mean(axis=0)
    bias = float(mean.mean())
    within = y - mean
    common = K.mean(axis=0)
    faces, poses = np.unique(visits.face), np.unique(visits.pose)
    off = mean - bias
    dof_s = min(_dof_by_group(off**2, visits.face), _dof_by_group(off**2, visits.pose))
    return TaskUncertainty(
        visits=n,
        places=J,
        faces=len(faces),
        poses=len(poses),
        bias=bias,
        u_cal=float(np.linalg.norm(common)),
        u_p=float(np.sqrt(np.sum(within**2) / (J * (n - 1)))),
        dof_p=_dof_of_visits(within),
        spread=float(np.sqrt(np.mean(off**2))),
        dof_s=dof_s,
        expected=float(np.sqrt(np.mean(np.sum((K - common) ** 2, axis=1)))),
        u_w=u_w,
        by_face=tuple(
            (str(f), float(mean[visits.face == f].mean()), float(mean[visits.face == f].std()))
            for f in faces
        ),
    )


def _dof_of_visits(within: Array) -> float:
    """Degrees of freedom of a variance over places (n, J) that may err together in a visit.

    ``(n - 1) tr(C)^2 / tr(C^2)`` with C the covariance of the places: J (n - 1) where they are
    independent, n - 1 where they move as one. tr(C^2) is freed of what chance adds to it.
    """
    n, J = within.shape
    gram = within @ within.T / (n - 1)
    trace = float(np.trace(gram))
    if n < 3 or trace <= 0.0:
        return float(n - 1)
    of_square = float(np.sum(gram**2)) - trace**2 / (n - 1)
    of_square *= (n - 1) ** 2 / ((n - 2) * (n + 1))
    independent = trace**2 / J
    return float((n - 1) * trace**2 / np.clip(of_square, independent, trace**2))


def _dof_by_group(squares: Array, group: np.ndarray) -> float:
    """Degrees of freedom of a mean square whose terms hang together within groups.

    ``2 m^2 / Var(m)``, the variance from how much the sums of the groups differ, and never more
    than the groups: few of them may agree by chance.
    """
    _, index = np.unique(group, return_inverse=True)
    count = np.bincount(index)
    G = len(count)
    if G < 2 or not squares.sum():
        return 1.0
    off = np.bincount(index, weights=squares) - squares.mean() * count
    variance = float(np.sum(off**2)) * G / (G - 1) / squares.sum() ** 2
    return float(min(2.0 / max(variance, 1e-12), G))
