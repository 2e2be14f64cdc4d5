"""Logs of control systems with a line a value or a line an event, made a table of channels.

EPICS (`camonitor`, `pvmonitor`) writes a name, a date, a time and a number: channels come in turn,
each when it changed, or whole arrays of samples behind their count. Programs that log JSON write an
object a line, with a time and what was read then. Out comes a table with a column a channel.
"""

import json
import re
from collections.abc import Iterator
from datetime import datetime

import numpy as np

_LINE = re.compile(r"(\S+)\s+(\d{4}-\d{2}-\d{2})[T\s]+(\d{2}:\d{2}:\d{2}(?:\.\d+)?)\s+(\S.*)\Z")

MOSTLY = 0.8
"""Share of the lines from which a text is such a log; others are remarks and alarms."""

_CLOCK = re.compile(r"ts|t|time|timestamp|eventtime|zeit", re.IGNORECASE)
"""Keys under which an object has its time."""

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
    at = _of_lines(lines) or _of_objects(lines)
    is_array = any(len(v) > 1 for rows in at.values() for _, _, v in rows)
    kept = {n: r for n, r in at.items() if (len(r) >= FEWEST) != is_array or len(r[0][2]) > 1}
    if len(kept) < 2:
        return []
    return _arrays(kept) if is_array else _scalars(kept)


def _of_lines(lines: list[tuple[int, str]]) -> dict[str, list[tuple[int, float, list[float]]]]:
    """Values of every channel of a log with a line a value, each with its line and time."""
    found = [(i, m) for i, line in lines if (m := _LINE.match(line))]
    at: dict[str, list[tuple[int, float, list[float]]]] = {}
    if not found or len(found) < MOSTLY * len(lines):
        return at
    first = _seconds(found[0][1])
    for i, match in found:
        values = _values(match[4])
        if values:
            at.setdefault(match[1], []).append((i, _seconds(match) - first, values))
    return at


def _of_objects(lines: list[tuple[int, str]]) -> dict[str, list[tuple[int, float, list[float]]]]:
    """The same of a log with a JSON object a line; what lies deeper is named `above.below`."""
    at: dict[str, list[tuple[int, float, list[float]]]] = {}
    if not lines or not lines[0][1].startswith("{"):
        return at
    first: float | None = None
    for i, line in lines:
        try:
            read = dict(_leaves(json.loads(line)))
        except ValueError:
            return {}
        clock = next((k for k in read if _CLOCK.fullmatch(k)), None)
        time = _instant(read.pop(clock)) if clock else None
        if time is None:
            continue
        first = time if first is None else first
        for name, value in read.items():
            if isinstance(value, int | float) and not isinstance(value, bool):
                at.setdefault(name, []).append((i, time - first, [float(value)]))
    return at


def _leaves(value: object, above: str = "") -> Iterator[tuple[str, object]]:
    """What an object holds, by its keys and those of what it lies in."""
    if isinstance(value, dict | list):
        for key, below in value.items() if isinstance(value, dict) else enumerate(value):
            yield from _leaves(below, f"{above}.{key}" if above else str(key))
    else:
        yield above, value


def _instant(value: object) -> float | None:
    """A time in seconds: a number of them, or a date with its time."""
    if isinstance(value, int | float):
        return float(value)
    try:
        return datetime.fromisoformat(str(value)).timestamp()
    except ValueError:
        return None


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
