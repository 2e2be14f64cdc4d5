"""Where the tool point is, by moving one point through the chain instead of multiplying poses."""

import numpy as np

from twin.frames import Array
from twin.machine.chain import Chain, Link
from twin.machine.contribution import Contribution


def tip_in_tool(length: Array | float, n: int) -> Array:
    """Tool point, or ball centre of a probe, in the tool frame, shape (N, 3), mm.

    Args:
        length: L of a point on the tool axis at (0, 0, -L), scalar or (N,); or the point itself,
            (N, 3), for a target beside the axis.
        n: Number of poses.
    """
    length = np.asarray(length, dtype=float)
    if length.ndim == 2:
        return length
    tip = np.zeros((n, 3))
    tip[:, 2] = -length
    return tip


def moved_tip(
    chain: Chain, q: Array, length: Array | float, contribution: Contribution | None
) -> Array:
    """Tool point in the table frame, exactly, with or without errors.

    From the tool to the foundation every link moves the point by its motion and then by its
    component error; from there to the workpiece by its error and then back along its motion, which
    are the products ``G M`` and their inverses without one matrix. No angle is taken for small.

    Args:
        chain: The machine.
        q: Readings, shape (N, A), mm and rad.
        length: As of `tip_in_tool`.
        contribution: What all effects add at these readings; None for the nominal machine.

    Returns:
        Shape (N, 3), mm.
    """
    x = np.ascontiguousarray(tip_in_tool(length, len(q)).T)
    tool = [i for i, link in enumerate(chain.links) if not link.carries_workpiece]
    workpiece = [i for i, link in enumerate(chain.links) if link.carries_workpiece]
    for i in tool[::-1]:
        link, reading = chain.links[i], _reading(chain, chain.links[i], q)
        x = _motion(link, reading, _rows(contribution, "place", i), x, back=False)
        x = _error(link, reading, _rows(contribution, "twist", i), x)
    for i in workpiece[::-1]:
        link, reading = chain.links[i], _reading(chain, chain.links[i], q)
        x = _error(link, -reading, _rows(contribution, "twist", i), x)
        x = _motion(link, -reading, _rows(contribution, "place", i), x, back=True)
    return np.ascontiguousarray((x - chain.table_origin[:, None]).T)


def _reading(chain: Chain, link: Link, q: Array) -> Array:
    return np.zeros(len(q)) if link.kind == "fixed" else q[:, chain.axis_index(link.name)]


def _rows(contribution: Contribution | None, part: str, link: int) -> Array | None:
    """Six components of one link, (6, N); None where all are zero."""
    if contribution is None:
        return None
    rows = np.asarray(getattr(contribution, part)[:, link].T)
    return rows if rows.any() else None


def _error(link: Link, travel: Array, six: Array | None, x: Array) -> Array:
    """A point (3, N) after the component error of a link whose body travelled so far.

    A linear axis carries the point that its angular errors turn about along.
    """
    if six is None:
        return x
    lever = link.point[:, None]
    if link.kind == "linear":
        lever = lever + travel * link.direction[:, None]
    return lever + _turned(six[3:], x - lever) + six[:3]


def _motion(link: Link, travel: Array, place: Array | None, x: Array, back: bool) -> Array:
    """A point (3, N) after the motion of a link about, or along, its displaced line.

    Args:
        travel: Of its body, (N,), mm or rad.
        place: Displacement of the line, (6, N); None where it stands where it should.
        back: Whether the motion is undone.
    """
    sign = -1.0 if back else 1.0
    d, point = link.direction[:, None], link.point[:, None]
    if link.kind == "fixed":
        return x if place is None else _placed(point, place, x, back)
    if link.kind == "linear":
        along = d if place is None else _turned(place[3:], np.broadcast_to(d, x.shape))
        far = travel if place is None else travel + _body(link) * place[link.own]
        return x + sign * far * along
    if place is None:
        return point + _about(d, sign * travel, x - point)
    line = place.copy()
    line[3 + link.own] = 0.0
    angle = sign * (travel + _body(link) * place[3 + link.own])
    moved = point + _about(d, angle, _placed(point, line, x, True) - point)
    return _placed(point, line, moved, False)


def _body(link: Link) -> float:
    """+1 where the body moves with the reading, -1 where it carries the workpiece."""
    return -1.0 if link.carries_workpiece else 1.0


def _placed(point: Array, place: Array, x: Array, back: bool) -> Array:
    """A point after a rotation about another and a shift, or before them."""
    if back:
        return point + _turned(-place[3:], x - place[:3] - point)
    return point + _turned(place[3:], x - point) + place[:3]


def _turned(r: Array, v: Array) -> Array:
    """Vectors (3, N) turned by rotation vectors (3, N): Rodrigues' formula without a matrix."""
    angle = np.sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2])
    # np.sinc is sin(pi x)/(pi x): both factors stay accurate through angle zero.
    first = np.sinc(angle / np.pi)
    second = 0.5 * np.sinc(angle / (2.0 * np.pi)) ** 2
    once = _cross(r, v)
    return np.asarray(v + first * once + second * _cross(r, once))


def _about(d: Array, angle: Array, v: Array) -> Array:
    """Vectors (3, N) turned about one unit direction (3, 1) by angles (N,)."""
    along = d * (d[0] * v[0] + d[1] * v[1] + d[2] * v[2])
    return along + np.cos(angle) * (v - along) + np.sin(angle) * _cross(d, v)


def _cross(a: Array, b: Array) -> Array:
    return np.stack(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    )
