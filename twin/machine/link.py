"""One member of a chain: an axis, the workpiece or the tool."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from matstd.twin.frames import Array, skew
from matstd.twin.machine.symbols import ALONG
from matstd.twin.units import DEG

Kind = Literal["linear", "rotary", "fixed"]

_ALONG = 1e-12  # 1 less the cosine of an angle that is none: 1.4 µrad


@dataclass(frozen=True, slots=True, eq=False)
class Link:
    """One member of the chain: an axis, the workpiece `w` or the tool `t`."""

    name: str  # axis letter with number, `w` or `t`
    kind: Kind  # linear, rotary, or fixed (`w` and `t`, which only carry set-up errors)
    carries_workpiece: bool  # primed axes and `w`
    direction: Array  # positive direction of the *reading* (tool relative to workpiece), unit, (3,)
    # reference point of the angular errors and of a rotary axis's line, machine frame with every
    # axis at zero, (3,), mm
    point: Array
    range: tuple[float, float]  # smallest and largest reading, mm or rad
    # False in brackets: a spindle that is not programmed, a quill that stays in
    programmed: bool = True
    # pitch of a linear axis's screw or scale, mm, as its owner states it; None where it is unknown.
    # It is no part of the kinematics
    pitch: float | None = None
    # size of each translational error of a linear axis, mm, beyond which it is unusual for such an
    # axis; None for that of its class. No part of its kinematics either
    expected: float | None = None
    # a rotary axis whose line is known by how it lies to the lines of its neighbours, in an open
    # chain (`chain.OPEN_CHAIN`); its errors are of a class of their own
    is_joint: bool = False

    @property
    def own(self) -> int:
        """Index in X Y Z of the letter's own direction, whatever the direction of the axis."""
        return "XYZ".index(ALONG[self.name[0]])

    @property
    def points_along_letter(self) -> bool:
        """Whether the axis moves along, or turns about, the direction of its letter."""
        return bool(np.allclose(self.direction, np.eye(3)[self.own], atol=1e-12))

    @property
    def sense(self) -> float:
        """1, or -1 where the reading runs against the direction of the letter."""
        return -1.0 if self.kind != "fixed" and self.direction[self.own] < 0.0 else 1.0

    @property
    def is_along_letter(self) -> bool:
        """Whether errors have the directions of the machine; so do those of workpiece and tool."""
        return self.kind == "fixed" or 1.0 - float(self.direction[self.own]) < _ALONG

    @property
    def frame(self) -> Array:
        """Directions of the errors X, Y, Z of the axis as columns, machine frame, (3, 3).

        The error of the axis's own letter is along, or about, its direction, whatever that is. The
        others have the directions of the machine, turned by the smallest rotation that lays the
        letter on the line of the axis: about X by 45 degrees for a table B that swivels about
        (0, 1, 1). An axis against its letter has the others unturned.
        """
        if self.is_along_letter:
            return np.eye(3)
        line, letter = self.sense * self.direction, np.eye(3)[self.own]
        S = skew(np.cross(letter, line))
        out = np.eye(3) + S + S @ S / (1.0 + letter @ line)
        out[:, self.own] = self.direction
        return np.asarray(out)

    def in_machine(self, six: Array) -> Array:
        """Errors X Y Z A B C in the frame of the axis, (..., 6), in directions of the machine."""
        return six if self.is_along_letter else _turned(six, self.frame.T)

    def in_frame(self, six: Array) -> Array:
        """The same the other way."""
        return six if self.is_along_letter else _turned(six, self.frame)

    @property
    def unit(self) -> float:
        """The unit in which files and messages give its readings: 1 mm or 1 degree, base units."""
        return DEG if self.kind == "rotary" else 1.0

    @property
    def column(self) -> str:
        """Column of its readings in a run, pose or result file: `X_mm`, `B_deg`."""
        return f"{self.name}_{'deg' if self.kind == 'rotary' else 'mm'}"

    def scaled(self, reading: Array) -> Array:
        """Readings scaled to [-1, 1] over the range, in any shape."""
        low, high = self.range
        return (2.0 * reading - (low + high)) / (high - low)

    @property
    def own_component(self) -> int:
        """Index in X Y Z A B C of the error along a linear axis, about a rotary one."""
        return self.own if self.kind == "linear" else 3 + self.own


def _turned(six: Array, R: Array) -> Array:
    """Displacements and rotations (..., 6) times a matrix from the right."""
    return np.asarray((np.reshape(six, (*six.shape[:-1], 2, 3)) @ R).reshape(six.shape))
