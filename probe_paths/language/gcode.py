"""The same blocks in the G-code of LinuxCNC 2.9.

Every block of `klartext` has its counterpart here, so that one plan, one interpreter and one
collision check serve both. What the iTNC has built in stands in the program as subprograms, word
for word the same in each: the touch (fast to find, slowly to measure) and the test of a number.
Parameters keep their numbers, `#1620` for Q1620. Lines of the log stand in the program; the clock
comes from two analog inputs (0: seconds of the day, 1: the date as 20310506), which also wait until
the machine stands.
"""

import re
from collections.abc import Mapping, Sequence

from matstd.probe_paths.language.dialect import TOOL_LENGTH, Dialect, Label, Q
from matstd.probe_paths.language.language import Datum, Says, Tilting, Touch
from matstd.probe_paths.language.masks import LogForm, MaskLine
from matstd.probe_paths.language.text import (
    axis_words,
    checked_line,
    checked_name,
    parameter,
    signed,
)

ENDING = ".ngc"
LINE_END = "\n"
MAX_LINE = 250
"""LinuxCNC takes lines of 255 characters."""

HAS_MASKS = False
SUBPROGRAMS_FIRST = True

MODES = "G17 G21 G40 G49 G80 G90 G94"
"""Plane, millimetres, no radius and length compensation, no cycle, absolute, feed a minute."""

TILTING: Tilting | None = None
RESET: Sequence[str] = (MODES, "G61", "G92.1")
UNWIND: Sequence[str] = ()
WAIT = "M66 E0 L0"
DATE = "M66 E1 L0"
INPUT = "#5399"
OPERATOR_STOP = "M0"
PROGRAM_STOP = "M30"
LABEL_END = "ENDSUB"

LOG = LogForm(
    clock=("T%1.6LF", ("SECONDS",)),
    date=(("DATE%1.6LF", ("CALENDAR",)), ("T%1.6LF", ("SECONDS",))),
    counter="%1.6LF",
    is_wide=False,
)

LENGTH = "#5403"
"""Length of the tool in the spindle, as in the tool table."""

SYSTEM: Mapping[Datum, str] = {
    Datum.RADIUS: "[#5410 / 2]",
    Datum.LENGTH: LENGTH,
    Datum.OFFSET_X: "#5401",
    Datum.OFFSET_Y: "#5402",
    Datum.TOOL: "#5400",
    Datum.TOOL_X: "[0 + #5401]",
    Datum.TOOL_Y: "[0 + #5402]",
    Datum.ROTATION: "#[5210 + 20 * #5220]",
    **{Datum(a): f"#<_abs_{a.lower()}>" for a in "XYZABC"},
    **{
        Datum(f"preset {a}"): f"[#<_abs_{a.lower()}> - #[{n} + 20 * #5220]{tool}]"
        for n, a, tool in zip(
            range(5201, 5207), "XYZABC", ("", "", f" - {LENGTH}", "", "", ""), strict=True
        )
    },
}
"""Offsets are those of the coordinate system in use, #5220 (1 is G54), whatever selected it."""

TESTS_TURNS = True
"""Rotary axes that INI files call wrapped take the sign of a word as a direction: C-100 ends at 100
degrees."""

SAYS = Says(
    reset=MODES,
    plane="G61",
    shift="G92.1",
    tool="T.. M6",
    preset="G43 G54",
    machine="G53",
    retract="G53 G0 Z..",
    retract_max="G53 G0 Z.. (RETRACT)",
    rapid="G0",
    sync=WAIT,
    status="O.. IF on the status of the touch",
    length=f"O.. IF .. LT and GT on {LENGTH}",
    unset="#{q} = -1",
    printed="(LOG,..)",
    halt="M0 and (ABORT,..)",
    back="a retract",
)

TOUCH = 94
"""Subprogram of one touch."""

# [#1 #2 #3] unit vector, #4 longest path, #5 fast feed, #6 retract, #7 slow feed, #8 step back
TOUCH_BODY = f"""\
O{TOUCH} SUB (TOUCH: FAST TO FIND, SLOWLY TO MEASURE)
G91
G38.3 X[#1 * #4] Y[#2 * #4] Z[#3 * #4] F#5
O194 IF [#5070 GT 0]
G1 X[0 - #1 * #8] Y[0 - #2 * #8] Z[0 - #3 * #8] F#5
G38.3 X[2 * #1 * #8] Y[2 * #2 * #8] Z[2 * #3 * #8] F#7
O194 ENDIF
G90
#{int(Q.RESULT_X)} = #5061
#{int(Q.RESULT_Y)} = #5062
#{int(Q.RESULT_Z)} = [#5063 + {LENGTH}]
#{int(Q.STATUS)} = [#5070 - 1]
O294 IF [#5070 GT 0]
G91
G1 X[0 - #1 * #6] Y[0 - #2 * #6] Z[0 - #3 * #6] F#5
G90
O294 ENDIF
O{TOUCH} ENDSUB"""

AGAIN = 10_000  # added to the number of a test that stands again
_TEST = re.compile(r"O([23]\d\d) (IF|ENDIF)")
SKIP = 1000  # added to the number of a label: those of the tests are below

_CLOCKS = {"SECONDS": WAIT, "CALENDAR": DATE}
_FORMAT = re.compile(r"%[\d.]+LF")


def begin(name: str) -> str:
    """First line of a program."""
    return f"(BEGIN PGM {checked_name(name)} MM)"


def end(name: str) -> str:
    """Last line of a program; LinuxCNC itself stops at M30 before it."""
    return f"(END PGM {checked_name(name)} MM)"


