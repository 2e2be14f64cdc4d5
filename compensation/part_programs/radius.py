"""Cutter radius compensation resolved: paths of the tool's centre beside a contour.

Lines and arcs of the contour are shifted to their left or right. At an outer corner the centre goes
round the corner on an arc, at an inner one shifted paths are cut where they meet. The tool comes
to the contour and leaves it on a straight line, square to the contour at its first and last point.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from matstd.compensation.part_programs.language import Reading
from matstd.compensation.part_programs.motion import Arc, ArcFeed, Item, Keep, Motion, angle_between
from matstd.twin.frames import Array

MAX_SMOOTH_SINE = 1e-4
"""Largest sine of the angle of a smooth transition: contours are programmed to a micrometre."""

MAX_OVERSHOOT = 1e-3
"""A cut may lie beyond the end of a shifted path by so much, mm: programmed in micrometres."""


@dataclass(frozen=True, eq=False)
class Element:
    """A line or an arc of the contour in its plane, and its path shifted to the left by `d`, mm."""

    motion: Motion
    start: Array
    end: Array
    d: float

    @property
    def arc(self) -> Arc | None:
        """None for a line."""
        return self.motion.arc

    def direction(self, at: Array) -> Array:
        """Unit tangent at one of its points, (2,)."""
        if self.arc is None:
            way = self.end - self.start
            return np.asarray(way / np.linalg.norm(way))
        out = _left(at - self.arc.centre) * np.sign(self.arc.angle)
        return np.asarray(out / np.linalg.norm(out))

    def shifted(self, at: Array) -> Array:
        """The centre of the tool beside one of its points, (2,)."""
        return np.asarray(at + self.d * _left(self.direction(at)))

    def nearest(self, to: Array) -> Array:
        """The point of its line or circle, carried on, that is nearest to another, (2,)."""
        if self.arc is None:
            way = self.direction(self.start)
            return np.asarray(self.start + way * ((to - self.start) @ way))
        out = to - self.arc.centre
        own = np.linalg.norm(self.start - self.arc.centre)
        return np.asarray(self.arc.centre + out * own / np.linalg.norm(out))

    def share(self, at: Array) -> float:
        """Way from its start to one of its points, mm on a line, rad on an arc."""
        if self.arc is None:
            return float((at - self.start) @ self.direction(self.start))
        if np.allclose(at, self.start, rtol=0.0, atol=1e-9):
            return 0.0
        angle = angle_between(self.start, at, self.arc.centre, self.arc.angle > 0.0)
        return abs(angle)

    @property
    def own_radius(self) -> float:
        """Radius of the arc of the contour, mm."""
        assert self.arc is not None
        return float(np.linalg.norm(self.start - self.arc.centre))

    @property
    def radius(self) -> float:
        """Radius of the shifted arc, mm; zero or less where the tool does not fit."""
        assert self.arc is not None
        return self.own_radius - self.d * float(np.sign(self.arc.angle))

    @property
    def feed_share(self) -> float:
        """Feed of the tool's centre on the shifted arc over the feed that the program states.

        With M109 the feed is that of the cutting edge: the control goes round by the same angle in
        the same time. It does so on arcs alone, and the shifted arc is written as lines.

        Reference:
            iTNC 530, User's Manual ISO programming (340 49x-02), 7.4 "Feed rate for circular arcs:
            M109/M110/M111".
        """
        share = self.radius / self.own_radius
        kind = self.motion.arc_feed
        is_of_edge = kind is ArcFeed.EDGE or (kind is ArcFeed.INNER_EDGE and share < 1.0)
        return share if is_of_edge else 1.0


def _left(v: Array) -> Array:
    return np.array([-v[1], v[0]])


def resolved(items: Sequence[Item], reading: Reading, is_square: bool) -> list[Item]:
    """Items with the paths of the tool's centre in place of those beside a contour.

    Args:
        is_square: Whether the tool comes to the contour square to its first element, as with
            Heidenhain; else square to the way on which it comes, as LinuxCNC does.

    Raises:
        BadFile: A contour on which the tool does not fit, or that does not begin and end with a
            straight line; with its line.
    """
    groups = [list(g) for _, g in groupby(_sides(items), key=lambda pair: pair[0])]
    out: list[Item] = []
    moved: Motion | None = None
    for group in groups:
        own = [item for _, item in group]
        if group[0][0] == 0.0:
            if moved is not None:
                own = _from(own, moved, reading)
            moved = None
            out += own
        else:
            if moved is not None:
                line = own[0].line
                raise reading.refusal(line, "another side of the contour", "R0 or G40 between")
            contour = list(_Contour(own, group[0][0], reading, is_square).path())
            moved = next(m for m in reversed(contour) if isinstance(m, Motion))
            out += contour
    return out


def _sides(items: Sequence[Item]) -> Iterator[tuple[float, Item]]:
    """Every item with the side of its motion; a block that moves nothing has that before it."""
    side = 0.0
    for item in items:
        if isinstance(item, Motion):
            side = item.beside
        yield side, item


def _from(items: list[Item], moved: Motion, reading: Reading) -> list[Item]:
    """The first motion after a contour begins where the tool's centre is."""
    for i, item in enumerate(items):
        if isinstance(item, Motion):
            if item.arc is not None:
                found = "an arc as the first motion after a contour"
                raise reading.refusal(item.line, found, "a straight line away from it")
            start = item.start.copy()
            start[reading.linear] = moved.end[reading.linear]
            return [*items[:i], item._replace(start=start), *items[i + 1 :]]
    return items


