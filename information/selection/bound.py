"""Proven bound on the criterion of every choice of touches, from any information.

Every touch may be made by a fraction, ``0 <= x_i <= 1``, ``sum x_i = n``, with the shares of poses
and features that the choice itself has to keep: a convex problem, whose optimum no whole choice can
beat. With the tangent ``sum_s trace(K_s M_s^-1)`` of a criterion (`DesignCriterion.tangents`),
which is nowhere above it, both

    phi = 1 / sum_s trace(K_s M_s^-1)       and for D       phi = prod_s det(M_s)^(w_s/R)

are concave and of degree one in the priors and the information together. So at *any* F0, near the
optimum or not,

    phi <= phi(F0) (sum_s trace(S_s prior_s) + most of sum x_i g_i) / sum_s trace(S_s M_s),

with ``g_i = sum_s w_i^T S_s w_i`` and ``S_s = M_s^-1 K_s M_s^-1`` (``w_s M_s^-1`` for D). That
holds for every criterion of `DesignCriterion`, the largest of several and means over the worst
machines included. The bound does not depend on the search that found F0.

Reference:
    Pukelsheim, Optimal Design of Experiments (1993), chapters 5 and 7 (information functions).
"""

from dataclasses import dataclass

import numpy as np

from matstd.information.criteria import DesignCriterion
from matstd.twin.frames import Array


@dataclass(frozen=True, eq=False)
class Slope:
    """Slope of a criterion at one information."""

    inverse: Array  # ``M_s^-1``, (S, R, R)
    S: Array  # forms of the gains ``w^T S_s w``, (S, R, R)
    constant: float  # ``sum_s trace(S_s prior_s)``
    value: float  # of the tangent: the criterion itself, or below it
    degree: float  # ``sum_s trace(S_s M_s)``

    def gains(self, W: Array) -> Array:
        """Gain of every candidate, (N,)."""
        total = self.S.sum(axis=0)
        return np.asarray(np.einsum("nr,nr->n", W @ total, W), dtype=np.float64)

    def bound(self, largest: float) -> float:
        """Bound for choices whose gains sum up to at most `largest`."""
        return self.value * self.degree / (self.constant + largest)


def slope(criterion: DesignCriterion, information: Array) -> Slope:
    """Slope of a criterion at an information (R, R)."""
    M = criterion.prior + information
    inverse = np.asarray(np.linalg.solve(M, np.broadcast_to(np.eye(M.shape[1]), M.shape)))
    tangents = criterion.tangents(information)
    S = np.stack([t.slope(i) for t, i in zip(tangents, inverse, strict=True)])
    raw = sum(t.value(m, i) for t, m, i in zip(tangents, M, inverse, strict=True))
    return Slope(
        inverse=inverse,
        S=S,
        constant=float(np.sum(S * criterion.prior)),
        value=criterion.measure.shown(raw),
        degree=sum(t.degree(i) for t, i in zip(tangents, inverse, strict=True)),
    )
