"""Heidenhain Klartext of part programs: a reader, and the blocks of motions."""

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from compensation.programs.klartext_flow import Block, in_order
from compensation.programs.language import NUMBER, Reading, centre_by_radius, checked_arc
from compensation.programs.motion import Arc, Motion
from twin.frames import Array

ENDING = ".H"
COMMENT = "; {}"
_DECIMALS = 4
"""Steps in which the control takes coordinates: 0.1 µm, 0.0001 degrees."""

_KEPT = re.compile(
    r"BEGIN PGM \S+ MM|END PGM \S+ MM|BLK FORM .*|TOOL DEF .*|STOP.*|\* - .*|"
    r"PLANE RESET STAY|CYCL DEF 247.*|CYCL DEF (?:32|9)\.\d.*|CYCL DEF 7\.0 .*"
)
_KEPT_M = {0, 1, 2, 3, 4, 5, 6, 8, 9, 13, 14, 30, 126, 127}
_TOOL = re.compile(r"TOOL CALL (\d+)(?: Z)?(.*)")
_SHIFT = re.compile(rf"CYCL DEF 7\.[1-9] ([XYZ])({NUMBER})")
_SIDES = {"R0": 0.0, "RL": 1.0, "RR": -1.0}
_AXIS = re.compile(rf"(I?)([XYZABCUVW])({NUMBER})\Z")
_EXPECTED = (
    (r"FN|.*\bQ|.*=", "numbers, and parameters Q that the program sets itself"),
    (r"LBL|CALL", "LBL and CALL LBL, with REP or without"),
    (r"CYCL", "cycles 7, 9, 32 and 247: others are resolved into motions before"),
    (r"LP|CP|CT|APPR|DEP|CHF|RND", "L, CC, C and CR: others are resolved into them before"),
    (r"PLANE", "PLANE RESET STAY, or rotary axes in L blocks"),
    (r"BEGIN|END", "BEGIN PGM <name> MM and END PGM <name> MM"),
)


class _Modes:
    """What stays in force from block to block."""

    pole: dict[str, float]
    preset: str | None = None

    def __init__(self) -> None:
        self.pole = {}


def read(text: str, reading: Reading) -> None:
    """Read a whole program into the items of `reading`.

    Raises:
        BadFile: A block that is not understood, with its line.
    """
    modes = _Modes()
    for number, block in in_order(list(_blocks(text)), reading):
        _block(number, block, reading, modes)


def _blocks(text: str) -> Iterator[Block]:
    """Blocks of a file; one that goes on in the next line ends in ~."""
    lines = text.replace("~\r\n", "~\n").splitlines()
    i = 0
    while i < len(lines):
        number, raw = i + 1, lines[i]
        while raw.rstrip().endswith("~") and i + 1 < len(lines):
            i += 1
            raw = f"{raw}\n{lines[i]}"
        i += 1
        yield Block(number, re.sub(r"\A\s*\d+\s+", "", raw).strip())


def _block(number: int, block: str, reading: Reading, modes: _Modes) -> None:
    """One block without its number."""
    bare = " ".join(block.partition(";")[0].split()).upper()
    first = bare.partition(" ")[0]
    if not bare or _KEPT.fullmatch(bare) or bare.startswith("CYCL DEF 247"):
        _check_preset(number, bare, reading, modes)
        reading.keep(number, block)
    elif _SHIFT.fullmatch(bare):
        letter, value = _SHIFT.fullmatch(bare).groups()  # type: ignore[union-attr]
        offset = reading.offset.copy()
        offset[reading.column(number, letter)] = float(value)
        reading.offset = offset
        reading.keep(number, block)
    elif _TOOL.fullmatch(bare):
        _tool(number, block, bare, reading)
    elif first == "CC":
        _pole(number, bare, reading, modes)
    elif first in ("L", "C", "CR"):
        _motion(number, bare, reading, modes)
    elif re.fullmatch(r"(?:M\d+ ?(?:F\d+)? ?)+", bare):
        if _functions(number, re.findall(r"M(\d+)", bare), reading):
            raise reading.refusal(number, "M91 alone", "M91 in an L block")
        reading.keep(number, block)
    else:
        listed = "a block of L, CC, C, CR, M, TOOL CALL, CYCL DEF 7, 9, 32, 247, STOP, BLK FORM"
        expected = next((e for begin, e in _EXPECTED if re.match(begin, bare)), listed)
        raise reading.refusal(number, repr(bare), expected)


