"""When each step of a program happens, by the clock of machine and control."""

from collections.abc import Sequence

import numpy as np

from probe_paths.control.clock import Clock
from probe_paths.control.steps import Move, ProbeStep, Step
from twin.frames import Array
from twin.machine import Chain


def step_times(
    chain: Chain, steps: Sequence[Step], clock: Clock, travel: Array | None = None
) -> Array:
    """Time at which each step of a program has been done.

    A touch counts until its contact; its retract belongs to the move that follows.

    Args:
        chain: The machine.
        steps: Of the program, in order.
        clock: Speeds.
        travel: Of each touch until its contact, (N,), mm; None takes the longest path.

    Returns:
        Shape (M,), s since the program was started; the start is where the first moves end.
    """
    count = len(steps)
    change = np.zeros((count, len(chain.axes)))
    feed, extra = np.full(count, np.nan), np.zeros(count)
    is_motion = np.zeros(count, dtype=bool)
    q = np.full(len(chain.axes), np.nan)
    back = 0.0
    for i, step in enumerate(steps):
        if isinstance(step, Move):
            change[i] = np.nan_to_num(step.q - q)
            feed[i] = np.nan if step.feed is None else step.feed
            q, is_motion[i] = step.q, True
            extra[i], back = back, 0.0
        elif isinstance(step, ProbeStep):
            length = step.distance if travel is None else travel[step.index]
            change[i] = length * step.direction
            feed[i], is_motion[i], extra[i] = step.feed, True, clock.probing
            back = min(step.back, length) / clock.rapid + clock.block
    duration = np.where(is_motion, clock.durations(chain, change, feed), 0.0)
    times: Array = np.cumsum(duration + extra)
    return times
