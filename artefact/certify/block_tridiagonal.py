"""Symmetric positive definite matrices whose blocks couple with their neighbours alone.

Coefficients of a tensor spline of degree k in rows of one direction couple over k rows, so blocks
of k rows do. Elimination block by block costs as much as the blocks: a face of 55 x 55 control
heights has eleven blocks of 275 instead of one matrix of 3025. The banded Cholesky factor of scipy
solves such systems; trace and uncertainty of the fit ask for entries of the inverse, too.

Reference:
    Golub and Van Loan, Matrix Computations, 4.5 (block tridiagonal systems).
    Takahashi, Fagan and Chin (1973): entries of the inverse where the matrix has entries.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse import block_array, csr_array

from matstd.twin.frames import Array


@dataclass(frozen=True, eq=False)
class Blocks:
    """The upper blocks of a symmetric matrix: those on the diagonal, and those to their right."""

    diagonal: Sequence[Array]
    right: Sequence[Array]

    @staticmethod
    def of(matrix: csr_array, size: int) -> "Blocks":
        """Dense blocks of a sparse matrix (M, M) that has nothing beyond its neighbouring ones.

        Args:
            size: Rows of a block; the last one has what is left.
        """
        count = matrix.shape[0]
        ends = [*range(0, count, size), count]
        rows = [slice(*ends_of) for ends_of in pairwise(ends)]
        diagonal = [matrix[own][:, own].toarray() for own in rows]
        right = [matrix[own][:, after].toarray() for own, after in pairwise(rows)]
        return Blocks(diagonal, right)

    def plus(self, other: "Blocks", factor: float, ridge: float) -> "Blocks":
        """The sum with a multiple of another one and of the unit matrix."""
        diagonal = [
            a + factor * b + ridge * np.eye(len(a))
            for a, b in zip(self.diagonal, other.diagonal, strict=True)
        ]
        right = [a + factor * b for a, b in zip(self.right, other.right, strict=True)]
        return Blocks(diagonal, right)

    def dot(self, other: "Blocks") -> float:
        """Sum of the products of all entries of two such matrices: the trace of their product."""
        pairs = zip(self.diagonal, other.diagonal, strict=True)
        beside = zip(self.right, other.right, strict=True)
        return sum(float(np.vdot(a, b)) for a, b in pairs) + 2.0 * sum(
            float(np.vdot(a, b)) for a, b in beside
        )

    def sparse(self) -> csr_array:
        """The matrix, (M, M)."""
        count = len(self.diagonal)
        grid: list[list[csr_array | None]] = [[None] * count for _ in range(count)]
        for k, own in enumerate(self.diagonal):
            grid[k][k] = csr_array(own)
        for k, beside in enumerate(self.right):
            grid[k][k + 1], grid[k + 1][k] = csr_array(beside), csr_array(beside.T)
        return csr_array(block_array(grid))


class Eliminated:
    """A matrix after elimination, block by block from the first to the last."""

    def __init__(self, matrix: Blocks) -> None:
        """Factors of the blocks that are left, and what each takes from the one behind it."""
        self._factors = [cho_factor(matrix.diagonal[0])]
        self._taken: list[Array] = []
        for right, diagonal in zip(matrix.right, matrix.diagonal[1:], strict=True):
            taken = cho_solve(self._factors[-1], right)
            self._taken.append(taken)
            self._factors.append(cho_factor(diagonal - right.T @ taken))
        ends = np.cumsum([len(block) for block in matrix.diagonal])[:-1]
        self._ends = ends.tolist()

    def solve(self, right: Array) -> Array:
        """Solution of the system for right sides (M, ...)."""
        parts = np.split(right, self._ends)
        left = [parts[0]]
        for taken, part in zip(self._taken, parts[1:], strict=True):
            left.append(part - taken.T @ left[-1])
        out = [cho_solve(self._factors[-1], left[-1])]
        for k in range(len(self._taken) - 1, -1, -1):
            out.append(cho_solve(self._factors[k], left[k]) - self._taken[k] @ out[-1])
        return np.concatenate(out[::-1])

    def inverse(self) -> Blocks:
        """The inverse where the matrix has blocks; its other entries are not zero but not asked."""
        diagonal = [_inverse(self._factors[-1])]
        right: list[Array] = []
        for k in range(len(self._taken) - 1, -1, -1):
            beside = self._taken[k] @ diagonal[-1]
            right.append(-beside)
            diagonal.append(_inverse(self._factors[k]) + beside @ self._taken[k].T)
        return Blocks(diagonal[::-1], right[::-1])


def _inverse(factor: tuple[Array, bool]) -> Array:
    return np.asarray(cho_solve(factor, np.eye(len(factor[0]))))
