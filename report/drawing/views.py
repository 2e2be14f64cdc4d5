"""Three views of a standard, drawn far to near so that what is behind is hidden."""

from dataclasses import dataclass

import numpy as np

from matstd.artefact.body import DatumSphere, FreeformPatch, Standard
from matstd.cad_out.details import DOT, RELIEF, Details
from matstd.report.drawing.sheet import LETTER_HEIGHT, THIN, WIDE, Sheet, View, length_of
from matstd.twin.frames import Array, apply
from matstd.twin.sampling import grid_points

_SAMPLES = 41  # along an edge of a face, at least: one every 2 mm of a large one
_ROOM = 0.6  # mm of paper round a name that is clear of what is before it
_LEVELS = 6  # lines of equal height on a face


def draw_top(sheet: Sheet, view: View, standard: Standard, details: Details) -> None:
    """From above: plate, holes, pillars with lines of equal height, balls, lettering."""
    base = standard.base
    sheet.line(view.at(_outline(base.half_size, base.corner_radius, details)), WIDE, fill="white")
    for pad in details.pads:
        sheet.circle(view.at([pad.x, pad.y])[0], view.scale * pad.radius, THIN, "--")
    _holes(sheet, view, standard, details)
    for patch in standard.patches:
        _patch_from_above(sheet, view, patch)
    for sphere in standard.spheres:
        middle = view.at(sphere.centre[:2])[0]
        sheet.circle(middle, view.scale * max(sphere.foot_radius, sphere.radius), fill="white")
        sheet.circle(middle, view.scale * sphere.radius)
        _cross(sheet, view, sphere.centre[:2], sphere.radius)
        sheet.text(middle[0] + 0.6, middle[1] + 0.6, sphere.name.removeprefix("SPH"))
    for line in details.lettering:
        if line.T_artefact_text[2, 2] > 0.5:
            for dot in apply(line.T_artefact_text, np.pad(line.dots, ((0, 0), (0, 1)))):
                sheet.circle(view.at(dot[:2])[0], view.scale * DOT, 0.13)


def _holes(sheet: Sheet, view: View, standard: Standard, details: Details) -> None:
    for hole in standard.holes:
        for radius in (hole.bore_radius, hole.radius):
            sheet.circle(view.at([hole.x, hole.y])[0], view.scale * radius)
        _cross(sheet, view, np.array([hole.x, hole.y]), hole.bore_radius)
    for bore in details.bores:
        begin = np.array(bore.mouth[:2])
        if bore.direction[2] < 0.0:
            sheet.circle(view.at(begin)[0], view.scale * bore.radius)
            _cross(sheet, view, begin, bore.radius)
        else:
            along = np.array(bore.direction[:2])
            across = bore.radius * np.array([-along[1], along[0]])
            end = begin + bore.depth * along
            corners = [begin + across, end + across, end - across, begin - across]
            sheet.line(view.at(corners), THIN, "--")


def draw_hole_names(sheet: Sheet, view: View, standard: Standard, details: Details) -> None:
    """Names of holes and bores from above, where they find their way round what is drawn."""
    pads = {(pad.x, pad.y): pad.radius for pad in details.pads}
    for hole in standard.holes:
        radius = max(hole.bore_radius, pads.get((hole.x, hole.y), 0.0))
        sheet.label(view.at([hole.x, hole.y])[0], view.scale * radius, hole.name)
    for bore in details.bores:
        sheet.label(view.at(bore.mouth[:2])[0], view.scale * bore.radius, bore.name)


def _outline(half: tuple[float, float], radius: float, details: Details) -> Array:
    """Corners of the plate from above, its flats cut off."""
    t = np.linspace(0.0, 0.5 * np.pi, 25)
    points = np.concatenate(
        [
            np.array([sx * (half[0] - radius), sy * (half[1] - radius)])
            + radius * np.column_stack([np.cos(t + turn), np.sin(t + turn)])
            for sx, sy, turn in (
                (1, 1, 0.0), (-1, 1, 0.5 * np.pi), (-1, -1, np.pi), (1, -1, 1.5 * np.pi)
            )
        ]
    )  # fmt: skip
    for side in details.sides.values():
        axis = 0 if side.normal[0] else 1
        sign = float(side.normal[axis])
        points[:, axis] = sign * np.minimum(sign * points[:, axis], side.offset)
    return np.concatenate([points, points[:1]])


def _patch_from_above(sheet: Sheet, view: View, patch: FreeformPatch) -> None:
    a, b = patch.half_size
    corners = np.array([[-a, -b], [a, -b], [a, b], [-a, b], [-a, -b]])
    rim = apply(patch.T_artefact_patch, np.column_stack([corners, patch.height(corners)]))
    sheet.line(view.at(rim[:, :2]), WIDE, fill="white")
    points = _points_over(patch)
    x, y = np.moveaxis(view.at(points[..., :2].reshape(-1, 2)).reshape(*points.shape[:2], 2), 2, 0)
    sheet.contours(x, y, points[..., 2], _LEVELS)
    x, y = view.at([rim[:, 0].min(), rim[:, 1].max()])[0] + [2.0, -5.0]
    sheet.line([[x - 1.0, y - 1.0], [x + 9.0, y - 1.0], [x + 9.0, y + 3.5], [x - 1.0, y + 3.5]],
               0.0, fill="white")  # fmt: skip
    sheet.text(x, y, patch.name, size=3.0)


