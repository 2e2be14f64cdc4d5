"""Logs of control systems, one line per value or event, as a table with a column per channel.

EPICS (`camonitor`, `pvmonitor`) writes a name, a date, a time and a number: channels come in turn,
each when it changed, or whole arrays of samples behind their count. Programs that log JSON write an
object a line, with a time and what was read then. Out comes a table with a column a channel.
"""

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from datetime import UTC, datetime
from typing import NamedTuple

import numpy as np

from matstd.importers.sheets.rows import filled_lines

_LINE = re.compile(r"(\S+)\s+(\d{4}-\d{2}-\d{2})[T\s]+(\d{2}:\d{2}:\d{2}(?:\.\d+)?)\s+(\S.*)\Z")
_CLOCK = re.compile(r"ts|t|time|timestamp|eventtime|zeit", re.IGNORECASE)
"""Keys of the time of an object."""
MIN_LOG_SHARE = 0.8  # share of the lines that must be readings; others are remarks and alarms
MIN_VALUES = 3  # values that distinguish a channel from a setting


class Reading(NamedTuple):
    """Reading of a channel at a time, s: one value, or an array of samples."""

    line: int
    channel: str
    time: float
    values: list[float]


def by_channels(text: str) -> list[tuple[int, list[str]]]:
    r"""Rows of the table of a log, each with its line; empty for any other text.

    The channel with most values gives the times; the others are interpolated between their own
    values, and rows before or after those are left out.

    Example:
        >>> by_channels("a 2024-05-31 10:00:00 1\nb 2024-05-31 10:00:00 5\n"
        ...             "a 2024-05-31 10:00:01 2\na 2024-05-31 10:00:02 3\n"
        ...             "b 2024-05-31 10:00:02 6\nb 2024-05-31 10:00:03 7\n")[:2]
        [(1, ['time [s]', 'a', 'b']), (1, ['0.0', '1.0', '5.0'])]
    """
    lines = filled_lines(text)
    readings = [r for r in _of_lines(lines) or _of_objects(lines) if r.values]
    at: dict[str, list[Reading]] = {}
    for reading in readings:
        at.setdefault(reading.channel, []).append(reading)
    is_array = any(len(r.values) > 1 for r in readings)
    kept = {
        n: r for n, r in at.items() if (len(r) >= MIN_VALUES) != is_array or len(r[0].values) > 1
    }
    if len(kept) < 2:
        return []
    return _arrays(kept) if is_array else _scalars(kept, readings[0].time)


def _of_lines(lines: Sequence[tuple[int, str]]) -> list[Reading]:
    """Readings of a log with a line a value; none of another text."""
    found = [(i, m) for i, line in lines if (m := _LINE.match(line))]
    if len(found) < MIN_LOG_SHARE * len(lines):
        return []
    dated = ((i, m, _instant(f"{m[2]} {m[3][:15]}")) for i, m in found)
    return [Reading(i, m[1], time, _numbers(m[4])) for i, m, time in dated if time is not None]


def _of_objects(lines: Sequence[tuple[int, str]]) -> list[Reading]:
    """Readings of a log with a JSON object a line; what lies deeper is named `above.below`."""
    out: list[Reading] = []
    if not lines or not lines[0][1].startswith("{"):
        return out
    for i, line in lines:
        try:
            read = dict(_leaves(json.loads(line)))
        except ValueError:
            return []
        clock = next((k for k in read if _CLOCK.fullmatch(k)), None)
        time = _instant(read.pop(clock)) if clock else None
        if time is not None:
            numbers = ((k, v) for k, v in read.items() if isinstance(v, int | float))
            out += [Reading(i, k, time, [float(v)]) for k, v in numbers if not isinstance(v, bool)]
    return out


def _leaves(value: object, above: str = "") -> Iterator[tuple[str, object]]:
    """What an object holds, by its keys and those of what it lies in."""
    if isinstance(value, dict | list):
        for key, below in value.items() if isinstance(value, dict) else enumerate(value):
            yield from _leaves(below, f"{above}.{key}" if above else str(key))
    else:
        yield above, value


def _instant(value: object) -> float | None:
    """A time in seconds: a number of them, or a date with its time.

    Without a zone it counts as UTC: in the zone of the computer that reads it an hour of a night in
    spring would be missing.
    """
    if isinstance(value, int | float):
        return float(value)
    try:
        found = datetime.fromisoformat(str(value))
    except ValueError:
        return None
    return (found if found.tzinfo else found.replace(tzinfo=UTC)).timestamp()


def _numbers(text: str) -> list[float]:
    """Numbers after the time: one, or a count and that many; words of alarms are dropped."""
    out: list[float] = []
    for word in text.split():
        try:
            out.append(float(word))
        except ValueError:
            break
    return out[1:] if len(out) > 1 and out[0] == len(out) - 1 else out[:1]


def _scalars(at: Mapping[str, Sequence[Reading]], start: float) -> list[tuple[int, list[str]]]:
    """Values of all channels at the times of the fullest one."""
    leader = max(at.values(), key=len)
    time = np.array([r.time for r in leader]) - start
    columns = []
    for readings in at.values():
        own, values = zip(*((r.time - start, r.values[0]) for r in readings), strict=True)
        columns.append(np.interp(time, own, values, left=np.nan, right=np.nan))
    table = np.column_stack([time, *columns])
    whole = np.flatnonzero(np.isfinite(table).all(axis=1))
    rows = [(leader[k].line, [repr(float(v)) for v in table[k]]) for k in whole.tolist()]
    return [(leader[0].line, ["time [s]", *at]), *rows]


def _arrays(at: Mapping[str, Sequence[Reading]]) -> list[tuple[int, list[str]]]:
    """Samples of arrays that came together: those of every channel one after the other."""
    joined = [[(r.line, repr(v)) for r in rows for v in r.values] for rows in at.values()]
    rows = [(cells[0][0], [v for _, v in cells]) for cells in zip(*joined, strict=False)]
    return [(rows[0][0], list(at)), *rows]
