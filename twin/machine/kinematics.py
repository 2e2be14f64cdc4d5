"""Forward kinematics: from axis readings and errors of the chain to the tool point, table frame.

Poses are products of exponentials: with every axis at zero all bodies share the machine frame, so
link k multiplies its motion, written in that frame, onto the body it sits on. A workpiece-carrying
axis moves its body by minus its reading.
"""

from typing import NamedTuple

import numpy as np

from matstd.twin.errors import NotReachable, ShapeMismatch
from matstd.twin.frames import Array, apply, inverse, pose, skew
from matstd.twin.machine.chain import Chain
from matstd.twin.machine.contribution import Contribution, Where
from matstd.twin.machine.link import Link
from matstd.twin.machine.moved_point import moved_tip, tip_in_tool


class Reach(NamedTuple):
    """Tip deviation in the table frame per unit of every component at every link, first order."""

    twist: Array  # of component errors, (N, L, 6, 3), mm/mm and mm/rad
    place: Array  # of displacements of an axis's line, of the workpiece or the tool, (N, L, 6, 3)

    def of(self, where: Where) -> Array:
        """Displacement of the tip relative to the standard per unit of one entry, (N, 3).

        A shift moves the standard, so the tip moves against it; a bias moves nothing.
        """
        if where.moves_tip:
            return np.asarray(getattr(self, where.part)[where.entry])
        out = np.zeros((len(self.twist), 3))
        if where.part == "shift":
            out[:, where.component] = -1.0
        return out


def checked_readings(chain: Chain, q: Array) -> Array:
    """Readings as a float array (N, A); raises ShapeMismatch."""
    q = np.asarray(q, dtype=float)
    if q.ndim != 2 or q.shape[1] != len(chain.axes):
        raise ShapeMismatch(
            f"readings of shape {q.shape}, expected (N, {len(chain.axes)}) "
            f"for the axes {', '.join(chain.axes)}"
        )
    return q


def _sign(link: Link) -> float:
    """+1 where the body moves with the reading, -1 where it carries the workpiece."""
    return -1.0 if link.carries_workpiece else 1.0


def _readings_of(chain: Chain, link: Link, q: Array) -> Array:
    return np.zeros(len(q)) if link.kind == "fixed" else q[:, chain.axis_index(link.name)]


def _after(R: Array, t: Array, link: Link, travel: Array) -> tuple[Array, Array]:
    """Rotation (N, 3, 3) and place (N, 3) of a body for the travel (N,) of a link that moves it."""
    if link.kind == "linear":
        return R, t + travel[:, None] * (R @ link.direction)
    turned = R @ _about(link.direction, travel)
    return turned, t + (R - turned) @ link.point


def _about(direction: Array, angle: Array) -> Array:
    """Rotations (N, 3, 3) by angles (N,) about one unit vector, exact for any angle (Rodrigues)."""
    S, angle = skew(direction), angle[:, None, None]
    return np.eye(3) + np.sin(angle) * S + 2.0 * np.sin(0.5 * angle) ** 2 * (S @ S)


def _lever_point(link: Link, reading: Array) -> Array:
    """Point (N, 3) that the angular errors turn about, in the frame of the carrying body.

    A linear axis carries its reference point along; a rotary axis's stays with the body.
    """
    if link.kind == "linear":
        return link.point + _sign(link) * reading[:, None] * link.direction
    return np.broadcast_to(link.point, (len(reading), 3))


def _sides(chain: Chain) -> tuple[list[int], list[int]]:
    """Indices of the links from the foundation outwards: to the workpiece, and to the tool."""
    primed = [i for i, link in enumerate(chain.links) if link.carries_workpiece]
    tool = [i for i, link in enumerate(chain.links) if not link.carries_workpiece]
    return primed[::-1], tool


