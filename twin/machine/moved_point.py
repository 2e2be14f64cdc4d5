"""Where the tool point is, by moving one point through the chain instead of multiplying poses."""

from typing import Any, NamedTuple

import numpy as np

from matstd.twin.compute import blocks
from matstd.twin.frames import Array
from matstd.twin.machine.chain import Chain
from matstd.twin.machine.contribution import Contribution
from matstd.twin.machine.link import Link

_POSES_A_BLOCK = 5000
"""Poses moved at once: the vectors of a block stay in the first caches (8192 take 1.3 times as long
a pose), and a call of numpy is spread over many of them (256: 1.5 times)."""
_SMALL = 1e-4
"""Square of an angle, rad^2, below which three terms of a series are exact to a double."""
_XYZXY = np.array([0, 1, 2, 0, 1])


def tip_in_tool(length: Array | float, n: int) -> Array:
    """Tool point, or ball centre of a probe, of n poses in the tool frame, shape (N, 3), mm.

    The length is L of a point on the tool axis at (0, 0, -L), scalar or (N,); or the point itself,
    (N, 3), for a target beside the axis.
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
    """Tool point in the table frame, exactly, with or without errors, (N, 3), mm.

    From the tool to the foundation every link moves the point by its motion and then by its
    component error; from there to the workpiece by its error and then back along its motion, which
    are the products ``G M`` and their inverses without one matrix. No angle is taken for small. The
    length is as of `tip_in_tool`; without a contribution the machine is the nominal one.
    """
    start = tip_in_tool(length, len(q)).T
    tool = [i for i, link in enumerate(chain.links) if not link.carries_workpiece]
    workpiece = [i for i, link in enumerate(chain.links) if link.carries_workpiece]
    steps = [_step(chain, i, q, contribution) for i in (*tool[::-1], *workpiece[::-1])]
    out = np.empty((len(q), 3))
    for rows in blocks(len(q), _POSES_A_BLOCK):
        x = np.ascontiguousarray(start[:, rows])
        for step in steps:
            x = step.at(rows).moved(x)
        out[rows] = (x - chain.table_origin[:, None]).T
    return out


class _Step(NamedTuple):
    """A link on the way of the point; arrays have a last dimension of one where all poses agree."""

    link: Link
    travel: Array  # reading of the axis, (N,)
    far: Array  # the reading with the error of its zero, (N,)
    along: Array  # direction of the displaced line, (3, N)
    point: Array  # on that line, (3, N)
    # displacement of the workpiece or the tool, (6, N); None where there is none
    place: Array | None
    twist: Array | None  # component errors, (6, N); None where all are zero

    def at(self, rows: slice) -> "_Step":
        """The same at some poses."""
        link, *arrays = self
        cut: list[Any] = [a if a is None or a.shape[-1] == 1 else a[..., rows] for a in arrays]
        return _Step(link, *cut)

    def moved(self, x: Array) -> Array:
        """A point (3, n) after the link; the body of a workpiece axis is left behind."""
        if self.link.carries_workpiece:
            return self._after_motion(self._after_error(x))
        return self._after_error(self._after_motion(x))

    def _after_error(self, x: Array) -> Array:
        """After the component error; a linear axis carries what its angular errors turn about."""
        if self.twist is None:
            return x
        lever = self.link.point[:, None]
        if self.link.kind == "linear":
            carried = -self.travel if self.link.carries_workpiece else self.travel
            lever = lever + carried * self.link.direction[:, None]
        return _turned(self.twist[3:], x - lever) + (lever + self.twist[:3])

    def _after_motion(self, x: Array) -> Array:
        """After the motion about, or along, the displaced line."""
        if self.link.kind == "linear":
            return x + self.far * self.along
        if self.link.kind == "rotary":
            return (
                self.point + _about(self.along, self.far, x - self.point) if self.far.any() else x
            )
        if self.place is None:
            return x
        if self.link.carries_workpiece:
            return self.point + _turned(-self.place[3:], x - (self.point + self.place[:3]))
        return _turned(self.place[3:], x - self.point) + (self.point + self.place[:3])


def _step(chain: Chain, i: int, q: Array, contribution: Contribution | None) -> _Step:
    """A link with everything that its place decides."""
    link = chain.links[i]
    along, point = link.direction[:, None], link.point[:, None]
    travel = np.zeros(1) if link.kind == "fixed" else q[:, chain.axis_index(link.name)]
    twist, place = _rows(contribution, "twist", i), _rows(contribution, "place", i)
    far = travel
    if place is not None and link.kind != "fixed":
        far, moved = travel + place[link.own_component], place.copy()
        if link.kind == "rotary":  # about its own letter it is the zero of the reading
            moved[link.own_component] = 0.0
        moved = link.in_machine(moved.T).T
        along, point, place = _turned(moved[3:], along), point + moved[:3], None
    if twist is not None:
        twist = link.in_machine(twist.T).T
    return _Step(
        link=link, travel=travel, far=far, along=along, point=point, place=place, twist=twist
    )


def _rows(contribution: Contribution | None, part: str, i: int) -> Array | None:
    """Six components of one link, (6, N), or (6, 1) of constants; None where all are zero."""
    if contribution is None:
        return None
    six = np.asarray(getattr(contribution, part)[:, i].T)
    first = six[:, :1]
    # location errors are constants: what follows from them alone is computed once
    if (first != six[:, -1:]).any():
        return six
    if not first.any() and not six.any():
        return None
    return first if (six == first).all() else six


def _turned(r: Array, v: Array) -> Array:
    """Vectors turned by rotation vectors, (3, n) or (3, 1): Rodrigues' formula without a matrix.

    ``v + r x (a v + b r x v)`` with ``a = sin(t)/t``, ``b = (1 - cos t)/t^2`` and ``t = |r|``.
    """
    r = _twice(r)
    square = r[0] * r[0] + r[1] * r[1] + r[2] * r[2]
    if square.max() < _SMALL:
        first = 1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0))
        second = 0.5 - square * (1.0 / 24.0 - square * (1.0 / 720.0))
    else:
        angle = np.sqrt(square)
        # np.sinc is sin(pi x)/(pi x): both factors stay accurate through angle zero
        first = np.sinc(angle / np.pi)
        second = 0.5 * np.sinc(angle / (2.0 * np.pi)) ** 2
    return np.asarray(v + _cross(r, _twice(first * v + second * _cross(r, _twice(v)))))


def _about(d: Array, angle: Array, v: Array) -> Array:
    """Vectors (3, n) turned about unit directions, (3, n) or (3, 1), by angles (n,)."""
    along = d * (d[0] * v[0] + d[1] * v[1] + d[2] * v[2])
    return along + np.cos(angle) * (v - along) + np.sin(angle) * _cross(_twice(d), _twice(v))


def _twice(v: Array) -> Array:
    """Components x y z x y, (5, n): those that follow one another in a cross product are views."""
    return v.take(_XYZXY, axis=0)


def _cross(a: Array, b: Array) -> Array:
    """Cross product (3, n) of vectors as `_twice` gives them."""
    return np.asarray(a[1:4] * b[2:] - a[2:] * b[1:4])
