"""Choice of the table to read in a report with several tables."""

from collections.abc import Callable, Sequence

Row = tuple[int, Sequence[str | float]]
"""A line of the file with its cells."""

MIN_EQUAL_NAMES = 0.5
"""From this share of equal names two headers belong to parts of one table."""


def fullest_table(
    rows: Sequence[Row], is_data: Callable[[Sequence[str | float]], bool]
) -> tuple[Sequence[Row], list[int]]:
    """Rows without the tables that have other columns than the one with most numbers.

    A header is a row of words with as many cells as the row of numbers right below it. Of tables
    with as many numbers the first is taken, as results stand below what they are computed from.

    Returns:
        The rows, and the lines of those that were passed over.

    Example:
        >>> is_data = lambda row: isinstance(row[0], float)
        >>> fullest_table([(1, ["a", "b"]), (2, [1.0, 2.0]),
        ...                (3, ["c", "d"]), (4, [1.0, 2.0]), (5, [3.0, 4.0])], is_data)
        ([(3, ['c', 'd']), (4, [1.0, 2.0]), (5, [3.0, 4.0])], [1, 2])
    """
    headers: list[tuple[str, ...]] = []
    of: list[int | None] = []
    at: int | None = None
    for k, (_, row) in enumerate(rows):
        below = rows[k + 1][1] if k + 1 < len(rows) else ()
        names = _names(row)
        if names and is_data(below) and len(names) == sum(c != "" for c in below):
            at = next((i for i, h in enumerate(headers) if _alike(h, names)), len(headers))
            headers += [names] if at == len(headers) else []
            of.append(at)
        else:
            of.append(at if is_data(row) else None)
    if len(headers) < 2:
        return rows, []
    numbers = [0] * len(headers)
    for (_, row), table in zip(rows, of, strict=True):
        if table is not None:
            numbers[table] += sum(isinstance(c, float) for c in row)
    best = numbers.index(max(numbers))
    kept = [row for row, table in zip(rows, of, strict=True) if table in (None, best)]
    return kept, [row[0] for row, table in zip(rows, of, strict=True) if table not in (None, best)]


def _names(row: Sequence[str | float]) -> tuple[str, ...]:
    """Cells of a row of two words or more, () of any other."""
    filled = tuple(c for c in row if c != "")
    words = tuple(c for c in filled if isinstance(c, str))
    return words if len(words) == len(filled) > 1 else ()


def _alike(one: tuple[str, ...], other: tuple[str, ...]) -> bool:
    same = sum(a == b for a, b in zip(one, other, strict=False))
    return len(one) == len(other) and same >= MIN_EQUAL_NAMES * len(one)
