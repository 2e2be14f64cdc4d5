"""Progress of a command on standard error, with the time left: bars in a terminal, else lines."""

from __future__ import annotations

import math
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple, TextIO

from matstd.stop import raise_if_asked
from matstd.twin.compute import Progress

if TYPE_CHECKING:
    from rich.console import Console

FIRST = 0.02
"""Fraction done from which on the pace of this run says how long the whole takes."""

WORTH_SHOWING = 0.04
"""Reported fraction from which on a time left is shown: one that began too short cannot grow."""


PATIENCE = 3
"""Power by which a time left that is too short runs slower: at half of the estimate an eighth."""


@dataclass(slots=True)
class TimeLeft:
    """How far a command is, and how long the rest takes."""

    # share of the whole that every stage takes, in their order; they sum up to one
    shares: Mapping[str, float]
    usual: float  # duration of the whole where it was measured, s: the pace before there is one
    begun: float = 0.0  # when the command began, s
    stage: str = ""
    position: float = 0.0
    reached: float = 0.0
    at: float = 0.0
    shown: float = math.inf
    shown_at: float = 0.0
    _before: dict[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.at = self.shown_at = self.begun
        total = 0.0
        for name, share in self.shares.items():
            self._before[name] = total
            total += share

    def report(self, stage: str, done: int, total: int, now: float) -> None:
        """Take what the work reports; a stage without a share changes nothing."""
        if stage not in self.shares:
            return
        self.stage = stage
        inside = done / total if total > 0 else 0.0
        position = self._before[stage] + self.shares[stage] * min(inside, 1.0)
        if position > self.position:
            self.position, self.at = position, now

    def fraction(self, now: float) -> float:
        """Fraction done, from 0 to 1, which never falls: a step that took longer catches up."""
        self.reached = max(self.reached, self._fraction(now))
        return self.reached

    def _fraction(self, now: float) -> float:
        """Fraction done by the last report and the clock."""
        end = self._before.get(self.stage, 0.0) + self.shares.get(self.stage, 0.0)
        rest = max(end - self.position, 0.0)
        if rest == 0.0:
            return self.position
        is_known = self.position > FIRST
        whole = (self.at - self.begun) / self.position if is_known else self.usual
        # towards the end of the stage, ever slower where it takes longer than its share
        return self.position - rest * math.expm1(-(now - self.at) / max(whole * rest, 1e-9))

    def left(self, now: float) -> float | None:
        """Seconds left, less at every call; None while there is no pace."""
        done = self._fraction(now)
        if self.position < WORTH_SHOWING:
            return None
        estimate = (now - self.begun) * (1.0 - done) / done
        if math.isinf(self.shown):
            self.shown = estimate
        else:  # where the estimate has grown, the shown one waits for it: nearly, but it falls
            ratio = min(self.shown / max(estimate, 1e-9), 1.0)
            self.shown = max(self.shown - (now - self.shown_at) * ratio**PATIENCE, 0.0)
            self.shown = min(self.shown, estimate)
        self.shown_at = now
        return self.shown


PERIOD = 10.0  # seconds between two lines where there is no terminal


TIME_LEFT_TOLERANCE = 1.2
"""Times the time left that was last shown, up to which a new estimate counts as the same."""


class Plan(NamedTuple):
    """Stages of a command as they were measured."""

    # share of the whole that every stage takes, in their order; they sum up to one
    shares: Mapping[str, float]
    usual: float  # duration of the whole, s


@dataclass(slots=True)
class _State:
    """What the command is doing, and how long the rest of the stage takes.

    The pace is that up to the last report: between two reports the time left runs down by the
    clock. It never grows: where a stage turns out slower than it began, none is shown until an
    estimate is below the last one again.
    """

    stage: str = "reading"
    done: int = 0
    total: int = 0
    since: float = 0.0
    reported: float = 0.0
    shown: float = math.inf

    def report(self, stage: str, done: int, total: int, now: float) -> None:
        """Take what the work reports."""
        if stage != self.stage:
            self.stage, self.since, self.shown = stage, now, math.inf
        self.done, self.total, self.reported = done, total, now

    def left(self, now: float) -> float | None:
        """Seconds left of the stage; None where they cannot be estimated."""
        if not 0 < self.done < self.total:
            return None
        whole = (self.reported - self.since) * self.total / self.done
        left = self.since + whole - now
        if not 0.0 < left <= TIME_LEFT_TOLERANCE * self.shown:
            return None
        self.shown = min(left, self.shown)
        return self.shown

    def words(self, now: float) -> str:
        """The stage, how much of it is done, and how long the rest of it takes."""
        if not self.total and self.done > 1:
            return f"{self.stage}, turn {self.done}"
        if not 0 < self.done < self.total:
            return self.stage
        left = self.left(now)
        rest = "" if left is None else f", about {clock(left)} left"
        return f"{self.stage}: {100 * self.done // self.total} %{rest}"


def clock(seconds: float) -> str:
    """A duration as minutes and seconds.

    Example:
        >>> clock(7.2), clock(192.0)
        ('7 s', '3:12 min')
    """
    whole = round(seconds)
    return f"{whole} s" if whole < 60 else f"{whole // 60}:{whole % 60:02d} min"


def turns(show: Progress) -> Callable[[float, str], None]:
    """Progress of work that goes in turns until nothing changes: what is done, and in which turn.

    How many turns are to come is not known, so neither a share nor a time is shown.
    """
    begun: Counter[str] = Counter()
    last = ""

    def report(_share: float, doing: str) -> None:
        nonlocal last
        begun[doing] += doing != last
        last = doing
        show(doing, begun[doing], 0)

    return report


@contextmanager
def stages(plan: Plan | None = None) -> Iterator[Progress]:
    """A function (stage, done, total) that shows how far the work is and how long it still takes.

    In a terminal every stage is a bar; elsewhere a line says every ten seconds what is being done,
    also while a stage does not report, so that a log shows that the command lives.

    Args:
        plan: Shares of the stages in a command whose stages are known: one bar shows the whole.
    """
    from rich.console import Console

    watched = Console(stderr=True)
    if plan is not None:
        left = TimeLeft(plan.shares, plan.usual, time.monotonic())
        with _bar(watched, left) if watched.is_terminal else _whole(sys.stderr, left) as show:
            yield show
        return
    with _bars(watched) if watched.is_terminal else _lines(sys.stderr, PERIOD) as show:
        yield show


@contextmanager
def _bar(watched: Console, left: TimeLeft) -> Iterator[Progress]:
    """One bar for the whole command, with the name of the stage."""
    from rich.progress import BarColumn, ProgressColumn, Task, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bars
    from rich.progress_bar import ProgressBar
    from rich.text import Text

    class Whole(BarColumn):
        """The fraction done by the clock, also while a stage is silent."""

        def render(self, task: Task) -> ProgressBar:
            done = 1.0 if task.finished else left.fraction(time.monotonic())
            return ProgressBar(total=1.0, completed=done, width=30)

    class Left(ProgressColumn):
        """Percent and time left of the whole."""

        def render(self, task: Task) -> Text:
            return Text("" if task.finished else _percent(left, time.monotonic()))

    columns = (TextColumn("{task.description}"), Whole(30), TimeElapsedColumn(), Left())
    with Bars(*columns, console=watched) as bars:
        whole = bars.add_task(f"{'':<24}", total=1)

        def show(stage: str, done: int, total: int) -> None:
            raise_if_asked()
            left.report(stage, done, total, time.monotonic())
            bars.update(whole, description=f"{stage:<24}")

        yield show
        bars.update(whole, completed=1, description=f"{'done':<24}")


@contextmanager
def _whole(out: TextIO, left: TimeLeft, period: float = PERIOD) -> Iterator[Progress]:
    """Lines such as `[ 70 s] placement: 31 % of the whole, about 2:35 min left`."""
    stage = "reading"

    def show(name: str, done: int, total: int) -> None:
        nonlocal stage
        raise_if_asked()
        stage = name
        left.report(name, done, total, time.monotonic())

    with _by_the_clock(out, period, lambda now: f"{stage}: {_percent(left, now)}"):
        yield show


def _percent(left: TimeLeft, now: float) -> str:
    """`31 % of the whole, about 2:35 min left`."""
    seconds = left.left(now)
    rest = "" if seconds is None else f", about {clock(seconds)} left"
    return f"{int(100.0 * left.fraction(now))} % of the whole{rest}"


@contextmanager
def _bars(watched: Console) -> Iterator[Progress]:
    from rich.progress import BarColumn, ProgressColumn, Task, TaskID, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bars
    from rich.text import Text

    state = _State(since=time.monotonic())

    class Left(ProgressColumn):
        """Time left of the stage that is being worked on."""

        def render(self, task: Task) -> Text:
            left = None if task.finished else state.left(time.monotonic())
            return Text("" if left is None else f"about {clock(left)} left")

    columns = (TextColumn("{task.description}"), BarColumn(30), TimeElapsedColumn(), Left())
    with Bars(*columns, console=watched) as bars:
        known: dict[str, TaskID] = {}

        def finish(but: str | None = None) -> None:
            for name, task in known.items():
                if name != but:
                    bars.update(task, completed=bars.tasks[task].total)

        def show(stage: str, done: int, total: int) -> None:
            raise_if_asked()
            finish(but=stage)
            state.report(stage, done, total, time.monotonic())
            if stage not in known:
                known[stage] = bars.add_task(f"{stage:<24}", total=max(total, 1))
            bars.update(known[stage], completed=done if total else 0, total=max(total, 1))

        yield show
        finish()


@contextmanager
def _lines(out: TextIO, period: float) -> Iterator[Progress]:
    """Lines such as `[ 70 s] placement: 50 %, about 60 s left`."""
    state = _State(since=time.monotonic())

    def show(stage: str, done: int, total: int) -> None:
        raise_if_asked()
        state.report(stage, done, total, time.monotonic())

    with _by_the_clock(out, period, state.words):
        yield show


@contextmanager
def _by_the_clock(out: TextIO, period: float, words: Callable[[float], str]) -> Iterator[None]:
    """A line by the clock while the block works."""
    begun, over = time.monotonic(), threading.Event()

    def repeat() -> None:
        while not over.wait(period):
            now = time.monotonic()
            print(f"[{now - begun:3.0f} s] {words(now)}", file=out, flush=True)

    reporter = threading.Thread(target=repeat, daemon=True)
    reporter.start()
    try:
        yield
    finally:
        over.set()
        reporter.join()
