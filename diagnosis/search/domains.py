"""Blocks of a domain left out: parts of the time, set-ups.

A pose that is left out has neighbours in time that were touched with the same sensors at nearly the
same temperatures. What merely follows a slow unknown between them predicts a pose, and fails where
an hour, or a set-up, is left out as a whole.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from matstd.diagnosis.evidence import EffectSet, ResidualSpace
from matstd.twin.record import IntArray

PARTS_OF_TIME = 5
"""Stretches of time that are left out in turn; a law of warming up is seen in one of them."""

MIN_ROWS = 4
"""Touches that a block must leave out to be a test."""


def domain_gain(others: EffectSet, whole: EffectSet) -> float:
    """Least gain of the log predictive density by what a set has more, over the domains."""
    gains = []
    for groups in domain_blocks(whole.complement):
        after, before = (
            EffectSet(replace(whole.complement, groups=groups), one.A).held_out_log_density
            for one in (whole, others)
        )
        gains.append(after - before)
    return min(gains, default=np.inf)


def domain_blocks(space: ResidualSpace) -> Iterator[tuple[IntArray, ...]]:
    """Rows of the fit, by numbers within it, of the blocks of every domain."""
    yield by_time(space)
    setup = space.touches.setup[space.used]
    blocks = tuple(np.flatnonzero(setup == k) for k in np.unique(setup))
    if len(blocks) > 1 and min(map(len, blocks)) >= MIN_ROWS:
        yield blocks


def by_time(space: ResidualSpace) -> tuple[IntArray, ...]:
    """Stretches of time."""
    order = np.argsort(space.touches.time[space.used], kind="stable")
    return tuple(np.array_split(order, PARTS_OF_TIME))
