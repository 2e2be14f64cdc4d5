"""Choosing touches: which rows, of all that could be measured, tell most.

The criterion is Bayesian and, by default, I-optimal: the mean predicted variance of the tool point
over the poses that the user cares about,

    value = trace(K M^-1),   M = 1 + sum over the chosen rows of w w^T,   K = mean of G^T G,

for parameters in units of their prior. With K the unit matrix it is A-optimality. D-optimality
takes ``det(M)^(-1/R)``, the geometric mean of the posterior variances, which the same row-by-row
updates serve with K = M. A greedy choice is mended by exchanges until no exchange helps; that is a
local optimum and is called nothing else. `sensitivity.certificate` says how near it is to the best.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from twin.errors import DesignError
from twin.frames import Array
from twin.touches import IntArray

_REFRESH = 40  # updates after which rounding is swept out
_WORTH = 1e-6  # relative gain below which an exchange is not made


@dataclass(frozen=True, eq=False)
class Purpose:
    """What touches are chosen for: the directions of parameter space that matter, and their weight.

    Attributes:
        directions: Orthonormal columns, (P, R): everything that a tool point or a touch can feel.
        K: Mean square of the tool point's deviation as a form in these directions, (R, R), mm^2.
        is_determinant: Whether the volume of what stays unknown counts (D) instead of K (I, A).
    """

    directions: Array
    K: Array
    is_determinant: bool = False

    def rows(self, W: Array) -> Array:
        """Whitened rows (N, P) in the directions that matter, (N, R)."""
        reduced: Array = W @ self.directions
        return reduced

    def value(self, information: Array) -> float:
        """Criterion for W^T W (R, R) of some rows; smaller is better.

        Mean predicted variance of the tool point, mm^2, or ``det(M)^(-1/R)`` for D.
        """
        M = np.eye(len(self.K)) + information
        if self.is_determinant:
            return float(np.exp(-np.linalg.slogdet(M)[1] / len(M)))
        return float(np.trace(np.linalg.solve(M, self.K)))


def purpose(G: Array, W: Array, prior_sd: Array) -> Purpose:
    """Purpose: to predict the tool point at M poses.

    Directions that neither move the tool point at any pose nor show in any row stay at their prior
    whatever is measured; they are left out, which is exact and a third of the work.

    Args:
        G: Deviation of the tip per unit of every parameter at the poses, (M, 3, P), mm.
        W: Some whitened rows that span what can be measured, (N, P).
        prior_sd: Expected standard deviation of every parameter, (P,).
    """
    scaled = (G * prior_sd).reshape(-1, len(prior_sd))
    K = scaled.T @ scaled / len(G)
    seen = W.T @ W
    both = K / np.trace(K) + seen / max(float(np.trace(seen)), 1e-300)
    values, vectors = np.linalg.eigh(both)
    V = vectors[:, values > 1e-13 * values[-1]]
    return Purpose(V, V.T @ K @ V)


class Selection:
    """Rows chosen so far, with what every other row would add; updated row by row.

    Attributes:
        chosen: Which rows are in, (N,).
        value: The criterion, smaller is better (`Purpose.value`).
    """

    def __init__(self, aim: Purpose, W: Array, chosen: NDArray[np.bool_] | None = None) -> None:
        self.aim, self.W = aim, W
        self.chosen = np.zeros(len(W), dtype=bool) if chosen is None else chosen.copy()
        self._refresh()

    def _refresh(self) -> None:
        """M^-1, leverages h = w M^-1 w and gains g = w M^-1 K M^-1 w of all rows, from scratch."""
        kept = self.W[self.chosen]
        self._inverse = np.linalg.solve(
            np.eye(self.W.shape[1]) + kept.T @ kept, np.eye(self.W.shape[1])
        )
        self.value = self.aim.value(kept.T @ kept)
        reach = self.W @ self._inverse
        self._leverage = np.einsum("nr,nr->n", reach, self.W)
        self._gain = self._leverage
        if not self.aim.is_determinant:
            self._gain = np.einsum("nr,nr->n", reach @ self.aim.K, reach)
        self._updates = 0

    @property
    def gains(self) -> Array:
        """How much less the value is with each row in, (N,); for a row that is in: once more.

        For D ``h / (1 + h)``, which ranks rows as ``log(1 + h)`` does.
        """
        return self._gain / (1.0 + self._leverage)

    @property
    def losses(self) -> Array:
        """How much more the value is with each chosen row out, (N,); inf for rows not chosen."""
        out = np.full(len(self.W), np.inf)
        i = self.chosen
        out[i] = self._gain[i] / np.maximum(1.0 - self._leverage[i], 1e-12)
        return out

    def add(self, row: int) -> None:
        """Choose a row."""
        self._update(row, 1.0)
        self.chosen[row] = True

    def drop(self, row: int) -> None:
        """Leave a row out again."""
        self._update(row, -1.0)
        self.chosen[row] = False

    def _update(self, row: int, sign: float) -> None:
        """Rank-one update of everything (Sherman and Morrison), sign 1 in and -1 out."""
        if self._updates >= _REFRESH:
            self._refresh()
        self._updates += 1
        a = self._inverse @ self.W[row]
        c = sign / (1.0 + sign * self._leverage[row])
        if self.aim.is_determinant:
            self.value *= float((1.0 + sign * self._leverage[row]) ** (-1.0 / len(a)))
            self._inverse -= c * np.outer(a, a)
            self._leverage -= c * (self.W @ a) ** 2
            self._gain = self._leverage
            return
        b = self._inverse @ (self.aim.K @ a)
        kappa = float(a @ self.aim.K @ a)
        along_a, along_b = self.W @ a, self.W @ b
        self._inverse -= c * np.outer(a, a)
        self._leverage -= c * along_a**2
        self._gain += c * c * kappa * along_a**2 - 2.0 * c * along_a * along_b
        self.value -= c * kappa


@dataclass(frozen=True, eq=False)
class Quota:
    """How many rows of a kind may be chosen.

    Attributes:
        kind: Of every row, (N,), from 0.
        most: Of each kind.
    """

    kind: IntArray
    most: IntArray

    def open(self, chosen: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Rows whose kind has room left, (N,)."""
        count = np.bincount(self.kind[chosen], minlength=len(self.most))
        room: NDArray[np.bool_] = (count < self.most)[self.kind]
        return room


