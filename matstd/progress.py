"""Progress of a command on standard error: bars in a terminal, a line now and then elsewhere."""

from __future__ import annotations

import math
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, TextIO

from matstd.stop import raise_if_asked
from matstd.twin.compute import Progress

if TYPE_CHECKING:
    from rich.console import Console

PERIOD = 10.0
"""Seconds between two lines where there is no terminal."""


TIME_LEFT_TOLERANCE = 1.2
"""Times the time left that was last shown, up to which a new estimate counts as the same."""


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

    def tell(_share: float, doing: str) -> None:
        nonlocal last
        begun[doing] += doing != last
        last = doing
        show(doing, begun[doing], 0)

    return tell


@contextmanager
def stages() -> Iterator[Progress]:
    """A function (stage, done, total) that shows how far the work is and how long it still takes.

    In a terminal every stage is a bar; elsewhere a line says every ten seconds what is being done,
    also while a stage does not report, so that a log shows that the command lives.
    """
    from rich.console import Console

    watched = Console(stderr=True)
    with _bars(watched) if watched.is_terminal else _lines(sys.stderr, PERIOD) as show:
        yield show


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
    begun = time.monotonic()
    state, over = _State(since=begun), threading.Event()

    def show(stage: str, done: int, total: int) -> None:
        raise_if_asked()
        state.report(stage, done, total, time.monotonic())

    def tell() -> None:
        while not over.wait(period):
            now = time.monotonic()
            print(f"[{now - begun:3.0f} s] {state.words(now)}", file=out, flush=True)

    teller = threading.Thread(target=tell, daemon=True)
    teller.start()
    try:
        yield show
    finally:
        over.set()
        teller.join()
