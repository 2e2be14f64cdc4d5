"""Program coordinates and readings of a machine: where the program's zero stands."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from matstd.compensation.field import Datum
from matstd.twin.errors import NotReachable
from matstd.twin.frames import Array
from matstd.twin.machine import Chain, inverse_linear, tip


@dataclass(frozen=True, eq=False)
class Frame:
    """A program on a machine.

    Without tool-point control coordinates are readings less those at the zero, whatever the rotary
    axes do; the control takes up the length of the tool. With it they are those of the tool point
    in the table frame, from the zero.
    """

    chain: Chain  # the machine; three linear axes
    datum: Datum  # readings at which the tool point of its tool stands at the program's zero

    @cached_property
    def zero(self) -> Array:
        """The program's zero in the table frame, (3,), mm."""
        return tip(self.chain, self.datum.zero[None, :], self.datum.length)[0]

    @cached_property
    def linear(self) -> list[int]:
        """Columns of X, Y and Z; raises NotReachable where the linear axes are others."""
        if sorted(self.chain.linear_axes) != ["X", "Y", "Z"]:
            shown = ", ".join(self.chain.linear_axes)
            raise NotReachable(f"machine {self.chain.name} moves {shown}; programs need X, Y, Z")
        return [self.chain.axis_index(a) for a in "XYZ"]

    def at_zero(self, length: float) -> Array:
        """Readings at the zero with a tool of that length, rotary axes as at the datum, (A,)."""
        q = inverse_linear(self.chain, self.zero[None, :], self.datum.zero[None, :], length)[0]
        q[[k for k in range(len(q)) if k not in self.linear]] = 0.0
        return q

    def readings(self, at: Array, tcpm: bool, length: float) -> Array:
        """Readings of program coordinates, (N, A), mm and rad."""
        if not tcpm:
            return np.asarray(at + self.at_zero(length))
        return inverse_linear(self.chain, self.zero + at[:, self.linear], at, length)

    def coordinates(self, q: Array, tcpm: bool, length: float) -> Array:
        """Program coordinates of readings, (N, A), mm and rad; inverse of `readings`."""
        if not tcpm:
            return np.asarray(q - self.at_zero(length))
        out = q.copy()
        out[:, self.linear] = tip(self.chain, q, length) - self.zero
        return out
