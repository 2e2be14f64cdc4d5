"""A reader of Klartext part programs: blocks into modes, motions and holes."""

import re

import numpy as np

from matstd.compensation.part_programs.klartext_words import AXIS, Hole, Modes, Words, defined, way
from matstd.compensation.part_programs.language import Reading, centre_by_radius, checked_arc
from matstd.compensation.part_programs.motion import Arc, ArcFeed, Corner, Cycle
from matstd.nc.grammar import NUMBER, Block, klartext_blocks, run_order
from matstd.twin.errors import BadFile
from matstd.twin.units import DEG

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

_KEPT_M = {*range(10), 13, 14, 30, 90, 107, 108, 116, 117, 120, 141}
_ARC_FEEDS = {feed.value for feed in ArcFeed}
_OWN_M = {89, 91, 99, 140}
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
    """Read a whole program into the items of `reading`; raises BadFile."""
    reader = _Reader(reading)
    for block in run_order(list(klartext_blocks(text.splitlines())), reading.path):
        reader.take(block)


class _Reader:
    """A program while it is read."""

    def __init__(self, reading: Reading) -> None:
        self.reading, self.modes = reading, Modes(reading)
        self.preset: str | None = None
        self.hole: Hole | None = None
        self.is_calling = False  # every motion calls it (M89)
        self.is_shorter_way = False  # rotary axes take it, whatever their words (M126)
        self.line, self.bare = 0, ""

    def _refusal(self, expected: str, found: str = "") -> BadFile:
        """What is not understood in this block."""
        return self.reading.refusal(self.line, found or repr(self.bare), expected)

    def take(self, block: Block) -> None:
        """One block; raises BadFile."""
        line, text, reading = block.line, block.text, self.reading
        bare = " ".join(text.partition(";")[0].split()).upper()
        bare = _ONE_WORD.sub(lambda m: "".join(g for g in m.groups() if g), bare)
        self.line, self.bare = line, bare
        # the order matters: CYCL DEF 247 and 7 are cycles that are handled before all others
        first = bare.partition(" ")[0]
        if not bare or _KEPT.fullmatch(bare) or bare.startswith("CYCL DEF 247"):
            self._check_preset()
            reading.unit = 25.4 if _INCH.fullmatch(bare) else reading.unit
            reading.keep(line, text)
        elif shift := _SHIFT.fullmatch(bare):
            k = reading.column(line, shift[1])
            reading.offset = reading.offset.copy()
            reading.offset[k] = float(shift[2]) * reading.unit
            reading.keep(line, text)
        elif tool := _TOOL.fullmatch(bare):
            self._tool(text, tool)
        elif first == "CC":
            self._pole()
        elif first in ("L", "C", "CR", "LP", "CP"):
            self._path(text, bare)
        elif match := _CORNER.fullmatch(bare):
            reading.items.append(Corner(line, float(match[2]) * reading.unit, match[1] == "RND"))
        elif bare.startswith("CYCL"):
            self._cycle(text)
        elif _TCP_ON.fullmatch(bare) or bare == _TCP_OFF:
            reading.switch(bare != _TCP_OFF, reading.length)
            reading.keep(line, text)
        elif re.fullmatch(r"(?:M\d+ ?(?:F\w+|LA\d+)? ?)+", bare):
            self._path(text, f"L {re.sub(r'F[0-9]+', '', bare)}")
        else:
            listed = "a block of L, LP, CC, C, CP, CR, RND, CHF, M, TOOL CALL, CYCL, STOP, BLK FORM"
            raise self._refusal(
                next((e for begin, e in _EXPECTED if re.match(begin, bare)), listed)
            )

    # --- modes ------------------------------------------------------------------------------------

    def _check_preset(self) -> None:
        """A compensated program holds for one datum."""
        if self.bare.startswith("CYCL DEF 247"):
            if self.preset not in (None, self.bare):
                raise self._refusal("one preset for the whole program")
            self.preset = self.bare

    def _tool(self, text: str, match: re.Match[str]) -> None:
        """TOOL CALL: of a number, a name, or of another speed alone."""
        reading, words = self.reading, match[3]
        if feed := re.search(r"\bF(\d+(?:\.\d+)?)", words):
            self.modes.tool_feed = float(feed[1])
            self.modes.take_feed(self.modes.tool_feed)
        reading.keep(self.line, text)
        tool = int(match[1]) if match[1] else match[2]
        if re.match(r" [XYUVW]\b", words):
            raise self._refusal("a tool along Z")
        if tool is None:
            return
        if reading.tcpm or reading.side:
            raise self._refusal(f"{'M129' if reading.tcpm else 'R0'} before a TOOL CALL")
        added, more = (re.search(rf"\b{word}({NUMBER})", words) for word in ("DL", "DR"))
        reading.tool, reading.more_radius = tool, float(more[1]) * reading.unit if more else 0.0
        length = reading.lengths.get(tool, reading.frame.datum.length)
        reading.switch(False, length + (float(added[1]) * reading.unit if added else 0.0))

    def _functions(self, words: list[str]) -> None:
        """Take M functions; raises BadFile for one that is not understood."""
        for word in words:
            if int(word) in (128, 129):
                self.reading.switch(word == "128", self.reading.length)
            elif int(word) in (126, 127):
                self.is_shorter_way = word == "126"
            elif int(word) in _ARC_FEEDS:
                self.reading.arc_feed = ArcFeed(int(word))
            elif int(word) not in {*_OWN_M, *_KEPT_M, *self.reading.passed}:
                expected = "M0 to M9, M13, M14, M30, M89 to M91, M99, M107 to M111, M116, M117, "
                expected += "M120, M126 to M129, M140, M141; "
                raise self._refusal(f"{expected}--pass-m {word} where it moves nothing", f"M{word}")

    def _pole(self) -> None:
        """Centre of the circles that follow; it is resolved, so the block goes."""
        reading, words = self.reading, self.bare.split()[1:]
        if not words:  # the last place is the pole
            columns = {a: reading.column(self.line, a) for a in "XY"}
            self.modes.pole = {a: float(reading.at[k]) for a, k in columns.items()}
        elif len(words) > 1:
            self.modes.pole = {}
        for word in words:
            match = AXIS.match(word)
            if match is None:
                raise self._refusal("CC with two of X, Y and Z")
            step, letter, value = match.groups()
            k = reading.column(self.line, letter)
            base = reading.at[k] if step else reading.offset[k]
            self.modes.pole[letter] = base + float(value) * reading.unit

    # --- motions ----------------------------------------------------------------------------------

    def _path(self, text: str, bare: str) -> None:
        """A block of L, LP, C, CP or CR, or of M functions alone; raises BadFile."""
        self.bare = bare
        said = Words(self.line, bare, self.modes)
        functions = set(said.functions)
        if {"128", "129"} & functions and said.named:
            raise self._refusal("M128 and M129 in a block without axes")
        if self.reading.tcpm and {"91", "140"} & functions:
            raise self._refusal("M129 before M91 and M140")
        self._functions(said.functions)
        is_called = "99" in functions or "89" in functions or (self.is_calling and bool(said.named))
        self.is_calling = "99" not in functions and ("89" in functions or self.is_calling)
        if "91" in functions and not said.named:
            raise self._refusal("M91 in an L block", "M91 alone")
        if "140" in functions:
            self._retract(text, said)
        elif is_called:
            self._called(said)
        elif not said.named and said.kind == "L":
            self.reading.keep(self.line, text)
        else:
            self._moved(said)

    def _retract(self, text: str, said: Words) -> None:
        """M140: away along the tool's axis, by a way that is not known."""
        chain = self.reading.chain
        if said.named:
            raise self._refusal("M140 in a block without axes")
        tool_side = [link for link in chain.links if not link.carries_workpiece]
        turns = any(link.kind == "rotary" and link.programmed for link in tool_side)
        self.reading.leave(self.line, text, "XYZ" if turns else "Z")

    def _moved(self, said: Words) -> None:
        """A motion of the program's own."""
        reading, is_arc = self.reading, said.kind in ("C", "CP", "CR")
        is_machine = "91" in said.functions
        if is_machine or not reading.is_known(said.end, is_arc):
            if is_arc:
                raise self._refusal("a motion to X, Y and Z before it")
            reading.at = said.end
            if is_machine:
                reading.leave(self.line, self.bare, said.named)
            else:
                reading.keep(self.line, self.bare, moves=True)
            return
        self._check_way(said)
        arc = self._arc(said) if is_arc else None
        words = " ".join(said.kept)
        reading.move(self.line, said.end, said.is_rapid, words, said.named, arc)

    def _check_way(self, said: Words) -> None:
        """Refuse a fed turn that M126 makes the other way: its pieces would go the longer way."""
        chain, turn = self.reading.chain, np.abs(said.end - self.reading.at)
        for axis in chain.rotary_axes if self.is_shorter_way and not said.is_rapid else ():
            angle = float(turn[chain.axis_index(axis)])
            if angle > np.pi + 1e-9:
                found = f"{axis} turning by {angle / DEG:g} degrees with M126"
                raise self._refusal("at most 180 degrees, or M127 before it", found)

    def _arc(self, said: Words) -> Arc:
        """Circle about the pole (C, CP), or of a radius (CR), in the plane of the pole, else XY."""
        reading, line = self.reading, self.line
        if not said.sense:
            raise self._refusal("DR+ or DR-")
        positive = said.sense == "+"
        if said.kind == "CR":
            columns = [reading.column(line, letter) for letter in "XY"]
            radius = float(said.radius or 0.0) * reading.unit
            centre = centre_by_radius(reading, line, columns, said.end, radius, positive)
            return checked_arc(reading, line, columns, said.end, centre, positive)
        columns, centre = self.modes.circle(line, self.bare)
        if said.sweep is not None:
            if said.sweep == 0.0 or (said.sweep > 0.0) != positive:
                raise self._refusal("IPA and DR of one sign")
            return Arc((columns[0], columns[1]), centre, said.sweep)
        return checked_arc(reading, line, columns, said.end, centre, positive)

    # --- cycles -----------------------------------------------------------------------------------

    def _cycle(self, text: str) -> None:
        """CYCL DEF of a hole, and its calls but for M99 and M89."""
        if self.bare.startswith("CYCL DEF"):
            self.hole, self.is_calling = defined(self.line, text, self.reading), False
            return
        hole = self._needed()
        match = re.fullmatch(r"CYCL CALL(?: (POS)(.*))?((?: M\d+)*)", self.bare)
        if match is None:
            raise self._refusal("CYCL CALL, CYCL CALL POS X Y Z, or M99")
        self.is_calling = False
        if match[1] is None:
            self._functions(re.findall(r"M(\d+)", match[3]))
            self._drill(hole, f"FMAX M99{match[3]}")
            return
        reading = self.reading
        said = Words(self.line, f"L{match[2]}", self.modes)
        z = reading.column(self.line, "Z")
        if not {"X", "Y", "Z"} <= set(said.named):
            raise self._refusal("X, Y and Z in CYCL CALL POS")
        self._functions(said.functions)
        raised = float(said.end[z] - reading.offset[z])
        for place in way(reading.at, said.end, z, said.end[z] + hole.surface + hole.near):
            reading.move(self.line, place, True)
        self._drill(hole, " ".join([*said.kept, "FMAX M99"]), raised=raised)

    def _called(self, said: Words) -> None:
        """A motion with M99 or M89: the cycle is called where it ends."""
        reading, hole = self.reading, self._needed()
        kept, named = [w for w in said.kept if w not in ("M89", "M99")], said.named
        if "Z" in named:
            reading.move(self.line, said.end, said.is_rapid, " ".join(kept), named)
            kept, named = [], []
        reading.at = said.end
        feed = "FMAX" if said.is_rapid or not reading.feed else f"F{reading.feed:g}"
        self._drill(hole, " ".join([*kept, feed, "M99"]), named)

    def _needed(self) -> Hole:
        """The cycle that a call means; raises BadFile."""
        if self.hole is None:
            raise self._refusal("CYCL DEF of a hole before it", "a call of no cycle")
        return self.hole

    def _drill(
        self, hole: Hole, words: str, named: list[str] | None = None, raised: float = 0.0
    ) -> None:
        """The hole at a place where the axes have just come to; `raised` goes to its surface."""
        reading, z = self.reading, self.reading.column(self.line, "Z")
        surface = hole.surface + raised + float(reading.offset[z])
        near, bottom, far = (surface + h for h in (hole.near, -hole.depth, hole.far))
        minutes = (hole.near + hole.depth) / hole.feed
        cycle = Cycle(hole.text, hole.depth, 0)
        place, heights = np.array(reading.at), (near, bottom, far)
        reading.hole(self.line, place, z, heights, words, cycle, named or (), minutes)
