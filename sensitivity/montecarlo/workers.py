"""Workers of a Monte Carlo: this process, an executor, or a Dask cluster.

All three have one interface. Shared data are made where they are used, jobs go out a few at a time,
and results come back in the order of the jobs, so sums do not depend on the kind of workers.
"""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import BrokenExecutor, Executor
from os import cpu_count
from typing import Any, Protocol, TypeVar

from matstd.sensitivity.montecarlo.dask_cluster import awaited, is_cluster
from matstd.twin.errors import DesignError

Shared = TypeVar("Shared")
Job = TypeVar("Job")
Result = TypeVar("Result")


class Client(Protocol):
    """As much of `dask.distributed.Client` as is used."""

    def submit(self, func: Callable[..., Any], *args: Any, **kwargs: Any) -> Any:
        """A future of ``func(*args)`` on some worker."""

    def nthreads(self) -> dict[str, int]:
        """Threads of every worker."""


Workers = Executor | Client | None
"""`None` for this process alone."""


def in_order(
    workers: Workers,
    prepare: Callable[[], Shared],
    work: Callable[[Shared, Job], Result],
    jobs: Iterable[Job],
) -> Iterator[Result]:
    """Results of ``work(prepare(), job)`` for every job, in the order of the jobs.

    Only a few jobs are under way at once, so jobs may be an endless iterator; pending jobs are
    cancelled when the iterator is closed. A Dask cluster repeats the work of a lost worker, its
    shared data included.

    Args:
        prepare: Makes what all jobs share; called once in this process, or once on a cluster.
        work: A function of a module, so that other processes find it.
    """
    if workers is None:
        shared = prepare()
        yield from (work(shared, job) for job in jobs)
    elif isinstance(workers, Executor):
        yield from _by_executor(workers, prepare(), work, jobs)
    elif is_cluster(workers):
        yield from _by_cluster(workers, prepare, work, jobs)
    else:
        raise DesignError(f"{type(workers).__name__} is neither an executor nor a Dask client")


def _by_executor(
    workers: Executor, shared: Shared, work: Callable[[Shared, Job], Result], jobs: Iterable[Job]
) -> Iterator[Result]:
    most = 2 * (getattr(workers, "_max_workers", None) or cpu_count() or 1)
    try:
        yield from _window(
            lambda job: workers.submit(work, shared, job),
            jobs,
            most,
            lambda future: future.result(),
        )
    except BrokenExecutor as error:
        raise DesignError(f"a worker process ended before its work was done ({error})") from error


def _by_cluster(
    workers: Any,
    prepare: Callable[[], Shared],
    work: Callable[[Shared, Job], Result],
    jobs: Iterable[Job],
) -> Iterator[Result]:
    shared = workers.submit(prepare, pure=False)
    most = 2 * max(1, sum(workers.nthreads().values()))
    yield from _window(
        lambda job: workers.submit(work, shared, job, pure=False),
        jobs,
        most,
        lambda future: awaited(workers, future),
    )


def _window(
    submit: Callable[[Job], Any], jobs: Iterable[Job], most: int, result: Callable[[Any], Result]
) -> Iterator[Result]:
    """Keep at most `most` jobs under way; results in order."""
    todo = iter(jobs)
    waiting: deque[Any] = deque()
    try:
        while True:
            while len(waiting) < most and (job := next(todo, None)) is not None:
                waiting.append(submit(job))
            if not waiting:
                return
            yield result(waiting[0])
            waiting.popleft()
    finally:
        for future in waiting:
            future.cancel()
