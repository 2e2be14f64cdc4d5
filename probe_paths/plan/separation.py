"""How far convex bodies are apart, many pairs at once: cylinders that move, and what stands.

A cylinder that is shifted along a straight line sweeps out a convex body, so one look decides a
whole move of the linear axes. The distance of two convex bodies is that of the origin from the hull
of their differences; it is found with nothing but their farthest points in a direction (Gilbert,
Johnson and Keerthi, IEEE J. Robotics and Automation 4 (1988) 193). Every such point gives a plane
between the bodies as well, and with it a gap that is never too large.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from matstd.twin.frames import Array, IntArray, Mask
from matstd.twin.rows import picked

CORNERS = 8  # most corners of a body
EXACT = 0.01  # accuracy of a gap that matters, mm
_ROUNDS = 60  # of the search; cylinders beside cylinders took up to 35
_INSIDE = 1e-7  # mm: nearer than this the bodies are in each other
_NOISE = 1e-9  # of a direction across an axis, in mm as all directions here: rounding is 1e-14
_SUBSETS = [pick for k in (1, 2, 3) for pick in combinations(range(3), k)]


@dataclass(frozen=True, eq=False)
class Hulls:
    """B convex bodies: hulls of discs round their corners, all of them swollen by a ball."""

    corner: Array  # corners, some of them the same, (B, CORNERS, 3), mm
    disc: Array  # radius of the disc round every corner, square to `up`, (B, CORNERS), mm
    up: Array  # axis of the discs, (B, 3)
    ball: Array  # by which the whole is swollen, (B,), mm

    def __len__(self) -> int:
        return len(self.ball)

    def __getitem__(self, rows: IntArray) -> "Hulls":
        return picked(self, rows)

    def farthest(self, direction: Array) -> Array:
        """Point of each body without its ball farthest in a direction (B, 3), (B, 3)."""
        along = np.einsum("bi,bi->b", direction, self.up)
        across = direction - along[:, None] * self.up
        size = np.linalg.norm(across, axis=1)
        reach = np.einsum("bki,bi->bk", self.corner, direction) + self.disc * size[:, None]
        row, best = np.arange(len(self)), np.argmax(reach, axis=1)
        share = self.disc[row, best] * _inverted(size)
        return self.corner[row, best] + share[:, None] * across


@dataclass(frozen=True, eq=False)
class Sweeps:
    """M cylinders (or balls) on their way."""

    centre: Array  # ball centre of the tool at the beginning, (M, 3), mm
    axis: Array  # unit vector from there to the spindle, (M, 3)
    way: Array  # straight way that is made, (M, 3), mm
    low: Array  # where the cylinder begins on the axis, (M,), mm
    high: Array  # where it ends, (M,), mm
    radius: Array  # radius of the cylinder, (M,), mm
    ball: Array  # by which it is swollen, (M,), mm

    def __len__(self) -> int:
        return len(self.ball)

    def __getitem__(self, rows: IntArray) -> "Sweeps":
        return picked(self, rows)

    @property
    def middle(self) -> Array:
        """Middle of each, (M, 3), mm."""
        along: Array = 0.5 * (self.low + self.high)
        return self.centre + along[:, None] * self.axis + 0.5 * self.way

    def farthest(self, direction: Array) -> Array:
        """Point of each without its ball farthest in a direction (M, 3), (M, 3)."""
        along = np.einsum("mi,mi->m", direction, self.axis)
        across = direction - along[:, None] * self.axis
        share = self.radius * _inverted(np.linalg.norm(across, axis=1))
        height = np.where(along > 0.0, self.high, self.low)
        is_end = np.einsum("mi,mi->m", direction, self.way) > 0.0
        return (
            self.centre
            + height[:, None] * self.axis
            + share[:, None] * across
            + is_end[:, None] * self.way
        )


def balls_apart(sweeps: Sweeps, hulls: Hulls) -> Array:
    """Gap of each sweep from the ball round the body of the same row, (M,), mm; never too large.

    A sweep is seen as a capsule here, as wide on all sides as half of its way is long.
    """
    middle = hulls.corner.mean(axis=1)
    wide = np.linalg.norm(hulls.corner - middle[:, None], axis=2) + hulls.disc
    off = middle - sweeps.centre - 0.5 * sweeps.way
    along = np.einsum("mi,mi->m", off, sweeps.axis)
    off -= np.clip(along, sweeps.low, sweeps.high)[:, None] * sweeps.axis
    reach = sweeps.radius + sweeps.ball + 0.5 * np.linalg.norm(sweeps.way, axis=1)
    return np.asarray(np.linalg.norm(off, axis=1) - reach - wide.max(axis=1) - hulls.ball)


def least_gaps(
    bound: Array, group: IntArray, enough: Array, search: Callable[[IntArray, Array], Array]
) -> Array:
    """Gaps of which only the least of every group matters, (M,), mm: that one as of `gaps`.

    The body whose ball is nearest is searched first: no other that is farther away needs a search.
    Of 240 bodies and parts at a position of a probing program, 4 remain.

    Args:
        bound: Gaps that are never too large, (M,), mm.
        group: Of every row, (M,), from 0.
        enough: As of `gaps`, (M,), alike within a group.
    """
    gap, limit = bound.copy(), enough.copy()
    order = np.lexsort((gap, group))
    nearest = order[np.unique(group[order], return_index=True)[1]]
    for rows in (nearest, np.arange(len(gap))):
        rows = rows[gap[rows] < limit[rows]]
        gap[rows] = np.maximum(gap[rows], search(rows, limit[rows]))
        least = np.full(int(group.max(initial=-1)) + 1, np.inf)
        np.minimum.at(least, group[rows], gap[rows])
        limit = np.minimum(limit, least[group])
    return gap


def _inverted(size: Array) -> Array:
    """1 / size; zero for a size within rounding."""
    return np.where(size > _NOISE, 1.0 / np.maximum(size, _NOISE), 0.0)


def gaps(sweeps: Sweeps, hulls: Hulls, enough: Array | float) -> Array:
    """Gap of each sweep from the body of the same row, (M,), mm.

    Args:
        enough: A gap that is larger need not be known better than that, mm, of every row
            or of all.

    Returns:
        Never too large, and too small by `EXACT` at most where it is less than `enough`; zero for
        bodies that are in each other.
    """
    swell = sweeps.ball + hulls.ball
    v = sweeps.middle - hulls.corner.mean(axis=1)
    v = np.where(np.linalg.norm(v, axis=1)[:, None] > _INSIDE, v, [0.0, 0.0, 1.0])
    lower, most = np.full(len(v), -np.inf), np.broadcast_to(enough, len(v))
    old, has = np.zeros((len(v), 3, 3)), np.zeros((len(v), 3), dtype=bool)
    # the first direction is no point of the difference: it counts as infinitely far away
    upper = np.full(len(v), np.inf)
    active = np.arange(len(v))
    for _ in range(_ROUNDS):
        w = sweeps[active].farthest(-v[active]) - hulls[active].farthest(v[active])
        size = np.linalg.norm(v[active], axis=1)
        plane = np.einsum("mi,mi->m", v[active], w) / size
        lower[active] = np.maximum(lower[active], plane)
        gap = lower[active] - swell[active]
        is_open = (gap < most[active]) & (upper[active] - lower[active] > EXACT)
        active, w = active[is_open], w[is_open]
        if not len(active):
            break
        nearest, old[active], has[active] = _nearest(old[active], has[active], w)
        size = np.linalg.norm(nearest, axis=1)
        is_better = size < upper[active] - 1e-12
        upper[active] = np.minimum(upper[active], size)
        v[active] = nearest
        active = active[is_better & (size > _INSIDE)]
    lower = np.where(upper <= _INSIDE, 0.0, lower)
    return np.maximum(lower - swell, 0.0)


def _nearest(old: Array, has: Mask, w: Array) -> tuple[Array, Array, Mask]:
    """Point nearest to the origin of the hull of `w` (M, 3) and up to three old points (M, 3, 3).

    Returns:
        That point (M, 3), and the points whose hull it is in, three of which are kept, with a mask.
    """
    edge = old - w[:, None]
    gram = np.einsum("mik,mjk->mij", edge, edge)
    right = -np.einsum("mik,mk->mi", edge, w)
    best, smallest = np.zeros((len(w), 3)), np.einsum("mi,mi->m", w, w)
    point = w.copy()
    for pick in _SUBSETS:
        i = np.array(pick)
        share = _solved(gram[:, i[:, None], i], right[:, i])
        # points in a line or a plane have no solution of their own: a smaller set has it
        finite = np.asarray(np.isfinite(share).all(axis=1))
        share = np.where(finite[:, None], share, -1.0)
        good = has[:, i].all(axis=1) & (share >= 0.0).all(axis=1) & (share.sum(axis=1) <= 1.0)
        there = w + np.einsum("mi,mik->mk", share, edge[:, i])
        size = np.einsum("mi,mi->m", there, there)
        better = np.flatnonzero(good & (size < smallest))
        smallest[better], point[better] = size[better], there[better]
        best[better] = 0.0
        best[better[:, None], i] = share[better]
    keep = best > 0.0
    # the new point takes the place of one that is not needed; if all are, the origin is inside
    free = np.argmin(keep, axis=1)
    row = np.arange(len(w))
    old, keep = old.copy(), keep.copy()
    old[row, free], keep[row, free] = w, True
    return point, old, keep


def _solved(gram: Array, right: Array) -> Array:
    """Solutions of small positive systems (M, k, k), k up to 3; nan where they have none."""
    k = right.shape[1]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        if k == 1:
            return right / gram[:, :, 0]
        if k == 2:
            a, b, d = gram[:, 0, 0], gram[:, 0, 1], gram[:, 1, 1]
            determinant = a * d - b * b
            x, y = d * right[:, 0] - b * right[:, 1], a * right[:, 1] - b * right[:, 0]
            return np.column_stack([x, y]) / determinant[:, None]
        adjoint = np.stack([np.cross(gram[:, (i + 1) % 3], gram[:, (i + 2) % 3]) for i in range(3)])
        determinant = np.einsum("mi,mi->m", gram[:, 0], adjoint[0])
        return np.einsum("imk,mi->mk", adjoint, right) / determinant[:, None]