def _check_preset(number: int, bare: str, reading: Reading, modes: _Modes) -> None:
    """A compensated program holds for one datum."""
    if bare.startswith("CYCL DEF 247"):
        if modes.preset not in (None, bare):
            raise reading.refusal(number, repr(bare), "one preset for the whole program")
        modes.preset = bare


def _tool(number: int, block: str, bare: str, reading: Reading) -> None:
    match = _TOOL.fullmatch(bare)
    assert match is not None
    if reading.tcpm:
        raise reading.refusal(number, repr(bare), "M129 before a TOOL CALL")
    added = re.search(rf"\bDL({NUMBER})", match[2])
    if reading.side:
        raise reading.refusal(number, repr(bare), "R0 before a TOOL CALL")
    more = re.search(rf"\bDR({NUMBER})", match[2])
    reading.tool, reading.more_radius = int(match[1]), float(more[1]) if more else 0.0
    length = reading.lengths.get(int(match[1]), reading.frame.datum.length)
    reading.switch(False, length + (float(added[1]) if added else 0.0))
    feed = re.search(r"\bF(\d+(?:\.\d+)?)", match[2])
    reading.feed = float(feed[1]) if feed else reading.feed
    reading.keep(number, block)


def _functions(number: int, words: list[str], reading: Reading) -> bool:
    """Take M functions; whether coordinates are those of the machine."""
    for word in words:
        if int(word) in (128, 129):
            reading.switch(word == "128", reading.length)
        elif int(word) != 91 and int(word) not in _KEPT_M:
            expected = "M0 to M9, M13, M14, M30, M91, M126 to M129"
            raise reading.refusal(number, f"M{word}", expected)
    return "91" in words


def _pole(number: int, bare: str, reading: Reading, modes: _Modes) -> None:
    """Centre of the circles that follow; it is resolved, so the block goes."""
    for word in bare.split()[1:]:
        match = _AXIS.match(word)
        if match is None:
            raise reading.refusal(number, repr(bare), "CC with two of X, Y and Z")
        step, letter, value = match.groups()
        k = reading.column(number, letter)
        base = reading.at[k] if step else reading.offset[k]
        modes.pole[letter] = base + float(value)


class _Words:
    """What the words of an L, C or CR block say."""

    def __init__(self, number: int, bare: str, reading: Reading) -> None:
        self.kind, *self.words = bare.split()
        self.number, self.bare, self.reading = number, bare, reading
        self.end = reading.at.copy()
        self.named: list[str] = []
        self.functions: list[str] = []
        self.kept: list[str] = []
        self.sense = self.radius = ""
        self.is_rapid = False
        for word in self.words:
            if not (self._axis(word) or self._path(word) or self._other(word)):
                raise reading.refusal(number, repr(word), f"words of a block {self.kind}")

    def _axis(self, word: str) -> bool:
        match = _AXIS.match(word)
        if match is None:
            return False
        step, letter, value = match.groups()
        k = self.reading.column(self.number, letter)
        base = self.end[k] if step else self.reading.offset[k]
        self.end[k] = base + float(value) * self.reading.scale(letter)
        self.named.append(letter)
        return True

    def _path(self, word: str) -> bool:
        """Radius compensation, and sense and radius of a circle."""
        if word in _SIDES:
            self.reading.side = _SIDES[word]
            self.kept.append("R0")
        elif self.kind in ("C", "CR") and word in ("DR+", "DR-"):
            self.sense = word[2]
        elif self.kind == "CR" and re.fullmatch(rf"R{NUMBER}", word):
            self.radius = word[1:]
        else:
            return False
        return True

    def _other(self, word: str) -> bool:
        """Feed and M functions."""
        if word == "FMAX":
            self.is_rapid = True
        elif re.fullmatch(r"F\d+(?:\.\d+)?", word):
            self.reading.feed = float(word[1:])
        elif re.fullmatch(r"M\d+", word):
            self.functions.append(word[1:])
            self.kept.append(word)
        else:
            return False
        return True


