"""What differs between controls and workshops, and which Q parameters our programs use."""

from dataclasses import dataclass, field
from enum import IntEnum
from typing import Literal

from probe_paths.language.klartext import ProbeWords


class Q(IntEnum):
    """Parameters of our programs, all in Q1600-Q1999, which no cycle and no builder uses."""

    PROBE_RADIUS = 1601
    PROBE_LENGTH = 1602
    OFFSET_X = 1603
    OFFSET_Y = 1604
    TOOL = 1605
    PRESET = 1606
    LENGTH_OFF = 1607
    RESULT_X = 1610
    RESULT_Y = 1611
    RESULT_Z = 1612
    STATUS = 1613
    TOUCH = 1620
    POSE = 1621
    FEATURE = 1622
    SIDE_1 = 1623
    SIDE_2 = 1624
    ROTARY_1 = 1631
    ROTARY_2 = 1632


TOOL_LENGTH = 114
"""Parameter in which the control keeps the length of the called tool, as in the tool table."""

FREE = range(1600, 2000)
"""Parameters that a program may write."""

SYSTEM_INDEX = {letter: i + 1 for i, letter in enumerate("XYZABCUVW")}
"""Order of the axes in the control's system data (IDX of ID240)."""


class Label(IntEnum):
    """Subprograms of our programs."""

    LOG = 90
    NO_CONTACT = 91
    OTHER_PROBE = 92


class ErrorText(IntEnum):
    """Numbers of the control's error texts that end a program early."""

    INPUT_VALUE_INCORRECT = 1011
    TOUCH_POINT_INACCESSIBLE = 1014


LENGTH_LIMIT = 1
"""By how much the probe's length may differ from the planned one, mm: the gap that is planned."""


@dataclass(frozen=True)
class Dialect:
    """Words and numbers of one control and one workshop.

    Attributes:
        words: Spelling of cycle 4.
        folder: Of programs, masks and logs on the control.
        tool: Number of the probe in the tool table.
        preset: Row of the preset table; it stands at the origin of the table frame with every
            rotary axis at zero.
        prefix: First letters of every program name.
        result_height: What Z of cycle 4 belongs to: the spindle's `gauge` point (no length
            compensation) or the `tip` of the tool table. One touch on the machine settles it.
        log_decimals: Of coordinates in the log.
    """

    words: ProbeWords = field(default_factory=ProbeWords)
    folder: str = "TNC:\\MATSTD"
    tool: int = 30
    preset: int = 1
    prefix: str = "MS"
    result_height: Literal["gauge", "tip"] = "gauge"
    log_decimals: int = 6

    def on_control(self, name: str) -> str:
        """Full name of a file on the control."""
        return f"{self.folder}\\{name}"
