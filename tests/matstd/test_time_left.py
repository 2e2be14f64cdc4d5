"""Time left of a whole command: right at a steady pace, always falling, never silent."""

import io
import re
import time

import numpy as np
import pytest

from matstd.progress import TimeLeft, Watch, _lines

SHARES = {"first": 0.2, "second": 0.5, "third": 0.3}


def watched(ends: dict[str, float], shares=SHARES, steps: int = 1, late: float | None = None):
    """Time left, every second, of stages that end at some seconds and report some steps.

    Args:
        late: Share of a stage after which it reports one step of ten; None for none.
    """
    left = TimeLeft(shares, usual=50.0)
    events, since = [], 0.0
    for name, end in ends.items():
        events += [(since + (end - since) * k / steps, name, k, steps) for k in range(steps)]
        events += [(since + (end - since) * late, name, 1, 10)] if late else []
        since = end
    shown = []
    for now in np.arange(1.0, since, 1.0):
        while events and events[0][0] <= now:
            at, name, done, total = events.pop(0)
            left.report(name, done, total, at)
        shown.append((now, left.left(now), left.fraction(now)))
    return shown, since


def test_at_a_steady_pace_it_is_what_is_left():
    """Stages as long as their shares, ten steps each: at most a quarter too long from a fifth on,
    a seventh in the last third, and never a tenth too short."""
    shown, end = watched({"first": 40.0, "second": 140.0, "third": 200.0}, steps=10)
    for now, left, _ in shown[40:-10]:
        assert 0.9 < left / (end - now) < (1.25 if now < 0.67 * end else 1.15)


@pytest.mark.parametrize("seed", range(20))
def test_it_falls_whatever_the_stages_take(seed):
    """Stages take up to five times their share; every other one reports a step that comes late."""
    rng = np.random.default_rng(seed)
    ends = np.cumsum(rng.uniform(0.2, 5.0, 3) * 100.0 * np.array(list(SHARES.values())))
    shown, _ = watched(dict(zip(SHARES, ends, strict=True)), late=0.8 if seed % 2 else None)
    known = [left for _, left, _ in shown if left is not None]
    assert np.all(np.diff(known) < 1e-9)
    assert min(known) >= 0.0
    fractions = [done for _, _, done in shown]
    assert np.all(np.diff(fractions) >= -1e-12)
    assert fractions[-1] < 1.0


def test_it_is_right_at_half_time_where_stages_are_a_third_off():
    """Shares by 0.7 and 1.3: an error within a third at half time."""
    ends = np.cumsum(100.0 * np.array([0.2 * 1.3, 0.5 * 0.8, 0.3 * 1.2]))
    shown, end = watched(dict(zip(SHARES, ends, strict=True)), steps=4)
    now, left, _ = shown[len(shown) // 2]
    assert left == pytest.approx(end - now, rel=0.3)


def test_a_stage_that_the_plan_does_not_know_changes_nothing():
    left = TimeLeft(SHARES, usual=50.0)
    left.report("second", 1, 2, 45.0)
    before = left.fraction(50.0)
    left.report("moves of the programs", 3, 4, 50.0)
    assert left.fraction(50.0) == before


def test_a_line_shows_the_stage_the_share_of_the_whole_and_the_time_left():
    out, left = io.StringIO(), TimeLeft(SHARES, 1.0, time.monotonic() - 2.0)
    watch = Watch(left, is_whole=True)
    with _lines(out, watch, 0.05):
        watch.report("second", 1, 2, time.monotonic())
        time.sleep(0.15)
    line = out.getvalue().splitlines()[-1]
    assert re.fullmatch(r"\[ *\d+ s\] second: 4\d % of the whole, about \d+ s left", line)
