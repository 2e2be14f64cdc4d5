"""Everything that disturbs a measurement ends here; nothing downstream asks which effect it was."""

from typing import NamedTuple

import numpy as np

from twin.frames import Array


class Contribution(NamedTuple):
    """What effects add at N touches; contributions of several effects add up.

    Attributes:
        twist: Component errors of each link, tool side minus workpiece side, X Y Z A B C,
            (N, L, 6), mm and rad.
        place: Displacement of each axis's line, of the workpiece `w` and of the tool `t`,
            (N, L, 6), mm and rad; along an axis's own direction it is its zero position.
        shift: Of the standard in the table frame, (N, 3), mm.
        bias: Of the measured surface along its outward normal, (N,), mm.
    """

    twist: Array
    place: Array
    shift: Array
    bias: Array

    @classmethod
    def zeros(cls, n: int, links: int) -> "Contribution":
        """Nothing disturbed at n touches of a machine with that many links."""
        return cls(np.zeros((n, links, 6)), np.zeros((n, links, 6)), np.zeros((n, 3)), np.zeros(n))
