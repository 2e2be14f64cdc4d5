"""Certified efficiency of a choice of touches.

The efficiency is the bound of `matstd.information.selection.relaxation` over the criterion of the
choice; the fractions of `matstd.information.selection.relaxation` make the bound tight, their
heaviest touches a good start for exchanges.
"""

from dataclasses import dataclass

from matstd.information.criteria import DesignCriterion
from matstd.information.selection.shares import heaviest
from matstd.information.selection.touch_selection import Quota, Selection, exchange
from matstd.twin.frames import Array


@dataclass(frozen=True)
class Certificate:
    """Bound on the distance of a choice from the best one."""

    candidates: int  # touches that could have been chosen
    count: int  # touches that were
    value: float  # criterion of the choice
    bound: float  # no other choice of as many of the candidates has a smaller one
    shares: bool  # whether other choices have to keep the same shares of poses and features

    @property
    def efficiency(self) -> float:
        """Lower bound of the efficiency, 0 to 1."""
        return self.bound / self.value

    def __str__(self) -> str:
        same = " under the same shares" if self.shares else ""
        return (
            f"{self.count} of {self.candidates} candidate touches: at least "
            f"{100 * self.efficiency:.1f} % as good as any choice of as many{same}"
        )


def rounded(
    criterion: DesignCriterion,
    W: Array,
    weight: Array,
    count: int,
    most: int = 300,
    quotas: tuple[Quota, ...] = (),
) -> Selection:
    """A choice of whole touches from fractions (N,) of candidates (N, R); raises DesignError.

    The heaviest, then exchanged until none helps.
    """
    selection = Selection(criterion, W, heaviest(weight, count, quotas))
    exchange(selection, quotas, most=most)
    return selection
