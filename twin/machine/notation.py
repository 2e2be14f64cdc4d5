"""ISO chain notation, read."""

import re

from matstd.twin.errors import BadValue

_TOKEN = re.compile(r"([XYZUVWABCS]\d?)('?)\Z")


def parse_notation(notation: str) -> list[tuple[str, bool, bool]]:
    """Axes of a chain notation as (name, carries the workpiece, programmed), workpiece to tool.

    Raises:
        BadValue: A token that is no axis, or a prime on the wrong side of the foundation.

    Reference:
        ISO 841; chain notation as in ISO 10791-6, with primes as in `[w C' B' X' f Y Z (C1) t]`.
    """
    # a word processor makes other primes of those that are typed
    notation = re.sub("[\u2019\u2018\u2032\u00b4`]", "'", notation)
    tokens = notation.strip().removeprefix("[").removesuffix("]").split()
    if len(tokens) < 3 or tokens[0] != "w" or tokens[-1] != "t" or tokens.count("f") != 1:
        expected = "one 'w' first, one 't' last and one 'f' between, such as [w X' f Y Z t]"
        raise BadValue("chain", f"'{notation}'", expected)
    foundation = tokens.index("f")
    axes: list[tuple[str, bool, bool]] = []
    for position, token in enumerate(tokens[1:-1], start=1):
        if token == "f":
            continue
        bracketed = token.startswith("(") and token.endswith(")")
        match = _TOKEN.match(token[1:-1] if bracketed else token)
        if match is None:
            expected = "a letter of X Y Z U V W A B C, a prime on the workpiece side"
            raise BadValue("chain", f"unknown axis '{token}' in '{notation}'", expected)
        name, prime = match.groups()
        # the prime repeats what the position says; a contradiction is a typing error
        if bool(prime) != (position < foundation):
            side, wanted = ("workpiece", "a") if position < foundation else ("tool", "no")
            found = f"axis '{token}' on the {side} side of f in '{notation}'"
            raise BadValue("chain", found, f"{wanted} prime")
        if any(name == known for known, _, _ in axes):
            raise BadValue("chain", f"axis '{name}' twice in '{notation}'", "it once")
        axes.append((name, bool(prime), not bracketed))
    if not axes:
        raise BadValue("chain", f"no axis in '{notation}'", "one at least")
    return axes
