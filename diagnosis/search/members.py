"""Sets of effects of one pool, and the tests of each member."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from matstd.diagnosis.evidence import EffectSet, ResidualSpace, Signatures
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.search.missing_driver import is_unrecorded
from matstd.twin.frames import Array
from matstd.twin.model import Effect


@dataclass(frozen=True, slots=True, eq=False)
class Member:
    """An effect in a set, at one point of its grid."""

    variant: int
    candidate: int
    effect: Effect
    scale: float


@dataclass(frozen=True, slots=True, eq=False)
class EffectSubset:
    """A set of effects with what it explains in the projection.

    Attributes:
        prior: Log prior of its members together.
    """

    members: tuple[Member, ...]
    effects: EffectSet
    prior: float

    @property
    def evidence(self) -> float:
        """Log evidence with what was believed of the members."""
        return self.effects.evidence + self.prior


@dataclass(frozen=True, slots=True, eq=False)
class Verified:
    """Tests of one member with all the others in place.

    Attributes:
        p_value: Probability by chance, corrected for grid and number of candidates.
        held_out: Held-out error with it over that without it.
        density: Gain of the held-out log predictive density by it.
        touches: Effective number it explains, ``(sum d^2)^2 / sum d^4`` of what it changes.
        domain_density: Least gain of the log predictive density over domains of which blocks are
            left out (parts of the time, set-ups); 0 where an earlier test fails already.
        is_possible: Whether no coefficient of expansion is of a body that shrinks when it warms,
            and no driver that was not recorded is more likely.
    """

    member: Member
    p_value: float
    evidence: float
    held_out: float
    density: float
    touches: float
    domain_density: float = 0.0
    is_possible: bool = True

    @property
    def stands(self) -> bool:
        """Whether all tests are passed."""
        if is_unrecorded(self.member.effect):  # it predicts nothing, so no other hour either
            return self.stands_by_poses
        return self.stands_by_poses and self.is_possible and self.domain_density > 0.0

    @property
    def stands_by_poses(self) -> bool:
        """Whether the tests are passed that leave out one pose at a time."""
        return (
            self.p_value < POLICY.false_alarm
            and self.evidence > POLICY.log_evidence_gain
            and self.held_out < 1.0
            and self.density > POLICY.log_evidence_gain
            and self.touches > POLICY.touches_explained
        )


def effect_set(
    complement: ResidualSpace,
    pool: Signatures,
    members: Sequence[Member],
    fixed: Array | None = None,
) -> EffectSet:
    """Set of members of a pool, with further fixed columns beside them."""
    blocks = [] if fixed is None else [fixed]
    blocks += [m.scale * pool.columns_of(m.variant) for m in members]
    rows = len(complement.residual)
    return EffectSet(complement, np.hstack(blocks) if blocks else np.zeros((rows, 0)))
