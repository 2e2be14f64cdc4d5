"""Exceptions: what a user can put right, in one line, with what is available instead."""

from collections.abc import Iterable, Sequence
from pathlib import Path

from matstd.twin.words import did_you_mean


class DesignError(Exception):
    """Root of everything a user can put right; `matstd` shows it as one line and exits with 2.

    The message is the one argument that `Exception` itself keeps, so that an error raised in a
    worker process travels back unharmed; further facts are attributes.
    """

    def __init__(self, message: str, **facts: object) -> None:
        super().__init__(message)
        self.message = message
        self.facts = facts

    def __str__(self) -> str:
        return self.message

    def __reduce__(self) -> tuple[object, ...]:
        return (_restore, (type(self), self.message, self.facts))


def _restore(kind: type[DesignError], message: str, facts: dict[str, object]) -> DesignError:
    error = kind.__new__(kind)
    DesignError.__init__(error, message, **facts)
    return error


class BadValue(DesignError, ValueError):
    """A value that does not fit, wherever it came from; `BadFile.of` adds the file.

    Args:
        key: What it is the value of.
    """

    def __init__(self, key: str, found: object, expected: str) -> None:
        message = f"{key}: found {found}, expected {expected}"
        super().__init__(message, key=key, found=found, expected=expected)


class BadArgument(DesignError, ValueError):
    """An argument of a function, or the option of a command that stands for it.

    Args:
        name: Name of the argument; the option of the same name has hyphens.
    """

    def __init__(self, name: str, found: object, expected: str) -> None:
        super().__init__(f"{name} {found}: expected {expected}", argument=name)


class UnknownAxis(DesignError, KeyError):
    """An axis letter that the machine does not have."""

    def __init__(self, axis: str, available: Iterable[str]) -> None:
        shown = ", ".join(available)
        super().__init__(
            f"unknown axis '{axis}'; this machine has {shown}",
            key=axis,
            found="an unknown axis",
            expected=f"one of {shown}",
        )


class UnknownSymbol(DesignError, KeyError):
    """An error parameter whose name is none of ISO 230-1, or none of this machine's."""

    def __init__(self, symbol: str, available: Iterable[str]) -> None:
        available = list(available)
        shown = ", ".join(available[:12]) + (" ..." if len(available) > 12 else "")
        meant = did_you_mean(symbol, available)
        super().__init__(
            f"unknown error parameter '{symbol}'{meant}; available: {shown}",
            key=symbol,
            found=f"an unknown error name{meant}",
            expected=f"one of {shown}",
        )


class UnknownEffect(DesignError, KeyError):
    """An effect that is not in the library, or arguments it does not take."""


class ShapeMismatch(DesignError, ValueError):
    """Arrays whose shapes do not belong together."""


class OutsideTravel(DesignError, ValueError):
    """A reading beyond the travel of its axis."""


class NotReachable(DesignError, ValueError):
    """A pose or a touch that this machine cannot reach."""


class NotBuildable(DesignError, ValueError):
    """A standard that cannot be made; the message names the constraint that binds."""


class NotConforming(DesignError, ValueError):
    """A measured piece that is not the one that was drawn; the message names what is out."""


class NotEnoughData(DesignError, ValueError):
    """Measurements too few or too uniform for what was asked; the message says what is possible."""


class MissingLibrary(DesignError, ImportError):
    """Something outside this package is needed for what was asked; the message names it."""


MOST_FAULTS = 4  # faults of one file that are described in one line; of more, their number


def _short(value: object, most: int = 120) -> str:
    """What stood in a file as a part of one line: on a screen, whatever stood there."""
    text = " ".join(str(value).split())
    half = most // 2
    return text if len(text) <= most else f"{text[:half]} ... {text[-half // 2 :]}"


class BadFile(DesignError, ValueError):
    """A file with unexpected content.

    Args:
        where: The key, or the number of the line.
        found: What stood there.
        expected: What should stand there.
    """

    def __init__(self, path: str | Path, where: str | int, found: object, expected: str) -> None:
        where = where if isinstance(where, str) else f"line {where}"
        super().__init__(
            f"{_short(path, 300)}: {_short(where)}: found {_short(found, 300)}, "
            f"expected {_short(expected, 400)}",
            path=str(path),
            where=where,
            found=found,
            expected=expected,
        )

    @classmethod
    def several(cls, faults: Sequence["BadFile"]) -> "BadFile":
        """All faults of one file in one line, the first `MOST_FAULTS` of them in full.

        The facts are those of the first; `faults` has all.
        """
        if len(faults) == 1:
            return faults[0]
        first = faults[0].facts
        shown = [
            f"{_short(f.facts['where'], 60)}: found {_short(f.facts['found'], 60)}, "
            f"expected {_short(f.facts['expected'], 150)}"
            for f in faults[:MOST_FAULTS]
        ]
        more = len(faults) - len(shown)
        rest = f"; and {more} more" if more else ""
        error = cls.__new__(cls)
        text = f"{_short(first['path'], 300)}: {len(faults)} faults: {'; '.join(shown)}{rest}"
        DesignError.__init__(error, text, **first, faults=tuple(faults))
        return error

    @classmethod
    def of(cls, path: str | Path, error: DesignError, within: str = "", key: str = "") -> "BadFile":
        """A refused value as a fault of the file that it stood in.

        Args:
            error: With the facts found and expected: BadValue, UnknownAxis, UnknownSymbol.
            within: Key of the table that the value stood in.
            key: Key of the value; empty for the key in the error.
        """
        where = ".".join(part for part in (within, key or str(error.facts["key"])) if part)
        return cls(path, where, error.facts["found"], str(error.facts["expected"]))
