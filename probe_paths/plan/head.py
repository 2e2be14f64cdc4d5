"""Where a head that carries the tool turns, and the space that the tool sweeps there.

The tool of a tilting head swings wide beside the spindle, so a head turns at one place only: Z
retracted, X and Y above the standard, or as little beside it as the travels demand. Places are
machine coordinates of the gauge point of the upright head. An axis that carries the workpiece
moves the table instead of the head; the same coordinates hold relative to the table.
"""

from itertools import product
from typing import NamedTuple

import numpy as np

from matstd.artefact.tool import NOSE_HEIGHT, Probe, home_readings
from matstd.twin.frames import Array, apply
from matstd.twin.machine import Chain, table_to_tool
from matstd.twin.units import DEG

_STEP = 2.5 * DEG
"""Step of the samples of a turn, rad: at an arm of 900 mm nothing goes farther out between two of
them by more than 0.22 mm, which is added."""

_WHOLE_TURN = 2.0 * np.pi


class HeadTurns(NamedTuple):
    """Where the head turns, and the space that the tool sweeps there, mm and rad."""

    place: Array  # readings of X, Y and Z, (3,); X and Y whole mm
    limits: Array  # smallest and largest reading of every axis of the head in programs, (H, 2)
    planned: Array  # lower and upper ends of the space between these readings, (2, 3)
    anywhere: Array  # the same from any position of the head within its travels, (2, 3)


def head_turns(
    chain: Chain, probe: Probe, T_table_artefact: Array, z: float, rotary: Array
) -> HeadTurns | None:
    """Place and space of the turns of a head; None where no rotary axis carries the tool.

    Args:
        z: Reading of Z at which it turns, mm.
        rotary: Readings to which programs turn the rotary axes besides home, (V, R), rad.
    """
    names = chain.tool_rotary_axes
    if not names:
        return None
    q = np.zeros(len(chain.axes))
    q[[chain.axis_index(a) for a in "XY"]] = _turning_place(chain, probe, T_table_artefact, z)
    q[chain.axis_index("Z")] = z
    reached = np.concatenate([home_readings(chain)[None], rotary])
    reached = reached[:, [chain.rotary_axes.index(name) for name in names]]
    limits = np.stack([reached.min(axis=0), reached.max(axis=0)], axis=1)
    return HeadTurns(
        place=q[[chain.axis_index(a) for a in "XYZ"]],
        limits=limits,
        planned=swept_space(chain, probe, q, limits),
        anywhere=swept_space(chain, probe, q),
    )


def _turning_place(chain: Chain, probe: Probe, T_table_artefact: Array, z: float) -> Array:
    """Readings of X and Y at which the head turns, (2,), whole mm.

    The upright head stands over the standard's origin, moved as little as needed for everything of
    the tool to stay over the travels of X and Y wherever the axes of the head stand; where the
    travel is shorter than the tool sweeps, in the middle: as far beyond one end as the other.
    """
    xy = [chain.axis_index(a) for a in "XY"]
    q = np.zeros((1, len(chain.axes)))
    q[0, chain.axis_index("Z")] = z
    upright = _gauge_point(chain, q)[0, :2]
    wanted = (T_table_artefact[:3, 3] + chain.table_origin)[:2] - upright
    q[0, xy] = wanted
    low, high = (end[:2] - wanted - upright for end in swept_space(chain, probe, q[0]))
    travel = chain.travels[xy]
    first, last = np.ceil(travel[:, 0] - low), np.floor(travel[:, 1] - high)
    place = np.where(
        first <= last, np.clip(np.round(wanted), first, last), np.round(0.5 * (first + last))
    )
    return np.asarray(np.clip(place, *travel.T))


def swept_space(chain: Chain, probe: Probe, q: Array, between: Array | None = None) -> Array:
    """Lower and upper ends of the space that the tool sweeps as the head turns, (2, 3), mm.

    The tool is ball, probe and spindle nose. All positions of the head between the limits count,
    in whatever order its axes turn; those of the table are at zero.

    Args:
        q: Readings, of which those of the head do not matter, (A,).
        between: Smallest and largest readings of the head's axes in chain order, (H, 2), rad; their
            whole travels without it.
    """
    names = chain.tool_rotary_axes
    limits = np.array([chain.link(name).range for name in names]) if between is None else between
    span = np.minimum(limits[:, 1] - limits[:, 0], _WHOLE_TURN)
    counts = np.ceil(span / _STEP).astype(int) + 1
    shares = [
        low + np.linspace(0.0, turn, count)
        for low, turn, count in zip(limits[:, 0], span, counts, strict=True)
    ]
    poses = np.repeat(q[None], int(np.prod(counts)), axis=0)
    poses[:, chain.rotary_columns] = 0.0
    poses[:, [chain.axis_index(name) for name in names]] = list(product(*shares))
    T = table_to_tool(chain, poses)
    # the rim of a disc of radius r square to the axis a reaches r sqrt(1 - a_i^2) along i
    rim = np.sqrt(np.maximum(1.0 - T[:, :3, 2] ** 2, 0.0))
    ball = _in_machine(chain, T, -probe.length)
    discs, begin = [(ball, np.full(ball.shape, probe.radius))], 0.0
    for end, radius in probe.shape.cylinders:
        for height in (begin, end):
            discs.append((_in_machine(chain, T, height - probe.length), radius * rim))
        begin = end
    low = np.min([(centre - wide).min(axis=0) for centre, wide in discs], axis=0)
    high = np.max([(centre + wide).max(axis=0) for centre, wide in discs], axis=0)
    steps = span / np.maximum(counts - 1, 1)
    more = float(np.sum(_arms(chain, probe) * steps**2)) / 8.0
    return np.stack([low - more, high + more])


def _gauge_point(chain: Chain, q: Array) -> Array:
    """Gauge point, (N, 3), mm, in the coordinates of this module."""
    return _in_machine(chain, table_to_tool(chain, q), 0.0)


def _in_machine(chain: Chain, T_table_tool: Array, height: float) -> Array:
    """Points of the tool axis at a height above the gauge point, (N, 3), mm."""
    return apply(T_table_tool, np.array([0.0, 0.0, height])) + chain.table_origin


def _arms(chain: Chain, probe: Probe) -> Array:
    """How far anything of the tool is from each axis of the head at most, (H,), mm."""
    tool, arms = probe.tool_length + NOSE_HEIGHT + probe.nose_radius, []
    for name in chain.tool_rotary_axes:
        carried = chain.links[chain.link_index(name) :]
        travel = sum(max(map(abs, link.range)) for link in carried if link.kind == "linear")
        arms.append(tool + travel + float(np.linalg.norm(chain.link(name).point)))
    return np.array(arms)
