"""TOML files of users: every fault is reported in one line."""

import math
import re
import tomllib
from pathlib import Path
from typing import Any

from matstd.twin.errors import BadFile
from matstd.twin.words import not_read

_NO_TEXT = {
    b"PK\x03\x04": "a zip archive, such as a workbook of Excel (save it as CSV)",
    b"\x89PNG": "a picture",
    b"%PDF": "a PDF",
    b"\xff\xfe": "text in UTF-16",
    b"\xfe\xff": "text in UTF-16",
}
"""First bytes of files that users take for text, and what they are."""

LARGEST_NUMBER = 1e18  # largest number in our files; the product of two such does not overflow
_MANY_DIGITS = re.compile(r"[\d_]{4300,}")
_TWICE = re.compile(r"Cannot declare \((.+?),?\) twice")
_STATEMENT = "one key = value, or one [table], on a line"
_GRAMMAR = {
    "Cannot overwrite": "every key once in its table",
    "Duplicate inline": "every key once in its table",
    "Cannot mutate": "every key once in its table",
    "Invalid value": 'a number, a "text", true, false or a [list] behind the =',
    "Unclosed array": "a ] behind the last value of a list, a comma between two",
    "Unclosed inline": "a } behind the last key of a table in one line, a comma between two",
    "Invalid date": "a date such as 2031-05-06",
    "Unescaped": "two backslashes for one in a text, or a text in single quotes",
    "Escaped": "two backslashes for one in a text, or a text in single quotes",
    "Invalid hex": "two backslashes for one in a text, or a text in single quotes",
    "Expected ']": "a ] behind the name of a table",
    "Unterminated": "a quotation mark at the end of a text",
    "Illegal character": "a quotation mark at the end of a text, and no control characters",
}
"""What is expected where a text is no TOML, by how the reader's reason begins."""

_KINDS = {
    "machine": ("a machine file", ""),
    "project": ("a project", "; matstd new project --machine MACHINE.toml proposes one"),
    "run": ("a run file", "; matstd import makes one of a table of measurements"),
    "model": ("a model", "; matstd diagnose RUN.csv writes one"),
    "standard": ("a standard", "; matstd design writes one"),
    "errors": ("a file of errors", ""),
    "task": ("a measuring task", ""),
    "dialect": ("a dialect of a control", ""),
    "import": ("a mapping file", ""),
}
"""Kinds of files, each with how a user comes by one."""

_STATED = re.compile(rf'^(?:# *)?format *= *"({"|".join(_KINDS)})/', re.MULTILINE)

_DECIMAL_COMMA = re.compile(r"=\s*-?\d+,\d+\s*(?:$|[,}#])")
_LONG_MINUS = re.compile(r"[\N{MINUS SIGN}\N{EN DASH}]\s*\d")


def _bytes(path: str | Path) -> bytes:
    """What a user's file holds; raises BadFile if it cannot be read."""
    try:
        return Path(path).read_bytes()
    except IsADirectoryError as error:
        raise BadFile(path, "file", "a folder", "a file") from error
    except OSError as error:
        found = not_read(Path(path), error)
        raise BadFile(path, "file", found, "a file that can be read") from error
    except ValueError as error:  # a name with a zero byte
        raise BadFile(path, "file", str(error), "a file that can be read") from error


