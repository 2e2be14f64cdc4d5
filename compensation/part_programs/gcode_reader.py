"""A reader of G-code part programs: words into modes, motions and holes."""

import re
from typing import NamedTuple

import numpy as np

from matstd.compensation.part_programs.language import Reading, centre_by_radius, checked_arc
from matstd.compensation.part_programs.motion import Arc, Cycle
from matstd.nc.grammar import DATUMS, MODAL, Modal, gcode_lines, split_words
from matstd.twin.frames import Array

_HOMES = frozenset({28.0, 30.0})
_TCP = frozenset({43.4, 234.0})
"""Tool-point control of Fanuc and its kin, and of Haas: coordinates on the turning table."""

_KEPT = frozenset(
    {4.0, 5.1, 15.0, 17.0, 18.0, 19.0, 20.0, 21.0, 40.0, 43.0, 49.0, 50.0, 50.1, 61.0, 61.1, 64.0}
    | {69.0, 80.0, 92.1, 92.2, 93.0, 94.0, 98.0, 99.0, 187.0}
    | _TCP
    | DATUMS
    | _HOMES
)
"""Words that stay in the program: modes, what ends one, smoothing, ways home."""

_READ = MODAL | {53.0} | _KEPT
_ENDS = frozenset({15.0, 50.0, 50.1, 69.0, 92.1, 92.2})
"""They end modes that are refused, and name no axis."""

_KEPT_M = frozenset({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 19, 29, 30, 48, 49})
_SUBPROGRAMS = (97, 98, 99)
_DATUM = "one datum for the whole program"
_REFUSED = {
    **dict.fromkeys((10.0, 52.0, 54.1, 54.2, 92.0), _DATUM),
    **dict.fromkeys((16.0, 51.0, 51.1, 68.0, 68.2, 53.1), "plain coordinates of the datum"),
    **dict.fromkeys((65.0, 66.0), "motions, not macros"),
    95.0: "G94 or G93, feed per minute or inverse time",
}
_UNDERSTOOD = (
    "G0 to G4, G17 to G21, G28, G30, G40 to G43, G43.4, G49, G53 to G64, G69, G73, G74, "
    "G80 to G86, G89 to G91, G93, G94, G98, G99"
)
_AXES = frozenset("XYZABCUVW")
_CENTRES = dict(zip("XYZ", "IJK", strict=True))
_NAME = re.compile(r"O\d+")
_NOT_PLAIN = re.compile(r"[/$]|O\d|O<|.*[#\[=]")
_CHANGE = re.compile(r"M0*6(?!\d)", re.IGNORECASE)

_IN_CYCLES = frozenset("XYZRPQFLHSTK")
MAX_HOLES = 1000  # holes of one line; beyond it the word is no number of holes


class _Block(NamedTuple):
    """One line."""

    line: int
    g: list[float]  # G words
    other: dict[str, float]  # words by letter but for G, M and N, axes among them
    axes: dict[str, float]
    kept: list[str]  # what stays in the program besides its motion

    def text(self, words: dict[str, float], but: str = "") -> list[str]:
        """Words as text, without some letters."""
        return [f"{k}{v:.10g}" for k, v in words.items() if k not in but]

    @property
    def placed(self) -> str:
        """Words of axes as text."""
        return " ".join(self.text(self.axes))


def read(text: str, reading: Reading) -> None:
    """Read a whole program into the items of `reading`; raises BadFile."""
    reader = _Reader(reading, calls_by_t=_CHANGE.search(text) is None)
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
        reader.take(line, words, remarks)


