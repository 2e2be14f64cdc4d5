"""The whole sheet."""

from dataclasses import dataclass
from pathlib import Path
from textwrap import wrap
from typing import Any

import numpy as np

from matstd.artefact.body import DatumSphere, FreeformPatch, Standard, max_slope, min_concave_radius
from matstd.cad_out.details import (
    BALL,
    DATUMS,
    Details,
    Tolerance,
    datum_touches,
    details_of,
    notes_of,
    tolerances_of,
)
from matstd.report.drawing.sections import (
    BALL_CUT,
    FACE_CUT,
    HOLE_CUT,
    LARGE,
    draw_face,
    draw_screw,
    draw_seat,
    engraving_words,
    joint_words,
    section_of,
)
from matstd.report.drawing.sheet import A1, A2, Paper, Sheet, View
from matstd.report.drawing.views import draw_from, draw_top
from matstd.twin.files import written_whole
from matstd.twin.units import DEG
from matstd.twin.versions import versions

DRAWING = ("drawing.pdf", "drawing.svg")
"""Names of the files."""

_SCALES = (2.0, 1.0, 0.5, 0.2, 0.1)  # of ISO 5455
_SMALLEST = 0.5  # scale of the views below which the sheet is larger
_LEFT, _ABOVE = 44.0, 28.0  # mm of paper: where the views begin, from the left and the upper edge
_BESIDE = (276.0, 48.0)  # mm of paper that the three views leave to tables and margins
_WIDE_TABLES = 198.0  # mm of paper, with the margin beside them
_FLAT = 10_000.0  # mm: a ball of 3 mm cannot distinguish such a face from a plane


@dataclass(frozen=True, slots=True)
class Issuer:
    """Who answers for a drawing."""

    author: str  # responsible for the design
    organisation: str  # whom the author works for
    mass: float  # mass of body and balls, kg
    approved: str = "not stated"  # who approved the drawing
    date: str = "not stated"  # date of its issue


def write_drawing(folder: Path, standard: Standard, issuer: Issuer) -> None:
    """One sheet as PDF and SVG, the same bytes for the same standard."""
    import matplotlib

    details = details_of(standard)
    sheet = draw_sheet(standard, details, issuer)
    fixed: list[dict[str, Any]] = [{"CreationDate": None, "ModDate": None}, {"Date": None}]
    with matplotlib.rc_context({"svg.hashsalt": "matstd", "pdf.fonttype": 42}):
        for name, metadata in zip(DRAWING, fixed, strict=True):
            with written_whole(folder / name) as part:
                sheet.figure.savefig(part, format=name[-3:], metadata=metadata)


def draw_sheet(standard: Standard, details: Details, issuer: Issuer) -> Sheet:
    """Views, sections, tables, notes and title block."""
    (a, b), tall = standard.base.half_size, _tallest(standard)
    sheet, scale = Sheet(A2), _scale(standard, A2)
    if scale < _SMALLEST:
        sheet, scale = Sheet(A1), _scale(standard, A1)
    begin = sheet.paper.height - _ABOVE
    floor = begin - 12.0 - scale * tall
    front = View(_LEFT + scale * a, floor, scale)
    left = View(_LEFT + scale * 2 * a + 36.0 + scale * b, floor, scale)
    top = View(front.x, floor - 46.0 - scale * b, scale)
    draw_from(sheet, front, standard, details, np.array([0.0, 1.0, 0.0]))
    draw_from(sheet, left, standard, details, np.array([1.0, 0.0, 0.0]))
    draw_top(sheet, top, standard, details)
    _dimensions(sheet, front, top, standard, tall)
    _datums(sheet, front, top, left, standard, details)
    _axes(sheet, top)
    _cuts(sheet, top, standard)
    if standard.spheres:
        enlarged = 2.0 if standard.spheres[0].radius <= 16.0 else 1.0
        x, y = top.x + scale * a + 74.0, floor - 76.0
        if sheet.paper is A1:  # with room for the next scale
            enlarged, x, y = 2.5 * enlarged, x + 50.0, y - 45.0
        draw_seat(sheet, View(x, y, enlarged), standard, details)
    if standard.holes:
        aside = 70.0 if sheet.paper is A2 else 140.0
        draw_screw(sheet, View(top.x + scale * a + aside, 62.0, 1.0), standard, details)
    _large_face(sheet, top, standard)
    low = _tables(sheet, standard, details)
    _notes(sheet, low - 8.0, standard, details)
    _title(sheet, standard, issuer, scale)
    return sheet


