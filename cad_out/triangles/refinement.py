"""Triangles without needles: every face refined in a plane chart until no angle is small.

Ruppert's refinement (J. Algorithms 18 (1995) 548): the Delaunay triangulation of the points on a
face's outline takes the circumcentre of every bad triangle as a new point, and halves a piece of
the outline instead where that point would stand in the circle over the piece. Pieces of an edge
are shared by its two faces, so the faces stay joined whatever either asks for.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.spatial import cKDTree

from matstd.cad_out.triangles.delaunay import Sheet, circumcircles, separate_centres
from matstd.twin.frames import Array

_LEAST_SINE = np.sin(np.deg2rad(20.0))  # of a chart's angles: what Ruppert's refinement reaches
_LEAST = 0.02  # mm, nothing is refined for its angles below twice this
_SHORTEST = 1e-4  # mm, of pieces that are halved until they are sides of triangles
_ONE_PLACE = 1e-3  # mm: ends of two sides that are one corner and lie so near are one place
_DIGITS = 9
"""Decimals of places in a chart, mm. Four points of one circle, as a bore has them, have two
triangulations; without these decimals the last digit decides, another one on each processor."""
_ROUNDS = 60  # 15 to 25 are usual
_ENOUGH = 0.8  # of the chord: distances between the tested points are a little larger


@dataclass(eq=False)
class Edge:
    """An edge of the body with its points."""

    at: Callable[[Array], Array]  # parameter to points, (T,) to (T, 3), mm
    t: Array  # parameters of its points in order, ends included
    ids: np.ndarray  # number of each of them among all points


@dataclass(eq=False)
class Side:
    """One side of an edge, as the outline of a face has it; the seam of a face has two."""

    edge: int
    at: Callable[[Array], Array]  # parameter of the edge to places in the chart, (T,) to (T, 2)
    t: Array = field(default_factory=lambda: np.empty(0))  # parameters whose places are known
    places: Array = field(default_factory=lambda: np.empty((0, 2)))

    def refreshed(self, t: Array) -> Array:
        """Places in the chart of all points of the edge."""
        if len(t) > len(self.t):  # an edge only gets more
            new = np.setdiff1d(t, self.t)
            self.places = np.concatenate([self.places, self.at(new)])
            self.t, order = np.unique(np.concatenate([self.t, new]), return_index=True)
            self.places = self.places[order]
        return self.places


@dataclass(eq=False)
class Face:
    """A face: a chart of its surface, its outline there, points inside."""

    point: Callable[[Array], Array]  # places in the chart to points, (N, 2) to (N, 3), mm
    sides: list[Side]  # of the outline, in any order
    is_flat: bool  # whether triangles have no distance from the surface
    is_reversed: bool  # whether the outward normal is against the chart's
    spacing: float = 0.0  # in the chart, of points to begin with; 0 for none
    # places of the points inside, (M, 2)
    inner: Array = field(default_factory=lambda: np.empty((0, 2)))
    # of the last triangulation, winding of the chart, (F, 3): into the outline's points and then
    # those inside
    triangles: np.ndarray = field(default_factory=lambda: np.empty((0, 3), dtype=int))
    # number of every point of the outline among all, (B,)
    outline: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=int))


@dataclass(frozen=True, eq=False)
class _Outline:
    places: Array  # (B, 2)
    ids: np.ndarray  # (B,)
    ends: np.ndarray  # (S, 2), into the places
    owner: np.ndarray  # (S, 2): edge, and which of its pieces

    def pieces(self, which: np.ndarray) -> set[tuple[int, int]]:
        """Some of its pieces, by edge and number."""
        return {(int(edge), int(piece)) for edge, piece in self.owner[which]}


def refined(
    corners: Array, edges: Sequence[Edge], faces: Sequence[Face], chord: float
) -> tuple[Array, np.ndarray, np.ndarray]:
    """Triangulate the faces of a body so that no triangle is a needle.

    Args:
        corners: The body's own corners, (V, 3), mm: the first numbers of all points.
        edges: With their first points; they get more.
        faces: They get their triangles.
        chord: Largest distance of triangles from the surface to aim at, mm.

    Returns:
        Corners (V, 3), triangles (F, 3) with outward winding and no corner twice, and the
        index of every triangle's face (F,).
    """
    points = _Points(corners)
    for edge in edges:
        points.fill(edge)
    users: list[set[int]] = [set() for _ in edges]
    for number, face in enumerate(faces):
        for side in face.sides:
            users[side.edge].add(number)
    for face in faces:
        _seed_points(face, edges, points)
    waiting = set(range(len(faces)))
    for _ in range(_ROUNDS):
        halve: set[tuple[int, int]] = set()
        again = set()
        for number in sorted(waiting):
            pieces, grew = _improve(faces[number], edges, points, chord)
            halve |= pieces
            again |= {number} if grew else set()
        for which in _halved(halve, edges, points):
            again |= users[which]
        # only faces that grew, or whose edges were halved, are triangulated again
        waiting = again
        if not waiting:
            break
    return _collected(points, faces)


def _seed_points(face: Face, edges: Sequence[Edge], points: "_Points") -> None:
    """Pieces and an even lattice of points at the spacing of a face, where it has one.

    Refinement alone ends at as good angles, after more rounds and with a half more triangles.
    """
    if not face.spacing:
        return
    while True:
        outline = _outline(face, edges)
        low, high = (outline.places[outline.ends[:, k]] for k in (0, 1))
        long = np.linalg.norm(high - low, axis=1) > 1.5 * face.spacing
        if not long.any():
            break
        _halved(outline.pieces(long), edges, points)
    rim = np.concatenate([outline.places, 0.5 * (low + high)])
    step = face.spacing * np.array([1.0, np.sqrt(0.75)])
    low, high = outline.places.min(axis=0), outline.places.max(axis=0)
    i, j = (np.arange(int(n) + 1) for n in (high - low) / step)
    x, y = np.meshgrid(low[0] + step[0] * i, low[1] + step[1] * j)
    x[1::2] += 0.5 * step[0]
    lattice = np.column_stack([x.ravel(), y.ravel()])
    free = cKDTree(rim).query(lattice)[0] > 0.7 * face.spacing
    inside = Sheet(outline.places, outline.ends).contains(lattice)
    face.inner = _settled(lattice[free & inside])


def _settled(places: Array) -> Array:
    """Places in a chart without what rounding leaves of equal ones."""
    return np.asarray(np.round(places, _DIGITS), dtype=np.float64)


def _halved(pieces: set[tuple[int, int]], edges: Sequence[Edge], points: "_Points") -> set[int]:
    """Halve pieces of edges; the numbers of these edges."""
    which = {edge for edge, _ in pieces}
    for edge in sorted(which):
        points.halve(edges[edge], sorted(piece for e, piece in pieces if e == edge))
    return which


class _Points:
    """All points that lie on edges, by number."""

    def __init__(self, corners: Array) -> None:
        self.xyz = np.asarray(corners, dtype=float)

    def fill(self, edge: Edge) -> None:
        """Number the points between the ends of an edge, whose numbers are known."""
        first, last = edge.ids[0], edge.ids[-1]
        new = np.arange(len(edge.t) - 2) + len(self.xyz)
        if len(new):
            self.xyz = np.concatenate([self.xyz, edge.at(edge.t[1:-1])])
        edge.ids = np.array([first, *new, last])

    def halve(self, edge: Edge, pieces: list[int]) -> None:
        """Put a point into pieces of an edge, in the middle or near it.

        The first and the last piece are cut at a power of two from the edge's end: two edges that
        meet at an acute angle there get pieces of one length and cease to halve each other.
        """
        low, high = self.xyz[edge.ids[:-1]], self.xyz[edge.ids[1:]]
        length = np.linalg.norm(high - low, axis=1)
        which = np.array([piece for piece in pieces if length[piece] > _SHORTEST], dtype=int)
        if not len(which):
            return
        share = np.full(len(which), 0.5)
        rounded = 2.0 ** np.round(np.log2(0.5 * length[which])) / length[which]
        share[which == len(length) - 1] = 1.0 - rounded[which == len(length) - 1]
        share[which == 0] = rounded[which == 0]
        middle = (1.0 - share) * edge.t[which] + share * edge.t[which + 1]
        new = np.arange(len(which)) + len(self.xyz)
        self.xyz = np.concatenate([self.xyz, edge.at(middle)])
        edge.t = np.insert(edge.t, which + 1, middle)
        edge.ids = np.insert(edge.ids, which + 1, new)


def _outline(face: Face, edges: Sequence[Edge]) -> _Outline:
    """The outline's points, without duplicates at the same place, and its pieces."""
    places = [side.refreshed(edges[side.edge].t) for side in face.sides]
    ids = [edges[side.edge].ids for side in face.sides]
    counts = [len(i) for i in ids]
    starts = np.cumsum([0, *counts[:-1]])
    ends = np.concatenate(
        [
            np.column_stack([np.arange(n - 1), np.arange(1, n)]) + s
            for s, n in zip(starts, counts, strict=True)
        ]
    )
    owner = np.concatenate(
        [
            np.column_stack([np.full(n - 1, side.edge), np.arange(n - 1)])
            for side, n in zip(face.sides, counts, strict=True)
        ]
    )
    every, number = _settled(np.concatenate(places)), np.concatenate(ids)
    # only where sides end can two of their points be one
    tips = np.unique(np.concatenate([starts, starts + counts - 1]))
    apart_by = np.linalg.norm(every[tips][:, None] - every[tips], axis=2)
    same = (apart_by < _ONE_PLACE) & (number[tips][:, None] == number[tips])
    one = np.arange(len(every))
    one[tips] = tips[np.argmax(same, axis=1)]
    used, back = np.unique(one, return_inverse=True)
    return _Outline(every[used], number[used], back[ends], owner)


