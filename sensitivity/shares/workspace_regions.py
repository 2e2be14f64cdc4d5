"""Parts of a workspace, and the shares of errors in the deviation of each.

The shares are those of `matstd.sensitivity.first_order.indices`: exact for the deviation to first
order. Only the poses of a region are sampled, evenly and without chance; the range of the shares
over them is no uncertainty. Effects on the length |d|, interactions included, need random machines.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

import numpy as np

from matstd.sensitivity.first_order import Workspace, variance_parts
from matstd.sensitivity.population import Population
from matstd.sensitivity.shares.total_effect_indices import MACHINES, norm_shares
from matstd.twin.frames import Array
from matstd.twin.sampling import even_points
from matstd.twin.units import DEG

POSES_OF_REGION = 256  # poses that stand for a region
_TOTAL_POSES = 16  # of a region, for random machines
_OUTER = 1.0 / 6.0  # of a travel at either end that counts as its end
_MIDDLE = (1.0 / 3.0, 2.0 / 3.0)  # of a travel that counts as its middle
_TURN = 350.0 * DEG  # from this travel the ends of a rotary axis meet
_AROUND = 15.0 * DEG  # on either side of an angle: a region
_TRIES = 20  # draws of a region before it counts as out of reach

Squeeze = Callable[[Array], Array]


class Part(Enum):
    """Parts of a workspace."""

    WHOLE = "whole workspace"
    MIDDLE = "linear axes in their middle third"
    CORNERS = "linear axes in their outer sixths"
    END = "an end of a rotary axis"
    AROUND = "readings around an angle of a rotary axis that turns all round"


class Place(NamedTuple):
    """Where a region is."""

    part: Part  # which part of the workspace
    axes: tuple[str, ...] = ()  # whose readings are restricted
    limits: tuple[float, float] = (0.0, 0.0)  # of the one rotary axis of an end or an angle, rad


@dataclass(frozen=True, eq=False)
class Region:
    """Part of a workspace."""

    place: Place
    q: Array  # poses in it, (N, A)
    shares: Array  # share of every error parameter in the variance of the deviation, (N, P)
    mean_shares: Array  # the same in the variance summed over the region, (P,)
    rms: float  # root mean square of the volumetric error over machines and poses, mm

    def largest(self, count: int) -> list[int]:
        """Indices of the parameters with the largest shares, largest first."""
        order = np.argsort(-self.mean_shares, kind="stable")[:count]
        return [int(i) for i in order if self.mean_shares[i] > 0.0]


def regions(population: Population, workspace: Workspace) -> tuple[Region, ...]:
    """The whole workspace, middle and corners of its linear axes, ends of its rotary ones.

    A rotary axis that turns all round has no ends; it has regions at 0, 90 and 180 degrees instead.
    """
    out = []
    for place, readings in _places(workspace):
        q = _poses(workspace, readings)
        if not len(q):
            continue
        each = variance_parts(population, q, workspace.length)
        total = each.sum(axis=1, keepdims=True)
        shares = each / np.where(total > 0.0, total, 1.0)
        whole = float(each.sum())
        of_all = each.sum(axis=0) / (whole if whole > 0.0 else 1.0)
        out.append(
            Region(
                place=place,
                q=q,
                shares=shares,
                mean_shares=of_all,
                rms=float(np.sqrt(total.mean())),
            )
        )
    return tuple(out)


@dataclass(frozen=True, eq=False)
class RegionTotals:
    """Total effect of every error on the length |d|, region by region."""

    total: Array  # index of every error, mean over poses of the region, (R, P)
    u: Array  # its standard error by sampling, (R, P)
    machines: int  # pairs of random machines
    poses: int  # of each region
    seed: str  # where the machines came from


def region_totals(
    population: Population,
    workspace: Workspace,
    found: Sequence[Region],
    rng: np.random.Generator,
    machines: int = MACHINES,
) -> RegionTotals:
    """What the errors do to the length |d| in each region, by Monte Carlo; raises DesignError.

    All poses share the machines, so the standard error of a mean over poses is taken as the mean of
    theirs, which is conservative.
    """
    some = [r.q[:_TOTAL_POSES] for r in found]
    # compiling would take longer than so few poses
    each = norm_shares(
        population, np.concatenate(some), workspace.length, rng, machines, compiled=False
    )
    ends = np.cumsum([len(q) for q in some])[:-1]
    total, u = (
        np.stack([part.mean(axis=1) for part in np.split(values, ends, axis=1)])
        for values in (each.total, each.u)
    )
    return RegionTotals(
        total=total, u=u, machines=each.machines, poses=_TOTAL_POSES, seed=each.seed
    )


def _places(workspace: Workspace) -> list[tuple[Place, dict[str, Squeeze]]]:
    """Regions with the readings that differ from the whole: unit interval to reading."""
    chain, free = workspace.chain, workspace.open_axes
    linear = tuple(sorted(a for a in free if a in chain.linear_axes))
    out: list[tuple[Place, dict[str, Squeeze]]] = [(Place(Part.WHOLE), {})]
    if linear:
        middle = {}
        for axis in linear:
            low, high = workspace.limit(axis)
            middle[axis] = _interval(*(low + share * (high - low) for share in _MIDDLE))
        ends = {a: _outer(workspace, a) for a in linear}
        out += [(Place(Part.MIDDLE, linear), middle), (Place(Part.CORNERS, linear), ends)]
    for axis in sorted(a for a in free if a in chain.rotary_axes):
        out += _of_rotary(workspace, axis)
    return out


def _of_rotary(workspace: Workspace, axis: str) -> list[tuple[Place, dict[str, Squeeze]]]:
    """Ends of a rotary axis, or two quarters and the opposite side where it turns all round."""
    low, high = workspace.limit(axis)
    if high - low < _TURN:
        step = _OUTER * (high - low)
        return [
            (Place(Part.END, (axis,), span), {axis: _interval(*span)})
            for span in ((low, low + step), (high - step, high))
        ]
    out = []
    for angle in (0.0, 0.5 * np.pi, np.pi):
        if low <= angle <= high:
            place = Place(Part.AROUND, (axis,), (angle - _AROUND, angle + _AROUND))
            a, b = max(place.limits[0], low), min(place.limits[1], high)
            out.append((place, {axis: _interval(a, b)}))
    return out


def _interval(low: float, high: float) -> Squeeze:
    return lambda t: low + t * (high - low)


def _outer(workspace: Workspace, axis: str) -> Squeeze:
    """Unit interval to both ends of a travel."""
    low, high = workspace.limit(axis)

    def squeeze(t: Array) -> Array:
        side = np.where(t < 0.5, 2.0 * _OUTER * t, 1.0 - 2.0 * _OUTER * (1.0 - t))
        return low + side * (high - low)

    return squeeze


def _poses(workspace: Workspace, readings: dict[str, Squeeze]) -> Array:
    """Poses of a region, spread evenly without chance, (N, A); empty where none is reachable."""
    chain = workspace.chain
    found = np.zeros((0, len(chain.axes)))
    for attempt in range(_TRIES):
        unit = even_points(POSES_OF_REGION, len(chain.axes), attempt * POSES_OF_REGION)
        q = np.empty_like(unit)
        for i, name in enumerate(chain.axes):
            low, high = workspace.limit(name)
            q[:, i] = readings.get(name, _interval(low, high))(unit[:, i])
        found = np.concatenate([found, q[workspace.in_volume(q)]])[:POSES_OF_REGION]
        if len(found) == POSES_OF_REGION:
            break
    return found
