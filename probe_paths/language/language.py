# ruff: noqa: D102  (what a function means stands at that of `klartext`)
"""What every language of a control can say: the closed list of blocks, spelt by each in its way.

A language is a module with these names. Its reader makes the same `Block`s of its text whichever
language it is, so that interpreter, collision check and twin know one list and no control.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple, Protocol

from matstd.probe_paths.language.dialect import Dialect
from matstd.probe_paths.language.masks import LogForm, MaskLine


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
    """One touch as a program states it.

    Attributes:
        direction: Probing vector in the workpiece frame.
        distance: Longest path from the start, mm.
        feed: Probing feed, mm/min.
        back: Retract after the contact, mm.
    """

    direction: Sequence[float]
    distance: float
    feed: float
    back: float


class Tilting(NamedTuple):
    """Planes square to the tool.

    Attributes:
        on: Block that begins one, of its spatial angles (degrees) and the reading of the rotary
            axis nearest the foundation.
        off: Block that ends it.
    """

    on: Callable[[Sequence[float], float], str]
    off: str


@dataclass(frozen=True, kw_only=True)
class Says:
    """How a language says what a refusal asks for.

    Attributes:
        reset: Block that ends tool-point control, with which a reset begins.
        plane: Block that ends tilted planes, or the like.
        shift: Blocks after which only the preset shifts.
        tool: Call of the probe.
        preset: Activation of the preset.
        machine: Word for coordinates of the machine.
        retract: Move of Z to its upper end.
        retract_max: The same after a touch without contact.
        rapid: Word for rapid.
        sync: Wait until the machine stands.
        status: Test of the status of a touch.
        length: Tests of the length of the called tool.
        unset: Assignment of a status; `{q}` is its parameter.
        printed: Line that goes to the log.
        halt: What ends a program early.
        back: Word for the retract after a contact.
    """

    reset: str
    plane: str
    shift: str
    tool: str
    preset: str
    machine: str
    retract: str
    retract_max: str
    rapid: str
    sync: str
    status: str
    length: str
    unset: str
    printed: str
    halt: str
    back: str


class Language(Protocol):
    """Blocks as text; what each means stands at the functions of `klartext`."""

    ENDING: str
    LINE_END: str
    SAYS: Says
    SYSTEM: Mapping[Datum, str]
    TESTS_TURNS: bool
    RESET: Sequence[str]
    UNWIND: Sequence[str]
    TILTING: Tilting | None
    WAIT: str
    LABEL_END: str
    OPERATOR_STOP: str
    PROGRAM_STOP: str
    LOG: LogForm
    HAS_MASKS: bool
    SUBPROGRAMS_FIRST: bool

    def begin(self, name: str) -> str: ...
    def end(self, name: str) -> str: ...
    def comment(self, text: str) -> str: ...
    def structure(self, text: str) -> str: ...
    def stock(self, low: Sequence[float], high: Sequence[float]) -> list[str]: ...
    def line(self, position: Mapping[str, float], feed: float | None = None) -> str: ...
    def turn(self, position: Mapping[str, float]) -> str: ...
    def retract(self, z: float) -> str: ...
    def retract_max(self, z: float) -> str: ...
    def tool_call(self, number: int) -> str: ...
    def preset(self, row: int) -> str: ...
    def read(self, q: int, datum: Datum) -> str: ...
    def assign(self, q: int, value: float) -> str: ...
    def difference(self, q: int, minuend: int, subtrahend: float) -> str: ...
    def minus(self, q: int, other: int) -> str: ...
    def jump_if_less(self, q: int, limit: float, label: int) -> str: ...
    def jump_if_greater(self, q: int, limit: float, label: int) -> str: ...
    def skip_if_greater(self, q: int, limit: float, label: int) -> str: ...
    def skipped(self, label: int) -> str: ...
    def stop_with_error(self, number: int) -> str: ...
    def printed(self, mask: str, lines: Sequence[MaskLine], target: str) -> str: ...
    def probe_vector(self, dialect: Dialect, result: int, touch: Touch) -> list[str]: ...
    def label(self, number: int, remark: str = "") -> str: ...
    def call(self, number: int) -> str: ...
    def listed(self, blocks: Sequence[str]) -> str: ...
