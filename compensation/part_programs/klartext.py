"""Heidenhain Klartext of part programs: blocks of motions."""

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np

from matstd.compensation.part_programs import klartext_cycles
from matstd.compensation.part_programs.motion import Motion
from matstd.twin.frames import Array

ENDING = ".H"
HAS_INVERSE_TIME = False
OPENS = re.compile("BEGIN", re.IGNORECASE)
_DECIMALS = 4  # steps in which the control takes coordinates: 0.1 µm, 0.0001 degrees


def comment(text: str) -> str:
    """A remark."""
    return f"; {text}"


def begin() -> list[str]:
    """Nothing has to stand before a compensated program."""
    return []


def decimals(is_length: bool, unit: Array) -> Array:
    """Decimals of a coordinate, (N,); one more of inches."""
    return np.where(is_length & (unit != 1.0), _DECIMALS + 1, _DECIMALS)


@cache
def _form(axes: tuple[str, ...], places: int) -> str:
    """Format of the words of some axes; lengths have `places` decimals."""
    return "".join(f" {a}%+.{places if a in 'XYZ' else _DECIMALS}f" for a in axes)


def lines(
    motion: Motion, axes: tuple[str, ...], shown: list[list[float]], parts: list[float]
) -> list[str]:
    """Straight lines to some places, or the call of a cycle; arguments as of `gcode.lines`."""
    unit, places = motion.unit, _DECIMALS + (motion.unit != 1.0)
    if unit != 1.0:
        shown = [
            [v / unit if a in "XYZ" else v for a, v in zip(axes, row, strict=True)] for row in shown
        ]
    if motion.cycle is not None:
        if not motion.cycle.block:
            return []
        x, y, z, *turned = shown[0]
        top = f"{z + motion.cycle.depth / unit:+.{places}f}"
        place = _form(("X", "Y", *axes[3:]), places) % (x, y, *turned)
        return [motion.cycle.block.format(top=top), f"L{place} {motion.words}"]
    words = motion.words.split()
    feed = "FMAX" if motion.is_rapid else f"F{motion.word:.6g}"
    form = f"L{_form(axes, places)}"
    out = [f"{form % tuple(row)} {feed}" for row in shown]
    first = " ".join(["R0"] * ("R0" in words) + [feed, *(w for w in words if w != "R0")])
    out[0] = f"{form % tuple(shown[0])} {first}"
    return out


def _defined_once(blocks: list[str]) -> Iterator[str]:
    """Blocks without definitions of a cycle that is defined so already."""
    last = ""
    for block in blocks:
        if klartext_cycles.is_hole(block):
            if block == last:
                continue
            last = block
        yield block


def listed(blocks: list[str], path: Path) -> str:
    """The whole file, blocks numbered and the program named after it."""
    named = [re.sub(r"\A(BEGIN|END) PGM \S+", rf"\1 PGM {path.stem.upper()}", b) for b in blocks]
    text = "\n".join(f"{k} {block}" for k, block in enumerate(_defined_once(named)))
    return text.replace("\n", "\r\n") + "\r\n"
