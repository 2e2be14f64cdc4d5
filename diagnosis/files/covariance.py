"""The covariance of a model file: the lower triangle, a row a parameter."""

from pathlib import Path

import numpy as np

from matstd.twin.errors import BadFile
from matstd.twin.frames import Array

LARGEST, SMALLEST = 1e12, 1e-300
"""Variances of a file beyond the first (µm, µrad squared ...) are slips; of none below the second a
root is taken."""

MAX_ROUNDING = 1e-6
"""By so much rounding may leave correlations of a file beyond one, or variances below zero."""


def covariance_of(rows: list[list[float]], factors: Array, path: str | Path) -> Array:
    """Covariance in base units from its lower triangle."""
    n = len(factors)
    if [len(row) for row in rows] != list(range(1, n + 1)):
        raise BadFile(
            path, "covariance", f"{len(rows)} rows", f"the lower triangle of {n} parameters"
        )
    out = np.zeros((n, n))
    for i, row in enumerate(rows):
        out[i, : i + 1] = row
        out[: i + 1, i] = row
    _check_covariance(out, path)
    return np.asarray(out * np.outer(factors, factors))


def _check_covariance(matrix: Array, path: str | Path) -> None:
    """Refuse numbers that no covariance has: correlations beyond one, variances below zero."""
    variance = np.diag(matrix)
    wrong = np.flatnonzero(~((variance >= 0.0) & (variance < LARGEST)))
    if len(wrong):
        i = int(wrong[0])
        raise BadFile(path, f"covariance[{i}][{i}]", matrix[i, i], "a variance")
    sd = np.sqrt(np.maximum(variance, SMALLEST))
    correlation = matrix / np.outer(sd, sd)
    if np.abs(correlation).max(initial=0.0) > 1.0 + MAX_ROUNDING:
        i, j = (int(k) for k in np.argwhere(np.abs(correlation) > 1.0 + MAX_ROUNDING)[0])
        expected = "a covariance within what the two variances allow"
        raise BadFile(path, f"covariance[{max(i, j)}][{min(i, j)}]", matrix[i, j], expected)
    if np.linalg.eigvalsh(correlation).min(initial=0.0) < -MAX_ROUNDING * len(matrix):
        raise BadFile(path, "covariance", "variances below zero of sums", "a covariance")
