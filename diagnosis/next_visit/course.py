"""How a visit spends its time, and the course of every recorded sensor while it does."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from matstd.twin.frames import Array, IntArray
from matstd.twin.record import Touches
from matstd.twin.units import HOUR, MINUTE

TIME_CONSTANTS = np.geomspace(0.03, 3.0, 25)
"""Time constants that are tried, as shares of the duration of the run."""


@dataclass(frozen=True, slots=True)
class Schedule:
    """How a visit spends its time."""

    warm_up: float = 0.0  # how long the machine has moved before the first touch, s
    pause: float = 0.0  # how long it stands still in the middle of the visit, s
    slowness: float = 1.0  # time from touch to touch over that of the recorded run

    def times(self, visit: IntArray, pace: float) -> Array:
        """Time of every touch from the first one on, (N,), s.

        Args:
            visit: Number of the pose of every touch, in the order of probing, (N,).
            pace: Time from touch to touch of the recorded run, s.
        """
        time = self.slowness * pace * np.arange(len(visit))
        return np.asarray(time + self.pause * self._is_after(visit), dtype=float)

    def pause_start(self, visit: IntArray, pace: float) -> float:
        """When the machine stops, s from the first touch; inf without a pause."""
        later = self._is_after(visit)
        if not self.pause or not later.any():
            return np.inf
        return self.slowness * pace * float(np.argmax(later))

    def _is_after(self, visit: IntArray) -> Array:
        """Touches after the pause: those of the second half of the poses."""
        poses = np.unique(visit)
        return np.asarray(visit >= poses[len(poses) // 2])


SCHEDULES = (
    Schedule(),
    Schedule(pause=1.0 * HOUR),
    Schedule(warm_up=2.0 * HOUR),
    Schedule(warm_up=2.0 * HOUR, pause=1.0 * HOUR),
    Schedule(slowness=3.0),
    Schedule(warm_up=30.0 * MINUTE, slowness=2.0),
)
"""From a cold machine, with a pause, after a warm-up, slowly: what makes time, temperatures and
places differ."""


@dataclass(frozen=True, eq=False)
class Course:
    """One sensor: it nears a level while the machine moves, and its start while it stands.

    ``T = start + rise (1 - exp(-t/tau))``; the remainder is weather, which another day has, too,
    but at other times.
    """

    start: float
    rise: float
    tau: float  # s
    weather: Array  # remainder over the time since the start, two rows: s and unit of the sensor

    @classmethod
    def of(cls, time: Array, value: Array) -> "Course":
        """Of a record over the time since its start, by least squares."""
        order = np.argsort(time, kind="stable")
        time, value = time[order], value[order]
        span = max(float(time[-1] - time[0]), 1.0)
        best: tuple[float, Array, float] | None = None
        for tau in span * TIME_CONSTANTS:
            A = np.stack([np.ones(len(time)), -np.expm1(-time / tau)], axis=1)
            found = np.linalg.lstsq(A, value, rcond=None)[0]
            left = float(np.sum((value - A @ found) ** 2))
            if best is None or left < best[0]:
                best = left, found, float(tau)
        assert best is not None
        _, (start, rise), tau = best
        weather = value - start - rise * -np.expm1(-time / tau)
        return cls(float(start), float(rise), tau, np.stack([time, weather]))

    def at(self, time: Array, schedule: Schedule, stop: float) -> Array:
        """The sensor in a visit, its weather left out, (N,).

        Args:
            time: From the first touch on, s.
            stop: When the machine stands still, s; inf for never.
        """
        moved = schedule.warm_up + time
        before = -np.expm1(-moved / self.tau)
        warm = -np.expm1(-(schedule.warm_up + min(stop, 1e12)) / self.tau)
        rested = warm * np.exp(-schedule.pause / self.tau)
        since = np.maximum(time - stop - schedule.pause, 0.0)
        after = 1.0 - (1.0 - rested) * np.exp(-since / self.tau)
        return np.asarray(self.start + self.rise * np.where(time <= stop, before, after))

    def weather_at(self, time: Array, shift: float) -> Array:
        """Weather of another day: that of the record, begun at another time, (N,)."""
        seen, value = self.weather
        span = max(float(seen[-1] - seen[0]), 1.0)
        phase = np.mod(time + shift, 2.0 * span)  # forwards, then backwards: without a jump
        return np.asarray(np.interp(seen[0] + np.minimum(phase, 2.0 * span - phase), seen, value))


def courses(touches: Touches) -> Mapping[str, Course]:
    """Courses of all temperature sensors, from the longest run of a record."""
    span = [np.ptp(touches.since_start[touches.run == k]) for k in range(len(touches.runs))]
    rows = touches.run == int(np.argmax(span))
    time = touches.since_start[rows]
    return {name: Course.of(time, value[rows]) for name, value in touches.temperature.items()}