def _open(quotas: tuple[Quota, ...], chosen: NDArray[np.bool_]) -> NDArray[np.bool_]:
    free = ~chosen
    for quota in quotas:
        free &= quota.open(chosen)
    return free


def fill(selection: Selection, count: int, quotas: tuple[Quota, ...] = ()) -> None:
    """Choose rows greedily, the one that helps most first, until `count` are in.

    Raises:
        DesignError: The quotas leave fewer rows than asked for.
    """
    while (chosen := int(selection.chosen.sum())) < count:
        free = _open(quotas, selection.chosen)
        if not free.any():
            raise DesignError(f"{chosen} of {count} touches chosen, and no other may be taken")
        selection.add(int(np.argmax(np.where(free, selection.gains, -np.inf))))


def exchange(
    selection: Selection,
    quotas: tuple[Quota, ...] = (),
    kept: NDArray[np.bool_] | None = None,
    most: int = 200,
) -> int:
    """Exchange chosen rows for better ones: the least useful out, the most useful in.

    Args:
        selection: Is changed.
        quotas: Hold after every exchange.
        kept: Rows that stay in, (N,).
        most: Largest number of exchanges.

    Returns:
        Number of exchanges made; fewer than `most` means that no such exchange helps any more.

    Reference:
        Fedorov, Theory of Optimal Experiments (1972); Cook and Nachtsheim (1980).
    """
    stays = np.zeros(len(selection.W), dtype=bool) if kept is None else kept
    for made in range(most):
        losses = np.where(stays, np.inf, selection.losses)
        worst = int(np.argmin(losses))
        if not np.isfinite(losses[worst]):
            return made
        before = selection.value
        selection.drop(worst)
        free = _open(quotas, selection.chosen)
        best = int(np.argmax(np.where(free, selection.gains, -np.inf)))
        selection.add(best)
        if best == worst or selection.value > before * (1.0 - _WORTH):
            selection.drop(best)
            selection.add(worst)
            return made
    return most
