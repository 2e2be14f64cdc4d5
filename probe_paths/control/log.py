"""Reads the log that our programs write, on a control or in the simulator.

A log costs half an hour of machine time. A line that is unreadable, truncated or foreign therefore
loses only the touch that it belongs to, with a remark. Only set-up, probe and calibration in the
head of a part are indispensable, as no touch can be evaluated without them.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime, timedelta
from itertools import pairwise
from pathlib import Path

import numpy as np

from matstd.probe_paths.control.clock import LogClock
from matstd.probe_paths.language import LOG_HEAD
from matstd.probe_paths.plan import Heading, parse_heading
from matstd.twin.errors import BadFile
from matstd.twin.frames import Array, IntArray
from matstd.twin.units import DAY
from matstd.twin.words import not_read

LARGEST_COORDINATE = 1e6

"""A coordinate (mm, degrees) or a number of a touch beyond this was not logged by our programs."""

_PAIR = re.compile(r"([A-Z]+)\s*([-+]?\d+(?:\.\d+)?)(?=\s|\Z)")
_CLOCK = re.compile(r"(?:END )?T *(\d{1,2}): *(\d{1,2}): *(\d{1,2})\Z")
_WHOLE_CLOCK = len("T  0:  0:  0")
_SECONDS = re.compile(r"(?:END )?T *(\d{1,5})\.\d*\Z")
_DATE = re.compile(r"DATE *(\d{4})(?:- *(\d{1,2})- *(\d{1,2})|(\d\d)(\d\d)\.0*)\Z")
_TOUCH = re.compile(r"P\s*[-+]?\d")
_COMMA = re.compile(r"(?<=\d),(?=\d)")
_VERSION = re.compile(r"MATSTD LOG \d+\Z")

UNDATED = datetime(1900, 1, 1)
"""Begin of a part whose date cannot be read: no sensor record covers it."""

BALL, FIRST = "CAL", "COM"
"""Last letters of the names of programs that measure nothing: touches on one ball before and after
the others, and one touch that a control is tried with."""

Line = tuple[int, str]  # number in the file and text


@dataclass(frozen=True, eq=False)
class LogPart:
    """What one run of one program logged."""

    path: Path
    program: str
    heading: Heading  # standard, set-up and probe as planned
    begin: datetime  # when the program was started; `UNDATED` where its date cannot be read
    radius: float  # calibrated radius of the ball, mm
    tool_length: float  # as calibrated, mm; that of the tool table where the control keeps none
    # calibrated offset of the ball from the spindle axis, mm; the control has already corrected X
    # and Y by it
    offset: float
    line: IntArray
    number: IntArray
    pose: IntArray
    feature: IntArray
    xyz: Array  # as the cycle returned them, (N, 3), mm
    rotary: Mapping[str, Array]  # rotary positions by letter, degrees, each (N,)
    side: Mapping[str, Array]  # side that each rotary axis came from, by letter, each (N,)
    time: Array  # s since `begin`, (N,); never falling
    is_complete: bool
    remarks: tuple[str, ...] = ()  # what was left out or mended, one line each
    # number of the tool as the control had it; None where the line was lost
    tool: float | None = None
    # number of the preset that the program selected; None where the line was lost
    preset: float | None = None
    # degC by sensor, each (N,); nan where a line could not be read
    temperature: Mapping[str, Array] = field(default_factory=dict)

    @property
    def is_ball(self) -> bool:
        """Whether its touches are those on a ball that show whether the probe has changed."""
        return self.program.endswith(f"_{BALL}")

    @property
    def is_first(self) -> bool:
        """Whether it is that of a commissioning program."""
        return self.program.endswith(f"_{FIRST}")

    @property
    def is_measuring(self) -> bool:
        """Whether its touches are measurements."""
        return not (self.is_ball or self.is_first)


def read_log(path: str | Path, rotary: Sequence[str], text: str | None = None) -> list[LogPart]:
    """Parts of a log file; a program that was run again appends a further part.

    Raises:
        BadFile: No part of the log has a head that can be read, or it is a log of another kind.
    """
    path = Path(path)
    lines = _lines(path, text)
    starts = [i for i, line in enumerate(lines) if _begins_part(lines, i, line[1])]
    if not starts:
        raise BadFile(path, 1, repr(lines[0][1]) if lines else "nothing", LOG_HEAD)
    parts: list[LogPart] = []
    refused: list[BadFile] = []
    for begin, end in pairwise([*starts, len(lines)]):
        if lines[begin][1] != LOG_HEAD and _VERSION.match(lines[begin][1]):
            raise BadFile(path, lines[begin][0], repr(lines[begin][1]), LOG_HEAD)
        try:
            parts.append(_PartReader(path, lines[begin:end], rotary).part())
        except BadFile as error:
            refused.append(error)
    if not any(len(part.number) for part in parts) and refused:
        raise refused[0]
    more = [f"{error}; the touches of this part are left out" for error in refused]
    if starts[0]:
        more.append(f"lines 1 to {lines[starts[0] - 1][0]} stand before the head and are left out")
    return [replace(parts[0], remarks=(*more, *parts[0].remarks)), *parts[1:]]


def _lines(path: Path, text: str | None) -> list[Line]:
    """Non-blank lines with decimal points; a truncated last line is marked."""
    if text is None:
        try:
            data = path.read_bytes()
        except OSError as error:
            raise BadFile(path, "file", not_read(path, error), "a log") from None
        # an editor may have changed the encoding; a non-ASCII character corrupts its line only
        encoding = "utf-16" if data[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig"
        text = data.decode(encoding, errors="replace")
    lines = [_COMMA.sub(".", line) for line in re.split(r"\r\n|\n|\r", text)]
    # after a line end the last of these is empty; a clock may have lost its last digit
    if lines[-1].strip() and not re.match(rf"(END )?T.{{{_WHOLE_CLOCK - 1}}}\Z", lines[-1]):
        lines[-1] = f"{lines[-1]} (cut off)"
    return [(i, s.strip()) for i, s in enumerate(lines, start=1) if s.strip()]


def _begins_part(lines: Sequence[Line], i: int, text: str) -> bool:
    """Whether a line begins a part: the head line, or the program's name if that is corrupted."""
    if _VERSION.match(text):
        return True
    return text.startswith("PGM ") and (i == 0 or not _VERSION.match(lines[i - 1][1]))


