"""Shewhart chart of single values, with limits from stated uncertainties or their own scatter.

Reference:
    ISO 7870-2:2013 (charts of individuals and moving ranges).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from itertools import pairwise

import numpy as np

from matstd.diagnosis.charts.course import Course, course_of, critical, mean_of
from matstd.diagnosis.charts.occasion import Charted, Occasion
from matstd.diagnosis.geometry import Estimate
from matstd.twin.frames import Array
from matstd.twin.numbers import rms

SIGMAS_OF_LIMITS = 3.0  # half width of the limits in standard deviations

MEDIAN_RANGE = 0.9539
"""Median of the difference of two values over their standard deviation, ``sqrt(2) * 0.6745``. The
median of the moving ranges is left alone by a step, of which one range in many is large."""

FEWEST_RANGES = 4
"""Moving ranges from which their median says something of the scatter of one quantity. The median
over all quantities does with fewer: where runs scatter 2 times as much as stated, 49 of 100
unchanged histories of ten runs had a change without it, with it 2."""


class LimitSource(Enum):
    """Where the width of the limits comes from: the larger of the two."""

    STATED = "stated uncertainties"
    SCATTER = "scatter of the differences"


@dataclass(frozen=True, slots=True)
class Segment:
    """Occasions between two steps, by their numbers in the chart, and their mean."""

    first: int
    last: int
    centre: Estimate


@dataclass(frozen=True, slots=True, eq=False)
class ControlChart:
    """The course of one quantity."""

    of: Charted
    rows: tuple[int, ...]  # numbers of the occasions that determine it, (n,)
    values: tuple[Estimate, ...]  # one estimate an occasion
    stated: float  # root mean square of their standard uncertainties
    scatter: float | None  # standard deviation from the moving ranges; None of too few
    widening: float  # scatter over stated uncertainty of all quantities together, at least 1
    segments: tuple[Segment, ...]  # between steps; one of a quantity without
    course: Course  # steps or drift
    beyond: tuple[int, ...]  # places in `rows` of values beyond the limits

    @property
    def sigma(self) -> float:
        """Standard deviation that the limits are made of: the larger of stated and scatter."""
        return max(self.stated * self.widening, self.scatter or 0.0)

    @property
    def source(self) -> LimitSource:
        """Which of the two it is."""
        return LimitSource.STATED if self.sigma == self.stated else LimitSource.SCATTER

    def smallest_step(self, quantities: int) -> float:
        """What chance accounts for of a step in the middle, in the unit of the quantity."""
        n = len(self.rows)
        half = n // 2
        return critical((n - 1) * quantities) * self.sigma * float(np.sqrt(n / (half * (n - half))))

    def limits(self, segment: Segment) -> tuple[float, float]:
        """Lower and upper control limit of a segment."""
        half = SIGMAS_OF_LIMITS * self.sigma
        return segment.centre.value - half, segment.centre.value + half

    @property
    def has_changed(self) -> bool:
        """Whether there is a step or a drift."""
        return bool(self.course.steps) or self.course.drift is not None


def widening_of(charted: Sequence[Charted], occasions: Sequence[Occasion]) -> float:
    """Median over all quantities of their scatter over their stated uncertainty, at least 1."""
    ratios = []
    for key in charted:
        x, u = _series(key, occasions)
        ratios.append(float(np.median(np.abs(np.diff(x)))) / MEDIAN_RANGE / rms(u))
    return max(1.0, float(np.median(ratios)))


def chart_of(
    charted: Charted,
    occasions: Sequence[Occasion],
    days: Array,
    quantities: int,
    widening: float = 1.0,
) -> ControlChart:
    """The chart of one quantity; arguments as of `course_of`, and `widening_of` all of them."""
    rows = tuple(i for i, one in enumerate(occasions) if charted in one.values)
    x, u = _series(charted, occasions)
    stated, scatter = rms(u), _scatter(x)
    sigma = max(stated * widening, scatter or 0.0)
    s = u * sigma / stated
    course = course_of(days[list(rows)], x, s, quantities)
    bounds = [0, *(step.after for step in course.steps), len(rows)]
    segments = tuple(
        Segment(low, high - 1, mean_of(x[low:high], s[low:high])) for low, high in pairwise(bounds)
    )
    beyond = [
        i
        for part in segments
        for i in range(part.first, part.last + 1)
        if abs(x[i] - part.centre.value) > SIGMAS_OF_LIMITS * sigma
    ]
    return ControlChart(
        of=charted,
        rows=rows,
        values=tuple(occasions[i].values[charted] for i in rows),
        stated=stated,
        scatter=scatter,
        widening=widening,
        segments=segments,
        course=course,
        beyond=tuple(beyond),
    )


def _series(charted: Charted, occasions: Sequence[Occasion]) -> tuple[Array, Array]:
    """Values of a quantity with their standard uncertainties."""
    known = [one.values[charted] for one in occasions if charted in one.values]
    return np.array([e.value for e in known]), np.array([e.u for e in known])


def _scatter(x: Array) -> float | None:
    """Standard deviation of single values from the median of their moving ranges."""
    ranges = np.abs(np.diff(x))
    return float(np.median(ranges)) / MEDIAN_RANGE if len(ranges) >= FEWEST_RANGES else None
