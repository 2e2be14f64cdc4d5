"""The state in which a machine is compensated: time since switching on, temperatures, speed."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.record import Touches, at_poses


@dataclass(frozen=True, slots=True)
class State:
    """Everything but the readings that drives the effects of a model; constant but for the time.

    Attributes:
        time: Since the machine was switched on, s.
        temperature: degC by sensor name; bodies that lag behind one have settled at it.
        spindle_rpm: Speed since the machine was switched on, 1/min; None where unknown.
        value: Columns of the user's own by name and unit.
        force: Load on the tool in table-frame directions, N.
    """

    time: float = 0.0
    temperature: Mapping[str, float] = field(default_factory=dict)
    spindle_rpm: float | None = None
    value: Mapping[str, float] = field(default_factory=dict)
    force: tuple[float, float, float] | None = None

    def touches(
        self,
        chain: Chain,
        q: Array,
        length: Array | float,
        approach: Array | None = None,
        elapsed: Array | None = None,
    ) -> Touches:
        """Poses in this state.

        Args:
            q: Readings, (N, A).
            length: Length of the tool, scalar or (N,), mm.
            approach: Sign of the last motion of every axis, (N, A); None where nothing moved.
            elapsed: Time since `time` at every pose, (N,), s.
        """
        at = at_poses(chain, q, length)
        n = len(at)
        speed, force = self.spindle_rpm, self.force
        return replace(
            at,
            time=np.full(n, self.time) if elapsed is None else self.time + elapsed,
            approach=at.approach if approach is None else approach,
            temperature={name: np.full(n, value) for name, value in self.temperature.items()},
            value={name: np.full(n, value) for name, value in self.value.items()},
            spindle_rpm=None if speed is None else np.full(n, speed),
            force=None if force is None else np.tile(force, (n, 1)),
        )


SWITCHED_ON = State()
"""A machine that was switched on just now, its spindle at rest, no sensor read."""
