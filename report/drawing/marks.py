"""What is written at the views: dimensions, datums with their targets, tolerances, cuts, axes."""

from dataclasses import dataclass
from itertools import product

import numpy as np

from matstd.artefact.body import DatumSphere, FreeformPatch, MountingHole, Standard
from matstd.cad_out.details import BALL_SIZE, Details, datum_touches, tolerances_of
from matstd.report.drawing.sections import BALL_CUT, FACE_CUT, HOLE_CUT, LARGE, section_of
from matstd.report.drawing.sheet import Sheet, View
from matstd.twin.frames import Array

BELOW = 42.0  # how far the marks of the view from above reach below it, mm of paper
_FRAME, _DIMENSION = 27.0, 35.0  # mm of paper below the view from above
_BEYOND = (5.0, 8.0, 11.0)  # mm of paper between a body and the marks of its cut
_HALF, _BACK = 3.6, 14.0  # mm of paper: half of a mark of a cut, and how far it reaches back


@dataclass(frozen=True, slots=True)
class Views:
    """The three views: from the front, from the left, from above."""

    front: View
    left: View
    top: View


def draw_dimensions(sheet: Sheet, views: Views, standard: Standard, tall: float) -> None:
    """Sizes of plate and whole; every place is in the tables."""
    (a, b), thick = standard.base.half_size, standard.base.thickness
    p, q = views.front.at([[-a, 0.0], [-a, thick]])
    sheet.dimension(p, q, 8.0, f"{thick:g}")
    highest = views.front.at([[-a, tall]])[0]
    sheet.dimension(p, highest, 16.0, f"({tall:.1f})")
    p, q = views.top.at([[-a, -b], [a, -b]])
    sheet.dimension(p, q, -_DIMENSION, f"{2 * a:g}")
    p, q = views.top.at([[a, -b], [a, b]])
    sheet.dimension(p, q, -9.0, f"{2 * b:g}")
    radius = standard.base.corner_radius
    corner = np.array([a, b]) - radius * (1.0 - np.sqrt(0.5))
    tip = views.top.at(corner)[0]
    round_plate = radius > 0.99 * min(a, b)
    elbow = views.top.at([[a, b]])[0] + [2.0, 5.0]  # above the line of the dimension beside it
    sheet.leader(tip, elbow, f"R{radius:g}" if round_plate else f"4 x R{radius:g}")


def draw_datums(sheet: Sheet, views: Views, standard: Standard, details: Details) -> None:
    """Letters and targets on their faces (ISO 5459), each with the tolerance of its face."""
    (_, b), thick = standard.base.half_size, standard.base.thickness
    down, west, up = np.array([0.0, -1.0]), np.array([-1.0, 0.0]), np.array([0.0, 1.0])
    held = {t.face: (t.kind, f"{t.width:g}", t.datums) for t in tolerances_of(standard, details)}
    # beside the view: on the face itself pillars and posts are in the way
    end = views.left.at([[b, thick]])[0]
    sheet.line(end + np.array([[1.0, 0.0], [16.0, 0.0]]))
    sheet.datum(np.add(end, [7.0, 0.0]), up, "A")
    sheet.attached(np.add(end, [-2.0, 18.0]), *held["DATUM_A"], np.add(end, [13.0, 0.0]))
    beside = views.front.at([[standard.base.half_size[0], thick]])[0]
    sheet.line(beside + np.array([[1.0, 0.0], [20.0, 0.0]]))
    sheet.roughness(np.add(beside, [4.0, 0.0]), "Ra 0.8")
    targets = datum_touches(standard)
    for side, names in (("DATUM_B", ("B1", "B2")), ("DATUM_C", ("C1",))):
        points, normal = targets[side]
        for name, point in zip(names, points, strict=True):
            place = views.top.at(point[:2])[0]
            sheet.target(place, place + 12.0 * normal[:2] + 3.0 * np.array([1.0, 0.0]), name)
    south = views.top.at([[0.0, -details.sides["DATUM_B"].offset]])[0]
    sheet.datum(np.add(south, [-8.0, 0.0]), down, "B")
    sheet.text(south[0] - 4.5, south[1] - 10.3, "B1, 2")
    sheet.attached(np.add(south, [-12.0, -_FRAME]), *held["DATUM_B"], np.add(south, [8.0, 0.0]))
    west_side = details.sides["DATUM_C"]
    corner = views.top.at([[-west_side.offset, b]])[0]
    at = views.top.at([[-west_side.offset, 0.85 * west_side.half_length]])[0]
    sheet.datum(np.add(at, [0.0, -7.0]), west, "C")
    sheet.text(at[0] - 11.0, at[1] - 3.5, "C1")
    sheet.attached(np.add(corner, [-21.0, 6.0]), *held["DATUM_C"], at)


