"""Blocks of Heidenhain Klartext, as text: the closed list of words that our programs use.

Nothing here knows of machines or standards. Every function returns the text of one block without
its number; `Listing` numbers them. Coordinates carry a sign and four decimals always, which is the
resolution the control takes, so that what is planned, printed and read back is the same number.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from twin.errors import DesignError

MAX_LINE = 72
"""Longest physical line that is emitted, characters; the control's own limit is not documented."""

MAX_NAME = 16
"""Longest program name that the oldest software displays whole."""

MAX_VALUE = 99999.9999
"""Largest coordinate that the control takes, mm or degrees."""

LINE_END = "\r\n"

CYCLE_NAMES = ("MEASURING IN 3D", "MEASURING IN 3-D")
DISTANCE_WORDS = ("SET UP", "ABST", "DIST")
"""Spellings of cycle 4 on different software; the first of each is the default."""

_NAME = re.compile(r"[A-Z][A-Z0-9_]*\Z")
_SPINDLE = re.compile(r"(?<![A-Z0-9])(M0?[34]|M1[34])(?!\d)|TOOL CALL.*\bS\s?\d")


def checked_name(name: str) -> str:
    """Program name that every software generation takes; raises DesignError."""
    if not _NAME.match(name) or len(name) > MAX_NAME:
        raise DesignError(
            f"program name '{name}': expected a letter, then letters A-Z, digits or _, "
            f"at most {MAX_NAME} characters"
        )
    return name


def signed(value: float, decimals: int = 4) -> str:
    """A number as the control wants it: sign, point, fixed decimals; never a negative zero.

    Raises:
        DesignError: A value beyond the input range of the control, or none at all.
    """
    if not abs(value) <= MAX_VALUE:
        raise DesignError(f"coordinate {value} is beyond the control's range of {MAX_VALUE}")
    rounded = round(value, decimals) + 0.0
    return f"{rounded:+.{decimals}f}"


def begin(name: str) -> str:
    """First block of a program in millimetres."""
    return f"BEGIN PGM {checked_name(name)} MM"


def end(name: str) -> str:
    """Last block of a program in millimetres."""
    return f"END PGM {checked_name(name)} MM"


def comment(text: str) -> str:
    """Comment block; a tilde at its end would be taken for a continuation."""
    if text.rstrip().endswith("~"):
        raise DesignError(f"comment '{text}' ends in ~, which continues a block")
    return f";{text}"


def structure(text: str) -> str:
    """Structure block, shown as a heading in the control's program view."""
    return f"* - {text}"


def stock(low: Sequence[float], high: Sequence[float]) -> list[str]:
    """The two blocks of the raw part: simulation graphics only."""
    return [f"BLK FORM 0.1 Z {_axes('XYZ', low)}", f"BLK FORM 0.2 {_axes('XYZ', high)}"]


def _axes(letters: str, values: Sequence[float]) -> str:
    return " ".join(f"{a}{signed(v)}" for a, v in zip(letters, values, strict=True))


def line(position: Mapping[str, float], feed: float | None = None, words: str = "") -> str:
    """Straight line to a position, rapid where no feed is given.

    Args:
        position: Coordinate by axis letter, mm or degrees.
        feed: mm/min (degrees/min for rotary axes alone), whole numbers.
        words: M functions at the end of the block.
    """
    axes = " ".join(f"{axis}{signed(value)}" for axis, value in position.items())
    speed = "FMAX" if feed is None else f"F{feed:.0f}"
    return f"L {axes} R0 {speed} {words}".rstrip()


def datum_shift_off() -> list[str]:
    """Cycle 7 with zeros: only the preset acts afterwards."""
    return [
        "CYCL DEF 7.0 DATUM SHIFT",
        "CYCL DEF 7.1 X+0",
        "CYCL DEF 7.2 Y+0",
        "CYCL DEF 7.3 Z+0",
    ]


def preset(row: int) -> str:
    """Cycle 247: activate a row of the preset table (one block on two lines)."""
    return f"CYCL DEF 247 DATUM SETTING ~{LINE_END}    Q339=+{row:d}    ;DATUM NUMBER"


def tool_call(number: int) -> str:
    """Call the probe; never with a spindle speed."""
    return f"TOOL CALL {number:d} Z"


def assign(q: int, value: float) -> str:
    """FN 0 with a number; whole numbers are written without decimals."""
    text = f"{value:+.0f}" if value == int(value) else signed(value)
    return f"FN 0: Q{q:d} = {text}"


def difference(q: int, minuend: int, subtrahend: float) -> str:
    """FN 2: a parameter less a number."""
    return f"FN 2: Q{q:d} = +Q{minuend:d} - {signed(subtrahend)}"


