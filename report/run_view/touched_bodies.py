"""What was touched, as triangles: a run file knows points and normals, not the standard.

A feature whose points lie a radius along their normals from one centre is drawn as that ball;
another one as the surface between its points.
"""

import numpy as np
from scipy.spatial import Delaunay, QhullError

from matstd.twin.frames import Array, outward
from matstd.twin.record import Touches

MIN_POINTS = 4  # distinct points of a feature from which a surface is drawn between them
MAX_MISFIT = 0.05  # distance of a point from the ball that is drawn through it, mm
MIN_TURN = 0.3  # spread of normals from which a feature can be a ball
MAX_RADIUS = 60.0  # of a ball, mm; larger ones are faces that bend
MERIDIANS = 16  # meridians of a ball

MOST_TRIANGLES = 20_000
"""Of all features together; of more, every second, third ... point is left out."""

SURFACE_DEPTH = 0.15  # depth of surfaces below their points, mm, so that these stand before them


def touched_bodies(touches: Touches) -> list[Array]:
    """Triangles (T, 3, 3) of every feature, artefact frame, mm; some have none."""
    out = []
    names = list(dict.fromkeys(touches.feature.tolist()))
    every = -(-2 * len(touches) // MOST_TRIANGLES)  # rounded up
    for name in names:
        rows = np.flatnonzero(touches.feature == name)
        point, normal = touches.point[rows], touches.normal[rows]
        ball = _ball(point, normal)
        if ball is not None:
            out.append(_sphere(*ball))
            continue
        _, first = np.unique(np.round(point, 3), axis=0, return_index=True)
        mesh = _surface(point[first[::every]], normal[first[::every]])
        if len(mesh):
            out.append(mesh)
    return out


def _ball(point: Array, normal: Array) -> tuple[Array, float] | None:
    """Centre and radius of ``p = c + r n``; None where that is no ball."""
    mean = normal.mean(axis=0)
    spread = normal - mean
    squared = float((spread**2).sum())
    if len(point) < MIN_POINTS or squared < MIN_TURN**2 * len(point):
        return None
    radius = float((spread * (point - point.mean(axis=0))).sum() / squared)
    centre = point.mean(axis=0) - radius * mean
    left = np.linalg.norm(point - centre - radius * normal, axis=1)
    if not 0.0 < radius < MAX_RADIUS or left.max() > MAX_MISFIT:
        return None
    return centre, radius


def _sphere(centre: Array, radius: float) -> Array:
    """Triangles of a ball."""
    turn = np.linspace(0.0, 2.0 * np.pi, MERIDIANS + 1)
    tilt = np.linspace(-0.5 * np.pi, 0.5 * np.pi, MERIDIANS // 2 + 1)
    T, L = np.meshgrid(turn, tilt, indexing="ij")
    grid = centre + (radius - SURFACE_DEPTH) * outward(T, L)
    a, b, c, d = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
    return np.concatenate([np.stack(t, axis=2).reshape(-1, 3, 3) for t in ((a, b, c), (a, c, d))])


def _surface(point: Array, normal: Array) -> Array:
    """Triangles between points seen along their mean normal; those along the rim are left out."""
    none = np.zeros((0, 3, 3))
    mean = normal.mean(axis=0)
    size = float(np.linalg.norm(mean))
    if len(np.unique(point, axis=0)) < MIN_POINTS or size < MIN_TURN:
        return none
    axes = np.linalg.svd((mean / size)[None])[2][1:]
    flat = (point - point.mean(axis=0)) @ axes.T
    try:
        found = Delaunay(flat).simplices
    except QhullError:  # on a line
        return none
    sides = np.linalg.norm(flat[found] - flat[np.roll(found, 1, axis=1)], axis=2)
    longest = sides.max(axis=1)
    kept = found[longest < 4.0 * np.median(longest)]
    return np.asarray((point - SURFACE_DEPTH * normal)[kept])
