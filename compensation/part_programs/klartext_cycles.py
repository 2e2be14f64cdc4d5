"""Cycles of Klartext that make a hole along Z, called once at its compensated place.

The definition of the cycle stands before every call again, its surface (Q203) shifted by what the
bottom of the hole needs.
"""

import re
from typing import NamedTuple

from matstd.compensation.part_programs.language import Reading
from matstd.nc.grammar import NUMBER
from matstd.twin.frames import Array

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
