"""Where the standard really stands on the table: six free numbers for every set-up."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from twin.model import Parameter, Term, Where
from twin.record import Touches
from twin.units import UM

SHIFT_SD = 1000.0 * UM
TURN_SD = 5e-3
"""Expected standard deviations of a set-up, mm and rad: wide, since nobody clamps to a micrometre
and the calibration of a machine must not depend on it."""


@dataclass(frozen=True)
class SetupError:
    """Displacement and rotation of the standard in one set-up, against the stated one.

    ``shift = e + r x (x - c)`` in the table frame, with x the touched point and c the centre. Six
    parameters, mm and rad.

    Attributes:
        setup: Label of the set-up.
        centre: c, table frame, mm: the middle of the touched points, so that displacement and
            rotation are estimated nearly independently.
        turns_only: Whether an instrument that feels angles alone stands there: three parameters.
    """

    setup: str
    centre: tuple[float, float, float]
    turns_only: bool = False

    kind = "setup"

    @property
    def name(self) -> str:
        """`setup(a)`."""
        return f"setup({self.setup})"

    @property
    def parameters(self) -> Sequence[Parameter]:
        """Displacement and rotation in the table frame."""
        shifts = [Parameter(f"d{c}", "mm", SHIFT_SD) for c in "xyz" if not self.turns_only]
        return (*shifts, *(Parameter(f"r{c}", "rad", TURN_SD) for c in "xyz"))

    def terms(self, touches: Touches) -> Sequence[Term]:
        """Shifts of the standard, at the touches of this set-up."""
        names = [s.name for s in touches.setups]
        index = names.index(self.setup) if self.setup in names else -1
        here = (touches.setup == index).astype(float)
        if self.turns_only:
            felt = np.cross(
                touches.point_table - touches.T_table_artefact[:, :3, 3], touches.normal_table
            )
            return [Term(i, Where("bias"), here * felt[:, i]) for i in range(3)]
        arm = (touches.point_table - np.array(self.centre)) * here[:, None]
        terms = [Term(i, Where("shift", 0, i), here) for i in range(3)]
        for turn in range(3):
            a, b = (turn + 1) % 3, (turn + 2) % 3
            terms.append(Term(3 + turn, Where("shift", 0, b), arm[:, a]))
            terms.append(Term(3 + turn, Where("shift", 0, a), -arm[:, b]))
        return terms


def setup_errors(touches: Touches) -> tuple[SetupError, ...]:
    """One for every set-up that was touched."""
    out = []
    for index, setup in enumerate(touches.setups):
        rows = touches.setup == index
        if rows.any():
            x, y, z = touches.point_table[rows].mean(axis=0)
            turns_only = touches.instrument.reads_angle
            out.append(SetupError(setup.name, (float(x), float(y), float(z)), turns_only))
    return tuple(out)
