"""Blocks of Heidenhain Klartext, as text: the closed list of words that our programs use.

Nothing here knows of machines or standards. Every function returns the text of one block without
its number; `listed` numbers them. Coordinates carry a sign and four decimals always, which is the
resolution the control takes, so that what is planned, printed and read back is the same number.
"""

from collections.abc import Mapping, Sequence

from matstd.probe_paths.language.dialect import TOOL_LENGTH, Dialect
from matstd.probe_paths.language.language import Datum, Says, Tilting, Touch
from matstd.probe_paths.language.masks import LogForm, MaskLine
from matstd.probe_paths.language.text import (
    axis_words,
    checked_line,
    checked_name,
    parameter,
    signed,
)
from matstd.twin.errors import DesignError

ENDING = ".H"
LINE_END = "\r\n"
HAS_MASKS = True
SUBPROGRAMS_FIRST = False


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
    corners = [axis_words(dict(zip("XYZ", corner, strict=True))) for corner in (low, high)]
    return [f"BLK FORM 0.1 Z {corners[0]}", f"BLK FORM 0.2 {corners[1]}"]


def line(position: Mapping[str, float], feed: float | None = None, words: str = "") -> str:
    """Straight line to a position, rapid where no feed is given.

    Args:
        position: Coordinate by axis letter, mm or degrees.
        feed: mm/min (degrees/min for rotary axes alone), whole numbers.
        words: M functions at the end of the block.
    """
    speed = "FMAX" if feed is None else f"F{feed:.0f}"
    return f"L {axis_words(position)} R0 {speed} {words}".rstrip()


def turn(position: Mapping[str, float]) -> str:
    """Rapid move of rotary axes, the shorter way."""
    return line(position, words=SHORTER_WAY)


def retract(z: float) -> str:
    """Z to a reading of the machine, where rotary axes may turn."""
    return line({"Z": z}, words="M91")


def plane(angles: Sequence[float], master: float) -> str:
    """PLANE SPATIAL: coordinates of a plane square to the tool; nothing moves.

    Args:
        angles: Spatial angles, degrees.
        master: Reading of the rotary axis nearest the foundation; its sign tells the two solutions
            apart. At zero there is one, and the table, not the coordinates, is what has turned.
    """
    words = " ".join(f"SP{a}{signed(v)}" for a, v in zip("ABC", angles, strict=True))
    is_free = signed(master) == signed(0.0)
    which = "TABLE ROT" if is_free else "SEQ+" if master > 0.0 else "SEQ-"
    return f"PLANE SPATIAL {words} STAY {which}"


def retract_max(z: float) -> str:
    """Along the tool axis to the end of the travel."""
    return RETRACT_MAX


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
    return f"FN 0: Q{q:d} = {parameter(value)}"


def difference(q: int, minuend: int, subtrahend: float) -> str:
    """FN 2: a parameter less a number."""
    return f"FN 2: Q{q:d} = +Q{minuend:d} - {signed(subtrahend)}"


def minus(q: int, other: int) -> str:
    """FN 2: a parameter less another one."""
    return f"FN 2: Q{q:d} = +Q{q:d} - +Q{other:d}"


def jump_if_less(q: int, limit: float, label: int) -> str:
    """FN 12: go to a label when a parameter is less than a number."""
    return f"FN 12: IF +Q{q:d} LT {parameter(limit)} GOTO LBL {label:d}"


def jump_if_greater(q: int, limit: float, label: int) -> str:
    """FN 11: go to a label when a parameter is greater than a number."""
    return f"FN 11: IF +Q{q:d} GT {parameter(limit)} GOTO LBL {label:d}"


def skip_if_greater(q: int, limit: float, label: int) -> str:
    """FN 11 again: go on behind a part of the program when a parameter is greater than a number."""
    return jump_if_greater(q, limit, label)


def skipped(number: int) -> str:
    """End of a part that may be skipped."""
    return label(number)


def stop_with_error(number: int) -> str:
    """FN 14: end the program with one of the control's error texts."""
    return f"FN 14: ERROR= {number:d}"


def printed(mask: str, lines: Sequence[MaskLine], target: str) -> str:
    """FN 16: write the lines of a mask file to a log."""
    return f"FN 16: F-PRINT {mask} / {target}"


def read(q: int, datum: Datum) -> str:
    """FN 18: read a system datum into a parameter."""
    return f"FN 18: SYSREAD Q{q:d} = {SYSTEM[datum]}"


