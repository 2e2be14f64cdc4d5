"""The closed list of blocks; Klartext to blocks, and one clear line for everything else."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

from matstd.nc.grammar import SIGNED, klartext_blocks
from matstd.probe_paths.language.dialect import CYCLE_NAMES, DISTANCE_WORDS, Dialect
from matstd.twin.errors import BadFile

_XYZ = rf"X({SIGNED}) Y({SIGNED}) Z({SIGNED})"
_PATH = r"[A-Z0-9_:\\.-]+"

LONGEST_BLOCK = 1000  # characters of a block; the longest of our programs has 71


class Kind(Enum):
    """The blocks of our programs; each value is the pattern of the whole block in Klartext."""

    BEGIN = r"BEGIN PGM (?P<name>\S+) (?P<unit>\S+)"
    END = r"END PGM (?P<name>\S+) (?P<unit>\S+)"
    COMMENT = r";(?P<text>.*)"
    STRUCTURE = r"\* - (?P<text>.+)"
    STOCK_LOW = rf"BLK FORM 0\.1 Z {_XYZ}"
    STOCK_HIGH = rf"BLK FORM 0\.2 {_XYZ}"
    SPINDLE_OFF = r"M0?5"
    ORIENTATION = r"CYCL DEF 13\.0 ORIENTATION|CYCL DEF 13\.1 ANGLE ?\+?0(?:\.0*)?|M19"
    TCPM_ON = r"M128(?: F\d+)?"
    TCPM_OFF = r"M129"
    HEAD_OFF = r"(?P<mode>M115|M145)"
    SHORTER_WAY = r"M126"
    SHORTER_WAY_OFF = r"M127"
    PLANE_OFF = r"PLANE RESET STAY"
    PLANE = (
        rf"PLANE SPATIAL SPA(?P<a>{SIGNED}) SPB(?P<b>{SIGNED}) SPC(?P<c>{SIGNED}) STAY"
        r" (?:SEQ(?P<which>[+-])|TABLE ROT)"
    )
    SHIFT_NAME = r"CYCL DEF 7\.0 DATUM SHIFT"
    SHIFT = rf"CYCL DEF 7\.(?P<index>[123]) (?P<axis>[XYZ])(?P<value>{SIGNED})"
    PRESET = r"CYCL DEF 247 DATUM SETTING ~ Q339 ?= ?(?P<row>[+]\d+)(?: ;.*)?"
    TOOL_CALL = r"TOOL CALL (?P<tool>\d+) Z(?P<speed> S.*)?"
    LINE = (
        rf"L(?P<axes>(?: [A-Z]{SIGNED})+)(?P<radius> R0)?"
        r"(?: F(?P<feed>MAX|\d+))?(?P<functions>(?: M\d+)*)"
    )
    PROBE_NAME = r"TCH PROBE 4\.0 (?P<cycle>[A-Z0-9][A-Z0-9 -]*)"
    PROBE_RESULT = r"TCH PROBE 4\.1 Q(?P<q>\d+)"
    PROBE_VECTOR = rf"TCH PROBE 4\.2 IX(?P<x>{SIGNED}) IY(?P<y>{SIGNED}) IZ(?P<z>{SIGNED})"
    PROBE_PATH = (
        rf"TCH PROBE 4\.3 (?P<word>[A-Z][A-Z -]*?) ?(?P<distance>{SIGNED}) F(?P<feed>\d+) "
        rf"MB(?P<back>{SIGNED}) REFERENCE SYSTEM: ?(?P<system>[01])"
    )
    # a control that saves a program leaves out blanks, zeros and the last line end
    ASSIGN = rf"FN ?0: Q(?P<q>\d+) ?= ?(?P<value>{SIGNED})"
    SUBTRACT = (
        rf"FN ?2: Q(?P<q>\d+) ?= ?\+?Q(?P<from>\d+) ?- ?(?:(?P<value>{SIGNED})|\+?Q(?P<other>\d+))"
    )
    # FN 12 goes with LT, FN 11 with GT
    JUMP = (
        r"FN ?1(?:2(?=.*LT)|1(?=.*GT)): ?IF ?\+?Q(?P<q>\d+) ?(?P<than>LT|GT) ?"
        r"(?P<limit>[+-]\d+(?:\.\d*)?) GOTO LBL ?(?P<label>\d+)"
    )
    ERROR = r"FN ?14: ERROR ?= ?(?P<number>\d+)"
    PRINT = rf"FN ?16: F-PRINT (?P<mask>{_PATH}) ?/ ?(?P<target>{_PATH})"
    READ = r"FN ?18: SYSREAD Q(?P<q>\d+) ?= ?(?P<datum>ID\d+ NR\d+(?: IDX\d+)?)"
    WAIT = r"FN ?20: WAIT FOR SYNC"
    CALL = r"CALL LBL (?P<label>[1-9]\d*)"
    LABEL = r"LBL (?P<label>\d+)"
    RETRACT_MAX = r"(?:L )?M140 MB MAX"
    STOP = r"STOP"
    PROGRAM_STOP = r"M30"


_PATTERNS = {kind: re.compile(kind.value + r"\Z") for kind in Kind}
_REMARK_KINDS = (Kind.COMMENT, Kind.STRUCTURE, Kind.PRESET)

_KNOWN_OTHERS = (
    (
        r"PLANE ",
        "PLANE RESET STAY, or PLANE SPATIAL SPA<signed> SPB<signed> SPC<signed> STAY "
        "SEQ+|SEQ-|TABLE ROT: our programs turn by L blocks with readings of their own",
    ),
    (r"M0?[34]\b|M1[34]\b", "no spindle start: there is a probe in the spindle"),
    (r"TCH PROBE 4\.0", f"TCH PROBE 4.0 and one of {', '.join(CYCLE_NAMES)}"),
    (r"TCH PROBE 4\.1", "TCH PROBE 4.1 Q<first result>"),
    (r"TCH PROBE 4\.2", "TCH PROBE 4.2 IX<signed> IY<signed> IZ<signed>"),
    (
        r"TCH PROBE 4\.3",
        f"TCH PROBE 4.3 <{' | '.join(DISTANCE_WORDS)}> <signed> F<whole> MB<signed> "
        "REFERENCE SYSTEM:0",
    ),
    (r"TCH PROBE", "TCH PROBE 4 (vector probing), the only cycle of our programs"),
    (r"L\b", "L <axis><signed number> ... R0 F<whole>|FMAX, words in this order"),
    (r"FN", "FN 0, 2, 11, 12, 14, 16, 18 or 20 in the form that our programs use"),
    (r"CYCL DEF", "CYCL DEF 7 with zeros or 247 with Q339"),
    (r"TOOL CALL", "TOOL CALL <number> Z"),
    (r"LBL|CALL", "LBL <number> or CALL LBL <number>"),
    (r"BEGIN|END", "BEGIN PGM <name> MM and END PGM <name> MM"),
)
_ANYTHING = (
    "a block of the closed list: BEGIN END ; * BLK L M5 M19 M115 M126 M127 M129 M140 M145 PLANE "
    "CYCL TOOL TCH FN LBL CALL STOP M30"
)


@dataclass(frozen=True)
class Block:
    """One block of a program."""

    line: int  # number of its first line in the file, from 1
    kind: Kind
    # named parts of its pattern; None where an optional part is absent
    words: Mapping[str, str | None]
    text: str  # as it stands in the file, blanks folded

    def word(self, name: str) -> str:
        """A part that the pattern guarantees."""
        value = self.words[name]
        assert value is not None, name
        return value

    def number(self, name: str) -> float:
        """A numeric part that the pattern guarantees."""
        return float(self.word(name))


def read_klartext(data: bytes, path: str | Path, dialect: Dialect) -> list[Block]:
    """Blocks of a program file; raises BadFile.

    Block numbers either stand everywhere and count from 0, or nowhere. A line that ends in a
    tilde continues on the next one.
    """
    blocks: list[Block] = []
    is_numbered: bool | None = None
    for line, number, text in klartext_blocks(physical_lines(data, path)):
        folded = " ".join(text.split())
        shown = f"{number} {folded}".lstrip()
        if shown.endswith("~"):
            raise BadFile(path, line, repr(shown), "a further line after the tilde")
        if len(shown) > LONGEST_BLOCK:
            raise BadFile(
                path, line, f"{len(shown)} characters in one block", f"at most {LONGEST_BLOCK}"
            )
        is_numbered = bool(number) if is_numbered is None else is_numbered
        if is_numbered != bool(number):
            raise BadFile(path, line, repr(shown), "block numbers everywhere or nowhere")
        if number and (number.lstrip("0") or "0") != str(len(blocks)):
            raise BadFile(path, line, f"block number {number}", str(len(blocks)))
        blocks.append(_parse(folded, line, path, dialect))
    return blocks


def physical_lines(data: bytes, path: str | Path) -> list[str]:
    """Lines of a program file, blanks at their ends dropped; raises BadFile."""
    if not data:
        raise BadFile(path, "file", "nothing", "a program that begins with BEGIN PGM")
    try:
        text = data.decode("ascii")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise BadFile(path, line, f"byte 0x{data[error.start]:02x}", "ASCII") from None
    if text.count("\r\n") not in (0, text.count("\n")) or text.replace("\r\n", "").count("\r"):
        raise BadFile(path, "file", "mixed line ends", "CRLF at the end of every line")
    lines = [line.rstrip() for line in text.splitlines()]
    if not text.endswith("\n") and "END PGM" not in lines[-1]:
        expected = "END PGM, or a whole line: the file is cut off"
        raise BadFile(path, len(lines), repr(lines[-1]), expected)
    return lines


def _parse(text: str, line: int, path: str | Path, dialect: Dialect) -> Block:
    """The block of one line, remarks at its end dropped."""
    for kind in _REMARK_KINDS:
        match = _PATTERNS[kind].match(text)
        if match is not None:
            return Block(line, kind, match.groupdict(), text)
    bare = text.split(";")[0].rstrip()
    for kind, pattern in _PATTERNS.items():
        match = pattern.match(bare)
        if match is not None and _is_known(match.groupdict(), dialect):
            return Block(line, kind, match.groupdict(), text)
    for beginning, expected in _KNOWN_OTHERS:
        if re.match(beginning, bare):
            raise BadFile(path, line, repr(text), expected)
    raise BadFile(path, line, repr(text), _ANYTHING)


def _is_known(words: Mapping[str, str | None], dialect: Dialect) -> bool:
    """Whether the dialog text of cycle 4 is the usual one or that of the dialect."""
    cycles, ways = (*CYCLE_NAMES, dialect.cycle_name), (*DISTANCE_WORDS, dialect.distance_word)
    return words.get("cycle") in (None, *cycles) and words.get("word") in (None, *ways)
