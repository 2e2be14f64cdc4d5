"""Sections: a ball in its seat, a screw through its pad, a large face along its middle."""

import numpy as np

from matstd.artefact.body import (
    BLEND,
    DatumSphere,
    FreeformPatch,
    MountingHole,
    Standard,
    min_concave_radius,
)
from matstd.cad_out.details import RELIEF, Details, Tolerance, glue_gap
from matstd.report.drawing.sheet import HATCH, THIN, WIDE, Sheet, View, ratio
from matstd.twin.units import DEG

BALL_CUT, HOLE_CUT, FACE_CUT = "D", "E", "F"  # letters of the sections; A, B and C are datums
_HEIGHT_WEIGHT = 0.01  # mm of height that count as much as a millimetre along y
LARGE = 40.0  # half side of a face from which its section is drawn, mm


def draw_seat(
    sheet: Sheet, view: View, sphere: DatumSphere, standard: Standard, details: Details
) -> None:
    """A ball and its seat, halved; the view's origin is the ball's centre."""
    seat, z = details.seats[sphere.name], sphere.centre[2]
    taper = (sphere.foot_radius - sphere.stem_radius) / (z - sphere.foot)
    floor = seat.bottom - z - 0.35 * sphere.radius
    low = seat.top_radius + taper * (seat.top - z - floor)
    top, deep = seat.top - z, seat.bottom - z
    wall = [[-low, floor], [-seat.top_radius, top], [-seat.rim_radius, top], [0.0, deep]]
    mirrored = [[-x, y] for x, y in wall[-2::-1]]
    sheet.line(view.at([*wall, *mirrored, wall[0]]), 0.0, fill=HATCH)
    sheet.line(view.at([*wall, *mirrored]), WIDE)
    sheet.broken(*view.at([wall[0], mirrored[-1]]))
    sheet.circle(view.at([[0.0, 0.0]])[0], view.scale * sphere.radius, fill="white")
    rim = 1.2 * sphere.radius
    sheet.line(view.at([[0.0, floor - 2.0], [0.0, rim]]), 0.13, "-.")
    circle = [seat.contact_radius, seat.contact - z]
    tip = view.at([circle])[0]
    contact = f"contact circle Ø{2 * seat.contact_radius:.1f}, metal on metal"
    sheet.leader(tip, np.add(tip, [14.0, 9.0]), contact)
    glue = view.at([[seat.rim_radius, top + 0.5 * glue_gap(sphere, seat)]])[0]
    gaps = sorted(glue_gap(s, details.seats[s.name]) for s in standard.spheres)
    high = " to ".join(dict.fromkeys(f"{gap:.2f}" for gap in (gaps[0], gaps[-1])))
    sheet.leader(glue, np.add(glue, [12.0, 1.0]), f"glue outside only, {high} high")
    half = seat.half_angle / DEG
    flank = view.at([[0.45 * seat.rim_radius, 0.55 * deep + 0.45 * top]])[0]
    beside = np.add(view.at([[low, floor]])[0], [8.0, 5.0])
    sheet.leader(flank, beside, f"{2 * half:.0f}°, Ra 0.8")
    size = view.at([[-0.7 * sphere.radius, 0.7 * sphere.radius]])[0]
    sheet.leader(size, np.add(size, [-6.0, 5.0]), f"(SØ{2 * sphere.radius:g})")
    where = view.at([[0.0, 1.3 * sphere.radius]])[0]
    title = f"{BALL_CUT}-{BALL_CUT} ({ratio(view.scale)}): {sphere.name} in its seat"
    sheet.text(where[0], where[1] + 6.0, title, size=3.0, ha="center")
    others = "all balls alike; land and countersink as in the table"
    sheet.text(where[0], where[1] + 2.0, others, ha="center")


