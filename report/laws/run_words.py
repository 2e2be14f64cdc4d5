"""Whether a law is expected in another run, in words, and what a second run says of it."""

from matstd.diagnosis.laws import POLICY, LearntLaw, SecondRun
from matstd.report.numbers import microns, odds_words, plural
from matstd.twin.laws import CLOCK

_OF_ONE_RUN = (
    "{what} belongs to this run. Other runs are predicted without it, and less surely by its size, "
    "unless their touches show it, too. "
    "Record {record} as a column of the run, and learn again."
)
_SWITCHES = ("step", "window", "square", "saw", "sine", "pulse", "plateau", "ramp")
"""Shapes over time of something that was switched or changed."""

_LEVEL = "a temperature, a speed or a level that moves as it does"


def run_sentence(one: LearntLaw) -> str:
    """Why a law is not expected in other runs, and what to record."""
    clocked = [f.shape for f in one.law.factors if f.driver == CLOCK]
    if not clocked:
        is_open = one.run_odds < POLICY.open_driver
        odds = f"odds {odds_words(one.run_odds)} against that"
        why = odds if is_open else "what it follows only rose or fell in this run, as the time does"
        what = f"It may stand for a driver that was not recorded ({why}), and"
    elif any(s.relaxes for s in clocked) and not any(s.is_placed for s in clocked):
        what = "It had not come to rest when the run ended, may be a drift, and"
    elif any(shape.word in _SWITCHES for shape in clocked):
        record = "what switches or was changed (coolant, a pump, a cooler, a stylus, a clamp)"
        return _OF_ONE_RUN.format(what="A driver that was not recorded and switches", record=record)
    else:
        what = "A driver that was not recorded"
    return _OF_ONE_RUN.format(what=what, record=_LEVEL)


def second_run_sentence(second: SecondRun) -> str:
    """What a second run says."""
    words = f"A second run ({second.touches} touches): {microns(second.without)} without the law"
    without, learnt = second.gross
    also = f" without the law, {learnt} with it" if without != learnt else ""
    out = f" Left out as gross errors: {plural(without, 'touch')}{also}."
    return _second_run(second, words) + (out if without or learnt else "")


def _second_run(second: SecondRun, words: str) -> str:
    """Errors after the first of them, and what they say."""
    if second.clocked is None:
        words += f", {microns(second.learnt)} with it"
        if second.is_better:
            return f"{words}."
        return f"{words}: the law does not hold there. Do not use it to predict."
    if second.learnt != second.without:
        words += f", {microns(second.learnt)} with those that hold for every run"
    if not second.is_clock:
        words += f", {microns(second.clocked)} with the laws that belong to the first run"
        hold = "hold here, too" if second.is_clock_kept else "do not hold here"
        return f"{words}. They {hold}."
    words += f", {microns(second.clocked)} if what the run did not record kept its times"
    if second.is_clock_kept:
        return f"{words}: it did. What drives it begins with the run or its program."
    return f"{words}: it did not."
