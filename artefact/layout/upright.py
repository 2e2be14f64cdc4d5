"""What can stand on a base: upright pillars with a freeform top, balls on posts, and screw holes.

Everything is milled from above: walls are upright and parallel to the sides of the base, a face is
a graph over its own rectangle, however much it leans. Between any two bodies a cutter passes,
places are in tenths of a millimetre, and nothing stands out beyond the outline.
"""

from collections.abc import Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from matstd.artefact.body import (
    BLEND,
    DatumSphere,
    FreeformPatch,
    Limits,
    MountingHole,
    graph_patch,
    outline_distance,
)
from matstd.artefact.layout.blank import Blank
from matstd.artefact.layout.post import post_foot
from matstd.artefact.layout.shapes import smooth_heights, steepest_slope
from matstd.twin.errors import NotBuildable
from matstd.twin.frames import Array, pose
from matstd.twin.units import UM

Pairs = NDArray[np.bool_]

WALL_GAP = 12.0
"""Least gap between two bodies, mm: a cutter of 10 mm passes with its run-out."""

POST_STIFFNESS = 18.0 / UM
"""Least force across a ball per deflection of its post, N/mm: with plate and pads 10 are left."""

SOFT = 70e3
"""Modulus for which posts are drawn where that of the material is not known, N/mm^2: aluminium, the
softest that standards are usually made of."""

TABLE_RIM = 8.0
"""From the rim of a screw hole to the rim of the table at least, mm."""

_FACES_SHARE = 0.17  # of the base that all freeform faces cover: with more no 13 balls fit beside
_SIZES = (0.7, 1.2)  # sides of a face in those that give them all that share
_LARGEST = 32.0  # half side of a face, mm: what a touch probe looks at as one surface
_ABOVE = 10.0  # mm that the lowest edge of a face is above the base: fillet, and room for the ball
_HIGHEST = 0.45  # of the blank's height, the middle of a face at most
_LEAN = (0.45, 0.65)
"""Of the steepest slope that the mean plane of a face takes: what is wrong across the table is seen
on slopes alone, but what the plane takes of the slope is lost to the curvature of the face. With
0.5 to 0.85 the least radii of curvature are 28 to 73 mm instead of 19 to 36 mm, and the proof finds
82 % instead of 79 % of what is wrong in whatever direction."""

_LEAN_OUT, _OUT = (0.75, 0.95), 0.4
"""Lean, and scatter of its direction about outwards (rad), where the probe comes from the side: it
reaches what looks at it, and nothing must stand before that."""

_LOWEST_BALL = 15.0  # mm between the base and a ball, for the probe to come beside it
_HIGHEST_BALL = 0.7  # of the blank's height, centre of a ball at most
_LEDGE = 1.0  # mm of the plate that is left outside the blend of a foot
_TO_HOLE = 6.0  # mm between a counterbore and a body: fillet of its foot, and the key
_WALL = 5.0  # mm between a counterbore and the outline
_APART = 60.0  # mm between two holes at least: nearer ones let a standard rock
_STEP = 7.0  # mm, in which places of holes are tried
_TRIES = 50  # draws for each place


def freeform_faces(
    blank: Blank,
    faces: int,
    count: int,
    rng: np.random.Generator,
    balls: Sequence[DatumSphere] = (),
    holes: Sequence[MountingHole] = (),
    from_side: bool = False,
    heaviest: float = np.inf,
) -> list[FreeformPatch]:
    """Pillars of which some may be chosen, named by their numbers, evenly over the base.

    Args:
        blank: Base, height and limits.
        faces: How many will be chosen: the more, the smaller they are.
        count: How many are tried.
        rng: Draws places, sizes and shapes.
        balls: On posts, beside which cutter and probe find room.
        holes: Beside which the key does.
        from_side: Whether the probe comes from the side at every table pose, not from above.
        heaviest: What a pillar may weigh, kg: it is drawn lower, and left out where it cannot be.

    Raises:
        NotBuildable: No pillar stands within the outline, or none is light enough.
    """
    base, around = blank.base, _around(blank, balls, holes)
    out: list[FreeformPatch] = []
    side = np.sqrt(_FACES_SHARE * 4.0 * np.prod(base.half_size) / faces)
    steepest = steepest_slope(blank.limits)
    smallest = blank.material.density * (min(side, 2.0 * _LARGEST) * _SIZES[0]) ** 2 * _ABOVE
    for _ in range(count if heaviest > smallest else 0):
        half = np.round(np.minimum(0.5 * side * rng.uniform(*_SIZES, 2), _LARGEST), 1)
        middle = _inside(blank, half, around, rng)
        if middle is None:
            continue
        direction, lean = rng.uniform(0.0, 2.0 * np.pi), steepest * rng.uniform(*_LEAN)
        if from_side:  # heights fall outwards
            direction = np.arctan2(-middle[1], -middle[0]) + rng.normal(0.0, _OUT)
            lean = steepest * rng.uniform(*_LEAN_OUT)
        plane = (float(lean * np.cos(direction)), float(lean * np.sin(direction)))
        size = (float(half[0]), float(half[1]))
        heights = np.round(smooth_heights(size, blank.limits, rng, plane=plane), 6)
        low = base.thickness + _ABOVE - float(heights.min())
        tallest = base.thickness + heaviest / (blank.material.density * 4.0 * float(np.prod(half)))
        if low > tallest:
            continue
        high = max(min(_HIGHEST * blank.height, blank.height - float(heights.max())), low)
        high = min(high, tallest)
        origin = np.round([*middle, rng.uniform(low, high)], 1)
        depth = float(origin[2]) - 0.5 * base.thickness + _ABOVE
        out.append(graph_patch(f"{len(out)}", pose(t=origin), size, heights, depth=depth))
    if not out:
        a, b = (2.0 * v for v in base.half_size)
        beside = f" beside {len(balls)} balls" if balls else ""
        raise NotBuildable(f"no freeform face stands within a blank of {a:g} x {b:g} mm{beside}")
    return out


