"""The tables of a report that has several: one per axis, readings, statistics, environment."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

Row = tuple[int, Sequence[str | float]]  # a line of the file with its cells

MIN_EQUAL_NAMES = 0.5  # from this share of equal names two headers belong to parts of one table
_AXIS = re.compile(
    r"\b(?:axis|achse|axe|eje)\b\W*([XYZABC])\b|\b([XYZABC])[- ](?:axis|achse)\b", re.IGNORECASE
)


@dataclass(frozen=True)
class Part:
    """One table of a report: its rows with all words of the file, and the lines of the others."""

    rows: Sequence[Row]
    passed_over: tuple[int, ...] = ()


def separate_tables(
    rows: Sequence[Row], is_data: Callable[[Sequence[str | float]], bool]
) -> list[Part]:
    """The tables of a file by their headers, in its order; words alone stand with each of them.

    A header is a row of words with as many cells as the row of numbers right below it. Tables with
    alike headers are parts of one (forward and backward), unless words above them name other axes.

    Example:
        >>> is_data = lambda row: isinstance(row[0], float)
        >>> [part.passed_over for part in separate_tables([(1, ["a", "b"]), (2, [1.0, 2.0]),
        ...     (3, ["c", "d"]), (4, [1.0, 2.0]), (5, [3.0, 4.0])], is_data)]
        [(3, 4, 5), (1, 2)]
    """
    headers: list[tuple[tuple[str, ...], str]] = []  # names, and the last axis named above them
    of: list[int | None] = []
    at: int | None = None
    axis = ""
    for k, (_, row) in enumerate(rows):
        below = rows[k + 1][1] if k + 1 < len(rows) else ()
        names = _names(row)
        axis = axis_in(" ".join(c for c in row if isinstance(c, str))) or axis
        if names and is_data(below) and len(names) == sum(c != "" for c in below):
            # a header that comes again, as of the way back, continues its table
            own = (i for i, h in enumerate(headers) if h[1] == axis and _alike(h[0], names))
            at = next(own, len(headers))
            headers += [(names, axis)] if at == len(headers) else []
            of.append(at)
        else:
            of.append(at if is_data(row) else None)
    if len(headers) < 2:
        return [Part(rows)]
    return [
        Part(
            [row for row, table in zip(rows, of, strict=True) if table in (None, k)],
            tuple(line for (line, _), t in zip(rows, of, strict=True) if t is not None and t != k),
        )
        for k in range(len(headers))
    ]


def axis_in(words: str) -> str:
    """Letter of the axis that words name last, `Axis: X` or `X-Achse`; "" where they name none."""
    found = [before or behind for before, behind in _AXIS.findall(words)]
    return (found or [""])[-1].upper()


def _names(row: Sequence[str | float]) -> tuple[str, ...]:
    """Cells of a row of two words or more, () of any other."""
    filled = tuple(c for c in row if c != "")
    words = tuple(c for c in filled if isinstance(c, str))
    return words if len(words) == len(filled) > 1 else ()


def _alike(one: tuple[str, ...], other: tuple[str, ...]) -> bool:
    same = sum(a == b for a, b in zip(one, other, strict=False))
    return len(one) == len(other) and same >= MIN_EQUAL_NAMES * len(one)
