"""Times of a log from the time of day alone: over midnight, and over a clock that was set."""

from matstd.twin.units import DAY, HOUR

_MIDNIGHT_STEP = 0.5 * DAY  # a step of more than this, s, is a step back within the same day

_PAUSE = 600.0
"""Usual limit of a pause between two touches, s: a step of an hour and less than this is a clock
that was set."""


class LogClock:
    """Turns the times of day of a part into seconds since its begin."""

    def __init__(self, start: int | None) -> None:
        self.start = start  # time of day of the head, s; of the first touch where it has none
        self.remarks: list[str] = []
        self._last = start
        self._elapsed = 0.0

    def elapsed(self, now: int, line: int) -> float:
        """Seconds since the beginning at a time of day, s, read from a line; never decreasing.

        A clock that goes back by an hour (summer time ends) or on by one (it begins) has been set;
        the time between the touches is then the remainder of the hour.
        """
        if self._last is None or self.start is None:
            self.start = self._last = now
        step = (now - self._last) % DAY
        if step > _MIDNIGHT_STEP:
            back = DAY - step
            step = HOUR - back if 0.0 <= HOUR - back < _PAUSE else 0.0
            self.remarks.append(
                f"line {line}: the clock goes back by {back / 60.0:.0f} min; it was set, and times "
                f"go on {step:.0f} s after the touch before"
            )
        elif HOUR <= step < HOUR + _PAUSE:
            self.remarks.append(
                f"line {line}: the clock goes on by {step / 60.0:.0f} min; a pause, or summer time "
                "began and later times are an hour too late"
            )
        self._last = now
        self._elapsed += step
        return self._elapsed
