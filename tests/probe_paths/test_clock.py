"""Durations by hand: trapezoid, triangle, feed, and what a step of a program costs."""

import numpy as np

from matstd.probe_paths.control import Clock, Move, ProbeStep, step_times

CLOCK = Clock()
"""300 mm/s and 1 rad/s, 3000 mm/s^2 and 5 rad/s^2, 0.05 s a move and 0.8 s a cycle, as by hand."""

ROUNDING = 1e-12


def steps_of(chain, **by_axis):
    row = np.zeros(len(chain.axes))
    for name, value in by_axis.items():
        row[chain.axis_index(name)] = value
    return row


def test_rapid_moves_by_hand(chain):
    moves = np.array(
        [
            steps_of(chain, X=300.0),  # 300/300 + 300/3000
            steps_of(chain, X=3.0),  # never up to speed: 2 sqrt(3/3000)
            steps_of(chain, X=30.0, C=2.0),  # the slower axis: 2/1 + 1/5
            steps_of(chain),
        ]
    )
    found = CLOCK.durations(chain, moves, np.full(4, np.nan))
    by_hand = 0.05 + np.array([1.1, 2.0 * np.sqrt(1e-3), 2.2, 0.0])
    assert np.abs(found - by_hand).max() < ROUNDING


def test_fed_moves_run_along_the_path_or_along_the_angle(chain):
    moves = np.array([steps_of(chain, X=3.0, Y=4.0), steps_of(chain, B=0.3, C=0.4)])
    found = CLOCK.durations(chain, moves, np.array([10.0, 0.25]))
    assert np.abs(found - (0.05 + np.array([0.5, 2.0]))).max() < ROUNDING


def test_a_touch_counts_until_its_contact_and_its_retract_with_the_next_move(chain):
    here = steps_of(chain)
    touch = ProbeStep(
        line=1,
        index=0,
        q=here,
        direction=steps_of(chain, Z=-1.0),
        distance=8.0,
        feed=4.0,
        back=5.0,
        side=here,
        number=1,
        pose=1,
        feature=1,
        slow_feed=0.0,
        step_back=0.0,
        is_air=False,
    )
    steps = [Move(0, here, None), touch, Move(2, steps_of(chain, X=300.0), None)]
    found = step_times(chain, steps, CLOCK, np.array([6.0]))
    contact = 0.05 + 0.05 + 6.0 / 4.0 + 0.8
    after = contact + (5.0 / 300.0 + 0.05) + (1.1 + 0.05)
    assert np.abs(found - [0.05, contact, after]).max() < ROUNDING
    longest = step_times(chain, steps, CLOCK)
    assert abs(longest[1] - (contact + 2.0 / 4.0)) < ROUNDING
