"""Choosing groups of touches: patches of a standard, table poses."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from matstd.information.criteria import DesignCriterion, Tangent
from matstd.information.selection.touch_selection import level
from matstd.twin.compute import blocks
from matstd.twin.frames import Array, IntArray, Mask

_GROUPS_A_BLOCK, _ROWS_A_BLOCK = 10, 4000  # looked at together: in the cache


def best_groups(
    criterion: DesignCriterion,
    W: Array,
    group: IntArray,
    count: int,
    take: int,
    start: Array | None = None,
    apart: Mask | None = None,
    begin: Sequence[int] = (),
) -> list[int]:
    """Choose groups of rows that belong together (the touches of a patch, of a table pose).

    A group is worth what its `take` most useful rows bring, useful as seen from the groups chosen
    before it; greedy, then every chosen group is once weighed against all that are left out.

    Args:
        W: Rows in the directions that matter, (N, R).
        group: Of every row, (N,), from 0.
        take: Rows that a group will contribute.
        start: W^T W of what is measured anyway, (R, R).
        apart: Which groups may stand beside each other, (groups, groups); None for all.
        begin: Groups that are chosen before the others and exchanged like them.

    Returns:
        The chosen groups, in the order of choice; fewer than `count` where no other fits.
    """
    nothing = np.zeros((criterion.size, criterion.size))
    board = _Groups(criterion, W, group, take, nothing if start is None else start)
    fits = np.ones((board.count, board.count), dtype=bool)
    if apart is not None:  # the last groups may have no rows
        fits = apart[: board.count, : board.count]
    chosen: list[int] = []
    for k in begin:
        board.best(chosen, fits, only=k)
        chosen.append(k)
    while len(chosen) < count:
        best = board.best(chosen, fits)
        if best is None:
            break
        chosen.append(best)
    for i in range(len(chosen)):
        others = chosen[:i] + chosen[i + 1 :]
        better = board.best(others, fits)
        assert better is not None  # the one that was taken out fits again
        chosen[i] = better
    return chosen


class _Groups:
    """Information that groups of rows bring."""

    def __init__(
        self, criterion: DesignCriterion, W: Array, group: IntArray, take: int, start: Array
    ) -> None:
        self.criterion, self.take, self.start = criterion, take, start
        order = np.argsort(group, kind="stable")
        self.W = W[order]
        self.count = int(group.max(initial=-1)) + 1
        self.edges = np.searchsorted(group[order], np.arange(self.count + 1))
        self.brought: dict[int, Array] = {}

    def best(self, chosen: list[int], fits: Mask, only: int | None = None) -> int | None:
        """The group that helps most beside those chosen, and whose rows are then remembered."""
        sizes = np.diff(self.edges)
        free = (np.all(fits[chosen], axis=0) if chosen else np.ones(self.count, bool)) & (sizes > 0)
        free[chosen] = False
        if only is not None:
            free = (np.arange(self.count) == only) & (sizes > 0)
        if not free.any():
            return None
        W = self.W if free.all() else self.W[np.repeat(free, sizes)]
        edges = np.concatenate([[0], np.cumsum(sizes[free])])
        information: Array = self.start.copy()
        for k in chosen:
            information = information + self.brought[k]
        tangents = self.criterion.tangents(information)
        unit = np.eye(self.criterion.size)
        # takes a third of the time of solving for every row
        inverses = [np.linalg.solve(p + information, unit) for p in self.criterion.prior]
        reaches, gain = np.empty((len(inverses), *W.shape)), np.zeros(len(W))
        for reach, inverse, tangent in zip(reaches, inverses, tangents, strict=True):
            for some in blocks(len(W), _ROWS_A_BLOCK):
                mine = np.matmul(W[some], inverse, out=reach[some])
                leverage = np.einsum("nr,nr->n", mine, W[some])
                gain[some] += tangent.fall(tangent.numerators(mine, leverage), leverage)
        top = self._most_useful(edges, level(gain, gain.max()))
        fall = np.zeros(len(top))
        for reach, tangent in zip(reaches, tangents, strict=True):
            for some in blocks(len(top), _GROUPS_A_BLOCK):
                fall[some] += self._falls(W, top[some], reach, tangent)
        i = int(np.argmax(level(fall, fall.max())))
        rows = W[top[i][top[i] >= 0]]
        best = int(np.flatnonzero(free)[i])
        self.brought[best] = rows.T @ rows
        return best

    def _most_useful(self, edges: IntArray, gain: Array) -> IntArray:
        """The rows of largest gain of every group, (groups, take); -1 where one has fewer."""
        out = np.full((len(edges) - 1, self.take), -1)
        for i, (first, end) in enumerate(pairwise(edges.tolist())):
            rows = first + np.argsort(-gain[first:end], kind="stable")[: self.take]
            out[i, : len(rows)] = rows
        return out

    def _falls(self, W: Array, top: IntArray, reach: Array, tangent: Tangent) -> Array:
        """Fall of the tangent with the rows of every group, (groups,)."""
        there = (top >= 0)[:, :, None]
        w, v = np.where(there, W[top], 0.0), np.where(there, reach[top], 0.0)
        return tangent.group_fall(v, np.eye(self.take) + v @ np.swapaxes(w, 1, 2))
