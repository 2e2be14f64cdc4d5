"""Tables of corrections over single axes, as controls without a volumetric model hold them."""

from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from matstd.compensation.field import (
    Datum,
    MachineErrors,
    aligned,
    correction,
    deviation,
    deviation_after,
)
from matstd.compensation.tables.by_name import (
    CHECKED_PLACES,
    interpolated,
    line,
    on_table,
    points_needed,
    span,
)
from matstd.twin.frames import Array
from matstd.twin.machine import Chain, Contribution, linear_directions
from matstd.twin.numbers import rms_length
from matstd.twin.record import Touches
from matstd.twin.units import NM

MIN_GAIN = 50.0 * NM  # a table that lowers the rms error by less is not written, mm


@dataclass(frozen=True, eq=False)
class AxisTable:
    """A correction of one axis over the reading of one, the same or another."""

    over: str  # axis whose reading counts
    moves: str  # axis that is corrected
    nodes: Array  # readings, ascending, (n,), mm or rad
    forward: Array  # correction after a positive motion of `over`, (n,), mm or rad
    reverse: Array  # the same after a negative motion

    @property
    def is_left_out(self) -> bool:
        """Whether it corrects at most what depends on the direction of motion (`harmless`)."""
        return not np.any(self.forward + self.reverse)

    @property
    def moved(self) -> tuple[int, ...]:
        """Directions of motion with a correction of their own; 0 for one between both."""
        return (0,) if np.array_equal(self.forward, self.reverse) else (1, -1)

    @property
    def reversal(self) -> "AxisTable":
        """What of it depends on the direction of motion alone."""
        half = 0.5 * (self.forward - self.reverse)
        return replace(self, forward=half, reverse=-half)


@dataclass(frozen=True, eq=False)
class AxisTables:
    """Corrections that add up; exact on the lines through the datum, where they were made."""

    chain: Chain
    tables: tuple[AxisTable, ...]

    def correction(self, touches: Touches) -> Array:
        """Readings that the control adds, (N, A); between both directions where none is known."""
        out = np.zeros_like(touches.q)
        for table in self.tables:
            at = on_table(touches.reading(table.over), table.nodes, self.chain.link(table.over))
            ways = [np.interp(at, table.nodes, v) for v in (table.forward, table.reverse)]
            share = 0.5 * (1.0 + touches.last_move(table.over))
            out[:, self.chain.axis_index(table.moves)] += share * ways[0] + (1.0 - share) * ways[1]
        return out


def along_axes(errors: MachineErrors, datum: Datum, most: int, crosswise: bool) -> AxisTables:
    """Corrections along the lines through the datum.

    Args:
        datum: Through which the lines go, with the tool that is in the spindle there.
        most: Points of an axis that the format holds.
        crosswise: Whether an axis may correct others, in both directions alike; else every axis
            corrects itself, each direction by itself, over all of its travel: LinuxCNC holds the
            last value beyond a table and knows no turns.
    """
    chain = errors.chain
    needed = _Needed(errors, datum)
    out = []
    for axis in chain.programmed_axes:
        ends = span(chain.link(axis)) if crosswise else chain.link(axis).range
        count = points_needed(ends, most, partial(needed.along, axis, move=1), np.max)
        nodes = np.linspace(*ends, count)
        ways = [needed.along(axis, nodes, move) for move in _moves(errors, axis, crosswise)]
        names = [*chain.linear_axes, axis] if crosswise else [axis]
        for name in dict.fromkeys(names):
            k = chain.axis_index(name)
            own = needed.zero[k] if name == axis else 0.0
            forward, reverse = ways[0][:, k] + own, ways[-1][:, k] + own
            out.append(AxisTable(axis, name, nodes, forward=forward, reverse=reverse))
    return AxisTables(chain, tuple(out))


@dataclass(frozen=True, eq=False)
class _Needed:
    """What has to be added along the lines through a datum, beside the zeros of the axes."""

    errors: MachineErrors
    datum: Datum

    @cached_property
    def there(self) -> Touches:
        return self.datum.touches(self.errors)

    @cached_property
    def zero(self) -> Array:
        """Correction of the zeros of the axes, (A,), mm and rad.

        What the linear axes do wrong at the datum displaces them against the lines of the rotary
        axes, and what a rotary axis does wrong there tilts the lines of those that it carries: a
        preset takes it up at one angle of the table and doubles it at the opposite one.
        """
        linear = correction(_OfLinearAxes(self.errors), self.there)[0]
        return np.asarray(linear + _rotary(self.errors, self.there)[0])

    @cached_property
    def aim(self) -> Array:
        return deviation_after(self.errors, self.there, self.zero[None, :])[0]

    def along(self, axis: str, readings: Array, move: int) -> Array:
        """Correction of every axis along one line, (n, A)."""
        touches = line(self.errors, self.datum, axis, readings, move)
        begun = self.zero + _rotary(self.errors, touches) - _rotary(self.errors, self.there)
        return correction(self.errors, touches, self.aim, begun) - self.zero


