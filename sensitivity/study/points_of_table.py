"""Single points of the workpiece while the table turns under them.

The linear axes follow, as they do under a program, so that the tool point stays at one point of the
workpiece; where their travel does not let them, the point is not reached.
"""

from dataclasses import dataclass

import numpy as np

from matstd.sensitivity.first_order import Workspace
from matstd.sensitivity.study.volume_map import has_volume
from matstd.twin.frames import Array
from matstd.twin.machine import inverse_linear, tip

_VALUES = 61  # of each rotary reading
_SLACK = 1e-9  # mm


@dataclass(frozen=True, eq=False)
class PointOverRotary:
    """One point of the workpiece while the table turns."""

    # where it is: linear readings by axis with the rotary axes next to zero, mm
    linear: dict[str, float]
    axes: tuple[str, ...]  # names of the rotary axes shown, one or two
    readings: tuple[Array, ...]  # their values, an array each, rad
    q: Array  # readings with the tool point there, (N, A), the second rotary reading fastest
    reached: Array  # whether the travels of the linear axes allow it, (N,)

    def shown(self, values: Array) -> Array:
        """Values (N,) on the grid of readings, not a number where out of reach."""
        return np.where(self.reached, values, np.nan).reshape([len(r) for r in self.readings])


def level(workspace: Workspace) -> dict[str, float]:
    """Rotary readings next to zero within the limits, rad: the table as a workpiece is set up."""
    return {
        name: float(np.clip(0.0, *workspace.limit(name))) for name in workspace.chain.rotary_axes
    }


def points_over_rotary(workspace: Workspace) -> tuple[PointOverRotary, ...]:
    """Four points of the workpiece over the one or two rotary axes that move: middle, top, corners.

    They are those of the linear readings with the table level. None where no rotary axis moves, or
    fewer than three linear axes can move.
    """
    chain = workspace.chain
    turning = sorted(a for a in workspace.open_axes if a in chain.rotary_axes)[:2]
    if not turning or not has_volume(workspace):
        return ()
    base = workspace.centre
    for name, reading in level(workspace).items():
        base[chain.axis_index(name)] = reading
    linear = sorted(chain.linear_axes)
    each = tuple(np.linspace(*workspace.limit(a), _VALUES) for a in turning)
    mesh = [m.ravel() for m in np.meshgrid(*each, indexing="ij")]
    out = []
    # ends of the linear travels: middle, top, one side, a lower corner
    for ends in ((0, 0, 0), (0, 0, 1), (1, 0, 0), (1, 1, -1)):
        start, place = base.copy(), {}
        for name, end in zip(linear, ends, strict=True):
            low, high = workspace.limit(name)
            start[chain.axis_index(name)] = 0.5 * (low + high) + 0.5 * end * (high - low)
            place[name] = float(start[chain.axis_index(name)])
        target = tip(chain, start[None], workspace.length)
        q = np.tile(base, (len(mesh[0]), 1))
        for name, values in zip(turning, mesh, strict=True):
            q[:, chain.axis_index(name)] = values
        q = inverse_linear(chain, np.repeat(target, len(q), axis=0), q, workspace.length)
        reached = np.ones(len(q), dtype=bool)
        for name in linear:
            first, last = chain.link(name).range
            follows = q[:, chain.axis_index(name)]
            reached &= (follows >= first - _SLACK) & (follows <= last + _SLACK)
        out.append(
            PointOverRotary(linear=place, axes=tuple(turning), readings=each, q=q, reached=reached)
        )
    return tuple(out)
