"""Gauge freedoms in words: what imitates what, why, and freedoms that differ in their shape alone.

Where members have different units an equation says what one unit of the first looks like,
`1 µrad of squareness of Y about Z (EC0Y) = - 0.3 µm of linear straightness of Y in X (EXY)`.
"""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from information.identifiability.parameter_words import in_words
from twin.frames import Array
from twin.machine import Chain, Family, Symbol, parse_symbol
from twin.model import Effect, Parameter
from twin.units import shown

TURNS = "it turns about the line from spindle to ball"
"""Why an angular error that turns about the tool's own line moves no touch."""

_SAME = 1e-6  # relative, of two weights
_SHAPED = re.compile(r"geometric\((\w+),([^,)]+)\)\Z")
_SHAPE_WORDS = {"sinusoidal": "sine", "sinusoidal@90": "cosine"}
_ORDER = ("linear", "parabolic", "sinusoidal", "sinusoidal@90")

Parameters = Sequence[tuple[Effect, Parameter]]
"""Those of a model, each with its effect."""


class Term(NamedTuple):
    """A member of an equation: value in base units per base unit of what it is compared with."""

    name: str
    unit: str
    value: float


@dataclass(frozen=True)
class Freedom:
    """A parameter that the touches cannot tell from others: only their sum has a value.

    Attributes:
        parameter: That can be left out.
        alike: What imitates it exactly, as (name, value per unit of the parameter), base units.
        words: The same as an equation in words.
        why: What makes them alike.
        resolved_by: Touches that would tell them apart.
    """

    parameter: str
    alike: tuple[tuple[str, float], ...]
    words: str = ""
    why: str = ""
    resolved_by: str = ""

    def __str__(self) -> str:
        if not self.alike:
            return f"{self.parameter} moves no touch"
        terms = " ".join(f"{value:+.4g} {name}" for name, value in self.alike)
        return f"{self.parameter} cannot be told from {terms}"


class FreedomWords(NamedTuple):
    """One line of a list of freedoms; it may stand for several shapes of the same."""

    words: str
    why: str
    resolved_by: str
    shapes: int


def terms(
    members: Sequence[int], value: Array, names: Sequence[str], units: Sequence[str]
) -> list[Term]:
    """Members of an equation, by their places."""
    return [Term(names[k], units[k], float(value[k])) for k in members]


def equation(lead: str, unit: str, others: Sequence[Term], chain: Chain) -> str:
    """`set-up rotation about Z (EC0w) = - zero position of C (EC0C)`.

    Args:
        lead: Name of the parameter that can be left out.
        unit: Its base unit, "mm" or "rad".
        others: What imitates it.
        chain: The machine.
    """
    left = in_words(lead, chain).strip()
    if not others:
        return f"{left} moves no touch"
    is_mixed = any(term.unit != unit for term in others)
    right = " ".join(_term(term, unit, is_mixed, chain) for term in others).removeprefix("+ ")
    return f"1 {shown(unit)[0]} of {left} = {right}" if is_mixed else f"{left} = {right}"


def _term(term: Term, of: str, is_mixed: bool, chain: Chain) -> str:
    """A term with its sign: `- zero position of C (EC0C)`, `+ 0.16 µm of ...`."""
    sign, size = ("-" if term.value < 0.0 else "+"), abs(term.value)
    words = in_words(term.name, chain).strip()
    if is_mixed:
        label, factor = shown(term.unit)
        return f"{sign} {size * shown(of)[1] / factor:.3g} {label} of {words}"
    return f"{sign} {words}" if abs(size - 1.0) < _SAME else f"{sign} {size:.3g} x {words}"


def reason(members: Sequence[int], parameters: Parameters, chain: Chain) -> str:
    """What makes the members of a freedom alike, from what they are."""
    symbols = [getattr(parameters[p][0], "symbol", None) for p in members]
    known = [s for s in symbols if isinstance(s, Symbol)]
    if len(known) < len(members):
        is_setup = any(parameters[p][0].kind == "setup" for p in members)
        return "the standard moves as a whole" if is_setup else ""
    still = [s for s in known if s.link not in "wt" and not chain.link(s.link).programmed]
    if len(known) == 1:
        if still:
            return "the spindle stands still, and the ball hangs on its line"
        return TURNS if known[0].is_angular else ""
    families, links = {s.family for s in known}, {s.link for s in known}
    mixed = len({s.is_angular for s in known}) == 2
    if "w" in links:
        return "the standard on the table moves as a whole"
    if len(known) == 2 and mixed and Family.LOCATION in families and len(links) == 1:
        return "a squareness is the slope of a straightness"
    if len(known) == 2 and mixed:
        return "the ball hangs at one length, so a tilt is a displacement"
    if "t" in links:
        return "the tool moves as a whole"
    if still:
        return "the spindle stands still, so its errors are constant"
    return "the body between two axes moves as a whole"


def in_families(freedoms: Iterable[Freedom], chain: Chain) -> tuple[FreedomWords, ...]:
    """Freedoms in words, those that say the same of several shapes of an error in one line.

    Args:
        freedoms: As `information.identifiability.separation` finds them.
        chain: The machine.

    Returns:
        In the order of their first members.
    """
    families: dict[object, list[Freedom]] = {}
    for freedom in freedoms:
        families.setdefault(_family(freedom) or (freedom.parameter,), []).append(freedom)
    return tuple(_line(family, chain) for family in families.values())


def _family(freedom: Freedom) -> tuple[object, ...] | None:
    """What freedoms of several shapes have in common; None where no one shape is in all members."""
    named = [(freedom.parameter, 1.0), *freedom.alike]
    found = [_SHAPED.match(name) for name, _ in named]
    if not all(found) or len({m.group(2) for m in found if m}) > 1:
        return None
    symbols = tuple(m.group(1) for m in found if m)
    return (symbols, tuple(f"{value:.6g}" for _, value in named), freedom.resolved_by)


def _line(family: Sequence[Freedom], chain: Chain) -> FreedomWords:
    """One line for freedoms of several shapes."""
    first = family[0]
    if len(family) == 1:
        return FreedomWords(first.words, first.why, first.resolved_by, 1)
    plain = [_without_shape(name, value) for name, value in first.alike]
    lead = _without_shape(first.parameter, 1.0)
    shapes = [m.group(2) for f in family if (m := _SHAPED.match(f.parameter))]
    shapes.sort(key=lambda shape: _ORDER.index(shape) if shape in _ORDER else len(_ORDER))
    listed = ", ".join(_SHAPE_WORDS.get(shape, shape) for shape in shapes)
    words = f"{equation(lead.name, lead.unit, plain, chain)} (in each shape: {listed})"
    return FreedomWords(words, first.why, first.resolved_by, len(family))


def _without_shape(name: str, value: float) -> Term:
    """The component error itself, `geometric(EXX,)`."""
    symbol = parse_symbol(name.partition("(")[2].partition(",")[0])
    unit = "rad" if symbol is not None and symbol.is_angular else "mm"
    return Term(f"geometric({symbol.name if symbol else ''},)", unit, value)