def _moves(errors: MachineErrors, axis: str, crosswise: bool) -> tuple[int, ...]:
    """Directions of motion of an axis that need tables of their own; 0 is between both."""
    middle = np.array([float(np.mean(errors.chain.link(axis).range))])
    there = Datum(np.zeros(len(errors.chain.axes)), 0.0)
    ways = [errors.contribution(line(errors, there, axis, middle, m)).twist for m in (1, -1)]
    return (0,) if crosswise or np.array_equal(ways[0], ways[1]) else (1, -1)


@dataclass(frozen=True, eq=False)
class _OfLinearAxes:
    """The errors of the linear axes alone."""

    errors: MachineErrors

    @property
    def chain(self) -> Chain:
        return self.errors.chain

    def contribution(self, touches: Touches) -> Contribution:
        total = self.errors.contribution(touches)
        for i, link in enumerate(self.chain.links):
            if link.kind != "linear":
                total.twist[:, i], total.place[:, i] = 0.0, 0.0
        return total


def _rotary(errors: MachineErrors, touches: Touches) -> Array:
    """Correction of the rotary axes' own positions, (N, A), rad."""
    added = errors.contribution(touches)
    out = np.zeros_like(touches.q)
    for axis in errors.chain.rotary_axes:
        i = errors.chain.link_index(axis)
        own = errors.chain.link(axis).own_component
        out[:, errors.chain.axis_index(axis)] = -(added.twist[:, i, own] + added.place[:, i, own])
    return out


def most_useful(
    tables: AxisTables, errors: MachineErrors, datum: Datum, q: Array, most: int
) -> AxisTables:
    """Tables that lower the error over some poses, one after the other, the most useful first.

    A table that is right on its line through the datum may be wrong beside it, so each has to show
    that it helps.

    Args:
        most: Tables that a control holds.
    """
    left, effects = _fields(tables, errors, datum, q)
    chosen: list[int] = []
    while len(chosen) < most:
        trials = {k: rms_length(left + e) for k, e in enumerate(effects) if k not in chosen}
        best = min(trials, key=lambda k: trials[k], default=None)
        if best is None or trials[best] > rms_length(left) - MIN_GAIN:
            break
        chosen.append(best)
        left = left + effects[best]
    return AxisTables(tables.chain, tuple(tables.tables[k] for k in chosen))


def harmless(tables: AxisTables, errors: MachineErrors, datum: Datum, q: Array) -> AxisTables:
    """Tables without those that raise the error over some poses, the most harmful left out first.

    A table keeps what depends on the direction of motion alone, which is right beside the datum
    too.
    """
    left, effects = _fields(tables, errors, datum, q)
    kept = dict(enumerate(effects))
    while kept:
        trials = {k: rms_length(left + sum(e for j, e in kept.items() if j != k)) for k in kept}
        worst = min(trials, key=lambda k: trials[k])
        if trials[worst] > rms_length(left + sum(kept.values())) - MIN_GAIN:
            break
        del kept[worst]
    out = [t if k in kept else t.reversal for k, t in enumerate(tables.tables)]
    return AxisTables(tables.chain, tuple(out))


def _fields(
    tables: AxisTables, errors: MachineErrors, datum: Datum, q: Array
) -> tuple[Array, list[Array]]:
    """Deviation of the aligned workpiece at some poses, and what every table adds, (N, 3)."""
    touches = errors.touches(q, datum.length)
    moves = _motion(errors, touches)
    effects = []
    for table in tables.tables:
        added = AxisTables(tables.chain, (table,)).correction(touches)
        effects.append(aligned(touches.point, np.einsum("nxa,na->nx", moves, added)))
    return aligned(touches.point, deviation(errors, touches)), effects


def line_bound(tables: AxisTables, errors: MachineErrors, datum: Datum) -> float:
    """What interpolation and rounding leave on the lines through the datum at most, mm."""
    worst: dict[str, float] = {}
    needed = _Needed(errors, datum)
    lever = np.linalg.norm(datum.touches(errors).reach.twist[0], axis=-1)
    for table in tables.tables:
        link = errors.chain.link(table.moves)
        unit = lever[errors.chain.link_index(table.moves), link.own_component]
        worst[table.over] = worst.get(table.over, 0.0) + unit * _missed_by(table, needed)
    return max(worst.values(), default=0.0)