def least_mass(face: FreeformPatch, blank: Blank) -> float:
    """What a pillar adds to the plate were it as low as its shape allows, kg."""
    tall = _ABOVE - float(face.heights.min())  # control heights have mean zero
    return float(blank.material.density * 4.0 * np.prod(face.half_size) * tall)


def _around(blank: Blank, balls: Sequence[DatumSphere], holes: Sequence[MountingHole]) -> Array:
    """Circles that no pillar may reach into: x, y and radius, (N, 3), mm."""
    posts = [[*b.centre[:2], max(_widest(b) + WALL_GAP, _probe_room(blank))] for b in balls]
    bores = [[h.x, h.y, h.bore_radius + _TO_HOLE] for h in holes]
    return np.array(posts + bores, dtype=np.float64).reshape(-1, 3)


def _inside(blank: Blank, half: Array, around: Array, rng: np.random.Generator) -> Array | None:
    """A place for a rectangle within the outline, clear of some circles; None where none is."""
    base, bare = blank.base, half
    half = half + BLEND + _LEDGE  # the blend of its foot stands on the plate too
    room = np.array(base.half_size) - half
    if room.min() < 0.0:
        return None
    corners = np.array(list(product((-1.0, 1.0), repeat=2))) * half
    for _ in range(_TRIES):
        middle = np.round(rng.uniform(-room, room), 1)
        beyond = np.maximum(np.abs(around[:, :2] - middle) - bare, 0.0)
        if (np.hypot(*beyond.T) < around[:, 2]).any():
            continue
        if outline_distance(middle + corners, base.half_size, base.corner_radius).max() <= 0.0:
            return middle
    return None


def ball_on_post(blank: Blank, name: str, centre: Array) -> DatumSphere:
    """A bought ball on a post of the body that is as stiff as `POST_STIFFNESS`."""
    fit, foot, material = blank.fittings, blank.base.thickness, blank.material
    length, modulus = float(centre[2]) - foot, material.modulus or SOFT
    radius = post_foot(length, fit.post_radius, POST_STIFFNESS, modulus, material.poisson)
    return DatumSphere(
        name=name,
        centre=centre,
        radius=fit.sphere_radius,
        stem_radius=fit.post_radius,
        foot_radius=radius,
        foot=foot,
    )


def balls_on_posts(blank: Blank, count: int, rng: np.random.Generator) -> list[DatumSphere]:
    """Balls of which some may be chosen, named by their numbers, evenly over base and height."""
    base, ball = blank.base, blank.fittings.sphere_radius
    low = base.thickness + _LOWEST_BALL + ball
    high = max(_HIGHEST_BALL * blank.height, low)
    half = np.array(base.half_size) - ball
    across = np.round(rng.uniform(-half, half, (count, 2)), 1)
    heights = np.round(rng.uniform(low, high, count), 1)
    balls = [
        ball_on_post(blank, "", np.array([*xy, z])) for xy, z in zip(across, heights, strict=True)
    ]
    inset = -outline_distance(across, base.half_size, base.corner_radius)
    balls = [b for b, room in zip(balls, inset, strict=True) if room >= _to_rim(b)]
    return [ball_on_post(blank, f"{i}", b.centre) for i, b in enumerate(balls)]


def _to_rim(ball: DatumSphere) -> float:
    """From the axis of a post to the outline at least, mm."""
    return max(ball.radius, ball.foot_radius + BLEND) + _LEDGE


def _widest(ball: DatumSphere) -> float:
    return max(ball.radius, ball.foot_radius)


