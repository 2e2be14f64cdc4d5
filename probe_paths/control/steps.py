"""What a program does once it is read: moves, touches, printed lines, in order."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from matstd.probe_paths.language import MaskLine
from matstd.probe_paths.plan import Heading, Sensor
from matstd.twin.frames import Array

STATUS = 3
"""Part of a cycle's result that states whether there was a contact; negative: none."""


class Result(NamedTuple):
    """A number that only the run brings: part 0-2 = X Y Z, 3 = status, of a touch."""

    touch: int
    part: int


Value = float | Result


@dataclass(frozen=True, eq=False)
class Move:
    """Positioning to a target.

    Attributes:
        q: Readings at the end, (A,), mm and rad; nan where an axis has not been positioned yet.
        feed: mm/s or rad/s; None is rapid.
        checked: False for a move that ends in mid-air by definition (M140), not at a position.
    """

    line: int
    q: Array
    feed: float | None
    checked: bool = True


@dataclass(frozen=True, eq=False)
class ProbeStep:
    """One run of touch probe cycle 4.

    Attributes:
        line: In the program file, of the cycle's last block.
        index: Counts the touches of this program from 0.
        q: Readings at the start, (A,), mm and rad.
        direction: Unit vector of the motion in readings, (A,); zero for rotary axes.
        distance: Longest travel, mm.
        feed: mm/s.
        slow_feed: Feed of the second touch that measures, mm/s; 0 where the first one does.
        step_back: From the surface before the second touch, mm.
        back: Retract after the contact, mm.
        side: Sign of the last motion of every axis before the touch, (A,); 0 where unknown.
        number: Number of the touch, as the log will name it.
        pose: Number of the table pose in the log.
        feature: Number of the feature in the log.
        on_miss: What the program does when there is no contact; of one in the air, when there is.
        is_air: It must meet nothing; it has no number, and no line in the log.
    """

    line: int
    index: int
    q: Array
    direction: Array
    distance: float
    feed: float
    back: float
    side: Array
    number: int
    pose: int
    feature: int
    slow_feed: float = 0.0
    step_back: float = 0.0
    on_miss: list["Step"] = field(default_factory=list)
    is_air: bool = False


@dataclass(frozen=True, eq=False)
class Print:
    """Lines that FN 16 writes.

    Attributes:
        values: Values of the Q parameters in the mask; a sensor where it is read at that moment.
    """

    line: int
    lines: tuple[MaskLine, ...]
    target: str
    values: Mapping[int, Value | Sensor]


@dataclass(frozen=True)
class Halt:
    """The program stops with one of the control's error texts."""

    line: int
    number: int


Step = Move | ProbeStep | Print | Halt


@dataclass(frozen=True, eq=False)
class ReadProgram:
    """A program as its text alone states it.

    Attributes:
        heading: Standard, set-up and probe that it was made for.
        features: Name of every feature number.
        is_search: Its touches come down from above on whatever is there.
        is_first: It is one that a control is tried with, and measures nothing.
        tool: Number of the tool that it calls.
        preset: Number of the preset that it selects.
    """

    path: Path
    name: str
    heading: Heading
    features: Mapping[int, str]
    steps: tuple[Step, ...]
    is_search: bool = False
    is_first: bool = False
    tool: int | None = None
    preset: int | None = None

    @property
    def touches(self) -> list[ProbeStep]:
        """The touches in order."""
        return [step for step in self.steps if isinstance(step, ProbeStep)]
