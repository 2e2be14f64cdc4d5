"""Lines of progress outside a terminal: what is done, how much, how long the rest takes."""

import io
import re
import time

import pytest

from matstd.progress import _lines, _State, clock, turns


def test_the_rest_takes_as_long_as_its_share() -> None:
    state = _State("random machines", done=25, total=100, since=100.0)
    assert state.words(130.0) == "random machines: 25 %, about 1:30 min left"
    assert _State("STEP and STL", 0, 1, 0.0).words(9.0) == "STEP and STL"


def test_turns_that_nobody_can_foresee_are_counted() -> None:
    """A search begins anew, and its share with it: no time is promised that will not hold."""
    told: list[str] = []
    tell = turns(lambda *shown: told.append(_State(*shown).words(99.0)))
    for share, doing in ((0.2, "sets"), (0.8, "sets"), (0.5, "structure"), (0.2, "sets")):
        tell(share, doing)
    assert told == ["sets", "sets", "structure", "sets, turn 2"]


@pytest.mark.parametrize(("seconds", "words"), [(0.4, "0 s"), (59.4, "59 s"), (60.0, "1:00 min")])
def test_durations(seconds: float, words: str) -> None:
    assert clock(seconds) == words


def test_a_silent_stage_is_told_too() -> None:
    """Lines come by the clock, not by what the work reports; none comes once it is over."""
    out = io.StringIO()
    with _lines(out, 0.05) as show:
        show("placement", 1, 4)
        time.sleep(0.4)
    told = out.getvalue().splitlines()
    assert len(told) >= 2
    assert all(re.fullmatch(r"\[ *\d+ s\] placement: 25 %, about \d+ s left", t) for t in told)
    time.sleep(0.15)
    assert out.getvalue().splitlines() == told