def draw_screw(
    sheet: Sheet, view: View, hole: MountingHole, standard: Standard, details: Details
) -> None:
    """A screw in its counterbore above its pad, halved; the view's origin is below the screw."""
    thick = standard.base.thickness
    radii = {(pad.x, pad.y): pad.radius for pad in details.pads}
    pad = radii.get((hole.x, hole.y), hole.bore_radius + 12.0)
    low = RELIEF if details.pads else 0.0
    wide, floor = pad + 14.0, thick - hole.bore_depth
    left = [[-wide, low], [-pad, low], [-pad, 0.0], [-hole.radius, 0.0], [-hole.radius, floor]]
    left += [[-hole.bore_radius, floor], [-hole.bore_radius, thick], [-wide, thick]]
    for sign in (1.0, -1.0):
        half = view.at([[sign * x, y] for x, y in left])
        sheet.line(half, 0.0, fill=HATCH)
        sheet.line(half, WIDE)
        sheet.broken(half[0], half[-1])
    for reach, height in ((hole.bore_radius, thick), (hole.radius, 0.0), (hole.radius, floor)):
        sheet.line(view.at([[-reach, height], [reach, height]]), WIDE)
    for screw in details.screws[:1]:
        d, h = 0.5 * screw.diameter, 0.5 * screw.head
        end = floor - screw.length
        shape = [[-h, floor], [-d, floor], [-d, end], [d, end], [d, floor], [h, floor]]
        head = [[h, floor + screw.diameter], [-h, floor + screw.diameter], shape[0]]
        sheet.line(view.at([*shape, *head]), THIN, fill="white")
        tip = view.at([[d, end + 4.0]])[0]
        total = sum(len(kind.holes) for kind in details.screws)
        sheet.leader(tip, np.add(tip, [8.0, -3.0]), f"{total} x {screw.name}")
    sheet.line(view.at([[0.0, -18.0], [0.0, thick + 6.0]]), 0.13, "-.")
    a, b = view.at([[-hole.bore_radius, thick], [hole.bore_radius, thick]])
    sheet.dimension(a, b, 5.0, f"Ø{2 * hole.bore_radius:g}")
    a, b = view.at([[-wide, low], [-wide, thick]])
    sheet.dimension(a, b, 5.0, f"{thick - low:g}")
    a, b = view.at([[wide, floor], [wide, thick]])
    sheet.dimension(a, b, -5.0, f"{hole.bore_depth:g}")
    if details.pads:
        edge = view.at([[-pad - 1.0, RELIEF]])[0]
        sheet.leader(
            edge, np.add(edge, [-6.0, -9.0]), f"pad Ø{2 * pad:g}, R{BLEND:g}, {RELIEF:g} high"
        )
        under = view.at([[0.5 * (pad + hole.radius), 0.0]])[0]
        beside = np.add(under, [10.0, -8.0])
        sheet.leader(under, beside)
        sheet.line([beside, np.add(beside, [18.0, 0.0])])
        sheet.roughness(np.add(beside, [2.5, 0.0]), "Ra 0.8")
    where = view.at([[0.0, thick]])[0]
    through = f"Ø{2 * hole.radius:g} through"
    alike = len({p.radius for p in details.pads}) < 2
    rest = f"{len(standard.holes)} alike" if alike else "others with pads as in the table"
    title = f"{HOLE_CUT}-{HOLE_CUT} ({ratio(view.scale)}): {hole.name}, {through}, {rest}"
    sheet.text(where[0], where[1] + 11.0, title, size=3.0, ha="center")


def draw_face(
    sheet: Sheet, view: View, patch: FreeformPatch, standard: Standard, tolerance: Tolerance
) -> None:
    """A large upright face with its plate, cut along x through its highest crest.

    The view's origin is below the middle of the face; the frame of its tolerance is above it.
    """
    a, (x0, y0) = patch.half_size[0], patch.T_artefact_patch[:2, 3]
    u, v = np.linspace(-a, a, 241), section_of(patch) - y0
    rim = patch.point(np.column_stack([u, np.full(len(u), v)]))
    thick, wide = standard.base.thickness, a + 12.0
    low = RELIEF if len(standard.holes) == 3 else 0.0
    plate = [[wide, thick], [wide, low], [-wide, low], [-wide, thick], [-a, thick]]
    profile = np.column_stack([rim[:, 0] - x0, rim[:, 2]])
    body = np.concatenate([profile, [[a, thick]], plate, profile[:1]])
    sheet.line(view.at(body), 0.0, fill=HATCH)
    first = len(profile) + 1  # of the plate; its sides are broken off
    sheet.line(view.at(np.concatenate([body[first + 3 :], body[1 : first + 1]])), WIDE)
    sheet.line(view.at(body[first + 1 : first + 3]), WIDE)
    for k in (first, first + 2):
        sheet.broken(*view.at(body[k : k + 2]))
    lowest, highest = profile[np.argmin(profile[:, 1])], profile[np.argmax(profile[:, 1])]
    rise = view.scale * float(highest[1] - lowest[1])
    for place, way in ((highest, 5.0), (lowest, rise + 5.0)):
        tip = view.at(place)[0]
        sheet.leader(tip, np.add(tip, [8.0, way]), f"z {place[1]:.2f}")
    p, q = view.at([[-a, thick], [a, thick]])
    sheet.dimension(p, q, -view.scale * thick - 7.0, f"{2.0 * a:g}")
    where = view.at([[0.0, patch.point(patch.grid())[:, 2].max()]])[0]
    begin = profile[len(profile) // 12]
    corner = (view.at(begin)[0, 0] - 12.0, where[1] + 9.0)
    sheet.attached(corner, tolerance.kind, f"{tolerance.width:g}", tolerance.datums,
                   view.at(begin)[0])  # fmt: skip
    title = f"{FACE_CUT}-{FACE_CUT} ({ratio(view.scale)}): {patch.name} at y = {y0 + v:g}"
    sheet.text(where[0], where[1] + 25.0, title, size=3.0, ha="center")
    made = f"ball-end cutter R {min_concave_radius(patch):.1f} at most; the model defines it"
    sheet.text(where[0], where[1] + 21.0, made, ha="center")


def section_of(patch: FreeformPatch) -> float:
    """Where a face is cut: y of a crest, of several the farthest from the target of C, mm."""
    uv = 0.8 * patch.grid(1.0)
    best = int(np.argmax(patch.height(uv) + _HEIGHT_WEIGHT * uv[:, 1]))
    return float(np.round(patch.point(uv[[best]])[0, 1], 1))
