"""Choosing touches: which rows, of all that could be measured, tell most.

The criterion is a `DesignCriterion`: Bayesian and, by default, I-optimal, the mean predicted
variance of the tool point over the poses that the user cares about,

    value = trace(K M^-1),   M = 1 + sum over the chosen rows of w w^T,   K = mean of G^T G,

for parameters in units of their prior. The same row-by-row updates serve every criterion by its
tangent. A greedy choice is mended by exchanges until none that is tried helps; that is a local
optimum and is called nothing else. `information.selection.certificate` says how near it is to the
best.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from information.criteria import DesignCriterion, Tangent, purpose
from twin.errors import DesignError
from twin.frames import Array
from twin.record import IntArray

__all__ = ["DesignCriterion", "Quota", "Selection", "exchange", "fill", "purpose"]

Mask = NDArray[np.bool_]

_REFRESH = 40  # updates after which rounding is swept out
_WORTH = 1e-6  # relative gain below which an exchange is not made
_PATIENCE = 8  # chosen rows, the least useful first, that are tried before an exchange is given up
_TURN = 20  # rows chosen greedily along one tangent of a criterion that is curved
_SHARPER = (1.0, 4.0, 16.0)  # power means that stand for the largest, one after another
_BATCH = 16  # exchanges along one tangent of a criterion that is curved


class _Machine:
    """Inverse information, and what every row would add, for one drawn machine."""

    def __init__(self, M: Array, K: Array | None, W: Array) -> None:
        self.W, self.K = W, K
        self.inverse = np.asarray(np.linalg.solve(M, np.eye(len(M))), dtype=np.float64)
        reach = W @ self.inverse
        self.leverage = np.einsum("nr,nr->n", reach, W)
        self.gain = self.leverage
        if K is not None:
            self.gain = np.einsum("nr,nr->n", reach @ K, reach)

    def update(self, row: int, sign: float) -> float:
        """Rank-one update of everything (Sherman and Morrison), sign 1 in and -1 out.

        Returns:
            By how much the value falls; for D by how much the log determinant grows.
        """
        a = self.inverse @ self.W[row]
        h = float(self.leverage[row])
        c = sign / (1.0 + sign * h)
        along_a = self.W @ a
        self.leverage = self.leverage - c * along_a**2
        if self.K is None:
            self.inverse -= c * np.outer(a, a)
            self.gain = self.leverage
            return float(np.log1p(sign * h))
        Ka = self.K @ a
        kappa, along_b = float(a @ Ka), self.W @ (self.inverse @ Ka)
        self.inverse -= c * np.outer(a, a)
        self.gain = self.gain + c * c * kappa * along_a**2 - 2.0 * c * along_a * along_b
        return c * kappa


class Selection:
    """Rows chosen so far, with what every other row would add; updated row by row.

    Attributes:
        chosen: Which rows are in, (N,).
        value: The criterion, smaller is better (`DesignCriterion.value`); between refreshes of a
        curved
            one that of its tangent.
    """

    def __init__(self, aim: DesignCriterion, W: Array, chosen: Mask | None = None) -> None:
        self.aim, self.W = aim, W
        self.chosen = np.zeros(len(W), dtype=bool) if chosen is None else chosen.copy()
        self.refresh()

    @property
    def information(self) -> Array:
        """``W^T W`` of the chosen rows, (R, R)."""
        kept = self.W[self.chosen]
        return np.asarray(kept.T @ kept, dtype=np.float64)

    def refresh(self) -> None:
        """Everything from scratch: sweeps out rounding, and turns the tangent."""
        information = self.information
        self.value = self.aim.value(information)
        self._tangent: Tangent = self.aim.tangent(information)
        self._sweep(information)

    def _sweep(self, information: Array) -> None:
        """Inverses, leverages and gains anew, along the tangent as it is."""
        forms = [None] * len(self.aim.prior) if self.aim.is_determinant else self._tangent.K
        self._machines = [
            _Machine(prior + information, K, self.W)
            for prior, K in zip(self.aim.prior, forms, strict=True)
        ]
        self._updates = 0

    @property
    def gains(self) -> Array:
        """How much less the value is with each row in, (N,); for a row that is in: once more.

        For D how much more the mean logarithm of the determinants is.
        """
        if self.aim.is_determinant:
            return self._sum([np.log1p(m.leverage) for m in self._machines])
        return np.sum([m.gain / (1.0 + m.leverage) for m in self._machines], axis=0)

    @property
    def losses(self) -> Array:
        """How much more the value is with each chosen row out, (N,); inf for rows not chosen."""
        out = np.full(len(self.W), np.inf)
        i = self.chosen
        left = [np.maximum(1.0 - m.leverage[i], 1e-12) for m in self._machines]
        if self.aim.is_determinant:
            out[i] = self._sum([-np.log(x) for x in left])
        else:
            out[i] = np.sum([m.gain[i] / x for m, x in zip(self._machines, left, strict=True)], 0)
        return out

    def _sum(self, each: list[Array]) -> Array:
        """Mean over the machines with the weights that they have now."""
        return np.asarray(self._tangent.weight @ np.stack(each), dtype=np.float64)

    def add(self, row: int) -> None:
        """Choose a row."""
        self._update(row, 1.0)
        self.chosen[row] = True

    def drop(self, row: int) -> None:
        """Leave a row out again."""
        self._update(row, -1.0)
        self.chosen[row] = False

    def _update(self, row: int, sign: float) -> None:
        if self._updates >= _REFRESH:
            information = self.information
            self._sweep(information)
            if not self.aim.is_curved:
                self.value = self.aim.value(information)
        self._updates += 1
        falls = np.array([m.update(row, sign) for m in self._machines])
        if self.aim.is_determinant:
            self.value *= float(np.exp(-(self._tangent.weight @ falls) / len(self.aim.K)))
        else:
            self.value -= float(falls.sum())


@dataclass(frozen=True, eq=False)
class Quota:
    """How many rows of a kind may be chosen.

    Attributes:
        kind: Of every row, (N,), from 0.
        most: Of each kind.
        least: Of each kind; None where there may be none. Exchanges and bounds keep to it; `fill`
            does not, which is asked for one kind after another.
    """

    kind: IntArray
    most: IntArray
    least: IntArray | None = None

    def count(self, chosen: Mask) -> IntArray:
        """EffectSubset rows of each kind."""
        return np.bincount(self.kind[chosen], minlength=len(self.most))

    def open(self, chosen: Mask) -> Mask:
        """Rows whose kind has room left, (N,)."""
        count = self.count(chosen)
        room: Mask = (count < self.most)[self.kind]
        return room

    def needed(self, chosen: Mask) -> Mask:
        """Rows of kinds that have too few; all where none has, (N,)."""
        lacks = np.zeros(len(self.most), dtype=bool)
        if self.least is not None:
            lacks = self.count(chosen) < self.least
        return lacks[self.kind] if lacks.any() else np.ones(len(self.kind), dtype=bool)


def _open(quotas: tuple[Quota, ...], chosen: Mask) -> Mask:
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
            raise DesignError(
                f"{chosen} of {count} touches can be chosen under the shares of each kind"
            )
        selection.add(int(np.argmax(np.where(free, selection.gains, -np.inf))))
        if selection.aim.is_curved and chosen % _TURN == 0:
            selection.refresh()
    selection.refresh()


def exchange(
    selection: Selection,
    quotas: tuple[Quota, ...] = (),
    kept: Mask | None = None,
    most: int = 200,
) -> int:
    """Exchange chosen rows for better ones: the least useful out, the most useful in.

    A criterion that is curved is followed along its tangent for some exchanges; they are taken back
    and fewer are tried where it grew.

    Args:
        selection: Is changed.
        quotas: Hold after every exchange.
        kept: Rows that stay in, (N,).
        most: Largest number of exchanges.

    Returns:
        Number of exchanges made; fewer than `most` means that no exchange that was tried helps.

    Reference:
        Fedorov, Theory of Optimal Experiments (1972); Cook and Nachtsheim (1980).
    """
    stays = np.zeros(len(selection.W), dtype=bool) if kept is None else kept
    if not selection.aim.is_curved:
        return _exchange(selection, quotas, stays, most)
    given, total = selection.aim, 0
    for sharper in _SHARPER if given.roots is not None else (1.0,):
        selection.aim = replace(given, sharpness=sharper * given.sharpness)
        total += _exchange_curved(selection, quotas, stays, most - total)
    selection.aim = given
    selection.refresh()
    return total


def _exchange_curved(
    selection: Selection, quotas: tuple[Quota, ...], stays: Mask, most: int
) -> int:
    """Exchanges in lots, each along one tangent, as long as the smooth criterion falls."""
    selection.refresh()
    total, batch = 0, _BATCH
    merit = selection.aim.merit(selection.information)
    while batch and total < most:
        before = selection.chosen.copy()
        made = _exchange(selection, quotas, stays, min(batch, most - total))
        now = selection.aim.merit(selection.information)
        if made and now < merit * (1.0 - _WORTH):
            merit, total = now, total + made
        else:
            selection.chosen, batch = before, (batch // 2 if made else 0)
        selection.refresh()
    return total


def _exchange(selection: Selection, quotas: tuple[Quota, ...], stays: Mask, most: int) -> int:
    """Exchanges along the present tangent."""
    made, tired = 0, np.zeros(len(stays), dtype=bool)
    while made < most and int(tired.sum()) < _PATIENCE:
        losses = np.where(stays | tired, np.inf, selection.losses)
        worst = int(np.argmin(losses))
        if not np.isfinite(losses[worst]):
            return made
        before = selection.value
        selection.drop(worst)
        free = _open(quotas, selection.chosen)
        for quota in quotas:
            free &= quota.needed(selection.chosen)
        best = int(np.argmax(np.where(free, selection.gains, -np.inf)))
        selection.add(best)
        if best != worst and selection.value <= before * (1.0 - _WORTH):
            made, tired = made + 1, np.zeros(len(stays), dtype=bool)
            continue
        if best != worst:
            selection.drop(best)
            selection.add(worst)
        tired[worst] = True
    return made
