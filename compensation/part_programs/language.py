"""What languages of part programs share: words of a block, the state that they change."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from matstd.compensation.part_programs.frame import Frame
from matstd.compensation.part_programs.motion import (
    Arc,
    ArcFeed,
    Corner,
    Cycle,
    Item,
    Keep,
    Motion,
    angle_between,
)
from matstd.twin.errors import BadFile
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.units import DEG

LENGTHS = "XYZUVW"  # letters of words that are lengths


@dataclass
class Reading:
    """A program while it is read: where its axes stand, what is in force."""

    path: Path
    frame: Frame  # where the program's zero stands on the machine
    # lengths of tools by number or name, mm; other tools have that of the datum
    lengths: dict[int | str, float]
    radii: dict[int | str, float] = field(default_factory=dict)  # radii of tools by number, mm
    # numbers of M functions of the machine that move nothing, as the user states
    passed: frozenset[int] = frozenset()
    # M functions of the machine that switch tool-point control on, and off
    tcp_functions: tuple[int, ...] = ()
    # program coordinates with the shift, (A,), mm and rad; nan where unknown
    at: Array = field(init=False)
    offset: Array = field(init=False)  # shift of the program's zero, (A,), mm
    items: list[Item | Corner] = field(default_factory=list)
    length: float = field(init=False)
    feed: float = 0.0  # number of the F word in force; degrees/min where axes turn alone
    feed_unit: float = 1.0  # one of it where linear axes move, mm/min
    arc_feed: ArcFeed = ArcFeed.CENTRE
    tcpm: bool = False
    unit: float = 1.0
    tool: int | str | None = None  # number, or name, of that in the spindle
    more_radius: float = 0.0  # what the program adds to its radius, mm
    side: float = 0.0  # side of the contour on which the tool goes: 1 left, -1 right, 0 on it

    def __post_init__(self) -> None:
        self.at = self.frame.datum.q.copy()
        self.at[self.linear] = np.nan
        self.offset = np.zeros(len(self.at))
        self.length = self.frame.datum.length
        self._columns = {a: self.chain.axis_index(a) for a in self.chain.programmed_axes}

    @property
    def chain(self) -> Chain:
        """The machine."""
        return self.frame.chain

    def switch(self, tcpm: bool, length: float) -> None:
        """Another way to count coordinates, or another tool: the axes stand still."""
        if not np.isnan(self.at).any():
            q = self.frame.readings(self.at[None], self.tcpm, self.length)
            self.at = self.frame.coordinates(q, tcpm, length)[0]
        self.tcpm, self.length = tcpm, length

    def refusal(self, line: int, found: str, expected: str) -> BadFile:
        """What is not understood, with its line."""
        return BadFile(self.path, line, found, expected)

    def column(self, line: int, letter: str) -> int:
        """Column of an axis of the program; raises BadFile."""
        if letter not in self._columns:
            available = ", ".join(self._columns)
            raise self.refusal(line, f"axis {letter}", f"an axis of the machine: {available}")
        return self._columns[letter]

    def scale(self, letter: str) -> float:
        """One unit of an axis's word in base units."""
        return self.unit if letter in LENGTHS else DEG

    def keep(self, line: int, text: str, moves: bool = False) -> None:
        """A block that stays."""
        self.items.append(Keep(line, text, moves))

    def leave(self, line: int, text: str, letters: Iterable[str] | None) -> None:
        """A block that moves axes to where no place is known; None stands for all axes."""
        self.keep(line, text, moves=True)
        columns = None if letters is None else [self.column(line, a) for a in letters]
        self.at = self.at.copy()
        self.at[slice(None) if columns is None else columns] = np.nan

    @property
    def linear(self) -> list[int]:
        """Columns of the linear axes."""
        return self.frame.linear

    def is_known(self, end: Array, is_arc: bool) -> bool:
        """Whether all axes have a place after a motion, and before it if it is an arc."""
        return _is_finite(end) and (not is_arc or _is_finite(self.at))

    def beside(self, line: int) -> float:
        """Way of the tool's centre to the left of the contour, mm; raises BadFile."""
        if self.tool not in self.radii:
            named = "the tool" if self.tool is None else f"tool {self.tool}"
            number = "NUMBER" if self.tool is None else self.tool
            found = f"a contour beside {named}, whose radius is not stated"
            raise self.refusal(line, found, f"--tool-radius {number}=MM")
        radius = self.radii[self.tool] + self.more_radius
        if radius <= 0.0:
            raise self.refusal(line, f"a tool of radius {radius:g} mm", "one above zero")
        return self.side * radius

    def needed_feed(self, line: int, is_turn: bool) -> float:
        """Feed of a motion, mm/min, or degrees/min of axes that turn alone; raises BadFile."""
        if self.feed <= 0.0:
            raise self.refusal(line, "a motion without feed", "F above zero in it or before it")
        return self.feed * (1.0 if is_turn else self.feed_unit)

    def move(
        self,
        line: int,
        end: Array,
        is_rapid: bool,
        words: str = "",
        named: Sequence[str] = (),
        arc: Arc | None = None,
        minutes: float = 0.0,
        cycle: Cycle | None = None,
    ) -> None:
        """A motion, after which the axes stand at its end; arguments as of `Motion`.

        `named` are all axes that the block names.

        Raises:
            BadFile: No feed, or a contour beside a tool whose radius is not stated.
        """
        is_known = _is_finite(self.at)
        # an axis without a known place is taken to stand at its end already
        at = self.at if is_known else np.where(np.isnan(self.at), end, self.at)
        is_turn = arc is None and not np.any((end - self.at)[self.linear])
        feed = 0.0 if is_rapid or minutes else self.needed_feed(line, is_turn)
        beside = self.beside(line) if self.side else 0.0
        motion = Motion(
            line=line,
            start=at,
            end=end,
            is_rapid=is_rapid,
            feed=feed,
            word=self.feed,
            is_from_known=is_known,
            tcpm=self.tcpm,
            length=self.length,
            offset=self.offset,
            unit=self.unit,
            words=words,
            turned=tuple(a for a in named if a not in LENGTHS),
            arc=arc,
            beside=beside,
            arc_feed=self.arc_feed,
            minutes=minutes,
            cycle=cycle,
        )
        self.items.append(motion)
        self.at = end

    def hole(
        self,
        line: int,
        place: Array,
        z: int,
        heights: tuple[float, float, float],
        words: str,
        cycle: Cycle,
        named: Sequence[str] = (),
        minutes: float = 0.0,
    ) -> None:
        """The three motions of a cycle; raises BadFile.

        Args:
            place: Where the axes stand above it, (A,).
            heights: Z above the hole, at its bottom and after it, mm.
            minutes: Time to the bottom where the feed in force is not that of the cycle.
        """
        if self.side or self.tcpm:
            where = "beside a contour" if self.side else "with tool-point control"
            raise self.refusal(line, f"a cycle {where}", "it before or after")
        levels = [place.copy() for _ in heights]
        for at, height in zip(levels, heights, strict=True):
            at[z] = height
        if not all(self.is_known(at, True) for at in levels):
            raise self.refusal(line, "a cycle from where no axis is known to stand", "X, Y and Z")
        above, bottom, after = levels
        self.move(line, above, True, cycle=cycle._replace(block="", ahead=1))
        self.move(line, bottom, False, words, named, minutes=minutes, cycle=cycle)
        self.move(line, after, True, cycle=cycle._replace(block="", ahead=-1))


