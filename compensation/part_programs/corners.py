"""Corners between two motions that a program rounds (RND) or breaks (CHF)."""

from collections.abc import Sequence

import numpy as np

from matstd.compensation.part_programs.language import Reading
from matstd.compensation.part_programs.motion import Arc, Corner, Item, Motion, angle_between
from matstd.compensation.part_programs.radius import MAX_OVERSHOOT, Element, cuts
from matstd.twin.frames import Array

MAX_SMOOTH_SINE = 1e-6  # largest sine of the angle of a smooth transition, which is no corner


def without_corners(items: Sequence[Item | Corner], reading: Reading) -> list[Item]:
    """Motions with the arcs and lines that their corners become; raises BadFile."""
    out: list[Item] = []
    corner: Corner | None = None
    for item in items:
        if isinstance(item, Corner):
            if not (out and isinstance(out[-1], Motion)) or corner is not None:
                raise _refused(reading, item, "no motion before it")
            corner = item
        elif corner is None:
            out.append(item)
        elif isinstance(item, Motion):
            before = out.pop()
            assert isinstance(before, Motion)
            out += _cut(corner, before, item, reading)
            corner = None
        else:
            raise _refused(reading, corner, "no motion right behind it")
    if corner is not None:
        raise _refused(reading, corner, "no motion right behind it")
    return out


def _cut(corner: Corner, before: Motion, after: Motion, reading: Reading) -> tuple[Motion, ...]:
    """The motions before and behind a corner, shortened, and what is between."""
    plane = [reading.column(corner.line, letter) for letter in "XY"]
    others = [k for k in range(len(before.end)) if k not in plane]
    moved = np.array([m.end - m.start for m in (before, after)])[:, others]
    in_plane = all(m.arc is None or list(m.arc.plane) == plane for m in (before, after))
    if corner.size < MAX_OVERSHOOT:
        raise _refused(reading, corner, "motions by nothing")
    if before.tcpm or before.is_rapid or not in_plane or np.abs(moved).max(initial=0.0) > 0.0:
        raise _refused(reading, corner, "motions that do not stay in X and Y")
    a, b = (Element(m, m.start[plane], m.end[plane], 0.0) for m in (before, after))
    if any(e.arc is None and np.linalg.norm(e.end - e.start) < MAX_OVERSHOOT for e in (a, b)):
        raise _refused(reading, corner, "motions that are too short for it")
    u, v = a.direction(a.end), b.direction(b.start)
    turn = float(u[0] * v[1] - u[1] * v[0])
    if abs(turn) < MAX_SMOOTH_SINE:
        raise _refused(reading, corner, "motions that go straight on")
    first, second, arc = (
        _rounded(corner, a, b, turn, plane, reading)
        if corner.is_round
        else (_along(corner, a, True, reading), _along(corner, b, False, reading), None)
    )
    if not (_is_before(a, first, a.end) and _is_before(b, b.start, second)):
        raise _refused(reading, corner, "motions that are too short for it")
    # the other axes stand still in both motions, so the ends differ in the plane only
    ends = before.end.copy(), after.start.copy()
    ends[0][plane], ends[1][plane] = first, second
    between = before._replace(
        line=corner.line, start=ends[0], end=ends[1], arc=arc, words="", turned=()
    )
    return (
        _shortened(before._replace(end=ends[0]), plane),
        between,
        _shortened(after._replace(start=ends[1]), plane),
    )


def _refused(reading: Reading, corner: Corner, found: str) -> Exception:
    word = "RND" if corner.is_round else "CHF"
    expected = "lines or arcs in X and Y before and behind it, longer than it"
    return reading.refusal(corner.line, f"{word} between {found}", expected)


def _along(corner: Corner, element: Element, is_first: bool, reading: Reading) -> Array:
    """Where a chamfer meets one of its lines."""
    if element.arc is not None:
        raise _refused(reading, corner, "an arc and another motion")
    way = element.direction(element.start) * corner.size
    return element.end - way if is_first else element.start + way


def _rounded(
    corner: Corner, a: Element, b: Element, turn: float, plane: list[int], reading: Reading
) -> tuple[Array, Array, Arc]:
    """Where the arc begins and ends, and itself: its centre lies a radius inside of both."""
    d = corner.size * np.sign(turn)
    beside = [Element(e.motion, e.start, e.end, d) for e in (a, b)]
    found = cuts(*beside)
    if not len(found):
        raise _refused(reading, corner, "motions that no such arc touches")
    centre = found[np.argmin(np.linalg.norm(found - a.end, axis=1))]
    first, second = (e.nearest(centre) for e in (a, b))
    angle = angle_between(first, second, centre, turn > 0.0)
    return first, second, Arc((plane[0], plane[1]), centre, angle)


def _is_before(element: Element, start: Array, end: Array) -> bool:
    """Whether a piece of an element, from one point to another, goes its way and within it."""
    whole = element.share(element.end)
    return -MAX_SMOOTH_SINE <= element.share(start) <= element.share(end) <= whole + MAX_SMOOTH_SINE


def _shortened(motion: Motion, plane: list[int]) -> Motion:
    """A motion whose ends have changed: the angle of its arc."""
    if motion.arc is None:
        return motion
    ends = motion.start[plane], motion.end[plane]
    angle = angle_between(*ends, motion.arc.centre, motion.arc.angle > 0.0)
    return motion._replace(arc=motion.arc._replace(angle=angle))
