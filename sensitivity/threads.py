"""How many threads matrix products may take."""

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """One thread for every product of matrices within.

    Where threads of our own share the processors, and where matrices are small: several threads a
    product then only wait for one another, the more so on a busy machine.
    """
    from threadpoolctl import threadpool_limits

    with threadpool_limits(1, user_api="blas"):
        yield
