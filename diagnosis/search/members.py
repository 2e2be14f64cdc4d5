"""Sets of effects, and the tests that every member of a set must pass.

A member stands if chance, its freedom and what it predicts speak for it, with all the others in
place. What it predicts is asked of whole parts of the time and of whole set-ups. A pose that is
left out would be no test: it has neighbours that were touched with the same sensors at nearly the
same temperatures, and what merely follows a slow unknown between them predicts it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from matstd.diagnosis.accuracy import domains
from matstd.diagnosis.evidence import EffectSet, ResidualSpace, ScaledEffect, Signatures
from matstd.diagnosis.policy import POLICY
from matstd.twin.frames import Array, IntArray
from matstd.twin.model import Effect, is_tunable

LEFT_OUT = ("time_s", "setup")
"""Domains of which blocks are left out: an effect may act in one half of a travel alone."""


@dataclass(frozen=True, slots=True, eq=False)
class Member:
    """An effect in a set, on a point of its grid or between two."""

    signature: Signatures  # of this effect alone, with the tries of its grid
    scale: float  # factor on its usual size

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
    """A set of effects with what it explains in the projection."""

    members: tuple[Member, ...]
    effects: EffectSet
    prior: float  # log prior of its members together

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
    """Tests of one member with all the others in place."""

    member: Member
    p_value: float  # probability by chance, corrected for grid and number of candidates
    evidence: float  # gain of log evidence by it
    # whether it is beyond chance, explains more than an accident and predicts what was left out;
    # what stands for a driver that was not recorded need not predict
    stands: bool


def is_general(others: EffectSet, whole: EffectSet) -> bool:
    """Whether a member explains more than an accident, and predicts what was left out.

    Args:
        others: The set without it.
        whole: The set with it.
    """
    changed = (others.residual - whole.residual)[: len(whole.complement.u)] ** 2
    touches = float(changed.sum()) ** 2 / max(float(changed @ changed), 1e-300)
    known = domains(whole.complement.touches, whole.complement.used)
    parts = [known[name] for name in LEFT_OUT if name in known] or [whole.complement.groups]
    return touches > POLICY.touches_explained and all(
        by_blocks(whole, blocks).held_out_log_density
        > by_blocks(others, blocks).held_out_log_density
        for blocks in parts
    )


def by_blocks(effects: EffectSet, groups: tuple[IntArray, ...]) -> EffectSet:
    """The set with other rows held out together."""
    return EffectSet(replace(effects.complement, groups=groups), effects.A)


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
