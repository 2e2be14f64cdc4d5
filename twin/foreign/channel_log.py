"""Logs of control systems with a line a value: name of the channel, date, time, number.

EPICS (`camonitor`, `pvmonitor`) writes such: channels come in turn, each when it changed, or whole
arrays of samples behind their count. Out comes a table with a column a channel.
"""

import re
from datetime import datetime

import numpy as np

_LINE = re.compile(r"(\S+)\s+(\d{4}-\d{2}-\d{2})[T\s]+(\d{2}:\d{2}:\d{2}(?:\.\d+)?)\s+(\S.*)\Z")

MOSTLY = 0.8
"""Share of the lines from which a text is such a log; others are remarks and alarms."""

FEWEST = 3
"""Values from which a channel is more than the setting of something."""


def by_channels(text: str) -> list[tuple[int, list[str]]]:
    r"""Rows of a table of such a log, each with its line; none where it is no such log.

    The channel with most values gives the times; the others are interpolated between their own
    values, and rows before or after those are left out.

    Example:
        >>> by_channels("a 2024-05-31 10:00:00 1\nb 2024-05-31 10:00:00 5\n"
        ...             "a 2024-05-31 10:00:01 2\na 2024-05-31 10:00:02 3\n"
        ...             "b 2024-05-31 10:00:02 6\nb 2024-05-31 10:00:03 7\n")[:2]
        [(1, ['time [s]', 'a', 'b']), (1, ['0.0', '1.0', '5.0'])]
    """
    lines = [(i, line.strip()) for i, line in enumerate(text.splitlines(), 1) if line.strip()]
    found = [(i, m) for i, line in lines if (m := _LINE.match(line))]
    if not found or len(found) < MOSTLY * len(lines):
        return []
    first = _seconds(found[0][1])
    at: dict[str, list[tuple[int, float, list[float]]]] = {}
    for i, match in found:
        values = _values(match[4])
        if values:
            at.setdefault(match[1], []).append((i, _seconds(match) - first, values))
    is_array = any(len(v) > 1 for rows in at.values() for _, _, v in rows)
    kept = {n: r for n, r in at.items() if (len(r) >= FEWEST) != is_array or len(r[0][2]) > 1}
    if len(kept) < 2:
        return []
    return _arrays(kept) if is_array else _scalars(kept)


def _seconds(match: re.Match[str]) -> float:
    return datetime.fromisoformat(f"{match[2]} {match[3][:15]}").timestamp()


def _values(text: str) -> list[float]:
    """Numbers behind the time: one, or a count and so many; words of alarms behind them go."""
    out: list[float] = []
    for word in text.split():
        try:
            out.append(float(word))
        except ValueError:
            break
    return out[1 : 1 + int(out[0])] if len(out) > 1 and out[0] == len(out) - 1 else out[:1]


def _scalars(
    at: dict[str, list[tuple[int, float, list[float]]]],
) -> list[tuple[int, list[str]]]:
    leader = max(at, key=lambda name: len(at[name]))
    time = np.array([t for _, t, _ in at[leader]])
    columns = {
        name: np.interp(
            time, [t for _, t, _ in rows], [v[0] for _, _, v in rows], left=np.nan, right=np.nan
        )
        for name, rows in at.items()
    }
    table = np.column_stack([time, *columns.values()])
    whole = np.isfinite(table).all(axis=1)
    lines = [i for i, _, _ in at[leader]]
    rows = [(lines[k], [repr(float(v)) for v in table[k]]) for k in np.flatnonzero(whole)]
    return [(lines[0], ["time [s]", *columns]), *rows]


def _arrays(
    at: dict[str, list[tuple[int, float, list[float]]]],
) -> list[tuple[int, list[str]]]:
    """Samples of arrays that came together: those of every channel one after the other."""
    joined = {name: [(i, v) for i, _, values in rows for v in values] for name, rows in at.items()}
    count = min(map(len, joined.values()))
    rows = [
        (next(iter(joined.values()))[k][0], [repr(v[k][1]) for v in joined.values()])
        for k in range(count)
    ]
    return [(rows[0][0], list(joined)), *rows]
