"""What a law moves: a component of a link, the standard, or the reading of the probe."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from matstd.twin.fields import component_symbol
from matstd.twin.frames import Array
from matstd.twin.machine import Chain, Symbol
from matstd.twin.model import Term, Where
from matstd.twin.record import Touches

SHIFT, BIAS, GROWTH, TILT = "shift", "bias", "growth", "tilt"
PARTS = {SHIFT: 3, BIAS: 1, GROWTH: 1, TILT: 3, "shift-x": 1, "shift-y": 1, "shift-z": 1}
"""Carriers that are no component of a link, with their number of amplitudes."""


@dataclass(frozen=True)
class Carrier:
    """What a law moves."""

    name: str  # a component error, `EZX`, or one of `PARTS`
    symbol: Symbol | None = None  # symbol of a component error; None for one of `PARTS`

    @property
    def count(self) -> int:
        """Number of amplitudes."""
        return PARTS.get(self.name, 1)

    @property
    def is_angular(self) -> bool:
        """Whether its amplitudes are angles."""
        return self.name == TILT or (self.symbol is not None and self.symbol.is_angular)

    @property
    def unit(self) -> str:
        """Base unit of an amplitude: of a growth it is a strain."""
        return "rad" if self.is_angular else "1" if self.name == GROWTH else "mm"

    @property
    def words(self) -> tuple[str, ...]:
        """Letters of its amplitudes; one empty word for a single amplitude."""
        return {SHIFT: ("X", "Y", "Z"), TILT: ("A", "B", "C")}.get(self.name, ("",))

    def entries(self, touches: Touches) -> list[tuple[int, Where, Array | float]]:
        """Amplitude, entry and factor of all that it moves."""
        if self.symbol is not None:
            return [(0, touches.chain.twist_of(self.symbol), 1.0)]
        if self.name == BIAS:
            return [(0, Where("bias"), 1.0)]
        if self.name == SHIFT:
            return [(i, Where("shift", 0, i), 1.0) for i in range(3)]
        if self.name.startswith("shift-"):
            return [(0, Where("shift", 0, "xyz".index(self.name[-1])), 1.0)]
        p = touches.point_table
        if self.name == GROWTH:
            return [(0, Where("shift", 0, i), p[:, i]) for i in range(3)]
        arm = p - _centre(touches)
        turned: list[tuple[int, Where, Array | float]] = []
        for turn in range(3):
            a, b = (turn + 1) % 3, (turn + 2) % 3
            turned += [(turn, Where("shift", 0, b), arm[:, a])]
            turned += [(turn, Where("shift", 0, a), -arm[:, b])]
        return turned

    def terms(self, touches: Touches, amounts: Sequence[Array]) -> Sequence[Term]:
        """Every amount, (N,), at all that it moves: amplitudes of one entry after another."""
        m = len(amounts)
        return tuple(
            Term(way * m + k, where, factor * amount)
            for way, where, factor in self.entries(touches)
            for k, amount in enumerate(amounts)
        )

    def columns(self, touches: Touches) -> Array:
        """Deviation along the normal per unit of every amplitude, (N, count)."""
        out = np.zeros((len(touches), self.count))
        for k, where, factor in self.entries(touches):
            out[:, k] += factor * touches.signature.of(where)
        return out


def _centre(touches: Touches) -> Array:
    """Middle of the points of the set-up of every touch, table frame, (N, 3), mm."""
    count = np.maximum(np.bincount(touches.setup, minlength=len(touches.setups)), 1)
    p = touches.point_table
    mean = [np.bincount(touches.setup, p[:, i], len(touches.setups)) / count for i in range(3)]
    return np.stack(mean, axis=1)[touches.setup]


def carrier_of(name: str, chain: Chain) -> Carrier:
    """The carrier of a name; raises UnknownSymbol or UnknownEffect."""
    return Carrier(name) if name in PARTS else Carrier(name, component_symbol(chain, name))