class _Contour:
    """The motions of one contour, the approach first."""

    def __init__(self, items: list[Item], beside: float, reading: Reading, is_square: bool) -> None:
        self.items, self.reading, self.is_square = items, reading, is_square
        self.d = beside
        motions = [m for m in items if isinstance(m, Motion)]
        self.plane = self._plane(motions)
        for item in items:
            self._check(item)
        self.approach = motions[0]
        if self.approach.arc is not None:
            found = "an arc as the first motion to a contour"
            raise reading.refusal(self.approach.line, found, "a straight line")
        self.elements = [self._element(m) for m in motions[1:]]
        if not self.elements:
            found = "a contour of one point"
            raise reading.refusal(self.approach.line, found, "a motion beside the tool's radius")

    def _plane(self, motions: list[Motion]) -> list[int]:
        planes = {m.arc.plane for m in motions if m.arc is not None}
        flat = (self.reading.column(0, "X"), self.reading.column(0, "Y"))
        if planes - {flat}:
            line = next(m.line for m in motions if m.arc is not None and m.arc.plane != flat)
            raise self.reading.refusal(line, "an arc across X and Y", "contours in X and Y")
        return list(flat)

    def _check(self, item: Item) -> None:
        """Refuse what no contour in X and Y has."""
        found = ""
        if isinstance(item, Keep):
            if item.moves or item.text.upper().startswith("TOOL"):
                found = "this block beside a contour"
        elif item.tcpm or item.turned:
            found = "rotary axes beside a contour"
        if found:
            raise self.reading.refusal(item.line, found, "it before the contour or after it")

    def _element(self, motion: Motion) -> Element:
        start, end = motion.start[self.plane], motion.end[self.plane]
        if motion.arc is None and np.linalg.norm(end - start) < MAX_OVERSHOOT:
            found = "no way in X and Y beside a contour"
            raise self.reading.refusal(motion.line, found, "Z before the contour, or on its way")
        element = Element(motion=motion, start=start, end=end, d=self.d)
        if motion.arc is not None and element.radius < MAX_OVERSHOOT:
            self._refuse(motion.line)
        return element

    def _refuse(self, line: int) -> None:
        found = f"a contour narrower than the tool, R {abs(self.d):g}"
        raise self.reading.refusal(line, found, "a smaller tool")

    def path(self) -> Iterator[Item]:
        """Blocks and motions of the tool's centre, in the order of the program."""
        here = self.elements[0].shifted(self.elements[0].start)
        left = list(self.elements if self.is_square else [self._coming(), *self.elements])
        for item in self.items:
            if isinstance(item, Keep):
                yield item
            elif item is self.approach and self.is_square:
                yield self._moved(item, None, here)
            else:
                element = left.pop(0)
                end, onward = self._ends(element, left[0] if left else None)
                is_coming = item is self.approach
                yield self._moved(item, None, end) if is_coming else self._cut(element, here, end)
                here = end
                if onward is not None:
                    yield self._round(left[0], end, onward)
                    here = onward

    def _coming(self) -> Element:
        """The way to the contour as a part of it."""
        start, end = self.approach.start[self.plane], self.approach.end[self.plane]
        if not np.linalg.norm(end - start) > abs(self.d):
            found = "a way to the contour that is no longer than the tool's radius"
            raise self.reading.refusal(self.approach.line, found, "a longer one")
        return Element(motion=self.approach, start=start, end=end, d=self.d)

    def _ends(self, before: Element, after: Element | None) -> tuple[Array, Array | None]:
        """End of a shifted path; at an outer corner also where the one behind it begins."""
        end = before.shifted(before.end)
        if after is None:
            return end, None
        at = after.start
        a, b = before.direction(before.end), after.direction(at)
        turn = float(a[0] * b[1] - a[1] * b[0])
        if abs(turn) < MAX_SMOOTH_SINE and a @ b > 0.0:
            return after.shifted(at), None
        if turn * self.d < 0.0:
            return end, after.shifted(at)
        found = cuts(before, after) if abs(turn) > MAX_SMOOTH_SINE else np.zeros((0, 2))
        if not len(found):
            self._refuse(after.motion.line)
        return np.asarray(found[np.argmin(np.linalg.norm(found - at, axis=1))]), None

    def _moved(self, motion: Motion, start: Array | None, end: Array) -> Motion:
        """A motion between other points of the plane."""
        ends = motion.start.copy(), motion.end.copy()
        if start is not None:
            ends[0][self.plane] = start
        ends[1][self.plane] = end
        return motion._replace(start=ends[0], end=ends[1], beside=0.0)

    def _cut(self, element: Element, start: Array, end: Array) -> Motion:
        """The shifted path of an element between two points of it."""
        moved = self._moved(element.motion, start, end)
        if element.arc is None:
            if (end - start) @ element.direction(element.start) < -MAX_OVERSHOOT:
                self._refuse(element.motion.line)
            return moved
        positive = element.arc.angle > 0.0
        whole = abs(element.arc.angle)
        turns = max(1, int(np.ceil(whole / (2.0 * np.pi) - 1e-9)))
        angle = angle_between(start, end, element.arc.centre, positive, turns)
        if abs(angle) > whole + MAX_OVERSHOOT / element.radius:
            self._refuse(element.motion.line)
        share = element.feed_share
        return moved._replace(
            arc=Arc(element.arc.plane, element.arc.centre, angle),
            feed=share * moved.feed,
            word=share * moved.word,
        )

    def _round(self, after: Element, start: Array, end: Array) -> Motion:
        """The arc round an outer corner, at the height at which the next element begins."""
        x, y = self.plane
        centre, positive = after.start, self.d < 0.0
        arc = Arc((x, y), centre, angle_between(start, end, centre, positive))
        moved = self._moved(after.motion._replace(words="", turned=()), start, end)
        flat = moved.end.copy()
        others = [k for k in range(len(flat)) if k not in self.plane]
        flat[others] = moved.start[others]
        return moved._replace(end=flat, arc=arc)


