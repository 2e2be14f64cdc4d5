"""Repeatability of the data themselves: what the same touch scatters by, whatever the model.

The stated noise is an opinion; repeated touches are its only witness. Three kinds, the strictest
first: replicates, made one after the other before the machine leaves the place; re-visits, which
return to a place later, and so include what an hour does; near neighbours, which any smooth error
moves alike, so that their differences bound the noise from above.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from matstd.diagnosis.fit import Fit
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.regression import f_tail, places_of
from matstd.twin.frames import Array, IntArray
from matstd.twin.numbers import rms
from matstd.twin.record import Touches

NEAR = 0.05  # distance of near neighbours, as a share of what was probed of every reading
MIN_PAIRS = 10  # pairs of neighbours from which their differences are a figure


@dataclass(frozen=True, slots=True)
class Scatter:
    """A standard deviation of single touches, mm, with its degrees of freedom."""

    size: float
    dof: int


@dataclass(frozen=True, slots=True)
class Repeatability:
    """Scatter of repeated touches beside the stated noise."""

    stated: float  # root mean square of the stated uncertainties, mm
    replicates: Scatter | None  # of one place, from one touch to the next while the machine stays
    # of one place and approach to which the machine returned: it includes what happened between
    revisits: Scatter | None
    neighbours: Scatter | None  # of near neighbours; an upper bound

    @property
    def known(self) -> Scatter | None:
        """What repeats show of the noise; None where there are too few."""
        both = (s for s in (self.revisits, self.replicates) if s is not None)
        return next((s for s in both if s.dof >= POLICY.repeat_dof), None)

    def lack_of_fit(self, scatter: float, dof: float) -> float:
        """Probability by chance that a residual scatters so much more than its repeats; 1 for none.

        ``F = (s^2 n - s_r^2 m)/(n - m) / s_r^2`` of n - m and m degrees of freedom (Fisher's test
        of the lack of fit).

        Args:
            scatter: Of the residual, mm.
            dof: Its degrees of freedom, n.

        Example:
            >>> both = Repeatability(1e-3, Scatter(1e-3, 20), None, None)
            >>> round(both.lack_of_fit(1e-3, 60.0), 2), both.lack_of_fit(3e-3, 60.0) < 1e-3
            (0.52, True)
        """
        known = self.known
        if known is None or known.size <= 0.0 or dof <= known.dof:
            return 1.0
        beyond = (scatter**2 * dof - known.size**2 * known.dof) / (dof - known.dof)
        return float(f_tail(max(beyond, 0.0) / known.size**2, dof - known.dof, known.dof))

    def excess(self, scatter: float) -> float:
        """What a residual has beyond the repeats, mm; 0 where these are unknown."""
        known = self.known
        return 0.0 if known is None else float(np.sqrt(max(scatter**2 - known.size**2, 0.0)))


def repeatability(fit: Fit) -> Repeatability:
    """Scatter of repeated touches about a fit, which removes the little that they differ in."""
    stated, noise = rms(fit.run.u), fit.noise
    z = fit.residual / fit.run.u
    replicates = None
    if noise.replicates is not None:
        replicates = Scatter(stated * noise.replicates, noise.replicates_dof)
    return Repeatability(
        stated=stated,
        replicates=replicates,
        revisits=_revisits(fit, z, stated),
        neighbours=_neighbours(fit.run.touches, z, np.flatnonzero(fit.used), stated),
    )


def _revisits(fit: Fit, z: Array, stated: float) -> Scatter | None:
    """Scatter of the first touches of all visits to one place."""
    place, visit = places_of(fit.run, fit.used)
    rows = np.flatnonzero(fit.used)
    first = np.unique(np.column_stack([place, visit])[rows], axis=0, return_index=True)[1]
    group, values = place[rows[first]], z[rows[first]]
    count = np.bincount(group)
    mean = np.bincount(group, values) / np.maximum(count, 1)
    dof = int((count[count > 1] - 1).sum())
    squares = float(((values - mean[group]) ** 2).sum())
    return Scatter(stated * float(np.sqrt(squares / dof)), dof) if dof else None


def _neighbours(touches: Touches, z: Array, rows: IntArray, stated: float) -> Scatter | None:
    """Scatter from differences of near neighbours, ``mean d^2 / 2``."""
    place = np.column_stack([touches.q, touches.point])[rows]
    extent = np.ptp(place, axis=0)
    place = place[:, extent > 0.0] / extent[extent > 0.0]
    key = np.column_stack([touches.normal, touches.approach])[rows]
    # touches of another set-up, direction or approach are no neighbours
    group = np.column_stack([touches.setup[rows], np.round(key, 1)]) * len(rows)
    distance, index = cKDTree(np.hstack([place, group])).query(np.hstack([place, group]), k=2)
    own = np.arange(len(rows))
    other = np.where(index[:, 1] == own, index[:, 0], index[:, 1])
    near = (distance[:, 1] > 0.0) & (distance[:, 1] < NEAR)  # at no distance it is a repeat
    pairs = np.unique(np.sort(np.column_stack([own, other]), axis=1)[near], axis=0)
    if len(pairs) < MIN_PAIRS:
        return None
    d = z[rows[pairs[:, 0]]] - z[rows[pairs[:, 1]]]
    return Scatter(stated * float(np.sqrt(0.5 * np.mean(d**2))), len(pairs))