class _PartReader:
    """Reads one run of a program, line by line."""

    def __init__(self, path: Path, lines: Sequence[Line], rotary: Sequence[str]) -> None:
        self.path, self.lines, self.rotary = path, list(lines), tuple(rotary)
        self.place = 0
        self.remarks: list[str] = []
        self.sensed: list[list[str]] = []
        self.names = [["P", "S", "F"], ["X", "Y", "Z"]]
        if rotary:
            self.names += [list(rotary), [f"U{a}" for a in rotary]]

    def part(self) -> LogPart:
        """The part; raises BadFile whose head lacks set-up, probe or calibration."""
        if self.lines[0][1] == LOG_HEAD:
            self.place = 1
        words = self._peek("PGM <name>").split()
        if len(words) != 2 or words[0] != "PGM":
            raise self._refusal("PGM <name>")
        self.place += 1
        heading, count = parse_heading(self.lines[self.place :], self.path)
        self.place += count
        sensed = [sensor.word for sensor in heading.sensors]
        self.sensed = [sensed[i : i + 4] for i in range(0, len(sensed), 4)]
        self.names += self.sensed
        day, start = self._date(), self._head_clock()
        tool, preset = self._pairs(("TOOL", "PRESET"), is_needed=False) or (None, None)
        calibration = self._pairs(("R", "L"))
        assert calibration is not None
        # a control that keeps no calibrated length logs that of the tool table
        offset = self._pairs(("EX", "EY", "TL"), is_needed=False) or [0.0, 0.0, 0.0]
        clock = LogClock(start)
        rows, is_complete = self._touches(clock)
        begin = (day or UNDATED) + timedelta(seconds=clock.start or 0)
        count = 6 + 2 * len(self.rotary)
        table = np.array([row for _, row in rows]).reshape(len(rows), count + len(sensed) + 1)
        return LogPart(
            path=self.path,
            program=words[1],
            heading=heading,
            begin=begin,
            radius=calibration[0],
            tool_length=calibration[1] or offset[2],
            offset=float(np.hypot(offset[0], offset[1])),
            line=np.array([line for line, _ in rows], dtype=np.int64),
            number=table[:, 0].astype(np.int64),
            pose=table[:, 1].astype(np.int64),
            feature=table[:, 2].astype(np.int64),
            xyz=table[:, 3:6],
            rotary={a: table[:, 6 + i] for i, a in enumerate(self.rotary)},
            side={a: table[:, 6 + len(self.rotary) + i] for i, a in enumerate(self.rotary)},
            time=table[:, -1],
            is_complete=is_complete,
            remarks=(*self.remarks, *clock.remarks),
            tool=tool,
            preset=preset,
            temperature={
                sensor.name: sensor.factor * table[:, count + i] + sensor.offset
                for i, sensor in enumerate(heading.sensors)
            },
        )

    def _peek(self, expected: str) -> str:
        """The next line; refuses the end of the part."""
        if self.place >= len(self.lines):
            raise BadFile(self.path, self.lines[-1][0], "the end of the part after it", expected)
        return self.lines[self.place][1]

    def _refusal(self, expected: str) -> BadFile:
        line, text = self.lines[self.place]
        return BadFile(self.path, line, repr(text), expected)

    def _date(self) -> datetime | None:
        """Day of the head; None, and a remark, where it cannot be read."""
        match = _DATE.match(self._peek("DATE <y>-<m>-<d>"))
        try:
            day = None
            if match:  # as 2031-05-06, or as one number
                month = int(match[2] or match[4])
                day = datetime(int(match[1]), month, int(match[3] or match[5]))
        except ValueError:
            day = None
        if day is None:
            line, text = self.lines[self.place]
            self.remarks.append(f"line {line}: {text!r} is no date; the run is without a date")
        self.place += day is not None or text.startswith("DATE")
        return day

    def _head_clock(self) -> int | None:
        """Time of day of the head; None, and a remark, where that of the first touch is taken."""
        now = _time_of_day(self._peek("T <h>:<m>:<s>"))
        if now is None:
            line, text = self.lines[self.place]
            self.remarks.append(f"line {line}: {text!r} is no time; the first touch's is taken")
        self.place += now is not None or self.lines[self.place][1].startswith("T ")
        return now

    def _pairs(self, names: Sequence[str], is_needed: bool = True) -> list[float] | None:
        """Numbers of a line of the head; None, and a remark, where it is not needed."""
        expected = " ".join(f"{n} <number>" for n in names)
        values = _numbers(self._peek(expected), names)
        if values is None and is_needed:
            raise self._refusal(expected)
        line, text = self.lines[self.place]
        if values is None:
            self.remarks.append(f"line {line}: {text!r}, expected {expected}; it is left out")
        self.place += values is not None or text.startswith(names[0])
        return values

    def _touches(self, clock: LogClock) -> tuple[list[tuple[int, list[float]]], bool]:
        """Complete touches with their lines, and whether the program ran to its end."""
        rows: list[tuple[int, list[float]]] = []
        known: dict[float, list[float]] = {}
        is_complete = False
        while self.place < len(self.lines):
            line, text = self.lines[self.place]
            if text.startswith("END "):
                is_complete = _time_of_day(text) is not None
                self.place += 1
                if not is_complete:
                    self.remarks.append(f"line {line}: {text!r} is no end of a program")
            elif text.startswith("NOCONTACT"):
                self.place += 1
                if self.place < len(self.lines) and _time_of_day(self.lines[self.place][1]):
                    self.place += 1
            elif _TOUCH.match(text):
                row = self._touch()
                if row is None:
                    continue
                now, same = int(row.pop()), known.get(row[0])
                # of a touch that is logged twice the first counts
                if same is None:
                    known[row[0]] = row
                    rows.append((line, [*row, clock.elapsed(now, line)]))
                else:
                    what = "again" if same == row else "again with other numbers"
                    self.remarks.append(f"line {line}: touch {row[0]:.0f} {what}; the first counts")
            else:
                self._skip()
        return rows, is_complete

    def _touch(self) -> list[float] | None:
        """Numbers of one touch and its time of day; None, and a remark, for a corrupted line."""
        row: list[float] = []
        first = self.place
        for names in [*self.names, None]:
            is_end = self.place >= len(self.lines)
            line, text = self.lines[-1 if is_end else self.place]
            text = "the end of the part" if is_end else text
            if names is None:
                expected, now = "T <h>:<m>:<s>", _time_of_day(text)
                values = None if now is None else [float(now)]
            else:
                expected = " ".join(f"{n} <number>" for n in names)
                values = _numbers(text, names)
            found = f"line {line}: found {text!r}, expected {expected}"
            if values is None and names in self.sensed:  # a touch without it is a touch
                self.remarks.append(found)
                row += [np.nan] * len(names)
                self.place += text.startswith(names[0])
                continue
            if values is None or (names == ["P", "S", "F"] and not _are_counters(values)):
                begun = f"the touch that begins in line {self.lines[first][0]} is left out"
                self.remarks.append(f"{found}; {begun}")
                self.place = max(self.place, first + 1)
                self._to_next()
                return None
            row += values
            self.place += 1
        return row

    def _to_next(self) -> None:
        """Skip to the next line that begins a touch, an end or a missed touch."""
        while self.place < len(self.lines) and not _begins(self.lines[self.place][1]):
            self.place += 1

    def _skip(self) -> None:
        """Skip unrecognised lines with one remark."""
        line, text = self.lines[self.place]
        self.place += 1
        self._to_next()
        last = self.lines[self.place - 1][0]
        many = f"lines {line} to {last}" if last > line else f"line {line}"
        self.remarks.append(f"{many}: {text!r} is the beginning of no touch; left out")


def _begins(text: str) -> bool:
    return text.startswith(("END ", "NOCONTACT")) or _TOUCH.match(text) is not None


def _numbers(text: str, names: Sequence[str]) -> list[float] | None:
    """Numbers of a line with exactly these names; None for another line."""
    found = _PAIR.findall(text)
    if _PAIR.sub("", text).strip() or [n for n, _ in found] != list(names):
        return None
    numbers = [float(v) for _, v in found]
    return numbers if all(abs(number) < LARGEST_COORDINATE for number in numbers) else None


def _are_counters(values: Sequence[float]) -> bool:
    """Whether the numbers of touch, pose and feature are whole and positive."""
    return all(0.0 < v < 1e6 and v == int(v) for v in values)


def _time_of_day(text: str) -> int | None:
    """Seconds since midnight of a clock line, as `T h:m:s` or as seconds; None for another."""
    seconds = _SECONDS.match(text)
    if seconds is not None:
        return int(seconds[1]) if int(seconds[1]) < DAY else None
    match = _CLOCK.match(text)
    if match is None:
        return None
    hour, minute, second = (int(v) for v in match.groups())
    is_time = hour < 24 and minute < 60 and second < 60
    return 3600 * hour + 60 * minute + second if is_time else None
