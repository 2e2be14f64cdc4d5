"""Names and numbers as they stand in programs of every control."""

import re
from collections.abc import Mapping

from matstd.twin.errors import DesignError

MAX_NAME = 16  # longest program name that the oldest software displays whole
MAX_VALUE = 99999.9999  # largest coordinate that the control takes, mm or degrees

MAX_LINE = 72
"""Longest physical line that is emitted, characters; the iTNC's own limit is not documented."""

_NAME = re.compile(r"[A-Z][A-Z0-9_]*\Z")
_SPINDLE = re.compile(r"(?<![A-Z0-9])(M0?[34]|M1[34])(?!\d)|TOOL CALL.*\bS\s?\d")


def checked_name(name: str) -> str:
    """Program name that every software generation takes; raises DesignError."""
    if not _NAME.match(name) or len(name) > MAX_NAME:
        expected = f"a letter, then letters A-Z, digits or _, at most {MAX_NAME} characters"
        raise DesignError(f"program name '{name}': expected {expected}")
    return name


def signed(value: float, decimals: int = 4) -> str:
    """Sign, point and fixed decimals, never a negative zero; raises DesignError out of range."""
    if not abs(value) <= MAX_VALUE:
        raise DesignError(f"coordinate {value} is beyond the control's range of {MAX_VALUE}")
    rounded = round(value, decimals) + 0.0
    return f"{rounded:+.{decimals}f}"


def parameter(value: float) -> str:
    """A number for a parameter; whole numbers without decimals."""
    return f"{value:+.0f}" if value == int(value) else signed(value)


def axis_words(position: Mapping[str, float]) -> str:
    """Coordinates by axis letter, mm or degrees."""
    return " ".join(f"{axis}{signed(value)}" for axis, value in position.items())


def checked_line(physical: str, longest: int = MAX_LINE) -> str:
    """A physical line that may be emitted; raises DesignError."""
    if not physical.isascii():
        raise DesignError(f"block '{physical}' has characters outside ASCII")
    if len(physical) > longest:
        found = f"block '{physical}' has {len(physical)} characters"
        raise DesignError(f"{found}, at most {longest} are emitted")
    if _SPINDLE.search(physical.split(";")[0]):
        raise DesignError(f"block '{physical}' would start the spindle with a probe in it")
    return physical
