"""Delaunay triangles in an outline in a plane.

The points are triangulated together with four far corners, without regard to the outline. Where the
outline is made of sides of triangles it separates them into rooms; a room is inside if an odd
number of crossings leads to it from outside.
"""

from functools import cached_property

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import Delaunay, cKDTree

from matstd.twin.frames import Array

_FAR = 3.0 * np.array([[-1.0, -1.1], [1.2, -1.0], [1.0, 1.3], [-1.1, 1.0]])
"""Corners far outside, so that the outside is connected."""

_AT_ONCE = 1024  # places that are compared with an outline together


class Sheet:
    """Delaunay triangulation of points in a plane, and the pieces of an outline in it.

    Attributes:
        ends: Pieces of the outline, (S, 2), into the places.
        wall: Piece that the side of a triangle opposite each of its corners is, or -1, (T, 3).
    """

    def __init__(self, places: Array, ends: np.ndarray) -> None:
        self.places, self.ends = places, ends
        low, high = places.min(axis=0), places.max(axis=0)
        far = 0.5 * (low + high) + (high - low).max() * _FAR
        self._whole = Delaunay(np.concatenate([places, far]))
        walls = self._codes(ends[:, 0], ends[:, 1])
        order = np.argsort(walls)
        t = self._whole.simplices
        sides = self._codes(t[:, [1, 2, 0]], t[:, [2, 0, 1]])
        at = np.minimum(np.searchsorted(walls[order], sides), len(walls) - 1)
        self.wall = np.where(walls[order][at] == sides, order[at], -1)

    def _codes(self, one: np.ndarray, other: np.ndarray) -> np.ndarray:
        """One number for every unordered pair."""
        low = np.minimum(one, other).astype(np.int64)
        return low * (len(self.places) + len(_FAR)) + np.maximum(one, other)

    @cached_property
    def lost(self) -> np.ndarray:
        """Pieces of the outline that are no side of any triangle, (S,)."""
        lost = np.ones(len(self.ends), dtype=bool)
        lost[self.wall[self.wall >= 0]] = False
        return lost

    @cached_property
    def inside(self) -> np.ndarray:
        """Mask of triangles inside the outline, by the parity of crossings, (T,)."""
        beside, is_wall = self._whole.neighbors, self.wall >= 0
        free = (beside >= 0) & ~is_wall
        rows = np.concatenate([[0], np.cumsum(free.sum(axis=1))])
        ways = csr_array((np.ones(rows[-1]), beside[free], rows), shape=(len(beside),) * 2)
        count, room = connected_components(ways, directed=False)
        row, k = np.nonzero(is_wall)
        here, there = room[row], room[beside[row, k]]
        crossings = np.full(count, -1)
        crossings[room[np.flatnonzero(beside.min(axis=1) < 0)[0]]] = 0
        while (new := (crossings[here] >= 0) & (crossings[there] < 0)).any():
            crossings[there[new]] = 1 + crossings[here[new]]
        return crossings[room] % 2 == 1

    @cached_property
    def triangles(self) -> np.ndarray:
        """Triangles inside, counter-clockwise, (F, 3)."""
        t: np.ndarray = self._whole.simplices[self.inside]
        a, b, c = (self.places[t[:, k]] for k in range(3))
        back = cross(b - a, c - a) < 0.0
        t[back] = t[back][:, ::-1]
        return t

    @cached_property
    def encroached(self) -> np.ndarray:
        """Pieces whose diametral circle contains the apex of an inner triangle on them, (S,)."""
        t, wall = self._whole.simplices[self.inside], self.wall[self.inside]
        row, k = np.nonzero(wall >= 0)
        apex = self.places[t[row, k]]
        one = self.places[t[row, (k + 1) % 3]] - apex
        other = self.places[t[row, (k + 2) % 3]] - apex
        seen = np.zeros(len(self.ends), dtype=bool)
        seen[wall[row, k][np.einsum("ni,ni->n", one, other) < 0.0]] = True
        return seen

    def sines(self) -> Array:
        """Sine of the smallest angle of every triangle inside, 1 where the outline has it."""
        wall = self.wall[self.inside] >= 0
        corner = self.places[self._whole.simplices[self.inside]]
        side = corner[:, [2, 0, 1]] - corner[:, [1, 2, 0]]  # opposite of each corner
        length = np.linalg.norm(side, axis=2)
        row, sharp = np.arange(len(side)), np.argmin(length, axis=1)
        one, other = (sharp + 1) % 3, (sharp + 2) % 3
        along = np.maximum(length[row, one] * length[row, other], 1e-300)
        sine = np.abs(cross(side[:, 0], side[:, 1])) / along
        return np.where(wall[row, one] & wall[row, other], 1.0, sine)

    def contains(self, places: Array) -> np.ndarray:
        """Whether places lie inside the outline, (N,): a ray to the right leaves it oddly often.

        A search in the triangles falls back to trying all of them where some are flat, as beside
        a straight outline: 0.2 s a call on a large face.
        """
        a, b = self.places[self.ends[:, 0]], self.places[self.ends[:, 1]]
        level = a[:, 1] == b[:, 1]
        a, b = a[~level], b[~level]
        slope = (b[:, 0] - a[:, 0]) / (b[:, 1] - a[:, 1])
        inside = np.empty(len(places), dtype=bool)
        for begin in range(0, len(places), _AT_ONCE):
            x, y = places[begin : begin + _AT_ONCE].T[:, :, None]
            beside = (a[:, 1] <= y) != (b[:, 1] <= y)
            to_right = a[:, 0] + slope * (y - a[:, 1]) > x
            inside[begin : begin + _AT_ONCE] = np.sum(beside & to_right, axis=1) % 2 == 1
        return inside


def cross(a: Array, b: Array) -> Array:
    """Third components of the cross products of plane vectors, (N,)."""
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


def circumcircles(corner: Array) -> tuple[Array, Array]:
    """Centres (F, 2) and radii (F,) of the circles through plane triangles (F, 3, 2)."""
    a = corner[:, 0]
    b, c = corner[:, 1] - a, corner[:, 2] - a
    twice = 2.0 * cross(b, c)
    bb, cc = (b**2).sum(axis=1), (c**2).sum(axis=1)
    x = (c[:, 1] * bb - b[:, 1] * cc) / twice
    y = (b[:, 0] * cc - c[:, 0] * bb) / twice
    return a + np.column_stack([x, y]), np.hypot(x, y)


def separate_centres(centre: Array, radius: Array) -> np.ndarray:
    """Mask of candidates, in their order, outside the circles of those already taken, (C,)."""
    keep = np.ones(len(centre), dtype=bool)
    if not len(centre):
        return keep
    near = cKDTree(centre).query_ball_point(centre, 0.9 * radius)
    for k, found in enumerate(near):
        if keep[k]:
            later = np.array(found)
            keep[later[later > k]] = False
    return keep
