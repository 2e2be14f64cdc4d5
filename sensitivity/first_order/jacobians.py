"""Jacobians of all error parameters at millions of poses a second: parameter by parameter.

One walk along the chain from the table to the tool. A workpiece-carrying axis moves its body by
minus its reading, so seen from the table every axis turns by plus its reading, and both sides of
the foundation are one product. With R the rotation of a body in the table frame, p the tip and c
the lever point of an axis, a component error e or r of it moves the tip by ``R e`` and ``(R r) x (p
- c)``. `matstd.twin.machine.kinematics.reach` computes the same with 4x4 matrices, sharing no code.

A vector is kept as its components x y z x y, (5, n): what follows one another in a cross product is
then a view, and three calls of numpy make three columns. Whatever does not depend on the pose has
a last dimension of one and is broadcast.
"""

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import NamedTuple

import numpy as np

from matstd.twin.compute import blocks
from matstd.twin.frames import Array, rotation, skew
from matstd.twin.machine import Chain, Family, Link, Symbol, checked_readings

_POSES_A_BLOCK = 5000
"""Poses at once: a few columns stay in the second cache (10 000 take no less), and a call of numpy
is spread over many of them (1500 take 1.5 times as long a pose)."""
_XYZXY = [0, 1, 2, 0, 1]


class PoseCache(NamedTuple):
    """A link of the chain at n poses, table frame."""

    before: Array  # axes of the body on the table's side of the link, (3, 5, n)
    after: Array  # axes of the body on the tool's side, (3, 5, n)
    carrier: Array  # axes of the body that the link sits on, one of the two
    arm: Array  # from the lever point of the link to the tip, (5, n), mm
    reading: Array  # shape (n,), mm or rad


class _Run(NamedTuple):
    """Consecutive parameters of one link that are alike but for their direction."""

    link: int
    family: Family
    is_angular: bool
    columns: slice  # of the Jacobian
    directions: slice  # as many of x, y, z


def jacobian(
    chain: Chain, q: Array, length: Array | float, symbols: Sequence[Symbol] | None = None
) -> Array:
    """First-order deviation of the tool point per unit of every error parameter.

    ``dp/dE`` in closed form: a component error by the twist of its axis, a location or set-up
    error by the displacement of its link. A component error counts with the value it has at the
    reading of the pose, whatever its distribution.

    Args:
        q: Readings, shape (N, A), mm and rad.
        length: Tool length, scalar or (N,), mm.
        symbols: P parameters; None for all of `chain.symbols`, in that order.

    Returns:
        Shape (N, P, 3), table frame, mm/mm and mm/rad.

    Reference:
        D-MT paper, eq. (3); the influence matrix of Bringmann and Knapp.
    """
    return np.moveaxis(jacobian_by_parameter(chain, q, length, symbols), -1, 0)


def jacobian_by_parameter(
    chain: Chain, q: Array, length: Array | float, symbols: Sequence[Symbol] | None = None
) -> Array:
    """As `jacobian`, (P, 3, N): in the fastest order of memory."""
    q = checked_readings(chain, q)
    symbols = chain.symbols if symbols is None else symbols
    length = np.broadcast_to(np.asarray(length, dtype=float), (len(q),))
    runs = _runs(chain, symbols)
    out = np.empty((len(symbols), 3, len(q)))
    for rows in blocks(len(q), _POSES_A_BLOCK):
        _fill(chain, q[rows], length[rows], runs, out[:, :, rows])
    return out


def jacobian_blocks(
    chain: Chain, q: Array, length: Array | float, symbols: Sequence[Symbol]
) -> Iterator[tuple[slice, Array]]:
    """The same in blocks of poses, for callers that need each column only once.

    Yields:
        Which poses, and their columns (P, 3, n); the array is used again for the next block.
    """
    length = np.broadcast_to(np.asarray(length, dtype=float), (len(q),))
    runs = _runs(chain, symbols)
    room = np.empty((len(symbols), 3, min(len(q), _POSES_A_BLOCK)))
    for rows in blocks(len(q), _POSES_A_BLOCK):
        part = room[:, :, : rows.stop - rows.start]
        _fill(chain, q[rows], length[rows], runs, part)
        yield rows, part


def _runs(chain: Chain, symbols: Sequence[Symbol]) -> list[_Run]:
    """The parameters in as few runs as their order allows: 30 of the 71 of the example."""

    def alike(numbered: tuple[int, Symbol]) -> tuple[str, Family, bool, int]:
        p, symbol = numbered
        return symbol.link, symbol.family, symbol.is_angular, symbol.component - p

    runs = []
    for (link, family, is_angular, ahead), group in groupby(enumerate(symbols), alike):
        columns = [p for p, _ in group]
        first, last = columns[0], columns[-1]
        directions = slice((first + ahead) % 3, (last + ahead) % 3 + 1)
        place = chain.link_index(link), family, is_angular
        runs.append(_Run(*place, slice(first, last + 1), directions))
    return runs


