"""Lines of progress outside a terminal: what is done, how much, how long the rest takes."""

import io
import re
import time

import pytest

from matstd.progress import Watch, _lines, clock, turns


def watched(*reports: tuple[str, int, int, float]) -> Watch:
    """A command without a plan that began at 0 s and has reported stages, shares and times."""
    watch = Watch.of(None, 0.0)
    for stage, done, total, now in reports:
        watch.report(stage, done, total, now)
    return watch


def test_the_rest_takes_as_long_as_its_share() -> None:
    watch = watched(("random machines", 0, 100, 100.0), ("random machines", 25, 100, 130.0))
    assert watch.words(130.0) == "25 %, about 1:30 min left"
    assert watched(("STEP and STL", 0, 1, 0.0)).words(9.0) == ""
    assert watched().words(9.0) == ""


def test_the_time_left_does_not_grow() -> None:
    """The second step takes ten times as long as the first; a new stage begins anew."""
    watch = watched(("placement", 0, 3, 0.0), ("placement", 1, 3, 5.0))
    left = [watch.left.left(now) for now in (6.0, 13.0, 40.0)]
    watch.report("placement", 2, 3, 55.0)
    left += [watch.left.left(now) for now in (56.0, 80.5)]
    assert left == sorted(left, reverse=True)
    assert left[0] == pytest.approx(9.0, abs=1.0)
    assert watch.words(81.0) == "87 %"  # overdue
    watch.report("proof", 0, 2, 90.0)
    watch.report("proof", 1, 2, 100.0)
    assert watch.words(100.0) == "50 %, about 10 s left"


@pytest.mark.parametrize(("pace", "drawn"), [(1.0, 5.0), (1.0, 30.0), (2.0, 5.0)])
def test_a_stage_that_is_sooner_done_says_nothing_about_the_others(
    pace: float, drawn: float
) -> None:
    """Three stages show how fast the machine is; the draws take a sixth of their plan, or all."""
    planned = {"reach": 10.0, "balls": 10.0, "choice": 10.0, "draws": 30.0, "report": 40.0}
    watch, now = Watch.of(planned, 0.0), 0.0
    for stage in planned:
        watch.report(stage, 0, 1, now)
        now += pace * (drawn if stage == "draws" else planned[stage])
    begun = now - pace * planned["report"]
    assert watch.left.left(begun) == pytest.approx(pace * planned["report"], rel=1e-3)


def test_turns_that_cannot_be_foreseen_are_counted() -> None:
    """A search begins anew, and its share with it: no time is promised that will not hold."""
    watch, stated = watched(), []

    def show(stage: str, done: int, total: int) -> None:
        watch.report(stage, done, total, 0.0)
        stated.append((watch.stage, watch.words(99.0)))

    report = turns(show)
    for share, doing in ((0.2, "sets"), (0.8, "sets"), (0.5, "structure"), (0.2, "sets")):
        report(share, doing)
    assert stated == [("sets", ""), ("sets", ""), ("structure", ""), ("sets", "turn 2")]


@pytest.mark.parametrize(("seconds", "words"), [(0.4, "0 s"), (59.4, "59 s"), (60.0, "1:00 min")])
def test_durations(seconds: float, words: str) -> None:
    assert clock(seconds) == words


def test_a_silent_stage_is_reported_too() -> None:
    """Lines come by the clock, not by what the work reports; none comes once it is over."""
    out, watch = io.StringIO(), watched()
    with _lines(out, watch, 0.05):
        watch.report("placement", 0, 4, time.monotonic())
        time.sleep(0.2)
        watch.left.begun -= 10.0
        watch.report("placement", 1, 4, time.monotonic())
        time.sleep(0.3)
    stated = out.getvalue().splitlines()
    assert len(stated) >= 2
    assert re.fullmatch(r"\[ *\d+ s\] placement: 2\d %, about \d+ s left", stated[-1])
    time.sleep(0.15)
    assert out.getvalue().splitlines() == stated
