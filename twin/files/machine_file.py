"""Machine file (TOML, "machine/1"): a chain in ISO notation and what is known of each axis."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field, Strict

from matstd.twin.errors import BadFile, BadValue, UnknownAxis
from matstd.twin.files.keys import Table, checked
from matstd.twin.files.toml import is_file, read_toml
from matstd.twin.files.unit_slips import refuse_unit_slips
from matstd.twin.frames import Array
from matstd.twin.machine import Axis, Chain, Link, make_chain
from matstd.twin.units import DEG, meant_in_radians

SHORTEST_TRAVEL = 5.0
"""A linear axis travels farther, mm; the smallest machining centres travel 20 mm. A travel in
metres is at most 5 or so."""
LONGEST_TRAVEL = 1e5  # no linear axis travels farther, mm; a travel of 300 mm in micrometres does
ROTARY_LETTERS, ALONG_ITS_LETTER = "ABC", 0.1
"""Rotary axes about X, Y and Z, and the least part of their lines along these (ISO 841); that of
inclined axes is half or more."""
ROOM = 500.0
"""A pivot lies at most so far beyond the box of all travels and the table, and their width, mm."""
NEAREST_PIVOT, FARTHEST_PIVOT = 0.05, 5.0
"""A coordinate of a pivot between these, mm, may be one in metres: 0.42 for 420 mm. Measured
centres of rotation differ from zero by hundredths of a millimetre."""
LONGEST_IN_METRES = 5e3  # in mm: no pivot lies farther
MOST_BELOW = 0.5  # share of the travel of the gauge point that may lie below the table's face
LEAST_AWAY = 50.0  # of a table from the line about which it turns, before that is strange, mm
NEARER = 4.0
"""Times that a pivot in metres is nearer to the table, or farther from the spindle, once read so;
only then is it one."""


def machine_slips(chain: Chain) -> Iterator[BadValue]:
    """Values of a machine that a slip of units or digits explains, and no machine has."""
    for link in chain.links:
        if link.kind != "fixed" and link.programmed:
            yield from _travel(chain, link)
    if len(chain.linear_axes) == 3:  # an arm states its joints one by one
        yield from _table(chain)
        for link in chain.links:
            if link.kind == "rotary" and link.programmed:
                yield from _letter(link)
                yield from _pivot(chain, link)


def _travel(chain: Chain, link: Link) -> Iterator[BadValue]:
    """Travels in metres and in radians; the one linear axis of a test bench may travel 2 mm."""
    low, high = link.range
    key = f"axis.{link.name}.range"
    is_bench = len(chain.linear_axes) == 1
    if link.kind == "linear" and not is_bench and 0.0 < high - low < SHORTEST_TRAVEL:
        found = f"{_pair(low, high)}, a travel of {high - low:.4g} mm"
        yield BadValue(key, found, f"mm; is it in metres, {_pair(1e3 * low, 1e3 * high)}?")
    if link.kind == "linear" and high - low > LONGEST_TRAVEL:
        found = f"{_pair(low, high)}, a travel of {1e-3 * (high - low):.4g} m"
        yield BadValue(key, found, f"mm; is it in µm, {_pair(1e-3 * low, 1e-3 * high)}?")
    if link.kind == "rotary":
        meant = meant_in_radians(low / DEG, high / DEG)
        if meant is not None:
            found = f"{_pair(low / DEG, high / DEG)}, a travel of {(high - low) / DEG:.3g} degrees"
            yield BadValue(key, found, f"degrees; is it in radians, {_pair(*meant)}?")


def _letter(link: Link) -> Iterator[BadValue]:
    """Rotary axes whose line is square to that of their letter."""
    parts = np.abs(link.direction) / np.linalg.norm(link.direction)
    if link.name not in ROTARY_LETTERS or parts[ROTARY_LETTERS.index(link.name)] > ALONG_ITS_LETTER:
        return
    along, turns = "XYZ"[ROTARY_LETTERS.index(link.name)], ROTARY_LETTERS[int(np.argmax(parts))]
    expected = f"a part along {along}, which {link.name} turns about; is it {turns}?"
    yield BadValue(f"axis.{link.name}.direction", _list(link.direction), expected)


def _pivot(chain: Chain, link: Link) -> Iterator[BadValue]:
    """Lines of rotary axes outside the machine, and in metres."""
    key = f"axis.{link.name}.point"
    low, high = _box(chain)
    point = _across(link.point, link)
    outside = np.maximum(low - point, point - high)
    outside[np.abs(point) < ROOM] = 0.0
    room = ROOM + float(np.max(high - low))
    if outside.max() > room:
        axis = int(np.argmax(outside))
        found = f"{_list(link.point)}, {outside[axis]:.0f} mm outside the travels along "
        yield BadValue(key, found + "XYZ"[axis], "a point within the machine, in mm")
    largest = float(np.abs(point).max())
    if not NEAREST_PIVOT < largest < FARTHEST_PIVOT or 1e3 * largest > LONGEST_IN_METRES:
        return
    mm = _list(1e3 * link.point)
    if link.carries_workpiece:
        table = _across(chain.table_origin, link)
        away = np.linalg.norm(table - point), np.linalg.norm(table - 1e3 * point)
        if away[0] > NEARER * away[1]:
            expected = f"mm, a point near the table at {_list(chain.table_origin)}"
            yield BadValue(key, _list(link.point), f"{expected}; is it in metres, {mm}?")
    elif abs(link.direction[2]) < 0.5:  # a head turns about a line far above the gauge point
        expected = "mm, a point tens of millimetres from the gauge point"
        yield BadValue(key, _list(link.point), f"{expected}; is it in metres, {mm}?")


def _table(chain: Chain) -> Iterator[BadValue]:
    """A table in metres: most travel of the gauge point lies below, or its line is far away."""
    origin, mm = chain.table_origin, 1e3 * chain.table_origin
    if not NEAREST_PIVOT < np.abs(origin).max() < FARTHEST_PIVOT:
        return
    low, high = _travels(chain)
    below = [(o[2] - low[2]) / max(high[2] - low[2], SHORTEST_TRAVEL) for o in (origin, mm)]
    is_above = below[0] > MOST_BELOW > below[1]
    lines = [link for link in chain.links if link.kind == "rotary" and link.carries_workpiece]
    away = [[np.linalg.norm(_across(o - k.point, k)) for o in (origin, mm)] for k in lines]
    is_far = any(stated > NEARER * meant and stated > LEAST_AWAY for stated, meant in away)
    if is_above or is_far:
        expected = f"mm, the centre of the table's face; is it in metres, {_list(mm)}?"
        yield BadValue("workpiece.origin", _list(origin), expected)


def _across(point: Array, link: Link) -> Array:
    """A point without its part along the line of an axis, (3,), mm."""
    along = link.direction / np.linalg.norm(link.direction)
    return np.asarray(point - (point @ along) * along)


def _box(chain: Chain) -> tuple[Array, Array]:
    """Smallest and largest coordinates of all that the tool reaches and of the table, mm."""
    low, high = _travels(chain)
    return np.minimum(low, chain.table_origin), np.maximum(high, chain.table_origin)


def _travels(chain: Chain) -> tuple[Array, Array]:
    """Smallest and largest coordinates of the gauge point, rotary axes at zero, mm."""
    low, high = np.zeros(3), np.zeros(3)
    for name in chain.linear_axes:
        link = chain.link(name)
        ends = np.outer(link.range, link.direction)
        low, high = low + ends.min(axis=0), high + ends.max(axis=0)
    return low, high


def _pair(low: float, high: float) -> str:
    return _list(np.array([low, high]))


def _list(values: Array) -> str:
    return f"[{', '.join(f'{v:.6g}' for v in values)}]"


KILOMETRE = 1e6  # in mm: nothing of a machine lies, and no axis travels, farther; degrees neither

Coordinate = Annotated[float, Field(ge=-KILOMETRE, le=KILOMETRE)]
Vector = Annotated[tuple[Coordinate, Coordinate, Coordinate], Strict(False)]  # TOML has lists
Pair = Annotated[tuple[float, float], Strict(False)]
Range = Annotated[tuple[Coordinate, Coordinate], Strict(False)]


class AxisTable(Table):
    """`[axis.X]`: range in mm or degrees, point, pitch and expected errors in mm, direction."""

    range: Range | None = Field(default=None, examples=[[-200.0, 200.0]])
    """smallest and largest reading, mm or degrees; needed for every axis that is programmed"""
    point: Vector | None = Field(default=None, examples=[[0.0, 0.0, -420.0]])
    """reference point of the angular errors of a linear axis, a point on the line of a rotary one:
    mm, machine frame, every axis at zero. Default: the machine origin, with a remark for a rotary
    axis"""
    direction: Vector | None = Field(default=None, examples=[[0.0, 0.0, 1.0]])
    """direction of travel or of the line, machine frame. Default: the direction of the letter"""
    pitch: float | None = Field(default=None, examples=[10.0])
    """pitch of the screw or scale of a linear axis, mm. `diagnose` searches for errors at it and
    at its whole fractions even if the targets are too far apart to resolve them, and prefers them
    among periods that the targets cannot distinguish. `diagnose --pitch X=10` has the same
    effect"""
    expected: float | None = Field(default=None, examples=[0.01])
    """usual size of each translational error of a linear axis (EXX, EYX, EZX), mm. An error that
    exceeds it significantly is reported as larger than expected; a fit is as free as the class of
    the error permits. Default: that of the class, 77 µm. `matstd import` writes 1 µm and 15 ppm of
    the travel"""

    def axis(self, name: str) -> Axis:
        """What the table says of the axis of that name, base units."""
        factor = DEG if name[:1] in "ABC" else 1.0
        low, high = self.range or (0.0, 0.0)
        travel = None if self.range is None else (low * factor, high * factor)
        return Axis(
            range=travel,
            point=self.point,
            direction=self.direction,
            pitch=self.pitch,
            expected=self.expected,
        )


class WorkpieceTable(Table):
    """`[workpiece]`: origin of the table frame, mm."""

    origin: Vector = (0.0, 0.0, 0.0)
    """origin of the table frame, mm, machine frame, every axis at zero"""


class MachineTables(Table):
    """A machine as it stands in its own file and in model files."""

    name: str = Field(examples=["Small mill"])
    """name of the machine, for reports"""
    chain: str = Field(examples=["[w C' B' X' f Y Z (C1) t]"])
    """ISO notation from workpiece `w` over foundation `f` to tool `t`; a prime marks an axis that
    carries the workpiece, brackets a spindle whose angle is not programmed, or an axis that stays
    at zero, such as a quill `(W)` beside Z"""
    axis: dict[str, AxisTable]
    """a table `[axis.X]` for every programmed axis"""
    workpiece: WorkpieceTable = WorkpieceTable()
    """the table `[workpiece]`"""

    def made(self, path: str | Path, within: str = "") -> Chain:
        """The machine in base units; raises BadFile, with the key `within` of these tables."""
        axes = {name: table.axis(name) for name, table in self.axis.items()}
        try:
            return make_chain(self.name, self.chain, axes, self.workpiece.origin)
        except UnknownAxis as error:
            raise BadFile.of(path, error, within, f"axis.{error.facts['key']}") from error
        except BadValue as error:
            raise BadFile.of(path, error, within=within) from error


class MachineFile(MachineTables):
    """The whole file."""

    format: str = Field(examples=["machine/1"])
    """kind and version of the file, `"machine/1"`"""
    bodies: dict[str, str] | None = None
    """drawings of the bodies of the machine for `matstd show`. The key is a link (an axis, `w`,
    `t`, or `f` for the foundation), the value an STL, OBJ, PLY or STEP file seen from the machine
    file, in mm, machine frame with every axis at zero. Links without a drawing are plain solids.
    No result depends on it"""


def read_machine(path: str | Path, named_in: str | Path | None = None) -> Chain:
    """Machine from its file; raises BadFile.

    Args:
        named_in: File that names it by a path relative to itself; None for a path as it is.
    """
    if named_in is not None:
        named, path = path, Path(named_in).parent / path
        if not is_file(path):
            found = f"{str(named)!r}, and {path} is no file"
            expected = "the path of a machine file, relative to this file"
            raise BadFile(named_in, "machine", found, expected)
    tables = checked(MachineFile, read_toml(path, "machine/1"), path)
    refuse_unit_slips(tables, path)
    chain = tables.made(path)
    slips = [BadFile.of(path, slip) for slip in machine_slips(chain)]
    if slips:
        raise BadFile.several(slips)
    known, drawings = ["f", *(link.name for link in chain.links)], tables.bodies or {}
    for name in drawings:
        if name not in known:
            raise BadFile(path, "bodies", name, f"one of {', '.join(known)}")
    # a drawing is seen from the machine file
    return replace(chain, drawings={name: Path(path).parent / d for name, d in drawings.items()})
