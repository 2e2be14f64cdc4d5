"""How large the noise really is, against what the run file states."""

from dataclasses import dataclass

import numpy as np

from matstd.diagnosis.policy import POLICY
from matstd.twin.frames import Array, IntArray, Mask
from matstd.twin.record import Instrument, Run

PRIOR_DOF = 4.0
"""Weight of the stated uncertainty, in degrees of freedom: it decides where touches are few."""

REPLICATE_PLACE = 0.05
"""Touches whose calibrated points lie within this (mm) are of one place."""

SAME_SHARE = 1e-3  # ... and within this share of what was probed, on which an axis may be 1 mm long

SAME_READING = 1e-6
"""The same of readings that an encoder took on the way (mm, rad): no two are one place."""

SAME_SIDE = 0.02  # their normals agree within this

PAUSE = 3.0
"""Time between touches of one place, over its median, after which the next is no replicate."""


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


def places_of(run: Run, rows: Mask) -> tuple[IntArray, IntArray]:
    """Number of the place of every row, and of the visit of the machine to it, (N,) each.

    A place has one point, normal, set-up, readings and last motions. A visit is what the machine
    probes without leaving its readings, pose or last motions, in the order of time, else of rows.
    Rows outside `rows` get -1.
    """
    t = run.touches
    extent = float(np.ptp(t.point, axis=0).max(initial=0.0))
    place = min(REPLICATE_PLACE, SAME_SHARE * extent) if extent > 0.0 else REPLICATE_PLACE
    place = SAME_READING if t.instrument is Instrument.ENCODER else place
    cells = np.round(t.point / place).astype(np.int64)
    sides = np.round(t.normal / SAME_SIDE).astype(np.int64)
    readings = np.round(t.q / place).astype(np.int64)
    stand = np.column_stack([readings, t.setup, t.approach.astype(np.int64)])
    number, visit = np.full(len(run), -1), np.full(len(run), -1)
    key = np.column_stack([cells, sides, stand])[rows]
    number[rows] = np.unique(key, axis=0, return_inverse=True)[1].reshape(-1)
    order = _in_order(run, rows)
    here = np.column_stack([stand, t.pose])[order]
    left = (here[1:] != here[:-1]).any(axis=1)
    visit[order] = np.concatenate([[0], np.cumsum(left)])[: len(order)]
    return number, visit


def _in_order(run: Run, rows: Mask) -> IntArray:
    """Rows in use in the order of time, of equal times as they stand."""
    return np.flatnonzero(rows)[np.argsort(run.touches.time[rows], kind="stable")]


def replicate_factor(run: Run, z: Array, rows: Mask) -> tuple[float | None, int]:
    """Noise over stated noise from replicates alone, with its degrees of freedom.

    ``s^2 = mean d^2 / 2`` of the differences d of successive touches of one place in one visit, so
    that a drift of the machine enters only by what it does from one touch to the next. Touches that
    follow after a pause (`PAUSE`) are not compared. M differences in chains of m have
    ``2 M^2 / sum(3 m - 1)`` degrees of freedom.

    Args:
        z: Residuals over the stated uncertainty, free of the memory of the noise, (N,); the model
            removes the little that replicates differ in.
        rows: Rows to use, (N,).

    Reference:
        von Neumann, Kent, Bellinson and Hart, The mean square successive difference, Annals of
        Mathematical Statistics 12 (1941) 153-162.
    """
    place, visit = places_of(run, rows)
    order = _in_order(run, rows)
    order = order[np.lexsort((place[order], visit[order]))]
    before, after = order[:-1], order[1:]
    same = (place[before] == place[after]) & (visit[before] == visit[after])
    gap = run.touches.time[after] - run.touches.time[before]
    if same.any():
        same &= gap <= PAUSE * float(np.median(gap[same]))
    count = int(same.sum())
    if count == 0:
        return None, 0
    d = (z[after] - z[before])[same]
    # a chain ends where the next pair is none
    chains = int((same & ~np.append(same[1:], False)).sum())
    dof = int(2 * count**2 / (3 * count - chains))
    return float(np.sqrt(0.5 * np.mean(d**2))), dof
