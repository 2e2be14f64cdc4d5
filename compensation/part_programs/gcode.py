"""G-code of part programs as LinuxCNC, Fanuc and their kin take it: lines of motions."""

import re
from functools import cache
from pathlib import Path

import numpy as np

from matstd.compensation.part_programs.motion import Cycle, Motion
from matstd.twin.frames import Array

ENDING = ".ngc"
OPENS = re.compile(r"%|O\d+|(?:\([^)]*\)|;.*)?\s*\Z", re.IGNORECASE)
"""Blocks that stay before all others: some controls look for the program's number there."""

_DECIMALS = 5
"""Decimals of a length in mm and of an angle in degrees: 10 nm, and 90 nm at half a metre."""

HAS_INVERSE_TIME = True

_FEED = re.compile(r"F[\d.]+")
_BACK = re.compile(r"G94 F[\d.]+")


def comment(text: str) -> str:
    """A remark in brackets, which every control takes, without others inside."""
    return f"({text.translate(str.maketrans('()', '[]'))})"


def begin() -> list[str]:
    """First lines of a compensated program: absolute coordinates from here on."""
    return ["G90"]


def decimals(is_length: bool, unit: Array) -> Array:
    """Decimals of a coordinate, (N,)."""
    return np.where(is_length & (unit != 1.0), _DECIMALS + 2, _DECIMALS)


@cache
def _form(axes: tuple[str, ...], places: int) -> str:
    """Format of the words of some axes; lengths have `places` decimals."""
    return "".join(f" {a}%.{places if a in 'XYZ' else _DECIMALS}f" for a in axes)


def lines(
    motion: Motion, axes: tuple[str, ...], shown: list[list[float]], parts: list[float]
) -> list[str]:
    """Straight lines to some places, or the call of a cycle.

    Args:
        motion: Whose lines they are; what else stood in its block goes to the first.
        shown: Program coordinates of these, mm and degrees.
        parts: Share of the motion that each line is.
    """
    unit = motion.unit
    places = _DECIMALS + 2 * (unit != 1.0)
    form = _form(axes, places)
    if unit != 1.0:
        shown = [
            [v / unit if a in "XYZ" else v for a, v in zip(axes, row, strict=True)] for row in shown
        ]
    if motion.cycle is not None:
        out = _called(motion.cycle, form, shown[0], unit, places)
    else:
        head = "G0" if motion.is_rapid else "G1"
        out = [head + form % tuple(row) for row in shown]
        if motion.minutes:
            out = [
                f"{line} F{_number(1.0 / (motion.minutes * part))}"
                for line, part in zip(out, parts, strict=True)
            ]
    if motion.words and out:
        out[0] = f"{motion.words} {out[0]}"
    return out


def _number(value: float) -> str:
    """Seven digits, never in powers of ten."""
    return np.format_float_positional(value, 7, unique=False, fractional=False, trim="-")


def timed_lines(
    motion: Motion,
    axes: tuple[str, ...],
    shown: list[list[float]],
    parts: list[float],
    minutes: float,
) -> list[str]:
    """Lines of a motion in inverse time, then back to its feed; arguments as of `lines`."""
    words = (w for w in motion.words.split() if w != "G94" and not _FEED.fullmatch(w))
    timed = motion._replace(words=" ".join(words), minutes=minutes)
    return ["G93", *lines(timed, axes, shown, parts), f"G94 F{_number(motion.word)}"]


def _called(cycle: Cycle, form: str, row: list[float], unit: float, places: int) -> list[str]:
    """The block of a cycle; the motions that it makes by itself have none."""
    if not cycle.block:
        return []
    top = row[2] + cycle.depth / unit
    return [cycle.block.format(place=form % tuple(row), top=f"{top:.{places}f}")]


def listed(blocks: list[str], path: Path) -> str:
    """The whole file; feed per minute that nothing runs in is left out."""
    kept: list[str] = []
    for block in blocks:
        if block == "G93" and kept and _BACK.fullmatch(kept[-1]):
            kept.pop()
        else:
            kept.append(block)
    return "\n".join(kept) + "\n"
