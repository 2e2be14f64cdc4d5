"""Uncertainty of a measuring task from repeated measurements of calibrated features.

A user measures the deviation of a surface point from its nominal place. At J places of calibrated
features that are like his task, n visits found y_ij where the calibration says 0. So

    b       mean of all y_ij: the systematic error of the task; results are corrected for it
    U       half the interval that holds `LEVEL` of what the next result, corrected by b, is
            expected to err (`diagnosis/task/predictive.py`); `U + |b|` where it is not corrected
    u, dof  of Student's distribution that has U, and the same interval for 90 %: U = k u
    u_cal   of b: what the places' calibrations share once the standard is placed
    u_p     standard deviation of one visit about the mean of a place, all places together
    u_w     of the workpieces: form, roughness, expansion
    u_b     what is left: u^2 = u_cal^2 + u_p^2 + u_b^2 + u_w^2. How the machine's own systematic
            error varies over the task, and what else makes b uncertain for another part of it

The calibration of single features is taken off what the places' means differ by, and not added a
second time.

Reference:
    ISO 15530-3:2011, 7 (the sum with u_b, b corrected); ISO/TS 15530-3:2004 (the sum with |b|).
    JCGM 101:2008, 7.7 (interval of a distribution); JCGM 100:2008, G.3 (Student's factor).
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import brentq
from scipy.special import stdtrit

from matstd.diagnosis.task.predictive import expected_error
from matstd.diagnosis.task.visits import Visits
from matstd.twin.numbers import rms, rms_length

LEVEL = 0.95
"""Share of results that U is to cover."""

_GUARD = 0.9  # the other interval that Student's distribution keeps: 95 % on one side of a limit
_MOST, _LEAST = 1e4, 0.5  # degrees of freedom: as good as infinite, and fewer than any data leave


@dataclass(frozen=True, eq=False)
class TaskUncertainty:
    """The budget of a task."""

    visits: int
    places: int
    faces: int  # number of features that the places are on
    poses: int
    bias: float  # b, mm
    u_cal: float  # standard uncertainty of b by the calibration, mm
    u_p: float  # standard uncertainty of one visit, mm
    spread: float  # root mean square of the places' means about b, mm
    expected: float  # what calibration lets expect of it, mm
    u_w: float  # standard uncertainty by the workpieces, mm
    u: float  # combined standard uncertainty of a result that is corrected for b, mm
    dof: float
    # name of every feature, mean of its places and their spread about it, mm
    by_face: tuple[tuple[str, float, float], ...]

    @property
    def u_b(self) -> float:
        """Standard uncertainty of b over the task, mm."""
        rest = self.u**2 - self.u_cal**2 - self.u_p**2 - self.u_w**2
        return float(np.sqrt(max(rest, 0.0)))

    @cached_property
    def k(self) -> float:
        """Coverage factor."""
        return float(stdtrit(self.dof, 0.5 + 0.5 * LEVEL))

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
        u_w: Standard uncertainty of the workpieces, mm.
    """
    y, K = visits.deviation, visits.shared
    n, J = y.shape
    mean = y.mean(axis=0)
    bias = float(mean.mean())
    common = K.mean(axis=0)
    faces, poses = np.unique(visits.face), np.unique(visits.pose)
    u_cal = float(np.linalg.norm(common))
    u_p = float(np.sqrt(np.sum((y - mean) ** 2) / (J * (n - 1))))
    error = expected_error(visits, u_w)
    # the last argument is the scale where no Student distribution has both intervals
    u, dof = _as_student(
        error.half_width(LEVEL),
        error.half_width(_GUARD),
        float(np.hypot(np.hypot(u_cal, u_p), u_w)),
    )
    return TaskUncertainty(
        visits=n,
        places=J,
        faces=len(faces),
        poses=len(poses),
        bias=bias,
        u_cal=u_cal,
        u_p=u_p,
        spread=rms(mean - bias),
        expected=rms_length(K - common),
        u_w=u_w,
        u=u,
        dof=dof,
        by_face=tuple(
            (str(f), float(mean[visits.face == f].mean()), float(mean[visits.face == f].std()))
            for f in faces
        ),
    )


def _as_student(U: float, narrower: float, least: float) -> tuple[float, float]:
    """Scale and degrees of freedom of Student's distribution with two intervals.

    Args:
        U: Half the interval of `LEVEL`.
        narrower: Half that of `_GUARD`.
        least: Of the scale, where the intervals are those of no such distribution: U is kept.
    """
    if U == 0.0:
        return 0.0, _MOST

    def factor(dof: float, level: float = LEVEL) -> float:
        return float(stdtrit(dof, 0.5 + 0.5 * level))

    dof = _where(lambda x: factor(x) / factor(x, _GUARD), U / narrower)
    u = max(U / factor(dof), least)
    dof = _where(factor, U / u)
    return U / factor(dof), dof


def _where(falling: Callable[[float], float], value: float) -> float:
    """Degrees of freedom at which something that falls with them has a value."""
    if falling(_MOST) >= value:
        return _MOST
    if falling(_LEAST) <= value:
        return _LEAST
    return float(brentq(lambda x: falling(x) - value, _LEAST, _MOST, xtol=1e-6))
