"""Deviations or uncertainties in another unit than their column says: a factor of a thousand."""

from dataclasses import dataclass
from enum import Enum

import numpy as np

from matstd.diagnosis.fit.identification import Fit
from matstd.diagnosis.regression import robust_scale, solve
from matstd.twin.units import UM

MIN_SMALL_RATIO = 30.0
"""Times smaller than expected that deviations are suspect if they also fall short of the noise."""

MIN_TINY_RATIO = 300.0
"""Times smaller that they are suspect by themselves: between the best machines and a thousand."""

MIN_LARGE_RATIO = 10.0  # times larger than expected that no machine of the kind is

MIN_SCATTER_RATIO = 0.1
"""Scatter over stated uncertainty that no fit leaves, however good the machine."""

MAX_SCATTER_RATIO = 30.0  # the same in the other direction

FINEST, COARSEST = 0.02 * UM, 30.0 * UM
"""Standard uncertainties (mm) that touches on a machine tool stay between."""


class MistakenUnit(Enum):
    """What looks like another unit than µm."""

    DEVIATIONS_IN_NM = "deviations in nm"
    BOTH_IN_NM = "deviations and uncertainties in nm"
    DEVIATIONS_IN_MM = "deviations in mm"
    BOTH_IN_MM = "deviations and uncertainties in mm"
    UNCERTAINTIES_IN_NM = "uncertainties in nm"
    UNCERTAINTIES_IN_MM = "uncertainties in mm"


@dataclass(frozen=True, slots=True)
class UnitMistake:
    """What looks like another unit, with typical sizes once the standard is placed best, mm."""

    what: MistakenUnit  # which column, and which unit it looks like
    measured: float
    # size of the deviations before the machine is probed: what its model predicts, and the spread
    # that the parameters have
    expected: float
    stated: float  # standard uncertainty of a touch as stated
    scatter: float


def unit_mistake(fit: Fit) -> UnitMistake | None:
    """What looks like another unit than the column says; None for an honest run.

    Judged by two yardsticks, since either alone misleads: a very good machine has small deviations,
    and an uncertainty may be stated wrongly. A model without a machine in it expects nothing.
    """
    if not fit.model.effects or fit.run.touches.instrument.reads_angle:
        return None  # a cheap encoder is off by degrees, a good one by a part of a second
    if int(fit.used.sum()) < 2 * (fit.X.shape[1] - len(fit.model.parameters)):
        return None  # what so few touches leave of the set-ups is small in any unit
    measured, expected, stated = _typical_sizes(fit)
    what = _mistaken(fit, measured, expected, stated)
    if what is None:
        return None
    return UnitMistake(
        what=what,
        measured=measured,
        expected=expected,
        stated=stated,
        scatter=stated * fit.noise.factor,
    )


def _mistaken(fit: Fit, measured: float, expected: float, stated: float) -> MistakenUnit | None:
    """Which unit is mistaken, by typical sizes in mm."""
    has_ball = fit.run.touches.instrument.is_ball_on_standard
    if measured == 0.0:
        return None
    # where no axis moves, what is expected of the machine is no yardstick
    is_expected = expected > FINEST
    if is_expected and measured > MIN_LARGE_RATIO * np.hypot(expected, min(stated, COARSEST)):
        both = stated > COARSEST
        return MistakenUnit.BOTH_IN_NM if both else MistakenUnit.DEVIATIONS_IN_NM
    if MIN_SMALL_RATIO * measured < expected and measured < MIN_SCATTER_RATIO * stated:
        return MistakenUnit.DEVIATIONS_IN_MM
    # encoders and interferometers resolve so little, and what they measure may be as good
    if MIN_TINY_RATIO * measured < expected and stated < FINEST and has_ball:
        return MistakenUnit.BOTH_IN_MM
    if measured < MIN_SCATTER_RATIO * stated:
        return MistakenUnit.UNCERTAINTIES_IN_NM
    if stated < FINEST and fit.noise.factor > MAX_SCATTER_RATIO:
        return MistakenUnit.UNCERTAINTIES_IN_MM
    return None


def _typical_sizes(fit: Fit) -> tuple[float, float, float]:
    """What was measured, what was to be expected, and the uncertainty that is stated, mm.

    The first two are freed of the set-ups alike. Medians, so that chips do not count; only rows in
    use.
    """
    rows, machine = fit.used, len(fit.model.parameters)
    X, u = fit.X[rows], fit.u[rows]
    Q = solve(X[:, machine:], np.zeros(len(X))).Q
    deviation = fit.run.deviation[rows] / u
    freed = np.column_stack([deviation, deviation - fit.y[rows], X[:, :machine]])
    freed -= Q @ (Q.T @ freed)
    variance = freed[:, 1] ** 2 + (freed[:, 2:] ** 2).sum(axis=1)
    return (
        robust_scale(freed[:, 0] * u),
        float(np.sqrt(np.median(variance * u**2))) / max(fit.widened, 1.0),
        float(np.median(fit.run.u[rows])),
    )