def jump_if_less(q: int, limit: int, label: int) -> str:
    """FN 12: go to a label when a parameter is less than a whole number."""
    return f"FN 12: IF +Q{q:d} LT {limit:+d} GOTO LBL {label:d}"


def jump_if_greater(q: int, limit: int, label: int) -> str:
    """FN 11: go to a label when a parameter is greater than a whole number."""
    return f"FN 11: IF +Q{q:d} GT {limit:+d} GOTO LBL {label:d}"


def stop_with_error(number: int) -> str:
    """FN 14: end the program with one of the control's error texts."""
    return f"FN 14: ERROR= {number:d}"


def print_masked(mask: str, target: str) -> str:
    """FN 16: write the lines of a mask file to a log."""
    return f"FN 16: F-PRINT {mask} / {target}"


def system_read(q: int, group: int, number: int, index: int | None = None) -> str:
    """FN 18: read a system datum into a parameter."""
    tail = "" if index is None else f" IDX{index:d}"
    return f"FN 18: SYSREAD Q{q:d} = ID{group:d} NR{number:d}{tail}"


WAIT = "FN 20: WAIT FOR SYNC"
"""Stops the look-ahead, so that system data are read where the machine stands."""


@dataclass(frozen=True)
class ProbeWords:
    """Dialog text of cycle 4, which differs between software versions.

    Attributes:
        cycle_name: After `4.0`; the number identifies the cycle.
        distance_word: Before the longest path in `4.3`.
    """

    cycle_name: str = CYCLE_NAMES[0]
    distance_word: str = DISTANCE_WORDS[0]

    def __post_init__(self) -> None:
        for word, known in (
            (self.cycle_name, CYCLE_NAMES),
            (self.distance_word, DISTANCE_WORDS),
        ):
            if word not in known:
                raise DesignError(f"word '{word}' of cycle 4: expected one of {', '.join(known)}")


def probe_vector(
    words: ProbeWords,
    result: int,
    direction: Sequence[float],
    distance: float,
    feed: float,
    back: float,
) -> list[str]:
    """Touch probe cycle 4 in its four blocks.

    Args:
        words: Spelling of the dialog text.
        result: First of four consecutive parameters: X, Y, Z and status.
        direction: Probing vector in the workpiece frame.
        distance: Longest path from the start, mm.
        feed: Probing feed, mm/min.
        back: Retract after the contact, mm.
    """
    vector = " ".join(f"I{a}{signed(v)}" for a, v in zip("XYZ", direction, strict=True))
    return [
        f"TCH PROBE 4.0 {words.cycle_name}",
        f"TCH PROBE 4.1 Q{result:d}",
        f"TCH PROBE 4.2 {vector}",
        f"TCH PROBE 4.3 {words.distance_word} {signed(distance)} F{feed:.0f} "
        f"MB{signed(back)} REFERENCE SYSTEM:0",
    ]


def label(number: int, remark: str = "") -> str:
    """Start of a subprogram."""
    return f"LBL {number:d} ;{remark}" if remark else f"LBL {number:d}"


def call(number: int) -> str:
    """Call of a subprogram."""
    return f"CALL LBL {number:d}"


LABEL_END = "LBL 0"
TCPM_OFF = "M129"
PLANE_OFF = "PLANE RESET STAY"
SHORTER_WAY = "M126"
SHORTER_WAY_OFF = "M127"
RETRACT_MAX = "M140 MB MAX"
OPERATOR_STOP = "STOP"
PROGRAM_STOP = "M30"


class Listing:
    """A program in the making: numbers its blocks and refuses what must never be emitted."""

    def __init__(self) -> None:
        self._lines: list[str] = []
        self._count = 0

    def add(self, *blocks: str) -> None:
        """Append blocks; one block may hold several physical lines (cycle parameters).

        Raises:
            DesignError: A line too long or not ASCII, or a block that starts the spindle.
        """
        for block in blocks:
            text = f"{self._count:d} {block}"
            for physical in text.split(LINE_END):
                _check_line(physical)
            self._lines.append(text)
            self._count += 1

    @property
    def text(self) -> str:
        """The whole file, CRLF line ends."""
        return LINE_END.join(self._lines) + LINE_END


def _check_line(physical: str) -> None:
    if not physical.isascii():
        raise DesignError(f"block '{physical}' has characters outside ASCII")
    if len(physical) > MAX_LINE:
        raise DesignError(
            f"block '{physical}' has {len(physical)} characters, at most {MAX_LINE} are emitted"
        )
    if _SPINDLE.search(physical.split(";")[0]):
        raise DesignError(f"block '{physical}' would start the spindle with a probe in it")
