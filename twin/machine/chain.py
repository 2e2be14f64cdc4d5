"""Machines in ISO chain notation, `[w C' B' X' f Y Z (C1) t]`, as an ordered tuple of links."""

import hashlib
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import groupby
from pathlib import Path

import numpy as np

from matstd.twin.display import Displayed
from matstd.twin.errors import BadValue, UnknownAxis, UnknownSymbol
from matstd.twin.frames import Array
from matstd.twin.machine.contribution import Where
from matstd.twin.machine.link import Kind, Link
from matstd.twin.machine.symbols import ALONG, Family, Symbol, parse_symbol
from matstd.twin.numbers import significant
from matstd.twin.units import DEG

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


_SAME = 1e-6  # machines whose numbers differ by less (mm, rad) are equal
SHORTEST = 1e-6  # directions shorter than this are refused
FLATTEST = 0.01
"""Smallest singular value of the directions of linear axes: below, two of three axes stand within
about a degree of one another."""
OPEN_CHAIN = 4
"""From this many rotary axes in series on the tool side, they are joints of an arm; heads of
machine tools have two or three."""
SPINDLE_RANGE = (-360.0 * DEG, 360.0 * DEG)
"""Range of a bracketed spindle without an entry in the machine file, rad."""


@dataclass(frozen=True)
class Axis:
    """Entry of one axis in a machine file, base units; None where a key is missing."""

    range: tuple[float, float] | None = None
    point: tuple[float, float, float] | None = None
    direction: tuple[float, float, float] | None = None
    pitch: float | None = None
    expected: float | None = None


