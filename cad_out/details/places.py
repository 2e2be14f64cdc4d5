"""Where there is room on the plate: its sides, lifting holes, a pocket for a thermometer."""

from dataclasses import dataclass

import numpy as np

from matstd.artefact.body import BLEND, FreeformPatch, Standard, outline_distance
from matstd.twin.frames import Array, apply
from matstd.twin.sampling import grid_points

HEAVY = 25.0  # mass above which a standard is lifted by a crane, kg
_SHORTEST = 40.0  # mm of a side's straight part, below which it gets a flat
_FLAT = 2.0  # mm that a flat is deep
_LIFT_CORE, _LIFT_DEPTH, _LIFT_COLLAR = 8.5, 18.0, 12.5  # mm: M10, DIN 580, its collar's radius
_LIFT_APART = 80.0  # mm between two lifting holes at least
_GRID = 10.0  # mm, of places tried for them
_POCKET_RADIUS = 3.1  # mm: a probe of 6 mm
_POCKET_DEPTHS = (40.0, 30.0, 20.0)
_WALL = 4.0  # mm of material between two holes


@dataclass(frozen=True, slots=True)
class Side:
    """An upright plane side of the plate."""

    normal: tuple[int, int]  # outwards, one of (+-1, 0), (0, +-1)
    offset: float  # of the plane along the normal, mm
    half_length: float  # of its straight part, mm
    flat: float  # how much was taken off the outline for it, mm


@dataclass(frozen=True, slots=True)
class Bore:
    """A blind hole."""

    name: str  # LIFT1 ... or THERMO
    mouth: tuple[float, float, float]  # middle of its mouth, mm
    direction: tuple[float, float, float]  # into the material
    radius: float  # mm
    depth: float  # mm
    thread: str = ""  # what is cut into it; empty for a plain hole


def sides_of(standard: Standard) -> dict[str, Side]:
    """The four sides, as `DATUM_B` (-y), `DATUM_C` (-x), `NAME` (+x) and `THERMO` (+y).

    A round plate gets a flat wherever a straight part would be too short for two touches.
    """
    (a, b), r = standard.base.half_size, standard.base.corner_radius
    out = {}
    named = {"DATUM_B": (0, -1), "DATUM_C": (-1, 0), "NAME": (1, 0), "THERMO": (0, 1)}
    for name, normal in named.items():
        along, across = (b, a) if normal[0] else (a, b)
        half = along - r
        flat = 0.0 if 2.0 * half >= _SHORTEST else _FLAT
        half += float(np.sqrt(r**2 - (r - flat) ** 2))
        out[name] = Side(normal, across - flat, half, flat)
    return out


def datum_touches(standard: Standard) -> dict[str, tuple[Array, Array]]:
    """Points (K, 3) and outward normal (3,) of the sides that are datums.

    Side B is touched twice, as far apart as its straight part is long, side C once in its middle,
    both at half the plate's height.
    """
    sides, z = sides_of(standard), 0.5 * standard.base.thickness
    out = {}
    for name, shares in (("DATUM_B", (-0.8, 0.8)), ("DATUM_C", (0.0,))):
        side = sides[name]
        normal = np.array([*side.normal, 0.0])
        across = np.abs(normal[[1, 0, 2]])
        middle = side.offset * normal + [0.0, 0.0, z]
        out[name] = np.array([middle + s * side.half_length * across for s in shares]), normal
    return out


def plan_room(standard: Standard, xy: Array) -> Array:
    """Distance of places (N, 2) from all that stands on the plate, is bored into it, or ends it.

    Seen from above: what hangs over a place stands in a tool's way as well.
    """
    base = standard.base
    room = -outline_distance(xy, base.half_size, base.corner_radius)
    for patch in standard.patches:
        room = np.minimum(room, _to_column(standard, patch, xy))
    for s in standard.spheres:
        widest = max(s.radius, s.foot_radius + BLEND)
        room = np.minimum(room, np.hypot(*(xy - s.centre[:2]).T) - widest)
    for hole in standard.holes:
        room = np.minimum(room, np.hypot(xy[:, 0] - hole.x, xy[:, 1] - hole.y) - hole.bore_radius)
    if standard.core is not None:
        widest = max(standard.core.low_radius, standard.core.high_radius)
        room = np.minimum(room, np.hypot(*xy.T) - widest)
    return np.asarray(room)