def _large_face(sheet: Sheet, top: View, standard: Standard) -> None:
    """Section of a large face below the view from above, as large as its room allows."""
    large = [p for p in standard.patches if min(p.half_size) >= LARGE and p.is_upright]
    if len(standard.patches) != 1 or not large:
        return
    patch, a = large[0], standard.base.half_size[0]
    aside = 20.0 if sheet.paper is A2 else 80.0
    most = (top.x + top.scale * a + aside - _LEFT) / (2.0 * patch.half_size[0] + 24.0)
    scale = next((s for s in _SCALES if s <= min(most, 1.0)), top.scale)
    draw_face(sheet, View(_LEFT + scale * (patch.half_size[0] + 12.0) + 6.0, 34.0, scale),
              standard, patch)  # fmt: skip
    for side in (-1.0, 1.0):
        end = top.at([side * (a + 14.0 / top.scale), section_of(patch)])[0]
        sheet.cut(end, np.array([0.0, 1.0]), FACE_CUT)


def _scale(standard: Standard, paper: Paper) -> float:
    """The largest scale of ISO 5455 at which the three views fit on a paper."""
    (a, b), tall = standard.base.half_size, _tallest(standard)
    wide, high = (total - taken for total, taken in zip(paper.size, _BESIDE, strict=True))
    most = min((wide - 36.0) / (2.0 * (a + b)), (high - 90.0) / (tall + 2.0 * b))
    return next((s for s in _SCALES if s <= most), _SCALES[-1])


def _tallest(standard: Standard) -> float:
    tops = [s.centre[2] + s.radius for s in standard.spheres]
    tops += [float(p.point(p.grid())[:, 2].max()) for p in standard.patches]
    return float(max(tops))


def _dimensions(sheet: Sheet, front: View, top: View, standard: Standard, tall: float) -> None:
    (a, b), thick = standard.base.half_size, standard.base.thickness
    p, q = front.at([[-a, 0.0], [-a, thick]])
    sheet.dimension(p, q, 8.0, f"{thick:g}")
    highest = front.at([[-a, tall]])[0]
    sheet.dimension(p, highest, 16.0, f"({tall:.1f})")
    p, q = top.at([[-a, -b], [a, -b]])
    sheet.dimension(p, q, -24.0, f"{2 * a:g}")  # below the targets of datum B
    p, q = top.at([[a, -b], [a, b]])
    sheet.dimension(p, q, -9.0, f"{2 * b:g}")
    radius = standard.base.corner_radius
    corner = np.array([a, b]) - radius * (1.0 - np.sqrt(0.5))
    tip = top.at(corner)[0]
    sheet.leader(tip, np.add(tip, [6.0, 6.0]), f"R{radius:g}")


