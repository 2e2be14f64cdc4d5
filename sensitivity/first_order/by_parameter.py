"""Jacobians of all error parameters at millions of poses a second: parameter by parameter.

One walk along the chain from the table to the tool. A workpiece-carrying axis moves its body by
minus its reading, so seen from the table every axis turns by plus its reading, and both sides of
the foundation are one product. With R the rotation of a body in the table frame, p the tip and c
the lever point of an axis, a component error e or r of it moves the tip by ``R e`` and
``(R r) x (p - c)``. Whatever does not depend on the pose has a last dimension of one and is
broadcast. `twin.machine.kinematics.reach` says the same in 4x4 matrices and shares nothing with
this file.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from twin.compute import blocks
from twin.frames import Array, rotation
from twin.machine import Chain, Family, Link, Symbol, checked_readings

_POSES_A_BLOCK = 4000  # a few columns of a block stay in the second cache


class PoseCache(NamedTuple):
    """A link of the chain at n poses, table frame; a last dimension of one is every pose alike.

    Attributes:
        before: Rotation of the body on the table's side of the axis, (3, 3, n).
        after: Rotation of the body on the tool's side, (3, 3, n).
        carrier: Rotation of the body that the axis sits on, one of the two.
        arm: From the lever point of the axis to the tip, (3, n), mm.
        reading: Shape (n,), mm or rad.
    """

    before: Array
    after: Array
    carrier: Array
    arm: Array
    reading: Array


def jacobian_by_parameter(
    chain: Chain, q: Array, length: Array | float, symbols: Sequence[Symbol] | None = None
) -> Array:
    """First-order deviation of the tool point per unit of every error parameter, parameter first.

    The same numbers as `sensitivity.first_order.jacobians.jacobian`, in the order of memory that
    fills fastest.

    Args:
        q: Readings, shape (N, A), mm and rad.
        length: Tool length, scalar or (N,), mm.
        symbols: P parameters; None for all of `chain.symbols`, in that order.

    Returns:
        Shape (P, 3, N), table frame, mm/mm and mm/rad.

    Reference:
        D-MT paper, eq. (3); the influence matrix of Bringmann and Knapp.
    """
    q = checked_readings(chain, q)
    symbols = chain.symbols if symbols is None else symbols
    out = np.empty((len(symbols), 3, len(q)))
    for rows, part in jacobian_blocks(chain, q, length, symbols):
        out[:, :, rows] = part
    return out


def jacobian_blocks(
    chain: Chain, q: Array, length: Array | float, symbols: Sequence[Symbol]
) -> Iterator[tuple[slice, Array]]:
    """The same, 4000 poses at a time, for whatever needs each column only once.

    Yields:
        Which poses, and their columns (P, 3, n); the array is used again for the next block.
    """
    length = np.broadcast_to(np.asarray(length, dtype=float), (len(q),))
    of_link: list[list[tuple[int, Symbol]]] = [[] for _ in chain.links]
    for p, symbol in enumerate(symbols):
        of_link[chain.link_index(symbol.link)].append((p, symbol))
    room = np.empty((len(symbols), 3, min(len(q), _POSES_A_BLOCK)))
    for rows in blocks(len(q), _POSES_A_BLOCK):
        part = room[:, :, : rows.stop - rows.start]
        stands = _walk(chain, q[rows], length[rows])
        for link, stand, wanted in zip(chain.links, stands, of_link, strict=True):
            for p, symbol in wanted:
                _column(link, stand, symbol, part[p])
        yield rows, part


def _walk(chain: Chain, q: Array, length: Array) -> list[PoseCache]:
    """Every link as seen from the table, in chain order."""
    R: Array = np.eye(3)[:, :, None]
    t = -chain.table_origin[:, None]
    passed: list[tuple[Array, Array, Array, Array]] = []
    for link in chain.links:
        before, lever = R, _times(R, link.point) + t
        fixed = link.kind == "fixed"
        reading = np.zeros(1) if fixed else q[:, chain.axis_index(link.name)].copy()
        if link.kind == "linear":
            t = t + _times(R, link.direction) * reading
        elif link.kind == "rotary":
            R = _turned(before, link.direction, reading)
            t = t + _times(before, link.point) - _times(R, link.point)
        if not link.carries_workpiece:  # the point is carried by the axis's own body
            lever = _times(R, link.point) + t
        passed.append((before, R, lever, reading))
    tip = t - R[:, 2] * length
    return [
        PoseCache(
            before=before,
            after=after,
            carrier=after if link.carries_workpiece else before,
            arm=tip - lever,
            reading=reading,
        )
        for link, (before, after, lever, reading) in zip(chain.links, passed, strict=True)
    ]


def _times(R: Array, v: Array) -> Array:
    """R (3, 3, n) on a fixed vector (3,), (3, n); entries of zero cost nothing."""
    columns = [R[:, i] * v[i] for i in range(3) if v[i] != 0.0]
    return sum(columns[1:], columns[0]) if columns else np.zeros((3, 1))


def _turned(R: Array, direction: Array, angle: Array) -> Array:
    """R behind a rotation about a direction, (3, 3, n)."""
    if not angle.any():  # a spindle that stands still
        return R
    main = int(np.argmax(np.abs(direction)))
    if np.count_nonzero(direction) > 1 or direction[main] < 0.0:
        turning = np.moveaxis(rotation(angle[:, None] * direction), 0, -1)
        out: Array = np.sum(R[:, :, None] * turning[None], axis=1)
        return out
    c, s = np.cos(angle), np.sin(angle)
    i, j = (main + 1) % 3, (main + 2) % 3
    out = np.empty((3, 3, len(angle)))
    out[:, main] = R[:, main]
    out[:, i] = R[:, i] * c + R[:, j] * s
    out[:, j] = R[:, j] * c - R[:, i] * s
    return out


def _column(link: Link, stand: PoseCache, symbol: Symbol, out: Array) -> None:
    """One column (3, n) of the Jacobian."""
    i = symbol.component % 3
    if symbol.family is Family.COMPONENT:
        axis = stand.carrier[:, i]
    else:
        axis = _displaced(link, stand, i, symbol.is_angular)
    linear_rotation = link.kind == "linear" and symbol.family is not Family.COMPONENT
    if not symbol.is_angular or linear_rotation:
        out[:] = axis
        return
    (x, y, z), (a, b, c) = axis, stand.arm
    np.subtract(y * c, z * b, out=out[0])
    np.subtract(z * a, x * c, out=out[1])
    np.subtract(x * b, y * a, out=out[2])


def _displaced(link: Link, stand: PoseCache, i: int, angular: bool) -> Array:
    """What a displaced or tilted line does along machine direction i, (3, n).

    Displacement, or rotation about the lever point; for a tilted linear axis the displacement that
    the tilt makes of its travel. See `twin.machine.kinematics.place_as_twist`.
    """
    if link.kind == "fixed":
        own = stand.carrier[:, i]
        return -own if link.carries_workpiece else own
    along = _times(stand.carrier, link.direction)
    if link.kind == "linear":
        if not angular:
            return along
        return _times(stand.carrier, np.cross(np.eye(3)[i], link.direction)) * stand.reading
    if angular and i == link.own:  # the zero position: a constant added to the reading
        return along
    return stand.before[:, i] - stand.after[:, i]
