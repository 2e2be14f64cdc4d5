"""Bodies on a base: upright pillars with a freeform top, balls on posts, and screw holes.

Everything is milled from above: walls are upright and parallel to the sides of the base, and every
face is a graph over its own rectangle. A cutter passes between any two bodies, positions are in
tenths of a millimetre, and nothing extends beyond the outline. Candidates are drawn at random and
kept if they meet these rules; the choice among them is made elsewhere.
"""

from collections.abc import Sequence
from itertools import product

import numpy as np

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
from matstd.twin.frames import Array, IntArray, Mask, pose
from matstd.twin.sampling import grid_points
from matstd.twin.units import UM

WALL_GAP = 12.0  # smallest gap between two bodies, mm: a cutter of 10 mm passes with its run-out

POST_STIFFNESS = 18.0 / UM
"""Smallest lateral stiffness of a post, N/mm: with plate and pads 10 N/um remain."""

DEFAULT_MODULUS = 70e3
"""Modulus for posts of an unknown material, N/mm^2: aluminium, the softest usual material."""

TABLE_RIM = 8.0  # smallest distance from the rim of a screw hole to that of the table, mm
_FACES_SHARE = 0.17  # of the base covered by all freeform faces: with more, 13 balls do not fit
_SIZES = (0.7, 1.2)  # sides of a face relative to equal squares
_MAX_HALF_SIDE = 32.0  # half side of a face, mm
_FACE_CLEARANCE = 10.0  # mm between base and lowest edge of a face: fillet, and room for the ball
_MAX_FACE_SHARE = 0.45  # of the height of the blank: highest middle of a face
_LEAN = (0.45, 0.65)
"""Slope of the mean plane of a face relative to the steepest slope. Only slopes show lateral
errors, but slope of the plane is lost to the curvature of the face. With 0.5 to 0.85 the smallest
radii of curvature are 28 to 73 mm instead of 19 to 36 mm, and the proof detects 82 % instead of 79
% of the errors in any direction."""

_SIDE_LEAN, _LEAN_SCATTER = (0.75, 0.95), 0.4
"""Lean, and scatter of its direction about outwards (rad), where the probe approaches from the
side: it reaches only faces that face it."""

_MIN_BALL_GAP = 15.0  # mm between base and ball, for access of the probe
_MAX_BALL_SHARE = 0.7  # of the height of the blank: highest centre of a ball
_LEDGE = 1.0  # mm of the plate outside the fillet of a foot
_HOLE_GAP = 6.0  # mm between counterbore and body: fillet of its foot, and the key
_WALL = 5.0  # mm between a counterbore and the outline
_MIN_HOLE_DISTANCE = 60.0  # mm, smallest distance of two holes: closer ones let the standard rock
# a plate on three of its corners swings at 427 Hz, with a screw amid a side at 755
_ROUND_MIDDLE = 5.0  # times the distance of the middle from a side counts as that of two holes
_STEP = 7.0  # mm, grid of candidate holes
_LOOKED_AT = 1000  # of the widest triples of holes, below whose best the others need no look
_MAX_DRAWS = 50  # random draws per place


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
    """Candidate pillars, named by their numbers, distributed evenly over the base.

    Args:
        faces: Number that will be chosen; more faces are smaller.
        rng: Draws places, sizes and shapes.
        balls: On posts, beside which cutter and probe find room.
        from_side: Whether the probe comes from the side at every table pose, not from above.
        heaviest: Largest mass of a pillar, kg; heavier pillars are lowered or left out.

    Raises:
        NotBuildable: No pillar stands within the outline, or none is light enough.
    """
    base, around = blank.base, _barred_circles(blank, balls, holes)
    out: list[FreeformPatch] = []
    side = np.sqrt(_FACES_SHARE * 4.0 * np.prod(base.half_size) / faces)
    steepest = steepest_slope(blank.limits)
    smallest = (
        blank.material.density
        * (min(side, 2.0 * _MAX_HALF_SIDE) * _SIZES[0]) ** 2
        * _FACE_CLEARANCE
    )
    for _ in range(count if heaviest > smallest else 0):
        half = np.round(np.minimum(0.5 * side * rng.uniform(*_SIZES, 2), _MAX_HALF_SIDE), 1)
        middle = _free_place(blank, half, around, rng)
        if middle is None:
            continue
        direction, lean = rng.uniform(0.0, 2.0 * np.pi), steepest * rng.uniform(*_LEAN)
        if from_side:  # heights fall outwards
            direction = np.arctan2(-middle[1], -middle[0]) + rng.normal(0.0, _LEAN_SCATTER)
            lean = steepest * rng.uniform(*_SIDE_LEAN)
        plane = (float(lean * np.cos(direction)), float(lean * np.sin(direction)))
        size = (float(half[0]), float(half[1]))
        heights = np.round(smooth_heights(size, blank.limits, rng, plane=plane), 6)
        low = base.thickness + _FACE_CLEARANCE - float(heights.min())
        tallest = base.thickness + heaviest / (blank.material.density * 4.0 * float(np.prod(half)))
        if low > tallest:
            continue
        high = max(min(_MAX_FACE_SHARE * blank.height, blank.height - float(heights.max())), low)
        high = min(high, tallest)
        origin = np.round([*middle, rng.uniform(low, high)], 1)
        depth = float(origin[2]) - 0.5 * base.thickness + _FACE_CLEARANCE
        out.append(graph_patch(f"{len(out)}", pose(t=origin), size, heights, depth=depth))
    if not out:
        a, b = (2.0 * v for v in base.half_size)
        beside = f" beside {len(balls)} balls" if balls else ""
        raise NotBuildable(f"no freeform face stands within a blank of {a:g} x {b:g} mm{beside}")
    return out


