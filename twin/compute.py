"""Work in blocks, its progress, and how many threads it may take."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController

Progress = Callable[[str, int, int], None]
"""Receives the name of the work, the amount done and the total."""


def blocks(count: int, size: int) -> Iterator[slice]:
    """Slices that cover 0 .. count in order, each of at most `size`, to bound the memory.

    Example:
        >>> list(blocks(5, 2))
        [slice(0, 2, None), slice(2, 4, None), slice(4, 5, None)]
    """
    for start in range(0, count, size):
        yield slice(start, min(start + size, count))


def silent(what: str, done: int, total: int) -> None:
    """Progress that is not reported."""


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """One thread for every product of matrices within.

    For use where our own threads share the processors or matrices are small: several BLAS threads
    would then only wait for one another. On two busy cores the relaxed problem of a placement took
    7.1 s of processor time with two threads and 1.3 s with one.
    """
    with _blas().limit(limits=1, user_api="blas"):
        yield


@cache
def _blas() -> "ThreadpoolController":
    """The libraries for products of matrices; to look for them takes five milliseconds."""
    import scipy.linalg  # noqa: F401  # its own BLAS is limited only once it is loaded
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()


def compiled_loop(function: Callable[..., None], **options: Any) -> Callable[..., None] | None:
    """A loop compiled by numba (the extra `fast`), or None without numba.

    The compiled code is cached beside the file or in the user's cache; this saves the next process
    a second or two per loop.
    """
    try:
        from numba import njit
    except ImportError:
        return None
    options |= {"nogil": True, "error_model": "numpy"}
    try:
        made: Callable[..., None] = njit(cache=True, **options)(function)
    except RuntimeError:  # no folder to keep it in
        made = njit(**options)(function)
    return made
