"""Work in blocks: what bounds the memory of everything that runs over many poses or draws."""

from collections.abc import Callable, Iterator

Progress = Callable[[str, int, int], None]
"""Told what is being done, how much of it is done and how much there is."""


def blocks(count: int, size: int) -> Iterator[slice]:
    """Slices that cover 0 .. count in order, each of at most `size`.

    Example:
        >>> list(blocks(5, 2))
        [slice(0, 2, None), slice(2, 4, None), slice(4, 5, None)]
    """
    for start in range(0, count, size):
        yield slice(start, min(start + size, count))


def silent(what: str, done: int, total: int) -> None:
    """Progress that nobody is told."""
