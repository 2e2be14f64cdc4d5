"""Motions of Klartext: L, LP, C, CP and CR, the pole, M functions."""

import re
from collections.abc import Sequence

import numpy as np

from matstd.compensation.part_programs import klartext_cycles
from matstd.compensation.part_programs.language import (
    Reading,
    centre_by_radius,
    checked_arc,
)
from matstd.compensation.part_programs.motion import Arc
from matstd.nc.grammar import NUMBER
from matstd.twin.frames import Array
from matstd.twin.units import DEG

_KEPT_M = {*range(10), 13, 14, 30, 90, 107, 108, 109, 110, 111, 116, 117, 120, 126, 127, 141}
_SIDES = {"R0": 0.0, "RL": 1.0, "RR": -1.0}
_AXIS = re.compile(rf"(I?)([XYZABCUVW])({NUMBER})\Z")
_POLAR = re.compile(rf"(I?)(PR|PA)({NUMBER})\Z")
_FEED = re.compile(r"F\d+(?:\.\d+)?\Z")


class Modes:
    """What stays in force from block to block.

    Attributes:
        pole: Of circles and polar coordinates, with the shift, mm.
        preset: The block that has called it.
        hole: Cycle that a call means.
        is_calling: Whether every motion calls it (M89).
        tool_feed: Of the last TOOL CALL, which F AUTO means.
    """

    def __init__(self) -> None:
        self.pole: dict[str, float] = {}
        self.preset: str | None = None
        self.hole: klartext_cycles.Hole | None = None
        self.is_calling = False
        self.tool_feed = 0.0

    def plane(self, line: int, bare: str, reading: Reading) -> list[int]:
        """Columns of the plane of the pole; raises BadFile."""
        for letters in ("XY", "ZX", "YZ"):
            if set(letters) == set(self.pole):
                return [reading.column(line, letter) for letter in letters]
        raise reading.refusal(line, repr(bare), "CC with two of X, Y and Z before it")

    def centre(self, line: int, bare: str, reading: Reading) -> Array:
        """The pole in its plane, (2,), mm."""
        return np.array([self.pole[reading.chain.axes[k]] for k in self.plane(line, bare, reading)])


def take_feed(word: float, reading: Reading) -> None:
    """A feed in tenths of an inch in a minute, or in mm/min."""
    reading.feed, reading.feed_unit = word, 1.0 if reading.unit == 1.0 else 0.1 * reading.unit


def take_functions(number: int, words: Sequence[str], reading: Reading) -> None:
    """Take M functions.

    Raises:
        BadFile: One that is not understood.
    """
    for word in words:
        if int(word) in (128, 129):
            reading.switch(word == "128", reading.length)
        elif int(word) not in {89, 91, 99, 140, *_KEPT_M, *reading.passed}:
            expected = "M0 to M9, M13, M14, M30, M89 to M91, M99, M107 to M111, M116, M117, M120, "
            expected += f"M126 to M129, M140, M141; --pass-m {word} where it moves nothing"
            raise reading.refusal(number, f"M{word}", expected)


def pole(number: int, bare: str, reading: Reading, modes: Modes) -> None:
    """Centre of the circles that follow; it is resolved, so the block goes."""
    words = bare.split()[1:]
    if not words:  # the last place is the pole
        modes.pole = {a: float(reading.at[reading.column(number, a)]) for a in "XY"}
    elif len(words) > 1:
        modes.pole = {}
    for word in words:
        match = _AXIS.match(word)
        if match is None:
            raise reading.refusal(number, repr(bare), "CC with two of X, Y and Z")
        step, letter, value = match.groups()
        k = reading.column(number, letter)
        base = reading.at[k] if step else reading.offset[k]
        modes.pole[letter] = base + float(value) * reading.unit


class Words:
    """What the words of a block with a motion say."""

    def __init__(self, number: int, bare: str, reading: Reading, modes: Modes) -> None:
        self.kind, *self.words = bare.split()
        self.number, self.bare, self.reading, self.modes = number, bare, reading, modes
        self.end = reading.at.copy()
        self.named: list[str] = []
        self.functions: list[str] = []
        self.kept: list[str] = []
        self.polar: dict[str, tuple[bool, float]] = {}
        self.sense = self.radius = ""
        self.is_rapid = False
        for word in self.words:
            if not (self._axis(word) or self._path(word) or self._other(word)):
                raise reading.refusal(number, repr(word), f"words of a block {self.kind}")
        self.sweep = self._take_polar() if self.kind in ("LP", "CP") else None

    def _axis(self, word: str) -> bool:
        match = _AXIS.match(word)
        if match is None:
            return False
        step, letter, value = match.groups()
        k = self.reading.column(self.number, letter)
        base = self.end[k] if step else self.reading.offset[k]
        self.end[k] = base + float(value) * self.reading.scale(letter)
        self.named.append(letter)
        return True

    def _path(self, word: str) -> bool:
        """Radius compensation, sense and radius of a circle, polar coordinates."""
        polar = _POLAR.match(word)
        if word in _SIDES:
            self.reading.side = _SIDES[word]
            self.kept.append("R0")
        elif self.kind in ("C", "CP", "CR") and word in ("DR+", "DR-"):
            self.sense = word[2]
        elif self.kind == "CR" and re.fullmatch(rf"R{NUMBER}", word):
            self.radius = word[1:]
        elif polar and (self.kind == "LP" or (self.kind == "CP" and polar[2] == "PA")):
            self.polar[polar[2]] = polar[1] == "I", float(polar[3])
        else:
            return False
        return True

    def _other(self, word: str) -> bool:
        """Feed and M functions."""
        if word in ("FMAX", "FAUTO"):
            self.is_rapid = word == "FMAX"
            if not self.is_rapid:
                take_feed(self.modes.tool_feed, self.reading)
        elif _FEED.match(word):
            take_feed(float(word[1:]), self.reading)
        elif re.fullmatch(r"M\d+", word):
            self.functions.append(word[1:])
            self.kept.append(word)
        elif re.fullmatch(r"LA\d+|MB(?:MAX|[+]?\d+\.?\d*)", word):
            self.kept.append(word)
        else:
            return False
        return True

    def _take_polar(self) -> float | None:
        """End of LP or CP in its plane; its angle where a circle states a step, rad."""
        centre = self.modes.centre(self.number, self.bare, self.reading)
        plane = self.modes.plane(self.number, self.bare, self.reading)
        at = self.end[plane] - centre
        radius, angle = float(np.hypot(*at)), float(np.arctan2(at[1], at[0]))
        is_step, value = self.polar.get("PR", (True, 0.0))
        radius = (radius if is_step else 0.0) + value * self.reading.unit
        is_step, value = self.polar.get("PA", (True, 0.0))
        angle = (angle if is_step else 0.0) + value * DEG
        self.end[plane] = centre + radius * np.array([np.cos(angle), np.sin(angle)])
        self.named += [self.reading.chain.axes[k] for k in plane]
        return value * DEG if self.kind == "CP" and is_step and "PA" in self.polar else None