def _datums(
    sheet: Sheet, front: View, top: View, left: View, standard: Standard, details: Details
) -> None:
    """Letters and targets on their faces, and tolerances attached to what they hold for."""
    (a, b), thick = standard.base.half_size, standard.base.thickness
    down, west, up = np.array([0.0, -1.0]), np.array([-1.0, 0.0]), np.array([0.0, 1.0])
    # beside the view: on the face itself pillars and posts are in the way
    end = left.at([[b, thick]])[0]
    sheet.line(end + np.array([[1.0, 0.0], [16.0, 0.0]]))
    sheet.datum(np.add(end, [7.0, 0.0]), up, "A")
    south = top.at([[-0.2 * a, -details.sides["DATUM_B"].offset]])[0]
    west_side = top.at([[-details.sides["DATUM_C"].offset, 0.75 * b]])[0]
    sheet.datum(south, down, "B")
    sheet.datum(west_side, west, "C")
    sheet.line(front.at([[a, thick]])[0] + np.array([[1.0, 0.0], [20.0, 0.0]]))
    sheet.roughness(np.add(front.at([[a, thick]])[0], [4.0, 0.0]), "Ra 0.8")
    names = {"DATUM_B": ("B1", "B2"), "DATUM_C": ("C1",)}
    for side, (points, normal) in datum_touches(standard).items():
        for name, point in zip(names.get(side, ()), points, strict=False):
            place = top.at(point[:2])[0]
            sheet.target(place, place + 12.0 * normal[:2] + 3.0 * np.array([1.0, 0.0]), name)
    tolerances = {t.face: t for t in tolerances_of(standard, details)}
    _attached(sheet, np.add(end, [-2.0, 18.0]), tolerances["DATUM_A"], np.add(end, [13.0, 0.0]))
    _attached(sheet, np.add(south, [8.0, -13.0]), tolerances["DATUM_B"], np.add(south, [5.0, 0.0]))
    corner = np.add(west_side, [-20.0, 22.0])
    _attached(sheet, corner, tolerances["DATUM_C"], np.add(west_side, [0.0, 6.0]))
    _of_features(sheet, left, top, standard, details, tolerances)


def _of_features(
    sheet: Sheet,
    left: View,
    top: View,
    standard: Standard,
    details: Details,
    tolerances: dict[str, Tolerance],
) -> None:
    """Tolerances of pads, faces and balls, each at one of them.

    In the view from the left one looks along +x, so that y runs to the left.
    """
    low = left.at([[-standard.base.half_size[1], 0.0]])[0]
    high = sheet.paper.height - _ABOVE + 2.0
    seat = next(t for t in tolerances.values() if t.kind == "parallelism")
    at, words = (low[0] + 20.0, low[1] - 16.0), "underside"
    under = left.at([[0.0, 0.0]])[0]
    if details.pads:
        pad = max(details.pads, key=lambda one: one.y)
        under, words = left.at([[-pad.y, 0.0]])[0], f"{len(details.pads)} x pad"
    _attached(sheet, at, seat, under, words, "CZ" if details.pads else "")
    if standard.patches:
        patch = max(standard.patches, key=lambda p: float(p.T_artefact_patch[1, 3]))
        rim = patch.point(patch.grid())
        middle = 0.5 * (rim[:, 0].min() + rim[:, 0].max())
        tip = top.at([[middle, rim[:, 1].max()]])[0]  # from above nothing hides it
        edge = top.at([[0.0, standard.base.half_size[1]]])[0]
        # above the frame of datum C, which stands 22 to 28 mm above three quarters of the side
        above = max(6.0, 30.0 - 0.25 * top.scale * standard.base.half_size[1])
        count = len(standard.patches)
        words = f"{count} x FF" if count > 1 else patch.name
        _attached(sheet, (tip[0] - 18.0, edge[1] + above), tolerances[patch.name], tip, words)
    if standard.spheres:
        ball = max(standard.spheres, key=lambda one: float(one.centre[2]))
        centre = left.at([[-ball.centre[1], ball.centre[2] + ball.radius]])[0]
        width = tolerances[f"{ball.name}_SEAT"].width
        place = Tolerance(ball.name, "position", width, "ABC")
        words = f"{len(standard.spheres)} x SØ{2 * ball.radius:g}, centre"
        _attached(sheet, (low[0] + 50.0, high), place, centre, words)


def _attached(
    sheet: Sheet, at: Any, tolerance: Tolerance, tip: Any, words: str = "", zone: str = ""
) -> None:
    """A tolerance frame with its leader to the feature, and words above the frame."""
    width = f"{tolerance.width:g} {zone}".rstrip()
    width = f"SØ{width}" if tolerance.kind == "position" else width
    x, y = float(at[0]), float(at[1])
    long = sheet.tolerance(x, y, tolerance.kind, width, tolerance.datums)
    goal = np.asarray(tip, dtype=float)
    start = np.array([x + 0.5 * long, y + 6.0 if goal[1] > y else y])
    sheet.line([start, goal])
    sheet.arrow(goal, goal - start)
    if words:
        beside = (x + long + 1.5, y + 1.8) if goal[1] > y else (x, y + 6.8)
        sheet.text(*beside, words)