class _Reader:
    """A program while it is read."""

    def __init__(self, reading: Reading, calls_by_t: bool) -> None:
        self.reading, self.modal = reading, Modal()
        self.calls_by_t = calls_by_t  # T itself changes the tool: nowhere in the program is an M6
        self.next_tool: int | None = None
        self.minutes = 0.0  # that the motion takes, from an F word in inverse time
        self.height = 0.0  # Z when the first of the cycles in a row was called, mm
        self.cycle: dict[str, float] | None = None  # words of a canned cycle in force

    def take(self, line: int, words: list[tuple[str, float]], remarks: str) -> None:
        """One line: modes first, then its motion; raises BadFile."""
        other = {letter: value for letter, value in words if letter not in "GMN"}
        g = [value for letter, value in words if letter == "G"]
        axes = {k: v for k, v in other.items() if k in _AXES}
        kept = [remarks] if remarks else []
        said = _Block(line=line, g=g, other=other, axes=axes, kept=kept)
        self._modes(said)
        said.kept.extend(f"G{value:g}" for value in g if value in _KEPT)
        self._tool(said)
        for m in (int(value) for letter, value in words if letter == "M"):
            self._function(line, m)
            said.kept.append(f"M{m}")
        if "F" in other and self.modal.is_inverse_time:
            self.minutes = 1.0 / other["F"] if other["F"] > 0.0 else 0.0
        elif "F" in other:
            self.reading.feed, self.reading.feed_unit = other["F"], self.reading.unit
        is_home = not _HOMES.isdisjoint(g)
        is_arc = self.modal.is_arc and not set("IJK").isdisjoint(other)
        if (axes or is_arc) and not is_home:
            self._moving(said)
            return
        said.kept.extend(said.text(other, but="XYZABCUVWD"))
        if is_home:
            self._home(said)
        elif said.kept:
            self.reading.keep(line, " ".join(said.kept))

    # --- modes ------------------------------------------------------------------------------------

    def _modes(self, said: _Block) -> None:
        """G words; raises BadFile."""
        reading, modal = self.reading, self.modal
        for g in said.g:
            if g not in _READ or (g in _ENDS and said.axes):
                raise reading.refusal(said.line, f"G{g:g}", _REFUSED.get(g, _UNDERSTOOD))
            if g in DATUMS and modal.datum not in (None, g):
                expected = f"G{modal.datum:g} alone: a compensated program holds for one datum"
                raise reading.refusal(said.line, f"G{g:g}", expected)
            if g == 94.0 and modal.is_inverse_time:
                reading.feed = 0.0  # LinuxCNC wants F anew; 1/min is no feed
            if g in MODAL:
                modal.take(g)
            elif g in (43.0, 49.0) or g in _TCP:
                # the length of H, else that of the tool
                is_stated = g != 49.0 and "H" in said.other
                number = int(said.other["H"]) if is_stated else None
                length = reading.length if number is None else reading.lengths.get(number)
                reading.switch(g in _TCP, reading.length if length is None else length)
            reading.unit, reading.side = modal.unit, modal.side
            if not modal.is_cycle:
                self.cycle = None

    def _tool(self, said: _Block) -> None:
        """Tool of a T word, the next one or this, and that whose radius a D word means."""
        if "T" in said.other:
            self.next_tool = int(said.other["T"])
            if self.calls_by_t:
                self._change(said.line, self.next_tool)
        if "D" in said.other:
            if not {41.0, 42.0}.intersection(said.g):
                raise self.reading.refusal(said.line, f"D{said.other['D']:g}", "it with G41 or G42")
            self.reading.tool = int(said.other["D"])

    def _change(self, line: int, number: int) -> None:
        reading = self.reading
        if reading.side:
            raise reading.refusal(line, f"T{number}", "G40 before another tool")
        reading.tool = number
        reading.switch(False, reading.lengths.get(number, reading.frame.datum.length))

    def _function(self, line: int, m: int) -> None:
        """Take an M word; raises BadFile for one that is not understood."""
        reading = self.reading
        if m in reading.tcp_functions:
            reading.switch(m == reading.tcp_functions[0], reading.length)
        elif m not in _KEPT_M and (m not in reading.passed or m in _SUBPROGRAMS):
            expected = "M0 to M9, M19, M29, M30, M48, M49"
            if m not in _SUBPROGRAMS:
                expected += f"; --pass-m {m} where it moves nothing"
            raise reading.refusal(line, f"M{m}", expected)
        if m == 6 and self.next_tool is not None:
            self._change(line, self.next_tool)

    # --- motions ----------------------------------------------------------------------------------

    def _home(self, said: _Block) -> None:
        """G28 or G30: to a place of the machine, by way of one of the program."""
        text = f"{' '.join(said.kept)} {said.placed}".strip()
        text = text if self.modal.is_absolute else f"G91 {text}\nG90"
        self.reading.leave(said.line, text, said.axes or None)

    def _moving(self, said: _Block) -> None:
        """A line with axes, or with the centre of a circle."""
        modal = self.modal
        if modal.motion is None or 4.0 in said.g:
            found = "axes without G0, G1, G2 or G3"
            raise self.reading.refusal(said.line, found, "one of them before")
        spent = "XYZABCUVWIJKRD" + "F" * modal.is_inverse_time
        spent += ("" if 64.0 in said.g else "P") + "QL" * modal.is_cycle
        said.kept.extend(said.text(said.other, but=spent))
        words = " ".join(said.kept)
        if modal.is_cycle:
            self._holes(said, words)
        elif 53.0 in said.g:
            text = f"{words} G53 G{modal.motion:g} {said.placed}".strip()
            self.reading.leave(said.line, text, said.axes)
        else:
            self._motion(said, words)

    def _end(self, line: int, axes: dict[str, float]) -> Array:
        """Where the axes stand after a motion, (A,)."""
        end = self.reading.at.copy()
        for letter, value in axes.items():
            k = self.reading.column(line, letter)
            step = value * self.reading.scale(letter)
            end[k] = step if self.modal.is_absolute else end[k] + step
        return end

    def _motion(self, said: _Block, words: str) -> None:
        """The motion of a line."""
        reading, modal, line = self.reading, self.modal, said.line
        end, is_rapid = self._end(line, said.axes), modal.motion == 0.0
        if not reading.is_known(end, modal.is_arc):
            if modal.is_arc or not modal.is_absolute:
                found = "an arc or a step from where no axis is known to stand"
                raise reading.refusal(line, found, "a motion to X, Y and Z before it")
            reading.keep(line, f"{words} G{modal.motion:g} {said.placed}".strip(), moves=True)
            reading.at = end
            return
        is_timed = modal.is_inverse_time and not is_rapid
        if is_timed and "F" not in said.other:
            raise reading.refusal(line, "a motion without F in inverse time", "F in every line")
        arc = self._arc(said, end) if modal.is_arc else None
        minutes = self.minutes if is_timed else 0.0
        reading.move(line, end, is_rapid, words, tuple(said.axes), arc, minutes)

    def _arc(self, said: _Block, end: Array) -> Arc:
        """Circle of a G2 or G3 line."""
        reading, line, other = self.reading, said.line, said.other
        plane = [reading.column(line, letter) for letter in self.modal.plane]
        positive = self.modal.motion == 3.0
        if "R" in other:
            radius = other["R"] * reading.unit
            centre = centre_by_radius(reading, line, plane, end, radius, positive)
        else:
            named = (other.get(_CENTRES[a], 0.0) * reading.unit for a in self.modal.plane)
            centre = np.array(list(named))
            centre = centre if self.modal.has_absolute_centres else centre + reading.at[plane]
        turns = int(other.get("P", 1))
        return checked_arc(reading, line, plane, end, centre, positive, turns)

    # --- canned cycles: a hole along Z, called once at its compensated place ----------------------

    def _holes(self, said: _Block, words: str) -> None:
        """The holes of a line; raises BadFile for what is no cycle along Z."""
        line, modal, reading = said.line, self.modal, self.reading
        if modal.plane != "XY":
            raise reading.refusal(line, f"G{modal.motion:g} outside G17", "G17 for canned cycles")
        if strange := sorted(set(said.other) - _IN_CYCLES):
            found = f"{strange[0]} in a canned cycle"
            raise reading.refusal(line, found, "X, Y, Z, R, P, Q, L and F")
        z = reading.column(line, "Z")
        top, bottom, stay = self._levels(said, z)
        back = max(top, self.height) if modal.returns_to_start else top
        cycle = Cycle(f"G{modal.motion:g}{{place}} R{{top}}{stay}", top - bottom, 0)
        times = int(said.other.get("L", said.other.get("K", 1.0)))
        if not 1 <= times <= MAX_HOLES:
            raise reading.refusal(line, f"{times} holes", f"1 to {MAX_HOLES}")
        axes = {a: v for a, v in said.axes.items() if a != "Z"}
        for _ in range(times):
            place = self._end(line, axes)
            reading.hole(line, place, z, (top, bottom, back), words, cycle)
            words = ""

    def _levels(self, said: _Block, z: int) -> tuple[float, float, str]:
        """Top and bottom of a hole, mm, and the words that every call has besides."""
        reading, modal = self.reading, self.modal
        assert modal.motion is not None
        if self.cycle is None:
            self.cycle, self.height = {}, float(reading.at[z])
        if self.cycle.get("G") != modal.motion:  # dwell and steps are those of one kind of cycle
            kept = {k: v for k, v in self.cycle.items() if k in "RZ"}
            self.cycle = {**kept, "G": modal.motion}
        self.cycle |= {k: v for k, v in said.other.items() if k in "RZPQ"}
        if missing := [k for k in "RZ" if k not in self.cycle]:
            found = f"a canned cycle without {missing[0]}"
            raise reading.refusal(said.line, found, "R and Z in its first")
        top = self.cycle["R"] * reading.unit + (0.0 if modal.is_absolute else self.height)
        bottom = self.cycle["Z"] * reading.unit + (0.0 if modal.is_absolute else top)
        if bottom > top:
            raise reading.refusal(said.line, f"a bottom at Z{bottom:g} above R{top:g}", "it below")
        stay = "".join(f" {k}{v:.10g}" for k, v in self.cycle.items() if k in "PQ")
        return top, bottom, stay
