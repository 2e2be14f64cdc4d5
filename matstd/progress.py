"""Progress of a command on standard error, with the time left: a bar in a terminal, else lines."""

from __future__ import annotations

import math
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from statistics import median
from typing import TYPE_CHECKING, TextIO

from matstd.stop import raise_if_asked
from matstd.twin.compute import Progress

if TYPE_CHECKING:
    from rich.console import Console

TRUSTED_FRACTION = 0.02
"""Fraction done from which on the pace of this run says how long the whole takes."""
WORTH_SHOWING = 0.04  # reported fraction from which on a time left is shown

MIN_STAGES = 3  # finished stages from which their median says how fast this machine is
MIN_SECONDS = 1.0  # planned for a stage, below which its duration says nothing about the machine

SLOWER = 4
"""Power by which a time left that is too short runs slower, since what is shown never rises: at
half of the estimate a sixteenth."""


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
    entered: float = 0.0  # when its stage began
    _paces: list[float] = field(default_factory=list)  # durations of finished stages over the plan
    _before: dict[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.at = self.shown_at = self.entered = self.begun
        total = 0.0
        for name, share in self.shares.items():
            self._before[name] = total
            total += share

    def report(self, stage: str, done: int, total: int, now: float) -> None:
        """Take what the work reports; a stage without a share changes nothing."""
        if stage not in self.shares:
            return
        if stage != self.stage:
            planned = self.shares.get(self.stage, 0.0) * self.usual
            if planned >= MIN_SECONDS:
                self._paces.append((now - self.entered) / planned)
            self.stage, self.entered = stage, now
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
        is_known = self.position > TRUSTED_FRACTION
        whole = (self.at - self.begun) / self.position if is_known else self.usual
        # towards the end of the stage, ever slower where it takes longer than its share
        return self.position - rest * math.expm1(-(now - self.at) / max(whole * rest, 1e-9))

    def left(self, now: float) -> float | None:
        """Seconds left, less at every call; None while there is no pace."""
        done = self._fraction(now)
        if self.position < WORTH_SHOWING:
            return None
        if len(self._paces) >= MIN_STAGES and math.isfinite(self.usual):
            # a stage whose work is not known beforehand says little about the others
            estimate = median(self._paces) * self.usual * (1.0 - done)
        else:
            estimate = (now - self.begun) * (1.0 - done) / done
        if math.isinf(self.shown):
            self.shown = estimate
        else:  # where the estimate has grown, the shown one waits for it: nearly, but it falls
            ratio = min(self.shown / max(estimate, 1e-9), 1.0)
            self.shown = max(self.shown - (now - self.shown_at) * ratio**SLOWER, 0.0)
            self.shown = min(self.shown, estimate)
        self.shown_at = now
        return self.shown


PERIOD = 10.0  # seconds between two lines where there is no terminal


Plan = Mapping[str, float]
"""Seconds that the stages of a command take, as they were measured, in their order."""


@dataclass(slots=True)
class Watch:
    """What a command is doing, how much of it is done, and how long the rest takes."""

    left: TimeLeft  # of the whole; of the stage where the stages of the command are not known
    is_whole: bool
    stage: str = "reading"
    turn: int = 0  # of a stage that goes in turns

    @classmethod
    def of(cls, plan: Plan | None, now: float) -> Watch:
        """At the beginning of a command, with its plan if it has one."""
        whole = math.inf if plan is None else sum(plan.values())
        shares = {stage: seconds / whole for stage, seconds in (plan or {}).items()}
        return cls(TimeLeft(shares, whole, now), plan is not None)

    def report(self, stage: str, done: int, total: int, now: float) -> None:
        """Take what the work reports; without a plan a new stage begins its own estimate."""
        if stage != self.stage and not self.is_whole:
            self.left = TimeLeft({stage: 1.0}, math.inf, now)
        self.stage, self.turn = stage, 0 if total else done
        self.left.report(stage, done, total, now)

    def words(self, now: float) -> str:
        """`turn 2`, `25 %, about 9 s left`; "" while nothing is known."""
        if self.turn > 1:
            return f"turn {self.turn}"
        done, seconds = self.left.fraction(now), self.left.left(now)
        if not 0.0 < done < 1.0:
            return ""
        # below a second the estimate is used up: nothing is promised
        rest = "" if seconds is None or seconds < 1.0 else f", about {clock(seconds)} left"
        return f"{int(100.0 * done)} %{' of the whole' if self.is_whole else ''}{rest}"


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

    A terminal shows a bar; elsewhere a line says every ten seconds what is being done, also while
    a stage does not report, so that a log shows that the command lives.

    Args:
        plan: Of a command whose stages are known: the bar shows the whole.
    """
    from rich.console import Console

    watched, watch = Console(stderr=True), Watch.of(plan, time.monotonic())

    def show(stage: str, done: int, total: int) -> None:
        raise_if_asked()
        watch.report(stage, done, total, time.monotonic())

    with _bar(watched, watch) if watched.is_terminal else _lines(sys.stderr, watch):
        yield show


@contextmanager
def _bar(watched: Console, watch: Watch) -> Iterator[None]:
    """One bar for the whole command, or for the stage where its stages are not known."""
    from rich.progress import BarColumn, ProgressColumn, Task, TimeElapsedColumn
    from rich.progress import Progress as Bars
    from rich.progress_bar import ProgressBar
    from rich.text import Text

    class Stage(ProgressColumn):
        def render(self, task: Task) -> Text:
            return Text(f"{'done' if task.finished else watch.stage:<24}")

    class Done(BarColumn):
        """The fraction done by the clock, also while a stage is silent."""

        def render(self, task: Task) -> ProgressBar:
            done = 1.0 if task.finished else watch.left.fraction(time.monotonic())
            return ProgressBar(total=1.0, completed=done, width=30)

    class Left(ProgressColumn):
        def render(self, task: Task) -> Text:
            return Text("" if task.finished else watch.words(time.monotonic()))

    with Bars(Stage(), Done(30), TimeElapsedColumn(), Left(), console=watched) as bars:
        whole = bars.add_task("", total=1)
        yield
        bars.update(whole, completed=1)


@contextmanager
def _lines(out: TextIO, watch: Watch, period: float = PERIOD) -> Iterator[None]:
    """Lines by the clock: `[ 70 s] placement: 31 % of the whole, about 2:35 min left`."""
    begun, over = time.monotonic(), threading.Event()

    def repeat() -> None:
        while not over.wait(period):
            now = time.monotonic()
            words = ": ".join(filter(None, (watch.stage, watch.words(now))))
            print(f"[{now - begun:3.0f} s] {words}", file=out, flush=True)

    reporter = threading.Thread(target=repeat, daemon=True)
    reporter.start()
    try:
        yield
    finally:
        over.set()
        reporter.join()
