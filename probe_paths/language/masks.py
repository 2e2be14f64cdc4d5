"""Mask files of FN 16: written, read strictly, and filled in as the control would."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum
from pathlib import Path

from probe_paths.language.dialect import TOOL_LENGTH, Dialect, Q
from probe_paths.language.klartext import LINE_END, MAX_LINE, checked_name
from twin.errors import BadFile, DesignError


class SharedMask(StrEnum):
    """Names of the masks that all programs share, without their ending."""

    POINT = "MSPOINT"
    END = "MSEND"
    NO_CONTACT = "MSMISS"


LOG_HEAD = "MATSTD LOG 1"
"""First line of every part of a log."""

_LINE = re.compile(r'"(?P<text>[^"]*)"(?P<arguments>(,[A-Z0-9]+)*);\Z')
_FORMAT = re.compile(r"%(\d+)(?:\.(\d+))?(LF|d)")
_CLOCK = {
    "DAY": "day",
    "MONTH": "month",
    "YEAR4": "year",
    "HOUR": "hour",
    "MIN": "minute",
    "SEC": "second",
}


@dataclass(frozen=True)
class MaskLine:
    """One line of a mask: literal text with formats, and what they print.

    Attributes:
        text: With `%w.dLF` and `%wd` formats.
        arguments: Q numbers, or words of the date.
    """

    text: str
    arguments: tuple[int | str, ...]

    def filled(self, values: Mapping[int, float], now: datetime) -> str:
        """The line as the control prints it."""
        numbers = iter(self.arguments)

        def one(match: re.Match[str]) -> str:
            width, decimals, kind = match.groups()
            argument = next(numbers)
            if isinstance(argument, str):
                return f"{getattr(now, _CLOCK[argument]):{width}d}"
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
        where = f"line {number}"
        match = _LINE.match(raw.strip())
        if match is None:
            raise BadFile(path, where, repr(raw), '"text",Q1620,HOUR; with quotes and semicolon')
        arguments = tuple(
            _argument(word, path, where) for word in match["arguments"].split(",")[1:]
        )
        formats = _FORMAT.findall(match["text"])
        if len(formats) != match["text"].count("%") or len(formats) != len(arguments):
            raise BadFile(
                path,
                where,
                f"{match['text'].count('%')} formats for {len(arguments)} values",
                "one format such as %13.6LF or %3d for each value",
            )
        lines.append(MaskLine(match["text"], arguments))
    if not lines:
        raise BadFile(path, "file", "no line", "at least one line of text")
    return tuple(lines)


def _argument(word: str, path: str | Path, where: str) -> int | str:
    if word in _CLOCK:
        return word
    if re.fullmatch(r"Q\d{1,4}", word):
        return int(word[1:])
    raise BadFile(path, where, word, f"a Q parameter or one of {', '.join(_CLOCK)}")


def _mask(lines: Sequence[tuple[str, Sequence[str]]]) -> str:
    """Text of a mask file; raises DesignError where a line is too long."""
    out = []
    for text, arguments in lines:
        line = f'"{text}"' + "".join(f",{a}" for a in arguments) + ";"
        if len(line) > MAX_LINE or not line.isascii() or '"' in text:
            raise DesignError(f"mask line {line}: expected ASCII, at most {MAX_LINE} characters")
        out.append(line)
    return LINE_END.join(out) + LINE_END


def _q(parameter: int) -> str:
    return f"Q{int(parameter)}"


def shared_masks(dialect: Dialect, rotary: Sequence[str]) -> dict[str, str]:
    """Masks that every program of a campaign uses, by file name.

    Args:
        rotary: Letters of the machine's rotary axes.
    """
    d = dialect.log_decimals
    sides = [Q.SIDE_1, Q.SIDE_2][: len(rotary)]
    places = [Q.ROTARY_1, Q.ROTARY_2][: len(rotary)]
    counters = [("P", Q.TOUCH), ("S", Q.POSE), ("F", Q.FEATURE)]
    came_from = [("U" + a, q) for a, q in zip(rotary, sides, strict=True)]
    turned = [(a, q) for a, q in zip(rotary, places, strict=True)]
    measured = [("X", Q.RESULT_X), ("Y", Q.RESULT_Y), ("Z", Q.RESULT_Z)]
    clock = ("T%3d:%3d:%3d", ("HOUR", "MIN", "SEC"))
    point = [_fields(counters, "%8.1LF"), _fields(measured, f"%{d + 7}.{d}LF")]
    if turned:
        point += [_fields(turned, f"%{d + 7}.{d}LF"), _fields(came_from, "%5.1LF")]
    return {
        f"{SharedMask.POINT}.A": _mask([*point, clock]),
        f"{SharedMask.END}.A": _mask([("END T%3d:%3d:%3d", clock[1])]),
        f"{SharedMask.NO_CONTACT}.A": _mask([_fields([("NOCONTACT P", Q.TOUCH)], "%8.1LF"), clock]),
    }


def _fields(named: Sequence[tuple[str, int]], form: str) -> tuple[str, list[str]]:
    return " ".join(name + form for name, _ in named), [_q(q) for _, q in named]


def head_mask(name: str, remarks: Sequence[str]) -> str:
    """Mask of one program's head: what was planned, then the calibration of the probe.

    Args:
        name: Of the program.
        remarks: Lines of the program's own head (standard, set-up), printed as they are.
    """
    checked_name(name)
    lines: list[tuple[str, Sequence[str]]] = [(LOG_HEAD, ()), (f"PGM {name}", ())]
    lines += [(remark, ()) for remark in remarks]
    lines += [
        ("DATE%5d-%3d-%3d", ("YEAR4", "MONTH", "DAY")),
        ("T%3d:%3d:%3d", ("HOUR", "MIN", "SEC")),
        _fields([("TOOL", Q.TOOL), ("PRESET", Q.PRESET)], "%8.1LF"),
        _fields([("R", Q.PROBE_RADIUS), ("L", Q.PROBE_LENGTH)], "%13.6LF"),
        _fields([("EX", Q.OFFSET_X), ("EY", Q.OFFSET_Y), ("TL", TOOL_LENGTH)], "%13.6LF"),
    ]
    return _mask(lines)
