"""Heidenhain Klartext of part programs: blocks of motions."""

import re
from collections.abc import Iterator
from pathlib import Path

from matstd.compensation.part_programs.klartext_words import is_hole
from matstd.compensation.part_programs.motion import Digits, Motion, axis_words

ENDING = ".H"
HAS_INVERSE_TIME = False
OPENS = re.compile("BEGIN", re.IGNORECASE)
BEGIN = ()  # nothing has to stand before a compensated program
DIGITS = Digits(usual=4, inch=5)
"""Steps in which the control takes coordinates: 0.1 µm, 0.0001 degrees."""


def comment(text: str) -> str:
    """A remark."""
    return f"; {text}"


def lines(
    motion: Motion, axes: tuple[str, ...], shown: list[list[float]], parts: list[float]
) -> list[str]:
    """Straight lines to some places, or the call of a cycle; arguments as of `gcode.lines`."""
    unit, cycle = motion.unit, motion.cycle
    if cycle is not None:
        if not cycle.block:
            return []
        x, y, z, *turned = shown[0]
        top = f"{z / unit + cycle.depth / unit:+.{DIGITS.of(unit)}f}"
        (place,) = axis_words(("X", "Y", *axes[3:]), [[x, y, *turned]], unit, DIGITS, "+")
        return [cycle.block.format(top=top), f"L{place} {motion.words}"]
    words = motion.words.split()
    feed = "FMAX" if motion.is_rapid else f"F{motion.word:.6g}"
    placed = axis_words(axes, shown, unit, DIGITS, "+")
    first = " ".join(["R0"] * ("R0" in words) + [feed, *(w for w in words if w != "R0")])
    return [f"L{placed[0]} {first}", *(f"L{place} {feed}" for place in placed[1:])]


def _defined_once(blocks: list[str]) -> Iterator[str]:
    """Blocks without definitions of a cycle that is defined so already."""
    last = ""
    for block in blocks:
        if is_hole(block):
            if block == last:
                continue
            last = block
        yield block


def listed(blocks: list[str], path: Path) -> str:
    """The whole file, blocks numbered and the program named after its file."""
    named = [re.sub(r"\A(BEGIN|END) PGM \S+", rf"\1 PGM {path.stem.upper()}", b) for b in blocks]
    text = "\n".join(f"{k} {block}" for k, block in enumerate(_defined_once(named)))
    return text.replace("\n", "\r\n") + "\r\n"
