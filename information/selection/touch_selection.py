"""Choosing touches: the rows that determine most, among all that could be measured.

The criterion is a `DesignCriterion`: Bayesian and, by default, I-optimal, the mean predicted
variance of the tool point over the poses that the user cares about,

    value = trace(K M^-1),   M = 1 + sum over the chosen rows of w w^T,   K = mean of G^T G,

for parameters in units of their prior. The same row-by-row updates serve every criterion by its
tangent. A greedy choice is improved by exchanges until none that is tried helps: a local optimum.
`matstd.information.selection.certificate` bounds its distance from the best choice.
"""

from dataclasses import dataclass

import numpy as np

from matstd.information.criteria import DesignCriterion, RowStep, Tangent
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array, IntArray, Mask

_REFRESH = 40  # updates after which rounding is swept out
_MIN_RELATIVE_GAIN = 1e-6  # relative gain below which an exchange is not made
_EQUAL = 1e-8  # relative difference below which rows are worth the same
_PATIENCE = 8  # chosen rows, the least useful first, that are tried before an exchange is given up
_ROWS_PER_TANGENT = 20  # rows chosen greedily along one tangent of a criterion that is curved
_SHARPNESS_FACTORS = (1.0, 4.0, 16.0)  # power means that stand for the largest, one after another
_MAX_LEVERAGE = 1.0 - 1e-12  # largest leverage of a row that is in; beyond it is rounding
_BATCH = 16  # exchanges along one tangent of a criterion that is curved


class _Machine:
    """Inverse information, and what every row would add, for one drawn machine."""

    def __init__(self, M: Array, tangent: Tangent, W: Array) -> None:
        self.W, self.tangent = W, tangent
        self.inverse = np.asarray(np.linalg.solve(M, np.eye(len(M))), dtype=np.float64)
        reach = W @ self.inverse
        self.leverage = np.einsum("nr,nr->n", reach, W)
        self.numerator = tangent.numerators(reach, self.leverage)

    def update(self, row: int, sign: float) -> float:
        """Rank-one update of everything, sign 1 in and -1 out."""
        a = self.inverse @ self.W[row]
        signed = sign * float(self.leverage[row])
        c = sign / (1.0 + signed)
        along = self.W @ a
        step = RowStep(W=self.W, inverse=self.inverse, a=a, along=along, signed=signed, c=c)
        change, fall = self.tangent.step(step)
        self.leverage = self.leverage - c * along**2
        self.numerator = self.numerator + change
        self.inverse -= c * np.outer(a, a)
        return fall


class Selection:
    """Rows chosen so far, with what every other row would add; updated row by row."""

    def __init__(self, criterion: DesignCriterion, W: Array, chosen: Mask | None = None) -> None:
        self.criterion, self.W = criterion, W
        self.chosen = np.zeros(len(W), dtype=bool) if chosen is None else chosen.copy()
        self.refresh()

    @property
    def value(self) -> float:
        """The criterion, smaller is better; between refreshes of a curved one its tangent."""
        return self.criterion.measure.shown(self._raw)

    @property
    def information(self) -> Array:
        """``W^T W`` of the chosen rows, (R, R)."""
        kept = self.W[self.chosen]
        return np.asarray(kept.T @ kept, dtype=np.float64)

    def refresh(self) -> None:
        """Recompute everything, which removes rounding errors and updates the tangent."""
        information = self.information
        self._raw = self.criterion.raw(information)
        self._tangents = self.criterion.tangents(information)
        self._sweep(information)

    def _sweep(self, information: Array) -> None:
        """Recompute inverses, leverages and numerators along the present tangent."""
        self._machines = [
            _Machine(prior + information, tangent, self.W)
            for prior, tangent in zip(self.criterion.prior, self._tangents, strict=True)
        ]
        self._updates = 0

    @property
    def gains(self) -> Array:
        """Fall of the tangent with each row added, (N,), those already chosen included."""
        falls = [m.tangent.fall(m.numerator, m.leverage) for m in self._machines]
        return np.sum(falls, axis=0)

    @property
    def losses(self) -> Array:
        """Growth of the tangent with each chosen row removed, (N,); inf for rows not chosen."""
        out, i = np.full(len(self.W), np.inf), self.chosen
        out[i] = 0.0
        for m in self._machines:
            leverage = np.minimum(m.leverage[i], _MAX_LEVERAGE)
            out[i] -= m.tangent.fall(m.numerator[i], leverage, sign=-1.0)
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
        if self._updates >= _REFRESH:
            information = self.information
            self._sweep(information)
            if not self.criterion.is_curved:
                self._raw = self.criterion.raw(information)
        self._updates += 1
        self._raw -= sum(m.update(row, sign) for m in self._machines)