def carriers(chain: Chain, q: Array) -> tuple[Array, Array, Array]:
    """Nominal poses of the body that each link sits on, of the table and of the tool.

    Returns:
        T_machine_carrier (N, L, 4, 4), T_machine_table (N, 4, 4), T_machine_tool (N, 4, 4).
    """
    q = checked_readings(chain, q)
    T_machine_carrier = np.empty((len(q), len(chain.links), 4, 4))
    ends = []
    for side in _sides(chain):
        R, t = np.broadcast_to(np.eye(3), (len(q), 3, 3)), np.zeros((len(q), 3))
        for i in side:
            link = chain.links[i]
            T_machine_carrier[:, i] = pose(R, t)
            if link.kind != "fixed":
                R, t = _after(R, t, link, _sign(link) * _readings_of(chain, link, q))
        ends.append((R, t))
    (R_table, t_table), tool = ends
    return T_machine_carrier, pose(R_table, t_table + R_table @ chain.table_origin), pose(*tool)


def table_to_tool(chain: Chain, q: Array) -> Array:
    """Nominal pose T_table_tool (N, 4, 4): takes tool coordinates to table coordinates."""
    _, T_machine_table, T_machine_tool = carriers(chain, q)
    return inverse(T_machine_table) @ T_machine_tool


def tip(chain: Chain, q: Array, length: Array | float) -> Array:
    """Nominal tool point (ball centre of a probe) in the table frame, (N, 3), mm.

    Args:
        q: Readings, shape (N, A), mm and rad.
        length: Tool length, scalar or (N,), or the tool point in the tool frame, (N, 3), mm.
    """
    return moved_tip(chain, checked_readings(chain, q), length, None)


def place_as_twist(chain: Chain, q: Array, twist: Array) -> Array:
    """What a displaced line, workpiece or tool does, as by twists of the same link, first order.

    With the reading q, direction d, body rotation R, s = +1 on the tool side and -1 on the
    workpiece side, (e, r) the displacement and k the component of the axis's own letter: a linear
    axis gives ``e' = d e_k + q r x d``; a rotary one ``(e', r') = s (1 - R)(e, r)`` for the
    components across its letter, and for its zero position ``r' = d r_k``, which adds to the
    reading; the tool ``(e, r)``; the workpiece ``-(e, r)``, since the twist is tool minus
    workpiece. All in the frame of the axis (`Link.frame`), in which d is its letter; against the
    letter that frame is left-handed, and cross products and rotations change their sign.

    Args:
        twist: What a unit of every component of the twists does, (N, L, 6, 3).

    Returns:
        The same of every component of the displacements, (N, L, 6, 3).
    """
    out = np.zeros_like(twist)
    for i, link in enumerate(chain.links):
        shifts, turns, there = twist[:, i, :3], twist[:, i, 3:], out[:, i]
        if link.kind == "fixed":
            there[:] = _sign(link) * twist[:, i]
            continue
        d, reading = link.sense * np.eye(3)[link.own], _readings_of(chain, link, q)
        if link.kind == "linear":
            there[:, link.own] = shifts[:, link.own]
            there[:, 3:] = reading[:, None, None] * (np.cross(np.eye(3), d) @ shifts)
        else:
            R = np.swapaxes(_about(d, _sign(link) * reading), -1, -2)
            there[:, :3] = _sign(link) * (shifts - R @ shifts)
            there[:, 3:] = _sign(link) * (turns - R @ turns)
            there[:, 3 + link.own] = turns[:, link.own]
    return out


def reach(chain: Chain, q: Array, length: Array | float) -> Reach:
    """First-order deviation of the tool point per unit of every error, table frame, in closed form.

    A component error (e, r) of link k moves the tip, relative to the table, by
    ``R_table_carrier (e + r x (x - c))``, with x the tip and c the lever point of the link, both
    in the frame of the body that the link sits on, and e, r in `Link.frame`. The sign is the same
    on both sides of the foundation because a component error is tool side minus workpiece side.
    Lengths are as of `tip`.

    Reference:
        ISO 230-1:2012 for the parameters; J is the influence matrix of Bringmann and Knapp.
    """
    q = checked_readings(chain, q)
    T_machine_carrier, T_machine_table, T_machine_tool = carriers(chain, q)
    tip_machine = apply(T_machine_tool, tip_in_tool(length, len(q)))
    R_carrier, origin = T_machine_carrier[..., :3, :3], T_machine_carrier[..., :3, 3]
    # rows are the carrier's x, y, z in table coordinates
    axes = np.swapaxes(R_carrier, -1, -2) @ T_machine_table[:, None, :3, :3]
    local = np.einsum("nlji,nlj->nli", R_carrier, tip_machine[:, None] - origin)
    points = [_lever_point(link, _readings_of(chain, link, q)) for link in chain.links]
    arm = np.einsum("nlk,nlki->nli", local - np.stack(points, axis=1), axes)
    twist = np.concatenate([axes, axes @ skew(arm)], axis=2)
    for i, link in enumerate(chain.links):
        if not link.is_along_letter:
            twist[:, i] = (link.frame.T @ twist[:, i].reshape(-1, 2, 3, 3)).reshape(-1, 6, 3)
    return Reach(twist, place_as_twist(chain, q, twist))


