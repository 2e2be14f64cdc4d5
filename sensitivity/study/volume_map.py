"""Maps in three dimensions: the box of the linear readings at fixed rotary readings.

Maps are drawn over readings, because a user sets these. At fixed rotary readings the tool point is
an affine function of them, so objects on the table and rotary axes have a place in the map.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from matstd.sensitivity.first_order import Workspace, covariance, normal_length, sensitivity
from matstd.sensitivity.population import Population
from matstd.twin.errors import NotReachable
from matstd.twin.frames import Array, apply
from matstd.twin.machine import Symbol, inverse_linear, reach, tip
from matstd.twin.sampling import grid_points

SECTION_POINTS = (19, 19, 17)  # readings of each axis in a volume


@dataclass(frozen=True, eq=False)
class Volume:
    """Poses that fill the box of three linear readings."""

    workspace: Workspace  # limits, tool length
    axes: tuple[str, ...]  # names of the three linear axes, in alphabetical order
    readings: tuple[Array, ...]  # their values, three arrays, mm
    q: Array  # readings of all axes at every point, (N, A); the last of the three runs fastest
    # takes a point of the table frame to the linear readings that bring the tool point there, (4,
    # 4)
    T_readings_table: Array

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values of each reading."""
        return tuple(len(r) for r in self.readings)

    @property
    def rotary(self) -> dict[str, float]:
        """Rotary readings at which the table stands still, rad."""
        chain = self.workspace.chain
        return {a: float(self.q[0, chain.axis_index(a)]) for a in chain.rotary_axes}

    def volumetric(self, population: Population) -> Array:
        """95 % quantile of the volumetric error at every point, `shape`, mm, without sampling.

        First order, and as if the errors were normally distributed
        (`matstd.sensitivity.first_order.normal_lengths`);
        not a number where the tool point leaves the volume of the workspace.
        """
        C = covariance(population, self.q, self.workspace.length)
        return self._shown(normal_length(C).p95)

    def sensitivity(self, symbol: Symbol) -> Array:
        """S of one error parameter at every point, `shape`, mm/mm or mm/rad."""
        workspace = self.workspace
        return self._shown(sensitivity(workspace.chain, self.q, workspace.length, [symbol])[:, 0])

    def _shown(self, values: Array) -> Array:
        """Values on the grid, without the points that are no poses of the workspace."""
        return np.where(self.workspace.in_volume(self.q), values, np.nan).reshape(self.shape)

    def lines(self) -> dict[str, Array]:
        """Lines of the rotary axes in the map: a point and a unit direction each, (2, 3).

        The columns of an axis for three translations e_i and three rotations are ``e_i`` and
        ``e_i x a`` with a its arm to the tool point; ``sum_i (e_i x a) x e_i = 2 a`` gives the arm.
        """
        chain = self.workspace.chain
        twist = reach(chain, self.q[:1], self.workspace.length).twist[0]
        here = tip(chain, self.q[:1], self.workspace.length)[0]
        linear = self.T_readings_table[:3, :3]
        out = {}
        for name in chain.rotary_axes:
            i = chain.link_index(name)
            axes, across = twist[i, :3], twist[i, 3:]
            arm = 0.5 * np.cross(across, axes).sum(axis=0)
            direction = linear @ (axes.T @ chain.link(name).direction)
            point = apply(self.T_readings_table, (here - arm)[None])[0]
            out[name] = np.stack([point, direction / np.linalg.norm(direction)])
        return out


def has_volume(workspace: Workspace) -> bool:
    """Whether there are three linear axes and each has room to move."""
    linear = workspace.chain.linear_axes
    return len(linear) == 3 and set(linear) <= set(workspace.open_axes)


def volume(
    workspace: Workspace, rotary: Mapping[str, float], points: tuple[int, int, int] = SECTION_POINTS
) -> Volume:
    """Poses that fill the box of the linear readings, `points` along each; raises NotReachable.

    A rotary axis that is left out, rad, stands in the middle.
    """
    chain = workspace.chain
    if not has_volume(workspace):
        raise NotReachable(
            f"no volume: the workspace of {chain.name} has room along "
            f"{', '.join(workspace.open_axes) or 'no axis'}, expected three linear axes"
        )
    base = workspace.centre
    for name, reading in rotary.items():
        base[chain.axis_index(name)] = reading
    names = tuple(sorted(chain.linear_axes))
    columns = [chain.axis_index(name) for name in names]
    each = tuple(
        np.linspace(*workspace.limit(name), n) for name, n in zip(names, points, strict=True)
    )
    points_of_grid = grid_points(*each)
    q = np.tile(base, (len(points_of_grid), 1))
    q[:, columns] = points_of_grid
    # where the tool point is to be, at the table's origin and one step along each of its axes
    corners = np.concatenate([np.zeros((1, 3)), np.eye(3)])
    found = inverse_linear(chain, corners, np.tile(base, (4, 1)), workspace.length)[:, columns]
    T = np.eye(4)
    T[:3, 3], T[:3, :3] = found[0], (found[1:] - found[0]).T
    return Volume(workspace=workspace, axes=names, readings=each, q=q, T_readings_table=T)
