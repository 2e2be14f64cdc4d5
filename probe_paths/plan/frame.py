"""Axis readings and programmed coordinates: what the preset and the tool table stand between.

The preset stands at the origin of the table frame with every rotary axis at zero, and neither a
tilted plane nor tool-point control is active. Then the control shows readings minus the preset's,
and Z belongs to the far pole of the ball:

    X_prog = X - x0,  Y_prog = Y - y0,  Z_prog = Z - (length + radius) - z0,  rotary axes as read.
"""

from dataclasses import dataclass
from functools import cached_property

from probe_paths.plan.probe import Probe
from twin.errors import DesignError
from twin.frames import Array
from twin.machine import Chain
from twin.units import DEG

LINEAR = "XYZ"


@dataclass(frozen=True, eq=False)
class ProgramFrame:
    """Converts between axis readings and the words of a program.

    Attributes:
        probe: In the spindle; its length in the tool table.

    Raises:
        DesignError: A machine whose axes the programs cannot name.
    """

    chain: Chain
    probe: Probe

    def __post_init__(self) -> None:
        chain = self.chain
        if sorted(chain.linear_axes) != sorted(LINEAR):
            raise DesignError(
                f"machine {chain.name} has linear axes {', '.join(chain.linear_axes) or 'none'}; "
                "a probing program needs exactly X, Y and Z"
            )
        for name in LINEAR:
            if not chain.link(name).points_along_letter:
                raise DesignError(
                    f"axis {name} of {chain.name} does not point along its letter; "
                    "programs without a tilted plane need that"
                )
        if any(len(name) > 1 for name in chain.rotary_axes) or len(chain.rotary_axes) > 2:
            raise DesignError(
                f"rotary axes {', '.join(chain.rotary_axes)} of {chain.name}: "
                "expected at most two, named A, B or C"
            )

    @cached_property
    def letters(self) -> tuple[str, ...]:
        """Axes that a program names: X Y Z, then the rotary axes in chain order."""
        return (*LINEAR, *self.chain.rotary_axes)

    @cached_property
    def linear(self) -> list[int]:
        """Columns of X, Y, Z in arrays of readings."""
        return [self.chain.axis_index(name) for name in LINEAR]

    @cached_property
    def rotary(self) -> list[int]:
        """Columns of the rotary axes in arrays of readings."""
        return [self.chain.axis_index(name) for name in self.chain.rotary_axes]

    def _offset(self, letter: str) -> float:
        i = LINEAR.index(letter)
        return float(self.chain.table_origin[i]) + (self.probe.tool_length if letter == "Z" else 0)

    def coordinate(self, letter: str, reading: float) -> float:
        """Programmed word of a reading: mm, or degrees for a rotary axis."""
        return reading - self._offset(letter) if letter in LINEAR else reading / DEG

    def reading(self, letter: str, coordinate: float) -> float:
        """Reading of a programmed word, mm or rad."""
        return coordinate + self._offset(letter) if letter in LINEAR else coordinate * DEG

    def coordinates(self, q: Array, letters: tuple[str, ...] | str) -> dict[str, float]:
        """Programmed words of some axes of one row of readings (A,)."""
        return {a: self.coordinate(a, float(q[self.chain.axis_index(a)])) for a in letters}
