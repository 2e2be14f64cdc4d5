"""Reach of cutters with their holders to every surface of a body.

Surfaces are sampled by points. The tool is a stack of cylinders, sampled by rings of points; it is
free where none of them lies in milled material.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np

from matstd.artefact.body import BLEND, FreeformPatch, Standard, min_concave_radius
from matstd.artefact.brief import FINISHING_RADIUS
from matstd.cad_out.details import Details
from matstd.twin.frames import Array
from matstd.twin.sampling import grid_points
from matstd.twin.units import DEG

RADIUS, OVERHANG = FINISHING_RADIUS, 60.0
"""Of the finishing ball-end mill, and its overhang from the holder: 10 D, mm."""

LONGER = (80.0, 100.0, 120.0)  # overhangs that are tried where the usual one is too short, mm
CUTTERS = (20.0, 16.0, 12.0, 10.0, 8.0, 6.0)  # diameters of ball-end mills, mm
TILTS = (15.0 * DEG, 30.0 * DEG, 45.0 * DEG)  # of the cutter's axis
_HOLDER = ((60.0, 13.5), (130.0, 25.0))  # mm from the ball's centre, radius: a shrink-fit holder
_SPINDLE_DISTANCE = 220.0  # mm from the ball's centre to what is beside the spindle
_SHARE = 0.8  # of the least concave radius that a cutter may have
_SLACK = 0.1  # mm by which a shank that runs along a wall may seem to be in it
_AZIMUTHS = 8


@dataclass(frozen=True, eq=False)
class Cutting:
    """What cutters make of a body."""

    points: dict[str, int]  # number of surface points tested, by kind
    upright: float  # share of them that the finishing cutter reaches from above
    tilted: float  # share that it reaches with its axis tilted by 45 degrees at most
    out_of_reach: tuple[str, ...]  # features with a point that it does not reach at all
    # the least with which it reaches everything, mm; infinite if none of `LONGER` does
    overhang: float
    # largest ball-end mill for every face, its diameter, mm; 0 where none fits. It stays within
    # `_SHARE` of the concave radius between the edges, and fits beyond them
    cutter: dict[str, float]
    radius: dict[str, float]  # least concave radius of every face between its edges, mm
    # the same of the untrimmed spline, over which a cutter may leave, mm
    whole_radius: dict[str, float]


def cutting_of(standard: Standard, details: Details) -> Cutting:
    """Reach of cutters to samples of faces, walls, posts, feet and plate; bores are drilled.

    A ball-end mill cuts with its ball; shank, holder and nose are checked against all milled
    material, without the balls, which are glued in later.
    """
    name, points, normals = _surface(standard, details)
    centre = points + (RADIUS + 0.01) * normals
    upright = is_free(standard, centre, np.array([0.0, 0.0, 1.0]))
    reached = upright | _reached_when_tilted(standard, centre, ~upright, OVERHANG)
    left, overhang = ~reached, OVERHANG
    for longer in LONGER:
        if left.any():
            overhang = longer
            left &= ~_reached_when_tilted(standard, centre, left, overhang)
    radius = {patch.name: min_concave_radius(patch) for patch in standard.patches}
    whole = {patch.name: untrimmed_radius(patch) for patch in standard.patches}
    kinds = [n.split()[-1] if " " in n else n[:2] for n in name]
    return Cutting(
        points={kind: kinds.count(kind) for kind in sorted(set(kinds))},
        upright=float(upright.mean()),
        tilted=float(reached.mean()),
        out_of_reach=tuple(sorted(set(name[~reached].tolist()))),
        overhang=float("inf") if left.any() else overhang,
        cutter={n: _largest_cutter(radius[n], whole[n]) for n in radius},
        radius=radius,
        whole_radius=whole,
    )


def _reached_when_tilted(
    standard: Standard, centre: Array, wanted: np.ndarray, overhang: float
) -> np.ndarray:
    """Mask of the wanted places that the finishing cutter reaches, upright or tilted, (N,)."""
    reached = np.zeros(len(centre), dtype=bool)
    for tilt, turn in product((0.0, *TILTS), np.arange(_AZIMUTHS) * 2.0 * np.pi / _AZIMUTHS):
        left = np.flatnonzero(wanted & ~reached)
        if not len(left):
            break
        if tilt or not turn:
            across = np.sin(tilt)
            axis = np.array([across * np.cos(turn), across * np.sin(turn), np.cos(tilt)])
            reached[left] = is_free(standard, centre[left], axis, overhang)
    return reached


def _largest_cutter(radius: float, whole: float) -> float:
    """Diameter of the largest ball-end mill for concave radii, mm; 0 where none fits."""
    most = min(2.0 * _SHARE * radius, 2.0 * whole)
    return next((d for d in CUTTERS if d <= most), 0.0)


def untrimmed_radius(patch: FreeformPatch) -> float:
    """Least concave radius over the whole spline, its overhang included, mm."""
    low, high = patch.domain
    axes = [np.linspace(a, b, 61) for a, b in zip(low, high, strict=True)]
    uv = grid_points(*axes)
    largest = float(patch.curvature(uv)[:, 0].max())
    return 1.0 / largest if largest > 1e-9 else float("inf")


def _surface(standard: Standard, details: Details) -> tuple[np.ndarray, Array, Array]:
    """Owner, place and outward normal of samples, each (N, ...)."""
    lots: list[tuple[str, Array, Array]] = []
    top, up = standard.base.thickness, np.array([0.0, 0.0, 1.0])
    for patch in standard.patches:
        uv = patch.grid(8.0)
        lots.append((patch.name, patch.point(uv), patch.normal(uv)))
        if patch.is_upright:
            lots += _walls(patch, top)
    for ball in standard.spheres:
        seat = details.seats[ball.name]
        for share in (0.0, 0.4, 0.9):
            z = top + BLEND + share * (seat.top - top - BLEND)
            slope = (ball.foot_radius - ball.stem_radius) / (ball.centre[2] - ball.foot)
            r = ball.foot_radius - slope * (z - ball.foot)
            for angle in np.arange(8) * np.pi / 4.0:
                out = np.array([np.cos(angle), np.sin(angle), slope])
                place = np.array([*ball.centre[:2], z]) + r * np.array([*out[:2], 0.0])
                lots.append((f"{ball.name} post", place[None], (out / np.linalg.norm(out))[None]))
    a, b = (half - 5.0 for half in standard.base.half_size)
    axes = [np.linspace(-h, h, int(2 * h // 12) + 1) for h in (a, b)]
    plate = grid_points(*axes)
    on_top = np.column_stack([plate, np.full(len(plate), top)])
    others = [body for name, body in standard.bodies.items() if name != "BASE"]
    # 0.1 mm above and below decide whether a place is bare and on the plate
    above, below = on_top + 0.1 * up, on_top - 0.1 * up
    bare = np.min([body.distance(above) for body in others], axis=0) > BLEND
    inside = standard.base.body.distance(below) < 0.0
    lots.append(("DATUM_A", on_top[bare & inside], np.tile(up, (int((bare & inside).sum()), 1))))
    name = np.concatenate([np.full(len(p), n, dtype="<U40") for n, p, _ in lots])
    return name, np.concatenate([p for _, p, _ in lots]), np.concatenate([n for _, _, n in lots])


def _walls(patch: FreeformPatch, top: float) -> list[tuple[str, Array, Array]]:
    """Samples of a pillar's walls from its blend to its edge."""
    out = []
    for axis, sign in product((0, 1), (-1.0, 1.0)):
        uv = np.zeros((5, 2))
        uv[:, axis] = sign * patch.half_size[axis]
        uv[:, 1 - axis] = np.linspace(-0.95, 0.95, 5) * patch.half_size[1 - axis]
        edge = patch.point(uv)
        normal = np.zeros(3)
        normal[axis] = sign
        for share in (0.0, 0.5, 1.0):
            points = edge.copy()
            points[:, 2] = top + BLEND + share * (edge[:, 2] - 0.2 - top - BLEND)
            out.append((f"{patch.name} wall", points, np.tile(normal, (5, 1))))
    return out


