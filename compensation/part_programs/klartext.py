"""Heidenhain Klartext of part programs: a reader, and the blocks of motions."""

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np

from matstd.compensation.part_programs import klartext_cycles
from matstd.compensation.part_programs.klartext_motions import (
    Modes,
    Words,
    motion,
    needed_hole,
    pole,
    take_feed,
    take_functions,
)
from matstd.compensation.part_programs.language import Reading
from matstd.compensation.part_programs.motion import Corner, Motion
from matstd.nc.grammar import NUMBER, klartext_blocks, run_order
from matstd.twin.frames import Array

ENDING = ".H"
HAS_INVERSE_TIME = False
OPENS = re.compile("BEGIN", re.IGNORECASE)
_DECIMALS = 4
"""Steps in which the control takes coordinates: 0.1 µm, 0.0001 degrees."""

_KEPT = re.compile(
    r"(?:BEGIN|END) PGM \S+ (?:MM|INCH)|BLK FORM .*|TOOL DEF .*|STOP.*|\* - .*|"
    r"PLANE RESET STAY|CYCL DEF 247.*|CYCL DEF (?:32|13|9)\.\d.*|CYCL DEF 7\.0\b.*"
)
_TOOL = re.compile(r'TOOL CALL(?: (?:(\d+)(?:\.\d+)?|"([^"]*)"))?(?: Z)?((?: .*)?)')
_SHIFT = re.compile(rf"CYCL DEF 7\.[1-9] ([XYZ])({NUMBER})")
_TCP_ON = re.compile(r"FUNCTION TCPM F (?:TCP|CONT) AXIS POS PATHCTRL AXIS(?: REFPNT TIP-TIP)?")
_TCP_OFF = "FUNCTION RESET TCPM"
_CORNER = re.compile(r"(RND|CHF) (?:R|L)?(\d+\.?\d*)(?: F\d+)?")
_INCH = re.compile(r"BEGIN PGM \S+ INCH")
_ONE_WORD = re.compile(r"\b(F) (MAX|AUTO)\b|\b(LA|MB|DL|DR|S|F|R) (?=[+-]?\d)|\b(MB) (MAX)\b")
"""Words that may be written in two."""

_EXPECTED = (
    (r"(?!TCH)(?:FN|.*\bQ|.*=)", "numbers, and parameters Q that the program sets itself"),
    (r"TCH", "no touches: a compensated program holds for one datum"),
    (r"LBL|CALL", "LBL and CALL LBL, with REP or without"),
    (r"CYCL", "cycles 7, 9, 13, 32, 247 and holes: others are resolved into motions before"),
    (r"CT|APPR|DEP", "L, LP, CC, C, CP, CR, RND, CHF: others are resolved into them before"),
    (r"PLANE", "PLANE RESET STAY, or rotary axes in L blocks"),
    (r"FUNCTION", "FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS, FUNCTION RESET TCPM"),
    (r"BEGIN|END", "BEGIN PGM <name> MM and END PGM <name> MM"),
)


def read(text: str, reading: Reading) -> None:
    """Read a whole program into the items of `reading`.

    Raises:
        BadFile: A block that is not understood, with its line.
    """
    modes = Modes()
    for block in run_order(list(klartext_blocks(text.splitlines())), reading.path):
        _block(block.line, block.text, reading, modes)