@dataclass(frozen=True, eq=False, repr=False)
class Chain(Displayed):
    """A machine: its links from workpiece to tool, and the position of its table."""

    name: str  # as its file states it
    notation: str  # ISO chain notation as the user wrote it
    links: tuple[Link, ...]  # `w` first, `t` last, without the foundation
    # origin of the table frame, machine frame with every axis at zero, (3,), mm
    table_origin: Array = field(default_factory=lambda: np.zeros(3))
    # rotary axes without a stated line; they are assumed to turn about a line through the machine's
    # origin
    assumed_points: tuple[str, ...] = ()
    # files that draw the bodies of links, `f` for the foundation; pictures alone depend on them
    drawings: Mapping[str, Path] = field(default_factory=dict)

    @property
    def remarks(self) -> tuple[str, ...]:
        """What the machine file leaves open and what is assumed instead, one line each."""
        return tuple(
            f"axis {axis} has no point in the machine file: it is assumed to turn about a line "
            "through the origin of the machine"
            for axis in self.assumed_points
        )

    @cached_property
    def axes(self) -> tuple[str, ...]:
        """Names of the moving links in chain order, spindle included: the columns of readings."""
        return tuple(link.name for link in self.links if link.kind != "fixed")

    @cached_property
    def programmed_axes(self) -> tuple[str, ...]:
        """Names of the axes that a program positions."""
        return tuple(link.name for link in self.links if link.kind != "fixed" and link.programmed)

    @cached_property
    def linear_axes(self) -> tuple[str, ...]:
        """Names of the programmed linear axes in chain order."""
        return tuple(ln.name for ln in self.links if ln.kind == "linear" and ln.programmed)

    @cached_property
    def rotary_axes(self) -> tuple[str, ...]:
        """Names of the programmed rotary axes in chain order."""
        return tuple(ln.name for ln in self.links if ln.kind == "rotary" and ln.programmed)

    @cached_property
    def linear_columns(self) -> list[int]:
        """Columns of the programmed linear axes in an array of readings (N, A), in chain order."""
        return [self.axis_index(name) for name in self.linear_axes]

    @cached_property
    def rotary_columns(self) -> list[int]:
        """Columns of the programmed rotary axes in an array of readings (N, A), in chain order."""
        return [self.axis_index(name) for name in self.rotary_axes]

    @property
    def travels(self) -> Array:
        """Smallest and largest reading of every axis, (A, 2), mm and rad."""
        return np.array([self.link(name).range for name in self.axes])

    @cached_property
    def tool_rotary_axes(self) -> tuple[str, ...]:
        """Programmed rotary axes that carry the tool, from the foundation outwards."""
        return tuple(n for n in self.rotary_axes if not self.link(n).carries_workpiece)

    @cached_property
    def carrying_axes(self) -> tuple[str, ...]:
        """Axes that carry the workpiece, the innermost first; a spindle that turns it is one."""
        return tuple(name for name in self.axes if self.link(name).carries_workpiece)

    @cached_property
    def joints(self) -> tuple[str, ...]:
        """Joints of an open chain, from the foundation outwards; none on a machine tool."""
        return tuple(link.name for link in self.links if link.is_joint)

    @cached_property
    def arrangement(self) -> str:
        """Order of the programmed axes from workpiece to tool, F the foundation: `C-B-X-F-Y-Z`.

        Neighbouring linear axes of one side move the tool alike in any order, so they are sorted.
        """
        programmed = [ln for ln in self.links if ln.kind != "fixed" and ln.programmed]
        order: list[str] = []
        for (_, kind), group in groupby(programmed, lambda ln: (ln.carries_workpiece, ln.kind)):
            names = [link.name for link in group]
            order += sorted(names) if kind == "linear" else names
        order.insert(sum(link.carries_workpiece for link in programmed), "F")
        return "-".join(order)

    @property
    def turns_workpiece(self) -> bool:
        """Whether a rotary axis carries the workpiece."""
        return len(self.tool_rotary_axes) < len(self.rotary_axes)

    def twist_of(self, symbol: Symbol) -> Where:
        """Where a component error acts."""
        return Where("twist", self.link_index(symbol.link), symbol.component)

    def axis_index(self, name: str) -> int:
        """Column of an axis in an array of readings (N, A); raises UnknownAxis."""
        if name not in self.axes:
            raise UnknownAxis(name, self.axes)
        return self.axes.index(name)

    def link_index(self, name: str) -> int:
        """Place of a link, also `w` and `t`, in arrays over links (N, L, 6); raises UnknownAxis."""
        place = self._places.get(name)
        if place is None:
            raise UnknownAxis(name, list(self._places))
        return place

    @cached_property
    def _places(self) -> dict[str, int]:
        """Place of every link by its name: asked for by every term of every effect."""
        return {link.name: i for i, link in enumerate(self.links)}

    def link(self, name: str) -> Link:
        """The link of that name; raises UnknownAxis."""
        return self.links[self.link_index(name)]

    @cached_property
    def symbols(self) -> tuple[Symbol, ...]:
        """Every error parameter of this machine: component, location, set-up of workpiece and tool.

        Six components an axis; location errors: the zero position and two squarenesses of a linear
        axis, two displacements, two tilts and the zero position of a rotary axis; six constants of
        the workpiece; five of the tool (not its rotation about itself). For
        `[w C' B' X' f Y Z (C1) t]` these are 36 + 24 + 6 + 5 = 71.
        """
        moving = [link for link in self.links if link.kind != "fixed"]
        component = [Symbol(i, ln.name, Family.COMPONENT) for ln in moving for i in range(6)]
        location = [Symbol(i, ln.name, Family.LOCATION) for ln in moving for i in _location(ln)]
        workpiece = [Symbol(i, "w", Family.SETUP) for i in range(6)]
        tool = [Symbol(i, "t", Family.SETUP) for i in range(5)]
        return tuple(component + location + workpiece + tool)

    def symbol(self, name: str) -> Symbol:
        """The error parameter of that name; raises UnknownSymbol."""
        symbol = parse_symbol(name)
        if symbol is None or symbol not in self.symbols:
            raise UnknownSymbol(name, (s.name for s in self.symbols))
        return symbol

    def with_pitch(self, name: str, pitch: float) -> "Chain":
        """The same machine with the pitch of a linear axis stated, mm.

        Raises:
            UnknownAxis: The machine has no such axis.
            BadValue: The axis is not linear, or the pitch is no length.
        """
        at = self.link_index(name)
        checked_length(self.links[at].kind, name, "pitch", pitch)
        links = list(self.links)
        links[at] = replace(links[at], pitch=pitch)
        return replace(self, links=tuple(links))

    def difference(self, other: "Chain") -> tuple[str, str, str] | None:
        """The first difference between two machines, None if they are equal.

        Travels count too: the shapes of component errors are scaled to them.

        Returns:
            Key of a machine file, this machine's value, the other's.
        """
        if self.name != other.name:
            return "name", repr(self.name), repr(other.name)
        if self.notation.split() != other.notation.split():
            return "chain", self.notation, other.notation
        if not np.allclose(self.table_origin, other.table_origin, rtol=0.0, atol=_SAME):
            return "workpiece.origin", _listed(self.table_origin), _listed(other.table_origin)
        for a, b in zip(self.links, other.links, strict=True):
            for key in ("range", "point", "direction"):
                left, right = np.array(getattr(a, key)), np.array(getattr(b, key))
                if not np.allclose(left, right, rtol=0.0, atol=_SAME):
                    factor = a.unit if key == "range" else 1.0
                    return f"axis.{a.name}.{key}", _listed(left / factor), _listed(right / factor)
        return None

    @cached_property
    def fingerprint(self) -> str:
        """Short digest of what `difference` compares; saved models state that of their machine."""
        numbers = [np.array(self.table_origin)]
        for link in self.links:
            numbers += [np.array(getattr(link, key)) for key in ("range", "point", "direction")]
            # models of before, whose errors have the directions of the machine, are refused
            numbers += [] if link.is_along_letter else [link.frame]
        text = " ".join(f"{v + 0.0:.6f}" for part in numbers for v in np.round(part, 6).ravel())
        words = f"{self.name} {' '.join(self.notation.split())} {text}"
        return hashlib.sha256(words.encode()).hexdigest()[:12]


