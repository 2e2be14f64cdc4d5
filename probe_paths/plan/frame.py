"""Axis readings and programmed coordinates: what the preset and the tool table stand between.

The preset stands at the origin of the table frame with every rotary axis at zero. Where neither a
tilted plane nor tool-point control is active the control shows readings minus the preset's, and Z
belongs to the far pole of the ball:

    X_prog = X - x0,  Y_prog = Y - y0,  Z_prog = Z - (length + radius) - z0,  rotary axes as read.

In a plane that is tilted by R, square to the tool, it shows R^T p of the pole p in the table frame:
on a machine whose tool does not turn the same with other constants (`ProgramFrame.tilted`).
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from matstd.artefact.tool import Probe
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array, fixed_xyz
from matstd.twin.machine import Chain, linear_directions, table_to_tool, tip
from matstd.twin.units import DEG

LINEAR = "XYZ"

_PARALLEL = 1e-9  # largest angle between an axis of a tilted plane and one of the machine, rad
_WORD = 1e-4  # last digit of the words of linear axes, mm
_SAME = 1e-3  # part of that digit that floating-point numbers may lack


@dataclass(frozen=True, eq=False)
class ProgramFrame:
    """Converts between axis readings and the words of a program.

    Raises:
        DesignError: A machine whose axes the programs cannot name.
    """

    chain: Chain
    probe: Probe
    shift: tuple[float, float, float] = (0.0, 0.0, 0.0)  # shift of a tilted plane, mm

    def __post_init__(self) -> None:
        chain = self.chain
        if sorted(chain.linear_axes) != sorted(LINEAR):
            found = f"machine {chain.name} has linear axes {', '.join(chain.linear_axes) or 'none'}"
            raise DesignError(f"{found}; a probing program needs exactly X, Y and Z")
        for name in LINEAR:
            if not chain.link(name).points_along_letter:
                found = f"axis {name} of {chain.name} does not point along its letter"
                raise DesignError(f"{found}; programs without a tilted plane need that")
        if any(len(name) > 1 for name in chain.rotary_axes) or len(chain.rotary_axes) > 2:
            found = f"rotary axes {', '.join(chain.rotary_axes)} of {chain.name}"
            raise DesignError(f"{found}: expected at most two, named A, B or C")

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
        return self.chain.rotary_columns

    def whole(self, z: float) -> float:
        """Z at the next whole millimetre in the program: an operator reads it at a glance."""
        return self.reading("Z", np.ceil(self.coordinate("Z", z)))

    def _offset(self, letter: str) -> float:
        i = LINEAR.index(letter)
        pole = self.probe.tool_length if letter == "Z" else 0.0
        return float(self.chain.table_origin[i]) + pole + self.shift[i]

    def tilted(self, rotary: Array) -> "ProgramFrame":
        """The same in the plane that is square to the tool at rotary readings (R,), rad.

        Raises:
            DesignError: A machine that turns the tool: its planes are not along its axes.
        """
        q = self._at(rotary)
        turn = table_to_tool(self.chain, q)[0, :3, :3]
        along = turn.T @ linear_directions(self.chain, q)[0]
        order = [self.chain.linear_axes.index(name) for name in LINEAR]
        if np.abs(along[:, order] - np.eye(3)).max() > _PARALLEL:
            raise DesignError(
                f"machine {self.chain.name} turns its tool: expected one whose rotary axes carry "
                "the workpiece for PLANE SPATIAL"
            )
        pole = turn.T @ tip(self.chain, q, self.probe.tool_length)[0]
        flat = replace(self, shift=(0.0, 0.0, 0.0))
        x, y, z = (flat.coordinate(a, 0.0) - float(v) for a, v in zip(LINEAR, pole, strict=True))
        return replace(self, shift=(x, y, z))

    def plane(self, rotary: Array) -> Array:
        """Spatial angles of that plane, SPA, SPB, SPC, degrees: about fixed X, then Y, then Z.

        Of the two triples that mean the same plane the one with the smaller SPA.
        """
        R = table_to_tool(self.chain, self._at(rotary))[0, :3, :3]
        y = -np.arcsin(np.clip(R[2, 0], -1.0, 1.0))
        if np.cos(y) < _PARALLEL:  # X and Z turn about the same line
            angles = np.array([0.0, y, np.arctan2(-R[0, 1], R[1, 1])])
        else:
            angles = np.array([np.arctan2(R[2, 1], R[2, 2]), y, np.arctan2(R[1, 0], R[0, 0])])
        other = np.array([angles[0] + np.pi, np.pi - y, angles[2] + np.pi])
        other = other - 2.0 * np.pi * np.round(other / (2.0 * np.pi))
        if abs(other[0]) < abs(angles[0]) - _PARALLEL:
            angles = other
        return np.asarray(angles / DEG)

    def is_plane(self, angles: Array, rotary: Array) -> bool:
        """Whether spatial angles (3,), degrees, are those of the tool, to their digits."""
        R = table_to_tool(self.chain, self._at(rotary))[0, :3, :3]
        return bool(np.abs(fixed_xyz(angles * DEG) - R).max() < 1e-4 * DEG)

    def _at(self, rotary: Array) -> Array:
        q = np.zeros((1, len(self.chain.axes)))
        q[0, self.rotary] = rotary
        return q

    def coordinate(self, letter: str, reading: float) -> float:
        """Programmed word of a reading: mm, or degrees for a rotary axis."""
        return reading - self._offset(letter) if letter in LINEAR else reading / DEG

    def height(self, z: float, top: float) -> float:
        """Programmed word of a reading of Z that leads no higher than the reading `top`, mm.

        In a plane the word of `top` has more digits than a program states: it is rounded down.
        """
        highest = np.floor(self.coordinate("Z", top) / _WORD + _SAME) * _WORD
        return min(self.coordinate("Z", z), float(highest))

    def reading(self, letter: str, coordinate: float) -> float:
        """Reading of a programmed word, mm or rad."""
        return coordinate + self._offset(letter) if letter in LINEAR else coordinate * DEG

    def coordinates(self, q: Array, letters: tuple[str, ...] | str) -> dict[str, float]:
        """Programmed words of some axes of one row of readings (A,)."""
        return {a: self.coordinate(a, float(q[self.chain.axis_index(a)])) for a in letters}
