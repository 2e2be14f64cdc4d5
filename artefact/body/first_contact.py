"""First contact of a moving ball with a whole standard: face, trimmed edge, column, stem or base.

Every surface is asked separately for its contact with the ball on its exact shape; of all contacts
the earliest wins (`_Race`). Bounding spheres exclude most pairs of ball and feature beforehand.
"""

from dataclasses import dataclass

import numpy as np

from matstd.artefact.body.datum import DatumSphere
from matstd.artefact.body.freeform import FreeformPatch
from matstd.artefact.body.patch import Meeting, rows, sphere_entry
from matstd.artefact.body.solids import entry
from matstd.artefact.body.standard import Standard
from matstd.twin.frames import Array, Mask, apply, turn, unit
from matstd.twin.units import NM

_EDGE_PITCH = 0.5  # mm, of the samples of a trimmed edge
_EDGE_SAMPLES = 16  # samples of an edge that share one bounding sphere
_NUMBERS_AT_ONCE = 2_000_000  # numbers in memory at once during the search of the edges


@dataclass(frozen=True, eq=False)
class Contact:
    """First contact of each of N moving balls."""

    feature: np.ndarray  # name of the feature or body, (N,); empty where nothing is met
    meeting: np.ndarray  # what was met of it, (N,), values of `Meeting`
    uv: Array  # parameters on the feature, (N, 2); nan unless its surface is met
    travel: Array  # of the ball, (N,), mm; nan where nothing is met, zero where it starts inside
    point: Array  # contact point, (N, 3), mm; nan unless a surface is met
    normal: Array  # outward unit normal there, (N, 3); nan unless a surface is met

    @property
    def is_surface(self) -> Mask:
        """Whether a surface is met, not an edge or a side."""
        return self.meeting == Meeting.SURFACE


class _Race:
    """Keeps the earliest contact of every ball."""

    def __init__(self, count: int) -> None:
        self.travel = np.full(count, np.inf)
        self.feature = np.full(count, "", dtype=object)
        self.meeting = np.full(count, Meeting.NOTHING, dtype=object)
        self.uv = np.full((count, 2), np.nan)

    def offer(
        self, travel: Array, name: str, meeting: Meeting, index: np.ndarray, uv: Array | None = None
    ) -> None:
        """Enter contacts of the balls `index` after `travel`; earlier contacts stay."""
        won = travel < self.travel[index]
        rows_won = index[won]
        self.travel[rows_won] = travel[won]
        self.feature[rows_won] = name
        self.meeting[rows_won] = meeting
        self.uv[rows_won] = np.nan if uv is None else uv[won]


def contact(
    standard: Standard,
    start: Array,
    direction: Array,
    radius: float,
    travel: float | Array = np.inf,
) -> Contact:
    """First contact of moving balls with the whole standard, on its exact shapes.

    Faces are B-splines and spheres, never a mesh. Trimmed edges, side walls, stems, holes, the
    core and the base are included, so that a touch on them is not mistaken for one on a face.
    Edges are found to better than a micrometre, all else to `CONTACT_TOLERANCE`.

    Args:
        standard: In the artefact frame.
        start: Ball centres, shape (N, 3), artefact frame, mm.
        direction: Of travel, shape (N, 3) or (3,).
        radius: Of the ball, mm.
        travel: Longest travel that is searched, mm; one for all or (N,).
    """
    p = rows(start).astype(np.float64)
    d = np.array(unit(rows(direction, len(p))))
    race = _Race(len(p))
    latest = np.broadcast_to(np.asarray(travel, dtype=np.float64), len(p))
    for patch in standard.patches:
        _meet_patch(race, standard, patch, p, d, radius, latest)
    for sphere in standard.spheres:
        _meet_sphere(race, standard, sphere, p, d, radius)
    _meet_base(race, standard, p, d, radius)
    everyone = np.arange(len(p))
    if "CORE" in standard.bodies:
        race.offer(entry(standard.bodies["CORE"], p, d, radius), "CORE", Meeting.SIDE, everyone)
    return _result(standard, race, travel)


def _result(standard: Standard, race: _Race, travel: float | Array) -> Contact:
    begins = race.travel <= -NM
    race.meeting[begins] = Meeting.INSIDE
    inside = race.meeting == Meeting.INSIDE
    late = race.travel > travel
    race.meeting[late] = Meeting.NOTHING
    race.feature[race.meeting == Meeting.NOTHING] = ""
    race.travel[inside] = 0.0
    race.travel[race.meeting == Meeting.NOTHING] = np.nan
    point, normal = np.full((len(begins), 3), np.nan), np.full((len(begins), 3), np.nan)
    on_surface = race.meeting == Meeting.SURFACE
    race.uv[~on_surface] = np.nan
    for name, surface in standard.features.items():
        mine = np.flatnonzero(on_surface & (race.feature == name))
        if len(mine):
            point[mine], normal[mine] = surface.point(race.uv[mine]), surface.normal(race.uv[mine])
    return Contact(
        feature=race.feature,
        meeting=race.meeting,
        uv=race.uv,
        travel=race.travel,
        point=point,
        normal=normal,
    )