def cuts(a: Element, b: Element) -> Array:
    """Points at which two shifted paths meet, carried on, (M, 2)."""
    if a.arc is None and b.arc is None:
        return _line_line(a, b)
    if a.arc is None or b.arc is None:
        line, arc = (a, b) if a.arc is None else (b, a)
        return _line_circle(line, arc)
    return _circle_circle(a, b)


def _line_line(a: Element, b: Element) -> Array:
    u, v = a.direction(a.start), b.direction(b.start)
    p, q = a.shifted(a.start), b.shifted(b.start)
    s = np.linalg.solve(np.column_stack([u, -v]), q - p)[0]
    return np.array([p + s * u])


def _line_circle(line: Element, arc: Element) -> Array:
    assert arc.arc is not None
    u, p = line.direction(line.start), line.shifted(line.start)
    to = arc.arc.centre - p
    along, away = float(to @ u), float(to @ _left(u))
    half = arc.radius**2 - away**2
    if half < 0.0:
        return np.zeros((0, 2))
    return np.array([p + (along + side * np.sqrt(half)) * u for side in (-1.0, 1.0)])


def _circle_circle(a: Element, b: Element) -> Array:
    assert a.arc is not None
    assert b.arc is not None
    between = b.arc.centre - a.arc.centre
    apart = float(np.linalg.norm(between))
    if apart < MAX_OVERSHOOT:
        return np.zeros((0, 2))
    along = (apart**2 + a.radius**2 - b.radius**2) / (2.0 * apart)
    half = a.radius**2 - along**2
    if half < 0.0:
        return np.zeros((0, 2))
    u = between / apart
    foot = a.arc.centre + along * u
    return np.array([foot + side * np.sqrt(half) * _left(u) for side in (-1.0, 1.0)])
