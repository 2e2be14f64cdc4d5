"""Touches and table poses that show unmodelled effects best, chosen from those that can be made.

A touch with the deviations r of the effects that all others and the model do not explain, and the
leverage ``h = 1 + b^T (1 + B^T B)^-1 b`` beside them, adds to the square of an effect's signal

    |r|^2 / h,   r = f - F^T B (1 + B^T B)^-1 b

in units of its noise, with B what is explained and F the effects at the touches chosen before. The
next touch is the one with the least sum of ``1 / signal^2`` over all effects: the effect that shows
least counts most. Steep flanks that face along an axis win, where several axes have to be shown.
Table poses are chosen alike, with all that can be measured at each.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from matstd.artefact.hidden.smooth_effects import (
    Measurement,
    effect_columns,
    explained_columns,
    measured_together,
)
from matstd.artefact.worth import Criterion
from matstd.twin.frames import Array, IntArray

_NEGLIGIBLE_SIGNAL = 1e-6  # of a square of a signal, for effects that nothing shows yet


def showing_touches(
    criterion: Criterion,
    given: Measurement,
    tried: Measurement,
    places: Array,
    count: int,
    at: IntArray,
    area: IntArray,
) -> IntArray:
    """Rows of the touches that show most beside given ones.

    Args:
        criterion: On the standard, whose calibration counts.
        given: Measurements that will be made whatever is chosen.
        tried: Touches that can be made. Form errors of a face are part of their noise: touches are
            at different places, so that they hardly share them.
        places: Where bumps may be, readings of the linear axes, (K, 3), mm.
        count: Number of touches, not above the number of places.
        at: Place of every touch that can be made, (N,); each is touched once.
        area: Of every place, (P,): each area gets its share, so that touches are spread.
    """
    choice = _Choice.begun(criterion, given, tried, places)
    room = np.ceil(count / len(np.unique(area))) * np.ones(area.max() + 1, dtype=int)
    free, out = np.ones(len(tried), dtype=bool), []
    for _ in range(count):
        open_now = free & (room[area[at]] > 0)
        if not open_now.any():  # areas with too few places: the others take more
            open_now = free
        if not open_now.any():
            break
        best = int(np.argmin(np.where(open_now, choice.left_after(), np.inf)))
        choice.take(best)
        room[area[at[best]]] -= 1
        free &= at != at[best]
        out.append(best)
    return np.array(out, dtype=np.int64)


def showing_poses(
    criterion: Criterion, given: Measurement, lots: Sequence[Measurement], places: Array, count: int
) -> list[int]:
    """Numbers of the lots that show most together beside given measurements, the best first.

    Args:
        criterion: On the standard, whose calibration counts.
        lots: What can be measured at each table pose, with independent noise.
        places: Where bumps may be, readings of the linear axes, (K, 3), mm.
        count: Number of lots wanted; none is taken twice.
    """
    F, first = effect_columns(criterion, measured_together([given, *lots]), places)
    B = explained_columns(criterion, measured_together([given, *lots]))
    ends = np.cumsum([len(given), *map(len, lots)])[:-1]
    shown, *alone = map(_Sums.of, np.split(B, ends), np.split(F, ends))
    chosen = list[int]()
    for _ in range(min(count, len(lots))):
        free = [k for k in range(len(lots)) if k not in chosen]
        left = [float(_left_unseen((shown + alone[k]).shown(first))) for k in free]
        chosen.append(free[int(np.argmin(left))])
        shown += alone[chosen[-1]]
    return chosen


def _left_unseen(square: Array) -> Array:
    """Sum of ``1 / signal^2`` over all effects, by squares of their signals (..., E)."""
    return np.asarray(np.sum(1.0 / (square + _NEGLIGIBLE_SIGNAL), axis=-1))


@dataclass(frozen=True, eq=False)
class _Sums:
    """Products of columns summed over some rows; those of independent rows add up."""

    M: Array  # identity and ``B^T B``, (B, B)
    C: Array  # ``B^T F``, (B, M)
    square: Array  # of every column of F, (M,)

    @staticmethod
    def of(B: Array, F: Array) -> "_Sums":
        """Of the columns of what is explained and of the effects, (N, B) and (N, M)."""
        return _Sums(np.eye(B.shape[1]) + B.T @ B, B.T @ F, np.sum(F**2, axis=0))

    def __add__(self, other: "_Sums") -> "_Sums":
        M = self.M + other.M - np.eye(len(self.M))
        return _Sums(M, self.C + other.C, self.square + other.square)

    @property
    def known(self) -> Array:
        """What the explained columns take of every effect, (B, M)."""
        return np.asarray(np.linalg.solve(self.M, self.C))

    def shown(self, first: IntArray) -> Array:
        """Squares of the signals of effects that begin at some columns, (E,)."""
        left = self.square - np.sum(self.C * self.known, axis=0)
        return np.asarray(np.add.reduceat(left, first))


@dataclass(eq=False)
class _Choice:
    """What given and chosen touches show, and what every other would add."""

    first: IntArray  # first column of every effect, (E,)
    square: Array  # squares of the signals, (E,)
    left: Array  # deviations at the possible touches that nothing explains, (N, M)
    explained: Array  # of the possible touches, (N, B)
    weighed: Array  # the same times the covariance of what is explained, (N, B)
    leverage: Array  # ``h``, (N,)

    @staticmethod
    def begun(
        criterion: Criterion, given: Measurement, tried: Measurement, places: Array
    ) -> "_Choice":
        """With the given measurements alone."""
        both, count = measured_together([given, tried]), len(given)
        F, first = effect_columns(criterion, both, places)
        B = explained_columns(criterion, both)
        sums = _Sums.of(B[:count], F[:count])
        known = sums.known
        weighed = np.asarray(np.linalg.solve(sums.M, B[count:].T).T, dtype=np.float64)
        return _Choice(
            first=first,
            square=sums.shown(first),
            left=F[count:] - B[count:] @ known,
            explained=B[count:],
            weighed=weighed,
            leverage=1.0 + np.sum(weighed * B[count:], axis=1),
        )

    def left_after(self) -> Array:
        """Sum of ``1 / signal^2`` after each of the possible touches, (N,)."""
        more = np.add.reduceat(self.left**2, self.first, axis=1) / self.leverage[:, None]
        return _left_unseen(self.square + more)

    def take(self, row: int) -> None:
        """Choose a touch."""
        r, h, w = self.left[row].copy(), self.leverage[row], self.weighed[row].copy()
        self.square = self.square + np.add.reduceat(r**2, self.first) / h
        alike = self.explained @ w / h
        self.left -= alike[:, None] * r
        self.weighed -= alike[:, None] * w
        self.leverage = 1.0 + np.sum(self.weighed * self.explained, axis=1)