def _meet_patch(
    race: _Race,
    standard: Standard,
    patch: FreeformPatch,
    start: Array,
    d: Array,
    radius: float,
    latest: Array,
) -> None:
    """A patch with its edges, the four walls of its column and their corners, up to some travel."""
    column = standard.columns[patch.name]
    middle, reach = column.hull
    earliest = sphere_entry(middle, start, d, reach + radius)
    near = np.flatnonzero(np.isfinite(earliest) & (earliest <= latest))
    if not len(near):
        return
    p, d = start[near], d[near]
    first = patch.contact_start(p, d, radius)
    hit = patch.contact(p, d, radius, first)
    face = patch.contains(hit.uv)
    race.offer(hit.travel[face], patch.name, Meeting.SURFACE, near[face], hit.uv[face])
    edge = _edge_entry(patch, p, d, radius, np.minimum(latest[near], race.travel[near]))
    race.offer(edge, patch.name, Meeting.EDGE, near)
    local_p, local_d = apply(patch.T_patch_artefact, p), turn(patch.T_patch_artefact, d)
    race.offer(_wall_entry(patch, local_p, local_d, radius), patch.name, Meeting.SIDE, near)
    race.offer(_corner_entry(patch, local_p, local_d, radius), patch.name, Meeting.SIDE, near)
    inside = column.distance(p) < 0.0
    race.offer(np.zeros(inside.sum()) - 1.0, patch.name, Meeting.INSIDE, near[inside])
    open_ = np.flatnonzero(np.isnan(hit.travel) & np.isfinite(first.travel))
    lost = open_[_aims_at_face(patch, p[open_], d[open_], first.travel[open_])]
    race.offer(first.travel[lost], patch.name, Meeting.UNRESOLVED, near[lost])


def _aims_at_face(patch: FreeformPatch, p: Array, d: Array, travel: Array) -> Mask:
    """Balls that end over the face, 3 mm inside its border: there Newton must succeed."""
    end = p + np.where(np.isfinite(travel), travel, 0.0)[:, None] * d
    local = apply(patch.T_patch_artefact, end)
    return np.all(np.abs(local[:, :2]) < np.asarray(patch.half_size) - 3.0, axis=1)


