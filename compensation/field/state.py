"""The state in which a machine is compensated: time since switching on, temperatures, speed."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from matstd.twin.errors import BadArgument
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.record import Touches, at_poses


@dataclass(frozen=True, slots=True)
class State:
    """Everything but the readings that drives the effects of a model; constant but for the time."""

    time: float = 0.0  # since the machine was switched on, s
    # degC by sensor name; bodies that lag behind one have settled at it
    temperature: Mapping[str, float] = field(default_factory=dict)
    spindle_rpm: float | None = None  # since the machine was switched on, 1/min; None where unknown
    value: Mapping[str, float] = field(default_factory=dict)  # user's columns, by name and unit
    force: tuple[float, float, float] | None = None  # on the tool, table-frame directions, N

    def __post_init__(self) -> None:
        for name in ("temperature", "value"):
            if not isinstance(given := getattr(self, name), Mapping):
                raise BadArgument(name, given, "values by name, such as {'spindle': 24.0}")

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
