"""Linear laws: ridge regression whose weight is chosen by blocks left out, with its covariance."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from matstd.diagnosis.drift.lags import Lagged
from matstd.diagnosis.drift.record import DriftRecord
from matstd.twin.frames import Array, IntArray

WEIGHTS = 10.0 ** np.arange(-6.0, 1.1, 0.5)
"""Of ridge regression, in variances of a standardised column."""

MIN_RELATIVE_SPREAD = 1e-9  # a column whose spread is less than this of its size is constant


@dataclass(frozen=True, eq=False)
class LinearLaw:
    """``y = intercept + (X - mean)/scale @ coefficients``, and how well it is known."""

    inputs: Lagged  # columns X of a record
    mean: Array  # of the columns in training, (M,)
    scale: Array  # their standard deviations, (M,)
    intercept: Array  # (K,), base units
    coefficients: Array  # (M, K)
    weight: float  # of the ridge
    # of intercept and coefficients per unit variance of one independent residual, (1 + M, 1 + M)
    covariance: Array
    residual: Array  # standard deviation of what is left in training, (K,)
    memory: float  # time in which what is left forgets itself, s

    def basis(self, record: DriftRecord) -> Array:
        """One and the standardised columns, (N, 1 + M)."""
        return _with_one((self.inputs(record) - self.mean) / self.scale)

    def predicted(self, record: DriftRecord) -> Array:
        """Free run: no displacement is fed back, (N, K)."""
        return self.basis(record) @ np.vstack([self.intercept, self.coefficients])

    def leverage(self, record: DriftRecord) -> Array:
        """Variance that unknown coefficients add, per unit variance of the residual, (N,)."""
        X = self.basis(record)
        return np.einsum("nm,mk,nk->n", X, self.covariance, X)


@dataclass(frozen=True, eq=False)
class Sums:
    """Sums of products of standardised columns, by block: each is predicted from the others."""

    gram: Array  # (B, 1 + M, 1 + M)
    cross: Array  # with the components in units of their size, (B, 1 + M, K)
    square: Array  # of the components, (B, K)
    count: Array  # rows of each block, (B,)

    def left_out(self, weight: float) -> Array:
        """Mean squared error of every block, predicted from the others, (B,).

        Args:
            weight: Of the ridge; column 0 is the constant and free of it.
        """
        others = self.gram.sum(axis=0) - self.gram
        count = self.count.sum() - self.count
        free = np.arange(self.gram.shape[-1]) > 0
        penalty = weight * count[:, None, None] * np.diag(free)
        theta = np.linalg.solve(
            others + penalty + _tiny(others), self.cross.sum(axis=0) - self.cross
        )
        error = (
            self.square
            - 2.0 * np.einsum("bmk,bmk->bk", theta, self.cross)
            + np.einsum("bmk,bmn,bnk->bk", theta, self.gram, theta)
        )
        return np.maximum(error, 0.0).mean(axis=1) / self.count


def _tiny(gram: Array) -> Array:
    """What keeps columns that are sums of one another solvable."""
    m = gram.shape[-1]
    return 1e-12 * np.trace(gram, axis1=-2, axis2=-1)[..., None, None] / m * np.eye(m)


def _with_one(columns: Array) -> Array:
    return np.column_stack([np.ones(len(columns)), columns])


def standardised(X: Array, rows: IntArray) -> tuple[Array, Array, Array]:
    """Columns less their mean over rows and in units of their spread there, mean and spread."""
    mean, spread = X[rows].mean(axis=0), X[rows].std(axis=0)
    scale = np.where(spread > MIN_RELATIVE_SPREAD * np.maximum(np.abs(mean), 1.0), spread, np.inf)
    return (X - mean) / scale, mean, scale


def sums(record: DriftRecord, Z: Array, parts: Sequence[IntArray]) -> Sums:
    """Sums of standardised columns over blocks of rows."""
    y = record.displacement / record.size
    columns = [_with_one(record.centred(Z[b], b)) for b in parts]
    moved = [record.centred(y[b], b) for b in parts]
    return Sums(
        np.array([X.T @ X for X in columns]),
        np.array([X.T @ v for X, v in zip(columns, moved, strict=True)]),
        np.array([(v**2).sum(axis=0) for v in moved]),
        np.array([float(len(b)) for b in parts]),
    )


def ridge(record: DriftRecord, inputs: Lagged, parts: Sequence[IntArray]) -> LinearLaw:
    """A linear law whose weight predicts left-out blocks best."""
    Z, _, _ = standardised(inputs(record), np.concatenate(parts))
    added = sums(record, Z, parts)
    errors = [added.left_out(w) @ added.count for w in WEIGHTS]
    return fitted(record, inputs, parts, float(WEIGHTS[int(np.argmin(errors))]))


def fitted(
    record: DriftRecord, inputs: Lagged, parts: Sequence[IntArray], weight: float
) -> LinearLaw:
    """A linear law with a given weight, from all blocks.

    The residual is no white noise: rows count as many as there are spans of twice its memory.
    Where logs have zeros of their own, only changes within a log count.
    """
    rows = np.concatenate(parts)
    Z, mean, scale = standardised(inputs(record), rows)
    X, y = _with_one(record.centred(Z[rows], rows)), record.displacement[rows]
    middle = y.mean(axis=0)
    y = record.centred(y, rows)
    penalty = weight * len(rows) * np.diag(np.arange(X.shape[1]) > 0)
    gram = X.T @ X
    theta: Array = np.asarray(
        np.linalg.solve(gram + penalty + _tiny(gram), X.T @ y), dtype=np.float64
    )
    left = y - X @ theta
    spread: Array = np.sqrt(np.mean(left**2, axis=0))
    memory = memory_of(left / record.size, record.step)
    independent = max(len(rows) * record.step / (2.0 * memory), 1.0)
    # columns that are sums of one another make the matrix singular
    inverse: Array = np.asarray(
        np.linalg.pinv((gram + penalty) / len(rows), hermitian=True), dtype=np.float64
    )
    return LinearLaw(
        inputs=inputs,
        mean=mean,
        scale=scale,
        intercept=theta[0] if record.zeros is None else middle,
        coefficients=theta[1:],
        weight=weight,
        covariance=inverse / independent,
        residual=spread,
        memory=memory,
    )


def memory_of(left: Array, step: float) -> float:
    """Time after which the correlation of a residual (N, K) has fallen to 1/e, s; a step at least.

    Example:
        >>> memory_of(np.sin(np.arange(1000) / 50.0)[:, None], 60.0) / 60.0
        60.0
    """
    left = left - left.mean(axis=0)
    power = float((left**2).sum())
    for lag in range(1, len(left) // 2):
        if (left[lag:] * left[:-lag]).sum() < power * np.exp(-1.0):
            return lag * step
    return step * max(len(left) // 2, 1)