def _cuts(sheet: Sheet, top: View, standard: Standard) -> None:
    """Cutting planes of the sections, through the ball and the hole that they show."""
    cut = [(s.centre[:2], s.foot_radius, BALL_CUT) for s in standard.spheres[:1]]
    cut += [(np.array([h.x, h.y]), h.bore_radius, HOLE_CUT) for h in standard.holes[:1]]
    for middle, radius, letter in cut:
        at = top.at(middle)[0]
        for side in (-1.0, 1.0):
            beside = [side * (top.scale * radius + 5.0), 0.0]
            sheet.cut(np.add(at, beside), np.array([0.0, 1.0]), letter)


def _axes(sheet: Sheet, top: View) -> None:
    for way, name in (((30.0, 0.0), "X"), ((0.0, 30.0), "Y")):
        ends = top.at([[0.0, 0.0], way])
        sheet.line(ends, 0.35)
        sheet.arrow(ends[1], np.array(way))
        sheet.text(ends[1][0] + 1.5, ends[1][1] + 1.0, name, size=3.0)


def _tables(sheet: Sheet, standard: Standard, details: Details) -> float:
    """Faces, balls and holes with their places; returns the height of the lower edge."""
    x, y = sheet.paper.width - _WIDE_TABLES, sheet.paper.height - _ABOVE + 9.0
    if standard.patches:
        rows = [["face", "x", "y", "z", "size", "slope", "R", "tests; dominant errors"]]
        rows += [_face_row(patch) for patch in standard.patches]
        title = "Freeform faces (middle, steepest slope, least concave radius between their edges)"
        y = sheet.table(x, y - 9.0, (11, 15, 15, 14, 26, 12, 16, 79), rows, title)
    rows = [["ball", "x", "y", "z", "Ø", "foot", "land", "land z", "sink",
             "identifies; calibrated"]]  # fmt: skip
    rows += [_ball_row(ball, details) for ball in standard.spheres]
    title = f"Balls (centres), {BALL.name}, and their posts"
    y = sheet.table(x, y - 9.0, (15, 15, 15, 15, 9, 16, 18, 16, 13, 56), rows, title)
    rows = [["hole", "x", "y", "z", "through", "counterbore", "pad", "for"]]
    rows += _hole_rows(standard, details)
    title = "Holes (middles of their mouths)"
    return sheet.table(x, y - 9.0, (18, 16, 16, 12, 24, 26, 16, 60), rows, title)


def _hole_rows(standard: Standard, details: Details) -> list[list[str]]:
    out, top = [], f"{standard.base.thickness:g}"
    pads = {(pad.x, pad.y): f"Ø{2 * pad.radius:g}" for pad in details.pads}
    for h in standard.holes:
        sizes = [f"Ø{2 * h.radius:g}", f"Ø{2 * h.bore_radius:g} x {h.bore_depth:g}"]
        sizes.append(pads.get((h.x, h.y), ""))
        out.append([h.name, f"{h.x:.1f}", f"{h.y:.1f}", top, *sizes, "screw to the table"])
    for bore in details.bores:
        x, y, z = bore.mouth
        sizes = [f"Ø{2 * bore.radius:g} x {bore.depth:g}", bore.thread, ""]
        purpose = "eyebolt" if bore.thread else "thermometer, side +y"
        out.append([bore.name, f"{x:.1f}", f"{y:.1f}", f"{z:g}", *sizes, purpose])
    return out


def _ball_row(ball: DatumSphere, details: Details) -> list[str]:
    seat = details.seats[ball.name]
    return [
        ball.name,
        *(f"{c:.1f}" for c in ball.centre),
        f"{2 * ball.radius:g}",
        f"Ø{2 * ball.foot_radius:.1f}",
        f"Ø{2 * seat.top_radius:.2f}",
        f"{seat.top:.2f}",
        f"{2 * seat.half_angle / DEG:.0f}°",
        f"{'no, proves' if ball.proves else 'yes'}; centre and form",
    ]


