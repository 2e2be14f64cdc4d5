"""What is said on the console: results on standard output, progress beside them."""

import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

WIDE = 120
"""Letters of a line where neither a terminal nor COLUMNS says how wide it is."""


def console() -> "Console":
    """Standard output; a file or a pipe is wide enough for a table."""
    from rich.console import Console

    out = Console(highlight=False)
    is_said = out.is_terminal or "COLUMNS" in os.environ
    return out if is_said else Console(highlight=False, width=WIDE)


def say(text: str, style: str | None = None) -> None:
    """One line as it is: a terminal breaks it where it likes, a file keeps it whole."""
    console().print(text, markup=False, style=style, soft_wrap=True)


@contextmanager
def stages() -> Iterator[Callable[[str, int, int], None]]:
    """A function (stage, done, total) that shows every stage as a bar with its time.

    The bars go to standard error, and only where somebody watches.
    """
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn

    watched = Console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(30), TimeElapsedColumn())
    bars = Progress(*columns, console=watched, transient=False, disable=not watched.is_terminal)
    with bars:
        known: dict[str, TaskID] = {}

        def show(stage: str, done: int, total: int) -> None:
            if _Asked.to_stop:
                raise KeyboardInterrupt
            for name, task in known.items():
                if name != stage and not bars.tasks[task].finished:
                    bars.update(task, completed=bars.tasks[task].total)
            if stage not in known:
                known[stage] = bars.add_task(f"{stage:<24}", total=max(total, 1))
            bars.update(known[stage], completed=done, total=max(total, 1))

        yield show
        for task in known.values():
            bars.update(task, completed=bars.tasks[task].total)


class _Asked:
    """Whether somebody asked the command to stop."""

    to_stop = False


@contextmanager
def clean_stop() -> Iterator[None]:
    """Whoever is asked to end, by Ctrl-C or by the system (SIGTERM), tidies up and says so.

    An interrupt can fall into a place that swallows or renames it (a destructor, the import of a
    module); it is remembered, so that the next stage of the work, or whatever fails first, ends it.

    Raises:
        KeyboardInterrupt: However the interrupt came out of the block.
    """

    def stop(number: int, frame: FrameType | None) -> None:
        _Asked.to_stop = True
        raise KeyboardInterrupt

    if threading.current_thread() is not threading.main_thread():
        yield
        return
    _Asked.to_stop = False
    before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    except Exception as error:
        if not _Asked.to_stop:
            raise
        raise KeyboardInterrupt from error
    finally:
        for number, handler in before.items():
            if handler is not None:  # else something that is not Python had set it
                signal.signal(number, handler)
