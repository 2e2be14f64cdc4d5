"""Gauge freedoms: which parameters imitate each other, and why."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from typing import NamedTuple

from matstd.twin.machine import Chain, Family, Symbol, parse_symbol
from matstd.twin.model import Effect, Parameter, traits

_SHAPED = re.compile(r"geometric\((\w+),([^,)]+)\)\Z")
_ORDER = ("linear", "parabolic", "sinusoidal", "sinusoidal@90")

Parameters = Sequence[tuple[Effect, Parameter]]  # those of a model, each with its effect


class Reason(Enum):
    """What makes the members of a freedom alike."""

    STANDARD = "the standard moves as a whole"
    STANDARD_ON_TABLE = "the standard on the table moves as a whole"
    TOOL = "the tool moves as a whole"
    BODY = "the body between two axes moves as a whole"
    SQUARENESS = "a squareness is the slope of a straightness"
    ONE_LENGTH = "the ball hangs at one length, so a tilt is a displacement"
    ON_SPINDLE = "the spindle stands still, and the ball hangs on its line"
    SPINDLE_STILL = "the spindle stands still, so its errors are constant"
    TURNS = "it turns about the line from spindle to ball"


class Resolution(Enum):
    """Measurement that would distinguish the members of a freedom."""

    UNTRIED = "nothing else was tried"
    TOUCHES = "other touches that were tried"
    SIDEWAYS = "a second stylus that reaches sideways, off the line of the spindle"
    NEVER = "nothing that touches a workpiece; it is fixed by convention"


class Term(NamedTuple):
    """A member of a freedom: value in base units per base unit of what it is compared with."""

    name: str
    unit: str
    value: float


@dataclass(frozen=True)
class Freedom:
    """A parameter that the touches cannot distinguish from others: only their sum is determined."""

    parameter: str  # that can be left out
    unit: str
    alike: tuple[Term, ...]  # what imitates it exactly; nothing for a parameter that moves no touch
    reason: Reason | None = None  # what makes them alike
    resolution: Resolution = Resolution.UNTRIED  # measurement that would distinguish them
    resolved_by: str = ""  # name of the tried touches that would

    @property
    def values(self) -> dict[str, float]:
        """What imitates it: value of every other parameter per unit of this one."""
        return {term.name: term.value for term in self.alike}


@dataclass(frozen=True)
class FreedomFamily:
    """Equal freedoms of several shapes of one error."""

    # one of them; of several shapes with the component errors themselves for names,
    # `geometric(EXX,)`
    first: Freedom
    shapes: tuple[str, ...]  # of the errors, in their usual order; empty for a freedom by itself
    count: int  # number of freedoms


def reason(members: Sequence[int], parameters: Parameters, chain: Chain) -> Reason | None:
    """What makes the members of a freedom alike, from what they are."""
    symbols = [traits(parameters[p][0]).symbol for p in members]
    known = [s for s in symbols if isinstance(s, Symbol)]
    if len(known) < len(members):
        is_setup = any(parameters[p][0].kind == "setup" for p in members)
        return Reason.STANDARD if is_setup else None
    still = [s for s in known if s.link not in "wt" and not chain.link(s.link).programmed]
    if len(known) == 1:
        if still:
            return Reason.ON_SPINDLE
        return Reason.TURNS if known[0].is_angular else None
    families, links = {s.family for s in known}, {s.link for s in known}
    is_mixed = len({s.is_angular for s in known}) == 2
    if "w" in links:
        return Reason.STANDARD_ON_TABLE
    if len(known) == 2 and is_mixed and Family.LOCATION in families and len(links) == 1:
        return Reason.SQUARENESS
    if len(known) == 2 and is_mixed:
        return Reason.ONE_LENGTH
    if "t" in links:
        return Reason.TOOL
    return Reason.SPINDLE_STILL if still else Reason.BODY


def in_families(freedoms: Iterable[Freedom]) -> tuple[FreedomFamily, ...]:
    """Freedoms, with equal ones of several shapes of an error joined."""
    families: dict[object, list[Freedom]] = {}
    for freedom in freedoms:
        families.setdefault(_family(freedom) or (freedom.parameter,), []).append(freedom)
    return tuple(_joined(family) for family in families.values())


def _family(freedom: Freedom) -> tuple[object, ...] | None:
    """What freedoms of several shapes have in common; None where no one shape is in all members."""
    named = [(freedom.parameter, 1.0), *((t.name, t.value) for t in freedom.alike)]
    found = [_SHAPED.match(name) for name, _ in named]
    if not all(found) or len({m.group(2) for m in found if m}) > 1:
        return None
    symbols = tuple(m.group(1) for m in found if m)
    values = tuple(f"{value:.6g}" for _, value in named)
    return symbols, values, freedom.resolution, freedom.resolved_by


def _joined(family: Sequence[Freedom]) -> FreedomFamily:
    """One record for freedoms of several shapes."""
    first = family[0]
    if len(family) == 1:
        return FreedomFamily(first, (), 1)
    lead = _without_shape(first.parameter, 1.0)
    shapes = [m.group(2) for f in family if (m := _SHAPED.match(f.parameter))]
    shapes.sort(key=lambda shape: _ORDER.index(shape) if shape in _ORDER else len(_ORDER))
    alike = tuple(_without_shape(term.name, term.value) for term in first.alike)
    plain = replace(first, parameter=lead.name, unit=lead.unit, alike=alike)
    return FreedomFamily(plain, tuple(shapes), len(family))


def _without_shape(name: str, value: float) -> Term:
    """The component error itself, `geometric(EXX,)`."""
    symbol = parse_symbol(name.partition("(")[2].partition(",")[0])
    unit = "rad" if symbol is not None and symbol.is_angular else "mm"
    return Term(f"geometric({symbol.name if symbol else ''},)", unit, value)
