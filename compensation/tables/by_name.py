"""Tables of errors by their ISO 230-1 names, as controls with a volumetric model hold them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from matstd.compensation.field import Datum, MachineErrors, correction
from matstd.twin.frames import Array
from matstd.twin.machine import Chain, Contribution, Link
from matstd.twin.record import Touches
from matstd.twin.units import NM

FIRST_POINTS = 17  # points of an axis from which the number is doubled until they are enough

MAX_INTERPOLATION = 20.0 * NM
"""What interpolation of one component may leave at the tool point, mm: far below what a machine
repeats."""

CHECKED_PLACES = 4  # places between two points at which interpolation is looked at


@dataclass(frozen=True, eq=False)
class NamedTables:
    """Component errors of every axis over its own reading, and location errors.

    The control interpolates linearly and corrects by its own inverse; what depends on a second axis
    has the value of the datum.
    """

    chain: Chain
    nodes: Mapping[str, Array]  # readings of the points by axis, ascending, (n,), mm or rad
    values: Mapping[str, Array]  # component errors there, (n, 6), mm and rad
    place: Array  # location errors of every link, (L, 6), mm and rad
    only_own: bool = False  # whether every axis's own positioning error is all that they hold

    def holds(self, axis: str) -> Array:
        """Which components of an axis they hold, (6,): 1 or 0."""
        own = self.chain.link(axis).own_component
        return np.eye(6)[own] if self.only_own else np.ones(6)

    def positioning(self) -> "NamedTables":
        """The positioning errors of these alone."""
        own = replace(self, place=np.zeros_like(self.place), only_own=True)
        values = {axis: rows * own.holds(axis) for axis, rows in self.values.items()}
        return replace(own, values=values)

    def contribution(self, touches: Touches) -> Contribution:
        """What the control believes of its axes."""
        total = Contribution.zeros(len(touches), len(self.chain.links))
        for axis, nodes in self.nodes.items():
            at = on_table(touches.reading(axis), nodes, self.chain.link(axis))
            link = self.chain.link_index(axis)
            for c in range(6):
                total.twist[:, link, c] = np.interp(at, nodes, self.values[axis][:, c])
        total.place[:] = self.place
        return total

    def correction(self, touches: Touches) -> Array:
        """Readings that the control adds, (N, A)."""
        return correction(self, touches)


def on_table(reading: Array, nodes: Array, link: Link) -> Array:
    """Readings brought into the turn that a table covers."""
    if link.kind != "rotary" or abs(nodes[-1] - nodes[0] - 2.0 * np.pi) > 1e-9:
        return reading
    return nodes[0] + np.mod(reading - nodes[0], 2.0 * np.pi)


def span(link: Link) -> tuple[float, float]:
    """Readings that a table covers: the travel, one turn of an axis that turns more than once."""
    low, high = link.range
    if link.kind == "rotary" and high - low > 2.0 * np.pi:
        return 0.0, 2.0 * np.pi
    return low, high


def line(errors: MachineErrors, datum: Datum, axis: str, readings: Array, move: int = 0) -> Touches:
    """Poses along one axis through the datum.

    Args:
        move: Sign of the axis's last motion; 0 between both.
    """
    q = np.tile(datum.q, (len(readings), 1))
    q[:, errors.chain.axis_index(axis)] = readings
    approach = np.zeros_like(q)
    approach[:, errors.chain.axis_index(axis)] = move
    return errors.touches(q, datum.length, approach)


def sampled(errors: MachineErrors, datum: Datum, most: int) -> NamedTables:
    """Tables of the errors with as many points as linear interpolation needs.

    Args:
        datum: Where the other axes stand while one is sampled.
        most: Points of an axis that the format holds.
    """
    chain = errors.chain
    counts = {a: _points(errors, datum, a, most) for a in chain.programmed_axes}
    nodes = {a: np.linspace(*span(chain.link(a)), n) for a, n in counts.items()}
    values = {a: _twist(errors, datum, a, at) for a, at in nodes.items()}
    there = errors.contribution(datum.touches(errors))
    return NamedTables(chain=chain, nodes=nodes, values=values, place=there.place[0])


def _twist(errors: MachineErrors, datum: Datum, axis: str, readings: Array) -> Array:
    added = errors.contribution(line(errors, datum, axis, readings))
    return added.twist[:, errors.chain.link_index(axis)]


def _points(errors: MachineErrors, datum: Datum, axis: str, most: int) -> int:
    lever = _levers(errors.chain)
    needed = partial(_twist, errors, datum, axis)
    ends = span(errors.chain.link(axis))
    return points_needed(ends, most, needed, lambda missed: float(missed @ lever))


def points_needed(
    ends: tuple[float, float],
    most: int,
    needed: Callable[[Array], Array],
    cost: Callable[[Array], float],
) -> int:
    """Points of an axis, doubled until linear interpolation is good enough or the table full.

    Args:
        needed: Values (n, C) at readings (n,).
        cost: What largest differences between points (C,) do at the tool point, mm.
    """
    count = FIRST_POINTS
    while True:
        between = np.linspace(*ends, CHECKED_PLACES * (count - 1) + 1)
        values = needed(between)
        missed = _missed(between, values, between[::CHECKED_PLACES], values[::CHECKED_PLACES])
        if cost(missed) < MAX_INTERPOLATION or 2 * count - 1 > most:
            return count
        count = 2 * count - 1


def point_spacing(errors: MachineErrors, datum: Datum) -> dict[str, float]:
    """Readings over which every axis's errors are straight to some 0.1 µm, mm or rad.

    Twice the distance of points between which interpolation leaves `MAX_INTERPOLATION`, so four
    times that.
    """
    spans = {a: np.ptp(span(errors.chain.link(a))) for a in errors.chain.programmed_axes}
    return {a: 2.0 * far / (_points(errors, datum, a, 4096) - 1) for a, far in spans.items()}


def _missed(between: Array, values: Array, nodes: Array, held: Array) -> Array:
    """Largest difference of every column from lines between points, (C,)."""
    read = np.column_stack([np.interp(between, nodes, column) for column in held.T])
    return np.abs(values - read).max(axis=0)


def _levers(chain: Chain) -> Array:
    """What a component moves the tool point by at most, roughly: the travels are the levers."""
    travel = np.sum([np.ptp(chain.link(a).range) for a in chain.linear_axes])
    return np.array([1.0, 1.0, 1.0, travel, travel, travel])


def interpolation_bound(
    tables: NamedTables, errors: MachineErrors, datum: Datum, q: Array
) -> float:
    """What linear interpolation and rounding leave of the tool point at most, mm.

    The largest difference of every component between its points, times the largest lever that it
    has at some poses, added up over all components as if they met at one place.
    """
    lever = np.linalg.norm(errors.touches(q, datum.length).reach.twist, axis=-1).max(axis=0)
    total = 0.0
    for axis, nodes in tables.nodes.items():
        low, high = nodes[0], nodes[-1]
        between = np.linspace(low, high, 2 * CHECKED_PLACES * (len(nodes) - 1) + 1)
        true = _twist(errors, datum, axis, between) * tables.holds(axis)
        missed = _missed(between, true, nodes, tables.values[axis])
        total += float(missed @ lever[tables.chain.link_index(axis)])
    return total


def unheld_by_name(
    tables: NamedTables, errors: MachineErrors, datum: Datum, touches: Touches
) -> Array:
    """What tables of errors by name leave per unit of every parameter, (N, 3, P).

    To first order: of every component the amount less what is interpolated between its points.
    """
    chain, there = errors.chain, datum.touches(errors)
    out = errors.columns(touches)
    if not tables.only_own:
        at_datum = errors.amounts(there, "place", range(len(chain.links)))[0]
        out -= np.einsum("nlcx,lcp->nxp", touches.reach.place, at_datum)
    for axis, nodes in tables.nodes.items():
        i = chain.link_index(axis)
        held = errors.amounts(line(errors, datum, axis, nodes), "twist", (i,))[:, i]  # (n, 6, P)
        at = on_table(touches.reading(axis), nodes, chain.link(axis))
        read = interpolated(at, nodes, held * tables.holds(axis)[:, None])
        out -= np.einsum("ncx,ncp->nxp", touches.reach.twist[:, i], read)
    return out


def interpolated(at: Array, nodes: Array, values: Array) -> Array:
    """Linear interpolation of values (n, ...) at points ascending, (N, ...); ends are kept."""
    k = np.clip(np.searchsorted(nodes, at) - 1, 0, len(nodes) - 2)
    share = np.clip((at - nodes[k]) / (nodes[k + 1] - nodes[k]), 0.0, 1.0)
    share = share.reshape(-1, *[1] * (values.ndim - 1))
    return (1.0 - share) * values[k] + share * values[k + 1]
