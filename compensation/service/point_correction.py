"""The correction of one point at a time, in plain numbers: fast enough while a machine moves.

The same steps as `matstd.compensation.field.correction`, for one point and without arrays. From the
tool to the workpiece every link moves the point by its motion and its component error; lines of
axes that stand askew are put askew once, errors come from tables. Rotations by errors are taken to
second order: what is left out is a sixth of the third power of an angle, 0.2 nm at a metre and
1 mrad.
"""

from collections.abc import Mapping, Sequence
from copy import copy
from itertools import pairwise
from math import cos, sin
from typing import NamedTuple

import numpy as np

from matstd.compensation.field import Datum, MachineErrors
from matstd.compensation.service.tabulated import (
    MAX_INTERPOLATION,
    ErrorTable,
    History,
    error_tables,
)
from matstd.twin.errors import DesignError, OutsideTravel
from matstd.twin.frames import Array, rotation
from matstd.twin.machine import Chain, Link

Point = tuple[float, float, float]
Six = tuple[float, ...]
Columns = list[Point]

_STEPS = 2  # of the inverse: the first leaves some 1e-4 of an error, the second 1e-8
_TRAVEL_TOLERANCE = 1e-9  # mm or rad by which a reading may lie beyond its travel


class _Source(NamedTuple):
    """Errors of one link from one table, or one table for each direction of an axis."""

    axes: tuple[int, ...]
    low: tuple[float, ...]  # smallest reading of each
    per: tuple[float, ...]  # cells per unit of each reading
    last: tuple[int, ...]  # number of the last cell along each
    turn: int  # number of the axis whose direction chooses the table, -1 for none
    # by direction, errors at the corners of the cells, the last reading running first
    cells: dict[int, list[tuple[Six, ...]]]


class _Step(NamedTuple):
    """A link on the way of the point: its line where it really is, and where it should be."""

    axis: int
    is_linear: bool  # or else rotary
    workpiece: bool  # whether it carries the workpiece, so that its error comes before its motion
    offset: float  # added to the reading: the zero of the axis is displaced
    direction: Point
    point: Point
    ideal: Point  # direction of the line without errors
    lever: Point  # point that angular errors turn about, every axis at zero
    carries: float  # by how much the lever goes along with the reading, in `ideal`: 0, 1 or -1
    sources: tuple[_Source, ...]
    column: int  # number of the linear axis that it is, -1 for none


