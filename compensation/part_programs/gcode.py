"""G-code of part programs as LinuxCNC, Fanuc and their kin take it: lines of motions."""

import re
from pathlib import Path

import numpy as np

from matstd.compensation.part_programs.motion import Digits, Motion, axis_words

ENDING = ".ngc"
OPENS = re.compile(r"%|O\d+|(?:\([^)]*\)|;.*)?\s*\Z", re.IGNORECASE)
"""Blocks that stay before all others: some controls look for the program's number there."""

DIGITS = Digits(usual=5, inch=7)  # 10 nm, and 90 nm of an angle at half a metre

HAS_INVERSE_TIME = True
BEGIN = ("G90",)  # first lines of a compensated program: absolute coordinates from here on

_FEED = re.compile(r"F[\d.]+")
_BACK = re.compile(r"G94 F[\d.]+")


def comment(text: str) -> str:
    """A remark in brackets, which every control takes, without others inside."""
    return f"({text.translate(str.maketrans('()', '[]'))})"


def lines(
    motion: Motion, axes: tuple[str, ...], shown: list[list[float]], parts: list[float]
) -> list[str]:
    """Straight lines to some places, or the call of a cycle.

    Args:
        motion: Whose lines they are; what else stood in its block goes to the first.
        shown: Program coordinates of these, mm and degrees.
        parts: Share of the motion that each line is.
    """
    unit, cycle = motion.unit, motion.cycle
    out = axis_words(axes, shown, unit, DIGITS)
    if cycle is not None:  # the motions that it makes by itself have no block
        top = f"{shown[0][2] / unit + cycle.depth / unit:.{DIGITS.of(unit)}f}"
        out = [cycle.block.format(place=out[0], top=top)] if cycle.block else []
    else:
        out = [f"{'G0' if motion.is_rapid else 'G1'}{words}" for words in out]
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


def listed(blocks: list[str], path: Path) -> str:
    """The whole file; feed per minute that nothing runs in is left out."""
    kept: list[str] = []
    for block in blocks:
        if block == "G93" and kept and _BACK.fullmatch(kept[-1]):
            kept.pop()
        else:
            kept.append(block)
    return "\n".join(kept) + "\n"