def least_mass(face: FreeformPatch, blank: Blank) -> float:
    """Mass of a pillar at its lowest possible height, kg."""
    tall = _FACE_CLEARANCE - float(face.heights.min())  # control heights have mean zero
    return float(blank.material.density * 4.0 * np.prod(face.half_size) * tall)


def _barred_circles(
    blank: Blank, balls: Sequence[DatumSphere], holes: Sequence[MountingHole]
) -> Array:
    """Circles barred to pillars: x, y and radius, (N, 3), mm."""
    posts = [[*b.centre[:2], max(_widest_radius(b) + WALL_GAP, _probe_room(blank))] for b in balls]
    bores = [[h.x, h.y, h.bore_radius + _HOLE_GAP] for h in holes]
    return np.array(posts + bores, dtype=np.float64).reshape(-1, 3)


def _free_place(blank: Blank, half: Array, around: Array, rng: np.random.Generator) -> Array | None:
    """A random free place for a rectangle within the outline; None if none is found."""
    base, bare = blank.base, half
    half = half + BLEND + _LEDGE  # the fillet of its foot needs plate too
    room = np.array(base.half_size) - half
    if room.min() < 0.0:
        return None
    corners = np.array(list(product((-1.0, 1.0), repeat=2))) * half
    for _ in range(_MAX_DRAWS):
        middle = np.round(rng.uniform(-room, room), 1)
        beyond = np.maximum(np.abs(around[:, :2] - middle) - bare, 0.0)
        if (np.hypot(*beyond.T) < around[:, 2]).any():
            continue
        if outline_distance(middle + corners, base.half_size, base.corner_radius).max() <= 0.0:
            return middle
    return None


def ball_on_post(blank: Blank, name: str, centre: Array) -> DatumSphere:
    """A bought ball on a milled post of at least `POST_STIFFNESS`."""
    fit, foot, material = blank.fittings, blank.base.thickness, blank.material
    length, modulus = float(centre[2]) - foot, material.modulus or DEFAULT_MODULUS
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
    """Candidate balls, named by their numbers, distributed evenly over base and height."""
    base, ball = blank.base, blank.fittings.sphere_radius
    low = base.thickness + _MIN_BALL_GAP + ball
    high = max(_MAX_BALL_SHARE * blank.height, low)
    half = np.array(base.half_size) - ball
    across = np.round(rng.uniform(-half, half, (count, 2)), 1)
    heights = np.round(rng.uniform(low, high, count), 1)
    balls = [
        ball_on_post(blank, "", np.array([*xy, z])) for xy, z in zip(across, heights, strict=True)
    ]
    inset = -outline_distance(across, base.half_size, base.corner_radius)
    rim = [max(ball.radius, ball.foot_radius + BLEND) + _LEDGE for ball in balls]
    balls = [b for b, room, least in zip(balls, inset, rim, strict=True) if room >= least]
    return [ball_on_post(blank, f"{i}", b.centre) for i, b in enumerate(balls)]


