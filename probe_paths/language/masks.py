"""Lines of a log: written as mask files of FN 16, read strictly, filled in as a control would."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum
from pathlib import Path
from typing import NamedTuple

from matstd.probe_paths.language.dialect import TOOL_LENGTH, Q
from matstd.probe_paths.language.text import MAX_LINE, checked_name
from matstd.probe_paths.plan import Sensor
from matstd.twin.errors import BadFile, DesignError


class SharedMask(StrEnum):
    """Names of the masks that all programs share, without their ending."""

    POINT = "MSPOINT"
    END = "MSEND"
    NO_CONTACT = "MSMISS"


LOG_HEAD = "MATSTD LOG 1"  # first line of every part of a log

_LINE = re.compile(r'"(?P<text>[^"]*)"(?P<arguments>(,[A-Z0-9]+)*);\Z')
_FORMAT = re.compile(r"%(\d+)(?:\.(\d+))?(LF|d)")
_CLOCK: dict[str, Callable[[datetime], int]] = {
    "DAY": lambda now: now.day,
    "MONTH": lambda now: now.month,
    "YEAR4": lambda now: now.year,
    "HOUR": lambda now: now.hour,
    "MIN": lambda now: now.minute,
    "SEC": lambda now: now.second,
    "CALENDAR": lambda now: 10_000 * now.year + 100 * now.month + now.day,
    "SECONDS": lambda now: 3600 * now.hour + 60 * now.minute + now.second,
}
"""What a clock can be asked for: SECONDS of the day, CALENDAR as one number 20310506."""

_SENSORS_A_LINE = 4

LINE_END = "\r\n"

Fields = tuple[str, Sequence[str]]  # text with formats, and what they print


class LogForm(NamedTuple):
    """How a control prints clock and counters."""

    clock: Fields  # line of a time of day
    date: Sequence[Fields]  # lines of the day and the time in the head
    counter: str  # format of whole numbers
    is_wide: bool  # whether numbers are printed in columns
    opens: str = ""  # word of a mask that adds to a file of an earlier run, or ""
    closes: str = ""  # word of a mask that closes the file, or ""


KEYWORDS = ("M_APPEND", "M_CLOSE")  # words of a mask that print nothing: what becomes of the file


@dataclass(frozen=True)
class MaskLine:
    """One line of a mask: literal text with formats, and what they print; or a keyword."""

    text: str  # with `%w.dLF` and `%wd` formats
    arguments: tuple[int | str, ...]  # Q numbers, or words of the date

    @property
    def prints(self) -> bool:
        """Whether the line is printed; a keyword is not."""
        return self.text not in KEYWORDS

    def filled(self, values: Mapping[int, float], now: datetime) -> str:
        """The line as the control prints it."""
        numbers = iter(self.arguments)

        def one(match: re.Match[str]) -> str:
            width, decimals, kind = match.groups()
            argument = next(numbers)
            if isinstance(argument, str):
                return f"{_CLOCK[argument](now):{width}{'d' if kind == 'd' else f'.{decimals}f'}}"
            shape = f"{width}.0f" if kind == "d" else f"{width}.{decimals or 0}f"
            return f"{values[argument] + 0.0:{shape}}"

        return _FORMAT.sub(one, self.text)


def parse_mask(text: str, path: str | Path) -> tuple[MaskLine, ...]:
    """Lines of a mask file.

    Raises:
        BadFile: Anything but `"text with formats",Q..,Q..;` lines whose arguments match.
    """
    lines = []
    for number, raw in enumerate(text.splitlines(), start=1):
        # keywords stand without quotes: M_CLOSE;
        if (word := raw.strip().removesuffix(";")) in KEYWORDS and raw.strip() != word:
            lines.append(MaskLine(word, ()))
            continue
        match = _LINE.match(raw.strip())
        if match is None:
            raise BadFile(path, number, repr(raw), '"text",Q1620,HOUR; with quotes and semicolon')
        words = match["arguments"].split(",")[1:]
        arguments = tuple(_argument(word, path, number) for word in words)
        formats, signs = _FORMAT.findall(match["text"]), match["text"].count("%")
        if not len(formats) == signs == len(arguments):
            found = f"{signs} formats for {len(arguments)} values"
            raise BadFile(path, number, found, "one format such as %13.6LF or %3d for each value")
        lines.append(MaskLine(match["text"], arguments))
    if not lines:
        raise BadFile(path, "file", "no line", "at least one line of text")
    return tuple(lines)


def _argument(word: str, path: str | Path, where: int) -> int | str:
    if word in _CLOCK:
        return word
    if re.fullmatch(r"Q\d{1,4}", word):
        return int(word[1:])
    raise BadFile(path, where, word, f"a Q parameter or one of {', '.join(_CLOCK)}")


def _mask(lines: Sequence[Fields]) -> str:
    """Text of a mask file; raises DesignError where a line is too long."""
    out = []
    for text, arguments in lines:
        if text in KEYWORDS:
            out.append(f"{text};")
            continue
        line = f'"{text}"' + "".join(f",{a}" for a in arguments) + ";"
        if len(line) > MAX_LINE or not line.isascii() or '"' in text:
            raise DesignError(f"mask line {line}: expected ASCII, at most {MAX_LINE} characters")
        out.append(line)
    return LINE_END.join(out) + LINE_END


def shared_masks(
    form: LogForm, decimals: int, rotary: Sequence[str], sensors: Sequence[Sensor] = ()
) -> dict[str, str]:
    """Masks that every program of a campaign uses, by file name; `sensors` are logged, too."""
    clock = form.clock
    missed = _fields([("NOCONTACT P", Q.TOUCH)], form.counter)
    return {
        f"{SharedMask.POINT}.A": _mask(_point_lines(form, decimals, rotary, sensors)),
        f"{SharedMask.END}.A": _mask([(f"END {clock[0]}", clock[1]), *_keyword(form.closes)]),
        f"{SharedMask.NO_CONTACT}.A": _mask([missed, clock, *_keyword(form.closes)]),
    }


def _keyword(word: str) -> list[Fields]:
    """A line of its own for a keyword that the control has."""
    return [(word, ())] if word else []


def _point_lines(
    form: LogForm, decimals: int, rotary: Sequence[str], sensors: Sequence[Sensor] = ()
) -> list[Fields]:
    number = _number(form, decimals)
    side = "%5.1LF" if form.is_wide else form.counter
    sides = [Q.SIDE_1, Q.SIDE_2][: len(rotary)]
    places = [Q.ROTARY_1, Q.ROTARY_2][: len(rotary)]
    counters = [("P", Q.TOUCH), ("S", Q.POSE), ("F", Q.FEATURE)]
    came_from = [("U" + a, q) for a, q in zip(rotary, sides, strict=True)]
    turned = [(a, q) for a, q in zip(rotary, places, strict=True)]
    measured = [("X", Q.RESULT_X), ("Y", Q.RESULT_Y), ("Z", Q.RESULT_Z)]
    point: list[Fields] = [_fields(counters, form.counter), _fields(measured, number)]
    if turned:
        point += [_fields(turned, number), _fields(came_from, side)]
    read = [(sensor.word, sensor.parameter) for sensor in sensors]
    lots = [read[i : i + _SENSORS_A_LINE] for i in range(0, len(read), _SENSORS_A_LINE)]
    return [*point, *(_fields(lot, "%11.4LF") for lot in lots), form.clock]


def _number(form: LogForm, decimals: int) -> str:
    """Format of a coordinate: a sign, five digits, a point and the decimals, in a column."""
    return f"%{decimals + 7 if form.is_wide else 1}.{decimals}LF"


def _fields(named: Sequence[tuple[str, int]], form: str) -> tuple[str, list[str]]:
    return " ".join(name + form for name, _ in named), [f"Q{int(q)}" for _, q in named]


def head_mask(
    form: LogForm,
    name: str,
    remarks: Sequence[str],
    rotary: Sequence[str] | None = None,
    decimals: int = 6,
) -> str:
    """Mask of one program's head: what was planned, then the calibration of the probe.

    Args:
        remarks: Lines of the program's own head (standard, set-up), printed as they are.
        rotary: Letters of the machine's rotary axes: then one touch and the end follow, which is
            the whole log of a commissioning program.
        decimals: Decimals of the coordinates of that touch.
    """
    lines = [*_keyword(form.opens), *_head_lines(form, name, remarks)]
    if rotary is not None:
        lines += [*_point_lines(form, decimals, rotary), (f"END {form.clock[0]}", form.clock[1])]
        lines += _keyword(form.closes)
    return _mask(lines)


def _head_lines(form: LogForm, name: str, remarks: Sequence[str]) -> list[Fields]:
    checked_name(name)
    number = _number(form, 6)
    lines: list[Fields] = [(LOG_HEAD, ()), (f"PGM {name}", ())]
    lines += [(remark, ()) for remark in remarks]
    return [
        *lines,
        *form.date,
        _fields([("TOOL", Q.TOOL), ("PRESET", Q.PRESET)], form.counter),
        _fields([("R", Q.PROBE_RADIUS), ("L", Q.PROBE_LENGTH)], number),
        _fields([("EX", Q.OFFSET_X), ("EY", Q.OFFSET_Y), ("TL", TOOL_LENGTH)], number),
    ]