def _fill(chain: Chain, q: Array, length: Array, runs: Sequence[_Run], out: Array) -> None:
    """Columns of all runs at n poses into (P, 3, n)."""
    stands = _walk(chain, q, length)
    for run in runs:
        link, stand = chain.links[run.link], stands[run.link]
        part = out[run.columns]
        if run.family is Family.COMPONENT:
            axes = stand.carrier[run.directions]
        elif link.kind == "linear" and run.is_angular:
            # a tilt displaces by travel, across the axis
            for column, across in zip(
                part, skew(link.sense * np.eye(3)[link.own])[run.directions], strict=True
            ):
                np.multiply(_along(stand.carrier, across)[:3], stand.reading, out=column)
            continue
        else:
            axes = _displaced(link, stand, run.directions, run.is_angular)
        if run.is_angular:
            arm = stand.arm
            np.subtract(axes[:, 1:4] * arm[2:], axes[:, 2:] * arm[1:4], out=part)
        else:
            part[:] = axes[:, :3]


def _walk(chain: Chain, q: Array, length: Array) -> list[PoseCache]:
    """Every link as seen from the table, in chain order."""
    axes: Array = np.eye(3)[:, _XYZXY, None]
    t = -chain.table_origin[_XYZXY, None]
    passed: list[PoseCache] = []
    for link in chain.links:
        before = axes
        if link.carries_workpiece:  # the point stays with the body on the table's side
            lever = _lever(t, axes, link.point)
        fixed = link.kind == "fixed"
        reading = np.zeros(1) if fixed else q[:, chain.axis_index(link.name)].copy()
        if link.kind == "linear":
            t = t + _along(axes, link.direction) * reading
        elif link.kind == "rotary":
            axes = _turned(before, link.direction, reading)
            t = _lever(t, before, link.point)
            t = _lever(t, axes, -link.point)
        if not link.carries_workpiece:  # the point is carried by the axis's own body
            lever = _lever(t, axes, link.point)
        old, new = (
            a if link.is_along_letter else np.tensordot(link.frame.T, a, 1) for a in (before, axes)
        )
        carrier = new if link.carries_workpiece else old
        passed.append(
            PoseCache(before=old, after=new, carrier=carrier, arm=-lever, reading=reading)
        )
    tip = t - axes[2] * length
    return [link._replace(arm=tip + link.arm) for link in passed]


def _along(axes: Array, v: Array) -> Array:
    """A fixed vector (3,) of a body, (5, n); components of zero and one cost nothing."""
    parts = [axes[i] if v[i] == 1.0 else axes[i] * v[i] for i in range(3) if v[i] != 0.0]
    return sum(parts[1:], parts[0]) if parts else np.zeros((5, 1))


def _lever(t: Array, axes: Array, point: Array) -> Array:
    """A fixed point of a body whose origin is at t, (5, n)."""
    return t + _along(axes, point) if point.any() else t


def _turned(axes: Array, direction: Array, angle: Array) -> Array:
    """Axes of a body behind a rotation about a direction of the one before it, (3, 5, n)."""
    if not angle.any():  # a spindle that stands still
        return axes
    main = int(np.argmax(np.abs(direction)))
    if np.count_nonzero(direction) > 1 or direction[main] < 0.0:
        turning = np.moveaxis(rotation(angle[:, None] * direction), 0, -1)
        return np.asarray(np.sum(axes[:, None] * turning[:, :, None], axis=0))
    c, s = np.cos(angle), np.sin(angle)
    i, j = (main + 1) % 3, (main + 2) % 3
    out = np.empty((3, 5, len(angle)))
    out[main] = axes[main]
    out[i] = axes[i] * c + axes[j] * s
    out[j] = axes[j] * c - axes[i] * s
    return out


def _displaced(link: Link, stand: PoseCache, directions: slice, is_angular: bool) -> Array:
    """Effect of a displaced line along machine directions, (., 5, n).

    Displacement, or of a tilted line of a rotary axis rotation about the lever point. See
    `matstd.twin.machine.kinematics.place_as_twist`.
    """
    if link.kind == "fixed":
        own = stand.carrier[directions]
        return -own if link.carries_workpiece else own
    if link.kind == "rotary":
        moved = stand.before[directions] - stand.after[directions]
        if is_angular and directions.start <= link.own < directions.stop:
            # the zero position: a constant added to the reading
            moved[link.own - directions.start] = stand.carrier[link.own]
        return moved
    return stand.carrier[link.own][None]


def sensitivity(
    chain: Chain, q: Array, length: Array | float, symbols: Sequence[Symbol] | None = None
) -> Array:
    """``S = |dp/dE|`` of every error parameter at every pose, (N, P), mm/mm and mm/rad.

    It is one for every translational component error, and the distance from the axis of rotation
    for an angular one. What a touch can determine follows from the signed ``n . dp/dE``
    (`matstd.information.criteria.posterior`). Arguments and reference are those of `jacobian`.
    """
    return np.linalg.norm(jacobian(chain, q, length, symbols), axis=-1)
