"""G-code of part programs as LinuxCNC, Fanuc and their kin take it: a reader, lines of motions."""

import re
from functools import cache
from pathlib import Path

import numpy as np

from matstd.compensation.part_programs import gcode_cycles
from matstd.compensation.part_programs.gcode_modes import CYCLES, HOMES, KEPT, Modes, function, take
from matstd.compensation.part_programs.gcode_modes import tool as take_tool
from matstd.compensation.part_programs.language import (
    Reading,
    centre_by_radius,
    checked_arc,
)
from matstd.compensation.part_programs.motion import Arc, Cycle, Motion
from matstd.nc.grammar import gcode_lines, split_words
from matstd.twin.frames import Array

ENDING = ".ngc"
OPENS = re.compile(r"%|O\d+|(?:\([^)]*\)|;.*)?\s*\Z", re.IGNORECASE)
"""Blocks that stay before all others: some controls look for the program's number there."""

_DECIMALS = 5
"""Of a length in mm, and of an angle in degrees: 10 nm, and 9 nm at half a metre."""

HAS_INVERSE_TIME = True

_FEED = re.compile(r"F[\d.]+")
_BACK = re.compile(r"G94 F[\d.]+")
_CENTRES = dict(zip("XYZ", "IJK", strict=True))
_NAME = re.compile(r"O\d+")
_NOT_PLAIN = re.compile(r"[/$]|O\d|O<|.*[#\[=]")
_CHANGE = re.compile(r"M0*6(?!\d)", re.IGNORECASE)


def read(text: str, reading: Reading) -> None:
    """Read a whole program into the items of `reading`.

    Raises:
        BadFile: A line that is not understood, with its number.
    """
    modes = Modes(calls_by_t=_CHANGE.search(text) is None)
    is_begun = False
    for line, raw, code, remarks in gcode_lines(text.splitlines()):
        if not code or code[0] == "%" or (not is_begun and _NAME.fullmatch(code)):
            reading.keep(line, raw)
            continue
        is_begun = True
        if _NOT_PLAIN.match(code):
            expected = "plain words: no parameters, expressions, subprograms or skipped blocks"
            raise reading.refusal(line, repr(raw), expected)
        try:
            words = split_words(code)
        except ValueError as error:
            raise reading.refusal(line, repr(str(error)), "words of G-code") from None
        _line(line, words, remarks, reading, modes)


def _line(
    number: int, words: list[tuple[str, float]], comment: str, reading: Reading, modes: Modes
) -> None:
    """One line: modes first, then its motion."""
    g = [value for letter, value in words if letter == "G"]
    m = [int(value) for letter, value in words if letter == "M"]
    other = {letter: value for letter, value in words if letter not in "GMN"}
    kept = [comment] if comment else []
    if g:
        take(number, g, other, reading, modes)
        kept += [f"G{value:g}" for value in g if value in KEPT]
    if "T" in other or "D" in other:
        take_tool(number, g, other, reading, modes)
    for value in m:
        function(number, value, reading, modes)
        kept.append(f"M{value}")
    if "F" in other:
        _feed(other["F"], reading, modes)
    axes = {k: v for k, v in other.items() if k in "XYZABCUVW"}
    is_motion = bool(axes) or (modes.motion in (2.0, 3.0) and not set("IJK").isdisjoint(other))
    if is_motion and not HOMES.intersection(g):
        _moving(number, g, axes, other, kept, reading, modes)
        return
    kept += [f"{k}{v:.10g}" for k, v in other.items() if k != "D" and k not in axes]
    if kept and not HOMES.intersection(g):
        reading.keep(number, " ".join(kept))
    elif kept or axes:
        _home(number, axes, " ".join(kept), reading, modes)


def _feed(value: float, reading: Reading, modes: Modes) -> None:
    """An F word: a feed, or how often in a minute the motion could be made."""
    if modes.is_inverse:
        modes.minutes = 1.0 / value if value > 0.0 else 0.0
    else:
        reading.feed, reading.feed_unit = value, reading.unit


