"""Times of foreign tables: numbers in a unit, or times of day."""

import re
from collections.abc import Sequence
from datetime import datetime

import numpy as np

from matstd.importers.sheets.sheet import Sheet
from matstd.importers.sheets.units import SECONDS, parted
from matstd.twin.errors import BadFile
from matstd.twin.frames import Array
from matstd.twin.units import DAY, HOUR, MINUTE

TIME = re.compile(r"time|zeit|clock|heure|\btemps", re.IGNORECASE)  # names of columns of times

_CLOCK = re.compile(
    r"(?:(?P<date>\d{1,4}[-./]\d{1,2}[-./]\d{1,4})[T ,]+)?"
    r"(?P<h>\d{1,3}):(?P<m>\d{2})(?::(?P<s>\d{2}(?:[.,]\d+)?))?\s*(?P<half>[aApP][mM])?\s*Z?\Z"
)
"""A time of day, with its date or without."""

_ORDERS = ("%Y-%m-%d", "%d-%m-%Y", "%m-%d-%Y", "%d-%m-%y", "%m-%d-%y")
"""Orders of the parts of a date; the first in which all dates of a column are valid is used."""


def seconds(sheet: Sheet, column: int) -> Array:
    """A column of times, (N,), s: numbers in the unit of its name, or clock times from the first.

    A time of day without a date that goes back by more than half a day has passed midnight.

    Raises:
        BadFile: A cell that is neither; an ambiguous date.
    """
    if has_clock(sheet, column):
        return clock_times(sheet, column)
    return sheet.numbers(column) * SECONDS.get(parted(sheet.columns[column])[1], 1.0)


def has_clock(sheet: Sheet, column: int) -> bool:
    """Whether a column holds times of day."""
    return any(isinstance(row[column], str) and ":" in str(row[column]) for row in sheet.cells)


def clock_times(sheet: Sheet, column: int) -> Array:
    """Clock times since the first, (N,), s; not a number where a cell is empty."""
    texts = sheet.text(column)
    found = [_CLOCK.match(t) for t in texts]
    for i, (text, match) in enumerate(zip(texts, found, strict=True)):
        if text and match is None:
            raise sheet.bad(i, column, repr(text), "a time such as 14:03:20 or 2024-05-31 14:03:20")
    days = _days(sheet, [m["date"] or "" if m else "" for m in found])
    out = np.array([np.nan if m is None else _of_day(m) for m in found]) + days * DAY
    there = np.flatnonzero(np.isfinite(out))
    if not any(m and m["date"] for m in found):
        back = np.diff(out[there], prepend=out[there[:1]]) < -0.5 * DAY
        out[there] += DAY * np.cumsum(back)
    return np.asarray(out - out[there[0]])


def _of_day(match: re.Match[str]) -> float:
    """Seconds since midnight."""
    hours, half = int(match["h"]), (match["half"] or "").lower()
    if half:
        hours = hours % 12 + (12 if half == "pm" else 0)
    return hours * HOUR + int(match["m"]) * MINUTE + float((match["s"] or "0").replace(",", "."))


def _days(sheet: Sheet, dates: Sequence[str]) -> Array:
    """Days since the first date of every date, (N,); 0 where there is none, or all are one day."""
    if len(set(dates) - {""}) < 2:
        return np.zeros(len(dates))
    found = [days for order in _ORDERS if (days := _ordinals(dates, order)) is not None]
    shown = repr(next(filter(None, dates)))
    expected = "dates such as 2024-05-31 or 31.5.2024"
    if not found:
        raise BadFile(sheet.path, "dates", shown, expected)
    if len(found) > 1 and any("/" in d for d in dates):
        raise BadFile(sheet.path, "dates", f"{shown}, day or month first", expected)
    return found[0]


def _ordinals(dates: Sequence[str], order: str) -> Array | None:
    """Days of dates in one order of their parts since the first; None where they are in another."""
    plain = [re.sub(r"[./]", "-", d) for d in dates]
    try:
        days = np.array([datetime.strptime(d, order).toordinal() if d else 0 for d in plain])
    except ValueError:
        return None
    return np.where(days > 0, days - days[days > 0][0], 0.0)
