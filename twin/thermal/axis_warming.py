"""Thermal growth of a screw or scale and its bearing while its axis works."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from matstd.twin.fields import LinearAxisName, Refuse, moving_linear_axes
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.model import Amounts, Declared, Inner, Kind, Parameter
from matstd.twin.record import Touches
from matstd.twin.thermal.drive_columns import OWN, Clock, clocks, own_column
from matstd.twin.thermal.thermal_lag import LONGEST, SHORTEST, STEPS
from matstd.twin.units import MINUTE, UM

FASTEST, SLOWEST = 0.3, 1.0
"""Shortest time constant scanned in cycles, and longest in durations of the test: a slower one
cannot be distinguished from a straight line, which has no final value."""


@dataclass(frozen=True)
class AxisWarming(Declared):
    """The positioning error of a linear axis that warms while it works.

    ``E = (1 - exp(-t/tau)) (low (1 - s) + high s)``, s from 0 to 1 over the travel: the screw grows
    from its fixed bearing, wherever that is, and the bearing may move. A positioning test has no
    times, but its order: then t counts cycles.

    Reference:
        ISO 230-3 (thermal distortion caused by moving linear axes); ISO 230-2 (drift over cycles).
    """

    axis: LinearAxisName
    clock: Clock = ""
    tau: float = 20.0 * MINUTE  # time constant, s, or in units of the clock

    kind, called = "axis-warming", "growth of the screw or scale of {axis} while it warms"
    parameters = tuple(Parameter(f"{end} end", "mm", 30 * UM) for end in ("low", "high"))

    def on(self, chain: Chain, refuse: Refuse) -> Self:
        """One cycle where the clock counts cycles."""
        return replace(self, tau=1.0) if self.clock else self

    def amounts(self, touches: Touches) -> Amounts:
        low, high = touches.chain.link(self.axis).range
        s = (touches.reading(self.axis) - low) / (high - low)
        y = -np.expm1(-self._clock(touches) / self.tau)
        return (y * (1.0 - s), y * s)

    def _clock(self, touches: Touches) -> Array:
        """Time since the run began, or what counts it."""
        if not self.clock:
            return touches.since_start
        return np.maximum(own_column(touches, self.clock.removeprefix(OWN)), 0.0)

    def changes(self, touches: Touches) -> Sequence[tuple[str, Touches]]:
        """What grew from the first to the last touch at either end of the probed readings.

        Final values at the ends of the travel lie beyond a run that is short against the time
        constant, or that probed a part of the travel.
        """
        clock, q = self._clock(touches), touches.reading(self.axis)
        if not len(touches):
            return ()
        ends = touches[np.array([np.argmin(clock), np.argmax(clock)])]
        out = []
        for word, at in (("lowest", q.min()), ("highest", q.max())):
            there = ends.q.copy()
            there[:, touches.chain.axis_index(self.axis)] = at
            moved = replace(ends, q=there, commanded=None)
            out.append((f"change_at_{word}_reading", moved))
        return out

    def inner(self, touches: Touches) -> Sequence[Inner]:
        """The time constant, evenly spaced in its logarithm, up to that of the run."""
        spent = float(np.ptp(self._clock(touches))) if len(touches) else 1.0
        if self.clock:
            grid = np.geomspace(FASTEST, SLOWEST * max(spent, 1.0), STEPS)
            return (Inner("cycles", "1", grid),)
        high = float(np.clip(SLOWEST * spent, 4.0 * SHORTEST, LONGEST))
        return (Inner("tau", "s", np.geomspace(SHORTEST, high, STEPS)),)

    def tuned(self, *values: float) -> Self:
        return replace(self, tau=float(values[0]))

    @property
    def tuning(self) -> Mapping[str, float]:
        return {"cycles" if self.clock else "tau": self.tau}


def propose(touches: Touches) -> Iterable[AxisWarming]:
    """Every linear axis that moved, by the time and by the order of a test without times."""
    for axis in moving_linear_axes(touches):
        for clock in clocks(touches):
            yield AxisWarming(axis, clock, 1.0 if clock else AxisWarming.tau)


KIND = Kind.of(
    AxisWarming,
    title="warming of an axis that works",
    synonyms="ball screw heating, warm-up, drift over cycles, thermal growth of the screw",
    formula="E = (1 - exp(-t/tau)) (low (1 - s) + high s), s = (q - q_min)/travel",
    units="low, high: µm; tau: min, or cycles of a positioning test",
    typical="screws 10 to 60 µm at the free end of a metre, tau 20 to 60 min; scales a few µm",
    source="ISO 230-3 (moving linear axes); ISO 230-2 (drift over the cycles of a test)",
    propose=propose,
    when=lambda touches: not touches.instrument.is_ball_on_standard,  # whose growth hides it
)
