"""Heidenhain Klartext: the forms of the blocks that our programs use."""

from collections.abc import Mapping, Sequence

from matstd.probe_paths.language.dialect import TOOL_LENGTH, Dialect
from matstd.probe_paths.language.language import Datum, Language, Terms, Tilting
from matstd.probe_paths.language.masks import LogForm
from matstd.probe_paths.language.text import MAX_LINE, signed
from matstd.twin.machine import Chain

LINE_END = "\r\n"
PLANE_OFF = "PLANE RESET STAY"

_JUMP = "FN {fn}: IF +Q{q:d} {than} {limit} GOTO LBL {label:d}"
_TOUCH = """\
TCH PROBE 4.0 {cycle}
TCH PROBE 4.1 Q{result:d}
TCH PROBE 4.2 IX{x} IY{y} IZ{z}
TCH PROBE 4.3 {word} {distance} F{feed} MB{back} REFERENCE SYSTEM:0"""

FORMS = {
    "begin": "BEGIN PGM {name} MM",
    "end": "END PGM {name} MM",
    "structure": "* - {text}",
    "rapid": "L {axes} R0 FMAX",
    "fed": "L {axes} R0 F{feed:.0f}",
    "turn": "L {axes} R0 FMAX M126",
    "retract": "L {axes} R0 FMAX M91",
    "retract_max": "M140 MB MAX",
    "tool_call": "TOOL CALL {number:d} Z",
    "preset": f"CYCL DEF 247 DATUM SETTING ~{LINE_END}    Q339=+{{row:d}}    ;DATUM NUMBER",
    "read": "FN 18: SYSREAD Q{q:d} = {datum}",
    "assign": "FN 0: Q{q:d} = {value}",
    "difference": "FN 2: Q{q:d} = +{minuend} - {value}",
    "minus": "FN 2: Q{q:d} = +Q{q:d} - +Q{other:d}",
    "test": _JUMP,
    "skip": _JUMP,
    "skipped": "LBL {label:d}",
    "stop_with_error": "FN 14: ERROR= {number:d}",
    "touch": _TOUCH,
    "label": "LBL {label:d}",
    "label_remarked": "LBL {label:d} ;{remark}",
    "call": "CALL LBL {label:d}",
}

DATUM_SHIFT_OFF = (
    "CYCL DEF 7.0 DATUM SHIFT",
    *(f"CYCL DEF 7.{i} {a}+0" for i, a in zip((1, 2, 3), "XYZ", strict=True)),
)
"""Cycle 7 with zeros: only the preset acts afterwards."""


ORIENTATION = ("CYCL DEF 13.0 ORIENTATION", "CYCL DEF 13.1 ANGLE 0", "M19")
"""As a published post-processor for this control orients a probe; M19 is the builder's."""


def plane(angles: Sequence[float], master: float) -> str:
    """PLANE SPATIAL: coordinates of a plane square to the tool; nothing moves.

    Args:
        angles: Spatial angles, degrees.
        master: Reading of the rotary axis nearest the foundation; its sign selects one of two
            solutions. At zero there is one, and the table, not the coordinates, has turned.
    """
    words = " ".join(f"SP{a}{signed(v)}" for a, v in zip("ABC", angles, strict=True))
    is_free = signed(master) == signed(0.0)
    which = "TABLE ROT" if is_free else "SEQ+" if master > 0.0 else "SEQ-"
    return f"PLANE SPATIAL {words} STAY {which}"


def _reset(chain: Chain, dialect: Dialect) -> tuple[str, ...]:
    """Blocks that begin a program on a machine.

    PLANE and M128 are software options 1 and 2 of an iTNC 530 (user's manuals: 340 422 p.456, and
    "Miscellaneous functions for rotary axes"): a control of a machine without rotary axes need not
    know them, and nothing can be tilted there.

    With M144 or M114 the offset of a tilted head enters every position, and no test at zero sees
    it. M145 cancels M144 (606 42x-03 p.515). M115 cancels M114, as the end of a program does (340
    420 ISO p.205), but not a program that was interrupted.
    """
    turned = ("M129", PLANE_OFF) if chain.rotary_axes else ()
    heads = dialect.head_off if chain.tool_rotary_axes else ()
    return ("M5", *turned, *heads, *DATUM_SHIFT_OFF)


def _lines(blocks: Sequence[str]) -> list[str]:
    """Blocks numbered; one block may hold several lines (parameters of a cycle)."""
    return [p for i, block in enumerate(blocks) for p in f"{i} {block}".split(LINE_END)]


# ID210: technical manual TNC 426/430, p.7-30; Klartext manual TNC 620 (01/2022), p.560
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
    Datum.CYCLE_ROTATION: "ID210 NR2",
    Datum.MIRROR: "ID210 NR3",
    **{Datum[f"SCALE_{a}"]: f"ID210 NR4 IDX{i}" for i, a in enumerate("XYZ", start=1)},
    Datum.TOP: "ID230 NR3 IDX3",
    **{Datum(a): f"ID240 NR1 IDX{i}" for i, a in enumerate("XYZ", start=1)},
    **{Datum(f"preset {a}"): f"ID270 NR1 IDX{i}" for i, a in enumerate("XYZABC", start=1)},
}

TERMS = Terms(
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
    unset="FN 0: Q{q} = -1",
    printed="FN 16",
    halt="STOP and FN 14",
    back="MB",
)

_CLOCK = ("T%3d:%3d:%3d", ("HOUR", "MIN", "SEC"))
KLARTEXT = Language(
    ending=".H",
    line_end=LINE_END,
    longest=MAX_LINE,
    forms=FORMS,
    stock_forms=("BLK FORM 0.1 Z {corner}", "BLK FORM 0.2 {corner}"),
    sign="Q",
    tool_length=f"Q{TOOL_LENGTH}",
    system=SYSTEM,
    terms=TERMS,
    log=LogForm(
        clock=_CLOCK,
        date=(("DATE%5d-%3d-%3d", ("YEAR4", "MONTH", "DAY")), _CLOCK),
        counter="%8.1LF",
        is_wide=True,
        opens="M_APPEND",
        closes="M_CLOSE",
    ),
    printed=lambda mask, _, target: f"FN 16: F-PRINT {mask} / {target}",
    lines=_lines,
    reset=_reset,
    unwind=("M127",),
    orientation=ORIENTATION,
    wait="FN 20: WAIT FOR SYNC",
    tilting=Tilting(plane, PLANE_OFF),
    label_end="LBL 0",
    operator_stop="STOP",
    has_masks=True,
)
"""Klartext of the iTNC 530 and controls that take its programs; `M127` fixes the way of a turn."""
