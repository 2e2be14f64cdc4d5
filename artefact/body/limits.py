"""Constraints that make a standard manufacturable and measurable, as numbers with limits."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from matstd.artefact.body.datum import DatumSphere, outline_distance
from matstd.artefact.body.freeform import FreeformPatch
from matstd.artefact.body.patch import rows
from matstd.artefact.body.solids import Body
from matstd.artefact.body.standard import Base, Standard
from matstd.twin.errors import NotBuildable
from matstd.twin.frames import Array, apply
from matstd.twin.units import DEG

MIN_BURIAL = 2.0  # depth of the end of a column inside base or core, at least, mm
_FACE_PITCH = 4.0  # mm, of the points of a face at which the probe needs room


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of cutter, stylus and table."""

    # for the ball-end cutter, mm; never less than the ball's own radius
    min_concave_radius: float = 12.0
    max_slope: float = 45.0 * DEG  # between a face's normal and its patch's own direction, rad
    ball_radius: float = 3.0  # of the largest probe ball, mm
    gap: float = 1.0  # between the ball at any touch and every other body, mm
    max_mass: float = 60.0  # of the standard, kg
    # of the disc about the standard's own axis that lies on the table, mm
    table_radius: float = np.inf
    # between the slots of the table, which run along its x, one through its middle; 0 where screws
    # may stand anywhere, mm
    slot_pitch: float = 0.0


@dataclass(frozen=True, slots=True)
class Constraint:
    """One constraint as a number: met where `slack` is not negative."""

    name: str
    subject: str  # feature it is about
    value: float
    limit: float
    slack: float  # margin to the limit in the unit of the value; negative where violated
    unit: str
    other: str = ""  # interfering body; empty where there is none

    @property
    def features(self) -> tuple[str, ...]:
        """Subject and, if any, the interfering body."""
        return tuple(filter(None, (self.subject, self.other)))

    def __str__(self) -> str:
        name = f"{self.name} {self.other}" if self.other else self.name
        return (
            f"{self.subject}: {name} is {self.value:.3f} {self.unit}, "
            f"limit {self.limit:.3f} {self.unit}"
        )


def constraints(standard: Standard, limits: Limits) -> tuple[Constraint, ...]:
    """Every constraint of a standard with its slack, met or not.

    Returns:
        Curvature, slope, blank, burial and freedom of every patch; place and freedom of every
        sphere and hole; the mass.
    """
    found: list[Constraint] = []
    for patch in standard.patches:
        found += _of_patch(standard, patch, limits)
    for sphere in standard.spheres:
        found += _of_sphere(standard, sphere, limits)
    found += _of_holes(standard)
    found.append(_at_most("mass", standard.name, standard.mass(step=6.0), limits.max_mass, "kg"))
    return tuple(found)


def check(standard: Standard, limits: Limits) -> None:
    """Raise NotBuildable, with the constraint that binds most, for what cannot be made."""
    violated = [c for c in constraints(standard, limits) if c.slack < 0.0]
    violated.sort(key=lambda c: c.slack / max(abs(c.limit), 1e-9))
    if violated:
        more = f" (and {len(violated) - 1} more)" if len(violated) > 1 else ""
        raise NotBuildable(f"standard '{standard.name}': {violated[0]}{more}", constraints=violated)


def min_concave_radius(patch: FreeformPatch) -> float:
    """Smallest concave radius on the trimmed face, mm; inf where it is convex everywhere.

    From the largest principal curvature on a 1 mm grid, then on finer grids about its maximum.
    """
    uv, step = patch.grid(1.0), 1.0
    largest = 0.0
    for _ in range(4):
        concave = patch.curvature(uv)[:, 0]
        best = uv[np.argmax(concave)]
        largest = max(largest, float(concave.max()))
        offsets = np.linspace(-step, step, 9)
        around = best + np.stack(np.meshgrid(offsets, offsets), axis=-1).reshape(-1, 2)
        uv = np.clip(around, -np.asarray(patch.half_size), np.asarray(patch.half_size))
        step /= 4.0
    return 1.0 / largest if largest > 0.0 else np.inf


def max_slope(patch: FreeformPatch) -> float:
    """Largest angle between normal and patch direction on a 1 mm grid of the face, rad."""
    return float(patch.slope(patch.grid(1.0)).max())


def overhang(patch: FreeformPatch, base: Base) -> float:
    """How far the column of a patch reaches beyond the outline of the base, mm; negative inside.

    Its four edges are followed from the mean plane of the face down to mid-base, where the column
    is cut off, because a column that leans outwards could leave the base through its side.
    """
    (a, b), T = patch.half_size, patch.T_artefact_patch
    corners = apply(T, np.array([[x, y, 0.0] for x in (-a, a) for y in (-b, b)]))
    to_cut = (corners[:, 2] - 0.5 * base.thickness) / max(T[2, 2], 1e-9)
    ends = corners - np.clip(to_cut, 0.0, patch.depth)[:, None] * T[:3, 2]
    both = np.concatenate([corners, ends])[:, :2]
    return float(outline_distance(both, base.half_size, base.corner_radius).max())


