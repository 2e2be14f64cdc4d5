"""What drove a machine since it was switched on: what lags behind follows all of it."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from matstd.compensation.field import State
from matstd.twin.errors import DesignError
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.record import Touches, at_poses

MAX_MOMENTS = 4000
"""Moments that are kept; then every other one goes, so that old ones stand wider apart."""


@dataclass(frozen=True, eq=False)
class History:
    """States of a machine in their order, the present one last."""

    states: tuple[State, ...] = field(default_factory=tuple)

    def __len__(self) -> int:
        return len(self.states)

    @property
    def now(self) -> State:
        """The present state."""
        return self.states[-1]

    def then(self, state: State) -> "History":
        """The history with one more moment; raises DesignError."""
        if self.states:
            last = self.now
            if not state.time > last.time:
                raise DesignError(f"time {state.time:g} s, expected later than {last.time:g} s")
            if set(state.temperature) != set(last.temperature):
                raise DesignError(
                    f"sensors {', '.join(sorted(state.temperature)) or 'none'}, expected "
                    f"{', '.join(sorted(last.temperature)) or 'none'}"
                )
        states = (*self.states, state)
        return History(states if len(states) <= MAX_MOMENTS else (*states[:-1:2], state))

    def touches(
        self, chain: Chain, q: Array, length: Array | float, approach: Array | None = None
    ) -> Touches:
        """Poses at the present moment, behind a pose at every moment before and now.

        Args:
            q: Readings, (N, A).
            length: Length of the tool, mm.
            approach: Sign of the last motion of every axis, (N, A).

        Returns:
            As many touches as there are moments, then the N.
        """
        n, before = len(q), len(self)
        states = (*self.states, *(self.now,) * n)
        at = at_poses(chain, np.concatenate([np.tile(q[:1], (before, 1)), q]), length)
        ways = np.zeros_like(at.approach)
        if approach is not None:
            ways[before:] = approach
        speeds = [s.spindle_rpm for s in states]
        return replace(
            at,
            time=np.array([s.time for s in states]),
            approach=ways,
            temperature=_columns([s.temperature for s in states]),
            value=_columns([s.value for s in states]),
            spindle_rpm=None if None in speeds else np.array(speeds, dtype=float),
        )


def _columns(rows: list[Mapping[str, float]]) -> dict[str, Array]:
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}
