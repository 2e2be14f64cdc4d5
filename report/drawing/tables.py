"""Tables, notes and the title block: blocks of one width that any column of a sheet may hold."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from textwrap import wrap

import numpy as np

from matstd.artefact.body import DatumSphere, FreeformPatch, Standard, max_slope, min_concave_radius
from matstd.artefact.price import Construction
from matstd.cad_out.details import (
    BALL,
    CUTTER,
    DATUMS,
    DEPTH,
    SCREW,
    Details,
    datum_touches,
    notes_of,
)
from matstd.cad_out.making import Joints, joints_if_any
from matstd.report.drawing.sheet import ROW, Block, Sheet, ratio
from matstd.report.numbers import concave_radius_words
from matstd.twin.units import DEG
from matstd.twin.versions import versions

COLUMN = 154.0  # width of every table and note, mm of paper
TITLE = (180.0, 48.0)  # width and height of the title block of ISO 7200, mm of paper
_HEADING = 9.0  # mm above a table, for its title
_LINE = 4.2  # mm from a line of a note to the next
_LETTERS = 80  # of a line of a note
_ERRORS = 2  # dominant errors that a row names


@dataclass(frozen=True, slots=True)
class Issuer:
    """Who answers for a drawing."""

    author: str  # responsible for the design
    organisation: str  # whom the author works for
    mass: float  # mass of body and balls, kg
    approved: str = "not stated"  # who approved the drawing
    date: str = "not stated"  # date of its issue
    make: Construction = Construction.BILLET  # the construction that the workshop makes


def blocks_of(standard: Standard, details: Details, make: Construction) -> list[Block]:
    """Tables of faces, balls, datum targets, holes and parts, then every note, in this order."""
    joints = joints_if_any(standard, details) if make is Construction.PARTS else None
    tables = [_balls(standard, details, joints), _targets(standard)]
    tables.append(_holes(standard, details, joints))
    if standard.patches:
        tables.insert(0, _faces(standard))
    tables.append(_parts(standard, details, joints))
    return [*tables, *_notes(standard, details, joints)]


def _table(title: str, widths: tuple[float, ...], rows: list[list[str]]) -> Block:
    def draw(sheet: Sheet, x: float, top: float) -> None:
        sheet.table(x, top - _HEADING, widths, rows, title)

    return Block(COLUMN, _HEADING + ROW * len(rows), draw)


def _place(coordinate: float) -> str:
    """A coordinate to a tenth of a millimetre, zero without a sign."""
    return f"{round(float(coordinate), 1) + 0.0:.1f}"


def _faces(standard: Standard) -> Block:
    head = ["face", "x", "y", "z", "size", "slope", "R", "tests; dominant errors"]
    title = "Freeform faces (middle, steepest slope, least concave radius R)"
    rows = [head, *map(_face_row, standard.patches)]
    return _table(title, (10, 14, 14, 12, 23, 13, 15, 53), rows)


def _face_row(patch: FreeformPatch) -> list[str]:
    x, y, z = patch.point(np.zeros((1, 2)))[0]
    shares = ", ".join(f"{e.name} {100 * e.share:.0f} %" for e in patch.errors[:_ERRORS])
    return [
        patch.name,
        *map(_place, (x, y, z)),
        f"{2 * patch.half_size[0]:g} x {2 * patch.half_size[1]:g}",
        f"{max_slope(patch) / DEG:.0f}°",
        concave_radius_words(min_concave_radius(patch)),
        shares or "a face of a workpiece",
    ]


def _balls(standard: Standard, details: Details, joints: Joints | None) -> Block:
    threads = {stud.ball: f"M{stud.thread:g}" for stud in joints.studs} if joints else {}
    last = "stud" if joints else ""
    head = ["ball", "x", "y", "z", "SØ", "foot", "land", "land z", "sink", last, "use"]
    rows = [head, *(_ball_row(one, details, threads) for one in standard.spheres)]
    title = "Balls (centres, theoretically exact) and their posts"
    return _table(title, (14, 14, 14, 14, 9, 15, 17, 15, 12, 11, 19), rows)


def _ball_row(ball: DatumSphere, details: Details, threads: dict[str, str]) -> list[str]:
    seat = details.seats[ball.name]
    return [
        ball.name,
        *map(_place, ball.centre),
        f"{2 * ball.radius:g}",
        f"Ø{2 * ball.foot_radius:.1f}",
        f"Ø{2 * seat.top_radius:.2f}",
        f"{seat.top:.2f}",
        f"{2 * seat.half_angle / DEG:.0f}°",
        threads.get(ball.name, ""),
        "proves" if ball.proves else "identifies",
    ]


def _targets(standard: Standard) -> Block:
    names = {"DATUM_B": ("B1", "B2"), "DATUM_C": ("C1",)}
    rows = [["target", "x", "y", "z", "on"]]
    for side, (points, _) in datum_touches(standard).items():
        for name, (x, y, z) in zip(names[side], points, strict=True):
            rows.append([name, _place(x), _place(y), f"{z:g}", f"datum {name[0]}: {side}"])
    return _table("Datum targets (theoretically exact, ISO 5459)", (18, 18, 18, 18, 82), rows)


def _holes(standard: Standard, details: Details, joints: Joints | None) -> Block:
    top = f"{standard.base.thickness:g}"
    pads = {(pad.x, pad.y): f"Ø{2 * pad.radius:g}" for pad in details.pads}
    rows = [["hole", "x", "y", "z", "through", "counterbore", "pad", "for"]]
    for h in standard.holes:
        sizes = [f"Ø{2 * h.radius:g}", f"Ø{2 * h.bore_radius:g} x {h.bore_depth:g}"]
        sizes.append(pads.get((h.x, h.y), ""))
        rows.append([h.name, _place(h.x), _place(h.y), top, *sizes, "screw to the table"])
    for bore in details.bores:
        x, y, z = bore.mouth
        sizes = [f"Ø{2 * bore.radius:g} x {bore.depth:g}", bore.thread, ""]
        purpose = "eyebolt" if bore.thread else "thermometer, at +y"
        rows.append([bore.name, _place(x), _place(y), f"{z:g}", *sizes, purpose])
    for block in joints.blocks if joints else ():
        below = [f"Ø{block.through:g}", f"Ø{block.head:g} x {block.sunk:g}", f"Ø{2 * block.pad:g}"]
        for k, (x, y) in enumerate(block.places, 1):
            purpose = f"M{block.thread:g} from below"
            rows.append([f"{block.face} S{k}", _place(x), _place(y), "0", *below, purpose])
    return _table("Holes (middles of their mouths)", (18, 15, 15, 9, 21, 23, 14, 39), rows)


def _parts(standard: Standard, details: Details, joints: Joints | None) -> Block:
    """Parts list of ISO 7573; parts of the body are its sub-items."""
    material, cm = standard.material.name, SCREW.name.removeprefix("steel, ")
    rows = [["item", "pieces", "part", "material or standard"]]
    if joints is None:
        rows.append(["1", "1", "body in one piece", material])
    else:
        rows.append(["1", "1", "body, joined of 1.1 to 1.4", ""])
        rows.append(["1.1", "1", "plate", material])
        if joints.studs:
            rows.append(["1.2", f"{len(joints.studs)}", "stud, thread as in the table", material])
        if joints.blocks:
            names = ", ".join(block.face for block in joints.blocks)
            names = names if len(joints.blocks) < 4 else f"{names[:3]} to {joints.blocks[-1].face}"
            rows.append(["1.3", f"{len(joints.blocks)}", f"block {names}", material])
        for name, count in _counted(f"M{b.thread:g}x{b.length:g}" for b in joints.blocks):
            rows.append(["1.4", f"{3 * count}", f"screw ISO 4762 {name}", cm])
    for name, count in _counted(f"SØ{2 * ball.radius:g}" for ball in standard.spheres):
        rows.append(["2", f"{count}", f"ball {name}", BALL.name])
    for screw in details.screws:
        rows.append(["3", f"{len(screw.holes)}", f"screw {screw.name}", cm])
    return _table("Parts (ISO 7573)", (11, 13, 50, 80), rows)


def _counted(names: Iterable[str]) -> list[tuple[str, int]]:
    return sorted(Counter(names).items())


def _notes(standard: Standard, details: Details, joints: Joints | None) -> list[Block]:
    a, b = standard.base.half_size
    words = [*notes_of(standard, details), _engraving_words()]
    words.append(
        f"Places in the tables are theoretically exact: origin {a:g} from C and {b:g} from B, "
        f"z {standard.base.thickness:g} at A."
        if not any(side.flat for side in details.sides.values())
        else "Places in the tables are theoretically exact, from the middle of the plate."
    )
    words += [f"Omitted for lack of space: {what}." for what in details.missing]
    words += _joint_words(joints)
    faces = ", ".join(f"{letter} = {face}" for letter, face in DATUMS.items())
    words.append(f"Names of faces as in standard.step: {faces}; that model is the definition.")
    return [_note(number, one) for number, one in enumerate(words, 1)]


def _note(number: int, words: str) -> Block:
    for plain, sign in ((" degC", " °C"), (" um", " µm"), ("+-", "±")):  # of the STEP file
        words = words.replace(plain, sign)
    lines = wrap(f"{number}  {words}", _LETTERS, subsequent_indent="    ")
    heading = _HEADING if number == 1 else 1.0

    def draw(sheet: Sheet, x: float, top: float) -> None:
        if number == 1:
            sheet.text(x, top - _HEADING + 2.0, "Notes", size=3.0)
        for k, line in enumerate(lines, 1):
            sheet.text(x, top - heading - _LINE * k + 1.2, line)

    return Block(COLUMN, heading + _LINE * len(lines), draw)


def _engraving_words() -> str:
    """How lettering is made."""
    return (
        f"Lettering: dots {DEPTH:g} deep, ball-ended cutter Ø{2.0 * CUTTER:g}; "
        "never on a datum's touches."
    )


_TORQUES = {4.0: 2.8, 5.0: 5.5, 6.0: 9.5, 8.0: 23.0, 10.0: 46.0, 12.0: 79.0}
"""Tightening torques of class 8.8 at a friction of 0.12 (VDI 2230-1, table A1), N m."""


def _joint_words(joints: Joints | None) -> list[str]:
    """How the parts of the second construction are joined; empty where it does not exist."""
    if joints is None:
        return []
    threads = sorted({stud.thread for stud in joints.studs})
    words = "Made of parts (standard-parts.step): "
    studs = [f"M{d:g} {0.5 * _TORQUES[d]:.0f} N m" for d in threads]
    if studs:
        words += (
            f"studs turned, shoulder square to the thread 0.01, through holes vent; "
            f"{', '.join(studs)} (half of VDI 2230, class 8.8) with thread lock"
        )
    for d in sorted({block.thread for block in joints.blocks}):
        words += (
            f"; blocks on three pads flat 0.005 CZ, screws M{d:g} from below "
            f"{_TORQUES[d]:.0f} N m; calibrate when joined"
        )
    return [f"{words}."]


def draw_title(sheet: Sheet, standard: Standard, issuer: Issuer, scale: float) -> None:
    """Title block of ISO 7200, with the signs of first-angle projection, edges and surfaces."""
    (w, h), y = TITLE, sheet.low
    x = sheet.right - w
    sheet.box(x, y, w, h, 0.7)
    tool = f"material-standard {versions()['material-standard']}"
    name = f"{standard.name} {standard.serial}".strip()
    cells = [
        (0.0, 36.0, 96.0, "title", f"Material standard {name}"),
        (96.0, 36.0, 84.0, "material", standard.material.name),
        (0.0, 24.0, 62.0, "legal owner", issuer.organisation),
        (62.0, 24.0, 59.0, "created by", issuer.author),
        (121.0, 24.0, 59.0, "approved by", issuer.approved),
        (0.0, 12.0, 44.0, "document type", "assembly drawing"),
        (44.0, 12.0, 36.0, "date of issue", issuer.date),
        (80.0, 12.0, 44.0, "identification", standard.fingerprint),
        (124.0, 12.0, 56.0, "made by", tool),
        (0.0, 0.0, 26.0, "mass", f"{issuer.mass:.1f} kg"),
        (26.0, 0.0, 20.0, "scale", ratio(scale)),
        (46.0, 0.0, 32.0, "sheet", f"1 / 1, {sheet.paper.name}"),
        (78.0, 0.0, 68.0, "tolerances", "ISO 22081, ISO 8015"),
    ]
    for left, low, width, what, words in cells:
        sheet.box(x + left, y + low, width, 12.0)
        sheet.text(x + left + 1.2, y + low + 8.4, what)
        sheet.text(x + left + 1.2, y + low + 2.6, words, size=3.0 if low == 36.0 else 2.5)
    sheet.edges(x, y + h + 3.0, "-0.1 / -0.3", "+0.3")
    sheet.text(x + 56.0, y + h + 6.0, "edges ISO 13715")
    sheet.roughness((x + 98.0, y + h + 4.5), "Ra 3.2")
    sheet.text(x + 116.0, y + h + 6.0, "(Ra 0.8, Ra 0.4)  ISO 21920-1")
    sheet.box(x + 146.0, y, 34.0, 12.0)
    middle = np.array([x + 155.0, y + 6.0])
    sheet.circle(np.add(middle, [14.0, 0.0]), 4.0, 0.3)
    sheet.circle(np.add(middle, [14.0, 0.0]), 2.2, 0.3)
    cone = [[-4.5, -2.2], [4.5, -4.0], [4.5, 4.0], [-4.5, 2.2], [-4.5, -2.2]]
    sheet.line(middle + np.array(cone), 0.3)