def _motion(number: int, bare: str, reading: Reading, modes: _Modes) -> None:
    """L, C or CR."""
    said = _Words(number, bare, reading)
    if reading.tcpm and "91" in said.functions:
        raise reading.refusal(number, repr(bare), "M129 before M91")
    if {"128", "129"} & set(said.functions) and said.named:
        raise reading.refusal(number, repr(bare), "M128 and M129 in a block without axes")
    is_machine = _functions(number, said.functions, reading)
    is_arc = said.kind != "L"
    if is_machine or not reading.is_known(said.end, is_arc):
        if is_arc:
            raise reading.refusal(number, repr(bare), "a motion to X, Y and Z before it")
        reading.keep(number, bare, moves=True)
        columns = [reading.column(number, letter) for letter in said.named]
        if is_machine:
            said.end[columns] = np.nan
        reading.at = said.end
        return
    reading.move(
        Motion(
            line=number,
            start=np.where(np.isnan(reading.at), said.end, reading.at),
            end=said.end,
            is_rapid=said.is_rapid,
            feed=reading.needed_feed(number, said.is_rapid),
            tcpm=reading.tcpm,
            length=reading.length,
            offset=reading.offset,
            unit=1.0,
            words=" ".join(said.kept),
            turned=tuple(a for a in said.named if not reading.is_linear(a)),
            arc=_arc(said, reading, modes) if is_arc else None,
            beside=reading.beside(number),
        )
    )


def _arc(said: _Words, reading: Reading, modes: _Modes) -> Arc:
    """Circle about the pole (C), or of a radius (CR), in the plane of the pole, else X and Y."""
    number, bare = said.number, said.bare
    pole = next((p for p in ("XY", "ZX", "YZ") if set(p) == set(modes.pole)), "")
    plane = pole if said.kind == "C" else "XY"
    if not said.sense:
        raise reading.refusal(number, repr(bare), "DR+ or DR-")
    if not plane:
        raise reading.refusal(number, repr(bare), "CC with two of X, Y and Z before it")
    columns = [reading.column(number, letter) for letter in plane]
    positive = said.sense == "+"
    if said.kind == "C":
        centre = np.array([modes.pole[letter] for letter in plane])
    else:
        radius = float(said.radius or 0.0)
        centre = centre_by_radius(reading, number, columns, said.end, radius, positive)
    return checked_arc(reading, number, columns, said.end, centre, positive)


def begin() -> list[str]:
    """Nothing has to stand before a compensated program."""
    return []


def decimals(is_length: bool, unit: Array) -> Array:
    """Decimals of a coordinate, (N,)."""
    return np.full(np.shape(unit), _DECIMALS)


def lines(motion: Motion, axes: tuple[str, ...], shown: list[list[float]]) -> list[str]:
    """Straight lines to some places; arguments as of `gcode.lines`."""
    words = motion.words.split()
    feed = "FMAX" if motion.is_rapid else f"F{motion.feed:g}"
    form = "L" + "".join(f" {a}%+.{_DECIMALS}f" for a in axes)
    out = [f"{form % tuple(row)} {feed}" for row in shown]
    first = " ".join(["R0"] * ("R0" in words) + [feed, *(w for w in words if w != "R0")])
    out[0] = f"{form % tuple(shown[0])} {first}"
    return out


def listed(blocks: list[str], path: Path) -> str:
    """The whole file, blocks numbered and the program named after it."""
    named = [re.sub(r"\A(BEGIN|END) PGM \S+", rf"\1 PGM {path.stem.upper()}", b) for b in blocks]
    return "\r\n".join(f"{k} {block}" for k, block in enumerate(named)) + "\r\n"
