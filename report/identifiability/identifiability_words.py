"""Sentences on what touches can and cannot distinguish.

Where the members of a gauge freedom have different units, its equation states the equivalent of one
unit of the first, `1 µrad of squareness of Y about Z (EC0Y) = - 0.3 µm of linear straightness of Y
in X (EXY)`.
"""

import re
from collections.abc import Sequence

import numpy as np

from matstd.artefact.compare import IdentifiabilityReport
from matstd.information.identifiability import (
    Degree,
    Freedom,
    FreedomFamily,
    Pair,
    Resolution,
    Term,
)
from matstd.report.numbers import shown
from matstd.twin.frames import Array
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


MAX_NAMED_PARAMETERS = 4  # parameters of a combination that are written out at most
MIN_WEIGHT_SHARE = 0.1
"""A parameter below this share of the largest weight is left out of the words."""
_FULL = 0.9995  # a correlation that rounds to 1.000
_SAME = 1e-6  # relative, of two weights
_SHAPES = {"sinusoidal": "sine", "sinusoidal@90": "cosine"}


def gist(known: IdentifiabilityReport) -> str:
    """What the touches of a design determine, in two sentences."""
    gauge = known.gauge
    never = sum(f.resolution is Resolution.NEVER for f in gauge.freedoms)
    return (
        f"{known.touches} touches determine {gauge.rank} independent combinations of "
        f"{gauge.parameters} parameters. Of the {len(gauge.freedoms)} that remain free, {never} "
        "are free on every workpiece and fixed by convention"
    )


def freedom_words(freedom: Freedom, chain: Chain) -> str:
    """`rotation of the workpiece about Z (EC0w) = - zero position of C (EC0C)`."""
    left, unit = in_words(freedom.parameter, chain).strip(), freedom.unit
    if not freedom.alike:
        return f"{left} moves no touch"
    is_mixed = any(term.unit != unit for term in freedom.alike)
    right = " ".join(_term(term, unit, is_mixed, chain) for term in freedom.alike)
    right = right.removeprefix("+ ")
    return f"1 {shown(unit)[0]} of {left} = {right}" if is_mixed else f"{left} = {right}"


def _term(term: Term, of: str, is_mixed: bool, chain: Chain) -> str:
    """A term with its sign: `- zero position of C (EC0C)`, `+ 0.16 µm of ...`."""
    sign, size = ("-" if term.value < 0.0 else "+"), abs(term.value)
    words = in_words(term.name, chain).strip()
    if is_mixed:
        label, factor = shown(term.unit)
        return f"{sign} {size * shown(of)[1] / factor:.3g} {label} of {words}"
    return f"{sign} {words}" if abs(size - 1.0) < _SAME else f"{sign} {size:.3g} x {words}"


def family_words(family: FreedomFamily, chain: Chain) -> str:
    """The same, with the shapes for which it holds."""
    words = freedom_words(family.first, chain)
    listed = ", ".join(_SHAPES.get(shape, shape) for shape in family.shapes)
    return f"{words} (in each shape: {listed})" if listed else words


def reason_words(freedom: Freedom) -> str:
    """Why the members of a freedom have the same signature; "" where that is unknown."""
    return freedom.reason.value if freedom.reason else ""


def resolution_words(freedom: Freedom) -> str:
    """What would distinguish the members of a freedom; "" where nothing was tried."""
    if freedom.resolution is Resolution.UNTRIED:
        return ""
    return freedom.resolved_by or freedom.resolution.value


def group_words(members: Sequence[str], known: int) -> str:
    """Number of visible combinations of confounded parameters."""
    return f"{len(members)} parameters, of which {known} combinations are visible"


def pair_words(pair: Pair, names: Sequence[str]) -> str:
    """Meaning of a correlation: `EXX and EX0C (r = -0.980): only their sum is known`."""
    known, sign = ("difference", ">") if pair.r > 0.0 else ("sum", "<")
    # a correlation is estimated, so that 1.000 would claim too much
    number = f"r = {pair.r:+.3f}" if abs(pair.r) < _FULL else f"r {sign} {np.sign(pair.r) * 0.999}"
    return f"{names[pair.first]} and {names[pair.second]} ({number}): only their {known} is known"


def degree_words(degree: Degree, chain: Chain) -> str:
    """`straightness of X in Y (EYX): degrees 2 to 5, the last to 0.4 µm`."""
    what = in_words(f"geometric({degree.symbol},)", chain).strip()
    link = chain.link(chain.symbol(degree.symbol).link)
    kind = "harmonic" if link.kind == "rotary" else "degree"
    if not degree.supported:
        return f"{what}: no {kind}"
    label, factor = shown(degree.unit)
    first, last = degree.supported[0], degree.supported[-1]
    if first == last:
        return f"{what}: {kind} {last} to {degree.u / factor:.2g} {label}"
    return f"{what}: {kind}s {first} to {last}, the last to {degree.u / factor:.2g} {label}"


def combination_words(
    names: Sequence[str], units: Sequence[str], weights: Array, importance: Array
) -> str:
    """`EXX + 0.52 EXZ - 0.03 µm/µrad EBX ...`: the most important parameters with their weights."""
    order = np.argsort(-np.abs(importance).round(9), kind="stable")
    kept = [k for k in order if abs(importance[k]) >= MIN_WEIGHT_SHARE * abs(importance[order[0]])]
    label, factor = shown(units[order[0]])
    parts = []
    for k in kept[:MAX_NAMED_PARAMETERS]:
        sign = "-" if weights[k] < 0 else "+"
        own, size = shown(units[k]), abs(weights[k])
        words = f"{size * own[1] / factor:.3g}"
        per = "" if own[0] == label else f"{label}/{own[0]} "
        parts.append(f"{sign} {'' if words == '1' and not per else words + ' '}{per}{names[k]}")
    rest = len(kept) - MAX_NAMED_PARAMETERS
    return " ".join(parts).removeprefix("+ ") + (f" and {rest} more" if rest > 0 else "")