def _home(number: int, axes: dict[str, float], words: str, reading: Reading, modes: Modes) -> None:
    """G28 or G30: to a place of the machine, by way of one of the program."""
    named = _placed(axes)
    text = f"{words} {named}".strip()
    reading.keep(number, text if modes.is_absolute else f"G91 {text}\nG90", moves=True)
    columns = [reading.column(number, letter) for letter in axes]
    reading.at = reading.at.copy()
    reading.at[columns or slice(None)] = np.nan


def _placed(axes: dict[str, float]) -> str:
    return " ".join(f"{k}{v:.10g}" for k, v in axes.items())


def _moving(
    number: int,
    g: list[float],
    axes: dict[str, float],
    other: dict[str, float],
    kept: list[str],
    reading: Reading,
    modes: Modes,
) -> None:
    """A line with axes, or with the centre of a circle."""
    if modes.motion is None or 4.0 in g:
        raise reading.refusal(number, "axes without G0, G1, G2 or G3", "one of them before")
    spent = "IJKRDF" if modes.is_inverse else "IJKRD"
    spent += "" if 64.0 in g else "P"
    spent += "QL" if modes.motion in CYCLES else ""
    kept += [f"{k}{v:.10g}" for k, v in other.items() if k not in axes and k not in spent]
    words = " ".join(kept)
    if modes.motion in CYCLES:
        gcode_cycles.call(number, axes, other, words, reading, modes)
    elif 53.0 in g:
        reading.keep(number, f"{words} G53 G{modes.motion:g} {_placed(axes)}".strip(), moves=True)
        reading.at = reading.at.copy()
        reading.at[[reading.column(number, letter) for letter in axes]] = np.nan
    else:
        _motion(number, axes, other, words, reading, modes)


def _motion(
    number: int,
    axes: dict[str, float],
    other: dict[str, float],
    words: str,
    reading: Reading,
    modes: Modes,
) -> None:
    """The motion of a line."""
    end = reading.at.copy()
    for letter, value in axes.items():
        k = reading.column(number, letter)
        step = value * reading.scale(letter)
        end[k] = step if modes.is_absolute else end[k] + step
    is_rapid = modes.motion == 0.0
    is_arc = modes.motion in (2.0, 3.0)
    if not reading.is_known(end, is_arc):
        if is_arc or not modes.is_absolute:
            found = "an arc or a step from where no axis is known to stand"
            raise reading.refusal(number, found, "a motion to X, Y and Z before it")
        reading.keep(number, f"{words} G{modes.motion:g} {_placed(axes)}".strip(), moves=True)
        reading.at = end
        return
    if modes.is_inverse and not is_rapid and "F" not in other:
        raise reading.refusal(number, "a motion without F in inverse time", "F in every line")
    reading.move(
        number,
        end,
        is_rapid,
        words,
        tuple(a for a in axes if not reading.is_linear(a)),
        _arc(number, end, other, reading, modes) if is_arc else None,
        modes.minutes if modes.is_inverse and not is_rapid else 0.0,
    )


def _arc(number: int, end: Array, other: dict[str, float], reading: Reading, modes: Modes) -> Arc:
    """Circle of a G2 or G3 line."""
    plane = [reading.column(number, letter) for letter in modes.plane]
    positive = modes.motion == 3.0
    if "R" in other:
        radius = other["R"] * reading.unit
        centre = centre_by_radius(reading, number, plane, end, radius, positive)
    else:
        named = [other.get(_CENTRES[letter], 0.0) * reading.unit for letter in modes.plane]
        centre = np.array(named) + (0.0 if modes.centres_absolute else reading.at[plane])
    return checked_arc(reading, number, plane, end, centre, positive, int(other.get("P", 1)))


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
    """Of the words of some axes; lengths have so many decimals."""
    return "".join(f" {a}%.{places if a in 'XYZ' else _DECIMALS}f" for a in axes)


def lines(
    motion: Motion, axes: tuple[str, ...], shown: list[list[float]], parts: list[float]
) -> list[str]:
    """Straight lines to some places, or the call of a cycle.

    Args:
        motion: Whose lines they are; what else stood in its block goes to the first.
        axes: That are named.
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
    """Lines of a motion in inverse time, then back to its feed; arguments as of `lines`.

    Args:
        minutes: That the whole motion takes.
    """
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