def _block(number: int, block: str, reading: Reading, modes: Modes) -> None:
    """One block without its number."""
    bare = " ".join(block.partition(";")[0].split()).upper()
    bare = _ONE_WORD.sub(lambda m: "".join(g for g in m.groups() if g), bare)
    first = bare.partition(" ")[0]
    if not bare or _KEPT.fullmatch(bare) or bare.startswith("CYCL DEF 247"):
        _check_preset(number, bare, reading, modes)
        reading.unit = 25.4 if _INCH.fullmatch(bare) else reading.unit
        reading.keep(number, block)
    elif shift := _SHIFT.fullmatch(bare):
        k = reading.column(number, shift[1])
        reading.offset = reading.offset.copy()
        reading.offset[k] = float(shift[2]) * reading.unit
        reading.keep(number, block)
    elif tool := _TOOL.fullmatch(bare):
        _tool(number, block, tool, reading, modes)
    elif first == "CC":
        pole(number, bare, reading, modes)
    elif first in ("L", "C", "CR", "LP", "CP"):
        motion(number, block, bare, reading, modes)
    elif match := _CORNER.fullmatch(bare):
        reading.items.append(Corner(number, float(match[2]) * reading.unit, match[1] == "RND"))
    elif bare.startswith("CYCL"):
        _cycle(number, block, bare, reading, modes)
    elif _TCP_ON.fullmatch(bare) or bare == _TCP_OFF:
        reading.switch(bare != _TCP_OFF, reading.length)
        reading.keep(number, block)
    elif re.fullmatch(r"(?:M\d+ ?(?:F\w+|LA\d+)? ?)+", bare):
        motion(number, block, f"L {re.sub(r'F[0-9]+', '', bare)}", reading, modes)
    else:
        listed = "a block of L, LP, CC, C, CP, CR, RND, CHF, M, TOOL CALL, CYCL, STOP, BLK FORM"
        expected = next((e for begin, e in _EXPECTED if re.match(begin, bare)), listed)
        raise reading.refusal(number, repr(bare), expected)


def _cycle(number: int, block: str, bare: str, reading: Reading, modes: Modes) -> None:
    """CYCL DEF of a hole, and its calls but for M99 and M89."""
    if bare.startswith("CYCL DEF"):
        modes.hole, modes.is_calling = klartext_cycles.defined(number, block, reading), False
        return
    hole = needed_hole(number, reading, modes)
    match = re.fullmatch(r"CYCL CALL(?: (POS)(.*))?((?: M\d+)*)", bare)
    if match is None:
        raise reading.refusal(number, repr(bare), "CYCL CALL, CYCL CALL POS X Y Z, or M99")
    modes.is_calling = False
    if match[1] is None:
        take_functions(number, re.findall(r"M(\d+)", match[3]), reading)
        klartext_cycles.call(number, hole, f"FMAX M99{match[3]}", (), reading)
        return
    said = Words(number, f"L{match[2]}", reading, modes)
    z = reading.column(number, "Z")
    if not {"X", "Y", "Z"} <= set(said.named):
        raise reading.refusal(number, repr(bare), "X, Y and Z in CYCL CALL POS")
    take_functions(number, said.functions, reading)
    raised = float(said.end[z] - reading.offset[z])
    over = said.end[z] + hole.surface + hole.near
    for place in klartext_cycles.way(reading.at, said.end, z, over):
        reading.move(number, place, True)
    klartext_cycles.call(number, hole, " ".join([*said.kept, "FMAX M99"]), (), reading, raised)


def _check_preset(number: int, bare: str, reading: Reading, modes: Modes) -> None:
    """A compensated program holds for one datum."""
    if bare.startswith("CYCL DEF 247"):
        if modes.preset not in (None, bare):
            raise reading.refusal(number, repr(bare), "one preset for the whole program")
        modes.preset = bare


def _tool(number: int, block: str, match: re.Match[str], reading: Reading, modes: Modes) -> None:
    """TOOL CALL: of a number, a name, or of another speed alone."""
    if feed := re.search(r"\bF(\d+(?:\.\d+)?)", match[3]):
        modes.tool_feed = float(feed[1])
        take_feed(modes.tool_feed, reading)
    reading.keep(number, block)
    tool = int(match[1]) if match[1] else match[2]
    if re.match(r" [XYUVW]\b", match[3]):
        raise reading.refusal(number, repr(match[0]), "a tool along Z")
    if tool is None:
        return
    if reading.tcpm or reading.side:
        expected = "M129" if reading.tcpm else "R0"
        raise reading.refusal(number, repr(match[0]), f"{expected} before a TOOL CALL")
    added, more = (re.search(rf"\b{word}({NUMBER})", match[3]) for word in ("DL", "DR"))
    reading.tool, reading.more_radius = tool, float(more[1]) * reading.unit if more else 0.0
    length = reading.lengths.get(tool, reading.frame.datum.length)
    reading.switch(False, length + (float(added[1]) * reading.unit if added else 0.0))


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
    """Of the words of some axes; lengths have so many decimals."""
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