def _face_row(patch: FreeformPatch) -> list[str]:
    x, y, z = patch.point(np.zeros((1, 2)))[0]
    radius = min_concave_radius(patch)
    shares = ", ".join(f"{e.name} {100 * e.share:.0f} %" for e in patch.errors[:5])
    return [
        patch.name,
        *(f"{c:.1f}" for c in (x, y, z)),
        f"{2 * patch.half_size[0]:g} x {2 * patch.half_size[1]:g}",
        f"{max_slope(patch) / DEG:.0f}°",
        f"{radius:.1f}" if radius < _FLAT else "convex",
        shares or "a face of a calibrated workpiece",
    ]


def _notes(sheet: Sheet, top: float, standard: Standard, details: Details) -> None:
    x = sheet.paper.width - _WIDE_TABLES
    sheet.text(x, top, "Notes", size=3.0)
    words = [*notes_of(standard, details), engraving_words()]
    words += [f"Omitted for lack of space: {what}." for what in details.missing]
    words += joint_words(standard, details)
    faces = ", ".join(f"{letter} = {face}" for letter, face in DATUMS.items())
    words.append(f"Names of faces as in standard.step: {faces}; that model is the definition.")
    for number, note in enumerate(words, 1):
        top -= 5.2
        for plain, sign in ((" degC", " °C"), (" um", " µm"), ("+-", "±")):  # of the STEP file
            note = note.replace(plain, sign)
        for k, part in enumerate(wrap(f"{number}  {note}", 90, subsequent_indent="    ")):
            top -= 4.2 if k else 0.0
            sheet.text(x, top, part)


def _title(sheet: Sheet, standard: Standard, issuer: Issuer, scale: float) -> None:
    """Title block of ISO 7200 with the sign of first-angle projection."""
    x, y, w = sheet.paper.width - _WIDE_TABLES, 10.0, _WIDE_TABLES - 10.0
    sheet.box(x, y, w, 48.0, 0.7)
    ratio = f"{scale:g}:1" if scale >= 1.0 else f"1:{1.0 / scale:g}"
    tool = f"material-standard {versions()['material-standard']}"
    name = f"{standard.name} {standard.serial}".strip()
    cells = [
        (0.0, 36.0, 100.0, "title", f"Material standard {name}"),
        (100.0, 36.0, 88.0, "material", standard.material.name),
        (0.0, 24.0, 64.0, "legal owner", issuer.organisation),
        (64.0, 24.0, 62.0, "created by", issuer.author),
        (126.0, 24.0, 62.0, "approved by", issuer.approved),
        (0.0, 12.0, 46.0, "document type", "part drawing"),
        (46.0, 12.0, 40.0, "date of issue", issuer.date),
        (86.0, 12.0, 40.0, "identification", standard.fingerprint),
        (126.0, 12.0, 62.0, "made by", tool),
        (0.0, 0.0, 28.0, "mass", f"{issuer.mass:.1f} kg"),
        (28.0, 0.0, 20.0, "scale", ratio),
        (48.0, 0.0, 34.0, "sheet", f"1 / 1, {sheet.paper.name}"),
        (82.0, 0.0, 72.0, "tolerances", "ISO 22081, ISO 8015"),
    ]
    for left, low, width, what, words in cells:
        sheet.box(x + left, y + low, width, 12.0)
        sheet.text(x + left + 1.2, y + low + 8.4, what)
        sheet.text(x + left + 1.2, y + low + 2.6, words, size=3.0 if low == 36.0 else 2.5)
    sheet.edges(x, y + 51.0, "-0.1 / -0.3", "+0.3")
    sheet.text(x + 50.0, y + 54.0, "edges ISO 13715")
    sheet.box(x + 154.0, y, 34.0, 12.0)
    middle = np.array([x + 163.0, y + 6.0])
    sheet.circle(np.add(middle, [14.0, 0.0]), 4.0, 0.3)
    sheet.circle(np.add(middle, [14.0, 0.0]), 2.2, 0.3)
    cone = [[-4.5, -2.2], [4.5, -4.0], [4.5, 4.0], [-4.5, 2.2], [-4.5, -2.2]]
    sheet.line(middle + np.array(cone), 0.3)
