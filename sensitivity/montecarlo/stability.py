"""Number of random machines by the adaptive procedure of JCGM 101:2008, 7.9.

Batches of equal size are drawn; every statistic is an average over batches, and its standard
deviation says how far it may still move. Drawing ends as soon as twice that standard deviation
is below the numerical tolerance of the standard uncertainty, for every statistic at every pose.
"""

from dataclasses import dataclass

import numpy as np

from matstd.twin.errors import DesignError
from matstd.twin.frames import Array


def numerical_tolerance(u: Array, digits: int) -> Array:
    """Half a unit of the last significant digit of standard uncertainties, shape of u.

    With ``u = c 10^l``, c a whole number of as many digits: ``delta = 10^l / 2``.

    Args:
        u: Standard uncertainties, zero or positive; zero gives infinity: nothing has to be stable.
        digits: Significant digits, one or two as a rule.

    Reference:
        JCGM 101:2008, 7.9.2.

    Example:
        >>> numerical_tolerance(np.array([0.00035, 2.0, 10.1]), 2)
        array([5.e-06, 5.e-02, 5.e-01])
    """
    safe = np.where(u > 0.0, u, 1.0)
    last = np.floor(np.log10(safe)) - (digits - 1)
    rounded = np.round(safe / 10.0**last)  # 9.96 is 10 to two digits
    last = np.where(rounded >= 10.0**digits, last + 1.0, last)
    return np.where(u > 0.0, 0.5 * 10.0**last, np.inf)


@dataclass(frozen=True)
class Stability:
    """Result of the adaptive procedure."""

    digits: int  # significant digits of the standard deviation that were asked for
    batches: int  # batches drawn
    # largest of twice the standard deviation of any statistic over its tolerance, at any pose; at
    # most one when everything is stable
    ratio: float

    @property
    def is_stable(self) -> bool:
        """Whether every statistic is stable at every pose."""
        return self.batches > 1 and self.ratio <= 1.0


class Stabiliser:
    """Averages of statistics over batches, and whether they have settled."""

    def __init__(self, digits: int) -> None:
        if not 1 <= digits <= 6:
            raise DesignError(f"{digits} significant digits asked for; expected 1 to 6")
        self.digits, self.batches = digits, 0
        self._mean: Array = np.zeros(0)
        self._spread: Array = np.zeros(0)  # sum of squared differences from the mean

    def add(self, statistics: Array) -> None:
        """Add the statistics of one batch, (Q, N) (Welford's update)."""
        if not self.batches:
            self._mean, self._spread = np.zeros_like(statistics), np.zeros_like(statistics)
        self.batches += 1
        off = statistics - self._mean
        self._mean += off / self.batches
        self._spread += off * (statistics - self._mean)

    def stability(self, u: Array) -> Stability:
        """State after the batches so far, for the standard deviation of |d| over all, (N,), mm."""
        if self.batches < 2:
            return Stability(self.digits, self.batches, np.inf)
        h = self.batches
        s = np.sqrt(self._spread / (h * (h - 1)))
        ratio = 2.0 * s / numerical_tolerance(u, self.digits)
        return Stability(self.digits, h, float(ratio.max()))