WAIT = "FN 20: WAIT FOR SYNC"
"""Stops the look-ahead, so that system data are read where the machine stands."""


def probe_vector(dialect: Dialect, result: int, touch: Touch) -> list[str]:
    """Touch probe cycle 4 in its four blocks.

    Args:
        dialect: Spelling of the dialog text.
        result: First of four consecutive parameters: X, Y, Z and status.
    """
    vector = " ".join(f"I{a}{signed(v)}" for a, v in zip("XYZ", touch.direction, strict=True))
    return [
        f"TCH PROBE 4.0 {dialect.cycle_name}",
        f"TCH PROBE 4.1 Q{result:d}",
        f"TCH PROBE 4.2 {vector}",
        f"TCH PROBE 4.3 {dialect.distance_word} {signed(touch.distance)} F{touch.feed:.0f} "
        f"MB{signed(touch.back)} REFERENCE SYSTEM:0",
    ]


def label(number: int, remark: str = "") -> str:
    """Start of a subprogram."""
    return f"LBL {number:d} ;{remark}" if remark else f"LBL {number:d}"


def call(number: int) -> str:
    """Call of a subprogram."""
    return f"CALL LBL {number:d}"


LABEL_END = "LBL 0"
TCPM_OFF = "M129"
SPINDLE_OFF = "M5"
PLANE_OFF = "PLANE RESET STAY"
SHORTER_WAY = "M126"
SHORTER_WAY_OFF = "M127"
RETRACT_MAX = "M140 MB MAX"
OPERATOR_STOP = "STOP"
PROGRAM_STOP = "M30"


RESET: Sequence[str] = (SPINDLE_OFF, TCPM_OFF, PLANE_OFF, *datum_shift_off())
TILTING: Tilting | None = Tilting(plane, PLANE_OFF)
UNWIND: Sequence[str] = (SHORTER_WAY_OFF,)

_CLOCK = ("T%3d:%3d:%3d", ("HOUR", "MIN", "SEC"))
LOG = LogForm(
    clock=_CLOCK,
    date=(("DATE%5d-%3d-%3d", ("YEAR4", "MONTH", "DAY")), _CLOCK),
    counter="%8.1LF",
    is_wide=True,
    opens="M_APPEND",
    closes="M_CLOSE",
)

SYSTEM: Mapping[Datum, str] = {
    Datum.RADIUS: "ID350 NR11",
    Datum.LENGTH: "ID350 NR12",
    Datum.OFFSET_X: "ID350 NR14 IDX1",
    Datum.OFFSET_Y: "ID350 NR14 IDX2",
    Datum.TOOL: "ID20 NR1",
    Datum.A: "ID240 NR1 IDX4",
    Datum.B: "ID240 NR1 IDX5",
    Datum.C: "ID240 NR1 IDX6",
    Datum.ROTATION: "ID210 NR1",
    Datum.TOP: "ID230 NR3 IDX3",
    **{Datum(a): f"ID240 NR1 IDX{i}" for i, a in enumerate("XYZ", start=1)},
    **{Datum(f"preset {a}"): f"ID270 NR1 IDX{i}" for i, a in enumerate("XYZABC", start=1)},
}

TESTS_TURNS = False
"""`M127` fixes the way of a turn, whatever the axis."""

SAYS = Says(
    reset="M129",
    plane="PLANE RESET STAY",
    shift="CYCL DEF 7 with zeros in X, Y and Z",
    tool="TOOL CALL",
    preset="CYCL DEF 247",
    machine="M91",
    retract="L Z.. R0 FMAX M91",
    retract_max="M140 MB MAX",
    rapid="FMAX",
    sync="FN 20: WAIT FOR SYNC",
    status="FN 12 on the status of the touch",
    length=f"FN 12 and FN 11 on Q{TOOL_LENGTH}",
    unset="FN 0: Q{q} = -1",
    printed="FN 16",
    halt="STOP and FN 14",
    back="MB",
)


def listed(blocks: Sequence[str]) -> str:
    """The whole file: blocks numbered, one block may hold several lines (cycle parameters).

    Raises:
        DesignError: A line too long or not ASCII, or a block that starts the spindle.
    """
    numbered = [f"{i} {block}" for i, block in enumerate(blocks)]
    for block in numbered:
        for physical in block.split(LINE_END):
            checked_line(physical)
    return LINE_END.join(numbered) + LINE_END
