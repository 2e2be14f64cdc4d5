"""Poses of a workspace: grids, Latin hypercubes and sections."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from matstd.twin.errors import DesignError, NotReachable, OutsideTravel, UnknownAxis
from matstd.twin.frames import Array, Mask
from matstd.twin.machine import Chain, inverse_linear, tip
from matstd.twin.sampling import latin_points

Box = tuple[tuple[float, float, float], tuple[float, float, float]]
_ROUNDS = 40  # draws of joints until enough tool points lie in the box


@dataclass(frozen=True, eq=False)
class Workspace:
    """Limits of the readings and of the tool point that a user needs."""

    chain: Chain
    # smallest and largest reading by axis, mm or rad; an axis left out has its whole range, a
    # spindle that is not programmed stands at zero
    limits: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    length: float = 0.0  # tool length, mm
    # lowest and highest corner of a box of the table frame in which the tool point has to stay, mm,
    # or None
    volume: Box | None = None

    def __post_init__(self) -> None:
        for name, (low, high) in self.limits.items():
            if name not in self.chain.programmed_axes:
                raise UnknownAxis(name, self.chain.programmed_axes)
            if not low <= high:
                raise DesignError(f"workspace of {name}: {low:g} to {high:g}, smaller one first")
            reach = self.chain.link(name).range
            slack = 1e-9 * (reach[1] - reach[0])
            if low < reach[0] - slack or high > reach[1] + slack:
                unit = self.chain.link(name).unit
                raise OutsideTravel(
                    f"workspace of {name}: {low / unit:g} to {high / unit:g}, beyond the travel "
                    f"{reach[0] / unit:g} to {reach[1] / unit:g}"
                )

    def limit(self, axis: str) -> tuple[float, float]:
        """Smallest and largest reading of an axis."""
        if not self.chain.link(axis).programmed:
            return 0.0, 0.0
        return self.limits.get(axis, self.chain.link(axis).range)

    @property
    def centre(self) -> Array:
        """Readings in the middle of all limits, (A,)."""
        return np.array([np.mean(self.limit(name)) for name in self.chain.axes])

    @property
    def open_axes(self) -> tuple[str, ...]:
        """Programmed axes whose limits leave them room to move."""
        return tuple(a for a in self.chain.programmed_axes if np.ptp(self.limit(a)) > 0.0)

    def in_volume(self, q: Array) -> Mask:
        """Whether the tool point at readings (N, A) is in the volume, (N,)."""
        if self.volume is None:
            return np.ones(len(q), dtype=bool)
        p, (low, high) = tip(self.chain, q, self.length), np.array(self.volume)
        return np.all((p >= low) & (p <= high), axis=1)


def _inside(workspace: Workspace, q: Array) -> Array:
    """Rows of readings within limits and volume."""
    keep = workspace.in_volume(q)
    for i, name in enumerate(workspace.chain.axes):
        low, high = workspace.limit(name)
        slack = 1e-9 * max(high - low, 1.0)
        keep &= (q[:, i] >= low - slack) & (q[:, i] <= high + slack)
    return q[keep]


def latin_hypercube(workspace: Workspace, count: int, rng: np.random.Generator) -> Array:
    """Poses that fill a workspace evenly, (N, A); raises NotReachable.

    Without a volume it is a Latin hypercube of the readings. With one, tool points and rotary
    readings are drawn so, the linear readings follow, and what lies beyond the limits is drawn
    again.
    """
    chain = workspace.chain
    low, high = np.array([workspace.limit(name) for name in chain.axes]).T
    if workspace.volume is None:
        return latin_points(low, high, count, rng)
    rotary = [chain.axis_index(a) for a in chain.axes if a not in chain.linear_axes]
    low, high = np.append(workspace.volume, [low[rotary], high[rotary]], axis=1)
    found = np.zeros((0, len(chain.axes)))
    for _ in range(_ROUNDS):
        cube = latin_points(low, high, count, rng)
        q = np.zeros((count, len(chain.axes)))
        q[:, rotary] = cube[:, 3:]
        q = inverse_linear(chain, cube[:, :3], q, workspace.length)
        found = np.concatenate([found, _inside(workspace, q)])
        if len(found) >= count:
            return found[:count]
    raise NotReachable(
        f"only {len(found)} of {_ROUNDS * count} poses have their tool point in "
        f"{_spans(workspace.volume)} mm of the table with every axis within its limits"
    )


def _spans(volume: Box) -> str:
    """`x -60 to 60, y ...`."""
    each = zip("xyz", *volume, strict=True)
    return ", ".join(f"{axis} {low:.0f} to {high:.0f}" for axis, low, high in each)


def section(
    workspace: Workspace, first: str, second: str, count: int, base: Array | None = None
) -> tuple[Array, Array, Array]:
    """Readings over two axes with the others held.

    Args:
        first: Axis along the rows.
        second: Axis along the columns.
        base: Readings of the other axes, (A,); None for the middle of their limits.

    Returns:
        Values of the first axis (n,), of the second (n,), readings (n n, A), the second fastest.
    """
    chain = workspace.chain
    a, b = (np.linspace(*workspace.limit(name), count) for name in (first, second))
    q = np.tile(workspace.centre if base is None else base, (count * count, 1))
    q[:, chain.axis_index(first)] = np.repeat(a, count)
    q[:, chain.axis_index(second)] = np.tile(b, count)
    return a, b, q
