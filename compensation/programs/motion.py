"""What a part program does, whatever its language: blocks that are kept, and motions."""

from dataclasses import dataclass

import numpy as np

from twin.frames import Array
from twin.record import IntArray


@dataclass(frozen=True, slots=True)
class Keep:
    """A block that moves nothing, or nothing whose place is known; it stays as it is.

    Attributes:
        line: Of the file.
        text: Without its number.
        moves: Whether it moves an axis all the same: in coordinates of the machine, or before
            the place of every axis is known.
    """

    line: int
    text: str
    moves: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Arc:
    """A circular arc, or a helix, in a plane of two linear axes.

    Attributes:
        plane: Columns of the readings, in the order in which a positive angle turns.
        centre: Of the circle in that plane, (2,), mm.
        angle: From start to end, signed, rad.
    """

    plane: tuple[int, int]
    centre: Array
    angle: float


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """A block that moves axes, from where the one before has ended.

    Attributes:
        line: Of the file.
        start: Program coordinates of every axis, (A,), mm and rad.
        end: The same.
        is_rapid: Whether it cuts nothing.
        feed: mm/min, or degrees/min; 0 where it is rapid.
        tcpm: Whether coordinates are those of the tool point on the turning table.
        length: Of the tool, mm.
        offset: What the program has shifted its zero by, (A,), mm; in `start` and `end` already.
        unit: One unit of the program's lengths, mm.
        words: What else stands in the block, for its first line.
        turned: Rotary axes that the block names.
        arc: None for a straight line.
        beside: Way by which the tool's centre goes to the left of the path that is programmed, mm;
            to the right below zero. Zero once it is resolved.
    """

    line: int
    start: Array
    end: Array
    is_rapid: bool
    feed: float
    tcpm: bool
    length: float
    offset: Array
    unit: float
    words: str
    turned: tuple[str, ...]
    arc: Arc | None = None
    beside: float = 0.0

    @property
    def travel(self) -> float:
        """Length of the path, mm; of axes that turn alone degrees."""
        moved = np.abs(self.end - self.start)
        if self.arc is None:
            return float(np.linalg.norm(moved))
        i, j = self.arc.plane
        radius = np.hypot(*(self.start[[i, j]] - self.arc.centre))
        moved[[i, j]] = 0.0
        return float(np.hypot(radius * self.arc.angle, np.linalg.norm(moved)))


Item = Keep | Motion


def angle_between(start: Array, end: Array, centre: Array, positive: bool, turns: int = 1) -> float:
    """Angle of an arc; a whole circle where start and end are the same.

    Args:
        start: In the plane, (2,), mm.
        end: The same.
        centre: The same.
        positive: Against the clock.
        turns: Times that the end is passed.
    """
    a, b = start - centre, end - centre
    angle = float(np.arctan2(a[0] * b[1] - a[1] * b[0], a @ b))
    if positive and angle <= 1e-9:
        angle += 2.0 * np.pi
    if not positive and angle >= -1e-9:
        angle -= 2.0 * np.pi
    return angle + (1.0 if positive else -1.0) * 2.0 * np.pi * (turns - 1)


def centre_of(start: Array, end: Array, radius: float, positive: bool) -> Array | None:
    """Centre of an arc that is given by its radius; None where no such circle is.

    Args:
        radius: Below zero for the longer way round.
    """
    chord = end - start
    length = float(np.hypot(*chord))
    height = radius * radius - 0.25 * length * length
    if length == 0.0 or height < -1e-6 * radius * radius:
        return None
    side = 1.0 if (radius > 0.0) == positive else -1.0
    across = np.array([-chord[1], chord[0]]) / length
    return 0.5 * (start + end) + side * np.sqrt(max(height, 0.0)) * across


def places(motions: list[Motion], which: IntArray, share: Array) -> Array:
    """Program coordinates on some motions, (N, A).

    Args:
        which: Index of the motion, (N,).
        share: Of it that is done, 0 to 1, (N,).
    """
    starts, ends = (np.array([getattr(m, end) for m in motions]) for end in ("start", "end"))
    out = starts[which] + share[:, None] * (ends - starts)[which]
    for k, motion in enumerate(motions):
        if motion.arc is None:
            continue
        rows = slice(*np.searchsorted(which, [k, k + 1]))
        plane, centre = list(motion.arc.plane), motion.arc.centre
        a, b = motion.start[plane] - centre, motion.end[plane] - centre
        radius = np.hypot(*a) + share[rows] * (np.hypot(*b) - np.hypot(*a))
        angle = np.arctan2(a[1], a[0]) + share[rows] * motion.arc.angle
        out[rows, plane[0]] = centre[0] + radius * np.cos(angle)
        out[rows, plane[1]] = centre[1] + radius * np.sin(angle)
    return out