def motion(number: int, block: str, bare: str, reading: Reading, modes: Modes) -> None:
    """A block of L, LP, C, CP or CR.

    Raises:
        BadFile: What is not understood.
    """
    said = Words(number, bare, reading, modes)
    functions = set(said.functions)
    if {"128", "129"} & functions and said.named:
        raise reading.refusal(number, repr(bare), "M128 and M129 in a block without axes")
    if reading.tcpm and {"91", "140"} & functions:
        raise reading.refusal(number, repr(bare), "M129 before M91 and M140")
    take_functions(number, said.functions, reading)
    is_called = "99" in functions or "89" in functions or (modes.is_calling and bool(said.named))
    modes.is_calling = "99" not in functions and ("89" in functions or modes.is_calling)
    if "91" in functions and not said.named:
        raise reading.refusal(number, "M91 alone", "M91 in an L block")
    if "140" in functions:
        _retract(number, block, said)
    elif is_called:
        _called(number, said, modes)
    elif not said.named and said.kind == "L":
        reading.keep(number, block)
    else:
        _moved(number, bare, said)


def _retract(number: int, block: str, said: Words) -> None:
    """M140: away along the tool's axis, nobody knows how far."""
    reading = said.reading
    if said.named:
        raise reading.refusal(number, repr(said.bare), "M140 in a block without axes")
    tool_side = [link for link in reading.chain.links if not link.carries_workpiece]
    turns = any(link.kind == "rotary" and link.programmed for link in tool_side)
    reading.keep(number, block, moves=True)
    reading.at = reading.at.copy()
    reading.at[reading.linear if turns else reading.column(number, "Z")] = np.nan


def _called(number: int, said: Words, modes: Modes) -> None:
    """A motion with M99 or M89: the cycle is called where it ends."""
    reading = said.reading
    hole = needed_hole(number, reading, modes)
    kept = [w for w in said.kept if w not in ("M89", "M99")]
    turned = tuple(a for a in said.named if not reading.is_linear(a))
    if "Z" in said.named:
        reading.move(number, said.end, said.is_rapid, " ".join(kept), turned)
        kept, turned = [], ()
    reading.at = said.end
    feed = "FMAX" if said.is_rapid or not reading.feed else f"F{reading.feed:g}"
    klartext_cycles.call(number, hole, " ".join([*kept, feed, "M99"]), turned, reading)


def needed_hole(number: int, reading: Reading, modes: Modes) -> klartext_cycles.Hole:
    """The cycle that a call means; raises BadFile."""
    if modes.hole is None:
        raise reading.refusal(number, "a call of no cycle", "CYCL DEF of a hole before it")
    return modes.hole


def _moved(number: int, bare: str, said: Words) -> None:
    """A motion of the program's own."""
    reading = said.reading
    is_arc = said.kind in ("C", "CP", "CR")
    is_machine = "91" in said.functions
    if is_machine or not reading.is_known(said.end, is_arc):
        if is_arc:
            raise reading.refusal(number, repr(bare), "a motion to X, Y and Z before it")
        reading.keep(number, bare, moves=True)
        if is_machine:
            said.end[[reading.column(number, letter) for letter in said.named]] = np.nan
        reading.at = said.end
        return
    arc = _arc(said) if is_arc else None
    turned = tuple(a for a in said.named if not reading.is_linear(a))
    reading.move(number, said.end, said.is_rapid, " ".join(said.kept), turned, arc)


def _arc(said: Words) -> Arc:
    """Circle about the pole (C, CP), or of a radius (CR), in the plane of the pole, else X, Y."""
    number, bare, reading = said.number, said.bare, said.reading
    if not said.sense:
        raise reading.refusal(number, repr(bare), "DR+ or DR-")
    positive = said.sense == "+"
    if said.kind == "CR":
        columns = [reading.column(number, letter) for letter in "XY"]
        radius = float(said.radius or 0.0) * reading.unit
        centre = centre_by_radius(reading, number, columns, said.end, radius, positive)
        return checked_arc(reading, number, columns, said.end, centre, positive)
    columns = said.modes.plane(number, bare, reading)
    centre = said.modes.centre(number, bare, reading)
    if said.sweep is not None:
        if said.sweep == 0.0 or (said.sweep > 0.0) != positive:
            raise reading.refusal(number, repr(bare), "IPA and DR of one sign")
        return Arc((columns[0], columns[1]), centre, said.sweep)
    return checked_arc(reading, number, columns, said.end, centre, positive)
