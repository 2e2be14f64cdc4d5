"""Several occasions of one machine in order of time, with a chart of every quantity."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime

import numpy as np

from matstd.diagnosis.charts.chart import ControlChart, chart_of, widening_of
from matstd.diagnosis.charts.occasion import Charted, Occasion
from matstd.twin.errors import DesignError, NotEnoughData
from matstd.twin.frames import Array
from matstd.twin.units import DAY

MIN_OCCASIONS = 3
"""Occasions from which there is a chart; two are compared by a diagnosis of both."""

SAME_FEATURE_WITHIN = 1.0
"""Distance between the touched parts of one feature beyond which it is another one, mm."""


@dataclass(frozen=True, eq=False)
class History:
    """A machine over several occasions."""

    occasions: tuple[Occasion, ...]  # in the order of time
    is_dated: bool  # whether every occasion has a date of its own; else they are counted
    days: Array  # since the first occasion, or their numbers, (n,)
    widening: float  # scatter over stated uncertainty of all quantities together, at least 1
    charts: tuple[ControlChart, ...]  # those that changed first, in the order of their significance

    @property
    def changed(self) -> tuple[ControlChart, ...]:
        """Charts with a step or a drift."""
        return tuple(chart for chart in self.charts if chart.has_changed)

    @property
    def begin(self) -> datetime | None:
        """Date of day zero; None without dates."""
        return self.occasions[0].date if self.is_dated else None

    @property
    def beyond(self) -> int:
        """Values beyond the limits, of all charts."""
        return sum(len(chart.beyond) for chart in self.charts)

    @property
    def values(self) -> int:
        """Values of all charts."""
        return sum(len(chart.rows) for chart in self.charts)


def history(occasions: Sequence[Occasion]) -> History:
    """Charts of occasions of one machine with one standard.

    Raises:
        NotEnoughData: Fewer occasions than a chart needs.
        DesignError: Another machine or standard, or one measurement twice.
    """
    if len(occasions) < MIN_OCCASIONS:
        raise NotEnoughData(
            f"{len(occasions)} occasion{'s' * (len(occasions) != 1)}, expected at least "
            f"{MIN_OCCASIONS}; two runs are compared by matstd diagnose FIRST.csv SECOND.csv"
        )
    dates = [one.date for one in occasions if one.date is not None]
    is_dated = len(set(dates)) == len(occasions)
    ordered = sorted(occasions, key=lambda one: (is_dated and one.date, one.name))
    _check_alike(ordered)
    days = np.arange(len(ordered), dtype=float)
    if is_dated:
        begin = min(dates)
        days = np.array([(one.date - begin).total_seconds() / DAY for one in ordered if one.date])
    charted = list(_charted(ordered))
    widening = widening_of(charted, ordered)
    charts = [chart_of(one, ordered, days, len(charted), widening) for one in charted]
    charts.sort(key=_first_what_changed)
    return History(
        occasions=tuple(ordered),
        is_dated=is_dated,
        days=days,
        widening=widening,
        charts=tuple(charts),
    )


def _charted(occasions: Sequence[Occasion]) -> Iterable[Charted]:
    """Quantities that enough occasions determine, in the order of the first that has them."""
    every = dict.fromkeys(key for one in occasions for key in one.values)
    return [k for k in every if sum(k in one.values for one in occasions) >= MIN_OCCASIONS]


def _first_what_changed(chart: ControlChart) -> tuple[bool, float]:
    """Order of charts: the most significant change first, then as they came."""
    found = [step.p_value for step in chart.course.steps]
    found += [] if chart.course.drift is None else [chart.course.drift.p_value]
    return not found, min(found, default=0.0)


def _check_alike(occasions: Sequence[Occasion]) -> None:
    """Refuse occasions of another machine or standard than the first, or one twice."""
    first = occasions[0]
    prints = {p: one.name for one in occasions for p in one.prints}
    for one in occasions[1:]:
        differs = one.chain.difference(first.chain)
        if differs is not None:
            key, here, there = differs
            raise DesignError(
                f"{one.name}: of another machine than {first.name} (machine "
                f"{one.chain.fingerprint}, not {first.chain.fingerprint}): {key} is {here}, "
                f"expected {there}"
            )
        if one.standard and first.standard and one.standard != first.standard:
            raise DesignError(
                f"{one.name}: measured on {one.standard}, expected {first.standard} as in "
                f"{first.name}; a trend is of one machine and one standard"
            )
        _check_places(one, first)
    for one in occasions:
        twice = [prints[p] for p in one.prints if prints[p] != one.name]
        if twice:
            raise DesignError(
                f"{one.name}: the same measurements as {twice[0]}, expected every run once"
            )


def _check_places(one: Occasion, first: Occasion) -> None:
    """Refuse features of one name at other places: without a stamp they show another standard."""
    for name in one.places.keys() & first.places.keys():
        (low, high), (least, most) = one.places[name], first.places[name]
        far = (
            np.maximum(least - high, low - most)
            - np.maximum(high - low, most - least)
            - SAME_FEATURE_WITHIN
        )
        if (far > 0.0).any():
            raise DesignError(
                f"{one.name}: {name} was touched about {_point(low, high)} mm, expected "
                f"{_point(least, most)} mm as in {first.name}; a trend is of one standard"
            )


def _point(low: Array, high: Array) -> str:
    return "[" + ", ".join(f"{v:.1f}" for v in 0.5 * (low + high)) + "]"
