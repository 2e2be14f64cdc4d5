"""Reads the log that FN 16 of our programs writes, on a control or in the simulator."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np

from probe_paths.language import LOG_HEAD
from probe_paths.plan import Heading, parse_heading
from twin.errors import BadFile
from twin.frames import Array
from twin.record import IntArray

LARGEST = 1e6
"""A coordinate (mm, degrees) or a number of a touch beyond this was not logged by our programs."""

_PAIR = re.compile(r"([A-Z]+)\s*([-+]?\d+(?:\.\d+)?)(?=\s|\Z)")
_CLOCK = re.compile(r"(?:END )?T *(\d{1,2}): *(\d{1,2}): *(\d{1,2})\Z")
_DATE = re.compile(r"DATE *(\d{4})- *(\d{1,2})- *(\d{1,2})\Z")


@dataclass(frozen=True, eq=False)
class LogPart:
    """What one run of one program logged.

    Attributes:
        path: Of the log file.
        program: Name of the program.
        heading: Standard, set-up and probe as planned.
        begin: When the program was started.
        radius: Of the ball as calibrated, mm.
        tool_length: As calibrated, mm; that of the tool table where the control keeps none.
        offset: Of the ball from the spindle axis as calibrated, (2,), mm; the control has already
            corrected X and Y by it.
        line: Of each touch in the file, (N,).
        number: Of each touch, (N,).
        pose: Number of the table pose, (N,).
        feature: Number of the feature, (N,).
        xyz: As the cycle returned them, (N, 3), mm.
        rotary: Rotary positions by letter, degrees, each (N,).
        side: Side that each rotary axis came from, by letter, each (N,).
        time: s since `begin`, (N,).
        is_complete: The program ran to its end.
    """

    path: Path
    program: str
    heading: Heading
    begin: datetime
    radius: float
    tool_length: float
    offset: Array
    line: IntArray
    number: IntArray
    pose: IntArray
    feature: IntArray
    xyz: Array
    rotary: Mapping[str, Array]
    side: Mapping[str, Array]
    time: Array
    is_complete: bool


def read_log(path: str | Path, rotary: Sequence[str], text: str | None = None) -> list[LogPart]:
    """Parts of a log file; a program that was run again appends a further part.

    Args:
        path: The log file.
        rotary: Letters of the machine's rotary axes.
        text: Its text where it is already at hand.

    Raises:
        BadFile: A line missing, cut off or spelt otherwise.
    """
    path = Path(path)
    if text is None:
        try:
            text = path.read_bytes().decode("ascii")
        except (OSError, UnicodeDecodeError) as error:
            raise BadFile(path, "file", str(error), "a log in ASCII") from None
    if text and not text.endswith("\n"):
        last = text.count("\n") + 1
        raise BadFile(path, f"line {last}", "a line cut off", "a line end: copy the whole log")
    reader = _Reader(path, text.splitlines(), rotary)
    parts = []
    while not reader.is_at_end:
        parts.append(reader.part())
    if not parts:
        raise BadFile(path, "line 1", "nothing", LOG_HEAD)
    return parts


class _Reader:
    """Goes through the lines of a log; blank lines do not count."""

    def __init__(self, path: Path, lines: list[str], rotary: Sequence[str]) -> None:
        self.path, self.rotary = path, tuple(rotary)
        self.lines = [(i, s.strip()) for i, s in enumerate(lines, start=1) if s.strip()]
        self.place = 0

    @property
    def is_at_end(self) -> bool:
        return self.place == len(self.lines)

    def refusal(self, found: str, expected: str) -> BadFile:
        line = self.lines[min(self.place, len(self.lines) - 1)][0] if self.lines else 1
        return BadFile(self.path, f"line {line}", found, expected)

    def peek(self, expected: str) -> str:
        """The line to be read next; refuses the end of the file."""
        if self.is_at_end:
            raise self.refusal("the end of the file", expected)
        return self.lines[self.place][1]

    def taken(self, expected: str) -> str:
        text = self.peek(expected)
        self.place += 1
        return text

    def pairs(self, names: Sequence[str]) -> list[float]:
        """A line of names and numbers, exactly these names."""
        expected = " ".join(f"{n} <number>" for n in names)
        text = self.peek(expected)
        found = _PAIR.findall(text)
        rest = _PAIR.sub("", text).strip()
        if rest or [n for n, _ in found] != list(names):
            raise self.refusal(repr(text), expected)
        numbers = [float(v) for _, v in found]
        if any(abs(number) > LARGEST for number in numbers):
            raise self.refusal(repr(text), f"numbers below {LARGEST:g}")
        self.place += 1
        return numbers

    def clock(self, day: datetime, after: datetime | None) -> datetime:
        """A time of day, on the day of `after` or, past midnight, on the next one."""
        match = _CLOCK.match(self.peek("T <h>:<m>:<s>"))
        if match is None:
            raise self.refusal(repr(self.lines[self.place][1]), "T <h>:<m>:<s>")
        hour, minute, second = (int(v) for v in match.groups())
        try:
            now = (after or day).replace(hour=hour, minute=minute, second=second)
        except ValueError:
            raise self.refusal(repr(match[0]), "a time of day") from None
        self.place += 1
        return now + timedelta(days=1) if after is not None and now < after else now

    def part(self) -> LogPart:
        """One run of a program."""
        if self.taken(LOG_HEAD) != LOG_HEAD:
            self.place -= 1
            raise self.refusal(repr(self.lines[self.place][1]), LOG_HEAD)
        words = self.taken("PGM <name>").split()
        if len(words) != 2 or words[0] != "PGM":
            self.place -= 1
            raise self.refusal(repr(" ".join(words)), "PGM <name>")
        heading = parse_heading(self.lines[self.place : self.place + 4], self.path)
        self.place += 4
        match = _DATE.match(self.peek("DATE <y>-<m>-<d>"))
        if match is None:
            raise self.refusal(repr(self.lines[self.place][1]), "DATE <y>-<m>-<d>")
        try:
            day = datetime(int(match[1]), int(match[2]), int(match[3]))
        except ValueError:
            raise self.refusal(repr(match[0]), "a date") from None
        self.place += 1
        begin = self.clock(day, None)
        self.pairs(("TOOL", "PRESET"))
        radius, tool_length = self.pairs(("R", "L"))
        *offset, table_length = self.pairs(("EX", "EY", "TL"))
        rows, is_complete = self._touches(begin)
        table = np.array([row[1] for row in rows]).reshape(len(rows), -1)
        return _part(
            self.path, words[1], heading, begin, (radius, tool_length or table_length), offset,
            np.array([row[0] for row in rows], dtype=np.int64), table, self.rotary, is_complete,
        )  # fmt: skip

    def _touches(self, begin: datetime) -> tuple[list[tuple[int, list[float]]], bool]:
        """Rows of touches until END or NOCONTACT, or for want of them the end of what was logged.

        A program that the operator stopped leaves neither: its whole touches count, and the next
        line, if any, begins the next run.
        """
        rows: list[tuple[int, list[float]]] = []
        now = begin
        while True:
            if rows and (self.is_at_end or self.lines[self.place][1] == LOG_HEAD):
                return rows, False
            text = self.peek("P <number> S <number> F <number>, END or NOCONTACT")
            if text.startswith("END "):
                self.clock(now, now)
                return rows, True
            if text.startswith("NOCONTACT"):
                self.place += 1
                self.clock(now, now)
                return rows, False
            line = self.lines[self.place][0]
            row = self.pairs(("P", "S", "F")) + self.pairs(("X", "Y", "Z"))
            if self.rotary:
                row += self.pairs(self.rotary) + self.pairs([f"U{a}" for a in self.rotary])
            now = self.clock(now, now)
            rows.append((line, [*row, (now - begin).total_seconds()]))


def _part(
    path: Path,
    program: str,
    heading: Heading,
    begin: datetime,
    calibration: tuple[float, float],
    offset: Sequence[float],
    line: IntArray,
    table: Array,
    rotary: Sequence[str],
    is_complete: bool,
) -> LogPart:
    """A part from the table of its touches, one row each."""
    count = len(rotary)
    table = table if len(table) else np.zeros((0, 7 + 2 * count))
    whole = table[:, :3].astype(np.int64)
    return LogPart(
        path=path,
        program=program,
        heading=heading,
        begin=begin,
        radius=calibration[0],
        tool_length=calibration[1],
        offset=np.array(offset),
        line=line,
        number=whole[:, 0],
        pose=whole[:, 1],
        feature=whole[:, 2],
        xyz=table[:, 3:6],
        rotary={a: table[:, 6 + i] for i, a in enumerate(rotary)},
        side={a: table[:, 6 + count + i] for i, a in enumerate(rotary)},
        time=table[:, -1],
        is_complete=is_complete,
    )
