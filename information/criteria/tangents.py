"""The two tangents that every criterion has, and how they change as touches come and go.

A tangent is the criterion of one machine seen from one information: ``trace(K M^-1)``, or the
negative logarithm of ``det M``, both times the weight of the machine. Searches know nothing else of
a criterion. For a row w with its ``reach = w M^-1``, its `leverage` is ``w M^-1 w`` and its
`numerator` is ``w M^-1 K M^-1 w``, for the determinant the leverage again. Both tangents have the
same methods:

    value       at M, (R, R)
    slope       S, (R, R): a little of the row w lets the value fall by ``w^T S w`` of it
    degree      ``trace(S M)``
    numerators  of rows with their reaches (N, R), (N,)
    fall        of the value with each row in (sign 1) or out (sign -1), (N,)
    step        change of all numerators by one row, (N,), and by how much the value falls
    group_fall  of the value with groups of rows, (groups,), from their reaches (groups, n, R) and
                ``inner = 1 + w M^-1 w^T``, (groups, n, n) (Woodbury)
    pair        numerators of two rows with one another, (2, 2), for their reaches (R, 2)
    flow_slope  how fast the value falls at the flow t between two rows (`relaxation`)
    after_flow  change of ``w^T S w`` of all rows, (N,), when ``M^-1`` falls by
                ``reach inner reach^T``, with reaches (R, k) of some rows and inner (k, k)
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from matstd.twin.frames import Array


class RowStep(NamedTuple):
    """One row that comes in or goes out (Sherman and Morrison): ``M^-1`` falls by ``c a a^T``."""

    W: Array  # all rows, (N, R)
    inverse: Array  # ``M^-1`` before, (R, R)
    a: Array  # ``M^-1 w``, (R,)
    along: Array  # ``W a``, (N,)
    signed: float  # leverage of the row, negative where it goes out
    c: float  # ``sign / (1 + sign leverage)``


@dataclass(frozen=True, eq=False)
class Trace:
    """``trace(K M^-1)``."""

    K: Array  # the form, with the weight of the machine in it, (R, R)

    def value(self, M: Array, inverse: Array) -> float:
        """``trace(K M^-1)``."""
        return float(np.sum(inverse * self.K))

    def degree(self, inverse: Array) -> float:
        return float(np.sum(inverse * self.K))

    def slope(self, inverse: Array) -> Array:
        """``M^-1 K M^-1``."""
        S = inverse @ self.K @ inverse
        return np.asarray(0.5 * (S + S.T))

    def numerators(self, reach: Array, leverage: Array) -> Array:
        """``w M^-1 K M^-1 w``."""
        return np.asarray(np.einsum("nr,nr->n", reach @ self.K, reach))

    def fall(self, numerator: Array, leverage: Array, sign: float = 1.0) -> Array:
        """``k / (1 + h)``."""
        return np.asarray(sign * numerator / (1.0 + sign * leverage))

    def step(self, row: RowStep) -> tuple[Array, float]:
        Ka = self.K @ row.a
        kappa, across = float(row.a @ Ka), row.W @ (row.inverse @ Ka)
        change = row.c * row.c * kappa * row.along**2 - 2.0 * row.c * row.along * across
        return change, row.c * kappa

    def group_fall(self, reach: Array, inner: Array) -> Array:
        """``trace(inner^-1  w M^-1 K M^-1 w^T)``."""
        spread = reach @ self.K @ np.swapaxes(reach, 1, 2)
        return np.asarray(np.trace(np.linalg.solve(inner, spread), axis1=1, axis2=2))

    def pair(self, reach: Array) -> Array:
        return np.asarray(reach.T @ self.K @ reach)

    def flow_slope(self, t: float, a: float, b: float, c: float, d: float) -> float:
        """Slope of ``(a t - c t^2) / (1 + b t - d t^2)``."""
        det, turn = 1.0 + b * t - d * t * t, b - 2.0 * d * t
        return ((a - 2.0 * t * c) * det - (t * a - t * t * c) * turn) / (det * det)

    def after_flow(self, W: Array, inverse: Array, reach: Array, inner: Array) -> Array:
        Kr = self.K @ reach
        # both at once, and as rows: half the time of two products, with the same digits
        along, other = np.split((np.hstack([reach, inverse @ Kr]).T @ W.T).T, 2, axis=1)
        kappa = inner @ (reach.T @ Kr) @ inner
        turned = along @ kappa - 2.0 * other @ inner
        return np.asarray(np.einsum("ni,ni->n", turned, along))


@dataclass(frozen=True)
class LogDeterminant:
    """``-weight log det M``."""

    weight: float  # of the machine

    def value(self, M: Array, inverse: Array) -> float:
        return float(-self.weight * np.linalg.slogdet(M)[1])

    def degree(self, inverse: Array) -> float:
        """R, of a machine of weight one."""
        return self.weight * len(inverse)

    def slope(self, inverse: Array) -> Array:
        return np.asarray(self.weight * inverse)

    def numerators(self, reach: Array, leverage: Array) -> Array:
        return leverage

    def fall(self, numerator: Array, leverage: Array, sign: float = 1.0) -> Array:
        return np.asarray(self.weight * np.log1p(sign * leverage))

    def step(self, row: RowStep) -> tuple[Array, float]:
        return -row.c * row.along**2, self.weight * float(np.log1p(row.signed))

    def group_fall(self, reach: Array, inner: Array) -> Array:
        return np.asarray(self.weight * np.linalg.slogdet(inner)[1])

    def pair(self, reach: Array) -> Array:
        """Not needed: the flow slope depends on the leverages alone."""
        return np.zeros((2, 2))

    def flow_slope(self, t: float, a: float, b: float, c: float, d: float) -> float:
        """Slope of ``log(1 + b t - d t^2)``."""
        return self.weight * (b - 2.0 * d * t) / (1.0 + b * t - d * t * t)

    def after_flow(self, W: Array, inverse: Array, reach: Array, inner: Array) -> Array:
        along = W @ reach
        return -self.weight * np.asarray(np.einsum("ni,ij,nj->n", along, inner, along))


Tangent = Trace | LogDeterminant
"""A criterion of one machine along which a search goes."""
