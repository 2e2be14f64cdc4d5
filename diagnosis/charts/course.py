"""The course of one quantity over several occasions: constant, in steps, or drifting.

Values ``x_i`` with standard deviations ``s_i`` are described by the course with the least
``sum ((x_i - course_i) / s_i)^2 + penalty``. A constant has no penalty. Every step has the square
of the standardised difference that chance exceeds in a share `ALPHA` of whole histories, over all
places where a step may be and all quantities (Bonferroni); a drift has the same over all
quantities. The least sum over all places of steps follows from optimal partitioning.

Reference:
    Jackson et al., IEEE Signal Process. Lett. 12 (2005) 105 (optimal partitioning).
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import erfc, erfcinv

from matstd.diagnosis.geometry import Estimate
from matstd.twin.frames import Array

ALPHA = 0.01
"""Share of histories of an unchanged machine in which chance may report a change."""


@dataclass(frozen=True, slots=True)
class Step:
    """A value that changed between two occasions."""

    after: int  # occasion, by number, from which on the new value holds
    size: Estimate  # new less old value
    date: float  # when it changed, of all intervals by their likelihood, days
    u_date: float  # its standard uncertainty: a date within an interval is as likely as any other
    p_value: float  # of a step of this size by chance, over all places and quantities


@dataclass(frozen=True, slots=True)
class Drift:
    """A value that changes steadily."""

    rate: Estimate  # change a day
    p_value: float  # of such a rate by chance, over all quantities


@dataclass(frozen=True, slots=True)
class Course:
    """How a quantity went: steps, or a drift, or neither."""

    steps: tuple[Step, ...] = ()
    drift: Drift | None = None


def course_of(days: Array, x: Array, s: Array, quantities: int) -> Course:
    """The simplest course that chance does not account for.

    Args:
        days: Of the occasions, rising, (n,).
        x: Values, (n,).
        s: Their standard deviations from one occasion to another, (n,).
        quantities: Number of quantities that are looked at.
    """
    tests = (len(x) - 1) * quantities
    a_step, a_drift = critical(tests) ** 2, critical(quantities) ** 2
    places, in_steps = _partition(x, s, a_step)
    rate = _rate(days, x, s)
    z = rate.value / rate.u
    drifting = _spread(x, s) - z**2 + a_drift
    if drifting < min(in_steps, _spread(x, s)):
        return Course(drift=Drift(rate, corrected(z, quantities)))
    bounds = [0, *places, len(x)]
    steps = (
        _step(days, x, s, (low, k, high), tests)
        for low, k, high in zip(bounds, bounds[1:], bounds[2:], strict=False)
    )
    return Course(tuple(steps))


def critical(tests: int) -> float:
    """Standardised difference that chance exceeds once in `ALPHA` of so many tests."""
    return float(np.sqrt(2.0) * erfcinv(ALPHA / tests))


def corrected(z: float, tests: int) -> float:
    """Probability that one of so many standardised differences is as large by chance."""
    return float(min(1.0, tests * erfc(abs(z) / np.sqrt(2.0))))


def mean_of(x: Array, s: Array) -> Estimate:
    """Weighted mean with its standard uncertainty."""
    w = 1.0 / s**2
    return Estimate(float(w @ x / w.sum()), float(1.0 / np.sqrt(w.sum())))


def _spread(x: Array, s: Array) -> float:
    """Weighted squares about the mean."""
    return float(np.sum(((x - mean_of(x, s).value) / s) ** 2))


def _rate(days: Array, x: Array, s: Array) -> Estimate:
    """Weighted slope over time."""
    t = days - mean_of(days, s).value
    w = 1.0 / s**2
    weight = float(w @ t**2)
    return Estimate(float((w * t) @ x / weight), float(1.0 / np.sqrt(weight)))


def _partition(x: Array, s: Array, penalty: float) -> tuple[list[int], float]:
    """First occasions behind every step, and the least penalised sum of squares."""
    best, last = [-penalty], [0]
    for end in range(1, len(x) + 1):
        cost = [best[k] + _spread(x[k:end], s[k:end]) + penalty for k in range(end)]
        last.append(int(np.argmin(cost)))
        best.append(cost[last[-1]])
    places, end = list[int](), last[-1]
    while end:
        places.append(end)
        end = last[end]
    return places[::-1], best[-1]


def _step(days: Array, x: Array, s: Array, place: tuple[int, int, int], tests: int) -> Step:
    """A step between two parts of the course, ``[low, k)`` and ``[k, high)``."""
    low, k, high = place
    before, now = mean_of(x[low:k], s[low:k]), mean_of(x[k:high], s[k:high])
    size = Estimate(now.value - before.value, float(np.hypot(before.u, now.u)))
    cuts = np.arange(low + 1, high)
    squares = [_spread(x[low:m], s[low:m]) + _spread(x[m:high], s[m:high]) for m in cuts]
    share = np.exp(-0.5 * (np.array(squares) - min(squares)))
    share /= share.sum()
    middle, length = 0.5 * (days[cuts] + days[cuts - 1]), days[cuts] - days[cuts - 1]
    date = float(share @ middle)
    u_date = float(np.sqrt(share @ ((middle - date) ** 2 + length**2 / 12.0)))
    p_value = corrected(size.value / size.u, tests)
    return Step(after=k, size=size, date=date, u_date=u_date, p_value=p_value)
