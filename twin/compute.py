"""Work in blocks, its progress, and how many threads it may take."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

Progress = Callable[[str, int, int], None]
"""Told what is being done, how much of it is done and how much there is."""


def blocks(count: int, size: int) -> Iterator[slice]:
    """Slices that cover 0 .. count in order, each of at most `size`; they bound the memory.

    Example:
        >>> list(blocks(5, 2))
        [slice(0, 2, None), slice(2, 4, None), slice(4, 5, None)]
    """
    for start in range(0, count, size):
        yield slice(start, min(start + size, count))


def silent(what: str, done: int, total: int) -> None:
    """Progress that nobody is told."""


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """One thread for every product of matrices within.

    Where threads of our own share the processors, and where matrices are small: several threads a
    product then only wait for one another, the more so on a busy machine.
    """
    from threadpoolctl import threadpool_limits

    with threadpool_limits(1, user_api="blas"):
        yield
