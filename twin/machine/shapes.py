"""Distributions of an error over the reading of its axis, with unit peak amplitude."""

from typing import Literal

import numpy as np

from matstd.twin.frames import Array
from matstd.twin.machine.link import Link

ShapeName = Literal["constant", "linear", "parabolic", "sinusoidal"]
SHAPES: tuple[ShapeName, ...] = ("constant", "linear", "parabolic", "sinusoidal")


def sine_argument(q: Array, link: Link, periods: float = 1.0) -> Array:
    """Argument of the sinusoidal distribution, rad: whole periods over the range of a linear axis,
    over a turn of a rotary one.
    """  # noqa: D205
    if link.kind == "rotary":
        return periods * q
    low, high = link.range
    return 2.0 * np.pi * periods * (q - low) / (high - low)


def shape(name: ShapeName, q: Array, link: Link, periods: float = 1.0, phase: float = 0.0) -> Array:
    """Error per unit of peak amplitude at every reading, (N,).

    With u the reading scaled to [-1, 1]: linear ``u``; parabolic ``2 u^2 - 1``; sinusoidal
    ``sin(2 pi n (q - q_min)/(q_max - q_min) + phi)`` on a linear axis, ``sin(n q + phi)`` on a
    rotary one; constant 1.

    Args:
        q: Readings, shape (N,), mm or rad.
        periods: n of the sinusoidal distribution.
        phase: phi of the sinusoidal distribution, rad.
    """
    if name == "constant":
        return np.ones_like(q)
    if name == "sinusoidal":
        return np.sin(sine_argument(q, link, periods) + phase)
    u = link.scaled(q)
    return u if name == "linear" else 2.0 * u**2 - 1.0
