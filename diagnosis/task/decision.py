"""What an uncertainty leaves of a tolerance: the decision rule of ISO 14253-1."""

from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit

CONFORMITY = 0.95  # probability that a feature is what it is said to be: the default of the rule


@dataclass(frozen=True, slots=True)
class Guarded:
    """Limits of a deviation with their guard bands."""

    tolerance: float  # width of the zone, even about the nominal surface, mm
    guard: float  # width of the guard band at each limit, mm

    @property
    def accepted(self) -> float:
        """Deviations up to this prove conformity, mm; negative where none can."""
        return 0.5 * self.tolerance - self.guard

    @property
    def rejected(self) -> float:
        """Deviations beyond this prove nonconformity, mm."""
        return 0.5 * self.tolerance + self.guard

    @property
    def share(self) -> float:
        """Share of the tolerance in which conformity can be proved, from 0 to 1."""
        return max(2.0 * self.accepted / self.tolerance, 0.0)


def guarded(tolerance: float, u: float, dof: float, bias: float = 0.0) -> Guarded:
    """Guard bands for a tolerance zone.

    ``g = t(conformity, dof) u + |bias|``: one-sided, as a deviation near one limit cannot violate
    the other.

    Args:
        tolerance: Width of the zone, mm.
        u: Combined standard uncertainty of a measured deviation, mm.
        bias: Systematic error that results are not corrected for, mm.

    Reference:
        ISO 14253-1:2017, 5 (rules for proving conformity and nonconformity).
    """
    return Guarded(tolerance, float(stdtrit(dof, CONFORMITY)) * u + float(np.abs(bias)))
