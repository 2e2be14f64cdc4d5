"""The whole sheet."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from matstd.artefact.body import DatumSphere, FreeformPatch, Standard, max_slope, min_concave_radius
from matstd.cad_out.details import (
    BALL,
    DATUMS,
    Details,
    Tolerance,
    details_of,
    notes_of,
    tolerances_of,
)
from matstd.report.drawing.sections import draw_screw, draw_seat, engraving_words
from matstd.report.drawing.sheet import WIDTH, Sheet, View
from matstd.report.drawing.views import draw_from, draw_top
from matstd.twin.files import written_whole
from matstd.twin.units import DEG
from matstd.twin.versions import versions

DRAWING = ("drawing.pdf", "drawing.svg")
"""Names of the files."""

_SCALES = (2.0, 1.0, 0.5, 0.2, 0.1)  # of ISO 5455
_LEFT, _TOP = 44.0, 392.0  # mm of paper: where the views begin
_ROOM = (318.0, 372.0)  # mm of paper for the three views
_TABLES = 396.0  # mm of paper: where the tables begin
_FLAT = 10_000.0  # mm: a ball of 3 mm cannot distinguish such a face from a plane


@dataclass(frozen=True, slots=True)
class Issuer:
    """Who answers for a drawing.

    Attributes:
        author: Responsible for the design.
        organisation: Whom the author works for.
        mass: Of body and balls, kg.
    """

    author: str
    organisation: str
    mass: float


def write_drawing(folder: Path, standard: Standard, issuer: Issuer) -> None:
    """One A2 sheet as PDF and SVG, the same bytes for the same standard."""
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
    sheet, base = Sheet(), standard.base
    (a, b), tall = base.half_size, _tallest(standard)
    wide, high = (_ROOM[0] - 36.0) / (2.0 * (a + b)), (_ROOM[1] - 90.0) / (tall + 2.0 * b)
    scale = next((s for s in _SCALES if s <= min(wide, high)), _SCALES[-1])
    floor = _TOP - 12.0 - scale * tall
    front = View(_LEFT + scale * a, floor, scale)
    left = View(_LEFT + scale * 2 * a + 36.0 + scale * b, floor, scale)
    top = View(front.x, floor - 46.0 - scale * b, scale)
    draw_from(sheet, front, standard, details, np.array([0.0, 1.0, 0.0]))
    draw_from(sheet, left, standard, details, np.array([1.0, 0.0, 0.0]))
    draw_top(sheet, top, standard, details)
    _dimensions(sheet, front, top, standard, tall)
    _datums(sheet, front, top, left, standard, details)
    _axes(sheet, top)
    if standard.spheres:
        enlarged = 2.0 if standard.spheres[0].radius <= 16.0 else 1.0
        draw_seat(sheet, View(top.x + scale * a + 74.0, floor - 76.0, enlarged), standard, details)
    if standard.holes:
        draw_screw(sheet, View(top.x + scale * a + 70.0, 62.0, 1.0), standard, details)
    low = _tables(sheet, standard, details)
    _notes(sheet, low - 8.0, standard, details)
    _title(sheet, standard, issuer, scale)
    return sheet


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
    sheet.dimension(p, q, -16.0, f"{2 * a:g}")
    p, q = top.at([[a, -b], [a, b]])
    sheet.dimension(p, q, -9.0, f"{2 * b:g}")
    radius = standard.base.corner_radius
    corner = np.array([a, b]) - radius * (1.0 - np.sqrt(0.5))
    tip = top.at(corner)[0]
    sheet.leader(tip, np.add(tip, [6.0, 6.0]), f"R{radius:g}")


def _datums(
    sheet: Sheet, front: View, top: View, left: View, standard: Standard, details: Details
) -> None:
    """Letters on their faces, and the tolerances of datums, pads, faces and balls."""
    (a, b), thick = standard.base.half_size, standard.base.thickness
    down, west = np.array([0.0, -1.0]), np.array([-1.0, 0.0])
    up = np.array([0.0, 1.0])
    # beside the view: on the face itself pillars and posts are in the way
    sheet.line(left.at([[b, thick]])[0] + np.array([[1.0, 0.0], [12.0, 0.0]]))
    sheet.datum(np.add(left.at([[b, thick]])[0], [7.0, 0.0]), up, "A")
    sheet.datum(top.at([[0.55 * a, -details.sides["DATUM_B"].offset]])[0], down, "B")
    sheet.datum(top.at([[-details.sides["DATUM_C"].offset, 0.55 * b]])[0], west, "C")
    sheet.line(front.at([[a, thick]])[0] + np.array([[1.0, 0.0], [16.0, 0.0]]))
    sheet.roughness(np.add(front.at([[a, thick]])[0], [4.0, 0.0]), "Ra 0.8")
    tolerances = {t.face: t for t in tolerances_of(standard, details)}
    x, y = left.at([[-b, 0.0]])[0]
    rows = [("DATUM_A", "A"), ("DATUM_B", "B"), ("DATUM_C", "C")]
    seats = [t.face for t in tolerances.values() if t.kind == "parallelism"]
    rows += [(seats[0], f"{len(seats)} x pad" if details.pads else "underside")]
    for patch in standard.patches[:1]:
        rows.append((patch.name, f"{len(standard.patches)} x FF"))
    for sphere in standard.spheres[:1]:
        rows.append((f"{sphere.name}_SEAT", f"{len(standard.spheres)} x centre"))
    for k, (face, words) in enumerate(rows):
        column, row = divmod(k, 3)
        at = (x + 62.0 * column, y - 14.0 - 8.5 * row)
        _frame(sheet, at, tolerances[face], words)


def _frame(sheet: Sheet, at: tuple[float, float], tolerance: Tolerance, words: str) -> None:
    width = f"{tolerance.width:g}"
    width = f"SØ{width}" if tolerance.kind == "position" else width
    sheet.text(at[0], at[1] + 1.8, words, size=2.2)
    sheet.tolerance(at[0] + 23.0, at[1], tolerance.kind, width, tolerance.datums)


def _axes(sheet: Sheet, top: View) -> None:
    for way, name in (((30.0, 0.0), "X"), ((0.0, 30.0), "Y")):
        ends = top.at([[0.0, 0.0], way])
        sheet.line(ends, 0.35)
        sheet.arrow(ends[1], np.array(way))
        sheet.text(ends[1][0] + 1.5, ends[1][1] + 1.0, name, size=3.0)


def _tables(sheet: Sheet, standard: Standard, details: Details) -> float:
    """Faces, balls and holes with their places; returns the height of the lower edge."""
    rows = [["face", "x", "y", "z", "size", "slope", "R", "tests the model; dominant errors"]]
    rows += [_face_row(patch) for patch in standard.patches]
    title = "Freeform faces (middle, steepest slope, least concave radius between their edges)"
    y = sheet.table(_TABLES, _TOP, (11, 14, 14, 14, 22, 11, 13, 89), rows, title)
    rows = [["ball", "x", "y", "z", "Ø", "foot", "land", "land z", "sink",
             "identifies the machine; calibrated"]]  # fmt: skip
    rows += [_ball_row(ball, details) for ball in standard.spheres]
    title = f"Balls (centres), {BALL.name}, and their posts"
    y = sheet.table(_TABLES, y - 9.0, (11, 14, 14, 14, 11, 15, 15, 15, 13, 66), rows, title)
    rows = [["hole", "x", "y", "z", "through", "counterbore", "pad", "for"]]
    rows += _hole_rows(standard, details)
    title = "Holes (middles of their mouths)"
    return sheet.table(_TABLES, y - 9.0, (17, 17, 17, 12, 24, 24, 14, 63), rows, title)


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
        purpose = "eyebolt" if bore.thread else "thermometer, from the side at +y"
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
        "centre and form",
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
    sheet.text(_TABLES, top, "Notes", size=3.0)
    words = [*notes_of(standard, details), engraving_words()]
    words += [f"Omitted for lack of space: {what}." for what in details.missing]
    faces = ", ".join(f"{letter} = {face}" for letter, face in DATUMS.items())
    words.append(f"Names of faces as in standard.step: {faces}; that model is the definition.")
    for number, note in enumerate(words, 1):
        top -= 4.2
        note = note.replace(" degC", " °C").replace(" um", " µm")  # ASCII is for the STEP file
        for k, part in enumerate(_wrapped(f"{number}  {note}")):
            top -= 3.6 if k else 0.0
            sheet.text(_TABLES, top, part, size=2.0)


def _wrapped(words: str, most: int = 112) -> list[str]:
    import textwrap

    return textwrap.wrap(words, most, subsequent_indent="    ")


def _title(sheet: Sheet, standard: Standard, issuer: Issuer, scale: float) -> None:
    """Title block of ISO 7200 with the sign of first-angle projection."""
    x, y, w = _TABLES, 10.0, WIDTH - 10.0 - _TABLES
    sheet.box(x, y, w, 36.0, 0.7)
    ratio = f"{scale:g}:1" if scale >= 1.0 else f"1:{1.0 / scale:g}"
    tool = f"material-standard {versions()['material-standard']}"
    name = f"{standard.name} {standard.serial}".strip()
    cells = [
        (0.0, 24.0, 100.0, "title", f"Material standard {name}"),
        (100.0, 24.0, 88.0, "material", standard.material.name),
        (0.0, 12.0, 64.0, "legal owner", issuer.organisation),
        (64.0, 12.0, 62.0, "author", issuer.author),
        (126.0, 12.0, 62.0, "made by", tool),
        (0.0, 0.0, 30.0, "mass with balls", f"{issuer.mass:.1f} kg"),
        (30.0, 0.0, 18.0, "scale", ratio),
        (48.0, 0.0, 24.0, "sheet", "1 / 1, A2"),
        (72.0, 0.0, 46.0, "tolerances", "ISO 2768-mK, ISO 8015"),
        (118.0, 0.0, 36.0, "identification", standard.fingerprint),
    ]
    for left, low, width, what, words in cells:
        sheet.box(x + left, y + low, width, 12.0)
        sheet.text(x + left + 1.2, y + low + 9.2, what, size=1.5)
        sheet.text(x + left + 1.2, y + low + 3.0, words, size=2.5)
    sheet.box(x + 154.0, y, 34.0, 12.0)
    middle = np.array([x + 163.0, y + 6.0])
    sheet.circle(np.add(middle, [14.0, 0.0]), 4.0, 0.3)
    sheet.circle(np.add(middle, [14.0, 0.0]), 2.2, 0.3)
    cone = [[-4.5, -2.2], [4.5, -4.0], [4.5, 4.0], [-4.5, 2.2], [-4.5, -2.2]]
    sheet.line(middle + np.array(cone), 0.3)
