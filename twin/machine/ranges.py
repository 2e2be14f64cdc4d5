"""Expected sizes of the errors of a machine by class, and their shapes over a reading."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from matstd.twin.frames import Array
from matstd.twin.machine.chain import Chain
from matstd.twin.machine.link import Link
from matstd.twin.machine.symbols import Family, Symbol
from matstd.twin.units import UM, URAD

ShapeName = Literal["constant", "linear", "parabolic", "sinusoidal"]


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


DEFAULT_RANGES: Mapping[str, tuple[float, float]] = {
    "linear_translation": (50 * UM, 100 * UM),
    "linear_rotation": (50 * URAD, 100 * URAD),
    "rotary_translation": (5 * UM, 10 * UM),
    "rotary_rotation": (10 * URAD, 40 * URAD),
    "linear_zero": (10 * UM, 50 * UM),
    "squareness": (20 * URAD, 100 * URAD),
    "rotary_location": (20 * UM, 100 * UM),
    "rotary_tilt": (20 * URAD, 100 * URAD),
    "rotary_zero": (20 * URAD, 100 * URAD),
    "arm_translation": (2 * UM, 20 * UM),
    "arm_rotation": (10 * URAD, 100 * URAD),
    "arm_location": (100 * UM, 1000 * UM),
    "arm_tilt": (100 * URAD, 5000 * URAD),
    "arm_zero": (200 * URAD, 10000 * URAD),
    "setup_translation": (10 * UM, 50 * UM),
    "setup_rotation": (20 * URAD, 100 * URAD),
}
"""Smallest and largest peak amplitude of each class of error, mm or rad.

The translations of a linear axis (50 to 100 µm) and the upper end of those of a rotary axis (10 µm)
are those of the D-MT paper's figures 2 and 3; the angular ones of a linear axis take the same
figures in µrad, over which the paper is silent; the rest are typical of neglected machines of this
class and are ours. Joints of a serial arm are those of an arm that was never calibrated, which
misses by millimetres: two that were measured had zeros off by 3 mrad, links by 0.9 mm, a twist by
7 mrad, while the joints themselves ran truer than 0.1 mrad.
"""


def error_class(chain: Chain, symbol: Symbol) -> str:
    """Class of an error parameter: one of the keys of `DEFAULT_RANGES`."""
    link = chain.link(symbol.link)
    kind = "arm" if link.is_joint else link.kind
    motion = "rotation" if symbol.is_angular else "translation"
    if symbol.family is Family.SETUP:
        return f"setup_{motion}"
    if symbol.family is Family.COMPONENT:
        return f"{kind}_{motion}"
    if kind == "linear":
        return "squareness" if symbol.is_angular else "linear_zero"
    if not symbol.is_angular:
        return f"{kind}_location"
    return f"{kind}_zero" if symbol.component - 3 == link.own else f"{kind}_tilt"


@dataclass(frozen=True)
class Ranges:
    """Expected amplitude of every error: by class, or by name where a name is given."""

    # smallest and largest peak amplitude of each class, mm or rad
    by_class: Mapping[str, tuple[float, float]] = field(default_factory=lambda: DEFAULT_RANGES)
    # the same for single parameters, which go before their class
    by_name: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    def of(self, chain: Chain, symbol: Symbol) -> tuple[float, float]:
        """Smallest and largest peak amplitude of one parameter, mm or rad."""
        if symbol.name in self.by_name:
            return self.by_name[symbol.name]
        return self.by_class[error_class(chain, symbol)]

    def sd(self, chain: Chain, symbol: Symbol) -> float:
        """Standard deviation of an amplitude drawn evenly from its range with a random sign.

        ``sqrt((a^2 + a b + b^2)/3)`` for the range [a, b].
        """
        low, high = self.of(chain, symbol)
        return math.sqrt((low * low + low * high + high * high) / 3.0)