def _location(link: Link) -> list[int]:
    """Components of the location errors of an axis.

    A displacement along a rotary axis's own line and, for a linear axis, any displacement across
    its direction change nothing; a rotation about the axis's own direction is the zero position of
    a rotary axis and nothing for a linear one. For a free direction the letter decides.
    """
    others = [i for i in range(3) if i != link.own]
    if link.kind == "linear":
        return [link.own] + [3 + i for i in others]
    return [*others, 3, 4, 5]


def _listed(values: Array) -> str:
    return f"[{', '.join(f'{v:.9g}' for v in values)}]"


def make_chain(
    name: str,
    notation: str,
    axes: Mapping[str, Axis],
    table_origin: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> Chain:
    """Machine from its notation and what is known of each axis.

    Args:
        axes: By name, mm and rad; a bracketed spindle may be left out.
        table_origin: Origin of the table frame, machine frame with every axis at zero, mm.

    Raises:
        BadValue: A notation that cannot be read, an axis without range, a direction of length
            zero, a range with its ends swapped.
        UnknownAxis: An entry for an axis that is not in the chain.
    """
    parsed = parse_notation(notation)
    for key in axes:
        if key not in [n for n, _, _ in parsed]:
            raise UnknownAxis(key, [n for n, _, _ in parsed])
    origin = np.array(table_origin, dtype=float)
    moving = [_make_link(n, primed, prog, axes.get(n, Axis())) for n, primed, prog in parsed]
    _check_directions([link for link in moving if link.kind == "linear"])
    links = [_end("w", True, origin), *moving, _end("t", False, np.zeros(3))]
    rotary = [link for link in links if link.kind == "rotary" and link.programmed]
    assumed = tuple(k.name for k in rotary if axes.get(k.name, Axis()).point is None)
    # a long series of rotary axes is an arm: its links have tolerances of another class
    in_series = [link for link in rotary if not link.carries_workpiece]
    is_open = len(in_series) >= OPEN_CHAIN
    return Chain(
        name=name,
        notation=notation,
        links=tuple(replace(k, is_joint=True) if is_open and k in in_series else k for k in links),
        table_origin=origin,
        assumed_points=assumed,
    )


def _end(name: str, carries_workpiece: bool, point: Array) -> Link:
    """The workpiece or the tool: a link that does not move."""
    return Link(
        name=name,
        kind="fixed",
        carries_workpiece=carries_workpiece,
        direction=np.zeros(3),
        point=point,
        range=(0.0, 0.0),
    )


def _check_directions(linear: list[Link]) -> None:
    """Refuse linear axes of different letters that move in one plane, or along one line."""
    letters = {link.own for link in linear}
    if len(letters) < 2:
        return
    strength = np.linalg.svd(np.array([link.direction for link in linear]), compute_uv=False)
    if len(strength) < len(letters) or strength[len(letters) - 1] < FLATTEST:
        names = ", ".join(link.name for link in linear)
        where = "in one plane" if len(letters) == 3 else "along one line"
        raise BadValue("axis", f"directions of {names} that lie {where}", "directions that span")


def checked_length(kind: Kind, name: str, key: str, value: float | None) -> None:
    """Refuse values that are no length, or belong to a rotary axis; raises BadValue."""
    if value is None:
        return
    if kind != "linear":
        raise BadValue(f"axis.{name}.{key}", value, f"none: only a linear axis has a {key} in mm")
    if not 0.0 < value < np.inf:
        raise BadValue(f"axis.{name}.{key}", value, "a length in mm above 0")


def _make_link(name: str, primed: bool, programmed: bool, axis: Axis) -> Link:
    """Link of one axis with its defaults filled in."""
    kind: Kind = "linear" if name[0] in "XYZUVW" else "rotary"
    reach = axis.range if axis.range is not None or programmed else SPINDLE_RANGE
    if reach is None:
        raise BadValue(f"axis.{name}.range", "nothing", "its smallest and largest reading")
    if not reach[0] < reach[1]:
        unit = 1.0 if kind == "linear" else DEG
        found = [significant(end / unit, 12) for end in reach]
        raise BadValue(f"axis.{name}.range", found, "the smaller reading first")
    own = np.eye(3)["XYZ".index(ALONG[name[0]])]
    # letters give the direction by ISO 841 unless the file states another
    direction = own if axis.direction is None else np.array(axis.direction, dtype=float)
    length = float(np.linalg.norm(direction))
    if not length > SHORTEST:
        raise BadValue(f"axis.{name}.direction", f"a vector of length {length:g}", "a unit vector")
    point = np.array(axis.point or (0.0, 0.0, 0.0), dtype=float)
    checked_length(kind, name, "pitch", axis.pitch)
    checked_length(kind, name, "expected", axis.expected)
    return Link(
        name=name,
        kind=kind,
        carries_workpiece=primed,
        direction=direction / length,
        point=point,
        range=reach,
        programmed=programmed,
        pitch=axis.pitch,
        expected=axis.expected,
    )