def holes_on(blank: Blank, balls: Sequence[DatumSphere] = ()) -> tuple[MountingHole, ...]:
    """Three screw holes as far apart as base, table, its slots and some balls allow.

    Two stand on one slot, the third on another; the slots run along x, one through the middle. A
    standard rests on the pads round its holes, so three of them never rock. Places are in tenths
    of a millimetre, whatever the slots are.

    Raises:
        NotBuildable: Base, table and slots leave no room for them.
    """
    fit, base, limits = blank.fittings, blank.base, blank.limits
    pitch = limits.slot_pitch or _STEP
    ys = np.arange(-(base.half_size[1] // pitch), base.half_size[1] // pitch + 1) * pitch
    xs = np.arange(-(base.half_size[0] // _STEP), base.half_size[0] // _STEP + 1) * _STEP
    places = np.round(np.stack(np.meshgrid(xs, ys, indexing="ij"), axis=-1).reshape(-1, 2), 1)
    inset = -outline_distance(places, base.half_size, base.corner_radius)
    good = inset >= fit.bore_radius + _WALL
    good &= np.hypot(*places.T) <= limits.table_radius - TABLE_RIM - fit.hole_radius
    for ball in balls:
        apart = np.hypot(*(places - ball.centre[:2]).T)
        good &= apart >= _widest(ball) + fit.bore_radius + _TO_HOLE
    mirrored = good.reshape(len(xs), -1)[::-1].reshape(-1)
    pair, third = places[good & mirrored & (places[:, 0] > 0.0)], places[good]
    legs = [np.linalg.norm(pair[:, None] * [s, 1.0] - third, axis=-1) for s in (-1.0, 1.0)]
    least = np.minimum(np.minimum(*legs), 2.0 * pair[:, :1])
    least[np.abs(pair[:, 1:] - third[:, 1]) < _APART] = 0.0  # in a row they would rock
    if least.max(initial=0.0) < _APART:
        slots = f"limits.slot_pitch_mm = {pitch:g}" if limits.slot_pitch else "no slots"
        raise NotBuildable(
            f"no three screw holes {_APART:g} mm apart, two in a row and one beside it, are within "
            f"base ({2 * base.half_size[0]:g} x {2 * base.half_size[1]:g} mm) and table (diameter "
            f"{2 * limits.table_radius:g} mm) with {slots}",
            binding=["slots"] if limits.slot_pitch else [],
        )
    first, last = np.unravel_index(np.argmax(least + 1e-3 * (legs[0] + legs[1])), least.shape)
    (x, y), bore = pair[first], (fit.hole_radius, fit.bore_radius, fit.bore_depth)
    return tuple(
        MountingHole(f"HOLE{i}", float(a), float(b), *bore)
        for i, (a, b) in enumerate([(-x, y), (x, y), third[last]], 1)
    )


def least_gap(limits: Limits) -> float:
    """Between two pillars, for the cutter and the probe's ball, mm."""
    return max(WALL_GAP, 2.0 * limits.ball_radius + limits.gap)


def faces_fit(
    faces: Sequence[FreeformPatch], holes: Sequence[MountingHole], limits: Limits
) -> Pairs:
    """Which pillars can stand beside each other, (F, F); one over a hole fits beside nothing."""
    middle = np.stack([p.T_artefact_patch[:2, 3] for p in faces])
    half = np.array([p.half_size for p in faces])
    # the sum first: to the last bit the same for both of a pair, which may be just as far apart
    beyond = np.abs(middle[:, None] - middle) - (half[:, None] + half)
    out: Pairs = np.linalg.norm(np.maximum(beyond, 0.0), axis=-1) >= least_gap(limits)
    for hole in holes:
        blocked = _to_pillar(faces, np.array([[hole.x, hole.y]]))[0] < hole.bore_radius + _TO_HOLE
        out[blocked, :] = out[:, blocked] = False
    return out


def balls_fit(balls: Sequence[DatumSphere], blank: Blank) -> Pairs:
    """Which posts leave room for cutter and probe between them, (B, B)."""
    across, widest = np.stack([b.centre[:2] for b in balls]), np.array([_widest(b) for b in balls])
    apart = np.linalg.norm(across[:, None] - across, axis=-1)
    least = np.maximum(widest[:, None] + widest + WALL_GAP, _probe_room(blank) + widest)
    return np.asarray(apart >= least)


def faces_beside(
    faces: Sequence[FreeformPatch], balls: Sequence[DatumSphere], blank: Blank
) -> NDArray[np.bool_]:
    """Which pillars leave room for cutter and probe beside some posts, (F,)."""
    if not balls:
        return np.ones(len(faces), dtype=bool)
    across, widest = np.stack([b.centre[:2] for b in balls]), np.array([_widest(b) for b in balls])
    room = np.maximum(widest + WALL_GAP, _probe_room(blank))
    return np.asarray((_to_pillar(faces, across) >= room[:, None]).all(axis=0))


def _probe_room(blank: Blank) -> float:
    """From the centre of a ball to the next body, for the probe's ball to come between, mm."""
    limits = blank.limits
    return blank.fittings.sphere_radius + 2.0 * limits.ball_radius + limits.gap


def _to_pillar(faces: Sequence[FreeformPatch], places: Array) -> Array:
    """Distance of places (N, 2) from the walls of pillars, (N, F), mm."""
    middle = np.stack([p.T_artefact_patch[:2, 3] for p in faces])
    half = np.array([p.half_size for p in faces])
    beyond = np.abs(places[:, None] - middle) - half
    return np.asarray(np.linalg.norm(np.maximum(beyond, 0.0), axis=-1))
