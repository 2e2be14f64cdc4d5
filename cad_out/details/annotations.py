"""Tolerances, datums and sizes as they are drawn beside the model: frames, letters, leaders.

Everything is read from above, in two columns left and right of the plate, each sign at the height
of the place that its leader touches, so that a sign and its leader lie in one plane.
"""

from typing import NamedTuple

import numpy as np

from matstd.artefact.body import Standard, outline_distance
from matstd.cad_out.details.detail_list import Details
from matstd.cad_out.details.places import plan_room
from matstd.cad_out.details.tolerances import BALL_SIZE, DATUMS, Tolerance, tolerances_of
from matstd.twin.frames import Array

_LETTER, _CELL, _PITCH = 5.0, 10.0, 13.0  # mm: a letter, a frame, from one frame to the next
_AWAY, _LANDING = 25.0, 6.0  # mm from the plate to the columns; a leader is level so far
_ARROW, _ARROW_SLENDERNESS = 4.0, 0.25  # mm, and half its width over its length

_LEADER_OFFSET = ((0.0, 8.0, 0.0), (8.0, 0.0, 0.0))
"""From the arrow on a datum's face to the triangle on it, mm, and that on side B."""

_GLYPHS = {
    "flatness": "01 31 45 15 01",
    "parallelism": "01 25/21 45",
    "perpendicularity": "01 41/21 25",
    "position": "12 14 25 34 32 21 12/03 43/20 26",
    "profile": "02 14 25 34 42 02",
    "A": "00 26 40/12 32",
    "B": "00 06 36 45 44 33 03/33 42 41 30 00",
    "C": "45 36 16 05 01 10 30 41",
    "S": "01 10 30 41 42 33 13 04 05 16 36 45",
    "Ø": "10 01 05 16 36 45 41 30 10/00 46",
    "±": "04 44/22 26/01 41",
    "0": "10 01 05 16 36 45 41 30 10",
    "1": "14 26 20",
    "2": "05 16 36 45 44 00 40",
    "3": "05 16 36 45 44 33 13/33 42 41 30 10 01",
    "4": "30 36 02 42",
    "5": "46 06 03 33 42 41 30 10 01",
    "6": "45 36 16 05 01 10 30 41 42 33 13 02",
    "7": "06 46 10",
    "8": "13 04 05 16 36 45 44 33 13/13 02 01 10 30 41 42 33",
    "9": "01 10 30 41 45 36 16 05 04 13 33 44",
    ".": "20 21",
    " ": "",
}
"""Signs of ISO 1101 and letters: strokes as places "xy" on a grid of 4 by 6, parted by slashes."""

_WIDE, _HIGH, _NEXT = 4.0, 6.0, 5.6  # of a glyph, and from one to the next, in its grid


class _Sign(NamedTuple):
    name: str
    at: Array  # where its leader ends, (3,), mm
    cells: tuple[str, ...]
    end: str  # of its leader: arrow or triangle


def annotations_of(standard: Standard, details: Details) -> dict[str, list[Array]]:
    """What is drawn beside the model, by the names of tolerances, datums and sizes.

    Returns:
        Polylines (N, 3), mm, all of a sign in one plane across z; the first is the frame (of a
        size its underline), which begins at the lower left corner, the second the leader.
    """
    signs = [_tolerance(standard, details, t) for t in tolerances_of(standard, details)]
    for letter, face in DATUMS.items():
        at = np.add(_place(standard, details, face), _LEADER_OFFSET[face == "DATUM_B"])
        signs.append(_Sign(f"datum {letter}", at, (letter,), "triangle"))
    for sphere in standard.spheres:
        x, y, z = sphere.centre
        at = np.array([x + np.copysign(sphere.radius, x), y, z])
        size = f"SØ{2.0 * sphere.radius:g} ±{BALL_SIZE:g}"
        signs.append(_Sign(f"{sphere.name} diameter", at, (size,), "arrow"))
    out: dict[str, list[Array]] = {}
    for side in (-1.0, 1.0):
        column = [sign for sign in signs if (sign.at[0] >= 0.0) == (side > 0.0)]
        column.sort(key=lambda sign: sign.at[1])
        edge = side * (standard.base.half_size[0] + _AWAY)
        for row, sign in enumerate(column):
            y = (row - 0.5 * (len(column) - 1)) * _PITCH
            out[sign.name] = _drawn(sign, np.array([edge, y]), side)
    return out


