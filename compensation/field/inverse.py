"""Readings that bring the tool point where it should be, by the inverse of the exact twin."""

from dataclasses import dataclass, replace

import numpy as np

from matstd.compensation.field.machine_errors import (
    Disturbance,
    MachineErrors,
    actual_tip,
    deviation,
)
from matstd.twin.errors import NotReachable
from matstd.twin.frames import Array
from matstd.twin.machine import Chain, linear_directions, tip
from matstd.twin.record import Touches
from matstd.twin.units import NM

MAX_INVERSE_STEPS = 6
"""Most steps of the inverse. Each reduces the error to some 1e-4, so two or three are enough."""

SETTLED_STEP = 2.0 * NM
"""Last step of the inverse, mm; the next one would be about a thousandth of it."""


@dataclass(frozen=True, eq=False)
class Datum:
    """The pose to which all figures refer: a preset taken there stays what it was."""

    q: Array  # readings, (A,)
    length: float  # length of the tool, mm
    # what the program's zero lies beyond them, out of the travels, (A,), mm
    beyond: Array | float = 0.0

    @property
    def zero(self) -> Array:
        """Readings of the program's zero, (A,); no axis needs to reach them."""
        return np.asarray(self.q + self.beyond)

    def touches(self, errors: MachineErrors) -> Touches:
        """The pose as a record of one row, in the state of some errors."""
        return errors.touches(self.q[None, :], self.length)

    def deviation(self, errors: MachineErrors) -> Array:
        """Deviation of the tool point there, (3,), mm: the preset has taken it up."""
        return deviation(errors, self.touches(errors))[0]


def correction(
    disturbance: Disturbance, touches: Touches, aim: Array | None = None, start: Array | None = None
) -> Array:
    """Readings to be added to the linear axes so that the tool point is right.

    Solves ``tip_actual(q + correction) = tip_nominal(q) + aim`` by steps with the directions of the
    linear axes. Rotary readings are kept, so an angle of the tool stays as wrong as it is. With
    fewer than three linear axes only what they can move is corrected.

    Args:
        aim: Deviation that is wanted, (3,) or (N, 3), mm: that of the datum.

        start: What is added already, (N, A), such as corrections of rotary axes.

    Returns:
        Shape (N, A), mm and rad; `start` in the columns of rotary axes.

    Raises:
        NotReachable: The steps do not close: the errors are too large for a machine.
    """
    chain, length = disturbance.chain, touches.target
    columns = np.array(chain.linear_columns, dtype=np.int64)  # empty without linear axes
    wanted = tip(chain, touches.q, length) + (0.0 if aim is None else aim)
    across = np.linalg.pinv(linear_directions(chain, touches.q))  # (N, M, 3)
    out = np.zeros_like(touches.q) if start is None else start.copy()
    rows = np.arange(len(out))
    for _ in range(MAX_INVERSE_STEPS):
        left = actual_tip(disturbance, shifted(touches[rows], out[rows])) - wanted[rows]
        step = np.einsum("nmi,ni->nm", across[rows], left)
        out[np.ix_(rows, columns)] -= step
        rows = rows[np.abs(step).max(axis=1, initial=0.0) > SETTLED_STEP]
        if not len(rows):
            return out
    raise NotReachable(f"the correction does not close on machine {chain.name}: errors too large")


def shifted(touches: Touches, added: Array) -> Touches:
    """The same poses with something added to their readings, (N, A)."""
    return replace(touches, q=touches.q + added)


def deviation_after(errors: Disturbance, touches: Touches, added: Array) -> Array:
    """Actual tool point less where the commanded readings put it, (N, 3), mm.

    Args:
        added: Readings that the compensation adds, (N, A).
    """
    chain = errors.chain
    actual = actual_tip(errors, shifted(touches, added))
    return actual - tip(chain, touches.q, touches.target)


def datum_of(chain: Chain, stated: dict[str, float], length: float) -> Datum:
    """Datum at stated readings, or at the next that an axis reaches: of zero where none is stated.

    Errors beyond a travel do not exist; a program's zero there does.
    """
    q = np.array([float(np.clip(stated.get(a, 0.0), *chain.link(a).range)) for a in chain.axes])
    zero = np.array([stated.get(a, at) for a, at in zip(chain.axes, q.tolist(), strict=True)])
    return Datum(q, length, zero - q)