def _improve(
    face: Face, edges: Sequence[Edge], points: _Points, chord: float
) -> tuple[set[tuple[int, int]], bool]:
    """Triangulate a face; returns pieces (edge, index) to halve, and whether points were added."""
    outline = _outline(face, edges)
    ends = outline.ends
    places = np.concatenate([outline.places, face.inner])
    ends_xyz = points.xyz[outline.ids[ends]]
    may = np.linalg.norm(ends_xyz[:, 1] - ends_xyz[:, 0], axis=1) > 2.0 * _LEAST
    sheet = Sheet(places, ends)
    if sheet.lost.any():
        return outline.pieces(sheet.lost), False
    face.triangles, face.outline = sheet.triangles, outline.ids
    if (sheet.encroached & may).any():
        return outline.pieces(sheet.encroached & may), False
    corner, worst = places[face.triangles], _LEAST_SINE / np.maximum(sheet.sines(), 1e-12)
    side = np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=2).min(axis=1)
    worst[side < 2.0 * _LEAST] = 0.0
    if not face.is_flat:
        xyz = np.concatenate([points.xyz[outline.ids], face.point(face.inner)])
        sags = _sags(face, corner, xyz[face.triangles])
        worst = np.maximum(worst, sags / (_ENOUGH * chord))
    order = np.argsort(-worst, kind="stable")[: np.count_nonzero(worst > 1.0)]
    if not len(order):
        return set(), False
    centre, radius = circumcircles(corner[order])
    outside = ~sheet.contains(centre)  # of an outline whose pieces there are too short to halve
    struck = np.zeros(len(centre), dtype=bool)
    hit = np.zeros(len(ends), dtype=bool)
    low, high = places[ends[:, 0]], places[ends[:, 1]]
    half = 0.4999999 * np.linalg.norm(high - low, axis=1)
    for k, found in enumerate(cKDTree(centre).query_ball_point(0.5 * (low + high), half)):
        hit[k] = bool(found) and may[k]
        struck[found] = True
    centre[outside] = corner[order][outside].mean(axis=1)
    new = centre[~struck][separate_centres(centre[~struck], radius[~struck])]
    face.inner = np.concatenate([face.inner, _settled(new)])
    return outline.pieces(hit), bool(len(new))


