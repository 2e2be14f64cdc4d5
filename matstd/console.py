"""Progress on the console: one line a stage, quiet where nobody watches."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def stages() -> Iterator[Callable[[str, int, int], None]]:
    """A function (stage, done, total) that shows every stage as a bar with its time."""
    from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description}"), BarColumn(30), TimeElapsedColumn())
    with Progress(*columns, transient=False) as bars:
        known: dict[str, TaskID] = {}

        def show(stage: str, done: int, total: int) -> None:
            for name, task in known.items():
                if name != stage and not bars.tasks[task].finished:
                    bars.update(task, completed=bars.tasks[task].total)
            if stage not in known:
                known[stage] = bars.add_task(f"{stage:<24}", total=max(total, 1))
            bars.update(known[stage], completed=done, total=max(total, 1))

        yield show
        for task in known.values():
            bars.update(task, completed=bars.tasks[task].total)