def draw_tolerances(sheet: Sheet, views: Views, standard: Standard, details: Details) -> None:
    """Tolerances of pads, small faces and balls, each at one of them.

    In the view from the left one looks along +x, so that y runs to the left.
    """
    held = tolerances_of(standard, details)
    low = views.left.at([[-standard.base.half_size[1], 0.0]])[0]
    seat = next(t for t in held if t.kind == "parallelism")
    under, words, zone = views.left.at([[0.0, 0.0]])[0], "underside", f"{seat.width:g}"
    if details.pads:
        pad = max(details.pads, key=lambda one: one.y)
        under, words = views.left.at([[-pad.y, 0.0]])[0], f"{len(details.pads)} x pad"
        zone += " CZ"
    sheet.attached((low[0] + 20.0, low[1] - 16.0), seat.kind, zone, seat.datums, under, words)
    if standard.patches and large_face(standard) is None:
        profile = next(t for t in held if t.kind == "profile")
        tip, edge = _free_face(sheet, views.top, standard)
        count = len(standard.patches)
        sheet.attached((tip[0] - 12.0, edge + 14.0), profile.kind, f"{profile.width:g}",
                       profile.datums, tip, f"{count} x FF")  # fmt: skip
    if standard.spheres:
        ball = max(standard.spheres, key=lambda one: float(one.centre[2]))
        tip = views.left.at([[-ball.centre[1], ball.centre[2] + ball.radius]])[0]
        width = next(t for t in held if t.face == f"{ball.name}_SEAT").width
        # under the size of a sphere a frame holds for its centre (ISO 1101)
        words = f"{len(standard.spheres)} x SØ{2 * ball.radius:g} ±{BALL_SIZE:g}"
        at = (np.clip(tip[0] - 20.0, low[0], low[0] + 90.0), tip[1] + 9.0)
        sheet.attached(at, "position", f"SØ{width:g}", "ABC", tip, words)


def large_face(standard: Standard) -> FreeformPatch | None:
    """The only face of a standard, if it is large enough for a section of its own."""
    patch = standard.patches[0] if len(standard.patches) == 1 else None
    return patch if patch and min(patch.half_size) >= LARGE and patch.is_upright else None


def _free_face(sheet: Sheet, top: View, standard: Standard) -> tuple[Array, float]:
    """The upper edge of the face above which least is drawn, and where the plate ends, on paper."""
    edge = float(top.at([[0.0, standard.base.half_size[1]]])[0, 1])
    found = []
    for patch in standard.patches:
        rim = patch.point(patch.grid())
        x = 0.5 * (rim[:, 0].min() + rim[:, 0].max())
        tip = top.at([[x, rim[:, 1].max()]])[0]
        crowd = sheet.crowd(np.add(tip, [-2.0, 1.0]), [tip[0] + 2.0, edge + 12.0])
        found.append((crowd, -tip[1], tip))
    return min(found, key=lambda one: one[:2])[2], edge


def draw_cuts(
    sheet: Sheet, top: View, standard: Standard, details: Details
) -> tuple[DatumSphere | None, MountingHole | None]:
    """Cutting planes of the sections, through the ball and the hole that have most room."""
    balls = [(one.centre[:2], one.foot_radius) for one in standard.spheres]
    pads = {(pad.x, pad.y): pad.radius for pad in details.pads}
    holes = [
        (np.array([one.x, one.y]), max(one.bore_radius, pads.get((one.x, one.y), 0.0)))
        for one in standard.holes
    ]
    ball, hole = (
        _cut(sheet, top, places, letter) if places else None
        for places, letter in ((balls, BALL_CUT), (holes, HOLE_CUT))
    )
    face = large_face(standard)
    if face is not None:
        for side in (-1.0, 1.0):
            place = [side * (standard.base.half_size[0] + 14.0 / top.scale), section_of(face)]
            sheet.cut(top.at([place])[0], np.array([0.0, 1.0]), FACE_CUT)
    return (
        None if ball is None else standard.spheres[ball],
        None if hole is None else standard.holes[hole],
    )


def _cut(sheet: Sheet, top: View, places: list[tuple[Array, float]], letter: str) -> int:
    """Marks of an upright cut through the round body that leaves them most room; its number."""

    def marks(number: int, way: Array, beyond: float) -> list[Array]:
        middle, radius = places[number]
        beside = (top.scale * radius + beyond) * np.array([way[1], -way[0]])
        return [top.at(middle)[0] + side * beside for side in (-1.0, 1.0)]

    def crowd(choice: tuple[int, Array, float]) -> int:
        way = choice[1]
        across = np.abs([way[1], way[0]])
        return sum(
            sheet.crowd(*np.sort([at - _BACK * way - _HALF * across, at + _HALF * across], axis=0))
            for at in marks(*choice)
        )

    ways = [np.array(way) for way in ((0.0, 1.0), (-1.0, 0.0), (0.0, -1.0), (1.0, 0.0))]
    chosen = min(product(range(len(places)), ways, _BEYOND), key=crowd)
    for at in marks(*chosen):
        sheet.cut(at, chosen[1], letter)
    return chosen[0]


def draw_axes(sheet: Sheet, top: View) -> None:
    """Axes of the coordinates in the tables."""
    for way, name in (((30.0, 0.0), "X"), ((0.0, 30.0), "Y")):
        ends = top.at([[0.0, 0.0], way])
        sheet.line(ends, 0.35)
        sheet.arrow(ends[1], np.array(way))
        sheet.text(ends[1][0] + 1.5, ends[1][1] + 1.0, name, size=3.0)