def _widest_radius(ball: DatumSphere) -> float:
    return max(ball.radius, ball.foot_radius)


def holes_on(
    blank: Blank, balls: Sequence[DatumSphere] = (), faces: Sequence[FreeformPatch] = ()
) -> tuple[MountingHole, ...]:
    """Three screw holes as far apart, round the middle, as base, table, slots and features allow.

    Two are on one slot, the third on another; the slots run along x, one through the middle. The
    standard rests on the pads round its holes, and three pads never rock.

    Raises:
        NotBuildable: Base, table and slots leave no room for them.
    """
    fit, base, limits = blank.fittings, blank.base, blank.limits
    pitch = limits.slot_pitch or _STEP
    ys = np.arange(-(base.half_size[1] // pitch), base.half_size[1] // pitch + 1) * pitch
    xs = np.arange(-(base.half_size[0] // _STEP), base.half_size[0] // _STEP + 1) * _STEP
    places = np.round(grid_points(xs, ys), 1)
    inset = -outline_distance(places, base.half_size, base.corner_radius)
    good = inset >= fit.bore_radius + _WALL
    good &= np.hypot(*places.T) <= limits.table_radius - TABLE_RIM - fit.hole_radius
    for ball in balls:
        apart = np.hypot(*(places - ball.centre[:2]).T)
        good &= apart >= _widest_radius(ball) + fit.bore_radius + _HOLE_GAP
    for face in faces:
        good &= _distance_to_pillar([face], places)[:, 0] >= fit.bore_radius + _HOLE_GAP
    mirrored = good.reshape(len(xs), -1)[::-1].ravel()
    pair, third = places[good & mirrored & (places[:, 0] > 0.0)], places[good]
    x, y = pair[:, :1], pair[:, 1:]
    legs = [np.sqrt((s * x - third[:, 0]) ** 2 + (y - third[:, 1]) ** 2) for s in (-1.0, 1.0)]
    least = np.minimum(np.minimum(*legs), 2.0 * x)
    least[np.abs(y - third[:, 1]) < _MIN_HOLE_DISTANCE] = 0.0  # three in a row would rock
    if least.max(initial=0.0) < _MIN_HOLE_DISTANCE:
        slots = f"limits.slot_pitch_mm = {pitch:g}" if limits.slot_pitch else "no slots"
        raise NotBuildable(
            f"no three screw holes {_MIN_HOLE_DISTANCE:g} mm apart, two in a row and one beside "
            f"it, are within base ({2 * base.half_size[0]:g} x {2 * base.half_size[1]:g} mm) "
            f"and table (diameter {2 * limits.table_radius:g} mm) with {slots}",
            binding=["slots"] if limits.slot_pitch else [],
        )
    of_pair, of_third = np.nonzero(least >= _MIN_HOLE_DISTANCE)
    far, long = least[of_pair, of_third], 1e-3 * (legs[0] + legs[1])[of_pair, of_third]

    def worth(some: IntArray) -> Array:
        inner = _inner(pair[of_pair[some]], third[of_third[some]])
        return np.minimum(far[some], _ROUND_MIDDLE * inner) + long[some]

    # looked at are those that may be worth more than the widest are
    widest = np.argpartition(far, max(len(far) - _LOOKED_AT, 0))[-_LOOKED_AT:]
    some = np.flatnonzero(far + long >= worth(widest).max())
    best = some[np.argmax(worth(some))]
    first, last = of_pair[best], of_third[best]
    (x, y), bore = pair[first], (fit.hole_radius, fit.bore_radius, fit.bore_depth)
    return tuple(
        MountingHole(f"HOLE{i}", float(a), float(b), *bore)
        for i, (a, b) in enumerate([(-x, y), (x, y), third[last]], 1)
    )


def _inner(pair: Array, third: Array) -> Array:
    """Distance of the middle from the nearest side of every triangle, (N,), mm; 0 outside.

    Args:
        pair: The right one of two holes that mirror each other in x, (N, 2).
        third: (N, 2).
    """
    x, y = pair.T
    out = np.abs(y) * (np.sign(third[:, 1] - y) == -np.sign(y))
    for begin in (x, -x):  # the sides to the third hole
        across, up = third[:, 0] - begin, third[:, 1] - y
        # seen from a hole of the pair, the middle and the other hole lie on one side of it
        middle, other = across * (0.0 - y) - up * (0.0 - begin), -up * (-2.0 * begin)
        inside = np.maximum(np.sign(other) * middle, 0.0) / np.maximum(np.hypot(across, up), 1e-9)
        out = np.minimum(out, inside)
    return np.asarray(out)


def least_gap(limits: Limits) -> float:
    """Smallest gap between two pillars for cutter and probe ball, mm."""
    return max(WALL_GAP, 2.0 * limits.ball_radius + limits.gap)


def faces_fit(
    faces: Sequence[FreeformPatch], holes: Sequence[MountingHole], limits: Limits
) -> Mask:
    """Which pillars fit beside each other, (F, F); one over a hole fits beside none."""
    middle = np.stack([p.T_artefact_patch[:2, 3] for p in faces])
    half = np.array([p.half_size for p in faces])
    # the sum first, so that the result is symmetric to the last bit
    beyond = np.abs(middle[:, None] - middle) - (half[:, None] + half)
    out: Mask = np.linalg.norm(np.maximum(beyond, 0.0), axis=-1) >= least_gap(limits)
    for hole in holes:
        blocked = (
            _distance_to_pillar(faces, np.array([[hole.x, hole.y]]))[0]
            < hole.bore_radius + _HOLE_GAP
        )
        out[blocked, :] = out[:, blocked] = False
    return out


def balls_fit(balls: Sequence[DatumSphere], blank: Blank) -> Mask:
    """Which posts leave room for cutter and probe between each other, (B, B)."""
    across, widest = _circles(balls)
    apart = np.linalg.norm(across[:, None] - across, axis=-1)
    least = np.maximum(widest[:, None] + widest + WALL_GAP, _probe_room(blank) + widest)
    return np.asarray(apart >= least)


def faces_beside(
    faces: Sequence[FreeformPatch], balls: Sequence[DatumSphere], blank: Blank
) -> Mask:
    """Which pillars leave room for cutter and probe beside some posts, (F,)."""
    if not balls:
        return np.ones(len(faces), dtype=bool)
    across, widest = _circles(balls)
    room = np.maximum(widest + WALL_GAP, _probe_room(blank))
    return np.asarray((_distance_to_pillar(faces, across) >= room[:, None]).all(axis=0))


def _circles(balls: Sequence[DatumSphere]) -> tuple[Array, Array]:
    """Places (B, 2) and widest radii (B,) of balls on posts, seen from above, mm."""
    return np.stack([b.centre[:2] for b in balls]), np.array([_widest_radius(b) for b in balls])


def _probe_room(blank: Blank) -> float:
    """Smallest distance from the centre of a ball to the next body, for the probe ball, mm."""
    limits = blank.limits
    return blank.fittings.sphere_radius + 2.0 * limits.ball_radius + limits.gap


def _distance_to_pillar(faces: Sequence[FreeformPatch], places: Array) -> Array:
    """Distance of places (N, 2) from the walls of pillars, (N, F), mm."""
    middle = np.stack([p.T_artefact_patch[:2, 3] for p in faces])
    half = np.array([p.half_size for p in faces])
    beyond = np.abs(places[:, None] - middle) - half
    return np.asarray(np.linalg.norm(np.maximum(beyond, 0.0), axis=-1))
