"""How long moves take and when steps happen, in plan and simulation; times of a log."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from matstd.probe_paths.control.steps import Move, ProbeStep, Step
from matstd.twin.frames import Array
from matstd.twin.machine import Chain
from matstd.twin.units import DAY, HOUR


@dataclass(frozen=True)
class Clock:
    """Speeds of machine and control. Defaults are those of a machine of medium speed."""

    rapid: float = 300.0  # rapid speed of a linear axis, mm/s
    turning: float = 1.0  # rapid of a rotary axis, rad/s
    acceleration: float = 3000.0  # acceleration of a linear axis, mm/s^2
    turning_acceleration: float = 5.0  # acceleration of a rotary axis, rad/s^2
    block: float = 0.05  # what every move costs besides, s
    probing: float = 0.8  # what a probing cycle costs besides its motion, s

    def durations(self, chain: Chain, steps: Array, feed: Array) -> Array:
        """Duration of moves from standstill to standstill, (M,), s.

        An axis that travels s needs ``s/v + v/a``, or ``2 sqrt(s/a)`` where it does not come up to
        speed; the slowest axis decides. A fed move runs at its feed along the path (along the
        angle, where only rotary axes turn).

        Args:
            steps: Change of the readings, shape (M, A), mm and rad; nan counts as no motion.
            feed: mm/s or rad/s, shape (M,); nan is rapid.
        """
        linear, rotary = chain.linear_columns, chain.rotary_columns
        travel = np.abs(np.nan_to_num(steps))
        fastest = np.maximum(
            _rapid(travel[:, linear], self.rapid, self.acceleration),
            _rapid(travel[:, rotary], self.turning, self.turning_acceleration),
        )
        path = np.linalg.norm(travel[:, linear], axis=1)
        path = np.where(path > 0.0, path, np.linalg.norm(travel[:, rotary], axis=1))
        return self.block + np.where(np.isnan(feed), fastest, path / feed)


def _rapid(travel: Array, speed: float, acceleration: float) -> Array:
    """Duration of rapid moves of axes, the slowest of each row, (M,), s."""
    if not travel.shape[1]:
        return np.zeros(len(travel))
    trapezoid = travel / speed + speed / acceleration
    triangle = 2.0 * np.sqrt(travel / acceleration)
    short = travel < speed**2 / acceleration
    return np.where(short, triangle, trapezoid).max(axis=1)


def step_times(
    chain: Chain, steps: Sequence[Step], clock: Clock, travel: Array | None = None
) -> Array:
    """Time at the end of each step of a program, (M,), s; zero at the end of the first moves.

    A touch counts until its contact; its retract belongs to the move that follows.

    Args:
        travel: Path of each touch to its contact, (N,), mm; None takes the longest path.
    """
    count = len(steps)
    change = np.zeros((count, len(chain.axes)))
    feed, extra = np.full(count, np.nan), np.zeros(count)
    is_motion = np.zeros(count, dtype=bool)
    q = np.full(len(chain.axes), np.nan)
    back = 0.0
    for i, step in enumerate(steps):
        if isinstance(step, Move):
            change[i] = step.q - q
            feed[i] = np.nan if step.feed is None else step.feed
            q, is_motion[i] = step.q, True
            extra[i], back = back, 0.0
        elif isinstance(step, ProbeStep):
            length = step.distance if travel is None else travel[step.index]
            change[i] = length * step.direction
            feed[i], is_motion[i], extra[i] = step.feed, True, clock.probing
            # the second stroke: back at the feed, forward at the slow feed
            if step.slow_feed:
                extra[i] += step.step_back * (1.0 / step.feed + 1.0 / step.slow_feed)
            back = min(step.back, length) / clock.rapid + clock.block
    duration = np.where(is_motion, clock.durations(chain, change, feed), 0.0)
    return np.cumsum(duration + extra)


_MIDNIGHT_STEP = 0.5 * DAY  # a step of more than this, s, is a step back within the same day

_PAUSE = 600.0
"""Usual limit of a pause between two touches, s: a step of an hour and less than this is a clock
that was set."""


class LogClock:
    """Turns the times of day of a part into seconds since its begin."""

    def __init__(self, start: int | None) -> None:
        self.start = start  # time of day of the head, s; of the first touch where it has none
        self.remarks: list[str] = []
        self._last = start
        self._elapsed = 0.0

    def elapsed(self, now: int, line: int) -> float:
        """Seconds since the beginning at a time of day, s, read from a line; never decreasing.

        A clock that goes back by an hour (summer time ends) or on by one (it begins) has been set;
        the time between the touches is then the remainder of the hour.
        """
        if self._last is None or self.start is None:
            self.start = self._last = now
        step = (now - self._last) % DAY
        if step > _MIDNIGHT_STEP:
            back = DAY - step
            step = HOUR - back if 0.0 <= HOUR - back < _PAUSE else 0.0
            self.remarks.append(
                f"line {line}: the clock goes back by {back / 60.0:.0f} min; it was set, and times "
                f"go on {step:.0f} s after the touch before"
            )
        elif HOUR <= step < HOUR + _PAUSE:
            self.remarks.append(
                f"line {line}: the clock goes on by {step / 60.0:.0f} min; a pause, or summer time "
                "began and later times are an hour too late"
            )
        self._last = now
        self._elapsed += step
        return self._elapsed
