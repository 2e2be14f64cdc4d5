"""Sets of effects, and the tests that every member of a set must pass.

A member stands if chance, its freedom and what it predicts speak for it, with all the others in
place. What it predicts is asked three ways: of poses that were left out; of every instant as one
observation, since x, y and z of a reflector share whatever the machine did in that pose; and of
whole parts of the time and whole set-ups. A pose that is left out has neighbours that were touched
with the same sensors at nearly the same temperatures: what merely follows a slow unknown between
them predicts a pose, and fails where an hour is left out as a whole.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.diagnosis.accuracy import domains
from matstd.diagnosis.evidence import EffectSet, ResidualSpace, ScaledEffect, Signatures
from matstd.diagnosis.policy import POLICY
from matstd.diagnosis.regression import f_tail
from matstd.diagnosis.search.missing_driver import is_unrecorded
from matstd.twin.frames import Array
from matstd.twin.model import Effect, is_tunable
from matstd.twin.record import IntArray

LEFT_OUT = ("time_s", "setup")
"""Domains of which blocks are left out: an effect may act in one half of a travel alone."""

MIN_SHARED_ROWS = 0.5
"""Share of rows with the instant and readings of the row before, from which rows of an instant are
grouped."""


@dataclass(frozen=True, slots=True, eq=False)
class Member:
    """An effect in a set, on a point of its grid or between two.

    Attributes:
        signature: Of this effect alone, with the tries of its grid.
        scale: Factor on its usual size.
    """

    signature: Signatures
    scale: float

    @property
    def effect(self) -> Effect:
        """The effect itself."""
        return self.signature.variants[0]

    @property
    def sized(self) -> ScaledEffect:
        """The effect with its size."""
        return ScaledEffect(self.effect, self.scale)

    @property
    def key(self) -> tuple[str | float, ...]:
        """Name, inner parameters and scale."""
        inner = self.effect.tuning.values() if is_tunable(self.effect) else ()
        return (self.effect.name, *inner, self.scale)


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

    @property
    def sized(self) -> tuple[ScaledEffect, ...]:
        """Its effects with their sizes."""
        return tuple(m.sized for m in self.members)

    @property
    def names(self) -> frozenset[str]:
        """Names of its effects."""
        return frozenset(m.effect.name for m in self.members)

    def others(self, *gone: Member) -> tuple[Member, ...]:
        """All members but some."""
        return tuple(m for m in self.members if not any(m is g for g in gone))


@dataclass(frozen=True, slots=True, eq=False)
class Verified:
    """Tests of one member with all the others in place; a later one is 0 where an earlier fails.

    Attributes:
        p_value: Probability by chance, corrected for grid and number of candidates.
        evidence: Gain of log evidence by it.
        held_out: Held-out error with it over that without it.
        density: Gain of the held-out log predictive density by it.
        touches: Effective number it explains, ``(sum d^2)^2 / sum d^4`` of what it changes.
        domain_density: Least gain of the log predictive density over domains of which blocks are
            left out (parts of the time, set-ups).
        is_possible: Whether no coefficient of expansion is of a body that shrinks when it warms,
            and no driver that was not recorded is more likely.
    """

    member: Member
    p_value: float
    evidence: float
    held_out: float = 0.0
    density: float = 0.0
    touches: float = 0.0
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
            self.is_beyond_chance
            and self.held_out < 1.0
            and self.density > POLICY.log_evidence_gain
            and self.touches > POLICY.touches_explained
        )

    @property
    def is_beyond_chance(self) -> bool:
        """Whether it explains more than noise and its own freedom would."""
        return self.p_value < POLICY.false_alarm and self.evidence > POLICY.log_evidence_gain


def tested(others: EffectSet, whole: EffectSet, quick: Verified) -> Verified:
    """The tests of a member that is beyond chance: what it predicts.

    Args:
        others: The set without it.
        whole: The set with it.
        quick: Its probability and evidence.
    """
    count = len(whole.complement.u)
    changed = (others.residual - whole.residual)[:count] ** 2
    found = replace(
        quick,
        held_out=whole.held_out.rms / max(others.held_out.rms, 1e-300),
        density=float(whole.held_out_log_density - others.held_out_log_density),
        touches=float(changed.sum()) ** 2 / max(float(changed @ changed), 1e-300),
    )
    if not found.stands_by_poses:
        return found
    known = domains(whole.complement.touches, whole.complement.used)
    gains = [
        by_blocks(whole, blocks).held_out_log_density
        - by_blocks(others, blocks).held_out_log_density
        for blocks in (known[name] for name in LEFT_OUT if name in known)
    ]
    return replace(found, domain_density=min(gains, default=found.density))


def by_blocks(effects: EffectSet, groups: tuple[IntArray, ...]) -> EffectSet:
    """The set with other rows held out together."""
    return EffectSet(replace(effects.complement, groups=groups), effects.A)


def p_by_instants(others: EffectSet, whole: EffectSet) -> float:
    """Probability by chance of what an effect explains, one variant, no correction; 0 for no say.

    ``F = g^T G^-1 g / tr(G^-1 V)`` of k and M - k degrees of freedom, with D the columns beside the
    others, ``G = D^T D``, ``g = D^T r``, and V the sum over M instants of the squares of
    ``D_m^T e_m``, e the errors of what was held out. Only where every instant is held out by
    itself: stretches of a log that are held out as a whole say how far an effect reaches.

    Reference:
        Liang and Zeger, Biometrika 73 (1986) 13-22 (estimates of variance from clusters).
    """
    space = whole.complement
    q, t = space.touches.q[space.used], space.touches.time[space.used]
    begins = np.r_[True, np.any(np.diff(q, axis=0) != 0.0, axis=1) | (np.diff(t) != 0.0)]
    first = np.flatnonzero(begins)
    added = whole.A.shape[1] - others.A.shape[1]
    freedom = len(first) - added
    is_shared = len(first) <= (1.0 - MIN_SHARED_ROWS) * len(q)
    if not is_shared or freedom < 1 or len(first) > len(space.groups):
        return 0.0
    D = whole.A - others.A @ others.coefficients(whole.A) if others.A.shape[1] else whole.A
    error = whole.held_out.error
    each = np.add.reduceat(D[: len(error)] * error[:, None], first, axis=0)
    inverse = np.linalg.pinv(D.T @ D, rcond=1e-9, hermitian=True)  # of the others nothing is left
    g = D.T @ others.residual
    explained = float(g @ inverse @ g)
    scatter = float(np.einsum("mi,ij,mj->", each, inverse, each))
    return float(f_tail(explained / max(scatter, 1e-300), added, freedom))


def single(pool: Signatures, variant: int) -> Signatures:
    """Signature of one variant of a pool."""
    columns, owner = slice(pool.start[variant], pool.start[variant + 1]), pool.owner[variant]
    return replace(
        pool,
        variants=(pool.variants[variant],),
        owner=np.zeros(1, dtype=np.int64),
        names=(pool.names[owner],),
        C=pool.C[:, columns],
        start=np.array([0, columns.stop - columns.start]),
        size=pool.size[columns],
        tries=pool.tries[[owner]],
    )


def set_of(complement: ResidualSpace, members: Sequence[Member], fixed: Array | None) -> EffectSet:
    """Set of members, with further fixed columns beside them."""
    blocks = [] if fixed is None else [fixed]
    blocks += [m.scale * m.signature.C for m in members]
    rows = len(complement.residual)
    return EffectSet(complement, np.hstack(blocks) if blocks else np.zeros((rows, 0)))


def explained(others: EffectSet, columns: Array) -> Array:
    """Direction of what columns (N + P, K) would explain beyond a set, (N + P,), of length 1."""
    whole = EffectSet(others.complement, np.hstack([others.A, columns]))
    difference = others.residual - whole.residual
    return np.asarray(difference / max(float(np.linalg.norm(difference)), 1e-300))