def _to_column(standard: Standard, patch: FreeformPatch, xy: Array) -> Array:
    from scipy.spatial import ConvexHull

    if patch.is_upright:
        beyond = np.abs(xy - patch.T_artefact_patch[:2, 3]) - patch.half_size
        outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=1)
        return np.asarray(outside + np.minimum(beyond.max(axis=1), 0.0) - BLEND)
    # from above a leaning column lies within the hull of its box's corners
    low, high = -patch.depth, standard.columns[patch.name].top
    (c, d), z = patch.half_size, (low, high)
    box = np.array([[x, y, h] for x in (-c, c) for y in (-d, d) for h in z])
    hull = ConvexHull(apply(patch.T_artefact_patch, box)[:, :2])
    return np.asarray((xy @ hull.equations[:, :2].T + hull.equations[:, 2]).max(axis=1))


def lifting_holes(standard: Standard, mass: float) -> tuple[Bore, ...]:
    """Two tapped holes for eyebolts, one on either side of the centre of mass; none if light."""
    if mass <= HEAVY:
        return ()
    a, b = standard.base.half_size
    axes = [np.arange(-(h // _GRID), h // _GRID + 1) * _GRID for h in (a, b)]
    xy = grid_points(*axes)
    xy = xy[plan_room(standard, xy) >= _LIFT_COLLAR]
    if len(xy) < 2:
        return ()
    middle = 0.5 * (xy[:, None] + xy)
    apart = np.linalg.norm(xy[:, None] - xy, axis=-1)
    # among pairs that are equally central the widest is taken
    off = np.linalg.norm(middle - centre_of_mass(standard), axis=-1) - 1e-3 * apart
    off[apart < _LIFT_APART] = np.inf
    i, j = np.unravel_index(np.argmin(off), off.shape)
    if not np.isfinite(off[i, j]):
        return ()
    top, depth = standard.base.thickness, min(_LIFT_DEPTH, standard.base.thickness - 6.0)
    return tuple(
        Bore(
            name=f"LIFT{n}",
            mouth=(float(x), float(y), top),
            direction=(0.0, 0.0, -1.0),
            radius=0.5 * _LIFT_CORE,
            depth=depth,
            thread="M10",
        )
        for n, (x, y) in enumerate(xy[sorted((int(i), int(j)))], 1)
    )


def centre_of_mass(standard: Standard) -> Array:
    """Of plate and pillars, seen from above, (2,), mm; posts and balls are light and all round."""
    (a, b), base = standard.base.half_size, standard.base
    weight, moment = 4.0 * a * b * base.thickness, np.zeros(2)
    for patch in standard.patches:
        place = patch.T_artefact_patch[:3, 3]
        volume = 4.0 * np.prod(patch.half_size) * max(place[2] - base.thickness, 0.0)
        weight, moment = weight + volume, moment + volume * place[:2]
    return np.asarray(moment / weight)


def thermometer_pocket(standard: Standard, side: Side, others: tuple[Bore, ...]) -> Bore | None:
    """A blind hole into a side at half the plate's height, clear of all other holes."""
    half = side.half_length - 8.0
    tried = np.arange(0.0, max(half, 1.0), 4.0)
    upright = [(h.x, h.y, h.bore_radius) for h in standard.holes]
    upright += [(bore.mouth[0], bore.mouth[1], bore.radius) for bore in others]
    for depth in _POCKET_DEPTHS:
        for x in (s * t for t in tried for s in (1.0, -1.0)):
            low = side.offset - depth
            room = [np.hypot(u - x, v - np.clip(v, low, side.offset)) - r for u, v, r in upright]
            if min(room, default=np.inf) >= _POCKET_RADIUS + _WALL:
                mouth = (float(x), side.offset, 0.5 * standard.base.thickness)
                return Bore(
                    name="THERMO",
                    mouth=mouth,
                    direction=(0.0, -1.0, 0.0),
                    radius=_POCKET_RADIUS,
                    depth=depth,
                )
    return None
