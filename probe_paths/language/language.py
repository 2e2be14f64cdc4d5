"""The closed list of blocks that our programs consist of, as each language spells them.

A language is a table of forms (`klartext`, `gcode`). Its reader makes the same `Block`s of its text
whichever language it is, so that interpreter, collision check and twin know one list and no
control.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple

from matstd.probe_paths.language.dialect import TOOL_LENGTH, Dialect
from matstd.probe_paths.language.masks import LogForm, MaskLine
from matstd.probe_paths.language.text import (
    axis_words,
    checked_line,
    checked_name,
    parameter,
    signed,
)
from matstd.twin.errors import DesignError
from matstd.twin.machine import Chain


class Datum(StrEnum):
    """System data that our programs read; X to C are nominal positions of the axes.

    With `preset` before them they are those that the active preset makes of them.
    """

    RADIUS = "radius of the calibrated ball"
    LENGTH = "length of the calibrated probe"
    OFFSET_X = "offset of the ball from the spindle axis in X"
    OFFSET_Y = "the same in Y"
    TOOL = "number of the called tool"
    ROTATION = "basic rotation"
    CYCLE_ROTATION = "rotation of cycle 10"
    MIRROR = "axes that cycle 8 mirrors, one bit each"
    SCALE_X = "scaling factor of cycles 11 and 26 in X"
    SCALE_Y = "the same factor in Y"
    SCALE_Z = "the same factor in Z"
    TOP = "upper software limit of Z"
    X = "X"
    Y = "Y"
    Z = "Z"
    A = "A"
    B = "B"
    C = "C"
    TOOL_X = "offset of the tool table in X"
    TOOL_Y = "offset of the tool table in Y"
    WORK_X = "preset X"
    WORK_Y = "preset Y"
    WORK_Z = "preset Z"
    WORK_A = "preset A"
    WORK_B = "preset B"
    WORK_C = "preset C"


class Touch(NamedTuple):
    """One touch as a program states it."""

    direction: Sequence[float]  # probing vector in the workpiece frame
    distance: float  # longest path from the start, mm
    feed: float  # probing feed, mm/min
    back: float  # retract after the contact, mm


class Tilting(NamedTuple):
    """Planes square to the tool."""

    # block that begins one, of its spatial angles (degrees) and the reading of the rotary axis
    # nearest the foundation
    on: Callable[[Sequence[float], float], str]
    off: str


@dataclass(frozen=True, kw_only=True)
class Terms:
    """How a language names what a refusal asks for."""

    reset: str  # block that ends tool-point control, with which a reset begins
    plane: str  # block that ends tilted planes, or the like
    shift: str  # blocks after which only the preset shifts
    tool: str  # call of the probe
    preset: str  # activation of the preset
    machine: str  # word for coordinates of the machine
    retract: str  # move of Z to its upper end
    retract_max: str  # the same after a touch without contact
    rapid: str  # word for rapid
    sync: str  # wait until the machine stands
    status: str  # test of the status of a touch
    unset: str  # assignment of a status; `{q}` is its parameter
    printed: str  # line that goes to the log
    halt: str  # what ends a program early
    back: str  # word for the retract after a contact


@dataclass(frozen=True, kw_only=True)
class Language:
    """Spelling of every block.

    Coordinates always carry a sign and four decimals, the resolution of the controls, so that the
    planned, printed and re-read numbers agree.
    """

    ending: str  # ending of the name of a program file
    line_end: str
    longest: int  # characters of a line that is emitted
    forms: Mapping[str, str]  # text of every block by the name of its method, with places in braces
    sign: str  # letter before the number of a parameter
    tool_length: str  # parameter with the length of the called tool, as in the tool table
    system: Mapping[Datum, str]  # how each system datum is addressed
    terms: Terms
    log: LogForm  # how the control prints clock and counters
    # block that appends lines to a log, from the mask file, its lines, and the target
    printed: Callable[[str, Sequence[MaskLine], str], str]
    lines: Callable[[Sequence[str]], list[str]]  # lines of the file from all blocks
    # blocks that begin a program on a machine: nothing that an earlier one left acts afterwards
    reset: Callable[[Chain, Dialect], Sequence[str]]
    orientation: Sequence[str]  # blocks that orient the spindle to 0 degrees
    wait: str  # block that stops the look-ahead: system data are read where the machine stands
    label_end: str
    operator_stop: str  # waits for the operator
    stock_forms: Sequence[str] = ()  # forms of the blocks of the raw part, which the control draws
    program_stop: str = "M30"
    unwind: Sequence[str] = ()  # blocks before rotary axes go home the way that the numbers state
    # blocks that tilt the plane square to the tool; None where the language has none
    tilting: Tilting | None = None
    has_masks: bool = False  # the lines of the log stand in mask files, not in the program
    subprograms_first: bool = False  # they stand before the program itself
    # the control may take another way or end of a turn than its word states
    tests_turns: bool = False

    def _form(self, form: str, /, **words: object) -> str:
        return self.forms[form].format(**words)

    def _jump(self, form: str, q: int, limit: float, label: int, number: int) -> str:
        fn, than = (12, "LT") if form == "less" else (11, "GT")
        words = {"fn": fn, "than": than, "limit": parameter(limit), "number": number}
        return self._form("skip" if form == "skip" else "test", q=q, label=label, **words)

    def begin(self, name: str) -> str:
        """First block of a program in millimetres."""
        return self._form("begin", name=checked_name(name))

    def end(self, name: str) -> str:
        """Last block of a program in millimetres."""
        return self._form("end", name=checked_name(name))

    def comment(self, text: str) -> str:
        """Comment block; in Klartext a tilde at its end would continue it on the next line."""
        if text.rstrip().endswith("~"):
            raise DesignError(f"comment '{text}' ends in ~, which continues a block")
        return f";{text}"

    def structure(self, text: str) -> str:
        """Heading, which the control shows in its view of the program."""
        return self._form("structure", text=text)

    def stock(self, low: Sequence[float], high: Sequence[float]) -> list[str]:
        """Blocks of the raw part: simulation graphics only."""
        corners = (axis_words(dict(zip("XYZ", c, strict=True))) for c in (low, high))
        return [f.format(corner=c) for f, c in zip(self.stock_forms, corners, strict=False)]

    def line(self, position: Mapping[str, float], feed: float | None = None) -> str:
        """Straight line to a position.

        Args:
            position: Coordinate by axis letter, mm or degrees.
            feed: mm/min (degrees/min for rotary axes alone), whole numbers; None is rapid.
        """
        name = "rapid" if feed is None else "fed"
        return self._form(name, axes=axis_words(position), feed=feed)

    def turn(self, position: Mapping[str, float]) -> str:
        """Rapid move of rotary axes, the shorter way where the control has a choice."""
        return self._form("turn", axes=axis_words(position))

    def retract(self, z: float) -> str:
        """Z to a reading of the machine, where rotary axes may turn."""
        return self._form("retract", axes=axis_words({"Z": z}))

    def to_turning_place(self, x: float, y: float) -> str:
        """X and Y to readings of the machine, where a head that carries the tool may turn."""
        return self._form("retract", axes=axis_words({"X": x, "Y": y}))

    def retract_max(self, z: float) -> str:
        """The same after a touch without contact: to the end of the travel."""
        return self._form("retract_max", axes=axis_words({"Z": z}))

    def tool_call(self, number: int) -> str:
        """Call of the probe; never with a spindle speed."""
        return self._form("tool_call", number=number)

    def preset(self, row: int) -> str:
        """Activation of a row of the preset table, or of G54 to G59."""
        return self._form("preset", row=row, system=53 + row)

    def read(self, q: int, datum: Datum) -> str:
        """Read a system datum into a parameter."""
        return self._form("read", q=q, datum=self.system[datum])

    def assign(self, q: int, value: float) -> str:
        """Set a parameter; whole numbers are written without decimals."""
        return self._form("assign", q=q, value=parameter(value))

    def parameter(self, q: int) -> str:
        """Name of a parameter."""
        return self.tool_length if q == TOOL_LENGTH else f"{self.sign}{q:d}"

    def difference(self, q: int, minuend: int, subtrahend: float) -> str:
        """A parameter less a number."""
        words = {"minuend": self.parameter(minuend), "value": signed(subtrahend)}
        return self._form("difference", q=q, **words)

    def minus(self, q: int, other: int) -> str:
        """A parameter less another one."""
        return self._form("minus", q=q, other=other)

    def jump_if_less(self, q: int, limit: float, label: int) -> str:
        """Go to a label when a parameter is less than a number."""
        return self._jump("less", q, limit, label, 100 + label)

    def jump_if_greater(self, q: int, limit: float, label: int) -> str:
        """Go to a label when a parameter is greater than a number."""
        return self._jump("greater", q, limit, label, 200 + label)

    def skip_if_greater(self, q: int, limit: float, label: int) -> str:
        """Go on behind a part of the program when a parameter is greater than a number."""
        return self._jump("skip", q, limit, label, SKIP + label)

    def skipped(self, label: int) -> str:
        """End of a part that may be skipped."""
        return self._form("skipped", label=label, number=SKIP + label)

    def stop_with_error(self, number: int) -> str:
        """End the program with one of the control's error texts, or a message."""
        return self._form("stop_with_error", number=number)

    def probe_vector(self, dialect: Dialect, result: int, touch: Touch) -> list[str]:
        """One touch.

        Args:
            dialect: Its spelling, and the second touch of a control without a latch.
            result: First of four consecutive parameters: X, Y, Z and status.
        """
        x, y, z = map(signed, touch.direction)
        back, distance, feed = signed(touch.back), signed(touch.distance), f"{touch.feed:.0f}"
        slow, step = f"{dialect.slow_feed:.0f}", signed(dialect.step_back)
        words = {"x": x, "y": y, "z": z, "back": back, "distance": distance, "feed": feed}
        words |= {"slow": slow, "step": step, "cycle": dialect.cycle_name}
        text = self._form("touch", result=result, word=dialect.distance_word, **words)
        return text.split("\n")

    def label(self, number: int, remark: str = "") -> str:
        """Start of a subprogram."""
        name = "label_remarked" if remark else "label"
        return self._form(name, label=number, remark=remark)

    def call(self, number: int) -> str:
        """Call of a subprogram."""
        return self._form("call", label=number)

    def listed(self, blocks: Sequence[str]) -> str:
        """The whole file; raises DesignError."""
        lines = [checked_line(line, self.longest) for line in self.lines(blocks)]
        return self.line_end.join(lines) + self.line_end


SKIP = 1000
"""Added to the number of a label where tests have numbers: those of other tests are below."""
