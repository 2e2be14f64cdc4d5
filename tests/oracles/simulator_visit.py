"""A planned visit on the exact simulator: same machine, standard and laws, clamped anew."""

from dataclasses import replace

import numpy as np
from simulator_experiment import LENGTH, RADIUS, placed, pose_about_z, temperatures
from simulator_machine import readings_at
from simulator_surface import surface_point, turn

STEP = 10.0
"""Step in which bodies warm and cool, s."""


def bodies(time, warm_up, stop, pause):
    """Share of a body's rise by its time constant, stepped through warm-up, work and standstill."""
    ticks = np.arange(-warm_up, time.max() + 2 * STEP, STEP)
    moves = (ticks < stop) | (ticks >= stop + pause)

    def risen(tau):
        share = np.zeros(len(ticks))
        for i in range(1, len(ticks)):
            share[i] = share[i - 1] + STEP / tau * (moves[i - 1] - share[i - 1])
        return np.interp(time, ticks, share)

    return risen


def visit(rng, first, row, stated, setup, tilt_and_turn, sides, time, rest):
    """The experiment of a visit, in the order of its touches.

    Args:
        rng: Source of clamping and weather.
        first: The experiment whose standard and places are touched.
        row: Touch of the first experiment whose place is touched, (N,).
        stated: (origin, rotation about z) of every set-up.
        setup: Its number, (N,).
        tilt_and_turn: Readings of the rotary axes by name, (N,) each, rad.
        sides: Sign of their last motion by name, (N,) each.
        time: From the first touch on, (N,), s.
        rest: (warm-up before, standstill from, its duration), s.
    """
    pad, place = first.pad[row], tuple(p[row] for p in first.place)
    point, normal = surface_point(first.pads, pad, *place)
    T = np.stack([pose_about_z(*s) for s in stated])[setup]
    target = turn(T[:, :3, :3], point) + T[:, :3, 3] + RADIUS * turn(T[:, :3, :3], normal)
    still = {name: np.zeros(len(row)) for name in first.machine.linear}
    warm = temperatures(rng, time, bodies(time, *rest))
    poses = np.stack([setup, *tilt_and_turn.values()], axis=1)
    return replace(
        first,
        stated=stated,
        actual=placed(rng, stated),
        q=readings_at(first.machine, target, still | tilt_and_turn, LENGTH),
        setup=setup,
        pose=np.cumsum(np.any(np.diff(poses, axis=0, prepend=poses[:1]) != 0.0, axis=1)),
        pad=pad,
        place=place,
        last_turn=sides,
        time=np.round(time, 1),
        temperature={k: np.round(v, 3) for k, v in warm.items()},
        rpm=np.zeros(len(row)),
    )
