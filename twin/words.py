"""Names that a user may have meant, lists of names, the unit of deviations, for messages."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

LENGTHS = "µm"
_UNIT: ContextVar[str] = ContextVar("unit of deviations", default=LENGTHS)


@contextmanager
def deviations_in(unit: str) -> Iterator[None]:
    """While it lasts, what is said, shown and drawn of deviations has this unit."""
    token = _UNIT.set(unit)
    try:
        yield
    finally:
        _UNIT.reset(token)


def in_own_unit(text: str) -> str:
    """A text whose figures of µm are those of an instrument of angles: the same in µrad.

    Example:
        >>> with deviations_in("µrad"):
        ...     in_own_unit("12 µm left")
        '12 µrad left'
    """
    unit = _UNIT.get()
    return text if unit == LENGTHS else text.replace(LENGTHS, unit)


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """The nearest of some names as a question, "" where none is near; case does not count.

    Example:
        >>> did_you_mean("Time_s", ["time_s", "setup"]), did_you_mean("colour", ["time_s"])
        ('; did you mean time_s?', '')
    """
    near = nearest(word, known)
    return f"; did you mean {near}?" if near else ""


def nearest(word: str, known: Iterable[str]) -> str:
    """The nearest of some names, "" where none is near; case does not count."""
    from difflib import get_close_matches

    by_letters = {name.lower(): name for name in known}
    near = get_close_matches(word.lower(), by_letters, n=1, cutoff=0.7)
    return by_letters[near[0]] if near else ""


def not_read(path: Path, error: OSError) -> str:
    """Why a file cannot be read, with the file beside it that may be meant."""
    if not isinstance(error, FileNotFoundError):
        return error.strerror or str(error)
    try:
        beside = [entry.name for entry in path.parent.iterdir()]
    except OSError:
        return f"no such file; the folder {path.parent} is missing too"
    return f"no such file{did_you_mean(path.name, beside)}"


def listed(names: list[str], last: str = "and") -> str:
    """`a`, `a and b`, `a, b and c`.

    Example:
        >>> listed(["a", "b", "c"])
        'a, b and c'
    """
    return f" {last} ".join([", ".join(names[:-1]), names[-1]] if len(names) > 2 else names)


def few(names: list[str], most: int, last: str = "and") -> str:
    """`a, b and c`, or the first ones and how many more there are.

    Example:
        >>> few(["a", "b", "c"], 2), few(["a", "b"], 2)
        ('a, b and 1 more', 'a and b')
    """
    if len(names) <= most:
        return listed(names, last)
    return f"{', '.join(names[:most])} {last} {len(names) - most} more"
