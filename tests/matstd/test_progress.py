"""Lines of progress outside a terminal: what is done, how much, how long the rest takes."""

import io
import re
import time

import pytest

from matstd.progress import _lines, _State, clock, turns


def test_the_rest_takes_as_long_as_its_share() -> None:
    state = _State("random machines", done=25, total=100, since=100.0, reported=130.0)
    assert state.words(130.0) == "random machines: 25 %, about 1:30 min left"
    assert _State("STEP and STL", 0, 1, 0.0).words(9.0) == "STEP and STL"


def test_the_time_left_does_not_grow() -> None:
    """The second step takes ten times as long as the first, and longer than its report foresaw."""
    state = _State()
    state.report("placement", 0, 3, 0.0)
    state.report("placement", 1, 3, 5.0)
    assert state.words(6.0) == "placement: 33 %, about 9 s left"
    assert state.words(13.0) == "placement: 33 %, about 2 s left"
    assert state.words(40.0) == "placement: 33 %"  # overdue
    state.report("placement", 2, 3, 55.0)
    assert state.left(56.0) is None  # 26 s by the new pace, 2 s were shown
    assert state.words(80.5) == "placement: 66 %, about 2 s left"
    state.report("proof", 1, 2, 90.0)
    state.report("proof", 1, 2, 100.0)
    assert state.left(101.0) == 9.0


def test_turns_that_cannot_be_foreseen_are_counted() -> None:
    """A search begins anew, and its share with it: no time is promised that will not hold."""
    stated: list[str] = []
    report = turns(lambda *shown: stated.append(_State(*shown).words(99.0)))
    for share, doing in ((0.2, "sets"), (0.8, "sets"), (0.5, "structure"), (0.2, "sets")):
        report(share, doing)
    assert stated == ["sets", "sets", "structure", "sets, turn 2"]


@pytest.mark.parametrize(("seconds", "words"), [(0.4, "0 s"), (59.4, "59 s"), (60.0, "1:00 min")])
def test_durations(seconds: float, words: str) -> None:
    assert clock(seconds) == words


def test_a_silent_stage_is_reported_too() -> None:
    """Lines come by the clock, not by what the work reports; none comes once it is over."""
    out = io.StringIO()
    with _lines(out, 0.05) as show:
        show("placement", 0, 4)
        time.sleep(0.2)
        show("placement", 1, 4)
        time.sleep(0.3)
    stated = out.getvalue().splitlines()
    assert len(stated) >= 2
    assert re.fullmatch(r"\[ *\d+ s\] placement: 25 %, about \d+ s left", stated[-1])
    time.sleep(0.15)
    assert out.getvalue().splitlines() == stated
