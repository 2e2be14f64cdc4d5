"""Sphere through measured points by least squares of their distances from it."""

from typing import NamedTuple

import numpy as np

from matstd.twin.frames import Array

_FIT_TOLERANCE = 1e-14  # relative change of the unknowns at which the fit ends


class FittedSphere(NamedTuple):
    """A sphere, and the residuals of its points."""

    centre: Array  # (3,), mm
    radius: float  # mm
    left: Array  # distance of every point from the sphere, outwards, (N,), mm
    cofactor: Array  # covariance of centre and radius for points of unit variance, (4, 4)


def fitted_sphere(points: Array, start: Array | None = None) -> FittedSphere:
    """Least-squares sphere.

    Args:
        points: (N, 3), four or more, mm.
        start: Approximate centre, (3,), mm; None for that of the linear form
            ``2 c.p + (r^2 - c.c) = p.p``, which needs points all round the sphere.
    """
    from scipy.optimize import least_squares

    if start is None:
        A = np.column_stack([2.0 * points, np.ones(len(points))])
        start = np.linalg.lstsq(A, (points**2).sum(axis=1), rcond=None)[0][:3]

    def left(x: Array) -> Array:
        return np.asarray(np.linalg.norm(points - x[:3], axis=1) - x[3])

    def jacobian(x: Array) -> Array:
        away = points - x[:3]
        length = np.linalg.norm(away, axis=1, keepdims=True)
        return -np.column_stack([away / length, np.ones(len(points))])

    first = np.append(start, np.linalg.norm(points - start, axis=1).mean())
    solved = least_squares(
        left, first, jacobian, method="lm", xtol=_FIT_TOLERANCE, ftol=_FIT_TOLERANCE
    ).x
    J = jacobian(solved)
    cofactor = np.asarray(np.linalg.pinv(J.T @ J), dtype=np.float64)
    return FittedSphere(solved[:3], float(solved[3]), left(solved), cofactor)