_BETWEEN = np.array([[2, 2, 2], [3, 3, 0], [0, 3, 3], [3, 0, 3]]) / 6.0


def _sags(face: Face, corner: Array, xyz: Array) -> Array:
    """Largest distance of triangles from their surface, (F,), mm."""
    normal = np.cross(xyz[:, 1] - xyz[:, 0], xyz[:, 2] - xyz[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    between = np.einsum("pk,fki->fpi", _BETWEEN, corner)
    on = face.point(between.reshape(-1, 2)).reshape(len(corner), -1, 3)
    return np.abs(np.einsum("fpi,fi->fp", on - xyz[:, :1], normal)).max(axis=1)


def _collected(points: _Points, faces: Sequence[Face]) -> tuple[Array, np.ndarray, np.ndarray]:
    corners, triangles, owner = [points.xyz], [], []
    count = len(points.xyz)
    for number, face in enumerate(faces):
        inner = np.arange(len(face.inner)) + count
        mine = np.concatenate([face.outline, inner])[face.triangles]
        triangles.append(mine[:, ::-1] if face.is_reversed else mine)
        owner.append(np.full(len(mine), number))
        corners.append(face.point(face.inner))
        count += len(inner)
    return np.concatenate(corners), np.concatenate(triangles), np.concatenate(owner)
