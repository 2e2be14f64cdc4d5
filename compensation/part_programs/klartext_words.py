"""Words of Klartext blocks: motions, and cycles that make a hole along Z.

A hole is made at its compensated place. The definition of its cycle stands before every call again,
its surface (Q203) shifted by what the bottom needs.
"""

import re
from typing import NamedTuple

import numpy as np

from matstd.compensation.part_programs.language import Reading
from matstd.nc.grammar import NUMBER
from matstd.twin.frames import Array
from matstd.twin.units import DEG

AXIS = re.compile(rf"(I?)([XYZABCUVW])({NUMBER})\Z")
_SIDES = {"R0": 0.0, "RL": 1.0, "RR": -1.0}
_POLAR = re.compile(rf"(I?)(PR|PA)({NUMBER})\Z")
_FEED = re.compile(r"F\d+(?:\.\d+)?\Z")


class Modes:
    """What stays in force from block to block."""

    def __init__(self, reading: Reading) -> None:
        self.reading = reading
        self.pole: dict[str, float] = {}  # of circles and polar coordinates, with the shift, mm
        self.tool_feed = 0.0  # of the last TOOL CALL, which F AUTO means

    def circle(self, line: int, bare: str) -> tuple[list[int], Array]:
        """Columns of the plane of the pole, and the pole in it, mm; raises BadFile."""
        for letters in ("XY", "ZX", "YZ"):
            if set(letters) == set(self.pole):
                columns = [self.reading.column(line, letter) for letter in letters]
                return columns, np.array([self.pole[letter] for letter in letters])
        raise self.reading.refusal(line, repr(bare), "CC with two of X, Y and Z before it")

    def take_feed(self, word: float) -> None:
        """A feed in tenths of an inch in a minute, or in mm/min."""
        reading = self.reading
        reading.feed, reading.feed_unit = word, 1.0 if reading.unit == 1.0 else 0.1 * reading.unit


class Words:
    """What the words of a block with a motion say."""

    def __init__(self, line: int, bare: str, modes: Modes) -> None:
        self.kind, *words = bare.split()  # L, LP, C, CP or CR first
        self.line, self.bare, self.reading, self.modes = line, bare, modes.reading, modes
        self.end = self.reading.at.copy()  # where the axes stand after it, (A,), mm and rad
        self.named: list[str] = []
        self.functions: list[str] = []
        self.kept: list[str] = []
        self.polar: dict[str, tuple[bool, float]] = {}
        self.sense = self.radius = ""
        self.is_rapid = False
        for word in words:
            if not (self._axis(word) or self._path(word) or self._other(word)):
                raise self.reading.refusal(line, repr(word), f"words of a block {self.kind}")
        # angle of a circle that states a step, rad
        self.sweep = self._take_polar() if self.kind in ("LP", "CP") else None

    def _axis(self, word: str) -> bool:
        match = AXIS.match(word)
        if match is None:
            return False
        step, letter, value = match.groups()
        k = self.reading.column(self.line, letter)
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
                self.modes.take_feed(self.modes.tool_feed)
        elif _FEED.match(word):
            self.modes.take_feed(float(word[1:]))
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
        plane, centre = self.modes.circle(self.line, self.bare)
        at = self.end[plane] - centre
        radius, angle = float(np.hypot(*at)), float(np.arctan2(at[1], at[0]))
        is_step, value = self.polar.get("PR", (True, 0.0))
        radius = (radius if is_step else 0.0) + value * self.reading.unit
        is_step, value = self.polar.get("PA", (True, 0.0))
        angle = (angle if is_step else 0.0) + value * DEG
        self.end[plane] = centre + radius * np.array([np.cos(angle), np.sin(angle)])
        self.named += [self.reading.chain.axes[k] for k in plane]
        return value * DEG if self.kind == "CP" and is_step and "PA" in self.polar else None


HOLES = ("200", "201", "202", "203", "205", "206", "207", "208", "209", "240", "241")
_DEFINED = re.compile(r"CYCL DEF (\d{3})\b")
_NUMBER = re.compile(rf"\bQ(\d+) *= *({NUMBER})(?=\s|\Z)")
_SURFACE = re.compile(rf"(\bQ203 *= *){NUMBER}", re.IGNORECASE)


DEFAULT_PLUNGE_FEED = 100.0
"""Feed where a cycle has none as a number, such as FAUTO, mm/min: for the time alone."""


class Hole(NamedTuple):
    """A cycle as it was defined; heights in coordinates of the program, mm."""

    text: str  # the block, `{top}` where its surface stands
    surface: float  # Q203
    depth: float  # Q201, downwards
    near: float  # set-up clearance above the surface, Q200
    far: float  # height above it on which the cycle ends
    feed: float  # Q206, or what is in force, mm/min


def is_hole(block: str) -> bool:
    """Whether a block defines one of these cycles."""
    number = _DEFINED.match(block.upper())
    return number is not None and number[1] in HOLES


def defined(line: int, block: str, reading: Reading) -> Hole:
    """A cycle by its definition; raises BadFile."""
    if not is_hole(block):
        known = ", ".join(HOLES)
        expected = f"cycles 7, 9, 13, 32, 247 and holes ({known}); others are resolved before"
        raise reading.refusal(line, repr(" ".join(block.split()[:4])), expected)
    plain = " ".join(part.partition(";")[0].rstrip(" ~") for part in block.upper().splitlines())
    found = {k: float(v) * reading.unit for k, v in _NUMBER.findall(plain)}
    for k, name in (("200", "clearance"), ("201", "depth"), ("203", "surface")):
        if k not in found:
            raise reading.refusal(line, f"a cycle without Q{k}", f"its {name} as a number")
    if found["201"] >= 0.0:
        raise reading.refusal(line, f"Q201={found['201']:g}", "a depth below zero")
    text = _SURFACE.sub(r"\1{top}", block.replace("{", "{{").replace("}", "}}"))
    near = found["200"]
    far = max(near, found.get("204", 0.0))
    feed = found.get("206") or reading.feed * reading.feed_unit or DEFAULT_PLUNGE_FEED
    return Hole(text=text, surface=found["203"], depth=-found["201"], near=near, far=far, feed=feed)


def way(start: Array, end: Array, z: int, height: float) -> list[Array]:
    """Places on the way to a call at a place of its own: up first where the tool stands low.

    Args:
        height: Above the surface that the cycle begins at, mm.
    """
    up, over = start.copy(), end.copy()
    up[z] = over[z] = max(float(start[z]), height)
    return [over] if up[z] == start[z] else [up, over]
