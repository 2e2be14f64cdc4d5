"""What a part program does, whatever its language: blocks that are kept, and motions."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cache
from typing import NamedTuple

import numpy as np

from matstd.twin.frames import Array, IntArray
from matstd.twin.units import DEG


@dataclass(frozen=True, slots=True)
class Keep:
    """A block that moves nothing, or nothing whose place is known; it stays as it is."""

    line: int
    text: str  # without its number
    # whether it still moves an axis: in coordinates of the machine, or before the place of every
    # axis is known
    moves: bool = False


class Corner(NamedTuple):
    """A corner between the motions before and behind it."""

    line: int
    size: float  # radius, or the length that a chamfer cuts off both, mm
    is_round: bool


class Arc(NamedTuple):
    """A circular arc, or a helix, in a plane of two linear axes."""

    plane: tuple[int, int]  # columns of the readings, in the order in which a positive angle turns
    centre: Array  # centre of the circle in that plane, (2,), mm
    angle: float  # from start to end, signed, rad


class Cycle(NamedTuple):
    """What the control does by itself at a place that the program names: a hole along Z.

    A cycle is three motions: above the hole, to its bottom, back. It is shifted as a whole, by what
    its bottom needs.
    """

    block: str  # block that calls it, with `{place}` and `{top}`; the second motion alone has one
    # bottom below what the block states as its top, mm: R of G-code, the surface of Klartext
    depth: float
    ahead: int  # motions from here to the second of the three


class ArcFeed(Enum):
    """What the feed of an arc beside a contour is the speed of."""

    CENTRE = 111  # of the tool's centre
    EDGE = 109  # of the cutting edge on the contour
    INNER_EDGE = 110  # of the edge where the centre goes on the smaller radius, else of the centre


class Motion(NamedTuple):
    """A block that moves axes, from where the one before has ended."""

    line: int
    start: Array  # program coordinates of every axis, (A,), mm and rad
    end: Array
    is_rapid: bool  # whether it cuts nothing
    feed: float  # mm/min, or degrees/min where axes turn alone; 0 where it is rapid
    word: float  # the feed as the number that the program states
    is_from_known: bool  # whether the place of every axis is known where it begins
    tcpm: bool  # whether coordinates are those of the tool point on the turning table
    length: float  # length of the tool, mm
    # what the program has shifted its zero by, (A,), mm; in `start` and `end` already
    offset: Array
    unit: float  # one unit of the program's lengths, mm
    words: str  # what else stands in the block, for its first line
    turned: tuple[str, ...]
    arc: Arc | None = None  # None for a straight line
    # way by which the tool's centre goes to the left of the path that is programmed, mm; to the
    # right below zero. Zero once it is resolved
    beside: float = 0.0
    arc_feed: ArcFeed = ArcFeed.CENTRE
    # time that it takes where the program states that instead of a feed; else 0
    minutes: float = 0.0
    cycle: Cycle | None = None  # None where the program itself says how the axes move


Item = Keep | Motion


class Digits(NamedTuple):
    """Decimals of coordinates in a language, mm and degrees, and of lengths in inches."""

    usual: int
    inch: int

    def of(self, unit: float) -> int:
        """Decimals of lengths in a unit, mm."""
        return self.usual if unit == 1.0 else self.inch


@cache
def _form(axes: tuple[str, ...], lengths: int, angles: int, sign: str) -> str:
    return "".join(f" {a}%{sign}.{lengths if a in 'XYZ' else angles}f" for a in axes)


def axis_words(
    axes: tuple[str, ...], rows: list[list[float]], unit: float, digits: Digits, sign: str = ""
) -> list[str]:
    """Coordinates of some axes as the words of blocks, one row a block.

    Args:
        unit: One unit of the program's lengths, mm.
        sign: `+` where every number has its sign.
    """
    form = _form(axes, digits.of(unit), digits.usual, sign)
    if unit != 1.0:
        rows = [
            [v / unit if a in "XYZ" else v for a, v in zip(axes, row, strict=True)] for row in rows
        ]
    return [form % tuple(row) for row in rows]


def angle_between(start: Array, end: Array, centre: Array, positive: bool, turns: int = 1) -> float:
    """Angle of an arc; a whole circle where start and end are the same.

    Args:
        start: In the plane, (2,), mm.
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


class Paths:
    """Where motions lead."""

    def __init__(self, motions: Sequence[Motion], linear: list[int]) -> None:
        self.start = np.array([m.start for m in motions])  # (M, A), mm and rad
        self.end = np.array([m.end for m in motions])
        self.arcs = [(k, m.arc) for k, m in enumerate(motions) if m.arc is not None]
        moved = self.end - self.start
        for k, arc in self.arcs:
            moved[k, list(arc.plane)] = self.radius(k, arc) * arc.angle, 0.0
        self.far = np.linalg.norm(moved[:, linear], axis=1)  # way of the linear axes, (M,), mm
        # angle of the rotary axes, (M,), degrees; the root of the sum of squares
        self.turned = np.linalg.norm(np.delete(moved, linear, axis=1), axis=1) / DEG
        # what their feed refers to, (M,), as LinuxCNC counts it: the angle where axes turn alone
        self.travel = np.where(self.far > 0.0, self.far, self.turned)

    def radius(self, k: int, arc: Arc) -> float:
        """Radius of a motion that is an arc, mm."""
        return float(np.hypot(*(self.start[k, list(arc.plane)] - arc.centre)))

    def at(self, which: IntArray, share: Array) -> Array:
        """Program coordinates on some motions, (N, A).

        Args:
            which: Number of the motion, ascending, (N,).
            share: Share of it that is done, 0 to 1, (N,).
        """
        out = self.start[which] + share[:, None] * (self.end - self.start)[which]
        for k, arc in self.arcs:
            rows = slice(*np.searchsorted(which, [k, k + 1]))
            plane, centre = list(arc.plane), arc.centre
            a, b = self.start[k, plane] - centre, self.end[k, plane] - centre
            radius = np.hypot(*a) + share[rows] * (np.hypot(*b) - np.hypot(*a))
            angle = np.arctan2(a[1], a[0]) + share[rows] * arc.angle
            out[rows, plane[0]] = centre[0] + radius * np.cos(angle)
            out[rows, plane[1]] = centre[1] + radius * np.sin(angle)
        return out