def comment(text: str) -> str:
    """A remark."""
    return f";{text}"


def structure(text: str) -> str:
    """A heading."""
    return f";* {text}"


def stock(low: Sequence[float], high: Sequence[float]) -> list[str]:
    """Nothing: LinuxCNC draws no raw part."""
    return []


def line(position: Mapping[str, float], feed: float | None = None) -> str:
    """Straight line to a position, rapid where no feed is given."""
    words = axis_words(position)
    return f"G0 {words}" if feed is None else f"G1 {words} F{feed:.0f}"


def turn(position: Mapping[str, float]) -> str:
    """Rapid move of rotary axes, the way that the numbers say."""
    return line(position)


def retract(z: float) -> str:
    """Z to a reading of the machine."""
    return f"G53 G0 Z{signed(z)}"


def retract_max(z: float) -> str:
    """The same, after a touch without contact."""
    return f"{retract(z)} (RETRACT)"


def tool_call(number: int) -> str:
    """Call the probe."""
    return f"T{number:d} M6"


def preset(row: int) -> str:
    """Length of the tool and one of the coordinate systems G54 to G59."""
    return f"G43 G{53 + row:d}"


def read(q: int, datum: Datum) -> str:
    """Read a system datum into a parameter."""
    return f"#{q:d} = {SYSTEM[datum]}"


def assign(q: int, value: float) -> str:
    """Set a parameter."""
    return f"#{q:d} = {parameter(value)}"


def difference(q: int, minuend: int, subtrahend: float) -> str:
    """A parameter less a number."""
    return f"#{q:d} = [{_parameter(minuend)} - {signed(subtrahend)}]"


def minus(q: int, other: int) -> str:
    """A parameter less another one."""
    return f"#{q:d} = [#{q:d} - #{other:d}]"


def jump_if_less(q: int, limit: float, label: int) -> str:
    """Call a subprogram that does not come back when a parameter is less than a number."""
    return _test(q, "LT", limit, label, 100 + label)


def jump_if_greater(q: int, limit: float, label: int) -> str:
    """The same when it is greater."""
    return _test(q, "GT", limit, label, 200 + label)


def skip_if_greater(q: int, limit: float, label: int) -> str:
    """Go on behind a part of the program when a parameter is greater than a number."""
    return f"O{SKIP + label} IF [#{q:d} LE {parameter(limit)}]"


def skipped(number: int) -> str:
    """End of a part that may be skipped."""
    return f"O{SKIP + number} ENDIF"


def _test(q: int, comparison: str, limit: float, label: int, number: int) -> str:
    condition = f"O{number} IF [#{q:d} {comparison} {parameter(limit)}]"
    return LINE_END.join([condition, call(label), f"O{number} ENDIF"])


def stop_with_error(number: int) -> str:
    """End the program with a message, and the subprogram that says so."""
    return f"(ABORT,{number:d}){LINE_END}{LABEL_END}"


def printed(mask: str, lines: Sequence[MaskLine], target: str) -> str:
    """Append lines to a log that is closed again: it is whole whenever the control dies."""
    out = [f"(LOGAPPEND,{target})"]
    for one in lines:
        out += [_CLOCKS[a] for a in one.arguments if isinstance(a, str)]
        values = (INPUT if isinstance(a, str) else _parameter(a) for a in one.arguments)
        out.append(f"(LOG,{_FORMAT.sub(lambda _: next(values), one.text)})")  # noqa: B023
    return LINE_END.join([*out, "(LOGCLOSE)"])


def _parameter(q: int) -> str:
    return LENGTH if q == TOOL_LENGTH else f"#{q:d}"


def probe_vector(dialect: Dialect, result: int, touch: Touch) -> list[str]:
    """Call of the touch with all that it needs; its results are always the same parameters."""
    assert result == Q.RESULT_X
    numbers = [*touch.direction, touch.distance]
    words = " ".join(f"[{signed(v)}]" for v in numbers)
    slow = f"[{dialect.slow_feed:.0f}] [{signed(dialect.step_back)}]"
    return [f"O{TOUCH} CALL {words} [{touch.feed:.0f}] [{signed(touch.back)}] {slow}"]


def label(number: int, remark: str = "") -> str:
    """Start of a subprogram."""
    return f"O{number:d} SUB ({remark})" if remark else f"O{number:d} SUB"


def call(number: int) -> str:
    """Call of a subprogram."""
    return f"O{number:d} CALL"


def listed(blocks: Sequence[str]) -> str:
    """The whole file: subprograms carry their number at both ends, that of a touch is added.

    LinuxCNC takes every number of a test once, so a test that stands again has a number of its own.

    Raises:
        DesignError: A line too long or not ASCII, or a block that starts the spindle.
    """
    out: list[str] = []
    opened = ""
    used: dict[str, int] = {}
    for text in (physical for block in blocks for physical in block.split(LINE_END)):
        match = re.match(r"O(\d+) SUB", text)
        opened = opened if match is None else match[1]
        if match is not None and int(opened) == Label.LOG:
            out += TOUCH_BODY.split(LINE_END)
        if (test := _TEST.match(text)) is not None:
            used[test[1]] = used.get(test[1], 0) + (test[2] == "IF")
            again = used[test[1]] - 1
            text = f"O{int(test[1]) + again * AGAIN}{text[test.end(1) :]}"
        out.append(f"O{opened} {text}" if text == LABEL_END else text)
    return LINE_END.join(checked_line(physical, MAX_LINE) for physical in out) + LINE_END
