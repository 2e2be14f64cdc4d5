"""The sum of all effects at some touches; nothing downstream depends on which effect it was."""

from typing import Literal, NamedTuple

import numpy as np

from matstd.twin.frames import Array

Part = Literal["twist", "place", "shift", "bias"]


class Where(NamedTuple):
    """One entry of a contribution: the part, the link (0 for shift, bias) and the component."""

    part: Part
    link: int = 0
    component: int = 0

    @property
    def moves_tip(self) -> bool:
        """Whether the tip moves; a shift moves the standard, a bias only what is measured."""
        return self.part in ("twist", "place")

    @property
    def entry(self) -> tuple[slice | int, ...]:
        """Index of this entry in the array of its part, over all touches."""
        if self.moves_tip:
            return (slice(None), self.link, self.component)
        return (slice(None), self.component) if self.part == "shift" else (slice(None),)

    @property
    def is_angular(self) -> bool:
        """Whether the entry is an angle (rad) rather than a length (mm)."""
        return self.component >= 3


class Contribution(NamedTuple):
    """What effects add at N touches; contributions of several effects add up."""

    # component errors of each link, tool side minus workpiece side, X Y Z A B C, (N, L, 6), mm and
    # rad
    twist: Array
    # displacement of each axis's line, of the workpiece `w` and of the tool `t`, (N, L, 6), mm and
    # rad; along an axis's own direction it is its zero position
    place: Array
    shift: Array  # of the standard in the table frame, (N, 3), mm
    bias: Array  # of the measured surface along its outward normal, (N,), mm

    @classmethod
    def zeros(cls, n: int, links: int) -> "Contribution":
        """Nothing disturbed at n touches of a machine with that many links.

        In memory the touches of one entry lie side by side, since entries are what is added to.
        """
        twist, place = (np.moveaxis(np.zeros((links, 6, n)), -1, 0) for _ in range(2))
        return cls(twist, place, np.zeros((n, 3)), np.zeros(n))

    def add(self, where: Where, amount: Array) -> None:
        """Add an amount (N,) to one entry, in place."""
        getattr(self, where.part)[where.entry] += amount