def _is_finite(at: Array) -> bool:
    return math.isfinite(sum(at.tolist()))


MAX_ARC_MISFIT = 0.02
"""An arc's end may lie off its circle by so much, mm: coordinates are rounded to micrometres,
inches to ten of them."""


def centre_by_radius(
    reading: Reading, line: int, plane: list[int], end: Array, radius: float, positive: bool
) -> Array:
    """Centre of an arc that is given by its radius, (2,), mm; below zero for the longer way round.

    Raises:
        BadFile: Ends that no such circle joins.
    """
    start, stop = reading.at[plane], end[plane]
    chord = stop - start
    length = float(np.hypot(*chord))
    height = radius * radius - 0.25 * length * length
    if length == 0.0 or height < -1e-6 * radius * radius:
        raise reading.refusal(
            line,
            f"R{radius:g} for ends {length:.4f} mm apart",
            "half of that at least, and two ends",
        )
    side = 1.0 if (radius > 0.0) == positive else -1.0
    across = np.array([-chord[1], chord[0]]) / length
    return 0.5 * (start + stop) + side * np.sqrt(max(height, 0.0)) * across


def checked_arc(
    reading: Reading,
    line: int,
    plane: list[int],
    end: Array,
    centre: Array,
    positive: bool,
    turns: int = 1,
) -> Arc:
    """Arc from where the axes stand about a centre; raises BadFile."""
    start, stop = reading.at[plane], end[plane]
    off = float(abs(np.hypot(*(stop - centre)) - np.hypot(*(start - centre))))
    if off > MAX_ARC_MISFIT:
        raise reading.refusal(
            line, f"an end {off:.4f} mm off the circle", f"{MAX_ARC_MISFIT} mm at most"
        )
    angle = angle_between(start, stop, centre, positive, turns)
    return Arc((plane[0], plane[1]), centre, angle)