def _edge_entry(patch: FreeformPatch, p: Array, d: Array, radius: float, latest: Array) -> Array:
    """Travel to the trimmed edge, (N,), mm; inf where it is missed, or met after the latest travel.

    The travel to the samples of each edge is refined by the vertex of the parabola through the
    earliest three and evaluated there, on the edge itself. Balls that meet no bounding sphere of
    the samples in time are skipped.
    """
    best = np.full(len(p), np.inf)
    for fixed in (0, 1):
        free = 1 - fixed
        half = patch.half_size[free]
        s = np.linspace(-half, half, int(np.ceil(2.0 * half / _EDGE_PITCH)) + 1)
        for side in (-patch.half_size[fixed], patch.half_size[fixed]):
            uv = np.empty((len(s), 2))
            uv[:, fixed], uv[:, free] = side, s
            points = patch.point(uv)
            near = _near_in_time(points, p, d, radius, latest)
            for some in np.array_split(near, len(near) * len(s) * 3 // _NUMBERS_AT_ONCE + 1):
                samples = sphere_entry(points, p[some, None], d[some, None], radius)
                first, vertex = _parabola_vertex(samples, s)
                refined = np.empty((len(some), 2))
                refined[:, fixed], refined[:, free] = side, vertex
                at_vertex = sphere_entry(patch.point(refined), p[some], d[some], radius)
                best[some] = np.minimum(best[some], np.minimum(first, at_vertex))
    return best


def _near_in_time(points: Array, p: Array, d: Array, radius: float, latest: Array) -> np.ndarray:
    """Balls that come near a row of points (K, 3), at most one pitch apart, before some travel."""
    near = np.zeros(len(p), dtype=bool)
    for piece in np.array_split(points, len(points) // _EDGE_SAMPLES + 1):
        middle = 0.5 * (piece[0] + piece[-1])
        reach = np.linalg.norm(piece - middle, axis=1).max() + 2.0 * _EDGE_PITCH
        entry = sphere_entry(middle, p, d, float(reach) + radius)
        near |= np.isfinite(entry) & (entry <= latest)
    return np.flatnonzero(near)


def _parabola_vertex(samples: Array, s: Array) -> tuple[Array, Array]:
    """Smallest of each row's samples (N, K), and where the parabola round it has its vertex."""
    n, i = np.arange(len(samples)), np.argmin(samples, axis=1)
    low, mid, high = (samples[n, np.clip(i + k, 0, len(s) - 1)] for k in (-1, 0, 1))
    usable = np.isfinite(low) & np.isfinite(high) & (i > 0) & (i < len(s) - 1)
    low, middle, high = (np.where(usable, value, 0.0) for value in (low, mid, high))
    bend = low - 2.0 * middle + high
    shift = np.where(bend > 0.0, 0.5 * (low - high) / np.where(bend > 0.0, bend, 1.0), 0.0)
    return mid, s[i] + np.clip(shift, -1.0, 1.0) * (s[1] - s[0])


def _wall_entry(patch: FreeformPatch, p: Array, d: Array, radius: float) -> Array:
    """Travel to the four plane walls of the column, patch frame, (N,), mm; inf where missed.

    Minus one where the ball starts through a wall.
    """
    best = np.full(len(p), np.inf)
    for fixed in (0, 1):
        free, half = 1 - fixed, patch.half_size[fixed]
        for sign in (-1.0, 1.0):
            outside = sign * p[:, fixed] - half
            towards = -sign * d[:, fixed]
            with np.errstate(divide="ignore", invalid="ignore"):
                travel = np.where(towards > 0.0, (outside - radius) / towards, np.inf)
            begins = (outside > 0.0) & (outside < radius - NM)
            travel = np.where(begins, 0.0, travel)
            travel = np.where(outside > 0.0, travel, np.inf)
            end = p + np.where(np.isfinite(travel), travel, 0.0)[:, None] * d
            uv = np.empty((len(p), 2))
            uv[:, fixed] = sign * half
            uv[:, free] = np.clip(end[:, free], -patch.half_size[free], patch.half_size[free])
            on_wall = (np.abs(end[:, free]) <= patch.half_size[free]) & (end[:, 2] >= -patch.depth)
            check = np.flatnonzero(on_wall & np.isfinite(travel))
            on_wall[check] = end[check, 2] <= patch.height(uv[check])
            travel = np.where(begins, -1.0, travel)
            best = np.where(on_wall, np.minimum(best, travel), best)
    return best


def _corner_entry(patch: FreeformPatch, p: Array, d: Array, radius: float) -> Array:
    """Travel to the four upright edges of the column, patch frame, (N,), mm; inf where missed."""
    best = np.full(len(p), np.inf)
    across = np.hypot(d[:, 0], d[:, 1])
    moving = across > 1e-9
    flat = np.where(moving[:, None], d[:, :2] / np.where(moving, across, 1.0)[:, None], [1.0, 0.0])
    for x in (-patch.half_size[0], patch.half_size[0]):
        for y in (-patch.half_size[1], patch.half_size[1]):
            # In the plane across the edge the ball is a disc that meets a point.
            travel = sphere_entry(np.array([x, y]), p[:, :2], flat, radius)
            travel = travel / np.where(moving, across, 1.0)
            reached = moving & np.isfinite(travel) & (travel >= 0.0)
            z = p[:, 2] + np.where(reached, travel, 0.0) * d[:, 2]
            top = patch.height(np.array([[x, y]]))[0]
            reached &= (z >= -patch.depth) & (z <= top)
            best = np.where(reached, np.minimum(best, travel), best)
    return best


def _meet_sphere(
    race: _Race, standard: Standard, sphere: DatumSphere, p: Array, d: Array, radius: float
) -> None:
    everyone = np.arange(len(p))
    hit = sphere.contact(p, d, radius)
    travel = np.where(np.isnan(hit.travel), np.inf, hit.travel)
    free = sphere.contains(hit.uv)
    race.offer(travel[free], sphere.name, Meeting.SURFACE, everyone[free], hit.uv[free])
    race.offer(travel[~free], sphere.name, Meeting.SIDE, everyone[~free])
    stem = entry(standard.stems[sphere.name], p, d, radius)
    race.offer(stem, sphere.name, Meeting.SIDE, everyone)


def _meet_base(race: _Race, standard: Standard, p: Array, d: Array, radius: float) -> None:
    """The base: its upper face counts as the datum plane, a bore or hole in it as a side."""
    everyone = np.arange(len(p))
    plane = standard.plane
    travel = entry(standard.base.body, p, d, radius)
    end = p + np.where(np.isfinite(travel), travel, 0.0)[:, None] * d
    on_top = np.isfinite(travel) & (np.abs(end[:, 2] - plane.height - radius) < NM)
    on_top &= plane.contains(end[:, :2])
    race.offer(travel[~on_top], "BASE", Meeting.SIDE, everyone[~on_top])
    for hole in standard.holes:
        over = on_top & (np.hypot(end[:, 0] - hole.x, end[:, 1] - hole.y) <= hole.bore_radius)
        race.offer(travel[over], hole.name, Meeting.SIDE, everyone[over])
        on_top &= ~over
    race.offer(travel[on_top], plane.name, Meeting.SURFACE, everyone[on_top], end[on_top, :2])
