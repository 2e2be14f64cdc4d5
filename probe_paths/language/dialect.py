"""What differs between controls and workshops, and which Q parameters our programs use."""

from dataclasses import dataclass, replace
from enum import IntEnum
from typing import Literal

from matstd.probe_paths.language.text import MAX_NAME
from matstd.probe_paths.plan import Sensor


class Q(IntEnum):
    """Parameters of our programs, all in Q1600-Q1999, which no cycle and no builder uses."""

    PROBE_RADIUS = 1601
    PROBE_LENGTH = 1602
    OFFSET_X = 1603
    OFFSET_Y = 1604
    TOOL = 1605
    PRESET = 1606
    RESULT_X = 1610
    RESULT_Y = 1611
    RESULT_Z = 1612
    STATUS = 1613
    TOUCH = 1620
    POSE = 1621
    FEATURE = 1622
    SIDE_1 = 1623
    SIDE_2 = 1624
    CHECK = 1614
    CHECK_WORK = 1615
    ROTARY_1 = 1631
    ROTARY_2 = 1632
    START = 1640


TOOL_LENGTH = 114
"""Parameter in which the control keeps the length of the called tool, as in the tool table."""

FREE = range(1600, 2000)  # parameters that a program may write
_ENDS_OF_VISITS = range(111, 255)  # up to the last label that the oldest software has


class Label(IntEnum):
    """Subprograms of our programs; from `OTHER_PROBE` on alarms, which docs/alarms.md explains.

    `NOT_AS_PLANNED` is the alarm of all tests of a commissioning program, `AIR` its continuation
    after a touch in the air without contact. Labels within the program follow the visits: a program
    that starts at a later visit jumps there.
    """

    LOG = 90
    NO_CONTACT = 91
    OTHER_PROBE = 92
    NOT_AS_PLANNED = 93
    AIR = 94
    CYCLES = 95
    RADIUS = 101
    ROTATION = 102
    TOP = 103
    PRESET_X = 104
    PRESET_Y = 105
    PRESET_Z = 106
    ZERO_1 = 107
    ZERO_2 = 108
    TURNED = 109
    TOOL_OFFSET = 110

    @staticmethod
    def behind(count: int) -> int | None:
        """Label behind a visit, counted from 0; None where there are no more."""
        return _ENDS_OF_VISITS[count] if count < len(_ENDS_OF_VISITS) else None

    @staticmethod
    def is_behind(number: int) -> bool:
        """Whether a number is that of such a label."""
        return number in _ENDS_OF_VISITS

    @staticmethod
    def stands_inside(number: int) -> bool:
        """Whether a label stands in the program itself, and not behind its end."""
        return number in _ENDS_OF_VISITS or number == Label.AIR


class ErrorText(IntEnum):
    """Numbers of the control's error texts that end a program early."""

    INPUT_VALUE_INCORRECT = 1011
    TOUCH_POINT_INACCESSIBLE = 1014


LENGTH_LIMIT = 1
"""By how much the probe's length may differ from the planned one, mm: the gap that is planned."""

CYCLE_NAMES = ("MEASURING IN 3D", "MEASURING IN 3-D")
DISTANCE_WORDS = ("SET UP", "ABST", "DIST")
"""Spellings of cycle 4 on different software; the first of each is the default."""


@dataclass(frozen=True)
class Dialect:
    """Words and numbers of one control and one workshop; the defaults are those of an iTNC 530."""

    language: Literal["klartext", "gcode"] = "klartext"  # in which blocks are spelt
    # name of cycle 4, after `4.0`; its number identifies the cycle
    cycle_name: str = CYCLE_NAMES[0]
    distance_word: str = DISTANCE_WORDS[0]  # before the longest path in `4.3`
    # folder of programs, masks and logs on the control; empty where it takes none
    folder: str = "TNC:\\MATSTD"
    tool: int = 30  # number of the probe in the tool table
    # row of the preset table; it stands at the origin of the table frame with every rotary axis at
    # zero
    preset: int = 1
    prefix: str = "MS"  # first letters of every program name
    # what Z of a touch in the log belongs to: the spindle's `gauge` point (no length compensation)
    # or the `tip` of the tool table. One touch settles it
    result_height: Literal["gauge", "tip"] = "gauge"
    log_decimals: int = 6  # decimals of coordinates in the log
    # feed of the second touch, mm/min, on a control that measures by a slow one
    slow_feed: float = 0.0
    step_back: float = 0.0  # from the surface before the second touch, mm
    has_planes: bool = True  # the control has PLANE SPATIAL
    # words after which the offset of a tilted head no longer enters positions, on machines with one
    head_off: tuple[str, ...] = ("M115", "M145")
    # programs use it: coordinates are those of planes tilted with the table
    is_tilted: bool = False
    is_oriented: bool = False  # programs orient the spindle after the call of the probe
    sensors: tuple[Sensor, ...] = ()  # temperatures that the control hands to programs

    def of_visit(self, longest: str) -> "Dialect":
        """The same for a planned visit: on the control the programs and logs of the run stay.

        Args:
            longest: What the longest name has behind its first letters and `_`, such as `A_LOC`.
                Where it is long, fewer letters of the run's names are left.

        Example:
            >>> [Dialect().of_visit(rest).prefix for rest in ("A_LOC", "CORNER_33_LOC")]
            ['MSV', 'MV']
        """
        before, visit, number = self.prefix.rpartition("V")
        is_of_visit = visit and (number.isdigit() or not number)
        own = f"V{int(number or 1) + 1}" if is_of_visit else "V"
        room = max(MAX_NAME - len(f"{own}_{longest}"), 0)
        return replace(self, prefix=(before if is_of_visit else self.prefix)[:room] + own)

    def on_control(self, name: str) -> str:
        """Full name of a file on the control."""
        return f"{self.folder}\\{name}" if self.folder else name