def _points_over(patch: FreeformPatch) -> Array:
    """Points of a face on a regular grid, (U, V, 3), mm."""
    u, v = (np.linspace(-half, half, max(_SAMPLES, round(half))) for half in patch.half_size)
    return patch.point(grid_points(u, v)).reshape(len(u), len(v), 3)


def _cross(sheet: Sheet, view: View, middle: Array, radius: float) -> None:
    reach = radius + 3.0 / view.scale * 0.5
    for way in (np.array([reach, 0.0]), np.array([0.0, reach])):
        sheet.line(view.at([middle - way, middle + way]), 0.13, "-.")


def draw_from(
    sheet: Sheet, view: View, standard: Standard, details: Details, towards: Array
) -> None:
    """A view along a horizontal direction.

    Args:
        view: Its origin is the middle of the underside.
        towards: Unit vector in which one looks, (3,).
    """
    right = np.cross(towards, [0.0, 0.0, 1.0])
    base = standard.base
    seen = [_pillar(patch, right, towards, base.thickness) for patch in standard.patches]
    seen += [_post(sphere, details, right, towards) for sphere in standard.spheres]
    seen.sort(key=lambda one: -one.depth)
    for one in seen:
        for outline in one.outlines:
            sheet.line(view.at(outline), WIDE, fill="white")
        if len(one.edge):
            sheet.line(view.at(one.edge), THIN)
    half = float(np.abs(right[:2]) @ base.half_size)
    low = RELIEF if details.pads else 0.0
    block = [[-half, low], [half, low], [half, base.thickness], [-half, base.thickness]]
    sheet.line(view.at([*block, block[0]]), WIDE, fill="white")
    for sign in (-1.0, 1.0):
        edge = sign * (half - base.corner_radius)
        sheet.line(view.at([[edge, low], [edge, base.thickness]]), 0.13)
    for pad in details.pads:
        at = float(np.array([pad.x, pad.y]) @ right[:2])
        corners = [[at - pad.radius, low], [at - pad.radius, 0.0], [at + pad.radius, 0.0]]
        sheet.line(view.at([*corners, [at + pad.radius, low]]), WIDE)
    _name_what_is_seen(sheet, view, seen)


@dataclass(frozen=True, eq=False)
class _Seen:
    """A pillar or a post with its ball, as one sees it from a side; millimetres of the part."""

    name: str
    depth: float
    outlines: list[Array]
    edge: Array
    middle: Array


def _name_what_is_seen(sheet: Sheet, view: View, seen: list[_Seen]) -> None:
    """Names of bodies, from far to near, where nothing nearer stands before them."""
    from matplotlib.path import Path

    for k, one in enumerate(seen):
        at = view.at(one.middle)[0]
        half = np.array([0.5 * length_of(one.name), 0.5 * LETTER_HEIGHT]) + _ROOM
        corners = at + half * [[-1, -1], [1, -1], [1, 1], [-1, 1], [0, 0]]
        nearer = (Path(view.at(outline)) for body in seen[k + 1 :] for outline in body.outlines)
        if not any(path.contains_points(corners).any() for path in nearer):
            sheet.text(at[0], at[1] - 1.0, one.name, ha="center")


def _pillar(patch: FreeformPatch, right: Array, towards: Array, foot: float) -> _Seen:
    """Walls, the outline of the face, and its nearer edge."""
    grid = _points_over(patch)
    if abs(right[0]) < 0.5:  # along x: what was one edge after the other is the depth
        grid = grid.transpose(1, 0, 2)
    along, top = (grid @ right).mean(axis=1), grid[:, :, 2].max(axis=1)
    front = grid[:, 0, 2]
    rim = np.column_stack([along, top])
    outline = np.concatenate([rim, [[along[-1], foot], [along[0], foot]], rim[:1]])
    return _Seen(
        name=patch.name,
        depth=float(patch.T_artefact_patch[:3, 3] @ towards),
        outlines=[outline],
        edge=np.column_stack([along, front]),
        middle=np.array([along.mean(), 0.5 * (foot + front.mean())]),
    )


def _post(sphere: DatumSphere, details: Details, right: Array, towards: Array) -> _Seen:
    seat, at = details.seats[sphere.name], float(sphere.centre @ right)
    low, high = sphere.foot_radius, seat.top_radius
    flank = [[at - low, sphere.foot], [at - high, seat.top], [at + high, seat.top]]
    flank += [[at + low, sphere.foot], flank[0]]
    t = np.linspace(0.0, 2.0 * np.pi, 97)
    middle = np.array([at, sphere.centre[2]])
    ring = middle + sphere.radius * np.column_stack([np.cos(t), np.sin(t)])
    number = sphere.name.removeprefix("SPH")
    depth = float(sphere.centre @ towards)
    return _Seen(
        name=number,
        depth=depth,
        outlines=[np.array(flank), ring],
        edge=np.empty((0, 2)),
        middle=middle,
    )
