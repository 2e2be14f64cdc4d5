"""Names that a user may have meant, and lists of names, for messages."""

from collections.abc import Iterable


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


def listed(names: list[str], last: str = "and") -> str:
    """`a`, `a and b`, `a, b and c`.

    Example:
        >>> listed(["a", "b", "c"])
        'a, b and c'
    """
    return f" {last} ".join([", ".join(names[:-1]), names[-1]] if len(names) > 2 else names)