def _of_patch(standard: Standard, patch: FreeformPatch, limits: Limits) -> Iterator[Constraint]:
    smallest = max(limits.min_concave_radius, limits.ball_radius)
    yield _at_least("smallest concave radius", patch.name, min_concave_radius(patch), smallest)
    yield _at_most("slope", patch.name, max_slope(patch) / DEG, limits.max_slope / DEG, "deg")
    uv = patch.grid(_FACE_PITCH)
    face, base = patch.point(uv), standard.base
    outside = outline_distance(face[:, :2], base.half_size, base.corner_radius).max()
    outside = max(float(outside), overhang(patch, base))
    yield _at_most("reach beyond the outline of the blank", patch.name, outside, 0.0)
    yield _at_most("height", patch.name, float(face[:, 2].max()), standard.blank_height)
    yield _at_least(
        "depth of the column's end in the body", patch.name, _burial(standard, patch), MIN_BURIAL
    )
    centres = face + limits.ball_radius * patch.normal(uv)
    others = {name: body for name, body in standard.bodies.items() if name != patch.name}
    name, room = _nearest(others, centres)
    yield _at_least(
        "room for the ball before", patch.name, room - limits.ball_radius, limits.gap, other=name
    )


def _of_sphere(standard: Standard, sphere: DatumSphere, limits: Limits) -> Iterator[Constraint]:
    own = {sphere.name, f"{sphere.name} stem"}
    others = {name: body for name, body in standard.bodies.items() if name not in own}
    base = standard.base
    name, room = _nearest(others, rows(sphere.centre))
    room -= sphere.radius + 2.0 * limits.ball_radius
    yield _at_least("room for the ball before", sphere.name, room, limits.gap, other=name)
    heights = np.linspace(sphere.foot, sphere.centre[2], 9)
    axis = np.column_stack([np.tile(sphere.centre[:2], (9, 1)), heights])
    others.pop("BASE")
    name, room = _nearest(others, axis)
    yield _at_least(
        "distance of the stem from", sphere.name, room - sphere.foot_radius, limits.gap, other=name
    )
    inset = -outline_distance(rows(sphere.centre[:2]), base.half_size, base.corner_radius)[0]
    yield _at_least("stem inside the outline", sphere.name, inset - sphere.foot_radius, 1.0)
    yield _at_most("height", sphere.name, sphere.centre[2] + sphere.radius, standard.blank_height)


def _of_holes(standard: Standard) -> Iterator[Constraint]:
    base = standard.base
    heights = np.arange(base.thickness, standard.blank_height + 4.0, 4.0)
    above = {name: body for name, body in standard.bodies.items() if name != "BASE"}
    for k, hole in enumerate(standard.holes):
        for other in standard.holes[:k]:
            wall = np.hypot(hole.x - other.x, hole.y - other.y)
            wall -= hole.bore_radius + other.bore_radius
            yield _at_least("wall to", hole.name, float(wall), 3.0, other=other.name)
        xy = np.array([[hole.x, hole.y]])
        inset = -outline_distance(xy, base.half_size, base.corner_radius)[0]
        yield _at_least("wall to the outline", hole.name, inset - hole.bore_radius, 3.0)
        yield _at_most("depth of the counterbore", hole.name, hole.bore_depth, base.thickness - 5.0)
        name, room = _nearest(above, np.column_stack([np.repeat(xy, len(heights), 0), heights]))
        free = room - hole.bore_radius
        yield _at_least("access from above past", hole.name, free, 1.0, other=name)


def _burial(standard: Standard, patch: FreeformPatch) -> float:
    """Depth of the end of a column's axis inside base or core, mm; it is cut off in mid-base."""
    origin, back = patch.T_artefact_patch[:3, 3], -patch.direction
    depth = patch.depth
    if back[2] < 0.0:
        depth = min(depth, (0.5 * standard.base.thickness - origin[2]) / back[2])
    end = rows(origin + depth * back)
    anchors = [standard.bodies[name] for name in ("BASE", "CORE") if name in standard.bodies]
    return float(max(-anchor.distance(end)[0] for anchor in anchors))


def _nearest(bodies: dict[str, Body], points: Array) -> tuple[str, float]:
    """Name of the body nearest to any of the points (N, 3), and its distance, mm."""
    rooms = {name: float(body.distance(points).min()) for name, body in bodies.items()}
    if not rooms:
        return "nothing", np.inf
    name = min(rooms, key=rooms.__getitem__)
    return name, rooms[name]


def _at_least(
    name: str, subject: str, value: float, limit: float, unit: str = "mm", other: str = ""
) -> Constraint:
    return Constraint(
        name=name,
        subject=subject,
        value=value,
        limit=limit,
        slack=value - limit,
        unit=unit,
        other=other,
    )


def _at_most(name: str, subject: str, value: float, limit: float, unit: str = "mm") -> Constraint:
    return Constraint(
        name=name, subject=subject, value=value, limit=limit, slack=limit - value, unit=unit
    )