def _tolerance(standard: Standard, details: Details, tolerance: Tolerance) -> _Sign:
    zone = "SØ" if tolerance.kind == "position" else ""
    cells = (tolerance.kind, f"{zone}{tolerance.width:g}", *tolerance.datums)
    at = _place(standard, details, tolerance.face)
    return _Sign(f"{tolerance.face} {tolerance.kind}", at, cells, "arrow")


def _place(standard: Standard, details: Details, face: str) -> Array:
    """A place on a face that carries a tolerance, (3,), mm."""
    for patch in standard.patches:
        if face == patch.name:
            return np.asarray(patch.point(np.zeros((1, 2)))[0])
    for sphere in standard.spheres:
        if face == f"{sphere.name}_SEAT":
            seat = details.seats[sphere.name]
            x, y = sphere.centre[:2]
            return np.array([x + np.copysign(seat.contact_radius, x), y, seat.contact])
    for pad in details.pads:
        if face == pad.name:
            return np.array([pad.x + np.copysign(0.9 * pad.radius, pad.x), pad.y, 0.0])
    base = standard.base
    if face in details.sides:
        side = details.sides[face]
        out, along = np.array(side.normal), np.abs(np.array(side.normal)[::-1])
        return np.array([*side.offset * out - 0.5 * side.half_length * along, 0.5 * base.thickness])
    y = np.linspace(-0.8, 0.8, 33) * base.half_size[1]
    rim = np.column_stack([np.full(len(y), 6.0 - base.half_size[0]), y])
    inside = -outline_distance(rim, base.half_size, base.corner_radius) > 1.0
    free = np.where(inside, plan_room(standard, rim), -np.inf)
    return np.array([*rim[np.argmax(free)], base.thickness if face == "DATUM_A" else 0.0])


def _drawn(sign: _Sign, edge: Array, side: float) -> list[Array]:
    """A sign whose frame ends at a place, on the far side from the plate."""
    cells = [_written(cell) for cell in sign.cells]
    widths = [max(_CELL, wide + _LETTER) for _, wide in cells]
    x = edge[0] - (sum(widths) if side < 0.0 else 0.0)
    low, high = edge[1] - 0.5 * _CELL, edge[1] + 0.5 * _CELL
    walls = x + np.cumsum([0.0, *widths])
    if sign.name.endswith("diameter"):
        first = [np.array([[walls[0], low], [walls[-1], low]])]
        foot = np.array([edge[0], low])
    else:
        first = [_rectangle(walls[0], walls[-1], low, high)]
        first += [np.array([[wall, low], [wall, high]]) for wall in walls[1:-1]]
        foot = edge
    ink = []
    for left, wide, (drawn, long) in zip(walls, widths, cells, strict=False):
        corner = np.array([left + 0.5 * (wide - long), edge[1] - 0.5 * _LETTER])
        ink += [corner + line for line in drawn]
    leader = np.array([foot, foot - [side * _LANDING, 0.0], sign.at[:2]])
    flat = [first[0], leader, *first[1:], *ink, _head(leader, sign.end)]
    return [np.round(np.column_stack([line, np.full(len(line), sign.at[2])]), 6) for line in flat]


def _written(cell: str) -> tuple[list[Array], float]:
    """Strokes (N, 2) of a sign or a line of letters that begins at the origin, and its length."""
    glyphs = [cell] if cell in _GLYPHS else list(cell)
    drawn = [
        np.array([[float(at[0]) + k * _NEXT, float(at[1])] for at in stroke.split()])
        for k, glyph in enumerate(glyphs)
        for stroke in filter(None, _GLYPHS[glyph].split("/"))
    ]
    scale = _LETTER / _HIGH
    return [scale * stroke for stroke in drawn], scale * ((len(glyphs) - 1) * _NEXT + _WIDE)


def _rectangle(left: float, right: float, low: float, high: float) -> Array:
    return np.array([[left, low], [right, low], [right, high], [left, high], [left, low]])


def _head(leader: Array, end: str) -> Array:
    """Arrow of a leader, or the triangle of a datum standing on its base."""
    back = leader[-2] - leader[-1]
    back = back / np.linalg.norm(back)
    across = np.array([-back[1], back[0]])
    tip, foot = leader[-1], leader[-1] + _ARROW * back
    if end == "triangle":
        tip, foot = foot, leader[-1]
    wide = (2.0 if end == "triangle" else 1.0) * _ARROW_SLENDERNESS * _ARROW * across
    return np.array([tip, foot + wide, foot - wide, tip])