def is_free(
    standard: Standard, centre: Array, axis: Array, overhang: float = OVERHANG
) -> np.ndarray:
    """Whether shank, holder and nose of a tool keep out of everything that is milled, (N,)."""
    balls = {ball.name for ball in standard.spheres}
    side = np.cross(axis, [0.0, 1.0, 0.0] if abs(axis[1]) < 0.9 else [1.0, 0.0, 0.0])
    side /= np.linalg.norm(side)
    other = np.cross(axis, side)
    free = np.ones(len(centre), dtype=bool)
    pieces = [(RADIUS, overhang, RADIUS, 8.0)]
    ends, out = [*(begin for begin, _ in _HOLDER[1:]), _SPINDLE_DISTANCE], overhang - OVERHANG
    pieces += [
        (low + out, high + out, r, 12.0) for (low, r), high in zip(_HOLDER, ends, strict=True)
    ]
    for low, high, radius, step in pieces:
        heights = np.linspace(low, high, int((high - low) / step) + 2)
        count = max(8, int(2.0 * np.pi * radius / 12.0))
        turn = np.arange(count) * 2.0 * np.pi / count
        ring = np.outer(np.cos(turn), side) + np.outer(np.sin(turn), other)
        offsets = np.concatenate([[h * axis, *(h * axis + radius * ring)] for h in heights])
        # the next piece is tested only where the pieces below it are free
        left = np.flatnonzero(free)
        if not len(left):
            break
        places = (centre[left, None] + offsets).reshape(-1, 3)
        held = standard.holds(places, _SLACK, balls)
        free[left] = ~held.reshape(len(left), -1).any(axis=1)
    return free
