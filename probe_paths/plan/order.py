"""Order of poses and touches: mixed, from both sides, and short ways within a pose.

The order of the golden ratio's fractional parts spreads axis positions evenly over time.
Touches within a pose follow a short way by 2-opt and Or-opt.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from matstd.artefact.reach import TRAVEL_ROUNDING
from matstd.twin.errors import NotReachable
from matstd.twin.frames import Array, IntArray
from matstd.twin.machine import Chain
from matstd.twin.units import DEG

GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
"""Fractional parts of its multiples are spread as evenly as any; no randomness is needed."""

LONGEST_TURN = 170.0 * DEG
"""A rotary move is cut into pieces below half a turn, so that M126 cannot change its way."""

_PART, _NO_GAIN = 3, 1e-9  # places that are put elsewhere together; mm


@dataclass(frozen=True, eq=False)
class Visit:
    """One stay at a table pose."""

    pose: int  # number of the pose, from 0
    rotary: Array  # readings of the rotary axes, (R,), rad
    side: Array  # direction of the last motion of each rotary axis, (R,), -1 or 1
    before: Array  # readings just before it, overshot to the side, (R,), rad
    rows: IntArray  # requests to touch here, (M,)
    height: float = 0.0  # reading of Z at which the probe moves sideways, mm
    stretch: int = 0  # number of the stretch between standstills; each begins a program


class StatedVisits(NamedTuple):
    """Visits in a given order, from given sides."""

    number: IntArray  # of the visit of every request, in their order, (N,)
    side: Array  # direction of the last motion of each rotary axis towards it, (N, R), -1 or 1
    stretch: IntArray  # number of the stretch between standstills, (N,)


def stated_visits(
    chain: Chain, rotary: Array, stated: StatedVisits, overshoot: float
) -> list[Visit]:
    """Visits in the order and from the sides that are stated; arguments and errors as `visits`."""
    poses, belongs = np.unique(rotary, axis=0, return_inverse=True)
    out = []
    for number in np.unique(stated.number):
        rows = np.flatnonzero(stated.number == number)
        pose, side = int(belongs.ravel()[rows[0]]), stated.side[rows[0]]
        made = _visit(chain, pose, poses[pose], side, overshoot, rows)
        out.append(replace(made, stretch=int(stated.stretch[rows[0]])))
    return out


def visits(chain: Chain, rotary: Array, overshoot: float, shortest_visit: int) -> list[Visit]:
    """Visits of all poses: a first round in mixed order, a second one backwards.

    Round one takes the poses, sorted by their readings, in the order of ``frac(k golden)``. The
    sides of the axes alternate from pose to pose independently of each other and are opposite in
    the second round.

    Args:
        rotary: Readings of every request, (N, R), rad.
        overshoot: Length of the last motion towards a reading, rad.
        shortest_visit: Fewest touches for which a pose is split over two visits.

    Raises:
        NotReachable: A rotary reading that is outside the travel or leaves no room to approach.
    """
    poses, belongs = np.unique(rotary, axis=0, return_inverse=True)
    order = np.argsort((np.arange(len(poses)) * GOLDEN) % 1.0, kind="stable")
    first: list[Visit] = []
    second: list[Visit] = []
    for turn, pose in enumerate(order):
        rows = np.flatnonzero(belongs.ravel() == pose)
        wanted = np.array([1.0 if (turn >> axis) & 1 else -1.0 for axis in range(rotary.shape[1])])
        halves = [rows[::2], rows[1::2]] if len(rows) >= shortest_visit else [rows]
        for half, target, sign in zip(halves, (first, second), (1.0, -1.0), strict=False):
            target.append(_visit(chain, int(pose), poses[pose], sign * wanted, overshoot, half))
    return first + second[::-1]


def _visit(
    chain: Chain, pose: int, rotary: Array, side: Array, overshoot: float, rows: IntArray
) -> Visit:
    """A visit from the wanted sides, or from the opposite one where the travel ends."""
    side = side.copy()
    for i, name in enumerate(chain.rotary_axes):
        low, high = chain.link(name).range
        low, high = low - TRAVEL_ROUNDING, high + TRAVEL_ROUNDING
        where = f"pose {name}{rotary[i] / DEG:+.4f}"
        if not low <= rotary[i] <= high:
            travel = f"{low / DEG:g} to {high / DEG:g} degrees"
            raise NotReachable(f"{where}: outside the travel of {name}, {travel}")
        if not low <= rotary[i] - side[i] * overshoot <= high:
            side[i] = -side[i]
        if not low <= rotary[i] - side[i] * overshoot <= high:
            raise NotReachable(f"{where}: travel of {name} leaves no room to approach it")
    return Visit(pose=pose, rotary=rotary, side=side, before=rotary - side * overshoot, rows=rows)


def waypoints(start: Array, end: Array) -> Array:
    """Rotary readings (W, R) after `start` up to `end`, no step longer than `LONGEST_TURN`."""
    pieces = max(int(np.ceil(np.abs(end - start).max(initial=0.0) / LONGEST_TURN)), 1)
    share = np.arange(1, pieces + 1)[:, None] / pieces
    return start + share * (end - start)


def rotary_path(start: Array, stops: list[Visit], end: Array) -> Array:
    """Every rotary position (W, R) of a programme of visits, from `start` to `end`."""
    path = [start[None]]
    for stop in stops:
        path += [waypoints(path[-1][-1], stop.before), stop.rotary[None]]
    return np.concatenate([*path, end[None]])


def short_order(places: Array, first: Array) -> IntArray:
    """Order of places (N, D) that goes from `first` (D,) a short way, as rapid moves take time.

    The axis with the longest way decides the time of a move. From nearest neighbours, parts are
    reversed (2-opt) and parts of up to three moved (Or-opt) while that shortens the way.
    """
    cost = np.abs(places[:, None] - places).max(axis=-1, initial=0.0)
    away = np.abs(places - first).max(axis=-1, initial=0.0)
    order = nearest_neighbours(places, first)
    while True:
        tried = [_best_two_opt(order, cost, away), _best_or_opt(order, cost, away)]
        gain, better = max(tried, key=lambda one: one[0])
        if gain <= _NO_GAIN:
            return order
        order = better


def _best_two_opt(order: IntArray, cost: Array, away: Array) -> tuple[float, IntArray]:
    """The best reversal of a part (2-opt): its saving, and the new order."""
    n = len(order)
    into = np.concatenate([[away[order]], cost[order[:-1][:, None], order]])  # from before i to j
    on = np.concatenate([cost[order[:, None], order[1:]], np.zeros((n, 1))], axis=1)
    at = np.arange(n)
    gain = (into[at, at][:, None] + on[at, at]) - (into + on)
    gain = np.triu(gain, 1)
    i, j = np.unravel_index(int(np.argmax(gain)), gain.shape)
    return float(gain[i, j]), np.concatenate([order[:i], order[i : j + 1][::-1], order[j + 1 :]])


def _best_or_opt(order: IntArray, cost: Array, away: Array) -> tuple[float, IntArray]:
    """The part of up to three places that saves most elsewhere, in either direction.

    Gap k is before the place k of the order, the last one behind all of them.
    """
    n, best, found = len(order), 0.0, order
    into = np.concatenate([[away[order]], cost[order[:, None], order]])  # over gap k to place j
    on = np.concatenate([cost[order[:, None], order], np.zeros((1, n))])  # from place j over gap k
    gap = np.append(into[np.arange(n), np.arange(n)], 0.0)
    for size in range(1, min(_PART, n - 1) + 1):
        first = np.arange(n - size + 1)
        last = first + size - 1
        bridge = np.append(into[first[:-1], last[:-1] + 1], 0.0)
        saved = gap[first] + gap[last + 1] - bridge
        k = np.arange(n + 1)[:, None]
        own = (k >= first) & (k <= last + 1)
        for one, other in ((first, last), (last, first)):
            gain = np.where(own, -np.inf, saved - (into[:, one] + on[:, other] - gap[:, None]))
            to, i = np.unravel_index(int(np.argmax(gain)), gain.shape)
            if gain[to, i] > best:
                part, rest = order[i : i + size], np.delete(order, np.s_[i : i + size])
                part = part if one is first else part[::-1]
                at = to if to < i else to - size
                best = float(gain[to, i])
                found = np.concatenate([rest[:at], part, rest[at:]])
    return best, found


def nearest_neighbours(places: Array, first: Array) -> IntArray:
    """Order of places (N, 3) that goes from `first` (3,) always to the nearest one left."""
    left = np.ones(len(places), dtype=bool)
    order = np.empty(len(places), dtype=np.int64)
    here = first
    for k in range(len(places)):
        distance = np.where(left, np.linalg.norm(places - here, axis=1), np.inf)
        order[k] = int(np.argmin(distance))
        left[order[k]] = False
        here = places[order[k]]
    return order