class PointCorrection:
    """What is added to the linear axes at one pose, for a machine in one state.

    Attributes:
        linear_axes: Names of the axes that are corrected, in the order of the corrections.
        interpolation: What tables leave at most between their points, mm at the tip, all tables
            added up.

    Example:
        corrects = PointCorrection(errors, 160.0, datum)
        dx, dy, dz = corrects.at((10.0, -20.0, -200.0, 0.0, 0.5))
    """

    def __init__(
        self,
        errors: MachineErrors,
        length: float,
        datum: Datum | None = None,
        close: float = MAX_INTERPOLATION,
    ) -> None:
        """Tabulate the errors.

        Args:
            datum: Pose at which nothing is corrected; None to correct the whole deviation.
            close: What straight lines between the points of one table may leave, mm at the tip.

        Raises:
            DesignError: A machine without three linear axes, or an error that no table holds.
        """
        chain = errors.chain
        if len(chain.linear_axes) != 3:
            found = f"machine {chain.name} has {len(chain.linear_axes)} linear axes"
            raise DesignError(f"{found}, three are needed to correct while it moves")
        self._chain, self.linear_axes = chain, tuple(chain.linear_axes)
        self._tables = error_tables(errors, length, close)
        self.interpolation = float(sum(t.left for t in self._tables))
        self._places = _places(errors, length)
        self._columns = tuple(chain.linear_columns)
        self._links = [chain.link(name) for name in chain.axes]
        self._tip = (0.0, 0.0, -float(length))
        self._aim = (0.0, 0.0, 0.0) if datum is None else _point(datum.deviation(errors))
        self._steps = _way(chain, self._places, self._tables)

    def following(
        self, history: History, learnt: Mapping[str, Array] | None = None
    ) -> "PointCorrection":
        """The same machine at the end of a history; what it stands on is not made again.

        The datum stays where it was set, so that what the machine has drifted since is corrected.

        Args:
            learnt: Parameters that are other ones by now, by the name of their effect.
        """
        other = copy(self)
        other._tables = [t.following(history, learnt) if t.is_driven else t for t in self._tables]
        other._steps = _way(self._chain, self._places, other._tables)
        return other

    def at(self, readings: Sequence[float], directions: Sequence[int] | None = None) -> Point:
        """Corrections of the three linear axes.

        Args:
            readings: Readings of every axis in the chain's order, mm and rad.
            directions: Sign of the last motion of every axis; None where unknown.

        Returns:
            What is to be added, mm, in the order of `linear_axes`.

        Raises:
            OutsideTravel: A reading beyond the travel of its axis.
        """
        self._check(readings)
        q, signs = list(readings), directions or (0,) * len(readings)
        columns: Columns = [(0.0, 0.0, 0.0)] * 3
        nominal = self._nominal(q, columns)
        wx, wy, wz = (w + a for w, a in zip(nominal, self._aim, strict=True))
        first, second, third = columns
        across = _cross(second, third), _cross(third, first), _cross(first, second)
        volume = _dot(first, across[0])
        added = [0.0, 0.0, 0.0]
        for _ in range(_STEPS):
            x, y, z = self._actual(q, signs)
            left = (x - wx, y - wy, z - wz)
            for k, column in enumerate(self._columns):
                step = _dot(across[k], left) / volume
                added[k] -= step
                q[column] -= step
        return added[0], added[1], added[2]

    def _check(self, readings: Sequence[float]) -> None:
        for value, link in zip(readings, self._links, strict=True):
            low, high = link.range
            if not low - _TRAVEL_TOLERANCE <= value <= high + _TRAVEL_TOLERANCE:
                word = "degrees" if link.kind == "rotary" else "mm"
                travel = f"{low / link.unit:g} to {high / link.unit:g}"
                found = f"{link.name} {value / link.unit:g} {word}"
                raise OutsideTravel(f"{found}, beyond its travel {travel}")

    def _nominal(self, q: Sequence[float], columns: Columns) -> Point:
        """Tool point without errors, and how it moves with each linear axis, from the table."""
        x = self._tip
        for step in self._steps:
            if step.is_linear:
                x = _along(x, q[step.axis], step.ideal)
                columns[step.column] = step.ideal
            else:
                c, s = cos(q[step.axis]), sin(q[step.axis])
                x = _turned_about(x, step.lever, step.ideal, c, s)
                for k, column in enumerate(columns):
                    columns[k] = _about(step.ideal, c, s, column)
        return x

    def _actual(self, q: Sequence[float], signs: Sequence[int]) -> Point:
        """Tool point with every error."""
        x = self._tip
        for step in self._steps:
            reading = q[step.axis]
            if step.workpiece and step.sources:
                x = _with_error(x, step, reading, _errors(step.sources, q, signs))
            travel = reading + step.offset
            if step.is_linear:
                x = _along(x, travel, step.direction)
            else:
                x = _turned_about(x, step.point, step.direction, cos(travel), sin(travel))
            if not step.workpiece and step.sources:
                x = _with_error(x, step, reading, _errors(step.sources, q, signs))
        return x


def _way(chain: Chain, place: Array, tables: Sequence[ErrorTable]) -> list[_Step]:
    """The links that move the point, from the tool to the foundation and on to the workpiece."""
    numbers = range(len(chain.links))
    way = [i for i in numbers if not chain.links[i].carries_workpiece][::-1]
    way += [i for i in numbers if chain.links[i].carries_workpiece][::-1]
    return [
        _step(chain, chain.links[i], place[i], _sources(tables, i, chain.links[i]))
        for i in way
        if chain.links[i].kind != "fixed"
    ]


def _step(chain: Chain, link: Link, place: Array, sources: tuple[_Source, ...]) -> _Step:
    """One link with its line displaced and tilted, about its point."""
    is_linear, moved = link.kind == "linear", place.copy()
    if not is_linear:
        moved[link.own_component] = 0.0
    moved = link.in_machine(moved)
    side = -1.0 if link.carries_workpiece else 1.0
    shift = np.zeros(3) if is_linear else moved[:3]
    return _Step(
        axis=chain.axis_index(link.name),
        is_linear=is_linear,
        workpiece=link.carries_workpiece,
        offset=float(place[link.own_component]),
        direction=_point(rotation(moved[3:]) @ link.direction),
        point=_point(link.point + shift),
        ideal=_point(link.direction),
        lever=_point(link.point),
        carries=side if is_linear else 0.0,
        sources=sources,
        column=chain.linear_axes.index(link.name) if is_linear else -1,
    )


def _places(errors: MachineErrors, length: float) -> Array:
    """Displacements of every link's line, which are constant, (L, 6)."""
    middle = errors.chain.travels.mean(axis=1)[None]
    return np.asarray(errors.contribution(errors.touches(middle, length)).place[0])


