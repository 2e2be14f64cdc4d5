"""Times of foreign tables: numbers in a unit, or what a clock on the wall said."""

import re
from collections.abc import Sequence
from datetime import date

import numpy as np

from matstd.importers.sheets.sheet import Sheet
from matstd.importers.sheets.units import SECONDS, parted
from matstd.twin.errors import BadFile
from matstd.twin.frames import Array
from matstd.twin.units import DAY, HOUR, MINUTE

_CLOCK = re.compile(
    r"(?:(?P<date>\d{1,4}[-./]\d{1,2}[-./]\d{1,4})[T ,]+)?"
    r"(?P<h>\d{1,3}):(?P<m>\d{2})(?::(?P<s>\d{2}(?:[.,]\d+)?))?\s*(?P<half>[aApP][mM])?\s*Z?\Z"
)
"""A time of day, with its date or without."""


def seconds(sheet: Sheet, column: int) -> Array:
    """A column of times, (N,), s: numbers in the unit of its name, or clock times from the first.

    A time of day without a date that falls back by more than half a day has passed midnight.

    Raises:
        BadFile: A cell that is neither; a date that may be read in two ways where it matters.
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
    parts = np.array([[int(p) for p in re.split(r"[-./]", d or "0-0-0")] for d in dates])
    is_year_first = any(re.match(r"\d{4}", d) for d in dates)
    if is_year_first:
        year, month, day = parts.T
    elif any("/" in d for d in dates) and parts[:, :2].max() <= 12:
        both = f"{next(d for d in dates if d)!r}, day or month first"
        raise BadFile(sheet.path, "dates", both, "dates such as 2024-05-31 or 31.5.2024")
    else:
        day, month, year = parts.T if parts[:, 1].max() <= 12 else parts[:, [1, 0, 2]].T
    year = np.where(year < 100, year + 2000, year)
    ymd = zip(dates, year.tolist(), month.tolist(), day.tolist(), strict=True)
    try:
        days = [date(y, m, d).toordinal() if text else None for text, y, m, d in ymd]
    except ValueError as error:
        raise BadFile(sheet.path, "dates", str(error), "dates such as 2024-05-31") from error
    first = next(day for day in days if day is not None)
    return np.array([0.0 if day is None else float(day - first) for day in days])
