"""What a program does once it is read: moves, touches, printed lines, in order."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from matstd.probe_paths.language import MaskLine
from matstd.probe_paths.plan import Heading, Sensor
from matstd.twin.frames import Array

STATUS = 3  # part of a cycle's result that states whether there was a contact; negative: none


class Result(NamedTuple):
    """A number that only the run brings: part 0-2 = X Y Z, 3 = status, of a touch."""

    touch: int
    part: int


Value = float | Result


@dataclass(frozen=True, eq=False)
class Move:
    """Positioning to a target."""

    line: int
    q: Array  # readings at the end, (A,), mm and rad; nan where an axis has not been positioned yet
    feed: float | None  # mm/s or rad/s; None is rapid
    # False for a move that ends in mid-air by definition (M140), not at a position
    checked: bool = True


@dataclass(frozen=True, eq=False)
class ProbeStep:
    """One run of touch probe cycle 4."""

    line: int  # in the program file, of the cycle's last block
    index: int  # counts the touches of this program from 0
    q: Array  # readings at the start, (A,), mm and rad
    direction: Array  # unit vector of the motion in readings, (A,); zero for rotary axes
    distance: float  # longest travel, mm
    feed: float  # mm/s
    back: float  # retract after the contact, mm
    side: Array  # sign of the last motion of every axis before the touch, (A,); 0 where unknown
    number: int  # number of the touch, as the log will name it
    pose: int  # number of the table pose in the log
    feature: int  # number of the feature in the log
    # feed of the second touch that measures, mm/s; 0 where the first one does
    slow_feed: float
    step_back: float  # from the surface before the second touch, mm
    is_air: bool  # it must meet nothing; it has no number, and no line in the log
    # what the program does when there is no contact; of one in the air, when there is
    on_miss: list["Step"] = field(default_factory=list)


@dataclass(frozen=True, eq=False)
class Print:
    """Lines that FN 16 writes."""

    line: int
    lines: tuple[MaskLine, ...]
    target: str
    # values of the Q parameters in the mask; a sensor where it is read at that moment
    values: Mapping[int, Value | Sensor]


@dataclass(frozen=True)
class Halt:
    """The program stops with one of the control's error texts."""

    line: int
    number: int


Step = Move | ProbeStep | Print | Halt


@dataclass(frozen=True, eq=False)
class ReadProgram:
    """A program as its text alone states it."""

    path: Path
    name: str
    heading: Heading  # standard, set-up and probe that it was made for
    features: Mapping[int, str]  # name of every feature number
    steps: tuple[Step, ...]
    is_search: bool  # its touches come down from above on whatever is there
    is_first: bool  # it is one that a control is tried with, and measures nothing
    tool: int | None  # number of the tool that it calls
    preset: int | None  # number of the preset that it selects

    @property
    def touches(self) -> list[ProbeStep]:
        """The touches in order."""
        return [step for step in self.steps if isinstance(step, ProbeStep)]

    @property
    def touch_rows(self) -> list[int]:
        """Which of the steps are touches."""
        return [i for i, step in enumerate(self.steps) if isinstance(step, ProbeStep)]