def exact_tip(chain: Chain, q: Array, length: Array | float, contribution: Contribution) -> Array:
    """Actual tool point in the table frame with every error in it, (N, 3), mm; lengths as of `tip`.

    Each link moves the point by its component error, a rotation by the vector r about the lever
    point followed by the shift e, and by its motion about, or along, its displaced line; no angle
    is taken for small. Minus `tip` it is the volumetric deviation.
    """
    return moved_tip(chain, checked_readings(chain, q), length, contribution)


def linear_directions(chain: Chain, q: Array) -> Array:
    """Motion of the tip in the table frame per unit of each linear axis of the chain, (N, 3, M)."""
    T_machine_carrier, T_machine_table, _ = carriers(chain, q)
    return _directions(chain, T_machine_carrier, T_machine_table)


def tool_and_directions(chain: Chain, q: Array) -> tuple[Array, Array]:
    """`table_to_tool` and `linear_directions` together, in half of their time."""
    T_machine_carrier, T_machine_table, T_machine_tool = carriers(chain, q)
    along = _directions(chain, T_machine_carrier, T_machine_table)
    return inverse(T_machine_table) @ T_machine_tool, along


def _directions(chain: Chain, T_machine_carrier: Array, T_machine_table: Array) -> Array:
    columns = []
    for name in chain.linear_axes:
        i = chain.link_index(name)
        in_machine = T_machine_carrier[:, i, :3, :3] @ chain.links[i].direction
        columns.append(np.einsum("nji,nj->ni", T_machine_table[:, :3, :3], in_machine))
    return np.stack(columns, axis=-1) if columns else np.zeros((len(T_machine_table), 3, 0))


def linear_motion(chain: Chain, q: Array, way: Array) -> Array:
    """Motion of the linear axes that moves the tip by given ways of the table frame, (N, A).

    Least squares, as a machine may have fewer than three of them; zero in columns of other axes.
    """
    out = np.zeros(q.shape)
    across = np.linalg.pinv(linear_directions(chain, q))
    out[:, chain.linear_columns] = np.einsum("nmi,ni->nm", across, way)
    return out


def inverse_linear(chain: Chain, target: Array, q: Array, length: Array | float) -> Array:
    """Readings of the linear axes that bring the tip to a point at given rotary readings, (N, A).

    At fixed rotary readings the tip is an affine function of the linear readings, so one solution
    of three equations is exact. Travels are not checked here.

    Args:
        chain: The machine; exactly three linear axes.
        target: Wanted tip (ball centre), table frame, shape (N, 3), mm.
        q: Readings whose rotary columns are kept, shape (N, A); linear columns are ignored.
        length: As of `tip`.

    Raises:
        NotReachable: The machine has not three independent linear axes in some pose.
    """
    q = checked_readings(chain, q).copy()
    columns = chain.linear_columns
    if len(columns) != 3:
        raise NotReachable(
            f"machine {chain.name} has {len(columns)} linear axes, "
            f"{', '.join(chain.linear_axes) or 'none'}; a tip position needs three: in brackets, "
            'such as "(W)", an axis of the chain stays at zero'
        )
    q[:, columns] = 0.0
    D = linear_directions(chain, q)
    if np.any(np.abs(np.linalg.det(D)) < 1e-6):
        raise NotReachable(f"the linear axes of {chain.name} lie in one plane in some pose")
    q[:, columns] = np.linalg.solve(D, (target - tip(chain, q, length))[..., None])[..., 0]
    return q
