"""Time left of a command whose stages take known shares of it.

Stages report steps, seldom and unevenly: between two reports the fraction done follows the clock,
up to the end of the stage. The time left that is shown always falls: where the estimate shrinks it
follows, where it grows the clock that is shown runs slower until both agree.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

FIRST = 0.02
"""Fraction done from which on the pace of this run says how long the whole takes."""

WORTH_SHOWING = 0.04
"""Reported fraction from which on a time left is shown: one that began too short cannot grow."""


PATIENCE = 3
"""Power by which a time left that is too short runs slower: at half of the estimate an eighth."""


@dataclass(slots=True)
class TimeLeft:
    """How far a command is, and how long the rest takes."""

    # share of the whole that every stage takes, in their order; they sum up to one
    shares: Mapping[str, float]
    usual: float  # duration of the whole where it was measured, s: the pace before there is one
    begun: float = 0.0  # when the command began, s
    stage: str = ""
    position: float = 0.0
    at: float = 0.0
    shown: float = math.inf
    shown_at: float = 0.0
    _before: dict[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.at = self.shown_at = self.begun
        total = 0.0
        for name, share in self.shares.items():
            self._before[name] = total
            total += share

    def report(self, stage: str, done: int, total: int, now: float) -> None:
        """Take what the work reports; a stage without a share changes nothing."""
        if stage not in self.shares:
            return
        self.stage = stage
        inside = done / total if total > 0 else 0.0
        position = self._before[stage] + self.shares[stage] * min(inside, 1.0)
        if position > self.position:
            self.position, self.at = position, now

    def fraction(self, now: float) -> float:
        """Fraction done, from 0 to 1, which never falls."""
        end = self._before.get(self.stage, 0.0) + self.shares.get(self.stage, 0.0)
        rest = max(end - self.position, 0.0)
        if rest == 0.0:
            return self.position
        is_known = self.position > FIRST
        whole = (self.at - self.begun) / self.position if is_known else self.usual
        # towards the end of the stage, ever slower where it takes longer than its share
        return self.position - rest * math.expm1(-(now - self.at) / max(whole * rest, 1e-9))

    def left(self, now: float) -> float | None:
        """Seconds left, less at every call; None while there is no pace."""
        done = self.fraction(now)
        if self.position < WORTH_SHOWING:
            return None
        estimate = (now - self.begun) * (1.0 - done) / done
        if math.isinf(self.shown):
            self.shown = estimate
        else:  # where the estimate has grown, the shown one waits for it: nearly, but it falls
            ratio = min(self.shown / max(estimate, 1e-9), 1.0)
            self.shown = max(self.shown - (now - self.shown_at) * ratio**PATIENCE, 0.0)
            self.shown = min(self.shown, estimate)
        self.shown_at = now
        return self.shown
