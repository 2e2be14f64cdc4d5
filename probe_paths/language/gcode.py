"""G-code of LinuxCNC 2.9: the forms of the blocks that our programs use.

What the iTNC has built in stands in the program as subprograms, word for word the same in each: the
touch (fast to find, slowly to measure) and the test of a number.
Parameters keep their numbers, `#1620` for Q1620. Lines of the log stand in the program; the clock
comes from two analog inputs (0: seconds of the day, 1: the date as 20310506), which also wait until
the machine stands.
"""

import re
from collections.abc import Mapping, Sequence

from matstd.probe_paths.language.dialect import Label, Q
from matstd.probe_paths.language.language import Datum, Language, Terms
from matstd.probe_paths.language.masks import LogForm, MaskLine

ENDING = ".ngc"
LINE_END = "\n"

MODES = "G17 G21 G40 G49 G80 G90 G94"
"""Plane, millimetres, no radius and length compensation, no cycle, absolute, feed a minute."""

WAIT, DATE = "M66 E0 L0", "M66 E1 L0"
INPUT = "#5399"

LENGTH = "#5403"  # length of the tool in the spindle, as in the tool table

SYSTEM: Mapping[Datum, str] = {
    Datum.RADIUS: "[#5410 / 2]",
    Datum.LENGTH: LENGTH,
    Datum.OFFSET_X: "#5401",
    Datum.OFFSET_Y: "#5402",
    Datum.TOOL: "#5400",
    Datum.TOOL_X: "[0 + #5401]",
    Datum.TOOL_Y: "[0 + #5402]",
    Datum.TOP: "#<_ini[AXIS_Z]MAX_LIMIT>",
    Datum.ROTATION: "#[5210 + 20 * #5220]",
    **{Datum(a): f"#<_abs_{a.lower()}>" for a in "XYZABC"},
    **{
        Datum(f"preset {a}"): f"[#<_abs_{a.lower()}> - #[{n} + 20 * #5220]{tool}]"
        for n, a, tool in zip(
            range(5201, 5207), "XYZABC", ("", "", f" - {LENGTH}", "", "", ""), strict=True
        )
    },
}
"""Offsets are those of the coordinate system in use, #5220 (1 is G54), whatever selected it.

`#<_ini[section]name>` is a number of the INI file (LinuxCNC 2.9, G-code overview, "INI file
variables"); a program that asks for one that is not there ends with an error.
"""

TERMS = Terms(
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
    unset="#{q} = -1",
    printed="(LOG,..)",
    halt="M0 and (ABORT,..)",
    back="a retract",
)

TOUCH = 94  # subprogram of one touch

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

FORMS = {
    "begin": "(BEGIN PGM {name} MM)",
    "end": "(END PGM {name} MM)",
    "structure": ";* {text}",
    "rapid": "G0 {axes}",
    "fed": "G1 {axes} F{feed:.0f}",
    "turn": "G0 {axes}",
    "retract": "G53 G0 {axes}",
    "retract_max": "G53 G0 {axes} (RETRACT)",
    "tool_call": "T{number:d} M6",
    "preset": "G43 G{system:d}",
    "read": "#{q:d} = {datum}",
    "assign": "#{q:d} = {value}",
    "difference": "#{q:d} = [{minuend} - {value}]",
    "minus": "#{q:d} = [#{q:d} - #{other:d}]",
    "test": "O{number:d} IF [#{q:d} {than} {limit}]\nO{label:d} CALL\nO{number:d} ENDIF",
    "skip": "O{number:d} IF [#{q:d} LE {limit}]",
    "skipped": "O{number:d} ENDIF",
    "stop_with_error": "(ABORT,{number:d})\nENDSUB",
    "touch": (
        f"O{TOUCH} CALL [{{x}}] [{{y}}] [{{z}}] [{{distance}}] [{{feed}}] [{{back}}]"
        " [{slow}] [{step}]"
    ),
    "label": "O{label:d} SUB",
    "label_remarked": "O{label:d} SUB ({remark})",
    "call": "O{label:d} CALL",
}

REPEATED_TEST = 10_000  # added to the number of a test that stands again
_TEST = re.compile(r"O([23]\d\d) (IF|ENDIF)")
_CLOCKS = {"SECONDS": WAIT, "CALENDAR": DATE}
_FORMAT = re.compile(r"%[\d.]+LF")


def _printed(mask: str, lines: Sequence[MaskLine], target: str) -> str:
    """Append lines to a log and close it, so that it is complete if the control fails."""
    out = [f"(LOGAPPEND,{target})"]
    for one in lines:
        out += [_CLOCKS[a] for a in one.arguments if isinstance(a, str)]
        values = (INPUT if isinstance(a, str) else GCODE.parameter(a) for a in one.arguments)
        out.append(f"(LOG,{_FORMAT.sub(lambda _: next(values), one.text)})")  # noqa: B023
    return LINE_END.join([*out, "(LOGCLOSE)"])


def _lines(blocks: Sequence[str]) -> list[str]:
    """Lines of a file: subprograms carry their number at both ends, that of a touch is added.

    LinuxCNC takes every number of a test once, so a test that stands again has a number of its own.
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
            text = f"O{int(test[1]) + again * REPEATED_TEST}{text[test.end(1) :]}"
        out.append(f"O{opened} {text}" if text == "ENDSUB" else text)
    return out


GCODE = Language(
    ending=ENDING,
    line_end=LINE_END,
    longest=250,  # LinuxCNC takes 255
    forms=FORMS,
    sign="#",
    tool_length=LENGTH,
    system=SYSTEM,
    terms=TERMS,
    log=LogForm(
        clock=("T%1.6LF", ("SECONDS",)),
        date=(("DATE%1.6LF", ("CALENDAR",)), ("T%1.6LF", ("SECONDS",))),
        counter="%1.6LF",
        is_wide=False,
    ),
    printed=_printed,
    lines=_lines,
    reset=lambda *_: ("M5", MODES, "G61", "G92.1"),
    orientation=("M19 R0 Q10",),
    wait=WAIT,
    label_end="ENDSUB",
    operator_stop="M0",
    subprograms_first=True,
    tests_turns=True,
)
"""Rotary axes that INI files call wrapped take the sign of a word as a direction: C-100 ends at 100
degrees."""