def _missed_by(table: AxisTable, needed: _Needed) -> float:
    """Largest difference of a table from what is needed between its points, mm or rad."""
    count = 2 * CHECKED_PLACES * (len(table.nodes) - 1) + 1
    between = np.linspace(table.nodes[0], table.nodes[-1], count)
    ways = _needed_by(table, needed, between)
    if table.is_left_out:  # what it should not correct is no fault of its points
        mean = 0.5 * (ways[0] + ways[1])
        ways = [way - mean for way in ways]
    held = [np.interp(between, table.nodes, v) for v in (table.forward, table.reverse)]
    return float(max(np.abs(w - h).max() for w, h in zip(ways, held, strict=True)))


def _needed_by(table: AxisTable, needed: _Needed, readings: Array) -> list[Array]:
    """What a table would have to correct after a positive and a negative motion, 2 x (n,)."""
    k = needed.errors.chain.axis_index(table.moves)
    own = needed.zero[k] if table.moves == table.over else 0.0
    ways = [needed.along(table.over, readings, move)[:, k] + own for move in table.moved]
    return [ways[0], ways[-1]]


def left_out(tables: AxisTables, errors: MachineErrors, datum: Datum) -> tuple[str, ...]:
    """Axes without a table although they err along the line through the datum (`harmless`)."""
    needed = _Needed(errors, datum)
    out = []
    for table in tables.tables:
        if table.is_left_out and np.abs(sum(_needed_by(table, needed, table.nodes))).max() > NM:
            out.append(table.over)
    return tuple(out)


def unheld_along(
    tables: AxisTables, errors: MachineErrors, datum: Datum, touches: Touches
) -> Array:
    """What tables of corrections leave per unit of every parameter, (N, 3, P), to first order."""
    chain = errors.chain
    zero = _unit_zero(errors, datum)  # (A, P)
    needed = {
        table.over: [_unit_needed(errors, datum, table, move) for move in table.moved]
        for table in {table.over: table for table in tables.tables}.values()
    }
    out = errors.columns(touches)
    moves = _motion(errors, touches)  # (N, 3, A)
    for table in tables.tables:
        k = chain.axis_index(table.moves)
        at = on_table(touches.reading(table.over), table.nodes, chain.link(table.over))
        ways = [way[:, k] for way in needed[table.over]]
        added = np.zeros((len(touches), len(zero[k])))
        if not table.is_left_out:
            own = zero[k] if table.over == table.moves else 0.0
            added += interpolated(at, table.nodes, 0.5 * (ways[0] + ways[-1])) + own
        half = interpolated(at, table.nodes, 0.5 * (ways[0] - ways[-1]))
        added += touches.last_move(table.over)[:, None] * half
        out += moves[:, :, k, None] * added[:, None, :]
    return out


def _motion(errors: MachineErrors, touches: Touches) -> Array:
    """Motion of the tool point per unit of every axis's reading, (N, 3, A)."""
    chain = errors.chain
    out = np.zeros((len(touches), 3, len(chain.axes)))
    linear = chain.linear_columns
    out[:, :, linear] = linear_directions(chain, touches.q)
    for axis in chain.rotary_axes:
        i, own = chain.link_index(axis), chain.link(axis).own_component
        out[:, :, chain.axis_index(axis)] = touches.reach.twist[:, i, own]
    return out


def _unit_zero(errors: MachineErrors, datum: Datum) -> Array:
    """Zeros of the axes per unit of every parameter, (A, P)."""
    chain, there = errors.chain, datum.touches(errors)
    links = [i for i, link in enumerate(chain.links) if link.kind == "linear"]
    moved = errors.columns(there, links)[0]
    out, linear = _unit_rotary(errors, there)[0], chain.linear_columns
    out[linear] = -np.linalg.pinv(linear_directions(chain, there.q)[0]) @ moved
    return out


def _unit_needed(errors: MachineErrors, datum: Datum, table: AxisTable, move: int) -> Array:
    """`_Needed.along` at the points of a table per unit of every parameter, (n, A, P)."""
    chain, there = errors.chain, datum.touches(errors)
    touches = line(errors, datum, table.over, table.nodes, move)
    out = _unit_rotary(errors, touches) - _unit_rotary(errors, there)
    zero, linear = _unit_zero(errors, datum), chain.linear_columns
    moves, at_datum = _motion(errors, touches), _motion(errors, there)
    left = errors.columns(touches) + moves @ (zero + out)
    left = left - (errors.columns(there) + at_datum @ zero)
    out[:, linear] = -np.linalg.pinv(moves[:, :, linear]) @ left
    return out


def _unit_rotary(errors: MachineErrors, touches: Touches) -> Array:
    """`_rotary` per unit of every parameter, (N, A, P)."""
    chain = errors.chain
    out = np.zeros((len(touches), len(chain.axes), len(errors.root)))
    for axis in chain.rotary_axes:
        i, own = chain.link_index(axis), chain.link(axis).own_component
        for part in ("twist", "place"):
            out[:, chain.axis_index(axis)] -= errors.amounts(touches, part, (i,))[:, i, own]
    return out