def _sources(tables: Sequence[ErrorTable], i: int, link: Link) -> tuple[_Source, ...]:
    """Tables that have errors of link i, those of one axis's directions together."""
    out: dict[tuple[object, ...], _Source] = {}
    for table in tables:
        rows = link.in_machine(table.rows[..., i, :])
        if not rows.any():
            continue
        turn, sign = next(iter(table.turns.items()), (-1, 0))
        key = (table.axes, turn)
        if key not in out:
            out[key] = _Source(
                axes=table.axes,
                low=tuple(map(float, table.ends[:, 0])),
                per=tuple(1.0 / float(step) for step in table.step),
                last=tuple(n - 2 for n in rows.shape[:-1]),
                turn=turn,
                cells={},
            )
        out[key].cells[sign] = _cells(rows)
    return tuple(out.values())


def _cells(rows: Array) -> list[tuple[Six, ...]]:
    """Errors at the corners of every cell, (*points, 6)."""
    six = [tuple(map(float, row)) for row in rows.reshape(-1, 6)]
    if rows.ndim == 1:
        return [(six[0],)]
    if rows.ndim == 2:
        return list(pairwise(six))
    n, m = rows.shape[:2]
    at = [(i * m + j) for i in range(n - 1) for j in range(m - 1)]
    return [(six[k], six[k + 1], six[k + m], six[k + m + 1]) for k in at]


def _errors(sources: tuple[_Source, ...], q: Sequence[float], signs: Sequence[int]) -> Six:
    """Component errors of a link at some readings, by straight lines between their points."""
    found = [_from(source, q, signs) for source in sources]
    return found[0] if len(found) == 1 else tuple(map(sum, zip(*found, strict=True)))


def _from(source: _Source, q: Sequence[float], signs: Sequence[int]) -> Six:
    cells = source.cells.get(0 if source.turn < 0 else int(signs[source.turn]))
    if cells is None:
        return _NO_CORRECTION
    if not source.axes:
        return cells[0][0]
    i, f = _cell(source, 0, q)
    if len(source.axes) == 1:
        a, b = cells[i]
        e = 1.0 - f
        return (
            e * a[0] + f * b[0],
            e * a[1] + f * b[1],
            e * a[2] + f * b[2],
            e * a[3] + f * b[3],
            e * a[4] + f * b[4],
            e * a[5] + f * b[5],
        )
    j, g = _cell(source, 1, q)
    a, b, c, d = cells[i * (source.last[1] + 1) + j]
    weights = (1.0 - f) * (1.0 - g), (1.0 - f) * g, f * (1.0 - g), f * g
    s, t, u, v = weights
    return tuple(s * a[k] + t * b[k] + u * c[k] + v * d[k] for k in range(6))


_NO_CORRECTION: Six = (0.0,) * 6


def _cell(source: _Source, k: int, q: Sequence[float]) -> tuple[int, float]:
    """Number of the cell along one reading, and how far the reading is in it."""
    at = (q[source.axes[k]] - source.low[k]) * source.per[k]
    cell = min(max(int(at), 0), source.last[k])
    return cell, at - cell


def _with_error(x: Point, step: _Step, reading: float, six: Six) -> Point:
    """A point after the component error of a link, angles to second order."""
    dx, dy, dz, a, b, c = six
    far = step.carries * reading
    px, py, pz = step.lever
    ix, iy, iz = step.ideal
    vx, vy, vz = x[0] - px - far * ix, x[1] - py - far * iy, x[2] - pz - far * iz
    ux, uy, uz = b * vz - c * vy, c * vx - a * vz, a * vy - b * vx
    return (
        x[0] + dx + ux + 0.5 * (b * uz - c * uy),
        x[1] + dy + uy + 0.5 * (c * ux - a * uz),
        x[2] + dz + uz + 0.5 * (a * uy - b * ux),
    )


def _along(x: Point, travel: float, d: Point) -> Point:
    return x[0] + travel * d[0], x[1] + travel * d[1], x[2] + travel * d[2]


def _turned_about(x: Point, p: Point, d: Point, c: float, s: float) -> Point:
    """A point turned about a line by an angle of this cosine and sine."""
    v = _about(d, c, s, (x[0] - p[0], x[1] - p[1], x[2] - p[2]))
    return p[0] + v[0], p[1] + v[1], p[2] + v[2]


def _about(d: Point, c: float, s: float, v: Point) -> Point:
    """A vector turned about a unit direction: Rodrigues' formula."""
    dx, dy, dz = d
    vx, vy, vz = v
    along = (1.0 - c) * (dx * vx + dy * vy + dz * vz)
    return (
        c * vx + s * (dy * vz - dz * vy) + along * dx,
        c * vy + s * (dz * vx - dx * vz) + along * dy,
        c * vz + s * (dx * vy - dy * vx) + along * dz,
    )


def _cross(a: Point, b: Point) -> Point:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _dot(a: Point, b: Point) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _point(v: Array) -> Point:
    return float(v[0]), float(v[1]), float(v[2])