def read_text(path: str | Path) -> str:
    """Text of a user's file; raises BadFile if it is missing or not UTF-8."""
    data = _bytes(path)
    for begin, what in _NO_TEXT.items():
        if data.startswith(begin):
            raise BadFile(path, "file", what, "a text file (UTF-8)")
    try:
        return _one_line_end(data.decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        if b"\0" in data:
            raise BadFile(path, "file", "no text", "a text file (UTF-8)") from error
        found = f"byte {data[error.start]:#04x}, which is no UTF-8"
        raise BadFile(path, line, found, "text saved as UTF-8") from error


def read_any_text(path: str | Path) -> str:
    """Text as spreadsheets and instruments save it: UTF-8, UTF-16, else Windows-1252.

    Raises:
        BadFile: The file cannot be read, or holds no text.
    """
    data = _bytes(path)
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return _one_line_end(data.decode("utf-16", errors="replace"))
    try:
        data.decode("utf-8")
    except UnicodeDecodeError:
        if b"\0" not in data:
            return _one_line_end(data.decode("cp1252", errors="replace"))
    return read_text(path)


def is_file(path: Path) -> bool:
    """Whether there is such a file; a name that the system cannot take has none."""
    try:
        return path.is_file()
    except OSError:
        return False


def _one_line_end(text: str) -> str:
    """Text with line feeds, whichever system wrote it."""
    return text.replace("\r\n", "\n").replace("\r", "\n") if "\r" in text else text


def parse_toml(text: str, path: str | Path, twice: str = "it once") -> dict[str, Any]:
    """Tables of a TOML text; raises BadFile.

    `twice` is expected of a table that stands in two places; `{name}` in it is its name.
    """
    try:
        return tomllib.loads(text, parse_float=_moderate)
    except tomllib.TOMLDecodeError as error:
        raise _no_toml(error, text, path, twice) from error
    except RecursionError:
        raise BadFile(path, "file", "brackets nested without end", "a TOML file") from None
    except ValueError as error:  # Python converts no whole number of more than 4300 digits
        long = _MANY_DIGITS.search(text)
        literal = long.group() if long else str(error)
        line = 1 + text.count("\n", 0, max(text.find(literal), 0))
        expected = "a number of fewer digits" if long else f"numbers below {LARGEST_NUMBER:g}"
        raise BadFile(path, line, literal, expected) from None


def _moderate(literal: str) -> float:
    """A number that may be squared without overflow; NaN and infinity are for the models."""
    value = float(literal)
    if LARGEST_NUMBER < abs(value) < math.inf:
        raise ValueError(literal)
    return value


def _no_toml(error: tomllib.TOMLDecodeError, text: str, path: str | Path, twice: str) -> BadFile:
    """The line that is no TOML, and why."""
    why, _, place = str(error).partition(" (at ")
    match = re.match(r"line (\d+)", place)
    lines = text.splitlines()
    number = int(match.group(1)) if match else len(lines)
    line = lines[number - 1].strip() if 0 < number <= len(lines) else ""
    place = f"line {number}"
    repeated = _TWICE.match(why)
    if repeated:
        name = re.sub(r"', '", ".", repeated.group(1)).strip("'")
        return BadFile(path, place, f"table [{name}] a second time", twice.format(name=name))
    comma = " and a point in decimal numbers" if _DECIMAL_COMMA.search(line) else ""
    if _LONG_MINUS.search(line):
        comma += " and - for a minus sign"
    written = next((ours for begin, ours in _GRAMMAR.items() if why.startswith(begin)), _STATEMENT)
    expected = f"a whole TOML file{comma}: {written}"
    found = repr(line[:60]) if line else "an end"
    return BadFile(path, place, found, expected)


def read_toml(path: str | Path, wanted: str, twice: str = "it once") -> dict[str, Any]:
    """Tables of a file of one kind, as `wanted` in its `format` says; raises BadFile.

    Args:
        twice: As of `parse_toml`.
    """
    return parse_kind(read_text(path), path, wanted, twice)


def parse_kind(
    text: str, path: str | Path, wanted: str, twice: str = "it once", whole: str | None = None
) -> dict[str, Any]:
    """The same of its text.

    Args:
        whole: Text of the file where `text` is its head.
    """
    try:
        data = parse_toml(text, path, twice)
    except BadFile:
        stated = kind_of(text if whole is None else whole)
        if stated in ("", _kind(wanted)):
            raise
        raise _other_kind(path, stated, wanted) from None
    check_format(data, wanted, path)
    return data


def check_format(data: dict[str, Any], wanted: str, path: str | Path) -> None:
    """Raise BadFile unless `format` says what the reader understands."""
    found = data.get("format")
    if found == wanted:
        return
    kind = _kind(found)
    if kind in _KINDS and kind != _kind(wanted):
        raise _other_kind(path, kind, wanted)
    older = "; files of other versions are not read" if kind == _kind(wanted) else ""
    raise BadFile(path, "format", repr(found) if found else "nothing", f'"{wanted}"{older}')


def kind_of(text: str) -> str:
    """Kind of one of our files by the `format` in its text, also behind a #; "" for none.

    Example:
        >>> kind_of('# format = "run/1"'), kind_of("X_mm,Y_mm")
        ('run', '')
    """
    stated = _STATED.search(text)
    return stated[1] if stated else ""


def _kind(stated: object) -> str:
    """Kind of a file in what its `format` states: `run` of `run/1`."""
    return str(stated).partition("/")[0]


def _other_kind(path: str | Path, kind: str, wanted: str) -> BadFile:
    """A file of ours that was given in place of another."""
    name, more = _KINDS[_kind(wanted)]
    return BadFile(path, "format", _KINDS[kind][0], f'{name}, "{wanted}"{more}')