@dataclass(frozen=True, eq=False)
class Quota:
    """How many rows of a kind may be chosen."""

    kind: IntArray  # of every row, (N,), from 0
    most: IntArray  # of each kind
    # of each kind; None where there may be none. Exchanges and bounds keep to it; `fill` does not,
    # which is asked for one kind after another
    least: IntArray | None = None

    def count(self, chosen: Mask) -> IntArray:
        """Chosen rows of each kind."""
        return np.bincount(self.kind[chosen], minlength=len(self.most))

    def open(self, chosen: Mask) -> Mask:
        """Rows whose kind has room left, (N,)."""
        return np.asarray((self.count(chosen) < self.most)[self.kind])

    def needed(self, chosen: Mask) -> Mask:
        """Rows of kinds that have too few; all where none has, (N,)."""
        lacks = np.zeros(len(self.most), dtype=bool)
        if self.least is not None:
            lacks = self.count(chosen) < self.least
        return lacks[self.kind] if lacks.any() else np.ones(len(self.kind), dtype=bool)


def level(values: Array, scale: float) -> Array:
    """Values to eight digits of a scale: the first of equals is then the same on any processor.

    Linear algebra rounds the last digit differently from one kind of processor to another, and rows
    that symmetry makes equal would be chosen by that digit.
    """
    unit = _EQUAL * scale if np.isfinite(scale) and scale else 1.0
    return np.asarray(np.round(values / unit) * unit)


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
        if selection.criterion.is_curved and chosen % _ROWS_PER_TANGENT == 0:
            selection.refresh()
    selection.refresh()


def exchange(selection: Selection, quotas: tuple[Quota, ...] = (), most: int = 200) -> int:
    """Exchange chosen rows for better ones: the least useful out, the most useful in.

    A criterion that is curved is followed along its tangent for some exchanges; they are taken back
    and fewer are tried where it grew. Quotas hold after every exchange.

    Returns:
        Number of exchanges made; fewer than `most` means that no exchange that was tried helps.

    Reference:
        Fedorov, Theory of Optimal Experiments (1972); Cook and Nachtsheim (1980).
    """
    if not selection.criterion.is_curved:
        return _exchange(selection, quotas, most)
    given, total = selection.criterion, 0
    for factor in _SHARPNESS_FACTORS if np.isfinite(given.measure.sharpness) else (1.0,):
        selection.criterion = given.sharper(factor)
        total += _exchange_curved(selection, quotas, most - total)
    selection.criterion = given
    selection.refresh()
    return total


def _exchange_curved(selection: Selection, quotas: tuple[Quota, ...], most: int) -> int:
    """Exchanges in lots, each along one tangent, as long as the smooth criterion falls."""
    selection.refresh()
    total, batch = 0, _BATCH
    merit = selection.criterion.merit(selection.information)
    while batch and total < most:
        before = selection.chosen.copy()
        made = _exchange(selection, quotas, min(batch, most - total))
        now = selection.criterion.merit(selection.information)
        if made and now < merit * (1.0 - _MIN_RELATIVE_GAIN):
            merit, total = now, total + made
        else:
            selection.chosen, batch = before, (batch // 2 if made else 0)
        selection.refresh()
    return total


def _exchange(selection: Selection, quotas: tuple[Quota, ...], most: int) -> int:
    """Exchanges along the present tangent."""
    made, tired = 0, np.zeros(len(selection.W), dtype=bool)
    while made < most and int(tired.sum()) < _PATIENCE:
        losses = np.where(tired, np.inf, selection.losses)
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
        if best != worst and selection.value <= before * (1.0 - _MIN_RELATIVE_GAIN):
            made, tired = made + 1, np.zeros_like(tired)
            continue
        if best != worst:
            selection.drop(best)
            selection.add(worst)
        tired[worst] = True
    return made
