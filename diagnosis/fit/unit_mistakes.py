"""Deviations or uncertainties in another unit than their column says: a factor of a thousand."""

from dataclasses import dataclass

import numpy as np

from diagnosis.fit.gross import robust_scale
from diagnosis.fit.identification import Fit
from diagnosis.fit.linear import solve
from twin.units import UM

SMALL = 30.0
"""Times smaller than expected that deviations are suspect if they also fall short of the noise."""

TINY = 300.0
"""Times smaller that they are suspect by themselves: between the best machines and a thousand."""

LARGE = 10.0
"""Times larger than expected that no machine of the kind is."""

QUIET = 0.1
"""Scatter over stated uncertainty that no fit leaves, however good the machine."""

LOUD = 30.0
"""The same the other way round."""

FINEST, COARSEST = 0.02 * UM, 30.0 * UM
"""Standard uncertainties (mm) that touches on a machine tool stay between."""


@dataclass(frozen=True, slots=True)
class Sizes:
    """Typical sizes in a run once the standard has been placed best, mm.

    Attributes:
        measured: Of the deviations.
        expected: Of the deviations of such a machine before it was probed: what its model predicts,
            and the spread that the parameters have.
        stated: Of the standard uncertainty of a touch.
    """

    measured: float
    expected: float
    stated: float


def typical_sizes(fit: Fit) -> Sizes:
    """Sizes of what was measured and of what was to be expected, freed of the set-ups alike.

    Medians, so that chips do not count. Only rows in use.
    """
    rows, machine = fit.used, len(fit.model.parameters)
    X, u = fit.X[rows], fit.u[rows]
    Q = solve(X[:, machine:], np.zeros(len(X))).Q
    deviation = fit.run.deviation[rows] / u
    freed = np.column_stack([deviation, deviation - fit.y[rows], X[:, :machine]])
    freed -= Q @ (Q.T @ freed)
    variance = freed[:, 1] ** 2 + (freed[:, 2:] ** 2).sum(axis=1)
    return Sizes(
        robust_scale(freed[:, 0] * u),
        float(np.sqrt(np.median(variance * u**2))) / max(fit.widened, 1.0),
        float(np.median(fit.run.u[rows])),
    )


def mixed_units(fit: Fit) -> list[str]:
    """What looks like another unit, in words; empty for an honest run.

    Judged by two yardsticks, since either alone misleads: a very good machine has small deviations,
    and an uncertainty may be stated wrongly.

    Args:
        fit: Any fit.
    """
    s = typical_sizes(fit)
    if s.measured == 0.0:
        return []
    is_small, is_tiny = SMALL * s.measured < s.expected, TINY * s.measured < s.expected
    usual = f"{_shown(s.measured)}, a machine like this shows {_shown(s.expected)}"
    if s.measured > LARGE * np.hypot(s.expected, min(s.stated, COARSEST)):
        what = "deviations and uncertainties" if s.stated > COARSEST else "deviations"
        return [
            f"typical deviations are {usual}: the {what} look like nm in a column of µm, or "
            "set-up, probe or machine are others than stated"
        ]
    if is_small and s.measured < QUIET * s.stated:
        return [
            f"typical deviations are {usual}, and a touch is stated to be uncertain by "
            f"{_shown(s.stated)}: the deviations look like mm in a column of µm"
        ]
    if is_tiny and s.stated < FINEST:
        return [
            f"typical deviations are {usual}, and a touch is stated to be uncertain by "
            f"{_shown(s.stated)}: deviations and uncertainties look like mm in columns of µm"
        ]
    stated = f"a touch is stated to be uncertain by {_shown(s.stated)}"
    if s.measured < QUIET * s.stated:
        return [f"{stated}, but typical deviations are {usual}: u_um looks like nm"]
    if s.stated < FINEST and fit.noise.factor > LOUD:
        found = _shown(s.stated * fit.noise.factor)
        return [f"{stated}, but touches scatter by {found} about the model: u_um looks like mm"]
    return []


def _shown(size: float) -> str:
    """`12 µm`, two digits."""
    return f"{float(f'{size / UM:.2g}'):g} µm"
