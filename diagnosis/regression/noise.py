"""How large the noise really is, against what the run file states."""

from dataclasses import dataclass

import numpy as np

from matstd.diagnosis.policy import POLICY
from matstd.twin.frames import Array, IntArray, Mask
from matstd.twin.record import Instrument, Run

PRIOR_DOF = 4.0
"""Weight of the stated uncertainty, in degrees of freedom: it decides where touches are few."""

REPLICATE_PLACE = 0.05
"""Touches whose calibrated points lie within this (mm) in one pose are replicates."""

SAME_SHARE = 1e-3  # ... and within this share of what was probed, on which an axis may be 1 mm long

SAME_READING = 1e-6
"""The same of readings that an encoder took on the way (mm, rad): no two are one place."""

SAME_SIDE = 0.02  # their normals agree within this


@dataclass(frozen=True, slots=True)
class Noise:
    """Noise of a fit in units of the stated uncertainty."""

    factor: float  # standard deviation of the noise over the stated one
    dof: float
    chi2_ratio: float  # weighted squared residual per degree of freedom, stated uncertainty
    # the factor from replicates alone, or None where there are none
    replicates: float | None = None
    replicates_dof: int = 0

    @property
    def is_wrongly_stated(self) -> bool:
        """Whether the noise differs from the stated one by more than chance."""
        spread = (0.5 / max(self.dof, 1.0)) ** 0.5
        return abs(self.factor - 1.0) > max(POLICY.noise_misstated * spread * self.factor, 0.05)


def noise_factor(chi2: float, dof: float) -> float:
    """Noise over stated noise from a residual, with the statement as `PRIOR_DOF` observations."""
    return float(np.sqrt((chi2 + PRIOR_DOF) / (max(dof, 0.0) + PRIOR_DOF)))


def replicate_groups(run: Run, rows: Mask, in_any_pose: bool = False) -> IntArray:
    """Number of the group of replicates of every row, (N,): same place, pose and last motions.

    Rows outside `rows` get -1.

    Args:
        in_any_pose: Whether a place that was returned to in another pose, or cycle, is the same.
    """
    t = run.touches
    extent = float(np.ptp(t.point, axis=0).max(initial=0.0))
    place = min(REPLICATE_PLACE, SAME_SHARE * extent) if extent > 0.0 else REPLICATE_PLACE
    place = SAME_READING if t.instrument is Instrument.ENCODER else place
    cells = np.round(t.point / place).astype(np.int64)
    sides = np.round(t.normal / SAME_SIDE).astype(np.int64)
    readings = np.round(t.q / place).astype(np.int64)
    pose = np.zeros_like(t.pose) if in_any_pose else t.pose
    key = np.column_stack([cells, sides, readings, t.setup, pose, t.approach.astype(np.int64)])
    group = np.full(len(run), -1)
    group[rows] = np.unique(key[rows], axis=0, return_inverse=True)[1].reshape(-1)
    return group


def replicate_factor(run: Run, z: Array, rows: Mask) -> tuple[float | None, int]:
    """Noise over stated noise from replicates alone, with its degrees of freedom.

    Args:
        z: Residuals over the stated uncertainty, (N,); the model removes the little that replicates
            differ in.
        rows: Rows to use, (N,).
    """
    group = replicate_groups(run, rows)[rows]
    count = np.bincount(group)
    mean = np.bincount(group, z[rows]) / np.maximum(count, 1)
    squares = float(((z[rows] - mean[group]) ** 2).sum())
    dof = int((count[count > 1] - 1).sum())
    return (float(np.sqrt(squares / dof)), dof) if dof > 0 else (None, 0)
