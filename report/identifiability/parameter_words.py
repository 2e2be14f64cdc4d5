"""Names of parameters in words: `location(EC0C)` is the zero position of C."""

import re

from matstd.twin.machine import Chain, parse_symbol

_NAME = re.compile(r"(geometric|location|setup)\(([^,)]+)(?:,([^)]*))?\)(?:: (\w+))?\Z")
_SETUP = {"dx": "X", "dy": "Y", "dz": "Z", "rx": "X", "ry": "Y", "rz": "Z"}
_SINE = re.compile(r"sinusoidal(?:,([\d.]+))?(?:@(-?[\d.]+))?\Z")


def in_words(name: str, chain: Chain) -> str:
    """A parameter in words, with its symbol in brackets; other names unchanged.

    Args:
        name: As in `Model.names`: `location(EC0C)`, `geometric(EXX,linear)`, `setup(a): rz`.
    """
    match = _NAME.match(name)
    if match is None:
        return name
    kind, first, second, part = match.groups()
    if kind == "setup" and part in _SETUP:
        how = "displacement along" if part.startswith("d") else "rotation about"
        return f"set-up {how} {_SETUP[part]} ({first})"
    symbol = parse_symbol(first)
    if symbol is None or symbol not in chain.symbols:
        return name
    shape = f"{_shape(second or '', part)} " if kind == "geometric" else ""
    return f"{shape}{symbol.title} ({symbol.name})"


def _shape(shape: str, part: str | None) -> str:
    """A distribution or a coefficient over the reading, as an adjective."""
    if part is not None and part[:1] == "T":
        return {"T1": "linear", "T2": "parabolic"}.get(part, f"degree {part[1:]} of the")
    if part is not None and part[:3] in ("sin", "cos"):
        wave = "sine" if part[:3] == "sin" else "cosine"
        return f"{wave} of harmonic {part[3:]} of the"
    match = _SINE.match(shape)
    if match is None:
        return shape
    waves = "" if match.group(1) is None else f" of {match.group(1)} periods"
    phase = {None: "sine", "90": "cosine"}.get(match.group(2), f"wave at {match.group(2)}°")
    return f"{phase}{waves} of the"


def short(name: str) -> str:
    """Name of a parameter as it fits beside a map: `EXX cosine` for `geometric(EXX,sinusoidal@90)`.

    Example:
        >>> short("geometric(EXX,sinusoidal@90)"), short("location(EX0C)"), short("setup(a): dx")
        ('EXX cosine', 'EX0C', 'set-up a dx')
    """
    kind, _, rest = name.partition("(")
    inner, _, tail = rest.partition(")")
    if kind == "geometric":
        symbol, _, shape = inner.partition(",")
        waves = {"sinusoidal": "sine", "sinusoidal@90": "cosine", "constant": ""}
        return f"{symbol} {waves.get(shape, shape)}".strip()
    if kind == "location" and not tail:
        return inner
    if kind == "setup":
        return f"set-up {inner} {tail.removeprefix(':').strip()}".strip()
    return name
